//! From starting points to an accepted root, or to the reason why there is none.
//!
//! Theory: `docs/theory/04-rigid.md`, sections on existence, slow and fast balls.

use std::mem;

use bsm_newton::{Bracket, Equations, Options, Report, Scales, solve};

use super::curve::Curve;
use super::first_order::{FirstOrder, SEARCHED_FROM, UNIQUE_BELOW};
use super::scaled::{ExistenceLimit, Scaled, Unknowns};
use super::search::{LONGEST, Search};
use crate::ball_unknowns::BALL;
use crate::ball_unknowns::unknown::{MINOR_LOAD, NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP};
use crate::equations::Workspace;
use crate::{Angles, Evidence, Reason, Unsolved};

/// Below this ratio of inertia to friction, rounding of loads of the size of the axial load would
/// decide about the slip at A; the root is then interpolated between no inertia and this much. The
/// error is the square.
pub(super) const SLOW: f64 = 1e-6;

/// Near self-locking the loads are larger, and their rounding with them; the ratio grows with them so
/// many times.
const MOST_LOAD: f64 = 100.0;

/// Up to this ratio of inertia to friction Newton from the first order stays on its branch.
pub(super) const MODERATE_INERTIA: f64 = 0.2;

/// Up to this ratio of inertia to friction what the first order denies by more than its error is not
/// there; above it, friction of order one leaves roots further from the first order.
const SMALL_INERTIA: f64 = 0.01;

/// Relative error of the first-order existence test over the ratio of inertia to friction.
const FIRST_ORDER_ERROR: f64 = 0.1;

/// A solve may take this many steps; more means that the start was not near the root.
const MOST_STEPS: usize = 8;

/// At larger inertia a solve that takes more steps may have met another root than the one of small inertia.
const SURE_STEPS: usize = 5;

/// Speeds beyond this multiple of `$d/r_b$`, in units of `$|W|$`, belong to the root at infinity,
/// where the scaled residual vanishes without a solution. Real roots stay below one.
const SPEED_LIMIT: f64 = 10.0;

/// Roots whose loads differ by less, relative, are one.
const SAME: f64 = 1e-6;

/// A root of the rigid equations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Root {
    pub(crate) unknowns: Unknowns<f64>,
    /// What the unknown of the precession counts from, see [`Scaled`].
    pub(crate) from_ground: bool,
    /// Newton steps of all solves.
    pub(crate) steps: usize,
    pub(crate) residual: f64,
    /// Other admissible roots of the point; `None` if none was looked for, or the search was lost.
    pub(crate) others: Option<Vec<Root>>,
}

impl Root {
    /// A root of whose others nothing is known.
    fn new(unknowns: Unknowns<f64>, steps: usize, residual: f64) -> Self {
        Self { unknowns, from_ground: false, steps, residual, others: None }
    }

    /// True if all contacts push and the slip at A is against its friction.
    fn is_admissible(&self) -> bool {
        [NUT_LOAD, MINOR_LOAD, SCREW_LOAD, SLIP].into_iter().all(|i| self.unknowns[i] > 0.0)
    }

    /// True for the same root but for rounding.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let near = |i: usize| {
            let (x, y) = (self.unknowns[i], other.unknowns[i]);
            (x - y).abs() <= SAME * x.abs().max(y.abs())
        };
        [NUT_LOAD, MINOR_LOAD, SCREW_LOAD].into_iter().all(near)
    }
}

/// What the first order, or the sign of a root that Newton has found from it, says.
fn none(reason: Reason) -> Unsolved {
    Unsolved::none(Evidence::Bound, reason)
}

/// Memory of the solves.
#[derive(Default)]
pub struct RigidWorkspace(pub(super) Workspace);

/// Finds the root, or the reason why there is none.
///
/// Of several admissible roots the one of smallest positive turn of the slip at B, then of smallest
/// negative: the first that the branch of small inertia meets. They are looked for from
/// [`SEARCHED_FROM`] on.
///
/// A hair from self-locking the loads are so large that their rounding misleads all searches. Where the
/// first order has a root by more than its error, none is denied.
pub(crate) fn find(case: &Scaled<f64>, work: &mut RigidWorkspace) -> Result<Root, Unsolved> {
    let start = FirstOrder::of(case);
    let crowding = start.crowding(case.friction());
    let found = root_near(case, &start, work).map(|root| {
        // That a search which Newton needed has met no other is not told: the kernel needs none, and a
        // row of a table says what the model says.
        let met = root.others.filter(|met| crowding >= SEARCHED_FROM || !met.is_empty());
        let others = met.or((crowding < UNIQUE_BELOW).then(Vec::new));
        Root { others, ..root }
    });
    found.map_err(|none| {
        let loaded = start.size / case.friction() * start.load;
        let error = FIRST_ORDER_ERROR * loaded;
        let sure = loaded < SMALL_INERTIA
            && start.exists()
            && start.margin > margin_error(case, &start, error)
            && start.rate.abs() > 2.0 * error;
        if sure && none.evidence().is_some() { Unsolved::LOST } else { none }
    })
}

/// The root near the first order, or another one.
fn root_near(
    case: &Scaled<f64>,
    start: &FirstOrder,
    work: &mut RigidWorkspace,
) -> Result<Root, Unsolved> {
    let inertia = start.size / case.friction();
    if inertia < SMALL_INERTIA
        && let Some(denial) = denied(case, start, inertia, work)
    {
        return Err(denial);
    }
    let slow = SLOW * start.load.clamp(1.0, MOST_LOAD);
    if inertia < slow
        && let Some(root) = interpolate(case, start, inertia / slow, work)
    {
        return accept(case, root, work);
    }
    let (mut denial, mut near) = (None, None);
    if let Some(root) = direct(case, start, inertia, work) {
        match accept(case, root, work) {
            Ok(root) if start.crowding(case.friction()) < SEARCHED_FROM => return Ok(root),
            Ok(root) => near = Some(root),
            Err(none) if inertia < SMALL_INERTIA => return Err(none),
            // A branch whose contacts pull already without inertia says nothing.
            Err(none) => denial = (start.load > 0.0 && start.minor > 0.0).then_some(none),
        }
    }
    let mut met = Met::of(case, start, work);
    if let Some(root) = met.first(near) {
        return Ok(root);
    }
    let Met { nearest_inertia, failure, .. } = met;
    if let Some(failure) = failure {
        return Err(failure);
    }
    let evidence = Evidence::Traced { resolution: LONGEST };
    Err(match denial {
        Some(Unsolved::NoSolution { reason, .. }) => Unsolved::none(evidence, reason),
        Some(lost) => lost,
        None => Unsolved::none(evidence, why_none(case, start, nearest_inertia, work)),
    })
}

/// The root that Newton goes straight to from the first order, where that is a guide.
fn direct(
    case: &Scaled<f64>,
    start: &FirstOrder,
    inertia: f64,
    work: &mut RigidWorkspace,
) -> Option<Root> {
    let moderate = inertia < MODERATE_INERTIA;
    if !(moderate || start.exists()) {
        return None;
    }
    let (unknowns, report) = newton(case, start, start.unknowns(), work);
    let most_steps = if moderate { MOST_STEPS - 1 } else { SURE_STEPS };
    let straight = report.steps.len() <= most_steps && report.steps.iter().all(|s| s.lambda > 0.5);
    if !(report.converged() && straight && is_slow(case, &unknowns)) {
        return None;
    }
    let (steps, residual) = (report.steps.len(), report.residual);
    let root = Root::new(unknowns, steps, residual);
    if moderate { Some(root) } else { settled(case, root, work).ok() }
}

/// What a search has met.
pub(super) struct Met {
    /// Admissible roots, each once: in the order of the turn of the slip at B upwards from zero, then
    /// downwards.
    pub(super) roots: Vec<Root>,
    nearest_inertia: Option<f64>,
    /// A part of the curve was not searched, or a crossing gave no root.
    failure: Option<Unsolved>,
}

impl Met {
    /// The roots of the whole curve.
    pub(super) fn of(case: &Scaled<f64>, start: &FirstOrder, work: &mut RigidWorkspace) -> Self {
        let curve = Curve::of(case);
        let (mut roots, mut failure) = (Vec::<Root>::new(), None);
        let mut search = Search::new(&curve, |point| {
            let (unknowns, from_ground) = curve.unknowns(point);
            let root = Root { from_ground, ..Root::new(unknowns, 0, f64::NAN) };
            match settled(case, root, work) {
                // Newton has left the crossing for another root.
                Ok(root) if !root.is_admissible() || roots.iter().any(|r| r.is_near(&root)) => {
                    failure = Some(Unsolved::LOST);
                }
                Ok(root) => roots.push(root),
                Err(none) => failure = Some(none),
            }
            false
        });
        search.run(start.inertia);
        let (nearest_inertia, cut_short) = (search.nearest_inertia, search.is_cut_short());
        if cut_short && failure.is_none() {
            failure = Some(Unsolved::LOST);
        }
        Self { roots, nearest_inertia, failure }
    }

    /// The first root, with the others; `direct` is one that Newton has found.
    fn first(&mut self, direct: Option<Root>) -> Option<Root> {
        // One that the search has missed.
        self.roots.extend(direct.filter(|d| !self.roots.iter().any(|root| root.is_near(d))));
        let mut others = mem::take(&mut self.roots);
        let first = (!others.is_empty()).then(|| others.remove(0))?;
        let known = self.failure.is_none() || !others.is_empty();
        Some(Root { others: known.then_some(others), ..first })
    }
}

/// What to say of a point where the search found no root.
fn why_none(
    case: &Scaled<f64>,
    start: &FirstOrder,
    nearest: Option<f64>,
    work: &mut RigidWorkspace,
) -> Reason {
    match nearest {
        Some(nearest) => Reason::NoRootAtInertia { inertia_ratio: case.inertia_ratio(), nearest },
        None if start.load <= 0.0 => self_locking(case),
        None if start.minor <= 0.0 => minor_would_pull(start),
        None => would_roll(case, start, work),
    }
}

/// A root on weights of its own size (R44), which large inertia needs.
fn settled(
    case: &Scaled<f64>,
    mut root: Root,
    work: &mut RigidWorkspace,
) -> Result<Root, Unsolved> {
    let case = case.counted(root.from_ground);
    let weights = case.own_weights(&root.unknowns);
    let report = run(&case, &mut root.unknowns, &weights, (MOST_STEPS, 1e-13), work);
    if !report.converged() {
        return Err(Unsolved::not_converged(Reason::from(report)));
    }
    root.residual = report.residual;
    root.steps += report.steps.len();
    Ok(root)
}

/// The one call of the solver: at most `max_steps` from `y`, on towards `residual_goal`.
fn run(
    system: &impl Equations<BALL>,
    y: &mut Unknowns<f64>,
    weights: &[f64; BALL],
    (max_steps, residual_goal): (usize, f64),
    work: &mut RigidWorkspace,
) -> Report {
    let options = Options { residual_goal, max_steps, ..Options::default() };
    let scales = Scales { x: &[1.0; BALL], f: weights };
    solve(system, &mut y.data.0[0], &scales, &options, &mut work.0)
}

/// One damped Newton solve from `y`.
///
/// A residual `$r$` leaves an error of `$r/\iota$` in the slip at A, and of `$r$` in the power
/// balance. Below the tolerance the steps therefore go on towards `$10^{-12}\iota$`, between
/// rounding and a safe distance from it.
fn newton(
    case: &Scaled<f64>,
    start: &FirstOrder,
    mut y: Unknowns<f64>,
    work: &mut RigidWorkspace,
) -> (Unknowns<f64>, Report) {
    let limits = (MOST_STEPS, (1e-12 * start.size).clamp(1e-15, 1e-13));
    let weights = case.weights(start.normal_moment());
    let report = run(case, &mut y, &weights, limits, work);
    (y, report)
}

/// False at the root at infinity.
fn is_slow(case: &Scaled<f64>, y: &Unknowns<f64>) -> bool {
    y[SLIP].abs().max(y[PRECESSION].abs()) <= SPEED_LIMIT * case.arc
}

/// The root for inertia so small that loads in double precision cannot tell it from none.
///
/// The root is analytic in the inertia. Between its limit, the first order, and a root of some more
/// inertia, of which the inertia of the point is a `fraction`, it is a straight line. Where large loads
/// have eaten the load of A' and the slip at A there too, by more than the error of the first order,
/// these two stay at the first order. `None` if the residual does not bear this out.
fn interpolate(
    case: &Scaled<f64>,
    start: &FirstOrder,
    fraction: f64,
    work: &mut RigidWorkspace,
) -> Option<Root> {
    let faster = case.with_inertia(fraction.recip());
    let at = FirstOrder::of(&faster);
    let (mut far, report) = newton(&faster, &at, at.unknowns(), work);
    if !(report.converged() && is_slow(&faster, &far)) {
        return None;
    }
    // Q_A' itself is proportional to the inertia; what varies little is its ratio.
    far[MINOR_LOAD] /= at.inertia;
    let mut limit = start.unknowns();
    limit[MINOR_LOAD] = start.minor;
    let mut unknowns = limit + (far - limit) * fraction;
    // Loads round by Q ε and vary by Q ι/f, and Q_A' is some ι/Q: known to Q² ε/ι there, to Q ι/f to
    // first order.
    if start.load.max(1.0) * f64::EPSILON / at.size > start.size / case.friction() {
        (unknowns[MINOR_LOAD], unknowns[SLIP]) = (limit[MINOR_LOAD], limit[SLIP]);
    }
    unknowns[MINOR_LOAD] *= start.inertia;

    // No step: only the residual is asked for.
    let weights = case.weights(start.normal_moment());
    let check = run(case, &mut unknowns, &weights, (0, Options::default().residual_goal), work);
    let (steps, residual) = (report.steps.len(), check.residual);
    check.converged().then_some(Root::new(unknowns, steps, residual))
}

/// Accepts a converged root of the extended equations if it is one of the physical ones.
fn accept(case: &Scaled<f64>, root: Root, work: &mut RigidWorkspace) -> Result<Root, Unsolved> {
    let y = &root.unknowns;
    if y[NUT_LOAD] <= 0.0 || y[SCREW_LOAD] <= 0.0 {
        let (nut_load_ratio, screw_load_ratio) = (y[NUT_LOAD], y[SCREW_LOAD]);
        return Err(none(Reason::LoadedContactWouldPull { nut_load_ratio, screw_load_ratio }));
    }
    if y[MINOR_LOAD] <= 0.0 {
        // The sign may be that of the rounding of the other loads, a few times their last digit.
        let eaten = y[MINOR_LOAD].abs() <= 16.0 * f64::EPSILON * y[NUT_LOAD];
        let pulls = || none(Reason::MinorContactWouldPull { load_ratio: y[MINOR_LOAD] });
        return Err(if eaten { Unsolved::LOST } else { pulls() });
    }
    if y[SLIP] <= 0.0 {
        let critical_lead_angle = critical_lead_angle(case, work);
        let (slip, exact) = (y[SLIP], true);
        return Err(none(Reason::NutContactWouldRoll { slip, exact, critical_lead_angle }));
    }
    Ok(root)
}

/// Denies a root at small inertia if the first order does so by more than its error.
///
/// The error is [`FIRST_ORDER_ERROR`] times the ratio of inertia to friction. The constant is
/// measured: no root of `tests/suite/rigid_campaign.rs` goes further against the first order than 0.077 of
/// that ratio, and the test watches it.
fn denied(
    case: &Scaled<f64>,
    start: &FirstOrder,
    inertia: f64,
    work: &mut RigidWorkspace,
) -> Option<Unsolved> {
    if start.rate == 0.0 {
        return Some(none(Reason::BallDoesNotCircle));
    }
    let error = FIRST_ORDER_ERROR * inertia;
    if start.load <= 0.0 {
        // The denominator of the loads (R17), over its friction term.
        let (sin_contact_angle, friction_term) = locking_terms(case);
        let sure = friction_term - sin_contact_angle >= error * friction_term;
        return sure.then(|| none(self_locking(case)));
    }
    // q_A' depends on the sign of P, which inertia may turn where P is small: seen up to 0.13 |W|.
    if start.rate.abs() <= 2.0 * error {
        return None;
    }
    // q_A' < 0 lies beyond q_A' = ∞, where the margin is -∞ already.
    if start.minor <= 0.0 {
        return Some(none(minor_would_pull(start)));
    }
    let sure = -start.margin > margin_error(case, start, error);
    sure.then(|| none(would_roll(case, start, work)))
}

/// What a relative error of the first order makes of its margin.
fn margin_error(case: &Scaled<f64>, start: &FirstOrder, error: f64) -> f64 {
    error * start.precession.abs() * case.helix.lead_angle.tan()
}

/// Both sides of Lin's Eq 16.
fn locking_terms(case: &Scaled<f64>) -> (f64, f64) {
    let angles = Angles { lead: case.helix.lead_angle, contact: case.contact_angle };
    (angles.contact.sin(), case.friction() * angles.slip_factor())
}

fn self_locking(case: &Scaled<f64>) -> Reason {
    let (sin_contact_angle, friction_term) = locking_terms(case);
    Reason::SelfLocking { sin_contact_angle, friction_term }
}

fn minor_would_pull(start: &FirstOrder) -> Reason {
    Reason::MinorContactWouldPull { load_ratio: start.minor * start.inertia }
}

fn would_roll(case: &Scaled<f64>, start: &FirstOrder, work: &mut RigidWorkspace) -> Reason {
    let critical_lead_angle = critical_lead_angle(case, work);
    Reason::NutContactWouldRoll { slip: start.slip, exact: false, critical_lead_angle }
}

/// Smallest lead angle above the point's at which the slip at A is no longer negative.
///
/// The first-order margin brackets it, Newton on the exact equations with the lead angle as an
/// unknown finds it. `None` if the first order has none below 80 degrees.
pub(crate) fn critical_lead_angle(case: &Scaled<f64>, work: &mut RigidWorkspace) -> Option<f64> {
    const STEP: f64 = 0.01;
    const LARGEST: f64 = 1.4;

    let at = |lead: f64| FirstOrder::of(&case.with_lead_angle(lead));
    let mut high = case.helix.lead_angle;
    while !at(high).exists() {
        high += STEP;
        if high > LARGEST {
            return None;
        }
    }
    // An angle that has one, next to one that has none.
    let ends = [(high - STEP).max(0.5 * high), high];
    let bracket = Bracket { x_tol: 1e-6, ..Bracket::new(ends, [-1.0, 1.0]) };
    let found = bracket.root(|lead| if at(lead).exists() { 1.0 } else { -1.0 }).root();
    let high = found.map_or(high, |root| root.ends[1]);

    // With too little inertia to tell, as much as can be told moves the angle by that much.
    let slow = case.friction() * SLOW / at(high).size;
    let case = &case.with_inertia(slow.max(1.0));
    let start = FirstOrder::of(&case.with_lead_angle(high));
    let mut x = start.unknowns();
    x[SLIP] = high;
    let weights = case.weights(start.normal_moment());
    let limits = (MOST_STEPS, Options::default().residual_goal);
    let report = run(&ExistenceLimit(case), &mut x, &weights, limits, work);
    let found = report.converged() && x[MINOR_LOAD] > 0.0 && x[SLIP] > case.helix.lead_angle;
    found.then_some(x[SLIP])
}
