"""A ball screw as a functional mock-up unit (FMI 2.0, co-simulation) for drive simulators.

`python -m pythonfmu build -f fmu.py` builds BallScrew.fmu. The unit needs Python with `ballscrew` at run time. If
this file is run as a script, it builds the unit and, if FMPy is installed, simulates a start from standstill.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import ballscrew as bs

try:
    from pythonfmu import Fmi2Causality, Fmi2Slave, Real
except ImportError:
    sys.exit("pip install pythonfmu")

SCREW = bs.Case(
    ball_diameter_mm=6.35,
    pitch_circle_diameter_mm=41.5,
    lead_mm=20,
    contact_angle_deg=45,
    nut_conformity=0.53,
    screw_conformity=0.53,
    friction_coefficient=0.06,
    loaded_balls=70,
)
SLOWEST = 1.0
"""Smallest calculated speed [rpm]. The model needs moving balls, so this speed is used at lower speeds."""


class BallScrew(Fmi2Slave):  # type: ignore[misc, unused-ignore]
    """Inputs: speed of the screw and load on the nut. Outputs: torque at the screw, efficiency and heat."""

    author = "ballscrew"
    description = "Steady motion of the balls of a ball screw"

    def __init__(self, **keywords: object) -> None:
        super().__init__(**keywords)
        self.screw_speed_rpm = 1500.0
        self.axial_load_N = 8000.0
        self.ball_torque_Nm = 0.0
        self.efficiency = 1.0
        self.dissipated_power_W = 0.0
        for name in ("screw_speed_rpm", "axial_load_N"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("ball_torque_Nm", "efficiency", "dissipated_power_W"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Calculate one step. The motion of the balls is steady, so the outputs depend only on the current inputs."""
        speed = max(abs(self.screw_speed_rpm), SLOWEST) * (1.0 if self.screw_speed_rpm >= 0 else -1.0)
        answer = bs.solve(SCREW, screw_speed_rpm=speed, axial_load_N=max(self.axial_load_N, 1.0), check=False)
        if not answer.converged:
            return False
        self.ball_torque_Nm = answer.ball_torque_Nm
        self.efficiency = answer.efficiency
        self.dissipated_power_W = answer.dissipated_power_W * abs(self.screw_speed_rpm) / abs(speed)
        return True


def main() -> None:
    """Build the functional mock-up unit in the current folder, and simulate it."""
    from pythonfmu.builder import FmuBuilder

    with tempfile.TemporaryDirectory() as folder:
        script = Path(shutil.copy(__file__, Path(folder) / "ballscrew_fmu.py"))
        unit = FmuBuilder.build_FMU(script, dest=".")
    print(f"built {unit}")
    try:
        import fmpy
    except ImportError:
        return
    import numpy as np

    time = np.linspace(0.0, 1.0, 101)
    signals = np.array(
        [(t, 3000.0 * t, 8000.0) for t in time],
        dtype=[("time", float), ("screw_speed_rpm", float), ("axial_load_N", float)],
    )
    result = fmpy.simulate_fmu(str(unit), stop_time=1.0, step_size=0.01, output_interval=0.01, input=signals)
    torque = result["ball_torque_Nm"][-1]
    expected = bs.solve(SCREW, screw_speed_rpm=2970.0, axial_load_N=8000.0).ball_torque_Nm
    print(f"torque at the end {torque:.3f} N m")
    # The last step began one hundredth of a second before the end.
    assert abs(torque / expected - 1.0) < 1e-3, (torque, expected)


if __name__ == "__main__":
    main()
