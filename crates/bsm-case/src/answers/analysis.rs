//! Analyses of a scene or of a solved motion: their numbers, and what they are made from.

use bsm_dyn::{ContactSite, Control, Model, ModelWorkspace, Solution, SteadyBall};
use bsm_kin::Site;
use serde_json::json;

use super::record::message;
use super::{axis, jam, nut, optimum, ratings, slip, warm};
use crate::case::problem::Needs;
use crate::case::rated_nut;
use crate::vocabulary::error::list;
use crate::vocabulary::units::DEG;
use crate::{
    AnalysisKind, Answer, CaseError, Column, Content, InputKey, InputSet, ModelChoice, Numbers,
    NutProblem, OUTPUTS, Of, Output, Quantity, Record, Scene, Settings, Table, nearest,
};

/// The contacts of a ball.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutMinor];

impl AnalysisKind {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Slip, Self::Jam, Self::Optimum, Self::Ratings, Self::Nut, Self::Axis, Self::Warm];

    /// Names and quantities, in the order of [`ALL`](Self::ALL).
    const ROWS: [(&str, &[Quantity]); 7] = [
        ("slip", slip::QUANTITIES),
        ("jam", jam::QUANTITIES),
        ("optimum", optimum::QUANTITIES),
        ("ratings", ratings::QUANTITIES),
        ("nut", nut::QUANTITIES),
        ("axis", axis::QUANTITIES),
        ("warm", warm::QUANTITIES),
    ];

    /// The command of that analysis.
    pub fn name(self) -> &'static str {
        Self::ROWS[self as usize].0
    }

    /// Its quantities, in the order in which they are printed.
    pub fn quantities(self) -> &'static [Quantity] {
        Self::ROWS[self as usize].1
    }

    /// Its numbers as outputs.
    pub fn columns(self) -> impl Iterator<Item = &'static Output> {
        self.quantities().iter().flat_map(|quantity| quantity.columns)
    }

    /// True if it is of a ball in motion, false if it is of the inputs alone.
    pub fn needs_motion(self) -> bool {
        matches!(self, Self::Slip | Self::Jam)
    }

    /// Missing inputs, as text; single quantities may need more.
    ///
    /// * `base`: the scene that the points vary.
    pub(crate) fn missing(self, base: &Scene, given: InputSet) -> Vec<String> {
        let given = given.and(rated_nut::given(base));
        match self {
            Self::Slip | Self::Jam => Needs::of(Model::Rigid).missing(given),
            Self::Optimum => optimum::NEEDS.missing(given),
            Self::Ratings => rated_nut::NEEDS.missing(given),
            Self::Nut => base.missing_for_a_nut(given),
            Self::Axis if given.has_ratings_only() => Vec::new(),
            Self::Axis => axis::NEEDS.missing(given),
            Self::Warm => warm::missing(base, given),
        }
    }

    /// Its numbers at a scene.
    ///
    /// * `settings`: how it is solved where it solves itself. * `motion`: a solution with a motion of the ball, where the analysis [needs](Self::needs_motion)
    ///   one. * `wanted`: quantities that may be left out if they are not wanted.
    ///
    /// # Errors
    ///
    /// Quantities of the analysis.
    pub fn numbers(
        self,
        scene: &Scene,
        settings: &Settings,
        motion: Option<&MotionAnswer>,
        wanted: impl Fn(&Quantity) -> bool,
    ) -> Result<Numbers, CaseError> {
        match (self, motion) {
            (Self::Nut, _) => {
                let found = NutProblem::of(scene, settings)?.solve();
                found.map_err(CaseError::Nut).map(|report| report.numbers(wanted))
            }
            (Self::Axis, _) => axis::numbers(scene, settings, wanted),
            (Self::Warm, _) => warm::numbers(scene, settings, wanted),
            (Self::Optimum, _) => optimum::numbers(scene),
            (Self::Ratings, _) => ratings::numbers(scene),
            (Self::Slip, Some(MotionAnswer { settings, solution, .. })) => {
                slip::slip(scene, settings, solution).map(Answer::into_numbers)
            }
            (Self::Jam, Some(moving)) => {
                jam::jam(scene, &moving.solution).map(Answer::into_numbers)
            }
            (Self::Slip | Self::Jam, None) => Ok(Numbers::none(self.quantities())),
        }
    }
}

impl Output {
    /// True if a point must be solved for it.
    pub fn needs_solution(&self) -> bool {
        self.analysis().is_none_or(AnalysisKind::needs_motion)
    }

    /// Whether points that have the inputs `given` can have it.
    ///
    /// * `base`: the scene that the points vary; `model`: what they are solved with.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`], or [`CaseError::Invalid`] with the inputs that lack.
    pub fn check(
        &self,
        base: &Scene,
        given: InputSet,
        model: ModelChoice,
    ) -> Result<(), CaseError> {
        let Some(kind) = self.analysis() else { return Ok(()) };
        if kind == AnalysisKind::Jam && given.is_lubricated() {
            return Err(CaseError::oiled_jam(""));
        }
        let mut missing = kind.missing(base, given);
        if let (true, ModelChoice::Fixed(model @ (Model::ClosedForm | Model::QuasiStatic))) =
            (kind.needs_motion(), model)
        {
            return Err(CaseError::NoMotion { model: model.name(), missing });
        }
        let own = |quantity: &&Quantity| quantity.columns.iter().any(|c| c.name == self.name);
        let own = kind.quantities().iter().find(own);
        missing.extend(own.map(|quantity| quantity.missing(given)).unwrap_or_default());
        if missing.is_empty() {
            return Ok(());
        }
        let (name, required) = (self.name, list(&missing));
        Err(CaseError::Invalid(format!("column {name} would be empty: {required} required for it")))
    }

    /// The output of that name, of a solution or else of an analysis.
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::all().find(|output| output.name == name)
    }

    /// The name of an output that is nearest to `name`, if any is near.
    pub fn nearest(name: &str) -> Option<&'static str> {
        nearest(name, Self::all().map(|output| output.name))
    }

    /// All of [`OUTPUTS`], then the numbers of all analyses.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        OUTPUTS.iter().chain(AnalysisKind::ALL.into_iter().flat_map(AnalysisKind::columns))
    }
}

/// Result of an analysis of a solved motion.
///
/// * `verdicts`: names of its statements, as text. * `lacks`: parts that are left out besides those that lack inputs.
pub(crate) fn of_a_motion(
    kind: AnalysisKind,
    scene: &Scene,
    solution: &Solution,
    numbers: Numbers,
    verdicts: Vec<(&'static str, String)>,
    lacks: Vec<String>,
) -> Answer {
    let verdict = |(name, words): (&'static str, String)| {
        let holds = numbers.number(name).is_some_and(|number| number > 0.5);
        vec![json!(name), json!(holds), json!(words)]
    };
    let verdicts = Table {
        columns: vec![
            Column::headed("", "statement"),
            Column::headed("answer", ""),
            Column::headed("words", ""),
        ],
        rows: verdicts.into_iter().map(verdict).collect(),
        keyed: true,
    };
    let lacks = without(kind, scene.given()).into_iter().chain(lacks).collect();
    let record = Record::new(solution.clone());
    let warnings = scene.warnings().into_iter().chain(record.warnings(scene)).collect();
    let notes = scene.given().unused_by_models().collect();
    Answer { notes, warnings, ..Answer::default() }
        .with("model", Content::Words("model ", Some(solution.model.name().to_owned())))
        .with("", Content::numbers(numbers, "ball"))
        .with("verdicts", Content::Table(verdicts))
        .with("lacks", Content::Texts("left out", lacks))
}

/// Quantities omitted without contact ellipses.
pub(crate) fn lacks_ellipses(what: &str, model: Model) -> String {
    format!("{what}: a model with elastic contacts, which {} is not", model.name())
}

/// The quantities of a table by its name: that of an analysis, or `steps`, `as used`, `best`, `screw`, `phase` or `torques`.
pub fn table(name: &str) -> impl Iterator<Item = &'static Quantity> + use<> {
    let steps = ratings::STEPS;
    let (all, steps_alone): (&[Quantity], _) = match name {
        "best" => (optimum::BY_MODEL, None),
        "ratings" => (ratings::QUANTITIES, Some(false)),
        "steps" => (ratings::QUANTITIES, Some(true)),
        "as used" => (ratings::AS_USED, None),
        "screw" => (axis::SCREW, None),
        "phase" => (axis::PHASE, None),
        "torques" => (axis::TORQUES, None),
        _ => {
            let kind = AnalysisKind::ALL.into_iter().find(|kind| kind.name() == name);
            (kind.map_or(&[], AnalysisKind::quantities), None)
        }
    };
    all.iter()
        .filter(move |quantity| steps_alone.is_none_or(|alone| alone == (quantity.title == steps)))
}

/// The quantities that lack inputs of their own, together with those that lack the same.
fn without(kind: AnalysisKind, given: InputSet) -> Vec<String> {
    let mut lacks: Vec<(String, Vec<&str>)> = Vec::new();
    for quantity in kind.quantities().iter().filter(|quantity| quantity.of != Of::Statement) {
        let missing = quantity.missing(given);
        if missing.is_empty() {
            continue;
        }
        let missing = missing.join(" and ");
        match lacks.iter_mut().find(|(known, _)| *known == missing) {
            Some((_, abouts)) => abouts.push(quantity.about),
            None => lacks.push((missing, vec![quantity.about])),
        }
    }
    let words =
        |(missing, abouts): (String, Vec<&str>)| format!("{}: {missing}", abouts.join(", "));
    lacks.into_iter().map(words).collect()
}

/// A solution for an analysis of the motion of the ball.
#[derive(Debug, Clone)]
pub struct MotionAnswer {
    /// Model and settings of the result.
    pub settings: Settings,
    /// The solution.
    pub solution: Solution,
}

/// A contact of a ball in motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingContact {
    pub(crate) touch: ContactSite<f64>,
    /// Normal load \[N\].
    pub(crate) load: f64,
    /// Slip angle \[rad\].
    pub(crate) slip_angle: f64,
    /// Semi-axes of the contact ellipse \[m\], if the model has them.
    pub(crate) semi_axes: Option<(f64, f64)>,
}

/// Solution of a model that the analyses read: a ball of known motion and loads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingBall {
    pub(crate) ball: SteadyBall<f64>,
    /// At [`SITES`].
    pub(crate) contacts: [Option<MovingContact>; 3],
}

impl MovingBall {
    /// The ball that rolls at the contact angles in motion that the scene gives, if it does, with the
    /// contact ellipses of the solution; and whether it is that one.
    ///
    /// # Errors
    ///
    /// [`CaseError::NotCovered`] if the model finds the angles itself.
    pub(crate) fn at_given_angles(
        mut self,
        scene: &Scene,
        settings: &Settings,
        model: Model,
    ) -> Result<(Self, bool), CaseError> {
        let Some(angles) = scene.running_angles() else { return Ok((self, false)) };
        if model != Model::RacewayControl {
            return Err(CaseError::NotCovered {
                key: InputKey::nut_running_contact_angle_deg.name(),
                value: angles[0] / DEG,
                rule: "left out",
                model: model.name(),
            });
        }
        let SteadyBall { helix, radius, drive, .. } = self.ball;
        let control = settings.control.unwrap_or(Control::Nut);
        self.ball = SteadyBall::rolling(control, helix, radius, drive, angles);
        for (contact, angle) in self.contacts.iter_mut().flatten().zip(angles) {
            contact.touch.angle = angle;
        }
        Ok((self, true))
    }

    /// Motion and contacts of a solution.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has none, [`CaseError::Invalid`] if there is no solution.
    pub(crate) fn of(scene: &Scene, solution: &Solution) -> Result<Self, CaseError> {
        let state = match &solution.answer {
            Ok(solved) => &solved.ball,
            Err(none) => return Err(CaseError::Invalid(message(none.reason()))),
        };
        let motion = state.motion.ok_or_else(|| CaseError::NoMotion {
            model: solution.model.name(),
            missing: scene.missing(Model::Rigid),
        })?;
        let case = scene.reader().operating_point();
        let ball =
            SteadyBall { helix: case.helix, radius: case.ball.radius, drive: case.drive, motion };
        let contacts = SITES.map(|site| {
            let contact = state.contact(site)?;
            Some(MovingContact {
                touch: ContactSite { site, angle: contact.angle },
                load: contact.load?,
                slip_angle: contact.slip_angle?,
                semi_axes: contact.pressed.map(|pressed| pressed.semi_axes),
            })
        });
        Ok(Self { ball, contacts })
    }

    /// A number of each contact.
    pub(crate) fn each(&self, number: impl Fn(&MovingContact) -> f64) -> [Option<f64>; 3] {
        self.contacts.map(|contact| contact.as_ref().map(&number))
    }
}

impl MotionAnswer {
    /// The solution of the model that the settings come to, see `ModelChoice::of_motion`.
    ///
    /// # Errors
    ///
    /// As [`Scene::problem`].
    pub fn of(
        scene: &Scene,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let settings = Settings { model: settings.model.of_motion(scene.stated()), ..*settings };
        let solution = scene.problem(&settings)?.solve(work);
        Ok(Self { settings, solution })
    }
}

impl Scene {
    /// Contact angles of nut and screw in motion, if they are given \[rad\].
    pub fn running_angles(&self) -> Option<[f64; 2]> {
        let angles = [self.nut_running_contact_angle_deg?, self.screw_running_contact_angle_deg?];
        Some(angles.map(|angle| angle * DEG))
    }
}
