//! Tests of runs that are killed at random moments, and of damaged datasets. Results must never be
//! wrong, damage must never be accepted silently, and only SIGKILL may leave temporary files
//! behind. `just kills` runs the long version of these tests.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::program::{example, folder, stderr};

const SIGNALS: [&str; 4] = ["-KILL", "-TERM", "-INT", "-HUP"];

fn program(args: &[String], folder: &Path) -> Command {
    // The parent process may ignore signals, so the default signal handlers are restored.
    let mut command = Command::new("env");
    command.arg("--default-signal").arg(env!("CARGO_BIN_EXE_bsm")).args(args).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn run(args: &[String], folder: &Path) -> Output {
    program(args, folder).output().expect("the program runs")
}

fn to_strings(args: &[&str]) -> Vec<String> {
    args.iter().map(|arg| (*arg).to_owned()).collect()
}

/// Returns all entries in a folder and its subfolders: files with their bytes, and `None` for
/// entries that are not files.
fn files(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("folder") {
            let entry = entry.expect("entry");
            let kind = entry.file_type().expect("entry");
            if kind.is_dir() {
                folders.push(entry.path());
                continue;
            }
            let bytes = kind.is_file().then(|| fs::read(entry.path()).expect("file"));
            let name = entry.path().strip_prefix(folder).expect("below").to_owned();
            found.insert(name, bytes);
        }
    }
    found
}

fn unfinished_files(files: &BTreeMap<PathBuf, Option<Vec<u8>>>) -> Vec<&PathBuf> {
    let temporary = |path: &&PathBuf| {
        path.starts_with("tmp") || path.display().to_string().starts_with(".bsm-")
    };
    files.keys().filter(temporary).collect()
}

/// Points of a grid, some of which have no result. The same points can be written as tables.
struct Points {
    vary: Vec<String>,
    rows: usize,
}

impl Points {
    /// Creates the points. At the last value of the friction coefficient, the screw is
    /// self-locking.
    fn new(loads: usize) -> Self {
        let vary = vec![
            format!("--vary=axial_load_N=500:9000:{loads}"),
            "--vary=friction_coefficient=0.05,0.1,0.15,12".to_owned(),
        ];
        Self { vary, rows: 4 * loads }
    }

    /// Returns the command-line arguments that solve the points of `source` and write the results
    /// to `output`.
    fn args(&self, source: &str, output: &str) -> Vec<String> {
        let drive = example("feed_drive.json");
        let mut args = match source {
            "grid" => [&to_strings(&["sweep", &drive])[..], &self.vary].concat(),
            table => to_strings(&["sweep", &drive, "--points", table]),
        };
        args.extend(to_strings(&["--model=elastic", "--columns=efficiency,ball_torque_Nm"]));
        args.extend(to_strings(&["-o", output]));
        if output.ends_with('/') {
            args.push(format!("--rows-per-part={}", self.rows.div_ceil(16)));
        }
        args
    }

    fn write(&self, folder: &Path) {
        for table in ["points.csv", "points.jsonl", "points.parquet"] {
            let drive = example("feed_drive.json");
            let args =
                to_strings(&["sweep", &drive, "--model=closed-form", "--columns=efficiency"]);
            let more = to_strings(&["--keep-going", "-o", table]);
            let output = run(&[args, self.vary.clone(), more].concat(), folder);
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        }
    }
}

/// Numbers of killed runs and leftover files in a test campaign.
#[derive(Debug, Default)]
struct Tally {
    kills: usize,
    late: usize,
    parts_at_kills: usize,
    left_by_sigkill: usize,
}

/// Kills `kills` runs that write a dataset and as many runs that write a single file. After each
/// kill and at the end, the files must be identical to the files of an undisturbed run.
fn kill_runs(source: &str, points: &Points, kills: usize, rng: &mut ChaCha8Rng, tally: &mut Tally) {
    let dir = folder();
    points.write(dir.path());
    let start = Instant::now();
    let undisturbed = run(&points.args(source, "whole/"), dir.path());
    let time = start.elapsed();
    assert_eq!(undisturbed.status.code(), Some(3), "{}", stderr(&undisturbed));
    let expected = files(&dir.path().join("whole"));
    let code = run(&points.args(source, "whole.csv"), dir.path()).status.code();
    assert_eq!(code, Some(3));
    let table = fs::read(dir.path().join("whole.csv")).expect("table");
    let quiet = |args: &[String], signal: &str, rng: &mut ChaCha8Rng| {
        let mut child = program(args, dir.path()).spawn().expect("the program starts");
        sleep(time.mul_f64(rng.random_range(0.0..1.0)));
        let over = child.try_wait().expect("a child").is_some();
        if !over {
            // If the process ends before the `kill` command runs, nothing is killed.
            let _ = Command::new("kill").args([signal, &child.id().to_string()]).output();
        }
        let output = child.wait_with_output().expect("ends");
        // The process was either killed or had already finished. In both cases, it must neither
        // panic nor report an error.
        let code = output.status.code();
        assert!(!matches!(code, Some(1 | 2 | 101)), "{code:?} {}", stderr(&output));
        code == Some(3)
    };

    // The first group of runs writes a dataset.
    let resume = [points.args(source, "map/"), to_strings(&["--resume"])].concat();
    let map = dir.path().join("map");
    let mut left = 0;
    let mut killed = 0;
    while killed < kills {
        let signal = SIGNALS[(tally.kills + killed) % SIGNALS.len()];
        let late = quiet(&resume, signal, rng);
        let found = if map.exists() { files(&map) } else { BTreeMap::new() };
        for (name, bytes) in found.iter().filter(|(name, _)| !name.starts_with("tmp")) {
            assert!(expected.get(name) == Some(bytes), "{source}: {} is wrong", name.display());
        }
        let now = unfinished_files(&found).len();
        if late {
            assert_eq!(found.len(), expected.len(), "{source}: complete, and nothing left");
            fs::remove_dir_all(&map).expect("folder");
            (left, tally.late) = (0, tally.late + 1);
            continue;
        }
        // A killed process may leave two temporary files: the part that was being solved, and the
        // previous part, which had not been renamed yet.
        let more = if signal == "-KILL" { 2 } else { 0 };
        let names = found.keys();
        assert!((left..=left + more).contains(&now), "{source} {signal}: {left}, {names:?}");
        tally.left_by_sigkill += now - left;
        tally.parts_at_kills += found.keys().filter(|name| name.starts_with("data")).count();
        (left, killed) = (now, killed + 1);
    }
    tally.kills += killed;
    let resumed = run(&resume, dir.path());
    let told = |output: &Output| stderr(output).replace("whole/", "map/");
    assert_eq!(resumed.status.code(), undisturbed.status.code());
    assert_eq!(told(&resumed), told(&undisturbed));
    assert!(files(&map) == expected, "{source}: not the same folder");

    // The second group of runs writes a single file.
    let args = points.args(source, "out.csv");
    let out = dir.path().join("out.csv");
    killed = 0;
    while killed < kills {
        fs::write(&out, "former").expect("writable");
        let signal = SIGNALS[(tally.kills + killed) % SIGNALS.len()];
        let late = quiet(&args, signal, rng);
        let bytes = fs::read(&out).expect("there");
        assert!(bytes == table || !late && bytes == b"former", "{source}: neither old nor new");
        let found = files(dir.path());
        let left = unfinished_files(&found);
        assert!(left.is_empty() || signal == "-KILL" && left.len() == 1, "{signal}: {left:?}");
        if let [left] = left[..] {
            fs::remove_file(dir.path().join(left)).expect("removable");
            tally.left_by_sigkill += 1;
        }
        if late {
            tally.late += 1;
        } else {
            killed += 1;
        }
    }
    tally.kills += killed;
}

fn campaign(loads: usize, kills: usize, seed: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let points = Points::new(loads);
    let mut tally = Tally::default();
    for source in ["grid", "points.csv", "points.jsonl", "points.parquet"] {
        kill_runs(source, &points, kills, &mut rng, &mut tally);
    }
    tally
}

#[test]
fn resumed_runs_write_bit_identical_files() {
    let tally = campaign(2_000, 1, 15);
    assert_eq!(tally.kills, 8);
}

#[test]
#[ignore = "minutes: `just kills`"]
fn resumed_runs_write_bit_identical_files_after_104_kills() {
    // For each of four sources of points, 13 runs that write a dataset and 13 runs that write a
    // single file are killed.
    let tally = campaign(4_000, 13, 2026);
    assert_eq!(tally.kills, 104);
    println!("0 wrong bytes: {tally:?}");
}

/// A function that damages a dataset.
type Harm<'a> = Box<dyn Fn() + 'a>;

/// Expected reaction of `--resume` to a damaged dataset.
enum Reaction {
    /// The run fails with the given exit code and message, and the damaged file is kept.
    Refused(i32, &'static str),
    /// The damaged part is solved again, and the dataset becomes identical to the dataset of an
    /// undisturbed run.
    Healed,
}

use Reaction::{Healed, Refused};

/// Regression test: `--resume` checked only whether the path of a part exists.
#[test]
#[expect(clippy::too_many_lines, reason = "a list of kinds of damage")]
fn resume_verifies_finished_parts() {
    let dir = folder();
    let points = Points::new(20);
    let args = points.args("grid", "map/");
    let undisturbed = run(&args, dir.path());
    assert_eq!(undisturbed.status.code(), Some(3));
    let map = dir.path().join("map");
    let expected = files(&map);
    // The folder contains 16 parts, the plan and the list of parts. The subfolder `data/` contains
    // only parts.
    assert_eq!(expected.len(), 18);
    let parts = expected.keys().filter(|name| name.starts_with("data"));
    assert!(
        parts.clone().count() == 16
            && parts.clone().all(|p| p.extension().is_some_and(|e| e == "parquet"))
    );
    let other = [points.args("grid", "other/"), to_strings(&["--set=density_kg_m3=7000"])].concat();
    assert_eq!(run(&other, dir.path()).status.code(), Some(3));
    let resume = [&args[..], &to_strings(&["--resume"])].concat();

    let part = map.join("data/part-000003.parquet");
    let bytes = fs::read(&part).expect("a part");
    let flipped = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 4;
        bytes
    };
    let fifo = |path: &Path| {
        fs::remove_file(path).expect("removable");
        assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo").success());
    };
    let plan = map.join("plan.json");
    let text = fs::read_to_string(&plan).expect("a plan");
    let foreign = map.join("data/notes.txt");
    let target = part.as_path();
    let put = |bytes: Vec<u8>| -> Harm<'_> {
        Box::new(move || fs::write(target, &bytes).expect("writable"))
    };
    let end = bytes.len();
    let broken =
        "not a part file of bsm; move it elsewhere and solve the missing parts again with --resume";
    let damages: Vec<(&str, Harm<'_>, Reaction)> = vec![
        ("cut to 100 bytes", put(bytes[..100].to_vec()), Refused(3, broken)),
        ("cut by a byte", put(bytes[..end - 1].to_vec()), Refused(3, broken)),
        ("emptied", put(Vec::new()), Refused(3, "part-000003.parquet is empty; move it elsewhere")),
        (
            "a bit of the data",
            put(flipped(500)),
            Refused(3, "has been changed: its bytes do not match"),
        ),
        ("a bit of the first letters", put(flipped(0)), Refused(3, "has been changed: its bytes")),
        ("a bit of the footer", put(flipped(end - 1500)), Refused(3, broken)),
        ("a bit of the length of the footer", put(flipped(end - 8)), Refused(3, broken)),
        ("a bit of the last letters", put(flipped(end - 1)), Refused(3, broken)),
        ("a byte more", put([&bytes[..], b"x"].concat()), Refused(3, broken)),
        ("a text", put(b"mine, do not touch".to_vec()), Refused(3, broken)),
        (
            "copy of another part",
            put(fs::read(map.join("data/part-000004.parquet")).expect("a part")),
            Refused(3, "is a copy of part 4"),
        ),
        (
            "part of another plan",
            put(fs::read(dir.path().join("other/data/part-000003.parquet")).expect("a part")),
            Refused(3, "is a part of another plan"),
        ),
        (
            "a folder",
            Box::new(|| {
                fs::remove_file(&part).expect("removable");
                fs::create_dir(&part).expect("a folder");
            }),
            Refused(3, "is a folder, not a file"),
        ),
        ("a pipe", Box::new(|| fifo(&part)), Refused(3, "is a pipe or a device, not a file")),
        (
            "a link to the right bytes",
            Box::new(|| {
                fs::rename(&part, map.join("moved")).expect("movable");
                symlink(map.join("moved"), &part).expect("a link");
            }),
            Refused(3, "is a link, not a file"),
        ),
        (
            "one too many",
            Box::new(|| {
                fs::copy(&part, map.join("data/part-000016.parquet")).expect("a copy");
            }),
            Refused(3, "part-000016.parquet the plan has no part with this name"),
        ),
        (
            "another way to write a number",
            Box::new(|| {
                fs::copy(&part, map.join("data/part-3.parquet")).expect("a copy");
            }),
            Refused(3, "part-3.parquet the plan has no part with this name"),
        ),
        (
            "five of them",
            Box::new(|| {
                for i in 3..8 {
                    let part = map.join(format!("data/part-00000{i}.parquet"));
                    fs::write(part, "").expect("writable");
                }
            }),
            Refused(3, "part-000005.parquet is empty; and 2 more; move them elsewhere"),
        ),
        ("no part", Box::new(|| fs::remove_file(&part).expect("removable")), Healed),
        (
            "no folder of parts",
            Box::new(|| fs::remove_dir_all(map.join("data")).expect("removable")),
            Healed,
        ),
        (
            "an emptied plan",
            Box::new(|| fs::write(&plan, "").expect("writable")),
            Refused(2, "plan.json is not the plan of this task: it is empty"),
        ),
        (
            "a bit of the plan",
            Box::new(|| {
                fs::write(&plan, text.replace("\"rows\":", "\"rowr\":")).expect("writable");
            }),
            Refused(2, "plan.json is not the plan of this task: it is damaged"),
        ),
        (
            "another plan",
            Box::new(|| {
                fs::copy(dir.path().join("other/plan.json"), &plan).expect("a copy");
            }),
            Refused(2, "holds the parts of another task, which differs in: base"),
        ),
        (
            "results of another revision",
            Box::new(|| {
                let other = text.replace("\"results\":", "\"results\":1000");
                fs::write(&plan, other).expect("writable");
            }),
            Refused(2, "which differs in: program"),
        ),
        ("a plan that is a pipe", Box::new(|| fifo(&plan)), Refused(2, "it is a pipe or a device")),
        (
            "no plan",
            Box::new(|| fs::remove_file(&plan).expect("removable")),
            Refused(2, "map/ is a folder that contains other files"),
        ),
        (
            "a damaged list",
            Box::new(|| fs::write(map.join("parts.parquet"), "PAR1").expect("writable")),
            Healed,
        ),
        (
            "no list",
            Box::new(|| fs::remove_file(map.join("parts.parquet")).expect("removable")),
            Healed,
        ),
        (
            "a file of somebody else",
            Box::new(|| fs::write(&foreign, "mine").expect("writable")),
            Refused(
                3,
                "warning: map/data/notes.txt does not belong to this table and was left in place",
            ),
        ),
    ];
    assert!(damages.len() >= 20);
    for (what, harm, said) in &damages {
        harm();
        let damaged = files(&map);
        let output = run(&resume, dir.path());
        match said {
            Refused(code, words) => {
                assert_eq!(output.status.code(), Some(*code), "{what}: {}", stderr(&output));
                assert!(stderr(&output).contains(words), "{what}: {}", stderr(&output));
                assert!(files(&map) == damaged, "{what} is not left as it was");
            }
            Healed => {
                assert_eq!(output.status.code(), Some(3), "{what}: {}", stderr(&output));
                assert_eq!(stderr(&output), stderr(&undisturbed), "{what}");
                assert!(files(&map) == expected, "{what}");
            }
        }
        // As the message advises, the changed files are removed and the plan is restored.
        for name in files(&map).keys() {
            let path = map.join(name);
            if !path.is_file()
                || path.is_symlink()
                || fs::read(&path).ok() != expected.get(name).cloned().flatten()
            {
                fs::remove_file(path).expect("removable");
            }
        }
        if part.is_dir() {
            fs::remove_dir(&part).expect("removable");
        }
        fs::write(&plan, &text).expect("writable");
        let output = run(&resume, dir.path());
        assert_eq!(output.status.code(), Some(3), "{what}: {}", stderr(&output));
        assert_eq!(stderr(&output), stderr(&undisturbed), "{what}");
        assert!(files(&map) == expected, "{what}: not the same folder again");
    }
    println!("0 silent acceptances: {} kinds of damage", damages.len());
}

/// Regression test: if the plan file was empty and the grid was different, the results of two tasks
/// were mixed.
#[test]
fn resume_rejects_a_different_grid() {
    let dir = folder();
    let run = |args: Vec<String>| run(&args, dir.path());
    let args =
        |loads, more: &[&str]| [Points::new(loads).args("grid", "map/"), to_strings(more)].concat();
    assert_eq!(run(args(20, &[])).status.code(), Some(3));
    let before = files(&dir.path().join("map"));
    for (args, words) in [
        (
            args(20, &[]),
            "map/ holds the parts of this task; continue with --resume, or use another folder",
        ),
        (args(24, &[]), "map/ holds the parts of another task; continue with --resume"),
        (
            args(24, &["--resume"]),
            "which differs in: points, rows (80, now 96), rows_per_part (5, now 6)",
        ),
        (
            args(20, &["--resume", "--set=density_kg_m3=7000"]),
            "another task, which differs in: base",
        ),
        (
            args(20, &["--resume"]).iter().map(|arg| arg.replace("elastic", "rigid")).collect(),
            "another task, which differs in: model",
        ),
    ] {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    fs::write(dir.path().join("map/plan.json"), "").expect("writable");
    assert_eq!(run(args(24, &["--resume"])).status.code(), Some(2));
    let after = files(&dir.path().join("map"));
    assert_eq!(before.len(), after.len());
    assert!(
        before.iter().all(|(name, bytes)| name.ends_with("plan.json") || after[name] == *bytes)
    );
}

/// Regression test: neither the exit code nor the note of a resumed run took into account rows
/// without a result in parts that had been finished earlier.
#[test]
fn a_resumed_run_counts_failed_rows_of_finished_parts() {
    let dir = folder();
    let args = Points::new(20).args("grid", "map/");
    let first = run(&args, dir.path());
    assert_eq!(first.status.code(), Some(3));
    assert_eq!(
        stderr(&first),
        "note: 20 of 80 rows have no result; see column `message` in map/\n"
    );
    let resumed = run(&[&args[..], &to_strings(&["--resume"])].concat(), dir.path());
    assert_eq!((resumed.status.code(), stderr(&resumed)), (Some(3), stderr(&first)));
    let more = to_strings(&["--resume", "--keep-going"]);
    let asked = run(&[&args[..], &more].concat(), dir.path());
    assert_eq!((asked.status.code(), stderr(&asked)), (Some(0), stderr(&first)));
}

/// Regression test: `--resume` deleted the user's own files with names of the form `.bsm-*`.
#[test]
fn resume_keeps_temporary_files_of_the_user() {
    let dir = folder();
    let args = Points::new(20).args("grid", "map/");
    assert_eq!(run(&args, dir.path()).status.code(), Some(3));
    let tmp = dir.path().join("map/tmp");
    let plan = fs::read(dir.path().join("map/plan.json")).expect("a plan");
    let plan: Value = serde_json::from_slice(&plan).expect("JSON");
    let id = plan["sha256"].as_str().expect("its hash")[..12].to_owned();
    let ours = [format!("part-000003.{id}.AbCd1234"), format!("parts.{id}.AbCd1234")];
    let others = [
        ".bsm-notes".to_owned(),
        "part-000003.parquet".to_owned(),
        "part-000003.0123456789ab.AbCd1234".to_owned(),
        format!("part-x.{id}.AbCd1234"),
        format!("part-000003.{id}.mine"),
    ];
    for name in ours.iter().chain(&others) {
        fs::write(tmp.join(name), "kept?").expect("writable");
    }
    fs::write(dir.path().join("map/.bsm-notes"), "mine").expect("writable");
    let output = run(&[&args[..], &to_strings(&["--resume"])].concat(), dir.path());
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(ours.iter().all(|name| !tmp.join(name).exists()));
    assert!(others.iter().all(|name| tmp.join(name).exists()));
    assert!(dir.path().join("map/.bsm-notes").exists());
}

/// Regression test: the program waited forever if a pipe replaced the plan file or the table of
/// points.
#[test]
fn run_does_not_wait_forever_if_a_named_pipe_replaces_an_input_file() {
    let dir = folder();
    let fifo = |name: &str| {
        let made = Command::new("mkfifo").arg(dir.path().join(name)).status();
        assert!(made.expect("mkfifo").success());
    };
    fs::create_dir(dir.path().join("map")).expect("folder");
    fifo("map/plan.json");
    fifo("points.csv");
    fifo("points.parquet");
    let points = Points::new(20);
    let resume = |source: &str| [points.args(source, "map/"), to_strings(&["--resume"])].concat();
    for (args, words) in [
        (resume("grid"), "map/plan.json is not the plan of this task: it is a pipe or a device"),
        (points.args("grid", "map/"), "holds the parts of another task"),
        (
            resume("points.csv"),
            "points.csv: the points for a folder of parts must come from a file",
        ),
        (
            resume("points.parquet"),
            "points.parquet: the points for a folder of parts must come from a file",
        ),
        (resume("-"), "standard input: the points for a folder of parts must come from a file"),
    ] {
        let output = run(&args, dir.path());
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
}

#[test]
fn error_for_a_run_that_cannot_be_resumed_suggests_a_remedy() {
    let dir = folder();
    let points = Points::new(20);
    let resume = |output: &str| {
        let args: Vec<_> = points.args("grid", output);
        run(&[&args[..], &to_strings(&["--resume"])].concat(), dir.path())
    };
    for (output, words) in [
        (
            "x.csv",
            "--resume cannot continue x.csv: a single table is only written when it is complete",
        ),
        ("x.parquet", "write a folder of parts with -o x/, which --resume can continue"),
        ("-", "--resume cannot continue standard output"),
    ] {
        let said = resume(output);
        assert_eq!(said.status.code(), Some(2));
        assert!(stderr(&said).contains(words), "{}", stderr(&said));
    }
    // This folder imitates a dataset of an earlier version.
    fs::create_dir(dir.path().join("old")).expect("folder");
    fs::write(dir.path().join("old/parts.json"), "{}").expect("writable");
    fs::write(dir.path().join("old/part-000000.parquet"), "PAR1").expect("writable");
    let said = resume("old/");
    assert_eq!(said.status.code(), Some(2));
    assert!(
        stderr(&said).contains("old/ holds the parts of an older version of bsm"),
        "{}",
        stderr(&said)
    );
    assert_eq!(fs::read_dir(dir.path().join("old")).expect("folder").count(), 2);
    assert_eq!(fs::read_dir(dir.path()).expect("folder").count(), 1);
}
