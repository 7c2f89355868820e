//! Checks that are defined by the rows of `checks.csv`. A row contains an expression of inputs and
//! outputs, the points at which the expression is evaluated, and a claim about its value.
//!
//! Expressions use the language of `minijinja`. An input is given by its name. A column of `bsm
//! sweep` is given by the model that calculates it and the name of the column:
//! `raceway_control.nut_normal_load_N / axial_load_N`.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use bsm_case::{
    AnalysisKind, Case, CaseError, GridAxis, InputKey, ModelChoice, MotionAnswer, Output, Record,
    Settings,
};
use bsm_dyn::{Control, Model, ModelWorkspace, Status};
use minijinja::value::Value;
use minijinja::{Environment, UndefinedBehavior, context};
use serde::Deserialize;

use crate::lubrication::reference_case;
use crate::{Check, PublishedData, ValidateError};

/// Statistic that is calculated from the values at several points.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Statistic {
    Largest,
    #[serde(rename = "least")]
    Smallest,
    #[serde(rename = "middle")]
    Median,
    /// Difference between the largest and the smallest value.
    Change,
}

/// Condition that the value of a check must satisfy.
#[derive(Debug, Clone, Copy, Deserialize)]
enum Rule {
    #[serde(rename = "=")]
    Equal,
    #[serde(rename = "<=")]
    AtMost,
    #[serde(rename = ">=")]
    AtLeast,
}

#[derive(Deserialize)]
struct Row {
    key: String,
    source: String,
    claim: String,
    /// Name of a published case. If it is empty, a case without inputs is used.
    case: String,
    /// Settings as in `bsm solve --set`, and axes as in `bsm sweep --vary`. Vertical bars separate
    /// several sets of points.
    points: String,
    value: String,
    fold: Option<Statistic>,
    /// Expected number of points without a value, by default 0.
    missing: Option<usize>,
    unit: String,
    /// Condition for the value. If there is no condition, the verdict of the check is `Finding`.
    rule: Option<Rule>,
    claimed: Option<f64>,
    /// Permitted difference from the claimed value, or limit of the value.
    limit: Option<f64>,
    reason: String,
    /// A note, which may contain expressions in double braces. The expressions are evaluated at the
    /// point that the statistic selects. In these expressions, `least` and `most` are the smallest
    /// and the largest value, `points` is the number of points, and `solved` is the number of
    /// points that have a value.
    note: String,
}

/// Values of the variables in an expression, by name. The outputs of a model are in a nested map.
type Variables = BTreeMap<String, Value>;

/// Evaluates all rows of the table, and returns one check per row.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let environment = environment();
    let rows = published.checks.rows::<Row>()?;
    rows.iter().map(|row| row.check(published, &environment)).collect()
}

/// Returns the environment in which expressions are evaluated. It contains mathematical functions
/// in addition to the filters of the language.
fn environment() -> Environment<'static> {
    let mut environment = Environment::new();
    // In strict mode, an expression with an unknown name is an error.
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_global("pi", PI);
    for (name, function) in [
        ("sin", f64::sin as fn(f64) -> f64),
        ("cos", f64::cos),
        ("tan", f64::tan),
        ("asin", f64::asin),
        ("sqrt", f64::sqrt),
        ("radians", f64::to_radians),
        ("degrees", f64::to_degrees),
    ] {
        environment.add_function(name, function);
    }
    environment
}

impl Row {
    fn check(
        &self,
        published: &PublishedData,
        environment: &Environment,
    ) -> Result<Check, ValidateError> {
        let place = format!("checks.csv, {}", self.key);
        let wrong = |error: minijinja::Error| ValidateError::of(&place, error);
        let value = environment.compile_expression(&self.value).map_err(wrong)?;
        let note = environment.template_from_str(&self.note).map_err(wrong)?;
        let mut names: BTreeSet<_> = value.undeclared_variables(true).into_iter().collect();
        names.extend(note.undeclared_variables(true));
        let mut found = Vec::new();
        for case in points(&case(published, &self.case)?, &self.points)? {
            let known = known(&case, &names)?;
            let value = value.eval(&known).and_then(f64::try_from).map_err(wrong)?;
            found.push((value, known));
        }
        let points = found.len();
        found.retain(|(value, _)| !value.is_nan());
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let solved = found.len();
        let (mut measured, mut words) =
            (f64::NAN, format!("{solved} of {points} points have a value"));
        if solved > 0 && solved + self.missing.unwrap_or(0) == points {
            let (least, most) = (found[0].0, found[solved - 1].0);
            let (value, known) = match self.fold {
                None | Some(Statistic::Smallest) => &found[0],
                Some(Statistic::Median) => &found[(solved - 1) / 2],
                Some(Statistic::Largest | Statistic::Change) => &found[solved - 1],
            };
            measured = if let Some(Statistic::Change) = self.fold { most - least } else { *value };
            let own = context! { least, most, solved, points };
            words =
                note.render(context! { ..own, ..Value::from_serialize(known) }).map_err(wrong)?;
        }
        let check = Check::new(&self.key, &self.source, self.claim.clone())
            .measured(measured, &self.unit)
            .note(words);
        let limit = self.limit.unwrap_or(f64::NAN);
        let check = match self.rule {
            None => check,
            Some(Rule::Equal) => {
                check.equals(self.claimed.unwrap_or(f64::NAN), limit, &self.reason)
            }
            Some(Rule::AtMost) => check.at_most(limit, &self.reason),
            Some(Rule::AtLeast) => check.at_least(limit, &self.reason),
        };
        Ok(Check { claimed: self.claimed, ..check })
    }
}

/// Returns the published case with the given name.
fn case(published: &PublishedData, name: &str) -> Result<Case, ValidateError> {
    match name {
        "" => Ok(Case::default()),
        "lin1994" => published.lin_case.case(),
        "xu2015" => published.xu_case.case(),
        "dong2020" => published.dong_case.case(),
        "manufacturers" => published.manufacturers_case.case(),
        "feed_axis" => published.feed_axis.case(),
        "machining_center" => published.machining_center.case(),
        "machining_center_oil" => published.machining_center_oil.case(),
        "upright_axis" => published.upright_axis.case(),
        _ => reference_case(published, name),
    }
}

/// Returns one case for each point that the settings and axes define.
fn points(case: &Case, settings: &str) -> Result<Vec<Case>, CaseError> {
    let mut all = Vec::new();
    for set in settings.split('|') {
        let mut cases = vec![case.clone()];
        for setting in set.split_whitespace() {
            let Ok(axis) = GridAxis::parse(setting) else {
                // A setting that is not an axis has the same value at all points.
                cases.iter_mut().try_for_each(|case| case.apply(&[setting]))?;
                continue;
            };
            let at = |(case, i): (&Case, usize)| {
                let mut case = case.clone();
                case.set(axis.key.name(), axis.value(i)).map(|()| case)
            };
            let each = cases.iter().flat_map(|case| (0..axis.len()).map(move |i| (case, i)));
            cases = each.map(at).collect::<Result<_, _>>()?;
        }
        all.extend(cases);
    }
    Ok(all)
}

/// Returns the values of the named inputs and outputs at a point. Missing values are NaN.
fn known(case: &Case, names: &BTreeSet<String>) -> Result<Variables, ValidateError> {
    let mut known = Variables::new();
    let mut of_models = BTreeMap::<_, BTreeMap<&str, f64>>::new();
    for name in names {
        if let Some((model, column)) = name.split_once('.') {
            of_models.entry(model).or_default().insert(column, f64::NAN);
        } else if let Ok(key) = InputKey::named(name) {
            let value = case.value_or_default(key).unwrap_or(f64::NAN);
            known.insert(name.clone(), value.into());
        }
    }
    for (model, mut columns) in of_models {
        solve(case, model, &mut columns)?;
        known.insert(model.to_owned(), Value::from_serialize(&columns));
    }
    Ok(known)
}

/// Calculates output columns with a model. The values come from its solution or from analyses.
fn solve(case: &Case, model: &str, columns: &mut BTreeMap<&str, f64>) -> Result<(), ValidateError> {
    // A name such as `nut_control` means model raceway control with the nut as the controlling
    // raceway.
    let control = model.strip_suffix("_control").and_then(Control::from_name);
    let model = match control {
        Some(_) => Model::RacewayControl.into(),
        None => ModelChoice::from_name(&model.replace('_', "-"))?,
    };
    let settings = Settings { model, control, ..Settings::default() };
    // Several analyses may have a column with the same name, but only one of them calculates its
    // value.
    let analyses = |name: &str| -> Vec<AnalysisKind> {
        let kinds = AnalysisKind::ALL.into_iter();
        kinds.filter(|kind| kind.columns().any(|column| column.name == name)).collect()
    };
    let moves = |name: &&str| {
        let kinds = analyses(name);
        kinds.is_empty() || kinds.into_iter().any(AnalysisKind::needs_motion)
    };
    let work = &mut ModelWorkspace::default();
    let moving = if columns.keys().any(moves) {
        Some(MotionAnswer::of(case, &settings, work)?)
    } else {
        None
    };
    let solution = moving.as_ref().map(|moving| moving.solution.clone());
    let record = solution.map(Record::new).filter(|record| record.status() == Status::Converged);
    for (name, value) in columns {
        let output = Output::named(name)
            .ok_or_else(|| ValidateError::of("checks.csv", format!("no output is named {name}")))?;
        let kinds = analyses(name);
        let mut number = None;
        if kinds.is_empty() {
            number = record.as_ref().and_then(|record| record.number(output.into()));
        }
        for kind in kinds {
            let wanted = |quantity: &bsm_case::Quantity| {
                quantity.columns.iter().any(|column| column.name == *name)
            };
            if number.is_none() {
                number = kind
                    .numbers(case, &settings, moving.as_ref(), wanted, work)?
                    .number(output.into());
            }
        }
        *value = number.unwrap_or(f64::NAN);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Verdict;

    /// A statistic must select the correct value from several points. The number of points without
    /// a value must equal the expected number.
    #[test]
    fn statistic_of_a_validation_row_selects_the_correct_value_from_several_points() {
        let check = |cells: &str| {
            let header = "key,source,claim,case,points,value,fold,missing,unit,rule,claimed,limit,reason,note";
            let text = format!("{header}\nk,s,c,lin1994,{cells}\n");
            let row = csv::Reader::from_reader(text.as_bytes()).into_deserialize().next();
            let row: Row = row.expect("a row").expect("as the table is");
            row.check(&PublishedData::default(), &environment())
        };
        let loads = |fold: &str, rule: &str| {
            let note =
                "{{ least }} to {{ most }} at {{ solved }} of {{ points }}: {{ axial_load_N }}";
            let check =
                check(&format!("axial_load_N=1:4:4,axial_load_N,{fold},,N,{rule},why,{note}"));
            let check = check.expect("a row");
            (check.measured, check.verdict, check.note)
        };
        let said = |at: &str| format!("1.0 to 4.0 at 4 of 4: {at}");
        assert_eq!(loads("largest", "<=,,4"), (4.0, Verdict::Pass, said("4.0")));
        assert_eq!(loads("middle", "=,2.5,0.4"), (2.0, Verdict::Fail, said("2.0")));
        assert_eq!(loads("least", ",,"), (1.0, Verdict::Finding, said("1.0")));
        assert_eq!(loads("change", ",,"), (3.0, Verdict::Finding, said("4.0")));
        // At the lead angle of 5 deg, the model has no solution.
        let rooted = |missing: &str| {
            let cells = "\"lead_angle_deg=5,10 | lead_angle_deg=20\",rigid.efficiency,least";
            let check = check(&format!("{cells},{missing},,>=,,0.5,why,")).expect("a row");
            (check.verdict, check.note)
        };
        assert_eq!(rooted("1"), (Verdict::Pass, String::new()));
        assert_eq!(rooted(""), (Verdict::Fail, "2 of 3 points have a value".to_owned()));
        for wrong in ["screw_sped_rpm", "rigid.efficiency +", "'words'"] {
            let error = check(&format!(",{wrong},,,,,,,,"));
            let error = error.expect_err("no number").to_string();
            assert!(error.starts_with("checks.csv, k: "), "{wrong}: {error}");
        }
    }

    /// The expected values were calculated by hand from the numbers in the manufacturers' examples
    /// and from beam tables.
    #[test]
    fn manufacturer_examples_match_hand_calculations() {
        let all = checks(&PublishedData::default()).expect("compiled-in data");
        let found = |key: &str| {
            all.iter().find(|check| check.key == key).map_or(f64::NAN, |check| check.measured)
        };
        // The factor λ² in beam tables is 15.418, and the density ρ is 7850 kg/m³.
        let rpm = 0.8 * 60.0 / (2.0 * PI) * 15.418 / 0.85_f64.powi(2)
            * (206e9 * 0.0144_f64.powi(2) / 16.0 / 7850.0).sqrt();
        // The tolerance is due to the five digits of the factor 15.418.
        assert!((found("manufacturers/critical-speed-example") / rpm - 1.0).abs() < 1e-4, "{rpm}");
        let near = |key: &str, by_hand: f64, reason: &str| {
            let ours = found(key);
            // The tolerance is due to the factors below, which have five digits.
            assert!(
                (ours / by_hand - 1.0).abs() < 1e-4,
                "{key}: {ours}, by hand {by_hand}: {reason}"
            );
        };
        // A stress of 147 N/mm² acts on the cross section of a bar with a diameter of 1 mm.
        near("manufacturers/yield-factor", 147.0 * PI / 4.0, "area of a circle of 1 mm");
        // The permitted load is half of the buckling load P = κ π² E I/l², in kgf and mm, with E =
        // 21 000 kgf/mm².
        for (support, kappa) in [
            ("fixed-free", 0.25),
            ("supported-supported", 1.0),
            ("fixed-supported", 2.0457),
            ("fixed-fixed", 4.0),
        ] {
            let factor = kappa * 9.8696 * 21_000.0 * (PI / 64.0) / 2.0 / 1000.0;
            near(&format!("manufacturers/buckling-factor-{support}"), factor, "Euler");
        }
        // The frequency is f = λ²/(2π l²) (d/4) √(E/ρ), with lengths in inches. A length of 101.6
        // mm is 4 in.
        let sound = (206e9_f64 / 7850.0).sqrt();
        for (support, root) in [("fixed-fixed", 22.373), ("supported-supported", 9.8696)] {
            let hertz = root / (2.0 * PI * 2.54 * 2.54) * (0.0254 / 4.0) * sound;
            near(&format!("manufacturers/frequency-{support}"), hertz, "beam tables");
        }
        // The rating life is 10⁶ (C/F)³ revolutions, and the speed is 2400 rpm.
        let hours = (17_073.1_f64 / 1200.0).powi(3) * 1e6 / (2400.0 * 60.0);
        near("manufacturers/rating-example", hours, "cubic life");
        near("manufacturers/guide-example", 0.02 * 50.0 * 9.806_65, "Coulomb");
        near(
            "manufacturers/guide-and-seal-example",
            28.0 + 0.02 * 100.0 * 9.806_65,
            "Coulomb and seals",
        );
        near("manufacturers/opening-load", 8.0_f64.sqrt(), "2 to the power 3/2");
        let buckles = 2.0457 * PI.powi(3) * 206e9 * 0.0125_f64.powi(4) / (64.0 * 0.82 * 0.82) / 2.0;
        // The tolerance is due to the five digits of the factor 2.0457.
        assert!(
            (found("manufacturers/buckling-example") / buckles - 1.0).abs() < 1e-4,
            "{buckles}"
        );
    }
}
