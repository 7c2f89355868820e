//! `bsm select` with a list: all nuts of the standard sizes or of lists.

use std::num::NonZeroUsize;
use std::path::Path;

use bsm_case::{Catalog, ListColumn, NutFilter, NutList, candidate_case};
use bsm_report::sheets::catalog_figures;
use serde_json::{Value, json};

use crate::answer::{Pictures, Reply};
use crate::args::SelectArgs;
use crate::failure::{Failure, warn};
use crate::files;
use crate::select::{check, requirement};
use crate::table;
use crate::table_job::{TABLES, form_of, write_numbers};

/// Number of rows shown on the screen.
const SHOWN: usize = 20;

/// Number of rows held in memory at a time.
const PART: usize = 1 << 14;

pub(crate) fn run(args: &SelectArgs, catalog: Catalog) -> Result<(), Failure> {
    let to = check(args, &[&TABLES[..], &["json"]].concat())?;
    let has_sheets = args.requirement.is_some();
    let mut wanted = NutFilter::new(&args.conditions, has_sheets, args.pareto)
        .map_err(|e| Failure::input("--where", &e))?;
    if let Some(sort) = &args.sort {
        let name = sort.trim_start_matches('-');
        wanted = wanted
            .sorted_by(name, sort.starts_with('-'), has_sheets)
            .map_err(|e| Failure::input("--sort", &e))?;
    }
    let requirement = requirement(args, &catalog)?;
    let list = wanted.choose(catalog, requirement.as_ref());
    if !list.why.is_empty() {
        let none = Reply { case: Some(Value::Null), ..Reply::of(list.answer(0)) };
        return none.give(&to, || Ok(Pictures::default()));
    }
    let figures = match args.out.figures {
        Some(_) => catalog_figures(&list.catalog, &list.within),
        None => Vec::new(),
    };
    // The figure of the forces of a preloaded pair needs one nut. The other figures need two.
    if args.out.figures.is_some() && figures.len() < 2 {
        let text = "only one figure is drawn; the other figures need two nuts that differ only in lead or only in diameter";
        warn("note", text);
    }
    warn("note", &count(&list, args));
    let first = |usual| args.first.map_or(usual, NonZeroUsize::get);
    let places = &list.chosen[..list.chosen.len().min(first(usize::MAX))];
    let table = |path: &Path| {
        let head: Vec<_> = list.columns().iter().map(|column| column.output).collect();
        let parts = places.chunks(PART).map(|part| list.values(part));
        write_numbers(path, form_of(path)?, &head, parts, &request(args)?)
    };
    let picked = list.nuts(&list.chosen[..1]);
    let case = picked.first().map(|nut| candidate_case(nut, requirement.as_ref()));
    let answer = list.answer(first(SHOWN));
    Reply { case: Some(case.into()), table: Some(Box::new(table)), ..Reply::of(answer) }
        .give(&to, || Ok(Pictures { figures, ..Pictures::default() }))
}

/// Builds the request from the command-line options.
fn request(args: &SelectArgs) -> Result<Value, Failure> {
    let json = |path: Option<&Path>| -> Result<Value, Failure> {
        let Some(path) = path else { return Ok(Value::Null) };
        serde_json::from_slice(&files::read_json(path)?)
            .map_err(|e| Failure::in_case(path, &e.to_string()))
    };
    let lists =
        args.from.as_deref().filter(|path| files::ending_of("--from", path, &["json"]).is_ok());
    Ok(json!({
        "from": args.from,
        "lists": json(lists)?,
        "requirement": json(args.requirement.as_deref())?,
        "conditions": args.conditions,
        "pareto": args.pareto,
        "sort": args.sort,
    }))
}

fn count(list: &NutList, args: &SelectArgs) -> String {
    let met = if args.conditions.is_empty() && args.requirement.is_none() {
        String::new()
    } else {
        format!(", of which {} meet the requirements", list.within.len())
    };
    let left = if args.pareto {
        format!(
            ", of which {} are Pareto-optimal in dynamic load rating, stiffness and mass",
            list.chosen.len()
        )
    } else {
        String::new()
    };
    format!("{} nuts within the limits{met}{left}", list.all)
}

/// Describes all columns with their names, units and meanings.
pub(crate) fn columns() -> String {
    let row = |column: &ListColumn| {
        let when = if column.is_of_sheet() { "with a requirement" } else { "" };
        [column.output.name, column.output.unit, column.output.about, when]
            .map(str::to_owned)
            .to_vec()
    };
    table::plain(None, &ListColumn::all(true).iter().map(row).collect::<Vec<_>>(), usize::MAX)
}
