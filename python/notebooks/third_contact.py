# %% [markdown]
# # Third contact and drag: why is a preloaded nut hard to turn?
#
# The drag torque that catalogs state for preloaded nuts is several times the friction torque of two contacts per ball.
# What causes this difference, and what can a designer do about it?

# %%
import matplotlib.pyplot as plt
import numpy as np

import ballscrew as bs

pair = bs.Case(
    ball_diameter_mm=6.35,
    pitch_circle_diameter_mm=41.336,
    lead_mm=10,
    contact_angle_deg=45,
    nut_conformity=0.5203,
    screw_conformity=0.5203,
    youngs_modulus_GPa=206,
    friction_coefficient=0.09,
    loaded_turns=3,
    loaded_balls_per_turn=20,
    preload_N=3000,
    axial_load_N=3000,
    screw_speed_rpm=100,
)

# %% [markdown]
# The case describes a double nut with a preload of 3 kN. A friction coefficient of 0.09 is typical of a lubricated
# screw at 100 rpm, the speed at which manufacturers measure the drag torque.
#
# ## Two contacts or three?
#
# Friction perpendicular to the grooves pushes each ball sideways. In a gothic arch with little play, the ball then
# touches the far flank of its groove. The axial play determines whether this third contact exists.

# %%
names = [
    "running_preload_torque_Nm",
    "running_preload_torque_factor",
    "running_preload_torque_over_rule",
    "third_contact_balls",
    "largest_third_contact_load_N",
    "third_contact_torque_share",
]
nuts = bs.solve_many({"axial_play_um": [40.0, 10.0, 0.0]}, pair, columns=names)
nuts[["axial_play_um", *names]].to_pandas().set_index("axial_play_um").T.round(3)

# %% [markdown]
# The first column applies to a nut with large play. Its balls have two contacts, and its drag torque is only a fraction
# of the drag torque from the manufacturers' rule (`running_preload_torque_over_rule`). Without play (last column), all
# balls touch a third flank. This contact carries only a few newtons. However, its slip speed is the rolling speed of
# the ball, so it causes more than half of the torque. The drag torque is then close to the rule.
#
# `running_preload_torque_factor` is the drag torque coefficient $K_p$ in $T = K_p F_p l / 2 \pi$. According to the
# manufacturers' rule, $K_p = 0.05 / \sqrt{\tan \alpha}$, where $\alpha$ is the lead angle. The uncertainty of the rule
# is 20 to 50 %.
#
# ## One ball

# %%
ball = bs.solve(pair, preload_N=None, axial_play_um=0, model="traction")
loaded, third = ball.nut_normal_load_N, ball.third_contact_load_N
print(f"load:  {loaded:.1f} N at a loaded contact, {third:.1f} N at the third")
loaded, third = 1000 * ball.nut_slip_velocity_m_s, 1000 * ball.third_contact_slip_m_s
print(f"slip:  {loaded:.1f} mm/s at a loaded contact, {third:.1f} mm/s at the third")
print(f"share of the third contact in the loss: {ball.third_contact_power_share:.0%}")
print(f"play below which the third contact begins: {ball.threshold_play_um:.0f} um")

# %% [markdown]
# ## Friction and play

# %%
grid = bs.sweep(
    pair,
    vary={
        "friction_coefficient": bs.linspace(0.02, 0.14, 25),
        "axial_play_um": bs.linspace(0, 40, 17),
    },
    columns=["running_preload_torque_over_rule", "running_preload_torque_factor"],
)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
plays = grid.axes["axial_play_um"]
for friction in (0.06, 0.09, 0.12):
    row = np.argmin(np.abs(grid.axes["friction_coefficient"] - friction))
    factor = grid.grid("running_preload_torque_factor")[row]
    left.plot(plays, factor, label=f"friction coefficient {friction}")
rule = bs.nut(pair)["preload_torque_factor_rule"]
left.axhspan(0.5 * rule, 1.5 * rule, color="gray", alpha=0.15, linewidth=0)
left.axhline(rule, color="gray", linestyle="--", label="manufacturers' rule, 50 %")
left.set(xlabel="axial play [um]", ylabel="drag coefficient $K_p$", ylim=(0, None))
left.legend(fontsize="small")

over = grid.grid("running_preload_torque_over_rule").T
frictions = grid.axes["friction_coefficient"]
colors = {"cmap": "RdBu_r", "vmin": 0, "vmax": 2}
drawn = right.pcolormesh(
    frictions, plays, over, shading="gouraud", rasterized=True, **colors
)
lines = right.contour(frictions, plays, over, levels=[0.5, 1, 1.5], colors="black")
right.clabel(lines)
figure.colorbar(drawn, label="drag torque / torque by the rule")
right.set(xlabel="friction coefficient", ylabel="axial play [um]")
plt.show()

# %% [markdown]
# With increasing play, the drag torque falls until the balls lose the third contact. The torque is then constant, because
# only two contacts remain. With a larger friction coefficient, the balls lose the third contact at a larger play, because
# higher friction pushes the balls farther.
#
# Conclusions for a designer:
#
# * Ask the manufacturer for the play of the groove. A difference of about 20 um determines whether the drag torque is a
#   third of the value from the rule or the whole value.
# * A lower friction coefficient has two advantages: it reduces the friction of each contact, and the balls can lose the third
#   contact.
# * If a delivered nut is hard to turn although its preload is correct, the play may be too small.
#
# ## Limits
#
# * No manufacturer states the play of a double nut, and the friction coefficient has not been measured either. This
#   comparison is therefore a consistency check, not a validation. A friction coefficient of 0.10 to 0.12 reproduces two
#   published torques ([public measured data](../../docs/evidence/measured.md)).
# * A measured drag torque also includes ball returns, seals and contact between balls. The calculated values do not.
# * [All balls of a nut](../../docs/guide/nut.md) describes the inputs, and [theory
#   22](../../docs/theory/22-third-contact.md) derives the third contact.
