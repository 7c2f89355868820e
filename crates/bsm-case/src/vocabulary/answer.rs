//! Answers of the program. An answer consists of sections with numbers, tables and texts, of rules
//! with limit, margin and source, and of notes and warnings. Text, JSON and HTML output are all
//! generated from answers.

use std::borrow::Cow;

use bsm_design::Bounds;
use bsm_design::statistics::Band;
use serde_json::{Map, Value, json};

use crate::vocabulary::members::row;
use crate::{DisplayUnit, Numbers, Output, OutputName, Scope, format_trimmed};

/// An answer of the program, such as an axis sheet.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// Sections in the order in which they are shown.
    pub sections: Vec<Section>,
    /// Rules that the results must meet.
    pub rules: Vec<Criterion>,
    /// Notes on default values that were used and on effects that were neglected.
    pub notes: Vec<String>,
    /// Warnings about the results.
    pub warnings: Vec<String>,
    /// Missing inputs that were treated as zero, each with the name of a result that the input
    /// affects.
    pub not_given: Vec<MissingInput>,
    /// True if there is no solution, if nothing was found, or if a rule is violated.
    pub fails: bool,
}

/// A missing input that was treated as zero, so that its contribution to a result is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingInput {
    /// Name of the result that the missing input affects.
    pub number: &'static str,
    /// Sentence that names the missing input and states how it was treated.
    pub text: String,
}

/// A section of an answer: numbers, a table or text.
#[derive(Debug, Clone)]
pub struct Section {
    /// Name of the section in the JSON object. If the name is empty, the numbers of the section
    /// become members of the enclosing object. If it is `None`, the section is shown only on the
    /// screen.
    pub member: Option<&'static str>,
    /// Numbers, table or text of the section.
    pub content: Content,
}

/// The kinds of content that a section can have.
#[derive(Debug, Clone)]
pub enum Content {
    /// Values of the quantities in a table of quantities.
    Numbers {
        /// Quantities of the section with their values.
        numbers: Numbers,
        /// Heading of the quantities that apply neither to a single contact nor to a single
        /// direction.
        whole: &'static str,
        /// Names of the quantities to which no error bound applies.
        unbounded: Vec<&'static str>,
    },
    /// A table with rows of numbers and strings.
    Table(Table),
    /// A label, followed by a short text that may be missing.
    Text(&'static str, Option<String>),
    /// A label, followed by sentences.
    Texts(&'static str, Vec<String>),
    /// JSON that is not shown on the screen.
    Json(Value),
}

/// A table whose rows become JSON objects.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Columns of the table.
    pub columns: Vec<Column>,
    /// Cells of the table, row by row.
    pub rows: Vec<Vec<Value>>,
    /// 90 % intervals of cells that depend on an estimated groove, row by row; empty if
    /// there are none.
    pub bands: Vec<Vec<Option<Band>>>,
    /// Unit of each row, if the rows have different units; empty if the columns have units.
    pub row_units: Vec<&'static str>,
    /// True if the JSON form is an object of objects whose keys are in the first column; false if
    /// it is a list of objects.
    pub keyed: bool,
}

/// A column of a result table.
#[derive(Debug, Clone)]
pub struct Column {
    /// Name of the column in JSON. A column with an empty name is shown only on the screen.
    pub name: Cow<'static, str>,
    /// Unit of the column as text.
    pub unit: &'static str,
    /// Heading on the screen; `None` for a column that appears only in JSON.
    pub head: Option<Cow<'static, str>>,
}

/// A rule that limits a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// Title of the rule.
    pub title: &'static str,
    /// Name of the limited quantity, with its unit as a suffix.
    pub name: &'static str,
    /// Symbol of the limited quantity.
    pub symbol: &'static str,
    /// Unit in which value and limit are displayed.
    pub unit: DisplayUnit,
    /// Value of the limited quantity.
    pub value: f64,
    /// Limit; `None` if there is no requirement.
    pub limit: Option<f64>,
    /// True if the limit is a minimum.
    pub at_least: bool,
    /// Source of the rule, with the equation tag of the theory.
    pub source: Cow<'static, str>,
    /// For a violated rule, the smallest change of one input that would satisfy the rule. For an
    /// undecided rule, the inputs that would decide the rule are added.
    pub remedy: Option<String>,
    /// 90 % interval of the value, if the value depends on an estimated groove.
    pub band: Option<Band>,
    /// 90 % interval of the margin, if the margin depends on an estimated groove.
    pub margins: Option<Band>,
    /// Margin of the rule if a default assumption that the user has not confirmed turns out to be
    /// wrong. An example of such a default is the assumption that the load is guided.
    pub margin_without_default: Option<f64>,
}

/// Verdict on a rule, or on all rules of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The rule is violated.
    Fails,
    /// The rule is undecided: either the groove is estimated and the limit lies within the 90 %
    /// interval of the value, or the rule is met only under a default assumption that may be wrong.
    Undecided,
    /// The rule is met, or the rule has no limit.
    Passes,
}

impl Verdict {
    /// Returns true if the rule is met, false if it is violated, and `None` if it is undecided.
    pub fn passes(self) -> Option<bool> {
        match self {
            Self::Fails => Some(false),
            Self::Undecided => None,
            Self::Passes => Some(true),
        }
    }

    /// Returns the verdict as a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fails => "fails",
            Self::Undecided => "undecided",
            Self::Passes => "passes",
        }
    }
}

impl Criterion {
    /// Returns the verdict on the rule.
    pub fn verdict(&self) -> Verdict {
        match (self.margins, self.margin_without_default) {
            (Some(Band { low, high }), _)
                if !Bounds::is_sufficient(low) && Bounds::is_sufficient(high) =>
            {
                Verdict::Undecided
            }
            _ if !self.bounds().are_met_by(self.value) => Verdict::Fails,
            (_, Some(margin)) if !Bounds::is_sufficient(margin) => Verdict::Undecided,
            _ => Verdict::Passes,
        }
    }

    /// Returns the limit of the rule as a lower or an upper bound.
    pub(crate) fn bounds(&self) -> Bounds {
        if self.at_least { Bounds::at_least(self.limit) } else { Bounds::at_most(self.limit) }
    }

    /// Returns true if the rule is met or there is no requirement.
    pub fn passes(&self) -> bool {
        self.verdict() == Verdict::Passes
    }

    /// Returns true if the rule is violated.
    pub fn fails(&self) -> bool {
        self.verdict() == Verdict::Fails
    }

    /// Returns the margin of the rule. The rule is met if the margin is at least 1.
    pub fn margin(&self) -> Option<f64> {
        self.bounds().margin(self.value)
    }

    /// Returns the margin of the rule, or the margin without a default assumption that the user has
    /// not confirmed if this margin is smaller.
    pub(crate) fn smallest_margin(&self) -> Option<f64> {
        let margin = self.margin()?;
        Some(self.margin_without_default.map_or(margin, |other| margin.min(other)))
    }

    fn sign(&self) -> &'static str {
        if self.at_least { ">=" } else { "<=" }
    }

    /// Returns the requirement as text, or `None` if there is no requirement.
    pub fn must_be(&self) -> Option<String> {
        limits_in_words(self.bounds())
    }

    /// Returns the rule as a row of the table of rules.
    fn row(&self) -> RuleRow {
        RuleRow {
            rule: self.title,
            name: self.name,
            symbol: self.symbol,
            unit: self.unit.text,
            value: self.value,
            must_be: self.sign(),
            limit: self.limit,
            margin: self.margin(),
            passes: self.verdict().passes(),
            source: self.source.clone(),
            remedy: self.remedy.clone(),
        }
    }
}

/// Returns limits as text, or `None` if there are none.
pub(crate) fn limits_in_words(Bounds { min, max }: Bounds) -> Option<String> {
    let min = min.map(|min| format!(">= {}", format_trimmed(min)));
    let max = max.map(|max| format!("<= {}", format_trimmed(max)));
    match (min, max) {
        (Some(min), Some(max)) => Some(format!("{min} and {max}")),
        (one, other) => one.or(other),
    }
}

row! {
    /// A rule in JSON.
    pub(crate) struct RuleRow {
        /// Title of the rule.
        rule: &'static str;
        /// Name of the number, with its unit as a suffix.
        name: &'static str;
        /// Symbol of the number.
        symbol: &'static str;
        /// Unit of the number.
        unit: &'static str;
        /// Value of the number; null if it cannot be calculated.
        #[schemars(with = "Option<f64>")]
        value: f64;
        /// `>=` or `<=`.
        must_be: &'static str;
        /// Lower or upper limit of the number, depending on `must_be`.
        limit: Option<f64>;
        /// Margin of the rule, which is met if the margin is at least 1.
        margin: Option<f64>;
        /// True if the rule is met, false if it is violated, null if it is undecided.
        passes: Option<bool>;
        /// Source of the rule.
        source: Cow<'static, str>;
        /// Change of an input that would satisfy the rule.
        remedy: Option<String>;
    }
}

row! {
    /// A missing input that was treated as zero.
    pub(crate) struct NotGivenRow {
        /// Name of the number that the missing input affects.
        number: &'static str;
        /// Sentence that names the missing input.
        text: String;
    }
}

impl Table {
    fn to_json(&self) -> Value {
        let named = |row: &[Value]| -> Value {
            let cells = self.columns.iter().zip(row).skip(usize::from(self.keyed));
            let cells = cells.filter(|(column, _)| !column.name.is_empty());
            cells
                .map(|(column, cell)| (column.name.clone().into_owned(), cell.clone()))
                .collect::<Map<_, _>>()
                .into()
        };
        if !self.keyed {
            return self.rows.iter().map(|row| named(row)).collect();
        }
        let key = |row: &Vec<Value>| row[0].as_str().unwrap_or_default().to_owned();
        self.rows.iter().map(|row| (key(row), named(row))).collect::<Map<_, _>>().into()
    }
}

/// Converts quantities to a JSON object. Missing values become null, and true-or-false statements
/// are omitted.
pub(crate) fn numbers_json(numbers: &Numbers) -> Map<String, Value> {
    let shown = numbers.all().iter().filter(|row| row.quantity.scope != Scope::Statement);
    let columns = shown.flat_map(|row| row.quantity.columns.iter().zip(row.values));
    columns
        .map(|(column, value)| {
            (column.name.to_owned(), json!(value.map(|value| column.json(value))))
        })
        .collect()
}

impl Content {
    /// Creates the content of a section from quantities and their values.
    pub fn numbers(numbers: Numbers, whole: &'static str) -> Self {
        Self::Numbers { numbers, whole, unbounded: Vec::new() }
    }

    fn to_json(&self) -> Value {
        match self {
            Self::Numbers { numbers, .. } => Value::Object(numbers_json(numbers)),
            Self::Table(table) => table.to_json(),
            Self::Text(_, words) => json!(words),
            Self::Texts(_, texts) => json!(texts),
            Self::Json(json) => json.clone(),
        }
    }
}

impl Answer {
    /// Adds a section with a JSON member name.
    #[must_use]
    pub fn with(mut self, member: &'static str, content: Content) -> Self {
        self.sections.push(Section { member: Some(member), content });
        self
    }

    /// Adds a section that is only shown on the screen.
    #[must_use]
    pub fn with_shown(mut self, content: Content) -> Self {
        self.sections.push(Section { member: None, content });
        self
    }

    /// Hides the section with the given member name on the screen, but keeps it in JSON.
    #[must_use]
    pub fn hiding(mut self, member: &str) -> Self {
        for section in self.sections.iter_mut().filter(|section| section.member == Some(member)) {
            section.content = Content::Json(section.content.to_json());
        }
        self
    }

    /// Returns the content of the section with the given member name.
    pub fn section(&self, member: &str) -> Option<&Content> {
        self.sections
            .iter()
            .find(|section| section.member == Some(member))
            .map(|section| &section.content)
    }

    /// Returns the sentences of the section with the given member name.
    pub fn texts(&self, member: &str) -> &[String] {
        match self.section(member) {
            Some(Content::Texts(_, texts)) => texts,
            _ => &[],
        }
    }

    /// Returns the quantities of all sections that have a JSON member name.
    pub fn numbers(&self) -> impl Iterator<Item = &Numbers> {
        self.sections.iter().filter_map(|section| match &section.content {
            Content::Numbers { numbers, .. } if section.member.is_some() => Some(numbers),
            _ => None,
        })
    }

    /// Returns the quantities of the last section that consists of quantities and is shown only on
    /// the screen.
    pub fn shown_numbers(&self) -> Option<&Numbers> {
        self.sections.iter().rev().find_map(|section| match &section.content {
            Content::Numbers { numbers, .. } if section.member.is_none() => Some(numbers),
            _ => None,
        })
    }

    /// Returns the quantities of the first section that consists of quantities.
    pub(crate) fn into_numbers(self) -> Numbers {
        let numbers = self.sections.into_iter().find_map(|section| match section.content {
            Content::Numbers { numbers, .. } => Some(numbers),
            _ => None,
        });
        numbers.unwrap_or_else(|| Numbers::none(&[]))
    }

    /// Returns all values, each with the output that defines its name and unit.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Output, f64)> {
        self.numbers().flat_map(Numbers::entries)
    }

    /// Returns the descriptions of the missing inputs that affect a result, joined into one line.
    pub fn lacks(&self, number: &str) -> Option<String> {
        let lacks = self.not_given.iter().filter(|lack| lack.number == number);
        let texts: Vec<_> = lacks.map(|lack| lack.text.as_str()).collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }

    /// Returns the descriptions of all missing inputs, without repetitions.
    pub fn all_not_given(&self) -> Vec<&str> {
        let mut texts: Vec<&str> = Vec::new();
        for lack in &self.not_given {
            if !texts.contains(&lack.text.as_str()) {
                texts.push(&lack.text);
            }
        }
        texts
    }

    /// Returns the overall verdict, which is the worst verdict on any of the rules.
    pub fn verdict(&self) -> Verdict {
        let of_rules = self.rules.iter().map(Criterion::verdict).min();
        let verdict = if self.fails { Verdict::Fails } else { Verdict::Passes };
        of_rules.unwrap_or(verdict).min(verdict)
    }

    /// Returns the value of the output with the given name, or `None` if it is missing.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.numbers().find_map(|numbers| numbers.number(name))
    }

    /// Converts the answer to a JSON object with its sections, rules, notes and warnings. If the
    /// whole answer is a single table, only this table is returned.
    pub fn to_json(&self) -> Value {
        let mut map = Map::new();
        for Section { member, content } in &self.sections {
            match (member, content.to_json()) {
                (None, _) => {}
                (Some(""), Value::Object(entries)) => map.extend(entries),
                (Some(""), list) => return list,
                (Some(member), json) => drop(map.insert((*member).to_owned(), json)),
            }
        }
        if !self.rules.is_empty() {
            let rules: Vec<_> = self.rules.iter().map(Criterion::row).collect();
            map.insert("rules".to_owned(), Table::of(&rules).to_json());
        }
        if !self.not_given.is_empty() {
            let row = |MissingInput { number, text }: &MissingInput| NotGivenRow {
                number,
                text: text.clone(),
            };
            let lacks: Vec<_> = self.not_given.iter().map(row).collect();
            map.insert("not_given".to_owned(), Table::of(&lacks).to_json());
        }
        map.insert("notes".to_owned(), json!(self.notes));
        map.insert("warnings".to_owned(), json!(self.warnings));
        Value::Object(map)
    }
}
