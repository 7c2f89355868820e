//! Keys of the lists and limits of a catalog.

use crate::Rule::{Above, AtLeast, Between, Within};
use crate::vocabulary::quantity::keys;

/// Smallest permitted length in a list \[mm\].
const MIN_LENGTH_MM: f64 = 1e-3;

keys! {
    /// Keys of the lists and limits of a catalog. The value of a key is a list of numbers, a range
    /// of two numbers, or a single number.
    pub LISTS of ListKey;
    nominal_diameter_mm ["mm" "d_0"] Within(MIN_LENGTH_MM, 1e4), None, "nominal diameters";
    lead_mm ["mm" "P_h"] Within(MIN_LENGTH_MM, 1e4), None, "leads";
    ball_diameter_mm ["mm" "D_w"] Within(MIN_LENGTH_MM, 1e3), None, "ball diameters";
    loaded_turns ["" "i"] Above(0.0), None, "loaded turns";
    nut_conformity ["" "f_rn"] Above(0.5), None, "groove radii of the nut divided by ball diameter; the same values apply to the screw";
    contact_angle_deg ["deg" "alpha"] Between(0.0, 90.0), None, "contact angles";
    largest_ball_over_lead [""] Above(0.0), None, "largest ball diameter divided by lead";
    smallest_ball_over_lead [""] AtLeast(0.0), None, "smallest ball diameter divided by lead, for leads up to 10 mm";
    ball_over_diameter_range [""] AtLeast(0.0), None, "smallest and largest ball diameter divided by nominal diameter";
    largest_ball_over_screw_root [""] Above(0.0), None, "largest ball diameter divided by root diameter of the screw";
    largest_ball_gap_over_ball [""] Between(0.0, 1.0), None, "largest gap between the balls of a turn divided by ball diameter";
    axial_play_um ["um"] AtLeast(0.0), None, "axial play of a nut without preload";
    turns_range ["" "i"] Above(0.0), None, "smallest and largest number of loaded turns";
    nut_conformity_range ["" "f_rn"] Above(0.5), None, "smallest and largest groove radius divided by ball diameter";
    youngs_modulus_GPa ["GPa" "E"] Above(0.0), None, "Young's modulus";
    poisson_ratio ["" "nu"] Between(0.0, 0.5), None, "Poisson's ratio";
    preload_over_dynamic_rating [""] Above(0.0), None, "preload of a pair divided by its dynamic load rating; defaults to 0.15 according to Sobolewski (2002), while the rule of `axis` permits 0.1";
    rolling_friction_mm ["mm"] Above(0.0), None, "lever arm of rolling resistance";
}
