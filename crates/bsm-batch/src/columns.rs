//! Columns of input tables and of tables of results.

use std::collections::HashMap;
use std::iter::repeat;
use std::sync::Arc;

use arrow_array::Float64Array;
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use bsm_case::units::UnitChange;
use bsm_case::{
    DisplayUnit, DisplayUnits, InputKey, InputSet, Output, OutputType, brief, nearest_input,
};

use crate::error::UnknownName;
use crate::{AnswerSink, Answers, Chunk, TableError, TableFormat};

/// Status columns, which precede the outputs in a table of results.
pub(crate) const ANSWERS: [&str; 3] = ["model", "status", "message"];

/// Key of the unit in the metadata of a column.
pub(crate) const UNIT: &str = "unit";

/// Returns true if the name belongs to a status column or to an output, so that a table of results
/// may contain a column with this name.
pub(crate) fn is_answer(name: &str) -> bool {
    ANSWERS.contains(&name) || Output::named(name).is_some()
}

/// Columns of a table of operating points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Inputs that are columns of the table, in the order of the columns.
    pub inputs: Vec<InputKey>,
    /// Indices of the input columns in the table.
    pub(crate) input_places: Vec<usize>,
    /// For each input, the column name in the table, and the conversion from the unit of the table
    /// to the unit of the input.
    pub(crate) units: Vec<(String, UnitChange)>,
    /// Names of the columns that are copied to the results.
    pub kept: Vec<String>,
    pub(crate) kept_places: Vec<usize>,
    /// Arrow types of the copied columns.
    pub(crate) kept_types: Vec<DataType>,
    /// Names of all columns that are ignored.
    pub(crate) unread: Vec<String>,
    /// Names of columns that are ignored because an output or a status column has the same name.
    results: Vec<String>,
}

/// Name, type, unit and description of a column in a table of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heading<'a> {
    /// Column name.
    pub name: &'a str,
    /// Type of the values in the column.
    pub output_type: OutputType,
    /// Unit of the column as text, which is empty for a column without a unit.
    pub unit: &'static str,
    /// Description of the values in the column.
    pub about: &'static str,
}

impl Columns {
    /// Determines for each column of a table whether it is an input, is copied to the results, or
    /// is ignored because it contains results of an earlier run.
    ///
    /// * `keep`: names of the columns that are copied to the results.
    /// * `table_format`: assignment of column names to inputs, for tables that use other names.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if a name is neither an input nor in `keep`, if a name appears twice,
    /// if a name in `keep` is also the name of a status column or an output, or if the table has no
    /// column with a name in `keep`.
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
            let Some(name) = (if is_kept { Some(own) } else { table_format.input_of(own) }) else {
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
                // Some outputs have the same name as an input. In a table with results of an
                // earlier run, columns before the status columns are inputs, and columns after the
                // status columns are outputs.
                columns.unread.push(own.to_owned());
                columns.results.push(own.to_owned());
            } else if unknown.iter().any(|other: &UnknownName| other.name == name) {
                // This unknown name is already in the list, so it is not added again.
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

    /// Returns the columns of a table that contains only inputs, in the units of the inputs.
    pub(crate) fn of_inputs(inputs: Vec<InputKey>) -> Self {
        Self { input_places: (0..inputs.len()).collect(), inputs, ..Self::default() }
    }

    /// Sets the Arrow types of the copied columns, which are text by default.
    #[must_use]
    pub fn with_kept_types(self, types: Vec<DataType>) -> Self {
        Self { kept_types: types, ..self }
    }

    /// Returns name, type, unit and description of each column in a table of results, in the order
    /// of the columns.
    pub fn headings<'a>(
        &'a self,
        outputs: &'a [&'static Output],
    ) -> impl Iterator<Item = Heading<'a>> {
        let text = |name, about| Heading { name, output_type: OutputType::Text, unit: "", about };
        let kept = self.kept.iter().map(move |name| text(name, "copied from the input table"));
        let inputs = self.inputs.iter().map(|key| {
            let input = key.input();
            Heading {
                name: input.name,
                output_type: OutputType::Number,
                unit: input.unit,
                about: input.about,
            }
        });
        let [model, status, message] = ANSWERS;
        let answers = [
            text(model, "model that calculated the result"),
            text(status, "status of the solution"),
            text(message, "reason why the row has no result, or why `auto` chose its model"),
        ];
        let outputs = outputs.iter().map(|output| {
            let Output { name, output_type, unit, about, .. } = **output;
            Heading { name, output_type, unit, about }
        });
        kept.chain(inputs).chain(answers).chain(outputs)
    }

    /// Converts the values of an input to the unit of this input. The values are copied only if the
    /// table uses another unit.
    pub fn in_unit(&self, index: usize, values: Float64Array) -> Float64Array {
        match self.change(index) {
            UnitChange::NONE => values,
            change => values.unary(|value| change.value(value)),
        }
    }

    /// Returns the conversion from the unit of the table to the unit of the input. The values of a
    /// grid need no conversion.
    pub(crate) fn change(&self, index: usize) -> UnitChange {
        self.units.get(index).map_or(UnitChange::NONE, |(_, change)| *change)
    }

    /// Returns the Arrow schema of a table of results. The column metadata contain the units.
    pub fn schema(&self, outputs: &[&'static Output]) -> SchemaRef {
        let kept = self.kept_types.iter().map(Some).chain(repeat(None));
        let fields = self.headings(outputs).zip(kept).map(|(heading, kept)| match kept {
            Some(kind) => Field::new(heading.name, kind.clone(), true),
            None if ANSWERS.contains(&heading.name) => {
                Field::new(heading.name, DataType::Utf8, heading.name == "message")
            }
            None => field(heading.name, heading.unit).with_data_type(match heading.output_type {
                OutputType::Number => DataType::Float64,
                OutputType::Integer => DataType::UInt64,
                OutputType::Boolean => DataType::Boolean,
                OutputType::Text => DataType::Utf8,
            }),
        });
        Arc::new(Schema::new(fields.collect::<Vec<_>>()))
    }

    /// Returns the indices of the input columns in the table.
    pub fn input_places(&self) -> &[usize] {
        &self.input_places
    }

    /// Returns a note that lists the columns that are ignored because an output or a status column
    /// has the same name.
    pub fn ignored_note(&self) -> Option<String> {
        /// Maximum number of column names in the note.
        const NAMED: usize = 4;
        let mut names: Vec<_> = self.results.iter().take(NAMED).map(|name| brief(name)).collect();
        let more = self.results.len().saturating_sub(NAMED);
        if more > 0 {
            names.push(format!("{more} more"));
        }
        let names = names.join(", ");
        (!names.is_empty()).then(|| {
            format!("Columns that contain results instead of inputs are ignored: {names}.")
        })
    }

    /// Returns the set of all inputs that are columns of the table.
    pub fn set(&self) -> InputSet {
        self.inputs.iter().copied().collect()
    }
}

/// Units in which a table of results displays its columns.
#[derive(Debug, Clone, Default)]
pub struct ColumnUnits {
    display: DisplayUnits,
    /// Outputs that the user requested in a unit other than the default, each with its displayed
    /// name and unit.
    selected: Vec<(&'static str, String, DisplayUnit)>,
}

impl ColumnUnits {
    /// Determines the units in which the columns are displayed.
    ///
    /// * `columns`: names of the selected outputs. If a name ends with a unit other than the
    ///   default unit of the output, the column is displayed in this unit.
    pub fn new(display: DisplayUnits, columns: Option<&[String]>) -> Self {
        let in_other_unit = |name: &String| {
            let (output, unit) = Output::in_unit(name)?;
            (output.name != name).then(|| (output.name, name.clone(), unit))
        };
        let names = columns.unwrap_or_default().iter();
        Self { display, selected: names.filter_map(in_other_unit).collect() }
    }

    /// Returns true if all inputs and outputs are displayed in their default units.
    pub fn are_own(&self) -> bool {
        self.display == DisplayUnits::Metric && self.selected.is_empty()
    }

    /// Returns the unit in which an input is displayed.
    pub fn of_input(&self, key: InputKey) -> DisplayUnit {
        self.display.of(key.input().unit)
    }

    /// Returns the name and the unit with which an output is displayed.
    pub fn of_output(&self, output: &Output) -> (String, DisplayUnit) {
        if let Some((_, name, unit)) = self.selected.iter().find(|(own, ..)| *own == output.name) {
            return (name.clone(), *unit);
        }
        let unit = self.display.of(output.unit);
        (unit.name(output.name), unit)
    }

    /// Returns the Arrow schema of a table of results, with the displayed names and units.
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

    /// Returns a sink that converts rows to the displayed units and passes them to `sink`.
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

/// A sink that converts rows to the displayed units and passes them to another sink.
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

/// Returns the unit of a column as text, which is empty for a column without a unit.
pub fn unit_of(field: &Field) -> &str {
    field.metadata().get(UNIT).map_or("", String::as_str)
}

/// Returns the Arrow field of a numeric column, with the unit in the metadata of the field.
pub(crate) fn field(name: &str, unit: &str) -> Field {
    let unit = HashMap::from([(UNIT.to_owned(), unit.to_owned())]);
    Field::new(name, DataType::Float64, true).with_metadata(unit)
}
