//! Table rows in memory: a chunk of rows as Arrow columns, the results of the chunk, and a table
//! that contains rows and results.

use std::collections::BTreeMap;
use std::sync::Arc;

use arrow_array::builder::{ArrayBuilder, Float64Builder, StringBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::UInt64Type;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array,
};
use arrow_buffer::NullBuffer;
use arrow_schema::{DataType, SchemaRef};
use bsm_case::{Case, CaseError, ModelChoice, OUTPUTS, Output, OutputType};
use bsm_dyn::Status;
use rayon::prelude::*;
use serde_json::{Number, Value};

use crate::columns::{ANSWERS, Columns};
use crate::error::UnknownName;
use crate::{TableError, arrow_column};

/// Number of rows per chunk. Each page of a Parquet table contains one chunk, so the contents of
/// the file depend on this number.
pub const ROWS_PER_CHUNK: usize = 1 << 16;

/// The value of a table cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// An empty cell. If the cell of an input is empty, the value of the base case is used.
    Missing,
    /// A floating-point number.
    Number(f64),
    /// An integer, or another number whose digits must not change.
    Digits(Number),
    /// A boolean.
    Flag(bool),
    /// A text. A row is invalid if it contains a text instead of a number.
    Text(&'a str),
}

impl<'a> From<&'a Value> for Cell<'a> {
    fn from(value: &'a Value) -> Self {
        match value {
            Value::Bool(flag) => Self::Flag(*flag),
            Value::Number(number) => Self::Digits(number.clone()),
            Value::String(text) => Self::Text(text),
            _ => Self::Missing,
        }
    }
}

impl From<Option<f64>> for Cell<'_> {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::Number)
    }
}

/// Number of unused elements that are allocated at the end of each column. Without them, the
/// distance between columns could be a power of two, and the columns would compete for the same few
/// cache lines.
pub(crate) const COLUMN_PADDING: usize = 40;

/// Maximum total size \[B\] of the texts in a chunk, not counting its last row. Processing a few
/// rows with long texts takes as long as processing many rows with numbers.
pub(crate) const MAX_TEXT_BYTES: usize = 32 << 20;

/// A chunk: consecutive rows of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chunk {
    /// Number of the first row; rows are counted from 1.
    pub first: u64,
    /// Number of rows in the chunk.
    pub len: usize,
    /// Values of each input. Missing values are null.
    pub inputs: Vec<Float64Array>,
    /// Texts in input cells that should contain numbers, by row and input.
    pub texts: BTreeMap<(usize, usize), String>,
    /// Values of each column that is copied to the results.
    pub kept: Vec<ArrayRef>,
}

impl Chunk {
    /// Returns a chunk in which all inputs are numbers, or `None` if `len` is 0.
    ///
    /// * `fill`: function that appends the values of the input with the given index.
    pub(crate) fn of_numbers(
        first: u64,
        len: usize,
        columns: &Columns,
        fill: impl Fn(usize, &mut Vec<f64>),
    ) -> Option<Self> {
        let input = |index| {
            let mut values = Vec::with_capacity(len + COLUMN_PADDING);
            fill(index, &mut values);
            Float64Array::from(values)
        };
        let inputs = (0..columns.inputs.len()).map(input).collect();
        (len > 0).then(|| Self { first, len, inputs, ..Self::default() })
    }

    /// Returns a chunk that contains the given input cells.
    pub fn of_rows<'a, C: Into<Cell<'a>>, R: IntoIterator<Item = C>>(
        columns: &Columns,
        rows: impl IntoIterator<Item = R>,
    ) -> Self {
        let mut chunk = ChunkBuilder::new(1, columns, 0);
        for row in rows {
            for (index, cell) in row.into_iter().enumerate() {
                chunk.input(index, &cell.into());
            }
            chunk.end_row();
        }
        chunk.finish().unwrap_or_default()
    }

    /// Returns a chunk with the numbers of the given rows, in the given order.
    #[must_use]
    pub fn select(&self, rows: &[usize]) -> Self {
        let of = |input: &Float64Array| {
            rows.iter().map(|row| input.is_valid(*row).then(|| input.value(*row))).collect()
        };
        let inputs = self.inputs.iter().map(of).collect();
        Self { first: 1, len: rows.len(), inputs, ..Self::default() }
    }

    /// Returns the cell of a row for the input with the given index.
    pub fn cell(&self, row: usize, index: usize) -> Cell<'_> {
        match self.texts.get(&(row, index)) {
            Some(text) => Cell::Text(text),
            None => number(&self.inputs[index], row),
        }
    }

    /// Returns the case of a row: a copy of the case `base` in which each nonempty cell of the row
    /// replaces the value of its input.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if a cell contains text instead of a number.
    pub fn case(&self, columns: &Columns, base: &Case, row: usize) -> Result<Case, CaseError> {
        let mut numbers = Vec::with_capacity(columns.inputs.len());
        for (index, key) in columns.inputs.iter().enumerate() {
            match self.cell(row, index) {
                Cell::Number(value) => numbers.push((*key, value)),
                Cell::Text(text) => return Err(CaseError::not_a_number(key.name(), text)),
                _ => {}
            }
        }
        let mut case = base.clone();
        case.override_with_numbers(&numbers);
        Ok(case)
    }

    /// Replaces the missing values of an input by `values`. If a replacement is NaN, the value
    /// remains missing.
    pub(crate) fn complete(&mut self, index: usize, values: &[f64]) {
        let both = self.inputs[index].iter().zip(values);
        let both = both.map(|(x, other)| x.or_else(|| Some(*other).filter(|x| !x.is_nan())));
        self.inputs[index] = both.collect();
    }
}

fn number(column: &Float64Array, row: usize) -> Cell<'static> {
    column.is_valid(row).then(|| column.value(row)).into()
}

/// Builds a chunk from a text table that is read row by row.
pub(crate) struct ChunkBuilder<'a> {
    columns: &'a Columns,
    chunk: Chunk,
    inputs: Vec<Float64Builder>,
    kept: Vec<StringBuilder>,
}

impl<'a> ChunkBuilder<'a> {
    pub(crate) fn new(first: u64, columns: &'a Columns, rows: usize) -> Self {
        let input = || Float64Builder::with_capacity(rows + COLUMN_PADDING);
        Self {
            columns,
            chunk: Chunk { first, ..Chunk::default() },
            inputs: columns.inputs.iter().map(|_| input()).collect(),
            kept: columns.kept.iter().map(|_| StringBuilder::new()).collect(),
        }
    }

    /// Returns the number of complete rows.
    pub(crate) fn len(&self) -> usize {
        self.chunk.len
    }

    /// Appends the cell of an input to the current row. The number is in the unit of the table.
    pub(crate) fn input(&mut self, index: usize, cell: &Cell<'_>) {
        match cell {
            Cell::Number(value) => {
                return self.inputs[index].append_value(self.columns.change(index).value(*value));
            }
            Cell::Text(text) => {
                self.chunk.texts.insert((self.chunk.len, index), (*text).to_owned());
            }
            _ => {}
        }
        self.inputs[index].append_null();
    }

    /// Appends the cell of a copied column to the current row.
    pub(crate) fn keep(&mut self, index: usize, text: Option<&str>) {
        self.kept[index].append_option(text);
    }

    pub(crate) fn end_row(&mut self) {
        self.chunk.len += 1;
    }

    /// Returns the complete chunk, or `None` if it has no rows.
    pub(crate) fn finish(self) -> Option<Chunk> {
        let inputs = self.inputs.into_iter().map(|mut column| column.finish());
        let kept = self.kept.into_iter().map(|mut texts| Arc::new(texts.finish()) as ArrayRef);
        let chunk = Chunk { inputs: inputs.collect(), kept: kept.collect(), ..self.chunk };
        (chunk.len > 0).then_some(chunk)
    }
}

/// Model and status with which a row was solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowOutcome {
    /// Model that solved the row, or the requested model if the row has no result.
    pub model: ModelChoice,
    /// Status with which the calculation of the row ended.
    pub status: Status,
    /// True if the operating point is known to have further solutions.
    pub has_others: bool,
}

/// Results of a chunk: model and status of each row, messages about some rows, and the values of
/// each output.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// Model and status of each row.
    pub outcomes: Vec<RowOutcome>,
    /// Row index and message, in ascending order of the row index. A message states the reason why
    /// the row has no result or why `auto` chose its model.
    pub messages: Vec<(usize, String)>,
    /// Values of the requested outputs, in the order in which the outputs were requested. The
    /// values have the form that [`Output::read`] returns, and missing values are NaN.
    pub columns: Vec<Vec<f64>>,
}

impl Answers {
    /// Allocates buffers for the results of a chunk with the given number of rows and outputs.
    pub fn allocate(rows: usize, outputs: usize) -> Self {
        let model = ModelChoice::Auto;
        let outcome = RowOutcome { model, status: Status::NotConverged, has_others: false };
        // The operating system provides zeroed memory pages, which occupy no physical memory until
        // the program writes to them.
        let column = || {
            let mut column = vec![0.0; rows + COLUMN_PADDING];
            column.truncate(rows);
            column
        };
        Self {
            outcomes: vec![outcome; rows],
            messages: Vec::new(),
            columns: (0..outputs).map(|_| column()).collect(),
        }
    }

    /// Returns the message about a row: the reason why the row has no result, or why `auto` chose
    /// its model.
    pub fn message(&self, row: usize) -> Option<&str> {
        let index = self.messages.binary_search_by_key(&row, |(row, _)| *row).ok()?;
        Some(&self.messages[index].1)
    }

    /// Returns the outputs with the given names, in the given order. The names may include results
    /// of analyses. Without names, all outputs of a solution are returned.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if a name is not an output or appears twice.
    pub fn select(names: Option<&[String]>) -> Result<Vec<&'static Output>, TableError> {
        let Some(names) = names else { return Ok(OUTPUTS.iter().collect()) };
        let mut selected: Vec<&'static Output> = Vec::with_capacity(names.len());
        let mut unknown = Vec::new();
        // The names of status columns are skipped, because every table contains these columns.
        for name in names.iter().filter(|name| !ANSWERS.contains(&name.as_str())) {
            let Some(output) = Output::named(name) else {
                unknown.push(UnknownName { name: name.clone(), nearest: Output::nearest(name) });
                continue;
            };
            if selected.iter().any(|other| other.name == output.name) {
                return Err(TableError::repeated(name, name));
            }
            selected.push(output);
        }
        if !unknown.is_empty() {
            return Err(TableError::UnknownOutputs { names: unknown });
        }
        Ok(selected)
    }

    /// Returns a table of the rows of a chunk and their results.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if a copied column does not have the expected type.
    pub fn table(
        self,
        chunk: &Chunk,
        schema: &SchemaRef,
        outputs: &[&'static Output],
    ) -> Result<RecordBatch, TableError> {
        let outcomes = &self.outcomes[..];
        let models = text_column(outcomes, |a, b| a.model == b.model, |v| Some(v.model.name()));
        let statuses =
            text_column(outcomes, |a, b| a.status == b.status, |v| Some(v.status.name()));
        let mut messages = StringBuilder::new();
        for (row, message) in &self.messages {
            messages.append_nulls(row - messages.len());
            messages.append_value(message);
        }
        messages.append_nulls(outcomes.len() - messages.len());
        let inputs = chunk.inputs.iter().map(|input| Arc::new(input.clone()) as ArrayRef);
        let before = chunk.kept.iter().cloned().chain(inputs);
        let before = before.chain([models, statuses, Arc::new(messages.finish())]);
        let answers = self.columns.into_par_iter().zip(outputs);
        let answers: Vec<_> = answers.map(|(column, output)| values(output, column)).collect();
        Ok(RecordBatch::try_new(schema.clone(), before.chain(answers).collect())?)
    }
}

/// Creates a text column. Consecutive rows with equal texts are appended together.
fn text_column<T>(
    rows: &[T],
    same: impl Fn(&T, &T) -> bool,
    word: impl Fn(&T) -> Option<&'static str>,
) -> ArrayRef {
    let mut words = StringBuilder::new();
    for run in rows.chunk_by(same) {
        match word(&run[0]) {
            // Most text columns contain the same text in all rows.
            Some(word) if run.len() == rows.len() => {
                return Arc::new(StringArray::new_repeated(word, rows.len()));
            }
            Some(word) => words.append_value_n(word, run.len()),
            None => words.append_nulls(run.len()),
        }
    }
    Arc::new(words.finish())
}

/// Converts the values of an output to an Arrow column with the data type of the output.
fn values(output: &Output, values: Vec<f64>) -> ArrayRef {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
    let count = |x: &f64| (!x.is_nan()).then_some(*x as u64);
    let flag = |x: &f64| (!x.is_nan()).then_some(*x > 0.5);
    match output.output_type {
        OutputType::Number => Arc::new(numbers(values)),
        OutputType::Integer => Arc::new(values.iter().map(count).collect::<UInt64Array>()),
        OutputType::Boolean => Arc::new(values.iter().map(flag).collect::<BooleanArray>()),
        OutputType::Text => {
            text_column(&values, |a, b| a.to_bits() == b.to_bits(), |x| output.word(*x))
        }
    }
}

/// Converts numbers to an Arrow column. NaN becomes null.
pub(crate) fn numbers(values: Vec<f64>) -> Float64Array {
    // The loop examines all values even after it has found NaN, because the compiler can then
    // vectorize the loop.
    let gaps = values.iter().fold(false, |gaps, x| gaps | x.is_nan());
    let given = gaps.then(|| values.iter().map(|x| !x.is_nan()).collect::<NullBuffer>());
    Float64Array::new(values.into(), given)
}

/// Access to the cells of a table, row by row.
pub struct RowCells<'a> {
    columns: Vec<ArrowColumn<'a>>,
    texts: &'a BTreeMap<(usize, usize), String>,
    kept: usize,
}

/// A column of the table with its Arrow type.
enum ArrowColumn<'a> {
    Numbers(&'a Float64Array),
    Counts(&'a UInt64Array),
    Flags(&'a BooleanArray),
    Texts(&'a StringArray),
    Values(Vec<Value>),
}

impl<'a> RowCells<'a> {
    /// Creates a view of the cells of a table. `chunk` is the chunk from which the table was
    /// created.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the values of a copied column have no text representation.
    pub fn of(table: &'a RecordBatch, chunk: &'a Chunk) -> Result<Self, TableError> {
        let kept = chunk.kept.len();
        let column = |(index, column): (usize, &'a ArrayRef)| {
            Ok(match column.data_type() {
                DataType::Utf8 => ArrowColumn::Texts(column.as_string()),
                _ if index < kept => ArrowColumn::Values(arrow_column::values(column)?),
                DataType::Boolean => ArrowColumn::Flags(column.as_boolean()),
                DataType::UInt64 => ArrowColumn::Counts(column.as_primitive::<UInt64Type>()),
                _ => ArrowColumn::Numbers(column.as_primitive()),
            })
        };
        let columns = table.columns().iter().enumerate().map(column);
        Ok(Self { columns: columns.collect::<Result<_, TableError>>()?, texts: &chunk.texts, kept })
    }

    /// Returns the cells of the row with the given index.
    pub fn row(&self, row: usize) -> impl Iterator<Item = Cell<'_>> {
        self.columns.iter().enumerate().map(move |(index, column)| match column {
            ArrowColumn::Numbers(column) => {
                match self.texts.get(&(row, index.wrapping_sub(self.kept))) {
                    Some(text) => Cell::Text(text),
                    None => number(column, row),
                }
            }
            ArrowColumn::Counts(column) if column.is_valid(row) => {
                Cell::Digits(column.value(row).into())
            }
            ArrowColumn::Flags(column) if column.is_valid(row) => Cell::Flag(column.value(row)),
            ArrowColumn::Texts(column) if column.is_valid(row) => Cell::Text(column.value(row)),
            ArrowColumn::Values(values) => Cell::from(&values[row]),
            _ => Cell::Missing,
        })
    }
}
