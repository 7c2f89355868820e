//! `bsm sweep`: a full grid, one row a point.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use bsm_case::{
    Axis, CaseError, Cell, Grid, ModelChoice, OUTPUTS, Output as OutputColumn, Record, Scene,
    Settings,
};
use bsm_dyn::{ModelWorkspace, Status};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Map, Value, json};

use crate::args::SweepArgs;
use crate::failure::{Failure, warn};
use crate::files::{Output, read_scene};
use crate::plot::{self, Curve, Frame, Stroke};

pub(crate) fn run(args: &SweepArgs) -> Result<(), Failure> {
    let base = read_scene(&args.scene.scene, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(&args.scene.scene, &e);
    let usage = |e: CaseError| Failure::Input(format!("--vary: {e}"));
    let axes: Vec<_> =
        args.vary.iter().map(|v| Axis::parse(v)).collect::<Result<_, _>>().map_err(usage)?;
    let grid = Grid::new(axes).map_err(usage)?;

    // Everything that can be told before the work: the fixed inputs, the model, the outputs.
    grid.fixed(&base).check().map_err(in_file)?;
    let mut settings = args.model.settings().map_err(in_file)?;
    // One choice for all rows, even if it does not cover the first or last point.
    let [first, last] =
        [0, grid.len() - 1].map(|i| grid.scene(&base, &grid.point(i)).choose(settings.model));
    settings.model = match (first, last) {
        (Ok(ModelChoice::Fixed(first)), Ok(ModelChoice::Fixed(last))) => {
            ModelChoice::Fixed(first.max(last))
        }
        (Ok(_), Ok(_)) => ModelChoice::Auto,
        (Ok(model), Err(_)) | (Err(_), Ok(model)) => model,
        (Err(error), Err(_)) => return Err(in_file(error)),
    };
    let mut plot = match &args.plot {
        Some(path) => {
            let curves = Curves::new(&grid, &args.plot_output, path)?;
            Some((curves, Output::create(path)?, path))
        }
        None => None,
    };
    let mut sink = Sink::create(&args.output, &grid)?;

    let bar = progress(grid.len(), args.quiet);
    let mut work = ModelWorkspace::default();
    let mut failed = 0_usize;
    for i in 0..grid.len() {
        let point = grid.point(i);
        let record = solve(&grid.scene(&base, &point), &settings, &mut work);
        failed += usize::from(record.status() != Status::Converged);
        if let Some((curves, ..)) = &mut plot {
            curves.add(i, point[0], &record);
        }
        sink.row(&grid, &point, &record)?;
        if i % 1024 == 0 {
            bar.set_position(i as u64);
        }
    }
    bar.finish_and_clear();
    if let Some((curves, mut out, path)) = plot {
        let svg = curves.render(base.description.as_deref(), settings.model);
        out.write_all(svg.as_bytes()).map_err(|e| Output::failure(path, &e))?;
        out.complete()?;
    }
    sink.complete()?;

    let total = grid.len();
    if failed > 0 {
        warn("note", &format!("{failed} of {total} points have no result; their rows say why"));
        if args.strict {
            return Err(Failure::Unsolved);
        }
    }
    Ok(())
}

fn solve(scene: &Scene, settings: &Settings, work: &mut ModelWorkspace) -> Record {
    match scene.problem(settings) {
        Ok(problem) => Record::new(problem.solve(work)),
        Err(error) => Record::invalid(settings.model, &error),
    }
}

/// A bar on a terminal, nothing elsewhere.
fn progress(total: usize, quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} points, {per_sec}, {eta} left");
    ProgressBar::new(total as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Where rows go, and in which form.
struct Sink {
    path: PathBuf,
    form: Form,
}

enum Form {
    Csv(Box<csv::Writer<Output>>),
    Lines(Output),
}

impl Sink {
    fn create(path: &Path, grid: &Grid) -> Result<Self, Failure> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let stdout = path.as_os_str() == "-";
        let lines = match ending.as_deref() {
            Some("jsonl" | "ndjson") => true,
            Some("csv") => false,
            _ if stdout => false,
            _ => {
                return Err(Failure::Input(format!(
                    "--output {}: the file must end in .csv or .jsonl, or be - for CSV on \
                     standard output",
                    path.display()
                )));
            }
        };
        let out = Output::create(path)?;
        let form = if lines {
            Form::Lines(out)
        } else {
            Form::Csv(Box::new(csv::Writer::from_writer(out)))
        };
        let mut sink = Self { path: path.to_owned(), form };
        let names = grid.axes().iter().map(|axis| axis.name);
        let header =
            names.chain(["model", "status", "message"]).chain(OUTPUTS.iter().map(|o| o.name));
        if let Form::Csv(writer) = &mut sink.form {
            let written = writer.write_record(header);
            sink.check(written)?;
        }
        Ok(sink)
    }

    fn row(&mut self, grid: &Grid, point: &[f64], record: &Record) -> Result<(), Failure> {
        let written = match &mut self.form {
            Form::Csv(writer) => {
                let words = [
                    record.model().name().to_owned(),
                    record.status_name().to_owned(),
                    record.message().unwrap_or_default().to_owned(),
                ];
                let cells = point.iter().map(f64::to_string).chain(words);
                writer.write_record(
                    cells.chain(OUTPUTS.iter().map(|output| text(record.cell(output)))),
                )
            }
            Form::Lines(out) => {
                let mut line: Map<String, Value> = Map::new();
                for (axis, value) in grid.axes().iter().zip(point) {
                    line.insert(axis.name.to_owned(), json!(value));
                }
                line.extend(record.to_json());
                writeln!(out, "{}", Value::Object(line)).map_err(csv::Error::from)
            }
        };
        self.check(written)
    }

    fn check(&self, written: Result<(), csv::Error>) -> Result<(), Failure> {
        written.map_err(|e| match e.into_kind() {
            csv::ErrorKind::Io(e) => Output::failure(&self.path, &e),
            other => Failure::Files(format!("cannot write CSV: {other:?}")),
        })
    }

    fn complete(self) -> Result<(), Failure> {
        match self.form {
            Form::Csv(writer) => {
                writer.into_inner().map_err(|e| Output::failure(&self.path, e.error()))?.complete()
            }
            Form::Lines(out) => out.complete(),
        }
    }
}

/// A value in a CSV cell; what is not there is empty.
fn text(cell: Option<Cell>) -> String {
    match cell {
        None => String::new(),
        Some(Cell::Number(x)) => json!(x).to_string(),
        Some(Cell::Count(n)) => n.to_string(),
        Some(Cell::Flag(b)) => b.to_string(),
    }
}

/// Points of the plot: one curve per value of the second axis.
struct Curves {
    output: &'static OutputColumn,
    x_name: &'static str,
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
        let output = OutputColumn::named(output).filter(|o| o.json_type == "number").ok_or_else(|| {
            Failure::Input(format!(
                "--plot-output: no numeric output is named `{output}`; `bsm schema output` lists them"
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
        let count = series.map_or(1, Axis::len);
        if count > plot::MOST_CURVES {
            return Err(Failure::Input(format!(
                "--plot draws at most {} lines; give the second --vary fewer than {count} values",
                plot::MOST_CURVES
            )));
        }
        let lines = (0..count)
            .map(|i| Curve {
                label: series.map(|axis| format!("{} = {}", axis.name, axis.value(i))),
                color: i,
                stroke: Stroke::Solid,
                points: Vec::new(),
            })
            .collect();
        Ok(Self { output, x_name: x.name, lines })
    }

    /// Adds grid point `i`, of which the second axis runs fastest; one without a result leaves a
    /// gap.
    fn add(&mut self, i: usize, x: f64, record: &Record) {
        let line = i % self.lines.len();
        let y = record.number(self.output.name).unwrap_or(f64::NAN);
        self.lines[line].points.push((x, y));
    }

    fn render(&self, title: Option<&str>, model: ModelChoice) -> String {
        let title = title.map_or_else(
            || format!("model {}", model.name()),
            |t| format!("{t} ({})", model.name()),
        );
        let (x_label, y_label) = (self.x_name, self.output.name);
        plot::lines(&Frame { title: &title, x_label, y_label, log_x: false }, &self.lines)
    }
}
