//! Newton's method without damping, using the linear algebra of nalgebra or faer.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::{ColMut, Mat, Par, Spec};

use crate::equations::{Answer, MAX_STEPS, Matrix, System, TOLERANCE, Vector};
use crate::points::Point;

/// Runs Newton's method from the first-order starting point. The function `step` calculates a
/// Newton step from the Jacobian and the residual.
fn newton(point: &Point, mut step: impl FnMut(&Matrix, &mut Vector) -> bool) -> Option<Answer> {
    let case = System::new(point);
    let mut y = case.start;
    for _ in 0..MAX_STEPS {
        let state = case.state(&y);
        let mut r = case.residual(&y, &state);
        if r.norm_squared() <= TOLERANCE * TOLERANCE {
            return case.answer(&y, &state);
        }
        if !step(&case.jacobian(&y, &state), &mut r) {
            return None;
        }
        y -= r;
    }
    None
}

/// Solves a point with Newton's method and the LU decomposition of nalgebra, which needs no
/// allocation for fixed-size matrices.
pub(crate) fn nalgebra(point: &Point) -> Option<Answer> {
    newton(point, |jacobian, r| jacobian.lu().solve_mut(r))
}

/// Buffers for Newton's method with the LU decomposition of faer.
pub(crate) struct Faer {
    factors: Mat<f64>,
    forward: [usize; 7],
    backward: [usize; 7],
    scratch: MemBuffer,
}

impl Default for Faer {
    fn default() -> Self {
        let factorize = factor::lu_in_place_scratch::<usize, f64>(7, 7, Par::Seq, Spec::default());
        let substitute = solve::solve_in_place_scratch::<usize, f64>(7, 1, Par::Seq);
        Self {
            factors: Mat::zeros(7, 7),
            forward: [0; 7],
            backward: [0; 7],
            scratch: MemBuffer::new(StackReq::any_of(&[factorize, substitute])),
        }
    }
}

impl Faer {
    /// Solves a point with Newton's method and the LU decomposition of faer. The buffers are reused
    /// for all points.
    pub(crate) fn solve(&mut self, point: &Point) -> Option<Answer> {
        newton(point, |jacobian, r| {
            let Self { factors, forward, backward, scratch } = self;
            for (to, from) in factors.col_iter_mut().zip(jacobian.column_iter()) {
                for (to, from) in to.iter_mut().zip(from.iter()) {
                    *to = *from;
                }
            }
            let stack = MemStack::new(scratch);
            let (lu, spec) = (factors.as_mut(), Spec::default());
            let (_, rows) = factor::lu_in_place(lu, forward, backward, Par::Seq, stack, spec);
            let (lu, r) = (factors.as_ref(), ColMut::from_slice_mut(r.as_mut_slice()));
            solve::solve_in_place(lu, lu, rows, r.as_mat_mut(), Par::Seq, stack);
            true
        })
    }
}
