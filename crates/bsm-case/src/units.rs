//! Factors from the units of the vocabulary to SI.

use std::f64::consts::PI;

/// Metres per millimetre.
pub(crate) const MM: f64 = 1e-3;
/// Metres per micrometre.
pub(crate) const UM: f64 = 1e-6;
/// Radians per degree.
pub(crate) const DEG: f64 = PI / 180.0;
/// Radians per second per revolution per minute.
pub(crate) const RPM: f64 = PI / 30.0;
/// Pascals per gigapascal.
pub(crate) const GPA: f64 = 1e9;
/// Pascals per megapascal.
pub(crate) const MPA: f64 = 1e6;
