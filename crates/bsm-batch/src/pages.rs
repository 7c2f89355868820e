//! Pages of Parquet files. The sizes that a page declares are checked before they are used.

use std::io::{self, Cursor, Read};
use std::sync::Arc;

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};

/// Number of bytes of a page header up to the last number that is needed: six fields of at most six
/// bytes, and the beginning of a structure.
const HEAD: u64 = 40;

/// Code of a dictionary page.
const DICTIONARY: i32 = 2;

/// Tag of a Thrift compact field that directly follows the previous field and contains a 32-bit
/// integer.
const NUMBER: u8 = 0x15;

/// A Parquet file that several readers read one after the other. The library allocates the memory
/// that a page header declares before it reads the page. Therefore no page may declare more than
/// its file could reasonably contain.
pub(crate) struct Pages<R> {
    file: Arc<R>,
    /// Number of bytes that a page may declare.
    most: u64,
}

impl<R: ChunkReader> Pages<R> {
    /// Returns the pages of a file, of which a given number of columns are read at the same time.
    pub(crate) fn new(file: R, columns: usize) -> Self {
        // With one page and one dictionary per column, 64 MiB and 256 times the size of the file.
        let most = (32 << 20) + file.len().saturating_mul(128);
        Self { file: Arc::new(file), most: most / (columns as u64).max(1) }
    }
}

impl<R> Clone for Pages<R> {
    fn clone(&self) -> Self {
        Self { file: self.file.clone(), most: self.most }
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
        let Self { most, .. } = *self;
        let head = Cursor::default();
        Ok(PageReader {
            head,
            rest: self.file.get_read(start)?,
            unread: true,
            most,
            file: self.len(),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        self.file.get_bytes(start, length)
    }
}

/// A page from its header on. It is checked when it is read, because not every requested page is
/// read.
pub(crate) struct PageReader<R> {
    head: Cursor<Vec<u8>>,
    rest: R,
    unread: bool,
    most: u64,
    file: u64,
}

impl<R: Read> Read for PageReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.unread {
            self.rest.by_ref().take(HEAD).read_to_end(self.head.get_mut())?;
            let announced = announced(self.head.get_ref())
                .ok_or_else(|| io::Error::other("it is damaged at the header of a page"))?;
            if announced > self.most {
                return Err(io::Error::other(format!(
                    "a page announces {} kB, but a file of {} kB is read with at most {} kB a page; it \
                     is damaged, or write it with smaller pages",
                    announced.div_ceil(1000),
                    self.file.div_ceil(1000),
                    self.most / 1000
                )));
            }
            self.unread = false;
        }
        match self.head.read(buffer)? {
            0 => self.rest.read(buffer),
            read => Ok(read),
        }
    }
}

/// Returns the number of bytes that the header of a page declares, or `None` if the bytes are not a
/// header.
fn announced(head: &[u8]) -> Option<u64> {
    let mut head = head.iter().copied().peekable();
    // The fields are the kind, the length and the length in the file. A dictionary also has a
    // number of values, with about eight bytes each, after an optional checksum.
    let kind = number(&mut head)?;
    let length = number(&mut head)?.max(number(&mut head)?);
    let length = u64::try_from(length).ok()?;
    if kind != DICTIONARY {
        return Some(length);
    }
    if head.peek() == Some(&NUMBER) {
        number(&mut head)?;
    }
    if !matches!(head.next()?, 0x3c | 0x4c) {
        return None;
    }
    Some(length.max(8 * u64::try_from(number(&mut head)?).ok()?))
}

/// Returns the next field, if it is a 32-bit integer.
fn number(head: &mut impl Iterator<Item = u8>) -> Option<i32> {
    if head.next()? != NUMBER {
        return None;
    }
    let mut zigzag = 0_u64;
    for shift in (0..35).step_by(7) {
        let byte = head.next()?;
        zigzag |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            let half = (zigzag >> 1).cast_signed();
            return i32::try_from(if zigzag & 1 == 0 { half } else { !half }).ok();
        }
    }
    None
}
