//! The cheapest model whose error is small enough, by the regime that the ball is in.
//!
//! Theory: `docs/theory/10-choice.md`, equations (A2) to (A6). The constants are measured against
//! the traction model, see the tests of `bsm-validate`.

use bsm_kin::Jet;

use crate::contact::Angles;
use crate::models::ball::{
    Basis, Choice, Direction, ElasticBall, ElasticPoint, ErrorBound, Model, Performance, Reason,
    SlipRegime, Solution, Solved, Unsolved,
};
use crate::models::elastic::Elastic;
use crate::models::raceway_control::RacewayControl;
use crate::models::traction::{SlipRoot, Start, Traction};
use crate::models::workspace::ModelWorkspace;

/// A screw at an operating point, to be solved by whatever model is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Auto<D = f64> {
    /// The screw at its operating point.
    pub at: ElasticPoint<D>,
    /// Error of the efficiency against the traction model that is small enough, positive.
    pub tolerance: f64,
}

impl Auto {
    /// Solves with the cheapest model that holds in the regime of the ball and whose error bound is at most the
    /// tolerance; with the finest traction model if none is.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        self.solve_for_root(work).0
    }

    /// The solution, and the root of the traction model if it is the one that was chosen.
    fn solve_for_root(&self, work: &mut ModelWorkspace) -> (Solution, Option<SlipRoot>) {
        let pair = match self.at.scaled() {
            Ok(pair) => pair,
            Err(invalid) => return (Solution::new(Model::RacewayControl, Err(invalid)), None),
        };
        let grip = work.raceway.grip(&pair, None).ok();
        let gripping =
            grip.and_then(|grip| work.raceway.solved_and_others(&self.at, &pair, &grip, None).ok());
        let regime = gripping.and_then(|o| Some((o, Regime::of(&pair, &o)?)));
        if let Some((solved, regime)) = &regime {
            if regime.motion == SlipRegime::Grips && regime.grip_bound <= self.tolerance {
                return (self.gripping(solved, regime), None);
            }
            if regime.motion == SlipRegime::Skids
                && regime.skid_bound(regime.range) <= self.tolerance
                && let Ok(skid) = self
                    .at
                    .point
                    .require_friction()
                    .and_then(|()| Elastic { at: self.at }.solved(&pair, &mut work.elastic))
            {
                let eta = |solved: &Solved| solved.transmission.efficiency;
                let bound = regime.skid_bound((eta(solved) - eta(&skid)).abs());
                if bound <= self.tolerance {
                    let basis = Basis::Skids { onset_number: regime.onset };
                    let skid = Solved { skid: solved.skid, ..skid };
                    return (self.chosen(Model::Elastic, &skid, bound, basis), None);
                }
            }
        }
        let traction =
            Traction { at: self.at, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let integrated = self.at.point.require_friction().and_then(|()| {
            let start = Start::new(&pair, grip.as_ref())?;
            traction.solve_to(&start, self.tolerance, &mut work.traction)
        });
        match integrated {
            Ok((found, accuracy, error)) => {
                let basis = Basis::Integrated { accuracy };
                let solved = found.solved(&pair);
                (self.chosen(Model::Traction, &solved, error, basis), Some(found.root))
            }
            Err(none) => {
                let solution = match regime {
                    // A rough answer with its bound is better than none, where the model holds.
                    Some((solved, regime)) if regime.motion == SlipRegime::Grips => {
                        self.gripping(&solved, &regime)
                    }
                    _ => Solution::new(Model::Traction, Err(none)),
                };
                (solution, None)
            }
        }
    }

    /// The gripping ball with the bound of its error.
    fn gripping(&self, solved: &Solved, regime: &Regime) -> Solution {
        let basis = Basis::Grips { onset_number: regime.onset };
        self.chosen(Model::RacewayControl, solved, regime.grip_bound, basis)
    }

    /// A solution with the bound of its error.
    fn chosen(&self, model: Model, solved: &Solved, error_bound: f64, basis: Basis) -> Solution {
        let choice = Some(Choice { basis, tolerance: self.tolerance });
        let direction =
            Direction::of(self.at.point.drive.relative_speed()).expect("the point was solved");
        let error = Some(ErrorBound::of(direction, solved.transmission.efficiency, error_bound));
        Solution { model, answer: Ok(Solved { error, ..*solved }), choice }
    }
}

impl<const M: usize> Auto<Jet<M>> {
    /// Efficiency and torque with their derivatives, of the model that the values choose.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, Unsolved> {
        let Self { at, tolerance } = *self;
        let (solution, root) = Auto { at: at.values(), tolerance }.solve_for_root(work);
        let basis = match solution.answer {
            Err(none) => return Err(none),
            Ok(_) => solution.choice.map(|choice| choice.basis),
        };
        match (basis, root) {
            (Some(Basis::Skids { .. }), _) => Elastic { at }.sensitivities(&mut work.elastic),
            (Some(Basis::Integrated { accuracy }), Some(root)) => {
                let case = Traction { at, accuracy, creep: Traction::CREEP };
                case.sensitivities_at(&root, &mut work.traction)
            }
            _ => RacewayControl { at, control: None }.sensitivities(&mut work.raceway),
        }
    }
}

/// Below this cross slip (W10) spin is nearly all of the loss, and the onset number tells nothing.
const LEAST_CROSS_SLIP: f64 = 0.3;

/// Where a point lies between gripping and skidding.
struct Regime {
    onset: f64,
    motion: SlipRegime,
    cross_slip: f64,
    /// Efficiency of the gripping ball less that of the skidding one.
    range: f64,
    /// Bound of the error of the gripping ball.
    grip_bound: f64,
}

impl Regime {
    /// From the numbers of a gripping ball.
    fn of(pair: &ElasticBall, grip: &Solved) -> Option<Self> {
        let (eta, skid) = (grip.transmission.efficiency, grip.skid?);
        let (onset, cross) = (skid.onset_number()?, skid.cross_slip?);
        let (f, direction) = (pair.friction, pair.direction);
        let angles = |contact| Angles { lead: pair.helix.lead_angle, contact };
        // Saturated friction at the angle that the load leaves; where it holds any load nothing
        // comes out.
        let loaded = pair.static_load(|beta| pair.signed_friction() * angles(beta).slip_factor());
        let sliding = match loaded {
            Ok((_, beta)) => angles(beta).efficiency(direction, f),
            Err(none) if matches!(none.reason(), Reason::SelfLocking { .. }) => 0.0,
            Err(_) => return None,
        };
        let range = (eta - sliding).abs();
        // A = 0.02 + 1.7 f + 0.35/(1 + (χ/0.6)²)                          (A2)
        let rolling = 0.02 + 1.7 * f + 0.35 / (1.0 + (cross / 0.6).powi(2));
        // σ = min(1, (S/0.27)⁶)                                           (A3)
        let skidding = (onset / 0.27).powi(6).min(1.0);
        // |δη| ≤ A (1 − η) + 1.05 σ (1 + μ)(η − η_s)                      (A4)
        let inertia = 1.0 + pair.inertia_ratio();
        let grip_bound = rolling * (1.0 - eta).abs() + 1.05 * skidding * inertia * range;
        let motion = SlipRegime::of(onset);
        Some(Self { onset, motion, cross_slip: cross, range, grip_bound })
    }

    /// Bound of the error of saturated friction (A5).
    fn skid_bound(&self, range: f64) -> f64 {
        if self.cross_slip < LEAST_CROSS_SLIP {
            return f64::INFINITY;
        }
        // |δη| ≤ (0.02 + 0.8/S^{5/2}) (η − η_s)                           (A5)
        (0.02 + 0.8 * self.onset.powf(-2.5)) * range
    }
}
