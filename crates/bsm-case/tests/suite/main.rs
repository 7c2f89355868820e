//! Tests of cases, rules, analyses and reports.

mod analysis;
mod calibration;
mod capacity;
mod case;
mod catalog;
mod catalog_line;
mod design;
mod drive;
mod glossary;
mod hard_points;
mod lubricant;
mod machine;
mod motion;
mod rated;
mod sensitivities;
mod shaft;
mod size;
mod third_contact;
mod train;
mod warm;

use bsm_case::OutputName;

/// Returns the output with the given name.
fn named(name: &str) -> OutputName {
    OutputName::named(name).unwrap_or_else(|| panic!("no output is named {name}"))
}
