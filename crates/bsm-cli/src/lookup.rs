//! Lookup tables for drive models: a grid of one or two inputs, written as a Modelica table or as a
//! CSV matrix.

use std::path::Path;

use bsm_batch::{AnswerSink, Answers, Chunk, Count, GridSource, TableError, Task, Workers};
use bsm_case::{Grid, GridAxis, Output, format_exact};

use crate::console::print_message;
use crate::failure::Failure;
use crate::files;
use crate::table_job::run_failure;

/// Maximum number of points of a lookup table. All points must fit into the memory of this program
/// and of the drive model.
const MAX_POINTS: usize = 10_000_000;

/// Format of a lookup table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lookup {
    /// Text file for Modelica's `CombiTable2D` and `CombiTable1D` (`.txt`). Other tools can also
    /// read this format.
    Modelica,
    /// CSV matrix of one output; rows correspond to the first axis and columns to the second
    /// (`.grid.csv`).
    Grid,
}

impl Lookup {
    /// Chooses the format by the file extension.
    pub(crate) fn of(path: &Path) -> Self {
        let is_text = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("txt"));
        if is_text { Self::Modelica } else { Self::Grid }
    }

    /// Solves a grid and writes the lookup table.
    pub(crate) fn write(
        self,
        path: &Path,
        task: &Task,
        grid: &Grid,
        workers: &Workers<'_>,
    ) -> Result<(), Failure> {
        let refused = |text: String| Failure::Input(format!("-o {}: {text}", path.display()));
        let axes = grid.axes();
        for axis in axes {
            let rises = |place: usize| axis.value(place) < axis.value(place + 1);
            if !(0..axis.len() - 1).all(rises) {
                let name = axis.key.name();
                return Err(refused(format!(
                    "the values of {name} must increase in a lookup table"
                )));
            }
        }
        match (self, axes.len(), task.outputs.len()) {
            (Self::Modelica, 1 | 2, _) | (Self::Grid, 2, 1) => {}
            (Self::Modelica, ..) => {
                return Err(refused("a lookup table has one or two varied inputs".to_owned()));
            }
            (Self::Grid, ..) => {
                let text =
                    "a .grid.csv matrix has two varied inputs and one output (see --columns)";
                return Err(refused(text.to_owned()));
            }
        }
        if grid.len() > MAX_POINTS {
            return Err(refused(format!("a lookup table has at most {MAX_POINTS} points")));
        }
        let mut source = GridSource::new(grid.clone());
        let columns = CollectedColumns(vec![Vec::with_capacity(grid.len()); task.outputs.len()]);
        let run = task.run(&mut source, columns, u64::MAX, workers, &mut |_, _| {});
        let (CollectedColumns(columns), Count { rows, failed, .. }) =
            run.map_err(|error| run_failure(path, error))?;
        if failed > 0 {
            let text = format!(
                "{failed} of {rows} points have no result, but a lookup table must not have gaps; narrow the ranges, or write a \
                 .csv table, which states the reasons"
            );
            print_message("error", &text);
            return Err(Failure::Unsolved);
        }
        for (output, column) in task.outputs.iter().zip(&columns) {
            if column.iter().any(|value| value.is_nan()) {
                let (name, model) = (output.name, task.settings.model.name());
                return Err(refused(format!(
                    "model {model} has no {name} at some points, but a lookup table needs all values; choose other outputs with --columns"
                )));
            }
        }
        let text = match self {
            Self::Modelica => modelica(axes, &task.outputs, &columns),
            Self::Grid => matrix(axes, &columns[0], ","),
        };
        files::write(path, &text)
    }
}

/// Values of each output, collected chunk by chunk.
struct CollectedColumns(Vec<Vec<f64>>);

impl AnswerSink for CollectedColumns {
    fn write(&mut self, _: Chunk, answers: Answers) -> Result<(), TableError> {
        for (all, column) in self.0.iter_mut().zip(answers.columns) {
            all.extend(column);
        }
        Ok(())
    }
}

/// Formats rows of numbers as lines of text.
fn lines(rows: impl Iterator<Item = Vec<f64>>, between: &str) -> String {
    let line =
        |row: Vec<f64>| row.into_iter().map(format_exact).collect::<Vec<_>>().join(between) + "\n";
    rows.map(line).collect()
}

/// Formats an output over two axes as a matrix. The first row contains the values of the second
/// axis, the first column contains the values of the first axis, and the corner is zero.
fn matrix(axes: &[GridAxis], column: &[f64], between: &str) -> String {
    let across = axes[1].len();
    let head = std::iter::once(0.0).chain((0..across).map(|place| axes[1].value(place)));
    let row = |(place, values): (usize, &[f64])| {
        std::iter::once(axes[0].value(place)).chain(values.iter().copied()).collect()
    };
    let rows = column.chunks(across).enumerate().map(row);
    lines(std::iter::once(head.collect()).chain(rows), between)
}

/// Formats Modelica tables: one table per output for two axes, or one table with all outputs for
/// one axis.
fn modelica(axes: &[GridAxis], outputs: &[&Output], columns: &[Vec<f64>]) -> String {
    let named = |name: &str, unit: &str| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    let axis = |axis: &GridAxis| named(axis.key.name(), axis.key.input().unit);
    if let [only] = axes {
        let titles: Vec<_> = outputs.iter().map(|o| named(o.name, o.unit)).collect();
        let row = |place: usize| {
            let cells = columns.iter().map(|column| column[place]);
            std::iter::once(only.value(place)).chain(cells).collect()
        };
        let (rows, width) = (only.len(), 1 + outputs.len());
        let table = lines((0..rows).map(row), " ");
        return format!(
            "#1\n# {}: {}\ndouble map({rows},{width})\n{table}",
            axis(only),
            titles.join(", ")
        );
    }
    let table = |(output, column): (&&Output, &Vec<f64>)| {
        format!(
            "# {}: u1 in rows {}, u2 in columns {}\ndouble {}({},{})\n{}",
            named(output.name, output.unit),
            axis(&axes[0]),
            axis(&axes[1]),
            output.name,
            axes[0].len() + 1,
            axes[1].len() + 1,
            matrix(axes, column, " ")
        )
    };
    let tables: String = outputs.iter().zip(columns).map(table).collect();
    format!("#1\n{tables}")
}
