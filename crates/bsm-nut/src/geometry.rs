//! Geometry of a nut: positions of the balls, and manufacturing errors of balls and grooves.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U1) to (U7), (U31) and (U35).

use std::f64::consts::TAU;

use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Materials, OperatingPoint, Reason,
    gothic::Grooves,
    hertz::{Groove, Hertz, Raceway},
};
use bsm_kin::{Drive, Helix};

use crate::ball::{Flanks, FourContacts};
use crate::bodies::{Bar, Ring};

/// A circuit of loaded balls, which begins and ends at a ball return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circuit {
    /// Helix angle at the beginning of the loaded arc \[rad\].
    pub start: f64,
    /// Helix angle that the loaded arc spans \[rad\], positive.
    pub arc: f64,
    /// Number of loaded balls, which are evenly spaced; at least one.
    pub balls: usize,
    /// Index of the thread (start of the screw), counted from 0.
    pub thread: usize,
    /// Index of the nut body, counted from 0.
    pub body: usize,
    /// Flanks on which the balls of the circuit can carry load.
    pub flanks: Flanks,
    /// Axial offset of the nut groove due to a spacer or a lead shift \[m\].
    pub offset: f64,
}

/// An error of the axial position of the nut groove relative to the screw groove.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeadError {
    /// A periodic error `$A\cos(k\theta + \varphi)$`.
    Wave {
        /// Amplitude `$A$` \[m\].
        amplitude: f64,
        /// Number of periods per turn, `$k$`.
        order: f64,
        /// Phase `$\varphi$` \[rad\].
        phase: f64,
    },
    /// An error that is a linear function of the axial position, `$s\,(z - z_0)$`.
    Slope {
        /// Slope `$s$`: change of the axial error per unit of axial position (dimensionless).
        slope: f64,
        /// Axial position `$z_0$` at which the linear error is zero \[m\].
        origin: f64,
    },
}

/// Manufacturing errors of balls and grooves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Errors {
    /// Difference between the actual and the nominal radius of each ball \[m\], in the order of the
    /// circuits. If the list is empty, all balls have the nominal radius.
    pub balls: Vec<f64>,
    /// Difference between actual and nominal radius that is the same for all balls \[m\]. It is
    /// added to the entries of `balls`.
    pub oversize: f64,
    /// Axial errors of the grooves. The total axial error is the sum of all entries.
    pub lead: Vec<LeadError>,
    /// Radial gap between grooves and balls \[m\], which is negative for an interference.
    pub gap: f64,
    /// Axial play of each nut body \[m\]. If the play is given, friction may press balls onto far
    /// flanks. `None` means that the play is so large that no ball reaches a far flank.
    pub axial_play: Option<f64>,
}

impl Errors {
    /// Increases the radius of all balls by `growth` \[m\]. In a nut with play, the larger balls
    /// first reduce the play. Only the growth that exceeds the play makes the balls oversize.
    ///
    /// * `axial_fraction`: axial component of a unit normal load.
    fn grow_into_play(&mut self, growth: f64, axial_fraction: f64) {
        // If the play is not given, it is assumed to be too large to be closed by the growth of the
        // balls.
        let Some(play) = self.axial_play else { return };
        // s_a ← s_a − 4 Δr/(sinβ₀ cosα)                                   (U35)
        let left = play - 4.0 * growth / axial_fraction;
        self.axial_play = Some(left.max(0.0));
        self.oversize += (-0.25 * axial_fraction * left).max(0.0);
    }
}

/// A ball nut together with its screw.
#[derive(Debug, Clone, PartialEq)]
pub struct BallNut {
    /// Helix through the ball centers.
    pub helix: Helix<f64>,
    /// Number of starts of the screw, at least one.
    pub starts: usize,
    /// Nominal ball.
    pub ball: Ball<f64>,
    /// Unloaded contact angle \[rad\], in (0, π/2).
    pub contact_angle: f64,
    /// Conformities of nut and screw (groove radius divided by ball diameter), above 1/2.
    pub conformity: Conformities,
    /// Elastic constants of raceways and balls.
    pub material: Materials,
    /// Circuits of loaded balls.
    pub circuits: Vec<Circuit>,
    /// Manufacturing errors.
    pub errors: Errors,
    /// Axially elastic nut; `None` if the nut is rigid.
    pub nut_bar: Option<Bar>,
    /// Axially elastic screw; `None` if the screw is rigid.
    pub screw_bar: Option<Bar>,
    /// Radially elastic nut; `None` if the nut is rigid.
    pub ring: Option<Ring>,
    /// Axial position of the reference point, to which displacements and loads refer \[m\]. If
    /// `None`, the reference point is in the middle of the balls.
    pub reference: Option<f64>,
    /// Angular velocity of the ball centers about the screw axis \[rad/s\], which determines the
    /// centrifugal force.
    pub precession: f64,
}

/// Position of a ball on the helix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallPosition {
    /// Index of the circuit.
    pub circuit: usize,
    /// Helix angle \[rad\].
    pub theta: f64,
    /// Axial position \[m\].
    pub z: f64,
}

impl BallNut {
    /// Returns the positions of all balls in the order of the circuits (U1).
    pub fn positions(&self) -> Vec<BallPosition> {
        let lead = self.helix.lead();
        let per_radian = lead / TAU;
        let of = |(number, circuit): (usize, &Circuit)| {
            let Circuit { start, arc, balls, thread, .. } = *circuit;
            (0..balls).map(move |j| {
                // θ_j = θ_c + (j + ½) Θ_c/Z_c,  z_j = h θ_j + m_c P_h/n   (U1)
                let theta = start + (count(j) + 0.5) * arc / count(balls);
                let z = per_radian * theta + count(thread) * lead / count(self.starts);
                BallPosition { circuit: number, theta, z }
            })
        };
        self.circuits.iter().enumerate().flat_map(of).collect()
    }

    /// Returns the nut after thermal expansion of its bodies and balls. In a nut with play, the
    /// expansion of the balls first reduces the play. The balls press against both flanks only
    /// after the play is closed.
    ///
    /// * `rises`: temperature rises of nut, screw and balls above the assembly temperature \[K\].
    /// * `expansion`: coefficient of thermal expansion \[1/K\].
    #[must_use]
    pub fn warmed(&self, rises: [f64; 3], expansion: f64) -> Self {
        let mut nut = self.clone();
        let [of_nut, of_screw, of_balls] = rises.map(|rise| expansion * rise);
        let slope = of_nut - of_screw;
        // e += (ε_n − ε_s)(z − z_ref),  g += r_m (ε_n − ε_s),
        // Δr += r_b [ε_b − (ε_n + ε_s)/2]                                 (U31)
        nut.errors.lead.push(LeadError::Slope { slope, origin: self.reference_position() });
        nut.errors.gap += self.helix.radius * slope;
        let growth = self.ball.radius * (of_balls - 0.5 * (of_nut + of_screw));
        if self.has_play() {
            nut.errors.grow_into_play(growth, self.axial_fraction());
        } else {
            nut.errors.oversize += growth;
        }
        nut
    }

    /// Returns true if balls of nominal size have play between the flanks of their gothic arches.
    /// This is true for a single nut without oversize balls. It is false for a pair, because the
    /// offset presses each body against one flank.
    fn has_play(&self) -> bool {
        let both = self.circuits.iter().all(|circuit| circuit.flanks == Flanks::Both);
        both && self.errors.oversize <= 0.0
    }

    /// Returns the nut on a screw under axial tension, which stretches the screw and reduces the
    /// screw diameter (I5).
    ///
    /// * `strain`: axial strain of the screw.
    /// * `poisson_ratio`: Poisson's ratio of the screw.
    #[must_use]
    pub fn strained(&self, strain: f64, poisson_ratio: f64) -> Self {
        let mut nut = self.clone();
        // e −= s (z − z_ref),  g += r_m ν s                               (I5)
        nut.errors
            .lead
            .push(LeadError::Slope { slope: -strain, origin: self.reference_position() });
        nut.errors.gap += self.helix.radius * poisson_ratio * strain;
        nut
    }

    /// Returns the axial position of the reference point, to which displacements and loads refer
    /// \[m\].
    pub fn reference_position(&self) -> f64 {
        let mean = || {
            let positions = self.positions();
            positions.iter().map(|position| position.z).sum::<f64>() / count(positions.len())
        };
        self.reference.unwrap_or_else(mean)
    }

    /// Returns the number of loaded balls.
    pub fn balls(&self) -> usize {
        self.circuits.iter().map(|circuit| circuit.balls).sum()
    }

    /// Returns a screw whose only ball carries an equal share of an axial load on the nut \[N\].
    pub(crate) fn equal_share(&self, axial: f64) -> ElasticPoint {
        ElasticPoint {
            point: OperatingPoint {
                helix: self.helix,
                contact_angle: self.contact_angle,
                ball: self.ball,
                friction: Coulomb(0.0),
                drive: Drive { screw_speed: 0.0, nut_speed: 0.0 },
                load: Load { axial, balls: count(self.balls()) },
            },
            conformity: self.conformity,
            material: self.material,
        }
    }

    /// Returns the Hertzian contacts of a ball at nut and screw.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if the curvatures do not form a Hertzian contact.
    pub fn hertz(&self) -> Result<[Hertz; 2], Reason> {
        self.equal_share(1.0).hertz()
    }

    /// Returns the dimensions and the stiffness of the contacts between ball and grooves, which are
    /// the same for all balls (U8).
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if the curvatures do not form a Hertzian contact.
    pub fn ball_in_grooves(&self) -> Result<FourContacts, Reason> {
        let ball = self.equal_share(1.0);
        let (series, grooves) = (ball.pressed_ball()?, Grooves::without_play(&ball)?);
        Ok(FourContacts {
            grooves,
            series,
            // If both contacts carry the same load, the nut's fraction of the approach is δ_A/(δ_A
            // + δ_B) = (K/K_A)^(2/3).
            nut_share: (series.stiffness / grooves.stiffness[0]).powf(2.0 / 3.0),
            // F_c = m r_m P²                                              (U9)
            outward: self.ball.mass * self.helix.radius * self.precession * self.precession,
        })
    }

    /// Returns the groove displacement that manufacturing errors cause at a ball, along binormal
    /// and principal normal \[m\], and the excess of the ball radius over the nominal radius \[m\]
    /// (U5) to (U7).
    pub(crate) fn error_at(&self, number: usize, position: &BallPosition) -> ([f64; 2], f64) {
        let wrong = |error: &LeadError| match *error {
            LeadError::Wave { amplitude, order, phase } => {
                amplitude * (order * position.theta + phase).cos()
            }
            LeadError::Slope { slope, origin } => slope * (position.z - origin),
        };
        // e_j = Σ A_k cos(kθ_j + φ_k) + s (z_j − z₀)                      (U7)
        let lead: f64 = self.errors.lead.iter().map(wrong).sum();
        // w_b = cosα (o_c + e_j),  w_n = −g_j                             (U5)
        let along = self.helix.lead_angle.cos() * (self.circuits[position.circuit].offset + lead);
        ([along, -self.errors.gap], self.oversize(number))
    }

    /// Returns the axial component of a normal force of 1 N at first contact,
    /// `$\sin\beta_0\cos\alpha$`.
    pub(crate) fn axial_fraction(&self) -> f64 {
        self.contact_angle.sin() * self.helix.lead_angle.cos()
    }

    /// Returns the difference between the actual radius of a ball and the nominal radius \[m\]
    /// (U6).
    pub(crate) fn oversize(&self, number: usize) -> f64 {
        // Δr_j = Δr of ball j + Δr that all balls have in common          (U6)
        self.errors.balls.get(number).copied().unwrap_or(0.0) + self.errors.oversize
    }

    /// Returns the distances between groove-arc center and ball center at first contact, for nut
    /// and screw \[m\].
    fn offsets(&self) -> [f64; 2] {
        let offset = |member, conformity| Groove { member, conformity }.offset(self.ball.radius);
        [offset(Raceway::Nut, self.conformity.nut), offset(Raceway::Screw, self.conformity.screw)]
    }

    /// Returns the distance between the groove-arc centers of nut and screw at first contact \[m\].
    pub(crate) fn arc_distance(&self) -> f64 {
        self.offsets().iter().sum()
    }
}

/// Converts a small count to a floating-point number.
#[expect(clippy::cast_precision_loss, reason = "the numbers of balls and threads are small")]
pub(crate) fn count(n: usize) -> f64 {
    n as f64
}
