//! Friction of all balls of a nut. Loads and groove displacements differ from ball to ball.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U21), (U30), (U32) and (U33), and
//! `docs/theory/22-third-contact.md`.

use std::cell::Cell;

use bsm_dyn::{
    Control, Coulomb, ElasticPoint, Load, Model, OperatingPoint, Solution, SolveFailure,
    gothic::{
        ArchFit, AxialCondition, GothicBall, GothicPair, GothicState, GothicWorkspace, RunningPair,
    },
    lubrication::OutsidePower,
    model::{Basis, Traction},
    solution::BallState,
};
use bsm_kin::{BallFrame, Drive, Motion, Site};

use crate::geometry::count;
use crate::interpolation::interpolated;
use crate::{BallInGrooves, BallNut, Equilibrium, Flanks};

/// Friction torque and power of a nut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NutFriction {
    /// Friction torque that each ball causes on the screw \[N·m\], at least zero. If the model has
    /// no solution for a ball, the list ends with the previous ball.
    pub balls: Vec<f64>,
    /// Motion of each ball; `None` for unloaded balls.
    pub motions: Vec<Option<FreeMotion>>,
    /// Number of balls that are loaded on both flanks at rest. For these balls, friction is
    /// integrated over all contact ellipses, whichever model is used for the other balls.
    pub balls_on_both_flanks: usize,
    /// Third contacts of balls that carry load on only one diagonal at rest and that friction
    /// presses onto a far flank.
    pub third_contacts: ThirdContacts,
    /// Mean friction coefficient of the lubricated balls (AC11); `None` without a lubricant.
    pub mean_friction: Option<f64>,
    /// Total friction torque of the balls \[N·m\]; `None` unless every ball has a solution.
    pub torque: Option<f64>,
    /// Total friction of all balls without push forces between neighbors, split into its
    /// contributions; `None` unless every ball has a solution.
    pub parts: Option<FrictionSum>,
    /// Torque that drives the screw \[N·m\]. It supports the axial force (`$h F_a$`) and overcomes
    /// the friction of balls, ball returns and seals.
    pub drive_torque: Option<f64>,
    /// Output power divided by input power; `None` without an axial load.
    pub efficiency: Option<f64>,
    /// Friction power of balls, ball returns and seals \[W\].
    pub heat: Option<f64>,
}

/// Summary of the third contacts of balls that are loaded on one diagonal at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThirdContacts {
    /// Number of balls with a third contact.
    pub count: usize,
    /// Largest normal load on any third contact \[N\].
    pub largest_load: f64,
    /// Friction torque due to all third contacts \[N·m\].
    pub torque: f64,
}

/// Motion of a ball that is not pushed by its neighbors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeMotion {
    /// Precession rate relative to the nut, divided by the relative speed, `$(P - \Omega_n)/W$`.
    pub rate: f64,
    /// Angular speed of the ball without its component along the groove, relative to the
    /// neighboring balls in the train (O1) \[rad/s\].
    pub rotation: f64,
    /// State of the ball, if the ball has exactly two contacts.
    pub ball: Option<BallState>,
}

/// Model of a ball, with the choices that were made for this ball. The friction is discontinuous
/// where a choice changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallModel {
    /// Model that was selected for the ball.
    pub model: Model,
    /// Controlling raceway, if the ball rolls.
    pub control: Option<Control>,
    /// Accuracy of the friction integrals, if the model was selected according to error bounds.
    pub accuracy: Option<f64>,
}

impl BallModel {
    /// Returns the model of a solution, with its controlling raceway and its quadrature accuracy,
    /// or `None` if there is no solution.
    fn of(solution: &Solution) -> Option<Self> {
        let solved = solution.steady_state()?;
        let accuracy = solution.choice.and_then(|choice| match choice.basis {
            Basis::Integrated { accuracy } => Some(accuracy),
            _ => None,
        });
        let control = solved.control.map(|control| control.raceway);
        Some(Self { model: solution.model, control, accuracy })
    }
}

/// Friction and motion of a ball that is not pushed by its neighbors.
#[derive(Debug, Clone, Copy)]
struct FreeBall {
    /// Friction of the ball as predicted by its model.
    friction: FrictionSum,
    /// Friction torque of the contacts divided by the friction torque in gross sliding on the screw
    /// (U33). The ratio is zero for models that balance the friction forces.
    sliding_share: f64,
    /// Motion of the ball; `None` if the model does not calculate the motion.
    motion: Option<FreeMotion>,
    /// True if the friction was calculated by model `traction`, which includes all friction of a
    /// ball with two contacts.
    has_traction: bool,
    /// Normal load \[N\] and friction torque \[N·m\] of the third contact, if there is one.
    third_contact: Option<(f64, f64)>,
    /// Mean friction coefficient of the contacts; `None` if they are not lubricated.
    mean_friction: Option<f64>,
}

/// Distance between a ball and the far flanks of its gothic arches.
#[derive(Debug, Clone, Copy)]
enum FarFlanks {
    /// The gothic arches have the given axial play \[m\].
    WithPlay(f64),
    /// The axial play is not given. The far flanks are assumed to be as close to the ball as they
    /// are at rest, so friction presses the ball only onto far flanks that it already touches at
    /// rest (AC10).
    AsAtRest,
}

/// Friction of one ball, or the sum over several balls.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionSum {
    /// Friction torque on the screw without the ball returns \[N·m\].
    pub torque: f64,
    /// Torque due to the contacts at nut and screw \[N·m\]. If the model does not distinguish the
    /// contacts, each value is half of the torque.
    pub contacts: [f64; 2],
    /// Torque due to the ball returns \[N·m\].
    pub ball_returns: f64,
    /// Part of the torque that results from a given force between neighboring balls \[N·m\].
    pub ball_contact: f64,
    /// Part of the torque that results from lubricant drag \[N·m\].
    pub drag: f64,
}

impl FrictionSum {
    /// Adds the friction `other`, multiplied by `part`, to `self`.
    fn add(&mut self, other: &Self, part: f64) {
        self.torque += part * other.torque;
        self.contacts = [0, 1].map(|side| self.contacts[side] + part * other.contacts[side]);
        self.ball_returns += part * other.ball_returns;
        self.ball_contact += part * other.ball_contact;
        self.drag += part * other.drag;
    }

    /// Returns a copy of this friction, limited to the friction in gross sliding on the screw
    /// (U33).
    ///
    /// * `sliding_share`: friction torque of the contacts divided by the friction torque in gross
    ///   sliding on the screw.
    fn limited_by_sliding(&self, sliding_share: f64) -> Self {
        if sliding_share <= 0.5 {
            return *self;
        }
        // T_f = T_max [1/2 + tanh(2 T_f/T_max − 1)/2]                     (U33)
        let part = (0.5 + 0.5 * (2.0 * sliding_share - 1.0).tanh()) / sliding_share;
        let contacts = self.contacts.map(|torque| part * torque);
        let lost = (1.0 - part) * (self.contacts[0] + self.contacts[1]);
        Self { torque: self.torque - lost, contacts, ..*self }
    }
}

/// Friction coefficients at the loaded flanks and at the far flanks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlankFriction {
    /// Friction coefficient at the flanks that carry the axial force of a ball; `None` if the model
    /// uses another friction law.
    pub loaded: Option<f64>,
    /// Friction coefficient at the far flanks; `None` if it equals the coefficient at the loaded
    /// flanks.
    pub far: Option<f64>,
}

impl FlankFriction {
    /// Returns equal friction coefficients for all flanks.
    pub fn equal(coefficient: f64) -> Self {
        Self { loaded: Some(coefficient), far: None }
    }

    /// Returns the coefficients at the loaded and far flanks, or `None` if the model uses another
    /// friction law.
    fn coefficients(self) -> Option<[f64; 2]> {
        self.loaded.map(|loaded| [loaded, self.far.unwrap_or(loaded)])
    }
}

/// Relative accuracy of the friction integrals for a ball in gothic arches. Friction coefficients
/// are known much less accurately.
const ARCH_ACCURACY: f64 = 1e-6;

/// Minimum ratio of a ball load to the largest ball load. A ball with a smaller load counts as idle
/// and does not influence the speed of its ball train.
const IDLE_LOAD: f64 = 1e-3;

/// Permitted relative errors of the interpolated precession rates and rotations of balls without
/// push forces. The ball train depends on differences between precession rates, so these rates must
/// be as accurate as the friction integrals.
const FREE_MOTION: [f64; 2] = [1e-7, 1e-4];

impl BallNut {
    /// Returns a screw whose only ball has the groove displacement and the oversize of the given
    /// ball of this nut (U21). Returns `None` if this ball is unloaded or is loaded on both flanks.
    ///
    /// * `number`: index of the ball.
    /// * `friction`: friction coefficient.
    /// * `drive`: speeds of screw and nut.
    pub fn ball_alone(
        &self,
        found: &Equilibrium,
        number: usize,
        friction: f64,
        drive: &Drive<f64>,
    ) -> Option<ElasticPoint> {
        let ball = &found.balls[number];
        let plus = match ball.flanks_pressed() {
            [true, false] => true,
            [false, true] => false,
            _ => return None,
        };
        let share = self.equal_share(1.0).fitted(-found.grooves[number][1], self.oversize(number));
        // For a ball on the − flanks, the calculation uses the + flanks and reverses the direction
        // of motion.
        let way = if plus { 1.0 } else { -1.0 };
        let axial = ball.force[0].abs() * self.helix.lead_angle.cos();
        Some(ElasticPoint {
            point: OperatingPoint {
                friction: Coulomb(friction),
                drive: Drive {
                    screw_speed: drive.screw_speed * way,
                    nut_speed: drive.nut_speed * way,
                },
                load: Load { axial, balls: 1.0 },
                ..share.point
            },
            ..share
        })
    }

    /// Returns a ball of this nut in its gothic arches. If the axial force on the ball is negative,
    /// the result is the mirror image, so that the + flanks are loaded.
    ///
    /// * `friction`: friction coefficients at the loaded and far flanks.
    /// * `play`: axial play of the gothic arches \[m\].
    ///
    /// All other arguments are the same as for [`ball_alone`](Self::ball_alone).
    fn ball_in_arches(
        &self,
        found: &Equilibrium,
        number: usize,
        (friction, play): ([f64; 2], f64),
        drive: &Drive<f64>,
    ) -> GothicBall {
        let fit = ArchFit {
            axial_play: play,
            radial_gap: -found.grooves[number][1],
            oversize: self.oversize(number),
        };
        let ball = self.nominal_ball(fit, friction, drive);
        if found.balls[number].force[0] < 0.0 { ball.back_driven() } else { ball }
    }

    /// Returns a ball of nominal size in the gothic arches of this nut.
    ///
    /// * `friction`: friction coefficients at the loaded and far flanks.
    fn nominal_ball(&self, fit: ArchFit, friction: [f64; 2], drive: &Drive<f64>) -> GothicBall {
        let share = self.equal_share(1.0);
        let [friction, far_friction] = friction.map(Coulomb);
        let point = OperatingPoint {
            friction,
            drive: *drive,
            load: Load { axial: 1.0, balls: 1.0 },
            ..share.point
        };
        GothicBall {
            screw: ElasticPoint { point, ..share },
            fit,
            far_friction,
            accuracy: ARCH_ACCURACY,
            creep: Traction::<f64>::CREEP,
        }
    }

    /// Returns the distance between a ball and its far flanks, or `None` if the ball has only two
    /// contacts.
    fn play(&self, number: usize, found: &Equilibrium) -> Option<FarFlanks> {
        let is_clamped = found.balls[number].flanks_pressed() == [true, true];
        let circuit = found.positions[number].circuit;
        let is_oversize =
            self.errors.oversize > 0.0 && self.circuits[circuit].flanks == Flanks::Both;
        match self.errors.axial_play {
            _ if is_oversize => Some(FarFlanks::WithPlay(0.0)),
            Some(play) => Some(FarFlanks::WithPlay(play)),
            None => is_clamped.then_some(FarFlanks::AsAtRest),
        }
    }

    /// Returns the state of a preloaded pair of nut bodies while the screw turns without external
    /// load (AC8). The preload was set at rest, and all balls of a body carry equal loads. Each
    /// load in the result refers to one ball of each body.
    ///
    /// Returns `None` unless there are two bodies with equal numbers of balls and a constant
    /// friction coefficient.
    ///
    /// * `preload`: force between the bodies at rest \[N\].
    /// * `play`: axial play of each body \[m\]; `None` if the play is so large that no ball touches
    ///   a far flank.
    ///
    /// All other arguments are the same as for [`friction`](Self::friction).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no steady motion of the balls exists or was found.
    pub fn running_pair(
        &self,
        preload: f64,
        friction: FlankFriction,
        drive: &Drive<f64>,
        play: Option<f64>,
    ) -> Option<Result<RunningPair, SolveFailure>> {
        let (balls, friction) = (self.balls_of_a_pair()?, friction.coefficients()?);
        let axial_play = play.unwrap_or(f64::INFINITY);
        let fit = ArchFit { axial_play, radial_gap: self.errors.gap, oversize: 0.0 };
        let ball = self.nominal_ball(fit, friction, drive);
        let work = &mut GothicWorkspace::default();
        let pair = GothicPair::of_preload(ball, preload / count(balls), work);
        Some(pair.and_then(|pair| pair.solve(0.0, work)))
    }

    /// Returns the number of balls per body if there are two bodies with equal numbers of balls.
    pub fn balls_of_a_pair(&self) -> Option<usize> {
        let balls = |body: usize| {
            let of_body = self.circuits.iter().filter(|circuit| circuit.body == body);
            of_body.map(|circuit| circuit.balls).sum::<usize>()
        };
        let (first, second) = (balls(0), balls(1));
        (first > 0 && first == second && first + second == self.balls()).then_some(first)
    }

    /// Calculates the friction of all balls with a model of a single ball (U21). The axial force on
    /// each ball is assumed to be the same as without friction.
    ///
    /// If a ball touches a far flank at rest or because of friction, its friction follows from the
    /// equilibrium of all its contacts (AC5) instead of from the model. The calculation ends at the
    /// first ball without a solution. If a ball has the same loads as the previous ball, the
    /// friction of the previous ball is used again.
    ///
    /// * `friction`: friction coefficients. If they are not given, the model uses another friction
    ///   law, and the friction of balls that touch a far flank cannot be calculated.
    /// * `drive`: speeds of screw and nut, which must not be equal.
    /// * `seal_torque`: friction torque of the seals \[N·m\].
    /// * `solve`: function that solves the model of a single ball. The model may include losses in
    ///   the ball returns.
    pub fn friction(
        &self,
        found: &Equilibrium,
        friction: FlankFriction,
        drive: &Drive<f64>,
        seal_torque: f64,
        solve: impl FnMut(ElasticPoint) -> Solution,
    ) -> NutFriction {
        let mut each = BallByBall::of(self, found, (friction, drive), solve);
        let mut sum = FrictionSum::default();
        let mut last: Option<(usize, FreeBall)> = None;
        let mut motions = Vec::with_capacity(found.balls.len());
        let mut third_contacts = ThirdContacts::default();
        let (mut coefficients, mut lubricated) = (0.0, 0.0);
        let mut of_ball = |number: usize| -> Option<f64> {
            if found.balls[number].max_load() <= 0.0 {
                motions.push(None);
                return Some(0.0);
            }
            let before = last.filter(|(other, _)| self.have_equal_loads(found, *other, number));
            let (as_of, ball) = match before {
                None => (number, each.friction_of(number)?),
                Some(like) => like,
            };
            last = Some((as_of, ball));
            motions.push(ball.motion);
            if let Some((load, torque)) = ball.third_contact {
                third_contacts.count += 1;
                third_contacts.largest_load = third_contacts.largest_load.max(load);
                third_contacts.torque += torque;
            }
            if let Some(coefficient) = ball.mean_friction {
                (coefficients, lubricated) = (coefficients + coefficient, lubricated + 1.0);
            }
            sum.add(&ball.friction, 1.0);
            Some(ball.friction.torque)
        };
        let balls: Vec<_> = (0..found.balls.len()).map_while(&mut of_ball).collect();
        let all = balls.len() == found.balls.len();
        let torque = all.then(|| balls.iter().sum::<f64>());
        let on_both = |ball: &BallInGrooves| ball.flanks_pressed() == [true, true];
        let balls_on_both_flanks = found.balls.iter().filter(|ball| on_both(ball)).count();
        let mut friction = NutFriction {
            balls,
            motions,
            balls_on_both_flanks,
            third_contacts,
            mean_friction: (lubricated > 0.0).then(|| coefficients / lubricated),
            parts: all.then_some(sum),
            ..NutFriction::default()
        };
        self.with_torque(&mut friction, found, drive, seal_torque, torque);
        friction
    }

    /// Replaces the friction torque of the balls and updates all results that depend on this
    /// torque. For example, the new torque may include the push forces of a [`train`](Self::train).
    pub fn with_torque(
        &self,
        friction: &mut NutFriction,
        found: &Equilibrium,
        drive: &Drive<f64>,
        seal_torque: f64,
        balls: Option<f64>,
    ) {
        let speed = drive.relative_speed();
        let all = balls
            .zip(friction.parts)
            .map(|(balls, parts)| balls + parts.ball_returns + seal_torque);
        let axial: f64 = found.bodies.iter().sum();
        let ideal = self.helix.lead() / std::f64::consts::TAU * axial;
        friction.torque = balls;
        // T = h F_a + sign(W) (Σ T_f + T_return + T_seal)                 (U32)
        friction.drive_torque = all.map(|torque| ideal + torque * speed.signum());
        // If the load opposes the motion, the screw moves the load; otherwise, the load drives the
        // screw.
        let is_loaded = axial.abs() > f64::EPSILON * found.forces();
        let driven = friction.drive_torque.filter(|_| is_loaded);
        friction.efficiency =
            driven.map(|torque| if ideal * speed > 0.0 { ideal / torque } else { torque / ideal });
        friction.heat = all.map(|torque| torque * speed.abs());
    }
}

/// Calculation of the friction of a nut in equilibrium, ball by ball.
struct BallByBall<'a, M> {
    nut: &'a BallNut,
    found: &'a Equilibrium,
    friction: FlankFriction,
    drive: &'a Drive<f64>,
    /// Solution of the last ball that was solved in gothic arches, used as the starting point for
    /// the next ball. The first value is true if this ball was loaded on the + flanks.
    before: Option<(bool, GothicState)>,
    arches: GothicWorkspace,
    /// Function that solves the model of a single ball.
    solve: M,
}

impl<'a, M: FnMut(ElasticPoint) -> Solution> BallByBall<'a, M> {
    fn of(
        nut: &'a BallNut,
        found: &'a Equilibrium,
        (friction, drive): (FlankFriction, &'a Drive<f64>),
        solve: M,
    ) -> Self {
        let arches = GothicWorkspace::default();
        Self { nut, found, friction, drive, before: None, arches, solve }
    }

    /// Returns a screw whose only ball is the ball with the given index (see
    /// [`BallNut::ball_alone`]).
    fn ball_alone(&self, number: usize) -> Option<ElasticPoint> {
        let friction = self.friction.loaded.unwrap_or(f64::NAN);
        self.nut.ball_alone(self.found, number, friction, self.drive)
    }

    /// Returns the friction of a loaded ball, which has two contacts (U21) or additional contacts
    /// at the far flanks (AC5).
    fn friction_of(&mut self, number: usize) -> Option<FreeBall> {
        let is_clamped = self.found.balls[number].flanks_pressed() == [true, true];
        let play = self.nut.play(number, self.found);
        // Most balls have the same number of contacts as the previous ball, so this number is tried
        // first.
        let touched = self.before.as_ref().is_some_and(|(_, state)| state.far_flank_carries());
        let two = if is_clamped || touched { None } else { self.on_two_contacts(number) };
        if let Some(arches) = self.friction.coefficients().zip(play)
            && !two.as_ref().is_some_and(|two| self.clears_far_flanks(two, number, arches))
        {
            let state = self.in_arches(number, arches).ok()?;
            if is_clamped || state.far_flank_carries() {
                return Some(self.free_in_arches(&state, is_clamped));
            }
        }
        if is_clamped {
            return None;
        }
        let mut free = two.or_else(|| self.on_two_contacts(number))?;
        if let (None, Some(FarFlanks::WithPlay(play)), Some(mean)) =
            (self.friction.loaded, play, free.mean_friction)
        {
            let friction = [mean, self.friction.far.unwrap_or(mean)];
            free = self.with_third_contact(&free, number, (friction, play))?;
        }
        Some(free)
    }

    /// Returns the friction of a ball with two contacts (U21).
    fn on_two_contacts(&mut self, number: usize) -> Option<FreeBall> {
        let alone = self.friction_alone(self.ball_alone(number)?)?;
        let friction = alone.friction.limited_by_sliding(alone.sliding_share);
        Some(FreeBall { friction, ..alone })
    }

    /// Returns true if a ball with two contacts keeps a gap to its far flanks even with friction.
    /// Only model `traction` can determine this gap; for other models, the result is false.
    fn clears_far_flanks(
        &self,
        two: &FreeBall,
        number: usize,
        (friction, far_flanks): ([f64; 2], FarFlanks),
    ) -> bool {
        let FarFlanks::WithPlay(play) = far_flanks else { return false };
        let state = two.motion.and_then(|motion| motion.ball).filter(|_| two.has_traction);
        let gap = state.and_then(|state| {
            self.in_own_arches(number, friction, play).far_gap_on_two_contacts(&state)
        });
        gap.is_some_and(|gap| gap >= 0.0)
    }

    /// Adds the power loss of the third contact to the friction of a lubricated ball. The added
    /// loss is the loss that a third contact causes in a dry ball with the mean friction
    /// coefficient (AC12).
    fn with_third_contact(
        &mut self,
        free: &FreeBall,
        number: usize,
        (friction, play): ([f64; 2], f64),
    ) -> Option<FreeBall> {
        let dry_ball = self.in_own_arches(number, friction, play);
        let found = dry_ball.solution(&mut self.arches);
        let solved = found.steady_state()?;
        let Some(far) = solved.far_flank.filter(|far| far.contact.is_some()) else {
            return Some(*free);
        };
        let (contact, dry) = (far.contact?, solved.transmission.power?.dissipated);
        let speed = self.drive.relative_speed().abs();
        let surplus = (dry - far.two_contact_power?) / speed;
        let mut friction = free.friction;
        friction.torque += surplus;
        friction.contacts[usize::from(contact.site == Site::Screw)] += surplus;
        let third_contact = Some((contact.load, contact.power_share * dry / speed));
        Some(FreeBall { friction, third_contact, ..*free })
    }

    /// Returns the ball in its gothic arches, loaded by the axial force that acts on it.
    fn in_own_arches(&self, number: usize, friction: [f64; 2], play: f64) -> GothicBall {
        let mut ball = self.nut.ball_in_arches(self.found, number, (friction, play), self.drive);
        ball.screw.point.load = Load { axial: self.axial_force(number), balls: 1.0 };
        ball
    }

    /// Returns the absolute value of the axial force on a ball \[N\].
    fn axial_force(&self, number: usize) -> f64 {
        self.found.balls[number].force[0].abs() * self.nut.helix.lead_angle.cos()
    }

    /// Solves the equilibrium of a ball with up to four contacts.
    fn in_arches(
        &mut self,
        number: usize,
        (friction, far_flanks): ([f64; 2], FarFlanks),
    ) -> Result<GothicState, SolveFailure> {
        let axial = self.axial_force(number);
        let play = match far_flanks {
            FarFlanks::WithPlay(play) => play,
            FarFlanks::AsAtRest => {
                let ball = self.in_own_arches(number, friction, 0.0);
                ball.compensating_play(axial, &mut self.arches).unwrap_or(0.0)
            }
        };
        let ball = self.in_own_arches(number, friction, play);
        let is_plus = self.found.balls[number].force[0] >= 0.0;
        let near = self.before.as_ref().filter(|(plus, _)| *plus == is_plus);
        let near = near.map(|(_, state)| state);
        let state = ball.solve(AxialCondition::Force(axial), near, &mut self.arches)?;
        self.before = Some((is_plus, state));
        Ok(state)
    }

    fn free_in_arches(&self, state: &GothicState, is_clamped: bool) -> FreeBall {
        let speed = self.drive.relative_speed().abs();
        let torque_of = |flanks: [usize; 2]| {
            let powers = flanks.map(|i| state.contacts[i].map_or(0.0, |contact| contact.power));
            (powers[0] + powers[1]) / speed
        };
        // T_f |W| = Σ P                                                   (U30)
        let torque = state.friction_power() / speed;
        let friction = FrictionSum {
            torque,
            contacts: [torque_of([0, 1]), torque_of([2, 3])],
            ..FrictionSum::default()
        };
        let third = state.far_contact().filter(|_| !is_clamped);
        FreeBall {
            friction,
            sliding_share: 0.0,
            motion: Some(self.nut.free_motion(&state.to_nut, state.relative_speed, None)),
            has_traction: true,
            third_contact: third.map(|third| (third.load, third.power_share * torque)),
            mean_friction: None,
        }
    }

    /// Returns the friction that the model predicts for a ball with two contacts (U21), before this
    /// friction is limited to gross sliding (U33).
    fn friction_alone(&mut self, alone: ElasticPoint) -> Option<FreeBall> {
        let nut = self.nut;
        let Drive { nut_speed, .. } = alone.point.drive;
        let signed = alone.point.drive.relative_speed();
        let speed = signed.abs();
        let solution = (self.solve)(alone);
        let solved = solution.steady_state()?;
        let torque = solved.transmission.screw_torque?;
        let of_film = |power: fn(&OutsidePower) -> f64| {
            solved.film.map_or(0.0, |film| power(&film.outside) / speed)
        };
        let ball_returns = of_film(|outside| outside.ball_return);
        let ball_contact = of_film(|outside| outside.ball_contact);
        let drag = of_film(|outside| outside.drag);
        let per_radian = nut.helix.lead() / std::f64::consts::TAU;
        // T_f = |T − h F|                                                 (U21)
        let torque = (torque - per_radian * alone.point.load.axial).abs() - ball_returns;
        let contacts = solved.contact_power.map(|of| of.map(|power| power / speed));
        let contacts = contacts.unwrap_or([0.5 * torque; 2]);
        let to_nut = |motion: Motion<f64>| motion.relative_to(nut_speed, &nut.frenet());
        let of_ball = |motion| nut.free_motion(&to_nut(motion), signed, Some(&solved.ball));
        let motion = solved.ball.motion.map(of_ball);
        let friction = FrictionSum { torque, contacts, ball_returns, ball_contact, drag };
        let mean_friction = solved.film.map(|film| film.mean_friction());
        let rolls = solution.model == Model::RacewayControl;
        let load = solved.ball.screw.load.filter(|_| rolls && contacts[0] + contacts[1] > 0.0);
        let sliding_share = load.map_or(0.0, |load| {
            let film = solved.film.map(|film| film.screw.law.boundary);
            let coefficient = film.unwrap_or(alone.point.friction.0);
            // T_max = f Q_B √(r_m² + h²)                                  (U33)
            let sliding = coefficient * load * nut.helix.arc_length_per_radian();
            (contacts[0] + contacts[1]) / sliding
        });
        Some(FreeBall {
            friction,
            sliding_share,
            motion,
            has_traction: solution.model == Model::Traction,
            third_contact: None,
            mean_friction,
        })
    }
}

impl BallNut {
    /// Converts the motion relative to the nut, with components in the Frenet-Serret triad, into
    /// precession rate and rotation.
    fn free_motion(
        &self,
        to_nut: &Motion<f64>,
        speed: f64,
        ball: Option<&BallState>,
    ) -> FreeMotion {
        let rotation = to_nut.across_groove(&self.frenet().k).norm();
        FreeMotion { rate: to_nut.precession / speed, rotation, ball: ball.copied() }
    }

    /// Returns the Frenet-Serret triad of the helix.
    fn frenet(&self) -> BallFrame<f64> {
        BallFrame::turned(self.helix.lead_angle, 0.0)
    }

    /// Returns the total friction of all balls (U21), or `None` unless every ball has a solution.
    /// This function is faster than [`friction`](Self::friction), because the friction of balls
    /// that differ only in their loads is interpolated between a few loads. Use it in searches that
    /// need the friction many times.
    ///
    /// * `between_loads`: permitted relative error of the friction that is interpolated between
    ///   loads.
    /// * `held`: model that `solve` must use for each ball, by ball index. For a ball without an
    ///   entry, the model is chosen automatically.
    ///
    /// All other arguments are the same as for [`friction`](Self::friction).
    pub fn friction_sum(
        &self,
        found: &Equilibrium,
        friction: FlankFriction,
        drive: &Drive<f64>,
        between_loads: f64,
        held: &[Option<BallModel>],
        mut solve: impl FnMut(ElasticPoint, Option<BallModel>) -> Solution,
    ) -> Option<FrictionSum> {
        let held_of = |number: usize| held.get(number).copied().flatten();
        let of_group = Cell::new(None);
        let solve = |at: ElasticPoint| solve(at, of_group.get());
        let mut each = BallByBall::of(self, found, (friction, drive), solve);
        let near = 1e-9 * self.arc_distance();
        let groups = self.groups(found, near, |one, other| held_of(one) == held_of(other));
        // The precession rate of a ball does not exceed the speed of the faster body, nut or screw.
        let fastest = drive.screw_speed.abs().max(drive.nut_speed.abs());
        let inertia = self.ball.mass * self.helix.radius * fastest * fastest;
        let mut sum = FrictionSum::default();
        for group in &groups {
            of_group.set(held_of(group[0]));
            let loads = group.iter().map(|number| found.balls[*number].force[0].abs());
            let (low, high) = loads.clone().fold((f64::MAX, 0.0), |(low, high), load| {
                (f64::min(low, load), f64::max(high, load))
            });
            // As a function of the ball load, friction has a singularity only at the load that
            // equals the centrifugal force.
            let (low_root, high_root) = ((low - inertia).sqrt(), (high - inertia).sqrt());
            let (roots, narrow) = (low_root + high_root, high_root - low_root);
            // The singularity at the centrifugal force determines the largest Bernstein ellipse in
            // which the friction is analytic, and thus the factor by which each additional
            // Chebyshev point reduces the error.
            let most = count(group.len());
            let points = (between_loads.ln() / (narrow / roots).ln()).ceil().clamp(1.0, most);
            // The friction of balls that may touch their far flanks is not interpolated, because it
            // has a kink at the load at which a far flank begins to carry load.
            let bends = group.iter().any(|n| self.play(*n, found).is_some());
            if low <= inertia || points >= most || bends {
                for number in group {
                    sum.add(&each.friction_of(*number)?.friction, 1.0);
                }
                continue;
            }
            let alone = each.ball_alone(group[0])?;
            let angles = (0_u8..).take_while(|k| f64::from(*k) < points);
            let mut nodes = Vec::with_capacity(group.len());
            for (number, angle) in angles.enumerate() {
                let angle = (f64::from(angle) + 0.5) * std::f64::consts::PI / points;
                let load = 0.5 * (low + high) + 0.5 * (high - low) * angle.cos();
                let mut ball = alone;
                ball.point.load.axial = load * self.helix.lead_angle.cos();
                let weight = if number % 2 == 0 { angle.sin() } else { -angle.sin() };
                nodes.push((load, weight, each.friction_alone(ball)?));
            }
            // The friction at each ball load is interpolated by the barycentric formula.
            for load in loads {
                let met = nodes.iter().position(|(node, ..)| (node - load).abs() <= 0.0);
                let all: f64 = nodes.iter().map(|(node, weight, _)| weight / (load - node)).sum();
                let (mut friction, mut sliding_share) = (FrictionSum::default(), 0.0);
                for (number, (node, weight, ball)) in nodes.iter().enumerate() {
                    let part = match met {
                        Some(met) => f64::from(u8::from(met == number)),
                        None => weight / (load - node) / all,
                    };
                    friction.add(&ball.friction, part);
                    sliding_share += part * ball.sliding_share;
                }
                sum.add(&friction.limited_by_sliding(sliding_share), 1.0);
            }
        }
        Some(sum)
    }

    /// Returns the model of each ball, by ball index. Unloaded balls and balls that are loaded on
    /// both flanks have no model (`None`). Returns `None` instead of the list unless all other
    /// balls have solutions.
    ///
    /// If balls differ only in their loads, the model is determined for the smallest and the
    /// largest load, and applies to all loads between them. If these two loads lead to different
    /// models, every ball is solved.
    ///
    /// All arguments are the same as for [`friction`](Self::friction).
    pub fn ball_models(
        &self,
        found: &Equilibrium,
        friction: FlankFriction,
        drive: &Drive<f64>,
        mut solve: impl FnMut(ElasticPoint) -> Solution,
    ) -> Option<Vec<Option<BallModel>>> {
        let mut models = vec![None; found.balls.len()];
        let mut model_of = |number: usize| {
            let alone =
                self.ball_alone(found, number, friction.loaded.unwrap_or(f64::NAN), drive)?;
            BallModel::of(&solve(alone))
        };
        let load = |number: &usize| found.balls[*number].force[0].abs();
        for mut group in self.groups(found, 1e-9 * self.arc_distance(), |_, _| true) {
            group.sort_by(|a, b| load(a).total_cmp(&load(b)));
            let (lightest, heaviest) = (group[0], group[group.len() - 1]);
            if found.balls[lightest].flanks_pressed() == [true, true] {
                continue;
            }
            let light = model_of(lightest)?;
            let heavy = if self.have_equal_loads(found, lightest, heaviest) {
                light
            } else {
                model_of(heaviest)?
            };
            for number in group {
                models[number] = Some(if light == heavy { light } else { model_of(number)? });
            }
        }
        Some(models)
    }

    /// Divides the loaded balls into groups and returns the ball indices of each group. Balls of a
    /// group differ only in their loads and groove displacements. A ball that is loaded on both
    /// flanks forms its own group.
    ///
    /// * `tolerance`: largest difference between the radial groove displacements of two balls in a
    ///   group \[m\].
    /// * `may_join`: function that returns true if two balls may belong to the same group.
    fn groups(
        &self,
        found: &Equilibrium,
        tolerance: f64,
        may_join: impl Fn(usize, usize) -> bool,
    ) -> Vec<Vec<usize>> {
        let near = 1e-9 * self.arc_distance();
        let together = |one: usize, other: usize| {
            let [a, b] = [one, other].map(|number| found.balls[number].flanks_pressed());
            a == b
                && may_join(one, other)
                && a != [true, true]
                && (found.grooves[one][1] - found.grooves[other][1]).abs() <= tolerance
                && (self.oversize(one) - self.oversize(other)).abs() <= near
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (number, ball) in found.balls.iter().enumerate() {
            if ball.max_load() > 0.0 {
                match groups.iter_mut().find(|group| together(group[0], number)) {
                    Some(group) => group.push(number),
                    None => groups.push(vec![number]),
                }
            }
        }
        groups
    }

    /// Returns the motions of all balls without push forces between neighbors, or `None` unless
    /// every loaded ball has a solution. The motions of balls that differ only in their loads and
    /// groove displacements are interpolated from a few of these balls.
    ///
    /// All arguments are the same as for [`friction`](Self::friction).
    pub fn free_motions(
        &self,
        found: &Equilibrium,
        friction: FlankFriction,
        drive: &Drive<f64>,
        solve: impl FnMut(ElasticPoint) -> Solution,
    ) -> Option<Vec<Option<FreeMotion>>> {
        let mut each = BallByBall::of(self, found, (friction, drive), solve);
        let idle = found.idle_load();
        let mut motions = vec![None; found.balls.len()];
        for mut group in self.groups(found, f64::INFINITY, |_, _| true) {
            group.retain(|number| found.balls[*number].max_load() >= idle);
            let point = |number: &usize| {
                // The interpolation uses the logarithm of the load, because the rates of lightly
                // loaded balls change rapidly with the load.
                [found.balls[*number].force[0].abs().ln(), found.grooves[*number][1]]
            };
            let points: Vec<_> = group.iter().map(point).collect();
            let of_group = interpolated(&points, FREE_MOTION, |position| {
                let FreeMotion { rate, rotation, .. } = each.friction_of(group[position])?.motion?;
                Some([rate, rotation])
            })?;
            for (number, [rate, rotation]) in group.into_iter().zip(of_group) {
                motions[number] = Some(FreeMotion { rate, rotation, ball: None });
            }
        }
        Some(motions)
    }

    /// Returns true if two balls have equal loads, contact angles and oversizes, except for
    /// rounding errors.
    pub(crate) fn have_equal_loads(&self, found: &Equilibrium, one: usize, other: usize) -> bool {
        /// Largest relative difference between two loads or contact angles that count as equal. The
        /// residual of the nut equilibrium is 1e-12 relative to the loads.
        const SAME: f64 = 1e-10;
        let near = |[a, b]: [f64; 2]| (a - b).abs() <= SAME * a.abs();
        let [a, b] = [one, other].map(|number| &found.balls[number]);
        (self.oversize(one) - self.oversize(other)).abs() <= 0.0
            && (0..4).all(|c| {
                near([a.loads[c], b.loads[c]])
                    && (a.loads[c] <= 0.0 || near([a.angles[c], b.angles[c]]))
            })
    }
}

impl Equilibrium {
    /// Returns the load below which a ball counts as idle \[N\].
    pub(crate) fn idle_load(&self) -> f64 {
        IDLE_LOAD * self.max_load()
    }

    /// Returns an upper bound on the sum of all ball loads \[N\].
    fn forces(&self) -> f64 {
        self.max_load() * count(self.balls.len())
    }
}
