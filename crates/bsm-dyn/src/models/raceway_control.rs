//! Raceway control: a model with elastic contacts, a force balance without friction, and rolling
//! kinematics. The friction power is calculated from the slip that remains in the contacts during
//! pure rolling.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W1) to (W16).

mod balance;
mod ball;
mod direct;
mod rolling;
mod sensitivities;
mod statics;

use std::array::from_fn;

use bsm_kin::{Motion, Real, Scalar};

use self::balance::{Balance, StaticRoot};
pub use self::ball::RacewayBall;
pub use self::direct::{RollingMotion, RollingRoot};
pub(crate) use self::rolling::rolling;
pub(crate) use self::statics::STATIC_UNKNOWNS;
use crate::ellipse::{Placement, Quadrature};
use crate::models::ball::{
    BallLoads, Control, ControllingRaceway, ElasticContacts, ElasticPoint, LoadedContact, Model,
    SkidNumbers, Solution, SolveFailure, SolveInfo, SteadyState, Transmission, Workspace,
    domain_error,
};

/// Inputs of the raceway-control model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacewayControl<D = f64> {
    /// The screw at its operating point.
    pub screw: ElasticPoint<D>,
    /// The controlling raceway; `None` selects the raceway by criterion (W7).
    pub control: Option<Control>,
}

/// Reusable buffers for solving raceway-control models.
pub struct RacewayWorkspace {
    newton: Workspace<STATIC_UNKNOWNS>,
    /// Quadrature rule for results without derivatives.
    quadrature: Quadrature,
    /// Quadrature rule for derivatives.
    sensitivity_quadrature: Quadrature,
}

impl Default for RacewayWorkspace {
    fn default() -> Self {
        Self {
            newton: Workspace::default(),
            quadrature: Quadrature::of(RacewayControl::ACCURACY),
            sensitivity_quadrature: Quadrature::of(RacewayControl::SENSITIVITY_ACCURACY),
        }
    }
}

/// Returns the torque on the screw for rolling balls (W8) \[N·m\].
///
/// * `ideal`: torque of the frictionless screw \[N·m\].
/// * `friction_power`: scaled friction power, divided by `$W$`.
/// * `ball_radius`, `axial_load`: ball radius \[m\] and axial load of all balls \[N\].
#[inline(always)]
pub fn rolling_torque<F: Real>(ideal: F, friction_power: F, ball_radius: F, axial_load: F) -> F {
    // T = T₀ + P_f/W                                                      (W8)
    ideal + friction_power * ball_radius * axial_load
}

/// Loads, contact angles and motion of a rolling ball.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RollingBall {
    /// The controlling raceway.
    control: Control,
    /// Unknowns of the static balance.
    unknowns: [f64; STATIC_UNKNOWNS],
    /// Loads, contact angles and contacts.
    pub(crate) loaded: BallLoads<f64>,
    /// Motion relative to the nut, divided by `$W$`.
    pub(crate) to_nut: Motion<f64>,
    /// Number of Newton steps.
    pub(crate) steps: usize,
    /// Scaled residual of the static balance.
    residual: f64,
    /// True if Newton's method, started from equal contact angles, has shown that the ball has no
    /// other rolling motion.
    is_unique: bool,
}

impl RollingBall {
    /// Finds the first root of the static balance, and calculates the rolling motion of the ball
    /// for its controlling raceway.
    ///
    /// * `control`: controlling raceway; `None` selects the raceway by criterion (W7).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if there is no root on the flanks.
    pub(crate) fn of(
        contacts: &ElasticContacts,
        control: Option<Control>,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<Self, SolveFailure> {
        // First, Newton's method is started from equal contact angles.
        let direct = RollingRoot::direct(&contacts.into(), control, true);
        if direct.is_first_root {
            let control = if direct.by_nut { Control::Nut } else { Control::Screw };
            let ball = Self::at(&Balance::new(contacts, control), StaticRoot::from(&direct));
            return Ok(Self { is_unique: direct.unique, ..ball });
        }

        // If Newton's method fails from equal contact angles, the first root is found by
        // bracketing, either for the given raceway or for both raceways.
        match control {
            Some(raceway) => Self::controlled(contacts, raceway, newton),
            None => Self::selected(contacts, newton),
        }
    }

    /// Finds the state of the ball whose controlling raceway is selected by (W7). The selection
    /// uses the first root with nut control. If there is no root with nut control, the screw is the
    /// controlling raceway, provided that (W7) selects the screw at the first root with screw
    /// control.
    fn selected(
        contacts: &ElasticContacts,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<Self, SolveFailure> {
        let nut = Self::controlled(contacts, Control::Nut, newton);
        if let Ok(nut) = &nut
            && nut.is_consistent(contacts)
        {
            return Ok(*nut);
        }
        let screw = Self::controlled(contacts, Control::Screw, newton);
        match (nut, screw) {
            (Ok(nut), Ok(screw)) => Ok(Self { steps: nut.steps + screw.steps, ..screw }),
            (Err(_), Ok(screw)) if screw.is_consistent(contacts) => Ok(screw),
            (Ok(_), Err(failure)) | (Err(failure), _) => Err(failure),
        }
    }

    /// Finds the state of the ball at the first root for a given controlling raceway.
    fn controlled(
        contacts: &ElasticContacts,
        control: Control,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<Self, SolveFailure> {
        let balance = Balance::new(contacts, control);
        Ok(Self::at(&balance, balance.first_root(newton)?))
    }

    /// Creates the state of the ball from a root of the static balance.
    fn at(balance: &Balance<'_>, StaticRoot { unknowns, steps, residual }: StaticRoot) -> Self {
        let (loaded, control) = (balance.loaded(&unknowns), balance.control);
        let to_nut = balance.rolling(&loaded);
        Self { control, unknowns, loaded, to_nut, steps, residual, is_unique: false }
    }

    /// Returns the loaded contacts at the nut and the screw.
    fn sides(&self, contacts: &ElasticContacts) -> [LoadedContact<f64>; 2] {
        let BallLoads { loads, angles, .. } = &self.loaded;
        from_fn(|i| {
            let stiffness = (contacts.scaled.offsets[i], contacts.scaled.approaches[i]);
            LoadedContact::of(stiffness, loads[i], angles[i].sin_cos())
        })
    }

    /// Returns true if criterion (W7), evaluated for this ball, selects the raceway that was
    /// assumed to control the ball.
    fn is_consistent(&self, contacts: &ElasticContacts) -> bool {
        let excess = RacewayBall::from(contacts).nut_excess(&self.sides(contacts));
        (excess > 0.0) == (self.control == Control::Nut)
    }

    /// Finds other states of the ball that satisfy the same equations. These are states with the
    /// same controlling raceway and a larger difference between the contact angles. If both the
    /// nut-controlled and the screw-controlled ball satisfy (W7), the screw-controlled state is
    /// also included.
    fn alternatives(
        &self,
        contacts: &ElasticContacts,
        control: Option<Control>,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Vec<Self> {
        if self.is_unique {
            return Vec::new();
        }
        let same = Balance::new(contacts, self.control);
        let farther = same.farther_roots(&self.unknowns, newton);
        let mut alternatives: Vec<_> =
            farther.into_iter().map(|root| Self::at(&same, root)).collect();
        let decided =
            control.is_some() || self.control == Control::Screw || self.is_unambiguous(contacts);
        if !decided
            && let Ok(screw) = Self::controlled(contacts, Control::Screw, newton)
            && screw.is_consistent(contacts)
        {
            alternatives.push(screw);
        }
        alternatives
    }

    /// Returns true if (W7) selects the same raceway regardless of which raceway controls, and if
    /// no other roots exist.
    fn is_unambiguous(&self, contacts: &ElasticContacts) -> bool {
        let (ball, sides) = (RacewayBall::from(contacts), self.sides(contacts));
        Control::ALL.iter().all(|raceway| Balance::new(contacts, *raceway).is_unique())
            && ball.is_control_unambiguous(&sides, ball.nut_excess(&sides))
    }

    /// Estimates the state of the nut-controlled ball with an accuracy of two digits. An estimate
    /// is available even if the centrifugal force is too large for raceway control.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if a contact is lost.
    pub(crate) fn guess(contacts: &ElasticContacts) -> Result<Self, SolveFailure> {
        let balance = Balance::new(contacts, Control::Nut);
        let angle = contacts.contact_angle.sin_cos();
        let (p, _) = rolling(true, contacts.scaled.lead, contacts.scaled.arc, [angle; 2]);
        let [nut, screw, tilt] = contacts.static_balance(p + contacts.scaled.nut_speed);
        let loaded = contacts.loaded([nut, screw], tilt).map_err(domain_error)?;
        let (control, to_nut) = (balance.control, balance.rolling(&loaded));
        let (unknowns, residual) = ([f64::NAN; STATIC_UNKNOWNS], f64::INFINITY);
        Ok(Self { control, unknowns, loaded, to_nut, steps: 0, residual, is_unique: false })
    }

    /// Returns the skid numbers, information about the solve, and the controlling raceway.
    pub(crate) fn solve_info(
        &self,
        contacts: &ElasticContacts,
    ) -> (SkidNumbers, SolveInfo, ControllingRaceway) {
        let info = SolveInfo { steps: self.steps, residual: self.residual };
        (self.skid(contacts), info, ControllingRaceway { raceway: self.control, consistent: None })
    }

    /// Returns the skid number (W9) and the cross slip (W10).
    pub(crate) fn skid(&self, contacts: &ElasticContacts) -> SkidNumbers {
        let (ball, sides) = (&contacts.scaled, self.sides(contacts));
        let motion = RollingMotion::of(ball, self.control == Control::Nut, &sides);
        let [skid_number, cross_slip] = motion.skid_numbers(ball, contacts.friction, &sides);
        SkidNumbers::new(skid_number, cross_slip)
    }
}

impl RacewayControl {
    /// Accuracy of the quadrature over the contact ellipse (dimensionless). A finer quadrature rule
    /// changes the loss by up to 0.2 % and the efficiency by up to 4e-5 for 30 random screws (see
    /// the tests). Both changes are far below the model error.
    pub const ACCURACY: f64 = 1e-4;

    /// Accuracy of the quadrature for derivatives (dimensionless). Because the derivatives do not
    /// include the motion of the nodes, they have an error of up to 2e-3 of the loss with
    /// [`ACCURACY`](Self::ACCURACY), but of less than 1e-6 of the loss with this accuracy (see the
    /// tests).
    const SENSITIVITY_ACCURACY: f64 = 1e-10;

    /// Creep speed of (E4), divided by `$r_b |W|$`. The creep speed is small compared with the slip
    /// due to the lead, `$\sin\alpha/2$`.
    pub const CREEP: f64 = 1e-4;

    /// Solves for the loads and contact angles, calculates the rolling motion, and integrates the
    /// friction power over the contact ellipses.
    pub fn solve(&self, work: &mut RacewayWorkspace) -> Solution {
        let solved = self.screw.scaled().and_then(|contacts| {
            let rolling_ball = work.rolling_ball(&contacts, self.control)?;
            let solved = work.steady_state(&self.screw, &contacts, &rolling_ball)?;
            Ok(work.with_alternatives(&self.screw, &contacts, &rolling_ball, self.control, &solved))
        });
        Solution::new(Model::RacewayControl, solved)
    }
}

impl<D: Scalar> ElasticPoint<D> {
    /// Returns the torque of the frictionless screw and the torque on the screw \[N·m\], calculated
    /// from the scaled friction power divided by `$W$`.
    pub(crate) fn rolling_torques(&self, friction_power: D) -> (D, D) {
        let ideal = self.point.ideal_torque();
        let (radius, axial) = (self.point.ball.radius, self.point.load.axial);
        let torque = rolling_torque(ideal, friction_power, radius, axial);
        (ideal, torque)
    }

    /// Converts scaled powers (divided by `$W$`) to the powers of all balls \[W\].
    pub(crate) fn in_watts(&self, powers: [D; 2]) -> [D; 2] {
        let point = &self.point;
        powers.map(|p| p * point.ball.radius * point.load.axial * point.drive.relative_speed())
    }
}

impl RacewayWorkspace {
    /// Returns the loads, contact angles and motion of a rolling ball; see [`RollingBall::of`].
    pub(crate) fn rolling_ball(
        &mut self,
        contacts: &ElasticContacts,
        control: Option<Control>,
    ) -> Result<RollingBall, SolveFailure> {
        RollingBall::of(contacts, control, &mut self.newton)
    }

    /// Calculates the steady state of a rolling ball.
    ///
    /// # Errors
    ///
    /// Returns [`crate::Reason::BallLeavesFlank`] if a contact angle is beyond its flank.
    pub(crate) fn steady_state(
        &self,
        screw: &ElasticPoint,
        contacts: &ElasticContacts,
        rolling_ball: &RollingBall,
    ) -> Result<SteadyState, SolveFailure> {
        let (loaded, nodes) = (&rolling_ball.loaded, [Placement::from(&self.quadrature); 2]);
        let [at_nut, at_screw] =
            contacts.friction_powers(loaded, &rolling_ball.to_nut, RacewayControl::CREEP, nodes);
        let ball = screw.ball_state(contacts, loaded, &rolling_ball.to_nut, false)?;
        let (ideal, torque) = screw.rolling_torques(at_nut + at_screw);
        let speed = screw.point.drive.relative_speed();
        let transmission = Transmission::of(contacts.direction.is_back(), ideal, torque, speed);
        let (skid, info, control) = rolling_ball.solve_info(contacts);
        let (skid, info, control) = (Some(skid), Some(info), Some(control));
        let contact_power = Some(screw.in_watts([at_nut, at_screw]));
        Ok(SteadyState {
            skid,
            info,
            control,
            contact_power,
            ..SteadyState::new(&ball, transmission)
        })
    }

    /// Returns the steady state of a rolling ball with information about other solutions: the
    /// number of these solutions, and the efficiency that differs most from the efficiency of this
    /// steady state.
    pub(crate) fn with_alternatives(
        &mut self,
        screw: &ElasticPoint,
        contacts: &ElasticContacts,
        rolling_ball: &RollingBall,
        control: Option<Control>,
        solved: &SteadyState,
    ) -> SteadyState {
        let consistent = control.is_none().then(|| rolling_ball.is_consistent(contacts));
        let alternatives = rolling_ball.alternatives(contacts, control, &mut self.newton);
        let alternatives = alternatives
            .iter()
            .filter_map(|rolling_ball| self.steady_state(screw, contacts, rolling_ball).ok());
        let control = Some(ControllingRaceway { raceway: rolling_ball.control, consistent });
        SteadyState { control, ..solved.with_alternatives(alternatives) }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use bsm_kin::{Drive, Helix, Jet};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::extreme::random_extreme_screw;
    use crate::{
        Ball, Conformities, Coulomb, Load, Material, Materials, OperatingPoint, Reason, Status,
        solution::{ContactState, Slip},
    };

    /// Elastic constants of steel.
    const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

    fn lin_screw(axial: f64, rpm: f64) -> RacewayControl {
        let screw = ElasticPoint {
            point: OperatingPoint {
                helix: Helix { radius: 24.3e-3, lead_angle: 10.0_f64.to_radians() },
                contact_angle: 45.0_f64.to_radians(),
                ball: Ball::of_density(4.37e-3, 7800.0),
                friction: Coulomb(0.075),
                drive: Drive { screw_speed: rpm * std::f64::consts::PI / 30.0, nut_speed: 0.0 },
                load: Load { axial, balls: 1.0 },
            },
            conformity: Conformities::alike(0.53),
            material: Materials::alike(STEEL),
        };
        RacewayControl { screw, control: None }
    }

    fn solved(case: &RacewayControl) -> SteadyState {
        case.solve(&mut RacewayWorkspace::default()).result.expect("a solution")
    }

    fn slip(contact: ContactState) -> Slip {
        contact.slip.expect("a motion")
    }

    /// The reference efficiencies were calculated independently to four digits, with nut control.
    #[test]
    fn efficiencies_of_the_screw_of_lin_match_the_reference() {
        for (axial, eta) in [(2113.0, 0.9759), (100.0, 0.9805), (20.0, 0.9810)] {
            let case = RacewayControl { control: Some(Control::Nut), ..lin_screw(axial, 2000.0) };
            let efficiency = solved(&case).transmission.efficiency;
            assert_relative_eq!(efficiency, eta, epsilon = 6e-5);
        }
    }

    /// The quadrature error of the efficiency is 7e-7 at Lin's load, and 1.1e-5 at 5 kN, where the
    /// contact ellipse is larger.
    #[test]
    fn quadrature_error_of_the_efficiency_is_below_2e_5() {
        let fine = Quadrature::of(1e-12);
        for (axial, rpm) in [(2113.0, 2000.0), (20.0, 500.0), (5000.0, -30.0)] {
            let eta = |quadrature: Quadrature| {
                let mut work = RacewayWorkspace { quadrature, ..RacewayWorkspace::default() };
                lin_screw(axial, rpm).solve(&mut work).efficiency().expect("efficiency")
            };
            let exact = eta(fine.clone());
            let ours = eta(Quadrature::of(RacewayControl::ACCURACY));
            assert_relative_eq!(ours, exact, epsilon = 2e-5);
        }
    }

    /// Returns a feed screw whose lead angle is the variable of differentiation.
    fn feed_screw<D: Scalar>(lead_angle: D) -> RacewayControl<D> {
        let steel = Material { youngs_modulus: D::from(207e9), poisson_ratio: D::from(0.3) };
        let ball = Ball::<f64>::of_density(3.175e-3, 7800.0);
        let point = OperatingPoint {
            helix: Helix { radius: D::from(30e-3), lead_angle },
            contact_angle: D::from(45_f64.to_radians()),
            ball: Ball { radius: D::from(ball.radius), mass: D::from(ball.mass) },
            friction: Coulomb(D::from(0.06)),
            drive: Drive {
                screw_speed: D::from(-10.0 * std::f64::consts::PI),
                nut_speed: D::from(0.0),
            },
            load: Load { axial: D::from(8000.0), balls: D::from(70.0) },
        };
        let conformity = Conformities { nut: D::from(0.52), screw: D::from(0.53) };
        RacewayControl {
            screw: ElasticPoint { point, conformity, material: Materials::alike(steel) },
            control: None,
        }
    }

    /// In an earlier version, derivatives with the coarse quadrature rule had errors of up to 2e-3
    /// of the loss, because they did not include the motion of the nodes.
    #[test]
    fn efficiency_derivative_agrees_with_finite_differences() {
        let lead_angle = 4.1_f64.to_radians();
        let work = || RacewayWorkspace {
            quadrature: Quadrature::of(RacewayControl::SENSITIVITY_ACCURACY),
            ..RacewayWorkspace::default()
        };
        let efficiency =
            |angle: f64| feed_screw(angle).solve(&mut work()).efficiency().expect("a solution");
        let exact = feed_screw(Jet::<1>::variable(lead_angle, 0))
            .sensitivities(&mut RacewayWorkspace::default());
        let exact = exact.expect("a solution").efficiency.eps[0];
        // With a step of 1e-4, the curvature of the efficiency causes an error of 1e-8, rounding
        // causes an error of 1e-9, and the residual of the solution causes an error of less than
        // 1e-6.
        let step = 1e-4 * lead_angle;
        let difference =
            (efficiency(lead_angle + step) - efficiency(lead_angle - step)) / (2.0 * step);
        let loss = 1.0 - efficiency(lead_angle);
        assert!(
            lead_angle * (exact - difference).abs() < 1e-6 * loss,
            "{exact} {difference} {loss}"
        );
    }

    #[test]
    fn raceway_with_the_closer_conformity_is_the_controlling_raceway() {
        let spins = |conformity| {
            let screw = ElasticPoint { conformity, ..lin_screw(2113.0, 2000.0).screw };
            let o = solved(&RacewayControl { screw, control: None });
            (slip(o.ball.nut).spin.abs(), slip(o.ball.screw).spin.abs())
        };
        // The groove with the closer conformity has the longer ellipse and the larger spin moment.
        let (nut, screw) = spins(Conformities { nut: 0.51, screw: 0.55 });
        assert!(nut < 1e-9 * screw, "{nut} {screw}");
        let (nut, screw) = spins(Conformities { nut: 0.55, screw: 0.51 });
        assert!(screw < 1e-9 * nut, "{nut} {screw}");
    }

    proptest! {
        /// The forces in the result are in equilibrium, the ball rolls along the groove at both
        /// contact centers, and the spin at one raceway is zero.
        #[test]
        fn ball_is_in_equilibrium_and_rolls_at_both_contacts(
            lead in 1.0..40.0_f64, beta in 30.0..60.0_f64, f_n in 0.51..0.56_f64, f_s in 0.51..0.56_f64,
            rpm in 10.0..5000.0_f64, axial in 50.0..2000.0_f64, back in any::<bool>(), nut in -0.9..0.9_f64,
        ) {
            let base = lin_screw(axial, if back { -rpm } else { rpm }).screw;
            let speed = base.point.drive.screw_speed;
            let point = OperatingPoint {
                helix: Helix { lead_angle: lead.to_radians(), ..base.point.helix },
                contact_angle: beta.to_radians(),
                drive: Drive { screw_speed: speed, nut_speed: nut * speed },
                ..base.point
            };
            let case = ElasticPoint { point, conformity: Conformities { nut: f_n, screw: f_s }, ..base };
            let o = solved(&RacewayControl { screw: case, control: None });
            let [q_a, q_b] = [o.ball.nut, o.ball.screw].map(|c| c.load.expect("a load"));
            let (a, b) = (o.ball.nut.angle, o.ball.screw.angle);
            let rate = o.ball.motion.expect("a motion").precession;
            let centrifugal = case.point.ball.mass * case.point.helix.radius * rate * rate;
            prop_assert!((q_a * a.cos() - q_b * b.cos() - centrifugal).abs() <= 1e-9 * axial);
            prop_assert!((q_a * a.sin() - q_b * b.sin()).abs() <= 1e-9 * axial);
            prop_assert!((q_a * a.sin() * lead.to_radians().cos() - axial).abs() <= 1e-9 * axial);
            // Each contact has half of the slip due to the lead; there is no other slip at the
            // contact centers.
            let w = case.point.drive.relative_speed().abs();
            let shared = 0.5 * case.point.ball.radius * w * lead.to_radians().sin();
            prop_assert!((slip(o.ball.nut).speed - shared).abs() <= 1e-9 * shared.max(w * 1e-3));
            prop_assert!((slip(o.ball.screw).speed - shared).abs() <= 1e-9 * shared.max(w * 1e-3));
            let least = slip(o.ball.nut).spin.abs().min(slip(o.ball.screw).spin.abs());
            prop_assert!(least <= 1e-9 * w, "{o:?}");
            let eta = o.transmission.efficiency;
            prop_assert!(eta < 1.0, "{eta}");
        }
    }

    /// A screw without friction has an efficiency of one.
    #[test]
    fn screw_without_friction_has_no_loss() {
        let screw = ElasticPoint {
            point: OperatingPoint {
                friction: Coulomb(0.0),
                ..lin_screw(500.0, 2000.0).screw.point
            },
            ..lin_screw(500.0, 2000.0).screw
        };
        let o = solved(&RacewayControl { screw, control: None });
        assert_relative_eq!(o.transmission.efficiency, 1.0);
    }

    /// The centrifugal force presses the ball against the nut.
    #[test]
    fn load_increases_contact_angles_and_speed_increases_their_difference() {
        let angles = |axial, rpm| {
            let o = solved(&lin_screw(axial, rpm));
            (o.ball.nut.angle, o.ball.screw.angle)
        };
        let (slow, loaded, fast) = (angles(100.0, 1.0), angles(2000.0, 1.0), angles(100.0, 8000.0));
        assert!(loaded.0 > slow.0 && loaded.1 > slow.1);
        assert!(fast.0 < slow.0 && fast.1 > slow.1);
        // Without inertia, only two forces act on the ball, so both contact angles are equal.
        assert_relative_eq!(slow.0, slow.1, max_relative = 1e-6);
    }

    /// If the selection of the controlling raceway is clear, (W7) selects the same raceway for the
    /// nut-controlled ball and for the screw-controlled ball. If the two sides of (W7) are nearly
    /// equal, both balls or neither ball may satisfy it.
    #[test]
    fn clear_criterion_selects_the_same_raceway_for_nut_control_and_for_screw_control() {
        let mut rng = ChaCha8Rng::seed_from_u64(33);
        let mut newton = Workspace::default();
        let (mut solved, mut asked, mut both, mut neither, mut missed) = (0, 0, 0, 0, 0);
        while solved < 6000 {
            let mut screw = random_extreme_screw(&mut rng);
            // Every other point has equal conformities, for which the two sides of (W7) are nearly
            // equal.
            if solved % 2 == 0 {
                screw.conformity.screw = screw.conformity.nut;
            }
            let Ok(contacts) = screw.scaled() else { continue };
            let [nut, screw] = Control::ALL
                .map(|raceway| RollingBall::controlled(&contacts, raceway, &mut newton).ok());
            let (Some(nut), Some(screw)) = (nut, screw) else { continue };
            solved += 1;
            asked += usize::from(!nut.is_unambiguous(&contacts));
            let consistent = [nut.is_consistent(&contacts), screw.is_consistent(&contacts)];
            both += usize::from(consistent == [true; 2]);
            neither += usize::from(consistent == [false; 2]);
            missed += usize::from(consistent[0] == consistent[1] && nut.is_unambiguous(&contacts));
            let found = RollingBall::of(&contacts, None, &mut newton).expect("a ball");
            let alternatives = found.alternatives(&contacts, None, &mut newton);
            let of_screw = alternatives.iter().any(|other| other.control != found.control);
            assert_eq!(of_screw, consistent == [true; 2], "{contacts:?}");
        }
        println!(
            "points solved: {solved}, selection unclear: {asked}; (W7) satisfied by both balls: {both}, \
             by neither ball: {neither}; wrongly decided: {missed}"
        );
        assert_eq!(missed, 0);
        assert!(both + neither > 0, "criterion (W7) is unambiguous at all random points");
    }

    #[test]
    fn invalid_inputs_are_reported_with_their_reason() {
        let failure_of = |case: &RacewayControl| {
            let failure =
                case.solve(&mut RacewayWorkspace::default()).result.expect_err("no solution");
            (failure.status(), failure.reason().clone())
        };
        let still = lin_screw(100.0, 0.0);
        assert_eq!(failure_of(&still), (Status::InvalidInput, Reason::NoRelativeSpeed));
        let screw = ElasticPoint {
            conformity: Conformities { nut: 5.0, screw: 0.53 },
            ..lin_screw(100.0, 100.0).screw
        };
        let (status, reason) = failure_of(&RacewayControl { screw, control: None });
        assert_eq!(status, Status::InvalidInput);
        assert!(matches!(reason, Reason::CurvaturesNotHertzian { .. }), "{reason:?}");
    }
}
