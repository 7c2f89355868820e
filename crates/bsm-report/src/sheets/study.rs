//! Sweeps of the analyses of a motion: figures, and the curves that published trends are compared
//! with.

use bsm_case::{AnalysisKind, Case, MotionAnswer, Numbers, OutputName, Settings};
use bsm_dyn::ModelWorkspace;

use crate::{Curve, Figure, ReportError, Stroke};

/// A named curve of a sweep, with all its points in the order of x.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Name of the curve. Curves for other loads, speeds and settings have the same name.
    pub name: String,
    /// Text that distinguishes the curve from other curves with the same name.
    pub label: String,
    /// The points. A value of y that is not finite is a gap.
    pub points: Vec<(f64, f64)>,
    /// Rounding error of the curve.
    pub rounding: f64,
}

/// Figures of an analysis, and the curves that have a name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Study {
    /// The figures.
    pub figures: Vec<Figure>,
    /// The curves.
    pub courses: Vec<Course>,
}

impl Study {
    /// Adds a curve if it has points.
    pub(super) fn course(
        &mut self,
        name: String,
        label: String,
        points: &[(f64, f64)],
        rounding: f64,
    ) {
        if points.iter().any(|(_, y)| y.is_finite()) {
            self.courses.push(Course { name, label, points: points.to_vec(), rounding });
        }
    }
}

/// Results of the analyses of a motion over x. Points without a solution have no results.
pub(super) type Rows = Vec<(f64, Vec<Numbers>)>;

/// Returns the analyses of cases with their positions on the x axis.
pub(super) fn analyzed(
    cases: Vec<(f64, Case)>,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Rows, ReportError> {
    let mut row = |(x, case): (f64, Case)| {
        let moving = MotionAnswer::of(&case, settings, work)?;
        // A point without a solution or without a contact state is a gap.
        let kinds = [AnalysisKind::Jam, AnalysisKind::Slip];
        let numbers =
            kinds.map(|kind| kind.numbers(&case, settings, Some(&moving), |_| true, work));
        Ok((x, numbers.into_iter().flatten().collect()))
    };
    cases.into_iter().map(&mut row).collect()
}

/// Returns a quantity of the analyses of a sweep, or its absolute value if the sign is a direction.
pub(super) fn sizes(rows: &Rows, name: OutputName) -> Vec<(f64, f64)> {
    let read = |analyses: &Vec<Numbers>| {
        analyses.iter().find_map(|numbers| numbers.number(name)).map_or(f64::NAN, f64::abs)
    };
    rows.iter().map(|(x, analyses)| (*x, read(analyses))).collect()
}

/// Returns a curve of the points above `least`, with gaps for other points. Returns `None` if the
/// curve has no points.
pub(super) fn line(
    label: &str,
    color: usize,
    stroke: Stroke,
    points: Vec<(f64, f64)>,
    least: f64,
) -> Option<Curve> {
    let gap = |(x, y): (f64, f64)| (x, if y > least { y } else { f64::NAN });
    let points: Vec<_> = points.into_iter().map(gap).collect();
    points.iter().any(|(_, y)| y.is_finite()).then(|| Curve::new(label, color, stroke, points))
}
