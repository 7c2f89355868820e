//! Ball circuits of a nut, and the deviations of the ball diameters.

use std::f64::consts::TAU;

use bsm_design::Nut;
use bsm_nut::{Circuit, Flanks, LeadError, PreloadKind};

use super::loading::{DEFAULT_ARRANGEMENT, arrangement, is_preloaded};
use crate::vocabulary::entries::{Arrangement, CaseEntries, CircuitEntry, LeadErrorEntry, Named};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input_set::loaded_turns;
use crate::vocabulary::number::{count, whole};
use crate::vocabulary::units::{DEG, MM, UM};
use crate::{Case, CaseError, InputKey, Rule};

/// Inputs that define all circuits together if the circuits are not listed individually.
pub(super) const SHORT: [InputKey; 5] = [
    InputKey::circuits_count,
    InputKey::loaded_turns,
    InputKey::loaded_balls_per_turn,
    InputKey::gap_deg,
    InputKey::phase_deg,
];

/// Permitted range of helix angles in a nut \[deg\]. The range is sufficient for thousands of
/// turns.
const ANGLES: Rule = Rule::Within(-1e6, 1e6);

/// Maximum number of balls of a nut.
const MAX_BALLS: usize = 100_000;

/// Loaded turns of one nut body.
pub(crate) struct NutTurns {
    /// Number of loaded balls per turn, if it is known.
    pub(crate) balls_per_turn: Option<f64>,
    /// Number of loaded turns, if it is known.
    pub(crate) turns: Option<f64>,
}

impl NutTurns {
    /// Determines the loaded turns of a case from the listed circuits or from the inputs [`SHORT`].
    pub(crate) fn of(case: &Case) -> Self {
        let Some(circuits) = &case.entries.circuits else {
            return Self {
                balls_per_turn: case.loaded_balls_per_turn,
                turns: loaded_turns(|key| case[key]),
            };
        };
        let first = || circuits.iter().filter(|circuit| circuit.body == 0);
        let turns = first().map(|circuit| circuit.arc_deg).sum::<f64>() / 360.0;
        let balls = first().map(|circuit| circuit.balls).sum::<usize>();
        Self { balls_per_turn: Some(count(balls) / turns), turns: Some(turns) }
    }
}

/// Returns the nut design in which the number of balls per turn and the number of turns are taken
/// from the circuits of one nut body.
pub(super) fn of_circuits(design: Nut, circuits: &[Circuit]) -> Nut {
    let first = || circuits.iter().filter(|circuit| circuit.body == 0);
    let turns = first().map(|circuit| circuit.arc).sum::<f64>() / TAU;
    let balls = first().map(|circuit| circuit.balls).sum::<usize>();
    Nut { balls_per_turn: count(balls) / turns, turns, ..design }
}

/// Returns the flank of a nut body on which the preload of the pair acts.
fn flank_of(body: usize, arrangement: Arrangement) -> Flanks {
    let first = body.is_multiple_of(2);
    if first == (arrangement == Arrangement::X) { Flanks::Plus } else { Flanks::Minus }
}

pub(super) fn listed_circuits(
    listed: &[CircuitEntry],
    starts: f64,
    arrangement: Option<Arrangement>,
) -> Result<Vec<Circuit>, CaseError> {
    if listed.is_empty() {
        return Err(invalid_input("circuits", "must not be empty"));
    }
    let bodies = 1 + listed.iter().map(|circuit| circuit.body).max().unwrap_or(0);
    if let Some(body) = (0..bodies.min(MAX_BALLS)).find(|b| listed.iter().all(|c| c.body != *b)) {
        return Err(invalid_input("circuits", format!("contains no circuit for nut body {body}")));
    }
    let mut balls = 0_usize;
    let mut all = Vec::new();
    for (i, entry) in listed.iter().enumerate() {
        let path = |key: &str| format!("circuits[{i}].{key}");
        balls = balls.saturating_add(entry.balls);
        if entry.balls == 0 || balls > MAX_BALLS {
            let rule = format!("from 1 to {MAX_BALLS} for all circuits together");
            return Err(CaseError::out_of_range(path("balls"), count(entry.balls), rule));
        }
        if count(entry.start) >= starts {
            let rule = format!("below the number of starts, {starts}");
            return Err(CaseError::out_of_range(path("start"), count(entry.start), rule));
        }
        let arc = Rule::Above(0.0).checked(&path("arc_deg"), entry.arc_deg)?;
        all.push(Circuit {
            start: ANGLES.checked(&path("start_deg"), entry.start_deg)? * DEG,
            arc: ANGLES.checked(&path("arc_deg"), arc)? * DEG,
            balls: entry.balls,
            thread: entry.start,
            body: entry.body,
            flanks: match entry.flank {
                Some(Named(flanks)) => flanks,
                None if bodies == 1 => Flanks::Both,
                None => flank_of(entry.body, arrangement.unwrap_or(DEFAULT_ARRANGEMENT)),
            },
            offset: Rule::Any.checked(&path("offset_um"), entry.offset_um)? * UM,
        });
    }
    apart(&all)?;
    Ok(all)
}

/// Rejects overlapping circuits, in which two balls could be at the same position.
fn apart(circuits: &[Circuit]) -> Result<(), CaseError> {
    let mut order: Vec<usize> = (0..circuits.len()).collect();
    order.sort_by(|a, b| {
        let place = |i: &usize| (circuits[*i].thread, circuits[*i].start);
        let ((thread, start), (other, next)) = (place(a), place(b));
        thread.cmp(&other).then(start.total_cmp(&next))
    });
    for pair in order.windows(2) {
        let [one, next] = [pair[0], pair[1]].map(|i| &circuits[i]);
        // The comparison allows for rounding errors of angles in degrees.
        if one.thread == next.thread && one.start + one.arc > next.start + 1e-9 * one.arc {
            let (first, second) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            return Err(invalid_input(
                "circuits",
                format!("has overlapping circuits, {first} and {second}"),
            ));
        }
    }
    Ok(())
}

/// Creates the circuits of a single nut, or of both nuts of a pair that is preloaded by an offset.
pub(super) fn short_circuits(case: &Case, way: PreloadKind) -> Result<Vec<Circuit>, CaseError> {
    let NutTurns { balls_per_turn, turns } = NutTurns::of(case);
    let (per_turn, turns) = (balls_per_turn.unwrap_or(f64::NAN), turns.unwrap_or(f64::NAN));
    let (number, starts) = (case.number(InputKey::circuits_count), case.number(InputKey::starts));
    let arc = 360.0 * turns / number;
    let balls = (per_turn * arc / 360.0).round();
    if balls.is_nan() || balls < 1.0 {
        let what = format!(
            "is {per_turn}, which leaves each of {number} circuits of {arc:.1} deg without a ball"
        );
        return Err(invalid_input(InputKey::loaded_balls_per_turn.name(), what));
    }
    if balls * number > count(MAX_BALLS) {
        let what = format!(
            "is {per_turn}, which gives {} balls, but at most {MAX_BALLS} are permitted",
            balls * number
        );
        return Err(invalid_input(InputKey::loaded_balls_per_turn.name(), what));
    }
    // Angle along the helix from the end of a circuit to the beginning of the next circuit on the
    // same thread.
    let gap = case.gap_deg.unwrap_or_else(|| (arc / 360.0).ceil() * 360.0 - arc);
    let (step, phase) = (arc + gap, case.number(InputKey::phase_deg));
    let pair = way == PreloadKind::Offset && is_preloaded(case);
    let arranged = arrangement(case)?.unwrap_or(DEFAULT_ARRANGEMENT);
    let circuit = |body: usize, from: f64| {
        move |i: usize| Circuit {
            start: (from + (count(i) / starts).floor() * step + count(i) * phase) * DEG,
            arc: arc * DEG,
            balls: whole(balls),
            thread: i % whole(starts),
            body,
            flanks: if pair { flank_of(body, arranged) } else { Flanks::Both },
            offset: 0.0,
        }
    };
    let mut all: Vec<_> = (0..whole(number)).map(circuit(0, 0.0)).collect();
    if pair {
        // The second nut continues along the helix after a spacer of one turn.
        let end = all.iter().map(|c| (c.start + c.arc) / DEG).fold(0.0, f64::max);
        let next = ((end - 1e-9) / 360.0).ceil() * 360.0 + 360.0;
        all.extend((0..whole(number)).map(circuit(1, next)));
    }
    apart(&all)?;
    Ok(all)
}

/// Returns the deviation of each ball radius \[m\].
pub(super) fn deviations(
    entries: &CaseEntries,
    deviation: Option<f64>,
) -> Result<Vec<f64>, CaseError> {
    let Some(listed) = &entries.ball_deviation_um else { return Ok(Vec::new()) };
    if deviation.is_some() {
        return Err(CaseError::given_twice(["ball_deviation_um", "ball_deviation_sd_um"]));
    }
    let one = |(i, value): (usize, &f64)| {
        let value = Rule::Any.checked(&format!("ball_deviation_um[{i}]"), *value)?;
        Ok(0.5 * UM * value)
    };
    listed.iter().enumerate().map(one).collect()
}

pub(super) fn lead_error((i, entry): (usize, &LeadErrorEntry)) -> Result<LeadError, CaseError> {
    let path = format!("lead_error[{i}]");
    let LeadErrorEntry { amplitude_um, order, phase_deg, slope_um_per_mm, z0_mm } = *entry;
    match (amplitude_um, order, slope_um_per_mm) {
        (Some(amplitude), Some(order), None) if z0_mm.is_none() => Ok(LeadError::Wave {
            amplitude: amplitude * UM,
            order,
            phase: phase_deg.unwrap_or(0.0) * DEG,
        }),
        (None, None, Some(slope)) if phase_deg.is_none() => {
            Ok(LeadError::Slope { slope: slope * (UM / MM), origin: z0_mm.unwrap_or(0.0) * MM })
        }
        _ => Err(invalid_input(
            path,
            "must be a wave (amplitude_um, order and, if it is not 0, phase_deg) or a slope \
             (slope_um_per_mm and, if it is not 0, z0_mm)",
        )),
    }
}
