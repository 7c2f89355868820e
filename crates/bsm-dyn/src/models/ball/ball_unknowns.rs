//! Indices of the unknowns and equations of one ball.

use bsm_kin::Scalar;

use crate::contact::Wrench;

/// Number of unknowns and of equations of one ball.
pub(crate) const BALL: usize = 7;

/// Indices of the unknowns of one ball. The rigid model has [`UNLOADED_FLANK_LOAD`](unknown::UNLOADED_FLANK_LOAD), the elastic
/// models have [`TILT`](unknown::TILT) instead.
pub(crate) mod unknown {
    /// Ratio of the load at A to the axial load per ball.
    pub(crate) const NUT_LOAD: usize = 0;
    /// Ratio of the load at A' to the axial load per ball.
    pub(crate) const UNLOADED_FLANK_LOAD: usize = 1;
    /// Half the difference of the contact angles at B and A, or the contact angle at A (T10) \[rad\].
    pub(crate) const TILT: usize = 1;
    /// Ratio of the load at B to the axial load per ball.
    pub(crate) const SCREW_LOAD: usize = 2;
    /// Ratio of the precession, relative to the nut or absolute, to the relative speed.
    pub(crate) const PRECESSION: usize = 3;
    /// Signed slip speed at A, divided by `$r_b|W|$`.
    pub(crate) const SLIP: usize = 4;
    /// Direction of the slip at A \[rad\].
    pub(crate) const SLIP_ANGLE: usize = 5;
    /// Gyroscopic moment of the spin about the common normal `$s = I P\sigma/(r_b F_a)$`.
    pub(crate) const SPIN: usize = 6;
}

/// Indices of the equations of one ball.
pub(crate) mod equation {
    /// Force balance in the triad (t, N, e_x) of the loaded contacts.
    pub(crate) const FORCE: [usize; 3] = [0, 1, 2];
    /// Moment balance in the same triad; the second equation is about the contact normal.
    pub(crate) const MOMENT: [usize; 3] = [3, 4, 5];
    /// Axial load.
    pub(crate) const AXIAL_LOAD: usize = 6;
}

/// Names of the equations in the order of [`equation`].
pub(crate) const ROWS: [&str; BALL] = [
    "force balance along the helix (t)",
    "force balance along the contact normal (N)",
    "force balance across the groove (e_x)",
    "moment balance about t",
    "moment balance about the contact normal (N)",
    "moment balance about e_x",
    "axial load",
];

/// Returns the seven residuals from the residuals of the Newton-Euler equations and of the axial load.
pub(crate) fn rows<D: Scalar>(residual: &Wrench<D>, axial_load: D) -> [D; BALL] {
    let [force, moment] = [residual.force, residual.moment];
    [force.x, force.y, force.z, moment.x, moment.y, moment.z, axial_load]
}

/// Returns the weight of an equation, the reciprocal of the size of its terms, limited to the range of double precision. A
/// size of NaN has weight one; the solve then reports the NaN of the equation.
pub(crate) fn weight(size: f64) -> f64 {
    if size.is_nan() { 1.0 } else { size.clamp(1e-300, 1e300).recip() }
}
