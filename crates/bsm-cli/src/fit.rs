//! `bsm fit`: finds inputs from measured outputs.

use std::path::Path;

use bsm_case::{
    Answer, Calibration, CalibrationReport, Case, CaseError, Fit, FittedInput, MeasurementError,
    NoFit, Settings,
};
use bsm_report::{Curve, Figure, PlotAxis, Stroke, format_number};

use crate::answer::{Pictures, Reply};
use crate::args::FitArgs;
use crate::failure::{Failure, input_error_text, note_unused};
use crate::files::{self, InputFiles, MAX_TABLE_BYTES};
use crate::progress::show_spinner;

pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let given = args.case.read_as_given()?;
    // A case whose groove is unknown is accepted here, because some outputs of `bsm axis` do not
    // depend on the groove geometry.
    let case = match given.with_groove() {
        Err(CaseError::NoGroove(_)) if args.points.is_none() => given,
        found => found.map_err(args.case.failure())?,
    };
    let settings = args.model.settings()?;
    let endings: &[&'static str] =
        if args.points.is_some() { &["json", "svg", "png"] } else { &["json"] };
    let inputs = InputFiles::of([Some(args.case.path()), args.points.as_deref()]);
    let to = args.out.check(endings, inputs)?;
    if args.points.is_none() {
        args.dialect.only_with("--points")?;
    }
    let line = show_spinner("fitting");
    let (answer, figures) = match &args.points {
        Some(points) => {
            let (answer, figure) = to_table(args, points, &case, &settings)?;
            (answer, vec![figure.in_units(case.display_units())])
        }
        None if args.out.figures.is_some() => {
            let text =
                "--figures compares measured points with fitted points, so it requires --points";
            return Err(Failure::Input(text.to_owned()));
        }
        None => (to_point(args, &case, &settings)?, Vec::new()),
    };
    drop(line);
    Reply { units: case.display_units(), ..Reply::of(answer) }
        .deliver(&to, || Ok(Pictures { figures, ..Pictures::default() }))
}

/// Finds all values of an input at which an output has its measured value or a rule reaches its
/// limit.
fn to_point(args: &FitArgs, case: &Case, settings: &Settings) -> Result<Answer, Failure> {
    let [input] = &args.input[..] else {
        let text =
            "one measured point determines only one --input; several inputs require --points";
        return Err(Failure::Input(text.to_owned()));
    };
    let fit = match (&args.limit, &args.measured) {
        (Some(rule), _) => {
            FittedInput::parse(input).and_then(|input| Fit::of_limit(case, &input, rule))
        }
        (None, measured) => Fit::parse(case, input, measured.as_deref().unwrap_or_default()),
    };
    let fit = fit.map_err(|e| Failure::Input(input_error_text(&e)))?;
    if fit.solves_one_ball() {
        note_unused(case.given());
    }
    let report = fit.run(case, settings).map_err(args.case.failure())?;
    Ok(fit.answer(case, &report))
}

/// Fits inputs to all points of a table by least squares.
fn to_table(
    args: &FitArgs,
    points: &Path,
    case: &Case,
    settings: &Settings,
) -> Result<(Answer, Figure), Failure> {
    let bytes = files::read(points, MAX_TABLE_BYTES)?;
    let usage = |e: CaseError| Failure::input(points.display(), &e);
    let measured = args.measured.as_deref().unwrap_or_default();
    let format = args.dialect.format();
    let errors = args.errors.as_deref().map(MeasurementError::named).transpose().map_err(usage)?;
    let inputs = args.input.iter().map(|text| FittedInput::parse(text));
    let inputs: Vec<_> = inputs.collect::<Result<_, _>>().map_err(usage)?;
    let prepare = |case: &Case| Calibration::new(case, &inputs, measured, errors, &bytes, &format);
    let fit = prepare(case).map_err(usage)?;
    let report = fit.run(case, settings).map_err(usage)?.map_err(|none| {
        let how = if none == NoFit::NotConverged { ", --input NAME=LOW:HIGH" } else { "" };
        Failure::Check(format!("{none}{how}"))
    })?;
    let figure = figure(&fit, &report);
    let answer = fit.answer(case, &report);
    Ok((Calibration::with_groove_intervals(answer, case, settings, prepare), figure))
}

/// Plots fitted values against measured values, together with the line on which they are equal.
fn figure(fit: &Calibration, report: &CalibrationReport) -> Figure {
    let all: Vec<_> = fit.fitted(report).collect();
    let values = all.iter().flat_map(|(a, b)| [*a, *b]);
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let found: Vec<_> = fit
        .rows(report)
        .into_iter()
        .map(|(name, value, _)| format!("{name} = {}", format_number(value)))
        .collect();
    let axis = |what: &str| PlotAxis::linear(&format!("{what} {}", fit.output()));
    Figure::new(
        ["fit", &format!("{} with {}", fit.output(), found.join(", ")), ""],
        [axis("measured"), axis("fitted")],
        vec![
            Curve::new("equal", 0, Stroke::Solid, vec![(low, low), (high, high)]),
            Curve::new("points", 1, Stroke::Circles, all),
        ],
    )
}
