//! Sizes that manufacturers offer, and the column names of their tables.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use bsm_design::OfferedSize;
use serde_json::Value;

use crate::vocabulary::cells::Cells;
use crate::vocabulary::names::wrong_type;
use crate::vocabulary::units::{MM, UnitChange, convert};
use crate::{CaseError, INPUTS, LISTS, Rule, TableFormat, entries, nearest};

/// Sizes of THK (general catalogue, B-584 to B-735) and HIWIN (BS-08-2, 6.4 to 6.9), to copy and edit.
///
/// Of end-cap nuts of THK with leads from the diameter on the source has the product of circuits and turns. Three turns and more are
/// taken as circuits of fewer than three, on 2 or 4 threads: TBI (SFY) prints 1.8x2 and 2.8x2 for such nuts, which are as long as
/// nuts with one such circuit (SFH).
pub const MANUFACTURER_SIZES: &str = include_str!("manufacturer_sizes.csv");

/// Columns of a table of sizes besides the inputs of a case.
const TEXT_COLUMNS: [&str; 5] = ["core_diameter_mm", "ball", "turns", "make", "source"];

static SIZES: LazyLock<Vec<OfferedSize>> = LazyLock::new(|| {
    read_sizes(MANUFACTURER_SIZES.as_bytes(), &TableFormat::default())
        .expect("the table is compiled in")
});

/// Reads a table, with `turns` such as 1.8x2/1.8x4: those of a circuit, and circuits side by side on as many starts; a size for each.
///
/// # Errors
///
/// [`CaseError`] with the row or the column.
pub(crate) fn read_sizes(
    table: &[u8],
    format: &TableFormat,
) -> Result<Vec<OfferedSize>, CaseError> {
    let cells = Cells::read(table, format)?;
    let columns = cells.columns(|name| manufacturer_column(name, format, &TEXT_COLUMNS))?;
    let sizes = cells.each(&columns, |_, row| {
        // A user knows his balls.
        let mut size = OfferedSize { ball_is_printed: true, ..OfferedSize::default() };
        let mut all_turns: Vec<(f64, f64)> = Vec::new();
        for ((word, change), text) in row {
            let number = |text: &str| {
                let number = change.value(cells.number(text)?);
                let list = LISTS.iter().find(|list| list.name == word);
                list.map_or(Ok(()), |list| list.rule.check(word, number)).map(|()| number)
            };
            let metres = |text: &str| Ok::<_, CaseError>(number(text)? * MM);
            match word {
                "nominal_diameter_mm" => size.diameter = metres(text)?,
                "lead_mm" => size.lead = metres(text)?,
                "ball_diameter_mm" => size.ball = metres(text)?,
                // Where it is estimated, it follows from pitch circle and core.
                "ball" => size.ball_is_printed = text != "estimated",
                "pitch_circle_diameter_mm" => size.pitch_diameter = Some(metres(text)?),
                "core_diameter_mm" => size.core = Some(metres(text)?),
                "turns" => {
                    let one = |text: &str| {
                        let (turns, starts) = text.split_once('x').unwrap_or((text, "1"));
                        let starts = number(starts)?;
                        Rule::Whole(1.0).check("turns", starts)?;
                        Ok((number(turns)? * starts, starts))
                    };
                    all_turns = text.split('/').map(one).collect::<Result<_, CaseError>>()?;
                }
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
        match needed.into_iter().find(|(_, given)| !given) {
            Some((name, _)) => Err(CaseError::Invalid(format!("{name} is missing"))),
            None => Ok(all_turns.into_iter().map(move |(turns, starts)| OfferedSize {
                turns,
                starts,
                ..size
            })),
        }
    })?;
    Ok(sizes.into_iter().flatten().collect())
}

/// All of them.
pub(crate) fn offered_sizes() -> &'static [OfferedSize] {
    &SIZES
}

/// A column: our name of it, and the change to our unit; `None` if it is not read.
///
/// * `words`: names of columns besides the inputs of a case.
pub(crate) fn manufacturer_column(
    name: &str,
    format: &TableFormat,
    words: &[&'static str],
) -> Result<Option<(&'static str, UnitChange)>, CaseError> {
    let Some(own) = format.name(name) else { return Ok(None) };
    let known = || words.iter().copied().chain(INPUTS.iter().map(|input| input.name));
    if let Some(word) = known().find(|word| *word == own) {
        return Ok(Some((word, UnitChange::NONE)));
    }
    convert(own, known()).map(Some).ok_or_else(|| {
        let near = nearest(own, known()).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
        let what = format!(
            "unknown column `{own}`{near}; `names` of the dialect gives ours for the names of a manufacturer, null for a column that \
             is not read"
        );
        CaseError::Invalid(what)
    })
}

/// Reads the names of the columns of a foreign table: a JSON object from them to ours, or to null for a column
/// that is not read.
///
/// # Errors
///
/// [`CaseError`] for syntax, repeated names, and what is neither a name nor null.
pub fn column_names(json: &[u8]) -> Result<BTreeMap<String, Option<String>>, CaseError> {
    let name = |(key, value): (String, Value)| match value {
        Value::Null => Ok((key, None)),
        Value::String(name) => Ok((key, Some(name))),
        other => Err(wrong_type(&key, &other, "a name, or null")),
    };
    entries(json)?.into_iter().map(name).collect()
}
