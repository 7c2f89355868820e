//! The task that is performed for each row of a table.

use bsm_case::{AnalysisKind, Case, CaseError, Grid, InputSet, ModelChoice, Output, Settings};

use crate::Columns;

/// Settings that apply to all rows of a table.
#[derive(Debug, Clone)]
pub struct Task {
    /// Base case: values of the inputs that are not table columns.
    pub base: Case,
    /// Model and model settings.
    pub settings: Settings,
    /// Outputs that are written for each row.
    pub outputs: Vec<&'static Output>,
    /// An output that is displayed but not written. In the results, its column is the last one.
    pub watched: Option<&'static Output>,
    /// Requested outputs that are also input columns of the table, such as a temperature. In rows
    /// where the input is missing, the calculated value is filled in.
    pub filled: Vec<&'static Output>,
    /// True if the groove is estimated separately for each row, because the estimate depends on a
    /// column.
    pub estimates_rows: bool,
}

/// Divides outputs into outputs that are not input columns of the table and outputs that are also
/// input columns, such as a temperature.
fn besides(
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

    /// Returns true if the points must be solved. Otherwise all outputs can be read from the
    /// inputs.
    pub(crate) fn solves(&self) -> bool {
        let mut outputs = self.outputs.iter().copied().chain(self.watched);
        self.outputs.is_empty() || outputs.any(Output::needs_solution)
    }

    /// Prepares the estimation of the groove if it is not fully specified. The groove is estimated
    /// once for the base case, or separately for each row if a column changes the estimate.
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

    /// Returns a note about the estimated groove, or `None` if the groove is given.
    pub fn groove_note(&self) -> Option<String> {
        if self.estimates_rows {
            let note = "The groove of each row that does not give it in full is estimated from the load ratings. Columns with `low` or \
                        `high` before the unit contain 90 % intervals over the possible grooves.";
            return Some(note.to_owned());
        }
        self.base.groove_note()
    }

    /// Returns the case with a given or estimated groove. If the groove cannot be estimated, the
    /// case is returned without a groove, provided that the requested results concern only the axis
    /// and need no groove.
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

    /// If an output depends on the motion of the ball, selects one model for all points and
    /// outputs.
    fn of_motion(mut self, given: InputSet) -> Self {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        if outputs.any(|output| output.analysis().is_some_and(AnalysisKind::needs_motion)) {
            self.settings.model = self.settings.model.of_motion(given);
        }
        self
    }

    /// Checks that all outputs can be calculated for points with the inputs `given` and the model
    /// `model`, and returns the task.
    fn checked(self, given: InputSet, model: ModelChoice) -> Result<Self, CaseError> {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        outputs.try_for_each(|output| output.check(&self.base, given, model))?;
        Ok(self)
    }

    /// Returns a task that solves all points of a grid with one model. Required inputs must be
    /// given by the base case or the grid.
    ///
    /// * `watched`: an output that is displayed but not written.
    ///
    /// # Errors
    ///
    /// The errors of [`Grid::choose`] and of [`Output::check`].
    pub fn over_grid(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        watched: Option<&'static Output>,
        grid: &Grid,
    ) -> Result<Self, CaseError> {
        let (outputs, _) = besides(outputs, grid.varied());
        let task = Self { watched, ..Self::new(base, settings, outputs) };
        let task = task.with_groove(grid.varied())?;
        let given = task.base.stated_over(grid.varied());
        let mut task = task.of_motion(given);
        if task.solves() {
            task.settings.model = grid.choose(&task.base, task.settings.model)?;
        } else {
            grid.check(&task.base)?;
        }
        let model = task.settings.model;
        task.checked(given, model)
    }

    /// Returns a task for the rows of a table. Required inputs must be given by the base case or by
    /// a column.
    ///
    /// # Errors
    ///
    /// [`CaseError::Entry`] if an input of the model is neither in the base case nor a column, and
    /// the errors of [`Output::check`].
    pub fn over_table(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        columns: &Columns,
    ) -> Result<Self, CaseError> {
        let (outputs, filled) = besides(outputs, columns.set());
        let task = Self { filled, ..Self::new(base, settings, outputs) };
        let task = task.with_groove(columns.set())?;
        let estimated = task.base.stated_over(columns.set());
        let given = task.base.stated().and(columns.set()).and(estimated);
        let task = task.of_motion(given);
        let model = task.settings.model;
        let model = if task.solves() { model.resolve(given, |_| Ok(()))? } else { model };
        task.checked(given, model)
    }
}
