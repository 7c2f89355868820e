//! From a scene to the SI problem of a model.

use std::num::NonZeroUsize;

use bsm_dyn::{
    Angles, Auto, Ball, ClosedForm, Control, Direction, Driven, Elastic, ElasticScrew, Load,
    Material, Model, Problem, QuasiStatic, RacewayControl, Rigid, Traction, Transmission,
};
use bsm_kin::{Drive, Helix};

use crate::units::{DEG, GPA, MM, RPM};
use crate::{CaseError, InputKey, Scene};

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
        let model = match self.choose(settings.model)? {
            ModelChoice::Auto => {
                let (screw, tolerance) = (self.elastic_screw(), settings.tolerance);
                return Ok(Problem::Auto(Auto { screw, tolerance }));
            }
            ModelChoice::Fixed(model) => model,
        };
        Ok(match model {
            Model::ClosedForm => Problem::ClosedForm(ClosedForm {
                angles: self.angles(),
                friction: self.value(InputKey::friction_coefficient),
                direction: self.direction(),
                transmission: self.transmission(),
            }),
            Model::QuasiStatic => Problem::QuasiStatic(self.quasi_static()),
            Model::Rigid => Problem::Rigid(self.rigid()),
            Model::RacewayControl => Problem::RacewayControl(RacewayControl {
                screw: self.elastic_screw(),
                control: settings.control,
            }),
            Model::Elastic => Problem::Elastic(Elastic { screw: self.elastic_screw() }),
            Model::Traction => Problem::Traction(Traction {
                screw: self.elastic_screw(),
                order: settings.quadrature,
                creep: settings.creep,
            }),
        })
    }

    /// A given or default value; the caller has asked [`choose`](Self::choose) before.
    fn value(&self, key: InputKey) -> f64 {
        self.value_or_default(key).expect("required inputs were checked")
    }

    fn angles(&self) -> Angles<f64> {
        Angles {
            lead: self.lead_angle().expect("required inputs were checked"),
            contact: self.value(InputKey::contact_angle_deg) * DEG,
        }
    }

    fn drive(&self) -> Option<Drive<f64>> {
        let (screw, nut) = self.speeds_rpm()?;
        Some(Drive { screw_speed: screw * RPM, nut_speed: nut * RPM })
    }

    /// Rotary to linear unless the speeds say otherwise.
    fn direction(&self) -> Direction {
        self.drive()
            .and_then(|drive| Direction::of(drive.relative_speed()))
            .unwrap_or(Direction::RotaryToLinear)
    }

    fn load(&self) -> Option<Load> {
        Some(Load { axial: self.axial_load_N?, balls: self.loaded_balls? })
    }

    fn transmission(&self) -> Option<Transmission> {
        Some(Transmission {
            pitch_radius: 0.5 * MM * self.pitch_circle_diameter_mm?,
            load: self.load()?,
            relative_speed: self.drive().map(|drive| drive.relative_speed()),
        })
    }

    fn quasi_static(&self) -> QuasiStatic {
        let ball = self.value(InputKey::ball_diameter_mm);
        let driven = match self.speeds_rpm() {
            Some((screw, nut)) if screw == 0.0 && nut != 0.0 => Driven::Nut,
            Some((_, nut)) if nut != 0.0 => Driven::Both,
            _ => Driven::Screw,
        };
        QuasiStatic {
            angles: self.angles(),
            friction: self.value(InputKey::friction_coefficient),
            size_ratio: ball / self.value(InputKey::pitch_circle_diameter_mm),
            rolling_ratio: self.value(InputKey::rolling_friction_mm) / (0.5 * ball),
            driven,
            direction: self.direction(),
            transmission: self.transmission(),
        }
    }

    /// Elastic constants of races and balls.
    pub(crate) fn materials(&self) -> (Material, Material) {
        let races = Material {
            youngs_modulus: self.value(InputKey::youngs_modulus_GPa) * GPA,
            poisson_ratio: self.value(InputKey::poisson_ratio),
        };
        let balls = Material {
            youngs_modulus: self.ball_youngs_modulus_GPa.map_or(races.youngs_modulus, |e| e * GPA),
            poisson_ratio: self.ball_poisson_ratio.unwrap_or(races.poisson_ratio),
        };
        (races, balls)
    }

    /// The screw of the elastic models; the caller has asked [`choose`](Self::choose) before.
    pub(crate) fn elastic_screw(&self) -> ElasticScrew {
        let Rigid { helix, contact_angle, ball, friction, drive, load } = self.rigid();
        ElasticScrew {
            helix,
            contact_angle,
            ball,
            conformity: (
                self.value(InputKey::nut_conformity),
                self.value(InputKey::screw_conformity),
            ),
            material: self.materials(),
            friction,
            drive,
            load,
        }
    }

    /// The inputs that every model with a motion of the ball shares; as
    /// [`elastic_screw`](Self::elastic_screw).
    pub(crate) fn rigid(&self) -> Rigid {
        let angles = self.angles();
        let radius = 0.5 * MM * self.value(InputKey::ball_diameter_mm);
        Rigid {
            helix: Helix {
                radius: 0.5 * MM * self.value(InputKey::pitch_circle_diameter_mm),
                lead_angle: angles.lead,
            },
            contact_angle: angles.contact,
            ball: Ball::of_density(radius, self.value(InputKey::density_kg_m3)),
            friction: self.value(InputKey::friction_coefficient),
            drive: self.drive().expect("required inputs were checked"),
            load: self.load().expect("required inputs were checked"),
        }
    }
}
