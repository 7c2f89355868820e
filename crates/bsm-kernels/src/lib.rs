//! Models by lanes: several points at a time, on the widest instruction set of the machine.
//!
//! A kernel answers the ordinary points of its model, and leaves the others to the model itself,
//! which also writes the messages. Formulas are those of the model, over lanes; the tests compare the two.

mod auto;
mod closed_form;
mod contacts;
mod elastic;
mod operand;
mod quasi_static;
mod raceway;
mod rigid;
mod traction;
mod units;

use bsm_case::{ModelChoice, OUTPUTS, Output, OutputKey, Settings};
use bsm_dyn::{Choice, Model};
use bsm_simd::{Arch, Simd, WithSimd};

use self::closed_form::ClosedForm;
use self::elastic::Elastic;
use self::quasi_static::QuasiStatic;
use self::raceway::Raceway;
use self::rigid::Rigid;
use crate::operand::{Lane, LaneInputs, Mask, Valid};

pub use operand::{InputColumn, InputColumns, is_plain};

/// A model by lanes.
trait Kernel {
    /// The model.
    const MODEL: Model;

    /// Solves a lane of points, and says for which of them the numbers are the answer.
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S>;
}

/// The outputs that are wanted, and their places.
#[derive(Debug, Clone)]
pub struct Selection([Option<usize>; OUTPUTS.len()]);

impl Selection {
    /// Outputs in the order of their columns.
    pub fn of(outputs: &[&Output]) -> Self {
        let mut indices = [None; OUTPUTS.len()];
        for (index, output) in outputs.iter().enumerate() {
            if let Some(key) = output.key() {
                indices[key as usize] = Some(index);
            }
        }
        Self(indices)
    }

    /// With more outputs, those that are new behind `len` columns.
    fn with(&self, keys: &[OutputKey], len: usize) -> Self {
        let mut this = self.clone();
        let new = keys.iter().filter(|key| self.index(**key).is_none());
        for (index, key) in (len..).zip(new) {
            this.0[*key as usize] = Some(index);
        }
        this
    }

    /// The place of an output.
    fn index(&self, key: OutputKey) -> Option<usize> {
        self.0[key as usize]
    }
}

/// Where the outputs of a lane of points go.
struct Sink<'a, 'b> {
    wanted: &'a Selection,
    columns: &'a mut [&'b mut [f64]],
    /// The first of the points.
    row: usize,
}

impl Sink<'_, '_> {
    /// True if any of these outputs is wanted: what takes time is computed only then.
    #[inline(always)]
    fn wants(&self, keys: &[OutputKey]) -> bool {
        keys.iter().any(|key| self.wanted.index(*key).is_some())
    }

    /// Stores the values of an output, in the unit of the vocabulary.
    #[inline(always)]
    fn set<S: Simd>(&mut self, key: OutputKey, values: Lane<S>) {
        if let Some(index) = self.wanted.index(key) {
            values.store(&mut self.columns[index][self.row..]);
        }
    }

    /// Stores the values of an output and of those that follow it in the vocabulary.
    #[inline(always)]
    fn set_all<S: Simd, const N: usize>(&mut self, first: OutputKey, values: [Lane<S>; N]) {
        for (index, values) in self.wanted.0[first as usize..].iter().zip(values) {
            if let Some(index) = *index {
                values.store(&mut self.columns[index][self.row..]);
            }
        }
    }

    /// No other solution than this one.
    #[inline(always)]
    fn set_unique<S: Simd>(&mut self, like: Lane<S>) {
        self.set(OutputKey::other_solutions, like.constant(0.0));
    }

    /// Stores yes and no.
    #[inline(always)]
    fn set_flag<S: Simd>(&mut self, key: OutputKey, values: Mask<S>) {
        self.set(key, values.to_numbers());
    }
}

/// Some rows of a chunk and the places of their answers.
#[derive(Debug)]
pub struct Rows<'a, 'b> {
    /// The inputs of the chunk.
    pub inputs: &'a InputColumns<'a>,
    /// The outputs that are wanted.
    pub wanted: &'a Selection,
    /// The first of the rows in the chunk.
    pub first: usize,
    /// Columns of the outputs, of these rows only.
    pub columns: &'a mut [&'b mut [f64]],
    /// Which of the rows are answered.
    pub done: &'a mut [bool],
}

/// Why a model answers a row of the choice by error bounds.
#[derive(Debug, Clone, Copy)]
pub struct RowChoice {
    /// Its place among the rows.
    pub row: usize,
    /// The reason.
    pub choice: Choice,
    /// Bound of the error of the efficiency.
    pub bound: f64,
}

impl Rows<'_, '_> {
    /// Answers the ordinary rows of a model, and says which one was chosen where it is to be chosen.
    pub fn solve(self, arch: Arch, model: ModelChoice, settings: &Settings) -> Vec<RowChoice> {
        match model {
            ModelChoice::Auto => return auto::solve(arch, self, settings.tolerance),
            ModelChoice::Fixed(Model::ClosedForm) => {
                arch.dispatch(Run { kernel: ClosedForm, rows: self });
            }
            ModelChoice::Fixed(Model::QuasiStatic) => {
                arch.dispatch(Run { kernel: QuasiStatic, rows: self });
            }
            ModelChoice::Fixed(Model::Rigid) => arch.dispatch(Run { kernel: Rigid, rows: self }),
            ModelChoice::Fixed(Model::RacewayControl) => {
                let kernel = Raceway { control: settings.control };
                arch.dispatch(Run { kernel, rows: self });
            }
            ModelChoice::Fixed(Model::Elastic) => {
                arch.dispatch(Run { kernel: Elastic, rows: self });
            }
            ModelChoice::Fixed(Model::Traction) => {
                traction::solve(arch, self, settings.accuracy, settings.creep);
            }
        }
        Vec::new()
    }
}

/// A kernel over rows.
struct Run<'a, 'b, K> {
    kernel: K,
    rows: Rows<'a, 'b>,
}

impl<K: Kernel> WithSimd for Run<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Rows { inputs, wanted, first, columns, done } = self.rows;
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, inputs, row: first + row };
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let solved = self.kernel.solve(&given, &mut out);
            let valid = simd.vectorize(Valid { given: &given, model: K::MODEL });
            (solved & valid).store(&mut done[row..]);
        }
    }
}
