//! Comparison of two offers for a screw: the design rules, the results by which screws are
//! compared, and the inputs that differ.

use bsm_design::Band;
use serde_json::{Map, Value, json};

use crate::answers::axis::{AxisReport, sheet_columns};
use crate::answers::groove::pair;
use crate::{Answer, Content, Criterion, Table, Verdict};

/// Columns of the tables that compare the rules, numbers and inputs of two offers.
pub(crate) const RULES: &str = "rule:string | =unit | limit:number? | first:number? | second:number? | better:string? | \
                                -first_interval:numbers? | -second_interval:numbers?";
pub(crate) const NUMBERS: &str = "number:string | =unit | first:number? | second:number? | better:string? | \
                                  -first_interval:numbers? | -second_interval:numbers?";
pub(crate) const INPUTS: &str = "input:string | first:any | second:any";

/// Numbers for which a smaller value is better. A larger value is better for the other numbers of
/// [`sheet_columns`], except for the numbers in [`NEITHER`].
const SMALLER: [&str; 5] = [
    "critical_speed_ratio",
    "peak_motor_torque_Nm",
    "mean_heat_W",
    "screw_mass_kg",
    "inertia_of_screw_kg_m2",
];
const NEITHER: [&str; 2] = ["back_driving_torque_Nm", "warm_preload_N"];

/// Returns the name of the better offer, `first` or `second`. Returns `None` if the values are
/// equal or a value is missing.
///
/// * `smaller`: true if a smaller value is better.
fn better(first: Option<f64>, second: Option<f64>, smaller: bool) -> Option<&'static str> {
    let (first, second) = (first?, second?);
    // Relative differences of up to 1e-9 are rounding errors.
    if (first - second).abs() <= 1e-9 * first.abs().max(second.abs()) {
        return None;
    }
    Some(if (first < second) == smaller { "first" } else { "second" })
}

/// Returns the rule with the given title.
fn find<'a>(rules: &'a [Criterion], title: &str) -> Option<&'a Criterion> {
    rules.iter().find(|rule| rule.title == title)
}

/// Returns a text that consists of `words` and the titles of the rules with the given verdict.
fn with_titles(report: &AxisReport, words: &str, verdict: Verdict) -> String {
    let rules = report.answer.rules.iter().filter(|rule| rule.verdict() == verdict);
    let titles: Vec<_> = rules.map(|rule| rule.title).collect();
    let titles = if titles.is_empty() { String::new() } else { format!(": {}", titles.join(", ")) };
    format!("{words}{titles}")
}

/// Compares the axis sheets of two offers.
///
/// * `names`: names of the offers, such as their file names.
pub fn compare_offers(names: [&str; 2], [first, second]: [&AxisReport; 2]) -> Answer {
    let verdict = |name: &str, report: &AxisReport| {
        let lacks = report.answer.all_not_given();
        let words = match (report.verdict(), &lacks[..]) {
            (Verdict::Fails, _) => with_titles(report, "fails", Verdict::Fails),
            (Verdict::Undecided, _) => {
                with_titles(report, "no rule fails; undecided", Verdict::Undecided)
            }
            (Verdict::Passes, []) => "all rules pass".to_owned(),
            (Verdict::Passes, lacks) => {
                format!("all rules pass for the given inputs ({})", lacks.join("; "))
            }
        };
        format!("{name}: {words}; order: {}", report.order)
    };
    let offers = vec![verdict(names[0], first), verdict(names[1], second)];
    let [of_first, of_second] = [first, second].map(|report| &report.answer.rules[..]);
    let only_second = |rule: &&Criterion| find(of_first, rule.title).is_none();
    let all = of_first.iter().chain(of_second.iter().filter(only_second));
    let rules = all.map(|Criterion { title, .. }| {
        let [one, other] = [of_first, of_second].map(|rules| find(rules, title));
        let [margin, other_margin] = [one, other].map(|rule| rule?.margin());
        let value = |rule: Option<&Criterion>| rule.map(|rule| rule.value);
        let limit = one.or(other).and_then(|rule| rule.limit);
        let better = better(margin, other_margin, false);
        let bands = [one, other].map(|rule| rule?.band);
        let unit = one.or(other).map_or("", |rule| rule.unit.text);
        let cells =
            vec![json!(title), json!(unit), json!(limit), json!(value(one)), json!(value(other))];
        (unit, beside(cells, better, bands))
    });
    let numbers = sheet_columns().filter_map(|column| {
        let values = [first, second].map(|report| report.number(column.into()));
        values.iter().any(Option::is_some).then(|| {
            let [one, other] = values;
            let best = if NEITHER.contains(&column.name) {
                None
            } else {
                better(one, other, SMALLER.contains(&column.name))
            };
            let bands = [first, second].map(|report| report.answer.band(column.name));
            let cells = vec![json!(column.name), json!(column.unit), json!(one), json!(other)];
            (column.unit, beside(cells, best, bands))
        })
    });
    let fails = first.verdict().min(second.verdict()) == Verdict::Fails;
    Answer { fails, ..Answer::default() }
        .with("offers", Content::Texts("", offers))
        .with("rules", Content::Table(table(RULES, rules)))
        .with("numbers", Content::Table(table(NUMBERS, numbers)))
        .with("inputs", Content::Table(Table::of(INPUTS, differing([first, second]))))
}

/// Cells of a row, and the intervals that the screen shows next to them.
type RowOfOffers = (Vec<Value>, Vec<Option<Band>>);

/// Appends the better offer and the intervals of both offers to the cells of a row.
fn beside(mut cells: Vec<Value>, better: Option<&str>, bands: [Option<Band>; 2]) -> RowOfOffers {
    let mut shown = vec![None; cells.len() - 2];
    shown.extend(bands);
    cells.push(json!(better));
    cells.extend(bands.map(|band| json!(band.map(pair))));
    shown.resize(cells.len(), None);
    (cells, shown)
}

fn table(columns: &'static str, rows: impl Iterator<Item = (&'static str, RowOfOffers)>) -> Table {
    let (row_units, rows): (Vec<_>, Vec<_>) = rows.unzip();
    let (rows, bands): (Vec<_>, _) = rows.into_iter().unzip();
    Table { bands, row_units, ..Table::of(columns, rows) }
}

/// Returns the inputs in which the offers differ, with the value of each offer.
fn differing(reports: [&AxisReport; 2]) -> Vec<Vec<Value>> {
    let inputs = |report: &AxisReport| match report.case.to_json() {
        Value::Object(inputs) => inputs,
        _ => Map::new(),
    };
    let [first, second] = reports.map(inputs);
    let keys = first.keys().chain(second.keys().filter(|key| !first.contains_key(*key)));
    // The description names the offer, and the list of estimated inputs is not an input itself.
    let is_input = |key: &&String| !["description", "estimated_inputs"].contains(&key.as_str());
    let differ = keys.filter(is_input).filter(|key| first.get(*key) != second.get(*key));
    differ.map(|key| vec![json!(key), json!(first.get(key)), json!(second.get(key))]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a misspelled name in these lists, the comparison would report the worse offer as
    /// better.
    #[test]
    fn compared_outputs_exist_on_the_axis_sheet() {
        for name in SMALLER.into_iter().chain(NEITHER) {
            assert!(sheet_columns().any(|column| column.name == name), "{name}");
        }
    }
}
