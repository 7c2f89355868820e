//! Converts Arrow columns to numbers or text.
//!
//! The crate arrow-cast can convert any type to any other type, but compiling it takes longer than
//! compiling all ball models together. This module supports only the few types that occur in
//! tables.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, ArrowTemporalType, Decimal32Type, Decimal64Type, Decimal128Type,
    Decimal256Type, DecimalType, DurationMicrosecondType, DurationMillisecondType,
    DurationNanosecondType, DurationSecondType, Float16Type, Float32Type, Float64Type,
};
use arrow_array::{
    Array, ArrayRef, PrimitiveArray, downcast_integer_array, downcast_temporal_array,
};
use arrow_schema::{ArrowError, DataType, TimeUnit};
use num_traits::ToPrimitive;
use serde_json::{Number, Value};

/// Describes the type of a nonnumeric column for an error message.
pub fn kind(cells: &DataType) -> String {
    match cells {
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => "text".to_owned(),
        other => other.to_string(),
    }
}

/// Returns the numbers of a column, with `None` for null cells.
///
/// # Errors
///
/// Returns [`ArrowError::CastError`] if the type of the column is not numeric.
pub fn numbers(column: &ArrayRef) -> Result<Vec<Option<f64>>, ArrowError> {
    fn plain<T: ArrowPrimitiveType<Native: ToPrimitive>>(
        values: &PrimitiveArray<T>,
    ) -> Vec<Option<f64>> {
        values.iter().map(|x| x.and_then(|x| x.to_f64())).collect()
    }
    /// Converts each decimal number to the nearest 64-bit floating-point number. Dividing the
    /// digits by the scale factor would not always give the nearest number, because both the digits
    /// and the quotient would be rounded.
    fn decimal<T: DecimalType + ArrowPrimitiveType>(
        column: &ArrayRef,
    ) -> Result<Vec<Option<f64>>, ArrowError> {
        let column = column.as_primitive::<T>();
        let number = |row: usize| {
            let digits = column.is_valid(row).then(|| column.value_as_string(row));
            digits.map(|digits| digits.parse()).transpose().map_err(|_| {
                ArrowError::CastError(format!("row {} does not contain a number", row + 1))
            })
        };
        (0..column.len()).map(number).collect()
    }
    Ok(downcast_integer_array!(
        column => plain(column),
        DataType::Float16 => plain(column.as_primitive::<Float16Type>()),
        DataType::Float32 => plain(column.as_primitive::<Float32Type>()),
        DataType::Float64 => plain(column.as_primitive::<Float64Type>()),
        DataType::Decimal32(..) => decimal::<Decimal32Type>(column)?,
        DataType::Decimal64(..) => decimal::<Decimal64Type>(column)?,
        DataType::Decimal128(..) => decimal::<Decimal128Type>(column)?,
        DataType::Decimal256(..) => decimal::<Decimal256Type>(column)?,
        DataType::Null => vec![None; column.len()],
        other => return Err(ArrowError::CastError(format!("{other} does not contain numbers"))),
    ))
}

/// Returns the values of a column as a text file would contain them: numbers, booleans and nulls
/// are unchanged, and all other values are converted to text.
///
/// # Errors
///
/// Returns [`ArrowError::CastError`] if the type has no text representation.
pub fn values(column: &ArrayRef) -> Result<Vec<Value>, ArrowError> {
    fn texts<T: ToString>(texts: impl Iterator<Item = Option<T>>) -> Vec<Value> {
        texts.map(|text| text.map_or(Value::Null, |text| Value::String(text.to_string()))).collect()
    }
    /// Converts each number to the 64-bit number with the same shortest decimal representation, so
    /// that 32-bit numbers do not get additional digits.
    fn short<T: ArrowPrimitiveType<Native: ToString>>(column: &ArrayRef) -> Vec<Value> {
        let number = |x: T::Native| x.to_string().parse::<f64>().map_or(Value::Null, Value::from);
        column.as_primitive::<T>().iter().map(|x| x.map_or(Value::Null, number)).collect()
    }
    fn decimal<T: DecimalType + ArrowPrimitiveType>(column: &ArrayRef) -> Vec<Value> {
        let column = column.as_primitive::<T>();
        texts((0..column.len()).map(|i| column.is_valid(i).then(|| column.value_as_string(i))))
    }
    fn durations<T: ArrowTemporalType<Native = i64>>(column: &ArrayRef) -> Vec<Value> {
        let column = column.as_primitive::<T>();
        let text = |i| if column.is_null(i) { None } else { column.value_as_duration(i) };
        texts((0..column.len()).map(text))
    }
    /// Converts byte strings to text. The bytes must be valid UTF-8.
    fn bytes<'a>(bytes: impl Iterator<Item = Option<&'a [u8]>>) -> Result<Vec<Value>, ArrowError> {
        let text = |bytes: Option<&'a [u8]>| bytes.map(std::str::from_utf8).transpose();
        let found: Vec<_> = bytes.map(text).collect::<Result<_, _>>().map_err(|_| {
            let what = "bytes that are not UTF-8 text; write a Parquet file to keep these bytes";
            ArrowError::CastError(what.to_owned())
        })?;
        Ok(texts(found.into_iter()))
    }
    Ok(match column.data_type() {
        DataType::Null => vec![Value::Null; column.len()],
        DataType::Boolean => {
            column.as_boolean().iter().map(|x| x.map_or(Value::Null, Value::Bool)).collect()
        }
        DataType::Float16 => short::<Float16Type>(column),
        DataType::Float32 => short::<Float32Type>(column),
        DataType::Float64 => short::<Float64Type>(column),
        DataType::Decimal32(..) => decimal::<Decimal32Type>(column),
        DataType::Decimal64(..) => decimal::<Decimal64Type>(column),
        DataType::Decimal128(..) => decimal::<Decimal128Type>(column),
        DataType::Decimal256(..) => decimal::<Decimal256Type>(column),
        DataType::Utf8 => texts(column.as_string::<i32>().iter()),
        DataType::LargeUtf8 => texts(column.as_string::<i64>().iter()),
        DataType::Utf8View => texts(column.as_string_view().iter()),
        DataType::Binary => bytes(column.as_binary::<i32>().iter())?,
        DataType::LargeBinary => bytes(column.as_binary::<i64>().iter())?,
        DataType::BinaryView => bytes(column.as_binary_view().iter())?,
        DataType::Duration(TimeUnit::Second) => durations::<DurationSecondType>(column),
        DataType::Duration(TimeUnit::Millisecond) => durations::<DurationMillisecondType>(column),
        DataType::Duration(TimeUnit::Microsecond) => durations::<DurationMicrosecondType>(column),
        DataType::Duration(TimeUnit::Nanosecond) => durations::<DurationNanosecondType>(column),
        DataType::Dictionary(..) => {
            let column = column.as_any_dictionary();
            let words = values(column.values())?;
            let word = |(i, key): (usize, &usize)| {
                if column.is_null(i) { Value::Null } else { words[*key].clone() }
            };
            column.normalized_keys().iter().enumerate().map(word).collect()
        }
        other => downcast_temporal_array!(
            column => texts((0..column.len()).map(|i| match other {
                _ if column.is_null(i) => None,
                DataType::Date32 => Some(format!("{:?}", column.value_as_date(i)?)),
                DataType::Time32(_) | DataType::Time64(_) => {
                    Some(format!("{:?}", column.value_as_time(i)?))
                }
                DataType::Timestamp(_, Some(_)) => {
                    Some(format!("{:?}Z", column.value_as_datetime(i)?))
                }
                _ => Some(format!("{:?}", column.value_as_datetime(i)?)),
            })),
            _ => downcast_integer_array!(
                column => {
                    let number = |x| Number::from_i128(x).map_or(Value::Null, Value::Number);
                    column.iter().map(|x| x.map_or(Value::Null, |x| number(x.into()))).collect()
                }
                other => return Err(ArrowError::CastError(format!("{other} has no text form"))),
            ),
        ),
    })
}
