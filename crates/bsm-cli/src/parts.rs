//! `bsm parts`: solves and checks the parts of a dataset, on any machine, and prints plans.

use std::ops::Range;
use std::path::{Path, PathBuf};

use bsm_batch::Workers;
use bsm_batch::dataset::{Dataset, Event, PartDefect};
use bsm_case::{Answer, Content};
use serde_json::json;

use crate::answer::{Pictures, Reply};
use crate::args::{CheckArgs, OutArgs, PartSelection, RunArgs};
use crate::console::print_message;
use crate::failure::Failure;
use crate::files::InputFiles;
use crate::progress::progress;
use crate::schema::{Damage, PartsJson};
use crate::table_job::{dataset_failure, repair_advice};
use crate::unfinished;

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
    let selection = args.only.unwrap_or(PartSelection::Range(0, all));
    let mine = selection.numbers(all).map_err(Failure::Input)?;
    let rows = (mine.clone().count() as u64).saturating_mul(parts.plan().rows_per_part());
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
    let solved = parts.run_parts(&task, &points, mine, args.repair, workers, &mut tell);
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

/// Maximum number of list entries to print.
const MAX_PRINTED: usize = 20;

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
