//! The search for the best screw that meets a requirement.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::catalogue::{IDLE_BALLS, STEP};
use crate::requirement::{BALL_RATIOS, CONTACT_ANGLES, GROOVE_RATIOS};
use crate::search::{SLACK, Value, minimise};
use crate::{Check, Design, EfficiencyOf, Nut, Objective, Pitch, Quantity, Requirement};

/// Loaded turns that are tried.
const TURNS: [f64; 5] = [2.0, 3.0, 4.0, 5.0, 6.0];

/// Starts of the search, in the unit cube of pitch diameter, ball ratio, contact angle and conformity.
const STARTS: [[f64; 4]; 6] = [
    [0.5, 0.5, 0.5, 0.5],
    [0.25, 0.7, 0.3, 0.2],
    [0.75, 0.3, 0.7, 0.3],
    [0.9, 0.8, 0.5, 0.1],
    [0.4, 0.2, 0.2, 0.8],
    [0.6, 0.6, 0.9, 0.6],
];

/// Smallest pitch circle diameter that is tried \[m\].
const SMALLEST: f64 = 2e-3;

/// How near to a limit counts as held back by it.
const NEAR: f64 = 2e-3;

/// What the search says.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A screw that meets the requirement.
    Found {
        /// The screw, with whole numbers of balls and a ball from stock.
        design: Design,
        /// What holds back the best screw with any ball size and fractions of balls.
        active: Vec<Quantity>,
    },
    /// None meets it.
    Infeasible {
        /// The compromise that fails least.
        design: Design,
        /// The limits that it fails.
        blocking: Vec<Blocked>,
    },
}

/// A limit that no screw keeps together with the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blocked {
    /// The limit, and the value of the compromise.
    pub check: Check,
    /// What else there is to say.
    pub why: Why,
}

/// Why a limit blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Why {
    /// With all other limits kept, this value is the best.
    Alone(f64),
    /// The other limits cannot all be kept even without this one.
    WithOthers,
    /// Only fractions of balls, or a ball that is not in stock, would do.
    WholeBalls,
}

impl Requirement {
    /// The best screw for the requirement.
    ///
    /// The free numbers are optimised for each number of turns from several starts, first with any
    /// ball and fractions of balls in a turn; then with the nearest balls in stock and whole numbers
    /// of them, which fix the pitch circle, contact angle and conformity are optimised again.
    pub fn choose(&self, efficiency: EfficiencyOf<'_>) -> Outcome {
        let needed = self.objective == Objective::Efficiency || self.least_efficiency.is_some();
        let search = Search { requirement: self, efficiency: needed.then_some(efficiency) };
        let complete = |nut: Nut| Design::of(self, nut, Some(efficiency));
        let turns = self.fixed.turns.map_or_else(|| TURNS.to_vec(), |turns| vec![turns]);
        let relaxed: Vec<_> = turns.par_iter().map(|turns| search.relaxed(*turns)).collect();
        let feasible: Vec<_> = relaxed.iter().filter(|at| search.value(at).is_feasible()).collect();
        let exact: Vec<_> = feasible.par_iter().flat_map(|at| search.exact(at)).collect();
        let value = |design: &&Design| search.value_of(design);
        let objective = |at: &&&Place| search.value(at).objective;
        if let Some(design) =
            least(exact.iter().filter(|d| d.is_feasible()), |d| value(d).objective)
        {
            let best = least(feasible.iter(), objective);
            let active = best.map_or_else(Vec::new, |at| search.active(at));
            return Outcome::Found { design: complete(design.nut), active };
        }
        if let Some(design) = least(exact.iter(), |d| value(d).worst()) {
            let blocked = |check: &Check| Blocked { check: *check, why: Why::WholeBalls };
            let failed = design.checks.iter().filter(|check| !check.passes());
            let blocking = failed.map(blocked).collect();
            return Outcome::Infeasible { design: complete(design.nut), blocking };
        }
        let (at, blocking) = search.conflict(&turns);
        Outcome::Infeasible { design: complete(search.nut(&at)), blocking }
    }
}

/// The item of the least value.
fn least<T>(items: impl Iterator<Item = T>, value: impl Fn(&T) -> f64) -> Option<T> {
    let valued = items.map(|item| (value(&item), item));
    valued.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, item)| item)
}

/// A place in the space of designs.
#[derive(Debug, Clone)]
struct Place {
    turns: f64,
    /// Free numbers in the unit cube.
    free: Vec<f64>,
}

struct Search<'a> {
    requirement: &'a Requirement,
    efficiency: Option<EfficiencyOf<'a>>,
}

/// The four numbers of a nut that the search moves.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    pitch_diameter: f64,
    ball: f64,
    contact_angle: f64,
    conformity: f64,
}

impl Search<'_> {
    /// The numbers of a place: fixed, or from the free ones in turn.
    fn numbers(&self, free: &[f64]) -> Numbers {
        let Requirement { fixed, largest_diameter, .. } = self.requirement;
        let mut free = free.iter();
        let mut next = |(low, high): (f64, f64)| {
            low + (high - low) * free.next().expect("a number for each that is free")
        };
        let pitch_diameter = fixed.pitch_diameter.unwrap_or_else(|| {
            let largest = largest_diameter.max(2.0 * SMALLEST);
            next((SMALLEST.ln(), largest.ln())).exp()
        });
        let ball = fixed.ball.unwrap_or_else(|| next(BALL_RATIOS) * pitch_diameter);
        let contact_angle = fixed.contact_angle.unwrap_or_else(|| next(CONTACT_ANGLES));
        let conformity = fixed.conformity.unwrap_or_else(|| 0.5 / next(GROOVE_RATIOS));
        Numbers { pitch_diameter, ball, contact_angle, conformity }
    }

    /// True for each of the four numbers that is free.
    fn is_free(&self) -> [bool; 4] {
        let f = &self.requirement.fixed;
        [f.pitch_diameter, f.ball, f.contact_angle, f.conformity].map(|fixed| fixed.is_none())
    }

    /// Length of a turn over the ball diameter.
    fn balls(&self, numbers: &Numbers) -> f64 {
        let lead = self.requirement.lead(numbers.pitch_diameter);
        (PI * numbers.pitch_diameter).hypot(lead) / numbers.ball
    }

    fn nut_of(&self, numbers: &Numbers, balls_per_turn: f64, turns: f64) -> Nut {
        Nut {
            ball_diameter: numbers.ball,
            pitch_diameter: numbers.pitch_diameter,
            lead: self.requirement.lead(numbers.pitch_diameter),
            contact_angle: numbers.contact_angle,
            conformity: (numbers.conformity, numbers.conformity),
            material: self.requirement.material,
            balls_per_turn,
            turns,
        }
    }

    /// The nut of a place, with fractions of balls.
    fn nut(&self, at: &Place) -> Nut {
        let numbers = self.numbers(&at.free);
        // Fewer than the four that stand in the return would carry nothing.
        let loaded = (self.balls(&numbers) - IDLE_BALLS).max(0.1);
        self.nut_of(&numbers, loaded, at.turns)
    }

    fn design(&self, nut: Nut) -> Design {
        Design::of(self.requirement, nut, self.efficiency)
    }

    fn value(&self, at: &Place) -> Value {
        self.value_of(&self.design(self.nut(at)))
    }

    fn value_of(&self, design: &Design) -> Value {
        Value {
            objective: design.objective(self.requirement.objective),
            excess: design.checks.iter().filter_map(Check::excess).collect(),
        }
    }

    /// The best place with this number of turns, any ball and fractions of balls.
    fn relaxed(&self, turns: f64) -> Place {
        self.best_of_starts(turns, |at| self.value(at))
    }

    /// The best of the minima from all starts.
    fn best_of_starts(&self, turns: f64, value: impl Fn(&Place) -> Value + Sync) -> Place {
        let free = self.is_free();
        let best = STARTS.par_iter().map(|start| {
            let start: Vec<_> =
                start.iter().zip(free).filter(|(_, free)| *free).map(|(x, _)| *x).collect();
            let place = |x: &[f64]| Place { turns, free: x.to_vec() };
            place(&minimise(|x| value(&place(x)), &start))
        });
        let rank = |at: &Place| {
            let value = value(at);
            (value.worst().max(SLACK), value.objective)
        };
        let best = best.min_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        best.expect("there are starts")
    }

    /// Designs near a place with balls in stock and whole numbers of them.
    fn exact(&self, at: &Place) -> Vec<Design> {
        const BALLS: usize = 6;
        let near = self.numbers(&at.free);
        let fixed = &self.requirement.fixed;
        let mut balls = fixed.ball.map_or_else(|| self.requirement.stock.clone(), |b| vec![b]);
        let distance = |ball: &f64| (ball / near.ball).ln().abs();
        balls.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        balls.truncate(BALLS);
        let mut designs = Vec::new();
        for ball in balls {
            let full = (self.balls(&Numbers { ball, ..near }) + 1e-9).floor();
            let counts = if fixed.pitch_diameter.is_some() {
                vec![full]
            } else {
                (-1..=3).map(|more| full + f64::from(more)).collect()
            };
            for count in counts {
                let pitch_diameter =
                    fixed.pitch_diameter.unwrap_or_else(|| self.filled_diameter(ball, count));
                if pitch_diameter.is_nan() || count - IDLE_BALLS < 1.0 {
                    continue;
                }
                let whole = Numbers { pitch_diameter, ball, ..near };
                designs.push(self.polished(&whole, count - IDLE_BALLS, at));
            }
        }
        designs
    }

    /// The pitch circle that so many balls fill, rounded up to 0.01 mm; NaN if the lead alone is
    /// longer.
    fn filled_diameter(&self, ball: f64, count: f64) -> f64 {
        let length = count * ball;
        let diameter = match self.requirement.pitch {
            Pitch::Lead(lead) => (length.powi(2) - lead.powi(2)).sqrt() / PI,
            Pitch::Angle(angle) => length * angle.cos() / PI,
        };
        (diameter / STEP).ceil() * STEP
    }

    /// A design with contact angle and conformity optimised, the rest as it is.
    fn polished(&self, whole: &Numbers, balls: f64, at: &Place) -> Design {
        let [diameter, ball, ..] = self.is_free();
        let skip = usize::from(diameter) + usize::from(ball);
        let nut = |x: &[f64]| {
            let mut free = vec![0.0; skip];
            free.extend_from_slice(x);
            let Numbers { contact_angle, conformity, .. } = self.numbers(&free);
            self.nut_of(&Numbers { contact_angle, conformity, ..*whole }, balls, at.turns)
        };
        // What these two numbers do not change needs no search.
        let first = Design::of(self.requirement, nut(&at.free[skip..]), None);
        if first.checks.iter().any(|check| check.quantity.is_of_size() && !check.passes()) {
            return first;
        }
        let best = minimise(|x| self.value_of(&self.design(nut(x))), &at.free[skip..]);
        self.design(nut(&best))
    }

    /// The limits that a place meets with nothing to spare.
    fn active(&self, at: &Place) -> Vec<Quantity> {
        let checks = self.design(self.nut(at)).checks;
        let near = checks.iter().filter(|c| c.excess().is_some_and(|excess| excess > -NEAR));
        near.map(|check| check.quantity).collect()
    }

    /// The place that fails least, and what it fails.
    fn conflict(&self, turns: &[f64]) -> (Place, Vec<Blocked>) {
        let failure = |at: &Place| {
            let excess = self.value(at).excess;
            excess.iter().map(|g| g.max(0.0).powi(2)).sum::<f64>()
        };
        let only = |at: &Place| Value { objective: failure(at), excess: Vec::new() };
        let places: Vec<_> =
            turns.par_iter().map(|turns| self.best_of_starts(*turns, only)).collect();
        let at = least(places.into_iter(), failure).expect("some turns");
        let checks = self.design(self.nut(&at)).checks;
        let failed = checks.iter().filter(|check| !check.passes());
        let blocked =
            |check: &Check| Blocked { check: *check, why: self.without(check.quantity, at.turns) };
        let blocking = failed.map(blocked).collect();
        (at, blocking)
    }

    /// What a quantity can be with all other limits kept.
    fn without(&self, quantity: Quantity, turns: f64) -> Why {
        let alone = |at: &Place| {
            let checks = self.design(self.nut(at)).checks;
            let excess = |own: bool| {
                let kept = checks.iter().filter(move |c| (c.quantity == quantity) == own);
                kept.filter_map(Check::excess)
            };
            Value { objective: excess(true).sum(), excess: excess(false).collect() }
        };
        let at = self.best_of_starts(turns, alone);
        if alone(&at).is_feasible() {
            Why::Alone(self.design(self.nut(&at)).value(quantity))
        } else {
            Why::WithOthers
        }
    }
}
