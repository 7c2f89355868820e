//! The answer of a model: the state of the ball, what the screw transmits, and how it was found.
//!
//! SI units and radians. Loads are per ball, torque and powers of all loaded balls together.

use bsm_kin::{Field, Motion, Site};
use bsm_simd::Compare;

use crate::contact::{FilmState, POWER_BALANCE_TOL, Power, efficiency};
use crate::outcome::{Control, Direction, NoAnswer, Reason, named};

/// What a model says of the steady ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallState<F = f64> {
    /// Absolute motion in the Frenet-Serret triad `(t, n, b)` \[rad/s\]; none where the model fixes
    /// no motion.
    pub motion: Option<Motion<F>>,
    /// Contact with the loaded flank of the nut.
    pub nut: ContactState<F>,
    /// Contact with the loaded flank of the screw.
    pub screw: ContactState<F>,
    /// Contact with the unloaded flank of the nut, of models that have it.
    pub unloaded: Option<ContactState<F>>,
    /// Displacement of the nut along the screw axis \[m\] (J15), of elastic contacts.
    pub axial_displacement: Option<F>,
    /// Axial play of one nut below which friction presses the ball onto a far flank \[m\] (AC7), zero if no play does; of
    /// models with friction across the grooves in their balance.
    pub threshold_play: Option<F>,
}

/// One contact of the steady ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState<F = f64> {
    /// Contact angle \[rad\].
    pub angle: F,
    /// Normal load \[N\]; none where the load on the screw is not given.
    pub load: Option<F>,
    /// Direction of friction on the ball \[rad\].
    pub slip_angle: Option<F>,
    /// Slip at the contact centre and spin, of models with a motion.
    pub slip: Option<Slip<F>>,
    /// The pressed surface, of elastic contacts.
    pub pressed: Option<HertzContact<F>>,
}

/// The flanks opposite to the loaded ones, of a ball in gothic arches with a given play.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarFlank<F = f64> {
    /// Gap between the ball and the nearer far flank \[m\], negative where that flank is pressed.
    pub gap: F,
    /// The far contact with the larger load, if a far flank is pressed.
    pub contact: Option<ThirdContact<F>>,
    /// Friction power of all balls if each had two contacts \[W\], if those have a steady motion.
    pub two_contact_power: Option<F>,
}

/// A contact with a far flank: the third contact of a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThirdContact<F = f64> {
    /// Body that the ball touches: [`Site::Nut`] or [`Site::Screw`].
    pub site: Site,
    /// Normal load \[N\].
    pub load: F,
    /// Slip speed at its center \[m/s\].
    pub slip: F,
    /// Part of the friction power of the ball.
    pub power_share: F,
}

/// Velocities of the ball against the body at a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip<F = f64> {
    /// Slip speed at the contact centre \[m/s\].
    pub speed: F,
    /// Spin about the contact normal \[rad/s\].
    pub spin: F,
}

/// A Hertz contact under load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzContact<F = f64> {
    /// Semi-axes of the ellipse across and along the groove \[m\].
    pub semi_axes: (F, F),
    /// Largest pressure \[Pa\].
    pub max_pressure: F,
    /// Elastic approach \[m\].
    pub approach: F,
}

/// What the screw makes of the power put in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission<F: Field = f64> {
    /// Power out over power in; negative: self-locking.
    pub efficiency: F,
    /// True if friction holds the screw in this direction.
    pub self_locking: F::Mask,
    /// Torque on the screw that holds the steady state \[N·m\].
    pub screw_torque: Option<F>,
    /// Powers \[W\], where the speed is given.
    pub power: Option<Power<F>>,
    /// Relative violation of the power balance (B10), of models with a balance of forces.
    pub power_balance: Option<F>,
}

/// Where a ball is between rolling and skidding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkidNumbers<F = f64> {
    /// Gyroscopic over friction moment of the rolling motion (W9); none without friction.
    pub skid_number: Option<F>,
    /// The slip across the grooves that the lead forces, over the slip of spin (W10); none without
    /// spin.
    pub cross_slip: Option<F>,
}

impl SkidNumbers {
    pub(crate) fn new(skid_number: f64, cross_slip: f64) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        Self { skid_number: finite(skid_number), cross_slip: finite(cross_slip) }
    }

    /// What the ball does.
    pub fn regime(&self) -> Option<SlipRegime> {
        self.onset_number().map(SlipRegime::of)
    }
}

impl<F: Field> SkidNumbers<F> {
    /// Skid number of a ball whose friction is already spent on the slip of the lead (W11): below
    /// 0.1 the ball rolls, above 2 friction is nearly saturated.
    #[inline(always)]
    pub fn onset_number(&self) -> Option<F> {
        Some(onset_number(self.skid_number?, self.cross_slip?))
    }
}

/// How a root was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveInfo {
    /// Newton steps.
    pub steps: usize,
    /// Scaled residual.
    pub residual: f64,
}

/// The steady state by a model that has an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyState<F: Field = f64> {
    /// The ball.
    pub ball: BallState<F>,
    /// Torque and powers.
    pub transmission: Transmission<F>,
    /// Between rolling and skidding, of models that tell.
    pub skid: Option<SkidNumbers<F>>,
    /// How it was found, unless in closed form.
    pub info: Option<SolveInfo>,
    /// The raceway at which the ball does not spin, of raceway control.
    pub control: Option<ControllingRaceway>,
    /// Other admissible solutions that are known; none where none was looked for.
    pub alternatives: Option<Alternatives>,
    /// Bound of the error: of the quadrature in model traction, against model traction in the choice by
    /// error bounds.
    pub error: Option<ErrorBound<F>>,
    /// Of a lubricated ball.
    pub film: Option<FilmState<F>>,
    /// Power lost at the contacts with nut and screw by all balls together \[W\], of raceway control, of
    /// lubricated balls and of balls on a far flank.
    pub contact_power: Option<[F; 2]>,
    /// The far flanks, where a play is given.
    pub far_flank: Option<FarFlank<F>>,
}

/// How far an answer may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound<F = f64> {
    /// Of the efficiency.
    pub efficiency: F,
    /// Of the power that is lost, relative to that of the answer; none above [`MOST_LOSS_ERROR`].
    pub loss: Option<F>,
}

impl ErrorBound {
    /// Of an efficiency and the bound of its error; the load on the screw or on the nut is given,
    /// whichever is not driven.
    pub fn of(direction: Direction, efficiency: f64, bound: f64) -> Self {
        let loss = loss_error(direction == Direction::LinearToRotary, efficiency, bound);
        Self { efficiency: bound, loss: Some(loss).filter(|loss| *loss <= MOST_LOSS_ERROR) }
    }
}

/// Largest relative error of a lost power that is stated: beyond, it may be off by factors.
const MOST_LOSS_ERROR: f64 = 0.5;

/// Bound of the error of an efficiency by integration over the contact ellipses (T25).
///
/// * `difference`: to the efficiency of another quadrature. * `accuracy`: of the one that was taken.
pub(crate) fn quadrature_error(difference: f64, accuracy: f64) -> f64 {
    // δη = max(20 |η'(y') − η(y)|, ε/200, 10⁻⁹)                           (T25)
    let (error, least) = (20.0 * difference.abs(), (accuracy / 200.0).max(1e-9));
    // A difference that is not a number stays one.
    if error < least { least } else { error }
}

/// Bound of the error of the efficiency, with that of the creep speed, from that of the quadrature (A6).
///
/// * `by_creep`: what the creep speed may change of the friction power, relative, from 0 to 1 (A8).
pub(crate) fn integrated_error(by_quadrature: f64, efficiency: f64, by_creep: f64) -> f64 {
    // |δη| ≤ |δη|_rule + |1 − η| |δP_f|/P_f                               (A6)
    by_quadrature + (1.0 - efficiency).abs() * by_creep
}

/// What a creep speed may change of the friction power, relative, at most 1 (A8).
///
/// * `pulls`: `$f Q$` at nut and screw. * `sliding`: the power that it takes.
pub(crate) fn creep_effect(creep: f64, pulls: [f64; 2], sliding: [f64; 2]) -> f64 {
    // |δP_f|/P_f ≤ 4 v_e² Σ (f Q)²/P_f,j / Σ P_f,j                        (A8)
    let slow = pulls[0] * pulls[0] / sliding[0] + pulls[1] * pulls[1] / sliding[1];
    (4.0 * creep * creep * slow / (sliding[0] + sliding[1])).min(1.0)
}

/// Skid number of a ball whose friction is already spent on the slip of the lead, see
/// [`SkidNumbers::onset_number`] (W11).
#[inline(always)]
pub fn onset_number<F: Field>(skid_number: F, cross_slip: F) -> F {
    // S = G √(1 + χ²)                                                     (W11)
    skid_number * (cross_slip.square() + 1.0).sqrt()
}

/// Direction of a friction force on the ball \[rad\] from its parts across the groove and along the helix; see
/// [`bsm_kin::Contact::slip_angle`].
#[inline(always)]
pub fn friction_angle<F: Compare>([across, along]: [F; 2]) -> F {
    along.zip(across, f64::atan2)
}

/// Error of the power that is lost, relative to it; not finite where the error may be all of the efficiency.
///
/// * `back`: true if the load drives.
/// * `bound`: error bound of the efficiency.
fn loss_error(back: bool, efficiency: f64, bound: f64) -> f64 {
    // P_f/P_out = 1/η − 1 of a drive, P_f/P_in = 1 − η of a load that drives:
    // δP_f/P_f = δη/[(η − δη) (1 − η)] or δη/(1 − η)                      (A7)
    let least = if back { 1.0 } else { (efficiency - bound).max(0.0) };
    bound / (least * (1.0 - efficiency).abs())
}

/// The raceway at which the ball does not spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllingRaceway {
    /// The raceway.
    pub raceway: Control,
    /// True if the decision (W7), asked at this solution, names that raceway; none if it was given.
    pub consistent: Option<bool>,
}

/// Other admissible solutions of the same equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternatives {
    /// How many.
    pub count: usize,
    /// Efficiency of the one of them that differs most.
    pub farthest_efficiency: Option<f64>,
}

impl<F: Field> SteadyState<F> {
    /// A ball and what the screw transmits, and nothing else.
    #[inline(always)]
    pub fn new(ball: &BallState<F>, transmission: Transmission<F>) -> Self {
        Self {
            ball: *ball,
            transmission,
            skid: None,
            info: None,
            control: None,
            alternatives: None,
            error: None,
            film: None,
            contact_power: None,
            far_flank: None,
        }
    }
}

impl SteadyState {
    /// The same, with what is known of other solutions.
    pub(crate) fn with_alternatives(self, alternatives: impl Iterator<Item = Self>) -> Self {
        let alternatives: Vec<_> =
            alternatives.map(|other| other.transmission.efficiency).collect();
        let far = |eta: &f64| (eta - self.transmission.efficiency).abs();
        let farthest = alternatives.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied();
        let alternatives =
            Alternatives { count: alternatives.len(), farthest_efficiency: farthest };
        Self { alternatives: Some(alternatives), ..self }
    }
}

impl<F: Copy> BallState<F> {
    /// The contact at a site.
    #[inline(always)]
    pub fn contact(&self, site: Site) -> Option<&ContactState<F>> {
        match site {
            Site::Nut => Some(&self.nut),
            Site::Screw => Some(&self.screw),
            Site::NutUnloaded => self.unloaded.as_ref(),
        }
    }

    /// A ball whose loaded contacts have the same angle \[rad\] and no friction direction yet.
    #[inline(always)]
    pub fn at_angle(angle: F) -> Self {
        let contact = ContactState::at_angle(angle);
        Self {
            motion: None,
            nut: contact,
            screw: contact,
            unloaded: None,
            axial_displacement: None,
            threshold_play: None,
        }
    }
}

impl<F> ContactState<F> {
    /// A contact of which nothing else is known than its angle \[rad\].
    #[inline(always)]
    pub fn at_angle(angle: F) -> Self {
        Self { angle, load: None, slip_angle: None, slip: None, pressed: None }
    }
}

impl<F: Compare> Transmission<F> {
    /// Of a torque on the screw and that of the frictionless screw \[N·m\], at a relative speed
    /// \[rad/s\].
    ///
    /// * `back`: where the load drives.
    #[inline(always)]
    pub fn of(back: F::Mask, ideal: F, torque: F, speed: F) -> Self {
        let efficiency = efficiency(back, ideal, torque);
        Self {
            efficiency,
            self_locking: efficiency.le(efficiency.constant(0.0)),
            screw_torque: Some(torque),
            power: Some(Power::transmitted(torque, ideal, speed)),
            power_balance: None,
        }
    }

    /// The same, with the violation of the power balance by a friction power \[W\].
    #[inline(always)]
    #[must_use]
    pub fn against(self, friction_power: F) -> Self {
        let power_balance = self.power.as_ref().map(
            #[inline(always)]
            |power| power.imbalance(friction_power),
        );
        Self { power_balance, ..self }
    }

    /// Where powers balance to rounding.
    #[inline(always)]
    pub fn is_balanced(&self) -> F::Mask {
        let imbalance = self.power_balance.unwrap_or(self.efficiency.constant(f64::NAN));
        imbalance.abs().le(imbalance.constant(POWER_BALANCE_TOL))
    }
}

impl Transmission {
    /// The same, unless powers do not balance.
    pub(crate) fn balanced(self) -> Result<Self, NoAnswer> {
        if self.is_balanced() {
            return Ok(self);
        }
        let imbalance = self.power_balance.unwrap_or(f64::NAN);
        Err(NoAnswer::not_converged(Reason::PowerDoesNotBalance { imbalance }))
    }
}

/// Below this onset number a ball rolls, whatever its cross slip.
pub const ROLLING_BELOW: f64 = 0.1;

/// Onset number above which friction is nearly saturated.
const GROSS_SKID_ABOVE: f64 = 2.0;

named! {
    /// What a ball does, by its onset number (W11).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum SlipRegime {
        /// It rolls on both raceways.
        Rolling = "rolling",
        /// Between rolling and sliding.
        PartialSkid = "partial skid",
        /// Friction is nearly saturated at both contacts.
        GrossSkid = "gross skid",
    }
}

impl SlipRegime {
    /// The motion at an onset number.
    pub fn of(onset_number: f64) -> Self {
        if onset_number < ROLLING_BELOW {
            Self::Rolling
        } else if onset_number < GROSS_SKID_ABOVE {
            Self::PartialSkid
        } else {
            Self::GrossSkid
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At coarse accuracies two rules agreed by chance, and the stated bound was a thousandth of the error.
    #[test]
    fn a_bound_does_not_rest_on_two_rules_that_agree() {
        for (difference, accuracy, bound) in
            [(0.0, 1e-4, 5e-7), (0.0, 1e-8, 1e-9), (-1e-6, 1e-4, 2e-5), (1e-12, 1e-12, 1e-9)]
        {
            let stated: f64 = quadrature_error(difference, accuracy);
            assert!((stated - bound).abs() <= 1e-12 * bound, "{difference} {accuracy}: {stated}");
        }
    }

    /// A loss bound near 1 was printed beside a loss that was 32 times the true one.
    #[test]
    fn a_loss_that_may_be_off_by_factors_has_no_bound() {
        let loss = |bound| ErrorBound::of(Direction::RotaryToLinear, 0.9, bound).loss;
        // δη/[(η − δη) (1 − η)] is 1/2 at δη = 0.045/1.05.
        assert!(loss(0.042).is_some_and(|loss| loss < 0.5), "{:?}", loss(0.042));
        assert_eq!(loss(0.043), None);
    }
}
