//! Tables for reading.

use bsm_case::units::MM;
use bsm_case::{
    Analysis, Cell, Numbers, OUTPUTS, Of, Output, Quantity, Record, Scene, Sensitivity, SizePhase,
    printable,
};
use bsm_dyn::Band;
use bsm_report::number;
use bsm_validate::Study;
use comfy_table::{CellAlignment, Table, presets};

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

/// Below this part of what is usual for its unit a number is rounding, and is printed as 0.
const ROUNDING: f64 = 1e-12;

/// What is usual for a unit in one table: the largest number that has it; 180 for angles.
struct Scales(Vec<(&'static str, f64)>);

impl Scales {
    fn of(numbers: impl Iterator<Item = (&'static str, f64)>) -> Self {
        let mut scales = vec![("deg", 180.0)];
        for (unit, value) in numbers {
            match scales.iter_mut().find(|(known, _)| *known == unit) {
                Some((_, largest)) => *largest = value.abs().max(*largest),
                None => scales.push((unit, value.abs())),
            }
        }
        Self(scales)
    }

    /// A number with its rounding left out. What has no unit has no scale, and may be a count.
    fn print(&self, unit: &str, value: f64) -> String {
        if unit.is_empty() {
            return count_or_number(value);
        }
        let scale = self.0.iter().find(|(known, _)| *known == unit);
        let noise = scale.is_some_and(|(_, largest)| value.abs() < ROUNDING * largest);
        number(if noise { 0.0 } else { value })
    }
}

/// Five digits, or a whole number as it is; one keeps its digits, as most ones are ratios.
pub(crate) fn count_or_number(value: f64) -> String {
    let is_count = (2.0..1e6).contains(&value.abs()) && value.fract().abs() <= 0.0;
    if is_count { format!("{value:.0}") } else { number(value) }
}

/// Overall results: label, output.
const OVERALL: &[(&str, &str)] = &[
    ("efficiency", "efficiency"),
    ("screw torque, all balls", "screw_torque_Nm"),
    ("input power", "input_power_W"),
    ("output power", "output_power_W"),
    ("dissipated power", "dissipated_power_W"),
    ("  sliding at the contacts", "sliding_power_W"),
    ("  rolling resistance", "rolling_power_W"),
    ("  seals", "seal_power_W"),
    ("  balls on each other", "ball_contact_power_W"),
    ("  ball returns", "return_power_W"),
    ("  drag", "drag_power_W"),
    ("equivalent friction coefficient", "equivalent_friction_coefficient"),
    ("friction coefficient of catalogues", "catalogue_friction_coefficient"),
    ("temperature of the lubricant", "lubricant_temperature_C"),
    ("viscosity", "viscosity_mPas"),
    ("pressure-viscosity coefficient", "pressure_viscosity_1_GPa"),
    ("heating of the film", "film_heating_K"),
    ("error of the efficiency, at most", "efficiency_error_bound"),
    ("relative error of the dissipated power, at most", "loss_error_bound"),
    ("axial displacement of the nut", "axial_displacement_um"),
    ("ball precession about the axis", "ball_precession_rad_s"),
    ("ball rotation along the helix t", "ball_omega_t_rad_s"),
    ("ball rotation towards the axis n", "ball_omega_n_rad_s"),
    ("ball rotation along the binormal b", "ball_omega_b_rad_s"),
    ("skid number", "skid_number"),
    ("skid onset number", "onset_number"),
];

/// Results per contact: label, outputs at nut, screw and minor contact.
const CONTACTS: &[(&str, [&str; 3])] = &[
    ("normal load per ball", ["nut_normal_load_N", "screw_normal_load_N", "minor_normal_load_N"]),
    ("contact angle", ["nut_contact_angle_deg", "screw_contact_angle_deg", ""]),
    ("slip speed", ["nut_slip_velocity_m_s", "screw_slip_velocity_m_s", "minor_slip_velocity_m_s"]),
    (
        "direction of friction",
        ["nut_slip_angle_deg", "screw_slip_angle_deg", "minor_slip_angle_deg"],
    ),
    ("spin about the normal", ["nut_spin_rad_s", "screw_spin_rad_s", ""]),
    ("largest pressure", ["nut_max_pressure_MPa", "screw_max_pressure_MPa", ""]),
    ("ellipse across the groove", ["nut_ellipse_a_mm", "screw_ellipse_a_mm", ""]),
    ("ellipse along the groove", ["nut_ellipse_b_mm", "screw_ellipse_b_mm", ""]),
    ("elastic approach", ["nut_approach_um", "screw_approach_um", ""]),
    ("film", ["nut_film_um", "screw_film_um", ""]),
    ("film over roughness", ["nut_film_ratio", "screw_film_ratio", ""]),
    ("share of asperities", ["nut_asperity_share", "screw_asperity_share", ""]),
    ("friction coefficient", ["nut_friction_coefficient", "screw_friction_coefficient", ""]),
    ("rolling moment", ["nut_rolling_moment_Nmm", "screw_rolling_moment_Nmm", ""]),
    ("entrainment", ["nut_entrainment_m_s", "screw_entrainment_m_s", ""]),
];

/// One solved point.
pub(crate) fn record(scene: &Scene, record: &Record) -> String {
    let cell = |name: &str| Output::named(name).and_then(|output| record.cell(output));
    let mut status = record.status_name().to_owned();
    if let Some(Cell::Count(steps)) = cell("iterations") {
        status = format!("{status} in {steps} Newton steps");
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

    // A ball that rolls has slips that are all rounding: the speed of its surface tells.
    let surface = record.number("ball_omega_t_rad_s").map_or(0.0, |omega_t| {
        let rates = ["ball_omega_n_rad_s", "ball_omega_b_rad_s"].map(|name| record.number(name));
        let fastest = rates.into_iter().flatten().fold(omega_t.abs(), |a, b| a.max(b.abs()));
        0.5 * MM * scene.ball_diameter_mm.unwrap_or(0.0) * fastest
    });
    let numbers = OUTPUTS.iter().filter_map(|o| Some((o.unit, record.number(o.name)?)));
    let scales = Scales::of(numbers.chain([("m/s", surface)]));
    let cell = |name: &str| {
        let output = Output::named(name)?;
        record.number(name).map(|value| scales.print(output.unit, value))
    };
    let unit = |name: &str| Output::named(name).map_or("", |o| o.unit).to_owned();
    let overall: Vec<_> = OVERALL
        .iter()
        .filter_map(|(label, name)| Some(vec![(*label).to_owned(), unit(name), cell(name)?]))
        .collect();
    let contacts: Vec<_> = CONTACTS
        .iter()
        .filter_map(|(label, names)| {
            let cells = names.map(|name| cell(name).unwrap_or_default());
            let any = cells.iter().any(|c| !c.is_empty());
            any.then(|| [vec![(*label).to_owned(), unit(names[0])], cells.to_vec()].concat())
        })
        .collect();
    if !overall.is_empty() {
        blocks.push(plain(None, &overall, 2));
    }
    if !contacts.is_empty() {
        blocks.push(plain(Some(&["contact", "", "nut", "screw", "minor"]), &contacts, 2));
    }
    blocks.join("\n\n")
}

/// What the parts of a torque are, by their names.
const TORQUE_PARTS: [(&str, &str); 7] = [
    ("of the load, without friction", "ideal_torque_Nm"),
    ("contacts of the balls", "contact_friction_torque_Nm"),
    (
        "returns and lubricant of the preload, by the rule of makers",
        "preload_drag_beyond_contacts_Nm",
    ),
    ("seals", "seal_torque_Nm"),
    ("support bearings", "support_bearing_torque_Nm"),
    ("torque on the screw", "screw_torque_Nm"),
    ("efficiency of the screw", "efficiency"),
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
    let choice = report.choice.as_deref();
    let head = [("model ", Some(report.model.name())), ("chosen", choice)];
    let head = head.into_iter().filter_map(|(label, text)| Some(format!("{label}  {}", text?)));
    let mut parts = vec![head.collect::<Vec<_>>().join("\n")];
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
            let print =
                |v: Option<f64>| v.map_or_else(String::new, |v| scales.print(quantity.unit, v));
            let numbers = values.iter().take(members.len()).map(|value| print(*value));
            [quantity.about, quantity.unit].map(str::to_owned).into_iter().chain(numbers).collect()
        };
        let cells: Vec<Vec<String>> = rows.map(cells).collect();
        (!cells.is_empty()).then(|| plain(Some(&[&[title, ""], members].concat()), &cells, 2))
    };
    let tables = [table(Of::Whole, &[whole]), table(Of::Contacts, &["nut", "screw", "minor"])];
    tables.into_iter().flatten().collect::<Vec<_>>().join("\n\n")
}

/// Published trends, and whether the curves of a study follow them.
pub(crate) fn trends(study: &Study) -> String {
    let rows: Vec<_> = study
        .trends
        .iter()
        .map(|trend| {
            let claim = format!("{} with {}", trend.claim.word(), trend.over);
            let holds = if trend.holds { "holds" } else { "does not hold" };
            let numbers = [trend.first.1, trend.last.1].map(number);
            let words = [holds.to_owned(), trend.describe()];
            [vec![trend.curve.clone(), claim], numbers.to_vec(), words.to_vec()].concat()
        })
        .collect();
    let header = ["curve", "published trend", "from", "to", "", "what it does"];
    format!("trends of {}\n\n{}", study.basis, plain(Some(&header), &rows, usize::MAX))
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
