//! One ball with up to four contacts in the gothic arches of the nut and the screw. The force
//! balance of the ball includes friction.
//!
//! Friction across the grooves moves the ball sideways. If the axial play is small, the ball then
//! touches the far flank of one groove, which is the third contact.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC1) to (AC9).

mod balance;
mod grooves;
mod pair;

use std::array::from_fn;

use bsm_kin::{BallFrame, Contact, Jet, Motion, Scalar, Site};
use bsm_newton::{Continuation, Convergence, JacobianUpdate, Options, Outcome, follow};

use self::balance::{ArchState, Balance, FrozenRules, Pressed, UNKNOWNS};
pub use self::grooves::{ArchFit, AxialCondition, FLANKS, FlankApproach, Grooves};
use self::grooves::{POSITIONS, site};
pub use self::pair::{GothicPair, RunningPair};
use super::traction::{
    COARSE_ACCURACY, COARSE_RESIDUAL, SEARCH_ACCURACY, Traction, TractionWorkspace,
};
use crate::contact::{
    Conformities, Coulomb, Load, POWER_BALANCE_TOL, Power, axial_force, efficiency, ideal_torque,
    max_pressure, torque,
};
use crate::ellipse::{Quadrature, RulePair, Rules, pressed_radius};
use crate::models::ball::{
    BallState, ContactState, ElasticPoint, FarFlank, HertzContact, Model, Performance, Reason,
    Slip, Solution, SolveFailure, SolveInfo, SteadyState, ThirdContact, Transmission, Workspace,
    moving_root,
};

/// A ball in gothic arches at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicBall<D = f64> {
    /// Screw, ball, friction and speeds. The load of this operating point is ignored by
    /// [`solve`](GothicBall::solve), which takes an [`AxialCondition`] instead.
    pub screw: ElasticPoint<D>,
    /// Axial play, radial gap and oversize of the ball in the gothic arches.
    pub fit: ArchFit<D>,
    /// Friction coefficient at the far flanks (− flanks), positive.
    pub far_friction: Coulomb<D>,
    /// Permitted quadrature error divided by the friction force (dimensionless), positive.
    pub accuracy: f64,
    /// Creep speed divided by `$r_b |W|$` (dimensionless), positive.
    pub creep: f64,
}

/// Reusable buffers for solving the models of a ball in gothic arches.
#[derive(Default)]
pub struct GothicWorkspace {
    traction: TractionWorkspace,
    newton: Workspace<UNKNOWNS>,
    rest: Workspace<POSITIONS>,
    rules: Rules,
}

/// A loaded contact of a ball in gothic arches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankContact {
    /// Contact angle \[rad\] (positive at both flanks), load, slip and contact ellipse.
    pub state: ContactState,
    /// Friction power at the contact \[W\].
    pub power: f64,
}

/// A ball in gothic arches in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicState {
    /// Loaded contacts in the order nut +, nut −, screw +, screw −. `None` stands for an unloaded
    /// contact (gap).
    pub contacts: [Option<FlankContact>; FLANKS],
    /// Approaches of the four contacts \[m\]; a negative approach is a gap.
    pub approaches: [f64; FLANKS],
    /// Absolute motion of the ball in the Frenet-Serret triad \[rad/s\].
    pub motion: Motion<f64>,
    /// Motion of the ball relative to the nut \[rad/s\].
    pub to_nut: Motion<f64>,
    /// Relative speed `$W$` of the screw and the nut \[rad/s\].
    pub relative_speed: f64,
    /// Axial force of the nut on the ball \[N\].
    pub axial_force: f64,
    /// Axial displacement of the nut from its middle position \[m\].
    pub axial_displacement: f64,
    /// Axial displacement at which the + flanks touch the ball \[m\].
    pub first_touch: f64,
    /// Torque on the screw \[N·m\].
    pub screw_torque: f64,
    /// Ratio of output power to input power; `None` if the + flanks carry no axial force.
    pub efficiency: Option<f64>,
    /// Input, output and dissipated powers \[W\].
    pub power: Power,
    /// Relative error of the power balance (B10).
    pub power_balance: f64,
    /// Number of Newton steps and scaled residual of the solve.
    pub info: SolveInfo,
    /// Position and motion of the ball, from which another solve can start.
    root: Root,
}

/// Position of the ball and the nut \[m\], and motion of the ball relative to the nut, divided by
/// `$|W|$`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Root {
    positions: [f64; POSITIONS],
    motion: [f64; 4],
}

impl Root {
    /// Returns the root for the screw turned end for end, so that the opposite flanks carry the
    /// load and the speeds are reversed.
    fn turned(&self) -> Self {
        let ([x_b, x_n, w_b], [rate, along, radial, around]) = (self.positions, self.motion);
        Self { positions: [-x_b, x_n, -w_b], motion: [-rate, -along, radial, -around] }
    }

    /// Returns the gap between the ball and the nearer far flank \[m\]. The gap is negative if ball
    /// and flank overlap.
    fn far_gap(&self, grooves: &Grooves) -> f64 {
        let [nut, screw] = [1, 3].map(|far| grooves.flank(far, &self.positions).approach);
        -nut.max(screw)
    }

    /// Returns the unknowns of the force and moment balance, with lengths divided by `length`
    /// \[m\].
    fn unknowns(&self, length: f64) -> [f64; UNKNOWNS] {
        from_fn(|i| match i {
            0..POSITIONS => self.positions[i] / length,
            _ => self.motion[i - POSITIONS],
        })
    }
}

/// Minimum creep speed at the start of a continuation, divided by `$r_b|W|$`. Because this creep
/// speed far exceeds all slip speeds, friction is linear and Newton's method converges from any
/// starting value.
const FIRST_CREEP: f64 = 30.0;

/// Residual tolerance (scaled) of the roots along a continuation. The tolerance equals the accuracy
/// of the quadrature that is used along the continuation.
const PATH_RESIDUAL: f64 = 1e-6;

/// Scaled residual below which Newton steps reuse the Jacobian. Above this residual, the Jacobian
/// is calculated together with every trial step, because few steps are rejected and the quadrature
/// with derivatives costs little more than the quadrature without derivatives.
const CHORD_RESIDUAL: f64 = 1e-3;

/// Maximum number of Newton steps from one starting value, after which the next starting value is
/// tried. Nine out of ten balls need at most 11 steps in total.
const MAX_NEWTON_STEPS: usize = 25;

/// Maximum scaled residual before the final Newton step. The residual after this step is not
/// evaluated.
const ROOT_RESIDUAL: f64 = 1e-10;

/// Minimum ratio of the friction moment of the far flanks to the spin moment of the loaded flanks,
/// both calculated without numerical factors. Above this ratio, the search starts with the
/// assumption that the third contact stops the spin. For 200 random balls, a value of 0.2 leads to
/// the fewest Newton steps.
const SPIN_STOP_RATIO: f64 = 0.2;

/// Largest ratio of axial force to largest normal load at which the axial force is treated as a
/// rounding error.
const AXIAL_FORCE_TOL: f64 = 1e-9;

impl<D: Scalar> GothicBall<D> {
    /// Returns the operating point of a ball with two contacts, with the contact angle at first
    /// contact.
    fn two_contact_point(&self) -> ElasticPoint<D> {
        self.screw.fitted(self.fit.radial_gap, self.fit.oversize)
    }

    /// Returns the radii of the deformed contact surfaces at the nut and the screw \[m\].
    fn pressed_radii(&self) -> [D; 2] {
        let Conformities { nut, screw } = self.screw.conformity;
        [nut, screw].map(|conformity| pressed_radius(conformity, self.screw.point.ball.radius))
    }
}

impl GothicBall {
    /// Solves for the steady motion of the ball in gothic arches (AC5), (AC6).
    ///
    /// Newton's method first starts from the state `near`, if this state is given, and then from
    /// the state of the ball with two contacts. If Newton's method converges from neither state, a
    /// continuation starts from the ball at rest and lowers the creep speed.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the grooves cannot carry the axial force, if the screw and the
    /// nut have no relative speed, if a friction coefficient is not positive, or if no root is
    /// found.
    pub fn solve(
        &self,
        condition: AxialCondition,
        near: Option<&GothicState>,
        work: &mut GothicWorkspace,
    ) -> Result<GothicState, SolveFailure> {
        self.check()?;
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        let at_rest = grooves.at_rest(condition, &mut work.rest)?;
        let force = match condition {
            AxialCondition::Force(axial) => axial,
            AxialCondition::Displacement(_) => grooves.axial_force(&at_rest),
        };
        self.search(&grooves, condition, &at_rest, work, |start, traction| match start {
            Start::Near => near.map(|near| near.root),
            // An oversize ball at rest loads all flanks, so there is no state with two contacts.
            Start::TwoContacts if self.fit.oversize > 0.0 => None,
            Start::TwoContacts if force < 0.0 => {
                let turned = self.back_driven();
                let two_contacts = turned.two_contacts(-force, traction)?;
                Some(turned.root_of(&grooves, &two_contacts.ball)?.turned())
            }
            Start::TwoContacts => {
                let two_contacts = self.two_contacts(force, traction)?;
                self.root_of(&grooves, &two_contacts.ball)
            }
        })
    }

    /// Returns the axial play \[m\] below which friction presses a ball with two contacts against a
    /// far flank (AC7). The result is zero if friction does not press the ball against a far flank
    /// even without play, and `None` if two contacts cannot carry the axial force \[N\].
    pub fn threshold_play(&self, axial: f64, work: &mut GothicWorkspace) -> Option<f64> {
        let grooves = Grooves::of(&self.screw, &self.fit).ok()?;
        let two_contacts = self.two_contacts(axial, &mut work.traction)?;
        threshold_play(&grooves, &two_contacts)
    }

    /// Returns the axial play \[m\] for which friction does not change the gap at the far flank:
    /// with this play and with friction, the gap equals the gap without play and without friction
    /// (AC10). Returns `None` if two contacts cannot carry the axial force \[N\].
    pub fn compensating_play(&self, axial: f64, work: &mut GothicWorkspace) -> Option<f64> {
        let grooves = Grooves::of(&self.screw, &self.fit).ok()?;
        let two_contacts = self.two_contacts(axial, &mut work.traction)?;
        let at = self.two_contact_point();
        let lead = at.point.helix.lead_angle;
        let (_, at_rest) = at.pressed_ball().ok()?.under_axial_load(axial, lead).ok()?;
        let approaches = grooves.approaches(at_rest.load);
        // s = s*(f) − s*(0)                                               (AC10)
        let play = threshold_play(&grooves, &two_contacts)?
            - grooves.threshold_play(approaches, [at_rest.angle; 2]);
        Some(play.max(0.0))
    }

    /// Returns the gap \[m\] between the ball and the nearer far flank for a given state with two
    /// contacts; it is negative if flank and ball overlap. Returns `None` if the state contains no
    /// motion or no contact ellipses.
    pub fn far_gap_on_two_contacts(&self, two_contacts: &BallState) -> Option<f64> {
        let grooves = Grooves::of(&self.screw, &self.fit).ok()?;
        Some(self.root_of(&grooves, two_contacts)?.far_gap(&grooves))
    }

    /// Checks that the friction coefficients are positive and that the nut and the screw have a
    /// relative speed.
    fn check(&self) -> Result<(), SolveFailure> {
        self.screw.point.require_friction()?;
        if self.far_friction.0.is_nan() || self.far_friction.0 <= 0.0 {
            return Err(SolveFailure::invalid(Reason::Frictionless));
        }
        if self.screw.point.drive.relative_speed() == 0.0 {
            return Err(SolveFailure::invalid(Reason::NoRelativeSpeed));
        }
        Ok(())
    }

    /// Finds the root from the first starting value from which Newton's method converges. If there
    /// is no such starting value, the root is found by lowering the creep speed.
    fn search(
        &self,
        grooves: &Grooves,
        condition: AxialCondition,
        at_rest: &[f64; POSITIONS],
        work: &mut GothicWorkspace,
        start: impl Fn(Start, &mut TractionWorkspace) -> Option<Root>,
    ) -> Result<GothicState, SolveFailure> {
        let GothicWorkspace { traction, newton, rest, rules } = work;
        let [coarse, smooth, fine] =
            rules.dry([COARSE_ACCURACY, SEARCH_ACCURACY, self.accuracy]).map(|pair| &pair.rule);
        let balance = self.balance(grooves, condition, at_rest, fine);
        let coarse = Balance { quadrature: coarse, coarse: true, ..balance };
        let smooth = Balance { quadrature: smooth, ..balance };
        let mut search = Search { balance, coarse, smooth, newton, steps: 0 };
        let near = start(Start::Near, traction).and_then(|near| {
            let positions = search.equilibrium_position(&near, [true; FLANKS], rest)?;
            search.from(&Root { positions, ..near })
        });
        let found = near.or_else(|| {
            let two_contacts = start(Start::TwoContacts, traction)?;
            let flank_pair = usize::from(grooves.axial_force(at_rest) < 0.0);
            let starts = search.equilibrium_starts(&two_contacts, flank_pair, rest);
            let found = starts.into_iter().flatten().find_map(|start| search.from(&start));
            found.or_else(|| search.from(&two_contacts))
        });
        let Found { unknowns, residual, rules } = match found {
            Some(found) => found,
            None => search.by_lowering_creep(at_rest)?,
        };
        let info = SolveInfo { steps: search.steps, residual };
        let balance = Balance { frozen_rules: Some(&rules), ..search.balance };
        self.gothic_state(&balance, &unknowns, info)
    }

    /// Returns the axial displacement \[m\] of the nut, measured from its middle position, at which
    /// the + flanks touch the ball (AC3).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the ball does not fit into the grooves.
    pub fn first_touch(&self) -> Result<f64, SolveFailure> {
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        Ok(grooves.first_touch() / grooves.lead.1)
    }

    /// Returns the axial force of the nut \[N\] without friction, for a given displacement \[m\]
    /// beyond first contact.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no flank carries a load.
    pub fn force_at_rest(
        &self,
        deflection: f64,
        work: &mut GothicWorkspace,
    ) -> Result<f64, SolveFailure> {
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        let u = grooves.first_touch() / grooves.lead.1 + deflection;
        let positions = grooves.at_rest(AxialCondition::Displacement(u), &mut work.rest)?;
        Ok(grooves.axial_force(&positions))
    }

    /// Returns the axial displacement \[m\] of the nut beyond first contact that results from an
    /// axial force \[N\] without friction.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the grooves cannot carry the force.
    pub fn deflection_at_rest(
        &self,
        axial: f64,
        work: &mut GothicWorkspace,
    ) -> Result<f64, SolveFailure> {
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        let positions = grooves.at_rest(AxialCondition::Force(axial), &mut work.rest)?;
        Ok((positions[2] - grooves.first_touch()) / grooves.lead.1)
    }

    /// Returns the ball with reversed speeds. The returned ball represents the ball in the other
    /// nut of a preloaded pair, mirrored so that its + flanks are loaded.
    #[must_use]
    pub fn back_driven(&self) -> Self {
        let mut ball = *self;
        let drive = &mut ball.screw.point.drive;
        (drive.screw_speed, drive.nut_speed) = (-drive.screw_speed, -drive.nut_speed);
        ball
    }

    /// Returns the steady state of a ball with two contacts under an axial force per ball \[N\], or
    /// `None` if there is no steady state.
    fn two_contacts(&self, axial: f64, work: &mut TractionWorkspace) -> Option<SteadyState> {
        if axial <= 0.0 {
            return None;
        }
        let mut screw = self.two_contact_point();
        let balls = screw.point.load.balls;
        screw.point.load = Load { axial: axial * balls, balls };
        let traction = Traction { screw, accuracy: self.accuracy, creep: self.creep };
        traction.solve(work).steady_state().copied()
    }

    /// Returns the position and the motion of the ball for a steady state with two contacts.
    fn root_of(&self, grooves: &Grooves, found: &BallState) -> Option<Root> {
        let [nut, screw] = [&found.nut, &found.screw];
        let [at_nut, at_screw] = [nut.pressed?.approach, screw.pressed?.approach];
        let Motion { precession, omega } =
            found.motion?.relative_to(self.screw.point.drive.nut_speed, &self.frame());
        let speed = self.screw.point.drive.relative_speed().abs();
        Some(Root {
            positions: grooves.position_for([at_nut, at_screw], [nut.angle, screw.angle]),
            motion: [precession, omega.x, omega.y, omega.z].map(|of| of / speed),
        })
    }

    fn frame(&self) -> BallFrame<f64> {
        BallFrame::turned(self.screw.point.helix.lead_angle, 0.0)
    }

    fn balance<'a>(
        &'a self,
        grooves: &'a Grooves,
        condition: AxialCondition,
        at_rest: &[f64; POSITIONS],
        quadrature: &'a Quadrature,
    ) -> Balance<'a> {
        let point = &self.screw.point;
        let speed = point.drive.relative_speed();
        // The precession rate of the ball is about half the speed of the screw.
        let centrifugal = point.ball.mass * point.helix.radius * (0.5 * speed).powi(2);
        let (load, approach) = grooves.largest_load(at_rest);
        Balance {
            screw: &self.screw,
            grooves,
            condition,
            friction: [point.friction.0, self.far_friction.0],
            pressed_radius: self.pressed_radii(),
            units: (load.max(centrifugal), approach),
            creep: self.creep,
            quadrature,
            coarse: false,
            frozen_rules: None,
        }
    }

    /// Converts a root into a steady state in SI units after checking its power balance.
    fn gothic_state(
        &self,
        balance: &Balance<'_>,
        unknowns: &[f64; UNKNOWNS],
        info: SolveInfo,
    ) -> Result<GothicState, SolveFailure> {
        let point = &self.screw.point;
        let frame = self.frame();
        let state = balance.evaluated(unknowns);
        let ArchState { positions, approaches, pressed, .. } = &state;
        let carried = axial_force(&state.wrench(0..2).force, &frame);
        let speed = point.drive.relative_speed();
        let (rate, omega) = state.to_nut;
        let to_nut =
            Motion::new(rate * speed.abs(), omega.map(|component| component * speed.abs()));
        // T = Σ_screw [(−r_m n) × F + M]·k                                (B7)
        let screw_torque = torque(&state.wrench(2..FLANKS), point.helix.radius, &frame);
        let ideal = ideal_torque(carried, point.helix.radius, point.helix.lead_angle.tan());
        let power = Power::transmitted(screw_torque, ideal, speed);
        let friction: f64 = pressed.iter().flatten().map(|pressed| pressed.power).sum();
        let imbalance = power.imbalance(friction);
        if imbalance.is_nan() || imbalance.abs() > POWER_BALANCE_TOL {
            return Err(SolveFailure::not_converged(Reason::PowerDoesNotBalance { imbalance }));
        }
        let contacts =
            from_fn(|i| pressed[i].as_ref().map(|pressed| self.contact(i, pressed, &to_nut)));
        let carries = carried > AXIAL_FORCE_TOL * balance.units.0;
        let cos_lead = point.helix.lead_angle.cos();
        Ok(GothicState {
            contacts,
            approaches: *approaches,
            motion: to_nut.relative_to(-point.drive.nut_speed, &frame),
            to_nut,
            relative_speed: speed,
            axial_force: carried,
            axial_displacement: positions[2] / cos_lead,
            first_touch: balance.grooves.first_touch() / cos_lead,
            screw_torque,
            efficiency: carries.then(|| efficiency(speed < 0.0, ideal, screw_torque)),
            power,
            power_balance: imbalance,
            info,
            root: Root { positions: *positions, motion: from_fn(|i| unknowns[POSITIONS + i]) },
        })
    }

    /// Returns the state of one contact for a given motion of the ball relative to the nut.
    fn contact(&self, i: usize, pressed: &Pressed<f64>, to_nut: &Motion<f64>) -> FlankContact {
        let (point, frame) = (&self.screw.point, self.frame());
        let motion = match site(i) {
            Site::Screw => to_nut.relative_to(point.drive.relative_speed(), &frame),
            Site::Nut | Site::NutUnloaded => *to_nut,
        };
        let (sin, cos) = pressed.angle;
        let angle = sin.atan2(cos);
        let contact = Contact::new(site(i), angle, &frame);
        let arc = point.helix.arc_length_per_radian();
        let slip = motion.slip_velocity(arc, &contact.point(point.ball.radius));
        let ellipse = HertzContact {
            semi_axes: pressed.semi_axes,
            max_pressure: max_pressure(pressed.load, pressed.semi_axes),
            approach: pressed.approach,
        };
        FlankContact {
            state: ContactState {
                angle: angle.abs(),
                load: Some(pressed.load),
                slip_angle: Some(contact.slip_angle(&slip)),
                slip: Some(Slip { speed: slip.norm(), spin: motion.spin(&contact) }),
                pressed: Some(ellipse),
            },
            power: pressed.power,
        }
    }
}

impl GothicState {
    /// Returns the normal loads of the four contacts \[N\]. The load is zero where the ball does
    /// not touch the flank.
    pub fn loads(&self) -> [f64; FLANKS] {
        self.contacts.map(|contact| contact.and_then(|contact| contact.state.load).unwrap_or(0.0))
    }

    /// Returns the friction power of all contacts \[W\].
    pub fn friction_power(&self) -> f64 {
        self.contacts.iter().flatten().map(|contact| contact.power).sum()
    }

    /// Returns true if a far flank (− flank) carries load.
    pub fn far_flank_carries(&self) -> bool {
        self.contacts[1].is_some() || self.contacts[3].is_some()
    }

    /// Returns the gap between the ball and the nearer far flank \[m\], which is negative if this
    /// flank carries a load.
    pub fn far_gap(&self) -> f64 {
        -self.approaches[1].max(self.approaches[3])
    }

    /// Returns the contact with the more heavily loaded far flank, or `None` if no far flank
    /// carries a load.
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
    /// Solves for the steady state of the screw, assuming that all balls carry equal loads.
    ///
    /// If the far flanks carry no load, the result is identical to the result of the traction
    /// model.
    pub fn solution(&self, work: &mut GothicWorkspace) -> Solution {
        Solution::new(Model::Traction, self.steady(work).map(|(steady, _)| steady))
    }

    /// Returns the steady state of all balls. If a far flank carries a load, also returns the root
    /// of the force and moment balance.
    fn steady(
        &self,
        work: &mut GothicWorkspace,
    ) -> Result<(SteadyState, Option<Root>), SolveFailure> {
        self.check()?;
        let load = self.screw.point.load;
        let condition = AxialCondition::Force(load.per_ball());
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        let is_oversize = self.fit.oversize > 0.0;
        let two = (!is_oversize).then(|| self.two_contacts(load.per_ball(), &mut work.traction));
        let two = two.flatten();
        let start = two.as_ref().and_then(|two| self.root_of(&grooves, &two.ball));
        let two_contact_power = two.and_then(|two| Some(two.transmission.power?.dissipated));
        if let Some((two, root)) = two.zip(start) {
            let gap = root.far_gap(&grooves);
            if gap >= 0.0 {
                let far_flank = FarFlank { gap, contact: None, two_contact_power };
                return Ok((SteadyState { far_flank: Some(far_flank), ..two }, None));
            }
        }
        let at_rest = grooves.at_rest(condition, &mut work.rest)?;
        let state = self.search(&grooves, condition, &at_rest, work, |from, _| match from {
            Start::Near => None,
            Start::TwoContacts => start,
        })?;
        let far_flank =
            FarFlank { gap: state.far_gap(), contact: state.far_contact(), two_contact_power };
        if let Some(two) = two.filter(|_| !state.far_flank_carries()) {
            return Ok((SteadyState { far_flank: Some(far_flank), ..two }, None));
        }
        let [Some(nut), _, Some(screw), _] = state.contacts else {
            return Err(SolveFailure::SEARCH_FAILED);
        };
        let ball = BallState {
            motion: Some(state.motion),
            nut: nut.state,
            screw: screw.state,
            unloaded: None,
            axial_displacement: Some(state.axial_displacement - state.first_touch),
            threshold_play: two.and_then(|two| threshold_play(&grooves, &two)),
        };
        let point = &self.screw.point;
        let speed = point.drive.relative_speed();
        let torque = state.screw_torque * load.balls;
        let transmission = Transmission::of(speed < 0.0, point.ideal_torque(), torque, speed)
            .with_power_balance(state.friction_power() * load.balls)
            .balanced()?;
        let power = |flanks: [usize; 2]| -> f64 {
            flanks.iter().filter_map(|i| state.contacts[*i]).map(|contact| contact.power).sum()
        };
        let steady = SteadyState {
            skid: two.and_then(|two| two.skid),
            info: Some(state.info),
            contact_power: Some([[0, 1], [2, 3]].map(|flanks| power(flanks) * load.balls)),
            far_flank: Some(far_flank),
            ..SteadyState::new(&ball, transmission)
        };
        Ok((steady, Some(state.root)))
    }
}

/// Returns the axial play \[m\] below which a ball with two contacts touches a far flank, or `None`
/// if a contact carries no load.
fn threshold_play(grooves: &Grooves, found: &SteadyState) -> Option<f64> {
    let [nut, screw] = [&found.ball.nut, &found.ball.screw];
    let approaches = [nut.pressed?.approach, screw.pressed?.approach];
    Some(grooves.threshold_play(approaches, [nut.angle, screw.angle]))
}

impl<const M: usize> GothicBall<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs.
    pub(crate) fn sensitivities(
        &self,
        work: &mut GothicWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let ball = self.values();
        if let (_, Some(root)) = ball.steady(work)? {
            return self.third_contact_slopes(&ball, &root, work);
        }
        let (screw, Self { accuracy, creep, .. }) = (self.two_contact_point(), *self);
        Traction { screw, accuracy, creep }.sensitivities(&mut work.traction)
    }

    /// Returns the efficiency and the torque with their derivatives with respect to the inputs, for
    /// a root with a third contact.
    fn third_contact_slopes(
        &self,
        ball: &GothicBall,
        root: &Root,
        work: &mut GothicWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let load = self.screw.point.load;
        let grooves = Grooves::of(&ball.screw, &ball.fit)?;
        let condition = AxialCondition::Force(ball.screw.point.load.per_ball());
        let at_rest = grooves.at_rest(condition, &mut work.rest)?;
        let GothicWorkspace { newton, rules, .. } = work;
        let [RulePair { rule: quadrature, .. }] = rules.dry([self.accuracy]);
        let balance = ball.balance(&grooves, condition, &at_rest, quadrature);
        let grooves = Grooves::of(&self.screw, &self.fit)?;
        let inputs = Balance {
            screw: &self.screw,
            grooves: &grooves,
            condition: AxialCondition::Force(load.per_ball()),
            friction: [self.screw.point.friction.0, self.far_friction.0],
            pressed_radius: self.pressed_radii(),
            units: balance.units,
            creep: balance.creep,
            quadrature,
            coarse: false,
            frozen_rules: None,
        };
        let unknowns = root.unknowns(balance.units.1);
        let residual = |y: &_| inputs.residual(y);
        let y = moving_root(&balance, &unknowns, &[1.0; UNKNOWNS], residual, newton)?;
        let point = &self.screw.point;
        let wrench = inputs.evaluated(&y).wrench(2..FLANKS);
        let frame = BallFrame::turned(point.helix.lead_angle, Jet::from(0.0));
        // T = Σ_screw [(−r_m n) × F + M]·k                                (B7)
        let screw_torque = torque(&wrench, point.helix.radius, &frame) * load.balls;
        let back = point.drive.relative_speed().re < 0.0;
        let efficiency = efficiency(back, point.ideal_torque(), screw_torque);
        Ok(Performance { efficiency, screw_torque: Some(screw_torque) })
    }

    /// Returns a copy of the inputs in plain numbers, without derivatives.
    fn values(&self) -> GothicBall {
        GothicBall {
            screw: self.screw.values(),
            fit: self.fit.values(),
            far_friction: Coulomb(self.far_friction.0.re()),
            accuracy: self.accuracy,
            creep: self.creep,
        }
    }
}

/// A starting value of Newton's method.
#[derive(Clone, Copy)]
enum Start {
    /// Start from a known state near the root, if the caller provides it.
    Near,
    /// Start from the steady state of the ball with two contacts, if it exists.
    TwoContacts,
}

/// Search for a root from several starting values in turn.
struct Search<'a> {
    balance: Balance<'a>,
    /// Force and moment balance with the quadrature rule for the first Newton steps.
    coarse: Balance<'a>,
    /// Force and moment balance with a quadrature rule whose sums are smooth enough for
    /// continuation.
    smooth: Balance<'a>,
    newton: &'a mut Workspace<UNKNOWNS>,
    steps: usize,
}

/// A root of the force and moment balance.
struct Found {
    unknowns: [f64; UNKNOWNS],
    residual: f64,
    /// Node counts of the quadrature, which are kept fixed near the root.
    rules: FrozenRules,
}

impl Search<'_> {
    /// Returns the root to which Newton's method converges from a starting value, or `None` if the
    /// method does not converge.
    fn from(&mut self, start: &Root) -> Option<Found> {
        let y = start.unknowns(self.balance.units.1);
        let Self { balance, coarse, .. } = *self;
        let near = self.solved(&coarse, y, COARSE_RESIDUAL);
        let found = near.and_then(|(near, _)| self.refined(near));
        let found = found.or_else(|_| {
            let (near, _) = self.solved(&balance, y, PATH_RESIDUAL)?;
            self.refined(near)
        });
        found.ok()
    }

    /// Returns two starting values derived from a ball with two contacts, or `None` if there is no
    /// position at which the forces balance.
    ///
    /// In both starting values, the ball is at the position where the normal loads of all flanks
    /// balance the friction of the two contacts. One starting value has the motion of the ball with
    /// two contacts; the other has the motion of a ball whose third contact stops its spin. The
    /// more likely starting value comes first.
    ///
    /// * `flank_pair`: pair of loaded flanks, 0 for the + flanks and 1 for the − flanks.
    fn equilibrium_starts(
        &self,
        start: &Root,
        flank_pair: usize,
        newton: &mut Workspace<POSITIONS>,
    ) -> Option<[Root; 2]> {
        let grooves = self.balance.grooves;
        let positions =
            self.equilibrium_position(start, from_fn(|i| i % 2 == flank_pair), newton)?;
        let unchanged = Root { positions, ..*start };
        let rolling = Root {
            motion: self.balance.without_spin(&positions, flank_pair, start.motion),
            positions,
        };
        // Two friction moments act about n: the moment of the far flanks, and the spin moment of
        // the loaded flanks.
        let flank = |i: usize| {
            let approach = grooves.flank(i, &positions).approach;
            (grooves.load(i, approach), grooves.semi_axes(i, approach.max(0.0)).0)
        };
        let [loaded, far] = [flank_pair, 1 - flank_pair].map(|i| [flank(i), flank(2 + i)]);
        let far: f64 = far.iter().map(|(load, _)| load).sum();
        let spin: f64 = loaded.iter().map(|(load, semi_axis)| load * semi_axis).sum();
        let stops = far * self.balance.screw.point.ball.radius > SPIN_STOP_RATIO * spin;
        Some(if stops { [rolling, unchanged] } else { [unchanged, rolling] })
    }

    /// Returns the position of the ball at which the normal loads balance the friction forces at
    /// the selected flanks, or `None` if no such position is found. The friction forces are
    /// calculated from the given starting value.
    fn equilibrium_position(
        &self,
        start: &Root,
        flanks: [bool; FLANKS],
        newton: &mut Workspace<POSITIONS>,
    ) -> Option<[f64; POSITIONS]> {
        let Balance { grooves, condition, units, .. } = self.balance;
        let forces = self.coarse.friction(&start.unknowns(units.1), flanks);
        grooves.equilibrium_position(condition, &forces, (&start.positions, units), newton).ok()
    }

    /// Returns the root near `y`. The node counts of the quadrature stay fixed at their values for
    /// `y`.
    fn refined(&mut self, y: [f64; UNKNOWNS]) -> Result<Found, SolveFailure> {
        let rules = FrozenRules::default();
        let balance = Balance { frozen_rules: Some(&rules), ..self.balance };
        let (unknowns, residual) = self.solved(&balance, y, ROOT_RESIDUAL)?;
        Ok(Found { unknowns, residual, rules })
    }

    /// Returns the root of a force and moment balance near `y`, and the scaled residual before the
    /// final Newton step, which is at most `residual_tol`.
    fn solved(
        &mut self,
        balance: &Balance<'_>,
        mut y: [f64; UNKNOWNS],
        residual_tol: f64,
    ) -> Result<([f64; UNKNOWNS], f64), SolveFailure> {
        let jacobian = JacobianUpdate::EveryTrial { chord_below: CHORD_RESIDUAL };
        let convergence =
            Convergence { residual_tol, residual_goal: residual_tol, max_steps: MAX_NEWTON_STEPS };
        let options = Options { convergence, jacobian, ..Options::default() };
        let Outcome { report, last, .. } = balance.run(&mut y, &options, self.newton);
        self.steps += report.steps.len();
        if !report.converged() {
            return Err(SolveFailure::not_converged(Reason::from(report)));
        }
        // The residual after the final step is not evaluated.
        let step = last.and_then(|(residual, ())| self.newton.correction(&residual).ok());
        for (y, step) in y.iter_mut().zip(step.unwrap_or_default()) {
            *y += step;
        }
        Ok((y, report.residual))
    }

    /// Finds the root by a continuation that starts from the ball at rest and lowers the creep
    /// speed.
    fn by_lowering_creep(&mut self, at_rest: &[f64; POSITIONS]) -> Result<Found, SolveFailure> {
        let Self { balance, smooth, .. } = *self;
        // The first continuation may fail because the integrals with the coarser quadrature rule
        // can jump. In this case, a second continuation uses the requested quadrature rule.
        self.followed(&smooth, at_rest).or_else(|_| self.followed(&balance, at_rest))
    }

    /// Lowers the creep speed by continuation to the creep speed of `balance`, and returns the root
    /// at this speed.
    fn followed(
        &mut self,
        balance: &Balance<'_>,
        at_rest: &[f64; POSITIONS],
    ) -> Result<Found, SolveFailure> {
        let sign = balance.screw.point.drive.relative_speed().signum();
        // At the start, the ball precesses at half the speed of the screw and rolls about b,
        // because the raceways of the nut and the screw are on opposite sides of the ball.
        let motion = [0.5 * sign, 0.0, 0.0, -0.5 * sign * balance.turning()];
        let mut y = from_fn(|i| match i {
            0..POSITIONS => at_rest[i] / balance.units.1,
            _ => motion[i - POSITIONS],
        });
        let control = Continuation { first_step: 0.9, min_step: 0.02 };
        let (end, mut failure) = (balance.creep, SolveFailure::SEARCH_FAILED);
        follow(&mut y, (FIRST_CREEP.max(end).ln(), end.ln()), control, |log, y| {
            match self.solved(&Balance { creep: log.exp(), ..*balance }, *y, PATH_RESIDUAL) {
                Ok((found, _)) => {
                    *y = found;
                    true
                }
                Err(error) => {
                    failure = error;
                    false
                }
            }
        })
        .map_err(|_| failure)?;
        self.refined(y)
    }
}
