//! README and guides: their commands run as they stand, and print what stands below them.
#![cfg(unix)]

#[path = "../examples/remake/document.rs"]
mod document;
#[path = "../examples/remake/fast.rs"]
mod fast;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use document::{Document, bsm_arguments, documents};
use fast::{BLOCKS, Program};
use tempfile::TempDir;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

fn program() -> (TempDir, Program) {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = env!("CARGO_BIN_EXE_bsm").into();
    let program = Program::new(path, &root(), folder.path()).expect("a folder with examples");
    (folder, program)
}

fn all() -> Vec<Document> {
    documents(&root()).expect("README and docs")
}

/// Where two texts differ. Two machines may differ in times, in the last printed digit, and in
/// numbers that are rounding themselves: below 1e-10, the residual at which the solver stops.
fn difference(documented: &str, printed: &str) -> Option<String> {
    let cells = |line: &str| -> Vec<String> {
        line.split("  ").map(|cell| cell.trim().to_owned()).filter(|c| !c.is_empty()).collect()
    };
    let mut time = None;
    let (mut old, mut new) = (documented.trim().lines(), printed.trim().lines());
    loop {
        let (old, new) = match (old.next(), new.next()) {
            (None, None) => return None,
            (old, new) => (old.unwrap_or_default(), new.unwrap_or_default()),
        };
        let [mut a, mut b] = [old, new].map(cells);
        // The header of a table says which column is a time.
        time = a.iter().position(|cell| cell == "time us").or(time);
        for cells in [&mut a, &mut b] {
            if let Some(cell) = time.and_then(|place| cells.get_mut(place))
                && cell.parse::<f64>().is_ok()
            {
                "a time".clone_into(cell);
            }
        }
        let [a, b] = [a, b].map(|cells| {
            let line = cells.join(" ");
            line.split([' ', ',', ';', ':', '(', ')', '|', '`'])
                .map(str::to_owned)
                .collect::<Vec<_>>()
        });
        if a.len() != b.len() || !a.iter().zip(&b).all(|(old, new)| alike(old, new)) {
            return Some(format!("documented: {old}\nprinted:    {new}"));
        }
    }
}

fn alike(old: &str, new: &str) -> bool {
    let numbers = old.parse::<f64>().ok().zip(new.parse::<f64>().ok());
    old == new
        || numbers.is_some_and(|(x, y)| {
            let last_digit = last_digit(old).max(last_digit(new));
            // Half a unit more for the decimal fractions that doubles are not.
            (x - y).abs() <= 1.5 * last_digit || x.abs().max(y.abs()) < 1e-10
        })
}

/// One unit of the last digit of a printed number; whole numbers are counts, and exact.
fn last_digit(number: &str) -> f64 {
    let (digits, power) = number.split_once('e').unwrap_or((number, "0"));
    let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
    if decimals == 0 && power == "0" {
        return 0.0;
    }
    let decimals = i32::try_from(decimals).expect("few digits");
    10_f64.powi(power.parse::<i32>().expect("a power") - decimals)
}

#[test]
fn texts_differ_where_they_should() {
    let table = "efficiency  angle nut deg  time us  status\n0.98592  3.3e-13  3.71  converged";
    for (same, other) in [
        (true, table.to_owned()),
        (true, table.replace("3.71", "12.02")),
        (true, table.replace("3.3e-13", "-1.1e-14").replace("0.98592", "0.98593")),
        (false, table.replace("0.98592", "0.98594")),
        (false, table.replace("3.3e-13", "3.3e-9")),
        (false, table.replace("converged", "no_solution")),
        (false, table.replace("time us", "time ms")),
        (false, format!("{table}\nmore")),
        (false, String::new()),
    ] {
        assert_eq!(difference(table, &other).is_none(), same, "{other}");
    }
    assert!(difference("| a | 5e-06 | 158 pass", "| a | 6e-06 | 158 pass").is_none());
    assert!(difference("158 pass", "159 pass").is_some());
}

/// Lines of the shell that are not run here: they build, or run tests.
const SET_UP: [&str; 3] = ["cargo fetch ", "cargo build ", "cargo test "];

/// Every line of an `sh` fence runs as it stands, in the order of its document, unless it is [`SET_UP`].
/// Files that a document shows under a name are there. Commands of `sh long` fences take seconds and more
/// when they are optimised, and run with fewer points.
#[test]
fn commands_run_and_print_what_is_documented() {
    for document in all() {
        let (folder, program) = program();
        let name = document.path.display();
        let fences = document.fences();
        for (file, body) in fences.iter().filter_map(|f| Some((f.info.split_once(' ')?.1, f.body)))
        {
            if file != "long" {
                fs::write(folder.path().join(file), body).expect("a file of the document");
            }
        }
        let blocks = document.blocks().expect("markers");
        for fence in fences.iter().filter(|fence| fence.info.split(' ').next() == Some("sh")) {
            let mut printed = None;
            for line in fence.body.lines() {
                if SET_UP.iter().any(|command| line.starts_with(command)) {
                    continue;
                }
                let words = bsm_arguments(line);
                let mut words = words.unwrap_or_else(|| panic!("{name}: who runs this? {line}"));
                if fence.info == "sh long" {
                    words = with_three_points(words, folder.path());
                }
                let output = program.run(&words).expect("the program starts");
                let code = output.status.code().expect("an exit code");
                let stderr = String::from_utf8_lossy(&output.stderr);
                printed = Some(String::from_utf8(output.stdout).expect("UTF-8"));
                // A denial is an answer if the document shows it.
                let shown = |b: &document::Block| {
                    b.name == "shown"
                        && document.command_before(b.body.start).as_deref() == Some(line)
                };
                let denied = code == 3 && blocks.iter().any(shown);
                assert!(code == 0 || denied, "{name}: {line}: exit code {code}: {stderr}");
            }
            let next = fences.iter().find(|f| f.end > fence.end);
            let below = next.and_then(|next| {
                blocks.iter().find(|b| b.body.contains(&(next.end - 1)) && b.name == "shown")
            });
            if let Some(block) = below {
                let documented = &document.text[block.body.clone()];
                let printed = fast::fenced(&printed.expect("a shown command of bsm"));
                if let Some(difference) = difference(documented, &printed) {
                    panic!("{name}: `docs/remake shown` is due:\n{difference}");
                }
            }
        }
    }
}

/// The same command with three points an input, or three points in all.
fn with_three_points(mut words: Vec<String>, folder: &Path) -> Vec<String> {
    match words[0].as_str() {
        "sweep" => {
            for word in &mut words {
                if let Some((range, count)) = word.rsplit_once(':')
                    && count.parse::<usize>().is_ok()
                {
                    *word = format!("{range}:3");
                }
            }
        }
        "tradeoff" => {
            let scenes = root().join("validation/golden/tradeoff/scenes.csv");
            let scenes = fs::read_to_string(scenes).expect("the committed points");
            let few: Vec<_> = scenes.lines().take(4).collect();
            fs::write(folder.join("few.csv"), few.join("\n")).expect("a table");
            words.push("few.csv".to_owned());
        }
        other => panic!("how is {other} made short?"),
    }
    words
}

/// Nothing is run where no fence is found.
#[test]
fn commands_are_found() {
    let count = |name: &str| {
        let documents = all();
        let document = documents.iter().find(|d| d.path.ends_with(name)).expect("a document");
        let fences = document.fences();
        let shells = fences.iter().filter(|fence| fence.info.split(' ').next() == Some("sh"));
        shells.flat_map(|fence| fence.body.lines()).filter_map(bsm_arguments).count()
    };
    // As counted by eye when this was written; more are welcome.
    assert!(count("README.md") >= 6);
    assert!(count("docs/guide/design.md") >= 7);
}

#[test]
fn numbers_are_those_of_the_program() {
    let (_folder, program) = program();
    let documents = all();
    for (name, make) in BLOCKS {
        let fresh = make(&program).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut written = 0;
        for document in &documents {
            for block in document.blocks().expect("markers").iter().filter(|b| b.name == *name) {
                if let Some(difference) = difference(&document.text[block.body.clone()], &fresh) {
                    let path = document.path.display();
                    panic!("{path}: `docs/remake {name}` is due:\n{difference}");
                }
                written += 1;
            }
        }
        assert!(written > 0, "{name} stands in no document");
    }
}

/// Output that is shown has a command above it that is run.
#[test]
fn output_stands_below_its_command() {
    for document in all() {
        for block in document.blocks().expect("markers").iter().filter(|b| b.name == "shown") {
            let command = document.command_before(block.body.start).unwrap_or_default();
            let path = document.path.display();
            assert!(bsm_arguments(&command).is_some(), "{path}: {command}");
        }
        // An output that is not made by a command goes stale by hand.
        let blocks = document.blocks().expect("markers");
        let places: BTreeSet<_> = blocks.iter().map(|b| b.body.end).collect();
        for fence in document.fences().iter().filter(|f| f.info == "text") {
            assert!(places.contains(&fence.end), "{}: {}", document.path.display(), fence.body);
        }
    }
}
