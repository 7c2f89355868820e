//! Equations of a ball between elastic raceways with friction integrated over the contact ellipses,
//! generic over the scalar type.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T10), (T11).

use std::cell::OnceCell;

use bsm_kin::{ContactMotion, Motion, Over, Real, RealOver, Scalar, Site, relative_rotation};
use bsm_newton::{Backtracking, Convergence, EvalError, JacobianUpdate, Options};
use bsm_simd::{Arch, Simd, WithSimd};
use nalgebra::Vector3;

use super::push::Push;
use crate::cost;
use crate::ellipse::{FrozenRule, Integral, Integrate, Patch, Placement, Quadrature, surface_drop};
use crate::models::ball::equation::{AXIAL_LOAD, FORCE, MOMENT};
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{
    BALL_UNKNOWNS, BallLoads, EhlPoint, ElasticContacts, ScaledFilm, weight,
};

/// Indices of the components of the angular velocity along `$k$`, `$n$` and `$k \times n$` (T4).
pub(super) const OMEGA: [usize; 3] = [4, 5, 6];

/// Accuracy of the coarse quadrature that is used first (relative to the friction force).
pub(crate) const COARSE_ACCURACY: f64 = 1e-4;

/// Accuracy of the quadrature for the search that follows if Newton's method fails with the coarse
/// quadrature (relative to the friction force). The sums of this quadrature are smooth enough for
/// continuation.
pub(crate) const SEARCH_ACCURACY: f64 = 1e-6;

/// Scaled residual at which the solve with the coarse quadrature ends and the solve with the
/// requested quadrature begins.
pub(crate) const COARSE_RESIDUAL: f64 = 1e-3;

/// Maximum scaled residual before the final Newton step of a solve. The residual after this step is
/// not evaluated.
pub(super) const ROOT_RESIDUAL: f64 = 1e-10;

/// Scaled residual below which Newton steps reuse the Jacobian. If the square root of the residual
/// goal exceeds this constant, the square root is used as the limit instead.
const CHORD_RESIDUAL: f64 = 1e-3;

/// Ratio of nut speed to relative speed above which the unknown precession rate is measured
/// relative to the nut.
const FAST_NUT_RATIO: f64 = 2.0;

/// Limits of a solve by Newton's method.
#[derive(Debug, Clone, Copy)]
pub(super) struct NewtonLimits {
    /// Maximum number of Newton steps.
    pub(super) max_steps: usize,
    /// Maximum number of halvings of each step.
    pub(super) max_halvings: u32,
}

/// Default limits of a solve.
const DEFAULT_LIMITS: NewtonLimits = NewtonLimits { max_steps: 20, max_halvings: 6 };

/// Error that is returned if no contact angles exist for the given loads and tilt.
const CONTACT_LOST: EvalError = EvalError {
    quantity: "contact angle of the ball at the nut or the screw",
    value: f64::NAN,
    requirement: "no contact angle exists for the given loads and tilt",
};

/// The traction equations of a ball at an operating point.
#[derive(Clone, Copy)]
pub(super) struct SlipBall<'a, P = f64> {
    pub(super) contacts: &'a ElasticContacts<P>,
    pub(super) quadrature: &'a Quadrature,
    /// Fixed node counts of the quadrature near a root; `None` if the node counts depend on the
    /// slip.
    pub(super) frozen_rules: Option<&'a [OnceCell<FrozenRule>; 2]>,
    pub(super) creep: f64,
    /// Scaled residual up to which a root is refined. The residual tolerance is the larger of this
    /// value and [`ROOT_RESIDUAL`].
    pub(super) residual_goal: f64,
    /// True if the unknowns for high centrifugal loads (T10) are used.
    pub(super) uses_nut_angle: bool,
    /// Lubricant data; `None` for a constant friction coefficient.
    pub(super) lubrication: Option<Lubrication<'a, P>>,
    /// Forces of the neighboring balls; `None` for a ball without neighbors.
    pub(super) push: Option<Push>,
    /// Limits of a solve.
    pub(super) limits: NewtonLimits,
}

/// Lubricant data of a ball, and the method of calculating friction from these data.
#[derive(Clone, Copy)]
pub(super) struct Lubrication<'a, P = f64> {
    pub(super) ehl: &'a EhlPoint<P>,
    /// Fraction of the friction that is calculated from the lubricant, from 0 to 1. The remaining
    /// friction has a constant coefficient.
    pub(super) fraction: f64,
    /// True if all derivatives are calculated at every quadrature node. Otherwise, the small
    /// derivatives with respect to the maximum pressure are omitted.
    pub(super) complete: bool,
}

/// Residuals of the seven equations, torque on the screw, and sliding and rolling power losses at
/// the nut and the screw, in scaled units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evaluation<D = f64> {
    pub(super) residual: [D; BALL_UNKNOWNS],
    pub(super) torque: D,
    /// Sliding powers at the nut and the screw. The powers have no derivatives if they are
    /// calculated with the vectorized sums over the contact ellipses.
    pub(super) sliding: [D; 2],
    pub(super) rolling: [D; 2],
}

/// Torque on the screw, total friction power, and sliding power at the nut and the screw, in scaled
/// units.
#[derive(Debug, Clone, Copy)]
pub(super) struct PowerFlow {
    pub(super) torque: f64,
    pub(super) power: f64,
    pub(super) sliding: [f64; 2],
}

impl<D: Scalar> Evaluation<D> {
    /// Returns the torque and the powers without derivatives.
    pub(super) fn power_flow(&self) -> PowerFlow {
        let (sliding, rolling) = (self.sliding.map(|x| x.re()), self.rolling.map(|x| x.re()));
        let power = sliding[0] + rolling[0] + (sliding[1] + rolling[1]);
        PowerFlow { torque: self.torque.re(), power, sliding }
    }
}

/// Geometry and motion of both contacts of a ball under load. Angles are given by sine and cosine.
pub(super) struct ContactGeometry<D> {
    /// Rotation of the triad from `n` to the mean contact normal (unknowns T1) or to the contact
    /// normal at the nut (unknowns T10).
    rotation: (D, D),
    /// Angles of the contact normals at the nut and the screw in the rotated triad.
    tilts: [(D, D); 2],
    /// Contact angles at the nut and the screw.
    pub(super) angles: [(D, D); 2],
    /// Contact ellipses with the motions of the ball relative to the raceways.
    pub(super) patches: [Patch<D>; 2],
}

/// Distances from the ball center to the centers of the groove arcs.
struct ArcDistances<D> {
    /// Cube roots of the ratios of normal load to axial load per ball.
    growth: [D; 2],
    lengths: [D; 2],
}

/// Mean contact angle, and contact angles at the nut and the screw. Each angle is given by sine and
/// cosine.
pub(super) struct MeanAngle<D> {
    pub(super) mean: (D, D),
    pub(super) contacts: [(D, D); 2],
}

/// Returns the angular velocity relative to the nut as components along t, n and b.
///
/// * `lead`: sine and cosine of the lead angle.
#[inline(always)]
pub(super) fn frenet<P: Copy, D: RealOver<P>>(
    (sin, cos): (P, P),
    y: &[D; BALL_UNKNOWNS],
) -> [D; 3] {
    let [along, radial, around] = [y[OMEGA[0]], y[OMEGA[1]], y[OMEGA[2]]];
    // ω' = ω'_k k + ω'_n n + ω'_c k × n                                   (T4)
    [along * sin - around * cos, radial, along * cos + around * sin]
}

/// Returns the second and third components of the vector that has the given components along `$N =
/// \pm(0, \cos, \sin)$` and `$t \times N$`.
///
/// * `i`: index of the contact: 0 for the nut, 1 for the screw.
/// * `(sin, cos)`: sine and cosine of the angle of `$N$`.
#[inline(always)]
pub(crate) fn turned<D: Real>(i: usize, (sin, cos): (D, D), (normal, across): (D, D)) -> (D, D) {
    let (second, third) = (cos * normal - sin * across, sin * normal + cos * across);
    if i == 0 { (second, third) } else { (-second, -third) }
}

impl<P: Scalar> SlipBall<'_, P> {
    /// Returns the distances from the ball center to the arc centers, or `None` if a contact
    /// carries no load.
    #[inline(always)]
    fn arc_distances<D: Over<P>>(&self, y: &[D; BALL_UNKNOWNS]) -> Option<ArcDistances<D>> {
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        let scaled = &self.contacts.scaled;
        // a ~ Q^{1/3},  δ = (Q/K_H)^{2/3}                                 (P6), (P2)
        let growth = [loads[0].cbrt(), loads[1].cbrt()];
        let lengths = [
            growth[0].square() * scaled.approaches[0] + scaled.offsets[0],
            growth[1].square() * scaled.approaches[1] + scaled.offsets[1],
        ];
        let pressed = loads[0].re() > 0.0 && loads[1].re() > 0.0;
        pressed.then_some(ArcDistances { growth, lengths })
    }

    /// Calculates the contact angles from the tilt and from the distances between the ball center
    /// and the arc centers. Returns `None` if no contact angles satisfy (J7).
    ///
    /// * `(sin_y, cos_y)`: sine and cosine of the tilt.
    #[inline(always)]
    fn mean_angle<D: Over<P>>(
        &self,
        [l_a, l_b]: [D; 2],
        (sin_y, cos_y): (D, D),
    ) -> Option<MeanAngle<D>> {
        let a_2 = self.contacts.scaled.radial_distance;
        // l_A cos(β − ν) + l_B cos(β + ν) = A₂ = S cosβ + D sinβ          (J7)
        let (s, d) = ((l_a + l_b) * cos_y, (l_a - l_b) * sin_y);
        let both = s * s + d * d;
        let square = both - a_2 * a_2;
        if !(square.re() > 0.0 && s.re() > 0.0) {
            return None;
        }
        let (height, per_both) = (square.sqrt(), both.recip());
        let sin = (height * s + d * a_2) * per_both;
        let cos = (s * a_2 - height * d) * per_both;
        Some(MeanAngle {
            mean: (sin, cos),
            contacts: [
                (sin * cos_y - cos * sin_y, cos * cos_y + sin * sin_y),
                (sin * cos_y + cos * sin_y, cos * cos_y - sin * sin_y),
            ],
        })
    }

    /// Returns the contact angles under load for given unknowns, or `None` if a contact is lost.
    ///
    /// * `tilt`: sine and cosine of the tilt.
    #[inline(always)]
    pub(super) fn loaded_angles<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
        tilt: (D, D),
    ) -> Option<MeanAngle<D>> {
        self.mean_angle(self.arc_distances(y)?.lengths, tilt)
    }

    /// Returns the motions of the ball relative to the nut and the screw in contact coordinates.
    ///
    /// * `angles`: sines and cosines of the contact angles.
    #[inline(always)]
    pub(super) fn contact_motions<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
        angles: [(D, D); 2],
    ) -> [ContactMotion<D>; 2] {
        let (lead, arc) = (self.contacts.scaled.lead, self.contacts.scaled.arc);
        let from_nut = self.rate_to_nut(y);
        let to_nut = frenet(lead, y);
        let to_screw = relative_rotation(to_nut, arc.constant(1.0), lead);
        [
            ContactMotion::at_angle(Site::Nut, from_nut * arc, to_nut, angles[0]),
            ContactMotion::at_angle(Site::Screw, (from_nut - 1.0) * arc, to_screw, angles[1]),
        ]
    }

    /// Returns the geometry of the contacts for given unknowns, or `None` if a contact is lost.
    #[inline(always)]
    fn contact_geometry<D: Over<P>>(&self, y: &[D; BALL_UNKNOWNS]) -> Option<ContactGeometry<D>> {
        let ArcDistances { growth, lengths: [l_a, l_b] } = self.arc_distances(y)?;
        let (zero, one) = (l_a.constant(0.0), l_a.constant(1.0));
        let scaled = &self.contacts.scaled;
        let tilt @ (sin_y, cos_y) = y[TILT].sin_cos();
        let (rotation, tilts, angles);
        if self.uses_nut_angle {
            // cosβ_B = (A₂ − l_A cosβ_A)/l_B                              (J9)
            let cos = (-(l_a * cos_y) + scaled.radial_distance) / l_b;
            let square = (-cos + 1.0) * (cos + 1.0);
            let exists = square.re() > 0.0;
            let sin = exists.then(|| square.sqrt())?;
            let between = (sin * cos_y - cos * sin_y, cos * cos_y + sin * sin_y);
            (rotation, tilts, angles) = (tilt, [(zero, one), between], [tilt, (sin, cos)]);
        } else {
            let mean = self.mean_angle([l_a, l_b], tilt)?;
            (rotation, tilts, angles) = (mean.mean, [(-sin_y, cos_y), tilt], mean.contacts);
        }
        let motions = self.contact_motions(y, angles);
        let mut patches = [Patch {
            semi_axes: (zero, zero),
            pressed_radius: zero,
            ball_radius: one,
            motion: [zero; 4],
            creep: zero + self.creep,
        }; 2];
        for i in 0..2 {
            let ContactMotion { speed, omega: [t, n, c] } = motions[i];
            let (a, b) = scaled.semi_axes[i];
            patches[i].semi_axes = (growth[i] * a, growth[i] * b);
            patches[i].pressed_radius = zero + scaled.pressed_radius[i];
            patches[i].motion = [speed, t, n, c];
        }
        Some(ContactGeometry { rotation, tilts, angles, patches })
    }

    /// Returns the residuals of the seven equations of the ball (P5), and the torque on the screw
    /// (B7).
    ///
    /// * `friction`: friction force and moment on the ball at the nut and the screw.
    /// * `rate`: precession rate from which the inertia forces are calculated.
    #[inline(always)]
    fn balance<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
        geometry: &ContactGeometry<D>,
        friction: &[Integral<D>; 2],
        rate: D,
    ) -> ([D; BALL_UNKNOWNS], D) {
        let scaled = &self.contacts.scaled;
        let (sin_lead, cos_lead) = scaled.lead;
        let ([force_t, force_n, force_c], [moment_t, moment_n, moment_c]) = (FORCE, MOMENT);
        let mut residual = [y[0].constant(0.0); BALL_UNKNOWNS];
        let mut torque = residual[0];
        for i in 0..2 {
            // F = Q N + f Q ∫ dF,  M = f Q ∫ dM                           (T2)
            let Integral { force: [f_t, f_c], moment: [m_t, m_n, m_c] } = friction[i];
            let load = [y[NUT_LOAD], y[SCREW_LOAD]][i];
            let (f_2, f_3) = turned(i, geometry.tilts[i], (load, f_c));
            let (m_2, m_3) = turned(i, geometry.tilts[i], (m_n, m_c));
            residual[force_t] += f_t;
            residual[force_n] += f_2;
            residual[force_c] += f_3;
            residual[moment_t] += m_t;
            residual[moment_n] += m_2;
            residual[moment_c] += m_3;
            let (_, f_b) = turned(i, geometry.angles[i], (load, f_c));
            if i == 0 {
                // F_nut·k − F_a                                           (P5)
                residual[AXIAL_LOAD] = f_t * sin_lead + f_b * cos_lead - 1.0;
            } else {
                let (_, m_b) = turned(i, geometry.angles[i], (m_n, m_c));
                // T = [(−r_m n) × F + M]·k                                (B7)
                torque = m_t * sin_lead
                    + m_b * cos_lead
                    + (f_t * cos_lead - f_b * sin_lead) * scaled.radius;
            }
        }
        let (sin, cos) = geometry.rotation;
        let [_, radial, around] = [y[OMEGA[0]], y[OMEGA[1]], y[OMEGA[2]]];
        // Σ F − m r_m P² n                                                (B4)
        let centrifugal = rate * rate * scaled.inertia_ratio();
        residual[force_n] -= centrifugal * cos;
        residual[force_c] += centrifugal * sin;
        // Σ M − I P (ω'_n k × n − ω'_c n)                                 (B5), (T5)
        let gyro = rate * scaled.ball().inertia();
        let (turning, radial) = (radial * sin_lead, radial * cos_lead);
        residual[moment_t] += gyro * radial;
        residual[moment_n] -= gyro * (sin * turning - cos * around);
        residual[moment_c] -= gyro * (cos * turning + sin * around);
        (residual, torque)
    }
}

impl<P: Scalar> SlipBall<'_, P> {
    /// Returns the loaded contacts for given unknowns.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(super) fn loaded<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
    ) -> Result<BallLoads<D>, EvalError> {
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        if self.uses_nut_angle {
            // The unknowns are Q_A/F_a, β_A, Q_B/F_a, (P − Ω_n)/W, …      (T10)
            self.contacts.loaded_by_nut_angle(loads, y[TILT])
        } else {
            self.contacts.loaded(loads, y[TILT])
        }
    }

    /// Returns the motion of the ball relative to the nut for given unknowns.
    pub(super) fn motion_to_nut<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
        loaded: &BallLoads<D>,
    ) -> Motion<D> {
        let [t, n, b] = frenet(self.contacts.scaled.lead, y);
        Motion {
            precession: self.rate_to_nut(y),
            omega: loaded.frame.from_frenet(&Vector3::new(t, n, b)),
        }
    }

    /// Returns the precession rate relative to the nut for given unknowns.
    #[inline(always)]
    fn rate_to_nut<D: Over<P>>(&self, y: &[D; BALL_UNKNOWNS]) -> D {
        y[PRECESSION] + (self.offset() - self.contacts.scaled.nut_speed)
    }

    /// Evaluates the equations for given unknowns.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(super) fn evaluated<D: Integrate<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
    ) -> Result<Evaluation<D>, EvalError> {
        let rate = y[PRECESSION] + self.offset();
        self.evaluated_at(y, D::from(self.contacts.friction), rate)
    }

    /// Evaluates the equations with a different friction coefficient and with inertia forces
    /// calculated from a different precession rate.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(super) fn evaluated_at<D: Integrate<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
        friction: D,
        rate: D,
    ) -> Result<Evaluation<D>, EvalError> {
        cost::count_evaluation();
        let mut found = Arch::new().dispatch(Evaluate { ball: self, y, friction, rate })?;
        if let Some(push) = &self.push {
            let loaded = self.loaded(y)?;
            let to_nut = self.motion_to_nut(y, &loaded);
            push.add_to(&mut found.residual, self.contacts, (&loaded, &to_nut));
        }
        Ok(found)
    }

    /// Returns the placement of the quadrature nodes at the nut (0) or the screw (1).
    pub(super) fn nodes(&self, i: usize) -> Placement<'_> {
        Placement {
            rule: self.quadrature,
            frozen_rule: self.frozen_rules.map(|rules| &rules[i]),
            coarse: self.is_coarse_solve() && self.lubrication.is_none(),
        }
    }

    /// Returns true if the root serves only as a starting value for a solve with another
    /// quadrature.
    pub(super) fn is_coarse_solve(&self) -> bool {
        self.residual_goal >= COARSE_RESIDUAL
    }

    /// Returns the difference between the precession rate and the unknown that represents it in the
    /// equations.
    ///
    /// If the nut speed is large compared with the relative speed, or if the ball almost sticks to
    /// the nut, this function returns the nut speed. This choice avoids cancellation in the slip.
    /// Otherwise, the function returns zero.
    #[inline(always)]
    pub(super) fn offset(&self) -> P {
        let nut = self.contacts.scaled.nut_speed;
        if self.uses_nut_angle || nut.re().abs() > FAST_NUT_RATIO { nut } else { P::from(0.0) }
    }

    /// Returns the residuals of the seven equations for given unknowns.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    pub(super) fn residual<D: Integrate<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        Ok(self.evaluated(y)?.residual)
    }
}

/// Arguments for evaluating the equations of a ball without neighbors.
struct Evaluate<'a, P, D> {
    ball: &'a SlipBall<'a, P>,
    y: &'a [D; BALL_UNKNOWNS],
    friction: D,
    rate: D,
}

impl<P: Scalar, D: Integrate<P>> WithSimd for Evaluate<'_, P, D> {
    type Output = Result<Evaluation<D>, EvalError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { ball, y, friction, rate } = self;
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        let geometry = ball.contact_geometry(y).ok_or(CONTACT_LOST)?;
        let zero = D::from(0.0);
        let mut wrench = [Integral { force: [zero; 2], moment: [zero; 3] }; 2];
        let (mut sliding, mut rolling) = ([zero; 2], [zero; 2]);
        let nodes = [ball.nodes(0), ball.nodes(1)];
        let fraction = ball.lubrication.as_ref().map_or(0.0, |oil| oil.fraction);
        if fraction < 1.0 {
            let sums = D::dry(simd, &geometry.patches, &nodes, false);
            for i in 0..2 {
                let (unit, power) = &sums[i];
                let pull = loads[i] * ball.contacts.signed(friction);
                // P_f = Σ f Q ∫ dP                                        (P7)
                sliding[i] = pull * *power;
                // f Q ∫ dF,  f Q ∫ dM                                     (T2)
                wrench[i] = unit.times(pull * (1.0 - fraction));
            }
        }
        if let Some(oil) = &ball.lubrication {
            let losses = oil.losses(simd, ball, (&geometry, loads), &nodes);
            for i in 0..2 {
                let loss = &losses[i];
                wrench[i].add_times(&loss.wrench, fraction);
                (sliding[i], rolling[i]) = (loss.sliding, loss.rolling);
            }
        }
        let (residual, torque) = ball.balance(y, &geometry, &wrench, rate);
        Ok(Evaluation { residual, torque, sliding, rolling })
    }
}

/// Force, moment and power losses due to friction and rolling resistance at a lubricated contact.
struct ContactLoss<D> {
    wrench: Integral<D>,
    sliding: D,
    rolling: D,
}

impl<P: Scalar> Lubrication<'_, P> {
    /// Calculates the friction and the rolling resistance at the nut and the screw.
    #[inline(always)]
    fn losses<S: Simd, D: Integrate<P>>(
        &self,
        simd: S,
        ball: &SlipBall<'_, P>,
        (geometry, loads): (&ContactGeometry<D>, [D; 2]),
        nodes: &[Placement<'_>; 2],
    ) -> [ContactLoss<D>; 2] {
        let (contacts, creep) = (ball.contacts, ball.creep);
        let (cos_lead, per_arc) = (contacts.scaled.lead.1, contacts.scaled.arc.recip());
        let film = |i: usize| {
            let [speed, _, _, around] = geometry.patches[i].motion;
            // `k_c` is the component k·(t × N) of the direction of the screw axis.
            let k_c = geometry.angles[i].1 * cos_lead * [1.0, -1.0][i];
            self.ehl.of_motion(i, loads[i], [speed * per_arc, speed, around], k_c, creep)
        };
        let films = [film(0), film(1)];
        let (laws, thickness) =
            ([&films[0].law, &films[1].law], [films[0].thickness, films[1].thickness]);
        let sums = if self.complete {
            let exact = |i: usize| geometry.patches[i].integrate(laws[i], nodes[i]);
            [exact(0), exact(1)]
        } else {
            D::lubricated(simd, &geometry.patches, laws, thickness, nodes)
        };
        let loss = |i: usize| {
            let ([speed, _, _, around], (unit, power)) = (geometry.patches[i].motion, sums[i]);
            let load = contacts.signed(loads[i]);
            let [force, couple] = films[i].rolling_resistance(around, creep);
            let mut wrench = unit.times(load);
            // ∫ dF + F_h,  ∫ r × dF + r × F_h + C_h                       (Y32)
            wrench.force[0] += contacts.signed(force);
            wrench.moment[2] += contacts.signed(force + couple);
            let resistance_power =
                ScaledFilm::rolling_resistance_power([force, couple], speed, around);
            ContactLoss {
                wrench,
                sliding: load * power,
                rolling: contacts.signed(resistance_power),
            }
        };
        [loss(0), loss(1)]
    }
}

impl<'a, P> SlipBall<'a, P> {
    /// Creates the equations for the unknowns (T1), without lubricant and without neighboring
    /// balls.
    pub(super) fn of_contacts(
        contacts: &'a ElasticContacts<P>,
        quadrature: &'a Quadrature,
        creep: f64,
    ) -> Self {
        Self {
            contacts,
            quadrature,
            frozen_rules: None,
            creep,
            residual_goal: 1e-12,
            uses_nut_angle: false,
            lubrication: None,
            push: None,
            limits: DEFAULT_LIMITS,
        }
    }

    /// Returns the options for solving the equations with Newton's method.
    pub(super) fn options(&self) -> Options {
        let NewtonLimits { max_steps, max_halvings } = self.limits;
        let by_jets = self.lubrication.as_ref().is_some_and(|lubrication| lubrication.complete);
        let chord_below = if by_jets { 0.0 } else { self.residual_goal.sqrt().max(CHORD_RESIDUAL) };
        Options {
            convergence: Convergence {
                residual_tol: self.residual_goal.max(ROOT_RESIDUAL),
                residual_goal: self.residual_goal,
                max_steps,
            },
            damping: Backtracking { max_halvings },
            jacobian: JacobianUpdate::EveryTrial { chord_below },
        }
    }
}

impl SlipBall<'_> {
    /// Returns the unknowns (T1) or (T10) that correspond to given contacts and motion.
    pub(super) fn unknowns(
        &self,
        loaded: &BallLoads<f64>,
        to_nut: &Motion<f64>,
    ) -> [f64; BALL_UNKNOWNS] {
        let mut y = [0.0; BALL_UNKNOWNS];
        [y[NUT_LOAD], y[SCREW_LOAD]] = loaded.loads;
        y[TILT] = if self.uses_nut_angle { loaded.angles[0] } else { loaded.tilt };
        y[PRECESSION] = to_nut.precession + self.contacts.scaled.nut_speed - self.offset();
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        for (place, axis) in OMEGA.iter().zip([k, n, k.cross(&n)]) {
            y[*place] = to_nut.omega.dot(&axis);
        }
        y
    }

    /// Returns the precession rate divided by `$W$`.
    pub(super) fn rate(&self, y: &[f64; BALL_UNKNOWNS]) -> f64 {
        y[PRECESSION] + self.offset()
    }

    /// Returns the weights of the seven equations (T3).
    pub(super) fn weights(&self, y: &[f64; BALL_UNKNOWNS]) -> [f64; BALL_UNKNOWNS] {
        self.weights_of(y, self.contacts.friction, self.rate(y))
    }

    /// Returns the weights of the seven equations (T3) for a given friction coefficient and for
    /// inertia forces at a given precession rate.
    pub(super) fn weights_of(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        friction: f64,
        rate: f64,
    ) -> [f64; BALL_UNKNOWNS] {
        let centrifugal = self.contacts.inertia_ratio() * rate * rate;
        let across = if self.uses_nut_angle {
            centrifugal.min(self.friction_force(y, friction, centrifugal))
        } else {
            centrifugal
        };
        let (force, moment) = sizes(across, friction, self.lever(y));
        let [force, pressing, moment] = [force, centrifugal.max(1.0), moment].map(weight);
        [force, pressing, force, moment, moment, moment, force]
    }

    /// Returns an upper estimate of the friction force at the nut. The slip is a difference between
    /// velocities, but the estimate uses the sum of their magnitudes (T11).
    ///
    /// * `load`: centrifugal force divided by the axial load.
    fn friction_force(&self, y: &[f64; BALL_UNKNOWNS], friction: f64, load: f64) -> f64 {
        // f C (|P − Ω_n| r_m + |ω'|)/v_e                                  (T11)
        let turning = OMEGA.iter().map(|i| y[*i].abs()).sum::<f64>();
        let slip = y[PRECESSION].abs() * self.contacts.helix.radius + turning;
        friction * load * slip / self.creep
    }

    /// Returns the largest lever arm of the friction forces, divided by the ball radius.
    pub(super) fn lever(&self, y: &[f64; BALL_UNKNOWNS]) -> f64 {
        let lengths = [(0, NUT_LOAD), (1, SCREW_LOAD)]
            .map(|(i, load)| self.contacts.scaled.semi_axes[i].0 * Real::cbrt(y[load]));
        lever(lengths, self.contacts.scaled.pressed_radius)
    }
}

/// Returns the largest lever arm of the friction forces, divided by the ball radius, `$h \ge 1$`.
/// The lever arm exceeds 1 if the semi-axis of an ellipse exceeds the ball radius, or if the
/// contact surface drops by more than the ball radius toward the end of the ellipse.
///
/// * `semi_axes`, `pressed_radius`: semi-axes of the loaded ellipses across the grooves and radii
///   of the contact surfaces, divided by the ball radius.
fn lever(semi_axes: [f64; 2], pressed_radius: [f64; 2]) -> f64 {
    let drops = [0, 1].map(|i| surface_drop(semi_axes[i], pressed_radius[i]));
    semi_axes.into_iter().chain(drops).fold(1.0, f64::max)
}

/// Returns the typical magnitudes of forces and moments, divided by the axial load and (for
/// moments) by the ball radius.
///
/// * `force`: ratio of inertia force to axial load.
fn sizes(force: f64, friction: f64, lever: f64) -> (f64, f64) {
    // D_F = diag(w, w₀, w, w/(f h), w/(f h), w/(f h), w)                  (T3)
    let force = force.max(1.0);
    (force, force * friction.min(1.0) * lever)
}
