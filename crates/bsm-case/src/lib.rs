//! Vocabulary, units and scene files: what a person reads and writes.
//!
//! The only place that knows millimetres, degrees and rpm. A [`Scene`] is one operating point in
//! the vocabulary; [`Scene::problem`] turns it into the SI problem of a model, [`Record`] turns
//! the answer back. Ratings, designs, fits and analyses are asked and answered here in the same words; how
//! anything is solved is not known here: no iteration, no search, no tolerance of one.
//!
//! Model `auto` takes the cheapest model that is exact enough:
//!
//! ```
//! use bsm_case::{Record, Scene, Settings};
//! use bsm_dyn::{Model, ModelWorkspace};
//!
//! let scene = Scene::from_json(
//!     br#"{
//!         "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.5, "lead_mm": 20,
//!         "contact_angle_deg": 45, "nut_conformity": 0.53, "screw_conformity": 0.53,
//!         "friction_coefficient": 0.06, "screw_speed_rpm": 1500,
//!         "axial_load_N": 8000, "loaded_balls": 70
//!     }"#,
//! )?;
//! let problem = scene.problem(&Settings::default())?;
//! let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
//!
//! assert_eq!(record.model(), Model::RacewayControl.into());
//! let torque = record.number("screw_torque_Nm").expect("converged");
//! assert!((torque - 25.828).abs() < 1e-3);
//! # Ok::<(), bsm_case::CaseError>(())
//! ```

#![expect(
    clippy::inline_always,
    reason = "rules over several points take the instruction set of their caller only inline"
)]

mod analysis;
mod calibration;
mod capacity;
mod catalogue;
mod comparison;
mod design;
mod ellipses;
mod error;
mod fit;
mod grid;
mod input;
mod input_set;
mod jam;
mod makers;
mod number;
mod nut;
mod optimum;
mod output;
mod problem;
mod quantity;
mod reader;
mod record;
mod requirement;
mod rows;
mod rules;
mod scene;
mod schema;
mod section;
mod sensitivity;
mod size;
mod slip;
mod spectrum;
pub mod units;

pub use analysis::{Analysis, AnalysisKind, Moving};
pub use calibration::{Calibration, CalibrationReport};
pub use capacity::CapacityReport;
pub use catalogue::{
    Asked, CATALOGUE_COLUMNS, Catalogue, CatalogueColumn, Condition, STANDARD_CATALOGUE,
    candidate_json, candidate_scene,
};
pub use comparison::{Compared, Comparison};
pub use design::{DesignReport, DesignRow};
pub use ellipses::EllipseFields;
pub use error::{CaseError, brief, printable};
pub use fit::{Fit, FitReport, Fitted};
pub use grid::{Axis, Grid};
pub use input::{INPUTS, Input, InputKey, Rule, Scene};
pub use input_set::{InputSet, following};
pub use makers::{MakerNut, MakerRow, column_names};
pub use number::{exact, write_exact};
pub use nut::{BALL_COLUMNS, CURVE_COLUMNS, LISTED, NutProblem, NutReport, NutWords, Samples};
pub use optimum::OptimumReport;
pub use output::{Cell, OUTPUTS, Output, OutputKey};
pub use problem::{ModelChoice, Settings};
pub use quantity::{Numbers, Of, Quantity};
pub use record::Record;
pub use requirement::{REQUIREMENT_INPUTS, REQUIREMENT_WORDS, RequirementFile};
pub use rows::{RecordRows, Scales};
pub use rules::{Inputs, Relation, covered};
pub(crate) use scene::nearest;
pub use scene::{entries, nearest_input};
pub use schema::{input_schema, output_schema};
pub use section::GrooveSection;
pub use sensitivity::{Sensitivities, Sensitivity};
pub use size::{
    NOT_MODELLED, PhaseWords, SizePhase, SizeReport, SizeRule, decimal_number, sheet_columns,
    torque_parts,
};
pub use spectrum::Spectrum;
