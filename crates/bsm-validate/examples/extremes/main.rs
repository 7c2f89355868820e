//! Runs a test campaign with extreme random points and a fixed seed. All points are solved with
//! every model, every result is checked, and each anomaly is written as a case file that reproduces
//! it:
//!
//!     cargo run --release -p bsm-validate --features tools --example extremes -- 100000
//!     cargo run --release -p bsm-validate --features tools --example extremes -- 20000 --model elastic --seed 3
//!     bsm solve target/extremes/elastic-not_converged-NoSkidAtInertia-17.json --model elastic
//!
//! Ranges: lead angle 0.05 to 85 deg, contact angle 1 to 89 deg, friction coefficient 0 and 1e-6 to
//! 1, speed 1e-3 to 1e6 rpm in both directions with screw, nut or both turning, load 1e-6 to 1e6 N
//! per ball, ball diameter 0.1 to 200 mm and 0.01 to 0.45 of the pitch circle diameter, conformity
//! 0.501 to 0.8, Young's modulus 0.01 to 1000 GPa, density 500 to 20 000 kg/m³. Speeds, loads,
//! sizes and moduli have uniformly distributed logarithms. Every point depends only on the seed and
//! its number, not on the number of threads.
//!
//! With `--edges`, one input of each point is close to a value at which the behavior changes. The
//! relative distance from this value is 1e-12 to 1e-1. Either both speeds are almost equal, or
//! friction can just hold the load.
//!
//! The exit code is 1 if a result is wrong. The following results are wrong: a panic, a converged
//! point with NaN or infinity, a residual above 1e-10, a power balance error above 1e-9, an
//! implausible sign, and a result that differs between the scalar solver and a table.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "the report of a program")]

mod answer;
mod draw;
mod tally;

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use bsm_case::ModelChoice;
use bsm_dyn::ModelWorkspace;
use rayon::prelude::*;

use answer::{classify, in_batch, with_sensitivities};
use tally::Tally;

/// Folder to which the case files of anomalies are written.
const FOLDER: &str = "target/extremes";

/// Number of points that a thread fetches at once.
const STRIDE: usize = 256;

/// Sensitivities are calculated for every `SENSITIVE`th point only, because they require several
/// solutions per point.
const SENSITIVE: usize = 8;

/// Parsed command-line arguments.
struct Arguments {
    points: usize,
    seed: u64,
    model: Option<ModelChoice>,
    /// If true, the points are close to values at which the behavior changes.
    edges: bool,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let Arguments { points, seed, model, edges } = parse_arguments(std::env::args().skip(1))?;
    fs::create_dir_all(FOLDER)?;
    // Panics must not print anything. They are counted as outcomes, and their cases are stored.
    std::panic::set_hook(Box::new(|_| {}));
    let models = match model {
        Some(model) => vec![model],
        None => ModelChoice::names().map(ModelChoice::from_name).collect::<Result<_, _>>()?,
    };
    let mut sound = true;
    for model in models {
        eprintln!("{}: {points} points, seed {seed}", model.name());
        let begin = Instant::now();
        let tally = campaign(model, points, seed, edges);
        println!(
            "\n## {}, seed {seed}, {:.1} s\n\n{tally}",
            model.name(),
            begin.elapsed().as_secs_f64()
        );
        sound &= tally.is_sound();
        tally.write_anomalies(Path::new(FOLDER), model)?;
    }
    eprintln!("anomalies: {FOLDER}");
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn parse_arguments(mut words: impl Iterator<Item = String>) -> Result<Arguments, Box<dyn Error>> {
    let mut asked = Arguments { points: 10_000, seed: 8, model: None, edges: false };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
        match word.as_str() {
            "--seed" => asked.seed = value()?.parse()?,
            "--edges" => asked.edges = true,
            "--model" => asked.model = Some(ModelChoice::from_name(&value()?)?),
            count => {
                let wanted = "the number of points, --seed N, --model M or --edges";
                asked.points = count.parse().map_err(|_| format!("{count}: expected {wanted}"))?;
            }
        }
    }
    Ok(asked)
}

fn campaign(model: ModelChoice, points: usize, seed: u64, edges: bool) -> Tally {
    let strides: Vec<_> = (0..points).step_by(STRIDE).collect();
    strides
        .into_par_iter()
        .map_init(ModelWorkspace::default, |work, first| {
            let numbers = first..points.min(first + STRIDE);
            let cases: Vec<_> =
                numbers.clone().map(|i| draw::point(seed, i, model, edges)).collect();
            let mut answers: Vec<_> =
                cases.iter().map(|case| classify(case, model, work)).collect();
            in_batch(&cases, model, &mut answers);
            for (case, answer) in cases.iter().zip(&mut answers).step_by(SENSITIVE) {
                with_sensitivities(case, model, answer, work);
            }
            let mut tally = Tally::default();
            for ((number, case), answer) in numbers.zip(&cases).zip(&answers) {
                tally.add(number, case, answer);
            }
            tally
        })
        .reduce(Tally::default, Tally::and)
}
