//! Coulomb friction at a contact point.
//!
//! Theory: `docs/theory/02-balance.md`, equation (F1).

use bsm_kin::Scalar;
use bsm_newton::EvalError;
use nalgebra::Vector3;

/// Friction force on the ball at a sliding point contact \[N\] (F1).
///
/// ```math
/// F_f = -f\,Q\,\frac{v}{|v|}
/// ```
///
/// * `friction`: Coulomb coefficient `$f \ge 0$`.
/// * `normal_load`: `$Q$` \[N\].
/// * `slip`: velocity `$v$` of the ball's surface against the body \[m/s\], tangential.
///
/// # Errors
///
/// [`EvalError`] if the slip vanishes: the direction of friction is then not defined.
pub fn friction_force<D: Scalar>(
    friction: D,
    normal_load: D,
    slip: &Vector3<D>,
) -> Result<Vector3<D>, EvalError> {
    let speed = slip.dot(slip).sqrt();
    if speed.re() > 0.0 && speed.re().is_finite() {
        // F = −f Q v/|v|                                                  (F1)
        Ok(slip * (-friction * normal_load / speed))
    } else {
        Err(EvalError {
            quantity: "slip speed at a contact",
            value: speed.re(),
            requirement: "positive and finite, for friction to have a direction",
        })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn friction_opposes_slip_and_is_saturated() {
        let slip = Vector3::new(3.0e-4, 0.0, -4.0e-4);
        let force = friction_force(0.07, 130.0, &slip).unwrap();
        assert_relative_eq!(force, Vector3::new(-0.6, 0.0, 0.8) * (0.07 * 130.0), epsilon = 1e-14);
    }

    #[test]
    fn no_slip_has_no_direction() {
        assert!(friction_force(0.07, 130.0, &Vector3::zeros()).is_err());
        assert!(friction_force(0.07, 130.0, &Vector3::repeat(f64::NAN)).is_err());
    }
}
