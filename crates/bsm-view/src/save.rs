//! The page as a single file, in which the solver runs as WebAssembly.

use bsm_case::{Case, Settings};
use serde_json::json;

use crate::form::schema;
use crate::page;

/// The file that the script `page-solver` writes. Its first line is the version of the solver, and
/// the rest is the WebAssembly module.
#[cfg(page_solver)]
const FILE: Option<&str> = Some(include_str!("../page/solver.wasm.gz.base64"));
#[cfg(not(page_solver))]
const FILE: Option<&str> = None;

/// The solver that a saved page contains.
#[derive(Debug, Clone, Copy)]
pub struct PageSolver<'a> {
    /// Version of the sources from which the solver was built.
    pub version: &'a str,
    /// The WebAssembly module, compressed with gzip and encoded in base64.
    pub module: &'a str,
}

impl PageSolver<'static> {
    /// Returns the page solver that is included in this build, or `None` if the page solver did not
    /// exist when the program was built.
    pub fn of_build() -> Option<Self> {
        let (version, module) = FILE?.split_once('\n')?;
        Some(Self { version, module: module.trim_end() })
    }
}

/// Returns the page for a case as a single file, which needs neither a server nor a network.
///
/// * `beside`: other cases, which the page compares with its own case.
pub fn saved(case: &Case, beside: &[Case], settings: &Settings, solver: &PageSolver<'_>) -> String {
    let start = json!({
        "case": case.without_estimates().to_json(),
        "beside": page::cases(beside),
        "settings": settings.to_json(),
        "save": false,
        "program": bsm_report::PROGRAM,
        "schema": schema(),
    });
    page::html(&start, Some(solver.module))
}
