"""Calls that a type checker must reject. It reports comments that suppress no error. This file is never run."""

import ballscrew as bs

screw = bs.Case(lead_mm=20)
bs.Case(lead_mn=3)  # type: ignore[call-arg]
bs.Case(lead_mm="20")  # type: ignore[arg-type]
bs.solve(screw, model="rigit")  # type: ignore[arg-type]
bs.solve(screw, axial_lod_N=3.0)  # type: ignore[call-arg]
bs.solve_many({}, screw, columns=["efficency"])  # type: ignore[list-item]
bs.gradient({}, "efficency", ["lead_mm"])  # type: ignore[arg-type]
screw.lead_mn  # type: ignore[attr-defined]
screw.lead_mm = 3.0  # type: ignore[misc]
bs.axis(screw).critical_sped_rpm  # type: ignore[attr-defined]
bs.axis(screw).rules[0].margn  # type: ignore[attr-defined]
bs.fit(screw, "screw_torque_Nm", input="friction_coefficient")  # type: ignore[call-overload]
