//! The rules of an axis: value, limit, source, and remedies.

mod drive;

use bsm_design::{Axis, OPENS_AT, least_preload};

use super::Preload;
use crate::case::axis::{preload_method, speed_number_limit, useful_travel};
use crate::vocabulary::units::{MM, UM};
use crate::{Answer, Criterion, InputKey, Numbers, Scene};

/// Least multiple of its speeds at which an axis runs away.
const FOLD: f64 = 1.25;

/// The rules of a sheet as they are added.
#[derive(Default)]
struct Rules(Vec<Criterion>);

impl Rules {
    /// Adds a rule about a number, if there is one.
    ///
    /// * `name`: with its unit. * `limit`: whether it is the least value, and it. * `remedy`: what to change,
    ///   from how many times the rule is kept.
    fn add(
        &mut self,
        title: &'static str,
        (name, unit): (&'static str, &'static str),
        value: Option<f64>,
        (at_least, limit): (bool, Option<f64>),
        source: &'static str,
        remedy: &dyn Fn(f64) -> String,
    ) {
        let Some(value) = value else { return };
        let mut rule =
            Criterion { title, name, unit, value, limit, at_least, source, remedy: None };
        // A number that cannot be had has no remedy; a note has the reason.
        rule.remedy = rule.margin().filter(|m| !m.is_nan() && !rule.passes()).map(remedy);
        self.0.push(rule);
    }
}

/// All rules of an axis that it has numbers for.
///
/// * `fold`: its speed over the speeds given. * `preload`: cold and warm \[N\].
pub(super) fn rules(
    scene: &Scene,
    axis: &Axis,
    (numbers, fold): (&Numbers, Option<f64>),
    of_nut: &Answer,
    preload: Option<&Preload>,
) -> Vec<Criterion> {
    let mut rules = Rules::default();
    screw_rules(&mut rules, scene, axis, numbers);
    rules.0.extend(steady_state(fold));
    travel_rule(&mut rules, scene, numbers);
    nut_rules(&mut rules, scene, axis, numbers);
    drive::drive_rules(&mut rules, scene, numbers);
    preload_rules(&mut rules, (scene, axis), numbers, of_nut, preload);
    rules.0
}

/// Of the screw between its bearings.
fn screw_rules(rules: &mut Rules, scene: &Scene, axis: &Axis, numbers: &Numbers) {
    let number = |name: &str| numbers.number(name);
    let input = |key| scene.value_or_default(key);
    let length = number("unsupported_length_mm").unwrap_or(f64::NAN);
    let diameter = number("shaft_diameter_mm").unwrap_or(f64::NAN);
    rules.add(
        "critical speed",
        ("critical_speed_ratio", ""),
        number("critical_speed_ratio"),
        (false, input(InputKey::required_critical_speed_ratio)),
        "manufacturers' catalogues: 0.8 of the critical speed (Z1)",
        &|margin| {
            format!(
                "unsupported_length_mm {:.0} or less, or a core of {:.1} mm, or a stiffer support",
                length * margin.sqrt(),
                diameter / margin
            )
        },
    );
    let limit = speed_number_limit(scene, axis.screw.lead, axis.screw.outer);
    rules.add(
        "speed number",
        ("largest_speed_number_mm_min", "mm/min"),
        number("largest_speed_number_mm_min"),
        (false, Some(limit)),
        "limit of the ball return by screw_make, THK A-697, unless given (Z15)",
        &|margin| {
            format!(
                "lead_mm {:.1} at the same feed, or another ball return (speed_number_limit_mm_min)",
                axis.screw.lead / MM / margin
            )
        },
    );
    rules.add(
        "buckling",
        ("buckling_safety", ""),
        number("buckling_safety"),
        (true, input(InputKey::required_buckling_safety)),
        "Euler; half of the buckling load (Z2)",
        &|margin| {
            format!(
                "unsupported_length_mm {:.0} or less, or a core of {:.1} mm",
                length * margin.sqrt(),
                diameter * margin.powf(-0.25)
            )
        },
    );
    rules.add(
        "core stress",
        ("largest_load_N", "N"),
        number("yield_load_N").map(|_| axis.largest_load()),
        (false, number("yield_load_N")),
        "THK and others: 147 N/mm2 (Z3)",
        &|margin| format!("a core of {:.1} mm", diameter * margin.powf(-0.5)),
    );
    let pretension = number("pretension_N");
    let hindered = pretension.zip(number("screw_tension_N")).map(|(cold, warm)| cold - warm);
    rules.add(
        "pretension left",
        ("pretension_N", "N"),
        pretension,
        (true, hindered.filter(|force| *force > 0.0)),
        "force of the growth that the bearings hinder; GY Ballscrew, THK A-715 (AA5)",
        &|margin| {
            let slack = number("pretension_K").unwrap_or(f64::NAN);
            let needed = (slack / margin).ceil();
            format!("the screw is slack from {slack:.1} K on: pretension_K {needed:.0}")
        },
    );
    rules.add(
        "support bearings",
        ("support_bearing_load_N", "N"),
        scene.support_bearing_axial_load_N.and(number("support_bearing_load_N")),
        (false, scene.support_bearing_axial_load_N),
        "manufacturer of the bearings",
        &|_| "larger bearings, or less pretension".to_owned(),
    );
}

/// Of the warm steady state.
pub(super) fn steady_state(fold: Option<f64>) -> Vec<Criterion> {
    let mut rules = Rules::default();
    rules.add(
        "steady state",
        ("fold_speed_factor", ""),
        fold,
        (true, Some(FOLD)),
        "no steady state above the fold (I20); the heat is uncertain by a quarter",
        &|_| {
            "a colder screw, a warmer nut, less preload, or O in place of X arrangement".to_owned()
        },
    );
    rules.0
}

/// Of the accuracy grade.
fn travel_rule(rules: &mut Rules, scene: &Scene, numbers: &Numbers) {
    let Some(required) = scene.required_travel_error_um else { return };
    // What cannot be judged is not kept.
    let worst = numbers.number("travel_error_worst_um").unwrap_or(f64::NAN);
    rules.add(
        "travel error",
        ("travel_error_worst_um", "um"),
        Some(worst),
        (false, Some(required)),
        "ISO 3408-3, JIS B 1192: deviation and half of the variation over the useful travel (Z35)",
        &|_| {
            let word = scene.nut.accuracy_grade;
            let grade = word
                .zip(useful_travel(scene))
                .and_then(|(word, travel)| word.grade.that_keeps(required * UM, travel));
            grade.map_or_else(
                || {
                    "accuracy_grade and useful_travel_mm that its standard has a value for"
                        .to_owned()
                },
                |grade| format!("accuracy_grade {}", grade.name),
            )
        },
    );
}

/// Of the load ratings.
fn nut_rules(rules: &mut Rules, scene: &Scene, axis: &Axis, numbers: &Numbers) {
    let number = |name: &str| numbers.number(name);
    let input = |key| scene.value_or_default(key);
    let rating = axis.static_rating;
    rules.add(
        "static safety",
        ("static_safety_factor", ""),
        number("static_safety_factor"),
        (true, input(InputKey::required_static_safety)),
        "ISO 3408-5 (Z16); by the most loaded ball too, bsm nut. THK asks for 1 to 1.5, with impact for 2 to 7",
        &|margin| format!("a static load rating of {:.0} N", rating / margin),
    );
    let dynamic = axis.dynamic_rating;
    rules.add(
        "life",
        ("cycle_life_h", "h"),
        number("cycle_life_h").or(scene.required_life_h.and(Some(f64::NAN))),
        (true, scene.required_life_h),
        "ISO 3408-5 (D12) to (D15), reliability (Z14)",
        &|margin| format!("a dynamic load rating of {:.0} N", dynamic / margin.cbrt()),
    );
    let lubricated = number("fatigue_load_limit_N").is_some();
    rules.add(
        "modified life",
        ("modified_life_h", "h"),
        // What cannot be judged is not kept.
        lubricated.then(|| number("modified_life_h").unwrap_or(f64::NAN)),
        (true, scene.required_life_h),
        "ISO 281 with viscosity ratio and contamination (Z37) to (Z40)",
        &|_| "more viscosity, a cleaner lubricant or a larger dynamic load rating".to_owned(),
    );
    rules.add(
        "life by all balls",
        ("cycle_life_by_balls_h", "h"),
        number("cycle_life_by_balls_h"),
        (true, scene.required_life_h),
        "loads of all balls (U24)",
        &|margin| format!("a dynamic load rating of {:.0} N", dynamic / margin.cbrt()),
    );
    rules.add(
        "equivalent load",
        ("equivalent_load_N", "N"),
        number("equivalent_load_N"),
        (false, Some(dynamic)),
        "dynamic load rating: a million revolutions (D13)",
        &|margin| format!("a dynamic load rating of {:.0} N", dynamic / margin),
    );
}

/// Of the contacts, and of the preload if there is one.
fn preload_rules(
    rules: &mut Rules,
    (scene, axis): (&Scene, &Axis),
    numbers: &Numbers,
    of_nut: &Answer,
    preload: Option<&Preload>,
) {
    let number = |name: &str| numbers.number(name);
    let edge = of_nut.number("edge_load_N");
    let (largest, dynamic) = (axis.largest_load(), axis.dynamic_rating);
    rules.add(
        "edge load of the contact ellipse",
        ("busier_nut_load_N", "N"),
        edge.map(|_| axis.busier_load()),
        (false, edge),
        "end of the flank (G8)",
        &|_| "a larger land: nut_bore_mm smaller, screw_outer_diameter_mm larger".to_owned(),
    );
    let share = preload_method(scene).share();
    if let Some(&Preload { cold, warm, .. }) = preload {
        rules.add(
            "preload",
            ("warm_preload_N", "N"),
            Some(warm),
            (false, Some(share * dynamic)),
            "THK A-687, HIWIN 3.6: 0.1 of the dynamic load rating in a double nut, else 0.05 (AA6)",
            &|_| {
                format!(
                    "a dynamic load rating of {:.0} N, or preload_N {:.0} and one nut that opens above {:.0} N",
                    least_preload(largest) / share,
                    share * dynamic * cold / warm,
                    OPENS_AT * share * dynamic
                )
            },
        );
        let opens = number("limit_load_N").unwrap_or(OPENS_AT * warm);
        rules.add(
            "remaining preload",
            ("largest_load_N", "N"),
            Some(largest),
            (false, Some(opens)),
            "limit load, some 2.83 times the preload (D14), (U20)",
            &|margin| format!("preload_N {:.0}", cold / margin),
        );
    }
}
