//! `bsm sweep`: solves a grid, random points or the rows of a table, with one result row per point.

use std::path::{Path, PathBuf};

use bsm_batch::dataset::Points;
use bsm_batch::{ColumnUnits, RandomPoints, TableFormat, Task, Workers};
use bsm_case::{AnalysisKind, Case, CaseError, Grid, InputSet, Output, OutputType, Settings};

use crate::args::SweepArgs;
use crate::console::print_message;
use crate::failure::{Failure, note_unused};
use crate::files::{InputFiles, OutputFile, ending_of, is_stdout, read_case, write_bytes};
use crate::lookup::Lookup;
use crate::pictures::{CurvePlot, MapPlot, Picture};
use crate::table_job::{Job, is_folder, open, outputs};

pub(crate) fn run(args: &SweepArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let case = args.case.as_deref();
    let base = read_case(case, &args.units.added_to(&args.settings))?;
    let units = ColumnUnits::new(base.display_units(), args.columns.as_deref());
    let path = case.or(args.points.as_deref()).unwrap_or(Path::new("--set"));
    let files = Files::of(args)?;
    let in_file = |e: CaseError| Failure::case(path, &e);
    let settings = args.model.settings()?;
    let chosen = outputs(args.columns.as_deref())?;
    if let Some(points) = &args.points {
        return sweep_table(args, points, (base, settings), (chosen, units), &files, workers);
    }
    args.table.only_with("--points")?;
    let (points, grid) = points_of(args)?;
    let is_grid = matches!(points, Points::Grid(_));

    // The combination of options, the fixed inputs, the model and the outputs are checked before
    // the first point is solved.
    let picture = files.lines.or(files.map);
    if picture.or(files.lookup).is_some() && (args.resume || args.plan || !is_grid) {
        let text = "plots and lookup tables need all points of a grid; they cannot be combined with --resume, --plan or --draw";
        return Err(Failure::Input(text.to_owned()));
    }
    let watched = picture.map(|path| plotted_output(path, args.columns.as_deref())).transpose()?;
    let interval = files.lines.and(watched).and_then(|output| interval_of(output, &chosen));
    if let Some((path, output)) = picture.zip(watched) {
        note_columns_not_plotted(path, output, args.columns.as_deref(), interval.is_some());
    }
    let mut pictures: Vec<(&Path, OutputFile, Box<dyn Picture>)> = Vec::new();
    if let Some((path, output)) = files.lines.zip(watched) {
        let curves = Box::new(CurvePlot::new(&grid, output, units.clone())?);
        pictures.push((path, OutputFile::create(path)?, curves));
    }
    if let Some((path, output)) = files.map.zip(watched) {
        let map_plot = Box::new(MapPlot::new(&grid, output, units.clone())?);
        pictures.push((path, OutputFile::create(path)?, map_plot));
    }
    let title = base.description.clone();
    let chosen = match watched {
        Some(output) if files.table.is_none() => {
            std::iter::once(output).chain(interval.into_iter().flatten()).collect()
        }
        _ => chosen,
    };
    let task = Task::over_grid(base, settings, chosen, watched, &grid).map_err(in_file)?;
    note_unused_inputs(&task, grid.varied());
    note_groove(&task);
    if let Some(path) = files.lookup {
        require_metric_units(&units, path, "a lookup table")?;
        return Lookup::of(path).write(path, &task, &grid, workers);
    }
    let model = task.settings.model.name();
    // Only the beginning of the case description becomes part of the title, because the rest may
    // contain values of varied inputs.
    let head = |text: String| text.split([':', ',']).next().unwrap_or_default().to_owned();
    let title = title.map_or_else(String::new, |text| format!("{}: ", head(text)));
    let of = watched.map_or_else(String::new, |output| output.name.replace('_', " "));
    let title = format!("{title}{of}, model {model}");
    let job = files.job((task, units), args, args.table.output_format())?;
    let column_of = |end: &Output| job.task.outputs.iter().position(|o| o.name == end.name);
    let columns = interval.and_then(|[low, high]| Some([column_of(low)?, column_of(high)?]));
    let mut source = points.open()?;
    let solved = job.run(source.as_mut(), &points, workers, |chunk, answers, values| {
        let ends = columns.map(|columns| columns.map(|column| answers.columns[column].as_slice()));
        for (.., picture) in &mut pictures {
            picture.add(chunk, answers, values, ends);
        }
    });
    if !matches!(solved, Ok(()) | Err(Failure::Unsolved)) {
        return solved;
    }
    for (path, out, picture) in pictures {
        let is_png = ending_of("-o", path, &["svg", "png"])? == "png";
        write_bytes(out, path, &picture.draw(title.clone(), is_png)?)?;
    }
    solved
}

/// Solves the rows of a table. The table of results has one row per input row, in the same order.
fn sweep_table(
    args: &SweepArgs,
    path: &Path,
    (base, settings): (Case, Settings),
    (outputs, units): (Vec<&'static Output>, ColumnUnits),
    files: &Files<'_>,
    workers: &Workers<'_>,
) -> Result<(), Failure> {
    if files.lines.or(files.map).or(files.lookup).is_some() {
        let text = "plots and lookup tables need all points of a grid; they cannot be combined with --points";
        return Err(Failure::Input(text.to_owned()));
    }
    let once = is_stdout(path) || path.metadata().is_ok_and(|points| !points.is_file());
    if once && files.table.is_some_and(is_folder) {
        let name = if is_stdout(path) { "standard input".into() } else { path.to_string_lossy() };
        let text = format!(
            "{name}: the points for a folder of parts must come from a file, because the points are read twice"
        );
        return Err(Failure::Input(text));
    }
    let table_format = args.table.format()?;
    let output_format = args.table.output_format();
    let mut source = open(path, &args.keep, &table_format)?;
    let task = Task::over_table(base, settings, outputs, source.columns()).map_err(|error| {
        let path = path.display();
        Failure::Input(format!(
            "{path}: {error}; give the inputs as columns, in a case or with --set"
        ))
    })?;
    note_unused_inputs(&task, source.columns().set());
    if let Some(note) = source.columns().ignored_note() {
        print_message("note", &note);
    }
    note_groove(&task);
    let points = Points::Table { path: path.to_owned(), keep: args.keep.clone(), table_format };
    let job = files.job((task, units), args, output_format)?;
    job.run(source.as_mut(), &points, workers, |_, _, _| {}).map_err(|e| match e {
        Failure::Table(error) => Failure::table(path, &error),
        other => other,
    })
}

/// Prints a note about inputs that no ball model uses. The note is omitted if a requested output
/// describes the nut or the axis, because such outputs may depend on these inputs.
fn note_unused_inputs(task: &Task, columns: InputSet) {
    use AnalysisKind::{Axis, Nut, Ratings, Warm};
    let is_beyond_the_ball =
        |output: &&Output| matches!(output.analysis(), Some(Nut | Ratings | Axis | Warm));
    if !task.outputs.iter().chain(&task.watched).any(is_beyond_the_ball) {
        note_unused(task.base.given().union(columns));
    }
}

/// Prints a note if the groove geometry is estimated.
fn note_groove(task: &Task) {
    if let Some(note) = task.groove_note() {
        print_message("note", &note);
    }
}

/// File extensions that `bsm sweep` can write.
const ENDINGS: [&str; 11] = [
    "csv", "jsonl", "parquet", "xlsx", "txt", "grid.csv", "svg", "png", "map.svg", "map.png",
    "json",
];

/// Requested output files, with at most one file of each kind.
#[derive(Default)]
struct Files<'a> {
    /// File to which the table of results is written.
    table: Option<&'a Path>,
    /// JSON file that describes the origin of the table.
    about: Option<&'a Path>,
    /// File to which a lookup table for a drive model is written.
    lookup: Option<&'a Path>,
    lines: Option<&'a Path>,
    map: Option<&'a Path>,
}

impl<'a> Files<'a> {
    fn of(args: &'a SweepArgs) -> Result<Self, Failure> {
        let mut files = Self::default();
        let refused =
            |path: &Path, why: &str| Failure::Input(format!("-o {}: {why}", path.display()));
        let outputs = || args.output.iter().map(PathBuf::as_path);
        InputFiles::of([args.case.as_deref(), args.table.names.as_deref()]).check(outputs())?;
        for path in &args.output {
            let slot = match ending_of("-o", path, &ENDINGS) {
                Ok("json") => &mut files.about,
                Ok("txt" | "grid.csv") => &mut files.lookup,
                Ok("svg" | "png") => &mut files.lines,
                Ok("map.svg" | "map.png") => &mut files.map,
                Err(refused) if !is_stdout(path) && !is_folder(path) => return Err(refused),
                _ => &mut files.table,
            };
            if slot.replace(path.as_path()).is_some() {
                return Err(refused(
                    path,
                    "a run writes at most one table, one plot of curves and one map",
                ));
            }
        }
        // The table of results may replace the table of points, because the points are read
        // completely before the temporary file with the results is renamed.
        let others = outputs().filter(|path| files.table != Some(*path));
        InputFiles::of([args.points.as_deref()]).check(others)?;
        if let Some(path) = files.lookup.filter(|_| args.output.len() > 1) {
            return Err(refused(
                path,
                "a lookup table cannot be written together with other files",
            ));
        }
        let in_file = |path: &&Path| {
            !is_stdout(path) && !is_folder(path) && (path.is_file() || !path.exists())
        };
        if let Some(path) =
            files.about.filter(|_| !files.table.is_some_and(|table| in_file(&table)))
        {
            let why = "a .json file describes the origin of a table in a file, but no other -o names such a table. Rows in JSON are \
                       written as .jsonl, and a folder contains its plan.json";
            return Err(refused(path, why));
        }
        if let Some(name) =
            [(args.plan, "--plan"), (args.rows_per_part.is_some(), "--rows-per-part")]
                .into_iter()
                .find_map(|(given, name)| given.then_some(name))
                .filter(|_| !files.table.is_some_and(is_folder))
        {
            return Err(Failure::Input(format!("{name} applies only to folders, such as -o map/")));
        }
        if args.resume && !files.table.is_some_and(is_folder) {
            let path = files.table.unwrap_or(&args.output[0]);
            let (name, folder) = if is_stdout(path) {
                ("standard output".into(), Path::new("map"))
            } else {
                (path.to_string_lossy(), path)
            };
            return Err(Failure::Input(format!(
                "--resume cannot continue {name}: a single table is only written when it is complete, so an \
                 interrupted run leaves no results; write a folder of parts with -o {}/, which --resume \
                 can continue",
                folder.with_extension("").display()
            )));
        }
        Ok(files)
    }

    fn job(
        &self,
        (task, units): (Task, ColumnUnits),
        args: &'a SweepArgs,
        table_format: TableFormat,
    ) -> Result<Job<'a>, Failure> {
        if let Some(folder) = self.table.filter(|table| is_folder(table)) {
            require_metric_units(&units, folder, "a folder of parts")?;
        }
        Ok(Job { task, args, table: self.table, about: self.about, table_format, units })
    }
}

/// Rejects display units for files whose readers expect metric units.
fn require_metric_units(units: &ColumnUnits, path: &Path, what: &str) -> Result<(), Failure> {
    if units.are_own() {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "-o {}: {what} has metric units; use --units metric and metric names in --columns, or write a .csv table",
        path.display()
    )))
}

/// Returns the points and the grid with which the task is checked. For random points, this grid
/// consists of their bounds and means.
fn points_of(args: &SweepArgs) -> Result<(Points, Grid), Failure> {
    let usage = |what: &'static str| move |e: CaseError| Failure::input(what, &e);
    if let Some(count) = args.samples {
        let draws = RandomPoints::parse(args.seed, count, &args.draw).map_err(usage("--draw"))?;
        let corners = draws.corners().map_err(usage("--draw"))?;
        return Ok((Points::Random(draws), corners));
    }
    let grid = Grid::parse(&args.vary).map_err(usage("--vary"))?;
    Ok((Points::Grid(grid.clone()), grid))
}

/// Returns the output that a plot shows, which is the first requested column.
fn plotted_output(path: &Path, columns: Option<&[String]>) -> Result<&'static Output, Failure> {
    let name = columns.and_then(|columns| columns.first()).map_or("efficiency", String::as_str);
    let found = Output::in_unit(name).map(|(output, _)| output);
    found.filter(|output| output.output_type == OutputType::Number).ok_or_else(|| {
        Failure::Input(format!(
            "-o {}: a plot shows the first output of --columns, but {name} is not a number; put a number first, such as \
             --columns efficiency,{name}",
            path.display()
        ))
    })
}

/// Prints a note if --columns names outputs that a plot does not show.
///
/// * `has_interval`: true if the plot also shows both ends of the interval of `output`.
fn note_columns_not_plotted(
    path: &Path,
    output: &Output,
    columns: Option<&[String]>,
    has_interval: bool,
) {
    let plotted = if has_interval { 3 } else { 1 };
    if columns.is_some_and(|columns| columns.len() > plotted) {
        let name = output.name;
        let with = if has_interval { " with its interval" } else { "" };
        let text =
            format!("{} shows only {name}{with}, the first of the --columns", path.display());
        print_message("note", &text);
    }
}

/// Returns the lower and the upper end of the 90 % interval of an output, if the requested outputs
/// contain both ends. The interval is due to uncertain friction (`band_X_low`) or to an estimated
/// groove (`X_low`).
fn interval_of(output: &Output, requested: &[&'static Output]) -> Option<[&'static Output; 2]> {
    let ends = Output::end_names(output.name, output.unit);
    ["band_", ""].into_iter().find_map(|cause| {
        let end = |name: &String| {
            let name = format!("{cause}{name}");
            requested.iter().copied().find(|end| end.name == name)
        };
        let [low, high] = &ends;
        Some([end(low)?, end(high)?])
    })
}
