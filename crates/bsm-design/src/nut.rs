//! Ratings of a nut from its geometry.

use std::f64::consts::PI;

use bsm_dyn::{Curvatures, Groove, Hertz, Material, Member, Reason, contact_modulus};

/// The formulas of the ratings are fits in millimetres.
const PER_MM: f64 = 1e3;

/// Loaded part of a nut and its screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nut {
    /// Diameter of the ball \[m\], positive.
    pub ball_diameter: f64,
    /// Diameter of the circle of ball centres \[m\], more than twice the ball's.
    pub pitch_diameter: f64,
    /// Lead \[m\], positive.
    pub lead: f64,
    /// Contact angle \[rad\], in (0, π/2).
    pub contact_angle: f64,
    /// Conformities of nut and screw, groove radius over ball diameter, above 1/2.
    pub conformity: (f64, f64),
    /// Elastic constants of races and balls.
    pub material: (Material, Material),
    /// Loaded balls of a turn, which may be a fraction; positive.
    pub balls_per_turn: f64,
    /// Loaded turns, which may be a fraction; positive.
    pub turns: f64,
}

/// Body of a nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Outer diameter \[m\].
    pub outer: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus: f64,
}

impl Nut {
    /// Lead angle \[rad\].
    pub fn lead_angle(&self) -> f64 {
        (self.lead / (PI * self.pitch_diameter)).atan()
    }

    /// Dynamic axial load rating `$C_a$` \[N\]: a million revolutions that 90 % survive (D1) to (D4).
    ///
    /// ```math
    /// C_a = C_s\big[1 + (C_s/C_n)^{10/3}\big]^{-3/10}\, i^{0.86}
    /// ```
    ///
    /// Source: ISO/DP 9783 as in Sobolewski (2002).
    pub fn dynamic_rating(&self) -> f64 {
        let (lead, alpha) = (self.lead_angle(), self.contact_angle);
        // γ = d_k cosα / d                                                (D1)
        let gamma = self.ball_diameter * alpha.cos() / self.pitch_diameter;
        let (low, high) = (1.0 - gamma, 1.0 + gamma);
        let (nut, screw) = self.conformity;
        // f_c = 93.2 (1 − sinα/3) γ^0.3 (1−γ)^1.39/(1+γ)^⅓ [1/(1 − 1/(2 f_s))]^0.41  (D2)
        let shape = 93.2 * (1.0 - alpha.sin() / 3.0) * gamma.powf(0.3) * low.powf(1.39)
            / high.cbrt()
            * (1.0 - 0.5 / screw).powf(-0.41);
        // C_s = f_c cos^0.86 α n^⅔ d_k^1.8 tanα cos^1.3 λ                 (D3)
        let of_screw = shape
            * alpha.cos().powf(0.86)
            * self.balls_per_turn.powf(2.0 / 3.0)
            * (self.ball_diameter * PER_MM).powf(1.8)
            * alpha.tan()
            * lead.cos().powf(1.3);
        // C_s/C_n = [(1−γ)/(1+γ)]^1.723 [(2 − 1/f_n)/(2 − 1/f_s)]^0.41,
        // C_a = C_s [1 + (C_s/C_n)^(10/3)]^−0.3 i^0.86                    (D4)
        let races = (low / high).powf(1.723) * ((2.0 - 1.0 / nut) / (2.0 - 1.0 / screw)).powf(0.41);
        of_screw * (1.0 + races.powf(10.0 / 3.0)).powf(-0.3) * self.turns.powf(0.86)
    }

    /// Static axial load rating `$C_{0a}$` \[N\]: a permanent mark of a ten-thousandth of the ball (D5).
    ///
    /// ```math
    /// C_{0a} = \frac{27.74\, n\,i\, d_k^2 \sin\alpha\cos\lambda}{d_k\sqrt{\rho_t\rho_x}}
    /// ```
    ///
    /// with the curvatures of the screw contact, its groove taken as that of a bearing.
    ///
    /// Source: ISO/DP 9783 as in Sobolewski (2002).
    pub fn static_rating(&self) -> f64 {
        let Curvatures { along, across } = self.curvatures(Member::Screw, 0.0);
        // C_0a = 27.74 n i sinα cosλ d_k² / (d_k √(ρ_t ρ_x))              (D5)
        27.74
            * self.balls_per_turn
            * self.turns
            * self.contact_angle.sin()
            * self.lead_angle().cos()
            * (self.ball_diameter * PER_MM).powi(2)
            / (self.ball_diameter * (along * across).sqrt())
    }

    /// Rigidity characteristic `$k$` of one turn \[N/m^1.5\], axial load over displacement to 3/2 (D6).
    ///
    /// ```math
    /// k = \frac{n\,(\sin\alpha\cos\lambda)^{5/2}}{(\delta_n + \delta_s)^{3/2}}
    /// ```
    ///
    /// `$\delta$` the Hertz approach at unit load. Source: ISO/DP 9784 as in Sobolewski (2002), with
    /// exact Hertz contacts of helical grooves in place of its fits.
    ///
    /// # Errors
    ///
    /// [`Reason::CurvaturesNotHertzian`] if the grooves leave no ellipse across them.
    pub fn turn_rigidity(&self) -> Result<f64, Reason> {
        let modulus = contact_modulus(&self.material.0, &self.material.1);
        let lead = self.lead_angle();
        let mut approach = 0.0;
        for member in [Member::Nut, Member::Screw] {
            let contact = Hertz::of(&self.curvatures(member, lead), modulus)?;
            // δ = (Q/K)^⅔                                                 (H9)
            approach += contact.stiffness.powf(-2.0 / 3.0);
        }
        let direction = self.contact_angle.sin() * lead.cos();
        // k = n (sinα cosλ)^5/2 / (δ_n + δ_s)^3/2                         (D6)
        Ok(self.balls_per_turn * (direction / approach).powf(1.5) * direction)
    }

    /// Displacement and rigidity \[m, N/m\] of the contacts of one nut under an axial load (D7).
    ///
    /// # Errors
    ///
    /// As [`turn_rigidity`](Self::turn_rigidity).
    pub fn contacts_under(&self, load: f64) -> Result<(f64, f64), Reason> {
        let k = self.turn_rigidity()? * self.turns;
        // δ = (F/(k i))^⅔,  dF/dδ = 3/2 k i √δ                            (D7)
        let displacement = (load / k).powf(2.0 / 3.0);
        Ok((displacement, 1.5 * k * displacement.sqrt()))
    }

    /// Rigidity of the body of one nut along its loaded turns \[N/m\] (D8).
    ///
    /// Source: Sobolewski (2002).
    pub fn body_rigidity(&self, body: &Body) -> f64 {
        let inner = self.pitch_diameter + self.ball_diameter * self.contact_angle.cos();
        let (outer, inner) = (body.outer * body.outer, inner * inner);
        // j = 2π i P E tan²α / [(D² + D_t²)/(D² − D_t²) + 1]              (D8)
        2.0 * PI * self.turns * self.lead * body.youngs_modulus * self.contact_angle.tan().powi(2)
            / ((outer + inner) / (outer - inner) + 1.0)
    }

    /// Efficiency of a screw whose balls roll against a resistance of lever arm `$f_r$` \[m\] (D9).
    ///
    /// Source: Sobolewski (2002), with (Q1).
    pub fn rolling_efficiency(&self, lever: f64) -> f64 {
        // tanρ = f_r / (r_b sinβ)                                         (Q1)
        let rho = (lever / (0.5 * self.ball_diameter * self.contact_angle.sin())).atan();
        // η = tanλ / tan(λ + ρ)                                           (D9)
        self.lead_angle().tan() / (self.lead_angle() + rho).tan()
    }

    fn curvatures(&self, member: Member, lead_angle: f64) -> Curvatures {
        let conformity = match member {
            Member::Nut => self.conformity.0,
            Member::Screw => self.conformity.1,
        };
        let (radius, ball) = (0.5 * self.pitch_diameter, 0.5 * self.ball_diameter);
        Groove { member, conformity }.curvatures(radius, ball, lead_angle, self.contact_angle)
    }
}
