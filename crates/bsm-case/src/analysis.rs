//! Analyses of a solved motion: their numbers, and what they are made from.

use bsm_dyn::{Model, Solution, SteadyBall, Touch};
use bsm_kin::Site;
use serde_json::{Map, Value, json};

use crate::record::message;
use crate::{CaseError, ModelChoice, Record, Scene, Settings};

/// The contacts of a line.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutMinor];

/// Their names in keys.
const PREFIXES: [&str; 3] = ["nut", "screw", "minor"];

/// The numbers of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Values {
    /// Of the ball, or of the screw.
    Whole(f64),
    /// At nut, screw and minor contact, where there is one.
    Contacts([Option<f64>; 3]),
}

/// A quantity of an analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Name with its unit as suffix; the contact stands in front of it.
    pub key: &'static str,
    /// Unit in words; empty if dimensionless.
    pub unit: &'static str,
    /// Meaning.
    pub about: &'static str,
    /// Its numbers.
    pub values: Values,
}

/// Lines that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// What they are about.
    pub title: &'static str,
    /// The lines.
    pub lines: Vec<Line>,
}

impl Block {
    pub(crate) fn new(title: &'static str) -> Self {
        Self { title, lines: Vec::new() }
    }

    pub(crate) fn whole(
        &mut self,
        key: &'static str,
        unit: &'static str,
        about: &'static str,
        value: f64,
    ) {
        self.lines.push(Line { key, unit, about, values: Values::Whole(value) });
    }

    /// Adds a line unless no contact has a number.
    pub(crate) fn contacts(
        &mut self,
        key: &'static str,
        unit: &'static str,
        about: &'static str,
        values: [Option<f64>; 3],
    ) {
        if values.iter().any(Option::is_some) {
            self.lines.push(Line { key, unit, about, values: Values::Contacts(values) });
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
    /// The numbers.
    pub blocks: Vec<Block>,
    /// Statements that follow from them: name, answer, words.
    pub verdicts: Vec<(&'static str, bool, String)>,
    /// Parts that were left out, and the inputs that they lack.
    pub lacks: Vec<String>,
    /// What an engineer should know before using the numbers.
    pub warnings: Vec<String>,
}

impl Analysis {
    /// An empty analysis of a solution.
    pub(crate) fn of(scene: &Scene, solution: &Solution) -> Self {
        let record = Record::new(solution.clone());
        Self {
            model: solution.model,
            choice: record.choice(),
            blocks: Vec::new(),
            verdicts: Vec::new(),
            lacks: Vec::new(),
            warnings: scene.warnings().into_iter().chain(record.warnings(scene)).collect(),
        }
    }

    /// The values by name, those of the contacts with the contact in front.
    fn entries(&self) -> impl Iterator<Item = (String, f64)> {
        let of_line = |line: &Line| match line.values {
            Values::Whole(value) => vec![(line.key.to_owned(), value)],
            Values::Contacts(values) => PREFIXES
                .iter()
                .zip(values)
                .filter_map(|(prefix, value)| Some((format!("{prefix}_{}", line.key), value?)))
                .collect(),
        };
        self.blocks.iter().flat_map(|block| &block.lines).flat_map(of_line)
    }

    /// The analysis, if every number of it is one.
    ///
    /// # Errors
    ///
    /// [`CaseError::BeyondDouble`] with the first that is not.
    pub(crate) fn finite(self) -> Result<Self, CaseError> {
        let endless = |line: &&Line| match line.values {
            Values::Whole(value) => !value.is_finite(),
            Values::Contacts(values) => values.iter().flatten().any(|value| !value.is_finite()),
        };
        match self.blocks.iter().flat_map(|block| &block.lines).find(endless) {
            Some(line) => Err(CaseError::BeyondDouble { output: line.key }),
            None => Ok(self),
        }
    }

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.entries().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// JSON object of model, numbers, verdicts and words.
    pub fn to_json(&self) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("model".to_owned(), json!(self.model.name()));
        map.insert("choice".to_owned(), json!(self.choice));
        map.extend(self.entries().map(|(key, value)| (key, json!(value))));
        let words = |(name, answer, words): &(&str, bool, String)| {
            let verdict = json!({ "answer": answer, "words": words });
            ((*name).to_owned(), verdict)
        };
        map.insert("verdicts".to_owned(), Value::Object(self.verdicts.iter().map(words).collect()));
        map.insert("lacks".to_owned(), json!(self.lacks));
        map.insert("warnings".to_owned(), json!(self.warnings));
        map
    }
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
        let state = match &solution.answer {
            Ok(solved) => &solved.ball,
            Err(none) => return Err(CaseError::NotRated(message(none.reason()))),
        };
        let motion = state.motion.ok_or_else(|| CaseError::NoMotion {
            model: solution.model.name(),
            missing: scene.missing(Model::Rigid),
        })?;
        let case = scene.reader().rigid();
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

impl Scene {
    /// What to ask for a motion where `auto` has found none: the cheapest model that has one, and
    /// that this is so in words.
    pub fn next_with_motion(
        &self,
        settings: &Settings,
        found: &Solution,
    ) -> Option<(Settings, String)> {
        let next = Model::RacewayControl;
        let lacks = found.solved().is_some_and(|solved| solved.ball.motion.is_none());
        let asked = settings.model == ModelChoice::Auto && self.suits(next);
        (lacks && asked).then(|| {
            let words = format!(
                "auto takes model {}, which is accurate enough but has no motion of the ball; \
                 this analysis uses {}",
                found.model.name(),
                next.name()
            );
            (Settings { model: next.into(), ..*settings }, words)
        })
    }
}
