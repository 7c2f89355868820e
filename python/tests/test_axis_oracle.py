"""Compare every number of 500 random axes with an independent calculation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from axis_oracle import Axis

import ballscrew as bs

# Numbers that the oracle does not calculate: uncertainty bands, results for a single moment of the cycle, and results
# for a vertical axis that falls.
ELSEWHERE = {
    "back_driving_torque_Nm",
    "back_driving_torque_high_Nm",
    "back_driving_torque_low_Nm",
    "fall_acceleration_m_s2",
    "fall_speed_rpm",
    "inertia_at_screw_kg_m2",
    "screw_efficiency",
    "screw_growth_um",
    "screw_torque_Nm",
    "shortest_ramp_s",
    "steady_temperature_rise_high_K",
    "steady_temperature_rise_low_K",
    "steady_temperature_time_s",
    "stop_energy_J",
}

# Numbers of the thermal network, and numbers that depend on the force of restrained thermal expansion. The program
# evaluates the film coefficient of a ramp at four speeds and the oracle at twelve. The results differ by less than 1 %.
THERMAL = {
    "buckling_safety",
    "buckling_safety_of_support",
    "critical_speed_ratio",
    "critical_speed_warm_rpm",
    "end_1_rise_K",
    "end_2_rise_K",
    "free_growth_um",
    "nut_conductance_W_K",
    "nut_rise_K",
    "pretension_for_no_slack_K",
    "screw_film_W_m2K",
    "screw_rise_K",
    "screw_tension_N",
    "steady_temperature_rise_K",
    "support_bearing_load_N",
    "support_bearing_load_warm_N",
}

# The oracle integrates numerically between kinks that it finds by bisection. Both steps have errors of about 1e-12.
TOLERANCE = 1e-9


def drawn(random: np.random.Generator) -> dict[str, Any]:
    """Draw a random axis with a catalog screw of typical proportions."""

    def log(low: float, high: float) -> float:
        return float(np.exp(random.uniform(math.log(low), math.log(high))))

    def maybe(share: float) -> bool:
        return bool(random.uniform() < share)

    diameter = float(random.choice([12, 16, 20, 25, 32, 40, 50, 63]))
    lead = float(random.choice([4, 5, 8, 10, 16, 20, 25, 40]))
    stroke = log(100, 1500)
    nut_length = 3 * diameter
    dynamic = 30 * diameter**1.9 * float(random.uniform(0.5, 1.5))
    case: dict[str, Any] = {
        # The oracle does not use the groove geometry, so no groove inputs are drawn.
        "estimate_groove": False,
        "nominal_diameter_mm": diameter,
        "pitch_circle_diameter_mm": diameter * 1.04,
        "shaft_diameter_mm": diameter * 0.84,
        "lead_mm": lead,
        "screw_mass_kg_m": 0.0055 * diameter**2,
        "nut_outer_diameter_mm": 2 * diameter,
        "nut_length_mm": nut_length,
        "stroke_mm": stroke,
        "unsupported_length_mm": stroke + nut_length + 2.5 * lead + log(20, 200),
        "rated_dynamic_load_N": dynamic,
        "rated_static_load_N": 2.4 * dynamic,
        "support": str(random.choice(["fixed-free", "supported-supported", "fixed-supported", "fixed-fixed"])),
        "moved_mass_kg": log(10, 1000) if maybe(0.8) else 0.0,
        "inclination_deg": float(random.choice([0, 0, 30, 90])),
        "seal_torque_Nm": log(0.01, 0.5),
        "support_bearing_torque_Nm": log(0.01, 0.5),
        "motor_inertia_kg_m2": log(1e-5, 1e-2),
        "gear_ratio": float(random.choice([1, 1, 2, 3.5])),
    }
    if maybe(0.4):
        case["guide_friction"] = log(0.002, 0.1)
    if maybe(0.3):
        case["guide_force_N"] = log(5, 200)
    if maybe(0.3):
        case["gear_efficiency"] = float(random.uniform(0.8, 1.0))
    if maybe(0.3):
        case["coupling_inertia_kg_m2"] = log(1e-6, 1e-3)
    if maybe(0.4):
        case["preload_N"] = dynamic * float(random.uniform(0.02, 0.1))
    if maybe(0.2):
        case["load_factor"] = float(random.uniform(1.0, 1.5))
    if case["inclination_deg"] == 90 and maybe(0.4):
        case["counterbalance_N"] = log(10, 500)
    if maybe(0.2):
        case["screws_count"] = 2
        if maybe(0.5):
            case["screws_per_motor"] = 2
    case["cycle"] = cycle(random, lead, stroke, dynamic)
    return case


def cycle(random: np.random.Generator, lead: float, stroke: float, dynamic: float) -> list[dict[str, Any]]:
    """Draw random cycle entries of all kinds, with speeds up to 2000 rpm."""
    top = float(random.uniform(0.1, 1.0)) * 2 * lead
    entries: list[dict[str, Any]] = []
    for _ in range(int(random.integers(1, 6))):
        sign = float(random.choice([-1, 1]))
        feed = sign * top * float(random.uniform(0.1, 1.0))
        force = float(random.choice([0.0, 1.0, -1.0])) * dynamic * float(random.uniform(0.005, 0.15))
        # The times are so short that five entries stay within the stroke.
        time = float(random.uniform(0.2, 1.0)) * 0.15 * stroke * 60 / (1000 * top)
        kind = int(random.integers(0, 6))
        distance = sign * stroke * float(random.uniform(0.02, 0.15))
        if kind == 0:
            entries.append({"dwell_s": time})
        elif kind == 1:
            entries.append({"distance_mm": distance, "max_feed_m_min": abs(feed), "acceleration_m_s2": 1.0, "deceleration_m_s2": 2.5, "force_N": force})
        elif kind == 2:
            profile = str(random.choice(["trapezoidal", "triangular"]))
            entries.append({"distance_mm": distance, "time_s": 120 * abs(distance) / (1000 * top), "profile": profile, "force_N": force})
        elif kind == 3:
            entries.append({"time_s": time, "start_feed_m_min": feed, "end_feed_m_min": float(random.uniform(-1, 1)) * top, "force_N": force})
        elif kind == 4:
            entries.append({"time_s": time, "feed_m_min": feed, "force_N": force, "end_force_N": force + dynamic * float(random.uniform(-0.1, 0.1))})
        else:
            entries.append({"time_s": time, "feed_m_min": feed, "force_N": force})
    # The program rejects an axis without any load.
    if not any(entry.get("force_N") for entry in entries):
        entries.append({"time_s": 0.15 * stroke * 60 / (1000 * top), "feed_m_min": top, "force_N": 0.1 * dynamic})
    return entries


def test_results_of_500_random_axes_match_an_independent_calculation() -> None:
    random = np.random.default_rng(2026)
    compared: dict[str, int] = {}
    for place in range(500):
        case = drawn(random)
        expected = Axis(case).results()
        found = bs.axis(bs.Case(case)).to_dict()["results"]
        scales = {"N": expected["largest_load_N"], "Nm": expected["peak_motor_torque_Nm"], "W": expected["peak_motor_power_W"]}
        for name, value in found.items():
            if value is None or name in ELSEWHERE:
                continue
            assert name in expected, f"the oracle does not know {name}"
            scale = max(abs(expected[name]), 1e-6 * scales.get(name.rsplit("_", 1)[-1], 0.0))
            assert value == pytest.approx(expected[name], rel=0, abs=scale * (1e-2 if name in THERMAL else TOLERANCE)), (place, name, case)
            compared[name] = compared.get(name, 0) + 1
    assert sum(compared.values()) > 15_000
