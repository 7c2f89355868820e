//! Plots of the efficiency error against the time, with one mark for each model and setting.

use bsm_report::{Curve, Figure, PlotAxis, Stroke};

use super::{Group, OneCore, SettingResult};

/// Returns the plots of the efficiency error. Two plots contain all points, solved one by one or as
/// a table; the other plots contain the points of one slip regime, solved one by one.
pub(super) fn figures(settings: &[SettingResult]) -> Vec<Figure> {
    let mut figures = vec![
        figure(settings, Group::All, "single", "points solved one by one", |times| {
            times.single.mean
        }),
        figure(settings, Group::All, "batch", "tables on one core", |times| times.batch),
    ];
    for group in Group::ALL.into_iter().filter(|group| *group != Group::All) {
        let key = group.name().replace(' ', "-");
        figures.push(figure(settings, group, &key, group.name(), |times| times.single.mean));
    }
    // The plot for a slip regime is removed if no point has this regime.
    figures.retain(|figure| !figure.curves.is_empty());
    figures
}

fn figure(
    settings: &[SettingResult],
    group: Group,
    key: &str,
    words: &str,
    time: fn(&OneCore) -> f64,
) -> Figure {
    let mut curves: Vec<Curve> = Vec::new();
    for result in settings {
        let (Some(times), Some(errors)) = (result.times.of(group), result.errors_of(group)) else {
            continue;
        };
        let Some(error) = errors.efficiency else { continue };
        // Settings that change the creep speed are left out, because their markers would coincide
        // with the markers of settings that change the accuracy. Errors of zero are left out,
        // because a logarithmic axis cannot show them.
        if result.setting.options.starts_with("--creep") || error.q99 == 0.0 {
            continue;
        }
        let name = result.setting.model.to_owned();
        let label = if errors.solved < 0.99 {
            format!("{name}, {:.0} % solved", 100.0 * errors.solved)
        } else {
            name
        };
        let place = curves.iter().position(|curve| curve.label.as_ref() == Some(&label));
        let place = place.unwrap_or_else(|| {
            let stroke =
                if curves.len().is_multiple_of(2) { Stroke::Circles } else { Stroke::Triangles };
            curves.push(Curve::new(label, curves.len(), stroke, Vec::new()));
            curves.len() - 1
        });
        let point = (1e-3 * time(times), error.q99);
        let value = result.setting.options.split_once(' ').map_or("", |(_, value)| value);
        let Curve { points, marks, .. } = &mut curves[place];
        let overlaps = points
            .iter()
            .zip(&*marks)
            .any(|(other, mark)| !mark.is_empty() && labels_overlap(point, *other));
        points.push(point);
        marks.push(if overlaps { "" } else { value }.to_owned());
    }
    Figure {
        key: format!("pareto-{key}"),
        title: format!("Error against time, {words}"),
        caption: "Settings on the left are faster, and settings at the bottom are more accurate. The numbers are the \
                  accuracy of traction and the tolerance of auto. The errors refer to the points that a model solves."
            .to_owned(),
        x: PlotAxis::log("time per point, us"),
        y: PlotAxis::log("efficiency error, 99 % quantile"),
        curves,
    }
}

/// Returns true if the labels of two points would overprint each other, which is the case if their
/// times differ by less than about 20 % and their errors by less than one decade.
fn labels_overlap(one: (f64, f64), other: (f64, f64)) -> bool {
    (one.0 / other.0).ln().abs() < 0.2 && (one.1 / other.1).log10().abs() < 1.0
}
