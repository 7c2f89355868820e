//! The outputs: one table that records, tables and schema are made from.

use bsm_dyn::{ContactFilm, Control, Evidence, FilmState, Solution, Transmission, ZERO_CELSIUS};
use bsm_kin::{Motion, Site};
use serde_json::{Value, json};

use super::number::count;
use super::quantity::{AnalysisKind, Quantity, Scope};
use crate::vocabulary::units::{DEG, GPA, MILLI, MM, MPA, UM, direction_deg};

/// One output of the vocabulary.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Name, with its unit as suffix.
    pub name: &'static str,
    /// Unit as text; empty if dimensionless.
    pub unit: &'static str,
    /// JSON type.
    pub json_type: &'static str,
    /// The possible texts; empty for numbers.
    pub words: &'static [&'static str],
    /// Meaning.
    pub about: &'static str,
    pub(crate) origin: Origin,
}

/// Where the value of an output comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// From the solution of a model.
    Solution { key: OutputKey, read: fn(&Solution) -> Option<f64> },
    /// From a table of quantities, which may be that of an analysis: a number of one of them.
    Table { kind: Option<AnalysisKind> },
}

impl Output {
    /// A number of a table.
    pub(crate) const fn of_table(
        name: &'static str,
        unit: &'static str,
        json_type: &'static str,
        about: &'static str,
        kind: Option<AnalysisKind>,
    ) -> Self {
        Self { name, unit, json_type, words: &[], about, origin: Origin::Table { kind } }
    }

    /// The value in a solution, in the unit of the vocabulary; `None` if it has none. No is 0 and yes is 1, a text its
    /// place among the texts.
    pub fn read(&self, solution: &Solution) -> Option<f64> {
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
        let of_the_ball = K::axial_displacement_um as usize..=K::ball_omega_b_rad_s as usize;
        let of_its_contacts = K::nut_normal_load_N as usize..=K::screw_approach_um as usize;
        let place = self.key().map(|key| key as usize);
        place.is_some_and(|key| of_the_ball.contains(&key) || of_its_contacts.contains(&key))
    }

    /// The word of a number in a column of texts.
    pub fn word(&self, number: f64) -> Option<&'static str> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let place = number as usize;
        self.words.get(place).filter(|_| !number.is_nan()).copied()
    }

    /// A value in JSON.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
    pub(crate) fn json(&self, value: f64) -> Value {
        match self.json_type {
            "integer" => json!(value as u64),
            "boolean" => json!(value > 0.5),
            "string" => json!(self.word(value)),
            _ => json!(value),
        }
    }
}

/// `"label" ["unit"] Kind: name member = reader, "meaning";`, several names with their members for the contacts.
macro_rules! outputs {
    ($($title:literal { $(
        $label:literal [$unit:literal $($symbol:literal)?] $kind:ident: $($name:ident $at:ident)+ = $read:expr, $about:literal;
    )* })*) => {
        /// All outputs of a solution, in the order of the documentation.
        pub const OUTPUTS: &[Output] =
            &[$($($(outputs!(@output $name $at, $unit, $kind, $read, $about),)+)*)*];

        /// The same for people: one quantity for the contacts. Those titled "hidden" are part of a sentence.
        pub(crate) const SOLUTION: &[Quantity] = &[$($(Quantity {
            name: outputs!(@first $($name)+),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $label,
            title: $title,
            scope: outputs!(@scope $($at)+),
            columns: &[$(outputs!(@output $name $at, $unit, $kind, $read, $about),)+],
            ..Quantity::WHOLE
        },)*)*];

        /// An output as a number: its place in [`OUTPUTS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "the names of the vocabulary")]
        pub enum OutputKey {
            $($($(#[doc = $about] $name,)+)*)*
        }
    };
    (@output $name:ident $at:ident, $unit:literal, $kind:ident, $read:expr, $about:literal) => {
        Output {
            name: stringify!($name),
            unit: $unit,
            json_type: outputs!(@json $kind),
            words: outputs!(@words $kind),
            about: concat!($about, outputs!(@said $at)),
            origin: Origin::Solution {
                key: OutputKey::$name,
                read: |solution| {
                    let read: fn(&Solution, Site) -> Option<_> = $read;
                    read(solution, outputs!(@site $at)).map(outputs!(@number $kind))
                },
            },
        }
    };
    (@first $name:ident $($other:ident)*) => { stringify!($name) };
    (@scope whole) => { Scope::Scalar };
    (@scope $($at:ident)+) => { Scope::Contacts };
    (@said nut) => { ", nut" };
    (@said screw) => { ", screw" };
    (@said unloaded) => { ", unloaded flank of the nut" };
    (@said whole) => { "" };
    (@site screw) => { Site::Screw };
    (@site unloaded) => { Site::NutUnloaded };
    (@site $at:ident) => { Site::Nut };
    (@json Number) => { "number" };
    (@json Count) => { "integer" };
    (@json Flag) => { "boolean" };
    (@json Raceway) => { "string" };
    (@json Evidence) => { "string" };
    // As it stands in a column of numbers: no is 0 and yes is 1, a text its place among the texts of its output.
    (@number Number) => { |number: f64| number };
    (@number Count) => { |number: usize| count(number) };
    (@number Flag) => { |holds: bool| f64::from(u8::from(holds)) };
    (@number Raceway) => { |raceway: Control| f64::from(raceway as u8) };
    (@number Evidence) => { |evidence: Evidence| f64::from(evidence.rank()) };
    (@words Raceway) => { &["nut", "screw"] };
    (@words Evidence) => { &Evidence::NAMES };
    (@words $kind:ident) => { &[] };
}

fn transmission(solution: &Solution) -> Option<&Transmission> {
    Some(&solution.solved()?.transmission)
}

fn lubricant(solution: &Solution) -> Option<&FilmState> {
    solution.solved()?.film.as_ref()
}

fn film(solution: &Solution, at: Site) -> Option<&ContactFilm> {
    let state = lubricant(solution)?;
    Some(if at == Site::Screw { &state.screw } else { &state.nut })
}

fn motion(solution: &Solution) -> Option<Motion<f64>> {
    solution.solved()?.ball.motion
}

outputs! {
    "" {
        "efficiency of the balls" ["" "eta"] Number: efficiency whole = |s, _| s.efficiency(),
            "output power over input power of the balls, without preload, seals and bearings; negative: self-locking";
        "torque of the balls" ["N m"] Number: ball_torque_Nm whole = |s, _| transmission(s)?.screw_torque,
            "torque of all balls on the screw; screw_torque_Nm has preload, seals and bearings, too";
        "input power" ["W"] Number: input_power_W whole = |s, _| Some(transmission(s)?.power?.input),
            "input power, all balls";
        "output power" ["W"] Number: output_power_W whole = |s, _| Some(transmission(s)?.power?.output),
            "output power, all balls";
        "dissipated power" ["W"] Number: dissipated_power_W whole = |s, _| Some(transmission(s)?.power?.dissipated),
            "dissipated power, all balls";
        "  sliding at the contacts" ["W"] Number: sliding_power_W whole = |s, _| Some(lubricant(s)?.sliding_power),
            "power lost by sliding at the contacts, all balls";
        "  rolling resistance" ["W"] Number: rolling_power_W whole = |s, _| Some(lubricant(s)?.rolling_power),
            "power lost by rolling resistance of lubricant and hysteresis, all balls";
        "  ball-to-ball contact" ["W"] Number: ball_contact_power_W whole = |s, _| Some(lubricant(s)?.outside.ball_contact),
            "power lost by ball-to-ball contact";
        "  ball returns" ["W"] Number: return_power_W whole = |s, _| Some(lubricant(s)?.outside.ball_return),
            "power lost in the ball returns";
        "  drag" ["W"] Number: drag_power_W whole = |s, _| Some(lubricant(s)?.outside.drag),
            "power lost by drag of the balls in the lubricant";
        "equivalent constant friction coefficient" [""] Number: equivalent_friction_coefficient whole = |s, _| Some(lubricant(s)?.equivalent_friction),
            "constant friction coefficient with the same loss of the contacts at this point";
        "equivalent thread friction coefficient" [""] Number: catalogue_friction_coefficient whole = |s, _| Some(lubricant(s)?.catalogue_friction),
            "friction coefficient of a plain thread of the same efficiency, which catalogues state";
        "temperature of the lubricant" ["C"] Number: lubricant_temperature_C whole = |s, _| Some(lubricant(s)?.temperature - ZERO_CELSIUS),
            "temperature of the lubricant, given or that at which all losses leave as heat";
        "viscosity" ["mPa s" "eta_0"] Number: viscosity_mPas whole = |s, _| Some(lubricant(s)?.viscosity / MILLI),
            "dynamic viscosity of the lubricant at its temperature";
        "pressure-viscosity coefficient" ["1/GPa" "alpha_p"] Number: pressure_viscosity_1_GPa whole = |s, _| Some(lubricant(s)?.pressure_viscosity * GPA),
            "pressure-viscosity coefficient of the lubricant";
        "heating of the film" ["K"] Number: film_heating_K whole = |s, _| Some(lubricant(s)?.heating),
            "by how much sliding heats the hotter film; not in the viscosity";
        "efficiency error bound" [""] Number: efficiency_error_bound whole = |s, _| Some(s.solved()?.error?.efficiency),
            "bound of the error of the efficiency: in model traction of its integration over the contact ellipses; in model auto against model traction, for 99 % of all points. Torque and powers follow from the efficiency; the numbers of the ball and of its contacts have no bound where auto takes another model than traction";
        "relative loss error bound" [""] Number: loss_error_bound whole = |s, _| s.solved()?.error?.loss,
            "the same of the power that is lost, relative to the lost power of this result; null: more than 0.5";
        "axial displacement of the nut" ["um"] Number: axial_displacement_um whole = |s, _| Some(s.solved()?.ball.axial_displacement? / UM),
            "axial displacement of the nut";
        "ball precession about the axis" ["rad/s" "omega_m"] Number: ball_precession_rad_s whole = |s, _| Some(motion(s)?.precession),
            "precession, the angular velocity of the ball centre about the screw axis";
        "ball rotation along the helix t" ["rad/s"] Number: ball_omega_t_rad_s whole = |s, _| Some(motion(s)?.omega.x),
            "angular velocity of the ball along the helix";
        "ball rotation towards the axis n" ["rad/s"] Number: ball_omega_n_rad_s whole = |s, _| Some(motion(s)?.omega.y),
            "angular velocity of the ball towards the axis";
        "ball rotation along the binormal b" ["rad/s"] Number: ball_omega_b_rad_s whole = |s, _| Some(motion(s)?.omega.z),
            "angular velocity of the ball along the binormal";
        "skid number" [""] Number: skid_number whole = |s, _| s.solved()?.skid?.skid_number,
            "gyroscopic moment over friction moment of a rolling ball";
        "skid onset number" [""] Number: onset_number whole = |s, _| s.solved()?.skid?.onset_number(),
            "skid onset number, the skid number times a factor for the friction that the slip of the lead takes: below 0.1 the ball rolls, above 2 it is in gross skid";
    }
    "contact" {
        "normal load per ball" ["N" "Q"] Number: nut_normal_load_N nut screw_normal_load_N screw unloaded_flank_normal_load_N unloaded = |s, at| s.contact(at)?.load,
            "normal load of a ball";
        "contact angle" ["deg" "alpha"] Number: nut_contact_angle_deg nut screw_contact_angle_deg screw = |s, at| Some(s.contact(at)?.angle / DEG),
            "contact angle";
        "slip speed" ["m/s"] Number: nut_slip_velocity_m_s nut screw_slip_velocity_m_s screw unloaded_flank_slip_velocity_m_s unloaded = |s, at| Some(s.contact(at)?.slip?.speed),
            "slip speed";
        "direction of friction" ["deg"] Number: nut_slip_angle_deg nut screw_slip_angle_deg screw unloaded_flank_slip_angle_deg unloaded = |s, at| Some(direction_deg(s.contact(at)?.slip_angle?)),
            "direction of friction on the ball";
        "spin about the normal" ["rad/s"] Number: nut_spin_rad_s nut screw_spin_rad_s screw = |s, at| Some(s.contact(at)?.slip?.spin),
            "spin about the contact normal, relative to nut or screw";
        "largest pressure" ["MPa" "p_max"] Number: nut_max_pressure_MPa nut screw_max_pressure_MPa screw = |s, at| Some(s.contact(at)?.pressed?.max_pressure / MPA),
            "largest Hertz pressure";
        "ellipse across the groove" ["mm" "a"] Number: nut_ellipse_a_mm nut screw_ellipse_a_mm screw = |s, at| Some(s.contact(at)?.pressed?.semi_axes.0 / MM),
            "semi-axis across the groove";
        "ellipse along the groove" ["mm" "b"] Number: nut_ellipse_b_mm nut screw_ellipse_b_mm screw = |s, at| Some(s.contact(at)?.pressed?.semi_axes.1 / MM),
            "semi-axis along the groove";
        "elastic approach" ["um" "delta"] Number: nut_approach_um nut screw_approach_um screw = |s, at| Some(s.contact(at)?.pressed?.approach / UM),
            "elastic approach";
        "film" ["um" "h"] Number: nut_film_um nut screw_film_um screw = |s, at| Some(film(s, at)?.thickness / UM),
            "film thickness";
        "film ratio" ["" "Lambda"] Number: nut_film_ratio nut screw_film_ratio screw = |s, at| Some(film(s, at)?.ratio),
            "film thickness over roughness: below 0.3 boundary, to 2 mixed, above full film";
        "asperity load share" ["" "xi"] Number: nut_asperity_share nut screw_asperity_share screw = |s, at| Some(film(s, at)?.asperity_share),
            "share of the load that asperities carry";
        "friction coefficient" ["" "mu"] Number: nut_friction_coefficient nut screw_friction_coefficient screw = |s, at| Some(film(s, at)?.friction),
            "mean friction coefficient: sliding power over that of a coefficient of one";
        "rolling moment" ["N mm"] Number: nut_rolling_moment_Nmm nut screw_rolling_moment_Nmm screw = |s, at| Some(film(s, at)?.rolling_moment / MM),
            "couple against rolling, by lubricant and hysteresis";
        "entrainment" ["m/s" "u"] Number: nut_entrainment_m_s nut screw_entrainment_m_s screw = |s, at| Some(film(s, at)?.entrainment),
            "mean speed of both surfaces along the track";
    }
    "hidden" {
        "power_balance" [""] Number: power_balance whole = |s, _| transmission(s)?.power_balance,
            "relative error of the power balance, rounding only at an exact solution";
        "iterations" [""] Count: iterations whole = |s, _| Some(s.solved()?.info?.steps),
            "Newton steps, or sweeps of `rigid`";
        "residual_norm" [""] Number: residual_norm whole = |s, _| Some(s.solved()?.info?.residual),
            "scaled residual of the equations";
        "seal_power_W" ["W"] Number: seal_power_W whole = |s, _| Some(lubricant(s)?.outside.seal),
            "power lost at the seals, which warms the lubricant; a part of screw_torque_Nm, not of dissipated_power_W";
        "self_locking" [""] Flag: self_locking whole = |s, _| s.self_locking(),
            "true if the screw is self-locking in this direction";
        "controlling_raceway" [""] Raceway: controlling_raceway whole = |s, _| Some(s.solved()?.control?.raceway),
            "raceway on which the ball does not spin (raceway control)";
        "control_consistent" [""] Flag: control_consistent whole = |s, _| s.solved()?.control?.consistent,
            "true if the controlling raceway has the larger spin friction moment at this solution; false where neither raceway has it at its own solution";
        "other_solutions" [""] Count: other_solutions whole = |s, _| Some(s.solved()?.alternatives?.count),
            "number of other steady motions known at this point; null: unknown, as no search was made or it was lost";
        "other_solution_efficiency" [""] Number: other_solution_efficiency whole = |s, _| s.solved()?.alternatives?.farthest_efficiency,
            "efficiency of the other steady motion whose efficiency differs most";
        "evidence" [""] Evidence: evidence whole = |s, _| s.evidence(),
            "evidence of no_solution: proof; bound (an expansion whose error is smaller than what decides); traced (a curve that contains all solutions was followed in steps of finite size); sampled (also random starts found none)";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns hold the place of a word.
    #[test]
    fn raceways_are_told_by_their_places() {
        let output = Output::named("controlling_raceway").expect("an output");
        for raceway in Control::ALL {
            assert_eq!(output.word(f64::from(raceway as u8)), Some(raceway.name()));
        }
    }
}
