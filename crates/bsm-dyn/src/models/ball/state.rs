//! Result of a model: state of the ball, torque and powers of the screw, and information about the
//! solve.
//!
//! All quantities are in SI units and radians. Loads are per ball; torque and powers are for all
//! loaded balls.

use bsm_kin::{Motion, Real, Site};

use crate::contact::{FilmState, POWER_BALANCE_TOL, Power, efficiency};
use crate::outcome::{Control, Direction, Reason, SolveFailure, named};

/// State of the ball in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallState<F = f64> {
    /// Absolute motion in the Frenet-Serret triad `(t, n, b)` \[rad/s\]; `None` if the model does
    /// not determine the motion.
    pub motion: Option<Motion<F>>,
    /// Contact with the loaded flank of the nut.
    pub nut: ContactState<F>,
    /// Contact with the loaded flank of the screw.
    pub screw: ContactState<F>,
    /// Contact with the unloaded flank of the nut; `None` if the model does not include this
    /// contact.
    pub unloaded: Option<ContactState<F>>,
    /// Displacement of the nut along the screw axis \[m\] (J15); `None` for rigid contacts.
    pub axial_displacement: Option<F>,
    /// Axial play of one nut \[m\] below which friction presses the ball against a far flank (AC7).
    /// The value is zero if friction does not press the ball against a far flank even without play,
    /// and `None` if the force balance of the model does not include friction across the grooves.
    pub threshold_play: Option<F>,
}

/// One contact of a ball in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState<F = f64> {
    /// Contact angle \[rad\].
    pub angle: F,
    /// Normal load \[N\]; `None` if the axial load is not given.
    pub load: Option<F>,
    /// Direction of the friction force on the ball at this contact \[rad\].
    pub slip_angle: Option<F>,
    /// Slip at the contact center, and spin; `None` if the model does not determine the motion.
    pub slip: Option<Slip<F>>,
    /// Contact ellipse; `None` for rigid contacts.
    pub pressed: Option<HertzContact<F>>,
}

/// State of the far flanks (opposite to the loaded flanks) of gothic arches with a given axial
/// play.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarFlank<F = f64> {
    /// Gap between the ball and the nearer far flank \[m\]; negative if the ball presses against
    /// this flank.
    pub gap: F,
    /// Contact with the more heavily loaded far flank; `None` if the ball touches no far flank.
    pub contact: Option<ThirdContact<F>>,
    /// Friction power of all balls \[W\] that would result if each ball had only two contacts;
    /// `None` if a ball with two contacts has no steady motion.
    pub two_contact_power: Option<F>,
}

/// Contact with a far flank, which is the third contact of the ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThirdContact<F = f64> {
    /// Body that the ball touches at this contact: [`Site::Nut`] or [`Site::Screw`].
    pub site: Site,
    /// Normal load \[N\].
    pub load: F,
    /// Slip speed at the contact center \[m/s\].
    pub slip: F,
    /// Ratio of the friction power at this contact to the total friction power of the ball.
    pub power_share: F,
}

/// Slip and spin of the ball at a contact, relative to the nut or the screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip<F = f64> {
    /// Slip speed at the contact center \[m/s\].
    pub speed: F,
    /// Spin about the contact normal \[rad/s\].
    pub spin: F,
}

/// Ellipse, pressure and deformation of a Hertz contact under load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzContact<F = f64> {
    /// Semi-axes of the ellipse across and along the groove \[m\].
    pub semi_axes: (F, F),
    /// Maximum pressure \[Pa\].
    pub max_pressure: F,
    /// Elastic approach \[m\].
    pub approach: F,
}

/// Efficiency, torque and power balance of the screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission<F: Real = f64> {
    /// Ratio of output power to input power; zero or negative if the screw is self-locking.
    pub efficiency: F,
    /// True if friction prevents motion in the given direction of the power flow.
    pub self_locking: F::Mask,
    /// Torque on the screw in steady motion \[N·m\]; `None` if the axial load is not given.
    pub screw_torque: Option<F>,
    /// Input, output and dissipated powers \[W\]; `None` if the speed is not given.
    pub power: Option<Power<F>>,
    /// Relative error of the power balance (B10); `None` if the model does not calculate the
    /// friction power separately.
    pub power_balance: Option<F>,
}

/// Dimensionless numbers that distinguish rolling balls from skidding balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkidNumbers<F = f64> {
    /// Ratio of gyroscopic moment to friction moment of the rolling ball (W9); `None` without
    /// friction.
    pub skid_number: Option<F>,
    /// Slip across the grooves due to the lead, divided by the slip due to spin (W10); `None`
    /// without spin.
    pub cross_slip: Option<F>,
}

impl SkidNumbers {
    /// Creates the skid numbers. A number that is not finite becomes `None`.
    pub(crate) fn new(skid_number: f64, cross_slip: f64) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        Self { skid_number: finite(skid_number), cross_slip: finite(cross_slip) }
    }

    /// Returns the slip regime of the ball; `None` if a skid number is undefined.
    pub fn regime(&self) -> Option<SlipRegime> {
        self.onset_number().map(SlipRegime::of)
    }
}

impl<F: Real> SkidNumbers<F> {
    /// Returns the onset number (W11), which is the skid number of a ball whose friction also has
    /// to oppose the slip due to the lead.
    ///
    /// Balls roll if the onset number is below [`MAX_ROLLING_ONSET`]. If the onset number is above
    /// 2, friction is nearly saturated.
    #[inline(always)]
    pub fn onset_number(&self) -> Option<F> {
        Some(onset_number(self.skid_number?, self.cross_slip?))
    }
}

/// Cost and accuracy of an iterative solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveInfo {
    /// Number of Newton steps.
    pub steps: usize,
    /// Largest scaled residual of the equations.
    pub residual: f64,
}

/// Steady state of the screw, calculated by one model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyState<F: Real = f64> {
    /// State of the ball.
    pub ball: BallState<F>,
    /// Efficiency, torque and powers.
    pub transmission: Transmission<F>,
    /// Skid numbers; `None` if the model does not calculate them.
    pub skid: Option<SkidNumbers<F>>,
    /// Cost and accuracy of the solve; `None` for closed forms.
    pub info: Option<SolveInfo>,
    /// Controlling raceway; `None` except for the model `raceway-control`.
    pub control: Option<ControllingRaceway>,
    /// Other admissible solutions; `None` if the model did not search for them.
    pub alternatives: Option<Alternatives>,
    /// Error bounds of the efficiency and the power loss. For the model `traction`, these bounds
    /// limit the quadrature error; for the model `auto`, they limit the difference from `traction`.
    pub error: Option<ErrorBound<F>>,
    /// Oil films of a lubricated ball; `None` for a constant friction coefficient.
    pub film: Option<FilmState<F>>,
    /// Friction powers of all balls at the nut and the screw \[W\]; available only for raceway
    /// control, lubricated balls, and balls that touch a far flank.
    pub contact_power: Option<[F; 2]>,
    /// State of the far flanks; `None` if no axial play is given.
    pub far_flank: Option<FarFlank<F>>,
}

/// Error bounds of the efficiency and of the power loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound<F = f64> {
    /// Absolute error bound of the efficiency.
    pub efficiency: F,
    /// Relative error bound of the power loss; `None` if it exceeds 0.5.
    pub loss: Option<F>,
}

impl ErrorBound {
    /// Calculates the error bound of the power loss from an efficiency and its error bound. The
    /// result is valid only if the axial load is given rather than the torque.
    pub fn of(direction: Direction, efficiency: f64, bound: f64) -> Self {
        let loss = loss_error(direction == Direction::LinearToRotary, efficiency, bound);
        Self { efficiency: bound, loss: Some(loss).filter(|loss| *loss <= MAX_LOSS_ERROR) }
    }
}

/// Largest relative error bound of the power loss that is reported. With a larger bound, the true
/// loss could differ from the calculated loss by a large factor.
const MAX_LOSS_ERROR: f64 = 0.5;

/// Returns the error bound of an efficiency that was calculated by integrating friction over the
/// contact ellipses (T25).
///
/// * `difference`: difference between the efficiencies of two quadrature rules.
/// * `accuracy`: accuracy of the quadrature rule for the reported efficiency.
pub(crate) fn quadrature_error(difference: f64, accuracy: f64) -> f64 {
    // δη = max(20 |η'(y') − η(y)|, ε/200, 10⁻⁹)                           (T25)
    let (error, least) = (20.0 * difference.abs(), (accuracy / 200.0).max(1e-9));
    // If the difference is NaN, this comparison is false and the result is NaN.
    if error < least { least } else { error }
}

/// Returns the error bound of an efficiency, due to both the quadrature and the creep speed (A6).
///
/// * `by_quadrature`: error bound due to the quadrature.
/// * `by_creep`: relative effect of the creep speed on the friction power, from 0 to 1 (A8).
pub(crate) fn integrated_error(by_quadrature: f64, efficiency: f64, by_creep: f64) -> f64 {
    // |δη| ≤ |δη|_rule + |1 − η| |δP_f|/P_f                               (A6)
    by_quadrature + (1.0 - efficiency).abs() * by_creep
}

/// Returns the relative effect of the creep speed on the friction power, limited to 1 (A8).
///
/// * `friction_forces`: friction forces `$f Q$` at the nut and the screw.
/// * `sliding`: friction powers at the nut and the screw.
pub(crate) fn creep_effect(creep: f64, friction_forces: [f64; 2], sliding: [f64; 2]) -> f64 {
    // |δP_f|/P_f ≤ 4 v_e² Σ (f Q)²/P_f,j / Σ P_f,j                        (A8)
    let [nut, screw] = friction_forces;
    let slow = nut * nut / sliding[0] + screw * screw / sliding[1];
    (4.0 * creep * creep * slow / (sliding[0] + sliding[1])).min(1.0)
}

/// Returns the onset number (W11); see [`SkidNumbers::onset_number`].
#[inline(always)]
pub fn onset_number<F: Real>(skid_number: F, cross_slip: F) -> F {
    // S = G √(1 + χ²)                                                     (W11)
    skid_number * (cross_slip.square() + 1.0).sqrt()
}

/// Returns the direction of a friction force on the ball \[rad\] from its components across the
/// groove and along the helix; see [`bsm_kin::Contact::slip_angle`].
#[inline(always)]
pub fn friction_angle<F: Real>([across, along]: [F; 2]) -> F {
    along.atan2(across)
}

/// Returns the relative error bound of the power loss (A7). The result is not finite if the error
/// bound of the efficiency exceeds the efficiency itself.
///
/// * `back`: true if the load back-drives the screw.
/// * `bound`: error bound of the efficiency.
fn loss_error(back: bool, efficiency: f64, bound: f64) -> f64 {
    // P_f/P_out = 1/η − 1 for driving, P_f/P_in = 1 − η for back-driving:
    // δP_f/P_f = δη/[(η − δη) (1 − η)] or δη/(1 − η)                      (A7)
    let least = if back { 1.0 } else { (efficiency - bound).max(0.0) };
    bound / (least * (1.0 - efficiency).abs())
}

/// The raceway on which the ball does not spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllingRaceway {
    /// The controlling raceway.
    pub raceway: Control,
    /// True if criterion (W7), evaluated for this solution, confirms the controlling raceway;
    /// `None` if the raceway was specified.
    pub consistent: Option<bool>,
}

/// Other admissible solutions of the same model equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternatives {
    /// Number of other admissible solutions.
    pub count: usize,
    /// Efficiency of the alternative solution whose efficiency differs most from the efficiency of
    /// this solution; `None` if there is no alternative solution.
    pub farthest_efficiency: Option<f64>,
}

impl<F: Real> SteadyState<F> {
    /// Creates a steady state that contains only the state of the ball and the transmission.
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
    /// Adds information about other solutions of the same equations: the number of these solutions,
    /// and the efficiency that differs most from the efficiency of this solution.
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
    /// Returns the contact at the given flank; `None` if the model does not include this contact.
    #[inline(always)]
    pub fn contact(&self, site: Site) -> Option<&ContactState<F>> {
        match site {
            Site::Nut => Some(&self.nut),
            Site::Screw => Some(&self.screw),
            Site::NutUnloaded => self.unloaded.as_ref(),
        }
    }

    /// Creates the state of a ball of which only the contact angle \[rad\] is known. Both loaded
    /// contacts have this contact angle.
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
    /// Creates a contact of which only the contact angle \[rad\] is known.
    #[inline(always)]
    pub fn at_angle(angle: F) -> Self {
        Self { angle, load: None, slip_angle: None, slip: None, pressed: None }
    }
}

impl<F: Real> Transmission<F> {
    /// Calculates the efficiency and the powers from the torque on the screw.
    ///
    /// * `back`: true if the load back-drives the screw.
    /// * `ideal`: torque of the frictionless screw \[N·m\].
    /// * `torque`: torque on the screw \[N·m\].
    /// * `speed`: relative speed \[rad/s\].
    #[inline(always)]
    pub fn of(back: F::Mask, ideal: F, torque: F, speed: F) -> Self {
        let efficiency = efficiency(back, ideal, torque);
        Self {
            efficiency,
            self_locking: efficiency.at_most(0.0),
            screw_torque: Some(torque),
            power: Some(Power::transmitted(torque, ideal, speed)),
            power_balance: None,
        }
    }

    /// Adds the relative error of the power balance, calculated from a friction power \[W\].
    #[inline(always)]
    #[must_use]
    pub fn with_power_balance(self, friction_power: F) -> Self {
        let power_balance = self.power.as_ref().map(
            #[inline(always)]
            |power| power.imbalance(friction_power),
        );
        Self { power_balance, ..self }
    }

    /// Returns true if the error of the power balance is at most the tolerance, and false if this
    /// error is unknown.
    #[inline(always)]
    pub fn is_balanced(&self) -> F::Mask {
        let imbalance = self.power_balance.unwrap_or(self.efficiency.constant(f64::NAN));
        imbalance.abs().at_most(POWER_BALANCE_TOL)
    }
}

impl Transmission {
    /// Returns the transmission after checking its power balance.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::PowerDoesNotBalance`] if the error of the power balance exceeds the
    /// tolerance.
    pub(crate) fn balanced(self) -> Result<Self, SolveFailure> {
        if self.is_balanced() {
            return Ok(self);
        }
        let imbalance = self.power_balance.unwrap_or(f64::NAN);
        Err(SolveFailure::not_converged(Reason::PowerDoesNotBalance { imbalance }))
    }
}

/// Largest onset number (dimensionless, W11) at which a ball rolls, for any cross slip.
pub const MAX_ROLLING_ONSET: f64 = 0.1;

/// Smallest onset number (dimensionless, W11) at which the friction of a ball is nearly saturated.
const MIN_SKIDDING_ONSET: f64 = 2.0;

named! {
    /// Slip regime of a ball, determined by its onset number (W11).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum SlipRegime {
        /// The ball rolls on both raceways.
        Rolling = "rolling",
        /// The ball is in a state between rolling and gross skid.
        PartialSkid = "partial skid",
        /// Friction is nearly saturated at both contacts.
        GrossSkid = "gross skid",
    }
}

impl SlipRegime {
    /// Returns the slip regime for an onset number.
    pub fn of(onset_number: f64) -> Self {
        if onset_number < MAX_ROLLING_ONSET {
            Self::Rolling
        } else if onset_number < MIN_SKIDDING_ONSET {
            Self::PartialSkid
        } else {
            Self::GrossSkid
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In an earlier version, the results of two coarse quadrature rules agreed by chance, and the
    /// calculated error bound was a thousandth of the true error.
    #[test]
    fn error_bound_is_positive_even_if_two_quadrature_rules_agree() {
        for (difference, accuracy, bound) in
            [(0.0, 1e-4, 5e-7), (0.0, 1e-8, 1e-9), (-1e-6, 1e-4, 2e-5), (1e-12, 1e-12, 1e-9)]
        {
            let stated: f64 = quadrature_error(difference, accuracy);
            assert!((stated - bound).abs() <= 1e-12 * bound, "{difference} {accuracy}: {stated}");
        }
    }

    /// An earlier version printed an error bound near 1 for a power loss that was 32 times the true
    /// power loss.
    #[test]
    fn loss_bound_above_one_half_is_not_reported() {
        let loss = |bound| ErrorBound::of(Direction::RotaryToLinear, 0.9, bound).loss;
        // The bound δη/[(η − δη) (1 − η)] is 1/2 at δη = 0.045/1.05.
        assert!(loss(0.042).is_some_and(|loss| loss < 0.5), "{:?}", loss(0.042));
        assert_eq!(loss(0.043), None);
    }
}
