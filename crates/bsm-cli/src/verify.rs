//! `bsm verify`: what of a folder of parts is there, and what is wrong with it.

use std::ops::Range;
use std::path::{Path, PathBuf};

use bsm_batch::Workers;
use bsm_batch::dataset::Damage;
use serde_json::json;

use crate::args::{Format, VerifyArgs};
use crate::failure::Failure;
use crate::files::{pretty_json, print};
use crate::shard::open;
use crate::stream::{failed, mend};

/// Lines of a list in words.
const SHOWN: usize = 20;

pub(crate) fn run(args: &VerifyArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let folder = args.folder.as_path();
    let parts = open(folder)?;
    let plan = parts.plan();
    let found = parts.survey(args.deep, workers).map_err(|error| failed(folder, error))?;
    let (missing, there) = (found.missing(plan), found.parts.len() as u64);
    // What is damaged has no part, but may be one too many.
    let is_complete = missing.is_empty() && found.damaged.is_empty();
    if is_complete {
        parts.finish(&found.parts).map_err(|error| failed(folder, error))?;
    }
    let count = found.count();
    let text = |range: &Range<u64>| format!("{}:{}", range.start, range.end);
    let ranges: Vec<_> = missing.iter().map(text).collect();
    let name = |path: &Path| path.display().to_string();
    match args.format {
        Format::Json => {
            let damage = |(path, why): &(PathBuf, Damage)| json!({ "file": name(path), "reason": why.to_string() });
            print(&pretty_json(&json!({
                "plan": plan.id(),
                "shards": plan.shards(),
                "finished": there,
                "complete": is_complete,
                "deep": args.deep,
                "missing": ranges,
                "damaged": found.damaged.iter().map(damage).collect::<Vec<_>>(),
                "foreign": found.foreign.iter().map(|path| name(path)).collect::<Vec<_>>(),
                "rows": count.rows,
                "failed": count.failed,
                "several": count.several,
            })))?;
        }
        Format::Table => {
            let what =
                if args.deep { "all bytes read" } else { "footers read; --deep reads all bytes" };
            let mut lines = vec![
                format!("{there} of {} shards ({what})", plan.shards()),
                format!(
                    "{} of {} rows, {} without a result",
                    count.rows,
                    plan.rows(),
                    count.failed
                ),
            ];
            let damaged = found.damaged.iter().map(|(path, why)| format!("{} {why}", name(path)));
            list(&mut lines, "missing", ranges);
            list(&mut lines, "damaged", damaged.collect());
            list(&mut lines, "foreign", found.foreign.iter().map(|path| name(path)).collect());
            if found.other_plan().is_some() {
                lines.push(
                    "put the plan.json of these parts back, or take another folder".to_owned(),
                );
            } else if !found.damaged.is_empty() {
                lines.push(mend(folder, &found.damaged));
            } else if !is_complete {
                lines.push(format!("`bsm shard {}` solves what is missing", folder.display()));
            }
            print(&lines.join("\n"))?;
        }
    }
    if is_complete { Ok(()) } else { Err(Failure::Unsolved) }
}

/// Adds the first few of some entries.
fn list(lines: &mut Vec<String>, what: &str, entries: Vec<String>) {
    let more = entries.len().saturating_sub(SHOWN);
    lines.extend(entries.into_iter().take(SHOWN).map(|entry| format!("{what}  {entry}")));
    if more > 0 {
        lines.push(format!("{what}  and {more} more; --format json has all"));
    }
}
