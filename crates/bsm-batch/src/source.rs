//! Sources, which provide the table rows that a task solves.

use std::ops::Range;

use bsm_case::{Grid, InputKey};

use crate::{Chunk, Columns, TableError};

/// A source of table rows. It returns the rows in chunks, in their original order.
pub trait Source: Send {
    /// Returns the columns of the table.
    fn columns(&self) -> &Columns;

    /// Returns the number of rows if it is known in advance.
    fn len_hint(&self) -> Option<u64> {
        None
    }

    /// Returns the next chunk, which has at most `rows` rows, or `None` after the last row.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the next rows cannot be read.
    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError>;

    /// Skips the given number of rows. If fewer rows remain, all remaining rows are skipped.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`next`](Self::next).
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

/// A set of points that are calculated when they are needed, such as a grid or random points.
pub trait PointSet: Send {
    /// Returns the inputs that the points specify.
    fn inputs(&self) -> Vec<InputKey>;

    /// Returns the number of points.
    fn count(&self) -> u64;

    /// Appends the values of the input with the given index to `to`, for the given rows.
    fn append_values(&self, index: usize, rows: Range<u64>, to: &mut Vec<f64>);
}

impl PointSet for Grid {
    fn inputs(&self) -> Vec<InputKey> {
        self.axes().iter().map(|axis| axis.key).collect()
    }

    fn count(&self) -> u64 {
        self.len() as u64
    }

    fn append_values(&self, index: usize, rows: Range<u64>, to: &mut Vec<f64>) {
        let [start, end] =
            [rows.start, rows.end].map(|row| usize::try_from(row).unwrap_or(usize::MAX));
        Self::append_values(self, index, start..end, to);
    }
}

/// A source whose rows are calculated points, such as a grid or random points.
#[derive(Debug, Clone)]
pub struct PointSource<P> {
    points: P,
    columns: Columns,
    at: u64,
}

/// A source whose rows are the points of a grid. The last axis of the grid varies fastest.
pub type GridSource = PointSource<Grid>;

impl<P: PointSet> PointSource<P> {
    /// Returns a source that starts at the first point.
    pub fn new(points: P) -> Self {
        let columns = Columns::of_inputs(points.inputs());
        Self { points, columns, at: 0 }
    }
}

impl<P: PointSet> Source for PointSource<P> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn len_hint(&self) -> Option<u64> {
        Some(self.points.count())
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let (first, before) = (self.at + 1, self.at);
        self.skip(rows as u64)?;
        let rows = before..self.at;
        let len = usize::try_from(rows.end - rows.start).unwrap_or(usize::MAX);
        Ok(Chunk::of_numbers(first, len, &self.columns, |index, values| {
            self.points.append_values(index, rows.clone(), values);
        }))
    }

    fn skip(&mut self, rows: u64) -> Result<(), TableError> {
        self.at = self.points.count().min(self.at.saturating_add(rows));
        Ok(())
    }
}
