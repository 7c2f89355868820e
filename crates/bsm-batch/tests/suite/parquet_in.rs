//! Tests of Parquet tables that other programs have written. All common codecs must be readable,
//! and checksums must be verified. Tables that are not supported or that would need unlimited
//! memory must be rejected with a message.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use allocation_counter::measure;
use arrow_array::builder::{MapBuilder, StringBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::Int32Type;
use arrow_array::{
    ArrayRef, BooleanArray, Date32Array, DurationSecondArray, Float64Array, Int64Array, ListArray,
    RecordBatch, StringArray, StructArray, TimestampMillisecondArray, UInt16Array,
};
use bsm_batch::{
    Answers, Cell, Format, ParquetSource, Source, TableError, TableFormat, Task, Workers,
};
use bsm_case::Case;
use bsm_dyn::Model;
use bytes::Bytes;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{
    BrotliLevel, Compression, Encoding, GzipLevel, Repetition, Type as Physical, ZstdLevel,
};
use parquet::column::writer::ColumnCloseResult;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// Numbers in the first input column, and texts in the first copied column.
type Rows = (Vec<f64>, Vec<String>);

fn read(table: Vec<u8>, kept: &[&str]) -> Result<Rows, TableError> {
    let keep: Vec<_> = kept.iter().map(|name| (*name).to_owned()).collect();
    let mut source = ParquetSource::new(Bytes::from(table), &keep, &TableFormat::default())?;
    let mut rows = Rows::default();
    while let Some(chunk) = source.next(1000)? {
        for row in 0..chunk.len {
            match chunk.cell(row, 0) {
                Cell::Number(value) => rows.0.push(value),
                other => panic!("{other:?}"),
            }
        }
        if let Some(texts) = chunk.kept.first() {
            rows.1.extend(texts.as_string::<i32>().iter().flatten().map(str::to_owned));
        }
    }
    Ok(rows)
}

fn error_text(read: Result<Rows, TableError>) -> String {
    read.expect_err("refused").to_string()
}

fn parquet_table(columns: Vec<(&str, ArrayRef)>, properties: WriterProperties) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).expect("columns of one length");
    let writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties));
    let mut writer = writer.expect("a schema");
    writer.write(&batch).expect("rows");
    writer.into_inner().expect("a footer")
}

fn writer_properties(codec: Compression) -> WriterProperties {
    WriterProperties::builder().set_compression(codec).build()
}

/// Returns all codecs that are supported.
fn codecs() -> [Compression; 6] {
    [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::GZIP(GzipLevel::default()),
        Compression::LZ4,
        Compression::LZ4_RAW,
        Compression::ZSTD(ZstdLevel::default()),
    ]
}

fn repeated_leads() -> Vec<f64> {
    (0..3000).map(|row| f64::from(row % 700) + 0.5).collect()
}

fn column(numbers: Vec<f64>) -> ArrayRef {
    Arc::new(Float64Array::from(numbers))
}

/// In an earlier version, tables that pandas and Polars had compressed with Zstandard, gzip or LZ4
/// were rejected as "not a Parquet table".
#[test]
fn parquet_files_with_any_common_codec_are_read() {
    let ids: Vec<_> = (0..3000).map(|row| format!("point {row}")).collect();
    for codec in codecs() {
        let texts: ArrayRef = Arc::new(StringArray::from_iter_values(&ids));
        let table = parquet_table(
            vec![("lead_mm", column(repeated_leads())), ("id", texts)],
            writer_properties(codec),
        );
        let (numbers, texts) = read(table, &["id"]).expect("a table");
        assert_eq!(numbers, repeated_leads(), "{codec}");
        assert_eq!(texts, ids, "{codec}");
    }
}

/// In an earlier version, the error message for an unsupported codec was "Disabled feature at
/// compile time".
#[test]
fn error_for_an_unsupported_parquet_codec_suggests_a_remedy() {
    let brotli =
        file_of_pages(Compression::BROTLI(BrotliLevel::default()), "lead_mm", &data_page(24, 24));
    assert_eq!(
        error_text(read(brotli, &[])),
        "the Parquet table uses Brotli compression, which is not supported; write it \
         without encryption, and with Snappy, Zstandard, gzip, LZ4 or no compression"
    );
    let mut encrypted = parquet_table(
        vec![("lead_mm", column(repeated_leads()))],
        writer_properties(Compression::SNAPPY),
    );
    let end = encrypted.len() - 4;
    encrypted[end..].copy_from_slice(b"PARE");
    let encrypted = error_text(read(encrypted, &[]));
    assert!(encrypted.contains("uses encryption, which is not supported"), "{encrypted}");
}

/// In an earlier version, the errors for copied columns with structures or maps were unclear.
#[test]
fn columns_of_structures_maps_or_lists_cannot_be_copied() {
    let list = ListArray::from_iter_primitive::<Int32Type, _, _>([Some([Some(1), None])]);
    let text: ArrayRef = Arc::new(StringArray::from(vec!["a"]));
    let structure = RecordBatch::try_from_iter([("name", text)]).expect("a column");
    let mut map = MapBuilder::new(None, StringBuilder::new(), StringBuilder::new());
    map.keys().append_value("key");
    map.values().append_value("value");
    map.append(true).expect("a row");
    let all: [ArrayRef; 3] =
        [Arc::new(list), Arc::new(StructArray::from(structure)), Arc::new(map.finish())];
    for nested in all {
        let columns = vec![("id", nested), ("lead_mm", column(vec![5.0]))];
        let table = parquet_table(columns, writer_properties(Compression::SNAPPY));
        assert_eq!(
            error_text(read(table, &["id"])),
            "the cells of column `id` are lists, maps or structures, which cannot be copied; \
             omit the column, or split it"
        );
    }
}

/// Parquet stores durations as plain integers. In an earlier version, an input of 8000 s was
/// therefore read as 8000 N.
#[test]
fn column_of_durations_is_rejected_as_a_numeric_input() {
    let loads: ArrayRef = Arc::new(DurationSecondArray::from(vec![8000, 9000]));
    let table =
        parquet_table(vec![("axial_load_N", loads)], writer_properties(Compression::SNAPPY));
    assert_eq!(
        error_text(read(table, &[])),
        "column `axial_load_N` contains Duration(s), but must contain numbers"
    );
}

/// In an earlier version, copied ids and dates were converted to text.
#[test]
fn copied_parquet_columns_keep_their_types() {
    let ids: ArrayRef = Arc::new(Int64Array::from(vec![Some(1 << 60), None, Some(-7)]));
    let dates: ArrayRef = Arc::new(Date32Array::from(vec![20_000, 20_001, 20_002]));
    let times: ArrayRef = Arc::new(TimestampMillisecondArray::from(vec![1, 2, 3]));
    let flags: ArrayRef = Arc::new(BooleanArray::from(vec![Some(true), None, Some(false)]));
    let small: ArrayRef = Arc::new(UInt16Array::from(vec![7, 8, 9]));
    let texts: ArrayRef = Arc::new(StringArray::from(vec![Some("a"), None, Some("")]));
    let lasting: ArrayRef = Arc::new(DurationSecondArray::from(vec![90, 1, 0]));
    let kept = [
        ("id", ids),
        ("date", dates),
        ("time", times),
        ("flag", flags),
        ("n", small),
        ("t", texts),
        ("lasting", lasting),
    ];
    let leads = ("axial_load_N", column(vec![500.0, 600.0, 700.0]));
    let table =
        parquet_table([&kept[..], &[leads]].concat(), writer_properties(Compression::SNAPPY));
    let keep: Vec<_> = kept.iter().map(|(name, _)| (*name).to_owned()).collect();
    let solved = |format| {
        let mut source =
            ParquetSource::new(Bytes::from(table.clone()), &keep, &TableFormat::default())
                .expect("a table");
        let base = include_bytes!("../../../../examples/feed_drive.json");
        let base = Case::from_json(base).expect("a case");
        let outputs = Answers::select(Some(&["efficiency".to_owned()])).expect("an output");
        let task = Task::new(base, Model::ClosedForm.into(), outputs);
        let stop = AtomicBool::new(false);
        let workers = Workers::start(NonZeroUsize::new(1), &stop).expect("a thread");
        task.write(&mut source, format, Vec::new(), &workers, &mut |_, _| {}).expect("solved").0
    };
    let again = ParquetRecordBatchReaderBuilder::try_new(Bytes::from(solved(Format::Parquet)));
    let mut again = again.expect("Parquet").build().expect("Parquet");
    let again = again.next().expect("rows").expect("Parquet");
    for (name, column) in kept {
        assert!(again.column_by_name(name) == Some(&column), "{name}");
    }
    let lines = String::from_utf8(solved(Format::JsonLines)).expect("text");
    let first = "{\"id\":1152921504606846976,\"date\":\"2024-10-04\",\"time\":\"1970-01-01T00:00:00.001\",\"flag\":true,\"n\":7,\"t\":\"a\",\"lasting\":\"PT90S\",";
    assert!(lines.starts_with(first), "{lines}");
    let rows = String::from_utf8(solved(Format::Csv)).expect("text");
    let second = "\n,2024-10-05,1970-01-01T00:00:00.002,,8,,PT1S,600,";
    assert!(rows.contains(second), "{rows}");
}

/// In an earlier version, a flipped bit changed numbers without an error. The file was written by
/// pyarrow 26.0.1 with `write_table(table({"lead_mm": [5.0, 6.0, 7.0]}), "checksums.parquet",
/// compression="none", use_dictionary=False, write_statistics=False, store_schema=False,
/// write_page_checksum=True)`.
#[test]
fn flipped_bit_in_a_parquet_page_with_a_checksum_causes_an_error() {
    const TABLE: &[u8] = include_bytes!("checksums.parquet");
    // The page data consist of 6 bytes of levels and three numbers. They follow the page header,
    // which has 25 bytes and begins after the magic number of 4 bytes.
    const PAGE: std::ops::Range<usize> = 29..59;
    assert_eq!(read(TABLE.to_vec(), &[]).expect("a table").0, [5.0, 6.0, 7.0]);
    assert_eq!(TABLE[PAGE.end - 8..PAGE.end], 7.0_f64.to_le_bytes());
    for bit in PAGE.start * 8..PAGE.end * 8 {
        let mut flipped = TABLE.to_vec();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let why = error_text(read(flipped, &[]));
        assert!(why.contains("Page CRC checksum mismatch"), "bit {bit}: {why}");
    }
}

/// Encodes an integer field in Thrift's compact protocol. The field must follow directly after the
/// previous field.
fn integer_field(value: u32) -> Vec<u8> {
    let mut rest = u64::from(value) << 1;
    let mut bytes = vec![0x15];
    while rest >= 0x80 {
        bytes.push(rest.to_le_bytes()[0] | 0x80);
        rest >>= 7;
    }
    bytes.push(rest.to_le_bytes()[0]);
    bytes
}

/// Returns the header of a data page with plain numbers. The header specifies the given
/// uncompressed and compressed lengths.
fn data_page(length: u32, compressed: u32) -> Vec<u8> {
    // The header contains page type 0 and a structure that specifies 3 values, plain encoding, and
    // run-length encoded levels.
    let head =
        [integer_field(0), integer_field(length), integer_field(compressed), vec![0x2c]].concat();
    let values =
        [integer_field(3), integer_field(0), integer_field(3), integer_field(3), vec![0, 0]]
            .concat();
    [head, values, vec![0; 24]].concat()
}

/// Returns the header of a dictionary page with plain numbers.
fn dictionary_page(length: u32, values: u32) -> Vec<u8> {
    let head = [integer_field(2), integer_field(length), integer_field(24), vec![0x4c]].concat();
    [head, integer_field(values), integer_field(0), vec![0, 0], vec![0; 24], data_page(24, 24)]
        .concat()
}

/// Returns a Parquet file with a single column, which consists of the given pages.
fn file_of_pages(codec: Compression, name: &str, pages: &[u8]) -> Vec<u8> {
    let number = Type::primitive_type_builder(name, Physical::DOUBLE)
        .with_repetition(Repetition::REQUIRED)
        .build();
    let fields = vec![Arc::new(number.expect("a column"))];
    let schema = Type::group_type_builder("schema").with_fields(fields).build().expect("a schema");
    let mut writer =
        SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::default()).expect("a writer");
    let column = writer.schema_descr().column(0);
    let length = i64::try_from(pages.len()).expect("short");
    let metadata = ColumnChunkMetaData::builder(column)
        .set_compression(codec)
        .set_encodings(vec![Encoding::PLAIN])
        .set_num_values(3)
        .set_total_compressed_size(length)
        .set_total_uncompressed_size(length)
        .set_data_page_offset(0)
        .build()
        .expect("a chunk");
    let close = ColumnCloseResult {
        bytes_written: pages.len() as u64,
        rows_written: 3,
        metadata,
        bloom_filter: None,
        column_index: None,
        offset_index: None,
    };
    let mut group = writer.next_row_group().expect("a row group");
    group.append_column(&Bytes::copy_from_slice(pages), close).expect("a column");
    group.close().expect("a row group");
    writer.into_inner().expect("a footer")
}

/// In an earlier version, reading a file of 2 kB took 291 MB of memory. The test covers all codecs
/// and uncompressed dictionaries.
#[test]
fn a_decompression_bomb_is_rejected_before_memory_is_allocated() {
    let bombs = [
        data_page(291_000_000, 24),
        data_page(i32::MAX.cast_unsigned(), 24),
        data_page(24, 291_000_000),
        dictionary_page(291_000_000, 4),
        dictionary_page(24, 291_000_000 / 8),
    ];
    for (codec, bomb) in codecs().iter().flat_map(|codec| bombs.iter().map(move |b| (*codec, b))) {
        let table = file_of_pages(codec, "lead_mm", bomb);
        assert!(table.len() < 2000);
        let mut said = String::new();
        // Reading the footer and formatting the message allocate a few kB of memory.
        let memory = measure(|| said = error_text(read(table, &[]))).bytes_max;
        assert!(memory < 1 << 20, "{codec}: {memory} bytes");
        assert!(said.starts_with("not a Parquet table: a page header specifies "), "{said}");
        assert!(said.contains(" kB, but in a file of 1 kB, a page may have at most 33"), "{said}");
    }
    // The same pages are valid if their headers specify the correct lengths.
    let whole = data_page(24, 24);
    assert_eq!(
        read(file_of_pages(Compression::UNCOMPRESSED, "lead_mm", &whole), &[]).expect("a table").0,
        [0.0; 3]
    );
}

/// A large table whose inputs are mostly constant is compressed to less than 1/500 of its size. The
/// table must not be rejected as a decompression bomb.
#[test]
fn highly_compressible_parquet_table_is_read() {
    const ROWS: usize = 200_000;
    let names = ["lead_mm", "axial_load_N", "screw_speed_rpm", "ball_diameter_mm"];
    let same = column(vec![5.0; ROWS]);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false);
    let columns = names.map(|name| (name, same.clone())).to_vec();
    let table = parquet_table(columns, properties.build());
    let unpacked = names.len() * 8 * ROWS;
    assert!(unpacked > 500 * table.len(), "{} bytes", table.len());
    assert_eq!(read(table, &[]).expect("a table").0.len(), ROWS);
}
