//! Counts the outcomes of a test campaign, and stores the largest errors and the anomalies.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;
use std::fs;
use std::path::Path;
use std::time::Duration;

use bsm_case::{Case, ModelChoice};

use crate::answer::{Answer, Severity, inertia};

/// Maximum number of cases that are written for each kind of anomaly.
const EACH: usize = 5;

/// Upper limits of the inertia-ratio ranges for which outcomes are counted. The inertia ratio is
/// `$m r_m W^2/F_a$`. Points above the largest limit form a last range.
const BANDS: [f64; 3] = [1e-6, 1e-2, 3.0];

/// All points with the same kind of outcome. If the outcome is an anomaly, the cases of the first
/// points are stored.
#[derive(Default)]
struct Kind {
    /// Number of points in each range of the inertia ratio.
    counts: [usize; BANDS.len() + 1],
    cases: Vec<(usize, Case)>,
}

/// Results of a test campaign.
#[derive(Default)]
pub(crate) struct Tally {
    points: usize,
    kinds: BTreeMap<(Severity, String), Kind>,
    /// Numbers of converged points with further solutions, without further solutions, and without a
    /// search for further solutions.
    others: [usize; 3],
    residual: (f64, usize),
    balance: (f64, usize),
    slowest: (Duration, usize),
}

impl Tally {
    pub(crate) fn add(&mut self, number: usize, case: &Case, answer: &Answer) {
        self.points += 1;
        let kind = self.kinds.entry((answer.severity, answer.kind.clone())).or_default();
        let inertia = inertia(case);
        kind.counts[BANDS.iter().filter(|end| inertia >= **end).count()] += 1;
        if answer.severity >= Severity::NotConverged && kind.cases.len() < EACH {
            let description = Some(format!("extremes, point {number}: {}", answer.words));
            kind.cases.push((number, Case { description, ..case.clone() }));
        }
        if answer.severity == Severity::Converged {
            self.others[answer.others.map_or(2, |others| usize::from(others == 0))] += 1;
        }
        self.worst((answer.residual, number), (answer.balance, number), (answer.time, number));
    }

    fn worst(&mut self, residual: (f64, usize), balance: (f64, usize), slow: (Duration, usize)) {
        if residual.0 > self.residual.0 {
            self.residual = residual;
        }
        if balance.0 > self.balance.0 {
            self.balance = balance;
        }
        if slow.0 > self.slowest.0 {
            self.slowest = slow;
        }
    }

    /// Adds the results of another campaign. The points of `self` come before the points of
    /// `other`.
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.points += other.points;
        for (place, kind) in other.kinds {
            let mine = self.kinds.entry(place).or_default();
            for (count, more) in mine.counts.iter_mut().zip(kind.counts) {
                *count += more;
            }
            mine.cases.extend(kind.cases);
            mine.cases.truncate(EACH);
        }
        for (count, more) in self.others.iter_mut().zip(other.others) {
            *count += more;
        }
        self.worst(other.residual, other.balance, other.slowest);
        self
    }

    /// Returns true if no result is wrong and no point is invalid.
    pub(crate) fn is_sound(&self) -> bool {
        self.kinds
            .keys()
            .all(|(severity, _)| !matches!(severity, Severity::Wrong | Severity::Invalid))
    }

    /// Writes a case file for each anomaly that was stored.
    pub(crate) fn write_anomalies(
        &self,
        folder: &Path,
        model: ModelChoice,
    ) -> Result<(), Box<dyn Error>> {
        for ((_, kind), Kind { cases, .. }) in &self.kinds {
            for (number, case) in cases {
                let file = format!("{}-{kind}-{number}.json", model.name()).replace(' ', "-");
                let text = serde_json::to_string_pretty(&case.to_json())?;
                fs::write(folder.join(file), text + "\n")?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Tally {
    /// Writes a Markdown table of the outcomes, followed by the largest errors.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, middle, high] = BANDS;
        let points = self.points;
        writeln!(
            f,
            "| {points} points | share | all | inertia ratio < {low:e} | < {middle} | < {high} | more |"
        )?;
        writeln!(f, "|---|--:|--:|--:|--:|--:|--:|")?;
        for ((_, name), Kind { counts, .. }) in &self.kinds {
            let all: usize = counts.iter().sum();
            #[expect(clippy::cast_precision_loss, reason = "counts")]
            let share = 100.0 * all as f64 / points as f64;
            let [one, two, three, four] = counts;
            writeln!(f, "| {name} | {share:.4} % | {all} | {one} | {two} | {three} | {four} |")?;
        }
        let [several, none, unknown] = self.others;
        writeln!(
            f,
            "\nother solutions: {several} points have some, {none} points have none, {unknown} points are undecided"
        )?;
        let ((residual, r), (balance, b), (slowest, s)) =
            (self.residual, self.balance, self.slowest);
        let slowest = 1e3 * slowest.as_secs_f64();
        write!(
            f,
            "\nworst residual {residual:.1e} (point {r}), worst power balance {balance:.1e} (point {b}), \
             slowest {slowest:.3} ms (point {s})"
        )
    }
}
