//! All results that are calculated from the inputs of a case.

pub(crate) mod analysis;
pub(crate) mod axis;
pub(crate) mod band;
pub(crate) mod calibration;
pub(crate) mod comparison;
pub(crate) mod design;
pub(crate) mod ellipses;
pub(crate) mod fit;
pub(crate) mod groove;
pub(crate) mod jam;
pub(crate) mod manufacturers;
pub(crate) mod moving;
pub(crate) mod nut;
pub(crate) mod offers;
pub(crate) mod optimum;
pub(crate) mod output_name;
pub(crate) mod ratings;
pub(crate) mod record;
pub(crate) mod rows;
pub(crate) mod samples;
pub(crate) mod schema;
pub(crate) mod section;
pub(crate) mod selection;
pub(crate) mod sensitivity;
pub(crate) mod slip;
pub(crate) mod warm;
pub(crate) mod warnings;

/// Names of all result tables in the schema, each with the definition of its columns.
pub const TABLES: [(&str, &str); 14] = [
    ("lacking", crate::vocabulary::answer::NOT_GIVEN),
    ("rule", crate::vocabulary::answer::RULES),
    ("interval", record::INTERVALS),
    ("derivatives", sensitivity::SENSITIVITIES),
    ("verdict", moving::VERDICTS),
    ("ellipse", ellipses::CONTACT),
    ("conductance", warm::CONDUCTANCES),
    ("range", warm::RANGES),
    ("step", design::STEP_COLUMNS),
    ("value", calibration::FOUND),
    ("point", calibration::POINTS),
    ("offered rule", offers::RULES),
    ("offered number", offers::NUMBERS),
    ("offered input", offers::INPUTS),
];
