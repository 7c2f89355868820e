//! Comparison of the vectorized kernels with the scalar models at random points, using fixed seeds.

use crate::alike;

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64};

use arrow_array::Float64Array;
use bsm_batch::{Answers, Buffers, Cell, Chunk, Columns, TableFormat, Task};
use bsm_case::{Case, InputKey, ModelChoice, Output, Record, Settings, output};
use bsm_dyn::{Control, Model, ModelWorkspace, Status, model::RacewayFriction};
use bsm_kernels::{InputColumn, InputColumns, Rows, Selection};
use bsm_sample::{Sample, campaign};
use bsm_simd::Arch;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use alike::assert_alike;

const INPUTS: [&str; 16] = [
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "ball_diameter_mm",
    "pitch_circle_diameter_mm",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
    "loaded_balls",
    "nut_conformity",
    "screw_conformity",
    "density_kg_m3",
    "youngs_modulus_GPa",
    "poisson_ratio",
    "ball_youngs_modulus_GPa",
    "ball_poisson_ratio",
];

/// Returns random points in the practical range and slightly outside it. The screw, the nut, or
/// both of them are driven in either direction.
fn points(count: usize) -> (Chunk, Columns) {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut elastic = ChaCha8Rng::seed_from_u64(7);
    let row = |_| {
        let mut rpm = || {
            let size = rng.log_uniform(1.0, 3e4);
            if rng.random_bool(0.5) { size } else { -size }
        };
        let speeds = (rpm(), rpm());
        let (screw, nut) = match rng.random_range(0..3) {
            0 => (speeds.0, 0.0),
            1 => (0.0, speeds.1),
            _ => speeds,
        };
        let pitch = rng.random_range(8.0..100.0);
        [
            rng.random_range(1.0..45.0),
            rng.random_range(20.0..75.0),
            rng.log_uniform(1e-3, 0.2),
            pitch * rng.random_range(0.05..0.25),
            pitch,
            screw,
            nut,
            rng.log_uniform(10.0, 1e5),
            rng.random_range(1.0..200.0),
            elastic.random_range(0.51..0.56),
            elastic.random_range(0.51..0.56),
            elastic.random_range(3000.0..8000.0),
            elastic.random_range(150.0..250.0),
            elastic.random_range(0.2..0.4),
            elastic.random_range(150.0..350.0),
            elastic.random_range(0.2..0.4),
        ]
        .map(Cell::Number)
    };
    let columns = Columns::sort(INPUTS, &[], &TableFormat::default()).expect("known names");
    (Chunk::of_rows(&columns, (0..count).map(row)), columns)
}

fn case(names: &[&str], chunk: &Chunk, base: &Case, row: usize) -> Case {
    let mut case = base.clone();
    for (name, column) in names.iter().zip(&chunk.inputs) {
        case.set(name, column.value(row)).expect("known name");
    }
    case
}

fn solve_alone(case: &Case, settings: &Settings) -> Record {
    match case.problem(settings) {
        Ok(problem) => Record::new(problem.solve(&mut ModelWorkspace::default())),
        Err(error) => Record::invalid(settings.model, &error),
    }
}

fn all_outputs() -> Vec<&'static Output> {
    Answers::select(None).expect("all outputs")
}

/// Compares all outputs of a kernel and of its model at random points. Outputs must agree to within
/// 1e-10 of their value plus an absolute tolerance.
fn compare_kernel_with_model(settings: &Settings, count: usize) {
    compare_kernel_with_model_at(settings, &Case::default(), &INPUTS, &points(count));
}

/// Compares a kernel and its model like [`compare_kernel_with_model`], but at the given points. The
/// kernel must solve at least some of the rows. All other rows are solved by the model, so a
/// comparison of these rows tests nothing.
fn compare_kernel_with_model_at(
    settings: &Settings,
    base: &Case,
    names: &[&str],
    table: &(Chunk, Columns),
) {
    let of_kernel = assert_rows(settings, base, names, table);
    assert!(of_kernel > 0, "the kernel solves none of the rows that converge");
}

/// Compares all outputs of a kernel and of its model at all points. Returns the number of rows that
/// the kernel has solved.
fn assert_rows(
    settings: &Settings,
    base: &Case,
    names: &[&str],
    table: &(Chunk, Columns),
) -> usize {
    let ((chunk, columns), outputs, count) = (table, all_outputs(), table.0.len);
    let task = Task::new(base.clone(), *settings, outputs.clone());
    let answers = task.solve(chunk, columns);
    let by_kernel = solved_by_kernel(settings, base, (chunk, columns));
    let (mut converged, mut of_kernel) = (0, 0);
    for (row, by_kernel) in by_kernel.into_iter().enumerate() {
        let case = case(names, chunk, base, row);
        let expected = solve_alone(&case, settings);
        let what = || format!("row {row}");
        let has_root = assert_alike(&what, (&answers, row), &outputs, (&expected, &case));
        assert_eq!(answers.outcomes[row].model, expected.model(), "{}", what());
        let words = expected.message().map(str::to_owned).or_else(|| expected.choice());
        assert_eq!(answers.message(row), words.as_deref(), "{}", what());
        converged += usize::from(has_root);
        of_kernel += usize::from(has_root && by_kernel);
    }
    assert!(converged > count / 4, "{converged} of {count} rows converge");
    of_kernel
}

#[test]
fn closed_form_kernel_matches_the_scalar_solver() {
    compare_kernel_with_model(&Model::ClosedForm.into(), 4000);
}

#[test]
fn quasi_static_kernel_matches_the_scalar_solver() {
    compare_kernel_with_model(&Model::QuasiStatic.into(), 4000);
}

#[test]
fn rigid_kernel_matches_the_scalar_solver() {
    compare_kernel_with_model(&Model::Rigid.into(), campaign(20_000));
}

/// The controlling raceway is either given or determined by the model. The kernel solves five out
/// of six points. At the remaining points, which it leaves to the model, the inertia forces are as
/// large as the load.
#[test]
fn raceway_control_kernel_matches_the_scalar_solver() {
    for control in [None, Some(Control::Nut), Some(Control::Screw)] {
        compare_kernel_with_model(&Settings { control, ..Model::RacewayControl.into() }, 3000);
    }
}

/// The friction is calculated either at every point of a contact, or with one friction coefficient
/// per contact. The lubricant temperature differs from row to row, and all losses outside the
/// contacts are included.
#[test]
fn lubricated_raceway_control_kernel_matches_the_scalar_solver() {
    const COUNT: usize = 3000;
    let base = br#"{"iso_vg": 68, "ball_roughness_um": 0.02, "nut_roughness_um": 0.1,
        "screw_roughness_um": 0.08, "hysteresis_loss": 0.007, "seal_torque_Nm": 0.05,
        "ball_contact_force_N": 2, "return_circuits": 3, "return_loss_coefficient": 0.5,
        "drag_coefficient": 0.5}"#;
    let base = Case::from_json(base).expect("case");
    let (mut chunk, _) = points(COUNT);
    let (mut names, mut rng) = (INPUTS, ChaCha8Rng::seed_from_u64(10));
    let place = names.iter().position(|name| *name == "friction_coefficient").expect("known");
    names[place] = "lubricant_temperature_C";
    chunk.inputs[place] =
        Float64Array::from_iter_values((0..COUNT).map(|_| rng.random_range(0.0..90.0)));
    let columns = Columns::sort(names, &[], &TableFormat::default()).expect("known names");
    for friction in [RacewayFriction::Local, RacewayFriction::PerContact] {
        let settings = Settings { friction, ..Model::RacewayControl.into() };
        compare_kernel_with_model_at(&settings, &base, &names, &(chunk.clone(), columns.clone()));
    }
}

#[test]
fn elastic_kernel_matches_the_scalar_solver() {
    compare_kernel_with_model(&Model::Elastic.into(), 4000);
}

/// The points are taken from `validation/hard`, where some points have several solutions.
#[test]
fn difficult_points_have_the_same_root_in_tables_and_single_solves() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/hard/solved");
    let case = |entry: Result<fs::DirEntry, _>| Case::read(&entry.expect("entry").path());
    let cases: Vec<_> = fs::read_dir(folder).expect("cases").map(case).collect();
    assert!(cases.len() >= 14);
    let (settings, outputs) =
        (Model::Traction.into(), [Output::named("efficiency").expect("known")]);
    for case in cases {
        let case = case.expect("a complete case");
        let alone = solve_alone(&case, &settings).number(output!(efficiency)).expect("solved");
        let given = InputKey::ALL.into_iter().filter(|key| case[*key].is_some());
        let names: Vec<_> = given.map(InputKey::name).collect();
        let columns = Columns::sort(names, &[], &TableFormat::default()).expect("known names");
        let row = columns.inputs.iter().map(|key| case[*key]);
        let chunk = Chunk::of_rows(&columns, [row]);
        let answers =
            Task::new(Case::default(), settings, outputs.to_vec()).solve(&chunk, &columns);
        // Kernels agree with the scalar models to within a relative difference of 1e-10.
        let in_table = answers.columns[0][0];
        assert!((in_table - alone).abs() <= 1e-10 * alone.abs(), "{case:?}: {in_table} {alone}");
    }
}

/// The model that `auto` chooses, its error bound and the stated reason must be the same in a
/// kernel and in the scalar solver.
#[test]
fn auto_chooses_the_same_model_in_kernel_and_scalar_solver() {
    for tolerance in [1e-1, 1e-2] {
        compare_kernel_with_model(&Settings { tolerance, ..auto_settings() }, campaign(1000));
    }
    // With this tolerance, only model `traction`, which has no kernel, is accurate enough.
    let accurate = Settings { tolerance: 1e-6, ..auto_settings() };
    let points = points(campaign(1000));
    assert_eq!(assert_rows(&accurate, &Case::default(), &INPUTS, &points), 0);
}

fn auto_settings() -> Settings {
    Settings { model: ModelChoice::Auto, ..Model::Traction.into() }
}

/// Returns settings for each model and for `auto`.
fn all_settings() -> impl Iterator<Item = Settings> {
    Model::ALL.into_iter().map(Settings::from).chain([auto_settings()])
}

/// Returns as many points as a test can solve with the given model in a short time. In a test
/// build, solving one point with `traction` takes as long as solving a hundred points with another
/// model.
fn sufficient_points(settings: &Settings, count: usize) -> (Chunk, Columns) {
    let is_slow = matches!(settings.model, ModelChoice::Auto | ModelChoice::Fixed(Model::Traction));
    points(if is_slow { count / 16 } else { count })
}

/// Returns rows `first` to `last - 1` of a chunk.
fn rows_of_chunk(chunk: &Chunk, first: usize, last: usize) -> Chunk {
    Chunk { first: first as u64 + 1, ..chunk.select(&(first..last).collect::<Vec<_>>()) }
}

/// Returns the status of each row and the bits of all its outputs.
fn status_and_bits(answers: &Answers) -> Vec<(String, Vec<u64>)> {
    let rows = answers.outcomes.iter().enumerate();
    rows.map(|(row, outcome)| {
        let numbers = answers.columns.iter().map(|column| column[row].to_bits());
        (format!("{outcome:?} {:?}", answers.message(row)), numbers.collect())
    })
    .collect()
}

/// The results must be bit-identical for all instruction sets, chunk sizes and numbers of threads.
#[test]
fn results_do_not_depend_on_chunks_threads_or_instruction_set() {
    for settings in all_settings() {
        // The table has more rows than two threads take at a time.
        let (model, (chunk, columns)) =
            (settings.model, sufficient_points(&settings, campaign(10_000)));
        let task = Task::new(Case::default(), settings, all_outputs());
        let expected = status_and_bits(&task.solve(&chunk, &columns));
        for arch in bsm_simd::instruction_sets() {
            let found = task.solve_on(arch, &chunk, &columns);
            assert!(status_and_bits(&found) == expected, "{arch:?}, {model:?}");
        }
        for size in [7, 300, 3000] {
            let mut found = Vec::new();
            for first in (0..chunk.len).step_by(size) {
                let part = rows_of_chunk(&chunk, first, chunk.len.min(first + size));
                found.extend(status_and_bits(&task.solve(&part, &columns)));
            }
            assert!(found == expected, "chunks of {size}, {model:?}");
        }
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let found = pool.expect("threads").install(|| task.solve(&chunk, &columns));
            assert!(status_and_bits(&found) == expected, "{threads} threads, {model:?}");
        }
    }
}

/// Returns, for each row, whether the kernel solves the row. The model solves all other rows.
fn solved_by_kernel(
    settings: &Settings,
    base: &Case,
    (chunk, columns): (&Chunk, &Columns),
) -> Vec<bool> {
    let rows = 0..chunk.len;
    let cases: Vec<_> =
        rows.map(|row| chunk.case(columns, base, row).expect("known inputs")).collect();
    let inputs = InputKey::ALL.map(|key| {
        let values: Option<Vec<_>> = cases.iter().map(|case| case.value_or_default(key)).collect();
        values.map_or(InputColumn::Absent, |values| {
            InputColumn::Column(key.input().rule, values.into())
        })
    });
    let lubricant = base.lubricant_but_for_temperature(columns.set());
    let lubricant = lubricant.map(|lubricant| (lubricant, settings.friction));
    let mut done = vec![false; cases.len()];
    let (inputs, wanted) = (&InputColumns::new(inputs, lubricant), &Selection::of(&[]));
    let rows = Rows { inputs, wanted, first: 0, columns: &mut [], done: &mut done };
    rows.solve(Arch::new(), settings.model, settings);
    done
}

/// Returns the number of solvable rows that the kernel leaves to the model, and the number of all
/// solvable rows.
fn count_rows_left_to_the_model(
    settings: &Settings,
    base: &Case,
    (chunk, columns): (&Chunk, &Columns),
) -> (usize, usize) {
    let (mut left, mut with_root) = (0, 0);
    for (row, done) in solved_by_kernel(settings, base, (chunk, columns)).into_iter().enumerate() {
        let case = chunk.case(columns, base, row).expect("known inputs");
        if solve_alone(&case, settings).status() == Status::Converged {
            with_root += 1;
            left += usize::from(!done);
        }
    }
    (left, with_root)
}

/// The kernel must solve nearly all points that have a solution, because the speed of tables
/// depends on it. The model solves the remaining points with Newton's method.
#[test]
fn kernels_solve_nearly_all_points_that_have_a_root() {
    const COUNT: usize = 10_000;
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    let base = br#"{"pitch_circle_diameter_mm": 48.6, "ball_diameter_mm": 8.74, "nut_speed_rpm": 0,
        "loaded_balls": 1}"#;
    let base = Case::from_json(base).expect("case");
    let ranges = [
        ("lead_angle_deg", 10.0..45.0),
        ("contact_angle_deg", 30.0..70.0),
        ("friction_coefficient", 0.01..0.1),
        ("screw_speed_rpm", -6000.0..6000.0),
        ("axial_load_N", 20.0..3000.0),
    ];
    let names = ranges.each_ref().map(|(name, _)| *name);
    let columns = Columns::sort(names, &[], &TableFormat::default()).expect("known names");
    let row = |_| ranges.each_ref().map(|(_, range)| Cell::Number(rng.random_range(range.clone())));
    let chunk = Chunk::of_rows(&columns, (0..COUNT).map(row));
    let (left, solved) =
        count_rows_left_to_the_model(&Model::Rigid.into(), &base, (&chunk, &columns));
    assert!(solved > COUNT / 2, "{solved}");
    assert!(left * 200 < solved, "{left} of {solved} points are left to Newton");
}

/// If the caller provides no buffer for an output, the values of this output are returned
/// separately. If the output has no values, nothing is returned for it.
#[test]
fn outputs_for_which_the_caller_provides_no_buffer_are_returned_separately() {
    for settings in all_settings() {
        // The table has more rows than a thread takes at a time.
        let (model, (chunk, columns)) =
            (settings.model, sufficient_points(&settings, campaign(20_000)));
        let task = Task::new(Case::default(), settings, all_outputs());
        let expected = task.solve(&chunk, &columns);
        let mut outcomes = expected.outcomes.clone();
        let buffers = Buffers {
            outcomes: &mut outcomes,
            columns: all_outputs().iter().map(|_| None).collect(),
        };
        let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
        let told = task.solve_into((&chunk, &columns), buffers, &stop, &done);
        let mut found = vec![vec![f64::NAN; chunk.len]; all_outputs().len()];
        for (place, first, values) in told.values {
            assert!(!values.iter().all(|value| value.is_nan()), "{model:?}");
            found[place][first..][..values.len()].copy_from_slice(&values);
        }
        assert_eq!((outcomes, told.messages), (expected.outcomes, expected.messages), "{model:?}");
        for (output, (found, expected)) in
            all_outputs().iter().zip(found.iter().zip(&expected.columns))
        {
            let same =
                |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
            assert!(found.iter().zip(expected).all(same), "{}, {model:?}", output.name);
        }
    }
}

/// The values of an output must not depend on which other outputs are requested.
#[test]
fn output_values_do_not_depend_on_other_requested_outputs() {
    let (base, everything) = (Case::default(), all_outputs());
    for settings in all_settings() {
        let (model, (chunk, columns)) =
            (settings.model, sufficient_points(&settings, campaign(500)));
        let task = |outputs| Task::new(base.clone(), settings, outputs);
        let expected = task(everything.clone()).solve(&chunk, &columns);
        for (output, column) in everything.iter().zip(&expected.columns) {
            let found = task(vec![output]).solve(&chunk, &columns);
            let same = found.columns[0].iter().zip(column).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same && found.outcomes == expected.outcomes, "{}, {model:?}", output.name);
        }
    }
}

/// A row with an invalid value, a missing value or a text must keep its position between valid
/// rows, and must report an error. A lead in a row replaces the lead angle of the base case.
#[test]
fn invalid_rows_keep_their_position_and_are_reported() {
    let base = Case::from_json(
        br#"{"pitch_circle_diameter_mm": 48.6, "lead_angle_deg": 12, "contact_angle_deg": 45,
             "friction_coefficient": 0.075, "screw_speed_rpm": 2000, "axial_load_N": 2113,
             "loaded_balls": 1}"#,
    )
    .expect("case");
    let columns = Columns::sort(
        ["ball_diameter_mm", "lead_mm", "nut_speed_rpm"],
        &[],
        &TableFormat::default(),
    );
    let columns = columns.expect("known names");
    let number = Cell::Number;
    let rows = [
        ([number(8.74), number(30.0), number(0.0)], "converged", ""),
        ([number(-8.74), number(30.0), number(0.0)], "invalid_input", "`ball_diameter_mm` = -8.74"),
        ([number(8.74), Cell::Text("wide"), number(0.0)], "invalid_input", "lead_mm"),
        ([number(8.74), number(f64::NAN), number(0.0)], "invalid_input", "`lead_mm` = NaN"),
        ([number(30.0), number(30.0), number(0.0)], "invalid_input", "30"),
        ([Cell::Missing, number(30.0), number(0.0)], "invalid_input", "ball_diameter_mm"),
        ([number(8.74), number(30.0), number(2000.0)], "invalid_input", "nut_speed_rpm"),
        ([number(8.74), number(30.0), Cell::Missing], "converged", ""),
        // If the lead is missing in a row, the lead angle of the base case is used.
        ([number(8.74), Cell::Missing, number(0.0)], "converged", ""),
        ([number(8.74), number(10.0), number(0.0)], "no_solution", "rolls on the nut"),
    ];
    let chunk = Chunk::of_rows(&columns, rows.iter().map(|(cells, ..)| cells.clone()));
    let efficiency = Output::named("efficiency").expect("known name");
    let task = Task::new(base, Model::Rigid.into(), vec![efficiency]);
    let answers = task.solve(&chunk, &columns);
    for (row, (cells, status, words)) in rows.iter().enumerate() {
        let (outcome, value) = (answers.outcomes[row], answers.columns[0][row]);
        assert_eq!(outcome.status.name(), *status, "{cells:?} {outcome:?}");
        assert_eq!(value.is_nan(), *status != "converged", "{cells:?}");
        let message = answers.message(row).unwrap_or_default();
        assert!(message.contains(words), "{cells:?}: {message}");
    }
    assert_eq!(answers.columns[0][0].to_bits(), answers.columns[0][7].to_bits());
}
