//! One friction coefficient from the lubricant for each contact by lanes, Eqs (Y1) to (Y31).

use bsm_case::InputKey;
use bsm_dyn::internals::{BallOrbit, EhlPoint, EhlUnits, FilmLoss, ScaledFilm};
use bsm_dyn::{
    FilmState, Hertz, Lubricant, OutsidePower, RacewayControl, Temperature, ZERO_CELSIUS,
};
use bsm_simd::Simd;

use super::balance::{BalanceRoot, RollingMotion};
use super::friction::Ellipse;
use crate::contacts::Contacts;
use crate::operand::{Lane, LaneInputs, Mask};
use crate::units::{Units, modulus};

/// Lubricated rolling balls.
pub(super) struct OilLane<S: Simd> {
    ehl: EhlPoint<Lane<S>>,
    /// At nut and screw.
    losses: [FilmLoss<Lane<S>>; 2],
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
        (state, motion): (&BalanceRoot<S>, &RollingMotion<S>),
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
            loss(&ehl, 0, (k_nut, contacts, ball), &ellipses[0]),
            loss(&ehl, 1, (k_screw, contacts, ball), &ellipses[1]),
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
        Some(Self { ehl, losses, outside })
    }

    /// The larger coefficient of nut and screw if the oil bore all that it can.
    #[inline(always)]
    pub(super) fn friction_scale(&self) -> Lane<S> {
        self.losses[0].film.law.most().max(self.losses[1].film.law.most())
    }

    /// What both contacts lose.
    #[inline(always)]
    pub(super) fn loss(&self) -> Lane<S> {
        let [nut, screw] = &self.losses;
        nut.sliding + nut.rolling + screw.sliding + screw.rolling
    }

    /// What films and losses tell.
    #[inline(always)]
    pub(super) fn state(
        &self,
        units: &Units<S>,
        balls: Lane<S>,
        of: (Mask<S>, Lane<S>, Lane<S>),
    ) -> FilmState<Lane<S>> {
        let unit = units.ball * units.speed.abs() * units.axial;
        self.ehl.state(&self.losses, (unit, balls), self.outside, of)
    }
}

/// A contact at nut (0) or screw (1).
///
/// * `k_c`: `$k \cdot (t \times N)$`. * `slip`: `$\int|v|\,dQ/Q$` over `$W$`, the power over `$Q$` of a friction
///   coefficient of one.
#[inline(always)]
fn loss<S: Simd>(
    ehl: &EhlPoint<Lane<S>>,
    i: usize,
    (k_c, contacts, ball): (Lane<S>, &Contacts<S>, Lane<S>),
    (ellipse, slip): &(Ellipse<S>, Lane<S>),
) -> FilmLoss<Lane<S>> {
    let creep = RacewayControl::CREEP;
    let ([_, _, around], (a, b)) = (ellipse.omega, ellipse.semi_axes);
    let rate = ellipse.speed / contacts.scaled.arc;
    let film = ehl.of_motion(i, ellipse.load, [rate, ellipse.speed, around], k_c, creep);
    let unit = ellipse.load * *slip;
    FilmLoss {
        sliding: film.mean_friction(*slip) * unit,
        unit,
        rolling: ScaledFilm::resisted(film.resist(around, creep), ellipse.speed, around),
        semi_axes: (a * ball, b * ball),
        inlet: [slip.constant(f64::NAN); 2],
        film,
    }
}
