//! A ball whose normal loads are given, on any number of contacts: its motion from its own balance.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U29) and (U30).

use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Scalar, Site};
use bsm_newton::{
    Backtracking, Continuation, Convergence, EvalError, Options, Report, Scales, Workspace, follow,
    solve,
};

use crate::contact::{Ball, Coulomb, Wrench, newton_euler};
use crate::ellipse::{ContactMotion, Ellipse, Integrate, Quadrature};
use crate::models::ball::{NoAnswer, Reason, equations};

/// A contact whose load is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrescribedContact {
    /// The body: [`Site::Nut`] or [`Site::Screw`].
    pub site: Site,
    /// Contact angle \[rad\]; negative on the flanks − of a gothic arch.
    pub angle: f64,
    /// Normal load \[N\].
    pub load: f64,
    /// Semi-axes across and along the groove \[m\].
    pub semi_axes: (f64, f64),
    /// Radius of the pressed surface \[m\] (E2).
    pub pressed_radius: f64,
}

/// A ball with given normal loads; friction moves no load. So moves a ball that its grooves hold
/// at more than two contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedBall {
    /// Helix of the ball centres.
    pub helix: Helix<f64>,
    /// The ball.
    pub ball: Ball<f64>,
    /// Speeds of screw and nut.
    pub drive: Drive<f64>,
    /// Friction, positive.
    pub friction: Coulomb<f64>,
    /// Creep speed over `$r_b |W|$`, positive.
    pub creep: f64,
    /// Its contacts.
    pub contacts: Vec<PrescribedContact>,
}

/// How a held ball moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallMotion {
    /// Motion relative to the nut, components in the Frenet-Serret triad.
    pub to_nut: Motion<f64>,
    /// Power that friction takes \[W\].
    pub power: f64,
    /// Friction torque on the screw \[N·m\], not negative.
    pub torque: f64,
}

/// Rate along the helix, then the angular velocity, all over `$|W|$`.
const UNKNOWNS: usize = 4;

const ROWS: [&str; UNKNOWNS] =
    ["force along t", "moment about t", "moment about n", "moment about b"];

/// The balance at a creep speed.
#[derive(Clone, Copy)]
struct PrescribedBalance<'a> {
    prescribed: &'a PrescribedBall,
    /// The sum of the loads \[N\].
    loads: f64,
    creep: f64,
    quadrature: &'a Quadrature,
}

impl PrescribedBall {
    /// The motion in which friction and inertia are in balance along the helix and about the centre
    /// (U29): without inertia the one of least friction power, and the only one.
    ///
    /// * `near`: the motion of a ball like it, to begin with.
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if screw and nut do not move against each other, or no balance is found.
    pub fn solve(
        &self,
        near: Option<&BallMotion>,
        quadrature: &Quadrature,
    ) -> Result<BallMotion, NoAnswer> {
        let speed = self.drive.relative_speed();
        let loads = self.contacts.iter().map(|contact| contact.load).sum::<f64>();
        if speed == 0.0 {
            return Err(NoAnswer::invalid(Reason::NoRelativeSpeed));
        }
        if loads <= 0.0 || self.friction.0 <= 0.0 {
            return Err(NoAnswer::invalid(Reason::Frictionless));
        }
        let balance = PrescribedBalance { prescribed: self, loads, creep: self.creep, quadrature };
        let mut work = Workspace::<UNKNOWNS>::default();
        let of_near =
            near.and_then(|BallMotion { to_nut: Motion { precession, omega }, .. }| {
                let mut y = [*precession, omega.x, omega.y, omega.z].map(|of| of / speed.abs());
                balance.run(&mut y, &mut work).converged().then_some(y)
            });
        let y = match of_near {
            Some(y) => y,
            None => balance.by_way_of_large_creep(&mut work)?,
        };
        let (to_nut, _, power) = balance.friction(&y);
        // T_f |W| = Σ P                                                   (U30)
        Ok(BallMotion { to_nut, power, torque: power / speed.abs() })
    }
}

impl PrescribedBalance<'_> {
    /// The balance by way of larger creep speeds.
    fn by_way_of_large_creep(
        &self,
        work: &mut Workspace<UNKNOWNS>,
    ) -> Result<[f64; UNKNOWNS], NoAnswer> {
        // Half the speed of the screw, and rolling about b: where the raceways of nut and screw move on
        // opposite sides of the ball.
        let around = self.prescribed.helix.arc_length_per_radian() / self.prescribed.ball.radius;
        let sign = self.prescribed.drive.relative_speed().signum();
        let mut y = [0.5 * sign, 0.0, -0.5 * sign * around, 0.0];
        // Against a creep speed far above all slip, friction is linear and the start does not matter.
        let begin = (10.0 * around).max(self.creep);
        let control = Continuation { first: 1.2, shortest: 0.05 };
        let mut failure = Reason::SearchLost;
        follow(&mut y, (begin.ln(), self.creep.ln()), control, |log, y| {
            let report = PrescribedBalance { creep: log.exp(), ..*self }.run(y, work);
            let converged = report.converged();
            if !converged {
                failure = Reason::from(report);
            }
            converged
        })
        .map_err(|_| NoAnswer::not_converged(failure))?;
        Ok(y)
    }

    fn run(&self, y: &mut [f64; UNKNOWNS], work: &mut Workspace<UNKNOWNS>) -> Report {
        let around = self.prescribed.helix.arc_length_per_radian() / self.prescribed.ball.radius;
        let x = [1.0, around.recip(), around.recip(), around.recip()];
        let f = [1.0; UNKNOWNS];
        let options = Options {
            convergence: Convergence { max_steps: 200, ..Convergence::default() },
            damping: Backtracking { max_halvings: 40 },
            ..Options::default()
        };
        solve(self, y, &Scales { x: &x, f: &f }, &options, work).report
    }

    /// Motion relative to the nut, wrench of all contacts on the ball, and the power of friction.
    fn friction<D: Integrate<f64>>(&self, y: &[D; UNKNOWNS]) -> (Motion<D>, Wrench<D>, f64) {
        let prescribed = self.prescribed;
        let speed = prescribed.drive.relative_speed().abs();
        let omega = nalgebra::Vector3::new(y[1], y[2], y[3]) * D::from(speed);
        let to_nut = Motion { precession: y[0] * speed, omega };
        let frame = self.frame_of::<D>();
        let to_screw = to_nut.relative_to(D::from(prescribed.drive.relative_speed()), &frame);
        let creep = self.creep * prescribed.ball.radius * speed;
        let arc = D::from(prescribed.helix.arc_length_per_radian());
        let (mut wrench, mut power) = (Wrench::zero(), 0.0);
        for contact in &prescribed.contacts {
            let motion = if contact.site == Site::Screw { &to_screw } else { &to_nut };
            let ellipse = Ellipse {
                contact: Contact::new(contact.site, D::from(contact.angle), &frame),
                load: D::from(contact.load),
                semi_axes: (D::from(contact.semi_axes.0), D::from(contact.semi_axes.1)),
                pressed_radius: contact.pressed_radius,
                ball_radius: prescribed.ball.radius,
            };
            let local = ContactMotion::of(motion, &ellipse.contact, arc);
            let (unit, lost) = D::integrate(&ellipse, &local, creep, self.quadrature.into());
            let sliding = prescribed.friction.0 * contact.load;
            wrench = wrench + unit.wrench(&ellipse.contact) * D::from(sliding);
            power += lost * sliding;
        }
        (to_nut, wrench, power)
    }

    fn frame_of<D: Scalar>(&self) -> BallFrame<D> {
        BallFrame::turned(D::from(self.prescribed.helix.lead_angle), D::from(0.0))
    }

    #[expect(clippy::unnecessary_wraps, reason = "the form that `equations!` takes")]
    fn residual<D: Integrate<f64>>(&self, y: &[D; UNKNOWNS]) -> Result<[D; UNKNOWNS], EvalError> {
        let prescribed = self.prescribed;
        let (to_nut, wrench, _) = self.friction(y);
        let frame = self.frame_of::<D>();
        let motion = to_nut.relative_to(D::from(-prescribed.drive.nut_speed), &frame);
        let ball =
            Ball { radius: D::from(prescribed.ball.radius), mass: D::from(prescribed.ball.mass) };
        // F·t = 0,  Σ M − P k × Iω = 0                                    (U29)
        let imbalance =
            newton_euler(&wrench, &ball, D::from(prescribed.helix.radius), &motion, &frame);
        let (force, lever_arm) =
            ((prescribed.friction.0 * self.loads).recip(), prescribed.ball.radius.recip());
        let moment = imbalance.moment * D::from(force * lever_arm);
        Ok([imbalance.force.x * force, moment.x, moment.y, moment.z])
    }
}

equations!(PrescribedBalance<'_>, UNKNOWNS, PrescribedBalance::residual, ROWS);

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::extreme::of_a_nut;
    use crate::models::traction::Traction;
    use crate::{ElasticPoint, TractionWorkspace, pressed_radius};

    /// A screw of 40 x 10 at 500 rpm under 100 N a ball.
    fn screw() -> ElasticPoint {
        of_a_nut(100.0, 1.0, 52.36)
    }

    fn prescribed(screw: &ElasticPoint, contacts: &[(Site, f64, f64)]) -> PrescribedBall {
        let hertz = screw.hertz().expect("Hertz contacts");
        let contact = |&(site, angle, load): &(Site, f64, f64)| {
            let (member, conformity) = match site {
                Site::Screw => (1, screw.conformity.1),
                Site::Nut | Site::NutUnloaded => (0, screw.conformity.0),
            };
            PrescribedContact {
                site,
                angle,
                load,
                semi_axes: hertz[member].semi_axes(load),
                pressed_radius: pressed_radius(conformity, screw.point.ball.radius),
            }
        };
        PrescribedBall {
            helix: screw.point.helix,
            ball: screw.point.ball,
            drive: screw.point.drive,
            friction: screw.point.friction,
            creep: Traction::<f64>::CREEP,
            contacts: contacts.iter().map(contact).collect(),
        }
    }

    /// With the loads and angles that traction finds, a ball on two contacts moves as it does there.
    #[test]
    fn two_contacts_are_model_traction() {
        let screw = screw();
        let traction = Traction { at: screw, accuracy: 1e-8, creep: Traction::<f64>::CREEP };
        let solution = traction.solve(&mut TractionWorkspace::default());
        let solved = solution.solved().expect("a solution");
        let [nut, on_screw] = [&solved.ball.nut, &solved.ball.screw];
        let load = |c: &crate::ContactState| c.load.expect("a load");
        let ball = prescribed(
            &screw,
            &[(Site::Nut, nut.angle, load(nut)), (Site::Screw, on_screw.angle, load(on_screw))],
        );
        let found = ball.solve(None, &Quadrature::of(1e-8)).expect("a motion");
        let power = solved.transmission.power.expect("a speed").dissipated;
        // Both rules are exact to 1e-8 of the friction; traction solves to 1e-10.
        assert_relative_eq!(found.power, power, max_relative = 1e-6);
        let rate = solved.ball.motion.expect("a motion").precession;
        assert_relative_eq!(found.to_nut.precession, rate, max_relative = 1e-6);
    }

    /// Turned the other way, a ball held alike on both flanks moves the other way with the same loss.
    #[test]
    fn four_equal_contacts_know_no_direction() {
        let mut screw = screw();
        // Without inertia: the gyroscopic moment knows a direction.
        screw.point.ball.mass = 1e-12;
        let angle = 45_f64.to_radians();
        let contacts = [
            (Site::Nut, angle, 80.0),
            (Site::Nut, -angle, 80.0),
            (Site::Screw, angle, 80.0),
            (Site::Screw, -angle, 80.0),
        ];
        let there =
            prescribed(&screw, &contacts).solve(None, &Quadrature::of(1e-6)).expect("a motion");
        screw.point.drive.screw_speed *= -1.0;
        let back =
            prescribed(&screw, &contacts).solve(None, &Quadrature::of(1e-6)).expect("a motion");
        // The balance ends at 1e-10 of the friction, the loss is flat about it.
        assert_relative_eq!(there.torque, back.torque, max_relative = 1e-8);
        // A ball on four contacts cannot roll on all: it loses several times what it does on two.
        let two = prescribed(&screw, &[contacts[0], contacts[2]]);
        let two = two.solve(None, &Quadrature::of(1e-6)).expect("a motion");
        assert!(there.torque > 2.5 * two.torque, "{} {}", there.torque, two.torque);
    }

    /// The motion is the one of least friction power: no other loses less.
    #[test]
    fn the_balance_is_the_least_power() {
        let mut screw = screw();
        screw.point.ball.mass = 1e-12;
        let angle = 44_f64.to_radians();
        let contacts = [
            (Site::Nut, angle, 120.0),
            (Site::Nut, -angle, 30.0),
            (Site::Screw, angle, 120.0),
            (Site::Screw, -angle, 30.0),
        ];
        let ball = prescribed(&screw, &contacts);
        let quadrature = Quadrature::of(1e-6);
        let found = ball.solve(None, &quadrature).expect("a motion");
        let balance = PrescribedBalance {
            prescribed: &ball,
            loads: 300.0,
            creep: ball.creep,
            quadrature: &quadrature,
        };
        let w = 52.36;
        let omega = found.to_nut.omega / w;
        let y = [found.to_nut.precession / w, omega.x, omega.y, omega.z];
        for i in 0..UNKNOWNS {
            for step in [-1e-2, 1e-2] {
                let mut z = y;
                z[i] += step;
                let (_, _, power) = balance.friction(&z);
                assert!(power > found.power, "{i} {step}: {power} {}", found.power);
            }
        }
    }

    /// The motion of another ball is a start and no more: the balance ends at 1e-10 of the friction from either.
    #[test]
    fn a_start_does_not_change_the_motion() {
        let screw = screw();
        let contacts = |more: f64| {
            [
                (Site::Nut, 0.78, 90.0 + more),
                (Site::Nut, -0.79, 60.0),
                (Site::Screw, 0.78, 90.0 + more),
                (Site::Screw, -0.79, 60.0),
            ]
        };
        let quadrature = Quadrature::of(1e-6);
        let [other, ball] = [0.0, 30.0].map(|more| prescribed(&screw, &contacts(more)));
        let other = other.solve(None, &quadrature).expect("a motion");
        let alone = ball.solve(None, &quadrature).expect("a motion");
        let begun = ball.solve(Some(&other), &quadrature).expect("a motion");
        assert_relative_eq!(alone.torque, begun.torque, max_relative = 1e-9);
        assert!((other.torque / alone.torque - 1.0).abs() > 0.01, "{other:?} {alone:?}");
    }

    #[test]
    fn a_ball_at_rest_or_without_friction_is_refused() {
        let mut screw = screw();
        let contacts = [(Site::Nut, 0.8, 80.0), (Site::Screw, 0.8, 80.0)];
        screw.point.friction = Coulomb(0.0);
        assert!(prescribed(&screw, &contacts).solve(None, &Quadrature::of(1e-4)).is_err());
        screw.point.friction = Coulomb(0.1);
        screw.point.drive.screw_speed = 0.0;
        assert!(prescribed(&screw, &contacts).solve(None, &Quadrature::of(1e-4)).is_err());
    }
}
