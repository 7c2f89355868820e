//! Analyses of a scene or of a solved motion: their numbers, and what they are made from.

use bsm_dyn::{Model, ModelWorkspace, Solution, SteadyBall, Touch};
use bsm_kin::Site;
use serde_json::{Map, Value, json};

use crate::problem::Needs;
use crate::quantity::Statement;
use crate::record::message;
use crate::{
    CapacityReport, CaseError, InputSet, ModelChoice, Numbers, NutProblem, Of, OptimumReport,
    Output, Quantity, Record, Scene, Settings, SizeReport, capacity, jam, nut, optimum, size, slip,
};

/// The contacts of a ball.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutMinor];

/// An analysis, whose numbers may be columns of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnalysisKind {
    /// Slip of the balls, `bsm slip`.
    Slip,
    /// Jamming of the balls, `bsm jam`.
    Jam,
    /// Optimum contact angles and self-locking limits, `bsm optimum`.
    Optimum,
    /// Ratings, rigidity and thread of a nut, `bsm capacity`.
    Capacity,
    /// All balls of a nut, `bsm nut`.
    Nut,
    /// The axis around a screw, `bsm size`.
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
    pub(crate) fn missing(self, given: InputSet) -> Vec<String> {
        match self {
            Self::Slip | Self::Jam => Needs::of(Model::Rigid).missing(given),
            Self::Optimum => optimum::NEEDS.missing(given),
            Self::Capacity => capacity::NEEDS.missing(given),
            Self::Nut => Needs::NUT.missing(given),
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
    /// Why that model, if it was chosen by the bound of its error.
    pub choice: Option<String>,
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
            choice: record.choice(),
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
        map.insert("choice".to_owned(), json!(self.choice));
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

/// A solution that has a motion of the ball, unless there is none.
#[derive(Debug, Clone)]
pub struct Moving {
    /// What it was found with.
    pub settings: Settings,
    /// The solution.
    pub solution: Solution,
    /// Why it is not the one that was asked for.
    pub note: Option<String>,
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
        let ball = Self::read(scene, solution)?;
        if scene.given().is_lubricated() {
            return Err(CaseError::NoLubricant { model: "of slip and jam" });
        }
        Ok(ball)
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
    /// What was found; where `auto` has taken a model without a motion, the solution of the cheapest
    /// model that has one, and that this is so in words.
    ///
    /// # Errors
    ///
    /// As [`Scene::problem`].
    pub fn of(
        scene: &Scene,
        settings: &Settings,
        found: Solution,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let next = Model::RacewayControl;
        let lacks = found.solved().is_some_and(|solved| solved.ball.motion.is_none());
        if !lacks || settings.model != ModelChoice::Auto || !scene.suits(next) {
            return Ok(Self { settings: *settings, solution: found, note: None });
        }
        let note = format!(
            "auto takes model {}, which is accurate enough but has no motion of the ball; this \
             analysis uses {}",
            found.model.name(),
            next.name()
        );
        let settings = Settings { model: next.into(), ..*settings };
        let solution = scene.problem(&settings)?.solve(work);
        Ok(Self { settings, solution, note: Some(note) })
    }
}
