//! The Gauss-Newton solver of the crate argmin. No other solver in argmin uses both a residual and
//! a Jacobian.
//!
//! For a square system, a Gauss-Newton step equals a Newton step but is calculated with the inverse
//! of JᵀJ. The `vec` backend of argmin-math cannot invert matrices, and its nalgebra backend
//! requires a version of nalgebra that differs from the version in this project. Therefore, the few
//! operations that the solver requires are implemented here for fixed-size matrices.

use argmin::core::{Error, Executor, IterState, Jacobian, Operator, State};
use argmin::solver::gaussnewton::GaussNewton;
use argmin_math::{ArgminDot, ArgminInv, ArgminL2Norm, ArgminMul, ArgminSub, ArgminTranspose};

use crate::equations::{self, Answer, MAX_STEPS, System, TOLERANCE};
use crate::points::Point;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Vector(equations::Vector);

#[derive(Debug, Clone, Copy)]
pub(crate) struct Matrix(equations::Matrix);

impl ArgminSub<Vector, Vector> for Vector {
    fn sub(&self, other: &Vector) -> Vector {
        Vector(self.0 - other.0)
    }
}

impl ArgminMul<f64, Vector> for Vector {
    fn mul(&self, factor: &f64) -> Vector {
        Vector(self.0 * *factor)
    }
}

impl ArgminL2Norm<f64> for Vector {
    fn l2_norm(&self) -> f64 {
        self.0.norm()
    }
}

impl ArgminTranspose<Matrix> for Matrix {
    fn t(self) -> Matrix {
        Matrix(self.0.transpose())
    }
}

impl ArgminDot<Matrix, Matrix> for Matrix {
    fn dot(&self, other: &Matrix) -> Matrix {
        Matrix(self.0 * other.0)
    }
}

impl ArgminDot<Vector, Vector> for Matrix {
    fn dot(&self, other: &Vector) -> Vector {
        Vector(self.0 * other.0)
    }
}

impl ArgminInv<Matrix> for Matrix {
    fn inv(&self) -> Result<Matrix, Error> {
        self.0.try_inverse().map(Matrix).ok_or_else(|| Error::msg("singular"))
    }
}

impl Operator for System {
    type Param = Vector;
    type Output = Vector;

    fn apply(&self, y: &Vector) -> Result<Vector, Error> {
        Ok(Vector(self.residual(&y.0, &self.state(&y.0))))
    }
}

impl Jacobian for System {
    type Param = Vector;
    type Jacobian = Matrix;

    fn jacobian(&self, y: &Vector) -> Result<Matrix, Error> {
        Ok(Matrix(System::jacobian(self, &y.0, &self.state(&y.0))))
    }
}

/// Solves a point with the Gauss-Newton solver of argmin, using the same tolerance as all other
/// solvers.
pub(crate) fn argmin(point: &Point) -> Option<Answer> {
    let case = System::new(point);
    // The solver's own tolerance is disabled, so that only the norm of the residual ends the
    // iteration.
    let solver = GaussNewton::new().with_tolerance(f64::MIN_POSITIVE).ok()?;
    let result = Executor::new(case, solver)
        .configure(|state: IterState<Vector, (), Matrix, (), Vector, f64>| {
            state.param(Vector(case.start)).target_cost(TOLERANCE).max_iters(MAX_STEPS as u64)
        })
        .run()
        .ok()?;
    let state = result.state();
    if state.get_best_cost() > TOLERANCE {
        return None;
    }
    let y = state.get_best_param()?.0;
    case.answer(&y, &case.state(&y))
}
