//! Kinematics of the rolling ball.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W3) to (W6).

use bsm_kin::{Real, RealOver};

/// Returns the rolling motion relative to the nut, divided by the relative speed: the precession
/// rate `$p$` and the angular velocity in `$(t, n, b)$` (W3) to (W6).
///
/// The ball rolls along the groove at both contact centers. Each contact has half of the slip
/// across the groove that is due to the lead.
///
/// * `by_nut`: true if the nut is the controlling raceway.
/// * `lead`: sine and cosine of the lead angle.
/// * `arc`: arc length of the helix per radian, `$d/r_b$`.
/// * The last argument contains the sines and cosines of the contact angles at the nut and the
///   screw.
#[inline(always)]
pub(crate) fn rolling<F: Real>(
    by_nut: F::Mask,
    lead: (F, F),
    arc: F,
    [(sin_n, cos_n), (sin_s, cos_s)]: [(F, F); 2],
) -> (F, [F; 3]) {
    let between = cos_n * cos_s + sin_n * sin_s;
    let p = rolling_precession(by_nut, lead.1 / arc, [cos_n, cos_s], between);
    let (to_nut, to_screw) = (p * arc, (p - 1.0) * arc);
    // ω'_t = W sinα / 2                                                   (W3)
    let along = lead.0 * 0.5;
    // (ω'_n, ω'_b) = −p (d/r_b) (−sinβ_A, cosβ_A)                         (W5)
    let nut = [to_nut * sin_n, -(to_nut * cos_n)];
    // (ω'_n, ω'_b − cosα) = (p − 1)(d/r_b) (−sinβ_B, cosβ_B)              (W6)
    let screw = [-(to_screw * sin_s), to_screw * cos_s + lead.1];
    (p, [along, F::select(by_nut, nut[0], screw[0]), F::select(by_nut, nut[1], screw[1])])
}

/// Returns the precession rate of the rolling ball relative to the nut, divided by the relative
/// speed (W4), (W6).
///
/// * `by_nut`: true if the nut is the controlling raceway.
/// * `lever`: ratio `$(r_b/d)\cos\alpha$`.
/// * `[nut, screw]`: cosines of the contact angles.
/// * `between`: cosine of the difference of the contact angles.
#[inline(always)]
pub(super) fn rolling_precession<P: Real, F: RealOver<P> + Real<Mask = P::Mask>>(
    by_nut: P::Mask,
    lever: P,
    [nut, screw]: [F; 2],
    between: F,
) -> F {
    let one = between.constant(1.0);
    // p = (1 − (r_b/d) cosα cosβ_B) / (1 + cos(β_A − β_B))                (W4)
    // p = (cos(β_A − β_B) − (r_b/d) cosα cosβ_A) / (1 + cos(β_A − β_B))   (W6)
    let (near, far) = (F::select(by_nut, one, between), F::select(by_nut, screw, nut));
    (near - far * lever) / (one + between)
}
