//! Errors as exceptions of the package.

use bsm_batch::TableError;
use bsm_case::{CaseError, Known};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The exception for an input that cannot be used.
pub(crate) fn input(error: &CaseError) -> PyErr {
    if error.is_io() {
        return PyOSError::new_err(error.to_string());
    }
    let hint = match error {
        CaseError::Unknown { known, .. } => match known {
            Known::Input => "ballscrew.INPUTS has all names",
            Known::Output => OUTPUTS,
            Known::Requirement => "ballscrew.REQUIREMENTS and ballscrew.INPUTS have all names",
            Known::List | Known::Column => "",
        },
        CaseError::NoRange { .. } => "give where to search: range=(low, high)",
        _ => "",
    };
    let about = About {
        key: error.key(),
        value: error.value(),
        rule: error.rule(),
        nearest: error.nearest(),
        row: error.row().map(|row| row - 1),
    };
    invalid(&error.to_string(), about, hint)
}

/// The exception for a table that cannot be used.
pub(crate) fn table(error: &TableError) -> PyErr {
    let of = |key, nearest| About { key: Some(key), nearest, ..About::default() };
    let (about, hint) = match error {
        TableError::Io(error) => return PyOSError::new_err(error.to_string()),
        TableError::UnknownColumns { names } => {
            let kept: Vec<_> = names.iter().map(|unknown| &unknown.name).collect();
            (
                of(&names[0].name, names[0].nearest),
                format!("leave out, or carry through with keep={kept:?}"),
            )
        }
        TableError::UnknownOutputs { names } => {
            (of(&names[0].name, names[0].nearest), OUTPUTS.to_owned())
        }
        TableError::Column { name, .. } => (of(name, None), String::new()),
        _ => (About::default(), String::new()),
    };
    invalid(&error.to_string(), about, &hint)
}

const OUTPUTS: &str = "ballscrew.OUTPUTS has all names";

/// What an error is about.
#[derive(Default)]
struct About<'a> {
    key: Option<&'a str>,
    value: Option<f64>,
    rule: Option<&'a str>,
    nearest: Option<&'a str>,
    /// From 0.
    row: Option<usize>,
}

/// An `InputError` with its attributes.
fn invalid(message: &str, about: About<'_>, hint: &str) -> PyErr {
    let made = Python::attach(|py| -> PyResult<PyErr> {
        let kind = py.import("ballscrew._errors")?.getattr("InputError")?;
        let named = PyDict::new(py);
        named.set_item("key", about.key)?;
        named.set_item("value", about.value)?;
        named.set_item("rule", about.rule)?;
        named.set_item("nearest", about.nearest)?;
        named.set_item("row", about.row)?;
        let error = kind.call((message,), Some(&named))?;
        if !hint.is_empty() {
            error.call_method1("add_note", (hint,))?;
        }
        Ok(PyErr::from_value(error))
    });
    made.unwrap_or_else(|error| error)
}

/// An error of the package, by its name, with a message alone.
pub(crate) fn named(kind: &str, message: &str) -> PyErr {
    let made = Python::attach(|py| -> PyResult<PyErr> {
        let kind = py.import("ballscrew._errors")?.getattr(kind)?;
        Ok(PyErr::from_value(kind.call1((message,))?))
    });
    made.unwrap_or_else(|error| error)
}

/// An `InputError` with a message alone.
pub(crate) fn from_text(message: &str) -> PyErr {
    invalid(message, About::default(), "")
}
