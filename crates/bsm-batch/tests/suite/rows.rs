//! Tests that a table row gives the same result as `bsm solve --set` with the values of this row.

use crate::alike;

use bsm_batch::{Answers, Cell, Chunk, Columns, CsvSource, Source, TableFormat, Task};
use bsm_case::units::{UnitChange, other_units};
use bsm_case::{Case, InputKey, ModelChoice, Record, Settings};
use bsm_dyn::{Model, ModelWorkspace, Status, model::RacewayFriction};
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use alike::assert_alike;

const DRIVE: &str = include_str!("../../../../examples/feed_drive.json");

fn drive() -> Case {
    Case::from_json(DRIVE.as_bytes()).expect("an example")
}

/// A table that consists of input cells.
struct Table {
    keys: Vec<InputKey>,
    rows: Vec<Vec<Cell<'static>>>,
}

impl Table {
    fn solve(&self, base: &Case, settings: &Settings) -> Answers {
        let columns =
            Columns::sort(self.keys.iter().map(|key| key.name()), &[], &TableFormat::default());
        let columns = columns.expect("inputs, each once");
        let chunk = Chunk::of_rows(&columns, self.rows.iter().cloned());
        let outputs = Answers::select(None).expect("all outputs");
        let task = Task::new(base.clone(), *settings, outputs);
        task.solve(&chunk, &columns)
    }

    /// Returns the cells of a row in the form in which `--set` accepts them.
    fn assignments(&self, row: usize) -> Vec<String> {
        let word = |(key, cell): (&InputKey, &Cell)| match cell {
            Cell::Number(value) => Some(format!("{}={value}", key.name())),
            Cell::Text(text) => Some(format!("{}={text}", key.name())),
            _ => None,
        };
        self.keys.iter().zip(&self.rows[row]).filter_map(word).collect()
    }

    /// Compares every row of the table with a single solve of the same point, and counts the
    /// converged rows.
    fn assert_solved(&self, base: &Case, settings: &Settings, seen: &mut Tally) {
        let outputs = Answers::select(None).expect("all outputs");
        let answers = self.solve(base, settings);
        for row in 0..self.rows.len() {
            let words = self.assignments(row);
            let what = || format!("{} {words:?} on {base:?}", settings.model.name());
            let mut case = base.clone();
            let asked = case.apply(&words).and_then(|()| {
                assert_eq!(
                    format!("{case:?}"),
                    format!("{:?}", self.case_built_by_hand(base, row))
                );
                case.problem(settings)
            });
            let expected = match asked {
                Ok(problem) => Record::new(problem.solve(&mut seen.work)),
                Err(error) => Record::invalid(settings.model, &error),
            };
            let message = expected.message().map(str::to_owned).or_else(|| expected.choice());
            assert_eq!(answers.message(row), message.as_deref(), "{}", what());
            assert_eq!(answers.outcomes[row].model, expected.model(), "{}", what());
            assert_alike(&what, (&answers, row), &outputs, (&expected, &case));
            seen.count_record(&expected);
        }
    }

    /// Builds the case of a row without using the tested code.
    fn case_built_by_hand(&self, base: &Case, row: usize) -> Case {
        let mut case = base.clone();
        let cells = || self.keys.iter().zip(&self.rows[row]);
        let leads = [InputKey::lead_angle_deg, InputKey::lead_mm];
        if cells().any(|(key, cell)| leads.contains(key) && *cell != Cell::Missing) {
            (case.lead_angle_deg, case.lead_mm) = (None, None);
        }
        for (key, cell) in cells() {
            if let Cell::Number(value) = cell {
                case[*key] = Some(*value);
            }
        }
        case
    }
}

/// Row counts of a test campaign.
#[derive(Default)]
struct Tally {
    work: ModelWorkspace,
    converged: Vec<(ModelChoice, usize)>,
    unsolved: usize,
    /// Parts of messages about invalid rows, each with the number of rows whose message contains
    /// this part.
    invalid: [(&'static str, usize); 6],
}

impl Tally {
    fn count_record(&mut self, record: &Record) {
        match record.status() {
            Status::Converged => {
                match self.converged.iter_mut().find(|(model, _)| *model == record.model()) {
                    Some((_, count)) => *count += 1,
                    None => self.converged.push((record.model(), 1)),
                }
            }
            Status::InvalidInput => {
                let message = record.message().unwrap_or_default();
                for (part, count) in &mut self.invalid {
                    *count += usize::from(message.contains(*part));
                }
            }
            _ => self.unsolved += 1,
        }
    }
}

/// A table has a column for the lead and a column for the lead angle. In an earlier version, a row
/// with a value in only one of the two columns was solved with the value of the base case.
#[test]
fn row_with_a_value_in_only_one_of_two_lead_columns_uses_this_value() {
    let table = Table {
        keys: vec![InputKey::lead_angle_deg, InputKey::lead_mm],
        rows: vec![
            vec![Cell::Number(6.0), Cell::Missing],
            vec![Cell::Missing, Cell::Number(10.0)],
            vec![Cell::Missing, Cell::Missing],
        ],
    };
    let mut angle = drive();
    angle.apply(&["lead_angle_deg=8.7"]).expect("known name");
    for base in [drive(), angle] {
        for choice in model_choices() {
            let settings = Settings { model: choice, ..Settings::default() };
            table.assert_solved(&base, &settings, &mut Tally::default());
        }
    }
    let answers = table.solve(&drive(), &Model::RacewayControl.into());
    // The expected value has the digits that `bsm solve --set lead_angle_deg=6 --model
    // raceway-control` prints.
    assert!((answers.columns[0][0] - 0.984_594).abs() < 5e-7, "{}", answers.columns[0][0]);
}

/// A row with both lead and lead angle must be treated like a case with both inputs: it is solved
/// if they agree, and rejected if they contradict each other.
#[test]
fn a_row_with_contradictory_lead_and_lead_angle_is_rejected() {
    let agreeing = 41.5 * std::f64::consts::PI * 6.0_f64.to_radians().tan();
    let row = |lead| vec![Cell::Number(6.0), Cell::Number(lead)];
    let table = Table {
        keys: vec![InputKey::lead_angle_deg, InputKey::lead_mm],
        rows: vec![row(agreeing), row(20.0)],
    };
    for model in Model::ALL {
        let answers = table.solve(&drive(), &model.into());
        let [agree, disagree] = [0, 1].map(|row| answers.outcomes[row].status);
        assert_ne!(agree, Status::InvalidInput, "{model:?}");
        assert_eq!(disagree, Status::InvalidInput, "{model:?}");
        let message = answers.message(1).unwrap_or_default();
        assert!(message.contains("lead_mm = 20 disagree"), "{model:?}: {message}");
        table.assert_solved(&drive(), &model.into(), &mut Tally::default());
    }
}

/// The library must check the solver settings, because not all callers use the command-line
/// program.
#[test]
fn settings_out_of_range_are_rejected_by_every_model() {
    let table = Table {
        keys: vec![InputKey::axial_load_N],
        rows: vec![vec![Cell::Number(5000.0)], vec![Cell::Missing]],
    };
    for model in model_choices() {
        let good = Settings { model, ..Settings::default() };
        for (settings, part) in [
            (Settings { accuracy: 0.1, ..good }, "`accuracy` = 0.1 must be from"),
            (Settings { creep: 0.0, ..good }, "`creep` = 0 must be a finite number > 0"),
            (Settings { tolerance: f64::NAN, ..good }, "`tolerance` = NaN must be"),
        ] {
            let error = drive().problem(&settings).expect_err(part).to_string();
            assert!(error.contains(part), "{error}");
            table.assert_solved(&drive(), &settings, &mut Tally::default());
        }
    }
}

fn model_choices() -> impl Iterator<Item = ModelChoice> {
    Model::ALL.into_iter().map(ModelChoice::from).chain([ModelChoice::Auto])
}

/// Returns one of a few practical values of an input. There are only a few values, so that rows
/// often contain special combinations: equal speeds, a lead that agrees with the lead angle, drives
/// in which both parts turn, balls that do not fit, and zero friction.
fn practical_value(key: InputKey, rng: &mut impl Rng) -> f64 {
    use InputKey as K;
    let lead = |pitch: f64, deg: f64| pitch * std::f64::consts::PI * deg.to_radians().tan();
    let values: &[f64] = match key {
        K::ball_diameter_mm => &[3.0, 6.35, 6.35, 8.0, 8.0, 22.0],
        K::pitch_circle_diameter_mm => &[41.5, 41.5, 48.6],
        K::lead_angle_deg => &[9.0, 9.0, 30.0],
        K::lead_mm => &[lead(41.5, 9.0), lead(41.5, 9.0), lead(48.6, 9.0), lead(41.5, 30.0)],
        K::contact_angle_deg => &[30.0, 45.0, 60.0],
        K::nut_conformity | K::screw_conformity => &[0.52, 0.54],
        K::friction_coefficient => &[0.0, 0.01, 0.06, 0.06, 0.2],
        K::rolling_friction_mm => &[0.0, 0.005],
        K::density_kg_m3 => &[7800.0, 3200.0],
        K::youngs_modulus_GPa | K::ball_youngs_modulus_GPa => &[207.0, 310.0],
        K::poisson_ratio | K::ball_poisson_ratio => &[0.3, 0.26],
        K::screw_speed_rpm => &[0.0, 500.0, -500.0, 1500.0],
        K::nut_speed_rpm => &[0.0, 0.0, 0.0, 500.0, -1200.0],
        K::axial_load_N => &[100.0, 8000.0],
        K::loaded_balls => &[1.0, 70.0],
        _ => &[2000.0],
    };
    *values.choose(rng).expect("some values")
}

/// Inputs that at least one model uses, and one input that no model uses.
const KEYS: [InputKey; 19] = [
    InputKey::lead_angle_deg,
    InputKey::lead_mm,
    InputKey::contact_angle_deg,
    InputKey::friction_coefficient,
    InputKey::ball_diameter_mm,
    InputKey::pitch_circle_diameter_mm,
    InputKey::screw_speed_rpm,
    InputKey::nut_speed_rpm,
    InputKey::axial_load_N,
    InputKey::loaded_balls,
    InputKey::nut_conformity,
    InputKey::screw_conformity,
    InputKey::rolling_friction_mm,
    InputKey::density_kg_m3,
    InputKey::youngs_modulus_GPa,
    InputKey::poisson_ratio,
    InputKey::ball_youngs_modulus_GPa,
    InputKey::ball_poisson_ratio,
    InputKey::raceway_yield_strength_MPa,
];

fn cell(key: InputKey, rng: &mut impl Rng) -> Cell<'static> {
    const WRONG: [f64; 8] = [f64::NAN, f64::INFINITY, 0.0, -1.0, 90.0, 1e-300, 1e300, 0.5];
    match rng.random_range(0..100) {
        0..25 => Cell::Missing,
        25 => Cell::Text("wide"),
        26..29 => Cell::Number(*WRONG.choose(rng).expect("some values")),
        _ => Cell::Number(practical_value(key, rng)),
    }
}

/// Chooses an inexpensive model for most tables, because models that integrate friction take about
/// a thousand times as long.
fn random_model_choice(rng: &mut impl Rng) -> ModelChoice {
    match rng.random_range(0..200) {
        0..50 => Model::ClosedForm.into(),
        50..90 => Model::QuasiStatic.into(),
        90..120 => Model::Rigid.into(),
        120..150 => Model::RacewayControl.into(),
        150..152 => Model::Elastic.into(),
        152..154 => Model::Traction.into(),
        _ => ModelChoice::Auto,
    }
}

/// Compares rows of random tables and random base cases with single solves. The tables contain
/// alternative columns for the same quantity, missing values, values that are not permitted or are
/// outside the range of a model, and inputs that change the model from row to row.
#[test]
fn rows_of_random_tables_match_single_solves() {
    let mut rng = ChaCha8Rng::seed_from_u64(1994);
    let parts = ["disagree", "required by", "for model", "are equal", "smaller than", "`wide`"];
    let mut seen = Tally { invalid: parts.map(|part| (part, 0)), ..Tally::default() };
    for _ in 0..10_000 {
        let rng = &mut rng;
        let settings = Settings { model: random_model_choice(rng), ..Settings::default() };
        // If the conformities are given, `auto` may choose `traction`, which is slow. Therefore,
        // tables with `auto` rarely contain conformities.
        let grooves = settings.model != ModelChoice::Auto || rng.random_bool(0.1);
        let possible = KEYS.into_iter().filter(|key| {
            grooves || ![InputKey::nut_conformity, InputKey::screw_conformity].contains(key)
        });
        let mut keys: Vec<_> = possible.collect();
        let mut base = Case::default();
        let share = *[0.5, 0.9, 0.97].choose(rng).expect("some shares");
        for key in &keys {
            if rng.random_bool(share) {
                base[*key] = Some(practical_value(*key, rng));
            }
        }
        // If the base case had both a random lead and a random lead angle, they would rarely agree.
        // Therefore, usually only one of the two inputs is kept.
        match rng.random_range(0..10) {
            0..4 => base.lead_mm = None,
            4..8 => base.lead_angle_deg = None,
            _ => {}
        }
        keys.shuffle(rng);
        // Lead and lead angle are often chosen as columns, because each of them can replace the
        // other in a row.
        keys.truncate(rng.random_range(1..6));
        for lead in [InputKey::lead_angle_deg, InputKey::lead_mm] {
            if !keys.contains(&lead) && rng.random_bool(0.4) {
                keys.push(lead);
            }
        }
        let rows = (0..rng.random_range(1..6))
            .map(|_| keys.iter().map(|key| cell(*key, rng)).collect())
            .collect();
        Table { keys, rows }.assert_solved(&base, &settings, &mut seen);
    }
    let converged: usize = seen.converged.iter().map(|(_, count)| count).sum();
    let counts = format!("{:?}, {} unsolved, {:?}", seen.converged, seen.unsolved, seen.invalid);
    // The test is meaningful only if all models and all kinds of rejection occur often enough.
    assert!(converged > 8000 && seen.converged.len() == Model::ALL.len(), "{counts}");
    assert!(seen.unsolved > 100 && seen.invalid.iter().all(|(_, count)| *count > 100), "{counts}");
}

/// Returns the name of an input with a random unit, and the conversion from this unit.
fn name_in_random_unit(key: InputKey, rng: &mut impl Rng) -> (String, UnitChange) {
    let name = key.name();
    let mut all = vec![(name.to_owned(), UnitChange::NONE)];
    for (unit, _) in other_units(name) {
        let names = name.match_indices('_').map(|(at, _)| format!("{}_{unit}", &name[..at]));
        all.extend(names.filter_map(|name| match InputKey::in_unit(&name) {
            Ok((found, change)) if found == key => Some((name, change)),
            _ => None,
        }));
    }
    let place = if rng.random_bool(0.5) { 0 } else { rng.random_range(0..all.len()) };
    all.swap_remove(place)
}

/// Compares rows with `bsm solve --set` for the same names and values. The rows contain random
/// inputs in all units and in all forms in which a quantity can be given. Returns the number of
/// rows, and the number of rows in which a quantity is given in two forms.
#[expect(clippy::too_many_lines, reason = "one list of forms and one loop over rows")]
fn compare_alternative_forms(seed: u64, rows: usize) -> (usize, usize) {
    use InputKey as K;
    // Each quantity in this list can be given by one of two inputs, but not by both.
    const TWO_FORMS: [[K; 2]; 4] = [
        [K::screw_speed_rpm, K::feed_m_min],
        [K::contact_angle_deg, K::groove_bottom_distance_mm],
        [K::viscosity_40C_mm2_s, K::iso_vg],
        [K::heat_transfer_W_K, K::lubricant_temperature_C],
    ];
    const DRY: [(K, f64); 10] = [
        (K::lead_angle_deg, 8.7),
        (K::lead_mm, 20.0),
        (K::screw_speed_rpm, 1200.0),
        (K::feed_m_min, 18.0),
        (K::contact_angle_deg, 50.0),
        (K::groove_bottom_distance_mm, 9.0),
        (K::loaded_balls, 66.0),
        (K::loaded_balls_per_turn, 20.0),
        (K::loaded_turns, 3.5),
        (K::axial_load_N, 6000.0),
    ];
    const OIL: [(K, f64); 6] = [
        (K::iso_vg, 100.0),
        (K::viscosity_40C_mm2_s, 90.0),
        (K::viscosity_100C_mm2_s, 9.0),
        (K::lubricant_temperature_C, 50.0),
        (K::heat_transfer_W_K, 8.0),
        (K::ambient_temperature_C, 20.0),
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let outputs = Answers::select(None).expect("all outputs");
    let mut work = ModelWorkspace::default();
    let (mut count, mut twice, mut converged) = (0, 0, 0);
    while count < rows {
        let rng = &mut rng;
        let mut base = drive();
        let is_wet = rng.random_bool(0.2);
        if is_wet {
            base.friction_coefficient = None;
            let oil = ["iso_vg=68", "lubricant_temperature_C=40", "ball_roughness_um=0.02"];
            let more = ["nut_roughness_um=0.1", "screw_roughness_um=0.1"];
            base.apply(&[&oil[..], &more].concat()).expect("inputs");
        }
        let settings = match rng.random_range(0..100) {
            // Model `traction` integrates friction over the contacts, which takes a thousand times
            // as long as with other models.
            0..2 if is_wet => Settings::from(Model::Traction),
            _ if is_wet => {
                Settings { friction: RacewayFriction::PerContact, ..Model::RacewayControl.into() }
            }
            0..80 => {
                let models = [
                    Model::ClosedForm,
                    Model::QuasiStatic,
                    Model::Rigid,
                    Model::RacewayControl,
                    Model::Elastic,
                ];
                Settings::from(*models.choose(rng).expect("some models"))
            }
            _ => Settings::default(),
        };
        let mut keys: Vec<_> = DRY.into_iter().collect();
        if is_wet {
            keys.extend(OIL);
        }
        keys.shuffle(rng);
        keys.truncate(rng.random_range(1..6));
        let names: Vec<_> = keys.iter().map(|(key, _)| name_in_random_unit(*key, rng)).collect();
        let heads: Vec<_> = names.iter().map(|(name, _)| &name[..]).collect();
        let mut text = heads.join(",") + "\n";
        let mut cells = Vec::new();
        for _ in 0..rng.random_range(1..9) {
            let row: Vec<_> = keys
                .iter()
                .zip(&names)
                .map(|((_, value), (_, change))| {
                    let value = change.back(value * rng.random_range(0.9..1.1));
                    // Only some integers are valid viscosity grades. Large values are rounded, so
                    // that some of them are valid grades.
                    let value = if value > 85.0 && *change == UnitChange::NONE {
                        value.round()
                    } else {
                        value
                    };
                    if rng.random_bool(0.25) { String::new() } else { value.to_string() }
                })
                .collect();
            // If a row consists of a single empty cell, the cell is written as two quotes, because
            // the row would otherwise be a blank line.
            let line =
                if row.len() == 1 && row[0].is_empty() { "\"\"".to_owned() } else { row.join(",") };
            text.push_str(&line);
            text.push('\n');
            cells.push(row);
        }
        let mut source = CsvSource::new(text.as_bytes(), &[], &TableFormat::default())
            .expect("inputs, each once");
        let columns = source.columns().clone();
        let chunk = source.next(100).expect("a table").expect("rows");
        assert_eq!(chunk.len, cells.len(), "{text}");
        let answers = Task::new(base.clone(), settings, outputs.clone()).solve(&chunk, &columns);
        for (row, cells) in cells.iter().enumerate() {
            let given = heads.iter().zip(cells).filter(|(_, cell)| !cell.is_empty());
            let words: Vec<_> = given.map(|(name, cell)| format!("{name}={cell}")).collect();
            let what = || format!("{} {words:?} on {base:?}", settings.model.name());
            let mut case = base.clone();
            let asked = case.apply(&words).and_then(|()| case.problem(&settings));
            let expected = match asked {
                Ok(problem) => Record::new(problem.solve(&mut work)),
                Err(error) => Record::invalid(settings.model, &error),
            };
            let message = expected.message().map(str::to_owned).or_else(|| expected.choice());
            assert_eq!(answers.message(row), message.as_deref(), "{}", what());
            assert_eq!(answers.outcomes[row].model, expected.model(), "{}", what());
            converged +=
                usize::from(assert_alike(&what, (&answers, row), &outputs, (&expected, &case)));
            let has =
                |key: &K| keys.iter().zip(cells).any(|((k, _), cell)| k == key && !cell.is_empty());
            if TWO_FORMS.iter().any(|forms| forms.iter().all(has)) {
                twice += 1;
                assert_eq!(answers.outcomes[row].status, Status::InvalidInput, "{}", what());
            }
            count += 1;
        }
    }
    assert!(converged > rows / 5, "{converged} of {count}");
    (count, twice)
}

/// In an earlier version, the feed rate was ignored if one column contained the speed and another
/// column contained the feed rate.
#[test]
fn rows_with_two_forms_of_one_quantity_are_rejected() {
    let (rows, twice) = compare_alternative_forms(3706, 500);
    assert!(rows >= 500 && twice > 10, "{twice} of {rows}");
}

#[test]
#[ignore = "minutes"]
fn five_thousand_random_rows_match_single_solves() {
    let (rows, twice) = compare_alternative_forms(3707, 5000);
    println!("0 false, 0 silent: {rows} rows, {twice} of them with two forms of one quantity");
}
