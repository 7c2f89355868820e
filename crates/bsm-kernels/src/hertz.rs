//! Elliptical Hertz contacts of ball and grooves by lanes, Eqs (H1) to (H9), (E2).

use bsm_case::InputKey;
use bsm_case::units::GPA;
use bsm_dyn::{Axes, Curvatures, Groove, Hertz, Material, Member, contact_modulus, pressed_radius};
use bsm_simd::Simd;

use crate::operand::{Given, Lane, Mask};
use crate::units::Units;

/// A contact in units of ball radius and axial load per ball.
pub(super) struct ElasticContact<S: Simd> {
    /// `$l_0$` of (H2).
    pub(super) offset: Lane<S>,
    /// Radius of the pressed surface.
    pub(super) pressed_radius: Lane<S>,
    pub(super) curvatures: Curvatures<Lane<S>>,
    /// Of the axial load.
    pub(super) hertz: Hertz<Lane<S>>,
    /// Where all this holds.
    pub(super) regular: Mask<S>,
}

/// The screw that a groove belongs to.
pub(super) struct Screw<S: Simd> {
    /// `$r_m/r_b$`.
    pub(super) radius: Lane<S>,
    pub(super) tan_a: Lane<S>,
    /// Of the unloaded contact angle.
    pub(super) cos_b: Lane<S>,
    /// `$E^* r_b^2/F_a$`.
    pub(super) modulus: Lane<S>,
}

/// `$E^* r_b^2/F_a$` of the materials, those of the races unless given for the ball.
#[inline(always)]
pub(super) fn modulus<S: Simd>(given: &Given<'_, S>, units: &Units<S>) -> Lane<S> {
    let youngs_modulus = given.get(InputKey::youngs_modulus_GPa);
    let poisson_ratio = given.get(InputKey::poisson_ratio);
    let races = Material { youngs_modulus, poisson_ratio };
    let ball = Material {
        youngs_modulus: given.try_get(InputKey::ball_youngs_modulus_GPa).unwrap_or(youngs_modulus),
        poisson_ratio: given.try_get(InputKey::ball_poisson_ratio).unwrap_or(poisson_ratio),
    };
    contact_modulus(&races, &ball) * GPA * (units.ball * units.ball) / units.load
}

impl<S: Simd> ElasticContact<S> {
    #[inline(always)]
    pub(super) fn of(member: Member, conformity: Lane<S>, screw: &Screw<S>) -> Self {
        let Screw { radius, tan_a, cos_b, modulus } = *screw;
        let one = conformity.constant(1.0);
        let groove = Groove { member, conformity };
        let curvatures = groove.curvatures_at(radius, one, tan_a, cos_b);
        let target = curvatures.along / curvatures.across;
        let practice = one.le(target) & target.le(one.constant(Axes::<Lane<S>>::PRACTICE));
        Self {
            offset: groove.offset(one),
            pressed_radius: pressed_radius(conformity, one),
            hertz: Hertz::on(&Axes::in_practice(target), &curvatures, modulus),
            regular: practice & curvatures.across.gt(one.constant(0.0)),
            curvatures,
        }
    }
}
