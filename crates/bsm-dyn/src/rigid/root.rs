//! From starting points to an accepted root, or to the reason why there is none.
//!
//! Theory: `docs/theory/04-rigid.md`, sections on existence and on the strategy.

use bsm_newton::{Options, Report, Scales, Workspace, solve};

use super::first_order::FirstOrder;
use super::scaled::{ExistenceLimit, Scaled, Unknowns};
use crate::layout::BALL;
use crate::{Angles, Direction, Reason, Status};

/// Speeds beyond this multiple of `$|W|$` belong to the root at infinity, where the scaled
/// residual vanishes without a solution. Real roots stay below about `$(r_m/r_b)/\cos\alpha$`,
/// less than 1e4 for any screw.
const SPEED_LIMIT: f64 = 1e6;

/// First-order numbers are trusted to deny a root when `$\varepsilon/f$`, the ratio of inertia
/// to friction forces, is below this: their error is of that order.
const FIRST_ORDER_VALID: f64 = 0.05;

/// A solve may take this many steps; more means that the start was not near the root, and the
/// path in the inertia is safer.
const DIRECT_STEPS: usize = 8;

/// A root of the rigid equations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Root {
    pub(crate) unknowns: Unknowns<f64>,
    /// Newton steps of all solves.
    pub(crate) steps: usize,
    pub(crate) residual: f64,
}

/// Why no root is returned.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NoRoot {
    pub(crate) status: Status,
    pub(crate) reason: Reason,
}

fn none(reason: Reason) -> NoRoot {
    NoRoot { status: Status::NoSolution, reason }
}

/// Memory of the solves.
pub struct RigidWorkspace(Workspace);

impl Default for RigidWorkspace {
    fn default() -> Self {
        Self(Workspace::new(BALL))
    }
}

/// Options of every Newton solve here.
///
/// A residual `$r$` leaves an error of `$r/\mu$` in the slip at A, and of `$r$` in the power
/// balance. Below the tolerance the steps therefore go on towards `$10^{-12}\mu$`, between
/// rounding and a safe distance from it.
fn options(case: &Scaled<f64>) -> Options {
    let residual_goal = (1e-12 * case.inertia_ratio()).clamp(1e-15, 1e-13);
    Options { residual_goal, max_steps: DIRECT_STEPS, ..Options::default() }
}

/// Finds the root, or the reason why there is none.
pub(crate) fn find(case: &Scaled<f64>, work: &mut RigidWorkspace) -> Result<Root, NoRoot> {
    self_locking(case)?;
    let start = FirstOrder::of(case);
    let small_inertia = start.inertia < FIRST_ORDER_VALID * case.friction;

    let (unknowns, report) = newton(case, start.unknowns(), work);
    let direct = report.converged().then(|| {
        let (steps, residual) = (report.steps.len(), report.residual);
        accept(case, Root { unknowns, steps, residual }, work)
    });
    if let Some(verdict) = &direct {
        if small_inertia || (near(&report) && verdict.is_ok() == start.exists()) {
            return verdict.clone();
        }
    } else if !start.exists() && (small_inertia || start.minor <= 0.0) {
        // A root with Q_A' < 0 keeps that sign along the path in the inertia, which then folds.
        return Err(denied(case, &start, work));
    }
    match (follow_inertia(case, &start, report.steps.len(), work), direct) {
        (Some(root), _) => accept(case, root, work),
        (None, Some(Ok(root))) => Ok(root),
        (None, _) if start.exists() => Err(not_converged(&report)),
        (None, _) => Err(denied(case, &start, work)),
    }
}

/// One damped Newton solve from `y`; a root that it meets with its last step is refined.
fn newton(
    case: &Scaled<f64>,
    mut y: Unknowns<f64>,
    work: &mut RigidWorkspace,
) -> (Unknowns<f64>, Report) {
    let weights = case.weights();
    let scales = Scales { x: &[1.0; BALL], f: &weights };
    let mut run = || {
        solve(case, y.as_mut_slice(), &scales, &options(case), &mut work.0)
            .expect("sizes are constant and the weights positive")
    };
    let mut report = run();
    if report.converged() && report.steps.len() == DIRECT_STEPS {
        let refined = run();
        report.residual = refined.residual;
        report.steps.extend(refined.steps);
    }
    (y, report)
}

/// True if the solve went to its root straight away: the start was on the same branch.
fn near(report: &Report) -> bool {
    report.converged()
        && report.steps.len() < DIRECT_STEPS
        && report.steps.iter().all(|s| s.lambda > 0.5)
}

/// Follows the root from small inertia to the full one, where the first-order start is bad.
///
/// The path in the inertia is smooth, through `$\lambda = 0$` too. Each unknown is predicted as a
/// power of the inertia: the loads and speeds have power laws at both ends of the path. The step
/// of the logarithm is halved when a solve strays and grows again afterwards. `steps` counts
/// those already taken. `None` if the path ends before full inertia.
fn follow_inertia(
    case: &Scaled<f64>,
    start: &FirstOrder,
    mut steps: usize,
    work: &mut RigidWorkspace,
) -> Option<Root> {
    /// Ratio of inertia to friction forces at which the first-order start is safe.
    const BEGIN: f64 = 1e-3;
    /// Longest and shortest step of the logarithm, and solves in all, before giving up.
    const LONGEST: f64 = 0.5;
    const SHORTEST: f64 = 1e-4;
    const MOST_SOLVES: usize = 200;
    /// A solve of the path that takes more steps may have changed the branch.
    const PATH_STEPS: usize = 5;

    let mut log = (BEGIN * case.friction / start.inertia).min(1.0).ln();
    let begin = FirstOrder::of(&case.with_inertia(log.exp())).unknowns();
    let (mut at, report) = newton(&case.with_inertia(log.exp()), begin, work);
    steps += report.steps.len();
    if !report.converged() {
        return None;
    }
    // Exponents d ln y / d ln μ: at first Q_A' alone grows.
    let mut exponents = Unknowns::from([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut stride = LONGEST;
    for _ in 0..MOST_SOLVES {
        let next = (log + stride).min(0.0);
        let guess = at.zip_map(&exponents, |y, e| y * (e * (next - log)).exp());
        let (found, report) = newton(&case.with_inertia(next.exp()), guess, work);
        steps += report.steps.len();
        if near(&report) && report.steps.len() <= PATH_STEPS {
            exponents = found.zip_map(&at, |new, old| {
                let ratio = new / old;
                // An unknown on its way through zero follows no power law.
                if ratio > 0.0 { (ratio.ln() / (next - log)).clamp(-2.0, 2.0) } else { 0.0 }
            });
            (at, log) = (found, next);
            if log >= 0.0 {
                return Some(Root { unknowns: at, steps, residual: report.residual });
            }
            stride = (1.5 * stride).min(LONGEST);
        } else {
            stride *= 0.5;
            if stride < SHORTEST {
                return None;
            }
        }
    }
    None
}

/// Accepts a converged root of the extended equations if it is one of the physical ones.
fn accept(case: &Scaled<f64>, root: Root, work: &mut RigidWorkspace) -> Result<Root, NoRoot> {
    let y = &root.unknowns;
    let speed_ratio = y[4].abs().max(y[3].abs());
    if speed_ratio > SPEED_LIMIT {
        return Err(none(Reason::RootAtInfinity { speed_ratio }));
    }
    if y[0] <= 0.0 || y[2] <= 0.0 {
        let (nut_load_ratio, screw_load_ratio) = (y[0], y[2]);
        return Err(none(Reason::LoadedContactWouldPull { nut_load_ratio, screw_load_ratio }));
    }
    if y[1] <= 0.0 {
        return Err(none(Reason::MinorContactWouldPull { load_ratio: y[1] }));
    }
    if y[4] <= 0.0 {
        let critical_lead_angle = critical_lead_angle(case, work);
        let (slip, exact) = (y[4], true);
        return Err(none(Reason::NutContactWouldRoll { slip, exact, critical_lead_angle }));
    }
    Ok(root)
}

/// The first-order reason why no root exists.
fn denied(case: &Scaled<f64>, start: &FirstOrder, work: &mut RigidWorkspace) -> NoRoot {
    if start.minor <= 0.0 {
        return none(Reason::MinorContactWouldPull { load_ratio: start.minor * start.inertia });
    }
    let critical_lead_angle = critical_lead_angle(case, work);
    none(Reason::NutContactWouldRoll { slip: start.slip, exact: false, critical_lead_angle })
}

fn not_converged(report: &Report) -> NoRoot {
    let reason = Reason::Newton {
        status: report.status,
        residual: report.residual,
        worst_equation: report.worst_equation_name.clone(),
    };
    NoRoot { status: Status::NotConverged, reason }
}

/// Lin's Eq 16, the limit of small inertia.
fn self_locking(case: &Scaled<f64>) -> Result<(), NoRoot> {
    let angles = Angles { lead: case.helix.lead_angle, contact: case.contact_angle };
    let driving = case.sign > 0.0;
    if driving && angles.self_locking(Direction::RotaryToLinear, case.friction) {
        return Err(none(Reason::SelfLocking {
            sin_contact_angle: angles.contact.sin(),
            friction_term: case.friction * angles.slip_factor(),
        }));
    }
    Ok(())
}

/// Smallest lead angle above the point's at which the slip at A is no longer negative.
///
/// The first-order margin brackets it, Newton on the exact equations with the lead angle as an
/// unknown finds it. `None` if there is none below 80 degrees.
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
    let mut low = (high - STEP).max(0.5 * high);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if at(middle).exists() { high = middle } else { low = middle }
    }

    let mut x = at(high).unknowns();
    x[4] = high;
    let weights = case.weights();
    let scales = Scales { x: &[1.0; BALL], f: &weights };
    let limit = ExistenceLimit(case);
    let report = solve(&limit, x.as_mut_slice(), &scales, &options(case), &mut work.0)
        .expect("sizes are constant and the weights positive");
    let found = report.converged() && x[1] > 0.0 && x[4] > case.helix.lead_angle;
    found.then_some(x[4])
}
