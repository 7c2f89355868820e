//! The program as users run it.

mod analyses;
mod cli;
mod data;
mod design;
mod documents;
mod leads;
mod lookup;
mod nut;
mod parts;
mod program;
mod reports;
mod resume;
mod robustness;
mod schemas;
mod size;
mod tables;
