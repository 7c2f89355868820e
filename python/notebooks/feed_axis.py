# %% [markdown]
# # Feed axis: which screw moves 10 kN at 30 m/min?
#
# A horizontal axis of a machine tool moves 500 kg over a stroke of 1.2 m against a force of 10 kN. The feed is 30
# m/min, and the required life is 20 000 hours. Which screw is sufficient, and which rule limits its size? How could the
# screw be lighter or generate less heat?

# %%
import matplotlib.pyplot as plt
import numpy as np

import ballscrew as bs

requirement = {
    "axial_load_kN": 10,
    "feed_m_min": 30,
    "stroke_mm": 1200,
    "required_life_h": 20000,
    "moved_mass_kg": 500,
    "guide_friction": 0.01,
    "support": "fixed-supported",
    "support_bearing_stiffness_N_um": 1000,
    "support_bearing_torque_Nm": 0.5,
    "seal_torque_Nm": 0.3,
    "motor_inertia_kg_m2": 0.01,
    "speed_number_limit_mm_min": 120000,
    "friction_coefficient": 0.06,
    "model": "raceway-control",
    "objective": "mass",
}
design = bs.select(requirement)
screw = design.case
print(f"size         {screw.nominal_diameter_mm:g} x {screw.lead_mm:g} mm")
print(f"balls        {screw.ball_diameter_mm:g} mm, {screw.loaded_turns:g} loaded turns")

# %% [markdown]
# `select` checks every size in the catalogs of THK and HIWIN against the rules of `axis`. It chooses the lightest screw
# that satisfies all rules. The result is a case that all other functions accept.
#
# ## Which rule limits the screw?

# %%
axis = bs.axis(screw)
rules = sorted(axis.rules, key=lambda rule: -rule.margin)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.barh([rule.rule for rule in rules], [rule.margin for rule in rules])
axes.axvline(1, color="black", linewidth=0.8)
axes.set_xscale("log")
axes.set_xlabel("margin: allowed / actual value, or actual / required value")
plt.show()

# %% [markdown]
# The screw satisfies a rule if the margin is at least 1. The margins of speed number and life are close to 1. Buckling,
# static safety and core stress have large margins, so a thicker core would not help. Each rule states its source and,
# if the screw violates the rule, a remedy.

# %%
for rule in rules[-3:]:
    limit = f"{rule.must_be} {rule.limit:.6g} {rule.unit}"
    print(f"{rule.rule}: {rule.value:.6g} {limit}, {rule.source}")

# %% [markdown]
# How much faster can the axis run? `fit` with `limit` finds the range of an input in which the axis satisfies a rule.

# %%
for limit in ("speed number", "life", "critical speed"):
    kept = bs.fit(screw, limit=limit, inputs="feed_m_min").kept
    print(f"{limit:15} holds up to {kept[-1][1]:.1f} m/min")

# %% [markdown]
# ## What must the motor supply?

# %%
names = ["motor_speed_rpm", "peak_motor_torque_Nm", "inertia_ratio", "mean_heat_W"]
names += ["steady_temperature_rise_K", "axis_stiffness_N_um", "cycle_life_h"]
for name in names:
    print(f"{name:28} {getattr(axis, name):10.5g} {bs.OUTPUTS[name].unit}")

# %% [markdown]
# ## Are other sizes better?
#
# Manufacturers' catalogs contain few sizes. The list of standard sizes combines all standard diameters, leads, ball
# diameters and turns, so it shows the trade-off between mass and heat. Each point is a screw that satisfies all rules.

# %%
nuts = bs.select_nuts("standard", requirement=requirement)
mass = nuts["nut_mass_kg"] + nuts["screw_mass_kg"]
heat = nuts["mean_heat_W"]
order = np.lexsort((heat, mass))
best = order[np.diff(np.minimum.accumulate(heat[order]), prepend=np.inf) < 0]

figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
dots = axes.scatter(mass, heat, c=nuts["lead_mm"], s=9, rasterized=True)
axes.step(mass[best], heat[best], "k", where="post", label="no screw is better in both")
steps = {step.name: step.value for step in design.steps}
chosen = steps["mass_of_nut_and_screw_kg"], axis.mean_heat_W
axes.plot(*chosen, "r*", markersize=15, label="chosen from catalogs")
figure.colorbar(dots, label="lead [mm]")
axes.set(xlabel="mass of nut and screw [kg]", ylabel="mean heat [W]")
axes.legend()
plt.show()

# %% [markdown]
# A screw with a small lead must turn fast, so the friction torque of seals and support bearings generates more heat. A
# large lead halves the heat but requires more motor torque:

# %%
names = [
    "nominal_diameter_mm",
    "lead_mm",
    "mean_heat_W",
    "peak_motor_torque_Nm",
    "cycle_life_h",
]
nuts[best[::2]][names]

# %% [markdown]
# `nuts.case(row)` returns the nut of a row as a case for `bs.axis` and `bs.nut`. `bs.axis(screw, figures="sheet")`
# writes a calculation sheet of two pages.
#
# ## Limits
#
# * A standard size is a combination of standard dimensions. Ask a manufacturer whether a nut of this size is available.
# * Life, stiffness and critical speed are calculated with rules of ISO 3408 and of manufacturers, which are
#   conservative to different degrees. The temperature rise is calculated from estimated conductances; its uncertainty
#   is several tens of percent.
# * The calculation does not include wear, shocks, the control of the axis, or the bending of the screw due to its
#   weight. `axis.not_modeled` lists these effects.
# * [Choose and size a feed axis](../../docs/guide/axis.md) explains the sheet and all rules.
