//! The outputs: one table that records, tables and schema are made from.

use bsm_dyn::{Control, Outputs};

use crate::units::{DEG, MM, MPA, UM, direction_deg};

/// A value of one output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// A quantity in the unit of the output.
    Number(f64),
    /// A count.
    Count(usize),
    /// Yes or no.
    Flag(bool),
    /// A race, as text.
    Race(Control),
}

impl Cell {
    /// The value as it stands in a column of numbers: no is 0 and yes is 1, a race its place among
    /// the words of its output.
    pub fn number(self) -> f64 {
        match self {
            Self::Number(x) => x,
            #[expect(clippy::cast_precision_loss, reason = "small counts")]
            Self::Count(n) => n as f64,
            Self::Flag(yes) => f64::from(u8::from(yes)),
            Self::Race(race) => f64::from(race as u8),
        }
    }
}

/// One output of the vocabulary.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Name, with its unit as suffix.
    pub name: &'static str,
    /// Unit in words; empty if dimensionless.
    pub unit: &'static str,
    /// JSON type.
    pub json_type: &'static str,
    /// The words that a text may be; empty if it is none.
    pub words: &'static [&'static str],
    /// Meaning.
    pub about: &'static str,
    /// Place in [`OUTPUTS`].
    pub key: OutputKey,
    read: fn(&Outputs) -> Option<Cell>,
}

impl Output {
    /// The value in `outputs`, in the unit of the vocabulary; `None` if the model has none.
    pub fn read(&self, outputs: &Outputs) -> Option<Cell> {
        (self.read)(outputs)
    }

    /// The word of a number in a column of texts.
    pub fn word(&self, number: f64) -> Option<&'static str> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let place = number as usize;
        self.words.get(place).filter(|_| !number.is_nan()).copied()
    }

    /// The output of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        OUTPUTS.iter().find(|output| output.name == name)
    }
}

macro_rules! outputs {
    ($($name:ident [$unit:literal] $kind:ident($field:ident $(/ $factor:expr)? $(=> $convert:ident)?), $about:literal;)*) => {
        /// All outputs, in the order of the documentation.
        pub const OUTPUTS: &[Output] = &[$(Output {
            name: stringify!($name),
            unit: $unit,
            json_type: outputs!(@json $kind),
            words: outputs!(@words $kind),
            about: $about,
            key: OutputKey::$name,
            read: |outputs| outputs.$field.map(|value| Cell::$kind($($convert)?(value $(/ $factor)?))),
        },)*];

        /// An output as a number: its place in [`OUTPUTS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "the names of the vocabulary")]
        pub enum OutputKey {
            $(#[doc = $about] $name,)*
        }
    };
    (@json Number) => { "number" };
    (@json Count) => { "integer" };
    (@json Flag) => { "boolean" };
    (@json Race) => { "string" };
    (@words Race) => { &["nut", "screw"] };
    (@words $kind:ident) => { &[] };
}

outputs! {
    efficiency [""] Number(efficiency), "power out over power in; negative: self-locking";
    screw_torque_Nm ["N m"] Number(screw_torque), "torque on the screw that holds the steady state, all balls";
    nut_normal_load_N ["N"] Number(nut_normal_load), "normal load of a ball on the nut";
    screw_normal_load_N ["N"] Number(screw_normal_load), "normal load of a ball on the screw";
    minor_normal_load_N ["N"] Number(minor_normal_load), "normal load of a ball on the opposite flank of the nut";
    nut_contact_angle_deg ["deg"] Number(nut_contact_angle / DEG), "contact angle at the nut";
    screw_contact_angle_deg ["deg"] Number(screw_contact_angle / DEG), "contact angle at the screw";
    nut_slip_angle_deg ["deg"] Number(nut_slip_angle => direction_deg), "direction of friction on the ball at the nut";
    screw_slip_angle_deg ["deg"] Number(screw_slip_angle => direction_deg), "direction of friction on the ball at the screw";
    minor_slip_angle_deg ["deg"] Number(minor_slip_angle => direction_deg), "direction of friction on the ball at the minor contact";
    nut_slip_velocity_m_s ["m/s"] Number(nut_slip_velocity), "slip speed at the nut";
    screw_slip_velocity_m_s ["m/s"] Number(screw_slip_velocity), "slip speed at the screw";
    minor_slip_velocity_m_s ["m/s"] Number(minor_slip_velocity), "slip speed at the minor contact";
    nut_spin_rad_s ["rad/s"] Number(nut_spin), "spin about the contact normal, against the nut";
    screw_spin_rad_s ["rad/s"] Number(screw_spin), "spin about the contact normal, against the screw";
    ball_precession_rad_s ["rad/s"] Number(precession), "rate of the ball centre about the screw axis";
    ball_omega_t_rad_s ["rad/s"] Number(omega_t), "angular velocity of the ball along the helix";
    ball_omega_n_rad_s ["rad/s"] Number(omega_n), "angular velocity of the ball towards the axis";
    ball_omega_b_rad_s ["rad/s"] Number(omega_b), "angular velocity of the ball along the binormal";
    nut_max_pressure_MPa ["MPa"] Number(nut_max_pressure / MPA), "largest Hertz pressure at the nut";
    screw_max_pressure_MPa ["MPa"] Number(screw_max_pressure / MPA), "largest Hertz pressure at the screw";
    nut_ellipse_a_mm ["mm"] Number(nut_ellipse_a / MM), "semi-axis across the groove, nut";
    nut_ellipse_b_mm ["mm"] Number(nut_ellipse_b / MM), "semi-axis along the groove, nut";
    screw_ellipse_a_mm ["mm"] Number(screw_ellipse_a / MM), "semi-axis across the groove, screw";
    screw_ellipse_b_mm ["mm"] Number(screw_ellipse_b / MM), "semi-axis along the groove, screw";
    nut_approach_um ["um"] Number(nut_approach / UM), "elastic approach at the nut";
    screw_approach_um ["um"] Number(screw_approach / UM), "elastic approach at the screw";
    axial_displacement_um ["um"] Number(axial_displacement / UM), "axial displacement of the nut";
    input_power_W ["W"] Number(input_power), "power put in, all balls";
    output_power_W ["W"] Number(output_power), "power got out, all balls";
    dissipated_power_W ["W"] Number(dissipated_power), "power lost, all balls";
    power_balance [""] Number(power_balance), "relative violation of the power balance, an identity at any root";
    iterations [""] Count(iterations), "Newton steps";
    residual_norm [""] Number(residual_norm), "scaled residual";
    skid_number [""] Number(skid_number), "gyroscopic over friction moment of the gripping ball";
    onset_number [""] Number(onset_number), "skid number of a ball whose friction is spent on the slip of the lead: below 0.1 it grips, above 2 it skids";
    efficiency_error_bound [""] Number(error_bound), "bound of the error of the efficiency against model traction, kept by 99 % of all points (model auto)";
    self_locking [""] Flag(self_locking), "true if the screw locks itself in this direction";
    controlling_race [""] Race(controlling_race), "race at which the ball does not spin (raceway control)";
    control_consistent [""] Flag(control_consistent), "true if the controlling race has the larger spin friction moment at this solution; false where neither race has it at its own";
    other_solutions [""] Count(other_solutions), "other steady motions that the equations of the model are known to have at this point; null: none was looked for, or the search was lost";
    other_solution_efficiency [""] Number(other_solution_efficiency), "efficiency of the other solution whose efficiency differs most";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns hold the place of a word.
    #[test]
    fn races_are_told_by_their_places() {
        let output = Output::named("controlling_race").expect("an output");
        for (place, race) in Control::ALL.into_iter().enumerate() {
            assert_eq!(output.words[place], race.name());
            #[expect(clippy::cast_precision_loss, reason = "two places")]
            let number = place as f64;
            assert!((Cell::Race(race).number() - number).abs() < f64::EPSILON);
        }
    }
}
