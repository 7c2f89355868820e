//! Nuts of lists: what is asked of them, and those that meet it.

use std::collections::BTreeMap;

use bsm_design::Candidate;
use serde_json::json;

use crate::vocabulary::number::number;
use crate::{
    Answer, Asked, CATALOGUE_COLUMNS, CaseError, Catalogue, CatalogueColumn, Column, Condition,
    Content, Output, RequirementFile, Table, sheet_columns,
};

/// A column of a list of nuts.
#[derive(Debug, Clone, Copy)]
pub enum ListColumn {
    /// Of the nut.
    Nut(&'static CatalogueColumn),
    /// Of its sheet in the axis of a requirement, by its place there.
    Sheet(usize, &'static Output),
}

impl ListColumn {
    /// All of them, those of sheets if there are any.
    pub fn all(has_sheets: bool) -> Vec<Self> {
        let of_sheets = sheet_columns().enumerate().filter(|_| has_sheets);
        let of_sheets = of_sheets.map(|(place, column)| Self::Sheet(place, column));
        CATALOGUE_COLUMNS.iter().map(Self::Nut).chain(of_sheets).collect()
    }

    fn named(name: &str, has_sheets: bool) -> Result<Self, CaseError> {
        let is_its = |column: &Self| matches!(column, Self::Sheet(_, c) if c.name == name);
        let of_sheet = Self::all(has_sheets).into_iter().find(is_its);
        of_sheet.map_or_else(|| CatalogueColumn::named(name).map(Self::Nut), Ok)
    }

    /// Its name and unit.
    pub fn head(&self) -> (&'static str, &'static str) {
        match self {
            Self::Nut(column) => (column.name, column.unit),
            Self::Sheet(_, column) => (column.name, column.unit),
        }
    }

    fn read(&self, nut: &Candidate, sheet: &[f64]) -> f64 {
        match self {
            Self::Nut(column) => (column.read)(nut),
            Self::Sheet(place, _) => sheet[*place],
        }
    }
}

/// What is asked of nuts besides a requirement, and their order.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    of_nut: Vec<(String, Condition)>,
    of_sheet: Vec<(usize, Asked)>,
    order: Option<(ListColumn, bool)>,
    pareto: bool,
}

impl Wanted {
    /// Conditions such as `lead_mm=20`; with a requirement also on its sheet.
    ///
    /// * `pareto`: only those that no other one beats in dynamic rating, rigidity and mass.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form and unknown columns.
    pub fn new(conditions: &[String], has_sheets: bool, pareto: bool) -> Result<Self, CaseError> {
        let mut wanted = Self { pareto, ..Self::default() };
        for text in conditions {
            let asked = Asked::parse(text)?;
            match ListColumn::named(&asked.name, has_sheets)? {
                ListColumn::Sheet(place, _) => wanted.of_sheet.push((place, asked)),
                ListColumn::Nut(_) => wanted.of_nut.push((text.clone(), Condition::on(asked)?)),
            }
        }
        Ok(wanted)
    }

    /// In the order of a column.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`].
    pub fn sorted_by(
        self,
        name: &str,
        descending: bool,
        has_sheets: bool,
    ) -> Result<Self, CaseError> {
        Ok(Self { order: Some((ListColumn::named(name, has_sheets)?, descending)), ..self })
    }

    /// The nuts of a catalogue that meet this and a requirement.
    pub fn choose(&self, catalogue: Catalogue, wish: Option<&RequirementFile>) -> NutList {
        let catalogue = match wish {
            Some(wish) => wish.of_its_steel(catalogue),
            None => catalogue,
        };
        let all = catalogue.places();
        let keeps = |nut: &Candidate| wish.is_none_or(|wish| wish.is_kept_by(&nut.nut));
        let meets = |nut: &Candidate| self.of_nut.iter().all(|(_, r)| r.is_met(nut)) && keeps(nut);
        let within = catalogue.map(&all, |place, nut| meets(nut).then_some(place));
        let mut list = NutList {
            has_sheets: wish.is_some(),
            all: all.len(),
            chosen: within.clone(),
            within,
            sheets: BTreeMap::new(),
            why: None,
            catalogue,
        };
        if list.within.is_empty() {
            list.why = Some(match wish {
                _ if all.is_empty() => NO_COMBINATION.to_owned(),
                Some(_) if self.of_nut.is_empty() => NO_NUT.to_owned(),
                _ => self.nearest(&list.catalogue, &all),
            });
            return list;
        }
        if let Some(wish) = wish {
            let sheet = |place, nut: &Candidate| Some((place, wish.sheet_of(&nut.nut)?));
            list.sheets.extend(list.catalogue.map(&list.within, sheet));
            let kept =
                |sheet: &Vec<f64>| self.of_sheet.iter().all(|(i, asked)| asked.is_met(sheet[*i]));
            list.within.retain(|place| list.sheets.get(place).is_some_and(kept));
            if list.within.is_empty() {
                let words = if list.sheets.is_empty() { NO_SHEET } else { NOT_ASKED };
                list.why = Some(words.to_owned());
            }
        }
        list.chosen =
            if self.pareto { list.catalogue.pareto(&list.within) } else { list.within.clone() };
        if let Some((column, descending)) = &self.order {
            let key = |place, nut: &Candidate| Some((column.read(nut, list.sheet(place)), place));
            let mut keys = list.catalogue.map(&list.chosen, key);
            keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            if *descending {
                keys.reverse();
            }
            list.chosen = keys.into_iter().map(|(_, place)| place).collect();
        }
        list
    }

    /// Why no nut was found, condition by condition.
    fn nearest(&self, catalogue: &Catalogue, all: &[u32]) -> String {
        let without = |(i, (name, condition)): (usize, &(String, Condition))| {
            let others = |nut: &Candidate| {
                self.of_nut.iter().enumerate().all(|(j, (_, r))| j == i || r.is_met(nut))
            };
            let read = condition.column().read;
            let rest = catalogue.map(all, |_, nut| others(nut).then(|| read(nut)));
            match condition.nearest_of(&rest) {
                Some(value) => {
                    let (nuts, value) = (rest.len(), number(value));
                    format!("\n  without {name}: {nuts} nuts, of which the nearest has {value}")
                }
                None => format!("\n  without {name}: no nut either"),
            }
        };
        let reasons: String = self.of_nut.iter().enumerate().map(without).collect();
        format!("none of {} nuts within the limits meets all requirements{reasons}", all.len())
    }
}

const NO_COMBINATION: &str = "no combination of the lists is within the limits: turns_range, conformity_range, \
                              largest_ball_over_lead, largest_ball_over_screw_root; or the lands hold no ball";
const NO_NUT: &str =
    "no nut meets all limits of the requirement, which says alone, without a list, what blocks";
const NO_SHEET: &str = "no nut passes all rules of its sheet (bsm axis)";
const NOT_ASKED: &str = "no nut that meets the requirement meets what is asked of its sheet";

/// The nuts that were chosen.
#[derive(Debug, Clone)]
pub struct NutList {
    /// The lists.
    pub catalogue: Catalogue,
    /// How many nuts are within the limits of the lists.
    pub all: usize,
    /// Places of those that meet what is asked.
    pub within: Vec<u32>,
    /// Places of those that no other one beats, if that is asked, in their order.
    pub chosen: Vec<u32>,
    /// Why there is none.
    pub why: Option<String>,
    has_sheets: bool,
    sheets: BTreeMap<u32, Vec<f64>>,
}

impl NutList {
    /// Its columns.
    pub fn columns(&self) -> Vec<ListColumn> {
        ListColumn::all(self.has_sheets)
    }

    fn sheet(&self, place: u32) -> &[f64] {
        self.sheets.get(&place).map_or(&[], Vec::as_slice)
    }

    /// The nuts at some places.
    pub fn nuts(&self, places: &[u32]) -> Vec<Candidate> {
        self.catalogue.map(places, |_, nut| Some(*nut))
    }

    /// The values of all columns at some places, column by column.
    pub fn values(&self, places: &[u32]) -> Vec<Vec<f64>> {
        let rows = self.catalogue.map(places, |place, nut| Some((*nut, self.sheet(place))));
        let values =
            |column: ListColumn| rows.iter().map(|(nut, sheet)| column.read(nut, sheet)).collect();
        self.columns().into_iter().map(values).collect()
    }

    /// The answer: the first nuts.
    pub fn answer(&self, first: usize) -> Answer {
        let places = &self.chosen[..self.chosen.len().min(first)];
        let values = self.values(places);
        let is_brief =
            |column: &ListColumn| !matches!(column, ListColumn::Nut(column) if !column.brief);
        let head = |column: &ListColumn| {
            let (name, unit) = column.head();
            Column { name, unit, head: is_brief(column).then_some(name) }
        };
        let row = |row: usize| values.iter().map(|column| json!(column[row])).collect();
        let table = Table {
            columns: self.columns().iter().map(head).collect(),
            rows: (0..places.len()).map(row).collect(),
            keyed: false,
        };
        let mut answer = Answer::default().with("", Content::Table(table));
        let more = self.chosen.len() - places.len();
        if more > 0 {
            let text = format!(
                "{more} more; --first N shows others, -o TABLE writes all with all columns"
            );
            answer.notes.push(text);
        }
        answer
    }
}
