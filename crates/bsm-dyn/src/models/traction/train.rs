//! A ball that its neighbours in the train push on.
//!
//! Theory: `docs/theory/20-ball-train.md`, equations (O1) to (O5).

use std::array::from_fn;
use std::f64::consts::TAU;

use bsm_kin::{Jet, Motion};
use bsm_newton::{Continuation, Equations, EvalError, Linearized, Outcome, Scales, follow, solve};

use super::Traction;
use super::equations::{Evaluation, Lubrication, PowerFlow, SlipBall};
use super::lubricated::ENOUGH;
use super::push::Push;
use super::root::LARGE_INERTIA;
use crate::contact::POWER_BALANCE_TOL;
use crate::models::ball::unknown::PRECESSION;
use crate::models::ball::{
    BALL, BallState, EhlPoint, ElasticContacts, ElasticPoint, ROWS, Workspace, variables,
};
use crate::models::workspace::ModelWorkspace;

/// Of the pushes where one step does not do.
const STRIDE: Continuation = Continuation { first: 1.0, shortest: 0.02 };

/// A ball that is held at the speed of the train: the force of the neighbour behind takes the place of the precession.
struct TrainEquations<'a> {
    ball: &'a SlipBall<'a>,
    push: Push,
    /// Precession as the unknowns of the ball have it.
    precession: f64,
}

impl TrainEquations<'_> {
    /// The ball and its unknowns at those of the held one.
    fn moving(&self, x: &[f64; BALL]) -> (SlipBall<'_>, [f64; BALL]) {
        let mut y = *x;
        y[PRECESSION] = self.precession;
        let push = Push { back: x[PRECESSION], ..self.push };
        (SlipBall { push: Some(push), ..*self.ball }, y)
    }
}

impl Equations<BALL> for TrainEquations<'_> {
    /// Power transmitted by the screw.
    type Details = PowerFlow;
    /// Derivatives of the equations with respect to the precession.
    type Slopes = [f64; BALL];

    fn residual(&self, x: &[f64; BALL]) -> Result<([f64; BALL], PowerFlow), EvalError> {
        let (ball, y) = self.moving(x);
        let found: Evaluation = ball.evaluated(&y)?;
        Ok((found.residual, found.power_flow()))
    }

    fn linearize(&self, x: &[f64; BALL], rows: &mut [[f64; BALL]; BALL]) -> Linearized<BALL, Self> {
        let (ball, y) = self.moving(x);
        let found: Evaluation<Jet<BALL>> = ball.evaluated(&variables(&y))?;
        let by_push = ball.by_push(&y, [0.0, 1.0], self.push.friction)?;
        for ((to, from), by_push) in rows.iter_mut().zip(&found.residual).zip(by_push) {
            *to = from.eps;
            to[PRECESSION] = by_push;
        }
        let by_precession = found.residual.map(|row| row.eps[PRECESSION]);
        Ok((found.residual.map(|row| row.re), found.power_flow(), by_precession))
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}

impl SlipBall<'_> {
    /// Derivative of the equations in a direction of the forces of both neighbours, in which they are linear.
    fn by_push(
        &self,
        y: &[f64; BALL],
        [front, back]: [f64; 2],
        friction: f64,
    ) -> Result<[f64; BALL], EvalError> {
        let loaded = self.loaded(y)?;
        let mut residual = [0.0; BALL];
        let to_nut = self.motion_to_nut(y, &loaded);
        let push = Push { front, back, friction };
        push.add_to(&mut residual, self.contacts, (&loaded, &to_nut));
        Ok(residual)
    }
}

/// A ball of a train by [`Traction`], of which the motion without pushes is known.
#[derive(Debug, Clone)]
pub struct TrainBall {
    contacts: ElasticContacts,
    ehl: Option<EhlPoint>,
    accuracy: f64,
    creep: f64,
    nut_chart: bool,
    /// Axial load \[N\], ball radius \[m\] and relative speed \[rad/s\].
    units: [f64; 3],
    /// Coefficient between balls.
    contact_friction: f64,
    free: TrainMotion,
}

/// The steady motion of a ball of a train, with the forces of its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainMotion {
    unknowns: [f64; BALL],
    /// Their derivatives by the forces of the neighbours in front and behind \[1/N\].
    by_pushes: [[f64; BALL]; 2],
    /// `$(P - \Omega_n)/W$`, positive.
    pub rate: f64,
    /// Torque on the screw of its contact \[N·m\].
    pub screw_torque: f64,
    /// Power lost at both raceways \[W\].
    pub raceway_power: f64,
    /// Speed of rotation against the neighbours `$|w|$` (O1) \[rad/s\].
    pub rotation: f64,
    /// Normal loads at nut and screw \[N\].
    pub loads: [f64; 2],
    /// Normal forces of the neighbours in front and behind \[N\].
    pub pushes: [f64; 2],
    /// Axial force of the neighbours on the ball `$F_b \cdot k$` \[N\].
    pub axial_push: f64,
}

impl TrainMotion {
    /// Growth of the rate by the forces of the neighbours in front and behind (O5) \[1/N\].
    pub fn compliances(&self) -> [f64; 2] {
        self.by_pushes.map(|by| by[PRECESSION])
    }

    /// The unknowns under other forces of the neighbours \[N\], as far as they are linear in them.
    fn at_pushes(&self, pushes: [f64; 2]) -> [f64; BALL] {
        let mut y = self.unknowns;
        for (by, (push, before)) in self.by_pushes.iter().zip(pushes.iter().zip(self.pushes)) {
            for (y, by) in y.iter_mut().zip(by) {
                *y += by * (push - before);
            }
        }
        y
    }

    /// The push of the neighbour behind at another rate and another push in front, as far as it is linear in them \[N\].
    pub fn back_push(&self, rate: f64, front: f64) -> f64 {
        let ([by_front, by_back], [before, back]) = (self.compliances(), self.pushes);
        back + (rate - self.rate - by_front * (front - before)) / by_back
    }
}

impl Traction {
    /// The ball of a train; `None` if its state is not steady.
    ///
    /// * `free`: the ball without pushes. * `contact_friction`: coefficient between balls.
    pub fn in_train(
        &self,
        free: &BallState,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainBall> {
        TrainBall::of(self, None, free, contact_friction, work)
    }
}

impl TrainBall {
    /// * `ehl`: of a lubricated ball. * `free`: the ball without pushes.
    pub(crate) fn of(
        case: &Traction,
        ehl: Option<&EhlPoint>,
        free: &BallState,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<Self> {
        let ElasticPoint { point, .. } = case.at;
        let units @ [load, _, speed] =
            [point.load.axial, point.ball.radius, point.drive.relative_speed()];
        let contacts = case.at.scaled().ok()?;
        let creep = case.creep * contacts.slip_scale();
        let [nut, screw] = [&free.nut, &free.screw];
        let loads = [nut.load? / load, screw.load? / load];
        let loaded = contacts.loaded(loads, 0.5 * (screw.angle - nut.angle)).ok()?;
        let Motion { precession, omega } = free.motion?;
        let turning = Motion { precession, omega: loaded.frame.from_frenet(&omega) };
        let turning = turning.relative_to(point.drive.nut_speed, &loaded.frame);
        let to_nut =
            Motion { precession: turning.precession / speed, omega: turning.omega / speed };
        let scale = ehl.map(|ehl| ehl.friction_scale(&contacts, &loaded, &to_nut, creep));
        let contacts = scale.map_or(contacts, |scale| contacts.with_friction(scale));
        let rate = to_nut.precession + contacts.scaled.nut_speed;
        let mut ball = Self {
            contacts,
            ehl: ehl.copied(),
            accuracy: case.accuracy,
            creep,
            nut_chart: contacts.inertia_ratio() * rate * rate > LARGE_INERTIA,
            units,
            contact_friction,
            free: TrainMotion {
                unknowns: [0.0; BALL],
                by_pushes: [[0.0; BALL]; 2],
                rate: to_nut.precession,
                screw_torque: 0.0,
                raceway_power: 0.0,
                rotation: 0.0,
                loads: [0.0; 2],
                pushes: [0.0; 2],
                axial_push: 0.0,
            },
        };
        ball.free.unknowns = ball.with(work, |ball, _| ball.unknowns(&loaded, &to_nut));
        ball.free = ball.pushed(&ball.free, [0.0; 2], work)?;
        Some(ball)
    }

    /// Its motion without pushes.
    pub fn free(&self) -> &TrainMotion {
        &self.free
    }

    /// Coefficient of friction at the raceways; of a lubricant the largest that it takes.
    pub fn friction(&self) -> f64 {
        self.contacts.friction
    }

    /// What it can give in a push before it slides on both raceways, without pushes \[N\].
    pub fn sliding_push(&self) -> f64 {
        self.friction() * self.free.loads.iter().sum::<f64>()
    }

    /// These forces of the neighbours in front and behind \[N\].
    fn push(&self, pushes: [f64; 2]) -> Push {
        let [load, ..] = self.units;
        let [front, back] = pushes.map(|push| push / load);
        Push { front, back, friction: self.contact_friction }
    }

    /// The equations, and what they are solved with.
    fn with<R>(
        &self,
        ModelWorkspace { traction, lubricated, .. }: &mut ModelWorkspace,
        solve: impl FnOnce(&SlipBall<'_>, &mut Workspace) -> R,
    ) -> R {
        let (accuracy, newton) = ([self.accuracy], &mut traction.newton);
        let ([[dry, _]], [[oil, _]]) =
            (traction.rules.dry(accuracy), lubricated.oil.of_oil(accuracy));
        let frozen_rules = Default::default();
        let ball = SlipBall::of_contacts(&self.contacts, dry, self.creep);
        let ball =
            SlipBall { frozen_rules: Some(&frozen_rules), nut_chart: self.nut_chart, ..ball };
        match &self.ehl {
            None => solve(&ball, newton),
            Some(ehl) => {
                let lubrication = Some(Lubrication { ehl, fraction: 1.0, complete: false });
                let ball = SlipBall { quadrature: oil, enough: ENOUGH, lubrication, ..ball };
                solve(&ball, newton)
            }
        }
    }

    /// Its motion under given forces of the neighbours in front and behind \[N\]; `None` if that is not found.
    ///
    /// * `from`: a motion nearby.
    pub fn pushed(
        &self,
        from: &TrainMotion,
        pushes: [f64; 2],
        work: &mut ModelWorkspace,
    ) -> Option<TrainMotion> {
        let begin = from.pushes;
        let solved = |is_near: bool, ball: &SlipBall<'_>, newton: &mut Workspace| {
            let under = |fraction: f64| {
                let push = [0, 1].map(|i| begin[i] + (pushes[i] - begin[i]) * fraction);
                SlipBall { push: Some(self.push(push)), ..*ball }
            };
            let (mut y, pushed) = (from.unknowns, under(1.0));
            let mut details = None;
            let mut run = |fraction, y: &mut _| {
                let outcome = under(fraction).run(y, newton);
                let converged = outcome.converged();
                details = outcome.last;
                converged
            };
            if is_near {
                y = from.at_pushes(pushes);
                run(1.0, &mut y).then_some(())?;
            } else {
                follow(&mut y, (0.0, 1.0), STRIDE, run).ok()?;
            }
            let (_, transmitted) = details?;
            let [load, ..] = self.units;
            let mut by = |sides| {
                let by_push = pushed.by_push(&y, sides, self.contact_friction).ok()?;
                // c = −[J⁻¹ dr/dG]_p                                      (O5)
                Some(newton.correction(&by_push).ok()?.map(|by| by / load))
            };
            let by_pushes = [by([1.0, 0.0])?, by([0.0, 1.0])?];
            self.motion(ball, (y, by_pushes), pushes, &transmitted)
        };
        self.attempts(work, solved)
    }

    /// From the state that the slopes of another lead to, then along the path from there: each with nodes of its own.
    fn attempts(
        &self,
        work: &mut ModelWorkspace,
        solve: impl Fn(bool, &SlipBall<'_>, &mut Workspace) -> Option<TrainMotion>,
    ) -> Option<TrainMotion> {
        [true, false]
            .into_iter()
            .find_map(|is_near| self.with(work, |ball, newton| solve(is_near, ball, newton)))
    }

    /// Its motion at the rate of the train and the force of the neighbour in front \[N\], of which that of the neighbour
    /// behind follows; below zero it is a pull. `None` if it is not found.
    ///
    /// * `from`: a motion nearby.
    pub fn at_rate(
        &self,
        from: &TrainMotion,
        rate: f64,
        front: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainMotion> {
        let [load, ..] = self.units;
        let [begin, before] = from.pushes;
        let back = from.back_push(rate, front);
        let solved = |is_near: bool, ball: &SlipBall<'_>, newton: &mut Workspace| {
            let offset = self.contacts.scaled.nut_speed - ball.offset();
            let at = |fraction: f64| {
                let rate = from.rate + (rate - from.rate) * fraction;
                let push = self.push([begin + (front - begin) * fraction, f64::NAN]);
                TrainEquations { ball, push, precession: rate + offset }
            };
            let mut found = None;
            let mut run = |fraction, x: &mut _| {
                let equations = at(fraction);
                let scales = Scales { x: &[1.0; BALL], f: &ball.weights(&equations.moving(x).1) };
                let Outcome { report, last, slopes } =
                    solve(&equations, x, &scales, &ball.options(), newton);
                found = last.zip(slopes);
                report.converged()
            };
            let unknowns = |y: [f64; BALL], back: f64| {
                from_fn(|i| if i == PRECESSION { back / load } else { y[i] })
            };
            let mut x = unknowns(from.unknowns, before);
            if is_near {
                x = unknowns(from.at_pushes([front, back]), back);
                run(1.0, &mut x).then_some(())?;
            } else {
                follow(&mut x, (0.0, 1.0), STRIDE, run).ok()?;
            }
            let ((_, transmitted), by_precession) = found?;
            let equations = at(1.0);
            let (moving, y) = equations.moving(&x);
            let by_front = moving.by_push(&y, [1.0, 0.0], self.contact_friction).ok()?;
            // Of all unknowns but the rate, and of the push behind, by the rate and by the push in front.
            let by_rate = newton.correction(&by_precession).ok()?;
            let by_front = newton.correction(&by_front).ok()?;
            // dp/dN_b = 1/(dN_b/dp),  dp/dN_f = −(dN_b/dN_f)/(dN_b/dp)
            let by_back = by_rate[PRECESSION].recip();
            let rate_by = [-by_front[PRECESSION] * by_back, by_back];
            let by_pushes = [0, 1].map(|side| {
                let by = |i| match i {
                    PRECESSION => rate_by[side],
                    _ if side == 0 => by_front[i] + by_rate[i] * rate_by[0],
                    _ => by_rate[i] * rate_by[1],
                };
                from_fn(|i| by(i) / load)
            });
            self.motion(ball, (y, by_pushes), [front, x[PRECESSION] * load], &transmitted)
        };
        self.attempts(work, solved)
    }

    /// In SI units, of the unknowns under these pushes.
    ///
    /// * `by_pushes`: their derivatives. * `transmitted`: by the screw.
    fn motion(
        &self,
        ball: &SlipBall<'_>,
        (unknowns, by_pushes): ([f64; BALL], [[f64; BALL]; 2]),
        pushes: [f64; 2],
        transmitted: &PowerFlow,
    ) -> Option<TrainMotion> {
        let [load, radius, speed] = self.units;
        let push = self.push(pushes);
        let loaded = ball.loaded(&unknowns).ok()?;
        let to_nut = ball.motion_to_nut(&unknowns, &loaded);
        let axial_push =
            push.wrench(&self.contacts, &loaded.frame, &to_nut).force.dot(&loaded.frame.k);
        let motion = TrainMotion {
            unknowns,
            by_pushes,
            rate: to_nut.precession,
            screw_torque: transmitted.torque * radius * load,
            raceway_power: transmitted.power * radius * load * speed,
            rotation: to_nut.across_groove(&loaded.frame.k).norm() * speed.abs(),
            loads: loaded.loads.map(|fraction| fraction * load),
            pushes,
            axial_push: axial_push * load,
        };
        self.is_balanced(&motion).then_some(motion)
    }

    /// Power that screw and load put into a motion of it \[W\].
    pub fn power_in(&self, motion: &TrainMotion) -> f64 {
        let [load, radius, speed] = self.units;
        let per_radian = self.contacts.helix.lead() * radius / TAU;
        (motion.screw_torque - per_radian * (load + motion.axial_push)) * speed
    }

    /// Power that friction of the neighbours takes \[W\].
    pub fn contact_power(&self, motion: &TrainMotion) -> f64 {
        let [_, radius, _] = self.units;
        let [front, back] = motion.pushes;
        self.contact_friction * radius * (front + back) * motion.rotation
    }

    /// Whether the powers of a motion balance: far beyond what a ball can take Newton's method may end where they do not.
    fn is_balanced(&self, motion: &TrainMotion) -> bool {
        let [_, radius, speed] = self.units;
        let [front, back] = motion.pushes;
        let travel = self.contacts.scaled.arc * radius * motion.rate * speed.abs();
        let friction_power = self.contact_power(motion);
        // (T − h (F_j + F_b·k)) W = P_raceways + f_b r_b (N_f + N_b)|w| − (N_b − N_f) v  (O4)
        let residual =
            self.power_in(motion) - motion.raceway_power - friction_power + (back - front) * travel;
        let size = (motion.screw_torque * speed).abs() + motion.raceway_power + friction_power;
        residual.abs() <= POWER_BALANCE_TOL * size
    }
}
