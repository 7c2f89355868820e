//! A ball between elastic races by lanes: its units, and what its contacts put out.

use bsm_case::units::{DEG, MM, MPA, UM};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::{BallContacts, LoadedContact, ScaledSize, max_pressure};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::Sink;
use crate::operand::{Lane, LaneInputs};
use crate::units::{Units, modulus};

/// A lane of points in units of ball radius, axial load per ball and relative speed.
pub(super) type Balls<S> = BallContacts<Lane<S>>;

/// A contact at its angle, in the same units.
pub(super) type LaneContact<S> = LoadedContact<Lane<S>>;

/// A lane of points in SI units and in those of its ball: a call of its own, as three kernels share it.
pub(super) struct InUnits<'a, 'b, S>(pub(super) &'a LaneInputs<'b, S>);

impl<S: Simd> NullaryFnOnce for InUnits<'_, '_, S> {
    type Output = (Units<S>, Balls<S>);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let units = Units::of(self.0);
        let conformities =
            [self.0.get(InputKey::nut_conformity), self.0.get(InputKey::screw_conformity)];
        let size = ScaledSize {
            radius: units.pitch / units.ball,
            mass: units.mass,
            nut_speed: units.nut_speed / units.speed,
            modulus: modulus(self.0, &units),
        };
        let pair = Balls::new(&self.0.sines(), conformities, &size);
        (units, pair)
    }
}

/// Stores loads, angles, ellipses, approaches and displacement: a call of its own, as three kernels share it.
pub(super) struct ContactRow<'a, 'b, 'c, S: Simd> {
    pub(super) out: &'a mut Sink<'b, 'c>,
    pub(super) units: &'a Units<S>,
    pub(super) pair: &'a Balls<S>,
    pub(super) sides: &'a [LaneContact<S>; 2],
}

impl<S: Simd> NullaryFnOnce for ContactRow<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        const KEYS: [[OutputKey; 6]; 2] = [
            [
                OutputKey::nut_normal_load_N,
                OutputKey::nut_contact_angle_deg,
                OutputKey::nut_ellipse_a_mm,
                OutputKey::nut_ellipse_b_mm,
                OutputKey::nut_max_pressure_MPa,
                OutputKey::nut_approach_um,
            ],
            [
                OutputKey::screw_normal_load_N,
                OutputKey::screw_contact_angle_deg,
                OutputKey::screw_ellipse_a_mm,
                OutputKey::screw_ellipse_b_mm,
                OutputKey::screw_max_pressure_MPa,
                OutputKey::screw_approach_um,
            ],
        ];
        let Self { out, units, pair, sides } = self;
        let ball = units.ball;
        for (i, [load, angle, long, short, pressure, approach]) in KEYS.into_iter().enumerate() {
            let (side, pressed) = (&sides[i], &pair.pressed[i]);
            let q = side.load * units.load;
            out.set(load, q);
            if out.wants(&[angle]) {
                out.set(angle, side.sin.zip(side.cos, f64::atan2) / DEG);
            }
            let (a, b) = side.semi_axes(pressed);
            let (a, b) = (a * ball, b * ball);
            out.set(long, a / MM);
            out.set(short, b / MM);
            out.set(pressure, max_pressure(q, (a, b)) / MPA);
            out.set(approach, side.approach * ball / UM);
        }
        out.set(OutputKey::axial_displacement_um, pair.displacement(sides) * ball / UM);
    }
}
