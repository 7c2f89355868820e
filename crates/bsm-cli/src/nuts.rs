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
use bsm_report::sheets::catalogue_figures;
use serde_json::{Value, json};

use crate::answer::{Answer, Drawn};
use crate::args::SelectArgs;
use crate::failure::{Failure, warn};
use crate::files;
use crate::select::{STANDARD, check, requirement};
use crate::stream::{TABLES, form_of, write_numbers};
use crate::table;

/// Rows that a screen shows.
const SHOWN: usize = 20;

/// Rows that are in memory at a time.
const PART: usize = 1 << 14;

pub(crate) fn run(args: &SelectArgs) -> Result<(), Failure> {
    check(args, &[&TABLES[..], &["json"]].concat())?;
    let usage = |e: CaseError| Failure::input("--where", &e);
    let has_sheets = args.requirement.is_some();
    let (mut requirements, mut of_sheet) = (Vec::new(), Vec::new());
    for text in &args.conditions {
        let asked = Asked::parse(text).map_err(usage)?;
        match Column::named(&asked.name, has_sheets).map_err(usage)? {
            Column::Sheet(place, _) => of_sheet.push((place, asked)),
            Column::Nut(_) => requirements.push((text, Condition::on(asked).map_err(usage)?)),
        }
    }
    let descending = args.sort.as_deref().is_some_and(|name| name.starts_with('-'));
    let order =
        args.sort.as_deref().map(|name| Column::named(name.trim_start_matches('-'), has_sheets));
    let order = order.transpose().map_err(|e| Failure::input("--sort", &e))?;
    let catalogue = read(lists(args))?;
    let wish = requirement(args, &catalogue)?;
    let catalogue = match &wish {
        Some(wish) => wish.of_its_steel(catalogue),
        None => catalogue,
    };
    let none = |text: &str| {
        warn("note", text);
        Err(Failure::Unsolved)
    };
    let all = catalogue.places();
    if all.is_empty() {
        let limits = "turns_range, conformity_range, largest_ball_over_lead, largest_ball_over_screw_root; or the lands hold no ball";
        return none(&format!("no combination of the lists is within the limits: {limits}"));
    }
    let keeps = |nut: &Candidate| wish.as_ref().is_none_or(|wish| wish.is_kept_by(&nut.nut));
    let meets = |nut: &Candidate| requirements.iter().all(|(_, r)| r.is_met(nut)) && keeps(nut);
    let mut chosen = catalogue.map(&all, |place, nut| meets(nut).then_some(place));
    if chosen.is_empty() && wish.is_some() && requirements.is_empty() {
        return none(
            "no nut keeps all limits of the requirement, which says alone, without a list, what blocks",
        );
    }
    if chosen.is_empty() {
        return none(&nearest(&catalogue, &all, &requirements));
    }
    let mut sheets = Sheets::new();
    if let Some(wish) = &wish {
        sheets.extend(catalogue.map(&chosen, |place, nut| Some((place, wish.sheet_of(&nut.nut)?))));
        let kept = |sheet: &Vec<f64>| of_sheet.iter().all(|(i, asked)| asked.is_met(sheet[*i]));
        chosen.retain(|place| sheets.get(place).is_some_and(kept));
        if chosen.is_empty() {
            return none(if sheets.is_empty() {
                "no nut keeps all rules of its sheet (bsm axis)"
            } else {
                "no nut that meets the requirement meets what --where asks of its sheet"
            });
        }
    }
    let figures = match args.out.figures {
        Some(_) => catalogue_figures(&catalogue, &chosen),
        None => Vec::new(),
    };
    // That of the forces of a pair takes one nut, the others two at least.
    if args.out.figures.is_some() && figures.len() < 2 {
        let text = "no two of the nuts differ in lead alone or in diameter alone, as other figures need them";
        warn("note", text);
    }
    let met = chosen.len();
    if args.pareto {
        chosen = catalogue.pareto(&chosen);
    }
    let sheet = |place: u32| sheets.get(&place).map_or(&[][..], Vec::as_slice);
    if let Some(column) = order {
        let key = |place, nut: &Candidate| Some((column.read(nut, sheet(place)), place));
        let mut keys = catalogue.map(&chosen, key);
        keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        if descending {
            keys.reverse();
        }
        chosen = keys.into_iter().map(|(_, place)| place).collect();
    }
    warn("note", &count(all.len(), met, chosen.len(), args));
    chosen.truncate(args.first.map_or(usize::MAX, NonZeroUsize::get));
    let columns = Column::all(!sheets.is_empty());
    let rows = |places: &[u32]| catalogue.map(places, |place, nut| Some((*nut, sheet(place))));
    for path in args.out.tables() {
        let head: Vec<_> = columns.iter().map(Column::head).collect();
        let values = |part| {
            let rows = rows(part);
            let values =
                |column: &Column| rows.iter().map(|(nut, sheet)| column.read(nut, sheet)).collect();
            columns.iter().map(values).collect()
        };
        let parts = chosen.chunks(PART).map(values);
        write_numbers(path, form_of(path)?, &head, parts, &asked(args)?)?;
    }
    let shown = &chosen[..chosen.len().min(args.first.map_or(SHOWN, NonZeroUsize::get))];
    let mut picked =
        catalogue.map(&chosen[..1], |_, nut| Some(candidate_scene(nut, wish.as_ref())));
    let answer = show(&columns, &rows(shown), chosen.len() - shown.len());
    let answer = Answer { scene: Some(picked.pop().into()), ..answer };
    answer.give(&args.out, || Ok(Drawn { figures, page: None }))
}

/// Numbers of the sheets of nuts, by their places.
type Sheets = BTreeMap<u32, Vec<f64>>;

/// A column of the list.
#[derive(Clone, Copy)]
enum Column {
    /// Of the nut.
    Nut(&'static CatalogueColumn),
    /// Of its sheet, by its place there.
    Sheet(usize, &'static Output),
}

impl Column {
    /// All of them, those of sheets if there are any.
    fn all(has_sheets: bool) -> Vec<Self> {
        let of_sheets = sheet_columns().enumerate().filter(|_| has_sheets);
        let of_sheets = of_sheets.map(|(place, column)| Self::Sheet(place, column));
        CATALOGUE_COLUMNS.iter().map(Self::Nut).chain(of_sheets).collect()
    }

    fn named(name: &str, has_sheets: bool) -> Result<Self, CaseError> {
        let is_its = |column: &Self| matches!(column, Self::Sheet(_, c) if c.name == name);
        let of_sheet = Self::all(has_sheets).into_iter().find(is_its);
        of_sheet.map_or_else(|| CatalogueColumn::named(name).map(Self::Nut), Ok)
    }

    fn head(&self) -> NumberColumn {
        let (name, unit) = match self {
            Self::Nut(column) => (column.name, column.unit),
            Self::Sheet(_, column) => (column.name, column.unit),
        };
        NumberColumn { name, unit }
    }

    fn read(&self, nut: &Candidate, sheet: &[f64]) -> f64 {
        match self {
            Self::Nut(column) => (column.read)(nut),
            Self::Sheet(place, _) => sheet[*place],
        }
    }
}

/// File of the lists; none if they are the standard ones.
fn lists(args: &SelectArgs) -> Option<&Path> {
    args.from.as_deref().filter(|path| *path != Path::new(STANDARD))
}

fn read(lists: Option<&Path>) -> Result<Catalogue, Failure> {
    let Some(path) = lists else {
        return Catalogue::standard().map_err(|e| Failure::Input(e.to_string()));
    };
    Catalogue::from_json(&files::read_json(path)?).map_err(|e| Failure::scene(path, &e))
}

/// What was asked for.
fn asked(args: &SelectArgs) -> Result<Value, Failure> {
    let json = |path: Option<&Path>| -> Result<Value, Failure> {
        let Some(path) = path else { return Ok(Value::Null) };
        serde_json::from_slice(&files::read_json(path)?)
            .map_err(|e| Failure::in_scene(path, &e.to_string()))
    };
    Ok(json!({
        "lists": json(lists(args))?,
        "requirement": json(args.requirement.as_deref())?,
        "conditions": args.conditions,
        "pareto": args.pareto,
        "sort": args.sort,
    }))
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
fn nearest(catalogue: &Catalogue, all: &[u32], requirements: &[(&String, Condition)]) -> String {
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

/// The first rows, with so many more.
fn show(columns: &[Column], rows: &[(Candidate, &[f64])], more: usize) -> Answer {
    let json = |(nut, sheet): &(Candidate, &[f64])| {
        let mut row = candidate_json(nut);
        let columns = sheet_columns().zip(*sheet);
        row.extend(columns.map(|(column, value)| (column.name.to_owned(), json!(value))));
        Value::Object(row)
    };
    let is_brief = |column: &&Column| !matches!(column, Column::Nut(column) if !column.brief);
    let columns: Vec<_> = columns.iter().filter(is_brief).collect();
    let header: Vec<_> = columns.iter().map(|column| column.head().name).collect();
    let cell = |value: f64| {
        let text = if value.is_nan() { "-".to_owned() } else { number(value) };
        // Sizes are decimals of a few digits.
        let short = text.contains('.') && !text.contains('e');
        if short { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    let cells = |(nut, sheet): &(Candidate, &[f64])| {
        columns.iter().map(|column| cell(column.read(nut, sheet))).collect()
    };
    let table = table::plain(Some(&header), &rows.iter().map(cells).collect::<Vec<_>>(), 0);
    let text = match more {
        0 => table,
        more => format!(
            "{table}\n\nand {more} more; --first N shows others, -o TABLE writes all with all columns"
        ),
    };
    Answer { text, json: rows.iter().map(json).collect(), ..Answer::default() }
}

/// Names and units of all columns.
pub(crate) fn columns() -> String {
    let row = |column: &Column| {
        let when = if matches!(column, Column::Nut(_)) { "" } else { "with a requirement" };
        let NumberColumn { name, unit } = column.head();
        [name, unit, when].map(str::to_owned).to_vec()
    };
    table::plain(None, &Column::all(true).iter().map(row).collect::<Vec<_>>(), usize::MAX)
}
