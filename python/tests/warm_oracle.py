"""An independent solution of the warm reference case WS-P5, with and without the limit of friction by gross sliding.

It shares no code with the program and does not call the program. It follows chapters 6, 7, 16, 17 and 19 of
`docs/theory` for a pair of nuts in X arrangement without axial load: oil, raceway control with the nut in control,
rigid bodies. The preload offset, the conductances and the drag outside the contacts are inputs.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

CELSIUS = 273.15
YOUNG, POISSON = 207e9, 0.3
MODULUS = YOUNG / (2 * (1 - POISSON**2))
DENSITY = 7800.0
EXPANSION = 11.5e-6
CONDUCTIVITY = 45.0
# Mineral oil of ISO VG 68: viscosities at 40 and 100 °C, density, factor and exponent of (Y4), ratio of the limiting
# shear stress to the pressure, conductivity.
VISCOSITIES = 68.0, 8.53
OIL_DENSITY = 880.0
PRESSURE_FACTOR, PRESSURE_EXPONENT = 9.904, 0.139
PRESSURE_SLOPE = 0.02
LIMITING_SHEAR = 0.047
OIL_CONDUCTIVITY = 0.134
BOUNDARY = 0.12
ROLLING_FACTOR, HYSTERESIS = 0.85, 0.01
CREEP = 1e-4


def elliptic(m: float) -> tuple[float, float]:
    """Return the complete elliptic integrals K and E with the parameter m, by arithmetic-geometric means."""
    a, g, power, total = 1.0, math.sqrt(1.0 - m), 0.5, 0.5 * m
    for _ in range(12):
        a, g, c = 0.5 * (a + g), math.sqrt(a * g), 0.5 * (a - g)
        power *= 2.0
        total += power * c * c
    k = math.pi / (2.0 * a)
    return k, k * (1.0 - total)


class Contact:
    """A Hertz contact between ball and groove: (H2) to (H10)."""

    def __init__(self, pitch_radius: float, h: float, ball: float, groove: float, angle: float, side: int) -> None:
        """Calculate the contact. `side` is +1 at the nut and -1 at the screw."""
        self.side, self.ball, self.groove = side, ball, groove
        self.offset = groove - ball
        center = pitch_radius - side * self.offset * math.cos(angle)
        curvature = center / (center**2 + h**2) * math.cos(angle)
        self.along = 1.0 / ball - side * curvature / (1.0 + side * groove * curvature)
        self.across = 1.0 / ball - 1.0 / groove
        low, high = 1.0 + 1e-12, 1e3
        for _ in range(200):
            self.ratio = math.sqrt(low * high)
            k, e = elliptic(1.0 - self.ratio**-2)
            if (self.ratio**2 * e - k) / (k - e) < self.along / self.across:
                low = self.ratio
            else:
                high = self.ratio
        self.k, self.e = elliptic(1.0 - self.ratio**-2)
        size = 3 * self.ratio**2 * self.e / (math.pi * (self.along + self.across) * MODULUS)
        self.unit_axis = size ** (1 / 3)
        self.unit_approach = 3 * self.k / (2 * math.pi * self.unit_axis * MODULUS)

    @property
    def stiffness(self) -> float:
        return float(self.unit_approach**-1.5)


class Oil:
    """The oil at a temperature [K]: (Y1) to (Y5)."""

    def __init__(self, kelvin: float) -> None:
        low, high = (math.log10(math.log10(nu + 0.7)) for nu in VISCOSITIES)
        slope = (low - high) / math.log10((100 + CELSIUS) / (40 + CELSIUS))
        z = 10 ** (low - slope * math.log10(kelvin / (40 + CELSIUS)))
        nu = 10**z - 0.7
        density = OIL_DENSITY * (1 - 6.5e-4 * (kelvin - 15 - CELSIUS))
        self.viscosity = nu * 1e-6 * density
        self.thinning = (nu + 0.7) / nu * math.log(10) * z * slope / kelvin + 6.5e-4 * OIL_DENSITY / density
        self.alpha = PRESSURE_FACTOR * nu**PRESSURE_EXPONENT * 1e-9
        self.pressure_scale = 1 / self.alpha - 2e8 * PRESSURE_SLOPE


# Polar rule over the unit disk: Gauss-Legendre in the radius and equal angles. The slip vanishes inside the disk at one
# point; twice the nodes change the friction of a ball by less than 1e-7.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)
_RADIUS = 0.5 * (_NODES + 1)
_ANGLE = 2 * np.pi * (np.arange(96) + 0.5) / 96
DISK_X = np.outer(_RADIUS, np.cos(_ANGLE)).ravel()
DISK_Y = np.outer(_RADIUS, np.sin(_ANGLE)).ravel()
PRESSURE = np.repeat(np.sqrt(1 - _RADIUS**2), 96)
SHARE = np.repeat(0.5 * _WEIGHTS * _RADIUS, 96) * PRESSURE * (2 * np.pi / 96) * 3 / (2 * np.pi)


def dot(one: Floats, other: Floats) -> float:
    return float(np.dot(one, other))


class Loads(NamedTuple):
    """Loads of the balls, in the order of the circuits."""

    normal: Floats
    axial: Floats
    stiffness: float
    """Axial stiffness of the nut [N/m]."""
    excess: float
    """Difference between the radius of the balls and the nominal radius [m]."""
    gap: float


class Pair:
    """The case WS-P5."""

    def __init__(self, case: dict[str, Any], expect: dict[str, Any]) -> None:
        self.pitch_radius = case["pitch_circle_diameter_mm"] / 2e3
        self.ball = case["ball_diameter_mm"] / 2e3
        self.h = case["lead_mm"] / 2e3 / math.pi
        self.lead_angle = math.atan2(self.h, self.pitch_radius)
        self.angle = math.radians(case["contact_angle_deg"])
        self.grooves = case["nut_conformity"] * 2 * self.ball, case["screw_conformity"] * 2 * self.ball
        self.length = case["stroke_mm"] / 1e3 + case["nut_length_mm"] / 1e3
        self.between = self.length + 2 * case["lead_mm"] / 1e3
        self.section = math.pi / 4e6 * (case["shaft_diameter_mm"] ** 2 - case["screw_bore_mm"] ** 2)
        self.speed = case["cycle"][0]["screw_speed_rpm"] * math.pi / 30
        self.seal, self.bearings = case["seal_torque_Nm"], case["support_bearing_torque_Nm"]
        self.roughness = math.hypot(case["ball_roughness_um"], case["nut_roughness_um"]) * 1e-6
        self.offset = expect["preload_offset_um"] * 1e-6
        self.drag = expect["phases"][0]["extra_drag_Nm"] / expect["warm_preload_N"]
        self.conductances = expect["conductances_W_K"]
        self.ratings = case["nut_rating_N"], case["screw_rating_N"]
        theta = [
            np.radians(of["start_deg"] + (np.arange(of["balls"]) + 0.5) * of["arc_deg"] / of["balls"])
            for of in case["circuits"]
        ]
        self.z = self.h * np.concatenate(theta)
        self.z -= self.z.mean()
        self.way = np.repeat([1.0, -1.0], [len(of) for of in theta])

    def contacts(self, excess: float, angle: float) -> tuple[Contact, Contact]:
        """Return the contacts at nut and screw of a ball whose radius is larger by `excess` [m]."""
        nut, screw = (
            Contact(self.pitch_radius, self.h, self.ball + excess, groove, angle, side)
            for groove, side in zip(self.grooves, (1, -1), strict=True)
        )
        return nut, screw

    def loads(self, rises: Floats) -> Loads:
        """Return the ball loads for given temperature rises of nut, screw and balls."""
        of_nut, of_screw, of_balls = EXPANSION * rises[:3]
        excess = self.ball * (of_balls - 0.5 * (of_nut + of_screw))
        gap = self.pitch_radius * (of_nut - of_screw)
        contacts = self.contacts(0.0, self.angle)
        stiffness = sum(contact.stiffness ** (-2 / 3) for contact in contacts) ** -1.5
        reach = sum(groove - self.ball for groove in self.grooves)
        cos = math.cos(self.lead_angle)

        def at(shift: float) -> Loads:
            # (U5), from the point of view of the flank that the ball touches, and (J10) to (J13).
            along = cos * (0.5 * self.offset + self.way * ((of_nut - of_screw) * self.z + shift))
            line_b, line_n = reach * math.sin(self.angle) + along, reach * math.cos(self.angle) - gap
            line = np.hypot(line_b, line_n)
            approach = np.maximum(line - (reach - 2 * excess), 0.0)
            normal, part = stiffness * approach**1.5, line_b / line
            slopes = 1.5 * stiffness * approach**0.5 * part**2 + normal / line * (1 - part**2)
            return Loads(normal, normal * part * cos, float(slopes.sum()) * cos**2, excess, gap)

        low, high = -1e-4, 1e-4
        for _ in range(200):
            shift = 0.5 * (low + high)
            low, high = (low, shift) if np.dot(self.way, at(shift).axial) > 0.0 else (shift, high)
        return at(shift)

    def ball_friction(self, force: float, excess: float, gap: float, oil: Oil) -> tuple[float, float, float]:
        """Return the power that a rolling ball loses at the nut and at the screw [W], and its load on the screw [N]."""
        radius = self.ball + excess
        reach = sum(groove - self.ball for groove in self.grooves)
        # (U21)
        angle = math.acos((reach * math.cos(self.angle) - gap) / (reach - 2 * excess))
        contacts = self.contacts(excess, angle)
        nut, screw = contacts
        lead, d = self.lead_angle, self.pitch_radius / math.cos(self.lead_angle)
        mass = DENSITY * 4 / 3 * math.pi * radius**3
        radial = (nut.offset + screw.offset) * math.cos(angle)
        beta_nut = beta_screw = angle
        for _ in range(100):
            # (W4) with the nut as the controlling raceway, followed by (W12) and (W13), with the mean cotangent.
            rate = (1 - radius / d * math.cos(lead) * math.cos(beta_screw)) / (1 + math.cos(beta_nut - beta_screw))
            spread = mass * self.pitch_radius * (rate * self.speed) ** 2 * math.cos(lead) / force
            low, high = 0.0, 10.0
            for _ in range(55):
                cot = 0.5 * (low + high)
                loads = [force / math.cos(lead) * math.sqrt(1 + (cot + add) ** 2) for add in (spread, 0.0)]
                lines = [of.offset + of.unit_approach * q ** (2 / 3) for of, q in zip(contacts, loads, strict=True)]
                angles = [math.atan2(1.0, cot + add) for add in (spread, 0.0)]
                closes = sum(line * math.cos(beta) for line, beta in zip(lines, angles, strict=True)) - radial
                low, high = (low, cot) if closes > 0 else (cot, high)
            change = abs(angles[0] - beta_nut) + abs(angles[1] - beta_screw)
            beta_nut, beta_screw = angles
            if change < 1e-13:
                break
        # (W3), (W5)
        axis = np.array([math.sin(lead), 0.0, math.cos(lead)])
        spin = -rate * d / radius
        omega = self.speed * np.array([0.5 * math.sin(lead), -spin * math.sin(beta_nut), spin * math.cos(beta_nut)])
        precession = rate * self.speed
        powers = [
            self.contact_power(contact, load, beta, (omega, precession, body * axis, d, body), oil)
            for contact, load, beta, body in zip(contacts, loads, angles, (0.0, self.speed), strict=True)
        ]
        return powers[0], powers[1], loads[1]

    def contact_power(
        self,
        contact: Contact,
        load: float,
        beta: float,
        motion: tuple[Floats, float, Floats, float, float],
        oil: Oil,
    ) -> float:
        """Return the power lost by sliding and rolling at a contact [W]."""
        omega, precession, body_omega, d, body = motion
        radius = contact.ball
        along, normal = np.array([1.0, 0.0, 0.0]), contact.side * np.array([0.0, math.cos(beta), math.sin(beta)])
        across = np.array([0.0, -math.sin(beta), math.cos(beta)])
        relative = omega - body_omega
        axis = np.array([math.sin(self.lead_angle), 0.0, math.cos(self.lead_angle)])
        a = contact.unit_axis * load ** (1 / 3)
        b = a / contact.ratio
        pressure = 3 * load / (2 * math.pi * a * b)
        # (Y14)
        creep = CREEP * radius * self.speed
        point = -radius * normal
        of_ball = dot(np.cross(omega - precession * axis, point), along)
        of_body = (precession - body) * (d + dot(np.cross(axis, point), along))
        entrainment_t = 0.5 * (of_ball - of_body)
        entrainment = math.hypot(entrainment_t, creep)
        # (Y6) to (Y9)
        modulus, r_x = 2 * MODULUS, 1 / contact.along
        film = 2.69 * r_x * (oil.viscosity * entrainment / (modulus * r_x)) ** 0.67 * (oil.alpha * modulus) ** 0.53
        dimensionless = load / (modulus * r_x**2)
        film *= dimensionless**-0.067 * (1 - 0.61 * math.exp(-0.73 * contact.ratio))
        inlet = oil.viscosity * oil.thinning * entrainment**2 / OIL_CONDUCTIVITY
        thermal = 1 / (1 + 0.254 * inlet**0.62)
        film *= thermal
        asperities = math.exp(-1.4 * film / self.roughness)
        # (E2), (E3)
        surface = 2 * contact.groove * radius / (contact.groove + radius)
        x, y = a * DISK_X, b * DISK_Y
        height = radius - x**2 / (2 * surface)
        points = -np.outer(height, normal) + np.outer(x, across) + np.outer(y, along)
        slip = d * (precession - body) * along + np.cross(relative, points)
        # Only the components in the plane of the contact slide.
        squared = (slip @ along) ** 2 + (slip @ across) ** 2
        speed = np.sqrt(squared + creep**2)
        # (Y10) to (Y13)
        p = pressure * PRESSURE
        eyring = 2 * LIMITING_SHEAR * (oil.pressure_scale + PRESSURE_SLOPE * pressure)
        thickened = oil.viscosity * np.exp(p / (oil.pressure_scale + PRESSURE_SLOPE * p))
        stress = eyring * np.arcsinh(thickened * speed / (film * eyring))
        fluid = LIMITING_SHEAR / (1 + (LIMITING_SHEAR * p / stress) ** 4) ** 0.25
        friction = asperities * BOUNDARY + (1 - asperities) * fluid
        sliding = load * float((SHARE * friction * squared / speed).sum())
        # (Y15) to (Y21)
        k = 1 / contact.ratio
        form = 4 / math.pi * contact.e / (1 + contact.across / contact.along)
        u_2 = 2 * oil.viscosity * entrainment / (modulus * r_x)
        m = form**0.25 * k * dimensionless * u_2**-0.75
        rigid = 1.8 * form**-0.25
        bracket = (0.77 * form ** (-1 / 3) * k**0.12 * u_2 ** (-1 / 12) - rigid) / (1 + m / 6.6) + rigid
        rolling = ROLLING_FACTOR * thermal * modulus * r_x**2 * 2 * a / r_x * bracket * u_2**0.75
        couple = 2 * rolling * r_x + 3 / 16 * HYSTERESIS * load * b
        force = (2 * r_x / radius - 1) * rolling * entrainment_t / entrainment * along
        omega_x = dot(relative, across)
        moment = -couple * omega_x / math.hypot(omega_x, creep / radius) * across
        center = d * (precession - body) * along + np.cross(relative, point)
        return sliding - dot(force, center) - dot(moment, relative)

    def heat(self, rises: Floats, *, limited: bool) -> Floats:
        """Return the heat generated at the nut, the screw, the balls and both ends [W] (I13), (I14)."""
        kelvin = 20 + CELSIUS + 0.5 * rises[2] + 0.25 * (rises[0] + rises[1])
        oil = Oil(kelvin)
        found = self.loads(rises)
        forces = found.axial
        arm = math.hypot(self.pitch_radius, self.h)
        at_nut = at_screw = 0.0
        # Balls at mirrored positions in both nuts carry the same load.
        for force in forces[: len(forces) // 2]:
            if force == 0.0:
                continue
            nut, screw, load = self.ball_friction(force, found.excess, found.gap, oil)
            part = 1.0
            if limited:
                # (U33)
                most = BOUNDARY * load * arm * self.speed
                share = (nut + screw) / most
                if share > 0.5:
                    part = (0.5 + 0.5 * math.tanh(2 * share - 1)) / share
            at_nut += 2 * part * nut
            at_screw += 2 * part * screw
        drag = self.drag * forces[self.way > 0].sum() * self.speed
        bearing = 0.5 * self.bearings * self.speed
        of_seal = self.seal * self.speed
        of_balls = 0.5 * (at_nut + at_screw) + drag
        return np.array([0.5 * at_nut, 0.5 * at_screw + of_seal, of_balls, bearing, bearing])

    def fin(self) -> tuple[float, float, float]:
        """Return the screw conductance per length [W/(m K)], and wave number [1/m] and length [m] of the fin (I7)."""
        of = self.conductances
        given = of["screw_film_W_m2K"] * math.pi * 2 * self.pitch_radius + of["coolant"] / self.between
        return given, math.sqrt(given / (CONDUCTIVITY * self.section)), 0.5 * (self.between - self.length)

    def matrix(self) -> Floats:
        """Return the heat that leaves the nodes per kelvin [W/K], at constant surrounding temperatures (I7), (I8)."""
        of, (given, m, length) = self.conductances, self.fin()
        near, far = (given / m / of_length(m * length) for of_length in (math.tanh, math.sinh))
        matrix = np.diag([of["nut"], given * self.length + 2 * (near - far), 0.0, *[near - far + of["end"]] * 2])
        links = (0, 1, of["gap"]), (0, 2, of["ball_nut"]), (1, 2, of["ball_screw"]), (1, 3, far), (1, 4, far)
        for i, k, conductance in links:
            matrix[[i, k], [i, k]] += conductance
            matrix[[i, k], [k, i]] -= conductance
        return matrix

    def growth(self, rises: Floats) -> float:
        """Return the thermal growth of the screw [m] (I16)."""
        _, m, length = self.fin()
        ends = 2 * rises[1] + rises[3] + rises[4]
        return EXPANSION * float(self.length * rises[1] + math.tanh(m * length / 2) / m * ends)

    def life(self, found: Loads) -> float:
        """Return the life [revolutions] (U22) to (U24)."""
        damage = 0.0
        for body in (1.0, -1.0):
            loads = found.normal[self.way == body]
            for rating, p in zip(self.ratings, (10 / 3, 3), strict=True):
                per_ball = rating / (len(loads) * math.sin(self.angle) * math.cos(self.lead_angle))
                damage += float(per_ball / np.mean(loads**p) ** (1 / p)) ** (-10 / 3)
        return float(1e6 * damage**-0.9)

    def slopes(self, rises: Floats, *, limited: bool) -> Floats:
        """Return the derivatives of heat with respect to temperature [W/K], from central differences of 2 mK."""
        slopes = np.zeros((5, 5))
        for node in range(3):
            step = np.zeros(5)
            step[node] = 2e-3
            ends = [self.heat(rises + way * step, limited=limited) for way in (1, -1)]
            slopes[:, node] = (ends[0] - ends[1]) / 4e-3
        return slopes

    def steady(self, *, limited: bool) -> dict[str, float]:
        """Return the steady state. The results have the same names as in the reference cases."""
        matrix = self.matrix()
        inverse = np.linalg.inv(matrix)
        rises: Floats = np.zeros(5)
        change: Floats = np.ones(5)
        # The heat decreases as the preload is lost, so full steps would overshoot.
        while np.abs(change).max() > 0.1:
            change = inverse @ self.heat(rises, limited=limited) - rises
            rises = rises + 0.5 * change
        jacobian = matrix - self.slopes(rises, limited=limited)
        while np.abs(change).max() > 1e-8:
            left = self.heat(rises, limited=limited) - matrix @ rises
            change = np.asarray(np.linalg.solve(jacobian, left), dtype=np.float64)
            rises = rises + change
        heat, found = self.heat(rises, limited=limited), self.loads(rises)
        preload = float(found.axial[self.way > 0].sum())
        names = ("nut", "screw", "balls", "end_1", "end_2")
        return {
            **{f"{name}_temperature_C": 20 + float(rise) for name, rise in zip(names, rises, strict=True)},
            "lubricant_temperature_C": 20 + float(rises @ [0.25, 0.25, 0.5, 0, 0]),
            "warm_preload_N": preload,
            "heat_W": float(heat.sum()),
            "nut_heat_W": float(heat[:3].sum()),
            "screw_growth_um": 1e6 * self.growth(rises),
            "loop_gain": float(np.linalg.eigvals(inverse @ self.slopes(rises, limited=limited)).real.max()),
            "contact_torque_Nm": 2 * float(heat[0] + heat[1] - self.seal * self.speed) / self.speed,
            "extra_drag_Nm": self.drag * preload,
            "max_contact_load_N": float(found.normal.max()),
            "nut_stiffness_N_um": 1e-6 * found.stiffness,
            "life_revolutions": self.life(found),
        }
