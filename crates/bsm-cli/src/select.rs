//! `bsm select`: a screw for a requirement, and nuts of a manufacturer beside ours.

use std::path::{Path, PathBuf};

use bsm_case::{
    Catalogue, DesignReport, DesignRow, MakerNut, MakerRow, REQUIREMENT_INPUTS, REQUIREMENT_WORDS,
    RequirementFile, STANDARD_CATALOGUE,
};
use bsm_report::{number, short};
use serde_json::{Map, Value, json};

use crate::answer::{Answer, Drawn};
use crate::args::{SelectArgs, SelectShow};
use crate::failure::{Failure, warn};
use crate::files::{MOST_OF_A_TABLE, ending_of, print, read, read_json};
use crate::{nuts, table};

/// The lists that the program has.
pub(crate) const STANDARD: &str = "standard";

pub(crate) fn run(args: &SelectArgs) -> Result<(), Failure> {
    match args.show {
        Some(SelectShow::Keys) => return print(&keys()),
        Some(SelectShow::Lists) => return print(STANDARD_CATALOGUE),
        Some(SelectShow::Columns) => return print(&nuts::columns()),
        None => {}
    }
    let table = args.from.as_deref().filter(|path| ending_of("--from", path, &["csv"]).is_ok());
    if table.is_none() && !args.dialect.is_ours() {
        return Err(Failure::Input("--dialect is for the table of --from TABLE.csv".to_owned()));
    }
    match (table, &args.requirement) {
        (Some(table), _) => makers(args, table),
        (None, Some(requirement)) if !args.is_list() => steps(args, requirement),
        _ => nuts::run(args),
    }
}

/// Refuses files of other endings, and those that were read.
pub(crate) fn check(args: &SelectArgs, endings: &[&'static str]) -> Result<(), Failure> {
    args.out.check(endings, &[args.requirement.as_deref(), args.from.as_deref()])
}

/// The requirement that nuts are held against.
pub(crate) fn requirement(
    args: &SelectArgs,
    catalogue: &Catalogue,
) -> Result<Option<RequirementFile>, Failure> {
    let Some(path) = &args.requirement else { return Ok(None) };
    let wish =
        RequirementFile::from_json(&read_json(path)?, &args.settings, catalogue.lists.clone());
    wish.map(Some).map_err(|e| Failure::scene(path, &e))
}

/// The best screw, and the steps that lead to it.
fn steps(args: &SelectArgs, path: &Path) -> Result<(), Failure> {
    check(args, &["json", "csv", "xlsx"])?;
    let catalogue = Catalogue::standard().map_err(|e| Failure::scene(path, &e))?;
    let Some(wish) = requirement(args, &catalogue)? else { return Ok(()) };
    let standard = if args.free { None } else { DesignReport::standard(&wish, &catalogue) };
    if standard.is_none() && !args.free {
        warn(
            "note",
            "no standard size is meant by this requirement: any size is taken, as with --free",
        );
    }
    let report = standard.unwrap_or_else(|| DesignReport::of(&wish));
    let scene = report.scene.to_json();
    let row = |row: &DesignRow| Some((row.name.to_owned(), row.unit.to_owned(), row.value?));
    let is_scene = |path: &&PathBuf| ending_of("-o", path, &["json"]).is_ok();
    let written = args.out.output.iter().find(is_scene);
    let answer = Answer {
        text: describe(&report, written.map(PathBuf::as_path)),
        json: report.to_json(),
        rows: report.rows.iter().filter_map(row).collect(),
        about: scene.clone(),
        scene: Some(report.found.then_some(scene).into()),
        failed: !report.found,
        warnings: report.warnings,
        ..Answer::default()
    };
    answer.give(&args.out, || Ok(Drawn::default()))
}

fn describe(report: &DesignReport, output: Option<&Path>) -> String {
    let row = |row: &DesignRow| {
        vec![
            row.step.to_string(),
            row.name.to_owned(),
            row.unit.to_owned(),
            row.value.map_or_else(|| "none".to_owned(), number),
            row.requirement.clone().unwrap_or_default(),
            table::verdict(row.requirement.as_ref().map(|_| row.passes)),
        ]
    };
    let rows: Vec<_> = report.rows.iter().map(row).collect();
    let header = ["step", "", "", "value", "must be", ""];
    let table = table::plain(Some(&header), &rows, usize::MAX);
    let verdict = if report.found {
        let held = if report.reasons.is_empty() {
            "nothing: the optimum is within all limits".to_owned()
        } else {
            report.reasons.join(", ")
        };
        let next = match output {
            Some(path) => format!("wrote {0}; next: bsm axis {0}", path.display()),
            None => "-o SCREW.json writes the scene for the other commands".to_owned(),
        };
        format!("what holds it back: {held}\n{next}")
    } else {
        format!(
            "no screw meets the requirement; what blocks it:\n  {}",
            report.reasons.join("\n  ")
        )
    };
    format!("{table}\n\n{verdict}")
}

/// What a requirement may say.
fn keys() -> String {
    let words = REQUIREMENT_WORDS.iter().map(|(name, words, about)| {
        vec![(*name).to_owned(), String::new(), format!("{about}: {}", words.join(", "))]
    });
    let numbers = REQUIREMENT_INPUTS.iter().map(|input| {
        let default = input.default.map_or_else(String::new, |d| format!("; {d} unless given"));
        vec![input.name.to_owned(), input.unit.to_owned(), format!("{}{default}", input.about)]
    });
    let rows: Vec<_> = words.chain(numbers).collect();
    let table = table::plain(None, &rows, usize::MAX);
    format!(
        "A requirement needs axial_load_N or screw_torque_Nm with screw_speed_rpm or feed_m_min, or a cycle;\n\
         stroke_mm or screw_length_mm; and friction_coefficient. All rules of bsm axis are limits.\n\
         The design chooses lead_mm or lead_angle_deg, ball_diameter_mm, pitch_circle_diameter_mm,\n\
         contact_angle_deg, nut_conformity and loaded_turns unless given.\n\
         These are inputs of a scene (bsm schema input), or one of the following keys.\n\n{table}"
    )
}

/// Nuts of a manufacturer beside ours, and in the axis of a requirement.
fn makers(args: &SelectArgs, path: &Path) -> Result<(), Failure> {
    if !args.conditions.is_empty()
        || args.pareto
        || args.sort.is_some()
        || args.first.is_some()
        || args.out.figures.is_some()
    {
        let text = "--where, --pareto, --sort, --first and --figures are for lists of standard sizes, not for --from TABLE.csv";
        return Err(Failure::Input(text.to_owned()));
    }
    check(args, &["json"])?;
    let bytes = read(path, MOST_OF_A_TABLE)?;
    let signs = args.dialect.read(&["delimiter", "decimal", "names"])?;
    let delimiter = u8::try_from(signs.delimiter).unwrap_or(b',');
    let nuts = MakerNut::from_csv(&bytes, &signs.names, delimiter, signs.decimal)
        .map_err(|e| Failure::scene(path, &e))?;
    let catalogue = Catalogue::standard().map_err(|e| Failure::scene(path, &e))?;
    let wish = requirement(args, &catalogue)?;
    let rows = MakerRow::all(&nuts, wish.as_ref())
        .map_err(|(name, e)| Failure::in_scene(path, &format!("{name}: {e}")))?;
    let passing = rows.iter().filter(|row| row.passes == Some(true)).count();
    if wish.is_some() {
        warn("note", &format!("{passing} of {} nuts keep all rules", rows.len()));
    }
    let usable = wish.is_none() || passing > 0;
    let answer = Answer {
        text: beside(&rows),
        json: rows.iter().map(nut_json).collect(),
        scene: Some(rows.first().filter(|_| usable).map(|row| row.scene.to_json()).into()),
        failed: !usable,
        ..Answer::default()
    };
    answer.give(&args.out, || Ok(Drawn::default()))
}

fn nut_json(row: &MakerRow) -> Value {
    let mut map = Map::from_iter([("nut".to_owned(), json!(row.name))]);
    map.extend(row.numbers.iter().map(|(name, _, value)| (name.clone(), json!(value))));
    map.extend(row.passes.map(|passes| ("passes".to_owned(), json!(passes))));
    Value::Object(map)
}

fn beside(rows: &[MakerRow]) -> String {
    let Some(first) = rows.first() else { return "the table has no nut".to_owned() };
    let sized = first.passes.is_some();
    let cells = |row: &MakerRow| {
        let numbers =
            row.numbers.iter().map(|(.., value)| value.map_or_else(|| "-".to_owned(), number));
        let verdict = row.passes.map(|passes| table::verdict(Some(passes)));
        std::iter::once(row.name.clone()).chain(numbers).chain(verdict).collect()
    };
    let mut header: Vec<_> = std::iter::once("nut")
        .chain(first.numbers.iter().map(|(name, ..)| name.as_str()))
        .collect();
    header.extend(sized.then_some(""));
    let table = table::plain(Some(&header), &rows.iter().map(cells).collect::<Vec<_>>(), 1);
    // How far ours are from the maker's.
    let ratio = |name: &str| {
        let ratios = rows
            .iter()
            .filter_map(|row| Some(row.value(&format!("our_{name}"))? / row.value(name)?));
        let ratios: Vec<f64> = ratios.collect();
        let (low, high) =
            ratios.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), r| (l.min(*r), h.max(*r)));
        (!ratios.is_empty()).then(|| format!("{name} {} to {}", short(low), short(high)))
    };
    let ratios = ["dynamic_load_rating_N", "static_load_rating_N", "rigidity_N_um"].map(ratio);
    let ratios: Vec<_> = ratios.into_iter().flatten().collect();
    if ratios.is_empty() {
        return table;
    }
    format!("{table}\n\nours over the maker's: {}", ratios.join(", "))
}
