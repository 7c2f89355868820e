//! Rules that relate the values of several inputs. A rule is evaluated for one point, or for
//! several points in SIMD lanes.
//! For a rule that applies to a single value, see [`Rule`](crate::Rule).

use bsm_design::turn_length;
use bsm_dyn::Model;
use bsm_kin::Real;
use bsm_simd::{Lane, Simd};

use super::input_set::{inputs, lead_angle, lead_mm};
use crate::vocabulary::units::{DEG, RPM};
use crate::{Case, CaseError, InputKey, InputSet};

/// A number at one point, or the numbers at several points in SIMD lanes. A function of ordinary
/// numbers can be applied at every point.
pub trait Pointwise: Real {
    /// Applies a function to the numbers of each point in `self` and `other`.
    #[must_use]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
}

impl Pointwise for f64 {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f(self, other)
    }
}

impl<S: Simd, const N: usize> Pointwise for Lane<S, N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        self.zip(other, f)
    }
}

/// Inputs of one point, or of several points in SIMD lanes.
pub trait Inputs {
    /// Type of the value of an input: a single number, or one number per SIMD lane.
    type Number: Pointwise;

    /// Returns the given or default value of an input.
    fn value(&self, key: InputKey) -> Option<Self::Number>;
}

/// Mask with one flag for each point.
type Mask<I> = <<I as Inputs>::Number as Real>::Mask;

impl Inputs for Case {
    type Number = f64;

    fn value(&self, key: InputKey) -> Option<f64> {
        self.value_or_default(key)
    }
}

/// A rule that relates several inputs and does not depend on the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// The balls fit on the pitch circle.
    BallsFit,
    /// The given number of balls per turn fits into one turn.
    TurnHolds,
    /// Lead and lead angle describe the same helix.
    LeadsAgree,
    /// Screw and nut do not turn at the same speed.
    SpeedsDiffer,
    /// The viscosity at 100 °C is less than the viscosity at 40 °C.
    OilThins,
}

/// Permitted relative rounding error of the number of balls that fill a turn.
const ROUNDED: f64 = 1e-9;

/// Permitted relative difference between the given lead and the lead that follows from the lead
/// angle.
const LEADS_AGREE: f64 = 1e-9;

impl Relation {
    /// All rules that relate several inputs.
    pub const ALL: [Self; 5] =
        [Self::BallsFit, Self::TurnHolds, Self::LeadsAgree, Self::SpeedsDiffer, Self::OilThins];

    /// Returns the inputs to which the rule applies.
    pub fn inputs(self) -> InputSet {
        match self {
            Self::BallsFit => inputs! { ball_diameter_mm pitch_circle_diameter_mm },
            Self::TurnHolds => inputs! {
                ball_diameter_mm pitch_circle_diameter_mm loaded_balls_per_turn lead_mm lead_angle_deg
            },
            Self::LeadsAgree => inputs! { lead_angle_deg lead_mm pitch_circle_diameter_mm },
            Self::SpeedsDiffer => inputs! { screw_speed_rpm nut_speed_rpm },
            Self::OilThins => inputs! { viscosity_40C_mm2_s viscosity_100C_mm2_s },
        }
    }

    /// Returns a mask that is true for the points that satisfy the rule, or `None` if inputs are
    /// missing.
    #[inline(always)]
    pub fn holds<I: Inputs>(self, inputs: &I) -> Option<Mask<I>> {
        Some(match self {
            Self::BallsFit => {
                let ball = inputs.value(InputKey::ball_diameter_mm)?;
                ball.lt(inputs.value(InputKey::pitch_circle_diameter_mm)? * 0.5)
            }
            Self::TurnHolds => {
                let balls = inputs.value(InputKey::loaded_balls_per_turn)?;
                let length = balls * inputs.value(InputKey::ball_diameter_mm)?;
                let pitch = inputs.value(InputKey::pitch_circle_diameter_mm)?;
                let by_angle = || {
                    let angle = inputs.value(InputKey::lead_angle_deg)?;
                    Some(angle.zip(pitch, |angle, pitch| lead_mm(angle * DEG, pitch)))
                };
                let lead = inputs.value(InputKey::lead_mm).or_else(by_angle)?;
                let turn = lead.zip(pitch, |lead, pitch| turn_length(pitch, lead));
                length.le(turn * (1.0 + ROUNDED))
            }
            Self::LeadsAgree => {
                let angle = inputs.value(InputKey::lead_angle_deg)?;
                let lead = inputs.value(InputKey::lead_mm)?;
                let pitch = inputs.value(InputKey::pitch_circle_diameter_mm)?;
                let implied = lead.zip(pitch, |lead, pitch| lead_angle(lead, pitch) / DEG);
                (implied - angle).abs().le(angle * LEADS_AGREE)
            }
            Self::SpeedsDiffer => {
                let screw = inputs.value(InputKey::screw_speed_rpm)?;
                let nut = inputs.value(InputKey::nut_speed_rpm)?;
                ((screw - nut) * RPM).abs().above(0.0)
            }
            Self::OilThins => inputs
                .value(InputKey::viscosity_100C_mm2_s)?
                .lt(inputs.value(InputKey::viscosity_40C_mm2_s)?),
        })
    }

    /// Returns the error for a case that violates the rule.
    pub(crate) fn broken(self, case: &Case) -> CaseError {
        let pitch = case.number(InputKey::pitch_circle_diameter_mm);
        match self {
            Self::BallsFit => CaseError::Invalid(format!(
                "ball_diameter_mm = {} must be smaller than the radius of the pitch circle, \
                 pitch_circle_diameter_mm / 2 = {}",
                case.number(InputKey::ball_diameter_mm),
                0.5 * pitch
            )),
            Self::TurnHolds => {
                let lead = case.lead().unwrap_or(f64::NAN);
                let most = turn_length(pitch, lead) / case.number(InputKey::ball_diameter_mm);
                CaseError::out_of_range(
                    InputKey::loaded_balls_per_turn.name(),
                    case.number(InputKey::loaded_balls_per_turn),
                    format!("<= {most:.3}, the number of balls that fill a turn"),
                )
            }
            Self::LeadsAgree => {
                let lead_mm = case.number(InputKey::lead_mm);
                CaseError::Invalid(format!(
                    "lead_angle_deg = {} and lead_mm = {lead_mm} disagree: on this pitch circle \
                     a lead of {lead_mm} mm is an angle of {} deg; give one of the two",
                    case.number(InputKey::lead_angle_deg),
                    lead_angle(lead_mm, pitch) / DEG
                ))
            }
            Self::SpeedsDiffer => CaseError::Invalid(format!(
                "screw_speed_rpm = {} and nut_speed_rpm = {} are equal: their difference must not be 0",
                case.number(InputKey::screw_speed_rpm),
                case.number(InputKey::nut_speed_rpm)
            )),
            Self::OilThins => CaseError::Invalid(format!(
                "viscosity_100C_mm2_s = {} must be below viscosity_40C_mm2_s = {}: viscosity decreases with temperature",
                case.number(InputKey::viscosity_100C_mm2_s),
                case.number(InputKey::viscosity_40C_mm2_s)
            )),
        }
    }
}

/// Returns a mask that is true for the points whose inputs are within the range of the model, or
/// `None` if the model covers all values.
#[inline(always)]
pub fn covered<I: Inputs>(model: Model, inputs: &I) -> Option<Mask<I>> {
    match model {
        Model::ClosedForm | Model::RacewayControl => None,
        Model::QuasiStatic => {
            let screw = inputs.value(InputKey::screw_speed_rpm)?;
            let nut = inputs.value(InputKey::nut_speed_rpm)?;
            Some(screw.abs().at_most(0.0) | nut.abs().at_most(0.0))
        }
        Model::Rigid | Model::Elastic | Model::Traction => {
            let friction = inputs.value(InputKey::friction_coefficient)?;
            Some(friction.above(0.0))
        }
    }
}

/// Returns the error for a case that is outside the range of a model.
pub(crate) fn not_covered(model: Model, case: &Case) -> CaseError {
    let (key, rule) = match model {
        Model::QuasiStatic => (InputKey::nut_speed_rpm, "0 while the screw turns (no dual drive)"),
        _ => (
            InputKey::friction_coefficient,
            "> 0 (without friction, the rotation of the ball is not determined)",
        ),
    };
    CaseError::not_covered(key, case.number(key), rule, model)
}
