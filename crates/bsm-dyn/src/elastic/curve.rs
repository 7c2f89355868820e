//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S12), (S26).

use super::forces::{Forces, Kinematics, Place, State};
use crate::ball_unknowns::BALL;
use crate::bracket::Bracket;
use crate::elastic_ball::ElasticBall;
use crate::{Evidence, Reason, Unsolved};

/// Logarithm of a `$q$` without inertia: next to the smallest normal number.
const NO_INERTIA: f64 = -700.0;

/// Longest and shortest step along the curve, in units of [`Forces::scale`]. A pair of roots that is
/// closer than the shortest step may be missed.
const LONGEST: f64 = 1.0;
const SHORTEST: f64 = 1e-4;

/// Distance of a state from the line through the last two, in the same units, up to which the step is
/// believed to have stayed on the curve.
const BEND: f64 = 0.05;

/// Steps along one curve; fifty are usual.
const MOST_STEPS: usize = 4000;

/// Steps of the regula falsi; ten are usual.
const MOST_TRIES: usize = 100;

/// Relative changes of the factors of (S27) from where the curve begins, up to which the curve is
/// straight: a walk may begin there, and the inertia has only risen up to there.
const BEGINS: f64 = 0.01;
const RISES: f64 = 0.1;

/// [`Forces::scale`] is some third of a place: a third of a relative change in its units.
const LARGE: f64 = 3.0;

/// A state on the curve.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// `$\ln q$` and `$c$`.
    q_c: (f64, f64),
    state: State<f64>,
    kinematics: Kinematics<f64>,
    /// What is left of (S26) for `$P/W > 0$` and for `$P/W < 0$`.
    left: [f64; 2],
}

impl Node {
    /// The place, by the `$x$` of one contact.
    fn place(&self, known: usize) -> Place {
        let (q, c) = self.q_c;
        Place::new(q, self.state.across[known], c)
    }

    /// What is a large step from here.
    fn scale(&self, known: usize, forces: &Forces<'_>) -> Place {
        forces.scale(&self.place(known), self.state.across.iter().sum())
    }

    /// True if the centrifugal force is proportional to `$q$` from `level` to here, a `rise` of its
    /// logarithm, and nothing else in (S27) changes, nor the place but for `$q$`; to a relative
    /// `change`.
    fn is_straight_from(&self, level: &Self, rise: f64, change: f64, forces: &Forces<'_>) -> bool {
        let near = |x: f64, y: f64| (x - y).abs() <= change * y.abs();
        // A place may be far from the begin and have the factors of the begin again.
        let stays = |known| {
            let off = self.place(known) - level.place(known) - UP * rise;
            off.component_div(&level.scale(known, forces)).amax() <= LARGE * change
        };
        near(self.state.centrifugal / level.state.centrifugal, rise.exp())
            && near(self.kinematics.inertia, level.kinematics.inertia)
            && near(self.kinematics.drive, level.kinematics.drive)
            && stays(0)
            && stays(1)
    }

    /// True if the ball slides against friction on its flanks.
    fn is_admissible(&self) -> bool {
        let State { sin, cos, .. } = &self.state;
        self.kinematics.slip.iter().all(|slip| *slip > 0.0)
            && sin.iter().all(|sin| *sin >= 0.0)
            && cos.iter().all(|cos| *cos > 0.0)
    }
}

/// What was seen of the curve.
struct Seen {
    /// Smallest and largest inertia ratio of a ball that slides against friction on its flanks.
    inertia: Option<(f64, f64)>,
    /// True if the curve was lost where such a ball still is on it.
    lost: bool,
}

/// A steady motion on the curve: its state, and the sign of `$P/W$`.
type Root = (Node, f64);

/// Unknowns of the first root on the curve, and Newton steps.
pub(super) fn first_root(pair: &ElasticBall) -> Result<([f64; BALL], usize), Unsolved> {
    let mut curve = Curve { forces: Forces::new(pair), steps: 0 };
    let begin = curve.begin()?;
    let (root, sign) = match curve.straight(&begin) {
        Some(root) => root,
        None => curve.search(begin)?,
    };
    Ok((curve.forces.unknowns(&root.state, &root.kinematics, sign), curve.steps))
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
    fn node(
        &mut self,
        known: usize,
        guess: Place,
        direction: &Place,
        scale: &Place,
    ) -> Option<Node> {
        let (place, state) = self.forces.closed(known, guess, direction, scale, &mut self.steps)?;
        Some(self.at(place, state))
    }

    fn at(&self, place: Place, state: State<f64>) -> Node {
        let kinematics = self.forces.kinematics(&state);
        let left = self.forces.excess(&state, &kinematics);
        Node { q_c: (place[0], place[2]), state, kinematics, left }
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
        let level = self.level().ok_or(LOST)?;
        // M ~ q, up to where the curve bends. Where nut and screw turn together, the inertia here
        // underflows, its logarithm does not.
        let here = Forces::log_inertia(&level.state, &level.kinematics);
        let root = NO_INERTIA + inertia.ln() - here;
        if root < NO_INERTIA {
            let reason = Reason::InertiaOutOfRange { inertia_ratio: inertia };
            return Err(Unsolved::invalid(reason));
        }
        Ok(Begin { level, root })
    }

    /// The first root, if it is where the curve is straight: up to there the inertia (S27) has only
    /// risen, so that no other root is before it.
    fn straight(&mut self, begin: &Begin) -> Option<Root> {
        let Begin { level, root } = begin;
        let rise = Place::new(root - NO_INERTIA, 0.0, 0.0);
        let scale = level.scale(1, &self.forces);
        let (place, state) = self.forces.steady(level.place(1) + rise, &scale, &mut self.steps)?;
        let node = self.at(place, state);
        let sign = (level.kinematics.drive * level.kinematics.inertia).signum();
        let is_first = node.is_straight_from(level, place[0] - NO_INERTIA, RISES, &self.forces);
        // Where rounding decides, the search does its best.
        let left = node.left[usize::from(sign < 0.0)].abs();
        let is_exact = left <= digit(place[0]) * node.kinematics.drive.abs();
        (is_first && is_exact && node.is_admissible()).then_some((node, sign))
    }

    /// The first root along the whole curve, or why there is none.
    fn search(&mut self, Begin { level, root }: Begin) -> Result<Root, Unsolved> {
        let inertia = self.forces.inertia_ratio();
        let here = Forces::log_inertia(&level.state, &level.kinematics);
        let begin = self.below(level, root);
        let slip = level.kinematics.slip[0];
        let mut seen = Seen { inertia: None, lost: false };
        if level.is_admissible() {
            seen.inertia = Some((0.0, here.exp()));
        }
        if let Some(root) = self.walk(begin, &mut seen) {
            return Ok(root);
        }
        if seen.lost {
            return Err(LOST);
        }
        let reason = match seen.inertia {
            Some((least, most)) => Reason::NoSkidAtInertia { inertia, least, most },
            None => Reason::SlipAlongFriction { slip },
        };
        Err(Unsolved::none(Evidence::Traced { resolution: SHORTEST }, reason))
    }

    /// The state without inertia.
    fn level(&mut self) -> Option<Node> {
        let [x, c] = self.forces.begin(&mut self.steps)?;
        let place = Place::new(NO_INERTIA, x, c);
        self.node(1, place, &UP, &self.forces.scale(&place, 2.0 * x))
    }

    /// A state below the first root, if that is at `root`: up to there the curve is straight.
    fn below(&mut self, level: Node, root: f64) -> Node {
        let scale = level.scale(1, &self.forces);
        // exp(−5): less than a hundredth of the inertia.
        let mut rise = root.min(0.0) - 5.0 - NO_INERTIA;
        while rise > 0.0 {
            // A root moves by a few per cent, not by a factor of a hundred.
            if let Some(node) = self.node(1, level.place(1) + UP * rise, &UP, &scale)
                && node.is_straight_from(&level, rise, BEGINS, &self.forces)
            {
                return node;
            }
            rise -= 3.0;
        }
        level
    }

    /// The next state.
    fn next(&mut self, along: &mut Along) -> Option<Node> {
        while along.step >= SHORTEST {
            let guess = along.at.place(along.known) + along.direction * along.step;
            if let Some(next) = self.node(along.known, guess, &along.direction, &along.scale)
                && (along.step < 2.0 * SHORTEST || along.is_smooth(&guess, &next))
            {
                return Some(next);
            }
            along.step *= 0.5;
        }
        None
    }

    /// Along the curve to its first root, or to its end.
    fn walk(&mut self, begin: Node, seen: &mut Seen) -> Option<Root> {
        let mut along = Along::from(begin, &self.forces);
        for _ in 0..MOST_STEPS {
            let at = along.at;
            if at.is_admissible() {
                let inertia = Forces::log_inertia(&at.state, &at.kinematics).exp();
                let (least, most) = seen.inertia.unwrap_or((inertia, inertia));
                seen.inertia = Some((least.min(inertia), most.max(inertia)));
            }
            let Some(next) = self.next(&mut along) else {
                seen.lost |= at.is_admissible();
                return None;
            };
            let mut first: Option<Root> = None;
            for (h, sign) in [1.0, -1.0].into_iter().enumerate() {
                if (at.left[h] > 0.0) == (next.left[h] > 0.0) {
                    continue;
                }
                let Some(root) = self.refined(along.known, at, next, h) else {
                    seen.lost |= at.is_admissible() || next.is_admissible();
                    continue;
                };
                let way = |node: &Node| along.way(node);
                if root.is_admissible() && first.is_none_or(|(other, _)| way(&root) < way(&other)) {
                    first = Some((root, sign));
                }
            }
            if first.is_some() {
                return first;
            }
            // Beyond, friction is along the slip.
            let [nut, screw] = next.state.across;
            if next.q_c.0 < NO_INERTIA || screw < 0.0 || nut < -self.forces.least() {
                return None;
            }
            along.go(next, &self.forces);
        }
        seen.lost = true;
        None
    }

    /// The root between two states, regula falsi with the Illinois rule.
    fn refined(&mut self, known: usize, low: Node, high: Node, h: usize) -> Option<Node> {
        let mut bracket = Bracket::new([low, high], [low.left[h], high.left[h]]);
        for _ in 0..MOST_TRIES {
            let ([low, high], [below, above]) = (bracket.ends, bracket.values);
            let place = low.place(known);
            let direction = high.place(known) - place;
            let scale = low.scale(known, &self.forces);
            let part = below / (below - above);
            let way = part * direction.component_div(&scale).amax();
            let digit = digit(place[0]);
            if way <= digit || part >= 1.0 || direction.component_div(&scale).amax() <= 4.0 * digit
            {
                break;
            }
            let node = self.node(known, place + direction * part, &direction, &scale)?;
            let left = node.left[h];
            if left.abs() <= 4.0 * f64::EPSILON * node.kinematics.drive.abs() {
                return Some(node);
            }
            bracket.tighten(usize::from((left > 0.0) != (low.left[h] > 0.0)), node, left);
        }
        let [low, high] = bracket.ends;
        Some(if low.left[h].abs() < high.left[h].abs() { low } else { high })
    }
}

/// The answer where the curve is lost.
const LOST: Unsolved = Unsolved::NotConverged { reason: Reason::SearchLost };

/// Towards more inertia.
const UP: Place = Place::new(1.0, 0.0, 0.0);

/// What the logarithm of `$q$` has no finer digits than.
fn digit(log: f64) -> f64 {
    4.0 * f64::EPSILON * log.abs().max(1.0)
}

/// A walk along the curve.
struct Along {
    at: Node,
    before: Option<Node>,
    /// The contact whose `$x$` is a coordinate.
    known: usize,
    /// Towards the next state, of length one in units of [`Forces::scale`].
    direction: Place,
    scale: Place,
    /// Length of the next step and of the last one.
    step: f64,
    last: f64,
}

impl Along {
    fn from(at: Node, forces: &Forces<'_>) -> Self {
        let scale = at.scale(1, forces);
        Self { at, before: None, known: 1, direction: UP, scale, step: LONGEST, last: LONGEST }
    }

    fn go(&mut self, next: Node, forces: &Forces<'_>) {
        // The smaller one does not vanish in a square root.
        let [nut, screw] = next.state.across;
        self.known = usize::from(screw <= nut);
        self.scale = next.scale(self.known, forces);
        let way = next.place(self.known) - self.at.place(self.known);
        self.last = way.component_div(&self.scale).norm();
        self.direction = way / self.last;
        (self.before, self.at) = (Some(self.at), next);
        self.step = (1.5 * self.step).min(LONGEST);
    }

    /// Way along the step to a state.
    fn way(&self, node: &Node) -> f64 {
        let way = node.place(self.known) - self.at.place(self.known);
        way.component_div(&self.scale).norm()
    }

    /// True if the step to `next` hides no pair of roots and no jump of the state.
    fn is_smooth(&self, guess: &Place, next: &Node) -> bool {
        let (at, part) = (&self.at, self.step / self.last);
        let off = (next.place(self.known) - guess).component_div(&self.scale).amax();
        let is_straight = |h: usize| {
            let Some(before) = &self.before else { return true };
            let straight = at.left[h] + (at.left[h] - before.left[h]) * part;
            let bend = (next.left[h] - straight).abs();
            let crosses = (at.left[h] > 0.0) != (next.left[h] > 0.0);
            crosses || bend <= 0.5 * at.left[h].abs().min(next.left[h].abs())
        };
        let concerns = at.is_admissible() || next.is_admissible();
        off <= BEND && (!concerns || (is_straight(0) && is_straight(1)))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
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
                screw.contact_angle = *angle;
            }
            let Ok(pair) = screw.scaled() else { continue };
            let mut curve = Curve { forces: Forces::new(&pair), steps: 0 };
            let _ = curve.begin();
            // Those to the angle, one to ask whether there is any, and those onto the curve.
            assert!(curve.steps <= 121 + 12, "{} {screw:?}", curve.steps);
        }
    }
}
