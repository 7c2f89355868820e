//! Derivatives of efficiency and torque with respect to inputs.

use std::cell::Cell;

use bsm_dyn::{ModelWorkspace, Problem, SolveFailure, solution::Performance};
use bsm_kin::Jet;

use crate::case::reader::Reader;
use crate::vocabulary::members::row;
use crate::{Case, CaseError, InputKey, InputSet, Quantity, Settings};

/// Number of inputs whose derivatives are calculated in a single solver run. The time of a run
/// increases with this number, and most callers request fewer derivatives.
const AT_A_TIME: usize = 8;

row! {
    /// Derivatives with respect to an input.
    #[expect(non_snake_case, reason = "the names end with unit symbols")]
    pub(crate) struct SensitivityRow {
        [skip] input: &'static str = "sensitivity to";
        [skip] unit: &'static str = "unit";
        [skip] value: f64 = "value";
        /// Relative change of the efficiency divided by the relative change of the input.
        efficiency_relative: Option<f64> = "efficiency, %/%";
        /// Relative change of the torque divided by the relative change of the input.
        ball_torque_relative: Option<f64> = "torque, %/%";
        /// Derivative of the efficiency.
        efficiency: f64 = "efficiency, 1/unit";
        /// Derivative of the torque \[N·m\].
        ball_torque_Nm: Option<f64> = "torque, N m/unit";
    }
}

/// A number together with its derivatives with respect to several inputs, in the units of these
/// inputs.
type Jets = Jet<AT_A_TIME>;

/// A case that is prepared for derivatives with respect to several inputs.
#[derive(Debug, Clone)]
pub struct Sensitivities(Vec<Part>);

/// The problem in SI units, and the inputs with respect to which it is differentiated, each with
/// its value.
#[derive(Debug, Clone)]
struct Part(Problem<Jets>, Vec<(InputKey, f64)>);

/// Sensitivities of efficiency and torque with respect to one input.
#[derive(Debug, Clone, Copy)]
pub struct Sensitivity {
    /// Input with respect to which the results are differentiated.
    pub input: &'static Quantity,
    /// Given or default value of the input.
    pub value: f64,
    /// Derivative of the efficiency with respect to the input, per unit of the input.
    pub efficiency: f64,
    /// Derivative of the screw torque with respect to the input \[N·m\] per unit of the input;
    /// `None` if there is no torque.
    pub screw_torque: Option<f64>,
    /// Relative change of the efficiency per relative change of the input \[%/%\]; `None` if the
    /// efficiency or the input is zero.
    pub relative_efficiency: Option<f64>,
    /// Relative change of the torque per relative change of the input \[%/%\]; `None` if the torque
    /// or the input is zero.
    pub relative_torque: Option<f64>,
}

impl Sensitivities {
    /// Prepares the derivatives of a case with respect to all inputs of its model. If the default
    /// value of an input is calculated from a second input, the derivatives with respect to the
    /// second input include the resulting change of the default value.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Case::problem`].
    pub fn of(case: &Case, settings: &Settings) -> Result<Self, CaseError> {
        Self::by(case, settings, InputKey::ALL.into_iter().collect())
    }

    /// Prepares the derivatives of a case with respect to the inputs in `wanted` that the model
    /// uses.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Case::problem`].
    pub fn by(case: &Case, settings: &Settings, wanted: InputSet) -> Result<Self, CaseError> {
        // The derivatives are calculated for constant temperatures, which are the temperatures of
        // the warm state.
        let case = &case.in_warm_state(settings)?;
        let model = case.check_and_choose(settings)?;
        let used = Cell::new(InputSet::default());
        let part = |variables: &[(InputKey, f64)]| {
            let jet = |key: InputKey| {
                let value = case.value_or_default(key)?;
                used.set(used.get().union(InputSet::of(&[key])));
                let place = variables.iter().position(|(variable, _)| *variable == key);
                Some(place.map_or(value.into(), |place| Jets::variable(value, place)))
            };
            let problem = Reader(jet, case.base_oil()).problem(model, settings);
            Part(problem, variables.to_vec())
        };
        let alone = part(&[]);
        let value = |key: InputKey| case.value_or_default(key).map(|value| (key, value));
        let used = used.get().iter().filter(|key| wanted.contains(*key));
        let variables: Vec<_> = used.filter_map(value).collect();
        if variables.is_empty() {
            return Ok(Self(vec![alone]));
        }
        Ok(Self(variables.chunks(AT_A_TIME).map(part).collect()))
    }

    /// Returns efficiency and torque, and their sensitivities with respect to each input. The rows
    /// are sorted by the effect of the input on the efficiency.
    ///
    /// # Errors
    /// Returns the same errors as [`Problem::sensitivities`].
    pub fn solve(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<(Performance<f64>, Vec<Sensitivity>), SolveFailure> {
        let mut rows = Vec::new();
        let mut value = Performance { efficiency: f64::NAN, screw_torque: None };
        for Part(problem, variables) in &self.0 {
            let answer = problem.sensitivities(work)?;
            let torque = answer.screw_torque.map(|torque| torque.re);
            value = Performance { efficiency: answer.efficiency.re, screw_torque: torque };
            rows.extend((0..).zip(variables).map(|(place, (key, value))| {
                let relative = |output: &Jets| {
                    let share = output.eps[place] * value / output.re;
                    (*value != 0.0 && share.is_finite()).then_some(share)
                };
                Sensitivity {
                    input: key.input(),
                    value: *value,
                    efficiency: answer.efficiency.eps[place],
                    screw_torque: answer.screw_torque.map(|torque| torque.eps[place]),
                    relative_efficiency: relative(&answer.efficiency),
                    relative_torque: answer.screw_torque.as_ref().and_then(relative),
                }
            }));
        }
        let size = |row: &Sensitivity| row.relative_efficiency.map_or(-1.0, f64::abs);
        rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
        Ok((value, rows))
    }
}

impl Sensitivity {
    /// Returns a row of the table of sensitivities.
    pub(crate) fn row(&self) -> SensitivityRow {
        SensitivityRow {
            input: self.input.name,
            unit: self.input.unit,
            value: self.value,
            efficiency_relative: self.relative_efficiency,
            ball_torque_relative: self.relative_torque,
            efficiency: self.efficiency,
            ball_torque_Nm: self.screw_torque,
        }
    }
}
