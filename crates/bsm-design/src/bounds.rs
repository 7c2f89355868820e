//! Bounds of a quantity, and the rule that determines whether a value meets the bounds.

/// Relative violation up to which a limit is still considered met, because decimal inputs have
/// rounding errors.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Interval between two numbers, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end, at least as large as the lower end.
    pub high: f64,
}

impl Range {
    /// Returns true if a value is in the range. NaN is in no range.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Returns the value at a fraction of the range: the lower end for 0, and the upper end for 1.
    pub fn at(&self, fraction: f64) -> f64 {
        self.low + (self.high - self.low) * fraction
    }

    /// Returns the range in another unit.
    #[must_use]
    pub fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self { low: change(self.low), high: change(self.high) }
    }
}

/// Lower and upper limit of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// Lower limit, if there is one.
    pub min: Option<f64>,
    /// Upper limit, if there is one.
    pub max: Option<f64>,
}

impl From<Range> for Bounds {
    fn from(range: Range) -> Self {
        Self { min: Some(range.low), max: Some(range.high) }
    }
}

impl Bounds {
    /// Creates limits from an optional lower limit.
    pub fn at_least(min: Option<f64>) -> Self {
        Self { min, max: None }
    }

    /// Creates limits from an optional upper limit.
    pub fn at_most(max: Option<f64>) -> Self {
        Self { min: None, max }
    }

    /// Returns the range between the limits. The ends of `default` replace missing limits.
    pub fn range_or(self, default: Range) -> Range {
        Range { low: self.min.unwrap_or(default.low), high: self.max.unwrap_or(default.high) }
    }

    /// Returns the relative violation of the limits. It is zero or negative within the limits, and
    /// 1 if the value is NaN. Returns `None` if there are no limits.
    pub fn violation(self, value: f64) -> Option<f64> {
        let below = self.min.map(|min| 1.0 - value / min);
        let above = self.max.map(|max| value / max - 1.0);
        let violation = match (below, above) {
            (Some(below), Some(above)) => below.max(above),
            (one, other) => one.or(other)?,
        };
        Some(if value.is_nan() { 1.0 } else { violation })
    }

    /// Returns true if a value is within the limits, or if there are no limits.
    pub fn are_met_by(self, value: f64) -> bool {
        self.violation(value).is_none_or(|violation| violation <= ROUNDING)
    }

    /// Returns the factor by which the value can change before it reaches a limit. Returns `None`
    /// if there are no limits.
    pub fn margin(self, value: f64) -> Option<f64> {
        let below = self.min.map(|min| value / min);
        let above = self.max.map(|max| max / value);
        match (below, above) {
            (Some(below), Some(above)) => Some(below.min(above)),
            (one, other) => one.or(other),
        }
    }

    /// Returns true if a [`margin`](Self::margin) is at least 1, apart from rounding errors.
    pub fn is_sufficient(margin: f64) -> bool {
        margin >= 1.0 - ROUNDING
    }

    /// Returns the limits in another unit.
    #[must_use]
    pub fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self { min: self.min.map(&change), max: self.max.map(&change) }
    }

    /// Returns true if the limits of `self` and `other` agree to within a relative difference.
    ///
    /// * `difference`: largest relative difference.
    pub fn are_close_to(self, other: Self, difference: f64) -> bool {
        let is_close = |one: Option<f64>, other: Option<f64>| match (one, other) {
            (Some(one), Some(other)) => (one - other).abs() <= difference * other.abs(),
            (one, other) => one.is_none() && other.is_none(),
        };
        is_close(self.min, other.min) && is_close(self.max, other.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value at a limit meets the limit in spite of rounding errors, NaN meets no limit, and a
    /// negative value meets an upper limit.
    #[test]
    fn value_at_a_limit_meets_the_limit_in_spite_of_rounding_errors() {
        let both = Bounds { min: Some(0.3), max: Some(2.0) };
        for (value, is_met) in [(0.1 + 0.2, true), (0.299, false), (2.0, true), (2.01, false)] {
            assert_eq!(both.are_met_by(value), is_met, "{value}");
            let margin = both.margin(value).expect("limits");
            assert_eq!(Bounds::is_sufficient(margin), is_met, "{value}");
        }
        assert!(!both.are_met_by(f64::NAN) && Bounds::default().are_met_by(f64::NAN));
        assert!(Bounds::at_most(Some(3.0)).are_met_by(-5.0));
    }
}
