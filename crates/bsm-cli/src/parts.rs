//! `bsm parts`: solves and checks the parts of a dataset, on any machine, and prints plans.

use std::ops::Range;
use std::path::{Path, PathBuf};

use bsm_batch::Workers;
use bsm_batch::dataset::{Dataset, Event, PartDefect, Plan};
use bsm_case::{Answer, Content};
use indicatif::HumanBytes;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::json;

use crate::answer::{Pictures, Reply};
use crate::args::{CheckArgs, OutArgs, PartSelection, RunArgs};
use crate::failure::{Failure, print_message};
use crate::files::{InputFiles, print};
use crate::progress::progress;
use crate::table_job::{dataset_failure, repair_advice};
use crate::unfinished;

/// Number of rows above which the program recommends calculating the results again instead of
/// storing them. Reading a terabyte from files takes longer than calculating these rows again.
const MANY_ROWS: u64 = 10_000_000_000;

/// Opens the dataset that is stored in a folder.
pub(crate) fn open(folder: &Path) -> Result<Dataset, Failure> {
    Dataset::open(folder, unfinished::create_temporary)
        .map_err(|error| dataset_failure(folder, error))
}

/// Solves the parts of a dataset that the command line requests.
pub(crate) fn run(args: &RunArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let folder = args.folder.as_path();
    let parts = open(folder)?;
    let task = parts.plan().task();
    let task = task.map_err(|why| Failure::in_case(&folder.join("plan.json"), &why.to_string()))?;
    let points = parts.points(args.points.as_deref(), workers);
    let points = points.map_err(|error| dataset_failure(folder, error))?;
    let all = parts.plan().parts();
    // With `--only I/N`, a process takes every Nth part, so that time-consuming regions of a grid
    // are shared by all processes.
    let ((from, to), (index, of)) = match args.only {
        None => ((0, all), (0, 1)),
        Some(PartSelection::Share(index, of)) => ((0, all), (index, of.get())),
        Some(PartSelection::Range(from, to)) => ((from, to), (0, 1)),
    };
    if to > all {
        let text = format!("--only {from}:{to} is outside the parts 0:{all} of the plan");
        return Err(Failure::Input(text));
    }
    let mine = || (from..to).filter(|number| number % of == index);
    let rows = (mine().count() as u64).saturating_mul(parts.plan().rows_per_part());
    let bar = progress(Some(rows.min(parts.plan().rows())), "rows", args.work.quiet);
    let mut found = 0;
    let mut tell = |event: Event<'_>| match event {
        Event::Found(part) => {
            found += 1;
            bar.inc(part.rows);
        }
        Event::Solved(chunk, _) => bar.inc(chunk.len as u64),
        Event::UnknownFiles(_) | Event::Planned(_) => {}
    };
    let solved = parts.run_parts(&task, &points, mine(), args.repair, workers, &mut tell);
    bar.finish_and_clear();
    let solved = solved.map_err(|error| dataset_failure(folder, error))?.len() - found;
    parts.check_names().map_err(|error| dataset_failure(folder, error))?;
    let folder = folder.display();
    let text = format!(
        "this run solved {solved} of {all} parts ({found} already finished); `bsm parts check {folder}` lists the missing parts"
    );
    print_message("note", &text);
    Ok(())
}

/// Prints a plan together with its estimated computing time and size.
pub(crate) fn print_plan(folder: &Path, plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate().map_err(|why| Failure::in_case(folder, &why.to_string()))?;
    let hours = estimate.core_seconds / 3600.0;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number of bytes is only displayed"
    )]
    let bytes = HumanBytes(estimate.bytes as u64);
    let (parts, per_part) = (plan.parts(), plan.rows_per_part());
    print(&format!(
        "plan        {}\nrows        {}\nparts       {parts} of {per_part} rows\n\
         core-hours  {hours:.3}\nsize        {bytes} at most",
        plan.id(),
        plan.rows(),
    ))?;
    let folder = folder.display();
    let how = format!(
        "solve the plan with `bsm parts run {folder}` on one or more machines, and then run `bsm parts check {folder}`"
    );
    print_message("note", &how);
    if plan.rows() > MANY_ROWS {
        let text = "solving so many rows again is cheaper than storing and reading them; for \
                    statistics, the Python package solves parts of this plan in memory \
                    (ballscrew.solve_part)";
        print_message("note", text);
    }
    Ok(())
}

/// Maximum number of list entries to print.
const MAX_PRINTED: usize = 20;

/// State of the parts of a dataset, in JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct PartsJson {
    /// Identifier of the plan.
    plan: String,
    /// Number of parts of the plan.
    parts: u64,
    /// Number of finished parts.
    finished: u64,
    /// True if all parts are finished.
    complete: bool,
    /// True if all bytes of the parts were read and verified.
    deep: bool,
    /// Ranges of the numbers of missing parts.
    missing: Vec<String>,
    damaged: Vec<Damage>,
    /// Files that do not belong to the dataset.
    foreign: Vec<String>,
    /// Number of rows in the finished parts.
    rows: u64,
    /// Number of rows without a result.
    failed: u64,
    /// Number of rows with several solutions.
    several: u64,
}

/// A damaged part.
#[derive(Serialize, JsonSchema)]
struct Damage {
    file: String,
    reason: String,
}

/// Checks the parts of a dataset and reports missing and damaged parts.
pub(crate) fn check(args: &CheckArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let folder = args.folder.as_path();
    let parts = open(folder)?;
    let plan = parts.plan();
    let found = parts.survey(args.deep, workers).map_err(|error| dataset_failure(folder, error))?;
    let (missing, there) = (found.missing(plan), found.parts.len() as u64);
    let is_complete = found.is_complete(plan);
    if is_complete {
        parts.finish(&found.parts).map_err(|error| dataset_failure(folder, error))?;
    }
    let count = found.count();
    let text = |range: &Range<u64>| format!("{}:{}", range.start, range.end);
    let name = |path: &Path| path.display().to_string();
    let damage =
        |(path, why): &(PathBuf, PartDefect)| Damage { file: name(path), reason: why.to_string() };
    let json = PartsJson {
        plan: plan.id().to_owned(),
        parts: plan.parts(),
        finished: there,
        complete: is_complete,
        deep: args.deep,
        missing: missing.iter().map(text).collect(),
        damaged: found.damaged.iter().map(damage).collect(),
        foreign: found.unknown_files.iter().map(|path| name(path)).collect(),
        rows: count.rows,
        failed: count.failed,
        several: count.with_other_solutions,
    };
    let what = if args.deep { "all bytes read" } else { "footers read; --deep reads all bytes" };
    let mut lines = vec![
        format!("{there} of {} parts ({what})", plan.parts()),
        format!("{} of {} rows, {} without a result", count.rows, plan.rows(), count.failed),
    ];
    let damaged = json.damaged.iter().map(|Damage { file, reason }| format!("{file} {reason}"));
    list(&mut lines, "missing", json.missing.clone());
    list(&mut lines, "damaged", damaged.collect());
    list(&mut lines, "foreign", json.foreign.clone());
    if found.other_plan().is_some() {
        lines.push("restore the plan.json of these parts, or use another folder".to_owned());
    } else if !found.damaged.is_empty() {
        lines.push(repair_advice(folder, &found.damaged));
    } else if !is_complete {
        lines.push(format!("`bsm parts run {}` solves the missing parts", folder.display()));
    }
    let answer = Answer { fails: !is_complete, ..Answer::default() }
        .with("", Content::Json(json!(json)))
        .with_shown(Content::Text("", Some(lines.join("\n"))));
    let out = OutArgs { json: args.json, ..OutArgs::default() };
    Reply::of(answer).deliver(&out.check(&[], InputFiles::default())?, || Ok(Pictures::default()))
}

/// Appends the first few entries of a list to the lines.
fn list(lines: &mut Vec<String>, what: &str, entries: Vec<String>) {
    let more = entries.len().saturating_sub(MAX_PRINTED);
    lines.extend(entries.into_iter().take(MAX_PRINTED).map(|entry| format!("{what}  {entry}")));
    if more > 0 {
        lines.push(format!("{what}  and {more} more; --json lists all"));
    }
}
