//! Part files of a dataset, which are Parquet files that contain hashes of their own contents.
//!
//! The footer of a part file contains its plan id, its part number and two hashes: a hash of all
//! bytes before the footer, and a hash of the footer itself. While the hash of the footer is
//! calculated, zeros take its place in the footer. The two hashes reveal every changed bit of the
//! file. Therefore, no separate log is needed. A separate log could be lost or become inconsistent.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch, StringArray, UInt64Array};
use parquet::arrow::ArrowWriter;
use parquet::file::metadata::ParquetMetaDataReader;
use sha2::{Digest, Sha256};

use super::error::describe_entry;
use super::{DatasetError, PartDefect, digest};
use crate::parquet_table::catch_decoder_panic;
use crate::{Count, TableError, TableSink, Workers};

const PLAN: &str = "bsm.plan";
const PART: &str = "bsm.part";
const ROWS: &str = "bsm.rows";
const FAILED: &str = "bsm.failed";
const OTHER_SOLUTIONS: &str = "bsm.several";
const DATA_BYTES: &str = "bsm.data_bytes";
const DATA_SHA256: &str = "bsm.data_sha256";
const FOOTER_SHA256: &str = "bsm.footer_sha256";

/// Zeros that replace the hash of the footer while this hash is calculated.
const ZEROS: [u8; 64] = [b'0'; 64];

/// Number of bytes that follow the footer in a Parquet file. These bytes contain the length of the
/// footer and a magic number.
const TAIL: usize = 8;

/// Maximum length of a footer \[B\]. It is about fifty times the length of the longest footer that
/// a part with all outputs can have.
const MAX_FOOTER_BYTES: u64 = 64 << 20;

/// Plan id, number and rows that a part file is expected to have.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartRange<'a> {
    /// Id of the plan.
    pub(super) plan: &'a str,
    pub(super) number: u64,
    pub(super) first_row: u64,
    pub(super) rows: u64,
}

impl PartRange<'_> {
    /// Returns an error if the number of solved rows differs from the number of rows in the plan.
    pub(super) fn check(&self, count: Count) -> Result<(), DatasetError> {
        let Self { number, rows, .. } = *self;
        let found = count.rows;
        if found == rows {
            return Ok(());
        }
        Err(DatasetError::NotOfThePlan(format!(
            "the number of points changed during the run: part {number} has {found} rows instead of {rows}"
        )))
    }
}

/// A finished part of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Index of the part, counted from 0.
    pub number: u64,
    /// Index, within the dataset, of the first row of the part, counted from 0.
    pub first_row: u64,
    /// Number of rows in the part.
    pub rows: u64,
    /// Number of rows in the part that have no result.
    pub failed: u64,
    /// Number of rows in the part whose operating points are known to have further solutions.
    pub with_other_solutions: u64,
    /// Number of bytes in the part file before its footer.
    pub data_bytes: u64,
    /// SHA-256 hash of the bytes before the footer.
    pub data_sha256: String,
}

/// A writer that calculates the hash of all bytes before the footer. The hash of the footer is
/// inserted into the footer before the footer is written.
#[derive(Debug)]
pub(super) struct HashingWriter<W> {
    out: W,
    hash: Sha256,
    data_bytes: u64,
    footer: Option<Vec<u8>>,
}

impl<W: Write> HashingWriter<W> {
    pub(super) fn new(out: W) -> Self {
        Self { out, hash: Sha256::new(), data_bytes: 0, footer: None }
    }
}

impl<W: Write> Write for HashingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(footer) = &mut self.footer {
            footer.extend_from_slice(bytes);
            return Ok(bytes.len());
        }
        let written = self.out.write(bytes)?;
        self.hash.update(&bytes[..written]);
        self.data_bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Writes the footer of a part file, including both hashes, and returns the underlying writer.
pub(super) fn write_footer<W: Write + Send>(
    table: TableSink<HashingWriter<W>>,
    range: PartRange<'_>,
    Count { failed, with_other_solutions, .. }: Count,
) -> Result<(W, Part), TableError> {
    let PartRange { plan, number, first_row, rows, .. } = range;
    let (data_bytes, data_sha256) = (0, String::new());
    let mut part =
        Part { number, first_row, rows, failed, with_other_solutions, data_bytes, data_sha256 };
    let written = table.finish_with(|file| {
        part.data_bytes = file.data_bytes;
        part.data_sha256 = digest::hex(file.hash.clone());
        file.footer = Some(Vec::new());
        vec![
            (PLAN, plan.to_owned()),
            (PART, number.to_string()),
            (ROWS, format!("{first_row}:{rows}")),
            (FAILED, failed.to_string()),
            (OTHER_SOLUTIONS, with_other_solutions.to_string()),
            (DATA_BYTES, part.data_bytes.to_string()),
            (DATA_SHA256, part.data_sha256.clone()),
            (FOOTER_SHA256, String::from_utf8_lossy(&ZEROS).into_owned()),
        ]
    })?;
    let HashingWriter { mut out, footer, .. } = written;
    let mut footer = footer.unwrap_or_default();
    let hash = digest::of_bytes(&footer);
    let range = place_of_hash(&footer).ok_or_else(|| {
        TableError::Parquet("the footer differs from the expected footer".to_owned())
    })?;
    footer[range].copy_from_slice(hash.as_bytes());
    out.write_all(&footer)?;
    Ok((out, part))
}

/// Returns the position of the hash in a footer. In Thrift's compact protocol, the bytes before the
/// hash are its key, the field type and the length.
fn place_of_hash(footer: &[u8]) -> Option<Range<usize>> {
    const FIELD: [u8; 2] = [0x18, 64];
    let key = FOOTER_SHA256.as_bytes();
    let at = footer.windows(key.len()).rposition(|bytes| bytes == key)? + key.len();
    (footer.get(at..at + 2)? == FIELD).then_some(at + 2..at + 2 + ZEROS.len())
}

/// Verifies a part file, and returns the part that it contains.
///
/// * `deep`: if true, all bytes are verified; if false, only the footer is verified.
///
/// Returns `None` if the workers are stopped before the verification is complete.
pub(super) fn verify(
    path: &Path,
    range: PartRange<'_>,
    deep: bool,
    workers: &Workers<'_>,
) -> Result<Option<Part>, PartDefect> {
    let found = fs::symlink_metadata(path)?;
    if !found.is_file() {
        return Err(PartDefect::NotAFile(describe_entry(&found)));
    }
    if found.len() == 0 {
        return Err(PartDefect::Empty);
    }
    let mut file = File::open(path)?;
    let footer = read_footer(&mut file, found.len())?.ok_or(PartDefect::Footer)?;
    let part = verified(footer, found.len(), range)?;
    if deep {
        file.seek(SeekFrom::Start(0))?;
        match digest::of_reader(&mut file.take(part.data_bytes), || workers.stopped())? {
            None => return Ok(None),
            Some((hash, _)) if hash == part.data_sha256 => {}
            Some(_) => return Err(PartDefect::Changed),
        }
    }
    Ok(Some(part))
}

/// Verifies the footer of a part file, and returns the part that the footer describes.
///
/// * `len`: length of the part file \[B\].
fn verified(mut footer: Vec<u8>, len: u64, range: PartRange<'_>) -> Result<Part, PartDefect> {
    // The hash of the footer is verified before any other contents of the footer are used.
    let hash_place = place_of_hash(&footer).ok_or(PartDefect::Footer)?;
    let stored_hash = footer.get(hash_place.clone()).ok_or(PartDefect::Footer)?.to_owned();
    footer[hash_place].copy_from_slice(&ZEROS);
    if digest::of_bytes(&footer).as_bytes() != stored_hash {
        return Err(PartDefect::Footer);
    }
    let thrift = &footer[..footer.len() - TAIL];
    let metadata = catch_decoder_panic(|| Ok(ParquetMetaDataReader::decode_metadata(thrift)?));
    let metadata = metadata.map_err(|_| PartDefect::Footer)?;
    let metadata = metadata.file_metadata();
    let value = |key: &str| {
        let keys = metadata.key_value_metadata()?;
        keys.iter().rev().find(|entry| entry.key == key)?.value.as_deref()
    };
    let plan = value(PLAN).ok_or(PartDefect::Footer)?;
    if plan != range.plan {
        return Err(PartDefect::OtherPlan(plan.to_owned()));
    }
    let PartRange { number, first_row, rows, .. } = range;
    let found = value(PART).unwrap_or("?");
    if found != number.to_string() || value(ROWS) != Some(&format!("{first_row}:{rows}")) {
        return Err(PartDefect::OtherPart(found.to_owned()));
    }
    let integer = |key| value(key).and_then(|n| n.parse().ok()).ok_or(PartDefect::Footer);
    let (failed, with_other_solutions, data_bytes) =
        (integer(FAILED)?, integer(OTHER_SOLUTIONS)?, integer(DATA_BYTES)?);
    let data_sha256 = value(DATA_SHA256).ok_or(PartDefect::Footer)?.to_owned();
    let all_rows = u64::try_from(metadata.num_rows()) == Ok(rows);
    if data_bytes + footer.len() as u64 != len || !all_rows {
        return Err(PartDefect::Footer);
    }
    Ok(Part { number, first_row, rows, failed, with_other_solutions, data_bytes, data_sha256 })
}

/// Returns the length of a Parquet footer, including the bytes after it. Returns `None` if `tail`,
/// the last bytes of the file, is invalid.
fn footer_len(tail: [u8; TAIL]) -> Option<u64> {
    let [a, b, c, d, letters @ ..] = tail;
    let footer = u64::from(u32::from_le_bytes([a, b, c, d]));
    (letters == *b"PAR1" && footer <= MAX_FOOTER_BYTES).then_some(footer + TAIL as u64)
}

/// Reads the footer of a Parquet file, including the bytes after it. Returns `None` if the file has
/// no footer.
fn read_footer(file: &mut File, len: u64) -> io::Result<Option<Vec<u8>>> {
    let Some(at_tail) = len.checked_sub(TAIL as u64) else { return Ok(None) };
    let mut tail = [0; TAIL];
    file.seek(SeekFrom::Start(at_tail))?;
    file.read_exact(&mut tail)?;
    let Some(start) = footer_len(tail).and_then(|footer| len.checked_sub(footer)) else {
        return Ok(None);
    };
    file.seek(SeekFrom::Start(start))?;
    let (mut bytes, rest) = (Vec::new(), len - start);
    file.take(rest).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 == rest).then_some(bytes))
}

/// Returns the list of parts as a Parquet table, which is written to the file `parts.parquet` of a
/// dataset.
///
/// # Errors
///
/// Returns [`TableError`] if the table cannot be created.
pub(super) fn list_parts(parts: &BTreeMap<u64, Part>) -> Result<Vec<u8>, TableError> {
    let numbers = |read: fn(&Part) -> u64| -> ArrayRef {
        Arc::new(parts.values().map(read).collect::<UInt64Array>())
    };
    let hashes = StringArray::from_iter_values(parts.values().map(|part| &part.data_sha256));
    let table = RecordBatch::try_from_iter([
        ("part", numbers(|part| part.number)),
        ("first_row", numbers(|part| part.first_row)),
        ("rows", numbers(|part| part.rows)),
        ("failed", numbers(|part| part.failed)),
        ("several", numbers(|part| part.with_other_solutions)),
        ("bytes", numbers(|part| part.data_bytes)),
        ("data_sha256", Arc::new(hashes)),
    ])?;
    let mut writer = ArrowWriter::try_new(Vec::new(), table.schema(), None)?;
    writer.write(&table)?;
    Ok(writer.into_inner()?)
}
