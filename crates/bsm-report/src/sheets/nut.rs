//! Figures of the load sharing and the displacement of a nut.

use bsm_case::{Columns, NutReport, output};

use crate::{Curve, Figure, PlotAxis, Stroke};

/// Load classes in the figure of the developed nut, as fractions of the largest load.
const CLASSES: [(f64, f64, &str); 4] = [
    (0.75, 1.0, "above 3/4 of the largest load"),
    (0.5, 0.75, "1/2 to 3/4"),
    (0.25, 0.5, "1/4 to 1/2"),
    (0.0, 0.25, "below 1/4"),
];

/// Required ball gap below which all balls are considered equal \[mm\]. With equal balls, the
/// calculated ball advance is only a rounding error, far below this limit of one nanometer.
const NO_GAP: f64 = 1e-6;

/// Caption for quantities that exist only at loaded flanks.
const TOUCHED: &str =
    "Each marker represents a ball; balls that do not touch the flank have no marker.";

/// Returns the figures of a nut: loads and contact angles along the helix, the developed nut, and
/// displacement and preload as functions of the axial load.
pub fn nut_figures(report: &NutReport) -> Vec<Figure> {
    let balls = report.balls();
    let curve = report.curve();
    let mut figures = vec![
        along(
            &balls,
            ["nut-loads", "Loads of the balls along the helix", TOUCHED],
            PlotAxis::linear("normal load at the nut, N"),
            &[("nut_plus_N", "flank +"), ("nut_minus_N", "flank -")],
        ),
        developed(&balls),
        along(
            &balls,
            ["nut-contact-angles", "Contact angles along the helix", TOUCHED],
            PlotAxis::linear("contact angle at the nut, deg"),
            &[("nut_plus_deg", "flank +"), ("nut_minus_deg", "flank -")],
        ),
        over_load(
            &curve,
            ("nut-displacement", "Displacement of the nut under its load"),
            PlotAxis::linear("axial displacement, um"),
            "nut_displacement_um",
            None,
        ),
    ];
    if report.number(output!(preload_left_N)).is_some() {
        let limit = report.number(output!(limit_load_N)).map(|load| (load, 0.0));
        figures.push(over_load(
            &curve,
            ("nut-preload", "Remaining preload under load"),
            PlotAxis::linear("remaining preload, N"),
            "preload_left_N",
            limit,
        ));
    }
    if report.number(output!(needed_gap_mm)).is_some_and(|gap| gap > NO_GAP) {
        figures.extend(train(&balls));
    }
    figures
}

/// Returns the figure of the ball advance and, if a ball gap is given, the figures of the ball
/// speeds and the push forces.
fn train(balls: &Columns) -> Vec<Figure> {
    let figures = [
        along(
            balls,
            [
                "nut-ball-advance",
                "Ball advance along the helix",
                "Advance of a free ball relative to a cage that turns uniformly.",
            ],
            PlotAxis::linear("advance, mm"),
            &[("advance_mm", "ball advance")],
        ),
        speeds(balls),
        along(
            balls,
            [
                "nut-ball-pushes",
                "Forces between the balls along the helix",
                "Balls without a push force have no marker.",
            ],
            PlotAxis::linear("force, N"),
            &[
                ("front_push_N", "force of the ball in front"),
                ("back_push_N", "force of the ball behind"),
            ],
        ),
    ];
    figures.into_iter().filter(|figure| !figure.curves.is_empty()).collect()
}

/// Plots the free and actual speeds of the balls, divided by the mean free speed. Balls that touch
/// each other are connected by a line.
fn speeds(balls: &Columns) -> Figure {
    let at = |row: &Vec<f64>, name| balls.cell(row, name);
    let free: Vec<_> =
        balls.rows.iter().map(|row| at(row, "free_rate")).filter(|rate| rate.is_finite()).collect();
    #[expect(clippy::cast_precision_loss, reason = "balls of a nut")]
    let mean = free.iter().sum::<f64>() / free.len() as f64;
    let curve = |name, (label, color, stroke): (&str, usize, Stroke), shown: fn(f64) -> bool| {
        let point = |row: &Vec<f64>| {
            let percent = 100.0 * (at(row, name) / mean - 1.0);
            let is_shown = shown(at(row, "gap_to_next_mm"));
            (at(row, "theta_deg") / 360.0, if is_shown { percent } else { f64::NAN })
        };
        let points: Vec<_> = balls.rows.iter().map(point).collect();
        let is_empty = points.iter().all(|(_, y)| !y.is_finite());
        (!is_empty).then(|| Curve::new(label, color, stroke, points))
    };
    let curves = [
        curve("free_rate", ("free", 0, Stroke::Circles), |_| true),
        curve("rate", ("with push forces", 1, Stroke::Triangles), |_| true),
        curve("rate", ("train of touching balls", 1, Stroke::Solid), |gap| gap < NO_GAP),
    ];
    Figure::new(
        [
            "nut-ball-speeds",
            "Speeds of the balls along the helix",
            "Speeds of free balls, and speeds with push forces between the balls; a line connects touching balls.",
        ],
        [
            PlotAxis::linear("turns along the helix"),
            PlotAxis::linear("speed relative to the mean speed of the free balls, %"),
        ],
        curves.into_iter().flatten().collect(),
    )
}

/// Plots quantities of the balls along the helix, with different marks for each column.
fn along(balls: &Columns, words: [&str; 3], y: PlotAxis, columns: &[(&str, &str)]) -> Figure {
    let strokes = [Stroke::Circles, Stroke::Triangles];
    let curve = |(i, (name, label)): (usize, &(&str, &str))| {
        let point = |row: &Vec<f64>| {
            let value = balls.cell(row, name);
            (value != 0.0).then(|| (balls.cell(row, "theta_deg") / 360.0, value))
        };
        let points: Vec<_> =
            balls.rows.iter().filter_map(point).filter(|(_, y)| y.is_finite()).collect();
        (!points.is_empty()).then(|| Curve::new(*label, i, strokes[i], points))
    };
    Figure::new(
        words,
        [PlotAxis::linear("turns along the helix"), y],
        columns.iter().enumerate().filter_map(curve).collect(),
    )
}

/// Plots the positions of the balls on the developed nut, with different marks for each load class.
fn developed(balls: &Columns) -> Figure {
    let load = |row: &Vec<f64>| {
        let at = |name| balls.cell(row, name);
        at("nut_plus_N").max(at("nut_minus_N"))
    };
    let largest = balls.rows.iter().map(load).fold(0.0, f64::max);
    let at = |row: &Vec<f64>| {
        let around = balls.cell(row, "theta_deg").rem_euclid(360.0);
        (around, balls.cell(row, "z_mm"))
    };
    let class = |(color, (low, high, label)): (usize, (f64, f64, &str))| {
        let within = |row: &&Vec<f64>| {
            let load = load(row);
            load > low * largest && load <= high * largest
        };
        let points: Vec<_> = balls.rows.iter().filter(within).map(at).collect();
        (!points.is_empty()).then(|| Curve::new(label, color, Stroke::Circles, points))
    };
    let mut curves: Vec<_> = CLASSES.into_iter().enumerate().filter_map(class).collect();
    let loose: Vec<_> = balls.rows.iter().filter(|row| load(row) <= 0.0).map(at).collect();
    if !loose.is_empty() {
        curves.push(Curve::new("not loaded", CLASSES.len(), Stroke::Triangles, loose));
    }
    Figure::new(
        [
            "nut-developed",
            "Loads of the balls on the developed nut",
            "Developed view of the nut: each marker represents a ball, and the color shows the class of its load.",
        ],
        [
            PlotAxis::linear("angle around the axis, deg"),
            PlotAxis::linear("position along the axis, mm"),
        ],
        curves,
    )
}

/// Plots quantities against the axial load, and marks the limit load.
fn over_load(
    curve: &Columns,
    (key, title): (&str, &str),
    y: PlotAxis,
    name: &str,
    limit: Option<(f64, f64)>,
) -> Figure {
    let point = |row: &Vec<f64>| (curve.cell(row, "axial_load_N"), curve.cell(row, name));
    let label = y.label.split(',').next().unwrap_or_default();
    let mut curves =
        vec![Curve::new(label, 0, Stroke::Solid, curve.rows.iter().map(point).collect())];
    curves.extend(limit.map(|at| Curve::new("limit load", 1, Stroke::Circles, vec![at])));
    Figure::new(
        [key, title, "Static solution of all balls without friction."],
        [PlotAxis::linear("axial load, N"), y],
        curves,
    )
}
