//! Positions of the balls, and errors of their grooves.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U1) to (U7) and (U31).

use std::f64::consts::TAU;

use bsm_dyn::{
    Ball, Coulomb, ElasticPoint, Load, Material, OperatingPoint, Reason,
    gothic::Grooves,
    hertz::{Groove, Hertz, Raceway},
};
use bsm_kin::{Drive, Helix};

use crate::ball::{Flanks, FourContacts};
use crate::bodies::{Bar, Ring};

/// Loaded balls between two ends of the ball return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circuit {
    /// Helix angle at which the loaded arc begins \[rad\].
    pub start: f64,
    /// Length of the arc \[rad\], positive.
    pub arc: f64,
    /// Loaded balls, evenly spaced, at least one.
    pub balls: usize,
    /// Index of the thread, counted from 0.
    pub thread: usize,
    /// Index of the nut body, counted from 0.
    pub body: usize,
    /// Flanks that exist.
    pub flanks: Flanks,
    /// Axial offset of the nut's groove \[m\], due to a spacer or a shift of the pitch.
    pub offset: f64,
}

/// An axial error of the nut's groove relative to the screw's groove.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeadError {
    /// A wave `$A\cos(k\theta + \varphi)$`.
    Wave {
        /// Amplitude `$A$` \[m\].
        amplitude: f64,
        /// Number of periods per turn `$k$`.
        order: f64,
        /// Phase `$\varphi$` \[rad\].
        phase: f64,
    },
    /// A slope `$s\,(z - z_0)$`.
    Slope {
        /// Slope `$s$`.
        slope: f64,
        /// Axial position without error `$z_0$` \[m\].
        origin: f64,
    },
}

/// Manufacturing errors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Errors {
    /// Excess of the radius of each ball over the nominal radius \[m\], in the order of the
    /// circuits. An empty list means no excess.
    pub balls: Vec<f64>,
    /// Excess of the radius of all balls \[m\].
    pub oversize: f64,
    /// Axial errors of the grooves, which are added.
    pub lead: Vec<LeadError>,
    /// Radial gap between the grooves and a ball \[m\]. A negative gap is an interference.
    pub gap: f64,
    /// Axial play of each body \[m\]. With a play, friction may press balls onto far flanks. `None`
    /// means that the play is too wide for this.
    pub axial_play: Option<f64>,
}

impl Errors {
    /// Adds the growth of the radius of all balls \[m\] to a nut with play: the play shrinks, and
    /// only the growth that exceeds the play is an oversize.
    ///
    /// * `inclination`: axial component of a unit normal load.
    fn grow_into_play(&mut self, growth: f64, inclination: f64) {
        // A play that is not given is too wide to be closed.
        let Some(play) = self.axial_play else { return };
        // s_a ← s_a − 4 Δr/(sinβ₀ cosα)                                   (U35)
        let left = play - 4.0 * growth / inclination;
        self.axial_play = Some(left.max(0.0));
        self.oversize += (-0.25 * inclination * left).max(0.0);
    }
}

/// A ball nut on its screw.
#[derive(Debug, Clone, PartialEq)]
pub struct BallNut {
    /// Helix of the ball centers.
    pub helix: Helix<f64>,
    /// Number of threads of the screw, at least one.
    pub starts: usize,
    /// The nominal ball.
    pub ball: Ball<f64>,
    /// Unloaded contact angle \[rad\], in (0, π/2).
    pub contact_angle: f64,
    /// Conformities of nut and screw (groove radius divided by ball diameter), above 1/2.
    pub conformity: (f64, f64),
    /// Elastic constants of raceways and balls.
    pub material: (Material, Material),
    /// The loaded balls, in one or several circuits.
    pub circuits: Vec<Circuit>,
    /// Manufacturing errors.
    pub errors: Errors,
    /// The nut as a bar along the axis; `None` if it is rigid.
    pub nut_bar: Option<Bar>,
    /// The screw as a bar along the axis; `None` if it is rigid.
    pub screw_bar: Option<Bar>,
    /// Radial expansion of the nut at its circuits; `None` if it is rigid.
    pub ring: Option<Ring>,
    /// Axial position of the reference point for displacements and loads \[m\]. `None` means the
    /// middle of the balls.
    pub reference: Option<f64>,
    /// Precession of the ball centers about the axis \[rad/s\], for their centrifugal force.
    pub precession: f64,
}

/// Position of a ball.
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
    /// Returns the balls in the order of the circuits (U1).
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

    /// Returns the same nut with bodies and balls that are warmer than at assembly \[K\]. The balls
    /// of a nut with play grow into the play, and press on both flanks only if they close it.
    ///
    /// * `rises`: temperature rises of nut, screw and balls.
    /// * `expansion`: coefficient of thermal expansion \[1/K\].
    #[must_use]
    pub fn warmed(&self, rises: [f64; 3], expansion: f64) -> Self {
        let mut nut = self.clone();
        let [of_nut, of_screw, of_balls] = rises.map(|rise| expansion * rise);
        let slope = of_nut - of_screw;
        // e += (ε_n − ε_s)(z − z_ref),  g += r_m (ε_n − ε_s),
        // Δr += r_b [ε_b − (ε_n + ε_s)/2]                                 (U31)
        nut.errors.lead.push(LeadError::Slope { slope, origin: self.middle() });
        nut.errors.gap += self.helix.radius * slope;
        let growth = self.ball.radius * (of_balls - 0.5 * (of_nut + of_screw));
        if self.has_play() {
            nut.errors.grow_into_play(growth, self.inclination());
        } else {
            nut.errors.oversize += growth;
        }
        nut
    }

    /// Returns true if balls of nominal size have play between the flanks of their arches: in a
    /// single nut without oversize balls. The bodies of a pair press on one flank each.
    fn has_play(&self) -> bool {
        let both = self.circuits.iter().all(|circuit| circuit.flanks == Flanks::Both);
        both && self.errors.oversize <= 0.0
    }

    /// Returns the nut on a screw that is elongated and thinned by tension (I5).
    ///
    /// * `strain`: axial strain.
    /// * `poisson_ratio`: Poisson's ratio of the screw.
    #[must_use]
    pub fn strained(&self, strain: f64, poisson_ratio: f64) -> Self {
        let mut nut = self.clone();
        // e −= s (z − z_ref),  g += r_m ν s                               (I5)
        nut.errors.lead.push(LeadError::Slope { slope: -strain, origin: self.middle() });
        nut.errors.gap += self.helix.radius * poisson_ratio * strain;
        nut
    }

    /// Returns the axial position of the reference point for displacements and loads \[m\].
    pub fn middle(&self) -> f64 {
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

    /// Returns a screw with one ball that carries an equal share of an axial load \[N\] of all
    /// balls.
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

    /// Returns the Hertz contacts at nut and screw.
    ///
    /// # Errors
    ///
    /// [`Reason::CurvaturesNotHertzian`].
    pub fn hertz(&self) -> Result<[Hertz; 2], Reason> {
        self.equal_share(1.0).hertz()
    }

    /// Returns the data that all balls share (U8).
    ///
    /// # Errors
    ///
    /// [`Reason::CurvaturesNotHertzian`].
    pub fn ball_in_grooves(&self) -> Result<FourContacts, Reason> {
        let ball = self.equal_share(1.0);
        let (series, grooves) = (ball.pressed_ball()?, Grooves::without_play(&ball)?);
        Ok(FourContacts {
            grooves,
            series,
            // δ_A/(δ_A + δ_B) = (K/K_A)^(2/3) for equal loads
            nut_share: (series.stiffness / grooves.stiffness[0]).powf(2.0 / 3.0),
            // F_c = m r_m P²                                              (U9)
            outward: self.ball.mass * self.helix.radius * self.precession * self.precession,
        })
    }

    /// Returns the displacement of the groove of a ball by its errors, along binormal and principal
    /// normal \[m\], and the excess of its radius \[m\] (U5) to (U7).
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

    /// Returns the axial component of a unit normal load at first contact,
    /// `$\sin\beta_0\cos\alpha$`.
    pub(crate) fn inclination(&self) -> f64 {
        self.contact_angle.sin() * self.helix.lead_angle.cos()
    }

    /// Returns the excess of the radius of a ball over the nominal radius \[m\] (U6).
    pub(crate) fn oversize(&self, number: usize) -> f64 {
        // Δr_j = Δr of this ball + Δr of all balls                        (U6)
        self.errors.balls.get(number).copied().unwrap_or(0.0) + self.errors.oversize
    }

    /// Returns the distances from groove-arc center to ball center at first contact, for nut and
    /// screw \[m\].
    fn offsets(&self) -> [f64; 2] {
        let offset = |member, conformity| Groove { member, conformity }.offset(self.ball.radius);
        [offset(Raceway::Nut, self.conformity.0), offset(Raceway::Screw, self.conformity.1)]
    }

    /// Returns the distance between the groove-arc centers of nut and screw at first contact \[m\].
    pub(crate) fn arc_distance(&self) -> f64 {
        self.offsets().iter().sum()
    }
}

/// Converts a small count to a floating-point number.
#[expect(clippy::cast_precision_loss, reason = "numbers of balls and threads")]
pub(crate) fn count(n: usize) -> f64 {
    n as f64
}
