//! One ball with up to four contacts in the gothic arches of nut and screw, with friction in its balance.
//!
//! Friction across the grooves moves the ball sideways. If the play is small, the ball then touches the far flank of
//! one groove: the third contact.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC1) to (AC9).

mod balance;
mod grooves;
mod pair;

use std::array::from_fn;

use bsm_kin::{BallFrame, Jet, Motion, Scalar, Site};
use bsm_newton::{Continuation, Convergence, EvalError, JacobianUpdate, Options, follow};

use self::balance::{ArchState, Balance, FrozenRules, Pressed, UNKNOWNS};
pub use self::grooves::{ArchFit, AxialCondition, FLANKS};
use self::grooves::{Grooves, PLACE, site};
pub use self::pair::{GothicPair, RunningPair};
use super::traction::{Traction, TractionWorkspace};
use crate::contact::{
    Coulomb, Load, POWER_BALANCE_TOL, Power, axial_force, efficiency, ideal_torque, max_pressure,
    torque,
};
use crate::ellipse::{Quadrature, Rules, pressed_radius};
use crate::models::ball::{
    BallState, ContactState, ElasticPoint, FarFlank, HertzContact, Model, NoAnswer, Performance,
    Reason, Slip, Solution, SolveInfo, SteadyState, ThirdContact, Transmission, Workspace,
};

/// A ball in gothic arches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicBall<D = f64> {
    /// Screw, ball, friction and speeds. [`solve`](GothicBall::solve) takes the load from an [`AxialCondition`].
    pub at: ElasticPoint<D>,
    /// How the ball fits into its grooves.
    pub fit: ArchFit<D>,
    /// Friction at the far flanks, −; positive.
    pub far_friction: Coulomb<D>,
    /// Accuracy of the quadrature over the ellipses: its error over the friction.
    pub accuracy: f64,
    /// Creep speed over `$r_b |W|$`, positive.
    pub creep: f64,
}

/// Memory of the solves.
#[derive(Default)]
pub struct GothicWorkspace {
    traction: TractionWorkspace,
    newton: Workspace<UNKNOWNS>,
    rest: Workspace<PLACE>,
    rules: Rules,
}

/// A pressed contact of a ball in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankContact {
    /// Angle \[rad\], positive at either flank, load, slip and ellipse.
    pub state: ContactState,
    /// Power that friction takes \[W\].
    pub power: f64,
}

/// A ball in gothic arches in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicState {
    /// Contacts that are pressed: nut +, nut −, screw +, screw −.
    pub contacts: [Option<FlankContact>; FLANKS],
    /// Approaches of the four contacts \[m\], negative where there is a gap.
    pub approaches: [f64; FLANKS],
    /// Absolute motion in the Frenet-Serret triad \[rad/s\].
    pub motion: Motion<f64>,
    /// Motion relative to the nut \[rad/s\].
    pub to_nut: Motion<f64>,
    /// Relative speed `$W$` of screw and nut \[rad/s\].
    pub relative_speed: f64,
    /// Axial force of the nut on the ball \[N\].
    pub axial_force: f64,
    /// Axial displacement of the nut from the middle \[m\], and that at which the flanks + touch the ball.
    pub axial_displacement: f64,
    /// Displacement at which the flanks + touch \[m\].
    pub first_touch: f64,
    /// Torque on the screw \[N·m\].
    pub screw_torque: f64,
    /// Power out over power in; `None` without an axial force against the flanks +.
    pub efficiency: Option<f64>,
    /// Powers \[W\].
    pub power: Power,
    /// Relative violation of the power balance (B10).
    pub power_balance: f64,
    /// How it was found.
    pub info: SolveInfo,
    /// Axial play below which friction presses a ball on two contacts onto a far flank (AC7) \[m\], zero if no play
    /// does; `None` without an axial force that two contacts carry.
    pub threshold_play: Option<f64>,
    /// The unknowns, to start another solve from.
    root: Root,
}

/// Position \[m\] and motion over `$|W|$`, relative to the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Root {
    place: [f64; PLACE],
    motion: [f64; 4],
}

/// Creep speed over `$r_b|W|$` from which a search lowers it: far above all slip, friction is linear and any start
/// leads to the root.
const BEGIN: f64 = 30.0;

/// Residual from which the numbers of nodes stay as they are.
const FREEZE: f64 = 1e-6;

/// Residual below which steps keep the Jacobian.
const CHORD: f64 = 1e-3;

/// Residuals of a root: enough, and aimed at.
const ROOT: [f64; 2] = [1e-10, 1e-13];

/// Part of the largest load below which an axial force is rounding.
const NO_FORCE: f64 = 1e-9;

impl GothicBall {
    /// Solves for the steady motion of the ball (AC5), (AC6).
    ///
    /// Starts from the ball on two contacts if there is one; otherwise from the ball at rest, with the creep speed
    /// lowered step by step.
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if nothing carries the axial force, if screw and nut do not move against each other, without
    /// friction, or if no balance is found.
    pub fn solve(
        &self,
        condition: AxialCondition,
        near: Option<&GothicState>,
        work: &mut GothicWorkspace,
    ) -> Result<GothicState, NoAnswer> {
        self.check()?;
        let grooves = Grooves::of(&self.at, &self.fit)?;
        let at_rest = grooves.at_rest(condition, &mut work.rest)?;
        let force = match condition {
            AxialCondition::Force(axial) => axial,
            AxialCondition::Displacement(_) => grooves.axial_force(&at_rest),
        };
        let two_contacts = self.two_contacts(&grooves, force, &mut work.traction);
        let start = two_contacts.as_ref().and_then(|found| self.root_of(&grooves, found));
        let starts = [near.map(|near| near.root), start];
        let state = self.search(&grooves, condition, &at_rest, starts, work)?;
        let is_force = matches!(condition, AxialCondition::Force(_));
        let threshold_play =
            two_contacts.filter(|_| is_force).and_then(|found| grooves.threshold_play(&found));
        Ok(GothicState { threshold_play, ..state })
    }

    /// Refuses a ball without friction or without motion.
    fn check(&self) -> Result<(), NoAnswer> {
        self.at.point.require_friction()?;
        if self.far_friction.0.is_nan() || self.far_friction.0 <= 0.0 {
            return Err(NoAnswer::invalid(Reason::Frictionless));
        }
        if self.at.point.drive.relative_speed() == 0.0 {
            return Err(NoAnswer::invalid(Reason::NoRelativeSpeed));
        }
        Ok(())
    }

    /// Finds the balance from the first start that leads to it, or else by lowering the creep speed.
    fn search(
        &self,
        grooves: &Grooves,
        condition: AxialCondition,
        at_rest: &[f64; PLACE],
        starts: [Option<Root>; 2],
        work: &mut GothicWorkspace,
    ) -> Result<GothicState, NoAnswer> {
        let GothicWorkspace { newton, rules, .. } = work;
        let [[quadrature, _]] = rules.dry([self.accuracy]);
        let balance = self.balance(grooves, condition, at_rest, quadrature);
        let mut search = Search { balance, newton, steps: 0 };
        let found = starts.into_iter().flatten().find_map(|start| search.from(&start));
        let (unknowns, residual) = match found {
            Some(found) => found,
            None => search.by_lowering_creep(at_rest)?,
        };
        let info = SolveInfo { steps: search.steps, residual };
        self.answer(&search.balance, &unknowns, info)
    }

    /// Axial displacement of the nut from the middle at which the flanks + touch the ball \[m\] (AC3).
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] of grooves that leave no room for the ball.
    pub fn first_touch(&self) -> Result<f64, NoAnswer> {
        let grooves = Grooves::of(&self.at, &self.fit)?;
        Ok(grooves.first_touch() / grooves.cos_lead)
    }

    /// Axial force of a nut that is moved so far beyond first touch \[m\], without friction \[N\].
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if no flank is pressed.
    pub fn force_at_rest(
        &self,
        deflection: f64,
        work: &mut GothicWorkspace,
    ) -> Result<f64, NoAnswer> {
        let grooves = Grooves::of(&self.at, &self.fit)?;
        let u = grooves.first_touch() / grooves.cos_lead + deflection;
        let place = grooves.at_rest(AxialCondition::Displacement(u), &mut work.rest)?;
        Ok(grooves.axial_force(&place))
    }

    /// Axial displacement of the nut beyond first touch under an axial force \[N\], without friction \[m\].
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if the grooves cannot carry the force.
    pub fn deflection_at_rest(
        &self,
        axial: f64,
        work: &mut GothicWorkspace,
    ) -> Result<f64, NoAnswer> {
        let grooves = Grooves::of(&self.at, &self.fit)?;
        let place = grooves.at_rest(AxialCondition::Force(axial), &mut work.rest)?;
        Ok((place[2] - grooves.first_touch()) / grooves.cos_lead)
    }

    /// The same ball with reversed speeds: mirrored onto the flanks +, the ball of the other nut of a pair.
    #[must_use]
    pub fn back_driven(&self) -> Self {
        let mut ball = *self;
        let drive = &mut ball.at.point.drive;
        (drive.screw_speed, drive.nut_speed) = (-drive.screw_speed, -drive.nut_speed);
        ball
    }

    /// The balls on two contacts under an axial force each.
    fn two_contacts(
        &self,
        grooves: &Grooves,
        axial: f64,
        work: &mut TractionWorkspace,
    ) -> Option<SteadyState> {
        if self.fit.oversize != 0.0 || axial <= 0.0 {
            return None;
        }
        let mut at = self.at;
        let balls = at.point.load.balls;
        at.point.load = Load { axial: axial * balls, balls };
        if self.fit.radial_gap != 0.0 {
            at.point.contact_angle = grooves.cos_first_contact().acos();
        }
        let traction = Traction { at, accuracy: self.accuracy, creep: self.creep };
        traction.solve(work).solved().copied()
    }

    /// The unknowns of a ball on two contacts.
    fn root_of(&self, grooves: &Grooves, found: &SteadyState) -> Option<Root> {
        let [nut, screw] = [&found.ball.nut, &found.ball.screw];
        let [at_nut, at_screw] = [nut.pressed?.approach, screw.pressed?.approach];
        let Motion { precession, omega } =
            found.ball.motion?.relative_to(self.at.point.drive.nut_speed, &self.frame());
        let speed = self.at.point.drive.relative_speed().abs();
        Some(Root {
            place: grooves.between([at_nut, at_screw], [nut.angle, screw.angle]),
            motion: [precession, omega.x, omega.y, omega.z].map(|of| of / speed),
        })
    }

    fn frame(&self) -> BallFrame<f64> {
        BallFrame::turned(self.at.point.helix.lead_angle, 0.0)
    }

    fn balance<'a>(
        &'a self,
        grooves: &'a Grooves,
        condition: AxialCondition,
        at_rest: &[f64; PLACE],
        quadrature: &'a Quadrature,
    ) -> Balance<'a> {
        let point = &self.at.point;
        let speed = point.drive.relative_speed();
        // The ball moves at about half the speed of the screw.
        let centrifugal = point.ball.mass * point.helix.radius * (0.5 * speed).powi(2);
        let (load, approach) = grooves.largest(at_rest);
        let radius = point.ball.radius;
        let (nut, screw) = self.at.conformity;
        Balance {
            at: &self.at,
            grooves,
            condition,
            friction: [point.friction.0, self.far_friction.0],
            pressed_radius: [pressed_radius(nut, radius), pressed_radius(screw, radius)],
            units: (load.max(centrifugal), approach),
            creep: self.creep,
            quadrature,
            frozen_rules: None,
        }
    }

    /// Converts a root into a state after checking its power balance.
    fn answer(
        &self,
        balance: &Balance<'_>,
        unknowns: &[f64; UNKNOWNS],
        info: SolveInfo,
    ) -> Result<GothicState, NoAnswer> {
        let point = &self.at.point;
        let frame = self.frame();
        let state = balance.state(unknowns);
        let ArchState { place, to_nut, approaches, pressed, .. } = &state;
        let carried = axial_force(&state.wrench(0..2).force, &frame);
        let speed = point.drive.relative_speed();
        // T = Σ over the screw of [(−r_m n) × F + M]·k                    (B7)
        let screw_torque = torque(&state.wrench(2..FLANKS), point.helix.radius, &frame);
        let ideal = ideal_torque(carried, point.helix.radius, point.helix.lead_angle.tan());
        let power = Power::transmitted(screw_torque, ideal, speed);
        let friction: f64 = pressed.iter().flatten().map(|pressed| pressed.power).sum();
        let imbalance = power.imbalance(friction);
        if imbalance.is_nan() || imbalance.abs() > POWER_BALANCE_TOL {
            return Err(NoAnswer::not_converged(Reason::PowerDoesNotBalance { imbalance }));
        }
        let contacts =
            from_fn(|i| pressed[i].as_ref().map(|pressed| self.contact(i, pressed, &state)));
        let carries = carried > NO_FORCE * balance.units.0;
        let cos_lead = point.helix.lead_angle.cos();
        Ok(GothicState {
            contacts,
            approaches: *approaches,
            motion: to_nut.relative_to(-point.drive.nut_speed, &frame),
            to_nut: *to_nut,
            relative_speed: speed,
            axial_force: carried,
            axial_displacement: place[2] / cos_lead,
            first_touch: balance.grooves.first_touch() / cos_lead,
            screw_torque,
            efficiency: carries.then(|| efficiency(speed < 0.0, ideal, screw_torque)),
            power,
            power_balance: imbalance,
            info,
            threshold_play: None,
            root: Root { place: *place, motion: from_fn(|i| unknowns[PLACE + i]) },
        })
    }

    fn contact(&self, i: usize, pressed: &Pressed<f64>, state: &ArchState<f64>) -> FlankContact {
        let motion = if site(i) == Site::Nut { &state.to_nut } else { &state.to_screw };
        let arc = self.at.point.helix.arc_length_per_radian();
        let slip = motion.slip_velocity(arc, &pressed.contact.point(self.at.point.ball.radius));
        let ellipse = HertzContact {
            semi_axes: pressed.semi_axes,
            max_pressure: max_pressure(pressed.load, pressed.semi_axes),
            approach: pressed.approach,
        };
        FlankContact {
            state: ContactState {
                angle: pressed.angle.abs(),
                load: Some(pressed.load),
                slip_angle: Some(pressed.contact.slip_angle(&slip)),
                slip: Some(Slip { speed: slip.norm(), spin: motion.spin(&pressed.contact) }),
                pressed: Some(ellipse),
            },
            power: pressed.power,
        }
    }
}

impl GothicState {
    /// Normal loads of the four contacts \[N\], zero of a gap.
    pub fn loads(&self) -> [f64; FLANKS] {
        self.contacts.map(|contact| contact.and_then(|contact| contact.state.load).unwrap_or(0.0))
    }

    /// Power that friction takes at all contacts \[W\].
    pub fn friction_power(&self) -> f64 {
        self.contacts.iter().flatten().map(|contact| contact.power).sum()
    }

    /// True if a far flank, −, carries load.
    pub fn far_flank_carries(&self) -> bool {
        self.contacts[1].is_some() || self.contacts[3].is_some()
    }

    /// Gap between the ball and the nearer of the far flanks \[m\], negative where that flank is pressed.
    pub fn far_gap(&self) -> f64 {
        -self.approaches[1].max(self.approaches[3])
    }

    /// The contact with the far flank of larger load, if one is pressed.
    pub fn far_contact(&self) -> Option<ThirdContact> {
        let loads = self.loads();
        let far = if loads[1] >= loads[3] { 1 } else { 3 };
        let FlankContact { state, power } = self.contacts[far]?;
        Some(ThirdContact {
            site: site(far),
            load: loads[far],
            slip: state.slip?.speed,
            power_share: power / self.friction_power(),
        })
    }
}

impl GothicBall {
    /// Solves for all balls, each under its share of the load.
    ///
    /// If the far flanks have a gap, the answer is that of model traction.
    pub fn solution(&self, work: &mut GothicWorkspace) -> Solution {
        Solution::new(Model::Traction, self.steady(work))
    }

    fn steady(&self, work: &mut GothicWorkspace) -> Result<SteadyState, NoAnswer> {
        self.check()?;
        let load = self.at.point.load;
        let condition = AxialCondition::Force(load.per_ball());
        let grooves = Grooves::of(&self.at, &self.fit)?;
        let two = self.two_contacts(&grooves, load.per_ball(), &mut work.traction);
        let start = two.as_ref().and_then(|two| self.root_of(&grooves, two));
        let two_contact_power = two.and_then(|two| Some(two.transmission.power?.dissipated));
        if let Some((two, root)) = two.zip(start) {
            let [nut, screw] = [1, 3].map(|far| grooves.flank(far, &root.place).approach);
            let gap = -nut.max(screw);
            if gap >= 0.0 {
                let far_flank = FarFlank { gap, contact: None, two_contact_power };
                return Ok(SteadyState { far_flank: Some(far_flank), ..two });
            }
        }
        let at_rest = grooves.at_rest(condition, &mut work.rest)?;
        let state = self.search(&grooves, condition, &at_rest, [None, start], work)?;
        let far_flank =
            FarFlank { gap: state.far_gap(), contact: state.far_contact(), two_contact_power };
        if let Some(two) = two.filter(|_| !state.far_flank_carries()) {
            return Ok(SteadyState { far_flank: Some(far_flank), ..two });
        }
        let [Some(nut), _, Some(screw), _] = state.contacts else {
            return Err(NoAnswer::LOST);
        };
        let ball = BallState {
            motion: Some(state.motion),
            nut: nut.state,
            screw: screw.state,
            unloaded: None,
            axial_displacement: Some(state.axial_displacement - state.first_touch),
            threshold_play: two.and_then(|two| grooves.threshold_play(&two)),
        };
        let point = &self.at.point;
        let speed = point.drive.relative_speed();
        let torque = state.screw_torque * load.balls;
        let transmission = Transmission::of(speed < 0.0, point.ideal_torque(), torque, speed)
            .against(state.friction_power() * load.balls)
            .balanced()?;
        let power = |flanks: [usize; 2]| -> f64 {
            flanks.iter().filter_map(|i| state.contacts[*i]).map(|contact| contact.power).sum()
        };
        Ok(SteadyState {
            skid: two.and_then(|two| two.skid),
            info: Some(state.info),
            contact_power: Some([[0, 1], [2, 3]].map(|flanks| power(flanks) * load.balls)),
            far_flank: Some(far_flank),
            ..SteadyState::new(&ball, transmission)
        })
    }
}

impl<const M: usize> GothicBall<Jet<M>> {
    /// Efficiency and torque with their derivatives, of balls on two contacts.
    pub(crate) fn sensitivities(
        &self,
        work: &mut GothicWorkspace,
    ) -> Result<Performance<Jet<M>>, NoAnswer> {
        let ball = self.values();
        let found = ball.steady(work)?;
        if found.far_flank.is_some_and(|far| far.contact.is_some()) {
            let error = EvalError {
                quantity: "axial play [m]",
                value: ball.fit.axial_play,
                requirement: "above the threshold play: derivatives are calculated for two contacts",
            };
            return Err(NoAnswer::invalid(Reason::Refused { error }));
        }
        let Self { at, accuracy, creep, .. } = *self;
        Traction { at, accuracy, creep }.sensitivities(&mut work.traction)
    }

    /// The same ball without derivatives.
    fn values(&self) -> GothicBall {
        let ArchFit { axial_play, radial_gap, oversize } = self.fit;
        GothicBall {
            at: self.at.values(),
            fit: ArchFit {
                axial_play: axial_play.re(),
                radial_gap: radial_gap.re(),
                oversize: oversize.re(),
            },
            far_friction: Coulomb(self.far_friction.0.re()),
            accuracy: self.accuracy,
            creep: self.creep,
        }
    }
}

/// Policies of a solve down to these residuals: steps are rarely rejected, and sums with slopes cost little more than sums without.
fn search_options(residual_tol: f64, residual_goal: f64) -> Options {
    let convergence = Convergence { residual_tol, residual_goal, ..Convergence::default() };
    let jacobian = JacobianUpdate::EveryTrial { chord_below: CHORD };
    Options { convergence, jacobian, ..Options::default() }
}

/// Newton's method from one start after the other.
struct Search<'a> {
    balance: Balance<'a>,
    newton: &'a mut Workspace<UNKNOWNS>,
    steps: usize,
}

impl Search<'_> {
    /// The root that a start leads to, and its residual.
    fn from(&mut self, start: &Root) -> Option<([f64; UNKNOWNS], f64)> {
        let length = self.balance.units.1;
        let y = from_fn(|i| match i {
            0..PLACE => start.place[i] / length,
            _ => start.motion[i - PLACE],
        });
        self.refined(y).ok()
    }

    /// The root near `y`.
    fn refined(&mut self, mut y: [f64; UNKNOWNS]) -> Result<([f64; UNKNOWNS], f64), NoAnswer> {
        let near = search_options(FREEZE, FREEZE);
        let report = self.balance.run(&mut y, &near, self.newton);
        self.steps += report.steps.len();
        if !report.converged() {
            return Err(NoAnswer::not_converged(Reason::from(report)));
        }
        let frozen_rules = FrozenRules::default();
        let balance = Balance { frozen_rules: Some(&frozen_rules), ..self.balance };
        let [residual_tol, residual_goal] = ROOT;
        let exact = search_options(residual_tol, residual_goal);
        let report = balance.run(&mut y, &exact, self.newton);
        self.steps += report.steps.len();
        if !report.converged() {
            return Err(NoAnswer::not_converged(Reason::from(report)));
        }
        Ok((y, report.residual))
    }

    /// The root by way of larger creep speeds, from the ball at rest.
    fn by_lowering_creep(
        &mut self,
        at_rest: &[f64; PLACE],
    ) -> Result<([f64; UNKNOWNS], f64), NoAnswer> {
        let balance = self.balance;
        let sign = balance.at.point.drive.relative_speed().signum();
        // Half the speed of the screw, and rolling about b: the raceways of nut and screw move on opposite sides of
        // the ball.
        let motion = [0.5 * sign, 0.0, 0.0, -0.5 * sign * balance.turning()];
        let mut y = from_fn(|i| match i {
            0..PLACE => at_rest[i] / balance.units.1,
            _ => motion[i - PLACE],
        });
        let control = Continuation { first: 0.9, shortest: 0.02 };
        let options = search_options(FREEZE, FREEZE);
        let (end, mut failure) = (balance.creep, Reason::SearchLost);
        let (newton, steps) = (&mut *self.newton, &mut self.steps);
        follow(&mut y, (BEGIN.max(end).ln(), end.ln()), control, |log, y| {
            let report = Balance { creep: log.exp(), ..balance }.run(y, &options, newton);
            *steps += report.steps.len();
            let converged = report.converged();
            if !converged {
                failure = Reason::from(report);
            }
            converged
        })
        .map_err(|_| NoAnswer::not_converged(failure))?;
        self.refined(y)
    }
}
