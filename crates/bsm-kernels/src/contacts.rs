//! A ball between elastic raceways by lanes: its units, and what its contacts put out.

use bsm_case::units::{DEG, MM, MPA, UM};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{BallContacts, LoadedContact, ScaledSize, max_pressure};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::kernel::Sink;
use crate::operand::{Lane, LaneInputs};
use crate::units::{Units, modulus};

/// A lane of points in units of ball radius, axial load per ball and relative speed.
pub(super) type Contacts<S> = BallContacts<Lane<S>>;

/// A contact at its angle, in the same units.
pub(super) type LaneContact<S> = LoadedContact<Lane<S>>;

/// A lane of points in SI units and in those of its ball: a call of its own, as three kernels share it.
///
/// A type, as all such calls: a closure is called through a shim that does not take the instruction set.
pub(super) struct InUnits<'a, 'b, S>(pub(super) &'a LaneInputs<'b, S>);

impl<S: Simd> NullaryFnOnce for InUnits<'_, '_, S> {
    type Output = (Units<S>, Contacts<S>);

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
        let contacts = Contacts::new(&self.0.sines(), conformities, &size);
        (units, contacts)
    }
}

/// Stores loads, angles, ellipses, approaches and displacement: a call of its own, as three kernels share it.
pub(super) struct ContactRow<'a, 'b, 'c, S: Simd> {
    pub(super) out: &'a mut Sink<'b, 'c>,
    pub(super) units: &'a Units<S>,
    pub(super) contacts: &'a Contacts<S>,
    pub(super) sides: &'a [LaneContact<S>; 2],
}

impl<S: Simd> NullaryFnOnce for ContactRow<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { out, units, contacts, sides } = self;
        let ball = units.ball;
        let [nut, screw] = sides;
        let [q_a, q_b] = [nut.load * units.load, screw.load * units.load];
        out.set_all(OutputKey::nut_normal_load_N, [q_a, q_b]);
        if out.wants(&[OutputKey::nut_contact_angle_deg, OutputKey::screw_contact_angle_deg]) {
            let angles = [nut.sin.zip(nut.cos, f64::atan2), screw.sin.zip(screw.cos, f64::atan2)];
            out.set_all(OutputKey::nut_contact_angle_deg, [angles[0] / DEG, angles[1] / DEG]);
        }
        let (a, b) = nut.semi_axes(&contacts.pressed[0]);
        let at_nut = (a * ball, b * ball);
        let (a, b) = screw.semi_axes(&contacts.pressed[1]);
        let at_screw = (a * ball, b * ball);
        let pressures = [max_pressure(q_a, at_nut) / MPA, max_pressure(q_b, at_screw) / MPA];
        out.set_all(OutputKey::nut_max_pressure_MPa, pressures);
        out.set_all(OutputKey::nut_ellipse_a_mm, [at_nut.0 / MM, at_screw.0 / MM]);
        out.set_all(OutputKey::nut_ellipse_b_mm, [at_nut.1 / MM, at_screw.1 / MM]);
        let approaches = [nut.approach * ball / UM, screw.approach * ball / UM];
        out.set_all(OutputKey::nut_approach_um, approaches);
        out.set(OutputKey::axial_displacement_um, contacts.displacement(sides) * ball / UM);
    }
}
