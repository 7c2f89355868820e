//! Gross slip on elastic contacts: saturated friction at the contact centres, contact angles that
//! follow load and speed.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S1) to (S12).

mod sensitivities;

use bsm_kin::{BallFrame, Motion, Over, Scalar};
use bsm_newton::{EvalError, MatMut, Options, Report, Scales, System, Workspace, solve};
use nalgebra::Vector3;

use crate::coulomb::friction_force;
use crate::follow::{Stride, follow};
use crate::jacobian::linearize;
use crate::layout::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT};
use crate::layout::{self, BALL, MOMENT_NORMAL};
use crate::pair::{ElasticScrew, Loaded, Pair, refused};
use crate::rigid::first_order::{Sliding, spin_moment};
use crate::{Angles, Model, Outputs, Reason, Solution, Status, Wrench};

/// Below this ratio of inertia to friction the rounding of the loads shows in the slip.
const SLOW: f64 = 1e-5;

/// Inertia ratio at which the first order is a safe start.
const CALM: f64 = 0.3;

/// Below this ratio of inertia to friction the first order decides about existence (S12).
const SURE: f64 = 0.05;

/// A solve may take this many steps; more means that the start was not near the root.
const MOST_STEPS: usize = 12;

/// A solve of a path that takes more steps may have changed the branch.
const PATH_STEPS: usize = 6;

/// Inputs of the elastic model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic<D = f64> {
    /// The screw at its operating point; friction positive.
    pub screw: ElasticScrew<D>,
}

/// Memory of the solves.
pub struct ElasticWorkspace(Workspace);

impl Default for ElasticWorkspace {
    fn default() -> Self {
        Self(Workspace::new(BALL))
    }
}

/// Contacts, motion, slips and wrenches that belong to a set of unknowns.
#[derive(Debug)]
struct State<D> {
    loaded: Loaded<D>,
    to_nut: Motion<D>,
    slip: [Vector3<D>; 2],
    wrench: [Wrench<D>; 2],
}

/// Saturated friction on a pair of contacts; unknowns `$Q_A/F_a,\; \nu,\; Q_B/F_a,\; p,\; \lambda,\;
/// \theta,\; s$` (S1).
struct Saturated<'a, P = f64>(&'a Pair<P>);

impl<P: Scalar> Saturated<'_, P> {
    fn state<D: Over<P>>(&self, y: &[D; BALL]) -> Result<State<D>, EvalError> {
        let pair = self.0;
        let loaded = pair.loaded([y[NUT_LOAD], y[SCREW_LOAD]], y[TILT])?;
        let [nut, screw] = loaded.contacts;
        // P = Ω_n + p W                                                   (S2)
        let precession = y[PRECESSION] * pair.sign() + pair.nut_speed;
        if precession.re() == 0.0 {
            return Err(EvalError {
                quantity: "precession rate P of the ball over |W|",
                value: 0.0,
                requirement: "not zero: a ball that does not circle has no gyroscopic moment",
            });
        }
        // σ = s r_b F_a / (I P), about the mean normal                    (S3)
        let sigma = y[SPIN] / (precession * pair.ball.inertia());
        // V_A = W r_b λ (cosθ e_xA + sinθ t)                              (S4)
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        let tangent = BallFrame::tangent();
        let along = (nut.across * cos + tangent * sin) * D::from(pair.sign());
        // ω'_t = −W λ cosθ,  ω'·e_xA = W (λ sinθ − p d/r_b)               (S5)
        let omega_t = -y[SLIP] * cos * pair.sign();
        let omega_a = (y[SLIP] * sin - y[PRECESSION] * pair.arc) * pair.sign();
        // e_xA = sinν N + cosν e_x                                        (S6)
        let omega_x = (omega_a - sigma * nut.across.y) / nut.across.z;
        let omega = Vector3::new(omega_t, sigma, omega_x);
        let to_nut = Motion { precession: y[PRECESSION] * pair.sign(), omega };

        let points = loaded.contacts.map(|c| c.point(D::from(1.0)));
        // V_A + V_B = d (2p − 1) W t + ω' × (r_A + r_B) − W k × r_B, in which the spin, of order
        // 1/P, meets the tilt only and does not cancel                    (S11)
        let arc = tangent * ((y[PRECESSION] * 2.0 - 1.0) * (pair.arc * pair.sign()));
        let both = arc + omega.cross(&(points[0] + points[1]))
            - loaded.frame.k.cross(&points[1]) * D::from(pair.sign());
        let at_screw = both - along * y[SLIP];
        // The part along the normal is zero but for rounding.
        let slip_screw = screw.across * at_screw.dot(&screw.across) + tangent * at_screw.x;
        let slip = [along * y[SLIP], slip_screw];
        let friction = [
            along * (y[NUT_LOAD] * -pair.friction),
            friction_force(D::from(pair.friction), y[SCREW_LOAD], &slip[1])?,
        ];
        let wrench = std::array::from_fn(|i| {
            let normal = &loaded.contacts[i].normal;
            Wrench::at_contact(normal, &points[i], loaded.loads[i], &friction[i])
        });
        Ok(State { loaded, to_nut, slip, wrench })
    }

    fn residual<D: Over<P>>(&self, y: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        let state = self.state(y)?;
        let motion = self.0.absolute(&state.to_nut, &state.loaded.frame);
        Ok(self.0.balance(&state.loaded, &motion, &state.wrench))
    }
}

impl Saturated<'_> {
    /// The motion without inertia at the static contact angle, tilt and slip to first order.
    fn start(&self) -> Result<[f64; BALL], (Status, Reason)> {
        let pair = self.0;
        let (alpha, signed) = (pair.helix.lead_angle, pair.friction * pair.sign());
        let factor = |beta| Angles { lead: alpha, contact: beta }.slip_factor();
        let static_load = pair.static_load(|beta| signed * factor(beta));
        let (load, beta) = static_load.map_err(|(status, reason)| {
            // sinβ > f D(β) at an angle only if it holds at 90 deg: f tanα < 1  (S12)
            let holds = signed * alpha.tan() >= 1.0;
            let calm = inertia_over_friction(pair, 1.0 + pair.nut_speed.abs()) < SURE;
            (if holds && calm { Status::NoSolution } else { status }, reason)
        })?;
        let ((sin_a, cos_a), (sin_b, cos_b)) = (alpha.sin_cos(), beta.sin_cos());
        let angles = Angles { lead: alpha, contact: beta };
        let size = pair.helix.radius.recip();
        let Sliding { slip_factor: d, sin_psi, cos_psi, precession: rigid, .. } =
            Sliding::of(&angles, size);
        // γ = sinβ − F (cosβ + F cosψ sinβ)/[cosψ (1 + F²)]               (S7)
        let gamma = sin_b
            - signed * (cos_b + signed * cos_psi * sin_b) / (cos_psi * (1.0 + signed * signed));
        // g = (5/2) F γ / D,  p = (p_R + g Ω_n/W)/(1 − g)                 (S8)
        let g = 2.5 * signed * gamma / d;
        let p = (rigid + g * pair.nut_speed * pair.sign()) / (1.0 - g);
        let rate = p + pair.nut_speed * pair.sign();
        // ν = m r_m P² γ / (2 Q)                                          (S9)
        let inertia = pair.inertia_ratio() * rate * rate;
        let tilt = 0.5 * inertia * gamma / load;
        let difference = inertia * (cos_b + signed * cos_psi * sin_b) / (1.0 + signed * signed);
        // λ = p_R d T / (cosψ + T sinψ),  T = tanα/cosβ                   (S10)
        let tangent = sin_a / (cos_a * cos_b);
        let slip = tangent * pair.arc * rigid / (cos_psi + tangent * sin_psi);
        let mut y = [0.0; BALL];
        y[NUT_LOAD] = load + 0.5 * difference;
        y[SCREW_LOAD] = load - 0.5 * difference;
        y[TILT] = tilt;
        y[PRECESSION] = p;
        y[SLIP] = slip;
        y[SLIP_ANGLE] = sin_psi.atan2(cos_psi);
        y[SPIN] = spin_moment(&angles, signed, load);
        Ok(y)
    }
}

impl System for Saturated<'_> {
    fn dim(&self) -> usize {
        BALL
    }

    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&Saturated::residual(self, x.try_into().expect("seven unknowns"))?);
        Ok(())
    }

    fn linearize(&self, x: &[f64], r: &mut [f64], jac: MatMut<'_, f64>) -> Result<(), EvalError> {
        linearize(|y| Saturated::residual(self, &y), x, r, jac)
    }

    fn equation(&self, i: usize) -> String {
        layout::equation(i).to_owned()
    }
}

/// A root of the elastic equations.
#[derive(Debug)]
pub(crate) struct Skid {
    state: State<f64>,
    steps: usize,
    residual: f64,
}

impl Skid {
    /// Contacts and motion relative to the nut.
    pub(crate) fn state(&self) -> (&Loaded<f64>, &Motion<f64>) {
        (&self.state.loaded, &self.state.to_nut)
    }

    /// Newton steps of all solves.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// The root, if its slip is against friction.
    pub(crate) fn of(pair: &Pair, newton: &mut Workspace) -> Result<Self, (Status, Reason)> {
        let (y, steps, residual) = find(pair, newton)?;
        let state = Saturated(pair).state(&y).map_err(refused)?;
        Ok(Self { state, steps, residual })
    }
}

/// Unknowns, Newton steps of all solves, residual.
type Found = ([f64; BALL], usize, f64);

/// How many times as much inertia it takes for a ball to be no longer slow.
fn slowness(pair: &Pair, start: &[f64; BALL]) -> f64 {
    let rate = start[PRECESSION] * pair.sign() + pair.nut_speed;
    SLOW / (pair.inertia_ratio() * rate * rate / pair.friction)
}

/// Size of the inertia forces over that of friction, at a precession rate over `$|W|$`.
fn inertia_over_friction(pair: &Pair, rate: f64) -> f64 {
    pair.inertia_ratio() * (rate * rate).max(1.0) / pair.friction
}

/// The root, if its slip is against friction.
fn find(pair: &Pair, newton: &mut Workspace) -> Result<Found, (Status, Reason)> {
    let y = Saturated(pair).start()?;
    let (first, rate) = (y[SLIP], y[PRECESSION] * pair.sign() + pair.nut_speed);
    let factor = slowness(pair, &y);
    let found =
        if factor > 1.0 { slow_root(pair, factor, newton)? } else { root(pair, y, newton)? };
    let slip = found.0[SLIP];
    if slip <= 0.0 {
        // The slip would point along friction, not against it. With little inertia there is no
        // other root; with more, others are not excluded.
        let sure = first < 0.0 && inertia_over_friction(pair, rate) < SURE;
        let status = if sure { Status::NoSolution } else { Status::NotConverged };
        return Err((status, Reason::SlipAlongFriction { slip }));
    }
    Ok(found)
}

/// Newton from the first order `y`; where inertia has grown too large for it, the root is followed
/// there.
fn root(
    pair: &Pair,
    mut y: [f64; BALL],
    newton: &mut Workspace,
) -> Result<Found, (Status, Reason)> {
    let failure = run(pair, &mut y, newton);
    let mut steps = failure.steps.len();
    if failure.converged() {
        return Ok((y, steps, failure.residual));
    }
    let begin = (CALM / pair.inertia_ratio()).min(1.0).ln();
    let slower = |log: f64| pair.with_inertia(log.exp());
    let mut path = Saturated(&slower(begin)).start()?;
    let mut residual = f64::INFINITY;
    let stride = Stride { first: 0.5, shortest: 1e-2 };
    follow(&mut path, (begin, 0.0), stride, |log, y| {
        let at = run(&slower(log), y, newton);
        steps += at.steps.len();
        residual = at.residual;
        at.converged() && at.steps.len() <= PATH_STEPS
    })
    .map_err(|end| {
        let ends = |log: f64| Reason::RootEnds { inertia_fraction: log.exp() };
        (Status::NotConverged, end.map_or_else(|| Reason::from(failure), ends))
    })?;
    Ok((path, steps, residual))
}

/// The root for inertia so small that loads in double precision hardly tell it from none: on the
/// line through the roots of `factor` and twice `factor` as much inertia.
///
/// All unknowns are analytic in the inertia; tilt and difference of the loads are proportional to
/// it at first.
fn slow_root(pair: &Pair, factor: f64, newton: &mut Workspace) -> Result<Found, (Status, Reason)> {
    let mut steps = 0;
    let mut residual: f64 = 0.0;
    let mut at = |factor: f64| {
        let faster = pair.with_inertia(factor);
        let mut y = Saturated(&faster).start()?;
        let report = run(&faster, &mut y, newton);
        steps += report.steps.len();
        residual = residual.max(report.residual);
        if !report.converged() {
            return Err((Status::NotConverged, Reason::from(report)));
        }
        let (sum, difference) = (y[NUT_LOAD] + y[SCREW_LOAD], y[NUT_LOAD] - y[SCREW_LOAD]);
        (y[NUT_LOAD], y[SCREW_LOAD], y[TILT]) = (sum, difference / factor, y[TILT] / factor);
        Ok(y)
    };
    let (near, far) = (at(factor)?, at(2.0 * factor)?);
    let beyond = 1.0 - factor.recip();
    let mut y: [f64; BALL] = std::array::from_fn(|i| near[i] + (near[i] - far[i]) * beyond);
    let (sum, difference) = (y[NUT_LOAD], y[SCREW_LOAD]);
    (y[NUT_LOAD], y[SCREW_LOAD]) = (0.5 * (sum + difference), 0.5 * (sum - difference));
    Ok((y, steps, residual))
}

/// Weights of the equations near `y`, and the size of the inertia forces there.
fn weights(pair: &Pair, y: &[f64; BALL]) -> ([f64; BALL], f64) {
    let rate = (y[PRECESSION] * pair.sign() + pair.nut_speed).abs();
    let size = pair.inertia_ratio() * rate.powi(2).max(1.0);
    let mut weights = [size.max(1.0).recip(); BALL];
    // The moment about the mean normal has inertia-sized terms only.
    weights[MOMENT_NORMAL] = (size * rate.min(1.0)).max(f64::MIN_POSITIVE).recip();
    (weights, size)
}

/// One damped Newton solve from `y`.
fn run(pair: &Pair, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
    let (weights, size) = weights(pair, y);
    let scales = Scales { x: &[1.0; BALL], f: &weights };
    // A residual `r` leaves an error of `r/size` in the slip, and of that in the power balance.
    let residual_goal = (1e-12 * size).clamp(1e-15, 1e-13);
    let residual_tol = 1e-12;
    let options =
        Options { residual_tol, residual_goal, max_steps: MOST_STEPS, ..Options::default() };
    solve(&Saturated(pair), y, &scales, &options, newton)
        .expect("sizes are constant and the weights positive")
}

impl Elastic {
    /// Solves for the steady motion of the ball.
    pub fn solve(&self, work: &mut ElasticWorkspace) -> Solution {
        let outputs = self
            .screw
            .require_friction()
            .and_then(|()| self.screw.pair())
            .and_then(|pair| self.outputs(&pair, work));
        match outputs {
            Ok(outputs) => Solution::converged(Model::Elastic, outputs),
            Err((status, reason)) => Solution::failed(Model::Elastic, status, reason),
        }
    }

    /// The numbers of the root.
    pub(crate) fn outputs(
        &self,
        pair: &Pair,
        work: &mut ElasticWorkspace,
    ) -> Result<Outputs, (Status, Reason)> {
        let Skid { state, steps, residual } = Skid::of(pair, &mut work.0)?;
        let mut outputs = self.screw.describe(pair, &state.loaded, &state.to_nut)?;
        // P_f = Σ f Q_c |V_c|, Eq (R21)
        let friction_power =
            (0..2).map(|i| pair.friction * state.loaded.loads[i] * state.slip[i].norm()).sum();
        let frame = &state.loaded.frame;
        self.screw.transmit(&mut outputs, pair, frame, &state.wrench[1], friction_power)?;
        outputs.iterations = Some(steps);
        outputs.residual_norm = Some(residual);
        Ok(outputs)
    }
}

#[cfg(test)]
mod tests;
