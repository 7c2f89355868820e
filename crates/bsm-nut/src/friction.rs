//! Friction of all balls, each at its own load in its own displaced grooves.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U21), (U29), (U30) and (U32).

use bsm_dyn::{
    Ball, Coulomb, ElasticPoint, Hertz, Load, OperatingPoint, PrescribedBall, PrescribedContact,
    Quadrature, Solution, Traction, pressed_radius,
};
use bsm_kin::{Drive, Site};

use crate::geometry::count;
use crate::{BallInGrooves, BallNut, Equilibrium};

/// Friction torque and power of a nut.
#[derive(Debug, Clone, PartialEq)]
pub struct NutFriction {
    /// Friction torque of each ball on the screw \[N·m\], not negative; if the model has no answer for a
    /// ball, of those before it.
    pub balls: Vec<f64>,
    /// Balls that both flanks press, whose friction is integrated over all their ellipses, whatever the
    /// model of the others.
    pub on_both_flanks: usize,
    /// Their torque \[N·m\].
    pub torque_on_both_flanks: f64,
    /// Sum over the balls \[N·m\]; `None` unless every ball has one.
    pub torque: Option<f64>,
    /// Torque of the ball returns \[N·m\]; `None` unless every ball has a motion.
    pub returns: Option<f64>,
    /// Torque on the screw that carries the axial force `$h F_a$` and drives against the friction of balls,
    /// returns and seals \[N·m\].
    pub drive_torque: Option<f64>,
    /// Power out over power in; `None` without an axial load.
    pub efficiency: Option<f64>,
    /// Friction power of balls, returns and seals \[W\].
    pub heat: Option<f64>,
}

/// Accuracy of the quadrature over the ellipses of a ball on both flanks: far below what a constant
/// friction coefficient is worth.
const FOUR_CONTACTS: f64 = 1e-6;

impl BallNut {
    /// The screw whose only ball is one of this nut (U21), with its own groove displacement and
    /// excess; `None` if the ball is loose or loaded on both flanks.
    ///
    /// * `number`: of the ball. * `friction`: coefficient. * `drive`: speeds of screw and nut.
    pub fn ball_alone(
        &self,
        found: &Equilibrium,
        number: usize,
        friction: f64,
        drive: &Drive<f64>,
    ) -> Option<ElasticPoint> {
        let ball = &found.balls[number];
        let plus = match ball.flanks_pressed() {
            [true, false] => true,
            [false, true] => false,
            _ => return None,
        };
        let excess = self.excess(number);
        let radius = self.ball.radius + excess;
        let scaled = |conformity: f64| conformity * self.ball.radius / radius;
        let conformity = (scaled(self.conformity.0), scaled(self.conformity.1));
        let share = self.equal_share(1.0);
        // (l_A0 + l_B0) cosβ₀ + w_n is the radial distance of the arc centres of this ball; its own
        // first touch is at (l_A0 + l_B0 − 2Δr) cosβ                      (U21)
        let first_touch = self.arc_distance();
        let radial = first_touch * self.contact_angle.cos() + found.grooves[number][1];
        let contact_angle = (radial / (first_touch - 2.0 * excess)).acos();
        // The far flank sees the drive the other way round.
        let way = if plus { 1.0 } else { -1.0 };
        let axial = ball.force[0].abs() * self.helix.lead_angle.cos();
        let mass = self.ball.mass * (radius / self.ball.radius).powi(3);
        Some(ElasticPoint {
            point: OperatingPoint {
                contact_angle,
                ball: Ball { radius, mass },
                friction: Coulomb(friction),
                drive: Drive {
                    screw_speed: drive.screw_speed * way,
                    nut_speed: drive.nut_speed * way,
                },
                load: Load { axial, balls: 1.0 },
                ..share.point
            },
            conformity,
            ..share
        })
    }

    /// The ball that both flanks press, with its loads as they are without friction (U29).
    fn ball_on_both_flanks(
        &self,
        found: &Equilibrium,
        number: usize,
        friction: f64,
        drive: &Drive<f64>,
        hertz: &[Hertz; 2],
    ) -> PrescribedBall {
        let ball = &found.balls[number];
        let contact = |c: usize| {
            let (site, conformity) = if c < 2 {
                (Site::Nut, self.conformity.0)
            } else {
                (Site::Screw, self.conformity.1)
            };
            let flank = [1.0, -1.0][c % 2];
            PrescribedContact {
                site,
                angle: flank * ball.angles[c],
                load: ball.loads[c],
                semi_axes: hertz[c / 2].semi_axes(ball.loads[c]),
                pressed_radius: pressed_radius(conformity, self.ball.radius),
            }
        };
        let pressed = (0..4).filter(|c| ball.loads[*c] > 0.0);
        PrescribedBall {
            helix: self.helix,
            ball: self.ball,
            drive: *drive,
            friction: Coulomb(friction),
            creep: Traction::<f64>::CREEP,
            contacts: pressed.map(contact).collect(),
        }
    }

    /// Friction of all balls by a model of one ball (U21): the sharing of the load is that without
    /// friction, which changes it by a few thousandths.
    ///
    /// A ball without an answer ends the sum: those after it are not solved. A ball like the one before it has its
    /// friction.
    ///
    /// * `friction`: coefficient; without one the model has another law, and a ball on both flanks no friction
    ///   that is known. * `solve`: the model, which may lose power in the ball returns. * `drive`: speeds;
    ///   friction needs a relative speed. * `seal_torque` \[N·m\].
    pub fn friction(
        &self,
        found: &Equilibrium,
        friction: Option<f64>,
        drive: &Drive<f64>,
        seal_torque: f64,
        mut solve: impl FnMut(ElasticPoint) -> Solution,
    ) -> NutFriction {
        let speed = drive.relative_speed();
        let per_radian = self.helix.lead() / std::f64::consts::TAU;
        let (quadrature, hertz) = (Quadrature::of(FOUR_CONTACTS), self.hertz());
        // Friction of a ball, and what it loses in the returns.
        let mut of_one = |number: usize| -> Option<[f64; 2]> {
            if found.balls[number].flanks_pressed() == [true, true] {
                let hertz = hertz.as_ref().ok()?;
                let ball = self.ball_on_both_flanks(found, number, friction?, drive, hertz);
                return ball.solve(&quadrature).ok().map(|motion| [motion.torque, 0.0]);
            }
            let coefficient = friction.unwrap_or(f64::NAN);
            let alone = self.ball_alone(found, number, coefficient, drive)?;
            let solution = solve(alone);
            let solved = solution.solved()?;
            let torque = solved.transmission.screw_torque?;
            let lost = solved.film.map_or(0.0, |film| film.outside.ball_return);
            let in_return = lost / speed.abs();
            // T_f = |T − h F|                                             (U21)
            let all = (torque - per_radian * alone.point.load.axial).abs();
            Some([all - in_return, in_return])
        };
        let mut returns = 0.0;
        let mut last: Option<(usize, [f64; 2])> = None;
        let mut of_ball = |number: usize| -> Option<f64> {
            if found.balls[number].max_load() <= 0.0 {
                return Some(0.0);
            }
            let before = last.filter(|(other, _)| self.alike(found, *other, number));
            let (as_of, [own, in_return]) = match before {
                None => (number, of_one(number)?),
                Some(like) => like,
            };
            last = Some((as_of, [own, in_return]));
            returns += in_return;
            Some(own)
        };
        let balls: Vec<_> = (0..found.balls.len()).map_while(&mut of_ball).collect();
        let all = balls.len() == found.balls.len();
        let torque = all.then(|| balls.iter().sum::<f64>());
        let returns = all.then_some(returns);
        let friction = torque.zip(returns).map(|(balls, returns)| balls + returns + seal_torque);
        let axial: f64 = found.bodies.iter().sum();
        let ideal = per_radian * axial;
        // T = h F_a + sign(W) (Σ T_f + T_return + T_seal)                 (U32)
        let drive_torque = friction.map(|torque| ideal + torque * speed.signum());
        // The load is moved if it resists the motion, else it drives.
        let efficiency = drive_torque
            .filter(|_| axial.abs() > f64::EPSILON * found.forces())
            .map(|torque| if ideal * speed > 0.0 { ideal / torque } else { torque / ideal });
        let heat = friction.map(|torque| torque * speed.abs());
        let on_both = |ball: &BallInGrooves| ball.flanks_pressed() == [true, true];
        let on_both_flanks = found.balls.iter().filter(|ball| on_both(ball)).count();
        let solved = found.balls.iter().zip(&balls).filter(|(ball, _)| on_both(ball));
        let torque_on_both_flanks = solved.fold(0.0, |sum, (_, torque)| sum + torque);
        NutFriction {
            balls,
            on_both_flanks,
            torque_on_both_flanks,
            torque,
            returns,
            drive_torque,
            efficiency,
            heat,
        }
    }
}

impl BallNut {
    /// True if two balls differ by no more than the rounding of their loads.
    fn alike(&self, found: &Equilibrium, one: usize, other: usize) -> bool {
        /// Part of load and contact angle: the balance of the nut leaves 1e-12 of the loads.
        const SAME: f64 = 1e-10;
        let near = |[a, b]: [f64; 2]| (a - b).abs() <= SAME * a.abs();
        let [a, b] = [one, other].map(|number| &found.balls[number]);
        (self.excess(one) - self.excess(other)).abs() <= 0.0
            && (0..4).all(|c| {
                near([a.loads[c], b.loads[c]])
                    && (a.loads[c] <= 0.0 || near([a.angles[c], b.angles[c]]))
            })
    }
}

impl Equilibrium {
    /// Sum of the sizes of the largest loads of all balls \[N\].
    fn forces(&self) -> f64 {
        self.max_load() * count(self.balls.len())
    }
}
