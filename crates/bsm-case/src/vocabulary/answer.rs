//! What is answered: sections of numbers, tables and texts, rules with limit, margin and source, notes and warnings. Text,
//! JSON and pages of every answer are made of them.

use std::borrow::Cow;

use bsm_design::Band;
use serde_json::{Map, Value, json};

use crate::{Numbers, Output, Scope, trimmed};

/// An answer.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// In the order in which people read them.
    pub sections: Vec<Section>,
    /// Rules for the numbers.
    pub rules: Vec<Criterion>,
    /// Defaults that were used, and effects that are neglected.
    pub notes: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Inputs that are not given and count as zero, or as none, in a number.
    pub not_given: Vec<NotGiven>,
    /// True if there is no solution, nothing was found or a rule is broken.
    pub fails: bool,
}

/// What is not given and counts as zero in a number, so that the number lacks it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotGiven {
    /// Name of the number.
    pub number: &'static str,
    /// What is not given, and how it counts.
    pub text: String,
}

/// A part of an answer.
#[derive(Debug, Clone)]
pub struct Section {
    /// Its member of the JSON object, into which the numbers of an empty one go; a section without one is for people alone.
    pub member: Option<&'static str>,
    /// Its content.
    pub content: Content,
}

/// Content of a section.
#[derive(Debug, Clone)]
pub enum Content {
    /// Numbers of a table of quantities.
    Numbers {
        /// The numbers.
        numbers: Numbers,
        /// Head of numbers of no contact and no direction.
        whole: &'static str,
        /// Names of those whose error has no bound.
        unbounded: Vec<&'static str>,
    },
    /// Rows of numbers and texts.
    Table(Table),
    /// A short text behind a label, if any.
    Text(&'static str, Option<String>),
    /// Sentences behind a label.
    Texts(&'static str, Vec<String>),
    /// For programs alone.
    Json(Value),
}

/// A table whose rows are objects.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// Their cells, row by row.
    pub rows: Vec<Vec<Value>>,
    /// 90 % intervals of cells that depend on an estimated groove, row by row; empty without any.
    pub bands: Vec<Vec<Option<Band>>>,
    /// True if the first column has the names of the rows in an object of objects; false for a list of objects.
    pub keyed: bool,
}

/// A column of a table.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Its name in JSON; one with an empty name is for people alone.
    pub name: &'static str,
    /// What its cells are, as the schema of answers names it; a number unless said.
    pub kind: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its head for people; one without is for programs alone.
    pub head: Option<&'static str>,
}

impl Column {
    /// A column `name`, `name=head`, `=head` for people alone, or `-name` for programs alone; `name:kind` in place of `name`
    /// if its cells are no numbers.
    pub(crate) fn of(text: &'static str) -> Self {
        let (shown, head) = text.split_once('=').map_or((text, None), |(a, b)| (a, Some(b)));
        let (name, kind) = shown.split_once(':').unwrap_or((shown, "number"));
        match name.strip_prefix('-') {
            Some(name) => Self { name, kind, unit: "", head: None },
            None => Self { name, kind, unit: "", head: head.or(Some(name)) },
        }
    }

    /// Columns of such texts, which bars separate.
    pub fn all_of(text: &'static str) -> impl Iterator<Item = Self> {
        text.split('|').map(|column| Self::of(column.trim()))
    }
}

/// A rule for a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// Label.
    pub title: &'static str,
    /// Name of the number, with its unit as suffix.
    pub name: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Unit as text.
    pub unit: &'static str,
    /// The number.
    pub value: f64,
    /// Its limit; `None` if nothing is required.
    pub limit: Option<f64>,
    /// True if the limit is the least value.
    pub at_least: bool,
    /// Whose rule it is, with the tag of the theory.
    pub source: Cow<'static, str>,
    /// The smallest change of one input that would keep it, if it fails.
    pub remedy: Option<String>,
    /// 90 % interval of the number, if it depends on an estimated groove.
    pub band: Option<Band>,
}

impl Criterion {
    /// True if it holds, or nothing is required.
    pub fn passes(&self) -> bool {
        // Inputs are decimals, which a limit may meet but for rounding.
        self.margin().is_none_or(|margin| margin >= 1.0 - 1e-9)
    }

    /// How many times the rule is kept: above 1 it holds.
    pub fn margin(&self) -> Option<f64> {
        let limit = self.limit?;
        Some(if self.at_least { self.value / limit } else { limit / self.value })
    }

    fn sign(&self) -> &'static str {
        if self.at_least { ">=" } else { "<=" }
    }

    /// What the number must be, as text; `None` if nothing is required.
    pub fn must_be(&self) -> Option<String> {
        Some(format!("{} {}", self.sign(), trimmed(self.limit?)))
    }

    /// Its cells under [`RULES`].
    fn cells(&self) -> Vec<Value> {
        vec![
            json!(self.title),
            json!(self.name),
            json!(self.symbol),
            json!(self.unit),
            json!(self.value),
            json!(self.sign()),
            json!(self.limit),
            json!(self.margin()),
            json!(self.passes()),
            json!(self.source),
            json!(self.remedy),
        ]
    }
}

/// Columns of rules.
pub(crate) const RULES: &str = "rule:string | name:string | symbol:string | unit:string | value:number? | must_be:string | limit:number? | margin:number? | passes:boolean | source:string | remedy:string?";

/// Columns of what is not given.
pub(crate) const NOT_GIVEN: &str = "number:string | text:string";

impl Table {
    /// Rows under columns, see [`Column::all_of`].
    pub(crate) fn of(columns: &'static str, rows: impl IntoIterator<Item = Vec<Value>>) -> Self {
        let (columns, rows) = (Column::all_of(columns).collect(), rows.into_iter().collect());
        Self { columns, rows, ..Self::default() }
    }

    /// The same as an object of objects by the first column.
    #[must_use]
    pub(crate) fn keyed(self) -> Self {
        Self { keyed: true, ..self }
    }

    fn to_json(&self) -> Value {
        let named = |row: &[Value]| -> Value {
            let cells = self.columns.iter().zip(row).skip(usize::from(self.keyed));
            let cells = cells.filter(|(column, _)| !column.name.is_empty());
            cells
                .map(|(column, cell)| (column.name.to_owned(), cell.clone()))
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

/// JSON object of numbers; null where there is none. Statements stand with their texts.
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
    /// Numbers of a table.
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
    /// Adds a section.
    #[must_use]
    pub fn with(mut self, member: &'static str, content: Content) -> Self {
        self.sections.push(Section { member: Some(member), content });
        self
    }

    /// Adds a section if it is there.
    #[must_use]
    pub(crate) fn with_some(self, member: &'static str, content: Option<Content>) -> Self {
        match content {
            Some(content) => self.with(member, content),
            None => self,
        }
    }

    /// Adds a section for people alone.
    #[must_use]
    pub fn with_shown(mut self, content: Content) -> Self {
        self.sections.push(Section { member: None, content });
        self
    }

    /// Keeps a section for programs alone.
    #[must_use]
    pub fn hiding(mut self, member: &str) -> Self {
        for section in self.sections.iter_mut().filter(|section| section.member == Some(member)) {
            section.content = Content::Json(section.content.to_json());
        }
        self
    }

    /// A section by its member.
    pub fn section(&self, member: &str) -> Option<&Content> {
        self.sections
            .iter()
            .find(|section| section.member == Some(member))
            .map(|section| &section.content)
    }

    /// The sentences of a section.
    pub fn texts(&self, member: &str) -> &[String] {
        match self.section(member) {
            Some(Content::Texts(_, texts)) => texts,
            _ => &[],
        }
    }

    /// Its numbers, section by section.
    pub fn numbers(&self) -> impl Iterator<Item = &Numbers> {
        self.sections.iter().filter_map(|section| match &section.content {
            Content::Numbers { numbers, .. } if section.member.is_some() => Some(numbers),
            _ => None,
        })
    }

    /// Returns the numbers of the last section for people alone that has some.
    pub fn shown_numbers(&self) -> Option<&Numbers> {
        self.sections.iter().rev().find_map(|section| match &section.content {
            Content::Numbers { numbers, .. } if section.member.is_none() => Some(numbers),
            _ => None,
        })
    }

    /// The numbers of its first section that has some.
    pub(crate) fn into_numbers(self) -> Numbers {
        let numbers = self.sections.into_iter().find_map(|section| match section.content {
            Content::Numbers { numbers, .. } => Some(numbers),
            _ => None,
        });
        numbers.unwrap_or_else(|| Numbers::none(&[]))
    }

    /// Its numbers with names and units.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Output, f64)> {
        self.numbers().flat_map(Numbers::entries)
    }

    /// Returns what a number lacks because it is not given, in one line.
    pub fn lacks(&self, number: &str) -> Option<String> {
        let lacks = self.not_given.iter().filter(|lack| lack.number == number);
        let texts: Vec<_> = lacks.map(|lack| lack.text.as_str()).collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }

    /// Returns what is not given, each once, in the order of the numbers.
    pub fn all_not_given(&self) -> Vec<&str> {
        let mut texts: Vec<&str> = Vec::new();
        for lack in &self.not_given {
            if !texts.contains(&lack.text.as_str()) {
                texts.push(&lack.text);
            }
        }
        texts
    }

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers().find_map(|numbers| numbers.number(name))
    }

    /// JSON of its sections by their members, with rules, notes and warnings; of a table that is the whole answer, the table.
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
            let rules = Table::of(RULES, self.rules.iter().map(Criterion::cells));
            map.insert("rules".to_owned(), rules.to_json());
        }
        if !self.not_given.is_empty() {
            let cells = |lack: &NotGiven| vec![json!(lack.number), json!(lack.text)];
            let lacks = Table::of(NOT_GIVEN, self.not_given.iter().map(cells));
            map.insert("not_given".to_owned(), lacks.to_json());
        }
        map.insert("notes".to_owned(), json!(self.notes));
        map.insert("warnings".to_owned(), json!(self.warnings));
        Value::Object(map)
    }
}
