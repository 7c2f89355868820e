//! `bsm select` with a list: all nuts of standard sizes, or of lists.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;

use bsm_batch::NumberColumn;
use bsm_case::{
    Asked, CATALOGUE_COLUMNS, CaseError, Catalogue, CatalogueColumn, Condition, Output,
    candidate_json, candidate_scene, sheet_columns,
};
use bsm_design::Candidate;
use bsm_report::number;
use bsm_validate::catalogue_figures;
use serde_json::{Value, json};

use crate::answer::Drawn;
use crate::args::SelectArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, pretty_json, print, write_drawn};
use crate::select::{STANDARD, check, requirement, scenes};
use crate::stream::{TABLES, form_of, write_numbers};
use crate::table;

/// Rows that a screen shows.
const SHOWN: usize = 20;

/// Rows that are in memory at a time.
const PART: usize = 1 << 14;

pub(crate) fn run(args: &SelectArgs) -> Result<(), Failure> {
    check(args, &[&TABLES[..], &["json"]].concat())?;
    let usage = |e: CaseError| Failure::input("--where", &e);
    let (mut requirements, mut of_sheet) = (Vec::new(), Vec::new());
    for text in &args.conditions {
        let asked = Asked::parse(text).map_err(usage)?;
        match place_on_sheet(&asked.name).filter(|_| args.requirement.is_some()) {
            Some(place) => of_sheet.push((place, asked)),
            None => requirements.push((text, Condition::on(asked).map_err(usage)?)),
        }
    }
    let sort = args.sort.as_deref();
    let descending = sort.is_some_and(|name| name.starts_with('-'));
    let order = sort.map(|name| name.strip_prefix('-').unwrap_or(name)).map(|name| {
        match place_on_sheet(name).filter(|_| args.requirement.is_some()) {
            Some(place) => Ok(Order::Sheet(place)),
            None => CatalogueColumn::named(name).map(Order::Nut),
        }
    });
    let order = order.transpose().map_err(|e| Failure::input("--sort", &e))?;
    let lists = args.from.as_deref().filter(|path| *path != Path::new(STANDARD));
    let catalogue = read(lists)?;
    let wish = requirement(args, &catalogue)?;
    let catalogue = match &wish {
        Some(wish) => wish.of_its_steel(catalogue),
        None => catalogue,
    };
    let all = catalogue.places();
    if all.is_empty() {
        let limits = "turns_range, conformity_range, largest_ball_over_lead, largest_ball_over_screw_root; or the lands hold no ball";
        warn("note", &format!("no combination of the lists is within the limits: {limits}"));
        return Err(Failure::Unsolved);
    }
    let keeps = |nut: &Candidate| wish.as_ref().is_none_or(|wish| wish.is_kept_by(&nut.nut));
    let meets = |nut: &Candidate| requirements.iter().all(|(_, r)| r.is_met(nut)) && keeps(nut);
    let mut chosen = catalogue.map(&all, |place, nut| meets(nut).then_some(place));
    if chosen.is_empty() && wish.is_some() && requirements.is_empty() {
        warn(
            "note",
            "no nut keeps all limits of the requirement; the requirement alone (without a list) says which one blocks",
        );
        return Err(Failure::Unsolved);
    }
    if chosen.is_empty() {
        warn("note", &none(&catalogue, &all, &requirements));
        return Err(Failure::Unsolved);
    }
    let mut sheets = BTreeMap::new();
    if let Some(wish) = &wish {
        sheets.extend(catalogue.map(&chosen, |place, nut| Some((place, wish.sheet_of(&nut.nut)?))));
        let kept = |sheet: &Vec<f64>| of_sheet.iter().all(|(i, asked)| asked.is_met(sheet[*i]));
        chosen.retain(|place| sheets.get(place).is_some_and(kept));
        if chosen.is_empty() {
            let text = if sheets.is_empty() {
                "no nut keeps all rules of its sheet (bsm axis)"
            } else {
                "no nut that meets the requirement meets what --where asks of its sheet"
            };
            warn("note", text);
            return Err(Failure::Unsolved);
        }
    }
    if let Some(folder) = &args.figures {
        let drawn = Drawn { figures: catalogue_figures(&catalogue, &chosen), page: None };
        write_drawn(folder, &drawn, &Value::Null)?;
        // That of the forces of a pair takes one nut, the others two at least.
        if drawn.figures.len() < 2 {
            warn(
                "note",
                "no two of the nuts differ in lead alone or in diameter alone: other figures need them",
            );
        }
    }
    let met = chosen.len();
    if args.pareto {
        chosen = catalogue.pareto(&chosen);
    }
    if let Some(order) = order {
        chosen = order.sorted(&catalogue, (&chosen, &sheets), descending);
    }
    warn("note", &count(all.len(), met, chosen.len(), args));
    chosen.truncate(args.first.map_or(usize::MAX, NonZeroUsize::get));
    let picked = catalogue.map(&chosen[..1], |_, nut| Some(candidate_scene(nut, wish.as_ref())));
    scenes(args, &picked[0])?;
    let tables: Vec<_> = args.output.iter().filter(|path| form_of(path).is_ok()).collect();
    for path in &tables {
        write(path, &catalogue, (&chosen, &sheets), &asked(args)?)?;
    }
    if args.json || tables.is_empty() { show(&catalogue, (&chosen, &sheets), args) } else { Ok(()) }
}

/// Numbers of the sheets of nuts, by their places.
type Sheets = BTreeMap<u32, Vec<f64>>;

/// What nuts are sorted by.
#[derive(Clone, Copy)]
enum Order {
    /// A column of the catalogue.
    Nut(&'static CatalogueColumn),
    /// A number of the sheet.
    Sheet(usize),
}

impl Order {
    /// Places of nuts, the smallest first unless `descending`.
    fn sorted(
        self,
        catalogue: &Catalogue,
        (chosen, sheets): (&[u32], &Sheets),
        descending: bool,
    ) -> Vec<u32> {
        let mut keys = catalogue.map(chosen, |place, nut| {
            let key = match self {
                Self::Nut(column) => (column.read)(nut),
                Self::Sheet(column) => sheets[&place][column],
            };
            Some((key, place))
        });
        keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        if descending {
            keys.reverse();
        }
        keys.into_iter().map(|(_, place)| place).collect()
    }
}

/// Columns of sheets, if there are any.
fn known(sheets: &Sheets) -> impl Iterator<Item = &'static Output> {
    sheet_columns().filter(|_| !sheets.is_empty())
}

fn place_on_sheet(name: &str) -> Option<usize> {
    sheet_columns().position(|column| column.name == name)
}

/// What was asked for.
fn asked(args: &SelectArgs) -> Result<Value, Failure> {
    let json = |path: Option<&Path>| -> Result<Value, Failure> {
        let Some(path) = path else { return Ok(Value::Null) };
        serde_json::from_slice(&files::read_json(path)?)
            .map_err(|e| Failure::in_scene(path, &e.to_string()))
    };
    Ok(json!({
        "lists": json(args.from.as_deref().filter(|path| *path != Path::new(STANDARD)))?,
        "requirement": json(args.requirement.as_deref())?,
        "conditions": args.conditions,
        "pareto": args.pareto,
        "sort": args.sort,
    }))
}

fn read(path: Option<&Path>) -> Result<Catalogue, Failure> {
    let Some(path) = path else {
        return Catalogue::standard().map_err(|e| Failure::Input(e.to_string()));
    };
    Catalogue::from_json(&files::read_json(path)?).map_err(|e| Failure::scene(path, &e))
}

fn count(all: usize, met: usize, left: usize, args: &SelectArgs) -> String {
    let met = if args.conditions.is_empty() && args.requirement.is_none() {
        String::new()
    } else {
        format!(", {met} of them meet the requirements")
    };
    let left = if args.pareto {
        format!(
            ", {left} of those are beaten by no other in dynamic load rating, rigidity and mass together"
        )
    } else {
        String::new()
    };
    format!("{all} nuts within the limits{met}{left}")
}

/// Why there is none, by the requirement.
fn none(catalogue: &Catalogue, all: &[u32], requirements: &[(&String, Condition)]) -> String {
    let without = |(i, (name, requirement)): (usize, &(&String, Condition))| {
        let others = |nut: &Candidate| {
            requirements.iter().enumerate().all(|(j, (_, r))| j == i || r.is_met(nut))
        };
        let read = requirement.column().read;
        let rest = catalogue.map(all, |_, nut| others(nut).then(|| read(nut)));
        match requirement.nearest_of(&rest) {
            Some(value) => format!(
                "\n  without {name}: {} nuts, of which the nearest has {}",
                rest.len(),
                number(value)
            ),
            None => format!("\n  without {name}: no nut either"),
        }
    };
    let reasons: String = requirements.iter().enumerate().map(without).collect();
    format!("none of {} nuts within the limits meets all requirements{reasons}", all.len())
}

fn write(
    path: &Path,
    catalogue: &Catalogue,
    (chosen, sheets): (&[u32], &Sheets),
    about: &Value,
) -> Result<(), Failure> {
    let column = |c: &CatalogueColumn| NumberColumn { name: c.name, unit: c.unit };
    let of_sheet = |c: &Output| NumberColumn { name: c.name, unit: c.unit };
    let of_sheets = known(sheets).map(of_sheet);
    let columns: Vec<_> = CATALOGUE_COLUMNS.iter().map(column).chain(of_sheets).collect();
    let parts = chosen.chunks(PART).map(|part| {
        let nuts = catalogue.map(part, |_, nut| Some(*nut));
        let of_nuts = CATALOGUE_COLUMNS.iter().map(|c| nuts.iter().map(c.read).collect());
        let of_sheets = (0..columns.len() - CATALOGUE_COLUMNS.len())
            .map(|i| part.iter().map(|place| sheets[place][i]).collect());
        of_nuts.chain(of_sheets).collect()
    });
    write_numbers(path, form_of(path)?, &columns, parts, about)
}

fn show(
    catalogue: &Catalogue,
    (chosen, sheets): (&[u32], &Sheets),
    args: &SelectArgs,
) -> Result<(), Failure> {
    let shown = &chosen[..chosen.len().min(args.first.map_or(SHOWN, NonZeroUsize::get))];
    let more = chosen.len() - shown.len();
    let shown = catalogue.map(shown, |place, nut| Some((*nut, sheets.get(&place))));
    if args.json {
        let row = |(nut, sheet): &(Candidate, Option<&Vec<f64>>)| {
            let mut row = candidate_json(nut);
            let columns = sheet_columns().zip(sheet.iter().copied().flatten());
            row.extend(columns.map(|(column, value)| (column.name.to_owned(), json!(value))));
            Value::Object(row)
        };
        return print(&pretty_json(&shown.iter().map(row).collect()));
    }
    let columns: Vec<_> = CATALOGUE_COLUMNS.iter().filter(|c| c.brief).collect();
    let of_sheets = known(sheets).map(|column| column.name);
    let header: Vec<_> = columns.iter().map(|c| c.name).chain(of_sheets).collect();
    let cell = |value: f64| {
        let text = number(value);
        // Sizes are decimals of a few digits.
        let short = text.contains('.') && !text.contains('e');
        if short { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    let row = |(nut, sheet): &(Candidate, Option<&Vec<f64>>)| {
        let of_sheet = sheet.iter().copied().flatten().map(|value| match value {
            value if value.is_nan() => "-".to_owned(),
            value => cell(*value),
        });
        columns.iter().map(|c| cell((c.read)(nut))).chain(of_sheet).collect()
    };
    let rows: Vec<Vec<_>> = shown.iter().map(row).collect();
    let rest = if more > 0 {
        format!("\n\nand {more} more; --first N shows others, -o TABLE writes all with all columns")
    } else {
        String::new()
    };
    print(&format!("{}{rest}", table::plain(Some(&header), &rows, 0)))
}

/// Names and units of all columns.
pub(crate) fn columns() -> String {
    let row = |name: &str, unit: &str, when: &str| [name, unit, when].map(str::to_owned).to_vec();
    let of_nuts = CATALOGUE_COLUMNS.iter().map(|c| row(c.name, c.unit, ""));
    let of_sheets = sheet_columns().map(|c| row(c.name, c.unit, "with a requirement"));
    table::plain(None, &of_nuts.chain(of_sheets).collect::<Vec<_>>(), usize::MAX)
}
