//! Where the root of a point is looked for, and when there is none.
//!
//! Theory: `docs/theory/09-traction.md`, sections "Starts" and "Existence".

use bsm_newton::{Report, Workspace};

use super::path::Shown;
use super::scatter::{MANY, STARTS};
use super::{OMEGA, Rolling, State};
use crate::balance::{POWER_BALANCE_TOL, Power, ideal_torque, torque};
use crate::elastic::Skid;
use crate::follow::{Stride, follow};
use crate::layout::BALL;
use crate::raceway_control::Grip;
use crate::{Reason, Status};

/// Skid number from which the skidding ball is the nearer start.
const SKIDS: f64 = 0.3;

/// No ball turns that fast: friction takes the power that the screw puts in.
const FASTEST: f64 = 1e9;

/// Inertia over friction below which a path that leaves the flanks is not asked about twice.
const CALM: f64 = 1e-3;

/// A root of the equations of a point.
pub(super) struct Root {
    pub(super) unknowns: [f64; BALL],
    /// Newton steps of all solves.
    pub(super) steps: usize,
    pub(super) residual: f64,
}

impl Rolling<'_> {
    /// The root, from a root near by, from the gripping ball or from the skidding one; if none of
    /// them leads to it, from friction that is nearly proportional to the slip, along the path of
    /// growing inertia, and from starts all over. The last two are for a point that has not been
    /// solved with another quadrature.
    ///
    /// Where the roots of the path are all beyond the flanks, and no start leads to another, the
    /// answer is that there is none.
    pub(super) fn find(
        &self,
        grip: &Grip,
        near: Option<&[f64; BALL]>,
        newton: &mut Workspace,
        wide: &mut Workspace,
    ) -> Result<Root, (Status, Reason)> {
        let gripping = self.unknowns(&grip.loaded, &grip.to_nut);
        let mut steps = 0;
        let mut failure = None;
        let skids = grip.skid_number(self.pair) > SKIDS;
        let starts = [near.map(Begin::Near), Some(Begin::of(skids)), Some(Begin::of(!skids))];
        for start in starts.into_iter().flatten() {
            let mut y = match start {
                Begin::Near(root) => *root,
                Begin::Grip => gripping,
                Begin::Skid => {
                    let Ok(skid) = Skid::of(self.pair, newton) else { continue };
                    steps += skid.steps();
                    self.unknowns(skid.state().0, skid.state().1)
                }
            };
            let report = self.run(&mut y, newton);
            steps += report.steps.len();
            if report.converged() && self.is_admissible(&y) {
                return Ok(Root { unknowns: y, steps, residual: report.residual });
            }
            failure = Some(report);
        }
        let mut y = gripping;
        let mut residual = f64::INFINITY;
        let stride = Stride { first: 1.0, shortest: 0.05 };
        let arrived = follow(&mut y, (0.0, self.creep.ln()), stride, |log, y| {
            let report = Self { creep: log.exp(), ..*self }.run(y, newton);
            steps += report.steps.len();
            residual = report.residual;
            report.converged()
        });
        if arrived.is_ok() && self.is_admissible(&y) {
            return Ok(Root { unknowns: y, steps, residual });
        }
        let failed = |failure: Option<Report>| {
            let report = failure.expect("the gripping start was tried");
            Err((Status::NotConverged, Reason::from(report)))
        };
        if near.is_some() {
            return failed(failure);
        }
        let shown = self.followed(newton, wide, &mut steps);
        if let Shown::Root(unknowns, residual) = shown
            && self.is_balanced(&unknowns)
        {
            return Ok(Root { unknowns, steps, residual });
        }
        let starts = match shown {
            Shown::Beyond(_) if self.is_calm() => 0,
            Shown::Stopped(_) => MANY,
            _ => STARTS,
        };
        if let Some((unknowns, residual)) = self.scatter(starts, newton, &mut steps) {
            return Ok(Root { unknowns, steps, residual });
        }
        match shown {
            // Rounding has eaten it, which its powers will show.
            Shown::Root(unknowns, residual) => Ok(Root { unknowns, steps, residual }),
            Shown::Beyond([nut, screw]) | Shown::Stopped([nut, screw]) => {
                Err((Status::NoSolution, Reason::BallLeavesFlank { nut, screw }))
            }
            Shown::Nothing => failed(failure),
        }
    }

    /// True for a root with both contacts on their flanks.
    pub(super) fn is_admissible(&self, y: &[f64; BALL]) -> bool {
        !self.is_beyond(y, 0.0) && OMEGA.iter().all(|i| y[*i].abs() < FASTEST)
    }

    /// True for a root whose powers balance. Where a ball turns faster and faster about the axis the
    /// residual vanishes without a root, and the powers do not balance.
    pub(super) fn is_balanced(&self, y: &[f64; BALL]) -> bool {
        let (pair, radius) = (self.pair, self.pair.helix.radius);
        self.state(y).is_ok_and(|State { loaded, to_nut, wrench }| {
            let friction = pair.friction_power(&loaded, &to_nut, self.creep, self.quadrature);
            let torque = torque(&wrench[1], radius, &loaded.frame);
            let ideal = ideal_torque(1.0, radius, pair.helix.lead_angle);
            let power = Power::transmitted(torque, ideal, pair.sign());
            power.imbalance(friction).abs() <= POWER_BALANCE_TOL
        })
    }

    /// True if inertia forces are too small against friction to move the ball to another root.
    fn is_calm(&self) -> bool {
        let rate = self.pair.nut_speed.abs().max(1.0);
        self.pair.inertia_ratio() * rate * rate < CALM * self.pair.friction
    }
}

/// Where a solve begins.
#[derive(Clone, Copy)]
enum Begin<'a> {
    /// At a root of the same point with another quadrature.
    Near(&'a [f64; BALL]),
    /// At the gripping ball.
    Grip,
    /// At the skidding ball.
    Skid,
}

impl Begin<'_> {
    fn of(skids: bool) -> Self {
        if skids { Self::Skid } else { Self::Grip }
    }
}
