//! Manufacturing process of a screw and type of ball return, which determine the permitted speed
//! number and the maximum length.

use std::f64::consts::TAU;

use crate::Grade;

/// Maximum screw lengths that manufacturers offer \[mm\] by grade and nominal diameter \[mm\].
///
/// Source: HIWIN BS-08-2, table 6.2, ground; THK, table 15, rolled.
const MAX_LENGTHS: &str = include_str!("longest_screws.csv");

/// Rounding increment of nominal diameters: one millimeter \[m\].
const STEP: f64 = 1e-3;

/// Manufacturing process of a screw, or type of ball return.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Make {
    /// Rolled screw.
    Rolled,
    /// Ground screw.
    Ground,
    /// Screw with a ball cage.
    Caged,
    /// Screw with a ball return for high speeds.
    HighSpeed,
}

/// Finest grade in which manufacturers offer rolled screws, as the number in the name of the grade.
///
/// This is common practice: HIWIN offers rolled screws in T5, T7 and T10, and THK in C7, C8 and C10.
const FINEST_ROLLED_GRADE: f64 = 5.0;

impl Make {
    /// Returns true if manufacturers offer screws of this make in the given grade. Rolled screws
    /// are not offered in grades finer than 5.
    pub fn is_offered_in(self, grade: &Grade) -> bool {
        self != Self::Rolled || grade.fineness().is_none_or(|number| number >= FINEST_ROLLED_GRADE)
    }

    /// Returns true if a listed screw of the given make can be supplied in this make. A ball cage
    /// or a high-speed ball return is an option of a ground screw.
    fn is_supplied_as(self, listed: Self) -> bool {
        self == listed || (listed == Self::Ground && self != Self::Rolled)
    }

    /// Returns true if a listed screw can be selected.
    ///
    /// * `listed`: make that the list of sizes states; `None` if the list does not state it.
    /// * `required`: required make; `None` if any make is permitted.
    /// * `grade`: required accuracy grade. If no make is required, it excludes rolled screws that
    ///   are not offered in this grade.
    pub(crate) fn may_be_selected(
        listed: Option<Self>,
        required: Option<Self>,
        grade: Option<&Grade>,
    ) -> bool {
        match (listed, required) {
            (None, _) => true,
            (Some(listed), Some(required)) => required.is_supplied_as(listed),
            (Some(listed), None) => grade.is_none_or(|grade| listed.is_offered_in(grade)),
        }
    }

    /// Returns the default limit of the speed number \[m·rad/s\].
    ///
    /// * `lead`, `land`: lead and outer diameter of the screw \[m\].
    ///
    /// Source: THK, A-697. HIWIN BS-08-2, 3.7.6, states 70 000 mm/min for rolled screws, 90 000 for
    /// ground screws and 180 000 for screws with a high-speed ball return.
    pub fn speed_number(self, lead: f64, land: f64) -> f64 {
        let nominal = (land / STEP).round() * STEP;
        let workshop = match self {
            Self::Rolled if lead < 0.5 * nominal * (1.0 - 1e-9) => 50e3,
            Self::Rolled | Self::Ground => 70e3,
            Self::Caged => 130e3,
            Self::HighSpeed => 160e3,
        };
        // Catalogs state the permitted speed number in mm/min.
        workshop * 1e-3 * TAU / 60.0
    }

    /// Returns the length of the longest screw that manufacturers offer \[m\], for the listed
    /// diameter that is nearest to the given diameter. For a ground screw, the result is the
    /// longest screw of the given grade or a finer grade. If the grade is unknown, all grades are
    /// considered. Returns `None` if the diameter is unknown.
    ///
    /// * `land`: outer diameter \[m\].
    pub fn longest(self, grade: Option<&Grade>, land: f64) -> Option<f64> {
        if land.is_nan() {
            return None;
        }
        let number = |text: &str| text.parse::<f64>().ok();
        let own = grade.and_then(Grade::fineness).unwrap_or(f64::INFINITY);
        let mut rows = MAX_LENGTHS.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let heads = rows.next()?;
        let far = |head: &str| number(head).map(|mm| (mm * 1e-3 / land).ln().abs());
        let columns = (1..heads.len()).filter_map(|column| Some((far(heads[column])?, column)));
        let (_, column) = columns.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let fits = |row: &Vec<&str>| match (self, number(row[0])) {
            (Self::Rolled, fineness) => fineness.is_none(),
            (_, fineness) => fineness.is_some_and(|fineness| fineness <= own),
        };
        // Coarser grades come last in the table and permit longer screws.
        Some(1e-3 * number(rows.rfind(fits)?[column])?)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The limits match rows of the THK table: one row with a lead of half the diameter, and rows
    /// with a smaller lead. The land diameter of a screw with a nominal diameter of 20 mm differs
    /// from 20 mm.
    #[test]
    fn the_speed_number_depends_on_the_manufacturing_method() {
        let workshop = |make: Make, lead, land| make.speed_number(lead, land) * 60e3 / TAU;
        for (make, lead, land, limit) in [
            (Make::Rolled, 10e-3, 20.3e-3, 70e3),
            (Make::Rolled, 5e-3, 20.3e-3, 50e3),
            (Make::Ground, 5e-3, 20.3e-3, 70e3),
            (Make::Caged, 5e-3, 20.3e-3, 130e3),
            (Make::HighSpeed, 5e-3, 20.3e-3, 160e3),
        ] {
            // The tolerance allows for rounding errors in the unit conversion.
            assert_relative_eq!(workshop(make, lead, land), limit, max_relative = 1e-14);
        }
    }

    /// Rolled screws are listed up to grade 5. A screw that is listed only as rolled is not ground,
    /// and a ball cage is an option of a ground screw.
    #[test]
    fn a_listed_make_restricts_grade_and_required_make() {
        use Make::{Caged, Ground, Rolled};
        for (listed, required, grade, expected) in [
            (Some(Rolled), None, Some("P3"), false),
            (Some(Rolled), None, Some("C7"), true),
            (Some(Rolled), None, None, true),
            (Some(Ground), None, Some("P3"), true),
            (Some(Rolled), Some(Rolled), Some("P3"), true),
            (Some(Rolled), Some(Ground), None, false),
            (Some(Ground), Some(Rolled), None, false),
            (Some(Ground), Some(Caged), None, true),
            (Some(Rolled), Some(Caged), None, false),
            (None, Some(Rolled), Some("P3"), true),
        ] {
            let selected = Make::may_be_selected(listed, required, grade.and_then(Grade::named));
            assert_eq!(selected, expected, "{listed:?} {required:?} {grade:?}");
        }
    }

    /// The lengths match rows of the HIWIN and THK tables: P3 with 32 mm diameter; C2, for which
    /// the limit of grade 1 applies; T7 and an unknown grade, for which the limit of grade 5
    /// applies; and rolled screws of any grade. A land diameter of 49.03 mm belongs to a nominal
    /// diameter of 50 mm.
    #[test]
    fn maximum_screw_lengths_match_the_catalog_tables() {
        for (make, grade, land, longest) in [
            (Make::Ground, Some("P3"), 32e-3, Some(2.5)),
            (Make::Ground, Some("C2"), 32e-3, Some(1.8)),
            (Make::Ground, Some("T7"), 49.03e-3, Some(5.0)),
            (Make::HighSpeed, None, 6e-3, Some(0.17)),
            (Make::Rolled, Some("P3"), 20e-3, Some(2.0)),
            (Make::Rolled, None, 63e-3, None),
        ] {
            let found = make.longest(grade.and_then(Grade::named), land);
            assert_eq!(
                found.map(|length| (length * 1e3).round()),
                longest.map(|length: f64| (length * 1e3).round())
            );
        }
    }
}
