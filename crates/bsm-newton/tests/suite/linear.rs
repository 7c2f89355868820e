//! Tests of bordered block matrices: comparisons with dense matrices, and use in Newton's method.

use bsm_newton::{BorderedMatrix, Dense, DynamicDense, Singular};

/// Generator of uniform random numbers between -1 and 1, with a fixed seed.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(self.0 >> 32).expect("32 bits")) / 2.0_f64.powi(31) - 1.0
    }
}

/// Returns the entries of a symmetric positive definite matrix with `count` blocks of size `K` and
/// a border.
fn entries<const K: usize>(count: usize, border: usize, seed: u64) -> Vec<(usize, usize, f64)> {
    let (mut draw, n) = (Draw(seed), K * count + border);
    let mut all = Vec::new();
    let mut sums = vec![1.0; n];
    for i in 0..n {
        for j in 0..i {
            if i >= K * count || i / K - j / K <= 1 {
                let value = draw.next();
                all.extend([(i, j, value), (j, i, value)]);
                sums[i] += value.abs();
                sums[j] += value.abs();
            }
        }
    }
    // Each diagonal entry exceeds the sum of the absolute values of all other entries in its row.
    all.extend(sums.into_iter().enumerate().map(|(i, sum)| (i, i, sum)));
    all
}

/// Checks that the bordered block matrix gives the same solution as a dense matrix with the same
/// entries.
fn assert_solutions_agree<const K: usize>(count: usize, border: usize, seed: u64) {
    let n = K * count + border;
    let (mut blocks, mut dense) = (BorderedMatrix::<K>::new(count, border), DynamicDense::new(n));
    for (i, j, value) in entries::<K>(count, border, seed) {
        blocks.add(i, j, value);
        dense.set(i, j, value);
    }
    let mut draw = Draw(7);
    let mut x: Vec<f64> = (0..n).map(|_| draw.next()).collect();
    let mut y = x.clone();
    assert_eq!((blocks.factorize(), dense.factorize()), (Ok(()), Ok(())));
    blocks.solve(&mut x);
    dense.solve(&mut y);
    for (i, (x, y)) in x.iter().zip(&y).enumerate() {
        // The tolerance allows for rounding errors with condition numbers below 100.
        assert!((x - y).abs() <= 1e-14, "{i}: {x} {y}");
    }
}

#[test]
fn bordered_block_matrix_matches_the_dense_solver() {
    assert_solutions_agree::<2>(100, 10, 1);
    assert_solutions_agree::<2>(100, 0, 2);
    assert_solutions_agree::<5>(7, 5, 3);
    assert_solutions_agree::<3>(1, 4, 4);
    assert_solutions_agree::<2>(0, 6, 5);
}

/// The tridiagonal matrix (-1, 2, -1) with n unknowns has the solution x_i = i (n + 1 − i)/2 for
/// unit loads. The same system is written as a ring of n + 1 unknowns whose last unknown is fixed
/// and is part of the border.
#[test]
fn cyclic_tridiagonal_system_is_solved_as_a_bordered_tridiagonal_system() {
    const N: usize = 9;
    let mut ring = BorderedMatrix::<1>::new(N, 1);
    for i in 0..=N {
        ring.add(i, i, 2.0);
        let next = (i + 1) % (N + 1);
        ring.add(i, next, -1.0);
        ring.add(next, i, -1.0);
    }
    ring.fix(N);
    assert_eq!(ring.factorize(), Ok(()));
    let mut x = vec![1.0; N];
    x.push(0.0);
    ring.solve(&mut x);
    for (i, x) in x[..N].iter().enumerate() {
        let place = f64::from(u32::try_from(i + 1).expect("small"));
        // The tolerance allows for rounding errors of ten operations with numbers up to 12.5.
        assert!((x - 0.5 * place * (10.0 - place)).abs() <= 1e-13, "{i}: {x}");
    }
}

/// A matrix with fixed unknowns equals a matrix that was filled without the entries of these
/// unknowns.
#[test]
fn fixed_unknowns_have_rows_of_the_identity_matrix() {
    let (count, border, fixed) = (6, 3, [0, 5, 6, 11, 13]);
    let [mut all, mut without] = [0, 1].map(|_| BorderedMatrix::<2>::new(count, border));
    for (i, j, value) in entries::<2>(count, border, 9) {
        all.add(i, j, value);
        if !fixed.contains(&i) && !fixed.contains(&j) {
            without.add(i, j, value);
        }
    }
    for i in fixed {
        all.fix(i);
        without.add(i, i, 1.0);
    }
    let mut draw = Draw(11);
    let rhs: Vec<f64> = (0..2 * count + border).map(|_| draw.next()).collect();
    let [x, y] = [&mut all, &mut without].map(|matrix| {
        assert_eq!(matrix.factorize(), Ok(()));
        let mut x = rhs.clone();
        matrix.solve(&mut x);
        x
    });
    // Both solutions must be bit-identical.
    assert_eq!(x, y);
    for i in fixed {
        // In a row of the identity matrix, the solution equals the right-hand side.
        assert!((x[i] - rhs[i]).abs() <= 1e-15, "{i}");
    }
}

/// At each of several points, springs connect the point to two bodies. The Schur complement
/// contains the stiffness of the springs in series.
#[test]
fn condensed_matrix_is_the_schur_complement() {
    let (mut matrix, count) = (BorderedMatrix::<1>::new(4, 2), 4);
    for i in 0..count {
        // The stiffness is k₁ = 1 + i toward body 0 and k₂ = 2 toward body 1.
        let k = [1.0 + f64::from(u32::try_from(i).expect("small")), 2.0];
        matrix.add(i, i, k[0] + k[1]);
        for (body, k) in k.into_iter().enumerate() {
            matrix.add(i, count + body, -k);
            matrix.add(count + body, i, -k);
            matrix.add(count + body, count + body, k);
        }
    }
    // The bodies are not fixed, so the last pivot is zero or a rounding error. The condensed matrix
    // is still valid.
    let _ = matrix.factorize();
    let series: f64 = (1..=4).map(|k| f64::from(k) * 2.0 / (f64::from(k) + 2.0)).sum();
    let expected = [series, -series, -series, series];
    for (found, expected) in matrix.condensed().iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-14, "{:?}", matrix.condensed());
    }
}

/// Singular matrices are expected failures. They are reported as errors, without a panic.
#[test]
fn singular_matrices_are_reported() {
    let mut zero = Dense::<3>::default();
    assert_eq!(zero.factorize(), Err(Singular));
    *zero.rows_mut() = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [1.0, 0.0, 1.0]];
    assert_eq!(zero.factorize(), Err(Singular));
    zero.rows_mut()[0][0] = f64::NAN;
    assert_eq!(zero.factorize(), Err(Singular));
    assert!(DynamicDense::new(4).factorize().is_err());
    let mut blocks = BorderedMatrix::<2>::new(3, 1);
    for i in [0, 1, 2, 3, 5, 6] {
        blocks.add(i, i, 1.0);
    }
    assert_eq!(blocks.factorize(), Err(Singular));
    blocks.clear();
    for i in 0..6 {
        blocks.add(i, i, 1.0);
    }
    assert_eq!(blocks.factorize(), Err(Singular));
}

/// The solution can be represented exactly in double precision, and it must not depend on the order
/// of the rows.
#[test]
fn small_matrices_are_solved_with_pivoting() {
    let rows = [[0.0, 2.0, 1.0], [4.0, 0.0, 0.0], [2.0, 2.0, -1.0]];
    for order in [[0, 1, 2], [1, 0, 2], [1, 2, 0], [2, 1, 0], [0, 2, 1], [2, 0, 1]] {
        let mut matrix = Dense::<3>::default();
        *matrix.rows_mut() = order.map(|i| rows[i]);
        let mut x = order.map(|i| [7.0, 4.0, 3.0][i]);
        assert_eq!(matrix.factorize(), Ok(()));
        matrix.solve(&mut x);
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-15), "{x:?}");
    }
}

/// Newton's method solves a system of points between two bodies with springs Q = k δ^{3/2} in five
/// steps. The lower body is fixed, the upper body carries a load, and bars connect neighboring
/// points. The system resembles the balls between a screw and a nut. If all springs have the same
/// k, the displacement is u = 2 (F/(n k))^{2/3}, regardless of the stiffness of the bars.
#[test]
fn newton_converges_with_a_bordered_block_matrix() {
    const N: usize = 200;
    let (bar, load, k) = (5.0, 50.0, 1.3);
    let mut x: Vec<f64> = (0..=N).map(|i| if i == N { 0.5 } else { 0.2 }).collect();
    let mut matrix = BorderedMatrix::<1>::new(N, 1);
    let mut left = vec![0.0; N + 1];
    for _ in 0..5 {
        matrix.clear();
        left.fill(0.0);
        left[N] = load;
        for i in 0..N {
            for (approach, sign) in [(x[i], 1.0), (x[N] - x[i], -1.0)] {
                let (force, slope) = (k * approach.powf(1.5), 1.5 * k * approach.sqrt());
                left[i] -= sign * force;
                matrix.add(i, i, slope);
                if sign < 0.0 {
                    left[N] -= force;
                    matrix.add(i, N, -slope);
                    matrix.add(N, i, -slope);
                    matrix.add(N, N, slope);
                }
            }
            if i + 1 < N {
                let force = bar * (x[i + 1] - x[i]);
                left[i] += force;
                left[i + 1] -= force;
                for (row, column, sign) in
                    [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)]
                {
                    matrix.add(row, column, sign * bar);
                }
            }
        }
        assert_eq!(matrix.factorize(), Ok(()));
        matrix.solve(&mut left);
        x.iter_mut().zip(&left).for_each(|(x, step)| *x += step);
    }
    let sum = f64::from(u32::try_from(N).expect("small")) * k;
    let expected = 2.0 * (load / sum).powf(2.0 / 3.0);
    // The tolerance is the rounding error of 200 forces of 0.25, divided by a stiffness of 100.
    assert!((x[N] - expected).abs() <= 1e-13, "{} {expected}", x[N]);
}
