//! Tests of datasets, which are divided into part files. The bytes of the part files must not
//! depend on the number of processes or on interruptions, and only verified parts may count as
//! complete.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use arrow_array::RecordBatch;
use bsm_batch::dataset::{
    self, Dataset, DatasetError, Event, Plan, Points, RunOptions, solve_part,
};
use bsm_batch::{
    Answers, Count, Format, GridSource, ParquetSource, RandomInput, RandomPoints, Source,
    TableFormat, TableSink, Task, Workers,
};
use bsm_case::{Case, Grid, GridAxis, Settings};
use bsm_dyn::Model;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::ParquetMetaDataReader;
use tempfile::{NamedTempFile, TempDir};

static NEVER: AtomicBool = AtomicBool::new(false);

fn workers(threads: usize) -> Workers<'static> {
    Workers::start(NonZeroUsize::new(threads), &NEVER).expect("threads")
}

fn make(file: &mut dyn FnMut() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
    file()
}

fn task(model: Model) -> Task {
    let base = include_bytes!("../../../../examples/feed_drive.json");
    let base = Case::from_json(base).expect("a case");
    let outputs = ["efficiency", "ball_torque_Nm"].map(str::to_owned);
    let outputs = Answers::select(Some(&outputs)).expect("outputs");
    Task::new(base, Settings::from(model), outputs)
}

/// Returns a grid of loads and friction coefficients. With the largest friction coefficient, the
/// screw is self-locking, so a third of the rows have no solution.
fn grid() -> Grid {
    let axes = ["axial_load_N=500:9000:40", "friction_coefficient=0.01,0.1,12"];
    Grid::new(axes.map(|axis| GridAxis::parse(axis).expect("an axis")).to_vec()).expect("a grid")
}

fn plan(task: &Task, points: &Points, rows: u64) -> Plan {
    Plan::new(task, points, NonZeroU64::new(rows), &workers(1)).expect("a plan")
}

fn fill(folder: &Path, task: &Task, points: &Points, threads: usize) -> Count {
    let how = RunOptions { resume: true, rows_per_part: NonZeroU64::new(50), make };
    dataset::fill(folder, task, points, how, &workers(threads), &mut |_| {}).expect("solved")
}

/// Returns the contents of all files in a folder and its subfolders, by relative path.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("folder") {
            let path = entry.expect("entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).expect("below").display().to_string();
                found.insert(name, fs::read(&path).expect("file"));
            }
        }
    }
    found
}

fn temporary_folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Reads all rows of a table and returns the values of their inputs.
fn rows(source: &mut dyn Source, size: usize) -> Vec<f64> {
    let mut rows = Vec::new();
    while let Some(chunk) = source.next(size).expect("a table") {
        for row in 0..chunk.len {
            rows.extend(chunk.inputs.iter().map(|column| column.value(row)));
        }
    }
    rows
}

#[test]
fn bytes_of_a_part_file_depend_only_on_the_plan() {
    let (task, points) = (task(Model::Elastic), Points::Grid(grid()));
    let first = temporary_folder();
    let count = fill(first.path(), &task, &points, 1);
    assert_eq!(count, Count { rows: 120, failed: 40, with_other_solutions: 0 });
    let expected = files(first.path());
    let names: Vec<_> = expected.keys().map(String::as_str).collect();
    let parts =
        ["data/part-000000.parquet", "data/part-000001.parquet", "data/part-000002.parquet"];
    assert_eq!(names, [&parts[..], &["parts.parquet", "plan.json"]].concat());

    for threads in [2, 5] {
        let other = temporary_folder();
        assert_eq!(fill(other.path(), &task, &points, threads), count);
        assert!(files(other.path()) == expected, "{threads} threads");
    }

    // The same parts are solved in another order. Parts that already exist must be found and
    // counted.
    let other = temporary_folder();
    let workers = workers(2);
    let parts = Dataset::create(other.path(), plan(&task, &points, 50), make).expect("a folder");
    for (number, rows) in [(2, 20), (0, 50)] {
        let solved = parts.run_parts(&task, &points, [number], false, &workers, &mut |_| {});
        let part = &solved.expect("solved")[&number];
        assert_eq!((part.number, part.first_row, part.rows), (number, number * 50, rows));
    }
    // The folder alone is sufficient to open a dataset.
    let parts = Dataset::open(other.path(), make).expect("a folder");
    let task = parts.plan().task().expect("a task");
    let points = parts.points(None, &workers).expect("a grid");
    let found = parts.survey(true, &workers).expect("readable");
    assert_eq!(found.parts.keys().copied().collect::<Vec<_>>(), [0, 2]);
    let (mut there, mut solved) = (0, 0);
    let again = parts.run(&task, &points, found, &workers, &mut |event| match event {
        Event::Found(part) => there += part.rows,
        Event::Solved(chunk, _) => solved += chunk.len,
        other => panic!("{other:?}"),
    });
    assert_eq!((again.expect("solved"), there, solved), (count, 70, 50));
    assert!(files(other.path()) == expected);
}

/// All parts together must contain the same rows as a single file, and each part must be a valid
/// Parquet file.
#[test]
fn parts_together_contain_the_same_rows_as_a_single_file() {
    let (task, folder) = (task(Model::Rigid), temporary_folder());
    fill(folder.path(), &task, &Points::Grid(grid()), 2);
    let one = folder.path().join("one.csv");
    let mut source = GridSource::new(grid());
    let columns = source.columns().clone();
    let out = fs::File::create(&one).expect("file");
    let table_format = TableFormat::default();
    let sink = TableSink::new(Format::Csv, out, &columns, &task.outputs, &table_format);
    let sink = sink.expect("a table");
    let run = task.run(&mut source, sink, u64::MAX, &workers(2), &mut |_, _| {});
    run.expect("solved").0.finish(None).expect("written");
    let keep = ["model", "status"].map(str::to_owned);
    assert!(
        Format::Csv.open(&one, &keep, &TableFormat::default()).is_err(),
        "columns of answers are passed over"
    );
    let whole =
        rows(Format::Csv.open(&one, &[], &TableFormat::default()).expect("a table").as_mut(), 1000);
    let mut parts = Vec::new();
    for number in 0..3 {
        let path = folder.path().join(format!("data/part-{number:06}.parquet"));
        let bytes = bytes::Bytes::from(fs::read(&path).expect("a part"));
        let footer = ParquetMetaDataReader::new().parse_and_finish(&bytes).expect("Parquet");
        let keys = footer.file_metadata().key_value_metadata().expect("keys");
        let names: Vec<_> = keys.iter().map(|entry| entry.key.as_str()).collect();
        for key in ["plan", "part", "rows", "failed", "several", "data_bytes", "data_sha256"] {
            assert!(names.contains(&format!("bsm.{key}").as_str()), "{names:?}");
        }
        parts.extend(rows(
            Format::Parquet.open(&path, &[], &TableFormat::default()).expect("a part").as_mut(),
            7,
        ));
    }
    assert_eq!(parts, whole);
    assert_eq!(parts.len(), 240);
}

/// A changed byte must be detected in the data, the footer, the hashes, and the bytes after the
/// footer.
#[test]
fn every_changed_byte_of_a_part_is_detected() {
    let (task, points, folder) =
        (task(Model::ClosedForm), Points::Grid(grid()), temporary_folder());
    fill(folder.path(), &task, &points, 1);
    let parts = Dataset::resume(folder.path(), plan(&task, &points, 50), make).expect("a folder");
    let path = parts.part_file(2);
    let good = fs::read(&path).expect("a part");
    let workers = workers(1);
    let damaged = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("writable");
        parts.survey(true, &workers).expect("readable").damaged.len()
    };
    assert_eq!(damaged(&good), 0);
    let mut bytes = good.clone();
    for i in 0..bytes.len() {
        bytes[i] ^= 1 << (i % 8);
        assert_eq!(damaged(&bytes), 1, "byte {i} of {}", good.len());
        bytes[i] = good[i];
    }
    for len in (0..good.len()).step_by(97) {
        assert_eq!(damaged(&good[..len]), 1, "cut to {len}");
    }
    assert_eq!(damaged(&[&good[..], b"PAR1"].concat()), 1);
}

/// In an earlier version, a part was skipped if a file with its name existed, even if this file was
/// damaged.
#[test]
fn a_damaged_part_is_reported_and_not_overwritten() {
    let (task, points, folder) =
        (task(Model::ClosedForm), Points::Grid(grid()), temporary_folder());
    fill(folder.path(), &task, &points, 1);
    let parts = Dataset::resume(folder.path(), plan(&task, &points, 50), make).expect("a folder");
    fs::write(parts.part_file(1), b"mine").expect("writable");
    let workers = workers(1);
    let found = parts.survey(false, &workers).expect("readable");
    let error = parts.run(&task, &points, found, &workers, &mut |_| {}).expect_err("damaged");
    assert!(matches!(&error, DatasetError::Damaged(files) if files.len() == 1), "{error}");
    assert_eq!(fs::read(parts.part_file(1)).expect("left"), b"mine");
    // A file must not be overwritten even if it is created while its part is being solved.
    fs::remove_file(parts.part_file(2)).expect("there");
    let mut appear = |_: Event<'_>| fs::write(parts.part_file(2), b"mine").expect("writable");
    let error = parts.run_parts(&task, &points, [2], false, &workers, &mut appear);
    assert!(error.expect_err("there is something").to_string().contains("part-000002.parquet"));
    assert_eq!(fs::read(parts.part_file(2)).expect("left"), b"mine");
    assert_eq!(fs::read_dir(folder.path().join("tmp")).expect("folder").count(), 0);
}

/// Several processes can solve the same dataset at the same time without a lock.
#[test]
fn three_concurrent_processes_write_identical_parts() {
    let (task, points) = (task(Model::Elastic), Points::Grid(grid()));
    let alone = temporary_folder();
    let count = fill(alone.path(), &task, &points, 1);
    let raced = temporary_folder();
    thread::scope(|scope| {
        let runners: Vec<_> =
            (0..3).map(|_| scope.spawn(|| fill(raced.path(), &task, &points, 1))).collect();
        for runner in runners {
            assert_eq!(runner.join().expect("no panic"), count);
        }
    });
    assert!(files(raced.path()) == files(alone.path()));
}

/// The run is stopped while it solves a chunk with the slowest model.
#[test]
fn a_run_can_be_stopped_within_a_chunk() {
    static STOP: AtomicBool = AtomicBool::new(false);
    let axes = vec![GridAxis::parse("axial_load_N=500:9000:1000000").expect("an axis")];
    let points = Points::Grid(Grid::new(axes).expect("a grid"));
    let (task, folder) = (task(Model::Traction), temporary_folder());
    // A part takes a few seconds, so the run is stopped before it finishes a part.
    let plan = plan(&task, &points, 1 << 20);
    let asked = thread::scope(|scope| {
        let asked = scope.spawn(|| {
            thread::sleep(Duration::from_millis(300));
            STOP.store(true, Ordering::Relaxed);
            Instant::now()
        });
        let workers = Workers::start(NonZeroUsize::new(2), &STOP).expect("threads");
        let parts = Dataset::create(folder.path(), plan, make).expect("a folder");
        let found = parts.survey(true, &workers).expect("readable");
        let stopped = parts.run(&task, &points, found, &workers, &mut |_| {});
        assert!(matches!(stopped, Err(DatasetError::Stopped)), "{stopped:?}");
        asked.join().expect("no panic")
    });
    // It takes a few milliseconds to solve a chunk. The limit is larger, because the machine may be
    // busy.
    assert!(asked.elapsed() < Duration::from_millis(100), "{:?}", asked.elapsed());
    assert_eq!(files(folder.path()).keys().collect::<Vec<_>>(), ["plan.json"]);
}

/// If rows of a Parquet table are skipped, complete row groups are not read at all. The remaining
/// rows must be the same as if the whole table had been read.
#[test]
fn rows_of_a_parquet_table_do_not_change_if_preceding_rows_are_skipped() {
    let folder = temporary_folder();
    let path = folder.path().join("points.parquet");
    // The table has more rows than a row group, and its number of rows is not a multiple of the
    // chunk size.
    let axes = vec![GridAxis::parse("axial_load_N=500:9000:300001").expect("an axis")];
    let grid = Grid::new(axes).expect("a grid");
    let mut source = GridSource::new(grid.clone());
    let out = fs::File::create(&path).expect("file");
    let task = Task { outputs: Vec::new(), ..task(Model::ClosedForm) };
    let columns = source.columns().clone();
    let table_format = TableFormat::default();
    let sink = TableSink::new(Format::Parquet, out, &columns, &task.outputs, &table_format);
    let sink = sink.expect("a table");
    let run = task.run(&mut source, sink, u64::MAX, &workers(2), &mut |_, _| {});
    run.expect("solved").0.finish(None).expect("written");
    let open = || {
        ParquetSource::new(fs::File::open(&path).expect("file"), &[], &TableFormat::default())
            .expect("Parquet")
    };
    let all = rows(&mut open(), 10_000);
    assert_eq!(all.len(), 300_001);
    for [before, skipped] in [[0, 1], [5, 262_139], [7, 262_137], [0, 262_145], [10, 300_001]] {
        let mut source = open();
        if before > 0 {
            source.next(before).expect("Parquet").expect("rows");
        }
        source.skip(skipped as u64).expect("Parquet");
        let from = (before + skipped).min(all.len());
        let next = source.next(1).expect("Parquet");
        assert_eq!(next.map(|chunk| chunk.first), all.get(from).map(|_| from as u64 + 1));
        let rest = rows(&mut source, 10_000);
        assert!(rest[..] == all[(from + 1).min(all.len())..], "{before} {skipped}");
    }
}

/// The program runs its commands on the worker threads. If there is only one worker, a command that
/// waits for a worker must not cause a deadlock. The table has more rows than a chunk, and one axis
/// has more values than a dictionary can hold.
#[test]
fn one_worker_and_several_workers_write_identical_tables() {
    let axes = ["axial_load_N=500:9000:3", "friction_coefficient=0.01:0.1:30001"];
    let axes = axes.map(|axis| GridAxis::parse(axis).expect("an axis")).to_vec();
    let grid = Grid::new(axes).expect("a grid");
    for format in [Format::Parquet, Format::Csv, Format::JsonLines] {
        let written = |threads| {
            let workers = workers(threads);
            workers.install(|| {
                let (task, mut source) = (task(Model::ClosedForm), GridSource::new(grid.clone()));
                let out = task.write(&mut source, format, Vec::new(), &workers, &mut |_, _| {});
                let (out, count) = out.expect("solved");
                assert_eq!(count, Count { rows: 90_003, failed: 0, with_other_solutions: 0 });
                out
            })
        };
        assert!(written(1) == written(3), "{format:?}");
    }
}

/// A table without rows must produce one part without rows, which must be a valid Parquet file.
#[test]
fn table_without_rows_produces_one_empty_part() {
    let folder = temporary_folder();
    let path = folder.path().join("points.csv");
    fs::write(&path, "axial_load_N\n").expect("writable");
    let points = Points::Table { path, keep: Vec::new(), table_format: TableFormat::default() };
    let map = folder.path().join("map");
    for _ in 0..2 {
        let count = fill(&map, &task(Model::Rigid), &points, 1);
        assert_eq!(count, Count::default());
    }
    let names: Vec<_> = files(&map).into_keys().collect();
    assert_eq!(names, ["data/part-000000.parquet", "parts.parquet", "plan.json"]);
    let mut part =
        Format::Parquet.open(&map.join(&names[0]), &[], &TableFormat::default()).expect("a part");
    assert!(part.next(10).expect("Parquet").is_none());
}

/// A part that is solved in memory must have the same columns, types and values as the part file.
#[test]
fn part_solved_in_memory_equals_the_part_file() {
    let (points, folder) = (Points::Grid(grid()), temporary_folder());
    // One output is a text, one a boolean, one a count, and one a number.
    let outputs = ["controlling_raceway", "control_consistent", "iterations", "efficiency"];
    let outputs = Answers::select(Some(&outputs.map(str::to_owned))).expect("outputs");
    let task = Task { outputs, ..task(Model::RacewayControl) };
    fill(folder.path(), &task, &points, 2);
    let parts = Dataset::open(folder.path(), make).expect("a folder");
    for number in 0..3 {
        let file = fs::File::open(parts.part_file(number)).expect("a part");
        let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("Parquet").build();
        let of_file: Vec<RecordBatch> =
            reader.expect("Parquet").map(|batch| batch.expect("rows")).collect();
        let workers = workers(2);
        let (schema, batches) =
            solve_part(parts.plan(), &points, number, &workers).expect("solved");
        assert_eq!(schema.fields(), of_file[0].schema().fields());
        assert!(batches == of_file, "part {number}");
    }
    let none = solve_part(parts.plan(), &points, 3, &workers(1));
    assert!(none.is_err_and(|e| e.to_string().contains("parts 0 to 2, but no part 3")));
}

/// In an earlier version, `--repair` overwrote valid parts if the plan file had been replaced by
/// another plan.
#[test]
fn parts_of_another_plan_are_not_overwritten() {
    let (points, [mine, yours]) = (Points::Grid(grid()), [temporary_folder(), temporary_folder()]);
    fill(mine.path(), &task(Model::ClosedForm), &points, 1);
    fill(yours.path(), &task(Model::QuasiStatic), &points, 1);
    let plan = mine.path().join("plan.json");
    let own = fs::read(&plan).expect("a plan");
    fs::copy(yours.path().join("plan.json"), &plan).expect("writable");
    let before = files(mine.path());
    let workers = workers(1);
    let repair = |task: &Task| {
        let parts = Dataset::open(mine.path(), make).expect("a folder");
        parts.run_parts(task, &points, 0..3, true, &workers, &mut |_| {}).map(|parts| parts.len())
    };
    let refused = repair(&task(Model::QuasiStatic));
    assert!(matches!(refused, Err(DatasetError::NotOfThePlan(_))), "{refused:?}");
    assert!(files(mine.path()) == before);
    // After the original plan has been restored, the folder is intact again. A single part of
    // another plan counts as damaged.
    fs::write(&plan, own).expect("writable");
    let [from, to] = [&yours, &mine].map(|f| f.path().join("data/part-000001.parquet"));
    fs::copy(from, to).expect("writable");
    assert_eq!(repair(&task(Model::ClosedForm)).expect("repaired"), 3);
}

/// In an earlier version, part files that are not in the plan were ignored.
#[test]
fn part_file_that_is_not_in_the_plan_is_reported() {
    let (task, points, folder) =
        (task(Model::ClosedForm), Points::Grid(grid()), temporary_folder());
    fill(folder.path(), &task, &points, 1);
    let parts = Dataset::open(folder.path(), make).expect("a folder");
    parts.check_names().expect("the parts of the plan");
    // Programs that read the folder would also read these copies of parts, regardless of their
    // names.
    for name in ["part-000003.parquet", "part-2.parquet", "other.parquet", "PART-000002.PARQUET"] {
        let path = folder.path().join("data").join(name);
        fs::copy(parts.part_file(2), &path).expect("writable");
        let said = parts.check_names().expect_err("too many").to_string();
        assert!(said.contains(name) && said.contains("no part with this name"), "{said}");
        fs::remove_file(path).expect("removable");
    }
    let within = folder.path().join("data/sub");
    fs::create_dir(&within).expect("a folder");
    assert!(parts.check_names().is_err_and(|why| why.to_string().contains("data/sub")));
    fs::remove_dir(within).expect("removable");
    // Programs that read the folder ignore these files, which are hidden or are not Parquet files.
    for name in [".part-000002.parquet", "notes.txt"] {
        fs::write(folder.path().join("data").join(name), "mine").expect("writable");
    }
    parts.check_names().expect("the parts of the plan");
}

/// In an earlier version, `parts.parquet` was kept even if it belonged to another folder, or if a
/// part was lost after `parts.parquet` had been written.
#[test]
fn repair_of_a_dataset_rewrites_or_removes_its_list_of_parts() {
    let (task, points, folder) =
        (task(Model::ClosedForm), Points::Grid(grid()), temporary_folder());
    fill(folder.path(), &task, &points, 1);
    let expected = files(folder.path());
    let (parts, workers) = (Dataset::open(folder.path(), make).expect("a folder"), workers(1));
    let list = folder.path().join("parts.parquet");
    let run = |numbers: std::ops::Range<u64>, repair| {
        parts.run_parts(&task, &points, numbers, repair, &workers, &mut |_| {}).expect("solved");
    };
    fs::write(&list, "of another folder").expect("writable");
    run(0..3, false);
    assert_eq!(fs::read(&list).expect("left"), b"of another folder");
    run(0..3, true);
    assert!(files(folder.path()) == expected);
    // Without one of the parts, the list of parts is not valid.
    fs::remove_file(parts.part_file(2)).expect("removable");
    run(0..2, true);
    assert!(!list.exists());
    run(0..3, true);
    assert!(!list.exists());
}

/// The dataset is opened from its folder alone, and its random points are solved in parts of
/// different sizes.
#[test]
fn random_points_do_not_depend_on_the_part_size() {
    let draws = ["axial_load_N=uniform:500:9000", "friction_coefficient=normal:0.06:0.005"];
    let draws = draws.map(|draw| RandomInput::parse(draw).expect("a draw")).to_vec();
    let points = Points::Random(RandomPoints::new(11, 120, draws).expect("draws"));
    let (task, folder) = (task(Model::Rigid), temporary_folder());
    assert_eq!(
        fill(folder.path(), &task, &points, 2),
        Count { rows: 120, failed: 0, with_other_solutions: 0 }
    );
    let one = temporary_folder();
    let whole = Dataset::create(one.path(), plan(&task, &points, 120), make).expect("a folder");
    let whole = Dataset::open(one.path(), make).map(|_| whole).expect("its own plan");
    let workers = workers(1);
    let points = whole.points(None, &workers).expect("draws");
    whole.run_parts(&task, &points, 0..1, false, &workers, &mut |_| {}).expect("solved");
    let rows_of = |folder: &Path, parts: usize| -> Vec<f64> {
        let part = |i: usize| folder.join(format!("data/part-{i:06}.parquet"));
        let part =
            |i| Format::Parquet.open(&part(i), &[], &TableFormat::default()).expect("a part");
        (0..parts).flat_map(|i| rows(part(i).as_mut(), 1000)).collect()
    };
    let all = rows_of(one.path(), 1);
    assert_eq!((all.len(), &all), (240, &rows_of(folder.path(), 3)));
}

/// If the points of a dataset come from a table, the dataset can be continued only with the same
/// table.
#[test]
fn dataset_of_a_table_can_be_continued_only_with_the_same_table() {
    let folder = temporary_folder();
    let (path, map) = (folder.path().join("points.parquet"), folder.path().join("map"));
    let write = |loads: &str| {
        let axes = vec![GridAxis::parse(&format!("axial_load_N={loads}:120")).expect("an axis")];
        let mut source = GridSource::new(Grid::new(axes).expect("a grid"));
        let task = Task { outputs: Vec::new(), ..task(Model::ClosedForm) };
        let out = task.write(&mut source, Format::Parquet, Vec::new(), &workers(1), &mut |_, _| {});
        fs::write(&path, out.expect("solved").0).expect("writable");
    };
    write("500:9000");
    let task = task(Model::Rigid);
    let (table_format, keep) = (TableFormat::default(), Vec::new());
    let points = Points::Table { path: path.clone(), keep, table_format };
    fill(&map, &task, &points, 1);
    let expected = files(&map);
    let workers = workers(2);
    let parts = Dataset::open(&map, make).expect("a folder");
    for number in [1, 2] {
        fs::remove_file(parts.part_file(number)).expect("removable");
    }
    // The table may be in the parent folder under its original name, or at any other given path.
    let beside = parts.points(None, &workers).expect("the table");
    parts.run_parts(&task, &beside, [2], false, &workers, &mut |_| {}).expect("solved");
    let moved = folder.path().join("other.parquet");
    fs::rename(&path, &moved).expect("movable");
    assert!(parts.points(None, &workers).expect_err("gone").to_string().contains("points.parquet"));
    let found = parts.points(Some(&moved), &workers).expect("the table");
    parts.run_parts(&task, &found, 0..3, false, &workers, &mut |_| {}).expect("solved");
    assert!(files(&map) == expected);
    write("500:9001");
    let said = parts.points(None, &workers).expect_err("another table").to_string();
    assert!(said.contains("is not identical to the table of points in the plan"), "{said}");
}

/// Damaged parts do not prevent other parts from being solved, and are replaced only with `repair`.
#[test]
fn damaged_parts_are_replaced_only_on_request() {
    let (task, points, folder) =
        (task(Model::ClosedForm), Points::Grid(grid()), temporary_folder());
    fill(folder.path(), &task, &points, 1);
    let expected = files(folder.path());
    let (parts, workers) = (Dataset::open(folder.path(), make).expect("a folder"), workers(1));
    let mut bytes = fs::read(parts.part_file(0)).expect("a part");
    bytes[500] ^= 4;
    fs::write(parts.part_file(0), &bytes).expect("writable");
    fs::write(parts.part_file(1), b"mine").expect("writable");
    fs::remove_file(parts.part_file(2)).expect("removable");
    let run = |repair| parts.run_parts(&task, &points, 0..3, repair, &workers, &mut |_| {});
    let said = run(false).expect_err("damaged").to_string();
    // Without `repair`, a run verifies only the footers, which do not reveal a flipped bit in the
    // data.
    assert!(said.contains("part-000001.parquet") && !said.contains("part-000000"), "{said}");
    assert_eq!(fs::read(parts.part_file(1)).expect("left"), b"mine");
    assert!(parts.part_file(2).exists());
    let found = parts.survey(true, &workers).expect("readable");
    let missing: Vec<_> = found.missing(parts.plan()).into_iter().flatten().collect();
    assert_eq!((missing, found.damaged.len()), (vec![0, 1], 2));
    assert_eq!(run(true).expect("solved").len(), 3);
    assert!(files(folder.path()) == expected);
    let none = parts.run_parts(&task, &points, [3], false, &workers, &mut |_| {});
    assert!(none.is_err_and(|e| e.to_string().contains("parts 0 to 2, but no part 3")));
}

/// The estimated size of a dataset must be at least as large as the actual size, and at most twice
/// as large.
#[test]
fn estimated_dataset_size_is_an_upper_bound_on_the_actual_size() {
    let draws = ["axial_load_N=uniform:500:9000", "screw_speed_rpm=normal:1500:50"];
    let draws = draws.map(|draw| RandomInput::parse(draw).expect("a draw")).to_vec();
    let points = Points::Random(RandomPoints::new(11, 100_000, draws).expect("draws"));
    let (task, folder) = (task(Model::Rigid), temporary_folder());
    let rows_per_part = NonZeroU64::new(30_000);
    let plan = Plan::new(&task, &points, rows_per_part, &workers(1)).expect("a plan");
    let bytes = plan.estimate().expect("a task").bytes;
    let how = RunOptions { resume: false, rows_per_part, make };
    dataset::fill(folder.path(), &task, &points, how, &workers(2), &mut |_| {}).expect("solved");
    let parts = files(folder.path()).into_iter().filter(|(name, _)| name.starts_with("data"));
    let found: u32 = parts.map(|(_, bytes)| u32::try_from(bytes.len()).expect("small")).sum();
    let found = f64::from(found);
    assert!(found < bytes && bytes < 2.0 * found, "{found} {bytes}");
}

/// A plan with 1e12 points can be created and opened, and one of its parts can be solved. If a step
/// visited all points, this test would run for hours.
#[test]
fn part_of_a_plan_with_1e12_points_is_solved_without_the_other_parts() {
    // The plan has 59 604 parts with 2^24 rows each, and a last part with 4096 rows.
    let axes = ["axial_load_N=500:9000:244137985", "friction_coefficient=0.01:0.1:4096"];
    let axes = axes.map(|axis| GridAxis::parse(axis).expect("an axis")).to_vec();
    let points = Points::Grid(Grid::new(axes).expect("a grid"));
    let (task, folder, workers) = (task(Model::ClosedForm), temporary_folder(), workers(1));
    let plan = Plan::new(&task, &points, None, &workers).expect("a plan");
    assert_eq!((plan.rows(), plan.parts()), (999_989_186_560, 59_605));
    assert!(plan.text().len() < 1000, "{}", plan.text());
    let parts = Dataset::create(folder.path(), plan, make).expect("a folder");
    let solved = parts.run_parts(&task, &points, [59_604], false, &workers, &mut |_| {});
    let part = solved.expect("solved").remove(&59_604).expect("a part");
    assert_eq!((part.first_row, part.rows), (59_604 << 24, 4096));
    let found = Dataset::open(folder.path(), make).expect("a folder").survey(true, &workers);
    assert_eq!(found.expect("readable").parts.into_values().collect::<Vec<_>>(), [part]);
}
