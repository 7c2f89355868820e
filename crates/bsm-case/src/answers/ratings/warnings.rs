//! Warnings about nuts with unfavorable proportions or outside the limits of the catalog formulas.

use bsm_design::catalog::Limits;
use bsm_design::life::UNLOADING_RATIO;
use bsm_design::{Elasticity, LIMIT_LOAD, Nut, NutBody, PRELOAD, Range, Thread};

use crate::format_exact;
use crate::vocabulary::units::{MM, UM};
use crate::vocabulary::warning::{SelectionLimit, Warning};

/// Returns warnings about unfavorable proportions and about inputs outside the limits of the
/// catalog formulas.
pub(super) fn limit_warnings(
    nut: &Nut,
    thread: &Thread,
    body: &NutBody,
    limits: &Limits,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if body.length < nut.turns * nut.pitch() {
        warnings.push(Warning::advice(format!(
            "A nut with a length of {:.3} mm is too short for {} loaded turns at a pitch of {:.3} mm.",
            body.length / MM,
            nut.turns,
            nut.pitch() / MM
        )));
    }
    let Range { low: few, high: many } = limits.turns;
    if nut.turns < few || nut.turns > many {
        let text = format!(
            "loaded_turns = {}: {few} to {many} turns are typical. Fewer turns guide the screw poorly; with more turns, the \
             outer turns carry little load, which the load ratings do not take into account.",
            nut.turns
        );
        let limit = (nut.turns > many).then_some(SelectionLimit::LoadedTurns);
        warnings.push(Warning { text, limit });
    }
    let over_pitch = nut.ball_diameter / nut.pitch();
    if over_pitch > limits.ball_over_lead * (1.0 + 1e-9) {
        let text = format!(
            "The ball diameter is {over_pitch:.3} times the groove pitch; if this ratio is above {}, the land between the turns is narrow.",
            limits.ball_over_lead
        );
        warnings.push(Warning::limit(SelectionLimit::BallOverLead, text));
    }
    let root = thread.screw.root;
    if nut.ball_diameter >= limits.ball_over_root * root {
        warnings.push(Warning::advice(format!(
            "The ball diameter is {:.3} times the root diameter of the screw, {:.3} mm; this ratio should be below {}.",
            nut.ball_diameter / root,
            root / MM,
            limits.ball_over_root
        )));
    }
    if body.mass(nut, thread) <= 0.0 {
        let text =
            "The grooves of this nut are larger than its body, so the mass is not calculated.";
        warnings.push(Warning::advice(text));
    }
    for (name, conformity) in
        [("nut_conformity", nut.conformity.nut), ("screw_conformity", nut.conformity.screw)]
    {
        if !limits.conformity.contains(conformity) {
            let Range { low, high } = limits.conformity;
            let text = format!(
                "{name} = {conformity}, but the rating formulas were fitted for {low} to {high}."
            );
            warnings.push(Warning::advice(text));
        }
    }
    warnings
}

/// Returns warnings if the preload of a pair is larger than recommended (D22) or too small for the
/// load (D23).
pub(super) fn preload_warnings(
    elasticity: &Elasticity,
    preload: f64,
    load: Option<f64>,
    rating: f64,
) -> Vec<String> {
    let mut warnings = Vec::new();
    // F_w ≤ 0.15 C_a                                                      (D22)
    if preload > PRELOAD * rating * (1.0 + 1e-9) {
        warnings.push(format!(
            "preload_N is {:.3} times the dynamic load rating; above a ratio of {PRELOAD}, the preload reduces the life.",
            preload / rating
        ));
    }
    // F_m ≤ 3 F_w                                                         (D23)
    if let Some(load) = load.filter(|load| *load > LIMIT_LOAD * preload * (1.0 + 1e-9)) {
        let alone = elasticity.preloaded_displacement(preload, load);
        warnings.push(format!(
            "The load of {} N is more than {LIMIT_LOAD} times the preload. Above {:.0} N (with equal ball loads), one nut is unloaded, \
             the stiffness of the pair is not valid, and the displacement is the displacement of the other nut alone, \
             {:.3} um.",
            format_exact(load.round()),
            UNLOADING_RATIO * preload,
            alone / UM
        ));
    }
    warnings
}
