//! Figures and maps as data.

use bsm_case::{DisplayUnits, format_exact};
use serde::Deserialize;

use crate::ReportError;

/// Maximum number of curves, which is the number of colors in the palette. Readers with color
/// blindness can distinguish these colors.
pub const MAX_CURVES: usize = 7;

/// Line or mark style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stroke {
    /// A solid line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// Circles at the points, without a line.
    Circles,
    /// Triangles at the points, without a line.
    Triangles,
}

/// One curve of a figure. Points whose y value is NaN or infinite leave a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Label of the curve in the legend.
    pub label: Option<String>,
    /// Index of the color in the palette.
    pub color: usize,
    /// Line or mark style of the curve.
    pub stroke: Stroke,
    /// Points (x, y) in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Names of the points, which are drawn next to their marks. The list is empty or has one name
    /// for each point.
    pub marks: Vec<String>,
}

impl Curve {
    /// Returns a curve with a label but without point names.
    pub fn new(
        label: impl Into<String>,
        color: usize,
        stroke: Stroke,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self { label: Some(label.into()), color, stroke, points, marks: Vec::new() }
    }
}

/// An axis of a figure: its label and its scale.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotAxis {
    /// Quantity and unit, separated by a comma.
    pub label: String,
    /// True if the axis has a logarithmic scale.
    pub log: bool,
    /// True if both axes must have the same scale, as in a drawing.
    pub equal: bool,
    /// True if the axis must start at zero.
    pub from_zero: bool,
}

impl PlotAxis {
    /// Creates an axis with a linear scale.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), log: false, equal: false, from_zero: false }
    }

    /// Creates an axis with a linear scale that starts at zero, for values that are not negative.
    pub fn from_zero(label: &str) -> Self {
        Self { from_zero: true, ..Self::linear(label) }
    }

    /// Creates an axis for a drawing, in which both axes have the same scale.
    pub fn equal(label: &str) -> Self {
        Self { equal: true, ..Self::linear(label) }
    }

    /// Creates an axis with a logarithmic scale.
    pub fn log(label: &str) -> Self {
        Self { log: true, ..Self::linear(label) }
    }
}

/// A figure that consists of curves over a common x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// File name of this figure, without extension.
    pub key: String,
    /// Title of the figure.
    pub title: String,
    /// Caption of the figure.
    pub caption: String,
    /// Horizontal axis.
    pub x: PlotAxis,
    /// Vertical axis.
    pub y: PlotAxis,
    /// The curves, in the order of the legend.
    pub curves: Vec<Curve>,
}

impl Figure {
    /// Creates a figure from key, title, caption, axes and curves.
    pub fn new(
        [key, title, caption]: [&str; 3],
        [x, y]: [PlotAxis; 2],
        curves: Vec<Curve>,
    ) -> Self {
        let [key, title, caption] = [key, title, caption].map(str::to_owned);
        Self { key, title, caption, x, y, curves }
    }

    /// Returns the figure with both axes in display units. The unit of an axis is the part of its
    /// label after the last comma.
    #[must_use]
    pub fn in_units(mut self, units: DisplayUnits) -> Self {
        let (x, x_unit) = units.label(&self.x.label);
        let (y, y_unit) = units.label(&self.y.label);
        (self.x.label, self.y.label) = (x, y);
        for point in self.curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *point = (x_unit.value(point.0), y_unit.value(point.1));
        }
        self
    }

    /// Returns the points as CSV, with one row for each point. In a gap, y is empty.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Table`] if the table cannot be written.
    pub fn csv(&self) -> Result<String, ReportError> {
        let mut table = csv::Writer::from_writer(Vec::new());
        table.write_record(["curve", "mark", &self.x.label, &self.y.label])?;
        for curve in &self.curves {
            let label = curve.label.as_deref().unwrap_or_default();
            for (i, (x, y)) in curve.points.iter().enumerate() {
                let mark = curve.marks.get(i).map_or("", String::as_str);
                let y = if y.is_finite() { format_exact(*y) } else { String::new() };
                table.write_record([label, mark, &format_exact(*x), &y])?;
            }
        }
        text_of_table(table)
    }
}

/// Returns the contents of a CSV writer as text.
pub(crate) fn text_of_table(table: csv::Writer<Vec<u8>>) -> Result<String, ReportError> {
    let bytes = table.into_inner().map_err(|e| csv::Error::from(e.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Maximum number of values per axis that are drawn. With more values, cells would be smaller than
/// a pixel.
pub const MAX_CELLS: usize = 400;

/// A map of a quantity as a function of two other quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Title of the map.
    pub title: String,
    /// Horizontal axis and its values.
    pub x: (PlotAxis, Vec<f64>),
    /// Vertical axis and its values.
    pub y: (PlotAxis, Vec<f64>),
    /// Label of the quantity that the colors show.
    pub label: String,
    /// Value of each cell; NaN for a cell without a value. Cells with the same x are consecutive.
    pub values: Vec<f64>,
    /// Region of each cell, as an index into `names`. Lines are drawn at the boundaries between
    /// regions.
    pub regions: Vec<usize>,
    /// Names of the regions.
    pub names: Vec<String>,
}
