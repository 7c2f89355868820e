//! Jamming of balls: wedge between the raceways, drag of the lubricant, and thrust in the ball
//! return.
//!
//! Theory: `docs/theory/14-jamming.md`, equations (M5) to (M23). The indices `A` and `B` denote nut
//! and screw; Dong et al. write `o` and `i` instead.

use std::f64::consts::PI;

use bsm_kin::{Real, Scalar};

use super::friction::magnitude;

/// A ball in the wedge between the raceways. The raceways push the ball out of the wedge, and
/// friction holds it.
///
/// Source: Dong et al. (2020), Equations 15 to 17.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge<D> {
    /// Normal loads at nut and screw \[N\].
    pub loads: [D; 2],
    /// Contact angles at nut and screw \[rad\].
    pub angles: [D; 2],
    /// Slip angles at nut and screw \[rad\] (K15).
    pub slip_angles: [D; 2],
    /// Friction coefficients at nut and screw.
    pub friction: [D; 2],
    /// Centrifugal force on the ball \[N\] (M5).
    pub centrifugal: D,
}

impl<D: Scalar> Wedge<D> {
    /// Returns the wedge angle `$D = \beta_B - \beta_A$` \[rad\]. The wedge opens toward the axis
    /// if the angle is positive.
    pub fn wedge_angle(&self) -> D {
        self.angles[1] - self.angles[0]
    }

    /// Returns the mean of the contact angles at nut and screw \[rad\].
    pub fn mean_angle(&self) -> D {
        (self.angles[0] + self.angles[1]) * 0.5
    }

    /// Returns the components of the friction forces across the grooves, at nut and screw \[N\]
    /// (M7).
    pub fn across(&self) -> [D; 2] {
        // F_X = f Q |cosψ|                                                (M7)
        [0, 1].map(|i| magnitude(self.slip_angles[i].cos()) * self.loads[i] * self.friction[i])
    }

    /// Returns the force \[N\] that holds the ball in the wedge. This force is the left side of
    /// (M8).
    pub fn holding_force(&self) -> D {
        let [a, b] = self.across();
        // Holding force: (F_XA + F_XB) cos(D/2) + F_c sin β               (M8)
        (a + b) * (self.wedge_angle() * 0.5).cos() + self.centrifugal * self.mean_angle().sin()
    }

    /// Returns the force \[N\] that pushes the ball out of the wedge, which is the right side of
    /// (M8). It is negative if the wedge opens outward.
    pub fn expelling_force(&self) -> D {
        // Expelling force: (Q_A + Q_B) sin(D/2)                           (M8)
        (self.loads[0] + self.loads[1]) * (self.wedge_angle() * 0.5).sin()
    }

    /// Returns the friction coefficient above which friction holds the ball in the wedge, for
    /// either direction of the pushing force (M9).
    ///
    /// If there is no slip across the grooves, the result is infinite.
    pub fn critical_friction(&self) -> D {
        let push = self.expelling_force() - self.centrifugal * self.mean_angle().sin();
        // f_lock = |(Q_A + Q_B) sin(D/2) − F_c sinβ| / (Σ Q|cosψ| cos(D/2))  (M9)
        magnitude(push) / (self.load_across() * (self.wedge_angle() * 0.5).cos())
    }

    /// Returns the critical friction coefficients at nut and screw, calculated with the formula as
    /// printed in the source (M18).
    ///
    /// Source: Dong et al. (2020), Equation 16.
    pub fn critical_friction_printed(&self) -> [D; 2] {
        // f ≥ |sinψ| tan(|D|/2)                                           (M18)
        self.slip_angles.map(|psi| magnitude(psi.sin()) * self.critical_friction_simplified())
    }

    /// Returns the critical friction coefficient, simplified by setting `$\sin\psi = 1$`.
    ///
    /// Source: Dong et al. (2020), Equation 17 without the radical.
    pub fn critical_friction_simplified(&self) -> D {
        magnitude((self.wedge_angle() * 0.5).tan())
    }

    /// Returns the critical friction coefficient of a ball without centrifugal force, calculated
    /// with the corrected formula (M10).
    pub fn critical_friction_corrected(&self) -> D {
        let share = self.load_across() / (self.loads[0] + self.loads[1]);
        // f_lock |cosψ| = tan(|D|/2)                                      (M10)
        self.critical_friction_simplified() / share
    }

    /// Returns the largest wedge angle \[rad\] at which friction can hold the ball if all friction
    /// acts across the grooves (M17).
    pub fn widest_opening(&self) -> D {
        let ([nut, screw], [q_a, q_b]) = (self.friction, self.loads);
        let mean = screw + (nut - screw) * q_a / (q_a + q_b);
        // D_max = 2 arctan f                                              (M17)
        mean.atan() * 2.0
    }

    /// Returns the sum of the normal loads that contribute to friction across the grooves, `$\sum
    /// Q\,|\cos\psi|$` \[N\].
    fn load_across(&self) -> D {
        let part = |i: usize| magnitude(self.slip_angles[i].cos()) * self.loads[i];
        part(0) + part(1)
    }
}

/// Returns the centrifugal force `$m r_m P^2$` \[N\] (M5).
pub fn centrifugal_force<D: Scalar>(mass: D, pitch_radius: D, precession: D) -> D {
    // F_c = m r_m P²                                                      (M5)
    mass * pitch_radius * precession.square()
}

/// Returns the drag force of the lubricant on a ball \[N\], which acts against the direction of
/// travel (M6).
///
/// * `coefficient`: drag coefficient `$C_v$`.
/// * `density`: density of the lubricant in the nut \[kg/m³\].
/// * `diameter`: ball diameter \[m\].
/// * `speed`: `$2 r_m|P - \Omega_n|$`, which is twice the speed of the ball center around the axis
///   \[m/s\].
///
/// Source: Dong et al. (2020), who use the formula for rolling bearings.
#[inline(always)]
pub fn viscous_drag<D: Real>(coefficient: D, density: D, diameter: D, speed: D) -> D {
    // F_v = (π/32) C_v ρ d_b² (2 r_m ω_m)^1.95                            (M6)
    coefficient * (PI / 32.0) * density * diameter.square() * speed.powf(1.95)
}

/// Returns the Hertz stiffness of a ball on a plane \[N/m^1.5\] for the contact modulus `modulus`
/// \[Pa\] (M11).
pub fn flat_stiffness(modulus: f64, ball_radius: f64) -> f64 {
    // K = (4/3) E* √r_b                                                   (M11)
    4.0 / 3.0 * modulus * ball_radius.sqrt()
}

/// Returns the impact force \[N\] of a ball that hits a contact with a given Hertz stiffness (M12),
/// (M13).
///
/// * `mass`: ball mass \[kg\].
/// * `speed`: ball speed along the contact normal \[m/s\].
/// * `stiffness`: Hertz stiffness `$K$` \[N/m^1.5\].
///
/// Source: Dong et al. (2020), Equation 19.
pub fn impact_force(mass: f64, speed: f64, stiffness: f64) -> f64 {
    // δ_m = (5 m v² / (4 K))^{2/5}                                        (M12)
    let approach = (1.25 * mass * speed.powi(2) / stiffness).powf(0.4);
    // F_m = 1.14 m v² / δ_m                                               (M13)
    1.14 * mass * speed.powi(2) / approach
}

/// Returns the impact force \[N\] of a ball that hits a linear spring (M19).
///
/// * `mass`: ball mass \[kg\].
/// * `speed`: ball speed along the contact normal \[m/s\].
/// * `stiffness`: stiffness of the spring `$k_h$` \[N/m\].
///
/// Source: Dong et al. (2020), Equation 19 as printed.
pub fn linear_impact_force(mass: f64, speed: f64, stiffness: f64) -> f64 {
    // F_m = k_h δ_m = 1.14 m v²/δ_m  ⇒  F_m = v √(1.14 k_h m)             (M19)
    speed * (1.14 * stiffness * mass).sqrt()
}

/// A ball that enters the ball return over a step. The ball behind pushes this ball, and this ball
/// pushes the ball ahead.
///
/// Source: Dong et al. (2020), Equation 22.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EntryStep {
    /// Height of the step divided by the ball radius.
    pub height: f64,
    /// Angle between return channel and track \[rad\].
    pub angle: f64,
    /// Rolling friction coefficient `$\mu'$`.
    pub rolling: f64,
}

impl EntryStep {
    /// Returns the ratio of the force from the ball behind to the force from the ball ahead at the
    /// moment when the ball lifts off its track (M21). Returns `None` if no force can lift the ball
    /// over the step.
    pub fn thrust_ratio(&self) -> Option<f64> {
        // sinα' = 1 − h/r_b                                               (M20)
        let edge = (1.0 - self.height).asin();
        let free = edge - self.rolling.atan();
        // F_O1/F_O3 = sin(α + α' − φ)/sin(α' − φ),  tanφ = μ'             (M21)
        (free > 0.0).then(|| (self.angle + free).sin() / free.sin())
    }

    /// Returns the maximum step height, divided by the ball radius, over which a force can lift the
    /// ball (M22).
    pub fn max_step_height(&self) -> f64 {
        // h_max/r_b = 1 − sinφ                                            (M22)
        1.0 - self.rolling.atan().sin()
    }
}

/// Returns the thrust \[N\] on the ball behind when a ball hits the apex of the return curve (M14).
///
/// * `impact`: impact force `$F_m$` \[N\].
/// * `half_angle`: half angle `$\lambda_1$` of the apex \[rad\].
/// * `friction`: friction coefficient `$f$`.
///
/// Source: Dong et al. (2020), Equation 18.
pub fn apex_thrust<D: Scalar>(impact: D, half_angle: D, friction: D) -> D {
    let (sin, cos) = half_angle.sin_cos();
    // F_O1 = (F_m/2)(1/sinλ₁ + f/cosλ₁)                                   (M14)
    impact * (sin.recip() + friction / cos) * 0.5
}

/// Returns the thrust \[N\] on the ball behind when a ball hits the step between ball return and
/// screw (M15).
///
/// * `normal`: normal force `$F_N$` of the step \[N\].
/// * `friction`: friction coefficient `$f > 0$`.
/// * `return_angle`: angle `$\lambda_3$` by which the track turns at the step \[rad\].
///
/// Source: Dong et al. (2020), Equations 23 and 24.
pub fn step_thrust<D: Scalar>(normal: D, friction: D, return_angle: D) -> D {
    // F_O1 = 2 F_N / ((f + 1/f) cosλ₃)                                    (M15)
    normal * 2.0 / ((friction + friction.recip()) * return_angle.cos())
}

/// Returns the friction force along the track \[N\] that pushes the loaded balls of one turn
/// against the ball ahead (M16).
///
/// * `balls`: number of balls per turn.
/// * `friction`: friction coefficient `$f$`.
/// * `load`: normal load on one ball \[N\].
/// * `slip_angle`: slip angle at the contact with the screw \[rad\].
///
/// Source: Dong et al. (2020), Equations 20 and 21, applied to the contact at the screw.
pub fn track_friction(balls: f64, friction: f64, load: f64, slip_angle: f64) -> f64 {
    // F_t = Z_t f Q |sinψ|                                                (M16)
    balls * friction * load * slip_angle.sin().abs()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use approx::assert_relative_eq;
    use bsm_kin::{BallFrame, Contact, Site};
    use nalgebra::{Matrix2, Vector2, Vector3};
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Both sides of the criterion are forces in the direction in which a ball leaves the
        /// wedge. Friction with the critical friction coefficient is just sufficient to hold the
        /// ball.
        #[test]
        fn wedge_criterion_matches_the_force_balance(
            a in 0.1..1.4_f64, tilt in -0.2..0.2_f64, q_a in 10.0..500.0_f64, q_b in 10.0..500.0_f64,
            f_c in 0.0..30.0_f64, psi in 0.0..1.5_f64,
        ) {
            let (angles, loads) = ([a - tilt, a + tilt], [q_a, q_b]);
            let slip_angles = [psi, PI - psi];
            let wedge = Wedge { loads, angles, slip_angles, friction: [0.1; 2], centrifugal: f_c };
            let frame = BallFrame::turned(0.1, 0.0);
            let normal = |site, angle| Contact::new(site, angle, &frame).normal;
            let forces = normal(Site::Nut, angles[0]) * q_a + normal(Site::Screw, angles[1]) * q_b;
            // The vector `out` points out of the wedge. It is perpendicular to the mean contact
            // normal and points toward the axis.
            let out = Vector3::new(0.0, a.sin(), -a.cos());
            let net = (forces - frame.n * f_c).dot(&out);
            let friction: f64 = wedge.across().iter().sum();
            let held = wedge.holding_force() - friction * tilt.cos() - wedge.expelling_force();
            // The tolerance allows for rounding errors of forces of 1 kN.
            prop_assert!((held + net).abs() <= 1e-11, "{held} {net}");
            let critical = Wedge { friction: [wedge.critical_friction(); 2], ..wedge };
            let held: f64 = critical.across().iter().sum::<f64>() * tilt.cos();
            prop_assert!((held - net.abs()).abs() <= 1e-11);
            let equal = Wedge { centrifugal: 0.0, ..wedge };
            let corrected = equal.critical_friction_corrected();
            prop_assert!((equal.critical_friction() / corrected - 1.0).abs() <= 1e-12);
            prop_assert!((corrected * psi.cos() - tilt.abs().tan()).abs() <= 1e-14);
            // The printed formula contains the sine, which gives the friction component along the
            // groove, instead of the cosine.
            let [at_nut, at_screw] = equal.critical_friction_printed();
            prop_assert!((at_nut - psi.sin() * tilt.abs().tan()).abs() <= 1e-14);
            prop_assert!((at_nut - at_screw).abs() <= 1e-14);
        }

        /// Equation 24 of Dong et al. is the solution of the two force balances of Equation 23. The
        /// unknowns are the force of the opposite wall and the thrust.
        #[test]
        fn step_thrust_satisfies_the_force_balances_of_eq_23_of_dong(
            normal in 1.0..500.0_f64, mu in 0.01..0.6_f64, angle in 0.0..1.4_f64,
        ) {
            let (sin, cos) = angle.sin_cos();
            // μ F_s + μ F_O1 sinλ₃ + μ F_N = F_O1 cosλ₃,  F_N = F_s + μ F_O1 cosλ₃ + F_O1 sinλ₃
            let rows = Matrix2::new(mu, mu * sin - cos, 1.0, mu * cos + sin);
            let right = Vector2::new(-mu * normal, normal);
            let solved = rows.lu().solve(&right).expect("regular");
            let thrust = step_thrust(normal, mu, angle);
            // The tolerance is the rounding error multiplied by the condition number, which is
            // large if the step is nearly perpendicular to the direction of travel.
            prop_assert!((thrust / solved.y - 1.0).abs() <= 1e-13 / cos, "{thrust} {solved}");
        }

        /// The Hertz contact stores the kinetic energy of the impact. The factor 1.14 in the
        /// formula applies to a half-sine pulse with the same approach and duration; for the
        /// maximum Hertz force, the factor is 5/4.
        #[test]
        fn impact_on_a_hertz_contact_conserves_energy(
            mass in 1e-5..1e-2_f64, speed in 0.01..20.0_f64, log_k in 7.0..11.0_f64,
        ) {
            let stiffness = 10.0_f64.powf(log_k);
            let force = impact_force(mass, speed, stiffness);
            let hertz = force * 1.25 / 1.14;
            let approach = (hertz / stiffness).powf(2.0 / 3.0);
            let (stored, moving) = (0.4 * hertz * approach, 0.5 * mass * speed.powi(2));
            prop_assert!((stored / moving - 1.0).abs() <= 1e-12);
        }
    }

    /// Hand calculation: without friction, the thrust at an apex with a half angle of 45 degrees is
    /// half of the impact force multiplied by √2. Friction increases the thrust by the frictionless
    /// thrust multiplied by the friction coefficient.
    #[test]
    fn thrust_at_the_groove_apex_matches_a_hand_calculation() {
        let thrust = apex_thrust(10.0, FRAC_PI_4, 0.1);
        assert_relative_eq!(thrust, 5.0 * 1.1 * 2.0_f64.sqrt(), max_relative = 1e-14);
    }

    /// Friction across the groove does not push the ball, whereas friction along the groove pushes
    /// the ball with its full magnitude.
    #[test]
    fn friction_along_the_groove_pushes_the_ball_and_friction_across_the_groove_does_not() {
        let full = track_friction(14.0, 0.1, 90.0, -FRAC_PI_2);
        assert_relative_eq!(full, 126.0, max_relative = 1e-14);
        assert!(track_friction(14.0, 0.1, 100.0, PI).abs() < 1e-12);
    }

    /// For a linear spring, the impact force is proportional to the speed. If the approach is the
    /// compression of the spring, the force satisfies Equation 19 of Dong et al.
    #[test]
    fn linear_impact_force_satisfies_eq_19_of_dong() {
        let (mass, stiffness) = (1.7e-4, 3e7);
        let force = linear_impact_force(mass, 1.3, stiffness);
        let approach = force / stiffness;
        assert_relative_eq!(force, 1.14 * mass * 1.3 * 1.3 / approach, max_relative = 1e-14);
        let twice = linear_impact_force(mass, 2.6, stiffness);
        assert_relative_eq!(twice, 2.0 * force, max_relative = 1e-14);
    }

    proptest! {
        /// The two force balances and the moment balance of Equation 22 of Dong et al. hold at the
        /// moment when the ball lifts off its track. The moment balance follows from the force
        /// balances.
        #[test]
        fn forces_and_moments_balance_at_the_entry_step(
            height in 0.0..0.8_f64, angle in 0.01..1.5_f64, rolling in 0.0..0.05_f64,
        ) {
            let step = EntryStep { height, angle, rolling };
            let ratio = step.thrust_ratio().expect("a low step");
            let (sin, cos) = (1.0 - height).asin().sin_cos();
            // F_N sinα' − f_N cosα' + F_R − F_O3 sinα = 0 with F_R = 0 and F_O3 = 1.
            let normal = angle.sin() / (sin - rolling * cos);
            let along = angle.cos() + normal * cos + rolling * normal * sin - ratio;
            // The tolerance is the rounding error multiplied by the condition number, which is
            // large near the maximum step height.
            prop_assert!(along.abs() <= 1e-13 * (1.0 + normal), "{along}");
            let moments = ratio * sin - (angle.cos() * sin + angle.sin() * cos) - rolling * normal;
            prop_assert!(moments.abs() <= 1e-13 * (1.0 + normal), "{moments}");
        }
    }

    /// A step of zero height only deflects the ball. Near the maximum height, the thrust grows
    /// without bound, and no thrust can lift the ball over a higher step.
    #[test]
    fn thrust_at_entry_step_grows_without_bound_near_the_maximum_height() {
        let step = |height, angle, rolling| EntryStep { height, angle, rolling };
        let flat = step(0.0, 0.4, 0.0).thrust_ratio().expect("flat");
        assert_relative_eq!(flat, 0.4_f64.cos(), max_relative = 1e-14);
        let highest = step(0.0, 0.4, 0.02).max_step_height();
        assert!(step(highest * (1.0 - 1e-6), 0.4, 0.02).thrust_ratio().expect("below") > 1e4);
        assert_eq!(step(highest * (1.0 + 1e-6), 0.4, 0.02).thrust_ratio(), None);
        assert_eq!(step(1.5, 0.4, 0.0).thrust_ratio(), None);
    }

    /// A hand calculation gives a drag force of (π/32) × 0.5 × 880 × 3.5e-3² × 2^1.95 N.
    #[test]
    fn drag_and_centrifugal_force_match_hand_calculations() {
        let drag = viscous_drag(0.5, 880.0, 3.5e-3, 2.0);
        assert_relative_eq!(drag, 2.044_6e-3, max_relative = 1e-4);
        assert_relative_eq!(centrifugal_force(2e-3, 8e-3, 250.0), 1.0, max_relative = 1e-14);
        assert_relative_eq!(flat_stiffness(1e11, 4e-3), 8.432_74e9, max_relative = 1e-6);
    }
}
