//! The page as a single file that contains the answers for a small grid of points.

use std::sync::atomic::AtomicBool;

use bsm_batch::Workers;
use bsm_case::{Case, EllipseFields, Settings};
use serde_json::{Map, Value, json};

use crate::Refusal;
use crate::answer::{Request, answer, axis, compare, nut, or_message, point, solved, warm};
use crate::form::schema;
use crate::page;

/// Number of positions of each slider on a saved page.
const STOPS: u32 = 9;

/// Number of cells of the map in each direction.
const CELLS: u32 = 60;

/// Number of points per semi-axis of the contact ellipses at all slider positions except the case
/// itself.
const COARSE: u32 = 6;

/// Outputs that the map of the page can show.
const COLUMNS: [&str; 8] = [
    "efficiency",
    "ball_torque_Nm",
    "dissipated_power_W",
    "nut_max_pressure_MPa",
    "screw_contact_angle_deg",
    "nut_contact_angle_deg",
    "axial_displacement_um",
    "onset_number",
];

/// Returns the page for a case as a single HTML file that needs no server.
///
/// The sliders and the map vary the speed and the load from a tenth to ten times the values of the
/// case.
///
/// * `beside`: further cases, whose results are included for comparison.
///
/// # Errors
///
/// Returns [`Refusal::Input`] if the case cannot be solved.
pub fn saved(
    case: &Case,
    beside: &[Case],
    settings: &Settings,
    workers: &Workers<'_>,
) -> Result<String, Refusal> {
    let case = &case.without_estimates();
    let body = |case: Case| json!({ "case": case.to_json(), "settings": settings.to_json() });
    let read = |value: &Value| Request::read(value.to_string().as_bytes())?.with_groove();
    let mut request = body(case.clone());
    request["band"] = json!(true);
    request["sheet"] = json!(true);
    let here = read(&request)?;
    let mut answers = Map::from_iter([
        ("point".to_owned(), Value::Object(point(&here, EllipseFields::POINTS)?)),
        ("compare".to_owned(), or_message(compare(&here))),
        ("nut".to_owned(), or_message(nut(&here))),
        ("warm".to_owned(), or_message(warm(&here))),
        ("axis".to_owned(), or_message(axis(&here))),
    ]);
    let axes: Vec<_> = ["screw_speed_rpm", "axial_load_N"]
        .into_iter()
        .filter_map(|name| Some((name, around(case, name)?)))
        .collect();
    let mut stops = Vec::new();
    let mut map = Value::Null;
    if let [(x, range_x), (y, range_y)] = axes[..] {
        let values = [range_x, range_y].map(|range| spread(range, STOPS));
        for (a, b) in values[0].iter().flat_map(|a| values[1].iter().map(move |b| (*a, *b))) {
            let mut other = case.clone();
            other.set(x, a)?;
            other.set(y, b)?;
            let there = read(&body(other))?;
            let found = or_message(point(&there, COARSE).map(Value::Object));
            stops.push(json!({ "point": stop(found) }));
        }
        let axis = |name: &str, [low, high]: [f64; 2]| format!("{name}={low}:{high}:{CELLS}:log");
        let mut request = body(case.clone());
        request["vary"] = json!([axis(x, range_x), axis(y, range_y)]);
        request["columns"] = json!(COLUMNS);
        let found =
            answer("sweep", request.to_string().as_bytes(), workers, &AtomicBool::new(false));
        map = found.map_or(Value::Null, brief);
        answers.insert("axes".to_owned(), json!([[x, values[0]], [y, values[1]]]));
    }
    let other = |case: &Case| {
        let solved = solved(&read(&body(case.clone()))?, false)?;
        Ok(json!({ "case": case.to_json(), "solved": solved }))
    };
    let beside = beside.iter().map(other).collect::<Result<Vec<_>, Refusal>>()?;
    Ok(page::html(&json!({
        "live": false,
        "beside": beside,
        "case": case.to_json(),
        "settings": settings.to_json(),
        "save": false,
        "program": bsm_report::PROGRAM,
        "schema": schema(),
        "answers": answers,
        "stops": stops,
        "map": map,
    })))
}

/// Removes those data from the answer for a slider position that are the same at all positions.
fn stop(mut point: Value) -> Value {
    if let Some(solved) = point.get_mut("solve").and_then(Value::as_object_mut) {
        solved.remove("section");
        solved.remove("inputs");
    }
    brief(point)
}

/// Returns the range from a tenth to ten times an input of the case, or `None` if the input is
/// missing or not positive.
fn around(case: &Case, name: &str) -> Option<[f64; 2]> {
    let value = case.to_json().get(name)?.as_f64().filter(|value| *value > 0.0)?;
    Some([value / 10.0, value * 10.0])
}

/// Returns `count` values in geometric progression from `low` to `high`.
fn spread([low, high]: [f64; 2], count: u32) -> Vec<f64> {
    let part = |i: u32| f64::from(i) / f64::from(count - 1);
    (0..count).map(|i| low * (high / low).powf(part(i))).collect()
}

/// Rounds all numbers in lists to five digits, which is sufficient for drawing.
fn brief(value: Value) -> Value {
    let short = |value: &Value| match value.as_f64() {
        Some(x) if !value.is_u64() => {
            format!("{x:.4e}").parse().map_or(Value::Null, |x: f64| json!(x))
        }
        _ => value.clone(),
    };
    match value {
        Value::Array(list) if list.len() > 20 => list.iter().map(short).collect(),
        Value::Array(list) => list.into_iter().map(brief).collect(),
        Value::Object(map) => map.into_iter().map(|(name, value)| (name, brief(value))).collect(),
        other => other,
    }
}
