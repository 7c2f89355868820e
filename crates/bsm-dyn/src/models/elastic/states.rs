//! Force balance of a ball with saturated friction, and the resulting motion, for one operating
//! point or for several points side by side in a SIMD vector.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S13) to (S27).

use bsm_kin::{Real, RealOver};

use crate::contact::Sines;
use crate::cost;
use crate::models::ball::{ElasticContacts, ScaledBall};

/// A ball that slides at both contacts, in scaled units, which are based on the ball radius, the
/// axial load per ball and the relative speed. Arrays with two elements contain the values at the
/// nut and the screw.
#[derive(Debug, Clone, Copy)]
pub struct SlidingBall<P> {
    /// Friction coefficient with the sign of the relative speed, `$F = f\,\mathrm{sign} W$`.
    pub friction: P,
    /// Sine of the lead angle, `$\sin\alpha$`.
    pub sin: P,
    /// Cosine of the lead angle, `$\cos\alpha$`.
    pub cos: P,
    /// Cotangent of the lead angle, `$\cot\alpha$`.
    pub cot: P,
    /// Arc length of the helix per radian `$d/r_b$`.
    pub arc: P,
    /// Inertia ratio `$m r_m W^2/F_a$`.
    pub inertia_ratio: P,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub nut_speed: P,
    /// Distances `$l_0$` between the arc center and the ball center at first contact.
    pub offsets: [P; 2],
    /// Hertz approaches under a normal load that equals the axial load per ball.
    pub approaches: [P; 2],
    /// Radial distance `$A_2$` between the groove arc centers.
    pub radial_distance: P,
}

/// Forces on a ball in equilibrium. Arrays with two elements contain the values at the nut and the
/// screw.
#[derive(Debug, Clone, Copy)]
pub struct SlidingState<D> {
    /// Cotangents `$x$` of the slip angles.
    pub slip_cotangents: [D; 2],
    /// Sines of the contact angles.
    pub sin: [D; 2],
    /// Cosines of the contact angles.
    pub cos: [D; 2],
    /// Load ratios `$Q/F_a$`.
    pub loads: [D; 2],
    /// Load parameter `$Y$` (S15). The forces can be in equilibrium only if `$Y$` is positive and
    /// finite.
    pub load_parameter: D,
    /// Scaled centrifugal force `$M$` (S16).
    pub centrifugal: D,
    /// Sine and cosine of the difference between the contact angles, `$2\nu$`.
    pub angle_difference: (D, D),
}

/// Motion of a ball whose forces are in equilibrium.
#[derive(Debug, Clone, Copy)]
pub struct SlidingMotion<D> {
    /// Slip speeds at the nut and the screw, divided by `$r_b|W|$`; positive if the slip is
    /// opposite to friction.
    pub slip: [D; 2],
    /// Gyroscopic factor `$1 - g$` of (S26).
    pub inertia: D,
    /// Precession rate `$\pi/d + \Omega_n/W$` that corresponds to the slip (S26).
    pub drive: D,
}

/// A point on the equilibrium curve: the forces on the ball, and the corresponding motion.
#[derive(Debug, Clone, Copy)]
pub struct SlidingPoint<D> {
    /// Forces on the ball.
    pub state: SlidingState<D>,
    /// Motion of the ball.
    pub motion: SlidingMotion<D>,
}

impl<P: Real> SlidingBall<P> {
    /// Creates a sliding ball from the scaled description of a ball.
    ///
    /// * `friction`: friction coefficient with the sign of the speed.
    #[inline(always)]
    pub fn of(ball: &ScaledBall<P>, friction: P) -> Self {
        let (sin, cos) = ball.lead;
        Self {
            friction,
            sin,
            cos,
            cot: cos / sin,
            arc: ball.arc,
            inertia_ratio: ball.inertia_ratio(),
            nut_speed: ball.nut_speed,
            offsets: ball.offsets,
            approaches: ball.approaches,
            radial_distance: ball.radial_distance,
        }
    }
}

impl From<&ElasticContacts> for SlidingBall<f64> {
    fn from(contacts: &ElasticContacts) -> Self {
        Self::of(&contacts.scaled, contacts.directed_friction())
    }
}

impl<F: Real> SlidingBall<F> {
    /// Returns the efficiency of a ball without inertia at its contact angle under load, accurate
    /// to two digits. The efficiency is zero if friction alone can hold any load.
    /// The contact angle is calculated with a few steps of a fixed-point iteration. If friction
    /// alone can hold the load at an intermediate contact angle, this contact angle is increased.
    ///
    /// * `back`: true if the load back-drives the screw.
    #[inline(always)]
    pub(crate) fn static_efficiency(&self, back: F::Mask) -> F {
        let (zero, one) = (self.radial_distance.constant(0.0), self.radial_distance.constant(1.0));
        let friction = self.friction.abs();
        let (unloaded, softness) =
            (self.offsets[0] + self.offsets[1], self.approaches[0] + self.approaches[1]);
        let mut sines = self.at_angle(self.radial_distance / unloaded);
        let mut carried = zero.mask(false);
        for _ in 0..4 {
            // q = 1/[cosα (sinβ − f D)], Eq (C4)                          (P4)
            let mut load = sines.load_ratio(back, friction);
            for _ in 0..20 {
                carried = load.above(0.0) & load.below(f64::INFINITY);
                if !F::any(!carried) {
                    break;
                }
                sines = self.at_angle(F::select(carried, sines.cos_b, sines.cos_b * 0.8));
                load = sines.load_ratio(back, friction);
            }
            // (l_A + l_B) cosβ = A₂, Eq (J7)
            let pressed = F::select(carried, load, one).cbrt().square() * softness + unloaded;
            sines = self.at_angle(self.radial_distance / pressed);
        }
        F::select(carried, sines.efficiency(back, friction), zero)
    }

    /// Returns the sines and cosines of the lead angle and of the contact angle whose cosine is
    /// given.
    #[inline(always)]
    fn at_angle(&self, cos_b: F) -> Sines<F> {
        let sin_b = ((-cos_b + 1.0) * (cos_b + 1.0)).sqrt();
        Sines { sin_a: self.sin, cos_a: self.cos, sin_b, cos_b }
    }
}

impl<P: Real> SlidingBall<P> {
    /// Returns the factor `$1 + F^2$`.
    #[inline(always)]
    fn one_plus_friction_square(&self) -> P {
        self.friction.square() + 1.0
    }

    /// Returns `$\delta$` and the square of `$x_A$` for given `$q$`, `$x_B$` and `$c$` (S19).
    #[inline(always)]
    pub fn nut_cotangent_square<D: RealOver<P>>(&self, [q, screw, c]: [D; 3]) -> (D, D) {
        // δ = q (2c + q)/(1 + c²),  x_A² = (1 + δ) x_B² + δ/(1 + F²)      (S19)
        let load_excess = (c * 2.0 + q) * q / (c.square() + 1.0);
        let inverse = self.one_plus_friction_square().recip();
        (load_excess, screw.square() * (load_excess + 1.0) + load_excess * inverse)
    }

    /// Returns the forces on the ball for given cotangents of the slip angles (`$x_A$`, `$x_B$`)
    /// and given values of `$\delta$`, `$q$` and `$c$` in (S18) and (S19), together with the
    /// residuals of (S14) and (S20).
    #[inline(always)]
    pub fn state<D: RealOver<P>>(
        &self,
        [nut, screw]: [D; 2],
        load_excess: D,
        q: D,
        c: D,
    ) -> (SlidingState<D>, [D; 2]) {
        cost::count_evaluation();
        let (f, v) = (self.friction, self.one_plus_friction_square());
        let w = [(nut.square() + 1.0).sqrt(), (screw.square() + 1.0).sqrt()];
        // E = R_B/√(1 + c²),  m_A = E (c + q),  m_B = E c                 (S18)
        let e = ((screw.square() * v + 1.0) / (c.square() + 1.0)).sqrt();
        let m = [e * (c + q), e * c];
        let r = [e.square() + m[0].square(), e.square() + m[1].square()];
        // cosβ = (w m − F x E)/R²,  sinβ = (w E + F x m)/R²               (S17)
        let cos = [(w[0] * m[0] - nut * e * f) / r[0], (w[1] * m[1] - screw * e * f) / r[1]];
        let sin = [(w[0] * e + nut * m[0] * f) / r[0], (w[1] * e + screw * m[1] * f) / r[1]];
        // Y = 1/(E cosα − F sinα)                                         (S15)
        let load_parameter = (e * self.cos - f * self.sin).recip();
        // Q = Y w                                                         (S13)
        let loads = [load_parameter * w[0], load_parameter * w[1]];
        // 2ν follows from sin(φ_A − φ_B) and sin(η_B − η_A), both without cancellation  (S21)
        let sine = load_excess * r[1] * (f / v) / (nut * w[1] + screw * w[0]);
        let cosine = w[0] * w[1] + nut * screw * f.square();
        let (s, k) = (e.square() * q, m[0] * m[1] + e.square());
        let both = r[0] * r[1];
        let angle_difference = ((s * cosine - k * sine) / both, (k * cosine + s * sine) / both);
        // M = Y E q                                                       (S16)
        let centrifugal = load_parameter * e * q;
        // δ = (Q/K_H)^{2/3}                                               (P2)
        let a = (loads[0].cbrt().square() * self.approaches[0] + self.offsets[0]) * cos[0];
        let b = (loads[1].cbrt().square() * self.approaches[1] + self.offsets[1]) * cos[1];
        let residual = [
            // cosβ_A + cosβ_B = (x_A + x_B) tanα                          (S14)
            (cos[0] + cos[1]) * self.cot / (nut + screw) - 1.0,
            // l_A cosβ_A + l_B cosβ_B = A₂, Eq (J7)                       (S20)
            (a + b) * self.radial_distance.recip() - 1.0,
        ];
        let slip_cotangents = [nut, screw];
        (
            SlidingState {
                slip_cotangents,
                sin,
                cos,
                loads,
                load_parameter,
                centrifugal,
                angle_difference,
            },
            residual,
        )
    }

    /// Returns the cotangents `$x$` of the slip angles and the value of `$c$` for equal contact
    /// angles with a given cotangent, together with the effective load component. This component is
    /// positive unless friction alone can hold the load.
    #[inline(always)]
    pub fn equal_angles<D: RealOver<P>>(&self, cot: D) -> ([D; 2], D) {
        let sin = (cot.square() + 1.0).sqrt().recip();
        let (cos, f) = (cot * sin, self.friction);
        let x = cos * self.cot;
        let w = (x.square() + 1.0).sqrt();
        let effect = w * sin - x * cos * f;
        ([x, (w * cos + x * sin * f) / effect], effect)
    }

    /// Calculates the motion of the ball from forces that are in equilibrium.
    /// Assumes: `$r_m > 1.21\,r_b$`. Then, `$Y > 0$` if the slip is opposite to the friction force.
    #[inline(always)]
    pub fn motion<D: RealOver<P>>(&self, s: &SlidingState<D>) -> SlidingMotion<D> {
        let (d, [x_a, x_b]) = (self.arc, s.slip_cotangents);
        let share = ((x_a + x_b) * (x_a * x_b + 1.0)).recip();
        // |V_A| = w_A [x_B (d − cosα cosβ_B) − sinα]/[(x_A + x_B)(1 + x_A x_B)]  (S22)
        let nut = (x_b * (-s.cos[1] * self.cos + d) - self.sin) * share;
        // |V_B| = w_B [x_A (d + cosα cosβ_A) + sinα]/[(x_A + x_B)(1 + x_A x_B)]  (S23)
        let screw = (x_a * (s.cos[0] * self.cos + d) + self.sin) * share;
        // ϖ = |V_A| (1 + x_A cotα cosβ_A)/w_A                             (S24)
        let rolling = nut * (x_a * s.cos[0] * self.cot + 1.0) * d.recip();
        // g = (5/2) F Y cotα sin2ν/M                                      (S25)
        let g = s.load_parameter * (self.friction * 2.5 * self.cot) * s.angle_difference.0
            / s.centrifugal;
        let slip = [nut * s.loads[0] / s.load_parameter, screw * s.loads[1] / s.load_parameter];
        SlidingMotion { slip, inertia: -g + 1.0, drive: rolling + self.nut_speed }
    }

    /// Returns the residuals of (S26) for `$P/W > 0$` and for `$P/W < 0$`.
    #[inline(always)]
    pub fn inertia_residuals<D: RealOver<P>>(
        &self,
        SlidingPoint { state, motion }: &SlidingPoint<D>,
    ) -> [D; 2] {
        // (1 − g) √(M/μ) = ± (π/d + Ω_n/W)                                (S26)
        let circling = motion.inertia * (state.centrifugal * self.inertia_ratio.recip()).sqrt();
        [circling - motion.drive, circling + motion.drive]
    }
}

impl<F: Real> SlidingPoint<F> {
    /// Returns true if the ball is on its flanks and the slip is opposite to friction.
    #[inline(always)]
    pub(super) fn is_admissible(&self) -> F::Mask {
        let SlidingState { sin, cos, .. } = &self.state;
        let [a, b] = self.motion.slip;
        a.above(0.0)
            & b.above(0.0)
            & sin[0].at_least(0.0)
            & sin[1].at_least(0.0)
            & cos[0].above(0.0)
            & cos[1].above(0.0)
    }

    /// Returns true if the centrifugal force of this state is `factor` times the centrifugal force
    /// of `begin`, and all other factors of (S27) agree within the relative tolerance `change`.
    #[inline(always)]
    pub(super) fn has_only_grown(&self, begin: &Self, factor: F, change: f64) -> F::Mask {
        is_near(self.state.centrifugal / begin.state.centrifugal, factor, change)
            & is_near(self.motion.inertia, begin.motion.inertia, change)
            & is_near(self.motion.drive, begin.motion.drive, change)
    }

    /// Returns the logarithm of the inertia ratio `$\mu$` for which this point of the equilibrium
    /// curve is a steady motion (S27).
    #[inline(always)]
    pub(super) fn log_inertia(&self) -> F {
        let SlidingMotion { inertia, drive, .. } = self.motion;
        // ln μ = ln M + 2 ln |(1 − g)/(π/d + Ω_n/W)|                          (S27)
        self.state.centrifugal.ln() + (inertia / drive).abs().ln() * 2.0
    }
}

/// Returns true if two numbers agree within the relative tolerance `change`.
#[inline(always)]
fn is_near<F: Real>(x: F, y: F, change: f64) -> F::Mask {
    (x - y).abs().le(y.abs() * change)
}
