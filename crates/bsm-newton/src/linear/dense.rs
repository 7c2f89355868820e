//! Dense matrices for a few unknowns, whose size is known at compile time.

use crate::Singular;

/// A dense `N`×`N` matrix and its LU factors with partial pivoting.
///
/// The type is intended for the few unknowns of a single body. It does not call other libraries and
/// does not allocate memory, and its results are bit-identical on every instruction set. For larger
/// matrices, use [`DynamicDense`](super::DynamicDense).
#[derive(Debug, Clone)]
pub struct Dense<const N: usize> {
    rows: [[f64; N]; N],
    /// Reciprocals of the pivots after the factorization.
    inverse: [f64; N],
    /// Row that was exchanged with row `k` in elimination step `k`.
    exchanged: [usize; N],
}

impl<const N: usize> Default for Dense<N> {
    fn default() -> Self {
        Self { rows: [[0.0; N]; N], inverse: [0.0; N], exchanged: [0; N] }
    }
}

impl<const N: usize> Dense<N> {
    /// Returns the rows for writing. They must be filled before [`factorize`](Self::factorize) is
    /// called.
    pub fn rows_mut(&mut self) -> &mut [[f64; N]; N] {
        &mut self.rows
    }

    /// Returns the sign of the determinant of the factorized matrix.
    pub(crate) fn determinant_sign(&self) -> f64 {
        (0..N).fold(1.0, |sign, k| {
            let exchange = if self.exchanged[k] == k { 1.0 } else { -1.0 };
            sign * exchange * self.rows[k][k].signum()
        })
    }

    /// Multiplies row `i` by `scale[i]`.
    pub fn scale_rows(&mut self, scale: &[f64; N]) {
        for (row, d) in self.rows.iter_mut().zip(scale) {
            for entry in row {
                *entry *= d;
            }
        }
    }

    /// Factorizes the matrix.
    ///
    /// # Errors
    ///
    /// Returns [`Singular`] if a pivot or its reciprocal is not finite.
    pub fn factorize(&mut self) -> Result<(), Singular> {
        for k in 0..N {
            let (mut pivot, mut largest) = (k, self.rows[k][k].abs());
            for i in k + 1..N {
                let size = self.rows[i][k].abs();
                if size > largest {
                    (pivot, largest) = (i, size);
                }
            }
            self.exchanged[k] = pivot;
            if pivot != k {
                self.rows.swap(k, pivot);
            }
            let (above, below) = self.rows.split_at_mut(k + 1);
            let upper = &above[k];
            let inverse = upper[k].recip();
            if !(upper[k].is_finite() && inverse.is_finite()) {
                return Err(Singular);
            }
            self.inverse[k] = inverse;
            for row in below {
                let factor = row[k] * inverse;
                row[k] = factor;
                for j in k + 1..N {
                    row[j] -= factor * upper[j];
                }
            }
        }
        Ok(())
    }

    /// Solves a linear system in place: overwrites the right-hand side with the solution. The
    /// result is meaningless unless [`factorize`](Self::factorize) has succeeded.
    pub fn solve(&self, rhs: &mut [f64; N]) {
        for (k, other) in self.exchanged.iter().enumerate() {
            rhs.swap(k, *other);
        }
        for k in 0..N {
            for i in k + 1..N {
                rhs[i] -= self.rows[i][k] * rhs[k];
            }
        }
        for k in (0..N).rev() {
            rhs[k] *= self.inverse[k];
            for i in 0..k {
                rhs[i] -= self.rows[i][k] * rhs[k];
            }
        }
    }
}
