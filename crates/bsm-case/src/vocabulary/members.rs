//! Typed members of answers. The JSON of an answer, its schema and its text on the screen are
//! generated from the same structs.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::marker::PhantomData;

use bsm_design::statistics::Band;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::answer::{Answer, Column, Content, Section, Table, numbers_json};
use crate::{Numbers, Output, Quantity, Scope};

/// Members of the JSON object of an answer. The macro [`answer!`] implements this trait.
pub(crate) trait Members: JsonSchema {
    /// Returns the sections of the answer in the order of the members.
    fn sections(self) -> Vec<Section>;
}

/// A member of an answer.
pub(crate) trait Member: JsonSchema {
    /// Returns the content of the section, or `None` if the member is omitted.
    fn content(self) -> Option<Content>;
}

/// A row of a table. The macro [`row!`] implements this trait.
pub(crate) trait TableRow: JsonSchema {
    /// Returns the columns of the cells.
    fn columns() -> Vec<Column>;

    /// Returns the cells in the order of the columns.
    fn cells(&self) -> Vec<Value>;

    /// Returns the unit of the numbers in the row, or `None` if the columns have units.
    fn unit(&self) -> Option<&'static str> {
        None
    }

    /// Returns the 90 % intervals that are shown on the screen next to the cells.
    fn bands(&self) -> Vec<Option<Band>> {
        vec![None; Self::columns().len()]
    }
}

/// Declares the members of an answer: `name: Type;`. A member with `[skip]` is only shown on the
/// screen. The members of a type with `[flatten]` become members of the answer itself. A member
/// with `[skip_serializing_if = "Maybe::is_none"]` can be absent.
macro_rules! answer {
    ($(#[$meta:meta])* $visible:vis struct $name:ident $(<$numbers:ident>)? {
        $($(#[$doc:meta])* $([$flag:ident $(= $condition:literal)?])? $field:ident: $kind:ty;)*
    }) => {
        $(#[$meta])*
        #[derive(schemars::JsonSchema)]
        $visible struct $name $(<$numbers: $crate::vocabulary::members::NumberTable>)? {
            $($(#[$doc])* $(#[schemars($flag $(= $condition)?)])? $visible $field: $kind,)*
        }

        impl $(<$numbers: $crate::vocabulary::members::NumberTable>)?
            $crate::vocabulary::members::Members for $name $(<$numbers>)?
        {
            fn sections(self) -> Vec<$crate::Section> {
                let sections = [$(
                    $crate::vocabulary::members::Member::content(self.$field).map(|content| {
                        let member = $crate::vocabulary::members::answer!(@member $field $($flag)?);
                        $crate::Section { member, content }
                    }),
                )*];
                sections.into_iter().flatten().collect()
            }
        }
    };
    (@member $field:ident skip) => { None };
    (@member $field:ident flatten) => { Some("") };
    (@member $field:ident $($flag:ident)?) => { Some(stringify!($field)) };
}

/// Declares a row of a table: `name: Type as "name in JSON" = "heading" | interval;`.
///
/// A cell without a heading appears only in JSON, and a cell with `[skip]` appears only on the
/// screen. `[flatten]` inserts the cells of another type. `interval` is the name of a cell with the
/// ends of the 90 % interval that the screen shows next to the number. `unit name` after the struct
/// states which cell contains the unit of the row.
macro_rules! row {
    ($(#[$meta:meta])* $visible:vis struct $name:ident {
        $($(#[$doc:meta])* $([$flag:ident])? $field:ident: $kind:ty $(as $json:literal)?
            $(= $head:literal)? $(| $interval:ident)?;)*
    } $(unit $unit:ident)?) => {
        $(#[$meta])*
        #[derive(Debug, Clone, schemars::JsonSchema)]
        $visible struct $name {
            $(
                $(#[$doc])* $(#[schemars($flag)])? $(#[schemars(rename = $json)])?
                $visible $field: $kind,
            )*
        }

        impl $crate::vocabulary::members::TableRow for $name {
            fn columns() -> Vec<$crate::Column> {
                [$($crate::vocabulary::members::row!(
                    @columns $($flag)? ($field $kind) [$($json)?] [$($head)?]
                ),)*].concat()
            }

            fn cells(&self) -> Vec<serde_json::Value> {
                [$($crate::vocabulary::members::row!(@cells self $field $($flag)?),)*].concat()
            }

            $(fn unit(&self) -> Option<&'static str> {
                Some(self.$unit)
            })?

            fn bands(&self) -> Vec<Option<bsm_design::statistics::Band>> {
                [$($crate::vocabulary::members::row!(
                    @bands self $field $($flag)? [$($interval)?]
                ),)*].concat()
            }
        }
    };
    (@columns flatten ($field:ident $kind:ty) [] []) => {
        <$kind as $crate::vocabulary::members::TableRow>::columns()
    };
    (@columns skip ($field:ident $kind:ty) [] [$head:literal]) => {
        vec![$crate::Column::new("", Some($head))]
    };
    (@columns skip ($field:ident $kind:ty) [] []) => {
        vec![$crate::Column::new("", None)]
    };
    (@columns ($field:ident $kind:ty) [] [$($head:literal)?]) => {
        $crate::vocabulary::members::row!(@columns ($field $kind) [stringify!($field)] [$($head)?])
    };
    (@columns ($field:ident $kind:ty) [$json:expr] [$head:literal]) => {
        vec![$crate::Column::new($json, Some($head))]
    };
    (@columns ($field:ident $kind:ty) [$json:expr] []) => {
        vec![$crate::Column::new($json, None)]
    };
    (@cells $self:ident $field:ident flatten) => {
        $crate::vocabulary::members::TableRow::cells(&$self.$field)
    };
    (@cells $self:ident $field:ident $($flag:ident)?) => { vec![serde_json::json!($self.$field)] };
    (@bands $self:ident $field:ident flatten []) => {
        $crate::vocabulary::members::TableRow::bands(&$self.$field)
    };
    (@bands $self:ident $field:ident $($flag:ident)? []) => { vec![None] };
    (@bands $self:ident $field:ident [$interval:ident]) => {
        vec![$self.$interval.map(|[low, high]: [f64; 2]| bsm_design::statistics::Band { low, high })]
    };
}

pub(crate) use {answer, row};

/// A text with a label.
pub(crate) struct Word(pub(crate) &'static str, pub(crate) String);

/// A text with a label; null in JSON and absent on the screen if there is no text.
pub(crate) struct Label(pub(crate) &'static str, pub(crate) Option<String>);

/// Sentences with a label.
pub(crate) struct Sentences(pub(crate) &'static str, pub(crate) Vec<String>);

/// A value that is not shown on the screen.
pub(crate) struct Data<T>(pub(crate) T);

/// A member that can be absent.
pub(crate) struct Maybe<T>(pub(crate) Option<T>);

/// Numbers of a table of quantities. The text is the heading of the numbers that apply neither to a
/// single contact nor to a single direction.
pub(crate) struct NumbersOf<T>(Numbers, &'static str, PhantomData<T>);

/// A table whose JSON form is a list of objects.
pub(crate) struct Rows<R>(pub(crate) Vec<R>);

/// A table whose JSON form is an object of objects. The first cell of a row is the key.
pub(crate) struct Keyed<R>(pub(crate) Vec<R>);

/// A table of quantities whose numbers are members of an answer or cells of a row.
pub(crate) trait NumberTable: JsonSchema {
    /// Returns the quantities of the table.
    fn quantities() -> impl Iterator<Item = &'static Quantity>;

    /// Returns true if the screen shows the number with the given name as a column.
    fn is_shown(_name: &str) -> bool {
        true
    }

    /// Returns the columns of the quantities that are numbers in JSON.
    fn columns() -> impl Iterator<Item = &'static Output> {
        let numbers = Self::quantities().filter(|quantity| quantity.scope != Scope::Statement);
        numbers.flat_map(|quantity| quantity.columns)
    }
}

/// Declares types for tables of quantities: `Type = quantities;`. If only some of the numbers are
/// shown as columns on the screen, the names of these numbers follow `shown`.
macro_rules! number_tables {
    ($($(#[$doc:meta])* $visible:vis $name:ident = $quantities:expr $(, shown $shown:expr)?;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone)]
        $visible enum $name {}

        impl $crate::vocabulary::members::NumberTable for $name {
            fn quantities() -> impl Iterator<Item = &'static $crate::Quantity> {
                $quantities
            }

            $(fn is_shown(name: &str) -> bool {
                $shown.contains(&name)
            })?
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $crate::vocabulary::members::object_of::<Self>()
            }
        }
    )*};
}

pub(crate) use number_tables;

/// Implements serialization and the schema for a pair of a name and a number, which becomes a JSON
/// object with one member. The names and meanings of all possible members follow the keyword `of`.
macro_rules! one_member {
    ($($name:ident of $members:expr;)*) => {$(
        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_map([(self.0, self.1)])
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $crate::vocabulary::members::optional_numbers($members)
            }
        }
    )*};
}

pub(crate) use one_member;

/// Cells of a row that contain the numbers of a table of quantities.
#[derive(Debug, Clone)]
pub(crate) struct NumberCells<T>(Vec<Option<f64>>, PhantomData<T>);

/// Numbers of a table of quantities in JSON.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub(crate) struct NumbersJson<T>(Map<String, Value>, #[serde(skip)] PhantomData<T>);

/// A JSON object with arbitrary names, which keep the given order.
#[derive(Debug, Clone)]
pub(crate) struct ByName<T>(pub(crate) Vec<(String, T)>);

impl<T> NumbersOf<T> {
    pub(crate) fn new(numbers: Numbers, whole: &'static str) -> Self {
        Self(numbers, whole, PhantomData)
    }
}

impl<T> NumbersJson<T> {
    pub(crate) fn of(numbers: &Numbers) -> Self {
        Self(numbers_json(numbers), PhantomData)
    }
}

impl<T> NumberCells<T> {
    pub(crate) fn of(numbers: &Numbers) -> Self {
        let rows = numbers.all().iter().filter(|row| row.quantity.scope != Scope::Statement);
        let cells = rows.flat_map(|row| row.values.into_iter().take(row.quantity.columns.len()));
        Self(cells.collect(), PhantomData)
    }
}

impl Column {
    /// Creates a column without a unit.
    ///
    /// * `name`: name in JSON; empty for a column that is only shown on the screen.
    /// * `head`: heading on the screen; `None` for a column that appears only in JSON.
    pub(crate) fn new(name: &'static str, head: Option<&'static str>) -> Self {
        Self { name: name.into(), unit: "", head: head.map(Cow::from) }
    }
}

impl Table {
    /// Creates the table of rows that are declared with [`row!`].
    pub(crate) fn of<R: TableRow>(rows: &[R]) -> Self {
        let bands: Vec<_> = rows.iter().map(R::bands).collect();
        let has_bands = bands.iter().flatten().any(Option::is_some);
        Self {
            columns: R::columns(),
            rows: rows.iter().map(R::cells).collect(),
            bands: if has_bands { bands } else { Vec::new() },
            row_units: rows.iter().filter_map(R::unit).collect(),
            keyed: false,
        }
    }
}

impl Answer {
    /// Appends the sections of the members.
    #[must_use]
    pub(crate) fn with_members(mut self, members: impl Members) -> Self {
        self.sections.extend(members.sections());
        self
    }
}

/// Returns the name and the schema of an output.
pub(crate) fn property(output: &Output) -> (String, Value) {
    let mut property = json!({
        "type": [output.output_type.name(), "null"],
        "description": with_unit(output.about, output.unit),
    });
    if !output.words.is_empty() {
        let words = output.words.iter().map(|word| json!(word));
        property["enum"] = words.chain([Value::Null]).collect();
    }
    (output.name.to_owned(), property)
}

/// Returns the meaning of a quantity with its unit.
pub(crate) fn with_unit(about: &str, unit: &str) -> String {
    if unit.is_empty() { about.to_owned() } else { format!("{about} [{unit}]") }
}

/// Returns the schema of an object with the numbers of a table, all of which are required.
pub(crate) fn object_of<T: NumberTable>() -> Schema {
    let properties: Map<_, _> = T::columns().map(property).collect();
    let required: Vec<_> = properties.keys().cloned().collect();
    json_schema!({ "type": "object", "properties": properties, "required": required })
}

/// Returns the schema of an object with numbers, each of which can be absent or null.
///
/// * `members`: names and meanings.
pub(crate) fn optional_numbers(members: impl Iterator<Item = (&'static str, String)>) -> Schema {
    let number = |about: String| json!({ "type": ["number", "null"], "description": about });
    let properties: Map<_, _> =
        members.map(|(name, about)| (name.to_owned(), number(about))).collect();
    json_schema!({ "type": "object", "properties": properties })
}

/// Implements `JsonSchema` for a type by reusing the schema of another type.
macro_rules! same_schema {
    ($($of:ident $(<$of_one:ident>)? as $other:ty;)*) => {$(
        impl $(<$of_one: JsonSchema>)? JsonSchema for $of $(<$of_one>)? {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                <$other>::schema_name()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                <$other>::json_schema(generator)
            }
        }
    )*};
}

same_schema! {
    Word as String;
    Label as Option<String>;
    Sentences as Vec<String>;
    Data<T> as T;
    Maybe<T> as T;
    Rows<T> as Vec<T>;
    Keyed<T> as BTreeMap<String, T>;
    ByName<T> as BTreeMap<String, T>;
    NumbersOf<T> as T;
    NumberCells<T> as T;
    NumbersJson<T> as T;
}

impl<T: NumberTable> TableRow for NumberCells<T> {
    fn columns() -> Vec<Column> {
        let column = |output: &Output| Column {
            unit: output.unit,
            ..Column::new(output.name, T::is_shown(output.name).then_some(output.name))
        };
        T::columns().map(column).collect()
    }

    fn cells(&self) -> Vec<Value> {
        self.0.iter().map(|value| json!(value)).collect()
    }
}

impl<T: Serialize> Serialize for ByName<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl Member for Word {
    fn content(self) -> Option<Content> {
        Some(Content::Text(self.0, Some(self.1)))
    }
}

impl Member for Label {
    fn content(self) -> Option<Content> {
        Some(Content::Text(self.0, self.1))
    }
}

impl Member for Sentences {
    fn content(self) -> Option<Content> {
        Some(Content::Texts(self.0, self.1))
    }
}

impl<T: Serialize + JsonSchema> Member for Data<T> {
    fn content(self) -> Option<Content> {
        Some(Content::Json(json!(self.0)))
    }
}

impl<T: Member> Member for Maybe<T> {
    fn content(self) -> Option<Content> {
        self.0?.content()
    }
}

impl<T: NumberTable> Member for NumbersOf<T> {
    fn content(self) -> Option<Content> {
        Some(Content::numbers(self.0, self.1))
    }
}

impl<R: TableRow> Member for Rows<R> {
    fn content(self) -> Option<Content> {
        Some(Content::Table(Table::of(&self.0)))
    }
}

impl<R: TableRow> Member for Keyed<R> {
    fn content(self) -> Option<Content> {
        Some(Content::Table(Table { keyed: true, ..Table::of(&self.0) }))
    }
}
