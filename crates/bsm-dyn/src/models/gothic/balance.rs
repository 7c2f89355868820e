//! Force and moment balance of a ball in gothic arches with friction at all loaded contacts,
//! generic over the scalar type.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC4) to (AC6).

use std::array::from_fn;
use std::cell::OnceCell;

use bsm_kin::{BallFrame, Contact, Motion, Over, Scalar};
use bsm_newton::{Equations, EvalError, Linearized, Options, Report, Scales, Workspace, solve};
use nalgebra::Vector3;

use super::grooves::{AxialCondition, FLANKS, FixedForces, FlankApproach, Grooves, PLACE, site};
use crate::contact::{Ball, Wrench, axial_force, magnitude, newton_euler};
use crate::ellipse::{
    Ellipse, FrozenRule, Integrate, Patch, Placement, Quadrature, contact_motion, dry_friction,
};
use crate::models::ball::ElasticPoint;
use crate::models::ball::linear;

/// Number of unknowns: position of ball and nut, precession rate, and angular velocity relative to
/// the nut.
pub(super) const UNKNOWNS: usize = PLACE + 4;

const ROWS: [&str; UNKNOWNS] = [
    "force along t",
    "force along n",
    "force along b",
    "moment about t",
    "moment about n",
    "moment about b",
    "axial position of the nut",
];

/// Maximum Newton steps: change of position divided by the approach, and relative change of the
/// motion.
const MAX_STEP: [f64; 2] = [0.5, 0.2];

/// Node counts of the quadrature at the four contacts, which stay fixed near a root.
#[derive(Default)]
pub(super) struct FrozenRules([OnceCell<FrozenRule>; FLANKS]);

/// Force and moment balance of a ball with friction. Forces are divided by a reference load,
/// lengths by a reference approach, and speeds by `$|W|$`.
#[derive(Clone, Copy)]
pub(super) struct Balance<'a, P = f64> {
    pub(super) at: &'a ElasticPoint<P>,
    pub(super) grooves: &'a Grooves<P>,
    pub(super) condition: AxialCondition<P>,
    /// Friction coefficients at the + and − flanks.
    pub(super) friction: [P; 2],
    /// Radii of the deformed contact surfaces at nut and screw \[m\].
    pub(super) pressed_radius: [P; 2],
    /// Units of force \[N\] and length \[m\].
    pub(super) units: (f64, f64),
    /// Creep speed divided by `$r_b |W|$`.
    pub(super) creep: f64,
    pub(super) quadrature: &'a Quadrature,
    pub(super) frozen_rules: Option<&'a FrozenRules>,
}

/// A loaded contact of the ball.
#[derive(Clone, Copy)]
pub(super) struct Pressed<D> {
    pub(super) contact: Contact<D>,
    pub(super) angle: D,
    pub(super) approach: D,
    pub(super) load: D,
    pub(super) semi_axes: (D, D),
    /// Wrench of normal load and friction on the ball.
    pub(super) wrench: Wrench<D>,
    /// Friction power \[W\] without derivatives.
    pub(super) power: f64,
}

/// State of the ball for given values of the unknowns.
pub(super) struct ArchState<D> {
    pub(super) place: [D; PLACE],
    pub(super) to_nut: Motion<D>,
    pub(super) to_screw: Motion<D>,
    /// Approaches of all contacts \[m\]; a negative approach is a gap.
    pub(super) approaches: [D; FLANKS],
    pub(super) pressed: [Option<Pressed<D>>; FLANKS],
}

impl<D: Scalar> ArchState<D> {
    /// Returns the total wrench of the given flanks on the ball.
    pub(super) fn wrench(&self, flanks: std::ops::Range<usize>) -> Wrench<D> {
        let pressed = self.pressed[flanks].iter().flatten();
        pressed.fold(Wrench::zero(), |sum, pressed| sum + pressed.wrench)
    }
}

impl<P: Scalar> Balance<'_, P> {
    /// Returns the unit of the speeds at the contacts, `$r_b |W|$` \[m/s\].
    fn speed(&self) -> P {
        let point = &self.at.point;
        point.ball.radius * magnitude(point.drive.relative_speed())
    }

    fn frame<D: Over<P>>(&self) -> BallFrame<D> {
        BallFrame::turned(D::from(self.at.point.helix.lead_angle), D::from(0.0))
    }

    pub(super) fn state<D: Integrate<P>>(&self, y: &[D; UNKNOWNS]) -> ArchState<D> {
        let point = &self.at.point;
        let (speed, size) = (point.drive.relative_speed(), magnitude(point.drive.relative_speed()));
        let place = from_fn(|i| y[i] * self.units.1);
        let omega = Vector3::new(y[4], y[5], y[6]) * D::from(size);
        let to_nut = Motion { precession: y[3] * size, omega };
        let to_screw = to_nut.relative_to(D::from(speed), &self.frame());
        let flanks: [FlankApproach<D>; FLANKS] = from_fn(|i| self.grooves.flank(i, &place));
        let approaches = flanks.map(|flank| flank.approach);
        let mut pressed = [None; FLANKS];
        let (mut touching, mut count) = ([0; FLANKS], 0);
        for i in (0..FLANKS).filter(|i| approaches[*i].re() > 0.0) {
            touching[count] = i;
            count += 1;
        }
        // Integrating over two ellipses at once is faster than integrating twice.
        for pair in touching[..count].chunks(2) {
            let places = [pair[0], pair[pair.len() - 1]];
            let contacts = places.map(|i| {
                let motion = if i < 2 { &to_nut } else { &to_screw };
                self.contact(i, &flanks[i], motion)
            });
            let patches = contacts.map(|(_, patch)| patch);
            let nodes = places.map(|i| self.nodes(i));
            let sums = dry_friction::<P, D>(&patches, &nodes, pair.len() == 1);
            for (k, i) in pair.iter().copied().enumerate() {
                let ((contact, _), (unit, power)) = (contacts[k], &sums[k]);
                // F = Q N + f Q ∫ dF                                      (T2)
                let friction = contact.load * self.friction[i % 2];
                let mut wrench = unit.wrench(&contact.contact) * friction;
                wrench.force += contact.contact.normal * contact.load;
                let power = power.re() * self.speed().re() * friction.re();
                pressed[i] = Some(Pressed { wrench, power, ..contact });
            }
        }
        ArchState { place, to_nut, to_screw, approaches, pressed }
    }

    /// Returns the quadrature nodes at a flank.
    fn nodes(&self, flank: usize) -> Placement<'_> {
        Placement {
            frozen_rule: self.frozen_rules.map(|rules| &rules.0[flank]),
            ..self.quadrature.into()
        }
    }

    /// Returns a loaded contact without friction, together with the patch over which friction is
    /// integrated.
    fn contact<D: Integrate<P>>(
        &self,
        i: usize,
        &FlankApproach { approach, normal: [b, n], .. }: &FlankApproach<D>,
        motion: &Motion<D>,
    ) -> (Pressed<D>, Patch<D>) {
        let point = &self.at.point;
        let side = if i < 2 { 1.0 } else { -1.0 };
        let angle = (b * side).atan2(n * side);
        let contact = Contact::new(site(i), angle, &self.frame());
        let load = self.grooves.load(i, approach);
        let ellipse = Ellipse {
            contact,
            load,
            semi_axes: self.grooves.semi_axes(i, approach),
            pressed_radius: self.pressed_radius[i / 2],
            ball_radius: point.ball.radius,
        };
        let local = contact_motion(motion, &contact, D::from(point.helix.arc_length_per_radian()));
        // Friction depends only on the ratio of slip speed to creep speed, so all speeds are
        // divided by r_b
        // |W|.
        let patch = ellipse.patch(&local.over(D::from(self.speed())), self.creep);
        let (semi_axes, wrench, power) = (ellipse.semi_axes, Wrench::zero(), 0.0);
        (Pressed { contact, angle, approach, load, semi_axes, wrench, power }, patch)
    }

    #[expect(clippy::unnecessary_wraps, reason = "the form of a residual")]
    pub(super) fn residual<D: Integrate<P>>(
        &self,
        y: &[D; UNKNOWNS],
    ) -> Result<[D; UNKNOWNS], EvalError> {
        let point = &self.at.point;
        let state = self.state(y);
        let frame = self.frame::<D>();
        let nut = state.wrench(0..2);
        let motion = state.to_nut.relative_to(D::from(-point.drive.nut_speed), &frame);
        let ball = Ball { radius: D::from(point.ball.radius), mass: D::from(point.ball.mass) };
        // Σ F = m r_m P² n,  Σ M = P k × I ω                              (AC5)
        let left = newton_euler(
            &(nut + state.wrench(2..FLANKS)),
            &ball,
            D::from(point.helix.radius),
            &motion,
            &frame,
        );
        let (load, length) = self.units;
        let force = load.recip();
        let along = force / self.friction[0].re().min(1.0);
        let moment = along / point.ball.radius.re();
        // (Σ_nut F)·k = F_a  or  w_b = u cosα                             (AC6)
        let position = match self.condition {
            AxialCondition::Force(axial) => (axial_force(&nut.force, &frame) - axial) * force,
            AxialCondition::Displacement(u) => y[2] - u * self.grooves.cos_lead * length.recip(),
        };
        Ok([
            left.force.x * along,
            left.force.y * force,
            left.force.z * force,
            left.moment.x * moment,
            left.moment.y * moment,
            left.moment.z * moment,
            position,
        ])
    }
}

impl Balance<'_> {
    /// Returns the approximate angular speed of a rolling ball, divided by `$|W|$`.
    pub(super) fn turning(&self) -> f64 {
        self.at.point.helix.arc_length_per_radian() / self.at.point.ball.radius
    }

    /// Returns the motion, divided by `$|W|$`, of a ball that rolls on both loaded flanks without
    /// rotation about the principal normal.
    pub(super) fn without_spin(
        &self,
        place: &[f64; PLACE],
        diagonal: usize,
        motion: [f64; 4],
    ) -> [f64; 4] {
        let point = &self.at.point;
        let (arc, radius) = (point.helix.arc_length_per_radian(), point.ball.radius);
        let (sign, cos_lead) = (point.drive.relative_speed().signum(), self.grooves.cos_lead);
        // Components of t × N along b at nut and screw
        let [nut, screw] = [0, 2].map(|i| self.grooves.flank(i + diagonal, place).normal[1]);
        // Without slip along t: d P + r_b ω_b c_A = 0,  d (P − W) + r_b (ω_b − W cosα) c_B = 0
        let around = sign * (arc + radius * cos_lead * screw) / (radius * (screw - nut));
        let [_, along, ..] = motion;
        [-radius / arc * around * nut, along, 0.0, around]
    }

    /// Returns the sum of inertia force and friction forces at the selected flanks for given values
    /// of the unknowns.
    pub(super) fn friction(&self, y: &[f64; UNKNOWNS], flanks: [bool; FLANKS]) -> FixedForces {
        let ArchState { to_nut, pressed, .. } = self.state(y);
        let friction = |i: usize| {
            pressed[i].filter(|_| flanks[i]).map_or(Vector3::zeros(), |pressed| {
                pressed.wrench.force - pressed.contact.normal * pressed.load
            })
        };
        let of_nut = friction(0) + friction(1);
        let of_screw = friction(2) + friction(3);
        let (point, frame) = (&self.at.point, self.frame());
        let rate = to_nut.precession + point.drive.nut_speed;
        let sum =
            of_nut + of_screw - frame.n * (point.ball.mass * point.helix.radius * rate * rate);
        FixedForces { ball: [sum.z, sum.y], of_nut: axial_force(&of_nut, &frame) }
    }

    /// Runs one damped Newton solve from `y`.
    pub(super) fn run(
        &self,
        y: &mut [f64; UNKNOWNS],
        options: &Options,
        newton: &mut Workspace<UNKNOWNS>,
    ) -> Report {
        let scales = Scales { x: &[1.0; UNKNOWNS], f: &[1.0; UNKNOWNS] };
        solve(self, y, &scales, options, newton).report
    }
}

impl Equations<UNKNOWNS> for Balance<'_> {
    type Details = ();
    type Slopes = ();

    fn residual(&self, x: &[f64; UNKNOWNS]) -> Result<([f64; UNKNOWNS], ()), EvalError> {
        Ok((Balance::residual(self, x)?, ()))
    }

    fn linearize(
        &self,
        x: &[f64; UNKNOWNS],
        rows: &mut [[f64; UNKNOWNS]; UNKNOWNS],
    ) -> Linearized<UNKNOWNS, Self> {
        let values;
        (values, *rows) = linear(x, |x| Balance::residual(self, x))?;
        Ok((values, (), ()))
    }

    fn max_step_length(&self, _x: &[f64; UNKNOWNS], dx: &[f64; UNKNOWNS]) -> f64 {
        let [place, motion] = MAX_STEP;
        let limit = |i: usize| match i {
            0..PLACE => place,
            PLACE => motion,
            _ => motion * self.turning(),
        };
        dx.iter().enumerate().fold(1.0, |part, (i, dx)| part.min(limit(i) / dx.abs()))
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}
