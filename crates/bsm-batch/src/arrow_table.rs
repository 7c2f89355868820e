//! Answers as Arrow arrays: the columns of a Parquet table, in memory.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array};
use arrow_buffer::NullBuffer;
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use bsm_case::Output;

use crate::rows::{ANSWERS, Answers, Chunk, Columns};
use crate::{Sink, TableError};

/// The columns of a table of answers, units in their metadata.
pub(crate) fn schema(columns: &Columns, outputs: &[&'static Output]) -> SchemaRef {
    let unit = |unit: &str| HashMap::from([("unit".to_owned(), unit.to_owned())]);
    let kept = columns.kept.iter().zip(&columns.kept_types);
    let kept = kept.map(|(name, kind)| Field::new(name, kind.clone(), true));
    let inputs = columns.inputs.iter().map(|key| {
        Field::new(key.name(), DataType::Float64, true).with_metadata(unit(key.input().unit))
    });
    let words = ANSWERS.map(|name| Field::new(name, DataType::Utf8, name == "message"));
    let answers = outputs.iter().map(|output| {
        let kind = match output.json_type {
            "integer" => DataType::UInt64,
            "boolean" => DataType::Boolean,
            "string" => DataType::Utf8,
            _ => DataType::Float64,
        };
        Field::new(output.name, kind, true).with_metadata(unit(output.unit))
    });
    Arc::new(Schema::new(kept.chain(inputs).chain(words).chain(answers).collect::<Vec<_>>()))
}

/// Why rows have no result.
pub(crate) fn messages(answers: &Answers) -> ArrayRef {
    let rows = answers.verdicts.len();
    Arc::new(if answers.messages.is_empty() {
        StringArray::new_null(rows)
    } else {
        (0..rows).map(|row| answers.message(row)).collect()
    })
}

/// Values of an output that are true or false.
pub(crate) fn flags(values: &[f64]) -> ArrayRef {
    let flag = |x: &f64| (!x.is_nan()).then_some(*x > 0.5);
    Arc::new(values.iter().map(flag).collect::<BooleanArray>())
}

/// Answers in memory, a batch for each chunk.
pub(crate) struct ArrowSink {
    pub(crate) schema: SchemaRef,
    pub(crate) batches: Vec<RecordBatch>,
    outputs: Vec<&'static Output>,
}

impl ArrowSink {
    pub(crate) fn new(columns: &Columns, outputs: &[&'static Output]) -> Self {
        let schema = schema(columns, outputs);
        Self { schema, batches: Vec::new(), outputs: outputs.to_vec() }
    }
}

/// Values of an output by its type.
fn values(output: &Output, values: Vec<f64>) -> ArrayRef {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
    let count = |x: &f64| (!x.is_nan()).then_some(*x as u64);
    match output.json_type {
        "integer" => Arc::new(values.iter().map(count).collect::<UInt64Array>()),
        "boolean" => flags(&values),
        "string" => Arc::new(values.iter().map(|x| output.word(*x)).collect::<StringArray>()),
        _ => {
            let given: NullBuffer = values.iter().map(|x| !x.is_nan()).collect();
            let given = Some(given).filter(|given| given.null_count() > 0);
            Arc::new(Float64Array::new(values.into(), given))
        }
    }
}

impl Sink for ArrowSink {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let inputs = chunk.inputs.iter().map(|column| -> ArrayRef {
            let given = column.given().map(NullBuffer::from);
            Arc::new(Float64Array::new(column.values().to_vec().into(), given))
        });
        let verdicts = answers.verdicts.iter();
        let models = StringArray::from_iter_values(verdicts.clone().map(|v| v.model.name()));
        let statuses = StringArray::from_iter_values(verdicts.map(|v| v.status.name()));
        let told: [ArrayRef; 3] = [Arc::new(models), Arc::new(statuses), messages(&answers)];
        let arrays: Vec<_> = chunk.kept.iter().cloned().chain(inputs).chain(told).collect();
        let outputs = self.outputs.iter().zip(answers.columns);
        let outputs = outputs.map(|(output, column)| values(output, column));
        let arrays = arrays.into_iter().chain(outputs).collect();
        self.batches.push(RecordBatch::try_new(self.schema.clone(), arrays)?);
        Ok(())
    }
}
