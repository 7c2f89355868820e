"""Calculate the steady motion of the balls of a ball screw: loads, contact angles, slip, efficiency and torque.

>>> import ballscrew as bs
>>> screw = bs.Case(
...     ball_diameter_mm=6.35, pitch_circle_diameter_mm=41.5, lead_mm=20, contact_angle_deg=45,
...     nut_conformity=0.53, screw_conformity=0.53, friction_coefficient=0.06, axial_load_N=8000,
...     loaded_balls=70)
>>> answer = bs.solve(screw, screw_speed_rpm=1500)
>>> answer.model, round(answer.efficiency, 3)
('raceway-control', 0.986)
"""

from ballscrew import _api, _errors, _parts, plot
from ballscrew._api import *
from ballscrew._core import __version__
from ballscrew._errors import *
from ballscrew._parts import *

__all__ = ["__version__", "plot"]
__all__ += _api.__all__
__all__ += _errors.__all__
__all__ += _parts.__all__
