//! A ball between elastic raceways by lanes: its units, and what its contacts put out.

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{BallContacts, LoadedContact, ScaledSize, max_pressure};
use bsm_dyn::{
    BallState, ContactState, ErrorBound, FilmState, HertzContact, Slip, Solved, Transmission,
};
use bsm_kin::{Motion, relative_rotation};
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

/// Angles, which take an arctangent each.
const ANGLES: [OutputKey; 2] =
    [OutputKey::nut_contact_angle_deg, OutputKey::screw_contact_angle_deg];

/// The answer of a ball on two elastic contacts, scaled, and a call of its own that stores it, as three kernels share
/// it.
pub(super) struct ElasticAnswer<'a, 'b, 'c, S: Simd> {
    pub(super) out: &'a mut Sink<'b, 'c>,
    pub(super) units: &'a Units<S>,
    pub(super) contacts: &'a Contacts<S>,
    pub(super) sides: &'a [LaneContact<S>; 2],
    /// Slip speeds, and spins over the relative speed.
    pub(super) slip: [Lane<S>; 2],
    pub(super) spin: [Lane<S>; 2],
    /// Directions of friction \[rad\], if they are wanted.
    pub(super) slip_angles: Option<[Lane<S>; 2]>,
    /// Over the relative speed: precession, and rotation relative to the nut.
    pub(super) rate: Lane<S>,
    pub(super) to_nut: [Lane<S>; 3],
    pub(super) transmission: &'a Transmission<Lane<S>>,
    pub(super) error: Option<ErrorBound<Lane<S>>>,
    pub(super) film: Option<FilmState<Lane<S>>>,
}

impl<S: Simd> NullaryFnOnce for ElasticAnswer<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { out, units, contacts, .. } = self;
        let (ball, w) = (units.ball, units.speed);
        let angles = out.wants(&ANGLES);
        let mut states = [ContactState::at_angle(w.constant(f64::NAN)); 2];
        for (i, state) in states.iter_mut().enumerate() {
            let side = &self.sides[i];
            if angles {
                state.angle = side.sin.zip(side.cos, f64::atan2);
            }
            if let Some(slip_angles) = &self.slip_angles {
                state.slip_angle = Some(slip_angles[i]);
            }
            let (speed, spin) = (self.slip[i] * w.abs() * ball, self.spin[i] * w);
            state.slip = Some(Slip { speed, spin });
            let load = side.load * units.load;
            state.load = Some(load);
            let (a, b) = side.semi_axes(&contacts.pressed[i]);
            let semi_axes = (a * ball, b * ball);
            let (max_pressure, approach) = (max_pressure(load, semi_axes), side.approach * ball);
            state.pressed = Some(HertzContact { semi_axes, max_pressure, approach });
        }
        let scaled = &contacts.scaled;
        let [t, n, b] = relative_rotation(self.to_nut, -scaled.nut_speed, scaled.lead);
        let ball = BallState {
            motion: Some(Motion::new(self.rate * w, [t * w, n * w, b * w])),
            nut: states[0],
            screw: states[1],
            unloaded: None,
            axial_displacement: Some(contacts.displacement(self.sides) * ball),
        };
        out.put(&Solved {
            error: self.error,
            film: self.film,
            ..Solved::new(&ball, *self.transmission)
        });
    }
}
