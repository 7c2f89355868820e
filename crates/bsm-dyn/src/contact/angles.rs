//! Friction, efficiency and self-locking of a ball without inertia, as functions of lead angle and
//! contact angle.
//!
//! Theory: `docs/theory/03-closed-form.md`, equations (C1) to (C20).

use std::f64::consts::PI;

use bsm_kin::{Real, Scalar};

use crate::outcome::Direction;

/// Lead angle and contact angle of a screw. The contact angles at nut and screw are equal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angles<D> {
    /// Lead angle `$\alpha$` \[rad\], in (0, π/2).
    pub lead: D,
    /// Contact angle `$\beta$` \[rad\], in (0, π/2). A contact angle of 0 corresponds to a radial
    /// contact normal.
    pub contact: D,
}

impl<D: Scalar> Angles<D> {
    /// Returns the sines and cosines of lead angle and contact angle.
    pub fn sines(&self) -> Sines<D> {
        let (sin_a, cos_a) = self.lead.sin_cos();
        let (sin_b, cos_b) = self.contact.sin_cos();
        Sines { sin_a, cos_a, sin_b, cos_b }
    }

    /// Returns the slip factor `$D = \sqrt{\cos^2\beta + \tan^2\alpha}$` (C1).
    pub fn slip_factor(&self) -> D {
        self.sines().slip_factor()
    }

    /// Returns the efficiency (C2), (C3). It is negative if the screw is self-locking in the given
    /// direction of the power flow.
    ///
    /// ```math
    /// \eta_{rl} = 1 - \frac{f}{\cos^2\alpha\,\sin\beta\,(D + f\sin\beta)}, \qquad
    /// \eta_{lr} = 1 - \frac{f}{\cos^2\alpha\,(D\sin\beta + f D^2)}
    /// ```
    ///
    /// * `friction`: friction coefficient `$f \ge 0$`.
    ///
    /// Assumes: equal contact angles, saturated friction, and inertia forces that are small
    /// compared with the load. Source: Lin, Velinsky and Ravani, ASME J. Mech. Des. 116 (1994),
    /// Equations 14 and 17. Difference from the source: the square root does not include
    /// `$+ f\sin\beta$`; see `docs/theory/errata.md`.
    pub fn efficiency(&self, direction: Direction, friction: D) -> D {
        self.sines().efficiency(direction.is_back(), friction)
    }

    /// Returns the efficiency of a ball for a given slip direction at the screw (C17), (C18).
    ///
    /// ```math
    /// \eta_{rl} = \frac{\sin\beta - f(\cos\beta\cos\psi + \tan\alpha\sin\psi)}
    ///   {\sin\beta + f[\cos\psi\,(r_b/r_m - \cos\beta) + \sin\psi\,(1 - (r_b/r_m)\cos\beta)/\tan\alpha]}
    /// ```
    /// If the load back-drives the screw, the efficiency is the reciprocal of the expression above.
    ///
    /// * `friction`: friction coefficient `$f \ge 0$`.
    /// * `size_ratio`: ratio of ball radius to pitch circle radius `$r_b/r_m$`.
    /// * `slip_angle`: slip angle at the screw `$\psi_B$` \[rad\]. The slip angle at the nut
    ///   differs from it by π.
    ///
    /// Source: Lin, Velinsky and Ravani, ASME J. Mech. Des. 116 (1994), Equation 11. Difference
    /// from the source: the sign of the friction term in the numerator; see
    /// `docs/theory/errata.md`.
    pub fn efficiency_at(
        &self,
        direction: Direction,
        friction: D,
        size_ratio: D,
        slip_angle: D,
    ) -> D {
        let (force, torque) = self.transmitted_at(friction, size_ratio, slip_angle);
        match direction {
            Direction::RotaryToLinear => force / torque,
            Direction::LinearToRotary => torque / force,
        }
    }

    /// Returns the axial force and the torque of a ball for a given slip direction at the screw
    /// (C17), (C18). Both are divided by their values without friction at the same normal loads.
    pub fn transmitted_at(&self, friction: D, size_ratio: D, slip_angle: D) -> (D, D) {
        let sines @ Sines { sin_b, cos_b, .. } = self.sines();
        let (sin, cos) = slip_angle.sin_cos();
        let tan_a = sines.tan_a();
        // F_a/(Q cosα) = sinβ − f (cosβ cosψ + tanα sinψ)                 (C17)
        let force = sin_b - friction * (cos_b * cos + tan_a * sin);
        // M/(Q r_m sinα) = sinβ + f [cosψ (r_b/r_m − cosβ) + sinψ (1 − r_b/r_m cosβ)/tanα] (C18)
        let lever = (-(size_ratio * cos_b) + 1.0) / tan_a;
        let torque = sin_b + friction * (cos * (size_ratio - cos_b) + sin * lever);
        (force / sin_b, torque / sin_b)
    }

    /// Returns the ratio of the normal load, which is equal at both contacts, to the axial load per
    /// ball (C4).
    ///
    /// The result is negative if `$\sin\beta < f D$` and the drive moves the load. In this case, no
    /// normal load satisfies the force balance.
    pub fn load_ratio(&self, direction: Direction, friction: D) -> D {
        self.sines().load_ratio(direction.is_back(), friction)
    }

    /// Returns the slip angle at the screw `$\psi_B$` \[rad\]. The slip angle at the nut is
    /// `$\psi_A = \psi_B + \pi$`.
    ///
    /// Source: Lin, Velinsky and Ravani (1994), Equation 13.
    pub fn screw_slip_angle(&self, direction: Direction) -> D {
        // ψ_B = atan(tanα / cosβ), rotated by π for back-driving          (C5)
        let forward = self.lead.tan().atan2(self.contact.cos());
        match direction {
            Direction::RotaryToLinear => forward,
            Direction::LinearToRotary => forward - PI,
        }
    }
}

impl Angles<f64> {
    /// Returns true if the screw is self-locking in the given direction of the power flow (C6),
    /// (C7).
    ///
    /// Source: Lin, Velinsky and Ravani (1994), Equations 16 and 19.
    pub fn self_locking(&self, direction: Direction, friction: f64) -> bool {
        self.sines().self_locking(direction.is_back(), friction)
    }

    /// Returns the friction coefficient above which the screw is self-locking in the given
    /// direction of the power flow (C6), (C7).
    pub fn locking_friction(&self, direction: Direction) -> f64 {
        // Driving: f = sinβ/D                                             (C6)
        // Back-driving: f = D/sinβ                                        (C7)
        let [outer, inner] = self.sines().by_direction(direction.is_back());
        outer / inner
    }

    /// Returns the contact angle \[rad\] at the limit of self-locking for a lead angle \[rad\]
    /// (C14), (C15). For conversion from rotary to linear motion, the screw is self-locking at this
    /// contact angle and at all smaller angles; for conversion from linear to rotary motion, at
    /// this contact angle and at all larger angles.
    ///
    /// The result is π/2 if the screw is self-locking for every contact angle, and `None` if it is
    /// not self-locking for any contact angle.
    pub fn locking_contact_angle(
        direction: Direction,
        lead_angle: f64,
        friction: f64,
    ) -> Option<f64> {
        let unit = lead_angle.cos() * friction.hypot(1.0);
        match direction {
            // sinβ = f / (cosα √(1+f²))                                   (C14)
            Direction::RotaryToLinear => Some((friction / unit).min(1.0).asin()),
            // sinβ = 1 / (cosα √(1+f²))                                   (C15)
            Direction::LinearToRotary => (unit >= 1.0).then(|| unit.recip().asin()),
        }
    }

    /// Returns the lead angle \[rad\] at the limit of self-locking for a contact angle \[rad\]
    /// (C20). For conversion from rotary to linear motion, the screw is self-locking at this lead
    /// angle and at all larger angles; for conversion from linear to rotary motion, at this lead
    /// angle and at all smaller angles. The result is `None` if the screw is self-locking for every
    /// lead angle (rotary to linear) or for no lead angle (linear to rotary).
    pub fn locking_lead_angle(
        direction: Direction,
        contact_angle: f64,
        friction: f64,
    ) -> Option<f64> {
        let unit = contact_angle.sin() * friction.hypot(1.0);
        let term = if direction.is_back() { 1.0 } else { friction };
        // cosα = f / (sinβ √(1+f²)), or 1 / (sinβ √(1+f²)) for back-driving (C20)
        (term <= unit).then(|| (term / unit).acos())
    }
}

/// Contact angle with the best efficiency, together with this efficiency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimum {
    /// Optimal contact angle `$\beta^*$` \[rad\].
    pub contact_angle: f64,
    /// Efficiency at the optimal contact angle.
    pub efficiency: f64,
}

impl Optimum {
    /// Returns the contact angle that gives the best efficiency for a lead angle \[rad\], in closed
    /// form (C8) to (C10).
    ///
    /// ```math
    /// (\sin\beta^*\cos\alpha)^2 = y^* = \tfrac12\Big(1 \pm \frac{f}{\sqrt{1+f^2}}\Big), \qquad
    /// \eta^* = \big(\sqrt{1+f^2} - f\big)^2
    /// ```
    /// In the equation for `$y^*$`, the upper sign applies to conversion from rotary to linear
    /// motion. The function returns `None` if the lead angle is too large: `$\sin\beta^* =
    /// \sqrt{y^*}/\cos\alpha > 1$`.
    ///
    /// Source: roots of Equations 15 and 18 of Lin, Velinsky and Ravani (1994); the closed form was
    /// derived for this project.
    pub fn of(direction: Direction, lead_angle: f64, friction: f64) -> Option<Self> {
        // sinβ* = √y* / cosα                                              (C9)
        let sine = Self::constant(direction, friction) / lead_angle.cos();
        (sine <= 1.0).then(|| Self {
            contact_angle: sine.asin(),
            efficiency: Self::best_efficiency(friction),
        })
    }

    /// Returns the lead angle \[rad\] for which a given contact angle \[rad\] gives the best
    /// efficiency (C19), or `None` if the contact angle is too small: `$\sin\beta < \sqrt{y^*}$`.
    ///
    /// Source: Lin, Velinsky and Ravani (1994), "Load capacity considerations". For conversion from
    /// linear to rotary motion, this is the largest contact angle with the lead angle of Equation
    /// 18.
    pub fn lead_angle(direction: Direction, contact_angle: f64, friction: f64) -> Option<f64> {
        // cosα* = √y* / sinβ                                              (C19)
        let cosine = Self::constant(direction, friction) / contact_angle.sin();
        (cosine <= 1.0).then(|| cosine.acos())
    }

    /// Returns the value `$\sqrt{y^*}$` of `$\cos\alpha\sin\beta$` at the best efficiency. This
    /// value does not depend on the lead angle.
    pub fn constant(direction: Direction, friction: f64) -> f64 {
        // y* = (1 ± f/√(1+f²))/2                                          (C8)
        (0.5 * (1.0 + direction.sign() * friction / friction.hypot(1.0))).sqrt()
    }

    /// Returns the best efficiency over all contact angles. It is equal for driving and
    /// back-driving.
    pub fn best_efficiency(friction: f64) -> f64 {
        // η* = (√(1+f²) − f)² = 1/(√(1+f²) + f)²                          (C10)
        (friction.hypot(1.0) + friction).powi(-2)
    }
}

/// Sines and cosines of lead angle and contact angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sines<D> {
    /// Sine of the lead angle, `$\sin\alpha$`.
    pub sin_a: D,
    /// Cosine of the lead angle, `$\cos\alpha$`.
    pub cos_a: D,
    /// Sine of the contact angle, `$\sin\beta$`.
    pub sin_b: D,
    /// Cosine of the contact angle, `$\cos\beta$`.
    pub cos_b: D,
}

/// In all methods, `back` is a mask that is true if the load back-drives the screw, and `friction`
/// is the friction coefficient `$f \ge 0$`.
impl<D: Real> Sines<D> {
    /// Returns the tangent of the lead angle, `$\tan\alpha$`.
    #[inline(always)]
    pub fn tan_a(&self) -> D {
        self.sin_a / self.cos_a
    }

    /// Returns the slip factor `$D = \sqrt{\cos^2\beta + \tan^2\alpha}$` (C1).
    #[inline(always)]
    pub fn slip_factor(&self) -> D {
        // D = √(cos²β + tan²α)                                            (C1)
        (self.cos_b.square() + self.tan_a().square()).sqrt()
    }

    /// Returns `$\sin\beta$` and the slip factor `$D$` in this order, or in reverse order if the
    /// load back-drives the screw.
    #[inline(always)]
    fn by_direction(&self, back: D::Mask) -> [D; 2] {
        let (s, d) = (self.sin_b, self.slip_factor());
        [D::select(back, d, s), D::select(back, s, d)]
    }

    /// Returns the efficiency (C2), (C3); see [`Angles::efficiency`].
    #[inline(always)]
    pub fn efficiency(&self, back: D::Mask, friction: D) -> D {
        // Driving: η = 1 − f / {cos²α sinβ (D + f sinβ)}                  (C2)
        // Back-driving: η = 1 − f / {cos²α (D sinβ + f D²)}               (C3)
        let [outer, inner] = self.by_direction(back);
        -(friction / (self.cos_a.square() * outer * (inner + friction * outer))) + 1.0
    }

    /// Returns the ratio of normal load to axial load per ball (C4); see [`Angles::load_ratio`].
    #[inline(always)]
    pub fn load_ratio(&self, back: D::Mask, friction: D) -> D {
        let signed = D::select(back, -friction, friction);
        // Q/F_a = 1 / [cosα (sinβ ∓ f D)]                                 (C4)
        (self.cos_a * (self.sin_b - signed * self.slip_factor())).recip()
    }

    /// Returns the directions of the friction force on the ball at nut and screw \[rad\] (C5),
    /// (C11); see [`Angles::screw_slip_angle`].
    #[inline(always)]
    pub fn slip_angles(&self, back: D::Mask) -> [D; 2]
    where
        D: Real,
    {
        // ψ_B = atan(tanα / cosβ), rotated by π for back-driving          (C5)
        let forward = self.tan_a().atan2(self.cos_b);
        // ψ_A = ψ_B ± π, in (−π, π]                                       (C11)
        let turned = forward - PI;
        [D::select(back, forward, turned), D::select(back, turned, forward)]
    }

    /// Returns true if the screw is self-locking (C6), (C7); see [`Angles::self_locking`].
    #[inline(always)]
    pub fn self_locking(&self, back: D::Mask, friction: D) -> D::Mask
    where
        D: Real,
    {
        // Driving: sinβ ≤ f D                                             (C6)
        // Back-driving: D ≤ f sinβ                                        (C7)
        let [outer, inner] = self.by_direction(back);
        outer.le(friction * inner)
    }
}
