//! Compares the speed of the vectorized kernels on each instruction set with the speed of the
//! scalar models, and measures how long whole tables take from file to file. To run this benchmark,
//! use `cargo bench -p bsm-benches --bench batch`.

use std::fs::File;
use std::hint::black_box;
use std::io::{BufReader, BufWriter, Seek};
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch};
use bsm_batch::{
    AnswerSink, Answers, Chunk, Columns, CsvSource, Format, ParquetSource, Source, TableFormat,
    TableSink, Task,
};
use bsm_benches::seeded;
use bsm_case::{Case, Output, Settings};
use bsm_dyn::{Model, ModelWorkspace, Problem};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use parquet::arrow::ArrowWriter;

/// Inputs that have different values in each random case.
const INPUTS: [&str; 7] = [
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "ball_diameter_mm",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
];

/// Returns the varying inputs of the cases as a chunk, and a base case that contains all other
/// inputs.
fn chunk(cases: &[Case]) -> (Chunk, Columns, Case) {
    let columns = Columns::sort(INPUTS, &[], &TableFormat::default()).expect("known names");
    let rows = cases.iter().map(|case| columns.inputs.iter().map(|key| case[*key]));
    let chunk = Chunk::of_rows(&columns, rows);
    (chunk, columns, bsm_benches::lin())
}

fn named(names: &[&str]) -> Vec<&'static Output> {
    names.iter().map(|name| Output::named(name).expect("known name")).collect()
}

/// Measures the speed of the kernels on one thread. The time includes reading input columns and
/// writing output columns.
fn kernels(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let (count, cases) = (4096, seeded(4096));
    let (points, columns, base) = chunk(&cases);
    let few = named(&["efficiency", "nut_normal_load_N", "screw_normal_load_N"]);
    let all = Answers::select(None).expect("all outputs");
    for model in Model::ALL {
        let settings: Settings = model.into();
        let mut group = c.benchmark_group(format!("batch/{}", model.name()));
        group.throughput(Throughput::Elements(count)).sample_size(20);
        for arch in bsm_simd::instruction_sets() {
            let arch_name = bsm_simd::name(arch);
            for (label, outputs) in [("3 outputs", &few), ("all outputs", &all)] {
                let task = Task::new(base.clone(), settings, outputs.clone());
                group.bench_function(format!("{arch_name}, {label}"), |b| {
                    pool.install(|| {
                        b.iter(|| task.solve_on(arch, black_box(&points), &columns));
                    });
                });
            }
        }
        let problems: Vec<Problem> =
            cases.iter().map(|s| s.problem(&settings).expect("complete case")).collect();
        let mut work = ModelWorkspace::default();
        group.bench_function("point by point", |b| {
            b.iter(|| {
                for problem in &problems {
                    let _ = black_box(black_box(problem).solve(&mut work));
                }
            });
        });
    }
}

/// Measures how fast tables are solved with the rigid model and two outputs on all cores. The time
/// includes reading and writing the files.
fn tables(c: &mut Criterion) {
    let rows = 100_000;
    let (points, _, base) = chunk(&seeded(rows));
    let outputs = named(&["efficiency", "ball_torque_Nm"]);
    let task = Task::new(base, Model::Rigid.into(), outputs.clone());
    let file = || tempfile::tempfile().expect("temporary file");
    let (mut csv, mut parquet) = (file(), file());
    let numbers = |row: usize| points.inputs.iter().map(move |c| c.value(row).to_string());
    let mut writer = csv::Writer::from_writer(BufWriter::new(&csv));
    writer.write_record(INPUTS).expect("header");
    for row in 0..rows {
        writer.write_record(numbers(row)).expect("row");
    }
    drop(writer.into_inner().expect("end"));
    let arrays = INPUTS
        .iter()
        .zip(&points.inputs)
        .map(|(name, column)| (*name, Arc::new(column.clone()) as ArrayRef));
    let batch = RecordBatch::try_from_iter(arrays).expect("columns of one length");
    let mut writer = ArrowWriter::try_new(&parquet, batch.schema(), None).expect("schema");
    writer.write(&batch).expect("rows");
    writer.close().expect("end");

    let signs = TableFormat::default();
    let run = |source: &mut dyn Source, format: Format, out: BufWriter<File>| {
        let columns = source.columns().clone();
        let sink = TableSink::new(format, out, &columns, &outputs, &signs);
        let mut sink = sink.expect("a head");
        while let Some(chunk) = source.next(1 << 16).expect("rows") {
            let answers = task.solve(&chunk, &columns);
            sink.write(chunk, answers).expect("rows");
        }
        sink.finish(None).expect("end")
    };
    let again = |file: &mut File| {
        file.rewind().expect("temporary file");
        file.try_clone().expect("temporary file")
    };
    let mut group = c.benchmark_group("file to file");
    group.throughput(Throughput::Elements(rows as u64)).sample_size(10);
    group.bench_function("CSV", |b| {
        b.iter(|| {
            let reader = BufReader::new(again(&mut csv));
            let mut source = CsvSource::new(reader, &[], &TableFormat::default()).expect("header");
            run(&mut source, Format::Csv, BufWriter::new(file()))
        });
    });
    group.bench_function("Parquet", |b| {
        b.iter(|| {
            let mut source = ParquetSource::new(again(&mut parquet), &[], &TableFormat::default())
                .expect("schema");
            run(&mut source, Format::Parquet, BufWriter::new(file()))
        });
    });
}

criterion_group!(benches, kernels, tables);
criterion_main!(benches);
