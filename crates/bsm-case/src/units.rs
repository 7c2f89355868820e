//! Factors from the units of the vocabulary to SI.

use std::f64::consts::PI;

/// Metres per millimetre.
pub const MM: f64 = 1e-3;
/// Metres per micrometre.
pub const UM: f64 = 1e-6;
/// Pascal seconds per millipascal second.
pub const MILLI: f64 = 1e-3;
/// Square metres per square millimetre.
pub const MM2: f64 = 1e-6;
/// Radians per degree.
pub const DEG: f64 = PI / 180.0;
/// Radians per second per revolution per minute.
pub const RPM: f64 = PI / 30.0;
/// Pascals per gigapascal.
pub const GPA: f64 = 1e9;
/// Pascals per megapascal.
pub const MPA: f64 = 1e6;

/// Next to -180 deg a direction is 180: rounding decides on which side of it a solve ends \[deg\].
const TURN_ROUNDING: f64 = 1e-9;

/// An angle \[rad\] as a direction in (-180, 180\] deg.
pub fn direction_deg(angle: f64) -> f64 {
    let degrees = angle / DEG;
    if degrees + 180.0 < TURN_ROUNDING { 180.0 } else { degrees }
}
