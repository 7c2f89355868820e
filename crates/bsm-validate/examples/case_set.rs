//! Draws the operating points of `bsm tradeoff`, `validation/golden/tradeoff/cases.csv`, and prints
//! them as CSV:
//!
//!     cargo run --release -p bsm-validate --features tools --example case_set > validation/golden/tradeoff/cases.csv
//!
//! A hundred each in rolling, partial and gross skid, of screws as in catalogues: pitch circle 8 to
//! 100 mm, 20 to 119 balls of 0.07 to 0.2 of that, turns that do not overlap, lead angle 2 to 30 deg,
//! contact angle 30 to 60 deg, conformities 0.51 to 0.56, friction 0.01 to 0.15, 10 to 30 000 rpm
//! both ways, screw or nut drive, 0.01 to 60 N normal load on each square millimetre of the ball's
//! diameter squared. The inertia ratio m r_m W^2/F_a is at most 3.

use std::error::Error;
use std::io;

use bsm_case::Case;
use bsm_dyn::{Model, ModelWorkspace, Problem, SlipRegime};
use bsm_sample::Sample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Points of each motion.
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
    let mut rng = ChaCha8Rng::seed_from_u64(2026);
    let mut work = ModelWorkspace::default();
    let mut table = csv::Writer::from_writer(io::stdout().lock());
    table.write_record(INPUTS)?;
    let mut counts = SlipRegime::ALL.map(|motion| (motion, 0));
    while counts.iter().any(|(_, count)| *count < EACH) {
        let point = draw(&mut rng);
        let mut case = Case::default();
        for (name, value) in INPUTS.iter().zip(point) {
            case.set(name, value)?;
        }
        // Turns that overlap and the like.
        if !case.warnings().is_empty() {
            continue;
        }
        let problem = case.problem(&Model::Traction.into())?;
        let Problem::Traction(traction) = &problem else { unreachable!("the model was fixed") };
        let speed = traction.at.point.drive.relative_speed();
        let (ball, radius) = (&traction.at.point.ball, traction.at.point.helix.radius);
        if ball.mass * radius * speed * speed > 3.0 * traction.at.point.load.per_ball() {
            continue;
        }
        let solution = problem.solve(&mut work);
        let regime = solution.solved().and_then(|solved| solved.skid?.regime());
        let count = counts.iter_mut().find(|(counted, _)| Some(*counted) == regime);
        if let Some((_, count)) = count.filter(|(_, count)| *count < EACH) {
            *count += 1;
            table.write_record(point.map(|value| value.to_string()))?;
        }
    }
    table.flush()?;
    Ok(())
}

fn draw(rng: &mut impl Rng) -> [f64; 11] {
    let pitch = rng.random_range(8.0..100.0);
    let ball = pitch * rng.random_range(0.07..0.2);
    let (lead, contact) = (rng.random_range(2.0..30.0), rng.random_range(30.0..60.0));
    let friction = rng.random_range(0.01..0.15);
    let (nut, screw) = (rng.random_range(0.51..0.56), rng.random_range(0.51..0.56));
    let rpm = rng.log_uniform(10.0, 30_000.0);
    let rpm = if rng.random_bool(0.5) { rpm } else { -rpm };
    let (screw_rpm, nut_rpm) = if rng.random_bool(0.5) { (rpm, 0.0) } else { (0.0, -rpm) };
    let normal = ball * ball * rng.log_uniform(0.01, 60.0);
    let balls = f64::from(rng.random_range(20..120));
    let axial = balls * normal * f64::to_radians(lead).cos() * f64::to_radians(contact).sin();
    [pitch, ball, lead, contact, friction, nut, screw, screw_rpm, nut_rpm, axial, balls].map(digits)
}

/// Four digits are enough of a random number.
fn digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
