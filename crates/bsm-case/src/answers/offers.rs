//! Comparison of two offers for a screw: design rules, results that are used to compare screws, and
//! inputs that differ between the offers.

use serde_json::{Map, Value};

use crate::answers::axis::{AxisReport, StiffnessOrigin, sheet_columns};
use crate::answers::groove::pair;
use crate::vocabulary::members::{Rows, Sentences, answer, row};
use crate::{Answer, Column, Criterion, OutputName, Verdict, output};

row! {
    /// A design rule that is checked for both offers.
    pub(crate) struct OfferedRule {
        /// Title of the rule.
        rule: &'static str = "rule";
        [skip] unit: &'static str = "unit";
        first: Option<f64> = "first" | first_interval;
        /// Limit of the rule for the first offer.
        first_limit: Option<f64> = "limit";
        /// `passes`, `fails` or `undecided`; null if the rule does not apply to the first offer.
        first_verdict: Option<&'static str> = "verdict";
        second: Option<f64> = "second" | second_interval;
        /// Limit of the rule for the second offer.
        second_limit: Option<f64> = "limit";
        /// `passes`, `fails` or `undecided`; null if the rule does not apply to the second offer.
        second_verdict: Option<&'static str> = "verdict";
        /// `first` or `second`; null if neither is better.
        better: Option<&'static str> = "better";
        first_interval: Option<[f64; 2]>;
        second_interval: Option<[f64; 2]>;
    } unit unit
}

row! {
    /// A result that is calculated for both offers.
    pub(crate) struct OfferedNumber {
        /// Name of the result.
        number: &'static str;
        [skip] label: &'static str = "number";
        [skip] unit: &'static str = "unit";
        first: Option<f64> = "first" | first_interval;
        second: Option<f64> = "second" | second_interval;
        /// `first` or `second`; null if neither is better.
        better: Option<&'static str> = "better";
        first_interval: Option<[f64; 2]>;
        second_interval: Option<[f64; 2]>;
    } unit unit
}

row! {
    /// An input that differs between the offers.
    pub(crate) struct OfferedInput {
        /// Name of the input.
        input: String = "input";
        first: Option<Value> = "first";
        second: Option<Value> = "second";
    }
}

answer! {
    /// Two offers.
    pub(crate) struct OfferMembers {
        /// Verdict on each offer, and order data of its screw.
        offers: Sentences;
        rules: Rows<OfferedRule>;
        numbers: Rows<OfferedNumber>;
        inputs: Rows<OfferedInput>;
    }
}

/// One of two offers that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offer {
    /// The first offer.
    First,
    /// The second offer.
    Second,
}

impl Offer {
    /// Both offers.
    const ALL: [Self; 2] = [Self::First, Self::Second];

    /// Returns the name of the offer in a comparison.
    pub fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Second => "second",
        }
    }

    /// Returns the offer with the given name, or `None` for any other text.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|offer| offer.name() == name)
    }
}

/// Meaning of a column in a table that compares two offers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfferColumn {
    /// Title of the row, which is a rule, a result or an input.
    Title,
    /// Unit of the values in the row.
    Unit,
    /// Value for an offer.
    Value(Offer),
    /// Limit of the rule for an offer.
    Limit(Offer),
    /// Verdict on the rule for an offer.
    Verdict(Offer),
    /// Name of the better offer (see [`Offer::named`]).
    Better,
}

impl OfferColumn {
    /// Returns the meaning of a column that has a heading.
    pub fn of(column: &Column) -> Self {
        if column.name == "better" {
            return Self::Better;
        }
        if column.head.as_deref() == Some("unit") {
            return Self::Unit;
        }
        let of_offer = Offer::ALL.into_iter().find_map(|offer| {
            match column.name.strip_prefix(offer.name())? {
                "" => Some(Self::Value(offer)),
                "_limit" => Some(Self::Limit(offer)),
                "_verdict" => Some(Self::Verdict(offer)),
                _ => None,
            }
        });
        of_offer.unwrap_or(Self::Title)
    }
}

/// Results for which a smaller value is better. For all other results of [`sheet_columns`], except
/// for the results in [`NO_PREFERENCE`], a larger value is better.
const SMALLER_IS_BETTER: [OutputName; 6] = [
    output!(critical_speed_ratio),
    output!(peak_motor_torque_Nm),
    output!(mean_heat_W),
    output!(screw_mass_kg),
    output!(mass_of_nut_and_screw_kg),
    output!(inertia_of_screw_kg_m2),
];
/// Results for which neither a smaller nor a larger value is better.
const NO_PREFERENCE: [OutputName; 3] =
    [output!(back_driving_torque_Nm), output!(warm_preload_N), output!(unsupported_length_mm)];

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
    let better = if (first < second) == smaller { Offer::First } else { Offer::Second };
    Some(better.name())
}

/// Returns the rule with the given title.
fn find<'a>(rules: &'a [Criterion], title: &str) -> Option<&'a Criterion> {
    rules.iter().find(|rule| rule.title == title)
}

/// Returns a text that consists of `words`, followed by the titles of the rules with the given
/// verdict.
fn with_titles(report: &AxisReport, words: &str, verdict: Verdict) -> String {
    let rules = report.answer.rules.iter().filter(|rule| rule.verdict() == verdict);
    let titles: Vec<_> = rules.map(|rule| rule.title).collect();
    let titles = if titles.is_empty() { String::new() } else { format!(": {}", titles.join(", ")) };
    format!("{words}{titles}")
}

/// Compares the axis sheets of two offers.
///
/// * `names`: names of the two offers, such as their file names.
pub fn compare_offers(names: [&str; 2], [first, second]: [&AxisReport; 2]) -> Answer {
    let verdict = |name: &str, report: &AxisReport| {
        let words = match report.verdict() {
            Verdict::Fails => with_titles(report, "fails", Verdict::Fails),
            Verdict::Undecided => {
                with_titles(report, "no rule fails; undecided", Verdict::Undecided)
            }
            Verdict::Passes => "all rules pass".to_owned(),
        };
        let lacks = report.answer.all_not_given();
        let missing = if lacks.is_empty() {
            String::new()
        } else {
            format!("; missing inputs: {}", lacks.join("; "))
        };
        format!("{name}: {words}; order: {}{missing}", report.order)
    };
    let offers = vec![verdict(names[0], first), verdict(names[1], second)];
    let [of_first, of_second] = [first, second].map(|report| &report.answer.rules[..]);
    let only_second = |rule: &&Criterion| find(of_first, rule.title).is_none();
    let all = of_first.iter().chain(of_second.iter().filter(only_second));
    let rules = all.map(|Criterion { title, .. }| {
        let [one, other] = [of_first, of_second].map(|rules| find(rules, title));
        let [margin, other_margin] = [one, other].map(|rule| rule?.margin());
        let value = |rule: Option<&Criterion>| rule.map(|rule| rule.value);
        let limit = |rule: Option<&Criterion>| rule.and_then(|rule| rule.limit);
        let verdict = |rule: Option<&Criterion>| rule.map(|rule| rule.verdict().word());
        let better = better(margin, other_margin, false);
        OfferedRule {
            rule: title,
            unit: one.or(other).map_or("", |rule| rule.unit.text),
            first: value(one),
            first_limit: limit(one),
            first_verdict: verdict(one),
            second: value(other),
            second_limit: limit(other),
            second_verdict: verdict(other),
            better,
            first_interval: one.and_then(|rule| rule.band).map(pair),
            second_interval: other.and_then(|rule| rule.band).map(pair),
        }
    });
    // A calculated stiffness cannot be compared with a stiffness that follows from a catalog.
    let origins = [first, second].map(|report| report.stiffness_origin);
    let has_other_origin = origins[0] != origins[1] && !origins.contains(&None);
    let note = has_other_origin.then(|| {
        let by_catalog = origins.iter().position(|origin| *origin == Some(StiffnessOrigin::Catalog));
        let name = by_catalog.map_or("", |place| names[place]);
        format!(
            "The two values of axis_stiffness_N_um are not ranked, because only that of {name} follows from a catalog. The other is \
             calculated from the contacts alone and is usually larger. Give rated_rigidity_N_um for both offers or for neither."
        )
    });
    let numbers = sheet_columns().filter_map(|column| {
        let values = [first, second].map(|report| report.number(column.into()));
        values.iter().any(Option::is_some).then(|| {
            let [one, other] = values;
            let name = OutputName::from(column);
            let best = if NO_PREFERENCE.contains(&name)
                || has_other_origin && name == output!(axis_stiffness_N_um)
            {
                None
            } else {
                better(one, other, SMALLER_IS_BETTER.contains(&name))
            };
            OfferedNumber {
                number: column.name,
                label: column.about.split(';').next().unwrap_or(column.about),
                unit: column.unit,
                first: one,
                second: other,
                better: best,
                first_interval: first.answer.band(column.name).map(pair),
                second_interval: second.answer.band(column.name).map(pair),
            }
        })
    });
    let fails = first.verdict().min(second.verdict()) == Verdict::Fails;
    let notes = note.into_iter().collect();
    Answer { notes, fails, ..Answer::default() }.with_members(OfferMembers {
        offers: Sentences("", offers),
        rules: Rows(rules.collect()),
        numbers: Rows(numbers.collect()),
        inputs: Rows(differing([first, second])),
    })
}

/// Returns the inputs that differ between the offers, with the value for each offer.
fn differing(reports: [&AxisReport; 2]) -> Vec<OfferedInput> {
    let inputs = |report: &AxisReport| match report.case.to_json() {
        Value::Object(inputs) => inputs,
        _ => Map::new(),
    };
    let [first, second] = reports.map(inputs);
    let keys = first.keys().chain(second.keys().filter(|key| !first.contains_key(*key)));
    // The description and the estimated inputs are not compared: the description only names the
    // offer, and the user did not give the estimated inputs.
    let is_estimated = |key: &str| reports.iter().any(|report| report.case.estimates(key));
    let is_input = |key: &&String| {
        !["description", "estimated_inputs"].contains(&key.as_str()) && !is_estimated(key)
    };
    let differ = keys.filter(is_input).filter(|key| first.get(*key) != second.get(*key));
    let row = |key: &String| OfferedInput {
        input: key.clone(),
        first: first.get(key).cloned(),
        second: second.get(key).cloned(),
    };
    differ.map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A misspelled name in these lists would cause the comparison to report the worse offer as
    /// better.
    #[test]
    fn outputs_that_compare_offers_exist_on_the_axis_sheet() {
        for name in SMALLER_IS_BETTER.into_iter().chain(NO_PREFERENCE) {
            assert!(sheet_columns().any(|column| OutputName::from(column) == name), "{name:?}");
        }
    }
}
