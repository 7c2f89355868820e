//! Tests of the conversion of Arrow columns to numbers and text.

use std::sync::Arc;

use arrow_array::types::Int8Type;
use arrow_array::{
    Array, ArrayRef, BinaryArray, BooleanArray, Date32Array, Decimal128Array, Decimal256Array,
    DictionaryArray, DurationMillisecondArray, Float32Array, Int32Array, NullArray,
    StringViewArray, Time64MicrosecondArray, TimestampMillisecondArray, UInt64Array,
};
use arrow_buffer::i256;
use bsm_batch::arrow_column::{numbers, values};
use serde_json::{Value, json};

fn column_as_json(column: impl Array + 'static) -> Value {
    Value::Array(values(&(Arc::new(column) as ArrayRef)).expect("has a text"))
}

/// For each type, the values must be the same as in a text file, and nulls must remain nulls.
#[test]
fn column_values_match_the_values_in_a_text_file() {
    let decimals = Decimal128Array::from(vec![Some(-12_345), None]).with_precision_and_scale(9, 3);
    let decimals = decimals.expect("digits");
    let days: DictionaryArray<Int8Type> = [Some("Mon"), None, Some("Mon")].into_iter().collect();
    // The timestamp represents 2026-11-24, 18:30:00.5.
    let time = TimestampMillisecondArray::from(vec![1_795_545_000_500]);
    for (found, expected) in [
        (column_as_json(Int32Array::from(vec![Some(-7), None])), json!([-7, null])),
        (column_as_json(UInt64Array::from(vec![u64::MAX])), json!([u64::MAX])),
        (column_as_json(Float32Array::from(vec![0.1, f32::NAN])), json!([0.1, null])),
        (column_as_json(BooleanArray::from(vec![Some(true), None])), json!([true, null])),
        (column_as_json(NullArray::new(1)), json!([null])),
        (column_as_json(StringViewArray::from(vec![Some("a"), None])), json!(["a", null])),
        (column_as_json(BinaryArray::from(vec![Some(&b"ab"[..]), None])), json!(["ab", null])),
        (column_as_json(decimals.clone()), json!(["-12.345", null])),
        (column_as_json(days), json!(["Mon", null, "Mon"])),
        (column_as_json(Date32Array::from(vec![20_781])), json!(["2026-11-24"])),
        (column_as_json(Time64MicrosecondArray::from(vec![66_600_000_000])), json!(["18:30:00"])),
        (
            column_as_json(DurationMillisecondArray::from(vec![Some(1500), None])),
            json!(["PT1.5S", null]),
        ),
        (column_as_json(time.clone()), json!(["2026-11-24T18:30:00.500"])),
        (column_as_json(time.with_timezone("UTC")), json!(["2026-11-24T18:30:00.500Z"])),
    ] {
        assert_eq!(found, expected);
    }
    let column: ArrayRef = Arc::new(decimals);
    assert_eq!(numbers(&column).expect("numbers"), [Some(-12.345), None]);
    let column: ArrayRef = Arc::new(BooleanArray::from(vec![true]));
    assert!(
        numbers(&column).is_err_and(|error| error.to_string().contains("does not contain numbers"))
    );
}

/// In an earlier version, bytes that are not UTF-8 became empty cells.
#[test]
fn bytes_that_are_not_utf8_are_rejected() {
    let column: ArrayRef = Arc::new(BinaryArray::from(vec![&b"ab"[..], b"\xff"]));
    assert!(values(&column).is_err_and(|error| error.to_string().contains("not UTF-8 text")));
}

/// In an earlier version, 0.1 with 40 decimal places was read as 0.09999999999999999, because its
/// digits and its scale factor were rounded before the division.
#[test]
fn decimals_are_read_as_the_nearest_double() {
    let digits = i256::from_i128(10).checked_pow(39).expect("39 digits");
    let column = Decimal256Array::from(vec![digits]).with_precision_and_scale(76, 40);
    let column: ArrayRef = Arc::new(column.expect("76 digits"));
    assert_eq!(numbers(&column).expect("numbers"), [Some(0.1)]);
}
