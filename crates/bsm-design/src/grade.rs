//! Accuracy grades of screws: which standard a name is of, and how much the travel may vary within 300 mm.

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
}
