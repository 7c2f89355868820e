//! Factors from the units of the vocabulary to SI.

use std::f64::consts::PI;

/// Metres per millimetre.
pub const MM: f64 = 1e-3;
/// Metres per micrometre.
pub const UM: f64 = 1e-6;
/// Radians per degree.
pub const DEG: f64 = PI / 180.0;
/// Radians per second per revolution per minute.
pub const RPM: f64 = PI / 30.0;
/// Pascals per gigapascal.
pub const GPA: f64 = 1e9;
/// Pascals per megapascal.
pub const MPA: f64 = 1e6;
