//! Sweeps for analyses of the ball motion: figures, and curves from which published trends are
//! checked.

use bsm_case::{AnalysisKind, Case, MotionAnswer, Numbers, OutputName, Settings};
use bsm_dyn::ModelWorkspace;

use crate::{Curve, Figure, ReportError, Stroke};

/// A named curve of a sweep, with all its points in ascending order of x.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCurve {
    /// Name of the curve. Curves of the same quantity for different loads, speeds or settings have
    /// the same name.
    pub name: String,
    /// Text that distinguishes the curve from other curves with the same name.
    pub label: String,
    /// Points of the curve. Points whose y value is NaN or infinite are gaps.
    pub points: Vec<(f64, f64)>,
    /// Rounding error of the y values of the curve.
    pub rounding: f64,
}

/// Figures of an analysis, and its named curves.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Study {
    /// The figures of the analysis.
    pub figures: Vec<Figure>,
    /// Named curves that are checked for published trends.
    pub named_curves: Vec<NamedCurve>,
}

impl Study {
    /// Adds a named curve if it has any points.
    pub(super) fn add_curve(
        &mut self,
        name: String,
        label: String,
        points: &[(f64, f64)],
        rounding: f64,
    ) {
        if points.iter().any(|(_, y)| y.is_finite()) {
            self.named_curves.push(NamedCurve { name, label, points: points.to_vec(), rounding });
        }
    }
}

/// Results of the ball motion analyses for each x value of a sweep. Points without a solution have
/// no results.
pub(super) type Rows = Vec<(f64, Vec<Numbers>)>;

/// Runs the jamming and slip analyses of several cases. Each case is given together with its x
/// value.
pub(super) fn analyzed(
    cases: Vec<(f64, Case)>,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Rows, ReportError> {
    let mut row = |(x, case): (f64, Case)| {
        let moving = MotionAnswer::of(&case, settings, work)?;
        // A point without a solution or without contact results leaves a gap.
        let kinds = [AnalysisKind::Jam, AnalysisKind::Slip];
        let numbers =
            kinds.map(|kind| kind.numbers(&case, settings, Some(&moving), |_| true, work));
        Ok((x, numbers.into_iter().flatten().collect()))
    };
    cases.into_iter().map(&mut row).collect()
}

/// Returns the absolute values of a quantity over a sweep. The sign is ignored, because it only
/// indicates a direction.
pub(super) fn sizes(rows: &Rows, name: OutputName) -> Vec<(f64, f64)> {
    let read = |analyses: &Vec<Numbers>| {
        analyses.iter().find_map(|numbers| numbers.number(name)).map_or(f64::NAN, f64::abs)
    };
    rows.iter().map(|(x, analyses)| (*x, read(analyses))).collect()
}

/// Returns a curve of the points whose y value is above `least`; all other points become gaps.
/// Returns `None` if no points are left.
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
