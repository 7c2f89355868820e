//! Equilibrium of a single ball between the flanks of nut and screw, for a given displacement of
//! the grooves.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U8) to (U12).

use std::array::from_fn;

use bsm_dyn::{
    gothic::{FlankApproach, GrooveForces, Grooves},
    model::StaticBall,
};
use nalgebra::{Matrix2, Vector2};

/// Flanks on which the balls of a circuit can carry load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flanks {
    /// Balls carry load only on the flanks on which they push the nut along +z relative to the
    /// screw.
    Plus,
    /// Balls carry load only on the flanks on which they push the nut along −z relative to the
    /// screw.
    Minus,
    /// Both flanks of the gothic arches.
    Both,
}

impl Flanks {
    /// Returns whether balls can be loaded along the + diagonal and along the − diagonal.
    pub(crate) fn diagonals(self) -> [bool; 2] {
        [self != Self::Minus, self != Self::Plus]
    }
}

/// Dimensions and contact stiffness of ball and grooves, which are the same for all balls of a nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourContacts {
    /// Gothic arches around a ball, without axial play (U8).
    pub grooves: Grooves,
    /// A ball between two opposite flanks. Its two Hertzian contacts act in series.
    pub series: StaticBall,
    /// Fraction of the total elastic approach of both contacts that occurs at the nut.
    pub nut_share: f64,
    /// Centrifugal force on a ball \[N\], directed away from the screw axis.
    pub outward: f64,
}

/// State of a ball in displaced grooves. The contacts are in the order nut +, nut −, screw +, screw
/// −. Balls on the + flanks push the nut along +z relative to the screw, and balls on the − flanks
/// push it along −z.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BallInGrooves {
    /// Normal loads of the contacts \[N\], which are zero for unloaded contacts.
    pub loads: [f64; 4],
    /// Contact angles \[rad\], which are meaningful only for loaded contacts.
    pub angles: [f64; 4],
    /// Potential energy `$V$` of the ball \[J\].
    pub energy: f64,
    /// Force that displaces the nut groove by `$w$`, `$\partial V/\partial w$` \[N\].
    pub force: [f64; 2],
    /// Derivative of `force` with respect to the displacement, `$\partial^2 V/\partial w^2$`
    /// \[N/m\].
    pub slope: [[f64; 2]; 2],
}

impl BallInGrooves {
    /// Returns whether the ball is loaded on the + flanks and on the − flanks.
    pub fn flanks_pressed(&self) -> [bool; 2] {
        [0, 1].map(|flank| self.loads[flank] > 0.0 || self.loads[2 + flank] > 0.0)
    }

    /// Returns the largest contact load of the ball \[N\].
    pub fn max_load(&self) -> f64 {
        self.loads.iter().copied().fold(0.0, f64::max)
    }
}

/// Signs of the + and − flanks.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// Maximum number of iterations for the position of a ball. Usually, four iterations are
/// sufficient, but a lightly loaded ball that slides along a flank needs more.
const MAX_BALL_STEPS: usize = 1000;

impl FourContacts {
    /// Returns the state of a ball for a displacement `w` of the nut groove relative to the screw
    /// groove \[m\], along the binormal and the principal normal. The ball radius exceeds the
    /// nominal radius by `oversize` \[m\].
    ///
    /// The energy is a convex function of `w`. Returns `None` if no equilibrium position of the
    /// ball is found.
    pub fn at(&self, w: [f64; 2], oversize: f64, flanks: Flanks) -> Option<BallInGrooves> {
        let (diagonals, w) = (flanks.diagonals(), Vector2::from(w));
        let grooves = &self.grooves.fitted(-w[1], oversize);
        let two_point = |i: usize| -> Option<(usize, GrooveForces)> {
            let ball = self.series.forces_at([SIGNS[i] * w[0], w[1]], oversize);
            (diagonals[i] && ball.load > 0.0).then_some((i, ball))
        };
        let two_point = two_point(0).or_else(|| two_point(1));
        if self.outward == 0.0 {
            let Some((first, ball)) = two_point else { return Some(BallInGrooves::default()) };
            let center = self.center(grooves, first, &ball);
            let others = [1 - first, 3 - first];
            let place = [center[0], center[1], w[0]];
            let free = !diagonals[1 - first]
                || others.iter().all(|&c| grooves.flank(c, &place).approach <= 0.0);
            if free {
                return Some(two_point_ball(first, &ball));
            }
        }
        let pressed = two_point.map(|(i, ball)| self.center(grooves, i, &ball));
        let starts = [Some(self.pressed_outward(w, oversize, flanks)), pressed];
        self.least_energy((grooves, w[0]), starts, flanks)
    }

    /// Returns the position of a ball that is loaded along one diagonal. The ball center is on the
    /// contact normal through the arc center of the screw groove.
    fn center(&self, grooves: &Grooves, diagonal: usize, ball: &GrooveForces) -> Vector2<f64> {
        // The total approach δ of both contacts follows from the energy V = ⅖ Q δ. The contact at
        // the screw accounts for a fixed fraction of δ.
        let approach = (1.0 - self.nut_share) * ball.energy / (0.4 * ball.load);
        let [x_b, x_n, _] = grooves.position_for([0.0, approach], [ball.angle; 2]);
        Vector2::new(SIGNS[diagonal] * x_b, x_n)
    }

    /// Returns the position of a ball that carries no external load and is pressed into the nut
    /// groove by the centrifugal force. The ball touches both flanks or, if balls can be loaded on
    /// only one flank, the deepest point of this flank.
    fn pressed_outward(&self, w: Vector2<f64>, oversize: f64, flanks: Flanks) -> Vector2<f64> {
        let [sin, cos] = self.series.unloaded;
        let (l, stiffness) = (self.grooves.offsets[0], self.grooves.stiffness[0]);
        let share = if flanks == Flanks::Both { 0.5 / cos } else { 1.0 };
        let away = l - oversize + (share * self.outward / stiffness).powf(2.0 / 3.0);
        match flanks {
            Flanks::Both => {
                let down = (away * away - (l * sin).powi(2)).max(0.0).sqrt();
                Vector2::new(w[0], w[1] + l * cos - down)
            }
            Flanks::Plus => Vector2::new(w[0] + l * sin, w[1] + l * cos - away),
            Flanks::Minus => Vector2::new(w[0] - l * sin, w[1] + l * cos - away),
        }
    }

    /// Returns the state of the ball at the position of minimum energy (U10). The search starts at
    /// the position in `starts` that has the lowest energy.
    fn least_energy(
        &self,
        (grooves, w_b): (&Grooves, f64),
        starts: [Option<Vector2<f64>>; 2],
        flanks: Flanks,
    ) -> Option<BallInGrooves> {
        let diagonals = flanks.diagonals();
        let at = |x: Vector2<f64>| {
            let place = [x[0], x[1], w_b];
            let touching =
                |c: usize| diagonals[c % 2].then(|| ContactForce::of(grooves, c, &place));
            BallEnergy::of(&from_fn(touching), self.outward, x)
        };
        let positions = starts.into_iter().flatten().map(|x| (x, at(x)));
        let (mut x, mut here) = positions.min_by(|a, b| a.1.energy.total_cmp(&b.1.energy))?;
        for _ in 0..MAX_BALL_STEPS {
            // If nothing resists motion in some direction, a small stiffness limits the step to the
            // depth of the groove.
            let held = Matrix2::identity() * (self.outward.max(here.size) / grooves.offsets[0]);
            let inverse = inverse(here.slope).or_else(|| inverse(here.slope + held))?;
            let step = inverse * here.pull;
            let fall = step.dot(&here.pull);
            // The position cannot be more accurate than the rounding error of the distance between
            // the groove-arc centers.
            let still = step[0].hypot(step[1]) <= 4.0 * f64::EPSILON * self.series.distance;
            if still || fall <= 0.0 {
                return here.balanced(self.series.distance);
            }
            let mut share = 1.0;
            let next = loop {
                let y = x + step * share;
                let next = at(y);
                // A step is accepted if it satisfies the Armijo condition. Near the solution,
                // energy differences are only rounding errors, so a step is also accepted if it
                // reduces the resulting force.
                let rounding =
                    64.0 * f64::EPSILON * here.energy.abs().max(self.outward * x[1].abs());
                let level = (next.energy - here.energy).abs() <= rounding;
                let nearer = next.residual() < here.residual();
                if next.energy < here.energy - 1e-4 * share * fall || (level && nearer) {
                    break Some((y, next));
                }
                share *= 0.5;
                if share < 1e-9 {
                    break None;
                }
            };
            match next {
                Some((y, next)) => (x, here) = (y, next),
                // No step reduces the resulting force, so the remaining force may be a rounding
                // error.
                None => return here.balanced(self.series.distance),
            }
        }
        None
    }
}

/// Returns the inverse of a symmetric positive semidefinite matrix, or `None` if the matrix is
/// singular to within rounding errors.
fn inverse(a: Matrix2<f64>) -> Option<Matrix2<f64>> {
    let determinant = a.determinant();
    let is_regular = determinant > 1e-13 * a[(0, 0)] * a[(1, 1)] && determinant.is_finite();
    a.try_inverse().filter(|_| is_regular)
}

/// Load and energy of one contact for a given position of the ball.
#[derive(Debug, Clone, Copy)]
struct ContactForce {
    load: f64,
    energy: f64,
    /// Unit vector from the ball center toward the groove-arc center.
    m: Vector2<f64>,
    slope: Matrix2<f64>,
}

impl ContactForce {
    /// Calculates load and energy of a contact for a given position of ball and nut groove.
    fn of(grooves: &Grooves, contact: usize, place: &[f64; 3]) -> Self {
        let FlankApproach { approach, length, normal } = grooves.flank(contact, place);
        let m = Vector2::from(normal);
        if approach <= 0.0 {
            return Self { load: 0.0, energy: 0.0, m, slope: Matrix2::zeros() };
        }
        // Q = K δ^(3/2),  V = ⅖ K δ^(5/2)                                 (U9)
        let load = grooves.load(contact, approach);
        // Stiffness of the contact: 3/2 K √δ m mᵀ + (Q/l)(1 − m mᵀ)       (U12)
        let (along, turning) = (1.5 * load / approach, load / length);
        let entry = |i: usize, k: usize| {
            (along - turning) * m[i] * m[k] + if i == k { turning } else { 0.0 }
        };
        let slope = Matrix2::from_fn(entry);
        Self { load, energy: 0.4 * load * approach, m, slope }
    }
}

/// Energy and forces of all contacts for a given position of the ball.
#[derive(Debug, Clone, Copy)]
struct BallEnergy {
    contacts: [Option<ContactForce>; 4],
    energy: f64,
    /// Resulting force on the ball \[N\].
    pull: Vector2<f64>,
    /// Sum of the absolute values of all forces on the ball \[N\].
    size: f64,
    slope: Matrix2<f64>,
}

impl BallEnergy {
    fn of(contacts: &[Option<ContactForce>; 4], outward: f64, x: Vector2<f64>) -> Self {
        // U = Σ ⅖ K δ^(5/2) + F_c x_n; the centrifugal force points along −n (U9)
        let mut all = Self {
            contacts: *contacts,
            energy: outward * x[1],
            pull: Vector2::new(0.0, -outward),
            size: outward,
            slope: Matrix2::zeros(),
        };
        for touching in contacts.iter().flatten() {
            all.energy += touching.energy;
            all.size += touching.load;
            all.pull += touching.m * touching.load;
            all.slope += touching.slope;
        }
        all
    }

    /// Returns the magnitude of the resulting force on the ball \[N\].
    fn residual(&self) -> f64 {
        self.pull[0].hypot(self.pull[1])
    }

    /// Returns the state of the ball if the forces on the ball are balanced except for rounding
    /// errors.
    ///
    /// * `distance`: distance between the groove-arc centers of nut and screw \[m\].
    fn balanced(&self, distance: f64) -> Option<BallInGrooves> {
        // The position cannot be more accurate than the rounding error of the distance between the
        // groove-arc centers. The stiffness converts this error to a force.
        let stiffness = self.slope.trace();
        let rounding = (64.0 * f64::EPSILON * distance * stiffness).min(1e-6 * self.size);
        (self.residual() <= 1e-7 * self.size + rounding).then(|| self.ball())
    }

    fn ball(&self) -> BallInGrooves {
        let mut force = Vector2::zeros();
        let [mut nut, mut screw] = [Matrix2::zeros(); 2];
        for (c, touching) in self.contacts.iter().enumerate() {
            let Some(touching) = touching else { continue };
            if c < 2 {
                // dV/dw = Σ Q m, summed over the contacts at the nut      (U11)
                force += touching.m * touching.load;
                nut += touching.slope;
            } else {
                screw += touching.slope;
            }
        }
        // U_ww − U_wx U_xx⁻¹ U_xw = A (A + B)⁻¹ B, which avoids the subtraction (U12)
        let slope = inverse(self.slope).map_or([[0.0; 2]; 2], |inverse| {
            let product = nut * inverse * screw;
            let across = 0.5 * (product[(0, 1)] + product[(1, 0)]);
            [[product[(0, 0)], across], [across, product[(1, 1)]]]
        });
        let load = |touching: &Option<ContactForce>| touching.as_ref().map_or(0.0, |t| t.load);
        let angles = from_fn(|c| {
            let m = self.contacts[c].map_or(Vector2::y(), |t| t.m);
            // β = atan2(±m_b, m_n) at the nut; at the screw, m is replaced by −m (U8)
            let outwards = SIGNS[c / 2];
            (outwards * SIGNS[c % 2] * m[0]).atan2(outwards * m[1])
        });
        BallInGrooves {
            loads: from_fn(|c| load(&self.contacts[c])),
            angles,
            energy: self.energy,
            force: force.into(),
            slope,
        }
    }
}

/// Returns the state of a ball that is loaded along one diagonal, in closed form. The − flanks are
/// the mirror image of the + flanks.
fn two_point_ball(diagonal: usize, ball: &GrooveForces) -> BallInGrooves {
    let sign = SIGNS[diagonal];
    let mut found = BallInGrooves::default();
    for contact in [diagonal, 2 + diagonal] {
        (found.loads[contact], found.angles[contact]) = (ball.load, ball.angle);
    }
    let [[bb, bn], [_, nn]] = ball.slope;
    BallInGrooves {
        energy: ball.energy,
        force: [sign * ball.force[0], ball.force[1]],
        slope: [[bb, sign * bn], [sign * bn, nn]],
        ..found
    }
}
