//! Statistics in place of rows: a few kB a part, merged in the order of the parts.
//!
//! A part holds what its rows add up to, in a form that can be added up further: counts, least and greatest
//! values, sums with what rounding took from them, bins that do not depend on the rows, and the outermost
//! rows. Rows are taken in their order on one thread, and parts in theirs, so that the result depends on
//! the plan only.

mod tally;
mod words;

use std::collections::HashMap;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt64Type};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array};
use bsm_case::{InputKey, Output};
use bsm_dyn::Status;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::writer::SerializedFileWriter;

pub use self::words::{Reduction, Statistic};

use self::tally::{Ends, Outer, Tally, bin, bin_of, edges};
use crate::parquet_table::{decoded, properties};
use crate::{Answers, Chunk, Columns, Sink, TableError};

/// Most groups of a result: all of them are in memory.
const MOST_GROUPS: usize = 100_000;

/// A group of rows.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    /// Values of the inputs that it goes by, NaN where none is given.
    key: Vec<f64>,
    rows: u64,
    failed: u64,
    tallies: Vec<Tally>,
}

/// Groups of rows and what they add up to, in the order in which they appear.
#[derive(Debug)]
pub(super) struct Reduced {
    reduction: Reduction,
    inputs: Vec<InputKey>,
    /// Places of the inputs that groups go by.
    by: Vec<usize>,
    /// Those that are numbers, with their places among the answers.
    outputs: Vec<(usize, &'static Output)>,
    groups: Vec<Group>,
    places: HashMap<Vec<u64>, usize>,
}

/// Columns of the table after the inputs.
const OUTPUT: &str = "output";
const STATISTIC: &str = "statistic";
const LOW: &str = "low";
const HIGH: &str = "high";
const ROW: &str = "row";
const VALUE: &str = "value";
const COUNT: &str = "count";

impl Reduced {
    /// No rows yet.
    ///
    /// # Errors
    ///
    /// [`TableError::NothingToGroupBy`] if the points do not have an input.
    pub(super) fn new(
        reduction: &Reduction,
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> Result<Self, TableError> {
        let place = |key: &InputKey| {
            let found = columns.inputs.iter().position(|other| other == key);
            found.ok_or_else(|| TableError::NothingToGroupBy { name: key.name().to_owned() })
        };
        let by = reduction.by.iter().map(place).collect::<Result<_, _>>()?;
        let numbers = outputs.iter().copied().enumerate();
        let outputs = numbers.filter(|(_, output)| output.json_type != "string").collect();
        let (reduction, inputs) = (reduction.clone(), columns.inputs.clone());
        let (groups, places) = (Vec::new(), HashMap::new());
        Ok(Self { reduction, inputs, by, outputs, groups, places })
    }

    /// Place of the group of these values.
    fn group(&mut self, key: &[f64]) -> Result<usize, TableError> {
        let bits = |x: &f64| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() };
        let bits: Vec<_> = key.iter().map(bits).collect();
        if let Some(place) = self.places.get(&bits) {
            return Ok(*place);
        }
        let place = self.groups.len();
        if place == MOST_GROUPS {
            return Err(TableError::TooManyGroups { most: MOST_GROUPS });
        }
        let tallies = vec![Tally::new(); self.outputs.len()];
        self.groups.push(Group { key: key.to_owned(), rows: 0, failed: 0, tallies });
        self.places.insert(bits, place);
        Ok(place)
    }

    /// Adds the groups of a later part.
    fn merge(&mut self, other: Self) -> Result<(), TableError> {
        let most = self.reduction.outermost();
        for from in other.groups {
            let place = self.group(&from.key)?;
            let to = &mut self.groups[place];
            to.rows += from.rows;
            to.failed += from.failed;
            for (to, from) in to.tallies.iter_mut().zip(from.tallies) {
                to.values += from.values;
                to.min = to.min.min(from.min);
                to.max = to.max.max(from.max);
                to.sum.merge(from.sum);
                for (bin, count) in from.bins {
                    *to.bins.entry(bin).or_default() += count;
                }
                let Ends { lowest, highest } = from.ends;
                let both = |list: &mut Vec<Outer>, later: Vec<Outer>, order: f64| {
                    list.extend(later);
                    // Stable: of equal values the earlier part stays first.
                    list.sort_by(|a, b| (order * a.value).total_cmp(&(order * b.value)));
                    list.truncate(most);
                };
                both(&mut to.ends.lowest, lowest, 1.0);
                both(&mut to.ends.highest, highest, -1.0);
            }
        }
        Ok(())
    }

    /// The groups as a table.
    ///
    /// * `is_whole`: with means in place of sums, which could be added up further.
    fn table(&self, is_whole: bool) -> Result<RecordBatch, TableError> {
        let mut rows = Lines::new(self.inputs.len());
        for group in &self.groups {
            let mut inputs = vec![None; self.inputs.len()];
            for (place, value) in self.by.iter().zip(&group.key) {
                inputs[*place] = Some(*value).filter(|x| !x.is_nan());
            }
            let line = Line { inputs: &inputs, ..Line::default() };
            rows.push(Line { statistic: "rows", count: Some(group.rows), ..line });
            rows.push(Line { statistic: "failed", count: Some(group.failed), ..line });
            for ((_, output), tally) in self.outputs.iter().zip(&group.tallies) {
                let line = Line { output: Some(output.name), ..line };
                rows.push(Line { statistic: "values", count: Some(tally.values), ..line });
                for statistic in &self.reduction.statistics {
                    self.lines(*statistic, tally, is_whole, line, &mut rows);
                }
            }
        }
        rows.finish(&self.inputs)
    }

    fn lines(
        &self,
        statistic: Statistic,
        tally: &Tally,
        is_whole: bool,
        line: Line<'_>,
        rows: &mut Lines,
    ) {
        let any = tally.values > 0;
        let mut number = |statistic, value: f64| {
            rows.push(Line { statistic, value: any.then_some(value), ..line });
        };
        match statistic {
            Statistic::Min => number("min", tally.min),
            Statistic::Max => number("max", tally.max),
            Statistic::Mean if is_whole => {
                #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
                let count = tally.values as f64;
                number("mean", (tally.sum.sum + tally.sum.rest) / count);
            }
            Statistic::Mean => {
                number("sum", tally.sum.sum);
                number("rest", tally.sum.rest);
            }
            Statistic::Histogram { .. } => {
                let bits = self.reduction.bits().unwrap_or(0);
                for (bin, count) in &tally.bins {
                    let (low, high) = edges(*bin, bits);
                    let (low, high, count) = (Some(low), Some(high), Some(*count));
                    rows.push(Line { statistic: "histogram", low, high, count, ..line });
                }
            }
            Statistic::Worst { .. } => {
                let ends = [("lowest", &tally.ends.lowest), ("highest", &tally.ends.highest)];
                for (statistic, list) in ends {
                    for outer in list {
                        let inputs = outer.inputs.iter().map(|x| (!x.is_nan()).then_some(*x));
                        let inputs: Vec<_> = inputs.collect();
                        let (row, value) = (Some(outer.row), Some(outer.value));
                        rows.push(Line { statistic, row, value, inputs: &inputs, ..line });
                    }
                }
            }
        }
    }

    /// Writes what can be added up further, all but the footer.
    pub(super) fn into_file<W: Write + Send>(
        self,
        out: W,
    ) -> Result<SerializedFileWriter<W>, TableError> {
        let table = self.table(false)?;
        let mut writer = ArrowWriter::try_new(out, table.schema(), Some(properties()))?;
        writer.write(&table)?;
        Ok(writer.into_serialized_writer()?.0)
    }

    /// The inputs of the points, by the columns of a part.
    pub(super) fn inputs(part: &Path) -> Result<Columns, TableError> {
        let file = File::open(part)?;
        let schema =
            decoded(|| Ok(ParquetRecordBatchReaderBuilder::try_new(file)?.schema().clone()));
        let schema = schema?;
        let names = schema.fields().iter().map(|field| field.name().as_str());
        let keys = names.take_while(|name| *name != OUTPUT).map(InputKey::named);
        let keys = keys.collect::<Result<_, _>>();
        Ok(Columns::of_inputs(keys.map_err(|e| TableError::Parquet(e.to_string()))?))
    }

    /// Reads back what a part holds.
    fn read(&self, path: &Path) -> Result<Self, TableError> {
        let mut found = Self {
            groups: Vec::new(),
            places: HashMap::new(),
            reduction: self.reduction.clone(),
            inputs: self.inputs.clone(),
            by: self.by.clone(),
            outputs: self.outputs.clone(),
        };
        let file = File::open(path)?;
        let reader =
            decoded(|| Ok(ParquetRecordBatchReaderBuilder::try_new(file.try_clone()?)?.build()?))?;
        // A group may go on in the next batch.
        let mut group = None;
        for batch in reader {
            found.take(&batch?, &mut group).ok_or_else(|| {
                TableError::Parquet(format!("{} holds no statistics", path.display()))
            })??;
        }
        Ok(found)
    }

    /// Takes in the rows of a table; `None` if it is none of statistics.
    ///
    /// * `place`: of the group of the last row.
    fn take(
        &mut self,
        batch: &RecordBatch,
        place: &mut Option<usize>,
    ) -> Option<Result<(), TableError>> {
        let numbers = |name: &str| batch.column_by_name(name)?.as_primitive_opt::<Float64Type>();
        let counts = |name: &str| batch.column_by_name(name)?.as_primitive_opt::<UInt64Type>();
        let texts = |name: &str| batch.column_by_name(name)?.as_string_opt::<i32>();
        let inputs: Vec<_> =
            self.inputs.iter().map(|key| numbers(key.name())).collect::<Option<_>>()?;
        let (outputs, statistics) = (texts(OUTPUT)?, texts(STATISTIC)?);
        let (lows, highs, values) = (numbers(LOW)?, numbers(HIGH)?, numbers(VALUE)?);
        let (rows, counts) = (counts(ROW)?, counts(COUNT)?);
        let number = |column: &Float64Array, row: usize| {
            if column.is_valid(row) { column.value(row) } else { f64::NAN }
        };
        let bits = self.reduction.bits().unwrap_or(0);
        for row in 0..batch.num_rows() {
            let (statistic, count) = (statistics.value(row), counts.value(row));
            if statistic == "rows" {
                let key: Vec<_> = self.by.iter().map(|by| number(inputs[*by], row)).collect();
                *place = match self.group(&key) {
                    Ok(place) => Some(place),
                    Err(error) => return Some(Err(error)),
                };
            }
            let group = self.groups.get_mut((*place)?)?;
            if !outputs.is_valid(row) {
                let to = if statistic == "rows" { &mut group.rows } else { &mut group.failed };
                *to = count;
                continue;
            }
            let name = outputs.value(row);
            let output = self.outputs.iter().position(|(_, output)| output.name == name)?;
            let tally = &mut group.tallies[output];
            let value = number(values, row);
            let outer = || Outer {
                value,
                row: rows.value(row),
                inputs: inputs.iter().map(|column| number(column, row)).collect(),
            };
            match statistic {
                "values" => tally.values = count,
                "histogram" => {
                    let bin = bin_of((lows.value(row), highs.value(row)), bits);
                    tally.bins.insert(bin, count);
                }
                "lowest" => tally.ends.lowest.push(outer()),
                "highest" => tally.ends.highest.push(outer()),
                // Of no values there is none.
                _ if value.is_nan() => {}
                "min" => tally.min = value,
                "max" => tally.max = value,
                "sum" => tally.sum.sum = value,
                "rest" => tally.sum.rest = value,
                _ => return None,
            }
        }
        Some(Ok(()))
    }

    /// The result of all parts, as the bytes of a Parquet table.
    pub(super) fn of_parts<P: AsRef<Path>>(
        mut self,
        parts: impl Iterator<Item = P>,
    ) -> Result<Vec<u8>, TableError> {
        for part in parts {
            let part = self.read(part.as_ref())?;
            self.merge(part)?;
        }
        let table = self.table(true)?;
        let mut writer = ArrowWriter::try_new(Vec::new(), table.schema(), Some(properties()))?;
        writer.write(&table)?;
        Ok(writer.into_inner()?)
    }
}

impl Sink for Reduced {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let (bits, most) = (self.reduction.bits(), self.reduction.outermost());
        let inputs: Vec<_> = chunk.inputs.iter().map(crate::Column::values).collect();
        let mut key = vec![f64::NAN; self.by.len()];
        let mut place = None;
        for (row, verdict) in answers.verdicts.iter().enumerate() {
            let mut same = place.is_some();
            for (key, by) in key.iter_mut().zip(&self.by) {
                let value = inputs[*by][row];
                same &= key.to_bits() == value.to_bits();
                *key = value;
            }
            let at = match place {
                Some(at) if same => at,
                _ => self.group(&key)?,
            };
            place = Some(at);
            let group = &mut self.groups[at];
            group.rows += 1;
            group.failed += u64::from(verdict.status != Status::Converged);
            for ((column, _), tally) in self.outputs.iter().zip(&mut group.tallies) {
                let value = answers.columns[*column][row];
                if value.is_nan() {
                    continue;
                }
                tally.values += 1;
                tally.min = tally.min.min(value);
                tally.max = tally.max.max(value);
                tally.sum.add(value);
                if let Some(bits) = bits {
                    *tally.bins.entry(bin(value, bits)).or_default() += 1;
                }
                if most > 0 {
                    let number = chunk.first - 1 + row as u64;
                    let inputs = || inputs.iter().map(|values| values[row]).collect();
                    tally.ends.push(most, value, number, inputs);
                }
            }
        }
        Ok(())
    }
}

/// A row of the table.
#[derive(Debug, Default, Clone, Copy)]
struct Line<'a> {
    inputs: &'a [Option<f64>],
    output: Option<&'static str>,
    statistic: &'static str,
    low: Option<f64>,
    high: Option<f64>,
    row: Option<u64>,
    value: Option<f64>,
    count: Option<u64>,
}

/// The columns of the table.
#[derive(Debug)]
struct Lines {
    inputs: Vec<Vec<Option<f64>>>,
    outputs: Vec<Option<&'static str>>,
    statistics: Vec<&'static str>,
    /// Low, high and value.
    numbers: [Vec<Option<f64>>; 3],
    /// Row and count.
    counts: [Vec<Option<u64>>; 2],
}

impl Lines {
    fn new(inputs: usize) -> Self {
        let (numbers, counts) = (Default::default(), Default::default());
        let (outputs, statistics) = (Vec::new(), Vec::new());
        Self { inputs: vec![Vec::new(); inputs], outputs, statistics, numbers, counts }
    }

    fn push(&mut self, line: Line<'_>) {
        for (column, value) in self.inputs.iter_mut().zip(line.inputs) {
            column.push(*value);
        }
        self.outputs.push(line.output);
        self.statistics.push(line.statistic);
        for (column, value) in self.numbers.iter_mut().zip([line.low, line.high, line.value]) {
            column.push(value);
        }
        for (column, count) in self.counts.iter_mut().zip([line.row, line.count]) {
            column.push(count);
        }
    }

    fn finish(self, inputs: &[InputKey]) -> Result<RecordBatch, TableError> {
        let numbers = |column| Arc::new(Float64Array::from(column)) as ArrayRef;
        let counts = |column| Arc::new(UInt64Array::from(column)) as ArrayRef;
        let [low, high, value] = self.numbers;
        let [row, count] = self.counts;
        let outputs: ArrayRef = Arc::new(StringArray::from(self.outputs));
        let statistics: ArrayRef = Arc::new(StringArray::from(self.statistics));
        let inputs = inputs.iter().zip(self.inputs);
        let inputs = inputs.map(|(key, column)| (key.name(), numbers(column), true));
        let columns = inputs.chain([
            (OUTPUT, outputs, true),
            (STATISTIC, statistics, false),
            (LOW, numbers(low), true),
            (HIGH, numbers(high), true),
            (ROW, counts(row), true),
            (VALUE, numbers(value), true),
            (COUNT, counts(count), true),
        ]);
        Ok(RecordBatch::try_from_iter_with_nullable(columns)?)
    }
}
