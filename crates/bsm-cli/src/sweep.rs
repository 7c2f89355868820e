//! `bsm sweep`: a full grid, one row a point.

use std::path::{Path, PathBuf};

use bsm_batch::dataset::Points;
use bsm_batch::{Answers, Chunk, Draws, Task, Workers};
use bsm_case::units::words;
use bsm_case::{Axis as GridAxis, CaseError, Grid, Output as OutputColumn, exact};
use bsm_report::{Axis, Curve, Figure, MOST_CELLS, MOST_CURVES, Map, ReportError, Stroke};

use crate::args::SweepArgs;
use crate::failure::{Failure, note_unused};
use crate::files::{self, Output, read_scene, write_bytes};
use crate::lookup::Lookup;
use crate::stream::{Job, outputs};

/// Points of a plot: beyond, a viewer of SVG chokes.
const MOST_POINTS: usize = 100_000;

/// A varied input that grows by as much as this has a logarithmic axis.
const DECADES: f64 = 100.0;

pub(crate) fn run(args: &SweepArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let base = read_scene(&args.scene.scene, &args.scene.settings)?;
    for output in [Some(&args.table.output), args.plot.as_ref(), args.map.as_ref()] {
        files::keep(&args.scene.scene, output.map(PathBuf::as_path))?;
    }
    let in_file = |e: CaseError| Failure::scene(&args.scene.scene, &e);
    let (points, grid) = points(args)?;

    // Everything that can be told before the work: the fixed inputs, the model, the outputs.
    let settings = args.model.settings().map_err(in_file)?;
    let title = base.description.clone();
    let wants = args.plot.is_some() || args.map.is_some();
    let watched = if wants { Some(drawn(&args.plot_output)?) } else { None };
    let is_grid = matches!(points, Points::Grid(_));
    if wants && (args.table.resume || args.table.plan || !is_grid) {
        let text = "--plot and --map need all points of a grid; they do not go with --resume, --plan or --draw";
        return Err(Failure::Input(text.to_owned()));
    }
    let mut curves = match (&args.plot, watched) {
        (Some(path), Some(output)) => Some((Curves::new(&grid, output)?, Picture::of(path)?)),
        _ => None,
    };
    let mut map = match (&args.map, watched) {
        (Some(path), Some(output)) => Some((Cells::new(&grid, output)?, Picture::of(path)?)),
        _ => None,
    };
    let task = Task::over_grid(base, settings, outputs(&args.table)?, watched, &grid);
    let task = task.map_err(in_file)?;
    let model = task.settings.model.name();
    // Of a long description what it is, not the values, which may vary.
    let head = |text: String| text.split([':', ',']).next().unwrap_or_default().to_owned();
    let title = title.map_or_else(String::new, |text| format!("{}: ", head(text)));
    let title = format!("{title}{}, model {model}", args.plot_output.replace('_', " "));
    note_unused(task.base.given() | grid.varied());
    if let Some(lookup) = Lookup::of(&args.table.output) {
        if wants || args.table.resume || args.table.plan || !is_grid {
            let text = "--plot, --map, --resume, --plan and --draw do not go with a lookup";
            return Err(Failure::Input(text.to_owned()));
        }
        return lookup.write(&args.table.output, &task, &grid, workers);
    }
    let job = Job::new(task, &args.table);
    let mut source = points.open()?;
    let solved = job.run(source.as_mut(), &points, workers, |chunk, answers, values| {
        if let Some((curves, _)) = &mut curves {
            curves.add(chunk, answers, values);
        }
        if let Some((map, _)) = &mut map {
            map.add(chunk, answers, values);
        }
    });
    if !matches!(solved, Ok(()) | Err(Failure::Unsolved)) {
        return solved;
    }
    if let Some((curves, picture)) = curves {
        let figure = curves.figure(title.clone());
        picture.write(|| figure.svg(), || figure.png())?;
    }
    if let Some((cells, picture)) = map {
        let map = cells.map(title);
        picture.write(|| map.svg(), || map.png())?;
    }
    solved
}

/// The points, and the grid that a task for them is made for: its own, or that of the ends of random points.
fn points(args: &SweepArgs) -> Result<(Points, Grid), Failure> {
    let usage = |what: &'static str| move |e: CaseError| Failure::input(what, &e);
    if let Some(count) = args.draws {
        let draws = Draws::parse(args.seed, count, &args.draw).map_err(usage("--draw"))?;
        let corners = draws.corners().map_err(usage("--draw"))?;
        return Ok((Points::Draws(draws), corners));
    }
    let grid = Grid::parse(&args.vary).map_err(usage("--vary"))?;
    Ok((Points::Grid(grid.clone()), grid))
}

/// The output of a plot.
fn drawn(name: &str) -> Result<&'static OutputColumn, Failure> {
    let named = OutputColumn::named(name).filter(|o| o.json_type == "number");
    named.ok_or_else(|| {
        let nearest = OutputColumn::nearest(name);
        Failure::Input(format!(
            "--plot-output: no numeric output is named `{name}`{}; `bsm schema output` lists them",
            nearest.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
        ))
    })
}

/// A file of a picture that was begun.
struct Picture<'a> {
    path: &'a Path,
    out: Output,
    is_png: bool,
}

impl<'a> Picture<'a> {
    fn of(path: &'a Path) -> Result<Self, Failure> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        if ending != "svg" && ending != "png" {
            let path = path.display();
            return Err(Failure::Input(format!("{path}: a picture must end in .svg or .png")));
        }
        Ok(Self { path, out: Output::create(path)?, is_png: ending == "png" })
    }

    fn write(
        self,
        svg: impl FnOnce() -> String,
        png: impl FnOnce() -> Result<Vec<u8>, ReportError>,
    ) -> Result<(), Failure> {
        let bytes = if self.is_png { png()? } else { svg().into_bytes() };
        write_bytes(self.out, self.path, &bytes)
    }
}

/// A quantity and its unit.
fn label(axis: &GridAxis) -> Axis {
    let input = axis.key.input();
    let label = words(input.name, input.unit);
    if axis.is_log() { Axis::log(&label) } else { Axis::linear(&label) }
}

/// Points of the plot: one curve per value of the second axis.
struct Curves {
    output: &'static OutputColumn,
    x: Axis,
    lines: Vec<Curve>,
    /// The model of the last point of each line.
    models: Vec<Option<&'static str>>,
    /// Where the model is another one than at the point before, and both names.
    changes: Vec<((f64, f64), [&'static str; 2])>,
}

impl Curves {
    fn new(grid: &Grid, output: &'static OutputColumn) -> Result<Self, Failure> {
        let (x, series) = match grid.axes() {
            [x] => (x, None),
            [x, series] => (x, Some(series)),
            _ => {
                return Err(Failure::Input(
                    "--plot draws one or two varied inputs; write the table and plot from it"
                        .to_owned(),
                ));
            }
        };
        let count = series.map_or(1, GridAxis::len);
        if count > MOST_CURVES {
            return Err(Failure::Input(format!(
                "--plot draws at most {MOST_CURVES} lines; give the second --vary fewer than {count} values, or \
                 draw a --map"
            )));
        }
        if grid.len() > MOST_POINTS {
            return Err(Failure::Input(format!(
                "--plot draws at most {MOST_POINTS} points, and holds them in memory; give --vary fewer \
                 than {} values, or draw a --map",
                grid.len()
            )));
        }
        let name = |axis: &GridAxis, i| {
            let input = axis.key.input();
            let (words, unit) = (words(input.name, input.unit), input.unit);
            let words = words.split(',').next().unwrap_or_default();
            format!("{words} {} {unit}", exact(axis.value(i))).trim_end().to_owned()
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
        let (low, high) = (x.value(0), x.value(x.len() - 1));
        let (mut x, models) = (label(x), vec![None; count]);
        x.log |= low > 0.0 && high >= DECADES * low;
        Ok(Self { output, x, lines, models, changes: Vec::new() })
    }

    /// Adds the points of a chunk, of which the second axis runs fastest; one without a result
    /// leaves a gap.
    fn add(&mut self, chunk: &Chunk, answers: &Answers, values: &[f64]) {
        let count = self.lines.len();
        // The first row of a chunk may belong to any line.
        let first = usize::try_from(chunk.first - 1).unwrap_or(0) % count;
        for (row, (x, y)) in chunk.inputs[0].values().iter().zip(values).enumerate() {
            let line = (first + row) % count;
            self.lines[line].points.push((*x, *y));
            let model = answers.verdicts[row].model.name();
            match self.models[line].replace(model) {
                Some(former) if former != model && y.is_finite() => {
                    self.changes.push(((*x, *y), [former, model]));
                }
                _ => {}
            }
        }
    }

    fn figure(self, title: String) -> Figure {
        let Self { output, x, lines: mut curves, changes, .. } = self;
        let mut names: Vec<_> = changes.iter().flat_map(|(_, names)| *names).collect();
        names.sort_unstable();
        names.dedup();
        if !names.is_empty() {
            let points = changes.iter().map(|(point, _)| *point).collect();
            let label = format!("model changes: {}", names.join(" / "));
            curves.push(Curve::new(label, curves.len(), Stroke::Circles, points));
        }
        let y = Axis::linear(&words(output.name, output.unit));
        Figure { key: String::new(), title, caption: String::new(), x, y, curves }
    }
}

/// Cells of the map: of long axes so many values as are seen, evenly.
struct Cells {
    output: &'static OutputColumn,
    axes: [Axis; 2],
    /// Places of the values of each axis that are drawn.
    places: [Vec<usize>; 2],
    values: [Vec<f64>; 2],
    /// Values of the second axis.
    rows: usize,
    /// Values of the output.
    found: Vec<f64>,
    regions: Vec<usize>,
    models: Vec<&'static str>,
}

impl Cells {
    fn new(grid: &Grid, output: &'static OutputColumn) -> Result<Self, Failure> {
        let [x, y] = grid.axes() else {
            let text = "--map draws two varied inputs; give --vary twice";
            return Err(Failure::Input(text.to_owned()));
        };
        let places = [x, y].map(|axis| {
            let drawn = axis.len().min(MOST_CELLS);
            (0..drawn).map(|i| i * (axis.len() - 1) / (drawn - 1).max(1)).collect::<Vec<_>>()
        });
        let value = |axis: &GridAxis, places: &[usize]| {
            places.iter().map(|place| axis.value(*place)).collect::<Vec<_>>()
        };
        let values = [value(x, &places[0]), value(y, &places[1])];
        let count = places[0].len() * places[1].len();
        Ok(Self {
            output,
            axes: [label(x), label(y)],
            values,
            rows: y.len(),
            found: vec![f64::NAN; count],
            regions: vec![0; count],
            models: Vec::new(),
            places,
        })
    }

    fn add(&mut self, chunk: &Chunk, answers: &Answers, values: &[f64]) {
        let first = usize::try_from(chunk.first - 1).unwrap_or(usize::MAX);
        for (row, value) in values.iter().enumerate() {
            let (x, y) = ((first + row) / self.rows, (first + row) % self.rows);
            let [columns, rows] = &self.places;
            let found = columns.binary_search(&x).ok().zip(rows.binary_search(&y).ok());
            let Some((column, row_of_map)) = found else { continue };
            let cell = column * rows.len() + row_of_map;
            let model = answers.verdicts[row].model.name();
            let known = self.models.iter().position(|known| *known == model);
            self.regions[cell] = known.unwrap_or_else(|| {
                self.models.push(model);
                self.models.len() - 1
            });
            self.found[cell] = *value;
        }
    }

    fn map(self, title: String) -> Map {
        let Self { output, axes: [x, y], values: [xs, ys], found, regions, models, .. } = self;
        Map {
            title,
            x: (x, xs),
            y: (y, ys),
            label: words(output.name, output.unit),
            values: found,
            regions,
            names: models.into_iter().map(str::to_owned).collect(),
        }
    }
}
