//! Analyses of a case or of a solved ball motion: the quantities that each analysis calculates, and
//! the inputs that it needs.

use bsm_dyn::{Model, ModelWorkspace};

use super::motion::MotionAnswer;
use super::{axis, band, branch, jam, manufacturers, nut, optimum, ratings, slip, warm, warnings};
use crate::case::problem::Needs;
use crate::case::rated_nut;
use crate::vocabulary::display::in_unit;
use crate::vocabulary::error::list;
use crate::{
    AnalysisKind, Answer, Case, CaseError, DisplayUnit, InputSet, ModelChoice, Numbers, NutProblem,
    OUTPUTS, Output, Quantity, Settings, nearest,
};

impl AnalysisKind {
    /// All kinds of analyses.
    pub const ALL: [Self; 10] = [
        Self::Slip,
        Self::Jam,
        Self::Optimum,
        Self::Ratings,
        Self::Nut,
        Self::Axis,
        Self::Warm,
        Self::Warnings,
        Self::Band,
        Self::Branch,
    ];

    /// Names and quantities of the analyses, in the order of [`ALL`](Self::ALL).
    const ROWS: [(&str, &[Quantity]); 10] = [
        ("slip", slip::QUANTITIES),
        ("jam", jam::QUANTITIES),
        ("optimum", optimum::QUANTITIES),
        ("ratings", ratings::QUANTITIES),
        ("nut", nut::QUANTITIES),
        ("axis", axis::QUANTITIES),
        ("warm", warm::QUANTITIES),
        ("warnings", warnings::QUANTITIES),
        ("band", band::QUANTITIES),
        ("branch", branch::QUANTITIES),
    ];

    /// Returns the name of the command that prints the analysis.
    pub fn name(self) -> &'static str {
        Self::ROWS[self as usize].0
    }

    /// Returns the quantities of the analysis in the order in which they are printed.
    pub fn quantities(self) -> &'static [Quantity] {
        Self::ROWS[self as usize].1
    }

    /// Returns the output columns that the analysis calculates.
    pub fn columns(self) -> impl Iterator<Item = &'static Output> {
        self.quantities().iter().flat_map(|quantity| quantity.columns)
    }

    /// Returns true if the analysis describes the motion of a ball.
    pub fn needs_motion(self) -> bool {
        matches!(self, Self::Slip | Self::Jam)
    }

    /// Returns true if the analysis needs a solved motion, and false if it needs only inputs.
    pub fn needs_solution(self) -> bool {
        self.needs_motion() || matches!(self, Self::Warnings | Self::Band | Self::Branch)
    }

    /// Returns the names of the required inputs that are missing. Some quantities may need
    /// additional inputs.
    ///
    /// * `base`: case that supplies all inputs that do not vary between the points.
    pub(crate) fn missing(self, base: &Case, given: InputSet) -> Vec<String> {
        let given = given.union(rated_nut::given(base));
        match self {
            Self::Slip | Self::Jam if given.is_lubricated() => Needs::LUBRICATED.missing(given),
            Self::Slip | Self::Jam => Needs::of(Model::Rigid).missing(given),
            Self::Optimum => optimum::NEEDS.missing(given),
            Self::Ratings => rated_nut::NEEDS.missing(given),
            Self::Nut => base.missing_for_a_nut(given),
            Self::Axis if given.lacks_groove() => Vec::new(),
            Self::Axis => axis::NEEDS.missing(given),
            Self::Warm => warm::missing(base, given),
            Self::Warnings | Self::Branch => Vec::new(),
            Self::Band => band::NEEDS.missing(given),
        }
    }

    /// Calculates the results of the analysis for a case.
    ///
    /// * `settings`: model and solver settings of analyses that solve the case themselves.
    /// * `motion`: solved motion, if the analysis [needs](Self::needs_solution) one.
    /// * `wanted`: function that returns true for the quantities to calculate. Other quantities may
    ///   be omitted.
    /// * `work`: workspace of the models, which is reused for several cases.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the analysis cannot be calculated.
    pub fn numbers(
        self,
        case: &Case,
        settings: &Settings,
        motion: Option<&MotionAnswer>,
        wanted: impl Fn(&Quantity) -> bool,
        work: &mut ModelWorkspace,
    ) -> Result<Numbers, CaseError> {
        match (self, motion) {
            (Self::Nut, _) => {
                let found = NutProblem::of(case, settings)?.solve();
                found.map_err(CaseError::Nut).map(|report| report.numbers(wanted))
            }
            (Self::Axis, _) => axis::numbers(case, settings, wanted, work),
            (Self::Warm, _) => warm::numbers(case, settings, wanted),
            (Self::Optimum, _) => optimum::numbers(case),
            (Self::Ratings, _) => ratings::numbers(case),
            (Self::Slip, Some(MotionAnswer { settings, solution, .. })) => {
                slip::slip(case, settings, solution).map(Answer::into_numbers)
            }
            (Self::Jam, Some(moving)) => jam::jam(case, &moving.solution).map(Answer::into_numbers),
            (Self::Warnings, Some(moving)) => Ok(warnings::numbers(case, &moving.solution)),
            (Self::Band, Some(moving)) => {
                band::numbers(case, &moving.settings, &moving.solution, work)
            }
            (Self::Branch, Some(moving)) => branch::numbers(case, &moving.settings, work),
            (Self::Slip | Self::Jam | Self::Warnings | Self::Band | Self::Branch, None) => {
                Ok(Numbers::none(self.quantities()))
            }
        }
    }
}

impl Output {
    /// Returns true if the output can only be calculated after the operating point is solved.
    pub fn needs_solution(&self) -> bool {
        self.analysis().is_none_or(AnalysisKind::needs_solution)
    }

    /// Returns the names of the missing inputs that the analysis and the output need. The result is
    /// empty for an output of a solution.
    ///
    /// * `base`: case that supplies all inputs that do not vary between the points.
    pub(crate) fn missing(&self, base: &Case, given: InputSet) -> Vec<String> {
        let Some(kind) = self.analysis() else { return Vec::new() };
        let name = self.interval().map_or(self.name, |(of, _)| of.name);
        let own = |quantity: &&Quantity| quantity.columns.iter().any(|c| c.name == name);
        let quantity = kind.quantities().iter().find(own);
        let of_quantity = quantity.map(|quantity| quantity.missing(given)).unwrap_or_default();
        kind.missing(base, given).into_iter().chain(of_quantity).collect()
    }

    /// Checks that the output can be calculated for points with the given inputs.
    ///
    /// * `base`: case that supplies all inputs that do not vary between the points.
    /// * `model`: model with which the points are solved.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Invalid`] if the model does not calculate the motion of the ball, or if
    /// inputs are missing.
    pub fn check(&self, base: &Case, given: InputSet, model: ModelChoice) -> Result<(), CaseError> {
        let Some(kind) = self.analysis() else { return Ok(()) };
        if let (true, ModelChoice::Fixed(model @ (Model::ClosedForm | Model::QuasiStatic))) =
            (kind.needs_motion(), model)
        {
            return Err(CaseError::no_motion(model, &kind.missing(base, given)));
        }
        let missing = self.missing(base, given);
        if missing.is_empty() {
            return Ok(());
        }
        let (name, required) = (self.name, list(&missing));
        Err(CaseError::Invalid(format!("column {name} would be empty, because {required} missing")))
    }

    /// Returns the output with the given name, either of a solution or of an analysis.
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::all().find(|output| output.name == name).or_else(|| Self::interval_end(name))
    }

    /// Returns the output to which `name` refers, and the unit at the end of `name`. This unit may
    /// differ from the unit of the output.
    pub fn in_unit(name: &str) -> Option<(&'static Self, DisplayUnit)> {
        if let Some(output) = Self::named(name) {
            return Some((output, DisplayUnit::unchanged(output.unit)));
        }
        let (own, unit) = in_unit(name, Self::all().map(|output| output.name))?;
        Some((Self::named(own)?, unit))
    }

    /// Returns the output name that is most similar to `name`, if any is similar enough.
    pub fn nearest(name: &str) -> Option<&'static str> {
        nearest(name, Self::all().map(|output| output.name))
    }

    /// Returns all outputs in [`OUTPUTS`], followed by the outputs of all analyses.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        OUTPUTS.iter().chain(AnalysisKind::ALL.into_iter().flat_map(AnalysisKind::columns))
    }
}

/// Returns the quantities of the table with the given name, which is the name of an analysis or one
/// of `steps`, `as used`, `best`, `screw`, `phase`, `torques`, `circuit` and `manufacturer`.
pub fn table(name: &str) -> impl Iterator<Item = &'static Quantity> + use<> {
    let steps = ratings::STEPS;
    let (all, steps_alone): (&[Quantity], _) = match name {
        "best" => (optimum::BY_MODEL, None),
        "ratings" => (ratings::QUANTITIES, Some(false)),
        "steps" => (ratings::QUANTITIES, Some(true)),
        "as used" => (ratings::AS_USED, None),
        "screw" => (axis::SCREW, None),
        "phase" => (axis::PHASE, None),
        "torques" => (axis::TORQUES, None),
        "circuit" => (nut::CIRCUITS, None),
        "manufacturer" => (manufacturers::COMPARED, None),
        _ => {
            let kind = AnalysisKind::ALL.into_iter().find(|kind| kind.name() == name);
            (kind.map_or(&[], AnalysisKind::quantities), None)
        }
    };
    all.iter()
        .filter(move |quantity| steps_alone.is_none_or(|alone| alone == (quantity.title == steps)))
}
