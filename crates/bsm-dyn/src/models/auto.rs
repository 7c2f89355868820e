//! Automatic choice of the fastest model that is accurate enough in the slip regime of the ball.
//!
//! Theory: `docs/theory/10-choice.md`, equations (A2) to (A6). The constants were fitted to results
//! of the model `traction`; see the tests of `bsm-validate`.

use bsm_kin::{Jet, Real};

use crate::models::ball::{
    Basis, Choice, ContactState, ElasticContacts, ElasticPoint, ErrorBound, Model, Performance,
    SlipRegime, Solution, SolveFailure, SteadyState,
};
use crate::models::elastic::{Elastic, SlidingBall};
use crate::models::raceway_control::{RacewayControl, RollingBall};
use crate::models::traction::{Integrated, RollingStart, SlipRoot, Traction};
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
        self.choose(work).solution
    }

    /// Solves with the chosen model and keeps the root of the traction model if that model was
    /// chosen.
    fn choose(&self, work: &mut ModelWorkspace) -> Chosen {
        let contacts = match self.screw.scaled() {
            Ok(contacts) => contacts,
            Err(invalid) => return Solution::new(Model::RacewayControl, Err(invalid)).into(),
        };
        let rolling_ball = work.raceway.rolling_ball(&contacts, None).ok();
        let known =
            rolling_ball.as_ref().and_then(|ball| self.outside_partial_skid(&contacts, ball, work));
        let solution =
            known.as_ref().and_then(|known| match known.errors.basis(self.tolerance)? {
                Basis::Rolling { .. } => {
                    Some(self.rolling(&contacts, known, Some(known.errors.rolling), work))
                }
                basis => self.in_gross_skid(&contacts, known, basis, work),
            });
        if let Some(solution) = solution {
            return solution.into();
        }
        self.integrated(&contacts, rolling_ball.as_ref(), work).unwrap_or_else(|failure| {
            let solution = match known {
                // If the ball rolls but the traction model fails, the less accurate result of
                // raceway control is better than no result.
                Some(known) if SlipRegime::of(known.errors.onset_number) == SlipRegime::Rolling => {
                    // If no solution of the traction model exists, the error relative to that
                    // solution is undefined.
                    let exists = failure.status() != Status::NoSolution;
                    let bound = Some(known.errors.rolling);
                    let bound = bound.filter(|bound| exists && bound.is_finite());
                    self.rolling(&contacts, &known, bound, work)
                }
                _ => Solution::new(Model::Traction, Err(failure)),
            };
            solution.into()
        })
    }

    /// Calculates the steady state of a rolling ball with its error bounds. Returns `None` if the
    /// ball is in partial skid, if the solve fails, or if an error bound is undefined.
    fn outside_partial_skid(
        &self,
        contacts: &ElasticContacts,
        ball: &RollingBall,
        work: &mut ModelWorkspace,
    ) -> Option<RollingState> {
        let onset_number = ball.skid(contacts).onset_number()?;
        if SlipRegime::of(onset_number) == SlipRegime::PartialSkid {
            // In partial skid, neither raceway control nor gross slip is valid, even if the error
            // bound of raceway control is small.
            return None;
        }
        let solved = work.raceway.steady_state(&self.screw, contacts, ball).ok()?;
        let errors = ModelErrors::of_ball(contacts, &solved)?;
        Some(RollingState { ball: *ball, solved, errors })
    }

    /// Returns the solution of raceway control.
    ///
    /// * `error_bound`: error bound of the efficiency, `None` if it is unknown.
    fn rolling(
        &self,
        contacts: &ElasticContacts,
        RollingState { ball, solved, errors }: &RollingState,
        error_bound: Option<f64>,
        work: &mut ModelWorkspace,
    ) -> Solution {
        let solved = work.raceway.with_alternatives(&self.screw, contacts, ball, None, solved);
        let basis = Basis::Rolling { onset_number: errors.onset_number };
        self.chosen(contacts, &solved, error_bound, basis)
    }

    /// Returns the solution of the gross-slip model, or `None` if the solve fails or the error bound
    /// exceeds the tolerance.
    fn in_gross_skid(
        &self,
        contacts: &ElasticContacts,
        rolling: &RollingState,
        basis: Basis,
        work: &mut ModelWorkspace,
    ) -> Option<Solution> {
        self.screw.point.require_friction().ok()?;
        let model = Elastic { screw: self.screw };
        let skid = model.steady_state(contacts, &mut work.elastic).ok()?;
        let eta = |solved: &SteadyState| solved.transmission.efficiency;
        let bound = rolling.errors.skid_bound((eta(&rolling.solved) - eta(&skid)).abs());
        (bound <= self.tolerance).then(|| {
            let skid = SteadyState { skid: rolling.solved.skid, ..skid };
            self.chosen(contacts, &skid, Some(bound), basis)
        })
    }

    /// Returns the solution of the traction model with its root.
    fn integrated(
        &self,
        contacts: &ElasticContacts,
        rolling_ball: Option<&RollingBall>,
        work: &mut ModelWorkspace,
    ) -> Result<Chosen, SolveFailure> {
        self.screw.point.require_friction()?;
        let traction =
            Traction { screw: self.screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let start = RollingStart::new(contacts, rolling_ball)?;
        let Integrated { found, accuracy, error } =
            traction.solve_to(&start, self.tolerance, &mut work.traction)?;
        let basis = Basis::Integrated { accuracy };
        let solution = self.chosen(contacts, &found.solved, Some(error), basis);
        Ok(Chosen { solution, root: Some(found.root) })
    }

    /// Returns the result of the chosen model, together with the error bound if it is known.
    fn chosen(
        &self,
        contacts: &ElasticContacts,
        solved: &SteadyState,
        error_bound: Option<f64>,
        basis: Basis,
    ) -> Solution {
        let choice = Some(Choice { basis, tolerance: self.tolerance });
        let efficiency = solved.transmission.efficiency;
        let error = error_bound.map(|bound| ErrorBound::of(contacts.direction, efficiency, bound));
        Solution { model: basis.model(), result: Ok(SteadyState { error, ..*solved }), choice }
    }
}

/// Solution of the chosen model.
struct Chosen {
    solution: Solution,
    /// Root of the traction equations, if the traction model was chosen.
    root: Option<SlipRoot>,
}

impl From<Solution> for Chosen {
    /// Creates the solution of a model other than the traction model.
    fn from(solution: Solution) -> Self {
        Self { solution, root: None }
    }
}

/// A rolling ball with its steady state and the error bounds of the fast models.
struct RollingState {
    ball: RollingBall,
    solved: SteadyState,
    errors: ModelErrors,
}

impl<const M: usize> Auto<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs. The
    /// choice of the model depends only on the values of the inputs, not on their derivatives.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let Self { screw, tolerance } = *self;
        let Chosen { solution, root } = Auto { screw: screw.values(), tolerance }.choose(work);
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
        let skidding = F::select(sixth.below(1.0), sixth, one);
        // |δη| ≤ A (1 − η) + 1.05 σ (1 + μ)(η − η_s)                      (A4)
        let inertia = ball.inertia_ratio + 1.0;
        let rolling = rolling * (one - efficiency).abs() + skidding * inertia * range * 1.05;
        // f ≤ cotβ ≤ 1/f                                                  (A9)
        let [nut, screw] = cotangents;
        let below_top = friction.le(nut) & friction.le(screw);
        let above_root = (friction * nut).at_most(1.0) & (friction * screw).at_most(1.0);
        let rolling = F::select(below_top & above_root, rolling, one.constant(f64::INFINITY));
        // |δη| ≤ (0.015 + 0.8/S^{5/2} + 0.1/(1 + (χ/0.6)⁴)) (η − η_s)     (A5)
        let spin = ((cross_slip * 0.6_f64.recip()).square().square() + 1.0).recip() * 0.1;
        let skidding = (onset_number.square() * onset_number.sqrt()).recip() * 0.8 + 0.015 + spin;
        let is_meaningful = cross_slip.at_least(MIN_CROSS_SLIP);
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
