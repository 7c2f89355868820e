//! The rigid model for inertia forces that are small against the load: start and existence.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R12) to (R20), (R23).

use super::scaled::{Scaled, Unknowns};
use crate::Angles;

/// Crowding (R45) up to which no point was seen to have a second root: the least of those that have one
/// is 3.4.
pub const UNIQUE_BELOW: f64 = 1.0;

/// Crowding (R45) from which second roots are looked for: below, one point in 10 000 has any.
pub const SEARCHED_FROM: f64 = 300.0;

/// First-order solution in the inertia ratio.
///
/// Loads are exact to first order in `$\varepsilon = m r_m P^2/F_a$`, the motion to zeroth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder {
    /// `$Q_A/F_a = Q_B/F_a$`; negative means self-locking.
    pub load: f64,
    /// `$q_{A'} = Q_{A'}/(\varepsilon F_a)$`; negative means that A' would have to pull.
    pub minor: f64,
    /// `$\varepsilon = m r_m P^2/F_a$`, the centrifugal force over the load.
    pub inertia: f64,
    /// `$\iota = \mu\max(1, (P/W)^2)$`, the size of the inertia forces over the load; over `$f$`
    /// it is the relative error of the first order.
    pub size: f64,
    /// Absolute precession over relative speed, `$P/W$`.
    pub rate: f64,
    /// Precession relative to the nut over relative speed, `$p$`.
    pub precession: f64,
    /// Existence margin: a finite root needs it positive.
    pub margin: f64,
    /// Slip at A over `$r_b|W|$`, of the sign of `margin`.
    pub slip: f64,
    /// Direction of the slip at A from `$e_x$` towards `$t$` \[rad\].
    pub slip_angle: f64,
    /// Spin moment `$s = I P\sigma/(r_b F_a)$`.
    pub spin: f64,
}

/// Motion without inertia of a ball that slides at both contacts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sliding {
    /// `$D$`.
    pub(crate) slip_factor: f64,
    /// `$\sin\psi$`.
    pub(crate) sin_psi: f64,
    /// `$\cos\psi$`.
    pub(crate) cos_psi: f64,
    /// `$\cos\alpha\cos\beta + \sin\alpha\tan\psi$`.
    pub(crate) lever: f64,
    /// `$p$`.
    pub(crate) precession: f64,
}

impl Sliding {
    /// Of a ball of radius `size` over the pitch radius.
    pub(crate) fn of(angles: &Angles<f64>, size: f64) -> Self {
        let (sin_a, cos_a) = angles.lead.sin_cos();
        let cos_b = angles.contact.cos();
        // tanψ = tanα / cosβ = T,  c = cosψ = cosβ/D,  s = sinψ = tanα/D  (R12)
        let d = angles.slip_factor();
        let (sin_psi, cos_psi) = (sin_a / cos_a / d, cos_b / d);
        // p = 1/2 − (r_b cosα / 2 r_m)(cosα cosβ + sinα T)                (R13)
        let lever = cos_a * cos_b + sin_a * sin_a / (cos_a * cos_b);
        let precession = 0.5 - 0.5 * size * cos_a * lever;
        Self { slip_factor: d, sin_psi, cos_psi, lever, precession }
    }
}

/// Spin moment `$s$` of the sliding ball, for the signed friction `$F$` and the load `$q$`.
pub(crate) fn spin_moment(angles: &Angles<f64>, signed: f64, load: f64) -> f64 {
    // s = −2 F q cosψ / (cosα cosβ)                                       (R20)
    -2.0 * signed * load / (angles.slip_factor() * angles.lead.cos())
}

impl FirstOrder {
    pub(crate) fn of(case: &Scaled<f64>) -> Self {
        let (sin_a, cos_a) = case.helix.lead_angle.sin_cos();
        let (sin_b, cos_b) = case.contact_angle.sin_cos();
        let (signed, ball) = (case.signed_friction, case.helix.radius.recip());
        let angles = Angles { lead: case.helix.lead_angle, contact: case.contact_angle };
        let Sliding { slip_factor: d, sin_psi, cos_psi, lever, precession: p } =
            Sliding::of(&angles, ball);
        // P/W = p + Ω_n/W,  ε = μ (P/W)²                                  (R14)
        let rate = p + case.nut_speed;
        let inertia = case.inertia_ratio() * rate * rate;
        // q_A' = (sinβ − F D) / [sin2β − F (cos2β + h sinψ) D/cosβ]       (R15)
        let h = rate.signum() * signed.signum();
        let (sin_2b, cos_2b) = (2.0 * sin_b * cos_b, (cos_b - sin_b) * (cos_b + sin_b));
        let denominator = sin_2b - signed * (cos_2b + h * sin_psi) / cos_psi;
        let minor = (sin_b - signed * d) / denominator;
        // margin = p tanα − 5 f sinβ cosβ q_A' |P/W|                      (R16)
        let margin = p * sin_a / cos_a - 5.0 * signed.abs() * sin_b * cos_b * minor * rate.abs();
        // Q/F_a = 1/[cosα (sinβ − F D)], Eq (C4)                          (R17)
        let load = (cos_a * (sin_b - signed * d)).recip();
        Self {
            load,
            minor,
            inertia,
            // ι = μ max(1, (P/W)²)                                        (R23)
            size: case.inertia_ratio() * (rate * rate).max(1.0),
            rate,
            precession: p,
            margin,
            // λ = margin / [(r_b/r_m)(cosα cosβ + sinα T) cosψ]           (R18)
            slip: margin / (ball * lever * cos_psi),
            // θ = ψ                                                       (R19)
            slip_angle: sin_psi.atan2(cos_psi),
            spin: spin_moment(&angles, signed, load),
        }
    }

    /// The unknowns of the full equations.
    pub(crate) fn unknowns(&self) -> Unknowns<f64> {
        Unknowns::from([
            self.load,
            self.minor * self.inertia,
            self.load,
            self.precession,
            self.slip,
            self.slip_angle,
            self.spin,
        ])
    }

    /// Size of the moment about the normal over `$r_b F_a$`: gyroscopic or friction of A'.
    pub(crate) fn normal_moment(&self) -> f64 {
        self.size * self.rate.abs().min(1.0)
    }

    /// Inertia forces times the load of a contact, over friction and over `$(P/W)^2$`: what roots have to
    /// exceed to be several.
    pub fn crowding(&self, friction: f64) -> f64 {
        // C = q ι / (f (P/W)²)                                            (R45)
        self.load.abs() * self.size / (friction * self.rate * self.rate)
    }

    /// True if a finite root exists, to first order: the contacts push and the ball slides on
    /// the nut.
    pub fn exists(&self) -> bool {
        self.load > 0.0 && self.minor > 0.0 && self.margin > 0.0
    }
}
