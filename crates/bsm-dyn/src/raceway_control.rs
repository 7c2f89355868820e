//! Raceway control: elastic contacts without friction in the balance, rolling kinematics, and
//! friction power from the slip that is left.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W1) to (W9).

use std::num::NonZeroUsize;

use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Scalar, Site};
use bsm_newton::{EvalError, MatMut, Options, Scales, System, Workspace, solve};
use nalgebra::Vector3;

use crate::balance::{Ball, Power, efficiency, ideal_torque};
use crate::ellipse::{Ellipse, Quadrature, pressed_radius};
use crate::hertz::{Groove, Hertz, Material, Member, contact_modulus};
use crate::jacobian::linearize;
use crate::jones::{Displacement, Jones, Side};
use crate::{Direction, Load, Model, Outputs, Reason, Solution, Status};

/// Unknowns of the static balance: X, R and the displacement of the nut.
const STATIC: usize = 3;

/// Order of the quadrature over the ellipse. A finer one moves the efficiency by 1e-6 to 1e-5 (see
/// the tests), which is far below what the model leaves out.
const ORDER: NonZeroUsize = NonZeroUsize::new(8).expect("not zero");

/// Creep speed of (E4) over `$r_b |W|$`, small against the slip that the lead leaves, `$\sin\alpha/2$`.
const CREEP: f64 = 1e-4;

/// The race at which the ball does not spin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// The nut.
    Nut,
    /// The screw.
    Screw,
}

/// Inputs of the raceway-control model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacewayControl {
    /// Helix of the ball centres.
    pub helix: Helix<f64>,
    /// Unloaded contact angle `$\beta_0$` \[rad\], in (0, π/2).
    pub contact_angle: f64,
    /// The ball.
    pub ball: Ball<f64>,
    /// Conformities of nut and screw, groove radius over ball diameter, above 1/2.
    pub conformity: (f64, f64),
    /// Elastic constants of races and ball.
    pub material: (Material, Material),
    /// Coulomb friction coefficient `$f \ge 0$`.
    pub friction: f64,
    /// Speeds of screw and nut.
    pub drive: Drive<f64>,
    /// Load on the balls.
    pub load: Load,
    /// The controlling race; `None` decides by (W7).
    pub control: Option<Control>,
}

/// Memory of the solves.
pub struct RacewayWorkspace {
    newton: Workspace,
    quadrature: Quadrature,
}

impl Default for RacewayWorkspace {
    fn default() -> Self {
        Self { newton: Workspace::new(STATIC), quadrature: Quadrature::new(ORDER) }
    }
}

/// Rolling motion relative to the nut over the relative speed: `$p$` and the angular velocity in
/// `$(t, n, b)$` (W3) to (W6).
///
/// Both contact centres roll along the groove; across it, the slip of the lead is shared equally.
///
/// * `size`: `$r_b/r_m$`.
fn rolling<D: Scalar>(
    control: Control,
    lead_angle: D,
    size: D,
    nut_angle: D,
    screw_angle: D,
) -> (D, Vector3<D>) {
    let (sin_a, cos_a) = lead_angle.sin_cos();
    let (sin_n, cos_n) = nut_angle.sin_cos();
    let (sin_s, cos_s) = screw_angle.sin_cos();
    let between = cos_n * cos_s + sin_n * sin_s;
    // Radius of the ball over arc length per radian, r_b/d.
    let lever = size * cos_a;
    // ω'_t = W sinα / 2                                                   (W3)
    let along = sin_a * 0.5;
    let one = D::from(1.0);
    match control {
        Control::Nut => {
            // p = (1 − (r_b/d) cosα cosβ_B) / (1 + cos(β_A − β_B))        (W4)
            let p = (one - lever * cos_a * cos_s) / (one + between);
            // (ω'_n, ω'_b) = −p (d/r_b) (−sinβ_A, cosβ_A)                 (W5)
            let rate = -p / lever;
            (p, Vector3::new(along, -rate * sin_n, rate * cos_n))
        }
        Control::Screw => {
            let p = (between - lever * cos_a * cos_n) / (one + between);
            // (ω'_n, ω'_b − cosα) = (p − 1)(d/r_b) (−sinβ_B, cosβ_B)      (W6)
            let rate = (p - one) / lever;
            (p, Vector3::new(along, -rate * sin_s, rate * cos_s + cos_a))
        }
    }
}

/// Static balance of the ball in the normal plane.
struct Balance {
    jones: Jones<f64>,
    stiffness: (f64, f64),
    cos_lead: f64,
    lead_angle: f64,
    size: f64,
    /// Axial load per ball \[N\].
    load: f64,
    /// Unit of displacement \[m\].
    unit: f64,
    control: Control,
    /// `$m r_m W^2$` \[N\].
    centrifugal: f64,
    /// Nut speed over relative speed.
    nut_speed: f64,
}

/// Loads and sides that belong to a set of unknowns.
struct Contacts<D> {
    nut: (Side<D>, D),
    screw: (Side<D>, D),
    rate: D,
}

impl Balance {
    fn contacts<D: Scalar>(&self, x: &[D; STATIC]) -> Result<Contacts<D>, EvalError> {
        let jones = Jones {
            nut_offset: D::from(self.jones.nut_offset),
            screw_offset: D::from(self.jones.screw_offset),
            contact_angle: D::from(self.jones.contact_angle),
        };
        let [axial, radial, nut] = x.map(|x| x * self.unit);
        let (a, b) = jones.sides(&Displacement { axial, radial, nut })?;
        let load = |side: &Side<D>, stiffness: f64| {
            if side.approach.re() > 0.0 {
                // Q = K_H δ^{3/2}, Eq (H9)                                (W1)
                Ok(side.approach * side.approach.sqrt() * stiffness)
            } else {
                Err(EvalError {
                    quantity: "elastic approach of a loaded contact [m]",
                    value: side.approach.re(),
                    requirement: "positive: the contact is lost",
                })
            }
        };
        let (lead, size) = (D::from(self.lead_angle), D::from(self.size));
        let (p, _) = rolling(self.control, lead, size, a.angle, b.angle);
        let (q_a, q_b) = (load(&a, self.stiffness.0)?, load(&b, self.stiffness.1)?);
        Ok(Contacts { nut: (a, q_a), screw: (b, q_b), rate: p + self.nut_speed })
    }

    fn equations<D: Scalar>(&self, x: &[D; STATIC]) -> Result<[D; STATIC], EvalError> {
        let Contacts { nut: (a, q_a), screw: (b, q_b), rate } = self.contacts(x)?;
        let ((sin_a, cos_a), (sin_b, cos_b)) = (a.angle.sin_cos(), b.angle.sin_cos());
        let unit = self.load.recip();
        // Q_A cosβ_A − Q_B cosβ_B = m r_m P²,  Q_A sinβ_A = Q_B sinβ_B,
        // Q_A sinβ_A cosα = F_a                                           (W2)
        Ok([
            (q_a * cos_a - q_b * cos_b - rate.square() * self.centrifugal) * unit,
            (q_a * sin_a - q_b * sin_b) * unit,
            q_a * sin_a * (self.cos_lead * unit) - 1.0,
        ])
    }
}

impl System for Balance {
    fn dim(&self) -> usize {
        STATIC
    }

    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&self.equations(&[x[0], x[1], x[2]])?);
        Ok(())
    }

    fn linearize(&self, x: &[f64], r: &mut [f64], jac: MatMut<'_, f64>) -> Result<(), EvalError> {
        linearize(|x| self.equations(&x), x, r, jac)
    }

    fn equation(&self, i: usize) -> String {
        let names = ["radial force balance", "axial force balance of the ball", "axial load"];
        names[i].to_owned()
    }
}

impl RacewayControl {
    /// Solves for loads and contact angles, takes the rolling motion, and integrates the friction
    /// power of the slip that it leaves.
    pub fn solve(&self, memory: &mut RacewayWorkspace) -> Solution {
        match self.outputs(memory) {
            Ok(outputs) => Solution::converged(Model::RacewayControl, outputs),
            Err((status, reason)) => Solution::failed(Model::RacewayControl, status, reason),
        }
    }

    fn grooves(&self) -> [Groove; 2] {
        [
            Groove { member: Member::Nut, conformity: self.conformity.0 },
            Groove { member: Member::Screw, conformity: self.conformity.1 },
        ]
    }

    fn hertz(&self) -> Result<[Hertz; 2], Reason> {
        let modulus = contact_modulus(&self.material.0, &self.material.1);
        let contact = |groove: Groove| {
            let (r_m, r_b) = (self.helix.radius, self.ball.radius);
            let (lead, beta) = (self.helix.lead_angle, self.contact_angle);
            Hertz::of(&groove.curvatures(r_m, r_b, lead, beta), modulus)
        };
        let [nut, screw] = self.grooves();
        Ok([contact(nut)?, contact(screw)?])
    }

    fn outputs(&self, memory: &mut RacewayWorkspace) -> Result<Outputs, (Status, Reason)> {
        let speed = self.drive.relative_speed();
        let direction =
            Direction::of(speed).ok_or((Status::InvalidInput, Reason::NoRelativeSpeed))?;
        let hertz = self.hertz().map_err(|reason| (Status::InvalidInput, reason))?;
        let r_b = self.ball.radius;
        let [nut_groove, screw_groove] = self.grooves();
        let (sin_0, cos_0) = self.contact_angle.sin_cos();
        let per_ball = self.load.per_ball();

        // Start: the approaches of the unloaded angle, along it.
        let load_0 = per_ball / (self.helix.lead_angle.cos() * sin_0);
        let [nut_0, screw_0] = hertz.map(|h| (load_0 / h.stiffness).powf(2.0 / 3.0));
        let mut balance = Balance {
            jones: Jones {
                nut_offset: nut_groove.offset(r_b),
                screw_offset: screw_groove.offset(r_b),
                contact_angle: self.contact_angle,
            },
            stiffness: (hertz[0].stiffness, hertz[1].stiffness),
            cos_lead: self.helix.lead_angle.cos(),
            lead_angle: self.helix.lead_angle,
            size: r_b / self.helix.radius,
            load: per_ball,
            unit: nut_0 + screw_0,
            control: self.control.unwrap_or(Control::Nut),
            centrifugal: self.ball.mass * self.helix.radius * speed * speed,
            nut_speed: self.drive.nut_speed / speed,
        };
        let unit = balance.unit;
        let mut x = [nut_0 * sin_0 / unit, nut_0 * cos_0 / unit, 1.0 / sin_0];
        let mut steps = solve_static(&balance, &mut x, memory)?;
        let decided = control_of(&balance, &x, &hertz).map_err(refused)?;
        if self.control.is_none() && decided == Control::Screw {
            balance.control = Control::Screw;
            steps.0 += solve_static(&balance, &mut x, memory)?.0;
        }
        let contacts = balance.contacts(&x).map_err(refused)?;
        let mut outputs = self.describe(&balance, &contacts, &hertz, direction, memory);
        outputs.axial_displacement = Some(x[2] * unit);
        outputs.iterations = Some(steps.0);
        outputs.residual_norm = Some(steps.1);
        Ok(outputs)
    }

    fn describe(
        &self,
        balance: &Balance,
        contacts: &Contacts<f64>,
        hertz: &[Hertz; 2],
        direction: Direction,
        memory: &RacewayWorkspace,
    ) -> Outputs {
        let speed = self.drive.relative_speed();
        let (r_b, r_m, lead) = (self.ball.radius, self.helix.radius, self.helix.lead_angle);
        let ((a, q_a), (b, q_b)) = (contacts.nut, contacts.screw);
        let (p, omega) = rolling(balance.control, lead, balance.size, a.angle, b.angle);

        let frame = BallFrame::turned(lead, 0.0);
        let to_nut = Motion { precession: p * speed, omega: omega * speed };
        let to_screw = to_nut.relative_to(speed, &frame);
        let motion = to_nut.relative_to(-self.drive.nut_speed, &frame);
        let sites = [
            (Contact::new(Site::Nut, a.angle, &frame), to_nut, q_a, self.conformity.0),
            (Contact::new(Site::Screw, b.angle, &frame), to_screw, q_b, self.conformity.1),
        ];
        let arc = self.helix.arc_length_per_radian();
        let mut friction_power = 0.0;
        let [nut_slip, screw_slip] =
            sites.map(|(contact, motion, ..)| motion.slip_velocity(arc, &contact.point(r_b)));
        for ((contact, motion, load, conformity), hertz) in sites.iter().zip(hertz) {
            let ellipse = Ellipse {
                contact: *contact,
                load: *load,
                semi_axes: hertz.semi_axes(*load),
                pressed_radius: pressed_radius(*conformity, r_b),
                ball_radius: r_b,
            };
            let creep = CREEP * r_b * speed.abs();
            friction_power +=
                ellipse.friction(motion, arc, self.friction, creep, &memory.quadrature).1;
        }
        friction_power *= self.load.balls;

        let ideal = ideal_torque(self.load.axial, r_m, lead);
        // T = T₀ + P_f/W                                                  (W8)
        let torque = ideal + friction_power / speed;
        let eta = efficiency(direction, ideal, torque);
        // G = I |P ω_n| / (f Q r_b)                                       (W9)
        let skid = self.ball.inertia() * (motion.precession * motion.omega.y).abs()
            / (self.friction * q_a.min(q_b) * r_b);
        let ((nut_a, nut_b), (screw_a, screw_b)) =
            (hertz[0].semi_axes(q_a), hertz[1].semi_axes(q_b));
        let mut outputs = Outputs {
            efficiency: Some(eta),
            screw_torque: Some(torque),
            nut_normal_load: Some(q_a),
            screw_normal_load: Some(q_b),
            nut_contact_angle: Some(a.angle),
            screw_contact_angle: Some(b.angle),
            nut_slip_angle: Some(sites[0].0.slip_angle(&nut_slip)),
            screw_slip_angle: Some(sites[1].0.slip_angle(&screw_slip)),
            nut_slip_velocity: Some(nut_slip.norm()),
            screw_slip_velocity: Some(screw_slip.norm()),
            nut_spin: Some(to_nut.spin(&sites[0].0)),
            screw_spin: Some(to_screw.spin(&sites[1].0)),
            precession: Some(motion.precession),
            omega_t: Some(motion.omega.x),
            omega_n: Some(motion.omega.y),
            omega_b: Some(motion.omega.z),
            nut_max_pressure: Some(hertz[0].max_pressure(q_a)),
            screw_max_pressure: Some(hertz[1].max_pressure(q_b)),
            nut_ellipse_a: Some(nut_a),
            nut_ellipse_b: Some(nut_b),
            screw_ellipse_a: Some(screw_a),
            screw_ellipse_b: Some(screw_b),
            nut_approach: Some(a.approach),
            screw_approach: Some(b.approach),
            self_locking: Some(eta <= 0.0),
            skid_number: Some(skid),
            ..Outputs::default()
        };
        outputs.set_power(&Power::transmitted(torque, ideal, speed));
        outputs
    }
}

/// The race with the larger spin friction moment, that of the nut weighted with the cosine of the
/// difference of the angles (W7).
///
/// Source: Harris and Kotzalas, *Advanced Concepts of Bearing Technology*, outer raceway control.
fn control_of(
    balance: &Balance,
    x: &[f64; STATIC],
    hertz: &[Hertz; 2],
) -> Result<Control, EvalError> {
    let Contacts { nut: (a, q_a), screw: (b, q_b), .. } = balance.contacts(x)?;
    let moment = |h: &Hertz, load: f64| load * h.semi_axes(load).0 * h.second_integral;
    // Q_A a_A E_A cos(β_A − β_B) > Q_B a_B E_B                            (W7)
    let nut = moment(&hertz[0], q_a) * (a.angle - b.angle).cos();
    Ok(if nut > moment(&hertz[1], q_b) { Control::Nut } else { Control::Screw })
}

/// Newton on the static balance; steps and residual.
fn solve_static(
    balance: &Balance,
    x: &mut [f64; STATIC],
    memory: &mut RacewayWorkspace,
) -> Result<(usize, f64), (Status, Reason)> {
    let ones = [1.0; STATIC];
    let scales = Scales { x: &ones, f: &ones };
    let options = Options { residual_goal: 1e-13, ..Options::default() };
    let report = solve(balance, x, &scales, &options, &mut memory.newton)
        .expect("sizes are constant and the weights positive");
    if report.converged() {
        return Ok((report.steps.len(), report.residual));
    }
    Err((Status::NotConverged, Reason::from(report)))
}

fn refused(error: EvalError) -> (Status, Reason) {
    (Status::NotConverged, Reason::Refused { error })
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

    fn lin(axial: f64, rpm: f64) -> RacewayControl {
        RacewayControl {
            helix: Helix { radius: 24.3e-3, lead_angle: 10.0_f64.to_radians() },
            contact_angle: 45.0_f64.to_radians(),
            ball: Ball::of_density(4.37e-3, 7800.0),
            conformity: (0.53, 0.53),
            material: (STEEL, STEEL),
            friction: 0.075,
            drive: Drive { screw_speed: rpm * std::f64::consts::PI / 30.0, nut_speed: 0.0 },
            load: Load { axial, balls: 1.0 },
            control: None,
        }
    }

    fn solved(case: &RacewayControl) -> Outputs {
        let solution = case.solve(&mut RacewayWorkspace::default());
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.reason);
        solution.outputs
    }

    /// Independent values of the efficiency under nut control, four digits.
    #[test]
    fn lin_screw_has_the_reference_efficiencies() {
        for (axial, eta) in [(2113.0, 0.9759), (100.0, 0.9805), (20.0, 0.9810)] {
            let case = RacewayControl { control: Some(Control::Nut), ..lin(axial, 2000.0) };
            let efficiency = solved(&case).efficiency.expect("efficiency");
            assert_relative_eq!(efficiency, eta, epsilon = 6e-5);
        }
    }

    /// The quadrature is fine enough: 2e-6 at Lin's load, 1.1e-5 at 5 kN, where the ellipse is larger.
    #[test]
    fn the_loss_does_not_depend_on_the_quadrature() {
        let fine = Quadrature::new(NonZeroUsize::new(48).expect("positive"));
        for (axial, rpm) in [(2113.0, 2000.0), (20.0, 500.0), (5000.0, -30.0)] {
            let eta = |quadrature: Quadrature| {
                let mut memory = RacewayWorkspace { quadrature, newton: Workspace::new(STATIC) };
                lin(axial, rpm).solve(&mut memory).outputs.efficiency.expect("efficiency")
            };
            let exact = eta(fine.clone());
            assert_relative_eq!(eta(Quadrature::new(ORDER)), exact, epsilon = 2e-5);
        }
    }

    /// The decision: close for Lin's equal conformities, clear for unequal ones.
    #[test]
    fn the_larger_spin_moment_controls() {
        let spins = |conformity| {
            let o = solved(&RacewayControl { conformity, ..lin(2113.0, 2000.0) });
            (o.nut_spin.expect("nut").abs(), o.screw_spin.expect("screw").abs())
        };
        // The closer groove has the longer ellipse, the larger moment, and holds the ball.
        let (nut, screw) = spins((0.51, 0.55));
        assert!(nut < 1e-9 * screw, "{nut} {screw}");
        let (nut, screw) = spins((0.55, 0.51));
        assert!(screw < 1e-9 * nut, "{nut} {screw}");
    }

    proptest! {
        /// Forces balance as printed, both centres roll, and one race has no spin.
        #[test]
        fn the_ball_is_in_balance_and_rolls(
            lead in 1.0..40.0_f64, beta in 30.0..60.0_f64, f_n in 0.51..0.56_f64, f_s in 0.51..0.56_f64,
            rpm in 10.0..5000.0_f64, axial in 50.0..2000.0_f64, back in any::<bool>(), nut in -0.9..0.9_f64,
        ) {
            let base = lin(axial, if back { -rpm } else { rpm });
            let speed = base.drive.screw_speed;
            let case = RacewayControl {
                helix: Helix { lead_angle: lead.to_radians(), ..base.helix },
                contact_angle: beta.to_radians(),
                conformity: (f_n, f_s),
                drive: Drive { screw_speed: speed, nut_speed: nut * speed },
                ..base
            };
            let o = solved(&case);
            let get = |x: Option<f64>| x.expect("raceway control has this output");
            let (q_a, q_b) = (get(o.nut_normal_load), get(o.screw_normal_load));
            let (a, b) = (get(o.nut_contact_angle), get(o.screw_contact_angle));
            let rate = get(o.precession);
            let centrifugal = case.ball.mass * case.helix.radius * rate * rate;
            prop_assert!((q_a * a.cos() - q_b * b.cos() - centrifugal).abs() <= 1e-9 * axial);
            prop_assert!((q_a * a.sin() - q_b * b.sin()).abs() <= 1e-9 * axial);
            prop_assert!((q_a * a.sin() * lead.to_radians().cos() - axial).abs() <= 1e-9 * axial);
            // Only the lead's slip across the groove is left, shared equally.
            let w = case.drive.relative_speed().abs();
            let shared = 0.5 * case.ball.radius * w * lead.to_radians().sin();
            prop_assert!((get(o.nut_slip_velocity) - shared).abs() <= 1e-9 * shared.max(w * 1e-3));
            prop_assert!((get(o.screw_slip_velocity) - shared).abs() <= 1e-9 * shared.max(w * 1e-3));
            let least = get(o.nut_spin).abs().min(get(o.screw_spin).abs());
            prop_assert!(least <= 1e-9 * w, "{o:?}");
            let eta = get(o.efficiency);
            prop_assert!(eta < 1.0, "{eta}");
        }
    }

    /// Limit: without friction nothing is lost.
    #[test]
    fn no_friction_means_no_loss() {
        let o = solved(&RacewayControl { friction: 0.0, ..lin(500.0, 2000.0) });
        assert_relative_eq!(o.efficiency.expect("efficiency"), 1.0);
    }

    /// Load raises the contact angles of a gothic arch; speed presses the ball against the nut.
    #[test]
    fn angles_follow_load_and_speed() {
        let angles = |axial, rpm| {
            let o = solved(&lin(axial, rpm));
            (o.nut_contact_angle.expect("nut"), o.screw_contact_angle.expect("screw"))
        };
        let (slow, loaded, fast) = (angles(100.0, 1.0), angles(2000.0, 1.0), angles(100.0, 8000.0));
        assert!(loaded.0 > slow.0 && loaded.1 > slow.1);
        assert!(fast.0 < slow.0 && fast.1 > slow.1);
        // Without inertia both angles are equal: two forces.
        assert_relative_eq!(slow.0, slow.1, max_relative = 1e-6);
    }

    /// Expected failures.
    #[test]
    fn failures_say_why() {
        let why = |case: &RacewayControl| {
            let solution = case.solve(&mut RacewayWorkspace::default());
            (solution.status, solution.reason.expect("a reason"))
        };
        let still = lin(100.0, 0.0);
        assert_eq!(why(&still), (Status::InvalidInput, Reason::NoRelativeSpeed));
        let open = RacewayControl { conformity: (5.0, 0.53), ..lin(100.0, 100.0) };
        let (status, reason) = why(&open);
        assert_eq!(status, Status::InvalidInput);
        assert!(matches!(reason, Reason::CurvaturesNotHertzian { .. }), "{reason:?}");
    }
}
