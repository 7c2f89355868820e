//! Selection of a screw for a requirement. The results are named quantities with units.

use std::cell::RefCell;

use bsm_design::catalog::{Candidate, Size};
use bsm_design::{
    ActiveLimit, BindingLimit, Bounds, Check, Design, DesignQuantity, Infeasibility, LoadCase, Nut,
    Outcome, Pitch, Rejection, Requirement,
};
use bsm_dyn::{Direction, ModelWorkspace};

use super::axis::QUANTITIES as AXIS;
use super::ratings::QUANTITIES as RATINGS;
use crate::answers::axis::{NO_LOAD, quick_efficiency};
use crate::answers::optimum::hard_to_make;
use crate::answers::schema::CaseJson;
use crate::vocabulary::answer::limits_in_words;
use crate::vocabulary::entries::{Choice, Named};
use crate::vocabulary::members::{Data, Label, Rows, Sentences, answer, row};
use crate::vocabulary::number::{decimal, format_trimmed};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, MPA, RPM};
use crate::vocabulary::warning::{SelectionLimit, Warning};
use crate::{
    Answer, AxisReport, Case, CaseEntries, CaseError, Catalog, Criterion, INPUTS, Output,
    OutputName, Quantity, REQUIREMENT_INPUTS, RequirementFile, SizeSource, Verdict, output,
    sheet_columns,
};

/// A result of the selection procedure, and the requirement on this result.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRow {
    /// Step of Lin's procedure, or 11 for additional results.
    pub step: u8,
    /// Name of the quantity, with its unit as a suffix.
    pub name: &'static str,
    /// Label of the quantity.
    pub label: &'static str,
    /// Unit of the quantity as text.
    pub unit: &'static str,
    /// Value of the quantity; `None` if it is not known.
    pub value: Option<f64>,
    /// Requirement on the quantity as text; `None` if there is none.
    pub requirement: Option<String>,
    /// True if the requirement is met or if there is no requirement.
    pub passes: bool,
}

/// The screw that was selected for a requirement, or the reasons why no suitable screw exists.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignReport {
    /// Results for the selected screw or, if no screw meets the requirement, for the screw that
    /// violates it least.
    pub rows: Vec<DesignRow>,
    /// True if the screw meets the requirement.
    pub found: bool,
    /// Limits that determine the selection. If no screw meets the requirement, the list contains
    /// the limits that cannot be met, and the amount by which they are missed.
    pub reasons: Vec<String>,
    /// Assumptions that the selection made.
    pub notes: Vec<String>,
    /// Warnings about the screw.
    pub warnings: Vec<String>,
    /// Order data of the screw, if the axis sheet could be calculated.
    pub order: Option<String>,
    /// Case of the screw at its operating point.
    pub case: Case,
}

/// Name of the output for the efficiency of the whole screw.
const EFFICIENCY: OutputName = output!(screw_efficiency);

row! {
    /// A step of the selection.
    pub(crate) struct StepRow {
        /// Step of Lin's procedure, or 11 for additional results.
        step: u8 = "step";
        /// Name of the quantity, with its unit as a suffix.
        name: &'static str;
        [skip] label: &'static str = "";
        [skip] unit: &'static str = "";
        value: Option<f64> = "value";
        /// Requirement as text.
        required: Option<String> = "limit";
        passes: bool;
        [skip] verdict: Option<&'static str> = "";
    } unit unit
}

answer! {
    /// Selected screw.
    pub(crate) struct DesignMembers {
        /// True if the screw meets the requirement.
        found: Data<bool>;
        steps: Rows<StepRow>;
        /// Limits that determine the selection, or limits that cannot be met.
        reasons: Sentences;
        [skip] order: Label;
        case: Data<CaseJson>;
    }
}

thread_local! {
    /// Workspace of the models. Each search thread has its own workspace.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

impl DesignReport {
    /// Searches for the best screw of any size with balls of standard diameters, by Lin's
    /// procedure. If no screw meets the requirement, the report states the reasons.
    pub fn of(requirement: &RequirementFile) -> Self {
        let requirement =
            &RequirementFile { problem: requirement.problem.of_any_size(), ..requirement.clone() };
        let efficiency = |design: &Design| efficiency(requirement, design);
        let outcome =
            requirement.problem.choose(&efficiency, &|design| accepted(requirement, design));
        Self::from_outcome(requirement, outcome, None)
    }

    /// Searches for the best screw among standard sizes. Returns `None` if the lists contain no
    /// size for the requirement, for example if the requirement prescribes a lead angle.
    pub fn standard(requirement: &RequirementFile, catalog: &Catalog) -> Option<Self> {
        let Catalog { lists, limits, .. } = catalog;
        let requirement = &requirement.within(catalog);
        let efficiency = |design: &Design| efficiency(requirement, design);
        let accepted = |design: &Design| accepted(requirement, design);
        let outcome = requirement.problem.choose_standard(lists, limits, &efficiency, &accepted)?;
        Some(Self::from_outcome(requirement, outcome, Some(catalog)))
    }

    /// Describes the result of a search.
    ///
    /// * `catalog`: catalog whose sizes were searched; `None` for a search over continuous sizes.
    fn from_outcome(
        requirement: &RequirementFile,
        outcome: Outcome,
        catalog: Option<&Catalog>,
    ) -> Self {
        let (design, mut reasons, mut found, not_calculated): (_, Vec<String>, _, _) = match outcome
        {
            Outcome::Found { design, active, rejected } => {
                let mut names: Vec<_> =
                    active.iter().map(|holds| step(holds.quantity).name).collect();
                let mut words: Vec<_> = active
                    .iter()
                    .map(|holds| describe_active_limit(requirement, &design, holds))
                    .collect();
                for name in rejected.failed_rules {
                    if !names.contains(&name) {
                        names.push(name);
                        words.push(label(name).unwrap_or(name).to_owned());
                    }
                }
                (design, words, true, rejected.not_calculated)
            }
            Outcome::Infeasible { design, blocking, rejected } => {
                let words = blocking.iter().map(describe_blocking_limit).collect();
                (design, words, false, rejected.not_calculated)
            }
        };
        let source = catalog.zip(design.size).and_then(|(catalog, size)| catalog.source_of(&size));
        let mut case = case(requirement, &design);
        case.entries.manufacturer = source.and_then(|source| source.manufacturer.clone());
        let axis_sheet = requirement.axis_sheet(&case);
        let why = match &axis_sheet {
            Ok(_) => None,
            // A screw that the other commands would reject must not be reported as found.
            Err(why) if found || reasons.is_empty() => {
                found = false;
                reasons = vec![why.to_string()];
                None
            }
            Err(why) => Some(why.to_string()),
        };
        let sheet = axis_sheet.ok();
        let of_axis = sheet.as_ref().map_or_else(Vec::new, |sheet| sheet.warnings.clone());
        let has_sheet = sheet.is_some();
        let runs_away = sheet.as_ref().is_some_and(|sheet| sheet.phases.is_empty());
        let efficiency = sheet.as_ref().and_then(|sheet| sheet.number(EFFICIENCY));
        // The efficiency of a preloaded nut is calculated from all its balls.
        let design = design.with_efficiency(&requirement.problem, &|_| efficiency);
        let order = sheet.as_ref().map(|sheet| sheet.order.to_string());
        let rules = sheet.map_or_else(Vec::new, |sheet| sheet.answer.rules);
        // The order data are always accompanied by the warnings of the `axis` command.
        let texts = of_axis.iter().map(|warning| warning.text.clone());
        let mut warnings = if has_sheet { texts.collect() } else { case.warnings() };
        let best = design.value(DesignQuantity::BestContactAngle) / DEG;
        warnings.extend(hard_to_make(
            "the motion of the requirement",
            Some(best).filter(|b| !b.is_nan()),
        ));
        let load = design.value(DesignQuantity::LargestLoad);
        let is_unloaded = load == 0.0 && design.preload().is_none();
        let has_reason = why.is_some() || runs_away || is_unloaded;
        warnings.extend(why);
        if !has_reason && design.value(DesignQuantity::Efficiency).is_nan() {
            let model = requirement.settings.model.name();
            warnings.push(format!(
                "Model {model} has no solution for this screw; `bsm solve` prints the reason."
            ));
        }
        if let LoadCase::Torque { torque, .. } = requirement.problem.demand {
            let eta = design.value(DesignQuantity::Efficiency);
            let driving = requirement.problem.direction == Direction::RotaryToLinear;
            let needed = if driving { torque / eta } else { torque * eta };
            if needed.is_finite() {
                warnings.push(format!(
                    "screw_torque_Nm is interpreted as the torque of a screw without friction (Lin's step 7); \
                     with an efficiency of {eta:.4}, this load needs a torque of {} N m.",
                    format_trimmed(needed)
                ));
            }
        }
        let nut = &design.nut;
        let gap = nut.ball_gap() / nut.ball_diameter;
        if found && gap > 0.1 + 1e-6 {
            warnings.push(format!(
                "On this pitch circle, the balls of a turn leave a gap of {gap:.2} ball diameters."
            ));
        }
        let rows = rows_of(&design, &rules);
        if !found && reasons.is_empty() {
            reasons.extend(rules.iter().filter(|rule| rule.fails()).map(describe_violation));
            let limits =
                of_axis.iter().filter(|warning| requirement.violated_limit(warning).is_some());
            reasons.extend(limits.map(|warning| warning.text.clone()));
        }
        if !found && reasons.is_empty() {
            let model = requirement.settings.model.name();
            reasons.push(format!("model {model} has no solution for any screw within the limits"));
        }
        let mut notes = requirement.notes.clone();
        notes.extend(describe_not_calculated(&not_calculated));
        notes.extend(is_unloaded.then(|| NO_LOAD.to_owned()));
        notes.extend(notes_on_size(&design, source));
        let order = order.filter(|_| found);
        Self { rows, found, reasons, notes, warnings, order, case }
    }

    /// Returns the answer: whether a screw was found, the steps of the selection, and the limits.
    pub fn answer(&self) -> Answer {
        let row = |row: &DesignRow| {
            let verdict = if row.passes { "pass" } else { "FAIL" };
            StepRow {
                step: row.step,
                name: row.name,
                label: row.label,
                unit: row.unit,
                value: row.value,
                required: row.requirement.clone(),
                passes: row.passes,
                verdict: row.requirement.as_ref().map(|_| verdict),
            }
        };
        let label = if self.found { "active limit" } else { "no screw found" };
        let (notes, warnings) = (self.notes.clone(), self.warnings.clone());
        let of = Answer { notes, warnings, fails: !self.found, ..Answer::default() };
        of.with_members(DesignMembers {
            found: Data(self.found),
            steps: Rows(self.rows.iter().map(row).collect()),
            reasons: Sentences(label, self.reasons.clone()),
            order: Label("order:", self.order.clone()),
            case: Data(CaseJson(self.case.to_json())),
        })
    }
}

impl RequirementFile {
    /// Returns the catalog with the steel that the requirement specifies.
    #[must_use]
    pub fn with_its_material(&self, mut catalog: Catalog) -> Catalog {
        catalog.limits.material = self.problem.material;
        catalog
    }

    /// Returns true if a nut meets all limits of the requirement that can be checked without the
    /// loads of all balls. [`sheet_of`](Self::sheet_of) checks the other limits.
    pub fn is_met_by(&self, candidate: &Candidate) -> bool {
        let nut = &candidate.nut;
        let of_pitch = |pitch: &Pitch| match pitch {
            Pitch::Lead(lead) => (lead - nut.lead).abs() < 1e-9,
            Pitch::Angle(angle) => (angle - nut.lead_angle()).abs() < 1e-9,
        };
        let keeps = |design: &Design| {
            let mut checks = design.checks.iter().filter(|check| !check.value.is_nan());
            checks.all(Check::passes)
        };
        let Requirement { pitches, least_efficiency, largest_power, .. } = &self.problem;
        let limited = least_efficiency.is_some() || largest_power.is_some();
        let efficiency = |design: &Design| efficiency(self, design);
        if !self.problem.permits_make(candidate.size.make()) || !pitches.iter().any(of_pitch) {
            return false;
        }
        let design = Design::of_candidate(&self.problem, candidate);
        keeps(&design)
            && (!limited || design.with_efficiency(&self.problem, &efficiency).is_feasible())
    }

    /// Calculates the axis sheet (see [`AxisReport`]) against which every selected, listed or
    /// manufacturer's nut is checked.
    pub(crate) fn axis_sheet(&self, case: &Case) -> Result<AxisReport, CaseError> {
        AxisReport::without_band(case, &self.settings)
    }

    /// Returns the case of a nut at the operating point that the requirement specifies.
    pub fn case_of(&self, candidate: &Candidate) -> Case {
        case(self, &Design::of_candidate(&self.problem, candidate))
    }

    /// Returns the outputs [`sheet_columns`] for a nut in the axis of the requirement, with NaN for
    /// missing outputs. Returns `None` if the nut violates a rule of the axis sheet.
    pub fn sheet_of(&self, candidate: &Candidate) -> Option<Vec<f64>> {
        let report = self.axis_sheet(&self.case_of(candidate)).ok()?;
        let number = |column: &Output| report.number(column.into()).unwrap_or(f64::NAN);
        let suits = self.objections(&report).next().is_none();
        suits.then(|| sheet_columns().map(number).collect())
    }
}

impl RequirementFile {
    /// Returns a copy of the requirement that also contains the default limit for the number of
    /// loaded turns in a catalog.
    pub(crate) fn within(&self, catalog: &Catalog) -> Self {
        let problem = self.problem.with_usual_turns(catalog.limits.turns.high);
        Self { problem, ..self.clone() }
    }

    /// Returns the selection limit that a warning states, unless the requirement permits the
    /// warning.
    fn violated_limit(&self, warning: &Warning) -> Option<SelectionLimit> {
        let Requirement { fixed, largest_turns, ball_over_lead, .. } = &self.problem;
        let usual = Requirement::BALL_OVER_LEAD * (1.0 + 1e-9);
        warning.limit.filter(|limit| match limit {
            // A limit in the requirement replaces the default limit.
            SelectionLimit::LoadedTurns => fixed.turns.is_none() && largest_turns.is_none(),
            SelectionLimit::BallOverLead => *ball_over_lead <= usual,
            other => !(self.allow_warnings && other.can_be_allowed()),
        })
    }

    /// Returns the verdict on a screw, which is based on the rules of its axis sheet and on the
    /// selection limits in its warnings.
    pub(crate) fn verdict(&self, sheet: &AxisReport) -> Verdict {
        match self.objections(sheet).next() {
            Some(_) => Verdict::Fails,
            None => sheet.verdict(),
        }
    }

    /// Returns the titles of the violated rules on the axis sheet of a screw, and the labels of the
    /// selection limits in its warnings.
    pub(crate) fn failed_rules(&self, sheet: &AxisReport) -> Vec<&'static str> {
        let broken = sheet.answer.rules.iter().filter(|rule| rule.fails()).map(|rule| rule.title);
        let limits = sheet.warnings.iter().filter_map(|warning| self.violated_limit(warning));
        broken.chain(limits.map(SelectionLimit::label)).collect()
    }

    /// Returns the reasons why a screw is not selected: the titles of the violated rules on its
    /// axis sheet, and the labels of the selection limits in its warnings.
    pub(crate) fn objections<'a>(
        &'a self,
        sheet: &'a AxisReport,
    ) -> impl Iterator<Item = &'static str> + 'a {
        let broken = sheet.answer.rules.iter().filter(|rule| rule.fails()).map(|rule| rule.name);
        let limits = sheet.warnings.iter().filter_map(|warning| self.violated_limit(warning));
        broken.chain(limits.map(SelectionLimit::label))
    }
}

/// Checks a design against the rules of its axis sheet and the warnings that are selection limits.
/// The efficiency of a preloaded nut is checked here as well, because the search does not solve all
/// balls of a nut.
fn accepted(requirement: &RequirementFile, design: &Design) -> Result<(), Rejection> {
    let Requirement { least_efficiency, largest_power, preload, .. } = &requirement.problem;
    let case = case(requirement, design);
    let not_calculated = |why: CaseError| Rejection::NotCalculated(why.to_string());
    // Most rules can be checked quickly without friction. A warm state needs friction.
    if !case.requests_warm_state() {
        let sheet =
            requirement.axis_sheet(&case.clone().without_friction()).map_err(not_calculated)?;
        let with_value = sheet.answer.rules.iter().filter(|rule| !rule.value.is_nan());
        let broken: Vec<_> = with_value.filter(|rule| rule.fails()).map(|rule| rule.name).collect();
        if !broken.is_empty() {
            return Err(Rejection::Rules(broken));
        }
    }
    let sheet = requirement.axis_sheet(&case).map_err(not_calculated)?;
    let mut broken: Vec<_> = requirement.objections(&sheet).collect();
    let by_all_balls = preload.is_some() && (least_efficiency.is_some() || largest_power.is_some());
    if by_all_balls {
        let efficiency = |_: &Design| sheet.number(EFFICIENCY);
        let design = design.with_efficiency(&requirement.problem, &efficiency);
        let failing = design.checks.iter().filter(|check| !check.passes());
        broken.extend(failing.map(|check| step(check.quantity).name));
    }
    if broken.is_empty() { Ok(()) } else { Err(Rejection::Rules(broken)) }
}

/// Calculates the efficiency of the whole screw at the operating point of a design, with the model
/// that the requirement specifies. Returns `None` if the model has no solution.
fn efficiency(requirement: &RequirementFile, design: &Design) -> Option<f64> {
    let (case, Design { nut, phase, .. }) = (case(requirement, design), design);
    WORK.with_borrow_mut(|work| quick_efficiency(&case, &requirement.settings, nut, phase, work))
}

/// Returns the case of a design in the axis of the requirement. The case contains the load that a
/// given torque produces, the preload of a preload class, and the nominal diameter and the make of
/// a listed size.
fn case(requirement: &RequirementFile, design: &Design) -> Case {
    let Design { nut, size, phase, .. } = design;
    let by_torque = matches!(requirement.problem.demand, LoadCase::Torque { .. });
    let conformity = Some(decimal(nut.conformity.nut));
    // A nut with several thread starts has one circuit on each start.
    let several = Some(nut.starts).filter(|starts| *starts > 1.0);
    Case {
        nominal_diameter_mm: size.map(|size| decimal(size.diameter / MM)),
        ball_diameter_mm: Some(decimal(nut.ball_diameter / MM)),
        pitch_circle_diameter_mm: Some(decimal(nut.pitch_diameter / MM)),
        lead_mm: Some(decimal(nut.lead / MM)),
        lead_angle_deg: None,
        contact_angle_deg: Some(decimal(nut.contact_angle / DEG)),
        nut_conformity: conformity,
        screw_conformity: conformity,
        loaded_balls_per_turn: Some(nut.balls_per_turn),
        loaded_turns: Some(nut.turns),
        starts: several.or(requirement.case.starts),
        circuits_count: several.or(requirement.case.circuits_count),
        loaded_balls: Some(decimal(nut.balls_per_turn * nut.turns).max(1.0)),
        axial_load_N: if by_torque { Some(phase.load) } else { requirement.case.axial_load_N },
        preload_N: design.preload(),
        entries: CaseEntries {
            preload_class: None,
            screw_make: requirement
                .case
                .entries
                .screw_make
                .or_else(|| size.as_ref()?.make().map(Named)),
            ..requirement.case.entries.clone()
        },
        ..requirement.case.clone()
    }
}

quantities! { pub(crate) STEPS, in_units(&f64);
    "steps of a design" {
        lead_angle_deg = INPUTS Scalar(|x| x / DEG);
        optimum_contact_angle_deg ["deg"] Scalar(|x| x / DEG), "contact angle with the highest efficiency in gross skid; for comparison only";
        contact_angle_deg = INPUTS Scalar(|x| x / DEG);
        screw_length_mm = REQUIREMENT_INPUTS Scalar(|x| x / MM);
        pitch_radius_over_length [""] Scalar(|x| *x), "pitch circle radius / length of the screw";
        pitch_circle_diameter_mm = INPUTS Scalar(|x| x / MM);
        ball_radius_over_pitch_radius [""] Scalar(|x| *x), "ball radius / pitch circle radius";
        ball_diameter_over_lead [""] Scalar(|x| *x), "ball diameter / lead";
        ball_radius_over_groove_radius [""] Scalar(|x| *x), "ball radius / groove radius";
        nut_conformity = INPUTS Scalar(|x| *x);
        loaded_turns = INPUTS Scalar(|x| *x);
        largest_load_N = AXIS Scalar(|x| *x);
        normal_load_per_ball_N ["N" "Q"] Scalar(|x| *x), "normal load of a ball, with equal load sharing";
        lead_mm = INPUTS Scalar(|x| x / MM);
        stroke_mm = INPUTS Scalar(|x| x / MM);
        turns_for_stroke [""] Scalar(|x| *x), "number of screw turns for the stroke";
        advance_mm_s ["mm/s"] Scalar(|x| x / MM), "speed of the nut along the screw";
        largest_speed_number_mm_min = AXIS Scalar(|x| x / (MM * RPM));
        motor_speed_rpm = AXIS Scalar(|x| x / RPM);
        nut_nominal_pressure_MPa ["MPa"] Scalar(|x| x / MPA), "largest pressure at the nut, with equal load sharing";
        screw_nominal_pressure_MPa ["MPa"] Scalar(|x| x / MPA), "largest pressure at the screw, with equal load sharing";
        contact_ellipse_end_deg ["deg"] Scalar(|x| x / DEG), "angle on the groove at which the contact ellipse ends";
        screw_efficiency = AXIS Scalar(|x| *x);
        screw_input_power_W ["W"] Scalar(|x| *x), "input power of the screw";
        screw_output_power_W ["W"] Scalar(|x| *x), "output power of the screw";
        dynamic_load_rating_N = RATINGS Scalar(|x| *x);
        equivalent_load_N = AXIS Scalar(|x| *x);
        cycle_life_h = AXIS Scalar(|x| x / 3600.0);
        static_safety_factor = AXIS Scalar(|x| *x);
        preload_N = INPUTS Scalar(|x| *x);
        critical_speed_ratio = AXIS Scalar(|x| *x);
        buckling_safety = AXIS Scalar(|x| *x);
        unsupported_length_mm = INPUTS Scalar(|x| x / MM);
        inertia_of_screw_kg_m2 = AXIS Scalar(|x| *x);
        mass_of_nut_and_screw_kg = AXIS Scalar(|x| *x);
    }
}

/// Returns the label of a design quantity or of a quantity on the axis sheet.
fn label(name: &str) -> Option<&'static str> {
    let known = STEPS.iter().chain(AXIS).find(|quantity| quantity.name == name);
    known.map(|quantity| quantity.about)
}

/// Returns the name, the unit and the label of a design quantity.
fn step(quantity: DesignQuantity) -> &'static Quantity {
    &STEPS[quantity as usize]
}

/// Returns the selection steps of a design together with the rules of its axis sheet. A rule
/// replaces the step that has the same quantity and limit, unless the rule assumes a guided load
/// that the selection does not assume.
fn rows_of(design: &Design, rules: &[Criterion]) -> Vec<DesignRow> {
    /// Largest relative difference between limits that count as equal. The limits can differ
    /// slightly, because the inputs in the case of a design are rounded.
    const SAME: f64 = 1e-6;
    let mut rows: Vec<_> = design.checks.iter().map(row).collect();
    for rule in rules {
        let row = of_rule(rule);
        let is_same = |check: &Check| {
            step(check.quantity).name == rule.name
                && bounds(check).are_close_to(rule.bounds(), SAME)
        };
        match design.checks.iter().position(is_same) {
            Some(_) if rule.margin_without_default.is_some() => {}
            Some(place) => rows[place] = DesignRow { step: rows[place].step, ..row },
            None => rows.push(row),
        }
    }
    rows
}

fn row(check: &Check) -> DesignRow {
    let Quantity { name, about: label, unit, .. } = *step(check.quantity);
    DesignRow {
        step: check.step,
        name,
        label,
        unit,
        value: Some(in_unit(check, check.value)).filter(|value| value.is_finite()),
        // Without a load, life and safety factors are unlimited.
        requirement: required(check).filter(|_| !check.value.is_infinite()),
        passes: check.passes(),
    }
}

/// Converts a rule on the axis sheet to an additional row in the table of selection steps.
fn of_rule(rule: &Criterion) -> DesignRow {
    DesignRow {
        step: 11,
        name: rule.name,
        label: label(rule.name).unwrap_or(rule.title),
        unit: rule.unit.text,
        value: Some(rule.value),
        requirement: rule.must_be(),
        passes: rule.passes(),
    }
}

/// Describes an axis-sheet rule that is violated by the best screw among all screws that meet the
/// other limits.
fn describe_violation(rule: &Criterion) -> String {
    let Criterion { name, unit, value, limit, at_least, .. } = rule;
    let number =
        |value: f64| format!("{} {}", format_trimmed(value), unit.text).trim_end().to_owned();
    let than = if *at_least { "at least" } else { "at most" };
    let limit = limit.map_or_else(String::new, number);
    let help =
        rule.remedy.as_ref().map_or_else(String::new, |help| format!("; this would need {help}"));
    let rule = format!("{} must be {than} {limit}", label(name).unwrap_or(rule.title));
    if value.is_nan() {
        return format!(
            "{rule}, but cannot be calculated for the best screw within the other limits{help}"
        );
    }
    format!("{rule}, but the best screw within the other limits has {}{help}", number(*value))
}

fn in_unit(check: &Check, value: f64) -> f64 {
    let name = step(check.quantity).name;
    let numbers = in_units(&value, |quantity| quantity.name == name);
    numbers.entries().next().map_or(f64::NAN, |(_, value)| value)
}

/// Returns the limits that a check imposes, in the unit of its quantity.
fn bounds(check: &Check) -> Bounds {
    check.bounds.map(|limit| in_unit(check, limit))
}

fn required(check: &Check) -> Option<String> {
    limits_in_words(bounds(check))
}

/// Returns the unit of a design quantity, with a leading space.
fn unit(quantity: DesignQuantity) -> String {
    let unit = step(quantity).unit;
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Describes a limit that determines the selection, and states the value that the objective could
/// reach without this limit.
fn describe_active_limit(
    requirement: &RequirementFile,
    design: &Design,
    holds: &BindingLimit,
) -> String {
    let name = step(holds.quantity).about;
    let quantity = requirement.problem.objective.quantity();
    let check = |quantity| design.checks.iter().find(|check| check.quantity == quantity);
    let (Some(without), Some(chosen)) = (holds.without, check(quantity)) else {
        return name.to_owned();
    };
    let limit =
        check(holds.quantity).and_then(required).unwrap_or_default() + &unit(holds.quantity);
    let [without, with] = [without, chosen.value]
        .map(|value| format_trimmed(in_unit(chosen, value)) + &unit(quantity));
    format!(
        "{name} {limit}. Without this limit, the best screw would have {} = {without} instead of {with}",
        step(quantity).about
    )
}

/// Returns a note on the screws that were rejected because their axis sheet could not be calculated,
/// or `None` if there are no such screws.
///
/// * `reasons`: one reason per screw.
fn describe_not_calculated(reasons: &[String]) -> Option<String> {
    match reasons {
        [] => None,
        [reason] => Some(format!(
            "One screw within the limits was rejected because its axis sheet cannot be calculated: {reason}."
        )),
        [first, ..] => Some(format!(
            "{} screws within the limits were rejected because their axis sheets cannot be calculated. The reason for the first of these screws: {first}.",
            reasons.len()
        )),
    }
}

/// Returns notes on the size of a design in a list of sizes: an estimated ball diameter, the source
/// of the size, and the balls that carry no load.
///
/// * `source`: source of the size; `None` if the size is not from a table of sizes.
fn notes_on_size(design: &Design, source: Option<&SizeSource>) -> Vec<String> {
    let Some(size) = &design.size else { return Vec::new() };
    let is_estimated = size.offered.is_some_and(|offered| !offered.ball_is_printed);
    let ball = is_estimated.then(|| {
        "The ball diameter is an estimate; ask the manufacturer for the actual diameter.".to_owned()
    });
    let source = source.map(|source| describe_source(size, source));
    ball.into_iter().chain(source).chain(describe_idle_balls(&design.nut)).collect()
}

/// Returns a note that states who lists a size and that the ratings are calculated.
fn describe_source(size: &Size, source: &SizeSource) -> String {
    let SizeSource { manufacturer, catalog } = source;
    let make = size.make().map_or_else(String::new, |make| format!(" as {}", make.name()));
    let pages = catalog.as_ref().map_or_else(String::new, |pages| format!(" ({pages})"));
    let listed = match manufacturer {
        Some(name) => format!("{name} lists this size{make}{pages}."),
        None => format!("The table of sizes contains this size{make}{pages}."),
    };
    format!(
        "{listed} The load ratings are calculated according to ISO 3408-5; ask the manufacturer for the ratings C_a and C_0a of the nut."
    )
}

/// Returns a note on the balls of a turn that carry no load, or `None` if all balls carry load.
fn describe_idle_balls(nut: &Nut) -> Option<String> {
    let loaded = nut.balls_per_turn;
    let fitting = ((nut.turn_length() - nut.ball_gap()) / nut.ball_diameter).round();
    (fitting - loaded >= 1.0).then(|| {
        format!(
            "loaded_balls_per_turn = {}: {fitting} balls fit into a turn, of which {} are assumed to be in the ball return, where they carry no load (D18).",
            format_trimmed(loaded),
            format_trimmed(fitting - loaded)
        )
    })
}

/// Describes a limit that cannot be met, and states the best achievable value and the cause.
fn describe_blocking_limit(ActiveLimit { check, cause }: &ActiveLimit) -> String {
    let (name, unit) = (step(check.quantity).about, unit(check.quantity));
    let number = |value: f64| format!("{}{unit}", format_trimmed(in_unit(check, value)));
    let rule = format!("{name} must be {}{unit}", required(check).unwrap_or_default());
    match cause {
        Infeasibility::SingleLimit(best) => {
            format!(
                "{rule}, but if all other limits are met, the best possible value is {}",
                number(*best)
            )
        }
        Infeasibility::SeveralLimits => {
            format!(
                "{rule}, but the nearest compromise has {} and also violates other limits",
                number(check.value)
            )
        }
        Infeasibility::WholeBalls => format!(
            "{rule}, but the nearest screw with an integer number of standard balls has {}; only a fractional number of balls would meet the limit",
            number(check.value)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `STEPS` is indexed by `DesignQuantity`, whose last variant is `Mass`.
    #[test]
    fn step_labels_match_the_order_of_design_quantities() {
        assert_eq!(STEPS.len(), DesignQuantity::Mass as usize + 1);
        let names = [
            (DesignQuantity::LeadAngle, "lead_angle_deg"),
            (DesignQuantity::Conformity, "nut_conformity"),
            (DesignQuantity::SpeedNumber, "largest_speed_number_mm_min"),
            (DesignQuantity::MotorSpeed, "motor_speed_rpm"),
            (DesignQuantity::EllipseEnd, "contact_ellipse_end_deg"),
            (DesignQuantity::Life, "cycle_life_h"),
            (DesignQuantity::Mass, "mass_of_nut_and_screw_kg"),
        ];
        for (quantity, name) in names {
            assert_eq!(step(quantity).name, name);
        }
    }
}
