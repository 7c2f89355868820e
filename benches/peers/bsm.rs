//! The solver of this project, which solves the points one by one or as a table.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::sync::{Mutex, MutexGuard};

use bsm_batch::{Answers, Buffers, Chunk, Columns, Task};
use bsm_case::{Case, Output, OutputName, Record, Settings, output};
use bsm_dyn::{Model, ModelWorkspace, Problem, Solution, Status, model::RigidWorkspace};

use crate::equations::Answer;
use crate::points::{INPUTS, Point};

/// Outputs that the comparison of solvers uses.
const OUTPUTS: [OutputName; 8] = [
    output!(efficiency),
    output!(nut_normal_load_N),
    output!(unloaded_flank_normal_load_N),
    output!(screw_normal_load_N),
    output!(ball_precession_rad_s),
    output!(ball_omega_t_rad_s),
    output!(nut_slip_velocity_m_s),
    output!(nut_spin_rad_s),
];

/// Values of the outputs in [`OUTPUTS`] at one point.
pub(crate) type Numbers = [f64; OUTPUTS.len()];

fn settings() -> Settings {
    Model::Rigid.into()
}

/// Converts the cases to problems in SI units.
pub(crate) fn problems(cases: &[Case]) -> Vec<Problem> {
    cases.iter().map(|case| case.problem(&settings()).expect("a complete case")).collect()
}

/// Solves the points one by one, with all outputs in SI units.
pub(crate) fn scalar(problems: &[Problem]) -> Vec<Solution> {
    let mut work = ModelWorkspace::default();
    problems.iter().map(|problem| problem.solve(&mut work)).collect()
}

/// All points as a table in memory.
pub(crate) struct Table {
    chunk: Chunk,
    columns: Columns,
    task: Task,
    answers: Mutex<Answers>,
}

impl Table {
    pub(crate) fn of(points: &[Point]) -> Self {
        let (chunk, columns) = bsm_benches::chunk(INPUTS, points);
        let outputs = OUTPUTS.map(|name| Output::named(name.name()).expect("known name"));
        let task = Task::new(Case::default(), settings(), outputs.to_vec());
        let answers = Mutex::new(Answers::allocate(points.len(), OUTPUTS.len()));
        Self { chunk, columns, task, answers }
    }

    /// Solves the table on the threads of the current thread pool. The results are written into a
    /// buffer that is reused, as in the table writers and in Python, because allocating new memory
    /// would take a tenth of the solution time.
    pub(crate) fn solve(&self) -> MutexGuard<'_, Answers> {
        let mut answers = self.answers.lock().expect("no solve has panicked");
        let Answers { outcomes, columns, .. } = &mut *answers;
        let columns = columns.iter_mut().map(|column| Some(&mut column[..])).collect();
        let buffers = Buffers { outcomes, columns };
        let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
        let told = self.task.solve_into((&self.chunk, &self.columns), buffers, &stop, &done);
        answers.messages = told.messages;
        answers
    }
}

/// Returns the outputs in a row of the table, or `None` if the row has no solution.
pub(crate) fn row(answers: &Answers, row: usize) -> Option<Numbers> {
    let there = answers.outcomes[row].status == Status::Converged;
    there.then(|| std::array::from_fn(|i| answers.columns[i][row]))
}

/// Returns the outputs of one solution.
pub(crate) fn numbers(solution: &Solution) -> Option<Numbers> {
    let record = Record::new(solution.clone());
    let mut numbers = [0.0; OUTPUTS.len()];
    for (number, name) in numbers.iter_mut().zip(OUTPUTS) {
        *number = record.number(name)?;
    }
    Some(numbers)
}

/// Returns the reference with which all other solvers are compared. It consists of the outputs of
/// this solver and the ball motion at its root.
pub(crate) fn reference(case: &Case) -> Option<Answer> {
    let Ok(Problem::Rigid(rigid)) = case.problem(&settings()) else { return None };
    let mut work = RigidWorkspace::default();
    let (solved, root) = (rigid.solve(&mut work).result.ok()?, rigid.root(&mut work).ok()?);
    Some([
        solved.transmission.efficiency,
        solved.ball.nut.load?,
        solved.ball.unloaded?.load?,
        solved.ball.screw.load?,
        root.p,
        root.u,
        root.tau,
        root.s,
    ])
}

/// Converts the outputs of a solution to an [`Answer`] for the comparison. The unknowns are
/// calculated from the ball motion and the slip at contact A.
pub(crate) fn answer(numbers: &Numbers, point: &Point) -> Answer {
    let [ball_mm, pitch_mm, lead_deg, _, _, density, screw_rpm, nut_rpm, axial, balls] = *point;
    let (r_b, r_m) = (0.5e-3 * ball_mm, 0.5e-3 * pitch_mm);
    let (sin_a, cos_a) = lead_deg.to_radians().sin_cos();
    let (w, nut) = ((screw_rpm - nut_rpm) * PI / 30.0, nut_rpm * PI / 30.0);
    let inertia = 0.4 * (4.0 / 3.0 * PI * r_b.powi(3) * density) * r_b * r_b;
    let [efficiency, q_a, q_m, q_b, precession, omega_t, slip, spin] = *numbers;
    let (p, u) = ((precession - nut) / w, (omega_t - nut * sin_a) / w);
    // The slip at contact A has the component u across the groove, and the component d p + τ along
    // t in the direction of W.
    let slip = slip / (r_b * w.abs());
    let along = (slip * slip - u * u).sqrt();
    let s = inertia * precession * spin / (r_b * axial / balls);
    [efficiency, q_a, q_m, q_b, p, u, along - p * r_m / (cos_a * r_b), s]
}
