//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S25) to (S27).

use super::forces::{Forces, Kinematics, State};
use crate::layout::BALL;
use crate::pair::Pair;
use crate::{Reason, Status};

/// Logarithm of a `$q$` without inertia to all digits, in which any state still is a number.
const NO_INERTIA: f64 = -600.0;

/// Longest and shortest step along the curve, in `$\ln q$`.
const LONGEST: f64 = 1.0;
const SHORTEST: f64 = 1e-4;

/// States that are tried along one curve.
const MOST_NODES: usize = 4000;

/// A state on the curve.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// `$\ln q$`.
    place: f64,
    /// `$C$` and `$c$`.
    x: [f64; 2],
    state: State<f64>,
    kinematics: Kinematics,
    /// What is left of (S25) for `$P/W > 0$` and for `$P/W < 0$`.
    left: [f64; 2],
}

impl Node {
    /// True if the ball slides against friction on its flanks.
    fn is_admissible(&self) -> bool {
        let State { sin, cos, .. } = &self.state;
        self.kinematics.slip.iter().all(|slip| *slip > 0.0)
            && sin.iter().all(|sin| *sin >= 0.0)
            && cos.iter().all(|cos| *cos > 0.0)
    }

    /// Place and shape on the line through `self` and `other`.
    fn towards(&self, other: &Self, place: f64) -> [f64; 2] {
        let part = (place - self.place) / (other.place - self.place);
        [0, 1].map(|i| self.x[i] + (other.x[i] - self.x[i]) * part)
    }
}

/// What was seen of the curve.
struct Seen {
    /// Smallest and largest inertia ratio of a ball that slides against friction on its flanks.
    inertia: Option<(f64, f64)>,
    /// Slip at the nut at the begin.
    slip: f64,
    /// True if the curve was lost where such a ball still is on it.
    lost: bool,
}

/// Unknowns of the first root on the curve, and the states that were tried.
pub(super) fn first_root(pair: &Pair) -> Result<([f64; BALL], usize), (Status, Reason)> {
    let curve = Curve { forces: Forces::new(pair), tried: 0 };
    curve.first_root()
}

struct Curve<'a> {
    forces: Forces<'a>,
    tried: usize,
}

impl Curve<'_> {
    fn node(&mut self, place: f64, guess: [f64; 2]) -> Option<Node> {
        self.tried += 1;
        let (x, state) = self.forces.closed(place.exp(), guess)?;
        let kinematics = self.forces.kinematics(&state);
        let left = self.forces.excess(&state, &kinematics);
        Some(Node { place, x, state, kinematics, left })
    }

    fn first_root(mut self) -> Result<([f64; BALL], usize), (Status, Reason)> {
        let Some(begin) = self.begin() else {
            // (S12) at 90 deg
            let friction_term = self.forces.friction_term();
            let reason = Reason::SelfLocking { sin_contact_angle: 1.0, friction_term };
            return Err((Status::NoSolution, reason));
        };
        let mut seen = Seen { inertia: None, slip: begin.kinematics.slip[0], lost: false };
        if let Some((root, sign)) = self.walk(begin, &mut seen) {
            return Ok((self.forces.unknowns(&root.state, &root.kinematics, sign), self.tried));
        }
        let inertia = self.forces.inertia_ratio();
        let reason = match seen.inertia {
            Some((least, most)) => Reason::NoSkidAtInertia { inertia, least, most },
            None => Reason::SlipAlongFriction { slip: seen.slip },
        };
        let status = if seen.lost { Status::NotConverged } else { Status::NoSolution };
        Err((status, reason))
    }

    /// The begin of the curve: up to where its root cannot be, or its lower end.
    fn begin(&mut self) -> Option<Node> {
        let Some(guess) = self.forces.begin() else { return self.lower_end() };
        let level = self.node(NO_INERTIA, guess)?;
        let (a, b) = (level.kinematics.inertia, level.kinematics.drive);
        // M ~ q here: half a per cent of the root, where the curve is straight up to there.
        let root = level.place + (self.forces.inertia_ratio() / Forces::inertia(&level.state, &level.kinematics)).ln();
        let mut place = root.min(0.0) - 5.0;
        while place > level.place {
            if let Some(node) = self.node(place, level.x) {
                let growth = node.state.centrifugal / level.state.centrifugal / (place - level.place).exp();
                let near = |x: f64, y: f64| (x - y).abs() <= 0.01 * y.abs();
                if near(growth, 1.0) && near(node.kinematics.inertia, a) && near(node.kinematics.drive, b) {
                    return Some(node);
                }
            }
            place -= 3.0;
        }
        Some(level)
    }

    /// The lower end of a curve that does not begin without inertia.
    fn lower_end(&mut self) -> Option<Node> {
        let mut node = None;
        'found: for i in 0..24 {
            let place = 0.5 * f64::from(i) - 8.0;
            for j in 1..16 {
                let angle = 0.1 * f64::from(j);
                let guess = self.forces.level(angle.cos() / angle.sin());
                node = self.node(place, guess);
                if node.is_some() {
                    break 'found;
                }
            }
        }
        let mut node = node?;
        let mut step = LONGEST;
        while step > SHORTEST && node.place > NO_INERTIA {
            match self.node(node.place - step, node.x) {
                Some(next) => node = next,
                None => step *= 0.5,
            }
        }
        Some(node)
    }

    /// Along the curve to its first root, or to its end.
    fn walk(&mut self, begin: Node, seen: &mut Seen) -> Option<(Node, f64)> {
        let (mut at, mut before) = (begin, None::<Node>);
        let mut step = LONGEST;
        for _ in 0..MOST_NODES {
            if at.is_admissible() {
                let inertia = Forces::inertia(&at.state, &at.kinematics);
                let (least, most) = seen.inertia.unwrap_or((inertia, inertia));
                seen.inertia = Some((least.min(inertia), most.max(inertia)));
            }
            let next = loop {
                if step < SHORTEST {
                    seen.lost = at.is_admissible();
                    return None;
                }
                let place = at.place + step;
                let guess = before.map_or(at.x, |before| before.towards(&at, place));
                if let Some(next) = self.node(place, guess)
                    && (step < 2.0 * SHORTEST || is_smooth(before.as_ref(), &at, &next, guess))
                {
                    break next;
                }
                step *= 0.5;
            };
            for h in 0..2 {
                if (at.left[h] > 0.0) != (next.left[h] > 0.0) {
                    match self.refined(at, next, h) {
                        Some(root) if root.is_admissible() => {
                            return Some((root, if h == 0 { 1.0 } else { -1.0 }));
                        }
                        Some(_) => {}
                        None => seen.lost = true,
                    }
                }
            }
            (before, at) = (Some(at), next);
            step = (1.5 * step).min(LONGEST);
        }
        seen.lost = true;
        None
    }

    /// The root between two states, regula falsi with the Illinois rule in the root of `$q$`.
    fn refined(&mut self, mut low: Node, mut high: Node, h: usize) -> Option<Node> {
        let (mut below, mut above) = (low.left[h], high.left[h]);
        let mut kept = 0;
        for _ in 0..100 {
            let [a, b] = [low.place, high.place].map(|place| (0.5 * place).exp());
            let place = 2.0 * ((a * above - b * below) / (above - below)).ln();
            if !(place > low.place && place < high.place) {
                break;
            }
            let node = self.node(place, low.towards(&high, place))?;
            let left = node.left[h];
            if left.abs() <= 4.0 * f64::EPSILON * node.kinematics.drive.abs() {
                return Some(node);
            }
            if (left > 0.0) == (low.left[h] > 0.0) {
                (low, below) = (node, left);
                if kept == 1 {
                    above *= 0.5;
                }
                kept = 1;
            } else {
                (high, above) = (node, left);
                if kept == -1 {
                    below *= 0.5;
                }
                kept = -1;
            }
        }
        Some(if low.left[h].abs() < high.left[h].abs() { low } else { high })
    }
}

/// True if the step from `at` to `next` hides no pair of roots and no jump of the state.
fn is_smooth(before: Option<&Node>, at: &Node, next: &Node, guess: [f64; 2]) -> bool {
    let moved = (next.x[0] / guess[0] - 1.0).abs().max((next.x[1] - guess[1]).abs() / (1.0 + next.x[1].abs()));
    moved <= 0.05
        && before.is_none_or(|before| {
            let part = (next.place - at.place) / (at.place - before.place);
            (0..2).all(|h| {
                let straight = at.left[h] + (at.left[h] - before.left[h]) * part;
                let bend = (next.left[h] - straight).abs();
                let crosses = (at.left[h] > 0.0) != (next.left[h] > 0.0);
                crosses || bend <= 0.5 * at.left[h].abs().min(next.left[h].abs())
            })
        })
}
