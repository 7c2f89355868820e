//! `bsm solve`: solves one operating point and calculates slip, jamming, the optimum contact angle
//! and load ratings.

use std::path::Path;

use bsm_case::{
    Answer, Case, CaseError, DRAWS, EllipseFields, ModelChoice, Record, Sensitivities, Settings,
    Supplement, comparison, jam, slip,
};
use bsm_dyn::{ModelWorkspace, Solution, Status};
use bsm_report::sheets::Study;
use bsm_report::{Figure, PROGRAM, ReportError};

use crate::answer::{Pictures, Reply, WriteTable};
use crate::args::{ALL_MODELS, Show, SolveArgs};
use crate::failure::Failure;
use crate::files::InputFiles;
use crate::nut::table_writer;
use crate::progress::show_spinner;
use crate::table_job::write_rows;

/// Sections of the answer, with the names of their JSON members if several sections are requested.
const PARTS: [(Show, &str); 6] = [
    (Show::Motion, "motion"),
    (Show::Slip, "slip"),
    (Show::Ellipses, "ellipses"),
    (Show::Jam, "jam"),
    (Show::Optimum, "optimum"),
    (Show::Ratings, "ratings"),
];

/// Returns the section of the answer that a given value of `--show` requests.
fn part_of(word: Show) -> Show {
    match word {
        Show::Band | Show::Sensitivities => Show::Motion,
        Show::Steps => Show::Ratings,
        part => part,
    }
}

pub(crate) fn run(args: &SolveArgs) -> Result<(), Failure> {
    let case = args.case.read()?;
    let is_shown = |(part, _): &(Show, &str)| match args.show[..] {
        [] => *part == Show::Motion,
        _ => args.show.iter().any(|word| part_of(*word) == *part),
    };
    let named_parts: Vec<_> = PARTS.into_iter().filter(is_shown).collect();
    let shown: Vec<_> = named_parts.iter().map(|(part, _)| *part).collect();
    let has_rows = shown == [Show::Ratings];
    let endings: &[&'static str] = match shown[..] {
        [Show::Ratings] => &["json", "csv", "xlsx"],
        [Show::Ellipses] => &["json", "csv", "jsonl", "parquet", "xlsx"],
        _ => &["json"],
    };
    let to = args.out.check(endings, InputFiles::of([Some(args.case.path())]))?;
    if args.points.is_some() && !shown.contains(&Show::Ellipses) {
        return Err(Failure::Input("--points applies only to --show ellipses".to_owned()));
    }
    let draws = |part: &Show| matches!(part, Show::Slip | Show::Jam | Show::Optimum);
    if args.out.figures.is_some() && !shown.iter().any(draws) {
        let text = "--figures draws only the results of --show slip, jam and optimum";
        return Err(Failure::Input(text.to_owned()));
    }
    if args.model.model == ALL_MODELS {
        if !args.show.is_empty() || args.model.has_settings() {
            let text = "--model all compares the motion in all models and cannot be combined with --show or with model settings";
            return Err(Failure::Input(text.to_owned()));
        }
        let answer = comparison(&case).map_err(args.case.failure())?;
        return Reply::about(&case, answer).deliver(&to, || Ok(Pictures::default()));
    }
    let mut settings = args.model.settings()?;
    // All requested sections describe the same motion, so they must use the same model.
    if shown.iter().any(|part| matches!(part, Show::Slip | Show::Ellipses | Show::Jam)) {
        settings.model = settings.model.for_motion(case.stated());
    }
    let line = show_spinner("solving");
    let mut figures = Vec::new();
    let mut parts = Vec::new();
    let mut table = None;
    for (part, name) in named_parts {
        let drawn = args.out.figures.is_some().then_some(&mut figures);
        let answer = match part {
            Show::Motion | Show::Band | Show::Sensitivities => motion(args, &case, &settings)?,
            Show::Slip => analysis(args, &case, &settings, drawn, slip, Study::slip)?,
            Show::Ellipses => ellipses(args, &case, &settings, &mut table)?,
            Show::Jam => {
                let jam = |case: &_, _: &_, solution: &_| jam(case, solution);
                analysis(args, &case, &settings, drawn, jam, Study::jam)?
            }
            Show::Optimum => optimum(args, &case, &settings, drawn)?,
            Show::Ratings | Show::Steps => ratings(args, &case)?,
        };
        let possible = |possible: &Case| recalculate_section(part, args, possible, &settings);
        parts.push((name, answer.with_groove_intervals(&case, DRAWS, possible)));
    }
    drop(line);
    let of_ratings = parts.iter().filter(|_| has_rows).flat_map(|(_, ratings)| ratings.entries());
    let rows: Vec<_> =
        of_ratings.map(|(column, value)| (column.name, column.unit, value)).collect();
    if !rows.is_empty() {
        let (about, units) = (case.to_json(), case.display_units());
        table = Some(Box::new(move |path: &Path| write_rows(path, &rows, units, &about)));
    }
    let reply = Reply { parts, table, ..Reply::about(&case, Answer::default()) };
    reply.deliver(&to, || Ok(Pictures { figures, ..Pictures::default() }))
}

/// Recalculates a section of the answer for another groove that is consistent with the inputs, or
/// returns `None` if there is no solution.
fn recalculate_section(
    part: Show,
    args: &SolveArgs,
    case: &Case,
    settings: &Settings,
) -> Option<Answer> {
    let solution = || {
        let solution = case.problem(settings).ok()?.solve(&mut ModelWorkspace::default());
        (solution.status() == Status::Converged).then_some(solution)
    };
    match part {
        Show::Motion | Show::Band | Show::Sensitivities => {
            let supplement = Supplement { parts: true, ..Supplement::default() };
            Some(Record::new(solution()?).answer(PROGRAM, case, settings, &supplement))
        }
        Show::Slip => slip(case, settings, &solution()?).ok(),
        Show::Jam => jam(case, &solution()?).ok(),
        Show::Ellipses => {
            let points = args.points.unwrap_or(EllipseFields::POINTS);
            Some(EllipseFields::of(case, settings, &solution()?, points).ok()?.answer())
        }
        Show::Optimum => optimum(args, case, settings, None).ok(),
        Show::Ratings | Show::Steps => ratings(args, case).ok(),
    }
}

/// Solves the motion and adds the 90 % interval or the sensitivities if they are requested.
fn motion(args: &SolveArgs, case: &Case, settings: &Settings) -> Result<Answer, Failure> {
    let in_file = args.case.failure();
    let mut work = ModelWorkspace::default();
    let solution = case.problem(settings).map_err(in_file)?.solve(&mut work);
    let band = args.show.contains(&Show::Band) || args.show.is_empty() && !args.out.json;
    let (mut notes, mut sensitivities) = (Vec::new(), None);
    if args.show.contains(&Show::Sensitivities) && solution.status() == Status::Converged {
        let inputs = Sensitivities::of(case, settings).map_err(in_file)?;
        match inputs.solve(&mut work) {
            Ok((_, rows)) => sensitivities = Some(rows),
            Err(none) => {
                let failed = Record::new(Solution::new(solution.model, Err(none)));
                notes.push(format!(
                    "The sensitivities are not calculated: {}",
                    failed.message().unwrap_or_default()
                ));
            }
        }
    }
    let lacks = args.show.contains(&Show::Sensitivities) && sensitivities.is_none();
    let mut answer = model_answer(
        args,
        case,
        settings,
        solution,
        &Supplement { band, parts: true, sensitivities },
    )?;
    answer.notes.splice(0..0, notes);
    answer.fails |= lacks;
    Ok(answer)
}

/// Returns the results of the motion, or the reason why the motion has no solution.
fn model_answer(
    args: &SolveArgs,
    case: &Case,
    settings: &Settings,
    solution: Solution,
    supplement: &Supplement,
) -> Result<Answer, Failure> {
    let record = Record::new(solution);
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model does not accept the inputs");
        return Err(Failure::in_case(args.case.path(), text));
    }
    Ok(record.answer(PROGRAM, case, settings, supplement))
}

/// Runs the slip or jamming analysis of the solved motion, and the sweeps for its figures.
fn analysis(
    args: &SolveArgs,
    case: &Case,
    settings: &Settings,
    figures: Option<&mut Vec<Figure>>,
    report: impl Fn(&Case, &Settings, &Solution) -> Result<Answer, CaseError>,
    study: impl Fn(&Case, &Settings, &Solution) -> Result<Study, ReportError>,
) -> Result<Answer, Failure> {
    motion_answer(args, case, settings, |solution| {
        let answer = report(case, settings, solution).map_err(args.case.failure())?;
        if let Some(figures) = figures {
            let units = case.display_units();
            let drawn = study(case, settings, solution)?.figures;
            figures.extend(drawn.into_iter().map(|figure| figure.in_units(units)));
        }
        Ok(answer)
    })
}

/// Runs an analysis of the ball motion, or returns the reason why the motion has no solution.
fn motion_answer(
    args: &SolveArgs,
    case: &Case,
    settings: &Settings,
    answer: impl FnOnce(&Solution) -> Result<Answer, Failure>,
) -> Result<Answer, Failure> {
    let problem = case.problem(settings).map_err(args.case.failure())?;
    let solution = problem.solve(&mut ModelWorkspace::default());
    if solution.reason().is_some() {
        return model_answer(args, case, settings, solution, &Supplement::default());
    }
    answer(&solution)
}

/// Calculates pressure, slip and friction over the contact ellipses. The table contains one row per
/// point.
fn ellipses<'a>(
    args: &SolveArgs,
    case: &'a Case,
    settings: &Settings,
    table: &mut Option<WriteTable<'a>>,
) -> Result<Answer, Failure> {
    motion_answer(args, case, settings, |solution| {
        let points = args.points.unwrap_or(EllipseFields::POINTS);
        let fields = EllipseFields::of(case, settings, solution, points);
        let fields = fields.map_err(args.case.failure())?;
        *table = Some(table_writer(fields.columns(), case));
        Ok(fields.answer())
    })
}

/// Finds the optimum contact angle and the self-locking limits.
fn optimum(
    args: &SolveArgs,
    case: &Case,
    settings: &Settings,
    figures: Option<&mut Vec<Figure>>,
) -> Result<Answer, Failure> {
    let model = match settings.model {
        ModelChoice::Auto => None,
        ModelChoice::Fixed(model) => Some(model),
    };
    let answer = bsm_case::optimum(case, model).map_err(args.case.failure())?;
    if let Some(figures) = figures {
        figures.extend(bsm_report::sheets::lin_figures(case)?);
    }
    Ok(answer)
}

/// Calculates the load ratings of the nut.
fn ratings(args: &SolveArgs, case: &Case) -> Result<Answer, Failure> {
    let answer = bsm_case::ratings(case).map_err(args.case.failure())?;
    Ok(if args.show.contains(&Show::Steps) { answer } else { answer.hiding("steps") })
}
