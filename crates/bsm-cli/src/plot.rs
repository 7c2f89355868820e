//! Line plots; the only file that names the plotting library.

use kuva::prelude::*;

/// Colours that the palette has, chosen to be told apart by the colour-blind too.
pub(crate) const MOST_CURVES: usize = 7;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stroke {
    Solid,
    Dashed,
    Dotted,
}

/// One line of a plot; a y that is not finite is a gap.
pub(crate) struct Curve {
    pub(crate) label: Option<String>,
    /// Number of its colour in the palette.
    pub(crate) color: usize,
    pub(crate) stroke: Stroke,
    pub(crate) points: Vec<(f64, f64)>,
}

/// Title and axes.
pub(crate) struct Frame<'a> {
    pub(crate) title: &'a str,
    pub(crate) x_label: &'a str,
    pub(crate) y_label: &'a str,
    /// Logarithmic x axis.
    pub(crate) log_x: bool,
}

/// SVG of some curves over a common x.
pub(crate) fn lines(frame: &Frame<'_>, curves: &[Curve]) -> String {
    let palette = Palette::tol_bright();
    let colors = palette.colors();
    let mut plots = Vec::new();
    for curve in curves {
        let color = colors[curve.color % colors.len()].as_str();
        let mut label = curve.label.clone();
        for run in curve.points.split(|(_, y)| !y.is_finite()).filter(|run| !run.is_empty()) {
            let mut line =
                LinePlot::new().with_data(run.to_vec()).with_color(color).with_stroke_width(2.0);
            line = match curve.stroke {
                Stroke::Solid => line,
                Stroke::Dashed => line.with_dashed(),
                Stroke::Dotted => line.with_dotted(),
            };
            // One legend entry for all runs of a curve.
            if let Some(label) = label.take() {
                line = line.with_legend(label);
            }
            plots.push(Plot::Line(line));
        }
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_title(frame.title)
        .with_title_wrap(60)
        .with_x_label(frame.x_label)
        .with_y_label(frame.y_label)
        .with_width(720.0)
        .with_height(440.0);
    if frame.log_x {
        layout = layout.with_log_x();
    }
    kuva::render_to_svg(plots, layout)
}
