//! Catalog of all nuts that can be built from combinations of standard sizes.

use std::cmp::Ordering;

use bsm_dyn::{Conformities, Materials};
use rayon::prelude::*;

use crate::nut::turn_length;
use crate::{Elasticity, Make, Nut, NutBody, NutSet, Range, Thread};

/// Number of balls per turn that carry no load because they are inside the ball return.
pub(crate) const IDLE_BALLS: f64 = 4.0;

/// Increment of pitch circle diameters \[m\].
pub(crate) const STEP: f64 = 1e-5;

/// Default upper limit of the gap that remains in a turn full of balls, divided by the ball
/// diameter (Sobolewski 2002).
pub const BALL_GAP: f64 = 0.10;

/// Largest lead \[m\] to which the limit [`Limits::least_ball_over_lead`] applies.
const SHORT_LEAD: f64 = 10e-3;

/// Lists of sizes that the catalog combines, with lengths in m and angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Lists {
    /// Nominal diameters of the screw.
    pub diameters: Vec<f64>,
    /// Leads of the screw.
    pub leads: Vec<f64>,
    /// Available ball diameters.
    pub balls: Vec<f64>,
    /// Numbers of loaded turns.
    pub turns: Vec<f64>,
    /// Conformities, equal for nut and screw.
    pub conformities: Vec<f64>,
    /// Contact angles.
    pub contact_angles: Vec<f64>,
    /// Sizes that manufacturers offer. If this list is not empty, it replaces the lists of nominal
    /// diameters, leads, balls and turns. If it is empty, all combinations of the other lists are
    /// used.
    pub offered: Vec<OfferedSize>,
}

/// A size that manufacturers offer, with lengths in m.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OfferedSize {
    /// Nominal diameter of the screw.
    pub diameter: f64,
    /// Lead.
    pub lead: f64,
    /// Ball diameter.
    pub ball: f64,
    /// Number of loaded turns.
    pub turns: f64,
    /// Number of thread starts. The loaded turns are distributed evenly among the starts.
    pub starts: f64,
    /// Pitch circle diameter, if the catalog states it.
    pub pitch_diameter: Option<f64>,
    /// Core diameter, if the catalog states it.
    pub core: Option<f64>,
    /// True if the catalog states the ball diameter; false if it is calculated from pitch circle
    /// and core diameters.
    pub ball_is_printed: bool,
    /// Manufacturing process of the screw; `None` if the list does not state it.
    pub make: Option<Make>,
    /// Index of the row in the table of sizes.
    pub row: usize,
}

/// Limits that each size must satisfy, and values that all sizes share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest ratio of ball diameter to lead.
    pub ball_over_lead: f64,
    /// Smallest ratio of ball diameter to lead, for leads up to 10 mm.
    pub least_ball_over_lead: f64,
    /// Range of the ratio of ball diameter to nominal diameter.
    pub ball_over_diameter: Range,
    /// Upper bound (exclusive) of the ratio of ball diameter to root diameter of the screw.
    pub ball_over_root: f64,
    /// Largest sum of all gaps between the balls of a full turn, divided by the ball diameter; less
    /// than 1.
    pub ball_gap: f64,
    /// Axial play of one nut without preload \[m\].
    pub axial_play: f64,
    /// Range of the number of loaded turns.
    pub turns: Range,
    /// Range of the conformity.
    pub conformity: Range,
    /// Elastic constants of raceways and balls.
    pub material: Materials,
    /// Preload of the nut pair for which the stiffness is calculated, divided by the dynamic load
    /// rating.
    pub preload: f64,
    /// Lever arm of the rolling resistance \[m\], from which the efficiency is calculated.
    pub rolling_lever: f64,
}

/// One combination of sizes, with lengths in m and angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "each field is an entry of the corresponding list in `Lists`")]
pub struct Size {
    pub diameter: f64,
    pub lead: f64,
    pub ball: f64,
    pub turns: f64,
    pub conformity: f64,
    pub contact_angle: f64,
    pub offered: Option<OfferedSize>,
}

impl Size {
    /// Returns the number of thread starts.
    fn starts(&self) -> f64 {
        self.offered.map_or(1.0, |offered| offered.starts)
    }

    /// Returns the manufacturing process that the list of sizes states for the screw.
    pub fn make(&self) -> Option<Make> {
        self.offered?.make
    }
}

/// A nut in the catalog with its calculated properties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Combination of sizes that defines the nut.
    pub size: Size,
    /// Nut with the pitch circle diameter at which the balls fill a turn.
    pub nut: Nut,
    /// Grooves of the nut and of the screw.
    pub thread: Thread,
    /// Body of the nut.
    pub body: NutBody,
    /// Dynamic axial load rating \[N\].
    pub dynamic_rating: f64,
    /// Static axial load rating \[N\].
    pub static_rating: f64,
    /// Preload of the nut pair \[N\].
    pub preload: f64,
    /// Elastic properties of one nut.
    pub elasticity: Elasticity,
    /// Stiffness of the preloaded pair, including contacts and bodies \[N/m\].
    pub stiffness: f64,
    /// Axial load on one nut at which a contact ellipse reaches the end of its flank \[N\].
    pub edge_load: f64,
    /// Mass of one nut \[kg\].
    pub mass: f64,
    /// Efficiency calculated from the rolling resistance alone.
    pub efficiency: f64,
}

/// Returns the pitch circle diameter and the number of loaded balls per turn (D17), (D18).
///
/// The pitch circle diameter is increased from the nominal diameter in steps of 0.01 mm until the
/// balls fill a turn with a remaining gap of at most `gap` ball diameters (`gap` must be less than
/// 1). Turn lengths are rounded to 0.01 mm, as in the published tables.
///
/// Source: Sobolewski (2002).
pub fn loaded_balls(diameter: f64, lead: f64, ball: f64, gap: f64) -> (f64, f64) {
    let (lead, ball) = (lead / STEP, ball / STEP);
    let mut steps = (diameter / STEP).round();
    loop {
        let balls = balls_of_turn(steps, lead, ball);
        // frac(L/D_w) ≤ 0.10                                              (D17)
        if balls.fract() <= gap {
            // n = ⌊L/D_w⌋ − 4                                             (D18)
            return (steps * STEP, balls.floor() - IDLE_BALLS);
        }
        steps += 1.0;
    }
}

/// Returns the number of loaded balls per turn for a given pitch circle diameter (D18); lengths in
/// m.
fn balls_on(pitch_diameter: f64, lead: f64, ball: f64) -> f64 {
    let [pitch_diameter, lead, ball] = [pitch_diameter, lead, ball].map(|x| x / STEP);
    balls_of_turn(pitch_diameter, lead, ball).floor() - IDLE_BALLS
}

/// Returns the length of a turn divided by the ball diameter. All lengths are in units of [`STEP`],
/// and the length of the turn is rounded to a whole number of units.
fn balls_of_turn(pitch_diameter: f64, lead: f64, ball: f64) -> f64 {
    // The added 1e-9 ensures that rounding errors do not reduce a whole number of balls by one.
    turn_length(pitch_diameter, lead).round() / ball + 1e-9
}

impl Nut {
    /// Returns the sum of the gaps between the balls in a full turn \[m\] (D17).
    pub fn ball_gap(&self) -> f64 {
        let in_steps = [self.pitch_diameter, self.lead, self.ball_diameter].map(|x| x / STEP);
        // Δ = D_w frac(L/D_w)                                             (D17)
        let gap = self.ball_diameter * balls_of_turn(in_steps[0], in_steps[1], in_steps[2]).fract();
        // Values below a nanometer are rounding errors.
        if gap < 1e-9 { 0.0 } else { gap }
    }
}

impl Limits {
    /// Returns true if a size is within the limits.
    fn allow(&self, size: &Size) -> bool {
        // Rounding errors of sizes in millimeters may push a value slightly over its bound.
        let slack = 1.0 + 1e-12;
        size.ball <= self.ball_over_lead * size.lead / size.starts() * slack
            && (size.lead > SHORT_LEAD * slack
                || size.ball * slack >= self.least_ball_over_lead * size.lead)
            && size.ball * slack >= self.ball_over_diameter.low * size.diameter
            && size.ball <= self.ball_over_diameter.high * size.diameter * slack
            && self.turns.contains(size.turns)
            && self.conformity.contains(size.conformity)
    }

    /// Returns the nut with the given size together with its calculated properties. Returns `None`
    /// if the size is outside the limits, if the nut cannot be manufactured, or if a contact
    /// ellipse would extend beyond its flank under the preload.
    pub fn candidate(&self, size: &Size) -> Option<Candidate> {
        if !self.allow(size) {
            return None;
        }
        let printed = size.offered.and_then(|offered| {
            let by_core = |core| {
                Nut::pitch_diameter_over(core, size.ball, size.conformity, size.contact_angle)
            };
            offered.pitch_diameter.or(offered.core.map(by_core))
        });
        let (pitch_diameter, balls_per_turn) = match printed {
            Some(diameter) => (diameter, balls_on(diameter, size.lead, size.ball)),
            None => loaded_balls(size.diameter, size.lead, size.ball, self.ball_gap),
        };
        if balls_per_turn < 1.0 {
            return None;
        }
        let nut = Nut {
            ball_diameter: size.ball,
            pitch_diameter,
            lead: size.lead,
            contact_angle: size.contact_angle,
            conformity: Conformities::alike(size.conformity),
            material: self.material,
            balls_per_turn,
            turns: size.turns,
            starts: size.starts(),
        };
        let thread = nut.thread(self.axial_play, nut.usual_lands());
        // An axial play larger than the play of a single-arc groove cannot be manufactured.
        if self.axial_play > nut.monoarc_play()
            || size.ball >= self.ball_over_root * thread.screw.root
        {
            return None;
        }
        let body = NutBody::usual(&nut, NutSet::Single);
        let dynamic_rating = nut.dynamic_rating().rating;
        let preload = self.preload * dynamic_rating;
        let elasticity = nut.elasticity(&body).ok()?;
        let candidate = Candidate {
            size: *size,
            nut,
            thread,
            body,
            dynamic_rating,
            static_rating: nut.static_rating().rating,
            preload,
            elasticity,
            stiffness: elasticity.preloaded_pair(preload),
            edge_load: nut.edge_load(&thread, &elasticity.hertz),
            mass: body.mass(&nut, &thread),
            efficiency: nut.rolling_efficiency(self.rolling_lever),
        };
        (candidate.is_finite() && candidate.edge_load >= preload).then_some(candidate)
    }
}

impl Candidate {
    /// Returns true if none of the calculated properties has overflowed.
    fn is_finite(&self) -> bool {
        let ratings = [self.dynamic_rating, self.static_rating, self.preload, self.edge_load];
        let others = [self.elasticity.turn_constant, self.stiffness, self.mass, self.efficiency];
        ratings.iter().chain(&others).all(|number| number.is_finite())
    }

    /// Returns the three objectives of the Pareto front, all of which are minimized: negated
    /// dynamic load rating, negated stiffness, and mass.
    pub fn costs(&self) -> [f64; 3] {
        [-self.dynamic_rating, -self.stiffness, self.mass]
    }
}

impl Lists {
    /// Returns the number of combinations, including those outside the limits.
    pub fn len(&self) -> usize {
        self.lengths().into_iter().fold(1, usize::saturating_mul)
    }

    /// Returns true if there are no combinations because a list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the lengths of the lists. The list of offered sizes replaces four other lists and
    /// counts as one list.
    fn lengths(&self) -> [usize; 6] {
        let Self { diameters, leads, balls, turns, conformities, contact_angles, offered } = self;
        let sizes = match offered.len() {
            0 => [diameters, leads, balls, turns].map(Vec::len),
            many => [many, 1, 1, 1],
        };
        let [diameters, leads, balls, turns] = sizes;
        [diameters, leads, balls, turns, conformities.len(), contact_angles.len()]
    }

    /// Returns the combination with index `i`. The index of the last list varies fastest.
    fn size(&self, mut i: usize) -> Size {
        let mut indices = [0; 6];
        for (index, length) in indices.iter_mut().zip(self.lengths()).rev() {
            *index = i % length;
            i /= length;
        }
        let [diameter, lead, ball, turns, conformity, contact_angle] = indices;
        let offered = self.offered.get(diameter).copied();
        let (diameter, lead, ball, turns) = match offered {
            Some(OfferedSize { diameter, lead, ball, turns, .. }) => (diameter, lead, ball, turns),
            None => {
                (self.diameters[diameter], self.leads[lead], self.balls[ball], self.turns[turns])
            }
        };
        let (conformity, contact_angle) =
            (self.conformities[conformity], self.contact_angles[contact_angle]);
        Size { diameter, lead, ball, turns, conformity, contact_angle, offered }
    }

    /// Returns the indices of all combinations within the limits, in ascending order.
    pub fn indices(&self, limits: &Limits) -> Vec<u32> {
        let all = 0..u32::try_from(self.len()).unwrap_or(u32::MAX);
        all.into_par_iter().filter(|index| self.candidate(limits, *index).is_some()).collect()
    }

    /// Applies `each` to the nuts with the given indices and returns the results that are not
    /// `None`, in the same order. The nuts are not stored.
    pub fn map<R: Send>(
        &self,
        limits: &Limits,
        indices: &[u32],
        each: impl Fn(u32, &Candidate) -> Option<R> + Sync + Send,
    ) -> Vec<R> {
        let one = |index: &u32| each(*index, &self.candidate(limits, *index)?);
        indices.par_iter().filter_map(one).collect()
    }

    fn candidate(&self, limits: &Limits, index: u32) -> Option<Candidate> {
        limits.candidate(&self.size(usize::try_from(index).ok()?))
    }
}

/// Returns the indices of the Pareto-optimal [costs](Candidate::costs) in ascending order. A set of
/// costs dominates another set if none of its values is larger and at least one value is smaller.
pub fn front(costs: &[[f64; 3]]) -> Vec<usize> {
    let mut order: Vec<_> = (0..costs.len()).collect();
    // After sorting, every candidate comes after all candidates that dominate it.
    order.sort_by(|a, b| {
        let pairs = costs[*a].iter().zip(&costs[*b]);
        pairs.map(|(a, b)| a.total_cmp(b)).fold(Ordering::Equal, Ordering::then)
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let beaten = front.iter().any(|other| {
            let mut pairs = costs[*other].iter().zip(&costs[i]);
            pairs.clone().all(|(o, v)| o <= v) && pairs.any(|(o, v)| o < v)
        });
        if !beaten {
            front.push(i);
        }
    }
    front.sort_unstable();
    front
}

#[cfg(test)]
mod tests {
    use bsm_dyn::Material;

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

    const LIMITS: Limits = Limits {
        ball_over_lead: 0.6,
        least_ball_over_lead: 0.0,
        ball_over_diameter: Range { low: 0.0, high: 1.0 },
        ball_over_root: 0.5,
        ball_gap: BALL_GAP,
        axial_play: 0.0,
        turns: Range { low: 2.0, high: 6.0 },
        conformity: Range { low: 0.51, high: 0.57 },
        material: Materials::alike(STEEL),
        preload: crate::PRELOAD,
        rolling_lever: crate::ROLLING_LEVER,
    };

    /// Three published pitch circle diameters and their ball counts are reproduced. In one case,
    /// the length of a turn is 319.9999 mm, which must be treated as the length of 32 balls.
    #[test]
    fn published_pitch_diameters_and_ball_counts_are_reproduced() {
        for (nominal, lead, ball, diameter, balls) in [
            (20e-3, 5e-3, 3e-3, 20.00e-3, 17.0),
            (63e-3, 20e-3, 10e-3, 63.35e-3, 16.0),
            (100e-3, 20e-3, 10e-3, 101.66e-3, 28.0),
        ] {
            let (found, n) = loaded_balls(nominal, lead, ball, BALL_GAP);
            // The diameters are multiples of 0.01 mm, but are stored in meters, which causes
            // rounding errors.
            assert!((found - diameter).abs() < 1e-12 && (n - balls).abs() < 0.5, "{found} {n}");
        }
    }

    /// The Pareto front matches the result of comparing all pairs. Candidates with equal costs are
    /// either all on the front or all off it.
    #[test]
    fn pareto_front_matches_a_comparison_of_all_pairs() {
        let lists = Lists {
            diameters: vec![16e-3, 25e-3, 40e-3, 40e-3],
            leads: vec![5e-3, 10e-3],
            balls: vec![2e-3, 3e-3, 3.5e-3, 5e-3],
            turns: vec![2.0, 3.0, 5.0, 9.0],
            conformities: vec![0.5, 0.52, 0.55],
            contact_angles: vec![0.7, 0.8],
            offered: Vec::new(),
        };
        let all = lists.map(&LIMITS, &lists.indices(&LIMITS), |_, nut| Some(*nut));
        assert!(all.iter().all(|c| c.size.turns < 6.5 && c.size.conformity > 0.505));
        assert!(all.iter().all(|c| c.size.ball <= 0.6 * c.size.lead * (1.0 + 1e-9)));
        let beats = |a: &Candidate, b: &Candidate| {
            let pairs = [
                (a.dynamic_rating, b.dynamic_rating),
                (a.stiffness, b.stiffness),
                (b.mass, a.mass),
            ];
            pairs.iter().all(|(a, b)| a >= b) && pairs.iter().any(|(a, b)| a > b)
        };
        let by_pairs: Vec<_> =
            (0..all.len()).filter(|i| !all.iter().any(|other| beats(other, &all[*i]))).collect();
        let costs: Vec<_> = all.iter().map(Candidate::costs).collect();
        assert_eq!(front(&costs), by_pairs);
        assert!(by_pairs.len() > 4 && by_pairs.len() < all.len(), "{}", by_pairs.len());
    }
}
