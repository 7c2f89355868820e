# %% [markdown]
# # First answer: how much torque does a screw need?
#
# A feed drive moves a load of 8 kN with a 40 x 20 mm screw at 1500 rpm. How much torque does the screw need, how much
# of this torque is due to friction, and how reliable are these numbers?

# %%
import matplotlib.pyplot as plt
import numpy as np

import ballscrew as bs

screw = bs.Case(
    ball_diameter_mm=6.35,
    pitch_circle_diameter_mm=41.5,
    lead_mm=20,
    contact_angle_deg=45,
    nut_conformity=0.53,
    screw_conformity=0.53,
    friction_coefficient=0.06,
    loaded_balls=70,
)
answer = bs.solve(screw, axial_load_N=8000, screw_speed_rpm=1500)
print(f"torque      {answer.ball_torque_Nm:.2f} N m")
print(f"efficiency  {answer.efficiency:.4f}")
print(f"pressure    {answer.screw_max_pressure_MPa:.0f} MPa")

# %% [markdown]
# Each input is a keyword whose name ends with its unit. To use another unit, change this ending, for example to
# `axial_load_kN=8`. The conformity is the groove radius divided by the ball diameter. If you do not know the grooves of
# your screw, enter [the data of a catalog line](../../docs/guide/catalog-line.md) instead.

# %%
parts = answer.to_dict()["torque_parts"]
names = ["ideal", "contact_friction", "seal", "support_bearing"]
for name in names:
    print(f"{name.replace('_', ' '):18} {parts[name + '_torque_Nm']:7.3f} N m")

# %% [markdown]
# Nearly all of the torque moves the load. The first row, $F l / 2 \pi$, is the torque that a screw without friction
# would need. The friction of the balls adds little. The torques of seals and support bearings are 0, because this case
# does not contain them. In a real axis, these torques often exceed the friction of the balls. Therefore, add
# `seal_torque_Nm` and `support_bearing_torque_Nm` before you choose a motor.
#
# ## How accurate is the calculation?
#
# The program chose the model automatically, and `choice` states the reason. The error bound is an upper limit for the
# difference in efficiency between the chosen model and the most detailed model.

# %%
print(answer.regime, "|", answer.choice)
print("warnings:", answer.warnings)

# %% [markdown]
# The inputs are less certain than the model. Exact derivatives show which inputs have a large effect on the friction
# loss.

# %%
table = bs.sensitivities(answer.case)
efficiency = answer.efficiency
# The loss is 1 - efficiency, so its relative change is the relative change of the efficiency times -efficiency / loss.
effect = -table["efficiency_relative"] * efficiency / (1 - efficiency)
largest = np.argsort(-np.abs(np.nan_to_num(effect)))[:8][::-1]

figure, axes = plt.subplots(figsize=(8, 3.5), layout="constrained")
axes.barh([name.replace("_", " ") for name in table["input"][largest]], effect[largest])
axes.axvline(0, color="black", linewidth=0.8)
axes.set_xlabel("change of the friction loss per 1 % of the input [%]")
plt.show()

# %% [markdown]
# A positive bar means that a larger value of the input increases the loss. The loss is proportional to the friction
# coefficient, which is known at best to within a few tens of percent. The conformity of the nut has the longest bar,
# but its value is known much more accurately: a tolerance of 0.01 at 0.53 is an uncertainty of 2 %.
#
# Random inputs show how these uncertainties affect the torque. In this example, the friction coefficient is uncertain
# by a third.

# %%
points = bs.draw(
    {
        "friction_coefficient": bs.uniform(0.04, 0.08),
        "nut_conformity": bs.uniform(0.52, 0.54),
        "screw_conformity": bs.uniform(0.52, 0.54),
    },
    samples=2000,
)
sample = bs.solve_many(points, answer.case, columns=["ball_torque_Nm", "efficiency"])
for name in ("ball_torque_Nm", "efficiency"):
    low, middle, high = np.nanquantile(sample[name], [0.05, 0.5, 0.95])
    print(f"{name:15} {middle:.4g}, 90 % of the values from {low:.4g} to {high:.4g}")

# %% [markdown]
# The torque is known to within about 1 %, although the friction coefficient is much less certain. The reason is that
# most of the torque moves the load. The *loss*, and therefore the heat, is as uncertain as the friction coefficient.
#
# ## Is the efficiency the same at other loads and speeds?

# %%
grid = bs.sweep(
    screw,
    vary={"axial_load_N": [20, 200, 2000], "screw_speed_rpm": np.geomspace(100, 6000, 60)},
    columns=["efficiency", "efficiency_error_bound"],
)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
bs.plot.curves(
    grid,
    x="screw_speed_rpm",
    y="efficiency",
    by="axial_load_N",
    error="efficiency_error_bound",
    ax=axes,
)
axes.set_xscale("log")
plt.show()

# %% [markdown]
# As long as the balls roll, the efficiency hardly depends on speed and load. At small load and high speed, gyroscopic
# moments make the balls skid, and the efficiency drops. The bands show the error bounds. The notebook [A million
# points](million_points.py) draws a map of this transition.
#
# ## Limits
#
# * The calculation assumes steady motion, equal loads on all balls and a constant friction coefficient. [Stribeck curve
#   and fit](stribeck.py) calculates the friction of an oil, and `bs.nut` calculates the load of each ball.
# * The friction in the ball returns and the drag of the lubricant are not included. A preloaded nut has additional
#   drag, which [third contact and drag](third_contact.py) explains.
# * [Limits](../../docs/guide/limits.md) states where each model is valid.
