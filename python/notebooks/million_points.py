# %% [markdown]
# # A million points: where does the screw skid?
#
# The balls of a screw roll under load, but skid at high speed and small load. Where is the boundary between rolling and
# skidding for a 40 x 20 mm feed drive? By how much does the efficiency fall beyond this boundary? Do the balls skid in
# a given work cycle?

# %%
import time

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
speeds, loads = np.geomspace(100, 6000, 1000), np.geomspace(100, 20000, 1000)
start = time.perf_counter()
grid = bs.sweep(
    screw,
    vary={"screw_speed_rpm": speeds, "axial_load_N": loads},
    columns=["efficiency", "onset_number", "dissipated_power_W"],
)
print(f"{len(grid):,} points in {time.perf_counter() - start:.0f} s")
print(f"{np.count_nonzero(~grid.ok)} points without a result")
grid

# %% [markdown]
# The program solves the grid on all cores. Each row has its own status. For each point, `auto` chooses the fastest
# model that is accurate to 1 %. Model `raceway-control` solves the points at which the balls roll, and more detailed
# models solve the points at which the balls begin to skid:

# %%
codes, counts = np.unique(grid.model.codes, return_counts=True)
for code, count in zip(codes, counts, strict=True):
    print(f"{grid.model.categories[code]:16} {count / len(grid):7.1%}")

# %% [markdown]
# ## The map

# %%
efficiency, onset = grid.grid("efficiency").T, grid.grid("onset_number").T

figure, axes = plt.subplots(figsize=(8, 5), layout="constrained")
# For a picture of this size, every fourth value is sufficient.
x, y, each = speeds[::4], loads[::4], np.s_[::4, ::4]
drawn = axes.pcolormesh(x, y, efficiency[each], shading="nearest", rasterized=True)
axes.contour(x, y, onset[each], levels=[0.1, 2], colors=["black", "white"])
axes.text(200, 3000, "rolling")
axes.text(1500, 190, "skid begins", color="white")
axes.text(5800, 108, "gross skid", color="white", ha="right")
figure.colorbar(drawn, label="efficiency")
axes.set(xscale="log", yscale="log")
axes.set(xlabel="screw speed [rpm]", ylabel="axial load [N]")
plt.show()

# %% [markdown]
# Each line connects points with the same skid onset number. The onset number compares the gyroscopic moment of a ball
# with the friction that can resist this moment. Above the black line (0.1), the balls roll, and the efficiency hardly
# depends on speed and load. Below the white line (2), the balls are in gross skid. Between the lines, the efficiency
# falls. The black line is therefore a conservative boundary. It has a step where the controlling raceway changes.
#
# Both lines rise steeply, because the gyroscopic moment increases with the square of the speed. At twice the speed, the
# balls need about three times the load to roll. The balls of a light axis can therefore skid at rapid traverse although
# they roll in every cut.

# %%
for speed in (1000, 2000, 4000):
    column = onset[:, np.argmin(np.abs(speeds - speed))]
    print(f"at {speed} rpm the balls roll above {loads[column < 0.1].min():.0f} N")

# %% [markdown]
# ## A work cycle in the map
#
# The map answers further questions without new calculations. For each phase of a cycle, the following code looks up the
# nearest point of the map.

# %%
data = grid.to_xarray()
cycle = {
    "rapid traverse": {"screw_speed_rpm": 3000, "axial_load_N": 150},
    "approach": {"screw_speed_rpm": 1500, "axial_load_N": 400},
    "roughing": {"screw_speed_rpm": 300, "axial_load_N": 9000},
    "finishing": {"screw_speed_rpm": 600, "axial_load_N": 1500},
}
for phase, inputs in cycle.items():
    point = data.sel(inputs, method="nearest")
    onset_number, heat = float(point["onset_number"]), float(point["dissipated_power_W"])
    print(f"{phase:15} onset number {onset_number:7.2g}, heat {heat:5.1f} W")

# %% [markdown]
# Rapid traverse at a small load generates more heat in the ball contacts than roughing does, because the balls skid.
#
# ## Limits
#
# * The map applies to a nut without preload. In a preloaded nut, the preload keeps the balls loaded, so they skid only
#   at much higher speeds. `bs.nut` calculates preloaded nuts.
# * The friction coefficient is constant. With a lubricant, the film determines the friction of skidding balls, and the
#   calculation of a million points takes minutes.
# * Larger tables can be written to a folder of files: see [a million points in
#   files](../../docs/guide/million-points.md) and [several machines](../../docs/guide/scale-out.md).
