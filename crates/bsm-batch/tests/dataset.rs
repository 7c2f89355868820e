//! Folders of parts: the same bytes whoever solves them and however often it is stopped, and nothing but
//! proven parts.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use bsm_batch::dataset::{self, Dataset, DatasetError, Event, Filling, Plan, Points};
use bsm_batch::{
    Answers, Count, Dialect, Format, GridSource, ParquetSource, Source, TableSink, Task, Workers,
};
use bsm_case::{Axis, Grid, Scene, Settings};
use bsm_dyn::Model;
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
    let base = include_bytes!("../../../examples/feed_drive.json");
    let base = Scene::from_json(base).expect("a scene");
    let outputs = ["efficiency", "screw_torque_Nm"].map(str::to_owned);
    let outputs = Answers::select(Some(&outputs)).expect("outputs");
    Task::new(base, Settings::from(model), outputs)
}

/// Loads and friction coefficients, of which the last one locks the screw: a third of the rows fails.
fn grid() -> Grid {
    let axes = ["axial_load_N=500:9000:40", "friction_coefficient=0.01,0.1,12"];
    Grid::new(axes.map(|axis| Axis::parse(axis).expect("an axis")).to_vec()).expect("a grid")
}

fn plan(task: &Task, points: &Points, rows: u64) -> Plan {
    Plan::new(task, points, NonZeroU64::new(rows), &workers(1)).expect("a plan")
}

fn fill(folder: &Path, task: &Task, points: &Points, threads: usize) -> Count {
    let how = Filling { resume: true, rows_per_shard: NonZeroU64::new(50), make };
    dataset::fill(folder, task, points, how, &workers(threads), &mut |_| {}).expect("solved")
}

/// All files below a folder.
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

fn temporary() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Rows of a table, as the values of its columns.
fn rows(source: &mut dyn Source, size: usize) -> Vec<f64> {
    let mut rows = Vec::new();
    while let Some(chunk) = source.next(size).expect("a table") {
        for row in 0..chunk.len {
            rows.extend(chunk.inputs.iter().map(|column| column.values()[row]));
        }
    }
    rows
}

#[test]
fn bytes_depend_on_the_plan_only() {
    let (task, points) = (task(Model::Elastic), Points::Grid(grid()));
    let first = temporary();
    let count = fill(first.path(), &task, &points, 1);
    assert_eq!(count, Count { rows: 120, failed: 40, several: 0 });
    let expected = files(first.path());
    let names: Vec<_> = expected.keys().map(String::as_str).collect();
    let parts =
        ["data/part-000000.parquet", "data/part-000001.parquet", "data/part-000002.parquet"];
    assert_eq!(names, [&parts[..], &["plan.json", "shards.parquet"]].concat());

    for threads in [2, 5] {
        let other = temporary();
        assert_eq!(fill(other.path(), &task, &points, threads), count);
        assert!(files(other.path()) == expected, "{threads} threads");
    }

    // Any order, by shards; what is there is found and counted.
    let other = temporary();
    let workers = workers(2);
    let parts = Dataset::create(other.path(), plan(&task, &points, 50), make).expect("a folder");
    for (shard, rows) in [(2, 20), (0, 50)] {
        let mut source = points.open().expect("a grid");
        source.skip(shard * 50).expect("a grid");
        let part = parts.run_shard(shard, &task, source.as_mut(), &workers, &mut |_| {});
        let part = part.expect("solved");
        assert_eq!((part.shard, part.first_row, part.rows), (shard, shard * 50, rows));
    }
    // Opened with nothing but the folder.
    let parts = Dataset::open(other.path(), make).expect("a folder");
    let task = parts.plan().task().expect("a task");
    let points = Points::Grid(parts.plan().grid().expect("axes").expect("a grid"));
    let found = parts.survey(true, &workers).expect("readable");
    assert_eq!(found.parts.keys().copied().collect::<Vec<_>>(), [0, 2]);
    let (mut there, mut solved) = (0, 0);
    let again = parts.run(&task, &points, found, &workers, &mut |event| match event {
        Event::Found(rows) => there += rows,
        Event::Solved(chunk, _) => solved += chunk.len,
        other => panic!("{other:?}"),
    });
    assert_eq!((again.expect("solved"), there, solved), (count, 70, 50));
    assert!(files(other.path()) == expected);
}

/// What the parts hold together is what one file holds, and it is plain Parquet.
#[test]
fn parts_are_the_rows_of_one_file() {
    let (task, folder) = (task(Model::Rigid), temporary());
    fill(folder.path(), &task, &Points::Grid(grid()), 2);
    let one = folder.path().join("one.csv");
    let mut source = GridSource::new(grid());
    let columns = source.columns().clone();
    let out = fs::File::create(&one).expect("file");
    let sink = TableSink::new(Format::Csv, out, &columns, &task.outputs).expect("a table");
    let run = task.run(&mut source, sink, u64::MAX, &workers(2), &mut |_, _| {});
    run.expect("solved").0.finish(None).expect("written");
    let keep = ["model", "status"].map(str::to_owned);
    assert!(Format::Csv.open(&one, &keep).is_err(), "columns of answers are passed over");
    let whole = rows(Format::Csv.open(&one, &[]).expect("a table").as_mut(), 1000);
    let mut parts = Vec::new();
    for shard in 0..3 {
        let path = folder.path().join(format!("data/part-{shard:06}.parquet"));
        let bytes = bytes::Bytes::from(fs::read(&path).expect("a part"));
        let footer = ParquetMetaDataReader::new().parse_and_finish(&bytes).expect("Parquet");
        let keys = footer.file_metadata().key_value_metadata().expect("keys");
        let names: Vec<_> = keys.iter().map(|entry| entry.key.as_str()).collect();
        for key in ["plan", "shard", "rows", "failed", "several", "data_bytes", "data_sha256"] {
            assert!(names.contains(&format!("bsm.{key}").as_str()), "{names:?}");
        }
        parts.extend(rows(Format::Parquet.open(&path, &[]).expect("a part").as_mut(), 7));
    }
    assert_eq!(parts, whole);
    assert_eq!(parts.len(), 240);
}

/// Every byte of a part counts: data, footer, hashes and tail.
#[test]
fn no_byte_of_a_part_changes_unnoticed() {
    let (task, points, folder) = (task(Model::ClosedForm), Points::Grid(grid()), temporary());
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

/// Found by the audit: parts were skipped because a file of their name was there.
#[test]
fn a_damaged_part_stops_the_run_and_stays() {
    let (task, points, folder) = (task(Model::ClosedForm), Points::Grid(grid()), temporary());
    fill(folder.path(), &task, &points, 1);
    let parts = Dataset::resume(folder.path(), plan(&task, &points, 50), make).expect("a folder");
    fs::write(parts.part_file(1), b"mine").expect("writable");
    let workers = workers(1);
    let found = parts.survey(false, &workers).expect("readable");
    let error = parts.run(&task, &points, found, &workers, &mut |_| {}).expect_err("damaged");
    assert!(matches!(&error, DatasetError::Damaged(files) if files.len() == 1), "{error}");
    assert_eq!(fs::read(parts.part_file(1)).expect("left"), b"mine");
    // Neither is it written over by who solves that part.
    let mut source = points.open().expect("a grid");
    source.skip(50).expect("a grid");
    let error = parts.run_shard(1, &task, source.as_mut(), &workers, &mut |_| {});
    assert!(error.expect_err("there is something").to_string().contains("part-000001.parquet"));
    assert_eq!(fs::read(parts.part_file(1)).expect("left"), b"mine");
    assert_eq!(fs::read_dir(folder.path().join("tmp")).expect("folder").count(), 0);
}

/// Nobody holds a lock, and nobody needs one.
#[test]
fn three_that_race_make_the_same_bytes() {
    let (task, points) = (task(Model::Elastic), Points::Grid(grid()));
    let alone = temporary();
    let count = fill(alone.path(), &task, &points, 1);
    let raced = temporary();
    thread::scope(|scope| {
        let runners: Vec<_> =
            (0..3).map(|_| scope.spawn(|| fill(raced.path(), &task, &points, 1))).collect();
        for runner in runners {
            assert_eq!(runner.join().expect("no panic"), count);
        }
    });
    assert!(files(raced.path()) == files(alone.path()));
}

/// Within the solving of a chunk of the slowest model.
#[test]
fn a_stop_takes_effect_at_once() {
    static STOP: AtomicBool = AtomicBool::new(false);
    let axes = vec![Axis::parse("axial_load_N=500:9000:1000000").expect("an axis")];
    let points = Points::Grid(Grid::new(axes).expect("a grid"));
    let (task, folder) = (task(Model::Traction), temporary());
    let plan = plan(&task, &points, 1 << 16);
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
    // A point takes some 0.1 ms; the rest is for a machine that does other things.
    assert!(asked.elapsed() < Duration::from_millis(100), "{:?}", asked.elapsed());
    assert_eq!(files(folder.path()).keys().collect::<Vec<_>>(), ["plan.json"]);
}

/// Rows of a Parquet table are passed over by row groups, and are those that reading on would give.
#[test]
fn rows_of_parquet_are_passed_over() {
    let folder = temporary();
    let path = folder.path().join("points.parquet");
    // More than a row group, and no multiple of a chunk.
    let axes = vec![Axis::parse("axial_load_N=500:9000:300001").expect("an axis")];
    let grid = Grid::new(axes).expect("a grid");
    let mut source = GridSource::new(grid.clone());
    let out = fs::File::create(&path).expect("file");
    let task = Task { outputs: Vec::new(), ..task(Model::ClosedForm) };
    let columns = source.columns().clone();
    let sink = TableSink::new(Format::Parquet, out, &columns, &task.outputs).expect("a table");
    let run = task.run(&mut source, sink, u64::MAX, &workers(2), &mut |_, _| {});
    run.expect("solved").0.finish(None).expect("written");
    let open = || ParquetSource::new(fs::File::open(&path).expect("file"), &[]).expect("Parquet");
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

/// The program runs its commands on the workers: what waits for a worker must not hold the only one. More rows
/// than a chunk, with an axis that has more values than a dictionary.
#[test]
fn a_table_that_is_solved_on_its_only_worker_has_the_same_bytes() {
    let axes = ["axial_load_N=500:9000:3", "friction_coefficient=0.01:0.1:30001"];
    let axes = axes.map(|axis| Axis::parse(axis).expect("an axis")).to_vec();
    let grid = Grid::new(axes).expect("a grid");
    for format in [Format::Parquet, Format::Csv, Format::JsonLines] {
        let written = |threads| {
            let workers = workers(threads);
            workers.install(|| {
                let (task, mut source) = (task(Model::ClosedForm), GridSource::new(grid.clone()));
                let out = task.write(&mut source, format, Vec::new(), &workers, &mut |_, _| {});
                let (out, count) = out.expect("solved");
                assert_eq!(count, Count { rows: 90_003, failed: 0, several: 0 });
                out
            })
        };
        assert!(written(1) == written(3), "{format:?}");
    }
}

/// A table without rows is one part without rows, which readers open.
#[test]
fn a_table_without_rows_is_one_part() {
    let folder = temporary();
    let path = folder.path().join("points.csv");
    fs::write(&path, "axial_load_N\n").expect("writable");
    let points = Points::Table { path, keep: Vec::new(), dialect: Dialect::default() };
    let map = folder.path().join("map");
    for _ in 0..2 {
        let count = fill(&map, &task(Model::Rigid), &points, 1);
        assert_eq!(count, Count::default());
    }
    let names: Vec<_> = files(&map).into_keys().collect();
    assert_eq!(names, ["data/part-000000.parquet", "plan.json", "shards.parquet"]);
    let mut part = Format::Parquet.open(&map.join(&names[0]), &[]).expect("a part");
    assert!(part.next(10).expect("Parquet").is_none());
}

/// A plan of 1e12 points is made, opened and worked on in the time and memory of a part.
#[test]
fn a_part_of_a_million_million_points_takes_a_moment() {
    // 59 604 parts of 2^24 rows, and a last one of 4096.
    let axes = ["axial_load_N=500:9000:244137985", "friction_coefficient=0.01:0.1:4096"];
    let axes = axes.map(|axis| Axis::parse(axis).expect("an axis")).to_vec();
    let points = Points::Grid(Grid::new(axes).expect("a grid"));
    let (task, folder, workers) = (task(Model::ClosedForm), temporary(), workers(1));
    let begin = Instant::now();
    let plan = Plan::new(&task, &points, None, &workers).expect("a plan");
    assert_eq!((plan.rows(), plan.shards()), (999_989_186_560, 59_605));
    assert!(plan.text().len() < 1000, "{}", plan.text());
    let parts = Dataset::create(folder.path(), plan, make).expect("a folder");
    let mut source = points.open().expect("a grid");
    source.skip(59_604 << 24).expect("a grid");
    let part = parts.run_shard(59_604, &task, source.as_mut(), &workers, &mut |_| {});
    let part = part.expect("solved");
    assert_eq!((part.first_row, part.rows), (59_604 << 24, 4096));
    let found = Dataset::open(folder.path(), make).expect("a folder").survey(true, &workers);
    assert_eq!(found.expect("readable").parts.into_values().collect::<Vec<_>>(), [part]);
    // It takes 0.1 s; the rest is for a machine that does other things.
    assert!(begin.elapsed() < Duration::from_secs(10), "{:?}", begin.elapsed());
}
