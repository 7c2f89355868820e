//! Oil film between ball and raceway, asperity load share, and rolling resistance.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y6) to (Y9), (Y14) to (Y20).

use std::array::from_fn;
use std::f64::consts::PI;

use bsm_kin::{BallFrame, Motion, Over, Real, RealOver, Scalar};
use nalgebra::Vector3;

use super::elastic_ball::{BallLoads, ElasticContacts, ElasticPoint, to_both};
use super::state::{ControllingRaceway, SkidNumbers, SolveInfo};
use crate::contact::{
    ContactFilm, Curvatures, FilmState, Hertz, LoadedFilm, Lubricant, MixedFriction, OilFriction,
    OilState, OutsidePower, Roughness, Wrench,
};
use crate::ellipse::{Integrate, Placement, Rules, lubricated_friction};
use crate::outcome::SolveFailure;

/// Magnitude of the load exponent in the film thickness formula (Y7) (dimensionless).
pub(crate) const FILM_LOAD_EXPONENT: f64 = 0.067;

/// Constants of one lubricated contact in SI units, independent of load and speed. Storing these
/// constants avoids repeated evaluation of powers.
#[derive(Debug, Clone, Copy)]
struct FilmConstants<P> {
    /// Radius along the track `$R_x = 1/\rho_t$`.
    radius: P,
    /// Ratio `$b/a$` of the semi-axis along the groove to the semi-axis across the groove.
    flatness: P,
    /// Semi-axis across the groove divided by the cube root of the load.
    semi_axis: P,
    /// Combined roughness of both surfaces.
    roughness: P,
    /// Factor that converts speed to dimensionless speed `$U$` (Y6).
    speed_factor: P,
    /// Factor that converts load to dimensionless load `$W$` (Y6).
    load_factor: P,
    /// Ratio of `$L^{0.62}$` in (Y8) to `$U^{1.24}$`.
    heating_factor: P,
    /// Ratio of the film thickness (Y7) to `$U^{0.67}W^{-0.067}\varphi_T$`.
    film_factor: P,
    /// Ratio of the load parameter `$M$` (Y17) to `$W\,U_2^{-3/4}$`.
    load_parameter_factor: P,
    /// Coefficient of `$U_2^{-1/12}$` in (Y16).
    rigid_coefficient: P,
    /// Constant `$c$` of (Y16).
    constant_c: P,
    /// Ratio of the rolling force (Y16) to the product of the semi-axis, the term in brackets in
    /// (Y16), `$\varphi_T$` and `$U_2^{3/4}$`.
    rolling_factor: P,
}

/// Lubrication data of an operating point, from which film thickness, friction and rolling
/// resistance are calculated for scaled loads and speeds.
#[derive(Debug, Clone, Copy)]
pub struct EhlPoint<P = f64> {
    lubricant: Lubricant<P>,
    /// Oil properties at the oil temperature.
    pub oil: OilState<P>,
    constants: [FilmConstants<P>; 2],
    pub(crate) units: EhlUnits<P>,
}

/// Factors that convert scaled lubrication quantities to SI units.
#[derive(Debug, Clone, Copy)]
pub struct EhlUnits<P = f64> {
    /// Unit of force: axial load per ball `$F_a$`.
    pub load: P,
    /// Unit of speed: `$r_b |W|$`.
    pub speed: P,
    /// Unit of length: ball radius `$r_b$`.
    pub length: P,
}

/// An oil film with its friction law and rolling resistance, in scaled units.
#[derive(Debug, Clone, Copy)]
pub struct ScaledFilm<D> {
    /// Signed entrainment speed along the track.
    pub rolling_speed: D,
    /// Magnitude of the entrainment speed, including the creep speed (Y14).
    pub entrainment: D,
    /// Thickness of the oil film \[m\].
    pub thickness: D,
    /// Film ratio: film thickness divided by combined roughness.
    pub ratio: D,
    /// Local friction law of the contact.
    pub law: MixedFriction<D>,
    /// Rolling force of the oil `$F_R$` (Y16).
    pub(crate) force: D,
    /// Couple (pure moment) of the rolling resistance `$C$` (Y18).
    pub couple: D,
    /// Lever arm `$2 R_x/r_b - 1$` of (Y19).
    lever: D,
}

impl<P: Real> EhlPoint<P> {
    /// Creates the lubrication data for the contacts at the nut and the screw.
    ///
    /// * `kelvin`: temperature of the oil \[K\].
    /// * `curvatures`: relative curvatures at the nut and the screw \[1/m\].
    /// * `hertz`: Hertz contacts at the nut and the screw, for loads in N.
    /// * `modulus`: contact modulus `$E^*$` \[Pa\].
    #[inline(always)]
    pub fn of(
        lubricant: &Lubricant<P>,
        kelvin: P,
        (curvatures, hertz): (&[Curvatures<P>; 2], &[Hertz<P>; 2]),
        modulus: P,
        units: EhlUnits<P>,
    ) -> Self {
        let oil = lubricant.oil.at(kelvin);
        let Roughness { nut, screw, .. } = lubricant.roughness;
        let material = (lubricant, &oil, modulus * 2.0);
        let constants = [
            FilmConstants::of(material, &curvatures[0], &hertz[0], nut),
            FilmConstants::of(material, &curvatures[1], &hertz[1], screw),
        ];
        Self { lubricant: *lubricant, oil, constants, units }
    }

    /// Calculates the oil film for a load and a motion in contact coordinates.
    ///
    /// * `i`: index of the contact: 0 for the nut, 1 for the screw.
    /// * `[rate, speed, around]`: precession rate, speed of the ball center along `$t$` and angular
    ///   velocity about `$t \times N$`, relative to the raceway.
    /// * `k_c`: component `$k \cdot (t \times N)$` of the screw axis.
    #[inline(always)]
    pub fn of_motion<D: RealOver<P>>(
        &self,
        i: usize,
        load: D,
        [rate, speed, around]: [D; 3],
        k_c: D,
        creep: f64,
    ) -> ScaledFilm<D> {
        let (Self { lubricant, oil, units, .. }, constants) = (self, &self.constants[i]);
        // u_t = ½ [ω_c − P (d + 2 k_c)]                                   (Y14)
        let along = (around - speed) * 0.5 - rate * k_c;
        // u = √(u_t² + v_e²)                                              (Y14)
        let entrainment = (along.square() + creep * creep).sqrt();
        let (speed, force) = (entrainment * units.speed, load * units.load);
        let zero = load.constant(0.0);
        // U = η u/(E' R_x),  W = Q/(E' R_x²)                              (Y6)
        let (log_rate, weight) =
            ((speed * constants.speed_factor).ln(), force * constants.load_factor);
        // φ_T = 1/(1 + 0.254 L^0.62)                                      (Y8)
        let heat = (log_rate * (2.0 * 0.62)).exp() * constants.heating_factor;
        let heating = (heat * 0.254 + 1.0).recip();
        // h ~ U^0.67 W^−0.067 φ_T                                         (Y7)
        let thickness = (log_rate * 0.67 - weight.ln() * FILM_LOAD_EXPONENT).exp()
            * constants.film_factor
            * heating;
        // λ = h/√(R_q,ball² + R_q,raceway²),  ξ = e^{−1.4λ}               (Y9)
        let ratio = thickness * constants.roughness.recip();
        let share = (ratio * -1.4).exp();
        let semi_axis = force.cbrt() * constants.semi_axis;
        let short = semi_axis * constants.flatness;
        let max_pressure = force * 1.5 / (semi_axis * short * PI);
        let law = MixedFriction::of(
            &OilFriction {
                state: oil,
                limiting_shear: lubricant.oil.limiting_shear,
                boundary: lubricant.boundary_friction,
            },
            &LoadedFilm { thickness, asperity_share: share, max_pressure },
            units.speed,
        );
        let rolling = constants.rolling_force(log_rate, weight, semi_axis) * heating;
        // C = 2 F_R R_x + (3/16) c_h Q b                                  (Y18)
        let couple = rolling * constants.radius * 2.0
            + force * short * lubricant.hysteresis_loss * (3.0 / 16.0);
        ScaledFilm {
            rolling_speed: along,
            entrainment,
            thickness,
            ratio,
            law,
            force: rolling * units.load.recip(),
            couple: couple * (units.load * units.length).recip(),
            lever: zero + (constants.radius * 2.0 / units.length - 1.0),
        }
    }
}

/// A lubricated contact with its power losses. All quantities except the semi-axes are in scaled
/// units.
#[derive(Debug, Clone, Copy)]
pub struct FilmLoss<F = f64> {
    /// Oil film of the contact.
    pub film: ScaledFilm<F>,
    /// Sliding power in the contact.
    pub sliding: F,
    /// Power that sliding would dissipate with a friction coefficient of one.
    pub unit: F,
    /// Power dissipated by rolling resistance.
    pub rolling: F,
    /// Semi-axes across and along the groove \[m\].
    pub semi_axes: (F, F),
    /// Ratio of minimum to central film thickness (Y36), NaN if it was not requested.
    pub min_to_central_ratio: F,
    /// Load parameter `$M$` (Y17), NaN if it was not requested.
    pub load_parameter: F,
}

impl<F: Real> FilmLoss<F> {
    #[inline(always)]
    fn film(&self, units: &EhlUnits<F>) -> ContactFilm<F> {
        let Self { film, sliding, unit, min_to_central_ratio, load_parameter, .. } = *self;
        ContactFilm {
            thickness: film.thickness,
            ratio: film.ratio,
            min_ratio: film.ratio * min_to_central_ratio,
            asperity_share: film.law.asperity_share,
            // μ_c = P_s/P_s(1)                                            (Y22)
            friction: sliding / unit,
            rolling_moment: film.couple * units.load * units.length,
            entrainment: film.entrainment * units.speed,
            load_parameter,
            law: film.law.in_unit(units.speed),
        }
    }
}

/// Quantities of a lubricated screw that the state of its oil films depends on.
#[derive(Debug, Clone, Copy)]
pub struct LubricatedScrew<F: Real> {
    /// Unit of power for all balls \[W\].
    pub power_unit: F,
    /// Number of balls.
    pub balls: F,
    /// Power losses outside the contacts \[W\].
    pub outside: OutsidePower<F>,
    /// True if the load back-drives the screw.
    pub back: F::Mask,
    /// Tangent of the lead angle.
    pub tan_a: F,
    /// Efficiency of the screw.
    pub efficiency: F,
}

impl<F: Real> EhlPoint<F> {
    /// Returns the state of the oil films at the nut and the screw with the power losses of all
    /// balls, in SI units.
    ///
    /// * `losses`: oil films and power losses of the contacts at the nut and the screw.
    #[inline(always)]
    pub fn state(&self, losses: &[FilmLoss<F>; 2], of: LubricatedScrew<F>) -> FilmState<F> {
        let LubricatedScrew { power_unit: unit, balls, outside, back, tan_a, efficiency } = of;
        let [nut, screw] = losses;
        let sliding_power = (nut.sliding + screw.sliding) * unit;
        let rolling_power = (nut.rolling + screw.rolling) * unit;
        let conductivity = self.lubricant.oil.base.conductivity();
        let films = [nut.film(&self.units), screw.film(&self.units)];
        let mut heating = unit.constant(0.0);
        for (loss, film) in losses.iter().zip(&films) {
            let (power, motion) = (loss.sliding * unit / balls, (film.thickness, film.entrainment));
            heating = heating.larger(film_heating(power, loss.semi_axes, motion, conductivity));
        }
        FilmState {
            temperature: self.oil.temperature,
            viscosity: self.oil.viscosity,
            pressure_viscosity: self.oil.pressure_viscosity,
            nut: films[0],
            screw: films[1],
            sliding_power,
            rolling_power,
            outside,
            heating,
            equivalent_friction: equivalent_friction(
                sliding_power + rolling_power,
                (nut.unit + screw.unit) * unit,
            ),
            catalog_friction: catalog_friction(back, tan_a, efficiency),
        }
    }
}

/// Returns the temperature rise of the film due to sliding \[K\] (Y29).
///
/// * `power`: sliding power \[W\].
/// * `semi_axes`, `thickness`: semi-axes and film thickness \[m\].
/// * `entrainment`: entrainment speed \[m/s\].
/// * `conductivity`: thermal conductivity of the oil \[W/(m·K)\].
#[inline(always)]
fn film_heating<F: Real>(
    power: F,
    (a, b): (F, F),
    (thickness, entrainment): (F, F),
    conductivity: f64,
) -> F {
    /// Product of thermal conductivity, density and specific heat capacity of steel in SI units.
    const STEEL: f64 = 46.0 * 7800.0 * 460.0;
    // ΔT = q h/(8 k) + 0.53 q √(b/(u k_s ρ_s c_s)),  q = P_s/(π a b)       (Y29)
    let heat = power / (a * std::f64::consts::PI * b);
    heat * thickness * (8.0 * conductivity).recip()
        + heat * (b / (entrainment * STEEL)).sqrt() * 0.53
}

/// Returns the constant friction coefficient with which both contacts together would have the same
/// power loss as with the lubricant (Y30).
///
/// * `power`: sum of sliding and rolling power.
/// * `unit_power`: sliding power that would result with a friction coefficient of one.
#[inline(always)]
fn equivalent_friction<F: Real>(power: F, unit_power: F) -> F {
    // f_eq = (P_s + P_r)/Σ P_s(1)                                         (Y30)
    power / unit_power
}

/// Returns the friction coefficient of a plain thread that has the same efficiency as the ball
/// screw (Y31).
///
/// * `back`: mask that is true if the load back-drives the screw.
/// * `tan`: tangent of the lead angle.
#[inline(always)]
fn catalog_friction<F: Real>(back: F::Mask, tan: F, efficiency: F) -> F {
    // η = (1 − μ tanα)/(1 + μ/tanα),  back-driving (1 − μ/tanα)/(1 + μ tanα)  (Y31)
    let cot = tan.recip();
    let (with, against) = (F::select(back, tan, cot), F::select(back, cot, tan));
    (-efficiency + 1.0) / (efficiency * with + against)
}

impl EhlPoint {
    /// Returns the dimensionless load parameter `$M$` at the nut (0) or the screw (1) (Y17).
    ///
    /// * `load`: normal load in scaled units.
    pub(crate) fn load_parameter(&self, i: usize, load: f64, film: &ScaledFilm<f64>) -> f64 {
        let constants = &self.constants[i];
        let root = (2.0 * film.entrainment * self.units.speed * constants.speed_factor).powf(0.75);
        constants.load_parameter(root, load * self.units.load * constants.load_factor)
    }

    /// Returns the ratio of minimum to central film thickness at the nut (0) or the screw (1)
    /// (Y36).
    ///
    /// * `load`: normal load in scaled units.
    ///
    /// Source: Hamrock and Dowson (1977).
    pub(crate) fn min_to_central_ratio(&self, i: usize, load: f64, film: &ScaledFilm<f64>) -> f64 {
        let constants = &self.constants[i];
        let rate = film.entrainment * self.units.speed * constants.speed_factor;
        let weight = load * self.units.load * constants.load_factor;
        let stiffening =
            self.oil.pressure_viscosity / (constants.load_factor * constants.radius.powi(2));
        let edge = 1.0 - (-0.68 / constants.flatness).exp();
        let middle = 1.0 - 0.61 * (-0.73 / constants.flatness).exp();
        // h_min/h = (3.63/2.69) U^0.01 G^−0.04 W^−0.006 (1 − e^{−0.68κ})/(1 − 0.61 e^{−0.73κ})  (Y36)
        3.63 / 2.69 * rate.powf(0.01) * stiffening.powf(-0.04) * weight.powf(-0.006) * edge / middle
    }
}

impl<P: Scalar> EhlPoint<P> {
    /// Creates the lubrication data of an operating point at an oil temperature \[K\].
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the inputs are invalid.
    pub(crate) fn new(
        screw: &ElasticPoint<P>,
        lubricant: &Lubricant<P>,
        temperature: P,
    ) -> Result<Self, SolveFailure> {
        let hertz = screw.hertz().map_err(SolveFailure::invalid)?;
        let relative = screw.point.drive.relative_speed();
        let length = screw.point.ball.radius;
        let units = EhlUnits {
            load: screw.point.load.per_ball(),
            speed: length * relative * relative.re().signum(),
            length,
        };
        let modulus = screw.material.contact_modulus();
        Ok(Self::of(lubricant, temperature, (&screw.curvatures(), &hertz), modulus, units))
    }
}

impl<P: Real> FilmConstants<P> {
    /// Creates the constants of the lubricated contact between ball and raceway.
    ///
    /// * `modulus`: reduced modulus `$E' = 2 E^*$` \[Pa\].
    /// * `raceway`: roughness of the groove surface \[m\].
    #[inline(always)]
    fn of(
        (lubricant, oil, modulus): (&Lubricant<P>, &OilState<P>, P),
        curvatures: &Curvatures<P>,
        hertz: &Hertz<P>,
        raceway: P,
    ) -> Self {
        let Hertz { flatness, semi_axis, second_integral, .. } = *hertz;
        let radius = curvatures.longitudinal.recip();
        // U = η u/(E' R_x),  G = α E',  W = Q/(E' R_x²)                   (Y6)
        let speed_factor = oil.viscosity / (modulus * radius);
        let stiffening = (oil.pressure_viscosity * modulus).powf(0.53);
        // h = 2.69 R_x U^0.67 G^0.53 W^−0.067 (1 − 0.61 e^{−0.73κ}) φ_T φ_s  (Y7)
        let shape = -(flatness.recip() * -0.73).exp() * 0.61 + 1.0;
        // B = (4/π) E(m)/(1 + ρ_x/ρ_t)                                    (Y15)
        let inlet =
            second_integral * (4.0 / PI) / (curvatures.transverse / curvatures.longitudinal + 1.0);
        let log_inlet = inlet.ln();
        // L = η β u²/k                                                    (Y8)
        let conductivity = lubricant.oil.base.conductivity();
        let heat = oil.viscosity * oil.temperature_coefficient * conductivity.recip()
            / speed_factor.square();
        Self {
            radius,
            flatness,
            semi_axis,
            roughness: (lubricant.roughness.ball.square() + raceway.square()).sqrt(),
            speed_factor,
            load_factor: (modulus * radius.square()).recip(),
            heating_factor: heat.powf(0.62),
            film_factor: radius * stiffening * shape * lubricant.film_factor * 2.69,
            // Factor B^{1/4} k of M                                       (Y17)
            load_parameter_factor: (log_inlet * 0.25).exp() * flatness,
            // Factor 0.77 B^{−1/3} k^0.12, and constant c = 1.8 B^{−1/4}  (Y16)
            rigid_coefficient: (flatness.ln() * 0.12 - log_inlet * (1.0 / 3.0)).exp() * 0.77,
            constant_c: (log_inlet * -0.25).exp() * 1.8,
            rolling_factor: radius
                * modulus
                * lubricant.rolling_factor
                * lubricant.film_factor
                * 2.0,
        }
    }

    /// Returns the dimensionless load parameter `$M$` (Y17).
    ///
    /// * `root`: power `$U_2^{3/4}$` of the dimensionless speed.
    /// * `weight`: dimensionless load `$W$`.
    #[inline(always)]
    fn load_parameter<D: RealOver<P>>(&self, root: D, weight: D) -> D {
        // M = B^{1/4} k W U₂^{−3/4}                                       (Y17)
        weight * self.load_parameter_factor / root
    }

    /// Returns the rolling force due to the oil in the inlet, without the effect of heating \[N\]
    /// (Y16).
    ///
    /// Source: Biboulet and Houpert (2010), part 2, formula for point contacts in all regimes from
    /// rigid to elastic.
    #[inline(always)]
    fn rolling_force<D: RealOver<P>>(&self, log_rate: D, weight: D, semi_axis: D) -> D {
        // U₂ = 2 η u/(E' R_x)                                             (Y17)
        let log = log_rate + std::f64::consts::LN_2;
        let root = (log * 0.75).exp();
        let elastic = self.load_parameter(root, weight);
        // F_R = c_R φ_s φ_T E' R_x² (2a/R_x) [(0.77 B^{−1/3} k^0.12 U₂^{−1/12} − c)/(1 + M/6.6) + c] U₂^{3/4}  (Y16)
        let rigid = (log * (-1.0 / 12.0)).exp() * self.rigid_coefficient;
        let both = (rigid - self.constant_c) / (elastic * 6.6_f64.recip() + 1.0) + self.constant_c;
        semi_axis * both * root * self.rolling_factor
    }
}

/// Film, friction and rolling resistance of a contact, in scaled units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EhlLoss<D> {
    pub(crate) film: ScaledFilm<D>,
    /// Wrench of friction and rolling resistance on the ball.
    pub(crate) wrench: Wrench<D>,
    /// Sliding power divided by `$W$`. It includes derivatives with respect to the inputs, but not
    /// with respect to the unknowns.
    pub(crate) sliding: D,
    /// Power of the rolling resistance divided by `$W$`.
    pub(crate) rolling: D,
}

impl<P: Scalar> EhlPoint<P> {
    /// Calculates the oil films, the friction and the rolling resistance at the nut and the screw.
    ///
    /// * `motions`: motions of the ball relative to the raceways.
    pub(crate) fn losses<D: Integrate<P>>(
        &self,
        (contacts, loaded): (&ElasticContacts<P>, &BallLoads<D>),
        motions: &[Motion<D>; 2],
        creep: f64,
        nodes: [Placement<'_>; 2],
    ) -> [EhlLoss<D>; 2] {
        let losses: [_; 2] =
            from_fn(|i| self.loss_of(i, (contacts, loaded), &motions[i], creep, D::from(0.0)));
        let patches = contacts.patches(loaded, motions, creep);
        let films = losses.each_ref().map(|loss| loss.film.thickness);
        let laws = losses.each_ref().map(|loss| &loss.film.law);
        let sums = lubricated_friction(&patches, laws, films, &nodes);
        from_fn(|i| {
            let ((unit, power), loss, load) = (&sums[i], losses[i], loaded.loads[i]);
            let wrench = unit.wrench(&loaded.contacts[i]) * contacts.signed(load) + loss.wrench;
            EhlLoss { wrench, sliding: contacts.signed(*power * load), ..loss }
        })
    }

    /// Calculates the oil film, the sliding power and the rolling resistance with a single friction
    /// coefficient for the whole contact, evaluated at the load-weighted means of pressure and slip
    /// speed (Y23). The returned wrench does not include friction.
    ///
    /// * `unit`: sliding power for a friction coefficient of one, divided by `$W$`.
    pub(crate) fn mean_loss<D: Over<P>>(
        &self,
        i: usize,
        ball: (&ElasticContacts<P>, &BallLoads<D>),
        motion: &Motion<D>,
        creep: f64,
        unit: D,
    ) -> EhlLoss<D> {
        let loss = self.loss_of(i, ball, motion, creep, unit);
        let mean = loss.film.mean_friction(ball.0.signed(unit / ball.1.loads[i]));
        EhlLoss { sliding: mean * unit, ..loss }
    }

    /// Calculates the oil film and the rolling resistance for a given sliding power. The returned
    /// wrench does not include friction.
    ///
    /// * `sliding`: sliding power divided by `$W$`.
    pub(crate) fn loss_of<D: Over<P>>(
        &self,
        i: usize,
        (contacts, loaded): (&ElasticContacts<P>, &BallLoads<D>),
        motion: &Motion<D>,
        creep: f64,
        sliding: D,
    ) -> EhlLoss<D> {
        let (film, axis, around) = self.film_at(i, (contacts, loaded), motion, creep);
        let [force, couple] = film.rolling_resistance(around, creep);
        // M = r × F_h + C_h                                               (Y32)
        let wrench =
            Wrench { force: BallFrame::tangent() * force, moment: axis * (force + couple) };
        let speed = motion.precession * D::from(contacts.scaled.arc);
        let rolling =
            contacts.signed(ScaledFilm::rolling_resistance_power([force, couple], speed, around));
        EhlLoss { film, wrench: wrench * contacts.signed(D::from(1.0)), sliding, rolling }
    }

    /// Returns the oil film at the nut (0) or the screw (1), the direction `$t \times N$`, and the
    /// angular velocity about this direction.
    fn film_at<D: Over<P>>(
        &self,
        i: usize,
        (contacts, loaded): (&ElasticContacts<P>, &BallLoads<D>),
        motion: &Motion<D>,
        creep: f64,
    ) -> (ScaledFilm<D>, Vector3<D>, D) {
        let axis = BallFrame::tangent().cross(&loaded.contacts[i].normal);
        let around = motion.omega.dot(&axis);
        let rates = [motion.precession, motion.precession * D::from(contacts.scaled.arc), around];
        let film = self.of_motion(i, loaded.loads[i], rates, loaded.frame.k.dot(&axis), creep);
        (film, axis, around)
    }
}

impl<D: Real> ScaledFilm<D> {
    /// Returns the friction coefficient of the contact at the load-weighted means of pressure and
    /// slip speed (Y23).
    ///
    /// * `slip`: load-weighted mean slip speed `$\int|v|\,dQ/Q$` in scaled units.
    #[inline(always)]
    pub fn mean_friction(&self, slip: D) -> D {
        // μ = μ(¾ p_max, ∫|v| dQ/Q)                                       (Y23)
        self.law.at(slip.constant(0.75), slip)
    }

    /// Returns the rolling resistance of the contact: its force along `$t$` at the contact center,
    /// and its couple about `$t \times N$`.
    ///
    /// * `transverse`: angular velocity about `$t \times N$` relative to the raceway.
    #[inline(always)]
    pub fn rolling_resistance(&self, transverse: D, creep: f64) -> [D; 2] {
        // F_h = (2 R_x/r_b − 1) F_R (u_t/u) t                             (Y19)
        let force = self.lever * self.force * self.rolling_speed / self.entrainment;
        // C_h = −C ω_x/√(ω_x² + (v_e/r_b)²) e_x                           (Y20)
        let twist = self.couple * transverse / (transverse.square() + creep * creep).sqrt();
        [force, -twist]
    }

    /// Returns the power that is dissipated by the rolling resistance.
    ///
    /// * `speed`, `around`: speeds as in [`EhlPoint::of_motion`].
    #[inline(always)]
    pub fn rolling_resistance_power([force, couple]: [D; 2], speed: D, around: D) -> D {
        // P_r = −F_h·v_c − C_h·(ω − Ω_i k)                                (Y21)
        -(force * (speed + around)) - couple * around
    }
}

/// Reusable buffers for solving lubricated models.
#[derive(Default)]
pub(crate) struct LubricatedWorkspace {
    pub(crate) rules: Rules,
}

/// A lubricated ball in steady motion. All quantities are in scaled units, except the torque, which
/// is in SI units.
pub(crate) struct LubricatedState<D = f64> {
    pub(crate) loaded: BallLoads<D>,
    pub(crate) to_nut: Motion<D>,
    /// Losses of the contacts at the nut and the screw.
    pub(crate) losses: [EhlLoss<D>; 2],
    /// Torque of the contacts on the screw \[N·m\].
    pub(crate) torque: D,
}

/// A steady state of a lubricated ball with its operating point and solver data.
pub(crate) struct SteadyRoot {
    pub(crate) contacts: ElasticContacts,
    pub(crate) steady: LubricatedState,
    /// Sliding powers at the nut and the screw that would result with a friction coefficient of
    /// one.
    pub(crate) unit: [f64; 2],
    pub(crate) skid: SkidNumbers,
    pub(crate) info: SolveInfo,
    pub(crate) control: Option<ControllingRaceway>,
    /// Error bound of the efficiency due to quadrature (T25); `None` if it was not estimated.
    pub(crate) error: Option<f64>,
}

impl EhlPoint {
    /// Returns the friction coefficient that would result if the oil reached its limiting shear
    /// stress everywhere in the contact. The result is the larger of the coefficients at the nut
    /// and the screw.
    pub(crate) fn friction_scale(
        &self,
        contacts: &ElasticContacts,
        loaded: &BallLoads<f64>,
        to_nut: &Motion<f64>,
        creep: f64,
    ) -> f64 {
        let motions = to_both(to_nut, &loaded.frame);
        let ball = (contacts, loaded);
        let [nut, screw] =
            [0, 1].map(|i| self.film_at(i, ball, &motions[i], creep).0.law.max_friction());
        nut.max(screw)
    }
}
