//! Which model is asked, and whether a scene has what it needs.

use std::num::NonZeroUsize;

use bsm_dyn::{Control, Model, Problem, Traction};

use crate::{CaseError, Scene};

/// The model to solve with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModelChoice {
    /// The cheapest model whose error is below the tolerance; without the inputs that tell, the
    /// most complete model that the scene has inputs for.
    #[default]
    Auto,
    /// This one.
    Fixed(Model),
}

impl From<Model> for ModelChoice {
    fn from(model: Model) -> Self {
        Self::Fixed(model)
    }
}

impl ModelChoice {
    /// All names, `auto` first.
    pub fn names() -> impl Iterator<Item = &'static str> {
        std::iter::once(Self::Auto.name()).chain(Model::ALL.into_iter().map(Model::name))
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Fixed(model) => model.name(),
        }
    }

    /// The choice of that name.
    ///
    /// # Errors
    ///
    /// [`CaseError::UnknownModel`].
    pub fn from_name(name: &str) -> Result<Self, CaseError> {
        if name == Self::Auto.name() {
            return Ok(Self::Auto);
        }
        Model::from_name(name).map(Self::Fixed).ok_or_else(|| CaseError::UnknownModel {
            name: name.to_owned(),
            known: Self::names().collect::<Vec<_>>().join(", "),
        })
    }
}

/// How to solve: the model and its dials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The model.
    pub model: ModelChoice,
    /// Error of the efficiency that the choice `auto` may leave, positive.
    pub tolerance: f64,
    /// Order of the quadrature over the contact ellipses in model traction.
    pub quadrature: NonZeroUsize,
    /// Creep speed over `$r_b|W|$` in model traction, positive: it makes friction smooth.
    pub creep: f64,
    /// The controlling race in model raceway-control; `None` decides by the spin moments.
    pub control: Option<Control>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: ModelChoice::Auto,
            tolerance: 1e-2,
            quadrature: Traction::ORDER,
            creep: Traction::CREEP,
            control: None,
        }
    }
}

impl From<Model> for Settings {
    /// That model with its default dials.
    fn from(model: Model) -> Self {
        Self { model: model.into(), ..Self::default() }
    }
}

/// Stands for "lead_angle_deg, or lead_mm and the pitch circle".
const LEAD: &str = "lead_angle_deg (or lead_mm)";

/// Inputs without default, most basic first; each model needs a number of them.
const REQUIRED: [&str; 10] = [
    LEAD,
    "contact_angle_deg",
    "friction_coefficient",
    "ball_diameter_mm",
    "pitch_circle_diameter_mm",
    "screw_speed_rpm",
    "axial_load_N",
    "loaded_balls",
    "nut_conformity",
    "screw_conformity",
];

/// Inputs without default that a model needs, most basic first.
pub fn required_inputs(model: Model) -> &'static [&'static str] {
    match model {
        Model::ClosedForm => &REQUIRED[..3],
        Model::QuasiStatic => &REQUIRED[..5],
        Model::Rigid => &REQUIRED[..8],
        Model::RacewayControl | Model::Elastic | Model::Traction => &REQUIRED,
    }
}

impl Scene {
    /// Inputs that `model` needs and the scene has not.
    pub fn missing(&self, model: Model) -> Vec<String> {
        let mut missing: Vec<_> = required_inputs(model)
            .iter()
            .filter(|name| match **name {
                LEAD => self.lead_angle_deg.is_none() && self.lead_mm.is_none(),
                name => self.get(name).is_none(),
            })
            .map(|name| (*name).to_owned())
            .collect();
        let pitch = "pitch_circle_diameter_mm";
        let from_lead = self.lead_angle_deg.is_none() && self.lead_mm.is_some();
        if from_lead && self.get(pitch).is_none() && !missing.iter().any(|m| m == pitch) {
            missing.push(format!("{pitch} (to turn lead_mm into an angle)"));
        }
        missing
    }

    /// What `model` does not cover of a scene that has its inputs.
    fn not_covered(&self, model: Model) -> Option<CaseError> {
        let not_covered = |key, value, rule| {
            Some(CaseError::NotCovered { key, value, rule, model: model.name() })
        };
        match (model, self.friction_coefficient, self.speeds_rpm()) {
            (Model::Rigid | Model::Elastic | Model::Traction, Some(friction), _)
                if friction <= 0.0 =>
            {
                let rule = "> 0 (without friction nothing fixes the rotation of the ball)";
                not_covered("friction_coefficient", friction, rule)
            }
            (Model::QuasiStatic, _, Some((screw, nut))) if screw != 0.0 && nut != 0.0 => {
                not_covered("nut_speed_rpm", nut, "0 while the screw turns (no dual drive)")
            }
            _ => None,
        }
    }

    /// True if the scene has the inputs of `model` and the model covers them.
    pub fn suits(&self, model: Model) -> bool {
        self.missing(model).is_empty() && self.not_covered(model).is_none()
    }

    /// What a choice comes to: `auto` stays where the scene has the inputs of raceway control,
    /// which tell the error of a model, and is the most complete other model elsewhere.
    ///
    /// # Errors
    ///
    /// [`CaseError::Missing`] if not even the cheapest model has its inputs,
    /// [`CaseError::NotCovered`] if a fixed one does not cover them.
    pub fn choose(&self, choice: ModelChoice) -> Result<ModelChoice, CaseError> {
        let model = match choice {
            ModelChoice::Fixed(model) => model,
            ModelChoice::Auto if self.suits(Model::RacewayControl) => return Ok(choice),
            ModelChoice::Auto => Model::ALL
                .into_iter()
                .rev()
                .find(|model| self.suits(*model))
                .unwrap_or(Model::ClosedForm),
        };
        let missing = self.missing(model);
        if !missing.is_empty() {
            return Err(CaseError::Missing { missing, model: model.name() });
        }
        self.not_covered(model).map_or(Ok(ModelChoice::Fixed(model)), Err)
    }

    /// The SI problem of a model.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if a value breaks a rule or an input of the model is missing.
    pub fn problem(&self, settings: &Settings) -> Result<Problem, CaseError> {
        self.check()?;
        let model = self.choose(settings.model)?;
        Ok(self.reader().problem(model, settings))
    }
}
