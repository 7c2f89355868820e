//! Tests of derivatives with respect to the inputs, compared with finite differences of complete
//! solutions and with exact identities.

use approx::assert_relative_eq;
use bsm_case::{Case, ModelChoice, Sensitivities, Sensitivity, Settings};
use bsm_dyn::{
    Control, Model, ModelWorkspace,
    model::{Basis, Traction},
    solution::{Performance, Transmission},
};
use proptest::prelude::*;

/// Returns efficiency and torque with their derivatives, or `None` if there is no solution.
fn solve_with_derivatives(
    case: &Case,
    settings: &Settings,
) -> Option<(Performance<f64>, Vec<Sensitivity>)> {
    let inputs = Sensitivities::of(case, settings).expect("complete case");
    inputs.solve(&mut ModelWorkspace::default()).ok()
}

/// Solves the case without derivatives.
fn solve_without_derivatives(case: &Case, settings: &Settings) -> Option<Transmission> {
    let problem = case.problem(settings).expect("complete case");
    let solution = problem.solve(&mut ModelWorkspace::default());
    Some(solution.steady_state()?.transmission)
}

/// Generates random cases with random speed, load and driving side. All inputs are far from their
/// limits.
fn random_cases() -> impl Strategy<Value = Case> {
    (
        (8.0..40.0_f64, 35.0..60.0_f64, 0.02..0.1_f64, 0.07..0.2_f64),
        (0.51..0.56_f64, 0.51..0.56_f64, 1.0..3.5_f64, 50.0..2000.0_f64),
        (any::<bool>(), 0..3_u8, any::<bool>(), any::<bool>()),
    )
        .prop_map(|((lead, contact, friction, size), (f_n, f_s, log_rpm, load), choices)| {
            let (back, drive, by_lead, own_ball) = choices;
            let rpm = 10.0_f64.powf(log_rpm) * if back { -1.0 } else { 1.0 };
            let pitch = 48.6;
            let mut case = Case {
                ball_diameter_mm: Some(pitch * size),
                pitch_circle_diameter_mm: Some(pitch),
                contact_angle_deg: Some(contact),
                nut_conformity: Some(f_n),
                screw_conformity: Some(f_s),
                friction_coefficient: Some(friction),
                axial_load_N: Some(3.0 * load),
                loaded_balls: Some(3.0),
                ..Case::default()
            };
            (case.screw_speed_rpm, case.nut_speed_rpm) = match drive {
                0 => (Some(rpm), None),
                1 => (Some(0.0), Some(-rpm)),
                _ => (Some(1.3 * rpm), Some(0.3 * rpm)),
            };
            if by_lead {
                case.lead_mm = Some(std::f64::consts::PI * pitch * lead.to_radians().tan());
            } else {
                case.lead_angle_deg = Some(lead);
            }
            if own_ball {
                case.ball_youngs_modulus_GPa = Some(310.0);
                case.ball_poisson_ratio = Some(0.26);
            }
            case
        })
}

/// Removes the nut speed if the screw turns, because the `quasi-static` model does not cover drives
/// in which both parts turn.
fn with_one_turning_part(mut case: Case) -> Case {
    if case.screw_speed_rpm != Some(0.0) {
        case.nut_speed_rpm = None;
    }
    case.rolling_friction_mm = Some(0.004);
    case
}

/// Compares each derivative with a finite difference of complete solutions, calculated with a
/// relative step of `h`. After Richardson extrapolation, the remaining error is of fourth order.
/// Returns the largest error, relative to the change that a relative change of 1 in the input would
/// cause.
fn largest_derivative_error(case: &Case, settings: &Settings, h: f64) -> Option<f64> {
    let (answer, rows) = solve_with_derivatives(case, settings)?;
    let mut worst: f64 = 0.0;
    for row in &rows {
        // Model `quasi-static` depends on which part turns, but not on the speeds, so its
        // derivatives with respect to the speeds are zero.
        if settings.model == Model::QuasiStatic.into() && row.input.unit == "rpm" {
            assert_eq!((row.efficiency, row.screw_torque), (0.0, Some(0.0)));
            continue;
        }
        let speed = [case.screw_speed_rpm, case.nut_speed_rpm].into_iter().flatten();
        // Changes of either speed are scaled by the relative speed.
        let unit = if row.input.unit == "rpm" {
            speed.reduce(|screw, nut| screw - nut).expect("a speed").abs()
        } else {
            row.value
        };
        let at = |steps: f64| {
            let mut moved = case.clone();
            moved.set(row.input.name, row.value + steps * h * unit).expect("known name");
            let o = solve_without_derivatives(&moved, settings)?;
            Some((o.efficiency, o.screw_torque?))
        };
        let difference = |steps: f64| {
            let (high, low) = (at(steps)?, at(-steps)?);
            let over = 2.0 * steps * h;
            Some(((high.0 - low.0) / over, (high.1 - low.1) / over))
        };
        let (near, far) = (difference(1.0)?, difference(2.0)?);
        let richardson = |near: f64, far: f64| near + (near - far) / 3.0;
        let efficiency = richardson(near.0, far.0);
        let torque = richardson(near.1, far.1);
        let own = row.screw_torque.expect("a torque") * unit;
        let scale = answer.screw_torque.expect("a torque");
        let error = (efficiency - row.efficiency * unit).abs().max(((torque - own) / scale).abs());
        worst = worst.max(error);
    }
    Some(worst)
}

/// Returns the exponents of mass, length and time in the dimension of an input.
fn dimension_exponents(key: &str) -> [f64; 3] {
    match key {
        "ball_diameter_mm"
        | "pitch_circle_diameter_mm"
        | "lead_mm"
        | "rolling_friction_mm"
        | "axial_play_um"
        | "radial_gap_um" => [0.0, 1.0, 0.0],
        "density_kg_m3" => [1.0, -3.0, 0.0],
        "youngs_modulus_GPa" | "ball_youngs_modulus_GPa" => [1.0, -1.0, -2.0],
        "screw_speed_rpm" | "nut_speed_rpm" => [0.0, 0.0, -1.0],
        "axial_load_N" => [1.0, 1.0, -2.0],
        _ => [0.0; 3],
    }
}

/// Returns the largest violation of Euler's identity for scaling of masses, lengths and times, for
/// efficiency and torque.
fn largest_identity_violation((answer, rows): &(Performance<f64>, Vec<Sensitivity>)) -> [f64; 2] {
    let torque = answer.screw_torque.expect("a torque");
    let exponents = [1.0, 2.0, -2.0];
    (0..3).fold([0.0; 2], |[worst, worst_torque]: [f64; 2], unit| {
        let sum = |of: &dyn Fn(&Sensitivity) -> f64| -> f64 {
            rows.iter()
                .map(|row| dimension_exponents(row.input.name)[unit] * row.value * of(row))
                .sum()
        };
        let efficiency = sum(&|row| row.efficiency);
        let own = sum(&|row| row.screw_torque.expect("a torque")) / torque;
        [worst.max(efficiency.abs()), worst_torque.max((own - exponents[unit]).abs())]
    })
}

/// Returns true if Euler's identity holds apart from rounding errors of the sums and of the
/// Jacobian. In raceway control, the torque and its derivatives are calculated with different
/// quadrature rules, which causes a difference of 1e-5 of the efficiency. The efficiency can be as
/// small as one fiftieth.
fn is_homogeneous(model: ModelChoice, [efficiency, torque]: [f64; 2]) -> bool {
    let of_torque = if model == Model::RacewayControl.into() { 5e-4 } else { 1e-11 };
    efficiency <= 1e-11 && torque <= of_torque
}

/// Largest error of a finite difference, relative to the change that a relative change of 1 in the
/// input would cause. With steps of 1e-4, residuals of 1e-13 cause errors of 1e-9, which the
/// equations amplify. The fourth-order error after Richardson extrapolation is smaller.
const DIFFERENCE: f64 = 1e-7;

/// Returns the relative jump of the results between neighboring points, the step size of the finite
/// differences, and their tolerance.
/// If friction is integrated numerically, the number of nodes depends on the point. Between
/// neighboring points, and between two solutions of the same point, the integrals jump by their
/// integration error. This error is 1e-8 of the loss, or 3e-6 if the ellipses are as long as the
/// ball. The `traction` model keeps its nodes fixed in the last iterations. Raceway control needs
/// larger steps, for which the fourth-order error is 1e-5.
fn tolerances(model: ModelChoice) -> (f64, f64, f64) {
    match model {
        ModelChoice::Fixed(Model::RacewayControl) => (3e-6, 1e-3, 5e-4),
        ModelChoice::Fixed(Model::Traction) => (1e-8, 1e-4, 1e-5),
        _ => (1e-10, 1e-4, DIFFERENCE),
    }
}

fn check_derivatives(case: &Case, settings: &Settings) -> Result<(), TestCaseError> {
    let (found, numbers) =
        (solve_with_derivatives(case, settings), solve_without_derivatives(case, settings));
    prop_assert_eq!(found.is_some(), numbers.is_some());
    let (Some(found), Some(numbers)) = (found, numbers) else {
        return Err(TestCaseError::reject("no solution"));
    };
    // The results calculated together with the derivatives equal the results calculated without
    // derivatives, apart from rounding errors.
    let torque = |o: Option<f64>| o.expect("a torque");
    let eta = numbers.efficiency;
    let (rounding, step, apart) = tolerances(settings.model);
    assert_relative_eq!(found.0.efficiency, eta, max_relative = rounding, epsilon = 1e-12);
    let own = torque(found.0.screw_torque);
    assert_relative_eq!(own, torque(numbers.screw_torque), max_relative = rounding);
    let violation = largest_identity_violation(&found);
    prop_assert!(is_homogeneous(settings.model, violation), "{violation:?}");
    // A neighboring point without a solution or on another branch is not compared.
    let difference = largest_derivative_error(case, settings, step);
    prop_assert!(difference.is_none_or(|d| d <= apart), "{difference:?}");
    Ok(())
}

/// Returns the case with its speeds divided by 10 to the power of `log_factor`.
fn reduce_speeds(mut case: Case, log_factor: f64) -> Case {
    let factor = 10.0_f64.powf(-log_factor);
    for speed in [&mut case.screw_speed_rpm, &mut case.nut_speed_rpm] {
        *speed = speed.map(|rpm| rpm * factor);
    }
    case
}

/// Returns Lin's screw with conformities, at the given speed.
fn screw_of_lin(rpm: f64) -> Case {
    Case {
        ball_diameter_mm: Some(8.74),
        pitch_circle_diameter_mm: Some(48.6),
        lead_angle_deg: Some(10.0),
        contact_angle_deg: Some(45.0),
        nut_conformity: Some(0.53),
        screw_conformity: Some(0.53),
        friction_coefficient: Some(0.075),
        screw_speed_rpm: Some(rpm),
        axial_load_N: Some(2113.0),
        loaded_balls: Some(1.0),
        ..Case::default()
    }
}

fn sensitivity_to(case: &Case, model: Model, name: &str) -> Sensitivity {
    let (_, rows) = solve_with_derivatives(case, &model.into()).expect("solved");
    rows.into_iter().find(|row| row.input.name == name).expect("the model uses the input")
}

/// The derivatives for a ball with a third contact at the nut or at the screw match finite
/// differences, including the derivatives with respect to the play and to the friction coefficient
/// at the far flank.
#[test]
fn third_contact_derivatives_match_finite_differences() {
    for rpm in [300.0, -300.0] {
        let case = Case {
            axial_load_N: Some(450.0),
            loaded_balls: Some(3.0),
            axial_play_um: Some(6.0),
            radial_gap_um: Some(2.0),
            far_flank_friction_coefficient: Some(0.09),
            ..screw_of_lin(rpm)
        };
        let settings = Settings::from(Model::Traction);
        let problem = case.problem(&settings).expect("complete case");
        let solution = problem.solve(&mut ModelWorkspace::default());
        let far = solution.steady_state().and_then(|solved| solved.far_flank).expect("a play");
        assert!(far.contact.is_some(), "{far:?}");
        check_derivatives(&case, &settings).expect("exact derivatives");
        for name in ["axial_play_um", "radial_gap_um", "far_flank_friction_coefficient"] {
            let row = sensitivity_to(&case, Model::Traction, name);
            assert!(row.efficiency != 0.0, "{name}");
        }
    }
}

/// The expected closed-form derivatives were calculated by hand for both directions: dη/df = −D /
/// [cos²α sinβ (D + f sinβ)²] and −sinβ / [cos²α D (sinβ + f D)²].
#[test]
fn closed_form_friction_derivative_matches_the_formula() {
    let (a, b, f) = (10.0_f64.to_radians(), 45.0_f64.to_radians(), 0.075);
    let (cos2, s) = (a.cos().powi(2), b.sin());
    let d = (b.cos().powi(2) + a.tan().powi(2)).sqrt();
    let driving =
        sensitivity_to(&screw_of_lin(2000.0), Model::ClosedForm, "friction_coefficient").efficiency;
    let expected = -d / (cos2 * s * (d + f * s).powi(2));
    assert_relative_eq!(driving, expected, max_relative = 1e-13);
    let driven = sensitivity_to(&screw_of_lin(-2000.0), Model::ClosedForm, "friction_coefficient")
        .efficiency;
    let expected = -s / (cos2 * d * (s + f * d).powi(2));
    assert_relative_eq!(driven, expected, max_relative = 1e-13);
}

/// The effect of inertia is proportional to the square of the speed if the balls are slow. This
/// must also be true below 15 rpm in the `rigid` model and below 47 rpm in the `elastic` model,
/// where the results are extrapolated from results at higher speeds.
#[test]
fn effect_of_ball_density_on_efficiency_is_proportional_to_speed_squared() {
    for model in [Model::Rigid, Model::Elastic] {
        let at = |rpm| {
            sensitivity_to(&screw_of_lin(rpm), model, "density_kg_m3").efficiency / rpm.powi(2)
        };
        let faster = at(100.0);
        for rpm in [4.0, 10.0, 40.0] {
            // At 4 rpm, the derivative multiplied by the density is 1e-11, so rounding errors of η
            // are significant.
            assert_relative_eq!(at(rpm), faster, max_relative = 1e-2);
        }
    }
}

/// Inputs that the model does not use have no row. Inputs whose value is zero have no relative
/// sensitivity.
#[test]
fn sensitivity_table_has_a_row_for_each_input_that_the_model_uses() {
    let names = |model: Model| {
        let rows = solve_with_derivatives(&screw_of_lin(2000.0), &model.into()).expect("solved").1;
        let mut names: Vec<_> = rows.iter().map(|row| row.input.name).collect();
        names.sort_unstable();
        names
    };
    let rigid = names(Model::Rigid);
    assert!(rigid.contains(&"density_kg_m3") && rigid.contains(&"nut_speed_rpm"), "{rigid:?}");
    assert!(!rigid.contains(&"nut_conformity") && !rigid.contains(&"lead_mm"), "{rigid:?}");
    assert!(names(Model::Elastic).contains(&"youngs_modulus_GPa"));
    let still = sensitivity_to(&screw_of_lin(2000.0), Model::Rigid, "nut_speed_rpm");
    assert!(still.relative_efficiency.is_none() && still.efficiency != 0.0);
    let (_, rows) =
        solve_with_derivatives(&screw_of_lin(2000.0), &Model::Rigid.into()).expect("solved");
    let sizes: Vec<_> = rows.iter().filter_map(|r| r.relative_efficiency).map(f64::abs).collect();
    assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
}

/// Without a load, the closed-form model has no torque. Without a solution, there are no
/// derivatives.
#[test]
fn missing_results_have_no_derivatives() {
    let case = Case { axial_load_N: None, ..screw_of_lin(2000.0) };
    let friction = sensitivity_to(&case, Model::ClosedForm, "friction_coefficient");
    assert!(friction.screw_torque.is_none() && friction.efficiency < 0.0);
    let mut shallow = screw_of_lin(2000.0);
    shallow.lead_angle_deg = Some(5.0);
    assert!(solve_with_derivatives(&shallow, &Model::Rigid.into()).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn closed_form_derivatives_match_finite_differences(case in random_cases()) {
        check_derivatives(&case, &Model::ClosedForm.into())?;
    }

    #[test]
    fn quasi_static_derivatives_match_finite_differences(case in random_cases()) {
        check_derivatives(&with_one_turning_part(case), &Model::QuasiStatic.into())?;
    }

    #[test]
    fn rigid_derivatives_match_finite_differences(case in random_cases()) {
        check_derivatives(&case, &Model::Rigid.into())?;
    }

    #[test]
    fn elastic_derivatives_match_finite_differences(case in random_cases()) {
        check_derivatives(&case, &Model::Elastic.into())?;
    }

    #[test]
    fn traction_derivatives_match_finite_differences(case in random_cases()) {
        check_derivatives(&case, &Model::Traction.into())?;
    }

    /// The controlling raceway is given, because the points of a finite difference could otherwise
    /// be controlled by different raceways if both raceways have nearly equal spin friction moments
    /// (W7).
    #[test]
    fn raceway_control_derivatives_match_finite_differences(case in random_cases(), at_nut in any::<bool>()) {
        let control = if at_nut { Control::Nut } else { Control::Screw };
        check_derivatives(&case, &Settings { control: Some(control), ..Model::RacewayControl.into() })?;
    }

    /// The balls are so slow that the results are extrapolated from results at higher speeds.
    #[test]
    fn derivatives_of_slow_balls_match_finite_differences(case in random_cases(), log_factor in 3.0..6.0_f64) {
        let case = reduce_speeds(case, log_factor);
        for model in [Model::Rigid, Model::Elastic, Model::Traction] {
            check_derivatives(&case, &model.into())?;
        }
    }

    /// The derivatives for `auto` equal the derivatives for the model that `auto` chose, if the
    /// other settings are the same.
    #[test]
    fn auto_derivatives_match_the_chosen_model(case in random_cases(), log_tolerance in -6.0..-0.5_f64) {
        let auto = Settings { tolerance: 10.0_f64.powf(log_tolerance), ..Settings::default() };
        let solution = case.problem(&auto).expect("complete").solve(&mut ModelWorkspace::default());
        let found = solve_with_derivatives(&case, &auto).expect("auto has an answer");
        let accuracy = match solution.choice.expect("a choice").basis {
            Basis::Integrated { accuracy } => accuracy,
            _ => Traction::ACCURACY,
        };
        let own = Settings { accuracy, ..solution.model.into() };
        let own = solve_with_derivatives(&case, &own).expect("the model has an answer");
        for row in &found.1 {
            // Inputs that the chosen model does not use have no row.
            let same = own.1.iter().find(|own| own.input.name == row.input.name);
            let expected = same.map_or(0.0, |own| own.efficiency);
            // In both cases, the solver finds the same root, but from different starting points.
            let error = (row.efficiency - expected) * row.value.abs().max(1.0);
            prop_assert!(error.abs() <= 1e-8, "{row:?} {expected}");
        }
        prop_assert!(is_homogeneous(solution.model.into(), largest_identity_violation(&found)));
    }
}

/// The `raceway-control` model calculates the derivatives of its results with a finer quadrature
/// rule than the results themselves. Theory 12 states the resulting deviations in percent.
#[test]
fn raceway_control_finite_differences_deviate_from_derivatives_as_documented() {
    let json = include_bytes!("../../../../examples/dong2020.json");
    let case = Case::from_json(json).expect("a case");
    let settings = Settings::from(Model::RacewayControl);
    let (_, rows) = solve_with_derivatives(&case, &settings).expect("a solution");
    for (name, documented) in [
        ("pitch_circle_diameter_mm", -2.9),
        ("screw_speed_rpm", 2.3),
        ("axial_load_N", 2.0),
        ("loaded_balls", 2.0),
        ("youngs_modulus_GPa", 2.0),
        ("ball_youngs_modulus_GPa", 2.0),
        ("lead_mm", 1.9),
        ("ball_diameter_mm", -1.3),
        ("contact_angle_deg", -0.7),
        ("nut_conformity", -0.2),
        ("screw_conformity", 0.2),
        ("friction_coefficient", 0.1),
    ] {
        let row = rows.iter().find(|row| row.input.name == name).expect(name);
        let efficiency = |part: f64| {
            let mut moved = case.clone();
            moved.set(name, part * row.value).expect("known name");
            solve_without_derivatives(&moved, &settings).expect("a solution").efficiency
        };
        let step = 1e-4;
        let difference =
            (efficiency(1.0 + step) - efficiency(1.0 - step)) / (2.0 * step * row.value);
        let deviation = 100.0 * (difference / row.efficiency - 1.0);
        // The table in theory chapter 12 states the deviations to one decimal place.
        assert!((deviation - documented).abs() <= 0.06, "{name}: {deviation} %");
    }
}
