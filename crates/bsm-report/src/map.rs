//! Maps: plots of a quantity as a function of two other quantities, with a color band for each
//! range of values.

use kuva::backend::raster::RasterBackend;
use kuva::plot::ColorMap;
use kuva::prelude::*;
use kuva::render::render::{PathData, Primitive, Scene as Drawing, render_multiple};

use crate::figure::{svg_of, with_axes};
use crate::{Map, ReportError};

/// Width and height of a map with its legend \[px\].
const SIZE: (f64, f64) = (640.0, 400.0);

/// Approximate number of color bands of a map.
const BANDS: f64 = 9.0;

/// Minimum ratio of the largest to the smallest value for which a quantity is shown on a
/// logarithmic scale.
const DECADES: f64 = 50.0;

/// Lower limit of the used range of the color scale (0: darkest color, 1: brightest color). Black
/// lines are visible on all colors above this limit.
const DARKEST: f64 = 0.25;

/// Color of cells without a value.
const NOTHING: &str = "#c8c8c8";

/// Number of PNG pixels per SVG pixel. This resolution is sufficient for printing.
const PNG_SCALE: f32 = 2.0;

impl Map {
    /// Returns the map as an SVG file.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::NotBuilt`] if the program was built without the feature `plot`.
    pub fn svg(&self) -> Result<String, ReportError> {
        Ok(svg_of(&self.drawing()))
    }

    /// Returns the map as a PNG file.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Picture`] if the map cannot be drawn.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        png_of(&self.drawing())
    }

    fn drawing(&self) -> Drawing {
        let edges = [&self.x, &self.y].map(|(axis, values)| edges(values, axis.log));
        let ends = |edges: &[f64]| (edges[0], edges[edges.len() - 1]);
        let ((left, right), (low, high)) = (ends(&edges[0].1), ends(&edges[1].1));
        let bands = Bands::of(&self.values);
        let mut legend: Vec<_> = (0..bands.len())
            .rev()
            .map(|band| entry(bands.label(band), bands.color(band), LegendShape::Rect, None))
            .collect();
        if self.values.iter().any(|value| value.is_nan()) {
            legend.push(entry("no result".to_owned(), NOTHING.to_owned(), LegendShape::Rect, None));
        }
        let boundary = self.boundary(&edges);
        if !boundary.is_empty() {
            let mut seen: Vec<_> = self.regions.clone();
            seen.sort_unstable();
            seen.dedup();
            let names: Vec<_> = seen.iter().filter_map(|i| self.names.get(*i)).cloned().collect();
            let dash = Some("5 3".to_owned());
            legend.push(entry(names.join(" / "), "#000000".to_owned(), LegendShape::Line, dash));
        }
        // An invisible curve from corner to corner defines the ranges of the axes.
        let corners = LinePlot::new().with_data(vec![(left, low), (right, high)]);
        let corners = vec![Plot::Line(corners.with_stroke_width(0.0).with_color("none"))];
        let layout = Layout::auto_from_plots(&corners)
            .with_title(&self.title)
            .with_title_wrap(46)
            .with_legend_position(LegendPosition::OutsideRightTop)
            .with_legend_title(&self.label)
            .with_legend_entries(legend)
            .with_legend_wrap(24)
            .with_show_grid(false)
            .with_width(SIZE.0)
            .with_height(SIZE.1)
            .with_x_axis_min(left)
            .with_x_axis_max(right)
            .with_y_axis_min(low)
            .with_y_axis_max(high);
        let mut drawing = render_multiple(corners, with_axes(layout, &self.x.0, &self.y.0));
        let clip = drawing.elements.iter().position(|e| matches!(e, Primitive::ClipStart { .. }));
        if let Some(place) = clip
            && let Primitive::ClipStart { x, y, width, height, .. } = drawing.elements[place]
        {
            let part = |value: f64, (from, to): (f64, f64), log: bool| {
                if log {
                    (value / from).ln() / (to / from).ln()
                } else {
                    (value - from) / (to - from)
                }
            };
            let to_x = |value: f64| x + width * part(value, (left, right), self.x.0.log);
            let to_y = |value: f64| y + height * (1.0 - part(value, (low, high), self.y.0.log));
            let mut drawn = self.cells(&edges, &bands, &to_x, &to_y);
            let path: Vec<_> = boundary
                .iter()
                .map(|[(x1, y1), (x2, y2)]| {
                    let [x1, x2] = [*x1, *x2].map(to_x);
                    let [y1, y2] = [*y1, *y2].map(to_y);
                    format!("M {x1:.1} {y1:.1} L {x2:.1} {y2:.1}")
                })
                .collect();
            if !path.is_empty() {
                drawn.push(Primitive::Path(Box::new(PathData {
                    d: path.join(" "),
                    fill: None,
                    stroke: "#000000".into(),
                    stroke_width: 1.5,
                    opacity: None,
                    stroke_dasharray: Some("5 3".to_owned()),
                })));
            }
            let above = drawing.elements.split_off(place + 1);
            drawing.elements.extend(drawn.into_iter().chain(above));
        }
        drawing
    }

    /// Returns the index of the cell in the given column and row.
    fn at(&self, column: usize, row: usize) -> usize {
        column * self.y.1.len() + row
    }

    /// Draws the cells. Consecutive cells in a column with the same color become one rectangle.
    fn cells(
        &self,
        [(columns, x_edges), (rows, y_edges)]: &[(Vec<usize>, Vec<f64>); 2],
        bands: &Bands,
        to_x: &impl Fn(f64) -> f64,
        to_y: &impl Fn(f64) -> f64,
    ) -> Vec<Primitive> {
        /// Overlap between neighboring rectangles \[px\]. It prevents the page background from
        /// being visible between them.
        const OVERLAP: f64 = 0.4;
        let mut drawn = Vec::new();
        for (place, column) in columns.iter().enumerate() {
            let (left, right) = (to_x(x_edges[place]), to_x(x_edges[place + 1]));
            let band = |row: &usize| bands.of_value(self.values[self.at(*column, *row)]);
            let mut first = 0;
            for run in rows.chunk_by(|a, b| band(a) == band(b)) {
                let after = first + run.len();
                let (bottom, top) = (to_y(y_edges[first]), to_y(y_edges[after]));
                let color = band(&run[0]).map_or_else(|| NOTHING.to_owned(), |b| bands.color(b));
                drawn.push(Primitive::Rect {
                    x: left,
                    y: top,
                    width: right - left + OVERLAP,
                    height: bottom - top + OVERLAP,
                    fill: color.into(),
                    stroke: None,
                    stroke_width: None,
                    opacity: None,
                });
                first = after;
            }
        }
        drawn
    }

    /// Returns the lines between cells of different regions, in axis units.
    fn boundary(
        &self,
        [(columns, x_edges), (rows, y_edges)]: &[(Vec<usize>, Vec<f64>); 2],
    ) -> Vec<[(f64, f64); 2]> {
        let region = |i: usize, j: usize| {
            let cell = self.at(columns[i], rows[j]);
            (!self.values[cell].is_nan()).then(|| self.regions.get(cell).copied()).flatten()
        };
        let differ = |a: Option<usize>, b: Option<usize>| a.zip(b).is_some_and(|(a, b)| a != b);
        let mut lines = Vec::new();
        for i in 0..columns.len() {
            for j in 0..rows.len() {
                let (x, y) = ((x_edges[i], x_edges[i + 1]), (y_edges[j], y_edges[j + 1]));
                if i + 1 < columns.len() && differ(region(i, j), region(i + 1, j)) {
                    lines.push([(x.1, y.0), (x.1, y.1)]);
                }
                if j + 1 < rows.len() && differ(region(i, j), region(i, j + 1)) {
                    lines.push([(x.0, y.1), (x.1, y.1)]);
                }
            }
        }
        lines
    }
}

/// Converts a drawing to PNG.
pub(crate) fn png_of(drawing: &Drawing) -> Result<Vec<u8>, ReportError> {
    RasterBackend::new().with_scale(PNG_SCALE).render_scene(drawing).map_err(ReportError::Picture)
}

fn entry(
    label: String,
    color: String,
    shape: LegendShape,
    dasharray: Option<String>,
) -> LegendEntry {
    LegendEntry { label, color, shape, dasharray }
}

/// Returns the indices that sort the values of an axis, and the edges of their cells. The edges are
/// halfway between neighboring values.
fn edges(values: &[f64], log: bool) -> (Vec<usize>, Vec<f64>) {
    let mut order: Vec<_> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let scaled = |place: &usize| if log { values[*place].ln() } else { values[*place] };
    let sorted: Vec<_> = order.iter().map(scaled).collect();
    let mut edges: Vec<_> = sorted.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
    // A single value has no neighbors, so its cell extends by 0.5 to both sides (on a logarithmic
    // axis, in units of the logarithm).
    let first = edges.first().map_or(sorted[0] - 0.5, |edge| 2.0 * sorted[0] - edge);
    let last = sorted[sorted.len() - 1];
    let end = edges.last().map_or(last + 0.5, |edge| 2.0 * last - edge);
    edges.insert(0, first);
    edges.push(end);
    let back = |edge: f64| if log { edge.exp() } else { edge };
    (order, edges.into_iter().map(back).collect())
}

/// Limits of the color bands. All limits are round numbers.
struct Bands(Vec<f64>);

impl Bands {
    fn of(values: &[f64]) -> Self {
        let there = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) =
            there().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return Self(Vec::new());
        }
        if low > 0.0 && high / low > DECADES {
            return Self::decades(low, high);
        }
        // The range is at least 1e-9 times the largest value, so that rounding errors do not appear
        // as color bands.
        let span = (high - low).max(1e-9 * high.abs()).max(f64::MIN_POSITIVE);
        let rough = span / BANDS;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|digit| digit * power);
        let step = step.into_iter().find(|step| *step >= rough).unwrap_or(rough);
        // The small offset compensates for the rounding errors of decimal multiples of the step.
        let (from, to) = ((low / step + 1e-9).floor(), (high / step + 1e-9).floor() + 1.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some ten bands"
        )]
        let count = (to - from) as u32;
        Self((0..=count).map(|i| (from + f64::from(i)) * step).collect())
    }

    fn decades(low: f64, high: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "powers of ten of doubles")]
        let (from, to) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let digits: &[f64] = match to - from {
            ..=2 => &[1.0, 2.0, 5.0],
            3..=4 => &[1.0, 3.0],
            _ => &[1.0],
        };
        // If the range covers many powers of ten, several powers share a band, so that there are at
        // most ten bands.
        let every = usize::try_from((to - from - 1) / 9).unwrap_or(0) + 1;
        let edges = (from..=to + 1).step_by(every).flat_map(|power| {
            digits.iter().map(move |digit| format!("{digit}e{power}").parse().unwrap_or(0.0))
        });
        let edges: Vec<f64> = edges.collect();
        let first = edges.iter().rposition(|edge| *edge <= low).unwrap_or(0);
        let last = edges.iter().position(|edge| *edge > high).unwrap_or(edges.len() - 1);
        Self(edges[first..=last].to_vec())
    }

    fn len(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    fn of_value(&self, value: f64) -> Option<usize> {
        let above = self.0.partition_point(|edge| *edge <= value);
        (!value.is_nan() && self.len() > 0).then(|| above.clamp(1, self.len()) - 1)
    }

    fn label(&self, band: usize) -> String {
        let step = self.0[band + 1] - self.0[band];
        let texts = [self.0[band], self.0[band + 1]].map(|edge| round(edge, step));
        texts.join(" to ")
    }

    #[expect(clippy::cast_precision_loss, reason = "some ten bands")]
    fn color(&self, band: usize) -> String {
        let part = if self.len() < 2 { 0.5 } else { band as f64 / (self.len() - 1) as f64 };
        ColorMap::Viridis.map(DARKEST + (1.0 - DARKEST) * part)
    }
}

/// Formats a band limit with as many digits as its step requires.
fn round(value: f64, step: f64) -> String {
    let magnitude = value.abs().max(step.abs());
    if !(1e-4..1e6).contains(&magnitude) && value != 0.0 {
        return format!("{value:e}");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few digits")]
    let decimals = (1.0 - step.abs().log10().floor()).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlotAxis;

    /// Returns a map with a logarithmic x axis, one cell without a value, and two regions.
    fn map() -> Map {
        Map {
            title: "t".into(),
            x: (PlotAxis::log("x, N"), vec![100.0, 1000.0, 10.0]),
            y: (PlotAxis::linear("y, rpm"), vec![0.0, 1.0]),
            label: "z, W".into(),
            values: vec![2.0, 2.5, 3.0, f64::NAN, 1.0, 1.5],
            regions: vec![0, 1, 1, 1, 0, 0],
            names: vec!["a".into(), "b".into()],
        }
    }

    /// Cells must be placed around their values in sorted order, regardless of the order in the
    /// list, and neighboring cells must share an edge.
    #[test]
    fn cells_of_a_map_plot_extend_to_midpoints_between_neighboring_values() {
        let (order, found) = edges(&[100.0, 1000.0, 10.0], true);
        assert_eq!(order, [2, 0, 1]);
        // The expected edges are the geometric means of neighboring values.
        for (found, edge) in
            found.iter().zip([10_f64.sqrt(), 1000_f64.sqrt(), 1e5_f64.sqrt(), 1e7_f64.sqrt()])
        {
            assert!((found / edge - 1.0).abs() < 1e-12, "rounding of logarithms: {found} {edge}");
        }
        assert_eq!(edges(&[3.0], false).1, [2.5, 3.5]);
    }

    /// Boundaries must be drawn between neighboring cells that have values and belong to different
    /// regions. The legend must contain every color, including the color for cells without a value.
    #[test]
    fn map_shows_region_boundaries_and_all_legend_colors() {
        let map = map();
        let edges = [edges(&map.x.1, true), edges(&map.y.1, false)];
        // Expected boundaries: 10 | 100 at y = 1, 0 | 1 at x = 100, and 100 | 1000 at y = 0. The
        // cell without a value has no boundaries.
        let lines = map.boundary(&edges);
        assert_eq!(lines.len(), 3, "{lines:?}");
        let svg = map.svg().expect("a picture");
        for part in
            ["no result", "a / b", "z, W", "1 to 1.25", "3 to 3.25", "stroke-dasharray=\"5 3\""]
        {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        let png = map.png().expect("a picture");
        assert_eq!(png[..4], [0x89, b'P', b'N', b'G']);
    }

    #[test]
    fn limits_of_color_bands_in_a_map_are_round_numbers() {
        let edges = |values: &[f64]| Bands::of(values).0;
        let close = |found: Vec<f64>, by_hand: &[f64]| {
            assert_eq!(found.len(), by_hand.len(), "{found:?}");
            for (a, b) in found.iter().zip(by_hand) {
                assert!((a - b).abs() <= 1e-12 * b.abs(), "rounding: {found:?}");
            }
        };
        close(
            edges(&[0.981, 0.988]),
            &[0.981, 0.982, 0.983, 0.984, 0.985, 0.986, 0.987, 0.988, 0.989],
        );
        close(edges(&[1.0, 700.0]), &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]);
        // If all values are equal, there must be one band and no division by zero.
        assert_eq!(Bands::of(&[5.0, 5.0]).len(), 1);
        assert_eq!(Bands::of(&[0.0]).len(), 1);
        assert_eq!(Bands::of(&[f64::NAN]).len(), 0);
        assert_eq!(
            (round(0.9825, 5e-4), round(-0.0, 1.0), round(2e-7, 1e-7)),
            ("0.9825".into(), "0".into(), "2e-7".into())
        );
    }
}
