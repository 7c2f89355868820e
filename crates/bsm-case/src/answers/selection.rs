//! Selection of nuts from lists, based on conditions that the nuts must meet.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};

use bsm_design::Nut;
use bsm_design::catalog::Candidate;
use bsm_design::statistics::Band;
use bsm_dyn::Materials;
use serde_json::{Map, Value, json};

use super::manufacturers::{ListNumber, ManufacturerRow, OwnCell};
use super::ratings::QUANTITIES as RATINGS;
use crate::case::catalog_keys::LISTS;
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::column_values::ColumnValues;
use crate::vocabulary::number::{decimal, format_number, format_trimmed};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, GPA, MM, UM, UnitChange, convert};
use crate::{
    AnalysisKind, Answer, CaseError, Catalog, Column, Content, DesignReport, DisplayUnits, INPUTS,
    InputKey, NameKind, Output, RequirementFile, ShownColumn, Table, nearest, sheet_columns,
};

quantities! {
    /// Columns of a list of nuts. Hidden columns are written only to files.
    pub CATALOG, read(&Candidate);
    "" {
        nominal_diameter_mm = LISTS Scalar(|c| decimal(c.size.diameter / MM));
        lead_mm = INPUTS Scalar(|c| decimal(c.nut.lead / MM));
        ball_diameter_mm = INPUTS Scalar(|c| decimal(c.nut.ball_diameter / MM));
        loaded_turns = INPUTS Scalar(|c| c.nut.turns);
        nut_conformity = INPUTS Scalar(|c| c.nut.conformity.nut);
    }
    hidden {
        screw_conformity = INPUTS Scalar(|c| c.nut.conformity.screw);
        contact_angle_deg = INPUTS Scalar(|c| decimal(c.nut.contact_angle / DEG));
        pitch_circle_diameter_mm = INPUTS Scalar(|c| c.nut.pitch_diameter / MM);
        loaded_balls_per_turn = INPUTS Scalar(|c| c.nut.balls_per_turn);
        starts = INPUTS Scalar(|c| c.nut.starts);
    }
    "" {
        dynamic_load_rating_N = RATINGS Scalar(|c| c.dynamic_rating);
        static_load_rating_N = RATINGS Scalar(|c| c.static_rating);
    }
    hidden {
        edge_load_N = RATINGS Scalar(|c| c.edge_load);
        stiffness_characteristic_N_um15 = RATINGS Scalar(|c| c.elasticity.turn_constant * 1e-9);
        preload_N = INPUTS Scalar(|c| c.preload);
        preloaded_contact_stiffness_N_um = RATINGS Scalar(|c| c.elasticity.preloaded(c.preload) * UM);
        preloaded_body_stiffness_N_um = RATINGS Scalar(|c| 2.0 * c.elasticity.body * UM);
    }
    "" {
        preloaded_stiffness_N_um = RATINGS Scalar(|c| c.stiffness * UM);
    }
    hidden {
        nut_outer_diameter_mm = INPUTS Scalar(|c| c.body.outer / MM);
        nut_length_mm = INPUTS Scalar(|c| c.body.length / MM);
    }
    "" {
        nut_mass_kg = INPUTS Scalar(|c| c.mass);
        rolling_efficiency = RATINGS Scalar(|c| c.efficiency);
    }
    hidden {
        clearance_per_turn_mm = RATINGS Scalar(|c| c.nut.ball_gap() / MM);
        axial_play_um = INPUTS Scalar(|c| c.thread.play / UM);
        nut_groove_radius_mm = RATINGS Scalar(|c| c.thread.nut.radius / MM);
        screw_groove_radius_mm = RATINGS Scalar(|c| c.thread.screw.radius / MM);
        nut_groove_offset_mm = RATINGS Scalar(|c| c.thread.nut.offset / MM);
        screw_groove_offset_mm = RATINGS Scalar(|c| c.thread.screw.offset / MM);
        nut_core_diameter_mm = RATINGS Scalar(|c| c.thread.nut.core / MM);
        screw_core_diameter_mm = RATINGS Scalar(|c| c.thread.screw.core / MM);
        nut_root_diameter_mm = RATINGS Scalar(|c| c.thread.nut.root / MM);
        screw_root_diameter_mm = RATINGS Scalar(|c| c.thread.screw.root / MM);
        nut_bore_mm = INPUTS Scalar(|c| c.thread.nut.land / MM);
        screw_outer_diameter_mm = INPUTS Scalar(|c| c.thread.screw.land / MM);
    }
}

/// A numeric column of a list of nuts.
#[derive(Debug, Clone)]
pub struct ListColumn {
    place: usize,
    /// Name of the column, with its unit as a suffix.
    pub name: Cow<'static, str>,
    /// Unit of the column as text; empty for a column that the program does not know.
    pub unit: &'static str,
    /// Meaning of the column.
    pub about: &'static str,
    is_of_sheet: bool,
    is_shown: bool,
}

impl ListColumn {
    /// Returns the columns of a list of sizes, including the columns of the axis sheet if
    /// `has_sheets` is true.
    pub fn of_sizes(has_sheets: bool) -> Vec<Self> {
        let of_nut = CATALOG.iter().flat_map(|quantity| {
            quantity.columns.iter().map(|output| (output, quantity.is_hidden))
        });
        let of_nut = of_nut.map(|(output, is_hidden)| (output, false, !is_hidden));
        let of_sheet = sheet_columns().filter(|_| has_sheets);
        let is_warm = |output: &Output| output.analysis() == Some(AnalysisKind::Warm);
        let all = of_nut.chain(of_sheet.map(|output| (output, true, !is_warm(output))));
        all.enumerate()
            .map(|(place, (output, is_of_sheet, is_shown))| Self {
                is_of_sheet,
                is_shown,
                ..Self::of_output(place, output)
            })
            .collect()
    }

    /// Returns the columns of a manufacturer's table, followed by the numeric columns that the
    /// program does not know, such as a price. The screen does not show the columns of inputs.
    pub fn of_rows(rows: &[ManufacturerRow]) -> Vec<Self> {
        let Some(first) = rows.first() else { return Vec::new() };
        let column = |(place, number): (usize, &ListNumber)| {
            let output = number.column;
            Self { is_shown: !output.is_input(), ..Self::of_output(place, output) }
        };
        let own = |(place, own): (usize, &OwnCell)| Self {
            place: first.numbers.len() + place,
            name: own.name.clone().into(),
            unit: "",
            about: "column of the table that has no effect on the calculation",
            is_of_sheet: false,
            is_shown: true,
        };
        let numbers = first.numbers.iter().enumerate().map(column);
        let is_numeric = |(_, own): &(usize, &OwnCell)| own.is_numeric();
        numbers.chain(first.own.iter().enumerate().filter(is_numeric).map(own)).collect()
    }

    fn of_output(place: usize, output: &'static Output) -> Self {
        Self {
            place,
            name: output.name.into(),
            unit: output.unit,
            about: output.about,
            is_of_sheet: false,
            is_shown: true,
        }
    }

    /// Returns the column to which a name refers, and the conversion to the unit of the column. The
    /// name may end with a different unit than the column.
    fn named(name: &str, all: &[Self]) -> Result<(Self, UnitChange), CaseError> {
        let names = || all.iter().map(|column| column.name.as_ref());
        let column = |name: &str| all.iter().find(|column| column.name == name).cloned();
        let found = column(name).map(|column| (column, UnitChange::NONE)).or_else(|| {
            let (own, change) = convert(name, names())?;
            Some((column(own)?, change))
        });
        found.ok_or_else(|| {
            if ManufacturerRow::is_text(name) {
                return CaseError::Invalid(format!(
                    "`{name}` is a column of text in a manufacturer's table (--from TABLE.csv), but conditions and sorting need a column \
                     of numbers. Nuts that pass all rules always come first"
                ));
            }
            CaseError::unknown(NameKind::Column, name, nearest(name, names()))
        })
    }

    /// Returns true if the column belongs to the axis sheet.
    pub fn is_of_sheet(&self) -> bool {
        self.is_of_sheet
    }

    fn read(&self, nut: &Candidate, sheet: &[f64]) -> f64 {
        match self.place.checked_sub(CATALOG.len()) {
            Some(place) => sheet[place],
            None => read::READ[self.place](nut)[0].unwrap_or(f64::NAN),
        }
    }
}

/// A condition on a column, stored as the range of permitted values.
#[derive(Debug, Clone)]
pub struct Condition {
    text: String,
    column: ListColumn,
    range: RangeInclusive<f64>,
}

impl Condition {
    /// Parses `name>=value`, `name<=value` or `name=value`. The name may end with a different unit
    /// than the column.
    ///
    /// * `columns`: columns of the list to which the condition applies.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the text is not a valid condition, the column is unknown, or the
    /// value is not a number.
    pub fn parse(text: &str, columns: &[ListColumn]) -> Result<Self, CaseError> {
        let form = "name>=number, name<=number or name=number";
        let malformed = || CaseError::bad_setting(text, form);
        let at = text.find(['<', '>', '=']).ok_or_else(malformed)?;
        let sign = if text[at..].starts_with('=') {
            "="
        } else {
            text.get(at..at + 2).ok_or_else(malformed)?
        };
        if !["<=", ">=", "="].contains(&sign) {
            return Err(malformed());
        }
        let (column, change) = ListColumn::named(text[..at].trim(), columns)?;
        let given = text[at + sign.len()..].trim();
        let value: f64 = given.parse().unwrap_or(f64::NAN);
        if value.is_nan() {
            let why =
                format!("in `{text}`, `{given}` is not a number; a condition has the form {form}");
            return Err(CaseError::Invalid(why));
        }
        let value = change.value(value);
        // The tolerance allows for rounding errors, because tables contain decimal numbers and
        // sizes are stored in meters.
        let near = 1e-9 * value.abs();
        let range = match sign {
            ">=" => value - near..=f64::INFINITY,
            "<=" => f64::NEG_INFINITY..=value + near,
            _ => value - near..=value + near,
        };
        Ok(Self { text: text.to_owned(), column, range })
    }

    /// Returns true if a nut meets the condition.
    ///
    /// * `sheet`: results for the nut on its axis sheet.
    pub fn is_met(&self, nut: &Candidate, sheet: &[f64]) -> bool {
        self.range.contains(&self.column.read(nut, sheet))
    }

    /// Returns the value that comes closest to meeting the condition, or `None` if there are no
    /// values.
    fn nearest_of(&self, values: &[f64]) -> Option<f64> {
        let miss = |value: f64| (self.range.start() - value).max(value - self.range.end());
        values.iter().copied().min_by(|a, b| miss(*a).total_cmp(&miss(*b)))
    }
}

/// Converts a nut to a JSON object whose keys are the names of the columns.
pub fn candidate_json(candidate: &Candidate) -> Map<String, Value> {
    numbers_json(&read(candidate, |_| true))
}

/// Converts a nut to a case that other commands can read. If a requirement is given, the case has
/// the operating point of the requirement.
pub fn candidate_case(candidate: &Candidate, requirement: Option<&RequirementFile>) -> Value {
    if let Some(requirement) = requirement {
        return requirement.case_of(candidate).to_json();
    }
    let mut nut = candidate_json(candidate);
    // The mass follows from the sizes, so it must not become an input.
    let is_size = |name: &str| name != InputKey::nut_mass_kg.name();
    nut.retain(|name, _| is_size(name) && INPUTS.iter().any(|input| input.name == name));
    for number in nut.values_mut() {
        *number = json!(number.as_f64().map(decimal));
    }
    let Nut { starts, material: Materials { raceways, ball: _ }, .. } = candidate.nut;
    if starts > 1.0 {
        nut.insert("circuits_count".to_owned(), json!(starts));
    }
    nut.insert("youngs_modulus_GPa".to_owned(), json!(raceways.youngs_modulus / GPA));
    nut.insert("poisson_ratio".to_owned(), json!(raceways.poisson_ratio));
    Value::Object(nut)
}

/// Conditions that nuts must meet in addition to a requirement, and the order in which the nuts are
/// sorted.
#[derive(Debug, Clone, Default)]
pub struct NutFilter {
    of_nut: Vec<Condition>,
    of_sheet: Vec<Condition>,
    order: Option<(ListColumn, bool)>,
    pareto: bool,
}

impl NutFilter {
    /// Creates a filter from conditions such as `lead_mm=20`.
    ///
    /// * `columns`: columns of the list to which the filter applies.
    /// * `pareto`: if true, keeps only the Pareto-optimal nuts with respect to dynamic load rating,
    ///   stiffness and mass.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if a condition is not of this form or names an unknown column.
    pub fn new(
        conditions: &[String],
        columns: &[ListColumn],
        pareto: bool,
    ) -> Result<Self, CaseError> {
        let mut wanted = Self { pareto, ..Self::default() };
        for text in conditions {
            let condition = Condition::parse(text, columns)?;
            let is_of_sheet = condition.column.is_of_sheet();
            if is_of_sheet { &mut wanted.of_sheet } else { &mut wanted.of_nut }.push(condition);
        }
        Ok(wanted)
    }

    /// Adds a sort order by a column to the filter.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Unknown`] for an unknown column.
    pub fn sorted_by(
        self,
        name: &str,
        descending: bool,
        columns: &[ListColumn],
    ) -> Result<Self, CaseError> {
        let (column, _) = ListColumn::named(name, columns)?;
        Ok(Self { order: Some((column, descending)), ..self })
    }

    /// Returns the indices of the columns that occur in the conditions or in the sort order.
    fn named_columns(&self) -> Vec<usize> {
        let conditions = self.of_nut.iter().chain(&self.of_sheet);
        let of_conditions = conditions.map(|condition| condition.column.place);
        of_conditions.chain(self.order.as_ref().map(|(column, _)| column.place)).collect()
    }

    /// Returns the rows of a manufacturer's table that meet the conditions. Rows that pass a
    /// requirement come first.
    pub fn choose_rows(&self, rows: Vec<ManufacturerRow>) -> NutList {
        let places = || 0..u32::try_from(rows.len()).unwrap_or(u32::MAX);
        let number = |place: u32, column: &ListColumn| rows[place as usize].number_at(column.place);
        let meets = |place: &u32| {
            self.of_nut.iter().all(|condition| {
                number(*place, &condition.column)
                    .is_some_and(|value| condition.range.contains(&value))
            })
        };
        let within: Vec<_> = places().filter(meets).collect();
        let mut chosen = if self.pareto {
            ManufacturerRow::pareto_front(&rows, &within)
        } else {
            within.clone()
        };
        if let Some((column, descending)) = &self.order {
            // A row without a value in the sort column comes last, both in ascending and in
            // descending order.
            chosen.sort_by(|a, b| {
                let verdict = |place: &u32| rows[*place as usize].verdict;
                let [one, other] = [a, b].map(|place| number(*place, column));
                let ordered = match (one, other) {
                    (Some(one), Some(other)) if *descending => other.total_cmp(&one),
                    (Some(one), Some(other)) => one.total_cmp(&other),
                    (one, other) => other.is_some().cmp(&one.is_some()),
                };
                verdict(b).cmp(&verdict(a)).then(ordered)
            });
        }
        let near = |condition: &Condition| {
            let values: Vec<_> =
                places().filter_map(|place| number(place, &condition.column)).collect();
            let value = condition.nearest_of(&values);
            let value = value.map_or_else(
                || "has no value".to_owned(),
                |value| format!("has {}", format_trimmed(value)),
            );
            format!("{}: the nearest of {} nuts {value}", condition.text, rows.len())
        };
        let why =
            if within.is_empty() { self.of_nut.iter().map(near).collect() } else { Vec::new() };
        NutList {
            columns: ListColumn::of_rows(&rows),
            all: rows.len(),
            within,
            chosen,
            named: self.named_columns(),
            reasons: why,
            warnings: Vec::new(),
            rows: Rows::Table(rows),
        }
    }

    /// Returns the nuts of a catalog that meet the conditions and the requirement.
    pub fn choose(&self, catalog: Catalog, requirement: Option<&RequirementFile>) -> NutList {
        let catalog = match requirement {
            Some(requirement) => requirement.with_its_material(catalog),
            None => catalog,
        };
        let requirement = requirement.map(|requirement| requirement.within(&catalog));
        let requirement = requirement.as_ref();
        let all = catalog.indices();
        let keeps =
            |nut: &Candidate| requirement.is_none_or(|requirement| requirement.is_met_by(&nut.nut));
        let meets = |nut: &Candidate| self.of_nut.iter().all(|c| c.is_met(nut, &[])) && keeps(nut);
        let within = catalog.map(&all, |place, nut| meets(nut).then_some(place));
        let mut found = Found { within, ..Found::default() };
        if found.within.is_empty() {
            found.reasons = match requirement {
                _ if all.is_empty() => vec![NO_COMBINATION.to_owned()],
                Some(requirement) if self.of_nut.is_empty() => {
                    blocking_limits(requirement, &catalog)
                }
                _ => {
                    let mut reasons = self.nearest(&catalog, &all, keeps);
                    let limits =
                        requirement.map(|requirement| blocking_limits(requirement, &catalog));
                    reasons.extend(limits.into_iter().flatten());
                    reasons
                }
            };
            return self.list(catalog, all.len(), requirement.is_some(), found);
        }
        if let Some(requirement) = requirement {
            self.check_axis_sheets(requirement, &catalog, &mut found);
        }
        found.chosen =
            if self.pareto { catalog.pareto(&found.within) } else { found.within.clone() };
        if let Some((column, descending)) = &self.order {
            let key = |place, nut: &Candidate| Some((column.read(nut, found.sheet(place)), place));
            let mut keys = catalog.map(&found.chosen, key);
            keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            if *descending {
                keys.reverse();
            }
            found.chosen = keys.into_iter().map(|(_, place)| place).collect();
        }
        let first = found.chosen.get(..1).unwrap_or_default();
        let first = catalog.map(first, |_, nut| Some(*nut));
        if let (Some(nut), Some(requirement)) = (first.first(), requirement)
            && let Ok(sheet) = requirement.axis_sheet(&requirement.case_of(nut))
        {
            found.warnings = sheet.answer.warnings;
        }
        self.list(catalog, all.len(), requirement.is_some(), found)
    }

    /// Creates the list of nuts from the sizes that the catalog search found.
    fn list(&self, catalog: Catalog, all: usize, has_sheets: bool, found: Found) -> NutList {
        let Found { within, chosen, sheets, reasons, warnings } = found;
        NutList {
            columns: ListColumn::of_sizes(has_sheets),
            all,
            within,
            chosen,
            reasons,
            warnings,
            named: self.named_columns(),
            rows: Rows::Sizes { catalog, sheets },
        }
    }

    /// Calculates the axis sheets of the found sizes, and keeps only the sizes that meet the
    /// conditions on columns of the axis sheet.
    fn check_axis_sheets(
        &self,
        requirement: &RequirementFile,
        catalog: &Catalog,
        found: &mut Found,
    ) {
        let sheet = |place, nut: &Candidate| Some((place, *nut, requirement.sheet_of(nut)?));
        let sheets = catalog.map(&found.within, sheet);
        let meets_sheet =
            |nut: &Candidate, sheet: &[f64]| self.of_sheet.iter().all(|c| c.is_met(nut, sheet));
        found.within = sheets
            .iter()
            .filter(|(_, nut, sheet)| meets_sheet(nut, sheet))
            .map(|(place, ..)| *place)
            .collect();
        if found.within.is_empty() && sheets.is_empty() {
            found.reasons = blocking_limits(requirement, catalog);
        } else if found.within.is_empty() {
            let near = |condition: &Condition| {
                let values: Vec<_> = sheets
                    .iter()
                    .map(|(_, nut, sheet)| condition.column.read(nut, sheet))
                    .collect();
                let value = condition.nearest_of(&values).map_or_else(String::new, format_number);
                format!("{}: the nearest of {} nuts has {value}", condition.text, values.len())
            };
            found.reasons = self.of_sheet.iter().map(near).collect();
        }
        found.sheets = sheets.into_iter().map(|(place, _, sheet)| (place, sheet)).collect();
    }

    /// Returns reasons why no nut meets all conditions. The reason for a condition states how many
    /// nuts meet all other conditions, and which value of these nuts is closest to the condition.
    ///
    /// * `keeps`: function that returns true for the nuts that meet the requirement.
    fn nearest(
        &self,
        catalog: &Catalog,
        all: &[u32],
        keeps: impl Fn(&Candidate) -> bool + Sync,
    ) -> Vec<String> {
        let without = |(i, condition): (usize, &Condition)| {
            let others = |nut: &Candidate| {
                let mut conditions = self.of_nut.iter().enumerate();
                keeps(nut) && conditions.all(|(j, c)| j == i || c.is_met(nut, &[]))
            };
            let read = |nut: &Candidate| condition.column.read(nut, &[]);
            let rest = catalog.map(all, |_, nut| others(nut).then(|| read(nut)));
            let text = &condition.text;
            match condition.nearest_of(&rest) {
                Some(value) => {
                    let (nuts, value) = (rest.len(), format_number(value));
                    format!(
                        "without {text}, {nuts} nuts remain; the value closest to this condition is {value}"
                    )
                }
                None => format!("even without {text}, no nut remains"),
            }
        };
        let count = format!("none of the {} nuts in the list meets all conditions", all.len());
        let reasons = self.of_nut.iter().enumerate().map(without);
        std::iter::once(count).chain(reasons).collect()
    }
}

/// Returns the limits of a requirement that no nut in the catalog meets.
fn blocking_limits(requirement: &RequirementFile, catalog: &Catalog) -> Vec<String> {
    match DesignReport::standard(requirement, catalog) {
        Some(report) => report.reasons,
        None => vec![NO_SIZE.to_owned()],
    }
}

const NO_COMBINATION: &str = "no combination of the lists is within the limits (turns_range, nut_conformity_range, \
                              largest_ball_over_lead, largest_ball_over_screw_root), or no ball fits between the lands";
const NO_SIZE: &str = "no listed size has the lead, lead angle or diameter that the requirement specifies; without \
                       lists, sizes are not restricted";

/// Sizes that were found in a catalog.
#[derive(Default)]
struct Found {
    within: Vec<u32>,
    chosen: Vec<u32>,
    sheets: BTreeMap<u32, Vec<f64>>,
    reasons: Vec<String>,
    warnings: Vec<String>,
}

impl Found {
    fn sheet(&self, place: u32) -> &[f64] {
        self.sheets.get(&place).map_or(&[], Vec::as_slice)
    }
}

/// Source of the nuts in a list.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a list contains only one value of this type")]
enum Rows {
    /// Standard sizes. `sheets` maps the index of each size that meets the requirement to the
    /// values on its axis sheet.
    Sizes { catalog: Catalog, sheets: BTreeMap<u32, Vec<f64>> },
    /// Rows of a manufacturer's table.
    Table(Vec<ManufacturerRow>),
}

/// A list of selected nuts.
#[derive(Debug, Clone)]
pub struct NutList {
    /// Number of nuts from which the selection was made.
    pub all: usize,
    /// Indices of the nuts that meet the conditions and the requirement.
    pub within: Vec<u32>,
    /// Indices of the selected nuts in sorted order. If requested, only the Pareto-optimal nuts are
    /// selected.
    pub chosen: Vec<u32>,
    /// Reasons why no nut was selected.
    pub reasons: Vec<String>,
    /// Warnings from the axis sheet of the first nut.
    pub warnings: Vec<String>,
    columns: Vec<ListColumn>,
    /// Indices of the columns that occur in the conditions or in the sort order.
    named: Vec<usize>,
    rows: Rows,
}

impl NutList {
    /// Returns the columns of the list.
    pub fn columns(&self) -> &[ListColumn] {
        &self.columns
    }

    /// Returns the catalog, or `None` if the nuts come from a manufacturer's table.
    pub fn catalog(&self) -> Option<&Catalog> {
        match &self.rows {
            Rows::Sizes { catalog, .. } => Some(catalog),
            Rows::Table(_) => None,
        }
    }

    /// Converts a nut to a case that other commands can read. If a requirement is given, the case
    /// has the operating point of the requirement.
    pub fn case(&self, place: u32, requirement: Option<&RequirementFile>) -> Value {
        match &self.rows {
            Rows::Sizes { catalog, .. } => {
                let nut = catalog.map(&[place], |_, nut| Some(*nut));
                nut.first().map_or(Value::Null, |nut| candidate_case(nut, requirement))
            }
            Rows::Table(rows) => rows[place as usize].case.to_json(),
        }
    }

    /// Selects the displayed columns (see [`ShownColumn::select`]).
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for a name that is not a column of this list.
    pub fn select(
        &self,
        wanted: Option<&[String]>,
        display: DisplayUnits,
    ) -> Result<Vec<ShownColumn>, CaseError> {
        let is_of_tables = |name: &&String| ManufacturerRow::is_text(name);
        let missing = wanted.into_iter().flatten().find(is_of_tables);
        if let (Rows::Sizes { .. }, Some(name)) = (&self.rows, missing) {
            return Err(CaseError::Invalid(format!(
                "`{name}` is a column only of a manufacturer's table (--from TABLE.csv). A list of sizes contains only nuts that meet the requirement; \
                 `bsm select --show columns` lists all its columns"
            )));
        }
        ShownColumn::select(&self.heads(), wanted, display)
    }

    /// Returns the name and the unit of each column.
    pub fn heads(&self) -> Vec<(String, &'static str)> {
        match &self.rows {
            Rows::Sizes { .. } => {
                let head = |column: &ListColumn| (column.name.clone().into_owned(), column.unit);
                self.columns.iter().map(head).collect()
            }
            Rows::Table(_) => {
                let table = ManufacturerRow::table(&self.rows_of(&self.chosen));
                table.into_iter().map(|(name, unit, _)| (name, unit)).collect()
            }
        }
    }

    /// Returns the values of all columns, column by column, for a range of the selected nuts.
    ///
    /// * `places`: range of positions in the list.
    pub fn values(&self, places: Range<usize>) -> Vec<ColumnValues> {
        let chosen = &self.chosen[places.clone()];
        match &self.rows {
            Rows::Sizes { catalog, sheets } => {
                let of = |place| sheets.get(&place).map_or(&[][..], Vec::as_slice);
                let rows = catalog.map(chosen, |place, nut| Some((*nut, of(place))));
                let values = |column: &ListColumn| {
                    ColumnValues::Numbers(
                        rows.iter().map(|(nut, sheet)| column.read(nut, sheet)).collect(),
                    )
                };
                self.columns.iter().map(values).collect()
            }
            // The table is built from all rows, because an interval in any row adds columns to the
            // table.
            Rows::Table(_) => {
                let table = ManufacturerRow::table(&self.rows_of(&self.chosen));
                table.into_iter().map(|(.., values)| values.part(places.clone())).collect()
            }
        }
    }

    /// Returns the rows of a manufacturer's table that meet the conditions. For a list of sizes,
    /// the result is empty.
    pub fn rows_within(&self) -> Vec<&ManufacturerRow> {
        self.rows_of(&self.within)
    }

    /// Returns the rows of a manufacturer's table with the given indices.
    fn rows_of(&self, places: &[u32]) -> Vec<&ManufacturerRow> {
        match &self.rows {
            Rows::Sizes { .. } => Vec::new(),
            Rows::Table(rows) => places.iter().map(|place| &rows[*place as usize]).collect(),
        }
    }

    /// Returns an answer for the screen. The answer contains only the first nuts and the given
    /// columns.
    pub fn answer_of(&self, first: usize, columns: &[ShownColumn]) -> Answer {
        let count = self.chosen.len().min(first);
        let all = self.values(0..count);
        let values: Vec<_> = columns.iter().map(|column| column.values(&all)).collect();
        let head = |column: &ShownColumn| Column {
            head: Some(column.name.clone().into()),
            ..Column::new("", None)
        };
        let row = |row: usize| values.iter().map(|column| column.json(row)).collect();
        let rows = (0..count).map(row).collect();
        let bands = self.bands_of(count, columns);
        let columns = columns.iter().map(head).collect();
        let table = Table { columns, rows, bands, ..Table::default() };
        let mut answer = self.answer(first);
        answer.sections = Vec::new();
        answer.with("", Content::Table(table))
    }

    /// Returns the intervals for the first nuts of the list, in the units in which the given
    /// columns are displayed.
    fn bands_of(&self, count: usize, columns: &[ShownColumn]) -> Vec<Vec<Option<Band>>> {
        let heads = self.heads();
        let band = |row: &ManufacturerRow, column: &ShownColumn| {
            let Band { low, high } = row.band_of_column(&heads[column.place].0)?;
            let [low, high] = [low, high].map(|end| column.unit.value(end));
            Some(Band { low, high })
        };
        let bands = |row| columns.iter().map(|column| band(row, column)).collect();
        self.rows_of(&self.chosen[..count]).into_iter().map(bands).collect()
    }

    /// Returns true if the screen shows the column.
    fn is_shown(&self, column: &ListColumn) -> bool {
        column.is_shown || self.named.contains(&column.place)
    }

    /// Returns the answer with the first nuts of the list.
    pub fn answer(&self, first: usize) -> Answer {
        let count = self.chosen.len().min(first);
        let mut answer = match &self.rows {
            Rows::Sizes { .. } => self.answer_of_sizes(count),
            Rows::Table(_) => {
                let is_shown = |place: usize| self.is_shown(&self.columns[place]);
                ManufacturerRow::answer(&self.rows_of(&self.chosen), count, is_shown)
            }
        };
        answer.notes.extend(self.reasons.iter().map(|why| format!("no nut was selected: {why}")));
        answer.fails |= !self.reasons.is_empty();
        let more = self.chosen.len() - count;
        if more > 0 {
            answer.notes.push(format!(
                "{more} more nuts are not shown. A table that is written to a file contains all nuts with all columns."
            ));
        }
        answer
    }

    fn answer_of_sizes(&self, count: usize) -> Answer {
        let values = self.values(0..count);
        let head = |column: &ListColumn| {
            let head = self.is_shown(column).then(|| column.name.clone());
            Column { name: column.name.clone(), unit: column.unit, head }
        };
        let row = |row: usize| values.iter().map(|column| column.json(row)).collect();
        let table = Table {
            columns: self.columns.iter().map(head).collect(),
            rows: (0..count).map(row).collect(),
            ..Table::default()
        };
        let warnings = self.warnings.iter().map(|text| format!("first nut: {text}")).collect();
        Answer { warnings, ..Answer::default() }.with("", Content::Table(table))
    }
}
