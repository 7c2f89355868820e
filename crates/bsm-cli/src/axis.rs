//! `bsm axis`: the axis around a screw.

use bsm_case::{AxisReport, Content, PhaseWords};
use bsm_report::PROGRAM;
use bsm_report::sheets::{size_figures, size_page};

use crate::answer::{Drawn, Reply};
use crate::args::AxisArgs;
use crate::failure::Failure;
use crate::files::{MOST_OF_A_TABLE, read};

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
    let report = AxisReport::of(&scene, &settings).map_err(in_file)?;
    let answer = report.answer.clone().with("program", Content::Json(PROGRAM.into()));
    let draw = || Ok(Drawn { figures: size_figures(&report), page: Some(size_page(&report)?) });
    Reply::about(&report.scene, answer).give(&args.out, draw)
}
