//! Compares published trends with calculated curves.

use std::collections::BTreeSet;

use bsm_report::sheets::{NamedCurve, Study};
use bsm_report::{format_number, format_short};
use serde::Deserialize;

use crate::published::File;
use crate::{Check, ValidateError};

/// A row in a table of published trends.
#[derive(Deserialize)]
struct Row {
    /// Name of the trend, unique in the table.
    trend: String,
    /// Label of the studies to which the trend applies.
    study: String,
    statement: String,
    /// Names of the curves, separated by spaces. A name of the form `a/b` refers to curve `a`
    /// divided by curve `b`.
    curves: String,
    claim: Claim,
    /// Value of x above which the curve is claimed to decrease more slowly. Required for the claim
    /// `flattens`.
    knee: Option<f64>,
    /// Lower and upper limit of the range of x in which the trend is claimed.
    from: Option<f64>,
    to: Option<f64>,
    /// Number of curves that followed the trend when the reference result was recorded, and total
    /// number of curves.
    held: usize,
    of: usize,
}

/// Behavior that a paper claims for a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Claim {
    /// The curve increases.
    Rises,
    /// The curve decreases.
    Falls,
    /// The curve decreases, and its slope before the knee is at least twice its slope after the
    /// knee.
    Flattens,
    /// The ratio of the first curve to the second curve is above one.
    Exceeds,
    /// The first curve changes more than the second curve.
    Spreads,
}

/// Behavior of a calculated curve.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// The curve increases overall and never decreases; flat sections are allowed.
    Rises,
    /// The curve decreases overall and never increases; flat sections are allowed.
    Falls,
    /// The curve is constant.
    Constant,
    /// The curve has its first extremum at the given x.
    Turns(f64),
}

impl Shape {
    /// Determines the behavior of a curve whose points are in ascending order of x. Changes smaller
    /// than `rounding` are ignored.
    fn of(points: &[(f64, f64)], rounding: f64) -> Self {
        let mut shape = Self::Constant;
        let mut reached = points.first().map_or(0.0, |p| p.1);
        let mut at = f64::NAN;
        for &(x, y) in points {
            if (y - reached).abs() <= rounding {
                continue;
            }
            let way = if y > reached { Self::Rises } else { Self::Falls };
            if shape == Self::Constant {
                shape = way;
            } else if shape != way {
                return Self::Turns(at);
            }
            (reached, at) = (y, x);
        }
        shape
    }

    /// Words for all behaviors, in the order in which a check counts them.
    const WORDS: [&str; 4] = ["rising", "falling", "constant", "turning"];

    fn word(self) -> &'static str {
        let place = match self {
            Self::Rises => 0,
            Self::Falls => 1,
            Self::Constant => 2,
            Self::Turns(_) => 3,
        };
        Self::WORDS[place]
    }
}

/// Returns the mean slope of a curve over a range of x, or NaN if the range contains fewer than two
/// points.
fn slope(points: &[(f64, f64)], within: impl Fn(f64) -> bool) -> f64 {
    let mut within = points.iter().filter(|(x, _)| within(*x));
    let (first, last) = (within.next(), within.last());
    first.zip(last).map_or(f64::NAN, |(a, b)| (b.1 - a.1) / (b.0 - a.0))
}

/// Returns the difference between the largest and the smallest y of a curve.
fn range(points: &[(f64, f64)]) -> f64 {
    let values = || points.iter().map(|(_, y)| *y).filter(|y| y.is_finite());
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

/// Behavior of a calculated curve, and whether it agrees with a claim.
struct Trend {
    curve: String,
    shape: Shape,
    /// True if the curve behaves as claimed over the whole range.
    holds: bool,
    first: (f64, f64),
    last: (f64, f64),
}

impl Trend {
    /// Describes the behavior of the curve as text.
    fn describe(&self, setting: &str) -> String {
        let Self { curve, first, last, .. } = self;
        let holds = if self.holds { "holds" } else { "does not hold" };
        let (from, to) = (format_short(first.0), format_short(last.0));
        let does = match self.shape {
            Shape::Rises => format!("rises from {from} to {to}"),
            Shape::Falls => format!("falls from {from} to {to}"),
            Shape::Constant => format!("is constant from {from} to {to}"),
            Shape::Turns(at) => {
                let way = if last.1 > first.1 { "higher" } else { "lower" };
                format!("has an extremum at {} and ends {way} than it begins", format_short(at))
            }
        };
        format!(
            "{curve}{setting}: {holds}, {} to {}, {does}",
            format_number(first.1),
            format_number(last.1)
        )
    }
}

fn named<'a>(study: &'a Study, name: &'a str) -> impl Iterator<Item = &'a NamedCurve> {
    study.named_curves.iter().filter(move |curve| curve.name == name)
}

/// Sweeps that are compared with published trends.
pub(crate) struct LabeledStudy {
    /// Label to which the column `study` of a trend table refers. Several studies may have the same
    /// label.
    pub label: &'static str,
    /// Text that distinguishes studies with the same label. It starts with a space.
    pub setting: &'static str,
    /// Calculated curves.
    pub study: Study,
}

impl Row {
    /// Compares the claim with all curves of a study to which this row applies.
    ///
    /// # Errors
    ///
    /// Returns the reason if two curves of a ratio do not belong together, or if the knee of the
    /// claim `flattens` is missing.
    fn trends(&self, study: &Study) -> Result<Vec<Trend>, String> {
        let mut trends = Vec::new();
        for name in self.curves.split(' ') {
            match name.split_once('/') {
                None => {
                    for curve in named(study, name) {
                        trends.extend(self.trend(curve)?);
                    }
                }
                Some((above, below)) => {
                    let [above, below]: [Vec<_>; 2] =
                        [above, below].map(|name| named(study, name).collect());
                    if above.len() != below.len() {
                        let (above, below) = (above.len(), below.len());
                        return Err(format!(
                            "`{name}` divides {above} curves by {below} curves, but their numbers must be equal"
                        ));
                    }
                    for (above, below) in above.into_iter().zip(below) {
                        trends.extend(self.trend(&self.ratio(above, below)?)?);
                    }
                }
            }
        }
        Ok(trends)
    }

    /// Returns the ratio of two curves. If the claim is about changes of the curves, returns the
    /// change of the first curve divided by the change of the second curve.
    ///
    /// # Errors
    ///
    /// Returns the reason if the curves have different numbers of points.
    fn ratio(&self, above: &NamedCurve, below: &NamedCurve) -> Result<NamedCurve, String> {
        let (mut label, mut points) =
            (format!("{} divided by {}", above.label, below.label), Vec::new());
        if self.claim == Claim::Spreads {
            label = format!("change of {label}");
            let middle = above.points[above.points.len() / 2].0;
            points.push((middle, range(&above.points) / range(&below.points)));
        } else if above.points.len() == below.points.len() {
            let both = above.points.iter().zip(&below.points);
            points.extend(both.map(|(above, below)| (above.0, above.1 / below.1)));
        } else {
            return Err(format!(
                "curve `{}` has {} points and curve `{}` has {} points, but their ratio requires equal numbers of points",
                above.name,
                above.points.len(),
                below.name,
                below.points.len()
            ));
        }
        Ok(NamedCurve { name: String::new(), label, points, rounding: 0.0 })
    }

    /// Compares a curve with the claim in the claimed range of x. Points whose y is NaN or infinite
    /// are left out. Returns `None` if no point is left.
    ///
    /// # Errors
    ///
    /// Returns the reason if the knee of the claim `flattens` is missing.
    fn trend(&self, curve: &NamedCurve) -> Result<Option<Trend>, String> {
        let range = self.from.unwrap_or(f64::NEG_INFINITY)..=self.to.unwrap_or(f64::INFINITY);
        let rounding = curve.rounding;
        let clean = |(x, y): (f64, f64)| (x, if y.abs() <= rounding { 0.0 } else { y });
        let points = curve.points.iter().copied();
        let points: Vec<_> =
            points.filter(|(x, y)| y.is_finite() && range.contains(x)).map(clean).collect();
        let shape = Shape::of(&points, rounding);
        let holds = match self.claim {
            Claim::Rises => shape == Shape::Rises,
            Claim::Falls => shape == Shape::Falls,
            Claim::Flattens => {
                let knee = self.knee.ok_or("the claim `flattens` requires a value of `knee`")?;
                shape == Shape::Falls
                    && slope(&points, |x| x <= knee) <= 2.0 * slope(&points, |x| x >= knee)
            }
            Claim::Exceeds | Claim::Spreads => points.iter().all(|(_, y)| *y > 1.0),
        };
        let ends = points.first().zip(points.last());
        Ok(ends.map(|(first, last)| {
            let curve = curve.label.clone();
            Trend { curve, shape, holds, first: *first, last: *last }
        }))
    }
}

/// Returns one check for each trend in a table. If a study contains a curve that is not in the
/// table, an additional check fails.
///
/// # Errors
///
/// Returns [`ValidateError`] if the table cannot be read, if a row names an unknown study, or if the
/// curves or the knee of a row are invalid.
pub(crate) fn checks(
    source: &str,
    key: &str,
    table: &File,
    studies: &[LabeledStudy],
) -> Result<Vec<Check>, ValidateError> {
    let check = |row: Row| {
        let error =
            |why: String| ValidateError::of(format!("{}: {}", table.name(), row.trend), why);
        if studies.iter().all(|study| study.label != row.study) {
            return Err(error(format!("there is no study `{}`", row.study)));
        }
        let mut trends = Vec::new();
        for LabeledStudy { setting, study, .. } in
            studies.iter().filter(|study| study.label == row.study)
        {
            let of_study = row.trends(study).map_err(error)?;
            trends.extend(of_study.into_iter().map(|trend| (*setting, trend)));
        }
        let held = trends.iter().filter(|(_, trend)| trend.holds).count();
        let count = |word: &&str| trends.iter().filter(|(_, t)| t.shape.word() == *word).count();
        let counted = Shape::WORDS.iter().map(|word| (count(word), word)).filter(|(n, _)| *n > 0);
        let counted: Vec<_> = counted.map(|(n, word)| format!("{n} {word}")).collect();
        let details: Vec<_> = trends.iter().map(|(setting, t)| t.describe(setting)).collect();
        let check = Check::new(&format!("{key}/{}", row.trend), source, row.statement)
            .note(counted.join(", "))
            .follows(held, trends.len(), (row.held, row.of));
        Ok(Check { details: details.join("; "), ..check })
    };
    let rows = table.rows::<Row>()?;
    let mut unknown = BTreeSet::new();
    for LabeledStudy { label, study, .. } in studies {
        let of_label = rows.iter().filter(|row| row.study == *label);
        let known: BTreeSet<_> = of_label.flat_map(|row| row.curves.split([' ', '/'])).collect();
        let names = study.named_curves.iter().map(|curve| curve.name.as_str());
        let left = names.filter(|name| !known.contains(name));
        unknown.extend(left.map(|name| format!("{key}/{label}-{name}")));
    }
    let unrecorded = |key: &String| {
        Check::new(key, source, "the table does not contain this curve").follows(1, 1, (0, 0))
    };
    let mut checks = rows.into_iter().map(check).collect::<Result<Vec<_>, _>>()?;
    checks.extend(unknown.iter().map(unrecorded));
    Ok(checks)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(values: &[f64]) -> Vec<(f64, f64)> {
        (0..).map(f64::from).zip(values.iter().copied()).collect()
    }

    #[test]
    fn curves_that_rise_or_fall_or_have_an_extremum_are_recognized() {
        let shape = |values: &[f64]| Shape::of(&points(values), 1e-9);
        assert_eq!(shape(&[1.0, 2.0, 2.0, 3.0]), Shape::Rises);
        assert_eq!(shape(&[3.0, 2.0, 2.0]), Shape::Falls);
        assert_eq!(shape(&[1.0, 1.0 + 1e-12, 1.0 - 1e-12]), Shape::Constant);
        assert_eq!(shape(&[1.0, 2.0, 3.0, 2.5, 4.0]), Shape::Turns(2.0));
        // A rounding error must not count as an extremum, but many small changes in the same
        // direction must count.
        assert_eq!(shape(&[1.0, 2.0, 2.0 - 1e-10, 3.0]), Shape::Rises);
        let slow: Vec<_> = (0..30).map(|i| f64::from(i) * 5e-10).collect();
        assert_eq!(shape(&slow), Shape::Rises);
    }

    /// A single point that violates a trend must make the trend fail. Missing points, and points
    /// outside the range, are ignored.
    #[test]
    fn a_trend_fails_if_one_point_violates_it() {
        let curve = |name: &str, values: &[f64]| NamedCurve {
            name: name.to_owned(),
            label: String::new(),
            points: points(values),
            rounding: 0.0,
        };
        let trend = |claim: &str, values: &[f64]| {
            let header = "trend,study,statement,curves,claim,knee,from,to,held,of";
            let text = format!("{header}\na,s,b,c{claim},1,1\n");
            let row = csv::Reader::from_reader(text.as_bytes()).into_deserialize().next();
            let row: Row = row.expect("a row").expect("as the table is");
            let curves = vec![curve("c", values), curve("one", &[1.0, 2.0, 2.5])];
            let found = row.trends(&Study { figures: Vec::new(), named_curves: curves });
            found.map(|found| found.first().map(|trend| trend.holds))
        };
        let missing_knee = trend(",flattens,,,", &[6.0, 4.0, 2.0]).expect_err("no knee");
        assert!(missing_knee.contains("knee"), "{missing_knee}");
        let too_short = trend("/one,exceeds,,,", &[1.5, 3.0]).expect_err("2 and 3 points");
        assert!(too_short.contains("equal numbers of points"), "{too_short}");
        let unpaired = trend("/none,exceeds,,,", &[1.5]).expect_err("no second curve");
        assert!(unpaired.contains("divides 1 curves by 0 curves"), "{unpaired}");
        let trend = |claim: &str, values: &[f64]| trend(claim, values).expect("a valid row");
        assert_eq!(trend(",falls,,,", &[3.0, f64::NAN, 1.0]), Some(true));
        assert_eq!(trend(",rises,,,", &[3.0, 1.0]), Some(false));
        assert_eq!(trend(",falls,,,", &[3.0, 1.0, 2.0]), Some(false));
        assert_eq!(trend(",falls,,,1", &[3.0, 1.0, 2.0]), Some(true));
        assert_eq!(trend(",rises,,1,", &[3.0, 1.0, 2.0]), Some(true));
        assert_eq!(trend(",falls,,,", &[1.0, 1.0]), Some(false));
        assert_eq!(trend(",falls,,,", &[f64::NAN]), None);
        // The mean slopes before and after the third point are −2 and −0.5 for the first curve. For
        // the second curve, they are −1 and −1.
        assert_eq!(trend(",flattens,2,,", &[6.0, 4.0, 2.0, 1.5, 1.0]), Some(true));
        assert_eq!(trend(",flattens,2,,", &[6.0, 5.0, 4.0, 3.0, 2.0]), Some(false));
        assert_eq!(trend(",flattens,2,,", &[1.0, 2.0, 3.0, 2.0]), Some(false));
        assert_eq!(trend(",flattens,9,,", &[6.0, 4.0, 3.0]), Some(false));
        assert_eq!(trend("/one,exceeds,,,", &[1.5, 3.0, 2.6]), Some(true));
        assert_eq!(trend("/one,exceeds,,,", &[1.5, 1.9, 5.0]), Some(false));
        assert_eq!(trend("/one,spreads,,,", &[1.0, 2.0, 3.0]), Some(true));
        assert_eq!(trend("/one,spreads,,,", &[1.0, 2.0, 1.5]), Some(false));
    }
}
