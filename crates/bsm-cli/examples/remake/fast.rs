//! What the program answers in seconds, the same each time: written by `docs/remake fast`, and held
//! against the documents by `cargo test -p bsm-cli --test documents`.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bsm_report::short;
use bsm_validate::tradeoff::{self, Dial, Errors, Group, Points, Quantiles};
use serde_json::Value;

/// A block and its text.
type Made = Result<String, Box<dyn Error>>;

/// What makes the text of a block.
type Make = fn(&Program) -> Made;

/// The program `bsm` in a folder that has the examples in it.
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) folder: PathBuf,
}

/// The blocks by name.
pub(crate) const BLOCKS: &[(&str, Make)] = &[
    ("checks", checks),
    ("quadrature", quadrature),
    ("slip-powers", slip_powers),
    ("catalogue", catalogue),
    ("accuracy", accuracy),
];

impl Program {
    /// A program that works in a new folder with the examples of the repository.
    pub(crate) fn new(path: PathBuf, root: &Path, folder: &Path) -> std::io::Result<Self> {
        std::os::unix::fs::symlink(root.join("examples"), folder.join("examples"))?;
        Ok(Self { path, folder: folder.to_owned() })
    }

    pub(crate) fn run(&self, arguments: &[String]) -> std::io::Result<Output> {
        Command::new(&self.path).args(arguments).current_dir(&self.folder).output()
    }

    /// What a command prints, where it answers or denies: exit codes 0 and 3.
    pub(crate) fn prints(&self, arguments: &[String]) -> Result<(String, String), Box<dyn Error>> {
        let output = self.run(arguments)?;
        let text = |bytes| String::from_utf8(bytes);
        let (stdout, stderr) = (text(output.stdout)?, text(output.stderr)?);
        if !matches!(output.status.code(), Some(0 | 3)) {
            return Err(format!("bsm {}: {stderr}", arguments.join(" ")).into());
        }
        Ok((stdout, stderr))
    }

    fn json(&self, arguments: &str) -> Result<Value, Box<dyn Error>> {
        let words: Vec<_> = arguments.split(' ').map(str::to_owned).collect();
        Ok(serde_json::from_str(&self.prints(&words)?.0)?)
    }
}

/// Output as it stands in a document.
pub(crate) fn fenced(text: &str) -> String {
    format!("\n```text\n{}\n```\n", text.trim_end())
}

/// A table in Markdown as it stands in a document.
pub(crate) fn table(header: &str, rows: &[String]) -> String {
    let columns = header.matches('|').count() - 1;
    format!("\n{header}\n{}|\n{}\n", "|---".repeat(columns), rows.join("\n"))
}

fn number(value: &Value, name: &str) -> Result<f64, String> {
    value[name].as_f64().ok_or_else(|| format!("no number `{name}`"))
}

fn checks(program: &Program) -> Made {
    let results = program.json("validate --format json")?;
    let checks = results["checks"].as_array().ok_or("no checks")?;
    let count = |verdict: &str| checks.iter().filter(|check| check["verdict"] == verdict).count();
    let (passed, failed, findings) = (count("pass"), count("fail"), count("finding"));
    Ok(format!(
        "\nOf the checks {passed} pass and {failed} fail. Another {findings} are findings: published trends that do not hold on \
         all curves,\nand numbers without a reference value.\n"
    ))
}

fn quadrature(program: &Program) -> Made {
    let efficiency = |order: u32| {
        let solve = "solve examples/feed_drive.json --model traction --format json --quadrature";
        Ok::<_, Box<dyn Error>>(number(&program.json(&format!("{solve} {order}"))?, "efficiency")?)
    };
    let finest = efficiency(48)?;
    let row = |order| {
        let found = efficiency(order)?;
        let off = (found - finest).abs();
        // The solver stops at residuals of 1e-10.
        let off = if off < 1e-10 { "< 1e-10".to_owned() } else { format!("{off:.0e}") };
        Ok::<_, Box<dyn Error>>(format!("| {order} | {found:.9} | {off} |"))
    };
    let rows = [4, 6, 8, 12, 24].map(row).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(table("| N | efficiency | off from order 48 by |", &rows))
}

fn slip_powers(program: &Program) -> Made {
    let row = |model: &str| {
        let slip = format!("slip examples/xu2015.json --format json --model {model}");
        let report = program.json(&slip)?;
        let both = |part: &str| {
            let at = |contact: &str| number(&report, &format!("{contact}_{part}_power_W"));
            Ok::<_, String>(at("nut")? + at("screw")?)
        };
        let [centre, spin, curvature] = [both("centre")?, both("spin")?, both("curvature")?];
        let all = number(&report, "total_friction_power_W")?;
        Ok::<_, Box<dyn Error>>(format!(
            "| `{model}` | {centre:.2} | {spin:.2} | {curvature:.2} | {all:.2} |"
        ))
    };
    let models = ["raceway-control", "traction", "elastic"];
    let rows = models.map(row).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(table("| model | slip at the centre | spin | curvature | all |", &rows))
}

fn catalogue(program: &Program) -> Made {
    let words = ["catalog", "--first", "1"].map(str::to_owned);
    let (_, note) = program.prints(&words)?;
    let count = note.split_whitespace().find_map(|word| word.parse::<u64>().ok());
    Ok(count.ok_or_else(|| format!("no number of nuts in: {note}"))?.to_string())
}

/// Errors of every model and setting over the committed points.
fn accuracy(_: &Program) -> Made {
    let rows: Vec<_> = tradeoff::accuracy(&Points::committed()?)?.iter().map(errors_row).collect();
    let header = "| model and setting | solved | grips | skids partly | skids | loads, grips | angles, grips |";
    Ok(table(header, &rows))
}

fn errors_row((dial, errors): &(Dial, Vec<Errors>)) -> String {
    let of = |group: Group| errors.iter().find(|errors| errors.group == group);
    let cell = |quantiles: Option<Quantiles>| {
        quantiles.map_or_else(String::new, |q| format!("{}, {}", small(q.median), small(q.q99)))
    };
    let [all, grips, partly, skids] = Group::ALL.map(of);
    let solved = all.map_or(0.0, |all| 100.0 * all.solved);
    let cells = [
        cell(grips.and_then(|e| e.efficiency)),
        cell(partly.and_then(|e| e.efficiency)),
        cell(skids.and_then(|e| e.efficiency)),
        cell(grips.and_then(|e| e.loads)),
        cell(grips.and_then(|e| e.angles_deg)),
    ];
    format!("| `{}` | {solved:.1} % | {} |", dial.name(), cells.join(" | "))
}

/// An error, down to where the residual of the solver ends.
fn small(error: f64) -> String {
    if error < 1e-9 { "< 1e-9".to_owned() } else { short(error) }
}
