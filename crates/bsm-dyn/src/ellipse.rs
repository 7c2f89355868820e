//! Integration of friction over the contact ellipse.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (E2) to (E6), and
//! `docs/theory/09-traction.md`, equations (T12) to (T20).

mod chords;
mod field;
mod kernel;
mod nodes;
mod oil;
mod panels;
mod placement;
mod power;
mod quadrature;
mod slip;

use std::array::from_fn;
use std::marker::PhantomData;

use bsm_kin::{BallFrame, Contact, ContactMotion, Jet, Motion, Over, Real, Scalar};
use bsm_simd::{Arch, Simd, WithSimd};

pub use self::kernel::Patch;
pub(crate) use self::kernel::Resultants;
use self::kernel::{Dry, MOTION, SUMS, sums};

pub(crate) use self::oil::OilLaw;
pub(crate) use self::placement::{FrozenRule, Placement};
pub use self::power::{lubricated_powers, power_of_many};
pub use self::quadrature::Quadrature;
pub(crate) use self::quadrature::{RulePair, Rules};
pub use self::slip::EllipseSlip;
pub(crate) use self::slip::{slip_scale, surface_drop};
use crate::contact::{Coulomb, FrictionLaw, MixedFriction, Wrench};

/// A loaded contact ellipse between ball and groove.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ellipse<D, P = f64> {
    /// Flank and unit vectors of the contact.
    pub contact: Contact<D>,
    /// Normal load `$Q$` \[N\].
    pub load: D,
    /// Semi-axes across and along the groove \[m\].
    pub semi_axes: (D, D),
    /// Radius of the deformed contact surface across the groove `$R_c$` \[m\] (E2).
    pub pressed_radius: P,
    /// Ball radius `$r_b$` \[m\].
    pub ball_radius: P,
}

/// Returns the radius of the deformed contact surface \[m\] (E2).
///
/// Source: Harris and Kotzalas, *Advanced Concepts of Bearing Technology*. The result is the
/// harmonic mean of the ball radius and the groove radius.
#[inline(always)]
pub fn pressed_radius<D: Real>(conformity: D, ball_radius: D) -> D {
    // R_c = 2 f_g (2 r_b) / (2 f_g + 1)                                   (E2)
    conformity * 4.0 * ball_radius / (conformity * 2.0 + 1.0)
}

/// Friction force and moment of a contact, integrated over the ellipse, in contact coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integral<D> {
    /// Friction force along `$t$` and along `$t \times N$`.
    pub(crate) force: [D; 2],
    /// Friction moment about the ball center, with components along `$t$`, `$N$` and `$t \times
    /// N$`.
    pub(crate) moment: [D; 3],
}

/// Converts a motion relative to the nut or the screw into contact coordinates.
pub(crate) fn contact_motion<D: Scalar>(
    motion: &Motion<D>,
    contact: &Contact<D>,
    arc_length_per_radian: D,
) -> ContactMotion<D> {
    let across = BallFrame::tangent().cross(&contact.normal);
    let omega = &motion.omega;
    ContactMotion {
        speed: arc_length_per_radian * motion.precession,
        omega: [omega.x, omega.dot(&contact.normal), omega.dot(&across)],
    }
}

impl<D: Scalar> Integral<D> {
    /// Converts the integrated friction from contact coordinates to a force and a moment on the
    /// ball.
    pub(crate) fn wrench(&self, contact: &Contact<D>) -> Wrench<D> {
        let tangent = BallFrame::tangent();
        let across = tangent.cross(&contact.normal);
        let ([f_t, f_c], [m_t, m_n, m_c]) = (self.force, self.moment);
        Wrench {
            force: tangent * f_t + across * f_c,
            moment: tangent * m_t + contact.normal * m_n + across * m_c,
        }
    }
}

impl<P: Scalar, D: Over<P>> Ellipse<D, P> {
    /// Integrates friction over the ellipse. Returns the force and the moment on the ball, and the
    /// friction power (E3) to (E6).
    ///
    /// * `motion`: motion of the ball relative to the nut or the screw.
    /// * `arc_length_per_radian`: length of the helix per radian, `$d$` \[m\].
    /// * `creep`: creep speed `$v_e$` \[m/s\], positive. If the slip speed is below the creep
    ///   speed, friction is nearly proportional to the slip.
    ///
    /// Source: Coulomb friction over the Hertz ellipse with spin and Heathcote slip, as in the work
    /// of Jones and of Harris.
    pub(crate) fn friction<L>(
        &self,
        motion: &Motion<D>,
        arc_length_per_radian: D,
        law: &L,
        creep: f64,
        quadrature: &Quadrature,
    ) -> (Wrench<D>, D)
    where
        L: FrictionLaw<D>,
    {
        let local = contact_motion(motion, &self.contact, arc_length_per_radian);
        let (unit, power) = self.patch(&local, creep).integrate(law, quadrature.into());
        (unit.wrench(&self.contact) * self.load, power * self.load)
    }

    /// Returns the contact patch (dimensions and motion) from which the friction sums are
    /// calculated, for a given motion.
    pub(crate) fn patch(&self, local: &ContactMotion<D>, creep: f64) -> Patch<D> {
        let [t, n, c] = local.omega;
        Patch {
            semi_axes: self.semi_axes,
            pressed_radius: self.pressed_radius.into(),
            ball_radius: self.ball_radius.into(),
            motion: [local.speed, t, n, c],
            creep: creep.into(),
        }
    }
}

impl<D: Scalar> Patch<D> {
    /// Integrates friction node by node, with all derivatives. Returns the friction force and
    /// moment, divided by `$Q$`, and the friction power (E3) to (E6).
    pub(crate) fn integrate<L: FrictionLaw<D>>(
        &self,
        law: &L,
        nodes: Placement<'_>,
    ) -> (Integral<D>, D) {
        let zero = D::from(0.0);
        let mut sum = Integral { force: [zero; 2], moment: [zero; 3] };
        let mut power = zero;
        let [speed, w_t, w_n, w_c] = self.motion;
        let curvature = self.pressed_radius.recip() * -0.5;
        let creep = self.creep.square();
        for (x, y, weight) in nodes::nodes(&self.values(), nodes, law.bend().as_ref()) {
            let pressure = (1.0 - x * x - y * y).max(0.0).sqrt();
            let (x, y) = (self.semi_axes.0 * x, self.semi_axes.1 * y);
            // r = −N (r_b − x²/(2 R_c)) + x e + y t,  e = t × N           (E3)
            let h = x.square() * curvature + self.ball_radius;
            let (v_t, v_c) = (speed + w_n * x + w_c * h, -w_t * h - w_n * y);
            // dF = −f dQ v/√(v² + v_e²)                                   (E4)
            let square = v_t.square() + v_c.square();
            let speed = (square + creep).sqrt();
            let pull = law.coefficient(D::from(pressure), speed) / speed * weight;
            let (f_t, f_c) = (-pull * v_t, -pull * v_c);
            sum.force[0] += f_t;
            sum.force[1] += f_c;
            // dM = r × dF                                                 (E5)
            sum.moment[0] -= h * f_c;
            sum.moment[1] += x * f_t - y * f_c;
            sum.moment[2] += h * f_t;
            // dP = −dF·v                                                  (E6)
            power += pull * square;
        }
        (sum, power)
    }

    /// Returns the contact patch without derivatives.
    #[inline(always)]
    fn values(&self) -> Patch {
        Patch {
            semi_axes: (self.semi_axes.0.re(), self.semi_axes.1.re()),
            pressed_radius: self.pressed_radius.re(),
            ball_radius: self.ball_radius.re(),
            motion: [
                self.motion[0].re(),
                self.motion[1].re(),
                self.motion[2].re(),
                self.motion[3].re(),
            ],
            creep: self.creep.re(),
        }
    }
}

/// Scalar types for which friction can be integrated over the contact ellipses. `P` is the type of
/// the constants.
///
/// The default implementations of the methods call [`Patch::integrate`], which provides all
/// derivatives but is slow. Plain numbers and jets of numbers use vectorized sums, which are
/// faster.
pub(crate) trait Integrate<P: Scalar>: Over<P> {
    /// Returns friction and friction power at two contacts with a constant friction coefficient,
    /// divided by `$f Q$`. The vectorized sums do not include the derivatives of the power.
    ///
    /// * `alone`: true if only the first contact is calculated.
    fn dry<S: Simd>(
        _simd: S,
        patches: &[Patch<Self>; 2],
        nodes: &[Placement<'_>; 2],
        alone: bool,
    ) -> [(Integral<Self>, Self); 2] {
        let one = Coulomb(Self::from(1.0));
        let first = patches[0].integrate(&one, nodes[0].rule.into());
        [first, if alone { first } else { patches[1].integrate(&one, nodes[1].rule.into()) }]
    }

    /// Returns friction and friction power at nut and screw with a lubricant, divided by `$Q$`. The
    /// vectorized sums do not include the derivatives of the power or the derivatives with respect
    /// to the maximum pressure.
    ///
    /// * `films`: film thicknesses at nut and screw \[m\].
    fn lubricated<S: Simd>(
        _simd: S,
        patches: &[Patch<Self>; 2],
        laws: [&MixedFriction<Self>; 2],
        _films: [Self; 2],
        nodes: &[Placement<'_>; 2],
    ) -> [(Integral<Self>, Self); 2] {
        from_fn(|i| patches[i].integrate(laws[i], nodes[i]))
    }

    /// Returns the friction powers at two contacts with their derivatives, divided by `$f Q$`.
    fn powers(patches: &[Patch<Self>; 2], nodes: [Placement<'_>; 2]) -> [Self; 2] {
        let one = Coulomb(Self::from(1.0));
        from_fn(|i| patches[i].integrate(&one, nodes[i].rule.into()).1)
    }
}

/// Returns the friction forces and moments at two lubricated contacts, as in
/// [`Integrate::lubricated`].
pub(crate) fn lubricated_friction<P: Scalar, D: Integrate<P>>(
    patches: &[Patch<D>; 2],
    laws: [&MixedFriction<D>; 2],
    films: [D; 2],
    nodes: &[Placement<'_>; 2],
) -> [(Integral<D>, D); 2] {
    struct Call<'a, D, P> {
        patches: &'a [Patch<D>; 2],
        laws: [&'a MixedFriction<D>; 2],
        films: [D; 2],
        nodes: &'a [Placement<'a>; 2],
        constants: PhantomData<P>,
    }

    impl<P: Scalar, D: Integrate<P>> WithSimd for Call<'_, D, P> {
        type Output = [(Integral<D>, D); 2];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            D::lubricated(simd, self.patches, self.laws, self.films, self.nodes)
        }
    }

    Arch::new().dispatch(Call { patches, laws, films, nodes, constants: PhantomData })
}

impl<D: Real> Integral<D> {
    /// Returns force and moment multiplied by a factor.
    #[inline(always)]
    pub(crate) fn times(&self, factor: D) -> Self {
        let ([f_t, f_c], [m_t, m_n, m_c]) = (self.force, self.moment);
        Self {
            force: [f_t * factor, f_c * factor],
            moment: [m_t * factor, m_n * factor, m_c * factor],
        }
    }

    /// Adds force and moment of another integral, multiplied by a factor.
    #[inline(always)]
    pub(crate) fn add_times(&mut self, other: &Self, factor: f64) {
        for (to, from) in self.force.iter_mut().zip(other.force) {
            *to = *to + from * factor;
        }
        for (to, from) in self.moment.iter_mut().zip(other.moment) {
            *to = *to + from * factor;
        }
    }

    #[inline(always)]
    fn from_sums([f_t, f_c, m_t, m_n, m_c]: [D; kernel::SUMS]) -> Self {
        Self { force: [f_t, f_c], moment: [m_t, m_n, m_c] }
    }
}

impl Integrate<f64> for f64 {
    #[inline(always)]
    fn dry<S: Simd>(
        simd: S,
        patches: &[Patch; 2],
        nodes: &[Placement<'_>; 2],
        alone: bool,
    ) -> [(Integral<f64>, f64); 2] {
        let found = sums::<S, _, 2, false>(simd, patches, &[Dry; 2], nodes, [false, alone]);
        found.map(|sums| (Integral::from_sums(sums.values), sums.power))
    }

    #[inline(always)]
    fn lubricated<S: Simd>(
        simd: S,
        patches: &[Patch; 2],
        laws: [&MixedFriction; 2],
        _films: [f64; 2],
        nodes: &[Placement<'_>; 2],
    ) -> [(Integral<f64>, f64); 2] {
        let laws = laws.map(OilLaw::of);
        let found = sums::<S, _, 4, false>(simd, patches, &laws, nodes, [false; 2]);
        found.map(|sums| (Integral::from_sums(sums.values), sums.power))
    }

    fn powers(patches: &[Patch; 2], nodes: [Placement<'_>; 2]) -> [f64; 2] {
        kernel::powers_on(Arch::new(), patches, nodes)
    }
}

impl<const N: usize> Integrate<f64> for Jet<N> {
    #[inline(always)]
    fn dry<S: Simd>(
        simd: S,
        patches: &[Patch<Self>; 2],
        nodes: &[Placement<'_>; 2],
        alone: bool,
    ) -> [(Integral<Self>, Self); 2] {
        let points = [patches[0].values(), patches[1].values()];
        let found = sums::<S, _, 2, true>(simd, &points, &[Dry; 2], nodes, [false, alone]);
        let [nut, screw] = &found;
        // The array is written out, because a closure would be compiled for the baseline
        // instruction set.
        [
            (Integral::with_slopes(nut, &patches[0]), nut.power.into()),
            (Integral::with_slopes(screw, &patches[1]), screw.power.into()),
        ]
    }

    #[inline(always)]
    fn lubricated<S: Simd>(
        simd: S,
        patches: &[Patch<Self>; 2],
        laws: [&MixedFriction<Self>; 2],
        films: [Self; 2],
        nodes: &[Placement<'_>; 2],
    ) -> [(Integral<Self>, Self); 2] {
        let points = [patches[0].values(), patches[1].values()];
        let laws = laws.map(|law| OilLaw::of(&law.values()));
        let found = sums::<S, _, 4, true>(simd, &points, &laws, nodes, [false; 2]);
        let [nut, screw] = &found;
        let mut unit =
            [Integral::with_slopes(nut, &patches[0]), Integral::with_slopes(screw, &patches[1])];
        unit[0].add_slopes(nut.by_film, logarithmic(films[0]));
        unit[1].add_slopes(screw.by_film, logarithmic(films[1]));
        [(unit[0], nut.power.into()), (unit[1], screw.power.into())]
    }
}

/// Returns a jet that has the value of `x` but the derivatives of the logarithm of `x`.
#[inline(always)]
fn logarithmic<const N: usize>(x: Jet<N>) -> Jet<N> {
    x.chain(x.re, x.re.recip())
}

impl<const N: usize> Integral<Jet<N>> {
    /// Creates the integral with derivatives. The sums provide the derivatives with respect to the
    /// motion and to the size of the ellipse.
    #[inline(always)]
    fn with_slopes(sums: &Resultants, patch: &Patch<Jet<N>>) -> Self {
        let [f_t, f_c, m_t, m_n, m_c] = sums.values;
        let mut all = Self {
            force: [Jet::fixed(f_t), Jet::fixed(f_c)],
            moment: [Jet::fixed(m_t), Jet::fixed(m_n), Jet::fixed(m_c)],
        };
        let [f_t, f_c, m_t, m_n, m_c] = &sums.slopes;
        for (i, argument) in patch.motion.into_iter().enumerate() {
            all.add_slopes([f_t[i], f_c[i], m_t[i], m_n[i], m_c[i]], argument);
        }
        // Both semi-axes grow by the same factor.
        let growth = [f_t[MOTION], f_c[MOTION], m_t[MOTION], m_n[MOTION], m_c[MOTION]];
        all.add_slopes(growth, logarithmic(patch.semi_axes.0));
        all
    }

    /// Applies the chain rule for one argument: adds the given slopes multiplied by the derivatives
    /// of the argument.
    #[inline(always)]
    fn add_slopes(&mut self, slopes: [f64; SUMS], argument: Jet<N>) {
        let [f_t, f_c, m_t, m_n, m_c] = slopes;
        for i in 0..N {
            let eps = argument.eps[i];
            self.force[0].eps[i] += f_t * eps;
            self.force[1].eps[i] += f_c * eps;
            self.moment[0].eps[i] += m_t * eps;
            self.moment[1].eps[i] += m_n * eps;
            self.moment[2].eps[i] += m_c * eps;
        }
    }
}

impl<const N: usize> Integrate<Self> for Jet<N> {}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::{Real, Site};
    use bsm_sample::Sample;
    use nalgebra::Vector3;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::kernel::sums_on;
    use super::*;

    /// Returns the friction forces and moments at two contacts with a constant friction
    /// coefficient, as in [`Integrate::dry`].
    fn dry_friction<P: Scalar, D: Integrate<P>>(
        patches: &[Patch<D>; 2],
        nodes: &[Placement<'_>; 2],
        alone: bool,
    ) -> [(Integral<D>, D); 2] {
        struct Call<'a, D, P>(&'a [Patch<D>; 2], &'a [Placement<'a>; 2], bool, PhantomData<P>);

        impl<P: Scalar, D: Integrate<P>> WithSimd for Call<'_, D, P> {
            type Output = [(Integral<D>, D); 2];

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
                D::dry(simd, self.0, self.1, self.2)
            }
        }

        Arch::new().dispatch(Call(patches, nodes, alone, PhantomData))
    }

    fn ellipse() -> (Ellipse<f64>, Quadrature) {
        let frame = BallFrame::turned(0.17, 0.0);
        let contact = Contact::new(Site::Nut, 0.8, &frame);
        // The contact is flat and far from the ball center, so there is no Heathcote slip and all
        // points have equal lever arms.
        let ellipse = Ellipse {
            contact,
            load: 130.0,
            semi_axes: (0.5e-3, 0.1e-3),
            pressed_radius: 1e9,
            ball_radius: 4e-3,
        };
        (ellipse, Quadrature::of(1e-8))
    }

    /// If all points have the same slip, the friction force is f Q and acts against the slip, and
    /// the friction power is f Q multiplied by the slip speed.
    #[test]
    fn uniform_slip_gives_coulomb_friction() {
        let (ellipse, quadrature) = ellipse();
        let motion = Motion { precession: 3.0, omega: Vector3::zeros() };
        let (wrench, power) = ellipse.friction(&motion, 0.02, &Coulomb(0.08), 1e-9, &quadrature);
        let full = 0.08 * 130.0;
        assert_relative_eq!(wrench.force, Vector3::new(-full, 0.0, 0.0), epsilon = 1e-10);
        assert_relative_eq!(power, full * 0.06, max_relative = 1e-10);
    }

    /// For pure spin, the friction moment is 3/8 f Q a E(m).
    #[test]
    fn pure_spin_gives_the_analytic_moment() {
        let (ellipse, quadrature) = ellipse();
        let motion = Motion { precession: 0.0, omega: ellipse.contact.normal * 50.0 };
        let (wrench, power) = ellipse.friction(&motion, 0.02, &Coulomb(0.08), 1e-9, &quadrature);
        let (_, e) = ellip::ellipke(1.0 - 0.04).expect("parameter below 1");
        let expected = 3.0 / 8.0 * 0.08 * 130.0 * 0.5e-3 * e;
        // At the center of the ellipse, the direction of slip has a singularity, which limits the
        // convergence of the quadrature to 1/order³.
        let spin_moment = -wrench.moment.dot(&ellipse.contact.normal);
        assert_relative_eq!(spin_moment, expected, max_relative = 1e-4);
        assert_relative_eq!(power, spin_moment * 50.0, max_relative = 1e-10);
        assert!(wrench.force.norm() <= 1e-10 * 0.08 * 130.0, "{}", wrench.force);
    }

    /// A friction coefficient that decreases from 0.1 at the rim of the ellipse to 0.02 at the
    /// maximum pressure.
    struct FallingFriction;

    impl FrictionLaw<f64> for FallingFriction {
        fn coefficient(&self, pressure: f64, _speed: f64) -> f64 {
            0.1 - 0.08 * pressure
        }
    }

    /// If all points have the same slip, the mean coefficient is the coefficient at the
    /// load-weighted mean pressure, which is three quarters of the maximum pressure in a Hertz
    /// ellipse.
    #[test]
    fn friction_law_is_evaluated_at_the_local_pressure() {
        let (ellipse, quadrature) = ellipse();
        let motion = Motion { precession: 3.0, omega: Vector3::zeros() };
        let (wrench, power) = ellipse.friction(&motion, 0.02, &FallingFriction, 1e-9, &quadrature);
        let full = (0.1 - 0.08 * 0.75) * 130.0;
        // Near the rim, the pressure decreases like the square root of the distance from the rim,
        // which limits the accuracy to 3e-6.
        assert_relative_eq!(wrench.force, Vector3::new(-full, 0.0, 0.0), max_relative = 1e-5);
        assert_relative_eq!(power, full * 0.06, max_relative = 1e-5);
    }

    /// The friction power equals the power of force and moment in the given motion.
    #[test]
    fn friction_power_equals_the_power_of_force_and_moment() {
        let (ellipse, quadrature) = ellipse();
        let ellipse = Ellipse { pressed_radius: 4.2e-3, ..ellipse };
        let omega = Vector3::new(3.0, -57.0, 21.0);
        let motion = Motion { precession: 1.7, omega };
        let (wrench, power) = ellipse.friction(&motion, 0.02, &Coulomb(0.08), 1e-4, &quadrature);
        let done = wrench.force.x * 0.02 * 1.7 + wrench.moment.dot(&omega);
        assert_relative_eq!(power, -done, max_relative = 1e-12);
    }

    /// Returns a contact in scaled units, with derivatives with respect to the motion and to the
    /// size of the ellipse.
    fn with_slopes(
        [along, w_t, w_n, w_c]: [f64; 4],
        (a, b): (f64, f64),
    ) -> (Ellipse<Jet<5>>, ContactMotion<Jet<5>>) {
        let jet = |x, i| Jet::<5>::variable(x, i);
        let growth = jet(1.0, 4);
        let local =
            ContactMotion { speed: jet(along, 0), omega: [jet(w_t, 1), jet(w_n, 2), jet(w_c, 3)] };
        let frame = BallFrame::turned(Jet::from(0.17), Jet::from(0.0));
        let ellipse = Ellipse {
            contact: Contact::new(Site::Screw, Jet::from(0.8), &frame),
            load: Jet::from(1.0),
            semi_axes: (growth * a, growth * b),
            pressed_radius: 1.03,
            ball_radius: 1.0,
        };
        (ellipse, local)
    }

    fn numbers<D: Copy>(sum: &Integral<D>) -> Vec<D> {
        [sum.force.as_slice(), &sum.moment].concat()
    }

    proptest! {
        /// Compares the vectorized sums for an oil with its friction law, evaluated at the same
        /// nodes: values, and derivatives with respect to motion, size of the ellipse and film
        /// thickness.
        #[test]
        fn vectorized_sums_for_an_oil_match_the_friction_law(
            along in -0.5..0.5_f64, roll in -4.0..0.0_f64,
            omega in proptest::array::uniform2(-3.0..3.0_f64),
            a in 0.01..0.1_f64, log_creep in -4.0..0.0_f64, share in 0.01..1.0_f64,
            log_shear in -6.0..1.0_f64, gigapascals in 0.05..4.0_f64,
        ) {
            let quadrature = Quadrature::of_oil(1e-4);
            let creep = 10.0_f64.powf(log_creep);
            let jet = |x, i| Jet::<6>::variable(x, i);
            let growth = jet(1.0, 4);
            let [w_n, w_c] = [jet(omega[0], 2), jet(omega[1] * a, 3)];
            let local = ContactMotion {
                speed: jet(along * a, 0),
                omega: [jet(10.0_f64.powf(roll), 1), w_n, w_c],
            };
            let frame = BallFrame::turned(Jet::from(0.17), Jet::from(0.0));
            let ellipse = Ellipse {
                contact: Contact::new(Site::Screw, Jet::from(0.8), &frame),
                load: Jet::from(1.0),
                semi_axes: (growth * a, growth * (0.2 * a)),
                pressed_radius: 1.03,
                ball_radius: 1.0,
            };
            let film = jet(1.0, 5);
            let law = MixedFriction {
                asperity_share: (film * share.ln()).exp(),
                boundary: Jet::from(0.12),
                limiting_shear: Jet::from(0.047),
                shear: Jet::from(10.0_f64.powf(log_shear)) / film,
                eyring_stress: Jet::from(7.7e6),
                max_pressure: Jet::from(gigapascals * 1e9),
                pressure_scale: Jet::from(52e6),
            };
            let nodes = Placement::from(&quadrature);
            let patch = ellipse.patch(&local, creep);
            let ((slow, power), point) = (patch.integrate(&law, nodes), patch.values());
            let oil = OilLaw::of(&law.values());
            let fast = sums_on::<_, 4, true>(Arch::new(), &point, oil, nodes);
            let bare = sums_on::<_, 4, false>(Arch::new(), &point, oil, nodes);
            for sums in [&fast, &bare] {
                prop_assert!((sums.power - power.re).abs() <= 1e-12 * power.re);
            }
            for (i, slow) in numbers(&slow).iter().enumerate() {
                // The tolerance allows for the rounding errors of sums over hundreds of nodes. Each
                // term has the magnitude of the friction coefficient.
                let (fast_value, bare) = (fast.values[i], bare.values[i]);
                prop_assert!((fast_value - slow.re).abs() <= 1e-13 && (bare - slow.re).abs() <= 1e-13);
                let ours = fast.slopes[i].iter().chain([&fast.by_film[i]]);
                for (k, (ours, jets)) in ours.zip(slow.eps).enumerate() {
                    // Derivatives with respect to the slip are proportional to the reciprocal of
                    // the creep speed, whereas the derivative with respect to the film thickness
                    // does not depend on the creep speed.
                    let unit = if k < 5 { 1.0 / creep } else { 1.0 };
                    prop_assert!((ours - jets).abs() <= 1e-11 * unit, "{k}: {ours} {jets}");
                }
            }
        }

        /// Compares the vectorized sums with Coulomb friction, evaluated at the same nodes: values
        /// and derivatives, with the spin pole (the point without slip) inside and outside the
        /// ellipse.
        #[test]
        fn vectorized_sums_match_coulomb_friction(
            digits in 2.0..9.0_f64, along in -0.5..0.5_f64, roll in -4.0..0.0_f64,
            omega in proptest::array::uniform2(-3.0..3.0_f64),
            a in 0.01..0.1_f64, log_creep in -4.0..0.0_f64,
        ) {
            let quadrature = Quadrature::of(10.0_f64.powf(-digits));
            let creep = 10.0_f64.powf(log_creep);
            let motion = [along * a, 10.0_f64.powf(roll), omega[0], omega[1] * a];
            let (ellipse, local) = with_slopes(motion, (a, 0.2 * a));
            let one = Coulomb(Jet::from(1.0));
            let (patch, nodes) = (ellipse.patch(&local, creep), Placement::from(&quadrature));
            let ((law, power), point) = (patch.integrate(&one, nodes), patch.values());
            let [(fast, sloped_power), _] = dry_friction::<f64, _>(&[patch; 2], &[nodes; 2], true);
            let Resultants { values, power: fast_power, .. } =
                sums_on::<_, 2, false>(Arch::new(), &point, Dry, (&quadrature).into());
            // The tolerance allows for rounding errors of sums whose terms are at most one, and of
            // derivatives that are at most 1/v_e.
            let same = |a: Jet<5>, b: Jet<5>| {
                (a.re - b.re).abs() <= 1e-13
                    && a.eps.iter().zip(&b.eps).all(|(a, b)| (a - b).abs() <= 1e-13 / creep)
            };
            for fast in [fast_power, sloped_power.re] {
                prop_assert!((power.re - fast).abs() <= 1e-13 * (1.0 + power.re), "{power:?}");
            }
            for ((law, fast), value) in numbers(&law).into_iter().zip(numbers(&fast)).zip(values) {
                prop_assert!(same(law, fast), "{law:?} {fast:?}");
                prop_assert!((law.re - value).abs() <= 1e-13);
            }
        }

        /// The friction sums are bit-identical on all instruction sets.
        #[test]
        fn friction_sums_are_bit_identical_on_every_instruction_set(
            motion in proptest::array::uniform4(-1.0..1.0_f64), b in 0.01..0.3_f64,
        ) {
            let (ellipse, local) = with_slopes(motion, (0.3, b));
            let (point, rule) = (ellipse.patch(&local, 1e-4).values(), Quadrature::of(1e-6));
            let bits = |arch| {
                let Resultants { values, power, slopes, .. } =
                    sums_on::<_, 2, true>(arch, &point, Dry, (&rule).into());
                (values.map(f64::to_bits), power.to_bits(), slopes.map(|s| s.map(f64::to_bits)))
            };
            for arch in bsm_simd::instruction_sets() {
                prop_assert_eq!(bits(arch), bits(Arch::Scalar));
            }
        }
    }

    /// For random contacts, the quadrature errors are within the stated limits. The reference
    /// values come from two finer quadratures that agree. The semi-axes and slips of the contacts
    /// vary over orders of magnitude, and in many contacts, the spin pole (the point without slip)
    /// is inside the ellipse.
    #[test]
    fn quadrature_errors_at_random_contacts_are_within_limits() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let fine = [(60, 1e-15), (90, 1e-16)]
            .map(|(nodes, tolerance)| Quadrature::with(nodes, tolerance, 0));
        let accuracies = [1e-4, 1e-6, 1e-8];
        let rules = accuracies.map(Quadrature::of);
        let mut errors = [const { Vec::new() }; 4];
        for _ in 0..400 {
            let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
            let (a, ratio) = (log(1e-3, 0.3), log(2.0, 30.0));
            let (slip, roll, turn) = (log(1e-4, 1.0), log(1e-3, 1.0), log(1e-2, 3.0));
            let (bend, shift) = (log(1e-2, 3.0), log(1e-3, 1.0));
            let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let along = side * slip * shift - bend;
            let (ellipse, local) = with_slopes([along, roll, turn, bend], (a, a / ratio));
            let point = ellipse.patch(&local, 1e-4).values();
            let wrench = |rule: &Quadrature| {
                let sums = sums_on::<_, 2, false>(Arch::new(), &point, Dry, rule.into());
                let [f_t, f_c, m_t, m_n, m_c] = sums.values;
                [f_t, f_c, m_t, m_n / a, m_c]
            };
            let [exact, other] = fine.each_ref().map(wrench);
            let off = |wrench: [f64; 5]| {
                wrench.iter().zip(exact).map(|(x, exact)| (x - exact).abs()).fold(0.0, f64::max)
            };
            for (errors, rule) in errors.iter_mut().zip(&rules) {
                errors.push(off(wrench(rule)));
            }
            errors[3].push(off(other));
        }
        let quantiles: Vec<_> = errors
            .iter_mut()
            .map(|errors| {
                errors.sort_unstable_by(f64::total_cmp);
                [50, 99, 100]
                    .map(|share| errors[(errors.len() * share / 100).min(errors.len() - 1)])
            })
            .collect();
        println!("{quantiles:?}");
        // The limits are 25 % above the observed errors, which leaves a margin for other random
        // numbers. The difference between the two finer quadratures is much smaller than these
        // errors.
        for ([_, most, worst], limits) in
            quantiles.iter().zip([[6e-3, 1e-2], [1.2e-5, 5e-5], [1.5e-6, 2.5e-6], [1e-9, 1e-8]])
        {
            assert!(*most <= limits[0] && *worst <= limits[1], "{quantiles:?}");
        }
    }

    /// For rolling balls in thin and thick oil at low and high pressure, the quadrature errors,
    /// divided by the friction force, are within the stated limits. The reference values come from
    /// a finer quadrature.
    #[test]
    fn quadrature_errors_of_lubricated_contacts_are_within_limits() {
        let mut rng = ChaCha8Rng::seed_from_u64(22);
        let rules = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12].map(Quadrature::of_oil);
        let mut errors = [const { Vec::new() }; 4];
        for _ in 0..200 {
            let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
            let (a, ratio) = (log(0.02, 0.12), log(4.0, 12.0));
            let (roll, spin, shift) = (log(0.01, 0.2), log(0.1, 1.0), log(1e-3, 0.5));
            let pressed = log(0.4e9, 3e9);
            let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let (ellipse, local) =
                with_slopes([side * shift * spin * a, roll, spin, 0.0], (a, a / ratio));
            let point = ellipse.patch(&local, 1e-4).values();
            let law = MixedFriction {
                asperity_share: rng.random_range(0.0..0.9),
                boundary: 0.12,
                limiting_shear: 0.047,
                shear: rng.log_uniform(1e-6, 3.0),
                eyring_stress: 2.0 * 0.047 * (52e6 + 0.02 * pressed),
                max_pressure: pressed,
                pressure_scale: 52e6,
            };
            let sums = rules.each_ref().map(|rule| {
                let oil = OilLaw::of(&law);
                let sums = sums_on::<_, 4, false>(Arch::new(), &point, oil, rule.into());
                let [f_t, f_c, m_t, m_n, m_c] = sums.values;
                [f_t, f_c, m_t, m_n / a, m_c, sums.power / (roll + spin * a)]
            });
            let [others @ .., exact] = sums;
            // The errors are divided by the upper limit of the friction coefficient.
            let most = law.max_friction();
            for (errors, sums) in errors.iter_mut().zip(&others) {
                let off = sums.iter().zip(&exact);
                errors.push(off.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / most);
            }
        }
        let quantiles = errors.map(|mut errors| {
            errors.sort_unstable_by(f64::total_cmp);
            [50, 90, 100].map(|share| errors[(errors.len() * share / 100).min(errors.len() - 1)])
        });
        println!("{quantiles:?}");
        // The limits are two to three times the observed errors, which leaves a margin for other
        // random numbers.
        for (found, limits) in quantiles.iter().zip([
            [4e-4, 1e-2, 7e-2],
            [6e-6, 5e-5, 2e-3],
            [3e-7, 5e-6, 2e-5],
            [6e-8, 1.2e-6, 1e-5],
        ]) {
            assert!(
                found.iter().zip(limits).all(|(found, limit)| *found <= limit),
                "{quantiles:?}"
            );
        }
    }
}
