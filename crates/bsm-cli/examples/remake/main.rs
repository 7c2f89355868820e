//! Updates the generated numbers in the README and in docs by running the corresponding commands;
//! see `docs/remake`.
//! The blocks of a command are written as soon as the command has succeeded, so that an interrupt
//! loses the work of at most one command. If a command fails, its blocks are not changed, the other
//! commands still run, and the exit code is 1.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the program prints its progress and a list"
)]

mod document;
mod fast;
mod slow;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use document::{bsm_arguments, documents};
use fast::Program;
use slow::{CAMPAIGNS, Site, Text};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Names of blocks, each with its new text.
type Blocks = Vec<(&'static str, Text)>;

/// A generator of one or several blocks. The command line can select the generator by name.
struct Source {
    name: String,
    /// The commands that are run, as shown by `--list`.
    commands: &'static str,
    takes: &'static str,
    generator: Generator,
}

enum Generator {
    /// The output of the `bsm` command shown above the block.
    Shown,
    /// The output of the `cargo test` command shown above the block.
    Tests,
    Fast(fn(&Program) -> Result<String>),
    Slow(fn(&Site) -> Result<Blocks>),
    Campaign(&'static str),
}

fn sources() -> Vec<Source> {
    let source = |name: &str, commands, takes, generator| Source {
        name: name.to_owned(),
        commands,
        takes,
        generator,
    };
    let mut all =
        vec![source("shown", "the `bsm` commands of README and guides", "2 s", Generator::Shown)];
    for (name, generate) in fast::BLOCKS {
        let (commands, takes) = match *name {
            "checks" | "groove-rates" | "groove-new-makers" | "groove-widths" => {
                ("bsm validate", "1 s")
            }
            "accuracies" => ("bsm solve --model traction --accuracy A", "1 s"),
            "slip-powers" => ("bsm solve examples/xu2015.json --show slip --model M", "1 s"),
            "catalog" => ("bsm select", "1 s"),
            "nut-sharing" => ("bsm nut", "1 s"),
            "catalog-line" | "catalog-line-items" => ("bsm axis", "1 s"),
            _ => ("errors of `bsm tradeoff`", "10 s"),
        };
        all.push(source(name, commands, takes, Generator::Fast(*generate)));
    }
    all.extend([
        source("tradeoff", "bsm tradeoff", "5 min", Generator::Slow(slow::tradeoff)),
        source("many", "bsm sweep", "2 min, 2 GB of disk", Generator::Slow(slow::many)),
        source("nuts", "bsm sweep, bsm nut", "15 s", Generator::Slow(slow::nuts)),
        source(
            "catalog-line-times",
            "bsm sweep, bsm select",
            "20 s",
            Generator::Slow(slow::catalog_lines),
        ),
        source("build", "cargo build --release", "5 min", Generator::Slow(slow::build)),
        source("peers", "benches/peers/run.sh", "5 min, Python", Generator::Slow(slow::peers)),
        source(
            "peers-traction",
            "benches/peers/traction.sh",
            "2 min, Python",
            Generator::Slow(slow::traction_peers),
        ),
        source("tests", "the `cargo test` commands of the documents", "an hour", Generator::Tests),
    ]);
    all.extend(CAMPAIGNS.iter().map(|(model, ..)| {
        let takes = "minutes to hours";
        source(&format!("extremes-{model}"), "just extremes", takes, Generator::Campaign(model))
    }));
    all
}

impl Source {
    fn group(&self) -> &'static str {
        if matches!(self.generator, Generator::Shown | Generator::Fast(_)) {
            "fast"
        } else {
            "slow"
        }
    }
}

fn main() -> Result<ExitCode> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    // The program `bsm` is one folder above this program, which is target/release/examples/remake.
    let bsm = std::env::current_exe()?.ancestors().nth(2).map(|folder| folder.join("bsm"));
    let bsm = bsm.filter(|path| path.exists()).ok_or("bsm is not built; run docs/remake")?;
    let (mut quick, mut names) = (false, Vec::new());
    for word in std::env::args().skip(1) {
        match word.as_str() {
            "--list" => return Ok(list()),
            "--quick" => quick = true,
            _ => names.push(word),
        }
    }
    let all = sources();
    let is = |source: &Source, name: &str| source.name == name || source.group() == name;
    if let Some(unknown) = names.iter().find(|name| !all.iter().any(|source| is(source, name))) {
        eprintln!(
            "error: no block or group is named {unknown}; `docs/remake --list` shows all names"
        );
        return Ok(ExitCode::from(2));
    }
    let asked = |source: &&Source| names.is_empty() || names.iter().any(|name| is(source, name));
    let site = Site { root, bsm, quick };
    let mut failed = Vec::new();
    for source in all.iter().filter(asked) {
        eprintln!("{}: {} ({})", source.name, source.commands, source.takes);
        let begin = Instant::now();
        match generate(&site, source) {
            Ok(()) => eprintln!("{}: {:.0} s", source.name, begin.elapsed().as_secs_f64()),
            Err(error) => {
                eprintln!(
                    "error: {}: {error}; the blocks of this command are not changed",
                    source.name
                );
                failed.push(source.name.as_str());
            }
        }
    }
    if failed.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("failed: {}", failed.join(", "));
    Ok(ExitCode::FAILURE)
}

fn list() -> ExitCode {
    for source in sources() {
        println!("{:24} {:5} {:22} {}", source.name, source.group(), source.takes, source.commands);
    }
    ExitCode::SUCCESS
}

fn generate(site: &Site, source: &Source) -> Result<()> {
    match source.generator {
        Generator::Shown => outputs(site, "shown", |line, program| {
            let words = bsm_arguments(line).ok_or("the line is not a bsm command")?;
            Ok(fast::fenced(&program.prints(&words)?.0))
        }),
        Generator::Tests => outputs(site, "tests", |line, _| slow::test_output(site, line)),
        Generator::Fast(generate) => {
            let folder = tempfile::tempdir()?;
            let text = generate(&Program::new(site.bsm.clone(), &site.root, folder.path())?)?;
            write(site, &source.name, &Text::Whole(text))
        }
        Generator::Slow(generate) => write_all(site, &generate(site)?),
        Generator::Campaign(model) => write_all(site, &slow::extremes(site, model)?),
    }
}

fn write_all(site: &Site, generated: &[(&str, Text)]) -> Result<()> {
    generated.iter().try_for_each(|(name, text)| write(site, name, text))
}

/// Writes a new text into all blocks with the given name.
fn write(site: &Site, name: &str, text: &Text) -> Result<()> {
    let mut written = 0;
    for document in documents(&site.root)? {
        let mut new = document.text.clone();
        // Blocks are replaced from the last to the first, so that the positions of the remaining
        // blocks stay valid.
        for block in document.blocks()?.iter().rev().filter(|block| block.name == name) {
            let body = match text {
                Text::Whole(body) => body.clone(),
                Text::Row(row) => with_row(&document.text[block.body.clone()], row),
            };
            new.replace_range(block.body.clone(), &body);
            written += 1;
            if site.quick {
                println!("{}, {name}:\n{body}", document.path.display());
            }
        }
        save(site, &document.path, &document.text, &new)?;
    }
    if written == 0 { Err(format!("no document has a block named {name}").into()) } else { Ok(()) }
}

/// Replaces a document atomically, unless it was edited in the meantime.
fn save(site: &Site, path: &Path, old: &str, new: &str) -> Result<()> {
    if site.quick || old == new {
        return Ok(());
    }
    if fs::read_to_string(path)? != old {
        return Err(format!("{} was changed in the meantime", path.display()).into());
    }
    let unfinished = PathBuf::from(format!("{}.new", path.display()));
    fs::write(&unfinished, new)?;
    fs::rename(&unfinished, path)?;
    eprintln!("  wrote {}", path.display());
    Ok(())
}

/// Replaces the table row that has the same first cell as `row`, or appends `row`.
fn with_row(table: &str, row: &str) -> String {
    let key = |line: &str| line.split('|').nth(1).map(|cell| cell.trim().to_owned());
    let mut lines: Vec<_> = table.trim_end().lines().collect();
    match lines.iter().position(|line| key(line).is_some() && key(line) == key(row)) {
        Some(place) => lines[place] = row,
        None => lines.push(row),
    }
    lines.join("\n") + "\n"
}

/// Runs the commands shown above all blocks with the given name, and writes their outputs into the
/// blocks. All commands of a document run in the same folder, so that a command can read files that
/// earlier commands wrote.
fn outputs(site: &Site, name: &str, run: impl Fn(&str, &Program) -> Result<String>) -> Result<()> {
    for mut document in documents(&site.root)? {
        let folder = tempfile::tempdir()?;
        let program = Program::new(site.bsm.clone(), &site.root, folder.path())?;
        // The positions of the blocks change whenever a block is written, so they are determined
        // again.
        for number in 0..document.blocks()?.len() {
            let block = document.blocks()?.swap_remove(number);
            if block.name != name {
                continue;
            }
            let command = document.command_before(block.body.start).ok_or("no command above")?;
            let body = run(&command, &program)?;
            if site.quick {
                println!("{}, {command}:\n{body}", document.path.display());
            }
            let old = document.text.clone();
            document.text.replace_range(block.body, &body);
            save(site, &document.path, &old, &document.text)?;
        }
    }
    Ok(())
}
