//! Nuts that are read from the rows of a manufacturer's table. A column has the name of an input or
//! a name that the catalog uses.

use std::f64::consts::PI;

use bsm_design::groove::FEW_DRAWS;
use bsm_design::statistics::Band;
use bsm_design::{Nut, StiffnessAt};
use serde_json::{Map, Value, json};

use super::groove::pair;
use super::ratings::QUANTITIES as RATINGS;
use crate::case::manufacturer_sizes::manufacturer_column;
use crate::case::rated_nut;
use crate::vocabulary::cells::Cells;
use crate::vocabulary::column_values::ColumnValues;
use crate::vocabulary::entries::Named;
use crate::vocabulary::number::{format_digits, format_short, format_trimmed};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM};
use crate::{
    Answer, AxisReport, Case, CaseEntries, CaseError, Column, Content, INPUTS, InputKey, Output,
    OutputName, RequirementFile, Table, TableFormat, Verdict, output, ratings, sheet_columns,
    with_groove_intervals,
};

/// Names of known columns that are not inputs.
const TEXT_COLUMNS: [&str; 6] = [
    "nut",
    "circuits",
    "core_diameter_mm",
    "dynamic_load_rating_N",
    "static_load_rating_N",
    "stiffness_N_um",
];

/// Returns the name of the input that a column contains. Except for the columns of ratings, each
/// column has the name of its input.
fn input_of(column: &'static str) -> &'static str {
    match column {
        "dynamic_load_rating_N" => InputKey::rated_dynamic_load_N.name(),
        "static_load_rating_N" => InputKey::rated_static_load_N.name(),
        own => own,
    }
}

/// Contact angle that is assumed if a table does not contain the contact angle \[deg\].
const CONTACT_ANGLE_DEG: f64 = 45.0;

/// A nut in a manufacturer's table.
#[derive(Debug, Clone, PartialEq)]
pub struct ManufacturerNut {
    /// Name of the nut, or the number of its row.
    pub name: String,
    /// Case of the nut, with the ratings stated by the manufacturer.
    pub case: Case,
    /// Cells of the columns that the program does not know, such as the price.
    pub extra: Vec<ExtraCell>,
}

/// Cell of a column that the program does not know.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtraCell {
    /// Name of the column.
    pub name: String,
    /// Value in the cell.
    pub value: ExtraValue,
}

/// Value in a column that the program does not know; `None` if the cell is empty.
#[derive(Debug, Clone, PartialEq)]
pub enum ExtraValue {
    /// Number in a column that contains only numbers.
    Number(Option<f64>),
    /// Text in a column in which at least one cell contains text.
    Text(Option<String>),
}

impl ExtraCell {
    /// Returns the number in the cell, or `None` if the cell is empty or contains text.
    fn number(&self) -> Option<f64> {
        match self.value {
            ExtraValue::Number(number) => number,
            ExtraValue::Text(_) => None,
        }
    }

    /// Returns the text in the cell, or `None` if the cell is empty or contains a number.
    fn text(&self) -> Option<&str> {
        match &self.value {
            ExtraValue::Number(_) => None,
            ExtraValue::Text(text) => text.as_deref(),
        }
    }

    /// Returns true if the column contains only numbers.
    pub(crate) fn is_numeric(&self) -> bool {
        matches!(self.value, ExtraValue::Number(_))
    }

    fn json(&self) -> Value {
        match &self.value {
            ExtraValue::Number(number) => json!(number),
            ExtraValue::Text(text) => json!(text),
        }
    }
}

impl ManufacturerNut {
    /// Reads the nuts from a CSV table.
    ///
    /// # Errors
    ///
    /// Returns a [`CaseError`] that names the row or the column that is invalid.
    pub fn from_csv(table: &[u8], format: &TableFormat) -> Result<Vec<Self>, CaseError> {
        let cells = Cells::read(table, format)?;
        let words = [&TEXT_COLUMNS, CaseEntries::KEYS].concat();
        let kept = cells.kept(|name, has_text| is_kept_column(name, has_text, format, &words));
        let columns = cells.columns(|name| {
            if kept.iter().any(|(own, _)| own == name) {
                return Ok(None);
            }
            let column = manufacturer_column(name, format, &words)?;
            Ok(column.map(|(word, change)| (input_of(word), change)))
        })?;
        let nuts = cells.each(&columns, |place, row| {
            let (name, case) = (format!("row {place}"), Case::default());
            let mut nut = Self { name, case, extra: Vec::new() };
            let (mut circuits, mut core, mut stiffness) = (None, None, None);
            for ((word, change), text) in row {
                if word == "nut" {
                    text.clone_into(&mut nut.name);
                    continue;
                }
                if CaseEntries::KEYS.contains(&word) && !TEXT_COLUMNS.contains(&word) {
                    nut.case.entries.set_cell(word, text)?;
                    continue;
                }
                let value = Some(change.value(cells.number(text)?));
                match word {
                    "circuits" => circuits = value,
                    "core_diameter_mm" => core = value,
                    "stiffness_N_um" => stiffness = value,
                    word => nut.case[InputKey::named(word)?] = value,
                }
            }
            if let Some(stiffness) = stiffness {
                nut.case.rated_rigidity_N_um.get_or_insert(stiffness);
                let at = Named(StiffnessAt::Load(STIFFNESS_LOAD_RATIO));
                nut.case.entries.rated_rigidity_at.get_or_insert(at);
            }
            complete(&mut nut.case, circuits, core)?;
            Ok(nut)
        })?;
        let extra = |place: usize| {
            kept.iter().map(move |(name, cells)| {
                let value = match cells {
                    ColumnValues::Numbers(numbers) => {
                        ExtraValue::Number(Some(numbers[place]).filter(|number| !number.is_nan()))
                    }
                    ColumnValues::Texts(texts) => ExtraValue::Text(texts[place].clone()),
                };
                ExtraCell { name: name.clone(), value }
            })
        };
        let nuts = nuts.into_iter().enumerate();
        Ok(nuts.map(|(place, nut)| Self { extra: extra(place).collect(), ..nut }).collect())
    }

    /// Returns the case of a requirement with the inputs of this nut.
    pub fn within(&self, requirement: &RequirementFile) -> Case {
        let mut case = requirement.case.clone();
        case.lead_angle_deg = None;
        case.override_with(&self.case);
        case.description = Some(self.name.clone());
        case.entries.order_code.get_or_insert_with(|| self.name.clone());
        case
    }

    /// Returns the inputs that occur in the table, except for the ratings, the mass and the
    /// stiffness of the nut, which have separate columns.
    fn inputs(nuts: &[Self]) -> Vec<InputKey> {
        let separate =
            [InputKey::rated_dynamic_load_N, InputKey::rated_static_load_N, InputKey::nut_mass_kg];
        let is_given = |key: &InputKey| {
            let has_stiffness = |nut: &Self| {
                *key == InputKey::rated_rigidity_N_um && nut.case.rigidity_of_one_nut().is_some()
            };
            nuts.iter().any(|nut| nut.case[*key].is_some() && !has_stiffness(nut))
        };
        let all = InputKey::ALL.into_iter().filter(|key| !separate.contains(key));
        all.filter(is_given).collect()
    }
}

/// Returns true if a column is kept although its name is unknown, for example the price of the
/// nuts. A numeric column is kept only if its name does not resemble any known name, so that an
/// input with a misspelled name is not silently ignored.
fn is_kept_column(
    name: &str,
    has_text: bool,
    format: &TableFormat,
    words: &[&'static str],
) -> bool {
    let Err(error) = manufacturer_column(name, format, words) else { return false };
    let is_own_name = format.input_of(name) == Some(name);
    is_own_name && (has_text || matches!(error, CaseError::Unknown { nearest: None, .. }))
}

/// Ratio of axial load to dynamic load rating for which manufacturers state the stiffness of a
/// single nut.
const STIFFNESS_LOAD_RATIO: f64 = 0.3;

quantities! {
    /// Ratings, stiffness and mass stated by the manufacturer, and the values calculated for the
    /// same nut.
    pub(crate) COMPARED, read_compared(&ComparedNut<'_>);
    "ratings" {
        dynamic_load_rating_N = RATINGS Scalar(|b| b.nut.case.rated_dynamic_load_N);
        our_dynamic_load_rating_N ["N"] Scalar(|b| b.rating(output!(dynamic_load_rating_N))), "calculated dynamic load rating";
        static_load_rating_N = RATINGS Scalar(|b| b.nut.case.rated_static_load_N);
        our_static_load_rating_N ["N"] Scalar(|b| b.rating(output!(static_load_rating_N))), "calculated static load rating";
        stiffness_N_um ["N/um"] Scalar(|b| b.nut.case.rigidity_of_one_nut()), "stiffness of one nut as stated by the manufacturer";
        our_stiffness_N_um ["N/um"] Scalar(|b| b.calculated.number(CALCULATED_STIFFNESS)), "calculated stiffness of one nut";
        nut_mass_kg = INPUTS Scalar(|b| b.nut.case.nut_mass_kg.or_else(|| b.calculated.number(output!(nut_mass_kg))));
    }
}

/// A manufacturer's nut together with its calculated ratings.
struct ComparedNut<'a> {
    nut: &'a ManufacturerNut,
    calculated: Answer,
    is_estimated: bool,
}

impl ComparedNut<'_> {
    /// Returns a calculated rating, or `None` if the groove was estimated from the manufacturer's
    /// ratings.
    fn rating(&self, name: OutputName) -> Option<f64> {
        self.calculated.number(name).filter(|_| !self.is_estimated)
    }
}

/// Output that is compared with the stiffness that the manufacturer states for a single nut.
const CALCULATED_STIFFNESS: OutputName = output!(single_nut_secant_stiffness_N_um);

/// Adds an estimated groove to a case. If no groove can be estimated, returns the unchanged case
/// together with the reason.
fn groove_or_reason(case: Case) -> Result<(Case, Option<String>), CaseError> {
    match case.with_groove() {
        Err(CaseError::NoGroove(why)) => Ok((case, Some(why))),
        found => Ok((found?, None)),
    }
}

/// Describes ratings that few typical grooves with the dimensions of a row have.
///
/// * `case`: case of the nut with the ratings in the row.
/// * `nut`: nut with the most probable groove.
fn unusual_ratings(case: &Case, nut: &Nut) -> String {
    let given = [
        ("C_a", case.rated_dynamic_load_N, nut.dynamic_rating().rating),
        ("C_0a", case.rated_static_load_N, nut.static_rating().rating),
    ];
    let given = given.into_iter().filter_map(|(symbol, given, calculated)| {
        Some(format!(
            "{symbol} is {} N in this row, but {calculated:.0} N for the most probable groove",
            format_trimmed(given?)
        ))
    });
    format!(
        "few typical grooves with these dimensions have these ratings: {}; check ball diameter, turns and ratings",
        given.collect::<Vec<_>>().join(", and ")
    )
}

/// Text in the groove column of a nut whose groove is neither given nor estimated.
const NO_GROOVE: &str = "none";

/// Describes the ball of an estimated groove, and whether its diameter is given or estimated.
fn estimated_ball(case: &Case) -> Option<String> {
    let what = if case.estimates(InputKey::ball_diameter_mm.name()) {
        "estimated together with the ball diameter of"
    } else {
        "estimated for the given ball diameter of"
    };
    Some(format!("{what} {} mm", format_trimmed(case.ball_diameter_mm?)))
}

/// Columns of values that manufacturers state, each with the column of the corresponding calculated
/// value.
const RATED: [[OutputName; 2]; 3] = [
    [output!(dynamic_load_rating_N), output!(our_dynamic_load_rating_N)],
    [output!(static_load_rating_N), output!(our_static_load_rating_N)],
    [output!(stiffness_N_um), output!(our_stiffness_N_um)],
];

/// A manufacturer's nut, compared with the calculation.
#[derive(Debug, Clone)]
pub struct ManufacturerRow {
    /// Name of the nut.
    pub name: String,
    /// Case of the nut. If a requirement is given, the nut is on the axis of the requirement.
    pub case: Case,
    /// Values stated by the manufacturer, and values calculated for the same nut. If there is a
    /// requirement, the results on the axis sheet follow.
    pub numbers: Vec<ListNumber>,
    /// Verdict according to the rules of the axis sheet and the selection limits; `None` without a
    /// requirement.
    pub verdict: Option<Verdict>,
    /// Titles of the violated rules and labels of the violated selection limits.
    pub failed_rules: Vec<&'static str>,
    /// Warnings on the axis sheet of the nut.
    pub warnings: Vec<String>,
    /// Description of the estimated ball, or `none` if no groove can be estimated. `None` if the
    /// groove is given.
    pub groove: Option<String>,
    /// Description of a contradiction between ratings and geometry, including the contradictory
    /// values.
    pub contradiction: Option<String>,
    /// Notes on an estimated groove: unusual ratings, and rules that are met only for some of the
    /// possible grooves.
    pub notes: Vec<String>,
    /// Cells of the columns that the program does not know, such as the price.
    pub extra: Vec<ExtraCell>,
}

/// Ratio of ball diameter to lead above which the ball does not fit between adjacent turns.
const MAX_BALL_OVER_LEAD: f64 = 0.8;

/// Smallest number of rows for which the median of the rating ratios is meaningful.
const MIN_ROWS_OF_MEDIAN: usize = 5;

/// Plausible range of the rating ratio in a row, relative to the median of all rows.
const RATIO_OVER_MEDIAN: (f64, f64) = (0.88, 1.14);

/// Title of the rule that the ratings and the geometry in a row must belong to the same nut.
const SAME_NUT: &str = "ratings and geometry belong to the same nut";

/// A numeric value of a nut in a list.
#[derive(Debug, Clone, Copy)]
pub struct ListNumber {
    /// Output of the column, with name, unit and meaning.
    pub column: &'static Output,
    /// Value in the unit of the column; `None` if it is not known.
    pub value: Option<f64>,
    /// 90 % interval, if the value depends on an estimated groove.
    pub band: Option<Band>,
}

/// Returns the values of the given columns in an answer, with their intervals.
fn numbers_of(
    answer: &Answer,
    columns: impl Iterator<Item = &'static Output>,
) -> impl Iterator<Item = ListNumber> {
    columns.map(|column| {
        let (value, band) = (answer.number(column.into()), answer.band(column.name));
        ListNumber { column, value, band }
    })
}

impl ManufacturerRow {
    /// Compares a manufacturer's nuts with the calculation, and checks them in the axis of a
    /// requirement. Nuts that pass all rules come first. Nuts with the same verdict are sorted by
    /// the mass of screw and nut. An unknown mass of a nut is assumed to be zero.
    ///
    /// # Errors
    /// Returns the name of the nut that cannot be calculated, together with the [`CaseError`] that
    /// names the missing or invalid input.
    pub fn all(
        nuts: &[ManufacturerNut],
        requirement: Option<&RequirementFile>,
    ) -> Result<Vec<Self>, (String, CaseError)> {
        let mut inputs = ManufacturerNut::inputs(nuts);
        // With a requirement, a column of the axis sheet contains the unsupported length.
        inputs.retain(|key| requirement.is_none() || *key != InputKey::unsupported_length_mm);
        let row = |nut: &ManufacturerNut| -> Result<Self, (String, CaseError)> {
            let mut row = Self::of(nut, requirement).map_err(|error| (nut.name.clone(), error))?;
            let input = |key: &InputKey| ListNumber {
                column: Output::input(*key),
                value: nut.case[*key],
                band: None,
            };
            row.numbers.splice(0..0, inputs.iter().map(input));
            Ok(row)
        };
        let rows = bsm_design::groove::on_all_cores(nuts, row);
        let mut rows = rows.into_iter().collect::<Result<Vec<_>, _>>()?;
        Self::compare(&mut rows);
        let mass = |row: &Self| {
            let screw = row.value(output!(screw_mass_kg)).unwrap_or(f64::INFINITY);
            screw + row.value(output!(nut_mass_kg)).unwrap_or(0.0)
        };
        rows.sort_by(|a, b| b.verdict.cmp(&a.verdict).then(mass(a).total_cmp(&mass(b))));
        Ok(rows)
    }

    fn of(nut: &ManufacturerNut, requirement: Option<&RequirementFile>) -> Result<Self, CaseError> {
        let mut at = nut.case.clone();
        at.axial_load_N = at.rated_dynamic_load_N.map(|rating| STIFFNESS_LOAD_RATIO * rating);
        let (at, refused) = groove_or_reason(at)?;
        let is_estimated = at.has_estimated_groove();
        let compared =
            with_groove_intervals(&at, FEW_DRAWS, |case| -> Result<Answer, CaseError> {
                let calculated =
                    if case.lacks_groove() { Answer::default() } else { ratings(case)? };
                let numbers =
                    read_compared(&ComparedNut { nut, calculated, is_estimated }, |_| true);
                Ok(Answer::default().with("ratings", Content::numbers(numbers, "nut")))
            })?;
        let calculated = (!at.lacks_groove() && !is_estimated).then(|| rated_nut::nut(&at));
        // If the given and calculated ratings differ by more than a factor of 2, the given ratings
        // belong to another nut.
        let other = calculated.transpose()?.and_then(|nut| rated_nut::compared(&at, &nut).err());
        let none = refused.as_ref().map(|_| NO_GROOVE.to_owned());
        let unusual = if at.has_unusual_groove() {
            Some(unusual_ratings(&nut.case, &rated_nut::nut(&at)?))
        } else {
            None
        };
        let contradiction = refused.or(other.as_ref().map(CaseError::to_string)).or(unusual);
        // The first note, which describes the estimate itself, is skipped.
        let of_ratings = compared.notes.iter().skip(1).chain(&compared.warnings);
        let mut row = Self {
            name: nut.name.clone(),
            case: nut.case.clone(),
            numbers: numbers_of(&compared, COMPARED.iter().flat_map(|of| of.columns)).collect(),
            verdict: None,
            failed_rules: Vec::new(),
            warnings: Vec::new(),
            groove: if is_estimated { estimated_ball(&at) } else { none },
            contradiction,
            notes: of_ratings.cloned().collect(),
            extra: nut.extra.clone(),
        };
        let Some(requirement) = requirement else { return Ok(row) };
        row.case = nut.within(requirement);
        if other.is_some() {
            row.verdict = Some(Verdict::Fails);
            row.failed_rules = vec![SAME_NUT];
            row.numbers.extend(numbers_of(&Answer::default(), sheet_columns()));
            return Ok(row);
        }
        let (case, _) = groove_or_reason(row.case.clone())?;
        let mut sheet = requirement.axis_sheet(&case)?;
        row.warnings.clone_from(&sheet.answer.warnings);
        let own_notes = sheet.answer.notes.len();
        let settings = sheet.settings;
        sheet = sheet
            .with_groove_intervals(|possible| AxisReport::numbers_only(possible, &settings).ok());
        row.verdict = Some(requirement.verdict(&sheet));
        row.failed_rules = requirement.failed_rules(&sheet);
        let sheet = sheet.answer;
        row.numbers.extend(numbers_of(&sheet, sheet_columns()));
        // The first note describes the groove estimate, and the notes of the axis sheet follow.
        // Both are skipped. The remaining notes concern the uncertainty of the estimated groove.
        for note in sheet.notes.into_iter().skip(1 + own_notes) {
            if !row.notes.contains(&note) {
                row.notes.push(note);
            }
        }
        Ok(row)
    }

    /// Returns the value in the column with the given name.
    pub fn value(&self, name: OutputName) -> Option<f64> {
        self.number(name.name())?.value
    }

    /// Returns the value of an input that occurs in the table.
    pub fn input(&self, key: InputKey) -> Option<f64> {
        self.number(key.name())?.value
    }

    /// Returns the 90 % interval of the value in the column with the given name, or `None` if the
    /// value does not depend on an estimated groove.
    pub fn band(&self, name: OutputName) -> Option<Band> {
        self.number(name.name())?.band
    }

    /// Works like [`ManufacturerRow::band`], for a column of the list. An unknown name has no
    /// interval.
    pub(crate) fn band_of_column(&self, name: &str) -> Option<Band> {
        self.number(name)?.band
    }

    fn number(&self, name: &str) -> Option<&ListNumber> {
        self.numbers.iter().find(|number| number.column.name == name)
    }

    /// Returns the number in the column with the given index; the columns that the program does not
    /// know follow after the columns that it knows.
    pub(crate) fn number_at(&self, place: usize) -> Option<f64> {
        match place.checked_sub(self.numbers.len()) {
            Some(place) => self.extra[place].number(),
            None => self.numbers[place].value,
        }
    }

    /// Returns the text in the column with the given name, or `None` if the cell is empty or the
    /// table has no such column of text.
    pub(crate) fn text_in(&self, name: &str) -> Option<&str> {
        match name {
            "nut" => Some(&self.name),
            "manufacturer" => self.case.entries.manufacturer.as_deref(),
            own => self.extra.iter().find(|cell| cell.name == own)?.text(),
        }
    }

    /// Returns a JSON object with the 90 % interval of each value. The keys are the names of the
    /// columns.
    fn intervals(&self) -> Value {
        let named = |ListNumber { column, band, .. }: &ListNumber| {
            Some((column.name.to_owned(), json!(pair((*band)?))))
        };
        Value::Object(self.numbers.iter().filter_map(named).collect::<Map<_, _>>())
    }
}

/// Name, unit and values of a table column.
pub type TableColumn = (String, &'static str, ColumnValues);

impl ManufacturerRow {
    /// Sets `contradiction` in the rows whose ratings contradict their geometry. In such a row, the
    /// ball is too large for the lead, or the ratio of calculated to stated dynamic load rating
    /// differs from the median of the table. The median is the reference because manufacturers do
    /// not publish the conformity, and a different conformity shifts the ratios of the whole table.
    fn compare(rows: &mut [Self]) {
        let ratio = |row: &Self| {
            let [stated, calculated] = RATED[0].map(|name| row.value(name));
            Some(calculated? / stated?)
        };
        let mut ratios: Vec<_> = rows.iter().filter_map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let median = ratios.get(ratios.len() / 2).filter(|_| ratios.len() >= MIN_ROWS_OF_MEDIAN);
        let (low, high) = RATIO_OVER_MEDIAN;
        for row in rows.iter_mut().filter(|row| row.contradiction.is_none()) {
            let [ball, lead] =
                [InputKey::ball_diameter_mm, InputKey::lead_mm].map(|key| row.input(key));
            let size = ball.zip(lead).filter(|(ball, lead)| ball / lead > MAX_BALL_OVER_LEAD);
            let of_ball = size.map(|(ball, lead)| {
                format!(
                    "ball_diameter_mm {} is more than {MAX_BALL_OVER_LEAD} times lead_mm {}, so adjacent turns touch",
                    format_trimmed(ball),
                    format_trimmed(lead)
                )
            });
            let far = ratio(row)
                .zip(median)
                .filter(|(ratio, median)| !(low..=high).contains(&(ratio / **median)));
            let of_rating = far.map(|(ratio, median)| {
                format!(
                    "the ratio of calculated to stated dynamic load rating is {}, but the median of the table is {}; check ball diameter, turns and rating in this row",
                    format_digits(ratio, 3),
                    format_digits(*median, 3)
                )
            });
            row.contradiction = of_ball.or(of_rating);
        }
    }

    /// Returns the Pareto-optimal rows with respect to dynamic load rating, stiffness and mass.
    /// Rows that fail a requirement are excluded.
    ///
    /// * `places`: indices of the rows to compare.
    pub(crate) fn pareto_front(rows: &[Self], places: &[u32]) -> Vec<u32> {
        let places: Vec<_> = places
            .iter()
            .copied()
            .filter(|place| rows[*place as usize].verdict != Some(Verdict::Fails))
            .collect();
        let costs = |place: &u32| {
            let row = &rows[*place as usize];
            let [rating, stiffness, mass] =
                [output!(dynamic_load_rating_N), output!(our_stiffness_N_um), output!(nut_mass_kg)]
                    .map(|name| row.value(name));
            // A missing number is treated as the worst possible value.
            let stiffness = row.value(output!(stiffness_N_um)).or(stiffness);
            [-rating.unwrap_or(0.0), -stiffness.unwrap_or(0.0), mass.unwrap_or(f64::INFINITY)]
        };
        let costs: Vec<_> = places.iter().map(costs).collect();
        bsm_design::catalog::front(&costs).into_iter().map(|place| places[place]).collect()
    }

    /// Columns that contain text, with their meaning.
    pub const TEXTS: [(&str, &str); 5] = [
        ("nut", "name of the nut, or the number of its row"),
        ("passes", "true, false or undecided: whether the nut passes all rules of the requirement"),
        ("failed_rules", "rules of the requirement that the nut fails"),
        ("groove", "given, or a description of the estimated ball"),
        ("contradiction", "reason why ratings and geometry of the row contradict each other"),
    ];

    /// Returns true if a column of text has the given name.
    pub(crate) fn is_text(name: &str) -> bool {
        Self::TEXTS.iter().any(|(text, _)| *text == name)
    }

    /// Returns the columns of a table of nuts. A column in which any number depends on an estimated
    /// groove is followed by two columns with the ends of the 90 % intervals.
    pub fn table(rows: &[&Self]) -> Vec<TableColumn> {
        let Some(first) = rows.first() else { return Vec::new() };
        let text = |name: &str, cell: &dyn Fn(&Self) -> Option<String>| -> TableColumn {
            (name.to_owned(), "", ColumnValues::Texts(rows.iter().map(|row| cell(row)).collect()))
        };
        let mut columns = vec![text("nut", &|row| Some(row.name.clone()))];
        for (place, ListNumber { column, .. }) in first.numbers.iter().enumerate() {
            let values = |read: fn(&ListNumber) -> Option<f64>| {
                let values = rows.iter().map(|row| read(&row.numbers[place]).unwrap_or(f64::NAN));
                ColumnValues::Numbers(values.collect())
            };
            columns.push((column.name.to_owned(), column.unit, values(|number| number.value)));
            if rows.iter().any(|row| row.numbers[place].band.is_some()) {
                let [low, high] = Output::end_names(column.name, column.unit);
                columns.push((low, column.unit, values(|number| Some(number.band?.low))));
                columns.push((high, column.unit, values(|number| Some(number.band?.high))));
            }
        }
        if first.verdict.is_some() {
            columns.push(text("passes", &|row| {
                let passes = row.verdict?.passes();
                Some(passes.map_or_else(|| "undecided".to_owned(), |passes| passes.to_string()))
            }));
            columns.push(text("failed_rules", &|row| {
                (!row.failed_rules.is_empty()).then(|| row.failed_rules.join("; "))
            }));
        }
        columns.push(text("groove", &|row| {
            Some(row.groove.clone().unwrap_or_else(|| "given".to_owned()))
        }));
        columns.push(text("contradiction", &|row| row.contradiction.clone()));
        for (place, cell) in first.extra.iter().enumerate() {
            columns.push(if cell.is_numeric() {
                let number = |row: &&Self| row.extra[place].number().unwrap_or(f64::NAN);
                let numbers = rows.iter().map(number).collect();
                (cell.name.clone(), "", ColumnValues::Numbers(numbers))
            } else {
                text(&cell.name, &|row| row.extra[place].text().map(str::to_owned))
            });
        }
        columns
    }

    /// Returns the table cells that state whether a nut passes, the failed rules as a list, and the
    /// failed rules as text for the screen. Returns `None` without a requirement.
    fn verdict_cells(&self) -> Option<[Value; 3]> {
        let shown = (!self.failed_rules.is_empty()).then(|| self.failed_rules.join("; "));
        Some([json!(self.verdict?.passes()), json!(self.failed_rules), json!(shown)])
    }

    /// Returns the answer with one row per nut. The answer fails if no nut passes the rules of its
    /// requirement.
    ///
    /// * `count`: number of rows in the answer.
    /// * `is_shown`: function that returns true if the screen shows the column with the given
    ///   index.
    pub fn answer(rows: &[&Self], count: usize, is_shown: impl Fn(usize) -> bool) -> Answer {
        let Some(first) = rows.first() else {
            return Answer::default().with("", Content::Table(Table::default()));
        };
        let numbers = first.numbers.iter().enumerate().map(|(place, ListNumber { column, .. })| {
            let head = is_shown(place).then_some(column.name);
            Column { unit: column.unit, ..Column::new(column.name, head) }
        });
        let fails = rows.iter().any(|row| !row.failed_rules.is_empty());
        let of_verdict = [
            Column::new("passes", Some("")),
            Column::new("failed_rules", None),
            Column::new("", fails.then_some("failed rules")),
        ];
        let of_verdict = of_verdict.into_iter().filter(|_| first.verdict.is_some());
        let are_estimated = rows.iter().any(|row| row.groove.is_some());
        let of_grooves = [("groove", Some("groove")), ("intervals", None), ("notes", None)];
        let of_grooves = of_grooves.map(|(name, head)| Column::new(name, head));
        let of_grooves = of_grooves.into_iter().filter(|_| are_estimated);
        let extra_numbers: Vec<_> =
            (0..first.extra.len()).filter(|place| first.extra[*place].is_numeric()).collect();
        // JSON contains these numbers in `texts`.
        let of_extra = extra_numbers.iter().map(|place| Column {
            head: Some(first.extra[*place].name.clone().into()),
            ..Column::new("", None)
        });
        let texts = Some(Column::new("texts", None)).filter(|_| !first.extra.is_empty());
        let row = |row: &&Self| {
            let numbers = row.numbers.iter().map(|number| json!(number.value));
            let of_groove = [json!(row.groove), row.intervals(), json!(row.notes)];
            let texts: Map<_, _> =
                row.extra.iter().map(|cell| (cell.name.clone(), cell.json())).collect();
            std::iter::once(json!(row.name))
                .chain(numbers)
                .chain(row.verdict_cells().into_iter().flatten())
                .chain(of_groove.into_iter().filter(|_| are_estimated))
                .chain(extra_numbers.iter().map(|place| json!(row.extra[*place].number())))
                .chain(Some(Value::Object(texts)).filter(|_| !first.extra.is_empty()))
                .collect()
        };
        let columns: Vec<_> = std::iter::once(Column::new("nut", Some("nut")))
            .chain(numbers)
            .chain(of_verdict)
            .chain(of_grooves)
            .chain(of_extra)
            .chain(texts)
            .collect();
        let bands = |row: &&Self| {
            let mut cells = vec![None];
            cells.extend(row.numbers.iter().map(|number| number.band));
            cells.resize(columns.len(), None);
            cells
        };
        let listed = &rows[..rows.len().min(count)];
        let bands = listed.iter().map(bands).collect();
        let table =
            Table { rows: listed.iter().map(row).collect(), bands, columns, ..Table::default() };
        let ratio = |[name, our]: [OutputName; 2]| {
            let ratios = rows.iter().filter_map(|row| Some(row.value(our)? / row.value(name)?));
            let (low, high) =
                ratios.fold((f64::INFINITY, 0.0_f64), |(l, h), r| (l.min(r), h.max(r)));
            (high > 0.0)
                .then(|| format!("{} {} to {}", name.name(), format_short(low), format_short(high)))
        };
        let ratios: Vec<_> = RATED.into_iter().filter_map(ratio).collect();
        let judged = |verdict| rows.iter().filter(|row| row.verdict == Some(verdict)).count();
        let (passing, undecided) = (judged(Verdict::Passes), judged(Verdict::Undecided));
        let sized = first.verdict.is_some();
        let mut answer = Answer { fails: sized && passing + undecided == 0, ..Answer::default() }
            .with("", Content::Table(table))
            .with_shown(Content::Text(
                "calculated / stated:",
                (!ratios.is_empty()).then(|| ratios.join(", ")),
            ));
        let choice =
            rows.first().filter(|row| row.verdict.is_some_and(|verdict| verdict != Verdict::Fails));
        let warning = |row: &Self| {
            let name = row.name.clone();
            row.warnings.clone().into_iter().map(move |text| format!("{name}: {text}"))
        };
        let contradictions = rows
            .iter()
            .filter_map(|row| Some(format!("{}: {}", row.name, row.contradiction.as_ref()?)));
        answer
            .warnings
            .extend(contradictions.chain(choice.into_iter().flat_map(|row| warning(row))));
        let of_choice = choice.into_iter().flat_map(|row| &row.notes);
        answer.notes.extend(of_choice.map(|note| format!("{}: {note}", rows[0].name)));
        answer.notes.extend(Self::notes(rows, passing, undecided));
        answer
    }

    /// Returns notes on the estimated grooves, the copied columns and the verdicts.
    ///
    /// * `passing`: number of nuts that pass all rules.
    /// * `undecided`: number of nuts that neither pass nor fail.
    fn notes(rows: &[&Self], passing: usize, undecided: usize) -> Vec<String> {
        let Some(first) = rows.first() else { return Vec::new() };
        let mut notes = Vec::new();
        // The text [`NO_GROOVE`] marks a nut without an estimated groove.
        let is_estimated =
            |row: &&&Self| row.groove.as_deref().is_some_and(|groove| groove != NO_GROOVE);
        let estimated = rows.iter().filter(is_estimated).count();
        notes.extend((estimated > 0).then(|| {
            format!(
                "The grooves of {estimated} of {} nuts are estimated from their ratings; intervals (low to high) contain 90 % of the possible \
                 grooves.",
                rows.len()
            )
        }));
        let names: Vec<_> = first.extra.iter().map(|cell| cell.name.as_str()).collect();
        notes.extend((!names.is_empty()).then(|| {
            format!("These columns have no effect on the calculation: {}.", names.join(", "))
        }));
        notes.extend(first.verdict.map(|_| format!("{passing} of {} nuts pass.", rows.len())));
        notes.extend((undecided > 0).then(|| {
            format!(
                "{undecided} of {} nuts neither pass nor fail: because their groove is estimated, the 90 % interval of a result contains its limit. For each of these nuts, `bsm axis` names the inputs that would decide the rule.",
                rows.len()
            )
        }));
        notes
    }
}

/// Completes the case of a nut with data that tables usually omit. The missing data are calculated
/// with a rule that reproduces the HIWIN data.
fn complete(case: &mut Case, circuits: Option<f64>, core: Option<f64>) -> Result<(), CaseError> {
    let given = case.clone();
    // Without a ball diameter, there is no groove to complete.
    if case.ball_diameter_mm.is_none() {
        return without_ball(case, circuits, core);
    }
    let conformity = Nut::USUAL_CONFORMITY;
    case.nut_conformity.get_or_insert(conformity);
    let conformity = *case.screw_conformity.get_or_insert(conformity);
    if case.groove_bottom_distance_mm.is_none() {
        case.contact_angle_deg.get_or_insert(CONTACT_ANGLE_DEG);
    }
    let Case { ball_diameter_mm: ball, contact_angle_deg: angle, lead_mm: lead, .. } = *case;
    if let (None, Some(core), Some(ball), Some(angle)) =
        (case.pitch_circle_diameter_mm, core, ball, angle)
    {
        let pitch = Nut::pitch_diameter_over(core * MM, ball * MM, conformity, angle * DEG);
        case.pitch_circle_diameter_mm = Some(pitch / MM);
    }
    if let (None, Some(circuits)) = (case.loaded_turns, circuits) {
        case.loaded_turns = Some(circuits - Nut::RETURN_TURNS);
    }
    if let (None, Some(ball), Some(pitch), Some(lead)) =
        (case.loaded_balls_per_turn, ball, case.pitch_circle_diameter_mm, lead)
    {
        case.loaded_balls_per_turn = Some((PI * pitch).hypot(lead) / ball);
    }
    case.check()?;
    if case.lacks_groove() && given.given().with_groove() != given.given() {
        // If groove inputs are still missing, the groove is estimated from the ratings.
        *case = given;
        return without_ball(case, circuits, core);
    }
    // The nut itself is not needed here, but its creation fails if inputs are missing.
    rated_nut::nut(case).map(drop)
}

/// Completes the case of a nut whose table row does not determine the groove.
fn without_ball(
    case: &mut Case,
    circuits: Option<f64>,
    core: Option<f64>,
) -> Result<(), CaseError> {
    case.shaft_diameter_mm = case.shaft_diameter_mm.or(core);
    case.loaded_turns = case.loaded_turns.or(circuits);
    case.check()
}
