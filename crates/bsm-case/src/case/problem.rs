//! Choice of the model that solves a case, and the inputs that each model requires.

use std::f64::consts::FRAC_PI_2;

use bsm_dyn::{
    Control, Model, Problem,
    model::{RacewayFriction, Traction},
};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use crate::case::reader::has_grooves;
use crate::vocabulary::error::{invalid_input, list};
use crate::vocabulary::input_set::{Form, LEAD, QuantityForms, TEMPERATURE, VISCOSITY, inputs};
use crate::vocabulary::rules::{covered, not_covered};
use crate::vocabulary::units::UM;
use crate::{Case, CaseError, InputKey, InputSet, Rule};

/// The model that solves a case, chosen by the user or automatically.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModelChoice {
    /// The program chooses the fastest model whose error is below the tolerance. If inputs for the
    /// error estimate are missing, it chooses the most complete model for which the case has the
    /// inputs.
    #[default]
    Auto,
    /// The user chooses this model.
    Fixed(Model),
}

impl From<Model> for ModelChoice {
    fn from(model: Model) -> Self {
        Self::Fixed(model)
    }
}

impl ModelChoice {
    /// Returns the names of all choices, with `auto` first.
    pub fn names() -> impl Iterator<Item = &'static str> {
        std::iter::once(Self::Auto.name()).chain(Model::ALL.into_iter().map(Model::name))
    }

    /// Returns the name of the model, or `auto`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Fixed(model) => model.name(),
        }
    }

    /// Returns the choice with the given name.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] for an unknown name.
    pub fn from_name(name: &str) -> Result<Self, CaseError> {
        if name == Self::Auto.name() {
            return Ok(Self::Auto);
        }
        Model::from_name(name).map(Self::Fixed).ok_or_else(|| {
            CaseError::unknown_word("model", "model", name, &Self::names().collect::<Vec<_>>())
        })
    }
}

/// Choice of the model, and settings of the solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Model that solves the case.
    pub model: ModelChoice,
    /// Largest error of the efficiency that `auto` may accept (see [`Self::TOLERANCE`]).
    pub tolerance: f64,
    /// Relative accuracy of the friction in the `traction` model, which is determined by the
    /// quadrature over the contact ellipses (see [`Self::ACCURACY`]).
    pub accuracy: f64,
    /// Creep speed that smooths the friction law in the `traction` model, divided by `$r_b|W|$`
    /// (see [`Self::CREEP`]).
    pub creep: f64,
    /// Controlling raceway in the `raceway-control` model. If it is `None`, the spin moments
    /// determine the controlling raceway.
    pub control: Option<Control>,
    /// Location at which model `raceway-control` calculates lubricated friction.
    pub friction: RacewayFriction,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: ModelChoice::Auto,
            tolerance: 1e-2,
            accuracy: Traction::ACCURACY,
            creep: Traction::CREEP,
            control: None,
            friction: RacewayFriction::Local,
        }
    }
}

impl From<Model> for Settings {
    /// Returns settings that select this model. All other settings have their default values.
    fn from(model: Model) -> Self {
        Self { model: model.into(), ..Self::default() }
    }
}

/// Settings in JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct SettingsJson {
    /// Name of the model.
    name: &'static str,
    /// Largest error of the efficiency that `auto` accepts.
    tolerance: f64,
    /// Relative accuracy of the friction in the `traction` model.
    accuracy: f64,
    /// Creep speed that smooths the friction law in the `traction` model, divided by the speed of
    /// the ball.
    creep: f64,
    /// Controlling raceway in the `raceway-control` model.
    control: Option<&'static str>,
    /// Location at which model `raceway-control` calculates lubricated friction.
    friction: &'static str,
}

impl Settings {
    /// Keys of the settings in a JSON object.
    const KEYS: [&str; 6] = ["name", "tolerance", "accuracy", "creep", "control", "friction"];
    /// Permitted range of [`tolerance`](Self::tolerance).
    pub const TOLERANCE: Rule = Rule::Above(0.0);
    /// Permitted range of [`accuracy`](Self::accuracy). The lower limit is the rounding error, and
    /// the upper limit is the coarsest accuracy for which the error bound is valid.
    pub const ACCURACY: Rule = Rule::Within(1e-13, 1e-4);
    /// Permitted range of [`creep`](Self::creep).
    pub const CREEP: Rule = Rule::Above(0.0);

    /// Returns settings with the given model, controlling raceway and friction location, which are
    /// specified by name. All other settings have their default values.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] for an unknown name.
    pub fn named(
        model: &str,
        control: Option<&str>,
        friction: Option<&str>,
    ) -> Result<Self, CaseError> {
        let raceway = |name: &str| {
            let unknown = || {
                CaseError::unknown_word(
                    "control",
                    "raceway",
                    name,
                    &Control::ALL.map(Control::name),
                )
            };
            Control::from_name(name).ok_or_else(unknown)
        };
        let control = control.map(raceway).transpose()?;
        let place = |name: &str| {
            let known = RacewayFriction::ALL.map(RacewayFriction::name);
            let unknown = || CaseError::unknown_word("friction", "friction", name, &known);
            RacewayFriction::from_name(name).ok_or_else(unknown)
        };
        let friction = friction.map_or(Ok(RacewayFriction::default()), place)?;
        Ok(Self { model: ModelChoice::from_name(model)?, control, friction, ..Self::default() })
    }

    /// Reads settings in the form of [`to_json`](Self::to_json). Null and missing members take
    /// their defaults.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] for a wrong name or type, and [`CaseError::OutOfRange`] for a
    /// value out of range.
    pub fn from_json(given: &Value) -> Result<Self, CaseError> {
        if !given.is_object() && !given.is_null() {
            return Err(invalid_input("settings", "must be an object"));
        }
        let mut keys = given.as_object().into_iter().flatten().map(|(key, _)| key);
        if let Some(key) = keys.find(|key| !Self::KEYS.contains(&key.as_str())) {
            let known = Self::KEYS.join(", ");
            return Err(invalid_input(key, format!("is not a setting; the settings are {known}")));
        }
        let wrong = |name: &str, kind| invalid_input(name, format!("must be a {kind}"));
        let text = |name: &str| match &given[name] {
            Value::Null => Ok(None),
            Value::String(text) => Ok(Some(text.as_str())),
            _ => Err(wrong(name, "text")),
        };
        let named =
            Self::named(text("name")?.unwrap_or("auto"), text("control")?, text("friction")?)?;
        let number = |name: &str, usual: f64| match &given[name] {
            Value::Null => Ok(usual),
            value => value.as_f64().ok_or_else(|| wrong(name, "number")),
        };
        let settings = Self {
            tolerance: number("tolerance", named.tolerance)?,
            accuracy: number("accuracy", named.accuracy)?,
            creep: number("creep", named.creep)?,
            ..named
        };
        settings.check()?;
        Ok(settings)
    }

    /// Converts the settings to a JSON object.
    pub fn to_json(&self) -> Value {
        json!(self.members())
    }

    /// Returns the settings as members of a JSON object.
    pub(crate) fn members(&self) -> SettingsJson {
        let Self { model, tolerance, accuracy, creep, control, friction } = *self;
        SettingsJson {
            name: model.name(),
            tolerance,
            accuracy,
            creep,
            control: control.map(Control::name),
            friction: friction.name(),
        }
    }

    /// Checks settings that a user has specified. Each setting that differs from its default must
    /// have an effect on the chosen model. `auto` accepts all settings, because it may choose any
    /// model.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Invalid`] with a list of the settings that the model uses, or
    /// [`CaseError::OutOfRange`] for a value out of range.
    pub fn checked(self) -> Result<Self, CaseError> {
        self.check()?;
        let usual = Self { model: self.model, ..Self::default() };
        let Self { accuracy, creep, control, friction, .. } = usual;
        let (others, used) = match self.model {
            ModelChoice::Auto => return Ok(self),
            ModelChoice::Fixed(Model::Traction) => {
                (Self { accuracy, creep, ..self }, "only the settings accuracy and creep")
            }
            ModelChoice::Fixed(Model::RacewayControl) => {
                (Self { control, friction, ..self }, "only the settings control and friction")
            }
            ModelChoice::Fixed(_) => (self, "no settings"),
        };
        let why = || CaseError::Invalid(format!("model {} uses {used}", self.model.name()));
        if others == usual { Ok(self) } else { Err(why()) }
    }

    /// Checks that the settings are in their permitted ranges.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::OutOfRange`] for a value out of range.
    pub fn check(&self) -> Result<(), CaseError> {
        Self::TOLERANCE.check("tolerance", self.tolerance)?;
        Self::ACCURACY.check("accuracy", self.accuracy)?;
        Self::CREEP.check("creep", self.creep)
    }
}

/// Inputs without a default that a model or an analysis requires.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Needs {
    /// Inputs that must all be given.
    pub(crate) all: InputSet,
    /// Quantities that must each be given in at least one form.
    pub(crate) quantities: &'static [QuantityForms],
}

impl Needs {
    /// Returns the inputs that a model requires for points with the inputs `given`.
    fn for_points(model: Model, given: InputSet) -> Self {
        if given.is_lubricated() && has_lubricant(model) {
            return Self::LUBRICATED;
        }
        Self::of(model)
    }

    /// Inputs that are required to define a lubricant.
    pub(crate) const LUBRICANT: Self =
        Self { all: inputs! {}, quantities: &[VISCOSITY, TEMPERATURE] };

    /// Inputs that a model requires if its friction is calculated from a lubricant.
    pub(crate) const LUBRICATED: Self = {
        let Self { all, .. } = Self::of(Model::Traction);
        let all = all.without(inputs! { friction_coefficient });
        Self { all, quantities: &[LEAD, VISCOSITY, TEMPERATURE] }
    };

    /// Returns the required inputs of a model for dry friction with a friction coefficient.
    pub(crate) const fn of(model: Model) -> Self {
        const FRICTION: InputSet = inputs! { contact_angle_deg friction_coefficient };
        const SIZES: InputSet = inputs! { ball_diameter_mm pitch_circle_diameter_mm };
        const MOTION: InputSet = inputs! { screw_speed_rpm axial_load_N loaded_balls };
        const GROOVES: InputSet = inputs! { nut_conformity screw_conformity };
        let all = match model {
            Model::ClosedForm => FRICTION,
            Model::QuasiStatic => FRICTION.union(SIZES),
            Model::Rigid => FRICTION.union(SIZES).union(MOTION),
            Model::RacewayControl | Model::Elastic | Model::Traction => {
                FRICTION.union(SIZES).union(MOTION).union(GROOVES)
            }
        };
        Self { all, quantities: &[LEAD] }
    }

    /// Required inputs of a nut, except for the inputs that define its balls and loads.
    pub(crate) const NUT: Self = {
        let all = inputs! {
            ball_diameter_mm pitch_circle_diameter_mm contact_angle_deg nut_conformity
            screw_conformity
        };
        Self { all, quantities: &[LEAD] }
    };

    /// Returns true if all required inputs are given.
    pub(crate) fn are_met(&self, given: InputSet) -> bool {
        let given = given.completed();
        let complete = |form: &Form| given.contains(form.key) && given.contains_all(form.with);
        given.contains_all(self.all) && self.quantities.iter().all(|q| q.forms.iter().any(complete))
    }

    /// Returns the missing inputs as text. The groove can be estimated from a catalog line. If this
    /// requires fewer additional inputs than the groove itself, the missing inputs of the catalog
    /// line are returned, and the inputs of the groove are named as an alternative.
    pub(crate) fn missing(&self, given: InputSet) -> Vec<String> {
        let given = given.completed();
        let of_groove = lacking(self.all, self.quantities.iter(), given);
        if given.contains_all(CATALOG_LINE) || !self.all.intersects(GROOVE) {
            return of_groove;
        }
        let is_angle =
            |quantity: &&QuantityForms| quantity.forms[0].key == InputKey::contact_angle_deg;
        let others = self.quantities.iter().filter(|quantity| !is_angle(quantity));
        // The estimated groove determines the pitch circle diameter, which is needed to calculate
        // the lead angle.
        let all = self.all.without(GROOVE).union(CATALOG_LINE);
        let mut of_line = lacking(all, others, given.union(GROOVE));
        if of_line.len() >= of_groove.len() {
            return of_groove;
        }
        let replaced: Vec<_> =
            of_groove.into_iter().filter(|name| !of_line.contains(name)).collect();
        let of_catalog = CATALOG_LINE.without(given).iter().last();
        let last =
            of_line.iter_mut().find(|name| of_catalog.is_some_and(|key| key.name() == **name));
        if let Some(last) = last {
            let groove =
                format!("{} inputs of the groove: {}", replaced.len(), replaced.join(", "));
            *last = format!("{last} (or {groove})");
        }
        of_line
    }
}

/// Returns missing inputs as text. If a quantity has several forms, the form with the fewest
/// missing inputs is named.
///
/// * `all`: inputs that must all be given.
/// * `quantities`: quantities that must each be given in one of their forms.
fn lacking<'a>(
    all: InputSet,
    quantities: impl Iterator<Item = &'a QuantityForms>,
    given: InputSet,
) -> Vec<String> {
    let mut missing = Vec::new();
    for QuantityForms { words, forms } in quantities {
        let begun = forms.iter().filter(|form| given.contains(form.key));
        // Inputs in `all` are reported separately below.
        let lacks = |form: &Form| form.with.without(given).without(all);
        match begun.min_by_key(|form| lacks(form).iter().count()) {
            None => missing.push((*words).to_owned()),
            Some(form) => {
                let besides = lacks(form);
                missing.extend(besides.iter().map(|key| format!("{} ({})", key.name(), form.to)));
            }
        }
    }
    missing.extend(all.without(given).iter().map(|key| key.name().to_owned()));
    missing
}

/// Inputs of a groove that can be estimated from a catalog line.
const GROOVE: InputSet = inputs! {
    ball_diameter_mm pitch_circle_diameter_mm contact_angle_deg nut_conformity screw_conformity
    loaded_balls loaded_balls_per_turn loaded_turns
};

/// Inputs of a catalog line, in addition to the lead.
const CATALOG_LINE: InputSet = inputs! { nominal_diameter_mm rated_dynamic_load_N };

/// Inputs that determine the force with which the balls are pressed against the grooves.
const PRESSED: InputSet = inputs! { axial_load_N preload_N preload_offset_um ball_oversize_um };

/// Inputs that describe the play of gothic arches. If one of them is given, friction can press a
/// ball against a far flank.
pub const PLAY: InputSet = inputs! { axial_play_um radial_gap_um };

/// Returns true if a model can calculate friction from a lubricant.
pub(crate) fn has_lubricant(model: Model) -> bool {
    matches!(model, Model::RacewayControl | Model::Traction)
}

impl ModelChoice {
    /// Chooses the model for points with the inputs `given`. If the model is fixed, it is returned
    /// unchanged.
    /// With a lubricant or with play, `auto` becomes `traction`. Otherwise, `auto` remains
    /// unchanged if the inputs of `raceway-control` are given, because the error of a model can
    /// then be estimated. If some of these inputs are missing, `auto` becomes the most complete
    /// model for which all inputs are given.
    ///
    /// * `covers`: function that checks whether the values of the inputs are within the valid range
    ///   of a model.
    ///
    /// # Errors
    /// Returns [`CaseError::Entry`] if the model with the fewest required inputs lacks an input.
    /// Returns [`CaseError::Invalid`] if friction is given twice or in a form that the model does
    /// not support. For a fixed model, returns the error of `covers`.
    pub fn resolve(
        self,
        given: InputSet,
        covers: impl Fn(Model) -> Result<(), CaseError>,
    ) -> Result<Self, CaseError> {
        given.check_friction()?;
        let suits = |model: &Model| {
            Needs::for_points(*model, given).are_met(given) && covers(*model).is_ok()
        };
        let model = match self {
            Self::Fixed(model) if given.is_lubricated() && !has_lubricant(model) => {
                return Err(CaseError::no_lubricant(model));
            }
            Self::Fixed(model) => model,
            Self::Auto if given.is_lubricated() => Model::Traction,
            // With play, friction determines which flanks are in contact, so the error of a faster
            // model is unknown.
            Self::Auto if given.intersects(PLAY) && suits(&Model::Traction) => Model::Traction,
            Self::Auto if suits(&Model::RacewayControl) => return Ok(self),
            Self::Auto => Model::ALL.into_iter().rev().find(suits).unwrap_or(Model::ClosedForm),
        };
        let needs = Needs::for_points(model, given);
        if !needs.are_met(given) {
            let by = match self {
                Self::Fixed(_) => format!("by model {}", model.name()),
                Self::Auto if given.is_lubricated() => {
                    format!("for friction from the lubricant (model {})", model.name())
                }
                Self::Auto => format!("even by the simplest model, {}", model.name()),
            };
            let purpose = given.purpose(&by);
            let mut missing = needs.missing(given);
            if self == Self::Auto {
                // Friction can also be specified by a lubricant, from which `auto` calculates the
                // friction.
                let dry = missing.iter_mut().filter(|name| *name == "friction_coefficient");
                dry.for_each(|name| name.push_str(" (or iso_vg and lubricant_temperature_C)"));
            }
            return Err(CaseError::missing(&missing, &purpose));
        }
        covers(model).map(|()| Self::Fixed(model))
    }
}

impl ModelChoice {
    /// Chooses the model for an analysis of the ball motion, for which no error bound exists.
    /// `auto` chooses the most complete model for which the inputs `given` are sufficient, so that
    /// all points of a table use the same model. If the running contact angles are given, `auto`
    /// chooses raceway control.
    #[must_use]
    pub fn for_motion(self, given: InputSet) -> Self {
        let suits = |model: &Model| Needs::for_points(*model, given).are_met(given);
        match self {
            Self::Fixed(_) => self,
            Self::Auto if given.intersects(InputSet::RUNNING_ANGLES) => {
                Model::RacewayControl.into()
            }
            Self::Auto => Model::ALL.into_iter().rev().find(suits).map_or(self, Self::Fixed),
        }
    }
}

impl Case {
    /// Returns the inputs that `model` requires and that are missing.
    pub fn missing(&self, model: Model) -> Vec<String> {
        Needs::for_points(model, self.stated()).missing(self.stated())
    }

    /// Returns a clause that ends a message and names the missing inputs of a model. The clause is
    /// empty if no input is missing.
    pub(crate) fn lacks(&self, model: Model) -> String {
        let missing = self.missing(model);
        if missing.is_empty() {
            return String::new();
        }
        format!("; {} required by model {}", list(&missing), model.name())
    }

    /// Returns the missing inputs that a nut requires, either for this case or for points with the
    /// inputs `given`.
    pub(crate) fn missing_for_a_nut(&self, given: InputSet) -> Vec<String> {
        use InputKey as K;
        let listed = self.entries.circuits.is_some();
        let by_gap = given.contains_all(inputs! { gap_deg circuits_count });
        let of_balls = [
            (K::loaded_balls_per_turn, given.contains(K::loaded_balls_per_turn)),
            (K::loaded_turns, given.contains(K::loaded_turns) || by_gap),
        ];
        let absent = of_balls.into_iter().filter(|(_, known)| !known && !listed);
        let absent: InputSet = absent.map(|(key, _)| key).collect();
        let needs = Needs { all: Needs::NUT.all.union(absent), ..Needs::NUT };
        let mut missing = needs.missing(given);
        for key in absent.iter() {
            for name in missing.iter_mut().filter(|name| **name == key.name()) {
                name.push_str(" (or circuits)");
            }
        }
        if listed && !given.intersects(PRESSED) {
            missing.push("axial_load_N (or preload_N)".to_owned());
        }
        missing
    }

    /// Returns true if a load or a preload is given.
    pub(crate) fn is_loaded(&self) -> bool {
        self.given().intersects(PRESSED)
    }

    /// Checks that the values of the case are within the range of `model`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::OutOfRange`] for a value outside the range of the model.
    pub fn covered_by(&self, model: Model) -> Result<(), CaseError> {
        match covered(model, self) {
            Some(false) => Err(not_covered(model, self)),
            _ => Ok(()),
        }
    }

    /// Returns true if the case has the inputs of `model`, and their values are within the range of
    /// this model.
    pub fn suits(&self, model: Model) -> bool {
        self.choose(model.into()).is_ok()
    }

    /// Chooses the model for the case (see [`ModelChoice::resolve`]).
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] if inputs are missing, and [`CaseError::OutOfRange`] for a
    /// value outside the range of the model.
    pub fn choose(&self, choice: ModelChoice) -> Result<ModelChoice, CaseError> {
        choice.resolve(self.stated(), |model| self.covered_by(model))
    }

    /// Checks the settings and the case, and chooses the model.
    pub(crate) fn check_and_choose(&self, settings: &Settings) -> Result<ModelChoice, CaseError> {
        settings.check()?;
        self.check()?;
        self.choose(settings.model)
    }

    /// Rejects a radial gap for which no contact angle exists. The gap is checked only for models
    /// in which the balls touch the grooves.
    fn check_radial_gap(&self, model: ModelChoice) -> Result<(), CaseError> {
        let has_grooves = !matches!(model, ModelChoice::Fixed(model) if !has_grooves(model));
        let Some(um) = self.radial_gap_um.filter(|_| has_grooves) else { return Ok(()) };
        let ball = self.reader().elastic_point().fitted(um * UM, 0.0);
        let angle = ball.point.contact_angle;
        if angle > 0.0 && angle < FRAC_PI_2 {
            return Ok(());
        }
        let rule = "such that balls touch the grooves at contact angles between 0 and 90 deg";
        Err(CaseError::out_of_range(InputKey::radial_gap_um.name(), um, rule))
    }

    /// Returns the problem of the model in SI units, in the warm steady state if the case requests
    /// it.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if a value or a setting violates a rule, if an input of the model is
    /// missing, or if there is no warm state.
    pub fn problem(&self, settings: &Settings) -> Result<Problem, CaseError> {
        if self.entries.preload_class.is_some() {
            return Err(invalid_input(
                "preload_class",
                "applies to `axis` and `nut`, but not to the single-ball models",
            ));
        }
        if self.requests_warm_state() {
            return self.in_warm_state(settings)?.problem(settings);
        }
        let model = self.check_and_choose(settings)?;
        self.check_radial_gap(model)?;
        Ok(self.reader().problem(model, settings))
    }
}
