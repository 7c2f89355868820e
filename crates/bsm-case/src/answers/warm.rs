//! Results for the warm steady state of an axis: quantities, uncertainty band, notes and warnings.

use bsm_nut::friction::FrictionSum;
use bsm_nut::thermal::{
    BranchState, Estimate, NoSteadyState, PhaseState, SteadyState, WarmNut, celsius,
};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use super::nut::QUANTITIES as NUT;
use crate::case::axis::AxisModel;
use crate::case::rated_nut;
use crate::case::warm::{Detail, Warm, WarmState};
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::members::{Keyed, Maybe, NumbersOf, answer, number_tables, row};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{RPM, UM};
use crate::{
    Answer, Case, CaseError, INPUTS, InputKey, InputSet, Numbers, Quantity, Row, Settings,
};

quantities! { pub(crate) QUANTITIES, read(&Warm) of Warm;
    "warm state" {
        nut_temperature_C ["C"] Scalar(|w| Some(state(w)?.celsius[0])), "steady temperature of nut and table";
        screw_temperature_C ["C"] Scalar(|w| Some(state(w)?.celsius[1])), "steady temperature of the screw along its travel";
        balls_temperature_C ["C"] Scalar(|w| Some(state(w)?.celsius[2])), "steady temperature of balls and oil";
        lubricant_temperature_C ["C"] Scalar(|w| state(w)?.oil), "temperature of the lubricant, given or calculated from the heat balance";
        end_1_temperature_C ["C"] Scalar(|w| Some(state(w)?.celsius[3])), "steady temperature of the screw end at the motor";
        end_2_temperature_C ["C"] Scalar(|w| Some(state(w)?.celsius[4])), "steady temperature of the other screw end";
        cold_preload_N = NUT Scalar(|w| Some(state(w)?.preload?.cold));
        warm_preload_N = NUT Scalar(|w| Some(state(w)?.preload?.warm));
        preload_setting_um = NUT Scalar(|w| Some(state(w)?.preload?.setting / UM));
        steady_heat_W ["W"] Scalar(|w| Some(state(w)?.steady.heat())), "heat flow of contacts, drag, seals, support bearings and motor in the steady state";
        nut_heat_W ["W"] Scalar(|w| Some(state(w)?.steady.nut_heat())), "heat flow of contacts, drag and seals in the steady state, without support bearings and motor";
        cold_cycle_life_revolutions [""] Scalar(|w| state(w)?.cold_life), "life under the cycle according to ISO 3408-5 with the cold preload, revolutions";
        cold_stiffness_N_um ["N/um"] Scalar(|w| Some(state(w)?.stiffness?[0] * UM)), "tangent stiffness of the preloaded nut without load, cold";
        no_load_stiffness_N_um ["N/um"] Scalar(|w| Some(state(w)?.stiffness?[1] * UM)), "tangent stiffness of the preloaded nut without load, warm";
        screw_tension_N = INPUTS Scalar(|w| state(w)?.tension);
        loop_gain [""] Scalar(|w| Some(state(w)?.steady.gain)), "loop gain of the feedback between heat and preload; 1 at the speed of thermal runaway";
        fold_speed_factor [""] Scalar(|w| Some(w.fold.as_ref()?.factor)), "speed of thermal runaway / speed; no steady state exists above this ratio";
        fold_searched_to [""] Scalar(|w| w.search.filter(|_| w.fold.is_none() && w.end.is_none())), "multiple of the given speeds up to which no fold exists";
        fold_nut_temperature_C ["C"] Scalar(|w| at_fold(w, 0)), "temperature of the nut at the fold";
        fold_screw_temperature_C ["C"] Scalar(|w| at_fold(w, 1)), "temperature of the screw at the fold";
        fold_balls_temperature_C ["C"] Scalar(|w| at_fold(w, 2)), "temperature of the balls at the fold";
        fold_preload_N ["N"] Scalar(|w| w.fold.as_ref()?.preload), "warm preload at the fold";
        unstable_nut_temperature_C ["C"] Scalar(|w| unstable(w, 0)), "temperature of the nut in the unstable state at the given speeds";
        unstable_screw_temperature_C ["C"] Scalar(|w| unstable(w, 1)), "temperature of the screw in the unstable state at the given speeds";
        unstable_balls_temperature_C ["C"] Scalar(|w| unstable(w, 2)), "temperature of the balls in the unstable state at the given speeds";
        unstable_preload_N ["N"] Scalar(|w| Some(w.fold.as_ref()?.unstable.as_ref()?.heated.preload)), "warm preload in the unstable state at the given speeds, above which the axis runs away thermally";
    }
    "conductances" {
        nut_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.nut));
        screw_film_W_m2K = INPUTS Scalar(|w| Some(state(w)?.conductances.screw_film));
        gap_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.gap));
        ball_nut_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.ball_nut));
        ball_screw_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.ball_screw));
        end_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.end));
        coolant_conductance_W_K = INPUTS Scalar(|w| Some(state(w)?.conductances.coolant));
    }
}

fn state(warm: &Warm) -> Option<&WarmState> {
    warm.state.as_ref()
}

number_tables! {
    /// Results for a warm state.
    pub(crate) WarmNumbers = QUANTITIES.iter();
}

/// Conductances of the warm state that can also be inputs.
const CONDUCTANCES: InputSet = inputs! {
    nut_conductance_W_K screw_film_W_m2K gap_conductance_W_K ball_nut_conductance_W_K
    ball_screw_conductance_W_K end_conductance_W_K coolant_conductance_W_K
};

/// Origin of a conductance.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ConductanceOrigin {
    /// An input.
    Given,
    /// The conductance is calculated from speeds and dimensions.
    Computed,
    /// The conductance has its default value of zero.
    Default,
}

row! {
    /// A conductance of the thermal network.
    pub(crate) struct Conductance {
        [skip] name: &'static str = "conductance";
        value: Option<f64>;
        origin: ConductanceOrigin = "origin";
    }
}

row! {
    /// Uncertainty band of a result.
    pub(crate) struct BandRow {
        [skip] name: String = "number, phase";
        low: Option<f64> = "low";
        value: f64 = "value";
        high: Option<f64> = "high";
    }
}

answer! {
    /// Warm state of an axis.
    pub(crate) struct WarmMembers {
        [skip_serializing_if = "Maybe::is_none"] warm: Maybe<NumbersOf<WarmNumbers>>;
        [skip_serializing_if = "Maybe::is_none"] conductances: Maybe<Keyed<Conductance>>;
        [skip_serializing_if = "Maybe::is_none"] band: Maybe<Keyed<BandRow>>;
    }
}

impl WarmState {
    /// Builds the table of conductances. Each conductance is given, is calculated from speeds and
    /// dimensions, or has its default value of zero.
    fn conductances(&self, numbers: &Numbers) -> Keyed<Conductance> {
        let row = |row: &Row| {
            let (name, [value, ..]) = (row.quantity.name, row.values);
            let key = InputKey::known(name).filter(|key| CONDUCTANCES.contains(*key))?;
            let origin = match value {
                _ if self.given.contains(key) => ConductanceOrigin::Given,
                Some(0.0) => ConductanceOrigin::Default,
                _ => ConductanceOrigin::Computed,
            };
            Some(Conductance { name, value, origin })
        };
        Keyed(numbers.rows().filter_map(row).collect())
    }
}

/// Returns the temperature \[°C\] of a network node at the fold, the highest speed with a thermal
/// steady state.
fn at_fold(warm: &Warm, node: usize) -> Option<f64> {
    let fold = warm.fold.as_ref()?;
    Some(celsius(fold.assembly_temperature, &fold.rises)[node])
}

/// Returns the temperature of a network node in the unstable steady state at the given speeds
/// \[°C\].
fn unstable(warm: &Warm, node: usize) -> Option<f64> {
    let fold = warm.fold.as_ref()?;
    Some(celsius(fold.assembly_temperature, &fold.unstable.as_ref()?.rises)[node])
}

/// Returns true if a result can be calculated only by following the branch of warm states up to the
/// fold, the highest speed with a thermal steady state.
fn is_of_fold(name: &str) -> bool {
    name.starts_with("fold_") || name.starts_with("unstable_")
}

/// Results for a warm state that have an uncertainty band.
const BAND_RESULTS: [&str; 10] = [
    "nut_temperature_C",
    "screw_temperature_C",
    "balls_temperature_C",
    "end_1_temperature_C",
    "end_2_temperature_C",
    "warm_preload_N",
    "steady_heat_W",
    "screw_growth_um",
    "screw_tension_N",
    "loop_gain",
];

/// Results for each phase with motion that have an uncertainty band.
const PHASE_BAND_RESULTS: [&str; 2] =
    ["contact_friction_torque_Nm", "preload_drag_beyond_contacts_Nm"];

/// Returns two values: whether the lower bound and whether the upper bound of a result is missing
/// because no steady state exists under some of the varied assumptions.
/// In case of thermal runaway or of an excessive temperature, the upper bounds are missing, except
/// that the lower bound is missing for the screw tension. In all other cases, both bounds are
/// missing.
fn missing_bounds(unsolved: &[(Estimate, f64, NoSteadyState)], name: &str) -> [bool; 2] {
    let heats = |why: &NoSteadyState| {
        matches!(why, NoSteadyState::RunsAway(_) | NoSteadyState::TooHot { .. })
    };
    let unknown = unsolved.iter().any(|(.., why)| !heats(why));
    let grows = unsolved.iter().any(|(.., why)| heats(why));
    let falls = name == "screw_tension_N";
    [unknown || grows && falls, unknown || grows && !falls]
}

/// Returns the results for a warm state: first the results in [`BAND_RESULTS`], and then the results in
/// [`PHASE_BAND_RESULTS`] for each phase with motion.
fn band_values(nut: &WarmNut<'_>, steady: &SteadyState) -> Vec<f64> {
    let network = nut.network(1.0);
    let (growth, tension) =
        (network.thermal_expansion(&steady.rises), network.tension(&steady.rises));
    let whole = [steady.heated.preload, steady.heat(), growth / UM, tension, steady.gain];
    let moving = steady.heated.phases.iter().flatten();
    let torques = moving.filter_map(|phase| {
        let FrictionSum { torque, ball_returns, .. } = phase.friction?;
        Some([torque + ball_returns, phase.drag])
    });
    celsius(nut.assembly_temperature, &steady.rises)
        .into_iter()
        .chain(whole)
        .chain(torques.flatten())
        .collect()
}

impl Warm {
    /// Calculates the warm state and its uncertainty band, if the case requests a warm state.
    pub(crate) fn with_band(
        case: &Case,
        settings: &Settings,
        detail: Detail,
    ) -> Result<Option<Self>, CaseError> {
        Self::of(case, settings, detail, band_values)
    }

    /// Adds results, conductances and uncertainty band of the warm state to an answer, if the warm
    /// state was requested.
    pub(crate) fn add_to(warm: Option<&Self>, answer: Answer) -> Answer {
        let Some(warm) = warm else { return answer };
        let numbers = read(warm, |_| true).where_finite();
        let conductances = state(warm).map(|state| state.conductances(&numbers));
        answer.with_members(WarmMembers {
            warm: Maybe(Some(NumbersOf::new(numbers, "warm"))),
            conductances: Maybe(conductances),
            band: Maybe(warm.band()),
        })
    }

    /// Builds the table of the uncertainty band.
    fn band(&self) -> Option<Keyed<BandRow>> {
        let state = state(self)?;
        let band = state.band.as_ref()?;
        let moving = state.steady.heated.phases.iter().enumerate();
        let moves =
            |phase: &Option<PhaseState>| phase.as_ref().is_some_and(|p| p.friction.is_some());
        let moving = moving.filter(|(_, phase)| moves(phase)).map(|(place, _)| place + 1);
        let of_phase =
            moving.flat_map(|number| PHASE_BAND_RESULTS.map(|name| format!("{name} {number}")));
        let names = BAND_RESULTS.map(str::to_owned).into_iter().chain(of_phase);
        let row = |((name, value), [low, high]): ((String, &f64), &[f64; 2])| {
            let [no_low, no_high] = missing_bounds(&band.failures, &name);
            let [low, high] =
                [(low, no_low), (high, no_high)].map(|(end, open)| (!open).then_some(*end));
            BandRow { name, low, value: *value, high }
        };
        let rows = names.zip(&band.values).zip(&band.limits);
        let is_there = |((name, value), _): &((String, &f64), &[f64; 2])| {
            let tension = name == "screw_tension_N" && state.tension.is_none();
            !(tension || value.is_nan())
        };
        Some(Keyed(rows.filter(is_there).map(row).collect()))
    }

    /// Returns notes on the assumptions behind the temperatures.
    pub(crate) fn notes(&self) -> Vec<String> {
        let Some(state) = state(self) else { return Vec::new() };
        let mut notes = Vec::new();
        if state.given.contains(InputKey::lubricant_temperature_C) {
            let what = "The given lubricant_temperature_C is not used, because the temperature follows from the warm steady state.";
            notes.push(what.to_owned());
        }
        if state.given.contains(InputKey::ball_gap_mm) {
            notes.push(
                "The warm state excludes the friction heat of ball-to-ball contact.".to_owned(),
            );
        }
        if state.steady.is_at_discontinuity {
            let what = "The friction of some balls is discontinuous at the warm state, because the \
                        controlling raceway or the model changes there. The calculated state uses \
                        the friction on one side of the jump.";
            notes.push(what.to_owned());
        }
        let Some(band) = &state.band else { return notes };
        if let Some(why) = &band.complete_failure {
            notes.push(format!(
                "With typical values for the missing seal and support bearing torques, {why}."
            ));
        }
        if let (None, Some(search)) = (&self.fold, self.search) {
            notes.push(match &self.end {
                Some(why) => format!("The warm state has no fold: {why}"),
                None => format!(
                    "No fold of the warm state was found up to {search} times the given speeds."
                ),
            });
        }
        for (estimate, factor, why) in &band.failures {
            let (times, way) =
                if *factor > 1.0 { (*factor, "larger") } else { (factor.recip(), "smaller") };
            notes.push(format!("{why} if {} {times} times {way}", estimate.clause()));
        }
        if !band.failures.is_empty() {
            let what =
                "The uncertainty band is open (null) on the side where no steady state exists.";
            notes.push(what.to_owned());
        }
        notes
    }

    /// Returns the most important warning about the warm state, if there is one.
    pub(crate) fn warning(&self) -> Option<String> {
        let Some(state) = state(self) else {
            let fold = self.fold.as_ref()?;
            return Some(format!("no warm steady state: {fold}"));
        };
        if let Some(why) = &self.replaced {
            return Some(format!(
                "Model traction has no warm state here: {why}. The warm state and the friction therefore follow from model \
                 raceway-control, whose friction is limited by gross sliding, and are less certain. A larger load or a preload \
                 avoids this."
            ));
        }
        if state.preload.is_some_and(|preload| preload.warm <= 0.0) {
            return Some("The preload is lost in the warm state, so the nut has play.".to_owned());
        }
        None
    }
}

/// Branch of warm steady states of an axis. The branch begins at standstill, reaches its highest
/// speed at the fold, and returns to lower speeds along the unstable states.
#[derive(Debug, Clone)]
#[expect(
    non_snake_case,
    reason = "the names end with units, and some unit symbols are capital letters"
)]
pub struct WarmBranch {
    /// States in order along the branch.
    pub points: Vec<WarmPoint>,
    /// Largest screw speed in the case \[rpm\].
    pub speed_rpm: f64,
    /// Preload as set at assembly \[N\]; `None` without a preload.
    pub cold_preload_N: Option<f64>,
}

/// A steady state on a [`WarmBranch`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(
    non_snake_case,
    reason = "the names end with units, and some unit symbols are capital letters"
)]
pub struct WarmPoint {
    /// Largest screw speed \[rpm\].
    pub speed_rpm: f64,
    /// Temperatures of nut, screw and balls \[°C\].
    pub temperatures_C: [f64; 3],
    /// Preload without external load \[N\].
    pub preload_N: f64,
    /// True for stable states, which precede the fold on the branch, and false for unstable states,
    /// which follow the fold.
    pub stable: bool,
}

impl WarmBranch {
    /// Calculates the branch of warm states up to `fold_search_factor` times the speeds of the
    /// case. Returns `None` if the case does not request its warm state.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input is missing or violates its rule, or if no steady state
    /// exists at low speed.
    #[expect(
        non_snake_case,
        reason = "the names end with units, and some unit symbols are capital letters"
    )]
    pub fn of(case: &Case, settings: &Settings) -> Result<Option<Self>, CaseError> {
        if !case.requests_warm_state() {
            return Ok(None);
        }
        let (set, cold_preload_N, states) = Warm::branch(case, settings)?;
        let speed_rpm = AxisModel::of(case)?.axis.fastest() / RPM;
        let point = |state: BranchState| {
            let [nut, screw, balls, ..] = celsius(set, &state.rises);
            WarmPoint {
                speed_rpm: state.factor * speed_rpm,
                temperatures_C: [nut, screw, balls],
                preload_N: state.preload,
                stable: state.stable,
            }
        };
        Ok(Some(Self {
            points: states.into_iter().map(point).collect(),
            speed_rpm,
            cold_preload_N,
        }))
    }

    /// Returns the state at the fold, which has the highest speed on the branch. Returns `None` if
    /// the branch ends without unstable states.
    pub fn fold(&self) -> Option<&WarmPoint> {
        let first_beyond = self.points.iter().position(|point| !point.stable)?;
        self.points[..first_beyond].last()
    }

    /// Converts the branch to a JSON object. Each member is a list with one value per state.
    pub fn to_json(&self) -> Value {
        let list = |number: &dyn Fn(&WarmPoint) -> f64| -> Value {
            self.points.iter().map(number).collect()
        };
        json!({
            "screw_speed_rpm": list(&|point| point.speed_rpm),
            "nut_temperature_C": list(&|point| point.temperatures_C[0]),
            "screw_temperature_C": list(&|point| point.temperatures_C[1]),
            "balls_temperature_C": list(&|point| point.temperatures_C[2]),
            "warm_preload_N": list(&|point| point.preload_N),
            "stable": self.points.iter().map(|point| point.stable).collect::<Vec<_>>(),
            "asked_rpm": self.speed_rpm,
        })
    }
}

/// Returns the names of missing inputs that the warm state requires.
pub(crate) fn missing(base: &Case, given: InputSet) -> Vec<String> {
    let state = (!base.requests_warm_state()).then(|| "warm_state (true)".to_owned());
    let stroke = (!given.contains(InputKey::stroke_mm)).then(|| "stroke_mm".to_owned());
    rated_nut::NEEDS.missing(given).into_iter().chain(state).chain(stroke).collect()
}

/// Calculates the results for the warm state. If the case does not request the warm state, there
/// are no results.
///
/// * `wanted`: function that returns true for the quantities to calculate. The fold, which is the
///   highest speed with a thermal steady state, is searched for only if one of these quantities
///   refers to it; otherwise, thermal runaway is an error.
pub(crate) fn numbers(
    case: &Case,
    settings: &Settings,
    wanted: impl Fn(&Quantity) -> bool,
) -> Result<Numbers, CaseError> {
    let any =
        |of_fold: bool| QUANTITIES.iter().any(|of| is_of_fold(of.name) == of_fold && wanted(of));
    let fold = any(true);
    let warm = if fold && !any(false) {
        Warm::with_band(case, settings, Detail { fold, ..Detail::WITHOUT_BAND })
    } else {
        Warm::state_of(case, settings, fold)
    }?;
    Ok(warm.map_or_else(|| Numbers::none(QUANTITIES), |warm| read(&warm, wanted).where_finite()))
}
