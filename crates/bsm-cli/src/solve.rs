//! `bsm solve`: one operating point, and what follows from it.

use bsm_case::{
    Answer, Beside, Comparison, ModelChoice, Moving, Record, Scene, Sensitivities, Settings, jam,
    slip, torque_parts,
};
use bsm_dyn::{ModelWorkspace, Problem, Solution, Status};
use bsm_report::sheets::Study;
use bsm_report::{Figure, PROGRAM};

use crate::answer::{Drawn, Reply, named};
use crate::args::{ALL, Show, SolveArgs};
use crate::failure::Failure;

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
        let answer = Comparison::of(&scene).map_err(args.scene.failure())?.answer();
        return Reply::about(&scene, answer).give(&args.out, || Ok(Drawn::default()));
    }
    let settings = args.model.settings().map_err(args.scene.failure())?;
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
    let rows = match (&parts[..], has_rows) {
        ([(_, ratings)], true) => {
            named(ratings.entries().map(|(column, value)| (column.name, column.unit, value)))
        }
        _ => Vec::new(),
    };
    let reply =
        Reply { parts, rows, about: scene.to_json(), ..Reply::about(&scene, Answer::default()) };
    reply.give(&args.out, || Ok(Drawn { figures, page: None }))
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
    let mut answer =
        point(args, scene, settings, solution, &Beside { band, parts, sensitivities })?;
    answer.notes.splice(0..0, notes);
    answer.fails |= lacks;
    Ok(answer)
}

/// A solution, or the reason for none.
fn point(
    args: &SolveArgs,
    scene: &Scene,
    settings: &Settings,
    solution: Solution,
    beside: &Beside,
) -> Result<Answer, Failure> {
    let record = Record::new(solution);
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model refuses the input");
        return Err(Failure::in_scene(args.scene.path(), text));
    }
    Ok(record.answer(PROGRAM, scene, settings, beside))
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
        (slip(scene, &settings, &solution), Study::slip)
    } else {
        (jam(scene, &solution), Study::jam)
    };
    let answer = report.map_err(in_file)?;
    if let Some(figures) = figures {
        figures.extend(study(scene, &settings, &solution)?.figures);
    }
    Ok(answer)
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
    let answer = bsm_case::optimum(scene, model).map_err(args.scene.failure())?;
    if let Some(figures) = figures {
        figures.extend(bsm_report::sheets::lin_figures(scene)?);
    }
    Ok(answer)
}

/// Load ratings of the nut.
fn ratings(args: &SolveArgs, scene: &Scene) -> Result<Answer, Failure> {
    let answer = bsm_case::ratings(scene, None).map_err(args.scene.failure())?;
    Ok(if args.show.contains(&Show::Steps) { answer } else { answer.hiding("steps") })
}
