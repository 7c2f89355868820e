//! The ball whose friction comes from a lubricant.
//!
//! Theory: `docs/theory/17-lubricant.md`, equation (Y32).

use std::cell::{Cell, OnceCell};

use bsm_kin::{Helix, Jet, Scalar};
use bsm_newton::{Equations, EvalError, Linear, Options, Report, Scales, solve};
use bsm_simd::Block;

use super::columns::Evaluated;
use super::root::Root;
use super::{COARSE, KEEP, NEAR, Rolling, SEARCH, Start, State, Traction};
use super::{Plan, TractionWorkspace};
use crate::balance::ideal_torque;
use crate::ball_unknowns::unknown::PRECESSION;
use crate::ball_unknowns::{BALL, ROWS};
use crate::continuation::{Stride, follow};
use crate::elastic_ball::{ElasticBall, refused, to_both};
use crate::ellipse::Lanes;
use crate::equations::{Workspace, linear};
use crate::lubricant::{Found, LubricatedWorkspace, Rub, Steady, Wetted, unit_powers};
use crate::raceway_control::Grip;
use crate::sensitivity::moving_root;
use crate::{ModelWorkspace, SolveInfo, Unsolved, Wrench};

/// Residual of a root: its powers balance to a tenth of what they must.
const ENOUGH: f64 = 1e-11;

/// The equations of a point with its lubricant.
#[derive(Clone, Copy)]
struct Wet<'a, P = f64> {
    ball: Rolling<'a, P>,
    wetted: &'a Wetted<P>,
    /// Part of the friction that comes from the lubricant; the rest has one coefficient.
    part: f64,
    /// Derivatives of all that changes, by jets; else without those that hardly matter, by hand.
    complete: bool,
    seen: &'a Seen,
}

/// What the equations were last evaluated for.
#[derive(Default)]
struct Seen {
    last: Cell<Option<Last>>,
    /// Derivatives of the torque by the unknowns, where the Jacobian was last asked for.
    slope: Cell<Block>,
}

#[derive(Clone, Copy)]
struct Last {
    unknowns: [f64; BALL],
    torque: f64,
    sliding: [f64; 2],
}

impl<P: Scalar> Wet<'_, P> {
    /// Contacts, motion, and what ball and races do to each other.
    fn state<D: Lanes<P>>(&self, y: &[D; BALL]) -> Result<(State<D>, [Rub<D>; 2]), EvalError> {
        crate::cost::evaluated();
        let Self { ball, wetted, part, .. } = self;
        let (pair, loaded) = (ball.pair, ball.loaded(y)?);
        let to_nut = ball.motion_to_nut(y, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let rubs = std::array::from_fn(|i| {
            wetted.rub(i, (pair, &loaded), &motions[i], ball.creep, ball.nodes(i))
        });
        let rest = if *part < 1.0 { Some(ball.state(y)?.wrench) } else { None };
        let wrench = std::array::from_fn(|i| {
            let rub: &Rub<D> = &rubs[i];
            // F = Q N + ∫ dF + F_h,  M = ∫ r × dF + r × F_h + C_h         (Y32)
            let Wrench { force, moment } = rub.wrench;
            let force = loaded.contacts[i].normal * loaded.loads[i] + force;
            match &rest {
                None => Wrench { force, moment },
                Some(rest) => Wrench {
                    force: force * D::from(*part) + rest[i].force * D::from(1.0 - part),
                    moment: moment * D::from(*part) + rest[i].moment * D::from(1.0 - part),
                },
            }
        });
        Ok((State { loaded, to_nut, wrench, power: f64::NAN }, rubs))
    }

    fn residual<D: Lanes<P>>(&self, y: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        let rate = y[PRECESSION] + self.ball.offset();
        Ok(self.ball.left(y, &self.state(y)?.0, rate))
    }
}

impl Wet<'_> {
    /// The state, if all friction comes from the lubricant and the ball has contacts.
    fn by_hand<const SLOPED: bool>(&self, y: &[f64; BALL]) -> Option<Evaluated> {
        if self.part < 1.0 {
            return None;
        }
        let found = self.ball.oiled::<SLOPED>(self.wetted, y)?;
        let (torque, sliding) = (found.transmitted.torque, found.sliding);
        self.seen.last.set(Some(Last { unknowns: *y, torque, sliding }));
        if SLOPED {
            self.seen.slope.set(found.slope);
        }
        Some(found)
    }

    /// Torque on the screw and power of sliding at a state, which mostly was the last one.
    fn transmitted(&self, y: &[f64; BALL]) -> Option<Last> {
        match self.seen.last.get() {
            Some(last) if last.unknowns.map(f64::to_bits) == y.map(f64::to_bits) => Some(last),
            _ => self.by_hand::<false>(y).and_then(|_| self.seen.last.get()),
        }
    }

    /// One damped Newton solve from `y`.
    fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace, steps: &mut usize) -> Report {
        let weights = self.ball.weights(y);
        let keep_below = if self.complete { 0.0 } else { self.ball.enough.sqrt().max(KEEP) };
        let options = Options { keep_below, ..self.ball.options() };
        let report = solve(self, y, &Scales { x: &[1.0; BALL], f: &weights }, &options, newton);
        *steps += report.steps.len();
        report
    }

    /// The root that Newton leads to, if it is one of a ball on its flanks.
    fn solved(
        &self,
        mut y: [f64; BALL],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<Root, Unsolved> {
        let report = self.run(&mut y, newton, steps);
        let root = Root { unknowns: y, at_nut: self.ball.at_nut, residual: report.residual };
        if report.converged() && self.ball.is_admissible(&root) {
            return Ok(root);
        }
        Err(Unsolved::not_converged(report.into()))
    }

    /// The root that `y` leads to while something of the equations changes from `begin` to `end`.
    fn followed(
        &self,
        mut y: [f64; BALL],
        (begin, end, stride): (f64, f64, Stride),
        at: impl Fn(&Self, f64) -> Self,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<Root> {
        let arrived = follow(&mut y, (begin, end), stride, |place, y| {
            at(self, place).run(y, newton, steps).converged()
        });
        arrived.ok()?;
        self.solved(y, newton, steps).ok()
    }

    /// The root near the one of a constant coefficient; else, while the oil takes over from it; else,
    /// from the rolling ball and friction that is nearly proportional to the slip.
    fn search(
        &self,
        near: Option<&Root>,
        grip: &Grip,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<Root, Unsolved> {
        let mut failure = Unsolved::LOST;
        if let Some(near) = near {
            let here = Self { ball: self.ball.of(near), ..*self };
            for complete in [false, true] {
                match (Self { complete, ..here }).solved(near.unknowns, newton, steps) {
                    Ok(root) => return Ok(root),
                    Err(none) => failure = none,
                }
            }
            let stride = Stride { first: 0.25, shortest: 0.01 };
            let oiled = |wet: &Self, part| Self { part, complete: true, ..*wet };
            let way = (0.0, 1.0, stride);
            if let Some(root) = here.followed(near.unknowns, way, oiled, newton, steps) {
                return Ok(root);
            }
        }
        let gripping = self.ball.unknowns(&grip.loaded, &grip.to_nut);
        let stride = Stride { first: 1.0, shortest: 0.05 };
        for complete in [false, true] {
            let lowered = |wet: &Self, log: f64| Self {
                ball: Rolling { creep: log.exp(), ..wet.ball },
                complete,
                ..*wet
            };
            let way = (0.0, self.ball.creep.ln(), stride);
            if let Some(root) = self.followed(gripping, way, lowered, newton, steps) {
                return Ok(root);
            }
        }
        Err(failure)
    }
}

impl Equations<BALL> for Wet<'_> {
    fn residual(&self, x: &[f64; BALL]) -> Result<[f64; BALL], EvalError> {
        match self.by_hand::<false>(x) {
            Some(found) => Ok(found.left),
            None => Wet::residual(self, x),
        }
    }

    fn linearize(&self, x: &[f64; BALL]) -> Result<Linear<BALL>, EvalError> {
        match self.by_hand::<true>(x) {
            Some(found) if !self.complete => Ok((found.left, found.jacobian())),
            _ => linear(x, |y| Wet::residual(self, y)),
        }
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}

/// A root, the point with its friction scale, and the gripping ball that the search began with.
struct Place {
    pair: ElasticBall,
    grip: Grip,
    root: Root,
    plans: [OnceCell<Plan>; 2],
    steps: usize,
    /// Of the contacts on the screw, scaled, and what sliding takes.
    last: Last,
    /// What the quadrature may leave in the efficiency of the contacts (T25).
    error: f64,
}

impl Traction {
    /// The root near that of a constant coefficient, with the quadrature of the accuracy.
    fn wet_root(
        &self,
        wetted: &Wetted,
        work: &mut TractionWorkspace,
        oil: &mut LubricatedWorkspace,
    ) -> Result<Place, Unsolved> {
        let pair = self.at.scaled()?;
        let grip = Grip::of(&pair, None, &mut work.statics);
        let Start { grip, .. } = Start::new(&pair, grip.ok().as_ref())?;
        let creep = self.creep * pair.slip_scale();
        let scale = wetted.friction_scale(&pair, &grip.loaded, &grip.to_nut, creep);
        let pair = pair.with_friction(scale);
        let places = [COARSE, SEARCH].map(|accuracy| work.rules(accuracy));
        let TractionWorkspace { newton, path, rules, .. } = work;
        let seen = &Seen::default();
        let ball = |rule| Rolling::of_pair(&pair, rule, creep);
        let wet = |ball| Wet { ball, wetted, part: 1.0, complete: false, seen };
        let coarse = Rolling { enough: NEAR, ..ball(&rules[places[0]].rule) };
        let mut steps = grip.steps;
        let near = coarse.search(&grip, false, (newton, path), &mut steps).ok();
        let ([rough, smooth, rule], check) = oil.rules([COARSE, SEARCH, self.accuracy]);
        let oiled = wet(Rolling { enough: NEAR, ..ball(rough) });
        let found = oiled.search(near.as_ref(), &grip, newton, &mut steps);
        let root = if let Ok(root) = found {
            root
        } else {
            let search = ball(&rules[places[1]].rule);
            let near = search.search(&grip, true, (newton, path), &mut steps).ok();
            wet(ball(smooth)).search(near.as_ref(), &grip, newton, &mut steps)?
        };
        let plans = Default::default();
        let fine = Rolling { plans: Some(&plans), enough: ENOUGH, ..ball(rule).of(&root) };
        let fine = wet(fine);
        let root = match fine.solved(root.unknowns, newton, &mut steps) {
            Ok(found) => found,
            Err(_) => Wet { complete: true, ..fine }.solved(root.unknowns, newton, &mut steps)?,
        };
        let last = fine.transmitted(&root.unknowns).ok_or(Unsolved::LOST)?;
        let checked = Rolling { quadrature: check, plans: None, ..fine.ball };
        let other = checked.oiled::<false>(wetted, &root.unknowns);
        let Helix { radius, lead_angle } = pair.helix;
        let ideal = ideal_torque(1.0, radius, lead_angle.tan());
        let efficiency = crate::balance::efficiency(pair.direction.is_back(), ideal, last.torque);
        let error =
            checked.error(self.accuracy, other.as_ref(), &seen.slope.get(), efficiency, newton);
        Ok(Place { pair, grip, root, plans, steps, last, error })
    }

    /// The steady ball with a lubricant.
    pub(crate) fn lubricated(
        &self,
        wetted: &Wetted,
        work: &mut TractionWorkspace,
        oil: &mut LubricatedWorkspace,
    ) -> Result<Found, Unsolved> {
        let Place { pair, grip, root, steps, last, error, .. } =
            self.wet_root(wetted, work, oil)?;
        let creep = self.creep * pair.slip_scale();
        let [_, dry] = oil.both(self.accuracy);
        let ball = Rolling::of_pair(&pair, dry, creep).of(&root);
        let loaded = ball.loaded(&root.unknowns).map_err(refused)?;
        let to_nut = ball.motion_to_nut(&root.unknowns, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let rubs = std::array::from_fn(|i| {
            wetted.rub_of(i, (&pair, &loaded), &motions[i], creep, last.sliding[i])
        });
        let unit = unit_powers(&pair, &loaded, &to_nut, creep, [0, 1].map(|i| ball.nodes(i)));
        let torque = last.torque * (self.at.point.ball.radius * self.at.point.load.axial);
        let info = SolveInfo { steps, residual: root.residual };
        let steady = Steady { loaded, to_nut, rubs, torque };
        let (skid, error) = (grip.skid(&pair), Some(error));
        Ok(Found { pair, steady, unit, skid, info, control: None, error })
    }
}

impl<const M: usize> Traction<Jet<M>> {
    /// The same without derivatives.
    pub(crate) fn values(&self) -> Traction {
        let Self { at, accuracy, creep } = *self;
        Traction { at: at.values(), accuracy, creep }
    }

    /// The steady ball with a lubricant, with derivatives, and the point.
    ///
    /// * `values`: the same without derivatives.
    pub(crate) fn lubricated_slopes(
        &self,
        wetted: &Wetted<Jet<M>>,
        values: &Wetted,
        ModelWorkspace { traction, lubricated, .. }: &mut ModelWorkspace,
    ) -> Result<(ElasticBall<Jet<M>>, Steady<Jet<M>>), Unsolved> {
        let inputs = self.at.scaled()?;
        let Place { pair, root, plans, .. } =
            self.values().wet_root(values, traction, lubricated)?;
        let creep = self.creep * pair.slip_scale();
        let (newton, quadrature) = (&mut traction.newton, lubricated.both(self.accuracy)[0]);
        let ball = Rolling::of_pair(&pair, quadrature, creep).of(&root);
        let ball = Rolling { plans: Some(&plans), ..ball };
        let Rolling { plans, enough, at_nut, .. } = ball;
        let seen = &Seen::default();
        let moving = Wet {
            ball: Rolling { pair: &inputs, quadrature, plans, creep, enough, at_nut },
            wetted,
            part: 1.0,
            complete: true,
            seen,
        };
        let system = Wet { ball, wetted: values, part: 1.0, complete: true, seen };
        let residual = |y: &_| moving.residual(y);
        let weights = ball.weights(&root.unknowns);
        let y = moving_root(&system, &root.unknowns, &weights, residual, newton)?;
        let (State { loaded, to_nut, wrench, .. }, rubs) = moving.state(&y).map_err(refused)?;
        let torque = self.at.screw_torque(&inputs, &loaded.frame, &wrench[1]);
        Ok((inputs, Steady { loaded, to_nut, rubs, torque }))
    }
}
