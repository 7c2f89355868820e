//! From a point to an accepted root, or to the reason why there is none.
//!
//! Theory: `docs/theory/04-rigid.md`, sections on existence, direct sweeps and fast balls.

use std::iter::successors;
use std::mem;

use bsm_newton::{Bracket, Equations, Options, Report, Scales, solve};
use bsm_simd::{Arch, BLOCK, Block, Lane, Simd, WithSimd};

use super::ball::{RigidBall, RigidMotion};
use super::curve::Curve;
use super::equations::{ExistenceLimit, LEAST_INERTIA, RigidEquations, Unknowns};
use super::first_order::FirstOrder;
use super::search::{CurveSearch, LONGEST};
use super::sweeps::Sweeps;
use crate::contact::Sines;
use crate::cost::count_of;
use crate::models::ball::unknown::{SLIP, UNLOADED_FLANK_LOAD};
use crate::models::ball::{Attempt, BALL, Evidence, NoAnswer, Reason, Workspace, first_answer};

/// Up to this ratio of inertia to friction what the first order excludes by more than its error does not
/// exist; above it, friction of order one leaves roots further from the first order.
const SMALL_INERTIA: f64 = 0.01;

/// Relative error of the first-order existence test over the ratio of inertia to friction.
const FIRST_ORDER_ERROR: f64 = 0.2;

/// A solve may take this many steps; more means that the start was not near the root.
const MOST_STEPS_NEAR_ROOT: usize = 8;

/// Roots whose loads differ by less, relative, are one.
const SAME: f64 = 1e-6;

/// A root of the rigid equations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BallRoot {
    pub(crate) motion: RigidMotion<f64>,
    /// Sweeps, or Newton steps from where the search has found it.
    pub(crate) steps: usize,
    pub(crate) residual: f64,
    /// Other admissible roots of the point; `None` if none was looked for, or the search was lost.
    pub(crate) alternatives: Option<Vec<BallRoot>>,
}

impl BallRoot {
    /// True for the same root but for rounding.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let loads = self.motion.loads.iter().zip(&other.motion.loads);
        loads.into_iter().all(|(x, y)| (x - y).abs() <= SAME * x.abs().max(y.abs()))
    }
}

/// What the first order, or the sign of a root that the sweeps have found from it, says.
fn none(reason: Reason) -> NoAnswer {
    NoAnswer::none(Evidence::Bound, reason)
}

/// Memory of the solves.
#[derive(Default)]
pub struct RigidWorkspace(pub(super) Workspace);

/// A point on the way to its root.
struct RootSearch<'a> {
    ball: &'a RigidBall<f64>,
    first: FirstOrder,
    /// Ratio of inertia to friction.
    inertia: f64,
    /// Where the sweeps have ended, if at no root.
    met: Option<Sweeps<f64>>,
    work: &'a mut RigidWorkspace,
}

/// Finds the root, or the reason why there is none.
///
/// Of several admissible roots the one of smallest positive turn of the slip at B, then of smallest
/// negative: the first that the branch of small inertia meets. They are looked for where the first order has a
/// [high multiplicity](FirstOrder::has_high_multiplicity).
///
/// A hair from self-locking the loads are so large that their rounding misleads all searches. Where the
/// first order has a root by more than its error, there is one.
pub(crate) fn find(ball: &RigidBall<f64>, work: &mut RigidWorkspace) -> Result<BallRoot, NoAnswer> {
    let first = ball.first_order();
    let inertia = first.inertia_scale / ball.friction();
    let mut search = RootSearch { ball, first, inertia, met: None, work };
    let found = first_answer(&mut search, &RootSearch::STRATEGIES).map(|root| {
        // At a low multiplicity no search is due, and an empty list of one is dropped: a row of a table and
        // the model report the same.
        let met = root.alternatives.filter(|met| first.has_high_multiplicity() || !met.is_empty());
        let alternatives = met.or(first.is_unique.then(Vec::new));
        BallRoot { alternatives, ..root }
    });
    found.map_err(|none| {
        let loaded = inertia * first.load;
        let error = FIRST_ORDER_ERROR * loaded;
        let sure = loaded < SMALL_INERTIA
            && first.exists()
            && first.sliding_margin > margin_error(ball, &first, error)
            && first.rate.abs() > 2.0 * error;
        if sure && none.evidence().is_some() { NoAnswer::LOST } else { none }
    })
}

impl RootSearch<'_> {
    const STRATEGIES: [fn(&mut Self) -> Attempt<BallRoot>; 3] =
        [Self::first_order, Self::sweeps, Self::whole_curve];

    /// No solution at small inertia where the first order has none by more than its error.
    ///
    /// The error is [`FIRST_ORDER_ERROR`] times the ratio of inertia to friction. The constant is
    /// measured: no root of `tests/suite/rigid_campaign.rs` goes further against the first order than 0.077 of
    /// that ratio, and the test watches it.
    fn first_order(&mut self) -> Attempt<BallRoot> {
        let Self { ball, first, inertia, .. } = self;
        if *inertia >= SMALL_INERTIA {
            return None;
        }
        if first.rate == 0.0 {
            return Some(Err(none(Reason::BallDoesNotCircle)));
        }
        let error = FIRST_ORDER_ERROR * *inertia;
        if first.load <= 0.0 {
            // The denominator of the loads (R17), over its friction term.
            let (sin_contact_angle, friction_term) = locking_terms(ball);
            let sure = friction_term - sin_contact_angle >= error * friction_term;
            return sure.then(|| Err(none(self_locking(ball))));
        }
        // q_A' depends on the sign of P, which inertia may turn where P is small: seen up to 0.13 |W|.
        if first.rate.abs() <= 2.0 * error {
            return None;
        }
        // q_A' < 0 lies beyond q_A' = ∞, where the margin is -∞ already.
        if first.unloaded <= 0.0 {
            return Some(Err(none(unloaded_flank_would_pull(first))));
        }
        let sure = -first.sliding_margin > margin_error(ball, first, error);
        sure.then(|| Err(none(would_roll(ball, first, self.work))))
    }

    /// The root that the sweeps go to from the first order, where that is a guide.
    fn sweeps(&mut self) -> Attempt<BallRoot> {
        let swept = self.ball.sweeps(&self.first);
        let motion = swept.motion;
        if motion.is_admissible() {
            return swept.converged.then(|| {
                let (steps, residual) = (count_of(swept.count), swept.residual);
                Ok(BallRoot { motion, steps, residual, alternatives: None })
            });
        }
        let small = swept.converged && self.inertia < SMALL_INERTIA;
        // The only state of the ball is none of sliding contacts that push.
        if small || (swept.stationary && self.first.is_unique) {
            return Some(Err(none(inadmissible(self.ball, &swept, self.work))));
        }
        self.met = swept.converged.then_some(swept);
        None
    }

    /// The first root of the whole curve, with the others.
    #[expect(clippy::unnecessary_wraps, reason = "the shape of a strategy")]
    fn whole_curve(&mut self) -> Attempt<BallRoot> {
        let mut met = SearchResult::of(self.ball, self.first.inertia, self.work);
        if let Some(root) = met.first() {
            return Some(Ok(root));
        }
        if let Some(failure) = met.failure {
            return Some(Err(failure));
        }
        let evidence =
            if met.excluded { Evidence::Proof } else { Evidence::Traced { resolution: LONGEST } };
        let reason = match self.met {
            Some(swept) => inadmissible(self.ball, &swept, self.work),
            None => self.why_none(met.nearest_inertia),
        };
        Some(Err(NoAnswer::none(evidence, reason)))
    }

    /// What to say of a point where the search found no root.
    fn why_none(&mut self, nearest: Option<f64>) -> Reason {
        let Self { ball, first, .. } = self;
        match nearest {
            Some(nearest) => Reason::NoRootAtInertia { inertia_ratio: ball.inertia_ratio, nearest },
            None if first.load <= 0.0 => self_locking(ball),
            None if first.unloaded <= 0.0 => unloaded_flank_would_pull(first),
            None => would_roll(ball, first, self.work),
        }
    }
}

/// What a search has met.
pub(super) struct SearchResult {
    /// Admissible roots, each once: in the order of the turn of the slip at B upwards from zero, then
    /// downwards.
    pub(super) roots: Vec<BallRoot>,
    nearest_inertia: Option<f64>,
    /// No turn can have a root.
    excluded: bool,
    /// A part of the curve was not searched, or a crossing gave no root.
    failure: Option<NoAnswer>,
}

impl SearchResult {
    /// The roots of the whole curve.
    ///
    /// * `inertia`: `$\varepsilon$` of the first order.
    pub(super) fn of(ball: &RigidBall<f64>, inertia: f64, work: &mut RigidWorkspace) -> Self {
        let curve = Curve::of(ball);
        let (mut roots, mut failure) = (Vec::<BallRoot>::new(), None);
        let mut search = CurveSearch::new(&curve, |point| {
            match refined(ball, &curve.motion(ball, point), work) {
                // Newton has left the crossing for another root.
                Ok(root)
                    if !root.motion.is_admissible() || roots.iter().any(|r| r.is_near(&root)) =>
                {
                    failure = Some(NoAnswer::LOST);
                }
                Ok(root) => roots.push(root),
                Err(none) => failure = Some(none),
            }
            false
        });
        search.run(inertia);
        let (nearest_inertia, cut_short) = (search.nearest_inertia(), search.is_cut_short());
        if cut_short && failure.is_none() {
            failure = Some(NoAnswer::LOST);
        }
        let excluded = curve.windows() == [None; 2];
        Self { roots, nearest_inertia, excluded, failure }
    }

    /// The first root, with the others.
    fn first(&mut self) -> Option<BallRoot> {
        let mut alternatives = mem::take(&mut self.roots);
        let first = (!alternatives.is_empty()).then(|| alternatives.remove(0))?;
        let known = self.failure.is_none() || !alternatives.is_empty();
        Some(BallRoot { alternatives: known.then_some(alternatives), ..first })
    }
}

/// The root next to a motion, by Newton on weights of its own size (R44), which large inertia needs.
fn refined(
    ball: &RigidBall<f64>,
    motion: &RigidMotion<f64>,
    work: &mut RigidWorkspace,
) -> Result<BallRoot, NoAnswer> {
    let (equations, mut unknowns) = RigidEquations::at(ball, motion);
    let weights = ball.own_weights(motion);
    let report = run(&equations, &mut unknowns, &weights, 1e-13, work);
    if !report.converged() {
        return Err(NoAnswer::not_converged(Reason::from(report)));
    }
    let motion = equations.motion(&unknowns).expect("the residual was evaluated at the root");
    Ok(BallRoot {
        motion,
        steps: report.steps.len(),
        residual: report.residual,
        alternatives: None,
    })
}

/// The one call of Newton: from `y` on towards `residual_goal`.
fn run(
    system: &impl Equations<BALL>,
    y: &mut Unknowns<f64>,
    weights: &[f64; BALL],
    residual_goal: f64,
    work: &mut RigidWorkspace,
) -> Report {
    let options = Options { residual_goal, max_steps: MOST_STEPS_NEAR_ROOT, ..Options::default() };
    let scales = Scales { x: &[1.0; BALL], f: weights };
    solve(system, &mut y.data.0[0], &scales, &options, &mut work.0)
}

/// Why the motion that sweeps have ended at is no physical one.
fn inadmissible(ball: &RigidBall<f64>, swept: &Sweeps<f64>, work: &mut RigidWorkspace) -> Reason {
    let motion = &swept.motion;
    let ([nut, unloaded, screw], slip) = (motion.loads, motion.speeds[0]);
    if nut <= 0.0 || screw <= 0.0 {
        return Reason::LoadedContactWouldPull { nut_load_ratio: nut, screw_load_ratio: screw };
    }
    if unloaded <= 0.0 {
        return Reason::UnloadedFlankWouldPull { load_ratio: unloaded };
    }
    let critical_lead_angle = critical_lead_angle(ball, work);
    Reason::NutContactWouldRoll { slip, exact: swept.converged, critical_lead_angle }
}

/// What a relative error of the first order makes of its margin.
fn margin_error(ball: &RigidBall<f64>, first: &FirstOrder, error: f64) -> f64 {
    error * first.precession.abs() * ball.sines.tan_a()
}

/// Both sides of Lin's Eq 16.
fn locking_terms(ball: &RigidBall<f64>) -> (f64, f64) {
    (ball.sines.sin_b, ball.friction() * ball.sines.slip_factor())
}

fn self_locking(ball: &RigidBall<f64>) -> Reason {
    let (sin_contact_angle, friction_term) = locking_terms(ball);
    Reason::SelfLocking { sin_contact_angle, friction_term }
}

fn unloaded_flank_would_pull(first: &FirstOrder) -> Reason {
    Reason::UnloadedFlankWouldPull { load_ratio: first.unloaded * first.inertia }
}

fn would_roll(ball: &RigidBall<f64>, first: &FirstOrder, work: &mut RigidWorkspace) -> Reason {
    let critical_lead_angle = critical_lead_angle(ball, work);
    Reason::NutContactWouldRoll { slip: first.slip, exact: false, critical_lead_angle }
}

/// Whether the first order has a root at other lead angles.
struct FirstOrderExists<'a>(&'a RigidBall<f64>, &'a Block);

impl WithSimd for FirstOrderExists<'_> {
    type Output = [bool; BLOCK];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(ball, leads) = self;
        let mut exists = [false; BLOCK];
        for first in (0..BLOCK).step_by(Lane::<S>::LEN) {
            let lead = Lane::<S>::load(simd, &leads[first..]);
            let sines = Sines {
                sin_a: lead.each(f64::sin),
                cos_a: lead.each(f64::cos),
                sin_b: lead.constant(ball.sines.sin_b),
                cos_b: lead.constant(ball.sines.cos_b),
            };
            let [mass, nut, signed] =
                [ball.inertia_ratio / ball.radius, ball.nut_speed, ball.signed];
            let ball = RigidBall::new(
                sines,
                lead.constant(ball.radius),
                lead.constant(mass),
                lead.constant(nut),
                lead.constant(signed),
            );
            ball.first_order().exists().store(&mut exists[first..]);
        }
        exists
    }
}

/// Smallest lead angle above the point's at which the slip at A is no longer negative.
///
/// The first-order margin brackets it, Newton on the exact equations with the lead angle as an
/// unknown finds it. `None` if the first order has none below 80 degrees.
pub(crate) fn critical_lead_angle(ball: &RigidBall<f64>, work: &mut RigidWorkspace) -> Option<f64> {
    const STEP: f64 = 0.01;
    const LARGEST: f64 = 1.4;

    let at = |lead: f64| ball.with_lead_angle(lead).first_order();
    let lead_angle = ball.sines.sin_a.atan2(ball.sines.cos_a);
    let block = |first: f64| -> Block {
        let mut leads = [first; BLOCK];
        for i in 1..BLOCK {
            leads[i] = leads[i - 1] + STEP;
        }
        leads
    };
    let (_, high) =
        successors(Some(block(lead_angle)), |leads| Some(block(leads[BLOCK - 1] + STEP)))
            .flat_map(|leads| {
                Arch::new().dispatch(FirstOrderExists(ball, &leads)).into_iter().zip(leads)
            })
            .take_while(|(_, lead)| *lead <= LARGEST.max(lead_angle))
            .find(|(exists, _)| *exists)?;
    // An angle that has one, next to one that has none.
    let ends = [(high - STEP).max(0.5 * high), high];
    let signs = [f64::NEG_INFINITY, f64::INFINITY];
    let bracket = Bracket { x_tol: 1e-6, ..Bracket::new(ends, signs) };
    let slip = |first: FirstOrder| if first.pushes() { first.slip } else { signs[0] };
    let found = bracket.root(|lead| slip(at(lead))).root();
    let high = found.map_or(high, |root| root.ends[1]);

    // At inertia below the resolution, the smallest resolved inertia moves the angle by as much.
    let slow = ball.friction() * LEAST_INERTIA / at(high).inertia_scale;
    let ball = &ball.with_inertia(slow.max(1.0));
    let there = ball.with_lead_angle(high);
    let first = there.first_order();
    let mut x = there.start_of(&first);
    x[SLIP] = high;
    let weights = there.weights(first.rate);
    let goal = Options::default().residual_goal;
    let report = run(&ExistenceLimit(ball), &mut x, &weights, goal, work);
    let found = report.converged() && x[UNLOADED_FLANK_LOAD] > 0.0 && x[SLIP] > lead_angle;
    found.then_some(x[SLIP])
}
