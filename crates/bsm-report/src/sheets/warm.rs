//! Figures of the warm steady states as functions of the speed: temperatures, and the preload with
//! its fold.

use bsm_case::{AxisReport, OutputName, WarmBranch, WarmPoint, output};
use bsm_design::{Bounds, least_preload};

use crate::{Curve, Figure, PlotAxis, Stroke};

/// Returns the stable points of a branch (up to its fold) or, if `stable` is false, the fold and
/// the unstable points beyond it.
fn part(branch: &WarmBranch, stable: bool, value: impl Fn(&WarmPoint) -> f64) -> Vec<(f64, f64)> {
    let points = branch.points.iter().filter(|point| point.stable == stable);
    // The stable and the unstable part of the branch meet at the fold.
    let fold = branch.fold().filter(|_| !stable);
    fold.into_iter().chain(points).map(|point| (point.speed_rpm, value(point))).collect()
}

/// Plots the warm preload of one or several axes against the speed. The line is solid up to the
/// fold and dashed beyond it; a circle marks the fold.
pub fn warm_preload(words: [&str; 3], branches: &[(impl AsRef<str>, &WarmBranch)]) -> Figure {
    let preload = |point: &WarmPoint| point.preload_N;
    let mut curves = Vec::new();
    let mut folds = Vec::new();
    for (color, (label, branch)) in branches.iter().enumerate() {
        curves.push(Curve::new(label.as_ref(), color, Stroke::Solid, part(branch, true, preload)));
        if let Some(fold) = branch.fold() {
            let beyond = Curve::new("", color, Stroke::Dashed, part(branch, false, preload));
            curves.push(Curve { label: None, ..beyond });
            folds.push((fold.speed_rpm, fold.preload_N));
        }
    }
    if !folds.is_empty() {
        curves.push(Curve::new(
            "fold: no steady state above this speed",
            6,
            Stroke::Circles,
            folds,
        ));
    }
    Figure::new(
        words,
        [PlotAxis::linear("speed of the screw, rpm"), PlotAxis::linear("warm preload, N")],
        curves,
    )
}

/// Returns a vertical dotted line at the requested speed. The line spans the range of the curves.
fn at_speed(branch: &WarmBranch, curves: &[Curve]) -> Curve {
    let values = curves.iter().flat_map(|curve| &curve.points).map(|(_, value)| *value);
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value| {
        (f64::min(low, value), f64::max(high, value))
    });
    let ends = [low, high].map(|value| (branch.speed_rpm, value));
    Curve::new("requested speed", 6, Stroke::Dotted, ends.into())
}

/// Returns figures of the temperatures and the preload of an axis against its speed, with the
/// uncertainty band at the requested speed.
pub fn warm_figures(report: &AxisReport, branch: &WarmBranch) -> Vec<Figure> {
    let caption = match branch.fold() {
        Some(fold) => format!(
            "Dashed lines show unstable states. Above {:.0} rpm, no steady state exists; the speed of this case is {:.0} rpm.",
            fold.speed_rpm, branch.speed_rpm
        ),
        None => format!("The speed of this case is {:.0} rpm.", branch.speed_rpm),
    };
    let bounds = |color: usize, name: OutputName| {
        let Bounds { min, max } = report.warm_bounds(name);
        let ends = [min, max].into_iter().flatten();
        let points = ends.map(|value| (branch.speed_rpm, value)).collect();
        Curve::new("uncertainty", color, Stroke::Triangles, points)
    };
    let nodes = [
        ("nut", output!(nut_temperature_C)),
        ("screw", output!(screw_temperature_C)),
        ("balls", output!(balls_temperature_C)),
    ];
    let mut curves = Vec::new();
    for (color, (name, _)) in nodes.into_iter().enumerate() {
        let value = |point: &WarmPoint| point.temperatures_C[color];
        curves.push(Curve::new(name, color, Stroke::Solid, part(branch, true, value)));
        if branch.fold().is_some() {
            let beyond = Curve::new("", color, Stroke::Dashed, part(branch, false, value));
            curves.push(Curve { label: None, ..beyond });
        }
    }
    for (color, (_, temperature)) in nodes.into_iter().enumerate() {
        let bounds = bounds(color, temperature);
        curves.push(Curve { label: bounds.label.filter(|_| color == 0), ..bounds });
    }
    curves.push(at_speed(branch, &curves));
    let temperatures = Figure::new(
        ["warm-temperatures", "Steady-state temperatures against speed", &caption],
        [PlotAxis::linear("speed of the screw, rpm"), PlotAxis::linear("temperature, C")],
        curves,
    );
    let words = ["warm-preload", "Warm preload against speed", &caption];
    let mut preload = warm_preload(words, &[("preload", branch)]);
    let fastest = branch.points.iter().map(|point| point.speed_rpm).fold(0.0, f64::max);
    let level = |label: &str, color: usize, value: Option<f64>| {
        let value = value.filter(|value| *value > 0.0)?;
        Some(Curve::new(label, color, Stroke::Dotted, vec![(0.0, value), (fastest, value)]))
    };
    let opens = report.number(output!(largest_load_N)).map(least_preload);
    preload.curves.push(bounds(0, output!(warm_preload_N)));
    preload.curves.extend(level("cold preload", 5, branch.cold_preload_N));
    preload.curves.extend(level("a nut unloads below", 4, opens));
    preload.curves.push(at_speed(branch, &preload.curves));
    vec![temperatures, preload]
}
