//! Accuracy grades of screws: their standards, permitted travel deviations and variations, and
//! permitted variations of the friction torque due to preload.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z34) and (Z35).

use std::sync::LazyLock;

/// Table with one row per grade: name; standard; `$v_{300p}$` and `$v_{2\pi p}$` \[um\]; and one
/// column with `$e_p$`/`$v_{up}$` \[um\] for each range of the useful travel. The heading of such a
/// column is the upper limit of its range \[mm\].
///
/// Source: ISO 3408-3 as printed in HIWIN BS-08-2, tables 3.3 and 3.4, with typical values for
/// `$v_{2\pi p}$`; JIS B 1192 as printed by THK, A-678, tables 1 and 2. For grade C7 and coarser
/// grades, the JIS tables state a ± deviation.
const TABLE: &str = include_str!("grades.csv");

static GRADES: LazyLock<Vec<Grade>> = LazyLock::new(|| {
    let number = |text: &str| text.parse::<f64>().ok();
    let um = |text: &str| Some(1e-6 * number(text)?);
    let mut rows = TABLE.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heads = rows.next().unwrap_or_default();
    let lengths: Vec<_> = heads.into_iter().filter_map(number).map(|mm| 1e-3 * mm).collect();
    let grade = |row: Vec<&'static str>| {
        let [name, standard, variation, of_a_turn, cells @ ..] = &row[..] else { return None };
        let row = |(length, cell): (&f64, &&str)| {
            let (deviation, variation) = cell.split_once('/')?;
            Some((*length, um(deviation)?, um(variation)))
        };
        let travels = lengths.iter().zip(cells).filter_map(row).collect();
        Some(Grade { name, standard, variation: um(variation)?, of_a_turn: um(of_a_turn), travels })
    };
    rows.filter_map(grade).collect()
});

/// Permitted variation of the friction torque due to preload \[%\], by range of the torque \[N·m\],
/// thread length and thread slenderness. Rows without length and slenderness apply to longer
/// threads.
///
/// Source: HIWIN BS-08-2, table 3.16, for P0 to P7; THK A-688, table 13, for C0 to C5.
const TORQUE_VARIATIONS: &str = include_str!("torque_variations.csv");

/// Thread length \[m\] above which the table rows without a length apply.
const LONG: f64 = 4.0;

/// Accuracy grade of a screw.
#[derive(Debug, Clone, PartialEq)]
pub struct Grade {
    /// Name of the grade, for example P3 or C3.
    pub name: &'static str,
    /// Standard that defines the grade.
    pub standard: &'static str,
    /// Permitted travel variation within any 300 mm, `$v_{300p}$` \[m\].
    pub variation: f64,
    /// Permitted travel variation within any revolution, `$v_{2\pi p}$` \[m\]; `None` for grades of
    /// transport screws.
    pub of_a_turn: Option<f64>,
    /// Table rows, each with the largest useful travel, `$e_p$` and `$v_{up}$` \[m\]; empty if the
    /// deviation is proportional to the travel.
    travels: Vec<(f64, f64, Option<f64>)>,
}

impl Grade {
    /// Returns the accuracy grades of all standards.
    pub fn all() -> impl Iterator<Item = &'static Self> + Clone {
        GRADES.iter()
    }

    /// Returns the number in the name of the grade. Finer grades have smaller numbers.
    pub(crate) fn fineness(&self) -> Option<f64> {
        self.name.trim_start_matches(char::is_alphabetic).parse().ok()
    }

    /// Returns the permitted travel deviation `$e_p$` over a useful travel \[m\] (Z34), or `None`
    /// if the travel is outside the range of the table.
    pub fn deviation(&self, travel: f64) -> Option<f64> {
        /// Travel to which the permitted variation `$v_{300p}$` refers \[m\].
        const STATED: f64 = 0.3;
        if self.travels.is_empty() {
            // e_p = (l_u/300 mm) v_300p                                   (Z34)
            return Some(travel / STATED * self.variation);
        }
        self.row(travel).map(|(_, deviation, _)| *deviation)
    }

    /// Returns the permitted travel variation within the useful travel, `$v_{up}$` \[m\]. Returns
    /// `None` if the travel is outside the range of the table, or if the deviation of the grade is
    /// proportional to the travel.
    pub fn variation_of_travel(&self, travel: f64) -> Option<f64> {
        self.row(travel).and_then(|(.., variation)| *variation)
    }

    /// Returns the first row whose largest useful travel is at least the given travel \[m\].
    fn row(&self, travel: f64) -> Option<&(f64, f64, Option<f64>)> {
        self.travels.iter().find(|(longest, ..)| travel <= longest * (1.0 + 1e-12))
    }

    /// Returns the largest possible travel error \[m\] (Z35), or `None` if the travel is outside
    /// the range of the table.
    pub fn worst_error(&self, travel: f64) -> Option<f64> {
        let deviation = self.deviation(travel)?;
        if self.travels.is_empty() {
            // If the permitted deviation of a grade is proportional to the travel, the deviation
            // already includes all variations.
            return Some(deviation);
        }
        // e = e_p + v_up/2                                                (Z35)
        Some(deviation + 0.5 * self.variation_of_travel(travel)?)
    }

    /// Returns the coarsest grade of the same standard that limits the travel error to `error`
    /// \[m\] over the useful travel `travel` \[m\].
    pub fn coarsest_within(&self, error: f64, travel: f64) -> Option<&'static Self> {
        let same = Self::all().filter(|grade| grade.standard == self.standard);
        let kept = same.filter_map(|grade| Some((grade, grade.worst_error(travel)?)));
        let kept = kept.filter(|(_, worst)| *worst <= error);
        kept.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(grade, _)| grade)
    }

    /// Returns the permitted variation of the friction torque due to preload as a ± value \[%\], or
    /// `None` if the standard does not state it.
    ///
    /// * `torque`: friction torque due to preload \[N·m\].
    /// * `length`: length of the thread \[m\].
    /// * `diameter`: nominal diameter \[m\].
    pub fn torque_variation(&self, torque: f64, length: f64, diameter: f64) -> Option<f64> {
        let mut rows = TORQUE_VARIATIONS.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let column = rows.next()?.iter().position(|head| *head == self.name)?;
        let row = rows.find(|row| {
            let limits = [0, 1, 3].map(|column: usize| row[column].parse().ok());
            let [Some(from), Some(to), slimmest] = limits else { return false };
            let within = slimmest
                .map_or(length > LONG, |most: f64| length <= LONG && length / diameter <= most);
            within && (from..=to).contains(&torque) && torque > from
        })?;
        row[column].parse().ok()
    }

    /// Returns the grade with the given name (case-insensitive). `IT3` and `G3` are aliases of P3.
    pub fn named(name: &str) -> Option<&'static Self> {
        let name = name.to_ascii_uppercase();
        let number = name.strip_prefix("IT").or(name.strip_prefix('G'));
        let name = number.map_or(name.clone(), |number| format!("P{number}"));
        GRADES.iter().find(|grade| grade.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The manufacturers' grade C3 used to be treated as P3 of ISO 3408-3, although it permits 8 um
    /// instead of 12 um. Source: THK A-678 and HIWIN table 3.3.
    #[test]
    fn grades_of_manufacturers_differ_from_iso_grades() {
        let um =
            |name: &str| Grade::named(name).map(|grade| (1e7 * grade.variation).round() / 10.0);
        let known =
            [("P3", 12.0), ("C3", 8.0), ("c5", 18.0), ("P5", 23.0), ("C7", 50.0), ("T7", 52.0)];
        for (name, expected) in known {
            assert_eq!(um(name), Some(expected), "{name}");
        }
        assert_eq!(um("C4"), None);
    }

    /// The deviations and the limits of the travel ranges match the tables (in um). A travel equal
    /// to the upper limit of a row belongs to this row, and values are not interpolated.
    #[test]
    fn travel_deviations_match_the_tables() {
        let um = |meters: Option<f64>| meters.map(|x| (1e7 * x).round() / 10.0);
        let of = |name: &str, mm: f64| {
            let grade = Grade::named(name).expect("a grade");
            [um(grade.deviation(1e-3 * mm)), um(grade.variation_of_travel(1e-3 * mm))]
        };
        for (name, mm, deviation, variation) in [
            ("P3", 315.0, Some(12.0), Some(12.0)),
            ("P3", 316.0, Some(13.0), Some(12.0)),
            ("P3", 50.0, Some(12.0), Some(12.0)),
            ("it3", 1000.0, Some(21.0), Some(17.0)),
            ("G5", 1000.0, Some(40.0), Some(34.0)),
            ("P0", 1600.0, Some(11.0), Some(7.0)),
            ("P0", 1601.0, Some(13.0), None),
            ("P0", 3151.0, None, None),
            ("P3", 5001.0, Some(92.0), None),
            ("P5", 6300.0, Some(170.0), Some(119.0)),
            ("P5", 6301.0, None, None),
            ("C3", 100.0, Some(8.0), Some(8.0)),
            ("C3", 101.0, Some(10.0), Some(8.0)),
            ("C3", 1000.0, Some(21.0), Some(15.0)),
            ("C5", 1000.0, Some(40.0), Some(27.0)),
            ("C5", 10_000.0, Some(260.0), Some(140.0)),
            ("C0", 1601.0, None, None),
            ("P7", 700.0, Some(121.3), None),
            ("C7", 700.0, Some(116.7), None),
            ("C7", 1000.0, Some(166.7), None),
            ("T10", 300.0, Some(210.0), None),
        ] {
            assert_eq!(of(name, mm), [deviation, variation], "{name} {mm}");
        }
        let turn = |name: &str| um(Grade::named(name).expect("a grade").of_a_turn);
        assert_eq!(["C3", "P3", "P5", "C7"].map(turn), [Some(6.0), Some(6.0), Some(8.0), None]);
        assert_eq!(Grade::all().count(), 17);
        // A finer grade or a shorter travel never permits a larger error.
        for standard in [["P0", "P1", "P3", "P5"], ["C0", "C1", "C3", "C5"]] {
            let mut finer = Some(0.0);
            for name in standard {
                let errors = [0.1, 0.5, 1.0, 1.5].map(|m| Grade::named(name)?.worst_error(m));
                assert!(errors.is_sorted() && finer < errors[0], "{name} {errors:?}");
                finer = errors[0];
            }
        }
    }

    /// Hand calculation for a travel of 1000 mm: C7 permits 0.167 mm (THK A-723), and C3 permits 21
    /// + 15/2 um. C3 is the coarsest grade for a limit of 28.5 um, because C5 permits more.
    #[test]
    fn coarsest_accuracy_grade_that_meets_a_travel_error_limit_is_found() {
        let of = |name: &str| Grade::named(name).expect("a grade");
        let worst = |name: &str| of(name).worst_error(1.0).map(|x| (1e7 * x).round() / 10.0);
        assert_eq!(["C7", "C3"].map(worst), [Some(166.7), Some(28.5)]);
        let kept = |um: f64| of("C7").coarsest_within(1e-6 * um, 1.0).map(|grade| grade.name);
        assert_eq!([28.5, 28.4, 1.0].map(kept), [Some("C3"), Some("C2"), None]);
        assert_eq!(of("T7").coarsest_within(60e-6, 1.0).map(|grade| grade.name), Some("P5"));
    }

    /// Every entry matches the tables of HIWIN (table 3.16: P0, P1, P3, P5, P7) and THK (table 13:
    /// C0, C1, C2 = C3, C5). Each entry is checked at the upper limit and just above the lower
    /// limit of its torque range. The three threads have a slenderness of up to 40, a slenderness
    /// of up to 60, and a length of more than 4 m.
    #[test]
    fn variations_of_the_preload_torque_match_the_tables() {
        const PRINTED: &str = "\
            0.2 0.4|30 35 40 50 -|40 40 50 60 -|- - - - -|35 40 45 55|45 45 55 65|- - - -
            0.4 0.6|25 30 35 40 -|35 35 40 45 -|- - - - -|25 30 35 45|38 38 45 50|- - - -
            0.6 1.0|20 25 30 35 40|30 30 35 40 45|- - 40 45 50|20 25 30 35|30 30 35 40|- - 40 45
            1.0 2.5|15 20 25 30 35|25 25 30 35 40|- - 35 40 45|15 20 25 30|25 25 30 35|- - 35 40
            2.5 6.3|10 15 20 25 30|20 20 25 30 35|- - 30 35 40|10 15 20 25|20 20 25 30|- - 30 35
            6.3 10|- - 15 20 30|- - 20 25 35|- - 25 30 35|- - 15 20|- - 20 25|- - 25 30";
        let iso = ["P0", "P1", "P3", "P5", "P7"];
        let jis = ["C0", "C1", "C2", "C5"];
        let percent = |name: &str, torque: f64, length: f64, diameter: f64| {
            Grade::named(name).expect("a grade").torque_variation(torque, length, diameter)
        };
        let threads = [(1.6, 0.04), (2.4, 0.04), (4.001, 0.1)];
        let mut entries = 0;
        for line in PRINTED.lines() {
            let mut cells = line.trim().split('|');
            let range = cells.next().expect("a range").split_once(' ').expect("two torques");
            let (from, to): (f64, f64) =
                (range.0.parse().expect("a torque"), range.1.parse().expect("a torque"));
            let columns = threads.iter().map(|thread| (&iso[..], thread));
            let columns = columns.chain(threads.iter().map(|thread| (&jis[..], thread)));
            for ((grades, (length, diameter)), cell) in columns.zip(cells) {
                for (name, text) in grades.iter().zip(cell.split(' ')) {
                    for torque in [from * 1.0001, to] {
                        let ours = percent(name, torque, *length, *diameter);
                        assert_eq!(ours, text.parse().ok(), "{name} {torque} N m, {length} m");
                        entries += 1;
                    }
                }
            }
        }
        // Six rows, nine grades and three thread types are checked at two torques each.
        assert_eq!(entries, 6 * 9 * 3 * 2);
        assert_eq!(percent("C3", 0.865, 1.3, 0.04), percent("C2", 0.865, 1.3, 0.04));
        // The tables contain no values for these torques, for a short slender thread, or for this
        // grade.
        for (name, torque, length) in
            [("P3", 0.2, 1.3), ("P3", 10.001, 1.3), ("C0", 0.5, 2.401), ("C7", 1.0, 1.3)]
        {
            assert_eq!(percent(name, torque, length, 0.04), None);
        }
    }
}
