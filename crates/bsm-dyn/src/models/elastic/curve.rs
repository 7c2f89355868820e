//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S12), (S26).

use std::array::from_fn;

use bsm_kin::Jet;
use bsm_newton::{EventRoot, Exit, JacobianUpdate, Seed, StepControl, Trace, trace};

use super::forces::CURVE;
use super::states::{SlidingBall, SlidingMotion, SlidingState};
use super::steady::{CurveState, log_inertia};
use crate::models::ball::{BALL, ElasticContacts, Evidence, Reason, Unsolved};
use crate::models::elastic::Elastic;

/// Steps along the curve, in units of its sizes; thirty are usual. Newton's method refines the root.
const STEP_CONTROL: StepControl = StepControl {
    first: 1.0,
    longest: 1.0,
    shortest: 1e-4,
    pair_resolution: 1e-4,
    most_points: 4000,
    goal: 1e-8,
    root_tolerance: 0.05,
    jacobian: JacobianUpdate::EveryStep,
};

/// The same to rounding, for a root that Newton's method does not refine.
const EXACT: StepControl = StepControl { goal: 1e-15, root_tolerance: 1e-14, ..STEP_CONTROL };

/// A root is refined by less than this, in the sizes of a step: twice as much as a crossing is known to.
const REFINED: f64 = 0.1;

/// A point of the curve.
#[derive(Debug, Clone, Copy)]
struct SlidingPoint {
    state: SlidingState<f64>,
    motion: SlidingMotion<f64>,
}

impl SlidingPoint {
    /// True if the ball slides against friction on its flanks.
    fn is_admissible(&self) -> bool {
        self.state.is_admissible(&self.motion)
    }
}

/// A steady motion on the curve: its state, and the sign of `$P/W$`.
type CurveRoot = (SlidingPoint, f64);

/// Unknowns of the first root on the curve, or of any that serves as a start, and Newton steps.
pub(super) fn root(
    contacts: &ElasticContacts,
    any: bool,
) -> Result<([f64; BALL], usize), Unsolved> {
    let mut curve = SlidingCurve { ball: contacts.into(), steps: 0 };
    let start = curve.begin(contacts.jones.contact_angle)?;
    let (root, sign) = match curve.straight_root(&start, any) {
        Some(root) => root,
        None => curve.search(&start, &STEP_CONTROL)?,
    };
    Ok((curve.ball.unknowns(&root.state, &root.motion, sign), curve.steps))
}

struct SlidingCurve {
    ball: SlidingBall<f64>,
    /// Newton steps.
    steps: usize,
}

impl SlidingCurve {
    /// The node at a point of the curve.
    fn state_at(&self, z: &[f64; CURVE]) -> Option<SlidingPoint> {
        let (state, _) = self.ball.state_at(z)?;
        Some(SlidingPoint { state, motion: self.ball.motion(&state) })
    }

    fn count(&mut self, steps: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
        let steps = steps as usize;
        self.steps += steps;
    }

    /// Where the curve begins, without inertia, if it does.
    ///
    /// * `unloaded`: contact angle \[rad\].
    fn begin(&mut self, unloaded: f64) -> Result<CurveState<f64>, Unsolved> {
        let friction_term = self.ball.friction / self.ball.cot;
        if !self.ball.carries() {
            let locks = Reason::SelfLocking { sin_contact_angle: 1.0, friction_term };
            return Err(Unsolved::none(Evidence::Proof, locks));
        }
        let begin = self.ball.begin(unloaded, &mut self.steps).ok_or(Unsolved::LOST)?;
        let start = self.ball.state_without_inertia(begin, true);
        self.count(start.steps);
        if !start.found {
            return Err(Unsolved::LOST);
        }
        if self.rise(&start) < 0.0 {
            let reason = Reason::InertiaOutOfRange { inertia_ratio: self.ball.inertia_ratio };
            return Err(Unsolved::invalid(reason));
        }
        Ok(start)
    }

    /// From where the curve begins to the root, if the curve were straight up to it, in `$\ln q$`.
    fn rise(&self, start: &CurveState<f64>) -> f64 {
        self.ball.inertia_ratio.ln() - start.log_inertia()
    }

    /// The root that Newton finds from where the curve begins: the first one, if the inertia only rises up to there, or any.
    fn straight_root(&mut self, start: &CurveState<f64>, any: bool) -> Option<CurveRoot> {
        let root = self.ball.first(start, any);
        self.count(root.steps - start.steps);
        let node = SlidingPoint { state: root.state, motion: root.motion };
        (if any { root.steady } else { root.found }).then_some((node, root.rate.signum()))
    }

    /// The first root along the whole curve, or why there is none.
    fn search(
        &mut self,
        start: &CurveState<f64>,
        control: &StepControl,
    ) -> Result<CurveRoot, Unsolved> {
        let inertia = self.ball.inertia_ratio;
        let slip = start.motion.slip[0];
        // Smallest and largest inertia ratio of a ball that slides against friction on its flanks.
        let mut seen = None::<(f64, f64)>;
        if start.is_admissible() {
            seen = Some((0.0, start.log_inertia().exp()));
        }
        let CurveState { point: [log, screw, c], state, .. } = self.below(start);
        let seed =
            Seed { z: [log, state.slip_cotangents[0], screw, c], towards: [1.0, 0.0, 0.0, 0.0] };
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
                    let inertia = log_inertia(&node.state, &node.motion).exp();
                    let (least, most) = seen.unwrap_or((inertia, inertia));
                    seen = Some((least.min(inertia), most.max(inertia)));
                }
                // Beyond, friction is along the slip.
                let [log, nut, screw, _] = *z;
                root.is_none()
                    && refined
                    && log >= Elastic::NO_INERTIA
                    && screw >= 0.0
                    && nut >= -self.ball.sin / self.ball.arc
            },
            control,
        );
        self.steps += steps;
        if !refined {
            return self.search(start, &EXACT);
        }
        if let Some(root) = root {
            return Ok(root);
        }
        if end != Exit::Ended && (end != Exit::Lost || admissible) {
            return Err(Unsolved::LOST);
        }
        let reason = match seen {
            Some((least, most)) => Reason::NoSkidAtInertia { inertia, least, most },
            None => Reason::SlipAlongFriction { slip },
        };
        Err(Unsolved::none(Evidence::Traced { resolution: STEP_CONTROL.pair_resolution }, reason))
    }

    /// Residual of (S26) for `$P/W > 0$` and for `$P/W < 0$`, and how it changes along the curve.
    fn events(&self, z: &[f64; CURVE], way: &[f64; CURVE]) -> [(f64, f64); 2] {
        let along: [Jet<1>; CURVE] = from_fn(|i| Jet { re: z[i], eps: [way[i]] });
        self.ball.state_at(&along).map_or([(f64::NAN, f64::NAN); 2], |(state, _)| {
            let residual = self.ball.inertia_residuals(&state, &self.ball.motion(&state));
            residual.map(|residual| (residual.re, residual.eps[0]))
        })
    }

    /// The steady motion next to a crossing, to rounding.
    fn refined(&self, at: &EventRoot<CURVE>) -> Option<SlidingPoint> {
        let (ball, [log, nut, screw, c]) = (&self.ball, at.z);
        let scale = ball.scale([nut, screw], c);
        let found = ball.iterate::<true>([log, screw, c], &scale, true);
        let [next_log, next_screw, next_c] = found.point;
        let moved = [
            next_log - log,
            (found.state.slip_cotangents[0] - nut) / scale[0],
            (next_screw - screw) / scale[1],
            (next_c - c) / scale[2],
        ];
        let motion = found.motion;
        let same = (motion.inertia * motion.drive > 0.0) == (sign(at) > 0.0);
        let near = moved.iter().all(|moved| moved.abs() < REFINED);
        (found.found && near && same).then_some(SlidingPoint { state: found.state, motion })
    }

    /// A state below the first root: up to there the curve is straight.
    fn below(&mut self, start: &CurveState<f64>) -> CurveState<f64> {
        let (ball, [log, screw, c]) = (self.ball, start.point);
        let scale = start.scale(&ball);
        // exp(−2): a seventh of the inertia.
        let mut rise = self.rise(start).min(-Elastic::NO_INERTIA) - 2.0;
        while rise > 0.0 {
            // The inertia of a root moves by twice the change of the factors, not by a factor of seven.
            let state = ball.iterate::<false>([log + rise, screw, c], &scale, true);
            self.count(state.steps);
            if state.found && state.is_straight_from(start, &scale, Elastic::RISES) {
                return state;
            }
            rise -= 3.0;
        }
        *start
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
            let mut curve = SlidingCurve { ball: (&contacts).into(), steps: 0 };
            let Ok(start) = curve.begin(contacts.jones.contact_angle) else { continue };
            let Some((straight, sign)) = curve.straight_root(&start, false) else { continue };
            let (first, same) = curve.search(&start, &EXACT).expect("a root");
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

    /// Newton on the root of a coarse walk ends where the walk to rounding does.
    #[test]
    fn the_root_of_a_coarse_walk_is_that_of_an_exact_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(15);
        let (mut of_practice, mut of_extremes, mut fewer) = (0, 0, 0);
        for number in 0..2000 {
            let (screw, found) = if number % 2 == 0 {
                (practical(&mut rng), &mut of_practice)
            } else {
                (extreme(&mut rng), &mut of_extremes)
            };
            let Ok(contacts) = screw.scaled() else { continue };
            let mut curve = SlidingCurve { ball: (&contacts).into(), steps: 0 };
            let Ok(start) = curve.begin(contacts.jones.contact_angle) else { continue };
            let begun = curve.steps;
            let coarse = curve.search(&start, &STEP_CONTROL);
            let in_all = curve.steps - begun;
            let exact = curve.search(&start, &EXACT);
            fewer += usize::from(in_all < curve.steps - begun - in_all);
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
            let mut curve = SlidingCurve { ball: (&contacts).into(), steps: 0 };
            let _ = curve.begin(contacts.jones.contact_angle);
            // Those to the angle, and those onto the curve.
            assert!(curve.steps <= Bracket::MOST_EVALUATIONS + 12, "{} {screw:?}", curve.steps);
        }
    }
}
