//! Errors as exceptions of the package.

use bsm_batch::{RunError, TableError};
use bsm_case::CaseError;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The exception for an input that cannot be used.
pub(crate) fn input(error: &CaseError) -> PyErr {
    if error.is_io() {
        return PyOSError::new_err(error.to_string());
    }
    let (value, nearest) = (error.value(), error.nearest().map(str::to_owned));
    invalid(&error.to_string(), error.key(), value, error.rule(), nearest, None)
}

/// The exception for a table that cannot be used.
pub(crate) fn table(error: &TableError) -> PyErr {
    match error {
        TableError::Io(error) => PyOSError::new_err(error.to_string()),
        TableError::UnknownColumn { name, nearest } => {
            let text =
                nearest.as_ref().map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
            let text = format!("column `{name}` is no input{text}");
            invalid(&text, Some(name), None, None, nearest.clone(), None)
        }
        TableError::UnknownOutput { name, nearest } => {
            let text = nearest.map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
            let text = format!("no output is named `{name}`{text}");
            invalid(&text, Some(name), None, None, nearest.map(str::to_owned), None)
        }
        other => invalid(&other.to_string(), None, None, None, None, None),
    }
}

/// The exception for a run that did not come to its end.
pub(crate) fn run(error: &RunError) -> PyErr {
    match error {
        RunError::Read(error) | RunError::Write(error) => table(error),
        RunError::Thread(error) => PyOSError::new_err(error.to_string()),
        RunError::Stopped => PyRuntimeError::new_err("stopped"),
    }
}

/// An `InputError` with its attributes.
fn invalid(
    message: &str,
    key: Option<&str>,
    value: Option<f64>,
    rule: Option<&str>,
    nearest: Option<String>,
    row: Option<u64>,
) -> PyErr {
    let made = Python::attach(|py| -> PyResult<PyErr> {
        let kind = py.import("ballscrew._errors")?.getattr("InputError")?;
        let about = PyDict::new(py);
        about.set_item("key", key)?;
        about.set_item("value", value)?;
        about.set_item("rule", rule)?;
        about.set_item("nearest", nearest)?;
        about.set_item("row", row)?;
        Ok(PyErr::from_value(kind.call((message,), Some(&about))?))
    });
    made.unwrap_or_else(|error| error)
}

/// An `InputError` with words alone.
pub(crate) fn words(message: &str) -> PyErr {
    invalid(message, None, None, None, None, None)
}
