//! Comparison of two offers for a screw on one page.

use bsm_case::{
    Answer, Column, Content, DisplayUnits, Offer, OfferColumn, Table, Verdict, format_digits,
    format_interval,
};
use serde_json::{Value, json};

use crate::{Page, ReportError};

/// Number of significant digits of the compared values.
const DIGITS: u8 = 4;

/// Sections of the comparison, with their titles.
const TABLES: [(&str, &str); 3] =
    [("rules", "Rules"), ("numbers", "Numbers"), ("inputs", "Inputs that differ")];

/// Returns the comparison of two offers as an HTML page.
///
/// * `answer`: answer that contains the comparison.
/// * `names`: names of the offers, such as their file names.
///
/// # Errors
///
/// Returns [`ReportError::Page`] if the template is invalid.
pub fn offers_page(
    answer: &Answer,
    names: [&str; 2],
    units: DisplayUnits,
) -> Result<String, ReportError> {
    let answer = answer.clone().in_units(units);
    let table = |(member, title): (&str, &str)| match answer.section(member) {
        Some(Content::Table(table)) => Some(table_of(title, table, names)),
        _ => None,
    };
    let page = Page {
        title: "Ball screw axis: two offers",
        command: "bsm axis A.json B.json -o offers.html",
        template: include_str!("../../templates/offers.html"),
        figures: &[],
    };
    page.html(&json!({
        "offers": answer.texts("offers"),
        "tables": TABLES.into_iter().filter_map(table).collect::<Vec<_>>(),
    }))
}

/// Returns the data of a table for the template. Each row states which offer is better.
fn table_of(title: &str, table: &Table, names: [&str; 2]) -> Value {
    let shown = (0..).zip(&table.columns).filter(|(_, column)| column.head.is_some());
    let shown: Vec<_> =
        shown.filter(|(_, column)| OfferColumn::of(column) != OfferColumn::Better).collect();
    let name_of = |offer: Offer| match offer {
        Offer::First => names[0],
        Offer::Second => names[1],
    };
    // The columns of an offer are labeled with the name of the offer.
    let label = |column: &Column| {
        let head = column.head.as_deref().unwrap_or_default();
        match OfferColumn::of(column) {
            OfferColumn::Value(offer) => name_of(offer).to_owned(),
            OfferColumn::Limit(offer) | OfferColumn::Verdict(offer) => {
                format!("{}: {head}", name_of(offer))
            }
            OfferColumn::Title | OfferColumn::Unit | OfferColumn::Better => head.to_owned(),
        }
    };
    let head = |(place, column): &(usize, &Column)| {
        let has_numbers = table.rows.iter().any(|row| row[*place].is_number());
        json!({ "text": label(column), "has_numbers": has_numbers })
    };
    let better =
        table.columns.iter().position(|column| OfferColumn::of(column) == OfferColumn::Better);
    let row = |(place, row): (usize, &Vec<Value>)| {
        let better = better.and_then(|column| Offer::named(row[column].as_str()?));
        let cell = |(column, about): &(usize, &Column)| {
            let band = table.bands.get(place).and_then(|bands| bands[*column]);
            let text = match &row[*column] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => match other.as_f64() {
                    Some(number) => format_digits(number, DIGITS) + &format_interval(band),
                    None => other.to_string(),
                },
            };
            let meaning = OfferColumn::of(about);
            let is_better = better.is_some_and(|offer| meaning == OfferColumn::Value(offer));
            let is_verdict = matches!(meaning, OfferColumn::Verdict(_));
            json!({
                "text": text,
                "is_number": row[*column].is_number(),
                "is_unit": meaning == OfferColumn::Unit,
                "is_better": is_better,
                "fails": is_verdict && text == Verdict::Fails.word(),
                "label": label(about),
            })
        };
        shown.iter().map(cell).collect::<Vec<_>>()
    };
    let rows: Vec<_> = table.rows.iter().enumerate().map(row).collect();
    json!({ "title": title, "heads": shown.iter().map(head).collect::<Vec<_>>(), "rows": rows })
}
