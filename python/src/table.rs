//! Columns that Python and Arrow share.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::Float64Type;
use arrow_array::{
    Array, ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int8Array, RecordBatch,
    RecordBatchIterator, RecordBatchReader, StringArray,
};
use arrow_buffer::{BooleanBuffer, Buffer, NullBuffer, ScalarBuffer};
use arrow_cast::cast;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use pyo3_arrow::buffer::{AnyBufferProtocol, PyArrowBuffer};
use pyo3_arrow::input::AnyRecordBatch;

use crate::errors;

/// Numbers of Python, read in place.
#[derive(Clone)]
pub(crate) struct Numbers(pub(crate) ScalarBuffer<f64>);

impl<'py> FromPyObject<'_, 'py> for Numbers {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(buffer(&object)?.into()))
    }
}

/// Numbers for Python, not copied.
pub(crate) fn shared(values: Vec<f64>) -> PyArrowBuffer {
    PyArrowBuffer::new(Buffer::from_vec(values))
}

/// A column of a frame: numbers with their gaps, or texts.
#[derive(IntoPyObject)]
pub(crate) enum Read {
    /// Values, NaN in the gaps, and which rows have none.
    Numbers(PyArrowBuffer, Vec<usize>),
    Texts(Vec<Option<String>>),
}

/// The columns of anything that gives an Arrow stream: numbers as doubles, all else as texts.
///
/// * `texts`: columns that are carried through.
#[pyfunction]
pub(crate) fn read_arrow(
    frame: AnyRecordBatch,
    texts: Vec<String>,
) -> PyResult<Vec<(String, Read)>> {
    let reader = frame.into_reader()?;
    let schema = reader.schema();
    let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>().map_err(refused)?;
    let column = |(place, field): (usize, &Arc<Field>)| {
        let parts = batches.iter().map(|batch| batch.column(place));
        let name = field.name().clone();
        if texts.contains(&name) {
            let mut column = Vec::new();
            for part in parts {
                let part = cast(part, &DataType::Utf8).map_err(refused)?;
                let part = part.as_string::<i32>();
                column.extend(part.iter().map(|text| text.map(str::to_owned)));
            }
            return Ok((name, Read::Texts(column)));
        }
        if let [batch] = &batches[..]
            && let Some(whole) = batch.column(place).as_primitive_opt::<Float64Type>()
            && whole.null_count() == 0
        {
            let shared = PyArrowBuffer::new(whole.values().inner().clone());
            return Ok((name, Read::Numbers(shared, Vec::new())));
        }
        let (mut values, mut gaps) = (Vec::new(), Vec::new());
        for part in parts {
            let numeric = part.data_type().is_numeric() || *part.data_type() == DataType::Null;
            if !numeric {
                let text = format!("column `{name}` holds {}, not numbers", part.data_type());
                return Err(errors::words(&text));
            }
            let part = cast(part, &DataType::Float64).map_err(refused)?;
            let part = part.as_primitive::<Float64Type>();
            let first = values.len();
            values.extend_from_slice(part.values());
            if let Some(nulls) = part.nulls() {
                for row in (0..part.len()).filter(|row| nulls.is_null(*row)) {
                    values[first + row] = f64::NAN;
                    gaps.push(first + row);
                }
            }
        }
        Ok((name, Read::Numbers(shared(values), gaps)))
    };
    schema.fields().iter().enumerate().map(column).collect()
}

/// A table as an Arrow stream, in the capsule of `__arrow_c_stream__`: name, unit, kind, values and words of each column; NaN is null.
///
/// The kinds: `numbers`; `flags`, numbers that are 0 or 1; `words`, places in the words, negative for none;
/// `texts`.
#[pyfunction]
pub(crate) fn to_arrow<'py>(
    py: Python<'py>,
    columns: Vec<(String, String, String, Bound<'_, PyAny>, Vec<String>)>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let column = |(name, unit, kind, values, words): (String, _, String, Bound<'_, PyAny>, _)| {
        let array: ArrayRef = match kind.as_str() {
            "words" => {
                let codes: ScalarBuffer<i8> = buffer(&values)?.into();
                let given: NullBuffer = codes.iter().map(|code| *code >= 0).collect();
                let keys = Int8Array::new(codes, Some(given));
                let words: Vec<String> = words;
                let array = DictionaryArray::try_new(keys, Arc::new(StringArray::from(words)));
                Arc::new(array.map_err(refused)?)
            }
            "texts" => Arc::new(StringArray::from(values.extract::<Vec<Option<String>>>()?)),
            kind => {
                let numbers: ScalarBuffer<f64> = buffer(&values)?.into();
                let given: NullBuffer = numbers.iter().map(|number| !number.is_nan()).collect();
                if kind == "flags" {
                    let flags: BooleanBuffer = numbers.iter().map(|number| *number > 0.5).collect();
                    Arc::new(BooleanArray::new(flags, Some(given)))
                } else {
                    let given = (given.null_count() > 0).then_some(given);
                    Arc::new(Float64Array::new(numbers, given))
                }
            }
        };
        let field = Field::new(name, array.data_type().clone(), true);
        let unit: String = unit;
        Ok((field.with_metadata(HashMap::from([("unit".to_owned(), unit)])), array))
    };
    let columns: Vec<_> = columns.into_iter().map(column).collect::<PyResult<_>>()?;
    let (fields, arrays): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(schema.clone(), arrays).map_err(refused)?;
    let batches = RecordBatchIterator::new([Ok(batch)], schema);
    // Not by pyo3-arrow's classes: their methods are a quarter of the module, and nobody calls them.
    let stream = FFI_ArrowArrayStream::new(Box::new(batches));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

/// The memory of an array, not copied.
fn buffer(array: &Bound<'_, PyAny>) -> PyResult<Buffer> {
    Ok(array.extract::<AnyBufferProtocol>()?.into_arrow_buffer()?)
}

/// What Arrow does not take.
fn refused(error: ArrowError) -> PyErr {
    errors::words(&error.to_string())
}
