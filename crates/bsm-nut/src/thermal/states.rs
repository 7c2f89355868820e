//! Steady states, in which every node loses as much heat as it receives, and the fold, which is the
//! highest speed with a steady state.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I8) and (I18) to (I20).

use std::array::from_fn;
use std::cell::Cell;
use std::fmt;

use bsm_dyn::lubrication::ZERO_CELSIUS;
use bsm_newton::{
    Convergence, CurveEquations, Dense, Equations, EvalError, JacobianUpdate, Linearized, Options,
    Outcome, Scales, Seed, StepControl, Trace, Workspace, solve, trace,
};

use nalgebra::{Matrix3, Schur};

use super::coupling::{BETWEEN_LOADS, ModelsOfPhases};
use super::{HeatSources, NODES, NutAtTemperature, WarmNut, celsius};
use crate::NutError;

/// Highest node temperature in a valid steady state \[K\].
const MAX_TEMPERATURE: f64 = ZERO_CELSIUS + 180.0;

/// Step size for finite differences with respect to temperatures \[K\]. In central differences, the
/// truncation error and the rounding error of the loads (1e-12 divided by the step) are both below
/// 1e-8.
const DIFFERENCE: f64 = 2e-3;
/// Relative step size for finite differences with respect to the speed factor.
const SPEED_DIFFERENCE: f64 = 1e-4;

/// Permitted relative error of interpolated friction in the derivatives for Newton and continuation
/// steps. The friction is interpolated between ball loads.
const STEP_FRICTION_TOLERANCE: f64 = 1e-3;

/// Maximum change of any node temperature in a Newton step \[K\].
const MAX_STEP_LENGTH: f64 = 8.0;

/// Speed factors at which the continuation may start. It starts at the first of these factors for
/// which a steady state is found.
const FIRST_FACTORS: [f64; 4] = [0.05, 5e-3, 5e-4, 5e-5];

/// Scale of the temperatures in the continuation \[K\].
const TEMPERATURE_SCALE: f64 = 20.0;

/// Scale of the speed factor in the continuation (dimensionless).
const SPEED_SCALE: f64 = 1.0;

/// Maximum length of a continuation step, in units of [`TEMPERATURE_SCALE`] and [`SPEED_SCALE`].
const MAX_CONTINUATION_STEP: f64 = 0.5;
/// Maximum length of a continuation step, in units of [`TEMPERATURE_SCALE`] and [`SPEED_SCALE`], if
/// the points on the branch are returned as results.
const MAX_STEP_FOR_RESULTS: f64 = 0.25;

/// Minimum ratio of speed to fold speed down to which the unstable states beyond the fold are
/// traced.
const UNSTABLE_SPEED_FRACTION: f64 = 0.8;

/// Residual of the heat balance, divided by the generated heat, below which Newton's method stops.
const RESIDUAL_TOLERANCE: f64 = 1e-10;

/// Maximum number of Newton steps in the search for a steady state.
const MAX_THERMAL_STEPS: usize = 60;

/// Maximum number of QR iterations for three eigenvalues. Usually, about ten iterations are
/// sufficient.
const MAX_QR_SWEEPS: usize = 200;

/// Number of thermal nodes at which friction generates heat: nut, screw and balls.
const FRICTION_NODES: usize = 3;

/// Accuracy with which a fold is located, as a fraction of a continuation step. At the fold, the
/// derivative of the speed along the branch is zero, so the relative error of the fold speed is
/// only 1e-6.
const ROOT_TOLERANCE: f64 = 1e-3;

/// Warm steady state of a nut.
#[derive(Debug, Clone)]
pub struct SteadyState {
    /// Temperature rise of each node above the assembly temperature \[K\].
    pub rises: [f64; NODES],
    /// Heat, loads and friction of the nut in this state.
    pub heated: NutAtTemperature,
    /// Loop gain (I18), which is 0 without thermal feedback and 1 at the fold.
    pub gain: f64,
    /// True if the models or controlling raceways that would be chosen in this state differ from
    /// those with which the friction was calculated. The friction is discontinuous in this state,
    /// and the reported friction is the value on one side of the discontinuity.
    pub is_at_discontinuity: bool,
    /// Ball models with which the friction in this state was calculated.
    models: ModelsOfPhases,
}

impl SteadyState {
    /// Returns the heat that is generated at all nodes together \[W\].
    pub fn heat(&self) -> f64 {
        self.heated.heat.iter().sum()
    }

    /// Returns the heat that is generated at nut, screw and balls \[W\], without the heat of
    /// bearings and motor.
    pub fn nut_heat(&self) -> f64 {
        self.heated.heat[..FRICTION_NODES].iter().sum()
    }
}

/// The fold of the branch of steady states, which is the state with the highest speed. No steady
/// state exists at higher speeds (I20).
#[derive(Debug, Clone)]
pub struct Fold {
    /// Speed at the fold divided by the given speed.
    pub factor: f64,
    /// Temperature rises of the nodes above the assembly temperature \[K\] at the fold.
    pub rises: [f64; NODES],
    /// Assembly temperature \[K\].
    pub assembly_temperature: f64,
    /// Preload of the nut without external load \[N\] at the fold; `None` for a nut without
    /// preload.
    pub preload: Option<f64>,
    /// Unstable state at the given speeds, which exists if the fold is at higher speeds.
    pub unstable: Option<SteadyState>,
}

impl fmt::Display for Fold {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { factor, preload, .. } = self;
        let [nut, screw, balls, ..] = celsius(self.assembly_temperature, &self.rises);
        write!(
            to,
            "the temperature of the axis runs away above {factor:.2} times the given speeds, where the nut \
             reaches {nut:.0} C, the screw {screw:.0} C and the balls {balls:.0} C"
        )?;
        preload.map_or(Ok(()), |preload| write!(to, " at a preload of {preload:.0} N"))
    }
}

/// A point on the branch of steady states that begins at standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchState {
    /// Speed at this point divided by the given speed.
    pub factor: f64,
    /// Temperature rises of the nodes above the assembly temperature \[K\].
    pub rises: [f64; NODES],
    /// Preload of the nut without external load \[N\].
    pub preload: f64,
    /// True for stable states, and false for states beyond the fold.
    pub stable: bool,
}

/// Reason why no warm steady state exists or was found.
#[derive(Debug, Clone, thiserror::Error)]
pub enum NoSteadyState {
    /// The speeds are above the fold, so the temperatures rise without limit.
    #[error("{0}")]
    RunsAway(Box<Fold>),
    /// The temperature limit of 180 °C is reached at speeds below the given speeds.
    #[error("a temperature exceeds 180 C at {factor:.2} times the given speeds")]
    TooHot {
        /// Speed at which the temperature limit is exceeded, divided by the given speed.
        factor: f64,
    },
    /// The nut loses its preload at speeds below the given speeds.
    #[error("the preload is lost at {factor:.2} times the given speeds")]
    PreloadLost {
        /// Speed at which the preload is lost, divided by the given speed.
        factor: f64,
    },
    /// The friction of a ball could not be calculated.
    #[error(
        "the friction of a ball is unknown, because the ball skids under a light load or its model does not converge"
    )]
    NoFriction,
    /// The nut cannot carry the load of a phase.
    #[error(transparent)]
    Nut(#[from] NutError),
    /// The branch of steady states ends at a discontinuity of the friction (balls begin to slide)
    /// or of the ball loads.
    #[error(
        "warm steady states were found only up to {factor:.2} times the given speeds, where the friction or the ball loads are discontinuous"
    )]
    Jump {
        /// Speed at which the branch ends, divided by the given speed.
        factor: f64,
    },
    /// The search did not find a steady state.
    #[error(
        "the search for temperatures at which generated and dissipated heat are equal did not converge"
    )]
    NotFound,
}

impl From<Option<NutError>> for NoSteadyState {
    fn from(why: Option<NutError>) -> Self {
        why.map_or(Self::NoFriction, Self::Nut)
    }
}

/// Heat balance of a nut.
struct HeatBalance<'a> {
    nut: &'a WarmNut<'a>,
    /// Reciprocal of the generated heat at the temperatures that the axis has without frictional
    /// heat.
    weight: f64,
    /// False if the nut had lost its preload when the heat balance was last evaluated.
    has_preload: Cell<bool>,
    /// Models of the balls. The models are held constant during a solve, because the friction is
    /// discontinuous where the model of a ball changes.
    models: ModelsOfPhases,
}

/// Derivatives of the heat flows into nut, screw and balls with respect to the temperatures of all
/// nodes.
type HeatSlopes = [[f64; NODES]; FRICTION_NODES];

/// Heat balance at a given speed factor.
struct BalanceAtSpeed<'a>(&'a HeatBalance<'a>, f64);

impl HeatBalance<'_> {
    /// Returns heat, loads and friction of the nut at given temperature rises and a given speed
    /// factor.
    ///
    /// * `between_loads`: permitted relative error of the friction that is interpolated between
    ///   ball loads.
    fn heated(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        between_loads: f64,
    ) -> Result<NutAtTemperature, EvalError> {
        let heated = self.nut.heated_to(rises, factor, false, between_loads, &self.models);
        let heated = heated.map_err(|_| EvalError {
            quantity: "temperature rise of the balls [K]",
            value: rises[2],
            requirement: "the nut must carry its load, and the friction of every ball must be known",
        })?;
        self.has_preload.set(self.nut.preload.is_none() || heated.preload > 0.0);
        Ok(heated)
    }

    /// Returns the residual of the heat balance, `$M T - r - P(T)$` (I8), and the heat and loads of
    /// the nut.
    fn heat_residual(
        &self,
        rises: &[f64; NODES],
        factor: f64,
    ) -> Result<([f64; NODES], NutAtTemperature), EvalError> {
        let heated = self.heated(rises, factor, BETWEEN_LOADS)?;
        Ok((self.left_with(rises, factor, &heated.heat), heated))
    }

    /// Returns the residual of the heat balance for given values of the heat that is generated at
    /// each node.
    fn left_with(&self, rises: &[f64; NODES], factor: f64, heat: &[f64; NODES]) -> [f64; NODES] {
        let (matrix, received) = self.nut.network(factor).balance();
        from_fn(|i| {
            let leaves: f64 = matrix[i].iter().zip(rises).map(|(m, t)| m * t).sum();
            leaves - received[i] - heat[i]
        })
    }

    /// Returns the derivatives `$P'$` of the heat with a relative error of 0.001, and the heat from
    /// which they are calculated. The derivatives are used in Newton and continuation steps.
    fn slopes_of_step(
        &self,
        rises: &[f64; NODES],
        factor: f64,
    ) -> Result<(HeatSlopes, [f64; NODES]), EvalError> {
        let heat = self.heated(rises, factor, STEP_FRICTION_TOLERANCE)?.heat;
        Ok((self.slopes(rises, factor, Some(&heat))?, heat))
    }

    /// Returns the derivatives `$P'$` of the heat with respect to the temperatures. One-sided
    /// differences are used if `here` contains the heat at the given temperature rises. Otherwise,
    /// central differences are used.
    fn slopes(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        here: Option<&[f64; NODES]>,
    ) -> Result<HeatSlopes, EvalError> {
        let between_loads = if here.is_some() { STEP_FRICTION_TOLERANCE } else { BETWEEN_LOADS };
        let mut slopes = [[0.0; NODES]; FRICTION_NODES];
        // The temperatures of the screw ends influence the nut only if both ends of the screw are
        // held, because only then do these temperatures change the axial tension of the screw.
        let felt = if self.nut.axis.screw.constraint.is_some() { NODES } else { FRICTION_NODES };
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

    /// Returns the rows of the matrix `$M - P'$`, the Jacobian of the heat balance.
    fn rows(&self, slopes: &HeatSlopes, factor: f64) -> [[f64; NODES]; NODES] {
        let (matrix, _) = self.nut.network(factor).balance();
        from_fn(|i| from_fn(|k| matrix[i][k] - slopes.get(i).map_or(0.0, |row| row[k])))
    }

    /// Returns the matrix `$P' M^{-1}$` for nut, screw and balls. Its nonzero eigenvalues are the
    /// nonzero eigenvalues of `$M^{-1} P'$`.
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

    /// Returns the temperature rises in the steady state at a given speed factor, together with the
    /// heat and the loads of the nut. The search starts at the temperature rises `rises`. Returns
    /// `None` if the search does not converge.
    fn steady_rises(
        &self,
        mut rises: [f64; NODES],
        factor: f64,
    ) -> Option<([f64; NODES], NutAtTemperature)> {
        let scales = Scales { x: &[1.0 / TEMPERATURE_SCALE; NODES], f: &[self.weight; NODES] };
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

    /// Returns the complete steady state, including its loop gain, from known temperature rises,
    /// heat and loads.
    fn state_at(
        &self,
        (rises, heated): ([f64; NODES], NutAtTemperature),
        factor: f64,
    ) -> Result<SteadyState, NoSteadyState> {
        let slopes = self.slopes(&rises, factor, None).map_err(|_| NoSteadyState::NotFound)?;
        let gain = largest_real_part(&self.loop_matrix(&slopes, factor));
        let is_complete = heated.phases.iter().all(Option::is_some);
        let heated = if is_complete {
            heated
        } else {
            self.nut.heated_to(&rises, factor, true, BETWEEN_LOADS, &self.models)?
        };
        let decided = self.nut.models(&rises, factor, &heated).ok_or(NoSteadyState::NoFriction)?;
        let is_at_discontinuity = !agree(&decided, &self.models);
        Ok(SteadyState { rises, heated, gain, is_at_discontinuity, models: self.models.clone() })
    }

    /// Returns a copy of the heat balance that uses the given ball models.
    fn with_models(self, models: ModelsOfPhases) -> Self {
        Self { models, ..self }
    }

    fn is_too_hot(&self, rises: &[f64]) -> bool {
        rises.iter().any(|rise| self.nut.assembly_temperature + rise > MAX_TEMPERATURE)
    }

    /// Returns true if the nut still has a preload in the last state of a continuation and this
    /// state is below the temperature limit.
    fn counts(&self, trace_branch: &Trace<{ NODES + 1 }>) -> bool {
        !self.is_too_hot(&trace_branch.last[..NODES]) && self.has_preload.get()
    }

    /// Returns the reason why a continuation ended without a fold.
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

    /// Returns a steady state at low speed and its speed factor. The continuation starts at this
    /// state.
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

    /// Traces the branch of steady states from a given state until `continues` returns false. Event
    /// 0 is a state at the given speeds (speed factor 1), and event 1 is a fold.
    ///
    /// * `longest`: maximum length of a continuation step, in units of
    ///   [`TEMPERATURE_SCALE`] and [`SPEED_SCALE`].
    fn trace_branch(
        &self,
        from: ([f64; NODES], f64),
        max_step: f64,
        continues: impl FnMut(&Trace<{ NODES + 1 }>) -> bool,
    ) -> Trace<{ NODES + 1 }> {
        let mut z = [from.1; NODES + 1];
        z[..NODES].copy_from_slice(&from.0);
        let towards = from_fn(|i| if i == NODES { 1.0 } else { 0.0 });
        let jacobian = JacobianUpdate::EveryTrial { chord_below: f64::INFINITY };
        let control = StepControl {
            max_step,
            // A continuation step must not be shorter than the finite-difference step.
            min_step: DIFFERENCE / TEMPERATURE_SCALE,
            root_tolerance: ROOT_TOLERANCE,
            residual_goal: RESIDUAL_TOLERANCE,
            jacobian,
            ..StepControl::default()
        };
        let events = |z: &[f64; NODES + 1], along: &[f64; NODES + 1]| {
            // At a fold, det(M − P')/det M changes sign (I20)
            let fold = self.slopes(&from_fn(|i| z[i]), z[NODES], None).map_or(f64::NAN, |slopes| {
                let gains = self.loop_matrix(&slopes, z[NODES]);
                (Matrix3::identity() - Matrix3::from_fn(|i, k| gains[i][k])).determinant()
            });
            [(z[NODES] - 1.0, along[NODES]), (fold, 0.0)]
        };
        trace(self, &Seed { z, towards }, events, continues, &control)
    }

    fn folded(
        &self,
        z: &[f64; NODES + 1],
        unstable: Option<SteadyState>,
    ) -> Result<Fold, NoSteadyState> {
        let (rises, factor) = (from_fn(|i| z[i]), z[NODES]);
        let preload = self.nut.heated(&rises, factor, false)?.preload;
        let (assembly_temperature, preload) =
            (self.nut.assembly_temperature, self.nut.preload.map(|_| preload));
        Ok(Fold { factor, rises, assembly_temperature, preload, unstable })
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
        let part = lambda * (MAX_STEP_LENGTH / longest).min(1.0);
        from_fn(|i| x[i] + part * dx[i])
    }
}

impl CurveEquations<NODES, { NODES + 1 }> for HeatBalance<'_> {
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
        let heat_faster = self.heated(&rises, faster, STEP_FRICTION_TOLERANCE)?.heat;
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
        from_fn(|i| if i < NODES { TEMPERATURE_SCALE } else { SPEED_SCALE })
    }
}

impl WarmNut<'_> {
    /// Returns the stable steady state at the given speeds. The search starts at the temperatures
    /// without frictional heat. If this search fails, the branch of steady states is traced from
    /// low speed.
    ///
    /// # Errors
    ///
    /// Returns [`NoSteadyState`] if there is no stable steady state. If the temperatures run away,
    /// the error contains the fold.
    pub fn steady(&self) -> Result<SteadyState, NoSteadyState> {
        self.steady_from(None)
    }

    /// Calculates a stable steady state like [`steady`](Self::steady), but starts at the
    /// temperature rises of a neighboring solution, which saves iterations. If there are two stable
    /// states, the two functions may return different states.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`steady`](Self::steady).
    pub fn steady_from(&self, near: Option<&[f64; NODES]>) -> Result<SteadyState, NoSteadyState> {
        let (balance, rest) = self.at_rest()?;
        let near = near.copied().unwrap_or(rest);
        let state = match Self::steady_with_models(&balance, rest, near) {
            // The ball models that were selected at the temperatures without frictional heat do not
            // lead to a steady state, so the search is repeated with models that are selected anew
            // at every step.
            Err(NoSteadyState::Jump { .. } | NoSteadyState::NotFound) => {
                return Self::steady_with_models(&balance.with_models(Vec::new()), rest, near);
            }
            found => found?,
        };
        if !state.is_at_discontinuity {
            return Ok(state);
        }
        let decided = self.models(&state.rises, 1.0, &state.heated);
        let decided = decided.ok_or(NoSteadyState::NoFriction)?;
        // The state is at a discontinuity. A steady state may exist with the ball models on the
        // other side of this discontinuity.
        Self::steady_with_models(&balance.with_models(decided), rest, state.rises).or(Ok(state))
    }

    /// Returns the stable steady state for a heat balance with given ball models. If the list of
    /// models is empty, the models are chosen automatically at every step.
    ///
    /// * `near`: temperature rises at which the search starts.
    fn steady_with_models(
        balance: &HeatBalance<'_>,
        rest: [f64; NODES],
        near: [f64; NODES],
    ) -> Result<SteadyState, NoSteadyState> {
        let found = balance.steady_rises(near, 1.0).filter(|(rises, _)| !balance.is_too_hot(rises));
        if let Some(steady) = found {
            let state = balance.state_at(steady, 1.0)?;
            if state.gain < 1.0 {
                return Ok(state);
            }
        }
        let slow = balance.slow(rest)?;
        let walked = balance.trace_branch(slow, MAX_CONTINUATION_STEP, |trace| {
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

    /// Returns the fold that the branch reaches at higher speeds than the given stable state.
    /// Returns `None` if the speed factor of the fold exceeds `most`.
    ///
    /// # Errors
    ///
    /// Returns [`NoSteadyState`] with the reason and the speed factor if the branch ends without a
    /// fold.
    pub fn fold(&self, state: &SteadyState, most: f64) -> Result<Option<Fold>, NoSteadyState> {
        let (balance, _) = self.at_rest()?;
        let balance = balance.with_models(state.models.clone());
        let walked = balance.trace_branch((state.rises, 1.0), MAX_CONTINUATION_STEP, |trace| {
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

    /// Returns points on the branch of steady states, from standstill up to the speed factor `most`
    /// or to a short distance beyond the fold. The branch ends earlier if a temperature exceeds 180
    /// °C or the preload is lost. The fold is one of the points.
    ///
    /// # Errors
    ///
    /// Returns [`NoSteadyState`] if no steady state exists even at low speed.
    pub fn branch(&self, most: f64) -> Result<Vec<BranchState>, NoSteadyState> {
        let (mut balance, rest) = self.at_rest()?;
        if let Ok(state) = self.steady() {
            balance = balance.with_models(state.models);
        }
        let slow = balance.slow(rest)?;
        let (mut points, mut turned) = (vec![(rest, 0.0, true), (slow.0, slow.1, true)], None);
        balance.trace_branch(slow, MAX_STEP_FOR_RESULTS, |trace| {
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
            counts
                && factor <= most
                && turned.is_none_or(|fold| factor > UNSTABLE_SPEED_FRACTION * fold)
        });
        let point = |(rises, factor, stable)| {
            let preload = self.heated(&rises, factor, false)?.preload;
            Ok(BranchState { factor, rises, preload, stable })
        };
        points.into_iter().map(point).collect()
    }

    /// Returns the heat balance of the nut, and the temperature rises without frictional heat.
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

/// Returns true if two lists of ball models agree, that is, if no ball has different models in the
/// two lists. Balls without a model in one of the lists are ignored.
fn agree(one: &ModelsOfPhases, other: &ModelsOfPhases) -> bool {
    let phases = one.iter().zip(other);
    phases.flat_map(|(one, other)| one.iter().zip(other)).all(|pair| match pair {
        (Some(one), Some(other)) => one == other,
        _ => true,
    })
}

/// Returns the largest real part of the eigenvalues of a matrix (I18), or NaN if the eigenvalue
/// iteration does not converge.
fn largest_real_part(a: &[[f64; FRICTION_NODES]; FRICTION_NODES]) -> f64 {
    let matrix = Matrix3::from_fn(|i, k| a[i][k]);
    let schur = Schur::try_new(matrix, f64::EPSILON, MAX_QR_SWEEPS);
    schur.map_or(f64::NAN, |schur| {
        // The loop gain is max Re λ(M⁻¹ P')                              (I18)
        schur.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test matrices are triangular matrices, matrices that contain a plane rotation, and the
    /// zero matrix.
    #[test]
    fn largest_real_part_matches_the_known_eigenvalues() {
        let cases = [
            ([[0.3, 5.0, -2.0], [0.0, -0.1, 4.0], [0.0, 0.0, 0.7]], 0.7),
            ([[0.2, -1.5, 0.0], [1.5, 0.2, 0.0], [0.0, 0.0, -0.4]], 0.2),
            ([[0.2, -1.5, 0.0], [1.5, 0.2, 0.0], [0.0, 0.0, 0.9]], 0.9),
            ([[0.0; 3]; 3], 0.0),
        ];
        for (matrix, largest) in cases {
            let found = largest_real_part(&matrix);
            // The tolerance is an upper bound on the rounding errors of a Schur decomposition of a
            // matrix with entries up to ten.
            assert!((found - largest).abs() < 1e-12, "{matrix:?}: {found}, not {largest}");
        }
    }
}
