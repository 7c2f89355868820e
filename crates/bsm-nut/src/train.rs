//! Ball trains: the ball advance, the gap that it requires, and the push forces between balls that
//! touch.
//!
//! Theory: `docs/theory/20-ball-train.md`, equations (O1) to (O16).

use std::convert::Infallible;
use std::f64::consts::TAU;

use bsm_dyn::{
    ElasticPoint, ModelWorkspace,
    solution::BallState,
    train::{TrainBall, TrainMotion},
};
use bsm_kin::Drive;
use bsm_newton::{Bracket, FunctionValue};

use crate::friction::FreeMotion;
use crate::geometry::count;
use crate::{BallNut, Equilibrium};

/// Largest ratio of push force to ball load at which the influence of push forces on ball loads and
/// contact angles is still neglected.
///
/// Two limits follow from this ratio. Above this ratio to the mean ball load, the friction torque is
/// only an estimate. Above this ratio to the largest ball load, the ball-train model is not valid,
/// and [`TrainError::LargePush`] is returned.
pub const MAX_PUSH_RATIO: f64 = 0.03;

/// Ball advance: the motion of balls that do not touch, relative to a cage that turns at constant
/// speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Advance {
    /// Difference between the largest and the smallest precession rate of balls that do not touch,
    /// divided by the mean rate.
    pub spread: f64,
    /// Helix angle between the centers of two balls that touch \[rad\].
    pub touch_angle: f64,
    /// Ball advance in each circuit.
    pub circuits: Vec<CircuitAdvance>,
    /// Friction torque between balls \[N·m\], divided by the friction coefficient between balls,
    /// for push forces of [`MAX_PUSH_RATIO`] times the mean ball load on every ball. Smaller push
    /// forces cause less torque.
    pub contact_torque: f64,
}

impl Advance {
    /// Returns the largest required gap of all circuits \[m\].
    pub fn largest_gap(&self) -> f64 {
        let largest = self.circuits.iter().map(|circuit| circuit.needed_gap).fold(0.0, f64::max);
        // Gaps below a nanometer are rounding errors.
        if largest < 1e-9 { 0.0 } else { largest }
    }
}

/// Ball advance in one circuit.
#[derive(Debug, Clone, PartialEq)]
pub struct CircuitAdvance {
    /// Smallest sum of the gaps in the loaded part of the circuit at which no balls touch \[m\].
    pub needed_gap: f64,
    /// Advance of each ball, in the order of the balls in the circuit; `None` for idle balls.
    pub balls: Vec<Option<BallAdvance>>,
}

/// Free advance of one ball of a circuit, without forces between the balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallAdvance {
    /// Relative precession rate of the ball without push forces, `$(P - \Omega_n)/W$`.
    pub rate: f64,
    /// Distance by which the ball is ahead of a cage that turns at constant speed \[m\].
    pub advance: f64,
}

/// Inputs of a ball train.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainInputs {
    /// Ball gap of each circuit: sum of the gaps in its loaded part, measured along the helix
    /// \[m\], positive.
    pub gaps: Vec<f64>,
    /// Thickness of the spacers between balls \[m\].
    pub spacer: f64,
    /// Friction coefficient between balls.
    pub contact_friction: f64,
    /// Push force that the ball return requires from the balls that enter it at the exit of the
    /// loaded part.
    pub exit: Exit,
    /// Force that is needed to move an unloaded ball along the circuit \[N\].
    pub idle_drag: f64,
}

/// Parameters of the push force that a ball return requires at the exit from the loaded part (O12).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exit {
    /// Push force that the ball return requires if the first loaded ball does not push against the
    /// balls in the ball return.
    pub push: ExitPush,
    /// Sum of the angles of all bends in the ball return \[rad\].
    pub bend_angle: f64,
    /// Friction coefficient between balls and ball return.
    pub friction: f64,
}

/// Place at which the push force that the ball return requires is specified. The force applies if
/// the first loaded ball does not push against the balls in the ball return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExitPush {
    /// Push force at the exit from the loaded part \[N\].
    AtExit(f64),
    /// Force that is needed to push a ball over the step into the loaded part, at the other end of
    /// the ball return \[N\].
    AtEntry(f64),
}

impl Exit {
    /// Returns the factor by which the bends in the ball return increase a push force.
    fn bend_factor(&self) -> f64 {
        (self.friction * self.bend_angle).exp()
    }

    /// Returns the push force that the ball return requires at the exit from the loaded part \[N\].
    ///
    /// * `entry`: force with which the first loaded ball pushes against the balls in the ball
    ///   return \[N\].
    /// * `centrifugal`: centrifugal term `$m v^2/2r_b$` \[N\].
    fn push(&self, entry: f64, centrifugal: f64) -> f64 {
        let factor = self.bend_factor();
        // N_x = (F_e + N_e + m v²/(2 r_b)) e^(μ_r φ_r) − m v²/(2 r_b)     (O12)
        match self.push {
            ExitPush::AtExit(push) => push + entry * factor,
            ExitPush::AtEntry(step) => (step + entry + centrifugal) * factor - centrifugal,
        }
    }
}

/// State of a ball in a train.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rolling {
    /// The ball rolls on both raceways.
    Rolls,
    /// The ball carries no load.
    Idle,
    /// The neighboring balls stop the rotation of the ball.
    Blocked,
}

/// A ball in a train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallOfTrain {
    /// State of the ball.
    pub rolling: Rolling,
    /// Relative precession rate of the ball, `$(P - \Omega_n)/W$`.
    pub rate: f64,
    /// Normal forces from the neighboring balls in front and behind \[N\]. Front and behind refer
    /// to the direction of travel.
    pub pushes: [f64; 2],
    /// Gap to the next ball \[m\].
    pub gap: f64,
}

/// Ball train of one circuit, in which the balls flow steadily.
#[derive(Debug, Clone, PartialEq)]
pub struct CircuitTrain {
    /// Relative precession rate that is common to all balls that touch each other.
    pub rate: f64,
    /// Ball flow: number of balls that pass any point of the circuit per second \[1/s\].
    pub flux: f64,
    /// Push forces between balls at the two ends of the loaded part \[N\]: at the exit, then at the
    /// entry.
    pub end_pushes: [f64; 2],
    /// Loaded and idle balls, in the order of the circuit.
    pub balls: Vec<BallOfTrain>,
}

/// Ball trains of a nut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Train {
    /// Ball train in each circuit.
    pub circuits: Vec<CircuitTrain>,
    /// Torque due to friction at the raceways if no balls touch \[N·m\].
    pub free_torque: f64,
    /// Torque due to friction at the raceways, including the effect of push forces \[N·m\].
    pub raceway_torque: f64,
    /// Torque due to friction between balls and due to moving the idle balls \[N·m\].
    pub contact_torque: f64,
    /// Torque that is needed to push the balls through the ball returns \[N·m\].
    pub return_torque: f64,
    /// Torque due to the energy that is lost when faster balls catch up with the ball train
    /// \[N·m\].
    pub catching_torque: f64,
    /// Relative error of the power balance: the power supplied by screw and load minus all losses,
    /// divided by the losses.
    pub power_balance: f64,
    /// Number of ball-to-ball contacts that transmit a push force.
    pub touching_contacts: usize,
    /// Largest push force between balls \[N\].
    pub largest_push: f64,
}

impl Train {
    /// Returns the total friction torque \[N·m\].
    pub fn torque(&self) -> f64 {
        self.raceway_torque + self.contact_torque + self.return_torque + self.catching_torque
    }

    /// Returns the number of balls in a given state.
    pub fn number_of(&self, rolling: Rolling) -> usize {
        let balls = self.circuits.iter().flat_map(|circuit| &circuit.balls);
        balls.filter(|ball| ball.rolling == rolling).count()
    }
}

/// Reason why a ball train has no steady flow or why none was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrainError {
    /// A ball is loaded on both flanks, but the ball-train model does not support such balls.
    #[error(
        "a ball is loaded on both flanks, but push forces are calculated only for balls that are loaded on one flank"
    )]
    BothFlanks,
    /// The gaps between the balls of a circuit add up to zero.
    #[error("circuit {circuit} has no gap between its balls")]
    NoGap {
        /// Index of the circuit.
        circuit: usize,
    },
    /// A ball return requires a larger push force than the balls can provide.
    #[error(
        "the ball return needs a push force of {needed:.3} N, but the balls can provide only {available:.3} N"
    )]
    Return {
        /// Push force required at the exit from the loaded part \[N\].
        needed: f64,
        /// Largest push force that all balls together can provide before they slide \[N\].
        available: f64,
    },
    /// A push force exceeds [`MAX_PUSH_RATIO`] times the largest ball load, so the ball-train model
    /// is not valid.
    #[error("the push forces between balls exceed {push:.3} N, which is {:.1} % of the largest ball load", 100.0 * part)]
    LargePush {
        /// Lower bound on the largest push force \[N\], calculated at a speed below the actual
        /// speed of the ball train.
        push: f64,
        /// Push force divided by the largest ball load.
        part: f64,
    },
    /// A circuit carries no load, so the speed of its balls is undetermined.
    #[error("circuit {circuit} carries no load, so the speed of its balls is unknown")]
    Unloaded {
        /// Index of the circuit.
        circuit: usize,
    },
    /// A ball has no steady motion even without push forces.
    #[error("a ball of circuit {circuit} has no steady motion, even without push forces")]
    NoMotion {
        /// Index of the circuit.
        circuit: usize,
    },
    /// The solver found no solution for a ball or for the steady flow in a circuit.
    #[error("the push forces in circuit {circuit} could not be calculated: {what}")]
    NotConverged {
        /// Index of the circuit.
        circuit: usize,
        /// Description of what could not be calculated.
        what: &'static str,
    },
}

impl BallNut {
    /// Returns the helix angle between two balls whose centers are separated by one ball diameter
    /// plus one spacer \[rad\] (O8).
    pub fn touch_angle(&self, spacer: f64) -> f64 {
        let distance = 2.0 * self.ball.radius + spacer;
        let per_radian = self.helix.lead() / TAU;
        let missing = |angle: f64| {
            let chord = 2.0 * self.helix.radius * (0.5 * angle).sin();
            // [2 r_m sin(θ_c/2)]² + (h θ_c)² = c²                         (O8)
            chord.hypot(per_radian * angle) - distance
        };
        let straight = distance / self.helix.arc_length_per_radian();
        let ends = [straight, std::f64::consts::FRAC_PI_2 * straight];
        Bracket::new(ends, ends.map(missing)).root(missing).root().map_or(straight, |root| root.x)
    }

    /// Returns the number of balls that fit into the loaded arc of a circuit.
    ///
    /// * `spacer`: thickness of the spacers between balls \[m\].
    pub fn ball_capacity(&self, circuit: usize, spacer: f64) -> f64 {
        (self.circuits[circuit].arc / self.touch_angle(spacer)).floor()
    }

    /// Returns the indices of the balls in a circuit, sorted in the direction of travel.
    fn in_travel(found: &Equilibrium, circuit: usize, speed: f64) -> Vec<usize> {
        let numbers = 0..found.positions.len();
        let mut order: Vec<_> =
            numbers.filter(|n| found.positions[*n].circuit == circuit).collect();
        if speed < 0.0 {
            order.reverse();
        }
        order
    }

    /// Returns the ball advance, assuming that balls do not touch. Returns `None` if any loaded
    /// ball has no steady motion.
    ///
    /// * `motions`: motion of each ball without push forces, from
    ///   [`NutFriction`](crate::friction::NutFriction).
    /// * `spacer`: thickness of the spacers between balls \[m\].
    pub fn advance(
        &self,
        found: &Equilibrium,
        motions: &[Option<FreeMotion>],
        drive: &Drive<f64>,
        spacer: f64,
    ) -> Option<Advance> {
        let speed = drive.relative_speed();
        let arc = self.helix.arc_length_per_radian();
        let idle = found.idle_load();
        let of = |number: usize| -> Option<Option<FreeMotion>> {
            let is_idle = found.balls[number].max_load() < idle;
            if is_idle { Some(None) } else { motions.get(number)?.map(Some) }
        };
        let motions = (0..found.balls.len()).map(of).collect::<Option<Vec<_>>>()?;
        let touch_angle = self.touch_angle(spacer);
        let summed = |numbers: &[usize]| {
            let rates = numbers.iter().filter_map(|n| Some(motions[*n]?.rate));
            let start = (0.0, 0.0, f64::MAX, f64::MIN);
            rates.fold(start, |(n, sum, low, high), rate| {
                (n + 1.0, sum + rate, low.min(rate), high.max(rate))
            })
        };
        let all: Vec<_> = (0..motions.len()).collect();
        let (number, sum, low, high) = summed(&all);
        let spread = if number > 0.0 { (high - low) * number / sum } else { 0.0 };
        let circuits = self.circuits.iter().enumerate().map(|(circuit, of)| {
            let order = Self::in_travel(found, circuit, speed);
            let (number, sum, low, _) = summed(&order);
            // X_0 = d θ_c Σ (p_j/p_min − 1)                                (O15)
            let needed_gap =
                if number > 0.0 { arc * touch_angle * (sum / low - number).max(0.0) } else { 0.0 };
            let (mean, spacing) = (sum / number, arc * of.arc / count(of.balls));
            let mut gained = 0.0;
            let mut balls: Vec<_> = order
                .iter()
                .map(|n| {
                    let rate = motions[*n]?.rate;
                    // A_j = Σ a_j Δ,  a_j = p_j/p̄ − 1                     (O14)
                    gained += (rate / mean - 1.0) * spacing;
                    Some(BallAdvance { rate, advance: gained })
                })
                .collect();
            if speed < 0.0 {
                balls.reverse();
            }
            CircuitAdvance { needed_gap, balls }
        });
        let circuits = circuits.collect();
        let rotations: f64 = motions.iter().flatten().map(|motion| motion.rotation).sum();
        let push = MAX_PUSH_RATIO * found.mean_load();
        let contact_torque = 2.0 * self.ball.radius * rotations * push / speed.abs();
        Some(Advance { spread, touch_angle, circuits, contact_torque })
    }

    /// Returns the ball trains of all circuits, including the push forces between balls that touch
    /// (O8) to (O16).
    ///
    /// * `motions`: motion of each ball without push forces, from
    ///   [`NutFriction`](crate::friction::NutFriction).
    /// * `friction`: friction coefficient at the raceways; `None` if another friction law applies.
    /// * `in_train`: function that returns the model of a ball under push forces. Its arguments are
    ///   an operating point and the state of the ball without push forces.
    ///
    /// # Errors
    ///
    /// Returns [`TrainError`] if no steady flow exists or was found.
    pub fn train(
        &self,
        found: &Equilibrium,
        motions: &[Option<FreeMotion>],
        friction: Option<f64>,
        drive: &Drive<f64>,
        inputs: &TrainInputs,
        in_train: impl Fn(ElasticPoint, &BallState, &mut ModelWorkspace) -> Option<TrainBall>,
    ) -> Result<Train, TrainError> {
        let (idle, mut work) = (found.idle_load(), ModelWorkspace::default());
        let mut balls: Vec<Option<TrainBall>> = Vec::with_capacity(found.balls.len());
        for number in 0..found.balls.len() {
            let circuit = found.positions[number].circuit;
            let ball = if found.balls[number].max_load() < idle {
                None
            } else if found.balls[number].flanks_pressed() == [true, true] {
                return Err(TrainError::BothFlanks);
            } else if number > 0
                && balls[number - 1].is_some()
                && self.have_equal_loads(found, number - 1, number)
            {
                balls[number - 1].clone()
            } else {
                let free = motions.get(number).and_then(|motion| motion.as_ref()?.ball.as_ref());
                let alone = self.ball_alone(found, number, friction.unwrap_or(f64::NAN), drive);
                let ball = alone.zip(free).and_then(|(at, free)| in_train(at, free, &mut work));
                Some(ball.ok_or(TrainError::NoMotion { circuit })?)
            };
            balls.push(ball);
        }
        let mut train = Train::default();
        let speed = drive.relative_speed();
        let touch_angle = self.touch_angle(inputs.spacer);
        let (mut put_in, mut lost) = (0.0, 0.0);
        for circuit in 0..self.circuits.len() {
            let order = Self::in_travel(found, circuit, speed);
            let balls = order.iter().map(|number| balls[*number].as_ref()).collect();
            let flow = Flow::of(self, inputs, speed, touch_angle, circuit, balls);
            let pass = flow.steady(found.max_load(), &mut work)?;
            let circuit = flow.train(&pass, speed < 0.0);
            let [raceways, contacts, returns, catching] = flow.losses(&pass);
            train.raceway_torque += raceways / speed.abs();
            train.contact_torque += contacts / speed.abs();
            train.return_torque += returns / speed.abs();
            train.catching_torque += catching / speed.abs();
            train.free_torque +=
                flow.rolling().map(|ball| ball.free().raceway_power).sum::<f64>() / speed.abs();
            lost += raceways + contacts + returns + catching;
            put_in += flow.power_in(&pass);
            let [exit, _] = circuit.end_pushes;
            let pushes = circuit.balls.iter().flat_map(|ball| ball.pushes).chain([exit]);
            train.largest_push = pushes.fold(train.largest_push, f64::max);
            train.touching_contacts +=
                pass.states.iter().skip(1).filter(|state| state.pushes[1] > 0.0).count();
            train.circuits.push(circuit);
        }
        train.power_balance = if lost > 0.0 { (put_in - lost) / lost } else { 0.0 };
        Ok(train)
    }
}

/// Data that are needed to calculate the steady flow of balls in a circuit.
struct Flow<'a> {
    nut: &'a BallNut,
    inputs: &'a TrainInputs,
    /// Relative speed of screw and nut \[rad/s\].
    speed: f64,
    /// Index of the circuit.
    circuit: usize,
    /// Given ball gap of the circuit \[m\].
    ball_gap: f64,
    /// Helix angle between the centers of two balls that touch \[rad\].
    touch_angle: f64,
    /// Balls of the circuit, in the direction of travel; `None` for idle balls.
    balls: Vec<Option<&'a TrainBall>>,
    /// Centrifugal term `$m v^2/2r_b$` of balls without push forces \[N\].
    centrifugal: f64,
}

/// State of a ball at a given precession rate of the ball train.
#[derive(Debug, Clone, Copy)]
struct State {
    rolling: Rolling,
    rate: f64,
    pushes: [f64; 2],
    /// Motion of the ball; `None` for idle and blocked balls.
    motion: Option<TrainMotion>,
    /// Derivatives of the precession rate of this ball and of the push force from behind with
    /// respect to the precession rate of the ball train.
    by_train: [f64; 2],
    /// Precession rate of the ball train and push force from the front, for which this state was
    /// calculated.
    of: [f64; 2],
}

/// State of a circuit at a given precession rate of the ball train.
#[derive(Debug, Clone)]
struct CircuitState {
    rate: f64,
    states: Vec<State>,
    /// Push force between balls at the exit from the loaded part \[N\].
    exit: f64,
}

impl CircuitState {
    /// Returns the force with which the first loaded ball pushes against the balls in the ball
    /// return \[N\].
    fn entry(&self) -> f64 {
        self.states.first().map_or(0.0, |state| state.pushes[1])
    }
}

/// Permitted relative change of the push force at the entry between two passes around the circuit.
/// The iteration ends if the change is smaller.
const ENTRY_TOLERANCE: f64 = 1e-9;
/// Maximum number of passes around a circuit. If at least one ball is not pushed from behind, two
/// passes are sufficient, because the state of this ball does not depend on the balls behind it.
const MAX_PASSES: usize = 40;
/// Length of the first bracketing step divided by the precession rate. Bracketing is used if
/// Newton's method does not find the precession rate of the ball train.
const FIRST_BRACKET_STEP: f64 = 1e-4;
/// Length of a bracketing step divided by the length of the previous step.
const BRACKET_GROWTH: f64 = 3.0;
/// Maximum number of steps in the bracketing search for the precession rate.
const MAX_BRACKET_STEPS: usize = 12;
/// Minimum ratio of the friction moment from the neighboring balls to the moment that stops a ball
/// (O6). A ball without a steady motion counts as blocked only if its ratio is at least this large.
/// The limit is below 1 because the friction at the raceways must also support the difference
/// between the push forces.
const MIN_STOPPED_SHARE: f64 = 0.9;
/// Minimum ratio of the ball gap to the length that a touching ball occupies. Below this ratio, the
/// ball gap is smaller than the rounding errors of the precession rates.
const FULL_TRAIN_TOLERANCE: f64 = 1e-12;
/// Permitted error of the ball gap, divided by the ball gap.
const GAP_TOLERANCE: f64 = 1e-6;
/// Permitted relative error of the precession rate of the ball train.
const RATE_TOLERANCE: f64 = 1e-11;

impl<'a> Flow<'a> {
    /// Collects the data of a circuit.
    fn of(
        nut: &'a BallNut,
        inputs: &'a TrainInputs,
        speed: f64,
        touch_angle: f64,
        circuit: usize,
        balls: Vec<Option<&'a TrainBall>>,
    ) -> Self {
        let ball_gap = inputs.gaps[circuit];
        let mut flow =
            Self { nut, inputs, speed, circuit, ball_gap, touch_angle, balls, centrifugal: 0.0 };
        let (number, sum) =
            flow.rolling().fold((0.0, 0.0), |(n, sum), ball| (n + 1.0, sum + ball.free().rate));
        let speed = flow.speed_of(if number > 0.0 { sum / number } else { 0.0 });
        flow.centrifugal = nut.ball.mass * speed * speed / (2.0 * nut.ball.radius);
        flow
    }
}

impl Flow<'_> {
    fn rolling(&self) -> impl Iterator<Item = &TrainBall> {
        self.balls.iter().flatten().copied()
    }

    /// Returns the length along the helix that a ball and its spacer occupy if the balls touch
    /// \[m\].
    fn pitch(&self) -> f64 {
        self.nut.helix.arc_length_per_radian() * self.touch_angle
    }

    /// Converts a relative precession rate to a ball speed along the helix \[m/s\].
    fn speed_of(&self, rate: f64) -> f64 {
        self.nut.helix.arc_length_per_radian() * self.speed.abs() * rate
    }

    /// Returns the ball gap that results from the given rates of the balls and of the ball train
    /// (O10), minus the given ball gap. The difference is divided by the length that a touching
    /// ball occupies.
    fn surplus(&self, rate: f64, rates: impl Iterator<Item = f64>) -> f64 {
        // Σ (p_j/p_c − 1) = X/(d θ_c)                                     (O10)
        let gained: f64 = rates.map(|of_ball| of_ball / rate - 1.0).sum();
        gained - self.ball_gap / self.pitch()
    }

    /// Returns the difference between the resulting and the given ball gap, assuming that the
    /// precession rate of each ball is a linear function of the push forces.
    fn linear(&self, rate: f64) -> f64 {
        let mut entry = 0.0;
        let mut surplus = 0.0;
        for _ in 0..MAX_PASSES {
            let mut push = self.inputs.exit.push(entry, self.centrifugal);
            let rates = self.balls.iter().rev().map(|ball| {
                let Some(ball) = ball else {
                    push += self.inputs.idle_drag;
                    return rate;
                };
                let [by_front, by_back] = ball.free().compliances();
                let free = ball.free().rate + by_front * push;
                // N_b = max(0, N_f − (p_free − p_c)/c)                    (O11)
                push = ((rate - free) / by_back).max(0.0);
                free.max(rate)
            });
            surplus = self.surplus(rate, rates);
            if (push - entry).abs() <= ENTRY_TOLERANCE * push {
                break;
            }
            entry = push;
        }
        surplus
    }

    /// Solves all balls of the circuit at a given precession rate of the ball train, starting with
    /// the ball at the exit (O11). The calculation is repeated until the push force at the entry is
    /// constant. Returns the difference between the resulting and the given ball gap (O10).
    fn pass(
        &self,
        rate: f64,
        last: &mut CircuitState,
        work: &mut ModelWorkspace,
    ) -> Result<FunctionValue, &'static str> {
        last.rate = rate;
        let (mut entry, bend_factor) = (last.entry(), self.inputs.exit.bend_factor());
        let mut entry_by_train = 0.0;
        for _ in 0..MAX_PASSES {
            last.exit = self.inputs.exit.push(entry, self.centrifugal);
            let mut front = [last.exit, bend_factor * entry_by_train];
            for (ball, state) in self.balls.iter().zip(&mut last.states).rev() {
                *state = self.state(*ball, state, rate, front, work)?;
                front = [state.pushes[1], state.by_train[1]];
            }
            // If all balls touch, the ball gap is zero, and every pass increases the push force by
            // the force that the ball return requires. The ball gap is reliable only if the
            // iteration started without a push force at the entry. Therefore, a push force that was
            // calculated for another rate is reset to zero.
            let all_touch = last.states.iter().all(|state| state.rate <= rate);
            let before = entry;
            [entry, entry_by_train] = if all_touch { [0.0; 2] } else { front };
            if (entry - before).abs() <= ENTRY_TOLERANCE * before {
                let value = self.surplus(rate, last.states.iter().map(|state| state.rate));
                let slopes = last.states.iter().map(|state| state.by_train[0] - state.rate / rate);
                return Ok(FunctionValue { value, slope: Some(slopes.sum::<f64>() / rate) });
            }
        }
        Err("the push force at the entry did not converge")
    }

    /// Returns the state of a ball for a given push force from the front, including the derivative
    /// of the push force from behind with respect to the precession rate of the ball train.
    fn state(
        &self,
        ball: Option<&TrainBall>,
        last: &State,
        rate: f64,
        [front, by_train]: [f64; 2],
        work: &mut ModelWorkspace,
    ) -> Result<State, &'static str> {
        let of = [rate, front];
        let passes_on = |rolling| State {
            rolling,
            rate,
            pushes: [front, front + self.inputs.idle_drag],
            motion: None,
            by_train: [1.0, by_train],
            of,
        };
        let Some(ball) = ball else { return Ok(passes_on(Rolling::Idle)) };
        let free = ball.free();
        let rolls = |motion: TrainMotion, by_train| State {
            rolling: Rolling::Rolls,
            rate: motion.rate,
            pushes: motion.pushes,
            motion: Some(motion),
            by_train,
            of,
        };
        if front <= 0.0 && free.rate >= rate {
            return Ok(rolls(*free, [0.0; 2]));
        }
        // 2 f_b N_f > f (Q_A + Q_B)                                       (O6)
        let stopped = 2.0 * self.inputs.contact_friction * front / ball.sliding_push();
        if stopped > 1.0 {
            return Ok(passes_on(Rolling::Blocked));
        }
        let caught = |motion: TrainMotion| {
            let [by_front, _] = motion.compliances();
            rolls(motion, [by_front * by_train, 0.0])
        };
        let held = |motion: TrainMotion| {
            let [by_front, by_back] = motion.compliances();
            // The derivative of the push force from behind is dN_b/dp_c = (1 − c_f dN_f/dp_c)/c_b.
            let back = (1.0 - by_front * by_train) / by_back;
            (by_back > 0.0)
                .then(|| rolls(motion, [1.0, back]))
                .ok_or("the speed of a ball does not increase with the push force from behind")
        };
        let is_known = last.of.map(f64::to_bits) == of.map(f64::to_bits);
        if let Some(motion) = last.motion.filter(|_| is_known) {
            return if motion.pushes[1] > 0.0 { held(motion) } else { Ok(caught(motion)) };
        }
        let from = last.motion.as_ref().unwrap_or(free);
        let catch = |work: &mut ModelWorkspace| {
            let alone = [front, 0.0];
            ball.pushed(from, alone, work).or_else(|| ball.pushed(free, alone, work))
        };
        if from.back_push(rate, front) <= 0.0
            && let Some(motion) = catch(work).filter(|motion| motion.rate >= rate)
        {
            return Ok(caught(motion));
        }
        let found = ball.at_rate(from, rate, front, work);
        let found = found.or_else(|| ball.at_rate(free, rate, front, work));
        if let Some(found) = found.filter(|found| found.pushes[1] >= 0.0) {
            return held(found);
        }
        let caught_up = found.and_then(|_| catch(work));
        match caught_up {
            Some(motion) => Ok(caught(motion)),
            None if stopped > MIN_STOPPED_SHARE => Ok(passes_on(Rolling::Blocked)),
            None => Err("a ball in the ball train has no steady motion"),
        }
    }

    /// Returns the state of the circuit at the precession rate of the ball train that leads to the
    /// given ball gap.
    ///
    /// * `largest_load`: largest ball load in the nut \[N\].
    fn steady(
        &self,
        largest_load: f64,
        work: &mut ModelWorkspace,
    ) -> Result<CircuitState, TrainError> {
        let rates: Vec<_> = self.rolling().map(|ball| ball.free().rate).collect();
        if rates.is_empty() {
            return Err(TrainError::Unloaded { circuit: self.circuit });
        }
        if self.ball_gap < FULL_TRAIN_TOLERANCE * self.pitch() {
            return Err(TrainError::NoGap { circuit: self.circuit });
        }
        let needed = self.check_return()?;
        // p_c = Σ p_j/(Z + X/(d θ_c))                                     (O13)
        let free_rate =
            rates.iter().sum::<f64>() / (count(rates.len()) + self.ball_gap / self.pitch());
        let slowest = rates.iter().copied().fold(f64::MAX, f64::min);
        let is_pushed = needed > 0.0 || self.inputs.idle_drag > 0.0;
        if free_rate <= slowest && !is_pushed {
            return Ok(self.without_pushes(free_rate));
        }
        let linear = |rate| self.linear(rate);
        let begin = [0.5 * free_rate, 2.0 * free_rate];
        let guess = Bracket { x_tol: 1e-9, ..Bracket::new(begin, begin.map(linear)) }.root(linear);
        let guess = guess.root().map_or(free_rate, |root| root.x);
        let mut pass = CircuitState { rate: 0.0, states: self.free_states(), exit: 0.0 };
        let mut why = "no speed of the ball train leads to the given gap between the balls";
        let mut least_push = needed;
        let mut surplus = |rate: f64| match self.pass(rate, &mut pass, work) {
            Ok(value) => {
                // Push forces increase with the precession rate of the ball train. If the ball gap
                // at the current rate is larger than the given gap, the solution has a higher rate
                // and larger push forces.
                if value.value > 0.0 {
                    least_push = pass
                        .states
                        .iter()
                        .fold(least_push, |most, state| most.max(state.pushes[1]));
                }
                value
            }
            // At this precession rate, the balls cannot provide the required push force, so the
            // rate of the solution is lower.
            Err(what) => {
                pass.states = self.free_states();
                why = what;
                f64::NEG_INFINITY.into()
            }
        };
        let residual = Self::solve_surplus(guess, &mut surplus);
        if !self.is_converged(residual) {
            return Err(self.failure(least_push, largest_load, why));
        }
        // The ball gap must decrease with increasing precession rate. Otherwise, the same ball gap
        // may also result from a second rate.
        if !residual.slope.is_some_and(|slope| slope < 0.0) {
            return Err(self.not_converged(
                "more than one speed of the ball train leads to the given gap between the balls",
            ));
        }
        Ok(pass)
    }

    /// Returns the push force that the ball return requires at the exit from the loaded part if the
    /// first loaded ball does not push against the balls in the ball return \[N\].
    ///
    /// # Errors
    ///
    /// Returns [`TrainError::Return`] if the balls cannot provide this push force.
    fn check_return(&self) -> Result<f64, TrainError> {
        let needed = self.inputs.exit.push(0.0, self.centrifugal);
        // The push force of a ball is at most the friction force of both contacts in full sliding.
        // A ball cannot push if the ball in front stops its rotation (O6).
        let given = self.rolling().map(TrainBall::sliding_push);
        let (sum, most) = given.fold((0.0, 0.0), |(sum, most), of| (sum + of, f64::max(most, of)));
        let available = f64::min(sum, most / (2.0 * self.inputs.contact_friction));
        if needed > available { Err(TrainError::Return { needed, available }) } else { Ok(needed) }
    }

    /// Returns the states of balls that do not touch. The rate of idle balls is set to zero.
    fn free_states(&self) -> Vec<State> {
        let free = |ball: Option<&TrainBall>| State {
            rolling: if ball.is_some() { Rolling::Rolls } else { Rolling::Idle },
            rate: ball.map_or(0.0, |ball| ball.free().rate),
            pushes: [0.0; 2],
            motion: ball.map(|ball| *ball.free()),
            by_train: [0.0; 2],
            of: [f64::NAN; 2],
        };
        self.balls.iter().copied().map(free).collect()
    }

    /// Returns the state of a circuit in which no balls touch.
    ///
    /// * `free_rate`: precession rate of the ball train, and therefore of the idle balls.
    fn without_pushes(&self, free_rate: f64) -> CircuitState {
        let mut states = self.free_states();
        for state in states.iter_mut().filter(|state| state.motion.is_none()) {
            state.rate = free_rate;
        }
        CircuitState { rate: free_rate, states, exit: 0.0 }
    }

    /// Returns true if the resulting ball gap agrees with the given ball gap.
    ///
    /// * `residual`: difference between both gaps, from [`pass`](Self::pass).
    fn is_converged(&self, residual: FunctionValue) -> bool {
        let allowed =
            GAP_TOLERANCE * self.ball_gap / self.pitch() + RATE_TOLERANCE * count(self.balls.len());
        residual.value.abs() <= allowed
    }

    /// Returns the reason why no precession rate of the ball train leads to the given ball gap.
    ///
    /// * `least_push`: lower bound on the largest push force \[N\].
    /// * `largest_load`: largest ball load in the nut \[N\].
    /// * `why`: reason if the push forces are within the range of the ball-train model.
    fn failure(&self, least_push: f64, largest_load: f64, why: &'static str) -> TrainError {
        let (push, part) = (least_push, least_push / largest_load);
        if part > MAX_PUSH_RATIO {
            TrainError::LargePush { push, part }
        } else {
            self.not_converged(why)
        }
    }

    fn not_converged(&self, what: &'static str) -> TrainError {
        TrainError::NotConverged { circuit: self.circuit, what }
    }

    /// Finds the root of a function that decreases with the precession rate, and returns the
    /// function value at the root. Newton's method is used as long as each step is at most half as
    /// long as the previous step. After that, the root is bracketed.
    fn solve_surplus(guess: f64, surplus: &mut impl FnMut(f64) -> FunctionValue) -> FunctionValue {
        // Newton steps come first, because the calculation of each state starts from the previous
        // state. In a wide bracket, the previous state would be a poor starting point.
        let (mut rate, mut here, mut last) = (guess, surplus(guess), f64::INFINITY);
        loop {
            let slope = here.slope.filter(|slope| *slope < 0.0);
            let step = slope.map_or(f64::INFINITY, |slope| -here.value / slope);
            if step.abs() <= RATE_TOLERANCE * rate {
                return here;
            }
            if !step.is_finite() || step.abs() > 0.5 * last {
                break;
            }
            last = step.abs();
            rate += step;
            here = surplus(rate);
        }
        let places = (0..MAX_BRACKET_STEPS).scan((rate, FIRST_BRACKET_STEP), |(rate, step), _| {
            *rate *= 1.0 + *step * here.value.signum();
            *step *= BRACKET_GROWTH;
            Some(*rate)
        });
        let value_at = |rate| Ok::<_, Infallible>(surplus(rate).value);
        let Ok(change) = Bracket::first_sign_change((rate, here.value), places, value_at);
        let bracket =
            change.map(|change| Bracket { x_tol: RATE_TOLERANCE, f_tol: 1e-13, ..change });
        match bracket.and_then(|bracket| bracket.root(&mut *surplus).root()) {
            Some(root) => surplus(root.x),
            None => here,
        }
    }

    /// Returns the power losses \[W\] at the raceways, between balls (including the motion of idle
    /// balls), in the ball return, and at the positions where faster balls catch up with the ball
    /// train.
    fn losses(&self, pass: &CircuitState) -> [f64; 4] {
        let mut lost = [0.0; 4];
        for (ball, state) in self.balls.iter().zip(&pass.states) {
            let speed = self.speed_of(state.rate);
            if let (Some(ball), Some(motion)) = (ball, state.motion) {
                lost[0] += motion.raceway_power;
                lost[1] += ball.contact_power(&motion);
            } else {
                lost[0] += ball.map_or(0.0, |ball| self.blocked(ball, state.rate));
                lost[1] += self.inputs.idle_drag * speed;
            }
        }
        for pair in pass.states.windows(2) {
            let [behind, ahead] = [pair[0].rate, pair[1].rate].map(|rate| self.speed_of(rate));
            // Between balls: Σ f_b r_b (N_f + N_b)|w| + Σ F_i v; in the ball return: N_x v_Z − N_e
            // v_1; where balls catch up: Σ N (v_behind − v_ahead) (O16)
            lost[3] += pair[0].pushes[0] * (behind - ahead);
        }
        let [first, last] = [pass.states.first(), pass.states.last()]
            .map(|state| state.map_or(0.0, |state| self.speed_of(state.rate)));
        lost[2] = pass.exit * last - pass.entry() * first;
        lost
    }

    /// Returns the power loss of a ball that slides on both raceways without rotating \[W\].
    fn blocked(&self, ball: &TrainBall, rate: f64) -> f64 {
        let ([nut, screw], speed) = (ball.free().loads, self.speed_of(rate));
        // P = f Q_A v + f Q_B (d|W| − v)                                  (O7)
        ball.friction() * (nut * speed + screw * (self.speed_of(1.0) - speed))
    }

    /// Returns the power supplied by screw and load \[W\].
    fn power_in(&self, pass: &CircuitState) -> f64 {
        let of = |(ball, state): (Option<&TrainBall>, &State)| match (ball, &state.motion) {
            (Some(ball), Some(motion)) => ball.power_in(motion),
            (Some(ball), None) => self.blocked(ball, state.rate),
            (None, _) => 0.0,
        };
        self.balls.iter().copied().zip(&pass.states).map(of).sum()
    }

    /// Returns the ball train, with the balls in the order of the circuit.
    fn train(&self, pass: &CircuitState, is_reversed: bool) -> CircuitTrain {
        let mut balls: Vec<_> = pass
            .states
            .iter()
            .map(|state| BallOfTrain {
                // Gap: d (θ_c p_j/p_c − θ_c)                              (O9)
                gap: self.pitch() * (state.rate / pass.rate - 1.0),
                rolling: state.rolling,
                rate: state.rate,
                pushes: state.pushes,
            })
            .collect();
        if is_reversed {
            balls.reverse();
        }
        CircuitTrain {
            rate: pass.rate,
            // Φ = p_c |W|/θ_c                                             (O8)
            flux: pass.rate * self.speed.abs() / self.touch_angle,
            end_pushes: [pass.exit, pass.entry()],
            balls,
        }
    }
}
