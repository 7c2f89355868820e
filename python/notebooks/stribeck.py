# %% [markdown]
# # Stribeck curve and fit: how much friction does an oil cause?
#
# A screw is lubricated with mineral oil ISO VG 68. How does its friction depend on speed and temperature, and how can
# measured torques improve the calculation?

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
    loaded_balls=70,
    axial_load_N=8000,
    screw_speed_rpm=1500,
    iso_vg=68,
    base_oil="mineral",
    lubricant_temperature_C=40,
    ball_roughness_um=0.03,
    nut_roughness_um=0.2,
    screw_roughness_um=0.2,
)

# %% [markdown]
# Instead of a friction coefficient, the case contains an oil and the roughness of the surfaces. The temperature is the
# temperature of nut and balls, not the room temperature.
#
# ## The Stribeck curve

# %%
grid = bs.sweep(
    screw,
    vary={
        "lubricant_temperature_C": [20, 40, 60],
        "screw_speed_rpm": np.geomspace(5, 5000, 40),
    },
    columns=["equivalent_friction_coefficient", "nut_film_ratio", "nut_asperity_share"],
)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
x, by = "screw_speed_rpm", "lubricant_temperature_C"
bs.plot.curves(grid, x, "equivalent_friction_coefficient", by=by, ax=left)
bs.plot.curves(grid, x, "nut_film_ratio", by=by, ax=right)
left.set(xscale="log", ylim=(0, None))
right.set(xscale="log", yscale="log")
right.axhline(1, color="gray", linestyle=":", linewidth=1)
plt.show()

# %% [markdown]
# The equivalent friction coefficient is the coefficient of dry friction that would cause the same loss. At low speed,
# the film is thinner than the roughness (film ratio below 1), asperities carry the load, and boundary friction
# dominates. With increasing speed, the film separates the surfaces, and the friction falls to a minimum. At high speed,
# the rolling resistance of the oil increases the friction again. Cold oil has a higher viscosity, so the minimum occurs
# at a lower speed.
#
# If you need a constant friction coefficient, use the value at the speed that is most important for your application:

# %%
for temperature in (20, 40, 60):
    rows = grid[grid["lubricant_temperature_C"] == temperature]
    friction, speed = rows["equivalent_friction_coefficient"], rows["screw_speed_rpm"]
    least = np.nanargmin(friction)
    for at in (0, least, -1):
        print(f"{temperature} C, {speed[at]:4.0f} rpm: {friction[at]:.3f}")

# %% [markdown]
# ## How certain is the friction?
#
# The result for one operating point contains the 90 % interval that results from the uncertainties of viscosity,
# roughness, boundary friction and oil supply.

# %%
band = bs.solve(screw).to_dict()["band"]
for name, limits in band.items():
    print(f"{name:20} {limits['low']:.4g} to {limits['high']:.4g}")

# %% [markdown]
# The uncertainty of the contact loss is about 25 %. A measurement on your own screw reduces it.
#
# ## Fit to measured torques
#
# The following table has the format of a measurement, but its values are invented. Replace them with your measured
# points.

# %%
measured = {
    "screw_speed_rpm": [10, 100, 600, 1500, 3000, 600, 1500],
    "axial_load_N": [8000, 8000, 8000, 8000, 8000, 2000, 2000],
    "screw_torque_Nm": [26.29, 26.17, 26.08, 26.07, 26.19, 6.60, 6.62],
}
report = bs.fit(
    screw,
    "screw_torque_Nm",
    points=measured,
    inputs={"boundary_friction_coefficient": None, "seal_torque_Nm": (0, 1)},
)
for name, found in report.fitted.items():
    print(f"{name}: {found.value:.3f} +- {found.standard_deviation:.3f}")
print(f"condition number {report.condition:.0f}")
for message in report.warnings:
    print(message)

# %% [markdown]
# Two inputs explain all seven torques: the boundary friction coefficient, which determines the torque at low speed, and
# the torque of the seals, which is the same at every point. The standard deviations state how accurately the points
# determine these inputs. If the condition number exceeds a few thousand, the points do not determine the inputs.

# %%
values = {name: found.value for name, found in report.fitted.items()}
fitted = screw.replace(**values)
speeds = np.geomspace(5, 5000, 40)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
for load, color in ((8000, "C0"), (2000, "C1")):
    ideal = load * screw.lead_mm / 1000 / (2 * np.pi)
    for case, style, label in ((screw, ":", "before the fit"), (fitted, "-", "fitted")):
        points = {"screw_speed_rpm": speeds, "axial_load_N": load}
        curve = bs.solve_many(points, case, columns=["ball_torque_Nm"])
        friction = curve["ball_torque_Nm"] + (case.seal_torque_Nm or 0) - ideal
        axes.plot(speeds, friction, style, color=color, label=f"{load} N, {label}")
    at_load = np.equal(measured["axial_load_N"], load)
    friction = np.array(measured["screw_torque_Nm"])[at_load] - ideal
    at = np.array(measured["screw_speed_rpm"])[at_load]
    axes.plot(at, friction, "o", color=color, label=f"{load} N, measured")
axes.set(xscale="log", ylim=(0, None))
axes.set(xlabel="screw speed [rpm]", ylabel="friction torque [N m]")
axes.legend(ncols=2)
plt.show()

# %% [markdown]
# The picture shows the friction torque, which is the measured torque minus the torque $F l / 2 \pi$ that moves the
# load. Because this difference is small, the torque meter must be accurate: its error should be at most 2 % of the
# friction torque.
#
# ## Limits
#
# * The calculation does not include running-in, starting from rest, or contact between balls. It includes starvation
#   only through `film_factor`.
# * A fit cannot distinguish between two inputs that have similar effects at all measured points. Therefore, measure at
#   low and high speeds and at small loads.
# * [Friction from oil and a measured torque](../../docs/guide/friction-from-oil.md) compares the friction with
#   published data, and [theory 17](../../docs/theory/17-lubricant.md) derives it.
