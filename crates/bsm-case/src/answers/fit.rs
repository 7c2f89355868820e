//! Calculation of an input from a measured output.

use std::cell::RefCell;

use bsm_design::search::{SignChange, sign_changes};
use bsm_design::{Band, FEW_DRAWS};
use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::json;

use crate::{
    Answer, Case, CaseError, Content, InputKey, Known, ModelChoice, Output, Record, Rule, Settings,
    interval, torque_parts,
};

/// What may be measured: a number of a solution, or the torque that the screw takes.
const SCREW_TORQUE: &str = "screw_torque_Nm";

/// An output that may be measured.
pub(crate) fn measurable(name: &str) -> Result<&'static Output, CaseError> {
    let name = name.trim();
    let output = Output::named(name).filter(|o| o.json_type == "number");
    output.filter(|output| output.key().is_some() || output.name == SCREW_TORQUE).ok_or_else(|| {
        let nearest = Output::nearest(name).filter(|nearest| *nearest != name);
        CaseError::unknown(Known::Output, name, nearest)
    })
}

/// What would be measured at a point; `None` without a solution.
///
/// # Errors
///
/// [`CaseError`] if the case lacks inputs of the model, or the model does not have the output.
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

/// The settings, with the most complete model in place of model auto: an error bound of the efficiency is none of an input.
pub(crate) fn exact(case: &Case, settings: &Settings) -> Result<Settings, CaseError> {
    let model = match case.choose(settings.model)? {
        ModelChoice::Auto => Model::Traction.into(),
        fixed @ ModelChoice::Fixed(_) => fixed,
    };
    Ok(Settings { model, ..*settings })
}

/// Default range of a friction coefficient.
const FRICTION: (f64, f64) = (1e-4, 0.5);

/// Default range of another input, over its value in the case.
const AROUND: (f64, f64) = (0.25, 4.0);

/// A fit: case, measured output and the input to find.
#[derive(Debug, Clone)]
pub struct Fit {
    input: InputKey,
    range: (f64, f64),
    output: &'static Output,
    measured: f64,
}

/// A value of the input at which the model gives what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct FitValue {
    /// The value of the input.
    pub value: f64,
    /// Relative change of the input for a relative change of what was measured.
    pub response: f64,
    /// The answer of the model there.
    pub record: Record,
    /// 90 % interval of the value over the possible grooves, if the groove is estimated.
    pub band: Option<Band>,
}

/// All values in the range, and how the output runs over it.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// The values, the smallest first.
    pub found: Vec<FitValue>,
    /// Smallest and largest output over the range, where the model has solutions.
    pub reachable: Option<(f64, f64)>,
    /// Share of the range in which the model has solutions.
    pub solved: f64,
}

/// Search range of an input: as given; 1e-4 to 0.5 for a friction coefficient, a quarter of the case's value to
/// four times it for another.
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
        // Values in a case may be near the end of what is allowed.
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

/// An input and where it is looked for.
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
    /// Seeks `input`, a `name` or `name=low:high`, in `range` such that the output of a measurement `name=value` comes out.
    ///
    /// The range is 1e-4 to 0.5 for a friction coefficient, a quarter of the case's value to four
    /// times it for another input, unless given.
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

    /// The case with a value of the input.
    fn at(&self, case: &Case, value: f64) -> Result<Case, CaseError> {
        let mut case = case.clone();
        case.set(self.input.name(), value)?;
        Ok(case)
    }

    /// Every value in the range at which the output is as measured.
    ///
    /// In place of model auto the most complete one is taken: an error bound of the efficiency is none
    /// of the input.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if the case has no inputs for the model.
    pub fn run(&self, case: &Case, settings: &Settings) -> Result<FitReport, CaseError> {
        let mut report = self.search(case, settings)?;
        let others = case.over_possible(FEW_DRAWS, |possible| self.search(possible, settings).ok());
        for (place, fitted) in report.found.iter_mut().enumerate() {
            let values = others.iter().flatten().filter_map(|other| other.found.get(place));
            fitted.band = Band::of(values.map(|other| other.value));
        }
        Ok(report)
    }

    /// The same for one groove.
    fn search(&self, case: &Case, settings: &Settings) -> Result<FitReport, CaseError> {
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
            Ok(FitValue { value: root.at, response, record, band: None })
        };
        Ok(FitReport {
            found: run.roots.into_iter().map(fitted).collect::<Result<_, CaseError>>()?,
            reachable: run.values.map(|(low, high)| (low + self.measured, high + self.measured)),
            solved: run.share,
        })
    }

    /// Label of the found number.
    fn describe(&self, report: &FitReport) -> String {
        let (input, output) = (self.input.name(), self.output.name);
        if let [first, ..] = &report.found[..] {
            let all: Vec<_> = report
                .found
                .iter()
                .map(|FitValue { value, band, .. }| {
                    let with = band.map_or("", |_| " over the possible grooves");
                    format!("{input} = {value:.6}{}{with}", interval(*band))
                })
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

    /// The answer: the values, each with the result there, and what can be reached.
    pub fn answer(&self, case: &Case, report: &FitReport) -> Answer {
        let fitted = |f: &FitValue| {
            json!({
                self.input.name(): f.value,
                "relative_response": f.response,
                "groove_interval": f.band.map(|band| [band.low, band.high]),
                "result": f.record.to_json(),
            })
        };
        let (fails, warnings) = (report.found.is_empty(), case.warnings());
        let notes = case.groove_note().into_iter().collect();
        let mut answer = Answer { notes, warnings, fails, ..Answer::default() }
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
