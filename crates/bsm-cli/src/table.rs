//! Tables for reading.

use bsm_case::{
    Analysis, Cell, ModelChoice, Numbers, Of, Output, Quantity, Record, RecordRows, Scales, Scene,
    Sensitivity, SizePhase, printable,
};
use bsm_dyn::{Band, Model};
use bsm_report::number;
use comfy_table::{CellAlignment, Table, presets};

/// The cell that says whether a limit is kept; empty without one.
pub(crate) fn verdict(passes: Option<bool>) -> String {
    passes.map_or("", |passes| if passes { "pass" } else { "FAIL" }).to_owned()
}

/// A plain table whose columns from `first_number` on are aligned right.
pub(crate) fn plain(header: Option<&[&str]>, rows: &[Vec<String>], first_number: usize) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    if let Some(header) = header {
        table.set_header(header.to_vec());
    }
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(first_number) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// The free text of a scene, as the title of what is printed.
pub(crate) fn title(scene: &Scene) -> Option<String> {
    scene.description.as_deref().map(printable)
}

/// A number of a unit; what has none may be a count.
fn shown(unit: &str, value: f64) -> String {
    if unit.is_empty() { count_or_number(value) } else { number(value) }
}

/// Five digits, or a whole number as it is; one keeps its digits, as most ones are ratios.
pub(crate) fn count_or_number(value: f64) -> String {
    let is_count = (2.0..1e6).contains(&value.abs()) && value.fract().abs() <= 0.0;
    if is_count { format!("{value:.0}") } else { number(value) }
}

/// One solved point.
pub(crate) fn record(scene: &Scene, record: &Record) -> String {
    let cell = |name: &str| Output::named(name).and_then(|output| record.cell(output));
    let mut status = record.status_name().to_owned();
    if let Some(Cell::Count(steps)) = cell("iterations") {
        let is_rigid = record.model() == ModelChoice::from(Model::Rigid);
        let kind = if is_rigid { "sweeps" } else { "Newton steps" };
        status = format!("{status} in {steps} {kind}");
        for (label, name) in [("residual", "residual_norm"), ("power balance", "power_balance")] {
            if let Some(value) = record.number(name) {
                status = format!("{status}, {label} {value:.0e}");
            }
        }
    }
    let choice = record.choice();
    let race = match cell("controlling_race") {
        Some(Cell::Race(race)) => Some(format!("the {} controls", race.name())),
        _ => None,
    };
    let evidence = match cell("evidence") {
        Some(Cell::Evidence(evidence)) => Some(evidence.to_string()),
        _ => None,
    };
    let lubrication = record.lubrication();
    let head = [
        ("model ", Some(record.model().name())),
        ("chosen", choice.as_deref()),
        ("status", Some(status.as_str())),
        ("reason", record.message()),
        ("shown by", evidence.as_deref()),
        ("regime", record.regime()),
        ("lubrication", lubrication.as_deref()),
        ("race  ", race.as_deref()),
    ];
    let head: Vec<_> =
        head.into_iter().filter_map(|(label, text)| Some(format!("{label}  {}", text?))).collect();
    let mut blocks = vec![head.join("\n")];

    let RecordRows { unbounded, overall, contacts } = record.rows(scene);
    let print = |unit: &str, value: f64| shown(unit, value);
    let marked = |label: &str| {
        let mark = if unbounded.contains(&label) { " *" } else { "" };
        format!("{label}{mark}")
    };
    let overall: Vec<_> = overall
        .into_iter()
        .map(|(label, unit, value)| vec![marked(label), unit.to_owned(), print(unit, value)])
        .collect();
    let contacts: Vec<_> = contacts
        .into_iter()
        .map(|(label, unit, values)| {
            let cells = values.map(|value| value.map_or_else(String::new, |v| print(unit, v)));
            [vec![marked(label), unit.to_owned()], cells.to_vec()].concat()
        })
        .collect();
    if !overall.is_empty() {
        blocks.push(plain(None, &overall, 2));
    }
    if !contacts.is_empty() {
        blocks.push(plain(Some(&["contact", "", "nut", "screw", "minor"]), &contacts, 2));
    }
    if !unbounded.is_empty() {
        blocks.push(format!(
            "* not covered by the error bound: value of model {}; take --model traction where it matters",
            record.model().name()
        ));
    }
    blocks.join("\n\n")
}

/// What the parts of a torque are, by their names.
const TORQUE_PARTS: [(&str, &str); 8] = [
    ("axial load, with the moved mass", "screw_load_N"),
    ("torque of the whole screw", "whole_screw_torque_Nm"),
    ("  of the load, without friction", "ideal_torque_Nm"),
    ("  contacts of the balls", "contact_friction_torque_Nm"),
    (
        "  returns and lubricant of the preload, by the rule of makers",
        "preload_drag_beyond_contacts_Nm",
    ),
    ("  seals", "seal_torque_Nm"),
    ("  support bearings", "support_bearing_torque_Nm"),
    ("efficiency of the whole screw", "screw_efficiency"),
];

/// The torque of a screw by its parts.
pub(crate) fn torque_parts(parts: &SizePhase) -> String {
    let row = |(label, name): &(&str, &str)| {
        let (_, unit, value) = parts.numbers.iter().find(|(own, ..)| own == name)?;
        Some(vec![(*label).to_owned(), (*unit).to_owned(), number((*value)?)])
    };
    let rows: Vec<_> = TORQUE_PARTS.iter().filter_map(row).collect();
    let how = format!("whole screw, contacts by model {}", parts.contacts);
    plain(Some(&[&how, "", ""]), &rows, 2)
}

/// How sure the friction of a lubricant is.
pub(crate) fn band(band: &Band) -> String {
    let row = |label: &str, unit: &str, [low, high]: [f64; 2]| {
        vec![label.to_owned(), unit.to_owned(), number(low), number(high)]
    };
    let rows = [
        row("loss of the contacts over the stated one", "", band.loss),
        row("screw torque, all balls", "N m", band.screw_torque),
        row("efficiency", "", band.efficiency),
    ];
    let table = plain(
        Some(&["nine of ten draws lie between", "", "less friction", "more friction"]),
        &rows,
        2,
    );
    format!("{table}\n\n{NOT_IN_IT}")
}

/// What a torque from a lubricant leaves out.
const NOT_IN_IT: &str = "Not in it: balls that rub on each other, returns, seals and drag beyond their inputs; errors of \
lead and ball size; contact at four points. Catalogue rules for the torque of a preloaded nut are three times that of \
the contacts.";

/// An analysis: a table for each block, then what follows from them.
pub(crate) fn analysis(report: &Analysis) -> String {
    let mut parts = vec![format!("model   {}", report.model.name())];
    let rows = report.numbers.rows().filter(|(quantity, _)| quantity.of != Of::Statement);
    parts.extend(blocks(&rows.collect::<Vec<_>>(), "ball"));
    let verdicts = report.statements().map(|(name, holds, words)| {
        format!("{name}: {}; {words}", if holds { "yes" } else { "no" })
    });
    let lacks = report.lacks.iter().map(|lack| format!("left out: {lack}"));
    parts.push(verdicts.chain(lacks).collect::<Vec<_>>().join("\n"));
    parts.join("\n\n")
}

/// A nut under load: a table for each group of numbers.
pub(crate) fn nut(numbers: &Numbers) -> String {
    blocks(&numbers.rows().collect::<Vec<_>>(), "nut").join("\n\n")
}

/// An axis: a table for each group of numbers.
pub(crate) fn size(numbers: &Numbers) -> String {
    blocks(&numbers.rows().collect::<Vec<_>>(), "axis").join("\n\n")
}

/// Quantities in the tables of their titles.
///
/// * `whole`: what those of no contact and direction are of.
fn blocks(rows: &[(&Quantity, [Option<f64>; 3])], whole: &str) -> Vec<String> {
    let scales = Scales::of(rows.iter().flat_map(|(quantity, values)| {
        values.iter().flatten().map(|value| (quantity.unit, *value))
    }));
    let titled = rows.chunk_by(|a, b| a.0.title == b.0.title);
    titled.map(|rows| block(rows, whole, &scales)).collect()
}

/// Quantities of an analysis that belong together: those of the ball, then those of its contacts.
fn block(rows: &[(&Quantity, [Option<f64>; 3])], whole: &str, scales: &Scales) -> String {
    let title = rows.first().map_or("", |(quantity, _)| quantity.title);
    let table = |of, members: &[&str]| {
        let rows = rows.iter().filter(|(quantity, _)| quantity.of == of);
        let cells = |(quantity, values): &(&Quantity, [Option<f64>; 3])| {
            let print = |v: Option<f64>| {
                v.map_or_else(String::new, |v| shown(quantity.unit, scales.clean(quantity.unit, v)))
            };
            let numbers = values.iter().take(members.len()).map(|value| print(*value));
            [quantity.about, quantity.unit].map(str::to_owned).into_iter().chain(numbers).collect()
        };
        let cells: Vec<Vec<String>> = rows.map(cells).collect();
        (!cells.is_empty()).then(|| plain(Some(&[&[title, ""], members].concat()), &cells, 2))
    };
    let tables = [table(Of::Whole, &[whole]), table(Of::Contacts, &["nut", "screw", "minor"])];
    tables.into_iter().flatten().collect::<Vec<_>>().join("\n\n")
}

/// How much efficiency and torque depend on each input.
pub(crate) fn sensitivities(rows: &[Sensitivity]) -> String {
    let cell = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    let rows: Vec<_> = rows
        .iter()
        .map(|row| {
            let numbers = [
                Some(row.value),
                row.relative_efficiency,
                row.relative_torque,
                Some(row.efficiency),
                row.screw_torque,
            ];
            let names = [row.input.name, row.input.unit].map(str::to_owned);
            [names.to_vec(), numbers.map(cell).to_vec()].concat()
        })
        .collect();
    let header = [
        "sensitivity to",
        "unit",
        "value",
        "efficiency, %/%",
        "torque, %/%",
        "efficiency, 1/unit",
        "torque, N m/unit",
    ];
    plain(Some(&header), &rows, 2)
}
