//! Load ratings and efficiency of a nut, calculated from its geometry.

use std::f64::consts::PI;

use bsm_dyn::{
    Conformities, Materials,
    hertz::{Curvatures, Groove, Raceway},
    solution::rolling_tangent,
};

/// Millimeters per meter, because the empirical rating formulas use millimeters.
const MM_PER_M: f64 = 1e3;

/// Geometry of the loaded part of a nut and its screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nut {
    /// Ball diameter \[m\], positive.
    pub ball_diameter: f64,
    /// Pitch circle diameter \[m\], more than twice the ball diameter.
    pub pitch_diameter: f64,
    /// Lead \[m\], positive.
    pub lead: f64,
    /// Contact angle \[rad\], in (0, π/2).
    pub contact_angle: f64,
    /// Conformities of nut and screw (groove radius divided by ball diameter), above 1/2.
    pub conformity: Conformities,
    /// Elastic constants of raceways and balls.
    pub material: Materials,
    /// Number of loaded balls per turn, positive. The number may be a fraction.
    pub balls_per_turn: f64,
    /// Number of loaded turns, positive. The number may be a fraction.
    pub turns: f64,
    /// Number of thread starts `$z$`, at least one. The loaded turns are distributed evenly among
    /// the starts.
    pub starts: f64,
}

/// Dynamic load rating together with intermediate results that help to check it by hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicRating {
    /// Geometry parameter `$\gamma$` (D1).
    pub gamma: f64,
    /// Geometry factor `$f_c$` (D2).
    pub shape: f64,
    /// Load rating of one turn for the screw raceway `$C_s$` \[N\] (D3).
    pub screw: f64,
    /// Ratio of the load ratings for the screw and nut raceways `$C_s/C_n$` (D4).
    pub ratio: f64,
    /// Load rating of one turn for both raceways together `$C_i$` \[N\] (D4).
    pub turn: f64,
    /// Dynamic load rating `$C_a$` \[N\] (D4).
    pub rating: f64,
}

/// Static load rating together with intermediate results that help to check it by hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticRating {
    /// Curvatures of the contact between ball and screw \[1/m\].
    pub curvatures: Curvatures,
    /// Static load capacity of a ball divided by `$D_w^2$` \[N/mm²\] (D5).
    pub factor: f64,
    /// Static load rating `$C_{0a}$` \[N\] (D5).
    pub rating: f64,
}

impl DynamicRating {
    /// Scales all load ratings so that the dynamic load rating of the nut equals a known value
    /// \[N\].
    #[must_use]
    pub fn scaled_to(self, rating: f64) -> Self {
        let factor = rating / self.rating;
        Self { screw: factor * self.screw, turn: factor * self.turn, rating, ..self }
    }
}

impl StaticRating {
    /// Scales the result so that the static load rating of the nut equals a known value \[N\].
    #[must_use]
    pub fn scaled_to(self, rating: f64) -> Self {
        Self { factor: rating / self.rating * self.factor, rating, ..self }
    }
}

impl Nut {
    /// Conformity for which the formulas reproduce the load ratings in the HIWIN catalog (BS-08-2).
    /// It is the default for tables that do not state the conformity.
    pub const USUAL_CONFORMITY: f64 = 0.5203;

    /// Number of turns by which the ball return shortens the loaded part of a circuit. It was
    /// fitted together with [`USUAL_CONFORMITY`](Self::USUAL_CONFORMITY).
    pub const RETURN_TURNS: f64 = 0.19;

    /// Returns the pitch circle diameter that belongs to a core diameter \[m\] (inverse of (G3)).
    pub fn pitch_diameter_over(core: f64, ball: f64, conformity: f64, contact_angle: f64) -> f64 {
        // D_pw = d_ro + 2 [R − (R − D_w/2) cosβ]                          (G3)
        let (radius, center_distance) = (conformity * ball, (conformity - 0.5) * ball);
        core + 2.0 * (radius - center_distance * contact_angle.cos())
    }

    /// Returns the lead angle \[rad\].
    pub fn lead_angle(&self) -> f64 {
        (self.lead / (PI * self.pitch_diameter)).atan()
    }

    /// Returns the axial distance between neighboring grooves `$P = P_h/z$` \[m\].
    pub fn pitch(&self) -> f64 {
        self.lead / self.starts
    }

    /// Returns the length of the helix through the ball centers over one turn \[m\] (D16).
    pub fn turn_length(&self) -> f64 {
        turn_length(self.pitch_diameter, self.lead)
    }

    /// Returns the dynamic axial load rating `$C_a$` \[N\] by (D1) to (D4). This is the load that
    /// 90 % of all nuts carry for a million revolutions.
    ///
    /// ```math
    /// C_a = C_s\big[1 + (C_s/C_n)^{10/3}\big]^{-3/10}\, i^{0.86}
    /// ```
    ///
    /// Source: ISO/DP 9784 as in Sobolewski (2002).
    pub fn dynamic_rating(&self) -> DynamicRating {
        let (lead_angle, beta) = (self.lead_angle(), self.contact_angle);
        // γ = D_w cosβ / D_pw                                             (D1)
        let gamma = self.ball_diameter * beta.cos() / self.pitch_diameter;
        let (low, high) = (1.0 - gamma, 1.0 + gamma);
        let Conformities { nut, screw } = self.conformity;
        // f_c = 93.2 (1 − sinβ/3) γ^0.3 (1−γ)^1.39/(1+γ)^⅓ [1/(1 − 1/(2 f_s))]^0.41  (D2)
        let shape = 93.2 * (1.0 - beta.sin() / 3.0) * gamma.powf(0.3) * low.powf(1.39)
            / high.cbrt()
            * (1.0 - 0.5 / screw).powf(-0.41);
        // C_s = f_c cos^0.86 β n^⅔ D_w^1.8 tanβ cos^1.3 α                 (D3)
        let of_screw = shape
            * beta.cos().powf(0.86)
            * self.balls_per_turn.powf(2.0 / 3.0)
            * (self.ball_diameter * MM_PER_M).powf(1.8)
            * beta.tan()
            * lead_angle.cos().powf(1.3);
        // C_s/C_n = [(1−γ)/(1+γ)]^1.723 [(2 − 1/f_n)/(2 − 1/f_s)]^0.41,
        // C_i = C_s [1 + (C_s/C_n)^(10/3)]^−0.3,  C_a = C_i i^0.86        (D4)
        let ratio = (low / high).powf(1.723) * ((2.0 - 1.0 / nut) / (2.0 - 1.0 / screw)).powf(0.41);
        let turn = of_screw * (1.0 + ratio.powf(10.0 / 3.0)).powf(-0.3);
        let rating = turn * self.turns.powf(0.86);
        DynamicRating { gamma, shape, screw: of_screw, ratio, turn, rating }
    }

    /// Returns the static axial load rating `$C_{0a}$` \[N\] (D5). This load leaves a permanent set
    /// of one ten-thousandth of the ball diameter.
    ///
    /// ```math
    /// C_{0a} = \frac{27.74\, n\,i\, D_w^2 \sin\beta\cos\alpha}{D_w\sqrt{\rho_t\rho_x}}
    /// ```
    /// Here, the curvatures belong to the contact between ball and screw. The groove is treated
    /// like a bearing groove, with zero lead angle.
    ///
    /// Source: ISO/DP 9784 as in Sobolewski (2002).
    pub fn static_rating(&self) -> StaticRating {
        let curvatures = self.curvatures(Raceway::Screw, 0.0);
        let Curvatures { longitudinal, transverse } = curvatures;
        // k₀ = 27.74 / (D_w √(ρ_t ρ_x)),  C_0a = k₀ n i sinβ cosα D_w²    (D5)
        let factor = 27.74 / (self.ball_diameter * (longitudinal * transverse).sqrt());
        let rating = factor
            * self.balls_per_turn
            * self.turns
            * self.contact_angle.sin()
            * self.lead_angle().cos()
            * (self.ball_diameter * MM_PER_M).powi(2);
        StaticRating { curvatures, factor, rating }
    }

    /// Returns the efficiency of a screw whose only loss is a rolling resistance with the lever arm
    /// `$f_r$` \[m\] (D9).
    ///
    /// Source: Sobolewski (2002), with (Q1).
    pub fn rolling_efficiency(&self, lever: f64) -> f64 {
        let ratio = lever / (0.5 * self.ball_diameter);
        let rho = rolling_tangent(ratio, self.contact_angle.sin()).atan();
        // η = tanα / tan(α + ρ)                                           (D9)
        self.lead_angle().tan() / (self.lead_angle() + rho).tan()
    }

    pub(crate) fn curvatures(&self, member: Raceway, lead_angle: f64) -> Curvatures {
        let conformity = match member {
            Raceway::Nut => self.conformity.nut,
            Raceway::Screw => self.conformity.screw,
        };
        let (radius, ball) = (0.5 * self.pitch_diameter, 0.5 * self.ball_diameter);
        Groove { member, conformity }.curvatures(radius, ball, lead_angle, self.contact_angle)
    }
}

/// Returns the length of the helix through the ball centers over one turn (D16), in the unit of the
/// arguments.
pub fn turn_length(pitch_diameter: f64, lead: f64) -> f64 {
    // L = √((π D_pw)² + P_h²)                                             (D16)
    (PI * pitch_diameter).hypot(lead)
}
