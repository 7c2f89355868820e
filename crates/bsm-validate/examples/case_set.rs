//! Draws the operating points of `bsm tradeoff`, `validation/golden/tradeoff/cases.csv`, and prints
//! them as CSV:
//!
//!     cargo run --release -p bsm-validate --features tools --example case_set > validation/golden/tradeoff/cases.csv
//!
//! There are a hundred points each in rolling, partial skid and gross skid, for screws as in
//! catalogs: pitch circle 8 to 100 mm, 20 to 119 balls with a diameter of 0.07 to 0.2 of the pitch
//! circle, turns that do not overlap, lead angle 2 to 30 deg, contact angle 30 to 60 deg,
//! conformities 0.51 to 0.56, friction 0.01 to 0.15, 10 to 30 000 rpm in both directions, screw or
//! nut drive, and a normal load divided by the square of the ball diameter of 0.01 to 60 N/mm². The
//! inertia ratio m r_m W^2/F_a is at most 3.
//!
//! If a number and, optionally, a seed are given, the program draws this number of points in any
//! motion, for screws as used in practice: largest pressure 0.2 to 4 GPa at the nut, lead angle 1
//! to 40 deg, 10 to 10 000 rpm, inertia ratio at most 1.
//!
//!     cargo run --release -p bsm-validate --features tools --example case_set -- 3000 > screws.csv
//!     bsm tradeoff --points screws.csv

use std::error::Error;
use std::io;

use bsm_case::{Case, CaseError};
use bsm_dyn::{Model, ModelWorkspace, Problem, model::Traction, solution::SlipRegime};
use bsm_sample::Sample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of points of each motion.
const EACH: usize = 100;

const INPUTS: [&str; 11] = [
    "pitch_circle_diameter_mm",
    "ball_diameter_mm",
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "nut_conformity",
    "screw_conformity",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
    "loaded_balls",
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut numbers = std::env::args().skip(1);
    let used = numbers.next().map(|number| number.parse::<usize>()).transpose()?;
    let seed = numbers.next().map_or(Ok(2026), |seed| seed.parse())?;
    let (all, each) = used.map_or((3 * EACH, EACH), |number| (number, number));
    let most_inertia = if used.is_some() { 1.0 } else { 3.0 };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut work = ModelWorkspace::default();
    let mut table = csv::Writer::from_writer(io::stdout().lock());
    table.write_record(INPUTS)?;
    let mut counts = SlipRegime::ALL.map(|motion| (motion, 0));
    while counts.iter().map(|(_, count)| count).sum::<usize>() < all {
        let mut point = draw(&mut rng, used.is_some());
        if used.is_some() {
            let screw = traction(&case(&point)?)?.at;
            let [lead, contact] = [point[2], point[3]].map(f64::to_radians);
            let normal = screw.point.load.per_ball() / (lead.cos() * contact.sin());
            let Ok([nut, _]) = screw.hertz() else { continue };
            // The pressure grows with the cube root of the load.
            let rise = rng.log_uniform(0.2e9, 4e9) / nut.max_pressure(normal);
            point[9] = digits(point[9] * rise.powi(3));
        }
        let case = case(&point)?;
        // Rejects cases with warnings, for example about overlapping turns.
        if !case.warnings().is_empty() {
            continue;
        }
        let traction = traction(&case)?;
        let speed = traction.at.point.drive.relative_speed();
        let (ball, radius) = (&traction.at.point.ball, traction.at.point.helix.radius);
        let load = traction.at.point.load.per_ball();
        if ball.mass * radius * speed * speed > most_inertia * load {
            continue;
        }
        let solution = Problem::Traction(traction).solve(&mut work);
        let regime = solution.solved().and_then(|solved| solved.skid?.regime());
        let count = counts.iter_mut().find(|(counted, _)| Some(*counted) == regime);
        if let Some((_, count)) = count.filter(|(_, count)| *count < each) {
            *count += 1;
            table.write_record(point.map(|value| value.to_string()))?;
        }
    }
    table.flush()?;
    Ok(())
}

fn case(point: &[f64; 11]) -> Result<Case, CaseError> {
    let mut case = Case::default();
    for (name, value) in INPUTS.iter().zip(point) {
        case.set(name, *value)?;
    }
    Ok(case)
}

fn traction(case: &Case) -> Result<Traction, CaseError> {
    match case.problem(&Model::Traction.into())? {
        Problem::Traction(traction) => Ok(traction),
        _ => unreachable!("the model was fixed"),
    }
}

/// * `used`: true for screws as used in practice, with any load.
fn draw(rng: &mut impl Rng, used: bool) -> [f64; 11] {
    let pitch = rng.random_range(8.0..100.0);
    let ball = pitch * rng.random_range(0.07..0.2);
    let (leads, fastest) = if used { (1.0..40.0, 1e4) } else { (2.0..30.0, 3e4) };
    let (lead, contact) = (rng.random_range(leads), rng.random_range(30.0..60.0));
    let friction = rng.random_range(0.01..0.15);
    let (nut, screw) = (rng.random_range(0.51..0.56), rng.random_range(0.51..0.56));
    let rpm = rng.log_uniform(10.0, fastest);
    let rpm = if rng.random_bool(0.5) { rpm } else { -rpm };
    let (screw_rpm, nut_rpm) = if rng.random_bool(0.5) { (rpm, 0.0) } else { (0.0, -rpm) };
    let normal = ball * ball * rng.log_uniform(0.01, 60.0);
    let balls = f64::from(rng.random_range(20..120));
    let axial = balls * normal * f64::to_radians(lead).cos() * f64::to_radians(contact).sin();
    [pitch, ball, lead, contact, friction, nut, screw, screw_rpm, nut_rpm, axial, balls].map(digits)
}

/// Rounds a random number to four digits, which are sufficient.
fn digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
