//! The private core of the Python package `ballscrew`. It contains only conversions and no
//! formulas. The public functions are in `ballscrew/_api.py`.

#![expect(
    clippy::needless_pass_by_value,
    clippy::type_complexity,
    reason = "arguments from Python are passed by value, and rows of tables are tuples"
)]

mod case;
mod clock;
mod errors;
mod objects;
mod parts;
mod points;
mod reports;
mod solution;
mod table;

use bsm_case::units::other_units;
use bsm_case::{
    CaseEntries, INPUTS, InputKey, ModelChoice, Output, Quantity, REQUIREMENT_INPUTS,
    RequirementChoice, Scope, input_schema,
};
use bsm_dyn::{Control, model::RacewayFriction};
use pyo3::prelude::*;
use serde_json::Value;

use crate::errors::{Error, Result};
use crate::objects::Object;

/// Returns the name, unit, meaning, default and rule of every input.
#[pyfunction]
fn inputs() -> Vec<(&'static str, &'static str, &'static str, Option<f64>, String)> {
    INPUTS.iter().map(|i| (i.name, i.unit, i.about, i.default, i.rule.describe())).collect()
}

/// Returns the input names that end with a unit other than the default unit of the input.
#[pyfunction]
fn names_in_other_units() -> Vec<String> {
    let of_input = |name: &'static str| {
        let in_unit = move |unit: &str| {
            let mut names =
                name.match_indices('_').map(|(at, _)| format!("{}_{unit}", &name[..at]));
            names.find(|other| InputKey::in_unit(other).is_ok_and(|(key, _)| key.name() == name))
        };
        other_units(name).into_iter().filter_map(move |(unit, _)| in_unit(unit))
    };
    INPUTS.iter().flat_map(|input| of_input(input.name)).collect()
}

/// Returns the name, unit, meaning, JSON type, possible texts and analysis of every output.
#[pyfunction]
fn outputs() -> Vec<(
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    Vec<&'static str>,
    Option<&'static str>,
)> {
    let row = |o: &Output| {
        let analysis = o.analysis().map(bsm_case::AnalysisKind::name);
        (o.name, o.unit, o.about, o.output_type.name(), o.words.to_vec(), analysis)
    };
    Output::all().map(row).collect()
}

/// Returns the name, unit, meaning and JSON type of each number in an analysis or in a section of
/// an answer (see [`bsm_case::table`]).
#[pyfunction]
fn columns(table: &str) -> Result<Vec<(&'static str, &'static str, &'static str, &'static str)>> {
    let numbers = bsm_case::table(table).filter(|quantity| quantity.scope != Scope::Statement);
    let columns: Vec<_> = numbers
        .flat_map(|quantity| quantity.columns)
        .map(|o| (o.name, o.unit, o.about, o.output_type.name()))
        .collect();
    if columns.is_empty() {
        return Err(Error::from(format!("`{table}` is not a table of any answer")));
    }
    Ok(columns)
}

/// Returns the name, unit, meaning, default and rule of each requirement key that is not an input
/// of a case.
#[pyfunction]
fn requirements() -> Vec<(&'static str, &'static str, String, Option<f64>, String)> {
    let words = RequirementChoice::ALL.iter().map(|choice| {
        let rule = format!("one of {}", choice.words().join(", "));
        (choice.name(), "", choice.about().to_owned(), None, rule)
    });
    let number = |i: &Quantity| (i.name, i.unit, i.about.to_owned(), i.default, i.rule.describe());
    words.chain(REQUIREMENT_INPUTS.iter().map(number)).collect()
}

/// Returns the name, meaning, JSON type and possible texts of each input that is not a number.
#[pyfunction]
fn case_choices() -> Vec<(&'static str, String, String, Vec<String>)> {
    let schema = input_schema();
    let texts = |of: &Value| -> Vec<String> {
        let values = of.as_array().into_iter().flatten().chain(of.as_str().map(|_| of));
        values.filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let row = |name: &&'static str| {
        let property = &schema["properties"][*name];
        let kind = texts(&property["type"]).into_iter().find(|kind| kind != "null");
        let about = property["description"].as_str().unwrap_or_default().to_owned();
        (*name, about, kind.unwrap_or_else(|| "string".to_owned()), texts(&property["enum"]))
    };
    CaseEntries::KEYS.iter().map(row).collect()
}

/// Parses a JSON object and returns its members.
#[pyfunction]
fn entries(text: &str) -> Result<Object> {
    let entries = bsm_case::entries(text.as_bytes())?;
    Ok(Object(Value::Object(entries.into_iter().collect())))
}

#[pymodule]
mod _core {
    use super::{Control, ModelChoice, RacewayFriction};
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::{
        case::Case,
        case_choices,
        clock::{batch_seconds, solve_seconds},
        columns, entries, inputs, names_in_other_units, outputs,
        parts::PyPlan,
        points::{Rows, draws, solve_many, sweep},
        reports::{
            Nuts, axis, compare, ellipses, fit, fit_table, jam, manufacturers, nut, nut_columns,
            nut_samples, optimum, ratings, select, select_nuts, slip, validate, write_numbers,
        },
        requirements,
        solution::{Solution, gradient, sensitivities},
        table::{Arrow, KeptColumn, read_arrow, to_arrow},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        // These constants contain the names of the models (`auto` first), of the raceways that can
        // control the ball, and of the methods for calculating the friction of a lubricant film.
        module.add("MODELS", ModelChoice::names().collect::<Vec<_>>())?;
        module.add("RACEWAYS", Control::ALL.map(Control::name))?;
        module.add("FRICTIONS", RacewayFriction::ALL.map(RacewayFriction::name))
    }
}
