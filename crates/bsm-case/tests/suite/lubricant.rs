//! Tests of friction from the lubricant: comparison with an independent solution, and checks of the
//! inputs.

use approx::assert_relative_eq;
use bsm_case::{
    Calibration, Case, FittedInput, NutProblem, NutReport, Record, Sensitivities, Settings,
    TableFormat, comparison, output, torque_parts,
};
use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::Value;

use crate::named;

const CASES: &str = include_str!("../../../../validation/published/lubrication/public.json");
const OILED: &[u8] = include_bytes!("../../../../examples/feed_drive_oil.json");
const DRY: &[u8] = include_bytes!("../../../../examples/feed_drive.json");

fn oiled_case(settings: &[&str]) -> Case {
    let mut case = Case::from_json(OILED).expect("an example");
    case.apply(settings).expect("inputs");
    case
}

fn solved(case: &Case, model: Model) -> Record {
    let problem = case.problem(&model.into()).expect("a complete case");
    let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
    assert_eq!(record.status(), Status::Converged, "{:?} {:?}", case.description, record.message());
    record
}

/// All models that support no lubricant are omitted for the same reason, which names no model.
#[test]
fn model_comparison_omits_models_without_lubricant_for_the_same_reason() {
    let answer = comparison(&oiled_case(&[])).expect("models").to_json();
    let left_out = answer["left_out"].as_array().expect("a list");
    let names: Vec<_> = left_out.iter().map(|row| row["model"].as_str()).collect();
    assert_eq!(names, ["closed-form", "quasi-static", "rigid", "elastic"].map(Some));
    let reason = left_out[0]["reason"].as_str().expect("a reason");
    assert!(reason.starts_with("does not support a lubricant"), "{reason}");
    assert!(left_out.iter().all(|row| row["reason"] == reason), "{left_out:?}");
}

/// The deviations refer to `traction`. If `traction` cannot be solved, they refer to the solved
/// model with the most inputs, and a note names this model.
#[test]
fn model_comparison_lists_deviations_from_the_reference_model() {
    let compared = |case: &Case| comparison(case).expect("models").to_json();
    let answer = compared(&Case::from_json(DRY).expect("an example"));
    assert_eq!(answer["reference_model"], "traction");
    let rows = answer["models"].as_array().expect("a list");
    let number = |row: &Value, name: &str| row[name].as_f64().expect("a number");
    let reference = rows.iter().find(|row| row["model"] == "traction").expect("a row");
    let exact = number(reference, "efficiency");
    for row in rows.iter().filter(|row| row["status"] == "converged") {
        let efficiency = number(row, "efficiency");
        assert_relative_eq!(number(row, "efficiency_deviation"), efficiency - exact);
        let loss = (1.0 - efficiency) / (1.0 - exact) - 1.0;
        assert_relative_eq!(number(row, "loss_deviation"), loss, epsilon = 1e-12);
    }
    let case = br#"{"lead_angle_deg": 5, "contact_angle_deg": 45, "friction_coefficient": 0.01}"#;
    let answer = compared(&Case::from_json(case).expect("a case"));
    assert_eq!(answer["reference_model"], "closed-form");
    let note = answer["notes"][0].as_str().expect("a note");
    assert!(note.contains("refer to model closed-form"), "{note}");
}

/// The results of the 11 cases agree with an independent solution within its tolerances. In one
/// case, the torque of the complete screw is compared, because the reference torque includes the
/// seals.
#[test]
fn lubricated_friction_matches_an_independent_solution() {
    let cases: Value = serde_json::from_str(CASES).expect("JSON");
    let mut numbers = 0;
    let mut far = Vec::new();
    for reference in cases["cases"].as_array().expect("a list") {
        let case = Case::from_json(reference["case"].to_string().as_bytes()).expect("a case");
        let model =
            Model::from_name(reference["model"].as_str().expect("a name")).expect("a model");
        let record = solved(&case, model);
        if model == Model::Traction {
            assert!(record.number(output!(power_balance)).expect("a balance").abs() <= 1e-9);
        }
        let told = reference["rel_tol"].as_f64().expect("a number");
        let whole =
            torque_parts(&case, &model.into(), &mut ModelWorkspace::default()).expect("a torque");
        let seal = record.number(output!(seal_power_W)).expect("a power");
        let whole = whole.expect("a load, a speed and friction");
        let number = |name: &str| match name {
            "screw_torque_Nm" => whole.torque(),
            "efficiency" => whole.number(output!(screw_efficiency)),
            "dissipated_power_W" => record.number(named(name)).map(|power| power + seal),
            _ => record.number(named(name)),
        };
        for (name, value) in reference["expect"].as_object().expect("numbers") {
            // The catalog friction coefficient is calculated from the efficiency. In the reference,
            // the efficiency includes the seals, so this output is not compared for a case with
            // seals.
            if seal > 0.0 && name == "catalog_friction_coefficient" {
                continue;
            }
            let (value, ours) = (value.as_f64().expect("a number"), number(name));
            let ours = ours.unwrap_or_else(|| panic!("{name} of {}", reference["id"]));
            let tolerance = if name.contains("spin") { 1e-3 } else { told };
            // A ball does not spin at the raceway that controls it, apart from rounding errors of
            // its surface speeds.
            let rounding = if name.contains("spin") { 1e-9 } else { 0.0 };
            if (ours - value).abs() > tolerance * value.abs() + rounding {
                far.push(format!(
                    "{} {name}: {ours} {value} {:.1e}",
                    reference["id"],
                    ours / value - 1.0
                ));
            }
            numbers += 1;
        }
    }
    assert!(far.is_empty() && numbers > 300, "{numbers} {far:#?}");
}

/// Friction may be given by a coefficient or by a lubricant, but not by both. A lubricant is
/// accepted only by models that use it.
#[test]
fn lubricant_inputs_that_conflict_or_are_incomplete_are_rejected() {
    let told = |case: &Case, settings: &Settings| match case.problem(settings) {
        Err(error) => error.to_string(),
        Ok(_) => String::new(),
    };
    let auto = Settings::default();
    let mut both = oiled_case(&[]);
    both.friction_coefficient = Some(0.06);
    assert!(told(&both, &auto).contains("friction_coefficient and iso_vg are given"));
    let mut dry = Case::from_json(DRY).expect("an example");
    dry.apply(&["film_factor=0.7"]).expect("an input");
    assert!(told(&dry, &auto).contains("friction_coefficient and film_factor are given"));
    for model in [Model::ClosedForm, Model::QuasiStatic, Model::Rigid, Model::Elastic] {
        let error = oiled_case(&[]).problem(&model.into()).expect_err("no lubricant");
        let text = error.to_string();
        assert!(
            text.contains("raceway-control and traction") && text.contains("equivalent_friction")
        );
    }
    let mut bare = oiled_case(&[]);
    bare.lubricant_temperature_C = None;
    let text = told(&bare, &auto);
    assert!(text.contains("lubricant_temperature_C (or"), "{text}");
    let text = told(&oiled_case(&["viscosity_100C_mm2_s=8"]), &auto);
    assert!(text.contains("viscosity_100C_mm2_s` also needs viscosity_40C_mm2_s"), "{text}");
    assert!(told(&oiled_case(&["iso_vg=69"]), &auto).contains("one of 10, 15, 22"));
    let thick = oiled_case(&["viscosity_40C_mm2_s=8", "viscosity_100C_mm2_s=9"]);
    assert!(told(&thick, &auto).contains("must be below"), "{}", told(&thick, &auto));
}

/// `auto` chooses the `traction` model for a lubricated ball. A given viscosity replaces the
/// viscosity grade.
#[test]
fn auto_chooses_the_traction_model_for_a_lubricated_ball() {
    let record = Record::new(
        oiled_case(&[])
            .problem(&Settings::default())
            .expect("complete")
            .solve(&mut ModelWorkspace::default()),
    );
    assert_eq!(record.model(), Model::Traction.into());
    let thin = oiled_case(&["viscosity_40C_mm2_s=31", "viscosity_100C_mm2_s=5.8", "base_oil=pao"]);
    assert!(thin.iso_vg.is_none());
    let film = |case: &Case| solved(case, Model::Traction).number(output!(nut_film_um));
    assert!(film(&thin) < film(&oiled_case(&[])));
}

/// Derivatives match finite differences, both at a fixed lubricant temperature and at a temperature
/// that depends on the losses.
#[test]
fn lubricated_sensitivities_match_finite_differences() {
    let heat = ["heat_transfer_W_K=6", "ambient_temperature_C=22", "screw_speed_rpm=3000"];
    let cases = [(Model::Traction, oiled_case(&[])), (Model::RacewayControl, oiled_case(&heat))];
    for (model, case) in cases {
        let settings = Settings::from(model);
        let inputs = Sensitivities::of(&case, &settings).expect("complete");
        let mut work = ModelWorkspace::default();
        let (_, rows) = inputs.solve(&mut work).expect("a solution");
        for name in
            ["axial_load_N", "nut_roughness_um", "boundary_friction_coefficient", "film_factor"]
        {
            let row =
                rows.iter().find(|row| row.input.name == name).expect("an input that is used");
            let torque = |factor: f64| {
                let mut moved = case.clone();
                moved.set(name, row.value * factor).expect("an input");
                solved(&moved, model).number(output!(ball_torque_Nm)).expect("a torque")
            };
            let step = 1e-3;
            let slope = (torque(1.0 + step) - torque(1.0 - step)) / (2.0 * step * row.value);
            let ours = row.screw_torque.expect("a torque");
            // The truncation error of the finite difference is proportional to the square of the
            // step.
            assert!((ours - slope).abs() <= 1e-4 * slope.abs() + 1e-9, "{name}: {ours} {slope}");
        }
    }
}

/// With rough surfaces and without rolling losses, the friction of a nut equals the friction with a
/// constant coefficient. If the oil film carries a part of the load, the film is calculated
/// separately for each ball.
#[test]
fn each_ball_of_a_lubricated_nut_has_its_own_film_thickness() {
    const NUT: &[u8] = include_bytes!("../../../../examples/nut_guided.json");
    const OIL: [&str; 5] = [
        "iso_vg=68",
        "lubricant_temperature_C=40",
        "ball_roughness_um=0.03",
        "nut_roughness_um=0.2",
        "screw_roughness_um=0.2",
    ];
    let nut = |settings: &[&str]| {
        let mut case = Case::from_json(NUT).expect("an example");
        case.friction_coefficient = None;
        // If an input is set several times, the last value is used.
        for setting in settings {
            case.apply(&[setting]).expect("an input");
        }
        NutProblem::of(&case, &Model::RacewayControl.into())
    };
    let report = |settings: &[&str]| {
        nut(settings).expect("a complete nut").solve().expect("a nut that carries")
    };
    let torque = |report: &NutReport| report.number(output!(friction_torque_Nm)).expect("a torque");
    let dry = report(&["friction_coefficient=0.12"]);
    let rough =
        ["nut_roughness_um=1e9", "screw_roughness_um=1e9", "rolling_factor=0", "hysteresis_loss=0"];
    let rough = report(&[&OIL[..], &rough].concat());
    // Model `raceway-control` integrates the friction for a constant coefficient with a relative
    // error of 1e-4 at each contact.
    assert_relative_eq!(torque(&rough), torque(&dry), max_relative = 1e-3);
    let oiled = report(&OIL);
    assert!(torque(&oiled) < torque(&dry));
    // The friction torque of the balls does not include the seal torque, which the axis sheet adds
    // separately.
    let sealed = report(&[&OIL[..], &["seal_torque_Nm=5"]].concat());
    assert_eq!(torque(&sealed).to_bits(), torque(&oiled).to_bits());

    let warming =
        [&OIL[..1], &OIL[2..], &["heat_transfer_W_K=5", "ambient_temperature_C=20"]].concat();
    let refused = nut(&warming).expect_err("no temperature").to_string();
    assert!(refused.contains("lubricant_temperature_C"), "{refused}");
    let pressed = ["preload_N=3000", "preload_by=oversize", "axial_load_N=3000"];
    let tight = report(&[&OIL[..], &pressed].concat());
    assert!(tight.number(output!(friction_torque_Nm)).is_none());
    assert!(tight.notes().iter().any(|note| note.contains("both flanks")), "{:?}", tight.notes());
}

/// Viscosity and temperature are sufficient to define a lubricant; the default roughness is the
/// roughness of ground grooves. Lubricant inputs replace the friction coefficient of a case, and
/// vice versa.
#[test]
fn lubricant_is_defined_by_viscosity_and_temperature() {
    let drive = include_bytes!("../../../../examples/feed_drive.json");
    let dry = Case::from_json(drive).expect("an example");
    let with = |case: &Case, settings: &[&str]| {
        let mut case = case.clone();
        case.apply(settings).expect("settings");
        case
    };
    let oil = with(&dry, &["iso_vg=68", "lubricant_temperature_C=40"]);
    assert_eq!((oil.friction_coefficient, oil.iso_vg), (None, Some(68.0)));
    let surfaces = ["ball_roughness_um=0.02", "nut_roughness_um=0.2", "screw_roughness_um=0.2"];
    let torque = |settings: &[&str]| {
        solved(&with(&oil, settings), Model::RacewayControl).number(output!(ball_torque_Nm))
    };
    assert_eq!(torque(&[]), torque(&surfaces));
    assert_eq!(torque(&["screw_make=rolled"]), torque(&["screw_roughness_um=0.4"]));
    assert_eq!(with(&oil, &["friction_coefficient=0.06"]), dry);
    let both = with(&dry, &["iso_vg=68", "lubricant_temperature_C=40", "friction_coefficient=0.1"]);
    assert!(both.problem(&Model::Traction.into()).is_err());
}

/// A fit to calculated points in other units recovers the input values, and the residuals are zero.
#[test]
fn fit_recovers_lubricant_inputs_from_a_table() {
    let base = oiled_case(&[]);
    let truth = ["boundary_friction_coefficient=0.1", "rolling_factor=0.7"];
    let mut rows = vec!["speed_rpm,axial_load_kN,screw_torque_Ncm".to_owned()];
    for speed in [20.0, 200.0, 1500.0, 4000.0] {
        for load in [2000.0, 8000.0] {
            let mut case = oiled_case(&truth);
            case.set("screw_speed_rpm", speed).expect("an input");
            case.set("axial_load_N", load).expect("an input");
            let torque = solved(&case, Model::RacewayControl).number(output!(ball_torque_Nm));
            let torque = torque.expect("a torque");
            rows.push(format!("{speed},{},{}", load / 1e3, torque * 100.0));
        }
    }
    let table = rows.join("\n");
    let inputs = ["boundary_friction_coefficient", "rolling_factor=0.3:1.5"];
    let inputs = inputs.map(|text| FittedInput::parse(text).expect("an input"));
    let settings = Settings::from(Model::RacewayControl);
    let fit = Calibration::new(
        &base,
        &inputs,
        "screw_torque_Nm",
        None,
        table.as_bytes(),
        &TableFormat::default(),
    )
    .expect("a table");
    let report = fit.run(&base, &settings).expect("complete").expect("a fit");
    let [boundary, rolling] = fit.rows(&report)[..] else { panic!("two inputs") };
    // The search stops when its steps are smaller than 1e-9 of the search ranges. The truncation
    // error of the finite-difference derivatives is 1e-6 relative to a step.
    assert_relative_eq!(boundary.1, 0.1, max_relative = 1e-6);
    assert_relative_eq!(rolling.1, 0.7, max_relative = 1e-6);
    assert!(report.scatter < 1e-6 && report.found.condition < 100.0, "{report:?}");
}

/// The message about an error in a table of measurements names the row or the column of the error.
#[test]
fn errors_in_measurement_tables_name_the_row_or_column() {
    let why = |inputs: &[&str], table: &str| {
        let inputs: Result<Vec<_>, _> =
            inputs.iter().map(|input| FittedInput::parse(input)).collect();
        let inputs = match inputs {
            Ok(inputs) => inputs,
            Err(error) => return error.to_string(),
        };
        Calibration::new(
            &oiled_case(&[]),
            &inputs,
            "screw_torque_Nm",
            None,
            table.as_bytes(),
            &TableFormat::default(),
        )
        .expect_err("a fault")
        .to_string()
    };
    let one = ["rolling_factor"];
    let said = why(&one, "screw_speed_rpm,screw_torque_Nm\n100,a\n");
    assert!(said.contains("row 1") && said.contains("`a`"), "{said}");
    assert!(why(&one, "screw_speed_rpm\n100\n").contains("screw_torque_Nm"));
    assert!(why(&one, "screw_torque_Nm\n").contains("no rows"));
    assert!(why(&one, "screw_sped_rpm,screw_torque_Nm\n1,2\n").contains("screw_speed_rpm"));
    assert!(why(&["seal_torque_Nm"], "screw_torque_Nm\n1\n").contains("seal_torque_Nm"));
    assert!(why(&["rolling_factor=1"], "screw_torque_Nm\n1\n").contains("low:high"));
}

/// With cold, thick oil and lightly loaded balls, the film is several times thicker than the
/// formula for elastic contacts predicts. The program used to give no warning.
#[test]
fn warns_about_a_film_between_rigid_contacts() {
    let warned = |settings: &[&str]| {
        let case = oiled_case(settings);
        let warnings = solved(&case, Model::RacewayControl).warnings(&case);
        warnings.iter().any(|words| words.starts_with("The load parameter M = "))
    };
    assert!(!warned(&[]));
    assert!(warned(&[
        "iso_vg=460",
        "lubricant_temperature_C=-20",
        "axial_load_N=20",
        "screw_speed_rpm=500"
    ]));
}
