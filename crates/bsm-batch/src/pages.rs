//! Reads the pages of Parquet files. The sizes in a page header are checked before memory is
//! allocated.

use std::io::{self, Cursor, Read};
use std::sync::Arc;

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};

/// Number of bytes that are sufficient to check a page header \[B\]. The checked part of the header
/// consists of at most six fields of up to six bytes each, and of the beginning of a structure.
const MAX_HEADER_BYTES: u64 = 40;

/// Page type in the header of a dictionary page.
const DICTIONARY: i32 = 2;

/// Byte that precedes a 32-bit integer field in the Thrift compact protocol, if the field number is
/// one higher than the number of the previous field.
const INTEGER: u8 = 0x15;

/// A Parquet file that several readers share.
///
/// Before the parquet crate decompresses a page, it allocates and fills as much memory as the page
/// header specifies, up to 2 GB. In a file of 2 kB, a damaged header caused an allocation of 291
/// MB. Therefore, a page is rejected if its header specifies more bytes than a file of the given
/// size can reasonably contain.
pub(crate) struct Pages<R> {
    file: Arc<R>,
    /// Maximum number of bytes that a page header may specify.
    max_page_bytes: u64,
}

impl<R: ChunkReader> Pages<R> {
    /// Creates a reader for the pages of a file. `columns` is the number of columns that are read
    /// at the same time.
    pub(crate) fn new(file: R, columns: usize) -> Self {
        // At any time, one data page and one dictionary page of each column are in memory. All
        // these pages together must not exceed 64 MiB plus 256 times the file size.
        let max_bytes = (32 << 20) + file.len().saturating_mul(128);
        Self { file: Arc::new(file), max_page_bytes: max_bytes / (columns as u64).max(1) }
    }
}

impl<R> Clone for Pages<R> {
    fn clone(&self) -> Self {
        Self { file: self.file.clone(), max_page_bytes: self.max_page_bytes }
    }
}

impl<R: ChunkReader> Length for Pages<R> {
    fn len(&self) -> u64 {
        self.file.len()
    }
}

impl<R: ChunkReader> ChunkReader for Pages<R> {
    type T = PageReader<R::T>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        Ok(PageReader {
            header: Cursor::default(),
            rest: self.file.get_read(start)?,
            is_checked: false,
            max_page_bytes: self.max_page_bytes,
            file_bytes: self.len(),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        self.file.get_bytes(start, length)
    }
}

/// Reads a page and its header. The header is not checked until the first bytes are read, because
/// some pages are requested but never read.
pub(crate) struct PageReader<R> {
    /// First bytes of the page, which contain its header.
    header: Cursor<Vec<u8>>,
    rest: R,
    is_checked: bool,
    max_page_bytes: u64,
    file_bytes: u64,
}

impl<R: Read> Read for PageReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !self.is_checked {
            self.rest.by_ref().take(MAX_HEADER_BYTES).read_to_end(self.header.get_mut())?;
            let declared = declared_bytes(self.header.get_ref())
                .ok_or_else(|| io::Error::other("a page header is damaged"))?;
            if declared > self.max_page_bytes {
                return Err(io::Error::other(format!(
                    "a page header specifies {} kB, but in a file of {} kB, a page may have at most {} kB; the \
                     file is damaged, or must be written with smaller pages",
                    declared.div_ceil(1000),
                    self.file_bytes.div_ceil(1000),
                    self.max_page_bytes / 1000
                )));
            }
            self.is_checked = true;
        }
        match self.header.read(buffer)? {
            0 => self.rest.read(buffer),
            read => Ok(read),
        }
    }
}

/// Returns the number of bytes that a page header specifies, or `None` if the header is invalid.
fn declared_bytes(header: &[u8]) -> Option<u64> {
    let mut header = header.iter().copied().peekable();
    // The fields are the page type, the uncompressed length, and the length in the file. After an
    // optional checksum, a dictionary page also specifies the number of its values, each of which
    // takes about eight bytes.
    let kind = integer(&mut header)?;
    let length = integer(&mut header)?.max(integer(&mut header)?);
    let length = u64::try_from(length).ok()?;
    if kind != DICTIONARY {
        return Some(length);
    }
    if header.peek() == Some(&INTEGER) {
        integer(&mut header)?;
    }
    if !matches!(header.next()?, 0x3c | 0x4c) {
        return None;
    }
    Some(length.max(8 * u64::try_from(integer(&mut header)?).ok()?))
}

/// Returns the value of the next field if it is a 32-bit integer.
fn integer(header: &mut impl Iterator<Item = u8>) -> Option<i32> {
    if header.next()? != INTEGER {
        return None;
    }
    let mut zigzag = 0_u64;
    for shift in (0..35).step_by(7) {
        let byte = header.next()?;
        zigzag |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            let half = (zigzag >> 1).cast_signed();
            return i32::try_from(if zigzag & 1 == 0 { half } else { !half }).ok();
        }
    }
    None
}
