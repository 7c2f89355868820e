//! A ball that its neighbours in the train push on.
//!
//! Theory: `docs/theory/20-ball-train.md`, equations (O1) to (O5).

use std::f64::consts::TAU;

use bsm_kin::{BallFrame, Motion, Over, Scalar};
use bsm_newton::{Continuation, Equations, EvalError, Scales, follow, solve};

use super::columns::Watched;
use super::lubricated::{ENOUGH, ScaledRoot};
use super::{Lubrication, SlipBall, SlipRoot, Start, Traction};
use crate::contact::{POWER_BALANCE_TOL, Wrench};
use crate::models::ball::unknown::PRECESSION;
use crate::models::ball::{BALL, BallLoads, EhlPoint, ElasticBall, ElasticPoint, ROWS, Workspace};
use crate::models::raceway_control::RollingBall;
use crate::models::workspace::ModelWorkspace;

/// Normal forces of both neighbours over the axial load of the ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    /// Of the neighbour in front, in the direction of travel.
    front: f64,
    /// Of the one behind.
    back: f64,
    /// Coefficient between balls.
    friction: f64,
}

impl Push {
    /// Force and moment on the ball.
    fn wrench<P: Scalar, D: Over<P>>(
        &self,
        pair: &ElasticBall<P>,
        frame: &BallFrame<D>,
        to_nut: &Motion<D>,
    ) -> Wrench<D> {
        let rolling = to_nut.across_groove(&frame.k);
        let speed = rolling.dot(&rolling).sqrt();
        let normal = D::from(self.front + self.back);
        // M_b = −f_b r_b (N_f + N_b) e                                    (O2)
        let moment = rolling * -pair.signed(normal * self.friction / speed);
        // F_b = [s (N_b − N_f) − (M_b·k)/d] t                             (O3)
        let along =
            pair.signed(D::from(self.back - self.front)) - moment.dot(&frame.k) / D::from(pair.arc);
        Wrench { force: BallFrame::tangent() * along, moment }
    }

    /// Adds force and moment to the rows of the balance.
    pub(super) fn add_to<P: Scalar, D: Over<P>>(
        &self,
        left: &mut [D; BALL],
        pair: &ElasticBall<P>,
        (loaded, to_nut): (&BallLoads<D>, &Motion<D>),
    ) {
        let Wrench { force, moment } = self.wrench(pair, &loaded.frame, to_nut);
        for (left, part) in left.iter_mut().zip(force.iter().chain(moment.iter())) {
            *left += *part;
        }
    }
}

/// A ball that is held at the speed of the train: the force of the neighbour behind takes the place of the precession.
struct HeldBall<'a> {
    ball: &'a SlipBall<'a>,
    push: Push,
    /// Precession as the unknowns of the ball have it.
    precession: f64,
}

impl HeldBall<'_> {
    /// The ball and its unknowns at those of the held one.
    fn moving(&self, x: &[f64; BALL]) -> (SlipBall<'_>, [f64; BALL]) {
        let mut y = *x;
        y[PRECESSION] = self.precession;
        let push = Push { back: x[PRECESSION], ..self.push };
        (SlipBall { push: Some(push), ..*self.ball }, y)
    }
}

impl Equations<BALL> for HeldBall<'_> {
    fn residual(&self, x: &[f64; BALL]) -> Result<[f64; BALL], EvalError> {
        let (ball, y) = self.moving(x);
        Ok(ball.evaluated::<false>(&y)?.left)
    }

    fn linearize(
        &self,
        x: &[f64; BALL],
        rows: &mut [[f64; BALL]; BALL],
    ) -> Result<[f64; BALL], EvalError> {
        let (ball, y) = self.moving(x);
        let found = ball.evaluated::<true>(&y)?;
        let by_push = ball.by_push(&y, [0.0, 1.0], self.push.friction)?;
        for ((to, from), by_push) in rows.iter_mut().zip(&found.rows).zip(by_push) {
            to.copy_from_slice(&from[..BALL]);
            to[PRECESSION] = by_push;
        }
        Ok(found.left)
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
        let mut by_push = [0.0; BALL];
        Push { front, back, friction }.add_to(
            &mut by_push,
            self.pair,
            (&loaded, &self.motion_to_nut(y, &loaded)),
        );
        Ok(by_push)
    }
}

/// A ball of a train by [`Traction`], of which the motion without pushes is known.
#[derive(Debug, Clone)]
pub struct TrainBall {
    pair: ElasticBall,
    ehl: Option<EhlPoint>,
    accuracy: f64,
    creep: f64,
    at_nut: bool,
    /// Axial load \[N\], ball radius \[m\] and relative speed \[rad/s\].
    units: [f64; 3],
    /// Coefficient between balls.
    contact_friction: f64,
    free: TrainMotion,
    compliances: [f64; 2],
}

/// The steady motion of a ball of a train, with the forces of its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainMotion {
    unknowns: [f64; BALL],
    /// `$(P - \Omega_n)/W$`, positive.
    pub rate: f64,
    /// Torque on the screw of its contact \[N·m\].
    pub screw_torque: f64,
    /// Power lost at both races \[W\].
    pub race_power: f64,
    /// Speed of rotation against the neighbours `$|w|$` (O1) \[rad/s\].
    pub rotation: f64,
    /// Normal loads at nut and screw \[N\].
    pub loads: [f64; 2],
    /// Normal forces of the neighbours in front and behind \[N\].
    pub pushes: [f64; 2],
    /// Axial force of the neighbours on the ball `$F_b \cdot k$` \[N\].
    pub axial_push: f64,
}

impl Traction {
    /// The ball without pushes, ready for them; `None` without a steady motion.
    ///
    /// * `contact_friction`: coefficient between balls.
    pub fn in_train(&self, contact_friction: f64, work: &mut ModelWorkspace) -> Option<TrainBall> {
        let pair = self.at.scaled().ok()?;
        let grip = RollingBall::of(&pair, None, &mut work.traction.statics);
        let start = Start::new(&pair, grip.ok().as_ref()).ok()?;
        let root = self.found(&start, None, &mut work.traction).ok()?.root;
        TrainBall::of(self, (pair, None), &root, contact_friction, work)
    }

    /// The same with a lubricant.
    pub(crate) fn lubricated_in_train(
        &self,
        ehl: &EhlPoint,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainBall> {
        let ModelWorkspace { traction, lubricated, .. } = work;
        let ScaledRoot { pair, refined, .. } =
            self.lubricated_root(ehl, traction, lubricated).ok()?;
        TrainBall::of(self, (pair, Some(*ehl)), &refined.root, contact_friction, work)
    }
}

impl TrainBall {
    fn of(
        case: &Traction,
        (pair, ehl): (ElasticBall, Option<EhlPoint>),
        root: &SlipRoot,
        contact_friction: f64,
        work: &mut ModelWorkspace,
    ) -> Option<Self> {
        let ElasticPoint { point, .. } = case.at;
        let free = TrainMotion {
            unknowns: root.unknowns,
            rate: 0.0,
            screw_torque: 0.0,
            race_power: 0.0,
            rotation: 0.0,
            loads: [0.0; 2],
            pushes: [0.0; 2],
            axial_push: 0.0,
        };
        let mut ball = Self {
            pair,
            ehl,
            accuracy: case.accuracy,
            creep: case.creep * pair.slip_scale(),
            at_nut: root.at_nut,
            units: [point.load.axial, point.ball.radius, point.drive.relative_speed()],
            contact_friction,
            free,
            compliances: [0.0; 2],
        };
        ball.free = ball.pushed(&free, [0.0; 2], work)?;
        ball.compliances = ball.compliances_at(&ball.free, work)?;
        Some(ball)
    }

    /// Its motion without pushes.
    pub fn free(&self) -> &TrainMotion {
        &self.free
    }

    /// Coefficient of friction at the races; of a lubricant the largest that it takes.
    pub fn friction(&self) -> f64 {
        self.pair.friction
    }

    /// What it can give in a push before it slides on both races, without pushes \[N\].
    pub fn sliding_push(&self) -> f64 {
        self.friction() * self.free.loads.iter().sum::<f64>()
    }

    /// Growth of the rate by the forces of the neighbours in front and behind, without pushes (O5) \[1/N\].
    pub fn compliances(&self) -> [f64; 2] {
        self.compliances
    }

    /// The same at a motion of this ball.
    pub fn compliances_at(
        &self,
        motion: &TrainMotion,
        work: &mut ModelWorkspace,
    ) -> Option<[f64; 2]> {
        let [load, ..] = self.units;
        let y = &motion.unknowns;
        let push = self.push(motion.pushes);
        self.with(work, |ball, newton| {
            let ball = SlipBall { push: Some(push), ..*ball };
            newton.linearize(&Watched::new(&ball), y, &ball.weights(y)).ok()?;
            let mut by = |sides| {
                let by_push = ball.by_push(y, sides, push.friction).ok()?;
                // c = −[J⁻¹ dr/dG]_p                                      (O5)
                let change = newton.correction(&by_push).ok()?;
                Some(change[PRECESSION] / load)
            };
            Some([by([1.0, 0.0])?, by([0.0, 1.0])?])
        })
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
        let plans = Default::default();
        let ball = SlipBall::of_pair(&self.pair, dry, self.creep);
        let ball = SlipBall { plans: Some(&plans), at_nut: self.at_nut, ..ball };
        match &self.ehl {
            None => solve(&ball, newton),
            Some(ehl) => {
                let lubrication = Some(Lubrication { ehl, part: 1.0, complete: false });
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
        let mut y = from.unknowns;
        let begin = from.pushes;
        self.with(work, |ball, newton| {
            let stride = Continuation { first: 1.0, shortest: 0.02 };
            follow(&mut y, (0.0, 1.0), stride, |part, y| {
                let push = self.push([0, 1].map(|i| begin[i] + (pushes[i] - begin[i]) * part));
                SlipBall { push: Some(push), ..*ball }.run(y, newton).converged()
            })
            .ok()?;
            self.motion(ball, y, pushes)
        })
    }

    /// Its motion at the rate of the train and the force of the neighbour in front \[N\], of which that of the neighbour
    /// behind follows; below zero it is a pull. `None` if it is not found.
    ///
    /// * `from`: a motion nearby.
    pub fn held(
        &self,
        from: &TrainMotion,
        rate: f64,
        front: f64,
        work: &mut ModelWorkspace,
    ) -> Option<TrainMotion> {
        let [load, ..] = self.units;
        let [begin, back] = from.pushes;
        let mut x = from.unknowns;
        x[PRECESSION] = back / load;
        self.with(work, |ball, newton| {
            let stride = Continuation { first: 1.0, shortest: 0.02 };
            let offset = self.pair.nut_speed - ball.offset();
            follow(&mut x, (0.0, 1.0), stride, |part, x| {
                let rate = from.rate + (rate - from.rate) * part;
                let push = self.push([begin + (front - begin) * part, f64::NAN]);
                let held = HeldBall { ball, push, precession: rate + offset };
                let (_, y) = held.moving(x);
                let scales = Scales { x: &[1.0; BALL], f: &ball.weights(&y) };
                solve(&held, x, &scales, &ball.options(), newton).converged()
            })
            .ok()?;
            let back = x[PRECESSION] * load;
            x[PRECESSION] = rate + offset;
            self.motion(ball, x, [front, back])
        })
    }

    /// In SI units, of the unknowns under these pushes.
    fn motion(
        &self,
        ball: &SlipBall<'_>,
        unknowns: [f64; BALL],
        pushes: [f64; 2],
    ) -> Option<TrainMotion> {
        let [load, radius, speed] = self.units;
        let push = self.push(pushes);
        let loaded = ball.loaded(&unknowns).ok()?;
        let to_nut = ball.motion_to_nut(&unknowns, &loaded);
        let axial_push = push.wrench(&self.pair, &loaded.frame, &to_nut).force.dot(&loaded.frame.k);
        let found = ball.evaluated::<false>(&unknowns).ok()?;
        let motion = TrainMotion {
            unknowns,
            rate: to_nut.precession,
            screw_torque: found.transmitted.torque * radius * load,
            race_power: found.transmitted.power * radius * load * speed,
            rotation: to_nut.across_groove(&loaded.frame.k).norm() * speed.abs(),
            loads: loaded.loads.map(|part| part * load),
            pushes,
            axial_push: axial_push * load,
        };
        self.is_balanced(&motion).then_some(motion)
    }

    /// Power that screw and load put into a motion of it \[W\].
    pub fn power_in(&self, motion: &TrainMotion) -> f64 {
        let [load, radius, speed] = self.units;
        let per_radian = self.pair.helix.lead() * radius / TAU;
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
        let travel = self.pair.arc * radius * motion.rate * speed.abs();
        let rubbed = self.contact_power(motion);
        // (T − h (F_j + F_b·k)) W = P_races + f_b r_b (N_f + N_b)|w| − (N_b − N_f) v  (O4)
        let left = self.power_in(motion) - motion.race_power - rubbed + (back - front) * travel;
        let size = (motion.screw_torque * speed).abs() + motion.race_power + rubbed;
        left.abs() <= POWER_BALANCE_TOL * size
    }
}
