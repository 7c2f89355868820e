//! Root finding for functions of one variable, between two points at which the function values have
//! opposite signs.

/// Value of a function at a point and, if known, its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FunctionValue {
    /// Function value.
    pub value: f64,
    /// Derivative, if known. If it is known, the search takes a Newton step unless this step would
    /// leave the bracket.
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

/// Bracket of two points between which a function changes sign, and the tolerances for the root.
///
/// The method [`root`](Self::root) has these properties for any function:
///
/// * **Bounded**: the method evaluates the function at most
///   [`MAX_EVALUATIONS`](Self::MAX_EVALUATIONS) times (N13). A smooth function requires six to ten
///   evaluations, or two or three if derivatives and a good starting point are available.
/// * **Guarded**: every new point lies strictly between the ends, and the values at the ends always
///   have opposite signs. If interpolation does not shrink the bracket fast enough, the bracket is
///   bisected, either by length or by the number of doubles that it contains. The second variant
///   handles roots near zero and brackets that span hundreds of orders of magnitude.
/// * **Exact at the ends**: if the function value at an end of the bracket is zero, this end is
///   returned without any evaluation.
/// * **Finds any sign change**: if there are several roots, the method finds one of them. The
///   method also finds jumps and poles, for which [`Root::value`] is not small. To search for the
///   transition of a predicate, use a function with the values 1 and -1; [`Root::ends`] then
///   encloses the transition.
/// * **Stops at NaN**: a NaN ends the search with [`RootResult::NotFinite`], so functions can
///   return NaN to signal a failure. Infinite values are allowed because they have a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bracket {
    /// Ends of the bracket, in any order.
    pub ends: [f64; 2],
    /// Function values at the ends. If only the sign of a value is known, use infinity with this
    /// sign.
    pub values: [f64; 2],
    /// First point to evaluate. Defaults to the root of the linear interpolation between both ends.
    pub start: Option<f64>,
    /// Relative tolerance of the root. The search ends when the width of the bracket or a Newton
    /// step is at most `x_tol` times the root. If the tolerance is zero, the search ends when there
    /// is no floating-point number between the ends of the bracket.
    pub x_tol: f64,
    /// Absolute tolerance of the function value. The search ends when the absolute function value
    /// is at most `f_tol`.
    pub f_tol: f64,
}

/// Result of a root search.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use = "a search may find no sign change"]
pub enum RootResult {
    /// The search found a sign change.
    Root(Root),
    /// The function values at both ends have the same sign.
    NoSignChange {
        /// Function values at the ends.
        values: [f64; 2],
    },
    /// A function value is NaN, or an end is not finite.
    NotFinite {
        /// Point at which the search stopped.
        x: f64,
        /// Function value at `x`.
        value: f64,
    },
}

/// A sign change of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Location of the root.
    pub x: f64,
    /// Function value at the root. If the search ended with a Newton step shorter than the
    /// tolerance, the field contains the value before the step.
    pub value: f64,
    /// Ends of the final bracket, in the same order as the initial ends.
    pub ends: [f64; 2],
    /// Function values at the ends of the final bracket.
    pub values: [f64; 2],
    /// Number of function evaluations.
    pub evaluations: usize,
}

impl RootResult {
    /// Returns the root, or `None` if the search found no sign change.
    pub fn root(self) -> Option<Root> {
        match self {
            Self::Root(root) => Some(root),
            Self::NoSignChange { .. } | Self::NotFinite { .. } => None,
        }
    }
}

impl Bracket {
    /// Maximum number of function evaluations. It allows five evaluations for each of 64
    /// bisections. After 64 bisections, no bracket contains further floating-point numbers (N13).
    pub const MAX_EVALUATIONS: usize = 5 * 64;

    /// Creates a bracket without a starting point and with zero tolerances.
    pub fn new(ends: [f64; 2], values: [f64; 2]) -> Self {
        Self { ends, values, start: None, x_tol: 0.0, f_tol: 0.0 }
    }

    /// Evaluates a function at successive points and returns the first pair of neighboring points
    /// whose values have different signs. Returns `None` if the sign never changes.
    ///
    /// Zero and NaN count as values without a sign, so they end the search.
    ///
    /// * `begin`: first point and its function value.
    /// * `places`: points after `begin`, in the order in which the function is evaluated.
    ///
    /// # Errors
    ///
    /// Returns the first error of `function`.
    pub fn first_sign_change<E>(
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

    /// Finds a sign change in the same way as [`root`](Self::root), but for a function that may
    /// return an error.
    ///
    /// # Errors
    /// Returns the first error that `function` returns. This error ends the search.
    pub fn try_root<E>(
        &self,
        mut function: impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<RootResult, E> {
        let mut failed = None;
        let found = self.root(|x| {
            function(x).unwrap_or_else(|error| {
                failed = Some(error);
                f64::NAN
            })
        });
        failed.map_or(Ok(found), Err)
    }

    /// Finds a sign change in the bracket.
    ///
    /// If `function` returns derivatives, the search uses Newton steps. Otherwise it uses inverse
    /// quadratic interpolation if the last three values satisfy (N12).
    /// Source: Chandrupatla, *A new hybrid quadratic/bisection algorithm for finding the zero of a
    /// nonlinear function without using derivatives*, Adv. Eng. Softw. 28 (1997). The safeguards
    /// based on the bracket length and on the number of floating-point values inside the bracket
    /// are our own.
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
        // The variable `newest` is the index of the bracket end that was moved last, `old` is the
        // point that this end replaced, and `slope` is the derivative at the new position of the
        // end.
        let (mut newest, mut old, mut slope) = (0, None::<(f64, f64)>, None::<f64>);
        let mut start = self.start;
        let (mut length, mut doubles) = (StallDetector::new(2), StallDetector::new(3));
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
                    // The next point keeps a minimum distance from both ends of the bracket. If one
                    // end is already close to the root, the next point then lies beyond the root
                    // and replaces the other end.
                    let rounding = 0.5 * tolerance.max(2.0 * f64::EPSILON * best.0.abs());
                    let least = (rounding / (other - x).abs()).min(0.5);
                    let fraction = interpolated_fraction((x, value), (other, opposite), old);
                    let t = x + fraction.clamp(least, 1.0 - least) * (other - x);
                    if inside(t) { t } else { halves }
                })
            };
            let sample = function(next).into();
            evaluations += 1;
            debug_assert!(
                evaluations <= Self::MAX_EVALUATIONS,
                "the search exceeded the maximum number of evaluations"
            );
            if sample.value.is_nan() {
                return RootResult::NotFinite { x: next, value: sample.value };
            }
            let side = usize::from((sample.value > 0.0) != (values[0] > 0.0));
            // The replaced point becomes the third point of the interpolation.
            old = Some((ends[side], values[side]));
            (ends[side], values[side]) = (next, sample.value);
            (newest, slope) = (side, sample.slope);
            if sample.value.abs() <= self.f_tol {
                return done(next, sample.value, ends, values, evaluations);
            }
        }
    }
}

/// Returns the estimated position of the root as a fraction of the distance from the newest point
/// `a` to the other end `b`.
///
/// * `old`: point that was replaced last, if any.
fn interpolated_fraction((a, fa): (f64, f64), (b, fb): (f64, f64), old: Option<(f64, f64)>) -> f64 {
    let quadratic = old.and_then(|(c, fc)| {
        // ξ = (a − b)/(c − b),  φ = (f_a − f_b)/(f_c − f_b);  if φ² < ξ and (1 − φ)² < 1 − ξ  (N12)
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        (phi * phi < xi && (1.0 - phi).powi(2) < 1.0 - xi).then(|| {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        })
    });
    let line = fa / (fa - fb);
    let fraction = quadratic.unwrap_or(if old.is_none() { line } else { 0.5 });
    if fraction.is_finite() { fraction } else { 0.5 }
}

/// Detects that an interval has not been halved within a given number of steps.
struct StallDetector {
    patience: u32,
    size: f64,
    left: u32,
}

impl StallDetector {
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

/// Returns the index of a floating-point number in the ordered sequence of all `f64` values.
fn ordinal(x: f64) -> i64 {
    let bits = x.to_bits().cast_signed();
    if bits < 0 { i64::MIN - bits } else { bits }
}

/// Returns the `f64` value halfway between two `f64` values, measured by their indices in the
/// sequence of all `f64` values.
fn between(a: f64, b: f64) -> f64 {
    let middle = i64::midpoint(ordinal(a), ordinal(b));
    f64::from_bits((if middle < 0 { i64::MIN - middle } else { middle }).cast_unsigned())
}
