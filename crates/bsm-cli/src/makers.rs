//! `bsm catalog --makers`: nuts of a maker beside ours, and in the axis of a requirement.

use std::path::Path;

use bsm_case::{
    CapacityReport, Catalogue, MakerNut, Output, RequirementFile, Scene, Settings, SizeReport,
    sheet_columns,
};
use bsm_report::{number, short};
use serde_json::{Map, Value, json};

use crate::args::{CatalogArgs, Format, TableSigns};
use crate::catalog::requirement;
use crate::failure::{Failure, warn};
use crate::files::{self, MOST_OF_A_SPECTRUM, names_of_columns, pretty_json, print, read};
use crate::table;

/// Load over the dynamic rating at which makers state the rigidity of one nut.
const RIGIDITY_AT: f64 = 0.3;

/// A nut with its numbers by name.
struct Row {
    nut: MakerNut,
    scene: Scene,
    numbers: Vec<(String, Option<f64>)>,
    passes: Option<bool>,
}

pub(crate) fn run(args: &CatalogArgs, path: &Path) -> Result<(), Failure> {
    let bytes = read(path, MOST_OF_A_SPECTRUM)?;
    let TableSigns { columns_from, delimiter, decimal } = &args.signs;
    let names = names_of_columns(columns_from.as_deref())?;
    let nuts = MakerNut::from_csv(&bytes, &names, delimiter.byte(), decimal.sign())
        .map_err(|e| Failure::scene(path, &e))?;
    let catalogue = Catalogue::standard().map_err(|e| Failure::scene(path, &e))?;
    let wish = requirement(args, &catalogue)?;
    let row = |nut: MakerNut| {
        let name = nut.name.clone();
        row(nut, wish.as_ref()).map_err(|e| Failure::in_scene(path, &format!("{name}: {e}")))
    };
    let mut rows: Vec<_> = nuts.into_iter().map(row).collect::<Result<_, _>>()?;
    // The lightest screw first, those that fail last.
    let mass = |row: &Row| value(row, "screw_mass_kg").unwrap_or(f64::INFINITY);
    if wish.is_some() {
        rows.sort_by(|a, b| b.passes.cmp(&a.passes).then(mass(a).total_cmp(&mass(b))));
    }
    let passing = rows.iter().filter(|row| row.passes == Some(true)).count();
    if wish.is_some() {
        warn("note", &format!("{passing} of {} nuts keep all rules", rows.len()));
    }
    let usable = wish.is_none() || passing > 0;
    if let (Some(output), Some(first), true) = (&args.pick, rows.first(), usable) {
        files::write(output, &(pretty_json(&first.scene.to_json()) + "\n"))?;
    }
    match args.format {
        Format::Json => print(&pretty_json(&rows.iter().map(to_json).collect()))?,
        Format::Table => print(&describe(&rows))?,
    }
    if usable { Ok(()) } else { Err(Failure::Unsolved) }
}

fn value(row: &Row, name: &str) -> Option<f64> {
    row.numbers.iter().find(|(own, _)| own == name).and_then(|(_, value)| *value)
}

fn row(nut: MakerNut, wish: Option<&RequirementFile>) -> Result<Row, bsm_case::CaseError> {
    let mut at = nut.scene.clone();
    at.axial_load_N = at.rated_dynamic_load_N.map(|rating| RIGIDITY_AT * rating);
    let ours = CapacityReport::of(&at, None)?.rows();
    let of_ours = |name: &str| ours.iter().find(|row| row.0 == name).map(|row| row.2);
    let mut numbers: Vec<(String, Option<f64>)> = Vec::new();
    let pairs = [
        ("dynamic_load_rating_N", nut.scene.rated_dynamic_load_N, of_ours("dynamic_load_rating_N")),
        ("static_load_rating_N", nut.scene.rated_static_load_N, of_ours("static_load_rating_N")),
        ("rigidity_N_um", nut.rigidity, of_ours("secant_rigidity_N_um")),
    ];
    for (name, makers, ours) in pairs {
        numbers.push((name.to_owned(), makers));
        numbers.push((format!("our_{name}"), ours));
    }
    numbers.push(("mass_kg".to_owned(), of_ours("mass_kg")));
    let (mut scene, mut passes) = (nut.scene.clone(), None);
    if let Some(wish) = wish {
        scene = nut.within(wish);
        let sheet = SizeReport::of(&scene, &Settings::default())?;
        passes = Some(sheet.passes());
        let of_sheet = |column: &Output| (column.name.to_owned(), sheet.number(column.name));
        numbers.extend(sheet_columns().map(of_sheet));
    }
    Ok(Row { nut, scene, numbers, passes })
}

fn to_json(row: &Row) -> Value {
    let mut map = Map::from_iter([("nut".to_owned(), json!(row.nut.name))]);
    map.extend(row.numbers.iter().map(|(name, value)| (name.clone(), json!(value))));
    map.extend(row.passes.map(|passes| ("passes".to_owned(), json!(passes))));
    Value::Object(map)
}

fn describe(rows: &[Row]) -> String {
    let Some(first) = rows.first() else { return "the table has no nut".to_owned() };
    let sized = first.passes.is_some();
    let cells = |row: &Row| {
        let numbers =
            row.numbers.iter().map(|(_, value)| value.map_or_else(|| "-".to_owned(), number));
        let verdict = row.passes.map(|passes| if passes { "pass" } else { "FAIL" }.to_owned());
        std::iter::once(row.nut.name.clone()).chain(numbers).chain(verdict).collect()
    };
    let mut header: Vec<_> =
        std::iter::once("nut").chain(first.numbers.iter().map(|(name, _)| name.as_str())).collect();
    header.extend(sized.then_some(""));
    let table = table::plain(Some(&header), &rows.iter().map(cells).collect::<Vec<_>>(), 1);
    // How far ours are from the maker's.
    let ratio = |name: &str| {
        let ratios = rows
            .iter()
            .filter_map(|row| Some(value(row, &format!("our_{name}"))? / value(row, name)?));
        let ratios: Vec<f64> = ratios.collect();
        let (low, high) =
            ratios.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), r| (l.min(*r), h.max(*r)));
        (!ratios.is_empty()).then(|| format!("{name} {} to {}", short(low), short(high)))
    };
    let ratios = ["dynamic_load_rating_N", "static_load_rating_N", "rigidity_N_um"].map(ratio);
    let ratios: Vec<_> = ratios.into_iter().flatten().collect();
    if ratios.is_empty() {
        return table;
    }
    format!("{table}\n\nours over the maker's: {}", ratios.join(", "))
}
