//! Friction laws, and friction at a contact point.
//!
//! Theory: `docs/theory/02-balance.md`, equation (F1).

use bsm_kin::Scalar;
use bsm_newton::EvalError;
use nalgebra::Vector3;

use super::transition::Transition;

/// A friction law that gives the friction coefficient at a point of a sliding contact.
///
/// Friction acts against the slip, and its magnitude is the normal load multiplied by the
/// coefficient. This applies to a point contact (F1) and to every point of a contact ellipse (E4).
///
/// The closed forms, the reduced equations of the rigid and the elastic model, and the vectorized
/// sums over a dry contact ellipse are valid only for a constant [`Coulomb`] coefficient. They take
/// this coefficient instead of a friction law.
pub trait FrictionLaw<D> {
    /// Returns the friction coefficient at a point of the contact.
    ///
    /// * `pressure`: pressure divided by the maximum pressure in the contact, from 0 to 1.
    /// * `speed`: slip speed \[m/s\], positive.
    fn coefficient(&self, pressure: D, speed: D) -> D;

    /// Returns the position at which the slope of the friction coefficient changes along a chord of
    /// a contact ellipse (the transition). Returns `None` if the coefficient depends neither on
    /// pressure nor on speed; the integration then needs fewer nodes.
    fn bend(&self) -> Option<Transition> {
        Some(Transition::SMOOTH)
    }
}

/// A constant friction coefficient `$f \ge 0$` for every pressure and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb<D>(pub D);

impl<D: Copy> FrictionLaw<D> for Coulomb<D> {
    fn coefficient(&self, _pressure: D, _speed: D) -> D {
        self.0
    }

    fn bend(&self) -> Option<Transition> {
        None
    }
}

/// Returns the friction force on the ball at a sliding point contact \[N\] (F1).
///
/// ```math
/// F_f = -f\,Q\,\frac{v}{|v|}
/// ```
///
/// * `law`: friction law, which is evaluated at the maximum pressure.
/// * `normal_load`: normal load `$Q$` \[N\].
/// * `slip`: tangential velocity `$v$` of the ball surface relative to the nut or the screw
///   \[m/s\].
///
/// # Errors
///
/// Returns [`EvalError`] if the slip vanishes, because the direction of friction is then undefined.
pub(crate) fn friction_force<D: Scalar>(
    law: &impl FrictionLaw<D>,
    normal_load: D,
    slip: &Vector3<D>,
) -> Result<Vector3<D>, EvalError> {
    let speed = sliding(slip.dot(slip).sqrt())?;
    let friction = law.coefficient(D::from(1.0), speed);
    Ok(friction_against(slip, friction * normal_load / speed))
}

/// Returns the slip speed after checking that it is positive and finite. For other values, the
/// direction of friction is undefined.
pub(crate) fn sliding<D: Scalar>(speed: D) -> Result<D, EvalError> {
    if speed.re() > 0.0 && speed.re().is_finite() {
        return Ok(speed);
    }
    Err(EvalError {
        quantity: "slip speed at a contact",
        value: speed.re(),
        requirement: "must be positive and finite; otherwise the direction of friction is undefined",
    })
}

/// Returns the friction force \[N\] that opposes a slip (F1). `size` is the magnitude of the
/// friction force divided by the slip speed.
pub(crate) fn friction_against<D: Scalar>(slip: &Vector3<D>, size: D) -> Vector3<D> {
    // F = −f Q v/|v|                                                      (F1)
    slip * -size
}

/// Returns the absolute value of a number with derivatives. The derivatives are multiplied by the
/// sign of the number.
pub(crate) fn magnitude<D: Scalar>(x: D) -> D {
    if x.re() < 0.0 { -x } else { x }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn friction_opposes_slip_and_is_saturated() {
        let slip = Vector3::new(3.0e-4, 0.0, -4.0e-4);
        let force = friction_force(&Coulomb(0.07), 130.0, &slip).unwrap();
        assert_relative_eq!(force, Vector3::new(-0.6, 0.0, 0.8) * (0.07 * 130.0), epsilon = 1e-14);
    }

    #[test]
    fn friction_without_slip_is_rejected() {
        assert!(friction_force(&Coulomb(0.07), 130.0, &Vector3::zeros()).is_err());
        assert!(friction_force(&Coulomb(0.07), 130.0, &Vector3::repeat(f64::NAN)).is_err());
    }
}
