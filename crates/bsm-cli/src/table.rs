//! Formats answers as text tables.

use std::collections::BTreeSet;

use bsm_case::{
    Answer, Content, Criterion, Numbers, Row, Scales, Scope, Table as Rows, Verdict,
    format_interval, format_number, format_short,
};
use comfy_table::{CellAlignment, Table, presets};
use serde_json::Value;

/// Returns the table cell that states whether a limit is met. Without a limit, the cell is empty.
///
/// * `verdict`: `None` if there is no limit.
fn verdict(verdict: Option<Verdict>) -> String {
    let word = match verdict {
        None => "",
        Some(Verdict::Passes) => "pass",
        Some(Verdict::Undecided) => "undecided",
        Some(Verdict::Fails) => "FAIL",
    };
    word.to_owned()
}

/// Formats a table without borders. All columns from index `first_number` onward are right-aligned.
pub(crate) fn plain(header: Option<&[&str]>, rows: &[Vec<String>], first_number: usize) -> String {
    aligned(header, rows, |column| column >= first_number)
}

/// Formats a table without borders. `right` returns true for right-aligned columns.
fn aligned(header: Option<&[&str]>, rows: &[Vec<String>], right: impl Fn(usize) -> bool) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    if let Some(header) = header {
        table.set_header(header.to_vec());
    }
    table.add_rows(rows);
    for (_, column) in table.column_iter_mut().enumerate().filter(|(place, _)| right(*place)) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// Formats a value. A value without a unit is formatted as a count if it is a whole number.
fn shown(unit: &str, value: f64) -> String {
    if unit.is_empty() { count_or_number(value) } else { format_number(value) }
}

/// Formats a count with all its digits, and any other number with five digits. The value 1 is not
/// treated as a count, because it is usually a ratio.
pub(crate) fn count_or_number(value: f64) -> String {
    let is_count = (2.0..1e6).contains(&value.abs()) && value.fract().abs() <= 0.0;
    if is_count { format!("{value:.0}") } else { format_number(value) }
}

/// Formats an answer as text: rules, sections and notes.
pub(crate) fn answer(answer: &Answer) -> String {
    let mut blocks: Vec<String> = Vec::new();
    if !answer.rules.is_empty() {
        let rules: Vec<_> = answer.rules.iter().map(rule).collect();
        let header = ["rule", "", "", "value", "limit", "utilization", "", "source"];
        blocks.push(plain(Some(&header), &rules, usize::MAX));
        let remedy =
            |rule: &Criterion| Some(format!("  {}: {}", rule.title, rule.remedy.as_ref()?));
        let remedies: Vec<_> = answer.rules.iter().filter_map(remedy).collect();
        if !remedies.is_empty() {
            blocks.push(format!("remedies\n{}", remedies.join("\n")));
        }
    }
    // Consecutive text sections form one block.
    let mut lines = Vec::new();
    for section in &answer.sections {
        match &section.content {
            Content::Text(label, Some(words)) => {
                lines.push(format!("{label}  {words}").trim().to_owned());
            }
            Content::Texts(label, texts) => {
                let label = if label.is_empty() { String::new() } else { format!("{label}: ") };
                lines.extend(texts.iter().map(|text| format!("{label}{text}")));
            }
            Content::Text(_, None) | Content::Json(_) => {}
            Content::Table(table) => {
                blocks.extend((!lines.is_empty()).then(|| std::mem::take(&mut lines).join("\n")));
                blocks.extend((!table.rows.is_empty()).then(|| rows(table)));
            }
            Content::Numbers { numbers: found, whole, unbounded } => {
                blocks.extend((!lines.is_empty()).then(|| std::mem::take(&mut lines).join("\n")));
                blocks.extend(numbers(found, (whole, unbounded), answer));
            }
        }
    }
    lines.extend(answer.notes.iter().map(|note| format!("note: {note}")));
    blocks.extend((!lines.is_empty()).then(|| lines.join("\n")));
    blocks.join("\n\n")
}

fn rule(rule: &Criterion) -> Vec<String> {
    vec![
        rule.title.to_owned(),
        rule.shown_name(),
        rule.unit.text.to_owned(),
        if rule.value.is_nan() {
            "-".to_owned()
        } else {
            format_number(rule.value) + &format_interval(rule.band)
        },
        rule.must_be().unwrap_or_default(),
        rule.margin()
            .filter(|margin| !margin.is_nan())
            .map_or_else(String::new, |margin| format!("{} %", format_short(100.0 / margin))),
        verdict(rule.limit.map(|_| rule.verdict())),
        rule.source.clone().into_owned(),
    ]
}

/// Formats a table of numbers and text.
fn rows(table: &Rows) -> String {
    let shown: Vec<_> = (0..)
        .zip(&table.columns)
        .filter_map(|(i, column)| Some((i, column.head.as_deref()?)))
        .collect();
    let is_text =
        |i: &usize| table.rows.iter().any(|row| row[*i].is_string() || row[*i].is_boolean());
    let cell = |i: usize, value: &Value| match value {
        Value::Null if table.columns[i].name == "passes" => verdict(Some(Verdict::Undecided)),
        Value::Bool(passes) if table.columns[i].name == "passes" => {
            verdict(Some(if *passes { Verdict::Passes } else { Verdict::Fails }))
        }
        Value::Null => if is_text(&i) { "" } else { "-" }.to_owned(),
        Value::Bool(holds) => if *holds { "yes" } else { "no" }.to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(count) if !count.is_f64() => count.to_string(),
        other => other.as_f64().map_or_else(|| other.to_string(), format_number),
    };
    let cells = |(place, row): (usize, &Vec<Value>)| {
        let band = |i: usize| format_interval(table.bands.get(place).and_then(|bands| bands[i]));
        shown.iter().map(|(i, _)| cell(*i, &row[*i]) + &band(*i)).collect()
    };
    let header: Vec<_> = shown.iter().map(|(_, head)| *head).collect();
    let cells: Vec<_> = table.rows.iter().enumerate().map(cells).collect();
    aligned(Some(&header), &cells, |column| !is_text(&shown[column].0))
}

/// Formats quantities as text tables, one for each title and scope.
///
/// * `whole`: column heading for quantities that do not refer to a contact or a direction.
/// * `unbounded`: names of quantities that are not covered by the error bound.
/// * `answer`: answer that lists the missing inputs for each quantity.
fn numbers(numbers: &Numbers, (whole, unbounded): (&str, &[&str]), answer: &Answer) -> Vec<String> {
    let mut rows: Vec<_> =
        numbers.rows().filter(|row| row.quantity.scope != Scope::Statement).collect();
    let values = |row: &&Row| {
        let unit = row.unit;
        row.values.into_iter().flatten().map(move |value| (unit, value))
    };
    let scales = Scales::of(rows.iter().flat_map(values));
    // Under each title, quantities that do not refer to a contact or a direction come first.
    for rows in rows.chunk_by_mut(|a, b| a.quantity.title == b.quantity.title) {
        rows.sort_by_key(|row| row.quantity.scope as u8);
    }
    let same = |a: &&Row, b: &&Row| {
        (a.quantity.title, a.quantity.scope) == (b.quantity.title, b.quantity.scope)
    };
    rows.chunk_by(same).map(|rows| block(rows, (whole, unbounded), answer, &scales)).collect()
}

/// Formats quantities with the same title and scope as one table.
fn block(
    rows: &[&Row],
    (whole, unbounded): (&str, &[&str]),
    answer: &Answer,
    scales: &Scales,
) -> String {
    let first = rows[0].quantity;
    let members = if first.scope == Scope::Scalar { &[whole][..] } else { first.scope.members() };
    let has_symbols = rows.iter().any(|row| !row.quantity.symbol.is_empty());
    // Missing inputs are listed in notes below the table, so that the columns stay narrow.
    let not_given = answer.all_not_given();
    let notes_of = |number: &str| -> Vec<usize> {
        let of_number = |text: &str| {
            answer.not_given.iter().any(|lack| lack.number == number && lack.text == text)
        };
        (0..not_given.len()).filter(|place| of_number(not_given[*place])).collect()
    };
    let cells = |row: &&Row| {
        let quantity = row.quantity;
        let print = |value: f64| shown(row.unit, scales.clean(row.unit, value));
        let none = if first.scope == Scope::Directions { "none" } else { "" };
        let number = |(value, band): (&Option<f64>, _)| {
            value.map_or_else(|| none.to_owned(), |value| print(value) + &format_interval(band))
        };
        let numbers = row.values.iter().zip(row.bands).take(members.len()).map(number);
        let mark = if unbounded.contains(&quantity.name) { " *" } else { "" };
        let notes = notes_of(quantity.name);
        let notes: Vec<_> = notes.iter().map(|place| format!(" [{}]", place + 1)).collect();
        let notes = notes.concat();
        let label = std::iter::once(format!("{}{mark}{notes}", quantity.about));
        let symbol = has_symbols.then(|| quantity.symbol.to_owned());
        label.chain(symbol).chain([row.unit.to_owned()]).chain(numbers).collect()
    };
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    let blank = vec![""; 1 + usize::from(has_symbols)];
    let header = [&[first.title][..], &blank, members].concat();
    let header = header.iter().any(|head| !head.is_empty()).then_some(&header[..]);
    let table = plain(header, &cells, 2 + usize::from(has_symbols));
    let noted: BTreeSet<_> = rows.iter().flat_map(|row| notes_of(row.quantity.name)).collect();
    let notes = noted.into_iter().map(|place| format!(" [{}] {}", place + 1, not_given[place]));
    std::iter::once(table).chain(notes).collect::<Vec<_>>().join("\n")
}
