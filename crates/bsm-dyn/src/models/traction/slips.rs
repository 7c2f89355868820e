//! Newton steps along which slips and spin change linearly.
//!
//! Friction depends on the slips, which are small differences of large angular velocities. A step
//! that is linear in the unknowns (T1) rotates the contacts. This rotation causes second-order
//! slips that can be as large as the slips themselves.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T26) to (T31).

use std::array::from_fn;

use bsm_kin::{Jet, Over, spin_at_nut};

use super::equations::{MeanAngle, OMEGA, SlipBall, frenet};
use crate::models::ball::BALL_UNKNOWNS;
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};

/// Maximum relative change of a load, and maximum change of the tilt \[rad\], for which a step is
/// linear in the unknowns. The resulting second-order slips are of the order of the square of this
/// limit.
const MAX_STRAIGHT_STEP: f64 = 1e-4;

/// Maximum relative change of a slip across the grooves in the first trial step.
const MAX_SLIP_CHANGE: f64 = 0.6;

/// Slip, divided by `$r_b W$`, that is added to a slip before its relative change is limited (T31).
/// Slips that are much smaller than this value may change their sign.
const SMALL_SLIP: f64 = 0.01;

/// Maximum spin, divided by `$W$`, for steps along which the slips change linearly. Up to this
/// limit, the rounding error of the spin is negligible compared with the slip.
const MAX_SPIN: f64 = 1e6;

impl SlipBall<'_> {
    /// Returns the unknowns after a step. If the step changes the loads or the tilt by more than
    /// [`MAX_STRAIGHT_STEP`], slips and spin change linearly along the step; otherwise the unknowns
    /// change linearly.
    pub(super) fn with_slips(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        step: &[f64; BALL_UNKNOWNS],
    ) -> [f64; BALL_UNKNOWNS] {
        let mut next = *y;
        for (next, step) in next.iter_mut().zip(step) {
            *next += step;
        }
        let turned = [NUT_LOAD, SCREW_LOAD]
            .map(|i| (step[i] / y[i]).abs())
            .into_iter()
            .fold(step[TILT].abs(), f64::max);
        if self.uses_nut_angle || turned < MAX_STRAIGHT_STEP {
            return next;
        }
        self.with_linear_slips(y, step, &next).unwrap_or(next)
    }

    /// Returns the slips along the grooves, the rotation about t and the spin for given unknowns,
    /// or `None` if a contact is lost.
    fn slips<D: Over<f64>>(&self, y: &[D; BALL_UNKNOWNS]) -> Option<Slips<D>> {
        let angles = self.loaded_angles(y, y[TILT].sin_cos())?;
        let motions = self.contact_motions(y, angles.contacts);
        let one = y[TILT].constant(1.0);
        // u = d (P − Ω) + ω_c,  r_b = 1                                   (T26)
        let along = [motions[0].slip(one)[0], motions[1].slip(one)[0]];
        let omega = frenet(self.contacts.scaled.lead, y);
        // σ = sinβ ω_b + cosβ ω_n                                         (T27)
        Some(Slips { along, rolling: omega[0], spin: spin_at_nut(omega, angles.mean) })
    }

    /// Returns the unknowns after a step along which loads, tilt, both slips along the grooves, the
    /// rotation about t and the spin change linearly. Returns `None` if a contact is lost at either
    /// end of the step or if the spin exceeds [`MAX_SPIN`].
    ///
    /// * `straight`: unknowns at the end of the step if all unknowns changed linearly along the
    ///   step.
    fn with_linear_slips(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        step: &[f64; BALL_UNKNOWNS],
        straight: &[f64; BALL_UNKNOWNS],
    ) -> Option<[f64; BALL_UNKNOWNS]> {
        let ((sin_lead, cos_lead), arc) = (self.contacts.scaled.lead, self.contacts.scaled.arc);
        let moving = from_fn(|i| Jet::<1> { re: y[i], eps: [step[i]] });
        // Slips and spin are extrapolated linearly over the whole step    (T28)
        let Slips { along: [nut, screw], rolling, spin } = self.slips(&moving)?;
        let (nut_slip, screw_slip) = (nut.re + nut.eps[0], screw.re + screw.eps[0]);
        let (w_t, spin) = (rolling.re + rolling.eps[0], spin.re + spin.eps[0]);
        if spin.abs() >= MAX_SPIN {
            return None;
        }
        let tilt @ (_, cos_tilt) = straight[TILT].sin_cos();
        let MeanAngle { mean: (sin, cos), contacts: [(sin_a, cos_a), (_, cos_b)] } =
            self.loaded_angles(straight, tilt)?;
        // e = (u_A − u_B − d + cosα cosβ_B)/(2 cosν)                      (T29)
        let across = (nut_slip - screw_slip - arc + cos_lead * cos_b) / (2.0 * cos_tilt);
        // ω_b = cosβ e + sinβ σ,  ω_n = cosβ σ − sinβ e                   (T29)
        let (w_b, w_n) = (cos * across + sin * spin, cos * spin - sin * across);
        // P' = (u_A − cosβ_A ω_b + sinβ_A ω_n)/d                          (T30)
        let from_nut = (nut_slip - cos_a * w_b + sin_a * w_n) / arc;
        let mut next = *straight;
        next[PRECESSION] = from_nut - (self.offset() - self.contacts.scaled.nut_speed);
        // ω_k = cosα ω_b + sinα ω_t,  ω_c = sinα ω_b − cosα ω_t           (T30)
        next[OMEGA[0]] = cos_lead * w_b + sin_lead * w_t;
        next[OMEGA[1]] = w_n;
        next[OMEGA[2]] = sin_lead * w_b - cos_lead * w_t;
        Some(next)
    }
}

/// Returns the fraction of a Newton step that is tried first, in (0, 1].
///
/// If the friction over both ellipses acts entirely across the grooves, only second-order terms
/// determine how much of the slip due to the lead occurs at each contact. In this case, a step that
/// reverses a slip is meaningless.
pub(super) fn max_step_fraction(
    lead: (f64, f64),
    y: &[f64; BALL_UNKNOWNS],
    step: &[f64; BALL_UNKNOWNS],
) -> f64 {
    let ([across, ..], [change, ..]) = (frenet(lead, y), frenet(lead, step));
    // λ ≤ 0.6 (|ω_t| + 0.01)/|δω_t|,  λ ≤ 0.6 (|ω_t − sinα| + 0.01)/|δω_t|  (T31)
    let parts = [across, across - lead.0]
        .map(|slip| change.abs() / ((slip.abs() + SMALL_SLIP) * MAX_SLIP_CHANGE));
    parts.into_iter().fold(1.0, f64::max).recip()
}

/// Slips along the grooves at both contact centers, rotation about t, and spin about the mean
/// contact normal.
struct Slips<D> {
    along: [D; 2],
    rolling: D,
    spin: D,
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::extreme::random_practical_screw;
    use crate::hertz::Quadrature;
    use crate::models::raceway_control::RollingBall;

    /// Calls `check` with rolling balls at random operating points that occur in practice.
    fn for_each_practical_rolling_ball(
        mut check: impl FnMut(&SlipBall<'_>, &[f64; BALL_UNKNOWNS], &mut ChaCha8Rng),
    ) {
        let (mut rng, quadrature) = (ChaCha8Rng::seed_from_u64(31), Quadrature::of(1e-4));
        for _ in 0..200 {
            let Ok(contacts) = random_practical_screw(&mut rng).scaled() else { continue };
            let Ok(rolling_ball) = RollingBall::guess(&contacts) else { continue };
            let ball = SlipBall::of_contacts(&contacts, &quadrature, 1e-4);
            let y = ball.unknowns(&rolling_ball.loaded, &rolling_ball.to_nut);
            check(&ball, &y, &mut rng);
        }
    }

    fn slips(ball: &SlipBall<'_>, y: &[f64; BALL_UNKNOWNS]) -> [f64; 4] {
        let loaded = ball.loaded(y).expect("contacts");
        let to_nut = ball.motion_to_nut(y, &loaded);
        let motions = crate::models::ball::to_both(&to_nut, &loaded.frame);
        let [nut, screw] = std::array::from_fn(|i| {
            let arc = ball.contacts.scaled.arc;
            let local = crate::ellipse::contact_motion(&motions[i], &loaded.contacts[i], arc);
            local.slip(1.0)[0]
        });
        [nut, screw, to_nut.omega.x, to_nut.omega.y]
    }

    /// Half of a step changes the slips by half as much as the whole step, even if the step rotates
    /// the contacts by 0.1 rad.
    #[test]
    fn slip_velocities_change_linearly_along_a_newton_step() {
        let (mut seen, mut bent) = (0, 0.0_f64);
        for_each_practical_rolling_ball(|ball, y, rng| {
            let mut step = [0.0; BALL_UNKNOWNS];
            for (step, y) in step.iter_mut().zip(y) {
                *step = 0.1 * rng.random_range(-1.0..1.0) * (0.1 + y.abs());
            }
            let at = |part: f64| ball.with_slips(y, &step.map(|step| part * step));
            let [begin, middle, end] = [*y, at(0.5), at(1.0)].map(|y| slips(ball, &y));
            let straight = std::array::from_fn(|i| y[i] + step[i]);
            for i in 0..4 {
                // The tolerance allows for rounding errors of precession rates up to ten.
                let off = middle[i] - 0.5 * (begin[i] + end[i]);
                assert!(off.abs() <= 1e-13, "{i} {off:e} {begin:?} {middle:?} {end:?}");
                bent = bent.max((slips(ball, &straight)[i] - end[i]).abs());
            }
            seen += 1;
        });
        // If the unknowns changed linearly instead, the step would cause second-order slips.
        assert!(seen > 150 && bent > 1e-3, "{seen} {bent:e}");
    }

    #[test]
    fn first_trial_step_does_not_reverse_large_slip_velocities() {
        for_each_practical_rolling_ball(|ball, y, rng| {
            let lead = ball.contacts.scaled.lead;
            let step = std::array::from_fn(|_| rng.random_range(-10.0..10.0));
            let part = max_step_fraction(lead, y, &step);
            let shares = |y| {
                let [across, ..] = frenet(lead, &y);
                [across, across - lead.0]
            };
            let next = shares(std::array::from_fn(|i| y[i] + part * step[i]));
            for (share, next) in shares(*y).into_iter().zip(next) {
                // Slips below 0.6 · 0.01/(1 − 0.6) may reverse; the last term allows for rounding.
                let small = MAX_SLIP_CHANGE * SMALL_SLIP / (1.0 - MAX_SLIP_CHANGE) + 1e-15;
                assert!(share * next > 0.0 || share.abs() <= small, "{share} {next}");
            }
        });
    }

    /// The derivative of the unknowns along a curved step, calculated with central differences,
    /// equals the Newton step.
    #[test]
    fn curved_step_is_tangent_to_the_newton_step() {
        for_each_practical_rolling_ball(|ball, y, rng| {
            let step: [f64; BALL_UNKNOWNS] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            let part = 2e-4;
            let [up, down] =
                [part, -part].map(|part| ball.with_slips(y, &step.map(|step| part * step)));
            for i in 0..BALL_UNKNOWNS {
                let slope = (up[i] - down[i]) / (2.0 * part);
                // The tolerance allows for the truncation error of the central difference and for
                // rounding errors of the precession rates.
                assert!((slope - step[i]).abs() <= 1e-5, "{i} {slope} {}", step[i]);
            }
        });
    }
}
