//! Fuzz targets, and the properties that they check.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::time::{Duration, Instant};

use allocation_counter::measure;
use bsm_batch::{
    AnswerSink, Answers, CsvSource, Format, JsonSource, ParquetSource, Source, TableError,
    TableFormat, TableSink, Task, silence_caught_panics,
};
use bsm_case::{
    Case, Catalog, Condition, DesignReport, Fit, Grid, GridAxis, ListColumn, NutProblem,
    RequirementFile, Row, Samples, candidate_json,
};
use bsm_dyn::Model;
use bytes::Bytes;

use crate::solve::{BASES, everything};

/// A fuzz target, which is a function that is called with arbitrary bytes.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Name of the target, which is also the name of its folder in the corpus.
    pub name: &'static str,
    /// Folder and file extension of the examples that are part of the corpus.
    examples: Option<(&'static str, &'static str)>,
    run: fn(&[u8]),
}

/// All fuzz targets.
pub const TARGETS: [Target; 9] = [
    Target { name: "case", examples: Some(("", "json")), run: case },
    Target { name: "nut", examples: Some(("", "json")), run: nut },
    Target { name: "solve", examples: None, run: solve },
    Target { name: "words", examples: None, run: words },
    Target { name: "csv", examples: None, run: csv },
    Target { name: "json-lines", examples: None, run: json_lines },
    Target { name: "parquet", examples: None, run: parquet },
    Target { name: "requirement", examples: Some(("requirements", "json")), run: requirement },
    Target { name: "catalog", examples: None, run: catalog },
];

/// Maximum time for an input. The slowest input of the corpus has a lead angle and a contact angle
/// of almost 90 deg. This input takes 2.3 s in a release build, because model traction starts twice
/// from each of its starting points. With debug assertions on a busy machine, this input takes ten
/// times as long.
const TIME_LIMIT: Duration = Duration::from_secs(60);

/// Maximum memory for an input \[bytes\], in addition to [`MEMORY_PER_BYTE`] for each byte of the
/// input. It is sufficient for a chunk of a table, its results, and the buffers of the table
/// writers.
const MEMORY: u64 = 64 << 20;

/// Maximum additional memory per byte of an input. The limit is large because Snappy compression
/// and dictionaries make a Parquet page much smaller than its contents.
const MEMORY_PER_BYTE: u64 = 256;

static HOOK: Once = Once::new();

impl Target {
    /// Returns the target with the given name.
    pub fn named(name: &str) -> Option<Self> {
        TARGETS.into_iter().find(|target| target.name == name)
    }

    /// Runs the target with an input and checks its time and memory.
    ///
    /// # Panics
    ///
    /// Panics if the target panics, or if it takes too much time or too much memory on this thread.
    pub fn check(&self, input: &[u8]) {
        // Panics caused by damaged tables are caught and converted to errors. As in the program, no
        // message is printed for these panics.
        HOOK.call_once(silence_caught_panics);
        let start = Instant::now();
        let memory = measure(|| (self.run)(input)).bytes_max;
        let time = start.elapsed();
        assert!(time < TIME_LIMIT, "{} took {time:?}", self.name);
        let most = MEMORY + MEMORY_PER_BYTE * input.len() as u64;
        let (name, size) = (self.name, input.len());
        assert!(memory < most, "{name} needs {memory} bytes for an input of {size} bytes");
    }

    /// Returns the names and contents of all files in the corpus of the target, including the
    /// examples.
    ///
    /// # Panics
    ///
    /// Panics if the corpus cannot be read.
    pub fn corpus(&self) -> Vec<(String, Vec<u8>)> {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut folders = vec![(here.join("corpus").join(self.name), None)];
        if let Some((folder, ending)) = self.examples {
            folders.push((here.join("../examples").join(folder), Some(ending)));
        }
        let mut files: Vec<PathBuf> = folders.iter().flat_map(|(f, e)| files(f, *e)).collect();
        files.sort();
        let name = |path: &Path| path.file_name().expect("a file").to_string_lossy().into_owned();
        files.iter().map(|path| (name(path), fs::read(path).expect("corpus"))).collect()
    }
}

fn files(folder: &Path, ending: Option<&str>) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("corpus");
    let paths = entries.map(|entry| entry.expect("corpus").path());
    let fits = |path: &PathBuf| {
        path.is_file() && ending.is_none_or(|end| path.extension().is_some_and(|e| e == end))
    };
    paths.filter(fits).collect()
}

/// Reads a case file and runs every calculation that is possible for the case.
fn case(input: &[u8]) {
    let Ok(case) = Case::from_json(input) else { return };
    let again = Case::from_json(case.to_json().to_string().as_bytes());
    assert_eq!(again.expect("a case that was written"), case);
    everything(&case);
}

/// Maximum number of balls in a nut. It limits the time that an input takes.
const BALLS: usize = 120;

/// Reads a case file and solves the nut with all its balls.
fn nut(input: &[u8]) {
    let Ok(case) = Case::from_json(input) else { return };
    let Ok(problem) = NutProblem::of(&case, &Model::RacewayControl.into()) else { return };
    if problem.balls() > BALLS {
        return;
    }
    let _ = Samples::new(&problem, 2, None).map(|samples| {
        let nuts = [0, 1].map(|number| samples.solve(number));
        Samples::answer(&nuts, &case).to_json().to_string()
    });
    let Ok(report) = problem.solve() else { return };
    for Row { quantity, values, .. } in report.numbers(|_| true).rows() {
        assert!(values.iter().flatten().all(|value| value.is_finite()), "{}", quantity.name);
    }
    let _ = (report.notes(), report.warnings(), report.answer().to_json(), report.curve());
}

/// Reads one setting per line and applies these settings to a base case. Unlike numbers in JSON,
/// numbers in settings may be infinite or NaN.
fn solve(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let mut lines = text.lines();
    let base = lines.next().and_then(|name| BASES.iter().find(|(base, _)| *base == name.trim()));
    let (_, base) = base.unwrap_or(&BASES[0]);
    let mut case = Case::from_json(base.as_bytes()).expect("an example");
    for line in lines {
        // A setting may be rejected with an error, but it must not cause a panic.
        let _ = case.apply(&[line]);
    }
    everything(&case);
}

/// Parses every line as a command-line argument.
fn words(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let base = Case::from_json(BASES[0].1.as_bytes()).expect("an example");
    let mut axes: Vec<GridAxis> = Vec::new();
    for line in text.lines() {
        axes.extend(GridAxis::parse(line));
        let _ = base.clone().apply(&[line]);
        let _ = Condition::parse(line, &ListColumn::of_sizes(false));
        if let Ok(fit) = Fit::parse(&base, "friction_coefficient", line) {
            let report = fit.run(&base, &Model::ClosedForm.into());
            let _ = report.map(|report| fit.answer(&base, &report).to_json().to_string());
        }
    }
    if let Ok(grid) = Grid::new(axes) {
        let _ = grid.check(&base);
        for point in [0, grid.len() / 2, grid.len() - 1] {
            let _ = grid.case(&base, &grid.point(point)).check();
        }
    }
}

fn csv(input: &[u8]) {
    table(|keep, of| Ok(Box::new(CsvSource::new(Cursor::new(input.to_vec()), keep, of)?)));
}

fn json_lines(input: &[u8]) {
    table(|keep, of| Ok(Box::new(JsonSource::new(Cursor::new(input.to_vec()), keep, of)?)));
}

fn parquet(input: &[u8]) {
    table(|keep, of| Ok(Box::new(ParquetSource::new(Bytes::copy_from_slice(input), keep, of)?)));
}

/// Maximum number of rows that are solved. It limits the time that an input takes.
const ROWS: usize = 3000;

/// Reads a table, with and without a column that is copied to the results, and writes the results
/// in all formats.
fn table(open: impl Fn(&[String], &TableFormat) -> Result<Box<dyn Source>, TableError>) {
    for keep in [&[][..], &["id".to_owned()]] {
        // A table may be rejected with an error, but it must not cause a panic.
        let _ = open(keep, &TableFormat::default()).and_then(|mut source| rewrite(source.as_mut()));
    }
}

fn rewrite(source: &mut dyn Source) -> Result<(), TableError> {
    let base = Case::from_json(BASES[0].1.as_bytes()).expect("an example");
    let outputs = Answers::select(Some(&["efficiency".to_owned()]))?;
    let (columns, table_format) = (source.columns().clone(), TableFormat::default());
    let sink = |format| TableSink::new(format, Vec::new(), &columns, &outputs, &table_format);
    let formats = [Format::Csv, Format::JsonLines, Format::Parquet];
    let mut sinks = formats.into_iter().map(sink).collect::<Result<Vec<_>, _>>()?;
    let task = Task::new(base, Model::ClosedForm.into(), outputs.clone());
    let mut rows = 0;
    while rows < ROWS
        && let Some(chunk) = source.next(512)?
    {
        assert!(chunk.len <= 512 && chunk.len > 0);
        rows += chunk.len;
        let answers = task.solve(&chunk, &columns);
        assert_eq!(answers.outcomes.len(), chunk.len);
        for sink in &mut sinks {
            sink.write(chunk.clone(), answers.clone())?;
        }
    }
    source.skip(10)?;
    sinks.into_iter().try_for_each(|sink| sink.finish(None).map(drop))
}

fn requirement(input: &[u8]) {
    let standard = Catalog::standard().expect("the compiled-in lists are valid").lists;
    // The least expensive model is sufficient, because other targets test the other models.
    let settings = ["model=closed-form".to_owned()];
    if let Ok(requirement) = RequirementFile::from_json(input, &settings, standard) {
        let _ = DesignReport::of(&requirement).answer().to_json().to_string();
    }
}

fn catalog(input: &[u8]) {
    let Ok(catalog) = Catalog::from_json(input) else { return };
    // Large catalogs are skipped, so that an input takes little time.
    if catalog.lists.len() <= 2000 {
        let best = catalog.pareto(&catalog.indices());
        let _ = catalog.map(&best, |_, nut| Some(candidate_json(nut)));
    }
}
