//! Automatic choice of the fastest model that is accurate enough in the slip regime of the ball.
//!
//! Theory: `docs/theory/10-choice.md`, equations (A2) to (A6). The constants were fitted to results
//! of the model `traction`; see the tests of `bsm-validate`.

use bsm_kin::{Jet, Real};

use crate::models::ball::{
    Basis, Choice, ContactState, Direction, ElasticContacts, ElasticPoint, ErrorBound, Model,
    Performance, SlipRegime, Solution, SolveFailure, SteadyState,
};
use crate::models::elastic::{Elastic, SlidingBall};
use crate::models::raceway_control::RacewayControl;
use crate::models::traction::{SlipRoot, Start, Traction};
use crate::models::workspace::ModelWorkspace;
use crate::outcome::Status;

/// A screw at an operating point, to be solved with the fastest model that is accurate enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Auto<D = f64> {
    /// The screw at its operating point.
    pub screw: ElasticPoint<D>,
    /// Permitted error of the efficiency relative to the traction model (dimensionless), positive.
    pub tolerance: f64,
}

impl Auto {
    /// Solves with the fastest model that is valid in the slip regime of the ball and whose error
    /// bound is at most the tolerance. If neither raceway control nor gross slip qualifies, the
    /// traction model is solved with increasing accuracy until its error bound is at most the
    /// tolerance or the highest accuracy is reached.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        self.solve_for_root(work).0
    }

    /// Returns the solution, together with the root of the traction model if that model was chosen.
    fn solve_for_root(&self, work: &mut ModelWorkspace) -> (Solution, Option<SlipRoot>) {
        let contacts = match self.screw.scaled() {
            Ok(contacts) => contacts,
            Err(invalid) => return (Solution::new(Model::RacewayControl, Err(invalid)), None),
        };
        let rolling_ball = work.raceway.rolling_ball(&contacts, None).ok();
        let known = rolling_ball.and_then(|rolling_ball| {
            let onset_number = rolling_ball.skid(&contacts).onset_number()?;
            if SlipRegime::of(onset_number) == SlipRegime::PartialSkid {
                // In partial skid, neither raceway control nor gross slip is valid, even if the
                // error bound of raceway control is small.
                return None;
            }
            let solved = work.raceway.steady_state(&self.screw, &contacts, &rolling_ball).ok()?;
            Some((rolling_ball, solved, ModelErrors::of_ball(&contacts, &solved)?))
        });
        if let Some((rolling_ball, solved, errors)) = &known {
            match errors.basis(self.tolerance) {
                Some(basis @ Basis::Rolling { .. }) => {
                    let solved = work.raceway.with_alternatives(
                        &self.screw,
                        &contacts,
                        rolling_ball,
                        None,
                        solved,
                    );
                    return (self.chosen(&solved, Some(errors.rolling), basis), None);
                }
                Some(basis) => {
                    if let Ok(skid) = self.screw.point.require_friction().and_then(|()| {
                        Elastic { screw: self.screw }.steady_state(&contacts, &mut work.elastic)
                    }) {
                        let eta = |solved: &SteadyState| solved.transmission.efficiency;
                        let bound = errors.skid_bound((eta(solved) - eta(&skid)).abs());
                        if bound <= self.tolerance {
                            let skid = SteadyState { skid: solved.skid, ..skid };
                            return (self.chosen(&skid, Some(bound), basis), None);
                        }
                    }
                }
                None => {}
            }
        }
        let traction =
            Traction { screw: self.screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let integrated = self.screw.point.require_friction().and_then(|()| {
            let start = Start::new(&contacts, rolling_ball.as_ref())?;
            traction.solve_to(&start, self.tolerance, &mut work.traction)
        });
        match integrated {
            Ok((found, accuracy, error)) => {
                let basis = Basis::Integrated { accuracy };
                (self.chosen(&found.solved, Some(error), basis), Some(found.root))
            }
            Err(failure) => {
                let solution = match known {
                    // If the ball rolls but the traction model fails, the less accurate result of
                    // raceway control is better than no result.
                    Some((rolling_ball, solved, errors))
                        if SlipRegime::of(errors.onset_number) == SlipRegime::Rolling =>
                    {
                        let solved = work.raceway.with_alternatives(
                            &self.screw,
                            &contacts,
                            &rolling_ball,
                            None,
                            &solved,
                        );
                        let basis = Basis::Rolling { onset_number: errors.onset_number };
                        // If no solution of the traction model exists, the error relative to that
                        // solution is undefined.
                        let exists = failure.status() != Status::NoSolution;
                        let bound =
                            Some(errors.rolling).filter(|bound| exists && bound.is_finite());
                        self.chosen(&solved, bound, basis)
                    }
                    _ => Solution::new(Model::Traction, Err(failure)),
                };
                (solution, None)
            }
        }
    }

    /// Returns the result of the chosen model, together with the error bound if it is known.
    fn chosen(&self, solved: &SteadyState, error_bound: Option<f64>, basis: Basis) -> Solution {
        let choice = Some(Choice { basis, tolerance: self.tolerance });
        let direction =
            Direction::of(self.screw.point.drive.relative_speed()).expect("the point was solved");
        let efficiency = solved.transmission.efficiency;
        let error = error_bound.map(|bound| ErrorBound::of(direction, efficiency, bound));
        Solution { model: basis.model(), result: Ok(SteadyState { error, ..*solved }), choice }
    }
}

impl<const M: usize> Auto<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs. The
    /// choice of the model depends only on the values of the inputs, not on their derivatives.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let Self { screw, tolerance } = *self;
        let (solution, root) = Auto { screw: screw.values(), tolerance }.solve_for_root(work);
        let basis = match solution.result {
            Err(failure) => return Err(failure),
            Ok(_) => solution.choice.map(|choice| choice.basis),
        };
        match (basis, root) {
            (Some(Basis::GrossSkid { .. }), _) => {
                Elastic { screw }.sensitivities(&mut work.elastic)
            }
            (Some(Basis::Integrated { accuracy }), Some(root)) => {
                let case = Traction { screw, accuracy, creep: Traction::CREEP };
                case.sensitivities_at(&root, &mut work.traction)
            }
            _ => RacewayControl { screw, control: None }.sensitivities(&mut work.raceway),
        }
    }
}

/// Minimum cross slip (dimensionless, W10) at which the onset number is meaningful. Below this
/// cross slip, spin causes nearly all of the loss.
const MIN_CROSS_SLIP: f64 = 0.3;

/// Efficiency error bounds of raceway control and of gross slip, for one operating point or for
/// several points side by side in a SIMD vector.
#[derive(Debug, Clone, Copy)]
pub struct ModelErrors<F = f64> {
    /// Onset number `$S$` (W11).
    pub onset_number: F,
    /// Error bound of raceway control (A4). The bound is infinite if friction may move a contact
    /// beyond the end of its flank (A9).
    pub rolling: F,
    /// Error bound of gross slip divided by `range` (A5). The bound is infinite if the cross slip
    /// is too small.
    pub skidding: F,
    /// Difference between the efficiency of a rolling ball and the efficiency of a skidding ball
    /// without inertia.
    pub range: F,
}

impl<F: Real> ModelErrors<F> {
    /// Calculates the error bounds from the solution for a rolling ball.
    ///
    /// * `back`: true if the load back-drives the screw.
    /// * `onset_number`, `cross_slip`: onset number and cross slip of the rolling ball. If they are
    ///   undefined (infinite or NaN), the error bounds are infinite or NaN, too.
    /// * `cotangents`: cotangents of the contact angles of the rolling ball at the nut and the
    ///   screw.
    #[inline(always)]
    pub fn of(
        ball: &SlidingBall<F>,
        back: F::Mask,
        efficiency: F,
        [onset_number, cross_slip]: [F; 2],
        cotangents: [F; 2],
    ) -> Self {
        let one = efficiency.constant(1.0);
        let friction = ball.friction.abs();
        let range = (efficiency - ball.static_efficiency(back)).abs();
        // A = 0.02 + 1.7 f + 0.35/(1 + (χ/0.6)²)                          (A2)
        let spinning = ((cross_slip * 0.6_f64.recip()).square() + 1.0).recip() * 0.35;
        let rolling = friction * 1.7 + 0.02 + spinning;
        // σ = min(1, (S/0.27)⁶)                                           (A3)
        let square = (onset_number * 0.27_f64.recip()).square();
        let sixth = square * square * square;
        let skidding = F::select(sixth.lt(one), sixth, one);
        // |δη| ≤ A (1 − η) + 1.05 σ (1 + μ)(η − η_s)                      (A4)
        let inertia = ball.inertia_ratio + 1.0;
        let rolling = rolling * (one - efficiency).abs() + skidding * inertia * range * 1.05;
        // f ≤ cotβ ≤ 1/f                                                  (A9)
        let [nut, screw] = cotangents;
        let below_top = friction.le(nut) & friction.le(screw);
        let above_root = (friction * nut).le(one) & (friction * screw).le(one);
        let rolling = F::select(below_top & above_root, rolling, one.constant(f64::INFINITY));
        // |δη| ≤ (0.015 + 0.8/S^{5/2} + 0.1/(1 + (χ/0.6)⁴)) (η − η_s)     (A5)
        let spin = ((cross_slip * 0.6_f64.recip()).square().square() + 1.0).recip() * 0.1;
        let skidding = (onset_number.square() * onset_number.sqrt()).recip() * 0.8 + 0.015 + spin;
        let is_meaningful = one.constant(MIN_CROSS_SLIP).le(cross_slip);
        let skidding = F::select(is_meaningful, skidding, one.constant(f64::INFINITY));
        Self { onset_number, rolling, skidding, range }
    }
}

impl ModelErrors {
    /// Calculates the error bounds for a rolling ball if its onset number and its cross slip are
    /// defined.
    fn of_ball(ball: &ElasticContacts, rolling_ball: &SteadyState) -> Option<Self> {
        let (skid, back) = (rolling_ball.skid?, ball.direction.is_back());
        let numbers = [skid.onset_number()?, skid.cross_slip?];
        let cot = |contact: &ContactState| contact.angle.tan().recip();
        let cotangents = [cot(&rolling_ball.ball.nut), cot(&rolling_ball.ball.screw)];
        Some(Self::of(
            &ball.into(),
            back,
            rolling_ball.transmission.efficiency,
            numbers,
            cotangents,
        ))
    }

    /// Returns the efficiency error bound of the gross-slip model for a given value of
    /// [`range`](Self::range).
    pub fn skid_bound(&self, range: f64) -> f64 {
        self.skidding * range
    }

    /// Selects raceway control for a rolling ball, or gross slip for a skidding ball, if the error
    /// bound of this model is at most the tolerance. Returns `None` otherwise, and for a ball in
    /// partial skid. After the gross-slip model is solved, its error bound must be recalculated
    /// with the efficiency of that solution.
    pub fn basis(&self, tolerance: f64) -> Option<Basis> {
        let Self { onset_number, rolling, range, .. } = *self;
        match SlipRegime::of(onset_number) {
            SlipRegime::Rolling if rolling <= tolerance => Some(Basis::Rolling { onset_number }),
            SlipRegime::GrossSkid if self.skid_bound(range) <= tolerance => {
                Some(Basis::GrossSkid { onset_number })
            }
            _ => None,
        }
    }
}
