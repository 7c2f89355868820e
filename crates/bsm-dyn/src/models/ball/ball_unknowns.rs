//! Indices of the unknowns and equations of one ball.

use bsm_kin::Scalar;

use crate::contact::Wrench;

/// Unknowns and equations of one ball.
pub(crate) const BALL: usize = 7;

/// Places of the unknowns of one ball; [`UNLOADED_FLANK_LOAD`](unknown::UNLOADED_FLANK_LOAD) in the rigid model is
/// [`TILT`](unknown::TILT) in the elastic ones.
pub(crate) mod unknown {
    /// Load of A over the axial load per ball.
    pub(crate) const NUT_LOAD: usize = 0;
    /// Load of A' over the axial load per ball.
    pub(crate) const UNLOADED_FLANK_LOAD: usize = 1;
    /// Half the difference of the contact angles at B and A, or the one at A (T10) \[rad\].
    pub(crate) const TILT: usize = 1;
    /// Load of B over the axial load per ball.
    pub(crate) const SCREW_LOAD: usize = 2;
    /// Precession over relative speed, from the nut's on or absolute.
    pub(crate) const PRECESSION: usize = 3;
    /// Slip at A, signed.
    pub(crate) const SLIP: usize = 4;
    /// Direction of the slip at A.
    pub(crate) const SLIP_ANGLE: usize = 5;
    /// Moment of the spin about the common normal.
    pub(crate) const SPIN: usize = 6;
}

/// Places of the equations of one ball.
pub(crate) mod equation {
    /// Force balance in the triad (t, N, e_x) of the loaded contacts.
    pub(crate) const FORCE: [usize; 3] = [0, 1, 2];
    /// Moment balance in it; the second one is about the contact normal.
    pub(crate) const MOMENT: [usize; 3] = [3, 4, 5];
    /// Axial load.
    pub(crate) const AXIAL_LOAD: usize = 6;
}

/// The [`equation`]s as text.
pub(crate) const ROWS: [&str; BALL] = [
    "force balance along the helix (t)",
    "force balance along the contact normal (N)",
    "force balance across the groove (e_x)",
    "moment balance about t",
    "moment balance about the contact normal (N)",
    "moment balance about e_x",
    "axial load",
];

/// The seven rows, from what the Newton-Euler equations and the axial load leave over.
pub(crate) fn rows<D: Scalar>(residual: &Wrench<D>, axial_load: D) -> [D; BALL] {
    let [force, moment] = [residual.force, residual.moment];
    [force.x, force.y, force.z, moment.x, moment.y, moment.z, axial_load]
}

/// Weight of an equation whose terms are of this size: one over it, as far as a double goes. A size
/// that is not a number is left to the solve, which says so.
pub(crate) fn weight(size: f64) -> f64 {
    if size.is_nan() { 1.0 } else { size.clamp(1e-300, 1e300).recip() }
}
