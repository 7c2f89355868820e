//! The format of a user's table.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Signs of a table of text, and names of its columns.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableFormat {
    /// Separator of cells, in ASCII.
    pub delimiter: char,
    /// The decimal sign.
    pub decimal: char,
    /// Names in the vocabulary of columns that have another one; `None` for a column that is not read.
    pub names: BTreeMap<String, Option<String>>,
}

impl Default for TableFormat {
    fn default() -> Self {
        Self { delimiter: ',', decimal: '.', names: BTreeMap::new() }
    }
}

impl TableFormat {
    /// True if the table is written as ours are.
    pub fn is_ours(&self) -> bool {
        *self == Self::default()
    }

    /// The name of a column in the vocabulary; `None` if it is not read.
    pub fn name<'a>(&'a self, own: &'a str) -> Option<&'a str> {
        match self.names.get(own) {
            Some(name) => name.as_deref(),
            None => Some(own),
        }
    }
}
