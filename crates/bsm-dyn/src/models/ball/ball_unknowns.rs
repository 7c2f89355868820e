//! Indices of the unknowns and equations of one ball.

use bsm_kin::Scalar;

use crate::contact::Wrench;

/// Number of unknowns and of equations of one ball.
pub(crate) const BALL_UNKNOWNS: usize = 7;

/// Indices of the unknowns of one ball. Index 1 is
/// [`UNLOADED_FLANK_LOAD`](unknown::UNLOADED_FLANK_LOAD) in the rigid model and
/// [`TILT`](unknown::TILT) in the elastic models.
pub(crate) mod unknown {
    /// Ratio of the load at A (loaded flank of the nut) to the axial load per ball.
    pub(crate) const NUT_LOAD: usize = 0;
    /// Ratio of the load at A' (unloaded flank of the nut) to the axial load per ball.
    pub(crate) const UNLOADED_FLANK_LOAD: usize = 1;
    /// Half the difference between the contact angles at B and A, or the contact angle at A if the
    /// unknowns (T10) are used \[rad\].
    pub(crate) const TILT: usize = 1;
    /// Ratio of the load at B (loaded flank of the screw) to the axial load per ball.
    pub(crate) const SCREW_LOAD: usize = 2;
    /// Precession rate, either absolute or relative to the nut, divided by the relative speed.
    pub(crate) const PRECESSION: usize = 3;
    /// Signed slip speed at A, divided by `$r_b|W|$`.
    pub(crate) const SLIP: usize = 4;
    /// Direction of the slip at A \[rad\].
    pub(crate) const SLIP_ANGLE: usize = 5;
    /// Gyroscopic moment that is caused by the spin about the common normal, in scaled units: `$s =
    /// I P\sigma/(r_b F_a)$`.
    pub(crate) const SPIN: usize = 6;
}

/// Indices of the equations of one ball.
pub(crate) mod equation {
    /// Force balance in the triad (t, N, e_x) of the loaded contacts.
    pub(crate) const FORCE: [usize; 3] = [0, 1, 2];
    /// Moment balance in the triad (t, N, e_x); the second equation is the balance of moments about
    /// the contact normal.
    pub(crate) const MOMENT: [usize; 3] = [3, 4, 5];
    /// Balance between the axial contact force on the nut and the external axial load on the nut.
    pub(crate) const AXIAL_LOAD: usize = 6;
}

/// Names of the equations in the order of [`equation`].
pub(crate) const EQUATION_NAMES: [&str; BALL_UNKNOWNS] = [
    "force balance along the helix (t)",
    "force balance along the contact normal (N)",
    "force balance across the groove (e_x)",
    "moment balance about t",
    "moment balance about the contact normal (N)",
    "moment balance about e_x",
    "axial load",
];

/// Combines the residuals of the Newton-Euler equations of the ball and of the axial force balance
/// of the nut into one array.
pub(crate) fn residual_rows<D: Scalar>(residual: &Wrench<D>, axial_load: D) -> [D; BALL_UNKNOWNS] {
    let [force, moment] = [residual.force, residual.moment];
    [force.x, force.y, force.z, moment.x, moment.y, moment.z, axial_load]
}

/// Returns the weight of an equation, which is the reciprocal of the magnitude of its terms,
/// limited to the range of double precision. If the magnitude is NaN, the weight is one; the solver
/// then reports the NaN in the equation.
pub(crate) fn weight(size: f64) -> f64 {
    if size.is_nan() { 1.0 } else { size.clamp(1e-300, 1e300).recip() }
}
