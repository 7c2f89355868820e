//! The program as users run it.

mod analyses;
mod catalog_line;
mod cli;
mod data;
mod design;
mod documents;
mod leads;
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
mod tables;

// A private file with a test of its own: the program is compiled once, without it.
#[expect(dead_code, reason = "bars are drawn by the program")]
#[path = "../../src/progress.rs"]
mod progress;
