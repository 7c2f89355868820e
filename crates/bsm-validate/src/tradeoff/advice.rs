//! Recommends a setting for each tolerance and each group of points.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Errors, Group, OneCore, SettingResult, TOLERANCES};

/// Minimum fraction of the points that a recommended setting must solve, and minimum fraction of
/// the solved points at which its error must be within the tolerance.
const SHARE: f64 = 0.99;

/// The fastest settings whose efficiency error is within a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Advice {
    /// Efficiency error that 99 % of the points must not exceed.
    pub tolerance: f64,
    /// Group of points for which the settings are recommended. If the group contains all points,
    /// the settings are within the tolerance in every slip regime.
    pub group: Group,
    /// Fastest setting if the points are solved one by one.
    pub single: Option<Pick>,
    /// Fastest setting if the points are solved as a table on one core.
    pub batch: Option<Pick>,
}

/// A recommended setting, and its time per point.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Pick {
    /// Model and options of the recommended setting.
    pub setting: String,
    /// Calculation time per point \[ns\].
    pub ns: f64,
    /// Slip regimes in which the error of this setting exceeds the tolerance.
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

/// Returns the recommended setting for a tolerance. Of all settings that meet the tolerance and are
/// nearly as fast as the fastest such setting, the most accurate setting is recommended. Small
/// differences in time are ignored, because measured times vary.
fn pick(
    settings: &[SettingResult],
    group: Group,
    tolerance: f64,
    time: fn(&OneCore) -> f64,
) -> Option<Pick> {
    const TIME_TOLERANCE: f64 = 1.2;
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
    let near = timed.into_iter().filter(|(_, ns)| *ns <= TIME_TOLERANCE * least);
    let (result, ns) = near.min_by(|a, b| error(a.0).total_cmp(&error(b.0)))?;
    let fails = |errors: &&Errors| errors.group != Group::All && !within(errors, tolerance);
    let fails_where = result.errors.iter().filter(fails).map(|errors| errors.group).collect();
    Some(Pick { setting: result.setting.name(), ns, fails_where })
}

/// Returns true if the error of a setting is within a tolerance in a group of points. If the group
/// contains all points, the error must be within the tolerance in every slip regime.
fn is_within(result: &SettingResult, group: Group, tolerance: f64) -> bool {
    let counts = |errors: &&Errors| group == Group::All || errors.group == group;
    result.errors.iter().filter(counts).all(|errors| within(errors, tolerance))
}

fn within(errors: &Errors, tolerance: f64) -> bool {
    errors.solved >= SHARE && errors.efficiency.is_some_and(|e| e.q99 <= tolerance)
}
