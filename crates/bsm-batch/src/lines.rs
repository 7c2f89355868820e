//! Text by lines: what holds for every table of text, CSV or JSON Lines.

use std::io::{self, BufRead, BufReader, Read};

use crate::TableError;

/// Bytes that a line may have: what never ends must not take all memory.
const LONGEST: usize = 16 << 20;

/// Lines of a text, numbered as an editor does. They end with LF, CRLF or CR; blank ones may stand
/// at the end only.
pub(crate) struct Lines<R> {
    reader: BufReader<R>,
    line: Vec<u8>,
    number: u64,
    /// The last line ended with CR: an LF that follows belongs to it.
    after_cr: bool,
}

impl<R: Read> Lines<R> {
    pub(crate) fn new(reader: R) -> Self {
        let reader = BufReader::with_capacity(1 << 16, reader);
        Self { reader, line: Vec::new(), number: 0, after_cr: false }
    }

    /// Number of the last line, from 1.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The next line without its end; `None` at the end of the file or if only blank lines follow.
    pub(crate) fn next(&mut self) -> Result<Option<&str>, TableError> {
        self.next_but(|line| line.trim_ascii().is_empty())
    }

    /// [`next`](Self::next) where other lines are blank.
    pub(crate) fn next_but(
        &mut self,
        is_blank: impl Fn(&[u8]) -> bool,
    ) -> Result<Option<&str>, TableError> {
        let mut blank = None;
        while self.read()? {
            self.number += 1;
            let line = self.number;
            let malformed = |what: &str| TableError::Malformed(format!("line {line} {what}"));
            if self.line.len() > LONGEST {
                let most = LONGEST >> 20;
                let what = format!("is longer than {most} MiB; is an end of line missing?");
                return Err(malformed(&what));
            }
            // Some programs begin a file with a byte order mark.
            if line == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if is_blank(&self.line) {
                blank = blank.or(Some(line));
            } else if let Some(line) = blank {
                return Err(TableError::Malformed(format!(
                    "line {line} is blank; a row is one line, so write an empty cell as \"\" or remove the line"
                )));
            } else if memchr::memchr(0, &self.line).is_some() {
                return Err(malformed("has a NUL byte; save the table as UTF-8 text"));
            } else {
                let text = str::from_utf8(&self.line);
                let not_text = |_| malformed("is not UTF-8 text; save the table as UTF-8");
                return text.map(Some).map_err(not_text);
            }
        }
        Ok(None)
    }

    /// Reads a line, or so much of it that it is too long; false at the end of the text.
    fn read(&mut self) -> io::Result<bool> {
        self.line.clear();
        let mut any = false;
        loop {
            let mut bytes = match self.reader.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                bytes => bytes?,
            };
            if bytes.is_empty() {
                return Ok(any);
            }
            let skipped = usize::from(self.after_cr && bytes[0] == b'\n');
            self.after_cr = false;
            bytes = &bytes[skipped..];
            let end = memchr::memchr2(b'\n', b'\r', bytes);
            self.line.extend_from_slice(&bytes[..end.unwrap_or(bytes.len())]);
            any |= !bytes.is_empty();
            self.after_cr = end.is_some_and(|end| bytes[end] == b'\r');
            let used = skipped + end.map_or(bytes.len(), |end| end + 1);
            self.reader.consume(used);
            if end.is_some() || self.line.len() > LONGEST {
                return Ok(true);
            }
        }
    }
}
