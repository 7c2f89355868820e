//! Solves a single point, and checks the result for defects.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use bsm_batch::{Chunk, Columns, TableFormat, Task};
use bsm_case::units::{MM, RPM};
use bsm_case::{
    Case, InputKey, ModelChoice, OUTPUTS, Output, Record, Sensitivities, Settings, output,
};
use bsm_dyn::{Ball, ModelWorkspace, Reason, Status};

/// Maximum permitted scaled residual of a solution.
const RESIDUAL: f64 = 1e-10;
/// Maximum permitted error of the power balance of a solution.
const BALANCE: f64 = 1e-9;

/// Maximum relative difference between the efficiencies of the vectorized kernel and of the scalar
/// model. If the inertia forces are far smaller than the load, only a few digits of the efficiency
/// are determined, and both results are accepted because of their small residuals.
const BATCH: f64 = 1e-7;

/// Absolute tolerance that is added to the relative tolerance. It allows for the rounding errors of
/// efficiencies that are almost zero because friction nearly holds the load.
const ROUNDING: f64 = 1e-14;

/// Severity of an outcome, in ascending order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Severity {
    Converged,
    NoSolution,
    Invalid,
    NotConverged,
    Wrong,
}

impl From<Status> for Severity {
    fn from(status: Status) -> Self {
        match status {
            Status::Converged => Self::Converged,
            Status::NoSolution => Self::NoSolution,
            Status::InvalidInput => Self::Invalid,
            Status::NotConverged => Self::NotConverged,
        }
    }
}

/// Outcome of solving a point.
pub(crate) struct Answer {
    pub(crate) severity: Severity,
    /// Kind of outcome: the status, followed by the slip regime or by the reason.
    pub(crate) kind: String,
    /// Message of the program about the point.
    pub(crate) words: String,
    pub(crate) residual: f64,
    /// Number of further solutions of the point; `None` if the program did not search for further
    /// solutions.
    pub(crate) others: Option<usize>,
    pub(crate) balance: f64,
    pub(crate) time: Duration,
    efficiency: Option<f64>,
}

impl Answer {
    fn new(severity: Severity, kind: String) -> Self {
        let (words, residual, balance, time) = (String::new(), 0.0, 0.0, Duration::ZERO);
        Self { severity, kind, words, residual, others: None, balance, time, efficiency: None }
    }

    fn mark_as_false(&mut self, what: &str) {
        (self.severity, self.kind) = (Severity::Wrong, format!("false {what}"));
    }

    fn mark_sensitivities_as_missing(&mut self, reason: &Reason) {
        let kind = format!("converged, no sensitivities: {}", name(reason));
        (self.severity, self.kind) = (Severity::NotConverged, kind);
    }
}

/// Solves a case with a model and classifies the outcome.
pub(crate) fn classify(case: &Case, model: ModelChoice, work: &mut ModelWorkspace) -> Answer {
    let problem = match case.problem(&settings(model)) {
        Ok(problem) => problem,
        Err(error) => return Answer::new(Severity::Invalid, format!("invalid_input: {error}")),
    };
    let begin = Instant::now();
    let solved = catch_unwind(AssertUnwindSafe(|| problem.solve(work)));
    let time = begin.elapsed();
    let Ok(solution) = solved else {
        *work = ModelWorkspace::default();
        return Answer::new(Severity::Wrong, "panic".to_owned());
    };
    let reason = solution.reason().map(name).unwrap_or_default();
    let others = solution.steady_state().and_then(|solved| Some(solved.alternatives?.count));
    let record = Record::new(solution);
    let mut answer = Answer::new(record.status().into(), String::new());
    answer.time = time;
    record.message().unwrap_or_default().clone_into(&mut answer.words);
    if record.status() != Status::Converged {
        answer.kind = format!("{} {reason}", record.status_name());
        return answer;
    }
    answer.kind = format!("converged {}", record.regime().unwrap_or_default());
    answer.residual = record.number(output!(residual_norm)).unwrap_or(0.0);
    answer.others = others;
    answer.balance = record.number(output!(power_balance)).unwrap_or(0.0).abs();
    answer.efficiency = record.number(output!(efficiency));
    if let Some(wrong) = find_defect(&record, case, &answer) {
        answer.mark_as_false(&wrong);
    }
    answer
}

fn settings(model: ModelChoice) -> Settings {
    Settings { model, ..Settings::default() }
}

/// Calculates the sensitivities of a converged solution. They must be finite, or a reason must be
/// stated why they are missing.
pub(crate) fn with_sensitivities(
    case: &Case,
    model: ModelChoice,
    answer: &mut Answer,
    work: &mut ModelWorkspace,
) {
    if answer.severity != Severity::Converged {
        return;
    }
    let asked = Sensitivities::of(case, &settings(model)).expect("the point was solved");
    let found = catch_unwind(AssertUnwindSafe(|| asked.solve(work)));
    match found {
        Err(_) => {
            *work = ModelWorkspace::default();
            answer.mark_as_false("panic in the sensitivities");
        }
        Ok(Err(none)) => answer.mark_sensitivities_as_missing(none.reason()),
        Ok(Ok((_, rows))) => {
            let mut slopes = rows.iter().flat_map(|row| [Some(row.efficiency), row.screw_torque]);
            if !slopes.all(|slope| slope.is_none_or(f64::is_finite)) {
                answer.mark_as_false("sensitivity not finite");
            }
        }
    }
}

/// The only failure of the scalar model for which a vectorized kernel may find a solution. The
/// formulas of the kernel are free of cancellation, and the kernel also rejects solutions that do
/// not satisfy the power balance.
const ROUNDED: &str = "not_converged PowerDoesNotBalance";

/// Solves all cases as one table, so that vectorized kernels are used for some models, and compares
/// the outcomes with the given answers.
pub(crate) fn in_batch(cases: &[Case], model: ModelChoice, answers: &mut [Answer]) {
    let given = |key: &InputKey| cases.iter().any(|case| case[*key].is_some());
    let names = InputKey::ALL.into_iter().filter(given).map(InputKey::name);
    let columns =
        Columns::sort(names, &[], &TableFormat::default()).expect("every input name occurs once");
    let rows = cases.iter().map(|case| columns.inputs.iter().map(|key| case[*key]));
    let chunk = Chunk::of_rows(&columns, rows);
    let efficiency = Output::named("efficiency").expect("an output");
    let task = Task::new(Case::default(), settings(model), vec![efficiency]);
    let Ok(batch) = catch_unwind(AssertUnwindSafe(|| task.solve(&chunk, &columns))) else {
        for answer in answers {
            answer.mark_as_false("panic in the batch");
        }
        return;
    };
    for ((answer, verdict), eta) in answers.iter_mut().zip(&batch.outcomes).zip(&batch.columns[0]) {
        let known = answer.efficiency.unwrap_or(f64::NAN);
        let alike = (eta - known).abs() <= BATCH * known.abs() + ROUNDING;
        if answer.kind == ROUNDED && verdict.status == Status::Converged {
            answer.kind.push_str(", but solved in the batch");
        } else if answer.severity < Severity::Wrong
            && Severity::from(verdict.status) != answer.severity
        {
            answer.mark_as_false("status in the batch");
        } else if answer.severity == Severity::Converged && !alike {
            answer.mark_as_false("efficiency in the batch");
        }
    }
}

/// Returns the name of a reason. If an iteration failed, the name includes how the iteration ended.
fn name(reason: &Reason) -> String {
    let text = format!("{reason:?}");
    let name: String = text.chars().take_while(char::is_ascii_alphanumeric).collect();
    match reason {
        Reason::Newton { status, .. } => format!("{name} {status:?}"),
        Reason::NoSkidAtInertia { inertia_ratio, min, max }
            if (min..=max).contains(&inertia_ratio) =>
        {
            format!("{name}, in a gap")
        }
        _ => name,
    }
}

/// Returns the inertia ratio, which is the inertia force `$m r_m W^2$` divided by the load.
pub(crate) fn inertia(case: &Case) -> f64 {
    let get = |key| case.value_or_default(key).unwrap_or(f64::NAN);
    let ball = 0.5 * MM * get(InputKey::ball_diameter_mm);
    let mass = Ball::of_density(ball, get(InputKey::density_kg_m3)).mass;
    let pitch = 0.5 * MM * get(InputKey::pitch_circle_diameter_mm);
    let speed = RPM * (get(InputKey::screw_speed_rpm) - get(InputKey::nut_speed_rpm));
    mass * pitch * speed * speed / get(InputKey::axial_load_N)
}

/// Describes the first defect of a converged solution, or returns `None` if it has no defect.
fn find_defect(record: &Record, case: &Case, answer: &Answer) -> Option<String> {
    for output in OUTPUTS {
        if let Some(x) = record.value(output)
            && !x.is_finite()
        {
            return Some(format!("{} not finite", output.name));
        }
    }
    if answer.residual > RESIDUAL {
        return Some("residual".to_owned());
    }
    if answer.balance > BALANCE {
        return Some("power balance".to_owned());
    }
    let loads = [
        output!(nut_normal_load_N),
        output!(screw_normal_load_N),
        output!(unloaded_flank_normal_load_N),
    ];
    for name in loads {
        // A contact load that is not positive is a defect.
        if record.number(name).is_some_and(|load| load <= 0.0) {
            return Some(format!("{} not positive", name.name()));
        }
    }
    for name in [output!(nut_contact_angle_deg), output!(screw_contact_angle_deg)] {
        if record.number(name).is_some_and(|angle| !(0.0..=90.0).contains(&angle)) {
            return Some(format!("{} outside 0 to 90 deg", name.name()));
        }
    }
    // Friction must not generate power. The tolerance allows for the rounding errors of a very
    // small power loss.
    let taken =
        record.number(output!(dissipated_power_W)).zip(record.number(output!(input_power_W)));
    if taken.is_some_and(|(lost, input)| lost < -1e-12 * input.abs()) {
        return Some("dissipated power negative".to_owned());
    }
    let most = if case.friction_coefficient == Some(0.0) { 1.0 } else { 1.0 + 1e-12 };
    answer.efficiency.filter(|eta| *eta > most).map(|_| "efficiency above one".to_owned())
}
