//! Tests that the labels use the terms and symbols of `docs/glossary.md`.

use std::collections::BTreeMap;

use bsm_case::{AnalysisKind, INPUTS, Output, Quantity};

const GLOSSARY: &str = include_str!("../../../../docs/glossary.md");

/// Returns the names in a table cell in lower case, without text in parentheses.
fn names_in_cell(cell: &str) -> Vec<String> {
    let outside: String = cell
        .split('(')
        .enumerate()
        .map(
            |(place, part)| {
                if place == 0 { part } else { part.split_once(')').map_or("", |p| p.1) }
            },
        )
        .collect();
    let names = outside.split([';', ',']).map(|name| name.trim().to_lowercase());
    names.filter(|name| !name.is_empty() && !name.contains('$')).collect()
}

/// Returns the rows of the tables that have a symbol column. Each row consists of the terms, the
/// symbol with its unit, and the names that should not be used.
fn rows_with_symbol() -> Vec<(Vec<String>, &'static str, Vec<String>)> {
    let cells = |line: &'static str| {
        let cells: Vec<_> = line.strip_prefix("| ")?.split('|').map(str::trim).collect();
        let [term, symbol, _, others, ""] = cells[..] else { return None };
        (term != "term").then(|| (names_in_cell(term), symbol, names_in_cell(others)))
    };
    GLOSSARY.lines().filter_map(cells).collect()
}

/// Replaces a phrase, or its plural that ends with `s`, with a space. Returns `None` if the text
/// does not contain the phrase as separate words.
fn remove_phrase(text: &str, phrase: &str) -> Option<String> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(phrase).find_map(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + phrase.len()..]);
        let after = after.strip_prefix('s').unwrap_or(after);
        let alone = !before.ends_with(is_part) && !after.starts_with(is_part);
        alone.then(|| format!("{before} {after}"))
    })
}

fn quantities() -> impl Iterator<Item = &'static Quantity> {
    INPUTS.iter().chain(AnalysisKind::ALL.into_iter().flat_map(AnalysisKind::quantities))
}

/// Labels use the preferred terms of the glossary instead of their synonyms, for example
/// "stiffness" instead of "rigidity".
#[test]
fn labels_use_the_terms_of_the_glossary() {
    let rows = rows_with_symbol();
    let mut terms: Vec<_> = rows.iter().flat_map(|row| &row.0).collect();
    // The catalog rigidity is an exception, because it is the number printed in catalogs.
    let printed = "rigidity of the nut as stated by the manufacturer".to_owned();
    terms.push(&printed);
    terms.sort_by_key(|term| std::cmp::Reverse(term.len()));
    let others: Vec<_> =
        rows.iter().flat_map(|row| &row.2).filter(|o| !terms.contains(o)).collect();
    assert!(terms.len() > 80 && others.len() > 40, "{} {}", terms.len(), others.len());
    let labels = quantities().map(|quantity| (quantity.name, quantity.about));
    let labels: Vec<_> = labels.chain(Output::all().map(|o| (o.name, o.about))).collect();
    assert!(labels.len() > 400, "{} labels", labels.len());
    let mut found = Vec::new();
    for (name, label) in labels {
        let mut text = label.to_lowercase();
        for term in &terms {
            while let Some(rest) = remove_phrase(&text, term) {
                text = rest;
            }
        }
        let wrong = others.iter().filter(|other| remove_phrase(&text, other).is_some());
        found.extend(wrong.map(|other| format!("{name}: \"{label}\" has \"{other}\"")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// If a label is a term of the glossary, it has the symbol of this term.
#[test]
fn labels_have_the_symbols_of_the_glossary() {
    let plain = |symbol: &str| {
        let bare = symbol.replace(['$', '{', '}', '\\', ' '], "");
        bare.replace(['(', ')'], ",").replace("varphi", "phi")
    };
    let rows = rows_with_symbol();
    let symbols: BTreeMap<_, _> = rows
        .iter()
        .flat_map(|row| row.0.iter().map(|term| (term.as_str(), plain(row.1))))
        .collect();
    let mut met = 0;
    for Quantity { name, about, symbol, .. } in quantities().filter(|q| !q.symbol.is_empty()) {
        let label = about.split([';', ',']).next().unwrap_or_default().to_lowercase();
        let Some(own) = symbols.get(label.as_str()) else { continue };
        met += 1;
        let own: Vec<_> = own.split([',', ';', '=']).collect();
        let is_own = own.iter().any(|own| own.trim_end_matches("inequations") == plain(symbol));
        assert!(is_own, "{name}: {symbol}, but the glossary has {own:?}");
    }
    assert!(met > 10, "{met} symbols");
}
