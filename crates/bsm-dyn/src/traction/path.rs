//! The root of a ball whose inertia grows, where no start leads to one.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T6) to (T8).

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use bsm_newton::{EvalError, Options, Report, Scales, path_direction, solve};

use super::Rolling;
use super::root::Root;
use crate::ball_unknowns::unknown::PRECESSION;
use crate::ball_unknowns::{BALL, ROWS};
use crate::continuation::{Stride, follow};
use crate::ellipse::Lanes;
use crate::equations::{Workspace, equations};
use crate::raceway_control::Grip;

/// Unknowns of a path: those of the ball, and what is varied.
pub(super) const PATH: usize = BALL + 1;

/// Friction so small that it hardly turns the contact angles.
const FAINT: f64 = 1e-3;

/// Points of a path before it is given up; few take a hundred.
const MOST_POINTS: usize = 600;

/// Steps of length 1 change what is varied by a factor of e; a tenth of a millionth is none.
pub(super) const LONGEST: f64 = 1.0;
const SHORTEST: f64 = 1e-7;

/// Roots of a path that are nearer to each other may be missed.
const SHORTEST_DIP: f64 = 1e-3;

/// Angle \[rad\] beyond a flank that is not the rounding of large loads.
const CLEARLY: f64 = 1e-6;

/// Least cosine between the path and a step, so that no step goes to another path.
const STRAIGHT: f64 = 0.9;

/// What the path shows.
pub(super) enum Shown {
    /// A root on the flanks; its powers may not balance.
    Root(Root),
    /// All roots on the path have contact angles beyond the flanks; those of the first, or of the
    /// end of the path.
    Beyond([f64; 2]),
    /// A ball without inertia has left its flanks before friction was all there.
    Stopped([f64; 2]),
    /// The path could not be followed to its end.
    Nothing,
}

/// What is varied.
#[derive(Debug, Clone, Copy)]
enum Along {
    /// The friction of a ball without inertia.
    Friction,
    /// The precession rate of the inertia forces.
    Rate { unit: f64 },
}

impl Along {
    /// Friction and rate, and their derivatives by `u`.
    fn at(self, friction: f64, u: f64) -> [(f64, f64); 2] {
        match self {
            // f = eᵘ                                                      (T6)
            Self::Friction => [(u.exp(), u.exp()), (0.0, 0.0)],
            // P̂ = P₀ sinh u                                               (T7)
            Self::Rate { unit } => [(friction, 0.0), (unit * u.sinh(), unit * u.cosh())],
        }
    }
}

/// The equations of a point of a path: those of the ball, and a plane across the path.
struct Path<'a> {
    ball: &'a Rolling<'a>,
    along: Along,
    foot: [f64; PATH],
    normal: [f64; PATH],
}

impl Path<'_> {
    fn residual<D: Lanes<f64>>(&self, z: &[D; PATH]) -> Result<[D; PATH], EvalError> {
        let y: [D; BALL] = from_fn(|i| z[i]);
        let du = z[BALL] - z[BALL].re();
        let [friction, rate] = self
            .along
            .at(self.ball.pair.friction, z[BALL].re())
            .map(|(value, slope)| du * slope + value);
        let left = self.ball.left(&y, &self.ball.rubbed(&y, friction)?, rate);
        // (z − z₀)·t = 0                                                  (T8)
        let mut plane = D::from(0.0);
        for ((z, foot), normal) in z.iter().zip(&self.foot).zip(&self.normal) {
            plane += (*z - *foot) * *normal;
        }
        Ok(from_fn(|i| if i < BALL { left[i] } else { plane }))
    }

    fn weights(&self, z: &[f64; PATH]) -> [f64; PATH] {
        let [(friction, _), (rate, _)] = self.along.at(self.ball.pair.friction, z[BALL]);
        let ball = self.ball.weights_of(&ball(z), friction, rate);
        from_fn(|i| if i < BALL { ball[i] } else { 1.0 })
    }

    /// The point of the path in the plane. It is a guess for the next one: eight digits are enough.
    fn run(&self, z: &mut [f64; PATH], newton: &mut Workspace<PATH>) -> Report {
        let scales = Scales { x: &[1.0; PATH], f: &self.weights(z) };
        let enough = 1e-8;
        let options = Options {
            residual_tol: enough,
            residual_goal: enough,
            max_steps: 10,
            ..Options::default()
        };
        solve(self, z, &scales, &options, newton)
    }

    /// The direction of the path at `z`; its sense is the same all along the path.
    fn direction(&self, z: &[f64; PATH], newton: &mut Workspace<PATH>) -> Option<[f64; PATH]> {
        path_direction(self, z, &self.weights(z), newton).ok()
    }
}

equations!(
    Path<'_>,
    PATH,
    Path::residual,
    from_fn(|i| ROWS.get(i).copied().unwrap_or("plane across the path"))
);

/// A step along a path.
struct Leg<'a> {
    from: &'a [f64; PATH],
    to: &'a [f64; PATH],
    /// Directions of the path at both ends, as long as the step.
    directions: [[f64; PATH]; 2],
}

/// What is to be done after a step.
enum Next {
    On,
    /// The step was too long.
    Shorter,
    Stop,
}

/// The unknowns of the ball.
fn ball(z: &[f64; PATH]) -> [f64; BALL] {
    from_fn(|i| z[i])
}

/// A point of a path.
fn point(y: &[f64; BALL], u: f64) -> [f64; PATH] {
    from_fn(|i| if i < BALL { y[i] } else { u })
}

/// Unknowns of a ball between two points of a path, where a quantity that is `from` and `to` there
/// vanishes.
fn between(a: &[f64; PATH], b: &[f64; PATH], from: f64, to: f64) -> [f64; BALL] {
    let part = from / (from - to);
    from_fn(|i| a[i] + part * (b[i] - a[i]))
}

/// True if a quantity with these values and slopes at both ends of a step, alike in sign, may have
/// two zeros between. It has none if it is a parabola, with four times the room that this takes.
fn may_dip([from, to]: [f64; 2], [leaving, arriving]: [f64; 2]) -> bool {
    let there_and_back = from * leaving < 0.0 && to * arriving > 0.0;
    there_and_back && from.abs().min(to.abs()) <= leaving.abs().max(arriving.abs())
}

/// Distance of two states over the size of their numbers.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let square = |(a, b): (&f64, &f64)| ((b - a) / (1.0 + a.abs())).powi(2);
    a.iter().zip(b).map(square).sum::<f64>().sqrt()
}

/// A direction at a point of a path, of length one in the size of its numbers.
fn unit(direction: &[f64; PATH], z: &[f64; PATH]) -> [f64; PATH] {
    let size = direction.iter().zip(z).map(|(d, z)| (d / (1.0 + z.abs())).powi(2)).sum::<f64>();
    direction.map(|d| d / size.sqrt())
}

/// True if no contact is more than `margin` beyond its flank.
pub(super) fn are_on_flanks(angles: [f64; 2], margin: f64) -> bool {
    angles.iter().all(|angle| (-margin..FRAC_PI_2 + margin).contains(angle))
}

impl Rolling<'_> {
    pub(super) fn rate(&self, y: &[f64; BALL]) -> f64 {
        y[PRECESSION] + self.offset()
    }

    /// Contact angles at nut and screw.
    pub(super) fn angles(&self, y: &[f64; BALL]) -> [f64; 2] {
        self.loaded(y).map_or([f64::NAN; 2], |loaded| loaded.angles)
    }

    /// True if a contact is more than `margin` beyond its flank.
    pub(super) fn is_beyond(&self, y: &[f64; BALL], margin: f64) -> bool {
        !are_on_flanks(self.angles(y), margin)
    }

    /// True if the path may come back to the flanks no more: a right angle beyond them.
    fn is_far(&self, z: &[f64; PATH]) -> bool {
        self.is_beyond(&ball(z), FRAC_PI_2)
    }

    /// The first root on the flanks along the path of growing inertia forces.
    pub(super) fn followed(
        &self,
        newton: &mut Workspace,
        wide: &mut Workspace<PATH>,
        steps: &mut usize,
    ) -> Shown {
        let still = self.pair.with_inertia(0.0);
        let slippery = still.with_friction(self.pair.friction.min(FAINT));
        let Ok(guess) = Grip::guess(&still) else { return Shown::Nothing };
        let mut y = self.unknowns(&guess.loaded, &guess.to_nut);
        // Friction that is nearly proportional to the slip, then less and less.
        let begin = (10.0 * self.lever(&y)).ln();
        let stride = Stride { first: 2.0, shortest: 1e-3 };
        let settled = follow(&mut y, (begin, self.creep.ln()), stride, |log, y| {
            let report = Rolling { pair: &slippery, creep: log.exp(), ..*self }.run(y, newton);
            *steps += report.steps.len();
            report.converged()
        });
        if settled.is_err() {
            return Shown::Nothing;
        }
        if slippery.friction < self.pair.friction {
            let resting = Rolling { pair: &still, ..*self };
            let (goal, mut z) = (self.pair.friction.ln(), point(&y, slippery.friction.ln()));
            let mut landed = false;
            let ended =
                resting.track(Along::Friction, &mut z, wide, steps, |Leg { from, to, .. }| {
                    if to[BALL] < goal {
                        let over = resting.is_far(to) || to[BALL] < 2.0 * FAINT.ln();
                        return if over { Next::Stop } else { Next::On };
                    }
                    y = between(from, to, goal - from[BALL], goal - to[BALL]);
                    let guess = y;
                    landed = resting.run(&mut y, newton).converged()
                        && distance(&guess, &y) <= distance(from, to);
                    if landed { Next::Stop } else { Next::Shorter }
                });
            if !(ended && landed) {
                let end = ball(&z);
                let none = self.is_beyond(&end, CLEARLY);
                return if none { Shown::Stopped(self.angles(&end)) } else { Shown::Nothing };
            }
        }
        let forwards = self.beginning_at_rest(&y, 1.0, newton, wide, steps);
        if let Shown::Root(root) = &forwards
            && self.is_balanced(root)
        {
            return forwards;
        }
        match self.beginning_at_rest(&y, -1.0, newton, wide, steps) {
            root @ Shown::Root(_) => root,
            _ => forwards,
        }
    }

    /// The first root on the flanks from a ball without inertia on, towards its own precession rate
    /// or, with a negative `sense`, away from it.
    fn beginning_at_rest(
        &self,
        y: &[f64; BALL],
        sense: f64,
        newton: &mut Workspace,
        wide: &mut Workspace<PATH>,
        steps: &mut usize,
    ) -> Shown {
        let (at_rest, mu) = (self.rate(y), self.pair.inertia_ratio());
        // Rates up to which inertia is small against load and friction.
        let small = at_rest.abs().min((0.1 / mu).sqrt()).min(self.pair.friction / mu);
        let unit = sense * small.copysign(at_rest);
        // No ball circles that fast.
        let most = 2.0 * (1.0 + self.pair.nut_speed.abs());
        let held = |z: &[f64; PATH]| unit * z[BALL].sinh();
        let (mut found, mut beyond, mut more) = (None, None, 0);
        let mut z = point(y, 0.0);
        let ended = self.track(Along::Rate { unit }, &mut z, wide, steps, |leg| {
            let Leg { from, to, directions } = leg;
            let [before, after] = [from, to].map(|z| self.rate(&ball(z)) - held(z));
            let slope = |z: &[f64; PATH], way: &[f64; PATH]| {
                way[PRECESSION] - unit * z[BALL].cosh() * way[BALL]
            };
            let slopes = [slope(from, &directions[0]), slope(to, &directions[1])];
            if may_dip([before, after], slopes) && distance(from, to) > SHORTEST_DIP {
                return Next::Shorter;
            }
            if before * after <= 0.0 && before != 0.0 {
                let guess = between(from, to, before, after);
                let mut y = guess;
                let report = self.run(&mut y, newton);
                if !report.converged() || distance(&guess, &y) > distance(from, to) {
                    return Next::Shorter;
                }
                let root = self.thrown(y, report.residual, newton, &mut more);
                if self.is_admissible(&root) {
                    found = Some(Shown::Root(root));
                    if self.is_balanced(&root) {
                        return Next::Stop;
                    }
                } else {
                    beyond = beyond.or(Some(self.of(&root).angles(&root.unknowns)));
                }
            }
            if self.is_far(to) || held(to).abs() > most { Next::Stop } else { Next::On }
        });
        *steps += more;
        let end = ball(&z);
        let is_off = self.is_beyond(&end, CLEARLY);
        found.unwrap_or_else(|| match beyond {
            _ if !ended && !is_off => Shown::Nothing,
            Some(angles) => Shown::Beyond(angles),
            None if is_off => Shown::Beyond(self.angles(&end)),
            None => Shown::Nothing,
        })
    }

    /// Goes along a path from `z` on, first towards larger `u`, in steps of its length, through
    /// folds too, until `visit` says stop. False if the path is lost.
    fn track(
        &self,
        along: Along,
        z: &mut [f64; PATH],
        newton: &mut Workspace<PATH>,
        steps: &mut usize,
        mut visit: impl FnMut(Leg<'_>) -> Next,
    ) -> bool {
        let upwards = from_fn(|i| if i < BALL { 0.0 } else { 1.0 });
        let begin = Path { ball: self, along, foot: *z, normal: upwards };
        let Some(direction) = begin.direction(z, newton) else { return false };
        let sense = direction[BALL].signum();
        let mut direction = direction.map(|x| x * sense);
        let mut length = 0.5 * LONGEST;
        for _ in 0..MOST_POINTS {
            let scale = z.map(|z| 1.0 + z.abs());
            let leaving = unit(&direction, z);
            let foot = from_fn(|i| z[i] + length * leaving[i]);
            let normal = from_fn(|i| leaving[i] / (scale[i] * scale[i]));
            let path = Path { ball: self, along, foot, normal };
            let mut next = foot;
            let report = path.run(&mut next, newton);
            *steps += report.steps.len();
            let moved = distance(z, &next);
            let cosine = (0..PATH).map(|i| (next[i] - z[i]) * normal[i]).sum::<f64>() / moved;
            let ahead = (report.converged() && cosine > STRAIGHT)
                .then(|| path.direction(&next, newton))
                .flatten();
            let verdict = ahead.map(|ahead| {
                let arriving = ahead.map(|x| x * sense);
                let directions =
                    [leaving, unit(&arriving, &next)].map(|way| way.map(|x| x * moved));
                (arriving, visit(Leg { from: z, to: &next, directions }))
            });
            match verdict {
                Some((_, Next::Shorter)) | None => {
                    length *= 0.4;
                    if length < SHORTEST {
                        return false;
                    }
                }
                Some((arriving, verdict)) => {
                    (*z, direction) = (next, arriving);
                    if matches!(verdict, Next::Stop) {
                        return true;
                    }
                    let easy = report.steps.len() <= 4;
                    length = (moved * if easy { 1.6 } else { 1.0 }).min(LONGEST);
                }
            }
        }
        false
    }
}
