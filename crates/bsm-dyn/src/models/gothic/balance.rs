//! The balance of a ball in gothic arches with friction at all contacts that are pressed, in any scalar.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC4) to (AC6).

use std::array::from_fn;
use std::cell::OnceCell;

use bsm_kin::{BallFrame, Contact, Motion};
use bsm_newton::{Equations, EvalError, Linearized, Options, Report, Scales, Workspace, solve};
use nalgebra::Vector3;

use super::grooves::{AxialCondition, FLANKS, FlankApproach, Grooves, PLACE, site};
use crate::contact::{Ball, Wrench, axial_force, newton_euler};
use crate::ellipse::{
    Ellipse, FrozenRule, Integrate, Patch, Placement, Quadrature, contact_motion, dry_friction,
};
use crate::models::ball::ElasticPoint;
use crate::models::ball::linear;

/// Position of ball and nut, rate along the helix and angular velocity relative to the nut.
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

/// Longest Newton step: of a position over the approach, and of the motion over its size.
const LONGEST: [f64; 2] = [0.5, 0.2];

/// Numbers of nodes at the four contacts that stay as they are near a root.
#[derive(Default)]
pub(super) struct FrozenRules([OnceCell<FrozenRule>; FLANKS]);

/// A ball with friction at its contacts; forces over a load, lengths over an approach, speeds over `$|W|$`.
#[derive(Clone, Copy)]
pub(super) struct Balance<'a> {
    pub(super) at: &'a ElasticPoint,
    pub(super) grooves: &'a Grooves,
    pub(super) condition: AxialCondition,
    /// Friction coefficients of the flanks + and −.
    pub(super) friction: [f64; 2],
    /// Radii of the pressed surfaces at nut and screw.
    pub(super) pressed_radius: [f64; 2],
    /// Load and approach that forces and lengths are divided by.
    pub(super) units: (f64, f64),
    /// Creep speed over `$r_b |W|$`.
    pub(super) creep: f64,
    pub(super) quadrature: &'a Quadrature,
    pub(super) frozen_rules: Option<&'a FrozenRules>,
}

/// A contact that is pressed.
#[derive(Clone, Copy)]
pub(super) struct Pressed<D> {
    pub(super) contact: Contact<D>,
    pub(super) angle: D,
    pub(super) approach: D,
    pub(super) load: D,
    pub(super) semi_axes: (D, D),
    /// Normal load and friction on the ball.
    pub(super) wrench: Wrench<D>,
    /// That friction takes \[W\], without derivatives.
    pub(super) power: f64,
}

/// A ball at values of the unknowns.
pub(super) struct ArchState<D> {
    pub(super) place: [D; PLACE],
    pub(super) to_nut: Motion<D>,
    pub(super) to_screw: Motion<D>,
    /// Approaches of all contacts, negative where there is a gap.
    pub(super) approaches: [D; FLANKS],
    pub(super) pressed: [Option<Pressed<D>>; FLANKS],
}

impl<D: Integrate<f64>> ArchState<D> {
    /// Sum over the contacts of a body.
    pub(super) fn wrench(&self, flanks: std::ops::Range<usize>) -> Wrench<D> {
        let pressed = self.pressed[flanks].iter().flatten();
        pressed.fold(Wrench::zero(), |sum, pressed| sum + pressed.wrench)
    }
}

impl Balance<'_> {
    pub(super) fn frame<D: Integrate<f64>>(&self) -> BallFrame<D> {
        BallFrame::turned(D::from(self.at.point.helix.lead_angle), D::from(0.0))
    }

    /// Size of the angular velocity of a rolling ball over `$|W|$`.
    pub(super) fn turning(&self) -> f64 {
        self.at.point.helix.arc_length_per_radian() / self.at.point.ball.radius
    }

    pub(super) fn state<D: Integrate<f64>>(&self, y: &[D; UNKNOWNS]) -> ArchState<D> {
        let point = &self.at.point;
        let speed = point.drive.relative_speed();
        let place = from_fn(|i| y[i] * self.units.1);
        let omega = Vector3::new(y[4], y[5], y[6]) * D::from(speed.abs());
        let to_nut = Motion { precession: y[3] * speed.abs(), omega };
        let to_screw = to_nut.relative_to(D::from(speed), &self.frame());
        let flanks: [FlankApproach<D>; FLANKS] = from_fn(|i| self.grooves.flank(i, &place));
        let approaches = flanks.map(|flank| flank.approach);
        let mut pressed = [None; FLANKS];
        let (mut touching, mut count) = ([0; FLANKS], 0);
        for i in (0..FLANKS).filter(|i| approaches[*i].re() > 0.0) {
            touching[count] = i;
            count += 1;
        }
        // Sums over two ellipses at once are faster than one after the other.
        for pair in touching[..count].chunks(2) {
            let places = [pair[0], pair[pair.len() - 1]];
            let contacts = places.map(|i| {
                let motion = if i < 2 { &to_nut } else { &to_screw };
                self.contact(i, &flanks[i], motion)
            });
            let patches = contacts.map(|(_, patch)| patch);
            let nodes = places.map(|i| self.nodes(i));
            let sums = dry_friction(&patches, &nodes, pair.len() == 1);
            for (i, ((contact, _), (unit, power))) in
                places.into_iter().zip(contacts.into_iter().zip(sums)).take(pair.len())
            {
                // F = Q N + f Q ∫ dF                                      (T2)
                let friction = contact.load * self.friction[i % 2];
                let mut wrench = unit.wrench(&contact.contact) * friction;
                wrench.force += contact.contact.normal * contact.load;
                let power = power.re() * friction.re();
                pressed[i] = Some(Pressed { wrench, power, ..contact });
            }
        }
        ArchState { place, to_nut, to_screw, approaches, pressed }
    }

    /// Nodes of the quadrature at a flank.
    fn nodes(&self, flank: usize) -> Placement<'_> {
        Placement {
            frozen_rule: self.frozen_rules.map(|rules| &rules.0[flank]),
            ..self.quadrature.into()
        }
    }

    /// A pressed contact without its friction, and the patch over which friction is integrated.
    fn contact<D: Integrate<f64>>(
        &self,
        i: usize,
        &FlankApproach { approach, normal: [b, n] }: &FlankApproach<D>,
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
        let creep = self.creep * point.ball.radius * point.drive.relative_speed().abs();
        let patch = ellipse.patch(&local, creep);
        let (semi_axes, wrench, power) = (ellipse.semi_axes, Wrench::zero(), 0.0);
        (Pressed { contact, angle, approach, load, semi_axes, wrench, power }, patch)
    }

    #[expect(clippy::unnecessary_wraps, reason = "the form of a residual")]
    fn residual<D: Integrate<f64>>(&self, y: &[D; UNKNOWNS]) -> Result<[D; UNKNOWNS], EvalError> {
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
        let along = force / self.friction[0].min(1.0);
        let moment = along / point.ball.radius;
        // (Σ_nut F)·k = F_a  or  w_b = u cosα                             (AC6)
        let position = match self.condition {
            AxialCondition::Force(axial) => (axial_force(&nut.force, &frame) - axial) * force,
            AxialCondition::Displacement(u) => y[2] - u * self.grooves.cos_lead / length,
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

    /// One damped Newton solve from `y`.
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
        let [place, motion] = LONGEST;
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
