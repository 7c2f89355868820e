//! Dense matrices of any size, based on the crate faer. No other file uses faer.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{ColMut, Mat, Par, Spec};

use crate::Singular;

/// A dense matrix whose size is known only at run time, and its LU factors with partial pivoting.
pub struct DynamicDense {
    factors: Mat<f64>,
    perm: Vec<usize>,
    perm_inv: Vec<usize>,
    scratch: MemBuffer,
}

impl DynamicDense {
    /// Creates a zero matrix of size `n`×`n`.
    pub fn new(n: usize) -> Self {
        let factorize = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Spec::default());
        let substitute = solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq);
        Self {
            factors: Mat::zeros(n, n),
            perm: (0..n).collect(),
            perm_inv: (0..n).collect(),
            scratch: MemBuffer::new(StackReq::any_of(&[factorize, substitute])),
        }
    }

    /// Sets an entry. All entries must be set before [`factorize`](Self::factorize) is called.
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.factors[(row, column)] = value;
    }

    /// Factorizes the matrix.
    ///
    /// # Errors
    ///
    /// Returns [`Singular`] if a pivot is zero or not finite.
    pub fn factorize(&mut self) -> Result<(), Singular> {
        factor::lu_in_place(
            self.factors.as_mut(),
            &mut self.perm,
            &mut self.perm_inv,
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Spec::default(),
        );
        let broken = |pivot: f64| pivot == 0.0 || !pivot.is_finite();
        let singular = (0..self.factors.nrows()).any(|i| broken(self.factors[(i, i)]));
        if singular { Err(Singular) } else { Ok(()) }
    }

    /// Solves a linear system in place: overwrites the right-hand side with the solution.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let perm = PermRef::new_checked(&self.perm, &self.perm_inv, self.perm.len());
        solve::solve_in_place(
            self.factors.as_ref(),
            self.factors.as_ref(),
            perm,
            ColMut::from_slice_mut(rhs).as_mat_mut(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}
