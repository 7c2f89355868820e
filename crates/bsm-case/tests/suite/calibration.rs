//! Tests of fits to measured points: standard deviations, and detection of systematic residuals.

use std::fmt::Write;

use bsm_case::{
    Calibration, CalibrationReport, Case, FittedInput, MeasurementError, Record, Settings,
    TableFormat, output,
};
use bsm_dyn::{Model, ModelWorkspace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const DRY: &[u8] = include_bytes!("../../../../examples/feed_drive.json");

/// True values of the fitted inputs.
const TRUTH: [(&str, f64); 2] = [("friction_coefficient", 0.06), ("contact_angle_deg", 45.0)];

/// Number of random data sets of each kind.
const SETS: usize = 400;

/// 97.5 % quantile of Student's t distribution with 10 degrees of freedom, which is 12 points minus
/// two inputs.
const T_10: f64 = 2.228;

fn settings() -> Settings {
    Settings::from(Model::RacewayControl)
}

/// Returns the loads \[N\] and the noise-free torques \[N·m\] of 12 points.
fn exact_points() -> Vec<(f64, f64)> {
    let mut case = Case::from_json(DRY).expect("an example");
    let mut work = ModelWorkspace::default();
    let mut torque = |load: f64| {
        case.set("axial_load_N", load).expect("an input");
        let problem = case.problem(&settings()).expect("a complete case");
        Record::new(problem.solve(&mut work)).number(output!(ball_torque_Nm)).expect("a torque")
    };
    (1..=12).map(|i| 1000.0 * f64::from(i)).map(|load| (load, torque(load))).collect()
}

fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

fn fitted_input(text: &str) -> FittedInput {
    FittedInput::parse(text).expect("an input")
}

/// Fits the inputs to points that consist of load, torque and, optionally, the error of the torque.
fn fit_to_points(
    points: &[(f64, f64, Option<f64>)],
    errors: Option<MeasurementError>,
) -> (Calibration, CalibrationReport) {
    let of_column = if points[0].2.is_some() { ",ball_torque_Nm_error" } else { "" };
    let mut table = format!("axial_load_N,ball_torque_Nm{of_column}\n");
    for (load, torque, error) in points {
        let error = error.map_or_else(String::new, |error| format!(",{error}"));
        writeln!(table, "{load},{torque}{error}").expect("text");
    }
    let (base, format) = (Case::from_json(DRY).expect("an example"), TableFormat::default());
    let inputs = ["friction_coefficient=0.01:0.3", "contact_angle_deg=20:80"].map(fitted_input);
    let fit = Calibration::new(&base, &inputs, "ball_torque_Nm", errors, table.as_bytes(), &format)
        .expect("a table");
    let report = fit.run(&base, &settings()).expect("complete").expect("a fit");
    (fit, report)
}

/// Fits random data sets and returns two results: for each input, the fraction of data sets in
/// which the true value is outside its 95 % interval; and the fraction of data sets whose residuals
/// are reported as systematic.
fn miss_and_alarm_rates(
    noise: impl Fn(f64) -> f64,
    errors: Option<MeasurementError>,
    with_column: bool,
) -> ([f64; 2], f64) {
    let (exact, mut random) = (exact_points(), ChaCha8Rng::seed_from_u64(4));
    let (mut beyond, mut alarms) = ([0.0; 2], 0.0);
    let each = 1.0 / 400.0;
    for _ in 0..SETS {
        let mut point = |&(load, torque): &(f64, f64)| {
            let error = noise(torque);
            // The factor of 7 shows that the fit does not depend on the common scale of the errors.
            (load, torque + error * draw_normal(&mut random), with_column.then_some(7.0 * error))
        };
        let points: Vec<_> = exact.iter().map(&mut point).collect();
        let (fit, report) = fit_to_points(&points, errors);
        for (i, (_, value, deviation)) in fit.rows(&report).into_iter().enumerate() {
            let t = (value - TRUTH[i].1) / deviation.expect("more points than inputs");
            beyond[i] += if t.abs() > T_10 { each } else { 0.0 };
        }
        alarms += if fit.systematic(&report).is_some() { each } else { 0.0 };
    }
    (beyond, alarms)
}

/// Tolerance for a fraction of 5 % of [`SETS`] random data sets. It is four times the standard
/// deviation of this fraction, which is sqrt(0.05 · 0.95/400) = 1.1 %.
const SCATTER: f64 = 0.044;

/// Returns true if both fractions are within [`SCATTER`] of 5 %.
fn are_fractions_close_to_five_percent(beyond: [f64; 2]) -> bool {
    beyond.iter().all(|share| (share - 0.05).abs() < SCATTER)
}

#[test]
fn absolute_weights_give_correct_standard_deviations_for_equal_errors() {
    let (beyond, alarms) = miss_and_alarm_rates(|_| 1e-3, Some(MeasurementError::Absolute), false);
    assert!(are_fractions_close_to_five_percent(beyond), "{beyond:?}");
    // The fraction of false alarms is at most the significance level of 5 %, because the number of
    // sign runs is discrete, and because the residuals of a fit change sign more often than
    // independent random numbers.
    assert!(alarms < 0.05 + SCATTER, "{alarms}");
}

#[test]
fn relative_weights_give_correct_standard_deviations_for_proportional_errors() {
    let (beyond, alarms) = miss_and_alarm_rates(|torque| 2e-4 * torque, None, false);
    assert!(are_fractions_close_to_five_percent(beyond), "{beyond:?}");
    assert!(alarms < 0.05 + SCATTER, "{alarms}");
}

/// The errors are neither constant nor proportional to the torque. The error column states the
/// errors up to a common factor.
#[test]
fn error_column_gives_correct_standard_deviations() {
    let (beyond, alarms) = miss_and_alarm_rates(|torque| 1e-5 * torque.powi(2), None, true);
    assert!(are_fractions_close_to_five_percent(beyond), "{beyond:?}");
    assert!(alarms < 0.05 + SCATTER, "{alarms}");
}

/// The measured torque contains a term that is proportional to the cube of the load and is missing
/// in the fitted model. Therefore, the residuals depend on the load.
#[test]
fn warns_about_residuals_that_depend_on_an_input() {
    let exact = exact_points();
    let bent = |&(load, torque): &(f64, f64)| (load, torque + 0.02 * (load / 12e3).powi(3), None);
    let points: Vec<_> = exact.iter().map(bent).collect();
    let (fit, report) = fit_to_points(&points, Some(MeasurementError::Absolute));
    let (key, runs) = fit.systematic(&report).expect("systematic residuals");
    assert_eq!(key.name(), "axial_load_N");
    assert!(runs.probability < 0.05, "{runs:?}");
    let case = Case::from_json(DRY).expect("an example");
    let warnings = fit.answer(&case, &report).warnings;
    assert!(
        warnings.iter().any(|text| text.contains("depend systematically on axial_load_N")),
        "{warnings:?}"
    );
}

#[test]
fn invalid_measurement_errors_are_rejected() {
    let why = |errors: Option<MeasurementError>, table: &str| {
        let case = Case::from_json(DRY).expect("an example");
        let inputs = [fitted_input("friction_coefficient")];
        let (table, format) = (table.as_bytes(), TableFormat::default());
        let fit = Calibration::new(&case, &inputs, "screw_torque_Nm", errors, table, &format);
        fit.expect_err("a fault").to_string()
    };
    let zero = "axial_load_N,screw_torque_Nm\n100,0\n";
    assert!(why(None, zero).contains("cannot be relative"), "{}", why(None, zero));
    let both = "screw_torque_Nm,screw_torque_Nm_error\n26,0.1\n";
    let said = why(Some(MeasurementError::Relative), both);
    assert!(said.contains("screw_torque_Nm_error"), "{said}");
    let negative = why(None, "screw_torque_Nm,screw_torque_Nm_error\n26,-1\n");
    assert!(negative.contains("-1") && negative.contains("positive"), "{negative}");
    let missing = why(None, "screw_torque_Nm,screw_torque_Nm_error\n26,\n");
    assert!(missing.contains("has no screw_torque_Nm_error"), "{missing}");
    assert!(MeasurementError::named("equal").is_err());
}

/// The unit of the errors is taken from the name of the error column.
#[test]
fn error_column_may_have_another_unit() {
    let case = Case::from_json(DRY).expect("an example");
    let fit = |table: &str| {
        let inputs = [fitted_input("friction_coefficient")];
        let (table, format) = (table.as_bytes(), TableFormat::default());
        let fit = Calibration::new(&case, &inputs, "ball_torque_Nm", None, table, &format);
        let fit = fit.expect("a table");
        fit.run(&case, &settings()).expect("complete").expect("a fit").weighted_scatter
    };
    let rows = ["8000,26,0.5", "4000,13.5,0.2"];
    let meters = rows.join("\n");
    let centimeters = ["8000,26,50", "4000,13.5,20"].join("\n");
    let [a, b] = [
        fit(&format!("axial_load_N,ball_torque_Nm,ball_torque_Nm_error\n{meters}\n")),
        fit(&format!("axial_load_N,ball_torque_Nm,ball_torque_Ncm_error\n{centimeters}\n")),
    ];
    // The tolerance allows for the rounding error of the unit conversion.
    assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
}
