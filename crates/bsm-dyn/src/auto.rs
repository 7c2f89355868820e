//! The cheapest model whose error is small enough, by the regime that the ball is in.
//!
//! Theory: `docs/theory/10-choice.md`, equations (A1) to (A6). The constants are measured against
//! the traction model, see the tests of `bsm-validate`.

use std::num::NonZeroUsize;

use crate::elastic::Elastic;
use crate::pair::ElasticScrew;
use crate::raceway_control::RacewayControl;
use crate::traction::Traction;
use crate::{
    Angles, ClosedForm, Direction, ModelWorkspace, Outputs, Solution, Status, Transmission,
};

/// The finest quadrature that is tried.
const FINEST: NonZeroUsize = NonZeroUsize::new(32).expect("not zero");

/// A screw at an operating point, to be solved by whatever model is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Auto {
    /// The screw at its operating point.
    pub screw: ElasticScrew,
    /// Error of the efficiency against the traction model that is small enough, positive.
    pub tolerance: f64,
}

/// What an error bound comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Basis {
    /// The whole way from saturated friction to none.
    NoWorseThanSliding,
    /// The ball grips.
    Grips {
        /// Onset number (W11).
        onset_number: f64,
    },
    /// The ball skids.
    Skids {
        /// Onset number (W11).
        onset_number: f64,
    },
    /// In between; friction was integrated over the ellipses.
    Integrated {
        /// Order of the quadrature.
        order: NonZeroUsize,
    },
}

impl Auto {
    /// Solves with the cheapest model whose error bound is at most the tolerance; with the finest
    /// traction model if none is.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        if let Some(solution) = self.closed_form() {
            return solution;
        }
        let grip = RacewayControl { screw: self.screw, control: None }.solve(&mut work.raceway);
        if grip.status == Status::InvalidInput {
            return grip;
        }
        if let Some((numbers, bound)) = Regime::of(&self.screw, &grip.outputs) {
            let onset_number = numbers.onset;
            if bound <= self.tolerance {
                return grip.estimated(bound, Basis::Grips { onset_number });
            }
            if numbers.skid_bound(numbers.range) <= self.tolerance {
                let skid = Elastic { screw: self.screw }.solve(&mut work.elastic);
                let gripping = grip.outputs.efficiency.unwrap_or(f64::NAN);
                let range = skid.outputs.efficiency.map_or(f64::NAN, |eta| (gripping - eta).abs());
                let bound = numbers.skid_bound(range);
                if bound <= self.tolerance {
                    return skid.estimated(bound, Basis::Skids { onset_number });
                }
            }
        }
        let traction =
            Traction { screw: self.screw, order: Traction::ORDER, creep: Traction::CREEP };
        let (solution, order, error) =
            traction.solve_to(self.tolerance, FINEST, &mut work.traction);
        solution.estimated(error, Basis::Integrated { order })
    }

    /// The closed form, if even the way from saturated friction to none is small enough (A1).
    fn closed_form(&self) -> Option<Solution> {
        let speed = self.screw.drive.relative_speed();
        let case = ClosedForm {
            angles: Angles { lead: self.screw.helix.lead_angle, contact: self.screw.contact_angle },
            friction: self.screw.friction,
            direction: Direction::of(speed)?,
            transmission: Some(Transmission {
                pitch_radius: self.screw.helix.radius,
                load: self.screw.load,
                relative_speed: Some(speed),
            }),
        };
        let solution = case.solve();
        let eta = solution.outputs.efficiency.filter(|eta| *eta > 0.0)?;
        let inertia = self.screw.ball.mass * self.screw.helix.radius * speed * speed
            / self.screw.load.per_ball();
        // |δη| ≤ (1 − η)(1 + μ)                                           (A1)
        let bound = (1.0 - eta) * (1.0 + inertia);
        (bound <= self.tolerance).then(|| solution.estimated(bound, Basis::NoWorseThanSliding))
    }
}

impl Solution {
    /// Adds the bound of the error of the efficiency, if there is one.
    fn estimated(mut self, error_bound: f64, basis: Basis) -> Self {
        if self.status == Status::Converged {
            self.outputs.error_bound = Some(error_bound);
            self.basis = Some(basis);
        }
        self
    }
}

/// Where a point lies between gripping and skidding.
struct Regime {
    onset: f64,
    /// Efficiency of the gripping ball less that of the skidding one.
    range: f64,
}

impl Regime {
    /// Numbers of a gripping ball, and the bound of its error.
    fn of(screw: &ElasticScrew, grip: &Outputs) -> Option<(Self, f64)> {
        let (eta, onset, cross) = (grip.efficiency?, grip.onset_number?, grip.cross_slip?);
        let pair = screw.pair().ok()?;
        let direction = pair.direction;
        let signed = screw.friction * direction.sign();
        let angles = |contact| Angles { lead: screw.helix.lead_angle, contact };
        // Saturated friction at the angle that the load leaves.
        let range = pair.static_load(|beta| signed * angles(beta).slip_factor()).map_or(
            f64::INFINITY,
            |(_, beta)| {
                let sliding = angles(beta).efficiency(direction, screw.friction);
                (eta - sliding).abs()
            },
        );
        let f = screw.friction;
        // A = 1.7 f + 0.35/(1 + (χ/0.4)²)                                 (A2)
        let rolling = 1.7 * f + 0.35 / (1.0 + (cross / 0.4).powi(2));
        // σ = min(1, (S/0.27)⁶)                                           (A3)
        let skidding = (onset / 0.27).powi(6).min(1.0);
        // |δη| ≤ A (1 − η) + 1.05 σ (1 + μ)(η − η_s)                      (A4)
        let inertia = 1.0 + pair.inertia_ratio();
        let bound = rolling * (1.0 - eta).abs() + 1.05 * skidding * inertia * range;
        Some((Self { onset, range }, bound))
    }

    /// Bound of the error of saturated friction (A5).
    fn skid_bound(&self, range: f64) -> f64 {
        // |δη| ≤ (0.02 + 0.8/S^{5/2}) (η − η_s)                           (A5)
        (0.02 + 0.8 * self.onset.powf(-2.5)) * range
    }
}
