//! States in which as much heat leaves each node as it gets, and the fold beyond which there is none.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I8) and (I18) to (I20).

use std::array::from_fn;
use std::cell::Cell;
use std::fmt;

use bsm_dyn::ZERO_CELSIUS;
use bsm_newton::{
    Convergence, Dense, Equations, EvalError, Homotopy, JacobianUpdate, Linearized, Options,
    Outcome, Scales, Seed, StepControl, Trace, Workspace, solve, trace,
};

use nalgebra::{Matrix3, Schur};

use super::coupling::{BETWEEN_LOADS, ModelsOfPhases};
use super::{HeatSources, NODES, NutAtTemperature, WarmNut, celsius};
use crate::NutError;

/// Temperature above which no state counts \[K\].
const HOTTEST: f64 = ZERO_CELSIUS + 180.0;

/// Difference of temperatures \[K\] that a slope is taken over, and of the speed factor, relative to it. Over two of them, up
/// and down, the error of the slope, their square, and the rounding of the loads, 1e-12 over them, are both below 1e-8.
const DIFFERENCE: f64 = 2e-3;
const SPEED_DIFFERENCE: f64 = 1e-4;

/// What friction may err by between the loads of balls where Newton's method and a walk take the slopes of their steps.
const OF_STEPS: f64 = 1e-3;

/// Longest Newton step \[K\].
const LONGEST_STEP: f64 = 8.0;

/// Speed factors at which the walk from rest begins: the first that has a state.
const FIRST_FACTORS: [f64; 4] = [0.05, 5e-3, 5e-4, 5e-5];

/// Size of a temperature on the walk \[K\], and of the speed factor.
const SIZES: (f64, f64) = (20.0, 1.0);

/// Longest step of a walk in these sizes, and of one whose points are wanted.
const STRIDE: f64 = 0.5;
const CLOSE: f64 = 0.25;

/// Part of the speed of a fold down to which the states beyond it are followed.
const BACK: f64 = 0.8;

/// Tolerance of the heat balance, relative to the heat.
const RESIDUAL_TOLERANCE: f64 = 1e-10;

/// Maximum number of Newton steps to a steady state.
const MAX_THERMAL_STEPS: usize = 60;

/// Sweeps that eigenvalues may take: three of a matrix converge in some ten.
const MOST_SWEEPS: usize = 200;

/// Nodes that have friction.
const FRICTION_NODES: usize = 3;

/// Part of a step to which a fold is placed: its speed is flat in it, so that this leaves 1e-6 of that.
const ROOT_TOLERANCE: f64 = 1e-3;

/// A warm steady state.
#[derive(Debug, Clone)]
pub struct Steady {
    /// Rise of each node over the temperature of setting \[K\].
    pub rises: [f64; NODES],
    /// What the nut does there.
    pub heated: NutAtTemperature,
    /// Loop gain: 0 without coupling, 1 where the state is lost (I18).
    pub gain: f64,
    /// True if balls would decide for another model, or another controlling raceway, in this state: it lies on the jump of
    /// friction between both, and has the friction of one side.
    pub on_jump: bool,
    /// Models of the balls that its friction has.
    models: ModelsOfPhases,
}

impl Steady {
    /// Heat of all nodes \[W\].
    pub fn heat(&self) -> f64 {
        self.heated.heat.iter().sum()
    }

    /// Heat of nut, screw and balls, without the bearings and the motor \[W\].
    pub fn nut_heat(&self) -> f64 {
        self.heated.heat[..FRICTION_NODES].iter().sum()
    }
}

/// Where the branch of states turns back: the largest speed that has one (I20).
#[derive(Debug, Clone)]
pub struct Fold {
    /// Factor on all speeds.
    pub factor: f64,
    /// Rises of the nodes there over the temperature of setting \[K\].
    pub rises: [f64; NODES],
    /// Temperature of setting \[K\].
    pub set: f64,
    /// Preload without load there \[N\]; `None` of a nut without one.
    pub preload: Option<f64>,
    /// The unstable state beyond it at the speeds themselves, if the fold is above them.
    pub unstable: Option<Steady>,
}

impl fmt::Display for Fold {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { factor, preload, .. } = self;
        let [nut, screw, balls, ..] = celsius(self.set, &self.rises);
        write!(
            to,
            "runs away above {factor:.2} of these speeds; there nut {nut:.0}, screw {screw:.0}, balls {balls:.0} C"
        )?;
        preload.map_or(Ok(()), |preload| write!(to, ", preload {preload:.0} N"))
    }
}

/// A state on the branch that goes out from rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnBranch {
    /// Factor on all speeds.
    pub factor: f64,
    /// Rises of the nodes \[K\].
    pub rises: [f64; NODES],
    /// Preload without load \[N\].
    pub preload: f64,
    /// False beyond the fold.
    pub stable: bool,
}

/// Why there is no warm steady state.
#[derive(Debug, Clone, thiserror::Error)]
pub enum NoSteadyState {
    /// Heat grows faster than what leaves.
    #[error("{0}")]
    RunsAway(Box<Fold>),
    /// A temperature above which nothing counts is reached before the speeds are.
    #[error("a temperature passes 180 C at {factor:.2} of these speeds")]
    TooHot {
        /// Factor on all speeds.
        factor: f64,
    },
    /// The balls let go of each other without load before the speeds are reached.
    #[error("the preload is lost at {factor:.2} of these speeds")]
    PreloadLost {
        /// Factor on all speeds.
        factor: f64,
    },
    /// A ball has no friction.
    #[error("a ball has no friction torque")]
    NoFriction,
    /// The nut does not carry its load.
    #[error(transparent)]
    Nut(#[from] NutError),
    /// The states end at a jump: of friction where balls begin to slide, or of loads.
    #[error(
        "the warm states end at {factor:.2} of these speeds, where friction or loads of the balls jump"
    )]
    Jump {
        /// Factor on all speeds.
        factor: f64,
    },
    /// The search ended without an answer.
    #[error("the warm state is not found")]
    NotFound,
}

impl From<Option<NutError>> for NoSteadyState {
    fn from(why: Option<NutError>) -> Self {
        why.map_or(Self::NoFriction, Self::Nut)
    }
}

/// The balance of heat of a nut.
struct HeatBalance<'a> {
    nut: &'a WarmNut<'a>,
    /// One over the heat at the temperatures of the surroundings.
    weight: f64,
    /// False where the nut has lost the preload that it has been given.
    has_preload: Cell<bool>,
    /// Models of the balls, which are held over a solve because friction jumps where a ball decides for another one.
    models: ModelsOfPhases,
}

/// Slopes of the heat of nut, screw and balls by the temperatures of all nodes.
type HeatSlopes = [[f64; NODES]; FRICTION_NODES];

/// The same at one speed factor.
struct BalanceAtSpeed<'a>(&'a HeatBalance<'a>, f64);

impl HeatBalance<'_> {
    /// What the nut does at some rises.
    ///
    /// * `between_loads`: what friction may err by.
    fn heated(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        between_loads: f64,
    ) -> Result<NutAtTemperature, EvalError> {
        let heated = self.nut.heated_to(rises, factor, false, between_loads, &self.models);
        let heated = heated.map_err(|_| EvalError {
            quantity: "rise of the balls [K]",
            value: rises[2],
            requirement: "such that the nut carries its load and every ball has friction",
        })?;
        self.has_preload.set(self.nut.preload.is_none() || heated.preload > 0.0);
        Ok(heated)
    }

    /// Returns `$M T - r - P(T)$` (I8) and the heated nut.
    fn heat_residual(
        &self,
        rises: &[f64; NODES],
        factor: f64,
    ) -> Result<([f64; NODES], NutAtTemperature), EvalError> {
        let heated = self.heated(rises, factor, BETWEEN_LOADS)?;
        Ok((self.left_with(rises, factor, &heated.heat), heated))
    }

    /// Returns `$M T - r - P$` for the heat `$P$` of the nodes.
    fn left_with(&self, rises: &[f64; NODES], factor: f64, heat: &[f64; NODES]) -> [f64; NODES] {
        let (matrix, received) = self.nut.network(factor).balance();
        from_fn(|i| {
            let leaves: f64 = matrix[i].iter().zip(rises).map(|(m, t)| m * t).sum();
            leaves - received[i] - heat[i]
        })
    }

    /// `$P'$` to a thousandth and the heat that it starts from: what the steps of Newton's method and of a walk need.
    fn slopes_of_step(
        &self,
        rises: &[f64; NODES],
        factor: f64,
    ) -> Result<(HeatSlopes, [f64; NODES]), EvalError> {
        let heat = self.heated(rises, factor, OF_STEPS)?.heat;
        Ok((self.slopes(rises, factor, Some(&heat))?, heat))
    }

    /// `$P'$` by differences from the heat at the rises, or else by central ones.
    fn slopes(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        here: Option<&[f64; NODES]>,
    ) -> Result<HeatSlopes, EvalError> {
        let between_loads = if here.is_some() { OF_STEPS } else { BETWEEN_LOADS };
        let mut slopes = [[0.0; NODES]; FRICTION_NODES];
        // The ends act on the nut by the tension alone.
        let felt = if self.nut.axis.screw.hold.is_some() { NODES } else { FRICTION_NODES };
        for k in 0..felt {
            let at = |by: f64| {
                let mut moved = *rises;
                moved[k] += by;
                self.heated(&moved, factor, between_loads).map(|heated| heated.heat)
            };
            let up = at(DIFFERENCE)?;
            let (down, width) = match here {
                Some(here) => (*here, DIFFERENCE),
                None => (at(-DIFFERENCE)?, 2.0 * DIFFERENCE),
            };
            for (i, row) in slopes.iter_mut().enumerate() {
                row[k] = (up[i] - down[i]) / width;
            }
        }
        Ok(slopes)
    }

    /// Rows of `$M - P'$`.
    fn rows(&self, slopes: &HeatSlopes, factor: f64) -> [[f64; NODES]; NODES] {
        let (matrix, _) = self.nut.network(factor).balance();
        from_fn(|i| from_fn(|k| matrix[i][k] - slopes.get(i).map_or(0.0, |row| row[k])))
    }

    /// `$P' M^{-1}$` at nut, screw and balls, which has all eigenvalues of `$M^{-1} P'$` that are not zero.
    fn loop_matrix(
        &self,
        slopes: &HeatSlopes,
        factor: f64,
    ) -> [[f64; FRICTION_NODES]; FRICTION_NODES] {
        let mut linear = Dense::<NODES>::default();
        *linear.rows_mut() = self.nut.network(factor).balance().0;
        if linear.factorize().is_err() {
            return [[f64::NAN; FRICTION_NODES]; FRICTION_NODES];
        }
        let mut gains = [[0.0; FRICTION_NODES]; FRICTION_NODES];
        for k in 0..FRICTION_NODES {
            let mut column = [0.0; NODES];
            column[k] = 1.0;
            linear.solve(&mut column);
            for (gain, row) in gains.iter_mut().zip(slopes) {
                gain[k] = row.iter().zip(column).map(|(slope, rise)| slope * rise).sum();
            }
        }
        gains
    }

    /// Returns the steady rises near some rises at a speed factor, and the heated nut.
    fn steady_rises(
        &self,
        mut rises: [f64; NODES],
        factor: f64,
    ) -> Option<([f64; NODES], NutAtTemperature)> {
        let scales = Scales { x: &[1.0 / SIZES.0; NODES], f: &[self.weight; NODES] };
        let options = Options {
            convergence: Convergence {
                residual_tol: RESIDUAL_TOLERANCE,
                residual_goal: 0.01 * RESIDUAL_TOLERANCE,
                max_steps: MAX_THERMAL_STEPS,
            },
            jacobian: JacobianUpdate::EveryTrial { chord_below: f64::INFINITY },
            ..Options::default()
        };
        let Outcome { report, last, .. } = solve(
            &BalanceAtSpeed(self, factor),
            &mut rises,
            &scales,
            &options,
            &mut Workspace::default(),
        );
        let (_, heated) = last.filter(|_| report.converged())?;
        Some((rises, heated))
    }

    /// Returns the state at steady rises, with its loop gain.
    fn state_at(
        &self,
        (rises, heated): ([f64; NODES], NutAtTemperature),
        factor: f64,
    ) -> Result<Steady, NoSteadyState> {
        let slopes = self.slopes(&rises, factor, None).map_err(|_| NoSteadyState::NotFound)?;
        let gain = largest_real_part(&self.loop_matrix(&slopes, factor));
        let is_complete = heated.phases.iter().all(Option::is_some);
        let heated = if is_complete {
            heated
        } else {
            self.nut.heated_to(&rises, factor, true, BETWEEN_LOADS, &self.models)?
        };
        let decided = self.nut.models(&rises, factor, &heated).ok_or(NoSteadyState::NoFriction)?;
        let on_jump = !agree(&decided, &self.models);
        Ok(Steady { rises, heated, gain, on_jump, models: self.models.clone() })
    }

    /// The same balance with other models of the balls.
    fn with_models(self, models: ModelsOfPhases) -> Self {
        Self { models, ..self }
    }

    fn is_too_hot(&self, rises: &[f64]) -> bool {
        rises.iter().any(|rise| self.nut.set + rise > HOTTEST)
    }

    /// Whether the last state of a walk counts.
    fn counts(&self, trace_branch: &Trace<{ NODES + 1 }>) -> bool {
        !self.is_too_hot(&trace_branch.last[..NODES]) && self.has_preload.get()
    }

    /// Why a walk ends where it meets no fold.
    fn ending(&self, trace_branch: &Trace<{ NODES + 1 }>) -> NoSteadyState {
        let factor = trace_branch.last[NODES];
        if self.is_too_hot(&trace_branch.last[..NODES]) {
            NoSteadyState::TooHot { factor }
        } else if self.has_preload.get() {
            NoSteadyState::Jump { factor }
        } else {
            NoSteadyState::PreloadLost { factor }
        }
    }

    /// A state and its speed factor at which a walk begins, slow enough for the state to be near that of rest.
    fn slow(&self, rest: [f64; NODES]) -> Result<([f64; NODES], f64), NoSteadyState> {
        let state = |factor: f64| {
            let (rises, _) = self.steady_rises(rest, factor)?;
            (!self.is_too_hot(&rises)).then_some((rises, factor))
        };
        FIRST_FACTORS.into_iter().find_map(state).ok_or_else(|| {
            if self.has_preload.get() {
                NoSteadyState::NotFound
            } else {
                NoSteadyState::PreloadLost { factor: 0.0 }
            }
        })
    }

    /// Follows the branch from a state on, in steps of a part of [`SIZES`] at most, until `goes_on` says no: crossings of the speeds themselves are event 0, folds
    /// event 1.
    fn trace_branch(
        &self,
        from: ([f64; NODES], f64),
        longest: f64,
        goes_on: impl FnMut(&Trace<{ NODES + 1 }>) -> bool,
    ) -> Trace<{ NODES + 1 }> {
        let mut z = [from.1; NODES + 1];
        z[..NODES].copy_from_slice(&from.0);
        let towards = from_fn(|i| if i == NODES { 1.0 } else { 0.0 });
        let jacobian = JacobianUpdate::EveryTrial { chord_below: f64::INFINITY };
        let control = StepControl {
            longest,
            // No step is shorter than the differences of its slopes.
            shortest: DIFFERENCE / SIZES.0,
            root_tolerance: ROOT_TOLERANCE,
            goal: RESIDUAL_TOLERANCE,
            jacobian,
            ..StepControl::default()
        };
        let events = |z: &[f64; NODES + 1], along: &[f64; NODES + 1]| {
            // det(M − P')/det M changes its sign                          (I20)
            let fold = self.slopes(&from_fn(|i| z[i]), z[NODES], None).map_or(f64::NAN, |slopes| {
                let gains = self.loop_matrix(&slopes, z[NODES]);
                (Matrix3::identity() - Matrix3::from_fn(|i, k| gains[i][k])).determinant()
            });
            [(z[NODES] - 1.0, along[NODES]), (fold, 0.0)]
        };
        trace(self, &Seed { z, towards }, events, goes_on, &control)
    }

    fn folded(
        &self,
        z: &[f64; NODES + 1],
        unstable: Option<Steady>,
    ) -> Result<Fold, NoSteadyState> {
        let (rises, factor) = (from_fn(|i| z[i]), z[NODES]);
        let preload = self.nut.heated(&rises, factor, false)?.preload;
        let (set, preload) = (self.nut.set, self.nut.preload.map(|_| preload));
        Ok(Fold { factor, rises, set, preload, unstable })
    }
}

impl Equations<NODES> for BalanceAtSpeed<'_> {
    type Details = NutAtTemperature;
    type Slopes = ();

    fn residual(
        &self,
        rises: &[f64; NODES],
    ) -> Result<([f64; NODES], NutAtTemperature), EvalError> {
        self.0.heat_residual(rises, self.1)
    }

    fn linearize(
        &self,
        rises: &[f64; NODES],
        rows: &mut [[f64; NODES]; NODES],
    ) -> Linearized<NODES, Self> {
        let (heat_residual, heated) = self.residual(rises)?;
        self.jacobian(rises, rows)?;
        Ok((heat_residual, heated, ()))
    }

    fn jacobian(
        &self,
        rises: &[f64; NODES],
        rows: &mut [[f64; NODES]; NODES],
    ) -> Result<(), EvalError> {
        let (slopes, _) = self.0.slopes_of_step(rises, self.1)?;
        *rows = self.0.rows(&slopes, self.1);
        Ok(())
    }

    fn retract(&self, x: &[f64; NODES], dx: &[f64; NODES], lambda: f64) -> [f64; NODES] {
        let longest = dx.iter().fold(0.0, |most: f64, dx| most.max(dx.abs()));
        let part = lambda * (LONGEST_STEP / longest).min(1.0);
        from_fn(|i| x[i] + part * dx[i])
    }
}

impl Homotopy<NODES, { NODES + 1 }> for HeatBalance<'_> {
    fn residual(&self, z: &[f64; NODES + 1]) -> Result<[f64; NODES], EvalError> {
        let (residual, _) = self.heat_residual(&from_fn(|i| z[i]), z[NODES])?;
        Ok(residual)
    }

    fn linearize(
        &self,
        z: &[f64; NODES + 1],
    ) -> Result<([f64; NODES], [[f64; NODES + 1]; NODES]), EvalError> {
        let (rises, factor): ([f64; NODES], f64) = (from_fn(|i| z[i]), z[NODES]);
        let (heat_residual, _) = self.heat_residual(&rises, factor)?;
        let (slopes, heat) = self.slopes_of_step(&rises, factor)?;
        let rows = self.rows(&slopes, factor);
        let faster = (1.0 + SPEED_DIFFERENCE) * factor;
        let heat_faster = self.heated(&rises, faster, OF_STEPS)?.heat;
        let up = self.left_with(&rises, faster, &heat_faster);
        let here = self.left_with(&rises, factor, &heat);
        let by_speed = |i: usize| (up[i] - here[i]) / (faster - factor);
        Ok((
            heat_residual,
            from_fn(|i| from_fn(|k| rows[i].get(k).copied().unwrap_or_else(|| by_speed(i)))),
        ))
    }

    fn weights(&self, _: &[f64; NODES + 1]) -> [f64; NODES] {
        [self.weight; NODES]
    }

    fn sizes(&self, _: &[f64; NODES + 1]) -> [f64; NODES + 1] {
        from_fn(|i| if i < NODES { SIZES.0 } else { SIZES.1 })
    }
}

impl WarmNut<'_> {
    /// The stable state at its speeds: from the temperatures of the surroundings, or on the branch from rest.
    ///
    /// # Errors
    ///
    /// [`NoSteadyState`]: it runs away, and above which speed, or why else there is none.
    pub fn steady(&self) -> Result<Steady, NoSteadyState> {
        self.steady_from(None)
    }

    /// [`steady`](Self::steady), the search begun at the rises of a neighbour: it saves steps, and the same state is
    /// found unless there are two.
    ///
    /// # Errors
    ///
    /// As [`steady`](Self::steady).
    pub fn steady_from(&self, near: Option<&[f64; NODES]>) -> Result<Steady, NoSteadyState> {
        let (balance, rest) = self.at_rest()?;
        let near = near.copied().unwrap_or(rest);
        let state = match Self::steady_with_models(&balance, rest, near) {
            // There is no state with the models of the cold loads, so that balls choose their models at every step.
            Err(NoSteadyState::Jump { .. } | NoSteadyState::NotFound) => {
                return Self::steady_with_models(&balance.with_models(Vec::new()), rest, near);
            }
            found => found?,
        };
        if !state.on_jump {
            return Ok(state);
        }
        let decided = self.models(&state.rises, 1.0, &state.heated);
        let decided = decided.ok_or(NoSteadyState::NoFriction)?;
        // A state may exist on only one side of the jump.
        Self::steady_with_models(&balance.with_models(decided), rest, state.rises).or(Ok(state))
    }

    /// The stable state with the models of a balance.
    ///
    /// * `near`: where it is looked for first.
    fn steady_with_models(
        balance: &HeatBalance<'_>,
        rest: [f64; NODES],
        near: [f64; NODES],
    ) -> Result<Steady, NoSteadyState> {
        let found = balance.steady_rises(near, 1.0).filter(|(rises, _)| !balance.is_too_hot(rises));
        if let Some(steady) = found {
            let state = balance.state_at(steady, 1.0)?;
            if state.gain < 1.0 {
                return Ok(state);
            }
        }
        let slow = balance.slow(rest)?;
        let walked = balance.trace_branch(slow, STRIDE, |trace| {
            balance.counts(trace) && trace.crossings.is_empty()
        });
        match walked.crossings.first() {
            Some(crossing) if crossing.event == 0 => {
                let near = from_fn(|i| crossing.z[i]);
                let steady = balance.steady_rises(near, 1.0).ok_or(NoSteadyState::NotFound)?;
                balance.state_at(steady, 1.0)
            }
            Some(crossing) => {
                let fold = balance.folded(&crossing.z, None)?;
                Err(NoSteadyState::RunsAway(Box::new(fold)))
            }
            None => Err(balance.ending(&walked)),
        }
    }

    /// The fold above a stable state, if its speed is not more than a factor times those of the state.
    ///
    /// # Errors
    ///
    /// [`NoSteadyState`]: why and where the branch ends before, without a fold.
    pub fn fold(&self, state: &Steady, most: f64) -> Result<Option<Fold>, NoSteadyState> {
        let (balance, _) = self.at_rest()?;
        let balance = balance.with_models(state.models.clone());
        let walked = balance.trace_branch((state.rises, 1.0), STRIDE, |trace| {
            let turned = trace.crossings.iter().any(|crossing| crossing.event == 1);
            let back = turned && trace.last[NODES] < 1.0;
            balance.counts(trace) && !back && (turned || trace.last[NODES] <= most)
        });
        let fold = walked.crossings.iter().find(|crossing| crossing.event == 1);
        let Some(fold) = fold.filter(|fold| fold.z[NODES] <= most) else {
            let is_open = walked.last[NODES] >= most;
            return if is_open { Ok(None) } else { Err(balance.ending(&walked)) };
        };
        let mut unstable = walked.crossings.iter().skip_while(|crossing| crossing.event != 1);
        let back = unstable.find(|crossing| crossing.event == 0);
        let unstable = back.and_then(|at| {
            let steady = balance.steady_rises(from_fn(|i| at.z[i]), 1.0)?;
            balance.state_at(steady, 1.0).ok()
        });
        balance.folded(&fold.z, unstable).map(Some)
    }

    /// The branch of states from rest up to a multiple of the speeds, or through its fold and some way back; it ends where no
    /// state counts, above 180 °C or without preload. The fold itself is one of the points.
    ///
    /// # Errors
    ///
    /// [`NoSteadyState`] if there is not even a slow state.
    pub fn branch(&self, most: f64) -> Result<Vec<OnBranch>, NoSteadyState> {
        let (mut balance, rest) = self.at_rest()?;
        if let Ok(state) = self.steady() {
            balance = balance.with_models(state.models);
        }
        let slow = balance.slow(rest)?;
        let (mut points, mut turned) = (vec![(rest, 0.0, true), (slow.0, slow.1, true)], None);
        balance.trace_branch(slow, CLOSE, |trace| {
            let fold = trace.crossings.iter().find(|crossing| crossing.event == 1);
            if let Some(fold) = fold.filter(|_| turned.is_none()) {
                points.push((from_fn(|i| fold.z[i]), fold.z[NODES], true));
                turned = Some(fold.z[NODES]);
            }
            let (rises, factor) = (from_fn(|i| trace.last[i]), trace.last[NODES]);
            let counts = balance.counts(trace);
            if counts {
                points.push((rises, factor, turned.is_none()));
            }
            counts && factor <= most && turned.is_none_or(|fold| factor > BACK * fold)
        });
        let point = |(rises, factor, stable)| {
            let preload = self.heated(&rises, factor, false)?.preload;
            Ok(OnBranch { factor, rises, preload, stable })
        };
        points.into_iter().map(point).collect()
    }

    /// The balance of heat, and the rises without any heat of friction.
    fn at_rest(&self) -> Result<(HeatBalance<'_>, [f64; NODES]), NoSteadyState> {
        let motor = HeatSources { motor: self.motor, ..HeatSources::default() };
        let rest = self.network(1.0).rises(&self.axis.heats(&motor))?;
        let heated = self.heated(&rest, 1.0, false)?;
        let heat: f64 = heated.heat.iter().sum();
        let weight = if heat > 0.0 { heat.recip() } else { 1.0 };
        let models = self.models(&rest, 1.0, &heated).ok_or(NoSteadyState::NoFriction)?;
        Ok((HeatBalance { nut: self, weight, has_preload: Cell::new(true), models }, rest))
    }
}

/// Returns true if every ball that has a model in both lists has the same model in both.
fn agree(one: &ModelsOfPhases, other: &ModelsOfPhases) -> bool {
    let phases = one.iter().zip(other);
    phases.flat_map(|(one, other)| one.iter().zip(other)).all(|pair| match pair {
        (Some(one), Some(other)) => one == other,
        _ => true,
    })
}

/// Largest real part of the eigenvalues of a matrix (I18); NaN if they are not found.
fn largest_real_part(a: &[[f64; FRICTION_NODES]; FRICTION_NODES]) -> f64 {
    let matrix = Matrix3::from_fn(|i, k| a[i][k]);
    let schur = Schur::try_new(matrix, f64::EPSILON, MOST_SWEEPS);
    schur.map_or(f64::NAN, |schur| {
        // gain = max Re λ(M⁻¹ P')                                        (I18)
        schur.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eigenvalues that are known: triangular, a turn in a plane, none.
    #[test]
    fn largest_real_parts_of_matrices_whose_eigenvalues_are_known() {
        let cases = [
            ([[0.3, 5.0, -2.0], [0.0, -0.1, 4.0], [0.0, 0.0, 0.7]], 0.7),
            ([[0.2, -1.5, 0.0], [1.5, 0.2, 0.0], [0.0, 0.0, -0.4]], 0.2),
            ([[0.2, -1.5, 0.0], [1.5, 0.2, 0.0], [0.0, 0.0, 0.9]], 0.9),
            ([[0.0; 3]; 3], 0.0),
        ];
        for (matrix, largest) in cases {
            let found = largest_real_part(&matrix);
            // Rounding of an orthogonal reduction of entries of order ten.
            assert!((found - largest).abs() < 1e-12, "{matrix:?}: {found}, not {largest}");
        }
    }
}
