//! Dense matrices of a few unknowns, with a constant size.

use crate::Singular;

/// A dense `N`×`N` matrix and its LU factors with partial pivoting.
///
/// For the handful of unknowns of one body: no call, no memory but its own, and the same bits on
/// every instruction set. Larger ones are better served by [`DynamicDense`](super::DynamicDense).
#[derive(Debug, Clone)]
pub struct Dense<const N: usize> {
    rows: [[f64; N]; N],
    /// Reciprocals of the pivots.
    inverse: [f64; N],
    /// Row that was exchanged with row `k` in step `k`.
    exchanged: [usize; N],
}

impl<const N: usize> Default for Dense<N> {
    fn default() -> Self {
        Self { rows: [[0.0; N]; N], inverse: [0.0; N], exchanged: [0; N] }
    }
}

impl<const N: usize> Dense<N> {
    /// The rows, to fill before [`factorize`](Self::factorize).
    pub fn rows_mut(&mut self) -> &mut [[f64; N]; N] {
        &mut self.rows
    }

    /// Sign of the determinant of the matrix that was factorized.
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
    /// [`Singular`] if a pivot or its reciprocal is not finite.
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

    /// Overwrites a right-hand side with its solution, which means nothing before [`factorize`](Self::factorize) has
    /// succeeded.
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
