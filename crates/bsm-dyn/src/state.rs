//! The answer of a model: the state of the ball, what the screw transmits, and how it was found.
//!
//! SI units and radians. Loads are per ball, torque and powers of all loaded balls together.

use bsm_kin::{BallFrame, Contact, Motion, Site};
use nalgebra::Vector3;

use crate::balance::{Power, efficiency};
use crate::{Direction, SlipRegime};

/// The contacts of a ball, in the order of [`BallState::contacts`].
pub const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutMinor];

/// What a model says of the steady ball.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BallState {
    /// Absolute motion in the Frenet-Serret triad `(t, n, b)` \[rad/s\]; none where the model fixes
    /// no motion.
    pub motion: Option<Motion<f64>>,
    /// Contacts with the nut, with the screw, and with the opposite flank of the nut, see [`SITES`].
    pub contacts: [Option<ContactState>; 3],
    /// Displacement of the nut in the normal plane \[m\], of elastic contacts.
    pub axial_displacement: Option<f64>,
}

/// One contact of the steady ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Contact angle \[rad\].
    pub angle: f64,
    /// Normal load \[N\]; none where the load on the screw is not given.
    pub load: Option<f64>,
    /// Direction of friction on the ball \[rad\].
    pub slip_angle: Option<f64>,
    /// Slip at the contact centre and spin, of models with a motion.
    pub slip: Option<Slip>,
    /// The pressed surface, of elastic contacts.
    pub pressed: Option<Pressed>,
}

/// Velocities of the ball against the body at a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// Slip speed at the contact centre \[m/s\].
    pub speed: f64,
    /// Spin about the contact normal \[rad/s\].
    pub spin: f64,
}

/// A Hertz contact under load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    /// Semi-axes of the ellipse across and along the groove \[m\].
    pub semi_axes: (f64, f64),
    /// Largest pressure \[Pa\].
    pub max_pressure: f64,
    /// Elastic approach \[m\].
    pub approach: f64,
}

/// What the screw makes of the power put in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// Power out over power in; negative: self-locking.
    pub efficiency: f64,
    /// True if friction holds the screw in this direction.
    pub self_locking: bool,
    /// Torque on the screw that holds the steady state \[N·m\].
    pub screw_torque: Option<f64>,
    /// Powers \[W\], where the speed is given.
    pub power: Option<Power>,
    /// Relative violation of the power balance (B10), of models with a balance of forces.
    pub power_balance: Option<f64>,
}

/// Where a ball is between gripping and skidding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkidNumbers {
    skid_number: f64,
    cross_slip: f64,
}

impl SkidNumbers {
    pub(crate) fn new(skid_number: f64, cross_slip: f64) -> Self {
        Self { skid_number, cross_slip }
    }

    /// Gyroscopic over friction moment of the gripping motion (W9); none without friction.
    pub fn skid_number(&self) -> Option<f64> {
        finite(self.skid_number)
    }

    /// The slip across the grooves that the lead forces, over the slip of spin (W10); none without
    /// spin.
    pub fn cross_slip(&self) -> Option<f64> {
        finite(self.cross_slip)
    }

    /// Skid number of a ball whose friction is already spent on the slip of the lead (W11): below
    /// 0.1 the ball grips, above 2 friction is nearly saturated.
    pub fn onset_number(&self) -> Option<f64> {
        // S = G √(1 + χ²)                                                 (W11)
        finite(self.skid_number * self.cross_slip.hypot(1.0))
    }

    /// What the ball does.
    pub fn regime(&self) -> Option<SlipRegime> {
        self.onset_number().map(SlipRegime::of)
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// How a root was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveInfo {
    /// Newton steps.
    pub steps: usize,
    /// Scaled residual.
    pub residual: f64,
}

/// The answer of a model that has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// The ball.
    pub ball: BallState,
    /// Torque and powers.
    pub transmission: Transmission,
    /// Between gripping and skidding, of models that tell.
    pub skid: Option<SkidNumbers>,
    /// How it was found, unless in closed form.
    pub info: Option<SolveInfo>,
}

impl BallState {
    /// The contact at a site.
    pub fn contact(&self, site: Site) -> Option<&ContactState> {
        let place = SITES.iter().position(|s| *s == site)?;
        self.contacts[place].as_ref()
    }

    /// A ball whose loaded contacts have the same angle \[rad\] and no friction direction yet.
    pub(crate) fn at_angle(angle: f64) -> Self {
        let contact =
            ContactState { angle, load: None, slip_angle: None, slip: None, pressed: None };
        Self { contacts: [Some(contact), Some(contact), None], ..Self::default() }
    }
}

impl ContactState {
    /// Of a contact and its slip.
    ///
    /// * `motion`: relative to the body of the contact, of speeds over `unit` \[rad/s\].
    /// * `slip`: velocity at the contact centre \[m/s\].
    pub(crate) fn sliding(
        (angle, load): (f64, f64),
        contact: &Contact<f64>,
        motion: &Motion<f64>,
        slip: &Vector3<f64>,
        unit: f64,
    ) -> Self {
        Self {
            angle,
            load: Some(load),
            slip_angle: Some(contact.slip_angle(slip)),
            slip: Some(Slip { speed: slip.norm(), spin: motion.spin(contact) * unit }),
            pressed: None,
        }
    }
}

/// Motion in the Frenet-Serret triad, of one in the triad of `frame` with speeds over `unit`
/// \[rad/s\].
pub(crate) fn in_frenet(motion: &Motion<f64>, frame: &BallFrame<f64>, unit: f64) -> Motion<f64> {
    let omega = frame.to_frenet(&motion.omega) * unit;
    Motion { precession: motion.precession * unit, omega }
}

impl Transmission {
    /// Of a torque on the screw and that of the frictionless screw \[N·m\], at a relative speed
    /// \[rad/s\].
    pub(crate) fn of(direction: Direction, ideal: f64, torque: f64, speed: f64) -> Self {
        let efficiency = efficiency(direction, ideal, torque);
        Self {
            efficiency,
            self_locking: efficiency <= 0.0,
            screw_torque: Some(torque),
            power: Some(Power::transmitted(torque, ideal, speed)),
            power_balance: None,
        }
    }

    /// The same, with the violation of the power balance by a friction power \[W\].
    pub(crate) fn against(self, friction_power: f64) -> Self {
        let power_balance = self.power.map(|power| power.imbalance(friction_power));
        Self { power_balance, ..self }
    }
}
