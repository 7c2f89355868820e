//! Which dial for which tolerance.

use serde::Serialize;

use super::{Errors, Group, Measured, TOLERANCES};

/// A dial counts as within a tolerance if it solves this share of the points, and as large a share
/// of those errs less.
const SHARE: f64 = 0.99;

/// The cheapest dials within a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// Error of the efficiency that 99 % of the points keep.
    pub tolerance: f64,
    /// The points.
    pub group: Group,
    /// Cheapest for one point.
    pub single: Option<Pick>,
    /// Cheapest in batches on one core.
    pub batch: Option<Pick>,
}

/// A dial that was picked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pick {
    /// Model and options.
    pub dial: String,
    /// Time of a point \[ns\].
    pub ns: f64,
    /// Where it is not within the tolerance.
    pub fails_where: Vec<Group>,
}

/// For every tolerance: over all points, and by motion of the balls.
pub(super) fn of(dials: &[Measured]) -> Vec<Advice> {
    let mut advice = Vec::new();
    for tolerance in TOLERANCES {
        for group in Group::ALL {
            let pick = |time: fn(&Measured, Group) -> Option<f64>| {
                dials
                    .iter()
                    .filter(|dial| {
                        dial.errors.iter().any(|e| e.group == group && within(e, tolerance))
                    })
                    .filter_map(|dial| Some((dial, time(dial, group)?)))
                    .min_by(|a, b| a.1.total_cmp(&b.1))
                    .map(|(dial, ns)| Pick {
                        dial: dial.dial.name(),
                        ns,
                        fails_where: fails_where(dial, tolerance),
                    })
            };
            let single =
                pick(|dial, group| dial.times.single.iter().find(|(other, _)| *other == group)?.1);
            let batch = pick(|dial, _| Some(dial.times.batch));
            advice.push(Advice { tolerance, group, single, batch });
        }
    }
    advice
}

fn within(errors: &Errors, tolerance: f64) -> bool {
    errors.solved >= SHARE && errors.efficiency.is_some_and(|e| e.q99 <= tolerance)
}

fn fails_where(dial: &Measured, tolerance: f64) -> Vec<Group> {
    let failing = dial.errors.iter().filter(|e| e.group != Group::All && !within(e, tolerance));
    failing.map(|errors| errors.group).collect()
}
