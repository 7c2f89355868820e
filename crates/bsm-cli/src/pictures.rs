//! Plots of results over a grid: curves and maps.

use bsm_batch::{Answers, Chunk, ColumnUnits};
use bsm_case::units::label;
use bsm_case::{DisplayUnit, Grid, GridAxis, Output, format_exact, format_trimmed};
use bsm_report::{Curve, Figure, MAX_CELLS, MAX_CURVES, Map, PlotAxis, ReportError, Stroke};

use crate::failure::Failure;

/// Maximum number of points of a plot. With more points, SVG viewers become very slow.
const MAX_POINTS: usize = 100_000;

/// Minimum ratio of the largest to the smallest value of a varied input for which its axis is
/// logarithmic.
const DECADES: f64 = 100.0;

/// Returns the plot axis of an input, labeled with its display unit.
fn axis_of(axis: &GridAxis, units: &ColumnUnits) -> PlotAxis {
    let unit = units.of_input(axis.key);
    let label = label(&unit.name(axis.key.name()), unit.text);
    if axis.is_log() { PlotAxis::log(&label) } else { PlotAxis::linear(&label) }
}

/// Returns the label of an output with its display unit.
fn label_of(output: &Output, units: &ColumnUnits) -> String {
    let (name, unit) = units.of_output(output);
    label(&name, unit.text)
}

/// A plot to which the results of a grid are added chunk by chunk.
pub(crate) trait Picture {
    /// Adds the points of a chunk. `values` contains the plotted output, and `interval` the lower
    /// and the upper end of its interval. The second axis of the grid varies fastest.
    fn add(
        &mut self,
        chunk: &Chunk,
        answers: &Answers,
        values: &[f64],
        interval: Option<[&[f64]; 2]>,
    );

    /// Draws the plot and returns the bytes of the image file.
    fn draw(self: Box<Self>, title: String, is_png: bool) -> Result<Vec<u8>, ReportError>;
}

/// A plot with one curve for each value of the second axis.
pub(crate) struct CurvePlot {
    output: &'static Output,
    units: ColumnUnits,
    x: PlotAxis,
    x_unit: DisplayUnit,
    lines: Vec<Curve>,
    /// Lower and upper ends of the interval of each curve, without points if no interval is
    /// plotted.
    limits: Vec<[Curve; 2]>,
    /// Model that solved the most recent point of each curve.
    models: Vec<Option<&'static str>>,
    /// Points whose model differs from the model of the preceding point, with the names of both
    /// models.
    changes: Vec<((f64, f64), [&'static str; 2])>,
}

impl CurvePlot {
    pub(crate) fn new(
        grid: &Grid,
        output: &'static Output,
        units: ColumnUnits,
    ) -> Result<Self, Failure> {
        let (x, series) = match grid.axes() {
            [x] => (x, None),
            [x, series] => (x, Some(series)),
            _ => {
                return Err(Failure::Input(
                    "a plot of curves has one or two varied inputs; write a table and plot it instead"
                        .to_owned(),
                ));
            }
        };
        let count = series.map_or(1, GridAxis::len);
        if count > MAX_CURVES {
            return Err(Failure::Input(format!(
                "a plot has at most {MAX_CURVES} curves; reduce the {count} values of the second --vary, or \
                 draw a map with -o x.map.svg"
            )));
        }
        if grid.len() > MAX_POINTS {
            return Err(Failure::Input(format!(
                "a plot has at most {MAX_POINTS} points; reduce the {} values of --vary, \
                 or draw a map with -o x.map.svg",
                grid.len()
            )));
        }
        let name = |axis: &GridAxis, i| {
            let input = axis.key.input();
            let (words, unit) = (label(input.name, input.unit), units.of_input(axis.key));
            let words = words.split(',').next().unwrap_or_default();
            let value = axis.value(i);
            let value =
                if unit.is_own() { format_exact(value) } else { format_trimmed(unit.value(value)) };
            format!("{words} {value} {}", unit.text).trim_end().to_owned()
        };
        let lines = (0..count)
            .map(|i| Curve {
                marks: Vec::new(),
                label: series.map(|axis| name(axis, i)),
                color: i,
                stroke: Stroke::Solid,
                points: Vec::new(),
            })
            .collect();
        let limit = |color, label: Option<&str>| Curve {
            label: label.map(str::to_owned),
            ..Curve::new("", color, Stroke::Dotted, Vec::new())
        };
        // One legend entry explains the dotted lines of all curves.
        let limits = (0..count)
            .map(|i| [limit(i, (i == 0).then_some("90 % interval")), limit(i, None)])
            .collect();
        let (low, high) = (x.value(0), x.value(x.len() - 1));
        let x_unit = units.of_input(x.key);
        let (mut x, models) = (axis_of(x, &units), vec![None; count]);
        x.log |= low > 0.0 && high >= DECADES * low;
        Ok(Self { output, units, x, x_unit, lines, limits, models, changes: Vec::new() })
    }
}

impl Picture for CurvePlot {
    /// Adds points to the curves. A point without a result leaves a gap in its curve.
    fn add(
        &mut self,
        chunk: &Chunk,
        answers: &Answers,
        values: &[f64],
        interval: Option<[&[f64]; 2]>,
    ) {
        let count = self.lines.len();
        // Consecutive rows belong to different curves, so a chunk may begin with any curve.
        let first = usize::try_from(chunk.first - 1).unwrap_or(0) % count;
        for (row, (x, y)) in chunk.inputs[0].values().iter().zip(values).enumerate() {
            let line = (first + row) % count;
            self.lines[line].points.push((*x, *y));
            for (limit, ends) in self.limits[line].iter_mut().zip(interval.iter().flatten()) {
                limit.points.push((*x, ends[row]));
            }
            let model = answers.outcomes[row].model.name();
            match self.models[line].replace(model) {
                Some(former) if former != model && y.is_finite() => {
                    self.changes.push(((*x, *y), [former, model]));
                }
                _ => {}
            }
        }
    }

    fn draw(self: Box<Self>, title: String, is_png: bool) -> Result<Vec<u8>, ReportError> {
        let Self { output, units, x, x_unit, lines: mut curves, limits, changes, .. } = *self;
        let mut names: Vec<_> = changes.iter().flat_map(|(_, names)| *names).collect();
        names.sort_unstable();
        names.dedup();
        if !names.is_empty() {
            let points = changes.iter().map(|(point, _)| *point).collect();
            let label = format!("model changes: {}", names.join(" / "));
            curves.push(Curve::new(label, curves.len(), Stroke::Circles, points));
        }
        curves.extend(limits.into_iter().flatten().filter(|limit| !limit.points.is_empty()));
        let (_, y_unit) = units.of_output(output);
        for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *point = (x_unit.value(point.0), y_unit.value(point.1));
        }
        let y = PlotAxis::linear(&label_of(output, &units));
        let figure = Figure::new(["", &title, ""], [x, y], curves);
        if is_png { figure.png() } else { figure.svg().map(String::into_bytes) }
    }
}

/// The cells of a map. If an axis has more values than can be shown, only evenly spaced values are
/// drawn.
pub(crate) struct MapPlot {
    output: &'static Output,
    units: ColumnUnits,
    axes: [PlotAxis; 2],
    /// For each axis, the indices of the values that are drawn.
    places: [Vec<usize>; 2],
    values: [Vec<f64>; 2],
    /// Number of values of the second axis that are drawn.
    rows: usize,
    /// Value of the plotted output in each cell of the map.
    found: Vec<f64>,
    regions: Vec<usize>,
    models: Vec<&'static str>,
}

impl MapPlot {
    pub(crate) fn new(
        grid: &Grid,
        output: &'static Output,
        units: ColumnUnits,
    ) -> Result<Self, Failure> {
        let [x, y] = grid.axes() else {
            let text = "a map needs two varied inputs; give --vary twice";
            return Err(Failure::Input(text.to_owned()));
        };
        let places = [x, y].map(|axis| {
            let drawn = axis.len().min(MAX_CELLS);
            (0..drawn).map(|i| i * (axis.len() - 1) / (drawn - 1).max(1)).collect::<Vec<_>>()
        });
        let value = |axis: &GridAxis, places: &[usize]| {
            let unit = units.of_input(axis.key);
            places.iter().map(|place| unit.value(axis.value(*place))).collect::<Vec<_>>()
        };
        let values = [value(x, &places[0]), value(y, &places[1])];
        let count = places[0].len() * places[1].len();
        Ok(Self {
            output,
            axes: [axis_of(x, &units), axis_of(y, &units)],
            units,
            values,
            rows: y.len(),
            found: vec![f64::NAN; count],
            regions: vec![0; count],
            models: Vec::new(),
            places,
        })
    }
}

impl Picture for MapPlot {
    fn add(
        &mut self,
        chunk: &Chunk,
        answers: &Answers,
        values: &[f64],
        _interval: Option<[&[f64]; 2]>,
    ) {
        let first = usize::try_from(chunk.first - 1).unwrap_or(usize::MAX);
        for (row, value) in values.iter().enumerate() {
            let (x, y) = ((first + row) / self.rows, (first + row) % self.rows);
            let [columns, rows] = &self.places;
            let found = columns.binary_search(&x).ok().zip(rows.binary_search(&y).ok());
            let Some((column, row_of_map)) = found else { continue };
            let cell = column * rows.len() + row_of_map;
            let model = answers.outcomes[row].model.name();
            let known = self.models.iter().position(|known| *known == model);
            self.regions[cell] = known.unwrap_or_else(|| {
                self.models.push(model);
                self.models.len() - 1
            });
            self.found[cell] = *value;
        }
    }

    fn draw(self: Box<Self>, title: String, is_png: bool) -> Result<Vec<u8>, ReportError> {
        let Self {
            output, units, axes: [x, y], values: [xs, ys], mut found, regions, models, ..
        } = *self;
        let (_, unit) = units.of_output(output);
        for value in &mut found {
            *value = unit.value(*value);
        }
        let map = Map {
            title,
            x: (x, xs),
            y: (y, ys),
            label: label_of(output, &units),
            values: found,
            regions,
            names: models.into_iter().map(str::to_owned).collect(),
        };
        if is_png { map.png() } else { map.svg().map(String::into_bytes) }
    }
}
