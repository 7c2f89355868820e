//! A ball between elastic raceways, vectorized over the points of a block: dimensionless
//! quantities, and outputs for the contacts.

use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::lanes::{BallContacts, ElasticMotion, LoadedContact, ScaledSize};
use bsm_dyn::{SteadyState, lubrication::FilmState, model::ErrorBound, solution::Transmission};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::inputs::{Lane, LaneInputs};
use crate::kernel::Sink;
use crate::units::{Units, modulus};

/// Ball and contacts at each point of a block. Quantities are nondimensionalized with the ball
/// radius, the axial load per ball and the relative speed.
pub(super) type Contacts<S> = BallContacts<Lane<S>>;

/// A loaded contact at each point of a block, in the same units as [`Contacts`].
pub(super) type LaneContact<S> = LoadedContact<Lane<S>>;

/// Function object that reads the inputs of a block of points in SI units and converts them to
/// dimensionless quantities. It is compiled as a separate function because three kernels share it.
///
/// A closure cannot replace this type, because closures are called through a function that is
/// compiled for another instruction set.
pub(super) struct UnitsCall<'a, 'b, S>(pub(super) &'a LaneInputs<'b, S>);

impl<S: Simd> NullaryFnOnce for UnitsCall<'_, '_, S> {
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

/// Contact-angle outputs. They are calculated only on request, because each angle requires an
/// arctangent.
const ANGLES: [SolutionOutput; 2] =
    [SolutionOutput::nut_contact_angle_deg, SolutionOutput::screw_contact_angle_deg];

/// Function object that stores the results of a ball with two elastic contacts. It is compiled as a
/// separate function because three kernels share it.
pub(super) struct ElasticResults<'a, 'b, 'c, S: Simd> {
    pub(super) out: &'a mut Sink<'b, 'c>,
    pub(super) units: &'a Units<S>,
    pub(super) contacts: &'a Contacts<S>,
    pub(super) sides: &'a [LaneContact<S>; 2],
    pub(super) motion: ElasticMotion<Lane<S>>,
    pub(super) transmission: &'a Transmission<Lane<S>>,
    pub(super) error: Option<ErrorBound<Lane<S>>>,
    pub(super) film: Option<FilmState<Lane<S>>>,
}

impl<S: Simd> NullaryFnOnce for ElasticResults<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { out, units, contacts, sides, motion, .. } = self;
        let mut angles = [contacts.constant(f64::NAN); 2];
        if out.wants(&ANGLES) {
            for (angle, side) in angles.iter_mut().zip(sides) {
                *angle = side.sin.zip(side.cos, f64::atan2);
            }
        }
        let displacement = contacts.displacement(sides);
        let ball =
            motion.state(&contacts.scaled, (angles, sides), displacement, &units.result_units());
        out.store(&SteadyState {
            error: self.error,
            film: self.film,
            ..SteadyState::new(&ball, *self.transmission)
        });
    }
}
