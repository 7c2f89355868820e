//! Motion of balls that push against each other in a ball train.
//!
//! Theory: `docs/theory/20-ball-train.md`, equations (O1) to (O5).

use std::array::from_fn;
use std::f64::consts::TAU;

use bsm_kin::{Jet, Motion};
use bsm_newton::{Continuation, Equations, EvalError, Linearized, Outcome, Scales, follow, solve};

use super::Traction;
use super::equations::{Evaluation, Lubrication, PowerFlow, SlipBall};
use super::lubricated::LUBRICATED_RESIDUAL_GOAL;
use super::push::Push;
use super::root::LARGE_INERTIA;
use crate::contact::POWER_BALANCE_TOL;
use crate::models::ball::unknown::PRECESSION;
use crate::models::ball::{
    BALL_UNKNOWNS, BallState, EQUATION_NAMES, EhlPoint, ElasticContacts, ResultUnits, Workspace,
    variables,
};
use crate::models::workspace::ModelWorkspace;

/// Step control of the continuation from known to requested push forces. Step lengths are fractions
/// of the total change of the push forces.
const PUSH_STEPS: Continuation = Continuation { first_step: 1.0, min_step: 0.02 };

/// Equations of a ball that travels at the speed of its ball train. The precession rate is given.
/// The force from the ball behind takes its place as an unknown.
struct TrainEquations<'a> {
    ball: &'a SlipBall<'a>,
    push: Push,
    /// Given precession rate, with the same offset as the corresponding unknown of a free ball.
    precession: f64,
}

impl TrainEquations<'_> {
    /// Returns the equations of the free ball, and the unknowns of the free ball that correspond to
    /// the unknowns `x` of the ball in the train.
    fn moving(&self, x: &[f64; BALL_UNKNOWNS]) -> (SlipBall<'_>, [f64; BALL_UNKNOWNS]) {
        let mut y = *x;
        y[PRECESSION] = self.precession;
        let push = Push { back: x[PRECESSION], ..self.push };
        (SlipBall { push: Some(push), ..*self.ball }, y)
    }
}

impl Equations<BALL_UNKNOWNS> for TrainEquations<'_> {
    /// Torque on the screw, total friction power, and sliding powers.
    type Details = PowerFlow;
    /// Derivatives of the residuals with respect to the precession rate.
    type Slopes = [f64; BALL_UNKNOWNS];

    fn residual(
        &self,
        x: &[f64; BALL_UNKNOWNS],
    ) -> Result<([f64; BALL_UNKNOWNS], PowerFlow), EvalError> {
        let (ball, y) = self.moving(x);
        let found: Evaluation = ball.evaluated(&y)?;
        Ok((found.residual, found.power_flow()))
    }

    fn linearize(
        &self,
        x: &[f64; BALL_UNKNOWNS],
        rows: &mut [[f64; BALL_UNKNOWNS]; BALL_UNKNOWNS],
    ) -> Linearized<BALL_UNKNOWNS, Self> {
        let (ball, y) = self.moving(x);
        let found: Evaluation<Jet<BALL_UNKNOWNS>> = ball.evaluated(&variables(&y))?;
        let by_push = ball.by_push(&y, [0.0, 1.0], self.push.friction)?;
        for ((to, from), by_push) in rows.iter_mut().zip(&found.residual).zip(by_push) {
            *to = from.eps;
            to[PRECESSION] = by_push;
        }
        let by_precession = found.residual.map(|row| row.eps[PRECESSION]);
        Ok((found.residual.map(|row| row.re), found.power_flow(), by_precession))
    }

    fn equation(&self, i: usize) -> String {
        EQUATION_NAMES[i].to_owned()
    }
}

impl SlipBall<'_> {
    /// Returns the directional derivative of the residuals with respect to the forces of both
    /// neighbors. The residuals are linear in these forces.
    ///
    /// * `[front, back]`: direction, with one component each for the forces of the balls in front
    ///   and behind.
    fn by_push(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        [front, back]: [f64; 2],
        friction: f64,
    ) -> Result<[f64; BALL_UNKNOWNS], EvalError> {
        let loaded = self.loaded(y)?;
        let mut residual = [0.0; BALL_UNKNOWNS];
        let to_nut = self.motion_to_nut(y, &loaded);
        let push = Push { front, back, friction };
        push.add_to(&mut residual, self.contacts, (&loaded, &to_nut));
        Ok(residual)
    }
}

/// A ball in a ball train, solved by [`Traction`], together with its motion without push forces.
#[derive(Debug, Clone)]
pub struct TrainBall {
    contacts: ElasticContacts,
    ehl: Option<EhlPoint>,
    accuracy: f64,
    creep: f64,
    uses_nut_angle: bool,
    /// Factors that convert scaled results to SI units.
    units: ResultUnits,
    /// Friction coefficient between balls.
    contact_friction: f64,
    free: TrainMotion,
}

/// Steady motion of a ball in a ball train under the forces of its neighbors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainMotion {
    unknowns: [f64; BALL_UNKNOWNS],
    /// Derivatives of the unknowns with respect to the forces of the ball in front and of the ball
    /// behind \[1/N\].
    by_pushes: [[f64; BALL_UNKNOWNS]; 2],
    /// Precession rate relative to the nut, `$(P - \Omega_n)/W$`, positive.
    pub rate: f64,
    /// Torque of the ball on the screw \[N·m\].
    pub screw_torque: f64,
    /// Power loss at both raceways \[W\].
    pub raceway_power: f64,
    /// Angular speed relative to the neighboring balls `$|w|$` (O1) \[rad/s\].
    pub rotation: f64,
    /// Normal loads at the nut and the screw \[N\].
    pub loads: [f64; 2],
    /// Normal forces of the ball in front and of the ball behind \[N\].
    pub pushes: [f64; 2],
    /// Axial force of the neighbors on the ball `$F_b \cdot k$` \[N\].
    pub axial_push: f64,
}

impl TrainMotion {
    /// Returns the derivatives of the precession rate with respect to the forces of the balls in
    /// front and behind \[1/N\] (O5).
    pub fn compliances(&self) -> [f64; 2] {
        self.by_pushes.map(|by| by[PRECESSION])
    }

    /// Extrapolates the unknowns linearly to different forces of the neighbors \[N\].
    fn at_pushes(&self, pushes: [f64; 2]) -> [f64; BALL_UNKNOWNS] {
        let mut y = self.unknowns;
        for (by, (push, before)) in self.by_pushes.iter().zip(pushes.iter().zip(self.pushes)) {
            for (y, by) in y.iter_mut().zip(by) {
                *y += by * (push - before);
            }
        }
        y
    }

    /// Extrapolates the force of the ball behind \[N\] linearly to a different precession rate and
    /// a different force of the ball in front \[N\].
    pub fn back_push(&self, rate: f64, front: f64) -> f64 {
        let ([by_front, by_back], [before, back]) = (self.compliances(), self.pushes);
        back + (rate - self.rate - by_front * (front - before)) / by_back
    }
}

impl Traction {
    /// Creates a ball in a ball train. Returns `None` if the motion of the ball without push forces
    /// is not found.
    ///
    /// * `free`: steady state of the ball without push forces.
    /// * `contact_friction`: friction coefficient between balls.
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
    /// Creates a ball in a ball train, with or without a lubricant. Returns `None` if the motion of
    /// the ball without push forces is not found.
    ///
    /// * `ehl`: lubricated operating point; `None` for a constant friction coefficient.
    /// * `free`: steady state of the ball without push forces.
    pub(crate) fn of(
        case: &Traction,
        ehl: Option<&EhlPoint>,
        free: &BallState,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<Self> {
        let point = case.screw.point;
        let units = point.units();
        let ResultUnits { load, speed, .. } = units;
        let contacts = case.screw.scaled().ok()?;
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
            uses_nut_angle: contacts.inertia_ratio() * rate * rate > LARGE_INERTIA,
            units,
            contact_friction,
            free: TrainMotion {
                unknowns: [0.0; BALL_UNKNOWNS],
                by_pushes: [[0.0; BALL_UNKNOWNS]; 2],
                rate: to_nut.precession,
                screw_torque: 0.0,
                raceway_power: 0.0,
                rotation: 0.0,
                loads: [0.0; 2],
                pushes: [0.0; 2],
                axial_push: 0.0,
            },
        };
        ball.free.unknowns = ball.with_equations(work, |ball, _| ball.unknowns(&loaded, &to_nut));
        ball.free = ball.pushed(&ball.free, [0.0; 2], work)?;
        Some(ball)
    }

    /// Returns the motion of the ball without push forces.
    pub fn free(&self) -> &TrainMotion {
        &self.free
    }

    /// Returns the friction coefficient at the raceways. For a lubricated ball, this is the upper
    /// limit of the friction coefficient.
    pub fn friction(&self) -> f64 {
        self.contacts.friction
    }

    /// Returns the push force \[N\] at which the ball slides on both raceways, calculated from its
    /// normal loads without push forces.
    pub fn sliding_push(&self) -> f64 {
        self.friction() * self.free.loads.iter().sum::<f64>()
    }

    /// Converts forces of the balls in front and behind \[N\] to scaled units.
    fn push(&self, pushes: [f64; 2]) -> Push {
        let load = self.units.load;
        let [front, back] = pushes.map(|push| push / load);
        Push { front, back, friction: self.contact_friction }
    }

    /// Calls `solve` with the equations of the ball and the buffers of Newton's method.
    fn with_equations<R>(
        &self,
        ModelWorkspace { traction, lubricated, .. }: &mut ModelWorkspace,
        solve: impl FnOnce(&SlipBall<'_>, &mut Workspace) -> R,
    ) -> R {
        let (accuracy, newton) = ([self.accuracy], &mut traction.newton);
        let ([dry], [oil]) = (traction.rules.dry(accuracy), lubricated.rules.of_oil(accuracy));
        let frozen_rules = Default::default();
        let ball = SlipBall::of_contacts(&self.contacts, &dry.rule, self.creep);
        let ball = SlipBall {
            frozen_rules: Some(&frozen_rules),
            uses_nut_angle: self.uses_nut_angle,
            ..ball
        };
        match &self.ehl {
            None => solve(&ball, newton),
            Some(ehl) => {
                let lubrication = Some(Lubrication { ehl, fraction: 1.0, complete: false });
                let ball = SlipBall {
                    quadrature: &oil.rule,
                    residual_goal: LUBRICATED_RESIDUAL_GOAL,
                    lubrication,
                    ..ball
                };
                solve(&ball, newton)
            }
        }
    }

    /// Returns the motion under given forces of the balls in front and behind \[N\], or `None` if
    /// the solver finds no motion.
    ///
    /// * `from`: known motion from which the solver starts.
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
                follow(&mut y, (0.0, 1.0), PUSH_STEPS, run).ok()?;
            }
            let (_, transmitted) = details?;
            let load = self.units.load;
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

    /// Returns the motion that `solve` finds from linearly extrapolated unknowns or, if this fails,
    /// by continuation. Each attempt determines its own node counts of the quadrature.
    ///
    /// * `solve`: solver; its first argument is true for the attempt with extrapolated unknowns.
    fn attempts(
        &self,
        work: &mut ModelWorkspace,
        solve: impl Fn(bool, &SlipBall<'_>, &mut Workspace) -> Option<TrainMotion>,
    ) -> Option<TrainMotion> {
        [true, false].into_iter().find_map(|is_near| {
            self.with_equations(work, |ball, newton| solve(is_near, ball, newton))
        })
    }

    /// Returns the motion of a ball for a given precession rate of the ball train and a given force
    /// from the ball in front \[N\], or `None` if the solver finds no motion.
    ///
    /// The force of the ball behind is part of the result. If this force is negative, the ball
    /// behind would have to pull.
    ///
    /// * `from`: known motion from which the solver starts.
    /// * `rate`: precession rate `$(P - \Omega_n)/W$` of the ball train.
    pub fn at_rate(
        &self,
        from: &TrainMotion,
        rate: f64,
        front: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainMotion> {
        let load = self.units.load;
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
                let scales =
                    Scales { x: &[1.0; BALL_UNKNOWNS], f: &ball.weights(&equations.moving(x).1) };
                let Outcome { report, last, slopes } =
                    solve(&equations, x, &scales, &ball.options(), newton);
                found = last.zip(slopes);
                report.converged()
            };
            let unknowns = |y: [f64; BALL_UNKNOWNS], back: f64| {
                from_fn(|i| if i == PRECESSION { back / load } else { y[i] })
            };
            let mut x = unknowns(from.unknowns, before);
            if is_near {
                x = unknowns(from.at_pushes([front, back]), back);
                run(1.0, &mut x).then_some(())?;
            } else {
                follow(&mut x, (0.0, 1.0), PUSH_STEPS, run).ok()?;
            }
            let ((_, transmitted), by_precession) = found?;
            let equations = at(1.0);
            let (moving, y) = equations.moving(&x);
            let by_front = moving.by_push(&y, [1.0, 0.0], self.contact_friction).ok()?;
            // The force of the ball behind replaces the precession rate as an unknown. `by_rate`
            // and `by_front` are the derivatives of the unknowns with respect to the precession
            // rate and to the force of the ball in front.
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

    /// Converts the unknowns of a ball into a motion in SI units. Returns `None` if a contact is
    /// lost or the power balance is violated.
    ///
    /// * `by_pushes`: derivatives of the unknowns with respect to the push forces.
    /// * `transmitted`: torque on the screw, and friction powers.
    fn motion(
        &self,
        ball: &SlipBall<'_>,
        (unknowns, by_pushes): ([f64; BALL_UNKNOWNS], [[f64; BALL_UNKNOWNS]; 2]),
        pushes: [f64; 2],
        transmitted: &PowerFlow,
    ) -> Option<TrainMotion> {
        let ResultUnits { length: radius, load, speed, .. } = self.units;
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

    /// Returns the net power \[W\] that the screw and the axial forces supply to the ball in a
    /// given motion.
    pub fn power_in(&self, motion: &TrainMotion) -> f64 {
        let ResultUnits { length: radius, load, speed, .. } = self.units;
        let per_radian = self.contacts.helix.lead() * radius / TAU;
        (motion.screw_torque - per_radian * (load + motion.axial_push)) * speed
    }

    /// Returns the friction power between the ball and its neighbors \[W\].
    pub fn contact_power(&self, motion: &TrainMotion) -> f64 {
        let [front, back] = motion.pushes;
        self.contact_friction * self.units.length * (front + back) * motion.rotation
    }

    /// Returns true if a motion satisfies the power balance of the ball (O4).
    ///
    /// If the push forces far exceed the forces that a ball can withstand, Newton's method may
    /// converge to a state that violates the power balance.
    fn is_balanced(&self, motion: &TrainMotion) -> bool {
        let ResultUnits { length: radius, speed, .. } = self.units;
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
