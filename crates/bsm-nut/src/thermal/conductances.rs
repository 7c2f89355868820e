//! Default conductances between nut, screw, balls and surroundings, and their uncertainty.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I9) to (I12).

use std::f64::consts::{PI, TAU};

use bsm_dyn::{DrivenPart, Reason};

use crate::BallNut;
use crate::geometry::count;

/// A quantity that is guessed unless it is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guess {
    /// What the nut gives to the air.
    Nut,
    /// The film of the screw.
    ScrewFilm,
    /// Gap and wipers.
    Gap,
    /// Contacts of the balls, both.
    Balls,
    /// Ends of the screw.
    Ends,
    /// Heat of contacts and drag.
    Heat,
}

impl Guess {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Nut, Self::ScrewFilm, Self::Gap, Self::Balls, Self::Ends, Self::Heat];

    /// Factor by which it may be more or less.
    pub fn range(self) -> f64 {
        match self {
            Self::Nut | Self::Balls => 2.0,
            Self::ScrewFilm => 1.4,
            Self::Gap | Self::Ends => 3.0,
            Self::Heat => 1.25,
        }
    }

    /// In words, after "runs away if".
    pub fn name(self) -> &'static str {
        match self {
            Self::Nut => "the nut gives away",
            Self::ScrewFilm => "the screw gives away",
            Self::Gap => "gap and wipers conduct",
            Self::Balls => "the balls conduct",
            Self::Ends => "the ends give away",
            Self::Heat => "contacts and drag heat",
        }
    }

    /// Factor on it where one guess is off.
    pub(super) fn factor(self, off: Option<(Self, f64)>) -> f64 {
        off.filter(|(guess, _)| *guess == self).map_or(1.0, |(_, by)| by)
    }

    /// True if a case gives it.
    pub(super) fn is_given(self, of: &Surfaces) -> bool {
        match self {
            Self::Nut => of.nut.or(of.carriage).is_some(),
            Self::ScrewFilm => of.screw_film.is_some(),
            Self::Gap => of.gap.is_some(),
            Self::Balls => of.ball_nut.is_some() && of.ball_screw.is_some(),
            Self::Ends => of.end.is_some(),
            Self::Heat => false,
        }
    }
}

/// Conductances of the network \[W/K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductances {
    /// Nut with its bracket and table to the air.
    pub nut: f64,
    /// Film of the screw \[W/(m²·K)\].
    pub screw_film: f64,
    /// Nut to screw through gap and wipers.
    pub gap: f64,
    /// Balls to nut.
    pub ball_nut: f64,
    /// Balls to screw.
    pub ball_screw: f64,
    /// Each end of the screw to the structure.
    pub end: f64,
    /// Screw to the coolant, along its whole length.
    pub coolant: f64,
    /// Nut to the coolant.
    pub nut_coolant: f64,
}

/// Kinematic viscosity of air \[m²/s\], its conductivity \[W/(m·K)\], Prandtl number, expansion \[1/K\].
const AIR: (f64, f64, f64, f64) = (1.6e-5, 0.026, 0.71, 1.0 / 300.0);
/// Rise at which free convection is taken \[K\].
const RISE: f64 = 10.0;
/// Film of radiation at 300 K and an emissivity of one, `$4\sigma T^3$` \[W/(m²·K)\].
const RADIATION: f64 = 4.0 * 5.670_374_419e-8 * 300.0 * 300.0 * 300.0;
/// Acceleration of free fall \[m/s²\], to the digits of the correlation.
const GRAVITY: f64 = 9.81;
/// Thermal diffusivity of steel \[m²/s\].
const DIFFUSIVITY: f64 = 1.2e-5;
/// Conductivity of grease that half fills a gap \[W/(m·K)\], and the gap \[m\].
const GREASE: (f64, f64) = (0.06, 0.0015);
/// Conductance of a bearing over the square of the pitch circle diameter \[W/(m²·K)\].
const BEARING: f64 = 3125.0;
/// Area of bracket and table over that of the nut.
const CARRIAGE: f64 = 10.0;
/// Conductance of the contacts of all balls in series, nut to screw, over the pitch circle diameter \[W/(m·K)\]: (I11) of usual
/// nuts at 1000 rpm, within a factor of 2.
const USUAL_BALLS: f64 = 65.0;

/// Film of a cylinder that turns in air \[W/(m²·K)\] (I9).
///
/// * `diameter` \[m\]; `speed` \[rad/s\], 0 at rest.
///
/// Source: Kays and Bjorklund (1958).
fn film_of_cylinder(diameter: f64, speed: f64) -> f64 {
    let (viscosity, conductivity, prandtl, expansion) = AIR;
    let reynolds = speed * diameter.powi(2) / (2.0 * viscosity);
    let grashof = GRAVITY * expansion * RISE * diameter.powi(3) / viscosity.powi(2);
    // h_s = Nu k_a/D + 4 ε σ T³,  Nu = 0.135 [(Re²/2 + Gr) Pr]^(1/3)      (I9)
    0.135 * ((0.5 * reynolds.powi(2) + grashof) * prandtl).cbrt() * conductivity / diameter
        + 0.3 * RADIATION
}

/// Film of a nut that moves in air \[W/(m²·K)\] (I10).
///
/// * `length` of the nut \[m\]; `feed` \[m/s\].
///
/// Source: McAdams (free convection); laminar flow along a plate.
fn film_of_nut(length: f64, feed: f64) -> f64 {
    let (viscosity, conductivity, prandtl, _) = AIR;
    let free = 1.42 * (RISE / length).powf(0.25);
    let forced =
        0.664 * (feed * length / viscosity).sqrt() * prandtl.cbrt() * conductivity / length;
    // h_n = (h_f³ + h_v³)^(1/3) + 4 ε σ T³                                (I10)
    (free.powi(3) + forced.powi(3)).cbrt() + 0.9 * RADIATION
}

/// Conductance of the contacts of all balls with one body \[W/K\] (I11).
///
/// * `radius`: `$\sqrt{ab}$` of a contact \[m\]; `rolling`: speed of the contact over the body \[m/s\];
///   `conductivity` of steel \[W/(m·K)\].
///
/// Source: Tian and Kennedy (1994), two bodies in series. Assumes: no film.
fn through_contacts(balls: f64, radius: f64, rolling: f64, conductivity: f64) -> f64 {
    let peclet = rolling * radius / (2.0 * DIFFUSIVITY);
    // G_bx = Z π a_e k √(π (0.6575 + Pe))/(2 · 1.22)                      (I11)
    balls * PI * radius * conductivity * (PI * (0.6575 + peclet)).sqrt() / (2.0 * 1.22)
}

/// The balls between nut and screw, as heat sees them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BallLink {
    /// Balls in a known groove, which are a node of their own.
    Contacts {
        /// Number of loaded balls.
        balls: f64,
        /// `$\sqrt{ab}$` of a contact with nut and screw \[m\], [`BallNut::contact_radii`].
        radii: [f64; 2],
        /// Cosine of the lead angle.
        lead_cosine: f64,
    },
    /// Balls in an unknown groove: no node, but a link of nut and screw in usual size.
    Usual,
}

impl BallLink {
    /// Returns the balls of a nut in their contacts.
    ///
    /// * `radii`: see [`BallNut::contact_radii`].
    pub fn of(nut: &BallNut, radii: [f64; 2]) -> Self {
        let (balls, lead_cosine) = (count(nut.balls()), nut.helix.lead_angle.cos());
        Self::Contacts { balls, radii, lead_cosine }
    }
}

/// Surfaces and contacts from which the conductances follow, and the conductances that are given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surfaces {
    /// Pitch circle diameter \[m\].
    pub diameter: f64,
    /// Lead \[m\].
    pub lead: f64,
    /// Outer diameter and length of the nut set \[m\].
    pub size: (f64, f64),
    /// Area of bracket and table \[m²\]; ten times that of the nut unless given.
    pub carriage: Option<f64>,
    /// The part that turns; a driven nut turns in a bearing in its carriage.
    pub driven: DrivenPart,
    /// The balls.
    pub link: BallLink,
    /// Given, in place of what is computed \[W/K\].
    pub nut: Option<f64>,
    /// \[W/(m²·K)\]
    pub screw_film: Option<f64>,
    /// \[W/K\]
    pub gap: Option<f64>,
    /// \[W/K\]
    pub ball_nut: Option<f64>,
    /// \[W/K\]
    pub ball_screw: Option<f64>,
    /// \[W/K\]
    pub end: Option<f64>,
    /// Of a hollow screw, else 0 \[W/K\].
    pub coolant: f64,
    /// 0 unless given \[W/K\].
    pub nut_coolant: f64,
}

impl BallNut {
    /// `$\sqrt{ab}$` of a contact with nut and screw under a normal load \[m\].
    ///
    /// # Errors
    ///
    /// The contacts are no Hertzian ones.
    pub fn contact_radii(&self, load: f64) -> Result<[f64; 2], Reason> {
        Ok(self.hertz()?.map(|hertz| {
            let (a, b) = hertz.semi_axes(load);
            (a * b).sqrt()
        }))
    }
}

impl Surfaces {
    /// Returns the conductances in air: means over the time of the phases, with standstill.
    ///
    /// * `conductivity`: of steel \[W/(m·K)\]. * `phases`: time and absolute relative speed of screw and nut \[rad/s\] of each.
    ///   * `off`: a guess that is off, and its factor.
    pub fn conductances(
        &self,
        conductivity: f64,
        phases: &[(f64, f64)],
        off: Option<(Guess, f64)>,
    ) -> Conductances {
        let diameter = self.diameter;
        let length = self.size.1;
        let [ball_nut, ball_screw] = match self.link {
            BallLink::Contacts { balls, radii, lead_cosine } => {
                let per_speed = diameter / (4.0 * lead_cosine);
                radii.map(|radius| {
                    mean(phases, |speed| {
                        through_contacts(balls, radius, per_speed * speed, conductivity)
                    })
                })
            }
            // Two halves in series.
            BallLink::Usual => [2.0 * USUAL_BALLS * diameter; 2],
        };
        let gap = GREASE.0 * PI * diameter * length / GREASE.1;
        let film = || match self.driven {
            DrivenPart::Screw => mean(phases, |speed| film_of_cylinder(diameter, speed)),
            DrivenPart::Nut => film_of_cylinder(diameter, 0.0),
        };
        Conductances {
            nut: self.nut.unwrap_or_else(|| Guess::Nut.factor(off) * self.of_nut(phases)),
            screw_film: self.screw_film.unwrap_or_else(|| Guess::ScrewFilm.factor(off) * film()),
            gap: self.gap.unwrap_or(Guess::Gap.factor(off) * gap),
            ball_nut: self.ball_nut.unwrap_or(Guess::Balls.factor(off) * ball_nut),
            ball_screw: self.ball_screw.unwrap_or(Guess::Balls.factor(off) * ball_screw),
            end: self.end.unwrap_or(Guess::Ends.factor(off) * bearing_conductance(diameter)),
            coolant: self.coolant,
            nut_coolant: self.nut_coolant,
        }
    }

    /// Returns the conductance from nut, bracket and table to the air \[W/K\]: of a nut that turns by its film (I9), and through its
    /// bearing to the carriage (I22).
    ///
    /// * `phases`: see [`conductances`](Self::conductances).
    fn of_nut(&self, phases: &[(f64, f64)]) -> f64 {
        let (outer, length) = self.size;
        let own = PI * outer * length;
        let carriage = self.carriage.unwrap_or(CARRIAGE * own);
        let film = film_of_nut(length, self.lead / TAU * mean(phases, |speed| speed));
        match self.driven {
            DrivenPart::Screw => film * (own + carriage),
            DrivenPart::Nut => {
                let turning = mean(phases, |speed| film_of_cylinder(outer, speed));
                // G_n = h(D₁) π D₁ L_n + [1/(h_n A_t) + 1/G_e(D₁)]⁻¹      (I22)
                turning * own
                    + ((film * carriage).recip() + bearing_conductance(outer).recip()).recip()
            }
        }
    }
}

/// Returns the mean of a function of the speed over the time of the phases.
fn mean(phases: &[(f64, f64)], of: impl Fn(f64) -> f64) -> f64 {
    let time: f64 = phases.iter().map(|(time, _)| time).sum();
    phases.iter().map(|(share, speed)| share * of(*speed)).sum::<f64>() / time
}

/// Returns the conductance of a bearing \[W/K\].
///
/// * `diameter`: of its ring \[m\].
fn bearing_conductance(diameter: f64) -> f64 {
    BEARING * diameter.powi(2)
}

/// What flows through a hollow screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coolant {
    /// Water.
    Water,
    /// Oil.
    Oil,
}

/// Conductance to a coolant along a hollow screw \[W/K\] (I12).
///
/// * `flow` \[m³/s\]; `bore`, `length` \[m\].
///
/// Source: Gnielinski (1976); laminar below a Reynolds number of 2300, a straight line up to 4000.
pub fn coolant_conductance(coolant: Coolant, flow: f64, bore: f64, length: f64) -> f64 {
    const LAMINAR: (f64, f64) = (2300.0, 3.66);
    const TURBULENT: f64 = 4000.0;
    let [conductivity, viscosity, prandtl, density, capacity] = match coolant {
        Coolant::Water => [0.60, 1.0e-6, 7.0, 998.0, 4180.0],
        Coolant::Oil => [0.14, 2.0e-5, 236.0, 870.0, 1900.0],
    };
    let gnielinski = |reynolds: f64| {
        let eighth = (0.79 * reynolds.ln() - 1.64).powi(-2) / 8.0;
        let excess = f64::powf(prandtl, 2.0 / 3.0) - 1.0;
        eighth * (reynolds - 1000.0) * prandtl / (1.0 + 12.7 * eighth.sqrt() * excess)
    };
    let reynolds = 4.0 * flow / (PI * bore * viscosity);
    let nusselt = if reynolds >= TURBULENT {
        gnielinski(reynolds)
    } else {
        let part = ((reynolds - LAMINAR.0) / (TURBULENT - LAMINAR.0)).max(0.0);
        LAMINAR.1 + part * (gnielinski(TURBULENT) - LAMINAR.1)
    };
    let stream = flow * density * capacity;
    // G_c = C (1 − exp(−UA/C)),  UA = Nu k_c π l                          (I12)
    -stream * (-nusselt * conductivity * PI * length / stream).exp_m1()
}
