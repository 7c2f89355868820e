//! Models by lanes against the models themselves, over seeded points.

use bsm_batch::{Answers, Cell, Chunk, Column, Columns, solve};
use bsm_case::{Output, Record, Scene, Settings};
use bsm_dyn::{Model, ModelWorkspace, Status};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const INPUTS: [&str; 9] = [
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "ball_diameter_mm",
    "pitch_circle_diameter_mm",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
    "loaded_balls",
];

/// Outputs that tell of the way to a root, not of the root.
const OF_THE_WAY: [&str; 3] = ["iterations", "residual_norm", "power_balance"];

/// Points of practice and somewhat beyond: screw drive, nut drive and both, both ways.
fn points(count: usize, dual: bool) -> (Chunk, Columns) {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut inputs = vec![Column::default(); INPUTS.len()];
    for _ in 0..count {
        let mut rpm = || {
            let size = 10.0_f64.powf(rng.random_range(0.0..4.5));
            if rng.random_bool(0.5) { size } else { -size }
        };
        let speeds = (rpm(), rpm());
        let (screw, nut) = match rng.random_range(0..if dual { 3 } else { 2 }) {
            0 => (speeds.0, 0.0),
            1 => (0.0, speeds.1),
            _ => speeds,
        };
        let pitch = rng.random_range(8.0..100.0);
        let row = [
            rng.random_range(1.0..45.0),
            rng.random_range(20.0..75.0),
            10.0_f64.powf(rng.random_range(-3.0..-0.7)),
            pitch * rng.random_range(0.05..0.25),
            pitch,
            screw,
            nut,
            10.0_f64.powf(rng.random_range(1.0..5.0)),
            rng.random_range(1.0..200.0),
        ];
        for (column, value) in inputs.iter_mut().zip(row) {
            column.push(Cell::Number(value));
        }
    }
    let columns = Columns::sort(INPUTS, &[]).expect("known names");
    (Chunk { first: 1, len: count, inputs, kept: Vec::new() }, columns)
}

fn record(chunk: &Chunk, base: &Scene, settings: &Settings, row: usize) -> Record {
    let mut scene = base.clone();
    for (name, column) in INPUTS.iter().zip(&chunk.inputs) {
        scene.set(name, column.values()[row]).expect("known name");
    }
    match scene.problem(settings) {
        Ok(problem) => Record::new(problem.solve(&mut ModelWorkspace::default())),
        Err(error) => Record::invalid(settings.model, &error),
    }
}

fn all() -> Vec<&'static Output> {
    Answers::select(None).expect("all outputs")
}

/// Compares every output of every point; returns the largest difference, over the size of the
/// quantity or a tenth of the unit that its kind has.
fn compare(model: Model, count: usize, dual: bool) -> f64 {
    let settings = Settings::from(model);
    let (base, (chunk, columns), outputs) = (Scene::default(), points(count, dual), all());
    let answers = solve(&chunk, &columns, &base, &settings, &outputs);
    let (mut worst, mut solved) = (0.0, 0);
    for row in 0..count {
        let expected = record(&chunk, &base, &settings, row);
        let verdict = &answers.verdicts[row];
        assert_eq!(verdict.status, expected.status(), "row {row}");
        solved += usize::from(verdict.status == Status::Converged);
        for (output, column) in outputs.iter().zip(&answers.columns) {
            if OF_THE_WAY.contains(&output.name) {
                continue;
            }
            let known = expected.number(output.name);
            let found = (!column[row].is_nan()).then_some(column[row]);
            if output.json_type != "number" {
                continue;
            }
            assert_eq!(found.is_some(), known.is_some(), "row {row}, {}", output.name);
            let (Some(found), Some(known)) = (found, known) else { continue };
            let difference = (found - known).abs() / known.abs();
            if difference > 1e-8 {
                println!("row {row} {}: {found} {known} {difference:.1e}", output.name);
            }
            worst = f64::max(worst, difference);
        }
    }
    assert!(solved > count / 4, "{solved}");
    worst
}

#[test]
fn closed_form() {
    let worst = compare(Model::ClosedForm, 4000, true);
    assert!(worst <= 1e-10, "{worst:.1e}");
}

#[test]
fn quasi_static() {
    let worst = compare(Model::QuasiStatic, 4000, true);
    assert!(worst <= 1e-10, "{worst:.1e}");
}

#[test]
fn rigid() {
    let worst = compare(Model::Rigid, 4000, true);
    assert!(worst <= 1e-10, "{worst:.1e}");
}
