//! Operating points for the benchmarks: Lin's case from the repository, random cases, and tables of
//! points.

use bsm_batch::{Chunk, Columns, CsvSource, Source, TableFormat};
use bsm_case::{Case, InputKey};
use bsm_dyn::{Model, Problem};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns Lin's published case with added conformities, which the elastic models require.
///
/// # Panics
///
/// Panics if the case in the repository is invalid.
pub fn lin() -> Case {
    let json = include_bytes!("../../validation/published/lin1994/case.json");
    Case {
        nut_conformity: Some(0.53),
        screw_conformity: Some(0.53),
        ..Case::from_json(json).expect("committed case")
    }
}

/// Returns the problem that a model solves for Lin's case.
///
/// # Panics
///
/// Panics if the case in the repository is invalid.
pub fn lin_problem(model: Model) -> Problem {
    lin().problem(&model.into()).expect("committed case")
}

/// Returns `count` random cases for which the rigid model has a solution. Their inputs are in the
/// same ranges as in the test campaign of the rigid model.
///
/// The lead angle is 8 to 45 deg, the contact angle 30 to 70 deg, the friction coefficient 0.01 to
/// 0.1, the ratio of ball radius to pitch radius 0.07 to 0.2, the speed 50 to 6000 rpm in both
/// directions with screw drive or nut drive, and the axial load 20 to 3000 N per ball.
///
/// # Panics
///
/// Panics if a case is incomplete.
pub fn seeded(count: usize) -> Vec<Case> {
    let mut rng = ChaCha8Rng::seed_from_u64(1994);
    let mut work = bsm_dyn::ModelWorkspace::default();
    let mut cases = Vec::new();
    while cases.len() < count {
        let mut case = lin();
        let rpm = rng.random_range(50.0..6000.0) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let (screw, nut) = if rng.random_bool(0.5) { (rpm, 0.0) } else { (0.0, rpm) };
        for (name, value) in [
            ("lead_angle_deg", rng.random_range(8.0..45.0)),
            ("contact_angle_deg", rng.random_range(30.0..70.0)),
            ("friction_coefficient", rng.random_range(0.01..0.1)),
            ("ball_diameter_mm", 48.6 * rng.random_range(0.07..0.2)),
            ("screw_speed_rpm", screw),
            ("nut_speed_rpm", nut),
            ("axial_load_N", rng.random_range(20.0..3000.0)),
        ] {
            case.set(name, value).expect("known name");
        }
        let problem = case.problem(&Model::Rigid.into()).expect("complete case");
        if problem.solve(&mut work).steady_state().is_some() {
            cases.push(case);
        }
    }
    cases
}

/// Returns those points of the table `validation/golden/tradeoff/cases.csv` for which the model has
/// a solution. The table contains ordinary operating points.
///
/// # Panics
///
/// Panics if the table in the repository is invalid.
pub fn ordinary(model: Model) -> Vec<Case> {
    let table = include_bytes!("../../validation/golden/tradeoff/cases.csv");
    let mut source =
        CsvSource::new(&table[..], &[], &TableFormat::default()).expect("committed table");
    let columns = source.columns().clone();
    let chunk = source.next(usize::MAX).expect("committed table").expect("rows");
    let mut work = bsm_dyn::ModelWorkspace::default();
    let has_solution = |case: &Case| {
        let problem = case.problem(&model.into()).expect("complete case");
        problem.solve(&mut work).steady_state().is_some()
    };
    let case = |row| chunk.case(&columns, &Case::default(), row).expect("complete case");
    (0..chunk.len).map(case).filter(has_solution).collect()
}

/// Returns the values of the named inputs in a case.
///
/// # Panics
///
/// Panics if an input is unknown or has no value.
pub fn values<const N: usize>(case: &Case, inputs: &[&str; N]) -> [f64; N] {
    let key = |name| InputKey::named(name).expect("known name");
    inputs.map(|name| case.value_or_default(key(name)).expect("complete case"))
}

/// Converts points to a table in memory.
///
/// # Panics
///
/// Panics if an input is unknown.
pub fn chunk<const N: usize>(inputs: [&str; N], points: &[[f64; N]]) -> (Chunk, Columns) {
    let columns = Columns::sort(inputs, &[], &TableFormat::default()).expect("known names");
    let rows = points.iter().map(|point| point.iter().copied().map(Some));
    (Chunk::of_rows(&columns, rows), columns)
}
