//! The task that is performed for every row of a table.

use bsm_case::{AnalysisKind, Case, CaseError, Grid, InputSet, ModelChoice, Output, Settings};

use crate::Columns;

/// Settings that all rows of a table share.
#[derive(Debug, Clone)]
pub struct Task {
    /// The inputs that are no columns.
    pub base: Case,
    /// The model and its settings.
    pub settings: Settings,
    /// Outputs to write.
    pub outputs: Vec<&'static Output>,
    /// An output that is only looked at: the last column of the answers that are shown.
    pub watched: Option<&'static Output>,
    /// Outputs that are inputs of the table too, as a temperature: rows that do not give them get them.
    pub filled: Vec<&'static Output>,
}

/// The outputs that are not the inputs of a table under the same name, as a temperature that is given; and those
/// that are.
fn besides(
    outputs: Vec<&'static Output>,
    inputs: InputSet,
) -> (Vec<&'static Output>, Vec<&'static Output>) {
    outputs.into_iter().partition(|output| inputs.iter().all(|key| key.name() != output.name))
}

impl Task {
    /// A task that writes these outputs and watches none.
    pub fn new(base: Case, settings: Settings, outputs: Vec<&'static Output>) -> Self {
        Self { base, settings, outputs, watched: None, filled: Vec::new() }
    }

    /// True if the points must be solved, and not only the inputs be read.
    pub(crate) fn solves(&self) -> bool {
        let mut outputs = self.outputs.iter().copied().chain(self.watched);
        self.outputs.is_empty() || outputs.any(Output::needs_solution)
    }

    /// The task with one model for all points and columns, if a column is of the motion of the ball.
    fn of_motion(mut self, given: InputSet) -> Self {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        if outputs.any(|output| output.analysis().is_some_and(AnalysisKind::needs_motion)) {
            self.settings.model = self.settings.model.of_motion(given);
        }
        self
    }

    /// The task, if points that have the inputs `given` and are solved with `model` can fill its columns.
    fn checked(self, given: InputSet, model: ModelChoice) -> Result<Self, CaseError> {
        let mut outputs = self.outputs.iter().chain(&self.watched);
        outputs.try_for_each(|output| output.check(&self.base, given, model))?;
        Ok(self)
    }

    /// A task for all points of a grid, with one model for all of them. Inputs that every point
    /// lacks are an error here.
    ///
    /// * `watched`: an output that is only looked at.
    ///
    /// # Errors
    ///
    /// As [`Grid::choose`], and as [`Output::check`].
    pub fn over_grid(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        watched: Option<&'static Output>,
        grid: &Grid,
    ) -> Result<Self, CaseError> {
        let given = base.stated().overridden_by(grid.varied());
        let (outputs, _) = besides(outputs, grid.varied());
        let mut task = Self { watched, ..Self::new(base, settings, outputs) }.of_motion(given);
        if task.solves() {
            task.settings.model = grid.choose(&task.base, task.settings.model)?;
        } else {
            grid.check(&task.base)?;
        }
        let model = task.settings.model;
        task.checked(given, model)
    }

    /// A task for the rows of a table. Inputs that every row lacks are an error here.
    ///
    /// # Errors
    ///
    /// [`CaseError::Entry`] if base and columns together lack an input of the model, and those of
    /// [`Output::check`].
    pub fn over_table(
        base: Case,
        settings: Settings,
        outputs: Vec<&'static Output>,
        columns: &Columns,
    ) -> Result<Self, CaseError> {
        let given = base.stated().and(columns.set());
        let (outputs, filled) = besides(outputs, columns.set());
        let task = Self { filled, ..Self::new(base, settings, outputs) }.of_motion(given);
        let model = task.settings.model;
        let model = if task.solves() { model.resolve(given, |_| Ok(()))? } else { model };
        task.checked(given, model)
    }
}
