//! Answers to requests from the page. They contain the output of the commands with `--json` and the
//! data for the graphics.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use bsm_batch::{Answers, Buffers, GridSource, Source, Task, Workers};
use bsm_case::{
    Answer, AxisReport, Case, CaseError, Columns, EllipseFields, FEW_DRAWS, Grid, GridAxis,
    GrooveSection, ModelChoice, MotionAnswer, Numbers, NutProblem, NutReport, Output, Quantity,
    Record, Row, Scope, Settings, Supplement, WarmBranch, comparison, format_interval,
    with_groove_intervals,
};
use bsm_dyn::{Model, ModelWorkspace, Status, model::RacewayFriction};
use bsm_report::sheets::{size_figures, size_page, size_results};
use bsm_report::{PROGRAM, format_number};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use thiserror::Error;

use crate::form::schema;

/// Maximum number of points of a map.
const MAX_POINTS: usize = 40_000;

/// The reason why a request is refused.
#[derive(Debug, Error)]
pub enum Refusal {
    /// The request contains invalid input.
    #[error("{text}")]
    Input {
        /// Message, which is the same as on the command line.
        text: String,
        /// Name of the invalid or missing input, if the name is known.
        key: Option<String>,
    },
    /// The server has no route with this path.
    #[error("unknown route `{0}`")]
    Route(String),
    /// The calculation took too long and was stopped.
    #[error(
        "stopped after {0} s, because this point takes too long for the page; the command line has no such limit"
    )]
    Slow(u64),
    /// The same page has sent a newer request.
    #[error("replaced by a newer request")]
    Superseded,
    /// Too many stopped calculations are still running.
    #[error("too many stopped calculations are still running; wait, or start bsm view again")]
    Busy,
    /// The operating system cannot start another thread.
    #[error("cannot start a thread: {0}; close other programs, or try again")]
    Thread(std::io::Error),
}

impl Refusal {
    /// Creates the refusal of an input whose name is not known.
    pub(crate) fn input(text: impl Into<String>) -> Self {
        Self::Input { text: text.into(), key: None }
    }

    /// Converts the refusal to a JSON object with two members: `error` contains the message, and
    /// `key` contains the name of the invalid or missing input, or null.
    pub fn to_json(&self) -> Value {
        let key = match self {
            Self::Input { key, .. } => key.as_deref(),
            _ => None,
        };
        json!({ "error": self.to_string(), "key": key })
    }
}

impl From<CaseError> for Refusal {
    fn from(error: CaseError) -> Self {
        Self::Input { text: error.to_string(), key: error.key().map(str::to_owned) }
    }
}

/// Members of a request that only some routes read. All members can be missing.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RequestOptions {
    /// `solve`: false to omit the torque contributions.
    parts: Option<bool>,
    /// `solve`: true to calculate the 90 % intervals for the uncertain oil properties.
    #[serde(default)]
    band: bool,
    /// `axis`: true to include the axis sheet.
    #[serde(default)]
    sheet: bool,
    /// `sweep`: axes of the grid, in the form of the option `--vary`.
    vary: Option<Vec<String>>,
    /// `sweep`: names of the outputs.
    columns: Option<Vec<String>>,
}

/// A parsed request.
pub(crate) struct Request {
    pub(crate) case: Case,
    pub(crate) settings: Settings,
    options: RequestOptions,
}

impl Request {
    /// Returns the request with a complete groove. Missing groove inputs are estimated.
    pub(crate) fn with_groove(self) -> Result<Self, Refusal> {
        Ok(Self { case: self.case.with_groove()?, ..self })
    }

    /// Parses the JSON body of a request.
    pub(crate) fn read(body: &[u8]) -> Result<Self, Refusal> {
        let mut members: Map<_, _> = bsm_case::entries(body)?.into_iter().collect();
        let case = match members.remove("case") {
            Some(Value::Object(entries)) => Case::from_entries(entries)?,
            Some(_) => return Err(Refusal::input("`case` must be an object")),
            None => return Err(Refusal::input("case is missing")),
        };
        // The settings have the same format as in the output of `bsm solve --json`.
        let settings = Settings::from_json(&members.remove("settings").unwrap_or_default())?;
        let options = serde_path_to_error::deserialize(Value::Object(members))
            .map_err(|error| Refusal::input(error.to_string()))?;
        Ok(Self { case, settings, options })
    }
}

/// Calculates the answer to a request from the page.
///
/// * `stop`: flag that stops the calculation of a map when it becomes true.
///
/// # Errors
/// Returns [`Refusal`] if the request is malformed or has no answer.
pub fn answer(
    route: &str,
    body: &[u8],
    workers: &Workers<'_>,
    stop: &AtomicBool,
) -> Result<Value, Refusal> {
    let request = || Request::read(body)?.with_groove();
    match route {
        "schema" => Ok(schema()),
        "point" => point(&request()?),
        "solve" => solve(&request()?),
        "compare" => compare(&request()?),
        "slip" => slip(&request()?),
        "nut" => nut(&request()?),
        "warm" => warm(&request()?),
        "axis" => axis(&Request::read(body)?),
        "ellipses" => ellipses(&request()?),
        "sweep" => sweep(&Request::read(body)?, workers, stop),
        _ => Err(Refusal::Route(route.to_owned())),
    }
}

/// Returns all results for one point: `solve` without the torque contributions, `slip` and
/// `ellipses`.
fn point(request: &Request) -> Result<Value, Refusal> {
    Ok(json!({
        "solve": solved(request, false)?,
        "slip": or_message(slip(request)),
        "ellipses": or_message(ellipses(request)),
    }))
}

/// Returns the answer, or an object with the error message if there is no answer.
fn or_message(answer: Result<Value, Refusal>) -> Value {
    answer.unwrap_or_else(|refusal| refusal.to_json())
}

/// Returns the output of `bsm solve --json`, the rows of the printed table, the cross section of the
/// grooves, and the note on an estimated groove.
fn solve(request: &Request) -> Result<Value, Refusal> {
    solved(request, request.options.parts.unwrap_or(true))
}

/// Returns the same data as [`solve`], optionally without the torque contributions.
///
/// * `parts`: true to include the torque contributions, which require the equilibrium of a
///   preloaded nut.
fn solved(Request { case, settings, options }: &Request, parts: bool) -> Result<Value, Refusal> {
    let record = Record::new(case.problem(settings)?.solve(&mut ModelWorkspace::default()));
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model does not accept the inputs");
        return Err(Refusal::input(text));
    }
    let supplement = Supplement { band: options.band, parts, sensitivities: None };
    let answer = record.answer(PROGRAM, case, settings, &supplement);
    let answer = answer.with_groove_intervals(case, FEW_DRAWS, |possible| {
        let solution = possible.problem(settings).ok()?.solve(&mut ModelWorkspace::default());
        let supplement = Supplement { parts, ..Supplement::default() };
        Some(Record::new(solution).answer(PROGRAM, possible, settings, &supplement))
    });
    let Value::Object(mut report) = answer.to_json() else {
        return Err(Refusal::input("the point has no result"));
    };
    let numbers =
        answer.shown_numbers().ok_or_else(|| Refusal::input("the point has no result"))?;
    let numbers = numbers.clone().in_units(case.display_units());
    let unbounded = record.unbounded();
    let rows = |scope: Scope| numbers.rows().filter(move |row| row.quantity.scope == scope);
    let whole = |row: &Row| {
        Some(json!([
            row.quantity.about,
            row.unit,
            format_number(row.values[0]?) + &format_interval(row.bands[0])
        ]))
    };
    let contact = |row: &Row| {
        let cell = |place: usize| {
            Some(format_number(row.values[place]?) + &format_interval(row.bands[place]))
        };
        let cells = [0, 1, 2].map(cell);
        json!([row.quantity.about, row.unit, cells])
    };
    let key = |row: &Row| {
        let entry = |(place, column): (usize, &Output)| {
            let value = row.values[place]?;
            let text = format_number(value) + &format_interval(row.bands[place]);
            let label = match row.quantity.scope {
                scope @ Scope::Contacts => {
                    format!("{}, {}", row.quantity.about, scope.members()[place])
                }
                _ => row.quantity.about.trim_start().to_owned(),
            };
            let key = json!({ "value": value, "unit": row.unit, "label": label, "text": text });
            Some((column.name.to_owned(), key))
        };
        row.quantity.columns.iter().enumerate().filter_map(entry).collect::<Vec<_>>()
    };
    let marked = numbers.rows().filter(|row| unbounded.contains(&row.quantity.name));
    report.insert(
        "shown".to_owned(),
        json!({
            "overall": rows(Scope::Scalar).filter_map(whole).collect::<Vec<_>>(),
            "contacts": rows(Scope::Contacts).map(contact).collect::<Vec<_>>(),
            "unbounded": marked.map(|row| row.quantity.about).collect::<Vec<_>>(),
            "keys": numbers.rows().flat_map(key).collect::<Map<_, _>>(),
        }),
    );
    report.insert("groove_note".to_owned(), json!(case.groove_note()));
    report.insert("lubrication".to_owned(), json!(record.lubrication()));
    let section = GrooveSection::of(case).ok();
    let warnings = section.as_ref().map(|section| section.warnings(&record));
    report.insert("section".to_owned(), section.map_or(Value::Null, |section| section.to_json()));
    report.insert("section_warnings".to_owned(), json!(warnings.unwrap_or_default()));
    let lead_angle = case.lead_angle().map(f64::to_degrees);
    report.insert("lead_angle_deg".to_owned(), json!(lead_angle));
    let speeds = case.speeds_rpm().map(|(screw, nut)| [screw, nut]);
    report.insert("speeds_rpm".to_owned(), json!(speeds));
    Ok(Value::Object(report))
}

/// Returns the output of `bsm solve --model all --json`, including the omitted models and the
/// reasons for omitting them. The note on an estimated groove is a separate member.
fn compare(Request { case, .. }: &Request) -> Result<Value, Refusal> {
    let mut answer = comparison(case)?.to_json();
    answer["groove_note"] = json!(case.groove_note());
    Ok(answer)
}

/// Returns the solution whose motion is analyzed. The page shows results of the same solution, so
/// that all losses agree.
fn moving(case: &Case, settings: &Settings) -> Result<MotionAnswer, CaseError> {
    let solution = case.problem(settings)?.solve(&mut ModelWorkspace::default());
    Ok(MotionAnswer { settings: *settings, solution })
}

/// Returns the output of `bsm solve --show slip --json`.
fn slip(request: &Request) -> Result<Value, Refusal> {
    let answer = |case: &Case| {
        let MotionAnswer { settings, solution } = moving(case, &request.settings)?;
        bsm_case::slip(case, &settings, &solution)
    };
    Ok(with_groove_intervals(&request.case, FEW_DRAWS, answer)?.to_json())
}

/// Returns the pressure, slip and friction over the contact ellipses.
fn ellipses(request: &Request) -> Result<Value, Refusal> {
    let MotionAnswer { settings, solution } = moving(&request.case, &request.settings)?;
    Ok(EllipseFields::of(&request.case, &settings, &solution, EllipseFields::POINTS)?
        .answer()
        .to_json())
}

/// Returns the output of `bsm nut --json`, the table of balls, and the load-displacement curve.
fn nut(Request { case, settings, .. }: &Request) -> Result<Value, Refusal> {
    let problem = NutProblem::of(case, settings)?;
    let settings = problem.settings();
    let report = match problem.solve() {
        Ok(report) => report,
        Err(none) => return Ok(NutProblem::unsolved(case, &none).to_json()),
    };
    let sections = NutReport::with_groove_intervals(report.answer(), case, &settings);
    let mut answer = sections.to_json();
    answer["balls"] = columns(&report.balls());
    answer["curve"] = columns(&report.curve());
    answer["shown"] = shown(&sections.in_units(case.display_units()));
    Ok(answer)
}

/// Returns the warm steady states as a function of the speed, for a plot. Friction is calculated
/// with one coefficient per contact, which is the fastest method.
fn warm(Request { case, settings, .. }: &Request) -> Result<Value, Refusal> {
    let quick = Settings { friction: RacewayFriction::PerContact, ..Model::RacewayControl.into() };
    let quick = Settings { control: settings.control, ..quick };
    Ok(WarmBranch::of(case, &quick)?.map_or(Value::Null, |branch| branch.to_json()))
}

/// Returns the output of `bsm axis --json`, the formatted numbers and, if requested, the axis
/// sheet.
fn axis(Request { case, settings, options }: &Request) -> Result<Value, Refusal> {
    let report = AxisReport::of(case, settings)?;
    let mut answer = size_results(&report);
    let displayed = report.answer.clone().in_units(case.display_units());
    answer["shown"] = shown(&displayed);
    // The page shows the rules and their intervals in display units.
    if let Some(rules) = displayed.to_json().get_mut("rules") {
        answer["rules"] = rules.take();
    }
    if let Some(estimate) = answer.get_mut("groove_estimate") {
        estimate["intervals"] = displayed.intervals();
    }
    if options.sheet {
        let sheet = size_page(&report, &size_figures(&report), None)
            .map_err(|error| Refusal::input(error.to_string()))?;
        answer["sheet"] = json!(sheet);
    }
    Ok(answer)
}

/// Returns the title, label, unit and formatted value of each number in an answer.
fn shown(answer: &Answer) -> Value {
    let row = |row: &Row| {
        let Quantity { title, about, .. } = row.quantity;
        Some(json!([
            title,
            about,
            row.unit,
            format_number(row.values[0]?) + &format_interval(row.bands[0])
        ]))
    };
    answer.numbers().flat_map(Numbers::rows).filter_map(row).collect()
}

/// Returns the columns of a table as an object. Each column has a unit and values. Missing numbers
/// are null.
fn columns(table: &Columns) -> Value {
    let column = |(place, head): (usize, &&Output)| {
        let values: Value = table.rows.iter().map(|row| row[place]).collect();
        (head.name.to_owned(), json!({ "unit": head.unit, "values": values }))
    };
    Value::Object(table.heads.iter().enumerate().map(column).collect())
}

/// Returns the results of `bsm sweep`, column by column. The request member `vary` contains the
/// axes of the grid, and `columns` contains the outputs. Models and statuses are returned as
/// indices into lists of names.
fn sweep(
    Request { case, settings, options }: &Request,
    workers: &Workers<'_>,
    stop: &AtomicBool,
) -> Result<Value, Refusal> {
    let vary = options.vary.as_ref().ok_or_else(|| Refusal::input("vary is missing"))?;
    let columns = options.columns.as_ref().ok_or_else(|| Refusal::input("columns is missing"))?;
    let grid = Grid::parse(vary)?;
    if grid.len() > MAX_POINTS {
        let text = format!("the map has {} points; at most {MAX_POINTS} are permitted", grid.len());
        return Err(Refusal::input(text));
    }
    let outputs = Answers::select(Some(columns));
    let outputs = outputs.map_err(|error| Refusal::input(error.to_string()))?;
    let task = Task::over_grid(case.clone(), *settings, outputs, None, &grid)?;
    let mut source = GridSource::new(grid.clone());
    let named = source.columns().clone();
    let chunk = source.next(grid.len()).map_err(|error| Refusal::input(error.to_string()))?;
    let chunk = chunk.ok_or_else(|| Refusal::input("the map has no points"))?;
    let mut answers = Answers::allocate(grid.len(), task.outputs.len());
    let room = Buffers {
        outcomes: &mut answers.outcomes,
        columns: answers.columns.iter_mut().map(|column| Some(&mut column[..])).collect(),
    };
    workers.install(|| task.solve_into((&chunk, &named), room, stop, &AtomicU64::new(0)));
    if stop.load(Ordering::Relaxed) {
        return Err(Refusal::Superseded);
    }
    let axis = |axis: &GridAxis| {
        let values: Vec<_> = (0..axis.len()).map(|place| axis.value(place)).collect();
        json!({ "name": axis.key.name(), "values": values, "log": axis.is_log() })
    };
    let models: Vec<_> = ModelChoice::names().collect();
    let place = |name: &str| models.iter().position(|known| *known == name);
    let of_rows: Vec<_> = answers.outcomes.iter().map(|v| json!(place(v.model.name()))).collect();
    let statuses: Vec<_> = answers
        .outcomes
        .iter()
        .map(|v| json!(Status::ALL.iter().position(|status| *status == v.status)))
        .collect();
    let column = |(output, values): (&&Output, &Vec<f64>)| {
        (output.name.to_owned(), values.iter().copied().collect::<Value>())
    };
    let columns: Map<_, _> = task.outputs.iter().zip(&answers.columns).map(column).collect();
    Ok(json!({
        "axes": grid.axes().iter().map(axis).collect::<Vec<_>>(),
        "models": models,
        "statuses": Status::ALL.map(Status::name),
        "model": of_rows,
        "status": statuses,
        "columns": columns,
    }))
}
