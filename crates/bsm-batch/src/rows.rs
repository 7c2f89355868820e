//! Rows in memory: a chunk of them by columns, and their answers.

use bsm_case::{INPUTS, OUTPUTS, Output, Record, nearest_input};

use crate::TableError;

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

/// What the columns of a table are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Inputs, in the order of the table.
    pub inputs: Vec<&'static str>,
    /// Places of the inputs in the table.
    pub(crate) input_places: Vec<usize>,
    /// Columns that are carried through as text.
    pub kept: Vec<String>,
    pub(crate) kept_places: Vec<usize>,
}

impl Columns {
    /// Sorts the names of a table into inputs and columns to keep.
    ///
    /// # Errors
    ///
    /// [`TableError`] for a name that is neither, that stands twice, or that is to be kept but is
    /// not there.
    pub fn sort<'a>(
        names: impl IntoIterator<Item = &'a str>,
        keep: &[String],
    ) -> Result<Self, TableError> {
        let mut columns = Self::default();
        for (place, name) in names.into_iter().enumerate() {
            let name = name.trim();
            let seen = columns.inputs.contains(&name) || columns.kept.iter().any(|k| k == name);
            if seen {
                return Err(TableError::RepeatedColumn { name: name.to_owned() });
            }
            if keep.iter().any(|kept| kept == name) {
                columns.kept.push(name.to_owned());
                columns.kept_places.push(place);
            } else if let Some(input) = INPUTS.iter().find(|input| input.name == name) {
                columns.inputs.push(input.name);
                columns.input_places.push(place);
            } else {
                let nearest = nearest_input(name).map(str::to_owned);
                return Err(TableError::UnknownColumn { name: name.to_owned(), nearest });
            }
        }
        match keep.iter().find(|name| !columns.kept.contains(name)) {
            Some(name) => Err(TableError::NothingToKeep { name: name.clone() }),
            None => Ok(columns),
        }
    }
}

/// Some rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// Number of the first row, from 1.
    pub first: u64,
    /// Number of rows.
    pub len: usize,
    /// Values of each input, by column.
    pub inputs: Vec<Vec<Cell>>,
    /// Values of each column that is carried through.
    pub kept: Vec<Vec<String>>,
}

impl Chunk {
    /// A chunk without rows.
    pub(crate) fn empty(first: u64, columns: &Columns, rows: usize) -> Self {
        Self {
            first,
            len: 0,
            inputs: vec![Vec::with_capacity(rows); columns.inputs.len()],
            kept: vec![Vec::with_capacity(rows); columns.kept.len()],
        }
    }

    pub(crate) fn filled(self) -> Option<Self> {
        (self.len > 0).then_some(self)
    }
}

/// The answers of a chunk, and which of their columns are wanted.
#[derive(Clone, Copy)]
pub struct Answers<'a> {
    /// One for each row.
    pub records: &'a [Record],
    /// Outputs to write.
    pub outputs: &'a [&'static Output],
}

impl Answers<'_> {
    /// All outputs, or those of a selection, in its order.
    ///
    /// # Errors
    ///
    /// [`TableError::UnknownOutput`].
    pub fn select(names: Option<&[String]>) -> Result<Vec<&'static Output>, TableError> {
        let Some(names) = names else { return Ok(OUTPUTS.iter().collect()) };
        names
            .iter()
            .map(|name| {
                Output::named(name).ok_or_else(|| TableError::UnknownOutput { name: name.clone() })
            })
            .collect()
    }
}
