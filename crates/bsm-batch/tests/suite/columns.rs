//! Tests of table columns that contain results of analyses.

use bsm_batch::{Answers, Chunk, Columns, GridSource, Source, TableFormat, Task};
use bsm_case::{
    AnalysisKind, AxisReport, Case, Grid, GridAxis, MotionAnswer, Output, OutputName, Settings,
};
use bsm_dyn::{Control, Model, ModelWorkspace, Status};

const DONG: &[u8] = include_bytes!("../../../../examples/dong2020.json");
const AXIS: &[u8] = include_bytes!("../../../../examples/axis.json");
const FEED_AXIS: &[u8] = include_bytes!("../../../../validation/published/nut/feed_axis.json");

const BALL_TRAIN: &str = include_str!("../../../../validation/published/nut/ball_train.json");

/// Returns an example case of a nut with three loaded turns, without the input that `without`
/// names.
fn dong_case(without: &str) -> Case {
    let mut case = Case::from_json(DONG).expect("an example");
    case.loaded_turns = Some(3.0);
    let mut json = case.to_json();
    // These inputs are required for the nut analysis.
    json["loaded_turns"] = 2.into();
    // These inputs are required for the axis analysis.
    json["axis_heat_transfer_W_K"] = 50.into();
    json["accuracy_grade"] = 5.into();
    json["stroke_mm"] = 500.into();
    json.as_object_mut().expect("an object").remove(without);
    Case::from_json(json.to_string().as_bytes()).expect("a case")
}

fn grid(axes: &[&str]) -> Grid {
    let axes = axes.iter().map(|axis| GridAxis::parse(axis).expect("an axis")).collect();
    Grid::new(axes).expect("a grid")
}

fn output_named(name: &str) -> OutputName {
    OutputName::named(name).expect("an output")
}

fn outputs(names: &[&str]) -> Vec<&'static Output> {
    let names: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
    Answers::select(Some(&names)).expect("outputs")
}

/// Returns all numeric outputs that the analyses calculate for a dry screw. Results of the warm
/// state are left out, and so are the loss in the ball returns and the modified life, which need a
/// lubricant.
fn all_columns() -> Vec<&'static Output> {
    let needs_lubricant =
        |kind: &AnalysisKind| matches!(kind, AnalysisKind::Warm | AnalysisKind::Band);
    let kinds = AnalysisKind::ALL.into_iter().filter(|kind| !needs_lubricant(kind));
    let columns = kinds.flat_map(AnalysisKind::columns);
    let oiled = [
        "return_torque_Nm",
        "drag_torque_Nm",
        "fatigue_load_limit_N",
        "modified_life_h",
        "modified_life_low_h",
        "modified_life_high_h",
    ];
    columns.filter(|column| !oiled.contains(&column.name)).collect()
}

fn solve(task: &Task, grid: &Grid) -> Answers {
    let mut source = GridSource::new(grid.clone());
    let columns = source.columns().clone();
    let chunk = source.next(grid.len()).expect("a grid can be read").expect("it has points");
    task.solve(&chunk, &columns)
}

fn has_same_bits(a: f64, b: Option<f64>) -> bool {
    a.to_bits() == b.unwrap_or(f64::NAN).to_bits()
}

/// A column with results of an analysis must be bit-identical to the results of the corresponding
/// command for the case of each row, even if a kernel calculates the other columns. If slip or
/// jamming columns are requested, `auto` must choose one model for all columns.
#[test]
fn table_columns_match_the_results_of_the_analyses() {
    let grid = grid(&["screw_speed_rpm=-3000,50,2500", "axial_load_N=2000,16000"]);
    let mut base = dong_case("");
    base.ball_gap_mm = Some(0.5);
    let mut work = ModelWorkspace::default();
    for settings in [
        Model::RacewayControl.into(),
        Model::Elastic.into(),
        Model::Traction.into(),
        Settings::default(),
    ] {
        let task =
            Task::over_grid(base.clone(), settings, all_columns(), None, &grid).expect("a task");
        let answers = solve(&task, &grid);
        let mut numbers_seen = 0;
        for row in 0..grid.len() {
            let case = grid.case(&base, &grid.point(row));
            let moving = MotionAnswer::of(&case, &settings, &mut work).expect("complete");
            assert_eq!(answers.outcomes[row].status, moving.solution.status());
            let solved = moving.solution.steady_state().is_some();
            let of = |kind: AnalysisKind| {
                let motion = solved.then_some(&moving);
                let numbers = kind.numbers(
                    &case,
                    &moving.settings,
                    motion,
                    |_| true,
                    &mut ModelWorkspace::default(),
                );
                (kind, numbers.expect("numbers"))
            };
            let numbers = AnalysisKind::ALL.map(of);
            for (output, column) in task.outputs.iter().zip(&answers.columns) {
                let kind = output.analysis().expect("of an analysis");
                let own = numbers.iter().find(|(other, _)| *other == kind);
                let expected = own.expect("all analyses").1.value(output);
                assert!(
                    has_same_bits(column[row], expected),
                    "{}: {} {expected:?}",
                    output.name,
                    column[row]
                );
                numbers_seen += usize::from(expected.is_some());
            }
        }
        // The table has six rows, each with about sixty numbers.
        assert!(numbers_seen > 300, "{settings:?}: {numbers_seen}");
    }
}

/// In an earlier version, `auto` chose the model of each row according to the error of the
/// efficiency. Between two loads, the wedge angle changed abruptly from 0.004 to 5.3 deg, which
/// falsely indicated jamming.
#[test]
fn motion_columns_use_one_model_for_all_rows() {
    let grid = grid(&["axial_load_N=2000:24000:12"]);
    let base = Case { friction_coefficient: Some(0.06), ..dong_case("") };
    let wanted = outputs(&["efficiency", "wedge_angle_deg", "published_margin"]);
    let task = Task::over_grid(base, Settings::default(), wanted, None, &grid).expect("a task");
    let answers = solve(&task, &grid);
    assert!(answers.outcomes.iter().all(|v| v.model == Model::Traction.into()), "one model");
    for column in &answers.columns[1..] {
        let steps: Vec<f64> = column.windows(2).map(|two| (two[1] / two[0]).ln().abs()).collect();
        // The largest changes occur in the first step, in which the load doubles. The jamming
        // margin grows slightly faster than the load, so it increases by a little more than a
        // factor of 2. The test permits changes by up to a factor of e.
        assert!(steps.iter().all(|step| *step < 1.0), "{column:?}");
    }
}

/// In an earlier version, rows of a vertical axis contained no results for the falling axis,
/// because only the axis sheet took the weight into account.
#[test]
fn table_rows_and_axis_sheet_agree_on_the_fall_speed() {
    let mut base = Case::from_json(AXIS).expect("a case");
    base.apply(&["inclination_deg=90", "moved_mass_kg=250"]).expect("settings");
    let grid = grid(&["axial_load_N=100,5000"]);
    for name in ["back_driving_torque_Nm", "fall_acceleration_m_s2", "fall_speed_rpm"] {
        let settings = Settings::default();
        let task = Task::over_grid(base.clone(), settings, outputs(&[name]), None, &grid);
        let answers = solve(&task.expect("a task"), &grid);
        for (row, load) in [100.0, 5000.0].into_iter().enumerate() {
            let case = Case { axial_load_N: Some(load), ..base.clone() };
            let number =
                AxisReport::of(&case, &settings).expect("a sheet").number(output_named(name));
            let number = number.expect("it falls");
            assert!(
                has_same_bits(answers.columns[0][row], Some(number)),
                "{name} at {load} N: {number}"
            );
        }
    }
}

/// If a table has warm-state columns, the results of the nut must belong to the same warm state, to
/// within the tolerance of the search for this state. A row must have no solution if its speed is
/// so high that no thermal steady state exists, regardless of which columns are requested.
#[test]
fn all_columns_of_a_row_use_the_same_warm_state() {
    let grid = grid(&["screw_speed_rpm=500,1500"]);
    let mut base = Case::from_json(FEED_AXIS).expect("a case");
    base.apply(&["preload_arrangement=X", "nut_conductance_W_K=20"]).expect("settings");
    let settings = Settings { control: Some(Control::Nut), ..Model::RacewayControl.into() };
    let columns = |names: &[&str]| {
        let task = Task::over_grid(base.clone(), settings, outputs(names), None, &grid);
        let answers = solve(&task.expect("a task"), &grid);
        assert_eq!(answers.outcomes[0].status, Status::Converged, "{names:?}");
        assert_eq!(answers.outcomes[1].status, Status::NoSolution, "{names:?}");
        answers.columns
    };
    let [nut, warm] = ["warm_preload_N", "nut_temperature_C"].map(|name| columns(&[name]));
    let both = columns(&["warm_preload_N", "nut_temperature_C"]);
    // In an earlier version, the warm case of a row was rejected because of a conductance that its
    // axis no longer used, and the axis was calculated without the warm state.
    let first = Case { screw_speed_rpm: Some(500.0), ..base.clone() };
    let sheet = AxisReport::of(&first, &settings).expect("a sheet");
    for name in ["screw_growth_um", "axis_heat_transfer_W_K", "screw_torque_Nm", "buckling_safety"]
    {
        assert!(
            has_same_bits(
                columns(&[name, "largest_load_N"])[0][0],
                sheet.number(output_named(name))
            ),
            "{name}"
        );
    }
    assert!((both[0][0] / nut[0][0] - 1.0).abs() < 1e-9, "{} {}", both[0][0], nut[0][0]);
    assert!(has_same_bits(both[1][0], Some(warm[0][0])) && both[0][1].is_nan(), "{both:?}");
}

/// In an earlier version, columns of the nut analysis were accepted for a nut without balls, and
/// the analysis then failed in every row.
#[test]
fn columns_of_a_nut_without_balls_are_rejected_before_solving() {
    let grid = grid(&["screw_speed_rpm=500,2500"]);
    let wanted = outputs(&["friction_torque_Nm"]);
    let base = dong_case("loaded_turns");
    let refused = Task::over_grid(base, Settings::default(), wanted, None, &grid);
    let error = refused.expect_err("no balls").to_string();
    assert!(
        error.starts_with("column friction_torque_Nm would be empty, because loaded_"),
        "{error}"
    );
}

/// Results of analyses are never calculated by a kernel. If they are requested, all other columns
/// must remain bit-identical.
#[test]
fn requesting_columns_of_an_analysis_does_not_change_other_columns() {
    let grid = grid(&["screw_speed_rpm=100:5000:20", "axial_load_N=500:20000:10"]);
    for model in [Model::QuasiStatic, Model::RacewayControl, Model::Rigid] {
        let task = |names: &[&str]| {
            Task::over_grid(dong_case(""), model.into(), outputs(names), None, &grid)
                .expect("a task")
        };
        let kernel = solve(&task(&["efficiency", "ball_torque_Nm"]), &grid);
        let analyzed = if model == Model::QuasiStatic {
            vec!["efficiency", "ball_torque_Nm", "rotary_to_linear_optimum_efficiency"]
        } else {
            vec!["efficiency", "ball_torque_Nm", "ball_return_margin", "nut_spin_power_W"]
        };
        let both = solve(&task(&analyzed), &grid);
        assert_eq!(both.outcomes, kernel.outcomes, "{model:?}");
        for (a, b) in both.columns.iter().zip(&kernel.columns) {
            assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()), "{model:?}");
        }
        let converged = kernel.outcomes.iter().map(|v| v.status == Status::Converged);
        assert!(both.columns[2].iter().zip(converged).all(|(x, there)| x.is_nan() != there));
    }
}

/// If a column cannot be calculated in any row, it must be rejected before the first row is solved.
/// The error must list the missing inputs.
#[test]
fn columns_that_cannot_be_calculated_in_any_row_are_rejected() {
    let grid = grid(&["screw_speed_rpm=100,200"]);
    for (without, model, column, words) in [
        ("return_angle_deg", "auto", "step_thrust_N", "because return_angle_deg is missing"),
        ("loaded_balls_per_turn", "auto", "jams", "loaded_balls_per_turn is missing"),
        ("axial_load_N", "auto", "nut_spin_slip_m_s", "axial_load_N is"),
        ("", "closed-form", "ball_slip_m_s", "closed-form does not calculate the motion"),
        ("friction_coefficient", "auto", "linear_to_rotary_efficiency", "friction_coefficient is"),
    ] {
        let settings = Settings::named(model, None, None).expect("a model");
        let (base, columns) = (dong_case(without), outputs(&[column]));
        let over = Task::over_grid(base.clone(), settings, columns.clone(), None, &grid);
        let error = over.expect_err("an empty column").to_string();
        assert!(error.contains(words), "{column}: {error}");
        let watched = Task::over_grid(base.clone(), settings, Vec::new(), Some(columns[0]), &grid);
        assert!(watched.is_err(), "{column}");
        let table =
            Columns::sort(["screw_speed_rpm"], &[], &TableFormat::default()).expect("an input");
        let error =
            Task::over_table(base, settings, columns, &table).expect_err("empty").to_string();
        assert!(error.contains(words), "{column}: {error}");
    }
    // One of two alternative inputs is given, which is sufficient to calculate the margin.
    let columns = outputs(&["ball_return_margin"]);
    Task::over_grid(dong_case("apex_half_angle_deg"), Settings::default(), columns, None, &grid)
        .expect("the step is left");
}

/// An output that does not depend on the motion must not require an operating point. The message of
/// a row must name the required inputs that are missing.
#[test]
fn output_that_depends_only_on_inputs_needs_no_operating_point() {
    let base = Case::from_json(br#"{"lead_angle_deg": 5}"#).expect("a case");
    let columns =
        Columns::sort(["friction_coefficient"], &[], &TableFormat::default()).expect("an input");
    let task = outputs(&["rotary_to_linear_optimum_contact_angle_deg"]);
    let task = Task::over_table(base, Settings::default(), task, &columns).expect("a task");
    let chunk = Chunk::of_rows(&columns, [[Some(0.075)], [None]]);
    let answers = task.solve(&chunk, &columns);
    assert_eq!(answers.outcomes[0].status, Status::Converged);
    assert!(answers.columns[0][0] > 5.0 && answers.columns[0][1].is_nan());
    assert_eq!(answers.outcomes[1].status, Status::InvalidInput);
    let words = answers.message(1).expect("words");
    assert!(words.contains("friction_coefficient is required"), "{words}");
}

/// Warm-state columns must depend on the conductances of each row. For an unloaded nut pair in X
/// arrangement at 1000 rpm, the results must agree with an independent solution whose results are
/// rounded to whole newtons. A column for a single ball must use the lubricant temperature of the
/// warm state.
#[test]
fn warm_state_columns_depend_on_the_conductances_of_the_row() {
    let axis = include_str!("../../../../validation/published/nut/feed_axis.json");
    let mut base = Case::from_json(axis.as_bytes()).expect("a case");
    let cycle = r#"cycle=[{"share": 1, "screw_speed_rpm": 1000, "force_N": 0}]"#;
    base.apply(&["preload_arrangement=X", cycle]).expect("settings");
    let settings = Settings { control: Some(Control::Nut), ..Model::RacewayControl.into() };
    let grid = grid(&["nut_conductance_W_K=5,8,12,20"]);
    let names = ["warm_preload_N", "nut_temperature_C", "lubricant_temperature_C"];
    let task =
        Task::over_grid(base.clone(), settings, outputs(&names), None, &grid).expect("a task");
    let answers = solve(&task, &grid);
    for (row, expected) in [2872.0, 3850.0, 5034.0, 7443.0].into_iter().enumerate() {
        let [preload, nut, oil] = [0, 1, 2].map(|column: usize| answers.columns[column][row]);
        assert!((preload - expected).abs() < 0.6, "{preload}, not {expected}");
        assert!(nut > 20.0 && oil > nut, "{nut} {oil}");
    }
    // The speed of this row is above the fold, which is at 874 rpm, so the row has no warm state.
    let one = self::grid(&["nut_conductance_W_K=40"]);
    let task = Task::over_grid(base, settings, outputs(&names[..1]), None, &one).expect("a task");
    let answers = solve(&task, &one);
    assert_eq!(answers.outcomes[0].status, Status::NoSolution);
    assert!(answers.columns[0][0].is_nan());
}

/// If the push forces between the balls exceed the valid range of the ball-train model, a row must
/// contain all results that are still valid, and a message with the reason why other results are
/// missing.
#[test]
fn row_message_explains_why_torque_is_missing_at_large_push_forces() {
    let file: serde_json::Value = serde_json::from_str(BALL_TRAIN).expect("JSON");
    let case = file["cases"][1]["case"].to_string();
    let base = Case::from_json(case.as_bytes()).expect("a case");
    // The largest ball load is 190 N, so the ball-train model is not valid for a push force of 6 N.
    let grid = grid(&["return_push_N=0:6:2"]);
    let outputs = outputs(&["friction_torque_Nm", "needed_gap_mm", "max_contact_load_N"]);
    let task = Task::over_grid(base, Settings::default(), outputs, None, &grid).expect("a task");
    let answers = solve(&task, &grid);
    let row = |row: usize| answers.columns.iter().map(move |column| column[row].is_finite());
    assert!(row(0).all(|is_there| is_there));
    assert_eq!(row(1).collect::<Vec<_>>(), [false, true, true]);
    let [(1, message)] = &answers.messages[..] else { panic!("{:?}", answers.messages) };
    assert!(message.starts_with(
        "nut: The friction torque with push forces between the balls is not calculated: a push"
    ));
    assert!(answers.outcomes.iter().all(|outcome| outcome.status == Status::Converged));
}

/// If a table has a column named `model`, the inputs in this table must still be read. Columns
/// after the status columns are outputs, even if one of them has the name of an input.
#[test]
fn columns_after_the_status_columns_of_earlier_results_are_not_read_as_inputs() {
    let inputs = |names: &[&str]| {
        let columns = Columns::sort(names.iter().copied(), &[], &TableFormat::default())
            .expect("known names");
        columns.inputs.iter().map(|key| key.name()).collect::<Vec<_>>()
    };
    let temperature = "lubricant_temperature_C";
    assert_eq!(inputs(&["model", temperature]), [temperature]);
    assert!(inputs(&["model", "status", "message", temperature]).is_empty());
}

/// A column with the name of a result is not read, and a note names this column. In an earlier
/// version, such columns were ignored without a note.
#[test]
fn note_lists_the_ignored_columns() {
    let note = |names: &[&str]| {
        let columns = Columns::sort(names.iter().copied(), &[], &TableFormat::default());
        columns.expect("known names").ignored_note()
    };
    assert_eq!(note(&["axial_load_N", "lead_mm"]), None);
    let some = note(&["axial_load_N", "efficiency", "nut_stiffness_N_um"]).expect("a note");
    assert!(some.ends_with("ignored: efficiency, nut_stiffness_N_um."), "{some}");
    let many = ["model", "status", "message", "efficiency", "ball_torque_Nm", "skid_number"];
    let many = note(&many).expect("a note");
    assert!(many.ends_with("ignored: model, status, message, efficiency, 2 more."), "{many}");
}
