//! The quantities of the analyses: a table for each, which reports, JSON, columns and schema are
//! made from.

use crate::output::Origin;
use crate::{AnalysisKind, CaseError, InputKey, InputSet, Output};

/// A quantity of an analysis: one number, or one for each contact or direction.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Unit in words; empty if dimensionless.
    pub unit: &'static str,
    /// Meaning.
    pub about: &'static str,
    /// What it is printed with.
    pub title: &'static str,
    /// What its numbers are of.
    pub of: Of,
    /// Its name in an object of one contact or direction, with its unit as suffix.
    pub key: &'static str,
    /// Its numbers as outputs; the contact or direction stands in front of the key.
    pub columns: &'static [Output],
    /// Inputs without default that it needs besides those of its analysis: one of each set.
    pub(crate) needs: &'static [InputSet],
}

impl Quantity {
    /// Inputs that it needs besides those of its analysis and that are not given, in words.
    pub(crate) fn missing(&self, given: InputSet) -> Vec<String> {
        let names = |set: &InputSet| {
            let names: Vec<_> = set.iter().map(InputKey::name).collect();
            names.join(" or ")
        };
        self.needs.iter().filter(|set| !given.completed().meets(**set)).map(names).collect()
    }
}

/// What the numbers of a quantity are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// The ball, the screw or the nut: one number.
    Whole,
    /// Each contact: nut, screw and minor.
    Contacts,
    /// Each direction of drive: rotary to linear, and linear to rotary.
    Directions,
    /// A statement that is true or false.
    Statement,
}

/// The most numbers that a quantity has.
const MOST: usize = 3;

/// The place of a quantity with one number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whole(pub(crate) usize);

/// The place of a quantity with a number for each contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contacts(pub(crate) usize);

/// The place of a quantity with a number for each direction of drive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Directions(pub(crate) usize);

/// The place of a statement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Statement(pub(crate) usize);

/// Declares the quantities of an analysis: `QUANTITIES`, and a constant of the same name for each,
/// with which [`Numbers`] takes its values.
macro_rules! quantities {
    ($analysis:ident; $($title:literal {
        $($name:ident [$unit:literal] $of:ident
            $(needs [$($($need:ident)|+),+])?, $about:literal;)*
    })*) => {
        /// Places in the table.
        #[expect(non_camel_case_types, reason = "the names of the vocabulary")]
        enum Place {
            $($($name,)*)*
        }

        $($(
            #[doc = $about]
            #[expect(non_upper_case_globals, reason = "the name of the vocabulary")]
            pub(crate) const $name: $crate::quantity::$of =
                $crate::quantity::$of(Place::$name as usize);
        )*)*

        /// All quantities, in the order in which they are printed.
        pub(crate) const QUANTITIES: &[$crate::Quantity] = &[$($($crate::Quantity {
            unit: $unit,
            about: $about,
            title: $title,
            of: $crate::Of::$of,
            key: stringify!($name),
            columns: $crate::quantity::quantities!(
                @$of $analysis, Place::$name as usize, $name, $unit, $about
            ),
            needs: &[$($($crate::InputSet::of(&[$($crate::InputKey::$need),+])),+)?],
        },)*)*];
    };
    (@Whole $($of:tt)*) => {
        &[$crate::quantity::quantities!(@column "number", 0, "", "", $($of)*)]
    };
    (@Statement $($of:tt)*) => {
        &[$crate::quantity::quantities!(@column "boolean", 0, "", "", $($of)*)]
    };
    (@Contacts $($of:tt)*) => {
        &[
            $crate::quantity::quantities!(@column "number", 0, "nut_", ", nut", $($of)*),
            $crate::quantity::quantities!(@column "number", 1, "screw_", ", screw", $($of)*),
            $crate::quantity::quantities!(@column "number", 2, "minor_", ", minor contact", $($of)*),
        ]
    };
    (@Directions $($of:tt)*) => {
        &[
            $crate::quantity::quantities!(
                @column "number", 0, "rotary_to_linear_", ", rotary to linear", $($of)*
            ),
            $crate::quantity::quantities!(
                @column "number", 1, "linear_to_rotary_", ", linear to rotary", $($of)*
            ),
        ]
    };
    (@column $json:literal, $member:literal, $before:literal, $where:literal,
        $analysis:ident, $place:expr, $name:ident, $unit:literal, $about:literal) => {
        $crate::Output {
            name: concat!($before, stringify!($name)),
            unit: $unit,
            json_type: $json,
            words: &[],
            about: concat!($about, $where),
            origin: $crate::output::Origin::Analysis {
                kind: $crate::AnalysisKind::$analysis,
                quantity: $place,
                member: $member,
            },
        }
    };
}

pub(crate) use quantities;

/// Values of the quantities of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    kind: AnalysisKind,
    /// By place and member; a statement is 0 or 1.
    values: Vec<[Option<f64>; MOST]>,
}

impl Numbers {
    pub(crate) fn new(kind: AnalysisKind) -> Self {
        Self { kind, values: vec![[None; MOST]; kind.quantities().len()] }
    }

    pub(crate) fn kind(&self) -> AnalysisKind {
        self.kind
    }

    pub(crate) fn whole(&mut self, Whole(place): Whole, value: impl Into<Option<f64>>) {
        self.values[place] = [value.into(), None, None];
    }

    /// * `values`: at nut, screw and minor contact.
    pub(crate) fn contacts(&mut self, Contacts(place): Contacts, values: [Option<f64>; 3]) {
        self.values[place] = values;
    }

    /// At nut and screw.
    pub(crate) fn both(&mut self, place: Contacts, [nut, screw]: [f64; 2]) {
        self.contacts(place, [Some(nut), Some(screw), None]);
    }

    /// * `values`: rotary to linear, and linear to rotary.
    pub(crate) fn directions(&mut self, Directions(place): Directions, values: [Option<f64>; 2]) {
        self.values[place] = [values[0], values[1], None];
    }

    pub(crate) fn statement(&mut self, Statement(place): Statement, holds: bool) {
        self.values[place] = [Some(f64::from(u8::from(holds))), None, None];
    }

    /// The quantities that have a value, with the values.
    pub fn rows(&self) -> impl Iterator<Item = (&'static Quantity, [Option<f64>; MOST])> {
        let rows = self.kind.quantities().iter().zip(self.values.iter().copied());
        rows.filter(|(_, values)| values.iter().any(Option::is_some))
    }

    /// The values with their names, as outputs.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Output, f64)> {
        let of_row = |(quantity, values): (&'static Quantity, [Option<f64>; MOST])| {
            let columns = quantity.columns.iter().zip(values);
            columns.filter_map(|(column, value)| Some((column, value?)))
        };
        self.rows().flat_map(of_row)
    }

    /// A value by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.entries().find(|(column, _)| column.name == name).map(|(_, value)| value)
    }

    /// The value of an output of this analysis; a statement is 0 or 1.
    pub fn value(&self, output: &Output) -> Option<f64> {
        match output.origin {
            Origin::Analysis { kind, quantity, member } if kind == self.kind => {
                self.values[quantity][member]
            }
            _ => None,
        }
    }

    /// These, if every one is a finite number.
    ///
    /// # Errors
    ///
    /// [`CaseError::BeyondDouble`] with the first that is not.
    pub(crate) fn finite(self) -> Result<Self, CaseError> {
        let endless = self.entries().find(|(_, value)| !value.is_finite());
        match endless.map(|(column, _)| column.name) {
            Some(output) => Err(CaseError::BeyondDouble { output }),
            None => Ok(self),
        }
    }
}
