//! `bsm axis`: calculates the speeds, loads, life, torque and heat of a feed axis and checks their
//! limits.

use std::path::Path;

use bsm_case::{AxisReport, Case, Content, GrooveSection, PhaseEntry, compare_offers};
use bsm_report::sheets::{offers_page, size_figures, size_page, size_table};
use bsm_report::{PROGRAM, groove_dxf};

use crate::answer::{Pictures, Reply};
use crate::args::AxisArgs;
use crate::failure::Failure;
use crate::files::{self, InputFiles, MAX_TABLE_BYTES, ending_of, read};
use crate::progress::show_spinner;

pub(crate) fn run(args: &AxisArgs) -> Result<(), Failure> {
    let names = args.table.names.as_deref();
    let files = [Some(args.case.path()), args.other.as_deref(), args.cycle.as_deref(), names];
    let endings: &[&'static str] =
        if args.other.is_some() { &["json", "html"] } else { &["json", "html", "dxf", "csv"] };
    let to = args.out.check(endings, InputFiles::of(files))?;
    let report = report(args, args.case.read_as_given()?, args.case.path())?;
    if let Some(other) = &args.other {
        let case = args.case.read_other(other)?;
        let second = self::report(args, case, other)?;
        let names = [args.case.path(), other].map(|path| path.display().to_string());
        let answer = compare_offers(names.each_ref().map(String::as_str), [&report, &second]);
        let units = report.case.display_units();
        let names = names.each_ref().map(String::as_str);
        let page = || -> Result<_, Failure> { Ok(Some(offers_page(&answer, names, units)?)) };
        let reply = Reply { units, ..Reply::of(answer.clone()) };
        return reply.deliver(&to, || Ok(Pictures { page: page()?, ..Pictures::default() }));
    }
    let answer = report.answer.clone().with("program", Content::Json(PROGRAM.into()));
    // The drawing shows the groove profiles, so the groove geometry of the case must be known.
    let drawing = GrooveSection::of(&report.case).map(|section| groove_dxf(&section));
    if args.out.output.iter().any(|path| ending_of("-o", path, &["dxf"]).is_ok()) {
        drawing.as_ref().map_err(|error| Failure::case(args.case.path(), error))?;
    }
    let table =
        |path: &Path| files::write(path, &size_table(&report, &args.table.output_format())?);
    let draw = || {
        let line = show_spinner("drawing the figures");
        let figures = size_figures(&report);
        drop(line);
        let page = Some(size_page(&report, &figures, args.case.hash().as_deref())?);
        Ok(Pictures { figures, page, drawing: drawing.ok() })
    };
    let reply = Reply { table: Some(Box::new(table)), ..Reply::about(&report.case, answer) };
    reply.deliver(&to, draw)
}

/// Analyzes the feed axis of a case. If `--cycle` names a table, the load cycle in this table
/// replaces the cycle of the case.
///
/// * `path`: path of the case file, for messages.
fn report(args: &AxisArgs, mut case: Case, path: &Path) -> Result<AxisReport, Failure> {
    if let Some(table) = &args.cycle {
        let format = args.table.format()?;
        let bytes = read(table, MAX_TABLE_BYTES)?;
        let cycle = PhaseEntry::from_csv(&bytes, &format);
        case.entries.cycle = Some(cycle.map_err(|e| Failure::case(table, &e))?);
    } else {
        args.table.only_with("--cycle")?;
    }
    let settings = args.model.settings()?;
    let line = show_spinner("calculating the axis");
    let report = AxisReport::of(&case, &settings);
    drop(line);
    report.map_err(|error| Failure::case(path, &error))
}
