//! Names of the outputs of all answers, checked at compile time.

use serde::de::{Deserialize, Deserializer, Error};

use super::{design, jam, manufacturers, nut, optimum, ratings, selection, slip, warm, warnings};
use crate::answers::axis;
use crate::vocabulary::output::SOLUTION;
use crate::vocabulary::quantity::is_same;
use crate::{OutputName, Quantity};

/// All tables of quantities whose values are read by name.
const QUANTITY_TABLES: [&[Quantity]; 19] = [
    SOLUTION,
    axis::QUANTITIES,
    axis::PHASE,
    axis::SCREW,
    axis::TORQUES,
    design::STEPS,
    jam::QUANTITIES,
    manufacturers::COMPARED,
    nut::QUANTITIES,
    nut::BALLS,
    nut::CIRCUITS,
    optimum::QUANTITIES,
    optimum::BY_MODEL,
    ratings::QUANTITIES,
    ratings::AS_USED,
    selection::CATALOG,
    slip::QUANTITIES,
    warm::QUANTITIES,
    warnings::QUANTITIES,
];

impl OutputName {
    /// Checks that an output with the name `name` exists, and returns its [`OutputName`].
    ///
    /// # Panics
    ///
    /// Panics if there is no output with this name.
    pub const fn of(name: &str) -> Self {
        match Self::named(name) {
            Some(known) => known,
            None => panic!("no result has this name"),
        }
    }

    /// Returns the name of an output, or `None` if there is no output with this name.
    pub const fn named(name: &str) -> Option<Self> {
        let mut table = 0;
        while table < QUANTITY_TABLES.len() {
            let quantities = QUANTITY_TABLES[table];
            let mut place = 0;
            while place < quantities.len() {
                let columns = quantities[place].columns;
                let mut member = 0;
                while member < columns.len() {
                    if is_same(columns[member].name, name) {
                        return Some(Self(columns[member].name));
                    }
                    member += 1;
                }
                place += 1;
            }
            table += 1;
        }
        None
    }
}

impl<'de> Deserialize<'de> for OutputName {
    fn deserialize<D: Deserializer<'de>>(json: D) -> Result<Self, D::Error> {
        let name = String::deserialize(json)?;
        Self::named(&name).ok_or_else(|| D::Error::custom(format!("no output is named {name}")))
    }
}

/// Returns the [`OutputName`] of an output. An unknown name is a compile error.
///
/// ```
/// assert_eq!(bsm_case::output!(cycle_life_h).name(), "cycle_life_h");
/// ```
///
/// ```compile_fail
/// bsm_case::output!(cycle_lief_h);
/// ```
#[macro_export]
macro_rules! output {
    ($name:ident) => {
        const { $crate::OutputName::of(stringify!($name)) }
    };
}
