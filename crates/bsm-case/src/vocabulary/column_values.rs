//! Values in one column of a list of nuts.

use std::ops::Range;

use serde_json::{Value, json};

/// Values of a column, one per row.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnValues {
    /// Numbers of the column; an empty cell is NaN.
    Numbers(Vec<f64>),
    /// Strings of the column; an empty cell is `None`.
    Texts(Vec<Option<String>>),
}

impl ColumnValues {
    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// Returns true if the column has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the values in a range of rows.
    pub(crate) fn part(self, places: Range<usize>) -> Self {
        match self {
            Self::Numbers(values) => Self::Numbers(values[places].to_vec()),
            Self::Texts(values) => Self::Texts(values[places].to_vec()),
        }
    }

    /// Returns the value in a row as JSON.
    pub(crate) fn json(&self, row: usize) -> Value {
        match self {
            Self::Numbers(values) => json!(values[row]),
            Self::Texts(values) => json!(values[row]),
        }
    }
}
