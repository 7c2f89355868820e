//! The first steady motion on the curve of all states of force.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S25) to (S27).

use super::forces::{Forces, Kinematics, Place, State};
use crate::layout::BALL;
use crate::pair::Pair;
use crate::{Reason, Status};

/// Logarithm of a `$q$` without inertia to all digits, in which any state still is a number.
const NO_INERTIA: f64 = -600.0;

/// Longest and shortest step along the curve, in units of [`Forces::scale`].
const LONGEST: f64 = 1.0;
const SHORTEST: f64 = 1e-4;

/// States that are tried along one curve.
const MOST_NODES: usize = 4000;

/// A state on the curve.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// `$\ln q$` and `$c$`.
    q_c: (f64, f64),
    state: State<f64>,
    kinematics: Kinematics,
    /// What is left of (S25) for `$P/W > 0$` and for `$P/W < 0$`.
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
    fn node(&mut self, known: usize, guess: Place, direction: &Place, scale: &Place) -> Option<Node> {
        self.tried += 1;
        let (place, state) = self.forces.closed(known, guess, direction, scale)?;
        let kinematics = self.forces.kinematics(&state);
        let left = self.forces.excess(&state, &kinematics);
        Some(Node { q_c: (place[0], place[2]), state, kinematics, left })
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

    /// The begin of the curve, or where its root cannot be before.
    fn begin(&mut self) -> Option<Node> {
        let Some([x, c]) = self.forces.begin() else { return self.end_below() };
        let place = Place::new(NO_INERTIA, x, c);
        let scale = self.forces.scale(&place, 2.0 * x);
        let level = self.node(1, place, &UP, &scale)?;
        let inertia = Forces::inertia(&level.state, &level.kinematics);
        // M ~ q here: half a per cent of the root, where the curve is straight up to there.
        let root = NO_INERTIA + (self.forces.inertia_ratio() / inertia).ln();
        let mut rise = root.min(0.0) - 5.0 - NO_INERTIA;
        while rise > 0.0 {
            if let Some(node) = self.node(1, level.place(1) + UP * rise, &UP, &scale) {
                let near = |x: f64, y: f64| (x - y).abs() <= 0.01 * y.abs();
                if near(node.state.centrifugal / level.state.centrifugal, rise.exp())
                    && near(node.kinematics.inertia, level.kinematics.inertia)
                    && near(node.kinematics.drive, level.kinematics.drive)
                {
                    return Some(node);
                }
            }
            rise -= 3.0;
        }
        Some(level)
    }

    /// The lower end of a curve that does not begin without inertia.
    fn end_below(&mut self) -> Option<Node> {
        let mut found = None;
        'search: for i in 0..24 {
            for j in 1..16 {
                let angle = 0.1 * f64::from(j);
                let [x, c] = self.forces.level(angle.cos() / angle.sin());
                let place = Place::new(0.5 * f64::from(i) - 8.0, x, c);
                found = self.node(1, place, &UP, &self.forces.scale(&place, 2.0 * x));
                if found.is_some() {
                    break 'search;
                }
            }
        }
        let mut along = Along::from(found?, -UP, &self.forces);
        for _ in 0..MOST_NODES {
            let Some(next) = self.next(&mut along) else { break };
            along.go(next, &self.forces);
        }
        Some(along.at)
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
    fn walk(&mut self, begin: Node, seen: &mut Seen) -> Option<(Node, f64)> {
        let mut along = Along::from(begin, UP, &self.forces);
        for _ in 0..MOST_NODES {
            let at = along.at;
            if std::env::var("ONE").is_ok() { eprintln!("{} {} {:?} ok {} {:?}", along.step, along.last, at.place(1), at.is_admissible(), at); }
            if at.is_admissible() {
                let inertia = Forces::inertia(&at.state, &at.kinematics);
                let (least, most) = seen.inertia.unwrap_or((inertia, inertia));
                seen.inertia = Some((least.min(inertia), most.max(inertia)));
            }
            let Some(next) = self.next(&mut along) else {
                if std::env::var("ONE").is_ok() { eprintln!("no next"); }
                seen.lost |= at.is_admissible();
                return None;
            };
            for h in 0..2 {
                if (at.left[h] > 0.0) != (next.left[h] > 0.0) {
                    match self.refined(along.known, at, next, h) {
                        Some(root) if root.is_admissible() => {
                            return Some((root, if h == 0 { 1.0 } else { -1.0 }));
                        }
                        Some(_) => {}
                        None => if std::env::var("ONE").is_ok() { eprintln!("not refined"); seen.lost = true } else {seen.lost |= at.is_admissible() || next.is_admissible()},
                    }
                }
            }
            // Slip against friction is behind.
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
    fn refined(&mut self, known: usize, mut low: Node, mut high: Node, h: usize) -> Option<Node> {
        let (mut below, mut above) = (low.left[h], high.left[h]);
        let mut kept = 0;
        for _ in 0..100 {
            let place = low.place(known);
            let direction = high.place(known) - place;
            let scale = low.scale(known, &self.forces);
            let part = below / (below - above);
            let way = part * direction.component_div(&scale).amax();
            if way <= f64::EPSILON || part >= 1.0 {
                break;
            }
            let node = self.node(known, place + direction * part, &direction, &scale)?;
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

/// Towards more inertia.
const UP: Place = Place::new(1.0, 0.0, 0.0);

/// A walk along the curve.
struct Along {
    at: Node,
    before: Option<Node>,
    /// The contact whose `$x$` is a coordinate.
    known: usize,
    /// Towards the next state, of length one in units of [`Forces::scale`].
    direction: Place,
    scale: Place,
    step: f64,
    last: f64,
}

impl Along {
    fn from(at: Node, direction: Place, forces: &Forces<'_>) -> Self {
        let scale = at.scale(1, forces);
        Self { at, before: None, known: 1, direction, scale, step: LONGEST, last: LONGEST }
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
        off <= 0.05 && (!concerns || (is_straight(0) && is_straight(1)))
    }
}
