//! Sizes that manufacturers offer, and the column names of their tables.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use bsm_design::Make;
use bsm_design::catalog::OfferedSize;
use serde_json::Value;

use crate::vocabulary::cells::Cells;
use crate::vocabulary::entries::Choice;
use crate::vocabulary::names::wrong_type;
use crate::vocabulary::units::{MM, UnitChange, convert};
use crate::{CaseError, INPUTS, LISTS, NameKind, Rule, TableFormat, entries, nearest};

/// Sizes offered by THK (general catalog, B-584 to B-735) and HIWIN (BS-08-2, 6.4 to 6.9) as a CSV
/// table, which users can copy and edit.
///
/// For THK end-cap nuts whose lead is at least as large as the diameter, the catalog states only
/// the product of circuits and turns. A product of three or more is interpreted as circuits of
/// fewer than three turns on 2 or 4 thread starts. The reason is that TBI (SFY) prints 1.8x2 and
/// 2.8x2 for such nuts. These nuts are as long as nuts with only one such circuit (SFH).
pub const MANUFACTURER_SIZES: &str = include_str!("manufacturer_sizes.csv");

/// Columns of a table of sizes that are not named after an input.
const TEXT_COLUMNS: [&str; 6] =
    ["core_diameter_mm", "ball", "turns", "make", "manufacturer", "source"];

/// Word in the column `make` for a size that is offered as a ground screw and as a rolled screw.
const BOTH_MAKES: &str = "both";

/// Manufacturer that offers a size, and the catalog that lists the size.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SizeSource {
    /// Name of the manufacturer; `None` if the table does not state it.
    pub manufacturer: Option<String>,
    /// Name and pages of the catalog; `None` if the table does not state them.
    pub catalog: Option<String>,
}

/// Sizes that manufacturers offer.
#[derive(Debug)]
pub(crate) struct SizeTable {
    pub(crate) sizes: Vec<OfferedSize>,
    /// Source of each row of the table.
    pub(crate) sources: Vec<SizeSource>,
}

static SIZES: LazyLock<SizeTable> = LazyLock::new(|| {
    read_sizes(MANUFACTURER_SIZES.as_bytes(), &TableFormat::default())
        .expect("the table is compiled in")
});

/// Reads a table of sizes. A cell of the column `turns`, such as 1.8x2/1.8x4, lists alternatives.
/// Each alternative states the turns per circuit and the number of parallel circuits, which equals
/// the number of starts. Each alternative becomes a separate size. If the column `make` contains
/// the word both, the ground screw and the rolled screw are separate sizes.
///
/// # Errors
///
/// Returns a [`CaseError`] that names the row or the column that is invalid.
pub(crate) fn read_sizes(table: &[u8], format: &TableFormat) -> Result<SizeTable, CaseError> {
    let cells = Cells::read(table, format)?;
    let columns = cells.columns(|name| manufacturer_column(name, format, &TEXT_COLUMNS))?;
    let rows = cells.each(&columns, |number, row| {
        // Ball diameters in a user's table are treated as published values.
        let mut size =
            OfferedSize { ball_is_printed: true, row: number - 1, ..OfferedSize::default() };
        let mut makes = vec![None];
        let mut source = SizeSource::default();
        let mut all_turns: Vec<(f64, f64)> = Vec::new();
        for ((word, change), text) in row {
            let number = |text: &str| {
                let number = change.value(cells.number(text)?);
                let list = LISTS.iter().find(|list| list.name == word);
                list.map_or(Ok(()), |list| list.rule.check(word, number)).map(|()| number)
            };
            let meters = |text: &str| Ok::<_, CaseError>(number(text)? * MM);
            match word {
                "nominal_diameter_mm" => size.diameter = meters(text)?,
                "lead_mm" => size.lead = meters(text)?,
                "ball_diameter_mm" => size.ball = meters(text)?,
                // Ball diameters that are marked as estimated were calculated from pitch circle
                // diameter and core diameter.
                "ball" => size.ball_is_printed = text != "estimated",
                "pitch_circle_diameter_mm" => size.pitch_diameter = Some(meters(text)?),
                "core_diameter_mm" => size.core = Some(meters(text)?),
                "turns" => {
                    let one = |text: &str| {
                        let (turns, starts) = text.split_once('x').unwrap_or((text, "1"));
                        let starts = number(starts)?;
                        Rule::Whole(1.0).check("turns", starts)?;
                        Ok((number(turns)? * starts, starts))
                    };
                    all_turns = text.split('/').map(one).collect::<Result<_, CaseError>>()?;
                }
                "make" => makes = makes_of(text)?,
                "manufacturer" => source.manufacturer = Some(text.to_owned()),
                "source" => source.catalog = Some(text.to_owned()),
                _ => {}
            }
        }
        let has_turns = !all_turns.is_empty() && all_turns.iter().all(|(turns, _)| *turns > 0.0);
        let needed = [
            ("nominal_diameter_mm", size.diameter > 0.0),
            ("lead_mm", size.lead > 0.0),
            ("ball_diameter_mm", size.ball > 0.0),
            ("turns", has_turns),
        ];
        if let Some((name, _)) = needed.into_iter().find(|(_, given)| !given) {
            return Err(CaseError::Invalid(format!("{name} is missing")));
        }
        let of_turns = |(turns, starts): (f64, f64)| OfferedSize { turns, starts, ..size };
        let sizes = all_turns.into_iter().map(of_turns);
        let of_makes = |size| makes.iter().map(move |make| OfferedSize { make: *make, ..size });
        Ok((sizes.flat_map(of_makes).collect::<Vec<_>>(), source))
    })?;
    let (sizes, sources): (Vec<_>, _) = rows.into_iter().unzip();
    Ok(SizeTable { sizes: sizes.concat(), sources })
}

/// Returns the makes in a cell of the column `make`: a value of `screw_make`, or the word both.
fn makes_of(text: &str) -> Result<Vec<Option<Make>>, CaseError> {
    if text == BOTH_MAKES {
        // If both screws satisfy a requirement, the first one is chosen.
        return Ok(vec![Some(Make::Ground), Some(Make::Rolled)]);
    }
    let make = Make::from_name(text).ok_or_else(|| {
        let names = Make::NAMES.iter().map(|(name, _)| *name);
        let names = names.chain([BOTH_MAKES]).collect::<Vec<_>>().join(", ");
        CaseError::Invalid(format!("make = `{text}` must be one of {names}, or empty"))
    })?;
    Ok(vec![Some(make)])
}

/// Returns all manufacturers' sizes that are built into the program.
pub(crate) fn offered_sizes() -> &'static SizeTable {
    &SIZES
}

/// Returns the name of the input in a column and the conversion to its unit, or `None` if the
/// column is ignored.
///
/// * `words`: known column names that are not input names.
pub(crate) fn manufacturer_column(
    name: &str,
    format: &TableFormat,
    words: &[&'static str],
) -> Result<Option<(&'static str, UnitChange)>, CaseError> {
    let Some(own) = format.input_of(name) else { return Ok(None) };
    let known = || words.iter().copied().chain(INPUTS.iter().map(|input| input.name));
    if let Some(word) = known().find(|word| *word == own) {
        return Ok(Some((word, UnitChange::NONE)));
    }
    let unknown = || CaseError::unknown(NameKind::TableColumn, own, nearest(own, known()));
    convert(own, known()).map(Some).ok_or_else(unknown)
}

/// Reads the column names of a user's table: a JSON object that maps each column to the name of an
/// input, or to null if the column is ignored.
///
/// # Errors
///
/// Returns [`CaseError`] for syntax errors, repeated names, and values that are neither a name nor
/// null.
pub fn column_names(json: &[u8]) -> Result<BTreeMap<String, Option<String>>, CaseError> {
    let name = |(key, value): (String, Value)| match value {
        Value::Null => Ok((key, None)),
        Value::String(name) => Ok((key, Some(name))),
        other => Err(wrong_type(&key, &other, "a name, or null")),
    };
    entries(json)?.into_iter().map(name).collect()
}
