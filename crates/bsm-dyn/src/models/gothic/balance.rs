//! Force and moment balance of a ball in gothic arches with friction at all loaded contacts,
//! generic over the scalar type.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC4) to (AC6).

use std::cell::OnceCell;

use bsm_kin::{BallFrame, ContactMotion, Over, Scalar, relative_rotation};
use bsm_newton::{Equations, EvalError, Linearized, Options, Outcome, Scales, Workspace, solve};
use bsm_simd::{Arch, Simd, WithSimd};
use nalgebra::Vector3;

use super::grooves::{
    AxialCondition, FLANKS, FixedForces, FlankApproach, Grooves, POSITIONS, site,
};
use crate::contact::{Wrench, axial_force, magnitude};
use crate::cost;
use crate::ellipse::{FrozenRule, Integral, Integrate, Patch, Placement, Quadrature};
use crate::models::ball::ElasticPoint;
use crate::models::ball::linear;
use crate::models::traction::turned;

/// Number of unknowns: positions of the ball and the nut, precession rate, and angular velocity
/// relative to the nut.
pub(super) const UNKNOWNS: usize = POSITIONS + 4;

const EQUATION_NAMES: [&str; UNKNOWNS] = [
    "force along t",
    "force along n",
    "force along b",
    "moment about t",
    "moment about n",
    "moment about b",
    "axial position of the nut",
];

/// Limits of a Newton step: maximum change of position divided by the approach, and maximum
/// relative change of the motion.
const MAX_STEP: [f64; 2] = [0.5, 0.2];

/// Node counts of the quadrature at the four contacts, which are kept fixed near a root.
#[derive(Default)]
pub(super) struct FrozenRules([OnceCell<FrozenRule>; FLANKS]);

/// Force and moment balance of a ball with friction. Forces are divided by a reference load,
/// lengths by a reference approach, and speeds by `$|W|$`.
#[derive(Clone, Copy)]
pub(super) struct Balance<'a, P = f64> {
    pub(super) screw: &'a ElasticPoint<P>,
    pub(super) grooves: &'a Grooves<P>,
    pub(super) condition: AxialCondition<P>,
    /// Friction coefficients at the + and − flanks.
    pub(super) friction: [P; 2],
    /// Radii of the deformed contact surfaces at the nut and the screw \[m\].
    pub(super) pressed_radius: [P; 2],
    /// Units of force \[N\] and length \[m\].
    pub(super) units: (f64, f64),
    /// Creep speed divided by `$r_b |W|$`.
    pub(super) creep: f64,
    pub(super) quadrature: &'a Quadrature,
    /// True for evaluations before Newton's method has converged; see [`Placement::coarse`].
    pub(super) coarse: bool,
    pub(super) frozen_rules: Option<&'a FrozenRules>,
}

/// A loaded contact of the ball. Vectors have components along t, n and b.
#[derive(Clone, Copy)]
pub(super) struct Pressed<D> {
    /// Sine and cosine of the contact angle; the sine is negative at a far flank.
    pub(super) angle: (D, D),
    pub(super) approach: D,
    pub(super) load: D,
    pub(super) semi_axes: (D, D),
    /// Friction force on the ball at this contact.
    friction: [D; 3],
    /// Sum of normal force and friction force on the ball at this contact.
    force: [D; 3],
    /// Moment of the friction about the ball center.
    moment: [D; 3],
    /// Friction power at this contact \[W\], without derivatives.
    pub(super) power: f64,
}

/// State of the ball for given values of the unknowns.
pub(super) struct ArchState<D> {
    pub(super) positions: [D; POSITIONS],
    /// Precession rate and angular velocity along t, n and b relative to the nut, divided by
    /// `$|W|$`.
    pub(super) to_nut: (D, [D; 3]),
    /// Approaches of all contacts \[m\]; a negative approach is a gap.
    pub(super) approaches: [D; FLANKS],
    pub(super) pressed: [Option<Pressed<D>>; FLANKS],
    /// Scaled residuals of the force and moment balance.
    pub(super) residual: [D; UNKNOWNS],
}

impl<D: Scalar> ArchState<D> {
    /// Returns the total force and moment of the given flanks on the ball.
    pub(super) fn wrench(&self, flanks: std::ops::Range<usize>) -> Wrench<D> {
        let pressed = self.pressed[flanks].iter().flatten();
        pressed.fold(Wrench::zero(), |sum, Pressed { force, moment, .. }| {
            sum + Wrench { force: Vector3::from(*force), moment: Vector3::from(*moment) }
        })
    }
}

/// Arguments for evaluating the force and moment balance.
struct Evaluate<'a, 'b, P, D> {
    balance: &'a Balance<'b, P>,
    y: &'a [D; UNKNOWNS],
}

impl<P: Scalar, D: Integrate<P>> WithSimd for Evaluate<'_, '_, P, D> {
    type Output = ArchState<D>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ArchState<D> {
        let Self { balance, y } = self;
        let zero = y[0].constant(0.0);
        let mut state = ArchState {
            positions: [y[0] * balance.units.1, y[1] * balance.units.1, y[2] * balance.units.1],
            to_nut: (y[3], [y[4], y[5], y[6]]),
            approaches: [zero; FLANKS],
            pressed: [None; FLANKS],
            residual: [zero; UNKNOWNS],
        };
        balance.press(simd, &mut state);
        balance.add_up(y, &mut state);
        state
    }
}

impl<P: Scalar> Balance<'_, P> {
    /// Evaluates the force and moment balance for given unknowns.
    pub(super) fn evaluated<D: Integrate<P>>(&self, y: &[D; UNKNOWNS]) -> ArchState<D> {
        cost::count_evaluation();
        Arch::new().dispatch(Evaluate { balance: self, y })
    }

    /// Calculates the approaches at all flanks, and the normal loads and friction at the loaded
    /// flanks.
    #[inline(always)]
    fn press<S: Simd, D: Integrate<P>>(&self, simd: S, state: &mut ArchState<D>) {
        let point = &self.screw.point;
        let radius = point.ball.radius;
        let speed = (radius * magnitude(point.drive.relative_speed())).re();
        let positions = state.positions;
        let (mut touching, mut count) = ([(0, self.grooves.flank(0, &positions)); FLANKS], 0);
        for (i, approach) in state.approaches.iter_mut().enumerate() {
            let flank = self.grooves.flank(i, &positions);
            *approach = flank.approach;
            if flank.approach.re() > 0.0 {
                touching[count] = (i, flank);
                count += 1;
            }
        }
        // Integrating over two ellipses at once is faster than integrating twice.
        for pair in touching[..count].chunks(2) {
            let [(i, first), (j, second)] = [pair[0], pair[pair.len() - 1]];
            let contacts =
                [self.contact(i, &first, state.to_nut), self.contact(j, &second, state.to_nut)];
            let patches = [contacts[0].1, contacts[1].1];
            let nodes = [self.nodes(i), self.nodes(j)];
            let sums = D::dry(simd, &patches, &nodes, pair.len() == 1);
            let contacts = pair.iter().zip(contacts).zip(&sums);
            for ((&(i, _), (mut pressed, _)), (unit, power)) in contacts {
                let (load, angle) = (pressed.load, pressed.angle);
                let pull = load * self.friction[i % 2];
                // F = Q N + f Q ∫ dF,  M = f Q ∫ dM                       (T2)
                let Integral { force: [f_t, f_c], moment: [m_t, m_n, m_c] } = unit.times(pull);
                let none = load.constant(0.0);
                let (friction_n, friction_b) = turned(i / 2, angle, (none, f_c));
                let (f_n, f_b) = turned(i / 2, angle, (load, f_c));
                let (m_n, m_b) = turned(i / 2, angle, (m_n, m_c));
                pressed.friction = [f_t, friction_n, friction_b];
                (pressed.force, pressed.moment) = ([f_t, f_n, f_b], [m_t, m_n, m_b]);
                pressed.power = power.re() * pull.re() * speed;
                state.pressed[i] = Some(pressed);
            }
        }
    }

    /// Returns the placement of the quadrature nodes at a flank.
    fn nodes(&self, flank: usize) -> Placement<'_> {
        Placement {
            rule: self.quadrature,
            frozen_rule: self.frozen_rules.map(|rules| &rules.0[flank]),
            coarse: self.coarse,
        }
    }

    /// Returns a loaded contact without friction, together with the contact patch over which
    /// friction is integrated.
    ///
    /// * `(rate, omega)`: motion relative to the nut, divided by `$|W|$`.
    #[inline(always)]
    fn contact<D: Over<P>>(
        &self,
        i: usize,
        &FlankApproach { approach, normal: [b, n], .. }: &FlankApproach<D>,
        (rate, omega): (D, [D; 3]),
    ) -> (Pressed<D>, Patch<D>) {
        let point = &self.screw.point;
        let (zero, radius) = (approach.constant(0.0), point.ball.radius);
        let arc = point.helix.arc_length_per_radian();
        // At the nut, the normal (K9) has the components sinβ along b and cosβ along n. At the
        // screw, both components have the opposite sign.
        let angle = if i < 2 { (b, n) } else { (-b, -n) };
        let (rate, omega) = if i < 2 {
            (rate, omega)
        } else {
            let body = radius.constant(point.drive.relative_speed().re().signum());
            (rate - body, relative_rotation(omega, body, self.grooves.lead))
        };
        let local = ContactMotion::at_angle(site(i), rate * arc, omega, angle);
        // Friction depends only on the ratio of slip speed to creep speed, so all speeds are
        // divided by r_b |W|.
        let (unit, [t, n, c]) = (radius.recip(), local.omega);
        let semi_axes = self.grooves.semi_axes(i, approach);
        let patch = Patch {
            semi_axes,
            pressed_radius: zero + self.pressed_radius[i / 2],
            ball_radius: zero + radius,
            motion: [local.speed * unit, t * unit, n * unit, c * unit],
            creep: zero + self.creep,
        };
        let load = self.grooves.load(i, approach);
        let none = [zero; 3];
        let (friction, force, moment) = (none, none, none);
        (Pressed { angle, approach, load, semi_axes, friction, force, moment, power: 0.0 }, patch)
    }

    /// Adds up the forces and moments on the ball, and stores the scaled residuals.
    #[inline(always)]
    fn add_up<D: Over<P>>(&self, y: &[D; UNKNOWNS], state: &mut ArchState<D>) {
        let point = &self.screw.point;
        let zero = y[0].constant(0.0);
        let (mut force, mut moment, mut axial) = ([zero; 3], [zero; 3], zero);
        let (sin_lead, cos_lead) = self.grooves.lead;
        for (i, pressed) in state.pressed.iter().enumerate() {
            let Some(pressed) = pressed else { continue };
            for (sum, part) in force.iter_mut().zip(pressed.force) {
                *sum += part;
            }
            for (sum, part) in moment.iter_mut().zip(pressed.moment) {
                *sum += part;
            }
            if i < 2 {
                // F_a = (Σ_nut F_c)·k                                     (B6)
                axial += pressed.force[0] * sin_lead + pressed.force[2] * cos_lead;
            }
        }
        let size = magnitude(point.drive.relative_speed());
        let (rate, [w_t, w_n, w_b]) = state.to_nut;
        let absolute = rate * size + point.drive.nut_speed;
        // Σ F = m r_m P² n,  Σ M = P k × I ω                              (AC5)
        force[1] -= absolute * absolute * (point.ball.mass * point.helix.radius);
        let gyro = absolute * (point.ball.inertia() * size);
        moment[0] += gyro * (w_n * cos_lead);
        moment[1] -= gyro * (w_t * cos_lead - w_b * sin_lead);
        moment[2] -= gyro * (w_n * sin_lead);
        let (load, length) = self.units;
        let per_load = load.recip();
        let along = per_load / self.friction[0].re().min(1.0);
        let per_moment = along / point.ball.radius.re();
        // (Σ_nut F)·k = F_a  or  w_b = u cosα                             (AC6)
        let position = match self.condition {
            AxialCondition::Force(given) => (axial - given) * per_load,
            AxialCondition::Displacement(u) => y[2] - u * cos_lead * length.recip(),
        };
        state.residual = [
            force[0] * along,
            force[1] * per_load,
            force[2] * per_load,
            moment[0] * per_moment,
            moment[1] * per_moment,
            moment[2] * per_moment,
            position,
        ];
    }

    /// Returns the scaled residuals of the force and moment balance.
    #[expect(
        clippy::unnecessary_wraps,
        reason = "the macro `equations!` requires this return type"
    )]
    pub(super) fn residual<D: Integrate<P>>(
        &self,
        y: &[D; UNKNOWNS],
    ) -> Result<[D; UNKNOWNS], EvalError> {
        Ok(self.evaluated(y).residual)
    }
}

impl Balance<'_> {
    /// Returns the approximate angular speed of a rolling ball, divided by `$|W|$`.
    pub(super) fn turning(&self) -> f64 {
        self.screw.point.helix.arc_length_per_radian() / self.screw.point.ball.radius
    }

    /// Returns the motion, divided by `$|W|$`, of a ball that rolls on both loaded flanks without
    /// rotation about the principal normal.
    pub(super) fn without_spin(
        &self,
        positions: &[f64; POSITIONS],
        flank_pair: usize,
        motion: [f64; 4],
    ) -> [f64; 4] {
        let point = &self.screw.point;
        let (arc, radius) = (point.helix.arc_length_per_radian(), point.ball.radius);
        let (sign, cos_lead) = (point.drive.relative_speed().signum(), self.grooves.lead.1);
        // `nut` and `screw` are the components of t × N along b at the nut and the screw.
        let [nut, screw] = [0, 2].map(|i| self.grooves.flank(i + flank_pair, positions).normal[1]);
        // Without slip along t: d P + r_b ω_b c_A = 0,  d (P − W) + r_b (ω_b − W cosα) c_B = 0
        let around = sign * (arc + radius * cos_lead * screw) / (radius * (screw - nut));
        let [_, along, ..] = motion;
        [-radius / arc * around * nut, along, 0.0, around]
    }

    /// Returns the sum of the inertia force and of the friction forces at the selected flanks for
    /// given unknowns.
    pub(super) fn friction(&self, y: &[f64; UNKNOWNS], flanks: [bool; FLANKS]) -> FixedForces {
        let ArchState { to_nut: (rate, _), pressed, .. } = self.evaluated(y);
        let friction = |i: usize| {
            let pressed = pressed[i].filter(|_| flanks[i]);
            pressed.map_or(Vector3::zeros(), |pressed| Vector3::from(pressed.friction))
        };
        let of_nut = friction(0) + friction(1);
        let of_screw = friction(2) + friction(3);
        let (point, frame) =
            (&self.screw.point, BallFrame::turned(self.screw.point.helix.lead_angle, 0.0));
        let rate = rate * point.drive.relative_speed().abs() + point.drive.nut_speed;
        let sum =
            of_nut + of_screw - frame.n * (point.ball.mass * point.helix.radius * rate * rate);
        FixedForces { ball: [sum.z, sum.y], of_nut: axial_force(&of_nut, &frame) }
    }

    /// Solves the force and moment balance with the damped Newton method, starting from `y`.
    pub(super) fn run(
        &self,
        y: &mut [f64; UNKNOWNS],
        options: &Options,
        newton: &mut Workspace<UNKNOWNS>,
    ) -> Outcome<UNKNOWNS, Self> {
        let scales = Scales { x: &[1.0; UNKNOWNS], f: &[1.0; UNKNOWNS] };
        solve(self, y, &scales, options, newton)
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
        let [position, motion] = MAX_STEP;
        let limit = |i: usize| match i {
            0..POSITIONS => position,
            POSITIONS => motion,
            _ => motion * self.turning(),
        };
        dx.iter().enumerate().fold(1.0, |part, (i, dx)| part.min(limit(i) / dx.abs()))
    }

    fn equation(&self, i: usize) -> String {
        EQUATION_NAMES[i].to_owned()
    }
}
