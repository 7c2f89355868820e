//! Vocabulary, units and case files: everything that a user reads and writes.
//!
//! This is the only crate that uses millimeters, degrees and rpm. A [`Case`] contains one operating
//! point with the names and units of the vocabulary. [`Case::problem`] converts it to the problem
//! of a model in SI units, and [`Record`] converts the solution back. Ratings, designs, fits and
//! analyses use the same vocabulary. The models, the equilibrium of a nut and the search for a
//! design are in other crates; this crate contains the fits of inputs to measured values and
//! combines the results of the other crates to answers.
//! The model choice `auto` selects the fastest model that is accurate enough:
//!
//! ```
//! use bsm_case::{Case, Record, Settings, output};
//! use bsm_dyn::{Model, ModelWorkspace};
//!
//! let case = Case::from_json(
//!     br#"{
//!         "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.5, "lead_mm": 20,
//!         "contact_angle_deg": 45, "nut_conformity": 0.53, "screw_conformity": 0.53,
//!         "friction_coefficient": 0.06, "screw_speed_rpm": 1500,
//!         "axial_load_N": 8000, "loaded_balls": 70
//!     }"#,
//! )?;
//! let problem = case.problem(&Settings::default())?;
//! let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
//!
//! assert_eq!(record.model(), Model::RacewayControl.into());
//! let torque = record.number(output!(ball_torque_Nm)).expect("converged");
//! assert!((torque - 25.828).abs() < 1e-3);
//! # Ok::<(), bsm_case::CaseError>(())
//! ```

mod answers;
mod case;
mod vocabulary;

pub use answers::analysis::table;
pub use answers::axis::{AxisReport, Order, ScrewTorque, sheet_columns, torque_parts};
pub use answers::calibration::{
    Calibration, CalibrationReport, InputAtLimit, MeasurementError, NoFit,
};
pub use answers::comparison::comparison;
pub use answers::design::{DesignReport, DesignRow};
pub use answers::ellipses::EllipseFields;
pub use answers::fit::{Fit, FitReport, FitValue, FittedInput, Measurement};
pub use answers::groove::with_groove_intervals;
pub use answers::jam::jam;
pub use answers::manufacturers::{ListNumber, ManufacturerNut, ManufacturerRow, TableColumn};
pub use answers::motion::MotionAnswer;
pub use answers::nut::{Columns, NutReport};
pub use answers::offers::{Offer, OfferColumn, compare_offers};
pub use answers::optimum::optimum;
pub use answers::ratings::ratings;
pub use answers::record::{Record, Supplement, reason_of_choice};
pub use answers::rows::Scales;
pub use answers::samples::Samples;
pub use answers::schema::{AnswerSchema, ObjectSchema, input_schema, output_schema};
pub use answers::section::GrooveSection;
pub use answers::selection::{
    CATALOG, Condition, ListColumn, NutFilter, NutList, candidate_case, candidate_json,
};
pub use answers::sensitivity::{Sensitivities, Sensitivity};
pub use answers::slip::slip;
pub use answers::warm::{WarmBranch, WarmPoint};
pub use bsm_design::groove::{DRAWS, FEW_DRAWS};
pub use bsm_design::statistics::Band;
pub use case::catalog::{Catalog, STANDARD_CATALOG};
pub use case::catalog_keys::LISTS;
pub use case::grid::{AxisValues, Grid, GridAxis};
pub use case::manufacturer_sizes::{MANUFACTURER_SIZES, SizeSource, column_names};
pub use case::nut::NutProblem;
pub use case::problem::{ModelChoice, PLAY, Settings};
pub use case::requirement::{REQUIREMENT_INPUTS, RequirementFile};
pub use vocabulary::answer::{
    Answer, Column, Content, Criterion, MissingInput, Section, Table, Verdict,
};
pub use vocabulary::cells::decimal_number;
pub use vocabulary::column_values::ColumnValues;
pub use vocabulary::display::{DisplayUnit, DisplayUnits, ShownColumn};
pub use vocabulary::entries::{CaseEntries, Choice};
pub use vocabulary::error::{CaseError, NameKind, brief, printable};
pub use vocabulary::input::{Case, INPUTS, InputKey, MAX_EXACT_INTEGER, Rule};
pub use vocabulary::input_set::{InputSet, derived_input};
pub use vocabulary::lines::{Lines, OtherSeparator, TextError, check_width, split};
pub(crate) use vocabulary::names::nearest;
pub use vocabulary::names::{RequirementChoice, entries, json_value_of, nearest_input};
pub use vocabulary::number::{
    format_digits, format_exact, format_interval, format_number, format_short, format_trimmed,
    format_with_interval, write_exact,
};
pub use vocabulary::output::{OUTPUTS, Output, OutputType, SolutionOutput, store_outputs};
pub use vocabulary::phase::PhaseEntry;
pub use vocabulary::quantity::{AnalysisKind, Numbers, OutputName, Quantity, Row, Scope, Values};
pub use vocabulary::rules::{Inputs, Pointwise, Relation, covered};
pub use vocabulary::table_format::TableFormat;
pub use vocabulary::units;
pub use vocabulary::warning::{SelectionLimit, Warning};
