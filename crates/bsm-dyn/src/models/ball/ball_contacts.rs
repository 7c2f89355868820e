//! A ball between elastic raceways in scaled units (lengths divided by the ball radius, forces by
//! the axial load per ball, and speeds by the relative speed `$W$`), for one operating point or for
//! several points side by side in a SIMD vector. Angles are given by their sines and cosines.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (P1), (P2), (P6).

use bsm_kin::{Motion, Real, RealOver, relative_rotation};

use super::operating_point::ResultUnits;
use super::state::{BallState, ContactState, HertzContact, Slip};
use crate::contact::{
    Axes, Ball, Curvatures, Groove, Hertz, Raceway, Sines, binormal_displacement, max_pressure,
};
use crate::ellipse::pressed_radius;

/// A ball between elastic raceways, in scaled units. Arrays with two elements contain the values at
/// the nut and the screw.
#[derive(Debug, Clone, Copy, Default)]
pub struct ScaledBall<P = f64> {
    /// Sine and cosine of the lead angle.
    pub lead: (P, P),
    /// Ratio of pitch circle radius to ball radius `$r_m/r_b$`.
    pub radius: P,
    /// Arc length of the helix per radian `$d/r_b$`.
    pub arc: P,
    /// Dimensionless mass of the ball `$m r_b W^2/F_a$`.
    pub mass: P,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub nut_speed: P,
    /// Radial distance `$A_2$` between the groove arc centers (J2).
    pub radial_distance: P,
    /// Distances `$l_0$` between the arc center and the ball center at first contact.
    pub offsets: [P; 2],
    /// Hertz approaches under a normal load that equals the axial load per ball.
    pub approaches: [P; 2],
    /// Semi-axes of the contact ellipses, across and along the groove, under a normal load that
    /// equals the axial load per ball.
    pub semi_axes: [(P, P); 2],
    /// Radii of the deformed contact surfaces (E2).
    pub pressed_radius: [P; 2],
}

impl<P: Real> ScaledBall<P> {
    /// Returns the inertia ratio `$\mu = m r_m W^2/F_a$`.
    #[inline(always)]
    pub fn inertia_ratio(&self) -> P {
        self.mass * self.radius
    }

    /// Returns the ball in scaled units, in which its radius is 1.
    #[inline(always)]
    pub fn ball(&self) -> Ball<P> {
        Ball { radius: self.mass.constant(1.0), mass: self.mass }
    }
}

impl<P: Real> ScaledBall<P> {
    /// Returns the axial play of one nut below which the ball touches a far flank (AC7). The result
    /// is zero if the ball does not touch a far flank even without play.
    ///
    /// * `sides`: contacts at the nut and the screw.
    #[inline(always)]
    fn threshold_play(&self, sides: &[LoadedContact<P>; 2]) -> P {
        let [l_a, l_b] = self.offsets;
        let cos = self.radial_distance / (l_a + l_b);
        let sin = ((-cos + 1.0) * (cos + 1.0)).sqrt();
        let [nut, screw] = sides;
        let at_nut = far_flank_play((l_a * sin, l_a), nut.length, (nut.sin, nut.cos), self.lead.1);
        let at_screw =
            far_flank_play((l_b * sin, l_b), screw.length, (screw.sin, screw.cos), self.lead.1);
        at_nut.larger(at_screw)
    }
}

/// Returns the axial play of one nut below which a ball with two loaded contacts touches the far
/// flank of a groove (AC7). The result is zero if the ball does not touch the far flank even
/// without play.
///
/// * `across`, `offset`: distances `$l_0\sin\beta_0$` and `$l_0$`, both reduced by the amount by
///   which the ball radius exceeds its nominal value.
/// * `length`: distance from the arc center of the loaded flank to the ball center.
/// * `(sin, cos)`: sine and cosine of the contact angle.
/// * `cos_lead`: cosine of the lead angle.
#[inline(always)]
pub(crate) fn far_flank_play<F: Real>(
    (across, offset): (F, F),
    length: F,
    (sin, cos): (F, F),
    cos_lead: F,
) -> F {
    let zero = across.constant(0.0);
    let radial = length * cos;
    // s* = 4 (l₀ sinβ₀ − e*)/cosα,  e* = [l sinβ + √(l₀² − l² cos²β)]/2   (AC7)
    let square = ((offset - radial) * (offset + radial)).larger(zero);
    let center = (length * sin + square.sqrt()) * 0.5;
    ((across - center) * 4.0 / cos_lead).larger(zero)
}

/// Dimensionless size, mass, speed and stiffness of an operating point.
#[derive(Debug, Clone, Copy)]
pub struct ScaledSize<F> {
    /// Ratio of pitch circle radius to ball radius `$r_m/r_b$`.
    pub radius: F,
    /// Dimensionless mass of the ball `$m r_b W^2/F_a$`.
    pub mass: F,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub nut_speed: F,
    /// Dimensionless contact modulus `$E^* r_b^2/F_a$`.
    pub modulus: F,
}

/// A Hertz contact of ball and groove.
#[derive(Debug, Clone, Copy)]
pub struct GrooveContact<F> {
    /// Distance `$l_0$` between the arc center and the ball center at first contact (H2).
    pub offset: F,
    /// Radius of the deformed contact surface (E2).
    pub pressed_radius: F,
    /// Relative curvatures of ball and groove.
    pub curvatures: Curvatures<F>,
    /// Hertz contact for loads in units of the axial load per ball.
    pub hertz: Hertz<F>,
}

/// A ball with its contacts at the nut and the screw.
#[derive(Clone, Copy)]
pub struct BallContacts<F: Real> {
    /// The ball in scaled units.
    pub scaled: ScaledBall<F>,
    /// Sine of the unloaded contact angle.
    pub sin_b: F,
    /// Cosine of the unloaded contact angle.
    pub cos_b: F,
    /// Hertz contacts at the nut and the screw.
    pub pressed: [GrooveContact<F>; 2],
    /// True if no number overflows or underflows and the aspect ratios of both contact ellipses are
    /// within the range that occurs in practice.
    pub regular: F::Mask,
}

/// A contact under load, in scaled units.
#[derive(Debug, Clone, Copy)]
pub struct LoadedContact<D> {
    /// Cotangent of the contact angle.
    pub cot: D,
    /// Sine of the contact angle.
    pub sin: D,
    /// Cosine of the contact angle.
    pub cos: D,
    /// Ratio of normal load to axial load per ball `$Q/F_a$`.
    pub load: D,
    /// Cube root of the load ratio `load`.
    pub cbrt_load: D,
    /// Hertz approach `$\delta$`.
    pub approach: D,
    /// Distance `$l$` from the arc center to the ball center.
    pub length: D,
}

impl<D: Real> LoadedContact<D> {
    /// Creates the contact with a given load and contact angle.
    ///
    /// * `offset`: distance `$l_0$` between the arc center and the ball center at first contact.
    /// * `compliance`: approach under a normal load that equals the axial load per ball.
    /// * `(sin, cos)`: sine and cosine of the contact angle.
    #[inline(always)]
    pub fn of<P: Copy>((offset, compliance): (P, P), load: D, (sin, cos): (D, D)) -> Self
    where
        D: RealOver<P>,
    {
        let cbrt_load = load.cbrt();
        // δ = (Q/K_H)^{2/3}                                               (P2), (W1)
        let approach = cbrt_load.square() * compliance;
        Self { cot: cos / sin, sin, cos, load, cbrt_load, approach, length: approach + offset }
    }

    /// Creates a contact without friction from the cotangent of its contact angle. The normal load
    /// follows from the axial load.
    ///
    /// * `stiffness`: pair of `offset` and `compliance`, as defined for [`of`](Self::of).
    /// * `axial`: ratio `$1/\cos\alpha$` of the load component along the binormal to the axial
    ///   load.
    #[inline(always)]
    pub fn without_friction<P: Copy>(stiffness: (P, P), axial: P, cot: D) -> Self
    where
        D: RealOver<P>,
    {
        let length = (cot.square() + 1.0).sqrt();
        let sin = length.recip();
        // Q sinβ cosα = F_a                                               (W2)
        Self { cot, ..Self::of(stiffness, length * axial, (sin, cot * sin)) }
    }

    /// Returns the radial component `$l\cos\beta$` of the distance from the arc center to the ball
    /// center.
    #[inline(always)]
    pub fn radial_component(&self) -> D {
        self.length * self.cos
    }

    /// Returns the derivative of [`radial_component`](Self::radial_component) with respect to the
    /// cotangent of the contact angle, for a contact without friction. The derivative is positive.
    #[inline(always)]
    pub fn radial_slope(&self) -> D {
        // d cosβ = sin³β d cotβ,  dδ = ⅔ δ sinβ cosβ d cotβ because δ ~ Q^{2/3}
        self.sin.square() * self.sin * self.length
            + self.approach * self.sin * self.cos.square() * (2.0 / 3.0)
    }

    /// Returns the semi-axes of the contact ellipse across and along the groove.
    ///
    /// * `(a, b)`: semi-axes under a normal load that equals the axial load per ball.
    #[inline(always)]
    pub fn semi_axes<P: Copy>(&self, (a, b): (P, P)) -> (D, D)
    where
        D: RealOver<P>,
    {
        // a ~ Q^{1/3}                                                     (P6)
        (self.cbrt_load * a, self.cbrt_load * b)
    }
}

impl<F: Real> GrooveContact<F> {
    /// Creates the contact of the ball with a groove, together with a mask that is true if the
    /// aspect ratio of the contact ellipse is within the range that occurs in practice.
    #[inline(always)]
    fn of(groove: &Groove<F>, tan_a: F, cos_b: F, size: &ScaledSize<F>) -> (Self, F::Mask) {
        let one = cos_b.constant(1.0);
        let curvatures = groove.curvatures_at(size.radius, one, tan_a, cos_b);
        let target = curvatures.longitudinal / curvatures.transverse;
        let practice = target.at_least(1.0) & target.at_most(Axes::<F>::MAX_PRACTICAL_RATIO);
        let contact = Self {
            offset: groove.offset(one),
            pressed_radius: pressed_radius(groove.conformity, one),
            hertz: Hertz::with_axes(&Axes::of_practical_ratio(target), &curvatures, size.modulus),
            curvatures,
        };
        (contact, practice & curvatures.transverse.above(0.0))
    }
}

impl<F: Real> BallContacts<F> {
    /// Creates a ball with its contacts at the nut and the screw.
    ///
    /// * `sines`: sines and cosines of the lead angle and the unloaded contact angle.
    /// * `conformities`: conformities of the nut and the screw.
    #[inline(always)]
    pub fn new(sines: &Sines<F>, conformities: [F; 2], size: &ScaledSize<F>) -> Self {
        let &Sines { sin_a, cos_a, sin_b, cos_b } = sines;
        let nut = Groove { member: Raceway::Nut, conformity: conformities[0] };
        let screw = Groove { member: Raceway::Screw, conformity: conformities[1] };
        let (nut, at_nut) = GrooveContact::of(&nut, sines.tan_a(), cos_b, size);
        let (screw, at_screw) = GrooveContact::of(&screw, sines.tan_a(), cos_b, size);
        // Lengths are divided by r_b, forces by F_a, and speeds by W      (P1)
        let scaled = ScaledBall {
            lead: (sin_a, cos_a),
            radius: size.radius,
            arc: size.radius / cos_a,
            mass: size.mass,
            nut_speed: size.nut_speed,
            // A₂ = (l_A0 + l_B0) cosβ₀                                    (J2)
            radial_distance: (nut.offset + screw.offset) * cos_b,
            offsets: [nut.offset, screw.offset],
            approaches: [nut.hertz.compliance, screw.hertz.compliance],
            semi_axes: [
                (nut.hertz.semi_axis, nut.hertz.semi_axis * nut.hertz.flatness),
                (screw.hertz.semi_axis, screw.hertz.semi_axis * screw.hertz.flatness),
            ],
            pressed_radius: [nut.pressed_radius, screw.pressed_radius],
        };
        let inertia_ratio = scaled.inertia_ratio();
        let regular = at_nut
            & at_screw
            & size.mass.above(f64::MIN_POSITIVE)
            & inertia_ratio.above(f64::MIN_POSITIVE)
            & inertia_ratio.below(f64::INFINITY);
        Self { scaled, sin_b, cos_b, pressed: [nut, screw], regular }
    }

    /// Converts the number `x` to the scalar type `F`, with the same value at all points.
    #[inline(always)]
    pub fn constant(&self, x: f64) -> F {
        self.scaled.arc.constant(x)
    }

    /// Returns the contact at the nut (0) or the screw (1) from its load and the sine and cosine of
    /// its contact angle.
    #[inline(always)]
    pub fn loaded(&self, i: usize, load: F, angle: (F, F)) -> LoadedContact<F> {
        let GrooveContact { offset, hertz, .. } = self.pressed[i];
        LoadedContact::of((offset, hertz.compliance), load, angle)
    }

    /// Returns the displacement of the nut along the binormal due to the elastic approaches.
    #[inline(always)]
    pub fn displacement(&self, [a, b]: &[LoadedContact<F>; 2]) -> F {
        let both = self.pressed[0].offset + self.pressed[1].offset;
        binormal_displacement([a.length, b.length], [a.sin, b.sin], both * self.sin_b)
    }
}

/// Motion of a ball with two elastic contacts, with lengths divided by the ball radius and speeds
/// divided by `$W$`. Arrays with two elements contain the values at the nut and the screw.
#[derive(Debug, Clone, Copy)]
pub struct ElasticMotion<F> {
    /// Slip speeds at the contact centers, not negative.
    pub slip: [F; 2],
    /// Spins about the contact normals, relative to the nut and the screw.
    pub spin: [F; 2],
    /// Directions of the friction forces \[rad\]; `None` if they were not requested.
    pub slip_angles: Option<[F; 2]>,
    /// Absolute precession rate `$P/W$`.
    pub rate: F,
    /// Angular velocity relative to the nut in the Frenet-Serret triad `$(t, n, b)$`.
    pub to_nut: [F; 3],
    /// True if the force balance includes friction across the grooves.
    pub friction_in_balance: bool,
}

impl<F: Real> ElasticMotion<F> {
    /// Converts the motion to the state of the ball in SI units.
    ///
    /// * `angles`, `sides`: contact angles \[rad\] and contacts at the nut and the screw.
    /// * `displacement`: displacement of the nut along the binormal, divided by the ball radius.
    #[inline(always)]
    pub fn state(
        &self,
        ball: &ScaledBall<F>,
        (angles, sides): ([F; 2], &[LoadedContact<F>; 2]),
        displacement: F,
        units: &ResultUnits<F>,
    ) -> BallState<F> {
        let (w, length) = (units.speed, units.length);
        let mut contacts = [ContactState::at_angle(angles[0]), ContactState::at_angle(angles[1])];
        for (i, contact) in contacts.iter_mut().enumerate() {
            let side = &sides[i];
            let (load, (a, b)) = (side.load * units.load, side.semi_axes(ball.semi_axes[i]));
            let semi_axes = (a * length, b * length);
            let (max_pressure, approach) = (max_pressure(load, semi_axes), side.approach * length);
            let (speed, spin) = (self.slip[i] * w.abs() * length, self.spin[i] * w);
            contact.load = Some(load);
            contact.slip = Some(Slip { speed, spin });
            contact.pressed = Some(HertzContact { semi_axes, max_pressure, approach });
            if let Some(slip_angles) = &self.slip_angles {
                contact.slip_angle = Some(slip_angles[i]);
            }
        }
        let [t, n, b] = relative_rotation(self.to_nut, -ball.nut_speed, ball.lead);
        // u = δ_b/cosα                                                    (J15)
        let axial = displacement / ball.lead.1;
        let threshold_play =
            if self.friction_in_balance { Some(ball.threshold_play(sides) * length) } else { None };
        BallState {
            motion: Some(Motion::new(self.rate * w, [t * w, n * w, b * w])),
            nut: contacts[0],
            screw: contacts[1],
            unloaded: None,
            axial_displacement: Some(axial * length),
            threshold_play,
        }
    }
}

/// Returns the friction power at two contacts with a constant friction coefficient. For a contact
/// ellipse, the slip speed is the pressure-weighted mean over the ellipse.
#[inline(always)]
pub fn friction_power<F: Real>(friction: F, loads: [F; 2], slips: [F; 2]) -> F {
    // P_f = Σ f Q_c |V_c|, or Σ f Q ∫ dP                                  (R21), (P7)
    friction * (loads[0] * slips[0] + loads[1] * slips[1])
}
