//! The outputs: one table that records, tables and schema are made from.

use bsm_dyn::{Control, Evidence, FilmState, Solution, Transmission, ZERO_CELSIUS};
use bsm_kin::Motion;
use bsm_kin::Site::{Nut, NutMinor, Screw};

use super::quantity::AnalysisKind;
use crate::vocabulary::units::{DEG, GPA, MILLI, MM, MPA, UM, direction_deg};

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
    /// How sure it is that there is no solution, as text.
    Evidence(Evidence),
}

impl Cell {
    /// The value as it stands in a column of numbers: no is 0 and yes is 1, a text its place among
    /// the words of its output.
    pub fn number(self) -> f64 {
        match self {
            Self::Number(x) => x,
            #[expect(clippy::cast_precision_loss, reason = "small counts")]
            Self::Count(n) => n as f64,
            Self::Flag(yes) => f64::from(u8::from(yes)),
            Self::Race(race) => f64::from(race as u8),
            Self::Evidence(evidence) => f64::from(evidence.rank()),
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
    pub(crate) origin: Origin,
}

/// Where the value of an output comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// From the solution of a model.
    Solution { key: OutputKey, read: fn(&Solution) -> Option<Cell> },
    /// From a table of quantities, which may be that of an analysis: a number of one of them.
    Table { kind: Option<AnalysisKind> },
}

impl Output {
    /// The value in a solution, in the unit of the vocabulary; `None` if it has none.
    pub fn read(&self, solution: &Solution) -> Option<Cell> {
        match self.origin {
            Origin::Solution { read, .. } => read(solution),
            Origin::Table { .. } => None,
        }
    }

    /// Its place in [`OUTPUTS`]; `None` for a number of an analysis.
    pub fn key(&self) -> Option<OutputKey> {
        match self.origin {
            Origin::Solution { key, .. } => Some(key),
            Origin::Table { .. } => None,
        }
    }

    /// The analysis that it is a number of.
    pub fn analysis(&self) -> Option<AnalysisKind> {
        match self.origin {
            Origin::Solution { .. } => None,
            Origin::Table { kind } => kind,
        }
    }

    /// True for a number of the ball or of its contacts.
    pub(crate) fn is_of_the_ball(&self) -> bool {
        use OutputKey as K;
        let of_the_ball = K::nut_normal_load_N as usize..=K::axial_displacement_um as usize;
        self.key().is_some_and(|key| of_the_ball.contains(&(key as usize)))
    }

    /// The word of a number in a column of texts.
    pub fn word(&self, number: f64) -> Option<&'static str> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let place = number as usize;
        self.words.get(place).filter(|_| !number.is_nan()).copied()
    }
}

macro_rules! outputs {
    ($($name:ident [$unit:literal] $kind:ident($read:expr), $about:literal;)*) => {
        /// All outputs of a solution, in the order of the documentation.
        pub const OUTPUTS: &[Output] = &[$(Output {
            name: stringify!($name),
            unit: $unit,
            json_type: outputs!(@json $kind),
            words: outputs!(@words $kind),
            about: $about,
            origin: Origin::Solution {
                key: OutputKey::$name,
                read: |solution| {
                    let read: fn(&Solution) -> Option<_> = $read;
                    read(solution).map(Cell::$kind)
                },
            },
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
    (@json Evidence) => { "string" };
    (@words Race) => { &["nut", "screw"] };
    (@words Evidence) => { &Evidence::NAMES };
    (@words $kind:ident) => { &[] };
}

fn transmission(solution: &Solution) -> Option<&Transmission> {
    Some(&solution.solved()?.transmission)
}

fn film(solution: &Solution) -> Option<&FilmState> {
    solution.solved()?.film.as_ref()
}

fn motion(solution: &Solution) -> Option<Motion<f64>> {
    solution.solved()?.ball.motion
}

outputs! {
    efficiency [""] Number(|s| s.efficiency()), "output power over input power; negative: self-locking";
    screw_torque_Nm ["N m"] Number(|s| transmission(s)?.screw_torque), "torque on the screw in the steady state, all balls";
    nut_normal_load_N ["N"] Number(|s| s.contact(Nut)?.load), "normal load of a ball on the nut";
    screw_normal_load_N ["N"] Number(|s| s.contact(Screw)?.load), "normal load of a ball on the screw";
    minor_normal_load_N ["N"] Number(|s| s.contact(NutMinor)?.load), "normal load of a ball on the minor contact, the opposite flank of the nut";
    nut_contact_angle_deg ["deg"] Number(|s| Some(s.contact(Nut)?.angle / DEG)), "contact angle at the nut";
    screw_contact_angle_deg ["deg"] Number(|s| Some(s.contact(Screw)?.angle / DEG)), "contact angle at the screw";
    nut_slip_angle_deg ["deg"] Number(|s| Some(direction_deg(s.contact(Nut)?.slip_angle?))), "direction of friction on the ball at the nut";
    screw_slip_angle_deg ["deg"] Number(|s| Some(direction_deg(s.contact(Screw)?.slip_angle?))), "direction of friction on the ball at the screw";
    minor_slip_angle_deg ["deg"] Number(|s| Some(direction_deg(s.contact(NutMinor)?.slip_angle?))), "direction of friction on the ball at the minor contact";
    nut_slip_velocity_m_s ["m/s"] Number(|s| Some(s.contact(Nut)?.slip?.speed)), "slip speed at the nut";
    screw_slip_velocity_m_s ["m/s"] Number(|s| Some(s.contact(Screw)?.slip?.speed)), "slip speed at the screw";
    minor_slip_velocity_m_s ["m/s"] Number(|s| Some(s.contact(NutMinor)?.slip?.speed)), "slip speed at the minor contact";
    nut_spin_rad_s ["rad/s"] Number(|s| Some(s.contact(Nut)?.slip?.spin)), "spin about the contact normal, relative to the nut";
    screw_spin_rad_s ["rad/s"] Number(|s| Some(s.contact(Screw)?.slip?.spin)), "spin about the contact normal, relative to the screw";
    ball_precession_rad_s ["rad/s"] Number(|s| Some(motion(s)?.precession)), "precession, the angular velocity of the ball centre about the screw axis";
    ball_omega_t_rad_s ["rad/s"] Number(|s| Some(motion(s)?.omega.x)), "angular velocity of the ball along the helix";
    ball_omega_n_rad_s ["rad/s"] Number(|s| Some(motion(s)?.omega.y)), "angular velocity of the ball towards the axis";
    ball_omega_b_rad_s ["rad/s"] Number(|s| Some(motion(s)?.omega.z)), "angular velocity of the ball along the binormal";
    nut_max_pressure_MPa ["MPa"] Number(|s| Some(s.contact(Nut)?.pressed?.max_pressure / MPA)), "largest Hertz pressure at the nut";
    screw_max_pressure_MPa ["MPa"] Number(|s| Some(s.contact(Screw)?.pressed?.max_pressure / MPA)), "largest Hertz pressure at the screw";
    nut_ellipse_a_mm ["mm"] Number(|s| Some(s.contact(Nut)?.pressed?.semi_axes.0 / MM)), "semi-axis across the groove, nut";
    nut_ellipse_b_mm ["mm"] Number(|s| Some(s.contact(Nut)?.pressed?.semi_axes.1 / MM)), "semi-axis along the groove, nut";
    screw_ellipse_a_mm ["mm"] Number(|s| Some(s.contact(Screw)?.pressed?.semi_axes.0 / MM)), "semi-axis across the groove, screw";
    screw_ellipse_b_mm ["mm"] Number(|s| Some(s.contact(Screw)?.pressed?.semi_axes.1 / MM)), "semi-axis along the groove, screw";
    nut_approach_um ["um"] Number(|s| Some(s.contact(Nut)?.pressed?.approach / UM)), "elastic approach at the nut";
    screw_approach_um ["um"] Number(|s| Some(s.contact(Screw)?.pressed?.approach / UM)), "elastic approach at the screw";
    axial_displacement_um ["um"] Number(|s| Some(s.solved()?.ball.axial_displacement? / UM)), "axial displacement of the nut";
    input_power_W ["W"] Number(|s| Some(transmission(s)?.power?.input)), "input power, all balls";
    output_power_W ["W"] Number(|s| Some(transmission(s)?.power?.output)), "output power, all balls";
    dissipated_power_W ["W"] Number(|s| Some(transmission(s)?.power?.dissipated)), "dissipated power, all balls";
    power_balance [""] Number(|s| transmission(s)?.power_balance), "relative error of the power balance, rounding only at an exact solution";
    iterations [""] Count(|s| Some(s.solved()?.info?.steps)), "Newton steps, or sweeps of `rigid`";
    residual_norm [""] Number(|s| Some(s.solved()?.info?.residual)), "scaled residual of the equations";
    lubricant_temperature_C ["C"] Number(|s| Some(film(s)?.temperature - ZERO_CELSIUS)), "temperature of the lubricant, given or that at which all losses leave as heat";
    viscosity_mPas ["mPa s"] Number(|s| Some(film(s)?.viscosity / MILLI)), "dynamic viscosity of the lubricant at its temperature";
    pressure_viscosity_1_GPa ["1/GPa"] Number(|s| Some(film(s)?.pressure_viscosity * GPA)), "pressure-viscosity coefficient of the lubricant";
    nut_film_um ["um"] Number(|s| Some(film(s)?.nut.thickness / UM)), "film thickness at the nut";
    screw_film_um ["um"] Number(|s| Some(film(s)?.screw.thickness / UM)), "film thickness at the screw";
    nut_film_ratio [""] Number(|s| Some(film(s)?.nut.ratio)), "film thickness over roughness at the nut: below 0.3 boundary, to 2 mixed, above full film";
    screw_film_ratio [""] Number(|s| Some(film(s)?.screw.ratio)), "film thickness over roughness at the screw";
    nut_asperity_share [""] Number(|s| Some(film(s)?.nut.share)), "share of the load that asperities carry at the nut";
    screw_asperity_share [""] Number(|s| Some(film(s)?.screw.share)), "share of the load that asperities carry at the screw";
    nut_friction_coefficient [""] Number(|s| Some(film(s)?.nut.friction)), "mean friction coefficient at the nut: sliding power over that of a coefficient of one";
    screw_friction_coefficient [""] Number(|s| Some(film(s)?.screw.friction)), "mean friction coefficient at the screw";
    nut_rolling_moment_Nmm ["N mm"] Number(|s| Some(film(s)?.nut.rolling_moment / MM)), "couple against rolling at the nut, by lubricant and hysteresis";
    screw_rolling_moment_Nmm ["N mm"] Number(|s| Some(film(s)?.screw.rolling_moment / MM)), "couple against rolling at the screw";
    nut_entrainment_m_s ["m/s"] Number(|s| Some(film(s)?.nut.entrainment)), "mean speed of both surfaces along the track at the nut";
    screw_entrainment_m_s ["m/s"] Number(|s| Some(film(s)?.screw.entrainment)), "mean speed of both surfaces along the track at the screw";
    sliding_power_W ["W"] Number(|s| Some(film(s)?.sliding_power)), "power lost by sliding at the contacts, all balls";
    rolling_power_W ["W"] Number(|s| Some(film(s)?.rolling_power)), "power lost by rolling resistance of lubricant and hysteresis, all balls";
    seal_power_W ["W"] Number(|s| Some(film(s)?.outside.seal)), "power lost at the seals, which warms the lubricant; a part of the torque of the whole screw, not of dissipated_power_W";
    ball_contact_power_W ["W"] Number(|s| Some(film(s)?.outside.ball_contact)), "power lost by balls that rub on each other";
    return_power_W ["W"] Number(|s| Some(film(s)?.outside.ball_return)), "power lost in the ball returns";
    drag_power_W ["W"] Number(|s| Some(film(s)?.outside.drag)), "power lost by drag of the balls in the lubricant";
    film_heating_K ["K"] Number(|s| Some(film(s)?.heating)), "by how much sliding heats the hotter film; not in the viscosity";
    equivalent_friction_coefficient [""] Number(|s| Some(film(s)?.equivalent_friction)), "constant friction coefficient with the same loss of the contacts at this point";
    catalogue_friction_coefficient [""] Number(|s| Some(film(s)?.catalogue_friction)), "friction coefficient of catalogues, that of a plain thread of the same efficiency";
    skid_number [""] Number(|s| s.solved()?.skid?.skid_number), "gyroscopic moment over friction moment of a ball that grips";
    onset_number [""] Number(|s| s.solved()?.skid?.onset_number()), "skid onset number, the skid number times a factor for the friction that the slip of the lead takes: below 0.1 the ball grips, above 2 it skids";
    efficiency_error_bound [""] Number(|s| Some(s.solved()?.error?.efficiency)), "bound of the error of the efficiency: in model traction of its integration over the contact ellipses; in model auto against model traction, for 99 % of all points. Torque and powers follow from the efficiency; the numbers of the ball and of its contacts have no bound where auto takes another model than traction";
    loss_error_bound [""] Number(|s| s.solved()?.error?.loss), "the same of the power that is lost, relative to the lost power of this result; null: more than 0.5";
    self_locking [""] Flag(|s| s.self_locking()), "true if the screw is self-locking in this direction";
    controlling_race [""] Race(|s| Some(s.solved()?.control?.race)), "race on which the ball does not spin (raceway control)";
    control_consistent [""] Flag(|s| s.solved()?.control?.consistent), "true if the controlling race has the larger spin friction moment at this solution; false where neither race has it at its own solution";
    other_solutions [""] Count(|s| Some(s.solved()?.others?.count)), "number of other steady motions known at this point; null: unknown, as no search was made or it was lost";
    other_solution_efficiency [""] Number(|s| s.solved()?.others?.farthest_efficiency), "efficiency of the other steady motion whose efficiency differs most";
    evidence [""] Evidence(|s| s.evidence()), "how sure no_solution is: proof; bound (an expansion whose error is smaller than what decides); traced (a curve that contains all solutions was followed in steps of finite size); sampled (also random starts found none)";
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
