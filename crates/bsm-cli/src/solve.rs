//! `bsm solve`: one operating point, and what follows from it.

use bsm_case::{
    Analysis, CapacityReport, CaseError, Compared, Comparison, ModelChoice, Moving, OptimumReport,
    Record, Scene, Sensitivities, Sensitivity, Settings, SizePhase, torque_parts,
};
use bsm_dyn::{Band, ModelWorkspace, Problem, Solution, Status};
use bsm_report::sheets::Study;
use bsm_report::{Figure, PROGRAM, number};
use serde_json::{Map, Value};

use crate::answer::{Answer, Drawn, named};
use crate::args::{ALL, Show, SolveArgs};
use crate::failure::{Failure, note_unused};
use crate::table;

/// What is shown, in this order, and the words of each.
const SHOWN: [(&str, &[Show]); 5] = [
    ("motion", &[Show::Motion, Show::Band, Show::Sensitivities]),
    ("slip", &[Show::Slip]),
    ("jam", &[Show::Jam]),
    ("optimum", &[Show::Optimum]),
    ("ratings", &[Show::Ratings, Show::Steps]),
];

pub(crate) fn run(args: &SolveArgs) -> Result<(), Failure> {
    let scene = args.scene.read()?;
    let is_asked = |word: &Show| args.show.contains(word);
    let shown: Vec<_> = SHOWN
        .into_iter()
        .filter(|(name, words)| {
            words.iter().any(is_asked) || args.show.is_empty() && *name == "motion"
        })
        .map(|(name, _)| name)
        .collect();
    let has_rows = shown == ["ratings"];
    let endings: &[&'static str] = if has_rows { &["json", "csv", "xlsx"] } else { &["json"] };
    args.out.check(endings, &[Some(args.scene.path())])?;
    let draws = |name: &str| ["slip", "jam", "optimum"].contains(&name);
    if args.out.figures.is_some() && !shown.iter().any(|name| draws(name)) {
        let text = "--figures draws what --show slip, jam and optimum show";
        return Err(Failure::Input(text.to_owned()));
    }
    if args.model.model == ALL {
        if !args.show.is_empty() || args.model.has_settings() {
            let text = "--model all sets the motion by all models side by side, without --show and --solver";
            return Err(Failure::Input(text.to_owned()));
        }
        let answer = models(&scene).map_err(args.scene.failure())?;
        note_unused(scene.given());
        return Answer::of_parts(&scene, vec![("models", answer)])
            .give(&args.out, || Ok(Drawn::default()));
    }
    let settings = args.model.settings().map_err(args.scene.failure())?;
    if shown.iter().any(|name| ["motion", "slip", "jam"].contains(name)) {
        note_unused(scene.given());
    }
    let mut figures = Vec::new();
    let mut parts = Vec::new();
    for name in shown {
        let drawn = args.out.figures.is_some().then_some(&mut figures);
        let part = match name {
            "motion" => motion(args, &scene, &settings)?,
            "optimum" => optimum(args, &scene, &settings, drawn)?,
            "ratings" => ratings(args, &scene)?,
            of_motion => analysis(args, of_motion == "slip", &scene, &settings, drawn)?,
        };
        parts.push((name, part));
    }
    Answer::of_parts(&scene, parts).give(&args.out, || Ok(Drawn { figures, page: None }))
}

/// What is shown with a motion.
#[derive(Default)]
struct Beside {
    /// How sure a friction from the lubricant is.
    band: Option<Band>,
    /// The torque of the whole screw by its parts.
    parts: Option<SizePhase>,
    sensitivities: Option<Vec<Sensitivity>>,
}

/// The motion, with what is shown besides.
fn motion(args: &SolveArgs, scene: &Scene, settings: &Settings) -> Result<Answer, Failure> {
    let in_file = args.scene.failure();
    let problem = scene.problem(settings).map_err(in_file)?;
    let mut work = ModelWorkspace::default();
    let solution = problem.solve(&mut work);
    let wants_band = args.show.contains(&Show::Band) || args.show.is_empty() && !args.out.json;
    let band = match (&problem, solution.solved()) {
        (Problem::Lubricated(case), Some(solved)) if wants_band => case.band(solved, &mut work),
        _ => None,
    };
    let (mut notes, mut sensitivities) = (Vec::new(), None);
    let parts = torque_parts(scene, settings).unwrap_or_else(|why| {
        notes.push(format!("no torque of the whole screw: {why}"));
        None
    });
    if args.show.contains(&Show::Sensitivities) && solution.status() == Status::Converged {
        let inputs = Sensitivities::of(scene, settings).map_err(in_file)?;
        match inputs.solve(&mut work) {
            Ok((_, rows)) => sensitivities = Some(rows),
            Err(none) => {
                let failed = Record::new(Solution::new(solution.model, Err(none)));
                notes.push(format!("no sensitivities: {}", failed.message().unwrap_or_default()));
            }
        }
    }
    let lacks = args.show.contains(&Show::Sensitivities) && sensitivities.is_none();
    let answer = point(args, scene, settings, solution, &Beside { band, parts, sensitivities })?;
    notes.extend(answer.notes);
    Ok(Answer { notes, failed: answer.failed || lacks, ..answer })
}

/// A solution, or why there is none.
fn point(
    args: &SolveArgs,
    scene: &Scene,
    settings: &Settings,
    solution: Solution,
    Beside { band, parts, sensitivities }: &Beside,
) -> Result<Answer, Failure> {
    let record = Record::new(solution);
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model refuses the input");
        return Err(Failure::in_scene(args.scene.path(), text));
    }
    let mut json = record.report(PROGRAM, scene, settings, band.as_ref(), parts.as_ref());
    if let Some(rows) = sensitivities {
        let entry = |row: &Sensitivity| (row.input.name.to_owned(), row.to_json());
        let rows: Map<_, _> = rows.iter().map(entry).collect();
        json.insert("sensitivities".to_owned(), Value::Object(rows));
    }
    let blocks = [
        parts.as_ref().map(table::torque_parts),
        Some(table::record(scene, &record)),
        band.as_ref().map(table::band),
        sensitivities.as_deref().map(table::sensitivities),
    ];
    Ok(Answer {
        warnings: scene.warnings().into_iter().chain(record.warnings(scene)).collect(),
        notes: record.notes(),
        text: blocks.into_iter().flatten().collect::<Vec<_>>().join("\n\n"),
        json: Value::Object(json),
        failed: record.status() != Status::Converged,
        ..Answer::default()
    })
}

/// Slip or jamming of the solved motion, and its sweeps.
fn analysis(
    args: &SolveArgs,
    is_slip: bool,
    scene: &Scene,
    settings: &Settings,
    figures: Option<&mut Vec<Figure>>,
) -> Result<Answer, Failure> {
    let in_file = args.scene.failure();
    let Moving { settings, solution } =
        Moving::of(scene, settings, &mut ModelWorkspace::default()).map_err(in_file)?;
    if solution.reason().is_some() {
        return point(args, scene, &settings, solution, &Beside::default());
    }
    let (report, study): (_, fn(&_, &_, &_) -> _) = if is_slip {
        (Analysis::slip(scene, &settings, &solution), Study::slip)
    } else {
        (Analysis::jam(scene, &solution), Study::jam)
    };
    let report = report.map_err(in_file)?;
    if let Some(figures) = figures {
        figures.extend(study(scene, &settings, &solution)?.figures);
    }
    Ok(Answer {
        text: table::analysis(&report),
        json: Value::Object(report.to_json()),
        warnings: report.warnings,
        ..Answer::default()
    })
}

/// The best contact angle and self-locking limits.
fn optimum(
    args: &SolveArgs,
    scene: &Scene,
    settings: &Settings,
    figures: Option<&mut Vec<Figure>>,
) -> Result<Answer, Failure> {
    let model = match settings.model {
        ModelChoice::Auto => None,
        ModelChoice::Fixed(model) => Some(model),
    };
    let report = OptimumReport::of(scene, model).map_err(args.scene.failure())?;
    if let Some(figures) = figures {
        figures.extend(bsm_report::sheets::lin_figures(scene)?);
    }
    let row = |(label, unit, values): (&str, &str, [Option<f64>; 2])| {
        let cells = values.map(|v| v.map_or_else(|| "none".to_owned(), number));
        [vec![label.to_owned(), unit.to_owned()], cells.to_vec()].concat()
    };
    let rows: Vec<_> = report.rows().into_iter().map(row).collect();
    let header = ["closed form", "", "rotary to linear", "linear to rotary"];
    Ok(Answer {
        text: table::plain(Some(&header), &rows, 2),
        json: report.to_json(),
        warnings: report.warnings(),
        ..Answer::default()
    })
}

/// Load ratings of the nut.
fn ratings(args: &SolveArgs, scene: &Scene) -> Result<Answer, Failure> {
    let report = CapacityReport::of(scene, None).map_err(args.scene.failure())?;
    let mut rows = report.rows();
    if args.show.contains(&Show::Steps) {
        rows.extend(report.steps());
    }
    let row = |(name, unit, value): &(&str, &str, f64)| {
        vec![(*name).to_owned(), (*unit).to_owned(), number(*value)]
    };
    Ok(Answer {
        text: table::plain(None, &rows.iter().map(row).collect::<Vec<_>>(), 2),
        json: report.to_json(),
        warnings: report.warnings().to_vec(),
        rows: named(rows),
        about: scene.to_json(),
        ..Answer::default()
    })
}

/// Columns of the models side by side: label, output.
const COLUMNS: &[(&str, &str)] = &[
    ("efficiency", "efficiency"),
    ("torque N m", "screw_torque_Nm"),
    ("Q nut N", "nut_normal_load_N"),
    ("Q screw N", "screw_normal_load_N"),
    ("angle nut deg", "nut_contact_angle_deg"),
    ("angle screw deg", "screw_contact_angle_deg"),
];

/// Every model that the scene has the inputs of.
fn models(scene: &Scene) -> Result<Answer, CaseError> {
    let compared = Comparison::of(scene)?;
    let Comparison { answers, left_out, .. } = &compared;
    let labels = COLUMNS.iter().map(|(label, _)| *label);
    let header: Vec<_> =
        std::iter::once("model").chain(labels).chain(["time us", "status"]).collect();
    let row = |Compared { record, time }: &Compared| {
        let cell =
            |(_, name): &(&str, &str)| record.number(name).map_or_else(|| "-".to_owned(), number);
        std::iter::once(record.model().name().to_owned())
            .chain(COLUMNS.iter().map(cell))
            .chain([format!("{time:.2}"), record.status_name().to_owned()])
            .collect()
    };
    let rows: Vec<_> = answers.iter().map(row).collect();
    let regime = compared.regime().map(|regime| format!("regime  {regime}"));
    let mut blocks: Vec<_> = regime.into_iter().collect();
    blocks.push(table::plain(Some(&header), &rows, 1));
    let reasons: Vec<_> = answers
        .iter()
        .filter_map(|a| Some(format!("{}: {}", a.record.model().name(), a.record.message()?)))
        .chain(left_out.iter().map(|why| format!("not compared: {why}")))
        .collect();
    if !reasons.is_empty() {
        blocks.push(reasons.join("\n"));
    }
    Ok(Answer {
        text: blocks.join("\n\n"),
        json: compared.to_json(),
        failed: !compared.is_solved(),
        warnings: compared.warnings,
        ..Answer::default()
    })
}
