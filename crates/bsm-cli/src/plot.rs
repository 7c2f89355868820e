//! Line plots; the only file that names the plotting library.

use kuva::prelude::*;

/// Colours that the palette has, chosen to be told apart by the colour-blind too.
pub(crate) const MOST_CURVES: usize = 7;

/// One line of a plot; a y that is not finite is a gap.
pub(crate) struct Curve {
    pub(crate) label: Option<String>,
    pub(crate) points: Vec<(f64, f64)>,
}

/// SVG of some curves over a common x.
pub(crate) fn lines(title: &str, x_label: &str, y_label: &str, curves: &[Curve]) -> String {
    let palette = Palette::tol_bright();
    let mut plots = Vec::new();
    for (curve, color) in curves.iter().zip(palette.colors().iter().cycle()) {
        let mut label = curve.label.clone();
        for run in curve.points.split(|(_, y)| !y.is_finite()).filter(|run| !run.is_empty()) {
            let mut line = LinePlot::new()
                .with_data(run.to_vec())
                .with_color(color.as_str())
                .with_stroke_width(2.0);
            // One legend entry for all runs of a curve.
            if let Some(label) = label.take() {
                line = line.with_legend(label);
            }
            plots.push(Plot::Line(line));
        }
    }
    let layout = Layout::auto_from_plots(&plots)
        .with_title(title)
        .with_title_wrap(60)
        .with_x_label(x_label)
        .with_y_label(y_label)
        .with_width(720.0)
        .with_height(440.0);
    kuva::render_to_svg(plots, layout)
}
