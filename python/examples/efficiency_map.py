"""Draw an efficiency map over speed and load, and write a lookup table for a drive model.

The file runs as a script, and opens as a notebook in editors that support `# %%` cells. It writes its files to the
current folder.
"""

# %% Describe the screw. The name of each input ends with its unit.
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

# %% Solve a full grid on all cores. The last input varies fastest.
grid = bs.sweep(
    screw,
    vary={"screw_speed_rpm": bs.linspace(100, 6000, 60), "axial_load_N": bs.linspace(20, 2000, 40)},
    model="raceway-control",
    columns=["efficiency", "ball_torque_Nm", "axial_displacement_um", "onset_number"],
)
print(grid, grid.grid("efficiency").shape)

# %% Find the points at which the balls roll, which means that their skid onset number is below 0.1.
rolls = grid.grid("onset_number") < 0.1
print(f"the balls roll at {rolls.mean():.0%} of the points")

# %% Draw the map. Points without a result leave gaps.
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
bs.plot.heatmap(grid, "efficiency", ax=left)
bs.plot.curves(
    bs.sweep(
        screw,
        vary={"screw_speed_rpm": bs.linspace(100, 6000, 60), "axial_load_N": [2e3, 8e3, 2e4]},
        columns=["ball_torque_Nm"],
    ),
    "screw_speed_rpm",
    "ball_torque_Nm",
    by="axial_load_N",
    ax=right,
)
figure.savefig("efficiency_map.svg")

# %% Write a table of the torque as a function of load and speed for a drive model.
table = grid.to_pandas().pivot(index="axial_load_N", columns="screw_speed_rpm", values="ball_torque_Nm")
table.to_csv("torque.csv")
assert np.isfinite(table.to_numpy()).all()
