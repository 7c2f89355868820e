//! Independent implementation of the rigid model for the compared solvers that run their own Newton
//! iteration on given equations. It contains the conversion from user units, the starting point,
//! the residual, the analytic Jacobian and the outputs.
//!
//! The equations come from `docs/theory/04-rigid.md` and have the unknowns `Q_A/F_a, Q_A'/F_a,
//! Q_B/F_a, p, u, τ, s`. Speeds are divided by W including its sign, so driving and back-driving
//! differ only in the sign of the friction.

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector};

use crate::points::Point;

pub(crate) type Vector = SVector<f64, 7>;
pub(crate) type Matrix = SMatrix<f64, 7, 7>;

/// Norm of the weighted residual below which a point counts as solved.
pub(crate) const TOLERANCE: f64 = 1e-10;

/// Maximum number of steps of a compared Newton solver. The solver of this project has the same
/// limit.
pub(crate) const MAX_STEPS: usize = 8;

/// Efficiency; loads of the contacts A, A' and B \[N\]; and the unknowns p, u, τ, s.
pub(crate) type Answer = [f64; 8];

/// An operating point in dimensionless form. Lengths are scaled by the ball radius, forces by the
/// axial load, and speeds by the relative speed W.
#[derive(Debug, Clone, Copy)]
pub(crate) struct System {
    /// Friction coefficient with the sign of W, `F = sign(W) f`.
    friction: f64,
    /// Ratio of pitch circle radius to ball radius, `r_m/r_b`.
    radius: f64,
    /// Dimensionless arc length of the helix per radian, `d/r_b`.
    arc: f64,
    cos_a: f64,
    sin_b: f64,
    cos_b: f64,
    sin_2b: f64,
    cos_2b: f64,
    /// Components of the screw axis along `(t, N, e_x)`.
    k: [f64; 3],
    /// Dimensionless centrifugal force, `m r_m W²/F_a`.
    mu: f64,
    /// Dimensionless moment of inertia of the ball, `I W²/(r_b F_a)`.
    inertia: f64,
    /// Dimensionless nut speed, `Ω_n/W`.
    nut_speed: f64,
    /// Axial load per ball `F_a` \[N\].
    load: f64,
    /// Factors that multiply the residuals of the equations.
    pub(crate) weights: Vector,
    /// First-order approximation of the unknowns, used as the starting point.
    pub(crate) start: Vector,
}

/// Direction of the slip at one contact, and derivatives of this direction with respect to p, u, τ,
/// s.
#[derive(Debug, Clone, Copy)]
struct Slip {
    along: f64,
    across: f64,
    rate: [f64; 4],
}

impl Slip {
    /// Creates the slip direction from the slip components along t and along e_x, and from their
    /// derivatives with respect to p, u, τ, s.
    fn of(along: f64, across: f64, slopes: [(f64, f64); 4]) -> Self {
        let inverse = (along * along + across * across).sqrt().recip();
        let (along, across) = (along * inverse, across * inverse);
        let rate = slopes.map(|(t, x)| (along * x - across * t) * inverse);
        Self { along, across, rate }
    }
}

/// Intermediate results that both the residual and the Jacobian need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State {
    /// Slip directions at the contacts A, A' and B.
    slip: [Slip; 3],
    /// Precession rate divided by the relative speed, `P/W`.
    rate: f64,
}

impl System {
    pub(crate) fn new(point: &Point) -> Self {
        let [
            ball_mm,
            pitch_mm,
            lead_deg,
            contact_deg,
            f,
            density,
            screw_rpm,
            nut_rpm,
            axial,
            balls,
        ] = *point;
        let (r_b, r_m) = (0.5e-3 * ball_mm, 0.5e-3 * pitch_mm);
        let (sin_a, cos_a) = lead_deg.to_radians().sin_cos();
        let (sin_b, cos_b) = contact_deg.to_radians().sin_cos();
        let (sin_2b, cos_2b) = (2.0 * sin_b * cos_b, (cos_b - sin_b) * (cos_b + sin_b));
        let rpm = PI / 30.0;
        let (w, nut_speed) = ((screw_rpm - nut_rpm) * rpm, nut_rpm / (screw_rpm - nut_rpm));
        let load = axial / balls;
        let mass = 4.0 / 3.0 * PI * r_b * r_b * r_b * density;
        let (radius, friction) = (r_m / r_b, f * w.signum());
        let mu = mass * r_m * w * w / load;
        let (arc, tan_a) = (radius / cos_a, sin_a / cos_a);

        let d = (cos_b * cos_b + tan_a * tan_a).sqrt();
        let (sin_psi, cos_psi) = (tan_a / d, cos_b / d);
        let lever = cos_a * cos_b + sin_a * tan_a / cos_b;
        let p = 0.5 - 0.5 * cos_a * lever / radius;
        let rate = p + nut_speed;
        let push = sin_b - friction * d;
        let unloaded =
            push / (sin_2b - friction * (cos_2b + rate.signum() * w.signum() * sin_psi) / cos_psi);
        let margin = p * tan_a - 2.5 * f * sin_2b * unloaded * rate.abs();
        let q = (cos_a * push).recip();
        let u = -margin * radius / lever;
        let tau = -u * sin_psi / cos_psi - p * arc;
        let s = -2.0 * friction * q / (d * cos_a);
        let start = [q, unloaded * mu * rate * rate, q, p, u, tau, s].into();

        let mut weights = Vector::repeat(mu.max(1.0).recip());
        weights[4] = (mu * (rate * rate).max(1.0) * rate.abs().min(1.0)).recip();
        Self {
            friction,
            radius,
            arc,
            cos_a,
            sin_b,
            cos_b,
            sin_2b,
            cos_2b,
            k: [sin_a, cos_a * sin_b, cos_a * cos_b],
            mu,
            inertia: 0.4 * mu / radius,
            nut_speed,
            load,
            weights,
            start,
        }
    }

    pub(crate) fn state(&self, y: &Vector) -> State {
        let [[_, _, _, p, u, tau, s]] = y.data.0;
        let Self { arc, sin_2b, cos_2b, k, .. } = *self;
        let rate = p + self.nut_speed;
        let by_moment = sin_2b / (self.inertia * rate);
        let spin = s * by_moment;
        State {
            slip: [
                Slip::of(arc * p + tau, -u, [(arc, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 0.0)]),
                Slip::of(
                    arc * p + tau * cos_2b + spin,
                    -u,
                    [(arc - spin / rate, 0.0), (0.0, -1.0), (cos_2b, 0.0), (by_moment, 0.0)],
                ),
                Slip::of(
                    arc * (p - 1.0) - tau + k[2],
                    u - k[0],
                    [(arc, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, 0.0)],
                ),
            ],
            rate,
        }
    }

    /// Returns the contributions of friction to the equations. The arguments are the components
    /// `(along, across)` of the friction forces that oppose the slip at A, A' and B.
    fn friction_rows(&self, [a, m, b]: [(f64, f64); 3]) -> Vector {
        let Self { sin_2b, cos_2b, k, .. } = *self;
        let unloaded_e = cos_2b * m.1;
        let unloaded_n = sin_2b * m.1;
        [
            -(a.0 + m.0 + b.0),
            -unloaded_n,
            -(a.1 + b.1 + unloaded_e),
            a.1 + m.1 - b.1,
            -sin_2b * m.0,
            -(a.0 + cos_2b * m.0 - b.0),
            -k[0] * (a.0 + m.0) - k[1] * unloaded_n - k[2] * (a.1 + unloaded_e),
        ]
        .into()
    }

    /// Returns the residual, multiplied by the weights of the equations.
    pub(crate) fn residual(&self, y: &Vector, state: &State) -> Vector {
        let [[q_a, q_m, q_b, _, u, tau, s]] = y.data.0;
        let Self { sin_2b, cos_2b, k, .. } = *self;
        let loads = [q_a, q_m, q_b];
        let mut r = self.friction_rows(std::array::from_fn(|i| {
            let force = self.friction * loads[i];
            (force * state.slip[i].along, force * state.slip[i].across)
        }));
        let centrifugal = self.mu * state.rate * state.rate;
        let gyro = self.inertia * state.rate;
        r[1] += q_a - q_b + cos_2b * q_m - centrifugal * self.cos_b;
        r[2] += centrifugal * self.sin_b - sin_2b * q_m;
        r[3] += k[2] * s - gyro * k[1] * tau;
        r[4] += gyro * (k[0] * tau - k[2] * u);
        r[5] += gyro * k[1] * u - k[0] * s;
        r[6] += k[1] * (q_a + cos_2b * q_m) - k[2] * sin_2b * q_m - 1.0;
        r.component_mul(&self.weights)
    }

    /// Returns the Jacobian of the residual, multiplied by the weights of the equations.
    pub(crate) fn jacobian(&self, y: &Vector, state: &State) -> Matrix {
        let [[q_a, q_m, q_b, _, u, tau, _]] = y.data.0;
        let Self { friction, sin_2b, cos_2b, k, inertia, .. } = *self;
        let normal = [
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, k[1]],
            [0.0, cos_2b, -sin_2b, 0.0, 0.0, 0.0, k[1] * cos_2b - k[2] * sin_2b],
            [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ];
        let centrifugal = 2.0 * self.mu * state.rate;
        let gyro = inertia * state.rate;
        let inertial = [
            [
                0.0,
                -centrifugal * self.cos_b,
                centrifugal * self.sin_b,
                -inertia * k[1] * tau,
                inertia * (k[0] * tau - k[2] * u),
                inertia * k[1] * u,
                0.0,
            ],
            [0.0, 0.0, 0.0, 0.0, -gyro * k[2], gyro * k[1], 0.0],
            [0.0, 0.0, 0.0, -gyro * k[1], gyro * k[0], 0.0, 0.0],
            [0.0, 0.0, 0.0, k[2], 0.0, -k[0], 0.0],
        ];

        let mut jacobian = Matrix::zeros();
        for (i, normal) in normal.into_iter().enumerate() {
            let mut forces = [(0.0, 0.0); 3];
            forces[i] = (friction * state.slip[i].along, friction * state.slip[i].across);
            jacobian.set_column(i, &(self.friction_rows(forces) + Vector::from(normal)));
        }
        let loads = [q_a, q_m, q_b];
        for (j, inertial) in inertial.into_iter().enumerate() {
            // The derivative of a unit vector is perpendicular to the vector.
            let forces = std::array::from_fn(|i| {
                let turn = friction * loads[i] * state.slip[i].rate[j];
                (-turn * state.slip[i].across, turn * state.slip[i].along)
            });
            jacobian.set_column(3 + j, &(self.friction_rows(forces) + Vector::from(inertial)));
        }
        for mut column in jacobian.column_iter_mut() {
            column.component_mul_assign(&self.weights);
        }
        jacobian
    }

    /// Returns the outputs of a root, or `None` if a contact load is tensile or if the root is the
    /// spurious root at infinity.
    pub(crate) fn answer(&self, y: &Vector, state: &State) -> Option<Answer> {
        let [[q_a, q_m, q_b, p, u, tau, s]] = y.data.0;
        let speed = p.abs().max(u.abs()).max(tau.abs());
        if !(q_a > 0.0 && q_m > 0.0 && q_b > 0.0 && speed < 10.0 * self.arc) {
            return None;
        }
        let Self { radius, k, cos_a, sin_b, cos_b, .. } = *self;
        let (along, across) =
            (self.friction * q_b * state.slip[2].along, self.friction * q_b * state.slip[2].across);
        let torque = k[0] * (radius * sin_b * q_b + (radius * cos_b - 1.0) * across)
            + cos_a * (cos_b - radius) * along;
        let ideal = radius * k[0] / cos_a;
        let efficiency = if self.friction > 0.0 { ideal / torque } else { torque / ideal };
        Some([efficiency, q_a * self.load, q_m * self.load, q_b * self.load, p, u, tau, s])
    }
}

#[cfg(test)]
mod tests {
    use bsm_benches::seeded;
    use bsm_dyn::model::{RigidSystem, RigidUnknowns};
    use bsm_dyn::{Model, Problem};
    use bsm_kin::{Jet, Real};

    use super::*;
    use crate::points::point;

    /// Compares starting point, residual and Jacobian with the library at points away from the
    /// root. The library calculates derivatives by automatic differentiation and expresses the slip
    /// at A in polar form (R4).
    #[test]
    fn independent_residual_and_jacobian_match_the_library() {
        for (i, case) in seeded(200).iter().enumerate() {
            let Ok(Problem::Rigid(rigid)) = case.problem(&Model::Rigid.into()) else {
                panic!("a rigid problem")
            };
            let (case, system) =
                (System::new(&point(case)), RigidSystem::of(&rigid).expect("friction"));
            // Each coordinate differs from the coordinate of the starting point by up to 3 %. The
            // differences vary from case to case.
            let y = Vector::from_fn(|j, _| {
                case.start[j] * (1.0 + 0.03 * f64::from(u32::try_from(i * j).unwrap()).sin())
            });

            let jets = std::array::from_fn(|j| Jet::<7>::variable(y[j], j));
            let [q_a, q_m, q_b, p, u, tau, s] = jets;
            let along = tau + p * case.arc;
            let slip = (u * u + along * along).sqrt();
            let polar = RigidUnknowns::from([q_a, q_m, q_b, p, slip, along.atan2(-u), s]);
            let expected = system.evaluate(&polar).expect("in the domain");

            let state = case.state(&y);
            let (r, jacobian) = (case.residual(&y, &state), case.jacobian(&y, &state));
            for row in 0..7 {
                let weight = system.weights[row];
                let scale =
                    1.0 + weight * expected[row].eps.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
                // Both implementations evaluate the same formulas, but in a different order. Their
                // results therefore differ by the rounding errors of terms of this magnitude.
                let close =
                    |ours: f64, theirs: f64| (ours - weight * theirs).abs() <= 1e-11 * scale;
                assert!(close(r[row], expected[row].re), "{i}: row {row}");
                for column in 0..7 {
                    let slope = expected[row].eps[column];
                    assert!(close(jacobian[(row, column)], slope), "{i}: {row}, {column}");
                }
            }

            let slip = case.start[4].hypot(case.start[5] + case.start[3] * case.arc);
            let signed = slip * system.start[4].signum();
            assert!((signed - system.start[4]).abs() <= 1e-12 * (1.0 + slip), "{i}: start");
            for j in [0, 1, 2, 3, 6] {
                assert!((case.start[j] - system.start[j]).abs() <= 1e-12 * system.start[j].abs());
            }
        }
    }
}
