//! `bsm shard`: parts of a planned folder, here or anywhere; and the plan in words.

use std::num::NonZeroU64;
use std::path::Path;

use bsm_batch::dataset::{Dataset, Event, Plan};
use bsm_batch::{Task, Workers};
use indicatif::HumanBytes;

use crate::args::ShardArgs;
use crate::failure::{Failure, warn};
use crate::files::print;
use crate::stream::{failed, progress};
use crate::unfinished;

/// Rows beyond which nobody keeps them: a terabyte of files, which takes longer to read than to make again.
const MANY_ROWS: u64 = 10_000_000_000;

/// Opens a folder that was planned.
pub(crate) fn open(folder: &Path) -> Result<Dataset, Failure> {
    Dataset::open(folder, unfinished::create_temporary).map_err(|error| failed(folder, error))
}

/// The task of a folder.
fn task(folder: &Path, parts: &Dataset) -> Result<Task, Failure> {
    parts.plan().task().map_err(|why| Failure::in_scene(&folder.join("plan.json"), &why))
}

pub(crate) fn run(args: &ShardArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let folder = args.folder.as_path();
    let parts = open(folder)?;
    let task = task(folder, &parts)?;
    let points = parts.points(args.points.as_deref(), workers);
    let points = points.map_err(|error| failed(folder, error))?;
    let all = parts.plan().shards();
    let (from, to) = args.shards.unwrap_or((0, all));
    // One number in `of`, so that expensive corners of a grid are spread over all processes.
    let (index, of) = (args.index.unwrap_or(0), args.of.map_or(1, NonZeroU64::get));
    if to > all {
        let text = format!("--shards {from}:{to}: the plan has the parts 0:{all}");
        return Err(Failure::Input(text));
    }
    if index >= of {
        return Err(Failure::Input(format!(
            "--index {index} --of {of}: the last index is {}",
            of - 1
        )));
    }
    let mine = || (from..to).filter(|shard| shard % of == index);
    let rows = (mine().count() as u64).saturating_mul(parts.plan().rows_per_shard());
    let bar = progress(Some(rows.min(parts.plan().rows())), "rows", args.quiet);
    let mut found = 0;
    let mut tell = |event: Event<'_>| match event {
        Event::Found(part) => {
            found += 1;
            bar.inc(part.rows);
        }
        Event::Solved(chunk, _) => bar.inc(chunk.len as u64),
        Event::Foreign(_) | Event::Planned(_) => {}
    };
    let solved = parts.run_shards(&task, &points, mine(), args.repair, workers, &mut tell);
    bar.finish_and_clear();
    let solved = solved.map_err(|error| failed(folder, error))?.len() - found;
    parts.check_names().map_err(|error| failed(folder, error))?;
    let folder = folder.display();
    let text = format!(
        "{solved} solved, {found} there before, of {all} parts; `bsm verify {folder}` tells what is missing"
    );
    warn("note", &text);
    Ok(())
}

/// Prints a plan and what it comes to.
pub(crate) fn print_plan(folder: &Path, plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate().map_err(|why| Failure::in_scene(folder, &why))?;
    let hours = estimate.core_seconds / 3600.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bytes to look at")]
    let bytes = HumanBytes(estimate.bytes as u64);
    let (shards, per_shard) = (plan.shards(), plan.rows_per_shard());
    print(&format!(
        "plan        {}\nrows        {}\nshards      {shards} of {per_shard} rows\n\
         core-hours  {hours:.3}\nsize        {bytes} at most",
        plan.id(),
        plan.rows(),
    ))?;
    let folder = folder.display();
    let how = format!(
        "solve it with `bsm shard {folder}`, on one machine or many, then `bsm verify {folder}`"
    );
    warn("note", &how);
    if plan.rows() > MANY_ROWS {
        let text = "so many rows are cheaper to solve again than to keep and read: the Python package solves \
                    parts of this plan in memory, for statistics (ballscrew.solve_shard)";
        warn("note", text);
    }
    Ok(())
}
