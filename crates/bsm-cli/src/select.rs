//! `bsm select`: chooses a screw for a requirement, from lists of sizes or from a manufacturer's
//! table.

use std::path::{Path, PathBuf};

use bsm_case::{
    Catalog, Content, DesignReport, DesignRow, MANUFACTURER_SIZES, REQUIREMENT_INPUTS,
    RequirementChoice, STANDARD_CATALOG,
};

use crate::answer::{Pictures, Reply, WriteTable};
use crate::args::{SelectArgs, SelectShow};
use crate::console::print_message;
use crate::failure::Failure;
use crate::files::{ending_of, print};
use crate::progress::show_spinner;
use crate::select_input::{STANDARD_HINT, Source, check, requirement};
use crate::table_job::write_rows;
use crate::{nuts, table};

pub(crate) fn run(args: &SelectArgs) -> Result<(), Failure> {
    match args.show {
        Some(SelectShow::Keys) => return print(&keys()),
        Some(SelectShow::Lists) => return print(STANDARD_CATALOG),
        Some(SelectShow::Sizes) => return print(MANUFACTURER_SIZES.trim_end()),
        Some(SelectShow::Columns) => return print(&nuts::columns()),
        None => {}
    }
    match Source::read(args)? {
        Source::Sizes(sizes) if args.requirement.is_some() && !args.is_list() => {
            steps(args, &sizes)
        }
        source => nuts::run(args, source),
    }
}

/// Chooses the best screw and prints the steps of this choice.
fn steps(args: &SelectArgs, sizes: &Catalog) -> Result<(), Failure> {
    let to = check(args, &["json", "csv", "xlsx"])?;
    let Some(requirement) = requirement(args, sizes)? else { return Ok(()) };
    let line = show_spinner("searching for the best screw");
    let of_sizes = if args.free { None } else { DesignReport::standard(&requirement, sizes) };
    if of_sizes.is_none() && !args.free {
        print_message(
            "note",
            &format!(
                "none of these sizes has the values that the requirement fixes, so continuous sizes are searched as with --free; {STANDARD_HINT}"
            ),
        );
    }
    let report = of_sizes.unwrap_or_else(|| DesignReport::of(&requirement));
    drop(line);
    let case = report.case.to_json();
    let units = args.display(Some(&report.case));
    let row = |row: &DesignRow| Some((row.name, row.unit, row.value?));
    let mut answer = report.answer();
    let is_json = |path: &&PathBuf| ending_of("-o", path, &["json"]).is_ok();
    if report.found {
        let next = match args.out.output.iter().find(is_json) {
            Some(path) => format!("bsm axis {}", path.display()),
            None => "-o SCREW.json writes the case for the other commands".to_owned(),
        };
        answer = answer.with_shown(Content::Text("next:", Some(next)));
    }
    let rows: Vec<_> = report.rows.iter().filter_map(row).collect();
    let table = |path: &Path| write_rows(path, &rows, units, &case);
    let table = (!rows.is_empty()).then(|| Box::new(table) as WriteTable<'_>);
    let found = report.found.then(|| case.clone());
    let reply = Reply { table, case: Some(found.into()), units, ..Reply::of(answer) };
    reply.deliver(&to, || Ok(Pictures::default()))
}

/// Returns a text that describes the keys of a requirement.
fn keys() -> String {
    let words = RequirementChoice::ALL.iter().map(|choice| {
        let meaning = format!("{}: {}", choice.about(), choice.words().join(", "));
        vec![choice.name().to_owned(), String::new(), meaning]
    });
    let numbers = REQUIREMENT_INPUTS.iter().map(|input| {
        let default = input.default.map_or_else(String::new, |d| format!("; defaults to {d}"));
        vec![input.name.to_owned(), input.unit.to_owned(), format!("{}{default}", input.about)]
    });
    let rows: Vec<_> = words.chain(numbers).collect();
    let table = table::plain(None, &rows, usize::MAX);
    format!(
        "A requirement needs axial_load_N or screw_torque_Nm with screw_speed_rpm or feed_m_min, or a cycle;\n\
         and stroke_mm or screw_length_mm. Without required_life_h, any life is accepted. friction_coefficient\n\
         defaults to 0.06. All rules of bsm axis are limits.\n\
         The program chooses lead_mm or lead_angle_deg, ball_diameter_mm, pitch_circle_diameter_mm,\n\
         contact_angle_deg, nut_conformity and loaded_turns, unless they are given.\n\
         A key is one of the following keys, or an input of a case (bsm schema input) that describes the\n\
         load, the axis, the lubricant or one of the sizes above. Other columns of the list of sizes, such as\n\
         nominal_diameter_mm, are not keys; restrict them with --where nominal_diameter_mm=25.\n\n{table}"
    )
}
