//! Tests of datasets that are solved by many processes. Some processes are killed, compete for the
//! same parts or find damaged files. The dataset must be bit-identical to the dataset of a single
//! process, or a clear error must be reported. `just faults` runs the long version of these tests.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::program::{bsm, folder, stderr, stdout};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn drive() -> String {
    format!("{ROOT}/examples/feed_drive.json")
}

/// Returns all files in a folder and its subfolders except temporary files.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("folder") {
            let path = entry.expect("entry").path();
            let name = path.strip_prefix(folder).expect("below").to_owned();
            if path.is_dir() {
                folders.push(path);
            } else if !name.starts_with("tmp") {
                found.insert(name, fs::read(&path).expect("file"));
            }
        }
    }
    found
}

/// Runs the program, checks its exit code, and returns standard output followed by standard error.
fn run_checked(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = bsm(folder, args, "");
    let words = stdout(&output) + &stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {words}");
    words
}

/// Returns the arguments of a sweep over loads that is divided into parts. A quarter of the rows
/// have no result.
fn sweep<'a>(drive: &'a str, loads: &'a str, output: &'a str, rows: &'a str) -> Vec<&'a str> {
    let vary = ["--vary", loads, "--vary=friction_coefficient=0.05,0.1,0.15,12"];
    let how = ["--model=elastic", "--columns=efficiency,ball_torque_Nm", "--rows-per-part", rows];
    [&["sweep", drive][..], &vary, &how, &["-o", output]].concat()
}

fn spawn(folder: &Path, args: &[&str]) -> Child {
    // The parent process may ignore signals, so the default signal handlers are restored.
    let mut command = Command::new("env");
    command.arg("--default-signal").arg(env!("CARGO_BIN_EXE_bsm")).args(args).current_dir(folder);
    let null = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    null.spawn().expect("the program starts")
}

#[test]
fn several_processes_solve_one_plan_and_write_parts_that_pass_verification() {
    let dir = folder();
    let run = |code, args: &[&str]| run_checked(dir.path(), code, args);
    let (drive, loads) = (drive(), "axial_load_N=500:9000:100");
    run(3, &sweep(&drive, loads, "whole/", "40"));
    let expected = files(&dir.path().join("whole"));

    let plan = [&sweep(&drive, loads, "map/", "40")[..], &["--plan"]].concat();
    for _ in 0..2 {
        let said = run(0, &plan);
        assert!(said.contains("parts       10 of 40 rows\n"), "{said}");
        assert!(
            said.contains("rows        400\n") && said.contains("core-hours  0.000\n"),
            "{said}"
        );
        assert!(!said.contains("in memory"), "only for many rows: {said}");
    }
    let other = [&sweep(&drive, loads, "map/", "50")[..], &["--plan"]].concat();
    let said = run(2, &other);
    assert!(said.contains("differs in: rows_per_part (40, now 50)"), "{said}");
    assert!(!said.contains("--resume"), "not requested: {said}");
    assert!(run(2, &sweep(&drive, loads, "map/", "40")).contains("continue with --resume"));
    assert!(run(3, &["parts", "check", "map/"]).contains("missing  0:10\n"));

    let said = run(0, &["parts", "run", "map/", "--only", "1/3"]);
    assert!(said.contains("solved 3 of 10 parts (0 already finished)"), "{said}");
    assert!(
        run(0, &["parts", "run", "map/", "--only", "3:5"])
            .contains("solved 1 of 10 parts (1 already finished)")
    );
    let said = run(3, &["parts", "check", "map/"]);
    assert!(said.starts_with("4 of 10 parts"), "{said}");
    assert!(said.contains("missing  0:1\nmissing  2:3\nmissing  5:7\nmissing  8:10\n"), "{said}");
    assert!(!dir.path().join("map/parts.parquet").exists());
    for (args, words) in [
        (&["--only", "5:11"][..], "is outside the parts 0:10 of the plan"),
        (&["--only", "5:5"], "such as 0:100"),
        (&["--only", "3/3"], "I from 0 to N - 1"),
        (&["--only", "3"], "must be I/N"),
        (&["--only", "0/0"], "invalid value"),
    ] {
        let said = run(2, &[&["parts", "run", "map/"][..], args].concat());
        assert!(said.contains(words), "{said}");
    }
    run(0, &["parts", "run", "map/", "--threads", "1"]);
    let said = run(0, &["parts", "check", "map/"]);
    assert!(said.contains("10 of 10 parts") && said.contains("100 without a result"), "{said}");
    assert!(files(&dir.path().join("map")) == expected, "not the bytes of one run");
    assert!(run(1, &["parts", "check", "nowhere/"]).contains("nowhere/plan.json"));
}

/// An unrelated or damaged file that has the name of a part must be reported and kept. It must be
/// replaced only on request.
#[test]
fn damaged_files_are_found_and_repaired() {
    let dir = folder();
    let run = |code, args: &[&str]| run_checked(dir.path(), code, args);
    let (drive, loads) = (drive(), "axial_load_N=500:9000:100");
    run(3, &sweep(&drive, loads, "map/", "40"));
    run(3, &[&sweep(&drive, loads, "other/", "40")[..], &["--set=density_kg_m3=7000"]].concat());
    let map = dir.path().join("map");
    let expected = files(&map);
    let part = map.join("data/part-000003.parquet");
    let good = fs::read(&part).expect("a part");
    let mut flipped = good.clone();
    flipped[500] ^= 4;
    let foreign = fs::read(dir.path().join("other/data/part-000003.parquet")).expect("a part");
    let copy = fs::read(map.join("data/part-000004.parquet")).expect("a part");
    for (bytes, is_shallow, words) in [
        (flipped, false, "has been changed: its bytes do not match the SHA-256"),
        (good[..good.len() / 2].to_vec(), true, "has an invalid footer"),
        (Vec::new(), true, "is empty"),
        (foreign, true, "is a part of another plan"),
        (copy, true, "is a copy of part 4"),
    ] {
        fs::write(&part, &bytes).expect("writable");
        if is_shallow {
            assert!(run(3, &["parts", "check", "map/"]).contains(words));
            let said = run(3, &["parts", "run", "map/"]);
            assert!(said.contains(words) && said.contains("--repair"), "{said}");
        } else {
            run(0, &["parts", "check", "map/"]);
        }
        let said = run(3, &["parts", "check", "map/", "--deep"]);
        assert!(
            said.contains("damaged  map/data/part-000003.parquet") && said.contains(words),
            "{said}"
        );
        assert!(said.contains("or replace it with `bsm parts run map/ --repair`"), "{said}");
        let found: Value =
            serde_json::from_str(&run(3, &["parts", "check", "map/", "--deep", "--json"]))
                .expect("JSON");
        assert_eq!((&found["missing"][0], &found["finished"]), (&"3:4".into(), &9.into()));
        assert_eq!(found["damaged"][0]["file"], "map/data/part-000003.parquet");
        assert!(fs::read(&part).expect("left") == bytes, "{words}");
        run(0, &["parts", "run", "map/", "--repair"]);
        run(0, &["parts", "check", "map/", "--deep"]);
        assert!(files(&map) == expected, "{words}");
    }
    // Adds a part that is not in the plan, and an unrelated file.
    fs::write(map.join("data/part-000010.parquet"), "").expect("writable");
    fs::write(map.join("data/notes.txt"), "").expect("writable");
    let said = run(3, &["parts", "check", "map/"]);
    assert!(said.contains("part-000010.parquet the plan has no part with this name"), "{said}");
    assert!(said.contains("move it elsewhere") && !said.contains("--repair"), "{said}");
    assert!(run(3, &["parts", "run", "map/"]).contains("move it elsewhere"));
    let copy = map.join("data/other.parquet");
    fs::rename(map.join("data/part-000010.parquet"), &copy).expect("movable");
    assert!(run(3, &["parts", "check", "map/"]).contains("other.parquet the plan has no part"));
    fs::rename(copy, map.join("data/part-000010.parquet")).expect("movable");
    assert!(said.contains("foreign  map/data/notes.txt"), "{said}");
    fs::remove_file(map.join("data/part-000010.parquet")).expect("removable");
    assert!(run(0, &["parts", "check", "map/"]).contains("foreign  map/data/notes.txt"));
    fs::write(map.join("plan.json"), "{}").expect("writable");
    assert!(run(2, &["parts", "run", "map/"]).contains("is not the plan"));
}

/// Starts several processes that solve all parts, kills them at random moments and restarts them
/// until all parts exist.
///
/// Returns the number of killed processes and the number of temporary files that they left behind.
fn race_processes(processes: usize, kills: usize, seed: u64) -> (usize, usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let dir = folder();
    let (drive, loads) = (drive(), "axial_load_N=500:9000:2500");
    run_checked(dir.path(), 3, &sweep(&drive, loads, "whole/", "100"));
    let expected = files(&dir.path().join("whole"));
    let map = dir.path().join("map");
    let plan = [&sweep(&drive, loads, "map/", "100")[..], &["--plan"]].concat();
    let start = || {
        let args = ["parts", "run", "map/", "--threads=1", "--quiet"];
        (0..processes).map(|_| spawn(dir.path(), &args)).collect::<Vec<_>>()
    };
    // Measures how long the processes take to solve all parts in an empty folder.
    run_checked(dir.path(), 0, &plan);
    let begin = Instant::now();
    for mut child in start() {
        assert!(child.wait().expect("ends").success());
    }
    let time = begin.elapsed();
    assert!(fs::read_dir(map.join("tmp")).expect("folder").next().is_none(), "none was killed");
    run_checked(dir.path(), 0, &["parts", "check", "map/"]);
    assert!(files(&map) == expected, "a race changes bytes");
    fs::remove_dir_all(&map).expect("removable");
    run_checked(dir.path(), 0, &plan);

    let (mut killed, mut left) = (0, 0);
    while killed < kills {
        let mut children = start();
        sleep(time.mul_f64(rng.random_range(0.0..0.3)));
        for child in &mut children {
            // Only a process that is still running is killed.
            if child.try_wait().expect("a child").is_none() {
                child.kill().expect("killed");
                killed += usize::from(child.wait().expect("ends").code().is_none());
            }
            sleep(time.mul_f64(rng.random_range(0.0..0.02)));
        }
        for (name, bytes) in files(&map) {
            assert!(expected.get(&name) == Some(&bytes), "{} is wrong", name.display());
        }
        left = left.max(fs::read_dir(map.join("tmp")).expect("folder").count());
        if fs::read_dir(map.join("data")).expect("folder").count() == 100 {
            run_checked(dir.path(), 0, &["parts", "check", "map/", "--deep"]);
            assert!(files(&map) == expected);
            fs::remove_dir_all(&map).expect("removable");
            run_checked(dir.path(), 0, &plan);
        }
    }
    run_checked(dir.path(), 0, &["parts", "run", "map/", "--quiet"]);
    run_checked(dir.path(), 0, &["parts", "check", "map/", "--deep"]);
    assert!(files(&map) == expected, "not the bytes of one run");
    assert!(fs::read_dir(map.join("tmp")).expect("folder").next().is_none(), "verify tidies up");
    (killed, left)
}

#[test]
fn killed_and_restarted_runs_write_bit_identical_parts() {
    let (killed, _) = race_processes(2, 10, 3701);
    assert!(killed >= 10);
}

#[test]
#[ignore = "minutes: `just faults`"]
fn runs_killed_150_times_write_bit_identical_parts() {
    let (two, of_two) = race_processes(2, 100, 3702);
    let (three, of_three) = race_processes(3, 50, 3703);
    assert!(two + three >= 150);
    println!(
        "0 wrong bytes, 0 lost: {two} kills of two processes, {three} of three; at most {of_two} and {of_three} unfinished files at a time"
    );
}

/// A modification of a complete dataset.
struct Modification {
    what: String,
    /// True if the modification only affects bytes before a footer, so that a check of the footers
    /// cannot detect it.
    is_hidden: bool,
    does: Box<dyn Fn(&Path)>,
}

fn part_name(number: usize) -> String {
    format!("data/part-{number:06}.parquet")
}

/// Returns sixty different modifications of a complete dataset. The seed determines where and how
/// the files are changed.
#[expect(clippy::too_many_lines, reason = "sixty kinds, one after the other")]
fn modifications(seed: u64, other: &Path) -> Vec<Modification> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut all = Vec::new();
    let mut add = |what: String, is_hidden, does: Box<dyn Fn(&Path)>| {
        all.push(Modification { what, is_hidden, does });
    };
    // The number `begin` is the relative position in a part: 0 to 1 in the data, 1 to 2 in the
    // footer, and 2 in the last bytes.
    for round in 0..2 {
        for (region, begin, is_hidden) in [
            ("magic", 0.0, true),
            ("pages", 0.3, true),
            ("end of the data", 1.0, true),
            ("footer", 1.3, false),
            ("end of the footer", 1.9, false),
            ("tail", 2.0, false),
        ] {
            let (number, bit) = (rng.random_range(0..10), 1_u8 << rng.random_range(0..8));
            let place: f64 =
                begin + if region == "pages" { rng.random_range(0.0..0.6) } else { 0.0 };
            let zeros = round == 1 && region == "pages";
            let change = move |map: &Path| {
                let path = map.join(part_name(number));
                let mut bytes = fs::read(&path).expect("a part");
                let len = bytes.len();
                let tail: [u8; 4] = bytes[len - 8..len - 4].try_into().expect("four");
                let footer = u32::from_le_bytes(tail) as usize;
                let data = len - 8 - footer;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a place"
                )]
                #[expect(clippy::cast_precision_loss, reason = "a place")]
                let at = match place {
                    place if place >= 2.0 => len - 1 - round * 6,
                    place if place > 1.0 => data + ((place - 1.0) * footer as f64) as usize,
                    place => ((place * data as f64) as usize).min(data - 1),
                };
                if zeros {
                    // The bytes to be overwritten must not already be zero.
                    let end = (at + 512).min(data);
                    assert!(bytes[at..end].iter().any(|byte| *byte != 0));
                    bytes[at..end].fill(0);
                } else {
                    bytes[at] ^= bit;
                }
                fs::write(path, bytes).expect("writable");
            };
            let how = if zeros { "512 zeros in" } else { "a bit of" };
            add(
                format!("{how} the {region} of part {number}, {round}"),
                is_hidden,
                Box::new(change),
            );
        }
    }
    for keep in [0.0, 0.01, 0.5, 0.9, 0.99] {
        let number = rng.random_range(0..10);
        add(
            format!("part {number} cut to {keep}"),
            false,
            Box::new(move |map| {
                let path = map.join(part_name(number));
                let bytes = fs::read(&path).expect("a part");
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a place"
                )]
                #[expect(clippy::cast_precision_loss, reason = "a place")]
                let end = (keep * bytes.len() as f64) as usize;
                fs::write(path, &bytes[..end]).expect("writable");
            }),
        );
    }
    for (what, before, after) in [
        ("a byte behind", "", "x"),
        ("zeros behind", "", "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"),
        ("a byte before", "x", ""),
        ("PAR1 behind", "", "PAR1"),
    ] {
        let number = rng.random_range(0..10);
        add(
            format!("{what} part {number}"),
            false,
            Box::new(move |map| {
                let path = map.join(part_name(number));
                let bytes = fs::read(&path).expect("a part");
                fs::write(path, [before.as_bytes(), &bytes, after.as_bytes()].concat())
                    .expect("writable");
            }),
        );
    }
    for text in ["", "PAR1", "mine", "PAR1\u{8}\0\0\0PAR1"] {
        let number = rng.random_range(0..10);
        add(
            format!("part {number} is {text:?}"),
            false,
            Box::new(move |map| {
                fs::write(map.join(part_name(number)), text).expect("writable");
            }),
        );
    }
    for (what, from_other) in [("another plan", true), ("this plan", false)] {
        for _ in 0..2 {
            let (number, by) = (rng.random_range(0..10), rng.random_range(1..10));
            let other = other.to_owned();
            let from = if from_other { number } else { (number + by) % 10 };
            add(
                format!("part {number} is part {from} of {what}"),
                false,
                Box::new(move |map| {
                    let folder = if from_other { &other } else { map };
                    fs::copy(folder.join(part_name(from)), map.join(part_name(number)))
                        .expect("writable");
                }),
            );
        }
    }
    for count in [1, 2, 5, 10] {
        let first: usize = rng.random_range(0..10);
        add(
            format!("{count} parts removed"),
            false,
            Box::new(move |map| {
                (0..count).for_each(|i| {
                    fs::remove_file(map.join(part_name((first + i) % 10))).expect("a part");
                });
            }),
        );
    }
    let (one, by) = (rng.random_range(0..10_usize), rng.random_range(1..10));
    add(
        "two parts swapped".to_owned(),
        false,
        Box::new(move |map| {
            let [one, two, away] = [part_name(one), part_name((one + by) % 10), "away".to_owned()]
                .map(|n| map.join(n));
            fs::rename(&one, &away).expect("a part");
            fs::rename(&two, &one).expect("a part");
            fs::rename(&away, &two).expect("a part");
        }),
    );
    for what in ["a folder", "a link"] {
        let number = rng.random_range(0..10);
        add(
            format!("part {number} is {what}"),
            false,
            Box::new(move |map| {
                let (path, away) = (map.join(part_name(number)), map.join("../away"));
                fs::rename(&path, &away).expect("a part");
                match what {
                    "a folder" => fs::create_dir(&path).expect("a folder"),
                    _ => symlink(away, &path).expect("a link"),
                }
            }),
        );
    }
    for too_many in [
        "part-000010.parquet",
        "part-2.parquet",
        "part-0000003.parquet",
        "part-x.parquet",
        "part-.parquet",
        "other.parquet",
        "PART-000002.parquet",
    ] {
        let from = rng.random_range(0..10);
        add(
            format!("{too_many} too many"),
            false,
            Box::new(move |map| {
                fs::copy(map.join(part_name(from)), map.join("data").join(too_many))
                    .expect("writable");
            }),
        );
    }
    for (from, to) in [
        ("6:9000:100", "6:9001:100"),
        (":9000:100", ":9000:200"),
        ("closed-form", "quasi-static"),
        ("\"rows\":100", "\"rows\":200"),
        ("rows_per_part\":10", "rows_per_part\":20"),
        ("}\n", "}"),
        ("{\"format\"", " {\"format\""),
        ("efficiency", "slide_to_roll"),
        ("\"tolerance\":0.01", "\"tolerance\":0.010"),
        ("\"sha256\":\"", "\"sha256\":\"0"),
        ("", ""),
    ] {
        add(
            format!("plan with {to:?} for {from:?}"),
            false,
            Box::new(move |map| {
                let path = map.join("plan.json");
                let plan = fs::read_to_string(&path).expect("a plan");
                let changed =
                    if from.is_empty() { String::new() } else { plan.replacen(from, to, 1) };
                let changed =
                    if changed == plan { plan.replacen("500", "501", 1) } else { changed };
                assert_ne!(changed, plan, "{from}");
                fs::write(path, changed).expect("writable");
            }),
        );
    }
    let plan = other.join("plan.json");
    add(
        "plan of another folder".to_owned(),
        false,
        Box::new(move |map| {
            fs::copy(&plan, map.join("plan.json")).expect("writable");
        }),
    );
    for what in ["parts.parquet", "data", "tmp"] {
        add(
            format!("{what} removed"),
            false,
            Box::new(move |map| {
                let path = map.join(what);
                if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
                    .expect("removable");
            }),
        );
    }
    for bytes in ["", "mine"] {
        add(
            format!("parts.parquet is {bytes:?}"),
            false,
            Box::new(move |map| {
                fs::write(map.join("parts.parquet"), bytes).expect("writable");
            }),
        );
    }
    for what in ["data", "parts.parquet"] {
        add(
            format!("{what} of another kind"),
            false,
            Box::new(move |map| {
                let path = map.join(what);
                if path.is_dir() {
                    fs::remove_dir_all(&path).expect("removable");
                    fs::write(path, "").expect("writable");
                } else {
                    fs::remove_file(&path).expect("removable");
                    fs::create_dir(path).expect("a folder");
                }
            }),
        );
    }
    all
}

/// Applies every `step`th modification and runs every command on the modified dataset. If a command
/// exits with code 0, the dataset must be bit-identical to the dataset of an undisturbed run,
/// except for changes that a check of the footers cannot detect. No command may change an intact
/// part.
fn run_commands_on_modified_folders(seed: u64, step: usize) -> (usize, usize) {
    let dir = folder();
    let drive = drive();
    let sweep = |model: &'static str, output: &'static str| {
        let how = [model, "--columns=efficiency", "--rows-per-part=10", "-o", output];
        [&["sweep", &drive, "--vary=axial_load_N=500:9000:100"][..], &how].concat()
    };
    run_checked(dir.path(), 0, &sweep("--model=closed-form", "whole/"));
    run_checked(dir.path(), 0, &sweep("--model=quasi-static", "other/"));
    let [whole, other, map] = ["whole", "other", "map"].map(|name| dir.path().join(name));
    let expected = files(&whole);
    let kinds = modifications(seed, &other);
    assert!(kinds.len() >= 60, "{}", kinds.len());
    let resume = [&sweep("--model=closed-form", "map/")[..], &["--resume"]].concat();
    let commands: [(&str, &[&str]); 5] = [
        ("verify", &["parts", "check", "map/"]),
        ("verify --deep", &["parts", "check", "map/", "--deep"]),
        ("run", &["parts", "run", "map/"]),
        ("run --repair", &["parts", "run", "map/", "--repair"]),
        ("sweep --resume", &resume),
    ];
    let (mut runs, mut mended) = (0, 0);
    for Modification { what, is_hidden, does } in kinds.iter().step_by(step) {
        for (command, args) in commands {
            let _ = fs::remove_file(dir.path().join("away"));
            if map.exists() {
                fs::remove_dir_all(&map).expect("removable");
            }
            for (name, bytes) in &expected {
                let path = map.join(name);
                fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
                fs::write(path, bytes).expect("writable");
            }
            fs::create_dir_all(map.join("tmp")).expect("a folder");
            does(&map);
            let before = files(&map);
            let output = bsm(dir.path(), args, "");
            let told = stdout(&output) + &stderr(&output);
            let code = output.status.code().expect("no signal");
            let at = format!("{what}, {command}: exit {code}: {told}");
            assert!(matches!(code, 0..=3), "{at}");
            let after = files(&map);
            let is_part = |name: &PathBuf| name.starts_with("data");
            for (name, bytes) in expected.iter().filter(|(name, _)| is_part(name)) {
                // The command must not change parts that were intact before it ran.
                assert!(before.get(name) != Some(bytes) || after.get(name) == Some(bytes), "{at}");
            }
            mended += usize::from(code == 0 && before != after);
            let parts = |files: &BTreeMap<PathBuf, Vec<u8>>| {
                files.clone().into_iter().filter(|(name, _)| is_part(name)).collect::<Vec<_>>()
            };
            let reads_all = !matches!(command, "verify" | "run");
            let list = Path::new("parts.parquet");
            if code == 0 && command != "run" {
                let (after, expected) = (after.get(list), expected.get(list));
                // A repair does not create a missing list of parts; `parts check` does.
                let is_left = command == "run --repair" && after.is_none();
                assert!(is_left || *is_hidden || after == expected, "silent: {at}");
            }
            if code == 0 && (!is_hidden || reads_all) {
                assert!(parts(&after) == parts(&expected), "silent: {at}");
                assert!(
                    after[Path::new("plan.json")] == expected[Path::new("plan.json")],
                    "silent: {at}"
                );
            }
            runs += 1;
        }
    }
    (runs, mended)
}

#[test]
fn no_command_accepts_a_dataset_folder_with_a_modified_file() {
    let (runs, _) = run_commands_on_modified_folders(3704, 10);
    assert!(runs >= 30);
}

#[test]
#[ignore = "a minute: `just faults`"]
fn no_command_accepts_a_dataset_folder_with_any_of_sixty_modifications() {
    let (runs, mended) = run_commands_on_modified_folders(3705, 1);
    assert!(runs >= 300);
    println!("0 silent, 0 false: {runs} runs over {} kinds, {mended} mended", runs / 5);
}

/// SIGTERM and Ctrl-C must end the program before it finishes a part, and the program must leave no
/// temporary files.
#[test]
fn stopped_run_leaves_no_temporary_files() {
    let dir = folder();
    let drive = drive();
    let loads = "axial_load_N=500:9000:1000000";
    let plan = [&sweep(&drive, loads, "map/", "4000000")[..], &["--plan"]].concat();
    run_checked(dir.path(), 0, &plan);
    let tmp = dir.path().join("map/tmp");
    // Regression test: the signals that job schedulers send before a time limit expires left
    // temporary files behind.
    for (signal, code) in [
        ("-TERM", 143),
        ("-INT", 130),
        ("-XCPU", 152),
        ("-USR1", 138),
        ("-USR2", 140),
        ("-ALRM", 142),
    ] {
        let mut child = spawn(dir.path(), &["parts", "run", "map/", "--quiet"]);
        while fs::read_dir(&tmp).expect("folder").next().is_none() {
            assert!(child.try_wait().expect("a child").is_none(), "ended early");
            sleep(Duration::from_millis(5));
        }
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(killed.expect("kill").success());
        // A program that finished its part before it ended would leave this part in the folder.
        assert_eq!(child.wait().expect("ends").code(), Some(code));
        assert_eq!(fs::read_dir(&tmp).expect("folder").count(), 0);
    }
    assert_eq!(fs::read_dir(dir.path().join("map/data")).expect("folder").count(), 0);
}

/// If a folder cannot be written, the exit code must be 1, and it must be possible to continue the
/// run later. A full disk is tested on a small file system if one can be mounted.
#[test]
fn dataset_folder_without_write_access_is_reported() {
    let dir = folder();
    let (drive, loads) = (drive(), "axial_load_N=500:9000:100");
    let plan = [&sweep(&drive, loads, "map/", "40")[..], &["--plan"]].concat();
    run_checked(dir.path(), 0, &plan);
    // File permissions do not restrict the root user. A file with the name of the folder, however,
    // prevents every user from writing.
    let tmp = dir.path().join("map/tmp");
    fs::remove_dir(&tmp).expect("removable");
    fs::write(&tmp, "").expect("writable");
    assert!(run_checked(dir.path(), 1, &["parts", "run", "map/"]).contains("map/tmp"));
    fs::remove_file(&tmp).expect("removable");
    run_checked(dir.path(), 0, &["parts", "run", "map/"]);
    run_checked(dir.path(), 0, &["parts", "check", "map/"]);
}

/// The points of a plan may be random points or the rows of a table in the parent folder.
#[test]
fn plans_accept_random_points_and_tables() {
    let dir = folder();
    let run = |code, args: &[&str]| run_checked(dir.path(), code, args);
    let drive = drive();
    let common = ["--model=closed-form", "--columns=efficiency"];
    let draw = ["--draw=friction_coefficient=uniform:0.01:0.1", "--samples=1e2", "--seed=5"];
    let sweep = [&["sweep", &drive][..], &common, &draw].concat();
    let parts = ["--rows-per-part=30"];
    run(0, &[&sweep[..], &parts, &["-o", "rows/", "--plan"]].concat());
    run(0, &["parts", "run", "rows/", "--only=2:4"]);
    run(0, &["parts", "run", "rows/", "--only=0:3"]);
    run(0, &["parts", "check", "rows/", "--deep"]);
    run(0, &[&sweep[..], &["-o", "points.parquet"]].concat());

    // The rows of the table are the random points of the first plan.
    let batch = ["sweep", &drive, "--points", "points.parquet"];
    run(0, &[&batch[..], &common, &parts, &["-o", "table/", "--plan"]].concat());
    run(0, &["parts", "run", "table/", "--only=1/2"]);
    fs::rename(dir.path().join("points.parquet"), dir.path().join("moved.parquet")).expect("moved");
    assert!(run(1, &["parts", "run", "table/"]).contains("points.parquet"));
    run(0, &["parts", "run", "table/", "--points", "moved.parquet"]);
    run(0, &["parts", "check", "table/"]);
    fs::write(dir.path().join("points.parquet"), "another").expect("writable");
    assert!(
        run(2, &["parts", "run", "table/"])
            .contains("is not identical to the table of points in the plan")
    );

    for (args, words) in [
        (&["--plan", "-o", "x.csv"][..], "--plan applies only to folders"),
        (&["-o", "x.csv", "-o", "x.svg"], "plots and lookup tables need all points of a grid"),
        (&["--vary=lead_mm=5,10", "-o", "x/"], "cannot be used with"),
        (&["--draw=lead_mm=uniform:2:1", "-o", "x/"], "--draw: "),
    ] {
        let said = run(2, &[&sweep[..], args].concat());
        assert!(said.contains(words), "{said}");
    }
}

/// Writes and reads a plan with 1e12 points, and solves and verifies one of its parts. If a step
/// visited all points, this test would run for hours.
#[test]
fn part_of_a_plan_with_1e12_points_is_solved_without_the_other_parts() {
    let dir = folder();
    let drive = drive();
    // The plan has 59 604 parts of 2^24 rows and a last part of 4096 rows.
    let vary =
        ["--vary=axial_load_N=500:9000:244137985", "--vary=friction_coefficient=0.01:0.1:4096"];
    let how = ["--model=closed-form", "--columns=efficiency", "-o", "map/", "--plan"];
    let said = run_checked(dir.path(), 0, &[&["sweep", &drive][..], &vary, &how].concat());
    assert!(
        said.contains("rows        999989186560\nparts       59605 of 16777216 rows\n"),
        "{said}"
    );
    assert!(said.contains("solves parts of this plan in memory"), "{said}");
    let said = run_checked(dir.path(), 0, &["parts", "run", "map/", "--only=59604:59605"]);
    assert!(said.contains("solved 1 of 59605 parts (0 already finished)"), "{said}");
    let said = run_checked(dir.path(), 3, &["parts", "check", "map/", "--deep"]);
    assert!(said.starts_with("1 of 59605 parts") && said.contains("missing  0:59604\n"), "{said}");
    assert!(said.contains("4096 of 999989186560 rows"), "{said}");
    let size: usize = files(&dir.path().join("map")).values().map(Vec::len).sum();
    assert!(size < 200_000, "{size} bytes");
}

/// A function that solves all parts of a plan.
type Run<'a> = Box<dyn Fn() + 'a>;

/// Runs the scripts in `examples/scale-out` as ordinary processes. The schedulers are replaced by
/// simple scripts.
#[test]
fn scheduler_examples_solve_a_plan() {
    let dir = folder();
    let bin = dir.path().join("bin");
    fs::create_dir(&bin).expect("folder");
    symlink(env!("CARGO_BIN_EXE_bsm"), bin.join("bsm")).expect("a link");
    let stand_in = |name: &str, text: &str| {
        fs::write(bin.join(name), text).expect("writable");
        fs::set_permissions(bin.join(name), fs::Permissions::from_mode(0o755)).expect("mode");
    };
    stand_in("srun", "#!/bin/sh\nexec \"$@\"\n");
    // Like GNU parallel, this script runs the command that precedes `:::` once for each word that
    // follows `:::`.
    stand_in(
        "parallel",
        "#!/bin/bash\nwhile [[ $1 == --* ]]; do shift 2; done\n\
         command=(); while [[ $1 != ::: ]]; do command+=(\"$1\"); shift; done; shift\n\
         for word; do \"${command[@]/\\{\\}/$word}\" & done; wait\n",
    );
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").expect("a path"));
    let (drive, loads) = (drive(), "axial_load_N=500:9000:100");
    run_checked(dir.path(), 3, &sweep(&drive, loads, "whole/", "10"));
    let expected = files(&dir.path().join("whole"));
    let map = dir.path().join("map");
    let run = |program: &str, args: &[&str], variables: &[(&str, &str)]| {
        let mut command = Command::new(program);
        command.args(args).current_dir(dir.path()).env("PATH", &path).envs(variables.to_vec());
        let output = command.output().expect("it runs");
        assert!(output.status.success(), "{program} {args:?}: {}", stderr(&output));
    };
    let example = |name: &str| format!("{ROOT}/examples/scale-out/{name}");
    let slurm = |i: usize| {
        let index = i.to_string();
        let variables = [("SLURM_ARRAY_TASK_ID", index.as_str()), ("SLURM_CPUS_PER_TASK", "1")];
        run("sh", &[&example("slurm.sh"), "map/"], &variables);
    };
    let yaml = fs::read_to_string(example("kubernetes.yaml")).expect("an example");
    let command = yaml.lines().find_map(|line| line.trim().strip_prefix("command: "));
    let command: Vec<String> = serde_json::from_str(command.expect("a command")).expect("a list");
    let pod = |i: usize| {
        let words = command.iter().map(|word| {
            let word = if word == "/map" { "map/".to_owned() } else { word.clone() };
            word.replace("$(JOB_COMPLETION_INDEX)", &i.to_string())
        });
        let words: Vec<_> = words.collect();
        let args: Vec<_> = words[1..].iter().map(String::as_str).collect();
        run(&bin.join(&words[0]).display().to_string(), &args, &[]);
    };
    // The plan has only about 40 parts, so the other tasks of the example would have nothing to do
    // and are not run.

    let runners: [(&str, Run<'_>); 3] = [
        ("slurm.sh", Box::new(|| (0..41).for_each(&slurm))),
        ("kubernetes.yaml", Box::new(|| (0..41).for_each(&pod))),
        ("parallel.sh", Box::new(|| run("sh", &[&example("parallel.sh"), "map/"], &[]))),
    ];
    for (name, solve) in runners {
        run_checked(
            dir.path(),
            0,
            &[&sweep(&drive, loads, "map/", "10")[..], &["--plan"]].concat(),
        );
        solve();
        run_checked(dir.path(), 0, &["parts", "check", "map/"]);
        assert!(files(&map) == expected, "{name}");
        fs::remove_dir_all(&map).expect("removable");
    }
}

/// The table in the guide must agree with the plans that the program prints.
#[test]
fn numbers_in_the_scaling_guide_match_the_printed_plans() {
    let dir = folder();
    let drive = drive();
    let mut table = String::new();
    for model in ["closed-form", "traction"] {
        let what = format!("`{model}`");
        // The plans in the guide have 1000 times as many points as the plans in this test.
        for (rows, all) in [("1000000", "1e9"), ("1000000000", "1e12")] {
            let vary = format!("--vary=axial_load_N=2000:8000:{rows}");
            let model = format!("--model={model}");
            let args = ["sweep", &drive, &model, &vary, "--vary=screw_speed_rpm=100:1500:1000"];
            let how = ["--columns=efficiency", "-o", "map/", "--plan"];
            let said = run_checked(dir.path(), 0, &[&args[..], &how].concat());
            fs::remove_dir_all(dir.path().join("map")).expect("removable");
            let line = |name: &str| {
                let line = said.lines().find_map(|line| line.strip_prefix(name));
                line.unwrap_or_else(|| panic!("{name}: {said}")).trim().to_owned()
            };
            let parts = line("parts");
            let hours: f64 = line("core-hours").parse().expect("a number");
            let size = line("size");
            writeln!(
                table,
                "| {what} | {all} | {hours:.1} | {} | {parts} |",
                size.trim_end_matches(" at most"),
            )
            .expect("memory");
        }
    }
    let page = fs::read_to_string(format!("{ROOT}/docs/evidence/scale-out.md")).expect("the page");
    assert!(page.contains(&table), "the page should have:\n{table}");
}
