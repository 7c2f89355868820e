//! Tests of the values, the statistics and the size of Parquet tables that the program writes.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use bsm_batch::{Answers, ColumnHead, Format, GridSource, TableFormat, TableSink, Task, Workers};
use bsm_case::{Case, ColumnValues, Grid, GridAxis, Output};
use bsm_dyn::Model;
use bytes::Bytes;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::statistics::Statistics;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns the metadata and the rows of a Parquet table.
fn read(table: Vec<u8>) -> (Arc<ParquetMetaData>, Vec<RecordBatch>) {
    let reader = ParquetRecordBatchReaderBuilder::try_new(Bytes::from(table)).expect("a table");
    let metadata = reader.metadata().clone();
    let batches = reader.build().expect("a table");
    (metadata, batches.map(|batch| batch.expect("rows")).collect())
}

/// Returns a value of one of five kinds that occur in real tables: constant, constant in many
/// consecutive rows, periodic like a grid axis, one of a few values, or different in every row.
fn random_value(kind: usize, row: usize, rng: &mut impl Rng) -> f64 {
    const FEW: [f64; 5] = [0.0, -0.0, f64::NAN, 1e300, -2.5];
    match kind {
        0 => 7.0,
        1 => f64::from(u32::try_from(row / 29).expect("small")),
        2 => f64::from(u32::try_from(row % 37).expect("small")) / 36.0,
        3 => FEW[rng.random_range(0..FEW.len())],
        _ => rng.random_range(-1.0..1.0),
    }
}

/// Each call that writes rows can contain a different kind of values. NaN represents an empty cell.
#[test]
fn numbers_round_trip_through_parquet() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let output = Output::named("efficiency").expect("known name");
    for _ in 0..200 {
        let gaps = [0.0, 0.0, 0.02, 0.6, 1.0][rng.random_range(0..5)];
        let mut expected: Vec<f64> = Vec::new();
        let head = ColumnHead { name: output.name, unit: output.unit, is_text: false };
        let mut sink =
            TableSink::of_columns(Format::Parquet, Vec::new(), [head], &TableFormat::default())
                .expect("head");
        for _ in 0..rng.random_range(1..5) {
            let (kind, first) = (rng.random_range(0..5), expected.len());
            for row in first..first + rng.random_range(1..700) {
                let is_gap = rng.random::<f64>() < gaps;
                expected.push(if is_gap { f64::NAN } else { random_value(kind, row, &mut rng) });
            }
            let rows = vec![ColumnValues::Numbers(expected[first..].to_vec())];
            sink.write_columns(rows).expect("rows");
        }
        let (metadata, batches) = read(sink.finish(None).expect("a footer"));
        let columns = batches.iter().map(|batch| batch.column(0).as_primitive::<Float64Type>());
        let found: Vec<_> = columns.flat_map(|column| column.iter().collect::<Vec<_>>()).collect();
        let wanted: Vec<_> = expected.iter().map(|x| Some(*x).filter(|x| !x.is_nan())).collect();
        let bits = |x: &Option<f64>| x.map(f64::to_bits);
        assert!(found.iter().map(bits).eq(wanted.iter().map(bits)), "gaps {gaps}");

        let Some(Statistics::Double(stats)) = metadata.row_group(0).column(0).statistics() else {
            panic!("no statistics")
        };
        let numbers = || wanted.iter().flatten().copied();
        let ends = (numbers().reduce(f64::min), numbers().reduce(f64::max));
        assert_eq!((stats.min_opt().copied(), stats.max_opt().copied()), ends);
        let nulls = wanted.iter().filter(|x| x.is_none()).count();
        assert_eq!(stats.null_count_opt(), Some(nulls as u64));
    }
}

/// A text column with nearly the same text in all rows must take almost no space, and repeated
/// input values must take less than one byte per row.
#[test]
fn repeated_texts_and_inputs_take_almost_no_space_in_a_parquet_file() {
    let base = include_bytes!("../../../../examples/feed_drive.json");
    let base = Case::from_json(base).expect("a case");
    let axes = ["axial_load_N=2000:8000:30", "screw_speed_rpm=100:1500:10000"];
    let axes = axes.map(|axis| GridAxis::parse(axis).expect("an axis"));
    let grid = Grid::new(axes.to_vec()).expect("a grid");
    let rows = grid.len();
    let outputs = Answers::select(Some(&["efficiency".to_owned()])).expect("an output");
    let task = Task::over_grid(base, Model::ClosedForm.into(), outputs, None, &grid);
    let stop = AtomicBool::new(false);
    let workers = Workers::start(None, &stop).expect("threads");
    let mut source = GridSource::new(grid);
    let table = task.expect("a complete case").write(
        &mut source,
        Format::Parquet,
        Vec::new(),
        &workers,
        &mut |_, _| {},
    );
    let (metadata, batches) = read(table.expect("solved").0);
    let found = batches.iter().map(RecordBatch::num_rows).sum::<usize>();
    assert_eq!(found, rows);
    let statuses = batches.iter().flat_map(|batch| {
        let column = batch.column_by_name("status").expect("a column").as_string::<i32>();
        column.iter().flatten().map(str::to_owned).collect::<Vec<_>>()
    });
    assert!(statuses.eq(std::iter::repeat_n("converged", rows)));
    let bytes = |name: &str| {
        let columns = metadata.row_groups().iter().flat_map(RowGroupMetaData::columns);
        let named = columns.filter(|column| column.column_path().string() == name);
        named.map(ColumnChunkMetaData::compressed_size).sum::<i64>()
    };
    let rows = i64::try_from(rows).expect("small");
    for (name, most) in [("model", rows / 500), ("status", rows / 500), ("message", rows / 500)] {
        assert!(bytes(name) < most, "{name}: {} bytes for {rows} rows", bytes(name));
    }
    for name in ["axial_load_N", "screw_speed_rpm"] {
        assert!(bytes(name) < rows, "{name}: {} bytes for {rows} rows", bytes(name));
    }
}
