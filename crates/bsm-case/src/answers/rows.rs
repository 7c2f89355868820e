//! Quantities of a record in display order, with rounding errors replaced by zero.

use crate::vocabulary::output::SOLUTION;
use crate::vocabulary::units::MM;
use crate::{Case, Numbers, OUTPUTS, Output, Quantity, Record, output};

/// Magnitude, relative to the scale of the unit, below which a number is treated as a rounding
/// error and shown as 0.
const ROUNDING: f64 = 1e-12;

/// Reference magnitude of each unit in a table: the largest magnitude among the numbers with this
/// unit, or 180 for angles.
#[derive(Debug, Clone)]
pub struct Scales(Vec<(&'static str, f64)>);

impl Scales {
    /// Determines the reference magnitude of each unit: the largest absolute value among the
    /// numbers with this unit.
    pub fn of(numbers: impl Iterator<Item = (&'static str, f64)>) -> Self {
        let mut scales = vec![("deg", 180.0)];
        for (unit, value) in numbers {
            match scales.iter_mut().find(|(known, _)| *known == unit) {
                Some((_, largest)) => *largest = value.abs().max(*largest),
                None => scales.push((unit, value.abs())),
            }
        }
        Self(scales)
    }

    /// Returns the number, or zero if it is only a rounding error compared with the reference
    /// magnitude of its unit. A number without a unit is returned unchanged.
    pub fn clean(&self, unit: &str, value: f64) -> f64 {
        let scale = self.0.iter().find(|(known, _)| !unit.is_empty() && *known == unit);
        let noise = scale.is_some_and(|(_, largest)| value.abs() < ROUNDING * largest);
        if noise { 0.0 } else { value }
    }
}

impl Record {
    /// Returns the outputs for display, with rounding errors replaced by zero. `case` contains the
    /// inputs.
    pub fn rows(&self, case: &Case) -> Numbers {
        // All slip speeds of a rolling ball are rounding errors, so the surface speed of the ball
        // serves as their scale.
        let surface = self.number(output!(ball_omega_t_rad_s)).map_or(0.0, |omega_t| {
            let rates = [output!(ball_omega_n_rad_s), output!(ball_omega_b_rad_s)]
                .map(|name| self.number(name));
            let fastest = rates.into_iter().flatten().fold(omega_t.abs(), |a, b| a.max(b.abs()));
            0.5 * MM * case.ball_diameter_mm.unwrap_or(0.0) * fastest
        });
        let numbers = OUTPUTS.iter().filter_map(|o| Some((o.unit, self.number(o.into())?)));
        let scales = Scales::of(numbers.chain([("m/s", surface)]));
        let read = |place: usize| {
            let Quantity { columns, unit, .. } = SOLUTION[place];
            let number = |column: &Output| Some(scales.clean(unit, self.number(column.into())?));
            [0, 1, 2].map(|member| columns.get(member).and_then(number))
        };
        Numbers::of(SOLUTION, read, |_| true).filter(|quantity| !quantity.is_hidden)
    }
}
