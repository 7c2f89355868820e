//! Compares other solvers with the solver of this project at the same points. To run the
//! comparison, use `benches/peers/run.sh`.
#![expect(clippy::print_stdout, reason = "the program prints a table")]

mod bsm;
mod equations;
mod gauss_newton;
mod newton;
mod points;
mod report;

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::MutexGuard;
use std::time::{Duration, Instant};

use bsm_benches::{ordinary, seeded};
use bsm_case::Case;
use bsm_dyn::{Model, Solution};
use clap::Parser;
use rayon::ThreadPoolBuilder;

use crate::equations::{Answer, System};
use crate::points::{INPUTS, Point, point};
use crate::report::{Peer, Python, Reference, Report};

/// Measures the times of several solvers at random points of the rigid model, and checks that their
/// results agree
#[derive(Debug, Parser)]
struct Arguments {
    /// Number of points
    #[arg(long, default_value_t = 4096)]
    count: usize,
    /// Use the points of validation/golden/tradeoff/cases.csv instead of random points; solvers may
    /// miss roots at these points
    #[arg(long)]
    ordinary: bool,
    /// Number of runs of each solver; the median is reported
    #[arg(long, default_value = "31")]
    runs: NonZeroUsize,
    /// Write the points to this file for the Python solvers, and do nothing else
    #[arg(long)]
    write_points: Option<PathBuf>,
    /// File with the results of the Python solvers
    #[arg(long)]
    python: Option<PathBuf>,
    /// Write the results to this file
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::parse();
    let cases = if arguments.ordinary { ordinary(Model::Rigid) } else { seeded(arguments.count) };
    let points: Vec<Point> = cases.iter().map(point).collect();
    if let Some(path) = arguments.write_points {
        let runs = arguments.runs;
        let json = serde_json::json!({ "inputs": INPUTS, "runs": runs, "points": points });
        fs::write(path, json.to_string())?;
        return Ok(ExitCode::SUCCESS);
    }

    let python: Python = match &arguments.python {
        Some(path) => serde_json::from_slice(&fs::read(path)?)?,
        None => Python { missing: vec!["all Python peers".to_owned()], ..Python::default() },
    };
    let reference: Option<Vec<_>> = cases.iter().map(reference).collect();
    let reference = reference.ok_or("a point has no root")?;

    let table = bsm::Table::of(&points);
    let problems = bsm::problems(&cases);
    let one_thread = ThreadPoolBuilder::new().num_threads(1).build()?;
    let all_threads = ThreadPoolBuilder::new().build()?;
    let (batch, newton) = ("bsm batch, 1 thread", "Newton on nalgebra's LU");
    let all = format!("bsm batch, {} threads", all_threads.current_num_threads());
    let mut faer = newton::Faer::default();
    let rows = |answers: &MutexGuard<'_, bsm_batch::Answers>, row: usize| {
        Some(bsm::answer(&bsm::row(answers, row)?, &points[row]))
    };
    let mut peers: [(&str, Run); 6] = [
        (batch, Box::new(|| one_thread.install(|| timed(&points, || table.solve(), rows)))),
        (&all, Box::new(|| all_threads.install(|| timed(&points, || table.solve(), rows)))),
        (
            "bsm, point by point",
            Box::new(|| {
                let answer = |solutions: &Vec<Solution>, i: usize| {
                    Some(bsm::answer(&bsm::numbers(&solutions[i])?, &points[i]))
                };
                timed(&points, || bsm::scalar(&problems), answer)
            }),
        ),
        (newton, Box::new(|| each(&points, newton::nalgebra))),
        ("Newton on faer's LU", Box::new(|| each(&points, |point| faer.solve(point)))),
        ("Gauss-Newton of argmin", Box::new(|| each(&points, gauss_newton::argmin))),
    ];
    let peers = medians(&mut peers, arguments.runs.get());

    let report = Report::of(&peers, &reference, (batch, newton), arguments.ordinary, python);
    print!("{report}");
    if let Some(path) = arguments.out {
        fs::write(path, serde_json::to_string_pretty(&report)?)?;
    }
    Ok(if report.agrees() { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

fn reference(case: &Case) -> Option<Reference> {
    let inertia = System::new(&point(case)).weights[4].recip().min(1.0);
    Some(Reference { answer: bsm::reference(case)?, inertia })
}

type Answers = Vec<Option<Answer>>;

/// A function that solves all points and returns the elapsed time and the results.
type Run<'a> = Box<dyn FnMut() -> (Duration, Answers) + 'a>;

/// Minimum duration of a measurement. A shorter measurement would mainly measure how long a thread
/// takes to wake up.
const MIN_DURATION: Duration = Duration::from_millis(20);

/// Measures the time that `solve` takes. The time that `answer` takes to convert the results is not
/// included.
fn timed<T>(
    points: &[Point],
    mut solve: impl FnMut() -> T,
    answer: impl Fn(&T, usize) -> Option<Answer>,
) -> (Duration, Answers) {
    let (start, mut count) = (Instant::now(), 0);
    let (found, time) = loop {
        let found = black_box(solve());
        count += 1;
        let time = start.elapsed();
        if time >= MIN_DURATION {
            break (found, time / count);
        }
    };
    (time, (0..points.len()).map(|i| answer(&found, i)).collect())
}

/// Measures a solver that solves the points one by one.
fn each(points: &[Point], mut solve: impl FnMut(&Point) -> Option<Answer>) -> (Duration, Answers) {
    let all = || points.iter().map(|point| solve(black_box(point))).collect::<Answers>();
    timed(points, all, |answers, i| answers[i])
}

/// Runs all solvers alternately, so that disturbances affect all of them, and returns the median
/// times. The first run of each solver is not measured.
#[expect(clippy::cast_precision_loss, reason = "counts of points are small")]
fn medians(peers: &mut [(&str, Run)], runs: usize) -> Vec<Peer> {
    let mut answers: Vec<Answers> = peers.iter_mut().map(|(_, run)| run().1).collect();
    let mut times = vec![Vec::new(); peers.len()];
    for _ in 0..runs {
        for (i, (_, run)) in peers.iter_mut().enumerate() {
            let (time, found) = run();
            times[i].push(time);
            answers[i] = found;
        }
    }
    let peers = peers.iter().zip(times.iter_mut().zip(answers));
    peers
        .map(|((name, _), (times, answers))| {
            times.sort_unstable();
            let median = times[times.len() / 2].as_secs_f64();
            let ns_per_point = median * 1e9 / answers.len() as f64;
            Peer { name: (*name).to_owned(), ns_per_point, answers }
        })
        .collect()
}
