//! Roots of functions of one variable between two points of different sign.

/// Value of a function and, if known, its slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FunctionValue {
    /// The value.
    pub value: f64,
    /// The slope; with it the next point is that of a Newton step.
    pub slope: Option<f64>,
}

impl From<f64> for FunctionValue {
    fn from(value: f64) -> Self {
        Self { value, slope: None }
    }
}

impl From<(f64, f64)> for FunctionValue {
    fn from((value, slope): (f64, f64)) -> Self {
        Self { value, slope: Some(slope) }
    }
}

/// Two points between which a function changes its sign, and the tolerance of the root.
///
/// Guarantees of [`root`](Self::root) for any function:
///
/// * **Bounded**: at most [`MAX_EVALUATIONS`](Self::MAX_EVALUATIONS) evaluations for any function and
///   bracket (N13); a smooth function takes six to ten, with slopes and a good start two or three.
/// * **Guarded**: every point lies strictly between the ends, which always have different signs, and an
///   interpolation that does not shrink the bracket is followed by a halving: of the length, and of
///   the number of doubles in the bracket, so that roots next to zero and brackets over hundreds of
///   orders of magnitude are no exception.
/// * **Exact at the ends**: an end whose value is zero is the root, without an evaluation.
/// * **A sign change, no more**: of several roots one is found; a jump or a pole is found too, and
///   [`Root::value`] is not small there. A predicate is a function that is 1 or -1; the answer then is in
///   [`Root::ends`].
/// * **NaN ends the search** with [`RootResult::NotFinite`]; infinite values are allowed because they have a sign. A
///   function that may fail returns NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bracket {
    /// The points, in any order.
    pub ends: [f64; 2],
    /// The values there; an infinity of the right sign if only the sign is known.
    pub values: [f64; 2],
    /// First point to evaluate; defaults to the zero of the line through the ends.
    pub start: Option<f64>,
    /// Relative tolerance: the search ends when the bracket or a Newton step is shorter than this part of the root. Zero
    /// means that no double is left between the ends.
    pub x_tol: f64,
    /// The search ends when the absolute value of the function is not larger than this.
    pub f_tol: f64,
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RootResult {
    /// A sign change.
    Root(Root),
    /// Both ends have the same sign.
    NoSignChange {
        /// The values at the ends.
        values: [f64; 2],
    },
    /// A value is NaN, or an end is not finite.
    NotFinite {
        /// Where.
        x: f64,
        /// The value there.
        value: f64,
    },
}

/// A sign change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// The root.
    pub x: f64,
    /// The value there; after a Newton step that is shorter than the tolerance, the value of the point
    /// before.
    pub value: f64,
    /// The bracket at the end, on the sides of the two ends that were given.
    pub ends: [f64; 2],
    /// The values there.
    pub values: [f64; 2],
    /// Evaluations of the function.
    pub evaluations: usize,
}

impl RootResult {
    /// The root, if there is one.
    pub fn root(self) -> Option<Root> {
        match self {
            Self::Root(root) => Some(root),
            Self::NoSignChange { .. } | Self::NotFinite { .. } => None,
        }
    }
}

impl Bracket {
    /// Five evaluations for each of the 64 halvings that leave no double in a bracket (N13).
    pub const MAX_EVALUATIONS: usize = 5 * 64;

    /// Creates a bracket whose root is found to the last double.
    pub fn new(ends: [f64; 2], values: [f64; 2]) -> Self {
        Self { ends, values, start: None, x_tol: 0.0, f_tol: 0.0 }
    }

    /// Returns the bracket between the first two successive points at which a function does not have the same sign, where
    /// zero and NaN have none; `None` if the sign never changes.
    ///
    /// * `begin`: the first point and the value there. * `places`: the following points.
    ///
    /// # Errors
    ///
    /// The first error of `function`.
    pub fn first_change<E>(
        begin: (f64, f64),
        places: impl IntoIterator<Item = f64>,
        mut function: impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<Option<Self>, E> {
        let (mut x, mut value) = begin;
        for next in places {
            let there = function(next)?;
            let same_sign = value > 0.0 && there > 0.0 || value < 0.0 && there < 0.0;
            if !same_sign {
                return Ok(Some(Self::new([x, next], [value, there])));
            }
            (x, value) = (next, there);
        }
        Ok(None)
    }

    /// Finds the root.
    ///
    /// Newton steps where slopes are given, else inverse quadratic interpolation where three values
    /// lie on a curve that it fits (N12).
    ///
    /// Source: Chandrupatla, *A new hybrid quadratic/bisection algorithm for finding the zero of a
    /// nonlinear function without using derivatives*, Adv. Eng. Softw. 28 (1997); the guards by
    /// length and number of doubles are ours.
    pub fn root<S: Into<FunctionValue>>(&self, mut function: impl FnMut(f64) -> S) -> RootResult {
        let (mut ends, mut values) = (self.ends, self.values);
        for (x, value) in ends.into_iter().zip(values) {
            if !x.is_finite() || value.is_nan() {
                return RootResult::NotFinite { x, value };
            }
        }
        let mut evaluations = 0;
        let done = |x, value, ends, values, evaluations| {
            RootResult::Root(Root { x, value, ends, values, evaluations })
        };
        for (x, value) in ends.into_iter().zip(values) {
            if value.abs() <= self.f_tol {
                return done(x, value, ends, values, evaluations);
            }
        }
        if (values[0] > 0.0) == (values[1] > 0.0) {
            return RootResult::NoSignChange { values };
        }
        // The end that was moved last, what it was before, and the slope there.
        let (mut newest, mut old, mut slope) = (0, None::<(f64, f64)>, None::<f64>);
        let mut start = self.start;
        let (mut length, mut doubles) = (Progress::new(2), Progress::new(3));
        loop {
            let [x, other] = [ends[newest], ends[1 - newest]];
            let [value, opposite] = [values[newest], values[1 - newest]];
            let best = if value.abs() <= opposite.abs() { (x, value) } else { (other, opposite) };
            let inside = |t: f64| t > x.min(other) && t < x.max(other);
            let tolerance = self.x_tol * best.0.abs();
            let newton = slope.map(|slope| x - value / slope).filter(|t| inside(*t));
            if let Some(t) = newton.filter(|t| (t - x).abs() <= tolerance) {
                return done(t, value, ends, values, evaluations);
            }
            let halves = between(x, other);
            if (other - x).abs() <= tolerance || !inside(halves) {
                return done(best.0, best.1, ends, values, evaluations);
            }
            let middle = 0.5 * x + 0.5 * other;
            let is_long = length.stalls((other - x).abs());
            #[expect(clippy::cast_precision_loss, reason = "a measure of size")]
            let are_many = doubles.stalls(ordinal(x).abs_diff(ordinal(other)) as f64);
            let next = if let Some(start) = start.take().filter(|t| inside(*t)) {
                start
            } else if are_many {
                halves
            } else if is_long && inside(middle) {
                middle
            } else {
                newton.unwrap_or_else(|| {
                    // Not nearer to an end than what is wanted, so that the other end moves too.
                    let rounding = 0.5 * tolerance.max(2.0 * f64::EPSILON * best.0.abs());
                    let least = (rounding / (other - x).abs()).min(0.5);
                    let part = part((x, value), (other, opposite), old).clamp(least, 1.0 - least);
                    let t = x + part * (other - x);
                    if inside(t) { t } else { halves }
                })
            };
            let sample = function(next).into();
            evaluations += 1;
            if sample.value.is_nan() {
                return RootResult::NotFinite { x: next, value: sample.value };
            }
            let side = usize::from((sample.value > 0.0) != (values[0] > 0.0));
            // The third place is that which left the bracket.
            old = Some((ends[side], values[side]));
            (ends[side], values[side]) = (next, sample.value);
            (newest, slope) = (side, sample.slope);
            if sample.value.abs() <= self.f_tol {
                return done(next, sample.value, ends, values, evaluations);
            }
        }
    }
}

/// Part of the way from the newest place to the other end at which the root is presumed.
fn part((a, fa): (f64, f64), (b, fb): (f64, f64), old: Option<(f64, f64)>) -> f64 {
    let quadratic = old.and_then(|(c, fc)| {
        // ξ = (a − b)/(c − b),  φ = (f_a − f_b)/(f_c − f_b);  if φ² < ξ and (1 − φ)² < 1 − ξ  (N12)
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        (phi * phi < xi && (1.0 - phi).powi(2) < 1.0 - xi).then(|| {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        })
    });
    let line = fa / (fa - fb);
    let part = quadratic.unwrap_or(if old.is_none() { line } else { 0.5 });
    if part.is_finite() { part } else { 0.5 }
}

/// Detects that a size was not halved during a number of steps.
struct Progress {
    patience: u32,
    size: f64,
    left: u32,
}

impl Progress {
    fn new(patience: u32) -> Self {
        Self { patience, size: f64::INFINITY, left: patience }
    }

    fn stalls(&mut self, size: f64) -> bool {
        if size <= 0.5 * self.size {
            (self.size, self.left) = (size, self.patience);
        } else if self.left == 0 {
            (self.size, self.left) = (size, self.patience);
            return true;
        } else {
            self.left -= 1;
        }
        false
    }
}

/// Number of a double in their order.
fn ordinal(x: f64) -> i64 {
    let bits = x.to_bits().cast_signed();
    if bits < 0 { i64::MIN - bits } else { bits }
}

/// The double in the middle between two, by their number.
fn between(a: f64, b: f64) -> f64 {
    let middle = i64::midpoint(ordinal(a), ordinal(b));
    f64::from_bits((if middle < 0 { i64::MIN - middle } else { middle }).cast_unsigned())
}
