//! Table columns whose memory is shared between Python, Arrow and this module.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, UInt64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int8Array, Int64Array,
    RecordBatch, RecordBatchIterator, RecordBatchReader, StringArray, TimestampMicrosecondArray,
    UInt64Array, downcast_temporal_array, new_empty_array,
};
use arrow_buffer::{BooleanBuffer, Buffer, NullBuffer, ScalarBuffer};
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use arrow_select::concat::concat;
use bsm_batch::arrow_column;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule};
use pyo3_arrow::buffer::{AnyBufferProtocol, PyArrowBuffer};
use pyo3_arrow::input::AnyRecordBatch;
use serde_json::Value;

use crate::errors::{Error, Result};

/// An array of numbers from Python, which is read without copying.
#[derive(Clone)]
pub(crate) struct NumberArray(pub(crate) ScalarBuffer<f64>);

impl<'py> FromPyObject<'_, 'py> for NumberArray {
    type Error = Error;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> Result<Self> {
        Ok(Self(buffer(&object)?.into()))
    }
}

/// Converts numbers to a buffer that Python can use without copying.
pub(crate) fn shared(values: Vec<f64>) -> PyArrowBuffer {
    PyArrowBuffer::new(Buffer::from_vec(values))
}

/// Rows in memory that can be exported as an Arrow stream.
#[pyclass(frozen, module = "ballscrew._core")]
pub(crate) struct Arrow {
    pub(crate) schema: SchemaRef,
    pub(crate) batches: Vec<RecordBatch>,
}

#[pymethods]
impl Arrow {
    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The Arrow interface permits ignoring a requested schema.
        let _ = requested_schema;
        stream(py, self.schema.clone(), self.batches.clone())
    }
}

/// Returns the batches in the capsule of `__arrow_c_stream__`.
fn stream(
    py: Python<'_>,
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
) -> PyResult<Bound<'_, PyCapsule>> {
    let batches = RecordBatchIterator::new(batches.into_iter().map(Ok), schema);
    // The classes of pyo3-arrow are not used, because their methods would make up a quarter of the
    // compiled module.
    let stream = FFI_ArrowArrayStream::new(Box::new(batches));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

/// A copied column of any type.
#[pyclass(frozen, module = "ballscrew._core")]
pub(crate) struct KeptColumn(pub(crate) ArrayRef);

/// Values of a column for NumPy: either a typed buffer or a list of single values.
#[derive(IntoPyObject)]
pub(crate) enum Values {
    Typed(PyArrowBuffer, &'static str),
    Whole(Vec<Option<i64>>),
    Texts(Vec<Option<String>>),
}

#[pymethods]
impl KeptColumn {
    #[staticmethod]
    fn of_texts(texts: Vec<Option<String>>) -> Self {
        Self(Arc::new(StringArray::from(texts)))
    }

    /// Creates a column from NumPy values and the name of their type.
    #[staticmethod]
    fn of_numbers(values: &Bound<'_, PyAny>, kind: &str) -> Result<Self> {
        let values = buffer(values)?;
        Ok(Self(match kind {
            "int64" => Arc::new(Int64Array::new(values.into(), None)),
            "uint64" => Arc::new(UInt64Array::new(values.into(), None)),
            "bool" => {
                let flags = ScalarBuffer::<u8>::from(values);
                Arc::new(flags.iter().map(|flag| Some(*flag != 0)).collect::<BooleanArray>())
            }
            "datetime64[us]" => {
                let times = ScalarBuffer::<i64>::from(values);
                let given: NullBuffer = times.iter().map(|time| *time != i64::MIN).collect();
                Arc::new(TimestampMicrosecondArray::new(times, Some(given)))
            }
            _ => Arc::new(Float64Array::new(values.into(), None)),
        }))
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Returns the values of the column as a NumPy buffer or list.
    fn values(&self) -> Result<Values> {
        let column = &self.0;
        let is_full = column.null_count() == 0;
        let values = || arrow_column::values(column);
        Ok(match column.data_type() {
            DataType::UInt64 if is_full => {
                let values = column.as_primitive::<UInt64Type>().values().inner().clone();
                Values::Typed(PyArrowBuffer::new(values), "uint64")
            }
            kind if kind.is_integer() => {
                let values: Vec<_> = values()?.iter().map(Value::as_i64).collect();
                if is_full {
                    let values: Vec<i64> = values.into_iter().flatten().collect();
                    Values::Typed(PyArrowBuffer::new(Buffer::from_vec(values)), "int64")
                } else {
                    Values::Whole(values)
                }
            }
            kind if kind.is_floating() => {
                let numbers = arrow_column::numbers(column)?.into_iter();
                Values::Typed(shared(numbers.map(|x| x.unwrap_or(f64::NAN)).collect()), "float64")
            }
            DataType::Boolean if is_full => {
                let flags = column.as_boolean().values().iter().map(u8::from).collect();
                Values::Typed(PyArrowBuffer::new(Buffer::from_vec::<u8>(flags)), "bool")
            }
            DataType::Date32 | DataType::Date64 | DataType::Timestamp(..) => {
                let times: Vec<i64> = downcast_temporal_array!(
                    column => (0..column.len()).map(|row| {
                        let time = if column.is_null(row) { None } else { column.value_as_datetime(row) };
                        time.map_or(i64::MIN, |time| time.and_utc().timestamp_micros())
                    }).collect(),
                    _ => Vec::new(),
                );
                Values::Typed(PyArrowBuffer::new(Buffer::from_vec(times)), "datetime64[us]")
            }
            _ => {
                let text = |value| match value {
                    Value::Null => None,
                    Value::String(text) => Some(text),
                    other => Some(other.to_string()),
                };
                Values::Texts(values()?.into_iter().map(text).collect())
            }
        })
    }

    #[staticmethod]
    fn of_bytes(bytes: &[u8]) -> Result<Self> {
        let mut reader = StreamReader::try_new(bytes, None)?;
        let batch = reader.next().transpose()?;
        let column = batch.map(|batch| batch.column(0).clone());
        column.map(Self).ok_or_else(|| "there is no column".to_owned().into())
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> Result<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let written = || -> Result<Vec<u8>, ArrowError> {
            let batch = RecordBatch::try_from_iter([("kept", self.0.clone())])?;
            let mut writer = StreamWriter::try_new(Vec::new(), &batch.schema())?;
            writer.write(&batch)?;
            writer.into_inner()
        };
        let bytes = PyBytes::new(py, &written()?);
        Ok((py.get_type::<Self>().getattr("of_bytes")?, (bytes,)))
    }
}

/// A data-frame column: either numbers, some of which may be missing, or a column copied unchanged.
#[derive(IntoPyObject)]
pub(crate) enum Read {
    /// Values (NaN if missing), and the indices of the rows without a value.
    Numbers(PyArrowBuffer, Vec<usize>),
    Kept(KeptColumn),
}

/// Reads the columns of any object that exports an Arrow stream. Numbers are converted to doubles.
///
/// * `kept`: names of the columns that are copied.
#[pyfunction]
pub(crate) fn read_arrow(frame: AnyRecordBatch, kept: Vec<String>) -> Result<Vec<(String, Read)>> {
    let reader = frame.into_reader()?;
    let schema = reader.schema();
    let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>()?;
    let column = |(place, field): (usize, &Arc<Field>)| {
        let parts = batches.iter().map(|batch| batch.column(place));
        let name = field.name().clone();
        if kept.contains(&name) {
            let parts: Vec<&dyn Array> = parts.map(AsRef::as_ref).collect();
            let whole = if parts.is_empty() {
                Ok(new_empty_array(field.data_type()))
            } else {
                concat(&parts)
            };
            return Ok((name, Read::Kept(KeptColumn(whole?))));
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
            let numbers = arrow_column::numbers(part).map_err(|_| {
                let found = arrow_column::kind(part.data_type());
                Error::from(format!("column `{name}` holds {found}, not numbers"))
            })?;
            for number in numbers {
                if number.is_none() {
                    gaps.push(values.len());
                }
                values.push(number.unwrap_or(f64::NAN));
            }
        }
        Ok((name, Read::Numbers(shared(values), gaps)))
    };
    schema.fields().iter().enumerate().map(column).collect()
}

/// Exports a table as an Arrow stream in the capsule of `__arrow_c_stream__`. Each column has a
/// name, a unit, a kind, values and texts. NaN becomes null.
///
/// The kinds are `numbers`, `flags` (numbers that are 0 or 1), `words` (indices of texts; a
/// negative index means that the text is missing), `texts` and `kept`.
#[pyfunction]
pub(crate) fn to_arrow<'py>(
    py: Python<'py>,
    columns: Vec<(String, String, String, Bound<'_, PyAny>, Vec<String>)>,
) -> Result<Bound<'py, PyCapsule>> {
    let column = |(name, unit, kind, values, words): (String, _, String, Bound<'_, PyAny>, _)| {
        let array: ArrayRef = match kind.as_str() {
            "words" => {
                let codes: ScalarBuffer<i8> = buffer(&values)?.into();
                let given: NullBuffer = codes.iter().map(|code| *code >= 0).collect();
                let keys = Int8Array::new(codes, Some(given));
                let words: Vec<String> = words;
                let array = DictionaryArray::try_new(keys, Arc::new(StringArray::from(words)));
                Arc::new(array?)
            }
            "texts" => Arc::new(StringArray::from(values.extract::<Vec<Option<String>>>()?)),
            "kept" => values.cast::<KeptColumn>().map_err(PyErr::from)?.get().0.clone(),
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
    let columns: Vec<_> = columns.into_iter().map(column).collect::<Result<_>>()?;
    let (fields, arrays): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(schema.clone(), arrays)?;
    Ok(stream(py, schema, vec![batch])?)
}

/// Returns the memory of a NumPy array without copying it.
fn buffer(array: &Bound<'_, PyAny>) -> Result<Buffer> {
    Ok(array.extract::<AnyBufferProtocol>()?.into_arrow_buffer()?)
}
