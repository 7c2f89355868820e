//! Runs the commands shown in the README and the guides, and compares their output with the
//! documented output.
#![cfg(unix)]

#[path = "../../examples/remake/document.rs"]
mod document;
#[path = "../../examples/remake/fast.rs"]
mod fast;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::Mutex;

use crate::program::root;
use document::{Document, bsm_arguments, documents};
use fast::{BLOCKS, Program};
use tempfile::TempDir;

/// Table of the equations, figures and statements in the papers, with the commands that reproduce
/// them.
const PAPERS: &str = "docs/papers.csv";

fn program() -> (TempDir, Program) {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = env!("CARGO_BIN_EXE_bsm").into();
    let program = Program::new(path, &root(), folder.path()).expect("a folder with examples");
    (folder, program)
}

fn all_documents() -> Vec<Document> {
    documents(&root()).expect("README and docs")
}

/// Returns the first relevant difference between two texts. Times may differ, because they depend
/// on the machine. The last printed digit of a number may differ as well. Numbers below 1e-10, the
/// residual at which the solver stops, may differ because they consist only of rounding errors.
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
        // The header of a table shows which column contains times.
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
        if a.len() != b.len()
            || !a.iter().zip(&b).all(|(old, new)| are_equal_when_printed(old, new))
        {
            return Some(format!("documented: {old}\nprinted:    {new}"));
        }
    }
}

fn are_equal_when_printed(old: &str, new: &str) -> bool {
    let numbers = old.parse::<f64>().ok().zip(new.parse::<f64>().ok());
    old == new
        || numbers.is_some_and(|(x, y)| {
            let last_digit = last_digit(old).max(last_digit(new));
            // The tolerance is 1.5 units in the last place instead of 1, because decimal fractions
            // are not exactly representable as doubles.
            (x - y).abs() <= 1.5 * last_digit || x.abs().max(y.abs()) < 1e-10
        })
}

/// Returns one unit in the last place of a printed number. Integers are counts and must match
/// exactly, so the result is 0.
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
fn comparison_of_printed_texts_ignores_only_times_and_rounding_errors() {
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

/// Beginnings of the shell commands that this test skips, because they build the program or run
/// tests.
const SET_UP: [&str; 5] =
    ["cargo fetch ", "cargo build ", "cargo test ", "pip install ", "crates/bsm-view/page-solver"];

/// The README contains two setup commands: one command that runs the program, and one command that
/// runs the tests. CI must use exactly these commands.
#[test]
fn ci_runs_exactly_the_two_setup_commands_of_the_readme() {
    let read = |file: &str| fs::read_to_string(root().join(file)).expect("a file");
    let readme = read("README.md");
    let start = readme.split("\n## ").find(|part| part.starts_with("Start\n")).expect("a section");
    let fences: Vec<_> = start.split("```sh\n").skip(1).collect();
    let commands: Vec<_> = fences
        .iter()
        .flat_map(|fence| fence.split("```").next().expect("an end").lines())
        .collect();
    let is_of_cargo =
        |line: &&str| line.starts_with("cargo run ") || line.starts_with("cargo test ");
    let ci = read(".ci/run");
    assert_eq!(ci.lines().filter(is_of_cargo).collect::<Vec<_>>(), commands);
    let [job, tests] = commands[..] else { panic!("{commands:?}") };
    assert!(bsm_arguments(job).is_some_and(|words| words[0] == "solve"), "{job}");
    assert!(tests.starts_with("cargo test "), "{tests}");
}

/// Every line of an `sh` fence, except the lines in [`SET_UP`], must print the documented output.
/// The lines are run exactly as documented and in the order of the document. The files whose
/// contents the document shows are created first. Commands in `sh long` fences take seconds or more
/// even in an optimized build, so they are run with fewer points.
#[test]
fn commands_print_the_documented_output() {
    for document in all_documents() {
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
                // An exit code that indicates a missing solution is acceptable if the document
                // shows the output of the command.
                let shown = |b: &document::Block| {
                    b.name == "shown"
                        && document.command_before(b.body.start).as_deref() == Some(line)
                };
                let no_solution = code == 3 && blocks.iter().any(shown);
                // If the build does not contain the solver for saved pages, the command checks its
                // inputs and then refuses to write a page.
                let no_page = code == 2 && stderr.contains("cannot write a page, because");
                assert!(
                    code == 0 || no_solution || no_page,
                    "{name}: {line}: exit code {code}: {stderr}"
                );
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

/// Returns the command with a reduced number of points: three per input for `sweep`, three in total
/// for other commands.
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
            let cases = root().join("validation/golden/tradeoff/cases.csv");
            let cases = fs::read_to_string(cases).expect("the committed points");
            let few: Vec<_> = cases.lines().take(4).collect();
            fs::write(folder.join("few.csv"), few.join("\n")).expect("a table");
            words.extend(["--points", "few.csv"].map(str::to_owned));
        }
        // A server would run forever, so the command writes the page to a file instead.
        "view" => {
            words.retain(|word| word != "--open");
            match words.iter().position(|word| word == "-o") {
                Some(place) => "view.html".clone_into(&mut words[place + 1]),
                None => words.extend(["-o", "view.html"].map(str::to_owned)),
            }
        }
        other => panic!("how is {other} made short?"),
    }
    words
}

/// The parser must find all commands in the documents.
#[test]
fn document_parser_finds_all_commands() {
    let count = |name: &str| {
        let documents = all_documents();
        let document = documents.iter().find(|d| d.path.ends_with(name)).expect("a document");
        let fences = document.fences();
        let shells = fences.iter().filter(|fence| fence.info.split(' ').next() == Some("sh"));
        shells.flat_map(|fence| fence.body.lines()).filter_map(bsm_arguments).count()
    };
    // The commands in each document were counted by hand when the test was written. Later versions of
    // the documents may contain more commands.
    assert!(count("README.md") >= 6);
    assert!(count("docs/guide/design.md") >= 6);
}

#[test]
fn documented_numbers_match_the_program() {
    let (_folder, program) = program();
    let documents = all_documents();
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

/// Every documented output must follow a command that is run.
#[test]
fn every_documented_output_follows_a_command() {
    for document in all_documents() {
        for block in document.blocks().expect("markers").iter().filter(|b| b.name == "shown") {
            let command = document.command_before(block.body.start).unwrap_or_default();
            let path = document.path.display();
            assert!(bsm_arguments(&command).is_some(), "{path}: {command}");
        }
        // Output that does not belong to a command could become outdated without being noticed.
        let blocks = document.blocks().expect("markers");
        let places: BTreeSet<_> = blocks.iter().map(|b| b.body.end).collect();
        for fence in document.fences().iter().filter(|f| f.info == "text") {
            assert!(places.contains(&fence.end), "{}: {}", document.path.display(), fence.body);
        }
    }
}

/// Returns the parts of a text that are enclosed in backticks.
fn texts_between_backquotes(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// A row of the papers table: one equation, figure or statement.
struct Row {
    paper: String,
    text: String,
    commands: Vec<String>,
    ours: String,
    verdict: String,
}

fn papers() -> String {
    fs::read_to_string(root().join(PAPERS)).expect("the table of the papers")
}

/// Parses the rows of the papers table. The columns are paper, item, equation, command, value in
/// the paper, calculated value and verdict.
fn rows(text: &str) -> Vec<Row> {
    let row = |record: Result<csv::StringRecord, csv::Error>| {
        let record = record.expect("a row of the table");
        let [paper, _, _, command, _, ours, verdict] = record.iter().collect::<Vec<_>>()[..] else {
            panic!("{PAPERS}: not seven cells: {record:?}")
        };
        let commands = texts_between_backquotes(command).filter(|code| code.starts_with("bsm "));
        Row {
            paper: paper.to_owned(),
            text: record.iter().collect::<Vec<_>>().join(" | "),
            commands: commands.map(str::to_owned).collect(),
            ours: ours.to_owned(),
            verdict: verdict.to_owned(),
        }
    };
    csv::Reader::from_reader(text.as_bytes()).records().map(row).collect()
}

/// Permitted verdicts in the table of papers.
const VERDICTS: [&str; 4] = ["reproduced", "corrected", "differs", "not modeled"];

/// Words that precede the number of an equation, a figure or a chapter.
const REFERENCES: [&str; 10] = [
    "Eq",
    "Eqs",
    "Fig",
    "Figs",
    "Table",
    "Tables",
    "chapter",
    "chapters",
    "conclusion",
    "conclusions",
];

/// Removes formulas, links and equation tags from a text.
fn prose(text: &str) -> String {
    let outside = |text: &str, mark: char| -> String {
        text.split(mark).step_by(2).collect::<Vec<_>>().join(" ")
    };
    let text = outside(&outside(text, '`'), '$');
    let (mut kept, mut rest) = (String::new(), text.as_str());
    while let Some(open) = rest.find('(') {
        let close = rest[open..].find(')').map_or(rest.len(), |length| open + length + 1);
        let inside = rest[open + 1..close].trim_end_matches(')');
        let tag = inside.strip_prefix(|c: char| c.is_ascii_uppercase());
        let is_tag = tag.is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        let is_address = rest[..open].ends_with(']');
        kept.push_str(&rest[..open]);
        if !is_tag && !is_address {
            kept.push_str(inside);
        }
        kept.push(' ');
        rest = &rest[close..];
    }
    kept + rest
}

/// Returns the first number that is neither in backticks nor the number of an equation, figure or
/// chapter.
fn bare_number(text: &str) -> Option<String> {
    let mut refers = false;
    for word in prose(text).split_whitespace() {
        let word = word.trim_matches(['.', ',', ';', ':', '(', ')']);
        if word.contains(|c: char| c.is_ascii_digit()) {
            if !refers {
                return Some(word.to_owned());
            }
        } else if REFERENCES.contains(&word) {
            refers = true;
        } else if !["", "and", "to", "or"].contains(&word) {
            refers = false;
        }
    }
    None
}

/// Returns true if a text contains a number. The number may have additional decimals in the text if
/// it has at least four digits.
fn contains_number(text: &str, number: &str) -> bool {
    let digits = number.bytes().filter(u8::is_ascii_digit).count();
    let may_go_on = digits >= 4 && number.contains('.');
    let begins = number.starts_with(|c: char| c.is_ascii_digit());
    let ends = number.ends_with(|c: char| c.is_ascii_digit());
    text.match_indices(number).any(|(place, _)| {
        let of_a_number = |c: char| c.is_ascii_digit() || c == '.';
        let (before, after) = (&text[..place], &text[place + number.len()..]);
        let decimals = after.strip_prefix('.').unwrap_or(after);
        let goes_on = after.starts_with(|c: char| c.is_ascii_digit());
        let has_decimals =
            decimals.len() < after.len() && decimals.starts_with(|c: char| c.is_ascii_digit());
        !(begins && before.ends_with(of_a_number))
            && !(ends && (has_decimals || goes_on && !may_go_on))
    })
}

#[test]
fn numbers_without_code_formatting_are_detected() {
    for (text, bare) in [
        ("efficiency `0.96609`", None),
        ("differs: by (X13), Eqs 7 and 8, Figs 4 to 6; $r_b/2$", None),
        ("[errata](theory/errata.md#the-033) has it", None),
        ("`49.4` to 50.6 deg", Some("50.6")),
        ("Eq 3 has 12 points", Some("12")),
        ("falls (10 000 rpm)", Some("10")),
        ("v^1.2", Some("v^1.2")),
    ] {
        assert_eq!(bare_number(text).as_deref(), bare, "{text}");
    }
    for (text, number, printed) in [
        ("a 49.428 b", "49.428", true),
        ("a 49.42872 b", "49.428", true),
        ("a 149.428 b", "49.428", false),
        ("a 0.75 b", "0.7", false),
        ("a 12.5 b", "12", false),
        ("at 12.", "12", true),
        ("no_solution", "no_solution", true),
    ] {
        assert_eq!(contains_number(text, number), printed, "{text}: {number}");
    }
}

/// The commands of each row in the table of papers must print every calculated number that the row
/// states. Each command is run only once.
/// Regression test: ten rows contained numbers that their commands did not print, because only
/// numbers in backticks were compared.
#[test]
fn commands_in_the_table_of_papers_print_the_stated_numbers() {
    let rows = rows(&papers());
    for row in &rows {
        assert!(VERDICTS.iter().any(|verdict| row.verdict.starts_with(verdict)), "{}", row.text);
        let modeled = !row.verdict.starts_with("not modeled");
        assert!(!modeled || !row.commands.is_empty(), "no command: {}", row.text);
    }
    let commands: BTreeSet<_> =
        rows.iter().flat_map(|row| row.commands.iter().map(String::as_str)).collect();
    let (waiting, answers) = (Mutex::new(commands.into_iter()), Mutex::new(BTreeMap::new()));
    let (_folder, program) = program();
    std::thread::scope(|scope| {
        let work = || {
            loop {
                let next = waiting.lock().expect("no thread has failed").next();
                let Some(command) = next else { break };
                let words = bsm_arguments(command).expect("it begins with bsm");
                let output = program.run(&words).expect("the program starts");
                answers.lock().expect("no thread has failed").insert(command, output);
            }
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        for _ in 0..threads.min(8) {
            scope.spawn(work);
        }
    });
    let answers = answers.into_inner().expect("no thread has failed");
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    for row in &rows {
        let mut printed = String::new();
        for command in &row.commands {
            let output = &answers[command.as_str()];
            let (code, stderr) = (output.status.code(), said(&output.stderr));
            // An exit code that indicates a missing solution is acceptable if the row mentions this
            // exit code.
            let no_solution = code == Some(3) && row.text.contains("exit code 3");
            assert!(code == Some(0) || no_solution, "{command}: exit code {code:?}: {stderr}");
            printed.push_str(&said(&output.stdout));
            printed.push_str(&stderr);
        }
        for text in [&row.ours, &row.verdict] {
            let bare = bare_number(text);
            assert!(bare.is_none(), "{bare:?} is not in backquotes: {}", row.text);
            for number in texts_between_backquotes(text) {
                assert!(
                    contains_number(&printed, number),
                    "no command prints `{number}`: {}",
                    row.text
                );
            }
        }
    }
}

/// The parser must find the commands and the verdict in a row of the table. The page that
/// accompanies the table must state, for each paper, the number of verdicts of each kind.
#[test]
fn table_of_papers_is_parsed_and_its_page_states_the_number_of_verdicts() {
    let text = "paper,item,equation,command,paper_value,our_value,verdict\n\
                a,Eq 1,(Q1),\"`bsm a`, `bsm b --c 'd e'`\",1,`2`,differs: why\n";
    let rows = rows(text);
    let [row] = &rows[..] else { panic!("{}", rows.len()) };
    assert_eq!(row.commands, ["bsm a", "bsm b --c 'd e'"]);
    assert_eq!((row.paper.as_str(), row.ours.as_str()), ("a", "`2`"));
    assert_eq!(row.verdict, "differs: why");
    let mut counts = BTreeMap::<String, [usize; VERDICTS.len()]>::new();
    for row in self::rows(&papers()) {
        let verdict = VERDICTS.iter().position(|verdict| row.verdict.starts_with(verdict));
        counts.entry(row.paper).or_default()[verdict.expect("a verdict")] += 1;
    }
    // The table had 176 rows when this test was written. Further rows may be added.
    assert!(counts.values().flatten().sum::<usize>() >= 176, "{counts:?}");
    let page = fs::read_to_string(root().join(PAPERS).with_extension("md")).expect("the page");
    for (paper, counts) in counts {
        let line = counts.iter().fold(format!("| `{paper}` |"), |line, n| format!("{line} {n} |"));
        assert!(page.contains(&line), "the page should have: {line}");
    }
}
