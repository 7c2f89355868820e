//! The task that is performed for every row of a table.

use bsm_case::{AnalysisKind, Case, CaseError, Grid, InputSet, ModelChoice, Output, Settings};

use crate::Columns;

/// Settings that all rows of a table share.
#[derive(Debug, Clone)]
pub struct Task {
    /// The inputs that are not columns.
    pub base: Case,
    /// The model and its settings.
    pub settings: Settings,
    /// Outputs to write.
    pub outputs: Vec<&'static Output>,
    /// An output that is shown, but not written. It is the last column of the results that are
    /// shown.
    pub watched: Option<&'static Output>,
    /// Outputs that are also inputs of the table, such as a temperature. They are filled in for
    /// rows that do not contain them.
    pub filled: Vec<&'static Output>,
    /// True if the groove is estimated in each row, because a column changes the estimate.
    pub estimates_rows: bool,
}

/// Divides outputs into outputs that are not inputs of the table and outputs that are also inputs
/// of the table, such as a given temperature.
fn besides(
    outputs: Vec<&'static Output>,
    inputs: InputSet,
) -> (Vec<&'static Output>, Vec<&'static Output>) {
    outputs.into_iter().partition(|output| inputs.iter().all(|key| key.name() != output.name))
}

impl Task {
    /// Returns a task that writes the given outputs and shows no output.
    pub fn new(base: Case, settings: Settings, outputs: Vec<&'static Output>) -> Self {
        Self { base, settings, outputs, watched: None, filled: Vec::new(), estimates_rows: false }
    }

    /// Returns true if the points must be solved. Otherwise it is sufficient to read their inputs.
    pub(crate) fn solves(&self) -> bool {
        let mut outputs = self.outputs.iter().copied().chain(self.watched);
        self.outputs.is_empty() || outputs.any(Output::needs_solution)
    }

    /// Returns the task with an estimated groove if the groove is not given in full. The groove is
    /// estimated once for the base case, or in each row if a column changes the estimate.
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

    /// Returns a note on an estimated groove; `None` if the groove is given.
    pub fn groove_note(&self) -> Option<String> {
        if self.estimates_rows {
            let note = "The groove of each row that does not give it in full is estimated from the load ratings. Columns with `low` or \
                        `high` before the unit contain 90 % intervals over the possible grooves.";
            return Some(note.to_owned());
        }
        self.base.groove_note()
    }

    /// Returns a case with a groove. A case whose groove cannot be estimated is returned without a
    /// groove if only results of the axis are requested, which need no groove.
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

    /// Returns the task with one model for all points and columns, if a column depends on the
    /// motion of the ball.
    fn of_motion(mut self, given: InputSet) -> Self {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        if outputs.any(|output| output.analysis().is_some_and(AnalysisKind::needs_motion)) {
            self.settings.model = self.settings.model.of_motion(given);
        }
        self
    }

    /// Returns the task if points with the inputs `given`, solved by `model`, can fill its columns.
    fn checked(self, given: InputSet, model: ModelChoice) -> Result<Self, CaseError> {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        outputs.try_for_each(|output| output.check(&self.base, given, model))?;
        Ok(self)
    }

    /// Returns a task for all points of a grid, with one model for all points. Inputs that are
    /// missing for every point are an error.
    ///
    /// * `watched`: an output that is shown, but not written.
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

    /// Returns a task for the rows of a table. Inputs that are missing for every row are an error.
    ///
    /// # Errors
    ///
    /// [`CaseError::Entry`] if base and columns together lack an input of the model, and the errors
    /// of [`Output::check`].
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
