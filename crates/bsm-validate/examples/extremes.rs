//! A seeded campaign over the ranges of the extremes: every model is asked at random points, every
//! answer is checked, and what should not be is written as a scene that reproduces it:
//!
//!     cargo run --release -p bsm-validate --example extremes -- 100000
//!     cargo run --release -p bsm-validate --example extremes -- 20000 --model elastic --seed 3
//!     bsm solve target/extremes/elastic-not_converged-NoSkidAtInertia-17.json --model elastic
//!
//! Ranges: lead angle 0.05 to 85 deg, contact angle 1 to 89 deg, friction 0 and 1e-6 to 1, 1e-3 to
//! 1e6 rpm both ways with screw, nut or both turning, 1e-6 to 1e6 N a ball, balls of 0.1 to 200 mm,
//! 0.01 to 0.45 of the pitch radius, conformities 0.501 to 0.8, Young's modulus 0.01 to 1000 GPa,
//! density 500 to 20 000 kg/m³. Speeds, loads, sizes and moduli are spread evenly over their orders of
//! magnitude. Every point depends on seed and number only, whatever the number of threads.
//!
//! The exit code is 1 if an answer is false: a panic, a converged row with a number that is not
//! finite, a residual above 1e-10, a power balance above 1e-9, or an implausible sign.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "the report of a program")]

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use bsm_case::units::{MM, RPM};
use bsm_case::{Cell, InputKey, OUTPUTS, Record, Scene};
use bsm_dyn::{Model, ModelWorkspace, Solution, Status};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Where the anomalies go.
const FOLDER: &str = "target/extremes";

/// Scenes that are written of each kind of anomaly.
const EACH: usize = 5;

/// Points that one thread takes at a time.
const STRIDE: usize = 256;

/// Largest scaled residual and power balance of an answer.
const RESIDUAL: f64 = 1e-10;
const BALANCE: f64 = 1e-9;

/// What the command line asks for.
struct Asked {
    points: usize,
    seed: u64,
    model: Option<Model>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let asked = asked(std::env::args().skip(1))?;
    fs::create_dir_all(FOLDER)?;
    // Panics are counted, their words are in the scene.
    std::panic::set_hook(Box::new(|_| {}));
    let mut sound = true;
    for model in Model::ALL.into_iter().filter(|m| asked.model.is_none_or(|one| one == *m)) {
        let begin = Instant::now();
        eprintln!("{}: {} points, seed {}", model.name(), asked.points, asked.seed);
        let tally = campaign(model, asked.points, asked.seed);
        tally.print(model, begin.elapsed());
        sound &= tally.is_sound();
        for anomalies in tally.kinds.values() {
            for (number, scene) in &anomalies.scenes {
                let (name, kind) = (model.name(), &anomalies.name);
                let file = format!("{name}-{kind}-{number}.json").replace([' ', ':', ','], "_");
                let text = serde_json::to_string_pretty(&scene.to_json())?;
                fs::write(Path::new(FOLDER).join(file), text + "\n")?;
            }
        }
    }
    eprintln!("anomalies: {FOLDER}");
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn asked(mut words: impl Iterator<Item = String>) -> Result<Asked, Box<dyn Error>> {
    let mut asked = Asked { points: 10_000, seed: 8, model: None };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
        match word.as_str() {
            "--seed" => asked.seed = value()?.parse()?,
            "--model" => {
                let name = value()?;
                asked.model = Some(Model::from_name(&name).ok_or("no such model")?);
            }
            count => asked.points = count.parse()?,
        }
    }
    Ok(asked)
}

/// Points of one kind of answer, with the first of them as scenes if it is an anomaly.
#[derive(Default)]
struct Kind {
    name: String,
    count: usize,
    scenes: Vec<(usize, Scene)>,
}

/// What came out.
#[derive(Default)]
struct Tally {
    points: usize,
    kinds: BTreeMap<(u8, String), Kind>,
    residual: (f64, usize),
    balance: (f64, usize),
    slowest: (Duration, usize),
}

/// Order of an answer in the table, by how bad it is.
const CONVERGED: u8 = 0;
const NO_SOLUTION: u8 = 1;
const INVALID: u8 = 2;
const NOT_CONVERGED: u8 = 3;
const FALSE: u8 = 4;

impl Tally {
    fn add(&mut self, number: usize, scene: &Scene, answer: &Answer) {
        self.points += 1;
        let kind = self.kinds.entry((answer.order, answer.kind.clone())).or_default();
        kind.name.clone_from(&answer.kind);
        kind.count += 1;
        if answer.order >= NOT_CONVERGED && kind.scenes.len() < EACH {
            let description = Some(format!("extremes, point {number}: {}", answer.words));
            kind.scenes.push((number, Scene { description, ..scene.clone() }));
        }
        self.worst((answer.residual, number), (answer.balance, number), (answer.time, number));
    }

    fn worst(&mut self, residual: (f64, usize), balance: (f64, usize), slow: (Duration, usize)) {
        if residual.0 > self.residual.0 {
            self.residual = residual;
        }
        if balance.0 > self.balance.0 {
            self.balance = balance;
        }
        if slow.0 > self.slowest.0 {
            self.slowest = slow;
        }
    }

    /// Both together; `self` has the earlier points.
    fn and(mut self, other: Self) -> Self {
        self.points += other.points;
        for (place, kind) in other.kinds {
            let mine = self.kinds.entry(place).or_default();
            (mine.name, mine.count) = (kind.name, mine.count + kind.count);
            mine.scenes.extend(kind.scenes);
            mine.scenes.truncate(EACH);
        }
        self.worst(other.residual, other.balance, other.slowest);
        self
    }

    fn is_sound(&self) -> bool {
        self.kinds.keys().all(|(order, _)| *order < FALSE)
    }

    fn print(&self, model: Model, time: Duration) {
        println!("\n{}: {} points, {:.1} s", model.name(), self.points, time.as_secs_f64());
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        for kind in self.kinds.values() {
            let share = 100.0 * kind.count as f64 / self.points as f64;
            println!("  {:>10} {share:9.4} %  {}", kind.count, kind.name);
        }
        let ((residual, r), (balance, b), (slowest, s)) =
            (self.residual, self.balance, self.slowest);
        println!("  worst residual {residual:.1e} (point {r}), power balance {balance:.1e} ({b})");
        println!("  slowest point {:.3} ms ({s})", 1e3 * slowest.as_secs_f64());
    }
}

/// An answer and what is wrong with it.
struct Answer {
    order: u8,
    kind: String,
    words: String,
    residual: f64,
    balance: f64,
    time: Duration,
}

fn campaign(model: Model, points: usize, seed: u64) -> Tally {
    let strides: Vec<_> = (0..points).step_by(STRIDE).collect();
    strides
        .into_par_iter()
        .map_init(ModelWorkspace::default, |work, first| {
            let mut tally = Tally::default();
            for number in first..points.min(first + STRIDE) {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(number as u64);
                let scene = draw(&mut rng, model);
                tally.add(number, &scene, &ask(&scene, model, work));
            }
            tally
        })
        .reduce(Tally::default, Tally::and)
}

fn ask(scene: &Scene, model: Model, work: &mut ModelWorkspace) -> Answer {
    let mut answer = Answer {
        order: INVALID,
        kind: String::new(),
        words: String::new(),
        residual: 0.0,
        balance: 0.0,
        time: Duration::ZERO,
    };
    let problem = match scene.problem(&model.into()) {
        Ok(problem) => problem,
        Err(error) => {
            answer.kind = format!("invalid_input: {error}");
            return answer;
        }
    };
    let begin = Instant::now();
    let solved = catch_unwind(AssertUnwindSafe(|| problem.solve(work)));
    answer.time = begin.elapsed();
    let Ok(solution) = solved else {
        *work = ModelWorkspace::default();
        (answer.order, answer.kind) = (FALSE, "panic".to_owned());
        return answer;
    };
    let reason = cause(&solution);
    let record = Record::new(solution);
    let status = record.status_name();
    record.message().unwrap_or_default().clone_into(&mut answer.words);
    answer.order = match record.status() {
        Status::Converged => CONVERGED,
        Status::NoSolution => NO_SOLUTION,
        Status::InvalidInput => INVALID,
        Status::NotConverged => NOT_CONVERGED,
    };
    if record.status() != Status::Converged {
        answer.kind = format!("{status} {reason}");
        if answer.order == NOT_CONVERGED {
            answer.kind += inertia(scene);
        }
        return answer;
    }
    answer.kind = format!("{status} {}", record.regime().unwrap_or_default());
    answer.residual = record.number("residual_norm").unwrap_or(0.0);
    answer.balance = record.number("power_balance").unwrap_or(0.0).abs();
    if let Some(wrong) = wrong(&record, scene, &answer) {
        (answer.order, answer.kind) = (FALSE, format!("false {wrong}"));
    }
    answer
}

/// Name of the reason, with the way the iteration ended.
fn cause(solution: &Solution) -> String {
    let text = solution.reason.as_ref().map(|reason| format!("{reason:?}")).unwrap_or_default();
    let name: String = text.chars().take_while(char::is_ascii_alphanumeric).collect();
    match &solution.reason {
        Some(bsm_dyn::Reason::Newton { status, .. }) => format!("{name} {status:?}"),
        _ => name,
    }
}

/// How large the inertia forces `$m r_m W^2$` are against the load.
fn inertia(scene: &Scene) -> &'static str {
    let get = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
    let ball = 0.5 * MM * get(InputKey::ball_diameter_mm);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * ball.powi(3) * get(InputKey::density_kg_m3);
    let pitch = 0.5 * MM * get(InputKey::pitch_circle_diameter_mm);
    let speed = RPM * (get(InputKey::screw_speed_rpm) - get(InputKey::nut_speed_rpm));
    match mass * pitch * speed * speed / get(InputKey::axial_load_N) {
        mu if mu < 1e-6 => ", inertia below 1e-6",
        mu if mu < 1e-2 => ", inertia 1e-6 to 0.01",
        mu if mu < 3.0 => ", inertia 0.01 to 3",
        _ => ", inertia above 3",
    }
}

/// What no converged answer may be.
fn wrong(record: &Record, scene: &Scene, answer: &Answer) -> Option<String> {
    for output in OUTPUTS {
        if let Some(Cell::Number(x)) = record.cell(output)
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
    for name in ["nut_normal_load_N", "screw_normal_load_N", "minor_normal_load_N"] {
        // No contact pulls.
        if record.number(name).is_some_and(|load| load <= 0.0) {
            return Some(format!("{name} not positive"));
        }
    }
    for name in ["nut_contact_angle_deg", "screw_contact_angle_deg"] {
        if record.number(name).is_some_and(|angle| !(0.0..=90.0).contains(&angle)) {
            return Some(format!("{name} beyond 0 to 90"));
        }
    }
    // Friction takes power; rounding of the powers may hide that little.
    let taken = record.number("dissipated_power_W").zip(record.number("input_power_W"));
    if taken.is_some_and(|(lost, input)| lost < -1e-12 * input.abs()) {
        return Some("dissipated power negative".to_owned());
    }
    let efficiency = record.number("efficiency");
    let most = if scene.friction_coefficient == Some(0.0) { 1.0 } else { 1.0 + 1e-12 };
    efficiency.filter(|eta| *eta > most).map(|_| "efficiency above one".to_owned())
}

/// A point of the ranges.
fn draw(rng: &mut impl Rng, model: Model) -> Scene {
    let mut log = |low: f64, high: f64| {
        let x = (low.ln() + rng.random::<f64>() * (high / low).ln()).exp();
        format!("{x:.6e}").parse().unwrap_or(x)
    };
    let (ball, ratio) = (log(0.1, 200.0), log(0.01, 0.45));
    let (load, speed, other) = (log(1e-6, 1e6), log(1e-3, 1e6), log(1e-3, 1e6));
    let friction = log(1e-6, 1.0);
    let (modulus, ball_modulus, density) = (log(1e-2, 1e3), log(1e-2, 1e3), log(500.0, 2e4));
    let (nut, screw) = (0.5 + log(1e-3, 0.3), 0.5 + log(1e-3, 0.3));
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let (speed, other) = (flip(speed), flip(other));
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        // Quasi-static covers one of both.
        _ if model == Model::QuasiStatic => (speed, 0.0),
        _ => (speed, other),
    };
    // Models in whose balance friction takes part refuse none.
    let needs = matches!(model, Model::Rigid | Model::Elastic | Model::Traction);
    let friction = if !needs && rng.random_ratio(1, 50) { 0.0 } else { friction };
    Scene {
        ball_diameter_mm: Some(ball),
        pitch_circle_diameter_mm: Some(ball / ratio),
        lead_angle_deg: Some(rng.random_range(0.05..85.0)),
        contact_angle_deg: Some(rng.random_range(1.0..89.0)),
        nut_conformity: Some(nut),
        screw_conformity: Some(screw),
        friction_coefficient: Some(friction),
        density_kg_m3: Some(density),
        youngs_modulus_GPa: Some(modulus),
        ball_youngs_modulus_GPa: Some(ball_modulus),
        screw_speed_rpm: Some(screw_speed),
        nut_speed_rpm: Some(nut_speed),
        axial_load_N: Some(load),
        loaded_balls: Some(1.0),
        ..Scene::default()
    }
}
