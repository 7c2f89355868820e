//! Friction of lubricated balls, vectorized over the points of a block, Eqs (Y1) to (Y31). The
//! friction is calculated locally at every point of a contact, or with one friction coefficient per
//! contact.

use bsm_case::InputKey;
use bsm_dyn::lanes::{BallOrbit, EhlPoint, EhlUnits, FilmLoss, LubricatedScrew, ScaledFilm};
use bsm_dyn::{
    hertz::Hertz,
    lubrication::{FilmState, Lubricant, OutsidePower, Temperature, ZERO_CELSIUS},
    model::{RacewayControl, RacewayFriction},
};
use bsm_simd::Simd;

use super::friction::Ellipse;
use super::{RollingMotion, RollingRoot};
use crate::contacts::Contacts;
use crate::inputs::{Lane, LaneInputs, Mask};
use crate::units::{Units, modulus};

/// Friction losses of lubricated rolling balls.
pub(super) struct OilLane<S: Simd> {
    ehl: EhlPoint<Lane<S>>,
    /// Losses in the lubricant films at nut and screw.
    losses: [FilmLoss<Lane<S>>; 2],
    /// Losses outside the contacts, as the sum over all balls \[W\].
    pub(super) outside: OutsidePower<Lane<S>>,
    /// Mask of the points at which the quadrature is fine enough for the losses.
    pub(super) resolved: Mask<S>,
}

impl<S: Simd> OilLane<S> {
    /// Calculates the friction losses of lubricated balls. Returns `None` if the friction
    /// coefficient is constant.
    #[inline(always)]
    pub(super) fn of(
        given: &LaneInputs<'_, S>,
        (units, contacts): (&Units<S>, &Contacts<S>),
        (state, motion): (&RollingRoot<S>, &RollingMotion<S>),
        [nut, screw]: [&Ellipse<S>; 2],
    ) -> Option<Self> {
        let (one, friction) = given.columns.lubricant.as_ref()?;
        let kelvin = given.get(InputKey::lubricant_temperature_C) + ZERO_CELSIUS;
        let splat = one.map(
            #[inline(always)]
            |x| kelvin.constant(x),
        );
        let lubricant = Lubricant { temperature: Temperature::Known(kelvin), ..splat };
        let (ball, speed) = (units.ball, units.speed.abs());
        let (per_ball, growth) = (ball.recip(), units.load.cbrt_positive().recip() * ball);
        let pressed = &contacts.pressed;
        let curvatures =
            [pressed[0].curvatures.times(per_ball), pressed[1].curvatures.times(per_ball)];
        let hertz = [
            Hertz { semi_axis: pressed[0].hertz.semi_axis * growth, ..pressed[0].hertz },
            Hertz { semi_axis: pressed[1].hertz.semi_axis * growth, ..pressed[1].hertz },
        ];
        let modulus = modulus(given, units) * units.load / (ball * ball);
        let scale = EhlUnits { load: units.load, speed: ball * speed, length: ball };
        let ehl = EhlPoint::of(&lubricant, kelvin, (&curvatures, &hertz), modulus, scale);
        // The components k·(t × N) of the screw axis follow from contact angle and lead angle.
        let (cos_lead, arc) = (contacts.scaled.lead.1, contacts.scaled.arc);
        let [k_nut, k_screw] = [state.sides[0].cos * cos_lead, -(state.sides[1].cos * cos_lead)];
        let films = [film(&ehl, 0, (k_nut, arc), nut), film(&ehl, 1, (k_screw, arc), screw)];
        let (slip, sliding, resolved) = match friction {
            RacewayFriction::PerContact => {
                let ((slip_a, at_nut), (slip_b, at_screw)) = (nut.power(), screw.power());
                let [mean_a, mean_b] =
                    [films[0].mean_friction(slip_a), films[1].mean_friction(slip_b)];
                ([slip_a, slip_b], [mean_a * slip_a, mean_b * slip_b], at_nut & at_screw)
            }
            RacewayFriction::Local => {
                let laws = [&films[0].law, &films[1].law];
                let [sliding, slip] =
                    Ellipse::lubricated_powers(given.simd, [nut, screw], laws, state.is_first_root);
                (slip, sliding, state.is_first_root)
            }
        };
        let losses = [
            loss(films[0], nut, (sliding[0], slip[0]), ball),
            loss(films[1], screw, (sliding[1], slip[1]), ball),
        ];
        let across = motion.omega[2] - motion.p * contacts.scaled.lead.1;
        let sliding_speed = (motion.omega[1] * motion.omega[1] + across * across).sqrt();
        let circling = BallOrbit {
            sliding_speed: sliding_speed * speed,
            rate: motion.p.abs() * speed,
            relative_speed: speed,
            radius: ball,
            mass: units.mass * units.load / (ball * speed * speed),
            pitch_radius: units.pitch,
            arc: contacts.scaled.arc * ball,
            balls: given.get(InputKey::loaded_balls),
        };
        let outside = lubricant.losses.power(&circling, lubricant.oil.density);
        Some(Self { ehl, losses, outside, resolved })
    }

    /// Returns the friction coefficient for a lubricant that reaches its limiting shear stress
    /// everywhere in the contact. The result is the larger of the values for nut and screw.
    #[inline(always)]
    pub(super) fn friction_scale(&self) -> Lane<S> {
        self.losses[0].film.law.max_friction().max(self.losses[1].film.law.max_friction())
    }

    /// Returns the sum of all losses in both contacts.
    #[inline(always)]
    pub(super) fn loss(&self) -> Lane<S> {
        let [nut, screw] = &self.losses;
        nut.sliding + nut.rolling + screw.sliding + screw.rolling
    }

    /// Returns film thicknesses, losses and other film results in SI units.
    #[inline(always)]
    pub(super) fn state(&self, screw: LubricatedScrew<Lane<S>>) -> FilmState<Lane<S>> {
        self.ehl.state(&self.losses, screw)
    }
}

/// Returns the lubricant film, at the nut for index 0 or at the screw for index 1.
///
/// * `k_c`: component of the screw axis along `$t \times N$`, `$k \cdot (t \times N)$`.
/// * `arc`: arc length of the helix per radian, divided by `$r_b$`.
#[inline(always)]
fn film<S: Simd>(
    ehl: &EhlPoint<Lane<S>>,
    i: usize,
    (k_c, arc): (Lane<S>, Lane<S>),
    Ellipse { load, speed, omega: [_, _, around], .. }: &Ellipse<S>,
) -> ScaledFilm<Lane<S>> {
    ehl.of_motion(i, *load, [*speed / arc, *speed, *around], k_c, RacewayControl::CREEP)
}

/// Returns the losses in the lubricant film of one contact.
///
/// * `sliding`: sliding power with the lubricant film, divided by `$Q$`; `slip`: sliding power with
///   a friction coefficient of one, divided by `$Q$`.
/// * `ball`: ball radius \[m\].
#[inline(always)]
fn loss<S: Simd>(
    film: ScaledFilm<Lane<S>>,
    Ellipse { load, semi_axes: (a, b), speed, omega: [_, _, around], .. }: &Ellipse<S>,
    (sliding, slip): (Lane<S>, Lane<S>),
    ball: Lane<S>,
) -> FilmLoss<Lane<S>> {
    let resistance = film.rolling_resistance(*around, RacewayControl::CREEP);
    FilmLoss {
        sliding: sliding * *load,
        unit: slip * *load,
        rolling: ScaledFilm::rolling_resistance_power(resistance, *speed, *around),
        semi_axes: (*a * ball, *b * ball),
        min_to_central_ratio: slip.constant(f64::NAN),
        load_parameter: slip.constant(f64::NAN),
        film,
    }
}
