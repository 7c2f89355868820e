//! Rows in memory: a chunk of them by columns, and their answers.

use std::borrow::Cow;

use arrow_array::ArrayRef;
use arrow_buffer::ScalarBuffer;
use arrow_schema::DataType;
use bsm_case::{CaseError, InputKey, InputSet, ModelChoice, OUTPUTS, Output, Scene, nearest_input};
use bsm_dyn::Status;
use serde_json::Value;

use crate::{Dialect, TableError, arrow_column};

/// A value of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Not given: the base scene decides.
    Missing,
    /// A number.
    Number(f64),
    /// Something else, which makes the row invalid.
    Text(String),
}

/// Columns of the answers before the outputs.
pub(crate) const ANSWERS: [&str; 3] = ["model", "status", "message"];

/// True for a column of an answer.
pub(crate) fn is_answer(name: &str) -> bool {
    ANSWERS.contains(&name) || Output::named(name).is_some()
}

/// What the columns of a table are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Inputs, in the order of the table.
    pub inputs: Vec<InputKey>,
    /// Places of the inputs in the table.
    pub(crate) input_places: Vec<usize>,
    /// Their names in the table, and what a value there is multiplied with to be in the unit of the input.
    pub(crate) units: Vec<(String, f64)>,
    /// Columns that are carried through.
    pub kept: Vec<String>,
    pub(crate) kept_places: Vec<usize>,
    /// Their types.
    pub(crate) kept_types: Vec<DataType>,
    /// Names of columns that are not read.
    pub(crate) unread: Vec<String>,
}

/// The head of a column of a table of answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heading<'a> {
    /// Name.
    pub name: &'a str,
    /// JSON type.
    pub json_type: &'static str,
    /// Unit in words; empty if it has none.
    pub unit: &'static str,
    /// Meaning.
    pub about: &'static str,
}

impl Columns {
    /// Sorts the names of a table into inputs and columns to keep; columns of an earlier answer are
    /// passed over.
    ///
    /// # Errors
    ///
    /// [`TableError`] for a name that is neither, that stands twice or is one of the answers, or that
    /// is to be kept but is not there.
    pub fn sort<'a>(
        names: impl IntoIterator<Item = &'a str>,
        keep: &[String],
    ) -> Result<Self, TableError> {
        Self::sort_as(names, keep, &Dialect::default())
    }

    /// Inputs and nothing else, in their units.
    pub(crate) fn of_inputs(inputs: Vec<InputKey>) -> Self {
        Self { input_places: (0..inputs.len()).collect(), inputs, ..Self::default() }
    }

    /// [`sort`](Self::sort) for a table that has other names; `keep` has those of the table.
    pub(crate) fn sort_as<'a>(
        names: impl IntoIterator<Item = &'a str>,
        keep: &[String],
        dialect: &Dialect,
    ) -> Result<Self, TableError> {
        let mut renamed: Vec<_> = dialect.names.keys().collect();
        if let Some(name) = keep.iter().find(|name| is_answer(name)) {
            return Err(TableError::NameOfAnAnswer { name: name.clone() });
        }
        let mut columns = Self::default();
        let mut answered = false;
        for (place, own) in names.into_iter().enumerate() {
            let own = own.trim();
            renamed.retain(|name| *name != own);
            let is_kept = keep.iter().any(|kept| kept == own);
            let Some(name) = (if is_kept { Some(own) } else { dialect.name(own) }) else {
                columns.unread.push(own.to_owned());
                continue;
            };
            let repeated = |former: &str| {
                Err(TableError::RepeatedColumn { names: [former, own].map(str::to_owned) })
            };
            answered |= ANSWERS.contains(&name);
            if columns.kept.iter().any(|k| k == name) {
                return repeated(own);
            }
            if is_kept {
                columns.kept.push(name.to_owned());
                columns.kept_places.push(place);
                columns.kept_types.push(DataType::Utf8);
            } else if answered && is_answer(name) {
                // Some answers have the name of an input; the inputs of an earlier answer stand before it.
                columns.unread.push(own.to_owned());
            } else if let Ok((key, factor)) = InputKey::in_unit(name) {
                if let Some(former) = columns.inputs.iter().position(|input| *input == key) {
                    return repeated(&columns.units[former].0);
                }
                columns.inputs.push(key);
                columns.input_places.push(place);
                columns.units.push((own.to_owned(), factor));
            } else if !is_answer(name) {
                let nearest = nearest_input(name).map(str::to_owned);
                return Err(TableError::UnknownColumn { name: name.to_owned(), nearest });
            }
        }
        match (keep.iter().find(|name| !columns.kept.contains(name)), renamed.first()) {
            (Some(name), _) => Err(TableError::NothingToKeep { name: name.clone() }),
            (None, Some(name)) => Err(TableError::NothingToRename { name: (*name).clone() }),
            (None, None) => Ok(columns),
        }
    }

    /// With the types of the columns that are carried through, which are texts otherwise.
    #[must_use]
    pub fn with_kept_types(self, types: Vec<DataType>) -> Self {
        Self { kept_types: types, ..self }
    }

    /// The columns of a table of answers, in order.
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
            text(model, "the model that was solved"),
            text(status, "how the solve ended"),
            text(message, "why there is no result, or why auto chose its model"),
        ];
        let outputs = outputs.iter().map(|output| {
            let Output { name, json_type, unit, about, .. } = **output;
            Heading { name, json_type, unit, about }
        });
        kept.chain(inputs).chain(answers).chain(outputs)
    }

    /// Values of the input at a place, in memory that somebody else may hold too; copied only if they are in
    /// another unit than the input.
    ///
    /// * `missing`: rows without a value, in their order.
    pub fn column(
        &self,
        place: usize,
        values: ScalarBuffer<f64>,
        missing: impl IntoIterator<Item = usize>,
    ) -> Column {
        let values = match self.units.get(place) {
            #[expect(clippy::float_cmp, reason = "exactly one: no conversion")]
            Some((_, factor)) if *factor != 1.0 => {
                Numbers::Own(values.iter().map(|value| value * factor).collect())
            }
            _ => Numbers::Shared(values),
        };
        let odd = missing.into_iter().map(|row| (row, Cell::Missing)).collect();
        Column { values, odd, ..Column::default() }
    }

    /// Places of the inputs among the names of the table.
    pub fn input_places(&self) -> &[usize] {
        &self.input_places
    }

    /// The inputs as a set.
    pub fn set(&self) -> InputSet {
        self.inputs.iter().copied().collect()
    }
}

/// Places that a column has more than rows: columns that lie a power of two apart would share the
/// few places of the cache that hold such addresses.
pub(crate) const APART: usize = 40;

/// Numbers of a column.
#[derive(Debug, Clone)]
enum Numbers {
    Own(Vec<f64>),
    /// Memory that somebody else holds too.
    Shared(ScalarBuffer<f64>),
}

impl PartialEq for Numbers {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}

impl Numbers {
    fn get(&self) -> &[f64] {
        match self {
            Self::Own(values) => values,
            Self::Shared(values) => values,
        }
    }

    fn own(&mut self) -> &mut Vec<f64> {
        if let Self::Shared(values) = self {
            *self = Self::Own(values.to_vec());
        }
        match self {
            Self::Own(values) => values,
            Self::Shared(_) => unreachable!("copied above"),
        }
    }
}

/// The values of an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Numbers, NaN where there is none.
    values: Numbers,
    /// What is no number, by row.
    odd: Vec<(usize, Cell)>,
    /// What numbers are multiplied with, from the unit of the table to that of the input.
    factor: f64,
}

impl Default for Column {
    fn default() -> Self {
        Self { values: Numbers::Own(Vec::new()), odd: Vec::new(), factor: 1.0 }
    }
}

impl Column {
    /// A column with room for some rows.
    pub fn with_capacity(rows: usize) -> Self {
        Self { values: Numbers::Own(Vec::with_capacity(rows + APART)), ..Self::default() }
    }

    /// Appends a value, in the unit of the table.
    pub fn push(&mut self, cell: Cell) {
        let values = self.values.own();
        if let Cell::Number(value) = cell {
            values.push(value * self.factor);
        } else {
            self.odd.push((values.len(), cell));
            values.push(f64::NAN);
        }
    }

    /// Appends the numbers that `fill` appends.
    pub(crate) fn extend_with(&mut self, fill: impl FnOnce(&mut Vec<f64>)) {
        fill(self.values.own());
    }

    /// The value of a row.
    pub fn cell(&self, row: usize) -> Cell {
        match self.odd.binary_search_by_key(&row, |(odd, _)| *odd) {
            Ok(place) => self.odd[place].1.clone(),
            Err(_) => Cell::Number(self.values()[row]),
        }
    }

    /// The numbers, NaN where there is none.
    pub fn values(&self) -> &[f64] {
        self.values.get()
    }

    /// The numbers, with `value` where nothing is given.
    pub(crate) fn filled(&self, value: Option<f64>) -> Cow<'_, [f64]> {
        let mut values = Cow::Borrowed(self.values());
        let missing = self.odd.iter().filter(|(_, cell)| *cell == Cell::Missing);
        if let Some(value) = value {
            for (row, _) in missing {
                values.to_mut()[*row] = value;
            }
        }
        values
    }

    /// Gives rows without a value theirs, if that is no NaN.
    pub(crate) fn fill(&mut self, values: &[f64]) {
        let mut odd = std::mem::take(&mut self.odd);
        odd.retain(|(row, cell)| {
            let is_left = *cell != Cell::Missing || values[*row].is_nan();
            if !is_left {
                self.values.own()[*row] = values[*row];
            }
            is_left
        });
        self.odd = odd;
    }

    /// The rows that have a number, which may be NaN itself, unless all have.
    pub(crate) fn given(&self) -> Option<Vec<bool>> {
        let mut given = (!self.odd.is_empty()).then(|| vec![true; self.values().len()])?;
        for (row, _) in &self.odd {
            given[*row] = false;
        }
        Some(given)
    }
}

impl Extend<Cell> for Column {
    fn extend<I: IntoIterator<Item = Cell>>(&mut self, cells: I) {
        for cell in cells {
            self.push(cell);
        }
    }
}

/// Text that a chunk may hold, but for its last row \[B\]: few rows of long texts are as much work as
/// many of numbers.
pub(crate) const TEXT: usize = 32 << 20;

/// Some rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// Number of the first row, from 1.
    pub first: u64,
    /// Number of rows.
    pub len: usize,
    /// Values of each input.
    pub inputs: Vec<Column>,
    /// Each column that is carried through.
    pub kept: Vec<ArrayRef>,
}

impl Chunk {
    /// A chunk without rows.
    pub(crate) fn empty(first: u64, columns: &Columns, rows: usize) -> Self {
        Self {
            first,
            len: 0,
            inputs: (0..columns.inputs.len())
                .map(|i| Column {
                    // A grid has the units of the inputs.
                    factor: columns.units.get(i).map_or(1.0, |(_, factor)| *factor),
                    ..Column::with_capacity(rows)
                })
                .collect(),
            kept: Vec::new(),
        }
    }

    /// What is carried through as text files have it, by columns.
    ///
    /// # Errors
    ///
    /// [`TableError`] if a column cannot be written as text.
    pub fn kept_values(&self) -> Result<Vec<Vec<Value>>, TableError> {
        Ok(self.kept.iter().map(arrow_column::values).collect::<Result<_, _>>()?)
    }

    /// The scene of a row: `base` with the given cells of the row as settings.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for a text in place of a number.
    pub fn scene(&self, columns: &Columns, base: &Scene, row: usize) -> Result<Scene, CaseError> {
        let (mut scene, mut settings) = (base.clone(), Scene::default());
        for (key, column) in columns.inputs.iter().zip(&self.inputs) {
            match column.cell(row) {
                Cell::Missing => {}
                Cell::Number(value) => settings[*key] = Some(value),
                Cell::Text(text) => return Err(CaseError::not_a_number(key.name(), &text)),
            }
        }
        scene.override_with(&settings);
        Ok(scene)
    }

    pub(crate) fn filled(self) -> Option<Self> {
        (self.len > 0).then_some(self)
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

/// The answers of a chunk: a verdict for each row, words for some, and columns of outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// One for each row.
    pub verdicts: Vec<Verdict>,
    /// Why there is no result, or why auto chose its model: rows in their order.
    pub messages: Vec<(usize, String)>,
    /// The outputs that were asked for, in their order, as [`Cell::number`](bsm_case::Cell::number)
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
            let mut column = vec![0.0; rows + APART];
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
        let place = self.messages.binary_search_by_key(&row, |(row, _)| *row).ok()?;
        Some(&self.messages[place].1)
    }

    /// All outputs of a solution, or those of a selection, in its order, which may hold numbers of
    /// analyses.
    ///
    /// # Errors
    ///
    /// [`TableError::UnknownOutput`], [`TableError::RepeatedColumn`].
    pub fn select(names: Option<&[String]>) -> Result<Vec<&'static Output>, TableError> {
        let Some(names) = names else { return Ok(OUTPUTS.iter().collect()) };
        let mut selected: Vec<&'static Output> = Vec::with_capacity(names.len());
        // The answers are in every table.
        for name in names.iter().filter(|name| !ANSWERS.contains(&name.as_str())) {
            let output = Output::named(name).ok_or_else(|| TableError::UnknownOutput {
                name: name.clone(),
                nearest: Output::nearest(name),
            })?;
            if selected.iter().any(|other| other.name == output.name) {
                return Err(TableError::RepeatedColumn { names: [name.clone(), name.clone()] });
            }
            selected.push(output);
        }
        Ok(selected)
    }
}
