//! Static balance of the gripping ball by lanes, Eqs (W1) to (W7), (P2), (J7), (J8).
//!
//! The force triangle gives both loads by the cotangents of the contact angles. They are the two
//! unknowns; the equations are the radial balance and the closing of the triangle of arc centres.

use bsm_dyn::{Control, RacewayControl, excess_of_nut, rolling_precession, spread_of_control};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::operand::{Lane, Mask};
use crate::pair::{Pair, Side};

/// Newton steps before a point is left to the model.
const MOST_STEPS: usize = 6;

/// Last step of an angle \[rad\]: the error behind it is of the order of its square.
const LAST_STEP: f64 = 1e-9;

/// Largest scaled residual of an answer.
const RESIDUAL: f64 = 1e-12;

/// Largest centrifugal force over the axial load. Beyond it the contact angles are far apart, and
/// the model itself may fail.
const CENTRIFUGAL: f64 = 0.5;

/// Spin moments nearer to each other than this do not decide which race controls, nor cotangents
/// nearer to zero which flank carries.
const TIE: f64 = 1e-9;

/// Precession of the rolling ball relative to the nut over `$W$`.
#[derive(Clone, Copy)]
pub(crate) struct Rolling<S: Simd> {
    pub(crate) p: Lane<S>,
    /// Its derivatives by both cotangents.
    slopes: [Lane<S>; 2],
    /// `$\sin(\beta_B - \beta_A)$`.
    pub(crate) twist: Lane<S>,
}

/// A lane of gripping balls.
pub(crate) struct Grip<S: Simd> {
    /// Where the nut controls.
    pub(crate) by_nut: Mask<S>,
    pub(crate) sides: [Side<S>; 2],
    pub(crate) rolling: Rolling<S>,
    pub(crate) steps: Lane<S>,
    pub(crate) residual: Lane<S>,
    /// Where it is the answer.
    pub(crate) found: Mask<S>,
}

/// The iterate.
#[derive(Clone, Copy)]
struct Iterate<S: Simd> {
    cots: [Lane<S>; 2],
    steps: Lane<S>,
    settled: Mask<S>,
}

/// The gripping balls of a lane, with the race that controls or by the decision: a call of its own, as two kernels
/// share it.
pub(crate) struct Balanced<'a, S: Simd> {
    pub(crate) pair: &'a Pair<S>,
    pub(crate) control: Option<Control>,
}

impl<S: Simd> NullaryFnOnce for Balanced<'_, S> {
    type Output = Grip<S>;

    #[inline(always)]
    fn call(self) -> Grip<S> {
        Grip::of(self.pair, self.control)
    }
}

impl<S: Simd> Grip<S> {
    /// Solves the balance, with the race that controls or by the decision.
    #[inline(always)]
    fn of(pair: &Pair<S>, control: Option<Control>) -> Self {
        let zero = pair.arc.constant(0.0);
        let mut by_nut = match control {
            Some(Control::Screw) => zero.lt(zero),
            Some(Control::Nut) | None => zero.le(zero),
        };
        let inertia = pair.inertia_ratio * (pair.nut_speed.abs() + 1.0);
        let mut at = pair.start();
        pair.settle(&mut at, by_nut);
        // Beyond, the precession, which the angles change by tenths, may turn the slope of the radial balance.
        let unique = inertia.lt(zero.constant(RacewayControl::UNIQUE_BELOW));
        let mut found = pair.regular & at.settled & unique;
        if control.is_none() {
            let excess = pair.nut_excess(&at);
            by_nut = zero.lt(excess);
            found = found & excess.abs().gt(pair.apart(&at) * RacewayControl::CLEAR + TIE);
            at.settled = at.settled & by_nut | !found;
            pair.settle(&mut at, by_nut);
            found = found & at.settled;
        }
        let sides = pair.sides(&at.cots);
        let rolling = pair.rolling(by_nut, &sides);
        let residual = pair.residual(&sides, &rolling);
        let [nut, screw] = at.cots;
        let on_flanks = nut.min(screw).gt(zero.constant(TIE));
        let rate = rolling.p + pair.nut_speed;
        let moderate = (pair.inertia_ratio * rate * rate).lt(zero.constant(CENTRIFUGAL));
        let found = found & on_flanks & moderate & residual.lt(zero.constant(RESIDUAL));
        Self { by_nut, sides, rolling, steps: at.steps, residual, found }
    }
}

/// Derivative of `$l\cos\beta$` by the cotangent.
#[inline(always)]
fn slope<S: Simd>(side: &Side<S>) -> Lane<S> {
    // d cosβ = sin³β d cotβ,  dδ = ⅔ δ sinβ cosβ d cotβ by δ ~ Q^{2/3}
    let (square, cosine) = (side.sin * side.sin, side.cos * side.cos);
    square * side.sin * side.length + side.approach * side.sin * cosine * (2.0 / 3.0)
}

/// `$\cos(\beta_A - \beta_B)$`.
#[inline(always)]
fn between<S: Simd>([a, b]: &[Side<S>; 2]) -> Lane<S> {
    a.cos * b.cos + a.sin * b.sin
}

impl<S: Simd> Pair<S> {
    #[inline(always)]
    fn sides(&self, cots: &[Lane<S>; 2]) -> [Side<S>; 2] {
        [self.side(0, cots[0]), self.side(1, cots[1])]
    }

    /// The angle that the loads of the unloaded angle lead to.
    #[inline(always)]
    fn start(&self) -> Iterate<S> {
        let unloaded = self.cos_b / self.sin_b;
        let [nut, screw] = self.sides(&[unloaded; 2]);
        let cos = self.reach() / (nut.length + screw.length);
        let cot = cos / (self.constant(1.0) - cos * cos).sqrt();
        Iterate { cots: [cot; 2], steps: self.constant(0.0), settled: !self.regular }
    }

    /// Newton steps on the cotangents that are not settled.
    #[inline(always)]
    fn settle(&self, at: &mut Iterate<S>, by_nut: Mask<S>) {
        for _ in 0..MOST_STEPS {
            if !(!at.settled).any() {
                break;
            }
            let sides = self.sides(&at.cots);
            let [nut, screw] = &sides;
            let rolling = self.rolling(by_nut, &sides);
            let [radial, reach] = self.equations(&sides, &rolling);
            let rate = rolling.p + self.nut_speed;
            let drift = self.inertia_ratio * self.cos_a * rate * 2.0;
            let one = self.constant(1.0);
            let [r_a, r_b] = [one - drift * rolling.slopes[0], -one - drift * rolling.slopes[1]];
            let (c_a, c_b) = (slope(nut), slope(screw));
            let scale = (r_a * c_b - r_b * c_a).recip();
            let step_a = (radial * c_b - reach * r_b) * scale;
            let step_b = (reach * r_a - radial * c_a) * scale;
            // dβ = −sin²β d cotβ
            let turn_a = (step_a * nut.sin * nut.sin).abs();
            let largest = turn_a.max((step_b * screw.sin * screw.sin).abs());
            at.cots = [
                at.settled.select(nut.cot, nut.cot - step_a),
                at.settled.select(screw.cot, screw.cot - step_b),
            ];
            at.steps = at.settled.select(at.steps, at.steps + 1.0);
            at.settled = at.settled | largest.lt(self.constant(LAST_STEP));
        }
    }

    /// What is left of the radial balance and of the closing triangle.
    #[inline(always)]
    fn equations(&self, [nut, screw]: &[Side<S>; 2], rolling: &Rolling<S>) -> [Lane<S>; 2] {
        let rate = rolling.p + self.nut_speed;
        [
            // Q_A cosβ_A − Q_B cosβ_B = m r_m P²,  Q_A sinβ_A = Q_B sinβ_B  (W2)
            nut.cot - screw.cot - self.inertia_ratio * self.cos_a * rate * rate,
            // l_A cosβ_A + l_B cosβ_B = A₂                                (J7)
            nut.length * nut.cos + screw.length * screw.cos - self.reach(),
        ]
    }

    #[inline(always)]
    fn residual(&self, sides: &[Side<S>; 2], rolling: &Rolling<S>) -> Lane<S> {
        let [radial, reach] = self.equations(sides, rolling);
        let size = self.cos_a * self.inertia_ratio.max(self.constant(1.0));
        (radial / size).abs().max((reach / self.reach()).abs())
    }

    /// Rolling at both contact centres, without spin at the controlling race.
    #[inline(always)]
    fn rolling(&self, by_nut: Mask<S>, sides: &[Side<S>; 2]) -> Rolling<S> {
        let [a, b] = sides;
        let one = self.constant(1.0);
        let between = between(sides);
        let twist = b.sin * a.cos - b.cos * a.sin;
        let scale = (one + between).recip();
        let p = rolling_precession(by_nut, self.lever, [a.cos, b.cos], between);
        // By the cotangents: d cosβ = sin³β, d cos(β_A − β_B) = ∓sin²β sin(β_B − β_A).
        let (square_a, square_b) = (a.sin * a.sin, b.sin * b.sin);
        let follow = by_nut.select(-p, one - p) * twist;
        let (lift_a, lift_b) = (self.lever * a.sin, self.lever * b.sin);
        let zero = self.constant(0.0);
        let slopes = [
            -(square_a * (follow + by_nut.select(zero, lift_a)) * scale),
            square_b * (follow - by_nut.select(lift_b, zero)) * scale,
        ];
        Rolling { p, slopes, twist }
    }

    /// By how much the cotangents differ between the balls of both races, to first order.
    #[inline(always)]
    fn apart(&self, at: &Iterate<S>) -> Lane<S> {
        let sides = self.sides(&at.cots);
        let ([a, b], between, one) = (&sides, between(&sides), self.constant(1.0));
        let scale = (one + between).recip();
        // P/W by (W4), and by (W6) less that
        let nut = (one - self.lever * b.cos) * scale + self.nut_speed;
        let change = (between - one + self.lever * (b.cos - a.cos)) * scale;
        spread_of_control(self.inertia_ratio, self.cos_a, [change, nut + nut + change])
    }

    /// By how much the spin moment of the nut exceeds that of the screw, relative.
    #[inline(always)]
    fn nut_excess(&self, at: &Iterate<S>) -> Lane<S> {
        let sides = self.sides(&at.cots);
        let ([a, b], [nut, screw]) = (&sides, &self.pressed);
        let moment_a = a.load * a.growth * nut.hertz.semi_axis * nut.hertz.second_integral;
        let moment_b = b.load * b.growth * screw.hertz.semi_axis * screw.hertz.second_integral;
        excess_of_nut([moment_a, moment_b], between(&sides))
    }
}
