//! The axis sheet: figures and HTML page.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use bsm_case::units::label;
use bsm_case::{
    Answer, AxisReport, Content, Criterion, DisplayUnit, GrooveSection, Numbers, OutputName,
    Quantity, Row, ScrewTorque, TableFormat, Verdict, format_digits, format_exact, format_interval,
    format_trimmed, format_with_interval, output,
};
use serde_json::{Value, json};

use super::warm::warm_figures;
use crate::plots::text_of_table;
use crate::{
    Curve, Figure, PROGRAM, Page, PlotAxis, ReportError, Stroke, format_number as text_of,
};

/// Number of points of a limit curve in the speed-load diagram.
const POINTS: u32 = 60;

/// Results that are highlighted at the top of the page.
const HEADLINES: [OutputName; 4] = [
    output!(cycle_life_h),
    output!(peak_motor_torque_Nm),
    output!(mean_heat_W),
    output!(axis_stiffness_N_um),
];

/// Results that are based on estimated conductances, which have a large relative error (a factor of
/// 1.4 to 3).
const FROM_CONDUCTANCES: [OutputName; 4] = [
    output!(axis_heat_transfer_W_K),
    output!(steady_temperature_rise_K),
    output!(steady_temperature_rise_low_K),
    output!(steady_temperature_rise_high_K),
];

/// Text inputs of the case that appear in the header of the sheet.
const HEAD: [&str; 7] = ["project", "drawing", "revision", "author", "date", "customer", "remark"];

/// Text inputs of the case that appear on the sheet without their names.
const UNNAMED: [&str; 4] = ["description", "display_units", "manufacturer", "order_code"];

/// Topics of the theory chapters, by the first letter of their equation tags. The sources of rules
/// contain equation tags.
const EQUATIONS: [(char, &str); 5] = [
    ('D', "load ratings and life, ISO 3408-5"),
    ('G', "thread and groove"),
    ('I', "warm steady state"),
    ('U', "loads of all balls of the nut"),
    ('Z', "axis: manufacturers' catalogs, Euler, ISO 3408"),
];

/// Numbers of significant digits for three kinds of quantities: quantities that depend on the
/// friction coefficient, which is only roughly known; quantities from catalog formulas; and
/// quantities from geometry and accuracy grades.
const DIGITS: [u8; 3] = [2, 3, 4];

/// Results that appear only in the JSON file and not on the sheet, because other
/// results contain the same information or few readers need them.
const IN_FILES_ALONE: [OutputName; 28] = [
    output!(cycle_life_revolutions),
    output!(cycle_life_km),
    output!(cycle_life_strokes),
    output!(required_life_revolutions),
    output!(required_dynamic_load_N),
    output!(end_1_rise_K),
    output!(end_2_rise_K),
    output!(free_growth_um),
    output!(nut_conductance_W_K),
    output!(screw_film_W_m2K),
    output!(torsional_stiffness_N_um),
    output!(natural_frequency_with_torsion_Hz),
    output!(peak_regenerated_power_W),
    output!(preload_torque_factor),
    output!(preload_torque_reverse_Nm),
    output!(running_preload_torque_reverse_Nm),
    output!(running_preload_torque_factor),
    output!(running_preload_torque_factor_without_play),
    output!(inertia_of_mass_kg_m2),
    output!(inertia_at_screw_kg_m2),
    output!(reflected_mass_kg),
    output!(buckling_load_of_support_N),
    output!(buckling_safety_of_support),
    output!(preload_torque_factor_rule),
    output!(holding_torque_Nm),
    output!(inertia_of_screw_kg_m2),
    output!(modified_static_rating_N),
    output!(steady_temperature_time_s),
];

/// Columns of the table of load-cycle phases.
const COLUMNS: [OutputName; 8] = [
    output!(time_share),
    output!(screw_load_N),
    output!(start_feed_m_min),
    output!(end_feed_m_min),
    output!(screw_torque_Nm),
    output!(screw_efficiency),
    output!(motor_torque_Nm),
    output!(heat_W),
];

/// Returns the results of an axis sheet as JSON, including the name and version of the program.
pub fn size_results(report: &AxisReport) -> Value {
    report.answer.clone().with("program", Content::Json(PROGRAM.into())).to_json()
}

/// Returns the rules of an axis sheet as CSV.
///
/// * `format`: column separator and decimal sign.
///
/// # Errors
///
/// Returns [`ReportError::Table`] if the table cannot be written.
pub fn size_table(report: &AxisReport, format: &TableFormat) -> Result<String, ReportError> {
    let report = &report.displayed();
    let exact = |number: f64| format_exact(number).replace('.', &format.decimal.to_string());
    let text = |number: Option<f64>| number.map_or_else(String::new, exact);
    let mut table =
        csv::WriterBuilder::new().delimiter(format.delimiter as u8).from_writer(Vec::new());
    let is_estimated = report.case.has_estimated_groove();
    let ends = ["low", "high"].into_iter().filter(|_| is_estimated);
    let head = ["rule", "symbol", "value"].into_iter().chain(ends);
    table.write_record(head.chain(["unit", "limit", "margin", "verdict", "source"]))?;
    for rule in &report.answer.rules {
        let ends = [rule.band.map(|band| band.low), rule.band.map(|band| band.high)].map(text);
        let value = exact(rule.value);
        let numbers = std::iter::once(&value).chain(ends.iter().filter(|_| is_estimated));
        let [limit, margin] = [text(rule.limit), text(rule.margin())];
        let verdict = rule.limit.map_or("", |_| rule.verdict().word());
        let words = [rule.title, rule.symbol].into_iter().chain(numbers.map(String::as_str));
        table.write_record(words.chain([
            rule.unit.text,
            &limit,
            &margin,
            verdict,
            &rule.source,
        ]))?;
    }
    text_of_table(table)
}

/// Returns the axis sheet as an HTML page, which prints on two to three pages of A4.
///
/// * `figures`: the figures of the sheet (see [`size_figures`]).
/// * `input`: name and hash of the case file, if there is one.
///
/// # Errors
///
/// Returns [`ReportError::Page`] if the template is invalid.
pub fn size_page(
    report: &AxisReport,
    figures: &[Figure],
    input: Option<&str>,
) -> Result<String, ReportError> {
    let page = Page {
        title: "Ball screw axis: calculation sheet",
        command: "bsm axis CASE.json --figures DIR",
        template: include_str!("../../templates/size.html"),
        figures,
    };
    page.html(&sheet(&report.displayed(), input))
}

/// Returns true if a list of results contains a quantity.
fn contains(results: &[OutputName], quantity: &Quantity) -> bool {
    results.iter().any(|result| result.name() == quantity.name)
}

/// Returns the data for the template of the axis sheet.
fn sheet(report: &AxisReport, input: Option<&str>) -> Value {
    let Answer { rules, notes, warnings, .. } = &report.answer;
    let rows = report.answer.to_json()["rules"].take();
    let rows = rules.iter().zip(rows.as_array().into_iter().flatten());
    let limited: Vec<_> = rules.iter().filter(|rule| rule.limit.is_some()).collect();
    let mut contacts: Vec<&str> = report.phases.iter().map(|phase| &*phase.contacts).collect();
    let mut seen = BTreeSet::new();
    contacts.retain(|words| seen.insert(*words));
    let first = report.phases.first();
    let head = |name: OutputName| {
        let row = first
            .into_iter()
            .flat_map(|phase| phase.numbers.all())
            .find(|row| row.quantity.name == name.name());
        row.map(|row| json!({ "title": row.quantity.about.trim(), "unit": row.unit }))
    };
    let units = report.case.display_units();
    let mut phase_columns = COLUMNS.map(head).to_vec();
    phase_columns.insert(1, Some(json!({ "title": "process force", "unit": units.of("N").text })));
    let results = report.answer.numbers().flat_map(Numbers::rows);
    let headlines = results.filter(|row| contains(&HEADLINES, row.quantity));
    let inputs = report.case.to_json();
    let headlines = headlines.map(|row| number_row(row, &inputs, &report.answer));
    let drag = report
        .number(output!(preload_torque_Nm))
        .zip(report.number(output!(preload_torque_measured_Nm)));
    json!({
        "description": report.case.description,
        "input": input,
        "head": head_of(report),
        "equations": equations(rules),
        "failed": limited.iter().filter(|rule| rule.fails()).count(),
        "undecided": limited.iter().filter(|rule| rule.verdict() == Verdict::Undecided).count(),
        "limited": limited.len(),
        "headlines": headlines.collect::<Vec<_>>(),
        "rules": rows.map(rule_row).collect::<Vec<_>>(),
        "parts": ScrewTorque::PARTS.map(head),
        "contacts": contacts,
        "phase_columns": phase_columns,
        "torque_unit": units.of("N m").text,
        "phases": (0..report.phases.len()).map(|place| phase_row(report, place)).collect::<Vec<_>>(),
        "groups": groups(report),
        "notes": notes,
        "warnings": warnings,
        "not_given": report.answer.all_not_given(),
        "not_modeled": report.answer.texts("not_modeled"),
        "drag": drag.map(|(contacts, rule)| json!({ "contacts": contacts, "rule": rule })),
    })
}

/// Returns the labels and strings for the header of the sheet.
fn head_of(report: &AxisReport) -> Vec<(&'static str, Value)> {
    let case = report.case.to_json();
    let text = |name: &&'static str| Some((*name, case.get(*name)?.clone()));
    HEAD.iter().filter_map(text).collect()
}

/// Explains the letters of the equation tags that occur in the sources of the rules.
fn equations(rules: &[Criterion]) -> String {
    let cited = |letter: char| {
        let is_tag = |part: &str| {
            part.starts_with(letter) && part[1..].starts_with(|c: char| c.is_ascii_digit())
        };
        rules.iter().any(|rule| rule.source.split('(').skip(1).any(is_tag))
    };
    let cited = EQUATIONS.iter().filter(|(letter, _)| cited(*letter));
    cited.map(|(letter, words)| format!("({letter}) {words}")).collect::<Vec<_>>().join("; ")
}

/// Returns the process force of a phase as text: the value at the start and, if the force changes,
/// also the value at the end.
fn process_force(report: &AxisReport, phase: &ScrewTorque) -> Option<String> {
    let unit = report.case.display_units().of("N");
    let text = |force: f64| format_digits(unit.value(force), DIGITS[1]);
    let Some(cycle) = &report.case.entries.cycle else { return report.case.axial_load_N.map(text) };
    let entry = (1..)
        .zip(cycle)
        .find(|(number, _)| phase.number(output!(cycle_entry)) == Some(f64::from(*number)));
    let (_, entry) = entry?;
    let start = entry.force_N.unwrap_or(0.0);
    Some(match entry.end_force_N {
        Some(end) => format!("{} to {}", text(start), text(end)),
        None => text(start),
    })
}

fn rule_row((rule, row): (&Criterion, &Value)) -> Value {
    let mut row = row.clone();
    row["must_be"] = json!(if rule.at_least { "≥" } else { "≤" });
    let value = || format_digits(rule.value, DIGITS[1]) + &format_interval(rule.band);
    row["value"] = json!(rule.value.is_finite().then(value));
    row["limit"] = json!(rule.limit.map(format_trimmed));
    row
}

/// Formats a number with as many digits as its uncertainty justifies, or exactly as entered if the
/// number is an input.
///
/// * `inputs`: given inputs, including the list of estimated inputs.
fn deserved(quantity: &Quantity, value: f64, inputs: &Value) -> String {
    let estimated = inputs["estimated_inputs"].as_array().into_iter().flatten();
    let is_given = inputs.get(quantity.name).is_some()
        && !estimated.into_iter().any(|name| name == quantity.name);
    let [friction, formula, geometry] = DIGITS;
    match quantity.title {
        _ if is_given => format_trimmed(value),
        // Efficiencies are excluded, because the relative error of an efficiency is smaller than
        // the relative error of the power loss.
        _ if quantity.follows_from_friction() && !quantity.unit.is_empty() => {
            format_digits(value, friction)
        }
        _ if contains(&FROM_CONDUCTANCES, quantity) => format_digits(value, friction),
        "screw and nut" => format_digits(value, geometry),
        _ => format_digits(value, formula),
    }
}

/// Returns a table row for a phase of the cycle: its quantities, the torque contributions, and the
/// percentage of the heat that each contribution causes. The torque due to the load itself causes
/// no heat.
fn phase_row(report: &AxisReport, place: usize) -> Value {
    let phase = &report.phases[place];
    let parts = ScrewTorque::PARTS.map(|name| phase.number(name));
    let heat = || parts.iter().skip(1).map(|part| part.unwrap_or(0.0).abs());
    let all: f64 = heat().sum();
    let share = |part: f64| if all > 0.0 { (1e3 * part / all).round() / 10.0 } else { 0.0 };
    let shown = |name: OutputName| {
        let band = report.phase_band(place, name);
        phase.number(name).map(|value| format_digits(value, DIGITS[1]) + &format_interval(band))
    };
    let mut values = COLUMNS.map(shown).to_vec();
    values.insert(1, process_force(report, phase));
    json!({
        "values": values,
        "parts": ScrewTorque::PARTS.map(shown),
        "shares": heat().map(share).collect::<Vec<_>>(),
    })
}

/// Returns a table row with symbol, label, unit and formatted number.
///
/// * `inputs`: given inputs, including the list of estimated inputs.
/// * `answer`: answer that lists the inputs that are missing for the calculation of the number.
fn number_row(
    Row { quantity, unit, values, bands }: &Row,
    inputs: &Value,
    answer: &Answer,
) -> Value {
    let Quantity { about, symbol, .. } = quantity;
    let text = values[0].map(|value| match bands[0] {
        Some(band) => format_with_interval(value, band),
        None => deserved(quantity, value, inputs),
    });
    let mut estimated = inputs["estimated_inputs"].as_array().into_iter().flatten();
    let estimated = estimated.any(|name| name == quantity.name).then(|| "estimated".to_owned());
    let lacks = answer.lacks(quantity.name).or(estimated);
    let label = about.split(';').next();
    json!({ "symbol": symbol, "about": about, "label": label, "unit": unit, "text": text, "lacks": lacks })
}

/// Formats an input as it was entered, or with five digits if its unit is converted.
fn number_text(value: f64, shown: DisplayUnit) -> String {
    let displayed = shown.value(value);
    if displayed.to_bits() == value.to_bits() {
        format_exact(value)
    } else {
        format_trimmed(displayed)
    }
}

/// Returns the given inputs, followed by the results grouped by title.
fn groups(report: &AxisReport) -> Vec<Value> {
    let used = report.screw_rows();
    let is_used = |name: &str| used.iter().any(|row| row.quantity.name == name);
    let inputs = report.case.to_json();
    let is_estimated = |name: &str| report.case.estimates(name);
    let input = |(name, value): (&String, &Value)| {
        let known = bsm_case::INPUTS.iter().find(|input| input.name == name);
        let text = value.as_str().filter(|_| known.is_none()).map(str::to_owned);
        let shown = report.case.display_units().of(known.map_or("", |input| input.unit));
        let text = value.as_f64().map(|value| number_text(value, shown)).or(text)?;
        let is_head = UNNAMED.iter().chain(&HEAD).any(|known| name == known);
        let (unit, symbol) = known.map_or(("", ""), |input| (input.unit, input.symbol));
        let about = label(name, unit);
        let unit = shown.text;
        let about = about.split(',').next();
        let lacks = is_estimated(name).then_some("estimated");
        (!is_head && !is_used(name))
            .then(|| json!({ "symbol": symbol, "about": about, "unit": unit, "text": text, "lacks": lacks }))
    };
    let given = inputs.as_object().into_iter().flatten().filter_map(input).collect::<Vec<_>>();
    let on_sheet = |row: &&Row| !contains(&IN_FILES_ALONE, row.quantity);
    let rows: Vec<_> = report.answer.numbers().flat_map(Numbers::rows).filter(on_sheet).collect();
    let titled = rows.chunk_by(|a, b| a.quantity.title == b.quantity.title);
    let titled = titled.map(|rows| {
        let rows_of = rows.iter().map(|row| number_row(row, &inputs, &report.answer)).collect();
        (rows[0].quantity.title, rows_of)
    });
    let ordered = report.order.rows();
    let ordered = ordered
        .map(|(what, text)| json!({ "symbol": "", "about": what, "unit": "", "text": text, "lacks": null }))
        .collect();
    let first = [("given requirement and axis", given), ("order", ordered)];
    let all = first.into_iter().chain(titled);
    all.map(|(title, rows)| json!({ "title": title, "rows": rows })).collect()
}

/// Returns the figures in the display units of the case: a load-speed diagram with the phases of
/// the cycle and their limits, the axial load, feed rate and motor torque over the cycle, the
/// groove profiles, and, if requested, temperatures and preload in the warm steady state against
/// the speed.
pub fn size_figures(report: &AxisReport) -> Vec<Figure> {
    // If there is only one phase, nothing varies over time.
    let cycle = (report.phases.len() > 1).then(|| over_time(report));
    let warm = report.warm_branch().map_or_else(Vec::new, |branch| warm_figures(report, &branch));
    let figures = [Some(among_limits(report)), cycle, section(report)].into_iter().flatten();
    let units = report.case.display_units();
    figures.chain(warm).map(|figure| figure.in_units(units)).collect()
}

/// Draws the groove profiles of nut and screw around a ball, with a line through the two contacts.
fn section(report: &AxisReport) -> Option<Figure> {
    /// Number of chords with which the circle of the ball is drawn.
    const CHORDS: u32 = 72;
    let grooves = GrooveSection::of(&report.case).ok()?;
    let (radius, angle) = (grooves.ball_radius, grooves.contact_angle);
    let around = |i: u32| {
        let turned = TAU * f64::from(i) / f64::from(CHORDS);
        (radius * turned.cos(), radius * turned.sin())
    };
    // The ball is hatched, because its outline nearly coincides with the grooves. The hatching is
    // drawn as one continuous line that crosses the ball alternately in both directions.
    let hatch = (0..CHORDS / 4).flat_map(|i| {
        let mut ends = [2 * i, CHORDS - 2 * i].map(|step| around(CHORDS / 8 + step));
        if i % 2 == 1 {
            ends.reverse();
        }
        ends
    });
    let ball = (0..=CHORDS).map(around).chain(hatch);
    let (x, y) = (radius * angle.sin(), radius * angle.cos());
    let curves = vec![
        Curve::new("ball", 6, Stroke::Solid, ball.collect()),
        Curve::new("nut", 0, Stroke::Solid, grooves.nut),
        Curve::new("screw", 1, Stroke::Solid, grooves.screw),
        Curve::new("contacts", 3, Stroke::Dashed, vec![(-x, y), (x, -y)]),
    ];
    let estimated =
        if report.case.has_estimated_groove() { " The groove is estimated." } else { "" };
    let caption = format!("Unloaded; contact angle {:.1} degrees.{estimated}", angle.to_degrees());
    Some(Figure::new(
        ["size-groove", "Section across the groove", &caption],
        [
            PlotAxis::linear("axial position, mm"),
            PlotAxis::equal("distance from the pitch circle, mm"),
        ],
        curves,
    ))
}

/// Plots the axial load against the speed, with limits as lines and phases as points.
fn among_limits(report: &AxisReport) -> Figure {
    let point = |phase: &ScrewTorque| {
        let [start, end] =
            [phase.number(output!(start_speed_rpm))?, phase.number(output!(end_speed_rpm))?];
        Some((start.abs().max(end.abs()), phase.number(output!(screw_load_N))?.abs() / 1e3))
    };
    let points: Vec<_> = report.phases.iter().filter_map(point).collect();
    let (fastest, largest) =
        points.iter().fold((0.0, 0.0), |(n, f): (f64, f64), (x, y)| (n.max(*x), f.max(*y)));
    let rule = |name: OutputName| {
        let found = report.answer.rules.iter().find(|rule| rule.name == name.name());
        found.and_then(|rule| Some((rule.limit?, rule.margin()?)))
    };
    // Each of the following speeds and loads brings one rule exactly to its limit.
    let speeds = [
        (rule(output!(critical_speed_ratio)), "permitted fraction of the critical speed"),
        (rule(output!(largest_speed_number_mm_min)), "speed number"),
    ]
    .map(|(rule, label)| (rule.map(|(_, margin)| fastest * margin), label));
    let loads = [
        (
            report
                .number(output!(buckling_load_N))
                .zip(rule(output!(buckling_safety)).map(|r| r.0))
                .map(|(f, s)| f / s),
            "buckling",
        ),
        (report.number(output!(yield_load_N)), "core stress"),
        (
            rule(output!(static_safety_factor)).map(|(_, margin)| 1e3 * largest * margin),
            "static safety",
        ),
    ]
    .map(|(load, label)| (load.map(|load| load / 1e3), label));
    let known = |limits: &[(Option<f64>, &str)], least: f64| {
        limits.iter().filter_map(|(limit, _)| *limit).fold(least, f64::max)
    };
    // Distant limits are omitted, because they would compress the points of the phases into a
    // corner.
    let far = known(&speeds, 1.25 * fastest).min(4.0 * fastest);
    let high = known(&loads, 1.5 * largest).min(5.0 * largest);
    let mut curves = Vec::new();
    for (limit, label) in speeds {
        if let Some(limit) = limit.filter(|limit| *limit <= far) {
            let line = vec![(limit, 0.0), (limit, high)];
            curves.push(Curve::new(label, curves.len(), Stroke::Solid, line));
        }
    }
    for (limit, label) in loads {
        if let Some(limit) = limit.filter(|limit| *limit <= high) {
            let line = vec![(0.0, limit), (far, limit)];
            curves.push(Curve::new(label, curves.len(), Stroke::Dashed, line));
        }
    }
    let life = |i: u32| {
        let speed = far * f64::from(i) / f64::from(POINTS);
        let load = report.load_of_life(speed)? / 1e3;
        (load <= high).then_some((speed, load))
    };
    let life: Vec<_> = (1..=POINTS).filter_map(life).collect();
    if !life.is_empty() {
        curves.push(Curve::new("required life at constant load", 5, Stroke::Dotted, life));
    }
    curves.push(Curve {
        marks: phase_labels(&points, [far, high]),
        ..Curve::new("phases", 6, Stroke::Circles, points)
    });
    let caption = "Phases must lie to the left of the solid lines and below the other lines. Distant limits are omitted.";
    Figure::new(
        ["size-limits", "Load cycle and limits", caption],
        [PlotAxis::from_zero("speed of the screw, rpm"), PlotAxis::from_zero("axial load, kN")],
        curves,
    )
}

/// Distance between two phases in the diagram, relative to the axes, below which their numbers would
/// overlap.
const LABEL_DISTANCE: f64 = 0.05;

/// Returns the labels of the phases. Phases whose numbers would overlap share a label such as "1,
/// 3", which is drawn at the first of these phases.
///
/// * `points`: speed and load of each phase.
/// * `ends`: largest speed and largest load in the diagram.
fn phase_labels(points: &[(f64, f64)], [far, high]: [f64; 2]) -> Vec<String> {
    let mut labels = vec![String::new(); points.len()];
    for (place, (speed, load)) in points.iter().enumerate() {
        let is_near =
            |(x, y): &(f64, f64)| ((x - speed) / far).hypot((y - load) / high) < LABEL_DISTANCE;
        let first = (0..place).find(|i| !labels[*i].is_empty() && is_near(&points[*i]));
        let number = (place + 1).to_string();
        match first {
            Some(first) => labels[first].extend([", ", &number]),
            None => labels[place] = number,
        }
    }
    labels
}

/// Plots the axial load, feed rate and motor torque over the cycle, each divided by its largest
/// value.
fn over_time(report: &AxisReport) -> Figure {
    let (time, label) = match report.number(output!(cycle_time_s)) {
        Some(time) => (time, "time, s"),
        None => (100.0, "fraction of the cycle time, %"),
    };
    let shares = report.phases.iter().map(|phase| phase.number(output!(time_share)).unwrap_or(0.0));
    let times: Vec<f64> = shares.map(|share| time * share).collect();
    let units = report.case.display_units();
    let curve = |(place, (names, label, unit)): (usize, ([OutputName; 2], &str, &'static str))| {
        let ends = |phase: &ScrewTorque| {
            let [start, end] = names.map(|name| phase.number(name));
            Some([start?, end?])
        };
        let values: Option<Vec<[f64; 2]>> = report.phases.iter().map(ends).collect();
        let values = values?;
        let largest = values.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        let (mut at, mut points) = (0.0, Vec::new());
        for ([start, end], time) in values.iter().zip(&times) {
            points.push((at, start / largest.max(f64::MIN_POSITIVE)));
            at += time;
            points.push((at, end / largest.max(f64::MIN_POSITIVE)));
        }
        let unit = units.of(unit);
        let label = format!("{label}, 1 = {} {}", text_of(unit.value(largest)), unit.text);
        let stroke = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted][place];
        Some(Curve::new(label, place, stroke, points))
    };
    let wanted = [
        ([output!(start_load_N), output!(end_load_N)], "axial load", "N"),
        ([output!(start_feed_m_min), output!(end_feed_m_min)], "feed", "m/min"),
        ([output!(start_motor_torque_Nm), output!(end_motor_torque_Nm)], "motor torque", "N m"),
    ];
    let caption = "Each quantity is divided by its largest value. Signs refer to the direction of positive feed.";
    Figure::new(
        ["size-cycle", "The cycle", caption],
        [PlotAxis::linear(label), PlotAxis::linear("value / largest value")],
        wanted.into_iter().enumerate().filter_map(curve).collect(),
    )
}
