//! Grids of points over varied inputs. The points are generated on demand.

use std::fmt::{self, Display, Formatter};
use std::iter::repeat_n;
use std::ops::Range;

use crate::vocabulary::error::invalid_input;
use crate::vocabulary::number;
use crate::vocabulary::units::UnitChange;
use crate::{Case, CaseError, InputKey, InputSet, ModelChoice};

/// A varied input of a grid and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct GridAxis {
    /// Varied input.
    pub key: InputKey,
    /// Values of the varied input.
    values: AxisValues,
}

/// Values of an input that is varied in a grid.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisValues {
    /// Equally spaced values, including both ends.
    Range {
        /// First value.
        start: f64,
        /// Last value.
        stop: f64,
        /// Number of values, at least 2.
        count: usize,
        /// True if successive values have equal ratios, false if they have equal differences.
        log: bool,
    },
    /// List of individual values.
    List(Vec<f64>),
}

impl AxisValues {
    /// Returns the values that must be checked against a rule. The ends of a range are sufficient,
    /// because every rule permits an interval.
    fn ends(&self) -> Vec<f64> {
        match self {
            Self::Range { start, stop, .. } => vec![*start, *stop],
            Self::List(values) => values.clone(),
        }
    }

    /// Converts the values to another unit.
    fn in_unit(self, change: UnitChange) -> Self {
        match self {
            Self::Range { start, stop, count, log } => {
                Self::Range { start: change.value(start), stop: change.value(stop), count, log }
            }
            Self::List(values) => Self::List(values.into_iter().map(|v| change.value(v)).collect()),
        }
    }
}

impl GridAxis {
    /// Parses `name=start:stop:count` (both ends included), `name=start:stop:count:log` for equal
    /// ratios instead of equal differences, or `name=v1,v2,...`.
    ///
    /// # Errors
    /// Returns [`CaseError`] if the text has another form. Also returns the errors of
    /// [`new`](Self::new).
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let form = "name=start:stop:count, name=start:stop:count:log or name=v1,v2,... with finite numbers and a \
                    count of at least 2; both ends of a log range must be > 0";
        let malformed = || CaseError::bad_setting(text, form);
        let (name, values) = text.split_once('=').ok_or_else(malformed)?;
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let values = match values.split(':').collect::<Vec<_>>()[..] {
            [start, stop, count, ref spacing @ ..] => {
                let log = match spacing {
                    [] => false,
                    [word] if word.trim() == "log" => true,
                    _ => return Err(malformed()),
                };
                let end = |text| number(text).ok_or_else(malformed);
                let count = count.trim().parse().map_err(|_| malformed())?;
                AxisValues::Range { start: end(start)?, stop: end(stop)?, count, log }
            }
            [list] => {
                let values: Option<_> = list.split(',').map(number).collect();
                AxisValues::List(values.ok_or_else(malformed)?)
            }
            _ => return Err(malformed()),
        };
        Self::new(name.trim(), values)
    }

    /// Creates an axis that varies an input.
    ///
    /// * `name`: name of the input, which may end with a unit other than the default unit.
    /// * `values`: values of the input, in the unit with which `name` ends.
    ///
    /// # Errors
    /// Returns [`CaseError`] for an unknown input, a value that is not finite or violates the rule
    /// of the input, a range of fewer than 2 values, an empty list, and a range with equal ratios
    /// whose ends are not both positive.
    pub fn new(name: &str, values: AxisValues) -> Result<Self, CaseError> {
        let (key, change) = InputKey::in_unit(name)?;
        let values = values.in_unit(change);
        let wrong = |what: String| Err(invalid_input(key.name(), what));
        match &values {
            AxisValues::Range { count, .. } if *count < 2 => {
                return wrong(format!("has a range of {count} values, but must have at least 2"));
            }
            AxisValues::Range { start, stop, log: true, .. } if !(*start > 0.0 && *stop > 0.0) => {
                return wrong("must have both ends of a logarithmic range above 0".to_owned());
            }
            AxisValues::List(list) if list.is_empty() => {
                return wrong("must have at least one value".to_owned());
            }
            _ => {}
        }
        for value in values.ends() {
            if !value.is_finite() {
                return wrong(format!("has the value {value}, but must have finite values"));
            }
            key.input().rule.check(key.name(), value)?;
        }
        Ok(Self { key, values })
    }

    /// Returns the number of values, which is at least 1.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        match &self.values {
            AxisValues::Range { count, .. } => *count,
            AxisValues::List(values) => values.len(),
        }
    }

    /// Returns the value with index `i`. The ends of a range are exact.
    pub fn value(&self, i: usize) -> f64 {
        match &self.values {
            AxisValues::Range { start, stop, count, log } => {
                if i + 1 == *count {
                    return *stop;
                }
                let fraction = number::count(i) / number::count(*count - 1);
                if *log {
                    let (from, to) = (start.ln(), stop.ln());
                    return if i == 0 { *start } else { (from + (to - from) * fraction).exp() };
                }
                let span = stop - start;
                if span.is_finite() {
                    start + span * fraction
                } else {
                    start * (1.0 - fraction) + stop * fraction
                }
            }
            AxisValues::List(values) => values[i],
        }
    }

    /// Returns true for a range with logarithmic spacing.
    pub fn is_log(&self) -> bool {
        matches!(self.values, AxisValues::Range { log: true, .. })
    }
}

/// Formats the axis for [`GridAxis::parse`], with the smallest number of digits that reproduces the
/// values.
impl Display for GridAxis {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let number = |value: &f64| format!("{value:?}").trim_end_matches(".0").to_owned();
        write!(f, "{}=", self.key.name())?;
        match &self.values {
            AxisValues::Range { start, stop, count, log } => {
                let log = if *log { ":log" } else { "" };
                write!(f, "{}:{}:{count}{log}", number(start), number(stop))
            }
            AxisValues::List(values) => {
                f.write_str(&values.iter().map(number).collect::<Vec<_>>().join(","))
            }
        }
    }
}

/// Cartesian product of axes. The last axis varies fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    axes: Vec<GridAxis>,
    len: usize,
}

impl Grid {
    /// Parses the axes of a grid (see [`GridAxis::parse`]).
    ///
    /// # Errors
    /// Returns the same errors as [`GridAxis::parse`] and [`new`](Self::new).
    pub fn parse<T: AsRef<str>>(axes: &[T]) -> Result<Self, CaseError> {
        let axes = axes.iter().map(|axis| GridAxis::parse(axis.as_ref()));
        Self::new(axes.collect::<Result<_, _>>()?)
    }

    /// Creates the Cartesian product of `axes`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input appears twice or the number of points is too large to
    /// count.
    pub fn new(axes: Vec<GridAxis>) -> Result<Self, CaseError> {
        for (i, axis) in axes.iter().enumerate() {
            if axes[..i].iter().any(|former| former.key == axis.key) {
                return Err(CaseError::given_twice([axis.key.name(); 2]));
            }
        }
        let varied: InputSet = axes.iter().map(|axis| axis.key).collect();
        if let Some(keys) = varied.two_forms().next() {
            return Err(CaseError::given_twice(keys.map(InputKey::name)));
        }
        let len = axes
            .iter()
            .try_fold(1_usize, |product, axis| product.checked_mul(axis.len()))
            .ok_or_else(|| CaseError::grid_too_large(usize::MAX))?;
        Ok(Self { axes, len })
    }

    /// Returns the number of points in the grid.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns the axes of the grid, one for each varied input.
    pub fn axes(&self) -> &[GridAxis] {
        &self.axes
    }

    /// Returns the values of the varied inputs at point `i`, one per axis.
    pub fn point(&self, i: usize) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.axes.len());
        for axis in 0..self.axes.len() {
            self.append_values(axis, i..i + 1, &mut values);
        }
        values
    }

    /// Appends the values of an axis at a range of points.
    pub fn append_values(&self, axis: usize, points: Range<usize>, to: &mut Vec<f64>) {
        // Number of consecutive points that share a value of this axis.
        let run: usize = self.axes[axis + 1..].iter().map(GridAxis::len).product();
        let (axis, mut at, first) = (&self.axes[axis], points.start, points.start / run);
        let (period, begin) = (run * axis.len(), to.len());
        let once = points.end.min(points.start.saturating_add(period));
        let (mut place, mut end) = (first % axis.len(), (first + 1) * run);
        while at < once {
            let until = end.min(once);
            to.extend(repeat_n(axis.value(place), until - at));
            (at, end) = (until, end.saturating_add(run));
            place = if place + 1 < axis.len() { place + 1 } else { 0 };
        }
        while at < points.end {
            let rows = period.min(points.end - at);
            to.extend_from_within(begin..begin + rows);
            at += rows;
        }
    }

    /// Returns the inputs that the grid varies.
    pub fn varied(&self) -> InputSet {
        self.axes.iter().map(|axis| axis.key).collect()
    }

    /// Checks all inputs and rules of `base` that do not depend on the varied inputs.
    ///
    /// # Errors
    /// Returns the same errors as [`Case::check`].
    pub fn check(&self, base: &Case) -> Result<(), CaseError> {
        base.check_but(self.varied().replaced())
    }

    /// Chooses one model for all points. If the user has specified a model, the first or the last
    /// point must be within the valid range of this model (see [`ModelChoice::resolve`]).
    ///
    /// # Errors
    /// Returns the same errors as [`check`](Self::check) and [`ModelChoice::resolve`].
    pub fn choose(&self, base: &Case, choice: ModelChoice) -> Result<ModelChoice, CaseError> {
        self.check(base)?;
        let ends = [0, self.len - 1].map(|i| self.case(base, &self.point(i)));
        let covers = |model| ends[0].covered_by(model).or_else(|_| ends[1].covered_by(model));
        choice.resolve(base.stated_over(self.varied()), covers)
    }

    /// Returns a copy of `base` with the input values of a [`point`](Self::point).
    #[must_use]
    pub fn case(&self, base: &Case, point: &[f64]) -> Case {
        let (mut case, mut settings) = (base.clone(), Case::default());
        for (axis, value) in self.axes.iter().zip(point) {
            settings[axis.key] = Some(*value);
        }
        case.override_with(&settings);
        case
    }
}
