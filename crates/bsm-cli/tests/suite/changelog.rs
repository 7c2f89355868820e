//! The tables of old and new names in the changelog, held against the program.

use std::collections::BTreeSet;

use crate::program::{bsm, example, folder, stderr, stdout};

const LOG: &str = include_str!("../../../../CHANGELOG.md");

/// Rows of the tables of commands, answers and quantities, old and new, but for those of other languages.
fn rows() -> impl Iterator<Item = [&'static str; 2]> {
    let begin = LOG.find("### Commands").expect("the tables");
    let end = LOG.find("### Python").expect("the next part");
    let cells = |line: &'static str| {
        let (old, new) = line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | ")?;
        let is_other = old.starts_with("Rust") || old.starts_with("Python");
        (!is_other).then_some([old, new])
    };
    LOG[begin..end].lines().filter_map(cells)
}

/// Words in backquotes, or of a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || "_-".contains(c)))
}

fn quoted(cell: &'static str) -> impl Iterator<Item = &'static str> {
    cell.split('`').skip(1).step_by(2).flat_map(words)
}

fn is_option(word: &str) -> bool {
    word.starts_with("--") && word.len() > 2
}

/// Names with a unit.
fn is_quantity(word: &str) -> bool {
    let unit = word.rsplit('_').next().unwrap_or_default();
    let units = ["N", "Nm", "um", "mm", "deg", "h", "rpm", "s", "MPa", "um15", "min"];
    !word.starts_with('_') && word.contains('_') && units.contains(&unit)
}

/// What is there now has the new words; what was there is refused.
#[test]
fn new_words_are_there_and_old_ones_are_refused() {
    let dir = folder();
    let case = example("feed_drive.json");
    let run = |args: &[&str]| bsm(dir.path(), args, "");
    let told = |args: &[&str]| stdout(&run(args));
    let mut all = String::new();
    for name in told(&["schema"]).lines() {
        all += &told(&["schema", name]);
    }
    let help = told(&["--help"]);
    let commands = help.split("Commands:").nth(1).expect("commands").lines();
    let commands = commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let commands: BTreeSet<_> =
        commands.filter(|name| name.starts_with(|c: char| c.is_ascii_lowercase())).collect();
    for command in &commands {
        all += &told(&[command, "--help"]);
    }
    for args in [["parts", "run", "--help"], ["parts", "check", "--help"]] {
        all += &told(&args);
    }
    for list in ["lists", "columns", "keys", "sizes"] {
        all += &told(&["select", "--show", list]);
    }
    let known: BTreeSet<_> = words(&all).collect();
    let (mut new_words, mut old_words) = (BTreeSet::new(), BTreeSet::new());
    for [old, new] in rows() {
        let is_word = |word: &&str| is_option(word) || is_quantity(word);
        new_words.extend(quoted(new).filter(is_word));
        old_words.extend(quoted(old).filter(is_word));
        let command = old.strip_prefix('`').and_then(|old| words(old).next());
        old_words.extend(command.filter(|word| word.len() > 3 && !word.contains(['_', '-'])));
    }
    let missing: Vec<_> = new_words.iter().filter(|word| !known.contains(**word)).collect();
    assert!(new_words.len() > 50 && missing.is_empty(), "{} {missing:?}", new_words.len());
    let mut refused = 0;
    for old in old_words.iter().filter(|old| !known.contains(**old) && !commands.contains(**old)) {
        let value = format!("{old}=1");
        let output = match old {
            old if is_option(old) => run(&["solve", &case, old]),
            old if is_quantity(old) => run(&["solve", &case, "--set", &value]),
            command => run(&[command]),
        };
        assert_eq!(output.status.code(), Some(2), "{old}: {}", stderr(&output));
        assert!(stderr(&output).contains(old), "{old}: {}", stderr(&output));
        refused += 1;
    }
    assert!(refused > 50, "{refused} of {}: {old_words:?}", old_words.len());
}
