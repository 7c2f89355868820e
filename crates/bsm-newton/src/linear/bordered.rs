//! Block tridiagonal matrices with small blocks, and with a border for a few unknowns that are
//! coupled to all blocks.

use std::array::from_fn;

use super::{Dense, DynamicDense};
use crate::Singular;

/// A matrix with `count` blocks of `K` unknowns each. Neighboring blocks are coupled, and the
/// border contains a few unknowns that are coupled to every block (N9).
///
/// ```math
/// \begin{pmatrix} T & R \\ B & C \end{pmatrix}, \qquad
/// T = \operatorname{tridiag}(L_i, D_i, U_i)
/// ```
///
/// Unknowns and equations are ordered by blocks, followed by the border. If neighboring blocks are
/// not coupled, `$L_i = U_i = 0$`. To represent a ring of blocks, cut it open into a chain and make
/// the unknowns of one block part of the border.
/// The factorization eliminates the chain of blocks from one end to the other, and then solves for
/// the border with its Schur complement. The cost is proportional to the number of blocks instead
/// of its cube. Rows are exchanged only within a block and within the border. Restricting the
/// exchanges in this way is safe for positive definite matrices and for block diagonally dominant
/// matrices. In other matrices, a block may be [`Singular`] even if the whole matrix is regular.
pub struct BorderedMatrix<const K: usize> {
    diagonal: Vec<Dense<K>>,
    /// Columns of the couplings to the next block. After the factorization, they contain the
    /// columns of `$D_i^{-1} U_i$`.
    above: Vec<[[f64; K]; K]>,
    /// Rows of the couplings to the previous block.
    below: Vec<[[f64; K]; K]>,
    /// Columns of the border, block by block. After the factorization, they contain the columns of
    /// `$T^{-1} R$`.
    right: Vec<[f64; K]>,
    /// Rows of the border, block by block, with the coefficients of the block unknowns.
    bottom: Vec<[f64; K]>,
    /// Coefficients of the border unknowns in the equations of the border, row by row. After the
    /// factorization, they contain the Schur complement.
    corner: Vec<f64>,
    border: usize,
    schur: DynamicDense,
}

/// Entries of a [`BorderedMatrix`] that belong to one block.
pub struct BorderedBlock<'a, const K: usize> {
    /// Diagonal block, row by row.
    pub rows: &'a mut [[f64; K]; K],
    /// Coefficients of the border unknowns in the equations of the block, column by column.
    pub right: &'a mut [[f64; K]],
    /// Coefficients of the block unknowns in the equations of the border, row by row.
    pub bottom: &'a mut [[f64; K]],
}

impl<const K: usize> BorderedMatrix<K> {
    /// Creates a zero matrix with the given numbers of blocks and border unknowns.
    pub fn new(count: usize, border: usize) -> Self {
        let couplings = vec![[[0.0; K]; K]; count.saturating_sub(1)];
        Self {
            diagonal: vec![Dense::default(); count],
            below: couplings.clone(),
            above: couplings,
            right: vec![[0.0; K]; count * border],
            bottom: vec![[0.0; K]; count * border],
            corner: vec![0.0; border * border],
            border,
            schur: DynamicDense::new(border),
        }
    }

    /// Sets all entries to zero, so that the matrix can be filled again.
    pub fn clear(&mut self) {
        for block in &mut self.diagonal {
            *block.rows_mut() = [[0.0; K]; K];
        }
        self.above.fill([[0.0; K]; K]);
        self.below.fill([[0.0; K]; K]);
        self.right.fill([0.0; K]);
        self.bottom.fill([0.0; K]);
        self.corner.fill(0.0);
    }

    /// Adds `value` to the entry in the given row (equation) and column (unknown).
    ///
    /// # Panics
    ///
    /// Panics if the matrix has no entry in the given row and column. The reason is either that the
    /// blocks are not neighbors or that the equation or the unknown does not exist.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let (chain, border) = (K * self.diagonal.len(), self.border);
        let border_index = |x: usize| {
            assert!(x - chain < border, "index {x} is outside the matrix");
            x - chain
        };
        let entry = match (row < chain, column < chain) {
            (true, true) => {
                let (i, j) = (row / K, column / K);
                if i == j {
                    &mut self.diagonal[i].rows_mut()[row % K][column % K]
                } else if i + 1 == j {
                    &mut self.above[i][column % K][row % K]
                } else {
                    assert!(i == j + 1, "blocks {i} and {j} are not neighbors");
                    &mut self.below[j][row % K][column % K]
                }
            }
            (true, false) => &mut self.right[row / K * border + border_index(column)][row % K],
            (false, true) => &mut self.bottom[column / K * border + border_index(row)][column % K],
            (false, false) => &mut self.corner[border_index(row) * border + border_index(column)],
        };
        *entry += value;
    }

    /// Returns the entries of block `i`, which are the diagonal block and its couplings to the
    /// border. Use this method to add many entries at once.
    pub fn block_mut(&mut self, i: usize) -> BorderedBlock<'_, K> {
        let of_border = i * self.border..(i + 1) * self.border;
        BorderedBlock {
            rows: self.diagonal[i].rows_mut(),
            right: &mut self.right[of_border.clone()],
            bottom: &mut self.bottom[of_border],
        }
    }

    /// Fixes an unknown by replacing its row and column with those of the identity matrix.
    pub fn fix(&mut self, unknown: usize) {
        let (count, border) = (self.diagonal.len(), self.border);
        if let Some(border_index) = unknown.checked_sub(K * count) {
            for columns in [&mut self.right, &mut self.bottom] {
                columns.iter_mut().skip(border_index).step_by(border).for_each(|c| *c = [0.0; K]);
            }
            for other in 0..border {
                self.corner[border_index * border + other] = 0.0;
                self.corner[other * border + border_index] = 0.0;
            }
            self.corner[border_index * border + border_index] = 1.0;
            return;
        }
        let (i, k) = (unknown / K, unknown % K);
        // The coefficients of this unknown are set to zero in both matrices that couple its block
        // to the next block.
        if let (Some(above), Some(below)) = (self.above.get_mut(i), self.below.get_mut(i)) {
            for line in above.iter_mut().chain(below) {
                line[k] = 0.0;
            }
        }
        if let Some(before) = i.checked_sub(1) {
            self.above[before][k] = [0.0; K];
            self.below[before][k] = [0.0; K];
        }
        let BorderedBlock { rows, right, bottom } = self.block_mut(i);
        for line in right.iter_mut().chain(bottom) {
            line[k] = 0.0;
        }
        for row in rows.iter_mut() {
            row[k] = 0.0;
        }
        rows[k] = from_fn(|j| if j == k { 1.0 } else { 0.0 });
    }

    /// Returns the Schur complement (N11), row by row. It is the matrix of the border after
    /// elimination of the chain. The matrix must have been factorized.
    pub fn condensed(&self) -> &[f64] {
        &self.corner
    }

    /// Factorizes the matrix.
    ///
    /// # Errors
    ///
    /// Returns [`Singular`] if a pivot is zero or not finite.
    pub fn factorize(&mut self) -> Result<(), Singular> {
        let (count, border) = (self.diagonal.len(), self.border);
        for i in 0..count {
            let (done, here) = self.right.split_at_mut(i * border);
            let here = &mut here[..border];
            if i > 0 {
                let (before, rows) = (&self.above[i - 1], &self.below[i - 1]);
                // D_i ← D_i − L_i D_{i−1}⁻¹ U_{i−1}                       (N10)
                for (row, below) in self.diagonal[i].rows_mut().iter_mut().zip(rows) {
                    for (entry, column) in row.iter_mut().zip(before) {
                        *entry -= dot(below, column);
                    }
                }
                for (here, before) in here.iter_mut().zip(&done[(i - 1) * border..]) {
                    *here = minus_product(here, rows, before);
                }
            }
            let block = &mut self.diagonal[i];
            block.factorize()?;
            let above = self.above.get_mut(i);
            for column in above.into_iter().flatten().chain(here) {
                block.solve(column);
            }
        }
        for i in (0..count.saturating_sub(1)).rev() {
            let (here, next) = self.right[i * border..].split_at_mut(border);
            for (here, next) in here.iter_mut().zip(next) {
                *here = minus_product_by_columns(here, &self.above[i], next);
            }
        }
        for r in 0..border {
            for c in 0..border {
                let part =
                    |i: usize| dot(&self.bottom[i * border + r], &self.right[i * border + c]);
                let inside: f64 = (0..count).map(part).sum();
                // S = C − B T⁻¹ R                                         (N11)
                let entry = &mut self.corner[r * border + c];
                *entry -= inside;
                self.schur.set(r, c, *entry);
            }
        }
        self.schur.factorize()
    }

    /// Solves a linear system in place: overwrites the right-hand side with the solution.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let (count, border) = (self.diagonal.len(), self.border);
        let (chain, rest) = rhs.split_at_mut(count * K);
        let (chain, _) = chain.as_chunks_mut::<K>();
        for i in 0..count {
            let (before, here) = chain.split_at_mut(i);
            // y_i = D_i⁻¹ (r_i − L_i y_{i−1})                             (N10)
            if let Some(before) = before.last() {
                here[0] = minus_product(&here[0], &self.below[i - 1], before);
            }
            self.diagonal[i].solve(&mut here[0]);
        }
        for i in (0..count.saturating_sub(1)).rev() {
            // x_i = y_i − D_i⁻¹ U_i x_{i+1}                               (N10)
            chain[i] = minus_product_by_columns(&chain[i], &self.above[i], &chain[i + 1]);
        }
        if border == 0 {
            return;
        }
        // S z = r_B − B T⁻¹ r,  x ← T⁻¹ r − T⁻¹ R z                       (N11)
        for (rows, x) in self.bottom.chunks_exact(border).zip(&*chain) {
            for (entry, row) in rest.iter_mut().zip(rows) {
                *entry -= dot(row, x);
            }
        }
        self.schur.solve(rest);
        for (x, columns) in chain.iter_mut().zip(self.right.chunks_exact(border)) {
            for (column, z) in columns.iter().zip(&*rest) {
                for (x, entry) in x.iter_mut().zip(column) {
                    *x -= entry * z;
                }
            }
        }
    }
}

/// Returns `$a - M b$` for a matrix `$M$` that is given by its rows.
fn minus_product<const K: usize>(a: &[f64; K], rows: &[[f64; K]; K], b: &[f64; K]) -> [f64; K] {
    from_fn(|k| a[k] - dot(&rows[k], b))
}

/// Returns `$a - M b$` for a matrix `$M$` that is given by its columns.
fn minus_product_by_columns<const K: usize>(
    a: &[f64; K],
    columns: &[[f64; K]; K],
    b: &[f64; K],
) -> [f64; K] {
    let mut difference = *a;
    for (column, b) in columns.iter().zip(b) {
        for (x, entry) in difference.iter_mut().zip(column) {
            *x -= entry * b;
        }
    }
    difference
}

fn dot<const K: usize>(a: &[f64; K], b: &[f64; K]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
