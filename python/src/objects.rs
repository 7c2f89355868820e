//! Conversion between Python objects and the JSON values of the program.

use bsm_case::{Case, CaseError, json_value_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::{Depythonizer, pythonize};
use serde_json::Value;

use crate::errors::{Error, Result};

/// A JSON value that is converted to a Python object with the same structure.
pub(crate) struct Object(pub(crate) Value);

impl<'py> IntoPyObject<'py> for Object {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.0)?)
    }
}

/// Members of a JSON object, read from a Python dict in the order of the dict.
pub(crate) struct Entries(pub(crate) Vec<(String, Value)>);

impl<'py> FromPyObject<'_, 'py> for Entries {
    type Error = Error;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> Result<Self> {
        let entry = |(key, value): (Bound<'py, PyAny>, Bound<'py, PyAny>)| -> Result<_> {
            let key: String = key.extract()?;
            let value = value_of(&key, &value)?;
            Ok((key, value))
        };
        let entries = object.cast::<PyDict>().map_err(PyErr::from)?.iter();
        entries.map(entry).collect::<Result<_>>().map(Self)
    }
}

/// Converts the value of a key to JSON. NumPy arrays and scalars are converted to lists and
/// numbers.
pub(crate) fn value_of(key: &str, value: &Bound<'_, PyAny>) -> Result<Value> {
    let plain =
        if value.hasattr("tolist")? { value.call_method0("tolist")? } else { value.clone() };
    json_value_of(&mut Depythonizer::from_object(&plain)).map_err(|error| {
        let what = format!("`{key}`: {error}");
        CaseError::Entry { key: key.to_owned(), what }.into()
    })
}

/// Converts the JSON object of a case to a case.
pub(crate) fn case_of(json: Value) -> Result<Case, CaseError> {
    match json {
        Value::Object(entries) => Case::from_entries(entries),
        other => {
            Err(CaseError::Invalid(format!("{other} is not a case; a case must be a JSON object")))
        }
    }
}
