//! Friction of all balls, each at its own load in its own displaced grooves.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U21), (U30) and (U32), and `docs/theory/22-third-contact.md`.

use std::cell::Cell;

use bsm_dyn::{
    ArchFit, AxialCondition, BallState, Basis, Control, Coulomb, ElasticPoint, GothicBall,
    GothicPair, GothicState, GothicWorkspace, Load, Model, NoAnswer, OperatingPoint, OutsidePower,
    RunningPair, Solution, Traction,
};
use bsm_kin::{BallFrame, Drive, Motion, Site};

use crate::geometry::count;
use crate::interpolation::interpolated;
use crate::{BallInGrooves, BallNut, Equilibrium, Flanks};

/// Friction torque and power of a nut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NutFriction {
    /// Friction torque of each ball on the screw \[N·m\], not negative; if the model has no answer for a
    /// ball, of those before it.
    pub balls: Vec<f64>,
    /// Motion of each ball; of a ball without a load none.
    pub motions: Vec<Option<FreeMotion>>,
    /// Balls that both flanks press at rest, whose friction is integrated over all their ellipses, whatever the
    /// model of the others.
    pub on_both_flanks: usize,
    /// The other balls that friction presses onto a far flank.
    pub third_contacts: ThirdContacts,
    /// Mean friction coefficient of the lubricated balls (AC11), if there are any.
    pub mean_friction: Option<f64>,
    /// Sum over the balls \[N·m\]; `None` unless every ball has one.
    pub torque: Option<f64>,
    /// The sum of balls that no neighbour pushes, with its parts; `None` unless every ball has a motion.
    pub parts: Option<FrictionSum>,
    /// Torque on the screw that carries the axial force `$h F_a$` and drives against the friction of balls,
    /// returns and seals \[N·m\].
    pub drive_torque: Option<f64>,
    /// Power out over power in; `None` without an axial load.
    pub efficiency: Option<f64>,
    /// Friction power of balls, returns and seals \[W\].
    pub heat: Option<f64>,
}

/// Third contacts of the balls that one diagonal carries.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThirdContacts {
    /// How many balls have one.
    pub count: usize,
    /// The largest load of one \[N\].
    pub largest_load: f64,
    /// Their friction torque, all together \[N·m\].
    pub torque: f64,
}

/// Motion of a ball that no neighbour pushes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeMotion {
    /// Precession relative to the nut over the relative speed, `$(P - \Omega_n)/W$`.
    pub rate: f64,
    /// Rotation against the neighbours in the train (O1) \[rad/s\].
    pub rotation: f64,
    /// The ball itself, on one flank.
    pub ball: Option<BallState>,
}

/// Model that answers for a ball, with what it decides: its friction jumps where another one is decided for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallModel {
    /// The model.
    pub model: Model,
    /// Controlling raceway of a rolling ball.
    pub control: Option<Control>,
    /// Accuracy of integrated friction that a choice by error bounds has taken.
    pub accuracy: Option<f64>,
}

impl BallModel {
    /// That of a solution; `None` if there is none.
    fn of(solution: &Solution) -> Option<Self> {
        let solved = solution.solved()?;
        let accuracy = solution.choice.and_then(|choice| match choice.basis {
            Basis::Integrated { accuracy } => Some(accuracy),
            _ => None,
        });
        let control = solved.control.map(|control| control.raceway);
        Some(Self { model: solution.model, control, accuracy })
    }
}

/// A ball with friction.
#[derive(Debug, Clone, Copy)]
struct FreeBall {
    /// Friction that the model predicts.
    friction: FrictionSum,
    /// Friction torque of its contacts divided by the torque of gross sliding on the screw (U33); 0 for models that
    /// balance friction.
    sliding_share: f64,
    /// None where the model fixes none.
    motion: Option<FreeMotion>,
    /// Load of its third contact \[N\] and the torque of that \[N·m\].
    third_contact: Option<(f64, f64)>,
    /// Mean friction coefficient of its lubricated contacts.
    mean_friction: Option<f64>,
}

/// Far flanks of a ball in its gothic arches.
#[derive(Debug, Clone, Copy)]
enum FarFlanks {
    /// With this axial play \[m\].
    WithPlay(f64),
    /// Where no play is given: as close to the ball as at rest, so that friction presses the ball onto no far flank that is
    /// not pressed at rest.
    AsAtRest,
}

/// Friction of one ball, or of all balls of a nut.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionSum {
    /// Friction torque on the screw \[N·m\], without the ball returns.
    pub torque: f64,
    /// Its parts at the contacts with nut and screw \[N·m\]: halves where a model does not tell them apart.
    pub contacts: [f64; 2],
    /// Torque of the ball returns \[N·m\].
    pub returns: f64,
    /// Part of the torque by a given force between the balls \[N·m\].
    pub ball_contact: f64,
    /// Part of the torque by drag in the lubricant \[N·m\].
    pub drag: f64,
}

impl FrictionSum {
    /// The sum with a part of another.
    fn add(&mut self, other: &Self, part: f64) {
        self.torque += part * other.torque;
        self.contacts = [0, 1].map(|side| self.contacts[side] + part * other.contacts[side]);
        self.returns += part * other.returns;
        self.ball_contact += part * other.ball_contact;
        self.drag += part * other.drag;
    }

    /// Returns the friction limited by gross sliding on the screw (U33).
    ///
    /// * `sliding_share`: friction torque of the contacts divided by the torque of gross sliding.
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

/// Friction coefficients of the balls.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlankFriction {
    /// Coefficient at the flanks that carry the axial force of a ball; `None` if the model has another friction law.
    pub loaded: Option<f64>,
    /// Coefficient at the far flanks; `None` if it equals that of the loaded flanks.
    pub far: Option<f64>,
}

impl FlankFriction {
    /// Returns one friction coefficient for all flanks.
    pub fn equal(coefficient: f64) -> Self {
        Self { loaded: Some(coefficient), far: None }
    }

    /// Returns the coefficients at loaded and far flanks, if the former is known.
    fn coefficients(self) -> Option<[f64; 2]> {
        self.loaded.map(|loaded| [loaded, self.far.unwrap_or(loaded)])
    }
}

/// Accuracy of the quadrature over the ellipses of a ball in gothic arches: far below what a constant
/// friction coefficient is worth.
const ARCHES: f64 = 1e-6;

/// Load divided by the largest load of the nut below which a ball does not determine the rate of its train.
const IDLE: f64 = 1e-3;

/// Errors of rates and rotations of free balls: of rates, whose differences matter, that of the quadrature.
const FREE_MOTION: [f64; 2] = [1e-7, 1e-4];

impl BallNut {
    /// The screw whose only ball is one of this nut (U21), with its own groove displacement and
    /// excess; `None` if the ball is loose or loaded on both flanks.
    ///
    /// * `number`: of the ball. * `friction`: coefficient. * `drive`: speeds of screw and nut.
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
        // The far flank sees the drive the other way round.
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

    /// A ball of this nut in its gothic arches, mirrored onto the flanks + if its force is negative.
    ///
    /// * `play`: of the arches \[m\]. * Other arguments as those of [`ball_alone`](Self::ball_alone).
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

    /// Returns a ball of the nominal screw in its gothic arches.
    ///
    /// * `friction`: coefficients at loaded and far flanks.
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
            at: ElasticPoint { point, ..share },
            fit,
            far_friction,
            accuracy: ARCHES,
            creep: Traction::<f64>::CREEP,
        }
    }

    /// Returns the far flanks of a ball; `None` if the ball has two contacts.
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

    /// The two bodies of a pair while the screw turns, without external load, all balls of a body alike: each ball has its
    /// part of a preload that was set at rest (AC8). Loads are those of one ball of each body.
    ///
    /// * `preload`: of the bodies against each other at rest \[N\]. * `play`: of each body \[m\]; `None` is so wide that no
    ///   ball touches a far flank. Other arguments as those of [`friction`](Self::friction).
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if the balls have no steady motion. Returns `None` unless two bodies have as many balls each and the
    /// friction coefficient is known.
    pub fn running_pair(
        &self,
        preload: f64,
        friction: FlankFriction,
        drive: &Drive<f64>,
        play: Option<f64>,
    ) -> Option<Result<RunningPair, NoAnswer>> {
        let (balls, friction) = (self.balls_of_a_pair()?, friction.coefficients()?);
        let axial_play = play.unwrap_or(f64::INFINITY);
        let fit = ArchFit { axial_play, radial_gap: self.errors.gap, oversize: 0.0 };
        let ball = self.nominal_ball(fit, friction, drive);
        let work = &mut GothicWorkspace::default();
        let pair = GothicPair::of_preload(ball, preload / count(balls), work);
        Some(pair.and_then(|pair| pair.solve(0.0, work)))
    }

    /// Balls of each of two bodies, if they have as many.
    pub fn balls_of_a_pair(&self) -> Option<usize> {
        let balls = |body: usize| {
            let of_body = self.circuits.iter().filter(|circuit| circuit.body == body);
            of_body.map(|circuit| circuit.balls).sum::<usize>()
        };
        let (first, second) = (balls(0), balls(1));
        (first > 0 && first == second && first + second == self.balls()).then_some(first)
    }

    /// Friction of all balls by a model of one ball (U21), each at the axial force that it carries without friction.
    ///
    /// A ball that friction or both flanks press onto a far flank has the balance of all its contacts (AC5) in place of
    /// the model.
    ///
    /// A ball without an answer ends the sum: those after it are not solved. A ball like the one before it has its
    /// friction.
    ///
    /// * `friction`: coefficients; without one the model has another law, and a ball on a far flank no friction
    ///   that is known. * `solve`: the model, which may lose power in the ball returns. * `drive`: speeds;
    ///   friction needs a relative speed. * `seal_torque` \[N·m\].
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
            let before = last.filter(|(other, _)| self.alike(found, *other, number));
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
        let on_both_flanks = found.balls.iter().filter(|ball| on_both(ball)).count();
        let mut friction = NutFriction {
            balls,
            motions,
            on_both_flanks,
            third_contacts,
            mean_friction: (lubricated > 0.0).then(|| coefficients / lubricated),
            parts: all.then_some(sum),
            ..NutFriction::default()
        };
        self.with_torque(&mut friction, found, drive, seal_torque, torque);
        friction
    }

    /// Gives the balls another friction torque, such as one with the pushes of a [`train`](Self::train), and what follows
    /// from it.
    pub fn with_torque(
        &self,
        friction: &mut NutFriction,
        found: &Equilibrium,
        drive: &Drive<f64>,
        seal_torque: f64,
        balls: Option<f64>,
    ) {
        let speed = drive.relative_speed();
        let all =
            balls.zip(friction.parts).map(|(balls, parts)| balls + parts.returns + seal_torque);
        let axial: f64 = found.bodies.iter().sum();
        let ideal = self.helix.lead() / std::f64::consts::TAU * axial;
        friction.torque = balls;
        // T = h F_a + sign(W) (Σ T_f + T_return + T_seal)                 (U32)
        friction.drive_torque = all.map(|torque| ideal + torque * speed.signum());
        // The load is moved if it resists the motion, else it drives.
        let is_loaded = axial.abs() > f64::EPSILON * found.forces();
        let driven = friction.drive_torque.filter(|_| is_loaded);
        friction.efficiency =
            driven.map(|torque| if ideal * speed > 0.0 { ideal / torque } else { torque / ideal });
        friction.heat = all.map(|torque| torque * speed.abs());
    }
}

/// The balls of a nut in equilibrium, asked for their friction one after the other.
struct BallByBall<'a, M> {
    nut: &'a BallNut,
    found: &'a Equilibrium,
    friction: FlankFriction,
    drive: &'a Drive<f64>,
    /// The last ball in gothic arches, and whether the flanks + carried it.
    before: Option<(bool, GothicState)>,
    arches: GothicWorkspace,
    /// The model of a ball.
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

    /// The screw whose only ball is this one, see [`BallNut::ball_alone`].
    fn alone(&self, number: usize) -> Option<ElasticPoint> {
        let friction = self.friction.loaded.unwrap_or(f64::NAN);
        self.nut.ball_alone(self.found, number, friction, self.drive)
    }

    /// Friction of a loaded ball, by itself (U21) or with far flanks (AC5).
    fn friction_of(&mut self, number: usize) -> Option<FreeBall> {
        let ball = &self.found.balls[number];
        let is_clamped = ball.flanks_pressed() == [true, true];
        let play = self.nut.play(number, self.found);
        if let Some((friction, far_flanks)) = self.friction.coefficients().zip(play) {
            let state = self.in_arches(number, (friction, far_flanks)).ok()?;
            if is_clamped || state.far_flank_carries() {
                return Some(self.free_in_arches(&state, is_clamped));
            }
        }
        if is_clamped {
            return None;
        }
        let alone = self.friction_alone(self.alone(number)?)?;
        let friction = alone.friction.limited_by_sliding(alone.sliding_share);
        let mut free = FreeBall { friction, ..alone };
        if let (None, Some(FarFlanks::WithPlay(play)), Some(mean)) =
            (self.friction.loaded, play, free.mean_friction)
        {
            let friction = [mean, self.friction.far.unwrap_or(mean)];
            free = self.with_third_contact(&free, number, (friction, play))?;
        }
        Some(free)
    }

    /// Adds what a third contact costs a lubricated ball: the surplus of dry friction of the mean coefficient (AC12).
    fn with_third_contact(
        &mut self,
        free: &FreeBall,
        number: usize,
        (friction, play): ([f64; 2], f64),
    ) -> Option<FreeBall> {
        let dry_ball = self.in_own_arches(number, friction, play);
        let found = dry_ball.solution(&mut self.arches);
        let solved = found.solved()?;
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

    /// The ball in its gothic arches under its axial force.
    fn in_own_arches(&self, number: usize, friction: [f64; 2], play: f64) -> GothicBall {
        let mut ball = self.nut.ball_in_arches(self.found, number, (friction, play), self.drive);
        ball.at.point.load = Load { axial: self.axial_force(number), balls: 1.0 };
        ball
    }

    /// Size of the axial force on a ball \[N\].
    fn axial_force(&self, number: usize) -> f64 {
        self.found.balls[number].force[0].abs() * self.nut.helix.lead_angle.cos()
    }

    /// The ball with up to four contacts.
    fn in_arches(
        &mut self,
        number: usize,
        (friction, far_flanks): ([f64; 2], FarFlanks),
    ) -> Result<GothicState, NoAnswer> {
        let axial = self.axial_force(number);
        let play = match far_flanks {
            FarFlanks::WithPlay(play) => play,
            FarFlanks::AsAtRest => {
                let ball = self.in_own_arches(number, friction, 0.0);
                ball.play_against_push(axial, &mut self.arches).unwrap_or(0.0)
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
            third_contact: third.map(|third| (third.load, third.power_share * torque)),
            mean_friction: None,
        }
    }

    /// Friction of a ball by itself (U21) as its model predicts it, before the limit by gross sliding (U33).
    fn friction_alone(&mut self, alone: ElasticPoint) -> Option<FreeBall> {
        let nut = self.nut;
        let Drive { nut_speed, .. } = alone.point.drive;
        let signed = alone.point.drive.relative_speed();
        let speed = signed.abs();
        let solution = (self.solve)(alone);
        let solved = solution.solved()?;
        let torque = solved.transmission.screw_torque?;
        let of_film = |power: fn(&OutsidePower) -> f64| {
            solved.film.map_or(0.0, |film| power(&film.outside) / speed)
        };
        let returns = of_film(|outside| outside.ball_return);
        let ball_contact = of_film(|outside| outside.ball_contact);
        let drag = of_film(|outside| outside.drag);
        let per_radian = nut.helix.lead() / std::f64::consts::TAU;
        // T_f = |T − h F|                                                 (U21)
        let torque = (torque - per_radian * alone.point.load.axial).abs() - returns;
        let contacts = solved.contact_power.map(|of| of.map(|power| power / speed));
        let contacts = contacts.unwrap_or([0.5 * torque; 2]);
        let to_nut = |motion: Motion<f64>| motion.relative_to(nut_speed, &nut.frenet());
        let of_ball = |motion| nut.free_motion(&to_nut(motion), signed, Some(&solved.ball));
        let motion = solved.ball.motion.map(of_ball);
        let friction = FrictionSum { torque, contacts, returns, ball_contact, drag };
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
        Some(FreeBall { friction, sliding_share, motion, third_contact: None, mean_friction })
    }
}

impl BallNut {
    /// Of a motion relative to the nut in the Frenet-Serret triad.
    fn free_motion(
        &self,
        to_nut: &Motion<f64>,
        speed: f64,
        ball: Option<&BallState>,
    ) -> FreeMotion {
        let rotation = to_nut.across_groove(&self.frenet().k).norm();
        FreeMotion { rate: to_nut.precession / speed, rotation, ball: ball.copied() }
    }

    /// The triad of the helix.
    fn frenet(&self) -> BallFrame<f64> {
        BallFrame::turned(self.helix.lead_angle, 0.0)
    }

    /// Sum of the friction of all balls (U21), for a search that asks for it often: balls that differ by their load
    /// alone have it from a few loads between them; `None` unless every ball has one.
    ///
    /// * `between_loads`: what this may err by, relative. * `held`: model of each ball by its number, which `solve` is given;
    ///   `None`, and balls beyond the end, decide for themselves. Other arguments as those of [`friction`](Self::friction).
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
        // The precession of a ball is at most the speed of the faster of nut and screw.
        let fastest = drive.screw_speed.abs().max(drive.nut_speed.abs());
        let inertia = self.ball.mass * self.helix.radius * fastest * fastest;
        let mut sum = FrictionSum::default();
        for group in &groups {
            of_group.set(held_of(group[0]));
            let loads = group.iter().map(|number| found.balls[*number].force[0].abs());
            let (low, high) = loads.clone().fold((f64::MAX, 0.0), |(low, high), load| {
                (f64::min(low, load), f64::max(high, load))
            });
            // As a function of the load, friction is singular only where the centrifugal force is as large as the load.
            let (low_root, high_root) = ((low - inertia).sqrt(), (high - inertia).sqrt());
            let (roots, narrow) = (low_root + high_root, high_root - low_root);
            // Each Chebyshev point reduces the error by the ratio of the ellipse through the singularity.
            let most = count(group.len());
            let points = (between_loads.ln() / (narrow / roots).ln()).ceil().clamp(1.0, most);
            // Friction bends where a far flank begins to carry.
            let bends = group.iter().any(|n| self.play(*n, found).is_some());
            if low <= inertia || points >= most || bends {
                for number in group {
                    sum.add(&each.friction_of(*number)?.friction, 1.0);
                }
                continue;
            }
            let alone = each.alone(group[0])?;
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
            // Barycentric interpolation.
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

    /// Models that answer for the balls, by their numbers; `None` of a ball without a load, or on both flanks, and in place of
    /// the list unless every other ball has an answer.
    ///
    /// Of balls that differ by their load alone the lightest and the heaviest are asked, and all if these differ. Arguments as
    /// those of [`friction`](Self::friction).
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
            let heavy =
                if self.alike(found, lightest, heaviest) { light } else { model_of(heaviest)? };
            for number in group {
                models[number] = Some(if light == heavy { light } else { model_of(number)? });
            }
        }
        Some(models)
    }

    /// The numbers of balls with a load that differ by it alone and by the displacement of their grooves; each ball on both
    /// flanks by itself.
    ///
    /// * `tolerance`: of the displacements of their grooves, at most \[m\]. * `may_join`: whether two balls may be together.
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

    /// Motions of balls that no neighbour pushes, of balls that differ by load and groove displacement alone from a few of
    /// them; `None` unless every ball with a load has one.
    ///
    /// Arguments as those of [`friction`](Self::friction).
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
                // The rates of light balls change fast.
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

    /// True if two balls differ by no more than the rounding of their loads.
    pub(crate) fn alike(&self, found: &Equilibrium, one: usize, other: usize) -> bool {
        /// Part of load and contact angle: the balance of the nut leaves 1e-12 of the loads.
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
    /// Load below which a ball is idle \[N\].
    pub(crate) fn idle_load(&self) -> f64 {
        IDLE * self.max_load()
    }

    /// Sum of the sizes of the largest loads of all balls \[N\].
    fn forces(&self) -> f64 {
        self.max_load() * count(self.balls.len())
    }
}
