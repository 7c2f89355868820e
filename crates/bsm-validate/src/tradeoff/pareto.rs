//! Error against time, one mark for each model and dial.

use super::{Group, Measured};
use crate::figure::{Axis, Curve, Figure, Stroke};

/// Errors below this are drawn as this: no measurement tells them from none.
const FLOOR: f64 = 1e-9;

/// One by one and in batches over all points, then one by one for each motion of the balls.
pub(super) fn figures(dials: &[Measured]) -> Vec<Figure> {
    let single = |group: Group| {
        move |dial: &Measured| dial.times.single.iter().find(|(other, _)| *other == group)?.1
    };
    let mut figures = vec![
        figure(dials, Group::All, "single", "one point after the other", &single(Group::All)),
        figure(dials, Group::All, "batch", "batches on one core", &|dial| Some(dial.times.batch)),
    ];
    for group in Group::ALL.into_iter().filter(|group| *group != Group::All) {
        let words = format!("where the ball {}", group.name());
        figures.push(figure(dials, group, &group.name().replace(' ', "-"), &words, &single(group)));
    }
    // Not every table has points of every motion.
    figures.retain(|figure| !figure.curves.is_empty());
    figures
}

fn figure(
    dials: &[Measured],
    group: Group,
    key: &str,
    words: &str,
    time: &dyn Fn(&Measured) -> Option<f64>,
) -> Figure {
    let mut curves: Vec<Curve> = Vec::new();
    for dial in dials {
        let error = dial.errors.iter().find(|e| e.group == group).and_then(|e| e.efficiency);
        let (Some(error), Some(ns)) = (error, time(dial)) else { continue };
        let point = (ns, error.q99.max(FLOOR));
        let curve = curves.iter_mut().find(|c| c.label.as_deref() == Some(dial.dial.model));
        match curve {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                label: Some(dial.dial.model.to_owned()),
                color: curves.len(),
                stroke: if curves.len().is_multiple_of(2) {
                    Stroke::Circles
                } else {
                    Stroke::Triangles
                },
                points: vec![point],
            }),
        }
    }
    Figure {
        key: format!("pareto-{key}"),
        title: format!("Error against time, {words}"),
        caption:
            "A mark for each model and dial: left is faster, down is more exact. The dials of \
                  traction are quadrature and creep speed, those of auto its tolerance."
                .to_owned(),
        x: Axis::log("time of a point, ns"),
        y: Axis::log("error of the efficiency, 99 %"),
        curves,
    }
}
