"""Select a screw for a requirement, and calculate the feed axis.

The file runs as a script, and opens as a notebook in editors that support `# %%` cells.
"""

# %% Describe the requirements for the feed axis.
import ballscrew as bs

requirement = {
    "axial_load_kN": 10,
    "feed_m_min": 30,
    "stroke_mm": 1200,
    "friction_coefficient": 0.06,
    "required_life_h": 20000,
    "speed_number_limit_mm_min": 120000,
    "support": "fixed-supported",
    "moved_mass_kg": 500,
    "motor_inertia_kg_m2": 0.01,
    "objective": "mass",
}

# %% Select the best screw from the sizes of manufacturers.
design = bs.select(requirement)
assert design.found, design.reasons
screw = design.case
print(screw)

# %% List the catalog nuts that meet all limits. The lightest nut comes first.
nuts = bs.select_nuts(requirement=requirement, sort="nut_mass_kg", first=5)
print(nuts.to_pandas()[["screw_root_diameter_mm", "ball_diameter_mm", "dynamic_load_rating_N", "nut_mass_kg"]])

# %% Check the rules for the feed axis. Each rule has a value and a limit.
axis = bs.axis(screw)
for rule in axis.rules:
    print(rule.name, rule.value, rule.limit, rule.passes)

# %% Calculate the loads of all balls of the nut.
nut = bs.nut(screw)
print(nut)
print(nut.balls.to_pandas().head())
