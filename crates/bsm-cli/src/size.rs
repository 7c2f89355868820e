//! `bsm size`: the axis around a screw.

use bsm_case::{NOT_MODELLED, PhaseWords, SizePhase, SizeReport, SizeRule};
use bsm_report::sheets::{size_figures, size_page, size_results};
use bsm_report::{number, short};

use crate::args::{Format, SizeArgs};
use crate::failure::{Failure, warn};
use crate::files::{
    MOST_OF_A_SPECTRUM, make_report_folder, pretty_json, print, read, read_scene, write_report,
};
use crate::table;

/// Numbers of a phase that a screen shows.
const SHOWN: [&str; 9] = [
    "time_share",
    "screw_load_N",
    "feed_m_min",
    "screw_speed_rpm",
    "ideal_torque_Nm",
    "whole_screw_torque_Nm",
    "screw_efficiency",
    "motor_torque_Nm",
    "heat_W",
];

pub(crate) fn run(args: &SizeArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let in_file = |e| Failure::scene(path, &e);
    let mut scene = read_scene(path, &args.scene.settings)?;
    if let Some(table) = &args.cycle {
        let bytes = read(table, MOST_OF_A_SPECTRUM)?;
        let cycle = PhaseWords::from_csv(&bytes, args.delimiter.byte(), args.decimal.sign());
        scene.nut.cycle = Some(cycle.map_err(|e| Failure::scene(table, &e))?);
    }
    let settings = args.model.settings().map_err(in_file)?;
    let report = SizeReport::of(&scene, &settings).map_err(in_file)?;
    let results = size_results(&report);
    if let Some(folder) = &args.out {
        make_report_folder(folder)?;
        write_report(folder, size_page(&report)?, &results, &size_figures(&report))?;
    }
    match args.format {
        Format::Json => print(&pretty_json(&results))?,
        Format::Table => {
            for warning in &report.warnings {
                warn("warning", warning);
            }
            print(&describe(&report))?;
        }
    }
    if report.passes() { Ok(()) } else { Err(Failure::Unsolved) }
}

fn describe(report: &SizeReport) -> String {
    let rules: Vec<_> = report.rules.iter().map(rule).collect();
    let header = ["rule", "", "", "value", "must be", "kept", "", "by"];
    let mut parts: Vec<_> = table::title(&report.scene).into_iter().collect();
    parts.push(table::plain(Some(&header), &rules, usize::MAX));
    let remedies: Vec<_> = report
        .rules
        .iter()
        .filter_map(|rule| Some(format!("{}: {}", rule.title, rule.remedy.as_ref()?)))
        .collect();
    if !remedies.is_empty() {
        parts.push(format!("what would help\n  {}", remedies.join("\n  ")));
    }
    let phases: Vec<_> =
        (1..).zip(&report.phases).map(|(place, phase)| of_phase(place, phase)).collect();
    let header: Vec<_> = std::iter::once("phase").chain(SHOWN).collect();
    parts.push(table::plain(Some(&header), &phases, 0));
    parts.push(table::size(&report.numbers));
    let left = NOT_MODELLED.iter().map(|text| format!("not modelled: {text}"));
    let notes = report.notes.iter().map(|note| format!("note: {note}")).chain(left);
    parts.push(notes.collect::<Vec<_>>().join("\n"));
    parts.join("\n\n")
}

fn rule(rule: &SizeRule) -> Vec<String> {
    let sign = if rule.at_least { ">=" } else { "<=" };
    let verdict = match (rule.limit, rule.passes()) {
        (None, _) => "",
        (_, true) => "pass",
        (_, false) => "FAIL",
    };
    vec![
        rule.title.to_owned(),
        rule.name.to_owned(),
        rule.unit.to_owned(),
        number(rule.value),
        rule.limit.map_or_else(String::new, |limit| format!("{sign} {}", number(limit))),
        rule.margin().map_or_else(String::new, |margin| format!("{} times", short(margin))),
        verdict.to_owned(),
        rule.source.to_owned(),
    ]
}

fn of_phase(place: usize, phase: &SizePhase) -> Vec<String> {
    let cell = |name: &str| {
        let found = phase.numbers.iter().find(|(own, ..)| *own == name);
        found.and_then(|(.., value)| *value).map_or_else(|| "-".to_owned(), number)
    };
    std::iter::once(place.to_string()).chain(SHOWN.map(cell)).collect()
}
