//! The rigid model in its own units, and its residual.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R1) to (R10).

use bsm_kin::{BallFrame, Contact, Helix, Motion, Scalar, Site};
use bsm_newton::{Equations, EvalError, Linear};
use nalgebra::{SVector, Vector3};

use crate::balance::{Ball, DOES_NOT_CIRCLE, axial_force, newton_euler};
use crate::ball_unknowns::unknown::{
    MINOR_LOAD, NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN,
};
use crate::ball_unknowns::{self, BALL, MOMENT_NORMAL, ROWS, weight};
use crate::equations::{equations, linear};
use crate::friction::{Coulomb, against, friction_force};
use crate::{Wrench, cost};

/// One operating point in units of ball radius, axial load per ball and `$W$` (R1).
///
/// Its arrays are made member by member: `map` and `from_fn` may copy what they make, kilobytes of jets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaled<D> {
    /// Helix with radius `$r_m/r_b$`.
    pub(crate) helix: Helix<D>,
    /// Arc length per radian of the helix.
    pub(crate) arc: D,
    /// Triad turned to the contact normal.
    pub(crate) frame: BallFrame<D>,
    /// Contacts A, A', B.
    pub(crate) contacts: [Contact<D>; 3],
    /// Contact angle \[rad\].
    pub(crate) contact_angle: D,
    /// Coulomb coefficient with the sign of `$W$`: friction against a slip over `$W$`.
    pub(crate) signed_friction: D,
    /// Ball of radius 1 and mass `$m r_b W^2/F_a$`.
    pub(crate) ball: Ball<D>,
    /// Nut speed over `$W$`.
    pub(crate) nut_speed: D,
    /// True if the unknown of the precession counts from the ground, `$P/W$` in the place of `$p$`:
    /// where the ball hardly circles, the sum `$p + \Omega_n/W$` would lose its digits.
    pub(crate) from_ground: bool,
}

/// The seven unknowns (R2) of the rigid model: `$Q_A/F_a,\; Q_{A'}/F_a,\; Q_B/F_a,\; p,\; \lambda,\; \theta,\; s$`.
pub type Unknowns<D> = SVector<D, BALL>;

/// Motion, slips and wrenches that belong to a set of unknowns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State<D> {
    /// Motion of the ball relative to the nut.
    pub(crate) to_nut: Motion<D>,
    /// Absolute precession over `$W$`.
    pub(crate) precession: D,
    /// Slip velocities at A, A', B.
    pub(crate) slip: [Vector3<D>; 3],
    /// Wrenches of A, A', B on the ball.
    pub(crate) wrench: [Wrench<D>; 3],
}

impl<D: Scalar> Scaled<D> {
    /// Builds geometry from its numbers, all in scaled units.
    pub(crate) fn new(
        helix: Helix<D>,
        contact_angle: D,
        signed_friction: D,
        mass: D,
        nut_speed: D,
    ) -> Self {
        let frame = BallFrame::turned(helix.lead_angle, contact_angle);
        let contact = |site| Contact::new(site, contact_angle, &frame);
        let contacts = [contact(Site::Nut), contact(Site::NutMinor), contact(Site::Screw)];
        let ball = Ball { radius: D::from(1.0), mass };
        let arc = helix.arc_length_per_radian();
        Self {
            helix,
            arc,
            frame,
            contacts,
            contact_angle,
            signed_friction,
            ball,
            nut_speed,
            from_ground: false,
        }
    }

    /// Coulomb coefficient.
    pub(crate) fn friction(&self) -> f64 {
        self.signed_friction.re().abs()
    }

    /// The same point with the inertia multiplied by `factor`.
    pub(crate) fn with_inertia(&self, factor: f64) -> Self {
        let ball = Ball { mass: self.ball.mass * factor, ..self.ball };
        Self { ball, ..*self }
    }

    /// The same point with the unknown of the precession counted from the ground or from the nut.
    pub(crate) fn counted(&self, from_ground: bool) -> Self {
        Self { from_ground, ..*self }
    }

    /// Precession `$p$` relative to the nut and absolute `$P/W$`, over relative speed.
    pub(crate) fn rates(&self, y: &Unknowns<D>) -> (D, D) {
        let (counted, nut) = (y[PRECESSION], self.nut_speed);
        // P = Ω_n + p W                                                   (R3)
        if self.from_ground { (counted - nut, counted) } else { (counted, counted + nut) }
    }

    /// The same point with its numbers turned into another scalar.
    pub(crate) fn map<E: Scalar>(&self, to: impl Fn(D) -> E) -> Scaled<E> {
        let vector = |v: &Vector3<D>| v.map(&to);
        let contact = |i: usize| {
            let Contact { site, normal, across } = &self.contacts[i];
            Contact { site: *site, normal: vector(normal), across: vector(across) }
        };
        Scaled {
            helix: Helix { radius: to(self.helix.radius), lead_angle: to(self.helix.lead_angle) },
            arc: to(self.arc),
            frame: BallFrame {
                turn: to(self.frame.turn),
                k: vector(&self.frame.k),
                n: vector(&self.frame.n),
            },
            contacts: [contact(0), contact(1), contact(2)],
            contact_angle: to(self.contact_angle),
            signed_friction: to(self.signed_friction),
            ball: Ball { radius: to(self.ball.radius), mass: to(self.ball.mass) },
            nut_speed: to(self.nut_speed),
            from_ground: self.from_ground,
        }
    }

    /// Motion of the ball relative to the nut: precession, and `u`, `τ` from the slip at A.
    fn relative_motion(&self, y: &Unknowns<D>) -> Result<Motion<D>, EvalError> {
        let (p, rate) = self.rates(y);
        let (precession, slip) = (rate, y[SLIP]);
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        if precession.re() == 0.0 {
            return Err(DOES_NOT_CIRCLE);
        }
        // u = −λ cosθ,  τ = λ sinθ − p d/r_b                              (R4)
        let u = -slip * cos;
        let tau = slip * sin - p * self.arc;
        // σ = s r_b F_a / (I P)                                           (R5)
        let sigma = y[SPIN] / (self.ball.inertia() * precession);
        // ω − Ω_n k = W u t + σ N + W τ e_x                               (R6)
        let omega = Vector3::new(u, sigma, tau);
        Ok(Motion { precession: p, omega })
    }

    /// Motion, slip and wrenches of a set of unknowns.
    ///
    /// # Errors
    ///
    /// [`EvalError`] where friction or the gyroscopic moment has no direction.
    pub(crate) fn state(&self, y: &Unknowns<D>) -> Result<State<D>, EvalError> {
        let to_nut = self.relative_motion(y)?;
        let precession = self.rates(y).1;
        let to_screw = to_nut.relative_to(D::from(1.0), &self.frame);
        let point = |i: usize| self.contacts[i].point(self.ball.radius);
        let points = [point(0), point(1), point(2)];

        // V_A = W r_b λ (cosθ e_x + sinθ t), friction against it whatever the size of λ  (R7)
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        let along = self.contacts[0].across * cos + BallFrame::tangent() * sin;
        let slip = [
            along * y[SLIP],
            to_nut.slip_velocity(self.arc, &points[1]),
            to_screw.slip_velocity(self.arc, &points[2]),
        ];
        let law = Coulomb(self.signed_friction);
        let friction = [
            against(&along, self.signed_friction * y[NUT_LOAD]),
            friction_force(&law, y[MINOR_LOAD], &slip[1])?,
            friction_force(&law, y[SCREW_LOAD], &slip[2])?,
        ];
        let loads = [y[NUT_LOAD], y[MINOR_LOAD], y[SCREW_LOAD]];
        let wrench = |i: usize| {
            Wrench::at_contact(&self.contacts[i].normal, &points[i], loads[i], &friction[i])
        };
        Ok(State { to_nut, precession, slip, wrench: [wrench(0), wrench(1), wrench(2)] })
    }

    /// The seven equations (R8): force and moment balance in (t, N, e_x), axial load.
    ///
    /// # Errors
    ///
    /// As [`state`](Self::state).
    pub(crate) fn residual(&self, y: &Unknowns<D>) -> Result<Unknowns<D>, EvalError> {
        cost::evaluated();
        // Looked at where it is: of jets it is two kilobytes.
        let state = self.state(y);
        let state = state.as_ref().map_err(|error| *error)?;
        let [a, minor, b] = &state.wrench;
        let nut = *a + *minor;
        // The speed of the nut, along k, has no gyroscopic moment but for its rounding.
        let motion = Motion { precession: state.precession, ..state.to_nut };
        let left = newton_euler(&(nut + *b), &self.ball, self.helix.radius, &motion, &self.frame);
        // Σ F − m r_m P² n = 0,  Σ M − P k × Iω = 0,  F_nut·k − F_a = 0   (R8)
        Ok(ball_unknowns::rows(&left, axial_force(&nut.force, &self.frame) - 1.0).into())
    }
}

impl Scaled<f64> {
    /// `$\mu = m r_m W^2/F_a$` (R9), the size of the inertia forces.
    pub(crate) fn inertia_ratio(&self) -> f64 {
        // μ = m r_m W² / F_a                                              (R9)
        self.ball.mass * self.helix.radius
    }

    /// Weights of the equations (R10).
    ///
    /// The unit of force is the larger of axial load and inertia force. The moment about the
    /// normal consists of inertia-sized terms only, and alone tells the slip at A: its unit is
    /// `normal_moment`, see [`FirstOrder`](super::FirstOrder).
    pub(crate) fn weights(&self, normal_moment: f64) -> [f64; BALL] {
        // D_F = diag(w, w, w, w, 1/M_N, w, w),  w = 1/max(1, μ)           (R10)
        let mut weights = [weight(self.inertia_ratio().max(1.0)); BALL];
        weights[MOMENT_NORMAL] = weight(normal_moment);
        weights
    }

    /// Weights of the equations by the size of their terms at a root (R44), for inertia forces that may
    /// be anything against the load.
    pub(crate) fn own_weights(&self, y: &Unknowns<f64>) -> [f64; BALL] {
        let (p, rate) = self.rates(y);
        let (p, rate, inertia) = (p.abs(), rate.abs(), self.inertia_ratio());
        // U = max(1, μ(P/W)²),  M = max(U, I |P/W| (|λ| + |p| d/r_b))     (R44)
        let force = (inertia * rate * rate).max(1.0);
        let moment = (self.ball.inertia() * rate * (y[SLIP].abs() + p * self.arc)).max(force);
        // M_N = μ |P/W| (|p| + f |P/W|)                                   (R44)
        let normal = inertia * rate * (p + self.friction() * rate);
        // D_F = diag(1/U, 1/U, 1/U, 1/M, 1/M_N, 1/M, 1/U)                 (R44)
        let [u, m, n] = [force, moment, normal].map(weight);
        [u, u, u, m, n, m, u]
    }

    /// The same point with another lead angle.
    pub(crate) fn with_lead_angle<D: Scalar>(&self, lead_angle: D) -> Scaled<D> {
        let helix = Helix { radius: D::from(self.helix.radius), lead_angle };
        Scaled::new(
            helix,
            D::from(self.contact_angle),
            D::from(self.signed_friction),
            D::from(self.ball.mass),
            D::from(self.nut_speed),
        )
    }

    /// The same point as constants of another scalar.
    pub(crate) fn lift<D: Scalar>(&self) -> Scaled<D> {
        self.map(D::from)
    }
}

impl Equations<BALL> for Scaled<f64> {
    fn residual(&self, x: &[f64; BALL]) -> Result<[f64; BALL], EvalError> {
        Ok(Scaled::residual(self, &Unknowns::from(*x))?.into())
    }

    fn linearize(&self, x: &[f64; BALL]) -> Result<Linear<BALL>, EvalError> {
        linear(x, |x| Ok(self.lift().residual(&Unknowns::from(*x))?.into()))
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}

/// The existence limit as a system: slip at A zero, lead angle unknown in its place [`SLIP`]
/// (R11).
pub(crate) struct ExistenceLimit<'a>(pub(crate) &'a Scaled<f64>);

impl ExistenceLimit<'_> {
    fn residual_at<D: Scalar>(&self, x: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        // λ = 0, α unknown                                                (R11)
        let mut y = Unknowns::from(*x);
        y[SLIP] = D::from(0.0);
        Ok(self.0.with_lead_angle(x[SLIP]).residual(&y)?.into())
    }
}

equations!(ExistenceLimit<'_>, BALL, ExistenceLimit::residual_at, ROWS);

#[cfg(test)]
mod tests {
    use bsm_newton::{Options, Scales, Workspace, solve};
    use num_dual::jacobian;
    use proptest::prelude::*;

    use bsm_kin::Jet;

    use super::super::first_order::FirstOrder;
    use super::*;

    fn case(lead: f64, contact: f64, friction: f64, mass: f64, nut: f64) -> Scaled<f64> {
        let helix = Helix { radius: 5.56, lead_angle: lead };
        Scaled::new(helix, contact, friction, mass, nut)
    }

    proptest! {
        /// Jets against central differences and num-dual, at points off the root. The spin must
        /// dominate at A': where the slip there passes near zero, differences are no measure.
        #[test]
        fn jacobian_matches_differences(
            lead in 0.1..0.7_f64, contact in 0.4..1.2_f64, friction in 0.01..0.1_f64,
            log_mass in -5.0..-1.5_f64, nut in 0.0..1.5_f64, back in any::<bool>(),
            shift in proptest::array::uniform7(-0.05..0.05_f64),
        ) {
            let sign = if back { -1.0 } else { 1.0 };
            let case = case(lead, contact, friction * sign, 10.0_f64.powf(log_mass), nut);
            let mut y = FirstOrder::of(&case).unknowns();
            prop_assume!(y.iter().all(|v| v.is_finite()) && y[PRECESSION].abs() > 0.1);
            for (y, s) in y.iter_mut().zip(shift) {
                *y += s;
            }
            prop_assume!((nut + y[PRECESSION]).abs() > 0.2);
            // The direction of friction turns with the third power of one over the slip.
            let slip = case.state(&y).expect("in the domain").slip;
            prop_assume!(slip[1..].iter().all(|slip| slip.norm() > 0.1));
            let exact = jacobian(|y| case.lift().residual(&y), &y).expect("in the domain").1;
            let variables = Unknowns::from_fn(|i, _| Jet::<BALL>::variable(y[i], i));
            let jets = case.lift().residual(&variables).expect("in the domain");
            // Truncation h²/6 F''' with F''' up to 1e4, rounding 1e-16/h.
            for j in 0..BALL {
                // That of the spin is the spin times the inertia (R5): a step of 1e-4 in the spin.
                let h = if j == SPIN { 1e-4 * case.ball.inertia() } else { 1e-6 };
                let at = |step: f64| {
                    let mut moved = y;
                    moved[j] += step;
                    case.residual(&moved).expect("in the domain")
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                let scale = 1.0 + exact.norm();
                prop_assert!((difference - exact.column(j)).norm() <= 1e-6 * scale, "{j}");
                for i in 0..BALL {
                    // Rounding of the same operations in another order.
                    prop_assert!((jets[i].eps[j] - exact[(i, j)]).abs() <= 1e-12 * scale);
                }
            }
        }
    }

    /// The tail of the iteration is quadratic, which only an exact Jacobian gives.
    #[test]
    fn newton_converges_quadratically() {
        let case = case(0.3, 0.7, 0.08, 0.02, 0.0);
        let mut y = FirstOrder::of(&case).unknowns();
        y[SLIP_ANGLE] += 0.1;
        let weights = case.weights(FirstOrder::of(&case).normal_moment());
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        let options = Options { residual_goal: 1e-14, ..Options::default() };
        let report = solve(&case, &mut y.data.0[0], &scales, &options, &mut Workspace::default());
        assert!(report.converged(), "{report}");
        let small: Vec<f64> =
            report.steps.iter().map(|s| s.residual).filter(|r| (1e-6..1e-1).contains(r)).collect();
        assert!(small.len() >= 2, "{report}");
        for pair in small.windows(2) {
            // The constant of the quadratic tail, about 10 here.
            assert!(pair[1] <= 100.0 * pair[0].powi(2), "{report}");
        }
    }

    /// The triad turned to the normal keeps the large terms out of the small row: with loads of
    /// order one and an inertia of 1e-12, the moment about the normal is of order 1e-12.
    #[test]
    fn the_normal_moment_is_inertia_sized() {
        let case = case(0.3, 0.7, 0.08, 1e-12, 0.0);
        let r = case.residual(&FirstOrder::of(&case).unknowns()).expect("in the domain");
        // First order cancels it; the rest is of second order or rounding of 1e-12.
        assert!(r[MOMENT_NORMAL].abs() <= 1e-20, "{r}");
    }
}
