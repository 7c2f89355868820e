//! Search for the best screw that meets a requirement.

use std::f64::consts::PI;

use bsm_dyn::Conformities;
use rayon::prelude::*;

use crate::bounds::ROUNDING;
use crate::catalog::{IDLE_BALLS, STEP};
use crate::nut::turn_length;
use crate::search::{SLACK, Value, minimize};
use crate::{
    AcceptedBy, Check, Design, DesignQuantity, EfficiencyOf, Nut, Pitch, Range, Rejection,
    Requirement,
};

/// Smallest number of loaded turns that the search considers.
const MIN_TURNS: u32 = 2;

/// Largest number of loaded turns that the search considers.
const MAX_TURNS: u32 = 12;

/// Number of intervals of the coarse grid for the contact angle.
const COARSE_ANGLE_STEPS: u32 = 9;

/// Number of intervals of the coarse grid for the conformity.
const COARSE_CONFORMITY_STEPS: u32 = 2;

/// Number of candidates from the coarse grid whose contact angle and conformity are optimized.
const MAX_REFINED: usize = 24;

/// Constraint violation below which candidates on the coarse grid are ranked by their objective
/// only.
const COARSE_VIOLATION: f64 = 0.1;

/// Starting points of the optimization in the unit cube. The coordinates are pitch circle diameter,
/// ball ratio, contact angle and conformity.
const STARTS: [[f64; 4]; 6] = [
    [0.5, 0.5, 0.5, 0.5],
    [0.25, 0.7, 0.3, 0.2],
    [0.75, 0.3, 0.7, 0.3],
    [0.9, 0.8, 0.5, 0.1],
    [0.4, 0.2, 0.2, 0.8],
    [0.6, 0.6, 0.9, 0.6],
];

/// Number of starting points used to select a lead.
const FEW_STARTS: usize = 2;

/// Smallest pitch circle diameter that the search considers \[m\].
const MIN_PITCH_DIAMETER: f64 = 2e-3;

/// Safety margin that the search keeps from each limit, relative to the limit.
const RESERVE: f64 = SLACK - ROUNDING;

/// Margin below which a limit is treated as active, relative to the limit.
const ACTIVE_MARGIN: f64 = 2e-3;

/// A limit that prevents a better design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BindingLimit {
    /// Quantity to which the limit applies.
    pub quantity: DesignQuantity,
    /// Best value of the objective if this limit is removed. Available only in searches over
    /// standard sizes.
    pub without: Option<f64>,
}

/// Result of the search for the best screw.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A screw that meets the requirement, with a whole number of balls of an available size.
    Found {
        /// The selected screw.
        design: Design,
        /// The active limits. In a search over continuous sizes, these are the limits that the
        /// screw just meets. In a search over standard sizes, these are the limits without which a
        /// better screw would be selected.
        active: Vec<BindingLimit>,
        /// Better screws that the rules based on all ball loads rule out.
        rejected: RejectedDesigns,
    },
    /// No screw meets the requirement.
    Infeasible {
        /// The screw with the smallest violation of the limits.
        design: Design,
        /// Limits that prevent a solution. A limit prevents a solution if all other limits can be
        /// met after removing it. If no such limit exists, the list contains the limits that
        /// `design` violates. The list is empty if the model gives no efficiency for any screw, or
        /// if the rules based on all ball loads rule out all screws within the limits.
        blocking: Vec<ActiveLimit>,
        /// Screws within the limits that the rules based on all ball loads rule out.
        rejected: RejectedDesigns,
    },
}

/// Designs that meet all limits, but are ruled out by the rules based on the loads of all balls.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RejectedDesigns {
    /// Names of the violated rules, in alphabetical order and without repetition.
    pub failed_rules: Vec<&'static str>,
    /// Reasons why the rules of a design could not be calculated, with one reason per design. The
    /// reason for the best of these designs comes first.
    pub not_calculated: Vec<String>,
}

/// A limit that cannot be met together with the other limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveLimit {
    /// The limit, and the value of the limited quantity for the screw with the smallest violation.
    pub check: Check,
    /// Reason why this limit blocks a solution.
    pub cause: Infeasibility,
}

/// Reason why a limit cannot be met together with the other limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Infeasibility {
    /// All other limits can be met if this limit is removed. The value is the best value of the
    /// limited quantity under the other limits.
    SingleLimit(f64),
    /// The other limits cannot all be met, even if this limit is removed.
    SeveralLimits,
    /// The limits can be met only with a fractional number of balls or with an unavailable ball
    /// size.
    WholeBalls,
}

impl Requirement {
    /// Returns the best screw that meets the requirement, or the reason why there is none.
    ///
    /// If several leads are allowed, the search first selects the lead of the best screw with
    /// continuous ball sizes and fractional numbers of balls. Each combination of an available ball
    /// size and a whole number of balls then determines a pitch circle diameter. The search
    /// evaluates these candidates on a coarse grid of contact angles and conformities, and
    /// optimizes both quantities for the best candidates. If no candidate meets all limits, a
    /// search with continuous ball sizes and fractional numbers of balls identifies the reason.
    ///
    /// # Panics
    ///
    /// Panics if the requirement does not contain a lead.
    pub fn choose(&self, efficiency: EfficiencyOf<'_>, accepted: AcceptedBy<'_>) -> Outcome {
        let limited = self.least_efficiency.is_some() || self.largest_power.is_some();
        let needed = self.objective.asks_efficiency() || limited;
        let complete = |nut: Nut| Design::of(self, nut, Some(efficiency));
        let turns = self.turns();
        let search = |pitch: &Pitch| Search {
            requirement: self,
            pitch: *pitch,
            efficiency: needed.then_some(efficiency),
        };
        let search = match &self.pitches[..] {
            [only] => search(only),
            several => least(several.iter().map(search), |s| rank(&s.relaxed(&turns)))
                .expect("a lead to choose"),
        };
        let exact = search.exact(&turns);
        let value = |design: &&Design| search.value_of(design);
        let mut feasible: Vec<_> = exact
            .iter()
            .filter(|design| design.is_feasible() && design.objective(self.objective).is_finite())
            .collect();
        feasible.sort_by(|a, b| value(a).objective.total_cmp(&value(b).objective));
        let Selection { first, rejected } = first_accepted(&feasible, accepted);
        if let Some(design) = first {
            let active = active_constraints(design);
            return Outcome::Found { design: complete(design.nut), active, rejected };
        }
        if let [best, ..] = feasible[..] {
            let blocking = Vec::new();
            return Outcome::Infeasible { design: complete(best.nut), blocking, rejected };
        }
        // The search below identifies the limits that rule out all designs. It needs the efficiency
        // only if the requirements limit the efficiency or the power.
        let search = Search { efficiency: limited.then_some(efficiency), ..search };
        let (at, mut blocking) = search.conflict(&turns);
        let mut nut = search.nut(&at);
        if blocking.is_empty()
            && let Some(design) = least(exact.iter(), |d| search.value_of(d).largest_violation())
        {
            let blocked =
                |check: &Check| ActiveLimit { check: *check, cause: Infeasibility::WholeBalls };
            blocking = design.checks.iter().filter(|check| !check.passes()).map(blocked).collect();
            nut = design.nut;
        }
        Outcome::Infeasible { design: complete(nut), blocking, rejected }
    }

    /// Returns the numbers of loaded turns that the search considers.
    fn turns(&self) -> Vec<f64> {
        match self.fixed.turns {
            Some(turns) => vec![turns],
            None => (MIN_TURNS..=MAX_TURNS)
                .map(f64::from)
                .filter(|turns| *turns <= self.searched_turns().max(f64::from(MIN_TURNS)))
                .collect(),
        }
    }
}

/// Number of designs that are checked in parallel against the rules that depend on the loads of all
/// balls.
const BATCH_SIZE: usize = 16;

/// The first design that meets the rules based on the loads of all balls, and the designs before
/// it.
pub(crate) struct Selection<'a> {
    /// The first design that meets the rules, or `None` if no design meets them.
    pub first: Option<&'a Design>,
    /// The designs before the first design that meets the rules.
    pub rejected: RejectedDesigns,
}

/// Checks designs against the rules based on the loads of all balls until one of them meets the
/// rules. The designs must be in order of preference.
pub(crate) fn first_accepted<'a>(
    designs: &[&'a Design],
    accepted: AcceptedBy<'_>,
) -> Selection<'a> {
    let mut rejected = RejectedDesigns::default();
    for part in designs.chunks(BATCH_SIZE) {
        let verdicts: Vec<_> = part.par_iter().map(|design| accepted(design)).collect();
        for (design, verdict) in part.iter().zip(verdicts) {
            match verdict {
                Ok(()) => return Selection { first: Some(*design), rejected },
                Err(Rejection::Rules(rules)) => rejected.failed_rules.extend(rules),
                Err(Rejection::NotCalculated(why)) => rejected.not_calculated.push(why),
            }
            rejected.failed_rules.sort_unstable();
            rejected.failed_rules.dedup();
        }
    }
    Selection { first: None, rejected }
}

/// Returns the limits that the design just meets.
fn active_constraints(design: &Design) -> Vec<BindingLimit> {
    let near =
        |check: &&Check| check.violation().is_some_and(|violations| violations > -ACTIVE_MARGIN);
    let holds = |check: &Check| BindingLimit { quantity: check.quantity, without: None };
    design.checks.iter().filter(near).map(holds).collect()
}

/// Returns the item for which `value` is smallest.
fn least<T>(items: impl Iterator<Item = T>, value: impl Fn(&T) -> f64) -> Option<T> {
    let valued = items.map(|item| (value(&item), item));
    valued.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, item)| item)
}

/// Returns a sort key for the evaluation of a design. Designs that meet all limits come first, in
/// order of their objective. All other designs follow, in order of their largest violation.
fn rank(value: &Value) -> f64 {
    let largest_violation = value.largest_violation();
    if largest_violation <= SLACK {
        value.objective.clamp(-1e3, 1e3)
    } else {
        1e4 + largest_violation
    }
}

/// A point of the search space.
#[derive(Debug, Clone)]
struct Trial {
    turns: f64,
    /// Values of the free variables in the unit cube.
    free: Vec<f64>,
}

struct Search<'a> {
    requirement: &'a Requirement,
    pitch: Pitch,
    efficiency: Option<EfficiencyOf<'a>>,
}

/// The four variables of a nut that the search can change.
#[derive(Debug, Clone, Copy)]
struct Variables {
    pitch_diameter: f64,
    ball: f64,
    contact_angle: f64,
    conformity: f64,
}

impl Search<'_> {
    /// Converts a point of the unit cube into the four variables. Variables with fixed values are
    /// not part of the point.
    fn variables(&self, free: &[f64]) -> Variables {
        let Requirement { fixed, largest_diameter, ranges, .. } = self.requirement;
        let mut free = free.iter();
        let mut next = |range: Range| range.at(*free.next().expect("one number per free variable"));
        let pitch_diameter = fixed.pitch_diameter.unwrap_or_else(|| {
            let largest = largest_diameter.max(2.0 * MIN_PITCH_DIAMETER);
            next(Range { low: MIN_PITCH_DIAMETER, high: largest }.map(f64::ln)).exp()
        });
        let ball =
            fixed.ball.unwrap_or_else(|| next(ranges.searched_ball_over_radius()) * pitch_diameter);
        let contact_angle = fixed.contact_angle.unwrap_or_else(|| next(ranges.contact_angle));
        let conformity =
            fixed.conformity.unwrap_or_else(|| 0.5 / next(ranges.searched_ball_over_groove()));
        Variables { pitch_diameter, ball, contact_angle, conformity }
    }

    /// Returns for each of the four variables whether it is free.
    fn is_free(&self) -> [bool; 4] {
        let f = &self.requirement.fixed;
        [f.pitch_diameter, f.ball, f.contact_angle, f.conformity].map(|fixed| fixed.is_none())
    }

    /// Returns the length of one turn divided by the ball diameter.
    fn balls(&self, variables: &Variables) -> f64 {
        let lead = self.pitch.lead(variables.pitch_diameter);
        turn_length(variables.pitch_diameter, lead) / variables.ball
    }

    fn nut_of(&self, variables: &Variables, balls_per_turn: f64, turns: f64) -> Nut {
        Nut {
            ball_diameter: variables.ball,
            pitch_diameter: variables.pitch_diameter,
            lead: self.pitch.lead(variables.pitch_diameter),
            contact_angle: variables.contact_angle,
            conformity: Conformities::alike(variables.conformity),
            material: self.requirement.material,
            starts: 1.0,
            balls_per_turn,
            turns,
        }
    }

    /// Returns the nut for a point of the search space, with a fractional number of balls.
    fn nut(&self, at: &Trial) -> Nut {
        let variables = self.variables(&at.free);
        // If a turn held no more balls than the four in the ball return, no ball would carry load,
        // so the number of loaded balls is at least 0.1.
        let loaded = (self.balls(&variables) - IDLE_BALLS).max(0.1);
        self.nut_of(&variables, loaded, at.turns)
    }

    fn design(&self, nut: Nut) -> Design {
        Design::of(self.requirement, nut, self.efficiency)
    }

    fn value(&self, at: &Trial) -> Value {
        self.value_of(&self.design(self.nut(at)))
    }

    fn value_of(&self, design: &Design) -> Value {
        Value {
            objective: design.objective(self.requirement.objective),
            // The search also accepts designs that violate a limit by less than the search
            // tolerance. The added reserve keeps accepted designs within the limits, except for
            // rounding errors.
            violations: design
                .checks
                .iter()
                .filter_map(Check::violation)
                .map(|g| g + RESERVE)
                .collect(),
        }
    }

    /// Returns the evaluation of the best design with continuous ball sizes and fractional numbers
    /// of balls, using only a few starting points.
    fn relaxed(&self, turns: &[f64]) -> Value {
        let value = |at: &Trial| self.value(at);
        value(&self.best_from(&STARTS[..FEW_STARTS], turns, value))
    }

    /// Starts a minimization from every combination of starting point and number of turns, and
    /// returns the best minimum. The best minimum has the smallest violation or, if several minima
    /// have the same violation, the smallest objective.
    fn best_from(
        &self,
        starts: &[[f64; 4]],
        turns: &[f64],
        value: impl Fn(&Trial) -> Value + Sync,
    ) -> Trial {
        let free = self.is_free();
        let minimum = |(turns, start): (f64, &[f64; 4])| {
            let start = start.iter().zip(free).filter(|(_, free)| *free).map(|(x, _)| *x);
            let trial = |x: &[f64]| Trial { turns, free: x.to_vec() };
            let at = trial(&minimize(|x| value(&trial(x)), &start.collect::<Vec<_>>()));
            let found = value(&at);
            (found.largest_violation().max(SLACK), found.objective, at)
        };
        let begins: Vec<_> =
            turns.iter().flat_map(|turns| starts.iter().map(|start| (*turns, start))).collect();
        let minima: Vec<_> = begins.into_par_iter().map(minimum).collect();
        let best = minima.into_iter();
        let best = best.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.expect("there are starts").2
    }

    /// Returns designs with available ball sizes and whole numbers of balls. The best designs on
    /// the coarse grid are optimized.
    fn exact(&self, turns: &[f64]) -> Vec<Design> {
        let fixed = &self.requirement.fixed;
        let balls = fixed.ball.map_or_else(|| self.requirement.stock.clone(), |ball| vec![ball]);
        let ball_over_radius = self.requirement.ranges.searched_ball_over_radius();
        let mut nuts = Vec::new();
        for turns in turns {
            for ball in &balls {
                let any = Variables { ball: *ball, ..self.variables(&[0.5; 4]) };
                let circle = |pitch_diameter| Variables { pitch_diameter, ..any };
                let full = |pitch_diameter| (self.balls(&circle(pitch_diameter)) + 1e-9).floor();
                let fewest = full(ball / ball_over_radius.high);
                let most = full(ball / ball_over_radius.low) + 1.0;
                let circles: Vec<_> = match fixed.pitch_diameter {
                    Some(pitch_diameter) => vec![(pitch_diameter, full(pitch_diameter))],
                    None => whole(fewest, most)
                        .map(|count| (self.filled_diameter(*ball, count), count))
                        .collect(),
                };
                for (pitch_diameter, count) in circles {
                    let loaded = count - IDLE_BALLS;
                    let nut = self.nut_of(&circle(pitch_diameter), loaded, *turns);
                    if loaded >= 1.0 && loaded.is_finite() && pitch_diameter.is_finite() {
                        nuts.push(nut);
                    }
                }
            }
        }
        // If no candidate meets the size limits, all candidates are kept to explain why the search
        // fails.
        let fitting: Vec<_> = nuts.iter().filter(|nut| self.fits(nut)).copied().collect();
        let nuts = if fitting.is_empty() { nuts } else { fitting };
        let mut coarse_grid: Vec<_> = nuts.par_iter().map(|nut| self.first_look(nut)).collect();
        // Designs with a large violation are unlikely to become feasible and come last.
        coarse_grid.sort_by(|(a, _), (b, _)| {
            let rough = |value: &Value| value.largest_violation().max(COARSE_VIOLATION);
            rough(a).total_cmp(&rough(b)).then(a.objective.total_cmp(&b.objective))
        });
        coarse_grid.truncate(MAX_REFINED.max(coarse_grid.len() / 10).min(4 * MAX_REFINED));
        coarse_grid.par_iter().map(|(_, nut)| self.refined(nut)).collect()
    }

    /// Returns true if a nut meets all limits that do not depend on contact angle and conformity.
    /// If the pitch circle or the ball diameter is fixed, the function always returns true, and the
    /// limits are checked later.
    fn fits(&self, nut: &Nut) -> bool {
        let free = self.is_free();
        !(free[0] && free[1])
            || Design::of(self.requirement, *nut, None)
                .checks
                .iter()
                .all(|check| check.passes() || !check.quantity.is_of_size())
    }

    /// Returns the nut with the best contact angle and conformity on the coarse grid, and its
    /// evaluation.
    fn first_look(&self, nut: &Nut) -> (Value, Nut) {
        let [.., angle, conformity] = self.is_free();
        let steps = |free: bool, steps: u32| {
            let last = if free { steps } else { 0 };
            (0..=last).map(move |i| f64::from(i) / f64::from(last.max(1)))
        };
        let coarse_grid = steps(angle, COARSE_ANGLE_STEPS).flat_map(|x| {
            let last = steps(conformity, COARSE_CONFORMITY_STEPS);
            last.map(move |y| [(angle, x), (conformity, y)])
        });
        let coarse_grid = coarse_grid.map(|look| {
            let free = look.iter().filter(|(free, _)| *free).map(|(_, x)| *x).collect::<Vec<_>>();
            let nut = self.shaped(nut, &free);
            (self.value_of(&self.design(nut)), nut)
        });
        least(coarse_grid, |(value, _)| rank(value)).expect("at least one look")
    }

    /// Returns the pitch circle diameter at which the given number of balls fills a turn, rounded
    /// up to 0.01 mm. Returns NaN if the lead is longer than the row of balls.
    fn filled_diameter(&self, ball: f64, count: f64) -> f64 {
        let length = count * ball;
        let diameter = match self.pitch {
            Pitch::Lead(lead) => (length.powi(2) - lead.powi(2)).sqrt() / PI,
            Pitch::Angle(angle) => length * angle.cos() / PI,
        };
        (diameter / STEP).ceil() * STEP
    }

    /// Returns the nut with free contact angle and conformity set from values in the unit cube.
    /// Fixed values are not changed.
    fn shaped(&self, nut: &Nut, free: &[f64]) -> Nut {
        let [diameter, ball, ..] = self.is_free();
        let mut all = vec![0.5; usize::from(diameter) + usize::from(ball)];
        all.extend_from_slice(free);
        let Variables { contact_angle, conformity, .. } = self.variables(&all);
        Nut { contact_angle, conformity: Conformities::alike(conformity), ..*nut }
    }

    /// Optimizes contact angle and conformity, starting from the values of `nut`, and returns the
    /// design.
    fn refined(&self, nut: &Nut) -> Design {
        let [.., angle, conformity] = self.is_free();
        let share = |Range { low, high }: Range, value: f64| (value - low) / (high - low);
        let ranges = &self.requirement.ranges;
        let start = [
            (angle, share(ranges.contact_angle, nut.contact_angle)),
            (conformity, share(ranges.searched_ball_over_groove(), 0.5 / nut.conformity.nut)),
        ];
        let start: Vec<_> = start.iter().filter(|(free, _)| *free).map(|(_, x)| *x).collect();
        let value = |x: &[f64]| self.value_of(&self.design(self.shaped(nut, x)));
        self.design(tidy(self.shaped(nut, &minimize(value, &start))))
    }

    /// Returns the point with the smallest violation, with continuous ball sizes and fractional
    /// numbers of balls, together with the blocking limits. The list is empty if the point violates
    /// no limit.
    fn conflict(&self, turns: &[f64]) -> (Trial, Vec<ActiveLimit>) {
        let failure = |at: &Trial| {
            let violations = self.value(at).violations;
            violations.iter().map(|g| g.max(0.0).powi(2)).sum::<f64>()
        };
        let only = |at: &Trial| Value { objective: failure(at), violations: Vec::new() };
        let at = self.best_from(&STARTS, turns, only);
        let checks = self.design(self.nut(&at)).checks;
        if checks.iter().all(Check::passes) {
            return (at, Vec::new());
        }
        let limited: Vec<_> = checks.iter().filter(|check| check.violation().is_some()).collect();
        let alone = limited.par_iter().filter_map(|check| self.without(check, turns));
        let mut blocking: Vec<_> = alone.collect();
        if blocking.is_empty() {
            let together =
                |check: &Check| ActiveLimit { check: *check, cause: Infeasibility::SeveralLimits };
            blocking = checks.iter().filter(|check| !check.passes()).map(together).collect();
        }
        (at, blocking)
    }

    /// Returns the given limit as a blocking limit, together with the best value of the limited
    /// quantity under all other limits. Returns `None` if the other limits cannot all be met.
    fn without(&self, check: &Check, turns: &[f64]) -> Option<ActiveLimit> {
        let blocked = |best| ActiveLimit { check: *check, cause: Infeasibility::SingleLimit(best) };
        if check.quantity == DesignQuantity::Turns {
            let more = (MIN_TURNS..=MAX_TURNS).map(f64::from).filter(|more| !turns.contains(more));
            let feasible = |turns: &f64| {
                let any = |at: &Trial| Value { objective: 0.0, ..self.value(at) };
                let at = self.best_from(&STARTS, &[*turns], any);
                let violations = self.design(self.nut(&at)).checks.into_iter();
                violations.filter(|c| c.quantity != check.quantity).all(|c| c.passes())
            };
            return more.into_iter().find(feasible).map(blocked);
        }
        let split = |at: &Trial| {
            let checks = self.design(self.nut(at)).checks;
            let others = checks.iter().filter(|c| c.quantity != check.quantity);
            let violations = others.filter_map(Check::violation).collect();
            let own = checks.iter().find(|c| c.quantity == check.quantity);
            // The logarithmic distance from the limit is a suitable measure even if the value is
            // many times the limit.
            let far = |c: &Check| {
                let below = c.bounds.min.map_or(f64::NEG_INFINITY, |least| (least / c.value).ln());
                let most = c.bounds.max;
                below.max(most.map_or(f64::NEG_INFINITY, |most| (c.value / most).ln()))
            };
            Value { objective: own.map_or(f64::NAN, far), violations }
        };
        let at = self.best_from(&STARTS, turns, split);
        let best = self.design(self.nut(&at)).value(check.quantity);
        split(&at).is_feasible().then(|| blocked(best))
    }
}

/// Rounds the dimensions of a nut to a nanometer and its angle to a microdegree.
fn tidy(nut: Nut) -> Nut {
    let round = |x: f64, unit: f64| (x / unit).round() * unit;
    let conformity = round(nut.conformity.nut, 1e-9);
    Nut {
        ball_diameter: round(nut.ball_diameter, 1e-9),
        pitch_diameter: round(nut.pitch_diameter, 1e-9),
        contact_angle: round(nut.contact_angle, 1e-6 * PI / 180.0),
        conformity: Conformities::alike(conformity),
        ..nut
    }
}

/// Returns the whole numbers between two limits. If there are more than 200 numbers, some of them
/// are skipped at regular intervals. So many numbers occur only if the lead is many times the
/// circumference of the screw.
fn whole(low: f64, high: f64) -> impl Iterator<Item = f64> {
    const MAX_WHOLE_NUMBERS: f64 = 200.0;
    let stride = ((high - low) / MAX_WHOLE_NUMBERS).ceil().max(1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is at most 200, and NaN becomes 0"
    )]
    let count = ((high - low) / stride) as u32;
    (0..=count).map(move |i| low + f64::from(i) * stride)
}
