//! Direct sweeps: all unknowns of given directions of slip, and the directions that they lead to.

use bsm_case::InputKey;
use bsm_simd::Simd;

use crate::operand::{Given, Lane, Mask};
use crate::units::Units;

/// A lane of points in units of ball radius, axial load per ball and relative speed.
pub(super) struct Scaled<S: Simd> {
    pub(super) sin_a: Lane<S>,
    pub(super) cos_a: Lane<S>,
    pub(super) sin_b: Lane<S>,
    pub(super) cos_b: Lane<S>,
    cot_b: Lane<S>,
    pub(super) sin_2b: Lane<S>,
    pub(super) cos_2b: Lane<S>,
    /// `$\cos\alpha\sin\beta$` and `$\cos\alpha\cos\beta$`, parts of the axis along N and e.
    pub(super) k_n: Lane<S>,
    pub(super) k_e: Lane<S>,
    /// `$f$` and `$F$`.
    pub(super) friction: Lane<S>,
    pub(super) signed: Lane<S>,
    /// `$r_m/r_b$`, `$d/r_b$`.
    pub(super) radius: Lane<S>,
    pub(super) arc: Lane<S>,
    /// `$\mu$` and `$I$`.
    pub(super) inertia_ratio: Lane<S>,
    pub(super) inertia: Lane<S>,
    /// `$\Omega_n/W$`.
    pub(super) nut_speed: Lane<S>,
    /// `$h$`, `$1/h$`, `$\cos\psi$`, `$\sin\psi$`: the axis along the slip of (R12).
    pub(super) h: Lane<S>,
    per_h: Lane<S>,
    pub(super) cos_psi: Lane<S>,
    pub(super) sin_psi: Lane<S>,
}

/// What the sweeps feed back: deviations of the slip from `$\psi$` at A and B, direction of the
/// friction at A' in `$(e_x, t)$`, and the correction of the force along the normal.
#[derive(Clone, Copy)]
pub(super) struct Directions<S: Simd> {
    pub(super) nut: Lane<S>,
    pub(super) screw: Lane<S>,
    pub(super) minor: [Lane<S>; 2],
    pub(super) correction: Lane<S>,
    /// `$|A|$` and `$|B|$`.
    pub(super) norms: [Lane<S>; 2],
}

/// A vector in `$(e_x, t)$`, the plane of the slip.
pub(super) type Plane<S> = [Lane<S>; 2];

/// The state that belongs to directions.
pub(super) struct State<S: Simd> {
    /// `$\kappa = Q_{A'}/M$` and `$M = \mu (P/W)^2$`.
    pub(super) minor: Lane<S>,
    pub(super) centrifugal: Lane<S>,
    pub(super) p: Lane<S>,
    /// `$P/W$`.
    pub(super) rate: Lane<S>,
    /// Slip at A, over the norm of `nut`.
    pub(super) slip: Lane<S>,
    pub(super) u: Lane<S>,
    pub(super) tau: Lane<S>,
    pub(super) s: Lane<S>,
    /// Direction of the slip at A, not normalized.
    pub(super) nut: Plane<S>,
    /// Norms of the directions at A and B that it was found with.
    pub(super) norms: [Lane<S>; 2],
    /// `$G = -2 F Q_A/|nut|$`, `$H = 2 F Q_B/|screw|$`.
    pub(super) pulls: [Lane<S>; 2],
    /// The directions that it leads to.
    pub(super) next: Directions<S>,
}

impl<S: Simd> Scaled<S> {
    #[inline(always)]
    pub(super) fn of(given: &Given<'_, S>) -> (Self, Units<S>) {
        let (sin_a, cos_a) = given.lead();
        let (sin_b, cos_b) = given.sin_cos(InputKey::contact_angle_deg);
        let friction = given.get(InputKey::friction_coefficient);
        let units = Units::of(given);
        let Units { mass, speed, nut_speed, .. } = units;
        let radius = units.pitch / units.ball;
        let (k_n, k_e) = (cos_a * sin_b, cos_a * cos_b);
        let h = (sin_a * sin_a + k_e * k_e).sqrt();
        let per_h = h.recip();
        let scaled = Self {
            sin_a,
            cos_a,
            sin_b,
            cos_b,
            sin_2b: sin_b * cos_b * 2.0,
            cos_2b: (cos_b - sin_b) * (cos_b + sin_b),
            k_n,
            k_e,
            friction,
            signed: speed.lt(speed.constant(0.0)).select(-friction, friction),
            radius,
            arc: radius / cos_a,
            inertia_ratio: mass * radius,
            inertia: mass * 0.4,
            nut_speed: nut_speed / speed,
            h,
            per_h,
            cot_b: cos_b / sin_b,
            cos_psi: k_e * per_h,
            sin_psi: sin_a * per_h,
        };
        (scaled, units)
    }
}

#[inline(always)]
pub(super) fn dot<S: Simd>(a: Plane<S>, b: Plane<S>) -> Lane<S> {
    a[0].mul_add(b[0], a[1] * b[1])
}

#[inline(always)]
pub(super) fn times<S: Simd>(factor: Lane<S>, a: Plane<S>) -> Plane<S> {
    [factor * a[0], factor * a[1]]
}

#[inline(always)]
pub(super) fn pick<S: Simd>(first: Mask<S>, a: Plane<S>, b: Plane<S>) -> Plane<S> {
    [first.select(a[0], b[0]), first.select(a[1], b[1])]
}

/// The part of `b` across `a`.
#[inline(always)]
pub(super) fn cross<S: Simd>(a: Plane<S>, b: Plane<S>) -> Lane<S> {
    a[1].neg_mul_add(b[0], a[0] * b[1])
}

impl<S: Simd> Scaled<S> {
    #[inline(always)]
    pub(super) fn constant(&self, x: f64) -> Lane<S> {
        self.friction.constant(x)
    }

    /// Slip along `$\psi$` at A and B; at A' that of the spin, whose sense is that of the ball.
    #[inline(always)]
    pub(super) fn start(&self) -> Directions<S> {
        let zero = self.constant(0.0);
        // p of (R13) tells the sense.
        let p = self.precession(zero, zero, [self.cos_psi, self.sin_psi], zero);
        let forward = self.constant(1.0);
        let along = self.toward(p + self.nut_speed).select(forward, -forward);
        let along = self.friction.gt(self.signed).select(-along, along);
        Directions {
            nut: zero,
            screw: zero,
            minor: [zero, along],
            correction: zero,
            norms: [forward; 2],
        }
    }

    /// Where a rate is positive.
    #[inline(always)]
    pub(super) fn toward(&self, rate: Lane<S>) -> Mask<S> {
        rate.gt(self.constant(0.0))
    }

    /// `$p$` (R26) of the direction against the slip at B, of slopes `$e_1$` and `$e_2$` of the
    /// slip at A, and of the turn X between the two.
    #[inline(always)]
    pub(super) fn precession(
        &self,
        e_1: Lane<S>,
        e_2: Lane<S>,
        screw: Plane<S>,
        turn: Lane<S>,
    ) -> Lane<S> {
        // p = [(d − cosα cosβ) x_B − sinα y_B − e₂ ω X] / [2 d x_B − (e₁ − e₂) X]  (R26)
        let above = self.sin_a.neg_mul_add(screw[1], (self.arc - self.k_e) * screw[0]);
        (e_2 * turn).neg_mul_add(self.nut_speed, above)
            / (e_1 - e_2).neg_mul_add(turn, (self.arc * 2.0) * screw[0])
    }

    /// One sweep: all unknowns of given directions, and the directions that they lead to.
    #[inline(always)]
    pub(super) fn sweep(&self, given: &Directions<S>) -> State<S> {
        let (f, one) = (self.signed, self.constant(1.0));
        let (c, s_psi, h) = (self.cos_psi, self.sin_psi, self.h);
        let [cos_m, sin_m] = given.minor;
        // x_A = cosψ − t_A sinψ,  y_A = sinψ + t_A cosψ                   (R24)
        let nut = [given.nut.neg_mul_add(s_psi, c), given.nut.mul_add(c, s_psi)];
        let screw = [given.screw.neg_mul_add(s_psi, c), given.screw.mul_add(c, s_psi)];
        // κ (Q_A′/M) from the force along N and along ψ                   (R25)
        let below = (f * (c * self.cos_2b + f * self.sin_2b))
            .neg_mul_add(cos_m, (f * s_psi).neg_mul_add(sin_m, c * self.sin_2b - f * self.cos_2b));
        let minor = ((c * self.sin_b - f * self.cos_b) - given.correction) / below;
        // λ = e₁ p − e₂ P/W from the moment about N                       (R27)
        let e_1 = self.sin_a * self.arc * self.per_h;
        let e_2 = (f * self.sin_2b * self.radius * self.per_h * 2.5) * (minor * sin_m);
        // X = t_A − t_B, from A to B
        let turn = given.nut - given.screw;
        let p = self.precession(e_1, e_2, screw, turn);
        let rate = p + self.nut_speed;
        let slip = e_2.neg_mul_add(rate, e_1 * p);
        // u = −λ x_A,  τ = λ y_A − p d                                    (R4)
        let (u, tau) = (-(slip * nut[0]), p.neg_mul_add(self.arc, slip * nut[1]));
        let centrifugal = self.inertia_ratio * rate * rate;
        let load = minor * centrifugal;
        let gyro = self.inertia * rate;
        // G = −2 F Q_A/|A| from the axial load                            (R28)
        let [norm_a, _] = given.norms;
        let carried = (f * h * s_psi).neg_mul_add(sin_m, (f * h * c).neg_mul_add(cos_m, self.k_n));
        let pull_a = (f * -2.0) * load.mul_add(carried, one) / norm_a.mul_add(self.k_n, -(f * h));
        // G x_A = …, H x_B = … from the forces and moments across N       (R29), (R30)
        let common = centrifugal.neg_mul_add(self.sin_b, load * self.sin_2b);
        let (turning, rolling) = (gyro * tau, gyro * u);
        let friction = load * cos_m;
        let e_a = [
            (f * 2.0 * self.cos_b * self.cos_b)
                .neg_mul_add(friction, turning.neg_mul_add(self.k_n, common)),
            rolling.neg_mul_add(self.cos_a / self.sin_b, turning * (self.sin_a * self.cot_b)),
        ];
        let e_b = [
            (f * 2.0 * self.sin_b * self.sin_b)
                .mul_add(friction, turning.mul_add(self.k_n, common)),
            turning * (self.sin_a / self.cot_b),
        ];
        let psi = [c, s_psi];
        let along_a = dot(psi, e_a);
        let s = (pull_a - along_a) * self.per_h;
        let pull_b = dot(psi, e_b) + along_a - pull_a;
        // Directions of the next sweep                                    (R31)
        let inverse = (pull_a * pull_b).recip();
        let tan_a = cross(psi, e_a) * (inverse * pull_b);
        let tan_b = cross(psi, e_b) * (inverse * pull_a);
        let across = rolling;
        let along = -s.mul_add(self.sin_2b, gyro.mul_add(self.arc * p, turning * self.cos_2b));
        let norm = dot([across, along], [across, along]).sqrt();
        let sense = self.toward(rate).select(norm, -norm).recip();
        // (|A| − 1) G + (|B| − 1) H over 2 M                              (R32)
        let (square_a, square_b) = (tan_a * tan_a, tan_b * tan_b);
        let norms = [(square_a + one).sqrt(), (square_b + one).sqrt()];
        let (one_a, one_b) = (norms[0] + one, norms[1] + one);
        let correction = dot([pull_a * square_a, pull_b * square_b], [one_b, one_a])
            / ((centrifugal * 2.0) * (one_a * one_b));
        State {
            minor,
            centrifugal,
            p,
            rate,
            slip,
            u,
            tau,
            s,
            nut,
            norms: given.norms,
            pulls: [pull_a, pull_b],
            next: Directions {
                nut: tan_a,
                screw: tan_b,
                minor: [across * sense, along * sense],
                correction,
                norms,
            },
        }
    }
}

impl<S: Simd> Directions<S> {
    /// Largest change towards others.
    #[inline(always)]
    pub(super) fn farthest(&self, other: &Self) -> Lane<S> {
        let turns = (self.nut - other.nut).abs().max((self.screw - other.screw).abs());
        let x = (self.minor[0] - other.minor[0]).abs();
        let y = (self.minor[1] - other.minor[1]).abs();
        turns.max(x.max(y))
    }

    /// These where `kept`, others elsewhere.
    #[inline(always)]
    pub(super) fn unless(&self, kept: Mask<S>, other: &Self) -> Self {
        Self {
            nut: kept.select(self.nut, other.nut),
            screw: kept.select(self.screw, other.screw),
            minor: pick(kept, self.minor, other.minor),
            correction: kept.select(self.correction, other.correction),
            norms: pick(kept, self.norms, other.norms),
        }
    }
}
