//! The trait of the kernels, and the rows of a table that a kernel solves.

use bsm_case::{OUTPUTS, Output, OutputKey, store_outputs};
use bsm_dyn::{Model, SteadyState, model::Choice};
use bsm_simd::{Simd, WithSimd};

use crate::operand::{InputColumns, Lane, LaneInputs, Mask, ValidCall};

/// The direct solve of a model for lanes.
pub(crate) trait Kernel {
    /// The model.
    const MODEL: Model;

    /// Solves a lane of points, stores the requested outputs, and returns the mask of the points that are solved.
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S>;
}

/// The requested outputs, and their columns.
#[derive(Debug, Clone)]
pub struct Selection([Option<usize>; OUTPUTS.len()]);

impl Selection {
    /// Returns the selection of outputs in the order of their columns.
    pub fn of(outputs: &[&Output]) -> Self {
        let mut indices = [None; OUTPUTS.len()];
        for (index, output) in outputs.iter().enumerate() {
            if let Some(key) = output.key() {
                indices[key as usize] = Some(index);
            }
        }
        Self(indices)
    }

    /// Returns the selection extended by outputs that it lacks. Their columns follow the first
    /// `len` columns.
    pub(crate) fn with(&self, keys: &[OutputKey], len: usize) -> Self {
        let mut this = self.clone();
        let missing = keys.iter().filter(|key| self.index(**key).is_none());
        for (index, key) in (len..).zip(missing) {
            this.0[*key as usize] = Some(index);
        }
        this
    }

    /// Returns the column of an output.
    pub(crate) fn index(&self, key: OutputKey) -> Option<usize> {
        self.0[key as usize]
    }
}

/// Column of an output for some rows. Missing values are NaN.
#[derive(Debug)]
pub enum OutputColumn<'a> {
    /// Memory of the caller, which must contain only NaN.
    Given(&'a mut [f64]),
    /// Memory that is allocated when the first value is stored. Most outputs belong to other models
    /// and never need memory.
    OnDemand {
        /// Number of rows.
        rows: usize,
        /// Values of all rows; empty before the first value is stored.
        values: Vec<f64>,
    },
}

impl OutputColumn<'_> {
    /// Returns a column without memory.
    pub fn on_demand(rows: usize) -> Self {
        Self::OnDemand { rows, values: Vec::new() }
    }

    /// Returns the value of a row.
    pub fn value(&self, row: usize) -> f64 {
        match self {
            Self::Given(values) => values[row],
            Self::OnDemand { values, .. } => values.get(row).copied().unwrap_or(f64::NAN),
        }
    }

    /// Stores the value of a row.
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

    /// Returns the memory of all rows.
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

/// Columns for the outputs of a lane of points.
pub(crate) struct Sink<'a, 'b> {
    /// The requested outputs.
    pub(crate) wanted: &'a Selection,
    /// Columns of the outputs.
    pub(crate) columns: &'a mut [OutputColumn<'b>],
    /// Index of the first point.
    pub(crate) row: usize,
}

impl Sink<'_, '_> {
    /// Returns true if any of these outputs is requested. Expensive quantities are calculated only
    /// in this case.
    #[inline(always)]
    pub(crate) fn wants(&self, keys: &[OutputKey]) -> bool {
        keys.iter().any(|key| self.wanted.index(*key).is_some())
    }

    /// Stores the values of an output, in the unit of the output.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, key: OutputKey, values: Lane<S>) {
        if let Some(index) = self.wanted.index(key) {
            values.store(&mut self.columns[index].values_mut()[self.row..]);
        }
    }

    /// Stores the values of an output and of the outputs that follow it in [`OUTPUTS`].
    #[inline(always)]
    pub(crate) fn set_all<S: Simd, const N: usize>(
        &mut self,
        first: OutputKey,
        values: [Lane<S>; N],
    ) {
        for (index, values) in self.wanted.0[first as usize..].iter().zip(values) {
            if let Some(index) = *index {
                values.store(&mut self.columns[index].values_mut()[self.row..]);
            }
        }
    }

    /// Stores the requested outputs of a result.
    #[inline(always)]
    pub(crate) fn put<S: Simd>(&mut self, solved: &SteadyState<Lane<S>>) {
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

/// Some rows of a chunk, and the memory for their results.
#[derive(Debug)]
pub struct Rows<'a, 'b> {
    /// The inputs of the chunk.
    pub inputs: &'a InputColumns<'a>,
    /// The requested outputs.
    pub wanted: &'a Selection,
    /// Index of the first row in the chunk.
    pub first: usize,
    /// Columns of the outputs, for these rows only.
    pub columns: &'a mut [OutputColumn<'b>],
    /// Flags of the rows that are solved.
    pub done: &'a mut [bool],
}

/// The model of a row that `auto` chose by its error bounds, with the reason for the choice.
#[derive(Debug, Clone, Copy)]
pub struct RowChoice {
    /// Index among the rows.
    pub row: usize,
    /// The reason.
    pub choice: Choice,
    /// Error bound of the efficiency.
    pub bound: f64,
}

/// A kernel applied to rows.
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
            let given = LaneInputs { simd, inputs, row: first + row };
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let solved = self.kernel.solve(&given, &mut out);
            let valid = simd.vectorize(ValidCall { given: &given, model: K::MODEL });
            (solved & valid).store(&mut done[row..]);
        }
    }
}
