//! Search for the value of an input at which a calculated output equals its measured value, or at
//! which a design rule is exactly at its limit.

use std::cell::RefCell;

use bsm_design::Range;
use bsm_design::groove::FEW_DRAWS;
use bsm_design::search::{SignChange, sign_changes};
use bsm_design::statistics::Band;
use bsm_dyn::{Model, ModelWorkspace, Status};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use crate::answers::axis::{missing_for_rule, rule_titles};
use crate::answers::groove::pair;
use crate::answers::schema::RecordJson;
use crate::case::rated_nut;
use crate::vocabulary::display::in_unit;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::members::{Data, Maybe, Word, answer, one_member, with_unit};
use crate::vocabulary::units::{UnitChange, convert};
use crate::{
    AnalysisKind, Answer, AxisReport, Case, CaseError, DisplayUnit, INPUTS, InputKey, ModelChoice,
    NameKind, Output, OutputType, Quantity, Record, Rule, Settings, format_interval,
    format_trimmed,
};

/// Returns the output to which `name` refers, and the conversion from the unit at the end of `name`
/// to the unit of the output. The output must be a result of a solved motion or of an analysis that
/// needs only inputs, such as `nut` or `axis`.
pub(crate) fn measurable(name: &str) -> Result<(&'static Output, UnitChange), CaseError> {
    let name = name.trim();
    let is_number = |output: &&Output| {
        output.output_type == OutputType::Number
            && (output.key().is_some() || of_inputs(output).is_some())
    };
    let known = Output::named(name).filter(is_number).map(|output| (output, UnitChange::NONE));
    let in_other_unit = || {
        let names = Output::all().filter(is_number).map(|output| output.name);
        let (own, change) = convert(name, names)?;
        Some((Output::named(own)?, change))
    };
    known.or_else(in_other_unit).ok_or_else(|| {
        let nearest = Output::nearest(name).filter(|nearest| *nearest != name);
        CaseError::unknown(NameKind::Output, name, nearest)
    })
}

/// Returns the analysis that calculates an output from inputs only, or `None` if the output
/// requires a solved motion.
fn of_inputs(output: &Output) -> Option<AnalysisKind> {
    output.analysis().filter(|kind| !kind.needs_solution())
}

/// Returns the value that the model predicts for the measured output at a point, or `None` if there
/// is no solution.
///
/// # Errors
///
/// Returns [`CaseError`] if the case lacks inputs of the model, or the model does not calculate the
/// output.
pub(crate) fn measured(
    output: &Output,
    case: &Case,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Option<f64>, CaseError> {
    if let Some(kind) = of_inputs(output) {
        let own = |quantity: &Quantity| quantity.columns.iter().any(|c| c.name == output.name);
        return Ok(kind.numbers(case, settings, None, own, work)?.number(output.into()));
    }
    let record = Record::new(case.problem(settings)?.solve(work));
    match record.number(output.into()) {
        _ if record.status() != Status::Converged => Ok(None),
        None => {
            let required = case.lacks(Model::Traction);
            let model = record.model().name();
            let what = format!("model {model} does not calculate {} here{required}", output.name);
            Err(CaseError::Invalid(what))
        }
        value => Ok(value),
    }
}

/// Replaces `auto` by the most complete model. The `auto` choice only bounds the error of the
/// efficiency, which does not limit the error of a fitted input.
pub(crate) fn exact(case: &Case, settings: &Settings) -> Result<Settings, CaseError> {
    let model = match case.choose(settings.model)? {
        ModelChoice::Auto => Model::Traction.into(),
        fixed @ ModelChoice::Fixed(_) => fixed,
    };
    Ok(Settings { model, ..*settings })
}

/// Default search range of a friction coefficient.
const FRICTION: (f64, f64) = (1e-4, 0.5);

/// Default search range of all inputs except friction coefficients in a fit to a table of points,
/// relative to the value in the case.
const TABLE_RANGE: (f64, f64) = (0.25, 4.0);

/// Default search range of all inputs except friction coefficients in a fit to a single measured
/// value, relative to the value in the case.
const SINGLE_VALUE_RANGE: (f64, f64) = (0.01, 100.0);

/// Condition that the fitted value of an input must satisfy.
#[derive(Debug, Clone)]
enum Target {
    /// The output equals the measured value.
    Measured { output: &'static Output, value: f64 },
    /// The axis rule with the title `rule` is exactly at its limit.
    Limit { rule: &'static str },
}

/// The fitted input in JSON.
pub(crate) struct InputJson(&'static str, f64);

/// The measured output in JSON.
pub(crate) struct OutputJson(&'static str, f64);

one_member! {
    InputJson of INPUTS.iter().map(|input| (input.name, with_unit(input.about, input.unit)));
    OutputJson of Output::all().map(|output| (output.name, with_unit(output.about, output.unit)));
}

/// A value found by a fit, in JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct FittedJson {
    #[serde(flatten)]
    value: InputJson,
    /// Relative change of the input divided by the relative change of the measured output or of the
    /// rule margin.
    #[schemars(with = "Option<f64>")]
    relative_response: f64,
    /// Both ends of the 90 % interval over the possible grooves.
    groove_interval: Option<[f64; 2]>,
    /// Solution of the model for the fitted value of the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    result: Option<RecordJson>,
    /// 90 % intervals of the solution over the possible grooves.
    #[serde(skip_serializing_if = "Option::is_none")]
    result_intervals: Option<Value>,
}

answer! {
    /// Values of an input that satisfy a condition.
    pub(crate) struct FitMembers {
        [skip_serializing_if = "Maybe::is_none"] measured: Maybe<Data<OutputJson>>;
        /// Title of the rule that is at its limit.
        [skip_serializing_if = "Maybe::is_none"] limit: Maybe<Data<&'static str>>;
        /// Parts of the search range in which the rule is met.
        [skip_serializing_if = "Maybe::is_none"] kept: Maybe<Data<Vec<[f64; 2]>>>;
        found: Data<Vec<FittedJson>>;
        /// Smallest and largest output, or margin of the rule, in the search range.
        reachable: Data<Option<[f64; 2]>>;
        message: Word;
    }
}

/// A search for the values of an input that satisfy a condition.
#[derive(Debug, Clone)]
pub struct Fit {
    input: InputKey,
    /// Name of the input as shown in sentences, with the displayed unit as a suffix.
    shown_name: String,
    shown_unit: DisplayUnit,
    range: Range,
    target: Target,
}

/// A value of the input that satisfies the condition.
#[derive(Debug, Clone, PartialEq)]
pub struct FitValue {
    /// Value of the input.
    pub value: f64,
    /// Sensitivity of the input: its relative change divided by the relative change of the measured
    /// output or of the rule margin.
    pub response: f64,
    /// Solution of the model for this value, if the condition refers to the motion of a ball.
    pub record: Option<Record>,
    /// 90 % interval of the value over the possible grooves, if the groove is estimated.
    pub band: Option<Band>,
    /// Number of possible grooves for which no input value close to the value for the best groove
    /// satisfies the condition.
    pub grooves_without_value: usize,
    /// Solutions for the possible grooves, each with the value of the input that satisfies the
    /// condition for this groove.
    possible: Vec<Record>,
}

/// Result of a search for the values of an input.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// Values of the input that satisfy the condition, in ascending order.
    pub found: Vec<FitValue>,
    /// Values of the input at which the output jumps across the measured value, or the margin of
    /// the rule jumps across its limit.
    pub jumps: Vec<f64>,
    /// Parts of the search range in which the rule is met. The list is empty if the condition is a
    /// measured output.
    pub ranges_within_limit: Vec<(f64, f64)>,
    /// Smallest and largest value of the output, or of the rule margin, in the part of the search
    /// range in which the model has solutions.
    pub reachable: Option<(f64, f64)>,
    /// Fraction of the search range in which the model has solutions.
    pub solved: f64,
    /// Notes on the source of the rule and on the inputs that the search lacks.
    pub notes: Vec<String>,
}

/// Returns the search range of an input. If none is given, the range is 1e-4 to 0.5 for a friction
/// coefficient, and the factors `around` times the value in the case for other inputs.
fn range_of(
    case: &Case,
    input: InputKey,
    range: Option<(f64, f64)>,
    around: (f64, f64),
) -> Result<(f64, f64), CaseError> {
    let rule = input.input().rule;
    let range = match (range, input, case.value_or_default(input)) {
        (Some(range), ..) => range,
        (None, InputKey::friction_coefficient, _) => FRICTION,
        (None, _, Some(value)) if value != 0.0 => {
            let (a, b) = (around.0 * value, around.1 * value);
            let (low, high) = (a.min(b), a.max(b));
            match rule {
                Rule::Within(least, most) => (low.max(least), high.min(most)),
                Rule::AtLeast(least) => (low.max(least), high),
                _ => (low, high),
            }
        }
        _ => return Err(CaseError::NoRange { key: input.name() }),
    };
    let range = match rule {
        // The rule excludes its limits, so the search range must end slightly inside the limits.
        Rule::Between(low, high) => {
            let inset = 1e-6 * (high - low);
            (range.0.max(low + inset), range.1.min(high - inset))
        }
        _ => range,
    };
    let ends = [range.0, range.1];
    let key = input.name();
    if matches!(rule, Rule::Whole(_) | Rule::OneOf(_)) {
        return Err(invalid_input(
            key,
            "takes only discrete values, so a continuous search cannot fit it",
        ));
    }
    if !(range.0 < range.1 && ends.iter().all(|value| rule.holds(*value))) {
        let (low, high) = range;
        let what = format!("{low} to {high} is not a range of permitted values of `{key}`");
        return Err(CaseError::Entry { key: key.to_owned(), what });
    }
    Ok(range)
}

/// An input whose value is determined by the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedInput {
    /// Name of the input. The name may end with a unit other than the default unit.
    pub name: String,
    /// Search range, in the unit with which the name of the input ends. The default for a friction
    /// coefficient is 1e-4 to 0.5. The default for other inputs is relative to the value in the
    /// case: 0.01 to 100 for a single measured value, and 0.25 to 4 for a table of points.
    pub range: Option<(f64, f64)>,
}

impl FittedInput {
    /// Parses `name` or `name=low:high`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the text does not have the form `name=value`, or if the value is
    /// not a number.
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let form = "input, or input=low:high, such as seal_torque_Nm=0:1";
        let wrong = || CaseError::bad_setting(text, form);
        let (name, range) = match text.split_once('=') {
            None => (text, None),
            Some((name, range)) => {
                let (low, high) = range.split_once(':').ok_or_else(wrong)?;
                let number = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
                (name, Some((number(low)?, number(high)?)))
            }
        };
        Ok(Self { name: name.trim().to_owned(), range })
    }

    /// Returns the input and its search range in the unit of the input.
    ///
    /// * `around`: default range relative to the value in the case.
    fn key_and_range(
        &self,
        base: &Case,
        around: (f64, f64),
    ) -> Result<(InputKey, (f64, f64)), CaseError> {
        let (key, change) = InputKey::in_unit(&self.name)?;
        let range = self.range.map(|(low, high)| (change.value(low), change.value(high)));
        Ok((key, range_of(base, key, range, around)?))
    }

    /// Returns the input and its search range for a fit to a table of points.
    pub(crate) fn of_points(&self, base: &Case) -> Result<(InputKey, (f64, f64)), CaseError> {
        self.key_and_range(base, TABLE_RANGE)
    }
}

/// A measured value of an output.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Name of the output. The name may end with a unit other than the default unit.
    pub name: String,
    /// Measured value, in the unit at the end of the output name.
    pub value: f64,
}

impl Measurement {
    /// Parses `name=value`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the text has another form.
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let wrong = || CaseError::bad_setting(text, "output=value, such as screw_torque_Nm=1.5");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let value = value.trim().parse().map_err(|_| wrong())?;
        Ok(Self { name: name.trim().to_owned(), value })
    }

    /// Returns the output and its measured value in the unit of the output.
    fn target(&self) -> Result<Target, CaseError> {
        let (output, change) = measurable(&self.name)?;
        if !self.value.is_finite() {
            return Err(invalid_input(
                &self.name,
                format!("has the measured value {}, but the value must be finite", self.value),
            ));
        }
        Ok(Target::Measured { output, value: change.value(self.value) })
    }
}

impl Fit {
    /// Prepares a search for the values of an input that reproduce a measured value.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for unknown names, an invalid range, or a measured value that is not
    /// finite.
    pub fn new(
        case: &Case,
        input: &FittedInput,
        measurement: &Measurement,
    ) -> Result<Self, CaseError> {
        Self::with(case, input, measurement.target()?)
    }

    /// Works like [`new`](Self::new), but parses strings with [`FittedInput::parse`] and
    /// [`Measurement::parse`].
    ///
    /// # Errors
    /// Returns the same errors as [`FittedInput::parse`], [`Measurement::parse`] and
    /// [`new`](Self::new).
    pub fn parse(case: &Case, input: &str, measurement: &str) -> Result<Self, CaseError> {
        Self::new(case, &FittedInput::parse(input)?, &Measurement::parse(measurement)?)
    }

    /// Prepares a search for the values of an input at which an axis rule is exactly at its limit.
    ///
    /// * `rule`: title of the rule, such as `critical speed`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for an unknown rule, an unknown input, or an invalid range.
    pub fn of_limit(case: &Case, input: &FittedInput, rule: &str) -> Result<Self, CaseError> {
        let known = rule_titles().find(|title| *title == rule.trim()).ok_or_else(|| {
            CaseError::unknown_word("rule", "rule", rule, &rule_titles().collect::<Vec<_>>())
        })?;
        Self::with(case, input, Target::Limit { rule: known })
    }

    fn with(case: &Case, input: &FittedInput, target: Target) -> Result<Self, CaseError> {
        let (key, (low, high)) = input.key_and_range(case, SINGLE_VALUE_RANGE)?;
        // Sentences keep the unit of the given name. Otherwise, they have the displayed units.
        let names = INPUTS.iter().map(|input| input.name);
        let (shown_name, shown_unit) = match in_unit(&input.name, names) {
            Some((_, unit)) if input.name != key.name() => (input.name.clone(), unit),
            _ => {
                let unit = case.display_units().of(key.input().unit);
                (unit.name(key.name()), unit)
            }
        };
        Ok(Self { input: key, shown_name, shown_unit, range: Range { low, high }, target })
    }

    /// Returns the name of the input and a value, both in the displayed unit.
    fn equation(&self, value: f64) -> String {
        format!("{} = {:.6}", self.shown_name, self.shown_unit.value(value))
    }

    /// Returns the case with another value of the input.
    fn at(&self, case: &Case, value: f64) -> Result<Case, CaseError> {
        let mut case = case.clone();
        case.set(self.input.name(), value)?;
        Ok(case)
    }

    /// Returns the output minus the measured value, or the margin of the rule minus 1. Returns
    /// `None` if there is no solution.
    fn excess(
        &self,
        case: &Case,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Option<f64>, CaseError> {
        match &self.target {
            Target::Measured { output, value } => {
                let found = measured(output, case, settings, work)?;
                Ok(found.map(|found| found - value))
            }
            Target::Limit { rule } => {
                let report = AxisReport::without_band(case, settings)?;
                let own = report.answer.rules.iter().find(|own| own.title == *rule);
                Ok(own.and_then(|own| Some(own.smallest_margin()? - 1.0)))
            }
        }
    }

    /// Finds all values in the search range that reproduce the measured output, or at which the
    /// rule is exactly at its limit.
    /// The choice `auto` is replaced by the most complete model, because `auto` only bounds the
    /// error of the efficiency, which does not limit the error of the input.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the output cannot be calculated at any value of the input.
    pub fn run(&self, case: &Case, settings: &Settings) -> Result<FitReport, CaseError> {
        let mut report = self.search(case, settings)?;
        report.notes = self.notes(case, settings, &report)?;
        for fitted in &mut report.found {
            let follow = |possible: &Case| {
                let value = self.follow(possible, settings, fitted)?;
                let settings = &self.exact_settings(possible, settings).ok()?;
                let record = self.record(possible, settings, value, &mut ModelWorkspace::default());
                Some((value, record))
            };
            // The model is chosen with the fitted value, because the case itself may lack the
            // fitted input.
            let values = self.at(case, fitted.value)?.map_possible_grooves(FEW_DRAWS, follow);
            fitted.grooves_without_value = values.iter().filter(|value| value.is_none()).count();
            fitted.band = Band::of(values.iter().flatten().map(|(value, _)| *value));
            fitted.possible =
                values.into_iter().flatten().filter_map(|(_, record)| record).collect();
        }
        Ok(report)
    }

    /// Returns notes on the source of the rule and on the inputs that the search lacks.
    fn notes(
        &self,
        case: &Case,
        settings: &Settings,
        report: &FitReport,
    ) -> Result<Vec<String>, CaseError> {
        if report.reachable.is_none() {
            let missing = self.missing_inputs(&self.at(case, self.range.high)?);
            let note = || format!("Missing inputs: {}.", missing.join(", "));
            return Ok((!missing.is_empty()).then(note).into_iter().collect());
        }
        let (Target::Limit { rule }, Some(at)) = (&self.target, report.found.first()) else {
            return Ok(Vec::new());
        };
        let sheet = AxisReport::without_band(&self.at(case, at.value)?, settings)?;
        let Some(rule) = sheet.answer.rules.iter().find(|own| own.title == *rule) else {
            return Ok(Vec::new());
        };
        let mut notes = vec![format!("At {}: {}.", self.equation(at.value), rule.source)];
        if rule.margin_without_default.is_some() {
            notes.push(
                "One end of the screw is free, so a table may not guide the load. The rule therefore counts as met only where it is \
                 also met with the end conditions of the input support. If a guided table clamps the nut, give buckling_support."
                    .to_owned(),
            );
        }
        Ok(notes)
    }

    /// Returns the names of the inputs that the output or the rule needs and that the case lacks.
    fn missing_inputs(&self, case: &Case) -> Vec<String> {
        match &self.target {
            Target::Limit { rule } => missing_for_rule(case, rule),
            Target::Measured { output, .. } => {
                output.missing(case, case.given().union(rated_nut::given(case)))
            }
        }
    }

    /// Returns the solution of the model for a value of the input, or `None` if the condition is
    /// the limit of a rule.
    fn record(
        &self,
        case: &Case,
        settings: &Settings,
        value: f64,
        work: &mut ModelWorkspace,
    ) -> Option<Record> {
        match &self.target {
            Target::Measured { .. } => {
                let problem = self.at(case, value).ok()?.problem(settings).ok()?;
                Some(Record::new(problem.solve(work)))
            }
            Target::Limit { .. } => None,
        }
    }

    /// Returns the value of the input that satisfies the condition for another possible groove. The
    /// secant method starts from the value and the slope that were found for the best groove.
    /// Returns `None` if the iteration leaves the search range or does not converge.
    fn follow(&self, case: &Case, settings: &Settings, best: &FitValue) -> Option<f64> {
        /// Relative step size below which the iteration stops. It is much smaller than the relative
        /// width of any uncertainty interval.
        const STEP: f64 = 1e-6;
        /// Maximum number of iterations.
        const MAX_STEPS: usize = 20;
        let Range { low, high } = self.range;
        let case = &self.at(case, best.value).ok()?;
        let settings = &self.exact_settings(case, settings).ok()?;
        let work = &mut ModelWorkspace::default();
        let mut excess = |value: f64| {
            let found = self.excess(&self.at(case, value).ok()?, settings, work);
            found.ok()?.filter(|excess| excess.is_finite())
        };
        let (mut at, mut slope) = (best.value, self.offset() / (best.value * best.response));
        let mut left = excess(at)?;
        for _ in 0..MAX_STEPS {
            let next = at - left / slope;
            if !(low..=high).contains(&next) {
                return None;
            }
            if (next - at).abs() <= STEP * next.abs() {
                return Some(next);
            }
            let left_at_next = excess(next)?;
            slope = (left_at_next - left) / (next - at);
            (at, left) = (next, left_at_next);
        }
        None
    }

    /// Returns the settings with the most complete model in place of `auto`.
    fn exact_settings(&self, case: &Case, settings: &Settings) -> Result<Settings, CaseError> {
        match &self.target {
            Target::Measured { output, .. } if of_inputs(output).is_none() => exact(case, settings),
            // Ratings and axis rules can be calculated without a ball model. If the case does not
            // suit any ball model, the settings remain unchanged, and the calculation of the
            // target reports an error if it needs the model.
            _ => Ok(exact(case, settings).unwrap_or(*settings)),
        }
    }

    /// Returns the target value of the search: the measured output, or 1 for the margin of a rule
    /// at its limit.
    fn offset(&self) -> f64 {
        match &self.target {
            Target::Measured { value, .. } => *value,
            Target::Limit { .. } => 1.0,
        }
    }

    /// Finds the values of the input that satisfy the condition, for a case with a single groove.
    fn search(&self, case: &Case, settings: &Settings) -> Result<FitReport, CaseError> {
        let mut case = case.clone();
        case.set(self.input.name(), self.range.low)?;
        let settings = &self.exact_settings(&case, settings)?;
        let work = RefCell::new(ModelWorkspace::default());
        let first_error = RefCell::new(None);
        let excess = |value: f64| -> Result<f64, CaseError> {
            let found = self
                .at(&case, value)
                .and_then(|case| self.excess(&case, settings, &mut work.borrow_mut()));
            Ok(found
                .unwrap_or_else(|error| {
                    first_error.borrow_mut().get_or_insert(error);
                    None
                })
                .unwrap_or(f64::NAN))
        };
        let run = sign_changes(excess, self.range)?;
        if let (None, Some(error)) = (run.values, first_error.take()) {
            return Err(error);
        }
        let offset = self.offset();
        let fitted = |root: &SignChange| {
            let response = offset / (root.at * root.slope);
            let record = self.record(&case, settings, root.at, &mut work.borrow_mut());
            let (value, possible) = (root.at, Vec::new());
            FitValue { value, response, record, band: None, grooves_without_value: 0, possible }
        };
        let found = run.roots.iter().map(fitted).collect();
        let ranges_within_limit = match &self.target {
            Target::Limit { .. } => self.ranges_within_limit(&run.roots, &run.jumps, excess)?,
            Target::Measured { .. } => Vec::new(),
        };
        Ok(FitReport {
            found,
            jumps: run.jumps,
            ranges_within_limit,
            reachable: run.values.map(|values| (values.low + offset, values.high + offset)),
            solved: run.share,
            notes: Vec::new(),
        })
    }

    /// Returns the parts of the search range in which the rule is met. The rule is checked at the
    /// midpoint between successive roots or jumps.
    fn ranges_within_limit(
        &self,
        roots: &[SignChange],
        jumps: &[f64],
        excess: impl Fn(f64) -> Result<f64, CaseError>,
    ) -> Result<Vec<(f64, f64)>, CaseError> {
        let Range { low, high } = self.range;
        let mut ends: Vec<_> = [low, high].into_iter().chain(jumps.iter().copied()).collect();
        ends.extend(roots.iter().map(|root| root.at));
        ends.sort_by(f64::total_cmp);
        // A root at an end of the range would otherwise occur twice in the list.
        ends.dedup();
        let mut ranges_within_limit = Vec::new();
        for part in ends.windows(2) {
            if excess(0.5 * (part[0] + part[1]))? >= 0.0 {
                ranges_within_limit.push((part[0], part[1]));
            }
        }
        Ok(ranges_within_limit)
    }

    /// Returns true if the measured output is calculated by a model of a single ball, and false if
    /// it is a result for the nut or the axis.
    pub fn solves_one_ball(&self) -> bool {
        matches!(self.target, Target::Measured { output, .. } if of_inputs(output).is_none())
    }

    /// Returns a note on the accuracy of the manufacturers' rule, if the measured output is
    /// calculated with this rule.
    fn about_rule(&self) -> Option<String> {
        let Target::Measured { output, .. } = self.target else { return None };
        let note = "The manufacturers' rule for the friction torque due to preload is accurate to about 50 %, so the value found has \
                    at least this uncertainty.";
        output.name.starts_with("preload_torque_measured").then(|| note.to_owned())
    }

    /// Describes the result of the search in a sentence.
    fn describe(&self, report: &FitReport) -> String {
        let input = &self.shown_name;
        let shown = |value: f64| format!("{:.6}", self.shown_unit.value(value));
        let all: Vec<_> = report
            .found
            .iter()
            .map(|FitValue { value, band, .. }| {
                let with = band.map_or("", |_| " over the possible grooves");
                let interval = format_interval(self.shown_unit.band(*band));
                format!("{}{interval}{with}", self.equation(*value))
            })
            .collect();
        let jumps: Vec<_> = report.jumps.iter().map(|at| shown(*at)).collect();
        let jumps = match &jumps[..] {
            [] => String::new(),
            all => format!("; it jumps at {input} = {}", all.join(", ")),
        };
        let what = match &self.target {
            Target::Measured { output, .. } => output.name,
            Target::Limit { rule } => rule,
        };
        let [low, high] =
            [self.range.low, self.range.high].map(|end| format_trimmed(self.shown_unit.value(end)));
        let part = if report.solved < 1.0 {
            let percent = 100.0 * report.solved;
            format!("; it can be calculated in {percent:.0} % of this range")
        } else {
            String::new()
        };
        match (&self.target, &report.found[..], report.reachable) {
            (_, _, None) => {
                format!("{what} cannot be calculated with {input} from {low} to {high}")
            }
            (Target::Limit { rule }, ..) => {
                let parts: Vec<_> = report
                    .ranges_within_limit
                    .iter()
                    .map(|(low, high)| format!("{} to {}", shown(*low), shown(*high)))
                    .collect();
                if parts.is_empty() {
                    format!(
                        "the rule \"{rule}\" is not met with {input} from {low} to {high}{part}{jumps}"
                    )
                } else {
                    let limits = if report.found.iter().any(|found| found.band.is_some()) {
                        format!("; it is at its limit at {}", all.join(", "))
                    } else {
                        String::new()
                    };
                    format!(
                        "the rule \"{rule}\" is met with {input} from {} (searched range: {low} to {high}{part}){limits}{jumps}",
                        parts.join(", and from ")
                    )
                }
            }
            (_, [first, ..], _) => {
                let more =
                    if all.len() > 1 { "; the output is the same at all these values" } else { "" };
                let response = first.response.abs();
                format!(
                    "{}{more}; a change of {what} by 1 % corresponds to a change of {input} by {response:.2} %{jumps}",
                    all.join(", ")
                )
            }
            (Target::Measured { value, .. }, [], Some((least, most))) => {
                format!(
                    "{input} from {low} to {high} gives {what} from {least:.6} to {most:.6}, not {value}{part}{jumps}"
                )
            }
        }
    }

    /// Returns the answer, which contains the values of the input, the solution for each value, and
    /// the reachable outputs.
    pub fn answer(&self, case: &Case, report: &FitReport) -> Answer {
        let fitted = |(f, solution): (&FitValue, &Answer)| FittedJson {
            value: InputJson(self.input.name(), f.value),
            relative_response: f.response,
            groove_interval: f.band.map(pair),
            result: f.record.as_ref().map(|record| RecordJson(record.to_json())),
            result_intervals: f.record.as_ref().map(|_| solution.intervals()),
        };
        let solutions: Vec<_> = report.found.iter().map(|found| found.solution(case)).collect();
        let values = report.found.iter().zip(&solutions);
        let warnings = case.warnings();
        let fails = report.found.is_empty() && report.ranges_within_limit.is_empty();
        let missing_values = report.found.iter().filter(|found| found.grooves_without_value > 0).map(|found| {
            format!(
                "For {} of {} possible grooves, no value near {} in the range gives this result.",
                found.grooves_without_value,
                case.draws(FEW_DRAWS),
                self.equation(found.value)
            )
        });
        let meaning = report.found.iter().any(|found| found.band.is_some()).then(|| {
            match self.target {
                Target::Measured { .. } => "The intervals account for the uncertainty of the estimated groove, but not for the error of the measured value.",
                Target::Limit { .. } => "The intervals account for the uncertainty of the estimated groove.",
            }
            .to_owned()
        });
        let notes = case.groove_note().into_iter().chain(meaning).chain(self.about_rule());
        let notes = notes.chain(missing_values).chain(report.notes.iter().cloned()).collect();
        let mut answer = Answer { notes, warnings, fails, ..Answer::default() };
        let (measured, limit) = match &self.target {
            Target::Measured { output, value } => (Some(OutputJson(output.name, *value)), None),
            Target::Limit { rule } => (None, Some(*rule)),
        };
        let ranges_within_limit: Vec<_> =
            report.ranges_within_limit.iter().map(|(low, high)| [*low, *high]).collect();
        answer = answer.with_members(FitMembers {
            measured: Maybe(measured.map(Data)),
            limit: Maybe(limit.map(Data)),
            kept: Maybe(limit.map(|_| Data(ranges_within_limit))),
            found: Data(values.map(fitted).collect()),
            reachable: Data(report.reachable.map(|(low, high)| [low, high])),
            message: Word("", self.describe(report)),
        });
        answer.sections.extend(solutions.into_iter().flat_map(|solution| solution.sections));
        answer
    }
}

impl FitValue {
    /// Returns the solution of the model for the fitted value of the input, with 90 % intervals
    /// over the possible grooves.
    fn solution(&self, case: &Case) -> Answer {
        let shown = |record: &Record| Answer { sections: record.shown(case), ..Answer::default() };
        let mut solution = self.record.as_ref().map(shown).unwrap_or_default();
        solution.add_bands(&self.possible.iter().map(shown).collect::<Vec<_>>());
        solution
    }
}
