//! Recommends settings for each tolerance.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Errors, Group, OneCore, SettingResult, TOLERANCES};

/// Minimum fraction of points that a recommended setting must solve. It is also the minimum
/// fraction of solved points whose error must be within the tolerance.
const SHARE: f64 = 0.99;

/// The fastest settings whose error is within a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Advice {
    /// Efficiency error that 99 % of the points must not exceed.
    pub tolerance: f64,
    /// Group of points. A setting that is recommended for all points is within the tolerance in
    /// every regime.
    pub group: Group,
    /// Fastest setting for single solves.
    pub single: Option<Pick>,
    /// Fastest setting for batches on one core.
    pub batch: Option<Pick>,
}

/// A recommended setting.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Pick {
    /// Model and options of the setting.
    pub setting: String,
    /// Time per point \[ns\].
    pub ns: f64,
    /// Groups in which the error of the setting exceeds the tolerance.
    pub fails_where: Vec<Group>,
}

/// Returns the recommendations for every tolerance and every group of points.
pub(super) fn of(settings: &[SettingResult], groups: &[Group]) -> Vec<Advice> {
    let mut advice = Vec::new();
    for tolerance in TOLERANCES {
        for group in groups {
            let pick = |time: fn(&OneCore) -> f64| pick(settings, *group, tolerance, time);
            let (single, batch) = (pick(|times| times.single.mean), pick(|times| times.batch));
            advice.push(Advice { tolerance, group: *group, single, batch });
        }
    }
    advice
}

/// Among the settings that are within a tolerance, returns the most accurate setting that takes
/// little more time than the fastest one. Small time differences are ignored because times vary
/// from run to run.
fn pick(
    settings: &[SettingResult],
    group: Group,
    tolerance: f64,
    time: fn(&OneCore) -> f64,
) -> Option<Pick> {
    const HARDLY: f64 = 1.2;
    let timed: Vec<_> = settings
        .iter()
        .filter(|result| is_within(result, group, tolerance))
        .filter_map(|result| Some((result, time(result.times.of(group)?))))
        .collect();
    let least = timed.iter().map(|(_, ns)| *ns).min_by(f64::total_cmp)?;
    let error = |result: &SettingResult| {
        let errors = result.errors_of(group).and_then(|errors| errors.efficiency);
        errors.map_or(f64::INFINITY, |e| e.q99)
    };
    let near = timed.into_iter().filter(|(_, ns)| *ns <= HARDLY * least);
    let (result, ns) = near.min_by(|a, b| error(a.0).total_cmp(&error(b.0)))?;
    let fails = |errors: &&Errors| errors.group != Group::All && !within(errors, tolerance);
    let fails_where = result.errors.iter().filter(fails).map(|errors| errors.group).collect();
    Some(Pick { setting: result.setting.name(), ns, fails_where })
}

/// Returns true if the error of a setting is within a tolerance in a group of points. For the group
/// of all points, this must be true in every group.
fn is_within(result: &SettingResult, group: Group, tolerance: f64) -> bool {
    let counts = |errors: &&Errors| group == Group::All || errors.group == group;
    result.errors.iter().filter(counts).all(|errors| within(errors, tolerance))
}

fn within(errors: &Errors, tolerance: f64) -> bool {
    errors.solved >= SHARE && errors.efficiency.is_some_and(|e| e.q99 <= tolerance)
}
