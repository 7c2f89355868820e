//! Rows in memory: a chunk of rows in Arrow columns, their results, and the table of both.

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
use bsm_case::{Case, CaseError, ModelChoice, OUTPUTS, Output};
use bsm_dyn::Status;
use rayon::prelude::*;
use serde_json::{Number, Value};

use crate::columns::{ANSWERS, Columns};
use crate::error::UnknownName;
use crate::{TableError, arrow_column};

/// A cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    /// Nothing; of an input, the base case decides.
    Missing,
    /// A number.
    Number(f64),
    /// A whole number, or one that keeps its digits.
    Digits(Number),
    /// True or false.
    Flag(bool),
    /// A text; in place of a number of an input it makes the row invalid.
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

/// Places that a column has more than rows: columns that lie a power of two apart would share the
/// few places of the cache that hold such addresses.
pub(crate) const COLUMN_PADDING: usize = 40;

/// Text that a chunk may hold, but for its last row \[B\]: few rows of long texts are as much work as
/// many of numbers.
pub(crate) const TEXT: usize = 32 << 20;

/// Some rows of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chunk {
    /// Number of the first row, from 1.
    pub first: u64,
    /// Number of rows.
    pub len: usize,
    /// Values of each input, null if missing.
    pub inputs: Vec<Float64Array>,
    /// Cells without a number, by row and place of the input.
    pub texts: BTreeMap<(usize, usize), String>,
    /// Each column that is carried through.
    pub kept: Vec<ArrayRef>,
}

impl Chunk {
    /// Rows of numbers, unless there are none.
    ///
    /// * `fill`: appends the values of the input at a place.
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

    /// Rows of the inputs of a table.
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

    /// The numbers of some rows, in that order.
    #[must_use]
    pub fn select(&self, rows: &[usize]) -> Self {
        let of = |input: &Float64Array| {
            rows.iter().map(|row| input.is_valid(*row).then(|| input.value(*row))).collect()
        };
        let inputs = self.inputs.iter().map(of).collect();
        Self { first: 1, len: rows.len(), inputs, ..Self::default() }
    }

    /// The value of an input, by its place.
    pub fn cell(&self, row: usize, index: usize) -> Cell<'_> {
        match self.texts.get(&(row, index)) {
            Some(text) => Cell::Text(text),
            None => number(&self.inputs[index], row),
        }
    }

    /// The case of a row: `base` with the given cells of the row as settings.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for a text in place of a number.
    pub fn case(&self, columns: &Columns, base: &Case, row: usize) -> Result<Case, CaseError> {
        let (mut case, mut settings) = (base.clone(), Case::default());
        for (index, key) in columns.inputs.iter().enumerate() {
            match self.cell(row, index) {
                Cell::Number(value) => settings[*key] = Some(value),
                Cell::Text(text) => return Err(CaseError::not_a_number(key.name(), text)),
                _ => {}
            }
        }
        case.override_with(&settings);
        Ok(case)
    }

    /// Gives rows without a value of an input theirs, if that is no NaN.
    pub(crate) fn complete(&mut self, index: usize, values: &[f64]) {
        let both = self.inputs[index].iter().zip(values);
        let both = both.map(|(x, other)| x.or_else(|| Some(*other).filter(|x| !x.is_nan())));
        self.inputs[index] = both.collect();
    }
}

fn number(column: &Float64Array, row: usize) -> Cell<'static> {
    column.is_valid(row).then(|| column.value(row)).into()
}

/// A chunk of a table of text, which is read row by row.
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

    /// Rows that are complete.
    pub(crate) fn len(&self) -> usize {
        self.chunk.len
    }

    /// Appends a value of an input, in the unit of the table.
    pub(crate) fn input(&mut self, index: usize, cell: &Cell<'_>) {
        match cell {
            Cell::Number(value) => {
                return self.inputs[index].append_value(value * self.columns.factor(index));
            }
            Cell::Text(text) => {
                self.chunk.texts.insert((self.chunk.len, index), (*text).to_owned());
            }
            _ => {}
        }
        self.inputs[index].append_null();
    }

    /// Appends a value of a column that is carried through.
    pub(crate) fn keep(&mut self, index: usize, text: Option<&str>) {
        self.kept[index].append_option(text);
    }

    pub(crate) fn end_row(&mut self) {
        self.chunk.len += 1;
    }

    /// The chunk, unless it has no rows.
    pub(crate) fn finish(self) -> Option<Chunk> {
        let inputs = self.inputs.into_iter().map(|mut column| column.finish());
        let kept = self.kept.into_iter().map(|mut texts| Arc::new(texts.finish()) as ArrayRef);
        let chunk = Chunk { inputs: inputs.collect(), kept: kept.collect(), ..self.chunk };
        (chunk.len > 0).then_some(chunk)
    }
}

/// How a row was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Verdict {
    /// The model that answered, or that was to be asked.
    pub model: ModelChoice,
    /// How the solve ended.
    pub status: Status,
    /// True if the point is known to have other solutions.
    pub has_others: bool,
}

/// The answers of a chunk: a verdict for each row, messages for some, and columns of outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// One for each row.
    pub verdicts: Vec<Verdict>,
    /// Why there is no result, or why auto chose its model: rows in their order.
    pub messages: Vec<(usize, String)>,
    /// The outputs that were asked for, in their order, as [`Output::read`]
    /// has them; NaN where there is none.
    pub columns: Vec<Vec<f64>>,
}

impl Answers {
    /// Room for the answers of some rows.
    pub fn room(rows: usize, outputs: usize) -> Self {
        let model = ModelChoice::Auto;
        let verdict = Verdict { model, status: Status::NotConverged, has_others: false };
        // Zeros of the system, which takes no memory before it is written to.
        let column = || {
            let mut column = vec![0.0; rows + COLUMN_PADDING];
            column.truncate(rows);
            column
        };
        Self {
            verdicts: vec![verdict; rows],
            messages: Vec::new(),
            columns: (0..outputs).map(|_| column()).collect(),
        }
    }

    /// Why a row has no result, or why auto chose its model.
    pub fn message(&self, row: usize) -> Option<&str> {
        let index = self.messages.binary_search_by_key(&row, |(row, _)| *row).ok()?;
        Some(&self.messages[index].1)
    }

    /// All outputs of a solution, or those of a selection, in its order, which may hold numbers of
    /// analyses.
    ///
    /// # Errors
    ///
    /// [`TableError`] of a name that is no output, or appears twice.
    pub fn select(names: Option<&[String]>) -> Result<Vec<&'static Output>, TableError> {
        let Some(names) = names else { return Ok(OUTPUTS.iter().collect()) };
        let mut selected: Vec<&'static Output> = Vec::with_capacity(names.len());
        let mut unknown = Vec::new();
        // The answers are in every table.
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

    /// The table of a chunk and its answers.
    ///
    /// # Errors
    ///
    /// [`TableError`] if a column that is carried through is not of its type.
    pub fn table(
        self,
        chunk: &Chunk,
        schema: &SchemaRef,
        outputs: &[&'static Output],
    ) -> Result<RecordBatch, TableError> {
        let verdicts = &self.verdicts[..];
        let models = text_column(verdicts, |a, b| a.model == b.model, |v| Some(v.model.name()));
        let statuses =
            text_column(verdicts, |a, b| a.status == b.status, |v| Some(v.status.name()));
        let mut messages = StringBuilder::new();
        for (row, message) in &self.messages {
            messages.append_nulls(row - messages.len());
            messages.append_value(message);
        }
        messages.append_nulls(verdicts.len() - messages.len());
        let inputs = chunk.inputs.iter().map(|input| Arc::new(input.clone()) as ArrayRef);
        let before = chunk.kept.iter().cloned().chain(inputs);
        let before = before.chain([models, statuses, Arc::new(messages.finish())]);
        let answers = self.columns.into_par_iter().zip(outputs);
        let answers: Vec<_> = answers.map(|(column, output)| values(output, column)).collect();
        Ok(RecordBatch::try_new(schema.clone(), before.chain(answers).collect())?)
    }
}

/// Words that stand in runs of rows.
fn text_column<T>(
    rows: &[T],
    same: impl Fn(&T, &T) -> bool,
    word: impl Fn(&T) -> Option<&'static str>,
) -> ArrayRef {
    let mut words = StringBuilder::new();
    for run in rows.chunk_by(same) {
        match word(&run[0]) {
            // Most columns have one word.
            Some(word) if run.len() == rows.len() => {
                return Arc::new(StringArray::new_repeated(word, rows.len()));
            }
            Some(word) => words.append_value_n(word, run.len()),
            None => words.append_nulls(run.len()),
        }
    }
    Arc::new(words.finish())
}

/// Values of an output by its type.
fn values(output: &Output, values: Vec<f64>) -> ArrayRef {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
    let count = |x: &f64| (!x.is_nan()).then_some(*x as u64);
    let flag = |x: &f64| (!x.is_nan()).then_some(*x > 0.5);
    match output.json_type {
        "integer" => Arc::new(values.iter().map(count).collect::<UInt64Array>()),
        "boolean" => Arc::new(values.iter().map(flag).collect::<BooleanArray>()),
        "string" => text_column(&values, |a, b| a.to_bits() == b.to_bits(), |x| output.word(*x)),
        _ => Arc::new(numbers(values)),
    }
}

/// Numbers; NaN is missing.
pub(crate) fn numbers(values: Vec<f64>) -> Float64Array {
    // All of them are looked at, several at once.
    let gaps = values.iter().fold(false, |gaps, x| gaps | x.is_nan());
    let given = gaps.then(|| values.iter().map(|x| !x.is_nan()).collect::<NullBuffer>());
    Float64Array::new(values.into(), given)
}

/// A table that is read by rows.
pub struct Cells<'a> {
    columns: Vec<ArrowColumn<'a>>,
    texts: &'a BTreeMap<(usize, usize), String>,
    kept: usize,
}

/// A column of it.
enum ArrowColumn<'a> {
    Numbers(&'a Float64Array),
    Counts(&'a UInt64Array),
    Flags(&'a BooleanArray),
    Texts(&'a StringArray),
    Values(Vec<Value>),
}

impl<'a> Cells<'a> {
    /// The cells of the table of a chunk.
    ///
    /// # Errors
    ///
    /// [`TableError`] if a column that is carried through cannot be written as text.
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

    /// The cells of a row.
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
