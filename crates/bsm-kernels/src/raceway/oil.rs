//! One friction coefficient from the lubricant for each contact by lanes, Eqs (Y1) to (Y31).

use bsm_case::units::{GPA, MILLI, MM, UM};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{
    BallOrbit, EhlPoint, EhlUnits, ScaledFilm, catalogue_friction, equivalent_friction,
    film_heating,
};
use bsm_dyn::{Hertz, Lubricant, OutsidePower, RacewayControl, Temperature, ZERO_CELSIUS};
use bsm_simd::Simd;

use super::balance::{Precession, RollingMotion};
use super::friction::Ellipse;
use crate::contacts::Contacts;
use crate::kernel::Sink;
use crate::operand::{Lane, LaneInputs, Mask};
use crate::units::{Units, modulus};

/// What a contact loses, over axial load per ball, ball radius and relative speed.
struct EhlLoss<S: Simd> {
    film: ScaledFilm<Lane<S>>,
    /// `$a$` and `$b$`.
    semi_axes: (Lane<S>, Lane<S>),
    /// Power of a friction coefficient of one, and the coefficient (Y23).
    unit: Lane<S>,
    friction: Lane<S>,
    /// Power of rolling resistance (Y21).
    rolling: Lane<S>,
}

/// Lubricated rolling balls.
pub(super) struct OilLane<S: Simd> {
    lubricant: Lubricant<Lane<S>>,
    ehl: EhlPoint<Lane<S>>,
    /// At nut and screw.
    losses: [EhlLoss<S>; 2],
    /// Outside the contacts, of all balls \[W\].
    pub(super) outside: OutsidePower<Lane<S>>,
}

impl<S: Simd> OilLane<S> {
    /// `None` with a friction coefficient.
    ///
    /// * `ellipses`: with the power over `$Q$` of a friction coefficient of one.
    #[inline(always)]
    pub(super) fn of(
        given: &LaneInputs<'_, S>,
        (units, contacts): (&Units<S>, &Contacts<S>),
        (state, motion): (&Precession<S>, &RollingMotion<S>),
        ellipses: [(Ellipse<S>, Lane<S>); 2],
    ) -> Option<Self> {
        let one = given.inputs.lubricant.as_ref()?;
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
        let [nut, screw] = &state.sides;
        // k·(t × N)
        let [k_nut, k_screw] =
            [nut.cos * contacts.scaled.lead.1, -(screw.cos * contacts.scaled.lead.1)];
        let losses = [
            EhlLoss::of(&ehl, 0, (k_nut, contacts), &ellipses[0]),
            EhlLoss::of(&ehl, 1, (k_screw, contacts), &ellipses[1]),
        ];
        let across = motion.omega[1] - motion.p * contacts.scaled.lead.1;
        let sliding_speed = (motion.omega[0] * motion.omega[0] + across * across).sqrt();
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
        Some(Self { lubricant, ehl, losses, outside })
    }

    /// The larger coefficient of nut and screw if the oil bore all that it can.
    #[inline(always)]
    pub(super) fn friction_scale(&self) -> Lane<S> {
        self.losses[0].film.law.most().max(self.losses[1].film.law.most())
    }

    /// Power of sliding at nut and screw.
    #[inline(always)]
    fn sliding(&self) -> [Lane<S>; 2] {
        let [nut, screw] = &self.losses;
        [nut.friction * nut.unit, screw.friction * screw.unit]
    }

    /// What both contacts lose.
    #[inline(always)]
    pub(super) fn loss(&self) -> Lane<S> {
        let [nut, screw] = self.sliding();
        nut + self.losses[0].rolling + screw + self.losses[1].rolling
    }

    #[inline(always)]
    pub(super) fn outputs(
        &self,
        out: &mut Sink<'_, '_>,
        (units, contacts): (&Units<S>, &Contacts<S>),
        (back, efficiency): (Mask<S>, Lane<S>),
    ) {
        let oil = &self.ehl.oil;
        let celsius = oil.temperature - ZERO_CELSIUS;
        let state = [celsius, oil.viscosity / MILLI, oil.pressure_viscosity * GPA];
        out.set_all(OutputKey::lubricant_temperature_C, state);
        let speed = units.ball * units.speed.abs();
        let [nut, screw] = &self.losses;
        let (at_nut, at_screw) = (&nut.film, &screw.film);
        out.set_all(OutputKey::nut_film_um, [at_nut.thickness / UM, at_screw.thickness / UM]);
        out.set_all(OutputKey::nut_film_ratio, [at_nut.ratio, at_screw.ratio]);
        out.set_all(
            OutputKey::nut_asperity_share,
            [at_nut.law.asperity_share, at_screw.law.asperity_share],
        );
        out.set_all(OutputKey::nut_friction_coefficient, [nut.friction, screw.friction]);
        let couples = [at_nut.couple * units.load, at_screw.couple * units.load];
        let moments = [couples[0] * units.ball / MM, couples[1] * units.ball / MM];
        out.set_all(OutputKey::nut_rolling_moment_Nmm, moments);
        let entrainments = [at_nut.entrainment * speed, at_screw.entrainment * speed];
        out.set_all(OutputKey::nut_entrainment_m_s, entrainments);
        let (sliding, rolling) = (self.sliding(), nut.rolling + screw.rolling);
        // Scaled powers in watts, of all balls.
        let unit = speed * units.axial;
        let OutsidePower { seal, ball_contact, ball_return, drag } = self.outside;
        let sliding_power = (sliding[0] + sliding[1]) * unit;
        let powers = [sliding_power, rolling * unit, ball_contact, ball_return, drag];
        out.set_all(OutputKey::sliding_power_W, powers);
        out.set(OutputKey::seal_power_W, seal);
        if out.wants(&[OutputKey::film_heating_K]) {
            let of_a_ball = speed * units.load;
            let conductivity = self.lubricant.oil.base.conductivity();
            let mut heating = speed.constant(0.0);
            for (loss, sliding) in self.losses.iter().zip(sliding) {
                let (a, b) = (loss.semi_axes.0 * units.ball, loss.semi_axes.1 * units.ball);
                let film = (loss.film.thickness, loss.film.entrainment * speed);
                let heats = film_heating(sliding * of_a_ball, (a, b), film, conductivity);
                heating = heating.max(heats);
            }
            out.set(OutputKey::film_heating_K, heating);
        }
        let equivalent = equivalent_friction(self.loss(), nut.unit + screw.unit);
        let catalogue =
            catalogue_friction(back, contacts.scaled.lead.0 / contacts.scaled.lead.1, efficiency);
        out.set_all(OutputKey::equivalent_friction_coefficient, [equivalent, catalogue]);
    }
}

impl<S: Simd> EhlLoss<S> {
    /// Of nut (0) or screw (1).
    ///
    /// * `k_c`: `$k \cdot (t \times N)$`. * `slip`: `$\int|v|\,dQ/Q$` over `$W$`, the power over `$Q$` of a friction
    ///   coefficient of one.
    #[inline(always)]
    fn of(
        ehl: &EhlPoint<Lane<S>>,
        i: usize,
        (k_c, contacts): (Lane<S>, &Contacts<S>),
        (ellipse, slip): &(Ellipse<S>, Lane<S>),
    ) -> Self {
        let creep = RacewayControl::CREEP;
        let [_, _, around] = ellipse.omega;
        let rate = ellipse.speed / contacts.scaled.arc;
        let film = ehl.of_motion(i, ellipse.load, [rate, ellipse.speed, around], k_c, creep);
        Self {
            semi_axes: ellipse.semi_axes,
            unit: ellipse.load * *slip,
            friction: film.mean_friction(*slip),
            rolling: ScaledFilm::resisted(film.resist(around, creep), ellipse.speed, around),
            film,
        }
    }
}
