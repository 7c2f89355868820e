//! The trait that all kernels implement, and the table rows that a kernel solves.

use bsm_case::{OUTPUTS, Output, SolutionOutput, store_outputs};
use bsm_dyn::{Model, SteadyState, model::Choice};
use bsm_simd::{Simd, WithSimd};

use crate::inputs::{InputColumns, Lane, LaneInputs, Mask, ValidCall};

/// A model that can be solved directly for a block of points. A block consists of the points in one
/// [`Lane`].
pub(crate) trait Kernel {
    /// Model that the kernel solves.
    const MODEL: Model;

    /// Solves a block of points, stores the requested outputs, and returns a mask that is true for
    /// the solved points.
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S>;
}

/// Requested outputs, with the index of the column for each output.
#[derive(Debug, Clone)]
pub struct Selection([Option<usize>; OUTPUTS.len()]);

impl Selection {
    /// Creates a selection from outputs that are given in the order of their columns.
    pub fn of(outputs: &[&Output]) -> Self {
        let mut indices = [None; OUTPUTS.len()];
        for (index, output) in outputs.iter().enumerate() {
            if let Some(key) = output.key() {
                indices[key as usize] = Some(index);
            }
        }
        Self(indices)
    }

    /// Returns a selection that also contains the outputs `keys`. Outputs that were not yet
    /// selected get columns after the first `len` columns.
    pub(crate) fn with(&self, keys: &[SolutionOutput], len: usize) -> Self {
        let mut this = self.clone();
        let missing = keys.iter().filter(|key| self.index(**key).is_none());
        for (index, key) in (len..).zip(missing) {
            this.0[*key as usize] = Some(index);
        }
        this
    }

    /// Returns the column index of an output, or `None` if the output is not selected.
    pub(crate) fn index(&self, key: SolutionOutput) -> Option<usize> {
        self.0[key as usize]
    }
}

/// Values of one output for several rows. Missing values are NaN.
#[derive(Debug)]
pub enum OutputColumn<'a> {
    /// Buffer that the caller provides. It must contain only NaN at the beginning.
    Given(&'a mut [f64]),
    /// Buffer that is allocated when the first value is stored. No buffer is allocated for outputs
    /// that the model does not calculate, which are the majority.
    OnDemand {
        /// Number of rows in the column.
        rows: usize,
        /// Values of all rows. The vector is empty until the first value is stored.
        values: Vec<f64>,
    },
}

impl OutputColumn<'_> {
    /// Creates a column without allocating its buffer.
    pub fn on_demand(rows: usize) -> Self {
        Self::OnDemand { rows, values: Vec::new() }
    }

    /// Returns the value of the output in a row.
    pub fn value(&self, row: usize) -> f64 {
        match self {
            Self::Given(values) => values[row],
            Self::OnDemand { values, .. } => values.get(row).copied().unwrap_or(f64::NAN),
        }
    }

    /// Stores the value of the output in a row.
    pub fn set(&mut self, row: usize, value: f64) {
        if !value.is_nan() || self.is_allocated() {
            self.values_mut()[row] = value;
        }
    }

    fn is_allocated(&self) -> bool {
        match self {
            Self::Given(_) => true,
            Self::OnDemand { values, .. } => !values.is_empty(),
        }
    }

    /// Returns the values of all rows, after allocating the buffer if necessary.
    #[inline(always)]
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Given(values) => values,
            Self::OnDemand { rows, values } => {
                if values.is_empty() {
                    values.resize(*rows, f64::NAN);
                }
                values
            }
        }
    }
}

/// Output columns, together with the row at which the results of a block of points are stored.
pub(crate) struct Sink<'a, 'b> {
    /// Requested outputs, with the index of the column for each output.
    pub(crate) wanted: &'a Selection,
    /// Columns in which the outputs are stored.
    pub(crate) columns: &'a mut [OutputColumn<'b>],
    /// Row index of the first point in the block.
    pub(crate) row: usize,
}

impl Sink<'_, '_> {
    /// Returns true if any of the given outputs is requested. Kernels use this function to skip
    /// expensive calculations.
    #[inline(always)]
    pub(crate) fn wants(&self, keys: &[SolutionOutput]) -> bool {
        keys.iter().any(|key| self.wanted.index(*key).is_some())
    }

    /// Stores the values of an output at all points of the block, in the unit of the output.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, key: SolutionOutput, values: Lane<S>) {
        if let Some(index) = self.wanted.index(key) {
            values.store(&mut self.columns[index].values_mut()[self.row..]);
        }
    }

    /// Stores all requested outputs of a solution.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, solved: &SteadyState<Lane<S>>) {
        let Self { wanted, columns, row } = self;
        store_outputs(
            solved,
            #[inline(always)]
            |key| wanted.index(key),
            #[inline(always)]
            |index, values: Lane<S>| values.store(&mut columns[index].values_mut()[*row..]),
        );
    }
}

/// Consecutive rows of a chunk, together with the buffers for their results.
#[derive(Debug)]
pub struct Rows<'a, 'b> {
    /// Inputs of all rows in the chunk.
    pub inputs: &'a InputColumns<'a>,
    /// Requested outputs, with the index of the column for each output.
    pub wanted: &'a Selection,
    /// Index of the first row within the chunk.
    pub first: usize,
    /// Output columns with one element per row to be solved.
    pub columns: &'a mut [OutputColumn<'b>],
    /// One flag per row, which is true if the row has been solved.
    pub done: &'a mut [bool],
}

/// Model that `auto` selected for a row according to its error bounds, with the reason for the
/// selection.
#[derive(Debug, Clone, Copy)]
pub struct RowChoice {
    /// Index of the row in [`Rows`].
    pub row: usize,
    /// Reason why this model was selected.
    pub choice: Choice,
    /// Upper bound of the efficiency error.
    pub bound: f64,
}

/// A kernel together with the rows to which it is applied.
pub(crate) struct RowKernel<'a, 'b, K> {
    pub(crate) kernel: K,
    pub(crate) rows: Rows<'a, 'b>,
}

impl<K: Kernel> WithSimd for RowKernel<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Rows { inputs, wanted, first, columns, done } = self.rows;
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, columns: inputs, row: first + row };
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let solved = self.kernel.solve(&given, &mut out);
            let valid = simd.vectorize(ValidCall { given: &given, model: K::MODEL });
            (solved & valid).store(&mut done[row..]);
        }
    }
}
