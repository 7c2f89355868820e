//! Static balance of the rolling ball in two unknowns, and its first root.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W2), (W12) to (W15).

use std::convert::Infallible;
use std::iter::successors;

use bsm_kin::{BallFrame, Contact, Motion, Over, Scalar, Site};
use bsm_newton::{Bracket, Convergence, EvalError, JacobianUpdate, Options, Report, Scales, solve};
use bsm_simd::Arch;

use super::rolling::rolling;
use super::statics::{Rates, STATIC, StaticBalance, StaticState};
use crate::contact::binormal_displacement;
use crate::cost::{count_of, searched};
use crate::models::ball::{
    BallLoads, Control, ElasticContacts, Evidence, NoAnswer, Reason, Workspace, equations,
};

/// Maximum number of Newton steps from a bracketed root.
const MAX_STEPS_FROM_BRACKET: usize = 8;

/// Passes of the rising bound (W14). Each is a fixed-point step, as Newton's may pass the first root; thousands are needed
/// where the centrifugal force nearly touches what the flanks hold.
const MOST_PASSES: usize = 20_000;

/// Steps of the scan for more roots, and their ends.
const SCAN: u8 = 48;
const SAMPLES: usize = SCAN as usize + 1;

/// Roots that differ by less, relative, are one.
const SAME: f64 = 1e-6;

/// Static balance of the ball in the normal plane.
pub(super) struct Balance<'a, P: Scalar = f64> {
    pub(super) contacts: &'a ElasticContacts<P>,
    pub(super) control: Control,
    statics: StaticBalance<P>,
}

impl<'a, P: Scalar> Balance<'a, P> {
    pub(super) fn new(contacts: &'a ElasticContacts<P>, control: Control) -> Self {
        let statics = StaticBalance::of(&contacts.scaled, control == Control::Nut);
        Self { contacts, control, statics }
    }

    /// Residuals of the radial balance and of the triangle of the arc centres (W12), (W13).
    pub(super) fn equations<D: Over<P>>(&self, x: &[D; STATIC]) -> [D; STATIC] {
        self.statics.residual(x[0], &self.statics.loaded(*x))
    }

    #[expect(clippy::unnecessary_wraps, reason = "the shape that equations have")]
    fn residual<D: Over<P>>(&self, x: &[D; STATIC]) -> Result<[D; STATIC], EvalError> {
        Ok(self.equations(x))
    }

    /// Loads, angles and contacts of the unknowns.
    pub(super) fn loaded<D: Over<P>>(&self, &[c, screw]: &[D; STATIC]) -> BallLoads<D> {
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

    /// Rolling motion relative to the nut over `$W$`.
    pub(super) fn rolling<D: Over<P>>(&self, loaded: &BallLoads<D>) -> Motion<D> {
        let contacts = self.contacts;
        let (lead, arc) =
            (D::from(contacts.helix.lead_angle).sin_cos(), D::from(contacts.scaled.arc));
        let angles = loaded.angles.map(|angle| angle.sin_cos());
        let (p, omega) = rolling(self.control == Control::Nut, lead, arc, angles);
        Motion { precession: p, omega: loaded.frame.from_frenet(&omega.into()) }
    }
}

/// A root of the balance.
pub(super) struct StaticRoot {
    pub(super) unknowns: [f64; STATIC],
    pub(super) steps: usize,
    pub(super) residual: f64,
}

impl Balance<'_> {
    /// One over the sizes of both equations.
    pub(super) fn weights(&self) -> [f64; STATIC] {
        let rate = self.contacts.scaled.nut_speed.abs().max(1.0);
        // As far as a double goes.
        let size = (self.statics.inertia * rate * rate).clamp(f64::MIN_POSITIVE, 0.25 * f64::MAX);
        [size.recip(), 1.0]
    }

    /// The root with the smallest difference of the contact angles, or the proof that there is
    /// none on the flanks.
    ///
    /// * `near`: a root of the other raceway, if there is one.
    pub(super) fn first_root(
        &self,
        near: Option<[f64; STATIC]>,
        newton: &mut Workspace<STATIC>,
    ) -> Result<StaticRoot, NoAnswer> {
        let mut at = match near {
            Some(unknowns) => StaticState { unknowns, steps: 0.0, converged: false },
            None => self.statics.start(self.unloaded(), true),
        };
        self.statics.iterate(&mut at);
        let residual = self.statics.scaled_residual(at.unknowns);
        let mut steps = count_of(at.steps);
        if at.converged
            && residual < StaticBalance::<f64>::CLOSED
            && self.statics.is_first(at.unknowns)
        {
            return Ok(StaticRoot { unknowns: at.unknowns, steps, residual });
        }
        let bracketed = self.bracketed()?;
        let mut x = bracketed;
        let report = self.run(&mut x, newton);
        steps += report.steps.len();
        // Where two roots meet, Newton may go to the other.
        if report.converged() && x[1] > 0.0 && (x[0] - bracketed[0]).abs() <= 1e-3 * bracketed[0] {
            return Ok(StaticRoot { unknowns: x, steps, residual: report.residual });
        }
        Err(NoAnswer::not_converged(Reason::from(report)))
    }

    /// True if there is no second root.
    pub(super) fn is_unique(&self) -> bool {
        self.statics.is_unique(self.unloaded(), true)
    }

    /// Roots on the flanks whose contact angles differ by more than those of the first root `x`, up to
    /// the resolution of a scan.
    pub(super) fn farther_roots(
        &self,
        &[first, _]: &[f64; STATIC],
        newton: &mut Workspace<STATIC>,
    ) -> Vec<StaticRoot> {
        if self.is_unique() { Vec::new() } else { self.scan(first, newton) }
    }

    /// The roots beyond a first one.
    fn scan(&self, first: f64, newton: &mut Workspace<STATIC>) -> Vec<StaticRoot> {
        searched();
        let farthest = self.farthest();
        let difference = |c: f64| c - self.centrifugal(self.rate_at(c));
        let begin = (first * (1.0 + SAME)).max(1e-3 * farthest);
        let grow = (farthest / begin).powf(f64::from(SCAN).recip());
        let mut samples = [begin; SAMPLES];
        for i in 1..SAMPLES {
            samples[i] = samples[i - 1] * grow;
        }
        samples[SAMPLES - 1] = farthest;
        let rates =
            Rates { balance: &self.statics, differences: &samples, unloaded: self.unloaded() };
        let rates: [f64; SAMPLES] = Arch::new().dispatch(rates);
        let at = |i: usize| samples[i] - self.centrifugal(rates[i]);
        let mut found = Vec::new();
        for i in 1..SAMPLES {
            let (ends, values) = ([samples[i - 1], samples[i]], [at(i - 1), at(i)]);
            if let Some(root) = Bracket::new(ends, values).root(difference).root() {
                found.extend(self.refined(root.x, newton));
            }
        }
        found
    }

    /// The root near a difference of the cotangents, by Newton; `None` where that goes to another.
    fn refined(&self, near: f64, newton: &mut Workspace<STATIC>) -> Option<StaticRoot> {
        let mut x = [near, self.closed(near)];
        let report = self.run(&mut x, newton);
        let found = report.converged() && x[1] > 0.0 && (x[0] - near).abs() <= 1e-3 * near;
        found.then_some(StaticRoot {
            unknowns: x,
            steps: report.steps.len(),
            residual: report.residual,
        })
    }

    /// `$\mu\cos\alpha\,(P/W)^2$`.
    fn centrifugal(&self, rate: f64) -> f64 {
        self.statics.inertia * rate * rate
    }

    /// Newton from `x`.
    fn run(&self, x: &mut [f64; STATIC], newton: &mut Workspace<STATIC>) -> Report {
        let weights = self.weights();
        let scales = Scales { x: &[weights[0].max(1.0), 1.0], f: &weights };
        // The displacement is a difference of lengths: down to their rounding.
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

    /// Cotangent of the unloaded contact angle.
    fn unloaded(&self) -> f64 {
        let angle = self.contacts.contact_angle;
        angle.cos() / angle.sin()
    }

    /// Cotangent of the screw's contact angle that closes the triangle at a difference `c`.
    fn closed(&self, c: f64) -> f64 {
        self.statics.closed(c, self.unloaded())
    }

    /// Largest difference of the cotangents on the flanks: the screw's contact angle is 90 deg there.
    fn farthest(&self) -> f64 {
        let difference = |cot: f64| {
            self.statics.contact(0, cot).radial_distance() - self.statics.radial_distance
        };
        let most = f64::MAX.sqrt();
        let places = successors(Some(1.0), |cot| Some(4.0 * cot).filter(|cot| *cot < most));
        let value = |cot| Ok::<_, Infallible>(difference(cot));
        let Ok(change) = Bracket::first_change((0.0, difference(0.0)), places, value);
        let root = change.and_then(|bracket| bracket.root(difference).root());
        root.map_or(most, |root| root.ends[0])
    }

    /// `$P/W$` at a difference of the cotangents.
    fn rate_at(&self, c: f64) -> f64 {
        self.statics.rate_at(c, self.unloaded())
    }

    /// The first root by brackets, in any inertia; or the proof that there is none.
    ///
    /// The rate is monotone in the difference of the cotangents, so that one of two cases holds up
    /// to where it changes its sign: the centrifugal force falls, and meets the straight line `c`
    /// at most once; or it rises, and its value at any lower bound of the first root is one too.
    fn bracketed(&self) -> Result<[f64; STATIC], NoAnswer> {
        let farthest = self.farthest();
        let outwards = match self.control {
            Control::Nut => 1.0,
            Control::Screw => -1.0,
        };
        let none = || {
            let rate = self.rate_at(farthest);
            let (held, centrifugal) =
                (farthest * self.statics.axial, self.centrifugal(rate) * self.statics.axial);
            let reason = Reason::FlanksCannotHold { control: self.control, held, centrifugal };
            NoAnswer::none(Evidence::Proof, reason)
        };
        let at_rest = self.rate_at(0.0);
        let c = if outwards * at_rest >= 0.0 {
            self.rising(farthest).ok_or_else(none)?
        } else {
            // Beyond a rate of zero the line is above.
            let above = |c: f64| {
                let rate = self.rate_at(c);
                if outwards * rate >= 0.0 { c } else { c - self.centrifugal(rate) }
            };
            if above(farthest) < 0.0 {
                return Err(none());
            }
            let ends = [0.0, self.centrifugal(at_rest).min(farthest)];
            let found = Bracket::new(ends, ends.map(above)).root(above);
            found.root().map_or(ends[1], |root| root.x)
        };
        Ok([c, self.closed(c)])
    }

    /// The first root where the centrifugal force rises with the difference of the cotangents.
    fn rising(&self, farthest: f64) -> Option<f64> {
        let mut bound = 0.0;
        for _ in 0..MOST_PASSES {
            // c ← μ cosα (P(c)/W)²                                        (W14)
            let next = self.centrifugal(self.rate_at(bound));
            if next > farthest {
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
    STATIC,
    Balance::residual,
    ["radial force balance", "triangle of the groove-arc centres"]
);

#[cfg(test)]
mod tests;
