//! The inputs. Case files, checks, the schema and the help texts are generated from one table.

use std::ops::{Index, IndexMut};

use bsm_dyn::VISCOSITY_GRADES;

use super::entries::CaseEntries;
use super::names::unknown_key;
use super::rules::PointNumbers;
use super::units::convert;
use crate::{CaseError, InputSet, Quantity};

/// Up to here every whole number is a double.
const MOST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Rule for a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Any finite number.
    Any,
    /// Greater than the bound.
    Above(f64),
    /// At least the bound.
    AtLeast(f64),
    /// Strictly between the bounds.
    Between(f64, f64),
    /// Between the bounds or one of them.
    Within(f64, f64),
    /// A whole number, at least the bound.
    Whole(f64),
    /// One of these numbers.
    OneOf(&'static [f64]),
}

impl Rule {
    /// Where a value is finite and satisfies the rule.
    #[inline(always)]
    pub fn holds<N: PointNumbers>(self, value: N) -> N::Mask {
        let finite = value.abs().lt(value.constant(f64::INFINITY));
        match self {
            Self::Any => finite,
            Self::Above(low) => finite & value.gt(value.constant(low)),
            Self::AtLeast(low) => finite & value.constant(low).le(value),
            Self::Between(low, high) => {
                value.gt(value.constant(low)) & value.lt(value.constant(high))
            }
            Self::Within(low, high) => {
                value.constant(low).le(value) & value.le(value.constant(high))
            }
            Self::Whole(low) => {
                let rest = value.zip(value, |value, _| value.fract());
                value.constant(low).le(value)
                    & value.le(value.constant(MOST_WHOLE))
                    & rest.le(value.constant(0.0))
            }
            Self::OneOf(numbers) => {
                let mut any = value.lt(value);
                for number in numbers {
                    let number = value.constant(*number);
                    any = any | value.le(number) & number.le(value);
                }
                any
            }
        }
    }

    /// Checks a value.
    ///
    /// * `key`: the name of what has it.
    ///
    /// # Errors
    ///
    /// [`CaseError::OutOfRange`].
    pub fn check(self, key: &str, value: f64) -> Result<(), CaseError> {
        if self.holds(value) {
            return Ok(());
        }
        Err(CaseError::out_of_range(key, value, self.describe()))
    }

    /// A value that it allows.
    pub(crate) fn checked(self, key: &str, value: f64) -> Result<f64, CaseError> {
        self.check(key, value).map(|()| value)
    }

    /// The rule as text, after "must be".
    pub fn describe(self) -> String {
        match self {
            Self::Any => "a finite number".to_owned(),
            Self::Above(low) => format!("a finite number > {low}"),
            Self::AtLeast(low) => format!("a finite number >= {low}"),
            Self::Between(low, high) => format!("between {low} and {high} (exclusive)"),
            Self::Within(low, high) => format!("from {low} to {high}"),
            Self::Whole(low) => format!("a whole number, {low} or more"),
            Self::OneOf(numbers) => {
                let words: Vec<_> = numbers.iter().map(f64::to_string).collect();
                format!("one of {}", words.join(", "))
            }
        }
    }
}

macro_rules! inputs {
    ($($group:literal {
        $($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*
    })*) => {
        /// One operating point in the vocabulary; every input is optional, a model asks for
        /// those that it needs.
        #[derive(Debug, Clone, Default, PartialEq)]
        #[expect(non_snake_case, reason = "names carry their unit as it is written")]
        pub struct Case {
            /// Free text.
            pub description: Option<String>,
            /// Entries besides numbers.
            pub nut: CaseEntries,
            $($(#[doc = $about] pub $name: Option<f64>,)*)*
        }

        /// All inputs, in the order of the documentation.
        pub const INPUTS: &[Quantity] = &[$($(Quantity {
            name: stringify!($name),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $about,
            title: $group,
            rule: $rule,
            default: $default,
            ..Quantity::WHOLE
        },)*)*];

        /// The key of an input: its place in [`INPUTS`] and in a [`Case`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "the names of the vocabulary")]
        pub enum InputKey {
            $($(#[doc = $about] $name,)*)*
        }

        impl InputKey {
            /// All inputs, in the order of the documentation.
            pub const ALL: [Self; INPUTS.len()] = [$($(Self::$name),*),*];
        }

        impl Case {
            /// The inputs that it has.
            pub fn given(&self) -> InputSet {
                let mut given = InputSet::default();
                $($(given.add(InputKey::$name, self.$name.is_some());)*)*
                given
            }
        }

        impl Index<InputKey> for Case {
            type Output = Option<f64>;

            #[inline]
            fn index(&self, key: InputKey) -> &Option<f64> {
                match key {
                    $($(InputKey::$name => &self.$name,)*)*
                }
            }
        }

        impl IndexMut<InputKey> for Case {
            #[inline]
            fn index_mut(&mut self, key: InputKey) -> &mut Option<f64> {
                match key {
                    $($(InputKey::$name => &mut self.$name,)*)*
                }
            }
        }
    };
}

impl InputKey {
    /// Its row of the table.
    #[inline]
    pub fn input(self) -> &'static Quantity {
        &INPUTS[self as usize]
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.input().name
    }

    /// The input of that name.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`] with the nearest name.
    pub fn named(name: &str) -> Result<Self, CaseError> {
        Self::known(name).ok_or_else(|| unknown_key(name))
    }

    fn known(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|key| key.name() == name)
    }

    /// The input that a name in any unit means, and the factor to the unit of the input: `axial_load_kN` is
    /// `axial_load_N` times 1000.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`] with the nearest name.
    pub fn in_unit(name: &str) -> Result<(Self, f64), CaseError> {
        Self::known_in_unit(name).ok_or_else(|| unknown_key(name))
    }

    /// [`in_unit`](Self::in_unit) where any other name will do too: a nearest name takes long to find.
    pub(crate) fn known_in_unit(name: &str) -> Option<(Self, f64)> {
        let given = || Some((Self::known(name)?, 1.0));
        let converted = || {
            let (own, factor) = convert(name, &INPUTS.iter().map(|input| input.name))?;
            Some((Self::known(own)?, factor))
        };
        given().or_else(converted)
    }
}

impl Case {
    /// The value of an input, given or following from others, or else its default.
    #[inline]
    pub fn value_or_default(&self, key: InputKey) -> Option<f64> {
        self[key].or_else(|| self.follows(key)).or(key.input().default)
    }

    /// The same, NaN where there is none.
    pub(crate) fn number(&self, key: InputKey) -> f64 {
        self.value_or_default(key).unwrap_or(f64::NAN)
    }
}

use Rule::{Above, Any, AtLeast, Between, OneOf, Whole, Within};

inputs! {
    "screw" {
        ball_diameter_mm ["mm" "D_w"] Above(0.0), None,
            "ball diameter";
        pitch_circle_diameter_mm ["mm" "D_pw"] Above(0.0), None,
            "pitch circle diameter; that of the ball centres";
        lead_angle_deg ["deg" "phi"] Between(0.0, 90.0), None,
            "lead angle; of the ball-centre helix, or give lead_mm";
        lead_mm ["mm" "P_h"] Above(0.0), None,
            "lead; axial advance per turn, or give lead_angle_deg";
        contact_angle_deg ["deg" "alpha"] Between(0.0, 90.0), None,
            "contact angle; 0 radial, 90 axial, unloaded in the elastic models";
        nut_running_contact_angle_deg ["deg"] Between(0.0, 90.0), None,
            "contact angle at the nut in motion, for slip with model raceway-control; found by the model unless given";
        screw_running_contact_angle_deg ["deg"] Between(0.0, 90.0), None,
            "contact angle at the screw in motion, for slip with model raceway-control; found by the model unless given";
        nut_conformity ["" "f_rn"] Above(0.5), None,
            "groove radius over ball diameter, nut";
        screw_conformity ["" "f_rs"] Above(0.5), None,
            "groove radius over ball diameter, screw";
    }
    "operating point" {
        friction_coefficient ["" "mu"] AtLeast(0.0), None,
            "Coulomb friction coefficient";
        rolling_friction_mm ["mm"] AtLeast(0.0), Some(0.0),
            "lever arm of rolling resistance";
    }
    "screw" {
        density_kg_m3 ["kg/m3"] Above(0.0), Some(7800.0),
            "density of the ball";
        youngs_modulus_GPa ["GPa" "E"] Above(0.0), Some(207.0),
            "Young's modulus of the raceways, and of the ball unless given for it";
        poisson_ratio ["" "nu"] Between(-1.0, 0.5), Some(0.3),
            "Poisson's ratio of the raceways, and of the ball unless given for it";
        ball_youngs_modulus_GPa ["GPa"] Above(0.0), None,
            "Young's modulus of the ball, if it differs from the raceways";
        ball_poisson_ratio [""] Between(-1.0, 0.5), None,
            "Poisson's ratio of the ball, if it differs from the raceways";
    }
    "operating point" {
        screw_speed_rpm ["rpm" "n"] Any, None,
            "speed of the screw about the axis; screw minus nut speed > 0 drives against the load, < 0 is back-driving";
        feed_m_min ["m/min"] Any, None,
            "velocity of the nut along the screw; in place of screw_speed_rpm, needs the lead";
        nut_speed_rpm ["rpm"] Any, Some(0.0),
            "speed of the nut about the axis";
        axial_load_N ["N" "F_a"] Above(0.0), None,
            "axial load on the nut; carried by all loaded balls together";
        loaded_balls ["" "Z"] AtLeast(1.0), None,
            "number of balls that share the load equally; loaded_balls_per_turn times loaded_turns, or those of the circuits, unless given";
    }
    "nut" {
        loaded_balls_per_turn ["" "z_1"] Above(0.0), None,
            "loaded balls per turn; for the load ratings of a nut, may be a fraction";
        loaded_turns ["" "i"] Above(0.0), None,
            "loaded turns; of a nut, for its load ratings, may be a fraction";
        preload_N ["N" "F_pr"] Above(0.0), None,
            "preload; axial force between the two nuts of a preloaded pair, or of oversize balls on either flank (preload_by)";
        preload_offset_um ["um"] Any, None,
            "axial offset of the two nuts of a pair against each other, in place of preload_N: > 0 pulls them together (X arrangement), < 0 pushes them apart (O)";
        ball_oversize_um ["um"] Any, None,
            "excess of the diameter of all balls over the one that just touches both flanks of a nut; < 0 is play";
        ball_deviation_sd_um ["um"] AtLeast(0.0), None,
            "standard deviation of the diameters of the balls of a nut, drawn with seed";
        seed [""] Whole(0.0), Some(0.0),
            "number that the random deviations of the balls follow from";
    }
    "screw" {
        starts [""] Whole(1.0), Some(1.0),
            "threads of the screw";
    }
    "nut" {
        circuits_count [""] Whole(1.0), Some(1.0),
            "circuits of balls that the loaded turns of a nut are divided into";
        gap_deg ["deg"] AtLeast(0.0), None,
            "arc without loaded balls between two circuits of one thread; up to the next whole turn unless given";
        phase_deg ["deg"] Any, Some(0.0),
            "angle along the helix by which each circuit is shifted against the one before, besides arc and gap";
        radial_gap_um ["um"] Any, Some(0.0),
            "radial gap between grooves and balls of a nut at rest";
        ball_gap_mm ["mm"] Above(0.0), None,
            "gaps between the balls of the loaded part of a circuit, all together, along the helix; with it the forces of balls that touch are calculated. A circuit of circuits may have its own";
        spacer_thickness_mm ["mm"] AtLeast(0.0), Some(0.0),
            "distance of two load balls that touch the same spacer; of spacer balls their diameter, with ball_contact_friction 0";
        return_push_N ["N"] AtLeast(0.0), None,
            "force on the last loaded ball with which the balls are pushed through the return, in place of return_entry_force_N and return_bend_deg";
        return_entry_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force with which a ball is pushed from the return into the loaded part";
        return_bend_deg ["deg"] AtLeast(0.0), Some(0.0),
            "angle of all bends of a return together, in which pushed balls press outwards";
        return_friction_coefficient [""] AtLeast(0.0), Some(0.1),
            "friction coefficient of the balls in the bends of a return";
        idle_ball_drag_N ["N"] AtLeast(0.0), Some(0.0),
            "force that moves a ball on which no load acts";
        reference_z_mm ["mm"] Any, None,
            "place on the axis to which displacements, side loads and moments of a nut belong; the middle of its balls unless given";
        radial_load_x_N ["N"] Any, None,
            "side load on the nut along x";
        radial_load_y_N ["N"] Any, None,
            "side load on the nut along y";
        moment_x_Nm ["N m"] Any, None,
            "moment on the nut about x";
        moment_y_Nm ["N m"] Any, None,
            "moment on the nut about y";
        radial_x_um ["um"] Any, None,
            "misalignment, side displacement along x at which the nut is held";
        radial_y_um ["um"] Any, None,
            "misalignment, side displacement along y at which the nut is held";
        tilt_x_urad ["urad"] Any, None,
            "misalignment, tilt about x at which the nut is held";
        tilt_y_urad ["urad"] Any, None,
            "misalignment, tilt about y at which the nut is held";
        guide_x_N_um ["N/um"] Above(0.0), None,
            "stiffness of the guides of the nut against side motion along x";
        guide_y_N_um ["N/um"] Above(0.0), None,
            "stiffness of the guides of the nut against side motion along y";
        guide_tilt_x_Nm_mrad ["N m/mrad"] Above(0.0), None,
            "stiffness of the guides of the nut against tilt about x";
        guide_tilt_y_Nm_mrad ["N m/mrad"] Above(0.0), None,
            "stiffness of the guides of the nut against tilt about y";
        nut_anchor_z_mm ["mm"] Any, None,
            "place on the axis where the force leaves the nut; or nut_anchor";
        screw_anchor_z_mm ["mm"] Any, None,
            "place on the axis where the force leaves the screw; or screw_anchor";
        nut_EA_N ["N"] Above(0.0), None,
            "Young's modulus times cross section of the nut; from its diameters unless given";
        screw_EA_N ["N"] Above(0.0), None,
            "Young's modulus times cross section of the screw; from its groove diameter unless given";
        screw_rating_N ["N"] Above(0.0), None,
            "dynamic load rating of the screw's side of one nut body; from the geometry unless given";
        nut_rating_N ["N"] Above(0.0), None,
            "dynamic load rating of the nut's side of one nut body; from the geometry unless given";
        nut_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature of the nut above the one at which it fits";
        screw_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature of the screw above the one at which it fits";
        ball_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature of the balls above the one at which they fit";
        thermal_expansion_um_m_K ["um/(m K)"] Above(0.0), Some(11.5),
            "coefficient of thermal expansion of nut, screw and balls";
        nut_outer_diameter_mm ["mm" "D_1"] Above(0.0), None,
            "outer diameter of the nut; for its stiffness and mass, pitch circle + 4 ball diameters unless given";
        nut_length_mm ["mm"] Above(0.0), None,
            "length of the nut set; one nut defaults to (loaded_turns + 3) lead_mm / starts, a pair to both nuts and nut_gap_mm, a nut with a shifted lead to (2 loaded_turns + 4) lead_mm / starts";
    }
    "screw" {
        groove_bottom_distance_mm ["mm"] Above(0.0), None,
            "radial distance of the bottoms of the groove arcs of nut and screw, half the difference of their core diameters; gives the contact angle of a nut's ratings in place of contact_angle_deg";
        axial_play_um ["um"] AtLeast(0.0), None,
            "axial play of one nut without preload; below the threshold play the balls touch a far flank, too. Without it they have two contacts, and the thread has no play: 0 is a gothic arch that balls at rest touch at four points";
        nut_bore_mm ["mm"] Above(0.0), None,
            "diameter of the land of the nut; for its mass and the ends of its flanks, pitch circle + 1.5 mm unless given, for balls below 3 mm + half a ball";
        screw_outer_diameter_mm ["mm" "d_1"] Above(0.0), None,
            "outer diameter of the screw; for the ends of its flanks, pitch circle - 1.5 mm unless given, for balls below 3 mm - half a ball";
    }
    "axis" {
        speed_number_limit_mm_min ["mm/min"] Above(0.0), None,
            "largest speed number, pitch circle diameter times speed, that the ball return permits; that of screw_make unless given";
    }
    "nut" {
        raceway_yield_strength_MPa ["MPa"] Above(0.0), None,
            "yield strength of the raceways, for the margin of the contacts against yield";
        ball_yield_strength_MPa ["MPa"] Above(0.0), None,
            "yield strength of the balls, for the margin of the contacts against yield";
    }
    "lubricant" {
        lubricant_density_kg_m3 ["kg/m3"] Above(0.0), None,
            "density of the lubricant, at 15 C where it varies with temperature; that of base_oil unless given, for drag in jam none";
        drag_coefficient [""] AtLeast(0.0), None,
            "drag coefficient of a ball in the lubricant";
        iso_vg [""] OneOf(&VISCOSITY_GRADES), None,
            "viscosity grade of the lubricant, for one of viscosity index 95, unless viscosity_40C_mm2_s and viscosity_100C_mm2_s are given";
        viscosity_40C_mm2_s ["mm2/s"] AtLeast(1.0), None,
            "kinematic viscosity of the lubricant at 40 C, of a grease that of its base oil";
        viscosity_100C_mm2_s ["mm2/s"] AtLeast(0.5), None,
            "kinematic viscosity of the lubricant at 100 C, less than at 40 C";
        pressure_viscosity_1_GPa ["1/GPa"] Between(0.0, 200.0), None,
            "pressure-viscosity coefficient at the temperature of the lubricant; from viscosity and base_oil unless given";
        limiting_shear_ratio [""] Above(0.0), None,
            "largest shear stress of the lubricant over pressure; that of base_oil unless given";
        boundary_friction_coefficient [""] Above(0.0), Some(0.12),
            "friction coefficient where asperities touch; 0.09 with friction modifiers, 0.15 at the start";
        lubricant_temperature_C ["C"] Within(-40.0, 200.0), None,
            "temperature of the lubricant at the inlet of the contacts, unless heat_transfer_W_K and ambient_temperature_C are given";
        heat_transfer_W_K ["W/K"] Above(0.0), None,
            "heat that leaves the nut for each kelvin above ambient_temperature_C, in place of lubricant_temperature_C";
        ambient_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of the surroundings; preload_temperature_C for the warm state unless given";
        ball_roughness_um ["um"] Above(0.0), Some(0.02),
            "root mean square roughness of the balls, 1.25 times the arithmetic one: 0.01 to 0.03";
        nut_roughness_um ["um"] Above(0.0), Some(0.2),
            "root mean square roughness of the nut's groove: ground 0.1 to 0.3, run in half of it";
        screw_roughness_um ["um"] Above(0.0), Some(0.2),
            "root mean square roughness of the screw's groove: ground 0.1 to 0.3, run in half of it, rolled 0.3 to 0.6; 0.4 if screw_make is rolled";
        film_factor [""] Above(0.0), Some(1.0),
            "film thickness over that of plenty of lubricant; 0.7 (0.4 to 1) for grease";
        rolling_factor [""] AtLeast(0.0), Some(0.85),
            "rolling force of the lubricant over that of flooded inlets";
        hysteresis_loss [""] AtLeast(0.0), Some(0.01),
            "part of the elastic energy of the contacts that rolling loses, 0.003 to 0.034";
        seal_torque_Nm ["N m"] AtLeast(0.0), Some(0.0),
            "friction torque of the seals, stated or measured; felt wipers 0.02 to 0.3";
        ball_contact_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force between neighbouring balls, 0.1 to 1; 0 with spacer balls, calculated with ball_gap_mm";
        ball_contact_friction [""] AtLeast(0.0), None,
            "friction coefficient between balls, or of spacers on balls; boundary_friction_coefficient unless given, of dry balls friction_coefficient";
        return_circuits [""] AtLeast(0.0), Some(0.0),
            "number of ball returns that lose kinetic energy of the balls";
        return_loss_coefficient [""] AtLeast(0.0), Some(0.0),
            "kinetic energy that a ball loses in a return over its own, 1 to 4 for in and out";
    }
    "nut" {
        apex_half_angle_deg ["deg"] Between(0.0, 90.0), None,
            "half angle of the apex of the return curve, for jamming";
        return_angle_deg ["deg"] Between(0.0, 90.0), None,
            "angle between the return channel and the track of the screw at the steps between them, for jamming";
        step_normal_force_N ["N"] Above(0.0), None,
            "normal force of the step on the ball, for jamming; the impact force unless given";
        return_approach_speed_m_s ["m/s"] Above(0.0), None,
            "speed at which a ball enters the ball return, for jamming; its speed in the nut unless given";
        return_stiffness_N_um15 ["N/um^1.5"] Above(0.0), None,
            "Hertz stiffness of the impact on the ball return, for jamming; that of a ball on a flat of raceway material unless given";
        return_linear_stiffness_N_um ["N/um"] Above(0.0), None,
            "linear stiffness of the impact on the ball return, for jamming, in place of return_stiffness_N_um15";
        step_height_mm ["mm"] AtLeast(0.0), None,
            "height of the step over which a ball enters the ball return, for jamming";
    }
    "axis" {
        nominal_diameter_mm ["mm" "d_0"] Above(0.0), None,
            "nominal diameter of the screw; with lead_mm, rated_dynamic_load_N and rated_static_load_N enough for the axis of a screw whose groove is not known";
        screw_mass_kg_m ["kg/m"] Above(0.0), None,
            "mass of a metre of the screw, where its groove is not known; estimated unless given";
        nut_mass_kg ["kg"] Above(0.0), None,
            "mass of the nut as the manufacturer states it; calculated from its groove unless given";
        catalogue_efficiency [""] Within(0.01, 1.0), Some(0.9),
            "efficiency of the screw by its catalogue, where its groove is not known; usually 0.85 to 0.95";
        catalogue_back_efficiency [""] Within(0.01, 1.0), Some(0.8),
            "efficiency of the screw driven back by its catalogue, where its groove is not known; usually 0.75 to 0.85";
        rated_rigidity_N_um ["N/um" "K"] Above(0.0), None,
            "rigidity of the nut as the manufacturer states it, where its groove is not known; needs rated_rigidity_at";
        rated_dynamic_load_N ["N" "C_a"] Above(0.0), None,
            "dynamic load rating as the manufacturer states it, in place of the calculated one";
        rated_static_load_N ["N" "C_0a"] Above(0.0), None,
            "static load rating as the manufacturer states it, in place of the calculated one";
        stroke_mm ["mm"] Above(0.0), None,
            "stroke of the nut; the thread is longer by the length of the nut set and overrun_mm at each end";
        overrun_mm ["mm"] Above(0.0), None,
            "overrun of the thread beyond stroke and nut at each end; defaults to one lead";
        nut_gap_mm ["mm" "g"] AtLeast(0.0), None,
            "gap between the nuts of a pair; defaults to lead_mm / starts";
        unsupported_length_mm ["mm"] Above(0.0), None,
            "unsupported length of the screw, between its bearings; defaults to the length of the thread";
        shaft_diameter_mm ["mm"] Above(0.0), None,
            "shaft diameter for bending and buckling; the calculated core diameter of its thread unless given";
        screw_bore_mm ["mm" "d_b"] Above(0.0), None,
            "bore of a hollow screw";
        coolant_density_kg_m3 ["kg/m3"] AtLeast(0.0), Some(0.0),
            "density of what fills the bore of a hollow screw, for its critical speed";
        buckling_length_mm ["mm"] Above(0.0), None,
            "length of the screw that may buckle, between fixed bearing and nut; the unsupported length unless given";
        screw_inertia_kg_m2_m ["kg m2/m"] Above(0.0), None,
            "moment of inertia of a metre of the screw as the manufacturer states it; that of its section unless given";
        support_bearing_axial_load_N ["N"] Above(0.0), None,
            "largest axial load of the support bearings, for load, pretension and hindered growth together";
        pretension_N ["N" "F_v"] AtLeast(0.0), None,
            "tension of a screw between two fixed bearings when it is as warm as the bed";
        pretension_K ["K"] AtLeast(0.0), None,
            "temperature rise whose growth the pretension compensates, between two fixed bearings, usually 2 to 5; in place of pretension_N";
        moved_mass_kg ["kg"] AtLeast(0.0), Some(0.0),
            "mass that the axis moves on all its screws; its weight, friction and inertia are added to the axial load";
        inclination_deg ["deg"] Within(-90.0, 90.0), Some(0.0),
            "inclination of the axis: 0 level, 90 upwards along the feed";
        guide_friction [""] AtLeast(0.0), Some(0.0),
            "friction coefficient of the guides under the moved mass";
        guide_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force of the guides that does not follow the load, against the feed: seals, scrapers";
        motor_rated_speed_rpm ["rpm"] Above(0.0), None,
            "rated speed of the motor";
        motor_max_speed_rpm ["rpm"] Above(0.0), None,
            "largest speed of the motor; motor_rated_speed_rpm unless given";
        motor_rated_torque_Nm ["N m"] Above(0.0), None,
            "rated torque of the motor, for the mean over the cycle";
        motor_peak_torque_Nm ["N m"] Above(0.0), None,
            "peak torque of the motor";
        motor_rated_power_W ["W"] Above(0.0), None,
            "rated power of the motor";
        largest_inertia_ratio [""] Above(0.0), Some(10.0),
            "largest load-to-motor inertia ratio that is permitted; 3 to 10";
        counterweight_kg ["kg"] AtLeast(0.0), Some(0.0),
            "mass of a counterweight, which hangs on the vertical and moves with the axis";
        counterbalance_N ["N"] Any, Some(0.0),
            "force of a gas spring or cylinder along a positive feed, which relieves the screw of an upright axis";
        screws_count [""] Whole(1.0), Some(1.0),
            "number of screws that share the load of the axis";
        load_share ["" "x"] Within(0.01, 1.0), None,
            "share of the load on the most loaded screw; defaults to 1 over screws_count";
        screws_per_motor [""] Whole(1.0), Some(1.0),
            "number of screws that each motor drives";
        cycles_per_hour [""] Above(0.0), None,
            "number of cycles in an hour; standstill fills the time between the cycles";
        hold_force_N ["N" "F_c"] Any, None,
            "process force that acts at rest, besides the weight, positive against a positive feed; defaults to a force_N that is the same in all entries of the cycle, otherwise 0";
        stop_deceleration_m_s2 ["m/s2" "a"] Above(0.0), None,
            "deceleration with which the drive stops the axis after brake_delay_s, in place of brake_torque_Nm";
        brake_torque_Nm ["N m"] Above(0.0), None,
            "torque of the brake, at the motor";
        brake_delay_s ["s"] AtLeast(0.0), Some(0.05),
            "time until the brake acts";
        brake_safety [""] AtLeast(1.0), Some(1.5),
            "required ratio of brake_torque_Nm to the torque of the load at rest without friction";
        motor_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of the motor";
        coupling_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of what turns with the driven part, such as a coupling or a pulley";
        nut_inertia_kg_m2 ["kg m2" "J_n"] Above(0.0), None,
            "moment of inertia of a driven nut; defaults to that of a steel tube from the pitch circle to nut_outer_diameter_mm";
        gear_ratio [""] Above(0.0), Some(1.0),
            "turns of the motor for one of the screw";
        gear_efficiency [""] Within(0.01, 1.0), Some(1.0),
            "efficiency of the gear between motor and screw";
        gear_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of the gear, at the motor";
        support_bearing_torque_Nm ["N m"] AtLeast(0.0), Some(0.0),
            "friction torque of all support bearings together; of a driven nut that of its bearing";
        support_bearing_stiffness_N_um ["N/um"] Above(0.0), None,
            "axial stiffness of each support bearing; rigid unless given";
        housing_stiffness_N_um ["N/um"] Above(0.0), None,
            "axial stiffness of the housings of bearings and nut; rigid unless given";
        load_factor ["" "f_w"] Within(1.0, 5.0), Some(1.0),
            "factor of the load in life and equivalent load; 1 to 1.2 without shocks up to 0.25 m/s, 1.2 to 1.5 up to 1 m/s, 1.5 to 2 up to 2 m/s";
        hardness_HRC ["HRC"] Within(40.0, 66.0), None,
            "Rockwell hardness of the raceways; lowers the load ratings below 60";
        hardness_HV10 ["HV10"] Within(392.0, 865.0), None,
            "Vickers hardness of the raceways, in place of hardness_HRC; lowers the load ratings below 654";
        accuracy_factor ["" "f_ac"] Within(0.1, 1.0), None,
            "factor of accuracy of the load ratings; of calculated ones that of accuracy_grade, else 1 unless given";
        contamination_factor ["" "e_C"] Within(0.0, 1.0), None,
            "contamination factor of the lubricant, for the modified life, in place of contamination";
        reliability_percent ["%"] Within(90.0, 99.0), Some(90.0),
            "share of the nuts that reach the life";
        axis_heat_transfer_W_K ["W/K"] Above(0.0), None,
            "heat transfer to surroundings; of screw and nut, in place of the thermal network";
        useful_travel_mm ["mm" "l_u"] Above(0.0), None,
            "useful travel, over which accuracy_grade limits the error of the travel; stroke_mm unless given";
        required_travel_error_um ["um"] Above(0.0), None,
            "largest error of the travel that is permitted";
        required_life_h ["h" "L_h"] Above(0.0), None,
            "life that is required";
        required_static_safety ["" "f_s"] Above(0.0), Some(1.5),
            "static safety that is required";
        required_critical_speed_ratio [""] Above(0.0), Some(0.8),
            "permitted speed / critical speed";
        required_buckling_safety [""] Above(0.0), Some(2.0),
            "buckling load over the largest axial load that is required";
        extra_drag_factor [""] AtLeast(0.0), None,
            "drag beyond the contacts over the warm preload times the lead over 2 pi; by manufacturers' rule unless given";
    }
    "warm state" {
        preload_temperature_C ["C"] Within(-40.0, 150.0), Some(20.0),
            "temperature at which preload and fits are set";
        structure_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of what carries the bearings of the screw; ambient_temperature_C unless given";
        coolant_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of the coolant of screw and nut; ambient_temperature_C unless given";
        nut_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of nut and table to the air; 2 to 20, computed to a factor of 2 unless given";
        carriage_area_m2 ["m2"] Above(0.0), None,
            "surface of bracket and table in air; in place of nut_conductance_W_K, ten times that of the nut unless given";
        screw_film_W_m2K ["W/(m2 K)"] Above(0.0), None,
            "film coefficient of the screw in air; 10 to 60, computed to a factor of 1.4 unless given";
        gap_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of gap and wipers from nut to screw; 0.2 to 3, computed to a factor of 3 unless given";
        ball_nut_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of the contacts from balls to nut; computed to a factor of 2 unless given";
        ball_screw_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of the contacts from balls to screw; computed to a factor of 2 unless given";
        end_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of each bearing of the screw to the structure; 2 to 20, computed to a factor of 3 unless given";
        nut_coolant_conductance_W_K ["W/K"] AtLeast(0.0), Some(0.0),
            "conductance of the nut to a coolant; 20 to 60 of a cooled nut";
        coolant_flow_l_min ["l/min"] Above(0.0), None,
            "flow of coolant through the bore of the screw";
        coolant_conductance_W_K ["W/K"] Above(0.0), None,
            "conductance of the screw to the coolant; in place of coolant_flow_l_min";
        screw_tension_N ["N"] Any, Some(0.0),
            "tension of the screw, below 0 a compression; found by warm_state";
        motor_heat_W ["W"] AtLeast(0.0), Some(0.0),
            "heat that the motor gives to the end of the screw";
        steel_conductivity_W_m_K ["W/(m K)"] Above(0.0), Some(45.0),
            "thermal conductivity of the steel";
        fold_search_factor [""] Above(1.0), Some(2.0),
            "multiple of the speeds up to which the fold is looked for";
    }
}
