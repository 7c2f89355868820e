//! `bsm axis`: the axis around a screw.

use bsm_case::{NOT_MODELLED, PhaseWords, SizePhase, SizeReport, SizeRule};
use bsm_report::sheets::{size_figures, size_page, size_results};
use bsm_report::{number, short};

use crate::answer::{Answer, Drawn};
use crate::args::AxisArgs;
use crate::failure::Failure;
use crate::files::{MOST_OF_A_TABLE, read};
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

pub(crate) fn run(args: &AxisArgs) -> Result<(), Failure> {
    let in_file = args.scene.failure();
    let mut scene = args.scene.read()?;
    args.out.check(&["json", "html"], &[Some(args.scene.path())])?;
    if let Some(table) = &args.cycle {
        let signs = args.dialect.read(&["delimiter", "decimal"])?;
        let bytes = read(table, MOST_OF_A_TABLE)?;
        let separator = u8::try_from(signs.delimiter).unwrap_or(b',');
        let cycle = PhaseWords::from_csv(&bytes, separator, signs.decimal);
        scene.nut.cycle = Some(cycle.map_err(|e| Failure::scene(table, &e))?);
    }
    let settings = args.model.settings().map_err(in_file)?;
    let report = SizeReport::of(&scene, &settings).map_err(in_file)?;
    let answer = Answer {
        text: describe(&report),
        json: size_results(&report),
        warnings: report.warnings.clone(),
        failed: !report.passes(),
        ..Answer::default()
    };
    let draw = || Ok(Drawn { figures: size_figures(&report), page: Some(size_page(&report)?) });
    Answer::of_parts(&report.scene, vec![("axis", answer)]).give(&args.out, draw)
}

fn describe(report: &SizeReport) -> String {
    let rules: Vec<_> = report.rules.iter().map(rule).collect();
    let header = ["rule", "", "", "value", "must be", "kept", "", "by"];
    let mut parts = vec![table::plain(Some(&header), &rules, usize::MAX)];
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
    vec![
        rule.title.to_owned(),
        rule.name.to_owned(),
        rule.unit.to_owned(),
        number(rule.value),
        rule.limit.map_or_else(String::new, |limit| format!("{sign} {}", number(limit))),
        rule.margin().map_or_else(String::new, |margin| format!("{} times", short(margin))),
        table::verdict(rule.limit.map(|_| rule.passes())),
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
