//! Accuracy grades of screws: which standard a name is of, how much the travel may vary within 300 mm, and how much the
//! friction torque of a preload.

/// A standard of grades.
const ISO: &str = "ISO 3408-3";
const JIS: &str = "JIS B 1192";

/// Grades \[m\]: of positioning (P) and transport (T) screws by ISO 3408-3, `$v_{300p}$`, as HIWIN BS-08-2 has them in
/// table 3.3; of JIS B 1192 (C) as THK has them, A-678, where those from C7 on are a deviation to either side.
const GRADES: [Grade; 17] = [
    Grade { name: "P0", standard: ISO, variation: 3.5e-6 },
    Grade { name: "P1", standard: ISO, variation: 6e-6 },
    Grade { name: "P3", standard: ISO, variation: 12e-6 },
    Grade { name: "P5", standard: ISO, variation: 23e-6 },
    Grade { name: "P7", standard: ISO, variation: 52e-6 },
    Grade { name: "P10", standard: ISO, variation: 210e-6 },
    Grade { name: "T5", standard: ISO, variation: 23e-6 },
    Grade { name: "T7", standard: ISO, variation: 52e-6 },
    Grade { name: "T10", standard: ISO, variation: 210e-6 },
    Grade { name: "C0", standard: JIS, variation: 3.5e-6 },
    Grade { name: "C1", standard: JIS, variation: 5e-6 },
    Grade { name: "C2", standard: JIS, variation: 7e-6 },
    Grade { name: "C3", standard: JIS, variation: 8e-6 },
    Grade { name: "C5", standard: JIS, variation: 18e-6 },
    Grade { name: "C7", standard: JIS, variation: 50e-6 },
    Grade { name: "C8", standard: JIS, variation: 100e-6 },
    Grade { name: "C10", standard: JIS, variation: 210e-6 },
];

/// Permitted variations of the friction torque of a preload \[%\] from the torque before \[N·m\] up to that of the next
/// row, for the slenderness and length of [`Grade::torque_variation`]: HIWIN BS-08-2, table 3.16, of P0, P1, P3, P5 and P7,
/// and THK A-688, table 13, of C0, C1, C2 with C3, and C5; 0 where there is none.
type Variations = (f64, [[u8; 5]; 3], [[u8; 4]; 3]);

const TORQUE_VARIATIONS: [Variations; 6] = [
    (
        0.2,
        [[30, 35, 40, 50, 0], [40, 40, 50, 60, 0], [0; 5]],
        [[35, 40, 45, 55], [45, 45, 55, 65], [0; 4]],
    ),
    (
        0.4,
        [[25, 30, 35, 40, 0], [35, 35, 40, 45, 0], [0; 5]],
        [[25, 30, 35, 45], [38, 38, 45, 50], [0; 4]],
    ),
    (
        0.6,
        [[20, 25, 30, 35, 40], [30, 30, 35, 40, 45], [0, 0, 40, 45, 50]],
        [[20, 25, 30, 35], [30, 30, 35, 40], [0, 0, 40, 45]],
    ),
    (
        1.0,
        [[15, 20, 25, 30, 35], [25, 25, 30, 35, 40], [0, 0, 35, 40, 45]],
        [[15, 20, 25, 30], [25, 25, 30, 35], [0, 0, 35, 40]],
    ),
    (
        2.5,
        [[10, 15, 20, 25, 30], [20, 20, 25, 30, 35], [0, 0, 30, 35, 40]],
        [[10, 15, 20, 25], [20, 20, 25, 30], [0, 0, 30, 35]],
    ),
    (
        6.3,
        [[0, 0, 15, 20, 30], [0, 0, 20, 25, 35], [0, 0, 25, 30, 35]],
        [[0, 0, 15, 20], [0, 0, 20, 25], [0, 0, 25, 30]],
    ),
];

/// Largest torque of the last row \[N·m\].
const LARGEST_TORQUE: f64 = 10.0;

/// An accuracy grade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grade {
    /// Its name, such as P3 or C3.
    pub name: &'static str,
    /// The standard that it is of.
    pub standard: &'static str,
    /// Permitted variation of travel within any 300 mm \[m\].
    pub variation: f64,
}

impl Grade {
    /// All of them.
    pub fn all() -> impl Iterator<Item = &'static Self> + Clone {
        GRADES.iter()
    }

    /// Permitted variation of the friction torque of a preload to either side \[%\], where its standard has one.
    ///
    /// * `torque` \[N·m\]. * `length`: of the thread \[m\]. * `diameter`: nominal \[m\].
    pub fn torque_variation(&self, torque: f64, length: f64, diameter: f64) -> Option<f64> {
        let slenderness = length / diameter;
        let column = match (length <= 4.0, slenderness) {
            (true, ..=40.0) => 0,
            (true, ..=60.0) => 1,
            (false, _) => 2,
            _ => return None,
        };
        let row = TORQUE_VARIATIONS.iter().rev().find(|(from, ..)| torque > *from);
        let (_, iso, jis) = row.filter(|_| torque <= LARGEST_TORQUE)?;
        let percent = match self.name {
            "P0" => iso[column][0],
            "P1" => iso[column][1],
            "P3" => iso[column][2],
            "P5" => iso[column][3],
            "P7" => iso[column][4],
            "C0" => jis[column][0],
            "C1" => jis[column][1],
            "C2" | "C3" => jis[column][2],
            "C5" => jis[column][3],
            _ => 0,
        };
        (percent > 0).then(|| f64::from(percent))
    }

    /// The grade of that name, in capitals or not.
    pub fn named(name: &str) -> Option<&'static Self> {
        GRADES.iter().find(|grade| grade.name.eq_ignore_ascii_case(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C3 of the makers was taken for P3 of ISO 3408-3: 8 um are not 12. THK A-678 and HIWIN table 3.3.
    #[test]
    fn a_grade_3_is_not_any_grade_3() {
        let um =
            |name: &str| Grade::named(name).map(|grade| (1e7 * grade.variation).round() / 10.0);
        let known =
            [("P3", 12.0), ("C3", 8.0), ("c5", 18.0), ("P5", 23.0), ("C7", 50.0), ("T7", 52.0)];
        for (name, expected) in known {
            assert_eq!(um(name), Some(expected), "{name}");
        }
        assert_eq!(um("C4"), None);
    }

    /// The worked example of THK, A-689, 30 % of 0.865 N m at a slenderness of 32.5, and the edges of the tables.
    #[test]
    fn variations_of_the_preload_torque_are_those_of_the_tables() {
        let percent = |name: &str, torque: f64, length: f64, diameter: f64| {
            Grade::named(name).expect("a grade").torque_variation(torque, length, diameter)
        };
        assert_eq!(percent("C3", 0.865, 1.3, 0.04), Some(30.0));
        // A torque belongs to the row that it ends.
        assert_eq!(percent("P5", 0.6, 1.3, 0.04), Some(40.0));
        assert_eq!(percent("P5", 0.6001, 1.3, 0.04), Some(35.0));
        assert_eq!(percent("P7", 0.6, 1.3, 0.04), None);
        // Slender to 40 and to 60 diameters, and more than 4 m.
        assert_eq!(percent("C0", 0.5, 1.6, 0.04), Some(25.0));
        assert_eq!(percent("C0", 0.5, 2.0, 0.04), Some(38.0));
        assert_eq!(percent("C0", 0.5, 3.0, 0.04), None);
        assert_eq!(percent("P3", 8.0, 5.0, 0.1), Some(25.0));
        // Outside the tables, and grades without one.
        for torque in [0.2, 10.001] {
            assert_eq!(percent("P3", torque, 1.3, 0.04), None);
        }
        assert_eq!(percent("C7", 1.0, 1.3, 0.04), None);
    }
}
