//! Search for the first steady motion on the equilibrium curve (the states in which all forces on
//! the ball balance), for a single operating point.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S12), (S26).

use std::array::from_fn;

use bsm_kin::Jet;
use bsm_newton::{EventRoot, JacobianUpdate, PathEnd, Seed, StepControl, Trace, trace};

use super::forces::CURVE_UNKNOWNS;
use super::states::{SlidingBall, SlidingPoint};
use super::steady::{CurveState, LOG_NO_INERTIA, STRAIGHTNESS_TOL};
use crate::cost::{count_of, count_search};
use crate::models::ball::{BALL_UNKNOWNS, ElasticContacts, Evidence, Reason, SolveFailure};

/// Step control along the equilibrium curve. Step lengths are relative to the scales of the
/// unknowns. Following a curve usually takes about thirty steps. Roots are refined afterwards by
/// Newton's method.
const STEP_CONTROL: StepControl = StepControl {
    first_step: 1.0,
    max_step: 1.0,
    min_step: 1e-4,
    pair_resolution: 1e-4,
    max_points: 4000,
    residual_goal: 1e-8,
    root_tolerance: 0.05,
    jacobian: JacobianUpdate::EveryStep,
};

/// Step control for a continuation whose roots are not refined by Newton's method. The roots are
/// accurate to rounding errors.
const EXACT_STEP_CONTROL: StepControl =
    StepControl { residual_goal: 1e-15, root_tolerance: 1e-14, ..STEP_CONTROL };

/// Maximum distance between a root found by continuation and the same root after refinement by
/// Newton's method, in units of the scales of the unknowns. The limit is twice the root tolerance
/// of [`STEP_CONTROL`].
const MAX_REFINEMENT_DISTANCE: f64 = 0.1;

/// A steady motion on the equilibrium curve, and the sign of its precession rate `$P/W$`.
type CurveRoot = (SlidingPoint<f64>, f64);

/// Returns the unknowns at the first root on the equilibrium curve, and the number of Newton steps.
///
/// * `any`: true if any root is acceptable because it only serves as a starting value.
///
/// # Errors
///
/// Returns [`SolveFailure`] if no root exists or if the search fails.
pub(super) fn root(
    contacts: &ElasticContacts,
    any: bool,
) -> Result<([f64; BALL_UNKNOWNS], usize), SolveFailure> {
    // First, Newton's method is started from the beginning of the equilibrium curve.
    let ball = SlidingBall::from(contacts);
    let direct = ball.direct_root(contacts.contact_angle.tan().recip(), true, any);
    let mut steps = count_of(direct.steps);
    if direct.is_first_root || (any && direct.steady) {
        return Ok((ball.unknowns(&direct.at, direct.rate.signum()), steps));
    }

    // If Newton's method fails, the root is found by continuation along the equilibrium curve.
    let (root, sign) = SlidingCurve::of(contacts, &mut steps)?.root()?;
    Ok((ball.unknowns(&root, sign), steps))
}

/// The equilibrium curve of an operating point, on which a root is sought.
struct SlidingCurve<'a> {
    ball: SlidingBall<f64>,
    /// Beginning of the equilibrium curve, where inertia is zero.
    start: CurveState<f64>,
    /// Counter of Newton steps.
    steps: &'a mut usize,
}

impl<'a> SlidingCurve<'a> {
    /// Finds the first root by continuation along the equilibrium curve.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root exists or if the search fails.
    fn root(&mut self) -> Result<CurveRoot, SolveFailure> {
        // Newton's method refines the roots that a coarse continuation finds. If the refinement
        // converges to a different root, the continuation is repeated with accurate step control.
        let found = self.trace(&STEP_CONTROL).or_else(|| self.trace(&EXACT_STEP_CONTROL));
        found.unwrap_or(Err(SolveFailure::SEARCH_FAILED))
    }

    /// Returns the state of the ball (forces and motion) at a point of the equilibrium curve.
    fn state_at(&self, z: &[f64; CURVE_UNKNOWNS]) -> Option<SlidingPoint<f64>> {
        let (state, _) = self.ball.state_at(z)?;
        Some(SlidingPoint { state, motion: self.ball.motion(&state) })
    }

    /// Adds `steps` to the counter of Newton steps.
    fn count(&mut self, steps: f64) {
        *self.steps += count_of(steps);
    }

    /// Creates the equilibrium curve of an operating point.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the screw is self-locking, if the inertia is out of range, or if
    /// the beginning of the curve is not found.
    fn of(contacts: &ElasticContacts, steps: &'a mut usize) -> Result<Self, SolveFailure> {
        let ball = SlidingBall::from(contacts);
        let friction_term = ball.friction / ball.cot;
        if !ball.can_carry_load() {
            let locks = Reason::SelfLocking { sin_contact_angle: 1.0, friction_term };
            return Err(SolveFailure::no_solution(Evidence::Proof, locks));
        }
        let beginning =
            ball.beginning(contacts.contact_angle, steps).ok_or(SolveFailure::SEARCH_FAILED)?;
        let start = ball.state_without_inertia(beginning, true);
        let mut curve = Self { ball, start, steps };
        curve.count(start.steps);
        if !start.converged {
            return Err(SolveFailure::SEARCH_FAILED);
        }
        if curve.rise() < 0.0 {
            let reason = Reason::InertiaOutOfRange { inertia_ratio: ball.inertia_ratio };
            return Err(SolveFailure::invalid(reason));
        }
        Ok(curve)
    }

    /// Returns the distance in `$\ln q$` between the beginning of the equilibrium curve and the
    /// root, under the assumption that the curve is straight.
    fn rise(&self) -> f64 {
        self.ball.inertia_ratio.ln() - self.start.at.log_inertia()
    }

    /// Follows the whole equilibrium curve and returns the first root, or the reason why there is
    /// no root. Returns `None` if a root cannot be refined.
    fn trace(&mut self, control: &StepControl) -> Option<Result<CurveRoot, SolveFailure>> {
        count_search();
        let inertia = self.ball.inertia_ratio;
        let start = self.start;
        // `seen` contains the smallest and the largest inertia ratio at which the ball is on its
        // flanks and its slip is opposite to friction.
        let mut seen = None::<(f64, f64)>;
        if start.at.is_admissible() {
            seen = Some((0.0, start.at.log_inertia().exp()));
        }
        let CurveState { point: [log, screw, c], at, .. } = self.below();
        let seed =
            Seed { z: [log, at.state.slip_cotangents[0], screw, c], towards: [1.0, 0.0, 0.0, 0.0] };
        let (mut root, mut known, mut admissible, mut refined) = (None, 0, false, true);
        let Trace { end, steps, .. } = trace(
            &self.ball,
            &seed,
            |z, way| self.events(z, way),
            |Trace { crossings, last: z, .. }| {
                for at in &crossings[known..] {
                    let node = if control.residual_goal > EXACT_STEP_CONTROL.residual_goal {
                        let node = self.refined(at);
                        refined &= node.is_some();
                        node
                    } else {
                        self.state_at(&at.z)
                    };
                    let admissible = node.filter(SlidingPoint::is_admissible);
                    root = root.or(admissible.map(|node| (node, sign(at))));
                }
                known = crossings.len();
                let node = self.state_at(z);
                admissible = node.is_some_and(|node| node.is_admissible());
                if let Some(node) = node.filter(SlidingPoint::is_admissible) {
                    let inertia = node.log_inertia().exp();
                    let (least, most) = seen.unwrap_or((inertia, inertia));
                    seen = Some((least.min(inertia), most.max(inertia)));
                }
                // The continuation ends at the limits of x_A and x_B, beyond which friction would
                // act in the direction of the slip.
                let [log, nut, screw, _] = *z;
                root.is_none()
                    && refined
                    && log >= LOG_NO_INERTIA
                    && screw >= 0.0
                    && nut >= -self.ball.sin / self.ball.arc
            },
            control,
        );
        *self.steps += steps;
        if !refined {
            return None;
        }
        if let Some(root) = root {
            return Some(Ok(root));
        }
        if end != PathEnd::Ended && (end != PathEnd::Lost || admissible) {
            return Some(Err(SolveFailure::SEARCH_FAILED));
        }
        let reason = match seen {
            Some((min, max)) => Reason::NoSkidAtInertia { inertia_ratio: inertia, min, max },
            None => Reason::SlipAlongFriction { slip: start.at.motion.slip[0] },
        };
        let evidence = Evidence::Traced { resolution: STEP_CONTROL.pair_resolution };
        Some(Err(SolveFailure::no_solution(evidence, reason)))
    }

    /// Returns the residuals of (S26) for `$P/W > 0$` and for `$P/W < 0$`, each with its derivative
    /// along the equilibrium curve.
    fn events(&self, z: &[f64; CURVE_UNKNOWNS], way: &[f64; CURVE_UNKNOWNS]) -> [(f64, f64); 2] {
        let along: [Jet<1>; CURVE_UNKNOWNS] = from_fn(|i| Jet { re: z[i], eps: [way[i]] });
        self.ball.state_at(&along).map_or([(f64::NAN, f64::NAN); 2], |(state, _)| {
            let point = SlidingPoint { state, motion: self.ball.motion(&state) };
            let residual = self.ball.inertia_residuals(&point);
            residual.map(|residual| (residual.re, residual.eps[0]))
        })
    }

    /// Returns the steady motion near a zero crossing of (S26), accurate to rounding errors.
    /// Returns `None` if Newton's method converges to a different motion.
    fn refined(&self, at: &EventRoot<CURVE_UNKNOWNS>) -> Option<SlidingPoint<f64>> {
        let (ball, [log, nut, screw, c]) = (&self.ball, at.z);
        let scale = ball.scale([nut, screw], c);
        let refined = ball.iterate::<true>([log, screw, c], &scale, true);
        let [next_log, next_screw, next_c] = refined.point;
        let moved = [
            next_log - log,
            (refined.at.state.slip_cotangents[0] - nut) / scale[0],
            (next_screw - screw) / scale[1],
            (next_c - c) / scale[2],
        ];
        let motion = refined.at.motion;
        let same = (motion.inertia * motion.drive > 0.0) == (sign(at) > 0.0);
        let near = moved.iter().all(|moved| moved.abs() < MAX_REFINEMENT_DISTANCE);
        (refined.converged && near && same).then_some(refined.at)
    }

    /// Returns a state on the straight part of the equilibrium curve that has less inertia than the
    /// first root.
    fn below(&mut self) -> CurveState<f64> {
        let (ball, start) = (self.ball, self.start);
        let [log, screw, c] = start.point;
        let scale = start.scale(&ball);
        // The search starts at about one seventh (exp(−2)) of the inertia at which a straight curve
        // would reach the root.
        let mut rise = self.rise().min(-LOG_NO_INERTIA) - 2.0;
        while rise > 0.0 {
            // The inertia ratio at a root contains the factor (`inertia / drive`)². On the straight
            // part of the curve, this factor changes by a factor of less than seven.
            let state = ball.iterate::<false>([log + rise, screw, c], &scale, true);
            self.count(state.steps);
            if state.converged && state.is_straight_from(&start, &scale, STRAIGHTNESS_TOL) {
                return state;
            }
            rise -= 3.0;
        }
        start
    }
}

/// Returns the sign of `$P/W$` at a zero crossing of (S26).
fn sign(at: &EventRoot<CURVE_UNKNOWNS>) -> f64 {
    if at.event == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_newton::Bracket;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::extreme::{random_extreme_screw, random_practical_screw};

    #[test]
    fn root_from_direct_newton_iteration_is_the_first_root_that_continuation_finds() {
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        let (mut of_practice, mut of_extremes) = (0, 0);
        for number in 0..2000 {
            let (screw, found) = if number % 2 == 0 {
                (random_practical_screw(&mut rng), &mut of_practice)
            } else {
                (random_extreme_screw(&mut rng), &mut of_extremes)
            };
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let Ok(mut curve) = SlidingCurve::of(&contacts, &mut steps) else { continue };
            let direct = curve.ball.direct_root(contacts.contact_angle.tan().recip(), true, false);
            if !direct.is_first_root {
                continue;
            }
            let (direct, sign) = (direct.at, direct.rate.signum());
            let (first, same) =
                curve.trace(&EXACT_STEP_CONTROL).expect("a result").expect("a root");
            // If friction nearly holds the load, the normal load is a million times the axial load,
            // and only ten digits remain accurate. A different root would differ by several
            // percent.
            let close = |x: f64, y: f64| assert_relative_eq!(x, y, max_relative = 1e-6);
            close(direct.state.centrifugal, first.state.centrifugal);
            close(direct.state.slip_cotangents[1], first.state.slip_cotangents[1]);
            close(sign, same);
            *found += 1;
        }
        // Newton's method directly solves nearly all of the 1000 practical points. Of the 1000
        // extreme points, it solves the points with low speeds.
        assert!(of_practice > 900 && of_extremes > 300, "{of_practice} {of_extremes}");
    }

    #[test]
    fn refined_root_of_coarse_continuation_agrees_with_exact_continuation() {
        let mut rng = ChaCha8Rng::seed_from_u64(15);
        let (mut of_practice, mut of_extremes, mut fewer) = (0, 0, 0);
        for number in 0..2000 {
            let (screw, found) = if number % 2 == 0 {
                (random_practical_screw(&mut rng), &mut of_practice)
            } else {
                (random_extreme_screw(&mut rng), &mut of_extremes)
            };
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let Ok(mut curve) = SlidingCurve::of(&contacts, &mut steps) else { continue };
            let begun = *curve.steps;
            let coarse = curve.root();
            let in_all = *curve.steps - begun;
            let exact =
                curve.trace(&EXACT_STEP_CONTROL).unwrap_or(Err(SolveFailure::SEARCH_FAILED));
            fewer += usize::from(in_all < *curve.steps - begun - in_all);
            match (coarse, exact) {
                (Ok((one, sign)), Ok((other, same))) => {
                    // The tolerance allows for the loss of digits at points at which friction
                    // nearly holds the load. A different root would differ by several percent.
                    let close = |x: f64, y: f64| assert_relative_eq!(x, y, max_relative = 1e-6);
                    close(one.state.centrifugal, other.state.centrifugal);
                    close(one.state.slip_cotangents[1], other.state.slip_cotangents[1]);
                    close(sign, same);
                    *found += 1;
                }
                (one, other) => {
                    assert_eq!(one.is_err(), other.is_err(), "{one:?} {other:?} {screw:?}");
                }
            }
        }
        assert!(of_practice > 900 && of_extremes > 300, "{of_practice} {of_extremes}");
        assert!(fewer > 1000, "{fewer}");
    }

    /// In an earlier version, the search for the beginning of the curve did not end if the
    /// cotangent of the contact angle overflowed.
    #[test]
    fn number_of_iterations_to_the_start_of_the_equilibrium_curve_is_bounded() {
        let mut rng = ChaCha8Rng::seed_from_u64(14);
        for number in 0..1000 {
            let mut screw = random_extreme_screw(&mut rng);
            if let Some(angle) = [5e-324, 1.7e-309, 1e-150, 1e-17].get(number % 8) {
                screw.point.contact_angle = *angle;
            }
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let _ = SlidingCurve::of(&contacts, &mut steps);
            // The limit is the maximum number of function evaluations in the bracket plus the
            // maximum number of Newton steps from the bracketed state to the equilibrium curve.
            assert!(steps <= Bracket::MAX_EVALUATIONS + 12, "{steps} {screw:?}");
        }
    }
}
