//! The ball whose friction comes from a lubricant.
//!
//! Theory: `docs/theory/17-lubricant.md`, equation (Y32).

use bsm_kin::{Jet, Scalar};
use bsm_newton::{EvalError, Report, Scales, solve};

use super::root::Root;
use super::{COARSE, NEAR, Rolling, SEARCH, Start, State, Traction};
use super::{Plan, TractionWorkspace};
use crate::ball_unknowns::unknown::PRECESSION;
use crate::ball_unknowns::{BALL, ROWS};
use crate::continuation::{Stride, follow};
use crate::elastic_ball::{ElasticBall, refused, to_both};
use crate::ellipse::Lanes;
use crate::equations::{Workspace, equations};
use crate::lubricant::{Found, LubricatedWorkspace, Rub, Steady, Wetted, unit_powers};
use crate::raceway_control::Grip;
use crate::sensitivity::moving_root;
use crate::{ModelWorkspace, SolveInfo, Unsolved, Wrench};

/// The equations of a point with its lubricant.
#[derive(Clone, Copy)]
struct Wet<'a, P = f64> {
    ball: Rolling<'a, P>,
    wetted: &'a Wetted<P>,
    /// Part of the friction that comes from the lubricant; the rest has one coefficient.
    part: f64,
}

impl<P: Scalar> Wet<'_, P> {
    /// Contacts, motion, and what ball and races do to each other.
    fn state<D: Lanes<P>>(&self, y: &[D; BALL]) -> Result<(State<D>, [Rub<D>; 2]), EvalError> {
        crate::cost::evaluated();
        let Self { ball, wetted, part } = self;
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
    /// One damped Newton solve from `y`.
    fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace, steps: &mut usize) -> Report {
        let weights = self.ball.weights(y);
        let options = self.ball.options();
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
            match here.solved(near.unknowns, newton, steps) {
                Ok(root) => return Ok(root),
                Err(none) => failure = none,
            }
            let stride = Stride { first: 0.25, shortest: 0.01 };
            let oiled = |wet: &Self, part| Self { part, ..*wet };
            let way = (0.0, 1.0, stride);
            if let Some(root) = here.followed(near.unknowns, way, oiled, newton, steps) {
                return Ok(root);
            }
        }
        let gripping = self.ball.unknowns(&grip.loaded, &grip.to_nut);
        let stride = Stride { first: 1.0, shortest: 0.05 };
        let lowered =
            |wet: &Self, log: f64| Self { ball: Rolling { creep: log.exp(), ..wet.ball }, ..*wet };
        let way = (0.0, self.ball.creep.ln(), stride);
        self.followed(gripping, way, lowered, newton, steps).ok_or(failure)
    }
}

equations!(Wet<'_>, BALL, Wet::residual, ROWS);

/// A root, the point with its friction scale, and the gripping ball that the search began with.
struct Place {
    pair: ElasticBall,
    grip: Grip,
    root: Root,
    plans: [Plan; 2],
    steps: usize,
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
        let ball = |rule| Rolling::of_pair(&pair, rule, creep);
        let wet = |ball| Wet { ball, wetted, part: 1.0 };
        let coarse = Rolling { enough: NEAR, ..ball(&rules[places[0]].rule) };
        let mut steps = grip.steps;
        let near = coarse.search(&grip, false, (newton, path), &mut steps).ok();
        let [rough, smooth, rule] = oil.rules([COARSE, SEARCH, self.accuracy]);
        let oiled = wet(Rolling { enough: NEAR, ..ball(rough) });
        let found = oiled.search(near.as_ref(), &grip, newton, &mut steps);
        let root = if let Ok(root) = found {
            root
        } else {
            let search = ball(&rules[places[1]].rule);
            let near = search.search(&grip, true, (newton, path), &mut steps).ok();
            wet(ball(smooth)).search(near.as_ref(), &grip, newton, &mut steps)?
        };
        let fine = ball(rule).of(&root);
        let plans = fine.plans(&root.unknowns).ok_or(Unsolved::LOST)?;
        let fine = wet(Rolling { plans: Some(&plans), ..fine });
        let root = fine.solved(root.unknowns, newton, &mut steps)?;
        Ok(Place { pair, grip, root, plans, steps })
    }

    /// The steady ball with a lubricant.
    pub(crate) fn lubricated(
        &self,
        wetted: &Wetted,
        work: &mut TractionWorkspace,
        oil: &mut LubricatedWorkspace,
    ) -> Result<Found, Unsolved> {
        let Place { pair, grip, root, plans, steps } = self.wet_root(wetted, work, oil)?;
        let creep = self.creep * pair.slip_scale();
        let ball = Rolling::of_pair(&pair, oil.rule(self.accuracy), creep).of(&root);
        let ball = Rolling { plans: Some(&plans), ..ball };
        let (State { loaded, to_nut, wrench, .. }, rubs) =
            Wet { ball, wetted, part: 1.0 }.state(&root.unknowns).map_err(refused)?;
        let unit = unit_powers(&pair, &loaded, &to_nut, creep, [0, 1].map(|i| ball.nodes(i)));
        let torque = self.at.screw_torque(&pair, &loaded.frame, &wrench[1]);
        let info = SolveInfo { steps, residual: root.residual };
        let steady = Steady { loaded, to_nut, rubs, torque };
        Ok(Found { skid: grip.skid(&pair), pair, steady, unit, info, control: None })
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
        let (newton, quadrature) = (&mut traction.newton, lubricated.rule(self.accuracy));
        let ball = Rolling::of_pair(&pair, quadrature, creep).of(&root);
        let ball = Rolling { plans: Some(&plans), ..ball };
        let Rolling { plans, enough, at_nut, .. } = ball;
        let moving = Wet {
            ball: Rolling { pair: &inputs, quadrature, plans, creep, enough, at_nut },
            wetted,
            part: 1.0,
        };
        let system = Wet { ball, wetted: values, part: 1.0 };
        let residual = |y: &_| moving.residual(y);
        let weights = ball.weights(&root.unknowns);
        let y = moving_root(&system, &root.unknowns, &weights, residual, newton)?;
        let (State { loaded, to_nut, wrench, .. }, rubs) = moving.state(&y).map_err(refused)?;
        let torque = self.at.screw_torque(&inputs, &loaded.frame, &wrench[1]);
        Ok((inputs, Steady { loaded, to_nut, rubs, torque }))
    }
}
