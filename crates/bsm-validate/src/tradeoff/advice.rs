//! The recommended setting for each tolerance.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Errors, Group, OneCore, SettingResult, TOLERANCES};

/// A setting counts as within a tolerance if it solves this share of the points, and as large a share
/// of those errs less.
const SHARE: f64 = 0.99;

/// The cheapest settings within a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Advice {
    /// Error of the efficiency that 99 % of the points keep.
    pub tolerance: f64,
    /// The points; a setting for all of them is within the tolerance for each motion.
    pub group: Group,
    /// Cheapest for one point.
    pub single: Option<Pick>,
    /// Cheapest in batches on one core.
    pub batch: Option<Pick>,
}

/// A setting that was picked.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Pick {
    /// Model and options.
    pub setting: String,
    /// Time of a point \[ns\].
    pub ns: f64,
    /// Where it is not within the tolerance.
    pub fails_where: Vec<Group>,
}

/// For every tolerance: over all points, and by motion of the balls.
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

/// Of the settings within a tolerance that take hardly longer than the cheapest, the most exact: times
/// move from run to run.
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

/// True if a setting is within a tolerance in a group; for all points, in every group.
fn is_within(result: &SettingResult, group: Group, tolerance: f64) -> bool {
    let counts = |errors: &&Errors| group == Group::All || errors.group == group;
    result.errors.iter().filter(counts).all(|errors| within(errors, tolerance))
}

fn within(errors: &Errors, tolerance: f64) -> bool {
    errors.solved >= SHARE && errors.efficiency.is_some_and(|e| e.q99 <= tolerance)
}
