//! Inputs of a case. Case files, checks, the schema and help texts are generated from a single
//! table of inputs.

use std::ops::{Index, IndexMut};

use bsm_dyn::lubrication::VISCOSITY_GRADES;

use super::entries::CaseEntries;
use super::names::unknown_key;
use super::rules::Pointwise;
use super::units::{UnitChange, convert};
use crate::{CaseError, InputSet, Quantity};

/// Limit up to which double-precision numbers represent every nonnegative integer exactly.
pub const MAX_EXACT_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Rule that a value must satisfy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Any finite number is permitted.
    Any,
    /// The value must be greater than this bound.
    Above(f64),
    /// The value must be greater than or equal to this bound.
    AtLeast(f64),
    /// The value must be strictly between these two bounds.
    Between(f64, f64),
    /// The value must be between these bounds or equal to one of them.
    Within(f64, f64),
    /// The value must be an integer that is greater than or equal to this bound.
    Whole(f64),
    /// The value must be equal to one of these numbers.
    OneOf(&'static [f64]),
}

impl Rule {
    /// Returns a mask that is true for each value that is finite and satisfies the rule.
    #[inline(always)]
    pub fn holds<N: Pointwise>(self, value: N) -> N::Mask {
        let finite = value.abs().below(f64::INFINITY);
        match self {
            Self::Any => finite,
            Self::Above(low) => finite & value.above(low),
            Self::AtLeast(low) => finite & value.at_least(low),
            Self::Between(low, high) => value.above(low) & value.below(high),
            Self::Within(low, high) => value.at_least(low) & value.at_most(high),
            Self::Whole(low) => {
                let rest = value.zip(value, |value, _| value.fract());
                value.at_least(low) & value.at_most(MAX_EXACT_INTEGER) & rest.at_most(0.0)
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

    /// Checks that a value satisfies the rule.
    ///
    /// * `key`: name of the input or setting.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::OutOfRange`] if the value violates the rule.
    pub fn check(self, key: &str, value: f64) -> Result<(), CaseError> {
        if self.holds(value) {
            return Ok(());
        }
        Err(CaseError::out_of_range(key, value, self.describe()))
    }

    /// Returns the value if it satisfies the rule.
    pub(crate) fn checked(self, key: &str, value: f64) -> Result<f64, CaseError> {
        self.check(key, value).map(|()| value)
    }

    /// Describes the rule as a phrase that can follow "must be".
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

/// Group of inputs in the documentation and in forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InputGroup {
    /// Inputs of the screw and its balls.
    Screw,
    /// Loads, speeds and friction.
    OperatingPoint,
    /// Inputs of the nut and its circuits.
    Nut,
    /// Inputs of the lubricant.
    Lubricant,
    /// Inputs of the axis: bearings, motor, duty and requirements.
    Axis,
    /// Inputs of the warm steady state.
    WarmState,
}

impl InputGroup {
    /// Returns the title of the group.
    const fn title(self) -> &'static str {
        match self {
            Self::Screw => "screw",
            Self::OperatingPoint => "operating point",
            Self::Nut => "nut",
            Self::Lubricant => "lubricant",
            Self::Axis => "axis",
            Self::WarmState => "warm state",
        }
    }
}

macro_rules! inputs {
    ($($group:ident {
        $($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*
    })*) => {
        /// An operating point, given by named inputs with units. All inputs are optional. Each
        /// model states which inputs it requires.
        #[derive(Debug, Clone, Default, PartialEq)]
        #[expect(non_snake_case, reason = "the names end with units, and some unit symbols are capital letters")]
        pub struct Case {
            /// Description of the case as free text.
            pub description: Option<String>,
            /// Inputs other than single numbers.
            pub entries: CaseEntries,
            $($(#[doc = $about] pub $name: Option<f64>,)*)*
        }

        /// All inputs, in the order of the documentation.
        pub const INPUTS: &[Quantity] = &[$($(Quantity {
            name: stringify!($name),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $about,
            title: InputGroup::$group.title(),
            rule: $rule,
            default: $default,
            ..Quantity::WHOLE
        },)*)*];

        /// Key of an input, which is its index in [`INPUTS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "variant names match the input names in the vocabulary")]
        pub enum InputKey {
            $($(#[doc = $about] $name,)*)*
        }

        impl InputKey {
            /// All inputs, in the order of the documentation.
            pub const ALL: [Self; INPUTS.len()] = [$($(Self::$name),*),*];

            /// Returns the group to which the input belongs.
            pub(crate) fn group(self) -> InputGroup {
                match self {
                    $($(Self::$name => InputGroup::$group,)*)*
                }
            }
        }

        impl Case {
            /// Returns the inputs that are given in the case.
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
    /// Returns the definition of the input.
    #[inline]
    pub fn input(self) -> &'static Quantity {
        &INPUTS[self as usize]
    }

    /// Returns the name of the input.
    pub fn name(self) -> &'static str {
        self.input().name
    }

    /// Returns the input with the given name.
    ///
    /// # Errors
    /// Returns [`CaseError::Unknown`] with the most similar name as a suggestion.
    pub fn named(name: &str) -> Result<Self, CaseError> {
        Self::known(name).ok_or_else(|| unknown_key(name))
    }

    /// Works like [`named`](Self::named), but returns `None` for an unknown name, which avoids the
    /// slow search for the most similar name.
    pub(crate) fn known(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|key| key.name() == name)
    }

    /// Returns the input to which `name` refers, and the conversion from the unit at the end of
    /// `name` to the unit of the input. For example, `axial_load_kN` is `axial_load_N` with a
    /// factor of 1000.
    ///
    /// # Errors
    ///
    /// Returns a [`CaseError::Unknown`] that suggests the most similar name.
    pub fn in_unit(name: &str) -> Result<(Self, UnitChange), CaseError> {
        Self::known_in_unit(name).ok_or_else(|| unknown_key(name))
    }

    /// Works like [`in_unit`](Self::in_unit), but returns `None` for an unknown name, which avoids
    /// the slow search for the most similar name.
    pub(crate) fn known_in_unit(name: &str) -> Option<(Self, UnitChange)> {
        let given = || Some((Self::known(name)?, UnitChange::NONE));
        let converted = || {
            let (own, change) = convert(name, INPUTS.iter().map(|input| input.name))?;
            Some((Self::known(own)?, change))
        };
        given().or_else(converted)
    }
}

impl Case {
    /// Returns the value of an input: the given value, a value derived from other inputs, or the
    /// default.
    #[inline]
    pub fn value_or_default(&self, key: InputKey) -> Option<f64> {
        self[key].or_else(|| self.derived_value(key)).or(key.input().default)
    }

    /// Returns the value of an input, or NaN if the input has no value.
    pub(crate) fn number(&self, key: InputKey) -> f64 {
        self.value_or_default(key).unwrap_or(f64::NAN)
    }
}

use Rule::{Above, Any, AtLeast, Between, OneOf, Whole, Within};

inputs! {
    Screw {
        ball_diameter_mm ["mm" "D_w"] Above(0.0), None,
            "ball diameter";
        pitch_circle_diameter_mm ["mm" "D_pw"] Above(0.0), None,
            "pitch circle diameter; diameter of the circle of the ball centers";
        lead_angle_deg ["deg" "phi"] Between(0.0, 90.0), None,
            "lead angle; lead angle of the helix of the ball centers. Alternative: lead_mm";
        lead_mm ["mm" "P_h"] Above(0.0), None,
            "lead; axial travel per turn. Alternative: lead_angle_deg";
        contact_angle_deg ["deg" "alpha"] Between(0.0, 90.0), None,
            "contact angle; 0 is radial, 90 is axial. In the elastic models, it is the angle without load";
        nut_running_contact_angle_deg ["deg"] Between(0.0, 90.0), None,
            "contact angle at the nut during motion, for `bsm solve --show slip` with model raceway-control; defaults to the angle that the model calculates";
        screw_running_contact_angle_deg ["deg"] Between(0.0, 90.0), None,
            "contact angle at the screw during motion, for `bsm solve --show slip` with model raceway-control; defaults to the angle that the model calculates";
        nut_conformity ["" "f_rn"] Above(0.5), None,
            "conformity of the nut groove; groove radius divided by ball diameter";
        screw_conformity ["" "f_rs"] Above(0.5), None,
            "conformity of the screw groove; groove radius divided by ball diameter";
    }
    OperatingPoint {
        friction_coefficient ["" "mu"] AtLeast(0.0), None,
            "Coulomb friction coefficient";
        far_flank_friction_coefficient [""] Above(0.0), None,
            "friction coefficient at the far flank, which a ball touches below the threshold play; defaults to friction_coefficient";
        rolling_friction_mm ["mm"] AtLeast(0.0), Some(0.0),
            "lever arm of rolling resistance";
    }
    Screw {
        density_kg_m3 ["kg/m3"] Above(0.0), Some(7800.0),
            "density of the ball";
        youngs_modulus_GPa ["GPa" "E"] Above(0.0), Some(207.0),
            "Young's modulus of the raceways; also applies to the balls unless ball_youngs_modulus_GPa is given";
        poisson_ratio ["" "nu"] Between(-1.0, 0.5), Some(0.3),
            "Poisson's ratio of the raceways; also applies to the balls unless ball_poisson_ratio is given";
        ball_youngs_modulus_GPa ["GPa"] Above(0.0), None,
            "Young's modulus of the balls; defaults to youngs_modulus_GPa";
        ball_poisson_ratio [""] Between(-1.0, 0.5), None,
            "Poisson's ratio of the balls; defaults to poisson_ratio";
    }
    OperatingPoint {
        screw_speed_rpm ["rpm" "n"] Any, None,
            "speed of the screw about the axis; a positive difference between screw speed and nut speed means that the drive works against the load, and a negative difference means that the load drives the screw";
        feed_m_min ["m/min"] Any, None,
            "velocity of the nut along the screw; replaces screw_speed_rpm and requires the lead";
        nut_speed_rpm ["rpm"] Any, Some(0.0),
            "speed of the nut about the axis";
        axial_load_N ["N" "F_a"] Above(0.0), None,
            "axial load on the nut; it is shared by all loaded balls";
        loaded_balls ["" "Z"] AtLeast(1.0), None,
            "number of balls that share the load equally; defaults to loaded_balls_per_turn times loaded_turns, or to the number of balls in the circuits";
    }
    Nut {
        loaded_balls_per_turn ["" "z_1"] Above(0.0), None,
            "loaded balls per turn; required for load ratings. A fractional number is valid";
        loaded_turns ["" "i"] Above(0.0), None,
            "loaded turns; number of loaded turns of one nut, required for load ratings. A fractional number is valid";
        preload_N ["N" "F_pr"] Above(0.0), None,
            "preload; axial force between the two nuts of a pair, or between the flanks of a nut with oversize balls (preload_by)";
        preload_offset_um ["um"] Any, None,
            "axial offset of the two nuts of a pair relative to each other; replaces preload_N. A positive offset pulls the nuts together (X arrangement), and a negative offset pushes them apart (O arrangement)";
        ball_oversize_um ["um"] Any, None,
            "oversize of all balls relative to the diameter at which they just touch both flanks of a nut; a negative value means play";
        ball_deviation_sd_um ["um"] AtLeast(0.0), None,
            "standard deviation of the ball diameters of a nut; the diameters are random numbers that depend on the input seed";
        seed [""] Whole(0.0), Some(0.0),
            "seed of the random deviations of the balls";
    }
    Screw {
        starts [""] Whole(1.0), Some(1.0),
            "number of starts of the screw thread";
    }
    Nut {
        circuits_count [""] Whole(1.0), Some(1.0),
            "number of ball circuits into which the loaded turns of a nut are divided";
        gap_deg ["deg"] AtLeast(0.0), None,
            "arc without loaded balls between two circuits of one thread; defaults to the rest of the turn";
        phase_deg ["deg"] Any, Some(0.0),
            "angle along the helix by which each circuit is shifted relative to the previous circuit, in addition to arc and gap";
        radial_gap_um ["um"] Any, None,
            "radial gap between the grooves of nut and screw; defaults to 0. It increases the contact angle at first touch and, like axial_play_um, counts as play of the gothic arches";
        ball_gap_mm ["mm"] Above(0.0), None,
            "sum of all gaps between the balls in the loaded part of a circuit, along the helix; if it is given, the forces between touching balls are calculated. Each entry of circuits may have its own value";
        spacer_thickness_mm ["mm"] AtLeast(0.0), Some(0.0),
            "distance between two load balls that touch the same spacer; for spacer balls, give their diameter and set ball_contact_friction to 0";
        return_push_N ["N"] AtLeast(0.0), None,
            "force on the last loaded ball that pushes the balls through the return; replaces return_entry_force_N and return_bend_deg";
        return_entry_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force with which a ball is pushed from the return into the loaded part";
        return_bend_deg ["deg"] AtLeast(0.0), Some(0.0),
            "sum of the angles of all bends of a return; in a bend, pushed balls press outward";
        return_friction_coefficient [""] AtLeast(0.0), Some(0.1),
            "friction coefficient of the balls in the bends of a return";
        idle_ball_drag_N ["N"] AtLeast(0.0), Some(0.0),
            "force that is needed to move an unloaded ball";
        reference_z_mm ["mm"] Any, None,
            "position on the axis to which displacements, side loads and moments of a nut refer; defaults to the middle of its balls";
        radial_load_x_N ["N"] Any, None,
            "side load on the nut along x";
        radial_load_y_N ["N"] Any, None,
            "side load on the nut along y";
        moment_x_Nm ["N m"] Any, None,
            "moment on the nut about x";
        moment_y_Nm ["N m"] Any, None,
            "moment on the nut about y";
        radial_x_um ["um"] Any, None,
            "misalignment: prescribed lateral displacement of the nut along x";
        radial_y_um ["um"] Any, None,
            "misalignment: prescribed lateral displacement of the nut along y";
        tilt_x_urad ["urad"] Any, None,
            "misalignment: prescribed tilt of the nut about x";
        tilt_y_urad ["urad"] Any, None,
            "misalignment: prescribed tilt of the nut about y";
        guide_x_N_um ["N/um"] Above(0.0), None,
            "lateral stiffness of the nut guides along x";
        guide_y_N_um ["N/um"] Above(0.0), None,
            "lateral stiffness of the nut guides along y";
        guide_tilt_x_Nm_mrad ["N m/mrad"] Above(0.0), None,
            "tilting stiffness of the nut guides about x";
        guide_tilt_y_Nm_mrad ["N m/mrad"] Above(0.0), None,
            "tilting stiffness of the nut guides about y";
        nut_anchor_z_mm ["mm"] Any, None,
            "axial position at which the nut transmits its load to the table; alternative: nut_anchor";
        screw_anchor_z_mm ["mm"] Any, None,
            "axial position of the bearing that supports the screw; alternative: screw_anchor";
        nut_EA_N ["N"] Above(0.0), None,
            "product of Young's modulus and cross-sectional area of the nut; defaults to a value calculated from the diameters of the nut";
        screw_EA_N ["N"] Above(0.0), None,
            "product of Young's modulus and cross-sectional area of the screw; defaults to a value calculated from the groove diameter of the screw";
        screw_rating_N ["N"] Above(0.0), None,
            "dynamic load rating of the screw side of one nut body; defaults to a value calculated from the geometry";
        nut_rating_N ["N"] Above(0.0), None,
            "dynamic load rating of the nut side of one nut body; defaults to a value calculated from the geometry";
        nut_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature rise of the nut above its assembly temperature";
        screw_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature rise of the screw above its assembly temperature";
        ball_temperature_rise_K ["K"] Any, Some(0.0),
            "temperature rise of the balls above their assembly temperature";
        thermal_expansion_um_m_K ["um/(m K)"] Above(0.0), Some(11.5),
            "coefficient of thermal expansion of nut, screw and balls";
        nut_outer_diameter_mm ["mm" "D_1"] Above(0.0), None,
            "outer diameter of the nut; used for its stiffness and mass. Defaults to the pitch circle diameter plus 4 ball diameters";
        nut_length_mm ["mm"] Above(0.0), None,
            "length of the nut set; defaults to (loaded_turns + 3) lead_mm / starts for one nut, to two nuts and nut_gap_mm for a pair, and to (2 loaded_turns + 4) lead_mm / starts for a nut with a shifted lead";
    }
    Screw {
        groove_bottom_distance_mm ["mm"] Above(0.0), None,
            "radial distance between the groove bottoms of nut and screw; equals half the difference of their core diameters. It replaces contact_angle_deg in load ratings";
        axial_play_um ["um"] AtLeast(0.0), None,
            "axial play of one nut without preload; below the threshold play, balls also touch a far flank. With a play of 0, balls at rest touch the gothic arch at four points. If neither axial_play_um nor radial_gap_um is given, the thread has no play, oversize balls have four contacts, and other balls have two contacts as with a large play, because no published source states a typical play";
        nut_bore_mm ["mm"] Above(0.0), None,
            "inner diameter of the nut at its lands; used for its mass and the ends of its flanks. Defaults to the pitch circle diameter plus 1.5 mm, or plus half a ball diameter for balls below 3 mm";
        screw_outer_diameter_mm ["mm" "d_1"] Above(0.0), None,
            "outer diameter of the screw; used for the ends of its flanks. Defaults to the pitch circle diameter minus 1.5 mm, or minus half a ball diameter for balls below 3 mm";
    }
    Axis {
        speed_number_limit_mm_min ["mm/min"] Above(0.0), None,
            "largest speed number that the ball return permits; pitch circle diameter times speed. Defaults to the limit of screw_make";
    }
    Nut {
        raceway_yield_strength_MPa ["MPa"] Above(0.0), None,
            "yield strength of the raceways; used to calculate the safety margin against yielding of the contacts";
        ball_yield_strength_MPa ["MPa"] Above(0.0), None,
            "yield strength of the balls; used to calculate the safety margin against yielding of the contacts";
    }
    Lubricant {
        lubricant_density_kg_m3 ["kg/m3"] Above(0.0), None,
            "density of the lubricant, at 15 C if the density varies with temperature; defaults to the density of base_oil. `bsm solve --show jam` calculates the drag force only if the density is given";
        drag_coefficient [""] AtLeast(0.0), None,
            "drag coefficient of a ball in the lubricant";
        iso_vg [""] OneOf(&VISCOSITY_GRADES), None,
            "viscosity grade of the lubricant; ISO 3448, with an assumed viscosity index of 95. Alternative: viscosity_40C_mm2_s and viscosity_100C_mm2_s";
        viscosity_40C_mm2_s ["mm2/s"] AtLeast(1.0), None,
            "kinematic viscosity of the lubricant at 40 C; for a grease, the viscosity of its base oil";
        viscosity_100C_mm2_s ["mm2/s"] AtLeast(0.5), None,
            "kinematic viscosity of the lubricant at 100 C; must be below the viscosity at 40 C";
        pressure_viscosity_1_GPa ["1/GPa"] Between(0.0, 200.0), None,
            "pressure-viscosity coefficient at the temperature of the lubricant; defaults to a value calculated from viscosity and base_oil";
        limiting_shear_ratio [""] Above(0.0), None,
            "ratio of the limiting shear stress of the lubricant to the pressure; defaults to the ratio of base_oil";
        boundary_friction_coefficient [""] Above(0.0), Some(0.12),
            "boundary friction coefficient; applies where asperities touch. Usually 0.09 with friction modifiers and 0.15 at the start from rest";
        lubricant_temperature_C ["C"] Within(-60.0, 200.0), None,
            "temperature of the lubricant at the inlet of the contacts; alternative: heat_transfer_W_K and ambient_temperature_C";
        heat_transfer_W_K ["W/K"] Above(0.0), None,
            "heat transfer from the nut to the surroundings; replaces lubricant_temperature_C";
        ambient_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of the surroundings; in the warm state, it defaults to preload_temperature_C";
        ball_roughness_um ["um"] Above(0.0), Some(0.02),
            "root mean square roughness of the balls; 1.25 times the arithmetic mean, usually 0.01 to 0.03";
        nut_roughness_um ["um"] Above(0.0), Some(0.2),
            "root mean square roughness of the nut groove; 0.1 to 0.3 if ground, half of this value after running-in";
        screw_roughness_um ["um"] Above(0.0), Some(0.2),
            "root mean square roughness of the screw groove; 0.1 to 0.3 if ground, half of this value after running-in, 0.3 to 0.6 if rolled. Defaults to 0.4 if screw_make is rolled";
        film_factor [""] Above(0.0), Some(1.0),
            "ratio of the film thickness to the film thickness with fully flooded inlets; usually 0.7 (0.4 to 1) for grease";
        rolling_factor [""] AtLeast(0.0), Some(0.85),
            "ratio of the rolling force of the lubricant to the rolling force with fully flooded inlets";
        hysteresis_loss [""] AtLeast(0.0), Some(0.01),
            "fraction of the elastic energy of the contacts that is lost in rolling; usually 0.003 to 0.034";
        seal_torque_Nm ["N m"] AtLeast(0.0), Some(0.0),
            "friction torque of the seals; stated by the manufacturer or measured. Felt wipers usually cause 0.02 to 0.3 N m";
        ball_contact_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force between neighboring balls; usually 0.1 to 1, or 0 with spacer balls. If ball_gap_mm is given, the force is calculated";
        ball_contact_friction [""] AtLeast(0.0), None,
            "friction coefficient between balls, or between spacers and balls; defaults to boundary_friction_coefficient, or to friction_coefficient without a lubricant";
        return_circuits [""] AtLeast(0.0), Some(0.0),
            "number of ball returns in which the balls lose kinetic energy";
        return_loss_coefficient [""] AtLeast(0.0), Some(0.0),
            "ratio of the kinetic energy that a ball loses in a return to the kinetic energy of the ball; usually 1 to 4 for entry and exit together";
    }
    Nut {
        apex_half_angle_deg ["deg"] Between(0.0, 90.0), None,
            "half angle of the apex of the return curve; used to calculate jamming";
        return_angle_deg ["deg"] Between(0.0, 90.0), None,
            "angle between the return channel and the screw track at the transition steps; used to calculate jamming";
        step_normal_force_N ["N"] Above(0.0), None,
            "normal force that the step exerts on the ball; used to calculate jamming. Defaults to the impact force";
        return_approach_speed_m_s ["m/s"] Above(0.0), None,
            "speed at which a ball enters the ball return; used to calculate jamming. Defaults to the speed of the ball in the nut";
        return_stiffness_N_um15 ["N/um^1.5"] Above(0.0), None,
            "Hertz stiffness of the impact on the ball return; used to calculate jamming. Defaults to the stiffness of a ball on a flat surface of the raceway material";
        return_linear_stiffness_N_um ["N/um"] Above(0.0), None,
            "linear stiffness of the impact on the ball return; used to calculate jamming. Replaces return_stiffness_N_um15";
        step_height_mm ["mm"] AtLeast(0.0), None,
            "height of the step over which a ball enters the ball return; used to calculate jamming";
    }
    Axis {
        nominal_diameter_mm ["mm" "d_0"] Above(0.0), None,
            "nominal diameter of the screw; if the groove is not given, it is estimated from this diameter, lead_mm, rated_dynamic_load_N and, if known, rated_static_load_N";
        screw_mass_kg_m ["kg/m"] Above(0.0), None,
            "mass per meter of the screw, if its groove is not known; defaults to an estimate";
        nut_mass_kg ["kg"] Above(0.0), None,
            "mass of the nut; as stated by the manufacturer, or by default calculated from its groove";
        catalog_efficiency [""] Within(0.01, 1.0), Some(0.9),
            "efficiency of the screw according to its catalog, if its groove is not known; usually 0.85 to 0.95";
        catalog_back_efficiency [""] Within(0.01, 1.0), Some(0.8),
            "efficiency of the screw in back-driving according to its catalog, if its groove is not known; usually 0.75 to 0.85";
        rated_rigidity_N_um ["N/um" "K"] Above(0.0), None,
            "rigidity of the nut as stated by the manufacturer, if the groove is not known; requires rated_rigidity_at";
        rated_dynamic_load_N ["N" "C_a"] Above(0.0), None,
            "dynamic load rating as stated by the manufacturer; replaces the calculated rating";
        rated_static_load_N ["N" "C_0a"] Above(0.0), None,
            "static load rating as stated by the manufacturer; replaces the calculated rating";
        stroke_mm ["mm"] Above(0.0), None,
            "stroke of the nut; the thread is longer by the length of the nut set and overrun_mm at each end";
        overrun_mm ["mm"] Above(0.0), None,
            "overrun of the thread at each end, beyond stroke and nut; defaults to one lead";
        nut_gap_mm ["mm" "g"] AtLeast(0.0), None,
            "gap between the nuts of a pair; defaults to lead_mm / starts";
        unsupported_length_mm ["mm"] Above(0.0), None,
            "unsupported length of the screw between its bearings; defaults to the length of the thread";
        shaft_diameter_mm ["mm"] Above(0.0), None,
            "shaft diameter for bending and buckling; defaults to the calculated core diameter of the thread";
        screw_bore_mm ["mm" "d_b"] Above(0.0), None,
            "bore of a hollow screw";
        coolant_density_kg_m3 ["kg/m3"] AtLeast(0.0), Some(0.0),
            "density of the liquid in the bore of a hollow screw; reduces the critical speed";
        buckling_length_mm ["mm"] Above(0.0), None,
            "length of the screw that may buckle, between fixed bearing and nut; defaults to the unsupported length";
        screw_inertia_kg_m2_m ["kg m2/m"] Above(0.0), None,
            "moment of inertia per meter of the screw as stated by the manufacturer; defaults to a value calculated from the cross section";
        support_bearing_axial_load_N ["N"] Above(0.0), None,
            "largest permitted axial load of the support bearings; the sum of the load, the pretension and the force due to constrained thermal expansion must not exceed it";
        pretension_N ["N" "F_v"] AtLeast(0.0), None,
            "tension of a screw between two fixed bearings when the screw and the bed have the same temperature";
        pretension_K ["K"] AtLeast(0.0), None,
            "temperature rise of the screw that the pretension compensates, between two fixed bearings; usually 2 to 5. It replaces pretension_N";
        moved_mass_kg ["kg"] AtLeast(0.0), Some(0.0),
            "moved mass, total for all screws of the axis; its weight, friction and inertia are added to the axial load";
        inclination_deg ["deg"] Within(-90.0, 90.0), Some(0.0),
            "inclination of the axis; 0 is horizontal, 90 is vertical with a positive feed upward";
        guide_friction [""] AtLeast(0.0), Some(0.0),
            "friction coefficient of the guides under the moved mass";
        guide_force_N ["N"] AtLeast(0.0), Some(0.0),
            "force of the guides that does not depend on the load, such as seals and scrapers; acts against the feed";
        motor_rated_speed_rpm ["rpm"] Above(0.0), None,
            "rated speed of the motor";
        motor_max_speed_rpm ["rpm"] Above(0.0), None,
            "largest speed of the motor; defaults to motor_rated_speed_rpm";
        motor_rated_torque_Nm ["N m"] Above(0.0), None,
            "rated torque of the motor; limits the RMS torque over the cycle";
        motor_peak_torque_Nm ["N m"] Above(0.0), None,
            "peak torque of the motor";
        motor_rated_power_W ["W"] Above(0.0), None,
            "rated power of the motor";
        motor_steps_per_turn [""] Whole(1.0), None,
            "full steps of a stepper motor per turn; used to calculate the travel per step";
        microsteps_count [""] Whole(1.0), Some(1.0),
            "microsteps per full step of a stepper motor";
        encoder_counts_per_turn [""] Whole(1.0), None,
            "counts of the encoder per turn of the motor; counted after quadrature and used to calculate the travel per count";
        largest_inertia_ratio [""] Above(0.0), Some(10.0),
            "largest permitted load-to-motor inertia ratio; usually 3 to 10";
        counterweight_kg ["kg"] AtLeast(0.0), Some(0.0),
            "mass of a counterweight; it hangs vertically and moves with the axis";
        counterbalance_N ["N"] Any, Some(0.0),
            "force of a gas spring or cylinder in the direction of positive feed; it relieves the screw of a vertical axis";
        screws_count [""] Whole(1.0), Some(1.0),
            "number of screws that share the load of the axis";
        load_share ["" "x"] Within(0.01, 1.0), None,
            "share of the load on the most loaded screw; defaults to 1 / screws_count";
        screws_per_motor [""] Whole(1.0), Some(1.0),
            "number of screws that each motor drives";
        cycles_per_hour [""] Above(0.0), None,
            "number of cycles per hour; between the cycles, the axis stands still";
        hold_force_N ["N" "F_c"] Any, None,
            "process force that acts at rest, in addition to the weight; positive if it opposes a positive feed. Defaults to force_N if it is the same in all entries of the cycle, otherwise to 0";
        stop_deceleration_m_s2 ["m/s2" "a"] Above(0.0), None,
            "deceleration with which the drive stops the axis after brake_delay_s; replaces brake_torque_Nm";
        brake_torque_Nm ["N m"] Above(0.0), None,
            "torque of the brake, at the motor";
        brake_delay_s ["s"] AtLeast(0.0), Some(0.05),
            "time until the brake acts";
        brake_safety [""] AtLeast(1.0), Some(1.5),
            "required ratio of brake_torque_Nm to the torque of the load at rest without friction";
        motor_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of the motor";
        coupling_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of parts that turn with the driven part, such as a coupling or a pulley";
        nut_inertia_kg_m2 ["kg m2" "J_n"] Above(0.0), None,
            "moment of inertia of a driven nut; defaults to the moment of inertia of a steel tube from the pitch circle to nut_outer_diameter_mm";
        gear_ratio [""] Above(0.0), Some(1.0),
            "turns of the motor for one turn of the screw";
        gear_efficiency [""] Within(0.01, 1.0), Some(1.0),
            "efficiency of the gearbox between motor and screw";
        gear_inertia_kg_m2 ["kg m2"] AtLeast(0.0), Some(0.0),
            "moment of inertia of the gearbox, referred to the motor shaft";
        support_bearing_torque_Nm ["N m"] AtLeast(0.0), Some(0.0),
            "friction torque of all support bearings together; for a driven nut, the friction torque of its bearing";
        support_bearing_stiffness_N_um ["N/um"] Above(0.0), None,
            "axial stiffness of each support bearing; if it is missing, the bearings are rigid";
        housing_stiffness_N_um ["N/um"] Above(0.0), None,
            "axial stiffness of the housings of bearings and nut; if it is missing, the housings are rigid";
        load_factor ["" "f_w"] Within(1.0, 5.0), Some(1.0),
            "load factor for life and equivalent load; usually 1 to 1.2 without shocks up to 0.25 m/s, 1.2 to 1.5 up to 1 m/s, 1.5 to 2 up to 2 m/s";
        hardness_HRC ["HRC"] Within(40.0, 66.0), None,
            "Rockwell hardness of the raceways; values below 60 reduce the load ratings";
        hardness_HV10 ["HV10"] Within(392.0, 865.0), None,
            "Vickers hardness of the raceways; replaces hardness_HRC. Values below 654 reduce the load ratings";
        accuracy_factor ["" "f_ac"] Within(0.1, 1.0), None,
            "accuracy factor of the load ratings; defaults to the factor of accuracy_grade for calculated ratings, and to 1 for the manufacturer's ratings";
        contamination_factor ["" "e_C"] Within(0.0, 1.0), None,
            "contamination factor of the lubricant, for the modified life; replaces contamination";
        reliability_percent ["%"] Within(90.0, 99.0), Some(90.0),
            "reliability; share of the nuts that reach the life";
        axis_heat_transfer_W_K ["W/K"] Above(0.0), None,
            "heat transfer to surroundings; heat transfer of screw and nut together, which replaces the thermal network";
        useful_travel_mm ["mm" "l_u"] Above(0.0), None,
            "useful travel, over which accuracy_grade limits the travel error; defaults to stroke_mm";
        required_travel_error_um ["um"] Above(0.0), None,
            "largest permitted travel error";
        required_life_h ["h" "L_h"] Above(0.0), None,
            "required life; includes the standstill times of the cycle";
        required_life_revolutions [""] Above(0.0), None,
            "required life in revolutions, both directions added; replaces required_life_h";
        required_life_km ["km"] Above(0.0), None,
            "required life as travel, both directions added; replaces required_life_h";
        required_life_cycles [""] Above(0.0), None,
            "required life in cycles; replaces required_life_h";
        required_life_strokes [""] Above(0.0), None,
            "required life in strokes of length stroke_mm; replaces required_life_h";
        required_life_years [""] Above(0.0), None,
            "required life in years, with operating_h_day hours per day and operating_days_year days per year; replaces required_life_h";
        operating_h_day ["h/day"] Within(0.1, 24.0), None,
            "hours of operation per day; used to calculate the life in years";
        operating_days_year [""] Within(1.0, 366.0), None,
            "days of operation per year; used to calculate the life in years";
        required_static_safety ["" "f_s"] Above(0.0), Some(1.5),
            "required static safety";
        required_critical_speed_ratio [""] Above(0.0), Some(0.8),
            "permitted ratio of speed to critical speed";
        required_buckling_safety [""] Above(0.0), Some(2.0),
            "required ratio of the buckling load to the largest axial load";
        extra_drag_factor [""] AtLeast(0.0), None,
            "drag factor of the preload; drag torque outside the contacts, divided by warm preload times lead / (2 pi). Defaults to the manufacturers' rule";
    }
    WarmState {
        preload_temperature_C ["C"] Within(-40.0, 150.0), Some(20.0),
            "temperature at which preload and fits are set";
        structure_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of the structure that carries the bearings of the screw; defaults to ambient_temperature_C";
        coolant_temperature_C ["C"] Within(-40.0, 150.0), None,
            "temperature of the coolant of screw and nut; defaults to ambient_temperature_C";
        nut_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance from nut and table to the air; usually 2 to 20. Defaults to a calculated value, which is accurate to a factor of 2";
        carriage_area_m2 ["m2"] Above(0.0), None,
            "surface area of the bracket and table exposed to air; replaces nut_conductance_W_K. Defaults to ten times the surface area of the nut";
        screw_film_W_m2K ["W/(m2 K)"] Above(0.0), None,
            "film coefficient of the screw in air; usually 10 to 60. Defaults to a calculated value, which is accurate to a factor of 1.4";
        gap_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance of gap and wipers between nut and screw; usually 0.2 to 3. Defaults to a calculated value, which is accurate to a factor of 3";
        ball_nut_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance of the contacts between balls and nut; defaults to a calculated value, which is accurate to a factor of 2";
        ball_screw_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance of the contacts between balls and screw; defaults to a calculated value, which is accurate to a factor of 2";
        end_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance from each screw bearing to the structure; usually 2 to 20. Defaults to a calculated value, which is accurate to a factor of 3";
        nut_coolant_conductance_W_K ["W/K"] AtLeast(0.0), Some(0.0),
            "thermal conductance from the nut to a coolant; usually 20 to 60 for a cooled nut";
        coolant_flow_l_min ["l/min"] Above(0.0), None,
            "coolant flow through the bore of the screw";
        coolant_conductance_W_K ["W/K"] Above(0.0), None,
            "thermal conductance from the screw to the coolant; replaces coolant_flow_l_min";
        screw_tension_N ["N"] Any, Some(0.0),
            "tension of the screw; negative if the screw is compressed. If warm_state is true, the tension is calculated";
        motor_heat_W ["W"] AtLeast(0.0), Some(0.0),
            "heat flow from the motor into the end of the screw";
        steel_conductivity_W_m_K ["W/(m K)"] Above(0.0), Some(45.0),
            "thermal conductivity of the steel";
        fold_search_factor [""] Above(1.0), Some(2.0),
            "upper end of the search for the fold, as a multiple of the given speeds; the fold is the speed above which no warm state exists";
    }
}
