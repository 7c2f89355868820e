//! Rating life, static safety factor and load concentration, calculated from the loads of all
//! balls.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U22) to (U25).

use crate::geometry::count;
use crate::{BallInGrooves, BallNut, Circuit, Equilibrium};

/// Dynamic load ratings of the loaded turns of one nut body for the raceways of screw and nut,
/// `$C_s i^{0.86}$` and `$C_n i^{0.86}$` \[N\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnRatings {
    /// Dynamic load rating of the screw raceway.
    pub screw: f64,
    /// Dynamic load rating of the nut raceway.
    pub nut: f64,
}

impl Equilibrium {
    /// Returns the largest contact load of all balls \[N\].
    pub fn max_load(&self) -> f64 {
        self.balls.iter().map(BallInGrooves::max_load).fold(0.0, f64::max)
    }

    /// Returns the mean ball load \[N\]. The load of a ball is the largest load of its contacts.
    pub fn mean_load(&self) -> f64 {
        let sum = self.balls.iter().map(BallInGrooves::max_load).sum::<f64>();
        sum / count(self.balls.len())
    }

    /// Returns the largest contact load divided by the mean ball load (U25).
    pub fn concentration(&self) -> f64 {
        // Load concentration: max Q / mean Q                              (U25)
        self.max_load() / self.mean_load()
    }

    /// Returns the number of unloaded balls.
    pub fn unloaded(&self) -> usize {
        self.balls.iter().filter(|ball| ball.max_load() <= 0.0).count()
    }

    /// Returns the static safety factor, which is the ball load at the static load rating of one
    /// nut body divided by the largest contact load.
    pub fn static_safety(&self, nut: &BallNut, rating: f64) -> f64 {
        let axial_fraction = nut.axial_fraction();
        let body = |circuit: &&Circuit| circuit.body == 0;
        let balls: usize = nut.circuits.iter().filter(body).map(|circuit| circuit.balls).sum();
        // f_s = C_0a / (Z_b sinβ₀ cosα) / max Q
        rating / (count(balls) * axial_fraction) / self.max_load()
    }

    /// Returns the rating life \[revolutions\], which 90 % of all nuts reach (U22) to (U24). The
    /// calculation includes the raceways of all nut bodies. The life is infinite if no ball is
    /// loaded.
    ///
    /// Source: the rule of ISO/TS 16281 with ball loads according to ISO 3408-5.
    pub fn life(&self, nut: &BallNut, ratings: &TurnRatings) -> f64 {
        let axial_fraction = nut.axial_fraction();
        let mut damage = 0.0;
        for body in 0..self.bodies.len() {
            let balls: Vec<_> = self
                .positions
                .iter()
                .zip(&self.balls)
                .filter(|(position, _)| nut.circuits[position.circuit].body == body)
                .map(|(_, ball)| ball)
                .collect();
            if balls.is_empty() {
                continue;
            }
            let number = count(balls.len());
            // Each tuple describes one raceway: the index of its first contact, its dynamic load
            // rating, and the exponent of its equivalent load (U23).
            let rings = [(0, ratings.nut, 10.0 / 3.0), (2, ratings.screw, 3.0)];
            for (ring, rating, power) in rings {
                // Q_c = C / (Z_b sinβ₀ cosα)                              (U22)
                let rated = rating / (number * axial_fraction);
                for flank in 0..2 {
                    let load = |ball: &&BallInGrooves| ball.loads[ring + flank].powf(power);
                    // Q_e = (mean Q_j^p)^(1/p)                            (U23)
                    let mean = (balls.iter().map(load).sum::<f64>() / number).powf(power.recip());
                    // L = 10⁶ [Σ L_track^(−10/9)]^(−9/10),  L_track = (Q_c/Q_e)³  (U24)
                    damage += (mean / rated).powf(10.0 / 3.0);
                }
            }
        }
        1e6 * damage.powf(-0.9)
    }
}
