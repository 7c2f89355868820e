"""An independent calculation for a feed axis with a catalog screw, with which the program is compared.

It shares no code with the program. It works on the names and units of a case, follows `docs/theory/18-axis.md` and
`docs/theory/19-warm-state.md`, and integrates a cycle numerically between the points where a speed, a force or a torque
changes its sign, while the program uses closed forms.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

GRAVITY = 9.80665
YOUNG = 207e9
DENSITY = 7850.0
EXPANSION = 11.5e-6
CONDUCTIVITY = 45.0
STEFAN_BOLTZMANN = 5.670374419e-8
CORE_STRESS = 147e6
EFFICIENCY = {"driving": 0.9, "back-driving": 0.8}

# For each support: root for the lowest bending frequency (Z1), buckling factor (Z2), number of axially fixed bearings.
WHIRL = {"fixed-free": 1.8751040687119611, "supported-supported": math.pi, "fixed-supported": 3.9266023120479185,
         "fixed-fixed": 4.730040744862704}
BUCKLING = {"fixed-free": 0.25, "supported-supported": 1.0, "fixed-supported": 4.493409457909064**2 / math.pi**2, "fixed-fixed": 4.0}

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class Piece:
    """A part of the cycle in which the speed and the process force change linearly with time."""

    time: float
    feeds: tuple[float, float]
    forces: tuple[float, float]
    load_factor: float

    @property
    def acceleration(self) -> float:
        return (self.feeds[1] - self.feeds[0]) / self.time

    @property
    def stands(self) -> bool:
        return self.feeds == (0.0, 0.0)

    def feed(self, u: float) -> float:
        return self.feeds[0] + u * (self.feeds[1] - self.feeds[0])

    def force(self, u: float) -> float:
        """Return the process force after the fraction u of the duration. It varies only if the speed is constant."""
        return self.forces[0] + u * (self.forces[1] - self.forces[0])


def ramps(entry: dict[str, Any], default_load_factor: float) -> list[Piece]:
    """Return the pieces into which a cycle entry is divided."""
    force = entry.get("force_N", 0.0)
    factor = entry.get("load_factor", default_load_factor)
    forces = (force, entry.get("end_force_N", force))

    def piece(time: float, start: float, end: float) -> Piece:
        return Piece(time, (start, end), forces if start == end else (force, force), factor)

    if "dwell_s" in entry:
        return [piece(entry["dwell_s"], 0.0, 0.0)]
    if "distance_mm" in entry:
        distance = entry["distance_mm"] / 1000
        sign, length = math.copysign(1.0, distance), abs(distance)
        if "profile" in entry:
            time = entry["time_s"]
            if entry["profile"] == "triangular":
                top, times = 2 * length / time, (time / 2, 0.0, time / 2)
            else:
                top, times = 1.5 * length / time, (time / 3, time / 3, time / 3)
        else:
            a = entry["acceleration_m_s2"]
            d = entry.get("deceleration_m_s2", a)
            c = 1 / a + 1 / d
            if "time_s" in entry:
                time = entry["time_s"]
                top = (time - math.sqrt(time * time - 2 * c * length)) / c
            else:
                top = min(entry["max_feed_m_min"] / 60, math.sqrt(2 * length / c))
                time = length / top + top * c / 2
            times = (top / a, time - top / a - top / d, top / d)
        v = sign * top
        parts = [(times[0], 0.0, v), (times[1], v, v), (times[2], v, 0.0)]
        return [piece(*part) for part in parts if part[0] > 1e-12 * time]
    time = entry["time_s"]
    if "start_feed_m_min" in entry or "end_feed_m_min" in entry:
        start, end = entry.get("start_feed_m_min", 0.0) / 60, entry.get("end_feed_m_min", 0.0) / 60
        if start * end < 0:
            turn = time * abs(start) / (abs(start) + abs(end))
            return [piece(turn, start, 0.0), piece(time - turn, 0.0, end)]
        return [piece(time, start, end)]
    feed = entry["feed_m_min"] / 60
    if acceleration := entry.get("acceleration_m_s2", 0.0):
        # The given feed rate applies to the faster end of the ramp.
        other = feed - acceleration * time * math.copysign(1.0, acceleration * feed)
        return [piece(time, other, feed) if acceleration * feed > 0 else piece(time, feed, other)]
    return [piece(time, feed, feed)]


def roots(function: Callable[[float], float]) -> list[float]:
    """Return the points in (0, 1) where the function changes its sign, found on a fine grid and by bisection."""
    grid = np.linspace(0.0, 1.0, 65)
    values = [function(u) for u in grid]
    found = []
    for low, high, at_low, at_high in zip(grid, grid[1:], values, values[1:]):
        if at_low * at_high < 0:
            for _ in range(80):
                middle = 0.5 * (low + high)
                if function(middle) * at_low > 0:
                    low = middle
                else:
                    high = middle
            found.append(0.5 * (low + high))
    return found


class Axis:
    """Calculation for an axis with a catalog screw. Internal values have SI units, results the units in their names."""

    def __init__(self, case: dict[str, Any]) -> None:
        self.case = case

        def number(key: str, default: float = 0.0) -> float:
            return float(case.get(key, default))

        self.lead = number("lead_mm") / 1000
        self.h = self.lead / math.tau
        self.core = number("shaft_diameter_mm") / 1000
        self.pitch_circle = number("pitch_circle_diameter_mm") / 1000
        self.length = number("unsupported_length_mm") / 1000
        self.support = case.get("support", "fixed-supported")
        self.ratio = number("gear_ratio", 1.0)
        self.gear = number("gear_efficiency", 1.0)
        self.share = number("load_share", 1 / number("screws_count", 1.0))
        self.mass, self.counterweight = number("moved_mass_kg"), number("counterweight_kg")
        slope = math.radians(number("inclination_deg"))
        self.weight = self.share * GRAVITY * (self.mass * math.sin(slope) - self.counterweight)
        self.guides = self.share * (
            number("guide_friction") * self.mass * GRAVITY * math.cos(slope) + number("guide_force_N")
        )
        self.balance = self.share * number("counterbalance_N")
        self.drag = number("seal_torque_Nm") + number("support_bearing_torque_Nm")
        self.preload = number("preload_N")
        tangent = self.lead / (math.pi * self.pitch_circle)
        self.preload_drag = 0.05 / math.sqrt(tangent) * self.preload * self.h if self.preload else 0.0
        self.driven_nut = case.get("driven_part") == "nut"
        self.pieces = [
            piece for entry in case["cycle"] for piece in ramps(entry, number("load_factor", 1.0))
        ]
        self.per_motor = number("screws_per_motor", 1.0)
        self.time = sum(piece.time for piece in self.pieces)

    # Loads and torques after the fraction u of the duration of a piece.

    def load(self, piece: Piece, u: float) -> float:
        """Return the axial load of the screw with the highest load. The guides oppose the motion."""
        sign = math.copysign(1.0, piece.feeds[0] + piece.feeds[1])
        inertia = self.share * (self.mass + self.counterweight) * piece.acceleration
        return self.share * piece.force(u) + self.weight - self.balance + sign * self.guides + inertia

    def rest_load(self) -> float:
        """Return the axial load at rest, which is the sum of the weight and the constant process force."""
        if "hold_force_N" in self.case:
            force = float(self.case["hold_force_N"])
        else:
            forces = {f for entry in self.case["cycle"] for f in (entry.get("force_N", 0.0), entry.get("end_force_N", entry.get("force_N", 0.0)))}
            force = forces.pop() if len(forces) == 1 else 0.0
        return self.share * force + self.weight - self.balance

    def friction_torque(self, piece: Piece, u: float) -> float:
        """Return the friction torque at the screw, from catalog efficiencies and the catalog rule for the preload."""
        load, feed = self.load(piece, u), piece.feed(0.5)
        loss = 1 / EFFICIENCY["driving"] - 1 if load * feed > 0 else 1 - EFFICIENCY["back-driving"]
        return abs(load) * self.h * loss + self.preload_drag + self.drag

    def screw_torque(self, piece: Piece, u: float) -> float:
        sign = math.copysign(1.0, piece.feeds[0] + piece.feeds[1])
        return self.load(piece, u) * self.h + sign * self.friction_torque(piece, u)

    def motor_torque(self, piece: Piece, u: float) -> float:
        if piece.stands:
            held = self.share * piece.force(0.0) + self.weight - self.balance
            return 0.0 if self.case.get("brake_at_rest") else self.per_motor * held * self.h / self.ratio
        turn = piece.acceleration / self.h
        at_screw = self.screw_torque(piece, u) + self.turning_inertia() * turn
        power = at_screw * piece.feed(0.5)
        through_gear = at_screw / (self.ratio * (self.gear if power > 0 else 1 / self.gear))
        return self.per_motor * (through_gear + self.motor_side_inertia() * self.ratio * turn)

    # Inertia.

    def screw_mass(self) -> float:
        return float(self.case["screw_mass_kg_m"]) * self.length

    def screw_inertia(self) -> float:
        return self.screw_mass() ** 2 / (2 * math.pi * DENSITY * self.length)

    def turning_inertia(self) -> float:
        turning = float(self.case["nut_inertia_kg_m2"]) if self.driven_nut else self.screw_inertia()
        return turning + float(self.case.get("coupling_inertia_kg_m2", 0.0))

    def motor_side_inertia(self) -> float:
        motor = float(self.case.get("motor_inertia_kg_m2", 0.0)) / self.per_motor
        return motor + float(self.case.get("gear_inertia_kg_m2", 0.0))

    # Integrals over the cycle.

    def mean(self, value: Callable[[Piece, float], float], kinks: list[Callable[[Piece, float], float]]) -> float:
        """Return the mean over the duration of the cycle, integrated between the sign changes of `kinks`."""
        return self.integral(value, kinks) / self.time

    def integral(self, value: Callable[[Piece, float], float], kinks: list[Callable[[Piece, float], float]]) -> float:
        total = 0.0
        for piece in self.pieces:
            ends = sorted({0.0, 1.0, *(u for kink in kinks for u in roots(partial(kink, piece)))})
            for low, high in pairwise(ends):
                half = 0.5 * (high - low)
                points = low + half * (1 + NODES)
                total += piece.time * half * sum(w * value(piece, u) for w, u in zip(WEIGHTS, points))
        return total

    def ends(self, value: Callable[[Piece, float], float]) -> list[float]:
        """Return the values at both ends of each moving piece."""
        return [value(piece, u) for piece in self.pieces if not piece.stands for u in (0.0, 1.0)]

    def body_loads(self, load: float) -> tuple[float, float]:
        """Return the loads of the two flanks of a nut, or of the two nuts of a preloaded pair (D14)."""
        if not self.preload:
            return (load, 0.0) if load > 0 else (0.0, -load)
        size = abs(load)
        lift = 2**1.5 * self.preload
        busy = self.preload * (1 + size / lift) ** 1.5 if size < lift else size
        rest = max(busy - size, 0.0)
        return (busy, rest) if load > 0 else (rest, busy)

    def equivalent_loads(self) -> list[float]:
        travel = self.integral(lambda p, u: abs(p.feed(u)), [])
        lift = 2**1.5 * self.preload
        kinks = [
            lambda p, u: p.load_factor * self.load(p, u),
            lambda p, u: abs(p.load_factor * self.load(p, u)) - lift,
        ]
        loads = []
        for side in (0, 1):

            def cube(p: Piece, u: float, side: int = side) -> float:
                return self.body_loads(p.load_factor * self.load(p, u))[side] ** 3 * abs(p.feed(u))

            loads.append((self.integral(cube, kinks) / travel) ** (1 / 3))
        return loads

    def results(self) -> dict[str, float]:
        """Return all numbers with the names of the program."""
        case = self.case
        found: dict[str, float] = {}
        travel = self.integral(lambda p, u: abs(p.feed(u)), [])
        revolutions = travel / self.lead
        mean_turn = revolutions / self.time
        loads = [abs(load) for load in self.ends(self.load)]
        if any(piece.stands for piece in self.pieces):
            loads.append(abs(self.rest_load()))
        largest = max(loads)
        fastest = max(abs(piece.feed(u)) for piece in self.pieces for u in (0.0, 1.0)) / self.lead
        found["largest_load_N"] = largest
        found["largest_speed_rpm"] = fastest * 60
        found["largest_feed_m_min"] = fastest * self.lead * 60
        found["equivalent_speed_rpm"] = mean_turn * 60
        found["revolutions_per_cycle"] = revolutions
        found["travel_per_cycle_mm"] = travel * 1000
        found["cycle_time_s"] = self.time
        places = np.cumsum([0.0] + [0.5 * (p.feeds[0] + p.feeds[1]) * p.time for p in self.pieces])
        found["cycle_return_mm"] = places[-1] * 1000
        found["cycle_range_mm"] = (places.max() - places.min()) * 1000
        found["speed_jumps_count"] = float(
            sum(
                abs(before.feeds[1] - after.feeds[0]) > 1e-9 * fastest * self.lead
                for before, after in zip(self.pieces, self.pieces[1:] + self.pieces[:1])
            )
        )

        # Life and static safety.
        dynamic, static = float(case["rated_dynamic_load_N"]), float(case["rated_static_load_N"])
        equivalent = self.equivalent_loads()
        found["equivalent_load_N"] = max(equivalent)
        if min(equivalent) > 0:
            found["equivalent_load_of_other_flank_N"] = min(equivalent)
        lives = [1e6 * (dynamic / load) ** 3 for load in equivalent if load > 0]
        life = sum(life ** (-10 / 9) for life in lives) ** (-9 / 10)
        found["cycle_life_revolutions"] = life
        found["cycle_life_h"] = life / (mean_turn * 3600)
        found["cycle_life_km"] = life * self.lead / 1000
        found["cycle_life_cycles"] = life / revolutions
        found["cycle_life_strokes"] = life * self.lead * 1000 / float(case["stroke_mm"])
        found["static_safety_factor"] = static / max(self.body_loads(largest))
        found["modified_dynamic_rating_N"] = dynamic
        found["modified_static_rating_N"] = static

        # Critical speed and buckling of the screw between its bearings.
        area, bending = math.pi / 4 * self.core**2, math.pi / 64 * self.core**4
        critical = WHIRL[self.support] ** 2 / self.length**2 * math.sqrt(YOUNG * bending / (DENSITY * area))
        found["critical_speed_rpm"] = critical / math.tau * 60
        if self.driven_nut:
            found["nut_resonance_ratio"] = fastest * math.tau / critical
        else:
            found["critical_speed_ratio"] = fastest * math.tau / critical
        end_condition = "supported-supported" if self.support == "supported-supported" else "fixed-fixed"
        buckling = BUCKLING[end_condition] * math.pi**2 * YOUNG * bending / self.length**2
        found["buckling_load_N"] = buckling
        found["yield_load_N"] = CORE_STRESS * area
        found["largest_speed_number_mm_min"] = self.pitch_circle * 1000 * fastest * 60
        found["screw_stiffness_N_um"] = YOUNG * area / self.length * (4 if self.support == "fixed-fixed" else 1) * 1e-6
        # Torsion of a round bar. If both bearings are fixed, only half the length between them counts.
        shear, polar = YOUNG / (2 * (1 + 0.3)), math.pi / 32 * self.core**4
        part = self.length * (0.5 if self.support == "fixed-fixed" else 1)
        found["torsional_stiffness_N_um"] = shear * polar / part / self.h**2 * 1e-6
        found["screw_mass_kg"] = self.screw_mass()
        found["unsupported_length_mm"] = self.length * 1000
        found["thread_length_mm"] = float(case["stroke_mm"]) + float(case["nut_length_mm"]) + 2 * self.lead * 1000
        found["shaft_diameter_mm"] = self.core * 1000

        # Torque, power and heat of the motor.
        torque = self.motor_torque

        def power(p: Piece, u: float) -> float:
            return torque(p, u) * p.feed(u) / self.h * self.ratio

        found["motor_speed_rpm"] = fastest * 60 * self.ratio
        found["peak_motor_torque_Nm"] = max(
            [abs(value) for value in self.ends(torque)] + [abs(torque(p, 0.5)) for p in self.pieces if p.stands]
        )
        found["rms_motor_torque_Nm"] = math.sqrt(self.mean(lambda p, u: torque(p, u) ** 2, [torque, self.load]))
        found["peak_motor_power_W"] = max(abs(value) for value in self.ends(power))
        found["peak_regenerated_power_W"] = max(0.0, *(-value for value in self.ends(power)))
        found["regenerated_energy_J"] = self.integral(lambda p, u: max(0.0, -power(p, u)), [power, self.load])

        def heat(p: Piece, u: float) -> float:
            return 0.0 if p.stands else self.friction_torque(p, u) * abs(p.feed(u)) / self.h

        found["mean_heat_W"] = self.mean(heat, [self.load])

        # Rest and brake.
        rest = self.rest_load()
        found["rest_load_N"] = rest
        without_friction = self.per_motor * abs(rest) * self.h / self.ratio
        found["holding_torque_frictionless_Nm"] = without_friction
        found["required_brake_torque_Nm"] = 1.5 * without_friction
        back = EFFICIENCY["back-driving"]
        found["holding_torque_Nm"] = abs(rest) * self.h * back

        # Inertia.
        moved = self.share * (self.mass + self.counterweight) * self.h**2
        found["inertia_of_mass_kg_m2"] = moved
        if not self.driven_nut:
            found["inertia_of_screw_kg_m2"] = self.screw_inertia()
        at_motor = self.per_motor * (self.turning_inertia() + moved) / self.ratio**2
        found["inertia_at_motor_kg_m2"] = at_motor
        rotating = self.turning_inertia() + self.motor_side_inertia() * self.ratio**2
        found["reflected_mass_kg"] = rotating / self.h**2
        motor = float(case.get("motor_inertia_kg_m2", 0.0))
        if motor:
            found["inertia_ratio"] = at_motor / motor
        if self.preload:
            found["preload_torque_measured_Nm"] = self.preload_drag
        self.largest, self.buckling, self.critical, self.fastest = largest, buckling, critical, fastest
        found.update(self.temperatures())
        compression = max(0.0, -self.tension)
        found["buckling_safety"] = buckling / (largest + compression)
        if compression:
            # Compression lowers the critical speed. `whole` is the buckling load of the screw with its end supports.
            whole = BUCKLING[self.support] * math.pi**2 * YOUNG * bending / self.length**2
            lowered = math.sqrt(max(0.0, 1 - compression / whole))
            found["critical_speed_ratio"] = math.inf if lowered == 0 else found["critical_speed_ratio"] / lowered
            found["critical_speed_warm_rpm"] = critical * lowered / math.tau * 60
        ends = BUCKLING[self.support] / BUCKLING[end_condition]
        found["buckling_load_of_support_N"] = ends * buckling
        found["buckling_safety_of_support"] = ends * found["buckling_safety"]
        found["support_bearing_load_N"] = largest
        if self.support == "fixed-fixed":
            found["screw_tension_N"] = self.tension
            found["support_bearing_load_cold_N"] = largest + abs(self.cold_tension)
            found["support_bearing_load_warm_N"] = largest + abs(self.tension)
            found["support_bearing_load_N"] = largest + max(abs(self.cold_tension), abs(self.tension))
            found["pretension_for_no_slack_K"] = found["steady_temperature_rise_K"]
        return found

    # Thermal network of docs/theory/19-warm-state.md, in which the balls are not a node.

    def film(self, diameter: float, speed: float) -> float:
        """Return the film coefficient of a rotating cylinder in still air with radiation (I9)."""
        reynolds = abs(speed) * diameter**2 / (2 * 1.6e-5)
        grashof = 9.81 * 10 / 300 * diameter**3 / 1.6e-5**2
        nusselt = 0.135 * ((0.5 * reynolds**2 + grashof) * 0.71) ** (1 / 3)
        return float(nusselt * 0.026 / diameter + 4 * 0.3 * STEFAN_BOLTZMANN * 300**3)

    def temperatures(self) -> dict[str, float]:
        """Return the temperature rises of nut, screw and ends, and the growth and the tension of the screw."""
        outer = float(self.case["nut_outer_diameter_mm"]) / 1000
        nut_length = float(self.case["nut_length_mm"]) / 1000
        stroke = float(self.case["stroke_mm"]) / 1000

        def turning(p: Piece, u: float) -> float:
            return 0.0 if self.driven_nut else p.feed(u) / self.h

        film = self.mean(lambda p, u: self.film(self.pitch_circle, turning(p, u)), [])
        mean_feed = self.mean(lambda p, u: abs(p.feed(u)), [])
        free = 1.42 * (10 / nut_length) ** 0.25
        forced = 0.664 * math.sqrt(mean_feed * nut_length / 1.6e-5) * 0.71 ** (1 / 3) * 0.026 / nut_length
        nut_film = (free**3 + forced**3) ** (1 / 3) + 4 * 0.9 * STEFAN_BOLTZMANN * 300**3
        surface = math.pi * outer * nut_length
        table = 10 * surface
        if self.driven_nut:
            turning_film = self.mean(lambda p, u: self.film(outer, p.feed(u) / self.h), [])
            bearing = 3125 * outer**2
            nut_to_air = turning_film * surface + 1 / (1 / (nut_film * table) + 1 / bearing)
        else:
            nut_to_air = nut_film * (surface + table)
        link = 0.06 * math.pi * self.pitch_circle * nut_length / 0.0015 + 65 * self.pitch_circle
        per_meter = film * math.pi * self.pitch_circle
        area = math.pi / 4 * self.core**2
        travel = stroke + nut_length
        side = (self.length - travel) / 2
        fin = math.sqrt(per_meter / (CONDUCTIVITY * area))
        direct = CONDUCTIVITY * area * fin / math.tanh(fin * side)
        across = CONDUCTIVITY * area * fin / math.sinh(fin * side)
        end = 3125 * self.pitch_circle**2
        held = [True, self.support != "fixed-free"]
        # Unknown temperature rises: nut, screw, end 1, end 2.
        matrix = np.zeros((4, 4))
        matrix[0] = [nut_to_air + link, -link, 0, 0]
        matrix[1] = [-link, link + per_meter * travel + 2 * direct, -across, -across]
        for i in (0, 1):
            matrix[2 + i, 2 + i] = direct + (end if held[i] else 0.0)
            matrix[2 + i, 1] = -across
        contacts = self.mean(
            lambda p, u: 0.0 if p.stands else (self.friction_torque(p, u) - self.drag) * abs(p.feed(u)) / self.h,
            [self.load],
        )
        mean_turn = self.mean(lambda p, u: abs(p.feed(u)) / self.h, [])
        seals = float(self.case.get("seal_torque_Nm", 0.0)) * mean_turn
        bearings = float(self.case.get("support_bearing_torque_Nm", 0.0)) * mean_turn
        ends = np.array(held) / sum(held)
        heat = np.array([contacts / 2, contacts / 2 + seals, *(bearings * ends)])
        if self.driven_nut:
            heat = np.array([contacts / 2 + seals, contacts / 2, 0.0, 0.0])
        rises = np.linalg.solve(matrix, heat)
        half = math.tanh(fin * side / 2) / fin
        growth = EXPANSION * (travel * rises[1] + sum(half * (rises[1] + rise) for rise in rises[2:]))
        bearing_stiffness = float(self.case.get("support_bearing_stiffness_N_um", math.inf)) * 1e6
        chain = 1 / (self.length / (YOUNG * area) + 2 / bearing_stiffness)
        self.tension = 0.0
        if self.support == "fixed-fixed":
            stretched = float(self.case.get("pretension_K", 0.0))
            self.cold_tension = chain * EXPANSION * self.length * stretched
            self.tension = self.cold_tension - chain * growth
        return {
            "nut_heat_W": contacts + seals,
            "nut_conductance_W_K": nut_to_air,
            "screw_film_W_m2K": film,
            "nut_rise_K": rises[0],
            "screw_rise_K": rises[1],
            "end_1_rise_K": rises[2],
            "end_2_rise_K": rises[3],
            "steady_temperature_rise_K": growth / (EXPANSION * self.length),
            "free_growth_um": growth * 1e6,
        }
