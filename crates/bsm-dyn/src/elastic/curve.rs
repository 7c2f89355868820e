//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S12), (S26).

use std::array::from_fn;

use bsm_kin::Jet;
use bsm_newton::{Crossing, End, Seed, Stride, Trace, trace};

use super::forces::{CURVE, Forces, Place};
use super::states::{SlidingMotion, SlidingState};
use crate::ball_unknowns::BALL;
use crate::elastic_ball::ElasticBall;
use crate::{Elastic, Evidence, Reason, Unsolved};

/// Steps along the curve, in units of [`Forces::scale`]; fifty are usual. Refined to rounding.
const STRIDE: Stride = Stride {
    first: 1.0,
    longest: 1.0,
    shortest: 1e-4,
    pair: 1e-4,
    most_points: 4000,
    goal: 1e-15,
    place: 1e-14,
};

/// Relative change of the factors of (S27) from where the curve begins, up to which a walk may begin; the
/// inertia has only risen up to [`Elastic::RISES`].
const BEGINS: f64 = 0.01;

/// A state on the curve.
#[derive(Debug, Clone, Copy)]
struct Node {
    z: [f64; CURVE],
    state: SlidingState<f64>,
    motion: SlidingMotion<f64>,
}

impl Node {
    fn place(&self) -> Place {
        let [log, _, screw, c] = self.z;
        Place::new(log, screw, c)
    }

    /// True if the centrifugal force is proportional to `$q$` from `level` to here, a `rise` of its
    /// logarithm, and nothing else in (S27) changes, nor the place but for `$q$`; to a relative
    /// `change`.
    fn is_straight_from(&self, level: &Self, rise: f64, change: f64, forces: &Forces<'_>) -> bool {
        // A place may be far from the begin and have the factors of the begin again.
        let scale = forces.scale(&level.z);
        let off = |i: usize| self.z[i] - level.z[i] - if i == 0 { rise } else { 0.0 };
        let (begin, factor) = ((&level.state, &level.motion), rise.exp());
        self.state.has_only_grown(&self.motion, begin, factor, change)
            && (0..CURVE).all(|i| off(i).abs() <= Elastic::LARGE * change * scale[i])
    }

    /// True if the ball slides against friction on its flanks.
    fn is_admissible(&self) -> bool {
        self.state.is_admissible(&self.motion)
    }
}

/// A steady motion on the curve: its state, and the sign of `$P/W$`.
type Root = (Node, f64);

/// Unknowns of the first root on the curve, or of any that serves as a start, and Newton steps.
pub(super) fn root(pair: &ElasticBall, any: bool) -> Result<([f64; BALL], usize), Unsolved> {
    let mut curve = Curve { forces: Forces::new(pair), steps: 0 };
    let begin = curve.begin()?;
    let near = if any { curve.steady(&begin) } else { curve.straight(&begin) };
    let (root, sign) = match near {
        Some(root) => root,
        None => curve.search(begin)?,
    };
    Ok((curve.forces.unknowns(&root.state, &root.motion, sign), curve.steps))
}

/// Where the curve begins.
struct Begin {
    /// The state without inertia.
    level: Node,
    /// `$\ln q$` of the root, if the curve were straight up to it.
    root: f64,
}

struct Curve<'a> {
    forces: Forces<'a>,
    /// Newton steps.
    steps: usize,
}

impl Curve<'_> {
    fn node(&mut self, guess: Place, scale: &Place) -> Option<Node> {
        let (place, state) = self.forces.closed(guess, scale, &mut self.steps)?;
        Some(self.at(place, state))
    }

    fn at(&self, place: Place, state: SlidingState<f64>) -> Node {
        let motion = self.forces.motion(&state);
        let [nut, screw] = state.across;
        Node { z: [place[0], nut, screw, place[2]], state, motion }
    }

    /// The node at a point of the curve.
    fn held(&self, z: &[f64; CURVE]) -> Option<Node> {
        let (state, _) = self.forces.held(z)?;
        Some(Node { z: *z, state, motion: self.forces.motion(&state) })
    }

    /// What is a large step from a state.
    fn scale(&self, node: &Node) -> Place {
        let [log, _, screw, c] = self.forces.scale(&node.z);
        Place::new(log, screw, c)
    }

    /// Where the curve begins, if it does.
    fn begin(&mut self) -> Result<Begin, Unsolved> {
        let friction_term = self.forces.friction_term();
        // F tanα < 1, or no contact angles carry an axial load            (S12)
        if friction_term >= 1.0 {
            let locks = Reason::SelfLocking { sin_contact_angle: 1.0, friction_term };
            return Err(Unsolved::none(Evidence::Proof, locks));
        }
        let inertia = self.forces.inertia_ratio();
        let level = self.level().ok_or(Unsolved::LOST)?;
        // M ~ q, up to where the curve bends. Where nut and screw turn together, the inertia here
        // underflows, its logarithm does not.
        let here = Forces::log_inertia(&level.state, &level.motion);
        let root = Elastic::NO_INERTIA + inertia.ln() - here;
        if root < Elastic::NO_INERTIA {
            let reason = Reason::InertiaOutOfRange { inertia_ratio: inertia };
            return Err(Unsolved::invalid(reason));
        }
        Ok(Begin { level, root })
    }

    /// The root that Newton finds from where the curve begins, if it slides against friction on its flanks.
    fn steady(&mut self, Begin { level, root }: &Begin) -> Option<Root> {
        let rise = UP * (root - Elastic::NO_INERTIA);
        let scale = self.scale(level);
        let (place, state) = self.forces.steady(level.place() + rise, &scale, &mut self.steps)?;
        let node = self.at(place, state);
        let sign = (level.motion.drive * level.motion.inertia).signum();
        node.is_admissible().then_some((node, sign))
    }

    /// The first root, if it is where the curve is straight: up to there the inertia (S27) has only
    /// risen, so that no other root is before it.
    fn straight(&mut self, begin: &Begin) -> Option<Root> {
        let (level, (node, sign)) = (&begin.level, self.steady(begin)?);
        let log = node.z[0];
        let is_first =
            node.is_straight_from(level, log - Elastic::NO_INERTIA, Elastic::RISES, &self.forces);
        // Where rounding decides, the search does its best.
        let left = self.forces.excess(&node.state, &node.motion)[usize::from(sign < 0.0)].abs();
        let is_exact = left <= digit(log) * node.motion.drive.abs();
        (is_first && is_exact).then_some((node, sign))
    }

    /// The first root along the whole curve, or why there is none.
    fn search(&mut self, Begin { level, root }: Begin) -> Result<Root, Unsolved> {
        let inertia = self.forces.inertia_ratio();
        let slip = level.motion.slip[0];
        // Smallest and largest inertia ratio of a ball that slides against friction on its flanks.
        let mut seen = None::<(f64, f64)>;
        if level.is_admissible() {
            seen = Some((0.0, Forces::log_inertia(&level.state, &level.motion).exp()));
        }
        let seed = Seed { z: self.below(level, root).z, towards: [1.0, 0.0, 0.0, 0.0] };
        let (mut root, mut known, mut admissible) = (None, 0, false);
        let Trace { end, steps, .. } = trace(
            &self.forces,
            &seed,
            |z, way| self.events(z, way),
            |Trace { crossings, last: z, .. }| {
                root = root.or_else(|| crossings[known..].iter().find_map(|at| self.root(at)));
                known = crossings.len();
                let node = self.held(z);
                admissible = node.is_some_and(|node| node.is_admissible());
                if let Some(node) = node.filter(Node::is_admissible) {
                    let inertia = Forces::log_inertia(&node.state, &node.motion).exp();
                    let (least, most) = seen.unwrap_or((inertia, inertia));
                    seen = Some((least.min(inertia), most.max(inertia)));
                }
                // Beyond, friction is along the slip.
                let [log, nut, screw, _] = *z;
                root.is_none()
                    && log >= Elastic::NO_INERTIA
                    && screw >= 0.0
                    && nut >= -self.forces.least()
            },
            &STRIDE,
        );
        self.steps += steps;
        if let Some(root) = root {
            return Ok(root);
        }
        match end {
            End::Stopped => {}
            End::Lost(_) if !admissible => {}
            End::Lost(_) | End::MostPoints | End::Closed | End::NoCurve(_) => {
                return Err(Unsolved::LOST);
            }
        }
        let reason = match seen {
            Some((least, most)) => Reason::NoSkidAtInertia { inertia, least, most },
            None => Reason::SlipAlongFriction { slip },
        };
        Err(Unsolved::none(Evidence::Traced { resolution: STRIDE.pair }, reason))
    }

    /// What is left of (S26) for `$P/W > 0$` and for `$P/W < 0$`, and how it changes along the curve.
    fn events(&self, z: &[f64; CURVE], way: &[f64; CURVE]) -> [(f64, f64); 2] {
        let along: [Jet<1>; CURVE] = from_fn(|i| Jet { re: z[i], eps: [way[i]] });
        self.forces.held(&along).map_or([(f64::NAN, f64::NAN); 2], |(state, _)| {
            let left = self.forces.excess(&state, &self.forces.motion(&state));
            left.map(|left| (left.re, left.eps[0]))
        })
    }

    /// The root at a crossing, if it is one.
    fn root(&self, at: &Crossing<CURVE>) -> Option<Root> {
        let node = self.held(&at.z).filter(Node::is_admissible)?;
        Some((node, if at.event == 0 { 1.0 } else { -1.0 }))
    }

    /// The state without inertia.
    fn level(&mut self) -> Option<Node> {
        let [x, c] = self.forces.begin(&mut self.steps)?;
        let [log, _, screw, cotangent] = self.forces.scale(&[Elastic::NO_INERTIA, x, x, c]);
        self.node(Place::new(Elastic::NO_INERTIA, x, c), &Place::new(log, screw, cotangent))
    }

    /// A state below the first root, if that is at `root`: up to there the curve is straight.
    fn below(&mut self, level: Node, root: f64) -> Node {
        let scale = self.scale(&level);
        // exp(−5): less than a hundredth of the inertia.
        let mut rise = root.min(0.0) - 5.0 - Elastic::NO_INERTIA;
        while rise > 0.0 {
            // A root moves by a few per cent, not by a factor of a hundred.
            if let Some(node) = self.node(level.place() + UP * rise, &scale)
                && node.is_straight_from(&level, rise, BEGINS, &self.forces)
            {
                return node;
            }
            rise -= 3.0;
        }
        level
    }
}

/// Towards more inertia.
const UP: Place = Place::new(1.0, 0.0, 0.0);

/// What the logarithm of `$q$` has no finer digits than.
fn digit(log: f64) -> f64 {
    4.0 * f64::EPSILON * log.abs().max(1.0)
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
            let Ok(pair) = screw.scaled() else { continue };
            let mut curve = Curve { forces: Forces::new(&pair), steps: 0 };
            let Ok(begin) = curve.begin() else { continue };
            let Some((straight, sign)) = curve.straight(&begin) else { continue };
            let (first, same) = curve.search(begin).expect("a root");
            // Where friction all but holds the load a million times the axial load is left, ten digits;
            // another root differs by per cent.
            let close = |x: f64, y: f64| assert_relative_eq!(x, y, max_relative = 1e-6);
            close(straight.state.centrifugal, first.state.centrifugal);
            close(straight.state.across[1], first.state.across[1]);
            close(sign, same);
            *found += 1;
        }
        // Of 1000 each; all but a few points of practice, and the slow ones of the extremes.
        assert!(of_practice > 900 && of_extremes > 300, "{of_practice} {of_extremes}");
    }

    /// Found in an audit: the search for the begin did not end for an angle whose cotangent is no number.
    #[test]
    fn the_begin_is_found_in_a_bounded_number_of_steps() {
        let mut rng = ChaCha8Rng::seed_from_u64(14);
        for number in 0..1000 {
            let mut screw = extreme(&mut rng);
            if let Some(angle) = [5e-324, 1.7e-309, 1e-150, 1e-17].get(number % 8) {
                screw.point.contact_angle = *angle;
            }
            let Ok(pair) = screw.scaled() else { continue };
            let mut curve = Curve { forces: Forces::new(&pair), steps: 0 };
            let _ = curve.begin();
            // Those to the angle, and those onto the curve.
            assert!(curve.steps <= Bracket::MOST_EVALUATIONS + 12, "{} {screw:?}", curve.steps);
        }
    }
}
