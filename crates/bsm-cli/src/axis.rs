//! `bsm axis`: the axis around a screw.

use std::path::Path;

use bsm_case::{AxisReport, Content, GrooveSection, PhaseEntry};
use bsm_report::sheets::{size_figures, size_page, size_table};
use bsm_report::{PROGRAM, groove_dxf};

use crate::answer::{Pictures, Reply};
use crate::args::AxisArgs;
use crate::failure::Failure;
use crate::files::{self, InputFiles, MOST_OF_A_TABLE, ending_of, read};
use crate::progress::waiting;

pub(crate) fn run(args: &AxisArgs) -> Result<(), Failure> {
    let in_file = args.case.failure();
    let mut case = args.case.read_as_given()?;
    let inputs = InputFiles::of([Some(args.case.path()), args.cycle.as_deref()]);
    let to = args.out.check(&["json", "html", "dxf", "csv"], inputs)?;
    if let Some(table) = &args.cycle {
        let format = args.dialect.read(&["delimiter", "decimal"])?;
        let bytes = read(table, MOST_OF_A_TABLE)?;
        let cycle = PhaseEntry::from_csv(&bytes, &format);
        case.nut.cycle = Some(cycle.map_err(|e| Failure::case(table, &e))?);
    }
    let settings = args.model.settings()?;
    let line = case.asks_warm().then(|| waiting("warm steady state, its band and its fold"));
    let report = AxisReport::of(&case, &settings);
    if let Some(line) = line {
        line.finish_and_clear();
    }
    let report = report.map_err(in_file)?;
    let answer = report.answer.clone().with("program", Content::Json(PROGRAM.into()));
    // A drawing needs the grooves.
    let drawing = GrooveSection::of(&report.case).map(|section| groove_dxf(&section));
    if args.out.output.iter().any(|path| ending_of("-o", path, &["dxf"]).is_ok()) {
        drawing.as_ref().map_err(|error| Failure::case(args.case.path(), error))?;
    }
    let table = |path: &Path| files::write(path, &size_table(&report)?);
    let draw = || {
        let page = Some(size_page(&report, args.case.hash().as_deref())?);
        Ok(Pictures { figures: size_figures(&report), page, drawing: drawing.ok() })
    };
    let reply = Reply { table: Some(Box::new(table)), ..Reply::about(&report.case, answer) };
    reply.give(&to, draw)
}
