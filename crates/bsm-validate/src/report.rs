//! Checks of calculated results against published data, and the report of all checks.

use bsm_case::{Answer, Content};
use bsm_report::PROGRAM;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

/// Result of comparing a calculated number with a published claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The published claim holds.
    Pass,
    /// The published claim does not hold.
    Fail,
    /// No reference value exists, or a published trend does not hold.
    Finding,
}

/// A published statement or number, and the result that the program calculates.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Check {
    /// Key of the check in the form `<source>/<what>`. The key never changes.
    pub key: String,
    /// Paper and equation that contain the claim.
    pub source: String,
    /// The published claim as text.
    pub claim: String,
    /// The published number; `None` if the claim is not a number.
    pub claimed: Option<f64>,
    /// The number that the program calculates.
    #[schemars(with = "Option<f64>")]
    pub measured: f64,
    /// Unit of `claimed` and `measured`.
    pub unit: String,
    /// Condition that `measured` must satisfy, and the reason for its tolerance.
    pub criterion: String,
    /// Point at which the calculated number occurs, or other information about this number.
    pub note: String,
    /// Further numbers, which are shown only on the HTML page.
    pub details: String,
    /// Result of the check.
    pub verdict: Verdict,
}

/// Returns the largest of several nonnegative numbers, or NaN if any of them is NaN.
pub(crate) fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
    numbers.into_iter().fold(0.0, larger)
}

impl Check {
    /// Creates a check without a condition. Its verdict is `Finding` until a condition is set.
    pub(crate) fn new(key: &str, source: &str, claim: impl Into<String>) -> Self {
        Self {
            key: key.to_owned(),
            source: source.to_owned(),
            claim: claim.into(),
            claimed: None,
            measured: f64::NAN,
            unit: String::new(),
            criterion: String::new(),
            note: String::new(),
            details: String::new(),
            verdict: Verdict::Finding,
        }
    }

    /// Sets the calculated number and its unit.
    pub(crate) fn measured(mut self, value: f64, unit: &str) -> Self {
        self.measured = value;
        unit.clone_into(&mut self.unit);
        self
    }

    /// Sets the note on the calculated number.
    pub(crate) fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Sets the condition that the calculated number is at most `limit`.
    pub(crate) fn at_most(self, limit: f64, reason: &str) -> Self {
        let holds = self.measured <= limit;
        self.judge(holds, format!("at most {limit:.3e}: {reason}"))
    }

    /// Sets the condition that the calculated number is at least `limit`.
    pub(crate) fn at_least(self, limit: f64, reason: &str) -> Self {
        let holds = self.measured >= limit;
        self.judge(holds, format!("at least {limit:.3e}: {reason}"))
    }

    /// Sets the condition that the calculated number differs from the claimed number by at most
    /// `tolerance`.
    pub(crate) fn equals(mut self, claimed: f64, tolerance: f64, reason: &str) -> Self {
        let holds = (self.measured - claimed).abs() <= tolerance;
        self.claimed = Some(claimed);
        self.judge(holds, format!("within {tolerance:.3e} of the claim: {reason}"))
    }

    /// Sets the number of curves that follow a published trend (`held` of `curves`). If the numbers
    /// differ from the recorded numbers, the results have changed, and the check fails. Otherwise,
    /// the verdict is `Pass` if all curves follow the trend, and `Finding` if some curves do not.
    pub(crate) fn follows(mut self, held: usize, curves: usize, recorded: (usize, usize)) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a few curves")]
        let [measured, claimed] = [held, curves].map(|n| n as f64);
        (self.measured, self.claimed) = (measured, Some(claimed));
        "curves".clone_into(&mut self.unit);
        self.criterion = format!("{} of {} curves, as recorded", recorded.0, recorded.1);
        self.verdict = match (held, curves) == recorded {
            true if held == curves => Verdict::Pass,
            true => Verdict::Finding,
            false => Verdict::Fail,
        };
        self
    }

    fn judge(mut self, holds: bool, criterion: String) -> Self {
        self.criterion = criterion;
        self.verdict = if holds { Verdict::Pass } else { Verdict::Fail };
        self
    }
}

/// Results of all checks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// All checks, in the order in which they were run.
    pub checks: Vec<Check>,
}

/// The results of all checks in JSON.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ReportJson<'a> {
    /// Name and version of the program.
    pub program: &'static str,
    /// True if no check failed.
    pub passed: bool,
    /// The checks in the order in which they were run.
    pub checks: &'a [Check],
}

impl Report {
    /// Returns the number of checks with the given verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|c| c.verdict == verdict).count()
    }

    /// Returns the answer of `bsm validate`, which counts as failed if any check fails.
    pub fn answer(&self) -> Answer {
        Answer { fails: !self.passed(), ..Answer::default() }
            .with("", Content::Json(self.to_json()))
    }

    /// Returns the results of all checks as JSON, with the name and version of the program.
    pub fn to_json(&self) -> Value {
        json!(ReportJson { program: PROGRAM, passed: self.passed(), checks: &self.checks })
    }

    /// Returns true if no check failed.
    pub fn passed(&self) -> bool {
        self.count(Verdict::Fail) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wrong number must fail a check, and NaN must never pass a check.
    #[test]
    fn validation_check_fails_for_a_wrong_number_or_nan() {
        let check = |measured| Check::new("k", "s", "c").measured(measured, "");
        assert_eq!(check(1.0).verdict, Verdict::Finding);
        assert_eq!(check(1.0).at_most(1.0, "").verdict, Verdict::Pass);
        assert_eq!(check(1.1).at_most(1.0, "").verdict, Verdict::Fail);
        assert_eq!(check(f64::NAN).at_most(1.0, "").verdict, Verdict::Fail);
        assert_eq!(check(1.0).at_least(1.0, "").verdict, Verdict::Pass);
        assert_eq!(check(0.9).at_least(1.0, "").verdict, Verdict::Fail);
        assert_eq!(check(f64::NAN).at_least(1.0, "").verdict, Verdict::Fail);
        assert_eq!(check(1.0).equals(1.05, 0.1, "").verdict, Verdict::Pass);
        assert_eq!(check(1.0).equals(1.2, 0.1, "").verdict, Verdict::Fail);
        assert_eq!(check(f64::NAN).equals(1.2, 0.1, "").verdict, Verdict::Fail);
        let trend = |held, recorded| check(0.0).follows(held, 4, recorded).verdict;
        assert_eq!(trend(4, (4, 4)), Verdict::Pass);
        assert_eq!(trend(2, (2, 4)), Verdict::Finding);
        assert_eq!(trend(3, (2, 4)), Verdict::Fail);
        assert_eq!(trend(4, (4, 5)), Verdict::Fail);
        let report =
            Report { checks: vec![check(1.0).at_most(1.0, ""), check(2.0).at_most(1.0, "")] };
        assert!(!report.passed());
        assert_eq!(report.count(Verdict::Fail), 1);
    }
}
