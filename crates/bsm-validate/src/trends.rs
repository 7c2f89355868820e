//! Published trends against the curves of our sweeps.

use std::collections::BTreeSet;

use bsm_report::number;
use serde::Deserialize;

use crate::published::File;
use crate::{Check, Shape, Study, Trend, ValidateError};

/// A row of a table of trends.
#[derive(Deserialize)]
struct Row {
    /// Label of the studies and group of the trend.
    trend: String,
    statement: String,
    /// On how many curves it held when the finding was made, and of how many.
    held: usize,
    curves: usize,
}

/// A check for each trend of a table; one that fails for each trend that the table does not have.
///
/// * `studies`: with a label that stands in front of the groups of their trends, and what sets them
///   apart among those of one label.
pub(crate) fn checks(
    source: &str,
    key: &str,
    table: &File,
    studies: &[(&str, &str, Study)],
) -> Result<Vec<Check>, ValidateError> {
    let named = || {
        studies.iter().flat_map(|(label, setting, study)| {
            study
                .trends
                .iter()
                .map(move |trend| (format!("{label}{}", trend.group), setting, trend))
        })
    };
    let describe = |setting: &str, trend: &Trend| {
        let holds = if trend.holds { "holds" } else { "does not" };
        let [from, to] = [trend.first.1, trend.last.1].map(number);
        format!("{}{setting}: {holds}, {from} to {to}, {}", trend.curve, trend.describe())
    };
    let mut checks = Vec::new();
    let mut unknown: BTreeSet<_> = named().map(|(group, ..)| group).collect();
    for row in table.rows::<Row>()? {
        unknown.remove(&row.trend);
        let curves: Vec<_> = named().filter(|(group, ..)| *group == row.trend).collect();
        let held = curves.iter().filter(|(.., trend)| trend.holds).count();
        let details: Vec<_> =
            curves.iter().map(|(_, setting, trend)| describe(setting, trend)).collect();
        let check = Check {
            details: details.join("; "),
            ..Check::new(&format!("{key}/{}", row.trend), source, row.statement)
        };
        let trends: Vec<_> = curves.iter().map(|(.., trend)| *trend).collect();
        let recorded = (row.held, row.curves);
        checks.push(check.note(counts(&trends)).follows(held, curves.len(), recorded));
    }
    let unrecorded =
        |group: &String| {
            Check::new(&format!("{key}/{group}"), source, "a trend that is not in the table")
                .follows(1, 1, (0, 0))
        };
    checks.extend(unknown.iter().map(unrecorded));
    Ok(checks)
}

/// How many curves have which shape, in words.
fn counts(trends: &[&Trend]) -> String {
    let word = |shape: Shape| match shape {
        Shape::Rises => "rising",
        Shape::Falls => "falling",
        Shape::Constant => "constant",
        Shape::Turns(_) => "turning",
    };
    let count = |name: &str| trends.iter().filter(|t| word(t.shape) == name).count();
    let counted = ["rising", "falling", "constant", "turning"].map(|name| (count(name), name));
    let counted = counted.iter().filter(|(count, _)| *count > 0);
    counted.map(|(count, name)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}
