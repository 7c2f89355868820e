//! Checks and their results.

use bsm_case::{Answer, Content};
use bsm_report::PROGRAM;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

/// Result of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The claim holds.
    Pass,
    /// The claim does not hold.
    Fail,
    /// A number without a reference value, or a published trend that does not hold.
    Finding,
}

/// One published statement or number, and our result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Check {
    /// Permanent name, `<source>/<what>`.
    pub key: String,
    /// Paper and equation.
    pub source: String,
    /// The claim, as text.
    pub claim: String,
    /// The claimed number, if it is one.
    pub claimed: Option<f64>,
    /// The measured number.
    #[schemars(with = "Option<f64>")]
    pub measured: f64,
    /// Unit of both numbers.
    pub unit: String,
    /// The condition for `measured`, with the reason for the tolerance.
    pub criterion: String,
    /// Place where the measured number occurs, or other data that belong to it.
    pub note: String,
    /// Numbers behind the result, for a page that has room for them.
    pub details: String,
    /// The outcome.
    pub verdict: Verdict,
}

impl Check {
    /// Creates a check with the given name. It is a finding until a criterion is set.
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

    /// Sets the number that we measured.
    pub(crate) fn measured(mut self, value: f64, unit: &str) -> Self {
        self.measured = value;
        unit.clone_into(&mut self.unit);
        self
    }

    /// Sets a note.
    pub(crate) fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Makes the check pass if the measured number is at most `limit`, because of `reason`.
    pub(crate) fn at_most(self, limit: f64, reason: &str) -> Self {
        let holds = self.measured <= limit;
        self.judge(holds, format!("at most {limit:.3e}: {reason}"))
    }

    /// Makes the check pass if the measured number is at least `limit`, because of `reason`.
    pub(crate) fn at_least(self, limit: f64, reason: &str) -> Self {
        let holds = self.measured >= limit;
        self.judge(holds, format!("at least {limit:.3e}: {reason}"))
    }

    /// Makes the check pass if the measured number is within `tolerance` of the claimed number.
    pub(crate) fn equals(mut self, claimed: f64, tolerance: f64, reason: &str) -> Self {
        let holds = (self.measured - claimed).abs() <= tolerance;
        self.claimed = Some(claimed);
        self.judge(holds, format!("within {tolerance:.3e} of the claim: {reason}"))
    }

    /// Makes the check pass if all of `curves` follow a published trend. If fewer curves follow the
    /// trend, the check is a finding as long as their number equals the recorded number. Otherwise
    /// the results have changed, and the check fails.
    pub(crate) fn follows(mut self, held: usize, curves: usize, recorded: (usize, usize)) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a few curves")]
        let [measured, claimed] = [held, curves].map(|n| n as f64);
        (self.measured, self.claimed) = (measured, Some(claimed));
        "curves".clone_into(&mut self.unit);
        self.criterion = format!("{} of {}, as recorded", recorded.0, recorded.1);
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

/// All checks of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The checks in the order in which they ran.
    pub checks: Vec<Check>,
}

impl Report {
    /// Returns the number of checks with this result.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|c| c.verdict == verdict).count()
    }

    /// Returns the answer of the program, which fails if a check fails.
    pub fn answer(&self) -> Answer {
        Answer { fails: !self.passed(), ..Answer::default() }
            .with("", Content::Json(self.to_json()))
    }

    /// Returns the JSON object of the checks, with the program that made them.
    pub fn to_json(&self) -> Value {
        json!({ "program": PROGRAM, "passed": self.passed(), "checks": self.checks })
    }

    /// Returns true if no check failed.
    pub fn passed(&self) -> bool {
        self.count(Verdict::Fail) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A perturbed number changes the verdict, and NaN never passes.
    #[test]
    fn checks_fail_for_wrong_numbers_and_nan() {
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
