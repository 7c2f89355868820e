//! Direct solution of the raceway-control model by Newton's method (static balance, controlling
//! raceway and rolling motion) for one operating point or for several points side by side in a SIMD
//! vector.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W3) to (W10).

use bsm_kin::{Real, relative_rotation, spin_at_nut};
use bsm_newton::LaneIterate;

use super::ball::RacewayBall;
use super::rolling::rolling;
use super::statics::{STATIC_UNKNOWNS, StaticBalance};
use crate::models::ball::{Control, LoadedContact, ScaledBall};

/// Minimum relative difference of the spin moments (dimensionless). If the difference is smaller,
/// it may be a rounding error, and the controlling raceway is undecided.
const MIN_SPIN_EXCESS: f64 = 1e-9;

/// Minimum cotangent of the contact angles (dimensionless). If a cotangent is smaller, its sign may
/// be due to rounding errors, and the loaded flank is undecided.
const MIN_COTANGENT: f64 = 1e-9;

/// Root of the static balance of a rolling ball, found directly by Newton's method.
#[derive(Debug, Clone, Copy)]
pub struct RollingRoot<F: Real> {
    /// True if the nut is the controlling raceway.
    pub by_nut: F::Mask,
    /// Unknowns of the static balance (W12).
    pub unknowns: [F; STATIC_UNKNOWNS],
    /// Contacts at the nut and the screw.
    pub sides: [LoadedContact<F>; 2],
    /// Number of Newton steps.
    pub steps: F,
    /// Scaled residual of the static balance.
    pub residual: F,
    /// True if this is the first root and (W7) selects the controlling raceway of this root.
    pub is_first_root: F::Mask,
    /// True if the ball has no other rolling motion for the same inputs.
    pub unique: F::Mask,
}

impl<F: Real> RollingRoot<F> {
    /// Solves for the state of the rolling ball by Newton's method, starting from equal contact
    /// angles. The field `is_first_root` of the result is false if the root is not certainly the
    /// first root, or if rounding errors could affect the controlling raceway or the loaded flank.
    ///
    /// * `control`: controlling raceway; `None` selects the raceway by criterion (W7).
    /// * `requested`: mask of the points to solve.
    #[inline(always)]
    pub fn direct(ball: &RacewayBall<F>, control: Option<Control>, requested: F::Mask) -> Self {
        match control {
            Some(raceway) => Self::controlled(ball, raceway, requested),
            None => Self::selected(ball, requested),
        }
    }

    /// Solves for the state of a rolling ball with a given controlling raceway.
    #[inline(always)]
    fn controlled(ball: &RacewayBall<F>, raceway: Control, requested: F::Mask) -> Self {
        let by_nut = ball.unloaded_cot.mask(raceway == Control::Nut);
        let balance = StaticBalance::of(ball, by_nut);
        let mut at = balance.start(requested);
        balance.iterate(&mut at);
        let found = requested & at.has_ended;
        let unique = balance.is_unique(found);
        Self::checked(&balance, &at, found & (unique | balance.is_first(at.x)), unique)
    }

    /// Solves for the state of a rolling ball whose controlling raceway is selected by criterion
    /// (W7).
    #[inline(always)]
    fn selected(ball: &RacewayBall<F>, requested: F::Mask) -> Self {
        let nut = StaticBalance::of(ball, ball.unloaded_cot.mask(true));
        let screw = StaticBalance::of(ball, ball.unloaded_cot.mask(false));

        // Criterion (W7) is evaluated at the first root with nut control.
        let mut at = nut.start(requested);
        nut.iterate(&mut at);
        let sides = nut.loaded(at.x);
        let excess = ball.nut_excess(&sides);
        let by_nut = excess.above(MIN_SPIN_EXCESS);
        let is_first = nut.is_first(at.x);
        let is_nut_unique = nut.is_unique(requested & at.has_ended & (by_nut | !is_first));
        let mut found = requested & at.has_ended & (is_nut_unique | is_first);
        found = found & excess.abs().above(MIN_SPIN_EXCESS);
        let is_screw_unique = screw.is_unique(found);

        // If the two sides of (W7) are nearly equal, the criterion is also evaluated for the
        // screw-controlled ball. Nut control is accepted only if the criterion selects the nut for
        // this ball as well.
        let close = found & by_nut & !ball.is_control_unambiguous(&sides, excess);
        if F::any(close) {
            let mut other = LaneIterate { has_ended: !close, ..at };
            screw.iterate(&mut other);
            let on_flanks = other.x[1].above(0.0);
            let is_first = is_screw_unique & on_flanks | screw.is_first(other.x);
            let selects_nut = ball.nut_excess(&screw.loaded(other.x)).above(MIN_SPIN_EXCESS);
            found = found & (!close | other.has_ended & is_first & selects_nut);
        }

        // For points at which the screw is the controlling raceway, Newton's method continues with
        // screw control.
        let balance = StaticBalance { by_nut, ..nut };
        at.has_ended = by_nut | !found;
        balance.iterate(&mut at);
        found = found & at.has_ended & (is_screw_unique | by_nut | balance.is_first(at.x));
        let unique = is_screw_unique & (is_nut_unique | !by_nut);

        // The result is valid only if criterion (W7), evaluated for this result, confirms the
        // controlling raceway.
        let root = Self::checked(&balance, &at, found, unique);
        let excess = ball.nut_excess(&root.sides);
        let is_consistent = F::select(by_nut, excess, -excess).above(MIN_SPIN_EXCESS);
        Self { is_first_root: root.is_first_root & is_consistent, ..root }
    }

    /// Creates the result after checking the residual and the contact angles of a root.
    #[inline(always)]
    fn checked(
        balance: &StaticBalance<F>,
        at: &LaneIterate<F, STATIC_UNKNOWNS>,
        found: F::Mask,
        unique: F::Mask,
    ) -> Self {
        let (unknowns, steps) = (at.x, at.steps);
        let sides = balance.loaded(unknowns);
        let residual = balance.scaled_residual(unknowns);
        let on_flanks = sides[0].cot.above(MIN_COTANGENT) & sides[1].cot.above(MIN_COTANGENT);
        let is_solved = residual.below(StaticBalance::<F>::RESIDUAL_TOL);
        let found = found & on_flanks & is_solved;
        Self {
            by_nut: balance.by_nut,
            unknowns,
            sides,
            steps,
            residual,
            is_first_root: found,
            unique,
        }
    }

    /// Returns half the difference between the contact angles at screw and nut \[rad\].
    #[inline(always)]
    pub fn tilt(&self) -> F {
        let [a, b] = &self.sides;
        // tan 2ν = sin(β_B − β_A)/cos(β_B − β_A)
        let sin = b.sin * a.cos - b.cos * a.sin;
        let cos = a.cos * b.cos + a.sin * b.sin;
        sin.atan2(cos) * 0.5
    }
}

/// Motion of a rolling ball relative to the nut, divided by `$W$`.
#[derive(Debug, Clone, Copy)]
pub struct RollingMotion<F> {
    /// Precession rate `$p$` relative to the nut.
    pub p: F,
    /// Angular velocity relative to the nut in the Frenet-Serret triad `$(t, n, b)$`.
    pub omega: [F; 3],
    /// Speeds of the ball center relative to the nut and the screw, divided by `$r_b$`. These
    /// speeds equal the negative angular velocities about `$t \times N$`.
    pub speed: [F; 2],
    /// Spins about the contact normals relative to the nut and the screw.
    pub spin: [F; 2],
}

impl<F: Real> RollingMotion<F> {
    /// Calculates the motion of a rolling ball (W3) to (W6).
    ///
    /// * `by_nut`: true if the nut is the controlling raceway.
    /// * `[a, b]`: contacts at the nut and the screw.
    #[inline(always)]
    pub fn of(ball: &ScaledBall<F>, by_nut: F::Mask, [a, b]: &[LoadedContact<F>; 2]) -> Self {
        let &ScaledBall { lead, arc, .. } = ball;
        let (zero, one) = (arc.constant(0.0), arc.constant(1.0));
        let (p, omega) = rolling(by_nut, lead, arc, [(a.sin, a.cos), (b.sin, b.cos)]);
        let to_screw = relative_rotation(omega, one, lead);
        let nut_spin = spin_at_nut(omega, (a.sin, a.cos));
        let screw_spin = -spin_at_nut(to_screw, (b.sin, b.cos));
        Self {
            p,
            omega,
            speed: [p * arc, (p - 1.0) * arc],
            spin: [F::select(by_nut, zero, nut_spin), F::select(by_nut, screw_spin, zero)],
        }
    }

    /// Returns the skid number (W9) and the cross slip (W10). Without friction, the skid number is
    /// not finite; without spin, the cross slip is not finite.
    ///
    /// * `friction`: friction coefficient.
    /// * `[a, b]`: contacts at the nut and the screw.
    #[inline(always)]
    pub fn skid_numbers(
        &self,
        ball: &ScaledBall<F>,
        friction: F,
        [a, b]: &[LoadedContact<F>; 2],
    ) -> [F; 2] {
        let rate = self.p + ball.nut_speed;
        let gyroscopic = ball.ball().inertia() * (rate * self.omega[1]).abs();
        let load = F::select(a.load.lt(b.load), a.load, b.load);
        // G = I |P ω_n| / (f Q r_b)                                       (W9)
        let skid_number = gyroscopic / (friction * load);
        let at_nut = self.spin[0].abs() * a.semi_axes(ball.semi_axes[0]).0;
        let at_screw = self.spin[1].abs() * b.semi_axes(ball.semi_axes[1]).0;
        // χ = r_b W sinα / (2 |ω_spin| a)                                 (W10)
        let cross_slip = ball.lead.0 * 0.5 / at_nut.larger(at_screw);
        [skid_number, cross_slip]
    }
}
