//! Tests of the third contact of a ball for a case with an axial play.

use bsm_case::{AxisReport, Case, ModelChoice, NutProblem, Record, Settings, output};
use bsm_dyn::{Model, ModelWorkspace};
use serde_json::Value;

use crate::named;

const CASES: &str = include_str!("../../../../validation/published/nut/third_contact.json");

/// Returns the case of a reference ball with changed inputs, and its expected results.
fn reference(name: &str, sets: &[&str]) -> (Case, Value) {
    let cases: Vec<Value> = serde_json::from_str(CASES).expect("JSON");
    let of = cases.into_iter().find(|case| case["name"] == name).expect("a reference case");
    let mut case = Case::from_json(of["case"].to_string().as_bytes()).expect("a case");
    case.apply(sets).expect("entries");
    (case, of["expect"].clone())
}

fn solve(case: &Case, settings: &Settings) -> Record {
    let problem = case.problem(settings).expect("a problem");
    Record::new(problem.solve(&mut ModelWorkspace::default()))
}

#[track_caller]
fn assert_near(record: &Record, name: &str, expected: f64, tolerance: f64) {
    let found = record.number(named(name)).unwrap_or_else(|| panic!("no {name}"));
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{name} {found} {expected}");
}

/// The nut has ten balls, which share ten times the load of the single ball in reference case V06.
#[test]
fn load_and_loss_of_the_third_contact_below_the_threshold_play_match_the_reference() {
    let (case, expect) = reference("V06", &["axial_load_N=600", "loaded_balls=10"]);
    let record = solve(&case, &Settings::default());
    assert_eq!(record.model(), ModelChoice::Fixed(Model::Traction));
    let get = |key: &str| expect[key].as_f64().expect("a number");
    // The tolerance is taken from the reference case.
    assert_near(&record, "nut_normal_load_N", get("nut_plus_N"), 1e-6);
    assert_near(&record, "screw_normal_load_N", get("screw_plus_N"), 1e-6);
    assert_near(&record, "third_contact_load_N", get("nut_minus_N"), 3e-5);
    assert_near(&record, "ball_torque_Nm", 10.0 * get("screw_torque_Nm"), 1e-6);
    assert_near(&record, "dissipated_power_W", 10.0 * get("dissipated_power_W"), 1e-6);
    assert_near(&record, "efficiency", get("efficiency"), 1e-6);
    assert_near(&record, "third_contact_power_share", get("third_contact_power_share"), 1e-6);
    let displacement = get("axial_displacement_um") - get("first_touch_um");
    assert_near(&record, "axial_displacement_um", displacement, 1e-5);
    assert!(record.number(output!(far_flank_gap_um)).is_some_and(|gap| gap < 0.0));
    let warnings = record.warnings(&case).join(" ");
    let told =
        ["axial play of 10 um is below the threshold", "far flank of the nut", "by a factor of"];
    assert!(told.iter().all(|text| warnings.contains(text)), "{warnings}");
}

#[test]
fn threshold_play_is_stated_if_no_play_is_specified() {
    let (mut case, _) = reference("V06", &[]);
    case.axial_play_um = None;
    let settings = Settings::from(Model::Traction);
    let record = solve(&case, &settings);
    let threshold = record.number(output!(threshold_play_um)).expect("a threshold");
    assert!(threshold > 10.0 && threshold < 40.0, "{threshold}");
    assert_eq!(record.number(output!(far_flank_gap_um)), None);
    assert!(!record.warnings(&case).join(" ").contains("far flank"));
    // Above the threshold play, a larger play only increases the gap between ball and far flank.
    let (above, _) = reference("V06", &[&format!("axial_play_um={}", threshold + 1.0)]);
    let wide = solve(&above, &settings);
    // The tolerance allows for rounding errors of the contact angle.
    assert_near(
        &wide,
        "ball_torque_Nm",
        record.number(output!(ball_torque_Nm)).expect("a torque"),
        1e-12,
    );
    assert_eq!(wide.number(output!(third_contact_load_N)), None);
    assert!(wide.number(output!(far_flank_gap_um)).is_some_and(|gap| gap > 0.0));
    assert!(!wide.warnings(&above).join(" ").contains("far flank"));
}

/// In the `raceway-control` model, friction does not affect the force balance of the ball, so there
/// is no threshold play.
#[test]
fn only_models_with_friction_in_the_force_balance_have_a_threshold_play() {
    let (mut case, _) = reference("V06", &[]);
    case.axial_play_um = None;
    for (model, has) in
        [(Model::RacewayControl, false), (Model::Elastic, true), (Model::Traction, true)]
    {
        let record = solve(&case, &Settings::from(model));
        assert_eq!(record.number(output!(threshold_play_um)).is_some(), has, "{}", model.name());
    }
}

/// An axial play of zero and a radial gap of zero describe the same grooves. If either of these
/// inputs is given, the play is known.
#[test]
fn radial_gap_counts_as_play() {
    let settings = Settings::default();
    let torque = |sets: &[&str]| {
        let (mut case, _) = reference("V06", &[]);
        case.axial_play_um = None;
        case.apply(sets).expect("entries");
        let record = solve(&case, &settings);
        assert_eq!(record.model(), ModelChoice::Fixed(Model::Traction), "{sets:?}");
        record.number(output!(ball_torque_Nm)).expect("a torque")
    };
    let none = torque(&["axial_play_um=0"]);
    assert_eq!(torque(&["radial_gap_um=0"]).to_bits(), none.to_bits());
    assert_eq!(
        torque(&["radial_gap_um=3", "axial_play_um=0"]).to_bits(),
        torque(&["radial_gap_um=3"]).to_bits()
    );
    // A radial gap moves the far flanks away from the ball, as an axial play does.
    let gaps = [0.0, 3.0, 6.0, 9.0].map(|gap| torque(&[&format!("radial_gap_um={gap}")]));
    assert!(gaps.windows(2).all(|pair| pair[1] < pair[0]), "{gaps:?}");
    // Balls with two contacts roll at the contact angle at which they first touch the grooves.
    let (l, gap) = (6.35 * (2.0 * 0.53 - 1.0), 0.09);
    let angle = (45_f64.to_radians().cos() - gap / l).acos().to_degrees();
    let wide = torque(&["radial_gap_um=90"]);
    let turned = torque(&["axial_play_um=1000", &format!("contact_angle_deg={angle}")]);
    // The tolerance allows for the residuals of both force balances, which are 1e-10 of the
    // friction.
    assert!((wide / turned - 1.0).abs() < 1e-9, "{wide} {turned}");
}

#[test]
fn radial_gap_deeper_than_the_grooves_is_rejected() {
    let (mut case, _) = reference("V06", &["radial_gap_um=300"]);
    for model in [Model::RacewayControl, Model::Elastic, Model::Traction] {
        let why = case.problem(&Settings::from(model)).expect_err("no groove is that deep");
        assert!(why.to_string().contains("radial_gap_um"), "{why}");
    }
    // Models that do not depend on the groove geometry ignore the play.
    case.radial_gap_um = Some(300.0);
    assert!(case.problem(&Settings::from(Model::Rigid)).is_ok());
}

/// For every value of the play, from zero to a large value, `auto` chooses the `traction` model,
/// because no less expensive model calculates a third contact.
#[test]
fn auto_chooses_traction_if_any_play_is_specified() {
    let mut last = f64::INFINITY;
    for play in [0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 1000.0] {
        let (case, _) = reference("V06", &[&format!("axial_play_um={play}")]);
        let [auto, traction] =
            [Settings::default(), Settings::from(Model::Traction)].map(|settings| {
                solve(&case, &settings).number(output!(ball_torque_Nm)).expect("a torque")
            });
        assert_eq!(auto.to_bits(), traction.to_bits(), "{play}");
        // Above the threshold, the balls have two contacts. The tolerance allows for rounding
        // errors.
        assert!(auto <= last * (1.0 + 1e-12), "{play}: {auto} {last}");
        last = auto;
    }
}

#[test]
fn far_flank_friction_defaults_to_the_friction_coefficient() {
    let settings = Settings::default();
    let power = |sets: &[&str]| {
        let (case, _) = reference("V06", sets);
        solve(&case, &settings).number(output!(dissipated_power_W)).expect("a power")
    };
    let equal = power(&[]);
    assert_eq!(power(&["far_flank_friction_coefficient=0.06"]).to_bits(), equal.to_bits());
    assert!(power(&["far_flank_friction_coefficient=0.03"]) < equal);
    assert!(power(&["far_flank_friction_coefficient=0.12"]) > equal);
    // Balls with two contacts do not touch the far flanks.
    let wide = ["axial_play_um=100", "far_flank_friction_coefficient=0.03"];
    assert_eq!(power(&wide).to_bits(), power(&wide[..1]).to_bits());
}

/// The third contact of a lubricated ball causes the same additional loss as a dry third contact
/// with the mean friction coefficient. At the threshold, the loss is a continuous function of the
/// play.
#[test]
fn loss_of_a_lubricated_third_contact_equals_the_loss_of_a_dry_third_contact() {
    let oil = ["iso_vg=68", "lubricant_temperature_C=30"];
    let settings = Settings::default();
    let at = |play: Option<f64>| {
        let (mut case, _) = reference("V06", &[]);
        case.apply(&oil).expect("an oil");
        case.axial_play_um = play;
        (solve(&case, &settings), case)
    };
    let power = |record: &Record| record.number(output!(dissipated_power_W)).expect("a power");
    let (two, _) = at(None);
    let (none, case) = at(Some(0.0));
    assert!(none.number(output!(third_contact_load_N)).is_some_and(|load| load > 0.0));
    assert!(power(&none) > 1.5 * power(&two), "{} {}", power(&none), power(&two));
    let text = none.warnings(&case).join(" ");
    assert!(text.contains("touch the far flank of the nut"), "{text}");
    // The bisection finds the play at which the gap to the far flank closes.
    let (mut low, mut high) = (0.0, 100.0);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        let is_third = at(Some(middle)).0.number(output!(third_contact_load_N)).is_some();
        if is_third { low = middle } else { high = middle }
    }
    let [below, above] = [low, high].map(|play| power(&at(Some(play)).0));
    assert!((below / above - 1.0).abs() < 1e-6, "{below} {above}");
    assert!((above / power(&two) - 1.0).abs() < 1e-12, "{above}");
    // The third contact adds the same loss as the third contact of dry balls with the mean friction
    // coefficient.
    let mean = 0.5
        * ["nut_friction_coefficient", "screw_friction_coefficient"]
            .map(|name| two.number(named(name)).expect(name))
            .iter()
            .sum::<f64>();
    let dry = |play: f64| {
        let (mut case, _) = reference("V06", &[&format!("friction_coefficient={mean}")]);
        case.axial_play_um = Some(play);
        power(&solve(&case, &settings))
    };
    let added = dry(0.0) - dry(1000.0);
    assert!(((power(&none) - power(&two)) / added - 1.0).abs() < 1e-9, "{added}");
}

/// Returns the report of a horizontal axis with a nut pair, with changed inputs.
fn axis(sets: &[&str]) -> AxisReport {
    let case = include_bytes!("../../../../examples/axis.json");
    let mut case = Case::from_json(case).expect("a case");
    case.apply(sets).expect("entries");
    AxisReport::of(&case, &Settings::default()).expect("a sheet")
}

#[test]
fn axis_sheet_states_third_contacts_and_drag_in_both_directions() {
    let with = axis(&["axial_play_um=0", "friction_coefficient=0.09"]);
    let wide = axis(&["axial_play_um=500", "friction_coefficient=0.09"]);
    let of = |report: &AxisReport, name: &str| {
        report.number(named(name)).unwrap_or_else(|| panic!("{name}"))
    };
    // The sheet states the number and the largest load of the third contacts under the largest
    // axial load, and the torque of the third contacts in each phase.
    assert!(
        of(&with, "third_contact_balls") > 0.0 && of(&with, "largest_third_contact_load_N") > 0.0
    );
    let share = of(&with, "third_contact_torque_share");
    assert!(share > 0.05 && share < 0.9, "{share}");
    let third: Vec<_> = with
        .phases
        .iter()
        .filter_map(|phase| phase.number(output!(third_contact_torque_Nm)))
        .collect();
    assert!(!third.is_empty() && third.iter().all(|torque| *torque > 0.0), "{third:?}");
    assert_eq!(wide.number(output!(third_contact_balls)), Some(0.0));
    assert!(
        wide.phases.iter().all(|phase| phase.number(output!(third_contact_torque_Nm)).is_none())
    );
    // The calculated drag torque coefficient is listed next to the value from the manufacturers'
    // rule.
    let rule = of(&with, "preload_torque_factor_rule");
    let [running, of_two] =
        [&with, &wide].map(|report| of(report, "running_preload_torque_factor"));
    assert!(running > 1.4 * of_two && running < rule, "{running} {of_two} {rule}");
    assert!(of(&with, "running_preload_N") < of(&wide, "running_preload_N"));
    // Without load, reversing the direction only exchanges the roles of the two equal nuts.
    for name in ["preload_torque", "running_preload_torque"] {
        let there = of(&with, &format!("{name}_Nm"));
        let back = of(&with, &format!("{name}_reverse_Nm"));
        // The torques are two roots of the force balance. The ellipse integrals of each root have a
        // relative error of 1e-6.
        assert!((there / back - 1.0).abs() < 2e-6, "{name} {there} {back}");
    }
    assert!(with.answer.notes.iter().all(|note| !note.contains("Neither axial_play_um")));
    let unknown = axis(&[]);
    let assumed = "Neither axial_play_um nor radial_gap_um is given";
    assert!(unknown.answer.notes.iter().any(|note| note.contains(assumed)));
}

/// Under load, the friction depends on whether the nut moves against the load or with the load.
#[test]
fn friction_of_a_loaded_nut_depends_on_the_direction_of_travel() {
    let nut = |rpm: f64| {
        let mut case = Case::from_json(include_bytes!("../../../../examples/nut_double.json"))
            .expect("a case");
        case.apply(&["axial_play_um=0", &format!("screw_speed_rpm={rpm}")]).expect("entries");
        NutProblem::of(&case, &Settings::default()).expect("a nut").solve().expect("carried")
    };
    let [there, back] = [nut(300.0), nut(-300.0)];
    let [a, b] = [&there, &back].map(|nut| {
        ["friction_torque_Nm", "friction_torque_reverse_Nm"]
            .map(|name| nut.number(named(name)).expect(name))
    });
    assert_eq!([a[0].to_bits(), a[1].to_bits()], [b[1].to_bits(), b[0].to_bits()]);
    assert!((a[0] / a[1] - 1.0).abs() > 1e-4, "{a:?}");
    assert_eq!(
        there.number(output!(third_contact_torque_share)).map(|share| share > 0.0),
        Some(true)
    );
}

/// In a lubricated nut pair, third contacts contribute to the drag torque if the play is small, but
/// not if the play is large.
#[test]
fn lubricated_pair_has_more_drag_with_little_play_than_with_large_play() {
    let nut = |play: Option<f64>| {
        let case = include_bytes!("../../../../examples/nut_double.json");
        let mut case = Case::from_json(case).expect("a case");
        case.apply(&["iso_vg=68", "lubricant_temperature_C=30", "screw_speed_rpm=100"])
            .expect("an oil");
        case.axial_play_um = play;
        let problem = NutProblem::of(&case, &Settings::default()).expect("a nut");
        problem.solve().expect("carried")
    };
    let [none, wide, unknown] = [Some(0.0), Some(300.0), None].map(nut);
    for name in ["preload_torque_Nm", "running_preload_torque_Nm"] {
        let [little, wide, unknown] = [&none, &wide, &unknown]
            .map(|nut| nut.number(named(name)).unwrap_or_else(|| panic!("{name}")));
        assert!(little > 1.2 * wide, "{name}: {little} {wide}");
        // The balls have two contacts if the play is large or unknown, and they are solved in the
        // same way in both cases.
        assert!((wide / unknown - 1.0).abs() < 1e-9, "{name}: {wide} {unknown}");
    }
    assert_eq!(wide.number(output!(third_contact_balls)), Some(0.0));
    assert!(none.notes().iter().any(|note| note.contains("mean friction coefficient")));
}
