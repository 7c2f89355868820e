//! The choice of a screw among standard sizes: every combination of the lists is tried.

use rayon::prelude::*;

use crate::procedure::near_their_limits;
use crate::{
    Blocked, Check, Design, EfficiencyOf, Limits, Lists, Objective, Outcome, Pitch, Quantity,
    Requirement, Why,
};

/// Designs of the best capacity or mass whose efficiency is asked at first; more only if none of them
/// keeps the limits.
const ASKED: usize = 512;

impl Requirement {
    /// The best screw of standard sizes for the requirement: of every nominal diameter, lead, ball, number of turns,
    /// conformity and contact angle of `lists` that `limits` allow.
    ///
    /// Values that the requirement fixes replace the lists. `None` if no combination is within the limits.
    pub fn choose_standard(
        &self,
        lists: &Lists,
        limits: &Limits,
        efficiency: EfficiencyOf<'_>,
    ) -> Option<Outcome> {
        let lists = self.lists(lists);
        let limits = Limits { material: self.material, ..*limits };
        let places = lists.places(&limits);
        let designs = lists.map(&limits, &places, |_, candidate| {
            let fits = self
                .fixed
                .pitch_diameter
                .is_none_or(|diameter| (candidate.nut.pitch_diameter - diameter).abs() <= 1e-9);
            fits.then(|| Design::of(self, candidate.nut, None))
        });
        let complete = |design: &Design| Design::of(self, design.nut, Some(efficiency));
        let told = |check: &Check| !check.value.is_nan();
        let keeps = |design: &Design| design.checks.iter().filter(|c| told(c)).all(Check::passes);
        let limited = self.least_efficiency.is_some() || self.largest_power.is_some();
        let (mut kept, failed): (Vec<_>, Vec<_>) = designs.into_iter().partition(keeps);
        if limited || self.objective == Objective::Efficiency {
            kept = kept.par_iter().map(complete).filter(Design::is_feasible).collect();
        } else {
            kept.sort_by(|a, b| {
                a.objective(self.objective).total_cmp(&b.objective(self.objective))
            });
            let first = kept.len().min(ASKED);
            kept = kept[..first].par_iter().map(complete).collect();
        }
        let best = kept
            .into_iter()
            .filter(|design| design.objective(self.objective).is_finite())
            .min_by(|a, b| a.objective(self.objective).total_cmp(&b.objective(self.objective)));
        if let Some(design) = best {
            return Some(Outcome::Found { active: near_their_limits(&design), design });
        }
        blocked(failed, complete)
    }

    /// The lists with what is fixed in their place.
    fn lists(&self, lists: &Lists) -> Lists {
        let one =
            |fixed: Option<f64>, list: &[f64]| fixed.map_or(list.to_vec(), |value| vec![value]);
        let leads = self.pitches.iter().filter_map(|pitch| match pitch {
            Pitch::Lead(lead) => Some(*lead),
            Pitch::Angle(_) => None,
        });
        Lists {
            diameters: lists.diameters.clone(),
            leads: leads.collect(),
            balls: one(self.fixed.ball, &lists.balls),
            turns: one(self.fixed.turns, &lists.turns),
            conformities: one(self.fixed.conformity, &lists.conformities),
            contact_angles: one(self.fixed.contact_angle, &lists.contact_angles),
        }
    }
}

/// Why no standard size keeps all limits: the one that fails least, and each limit that alone is in the way, with
/// the best value that it could have.
fn blocked(designs: Vec<Design>, complete: impl Fn(&Design) -> Design) -> Option<Outcome> {
    let excess = |design: &Design| -> f64 {
        let far = design.checks.iter().filter_map(Check::excess).filter(|e| e.is_finite());
        far.map(|excess| excess.max(0.0).powi(2)).sum()
    };
    let failing = |design: &Design| -> Vec<Check> {
        let told = design.checks.iter().filter(|check| !check.value.is_nan());
        told.filter(|check| !check.passes()).copied().collect()
    };
    let mut alone: Vec<(Quantity, Check)> = Vec::new();
    for design in &designs {
        // The only one that fails.
        if let [check] = failing(design)[..] {
            match alone.iter_mut().find(|(quantity, _)| *quantity == check.quantity) {
                Some((_, best)) if check.excess() < best.excess() => *best = check,
                Some(_) => {}
                None => alone.push((check.quantity, check)),
            }
        }
    }
    let nearest = designs.into_iter().min_by(|a, b| excess(a).total_cmp(&excess(b)));
    let nearest = nearest?;
    let mut blocking: Vec<_> = alone
        .into_iter()
        .map(|(_, check)| Blocked { why: Why::Alone(check.value), check })
        .collect();
    if blocking.is_empty() {
        let with = |check: Check| Blocked { check, why: Why::WithOthers };
        blocking = failing(&nearest).into_iter().map(with).collect();
    }
    Some(Outcome::Infeasible { design: complete(&nearest), blocking })
}
