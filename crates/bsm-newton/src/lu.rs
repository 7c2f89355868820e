//! Dense LU with partial pivoting in preallocated memory; the only file that names faer's
//! factorization.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::{ColMut, Mat, MatMut, Par, Spec};

/// Matrix, permutation and scratch memory for systems of one size.
pub(crate) struct DenseLu {
    factors: Mat<f64>,
    perm: Vec<usize>,
    perm_inv: Vec<usize>,
    scratch: MemBuffer,
}

impl DenseLu {
    /// Memory for `n` unknowns.
    pub(crate) fn new(n: usize) -> Self {
        let factorize = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Spec::default());
        let substitute = solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq);
        Self {
            factors: Mat::zeros(n, n),
            perm: vec![0; n],
            perm_inv: vec![0; n],
            scratch: MemBuffer::new(StackReq::any_of(&[factorize, substitute])),
        }
    }

    /// The matrix to fill before [`solve`](Self::solve).
    pub(crate) fn matrix(&mut self) -> MatMut<'_, f64> {
        self.factors.as_mut()
    }

    /// Multiplies row `i` of the matrix by `scale[i]`.
    pub(crate) fn scale_rows(&mut self, scale: &[f64]) {
        for column in self.factors.col_iter_mut() {
            for (entry, d) in column.iter_mut().zip(scale) {
                *entry *= d;
            }
        }
    }

    /// Sign of the determinant of the matrix that was factorized last.
    pub(crate) fn determinant_sign(&self) -> f64 {
        let mut sign = 1.0;
        for i in 0..self.factors.nrows() {
            sign *= self.factors[(i, i)].signum();
            // Each pair in the wrong order turns the sign.
            let passed = self.perm[..i].iter().filter(|before| **before > self.perm[i]).count();
            if passed % 2 == 1 {
                sign = -sign;
            }
        }
        sign
    }

    /// Factorizes in place and overwrites `rhs`, one or more columns one after the other, with the
    /// solutions.
    ///
    /// Returns false if a pivot is zero or if a solution is not finite. Small pivots are no
    /// reason to give up: in these systems an unknown may legitimately act at the size of the
    /// inertia forces only, and the residual decides about success.
    pub(crate) fn solve(&mut self, rhs: &mut [f64]) -> bool {
        let stack = MemStack::new(&mut self.scratch);
        let (_, perm) = factor::lu_in_place(
            self.factors.as_mut(),
            &mut self.perm,
            &mut self.perm_inv,
            Par::Seq,
            stack,
            Spec::default(),
        );
        let n = self.factors.nrows();
        if (0..n).any(|i| self.factors[(i, i)] == 0.0) {
            return false;
        }
        for column in rhs.chunks_exact_mut(n) {
            solve::solve_in_place(
                self.factors.as_ref(),
                self.factors.as_ref(),
                perm,
                ColMut::from_slice_mut(column).as_mat_mut(),
                Par::Seq,
                stack,
            );
        }
        rhs.iter().all(|v| v.is_finite())
    }
}
