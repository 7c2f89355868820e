//! Prints random points of the traction model as JSON, with the results and times of the solver of
//! this project. `benches/peers/traction.sh` compares them with other solvers.
#![expect(clippy::print_stdout, reason = "the program prints its results")]

use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Instant;

use bsm_batch::Task;
use bsm_benches::{chunk, ordinary, seeded, values};
use bsm_case::{Case, Output, OutputName, Record, Settings, output};
use bsm_dyn::{Model, ModelWorkspace, Solution};
use clap::Parser;
use rayon::ThreadPoolBuilder;

/// Inputs of the traction model, in the order in which the compared solvers read them.
const INPUTS: [&str; 14] = [
    "ball_diameter_mm",
    "pitch_circle_diameter_mm",
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "density_kg_m3",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
    "loaded_balls",
    "nut_conformity",
    "screw_conformity",
    "youngs_modulus_GPa",
    "poisson_ratio",
];

/// Outputs in which all compared solvers must agree.
const OUTPUTS: [OutputName; 5] = [
    output!(efficiency),
    output!(nut_normal_load_N),
    output!(screw_normal_load_N),
    output!(nut_contact_angle_deg),
    output!(screw_contact_angle_deg),
];

/// Solves random points with the traction model, both one by one and as a table
#[derive(Debug, Parser)]
struct Arguments {
    /// Number of points
    #[arg(long, default_value_t = 1000)]
    count: usize,
    /// Use the points of validation/golden/tradeoff/cases.csv instead of random points; solvers may
    /// miss roots there
    #[arg(long)]
    ordinary: bool,
    /// Number of runs; the median is reported
    #[arg(long, default_value = "31")]
    runs: NonZeroUsize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { count, ordinary: is_ordinary, runs } = Arguments::parse();
    let cases = if is_ordinary { ordinary(Model::Traction) } else { seeded(count) };
    let points: Vec<_> = cases.iter().map(|case| values(case, &INPUTS)).collect();
    let settings: Settings = Model::Traction.into();

    let mut work = ModelWorkspace::default();
    let problem = |case: &Case| case.problem(&settings).expect("complete case");
    let problems: Vec<_> = cases.iter().map(problem).collect();
    let mut solve =
        || -> Vec<Solution> { problems.iter().map(|problem| problem.solve(&mut work)).collect() };
    let answers: Vec<_> = solve().into_iter().map(answer).collect();

    let (chunk, columns) = chunk(INPUTS, &points);
    let outputs = OUTPUTS.map(|name| Output::named(name.name()).expect("known name"));
    let task = Task::new(Case::default(), settings, outputs.to_vec());
    let one_thread = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..runs.get() {
        times[0].push(seconds(|| one_thread.install(|| task.solve(&chunk, &columns))));
        times[1].push(seconds(&mut solve));
    }
    let [batch, single] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let json = serde_json::json!({
        "points": points, "answers": answers, "batch": batch, "single": single,
        "ordinary": is_ordinary,
    });
    println!("{json}");
    Ok(())
}

/// Returns the outputs of a solution, or `None` if the model has no solution.
fn answer(solution: Solution) -> Option<Vec<f64>> {
    let record = Record::new(solution);
    OUTPUTS.iter().map(|name| record.number(*name)).collect()
}

fn seconds<T>(mut solve: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    black_box(solve());
    start.elapsed().as_secs_f64()
}
