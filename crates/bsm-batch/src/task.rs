//! The calculation that a table task performs for each row.

use bsm_case::{AnalysisKind, Case, CaseError, Grid, InputSet, ModelChoice, Output, Settings};

use crate::Columns;

/// The calculation for each row of a table, which is defined by a base case, settings and outputs.
#[derive(Debug, Clone)]
pub struct Task {
    /// Base case, which contains the values of all inputs that are not columns of the table.
    pub base: Case,
    /// Model and solver settings.
    pub settings: Settings,
    /// Outputs that are written to the table of results.
    pub outputs: Vec<&'static Output>,
    /// Output that the caller displays while the rows are solved. If this output is not written to
    /// the table, it is the last column of the results (see
    /// [`watched_index`](Self::watched_index)).
    pub watched: Option<&'static Output>,
    /// Requested outputs that are also input columns of the table, such as a temperature. If the
    /// input is missing in a row, the calculated value is written instead.
    pub filled: Vec<&'static Output>,
    /// True if the groove is estimated separately for each row, because the estimate depends on a
    /// column of the table.
    pub estimates_rows: bool,
}

/// Divides the requested outputs into two lists. The first list contains the outputs that are not
/// input columns of the table, and the second list contains the outputs that are also input
/// columns, such as a temperature.
fn split_off_input_columns(
    outputs: Vec<&'static Output>,
    inputs: InputSet,
) -> (Vec<&'static Output>, Vec<&'static Output>) {
    outputs.into_iter().partition(|output| inputs.iter().all(|key| key.name() != output.name))
}

impl Task {
    /// Returns a task that writes the given outputs and displays no other output.
    pub fn new(base: Case, settings: Settings, outputs: Vec<&'static Output>) -> Self {
        Self { base, settings, outputs, watched: None, filled: Vec::new(), estimates_rows: false }
    }

    /// Returns the index of the watched output among the columns of the results.
    pub fn watched_index(&self) -> Option<usize> {
        let watched = self.watched?;
        let written = self.outputs.iter().position(|output| output.name == watched.name);
        Some(written.unwrap_or(self.outputs.len() + self.filled.len()))
    }

    /// Returns true if the outputs require a solution of each row. Otherwise, they can be
    /// calculated from the inputs alone.
    pub(crate) fn solves(&self) -> bool {
        let mut outputs = self.outputs.iter().copied().chain(self.watched);
        self.outputs.is_empty() || outputs.any(Output::needs_solution)
    }

    /// Decides how the groove is estimated if it is not fully specified. It is estimated once for
    /// the base case or, if a column changes the estimate, separately for each row.
    fn with_groove(mut self, columns: InputSet) -> Result<Self, CaseError> {
        if columns.changes_groove() {
            self.base = self.base.without_estimates();
            let given = self.base.stated().overridden_by(columns);
            self.estimates_rows = self.base.stated_over(columns) != given;
        } else {
            self.base = self.groove_of(&self.base)?;
        }
        Ok(self)
    }

    /// Returns a note about the estimated groove, or `None` if the groove is fully specified.
    pub fn groove_note(&self) -> Option<String> {
        if self.estimates_rows {
            let note = "In rows that do not specify the groove completely, the groove is estimated from the load ratings. Columns with `low` or \
                        `high` before the unit contain the limits of 90 % intervals over the possible grooves.";
            return Some(note.to_owned());
        }
        self.base.groove_note()
    }

    /// Returns the case with its groove, which is estimated if it is not given. If the groove
    /// cannot be estimated, but no output depends on the groove, the case is returned without a
    /// groove.
    pub(crate) fn groove_of(&self, case: &Case) -> Result<Case, CaseError> {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        match case.with_groove() {
            Err(CaseError::NoGroove(_))
                if !self.solves()
                    && outputs.all(|output| output.analysis() == Some(AnalysisKind::Axis)) =>
            {
                Ok(case.without_estimates())
            }
            found => found,
        }
    }

    /// Selects a single model for all rows and outputs if an output depends on the motion of the
    /// ball.
    fn with_one_model_for_motion(mut self, given: InputSet) -> Self {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        if outputs.any(|output| output.analysis().is_some_and(AnalysisKind::needs_motion)) {
            self.settings.model = self.settings.model.for_motion(given);
        }
        self
    }

    /// Returns this task if all outputs can be calculated with the model `model` for points with
    /// the inputs `given`.
    fn check_outputs(self, given: InputSet, model: ModelChoice) -> Result<Self, CaseError> {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        outputs.try_for_each(|output| output.check(&self.base, given, model))?;
        Ok(self)
    }

    /// Returns a task that solves all points of a grid with the same model. Each required input
    /// must be in the base case or in the grid.
    ///
    /// * `watched`: output that is displayed but not written.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`Grid::choose`] and [`Output::check`].
    pub fn over_grid(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        watched: Option<&'static Output>,
        grid: &Grid,
    ) -> Result<Self, CaseError> {
        let (outputs, _) = split_off_input_columns(outputs, grid.varied());
        let task = Self { watched, ..Self::new(base, settings, outputs) };
        let task = task.with_groove(grid.varied())?;
        let given = task.base.stated_over(grid.varied());
        let mut task = task.with_one_model_for_motion(given);
        if task.solves() {
            task.settings.model = grid.choose(&task.base, task.settings.model)?;
        } else {
            grid.check(&task.base)?;
        }
        let model = task.settings.model;
        task.check_outputs(given, model)
    }

    /// Returns a task that solves the rows of a table. Each required input must be in the base case
    /// or a column of the table.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] if an input that the model requires is neither in the base case
    /// nor a column, or an error of [`Output::check`].
    pub fn over_table(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        columns: &Columns,
    ) -> Result<Self, CaseError> {
        let (outputs, filled) = split_off_input_columns(outputs, columns.set());
        let task = Self { filled, ..Self::new(base, settings, outputs) };
        let task = task.with_groove(columns.set())?;
        let estimated = task.base.stated_over(columns.set());
        let given = task.base.stated().union(columns.set()).union(estimated);
        let task = task.with_one_model_for_motion(given);
        let model = task.settings.model;
        let model = if task.solves() { model.resolve(given, |_| Ok(()))? } else { model };
        task.check_outputs(given, model)
    }
}
