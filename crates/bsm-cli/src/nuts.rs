//! `bsm select` with list options: lists nuts of standard sizes, of user-defined sizes, or from a
//! manufacturer's table.

use std::num::NonZeroUsize;
use std::path::Path;

use bsm_case::{
    Case, Catalog, ListColumn, ManufacturerRow, NutFilter, NutList, Output, RequirementFile,
};
use bsm_report::sheets::{catalog_figures, table_figures};
use serde_json::{Value, json};

use crate::answer::{Pictures, Reply, WriteTable};
use crate::args::SelectArgs;
use crate::console::print_message;
use crate::failure::Failure;
use crate::files;
use crate::progress::show_spinner;
use crate::select_input::{Source, check, requirement};
use crate::table;
use crate::table_job::{TABLES, write_columns};

/// Number of rows that are printed by default.
const MAX_PRINTED: usize = 20;

/// Number of rows that are held in memory at a time.
const PART: usize = 1 << 14;

pub(crate) fn run(args: &SelectArgs, source: Source) -> Result<(), Failure> {
    let to = check(args, &[&TABLES[..], &["json"]].concat())?;
    let line = show_spinner("calculating the nuts of the list");
    let list = list(args, source);
    drop(line);
    let (list, requirement) = list?;
    let requirement = requirement.as_ref();
    for note in requirement.into_iter().flat_map(RequirementFile::notes) {
        print_message("note", note);
    }
    let first = list.chosen.first().map(|place| list.case(*place, requirement));
    let nut = first.map(|json| Case::from_json(json.to_string().as_bytes())).transpose();
    let nut = nut.map_err(|error| Failure::input("selected nut", &error))?;
    let units = args.display(nut.as_ref());
    if !list.reasons.is_empty() {
        let none = Reply { case: Some(Value::Null), units, ..Reply::of(list.answer(0)) };
        return none.deliver(&to, || Ok(Pictures::default()));
    }
    let figures = match (&args.out.figures, list.catalog()) {
        (None, _) => Vec::new(),
        (Some(_), Some(catalog)) => catalog_figures(catalog, &list.within),
        (Some(_), None) => table_figures(&list.rows_within()),
    };
    let figures: Vec<_> = figures.into_iter().map(|figure| figure.in_units(units)).collect();
    let lacking = match list.catalog() {
        // The figure of the forces in a preloaded pair can be drawn for a single nut. Each of the
        // other figures requires at least two nuts.
        Some(_) if figures.len() < 2 => Some(
            "only one figure is drawn; the other figures need two nuts that differ only in lead or only in diameter",
        ),
        None if figures.is_empty() => {
            Some("no figure is drawn; the figures need two nuts with a diameter and a lead_mm")
        }
        _ => None,
    };
    if let Some(text) = lacking.filter(|_| args.out.figures.is_some()) {
        print_message("note", text);
    }
    if list.catalog().is_some() {
        print_message("note", &count_note(&list, args));
    }
    let columns =
        list.select(args.columns.as_deref(), units).map_err(|e| Failure::input("--columns", &e))?;
    let first = |usual| args.first.map_or(usual, NonZeroUsize::get);
    let written = list.chosen.len().min(first(usize::MAX));
    let table = |path: &Path| {
        let parts = (0..written).step_by(PART);
        let parts = parts.map(|from| list.values(from..written.min(from + PART)));
        write_columns(path, &columns, parts, &request(args)?, &args.table.output_format())
    };
    // The nuts in a manufacturer's table are few enough to print all of them.
    let usual = if list.catalog().is_some() { MAX_PRINTED } else { usize::MAX };
    let answer = list.answer(first(usual));
    let shown = args.columns.is_some().then(|| list.answer_of(first(usual), &columns));
    let best = list.chosen.first().filter(|_| !answer.fails);
    let case = best.map(|place| list.case(*place, requirement));
    let (case, table) = (Some(case.into()), Some(Box::new(table) as WriteTable<'_>));
    Reply { case, table, units, shown, ..Reply::of(answer) }
        .deliver(&to, || Ok(Pictures { figures, ..Pictures::default() }))
}

/// Selects nuts from a list, and reads the requirement that they must meet.
fn list(args: &SelectArgs, source: Source) -> Result<(NutList, Option<RequirementFile>), Failure> {
    let filter = |columns: &[ListColumn]| -> Result<NutFilter, Failure> {
        let wanted = NutFilter::new(&args.conditions, columns, args.pareto)
            .map_err(|e| Failure::input("--where", &e))?;
        let Some(sort) = &args.sort else { return Ok(wanted) };
        let name = sort.trim_start_matches('-');
        wanted
            .sorted_by(name, sort.starts_with('-'), columns)
            .map_err(|e| Failure::input("--sort", &e))
    };
    match source {
        Source::Sizes(catalog) => {
            let wanted = filter(&ListColumn::of_sizes(args.requirement.is_some()))?;
            let requirement = requirement(args, &catalog)?;
            Ok((wanted.choose(catalog, requirement.as_ref()), requirement))
        }
        Source::Nuts(nuts) => {
            let sizes = Catalog::manufacturers().map_err(|e| Failure::Input(e.to_string()))?;
            let requirement = requirement(args, &sizes)?;
            let path = args.from.as_deref().unwrap_or(Path::new(""));
            let rows = ManufacturerRow::all(&nuts, requirement.as_ref())
                .map_err(|(name, e)| Failure::in_case(path, &format!("{name}: {e}")))?;
            Ok((filter(&ListColumn::of_rows(&rows))?.choose_rows(rows), requirement))
        }
    }
}

/// Returns the command-line options as JSON, which is stored with the table.
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
        "columns": args.columns,
    }))
}

fn count_note(list: &NutList, args: &SelectArgs) -> String {
    let all = match (args.requirement.is_some(), args.conditions.is_empty()) {
        (false, true) => None,
        (false, false) => Some("all conditions"),
        (true, true) => Some("the requirement"),
        (true, false) => Some("the requirement and all conditions"),
    };
    let met = all.map_or_else(String::new, |all| {
        let verb = if list.within.len() == 1 { "meets" } else { "meet" };
        format!(", of which {} {verb} {all}", list.within.len())
    });
    let left = if args.pareto {
        format!(
            ", of which {} are Pareto-optimal in dynamic load rating, stiffness and mass",
            list.chosen.len()
        )
    } else {
        String::new()
    };
    format!("The list contains {} nuts{met}{left}.", list.all)
}

/// Returns a text that lists the names, units and descriptions of all columns.
pub(crate) fn columns() -> String {
    let row = |name: &str, unit: &str, about: &str, when: &str| {
        [name, unit, about, when].map(str::to_owned).to_vec()
    };
    let sizes = ListColumn::of_sizes(true);
    let is_new = |output: &&Output| !sizes.iter().any(|known| known.name == output.name);
    let of_tables = bsm_case::table("manufacturer").flat_map(|quantity| quantity.columns);
    let of_list = sizes.iter().map(|column| {
        let when = match (column.is_of_sheet(), column.is_text()) {
            (true, _) => "with a requirement",
            (false, true) => "with a table of sizes",
            (false, false) => "",
        };
        row(&column.name, column.unit, column.about, when)
    });
    let when = "with --from TABLE.csv";
    let numbers = of_tables.filter(is_new).map(|o| row(o.name, o.unit, o.about, when));
    let texts = ManufacturerRow::TEXTS.iter().map(|(name, about)| row(name, "", about, when));
    table::plain(None, &of_list.chain(numbers).chain(texts).collect::<Vec<_>>(), usize::MAX)
}
