//! Tables of quantities. Each row defines the name, unit, symbol, scope and meaning of a quantity.
//! For an input, the row also contains the rule for its value; for a result, the row contains the
//! function that reads its value. Cases, answers, JSON, columns and the schema are generated from
//! these tables.

use bsm_design::statistics::Band;

use super::output::Origin;
use crate::{CaseError, InputKey, InputSet, Output, Rule};

/// Kinds of analyses whose results can be columns of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalysisKind {
    /// Analysis of ball slip.
    Slip,
    /// Analysis of ball jamming.
    Jam,
    /// Optimum contact angles and self-locking limits.
    Optimum,
    /// Calculation of the ratings, the stiffness and the thread of a nut.
    Ratings,
    /// Calculation of a nut with all its balls (`bsm nut`).
    Nut,
    /// Calculation of an axis: screw, nut, bearings and motor (`bsm axis`).
    Axis,
    /// Calculation of the warm steady state of an axis.
    Warm,
    /// Number of warnings about a solution.
    Warnings,
    /// 90 % intervals due to uncertain lubricant friction.
    Band,
    /// Steady motions along the solution branch of increasing inertia.
    Branch,
}

/// An input or a result. It has a single value, or one value for each contact or direction.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Name, with its unit as a suffix.
    pub name: &'static str,
    /// Unit as text; empty if dimensionless.
    pub unit: &'static str,
    /// Standard symbol, such as `C_a`; empty if there is none.
    pub symbol: &'static str,
    /// Meaning of the quantity, which is also its label.
    pub about: &'static str,
    /// Title of the table that contains the result, or group to which the input belongs.
    pub title: &'static str,
    /// True if the quantity is not displayed by itself: it is part of a sentence, or is written only
    /// to files.
    pub(crate) is_hidden: bool,
    /// Scope of the quantity, which determines how many values it has.
    pub scope: Scope,
    /// Columns that contain the values. The names of columns begin with the contact or the
    /// direction.
    pub columns: &'static [Output],
    /// Sets of additional inputs without a default that this quantity needs. At least one input of
    /// each set is required.
    pub(crate) needs: &'static [InputSet],
    /// Rule for the value, if the quantity is an input.
    pub rule: Rule,
    /// Default value of the quantity, if the quantity is an input.
    pub default: Option<f64>,
}

impl Quantity {
    /// Template for a quantity with a single value. All string fields are empty.
    pub(crate) const WHOLE: Self = Self {
        name: "",
        unit: "",
        symbol: "",
        about: "",
        title: "",
        is_hidden: false,
        scope: Scope::Scalar,
        columns: &[],
        needs: &[],
        rule: Rule::Any,
        default: None,
    };

    /// Returns the quantity with the given name from a table. The description of its meaning is cut
    /// off at the first semicolon.
    pub(crate) const fn with_short_meaning(table: &[Self], name: &str) -> Self {
        let mut place = 0;
        loop {
            if is_same(table[place].name, name) {
                let mut quantity = table[place];
                let mut end = 0;
                while end < quantity.about.len() && quantity.about.as_bytes()[end] != b';' {
                    end += 1;
                }
                quantity.about = quantity.about.split_at(end).0;
                return quantity;
            }
            place += 1;
        }
    }

    /// Returns the quantity with the given name from the first table that contains the name. In a
    /// const context, a name that is in none of the tables is a compile error.
    pub(crate) const fn of_tables(tables: &[&[Self]], name: &str) -> Self {
        let mut table = 0;
        loop {
            let mut place = 0;
            while place < tables[table].len() {
                if is_same(tables[table][place].name, name) {
                    return tables[table][place];
                }
                place += 1;
            }
            table += 1;
        }
    }

    /// Returns true if the quantity depends on friction, which is specified by a coefficient or by
    /// a lubricant.
    pub fn follows_from_friction(&self) -> bool {
        self.needs.iter().any(|set| set.contains(InputKey::friction_coefficient))
    }

    /// Returns the names of the additional inputs that the quantity needs and that are missing.
    pub(crate) fn missing(&self, given: InputSet) -> Vec<String> {
        let names = |set: &InputSet| {
            let names: Vec<_> = set.iter().map(InputKey::name).collect();
            names.join(" or ")
        };
        self.needs.iter().filter(|set| !given.completed().intersects(**set)).map(names).collect()
    }
}

/// Returns true if two names are equal. The comparison operator of `str` cannot be used in const
/// functions.
pub(crate) const fn is_same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    if one.len() != other.len() {
        return false;
    }
    let mut place = 0;
    while place < one.len() {
        if one[place] != other[place] {
            return false;
        }
        place += 1;
    }
    true
}

/// Scope of a quantity, which determines how many values it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// A single value for the ball, the screw or the nut.
    Scalar,
    /// One value for each contact: nut, screw and unloaded flank of the nut.
    Contacts,
    /// One value for each direction of drive: rotary to linear, and linear to rotary.
    Directions,
    /// A statement that is true or false.
    Statement,
}

impl Scope {
    /// Returns the table headings for the values.
    pub fn members(self) -> &'static [&'static str] {
        match self {
            Self::Scalar | Self::Statement => &[""],
            Self::Contacts => &["nut", "screw", "far flank"],
            Self::Directions => &["rotary to linear", "linear to rotary"],
        }
    }
}

/// Values of a quantity. True-or-false statements are stored as 1 and 0.
pub type Values = [Option<f64>; 3];

/// Type that the reader of a quantity can return.
pub(crate) trait Read {
    fn values(self) -> Values;
}

macro_rules! read {
    ($($kind:ty: $values:expr;)*) => {
        $(impl Read for $kind {
            fn values(self) -> Values {
                let values: fn(Self) -> Values = $values;
                values(self)
            }
        })*
    };
}

read! {
    f64: |number| [Some(number), None, None];
    Option<f64>: |number| [number, None, None];
    Option<bool>: |holds| [holds.map(|holds| f64::from(u8::from(holds))), None, None];
    // The two values apply to nut and screw, or to the two directions of drive.
    [f64; 2]: |[one, other]| [Some(one), Some(other), None];
    [Option<f64>; 2]: |[one, other]| [one, other, None];
    Option<[f64; 2]>: |pair| pair.map_or([None; 3], Read::values);
    Values: |values| values;
}

/// Declares a table of keys that are not inputs of a case:
/// `name ["unit"] rule, default, "meaning";`. The form `TABLE of Key;` also declares an enum with
/// one variant for each key.
macro_rules! keys {
    ($(#[$doc:meta])* $visible:vis $table:ident of $key:ident;
     $($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*) => {
        $crate::vocabulary::quantity::keys! {
            $(#[$doc])*
            $visible $table;
            $($name [$unit $($symbol)?] $rule, $default, $about;)*
        }

        #[doc = concat!("Key whose value is its index in [`", stringify!($table), "`].")]
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "variant names match the key names in the vocabulary")]
        pub(crate) enum $key {
            $(#[doc = $about] $name,)*
        }

        impl $key {
            /// All keys, in the order of the table.
            pub(crate) const ALL: [Self; $table.len()] = [$(Self::$name),*];

            /// Returns the key with the given name.
            pub(crate) fn from_name(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|key| key.quantity().name == name)
            }

            /// Returns the definition of the key.
            pub(crate) fn quantity(self) -> &'static $crate::Quantity {
                &$table[self as usize]
            }
        }
    };
    ($(#[$doc:meta])* $visible:vis $table:ident;
     $($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*) => {
        $(#[$doc])*
        $visible const $table: &[$crate::Quantity] = &[$($crate::Quantity {
            name: stringify!($name),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $about,
            rule: $rule,
            default: $default,
            ..$crate::Quantity::WHOLE
        },)*];
    };
}

pub(crate) use keys;

/// Converts the first token of a group of quantities, which is its title or the word `hidden`.
macro_rules! group {
    (@title hidden) => {
        ""
    };
    (@title $title:literal) => {
        $title
    };
    (@is_hidden hidden) => {
        true
    };
    (@is_hidden $title:literal) => {
        false
    };
}

pub(crate) use group;

/// Declares a table of quantities and the function that calculates their values.
///
/// The syntax is `name ["unit"] Scope(reader), "meaning";`. A `"symbol"` may follow the unit. The
/// reader may be followed by a list `needs [a, b | c]`, or by a constant that contains such a list.
/// The list names additional inputs that the quantity needs (here `a`, and either `b` or `c`). The
/// form `name = TABLE Scalar(reader);` takes unit, symbol and meaning from another table. The
/// quantities form groups. Each group begins with its title, or with the word `hidden`.
macro_rules! quantities {
    ($(#[$doc:meta])* $visible:vis $table:ident, $numbers:ident(&$state:ty) $(of $analysis:ident)?; $($title:tt {
        $($name:ident $([$unit:literal $($symbol:literal)?])? $(= $table_of:ident)? $of:ident($read:expr)
            $(needs $needs:tt)? $(, $about:literal)?;)*
    })*) => {
        $(#[$doc])*
        $visible const $table: &[$crate::Quantity] = {
            const KIND: Option<$crate::AnalysisKind> =
                $crate::vocabulary::quantity::quantities!(@kind $($analysis)?);
            &[$($($crate::Quantity {
                title: $crate::vocabulary::quantity::group!(@title $title),
                is_hidden: $crate::vocabulary::quantity::group!(@is_hidden $title),
                scope: $crate::Scope::$of,
                needs: $crate::vocabulary::quantity::quantities!(@needs $($needs)?),
                ..$crate::vocabulary::quantity::quantities!(
                    @said $of $name $([$unit $($symbol)?])? $(= $table_of)? $($about)?
                )
            },)*)*]
        };

        /// Namespace for the functions that read the values of the table.
        #[expect(non_camel_case_types, reason = "the type is named after the function")]
        enum $numbers {}

        impl $numbers {
            const READ: &[fn(&$state) -> $crate::vocabulary::quantity::Values] = &[$($(|state| {
                let read: fn(&$state) -> _ = $read;
                $crate::vocabulary::quantity::Read::values(read(state))
            },)*)*];
        }

        /// Returns the requested quantities of the table with their values.
        fn $numbers(
            state: &$state,
            wanted: impl Fn(&$crate::Quantity) -> bool,
        ) -> $crate::Numbers {
            $crate::Numbers::of($table, |place| <$numbers>::READ[place](state), wanted)
        }
    };
    (@said $of:ident $name:ident [$unit:literal $($symbol:literal)?] $about:literal) => {
        $crate::Quantity {
            name: stringify!($name),
            unit: $unit,
            symbol: concat!($($symbol)?),
            about: $about,
            columns: $crate::vocabulary::quantity::quantities!(@$of $name, $unit, $about),
            ..$crate::Quantity::WHOLE
        }
    };
    (@said Scalar $name:ident = $table_of:ident) => {{
        const SAID: $crate::Quantity = $crate::Quantity::with_short_meaning($table_of, stringify!($name));
        $crate::Quantity {
            columns: &[$crate::Output::of_table(SAID.name, SAID.unit, $crate::OutputType::Number, SAID.about, KIND)],
            ..SAID
        }
    }};
    (@needs) => { &[] };
    (@needs $known:ident) => { $known };
    (@needs [$($($need:ident)|+),+]) => { &[$($crate::InputSet::of(&[$($crate::InputKey::$need),+])),+] };
    (@kind) => { None };
    (@kind $analysis:ident) => { Some($crate::AnalysisKind::$analysis) };
    (@Scalar $($of:tt)*) => {
        $crate::vocabulary::quantity::quantities!(@columns Number ["" ""], ($($of)*))
    };
    (@Statement $($of:tt)*) => {
        $crate::vocabulary::quantity::quantities!(@columns Boolean ["" ""], ($($of)*))
    };
    (@Contacts $($of:tt)*) => {
        $crate::vocabulary::quantity::quantities!(
            @columns Number ["nut_" ", nut"] ["screw_" ", screw"] ["unloaded_flank_" ", far flank"], ($($of)*)
        )
    };
    (@Directions $($of:tt)*) => {
        $crate::vocabulary::quantity::quantities!(
            @columns Number ["rotary_to_linear_" ", rotary to linear"] ["linear_to_rotary_" ", linear to rotary"], ($($of)*)
        )
    };
    (@columns $type:ident $([$before:literal $where:literal])+, $of:tt) => {
        &[$($crate::vocabulary::quantity::quantities!(@column $type, $before, $where, $of)),+]
    };
    (@column $type:ident, $before:literal, $where:literal,
        ($name:ident, $unit:literal, $about:literal)) => {
        $crate::Output::of_table(
            concat!($before, stringify!($name)), $unit, $crate::OutputType::$type, concat!($about, $where), KIND
        )
    };
}

pub(crate) use quantities;

/// Name of an output. The macro [`output!`](crate::output) creates it and checks it at compile
/// time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct OutputName(pub(crate) &'static str);

impl OutputName {
    /// Returns the name, with its unit as a suffix.
    pub const fn name(self) -> &'static str {
        self.0
    }
}

impl From<&Output> for OutputName {
    fn from(output: &Output) -> Self {
        Self(output.name)
    }
}

/// A quantity with its values.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Quantity to which the values belong.
    pub quantity: &'static Quantity,
    /// Unit of the values as text. It differs from the unit of the quantity if the values are in
    /// displayed units.
    pub unit: &'static str,
    /// Values, in the order of the contacts or directions in the scope of the quantity.
    pub values: Values,
    /// 90 % intervals of those values that depend on an estimated groove.
    pub bands: [Option<Band>; 3],
}

/// A list of quantities with their values.
#[derive(Debug, Clone)]
pub struct Numbers {
    rows: Vec<Row>,
    /// Reason why some of the requested values are missing.
    reason: Option<String>,
    /// Names of quantities that are not shown on the screen.
    hidden: &'static [&'static str],
}

impl Numbers {
    /// Returns all quantities of a table. Only the requested quantities have values.
    ///
    /// * `read`: function that returns the values of the quantity with the given index.
    pub(crate) fn of(
        table: &'static [Quantity],
        read: impl Fn(usize) -> Values,
        wanted: impl Fn(&Quantity) -> bool,
    ) -> Self {
        let value = |(place, quantity)| {
            let values = if wanted(quantity) { read(place) } else { [None; 3] };
            Row { quantity, unit: quantity.unit, values, bands: [None; 3] }
        };
        Self { rows: table.iter().enumerate().map(value).collect(), reason: None, hidden: &[] }
    }

    /// Returns all quantities of a table without values.
    pub(crate) fn none(table: &'static [Quantity]) -> Self {
        Self::of(table, |_| [None; 3], |_| false)
    }

    /// Appends the quantities of `other` to this list.
    #[must_use]
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.rows.extend(other.rows);
        self
    }

    /// Keeps only the quantities that satisfy a condition.
    #[must_use]
    pub(crate) fn filter(mut self, wanted: impl Fn(&Quantity) -> bool) -> Self {
        self.rows.retain(|row| wanted(row.quantity));
        self
    }

    /// Returns all quantities, including quantities without values.
    pub fn all(&self) -> &[Row] {
        &self.rows
    }

    pub(crate) fn all_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    /// Returns the quantities that are shown on the screen and have a value.
    pub fn rows(&self) -> impl Iterator<Item = &Row> {
        let is_shown = |row: &&Row| !self.hidden.contains(&row.quantity.name);
        self.rows.iter().filter(is_shown).filter(|row| row.values.iter().any(Option::is_some))
    }

    /// Hides the quantities with the given names from the screen.
    #[must_use]
    pub(crate) fn with_hidden(self, hidden: &'static [&'static str]) -> Self {
        Self { hidden, ..self }
    }

    /// Returns all columns with their values.
    pub fn columns(&self) -> impl Iterator<Item = (&'static Output, Option<f64>)> {
        self.rows.iter().flat_map(|row| row.quantity.columns.iter().zip(row.values))
    }

    /// Returns the columns that have a value, each with its value.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Output, f64)> {
        self.columns().filter_map(|(column, value)| Some((column, value?)))
    }

    /// Returns the value of the output with the given name, or `None` if it is missing.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.columns().find(|(column, _)| column.name == name.name())?.1
    }

    /// Returns the value of an output, or `None` if the output does not belong to this list.
    /// True-or-false statements are returned as 1 and 0.
    pub fn value(&self, output: &Output) -> Option<f64> {
        self.number(output.into()).filter(|_| matches!(output.origin, Origin::Table { .. }))
    }

    /// Returns the reason why some of the requested values are missing.
    pub fn reason(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// Sets the reason why some of the requested values are missing.
    #[must_use]
    pub(crate) fn with_reason(self, reason: Option<String>) -> Self {
        Self { reason, ..self }
    }

    /// Removes all values that are not finite.
    #[must_use]
    pub(crate) fn where_finite(mut self) -> Self {
        for value in self.rows.iter_mut().flat_map(|row| &mut row.values) {
            *value = value.filter(|value| value.is_finite());
        }
        self
    }

    /// Returns the list unchanged if all its values are finite.
    ///
    /// # Errors
    /// Returns [`CaseError::Invalid`] with the name of the first quantity whose value is not
    /// finite.
    pub(crate) fn finite(self) -> Result<Self, CaseError> {
        let endless = self.entries().find(|(_, value)| !value.is_finite());
        match endless.map(|(column, _)| column.name) {
            Some(output) => Err(CaseError::beyond_double(output)),
            None => Ok(self),
        }
    }
}
