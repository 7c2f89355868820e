//! Determination of an input from a measured output.

use std::cell::RefCell;

use bsm_design::search::{SignChange, sign_changes};
use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::json;

use crate::{
    Answer, Case, CaseError, Content, InputKey, Known, ModelChoice, Output, Record, Rule, Settings,
    torque_parts,
};

/// Name of the screw torque, which may be measured in addition to the outputs of a solution.
const SCREW_TORQUE: &str = "screw_torque_Nm";

/// Returns the output with the given name if it may be measured.
pub(crate) fn measurable(name: &str) -> Result<&'static Output, CaseError> {
    let name = name.trim();
    let output = Output::named(name).filter(|o| o.json_type == "number");
    output.filter(|output| output.key().is_some() || output.name == SCREW_TORQUE).ok_or_else(|| {
        let nearest = Output::nearest(name).filter(|nearest| *nearest != name);
        CaseError::unknown(Known::Output, name, nearest)
    })
}

/// Returns the value that would be measured at a point, or `None` without a solution.
///
/// # Errors
///
/// [`CaseError`] if the case lacks inputs of the model, or the model does not calculate the output.
pub(crate) fn measured(
    output: &Output,
    case: &Case,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Option<f64>, CaseError> {
    let lacks = |model: &str| {
        let required = case.lacks(Model::Traction);
        CaseError::Invalid(format!("model {model} gives no {} here{required}", output.name))
    };
    if output.name == SCREW_TORQUE {
        let parts = torque_parts(case, settings)?;
        return Ok(parts.ok_or_else(|| lacks(settings.model.name()))?.torque());
    }
    let record = Record::new(case.problem(settings)?.solve(work));
    match record.number(output.name) {
        _ if record.status() != Status::Converged => Ok(None),
        None => Err(lacks(record.model().name())),
        value => Ok(value),
    }
}

/// Replaces model `auto` by the most complete model, because an error bound of the efficiency says
/// nothing about the error of an input.
pub(crate) fn exact(case: &Case, settings: &Settings) -> Result<Settings, CaseError> {
    let model = match case.choose(settings.model)? {
        ModelChoice::Auto => Model::Traction.into(),
        fixed @ ModelChoice::Fixed(_) => fixed,
    };
    Ok(Settings { model, ..*settings })
}

/// Default range of a friction coefficient.
const FRICTION: (f64, f64) = (1e-4, 0.5);

/// Default range of other inputs, relative to the value in the case.
const AROUND: (f64, f64) = (0.25, 4.0);

/// A fit: measured output and input to find.
#[derive(Debug, Clone)]
pub struct Fit {
    input: InputKey,
    range: (f64, f64),
    output: &'static Output,
    measured: f64,
}

/// Value of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct FitValue {
    /// The value of the input.
    pub value: f64,
    /// Relative change of the input per relative change of the measured output.
    pub response: f64,
    /// Result of the model at this value.
    pub record: Record,
}

/// Values in ascending order.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// The values, the smallest first.
    pub found: Vec<FitValue>,
    /// Smallest and largest output over the range in which the model has solutions.
    pub reachable: Option<(f64, f64)>,
    /// Share of the range in which the model has solutions.
    pub solved: f64,
}

/// Returns the search range of an input: as given, or 1e-4 to 0.5 for a friction coefficient, or
/// 0.25 to 4 times the value in the case for other inputs.
fn range_of(
    case: &Case,
    input: InputKey,
    range: Option<(f64, f64)>,
) -> Result<(f64, f64), CaseError> {
    let range = match (range, input, case.value_or_default(input)) {
        (Some(range), ..) => range,
        (None, InputKey::friction_coefficient, _) => FRICTION,
        (None, _, Some(value)) if value != 0.0 => {
            let (a, b) = (AROUND.0 * value, AROUND.1 * value);
            (a.min(b), a.max(b))
        }
        _ => return Err(CaseError::NoRange { key: input.name() }),
    };
    let rule = input.input().rule;
    let range = match rule {
        // The value in the case may be close to a limit of its rule.
        Rule::Between(low, high) => {
            let inset = 1e-6 * (high - low);
            (range.0.max(low + inset), range.1.min(high - inset))
        }
        _ => range,
    };
    let ends = [range.0, range.1];
    if !(range.0 < range.1 && ends.iter().all(|value| rule.holds(*value))) {
        let ((low, high), key) = (range, input.name());
        let what = format!("range: {low} to {high} is not a range of allowed values of `{key}`");
        return Err(CaseError::Entry { key: key.to_owned(), what });
    }
    Ok(range)
}

/// Parses an input and its search range.
pub(crate) fn sought(base: &Case, text: &str) -> Result<(InputKey, (f64, f64)), CaseError> {
    let form = "input, or input=low:high, such as seal_torque_Nm=0:1";
    let bad = || CaseError::bad_setting(text, form);
    let (name, range) = match text.split_once('=') {
        None => (text, None),
        Some((name, range)) => {
            let (low, high) = range.split_once(':').ok_or_else(bad)?;
            let number = |text: &str| text.trim().parse::<f64>().map_err(|_| bad());
            (name, Some((number(low)?, number(high)?)))
        }
    };
    let key = InputKey::named(name.trim())?;
    Ok((key, range_of(base, key, range)?))
}

impl Fit {
    /// Prepares a search for `input`, given as `name` or `name=low:high`, that reproduces the
    /// measurement `name=value`.
    ///
    /// The default range is 1e-4 to 0.5 for a friction coefficient, and 0.25 to 4 times the value
    /// in the case for other inputs.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for unknown names, a missing number, or an invalid range.
    pub fn new(
        case: &Case,
        input: &str,
        range: Option<(f64, f64)>,
        measurement: &str,
    ) -> Result<Self, CaseError> {
        let (input, range) = match range {
            Some(_) => {
                let input = InputKey::named(input)?;
                (input, range_of(case, input, range)?)
            }
            None => sought(case, input)?,
        };
        let form = "output=value, such as screw_torque_Nm=1.5";
        let bad = || CaseError::bad_setting(measurement, form);
        let (name, value) = measurement.split_once('=').ok_or_else(bad)?;
        let output = measurable(name)?;
        let measured: f64 =
            value.trim().parse().ok().filter(|v| f64::is_finite(*v)).ok_or_else(bad)?;
        Ok(Self { input, range, output, measured })
    }

    /// Returns the case with another value of the input.
    fn at(&self, case: &Case, value: f64) -> Result<Case, CaseError> {
        let mut case = case.clone();
        case.set(self.input.name(), value)?;
        Ok(case)
    }

    /// Finds every value in the range that reproduces the measured output.
    ///
    /// Model `auto` is replaced by the most complete model, because an error bound of the
    /// efficiency says nothing about the error of the input.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if the case lacks inputs of the model.
    pub fn run(&self, case: &Case, settings: &Settings) -> Result<FitReport, CaseError> {
        let mut case = case.clone();
        case.set(self.input.name(), self.range.0)?;
        let settings = &exact(&case, settings)?;
        let work = RefCell::new(ModelWorkspace::default());
        let excess = |value: f64| -> Result<f64, CaseError> {
            let case = self.at(&case, value)?;
            let output = measured(self.output, &case, settings, &mut work.borrow_mut())?;
            Ok(output.map_or(f64::NAN, |output| output - self.measured))
        };
        let run = sign_changes(excess, self.range)?;
        let fitted = |root: SignChange| {
            let response = self.measured / (root.at * root.slope);
            let problem = self.at(&case, root.at)?.problem(settings)?;
            let record = Record::new(problem.solve(&mut work.borrow_mut()));
            Ok(FitValue { value: root.at, response, record })
        };
        Ok(FitReport {
            found: run.roots.into_iter().map(fitted).collect::<Result<_, CaseError>>()?,
            reachable: run.values.map(|(low, high)| (low + self.measured, high + self.measured)),
            solved: run.share,
        })
    }

    /// Describes the result in a sentence.
    fn describe(&self, report: &FitReport) -> String {
        let (input, output) = (self.input.name(), self.output.name);
        if let [first, ..] = &report.found[..] {
            let all: Vec<_> = report
                .found
                .iter()
                .map(|fitted| format!("{input} = {:.6}", fitted.value))
                .collect();
            let more = if all.len() > 1 { "; the model gives the same at all of them" } else { "" };
            return format!(
                "{}{more}; 1 % of {output} is {:.2} % of {input}",
                all.join(", "),
                first.response.abs()
            );
        }
        let (low, high) = self.range;
        match report.reachable {
            Some((least, most)) => format!(
                "{input} from {low} to {high} gives {output} from {least:.6} to {most:.6}, not {}{}",
                self.measured,
                if report.solved < 1.0 {
                    format!(
                        "; the model has solutions in {:.0} % of that range",
                        100.0 * report.solved
                    )
                } else {
                    String::new()
                }
            ),
            None => format!("the model has no solution with {input} from {low} to {high}"),
        }
    }

    /// Returns the answer: the values found, each with the solution at this value, and the
    /// reachable outputs.
    pub fn answer(&self, case: &Case, report: &FitReport) -> Answer {
        let fitted = |f: &FitValue| {
            json!({
                self.input.name(): f.value,
                "relative_response": f.response,
                "result": f.record.to_json(),
            })
        };
        let (fails, warnings) = (report.found.is_empty(), case.warnings());
        let mut answer = Answer { warnings, fails, ..Answer::default() }
            .with("measured", Content::Json(json!({ self.output.name: self.measured })))
            .with("found", Content::Json(report.found.iter().map(fitted).collect()))
            .with(
                "reachable",
                Content::Json(json!(report.reachable.map(|(low, high)| [low, high]))),
            )
            .with("message", Content::Text("", Some(self.describe(report))));
        for found in &report.found {
            answer.sections.extend(found.record.shown(case));
        }
        answer
    }
}
