//! Selection of nuts from lists, based on conditions that the nuts must meet.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::{Range, RangeInclusive};

use bsm_design::Nut;
use bsm_design::catalog::Candidate;
use bsm_design::statistics::Band;
use bsm_dyn::Materials;
use serde_json::{Map, Value, json};

use super::manufacturers::{ExtraCell, ListNumber, ManufacturerRow};
use super::ratings::QUANTITIES as RATINGS;
use crate::case::catalog_keys::LISTS;
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::column_values::ColumnValues;
use crate::vocabulary::entries::Choice;
use crate::vocabulary::number::{decimal, format_number, format_trimmed};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, GPA, MM, UM, UnitChange, convert};
use crate::{
    AnalysisKind, Answer, CaseError, Catalog, Column, Content, DesignReport, DisplayUnits, INPUTS,
    InputKey, NameKind, Output, RequirementFile, ShownColumn, Table, Verdict, nearest, output,
    sheet_columns,
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

/// Columns with the text of a table of sizes.
const SIZE_TEXTS: [(&str, &str); 2] = [
    ("make", "make of the screw in the list of sizes, ground or rolled"),
    ("manufacturer", "manufacturer that lists the size"),
];

/// Columns with the text of a manufacturer's table that a condition can name.
const ROW_TEXTS: [(&str, &str); 2] = [
    ("nut", "name of the nut, or the number of its row"),
    ("manufacturer", "manufacturer of the nut"),
];

/// Column of the axis sheet that the screen shows only if a condition or the sort order names it.
const UNSUPPORTED_LENGTH: &str = output!(unsupported_length_mm).name();

/// Returns true if the screen shows a column of the axis sheet.
fn is_shown_of_sheet(output: &Output) -> bool {
    output.analysis() != Some(AnalysisKind::Warm) && output.name != UNSUPPORTED_LENGTH
}

/// A column of a list of nuts.
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
    /// True for a column of text, whose cells can only be compared with a text.
    is_text: bool,
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
        let all = of_nut.chain(of_sheet.map(|output| (output, true, is_shown_of_sheet(output))));
        let numbers = all
            .enumerate()
            .map(|(place, (output, is_of_sheet, is_shown))| Self {
                is_of_sheet,
                is_shown,
                ..Self::of_output(place, output)
            })
            .collect();
        Self::with_texts(numbers, &SIZE_TEXTS)
    }

    /// Appends columns of text with the given names and meanings.
    fn with_texts(mut columns: Vec<Self>, texts: &[(&'static str, &'static str)]) -> Vec<Self> {
        let first = columns.len();
        columns.extend(texts.iter().enumerate().map(|(place, (name, about))| Self {
            place: first + place,
            name: (*name).into(),
            unit: "",
            about,
            is_of_sheet: false,
            is_shown: true,
            is_text: true,
        }));
        columns
    }

    /// Returns the columns of a manufacturer's table, followed by the columns that the program does
    /// not know, such as a price or a supplier. The screen does not show the columns of inputs.
    pub fn of_rows(rows: &[ManufacturerRow]) -> Vec<Self> {
        let Some(first) = rows.first() else { return Vec::new() };
        let column = |(place, number): (usize, &ListNumber)| {
            let output = number.column;
            let is_shown = !output.is_input() && output.name != UNSUPPORTED_LENGTH;
            Self { is_shown, ..Self::of_output(place, output) }
        };
        let extra = |(place, cell): (usize, &ExtraCell)| Self {
            place: first.numbers.len() + place,
            name: cell.name.clone().into(),
            unit: "",
            about: "column of the table that has no effect on the calculation",
            is_of_sheet: false,
            is_shown: true,
            is_text: !cell.is_numeric(),
        };
        let numbers = first.numbers.iter().enumerate().map(column);
        let extra = first.extra.iter().enumerate().map(extra);
        Self::with_texts(numbers.chain(extra).collect(), &ROW_TEXTS)
    }

    fn of_output(place: usize, output: &'static Output) -> Self {
        Self {
            place,
            name: output.name.into(),
            unit: output.unit,
            about: output.about,
            is_of_sheet: false,
            is_shown: true,
            is_text: false,
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

    /// Returns true if the column contains text.
    pub fn is_text(&self) -> bool {
        self.is_text
    }

    /// Returns true if the column belongs to the axis sheet.
    pub fn is_of_sheet(&self) -> bool {
        self.is_of_sheet
    }

    /// Returns the number of a size in this column. The column must not be a column of text.
    fn read(&self, nut: &Candidate, sheet: &[f64]) -> f64 {
        match self.place.checked_sub(CATALOG.len()) {
            Some(place) => sheet[place],
            None => read::READ[self.place](nut)[0].unwrap_or(f64::NAN),
        }
    }

    /// Returns the text of a size in this column, or `None` if the table of sizes does not state
    /// it. The column must be a column of text.
    fn read_text<'a>(&self, nut: &Candidate, catalog: &'a Catalog) -> Option<&'a str> {
        match self.name.as_ref() {
            "make" => nut.size.make().map(Choice::name),
            _ => catalog.source_of(&nut.size)?.manufacturer.as_deref(),
        }
    }
}

/// A condition on a column.
#[derive(Debug, Clone)]
pub struct Condition {
    text: String,
    column: ListColumn,
    permitted: Permitted,
}

/// Values that a condition permits.
#[derive(Debug, Clone)]
enum Permitted {
    /// Range of numbers.
    Range(RangeInclusive<f64>),
    /// A text.
    Text(String),
}

impl Condition {
    /// Parses `name>=number`, `name<=number`, `name=number` or, for a column of text, `name=text`.
    /// The name may end with a different unit than the column.
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
        if column.is_text {
            if sign != "=" {
                return Err(CaseError::Invalid(format!(
                    "in `{text}`, `{}` is a column of text; its condition has the form name=text",
                    column.name
                )));
            }
            let permitted = Permitted::Text(given.to_owned());
            return Ok(Self { text: text.to_owned(), column, permitted });
        }
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
        Ok(Self { text: text.to_owned(), column, permitted: Permitted::Range(range) })
    }

    /// Returns true if a nut meets the condition.
    ///
    /// * `sheet`: results for the nut on its axis sheet.
    pub fn is_met(&self, nut: &Candidate, catalog: &Catalog, sheet: &[f64]) -> bool {
        match &self.permitted {
            Permitted::Range(range) => range.contains(&self.column.read(nut, sheet)),
            Permitted::Text(text) => self.column.read_text(nut, catalog) == Some(text),
        }
    }

    /// Returns true if a row of a manufacturer's table meets the condition.
    fn is_met_by_row(&self, row: &ManufacturerRow) -> bool {
        match &self.permitted {
            Permitted::Range(range) => {
                row.number_at(self.column.place).is_some_and(|number| range.contains(&number))
            }
            Permitted::Text(text) => row.text_in(&self.column.name) == Some(text),
        }
    }

    /// Describes which of the given nuts comes closest to meeting the condition: its number, or the
    /// texts in the column. Returns `None` if no nut has a value.
    ///
    /// * `number`, `text`: functions that return the number and the text of a nut in the column.
    /// * `format`: function that formats a number.
    fn nearest_of<N>(
        &self,
        nuts: &[N],
        number: impl Fn(&N) -> Option<f64>,
        text: impl Fn(&N) -> Option<String>,
        format: fn(f64) -> String,
    ) -> Option<String> {
        match &self.permitted {
            Permitted::Range(range) => {
                let miss = |value: f64| (range.start() - value).max(value - range.end());
                let values = nuts.iter().filter_map(number);
                values.min_by(|a, b| miss(*a).total_cmp(&miss(*b))).map(format)
            }
            Permitted::Text(_) => {
                let texts: BTreeSet<_> = nuts.iter().filter_map(text).collect();
                let first: Vec<_> = texts.into_iter().take(MAX_LISTED_TEXTS).collect();
                (!first.is_empty()).then(|| first.join(", "))
            }
        }
    }
}

/// Largest number of texts that a reason for an empty list states.
const MAX_LISTED_TEXTS: usize = 10;

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
    if let Some(make) = candidate.size.make() {
        nut.insert("screw_make".to_owned(), json!(make.name()));
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
    /// Returns [`CaseError`] for an unknown column and for a column of text.
    pub fn sorted_by(
        self,
        name: &str,
        descending: bool,
        columns: &[ListColumn],
    ) -> Result<Self, CaseError> {
        let (column, _) = ListColumn::named(name, columns)?;
        if column.is_text {
            return Err(CaseError::Invalid(format!(
                "`{name}` is a column of text, but sorting needs a column of numbers"
            )));
        }
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
            self.of_nut.iter().all(|condition| condition.is_met_by_row(&rows[*place as usize]))
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
            let Condition { text, column, permitted } = condition;
            let number = |row: &ManufacturerRow| row.number_at(column.place);
            let of_row = |row: &ManufacturerRow| row.text_in(&column.name).map(str::to_owned);
            let nearest = condition.nearest_of(&rows, number, of_row, format_trimmed);
            match (permitted, nearest) {
                (Permitted::Range(_), Some(value)) => {
                    format!("{text}: the nearest of {} nuts has {value}", rows.len())
                }
                (Permitted::Range(_), None) => {
                    format!("{text}: the nearest of {} nuts has no value", rows.len())
                }
                (Permitted::Text(_), texts) => describe_texts(text, rows.len(), texts),
            }
        };
        let why =
            if within.is_empty() { self.of_nut.iter().map(near).collect() } else { Vec::new() };
        let mut notes = Vec::new();
        let is_failing = |place: &u32| rows[*place as usize].verdict == Some(Verdict::Fails);
        if let (Some((column, _)), true) = (&self.order, chosen.iter().any(is_failing)) {
            notes.push(format!(
                "Nuts that pass all rules come first, and nuts that fail a rule come last. Each of these groups is sorted by {}.",
                column.name
            ));
        }
        NutList {
            columns: ListColumn::of_rows(&rows),
            all: rows.len(),
            within,
            chosen,
            named: self.named_columns(),
            reasons: why,
            warnings: Vec::new(),
            notes,
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
            |nut: &Candidate| requirement.is_none_or(|requirement| requirement.is_met_by(nut));
        let meets = |nut: &Candidate| {
            self.of_nut.iter().all(|c| c.is_met(nut, &catalog, &[])) && keeps(nut)
        };
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
        let mut columns = ListColumn::of_sizes(has_sheets);
        columns.retain(|column| !column.is_text || !catalog.sources.is_empty());
        NutList {
            columns,
            all,
            within,
            chosen,
            reasons,
            warnings,
            notes: Vec::new(),
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
        let meets_sheet = |nut: &Candidate, sheet: &[f64]| {
            self.of_sheet.iter().all(|c| c.is_met(nut, catalog, sheet))
        };
        found.within = sheets
            .iter()
            .filter(|(_, nut, sheet)| meets_sheet(nut, sheet))
            .map(|(place, ..)| *place)
            .collect();
        if found.within.is_empty() && sheets.is_empty() {
            found.reasons = blocking_limits(requirement, catalog);
        } else if found.within.is_empty() {
            let near = |condition: &Condition| {
                let number = |(_, nut, sheet): &(u32, Candidate, Vec<f64>)| {
                    Some(condition.column.read(nut, sheet))
                };
                let value = condition.nearest_of(&sheets, number, |_| None, format_number);
                let value = value.unwrap_or_default();
                format!("{}: the nearest of {} nuts has {value}", condition.text, sheets.len())
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
                keeps(nut) && conditions.all(|(j, c)| j == i || c.is_met(nut, catalog, &[]))
            };
            let rest = catalog.map(all, |_, nut| others(nut).then_some(*nut));
            let Condition { text, column, permitted } = condition;
            let number = |nut: &Candidate| Some(column.read(nut, &[]));
            let of_nut = |nut: &Candidate| column.read_text(nut, catalog).map(str::to_owned);
            let nearest = condition.nearest_of(&rest, number, of_nut, format_number);
            let nuts = rest.len();
            match (permitted, nearest) {
                _ if rest.is_empty() => format!("even without {text}, no nut remains"),
                (Permitted::Range(_), nearest) => {
                    let value = nearest.unwrap_or_default();
                    format!(
                        "without {text}, {nuts} nuts remain; the value closest to this condition is {value}"
                    )
                }
                (Permitted::Text(_), texts) => {
                    let column = describe_texts(text, nuts, texts);
                    format!("without {text}, {nuts} nuts remain; {column}")
                }
            }
        };
        let count = format!("none of the {} nuts in the list meets all conditions", all.len());
        let reasons = self.of_nut.iter().enumerate().map(without);
        std::iter::once(count).chain(reasons).collect()
    }
}

/// Returns a text that states which texts a column of the given number of nuts contains.
///
/// * `texts`: texts in the column, separated by commas; `None` if all cells are empty.
fn describe_texts(condition: &str, nuts: usize, texts: Option<String>) -> String {
    match texts {
        Some(texts) => format!("{condition}: the column of {nuts} nuts contains {texts}"),
        None => format!("{condition}: the column of {nuts} nuts is empty"),
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
    /// Notes on the order of the nuts.
    notes: Vec<String>,
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
                let Some(nut) = nut.first() else { return Value::Null };
                let mut case = candidate_case(nut, requirement);
                let source = catalog.source_of(&nut.size);
                if let Some(name) = source.and_then(|source| source.manufacturer.as_ref()) {
                    case["manufacturer"] = json!(name);
                }
                case
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
                 `bsm select --show columns` lists all its columns. To see which limits exclude the other sizes, omit --columns: \
                 the command then chooses the best screw and states the active limits"
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
                    if column.is_text {
                        let text = |(nut, _): &(Candidate, &[f64])| {
                            column.read_text(nut, catalog).map(str::to_owned)
                        };
                        return ColumnValues::Texts(rows.iter().map(text).collect());
                    }
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
        answer.notes.extend(self.notes.iter().cloned());
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
