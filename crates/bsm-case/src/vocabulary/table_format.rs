//! Format of a table that a user provides.

use std::collections::BTreeMap;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

/// Delimiter, decimal sign and column names of a text table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableFormat {
    /// Delimiter between cells, which must be an ASCII character.
    #[serde(deserialize_with = "ascii")]
    pub delimiter: char,
    /// Decimal sign, which must be an ASCII character.
    #[serde(deserialize_with = "ascii")]
    pub decimal: char,
    /// Map from column names of the table to names of inputs, or to `None` for columns that are
    /// ignored.
    pub names: BTreeMap<String, Option<String>>,
}

/// Reads an ASCII character.
fn ascii<'de, D: Deserializer<'de>>(deserializer: D) -> Result<char, D::Error> {
    let sign = char::deserialize(deserializer)?;
    if sign.is_ascii() {
        Ok(sign)
    } else {
        Err(D::Error::custom(format!("`{sign}` is not an ASCII character")))
    }
}

impl Default for TableFormat {
    fn default() -> Self {
        Self { delimiter: ',', decimal: '.', names: BTreeMap::new() }
    }
}

impl TableFormat {
    /// Returns true if the table has the program's default format.
    pub fn is_standard(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the name of the input in a column, or `None` if the column is ignored. Names that
    /// are not in the map are returned unchanged.
    pub fn input_of<'a>(&'a self, own: &'a str) -> Option<&'a str> {
        match self.names.get(own) {
            Some(name) => name.as_deref(),
            None => Some(own),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_a_delimiter_that_is_not_ascii() {
        let read = |delimiter: char| {
            let text = format!(r#"{{"delimiter": "{delimiter}", "decimal": ",", "names": {{}}}}"#);
            serde_json::from_str::<TableFormat>(&text)
        };
        assert_eq!(read(';').expect("valid").delimiter, ';');
        let error = read('→').expect_err("no byte is equal to this character").to_string();
        assert!(error.starts_with("`→` is not an ASCII character"), "{error}");
    }
}
