//! The seven equations of a ball with friction over both ellipses by lanes, with derivatives by hand,
//! Eqs (T1) to (T5), (P2) to (P7).
//!
//! Every vector is in the triad of the mean normal, along t, N and `$e_x$`. At the nut a contact is turned
//! from it by `$-\nu$`, at the screw by `$\nu$`.

#![expect(clippy::needless_range_loop, reason = "places of vectors and matrices, as on paper")]

use bsm_dyn::{ContactMotion, InnerNodes, ManyFrictions, ManyQuadrature};
use bsm_simd::{Simd, WithSimd};

use crate::operand::{Lane, Mask};

/// Unknowns and equations.
pub(super) const BALL: usize = 7;

/// A number for each unknown.
pub(super) type Vector<S> = [Lane<S>; BALL];

/// Places of the unknowns (T1), with the precession from the nut's on.
pub(super) const NUT_LOAD: usize = 0;
pub(super) const TILT: usize = 1;
pub(super) const SCREW_LOAD: usize = 2;
pub(super) const PRECESSION: usize = 3;
pub(super) const OMEGA: usize = 4;

/// Which equation each unknown is eliminated with: friction is a convex potential of the motion, so that no
/// exchange of rows is needed.
const PIVOT_ROWS: [usize; BALL] = [6, 1, 2, 0, 3, 4, 5];
const PIVOT_ORDER: [usize; BALL] = [NUT_LOAD, SCREW_LOAD, TILT, PRECESSION, 4, 5, 6];

/// Centrifugal force over the load from which the model has other unknowns (T10), and the fastest rotation.
const THROWN: f64 = 1e6;
const FASTEST: f64 = 1e9;

/// Balls in units of ball radius, axial load per ball and `$|W|$`.
pub(super) struct Balls<S: Simd> {
    pub(super) arc: Lane<S>,
    pub(super) sin_a: Lane<S>,
    pub(super) cos_a: Lane<S>,
    /// `$\Omega_n/|W|$`.
    pub(super) nut_speed: Lane<S>,
    /// Of `$W$`.
    pub(super) sign: Lane<S>,
    /// `$m r_m W^2/F_a$`.
    pub(super) inertia_ratio: Lane<S>,
    pub(super) friction: Lane<S>,
    /// `$A_2$`.
    pub(super) reach: Lane<S>,
    /// `$v_e$`.
    pub(super) creep: Lane<S>,
    pub(super) races: [Race<S>; 2],
}

/// The groove of nut or screw.
#[derive(Clone, Copy)]
pub(super) struct Race<S: Simd> {
    pub(super) offset: Lane<S>,
    /// Of the axial load.
    pub(super) compliance: Lane<S>,
    pub(super) semi_axis: Lane<S>,
    pub(super) flatness: Lane<S>,
    pub(super) pressed_radius: Lane<S>,
}

/// Loads and angles.
pub(super) struct Loaded<S: Simd> {
    /// Cube roots of the loads.
    growth: [Lane<S>; 2],
    /// Sine and cosine of the tilt, and of the mean contact angle.
    pub(super) tilt: (Lane<S>, Lane<S>),
    pub(super) mean: (Lane<S>, Lane<S>),
    /// Sines and cosines of the contact angles.
    pub(super) angles: [(Lane<S>, Lane<S>); 2],
    /// Derivatives of the mean contact angle by loads and tilt.
    slopes: [Lane<S>; 3],
    /// Where there are such contacts.
    pub(super) exists: Mask<S>,
}

/// Motion relative to nut or screw.
pub(super) struct Local<S: Simd> {
    /// Speed of the centre along t.
    pub(super) speed: Lane<S>,
    /// Angular velocity about t, N and t × N of the contact.
    pub(super) omega: [Lane<S>; 3],
    /// What turns the axes of the contact to those of the mean normal: `$\pm\cos\nu$`, `$\sin\nu$`.
    pub(super) turn: (Lane<S>, Lane<S>),
}

/// The equations at a state.
pub(super) struct Evaluated<S: Simd> {
    pub(super) residual: Vector<S>,
    /// Derivatives, by unknown and equation; those by the rotation in the triad of the mean normal.
    pub(super) slopes: [Vector<S>; BALL],
    /// Sine and cosine of the mean contact angle.
    pub(super) mean: (Lane<S>, Lane<S>),
    /// Torque on the screw, and the power that friction takes.
    pub(super) torque: Lane<S>,
    pub(super) power: Lane<S>,
    /// Where the contacts exist, and where the quadrature resolves their friction.
    pub(super) exists: Mask<S>,
    pub(super) resolved: Mask<S>,
}

/// Factors of the derivatives.
pub(super) struct Factors<S: Simd> {
    rows: [Vector<S>; BALL],
    mean: (Lane<S>, Lane<S>),
}

impl<S: Simd> Local<S> {
    /// Slip at the contact centre, along t × N and along t.
    #[inline(always)]
    pub(super) fn slip(&self) -> [Lane<S>; 2] {
        let [along, _, across] = self.omega;
        [-along, self.speed + across]
    }

    #[inline(always)]
    pub(super) fn slip_speed(&self) -> Lane<S> {
        let [across, along] = self.slip();
        (across * across + along * along).sqrt()
    }
}

impl<S: Simd> Balls<S> {
    #[inline(always)]
    fn constant(&self, x: f64) -> Lane<S> {
        self.arc.constant(x)
    }

    /// `$r_m/r_b$`.
    #[inline(always)]
    fn radius(&self) -> Lane<S> {
        self.arc * self.cos_a
    }

    /// `$P/|W|$`.
    #[inline(always)]
    pub(super) fn rate(&self, y: &Vector<S>) -> Lane<S> {
        y[PRECESSION] + self.nut_speed
    }

    /// How far the pressed surface falls off at a distance across the groove.
    #[inline(always)]
    fn depth(&self, i: usize, across: Lane<S>) -> Lane<S> {
        across * across * 0.5 / self.races[i].pressed_radius
    }

    /// Weights of forces and of moments.
    #[inline(always)]
    pub(super) fn weights(&self, y: &Vector<S>) -> (Lane<S>, Lane<S>) {
        let (rate, one) = (self.rate(y), self.constant(1.0));
        let mut lever = one;
        for (i, load) in [(0, y[NUT_LOAD]), (1, y[SCREW_LOAD])] {
            let a = self.races[i].semi_axis * load.cbrt_positive();
            lever = lever.max(a.max(self.depth(i, a)));
        }
        // D_F = diag(w, w₀, w, w/(f h), w/(f h), w/(f h), w)              (T3)
        let force = (self.inertia_ratio * rate * rate).max(one);
        (force.recip(), (force * self.friction.min(one) * lever).recip())
    }

    /// Contacts of loads and tilt.
    #[inline(always)]
    pub(super) fn loaded(&self, y: &Vector<S>) -> Loaded<S> {
        let zero = self.constant(0.0);
        let (loads, tilt) = ([y[NUT_LOAD], y[SCREW_LOAD]], y[TILT]);
        let (mut growth, mut approach, mut length) = ([zero; 2], [zero; 2], [zero; 2]);
        for i in 0..2 {
            growth[i] = loads[i].cbrt_positive();
            // δ = (Q/K_H)^{2/3}                                           (P2)
            approach[i] = self.races[i].compliance * growth[i] * growth[i];
            length[i] = self.races[i].offset + approach[i];
        }
        let (sin, cos) = tilt.abs().sin_cos_first_quadrant();
        let (s, c) = (tilt.lt(zero).select(-sin, sin), cos);
        // l_A cos(β − ν) + l_B cos(β + ν) = A₂ = S cosβ + D sinβ          (J7)
        let (sum, difference) = ((length[0] + length[1]) * c, (length[0] - length[1]) * s);
        let whole = sum * sum + difference * difference;
        let square = whole - self.reach * self.reach;
        let a_1 = square.sqrt();
        let mean = (
            (a_1 * sum + self.reach * difference) / whole,
            (self.reach * sum - a_1 * difference) / whole,
        );
        // β_A = β − ν,  β_B = β + ν                                       (P3)
        let angles = [
            (mean.0 * c - mean.1 * s, mean.1 * c + mean.0 * s),
            (mean.0 * c + mean.1 * s, mean.1 * c - mean.0 * s),
        ];
        let [up_a, up_b] = [length[0] * angles[0].0, length[1] * angles[1].0];
        let height = up_a + up_b;
        let mut slopes = [zero; 3];
        for i in 0..2 {
            slopes[i] = angles[i].1 * approach[i] * (2.0 / 3.0) / (loads[i] * height);
        }
        slopes[2] = (up_a - up_b) / height;
        let quarter = zero.constant(std::f64::consts::FRAC_PI_2);
        let exists = loads[0].min(loads[1]).gt(zero)
            & square.gt(zero)
            & tilt.abs().lt(quarter)
            & loads[0].max(loads[1]).lt(zero.constant(1e100));
        Loaded { growth, tilt: (s, c), mean, angles, slopes, exists }
    }

    /// Motion relative to nut (0) or screw (1).
    #[inline(always)]
    pub(super) fn local(&self, i: usize, y: &Vector<S>, loaded: &Loaded<S>) -> Local<S> {
        let ((sin, cos), (s, c)) = (loaded.mean, loaded.tilt);
        // ω' = ω'_k k + ω'_n n + ω'_c k × n, less W k at the screw         (T4), (K12)
        let [along, radial, around] = [y[OMEGA], y[OMEGA + 1], y[OMEGA + 2]];
        let (along, precession, c) = if i == 0 {
            (along, y[PRECESSION], c)
        } else {
            (along - self.sign, y[PRECESSION] - self.sign, -c)
        };
        let omega_t = self.sin_a * along - self.cos_a * around;
        let omega_b = self.cos_a * along + self.sin_a * around;
        let (v, w) = (cos * radial + sin * omega_b, cos * omega_b - sin * radial);
        Local {
            speed: self.arc * precession,
            omega: [omega_t, c * v - s * w, s * v + c * w],
            turn: (c, s),
        }
    }

    /// A contact with its motion.
    #[inline(always)]
    fn contact(&self, i: usize, loaded: &Loaded<S>, local: &Local<S>) -> ContactMotion<Lane<S>> {
        let Race { semi_axis, flatness, pressed_radius, .. } = self.races[i];
        // a ~ Q^{1/3}                                                     (P6)
        let a = semi_axis * loaded.growth[i];
        let (speed, omega) = (local.speed, local.omega);
        ContactMotion {
            semi_axes: (a, a * flatness),
            pressed_radius,
            speed,
            omega,
            creep: self.creep,
        }
    }

    /// What the equations leave over, with derivatives if `SLOPED`.
    ///
    /// * `inner`: numbers of nodes at nut and screw, as they are if `planned`.
    #[inline(always)]
    pub(super) fn evaluated<const SLOPED: bool>(
        &self,
        simd: S,
        y: &Vector<S>,
        rule: &ManyQuadrature,
        inner: &mut [InnerNodes; 2],
        planned: bool,
    ) -> Evaluated<S> {
        // A call of its own: the code is long.
        simd.vectorize(Call::<S, SLOPED> { balls: self, simd, y, rule, inner, planned })
    }

    #[inline(always)]
    fn evaluated_here<const SLOPED: bool>(
        &self,
        simd: S,
        y: &Vector<S>,
        rule: &ManyQuadrature,
        inner: &mut [InnerNodes; 2],
        planned: bool,
    ) -> Evaluated<S> {
        let zero = self.constant(0.0);
        let loaded = self.loaded(y);
        let (sin, cos) = loaded.mean;
        let (k_t, k_n, k_e) = (self.sin_a, self.cos_a * sin, self.cos_a * cos);
        let mut total = [zero; 6];
        // By loads, tilt, precession, rotation about t, N, e_x, and the mean contact angle.
        let mut by = [[zero; BALL]; BALL + 1];
        let (mut torque, mut power, mut axial) = (zero, zero, zero);
        let mut resolved = zero.le(zero);
        for i in 0..2 {
            let local = self.local(i, y, &loaded);
            let contact = self.contact(i, &loaded, &local);
            let (unit, held) =
                rule.frictions::<S, _, SLOPED>(simd, &contact, &mut inner[i], planned);
            resolved = resolved & held;
            let load = y[if i == 0 { NUT_LOAD } else { SCREW_LOAD }];
            let pull = load * self.friction;
            // P_f = Σ f Q ∫ dP                                            (P7)
            power = power + pull * unit.power;
            // F = Q N + f Q ∫ dF,  M = f Q ∫ dM                            (T2)
            let own = own_wrench(&unit.wrench, pull, load);
            let wrench = turned(&own, local.turn);
            for k in 0..6 {
                total[k] = total[k] + wrench[k];
            }
            if i == 0 {
                axial = k_t * wrench[0] + k_n * wrench[1] + k_e * wrench[2];
            } else {
                // T = [(−r_m n) × F + M]·k                                (B7)
                let lifted = k_t * (cos * wrench[2] + sin * wrench[1]) - self.cos_a * wrench[0];
                torque =
                    k_t * wrench[3] + k_n * wrench[4] + k_e * wrench[5] - self.radius() * lifted;
            }
            if !SLOPED {
                continue;
            }
            let columns = self.columns(i, &local, (pull, &unit), &own);
            let places =
                [if i == 0 { NUT_LOAD } else { SCREW_LOAD }, PRECESSION, 4, 5, 6, BALL, TILT];
            for (column, place) in columns.iter().zip(places) {
                let turned = turned(column, local.turn);
                for k in 0..6 {
                    by[place][k] = by[place][k] + turned[k];
                }
                if i == 0 {
                    by[place][6] = k_t * turned[0] + k_n * turned[1] + k_e * turned[2];
                }
            }
            if i == 0 {
                by[BALL][6] = by[BALL][6] + k_e * wrench[1] - k_n * wrench[2];
            }
        }
        let rate = self.rate(y);
        let (radial, around) = (y[OMEGA + 1], y[OMEGA + 2]);
        let thrown = self.inertia_ratio * rate * rate;
        // k × ω = ω'_n k × n − ω'_c n                                     (T5)
        let turn = [
            -(self.cos_a * radial),
            self.sin_a * sin * radial - cos * around,
            self.sin_a * cos * radial + sin * around,
        ];
        let moment = self.gyro() * rate;
        // Σ F − m r_m P² n = 0,  Σ M − P k × Iω = 0,  F_nut·k − F_a = 0   (P5)
        let residual = [
            total[0],
            total[1] - thrown * cos,
            total[2] + thrown * sin,
            total[3] - moment * turn[0],
            total[4] - moment * turn[1],
            total[5] - moment * turn[2],
            axial - 1.0,
        ];
        if SLOPED {
            self.add_inertia(&mut by, y, (&loaded, &turn));
        }
        let mut slopes = [[zero; BALL]; BALL];
        slopes.copy_from_slice(&by[..BALL]);
        let exists = loaded.exists;
        Evaluated { residual, slopes, mean: loaded.mean, torque, power, exists, resolved }
    }

    /// Derivatives of the wrench of a contact in its own axes: by its load, the precession, the rotation about
    /// t, N and `$e_x$`, the mean contact angle and the tilt.
    #[inline(always)]
    fn columns(
        &self,
        i: usize,
        local: &Local<S>,
        (pull, unit): (Lane<S>, &ManyFrictions<Lane<S>>),
        own: &[Lane<S>; 6],
    ) -> [[Lane<S>; 6]; 7] {
        let zero = self.constant(0.0);
        let ((c, s), [_, w_n, w_c]) = (local.turn, local.omega);
        let ManyFrictions { wrench: force, by_motion, by_growth, .. } = unit;
        let one = zero.constant(1.0);
        let mut columns = [[zero; 6]; 7];
        for (row, place) in [0, 2, 3, 4, 5].into_iter().enumerate() {
            let [by_speed, by_t, by_n, by_c] = by_motion[row];
            columns[0][place] = self.friction * (force[row] + by_growth[row] * (1.0 / 3.0));
            columns[1][place] = pull * self.arc * by_speed;
            columns[2][place] = pull * by_t;
            columns[3][place] = pull * (c * by_n + s * by_c);
            columns[4][place] = pull * (c * by_c - s * by_n);
            // Turning the contact by an angle turns the motion in its axes.
            columns[5][place] = pull * (w_c * by_n - w_n * by_c);
        }
        columns[0][1] = one;
        // By the tilt the axes turn, too.
        let side = if i == 0 { one } else { -one };
        for k in 0..6 {
            columns[6][k] = -(side * columns[5][k]);
        }
        let [_, f_n, f_c, _, m_n, m_c] = *own;
        for (place, add) in [(1, f_c), (2, -f_n), (4, m_c), (5, -m_n)] {
            columns[6][place] = columns[6][place] + side * add;
        }
        columns
    }

    /// Adds the derivatives of the inertia forces, and those by loads and tilt through the mean contact angle.
    ///
    /// * `turn`: `$k \times \omega$`.
    #[inline(always)]
    fn add_inertia(
        &self,
        by: &mut [Vector<S>; BALL + 1],
        y: &Vector<S>,
        (loaded, turn): (&Loaded<S>, &[Lane<S>; 3]),
    ) {
        let (zero, (sin, cos)) = (self.constant(0.0), loaded.mean);
        let (rate, gyro) = (self.rate(y), self.gyro());
        let (thrown, moment) = (self.inertia_ratio * rate * rate, gyro * rate);
        let change = self.inertia_ratio * rate * 2.0;
        by[PRECESSION][1] = by[PRECESSION][1] - change * cos;
        by[PRECESSION][2] = by[PRECESSION][2] + change * sin;
        for k in 0..3 {
            by[PRECESSION][3 + k] = by[PRECESSION][3 + k] - gyro * turn[k];
        }
        // ω'_n = cosβ ω_N − sinβ ω_e,  ω'_c = sinα (sinβ ω_N + cosβ ω_e) − cosα ω_t
        let lead = self.sin_a;
        let across = [-self.cos_a, lead * sin, lead * cos];
        for (place, radial, around) in
            [(4, zero, across[0]), (5, cos, across[1]), (6, -sin, across[2])]
        {
            by[place][3] = by[place][3] + moment * self.cos_a * radial;
            by[place][4] = by[place][4] - moment * (lead * sin * radial - cos * around);
            by[place][5] = by[place][5] - moment * (lead * cos * radial + sin * around);
        }
        by[BALL][1] = by[BALL][1] + thrown * sin;
        by[BALL][2] = by[BALL][2] + thrown * cos;
        by[BALL][4] = by[BALL][4] - moment * turn[2];
        by[BALL][5] = by[BALL][5] + moment * turn[1];
        for (place, slope) in [NUT_LOAD, SCREW_LOAD, TILT].into_iter().zip(loaded.slopes) {
            for k in 0..BALL {
                by[place][k] = by[place][k] + slope * by[BALL][k];
            }
        }
    }

    /// `$I$`, of the ball.
    #[inline(always)]
    fn gyro(&self) -> Lane<S> {
        // I = (2/5) m r_b²                                                (B2)
        self.inertia_ratio / self.radius() * 0.4
    }

    /// Torque on the screw only.
    #[inline(always)]
    pub(super) fn torque(
        &self,
        simd: S,
        y: &Vector<S>,
        rule: &ManyQuadrature,
        inner: &mut InnerNodes,
    ) -> (Lane<S>, Mask<S>) {
        let loaded = self.loaded(y);
        let (sin, cos) = loaded.mean;
        let local = self.local(1, y, &loaded);
        let contact = self.contact(1, &loaded, &local);
        let (unit, resolved) = rule.frictions::<S, _, false>(simd, &contact, inner, false);
        let load = y[SCREW_LOAD];
        let own = own_wrench(&unit.wrench, load * self.friction, load);
        let wrench = turned(&own, local.turn);
        // T = [(−r_m n) × F + M]·k                                        (B7)
        let lifted = self.sin_a * (cos * wrench[2] + sin * wrench[1]) - self.cos_a * wrench[0];
        let axial = self.cos_a * (sin * wrench[4] + cos * wrench[5]) + self.sin_a * wrench[3];
        (axial - self.radius() * lifted, resolved & loaded.exists)
    }

    /// Where a root has both contacts on their flanks.
    #[inline(always)]
    pub(super) fn is_admissible(&self, y: &Vector<S>) -> Mask<S> {
        let (loaded, zero) = (self.loaded(y), self.constant(0.0));
        let [(sin_a, cos_a), (sin_b, cos_b)] = loaded.angles;
        loaded.exists & zero.le(sin_a) & zero.le(sin_b) & cos_a.gt(zero) & cos_b.gt(zero)
    }

    /// Where the ball is not thrown against the nut, in the unknowns (T10), nor faster than any ball.
    #[inline(always)]
    pub(super) fn is_moderate(&self, y: &Vector<S>) -> Mask<S> {
        let rate = self.rate(y);
        let fastest = y[OMEGA].abs().max(y[OMEGA + 1].abs()).max(y[OMEGA + 2].abs());
        (self.inertia_ratio * rate * rate).le(self.constant(THROWN))
            & fastest.lt(self.constant(FASTEST))
    }

    /// Torque of the frictionless screw.
    #[inline(always)]
    pub(super) fn ideal(&self) -> Lane<S> {
        // T₀ = F_a r_m tanα                                               (B9)
        self.radius() * self.sin_a / self.cos_a
    }

    /// Efficiency of a torque on the screw.
    #[inline(always)]
    pub(super) fn efficiency(&self, torque: Lane<S>) -> Lane<S> {
        let ideal = self.ideal();
        let back = self.sign.lt(self.constant(0.0));
        // η = T₀/T or T/T₀                                                (B8)
        back.select(torque, ideal) / back.select(ideal, torque)
    }

    /// The step that a residual asks for (N1).
    #[inline(always)]
    pub(super) fn step(&self, factors: &Factors<S>, residual: &Vector<S>) -> Vector<S> {
        let zero = self.constant(0.0);
        let mut x = [zero; BALL];
        for k in 0..BALL {
            let mut left = -residual[PIVOT_ROWS[k]];
            for j in 0..k {
                left = left - factors.rows[k][j] * x[j];
            }
            x[k] = left;
        }
        for k in (0..BALL).rev() {
            let mut left = x[k];
            for j in k + 1..BALL {
                left = left - factors.rows[k][j] * x[j];
            }
            x[k] = left * factors.rows[k][k];
        }
        let (sin, cos) = factors.mean;
        let [q_a, q_b, tilt, rate, u, v, w] = x;
        let omega_b = sin * v + cos * w;
        let mut step = [zero; BALL];
        (step[NUT_LOAD], step[TILT], step[SCREW_LOAD]) = (q_a, tilt, q_b);
        step[PRECESSION] = rate;
        step[OMEGA] = self.sin_a * u + self.cos_a * omega_b;
        step[OMEGA + 1] = cos * v - sin * w;
        step[OMEGA + 2] = self.sin_a * omega_b - self.cos_a * u;
        step
    }
}

/// What [`Balls::evaluated`] is asked for.
struct Call<'a, S: Simd, const SLOPED: bool> {
    balls: &'a Balls<S>,
    simd: S,
    y: &'a Vector<S>,
    rule: &'a ManyQuadrature,
    inner: &'a mut [InnerNodes; 2],
    planned: bool,
}

impl<S: Simd, const SLOPED: bool> WithSimd for Call<'_, S, SLOPED> {
    type Output = Evaluated<S>;

    #[inline(always)]
    fn with_simd<Same: Simd>(self, _: Same) -> Evaluated<S> {
        let Self { balls, simd, y, rule, inner, planned } = self;
        balls.evaluated_here::<SLOPED>(simd, y, rule, inner, planned)
    }
}

impl<S: Simd> Factors<S> {
    /// Triangular factors; their diagonal is inverted.
    #[inline(always)]
    pub(super) fn of(at: &Evaluated<S>) -> Self {
        let mut rows = at.slopes;
        for k in 0..BALL {
            for j in 0..BALL {
                rows[k][j] = at.slopes[PIVOT_ORDER[j]][PIVOT_ROWS[k]];
            }
        }
        for k in 0..BALL {
            let pivot = rows[k][k].recip();
            rows[k][k] = pivot;
            for i in k + 1..BALL {
                let factor = rows[i][k] * pivot;
                rows[i][k] = factor;
                for j in k + 1..BALL {
                    rows[i][j] = rows[i][j] - factor * rows[k][j];
                }
            }
        }
        Self { rows, mean: at.mean }
    }
}

/// Force and moment of a contact in its own axes, t, N and t × N.
#[inline(always)]
fn own_wrench<S: Simd>(unit: &[Lane<S>; 5], pull: Lane<S>, load: Lane<S>) -> [Lane<S>; 6] {
    let [f_t, f_c, m_t, m_n, m_c] = *unit;
    [pull * f_t, load, pull * f_c, pull * m_t, pull * m_n, pull * m_c]
}

/// From the axes of a contact to those of the mean normal.
#[inline(always)]
fn turned<S: Simd>(own: &[Lane<S>; 6], (c, s): (Lane<S>, Lane<S>)) -> [Lane<S>; 6] {
    let [f_t, f_n, f_c, m_t, m_n, m_c] = *own;
    [f_t, c * f_n + s * f_c, c * f_c - s * f_n, m_t, c * m_n + s * m_c, c * m_c - s * m_n]
}
