//! A ball between elastic races by lanes: units, contacts and what they put out, Eqs (P1), (P2), (P6),
//! (H1) to (H10), (J8).

use bsm_case::units::{DEG, MM, MPA, UM};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::{Member, axial_displacement, max_pressure};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::Out;
use crate::hertz::{self, ElasticContact, Screw};
use crate::operand::{Given, Lane, Mask};
use crate::units::Units;

/// A lane of points in units of ball radius, axial load per ball and relative speed.
pub(super) struct Pair<S: Simd> {
    pub(super) sin_a: Lane<S>,
    pub(super) cos_a: Lane<S>,
    /// Of the unloaded contact angle.
    pub(super) sin_b: Lane<S>,
    pub(super) cos_b: Lane<S>,
    /// `$d/r_b$`, and its inverse times `$\cos\alpha$`.
    pub(super) arc: Lane<S>,
    pub(super) lever: Lane<S>,
    /// `$m r_m W^2/F_a$`.
    pub(super) inertia_ratio: Lane<S>,
    /// `$\Omega_n/W$`.
    pub(super) nut_speed: Lane<S>,
    /// Contacts at nut and screw.
    pub(super) pressed: [ElasticContact<S>; 2],
    /// Where numbers neither overflow nor underflow and contacts are ellipses.
    pub(super) regular: Mask<S>,
}

/// A contact at its angle, in the same units.
#[derive(Clone, Copy)]
pub(super) struct Side<S: Simd> {
    pub(super) cot: Lane<S>,
    pub(super) sin: Lane<S>,
    pub(super) cos: Lane<S>,
    /// `$Q/F_a$`, and its cube root.
    pub(super) load: Lane<S>,
    pub(super) growth: Lane<S>,
    pub(super) approach: Lane<S>,
    /// `$l$`, from the arc centre to the ball centre.
    pub(super) length: Lane<S>,
}

/// A lane of points in SI units and in those of its ball: a call of its own, as three kernels share it.
pub(super) struct InUnits<'a, 'b, S>(pub(super) &'a Given<'b, S>);

impl<S: Simd> NullaryFnOnce for InUnits<'_, '_, S> {
    type Output = (Units<S>, Pair<S>);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let units = Units::of(self.0);
        let pair = Pair::of(self.0, &units);
        (units, pair)
    }
}

impl<S: Simd> Pair<S> {
    #[inline(always)]
    fn of(given: &Given<'_, S>, units: &Units<S>) -> Self {
        let (sin_a, cos_a) = given.lead();
        let (sin_b, cos_b) = given.sin_cos(InputKey::contact_angle_deg);
        // Lengths in r_b, forces in F_a, speeds in W                      (P1)
        let radius = units.pitch / units.ball;
        let arc = radius / cos_a;
        let modulus = hertz::modulus(given, units);
        let screw = Screw { radius, tan_a: sin_a / cos_a, cos_b, modulus };
        let pressed = [
            ElasticContact::of(Member::Nut, given.get(InputKey::nut_conformity), &screw),
            ElasticContact::of(Member::Screw, given.get(InputKey::screw_conformity), &screw),
        ];
        let inertia_ratio = units.mass * radius;
        let [least, infinity] = [f64::MIN_POSITIVE, f64::INFINITY].map(|x| arc.constant(x));
        let regular = pressed[0].regular
            & pressed[1].regular
            & units.mass.gt(least)
            & inertia_ratio.gt(least)
            & inertia_ratio.lt(infinity);
        Self {
            sin_a,
            cos_a,
            sin_b,
            cos_b,
            arc,
            lever: cos_a / arc,
            inertia_ratio,
            nut_speed: units.nut_speed / units.speed,
            pressed,
            regular,
        }
    }

    #[inline(always)]
    pub(super) fn constant(&self, x: f64) -> Lane<S> {
        self.arc.constant(x)
    }

    /// `$A_2 = (l_{A0} + l_{B0})\cos\beta_0$`.
    #[inline(always)]
    pub(super) fn reach(&self) -> Lane<S> {
        (self.pressed[0].offset + self.pressed[1].offset) * self.cos_b
    }

    /// The contact at nut (0) or screw (1) with this cotangent of its angle, without friction.
    #[inline(always)]
    pub(super) fn side(&self, i: usize, cot: Lane<S>) -> Side<S> {
        let length = (cot * cot + 1.0).sqrt();
        let sin = length.recip();
        // Q_A sinβ_A cosα = F_a                                           (W2)
        Side { cot, ..self.loaded(i, length / self.cos_a, (sin, cot * sin)) }
    }

    /// The contact at nut (0) or screw (1) of a load, with sine and cosine of its angle.
    #[inline(always)]
    pub(super) fn loaded(
        &self,
        i: usize,
        load: Lane<S>,
        (sin, cos): (Lane<S>, Lane<S>),
    ) -> Side<S> {
        let pressed = &self.pressed[i];
        let growth = load.cbrt_positive();
        // δ = (Q/K_H)^{2/3}                                               (P2), (W1)
        let approach = pressed.hertz.compliance * growth * growth;
        let length = pressed.offset + approach;
        Side { cot: cos / sin, sin, cos, load, growth, approach, length }
    }
}

/// Stores loads, angles, ellipses, approaches and displacement: a call of its own, as three kernels share it.
pub(super) struct Contacts<'a, 'b, 'c, S: Simd> {
    pub(super) out: &'a mut Out<'b, 'c>,
    pub(super) units: &'a Units<S>,
    pub(super) pair: &'a Pair<S>,
    pub(super) sides: &'a [Side<S>; 2],
}

impl<S: Simd> NullaryFnOnce for Contacts<'_, '_, '_, S> {
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
            // a ~ Q^{1/3}                                                     (P6)
            let a = side.growth * pressed.hertz.semi_axis * ball;
            let b = a * pressed.hertz.flatness;
            out.set(long, a / MM);
            out.set(short, b / MM);
            out.set(pressure, max_pressure(q, (a, b)) / MPA);
            out.set(approach, side.approach * ball / UM);
        }
        let [a, b] = sides;
        let both = pair.pressed[0].offset + pair.pressed[1].offset;
        let displacement =
            axial_displacement([a.length, b.length], [a.sin, b.sin], both * pair.sin_b);
        out.set(OutputKey::axial_displacement_um, displacement * ball / UM);
    }
}
