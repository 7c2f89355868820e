"""Calls that a type checker must accept. This file is never run."""

import ballscrew as bs

screw = bs.Case(lead_mm=20, ball_diameter_mm=6.35)
answer = bs.solve(screw, model="rigid", axial_load_N=8000)
in_other_units = bs.solve(screw, model="rigid", axial_load_kN=8)
efficiency: float = answer.efficiency
lead: float | None = screw.lead_mm
table = bs.solve_many({"axial_load_N": [1e3, 2e3]}, screw, columns=["efficiency"])
sheet = bs.axis(screw)
critical_speed: float | None = sheet.critical_speed_rpm
margin: float | None = sheet.rules[0].margin
heat: float | None = sheet.phases[0].heat_W
life: float | None = bs.ratings(screw).rating_life_h
friction: list[float] = bs.fit(screw, {"screw_torque_Nm": 26.0}).fitted
deviation: float | None = bs.fit(screw, "screw_torque_Nm", points="t.csv").fitted["seal_torque_Nm"].standard_deviation
