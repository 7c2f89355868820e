//! Where rows come from.

use bsm_case::Grid;

use crate::{Chunk, Columns, TableError};

/// Rows in chunks, in order.
pub trait Source: Send {
    /// The columns.
    fn columns(&self) -> &Columns;

    /// Number of rows, if it is known before they are read.
    fn len_hint(&self) -> Option<u64> {
        None
    }

    /// The next rows, at most `rows`; `None` at the end.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the table cannot be read on.
    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError>;

    /// Passes over rows, fewer if the table ends before.
    ///
    /// # Errors
    ///
    /// As [`next`](Self::next).
    fn skip(&mut self, rows: u64) -> Result<(), TableError> {
        const AT_ONCE: u64 = 65_536;
        let mut left = rows;
        while left > 0 {
            let count = usize::try_from(left.min(AT_ONCE)).unwrap_or(1);
            match self.next(count)? {
                Some(chunk) => left -= chunk.len as u64,
                None => break,
            }
        }
        Ok(())
    }
}

/// The points of a grid, made when they are asked for.
#[derive(Debug, Clone)]
pub struct GridSource {
    grid: Grid,
    columns: Columns,
    at: usize,
}

impl GridSource {
    /// All points of `grid`, its last axis fastest.
    pub fn new(grid: Grid) -> Self {
        let columns = Columns::of_inputs(grid.axes().iter().map(|axis| axis.key).collect());
        Self { grid, columns, at: 0 }
    }
}

impl Source for GridSource {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn len_hint(&self) -> Option<u64> {
        Some(self.grid.len() as u64)
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let end = self.grid.len().min(self.at.saturating_add(rows));
        let (rows, first) = (self.at..end, self.at as u64 + 1);
        self.at = end;
        Ok(Chunk::of_numbers(first, rows.len(), &self.columns, |axis, values| {
            self.grid.fill(axis, rows.clone(), values);
        }))
    }

    fn skip(&mut self, rows: u64) -> Result<(), TableError> {
        let rows = usize::try_from(rows).unwrap_or(usize::MAX);
        self.at = self.grid.len().min(self.at.saturating_add(rows));
        Ok(())
    }
}
