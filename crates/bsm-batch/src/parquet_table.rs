//! Reads and writes Parquet tables, whose column metadata contain the units.

use std::io::Write;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::{Array, RecordBatch, StringArray};
use arrow_schema::{DataType, FieldRef, Fields, Schema, SchemaRef};
use arrow_select::concat::concat_batches;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReader,
    ParquetRecordBatchReaderBuilder,
};
use parquet::arrow::arrow_writer::{ArrowColumnWriter, ArrowRowGroupWriterFactory, compute_leaves};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::ChunkReader;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::ColumnPath;
use rayon::prelude::*;

use crate::columns::Columns;
use crate::pages::Pages;
use crate::panics::catch_panic;
use crate::rows::ROWS_PER_CHUNK;
use crate::rows::{Chunk, MAX_TEXT_BYTES};
use crate::{Source, TableError, TableFormat, arrow_column};

/// Returns the result of `decode`, and converts a panic to an error. Version 59.3 of the parquet
/// crate contains seven panics that damaged tables can cause, for example if a page refers to a
/// missing dictionary or if a column has a negative offset. In a test with 100 000 small tables,
/// each with one to three damaged bytes, 0.4 % of the tables caused such a panic.
pub(crate) fn catch_decoder_panic<T>(
    decode: impl FnOnce() -> Result<T, TableError>,
) -> Result<T, TableError> {
    catch_panic(decode).unwrap_or_else(|| Err(TableError::Parquet("it is damaged".to_owned())))
}

/// Returns the fields of a table with their Arrow types. Parquet stores durations as integers, and
/// only the Arrow schema in the metadata of the file identifies them as durations.
fn with_temporal_types(found: &ArrowReaderMetadata) -> Fields {
    let plain = found.schema().fields();
    let stored = || {
        let options = ArrowReaderOptions::new();
        ArrowReaderMetadata::try_new(found.metadata().clone(), options).ok()
    };
    let Some(stored) = catch_panic(stored).flatten() else { return plain.clone() };
    let field = |(plain, stored): (&FieldRef, &FieldRef)| {
        let is_time = plain.data_type().is_integer() && stored.data_type().is_temporal();
        if is_time { stored.clone() } else { plain.clone() }
    };
    plain.iter().zip(stored.schema().fields()).map(field).collect()
}

/// Reads the rows of a Parquet table.
pub struct ParquetSource {
    reader: ParquetRecordBatchReader,
    /// Function that returns a reader that starts at a given row.
    from_row: Box<dyn Fn(u64) -> Result<ParquetRecordBatchReader, TableError> + Send>,
    columns: Columns,
    len: u64,
    row: u64,
    /// Number of rows in all batches that have been read so far.
    read: u64,
    /// Rows of the last batch that have not been returned yet.
    rest: Option<RecordBatch>,
}

impl ParquetSource {
    /// Opens a Parquet table and reads its metadata.
    ///
    /// * `table_format`: assignment of column names to inputs.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the file is not a Parquet file, or if a column is neither a
    /// numeric input nor in `keep`.
    pub fn new(
        file: impl ChunkReader + 'static,
        keep: &[String],
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        catch_decoder_panic(|| Self::open(file, keep, table_format))
    }

    fn open(
        file: impl ChunkReader + 'static,
        keep: &[String],
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        // The Arrow types that the file stores are skipped here, because the parquet crate panics
        // if the stored types are damaged. Only `with_temporal_types` needs the Arrow types.
        let plain = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
        let found = ArrowReaderMetadata::load(&file, plain)?;
        let fields = with_temporal_types(&found);
        let mut columns =
            Columns::sort(fields.iter().map(|f| f.name().as_str()), keep, table_format)?;
        for (key, index) in columns.inputs.iter().zip(&columns.input_places) {
            let found = fields[*index].data_type();
            if !(found.is_numeric() || *found == DataType::Null) {
                let name = key.name();
                let found = arrow_column::kind(found);
                let message = format!("column `{name}` contains {found}, but must contain numbers");
                return Err(TableError::Column { name: name.to_owned(), message });
            }
        }
        for (index, (name, at)) in columns.kept.iter().zip(&columns.kept_places).enumerate() {
            columns.kept_types[index] = match fields[*at].data_type() {
                found if found.is_nested() => return Err(TableError::nested_column(name)),
                DataType::LargeUtf8 => DataType::Utf8,
                found => found.clone(),
            };
        }
        // Texts are read as view arrays, which store a text only once even if it occurs in many
        // rows.
        let views = fields.iter().map(|field| match field.data_type() {
            DataType::Utf8 | DataType::LargeUtf8 => {
                Arc::new(field.as_ref().clone().with_data_type(DataType::Utf8View))
            }
            _ => field.clone(),
        });
        let schema = Arc::new(Schema::new(views.collect::<Vec<_>>()));
        let options = ArrowReaderOptions::new().with_schema(schema);
        let metadata = ArrowReaderMetadata::try_new(found.metadata().clone(), options)?;
        let len = u64::try_from(metadata.metadata().file_metadata().num_rows()).unwrap_or(0);
        // Only columns that are inputs or are copied are read from the file.
        let mut read = [&columns.input_places[..], &columns.kept_places].concat();
        read.sort_unstable();
        let mask = ProjectionMask::roots(metadata.parquet_schema(), read.iter().copied());
        for index in columns.input_places.iter_mut().chain(&mut columns.kept_places) {
            *index = read.partition_point(|other| other < index);
        }
        for group in metadata.metadata().row_groups() {
            for (leaf, chunk) in group.columns().iter().enumerate() {
                let unread = match chunk.compression() {
                    // Brotli pages are rejected, because they can expand to any size, regardless of
                    // the size in the page header.
                    Compression::BROTLI(_) => "Brotli",
                    Compression::LZO => "LZO",
                    _ => continue,
                };
                if mask.leaf_included(leaf) {
                    return Err(TableError::unsupported(&format!("{unread} compression")));
                }
            }
        }
        let file = Pages::new(file, read.len());
        let from_row = Box::new(move |row: u64| {
            // Row groups that end before the requested row are skipped without reading them.
            let (mut group, mut skipped) = (0, 0);
            let groups = metadata.metadata().row_groups();
            while let Some(rows) = groups.get(group).and_then(|g| u64::try_from(g.num_rows()).ok())
                && skipped + rows <= row
            {
                skipped += rows;
                group += 1;
            }
            let (file, metadata) = (file.clone(), metadata.clone());
            let builder =
                ParquetRecordBatchReaderBuilder::new_with_metadata(file, metadata.clone())
                    .with_row_groups((group..metadata.metadata().num_row_groups()).collect())
                    .with_offset(usize::try_from(row - skipped).unwrap_or(usize::MAX));
            Ok(builder.with_projection(mask.clone()).build()?)
        });
        let reader = from_row(0)?;
        Ok(Self { reader, from_row, columns, len, row: 0, read: 0, rest: None })
    }

    /// Returns the remaining rows of the last batch or, if no rows remain, the next batch.
    fn batch(&mut self) -> Result<Option<RecordBatch>, TableError> {
        if let Some(batch) = self.rest.take() {
            return Ok(Some(batch));
        }
        let batch = catch_decoder_panic(|| Ok(self.reader.next().transpose()?))?;
        self.read += batch.as_ref().map_or(0, |batch| batch.num_rows() as u64);
        if batch.is_none() && self.read != self.len {
            return Err(TableError::Malformed(format!(
                "according to its metadata, the table has {} rows, but it contains {} rows; the file is damaged",
                self.len, self.read
            )));
        }
        Ok(batch)
    }
}

impl Source for ParquetSource {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn len_hint(&self) -> Option<u64> {
        Some(self.len)
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let (mut parts, mut len, mut text) = (Vec::new(), 0, 0);
        while len < rows && text < MAX_TEXT_BYTES {
            let Some(batch) = self.batch()? else { break };
            let columns = self.columns.kept_places.iter().map(|index| batch.column(*index));
            let texts: Vec<_> = columns.filter_map(|c| c.as_string_view_opt()).collect();
            let mut taken = 0;
            while taken < batch.num_rows() && len < rows && text < MAX_TEXT_BYTES {
                text += texts.iter().map(|texts| texts.value(taken).len()).sum::<usize>();
                len += 1;
                taken += 1;
            }
            parts.push(batch.slice(0, taken));
            if taken < batch.num_rows() {
                self.rest = Some(batch.slice(taken, batch.num_rows() - taken));
            }
        }
        if len == 0 {
            return Ok(None);
        }
        let (table, columns) = (concat_batches(&parts[0].schema(), &parts)?, &self.columns);
        let kept = |(index, kind): (&usize, &DataType)| match table.column(*index) {
            views if *kind == DataType::Utf8 && *views.data_type() == DataType::Utf8View => {
                Arc::new(views.as_string_view().iter().collect::<StringArray>())
            }
            other => other.clone(),
        };
        let input = |(input, index): (usize, &usize)| {
            let numbers = arrow_column::numbers(table.column(*index))?;
            Ok(columns.in_unit(input, numbers.into()))
        };
        let kept = columns.kept_places.iter().zip(&columns.kept_types).map(kept).collect();
        let inputs = columns.input_places.iter().enumerate().map(input);
        let (first, inputs) = (self.row + 1, inputs.collect::<Result<_, TableError>>()?);
        self.row += len as u64;
        Ok(Some(Chunk { first, len, inputs, kept, ..Chunk::default() }))
    }

    fn skip(&mut self, rows: u64) -> Result<(), TableError> {
        if rows > 0 {
            self.row = self.row.saturating_add(rows).min(self.len);
            (self.read, self.rest) = (self.row, None);
            self.reader = catch_decoder_panic(|| (self.from_row)(self.row))?;
        }
        Ok(())
    }
}

/// Number of rows per row group, a multiple of the chunk size. Larger row groups would need more
/// memory, and smaller row groups would slow down readers.
const ROW_GROUP: usize = 1 << 18;

/// Returns the compression and encoding settings for the columns of a table.
/// The encoding `BYTE_STREAM_SPLIT` stores the first bytes of all numbers together, then all second
/// bytes, and so on, so that Snappy can compress similar numbers. Dictionaries of numbers would
/// take twice the time and twice the space. This was measured on a grid with the `rigid` model,
/// with one output and with all outputs.
fn properties(schema: &Schema) -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        // Each data page contains one chunk.
        .set_data_page_row_count_limit(ROWS_PER_CHUNK)
        // Without an offset index, the footer follows directly after the rows, so a single hash can
        // cover all bytes before the footer.
        .set_offset_index_disabled(true)
        .set_statistics_enabled(EnabledStatistics::Chunk);
    for field in schema.fields() {
        let column = ColumnPath::new(vec![field.name().clone()]);
        properties = match field.data_type() {
            DataType::Float64 => properties
                .set_column_dictionary_enabled(column.clone(), false)
                .set_column_encoding(column, Encoding::BYTE_STREAM_SPLIT),
            // No statistics are written for text columns, because calculating them takes nearly as
            // long as encoding the column (12 and 16 ns per row). Text columns contain only a few
            // distinct texts, which readers find in the dictionary.
            DataType::Utf8 => {
                properties.set_column_statistics_enabled(column, EnabledStatistics::None)
            }
            _ => properties,
        };
    }
    properties.build()
}

/// Writes a Parquet table, whose column metadata contain the units.
pub(crate) struct ParquetSink<W: Write + Send> {
    file: SerializedFileWriter<W>,
    schema: SchemaRef,
    writers: ArrowRowGroupWriterFactory,
    /// Column writers of the current row group. The list is empty if no row group has been started.
    group: Vec<ArrowColumnWriter>,
    rows: usize,
}

impl<W: Write + Send> ParquetSink<W> {
    /// Starts a table and writes its schema.
    pub(crate) fn new(writer: W, schema: SchemaRef) -> Result<Self, TableError> {
        let properties = properties(&schema);
        let writer = ArrowWriter::try_new(writer, schema.clone(), Some(properties))?;
        let (file, writers) = writer.into_serialized_writer()?;
        Ok(Self { file, schema, writers, group: Vec::new(), rows: 0 })
    }

    /// Writes rows. The columns are encoded in parallel.
    pub(crate) fn write(&mut self, table: &RecordBatch) -> Result<(), TableError> {
        if self.group.is_empty() {
            let index = self.file.flushed_row_groups().len();
            self.group = self.writers.create_column_writers(index)?;
        }
        let columns = self.group.par_iter_mut().zip(&self.schema.fields()[..]);
        columns.zip(table.columns()).try_for_each(|((writer, field), column)| {
            compute_leaves(field, column)?.iter().try_for_each(|leaf| writer.write(leaf))
        })?;
        self.rows += table.num_rows();
        if self.rows >= ROW_GROUP {
            self.end_group()?;
        }
        Ok(())
    }

    fn end_group(&mut self) -> Result<(), TableError> {
        if self.rows > 0 {
            let mut group = self.file.next_row_group()?;
            for writer in self.group.drain(..) {
                writer.close()?.append_to_row_group(&mut group)?;
            }
            group.close()?;
            self.rows = 0;
        }
        Ok(())
    }

    /// Writes the remaining rows and the footer, and returns the underlying writer. The function
    /// `keys` returns additional metadata for the footer. It is called after everything before the
    /// footer has been written.
    pub(crate) fn finish(
        mut self,
        keys: impl FnOnce(&mut W) -> Vec<(&'static str, String)>,
    ) -> Result<W, TableError> {
        self.end_group()?;
        self.file.flush()?;
        for (key, value) in keys(self.file.inner_mut()) {
            self.file.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
        }
        Ok(self.file.into_inner()?)
    }
}
