//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S12), (S26).

use std::array::from_fn;

use bsm_kin::Jet;
use bsm_newton::{EventRoot, JacobianUpdate, PathEnd, Seed, StepControl, Trace, trace};

use super::forces::CURVE;
use super::states::{SlidingBall, SlidingPoint};
use super::steady::{CurveState, NO_INERTIA, RISES};
use crate::cost::{count_of, searched};
use crate::models::ball::{BALL, ElasticContacts, Evidence, NoAnswer, Reason};

/// Steps along the curve, in units of its sizes; thirty are usual. Newton's method refines the root.
const STEP_CONTROL: StepControl = StepControl {
    first: 1.0,
    longest: 1.0,
    shortest: 1e-4,
    pair_resolution: 1e-4,
    max_points: 4000,
    goal: 1e-8,
    root_tolerance: 0.05,
    jacobian: JacobianUpdate::EveryStep,
};

/// Steps along the curve with roots to rounding, for a root that Newton's method does not refine.
const EXACT: StepControl = StepControl { goal: 1e-15, root_tolerance: 1e-14, ..STEP_CONTROL };

/// Maximum distance by which Newton's method refines a root, in the sizes of a step: twice the tolerance of a crossing.
const MAX_REFINEMENT: f64 = 0.1;

/// A steady motion on the curve: its state, and the sign of `$P/W$`.
type CurveRoot = (SlidingPoint<f64>, f64);

/// Returns the unknowns of the first root on the curve, or of any root that serves as a start, and the number of Newton
/// steps.
pub(super) fn root(
    contacts: &ElasticContacts,
    any: bool,
) -> Result<([f64; BALL], usize), NoAnswer> {
    let mut steps = 0;
    let mut curve = SlidingCurve::of(contacts, any, &mut steps)?;
    let (root, sign) = curve.root()?;
    Ok((curve.ball.unknowns(&root, sign), steps))
}

/// The curve of all states of force of a point, on which a root is looked for.
struct SlidingCurve<'a> {
    ball: SlidingBall<f64>,
    /// Where it begins, without inertia.
    start: CurveState<f64>,
    /// Any root is enough.
    any: bool,
    /// Newton steps.
    steps: &'a mut usize,
}

impl<'a> SlidingCurve<'a> {
    /// Finds the first root on the curve, or any that serves as a start, or the reason why there is none.
    fn root(&mut self) -> Result<CurveRoot, NoAnswer> {
        // Direct: Newton's method from where the curve begins.
        if let Some(root) = self.straight_root() {
            return Ok(root);
        }
        self.traced()
    }

    /// Finds the first root by continuation along the curve, or the reason why there is none.
    fn traced(&mut self) -> Result<CurveRoot, NoAnswer> {
        // Newton's method refines the roots of a coarse continuation, unless that leads elsewhere.
        let found = self.trace(&STEP_CONTROL).or_else(|| self.trace(&EXACT));
        found.unwrap_or(Err(NoAnswer::LOST))
    }

    /// The node at a point of the curve.
    fn state_at(&self, z: &[f64; CURVE]) -> Option<SlidingPoint<f64>> {
        let (state, _) = self.ball.state_at(z)?;
        Some(SlidingPoint { state, motion: self.ball.motion(&state) })
    }

    fn count(&mut self, steps: f64) {
        *self.steps += count_of(steps);
    }

    /// The curve, if it begins.
    fn of(contacts: &ElasticContacts, any: bool, steps: &'a mut usize) -> Result<Self, NoAnswer> {
        let ball = SlidingBall::from(contacts);
        let friction_term = ball.friction / ball.cot;
        if !ball.carries() {
            let locks = Reason::SelfLocking { sin_contact_angle: 1.0, friction_term };
            return Err(NoAnswer::none(Evidence::Proof, locks));
        }
        let begin = ball.begin(contacts.contact_angle, steps).ok_or(NoAnswer::LOST)?;
        let start = ball.state_without_inertia(begin, true);
        let mut curve = Self { ball, start, any, steps };
        curve.count(start.steps);
        if !start.found {
            return Err(NoAnswer::LOST);
        }
        if curve.rise() < 0.0 {
            let reason = Reason::InertiaOutOfRange { inertia_ratio: ball.inertia_ratio };
            return Err(NoAnswer::invalid(reason));
        }
        Ok(curve)
    }

    /// From where the curve begins to the root, if the curve were straight up to it, in `$\ln q$`.
    fn rise(&self) -> f64 {
        self.ball.inertia_ratio.ln() - self.start.at.log_inertia()
    }

    /// Returns the root that Newton's method finds from where the curve begins if it is the first one because the inertia only
    /// rises up to there, or if any root will do.
    fn straight_root(&mut self) -> Option<CurveRoot> {
        let root = self.ball.first(&self.start, self.any);
        self.count(root.steps - self.start.steps);
        let is_root = if self.any { root.steady } else { root.found };
        is_root.then_some((root.at, root.rate.signum()))
    }

    /// Returns the first root along the whole curve, or why there is none; `None` if a root cannot be refined.
    fn trace(&mut self, control: &StepControl) -> Option<Result<CurveRoot, NoAnswer>> {
        searched();
        let inertia = self.ball.inertia_ratio;
        let start = self.start;
        // Smallest and largest inertia ratio of a ball that slides against friction on its flanks.
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
                    let node = if control.goal > EXACT.goal {
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
                // Beyond, friction is along the slip.
                let [log, nut, screw, _] = *z;
                root.is_none()
                    && refined
                    && log >= NO_INERTIA
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
            return Some(Err(NoAnswer::LOST));
        }
        let reason = match seen {
            Some((least, most)) => Reason::NoSkidAtInertia { inertia, least, most },
            None => Reason::SlipAlongFriction { slip: start.at.motion.slip[0] },
        };
        let evidence = Evidence::Traced { resolution: STEP_CONTROL.pair_resolution };
        Some(Err(NoAnswer::none(evidence, reason)))
    }

    /// Residual of (S26) for `$P/W > 0$` and for `$P/W < 0$`, and how it changes along the curve.
    fn events(&self, z: &[f64; CURVE], way: &[f64; CURVE]) -> [(f64, f64); 2] {
        let along: [Jet<1>; CURVE] = from_fn(|i| Jet { re: z[i], eps: [way[i]] });
        self.ball.state_at(&along).map_or([(f64::NAN, f64::NAN); 2], |(state, _)| {
            let point = SlidingPoint { state, motion: self.ball.motion(&state) };
            let residual = self.ball.inertia_residuals(&point);
            residual.map(|residual| (residual.re, residual.eps[0]))
        })
    }

    /// The steady motion next to a crossing, to rounding.
    fn refined(&self, at: &EventRoot<CURVE>) -> Option<SlidingPoint<f64>> {
        let (ball, [log, nut, screw, c]) = (&self.ball, at.z);
        let scale = ball.scale([nut, screw], c);
        let found = ball.iterate::<true>([log, screw, c], &scale, true);
        let [next_log, next_screw, next_c] = found.point;
        let moved = [
            next_log - log,
            (found.at.state.slip_cotangents[0] - nut) / scale[0],
            (next_screw - screw) / scale[1],
            (next_c - c) / scale[2],
        ];
        let motion = found.at.motion;
        let same = (motion.inertia * motion.drive > 0.0) == (sign(at) > 0.0);
        let near = moved.iter().all(|moved| moved.abs() < MAX_REFINEMENT);
        (found.found && near && same).then_some(found.at)
    }

    /// A state below the first root: up to there the curve is straight.
    fn below(&mut self) -> CurveState<f64> {
        let (ball, start) = (self.ball, self.start);
        let [log, screw, c] = start.point;
        let scale = start.scale(&ball);
        // exp(−2): a seventh of the inertia.
        let mut rise = self.rise().min(-NO_INERTIA) - 2.0;
        while rise > 0.0 {
            // The inertia of a root moves by twice the change of the factors, not by a factor of seven.
            let state = ball.iterate::<false>([log + rise, screw, c], &scale, true);
            self.count(state.steps);
            if state.found && state.is_straight_from(&start, &scale, RISES) {
                return state;
            }
            rise -= 3.0;
        }
        start
    }
}

/// Sign of `$P/W$` at a crossing.
fn sign(at: &EventRoot<CURVE>) -> f64 {
    if at.event == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_newton::Bracket;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::extreme::{extreme, practical};

    /// Newton where the curve is straight goes to the root that the search along the curve meets first.
    #[test]
    fn the_straight_begin_has_the_first_root() {
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        let (mut of_practice, mut of_extremes) = (0, 0);
        for number in 0..2000 {
            let (screw, found) = if number % 2 == 0 {
                (practical(&mut rng), &mut of_practice)
            } else {
                (extreme(&mut rng), &mut of_extremes)
            };
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let Ok(mut curve) = SlidingCurve::of(&contacts, false, &mut steps) else { continue };
            let Some((straight, sign)) = curve.straight_root() else { continue };
            let (first, same) = curve.trace(&EXACT).expect("an answer").expect("a root");
            // Where friction all but holds the load a million times the axial load is left, ten digits;
            // another root differs by per cent.
            let close = |x: f64, y: f64| assert_relative_eq!(x, y, max_relative = 1e-6);
            close(straight.state.centrifugal, first.state.centrifugal);
            close(straight.state.slip_cotangents[1], first.state.slip_cotangents[1]);
            close(sign, same);
            *found += 1;
        }
        // Of 1000 each; all but a few points of practice, and the slow ones of the extremes.
        assert!(of_practice > 900 && of_extremes > 300, "{of_practice} {of_extremes}");
    }

    /// Newton on the root of a coarse continuation ends where that to rounding does.
    #[test]
    fn the_root_of_a_coarse_trace_is_that_of_an_exact_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(15);
        let (mut of_practice, mut of_extremes, mut fewer) = (0, 0, 0);
        for number in 0..2000 {
            let (screw, found) = if number % 2 == 0 {
                (practical(&mut rng), &mut of_practice)
            } else {
                (extreme(&mut rng), &mut of_extremes)
            };
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let Ok(mut curve) = SlidingCurve::of(&contacts, false, &mut steps) else { continue };
            let begun = *curve.steps;
            let coarse = curve.traced();
            let in_all = *curve.steps - begun;
            let exact = curve.trace(&EXACT).unwrap_or(Err(NoAnswer::LOST));
            fewer += usize::from(in_all < *curve.steps - begun - in_all);
            match (coarse, exact) {
                (Ok((one, sign)), Ok((other, same))) => {
                    // As above.
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

    /// Found in an audit: the search for the begin did not end for an angle whose cotangent is not a number.
    #[test]
    fn the_begin_is_found_in_a_bounded_number_of_steps() {
        let mut rng = ChaCha8Rng::seed_from_u64(14);
        for number in 0..1000 {
            let mut screw = extreme(&mut rng);
            if let Some(angle) = [5e-324, 1.7e-309, 1e-150, 1e-17].get(number % 8) {
                screw.point.contact_angle = *angle;
            }
            let Ok(contacts) = screw.scaled() else { continue };
            let mut steps = 0;
            let _ = SlidingCurve::of(&contacts, false, &mut steps);
            // Those to the angle, and those onto the curve.
            assert!(steps <= Bracket::MAX_EVALUATIONS + 12, "{steps} {screw:?}");
        }
    }
}
