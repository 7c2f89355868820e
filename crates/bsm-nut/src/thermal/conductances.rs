//! Default conductances between nut, screw, balls and surroundings, and their uncertainty.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I9) to (I12).

use std::f64::consts::{PI, TAU};

use bsm_dyn::{DrivenPart, Reason};

use crate::BallNut;
use crate::geometry::count;

/// A quantity that is estimated unless the case gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guess {
    /// Conductance from the nut to the air.
    Nut,
    /// Film coefficient of the screw.
    ScrewFilm,
    /// Gap and wipers.
    Gap,
    /// Contacts of the balls at nut and screw.
    Balls,
    /// Ends of the screw.
    Ends,
    /// Heat of contacts and drag.
    Heat,
}

impl Guess {
    /// All estimated quantities.
    pub const ALL: [Self; 6] =
        [Self::Nut, Self::ScrewFilm, Self::Gap, Self::Balls, Self::Ends, Self::Heat];

    /// Returns the uncertainty factor of the quantity.
    pub fn range(self) -> f64 {
        match self {
            Self::Nut | Self::Balls => 2.0,
            Self::ScrewFilm => 1.4,
            Self::Gap | Self::Ends => 3.0,
            Self::Heat => 1.25,
        }
    }

    /// Returns a phrase that continues "runs away if".
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

    /// Returns the factor of the quantity if one estimate is changed.
    pub(super) fn factor(self, off: Option<(Self, f64)>) -> f64 {
        off.filter(|(guess, _)| *guess == self).map_or(1.0, |(_, by)| by)
    }

    /// Returns true if the case gives the quantity.
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
    /// Conductance from the nut with its bracket and table to the air.
    pub nut: f64,
    /// Film coefficient of the screw \[W/(m²·K)\].
    pub screw_film: f64,
    /// Conductance from nut to screw through gap and wipers.
    pub gap: f64,
    /// Conductance from balls to nut.
    pub ball_nut: f64,
    /// Conductance from balls to screw.
    pub ball_screw: f64,
    /// Conductance from each end of the screw to the structure.
    pub end: f64,
    /// Conductance from the screw to the coolant, along the whole length of the screw.
    pub coolant: f64,
    /// Conductance from the nut to the coolant.
    pub nut_coolant: f64,
}

/// Air: kinematic viscosity \[m²/s\], thermal conductivity \[W/(m·K)\], Prandtl number, coefficient
/// of expansion \[1/K\].
const AIR: (f64, f64, f64, f64) = (1.6e-5, 0.026, 0.71, 1.0 / 300.0);
/// Temperature rise for which free convection is calculated \[K\].
const RISE: f64 = 10.0;
/// Film coefficient of radiation at 300 K for an emissivity of one, `$4\sigma T^3$` \[W/(m²·K)\].
const RADIATION: f64 = 4.0 * 5.670_374_419e-8 * 300.0 * 300.0 * 300.0;
/// Acceleration of gravity \[m/s²\], with the digits used in the correlation.
const GRAVITY: f64 = 9.81;
/// Thermal diffusivity of steel \[m²/s\].
const DIFFUSIVITY: f64 = 1.2e-5;
/// Conductivity of grease that fills half of a gap \[W/(m·K)\], and the width of the gap \[m\].
const GREASE: (f64, f64) = (0.06, 0.0015);
/// Conductance of a bearing divided by the square of the pitch circle diameter \[W/(m²·K)\].
const BEARING: f64 = 3125.0;
/// Default ratio of the area of bracket and table to the area of the nut.
const CARRIAGE: f64 = 10.0;
/// Conductance of the contacts of all balls in series, from nut to screw, divided by the pitch
/// circle diameter \[W/(m·K)\]. This is (I11) for usual nuts at 1000 rpm, within a factor of 2.
const USUAL_BALLS: f64 = 65.0;

/// Returns the film coefficient of a cylinder that rotates in air \[W/(m²·K)\] (I9).
///
/// * `diameter`: diameter of the cylinder \[m\].
/// * `speed`: rotational speed \[rad/s\], 0 at rest.
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

/// Returns the film coefficient of a nut that moves in air \[W/(m²·K)\] (I10).
///
/// * `length`: length of the nut \[m\].
/// * `feed`: feed speed \[m/s\].
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

/// Returns the conductance of the contacts of all balls with one body \[W/K\] (I11).
///
/// * `radius`: `$\sqrt{ab}$` of a contact \[m\].
/// * `rolling`: speed of the contact on the body \[m/s\].
/// * `conductivity`: thermal conductivity of steel \[W/(m·K)\].
///
/// Source: Tian and Kennedy (1994), two bodies in series. Assumes: no film.
fn through_contacts(balls: f64, radius: f64, rolling: f64, conductivity: f64) -> f64 {
    let peclet = rolling * radius / (2.0 * DIFFUSIVITY);
    // G_bx = Z π a_e k √(π (0.6575 + Pe))/(2 · 1.22)                      (I11)
    balls * PI * radius * conductivity * (PI * (0.6575 + peclet)).sqrt() / (2.0 * 1.22)
}

/// The balls between nut and screw in the thermal network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BallLink {
    /// Balls in a known groove. The balls are a node of the network.
    Contacts {
        /// Number of loaded balls.
        balls: f64,
        /// `$\sqrt{ab}$` of a contact at nut and screw \[m\], see [`BallNut::contact_radii`].
        radii: [f64; 2],
        /// Cosine of the lead angle.
        lead_cosine: f64,
    },
    /// Balls in an unknown groove. Instead of a node, there is a conductance of usual size between
    /// nut and screw.
    Usual,
}

impl BallLink {
    /// Returns the balls of a nut with their contacts.
    ///
    /// * `radii`: see [`BallNut::contact_radii`].
    pub fn of(nut: &BallNut, radii: [f64; 2]) -> Self {
        let (balls, lead_cosine) = (count(nut.balls()), nut.helix.lead_angle.cos());
        Self::Contacts { balls, radii, lead_cosine }
    }
}

/// Surfaces and contacts that determine the conductances, and given conductances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surfaces {
    /// Pitch circle diameter \[m\].
    pub diameter: f64,
    /// Lead \[m\].
    pub lead: f64,
    /// Outer diameter and length of the nut set \[m\].
    pub size: (f64, f64),
    /// Area of bracket and table \[m²\]; defaults to ten times the area of the nut.
    pub carriage: Option<f64>,
    /// The driven part. A driven nut rotates in a bearing in its carriage.
    pub driven: DrivenPart,
    /// The balls.
    pub link: BallLink,
    /// Given conductance from nut and table to the air \[W/K\], which replaces the calculated
    /// value.
    pub nut: Option<f64>,
    /// Given film coefficient of the screw \[W/(m²·K)\].
    pub screw_film: Option<f64>,
    /// Given conductance of gap and wipers \[W/K\].
    pub gap: Option<f64>,
    /// Given conductance from balls to nut \[W/K\].
    pub ball_nut: Option<f64>,
    /// Given conductance from balls to screw \[W/K\].
    pub ball_screw: Option<f64>,
    /// Given conductance of each end of the screw \[W/K\].
    pub end: Option<f64>,
    /// Conductance from a hollow screw to its coolant, otherwise 0 \[W/K\].
    pub coolant: f64,
    /// Conductance from the nut to its coolant; defaults to 0 \[W/K\].
    pub nut_coolant: f64,
}

impl BallNut {
    /// Returns `$\sqrt{ab}$` of a contact at nut and screw under a normal load \[m\].
    ///
    /// # Errors
    ///
    /// An error if the contacts are not Hertzian.
    pub fn contact_radii(&self, load: f64) -> Result<[f64; 2], Reason> {
        Ok(self.hertz()?.map(|hertz| {
            let (a, b) = hertz.semi_axes(load);
            (a * b).sqrt()
        }))
    }
}

impl Surfaces {
    /// Returns the conductances in air as means over the time of the phases, including standstill.
    ///
    /// * `conductivity`: thermal conductivity of steel \[W/(m·K)\].
    /// * `phases`: time and absolute relative speed of screw and nut \[rad/s\] of each phase.
    /// * `off`: an estimated quantity and the factor by which it is changed.
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
            // The two halves of the conductance are in series.
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

    /// Returns the conductance from nut, bracket and table to the air \[W/K\]. For a nut that
    /// rotates, it consists of the film on the nut (I9) and of the path through its bearing to the
    /// carriage (I22).
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
/// * `diameter`: diameter of the bearing ring \[m\].
fn bearing_conductance(diameter: f64) -> f64 {
    BEARING * diameter.powi(2)
}

/// Coolant of a hollow screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coolant {
    /// Water.
    Water,
    /// Oil.
    Oil,
}

/// Returns the conductance to a coolant along a hollow screw \[W/K\] (I12).
///
/// * `flow` \[m³/s\].
/// * `bore`, `length`: diameter of the bore and length of the screw \[m\].
///
/// Source: Gnielinski (1976); laminar below a Reynolds number of 2300, with linear interpolation up
/// to 4000.
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
