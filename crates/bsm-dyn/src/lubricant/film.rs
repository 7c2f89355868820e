//! The film between ball and race, the share of the load that asperities carry, and what rolling loses.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y6) to (Y9), (Y14) to (Y20).

use std::f64::consts::PI;

use bsm_kin::{BallFrame, Contact, Motion, Over, Scalar};
use nalgebra::Vector3;

use super::{Lubricant, MixedFriction, WarmOil};
use crate::elastic_ball::{ElasticBall, ElasticPoint, Loaded};
use crate::ellipse::{Lanes, Local, Nodes};
use crate::hertz::contact_modulus;
use crate::{FrictionLaw, Unsolved, Wrench};

/// Root mean square roughness of the surfaces \[m\], positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness<D = f64> {
    /// Of the balls.
    pub ball: D,
    /// Of the groove of the nut.
    pub nut: D,
    /// Of the groove of the screw.
    pub screw: D,
}

/// What a film depends on besides load and speed: the gap of one contact \[SI\]. Its powers are taken once.
#[derive(Debug, Clone, Copy)]
struct Gap<P> {
    /// Radius along the track `$R_x = 1/\rho_t$`.
    radius: P,
    /// `$b/a$`.
    flatness: P,
    /// Semi-axis across the groove over the cube root of the load.
    semi_axis: P,
    /// Roughness of both surfaces together.
    roughness: P,
    /// Speed and load for which `$U$` and `$W$` of (Y6) are one.
    unit_speed: P,
    unit_load: P,
    /// `$L$` of (Y8) over `$U^2$`.
    heat: P,
    /// Film of (Y7) over `$U^{0.67}W^{-0.067}\varphi_T$`.
    film: P,
    /// `$M\,U_2^{3/4}/W$` of (Y17), what `$U_2^{-1/12}$` and one are multiplied with in (Y16), and all of it
    /// over semi-axis, brackets and `$U_2^{3/4}$`.
    elastic: P,
    rigid: P,
    flat: P,
    rolling: P,
}

/// An operating point with its oil: what turns loads and speeds of a scaled point into films.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wetted<P = f64> {
    lubricant: Lubricant<P>,
    pub(crate) oil: WarmOil<P>,
    gaps: [Gap<P>; 2],
    /// `$F_a$`, `$r_b |W|$` and `$r_b$`.
    pub(crate) load: P,
    pub(crate) speed: P,
    pub(crate) length: P,
}

/// A film, scaled as the point is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Film<D> {
    /// Entrainment: signed along the track, and its size, with the creep speed.
    pub(crate) along: D,
    pub(crate) entrainment: D,
    /// Thickness \[m\], its power of the entrainment here, and over the roughness.
    pub(crate) thickness: D,
    pub(crate) growth: D,
    pub(crate) ratio: D,
    /// Friction at its points.
    pub(crate) law: MixedFriction<D>,
    /// Force of the oil `$F_R$`, and couple of all that rolling loses `$C$`.
    pub(crate) force: D,
    pub(crate) couple: D,
    /// `$2 R_x/r_b - 1$`.
    lever: D,
}

impl<P: Scalar> Wetted<P> {
    /// A point with its oil at a temperature \[K\].
    pub(crate) fn new(
        screw: &ElasticPoint<P>,
        lubricant: &Lubricant<P>,
        temperature: P,
    ) -> Result<Self, Unsolved> {
        let hertz = screw.hertz().map_err(Unsolved::invalid)?;
        let (curvatures, Roughness { ball, nut, screw: groove }) =
            (screw.curvatures(), lubricant.roughness);
        let modulus = contact_modulus(&screw.material.0, &screw.material.1) * 2.0;
        let oil = lubricant.oil.at(temperature);
        let gaps = [(0, nut), (1, groove)].map(|(i, race)| {
            let radius = curvatures[i].along.recip();
            let flatness = hertz[i].flatness;
            // U = η u/(E' R_x),  G = α E',  W = Q/(E' R_x²)               (Y6)
            let unit_speed = modulus * radius / oil.viscosity;
            let stiffening = (oil.pressure_viscosity * modulus).powf(0.53);
            // h = 2.69 R_x U^0.67 G^0.53 W^−0.067 (1 − 0.61 e^{−0.73κ}) φ_T φ_s  (Y7)
            let shape = -(flatness.recip() * -0.73).exp() * 0.61 + 1.0;
            let film = radius * stiffening * shape * lubricant.film_factor * 2.69;
            // B = (4/π) E(m)/(1 + ρ_x/ρ_t)                                (Y15)
            let inlet = hertz[i].second_integral * (4.0 / PI)
                / (curvatures[i].across / curvatures[i].along + 1.0);
            Gap {
                radius,
                flatness,
                semi_axis: hertz[i].semi_axis,
                roughness: (ball.square() + race.square()).sqrt(),
                unit_speed,
                unit_load: modulus * radius.square(),
                // L = η β u²/k                                            (Y8)
                heat: unit_speed.square()
                    * oil.viscosity
                    * oil.thinning
                    * lubricant.oil.base.conductivity().recip(),
                film,
                // M = B^{1/4} k W U₂^{−3/4}                               (Y17)
                elastic: inlet.powf(0.25) * flatness,
                // 0.77 B^{−1/3} k^0.12 U₂^{−1/12},  c = 1.8 B^{−1/4}      (Y16)
                rigid: inlet.powf(-1.0 / 3.0) * flatness.powf(0.12) * 0.77,
                flat: inlet.powf(-0.25) * 1.8,
                rolling: radius * modulus * lubricant.rolling_factor * lubricant.film_factor * 2.0,
            }
        });
        let relative = screw.point.drive.relative_speed();
        Ok(Self {
            lubricant: *lubricant,
            oil,
            gaps,
            load: screw.point.load.per_ball(),
            speed: screw.point.ball.radius * relative * relative.re().signum(),
            length: screw.point.ball.radius,
        })
    }

    /// The film at nut (0) or screw (1).
    ///
    /// * `motion`: relative to the race. * `load`, `arc`, `creep`: scaled as the point is.
    pub(crate) fn film<D: Over<P>>(
        &self,
        i: usize,
        (contact, load): (&Contact<D>, D),
        motion: &Motion<D>,
        frame: &BallFrame<D>,
        (arc, creep): (P, f64),
    ) -> Film<D> {
        let along = entrainment(contact, motion, frame, D::from(arc));
        // u = √(u_t² + v_e²)                                              (Y14)
        let u = (along.square() + creep * creep).sqrt();
        self.of_speed(i, load, along, u)
    }

    /// The film of a load and an entrainment, signed and its size.
    pub(crate) fn of_speed<D: Over<P>>(
        &self,
        i: usize,
        load: D,
        along: D,
        entrainment: D,
    ) -> Film<D> {
        let (Self { lubricant, oil, .. }, gap) = (self, &self.gaps[i]);
        let (speed, force) = (entrainment * self.speed, load * self.load);
        let radius = D::from(gap.radius);
        // U = η u/(E' R_x),  W = Q/(E' R_x²)                              (Y6)
        let rate = speed / D::from(gap.unit_speed);
        let (log_rate, weight) = (rate.ln(), force / D::from(gap.unit_load));
        // φ_T = 1/(1 + 0.254 L^0.62)                                      (Y8)
        let heat = (log_rate * (2.0 * 0.62)).exp() * D::from(gap.heat.powf(0.62));
        let heating = (heat * 0.254 + 1.0).recip();
        // h ~ U^0.67 W^−0.067 φ_T                                         (Y7)
        let thickness = (log_rate * 0.67 - weight.ln() * 0.067).exp() * D::from(gap.film) * heating;
        // λ = h/√(R_q,ball² + R_q,race²),  ξ = e^{−1.4λ}                  (Y9)
        let ratio = thickness / D::from(gap.roughness);
        let share = (ratio * -1.4).exp();
        let semi_axis = force.cbrt() * gap.semi_axis;
        let short = semi_axis * gap.flatness;
        let max_pressure = force * 1.5 / (semi_axis * short * PI);
        let law = MixedFriction::of(
            (oil, lubricant.oil.limiting_shear, lubricant.boundary_friction),
            (thickness, share, max_pressure),
            self.speed,
        );
        let rolling = gap.rolling_force(log_rate, weight, semi_axis) * heating;
        // C = 2 F_R R_x + (3/16) c_h Q b                                  (Y18)
        let couple =
            rolling * radius * 2.0 + force * short * lubricant.hysteresis_loss * (3.0 / 16.0);
        Film {
            along,
            entrainment,
            thickness,
            growth: -(-heating + 1.0) * 1.24 + 0.67,
            ratio,
            law,
            force: rolling / D::from(self.load),
            couple: couple / D::from(self.load * self.length),
            lever: D::from(gap.radius * 2.0 / self.length - 1.0),
        }
    }
}

impl<P: Scalar> Gap<P> {
    /// Force that presses the oil through the inlet, without heating \[N\] (Y16).
    ///
    /// Source: Biboulet and Houpert (2010), part 2, point contacts from rigid to elastic.
    fn rolling_force<D: Over<P>>(&self, log_rate: D, weight: D, semi_axis: D) -> D {
        // U₂ = 2 η u/(E' R_x)                                             (Y17)
        let log = log_rate + std::f64::consts::LN_2;
        let root = (log * 0.75).exp();
        let elastic = weight * self.elastic / root;
        // F_R = c_R φ_s φ_T E' R_x² (2a/R_x) [(0.77 B^{−1/3} k^0.12 U₂^{−1/12} − c)/(1 + M/6.6) + c] U₂^{3/4}  (Y16)
        let rigid = (log * (-1.0 / 12.0)).exp() * self.rigid;
        let both = (rigid - self.flat) / (elastic * 6.6_f64.recip() + 1.0) + self.flat;
        semi_axis * both * root * self.rolling
    }
}

/// What ball and race do to each other besides the normal load; scaled as the point is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rub<D> {
    pub(crate) film: Film<D>,
    /// Friction and rolling resistance on the ball.
    pub(crate) wrench: Wrench<D>,
    /// Power over `$W$` that sliding takes, with the derivatives of constants only, and rolling.
    pub(crate) sliding: D,
    pub(crate) rolling: D,
}

impl<P: Scalar> Wetted<P> {
    /// Friction and rolling resistance at nut (0) or screw (1).
    ///
    /// * `motion`: relative to the race.
    pub(crate) fn rub<D: Lanes<P>>(
        &self,
        i: usize,
        (pair, loaded): (&ElasticBall<P>, &Loaded<D>),
        motion: &Motion<D>,
        creep: f64,
        nodes: Nodes<'_>,
    ) -> Rub<D> {
        let (contact, load) = (&loaded.contacts[i], loaded.loads[i]);
        let rub = self.rub_of(i, (pair, loaded), motion, creep, D::from(0.0));
        let local = Local::of(motion, contact, D::from(pair.arc));
        let law = &rub.film.law;
        let (unit, power) = D::oiled(&pair.ellipse(i, loaded), &local, law, creep, nodes);
        let Wrench { force, moment } = unit.wrench(contact);
        let wrench = Wrench {
            force: force.map(|x| pair.signed(x * load)) + rub.wrench.force,
            moment: moment.map(|x| pair.signed(x * load)) + rub.wrench.moment,
        };
        Rub { wrench, sliding: pair.signed(power * load), ..rub }
    }

    /// The same with one coefficient for all points, at the mean of pressure and slip that the load
    /// sees (Y23), and without the wrench of friction.
    ///
    /// * `unit`: power over `$W$` of a coefficient of one.
    pub(crate) fn rub_at_once<D: Over<P>>(
        &self,
        i: usize,
        of: (&ElasticBall<P>, &Loaded<D>),
        motion: &Motion<D>,
        creep: f64,
        unit: D,
    ) -> Rub<D> {
        let rub = self.rub_of(i, of, motion, creep, unit);
        // μ = μ(¾ p_max, ∫|v| dQ/Q)                                       (Y23)
        let slip = of.0.signed(unit / of.1.loads[i]);
        let mean = rub.film.law.coefficient(D::from(0.75), slip);
        Rub { sliding: mean * unit, ..rub }
    }

    /// Film and rolling resistance, without the wrench of friction.
    ///
    /// * `sliding`: power over `$W$` that sliding takes.
    pub(crate) fn rub_of<D: Over<P>>(
        &self,
        i: usize,
        (pair, loaded): (&ElasticBall<P>, &Loaded<D>),
        motion: &Motion<D>,
        creep: f64,
        sliding: D,
    ) -> Rub<D> {
        let (contact, load) = (&loaded.contacts[i], loaded.loads[i]);
        let film = self.film(i, (contact, load), motion, &loaded.frame, (pair.arc, creep));
        let resistance = film.resistance(contact, motion, creep);
        let Wrench { force, moment } = resistance.wrench(contact);
        Rub {
            film,
            wrench: Wrench {
                force: force.map(|x| pair.signed(x)),
                moment: moment.map(|x| pair.signed(x)),
            },
            sliding,
            rolling: pair.signed(resistance.power(contact, motion, D::from(pair.arc))),
        }
    }
}

/// Mean speed of both surfaces along the track, as the contact sees them (Y14).
///
/// * `motion`: relative to the race.
fn entrainment<D: Scalar>(
    contact: &Contact<D>,
    motion: &Motion<D>,
    frame: &BallFrame<D>,
    arc: D,
) -> D {
    let point = contact.point(D::from(1.0));
    let ball = (motion.omega - frame.k * motion.precession).cross(&point).x;
    let race = motion.precession * (arc + frame.k.cross(&point).x);
    // u_t = ½ {[(ω − P k) × r]·t − (P − Ω_i)[d + (k × r)·t]}              (Y14)
    (ball - race) * 0.5
}

/// What rolling costs at a contact: a force at its centre, and a couple.
pub(crate) struct Resistance<D> {
    force: Vector3<D>,
    couple: Vector3<D>,
}

impl<D: Scalar> Film<D> {
    /// Rolling resistance on the ball.
    ///
    /// * `motion`: relative to the race.
    pub(crate) fn resistance(
        &self,
        contact: &Contact<D>,
        motion: &Motion<D>,
        creep: f64,
    ) -> Resistance<D> {
        let [push, couple] = self.resist(motion.omega.dot(&contact.across), creep);
        Resistance { force: BallFrame::tangent() * push, couple: contact.across * couple }
    }

    /// Its force along `$t$` at the centre of the contact, and its couple about `$t \times N$`.
    ///
    /// * `across`: angular velocity about `$t \times N$`, relative to the race.
    #[expect(
        clippy::inline_always,
        reason = "code takes the instruction set of its caller only inline"
    )]
    #[inline(always)]
    pub(crate) fn resist(&self, across: D, creep: f64) -> [D; 2] {
        // F_h = (2 R_x/r_b − 1) F_R (u_t/u) t                             (Y19)
        let push = self.lever * self.force * self.along / self.entrainment;
        // C_h = −C ω_x/√(ω_x² + (v_e/r_b)²) e_x                           (Y20)
        let twist = self.couple * across / (across.square() + creep * creep).sqrt();
        [push, -twist]
    }
}

impl<D: Scalar> Resistance<D> {
    /// As a wrench about the ball centre.
    pub(crate) fn wrench(&self, contact: &Contact<D>) -> Wrench<D> {
        let moment = contact.point(D::from(1.0)).cross(&self.force) + self.couple;
        Wrench { force: self.force, moment }
    }

    /// Power that it takes.
    pub(crate) fn power(&self, contact: &Contact<D>, motion: &Motion<D>, arc: D) -> D {
        let slip = motion.slip_velocity(arc, &contact.point(D::from(1.0)));
        // P_r = −F_h·v_c − C_h·(ω − Ω_i k)                                (Y21)
        -self.force.dot(&slip) - self.couple.dot(&motion.omega)
    }
}
