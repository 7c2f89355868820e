//! `bsm sweep`: a full grid, one row a point.

use std::io::Write;
use std::path::{Path, PathBuf};

use bsm_batch::dataset::Points;
use bsm_batch::{Chunk, GridSource, Task, Workers};
use bsm_case::{Axis as GridAxis, CaseError, Grid, ModelChoice, Output as OutputColumn, exact};
use bsm_report::{Axis, Curve, Figure, MOST_CURVES, Stroke};

use crate::args::SweepArgs;
use crate::failure::{Failure, note_unused};
use crate::files::{self, Output, read_scene};
use crate::stream::{Job, outputs};

/// Points of a plot: beyond, a viewer of SVG chokes.
const MOST_POINTS: usize = 100_000;

/// A varied input that grows by as much as this has a logarithmic axis.
const DECADES: f64 = 100.0;

pub(crate) fn run(args: &SweepArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let base = read_scene(&args.scene.scene, &args.scene.settings)?;
    for output in [Some(&args.table.output), args.plot.as_ref()] {
        files::keep(&args.scene.scene, output.map(PathBuf::as_path))?;
    }
    let in_file = |e: CaseError| Failure::scene(&args.scene.scene, &e);
    let usage = |e: CaseError| Failure::Input(format!("--vary: {e}"));
    let axes: Vec<_> =
        args.vary.iter().map(|v| GridAxis::parse(v)).collect::<Result<_, _>>().map_err(usage)?;
    let grid = Grid::new(axes).map_err(usage)?;

    // Everything that can be told before the work: the fixed inputs, the model, the outputs.
    let settings = args.model.settings().map_err(in_file)?;
    let description = base.description.clone();
    let curves = match &args.plot {
        Some(path) => Some((Curves::new(&grid, &args.plot_output, path)?, path)),
        None => None,
    };
    let watched = curves.as_ref().map(|(curves, _)| curves.output);
    let task = Task::over_grid(base, settings, outputs(&args.table)?, watched, &grid);
    let task = task.map_err(in_file)?;
    let model = task.settings.model;
    note_unused(task.base.given() | grid.varied());
    let mut plot = match curves {
        Some((curves, path)) => Some((curves, Output::create(path)?, path)),
        None => None,
    };
    let job = Job::new(task, &args.table);
    if plot.is_some() && args.table.resume {
        let text = "--plot needs all points; it does not go with --resume";
        return Err(Failure::Input(text.to_owned()));
    }
    let mut source = GridSource::new(grid.clone());
    let solved = job.run(&mut source, &Points::Grid(grid), workers, |chunk, values| {
        if let Some((curves, ..)) = &mut plot {
            curves.add(chunk, values);
        }
    });
    if !matches!(solved, Ok(()) | Err(Failure::Unsolved)) {
        return solved;
    }
    if let Some((curves, mut out, path)) = plot {
        let svg = curves.render(description.as_deref(), model);
        out.write_all(svg.as_bytes()).map_err(|e| Output::failure(path, &e))?;
        out.complete()?;
    }
    solved
}

/// Points of the plot: one curve per value of the second axis.
struct Curves {
    output: &'static OutputColumn,
    x_name: &'static str,
    log_x: bool,
    lines: Vec<Curve>,
}

impl Curves {
    fn new(grid: &Grid, output: &str, path: &Path) -> Result<Self, Failure> {
        let svg = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
        if !svg {
            return Err(Failure::Input(format!(
                "--plot {}: the file must end in .svg",
                path.display()
            )));
        }
        let named = OutputColumn::named(output).filter(|o| o.json_type == "number");
        let output = named.ok_or_else(|| {
            let nearest = OutputColumn::nearest(output);
            Failure::Input(format!(
                "--plot-output: no numeric output is named `{output}`{}; `bsm schema output` lists them",
                nearest.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
            ))
        })?;
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
                "--plot draws at most {MOST_CURVES} lines; give the second --vary fewer than {count} values"
            )));
        }
        if grid.len() > MOST_POINTS {
            return Err(Failure::Input(format!(
                "--plot draws at most {MOST_POINTS} points, and holds them in memory; give --vary fewer \
                 than {} values",
                grid.len()
            )));
        }
        let lines = (0..count)
            .map(|i| Curve {
                marks: Vec::new(),
                label: series.map(|axis| format!("{} = {}", axis.key.name(), exact(axis.value(i)))),
                color: i,
                stroke: Stroke::Solid,
                points: Vec::new(),
            })
            .collect();
        let (low, high) = (x.value(0), x.value(x.len() - 1));
        let log_x = low > 0.0 && high >= DECADES * low;
        Ok(Self { output, x_name: x.key.name(), log_x, lines })
    }

    /// Adds the points of a chunk, of which the second axis runs fastest; one without a result
    /// leaves a gap.
    fn add(&mut self, chunk: &Chunk, values: &[f64]) {
        let count = self.lines.len();
        // The first row of a chunk may belong to any line.
        let first = usize::try_from(chunk.first - 1).unwrap_or(0) % count;
        for (row, (x, y)) in chunk.inputs[0].values().iter().zip(values).enumerate() {
            self.lines[(first + row) % count].points.push((*x, *y));
        }
    }

    fn render(&self, title: Option<&str>, model: ModelChoice) -> String {
        let title = title.map_or_else(
            || format!("model {}", model.name()),
            |t| format!("{t} ({})", model.name()),
        );
        let figure = Figure {
            key: String::new(),
            title,
            caption: String::new(),
            x: Axis { log: self.log_x, ..Axis::linear(self.x_name) },
            y: Axis::linear(self.output.name),
            curves: self.lines.clone(),
        };
        figure.svg()
    }
}
