//! Columns of input tables and of results tables.

use std::collections::HashMap;
use std::iter::repeat;
use std::sync::Arc;

use arrow_array::Float64Array;
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use bsm_case::units::UnitChange;
use bsm_case::{DisplayUnit, DisplayUnits, InputKey, InputSet, Output, brief, nearest_input};

use crate::error::UnknownName;
use crate::{AnswerSink, Answers, Chunk, TableError, TableFormat};

/// Columns of status information that precede the outputs in a results table.
pub(crate) const ANSWERS: [&str; 3] = ["model", "status", "message"];

/// Key of the unit in the column metadata.
pub(crate) const UNIT: &str = "unit";

/// Returns true for the name of a results column.
pub(crate) fn is_answer(name: &str) -> bool {
    ANSWERS.contains(&name) || Output::named(name).is_some()
}

/// Columns of a table of operating points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Inputs, in the order of the table columns.
    pub inputs: Vec<InputKey>,
    /// Indices of the input columns in the table.
    pub(crate) input_places: Vec<usize>,
    /// For each input, the column name in the table and the conversion from the unit of the table
    /// to the unit of the input.
    pub(crate) units: Vec<(String, UnitChange)>,
    /// Names of the columns that are copied to the results.
    pub kept: Vec<String>,
    pub(crate) kept_places: Vec<usize>,
    /// Arrow types of the copied columns.
    pub(crate) kept_types: Vec<DataType>,
    /// Names of the ignored columns.
    pub(crate) unread: Vec<String>,
    /// Names of columns that are ignored because they have the name of a result.
    results: Vec<String>,
}

/// Header of a column in a results table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heading<'a> {
    /// Column name.
    pub name: &'a str,
    /// JSON type of the values.
    pub json_type: &'static str,
    /// Unit as text; empty for a column without a unit.
    pub unit: &'static str,
    /// Description of the column.
    pub about: &'static str,
}

impl Columns {
    /// Divides the column names of a table into inputs and columns to copy. Columns with results of
    /// an earlier run are ignored.
    ///
    /// * `keep`: names of the columns to copy.
    /// * `table_format`: assignment of column names to inputs, if the table uses other names.
    ///
    /// # Errors
    ///
    /// [`TableError`] if a name is neither an input nor in `keep`, if a name appears twice, if a
    /// copied column has the name of a results column, or if a name in `keep` is missing from the
    /// table.
    pub fn sort<'a>(
        names: impl IntoIterator<Item = &'a str>,
        keep: &[String],
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let missing = |name: &str, to: &str| {
            let message = format!("the table has no column `{}` to {to}", brief(name));
            TableError::Column { name: name.to_owned(), message }
        };
        let mut renamed: Vec<_> = table_format.names.keys().collect();
        if let Some(name) = keep.iter().find(|name| is_answer(name)) {
            let what = "cannot be kept, because the results have a column with this name; rename your column";
            let message = format!("column `{}` {what}", brief(name));
            return Err(TableError::Column { name: name.clone(), message });
        }
        let mut columns = Self::default();
        let (mut answers, mut unknown) = (ANSWERS.to_vec(), Vec::new());
        for (index, own) in names.into_iter().enumerate() {
            let own = own.trim();
            renamed.retain(|name| *name != own);
            let is_kept = keep.iter().any(|kept| kept == own);
            let Some(name) = (if is_kept { Some(own) } else { table_format.name(own) }) else {
                columns.unread.push(own.to_owned());
                continue;
            };
            let repeated = |former: &str| Err(TableError::repeated(former, own));
            answers.retain(|answer| *answer != name);
            if columns.kept.iter().any(|k| k == name) {
                return repeated(own);
            }
            if is_kept {
                columns.kept.push(name.to_owned());
                columns.kept_places.push(index);
                columns.kept_types.push(DataType::Utf8);
            } else if ANSWERS.contains(&name) || answers.is_empty() && is_answer(name) {
                // Some outputs have the same name as an input. In a table with earlier results, the
                // input columns come first.
                columns.unread.push(own.to_owned());
                columns.results.push(own.to_owned());
            } else if unknown.iter().any(|other: &UnknownName| other.name == name) {
                // This unknown name has already been reported.
            } else if let Ok((key, change)) = InputKey::in_unit(name) {
                if let Some(former) = columns.inputs.iter().position(|input| *input == key) {
                    return repeated(&columns.units[former].0);
                }
                columns.inputs.push(key);
                columns.input_places.push(index);
                columns.units.push((own.to_owned(), change));
            } else if is_answer(name) {
                columns.results.push(own.to_owned());
            } else {
                let nearest = nearest_input(name).filter(|nearest| *nearest != name);
                unknown.push(UnknownName { name: name.to_owned(), nearest });
                if unknown.len() == UnknownName::NAMED {
                    break;
                }
            }
        }
        if !unknown.is_empty() {
            return Err(TableError::UnknownColumns { names: unknown });
        }
        match (keep.iter().find(|name| !columns.kept.contains(name)), renamed.first()) {
            (Some(name), _) => Err(missing(name, "keep")),
            (None, Some(name)) => Err(missing(name, "rename")),
            (None, None) => Ok(columns),
        }
    }

    /// Returns the columns of a table that contains only inputs, in their own units.
    pub(crate) fn of_inputs(inputs: Vec<InputKey>) -> Self {
        Self { input_places: (0..inputs.len()).collect(), inputs, ..Self::default() }
    }

    /// Sets the types of the copied columns. The default type is text.
    #[must_use]
    pub fn with_kept_types(self, types: Vec<DataType>) -> Self {
        Self { kept_types: types, ..self }
    }

    /// Returns the column headers of a results table, in order.
    pub fn headings<'a>(
        &'a self,
        outputs: &'a [&'static Output],
    ) -> impl Iterator<Item = Heading<'a>> {
        let text = |name, about| Heading { name, json_type: "string", unit: "", about };
        let kept = self.kept.iter().map(move |name| text(name, "copied from the table of points"));
        let inputs = self.inputs.iter().map(|key| {
            let input = key.input();
            Heading { name: input.name, json_type: "number", unit: input.unit, about: input.about }
        });
        let [model, status, message] = ANSWERS;
        let answers = [
            text(model, "model that calculated the result"),
            text(status, "status of the solution"),
            text(message, "reason why the row has no result, or why model auto chose its model"),
        ];
        let outputs = outputs.iter().map(|output| {
            let Output { name, json_type, unit, about, .. } = **output;
            Heading { name, json_type, unit, about }
        });
        kept.chain(inputs).chain(answers).chain(outputs)
    }

    /// Returns the values of an input in its own unit. The values are copied only if the table uses
    /// another unit.
    pub fn in_unit(&self, index: usize, values: Float64Array) -> Float64Array {
        match self.change(index) {
            UnitChange::NONE => values,
            change => values.unary(|value| change.value(value)),
        }
    }

    /// Returns the conversion from the unit of the table to the unit of the input. The conversion
    /// is the identity for a grid.
    pub(crate) fn change(&self, index: usize) -> UnitChange {
        self.units.get(index).map_or(UnitChange::NONE, |(_, change)| *change)
    }

    /// Returns the Arrow schema of a results table. The column metadata contain the units.
    pub fn schema(&self, outputs: &[&'static Output]) -> SchemaRef {
        let kept = self.kept_types.iter().map(Some).chain(repeat(None));
        let fields = self.headings(outputs).zip(kept).map(|(heading, kept)| match kept {
            Some(kind) => Field::new(heading.name, kind.clone(), true),
            None if ANSWERS.contains(&heading.name) => {
                Field::new(heading.name, DataType::Utf8, heading.name == "message")
            }
            None => field(heading.name, heading.unit).with_data_type(match heading.json_type {
                "integer" => DataType::UInt64,
                "boolean" => DataType::Boolean,
                "string" => DataType::Utf8,
                _ => DataType::Float64,
            }),
        });
        Arc::new(Schema::new(fields.collect::<Vec<_>>()))
    }

    /// Returns the indices of the input columns in the table.
    pub fn input_places(&self) -> &[usize] {
        &self.input_places
    }

    /// Returns a note on the columns that are ignored because they have the name of a result.
    pub fn ignored_note(&self) -> Option<String> {
        /// Maximum number of names in the note.
        const NAMED: usize = 4;
        let mut names: Vec<_> = self.results.iter().take(NAMED).map(|name| brief(name)).collect();
        let more = self.results.len().saturating_sub(NAMED);
        if more > 0 {
            names.push(format!("{more} more"));
        }
        let names = names.join(", ");
        (!names.is_empty()).then(|| {
            format!(
                "The table has columns of results, which are not inputs and are therefore ignored: {names}."
            )
        })
    }

    /// Returns the input columns as a set.
    pub fn set(&self) -> InputSet {
        self.inputs.iter().copied().collect()
    }
}

/// Units in which the columns of a table of results are displayed.
#[derive(Debug, Clone, Default)]
pub struct ColumnUnits {
    display: DisplayUnits,
    /// Names and units of outputs that were selected in another unit.
    selected: Vec<(&'static str, String, DisplayUnit)>,
}

impl ColumnUnits {
    /// Returns the units of a table.
    ///
    /// * `columns`: names of selected outputs. A name in a unit that is not a unit of the vocabulary determines the unit of its column.
    pub fn new(display: DisplayUnits, columns: Option<&[String]>) -> Self {
        let in_other_unit = |name: &String| {
            let (output, unit) = Output::in_unit(name)?;
            (output.name != name).then(|| (output.name, name.clone(), unit))
        };
        let names = columns.unwrap_or_default().iter();
        Self { display, selected: names.filter_map(in_other_unit).collect() }
    }

    /// Returns true if all columns have the units of the vocabulary.
    pub fn are_own(&self) -> bool {
        self.display == DisplayUnits::Metric && self.selected.is_empty()
    }

    /// Returns the displayed unit of an input.
    pub fn of_input(&self, key: InputKey) -> DisplayUnit {
        self.display.of(key.input().unit)
    }

    /// Returns the displayed name and unit of an output.
    pub fn of_output(&self, output: &Output) -> (String, DisplayUnit) {
        if let Some((_, name, unit)) = self.selected.iter().find(|(own, ..)| *own == output.name) {
            return (name.clone(), *unit);
        }
        let unit = self.display.of(output.unit);
        (unit.name(output.name), unit)
    }

    /// Returns the columns of a table of results, with displayed names and units.
    pub fn schema(&self, columns: &Columns, outputs: &[&'static Output]) -> SchemaRef {
        let own = columns.schema(outputs);
        let first_input = columns.kept.len();
        let first_output = first_input + columns.inputs.len() + ANSWERS.len();
        let shown = |(place, own): (usize, &Arc<Field>)| {
            let (name, unit) = if let Some(place) = place.checked_sub(first_output) {
                self.of_output(outputs[place])
            } else if let Some(key) =
                place.checked_sub(first_input).and_then(|place| columns.inputs.get(place))
            {
                let unit = self.of_input(*key);
                (unit.name(key.name()), unit)
            } else {
                return Field::clone(own);
            };
            field(&name, unit.text).with_data_type(own.data_type().clone())
        };
        Arc::new(Schema::new(own.fields().iter().enumerate().map(shown).collect::<Vec<_>>()))
    }

    /// Returns a sink that converts rows to displayed units before it writes them to `sink`.
    pub fn converting<S>(
        &self,
        sink: S,
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> ConvertingSink<S> {
        let inputs = columns.inputs.iter().map(|key| self.of_input(*key)).collect();
        let outputs = outputs.iter().map(|output| self.of_output(output).1).collect();
        ConvertingSink { sink, inputs, outputs }
    }
}

/// A sink that converts rows to displayed units and passes them to another sink.
#[derive(Debug)]
pub struct ConvertingSink<S> {
    /// The sink that receives the converted rows.
    pub sink: S,
    inputs: Vec<DisplayUnit>,
    outputs: Vec<DisplayUnit>,
}

impl<S: AnswerSink> AnswerSink for ConvertingSink<S> {
    fn write(&mut self, mut chunk: Chunk, mut answers: Answers) -> Result<(), TableError> {
        for (values, unit) in chunk.inputs.iter_mut().zip(&self.inputs) {
            if !unit.is_own() {
                *values = values.unary(|value| unit.value(value));
            }
        }
        for (values, unit) in answers.columns.iter_mut().zip(&self.outputs) {
            if !unit.is_own() {
                for value in values.iter_mut() {
                    *value = unit.value(*value);
                }
            }
        }
        self.sink.write(chunk, answers)
    }
}

/// Returns the unit of a column as text; empty if the column has none.
pub fn unit_of(field: &Field) -> &str {
    field.metadata().get(UNIT).map_or("", String::as_str)
}

/// Returns the schema field of a numeric column with its unit.
pub(crate) fn field(name: &str, unit: &str) -> Field {
    let unit = HashMap::from([(UNIT.to_owned(), unit.to_owned())]);
    Field::new(name, DataType::Float64, true).with_metadata(unit)
}
