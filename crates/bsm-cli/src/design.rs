//! `bsm design`: a screw for a requirement.

use std::path::Path;

use bsm_case::{
    Catalogue, DesignReport, DesignRow, REQUIREMENT_INPUTS, REQUIREMENT_WORDS, RequirementFile,
};
use bsm_report::number;

use crate::args::{DesignArgs, Format};
use crate::failure::{Failure, warn};
use crate::files::{self, pretty_json, print, read_json};
use crate::stream::write_rows;
use crate::table;

pub(crate) fn run(args: &DesignArgs) -> Result<(), Failure> {
    let Some(path) = &args.requirement else {
        return print(&keys());
    };
    let json = read_json(path)?;
    files::keep(path, args.output.as_deref())?;
    let in_file = |e| Failure::scene(path, &e);
    let catalogue = Catalogue::standard().map_err(in_file)?;
    let standard = catalogue.lists.clone();
    let wish = RequirementFile::from_json(&json, &args.settings, standard).map_err(in_file)?;
    let report = if args.free {
        DesignReport::of(&wish)
    } else if let Some(report) = DesignReport::standard(&wish, &catalogue) {
        report
    } else {
        warn(
            "note",
            "no standard size is meant by this requirement: any size is taken, as with --free",
        );
        DesignReport::of(&wish)
    };
    if let Some(output) = args.output.as_deref().filter(|_| report.found) {
        files::write(output, &(pretty_json(&report.scene.to_json()) + "\n"))?;
    }
    if let Some(output) = &args.table {
        let row = |row: &DesignRow| Some((row.name, row.unit, row.value?));
        let rows: Vec<_> = report.rows.iter().filter_map(row).collect();
        files::keep(path, Some(output))?;
        write_rows(output, &rows, &report.scene.to_json())?;
    }
    match args.format {
        Format::Json => print(&pretty_json(&report.to_json()))?,
        Format::Table => {
            for warning in &report.warnings {
                warn("warning", warning);
            }
            print(&describe(&report, args.output.as_deref()))?;
        }
    }
    if report.found { Ok(()) } else { Err(Failure::Unsolved) }
}

fn describe(report: &DesignReport, output: Option<&Path>) -> String {
    let row = |row: &DesignRow| {
        let verdict = match (&row.requirement, row.passes) {
            (None, _) => "",
            (_, true) => "pass",
            (_, false) => "FAIL",
        };
        vec![
            row.step.to_string(),
            row.name.to_owned(),
            row.unit.to_owned(),
            row.value.map_or_else(|| "none".to_owned(), number),
            row.requirement.clone().unwrap_or_default(),
            verdict.to_owned(),
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
            Some(path) => format!("wrote {0}; next: bsm size {0}", path.display()),
            None => "-o SCREW.json writes the scene for every other command".to_owned(),
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
         stroke_mm or screw_length_mm; and friction_coefficient. All rules of bsm size are limits.\n\
         The design chooses lead_mm or lead_angle_deg, ball_diameter_mm, pitch_circle_diameter_mm,\n\
         contact_angle_deg, nut_conformity and loaded_turns unless given.\n\
         These are inputs of a scene (bsm schema input), or one of the following keys.\n\n{table}"
    )
}
