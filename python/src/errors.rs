//! Converts errors of the program to exceptions of the package.

use std::fmt::Display;
use std::io;

use arrow_schema::ArrowError;
use bsm_batch::TableError;
use bsm_batch::dataset::DatasetError;
use bsm_case::{CaseError, NameKind};
use bsm_report::ReportError;
use bsm_validate::ValidateError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pyo3_arrow::error::PyArrowError;

/// A Python exception. All errors of the program are converted to this type.
pub(crate) struct Error(PyErr);

/// Return type of the functions that can be called from Python.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

impl From<Error> for PyErr {
    fn from(Error(error): Error) -> Self {
        error
    }
}

macro_rules! becomes {
    ($($error:ty: $exception:expr;)*) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Self($exception(error))
            }
        })*
    };
}

becomes! {
    PyErr: |error| error;
    PyArrowError: PyErr::from;
    io::Error: PyErr::from;
    CaseError: |error| input(&error);
    &CaseError: input;
    TableError: |error| table(&error);
    DatasetError: folder;
    // A message without further attributes becomes an `InputError`.
    String: |message: String| invalid(&message, &About::default(), "");
    ArrowError: of_text;
    ReportError: of_text;
    ValidateError: of_text;
}

fn of_text(error: impl Display) -> PyErr {
    Error::from(error.to_string()).into()
}

/// Creates the exception for an error in the folder of a dataset that is solved in parts.
fn folder(error: DatasetError) -> PyErr {
    match error {
        DatasetError::Io { .. } | DatasetError::Thread(_) => PyOSError::new_err(error.to_string()),
        DatasetError::Read(error) | DatasetError::Write { error, .. } => table(&error),
        DatasetError::Damaged(_) | DatasetError::NotOfThePlan(_) => {
            made("PartError", |_, kind| kind.call1((error.to_string(),)))
        }
        _ => of_text(error),
    }
}

/// Creates the exception for an invalid input.
fn input(error: &CaseError) -> PyErr {
    if error.is_io() {
        return PyOSError::new_err(error.to_string());
    }
    let hint = match error {
        CaseError::Unknown { kind, .. } => match kind {
            NameKind::Input => "ballscrew.INPUTS contains all names",
            NameKind::Output => OUTPUTS,
            NameKind::Requirement => {
                "ballscrew.REQUIREMENTS and ballscrew.INPUTS contain all names"
            }
            NameKind::List | NameKind::Column | NameKind::TableColumn => "",
        },
        CaseError::NoRange { .. } => "give the search range: inputs={name: (low, high)}",
        _ => "",
    };
    let about = About {
        key: error.key(),
        value: error.value(),
        rule: error.rule(),
        nearest: error.nearest(),
        row: error.row().map(|row| row - 1),
    };
    invalid(&error.to_string(), &about, hint)
}

/// Creates the exception for an invalid table.
fn table(error: &TableError) -> PyErr {
    let of = |key, nearest| About { key: Some(key), nearest, ..About::default() };
    let (about, hint) = match error {
        TableError::Io(error) => return PyOSError::new_err(error.to_string()),
        TableError::UnknownColumns { names } => {
            let kept: Vec<_> = names.iter().map(|unknown| &unknown.name).collect();
            (
                of(&names[0].name, names[0].nearest),
                format!("omit it, or copy it with keep={kept:?}"),
            )
        }
        TableError::UnknownOutputs { names } => {
            (of(&names[0].name, names[0].nearest), OUTPUTS.to_owned())
        }
        TableError::Column { name, .. } => (of(name, None), String::new()),
        _ => (About::default(), String::new()),
    };
    invalid(&error.to_string(), &about, &hint)
}

const OUTPUTS: &str = "ballscrew.OUTPUTS contains all names";

/// Attributes of an `InputError`.
#[derive(Default)]
struct About<'a> {
    key: Option<&'a str>,
    value: Option<f64>,
    rule: Option<&'a str>,
    nearest: Option<&'a str>,
    /// Index of the invalid row, counted from 0.
    row: Option<usize>,
}

/// Creates an `InputError` with the given message and attributes.
fn invalid(message: &str, about: &About<'_>, hint: &str) -> PyErr {
    made("InputError", |py, kind| {
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
        Ok(error)
    })
}

/// Creates an exception of the class with the given name in `ballscrew._errors`.
fn made(
    kind: &str,
    make: impl for<'py> FnOnce(Python<'py>, Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>>,
) -> PyErr {
    let made = Python::attach(|py| {
        let kind = py.import("ballscrew._errors")?.getattr(kind)?;
        make(py, kind).map(PyErr::from_value)
    });
    made.unwrap_or_else(|error| error)
}
