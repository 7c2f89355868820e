//! Analyses of a scene or of a solved motion: their numbers, and what they are made from.

use bsm_dyn::{Control, Model, ModelWorkspace, Solution, SteadyBall, Touch};
use bsm_kin::Site;
use serde_json::{Map, Value, json};

use crate::problem::Needs;
use crate::quantity::Statement;
use crate::record::message;
use crate::units::DEG;
use crate::{
    CapacityReport, CaseError, InputKey, InputSet, Numbers, NutProblem, Of, OptimumReport, Output,
    Quantity, Record, Scene, Settings, SizeReport, capacity, jam, nut, optimum, size, slip,
};

/// The contacts of a ball.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutMinor];

/// An analysis, whose numbers may be columns of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalysisKind {
    /// Slip of the balls.
    Slip,
    /// Jamming of the balls.
    Jam,
    /// Optimum contact angles and self-locking limits.
    Optimum,
    /// Ratings, rigidity and thread of a nut.
    Capacity,
    /// All balls of a nut, `bsm nut`.
    Nut,
    /// The axis around a screw.
    Size,
}

impl AnalysisKind {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Slip, Self::Jam, Self::Optimum, Self::Capacity, Self::Nut, Self::Size];

    /// The command of that analysis.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::Jam => "jam",
            Self::Optimum => "optimum",
            Self::Capacity => "capacity",
            Self::Nut => "nut",
            Self::Size => "size",
        }
    }

    /// Its quantities, in the order in which they are printed.
    pub fn quantities(self) -> &'static [Quantity] {
        match self {
            Self::Slip => slip::QUANTITIES,
            Self::Jam => jam::QUANTITIES,
            Self::Optimum => optimum::QUANTITIES,
            Self::Capacity => capacity::QUANTITIES,
            Self::Nut => nut::QUANTITIES,
            Self::Size => size::QUANTITIES,
        }
    }

    /// Its numbers as outputs.
    pub fn columns(self) -> impl Iterator<Item = &'static Output> {
        self.quantities().iter().flat_map(|quantity| quantity.columns)
    }

    /// True if it is of a ball in motion, false if it is of the inputs alone.
    pub fn needs_motion(self) -> bool {
        match self {
            Self::Slip | Self::Jam => true,
            Self::Optimum | Self::Capacity | Self::Nut | Self::Size => false,
        }
    }

    /// Inputs that it needs and that are not given, in words; single quantities may need more.
    ///
    /// * `base`: the scene that the points vary.
    pub(crate) fn missing(self, base: &Scene, given: InputSet) -> Vec<String> {
        match self {
            Self::Slip | Self::Jam => Needs::of(Model::Rigid).missing(given),
            Self::Optimum => optimum::NEEDS.missing(given),
            Self::Capacity => capacity::NEEDS.missing(given),
            Self::Nut => base.missing_for_a_nut(given),
            Self::Size => size::NEEDS.missing(given),
        }
    }

    /// Its numbers at a scene.
    ///
    /// * `settings`: how it is solved where it solves itself. * `motion`: a solution with a motion of the ball, where the analysis [needs](Self::needs_motion)
    ///   one. * `wanted`: quantities that may be left out if they are not wanted.
    ///
    /// # Errors
    ///
    /// Those of the analysis.
    pub fn numbers(
        self,
        scene: &Scene,
        settings: &Settings,
        motion: Option<&Moving>,
        wanted: impl Fn(&Quantity) -> bool,
    ) -> Result<Numbers, CaseError> {
        match (self, motion) {
            (Self::Nut, _) => {
                let found = NutProblem::of(scene, settings)?.solve();
                found.map_err(CaseError::Nut).map(|report| report.numbers(wanted))
            }
            (Self::Size, _) => SizeReport::of(scene, settings).map(|report| report.numbers),
            (Self::Optimum, _) => OptimumReport::of(scene, None).map(|report| report.numbers),
            (Self::Capacity, _) => CapacityReport::numbers(scene),
            (Self::Slip, Some(Moving { settings, solution, .. })) => {
                Analysis::slip(scene, settings, solution).map(|analysis| analysis.numbers)
            }
            (Self::Jam, Some(moving)) => {
                Analysis::jam(scene, &moving.solution).map(|analysis| analysis.numbers)
            }
            (Self::Slip | Self::Jam, None) => Ok(Numbers::new(self)),
        }
    }
}

/// What an analysis says of a solved motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// The model whose motion it is.
    pub model: Model,
    /// The numbers, and whether its statements hold.
    pub numbers: Numbers,
    /// The statements in words, by name.
    pub verdicts: Vec<(&'static str, String)>,
    /// Parts that were left out, and the inputs that they lack.
    pub lacks: Vec<String>,
    /// What an engineer should know before using the numbers.
    pub warnings: Vec<String>,
}

impl Analysis {
    /// An empty analysis of a solution.
    pub(crate) fn of(kind: AnalysisKind, scene: &Scene, solution: &Solution) -> Self {
        let record = Record::new(solution.clone());
        Self {
            model: solution.model,
            numbers: Numbers::new(kind),
            verdicts: Vec::new(),
            lacks: lacks(kind, scene.given()),
            warnings: scene.warnings().into_iter().chain(record.warnings(scene)).collect(),
        }
    }

    /// Takes a statement, and says it.
    pub(crate) fn state(&mut self, statement: Statement, holds: bool, words: String) {
        self.numbers.statement(statement, holds);
        self.verdicts.push((self.numbers.kind().quantities()[statement.0].key, words));
    }

    /// Says what is left out for want of contact ellipses, though their inputs may be given.
    pub(crate) fn lacks_ellipses(&mut self, what: &str) {
        let model = self.model.name();
        self.lacks.push(format!("{what}: a model with elastic contacts, which {model} is not"));
    }

    /// The analysis, if every number of it is one.
    ///
    /// # Errors
    ///
    /// [`CaseError::BeyondDouble`] with the first that is not.
    pub(crate) fn finite(self) -> Result<Self, CaseError> {
        Ok(Self { numbers: self.numbers.finite()?, ..self })
    }

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.number(name)
    }

    /// The statements: name, whether it holds, words.
    pub fn statements(&self) -> impl Iterator<Item = (&'static str, bool, &str)> {
        let holds = |name| self.number(name).is_some_and(|number| number > 0.5);
        self.verdicts.iter().map(move |(name, words)| (*name, holds(name), words.as_str()))
    }

    /// JSON object of model, numbers, verdicts and words.
    pub fn to_json(&self) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("model".to_owned(), json!(self.model.name()));
        let numbers = self.numbers.entries().filter(|(column, _)| column.json_type == "number");
        map.extend(numbers.map(|(column, value)| (column.name.to_owned(), json!(value))));
        let verdict = |(name, answer, words): (&str, bool, &str)| {
            (name.to_owned(), json!({ "answer": answer, "words": words }))
        };
        map.insert("verdicts".to_owned(), Value::Object(self.statements().map(verdict).collect()));
        map.insert("lacks".to_owned(), json!(self.lacks));
        map.insert("warnings".to_owned(), json!(self.warnings));
        map
    }
}

/// The quantities that lack inputs of their own, together with those that lack the same.
fn lacks(kind: AnalysisKind, given: InputSet) -> Vec<String> {
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
pub struct Moving {
    /// What it was found with.
    pub settings: Settings,
    /// The solution.
    pub solution: Solution,
}

/// A contact of a ball in motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingContact {
    pub(crate) touch: Touch<f64>,
    /// Normal load \[N\].
    pub(crate) load: f64,
    /// Slip angle \[rad\].
    pub(crate) slip_angle: f64,
    /// Semi-axes of the contact ellipse \[m\], if the model has them.
    pub(crate) semi_axes: Option<(f64, f64)>,
}

/// What the analyses take from a model: a ball whose motion and loads are known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingBall {
    pub(crate) ball: SteadyBall<f64>,
    /// At [`SITES`].
    pub(crate) contacts: [Option<MovingContact>; 3],
}

impl MovingBall {
    /// Motion and contacts of a solution.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoMotion`] if the model has none, [`CaseError::NotRated`] if there is no solution.
    pub(crate) fn of(scene: &Scene, solution: &Solution) -> Result<Self, CaseError> {
        if scene.given().is_lubricated() {
            return Err(CaseError::DryAnalysis);
        }
        Self::read(scene, solution)
    }

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

    /// The same, of a ball whose friction may come from a lubricant.
    pub(crate) fn read(scene: &Scene, solution: &Solution) -> Result<Self, CaseError> {
        let state = match &solution.answer {
            Ok(solved) => &solved.ball,
            Err(none) => return Err(CaseError::NotRated(message(none.reason()))),
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
                touch: Touch { site, angle: contact.angle },
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

impl Moving {
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
