//! How a screw is made, and the speed number that its ball return permits.

use std::f64::consts::TAU;

/// Nominal diameters are whole millimetres \[m\].
const STEP: f64 = 1e-3;

/// How a screw and the return of its nut are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Make {
    /// Rolled.
    Rolled,
    /// Ground.
    Ground,
    /// Balls in a cage.
    Caged,
    /// With a return for high speeds.
    HighSpeed,
}

impl Make {
    /// Largest speed number \[m·rad/s\], unless the maker states one.
    ///
    /// * `lead`, `land`: of the screw and its outer diameter \[m\].
    ///
    /// Source: THK, A-697; HIWIN BS-08-2, 3.7.6, has 70 000 mm/min rolled, 90 000 ground and 180 000 with a return for high
    /// speeds.
    pub fn speed_number(self, lead: f64, land: f64) -> f64 {
        let nominal = (land / STEP).round() * STEP;
        let workshop = match self {
            Self::Rolled if lead < 0.5 * nominal * (1.0 - 1e-9) => 50e3,
            Self::Rolled | Self::Ground => 70e3,
            Self::Caged => 130e3,
            Self::HighSpeed => 160e3,
        };
        // mm/min
        workshop * 1e-3 * TAU / 60.0
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The rows of THK, with leads at and below half of the diameter; the land of a 20 mm screw is not 20 mm.
    #[test]
    fn the_speed_number_follows_the_make() {
        let workshop = |make: Make, lead, land| make.speed_number(lead, land) * 60e3 / TAU;
        for (make, lead, land, limit) in [
            (Make::Rolled, 10e-3, 20.3e-3, 70e3),
            (Make::Rolled, 5e-3, 20.3e-3, 50e3),
            (Make::Ground, 5e-3, 20.3e-3, 70e3),
            (Make::Caged, 5e-3, 20.3e-3, 130e3),
            (Make::HighSpeed, 5e-3, 20.3e-3, 160e3),
        ] {
            // Rounding of the units.
            assert_relative_eq!(workshop(make, lead, land), limit, max_relative = 1e-14);
        }
    }
}
