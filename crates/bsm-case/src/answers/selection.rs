//! Selection of nuts from lists: conditions, and the nuts that satisfy them.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use bsm_design::{Candidate, Nut};
use serde_json::{Map, Value, json};

use super::ratings::QUANTITIES as RATINGS;
use crate::case::catalog::LISTS;
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::number::{decimal, number};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, GPA, MM, UM};
use crate::{
    AnalysisKind, Answer, CaseError, Catalog, Column, Content, DesignReport, INPUTS, Known, Output,
    RequirementFile, Table, nearest, sheet_columns,
};

quantities! {
    /// The columns of a list of nuts. Columns titled "shown" are printed on the screen.
    pub CATALOG, read(&Candidate);
    "shown" {
        nominal_diameter_mm = LISTS Scalar(|c| decimal(c.size.diameter / MM));
        lead_mm = INPUTS Scalar(|c| decimal(c.nut.lead / MM));
        ball_diameter_mm = INPUTS Scalar(|c| decimal(c.nut.ball_diameter / MM));
        loaded_turns = INPUTS Scalar(|c| c.nut.turns);
        nut_conformity = INPUTS Scalar(|c| c.nut.conformity.0);
    }
    "in files" {
        screw_conformity = INPUTS Scalar(|c| c.nut.conformity.1);
        contact_angle_deg = INPUTS Scalar(|c| decimal(c.nut.contact_angle / DEG));
        pitch_circle_diameter_mm = INPUTS Scalar(|c| c.nut.pitch_diameter / MM);
        loaded_balls_per_turn = INPUTS Scalar(|c| c.nut.balls_per_turn);
        starts = INPUTS Scalar(|c| c.nut.starts);
    }
    "shown" {
        dynamic_load_rating_N = RATINGS Scalar(|c| c.dynamic_rating);
        static_load_rating_N = RATINGS Scalar(|c| c.static_rating);
    }
    "in files" {
        edge_load_N = RATINGS Scalar(|c| c.edge_load);
        stiffness_characteristic_N_um15 = RATINGS Scalar(|c| c.elasticity.turn * 1e-9);
        preload_N = INPUTS Scalar(|c| c.preload);
        preloaded_contact_stiffness_N_um = RATINGS Scalar(|c| c.elasticity.preloaded(c.preload) * UM);
        preloaded_body_stiffness_N_um = RATINGS Scalar(|c| 2.0 * c.elasticity.body * UM);
    }
    "shown" {
        preloaded_stiffness_N_um = RATINGS Scalar(|c| c.stiffness * UM);
    }
    "in files" {
        nut_outer_diameter_mm = INPUTS Scalar(|c| c.body.outer / MM);
        nut_length_mm = INPUTS Scalar(|c| c.body.length / MM);
    }
    "shown" {
        mass_kg = RATINGS Scalar(|c| c.mass);
        rolling_efficiency = RATINGS Scalar(|c| c.efficiency);
    }
    "in files" {
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

/// A column of a list of nuts, either of [`CATALOG`] or of the axis sheet for a requirement.
#[derive(Debug, Clone, Copy)]
pub struct ListColumn {
    place: usize,
    /// Name, unit and meaning.
    pub output: &'static Output,
}

impl ListColumn {
    /// Returns all columns, including the columns of the axis sheet if there is one.
    pub fn all(has_sheets: bool) -> Vec<Self> {
        let of_nut = CATALOG.iter().flat_map(|quantity| quantity.columns);
        let all = of_nut.chain(sheet_columns().filter(|_| has_sheets));
        all.enumerate().map(|(place, output)| Self { place, output }).collect()
    }

    fn named(name: &str, has_sheets: bool) -> Result<Self, CaseError> {
        let all = Self::all(has_sheets);
        all.iter().copied().find(|column| column.output.name == name).ok_or_else(|| {
            let names = all.iter().map(|column| column.output.name);
            CaseError::unknown(Known::Column, name, nearest(name, names))
        })
    }

    /// Returns true if the column belongs to the axis sheet.
    pub fn is_of_sheet(&self) -> bool {
        self.place >= CATALOG.len()
    }

    /// Returns true if the column is shown on the screen.
    fn is_shown(&self) -> bool {
        let is_warm = || self.output.analysis() == Some(AnalysisKind::Warm);
        CATALOG.get(self.place).map_or_else(|| !is_warm(), |quantity| quantity.title == "shown")
    }

    fn read(&self, nut: &Candidate, sheet: &[f64]) -> f64 {
        match self.place.checked_sub(CATALOG.len()) {
            Some(place) => sheet[place],
            None => read::READ[self.place](nut)[0].unwrap_or(f64::NAN),
        }
    }
}

/// A condition on a column, given as the range of permitted values.
#[derive(Debug, Clone)]
pub struct Condition {
    text: String,
    column: ListColumn,
    range: RangeInclusive<f64>,
}

impl Condition {
    /// Parses `name>=value`, `name<=value` or `name=value`.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form, an unknown column, or a value that is not a number.
    pub fn parse(text: &str, has_sheets: bool) -> Result<Self, CaseError> {
        let form = "name>=value, name<=value or name=value";
        let bad = || CaseError::bad_setting(text, form);
        let at = text.find(['<', '>', '=']).ok_or_else(bad)?;
        let sign =
            if text[at..].starts_with('=') { "=" } else { text.get(at..at + 2).ok_or_else(bad)? };
        let value: f64 = text[at + sign.len()..].trim().parse().map_err(|_| bad())?;
        // Tables contain decimal numbers, which differ from sizes in meters by rounding.
        let near = 1e-9 * value.abs();
        let range = match sign {
            ">=" => value - near..=f64::INFINITY,
            "<=" => f64::NEG_INFINITY..=value + near,
            "=" => value - near..=value + near,
            _ => return Err(bad()),
        };
        if value.is_nan() {
            return Err(bad());
        }
        let column = ListColumn::named(text[..at].trim(), has_sheets)?;
        Ok(Self { text: text.to_owned(), column, range })
    }

    /// Returns true if a nut meets the condition.
    ///
    /// * `sheet`: numbers of the nut in the axis of a requirement.
    pub fn is_met(&self, nut: &Candidate, sheet: &[f64]) -> bool {
        self.range.contains(&self.column.read(nut, sheet))
    }

    /// Returns the value that is closest to meeting the condition, if there are any values.
    fn nearest_of(&self, values: &[f64]) -> Option<f64> {
        let miss = |value: f64| (self.range.start() - value).max(value - self.range.end());
        values.iter().copied().min_by(|a, b| miss(*a).total_cmp(&miss(*b)))
    }
}

/// Converts a nut to a JSON object with the names of the columns.
pub fn candidate_json(candidate: &Candidate) -> Map<String, Value> {
    numbers_json(&read(candidate, |_| true))
}

/// Converts a nut to a case for the other commands. With a requirement, the case is at its
/// operating point.
pub fn candidate_case(candidate: &Candidate, requirement: Option<&RequirementFile>) -> Value {
    if let Some(requirement) = requirement {
        return requirement.case_of(&candidate.nut).to_json();
    }
    let mut nut = candidate_json(candidate);
    nut.retain(|name, _| INPUTS.iter().any(|input| input.name == name));
    for number in nut.values_mut() {
        *number = json!(number.as_f64().map(decimal));
    }
    let Nut { starts, material: (raceways, _), .. } = candidate.nut;
    if starts > 1.0 {
        nut.insert("circuits_count".to_owned(), json!(starts));
    }
    nut.insert("youngs_modulus_GPa".to_owned(), json!(raceways.youngs_modulus / GPA));
    nut.insert("poisson_ratio".to_owned(), json!(raceways.poisson_ratio));
    Value::Object(nut)
}

/// Filter and order of nuts in addition to a requirement.
#[derive(Debug, Clone, Default)]
pub struct NutFilter {
    of_nut: Vec<Condition>,
    of_sheet: Vec<Condition>,
    order: Option<(ListColumn, bool)>,
    pareto: bool,
}

impl NutFilter {
    /// Parses conditions such as `lead_mm=20`. With a requirement, columns of the axis sheet are
    /// also allowed.
    ///
    /// * `pareto`: keeps only Pareto-optimal nuts with respect to dynamic load rating, stiffness and
    ///   mass.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form or an unknown column.
    pub fn new(conditions: &[String], has_sheets: bool, pareto: bool) -> Result<Self, CaseError> {
        let mut wanted = Self { pareto, ..Self::default() };
        for text in conditions {
            let condition = Condition::parse(text, has_sheets)?;
            let is_of_sheet = condition.column.is_of_sheet();
            if is_of_sheet { &mut wanted.of_sheet } else { &mut wanted.of_nut }.push(condition);
        }
        Ok(wanted)
    }

    /// Sorts the nuts by a column.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`] for an unknown column.
    pub fn sorted_by(
        self,
        name: &str,
        descending: bool,
        has_sheets: bool,
    ) -> Result<Self, CaseError> {
        Ok(Self { order: Some((ListColumn::named(name, has_sheets)?, descending)), ..self })
    }

    /// Returns the columns that occur in the conditions and the order.
    fn columns(&self) -> impl Iterator<Item = ListColumn> {
        let conditions = self.of_nut.iter().chain(&self.of_sheet).map(|condition| condition.column);
        conditions.chain(self.order.map(|(column, _)| column))
    }

    /// Returns the nuts of a catalog that meet the filter and a requirement.
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
        let mut list = NutList {
            has_sheets: requirement.is_some(),
            all: all.len(),
            chosen: within.clone(),
            within,
            sheets: BTreeMap::new(),
            named: self.columns().map(|column| column.place).collect(),
            why: Vec::new(),
            warnings: Vec::new(),
            catalog,
        };
        if list.within.is_empty() {
            list.why = match requirement {
                _ if all.is_empty() => vec![NO_COMBINATION.to_owned()],
                Some(requirement) if self.of_nut.is_empty() => blocks(requirement, &list.catalog),
                _ => self.nearest(&list.catalog, &all),
            };
            return list;
        }
        if let Some(requirement) = requirement {
            let sheet =
                |place, nut: &Candidate| Some((place, *nut, requirement.sheet_of(&nut.nut)?));
            let sheets = list.catalog.map(&list.within, sheet);
            let meets_sheet =
                |nut: &Candidate, sheet: &[f64]| self.of_sheet.iter().all(|c| c.is_met(nut, sheet));
            list.within = sheets
                .iter()
                .filter(|(_, nut, sheet)| meets_sheet(nut, sheet))
                .map(|(place, ..)| *place)
                .collect();
            if list.within.is_empty() && sheets.is_empty() {
                list.why = blocks(requirement, &list.catalog);
            } else if list.within.is_empty() {
                let near = |condition: &Condition| {
                    let values: Vec<_> = sheets
                        .iter()
                        .map(|(_, nut, sheet)| condition.column.read(nut, sheet))
                        .collect();
                    let value = condition.nearest_of(&values).map_or_else(String::new, number);
                    format!("{}: the nearest of {} nuts has {value}", condition.text, values.len())
                };
                list.why = self.of_sheet.iter().map(near).collect();
            }
            list.sheets = sheets.into_iter().map(|(place, _, sheet)| (place, sheet)).collect();
        }
        list.chosen =
            if self.pareto { list.catalog.pareto(&list.within) } else { list.within.clone() };
        if let Some((column, descending)) = &self.order {
            let key = |place, nut: &Candidate| Some((column.read(nut, list.sheet(place)), place));
            let mut keys = list.catalog.map(&list.chosen, key);
            keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            if *descending {
                keys.reverse();
            }
            list.chosen = keys.into_iter().map(|(_, place)| place).collect();
        }
        let first = list.nuts(list.chosen.get(..1).unwrap_or_default());
        if let (Some(nut), Some(requirement)) = (first.first(), requirement)
            && let Ok(sheet) = requirement.judge(&requirement.case_of(&nut.nut))
        {
            list.warnings = sheet.answer.warnings;
        }
        list
    }

    /// Explains for each condition why no nut remains.
    fn nearest(&self, catalog: &Catalog, all: &[u32]) -> Vec<String> {
        let without = |(i, condition): (usize, &Condition)| {
            let others = |nut: &Candidate| {
                self.of_nut.iter().enumerate().all(|(j, c)| j == i || c.is_met(nut, &[]))
            };
            let read = |nut: &Candidate| condition.column.read(nut, &[]);
            let rest = catalog.map(all, |_, nut| others(nut).then(|| read(nut)));
            let text = &condition.text;
            match condition.nearest_of(&rest) {
                Some(value) => {
                    let (nuts, value) = (rest.len(), number(value));
                    format!("without {text}, {nuts} nuts remain, and the nearest nut has {value}")
                }
                None => format!("without {text}, no nut remains either"),
            }
        };
        let count = format!("none of {} nuts within the limits meets all conditions", all.len());
        let reasons = self.of_nut.iter().enumerate().map(without);
        std::iter::once(count).chain(reasons).collect()
    }
}

/// Returns the limits of a requirement that no nut of the lists meets.
fn blocks(requirement: &RequirementFile, catalog: &Catalog) -> Vec<String> {
    match DesignReport::standard(requirement, catalog) {
        Some(report) => report.reasons,
        None => vec![NO_SIZE.to_owned()],
    }
}

const NO_COMBINATION: &str = "no combination of the lists is within the limits (turns_range, nut_conformity_range, \
                              largest_ball_over_lead, largest_ball_over_screw_root), or the lands leave no room for a ball";
const NO_SIZE: &str = "no size of the lists has the lead, lead angle or diameter that the requirement fixes; without \
                       lists, sizes are not restricted";

/// The selected nuts.
#[derive(Debug, Clone)]
pub struct NutList {
    /// Catalog from which the nuts were selected.
    pub catalog: Catalog,
    /// Number of nuts within the limits of the lists.
    pub all: usize,
    /// Indices of the nuts that meet the filter and the requirement.
    pub within: Vec<u32>,
    /// Indices of the selected nuts in their order. They are only the Pareto-optimal nuts, if this is
    /// requested.
    pub chosen: Vec<u32>,
    /// Reasons why no nut was selected.
    pub why: Vec<String>,
    /// Warnings of the axis sheet for the first nut.
    pub warnings: Vec<String>,
    has_sheets: bool,
    sheets: BTreeMap<u32, Vec<f64>>,
    /// Indices of the columns that occur in the conditions and the order.
    named: Vec<usize>,
}

impl NutList {
    /// Returns the columns of the list.
    pub fn columns(&self) -> Vec<ListColumn> {
        ListColumn::all(self.has_sheets)
    }

    fn sheet(&self, place: u32) -> &[f64] {
        self.sheets.get(&place).map_or(&[], Vec::as_slice)
    }

    /// Returns the nuts with the given indices.
    pub fn nuts(&self, places: &[u32]) -> Vec<Candidate> {
        self.catalog.map(places, |_, nut| Some(*nut))
    }

    /// Returns the values of all columns for the given indices, column by column.
    pub fn values(&self, places: &[u32]) -> Vec<Vec<f64>> {
        let rows = self.catalog.map(places, |place, nut| Some((*nut, self.sheet(place))));
        let values =
            |column: ListColumn| rows.iter().map(|(nut, sheet)| column.read(nut, sheet)).collect();
        self.columns().into_iter().map(values).collect()
    }

    /// Returns the answer with the first nuts.
    pub fn answer(&self, first: usize) -> Answer {
        let places = &self.chosen[..self.chosen.len().min(first)];
        let values = self.values(places);
        let head = |column: &ListColumn| {
            let Output { name, unit, .. } = *column.output;
            let shown = column.is_shown() || self.named.contains(&column.place);
            Column { unit, head: shown.then_some(name), ..Column::of(name) }
        };
        let row = |row: usize| values.iter().map(|column| json!(column[row])).collect();
        let table = Table {
            columns: self.columns().iter().map(head).collect(),
            rows: (0..places.len()).map(row).collect(),
            ..Table::default()
        };
        let notes = self.why.iter().map(|why| format!("no nut was selected: {why}")).collect();
        let first = self.warnings.iter().map(|text| format!("first nut: {text}")).collect();
        let fails = !self.why.is_empty();
        let mut answer = Answer { fails, notes, warnings: first, ..Answer::default() }
            .with("", Content::Table(table));
        let more = self.chosen.len() - places.len();
        if more > 0 {
            answer.notes.push(format!(
                "The list has {more} more nuts. A table contains all nuts with all columns."
            ));
        }
        answer
    }
}
