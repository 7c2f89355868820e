//! Answers for a case with an estimated groove. They contain the estimated groove and the
//! uncertainty intervals of the results.

use std::collections::{HashMap, HashSet};

use bsm_design::groove::{EstimatedGroove, GrooveEstimate, Hypothesis};
use bsm_design::statistics::Band;
use bsm_design::{NutBody, NutSet, StiffnessAt};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::case::rated_screw::usual_nut_length_mm;
use crate::vocabulary::entries::Named;
use crate::vocabulary::members::{ByName, Data, answer, row};
use crate::vocabulary::number::{count, format_digits, format_trimmed};
use crate::vocabulary::units::{DEG, MM, UM};
use crate::{
    Answer, Case, Content, Criterion, InputKey, Numbers, Row, Scope, Section, Table, Verdict,
};

/// Smallest ratio of interval width to result that is significant. A narrower interval is
/// attributed to rounding errors.
const ROUNDING: f64 = 1e-9;

/// Maximum number of possible grooves for a case with a warm state. The calculation of a warm state
/// takes from 0.1 s to several seconds.
const WARM_DRAWS: usize = 16;

/// Probability of clean steel above which a note states that the load ratings are increased for
/// clean steel.
const MIN_CLEAN_STEEL_WEIGHT: f64 = 0.5;

/// Maximum number of names that a note lists.
const NAMED: usize = 4;

/// Labels of text sections that have only a few possible texts.
const DISCRETE: [&str; 3] = ["regime", "lubrication", "controlling raceway"];

/// JSON member name of the table that contains the true-or-false statements about a motion.
const VERDICTS: &str = "verdicts";

/// Typical ratios of catalog stiffness to contact stiffness. Ratios in this range can be explained
/// by the different conventions of manufacturers.
const USUAL_STIFFNESS: std::ops::RangeInclusive<f64> = 0.6..=0.95;

impl Case {
    /// Returns cases with possible grooves, which represent the uncertainty of an estimated groove.
    /// The list is empty if the groove is given.
    ///
    /// * `count`: number of grooves, at most [`DRAWS`](bsm_design::groove::DRAWS).
    pub fn possible_cases(&self, count: usize) -> Vec<Self> {
        let Some((line, estimate)) = self.estimate() else { return Vec::new() };
        let draws = estimate.draws(self.draws(count));
        draws.iter().enumerate().map(|(draw, groove)| line.possible(draw, groove)).collect()
    }

    /// Returns the number of possible grooves to calculate, which is at most [`WARM_DRAWS`] for a
    /// warm state.
    pub(crate) fn draws(&self, count: usize) -> usize {
        if self.requests_warm_state() { count.min(WARM_DRAWS) } else { count }
    }

    /// Calls `f` in parallel with a case for each possible groove and returns the results. The list
    /// is empty if the groove is given.
    pub(crate) fn map_possible_grooves<T: Send>(
        &self,
        count: usize,
        f: impl Fn(&Self) -> T + Sync,
    ) -> Vec<T> {
        let Some((line, estimate)) = self.estimate() else { return Vec::new() };
        estimate.map(self.draws(count), |draw, groove| f(&line.possible(draw, groove)))
    }

    /// Returns the case without its estimated inputs, together with the estimate of these inputs.
    fn estimate(&self) -> Option<(Self, GrooveEstimate)> {
        if !self.has_estimated_groove() {
            return None;
        }
        let mut line = self.without_estimates();
        let estimate = line.groove_estimate().ok()??;
        // The nut length is estimated from the best groove. The same nut length is used for all
        // possible grooves, so that each length on the axis sheet is a single value instead of an
        // interval.
        line.nut_length_mm = line.nut_length_mm.or_else(|| usual_nut_length_mm(self));
        Some((line, estimate))
    }

    /// Returns true if the groove is estimated, and typical grooves rarely have the ratings and
    /// dimensions of the case.
    pub(crate) fn has_unusual_groove(&self) -> bool {
        self.estimate().is_some_and(|(_, estimate)| estimate.is_unusual())
    }

    /// Returns a note about the estimated groove, or `None` if the groove is given.
    pub fn groove_note(&self) -> Option<String> {
        let (line, estimate) = self.estimate()?;
        Some(note(&estimate, &narrowing(&line, &estimate)))
    }
}

/// Calculates the answer for a case. If the groove is estimated, the answer contains the estimate
/// and 90 % intervals (see [`Answer::with_groove_intervals`]).
///
/// # Errors
/// Returns the same errors as `answer` for the case itself. If `answer` fails for some possible
/// grooves, a note states the number of these grooves.
pub fn with_groove_intervals<E>(
    case: &Case,
    count: usize,
    answer: impl Fn(&Case) -> Result<Answer, E> + Sync,
) -> Result<Answer, E> {
    Ok(answer(case)?.with_groove_intervals(case, count, |possible| answer(possible).ok()))
}

/// Estimate of a groove in JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct EstimateJson {
    /// Logarithm of the probability density of the ratings and sizes.
    ln_evidence: f64,
    /// Pairs of ball diameter \[mm\] and probability.
    balls: Vec<[f64; 2]>,
    /// Ball diameters that together have a probability of 90 % \[mm\].
    ball_set_90: Vec<f64>,
    /// Number of loaded balls: 5 %, 50 % and 95 % quantile.
    loaded_balls: [f64; 3],
    /// Number of possible grooves.
    draws: usize,
    /// Number of possible grooves without a result.
    without_result: usize,
    /// Results that exist only for some possible grooves, each with the number of these grooves.
    grooves_with_number: ByName<usize>,
    /// Members of the answer that depend on the groove, with both ends of their 90 % intervals.
    intervals: Value,
}

answer! {
    /// Estimate of a groove from the load ratings.
    pub(crate) struct EstimateMember {
        groove_estimate: Data<EstimateJson>;
    }
}

row! {
    /// A quantity of the estimate.
    struct EstimateRow {
        [skip] what: &'static str = "groove, estimated from the ratings";
        [skip] value: String = "";
        [skip] unit: &'static str = "";
        [skip] source: &'static str = "";
        [skip] sure: String = "probability or 90 % interval";
    }
}

impl Answer {
    /// Adds the groove estimate of a case to the answer, and the 90 % intervals of all results over
    /// the possible grooves. If the groove is given, the answer is returned unchanged.
    ///
    /// * `count`: number of possible grooves.
    /// * `answer`: function that calculates the answer for a case with a possible groove.
    #[must_use]
    pub fn with_groove_intervals(
        mut self,
        case: &Case,
        count: usize,
        answer: impl Fn(&Case) -> Option<Self> + Sync,
    ) -> Self {
        let count = case.draws(count);
        let Some((line, estimate)) = case.estimate() else { return self };
        let answers = estimate.map(count, |draw, groove| answer(&line.possible(draw, groove)));
        let solved: Vec<_> = answers.into_iter().flatten().collect();
        self.add_bands(&solved);
        let deciding = narrowing(&line, &estimate);
        self.name_deciding_inputs(&deciding);
        let partial = self.partial_numbers(&solved);
        self.notes.insert(0, note(&estimate, &deciding));
        self.notes.extend(about_ratings(&line, &estimate));
        self.notes.extend(self.doubtful_rules(&solved));
        self.notes.extend(self.shares(&solved));
        self.notes.extend(about_partial(&partial, solved.len()));
        if solved.len() < count {
            let without = count - solved.len();
            self.notes.push(format!("{without} of {count} possible grooves have no result."));
        }
        if estimate.is_unusual() {
            self.warnings.push(
                "Few grooves have these ratings and sizes, so the estimated groove is uncertain. Check the ratings and sizes."
                    .to_owned(),
            );
        }
        let shown = Section { member: None, content: Content::Table(shown(case, &estimate)) };
        self.sections.insert(0, shown);
        let mut intervals = self.intervals();
        if let Value::Object(intervals) = &mut intervals {
            let missing = partial.iter().filter(|number| !number.has_value);
            let missing = missing
                .filter_map(|number| Some((number.name.to_owned(), json!(pair(number.band?)))));
            intervals.extend(missing);
        }
        let counts = partial.iter().map(|number| (number.name.to_owned(), number.grooves));
        let loaded_balls = [0.05, 0.5, 0.95].map(|part| estimate.loaded_balls_quantile(part));
        self.with_members(EstimateMember {
            groove_estimate: Data(EstimateJson {
                ln_evidence: estimate.ln_evidence,
                balls: pairs(&estimate),
                ball_set_90: likely(&estimate),
                loaded_balls,
                draws: count,
                without_result: count - solved.len(),
                grooves_with_number: ByName(counts.collect()),
                intervals,
            }),
        })
    }

    /// Returns the 90 % interval of the result with the given name, or `None` if the result does
    /// not depend on an estimated groove.
    pub fn band(&self, number: &str) -> Option<Band> {
        let mut columns =
            self.all_rows().flat_map(|row| row.quantity.columns.iter().zip(row.bands));
        columns.find(|(column, _)| column.name == number)?.1
    }

    /// Adds intervals to the results, tables and rules of this answer. The intervals are calculated
    /// from the answers for the possible grooves.
    pub(crate) fn add_bands(&mut self, answers: &[Self]) {
        let rows: Vec<Vec<&Row>> = answers.iter().map(|of| of.all_rows().collect()).collect();
        for section in &mut self.sections {
            match &mut section.content {
                Content::Numbers { numbers, .. } => {
                    for row in numbers.all_mut() {
                        let same: Vec<_> =
                            rows.iter().filter_map(|rows| same_row(rows, row)).collect();
                        row.bands = [0, 1, 2].map(|member| {
                            let others = same.iter().filter_map(|other| other.values[member]);
                            band(row.values[member]?, others)
                        });
                    }
                }
                Content::Table(table) => {
                    let Some(member) = section.member else { continue };
                    let others: Vec<_> =
                        answers.iter().filter_map(|answer| answer.table(member)).collect();
                    table.add_bands(&others);
                }
                _ => {}
            }
        }
        for rule in &mut self.rules {
            let others: Vec<_> = answers.iter().filter_map(|answer| rule.same_in(answer)).collect();
            let margins = others.iter().filter_map(|other| other.margin());
            let margins = margins.filter(|margin| !margin.is_nan());
            let margins = rule.margin().and_then(|margin| interval_of(margin, margins));
            rule.band = band(rule.value, others.iter().map(|other| other.value));
            rule.margins = margins;
        }
    }

    /// Returns the results that exist only for some of the possible grooves, such as the highest
    /// speed with a thermal steady state.
    fn partial_numbers(&self, answers: &[Self]) -> Vec<PartialNumber> {
        let has_same_names = |answer: &Self| {
            answer
                .existing_numbers()
                .map(|(name, _)| name)
                .eq(self.existing_numbers().map(|(name, _)| name))
        };
        if answers.iter().all(has_same_names) {
            return Vec::new();
        }
        let mut values: HashMap<&str, Vec<f64>> = HashMap::new();
        let mut names: Vec<_> = self.existing_numbers().map(|(name, _)| name).collect();
        let own: HashSet<_> = names.iter().copied().collect();
        for answer in answers {
            let mut seen = HashSet::new();
            for (name, value) in answer.existing_numbers() {
                if seen.insert(name) {
                    values.entry(name).or_default().push(value);
                    names.push(name);
                }
            }
        }
        let mut seen = HashSet::new();
        names.retain(|name| seen.insert(*name));
        let partial = |name: &'static str| {
            let (values, has_value) = (values.remove(name).unwrap_or_default(), own.contains(name));
            let (grooves, band) = (values.len(), Band::of(values));
            let is_partial = grooves < answers.len() || !has_value;
            is_partial.then_some(PartialNumber { name, has_value, grooves, band })
        };
        names.into_iter().filter_map(partial).collect()
    }

    /// Returns the results that have a value. If a result occurs in several sections, it is
    /// returned once per section.
    fn existing_numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let rows = self.all_rows().filter(|row| row.quantity.scope != Scope::Statement);
        let values = rows.flat_map(|row| row.quantity.columns.iter().zip(row.values));
        values.filter_map(|(column, value)| Some((column.name, value?)))
    }

    /// Returns the table of the section whose JSON member has the given name.
    fn table(&self, member: &str) -> Option<&Table> {
        match self.section(member) {
            Some(Content::Table(table)) => Some(table),
            _ => None,
        }
    }

    fn all_rows(&self) -> impl Iterator<Item = &Row> {
        let numbers = self.sections.iter().filter_map(|section| match &section.content {
            Content::Numbers { numbers, .. } => Some(numbers),
            _ => None,
        });
        numbers.flat_map(Numbers::all)
    }

    /// For each rule that is undecided because the groove is estimated, adds the names of the
    /// inputs that would decide it.
    fn name_deciding_inputs(&mut self, deciding: &[&str]) {
        let undecided = |rule: &&mut Criterion| {
            rule.verdict() == Verdict::Undecided && rule.margin_without_default.is_none()
        };
        for rule in self.rules.iter_mut().filter(undecided).filter(|_| !deciding.is_empty()) {
            let decide = format!("{} to decide the rule", alternatives(deciding));
            rule.remedy = Some(match rule.remedy.take() {
                Some(remedy) => format!("{decide}; or {remedy}"),
                None => decide,
            });
        }
    }

    /// Returns a note for each rule that is met for some possible grooves and violated for others.
    fn doubtful_rules(&self, answers: &[Self]) -> Vec<String> {
        let doubt = |rule: &Criterion| {
            let same: Vec<_> = answers.iter().filter_map(|answer| rule.same_in(answer)).collect();
            let failing = same.iter().filter(|other| other.fails()).count();
            (0 < failing && failing < same.len()).then(|| {
                let undecided = match rule.verdict() {
                    Verdict::Undecided => "is undecided: it ",
                    _ => "",
                };
                format!(
                    "The rule `{}` {undecided}fails for {failing} of {} possible grooves.",
                    rule.title,
                    same.len()
                )
            })
        };
        self.rules.iter().filter_map(doubt).collect()
    }

    /// Returns a note for each slip regime or verdict that is not the same for all possible
    /// grooves. The note states the percentage of grooves that agree with the best groove.
    fn shares(&self, answers: &[Self]) -> Vec<String> {
        let note = |what: &str, value: &str, same: usize| {
            let percent = 100.0 * count(same) / count(answers.len());
            (same < answers.len())
                .then(|| format!("{what}: {value} for {percent:.0} % of the possible grooves."))
        };
        let mut notes = Vec::new();
        for section in &self.sections {
            match &section.content {
                Content::Text(label, Some(words)) if DISCRETE.contains(label) => {
                    let is_same = |answer: &&Self| answer.text(label) == Some(words);
                    notes.extend(note(label, words, answers.iter().filter(is_same).count()));
                }
                Content::Table(table) if section.member == Some(VERDICTS) => {
                    for (place, row) in table.rows.iter().enumerate() {
                        let [Value::String(what), Value::Bool(holds), ..] = &row[..] else {
                            continue;
                        };
                        let is_same = |answer: &&Self| {
                            let other = answer.table(VERDICTS).and_then(|of| of.rows.get(place));
                            other.is_some_and(|other| other[1] == *holds)
                        };
                        let same = answers.iter().filter(is_same).count();
                        notes.extend(note(what, if *holds { "yes" } else { "no" }, same));
                    }
                }
                _ => {}
            }
        }
        notes
    }

    /// Returns the text of the section with the given label.
    fn text(&self, label: &str) -> Option<&String> {
        self.sections.iter().find_map(|section| match &section.content {
            Content::Text(own, words) if *own == label => words.as_ref(),
            _ => None,
        })
    }

    /// Returns all intervals as a JSON object. The keys are the names of results, the titles of
    /// rules, and the member names of tables. The intervals of a table have the layout of the
    /// table.
    pub fn intervals(&self) -> Value {
        let mut map = Map::new();
        for row in self.all_rows() {
            for (column, band) in row.quantity.columns.iter().zip(row.bands) {
                if let Some(band) = band {
                    map.insert(column.name.to_owned(), json!(pair(band)));
                }
            }
        }
        for section in &self.sections {
            let (Some(member), Content::Table(table)) = (section.member, &section.content) else {
                continue;
            };
            if table.bands.iter().flatten().any(Option::is_some) {
                map.insert(member.to_owned(), table.intervals());
            }
        }
        let of_rule = |rule: &Criterion| Some((rule.title.to_owned(), json!(pair(rule.band?))));
        let rules: Map<_, _> = self.rules.iter().filter_map(of_rule).collect();
        if !rules.is_empty() {
            map.insert("rules".to_owned(), Value::Object(rules));
        }
        Value::Object(map)
    }
}

/// A result that exists only for some of the possible grooves.
struct PartialNumber {
    name: &'static str,
    /// True if the result exists for the best groove.
    has_value: bool,
    /// Number of possible grooves for which the result exists.
    grooves: usize,
    /// 90 % interval of the result over the grooves for which the result exists.
    band: Option<Band>,
}

/// Describes the results that exist only for some of the possible grooves. Results that exist for
/// the same grooves share one note.
///
/// * `count`: number of possible grooves.
fn about_partial(numbers: &[PartialNumber], count: usize) -> Vec<String> {
    let mut groups: Vec<Vec<&PartialNumber>> = Vec::new();
    for number in numbers {
        let same = |group: &&mut Vec<&PartialNumber>| {
            (group[0].has_value, group[0].grooves) == (number.has_value, number.grooves)
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    let note = |group: &Vec<&PartialNumber>| {
        let PartialNumber { has_value, grooves, .. } = *group[0];
        let shown = |number: &&PartialNumber| match number.band.filter(|_| !has_value) {
            Some(Band { low, high }) => {
                format!("{} ({} to {})", number.name, format_digits(low, 3), format_digits(high, 3))
            }
            None => number.name.to_owned(),
        };
        let mut names: Vec<_> = group.iter().take(NAMED).map(shown).collect();
        if group.len() > NAMED {
            names.push(format!("{} more results", group.len() - NAMED));
        }
        let names = names.join(", ");
        if has_value {
            format!(
                "Only {grooves} of {count} possible grooves have values for {names}. The 90 % intervals refer to these grooves."
            )
        } else {
            format!(
                "The best groove has no value for {names}, but {grooves} of {count} possible grooves have one."
            )
        }
    };
    groups.iter().map(note).collect()
}

/// Returns both ends of an interval.
pub(crate) fn pair(band: Band) -> [f64; 2] {
    [band.low, band.high]
}

impl Table {
    /// Returns the 90 % interval of the cell in the given row and column, or `None` if the cell
    /// does not depend on an estimated groove.
    pub fn band(&self, row: usize, column: &str) -> Option<Band> {
        let place = self.columns.iter().position(|own| own.name == column)?;
        *self.bands.get(row)?.get(place)?
    }

    /// Returns the intervals of the cells by row and column, as in [`Answer::to_json`].
    fn intervals(&self) -> Value {
        let row = |bands: &Vec<Option<Band>>| -> Value {
            let named = self.columns.iter().zip(bands);
            let named = named.filter_map(|(column, band)| {
                Some((column.name.clone().into_owned(), json!(pair((*band)?))))
            });
            Value::Object(named.collect())
        };
        if !self.keyed {
            return self.bands.iter().map(row).collect();
        }
        let key = |row: &[Value]| row[0].as_str().unwrap_or_default().to_owned();
        let rows = self.rows.iter().zip(&self.bands);
        Value::Object(rows.map(|(cells, bands)| (key(cells), row(bands))).collect())
    }

    /// Adds an interval to each number of the table. The interval is calculated from the
    /// corresponding numbers in the tables for the possible grooves.
    fn add_bands(&mut self, others: &[&Self]) {
        let same: Vec<_> =
            others.iter().filter(|other| other.rows.len() == self.rows.len()).collect();
        let cell = |row: usize, column: usize| {
            let value = self.rows[row][column].as_f64()?;
            let others = same.iter().filter_map(|other| other.rows[row].get(column)?.as_f64());
            band(value, others)
        };
        let row = |row: usize| (0..self.columns.len()).map(|column| cell(row, column)).collect();
        self.bands = (0..self.rows.len()).map(row).collect();
    }
}

/// Returns the row with the same quantity as `row`.
fn same_row<'a>(rows: &[&'a Row], row: &Row) -> Option<&'a Row> {
    let is_same = |other: &&&Row| {
        (other.quantity.title, other.quantity.name) == (row.quantity.title, row.quantity.name)
    };
    // The answers usually share one static table of quantities. The rows are therefore first
    // compared by the address of their quantity, and by name only if no address matches.
    let own = rows.iter().find(|other| std::ptr::eq(other.quantity, row.quantity));
    own.or_else(|| rows.iter().find(is_same)).copied()
}

/// Returns the interval of a result, calculated from its finite values for the possible grooves, or
/// `None` if the result does not depend on the groove.
fn band(value: f64, others: impl Iterator<Item = f64>) -> Option<Band> {
    interval_of(value, others.filter(|other| other.is_finite()))
}

/// Returns the interval of a result, calculated from its values for the possible grooves, or `None`
/// if the result does not depend on the groove.
fn interval_of(value: f64, others: impl Iterator<Item = f64>) -> Option<Band> {
    let band = Band::of(others)?;
    (band.high - band.low > ROUNDING * value.abs()).then_some(band)
}

impl Criterion {
    /// Returns the rule in `answer` that has the same title and limits the same quantity as this
    /// rule.
    fn same_in<'a>(&self, answer: &'a Answer) -> Option<&'a Self> {
        answer.rules.iter().find(|own| (own.title, own.name) == (self.title, self.name))
    }
}

/// Returns pairs of ball diameter \[mm\] and probability for all balls with a probability of at
/// least 0.1 %.
fn pairs(estimate: &GrooveEstimate) -> Vec<[f64; 2]> {
    let likely = estimate.balls.iter().filter(|ball| ball.probability >= 1e-3);
    likely.map(|ball| [ball.ball_diameter / MM, ball.probability]).collect()
}

/// Returns the most likely ball diameters, which together have a probability of 90 % \[mm\].
fn likely(estimate: &GrooveEstimate) -> Vec<f64> {
    estimate.likely_balls().iter().map(|ball| ball.ball_diameter / MM).collect()
}

/// Returns the names of the missing inputs that would narrow the intervals.
fn narrowing(line: &Case, estimate: &GrooveEstimate) -> Vec<&'static str> {
    let several = estimate.likely_balls().len() > 1;
    let narrowing = [
        (InputKey::nut_conformity, true),
        (InputKey::screw_conformity, true),
        (InputKey::ball_diameter_mm, several),
        (InputKey::contact_angle_deg, line.groove_bottom_distance_mm.is_none()),
    ];
    narrowing
        .into_iter()
        .filter(|(key, helps)| *helps && line[*key].is_none())
        .map(|(key, _)| key.name())
        .collect()
}

/// Joins names with commas and "or".
fn alternatives(names: &[&str]) -> String {
    match names {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        names => names.concat(),
    }
}

/// Describes the estimated groove, the meaning of the intervals, and the inputs that would narrow
/// the intervals.
fn note(estimate: &GrooveEstimate, narrowing: &[&str]) -> String {
    let EstimatedGroove { ball_diameter, conformity, contact_angle, turns, loaded_balls, .. } =
        estimate.best();
    let conformities = if (conformity.nut - conformity.screw).abs() <= 0.0 {
        format!("conformities {}", format_trimmed(conformity.nut))
    } else {
        format!(
            "conformities {} and {}",
            format_trimmed(conformity.nut),
            format_trimmed(conformity.screw)
        )
    };
    let narrow = if narrowing.is_empty() {
        String::new()
    } else {
        format!(" Give {} for a better estimate.", alternatives(narrowing))
    };
    format!(
        "The groove is estimated from the load ratings: ball {} mm, {loaded_balls} loaded balls in {} turns, {conformities}, contact \
         angle {} deg. Intervals (low to high) contain 90 % of the possible grooves.{narrow}",
        format_trimmed(ball_diameter / MM),
        format_trimmed(turns),
        format_trimmed(contact_angle / DEG)
    )
}

/// Returns notes on ratings that differ from ISO 3408-5, and on a catalog stiffness that differs
/// from the contact stiffness.
fn about_ratings(line: &Case, estimate: &GrooveEstimate) -> Vec<String> {
    let clean = estimate.clean_steel_probability() > MIN_CLEAN_STEEL_WEIGHT;
    let clean = estimate.excess_factor().filter(|_| clean).map(|factor| {
        let percent = 100.0 * (factor - 1.0);
        format!(
            "C_a is about {percent:.0} % above the basic rating of ISO 3408-5, which is typical for clean steel."
        )
    });
    let stiffness = || {
        let stated = line.rated_rigidity_N_um?;
        let Some(Named(StiffnessAt::Load(part))) = line.entries.rated_rigidity_at else {
            return None;
        };
        let nut = estimate.best().nut(estimate.line.lead, line.reader().materials());
        let contacts = nut.elasticity(&NutBody::usual(&nut, NutSet::Single)).ok()?;
        let ours = contacts.secant(part * estimate.line.dynamic_rating) * UM;
        let ratio = stated / ours;
        (!USUAL_STIFFNESS.contains(&ratio)).then(|| {
            format!(
                "rated_rigidity_N_um = {stated} is {ratio:.2} times the contact stiffness of the estimated groove, {ours:.0} N/um; ratios of 0.6 to 0.95 are typical."
            )
        })
    };
    clean.into_iter().chain(stiffness()).collect()
}

/// Returns the table of the groove estimate for the screen, which lists each quantity with its
/// value and uncertainty.
fn shown(case: &Case, estimate: &GrooveEstimate) -> Table {
    let estimated = case.entries.estimated_inputs.iter().flatten();
    let estimated: Vec<_> = estimated.map(|name| name.0).collect();
    let is_estimated = |key| estimated.contains(&key);
    let length = case.display_units().of("mm");
    let draws = estimate.draws(bsm_design::groove::DRAWS);
    let ends = |key: InputKey| {
        let read = |groove: &EstimatedGroove| match key {
            InputKey::nut_conformity => groove.conformity.nut,
            InputKey::screw_conformity => groove.conformity.screw,
            InputKey::contact_angle_deg => groove.contact_angle / DEG,
            _ => length.value(groove.pitch_diameter / MM),
        };
        let Some(Band { low, high }) = Band::of(draws.iter().map(read)) else {
            return String::new();
        };
        format!("{} to {}", format_digits(low, 3), format_digits(high, 3))
    };
    let mut rows = Vec::new();
    let mut row = |what, value: String, unit, source, sure: String| {
        rows.push(EstimateRow { what, value, unit, source, sure });
    };
    let best = estimate.best();
    if is_estimated(InputKey::ball_diameter_mm) {
        let others = estimate.likely_balls().iter().skip(1).map(|ball| {
            let percent = 100.0 * ball.probability;
            let diameter = format_trimmed(length.value(ball.ball_diameter / MM));
            format!("{diameter} {}: {percent:.0} %", length.text)
        });
        let percent = 100.0 * estimate.balls[0].probability;
        let sure = std::iter::once(format!("{percent:.0} %")).chain(others);
        let sure = sure.collect::<Vec<_>>().join(", ");
        let diameter = format_trimmed(length.value(best.ball_diameter / MM));
        row("ball diameter", diameter, length.text, "estimated", sure);
    }
    let [low, high] = [0.05, 0.95].map(|part| estimate.loaded_balls_quantile(part));
    let sure = format!("{low:.0} to {high:.0}");
    row("loaded balls", best.loaded_balls.to_string(), "", "estimated", sure);
    if is_estimated(InputKey::loaded_turns) {
        row("loaded turns", format_trimmed(best.turns), "", "assumed", turns(&estimate.hypotheses));
    }
    let others = [
        (InputKey::nut_conformity, "conformity of the nut", best.conformity.nut, ""),
        (InputKey::screw_conformity, "conformity of the screw", best.conformity.screw, ""),
        (InputKey::contact_angle_deg, "contact angle", best.contact_angle / DEG, "deg"),
        (
            InputKey::pitch_circle_diameter_mm,
            "pitch circle diameter",
            length.value(best.pitch_diameter / MM),
            length.text,
        ),
    ];
    for (key, what, value, unit) in others {
        if is_estimated(key) {
            row(what, format_trimmed(value), unit, "assumed", ends(key));
        }
    }
    Table::of(&rows)
}

/// Describes the 90 % range of the number of loaded turns. The hypotheses are weighted by their
/// probabilities.
fn turns(hypotheses: &[Hypothesis]) -> String {
    let mut sorted: Vec<_> = hypotheses.iter().map(|of| (of.turns, of.probability)).collect();
    sorted.sort_by(|one, other| one.0.total_cmp(&other.0));
    let at = |part: f64| {
        let mut sum = 0.0;
        let place = sorted.iter().position(|(_, probability)| {
            sum += probability;
            sum >= part
        });
        place.or(sorted.len().checked_sub(1)).map_or(f64::NAN, |place| sorted[place].0)
    };
    format!("{} to {}", format_trimmed(at(0.05)), format_trimmed(at(0.95)))
}
