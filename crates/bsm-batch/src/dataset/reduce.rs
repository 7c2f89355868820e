//! Statistics in place of rows: a few kB a part, merged in the order of the parts.
//!
//! A part holds what its rows add up to, in a form that can be added up further: counts, least and greatest
//! values, sums with what rounding took from them, bins that do not depend on the rows, and the outermost
//! rows. Rows are taken in their order on one thread, and parts in theirs, so that the result depends on
//! the plan only.

use std::collections::{BTreeMap, HashMap};
use std::fmt::{self, Display, Formatter};
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

use crate::parquet_table::{decoded, properties};
use crate::{Answers, Chunk, Columns, Sink, TableError};

/// Most groups of a result: all of them are in memory.
const MOST_GROUPS: usize = 100_000;

/// Most bins for each doubling of a value, and most rows at each end.
const MOST_BINS: u32 = 4096;
const MOST_ROWS: u32 = 10_000;

/// Bits of the fraction of a double.
const FRACTION: u32 = 52;

/// What is told of an output in place of its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// The least value.
    Min,
    /// The greatest value.
    Max,
    /// The mean.
    Mean,
    /// How many values lie in each bin. The edges do not depend on the values: so many bins of equal width
    /// from each power of two to the next.
    Histogram {
        /// Bins for each doubling, a power of two.
        bins: u32,
    },
    /// The rows with the least and with the greatest values.
    Worst {
        /// How many at each end.
        rows: u32,
    },
}

impl Statistic {
    /// Parses `min`, `max`, `mean`, `histogram:BINS` or `worst:ROWS`.
    fn parse(text: &str) -> Option<Self> {
        let (word, number) = match text.split_once(':') {
            Some((word, number)) => (word, number.trim().parse::<u32>().ok()?),
            None => (text, 0),
        };
        match (word.trim(), number) {
            ("min", 0) => Some(Self::Min),
            ("max", 0) => Some(Self::Max),
            ("mean", 0) => Some(Self::Mean),
            ("histogram", bins @ 1..=MOST_BINS) if bins.is_power_of_two() => {
                Some(Self::Histogram { bins })
            }
            ("worst", rows @ 1..=MOST_ROWS) => Some(Self::Worst { rows }),
            _ => None,
        }
    }
}

/// The form that is read.
impl Display for Statistic {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Min => f.write_str("min"),
            Self::Max => f.write_str("max"),
            Self::Mean => f.write_str("mean"),
            Self::Histogram { bins } => write!(f, "histogram:{bins}"),
            Self::Worst { rows } => write!(f, "worst:{rows}"),
        }
    }
}

/// Which statistics, for which groups of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reduction {
    /// What is told of each output that is a number.
    pub statistics: Vec<Statistic>,
    /// Inputs whose values make groups; none for one group of all rows.
    pub by: Vec<InputKey>,
}

impl Reduction {
    /// From the words of statistics and the names of inputs.
    ///
    /// # Errors
    ///
    /// What is wrong with a word, in words.
    pub fn parse(statistics: &[String], by: &[String]) -> Result<Self, String> {
        let mut this = Self { statistics: Vec::new(), by: Vec::new() };
        for text in statistics {
            let statistic = Statistic::parse(text.trim()).ok_or_else(|| {
                format!(
                    "`{text}` is none of min, max, mean, histogram:BINS (a power of two up to {MOST_BINS}: bins for \
                     each doubling of the value), worst:ROWS (1 to {MOST_ROWS})"
                )
            })?;
            let same = |other: &Statistic| {
                std::mem::discriminant(other) == std::mem::discriminant(&statistic)
            };
            if this.statistics.iter().any(same) {
                return Err(format!("`{text}` stands twice"));
            }
            this.statistics.push(statistic);
        }
        for name in by {
            let key = InputKey::named(name.trim()).map_err(|e| e.to_string())?;
            if this.by.contains(&key) {
                return Err(format!("`{name}` stands twice"));
            }
            this.by.push(key);
        }
        Ok(this)
    }

    /// Rows of the table of a group at most, of which each bin that has a value is one.
    pub(super) fn rows_of_a_group(&self, outputs: usize) -> f64 {
        /// Doublings that the values of an output span, nominally.
        const DOUBLINGS: f64 = 8.0;
        let rows = |statistic: &Statistic| match *statistic {
            Statistic::Min | Statistic::Max => 1.0,
            Statistic::Mean => 2.0,
            Statistic::Histogram { bins } => DOUBLINGS * f64::from(bins),
            Statistic::Worst { rows } => 2.0 * f64::from(rows),
        };
        #[expect(clippy::cast_precision_loss, reason = "there are some fifty")]
        let outputs = outputs as f64;
        2.0 + outputs * (1.0 + self.statistics.iter().map(rows).sum::<f64>())
    }

    fn bits(&self) -> Option<u32> {
        self.statistics.iter().find_map(|statistic| match statistic {
            Statistic::Histogram { bins } => Some(bins.trailing_zeros()),
            _ => None,
        })
    }

    fn outermost(&self) -> usize {
        let rows = self.statistics.iter().find_map(|statistic| match statistic {
            Statistic::Worst { rows } => usize::try_from(*rows).ok(),
            _ => None,
        });
        rows.unwrap_or(0)
    }
}

/// Number of the bin of a value, growing with it; `bits` of the fraction tell bins apart.
fn bin(value: f64, bits: u32) -> i64 {
    let place = (value.abs().to_bits() >> (FRACTION - bits)).cast_signed();
    if value < 0.0 { -1 - place } else { place }
}

/// The ends of a bin, the one nearer to zero being in it.
fn edges(bin: i64, bits: u32) -> (f64, f64) {
    let edge = |place: i64| f64::from_bits(place.cast_unsigned() << (FRACTION - bits));
    if bin < 0 { (-edge(-bin), -edge(-1 - bin)) } else { (edge(bin), edge(bin + 1)) }
}

/// The bin that has these ends.
fn bin_of((low, high): (f64, f64), bits: u32) -> i64 {
    if low < 0.0 { -1 - bin(-high, bits) } else { bin(low, bits) }
}

/// A sum and what rounding took from it, after Neumaier.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        self.rest += if self.sum.abs() >= value.abs() {
            (self.sum - sum) + value
        } else {
            (value - sum) + self.sum
        };
        self.sum = sum;
    }

    fn merge(&mut self, other: Self) {
        self.add(other.sum);
        self.add(other.rest);
    }
}

/// A row at one end of the values.
#[derive(Debug, Clone, PartialEq)]
struct Outer {
    value: f64,
    row: u64,
    inputs: Vec<f64>,
}

/// The outermost rows at both ends.
#[derive(Debug, Default, Clone, PartialEq)]
struct Ends {
    /// Values that grow, and values that fall; of equal ones the first row stands first.
    lowest: Vec<Outer>,
    highest: Vec<Outer>,
}

impl Ends {
    /// Takes a row in at the ends where it is among the first `most`.
    fn push(&mut self, most: usize, value: f64, row: u64, inputs: impl Fn() -> Vec<f64>) {
        type Before = fn(f64, f64) -> bool;
        let ends: [(&mut Vec<Outer>, Before); 2] =
            [(&mut self.lowest, |a, b| a <= b), (&mut self.highest, |a, b| a >= b)];
        for (list, before) in ends {
            let place = list.partition_point(|other| before(other.value, value));
            if place < most {
                list.truncate(most - 1);
                list.insert(place, Outer { value, row, inputs: inputs() });
            }
        }
    }
}

/// What the values of an output add up to.
#[derive(Debug, Clone, PartialEq)]
struct Tally {
    values: u64,
    min: f64,
    max: f64,
    sum: Sum,
    bins: BTreeMap<i64, u64>,
    ends: Ends,
}

impl Tally {
    fn new() -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        let (bins, ends) = (BTreeMap::new(), Ends::default());
        Self { values: 0, min, max, sum: Sum::default(), bins, ends }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// A bin holds its end nearer to zero, follows the one before, and is found again from its ends.
    #[test]
    fn bins_tile_the_numbers() {
        for bits in [0, 3, 12] {
            for value in [0.0, -0.0, 5e-324, 0.1, 0.886, 1.0, 1.5, 2.0 - 1e-15, 3e300, 1e-310] {
                for value in [value, -value] {
                    let place = bin(value, bits);
                    let (low, high) = edges(place, bits);
                    let inside = if value < 0.0 {
                        low < value && value <= high
                    } else {
                        low <= value && value < high
                    };
                    assert!(inside, "{low} {value} {high}");
                    assert_eq!(bin_of((low, high), bits), place, "{value}");
                    // Zero is the border of the first bins of both signs.
                    assert_eq!(Some(edges(place + 1, bits).0), Some(high), "{value}");
                }
            }
        }
        // Eight bins from 1 to 2.
        assert_eq!(edges(bin(1.3, 3), 3), (1.25, 1.375));
    }

    /// 1 + 1e100 - 1e100 is 1, in one sum and merged from two.
    #[test]
    fn sums_keep_what_rounding_takes() {
        let sum = |values: &[f64]| {
            let mut sum = Sum::default();
            for value in values {
                sum.add(*value);
            }
            sum
        };
        let whole = sum(&[1.0, 1e100, 1.0, -1e100]);
        assert!((whole.sum + whole.rest - 2.0).abs() < f64::EPSILON);
        let mut merged = sum(&[1.0, 1e100]);
        merged.merge(sum(&[1.0, -1e100]));
        assert!((merged.sum + merged.rest - 2.0).abs() < f64::EPSILON, "{merged:?}");
    }

    #[test]
    fn words_are_read_as_they_are_written() {
        let texts = ["min", "max", "mean", "histogram:64", "worst:10"].map(str::to_owned);
        let by = ["lead_mm".to_owned()];
        let read = Reduction::parse(&texts, &by).expect("a reduction");
        assert_eq!(read.statistics.iter().map(ToString::to_string).collect::<Vec<_>>(), texts);
        assert_eq!(read.by, [InputKey::lead_mm]);
        for (texts, by, part) in [
            ("median", "lead_mm", "`median` is none of min, max"),
            ("histogram:3", "lead_mm", "a power of two"),
            ("histogram", "lead_mm", "a power of two"),
            ("worst:0", "lead_mm", "1 to 10000"),
            ("min:2", "lead_mm", "none of"),
            ("min,min", "lead_mm", "`min` stands twice"),
            ("min", "leed_mm", "lead_mm"),
            ("min", "lead_mm,lead_mm", "`lead_mm` stands twice"),
        ] {
            let split = |text: &str| text.split(',').map(str::to_owned).collect::<Vec<_>>();
            let said = Reduction::parse(&split(texts), &split(by)).expect_err(texts);
            assert!(said.contains(part), "{said}");
        }
    }
}
