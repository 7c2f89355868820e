//! Selection of a screw from standard sizes by evaluating every combination in the lists.

use std::cmp::Ordering::Equal;

use rayon::prelude::*;

use crate::catalog::{Limits, Lists, OfferedSize};
use crate::procedure::{Selection, first_accepted};
use crate::{
    AcceptedBy, ActiveLimit, BindingLimit, Check, Design, EfficiencyOf, FixedValues, Infeasibility,
    Outcome, Pitch, RejectedDesigns, Requirement,
};

/// Maximum number of designs whose efficiency is calculated to find out whether a limit affects the
/// selection.
const MAX_EFFICIENCY_SOLVES: usize = 64;

impl Requirement {
    /// Returns the best screw with a standard size that meets the requirement. The search evaluates
    /// all combinations of nominal diameter, lead, ball diameter, number of turns, conformity and
    /// contact angle in `lists` that are within `limits`.
    ///
    /// Fixed values of the requirement replace the corresponding lists. Returns `None` if no
    /// combination is within the limits.
    pub fn choose_standard(
        &self,
        lists: &Lists,
        limits: &Limits,
        efficiency: EfficiencyOf<'_>,
        accepted: AcceptedBy<'_>,
    ) -> Option<Outcome> {
        let offered = !lists.offered.is_empty();
        let lists = self.lists(lists);
        if offered && lists.offered.is_empty() {
            return None;
        }
        let limits = Limits { material: self.material, ..*limits };
        let indices = lists.indices(&limits);
        let designs = lists.map(&limits, &indices, |_, candidate| {
            let fits = self
                .fixed
                .pitch_diameter
                .is_none_or(|diameter| (candidate.nut.pitch_diameter - diameter).abs() <= 1e-9);
            fits.then(|| Design::of_candidate(self, candidate))
        });
        let complete = |design: &Design| design.with_efficiency(self, efficiency);
        let known = |check: &Check| !check.value.is_nan();
        let keeps = |design: &Design| design.checks.iter().filter(|c| known(c)).all(Check::passes);
        let limited = self.least_efficiency.is_some() || self.largest_power.is_some();
        let needs_efficiency = limited || self.objective.asks_efficiency();
        let (mut kept, mut failed): (Vec<_>, Vec<_>) = designs.into_iter().partition(keeps);
        if needs_efficiency {
            let (whole, part) = kept.par_iter().map(complete).partition(Design::is_feasible);
            kept = whole;
            failed.extend::<Vec<_>>(part);
        }
        kept.retain(|design| design.objective(self.objective).is_finite());
        kept.sort_by(|a, b| a.objective(self.objective).total_cmp(&b.objective(self.objective)));
        let Selection { first, rejected } =
            first_accepted(&kept.iter().collect::<Vec<_>>(), accepted);
        if let Some(design) = first {
            let design = complete(design);
            let active = self.limits_of_better_designs(&failed, &design, complete);
            return Some(Outcome::Found { design, active, rejected });
        }
        if let [best, ..] = &kept[..] {
            let (design, blocking) = (complete(best), Vec::new());
            return Some(Outcome::Infeasible { design, blocking, rejected });
        }
        blocked(failed, complete)
    }

    /// Returns the limits that rule out better designs than the selected design. If no single limit
    /// does so, returns the limits that the nearest better design violates.
    fn limits_of_better_designs(
        &self,
        failed: &[Design],
        chosen: &Design,
        complete: impl Fn(&Design) -> Design + Sync,
    ) -> Vec<BindingLimit> {
        let Self { objective, .. } = *self;
        let best = chosen.objective(objective);
        // Returns the objective if the design is better than the selected design.
        let better = |design: &Design| {
            let number = |design: &Design| {
                let value = (design.objective(objective), design.value(objective.quantity()));
                (value.0 < best).then_some(value)
            };
            if objective.asks_efficiency() { number(&complete(design)) } else { number(design) }
        };
        // Each efficiency requires a solution of the ball model, so the number of evaluations is
        // limited.
        let most = if objective.asks_efficiency() { MAX_EFFICIENCY_SOLVES } else { usize::MAX };
        let mut nearest: Vec<_> = failed.iter().map(|design| (violation(design), design)).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let holds = |designs: Vec<(Check, &Design)>| {
            let quantity = designs[0].0.quantity;
            let first = &designs[..most.min(designs.len())];
            let better = first.par_iter().filter_map(|(_, design)| better(design));
            let (_, value) = better.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(BindingLimit { quantity, without: Some(value) })
        };
        let single_violations = single_violations(nearest.iter().map(|(_, design)| *design));
        let found: Vec<_> = single_violations.into_iter().filter_map(holds).collect();
        if !found.is_empty() {
            return found;
        }
        let next = nearest.iter().take(most).find(|(_, design)| better(design).is_some());
        next.map_or_else(Vec::new, |(_, design)| {
            let failing = failing(design).into_iter();
            failing.map(|check| BindingLimit { quantity: check.quantity, without: None }).collect()
        })
    }

    /// Returns the lists in which fixed values of the requirement replace the corresponding lists.
    fn lists(&self, lists: &Lists) -> Lists {
        let one =
            |fixed: Option<f64>, list: &[f64]| fixed.map_or(list.to_vec(), |value| vec![value]);
        let leads = self.pitches.iter().filter_map(|pitch| match pitch {
            Pitch::Lead(lead) => Some(*lead),
            Pitch::Angle(_) => None,
        });
        let leads: Vec<_> = leads.collect();
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9;
        let fits = |size: &&OfferedSize| {
            let FixedValues { ball, turns, .. } = self.fixed;
            self.permits_make(size.make)
                && leads.iter().any(|lead| near(*lead, size.lead))
                && ball.is_none_or(|ball| near(ball, size.ball))
                && turns.is_none_or(|turns| near(turns, size.turns))
        };
        Lists {
            offered: lists.offered.iter().filter(fits).copied().collect(),
            diameters: lists.diameters.clone(),
            leads,
            balls: one(self.fixed.ball, &lists.balls),
            turns: one(self.fixed.turns, &lists.turns),
            conformities: one(self.fixed.conformity, &lists.conformities),
            contact_angles: one(self.fixed.contact_angle, &lists.contact_angles),
        }
    }
}

/// Returns the total violation of all limits by a design.
fn violation(design: &Design) -> f64 {
    let far = design.checks.iter().filter_map(Check::violation).filter(|e| e.is_finite());
    far.map(|violation| violation.max(0.0).powi(2)).sum()
}

/// Returns the checks that a design fails.
fn failing(design: &Design) -> Vec<Check> {
    let known = design.checks.iter().filter(|check| !check.value.is_nan());
    known.filter(|check| !check.passes()).copied().collect()
}

/// Returns the designs that violate exactly one limit, grouped by this limit.
fn single_violations<'a>(
    designs: impl Iterator<Item = &'a Design>,
) -> Vec<Vec<(Check, &'a Design)>> {
    let mut single_violations: Vec<Vec<(Check, &Design)>> = Vec::new();
    for design in designs {
        if let [check] = failing(design)[..] {
            match single_violations.iter_mut().find(|group| group[0].0.quantity == check.quantity) {
                Some(group) => group.push((check, design)),
                None => single_violations.push(vec![(check, design)]),
            }
        }
    }
    single_violations
}

/// Returns the reason why no standard size meets all limits. The result contains the design with
/// the smallest violation. For each limit that alone prevents a solution, the result also contains
/// the best value of the limited quantity without this limit.
fn blocked(designs: Vec<Design>, complete: impl Fn(&Design) -> Design) -> Option<Outcome> {
    let least = |mut designs: Vec<(Check, &Design)>| {
        designs
            .sort_by(|(a, _), (b, _)| a.violation().partial_cmp(&b.violation()).unwrap_or(Equal));
        // Calculating the efficiency, which requires a solution of the ball model, may reveal that
        // the design violates another limit.
        let alone = |(_, design): &(Check, &Design)| failing(&complete(design)).len() == 1;
        let (least, _) = designs.into_iter().take(MAX_EFFICIENCY_SOLVES).find(alone)?;
        Some(ActiveLimit { cause: Infeasibility::SingleLimit(least.value), check: least })
    };
    let mut blocking: Vec<_> =
        single_violations(designs.iter()).into_iter().filter_map(least).collect();
    let nearest = designs.into_iter().min_by(|a, b| violation(a).total_cmp(&violation(b)))?;
    if blocking.is_empty() {
        let with = |check: Check| ActiveLimit { check, cause: Infeasibility::SeveralLimits };
        blocking = failing(&nearest).into_iter().map(with).collect();
    }
    let rejected = RejectedDesigns::default();
    Some(Outcome::Infeasible { design: complete(&nearest), blocking, rejected })
}
