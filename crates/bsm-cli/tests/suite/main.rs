//! Tests of the program on the command line.

mod analyses;
mod catalog_line;
mod cli;
mod data;
mod design;
mod documents;
mod leads;
mod lists;
mod lookup;
mod nut;
mod parts;
mod program;
mod readers;
mod reports;
mod resume;
mod robustness;
mod schemas;
mod size;
mod snapshots;
mod tables;

// The private module `progress` is included here, so that its own tests are run. The program itself
// is compiled once, without tests.
#[expect(dead_code, reason = "bars are drawn by the program")]
#[path = "../../src/progress.rs"]
mod progress;
