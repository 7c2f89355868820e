//! Column chunks of Parquet: what repeats is written by runs, what varies by the places of its bytes.
//!
//! Few values are a dictionary and runs of keys. Numbers that vary get no dictionary: `BYTE_STREAM_SPLIT` puts
//! the bytes of one place of all numbers together, where Snappy finds what they have in common. Measured on
//! grids, that takes half the bytes of `PLAIN` in the same time.

use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::Hash;
use std::iter::repeat_n;

use bytes::Bytes;
use foldhash::fast::FixedState;
use parquet::basic::{Compression, Encoding, EncodingMask, PageType, Type};
use parquet::column::page::{CompressedPage, Page, PageWriter};
use parquet::column::writer::ColumnCloseResult;
use parquet::data_type::ByteArray;
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::{ColumnChunkMetaData, PageEncodingStats};
use parquet::file::statistics::Statistics;
use parquet::file::writer::{SerializedPageWriter, TrackedWrite};
use parquet::schema::types::ColumnDescPtr;
use snap::raw::Encoder;

/// How pages are packed.
pub(crate) const PACKED: Compression = Compression::SNAPPY;

/// A column chunk, and what the footer says of it.
pub(crate) type Encoded = (Bytes, ColumnCloseResult);

/// A value of a dictionary.
pub(crate) trait Word: Copy + Eq + Hash {
    /// Appends it as `PLAIN` has it.
    fn write(self, to: &mut Vec<u8>);
}

/// The bits of a number.
impl Word for u64 {
    fn write(self, to: &mut Vec<u8>) {
        to.extend(self.to_le_bytes());
    }
}

impl Word for &str {
    fn write(self, to: &mut Vec<u8>) {
        let length = u32::try_from(self.len()).unwrap_or(u32::MAX);
        to.extend(length.to_le_bytes());
        to.extend(self.as_bytes());
    }
}

/// Begins a run, or as many groups of eight values, in the hybrid of both: a number by seven bits.
fn header(mut number: usize, to: &mut Vec<u8>) {
    while number >= 0x80 {
        to.push(number.to_le_bytes()[0] | 0x80);
        number >>= 7;
    }
    to.push(number.to_le_bytes()[0]);
}

/// Which rows have a value, by runs.
#[derive(Debug, Default)]
struct Levels {
    bytes: Vec<u8>,
    /// The run that goes on.
    there: bool,
    run: usize,
    rows: usize,
    nulls: usize,
}

impl Levels {
    fn push(&mut self, there: bool, rows: usize) {
        if there != self.there {
            self.end_run();
            self.there = there;
        }
        self.run += rows;
        self.rows += rows;
        self.nulls += if there { 0 } else { rows };
    }

    fn end_run(&mut self) {
        if self.run > 0 {
            header(self.run << 1, &mut self.bytes);
            self.bytes.push(self.there.into());
            self.run = 0;
        }
    }

    /// The page of these rows with what `values` appends behind the levels, if the column may have rows without.
    fn page(
        mut self,
        column: &ColumnDescPtr,
        encoding: Encoding,
        values: impl FnOnce(&mut Vec<u8>),
    ) -> Result<CompressedPage> {
        let mut page = Vec::new();
        if column.max_def_level() > 0 {
            self.end_run();
            page.extend(count(self.bytes.len())?.to_le_bytes());
            page.extend(&self.bytes);
        }
        values(&mut page);
        let (length, rle) = (page.len(), Encoding::RLE);
        let page = Page::DataPage {
            buf: packed(&page)?,
            num_values: count(self.rows)?,
            encoding,
            def_level_encoding: rle,
            rep_level_encoding: rle,
            statistics: None,
        };
        Ok(CompressedPage::new(page, length))
    }
}

/// A number as pages have it.
fn count(number: usize) -> Result<u32> {
    let fits = i32::try_from(number).ok().and_then(|n| u32::try_from(n).ok());
    fits.ok_or_else(|| ParquetError::General(format!("{number} is too much for a page")))
}

fn packed(page: &[u8]) -> Result<Bytes> {
    let packed = Encoder::new().compress_vec(page);
    Ok(packed.map_err(|error| ParquetError::External(Box::new(error)))?.into())
}

/// Equal keys that are a run; fewer stand one by one.
const LEAST_RUN: usize = 8;

/// Rows as keys of a dictionary, in runs.
#[derive(Debug)]
pub(crate) struct Keys<T> {
    words: Vec<T>,
    places: HashMap<T, u16, FixedState>,
    /// Place of the last word.
    last: u16,
    /// Bytes of a key.
    width: usize,
    /// Words that there may be.
    most: u16,
    levels: Levels,
    bytes: Vec<u8>,
    /// Keys that stand one by one, in groups of eight.
    single: Vec<u16>,
}

impl<T: Word> Keys<T> {
    /// No rows, with room for some words.
    pub(crate) fn new(most: u16) -> Self {
        Self {
            words: Vec::new(),
            places: HashMap::default(),
            last: 0,
            width: if most <= 1 << 8 { 1 } else { 2 },
            most,
            levels: Levels::default(),
            bytes: Vec::new(),
            single: Vec::new(),
        }
    }

    /// Appends rows of the same value; false if it would be one word too many.
    pub(crate) fn push(&mut self, word: Option<T>, rows: usize) -> bool {
        if let Some(word) = word {
            let next = self.next();
            self.last = if self.words.get(usize::from(next)) == Some(&word) {
                next
            } else if let Some(place) = self.places.get(&word) {
                *place
            } else if let Some(place) =
                u16::try_from(self.words.len()).ok().filter(|place| *place < self.most)
            {
                self.places.insert(word, place);
                self.words.push(word);
                place
            } else {
                return false;
            };
            self.push_key(rows);
        }
        self.levels.push(word.is_some(), rows);
        true
    }

    /// A grid goes on as it did before: the next word, and after the last one the first.
    fn next(&self) -> u16 {
        if usize::from(self.last) + 1 < self.words.len() { self.last + 1 } else { 0 }
    }

    /// Appends the key of the last word.
    fn push_key(&mut self, rows: usize) {
        // What lacks to a group of eight.
        let lacks = self.single.len().wrapping_neg() % LEAST_RUN;
        let single = if rows < lacks + LEAST_RUN { rows } else { lacks };
        self.single.extend(repeat_n(self.last, single));
        if rows > single {
            self.end_single();
            header((rows - single) << 1, &mut self.bytes);
            self.bytes.extend_from_slice(&self.last.to_le_bytes()[..self.width]);
        }
    }

    fn end_single(&mut self) {
        let groups = self.single.len().div_ceil(LEAST_RUN);
        if groups > 0 {
            self.single.resize(groups * LEAST_RUN, 0);
            header(groups << 1 | 1, &mut self.bytes);
            let keys = self.single.iter();
            if self.width == 1 {
                self.bytes.extend(keys.map(|key| key.to_le_bytes()[0]));
            } else {
                self.bytes.extend(keys.flat_map(|key| key.to_le_bytes()));
            }
            self.single.clear();
        }
    }

    /// The dictionary and the keys; neither without rows, no dictionary without values.
    fn pages(mut self, column: &ColumnDescPtr) -> Result<Vec<CompressedPage>> {
        if self.levels.rows == 0 {
            return Ok(Vec::new());
        }
        if self.words.is_empty() {
            return Ok(vec![self.levels.page(column, Encoding::PLAIN, |_| {})?]);
        }
        let mut plain = Vec::new();
        self.words.iter().for_each(|word| word.write(&mut plain));
        let dictionary = Page::DictionaryPage {
            buf: packed(&plain)?,
            num_values: count(self.words.len())?,
            encoding: Encoding::PLAIN,
            is_sorted: false,
        };
        self.end_single();
        let bits_of_key = if self.width == 1 { 8 } else { 16 };
        let keys = self.levels.page(column, Encoding::RLE_DICTIONARY, |page| {
            page.push(bits_of_key);
            page.append(&mut self.bytes);
        })?;
        Ok(vec![CompressedPage::new(dictionary, plain.len()), keys])
    }
}

impl Keys<u64> {
    /// Appends numbers for as long as they go on as a grid does, none like the one after it; returns how many.
    fn push_next(&mut self, rows: &[f64]) -> usize {
        let mut pushed = 0;
        while pushed < rows.len() {
            let (next, rest) = (self.next(), &rows[pushed..]);
            let mut more = alike(&self.words[usize::from(next)..], rest);
            let same = |x: &f64| x.to_bits() == rest[more - 1].to_bits();
            if more > 0 && rest.get(more).is_some_and(same) {
                // A run begins.
                more -= 1;
            }
            let Some(end) = u16::try_from(more).ok().filter(|n| *n > 0).map(|n| next + n) else {
                break;
            };
            self.single.extend(next..end);
            self.last = end - 1;
            pushed += more;
        }
        if pushed > 0 {
            self.levels.push(true, pushed);
        }
        pushed
    }
}

/// How many numbers at the beginning of `rows` are these words.
fn alike(words: &[u64], rows: &[f64]) -> usize {
    /// Compared at once, whatever the first ones are.
    const BLOCK: usize = 64;
    let same = |(word, x): (&u64, &f64)| *word == x.to_bits();
    let blocks = words.chunks_exact(BLOCK).zip(rows.chunks_exact(BLOCK));
    let all = |(words, rows): &(&[u64], &[f64])| {
        words.iter().zip(*rows).fold(true, |all, pair| all & same(pair))
    };
    let first = BLOCK * blocks.take_while(all).count();
    first + words[first..].iter().zip(&rows[first..]).take_while(|pair| same(*pair)).count()
}

impl Keys<&'static str> {
    /// The column chunk.
    pub(crate) fn finish(self, column: &ColumnDescPtr) -> Result<Encoded> {
        let end = |word: Option<&&str>| word.map(|word| ByteArray::from(*word));
        let (least, most) = (end(self.words.iter().min()), end(self.words.iter().max()));
        let nulls = self.levels.nulls as u64;
        let mut pages = Pages::default();
        let statistics = Statistics::byte_array(least, most, None, Some(nulls), false);
        pages.write(self.pages(column)?)?;
        pages.finish(column, statistics)
    }
}

/// A number as it stands in the file.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
fn bits(value: f64, whole: bool) -> u64 {
    if whole { value as u64 } else { value.to_bits() }
}

/// A column chunk of numbers, NaN or not.
#[derive(Debug)]
pub(crate) struct Numbers {
    column: ColumnDescPtr,
    /// True for whole numbers without sign, false for `f64`.
    whole: bool,
    /// Words that a dictionary may have.
    most: u16,
    /// The rows at the beginning, until there were too many words.
    keys: Keys<u64>,
    varies: bool,
    /// All other rows.
    pages: Pages,
    least: f64,
    greatest: f64,
    nulls: usize,
}

impl Numbers {
    /// No rows; `most` is the size of a dictionary.
    pub(crate) fn new(column: ColumnDescPtr, most: u16) -> Self {
        Self {
            whole: column.physical_type() == Type::INT64,
            column,
            most,
            keys: Keys::new(most),
            varies: false,
            pages: Pages::default(),
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            nulls: 0,
        }
    }

    /// Appends rows; all have a value unless `there` says which.
    pub(crate) fn push(&mut self, values: &[f64], there: Option<&[bool]>) -> Result<()> {
        let mut first = 0;
        if !self.varies {
            first = self.push_keys(values, there);
            self.varies = first < values.len();
            if self.varies && self.keys.levels.rows == first {
                // All rows are like these.
                self.keys = Keys::new(self.most);
                first = 0;
            }
        }
        if first < values.len() {
            self.push_page(&values[first..], there.map(|there| &there[first..]))?;
        }
        Ok(())
    }

    /// Appends rows as keys, and returns the first one that the dictionary has no room for.
    fn push_keys(&mut self, values: &[f64], there: Option<&[bool]>) -> usize {
        let is_there = |row: usize| there.is_none_or(|there| there[row]);
        let same = |a: usize, b: usize| {
            values[a].to_bits() == values[b].to_bits() && is_there(a) == is_there(b)
        };
        let mut row = 0;
        while row < values.len() {
            if there.is_none() && self.keys.words.len() > 1 {
                row += self.keys.push_next(&values[row..]);
                if row == values.len() {
                    break;
                }
            }
            let mut end = row + 1;
            while end < values.len() && same(row, end) {
                end += 1;
            }
            let word = is_there(row).then(|| values[row].to_bits());
            if !self.keys.push(word, end - row) {
                break;
            }
            row = end;
        }
        row
    }

    /// Appends rows as a page of their own.
    fn push_page(&mut self, values: &[f64], there: Option<&[bool]>) -> Result<()> {
        let mut levels = Levels::default();
        let given: Cow<'_, [f64]> = if let Some(there) = there {
            for there in there {
                levels.push(*there, 1);
            }
            values.iter().zip(there).filter_map(|(value, there)| there.then_some(*value)).collect()
        } else {
            levels.push(true, values.len());
            values.into()
        };
        self.widen(&given);
        self.nulls += levels.nulls;
        let whole = self.whole;
        let plain = whole || given.is_empty();
        let encoding = if plain { Encoding::PLAIN } else { Encoding::BYTE_STREAM_SPLIT };
        let page = levels.page(&self.column, encoding, |page| {
            if plain {
                page.extend(given.iter().flat_map(|x| bits(*x, whole).to_le_bytes()));
            } else {
                by_places(&given, page);
            }
        })?;
        self.pages.write(vec![page])
    }

    /// Puts values between the least and the greatest one; NaN is none.
    fn widen(&mut self, values: &[f64]) {
        let ends = values.iter().fold((self.least, self.greatest), |(least, greatest), x| {
            (if *x < least { *x } else { least }, if *x > greatest { *x } else { greatest })
        });
        (self.least, self.greatest) = ends;
    }

    /// The column chunk.
    pub(crate) fn finish(mut self) -> Result<Encoded> {
        let words: Vec<_> = self.keys.words.iter().map(|word| f64::from_bits(*word)).collect();
        self.widen(&words);
        self.keys.words = words.iter().map(|value| bits(*value, self.whole)).collect();
        self.nulls += self.keys.levels.nulls;
        // There may be none, or only NaN; which zero it was is not told.
        let any = self.least <= self.greatest;
        let [least, greatest] = [(self.least, -0.0), (self.greatest, 0.0)]
            .map(|(end, zero)| any.then_some(if end.abs() > 0.0 { end } else { zero }));
        let nulls = Some(self.nulls as u64);
        let statistics = if self.whole {
            #[expect(clippy::cast_possible_truncation, reason = "small counts")]
            let [least, greatest] = [least, greatest].map(|end| end.map(|end| end as i64));
            Statistics::int64(least, greatest, None, nulls, false)
        } else {
            Statistics::double(least, greatest, None, nulls, false)
        };
        let mut pages = Pages::default();
        pages.write(self.keys.pages(&self.column)?)?;
        pages.append(self.pages);
        pages.finish(&self.column, statistics)
    }
}

/// Appends the first bytes of all numbers, then all second ones, and so on: `BYTE_STREAM_SPLIT`.
///
/// * `values`: one at least.
fn by_places(values: &[f64], to: &mut Vec<u8>) {
    const BLOCK: usize = 64;
    let first = to.len();
    to.resize(first + 8 * values.len(), 0);
    let mut places: Vec<_> = to[first..].chunks_exact_mut(values.len()).collect();
    // The halves of numbers first: twice as many of them are shifted at once.
    let mut halves = [[0_u32; BLOCK]; 2];
    for (block, values) in values.chunks(BLOCK).enumerate() {
        for (i, value) in values.iter().enumerate() {
            let [a, b, c, d, e, f, g, h] = value.to_le_bytes();
            halves[0][i] = u32::from_le_bytes([a, b, c, d]);
            halves[1][i] = u32::from_le_bytes([e, f, g, h]);
        }
        for (place, bytes) in places.iter_mut().enumerate() {
            let shift = 8 * (place % 4);
            for (byte, half) in bytes[BLOCK * block..].iter_mut().zip(&halves[place / 4]) {
                *byte = (half >> shift).to_le_bytes()[0];
            }
        }
    }
}

/// Pages of a column chunk, one behind the other.
#[derive(Debug, Default)]
struct Pages {
    bytes: Vec<u8>,
    /// Length of the dictionary, which is first.
    dictionary: Option<usize>,
    /// Length before packing.
    unpacked: usize,
    rows: usize,
    encodings: Vec<PageEncodingStats>,
}

impl Pages {
    fn write(&mut self, pages: Vec<CompressedPage>) -> Result<()> {
        let mut out = TrackedWrite::new(&mut self.bytes);
        let mut writer = SerializedPageWriter::new(&mut out);
        for page in pages {
            let (page_type, encoding, rows) =
                (page.page_type(), page.encoding(), page.num_values());
            let written = writer.write_page(page)?;
            self.unpacked += written.uncompressed_size;
            if page_type == PageType::DICTIONARY_PAGE {
                self.dictionary = Some(written.compressed_size);
            } else {
                self.rows += rows as usize;
            }
            self.encodings.push(PageEncodingStats { page_type, encoding, count: 1 });
        }
        Ok(())
    }

    /// Appends pages without a dictionary.
    fn append(&mut self, mut other: Self) {
        if self.bytes.is_empty() {
            *self = other;
        } else {
            self.bytes.append(&mut other.bytes);
            self.unpacked += other.unpacked;
            self.rows += other.rows;
            self.encodings.append(&mut other.encodings);
        }
    }

    fn finish(self, column: &ColumnDescPtr, statistics: Statistics) -> Result<Encoded> {
        let Self { bytes, dictionary, unpacked, rows, encodings } = self;
        let (length, rows) = (bytes.len() as u64, rows as u64);
        let signed = |number: u64| i64::try_from(number).unwrap_or(i64::MAX);
        let mut kinds = vec![Encoding::RLE];
        kinds.extend(encodings.iter().map(|page| page.encoding));
        let metadata = ColumnChunkMetaData::builder(column.clone())
            .set_compression(PACKED)
            .set_encodings_mask(EncodingMask::new_from_encodings(kinds.iter()))
            .set_page_encoding_stats(encodings)
            .set_total_compressed_size(signed(length))
            .set_total_uncompressed_size(signed(unpacked as u64))
            .set_num_values(signed(rows))
            .set_dictionary_page_offset(dictionary.map(|_| 0))
            .set_data_page_offset(signed(dictionary.unwrap_or(0) as u64))
            .set_statistics(statistics)
            .build()?;
        let close = ColumnCloseResult {
            bytes_written: length,
            rows_written: rows,
            metadata,
            bloom_filter: None,
            column_index: None,
            offset_index: None,
        };
        Ok((bytes.into(), close))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arrow_array::ArrayRef;
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, Int64Type};
    use parquet::arrow::arrow_reader::ParquetRecordBatchReader;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use rand::{Rng, RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A file with one column, which readers find as it says it is.
    fn file(column: &str, encode: impl FnOnce(&ColumnDescPtr) -> Result<Encoded>) -> Bytes {
        let schema = parse_message_type(&format!("message m {{ {column}; }}")).expect("a schema");
        let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::default());
        let file_writer = file.as_mut().expect("memory");
        let column = file_writer.schema_descr().column(0);
        let (bytes, close) = encode(&column).expect("encoded");
        let mut group = file_writer.next_row_group().expect("memory");
        group.append_column(&bytes, close).expect("a column");
        group.close().expect("a row group");
        file.expect("memory").into_inner().expect("memory").into()
    }

    fn read(file: &Bytes) -> Vec<ArrayRef> {
        let batches = ParquetRecordBatchReader::try_new(file.clone(), 1000).expect("a table");
        batches.map(|batch| batch.expect("rows").column(0).clone()).collect()
    }

    fn statistics(file: &Bytes) -> Statistics {
        let reader = SerializedFileReader::new(file.clone()).expect("a footer");
        reader.metadata().row_group(0).column(0).statistics().expect("statistics").clone()
    }

    /// Values as tables have them: constant, in runs, as an axis of a grid, a few, all different.
    fn value(kind: usize, row: usize, rng: &mut impl Rng) -> f64 {
        const FEW: [f64; 5] = [0.0, -0.0, f64::NAN, 1e300, -2.5];
        match kind {
            0 => 7.0,
            1 => f64::from(u32::try_from(row / 29).expect("small")),
            2 => f64::from(u32::try_from(row % 37).expect("small")) / 36.0,
            3 => FEW[rng.random_range(0..FEW.len())],
            _ => rng.random_range(-1.0..1.0),
        }
    }

    /// Every way a column may go on: keys of both widths, a dictionary that fills up in the first chunk or in
    /// a later one, gaps, and columns that change their kind.
    #[test]
    fn numbers_are_read_as_they_were_pushed() {
        let mut rng = ChaCha8Rng::seed_from_u64(20);
        for _ in 0..600 {
            let most = [1, 4, 40, 300, 1 << 14][rng.random_range(0..5)];
            let gaps = [0.0, 0.0, 0.02, 0.6, 1.0][rng.random_range(0..5)];
            let (mut kind, mut expected, mut whole) = (rng.random_range(0..5), Vec::new(), None);
            let bytes = file("optional double x", |column| {
                let mut numbers = Numbers::new(column.clone(), most);
                for _ in 0..rng.random_range(1..5) {
                    let first = expected.len();
                    for row in first..first + rng.random_range(1..700) {
                        let there = rng.random::<f64>() >= gaps;
                        expected.push(there.then(|| value(kind, row, &mut rng)));
                    }
                    let rows = &expected[first..];
                    let values: Vec<_> = rows.iter().map(|x| x.unwrap_or(f64::NAN)).collect();
                    let there: Vec<_> = rows.iter().map(Option::is_some).collect();
                    numbers.push(&values, there.contains(&false).then_some(&there[..]))?;
                    if rng.random_range(0..4) == 0 {
                        kind = rng.random_range(0..5);
                    }
                }
                whole = Some(numbers.varies);
                numbers.finish()
            });
            let bits = |x: Option<f64>| x.map(f64::to_bits);
            let found: Vec<_> = read(&bytes)
                .iter()
                .flat_map(|array| array.as_primitive::<Float64Type>().iter().collect::<Vec<_>>())
                .map(bits)
                .collect();
            let wanted: Vec<_> = expected.iter().map(|x| bits(*x)).collect();
            assert!(found == wanted, "{most} words, gaps {gaps}, varies {whole:?}");

            let numbers = || expected.iter().flatten().filter(|x| !x.is_nan());
            let Statistics::Double(told) = statistics(&bytes) else { panic!("no numbers") };
            let least = numbers().copied().reduce(f64::min);
            let greatest = numbers().copied().reduce(f64::max);
            assert_eq!((told.min_opt().copied(), told.max_opt().copied()), (least, greatest));
            let nulls = expected.iter().filter(|x| x.is_none()).count();
            assert_eq!(told.null_count_opt(), Some(nulls as u64));
        }
    }

    /// More counts than a dictionary has room for stand in full.
    #[test]
    fn counts_are_whole_numbers() {
        for most in [2_u16, 300] {
            let bytes = file("optional int64 x", |column| {
                let mut counts = Numbers::new(column.clone(), most);
                counts.push(&[3.0, 3.0, 5.0], None)?;
                counts.push(&[5.0, f64::NAN, 9.0], Some(&[true, false, true]))?;
                counts.finish()
            });
            let found: Vec<_> = read(&bytes)[0].as_primitive::<Int64Type>().iter().collect();
            assert_eq!(found, [Some(3), Some(3), Some(5), Some(5), None, Some(9)]);
            let Statistics::Int64(told) = statistics(&bytes) else { panic!("no counts") };
            assert_eq!((told.min_opt(), told.max_opt()), (Some(&3), Some(&9)));
        }
    }

    /// A million equal words take no more bytes than a few.
    #[test]
    fn words_cost_by_the_run() {
        let names = [Some("rigid"), None, Some("elastic"), Some("rigid")];
        let rows = [250_000, 3, 17, 750_000];
        let bytes = file("optional binary x (UTF8)", |column| {
            let mut keys = Keys::new(4);
            for (name, rows) in names.into_iter().zip(rows) {
                assert!(keys.push(name, rows));
            }
            let encoded = keys.finish(column)?;
            assert!(encoded.0.len() < 200, "{} bytes", encoded.0.len());
            Ok(encoded)
        });
        let mut found = Vec::new();
        for array in read(&bytes) {
            found.extend(array.as_string::<i32>().iter().map(|name| name.map(str::to_owned)));
        }
        let wanted =
            names.into_iter().zip(rows).flat_map(|(name, rows)| std::iter::repeat_n(name, rows));
        assert!(found.iter().map(Option::as_deref).eq(wanted));
        let Statistics::ByteArray(told) = statistics(&bytes) else { panic!("no words") };
        let ends = [told.min_opt(), told.max_opt()].map(|end| end.expect("words").data().to_vec());
        assert_eq!(ends, [b"elastic".to_vec(), b"rigid".to_vec()]);
        assert_eq!(told.null_count_opt(), Some(3));
    }
}
