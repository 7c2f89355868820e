# %% [markdown]
# # Third contact and drag: why is a preloaded nut hard to turn?
#
# For preloaded nuts, catalogs state a drag torque of several times the friction of two contacts per ball. What causes the
# difference, and what can a designer do about it?

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
# The case is a pair of nuts that are preloaded against each other with 3 kN. A friction coefficient of 0.09 is usual for
# a lubricated screw at 100 rpm, the speed at which manufacturers measure the drag.
#
# ## Two contacts or three?
#
# Friction across the grooves pushes each ball sideways. In a gothic arch with little play, the ball touches the opposite
# flank of its groove. The axial play decides whether this third contact exists.

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
# The first column is a nut with large play: its balls have two contacts, and its drag is a fraction of the drag that the
# manufacturers' rule predicts (`running_preload_torque_over_rule`). Without play, all balls touch a third flank. This
# contact carries only a few newtons, but it slides at the rolling speed of the ball, so it causes more than half of the torque.
# The drag is then close to the rule.
#
# `running_preload_torque_factor` is the drag coefficient $K_p$ in $T = K_p F_p l / 2 \pi$. The rule states
# $K_p = 0.05 / \sqrt{\tan \alpha}$ with the lead angle $\alpha$, with an accuracy of 20 to 50 %.
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
# As the play grows, the drag falls until the third contact opens. It is then constant, because two contacts remain. With a
# larger friction coefficient, the third contact opens at a larger play, because more friction pushes the balls further.
#
# For a designer this means:
#
# * Ask the manufacturer for the play of the groove. A difference of about twenty micrometers decides whether the drag is a
#   third of the value by the rule or the whole value.
# * A lower friction coefficient helps twice: it reduces the friction of each contact and opens the third contact.
# * If a delivered nut is hard to turn although its preload is correct, too little play is a plausible cause.
#
# ## Limits
#
# * No manufacturer states the play of the nuts of a pair, and the friction coefficient is not measured either. The
#   comparison is therefore a consistency check, not a validation. A coefficient of 0.10 to 0.12 reproduces two published
#   torques ([public measured data](../../docs/evidence/measured.md)).
# * Ball returns, seals and contact between balls add to the measured drag. These numbers do not include them.
# * [All balls of a nut](../../docs/guide/nut.md) describes the inputs, and [theory 22](../../docs/theory/22-third-contact.md)
#   derives the third contact.
