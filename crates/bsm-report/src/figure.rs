//! Figures, which can be written as images and as tables.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::prelude::*;
use kuva::render::color::Color;
use kuva::render::layout::TickFormat;
use kuva::render::render::{PathData, Primitive, Scene as Drawing, render_multiple};

use crate::map::png_of;
use crate::{Curve, Figure, PlotAxis, ReportError, Stroke, format_number};

impl Stroke {
    fn is_line(self) -> bool {
        matches!(self, Self::Solid | Self::Dashed | Self::Dotted)
    }
}

/// Width and height of a figure without its legend \[px\]. At this size, text is legible on a
/// phone.
const SIZE: (f64, f64) = (460.0, 330.0);

/// Number of characters that fit into a line of the title, even in capitals, and the line height
/// \[px\].
const TITLE: usize = 34;
const TITLE_LINE: f64 = 20.0;

/// Height of a legend row \[px\], and number of characters that fit into one of two legend columns.
const ROW: f64 = 21.0;
const COLUMN: usize = 18;

/// Approximate number of points per curve that show their values when the pointer is on them. With
/// more points, neighboring points would be too close together.
const MAX_POINT_LABELS: usize = 16;

/// Markers that distinguish lines without color, in the order of the colors. The first color has no
/// marker.
const SHAPES: [MarkerShape; 5] = [
    MarkerShape::Square,
    MarkerShape::Diamond,
    MarkerShape::TriangleDown,
    MarkerShape::Plus,
    MarkerShape::Cross,
];

/// Number of markers on each line, and size of a marker \[px\].
const SHAPES_OF_LINE: usize = 5;
const SHAPE_SIZE: f64 = 3.5;

/// Legend texts: strokes with their meanings, and color indices with their meanings.
type Parts<'a> = (Vec<(Stroke, &'a str)>, Vec<(usize, &'a str)>);

/// Color of the line samples in a legend for strokes that occur in several colors.
const GRAY: &str = "#777777";

/// Factor by which a logarithmic axis extends beyond the outermost points.
const BEYOND: f64 = 1.4;

impl Figure {
    /// Returns the figure as an SVG file.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::NotBuilt`] if the program was built without the feature `plot`.
    pub fn svg(&self) -> Result<String, ReportError> {
        Ok(svg_of(&self.titled()))
    }

    /// Returns the figure as a PNG file.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Picture`] if the figure cannot be drawn.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        png_of(&self.titled())
    }

    fn titled(&self) -> Drawing {
        let lines = self.title.chars().count().div_ceil(TITLE);
        // The plotting library takes the space for the title from the height of the plot, so the
        // height is increased.
        #[expect(clippy::cast_precision_loss, reason = "a few lines")]
        let more = TITLE_LINE * lines.saturating_sub(1) as f64;
        self.drawing(Vec::new(), |layout, height| {
            layout.with_title(&self.title).with_title_wrap(TITLE).with_height(height + more)
        })
    }

    /// Returns the figure as SVG for an HTML page that shows the title itself and may contain
    /// several figures. The values of a point appear when the pointer is on the point; no script is
    /// needed.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::NotBuilt`] if the program was built without the feature `plot`.
    pub fn inline_svg(&self) -> Result<String, ReportError> {
        let plots = self.curves.iter().map(|curve| self.plot_of(curve)).collect();
        let svg = svg_of(&self.drawing(plots, Layout::with_height));
        // Ids in an inline SVG apply to the whole page, so they must be unique.
        Ok(svg.replace("kuva-clip-", &format!("{}-clip-", self.key)))
    }

    /// Returns invisible points on a curve that show their values when the pointer is on them.
    fn plot_of(&self, curve: &Curve) -> Plot {
        let real: Vec<_> =
            curve.points.iter().enumerate().filter(|(_, (_, y))| y.is_finite()).collect();
        // Every nth point is included, and so is the last point of the curve.
        let every = real.len().saturating_sub(1) / MAX_POINT_LABELS + 1;
        let picked = || real.iter().rev().step_by(every);
        let text = |(i, (x, y)): &(usize, &(f64, f64))| {
            let names = curve.label.iter().chain(curve.marks.get(*i));
            let values = [(&self.x, *x), (&self.y, *y)]
                .map(|(axis, value)| format!("{}: {}", axis.label, format_number(value)));
            names.chain(&values).map(String::as_str).collect::<Vec<_>>().join("\n")
        };
        let points = ScatterPlot::new().with_data(picked().map(|(_, point)| **point));
        let points = points.with_color(color(curve.color)).with_size(7.0).with_marker_opacity(0.0);
        Plot::Scatter(points.with_tooltip_labels(picked().map(text)))
    }

    /// Draws the curves, the axes and the legend.
    ///
    /// * `above`: additional elements that are drawn over the curves.
    fn drawing(&self, above: Vec<Plot>, title: impl Fn(Layout, f64) -> Layout) -> Drawing {
        let mut plots = Vec::new();
        for curve in &self.curves {
            let runs = curve.points.split(|(_, y)| !y.is_finite()).filter(|run| !run.is_empty());
            plots.extend(runs.map(|run| plot(curve, run, &color(curve.color))));
        }
        let shapes = self.shapes();
        plots.extend(self.curves.iter().filter_map(|curve| shaped(curve, &shapes)));
        plots.extend(above);
        let entry = |curve: &Curve| {
            let label = curve.label.as_ref()?;
            Some(legend_entry(curve.stroke, &color(curve.color), label))
        };
        let by_parts = self.strokes_and_colors().map(|(strokes, of_colors)| {
            let strokes = strokes.iter().map(|(stroke, label)| legend_entry(*stroke, GRAY, label));
            let of_colors =
                of_colors.iter().map(|(i, label)| legend_entry(Stroke::Solid, &color(*i), label));
            strokes.chain(of_colors).collect()
        });
        let legend: Vec<_> =
            by_parts.unwrap_or_else(|| self.curves.iter().filter_map(entry).collect());
        // The plotting library takes the space for the legend from the height of the plot, so the
        // height is increased.
        let longest = legend.iter().map(|entry| entry.label.chars().count()).max().unwrap_or(0);
        let columns = if longest > COLUMN { 1 } else { 2 };
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let height = SIZE.1 + ROW * legend.len().div_ceil(columns) as f64;
        let mut layout = Layout::auto_from_plots(&plots)
            .with_legend_position(LegendPosition::OutsideBottomColumns)
            .with_legend_col_limit(columns)
            .with_legend_entries(legend)
            .with_width(SIZE.0);
        layout = with_axes(layout, &self.x, &self.y);
        if self.x.log {
            // The ends of the axis are set explicitly, because the plotting library would extend
            // the axis to powers of ten that may be far from the points.
            let xs = || self.curves.iter().flat_map(|curve| &curve.points).map(|(x, _)| *x);
            let (low, high) = (xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max));
            layout = layout.with_x_axis_min(low / BEYOND).with_x_axis_max(high * BEYOND);
        }
        if self.x.from_zero {
            layout = layout.with_x_axis_min(0.0);
        }
        if self.y.from_zero {
            layout = layout.with_y_axis_min(0.0);
        }
        if self.y.equal {
            layout = layout.with_equal_aspect();
        }
        let mut drawing = render_multiple(plots, title(layout, height));
        lengthen_samples(&mut drawing, &shapes);
        drawing
    }

    /// Returns markers for the colors whose lines cannot be distinguished by stroke. A figure with
    /// equal scales on both axes is a drawing and needs no markers, because its curves can be
    /// distinguished by their position.
    fn shapes(&self) -> Vec<(usize, MarkerShape)> {
        let lines = || self.curves.iter().filter(|curve| curve.stroke.is_line());
        let mut colors = Vec::new();
        for (i, curve) in lines().enumerate() {
            let alike = |other: &Curve| other.stroke == curve.stroke && other.color != curve.color;
            if lines().take(i).any(alike) && !colors.contains(&curve.color) {
                colors.push(curve.color);
            }
        }
        if self.y.equal { Vec::new() } else { colors.into_iter().zip(SHAPES).collect() }
    }

    /// Returns the meaning of each stroke and each color. Returns `None` unless the figure has many
    /// curves with labels of the form `a, b`, in which one part determines the stroke and the other
    /// part determines the color.
    fn strokes_and_colors(&self) -> Option<Parts<'_>> {
        self.parts(false).or_else(|| self.parts(true))
    }

    /// Returns the meaning of each stroke and each color, if the labels have two parts.
    ///
    /// * `color_first`: true if the first part of each label determines the color.
    fn parts(&self, color_first: bool) -> Option<Parts<'_>> {
        /// Maximum number of curves that are listed in a single legend list. With more curves,
        /// separate lists of strokes and colors are easier to read.
        const FEW: usize = 4;
        let (mut strokes, mut colors) = (Vec::new(), Vec::new());
        for curve in &self.curves {
            let (first, second) = curve.label.as_ref()?.split_once(", ")?;
            let (of_stroke, of_color) = if color_first { (second, first) } else { (first, second) };
            let (stroke, color) = ((curve.stroke, of_stroke), (curve.color, of_color));
            if !strokes.contains(&stroke) {
                strokes.push(stroke);
            }
            if !colors.contains(&color) {
                colors.push(color);
            }
        }
        let once = |all: &mut dyn Iterator<Item = bool>| all.filter(|same| *same).count() == 1;
        let by_strokes =
            strokes.iter().all(|(a, _)| once(&mut strokes.iter().map(|(b, _)| a == b)));
        let by_colors = colors.iter().all(|(a, _)| once(&mut colors.iter().map(|(b, _)| a == b)));
        let fewer = strokes.len() + colors.len() < self.curves.len();
        let holds = self.curves.len() > FEW && fewer && by_strokes && by_colors;
        holds.then_some((strokes, colors))
    }
}

/// Converts a drawing to SVG.
pub(crate) fn svg_of(drawing: &Drawing) -> String {
    let mut svg = SvgBackend.render_scene(drawing);
    svg.retain(is_xml);
    scalable(&renumbered(&svg))
}

/// Renumbers the clip paths of a figure. The plotting library numbers them consecutively across all
/// figures of a process. Renumbering ensures that the text of a figure does not depend on previous
/// figures.
fn renumbered(svg: &str) -> String {
    const CLIP: &str = "kuva-clip-";
    let mut parts = svg.split(CLIP);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut known: Vec<&str> = Vec::new();
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let (number, rest) = part.split_at(end);
        let place = known.iter().position(|own| *own == number).unwrap_or_else(|| {
            known.push(number);
            known.len() - 1
        });
        for piece in [CLIP, &place.to_string(), rest] {
            text.push_str(piece);
        }
    }
    text
}

/// Sets the labels, scales and sizes of the axes.
pub(crate) fn with_axes(layout: Layout, x: &PlotAxis, y: &PlotAxis) -> Layout {
    let layout = layout
        .with_x_label(&x.label)
        .with_y_label(&y.label)
        .with_x_tick_format(tick(x.log))
        .with_y_tick_format(tick(y.log))
        .with_label_size(15)
        .with_tick_size(14)
        .with_body_size(14)
        .with_legend_box(false);
    let layout = if x.log { layout.with_log_x() } else { layout };
    if y.log { layout.with_log_y() } else { layout }
}

/// Returns the format of the tick labels of an axis.
///
/// * `log`: true for a logarithmic axis, where the tick values have rounding errors because they
///   are powers of ten.
fn tick(log: bool) -> TickFormat {
    TickFormat::Custom(Arc::new(move |value| {
        let digits = if log { 3 } else { 6 };
        // Parsing the rounded text gives a number with few digits.
        let value: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
        let plain = (1e-4..1e6).contains(&value.abs());
        if value.abs() < 1e-15 {
            "0".to_owned()
        } else if plain {
            value.to_string()
        } else {
            format!("{value:e}")
        }
    }))
}

/// Returns the palette color with the given index.
fn color(number: usize) -> String {
    let palette = Palette::tol_bright();
    let colors = palette.colors();
    colors[number % colors.len()].clone()
}

fn line_style(stroke: Stroke) -> LineStyle {
    match stroke {
        Stroke::Dashed => LineStyle::Dashed,
        Stroke::Dotted => LineStyle::Dotted,
        _ => LineStyle::Solid,
    }
}

fn plot(curve: &Curve, points: &[(f64, f64)], color: &str) -> Plot {
    let marks = |marker| {
        let marks = ScatterPlot::new().with_data(points.to_vec()).with_color(color);
        let marks = marks.with_marker(marker).with_size(4.0);
        // A curve with gaps is drawn in segments. The list of point names applies to the whole
        // curve, so names are drawn only if one segment contains all points.
        Plot::Scatter(if curve.marks.len() == points.len() {
            marks.with_labels(curve.marks.clone()).with_repel_labels()
        } else {
            marks
        })
    };
    match curve.stroke {
        Stroke::Circles => marks(MarkerShape::Circle),
        Stroke::Triangles => marks(MarkerShape::Triangle),
        Stroke::Solid | Stroke::Dashed | Stroke::Dotted => {
            let line = LinePlot::new().with_data(points.to_vec()).with_color(color);
            Plot::Line(line.with_stroke_width(2.0).with_line_style(line_style(curve.stroke)))
        }
    }
}

/// Draws markers along a line. Returns `None` if the color of the line has no marker.
fn shaped(curve: &Curve, shapes: &[(usize, MarkerShape)]) -> Option<Plot> {
    let (_, shape) = shapes.iter().find(|(place, _)| *place == curve.color)?;
    let real: Vec<_> = curve.points.iter().filter(|(_, y)| y.is_finite()).collect();
    let places = (0..SHAPES_OF_LINE).map(|k| (2 * k + 1) * real.len() / (2 * SHAPES_OF_LINE));
    let points = places.filter_map(|place| real.get(place)).map(|point| **point);
    let plot = ScatterPlot::new().with_data(points).with_color(color(curve.color));
    let plot = plot.with_marker(*shape).with_size(SHAPE_SIZE);
    curve.stroke.is_line().then_some(Plot::Scatter(plot))
}

fn legend_entry(stroke: Stroke, color: &str, label: &str) -> LegendEntry {
    let shape = match stroke {
        Stroke::Circles => LegendShape::Circle,
        Stroke::Triangles => LegendShape::Marker(MarkerShape::Triangle),
        Stroke::Solid | Stroke::Dashed | Stroke::Dotted => LegendShape::Line,
    };
    // With the dash pattern of the line itself, the short line sample in the legend would show only
    // one dash.
    let dasharray = match stroke {
        Stroke::Dashed => Some("5 3".to_owned()),
        Stroke::Dotted => Some("2 3".to_owned()),
        _ => None,
    };
    LegendEntry { label: label.to_owned(), color: color.to_owned(), shape, dasharray }
}

/// Lengthens the line samples in the legend and adds the markers. The plotting library makes the
/// samples too short to distinguish the line styles.
fn lengthen_samples(drawing: &mut Drawing, shapes: &[(usize, MarkerShape)]) {
    const ADDED_LENGTH: f64 = 12.0;
    const MAX_SAMPLE_LENGTH: f64 = 30.0;
    let plot = drawing.elements.iter().rposition(|element| matches!(element, Primitive::ClipEnd));
    let mut drawn = Vec::new();
    for element in drawing.elements.iter_mut().skip(plot.unwrap_or(usize::MAX)) {
        if let Primitive::Line { x1, x2, y1, y2, stroke, .. } = element
            && (*y1 - *y2).abs() < 1e-9
            && (0.0..MAX_SAMPLE_LENGTH).contains(&(*x2 - *x1))
        {
            *x1 -= ADDED_LENGTH;
            let of_line =
                shapes.iter().find(|(place, _)| *stroke == Color::from(color(*place).as_str()));
            if let Some((_, shape)) = of_line {
                drawn.push(sample(*shape, f64::midpoint(*x1, *x2), *y1, stroke));
            }
        }
    }
    drawing.elements.extend(drawn);
}

/// Draws the sample of a marker in the legend.
fn sample(shape: MarkerShape, x: f64, y: f64, stroke: &Color) -> Primitive {
    let (s, m) = (SHAPE_SIZE, 1.3 * SHAPE_SIZE);
    let d = match shape {
        MarkerShape::Diamond => format!("M{x},{} l{m},{m} l-{m},{m} l-{m},-{m} Z", y - m),
        MarkerShape::TriangleDown => {
            format!("M{},{} h{} l-{s},{} Z", x - s, y - 0.7 * s, 2.0 * s, 1.7 * s)
        }
        MarkerShape::Plus => format!("M{},{y} h{} M{x},{} v{}", x - s, 2.0 * s, y - s, 2.0 * s),
        MarkerShape::Cross => {
            let side = 2.0 * s;
            format!("M{},{} l{side},{side} m-{side},0 l{side},-{side}", x - s, y - s)
        }
        _ => format!("M{},{} h{} v{} h-{} Z", x - s, y - s, 2.0 * s, 2.0 * s, 2.0 * s),
    };
    Primitive::Path(Box::new(PathData {
        d,
        fill: Some(stroke.clone()),
        stroke: stroke.clone(),
        stroke_width: 1.5,
        opacity: None,
        stroke_dasharray: None,
    }))
}

/// Returns true for characters that are permitted in XML 1.0. Any other character in a title would
/// make the file unreadable.
fn is_xml(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}

/// Makes the size of an SVG adapt to the page. The plotting library sets a fixed size and no view
/// box.
fn scalable(svg: &str) -> String {
    let size = |name: &str| {
        let from = svg.find(&format!(" {name}=\""))? + name.len() + 3;
        svg[from..].split('"').next()
    };
    match (size("width"), size("height")) {
        (Some(width), Some(height)) => {
            svg.replacen("<svg ", &format!("<svg viewBox=\"0 0 {width} {height}\" "), 1)
        }
        _ => svg.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure_of(curves: Vec<Curve>) -> Figure {
        Figure {
            key: "k".into(),
            title: "t".into(),
            caption: String::new(),
            x: PlotAxis::linear("x, mm"),
            y: PlotAxis::linear("y, N"),
            curves,
        }
    }

    /// The legend for three loads and three models must list strokes and colors separately.
    /// Regression test: this legend had nine rows.
    #[test]
    fn legend_lists_strokes_and_colors_separately() {
        let strokes = [(Stroke::Solid, "a"), (Stroke::Dashed, "b"), (Stroke::Dotted, "c")];
        let curve = |i: usize| {
            let (stroke, name) = strokes[i / 3];
            Curve::new(format!("{name}, {} N", i % 3), i % 3, stroke, vec![(0.0, 0.0), (1.0, 1.0)])
        };
        let mut figure = figure_of((0..9).map(curve).collect());
        let (by_stroke, by_color) = figure.strokes_and_colors().expect("two parts");
        assert_eq!(by_stroke, strokes);
        assert_eq!(by_color, [(0, "0 N"), (1, "1 N"), (2, "2 N")]);
        // The two parts of a label may also be in the opposite order, as in `0 N, a`.
        let mut turned = figure.clone();
        for curve in &mut turned.curves {
            let (name, load) =
                curve.label.as_deref().expect("a label").split_once(", ").expect("two parts");
            curve.label = Some(format!("{load}, {name}"));
        }
        let (by_stroke, by_color) = turned.strokes_and_colors().expect("two parts");
        assert_eq!(by_stroke, strokes);
        assert_eq!(by_color, [(0, "0 N"), (1, "1 N"), (2, "2 N")]);
        // If one label does not match the pattern, the legend must be a single list.
        figure.curves[4].stroke = Stroke::Solid;
        assert_eq!(figure.strokes_and_colors(), None);
    }

    /// Lines with the same stroke and different colors must have markers, both in the figure and in
    /// the legend. Lines with different strokes need no markers.
    #[test]
    fn lines_can_be_distinguished_without_color() {
        let curve = |color: usize, stroke| {
            let points = (0..20).map(|x| (f64::from(x), 1.0)).collect();
            Curve::new(format!("curve {color}"), color, stroke, points)
        };
        let mut figure = figure_of(vec![curve(0, Stroke::Solid), curve(1, Stroke::Dashed)]);
        assert_eq!(figure.shapes(), []);
        let plain = figure.svg().expect("a picture").matches("<rect").count();
        figure.curves.push(curve(2, Stroke::Solid));
        assert_eq!(figure.shapes(), [(2, MarkerShape::Square)]);
        let svg = figure.svg().expect("a picture");
        assert_eq!(svg.matches("<rect").count() - plain, SHAPES_OF_LINE, "{svg}");
        assert_eq!(svg.matches(" v7 h-7 Z").count(), 1, "{svg}");
        // With equal scales on both axes, the figure is a drawing, whose curves can be
        // distinguished by their position.
        figure.y = PlotAxis::equal("y");
        assert_eq!(figure.shapes(), []);
    }

    /// A gap in a curve must be a gap in the figure and in the table. The SVG must have a view box.
    #[test]
    fn figures_show_gaps_and_their_svg_has_a_view_box() {
        let points = vec![(1.0, 1.0), (2.0, 2.0), (3.0, f64::NAN), (4.0, 2.0), (5.0, 1.0)];
        let curve = Curve::new("a", 0, Stroke::Solid, points);
        let mut figure = figure_of(vec![curve]);
        figure.y = PlotAxis::log("y, N");
        let svg = figure.svg().expect("a picture");
        assert!(svg.contains("viewBox=\"0 0 460 "), "{}", &svg[..300]);
        assert_eq!(svg.matches("<path d=\"M ").count(), 2, "{svg}");
        // Regression test: the SVG text of a figure depended on figures that were drawn before.
        assert_eq!(figure.svg().expect("a picture"), svg);
        // On a page, every point must show its values, except for the missing point at the gap; in
        // an SVG file, no point may show its values.
        let titles = |svg: &str| svg.matches("<title>").count();
        assert_eq!((titles(&svg), titles(&figure.inline_svg().expect("a picture"))), (0, 4));
        assert!(
            figure
                .inline_svg()
                .expect("a picture")
                .contains("<title>a\nx, mm: 4.0000\ny, N: 2.0000</title>")
        );
        assert!(figure.csv().expect("a table").contains("\na,,3,\na,,4,2\n"));
    }
}
