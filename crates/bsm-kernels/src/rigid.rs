//! The published steady-state equations by lanes: direct sweeps instead of Newton.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R24) to (R32).

mod sweep;

use bsm_case::OutputKey;
use bsm_case::units::direction_deg;
use bsm_dyn::{Model, POWER_BALANCE_TOL, SEARCHED_FROM, UNIQUE_BELOW};
use bsm_simd::Simd;

use self::sweep::{Plane, Scaled, State, dot, times};
use crate::closed_form::{contact_angles, power_balance, transmit_torque};
use crate::operand::{Given, Lane, Mask};
use crate::units::Units;
use crate::{Kernel, Out};

pub(super) struct Rigid;

/// Sweeps before a point is left to Newton.
const MOST_SWEEPS: usize = 24;

/// Largest ratio of inertia to friction. Up to there sweeps and model found the same root from the
/// same first order at every one of 300 000 seeded points.
const MOST_INERTIA: f64 = 100.0;

/// Where friction holds all but this share of the load, rounding of the normal loads decides; the model
/// looks closer.
const LOCKED: f64 = 1e-3;

/// What the directions may still change.
const SETTLED: f64 = 1e-12;

/// Largest scaled residual of an answer, as that of Newton.
const RESIDUAL: f64 = 1e-10;

/// Nearer to a ball that does not circle, inertia may turn its way; the model looks closer.
const LEAST_RATE: f64 = 0.1;

impl Kernel for Rigid {
    const MODEL: Model = Model::Rigid;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S> {
        let (case, si) = Scaled::of(given);
        let start = case.start();
        let first = case.sweep(&start);
        let expected = case.expected(&first);
        let mut last = start.farthest(&first.next);
        let mut directions = first.next;
        let mut settled = !expected;
        let mut sweeps = case.constant(2.0);
        for _ in 0..MOST_SWEEPS {
            let state = case.sweep(&directions);
            let change = directions.farthest(&state.next);
            directions = directions.unless(settled, &state.next);
            sweeps = settled.select(sweeps, sweeps + 1.0);
            // Geometric series: c/(1 − c) times the last change is left, c = change/last.
            let converges = (change * change).lt((last - change) * SETTLED);
            settled = settled | converges | change.lt(case.constant(f64::EPSILON));
            last = change;
            if !(!settled).any() {
                break;
            }
        }
        let state = case.sweep(&directions);
        let contacts = case.contacts(&state);
        let residual = case.residual(&state, &contacts);
        let found = expected & settled & case.admissible(&state, &contacts);
        let found = found & residual.lt(case.constant(RESIDUAL));
        if !found.any() {
            return found;
        }
        let imbalance = outputs(out, &case, &si, (&state, &contacts));
        contact_angles(given, out);
        out.set(OutputKey::iterations, sweeps);
        out.set(OutputKey::residual_norm, residual);
        // Unknown where no search is made.
        let unique = case.crowding(&first).lt(case.constant(UNIQUE_BELOW));
        let others = unique.select(case.constant(0.0), case.constant(f64::NAN));
        out.set(OutputKey::other_solutions, others);
        found & imbalance.abs().le(case.constant(POWER_BALANCE_TOL))
    }
}

/// Loads and slip velocities of a state.
struct Contacts<S: Simd> {
    /// Normal loads at A, A', B.
    loads: [Lane<S>; 3],
    /// `$\lambda$`, and the slip speeds at A' and B.
    speeds: [Lane<S>; 3],
    /// Direction against the slip at B.
    screw: Plane<S>,
}

impl<S: Simd> Scaled<S> {
    /// Points that the sweeps may answer: with friction, numbers that do not underflow, a root to
    /// first order, and not more inertia than tested or than the model answers without a search.
    #[inline(always)]
    fn expected(&self, first: &State<S>) -> Mask<S> {
        let (zero, least) = (self.constant(0.0), self.constant(f64::MIN_POSITIVE));
        self.friction.gt(least)
            & self.inertia.gt(least)
            & self.inertia_ratio.gt(least)
            // sinβ > F D by more than a hair, κ > 0, margin > 0
            & self.holds().gt(self.k_n * LOCKED)
            & first.minor.gt(zero)
            & first.slip.gt(zero)
            & self.size(first.rate).lt(self.friction * MOST_INERTIA)
            & self.crowding(first).lt(self.constant(SEARCHED_FROM))
    }

    /// Axial load over the normal load of a ball without inertia.
    #[inline(always)]
    fn holds(&self) -> Lane<S> {
        self.k_n - self.signed * self.h
    }

    /// Crowding of the roots.
    #[inline(always)]
    fn crowding(&self, first: &State<S>) -> Lane<S> {
        // C = q ι / (f (P/W)²),  q = 1/(cosα sinβ − F h)                  (R45)
        self.size(first.rate) / (self.friction * first.rate * first.rate * self.holds())
    }

    /// `$\iota$` of a rate (R23).
    #[inline(always)]
    fn size(&self, rate: Lane<S>) -> Lane<S> {
        // ι = μ max(1, (P/W)²)                                            (R23)
        self.inertia_ratio * (rate * rate).max(self.constant(1.0))
    }

    #[inline(always)]
    fn contacts(&self, state: &State<S>) -> Contacts<S> {
        let twice = self.signed * 2.0;
        // −V_B/(W r_b) = λ A + (sinα, d (1 − 2p) − cosα cosβ)             (R26)
        let against = [
            state.slip * state.nut[0] + self.sin_a,
            state.slip * state.nut[1] + self.arc * (self.constant(1.0) - state.p * 2.0) - self.k_e,
        ];
        let speed = dot(against, against).sqrt();
        let gyro = self.inertia * state.rate;
        let along = self.arc * state.p + state.tau * self.cos_2b + state.s * self.sin_2b / gyro;
        Contacts {
            loads: [
                -(state.pulls[0] * state.norms[0]) / twice,
                state.minor * state.centrifugal,
                state.pulls[1] * state.norms[1] / twice,
            ],
            speeds: [
                state.slip * state.norms[0],
                (state.u * state.u + along * along).sqrt(),
                speed,
            ],
            screw: [against[0] / speed, against[1] / speed],
        }
    }

    /// Where contacts push and the ball slides on the nut.
    #[inline(always)]
    fn admissible(&self, state: &State<S>, contacts: &Contacts<S>) -> Mask<S> {
        let zero = self.constant(0.0);
        let [a, minor, b] = contacts.loads;
        a.gt(zero)
            & minor.gt(zero)
            & b.gt(zero)
            & contacts.speeds[0].gt(zero)
            & state.rate.abs().gt(self.constant(LEAST_RATE))
    }

    /// Scaled residual of the equations (R8), with the directions of the slip as it is.
    #[inline(always)]
    fn residual(&self, state: &State<S>, contacts: &Contacts<S>) -> Lane<S> {
        let [q_a, q_m, q_b] = contacts.loads;
        let (f, gyro) = (self.signed, self.inertia * state.rate);
        let half = state.pulls[0] * 0.5;
        let a = times(half, state.nut);
        let b = times(f * q_b, contacts.screw);
        let m = times(f * q_m, state.next.minor);
        let State { u, tau, .. } = *state;
        let force = [
            a[1] + b[1] + m[1],
            q_a - q_b + q_m * self.cos_2b + m[0] * self.sin_2b - state.centrifugal * self.cos_b,
            a[0] + b[0] - q_m * self.sin_2b + m[0] * self.cos_2b + state.centrifugal * self.sin_b,
        ];
        let axial = q_a * self.k_n + a[0] * self.k_e + a[1] * self.sin_a - q_m * self.k_n
            + m[0] * self.k_e
            + m[1] * self.sin_a
            - 1.0;
        let moment = [
            b[0] - a[0] - m[0] - gyro * self.k_n * tau + self.k_e * state.s,
            a[1] - b[1] + m[1] * self.cos_2b - self.sin_a * state.s + gyro * self.k_n * u,
        ];
        let normal = m[1] * self.sin_2b - gyro * (self.k_e * u - self.sin_a * tau);
        let one = self.constant(1.0);
        let others = (force[0].abs().max(force[1].abs()))
            .max(force[2].abs().max(axial.abs()))
            .max(moment[0].abs().max(moment[1].abs()));
        // w = 1/max(1, μ),  M_N = ι min(1, |P/W|)                         (R10), (R23)
        let moment = self.size(state.rate) * state.rate.abs().min(one);
        (others / self.inertia_ratio.max(one)).max(normal.abs() / moment)
    }
}

/// Stores what is wanted of a state, and returns the violation of its power balance.
#[inline(always)]
fn outputs<S: Simd>(
    out: &mut Out<'_, '_>,
    case: &Scaled<S>,
    si: &Units<S>,
    (state, contacts): (&State<S>, &Contacts<S>),
) -> Lane<S> {
    let [q_a, q_m, q_b] = contacts.loads;
    let zero = case.constant(0.0);
    out.set(OutputKey::nut_normal_load_N, q_a * si.load);
    out.set(OutputKey::minor_normal_load_N, q_m * si.load);
    out.set(OutputKey::screw_normal_load_N, q_b * si.load);

    // T = [(−r_m n) × F + M]·k of the wrench of the screw                 (B7)
    let [x, y] = times(case.signed * q_b, contacts.screw);
    let torque = case.radius * (case.cos_a * y + case.sin_a * (q_b * case.sin_b - x * case.cos_b))
        + x * case.sin_a
        - y * case.k_e;
    let ideal = case.radius * case.sin_a / case.cos_a;
    let back = si.speed.lt(zero);
    transmit_torque(out, back, (torque, ideal), si.ball * si.axial, si.speed);

    // P_f = Σ f Q_c |V_c|                                                 (R21)
    let [v_a, v_m, v_b] = contacts.speeds;
    let lost = case.friction * (q_a * v_a + q_m * v_m + q_b * v_b);
    let imbalance = power_balance(out, back, (torque, ideal), lost);

    let w = si.speed.abs();
    let slip = w * si.ball;
    out.set(OutputKey::nut_slip_velocity_m_s, v_a * slip);
    out.set(OutputKey::minor_slip_velocity_m_s, v_m * slip);
    out.set(OutputKey::screw_slip_velocity_m_s, v_b * slip);
    // σ = s r_b F_a/(I P)                                                 (R5)
    let spin = state.s / (case.inertia * state.rate) * si.speed;
    out.set(OutputKey::nut_spin_rad_s, spin);
    out.set(OutputKey::screw_spin_rad_s, si.speed * case.k_n - spin);
    // P = Ω_n + p W,  ω = Ω_n k + W u t + σ N + W τ e_x                   (R3), (R6)
    out.set(OutputKey::ball_precession_rad_s, si.nut_speed + state.p * si.speed);
    let (u, tau) = (state.u * si.speed, state.tau * si.speed);
    out.set(OutputKey::ball_omega_t_rad_s, u + si.nut_speed * case.sin_a);
    out.set(OutputKey::ball_omega_n_rad_s, spin * case.cos_b - tau * case.sin_b);
    let omega_b = spin * case.sin_b + tau * case.cos_b + si.nut_speed * case.cos_a;
    out.set(OutputKey::ball_omega_b_rad_s, omega_b);

    // ψ = atan2(−V_y, −V_x)                                               (K15)
    let sense = back.select(case.constant(-1.0), case.constant(1.0));
    slip_angle(out, OutputKey::nut_slip_angle_deg, times(-sense, state.nut));
    slip_angle(out, OutputKey::minor_slip_angle_deg, times(sense, state.next.minor));
    slip_angle(out, OutputKey::screw_slip_angle_deg, times(sense, contacts.screw));
    imbalance
}

/// Stores the direction of friction, by its parts across the groove and along the helix.
#[inline(always)]
pub(super) fn slip_angle<S: Simd>(out: &mut Out<'_, '_>, key: OutputKey, friction: Plane<S>) {
    if out.wants(&[key]) {
        out.set(key, friction[1].zip(friction[0], f64::atan2).each(direction_deg));
    }
}
