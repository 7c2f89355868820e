//! The equations of a ball, with both contacts in one call, and their Jacobian in closed form.
//!
//! The equations are those of [`SlipBall::residual`], and the columns of the Jacobian are the
//! derivatives of its jets. Tests compare both. A state in which the contacts do not exist is left
//! to [`SlipBall::residual`].
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T10), (T23).

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use bsm_kin::Jet;
use bsm_newton::EvalError;
use bsm_simd::{Arch, BLOCK, Compare, Lane, Simd, WithSimd};

use super::equations::{Lubrication, OMEGA, SlipBall};
use crate::contact::torque;
use crate::cost;
use crate::ellipse::{Dry, OilLaw, Patch, PointLaw, Resultants, SUMS, sums};
use crate::models::ball::equation::{AXIAL_LOAD, FORCE, MOMENT};
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{BALL, EhlPoint, FILM_LOAD_EXPONENT, ScaledBall, ScaledFilm, linear};

/// What belongs to a state, all scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct EquationValues<F = f64> {
    /// What the seven equations leave over.
    pub(super) residual: [F; BALL],
    pub(super) transmitted: PowerFlow<F>,
    /// Derivatives of the equations and of the torque by the unknowns, if asked for, and a place that is zero.
    pub(super) rows: [Partials<F>; BALL],
    pub(super) slope: Partials<F>,
}

/// A number for each unknown, and a place that is zero.
type Partials<F> = [F; BLOCK];

/// Numbers of a point in units of ball radius, axial load per ball and relative speed, as the equations take
/// them.
#[derive(Debug, Clone, Copy, Default)]
pub struct TractionPoint<F = f64> {
    /// The ball and its contacts.
    pub scaled: ScaledBall<F>,
    /// Coefficient against a slip over `$W$`.
    pub friction: F,
    /// What the unknown of the precession leaves out of its rate.
    pub offset: F,
    /// Creep speed.
    pub creep: F,
    /// The unknowns are those of a ball under a high centrifugal load (T10).
    pub nut_chart: bool,
}

impl SlipBall<'_> {
    /// The equations at a state, with derivatives if `JACOBIAN`; of a lubricant, unless they are to be complete, without
    /// those of rolling resistance and of the coefficient by the load.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if a contact is lost.
    pub(super) fn evaluated<const JACOBIAN: bool>(
        &self,
        y: &[f64; BALL],
    ) -> Result<EquationValues, EvalError> {
        let mut found = EquationValues::zero(0.0);
        self.evaluate::<JACOBIAN>(y, &mut found)?;
        Ok(found)
    }

    /// The same in place; without `JACOBIAN` derivatives may stay those of another state.
    pub(super) fn evaluate<const JACOBIAN: bool>(
        &self,
        y: &[f64; BALL],
        found: &mut EquationValues,
    ) -> Result<(), EvalError> {
        cost::evaluated();
        (found.residual, found.transmitted) = ([0.0; BALL], PowerFlow::zero(0.0));
        if JACOBIAN {
            found.rows = [[0.0; BLOCK]; BALL];
        }
        let arch = Arch::new();
        let is_done = match &self.lubrication {
            None => arch.dispatch(Evaluate::<_, JACOBIAN>(self, y, &Dry, found)),
            Some(Lubrication { fraction, complete, .. })
                if *fraction < 1.0 || JACOBIAN && *complete =>
            {
                false
            }
            Some(Lubrication { ehl, .. }) => {
                arch.dispatch(Evaluate::<_, JACOBIAN>(self, y, *ehl, found))
            }
        };
        if !is_done {
            *found = self.in_jets(y)?;
        } else if let Some(push) = &self.push {
            let values = if JACOBIAN {
                let (values, slopes) = linear::<BALL, BALL>(y, |y| self.pushed_by(push, y))?;
                for (row, slope) in found.rows.iter_mut().zip(&slopes) {
                    row.iter_mut().zip(slope).for_each(|(to, slope)| *to += slope);
                }
                values
            } else {
                self.pushed_by(push, y)?
            };
            found.residual.iter_mut().zip(&values).for_each(|(residual, value)| *residual += value);
        }
        Ok(())
    }

    /// The same from the formulas in any scalar.
    pub(super) fn in_jets(&self, y: &[f64; BALL]) -> Result<EquationValues, EvalError> {
        let (mut power, mut sliding) = (f64::NAN, [f64::NAN; 2]);
        let (values, slopes) = linear::<{ BALL + 1 }, BALL>(y, |y| {
            let state = self.state(y)?;
            (power, sliding) = (state.power, state.sliding);
            let residual = self.residual_of(y, &state, y[PRECESSION] + self.offset());
            let radius = Jet::from(self.contacts.helix.radius);
            let torque = torque(&state.wrench[1], radius, &state.loaded.frame);
            Ok(from_fn(|i| residual.get(i).copied().unwrap_or(torque)))
        })?;
        let block = |row: &[f64; BALL]| from_fn(|k| row.get(k).copied().unwrap_or(0.0));
        Ok(EquationValues {
            residual: from_fn(|i| values[i]),
            transmitted: PowerFlow { torque: values[BALL], power, sliding },
            rows: from_fn(|i| block(&slopes[i])),
            slope: block(&slopes[BALL]),
        })
    }
}

impl<F: Copy> EquationValues<F> {
    #[inline(always)]
    pub(super) fn zero(zero: F) -> Self {
        Self {
            residual: [zero; BALL],
            transmitted: PowerFlow::zero(zero),
            rows: [[zero; BLOCK]; BALL],
            slope: [zero; BLOCK],
        }
    }
}

/// Torque on the screw, the power that friction takes, and that of sliding at nut and screw; scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct PowerFlow<F = f64> {
    pub(super) torque: F,
    pub(super) power: F,
    pub(super) sliding: [F; 2],
}

impl<F: Copy> PowerFlow<F> {
    #[inline(always)]
    fn zero(zero: F) -> Self {
        Self { torque: zero, power: zero, sliding: [zero; 2] }
    }
}

/// Evaluates a state, in place, if it has contacts.
struct Evaluate<'a, R, const JACOBIAN: bool>(
    &'a SlipBall<'a>,
    &'a [f64; BALL],
    &'a R,
    &'a mut EquationValues,
);

impl<R: TractionLaw, const JACOBIAN: bool> WithSimd for Evaluate<'_, R, JACOBIAN> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self(ball, y, law, found) = self;
        let scaled = ball.scaled();
        let (geometry, exist) = contact_geometry(&scaled, y, sin_cos_of_tilt(simd, y[TILT]));
        if !exist {
            return false;
        }
        let mut tractions = [ContactTraction::none(0.0); 2];
        law.loss::<S, JACOBIAN>(simd, ball, y, &geometry, &mut tractions);
        evaluate::<_, R, JACOBIAN>(&scaled, y, &geometry, &tractions, found);
        true
    }
}

/// What friction does at a contact.
#[derive(Clone, Copy)]
pub(super) struct ContactTraction<F = f64> {
    /// The sums of its coefficient, and what they are multiplied with, against a slip over `$W$`.
    pub(super) sums: Resultants<F>,
    pub(super) coefficient: F,
    /// Derivatives of the logarithm of the film by the unknowns.
    film: Partials<F>,
    /// Force along t and moment about t × N of rolling resistance, and the power that it takes.
    resistance: [F; 2],
    rolling: F,
}

impl<F: Compare> ContactTraction<F> {
    /// Nothing.
    #[inline(always)]
    pub(super) fn none(zero: F) -> Self {
        Self {
            sums: Resultants::none(zero),
            coefficient: zero,
            film: [zero; BLOCK],
            resistance: [zero; 2],
            rolling: zero,
        }
    }
}

/// What friction is made of.
pub(super) trait TractionLaw {
    /// True with a film and rolling resistance.
    const LUBRICATED: bool;

    /// What it does at a state, in place.
    fn loss<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        ball: &SlipBall<'_>,
        y: &[f64; BALL],
        geometry: &ContactGeometry<f64>,
        tractions: &mut [ContactTraction; 2],
    );
}

impl TractionLaw for Dry {
    const LUBRICATED: bool = false;

    #[inline(always)]
    fn loss<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        ball: &SlipBall<'_>,
        _y: &[f64; BALL],
        geometry: &ContactGeometry<f64>,
        tractions: &mut [ContactTraction; 2],
    ) {
        let coefficient = ball.contacts.directed_friction();
        set_sums::<S, _, 2, JACOBIAN>(simd, ball, geometry, (&[Dry; 2], coefficient), tractions);
    }
}

impl TractionLaw for EhlPoint {
    const LUBRICATED: bool = true;

    #[inline(always)]
    fn loss<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        ball: &SlipBall<'_>,
        y: &[f64; BALL],
        geometry: &ContactGeometry<f64>,
        tractions: &mut [ContactTraction; 2],
    ) {
        let (arc, cos_lead) = (ball.contacts.scaled.arc, ball.contacts.scaled.lead.1);
        let mut laws = [None; 2];
        for i in 0..2 {
            let (side, unknown) = [(1.0, NUT_LOAD), (-1.0, SCREW_LOAD)][i];
            let angle = &geometry.angles[i];
            let [along_t, _, w_n, w_c] = geometry.points[i].motion;
            // k·(t × N), and its slope by the angle
            let (k_c, turned) = (side * angle.cos * cos_lead, -side * angle.sin * cos_lead);
            let rate = along_t / arc;
            let film = self.of_motion(i, y[unknown], [rate, along_t, w_c], k_c, ball.creep);
            let ContactTraction { film: by, resistance, rolling, .. } = &mut tractions[i];
            if JACOBIAN {
                let growth = film.speed_exponent * film.rolling_speed / film.entrainment.powi(2);
                by[PRECESSION] = -(0.5 * arc + k_c) * growth;
                by[OMEGA[1]] -= 0.5 * side * angle.sin * growth;
                add::<_, ALL>(by, 0.5 * side * angle.cos * growth, &geometry.by_b);
                add::<_, ALL>(by, -(0.5 * w_n + rate * turned) * growth, &angle.by);
                by[unknown] -= FILM_LOAD_EXPONENT / y[unknown];
            }
            let [push, couple] = film.resist(w_c, ball.creep);
            // M = r × F_h + C_h                                           (Y32)
            *resistance = [push, push + couple].map(|x| ball.contacts.signed(x));
            *rolling = ball.contacts.signed(ScaledFilm::resisted([push, couple], along_t, w_c));
            laws[i] = Some(OilLaw::of(&film.law));
        }
        let [Some(nut), Some(screw)] = laws else { return };
        let of = (&[nut, screw], ball.contacts.signed(1.0));
        set_sums::<S, _, 4, JACOBIAN>(simd, ball, geometry, of, tractions);
    }
}

/// Takes the sums of both contacts.
///
/// * `laws`, `coefficient`: what the sums are of, and what they are multiplied with.
#[inline(always)]
fn set_sums<S: Simd, L: PointLaw<N>, const N: usize, const JACOBIAN: bool>(
    simd: S,
    ball: &SlipBall<'_>,
    geometry: &ContactGeometry<f64>,
    (laws, coefficient): (&[L; 2], f64),
    tractions: &mut [ContactTraction; 2],
) {
    for traction in &mut *tractions {
        traction.coefficient = coefficient;
    }
    let (nodes, all) = ([ball.nodes(0), ball.nodes(1)], [false; 2]);
    let found = tractions.each_mut().map(|traction| &mut traction.sums);
    sums::<S, L, N, JACOBIAN>(simd, &geometry.points, laws, &nodes, all, found);
}

/// A number and its derivatives by the unknowns.
#[derive(Clone, Copy)]
struct Gradient<F> {
    re: F,
    by: Partials<F>,
}

/// The derivatives of an unknown at its own rate.
#[inline(always)]
fn along<F: Compare>(unknown: usize, rate: F) -> Partials<F> {
    let mut by = [rate.constant(0.0); BLOCK];
    by[unknown] = rate;
    by
}

/// Sets of unknowns that a term may change with, a bit each:
///
/// ```text
///                                      Q_A  ν  Q_B  p  ω'_k ω'_n ω'_c
/// loads and contact angles: GEOMETRY    x   x   x
/// ω' about t and b: ABOUT_T_B                          x         x
/// ω' about N and t × N: SPINNING        x   x   x      x    x    x
/// friction and what it adds to: ALL     x   x   x   x  x    x    x
/// ```
const GEOMETRY: u8 = 1 << NUT_LOAD | 1 << TILT | 1 << SCREW_LOAD;
const ABOUT_T_B: u8 = 1 << OMEGA[0] | 1 << OMEGA[2];
const SPINNING: u8 = GEOMETRY | ABOUT_T_B | 1 << OMEGA[1];
const ALL: u8 = (1 << BALL) - 1;

/// Adds derivatives by the unknowns `OF`; those by others are zero.
#[inline(always)]
fn add<F: Compare, const OF: u8>(to: &mut Partials<F>, factor: F, by: &Partials<F>) {
    for i in 0..BLOCK {
        // Those of one number are side by side, and take one operation all together.
        if !F::WIDE || OF >> i & 1 == 1 {
            to[i] = to[i] + factor * by[i];
        }
    }
}

/// Derivatives times a factor.
#[inline(always)]
fn times<F: Compare>(factor: F, by: &Partials<F>) -> Partials<F> {
    let mut product = *by;
    for i in 0..BLOCK {
        product[i] = factor * by[i];
    }
    product
}

/// Derivatives and a derivative by the tilt itself.
#[inline(always)]
fn tilted<F: Compare>(by: &Partials<F>, own: f64) -> Partials<F> {
    let mut sum = *by;
    sum[TILT] = sum[TILT] + own;
    sum
}

/// Sine and cosine of an angle, and its derivatives.
#[derive(Clone, Copy)]
pub(super) struct Angle<F> {
    pub(super) sin: F,
    pub(super) cos: F,
    by: Partials<F>,
}

/// The contacts of a state, with what their columns are made of.
pub(super) struct ContactGeometry<F> {
    pub(super) points: [Patch<F>; 2],
    /// The turn of the triad, the angles of the contacts from there, and those of the contacts.
    pub(super) rotation: Angle<F>,
    tilts: [Angle<F>; 2],
    pub(super) angles: [Angle<F>; 2],
    /// Derivatives of the angular velocity about t and b.
    by_t: Partials<F>,
    by_b: Partials<F>,
}

impl SlipBall<'_> {
    /// The numbers of the equations.
    #[inline(always)]
    pub(super) fn scaled(&self) -> TractionPoint {
        TractionPoint {
            scaled: self.contacts.scaled,
            friction: self.contacts.directed_friction(),
            offset: self.offset(),
            creep: self.creep,
            nut_chart: self.nut_chart,
        }
    }
}

/// Sine and cosine of the tilt, as lanes have them, which are faster than the library.
#[inline(always)]
fn sin_cos_of_tilt<S: Simd>(simd: S, tilt: f64) -> (f64, f64) {
    if tilt.abs() > FRAC_PI_2 {
        return tilt.sin_cos();
    }
    let (sin, cos) = Lane::<S>::splat(simd, tilt).sin_cos_of_tilt();
    (sin.as_slice()[0], cos.as_slice()[0])
}

/// Lengths of both sides of the triangle of loaded contacts, and their slopes by the loads.
pub(super) struct Sides<F: Compare> {
    /// Cube roots of the loads.
    growth: [F; 2],
    pub(super) lengths: [F; 2],
    pub(super) slopes: [F; 2],
    pub(super) pressed: F::Mask,
}

impl<F: Compare> Sides<F> {
    #[inline(always)]
    pub(super) fn of(point: &TractionPoint<F>, y: &[F; BALL]) -> Self {
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        let zero = point.scaled.radius.constant(0.0);
        // a ~ Q^{1/3},  δ = (Q/K_H)^{2/3}                                 (P6), (P2)
        let growth = [loads[0].cbrt(), loads[1].cbrt()];
        let (mut lengths, mut slopes) = (point.scaled.offsets, [zero; 2]);
        for i in 0..2 {
            let approach = growth[i] * growth[i] * point.scaled.approaches[i];
            lengths[i] = lengths[i] + approach;
            slopes[i] = approach / loads[i] * (2.0 / 3.0);
        }
        Self { growth, lengths, slopes, pressed: loads[0].gt(zero) & loads[1].gt(zero) }
    }
}

/// Sines and cosines of the mean contact angle and of those at nut and screw, and the height `$A_1$` of the triangle.
pub(super) struct MeanAngle<F: Compare> {
    pub(super) angle: (F, F),
    pub(super) nut: [F; 2],
    pub(super) screw: [F; 2],
    pub(super) height: F,
    pub(super) exists: F::Mask,
}

impl<F: Compare> MeanAngle<F> {
    /// Of two sides that are turned apart by twice the tilt.
    #[inline(always)]
    pub(super) fn of([l_a, l_b]: [F; 2], a_2: F, (sin_y, cos_y): (F, F)) -> Self {
        // l_A cos(β − ν) + l_B cos(β + ν) = A₂ = S cosβ + D sinβ          (J7)
        let (s, d) = ((l_a + l_b) * cos_y, (l_a - l_b) * sin_y);
        let both = s * s + d * d;
        let square = both - a_2 * a_2;
        let zero = a_2.constant(0.0);
        let height = square.sqrt();
        let (sin, cos) = ((height * s + a_2 * d) / both, (a_2 * s - height * d) / both);
        Self {
            angle: (sin, cos),
            nut: [sin * cos_y - cos * sin_y, cos * cos_y + sin * sin_y],
            screw: [sin * cos_y + cos * sin_y, cos * cos_y - sin * sin_y],
            height,
            exists: square.gt(zero) & s.gt(zero),
        }
    }
}

/// The contacts of a state, and where they exist.
///
/// * `sin_y`, `cos_y`: of the tilt.
#[inline(always)]
pub(super) fn contact_geometry<F: Compare>(
    point: &TractionPoint<F>,
    y: &[F; BALL],
    (sin_y, cos_y): (F, F),
) -> (ContactGeometry<F>, F::Mask) {
    let (zero, one) = (point.scaled.radius.constant(0.0), point.scaled.radius.constant(1.0));
    let Sides { growth, lengths: [l_a, l_b], slopes, pressed } = Sides::of(point, y);
    let a_2 = point.scaled.radial_distance;
    let own = along(TILT, one);
    let (rotation, tilts, angles, exist);
    if point.nut_chart {
        // cosβ_B = (A₂ − l_A cosβ_A)/l_B                                  (J9)
        let cos = (a_2 - l_a * cos_y) / l_b;
        let square = (one - cos) * (one + cos);
        exist = pressed & square.gt(zero);
        let sin = square.sqrt();
        let mut by = along(TILT, -l_a * sin_y);
        (by[NUT_LOAD], by[SCREW_LOAD]) = (cos_y * slopes[0], cos * slopes[1]);
        let nut = Angle { sin: sin_y, cos: cos_y, by: own };
        let screw = Angle { sin, cos, by: times(one / (l_b * sin), &by) };
        let between = Angle {
            sin: sin * cos_y - cos * sin_y,
            cos: cos * cos_y + sin * sin_y,
            by: tilted(&screw.by, -1.0),
        };
        rotation = nut;
        tilts = [Angle { sin: zero, cos: one, by: [zero; BLOCK] }, between];
        angles = [nut, screw];
    } else {
        let MeanAngle { angle: (sin, cos), nut, screw, height, exists } =
            MeanAngle::of([l_a, l_b], a_2, (sin_y, cos_y));
        exist = pressed & exists;
        let ([sin_a, cos_a], [sin_b, cos_b]) = (nut, screw);
        // A₁ dβ = cosβ_A dl_A + cosβ_B dl_B + (l_A sinβ_A − l_B sinβ_B) dν
        let mut by = along(TILT, l_a * sin_a - l_b * sin_b);
        (by[NUT_LOAD], by[SCREW_LOAD]) = (cos_a * slopes[0], cos_b * slopes[1]);
        let by = times(one / height, &by);
        rotation = Angle { sin, cos, by };
        tilts = [
            Angle { sin: -sin_y, cos: cos_y, by: along(TILT, -one) },
            Angle { sin: sin_y, cos: cos_y, by: own },
        ];
        angles = [
            Angle { sin: sin_a, cos: cos_a, by: tilted(&by, -1.0) },
            Angle { sin: sin_b, cos: cos_b, by: tilted(&by, 1.0) },
        ];
    }

    // ω' = ω'_k k + ω'_n n + ω'_c k × n                                   (T4)
    let (sin_lead, cos_lead) = point.scaled.lead;
    let [along_axis, radial, around] = [y[OMEGA[0]], y[OMEGA[1]], y[OMEGA[2]]];
    // About t and b, relative to the nut.
    let mut by_t = along(OMEGA[0], sin_lead);
    by_t[OMEGA[2]] = -cos_lead;
    let mut by_b = along(OMEGA[0], cos_lead);
    by_b[OMEGA[2]] = sin_lead;
    let omega_t = sin_lead * along_axis - cos_lead * around;
    let omega_b = cos_lead * along_axis + sin_lead * around;

    let from_nut = y[PRECESSION] + (point.offset - point.scaled.nut_speed);
    let mut points = [Patch {
        semi_axes: (zero, zero),
        pressed_radius: zero,
        ball_radius: one,
        motion: [zero; 4],
        creep: point.creep,
    }; 2];
    for i in 0..2 {
        let (side, body) = [(one, zero), (-one, one)][i];
        let Angle { sin, cos, .. } = angles[i];
        let (t, b) = (omega_t - body * sin_lead, omega_b - body * cos_lead);
        points[i].motion = [
            point.scaled.arc * (from_nut - body),
            t,
            side * (sin * b + cos * radial),
            side * (cos * b - sin * radial),
        ];
        let (a, b) = point.scaled.semi_axes[i];
        points[i].semi_axes = (growth[i] * a, growth[i] * b);
        points[i].pressed_radius = point.scaled.pressed_radius[i];
    }
    (ContactGeometry { points, rotation, tilts, angles, by_t, by_b }, exist)
}

/// The equations, with derivatives if `JACOBIAN`, in the place of zeros.
#[inline(always)]
pub(super) fn evaluate<F: Compare, R: TractionLaw, const JACOBIAN: bool>(
    point: &TractionPoint<F>,
    y: &[F; BALL],
    geometry: &ContactGeometry<F>,
    tractions: &[ContactTraction<F>; 2],
    EquationValues { residual, transmitted, rows, slope }: &mut EquationValues<F>,
) {
    let one = point.friction.constant(1.0);
    for i in 0..2 {
        let (side, unknown) = ([one, -one][i], [NUT_LOAD, SCREW_LOAD][i]);
        let (load, traction) = (y[unknown], &tractions[i]);
        let pull = load * traction.coefficient;
        // P_f = Σ f Q ∫ dP                                                (P7)
        let sliding = pull * traction.sums.power;
        transmitted.sliding[i] = sliding;
        transmitted.power = transmitted.power + (sliding + traction.rolling);
        let friction = friction::<F, R, JACOBIAN>(i, (pull, side), point, geometry, traction);
        // F = Q N + f Q ∫ dF,  M = f Q ∫ dM                               (T2)
        let [f_t, f_c, m_t, m_n, m_c] = &friction;
        let normal = Gradient { re: load, by: along(unknown, one) };
        let (force, moment) = ([f_t, &normal, f_c], [m_t, m_n, m_c]);
        let (tilt, angle) = (&geometry.tilts[i], &geometry.angles[i]);
        add_vector::<F, JACOBIAN, GEOMETRY>((side, tilt), force, FORCE, (residual, rows));
        add_vector::<F, JACOBIAN, ALL>((side, tilt), moment, MOMENT, (residual, rows));
        if i == 0 {
            let into = (&mut residual[AXIAL_LOAD], &mut rows[AXIAL_LOAD]);
            set_axial_load::<F, JACOBIAN>(point, (side, angle), force, into);
        } else {
            let into = (&mut transmitted.torque, &mut *slope);
            set_torque::<F, JACOBIAN>(point, (side, angle), (force, moment), into);
        }
    }
    add_inertia::<F, JACOBIAN>(point, y, &geometry.rotation, (residual, rows));
}

/// Friction at a contact: the force along t and t × N and the moment about t, N and t × N.
///
/// * `pull`: `$f Q$`.
#[inline(always)]
fn friction<F: Compare, R: TractionLaw, const JACOBIAN: bool>(
    i: usize,
    (pull, side): (F, F),
    point: &TractionPoint<F>,
    ContactGeometry { points, angles, by_t, by_b, .. }: &ContactGeometry<F>,
    traction: &ContactTraction<F>,
) -> [Gradient<F>; SUMS] {
    let &ContactTraction { ref sums, coefficient, ref film, resistance, .. } = traction;
    let (unknown, angle) = ([NUT_LOAD, SCREW_LOAD][i], &angles[i]);
    let zero = pull.constant(0.0);
    let mut friction = [Gradient { re: zero, by: [zero; BLOCK] }; SUMS];
    let [_, _, w_n, w_c] = points[i].motion;
    let (mut by_n, mut by_c) =
        (along(OMEGA[1], side * angle.cos), along(OMEGA[1], -side * angle.sin));
    if JACOBIAN {
        add::<_, GEOMETRY>(&mut by_n, w_c, &angle.by);
        add::<_, ABOUT_T_B>(&mut by_n, side * angle.sin, by_b);
        add::<_, GEOMETRY>(&mut by_c, -w_n, &angle.by);
        add::<_, ABOUT_T_B>(&mut by_c, side * angle.cos, by_b);
    }
    for (k, part) in friction.iter_mut().enumerate() {
        part.re = pull * sums.values[k];
        if JACOBIAN {
            let [a, t, n, c, g] = sums.slopes[k];
            part.by = times(pull * n, &by_n);
            add::<_, SPINNING>(&mut part.by, pull * c, &by_c);
            add::<_, ABOUT_T_B>(&mut part.by, pull * t, by_t);
            part.by[PRECESSION] = pull * a * point.scaled.arc;
            // d(f Q I) = f I dQ + f Q dI,  d ln a = dQ/(3 Q)
            part.by[unknown] = part.by[unknown] + coefficient * (sums.values[k] + g * (1.0 / 3.0));
            if R::LUBRICATED {
                add::<_, ALL>(&mut part.by, pull * sums.by_film[k], film);
            }
        }
    }
    if R::LUBRICATED {
        let [f_t, .., m_c] = &mut friction;
        (f_t.re, m_c.re) = (f_t.re + resistance[0], m_c.re + resistance[1]);
    }
    friction
}

/// The axial load that the nut's contact takes over the one that it is to take.
#[inline(always)]
fn set_axial_load<F: Compare, const JACOBIAN: bool>(
    point: &TractionPoint<F>,
    (side, angle): (F, &Angle<F>),
    [f_t, normal, f_c]: [&Gradient<F>; 3],
    (residual, row): (&mut F, &mut Partials<F>),
) {
    let (sin_lead, cos_lead) = point.scaled.lead;
    // Components along n and b.
    let (n, b) = turned(side, (angle.sin, angle.cos), (normal.re, f_c.re));
    // F_nut·k − F_a                                                       (P5)
    *residual = f_t.re * sin_lead + b * cos_lead - side.constant(1.0);
    if JACOBIAN {
        *row = times(sin_lead, &f_t.by);
        add::<_, GEOMETRY>(row, cos_lead * side * angle.sin, &normal.by);
        add::<_, ALL>(row, cos_lead * side * angle.cos, &f_c.by);
        add::<_, GEOMETRY>(row, cos_lead * n, &angle.by);
    }
}

/// Torque of the screw's contact on it.
#[inline(always)]
fn set_torque<F: Compare, const JACOBIAN: bool>(
    point: &TractionPoint<F>,
    (side, angle): (F, &Angle<F>),
    ([f_t, normal, f_c], [m_t, m_n, m_c]): ([&Gradient<F>; 3], [&Gradient<F>; 3]),
    (torque, slope): (&mut F, &mut Partials<F>),
) {
    let ((sin_lead, cos_lead), radius) = (point.scaled.lead, point.scaled.radius);
    let (arm_t, arm_b) = (radius * cos_lead, -(radius * sin_lead));
    let (n, b) = turned(side, (angle.sin, angle.cos), (normal.re, f_c.re));
    let (m_1, m_2) = turned(side, (angle.sin, angle.cos), (m_n.re, m_c.re));
    // T = [(−r_m n) × F + M]·k                                            (B7)
    *torque = m_t.re * sin_lead + m_2 * cos_lead + f_t.re * arm_t + b * arm_b;
    if JACOBIAN {
        *slope = times(sin_lead, &m_t.by);
        add::<_, ALL>(slope, cos_lead * side * angle.sin, &m_n.by);
        add::<_, ALL>(slope, cos_lead * side * angle.cos, &m_c.by);
        add::<_, GEOMETRY>(slope, cos_lead * m_1 + arm_b * n, &angle.by);
        add::<_, ALL>(slope, arm_t, &f_t.by);
        add::<_, GEOMETRY>(slope, arm_b * side * angle.sin, &normal.by);
        add::<_, ALL>(slope, arm_b * side * angle.cos, &f_c.by);
    }
}

/// Adds a vector of a contact, given along t, N and t × N, to three equations.
///
/// * `NORMAL`: unknowns that its component along N changes with.
#[inline(always)]
fn add_vector<F: Compare, const JACOBIAN: bool, const NORMAL: u8>(
    (side, tilt): (F, &Angle<F>),
    [along_t, along_n, across]: [&Gradient<F>; 3],
    [t, n, c]: [usize; 3],
    (residual, rows): (&mut [F; BALL], &mut [Partials<F>; BALL]),
) {
    let (second, third) = turned(side, (tilt.sin, tilt.cos), (along_n.re, across.re));
    residual[t] = residual[t] + along_t.re;
    residual[n] = residual[n] + second;
    residual[c] = residual[c] + third;
    if JACOBIAN {
        let one = side.constant(1.0);
        add::<_, ALL>(&mut rows[t], one, &along_t.by);
        add::<_, NORMAL>(&mut rows[n], side * tilt.cos, &along_n.by);
        add::<_, ALL>(&mut rows[n], -side * tilt.sin, &across.by);
        add::<_, GEOMETRY>(&mut rows[n], -third, &tilt.by);
        add::<_, NORMAL>(&mut rows[c], side * tilt.sin, &along_n.by);
        add::<_, ALL>(&mut rows[c], side * tilt.cos, &across.by);
        add::<_, GEOMETRY>(&mut rows[c], second, &tilt.by);
    }
}

/// Inertia forces and the gyroscopic moment.
#[inline(always)]
fn add_inertia<F: Compare, const JACOBIAN: bool>(
    point: &TractionPoint<F>,
    y: &[F; BALL],
    rotation: &Angle<F>,
    (residual, rows): (&mut [F; BALL], &mut [Partials<F>; BALL]),
) {
    let ((sin_lead, cos_lead), [_, f_n, f_c], [m_t, m_n, m_c]) = (point.scaled.lead, FORCE, MOMENT);
    let [_, radial, around] = [y[OMEGA[0]], y[OMEGA[1]], y[OMEGA[2]]];
    let rate = y[PRECESSION] + point.offset;
    // Σ F − m r_m P² n                                                    (B4)
    let mass = point.scaled.mass * point.scaled.radius;
    let centrifugal = mass * rate * rate;
    residual[f_n] = residual[f_n] - centrifugal * rotation.cos;
    residual[f_c] = residual[f_c] + centrifugal * rotation.sin;
    // Σ M − I P (ω'_n k × n − ω'_c n)                                     (B5), (T5)
    let inertia = point.scaled.ball().inertia();
    let (second, third) = (
        sin_lead * rotation.sin * radial - rotation.cos * around,
        sin_lead * rotation.cos * radial + rotation.sin * around,
    );
    let gyro = inertia * rate;
    residual[m_t] = residual[m_t] + gyro * cos_lead * radial;
    residual[m_n] = residual[m_n] - gyro * second;
    residual[m_c] = residual[m_c] - gyro * third;
    if JACOBIAN {
        let change = mass * rate * 2.0;
        for (row, unknown, slope) in [
            (f_n, PRECESSION, -(change * rotation.cos)),
            (f_c, PRECESSION, change * rotation.sin),
            (m_t, PRECESSION, inertia * cos_lead * radial),
            (m_n, PRECESSION, -(inertia * second)),
            (m_c, PRECESSION, -(inertia * third)),
            (m_t, OMEGA[1], gyro * cos_lead),
            (m_n, OMEGA[1], -(gyro * sin_lead * rotation.sin)),
            (m_c, OMEGA[1], -(gyro * sin_lead * rotation.cos)),
            (m_n, OMEGA[2], gyro * rotation.cos),
            (m_c, OMEGA[2], -(gyro * rotation.sin)),
        ] {
            rows[row][unknown] = rows[row][unknown] + slope;
        }
        add::<_, GEOMETRY>(&mut rows[f_n], centrifugal * rotation.sin, &rotation.by);
        add::<_, GEOMETRY>(&mut rows[f_c], centrifugal * rotation.cos, &rotation.by);
        add::<_, GEOMETRY>(&mut rows[m_n], -(gyro * third), &rotation.by);
        add::<_, GEOMETRY>(&mut rows[m_c], gyro * second, &rotation.by);
    }
}

/// Second and third component of a vector that has these along `$N = \pm(0, \cos, \sin)$` and `$t \times N$`.
#[inline(always)]
fn turned<F: Compare>(side: F, (sin, cos): (F, F), (normal, across): (F, F)) -> (F, F) {
    (side * (cos * normal - sin * across), side * (sin * normal + cos * across))
}
