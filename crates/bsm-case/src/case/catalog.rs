//! Catalog of nuts: lists of sizes, and limits for their combinations.

use bsm_design::Range;
use bsm_design::catalog::{Candidate, Limits, Lists, OfferedSize, Size, front};
use bsm_dyn::{Material, Materials};
use serde_json::{Map, Value};

use crate::case::catalog_keys::ListKey;
use crate::case::manufacturer_sizes::{SizeSource, SizeTable, offered_sizes, read_sizes};
use crate::vocabulary::cells::Cells;
use crate::vocabulary::error;
use crate::vocabulary::units::{DEG, GPA, MM, UM};
use crate::{CaseError, LISTS, NameKind, TableFormat, entries, nearest};

/// Standard lists and limits as JSON text, which users can copy and edit.
pub const STANDARD_CATALOG: &str = include_str!("catalog.json");

/// Maximum number of combinations of the listed sizes.
const MAX_COMBINATIONS: usize = 20_000_000;

/// Conformity that is assumed for manufacturers' nuts, because manufacturers' catalogs do not state
/// it.
const MANUFACTURER_CONFORMITY: f64 = 0.52;

/// Number of nuts that are compared in one pass of the Pareto selection.
const CHUNK: usize = 1 << 16;

/// Lists of sizes, and the limits that a combination of sizes must meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalog {
    /// Lists of sizes that are combined.
    pub lists: Lists,
    /// Limits for combinations of sizes.
    pub limits: Limits,
    /// Source of each row of a table of sizes; empty for lists that are combined.
    pub sources: Vec<SizeSource>,
}

impl Catalog {
    /// Returns the standard lists of ISO 3408-2, the standard ball diameters, and the limits of
    /// Sobolewski (2002).
    ///
    /// # Errors
    /// This function does not fail in practice, because the lists are compiled into the program.
    pub fn standard() -> Result<Self, CaseError> {
        Self::from_json(b"{}")
    }

    /// Returns the sizes that THK and HIWIN offer, with the limits and the contact angle of the
    /// standard lists.
    ///
    /// # Errors
    /// Does not fail in practice, because the sizes are compiled into the program.
    pub fn manufacturers() -> Result<Self, CaseError> {
        Self::of_sizes(offered_sizes())
    }

    /// Reads a table of sizes with the columns of
    /// [`MANUFACTURER_SIZES`](crate::MANUFACTURER_SIZES). Returns `None` if the table has no column
    /// `turns`, which means that it is a table of nuts.
    ///
    /// # Errors
    ///
    /// Returns a [`CaseError`] that names the row or the column that is invalid.
    pub fn from_csv(table: &[u8], format: &TableFormat) -> Result<Option<Self>, CaseError> {
        let has_turns = |head: &String| format.input_of(head) == Some("turns");
        if !Cells::read(table, format)?.heads().iter().any(has_turns) {
            return Ok(None);
        }
        Self::of_sizes(&read_sizes(table, format)?).map(Some)
    }

    fn of_sizes(SizeTable { sizes, sources }: &SizeTable) -> Result<Self, CaseError> {
        let mut all_sizes = Self::standard()?;
        all_sizes.sources.clone_from(sources);
        let Self { lists, limits, .. } = &mut all_sizes;
        lists.offered.clone_from(sizes);
        let all = |number: fn(&OfferedSize) -> f64| {
            let mut all: Vec<_> = lists.offered.iter().map(number).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        lists.diameters = all(|size| size.diameter);
        lists.leads = all(|size| size.lead);
        lists.balls = all(|size| size.ball);
        lists.turns = all(|size| size.turns);
        lists.conformities = vec![MANUFACTURER_CONFORMITY];
        limits.turns = Range { low: 1.0, high: f64::INFINITY };
        Ok(all_sizes)
    }

    /// Reads lists and limits from JSON text. Missing keys default to the standard values.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for syntax errors, unknown keys, values out of range, or too many
    /// combinations.
    pub fn from_json(json: &[u8]) -> Result<Self, CaseError> {
        Self::from_entries(entries(json)?)
    }

    /// Works like [`from_json`](Self::from_json), but takes the members of the JSON object.
    ///
    /// # Errors
    /// Returns the same errors as [`from_json`](Self::from_json), except for syntax errors.
    pub fn from_entries(
        entries: impl IntoIterator<Item = (String, Value)>,
    ) -> Result<Self, CaseError> {
        let mut given = ListEntries::standard()?;
        for (key, value) in entries {
            given.set(&key, &value)?;
        }
        given.catalog()
    }

    /// Returns the source of a size, or `None` if the size is a combination of lists.
    pub fn source_of(&self, size: &Size) -> Option<&SizeSource> {
        self.sources.get(size.offered?.row)
    }

    /// Returns the indices of all combinations that meet the limits, in the order of the lists. An
    /// index takes only one sixtieth of the memory of a nut, so each nut is created only when it is
    /// needed.
    pub fn indices(&self) -> Vec<u32> {
        self.lists.indices(&self.limits)
    }

    /// Calls `each` with every nut in `indices` and returns the results that are not `None`, in the
    /// same order.
    pub fn map<R: Send>(
        &self,
        indices: &[u32],
        each: impl Fn(u32, &Candidate) -> Option<R> + Sync + Send,
    ) -> Vec<R> {
        self.lists.map(&self.limits, indices, each)
    }

    /// Returns the indices of the nuts that are Pareto-optimal with respect to dynamic load rating,
    /// stiffness and mass.
    #[must_use]
    pub fn pareto(&self, indices: &[u32]) -> Vec<u32> {
        let mut best: Vec<(u32, [f64; 3])> = Vec::new();
        // A nut that is dominated by another nut of its chunk cannot be Pareto-optimal in the whole
        // list.
        for part in indices.chunks(CHUNK) {
            best.extend(self.map(part, |index, nut| Some((index, nut.costs()))));
            let costs: Vec<_> = best.iter().map(|(_, costs)| *costs).collect();
            best = front(&costs).into_iter().map(|i| best[i]).collect();
        }
        best.into_iter().map(|(index, _)| index).collect()
    }
}

/// Numbers of a catalog key.
struct ListEntry {
    numbers: Vec<f64>,
    /// True for a list of numbers and for a range, false for a single number.
    is_list: bool,
}

/// Complete set of lists, ranges and numbers, in the order of [`LISTS`].
struct ListEntries([ListEntry; LISTS.len()]);

impl ListEntries {
    /// Reads the standard catalog.
    fn standard() -> Result<Self, CaseError> {
        let standard: Map<String, Value> =
            serde_json::from_str(STANDARD_CATALOG).map_err(CaseError::Syntax)?;
        Ok(Self(ListKey::ALL.map(|key| {
            let value = &standard[key.quantity().name];
            let numbers = value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice);
            ListEntry {
                numbers: numbers.iter().filter_map(Value::as_f64).collect(),
                is_list: value.is_array(),
            }
        })))
    }

    fn set(&mut self, name: &str, value: &Value) -> Result<(), CaseError> {
        let Some(key) = ListKey::from_name(name) else {
            let names = LISTS.iter().map(|list| list.name);
            return Err(CaseError::unknown(NameKind::List, name, nearest(name, names)));
        };
        let invalid_input = |what: &str| error::invalid_input(name, what);
        let entry = &mut self.0[key as usize];
        let numbers = match value {
            Value::Array(list) if entry.is_list => list.as_slice(),
            one if !entry.is_list => std::slice::from_ref(one),
            _ => return Err(invalid_input("must be a list of numbers")),
        };
        let numbers: Option<Vec<_>> = numbers.iter().map(Value::as_f64).collect();
        let numbers =
            numbers.ok_or_else(|| invalid_input("contains an entry that is not a number"))?;
        for number in &numbers {
            key.quantity().rule.check(name, *number)?;
        }
        let is_range = name.ends_with("_range");
        match numbers[..] {
            [] => return Err(invalid_input("must not be empty")),
            [low, high] if is_range && low <= high => {}
            _ if is_range => {
                return Err(invalid_input("must consist of a smallest and a largest value"));
            }
            _ => {}
        }
        entry.numbers = numbers;
        Ok(())
    }

    /// Returns the numbers of a key, converted to SI units.
    fn all(&self, key: ListKey, unit: f64) -> Vec<f64> {
        self.0[key as usize].numbers.iter().map(|number| number * unit).collect()
    }

    fn number(&self, key: ListKey, unit: f64) -> f64 {
        self.0[key as usize].numbers[0] * unit
    }

    fn range(&self, key: ListKey) -> Range {
        let numbers = &self.0[key as usize].numbers;
        Range { low: numbers[0], high: numbers[numbers.len() - 1] }
    }

    fn catalog(&self) -> Result<Catalog, CaseError> {
        use ListKey as K;
        let lists = Lists {
            diameters: self.all(K::nominal_diameter_mm, MM),
            leads: self.all(K::lead_mm, MM),
            balls: self.all(K::ball_diameter_mm, MM),
            turns: self.all(K::loaded_turns, 1.0),
            conformities: self.all(K::nut_conformity, 1.0),
            contact_angles: self.all(K::contact_angle_deg, DEG),
            offered: Vec::new(),
        };
        if lists.len() > MAX_COMBINATIONS {
            return Err(CaseError::grid_too_large(MAX_COMBINATIONS));
        }
        let steel = Material {
            youngs_modulus: self.number(K::youngs_modulus_GPa, GPA),
            poisson_ratio: self.number(K::poisson_ratio, 1.0),
        };
        let limits = Limits {
            ball_over_lead: self.number(K::largest_ball_over_lead, 1.0),
            least_ball_over_lead: self.number(K::smallest_ball_over_lead, 1.0),
            ball_over_diameter: self.range(K::ball_over_diameter_range),
            ball_over_root: self.number(K::largest_ball_over_screw_root, 1.0),
            ball_gap: self.number(K::largest_ball_gap_over_ball, 1.0),
            axial_play: self.number(K::axial_play_um, UM),
            turns: self.range(K::turns_range),
            conformity: self.range(K::nut_conformity_range),
            material: Materials::alike(steel),
            preload: self.number(K::preload_over_dynamic_rating, 1.0),
            rolling_lever: self.number(K::rolling_friction_mm, MM),
        };
        Ok(Catalog { lists, limits, sources: Vec::new() })
    }
}
