//! Solutions of a model as named quantities with units.

use bsm_dyn::{
    Model, ModelWorkspace, Problem, Reason, Solution, Status, SteadyState,
    gothic::FarFlank,
    lubrication::{FilmState, Regime, ZERO_CELSIUS},
    model::{Basis, Choice, ErrorBound, LossInterval, MAX_ROLLING_ONSET},
    solution::{Alternatives, ContactState, ControllingRaceway, Slip, SlipRegime},
};
use bsm_kin::Site;
use serde_json::{Map, Value, json};

use crate::answers::axis::TorqueParts;
use crate::answers::band::{NO_INTERVAL, high, low};
use crate::answers::schema::{CaseJson, RecordJson};
use crate::answers::section::{GrooveSection, beyond_the_flank};
use crate::answers::sensitivity::SensitivityRow;
use crate::case::problem::SettingsJson;
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::members::{Data, Keyed, Label, Maybe, Word, answer, row};
use crate::vocabulary::output::SOLUTION;
use crate::vocabulary::units::{DEG, MM, MPA, UM};
use crate::{
    Answer, Case, CaseError, Content, MissingInput, ModelChoice, Numbers, OUTPUTS, Output,
    OutputName, OutputType, Section, Sensitivity, Settings, format_exact, output, torque_parts,
};

/// Hertzian pressure between ball and groove above which permanent indentations are expected
/// \[Pa\]. The static load rating of ISO 76 is based on this value.
pub(crate) const MARKS_ABOVE: f64 = 4.2e9;

/// Explains why `auto` chose a certain model, based on the error bound.
///
/// * `bound`: bound on the error of the efficiency; `None` if the error is unknown because the
///   `traction` model has no solution.
pub fn reason_of_choice(choice: &Choice, bound: Option<f64>) -> String {
    let Some(bound) = bound else {
        return format!(
            "the efficiency error is unknown, because model traction has no result here; the result comes from model {}",
            choice.basis.model().name()
        );
    };
    let why = match choice.basis {
        Basis::Rolling { onset_number } if bound > choice.tolerance => format!(
            "; no more accurate model has a result here, and raceway control has a skid onset number of {onset_number:.2e}"
        ),
        Basis::Rolling { onset_number } => {
            format!(", because the ball rolls (skid onset number {onset_number:.2e})")
        }
        Basis::GrossSkid { onset_number } => {
            format!(", because the ball is in gross skid (skid onset number {onset_number:.1})")
        }
        Basis::Integrated { accuracy } => {
            format!(
                ", because friction is integrated with an accuracy of {accuracy:.0e}; no faster model is accurate enough here"
            )
        }
        other => format!(": {other:?}"),
    };
    format!("efficiency error at most {bound:.1e}{why}")
}

/// Result at one operating point: model, status and outputs, or the reason why there are no
/// outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    model: ModelChoice,
    /// Solution of the model; `None` if the inputs are invalid for the model.
    solution: Option<Solution>,
    message: Option<String>,
}

impl Record {
    /// Creates a record from the solution of a model. If an output overflows, the record contains
    /// an error instead.
    pub fn new(solution: Solution) -> Self {
        let endless =
            |output: &&Output| output.read(&solution).is_some_and(|value| !value.is_finite());
        if let Some(output) = OUTPUTS.iter().find(endless) {
            let error = CaseError::beyond_double(output.name);
            return Self::invalid(ModelChoice::Fixed(solution.model), &error);
        }
        let message = solution.reason().map(message);
        Self { model: ModelChoice::Fixed(solution.model), solution: Some(solution), message }
    }

    /// Creates a record for a case whose inputs are invalid for `model`.
    pub fn invalid(model: ModelChoice, error: &CaseError) -> Self {
        Self { model, solution: None, message: Some(error.to_string()) }
    }

    /// Returns the model that solved the case or tried to solve it.
    pub fn model(&self) -> ModelChoice {
        self.model
    }

    /// Returns the solution of the model, or `None` if the inputs are invalid.
    pub fn into_solution(self) -> Option<Solution> {
        self.solution
    }

    /// Returns the steady state, if the solver converged.
    pub fn solved(&self) -> Option<&SteadyState> {
        self.solution.as_ref()?.steady_state()
    }

    /// Returns the status of the solution.
    pub fn status(&self) -> Status {
        self.solution.as_ref().map_or(Status::InvalidInput, Solution::status)
    }

    /// Returns the status name that is used in files.
    pub fn status_name(&self) -> &'static str {
        self.status().name()
    }

    /// Returns the value of an output (see [`Output::read`]).
    pub fn value(&self, output: &Output) -> Option<f64> {
        output.read(self.solution.as_ref()?)
    }

    /// Returns the value of the numeric output with the given name, if it exists.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.value(
            Output::named(name.name()).filter(|output| output.output_type == OutputType::Number)?,
        )
    }

    /// Returns true if the point is known to have more than one solution.
    pub fn has_others(&self) -> bool {
        self.others().is_some_and(|others| others.count > 0)
    }

    /// Returns the reason why there are no results, or `None` if the solver converged.
    pub fn message(&self) -> Option<&str> {
        self.message.as_deref()
    }

    /// Returns a description of the slip regime, for example rolling or gross skid.
    pub fn regime(&self) -> Option<&'static str> {
        let solution = self.solution.as_ref()?;
        let solved = solution.steady_state()?;
        if solved.transmission.self_locking {
            return Some("self-locking in this direction");
        }
        let regime = solved.skid.and_then(|skid| skid.regime());
        Some(match (solution.model, regime) {
            (Model::ClosedForm, _) => "gross skid and low inertia (assumed)",
            (Model::QuasiStatic, _) => "slip across the groove only (assumed)",
            (Model::Rigid | Model::Elastic, _) => {
                "gross skid with saturated friction at every contact (assumed)"
            }
            (_, Some(SlipRegime::Rolling)) => "rolling",
            (Model::RacewayControl, _) => "skidding; raceway control does not apply",
            (_, Some(SlipRegime::PartialSkid)) => "partial skid, between rolling and gross skid",
            _ => "gross skid with nearly saturated friction",
        })
    }

    /// Returns a sentence that explains why `auto` chose the model, or `None` if `auto` was not
    /// requested.
    pub fn choice(&self) -> Option<String> {
        let bound = self.solved()?.error.map(|error| error.efficiency);
        Some(reason_of_choice(&self.solution.as_ref()?.choice?, bound))
    }

    /// Returns the names of the outputs to which the error bound of the efficiency does not apply:
    /// the outputs of the ball and its contacts, if `auto` chose a model other than `traction`.
    pub fn unbounded(&self) -> Vec<&'static str> {
        let is_chosen =
            |solution: &&Solution| solution.choice.is_some() && solution.model != Model::Traction;
        let Some(solution) = self.solution.as_ref().filter(is_chosen) else { return Vec::new() };
        let own = OUTPUTS.iter().filter(|output| output.is_of_the_ball());
        own.filter(|output| output.read(solution).is_some()).map(|output| output.name).collect()
    }

    /// Returns the warnings about the inputs and the result. They are shown by `bsm solve` and in
    /// the rows of a table.
    pub fn all_warnings(&self, case: &Case) -> Vec<String> {
        case.warnings().into_iter().chain(self.warnings(case)).collect()
    }

    /// Returns warnings about the result. `case` contains the inputs.
    pub fn warnings(&self, case: &Case) -> Vec<String> {
        let mut warnings = Vec::new();
        let Some(solution) = &self.solution else { return warnings };
        let slip = |site| solution.contact(site).and_then(|contact| contact.slip);
        if let (Some(Slip { spin, .. }), Model::Rigid | Model::Elastic, None) =
            (slip(Site::Nut), solution.model, solution.choice)
        {
            let unloaded = slip(Site::NutUnloaded).map_or_else(String::new, |slip| {
                format!(", slip {:.0} m/s at the far flank", slip.speed)
            });
            warnings.push(format!(
                "The ball spin is {:.2e} rad/s{unloaded}. This model assumes gross skid, but a ball whose \
                 friction supports the gyroscopic moment rolls and loses less power. Model traction covers \
                 both{}.",
                spin.abs(),
                case.lacks(Model::Traction)
            ));
        }
        let onset = self.solved().and_then(|solved| solved.skid?.onset_number());
        if solution.model == Model::RacewayControl {
            warnings.extend(onset.and_then(skid_warning));
        }
        warnings.extend(self.film().map(film_warnings).unwrap_or_default());
        warnings.extend(self.far_flank(case));
        warnings.extend(self.ambiguities());
        if let (Some(Choice { tolerance, .. }), Some(solved)) = (solution.choice, self.solved()) {
            match solved.error {
                Some(ErrorBound { efficiency: bound, .. }) if bound > tolerance => {
                    warnings.push(format!(
                        "The tolerance of {tolerance:.1e} is not met: the error bound of the most accurate model \
                         here is {bound:.1e}."
                    ));
                }
                Some(_) => {}
                None => warnings.push(format!(
                    "The tolerance of {tolerance:.1e} is not met: model traction has no result here, so the error of model {} is unknown. To see the reason, solve the point with model traction.",
                    solution.model.name()
                )),
            }
        }
        let pressed = |site| solution.contact(site).and_then(|contact| contact.pressed);
        let pressures =
            [Site::Nut, Site::Screw].map(|s| pressed(s).map_or(0.0, |p| p.max_pressure));
        let pressure = pressures[0].max(pressures[1]);
        if pressure > MARKS_ABOVE {
            warnings.push(format!(
                "The pressure is {:.0} MPa. Above {:.0} MPa, balls leave permanent marks (ISO 76), but the \
                 models have only elastic contacts.",
                pressure / MPA,
                MARKS_ABOVE / MPA
            ));
        }
        match (GrooveSection::of(case), case.ball_diameter_mm) {
            (Ok(section), _) => warnings.extend(section.warnings(self)),
            // Without the land diameter, the flank is only known to lie between 0 and 90 deg.
            (Err(_), Some(ball)) => warnings.extend(self.cut_off(0.5 * MM * ball)),
            (Err(_), None) => {}
        }
        if solution.self_locking() == Some(true) {
            warnings.push(match solution.efficiency() {
                Some(eta) => format!(
                    "The efficiency of {eta:.4} is not positive: the screw is self-locking in this \
                     direction."
                ),
                None => "The screw is self-locking in this direction.".to_owned(),
            });
        }
        warnings
    }

    /// Returns notes on neglected effects.
    pub fn notes(&self) -> Vec<String> {
        let uncertainty = "Friction from the lubricant is uncertain by about 25 % of the contact loss. The model excludes ball-to-ball contact, ball returns, lead errors, deviations of the ball diameters, and four-point contact. Two contacts per ball cause about 15 to 40 % of the drag torque that the manufacturers' rule predicts for a preloaded nut.";
        self.film().map(|_| uncertainty.to_owned()).into_iter().collect()
    }

    /// Returns a note on the critical lead angle if the `rigid` model has no solution because the
    /// ball would roll on the nut. Table rows have no such note, because calculating this angle
    /// takes longer than solving the point.
    fn critical_lead_angle(&self, case: &Case, settings: &Settings) -> Option<String> {
        let (Some(Reason::NutContactWouldRoll { .. }), Ok(Problem::Rigid(rigid))) =
            (self.solution.as_ref()?.reason(), case.problem(settings))
        else {
            return None;
        };
        Some(match rigid.critical_lead_angle() {
            Some(angle) => format!(
                "For these inputs, model rigid has solutions above a critical lead angle of {:.4} deg.",
                angle / DEG
            ),
            None => {
                "No larger lead angle at which model rigid has a solution was found.".to_owned()
            }
        })
    }

    /// Returns a note on the threshold play. If the play is smaller, friction presses the ball
    /// against a far flank. There is no note if the play is given or if the model already
    /// calculates the threshold. Table rows have no such note, because it requires a solution with
    /// the `traction` model.
    fn threshold_play(
        &self,
        case: &Case,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Option<String> {
        if self.solved()?.ball.threshold_play.is_some() || case.reader().arch_fit().is_some() {
            return None;
        }
        let traction = Settings { model: Model::Traction.into(), ..*settings };
        let solution = case.problem(&traction).ok()?.solve(work);
        let threshold = solution.steady_state()?.ball.threshold_play? / UM;
        Some(format!(
            "If the axial play is below {threshold:.1} um (model traction), friction presses the ball against a \
             far flank of the gothic arch, and this third contact causes additional friction. Give axial_play_um \
             to include it."
        ))
    }

    fn film(&self) -> Option<&FilmState> {
        self.solved()?.film.as_ref()
    }

    /// Returns the lubrication regime at nut and screw: boundary, mixed or full film.
    pub fn lubrication(&self) -> Option<String> {
        let film = self.film()?;
        let [nut, screw] = [film.nut, film.screw].map(|film| Regime::of(film.ratio).name());
        Some(if nut == screw { nut.to_owned() } else { format!("{nut} (nut), {screw} (screw)") })
    }

    /// Returns a warning if the axial play is so small that friction presses the balls against a
    /// far flank.
    fn far_flank(&self, case: &Case) -> Option<String> {
        let (solved, fit) = (self.solved()?, case.reader().arch_fit()?);
        let threshold = solved.ball.threshold_play? / UM;
        let play = fit.axial_play / UM;
        let with = match case.radial_gap_um {
            Some(gap) => format!(" with a radial gap of {} um", format_exact(gap)),
            None => String::new(),
        };
        let below = format!(
            "The axial play of {} um{with} is below the threshold of {threshold:.1} um.",
            format_exact(play)
        );
        if let Some(FarFlank { contact: Some(contact), two_contact_power, .. }) = solved.far_flank {
            let body = if contact.site == Site::Screw { "screw" } else { "nut" };
            let loss = solved.transmission.power?.dissipated;
            let factor = two_contact_power.map_or_else(String::new, |two| {
                format!("; a calculation with two contacts underestimates friction by a factor of {:.2}", loss / two)
            });
            return Some(format!("{below} The balls touch the far flank of the {body}{factor}."));
        }
        // Only model `traction` calculates the friction at a third contact.
        (solved.far_flank.is_none() && play < threshold).then(|| {
            format!(
                "{below} The balls touch a far flank, whose friction only model traction calculates, so the loss is larger than stated."
            )
        })
    }

    fn others(&self) -> Option<Alternatives> {
        self.solved()?.alternatives
    }

    /// Returns warnings about operating points that have several solutions or no consistent
    /// solution.
    fn ambiguities(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(Alternatives { count, farthest_efficiency: Some(eta) }) = self.others() {
            let which = match self.model {
                ModelChoice::Fixed(Model::RacewayControl) => {
                    "the result is the solution in which the contact angles differ least, under nut \
                     control if both raceways can control"
                }
                _ => {
                    "the result is the first solution that is found as the inertia of the ball increases from zero"
                }
            };
            let motions = if count == 1 { "motion solves" } else { "motions solve" };
            warnings.push(format!(
                "{count} other steady {motions} the equations of this point; the efficiency that \
                 differs most from the result is {eta:.6}, and {which}. In a sweep, the results may jump from one solution to \
                 another."
            ));
        }
        let control = self.solved().and_then(|solved| solved.control);
        if let Some(ControllingRaceway { raceway, consistent: Some(false) }) = control {
            let raceway = raceway.name();
            warnings.push(format!(
                "A raceway controls if it has the larger spin friction moment in the solution under its control. Here, neither raceway meets this condition. The result is the solution under {raceway} control; to choose the raceway, use the setting `control`."
            ));
        }
        warnings
    }

    /// Returns a warning if a contact ellipse extends beyond the bottom of its groove or beyond the
    /// axial direction, where the groove ends.
    fn cut_off(&self, ball_radius: f64) -> Option<String> {
        let ball = &self.solved()?.ball;
        [("nut", Site::Nut), ("screw", Site::Screw)].into_iter().find_map(|(member, site)| {
            let ContactState { angle, pressed, .. } = *ball.contact(site)?;
            let half = (pressed?.semi_axes.0 / ball_radius).min(1.0).asin();
            beyond_the_flank(member, [0.0, 90.0], angle / DEG, half / DEG)
        })
    }

    /// Converts the record to a JSON object whose keys are the names of the outputs. Outputs that
    /// the model does not calculate are null.
    pub fn to_json(&self) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("model".to_owned(), json!(self.model().name()));
        map.insert("status".to_owned(), json!(self.status_name()));
        map.insert("message".to_owned(), json!(self.message()));
        map.insert("choice".to_owned(), json!(self.choice()));
        let unbounded = Some(self.unbounded()).filter(|names| !names.is_empty());
        map.insert("without_error_bound".to_owned(), json!(unbounded));
        let read = |place: usize| {
            let columns = SOLUTION[place].columns;
            [0, 1, 2].map(|member| self.value(columns.get(member)?))
        };
        map.extend(numbers_json(&Numbers::of(SOLUTION, read, |_| true)));
        map
    }

    /// Returns the sections of the record: first the model, the status and explanations as text,
    /// and then the outputs.
    pub fn shown(&self, case: &Case) -> Vec<Section> {
        let mut status = self.status_name().to_owned();
        if let Some(steps) = self.solved().and_then(|solved| Some(solved.info?.steps)) {
            let is_rigid = self.model() == ModelChoice::from(Model::Rigid);
            let kind = if is_rigid { "sweeps" } else { "Newton steps" };
            status = format!("{status} in {steps} {kind}");
            let checks =
                [("residual", output!(residual_norm)), ("power balance", output!(power_balance))];
            for (label, name) in checks {
                if let Some(value) = self.number(name) {
                    status = format!("{status}, {label} {value:.0e}");
                }
            }
        }
        let raceway = self.solved().and_then(|solved| solved.control);
        let raceway = raceway.map(|control| control.raceway.name().to_owned());
        let evidence = self.solution.as_ref().and_then(Solution::evidence);
        let evidence = evidence.map(|evidence| evidence.to_string());
        let words = [
            ("model ", Some(self.model().name().to_owned())),
            ("chosen", self.choice()),
            ("status", Some(status)),
            ("reason", self.message.clone()),
            ("evidence", evidence),
            ("regime", self.regime().map(str::to_owned)),
            ("lubrication", self.lubrication()),
            ("controlling raceway", raceway),
        ];
        let unbounded = self.unbounded();
        let caution = (!unbounded.is_empty()).then(|| {
            format!(
                "* not covered by the error bound: value of model {}; use model traction if an error bound matters",
                self.model().name()
            )
        });
        let numbers = Content::Numbers { numbers: self.rows(case), whole: "balls", unbounded };
        let words = words.map(|(label, words)| Content::Text(label, words));
        let all = words.into_iter().chain([numbers, Content::Text("", caution)]);
        all.map(|content| Section { member: None, content }).collect()
    }

    /// Returns the answer with the program version, the case, the settings, the regime and the
    /// warnings.
    pub fn answer(
        &self,
        program: &str,
        case: &Case,
        settings: &Settings,
        supplement: &Supplement,
    ) -> Answer {
        let work = &mut ModelWorkspace::default();
        let mut uncertainty = || case.problem(settings).ok()?.loss_interval(self.solved()?, work);
        let band = if supplement.band { uncertainty() } else { None };
        let (mut notes, mut parts) = (Vec::new(), None);
        if supplement.band && band.is_none() && self.film().is_some() {
            notes.push(NO_INTERVAL.to_owned());
        }
        if supplement.parts {
            match torque_parts(case, settings, work) {
                Ok(found) => parts = found.filter(|parts| parts.torque().is_some()),
                Err(why) => notes.push(format!("The screw torque is not calculated: {why}")),
            }
        }
        notes.extend(self.notes());
        notes.extend(self.critical_lead_angle(case, settings));
        notes.extend(self.threshold_play(case, settings, work));
        notes.extend(case.assumed_roughness());
        notes.extend(case.given().unused_by_models());
        notes.extend(case.unused_cycle());
        let cold = case.cold_lubricant().filter(|_| parts.is_some());
        let not_given =
            cold.into_iter().map(|text| MissingInput { number: "screw_torque_Nm", text });
        let mut answer = Answer {
            notes,
            warnings: self.all_warnings(case),
            not_given: not_given.collect(),
            fails: self.status() != Status::Converged,
            ..Answer::default()
        };
        if let Some(parts) = &parts {
            answer =
                answer.with_shown(Content::numbers(parts.numbers.clone(), "screw")).with_shown(
                    Content::Text("model of the ball contacts", Some(parts.contacts.clone())),
                );
        }
        answer.sections.extend(self.shown(case));
        let of_model = |band: &LossInterval| {
            Word("interval calculated with model", band.model.name().to_owned())
        };
        let not_included = band.is_some().then(|| NOT_INCLUDED.to_owned());
        let rows = |rows: &Vec<Sensitivity>| Keyed(rows.iter().map(Sensitivity::row).collect());
        answer.with_members(MotionResult {
            record: Data(RecordJson(self.to_json())),
            program: Data(program.to_owned()),
            inputs: Data(CaseJson(case.to_json())),
            settings: Data(settings.members()),
            regime: Data(self.regime().map(str::to_owned)),
            torque_parts: Maybe(parts.as_ref().map(|parts| Data(parts.members()))),
            band: Maybe(band.as_ref().map(interval_rows)),
            band_model: Maybe(band.as_ref().map(of_model)),
            not_included: Label("not included:", not_included),
            sensitivities: Maybe(supplement.sensitivities.as_ref().map(rows)),
        })
    }
}

answer! {
    /// Solution of a model at a point.
    pub(crate) struct MotionResult {
        [flatten] record: Data<RecordJson>;
        /// Name and version of the program.
        program: Data<String>;
        inputs: Data<CaseJson>;
        settings: Data<SettingsJson>;
        /// Slip regime of the ball.
        regime: Data<Option<String>>;
        [skip_serializing_if = "Maybe::is_none"] torque_parts: Maybe<Data<TorqueParts>>;
        /// 90 % intervals due to uncertain lubricated friction.
        [skip_serializing_if = "Maybe::is_none"] band: Maybe<Keyed<LossRow>>;
        /// Model with which the intervals are calculated.
        [skip_serializing_if = "Maybe::is_none"] band_model: Maybe<Word>;
        [skip] not_included: Label;
        [skip_serializing_if = "Maybe::is_none"] sensitivities: Maybe<Keyed<SensitivityRow>>;
    }
}

/// Optional parts of an answer that complement the record of an operating point.
#[derive(Debug, Clone, Default)]
pub struct Supplement {
    /// True if the answer states the uncertainty of lubricated friction.
    pub band: bool,
    /// True if the answer contains the parts of the screw torque
    /// ([`torque_parts`](crate::torque_parts)), or a note that explains why they are missing.
    pub parts: bool,
    /// Sensitivities of efficiency and torque with respect to each input, if requested.
    pub sensitivities: Option<Vec<Sensitivity>>,
}

/// Effects that the calculated torque of lubricated contacts neglects.
const NOT_INCLUDED: &str = "ball-to-ball contact, ball returns, seals and drag, except for effects that inputs describe; lead errors and deviations of the ball diameters; four-point contact. Two contacts per ball cause about 15 to 40 % of the drag torque that the \
                         manufacturers' rule predicts for a preloaded nut.";

row! {
    /// Interval of a result due to the uncertainty of the lubricated friction.
    pub(crate) struct LossRow {
        [skip] name: &'static str;
        [skip] label: &'static str = "90 % interval";
        [skip] unit: &'static str = "";
        low: f64 = "low";
        high: f64 = "high";
    }
}

/// Builds the table that lists the intervals due to uncertain lubricated friction.
fn interval_rows(
    LossInterval { loss, screw_torque, efficiency, .. }: &LossInterval,
) -> Keyed<LossRow> {
    let row = |name, label, unit, ends: &[f64; 2]| LossRow {
        name,
        label,
        unit,
        low: low(*ends),
        high: high(*ends),
    };
    Keyed(vec![
        row("contact_loss_ratio", "contact loss / contact loss of this solution", "", loss),
        row("ball_torque_Nm", "torque of the balls", "N m", screw_torque),
        row("efficiency", "efficiency", "", efficiency),
    ])
}

/// Returns a warning if the skid onset number shows that raceway control does not apply.
pub(crate) fn skid_warning(onset: f64) -> Option<String> {
    (onset >= MAX_ROLLING_ONSET).then(|| {
        format!(
            "The skid onset number is {onset:.2}. Above {MAX_ROLLING_ONSET}, the balls begin to skid, which \
             raceway control does not cover; use model traction."
        )
    })
}

/// Returns warnings if a lubricant film is outside the range of its formulas.
fn film_warnings(film: &FilmState) -> Vec<String> {
    /// Temperature rise of the lubricant film that reduces the film thickness by about half \[K\].
    const HEATING_LIMIT_K: f64 = 10.0;
    /// Value of the load parameter M below which the contacts behave as rigid, so that the formula
    /// for elastic contacts gives a wrong film thickness (theory 17).
    const RIGID_LOAD_PARAMETER: f64 = 10.0;
    let mut warnings = Vec::new();
    let load_parameter = film.nut.load_parameter.min(film.screw.load_parameter);
    if load_parameter < RIGID_LOAD_PARAMETER {
        warnings.push(format!(
            "The load parameter M = {load_parameter:.1e} is below {RIGID_LOAD_PARAMETER}: the load hardly deforms the contact, so the film is several \
             times thicker than the formula for elastic contacts gives, and the sliding friction is smaller."
        ));
    }
    if film.heating > HEATING_LIMIT_K {
        warnings.push(format!(
            "Sliding heats the film by {:.0} K, which thins the lubricant in the contact. The model \
             neglects this effect, so the friction is smaller than stated.",
            film.heating
        ));
    }
    warnings
}

/// Returns a message that explains why a model has no solution. Numbers in the message have the
/// units of the outputs.
#[expect(clippy::too_many_lines, reason = "the match has one arm for each reason")]
pub(crate) fn message(reason: &Reason) -> String {
    match reason {
        Reason::SelfLocking { sin_contact_angle, friction_term } => format!(
            "self-locking: sin(contact angle) = {sin_contact_angle:.4} does not exceed f D = \
             {friction_term:.4} (Lin Eq 16); friction holds any load. Raise contact_angle_deg or \
             lower friction_coefficient"
        ),
        Reason::FrictionHoldsLoad { load_ratio } => format!(
            "self-locking: equilibrium would need a normal load of {load_ratio:.3e} times the axial \
             load; friction holds any load. Raise contact_angle_deg or lower friction_coefficient"
        ),
        Reason::NutContactWouldRoll { slip, exact, .. } => {
            let how =
                if *exact { "from the full equations" } else { "to first order in the inertia" };
            format!(
                "in a steady motion, the slip at the nut along the friction direction would be {slip:.3e} r_b |W| ({how}), but it must be positive: \
                 the ball rolls on the nut, which models with saturated friction do not cover"
            )
        }
        Reason::UnloadedFlankWouldPull { load_ratio } => format!(
            "the far flank would have to pull the ball: its normal load would be \
             {load_ratio:.3e} times the axial load"
        ),
        Reason::LoadedContactWouldPull { nut_load_ratio, screw_load_ratio } => format!(
            "a loaded contact would have to pull the ball: normal loads of {nut_load_ratio:.3e} \
             (nut) and {screw_load_ratio:.3e} (screw) times the axial load"
        ),
        Reason::BallLeavesFlank { nut, screw } => format!(
            "the ball leaves its flanks: contact angles of {:.2} deg (nut) and {:.2} deg (screw), \
             outside 0 to 90 deg, where other flanks would carry the load. Raise axial_load_N, or \
             lower the speed or the friction coefficient",
            nut / DEG,
            screw / DEG
        ),
        Reason::FlanksCannotHold { control, max_force_ratio, force_ratio } => format!(
            "the ball leaves its flanks, because they cannot hold the centrifugal force at any contact \
             angles between 0 and 90 deg. With the {} in control, the flanks hold at most {max_force_ratio:.3e} times \
             the axial load, but the centrifugal force is {force_ratio:.3e} times the axial load. \
             Raise axial_load_N or lower the speed",
            control.name()
        ),
        Reason::SlipAlongFriction { slip } => format!(
            "a skidding ball cannot be in equilibrium here if friction opposes the slip at both \
             contacts; without inertia, the slip at the nut would be {slip:.3e} r_b |W|. The balls \
             roll here; use model traction"
        ),
        Reason::NoSkidAtInertia { inertia_ratio, min, max } => format!(
            "the ratio of inertia forces to axial load, m r_m W^2/F_a, is {inertia_ratio:.3e}; solutions with skid on both flanks exist only for ratios from {min:.3e} to {max:.3e}. Change axial_load_N or the speed"
        ),
        Reason::SearchFailed => "the search for a steady motion failed: none was found, but \
             one may exist. Change the inputs slightly, or use another model"
            .to_owned(),
        Reason::CurvaturesNotHertzian { longitudinal, transverse } => format!(
            "relative curvatures of {longitudinal:.3e} 1/m along and {transverse:.3e} 1/m across the groove give \
             no contact ellipse with its long axis across the groove; change nut_conformity and \
             screw_conformity towards 0.52"
        ),
        Reason::NoRootAtInertia { inertia_ratio, nearest_ratio } => format!(
            "the branch of steady motions with saturated friction that starts at small inertia ends before this point: \
             the ratio of inertia forces to axial load, m r_m W^2/F_a, is {inertia_ratio:.3e}, and the nearest ratio with a solution is \
             {nearest_ratio:.3e}. Change axial_load_N or the speed"
        ),
        Reason::Refused { error } => error.to_string(),
        Reason::SingularRoot => {
            "the derivatives with respect to the inputs do not exist at this point, because the \
             Jacobian is singular. Change the inputs slightly"
                .to_owned()
        }
        Reason::BallDoesNotOrbit => {
            "the ball would not move around the axis (precession 0), and a ball \
             without precession has no gyroscopic moment to balance the friction moment"
                .to_owned()
        }
        Reason::InertiaOutOfRange { inertia_ratio } => format!(
            "the ratio of inertia forces to axial load overflows ({inertia_ratio:e}); \
             check screw_speed_rpm, nut_speed_rpm and axial_load_N"
        ),
        Reason::Frictionless => {
            "friction_coefficient must be > 0 (at least 1e-12) for this model: without \
             friction the rotation of the ball is not determined"
                .to_owned()
        }
        Reason::NoRelativeSpeed => {
            "screw_speed_rpm and nut_speed_rpm must differ: at equal speeds, the balls do not move"
                .to_owned()
        }
        Reason::DualDrive => "model quasi-static covers a turning screw or a turning nut, not \
             both; set one of screw_speed_rpm and nut_speed_rpm to 0"
            .to_owned(),
        Reason::LubricantRunsAway { max_temperature } => format!(
            "thermal runaway: the losses heat the lubricant faster than heat_transfer_W_K cools it, at all temperatures up to {:.0} C",
            max_temperature - ZERO_CELSIUS
        ),
        Reason::PowerDoesNotBalance { imbalance } => {
            format!(
                "rounding errors are too large: relative error of the power balance {imbalance:.1e}"
            )
        }
        Reason::Newton { status, worst_equation, .. } if worst_equation.is_empty() => {
            status.describe().to_owned()
        }
        Reason::Newton { status, residual, worst_equation } => format!(
            "{}: scaled residual {residual:.1e}, largest in the {worst_equation}",
            status.describe()
        ),
        other => other.to_string(),
    }
}
