//! Roots of the static balance of the rolling ball for a single point, found by Newton's method and
//! by bracketing.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W2), (W12) to (W15).

use std::convert::Infallible;
use std::iter::successors;

use bsm_kin::{BallFrame, Contact, Motion, Over, Scalar, Site};
use bsm_newton::{Bracket, Convergence, EvalError, JacobianUpdate, Options, Report, Scales, solve};
use bsm_simd::Arch;

use super::direct::RollingRoot;
use super::rolling::rolling;
use super::statics::{Rates, STATIC_UNKNOWNS, StaticBalance};
use crate::contact::binormal_displacement;
use crate::cost::{count_of, count_search};
use crate::models::ball::{
    BallLoads, Control, ElasticContacts, Evidence, Reason, SolveFailure, Workspace, equations,
};

/// Maximum number of Newton steps that refine a bracketed root.
const MAX_STEPS_FROM_BRACKET: usize = 8;

/// Maximum number of fixed-point steps for the lower bound (W14). Newton steps are not used because
/// they could pass the first root. Thousands of fixed-point steps are necessary if the centrifugal
/// force is close to the largest force that the flanks can hold.
const MAX_LOWER_BOUND_STEPS: usize = 20_000;

/// Number of intervals that the scan for other roots examines.
const SCAN_INTERVALS: u8 = 48;

/// Number of interval boundaries at which the scan evaluates the static balance.
const SAMPLES: usize = SCAN_INTERVALS as usize + 1;

/// Minimum starting point of the scan for other roots, divided by the largest difference of the
/// cotangents at which both contacts are on their flanks (dimensionless).
const MIN_SCAN_START: f64 = 1e-3;

/// Minimum relative distance between another root and the first root (dimensionless).
const MIN_ROOT_DISTANCE: f64 = 1e-6;

/// Maximum relative change of the unknown during the refinement of a bracketed root
/// (dimensionless). After a larger change, Newton's method has converged to a different root.
const MAX_REFINEMENT_CHANGE: f64 = 1e-3;

/// Static force balance of the ball in the normal plane.
pub(super) struct Balance<'a, P: Scalar = f64> {
    pub(super) contacts: &'a ElasticContacts<P>,
    pub(super) control: Control,
    statics: StaticBalance<P>,
}

impl<'a, P: Scalar> Balance<'a, P> {
    /// Creates the static balance of a ball with a given controlling raceway.
    pub(super) fn new(contacts: &'a ElasticContacts<P>, control: Control) -> Self {
        let statics = StaticBalance::of(&contacts.into(), control == Control::Nut);
        Self { contacts, control, statics }
    }

    /// Returns the residuals of the radial force balance (W12) and of the radial closure of the
    /// groove arcs (W13).
    pub(super) fn equations<D: Over<P>>(&self, x: &[D; STATIC_UNKNOWNS]) -> [D; STATIC_UNKNOWNS] {
        self.statics.residual(x[0], &self.statics.loaded(*x))
    }

    #[expect(
        clippy::unnecessary_wraps,
        reason = "the macro `equations!` requires this return type"
    )]
    fn residual<D: Over<P>>(
        &self,
        x: &[D; STATIC_UNKNOWNS],
    ) -> Result<[D; STATIC_UNKNOWNS], EvalError> {
        Ok(self.equations(x))
    }

    /// Returns the loads, the contact angles and the contact geometry for given unknowns.
    pub(super) fn loaded<D: Over<P>>(&self, &[c, screw]: &[D; STATIC_UNKNOWNS]) -> BallLoads<D> {
        let ElasticContacts { helix, contact_angle, scaled, .. } = self.contacts;
        let nut = screw + c;
        let [a, b] = self.statics.loaded([c, screw]);
        let one = D::from(1.0);
        let angles = [one.atan2(nut), one.atan2(screw)];
        // tan 2ν = (cotβ_A − cotβ_B) / (1 + cotβ_A cotβ_B)
        let tilt = c.atan2(nut * screw + 1.0) * 0.5;
        let contacts = [Contact::tilted(Site::Nut, -tilt), Contact::tilted(Site::Screw, tilt)];
        let mean = angles[1] - tilt;
        let frame = BallFrame::turned(D::from(helix.lead_angle), mean);
        let unloaded = (scaled.offsets[0] + scaled.offsets[1]) * contact_angle.sin();
        let displacement = binormal_displacement([a.length, b.length], [a.sin, b.sin], unloaded);
        BallLoads { loads: [a.load, b.load], tilt, angles, frame, contacts, displacement }
    }

    /// Returns the rolling motion relative to the nut, divided by `$W$`.
    pub(super) fn rolling<D: Over<P>>(&self, loaded: &BallLoads<D>) -> Motion<D> {
        let contacts = self.contacts;
        let (lead, arc) =
            (D::from(contacts.helix.lead_angle).sin_cos(), D::from(contacts.scaled.arc));
        let angles = loaded.angles.map(|angle| angle.sin_cos());
        let (p, omega) = rolling(self.control == Control::Nut, lead, arc, angles);
        Motion { precession: p, omega: loaded.frame.from_frenet(&omega.into()) }
    }
}

/// A root of the static balance of the rolling ball.
pub(super) struct StaticRoot {
    pub(super) unknowns: [f64; STATIC_UNKNOWNS],
    /// Number of Newton steps.
    pub(super) steps: usize,
    /// Scaled residual at the root.
    pub(super) residual: f64,
}

impl From<&RollingRoot<f64>> for StaticRoot {
    fn from(root: &RollingRoot<f64>) -> Self {
        let (steps, residual) = (count_of(root.steps), root.residual);
        Self { unknowns: root.unknowns, steps, residual }
    }
}

impl Balance<'_> {
    /// Returns the weights of both equations, which are the reciprocals of the magnitudes of their
    /// terms.
    pub(super) fn weights(&self) -> [f64; STATIC_UNKNOWNS] {
        let rate = self.contacts.scaled.nut_speed.abs().max(1.0);
        // Clamping keeps the weights within the range of double precision.
        let size = (self.statics.inertia * rate * rate).clamp(f64::MIN_POSITIVE, 0.25 * f64::MAX);
        [size.recip(), 1.0]
    }

    /// Finds the root with the smallest difference between the contact angles.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::FlanksCannotHold`] if there is provably no root on the flanks, and
    /// [`Reason::Newton`] if Newton's method does not converge.
    pub(super) fn first_root(
        &self,
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<StaticRoot, SolveFailure> {
        // First, Newton's method is started from equal contact angles.
        let direct = RollingRoot::direct(&self.contacts.into(), Some(self.control), true);
        if direct.is_first_root {
            return Ok(StaticRoot::from(&direct));
        }

        // If Newton's method fails from equal contact angles, the root is found by bracketing.
        let refined = self.refined(self.bracketed()?, newton)?;
        Ok(StaticRoot { steps: count_of(direct.steps) + refined.steps, ..refined })
    }

    /// Returns true if a second root is provably excluded.
    pub(super) fn is_unique(&self) -> bool {
        self.statics.is_unique(true)
    }

    /// Finds roots on the flanks that have a larger difference between the contact angles than the
    /// first root. The scan may miss pairs of roots that are closer together than its resolution.
    pub(super) fn farther_roots(
        &self,
        &[first, _]: &[f64; STATIC_UNKNOWNS],
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Vec<StaticRoot> {
        if self.is_unique() { Vec::new() } else { self.scan(first, newton) }
    }

    /// Scans for roots that have a larger difference of the cotangents than the first root.
    fn scan(&self, first: f64, newton: &mut Workspace<STATIC_UNKNOWNS>) -> Vec<StaticRoot> {
        count_search();
        let max_difference = self.max_difference();
        let difference = |c: f64| c - self.centrifugal(self.statics.rate_at(c));
        let begin = (first * (1.0 + MIN_ROOT_DISTANCE)).max(MIN_SCAN_START * max_difference);
        let grow = (max_difference / begin).powf(f64::from(SCAN_INTERVALS).recip());
        let mut samples = [begin; SAMPLES];
        for i in 1..SAMPLES {
            samples[i] = samples[i - 1] * grow;
        }
        samples[SAMPLES - 1] = max_difference;
        let rates = Rates { balance: &self.statics, differences: &samples };
        let rates: [f64; SAMPLES] = Arch::new().dispatch(rates);
        let at = |i: usize| samples[i] - self.centrifugal(rates[i]);
        let mut found = Vec::new();
        for i in 1..SAMPLES {
            let (ends, values) = ([samples[i - 1], samples[i]], [at(i - 1), at(i)]);
            if let Some(root) = Bracket::new(ends, values).root(difference).root() {
                found.extend(self.refined([root.x, self.statics.screw_cotangent(root.x)], newton));
            }
        }
        found
    }

    /// Refines a bracketed root by Newton's method.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::Newton`] if Newton's method does not converge, or if it converges to a
    /// different root.
    fn refined(
        &self,
        bracketed: [f64; STATIC_UNKNOWNS],
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Result<StaticRoot, SolveFailure> {
        let mut x = bracketed;
        let report = self.run(&mut x, newton);
        // If two roots are close together, Newton's method may converge to the wrong root.
        let change = (x[0] - bracketed[0]).abs();
        if report.converged() && x[1] > 0.0 && change <= MAX_REFINEMENT_CHANGE * bracketed[0] {
            let (steps, residual) = (report.steps.len(), report.residual);
            return Ok(StaticRoot { unknowns: x, steps, residual });
        }
        Err(SolveFailure::not_converged(Reason::from(report)))
    }

    /// Returns the centrifugal term `$\mu\cos\alpha\,(P/W)^2$` of (W12).
    fn centrifugal(&self, rate: f64) -> f64 {
        self.statics.inertia * rate * rate
    }

    /// Runs Newton's method from the starting value `x`.
    fn run(
        &self,
        x: &mut [f64; STATIC_UNKNOWNS],
        newton: &mut Workspace<STATIC_UNKNOWNS>,
    ) -> Report {
        let weights = self.weights();
        let scales = Scales { x: &[weights[0].max(1.0), 1.0], f: &weights };
        // The residual goal is the rounding error of the lengths, because the axial displacement is
        // calculated as a difference of lengths.
        let options = Options {
            convergence: Convergence {
                residual_goal: 3e-15,
                max_steps: MAX_STEPS_FROM_BRACKET,
                ..Convergence::default()
            },
            jacobian: JacobianUpdate::EveryTrial { chord_below: 0.0 },
            ..Options::default()
        };
        solve(self, x, &scales, &options, newton).report
    }

    /// Returns the largest difference of the cotangents for which both contacts are on their
    /// flanks. At this difference, the contact angle at the screw is 90 degrees. If no such
    /// difference is found, returns the square root of the largest floating-point number.
    fn max_difference(&self) -> f64 {
        let difference = |cot: f64| {
            self.statics.contact(0, cot).radial_component() - self.statics.radial_distance
        };
        let most = f64::MAX.sqrt();
        let places = successors(Some(1.0), |cot| Some(4.0 * cot).filter(|cot| *cot < most));
        let value = |cot| Ok::<_, Infallible>(difference(cot));
        let Ok(change) = Bracket::first_sign_change((0.0, difference(0.0)), places, value);
        let root = change.and_then(|bracket| bracket.root(difference).root());
        root.map_or(most, |root| root.ends[0])
    }

    /// Finds the first root by bracketing, for any inertia.
    ///
    /// The precession rate `$P/W$` is monotonic in the difference `c` of the cotangents. Up to the
    /// sign change of the rate, the centrifugal term either decreases, so that it equals `c` at
    /// most once, or increases. In the second case, the value of the centrifugal term at a lower
    /// bound of the first root is another lower bound.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::FlanksCannotHold`] if there is provably no root.
    fn bracketed(&self) -> Result<[f64; STATIC_UNKNOWNS], SolveFailure> {
        let max_difference = self.max_difference();
        let outwards = match self.control {
            Control::Nut => 1.0,
            Control::Screw => -1.0,
        };
        let failure = || {
            let rate = self.statics.rate_at(max_difference);
            let (max_force_ratio, force_ratio) =
                (max_difference * self.statics.axial, self.centrifugal(rate) * self.statics.axial);
            let reason =
                Reason::FlanksCannotHold { control: self.control, max_force_ratio, force_ratio };
            SolveFailure::no_solution(Evidence::Proof, reason)
        };
        let at_rest = self.statics.rate_at(0.0);
        let c = if outwards * at_rest >= 0.0 {
            self.rising(max_difference).ok_or_else(failure)?
        } else {
            // There is no root beyond the sign change of the precession rate, so the function
            // returns a positive value there.
            let above = |c: f64| {
                let rate = self.statics.rate_at(c);
                if outwards * rate >= 0.0 { c } else { c - self.centrifugal(rate) }
            };
            if above(max_difference) < 0.0 {
                return Err(failure());
            }
            let ends = [0.0, self.centrifugal(at_rest).min(max_difference)];
            let found = Bracket::new(ends, ends.map(above)).root(above);
            found.root().map_or(ends[1], |root| root.x)
        };
        Ok([c, self.statics.screw_cotangent(c)])
    }

    /// Returns the difference of the cotangents at the first root if the centrifugal force
    /// increases with this difference, or `None` if there is no root on the flanks.
    fn rising(&self, max_difference: f64) -> Option<f64> {
        let mut bound = 0.0;
        for _ in 0..MAX_LOWER_BOUND_STEPS {
            // c ← μ cosα (P(c)/W)²                                        (W14)
            let next = self.centrifugal(self.statics.rate_at(bound));
            if next > max_difference {
                return None;
            }
            let converged = next <= bound * (1.0 + 4.0 * f64::EPSILON);
            bound = next.max(bound);
            if converged {
                break;
            }
        }
        Some(bound)
    }
}

equations!(
    Balance<'_>,
    STATIC_UNKNOWNS,
    Balance::residual,
    ["radial force balance", "closure of the triangle of arc centers"]
);

#[cfg(test)]
mod tests;
