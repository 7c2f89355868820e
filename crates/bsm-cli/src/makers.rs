//! `bsm catalog --makers`: nuts of a maker beside ours, and in the axis of a requirement.

use std::path::Path;

use bsm_case::{Catalogue, MakerNut, MakerRow};
use bsm_report::{number, short};
use serde_json::{Map, Value, json};

use crate::args::{CatalogArgs, Format, TableSigns};
use crate::catalog::requirement;
use crate::failure::{Failure, warn};
use crate::files::{self, MOST_OF_A_SPECTRUM, names_of_columns, pretty_json, print, read};
use crate::table;

pub(crate) fn run(args: &CatalogArgs, path: &Path) -> Result<(), Failure> {
    let bytes = read(path, MOST_OF_A_SPECTRUM)?;
    let TableSigns { columns_from, delimiter, decimal } = &args.signs;
    let names = names_of_columns(columns_from.as_deref())?;
    let nuts = MakerNut::from_csv(&bytes, &names, delimiter.byte(), decimal.sign())
        .map_err(|e| Failure::scene(path, &e))?;
    let catalogue = Catalogue::standard().map_err(|e| Failure::scene(path, &e))?;
    let wish = requirement(args, &catalogue)?;
    let rows = MakerRow::all(&nuts, wish.as_ref())
        .map_err(|(name, e)| Failure::in_scene(path, &format!("{name}: {e}")))?;
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

fn to_json(row: &MakerRow) -> Value {
    let mut map = Map::from_iter([("nut".to_owned(), json!(row.name))]);
    map.extend(row.numbers.iter().map(|(name, _, value)| (name.clone(), json!(value))));
    map.extend(row.passes.map(|passes| ("passes".to_owned(), json!(passes))));
    Value::Object(map)
}

fn describe(rows: &[MakerRow]) -> String {
    let Some(first) = rows.first() else { return "the table has no nut".to_owned() };
    let sized = first.passes.is_some();
    let cells = |row: &MakerRow| {
        let numbers =
            row.numbers.iter().map(|(.., value)| value.map_or_else(|| "-".to_owned(), number));
        let verdict = row.passes.map(|passes| if passes { "pass" } else { "FAIL" }.to_owned());
        std::iter::once(row.name.clone()).chain(numbers).chain(verdict).collect()
    };
    let mut header: Vec<_> = std::iter::once("nut")
        .chain(first.numbers.iter().map(|(name, ..)| name.as_str()))
        .collect();
    header.extend(sized.then_some(""));
    let table = table::plain(Some(&header), &rows.iter().map(cells).collect::<Vec<_>>(), 1);
    // How far ours are from the maker's.
    let ratio = |name: &str| {
        let ratios = rows
            .iter()
            .filter_map(|row| Some(row.value(&format!("our_{name}"))? / row.value(name)?));
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
