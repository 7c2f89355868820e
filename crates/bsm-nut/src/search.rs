//! Minimizes the energy of a nut by damped Newton steps.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U15) and (U16).

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use crate::assembly::{Assembly, EnergyState, StiffnessScope};
use crate::equilibrium::{Equilibrium, FREEDOMS, NutError, Support};
use crate::geometry::count;
use crate::{BallInGrooves, BallNut};

/// Maximum number of Newton steps. Ten steps are usually sufficient.
const MAX_EQUILIBRIUM_STEPS: usize = 100;

/// Largest residual force, divided by the sum of the absolute values of all forces, at which the
/// forces count as balanced (dimensionless).
const RESIDUAL_TOLERANCE: f64 = 1e-12;

/// Number of Newton steps after which a residual up to [`RELAXED_TOLERANCE`] is accepted.
const RELAXED_AFTER_STEPS: usize = 30;

/// Largest residual force, divided by the sum of the absolute values of all forces, that is
/// accepted after [`RELAXED_AFTER_STEPS`] (dimensionless). It is larger than
/// [`RESIDUAL_TOLERANCE`], because the rounding errors of displacements are not negligible compared
/// with the elastic approaches of the balls if the bodies are stretched by millimeters.
const RELAXED_TOLERANCE: f64 = 1e-10;

/// Unknowns and the corresponding state of the nut.
struct EnergyPoint {
    y: Vec<f64>,
    state: EnergyState,
}

impl BallNut {
    /// Returns the equilibrium of the nut under load: the displacements, the loads of all balls,
    /// and the stiffness of the nut.
    ///
    /// The energy is convex, so the ball loads are unique (U15).
    ///
    /// # Errors
    ///
    /// Returns [`NutError`] if there are no balls, if the contacts are not Hertzian, if nothing
    /// carries the load, or if the iteration does not converge.
    pub fn solve(&self, support: &Support) -> Result<Equilibrium, NutError> {
        self.solve_from(support, None)
    }

    /// Calculates the same result as [`solve`](Self::solve), but starts from the displacement of a
    /// neighboring solution. This saves iterations and changes the result only by rounding errors.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`solve`](Self::solve).
    pub fn solve_from(
        &self,
        support: &Support,
        start: Option<&[f64; FREEDOMS]>,
    ) -> Result<Equilibrium, NutError> {
        Assembly::of(self, support)?.solve(start)
    }
}

impl Assembly<'_> {
    /// Solves the equilibrium of the nut. The search starts from equal load sharing, or from the
    /// displacement of a neighboring solution.
    pub(crate) fn solve(
        mut self,
        start: Option<&[f64; FREEDOMS]>,
    ) -> Result<Equilibrium, NutError> {
        let none = |residual, steps| NutError::NotConverged { residual, steps };
        let y = self.start(start);
        let state = self.state(&y).map_err(|ball| NutError::BallNotBalanced { ball })?;
        // If displacements are prescribed, the iteration may start far from the undeformed position
        // of the nut, because elastic bodies can follow a large displacement.
        let begun = self.moved(&y);
        let mut at = EnergyPoint { y, state };
        let mut damping = 0.0;
        for steps in 0..=MAX_EQUILIBRIUM_STEPS {
            let imbalance = self.imbalance(&at.state);
            if imbalance <= RESIDUAL_TOLERANCE
                || (steps >= RELAXED_AFTER_STEPS && imbalance <= RELAXED_TOLERANCE)
            {
                return self.finish(at, steps, imbalance).in_grooves(self.nut);
            }
            let moved = self.moved(&at.y);
            // If the nut moves farther than the distance between the groove-arc centers, the balls
            // have moved past these centers and can no longer carry load.
            if moved > begun + self.nut.arc_distance() {
                return Err(NutError::NothingCarries { moved });
            }
            at = loop {
                if let Some(next) = self.step(&at, damping) {
                    break next;
                }
                // No step reduces the energy, for example because the nut has free play. With more
                // damping, the step turns toward the negative gradient of the energy.
                damping = f64::max(10.0 * damping, 1e-6);
                if damping > 1e6 {
                    return Err(none(imbalance, steps));
                }
            };
            damping = if damping < 1e-7 { 0.0 } else { 0.1 * damping };
        }
        Err(none(self.imbalance(&at.state), MAX_EQUILIBRIUM_STEPS))
    }

    /// Takes a Newton step that reduces the energy, or returns `None` if no such step exists.
    fn step(&mut self, at: &EnergyPoint, damping: f64) -> Option<EnergyPoint> {
        let EnergyPoint { y, state } = at;
        self.linearize(state, StiffnessScope::Step);
        if damping > 0.0 {
            self.damp(state, damping);
        }
        self.matrix.factorize().ok()?;
        let mut step: Vec<f64> = state.residual.iter().map(|r| -r).collect();
        self.matrix.solve(&mut step);
        let fall: f64 = -step.iter().zip(&state.residual).map(|(s, r)| s * r).sum::<f64>();
        if !fall.is_finite() || fall <= 0.0 {
            return None;
        }
        let before = self.imbalance(state);
        let mut share = 1.0;
        while share > 1e-4 {
            let next: Vec<f64> = y.iter().zip(&step).map(|(y, s)| y + share * s).collect();
            if let Ok(there) = self.state(&next) {
                // A step is accepted if it satisfies the Armijo condition. Near the solution,
                // energy differences are only rounding errors, so a step is also accepted if it
                // reduces the residual forces.
                let lower = there.energy <= state.energy - 1e-4 * share * fall;
                // The rounding error of a sum of n terms is at most n/2 units in the last place.
                let terms = count(state.balls.len());
                let rounding = (0.5 * f64::EPSILON * terms).max(1e-14);
                let rounding = rounding * state.energy_scale.max(there.energy_scale);
                let level = (there.energy - state.energy).abs() <= rounding;
                if lower || (level && self.imbalance(&there) < before) {
                    return Some(EnergyPoint { y: next, state: there });
                }
            }
            share *= 0.5;
        }
        None
    }

    fn finish(
        &mut self,
        EnergyPoint { y, state }: EnergyPoint,
        steps: usize,
        residual: f64,
    ) -> Equilibrium {
        let first = self.freedoms();
        self.linearize(&state, StiffnessScope::Nut);
        let stiffness = self.condensed();
        let (carried, bodies) = self.carried(&state);
        Equilibrium {
            displacement: from_fn(|i| y[first + i]),
            carried,
            stiffness,
            positions: self.positions(),
            balls: state.balls,
            grooves: state.grooves,
            bodies,
            radial_expansions: y[first + FREEDOMS..].to_vec(),
            steps,
            residual,
        }
    }
}

impl Equilibrium {
    /// Returns the equilibrium after checking that no ball has left its flank.
    fn in_grooves(self, nut: &BallNut) -> Result<Self, NutError> {
        /// Permitted rounding error of the contact angle of a ball at the end of its flank \[rad\].
        const ANGLE_TOLERANCE: f64 = 1e-6;
        // If the nominal contact angle is zero, both flanks of a groove form a single arc, so
        // negative contact angles are valid.
        let least = if nut.contact_angle == 0.0 { -FRAC_PI_2 } else { 0.0 };
        let outside = |ball: &BallInGrooves| {
            let angles = ball.loads.iter().zip(ball.angles);
            let mut pressed = angles.filter(|(load, _)| **load > 0.0).map(|(_, angle)| angle);
            pressed.find(|angle| {
                !(least - ANGLE_TOLERANCE..=FRAC_PI_2 + ANGLE_TOLERANCE).contains(angle)
            })
        };
        let first = self.balls.iter().enumerate().find_map(|(i, ball)| Some((i, outside(ball)?)));
        match first {
            Some((ball, angle)) => Err(NutError::BallLeavesFlank { ball, angle }),
            None => Ok(self),
        }
    }
}
