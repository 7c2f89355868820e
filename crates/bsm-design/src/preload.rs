//! Amount of preload, which is specified as a force, derived from the load, or given by a
//! manufacturer's preload class.

use crate::life::UNLOADING_RATIO;

/// Amount of preload that a case requests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PreloadSize {
    /// Preload force \[N\].
    Force(f64),
    /// Smallest preload at which neither nut of a pair is unloaded by the largest load.
    Auto,
    /// Preload as a fraction of the dynamic load rating.
    Share(f64),
}

/// Method by which a nut is preloaded, which limits the preload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PreloadMethod {
    /// Two nuts clamped against each other.
    DoubleNut,
    /// Single nut with a lead offset between its two halves.
    Offset,
    /// Single nut with oversize balls that press against both flanks.
    Oversize,
}

impl PreloadMethod {
    /// Returns the maximum preload as a fraction of the dynamic load rating, `$q$` (AA6).
    ///
    /// Source: THK, A-687; HIWIN BS-08-2, 3.6.1 and 3.6.2.
    pub fn share(self) -> f64 {
        match self {
            Self::DoubleNut => 0.10,
            Self::Offset | Self::Oversize => 0.05,
        }
    }
}

impl PreloadSize {
    /// Returns the preload force \[N\].
    ///
    /// * `load`: largest load of the duty cycle \[N\].
    /// * `rating`: dynamic load rating \[N\].
    pub fn force(self, load: f64, rating: f64) -> f64 {
        match self {
            Self::Force(force) => force,
            Self::Auto => rounded_up(least_preload(load)),
            Self::Share(share) => share * rating,
        }
    }
}

/// Returns the smallest preload of a nut pair \[N\] at which neither nut is unloaded by a given
/// load (AA6).
///
/// ```math
/// F_{max}/2^{3/2} \le F_{pr} \le q\,C_a
/// ```
/// Source: (D14). THK, A-687, uses one third of the load instead.
pub fn least_preload(load: f64) -> f64 {
    // F_pr ≥ F_max/2^(3/2)                                                (AA6)
    load / UNLOADING_RATIO
}

/// Rounds a force up to a multiple of 50 N if it is below 5 kN, and otherwise to a multiple of 100
/// N.
fn rounded_up(force: f64) -> f64 {
    let step = if force < 5e3 { 50.0 } else { 100.0 };
    // The subtracted 1e-9 prevents rounding errors from raising an exact multiple of the step to
    // the next multiple.
    (force / step - 1e-9).ceil() * step
}

/// Meaning of a manufacturer's preload class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PreloadClass {
    /// The preload class specifies a preload.
    Preload(PreloadSize),
    /// The class specifies no preload. The value is the largest axial play \[m\], if the
    /// manufacturer states it.
    Play(Option<f64>),
}

/// Preload classes of manufacturers. The fractions of the dynamic load rating are typical values,
/// and the values of axial play come from THK, table 10.
pub const PRELOAD_CLASSES: [(&str, PreloadClass); 16] = {
    use PreloadClass::{Play, Preload as Of};
    use PreloadSize::{Auto, Share};
    [
        ("auto", Of(Auto)),
        ("Z", Of(Share(0.01))),
        ("G0", Of(Share(0.01))),
        ("GT", Play(Some(5e-6))),
        ("G1", Play(Some(10e-6))),
        ("G2", Play(Some(20e-6))),
        ("G3", Play(Some(50e-6))),
        ("P0", Play(None)),
        ("P1", Play(Some(0.0))),
        ("P2", Of(Share(0.03))),
        ("P3", Of(Share(0.05))),
        ("P4", Of(Share(0.08))),
        ("Z0", Play(Some(0.0))),
        ("Z1", Of(Share(0.03))),
        ("Z2", Of(Share(0.05))),
        ("Z3", Of(Share(0.08))),
    ]
};

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Hand calculation for a feed axis with a largest load of 7000 N. The preload must be at least
    /// 2474.9 N, which is rounded up to 2500 N. For a double nut with a rating of 52.7 kN, the
    /// preload may be at most 5270 N.
    #[test]
    fn auto_preload_is_rounded_up_to_catalog_steps() {
        assert_relative_eq!(least_preload(7e3), 2474.9, max_relative = 2e-5);
        assert_relative_eq!(PreloadSize::Auto.force(7e3, 52.7e3), 2500.0, max_relative = 1e-14);
        assert_relative_eq!(PreloadSize::Auto.force(14.2e3, 0.0), 5100.0, max_relative = 1e-14);
        assert_relative_eq!(
            PreloadSize::Auto.force(2500.0 * UNLOADING_RATIO, 0.0),
            2500.0,
            max_relative = 1e-14
        );
        assert_relative_eq!(
            PreloadSize::Share(0.05).force(7e3, 52.7e3),
            2635.0,
            max_relative = 1e-14
        );
        assert_relative_eq!(
            PreloadMethod::DoubleNut.share() * 52.7e3,
            5270.0,
            max_relative = 1e-14
        );
    }
}
