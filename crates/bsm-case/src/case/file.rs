//! Reading, checking and changing case files.

use std::fs;
use std::path::Path;

use bsm_design::drive::{rod_inertia, rod_mass_per_length};
use bsm_dyn::lubrication::Temperature;
use serde_json::{Value, json};

use crate::case::nut::NUT_ONLY_INPUTS;
use crate::vocabulary::input_set::{LUBRICANT_INPUTS, inputs, lead_mm};
use crate::vocabulary::names::{GivenNames, json_or_text, wrong_type};
use crate::vocabulary::number::{format_short, format_trimmed};
use crate::vocabulary::rules::Relation;
use crate::vocabulary::units::MM;
use crate::{Case, CaseEntries, CaseError, InputKey, InputSet, entries};

/// Key under which a case file contains its description.
const DESCRIPTION: &str = "description";

impl Case {
    /// Reads and checks a case file.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the file cannot be read, is not a valid case, or violates a rule.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let bytes = fs::read(path)
            .map_err(|source| CaseError::Unreadable { path: path.to_owned(), source })?;
        Self::from_json(&bytes)
    }

    /// Reads a case from JSON text.
    /// A value of `null` is treated as missing. The ranges of the values are not checked here (see
    /// [`check`](Self::check)), because later settings can still complete or correct the case.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for syntax errors, unknown or repeated keys, and wrong types.
    pub fn from_json(json: &[u8]) -> Result<Self, CaseError> {
        Self::from_entries(entries(json)?)
    }

    /// Works like [`from_json`](Self::from_json), but takes the members of the JSON object.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for unknown or repeated keys, and wrong types.
    pub fn from_entries(
        entries: impl IntoIterator<Item = (String, Value)>,
    ) -> Result<Self, CaseError> {
        let (mut case, mut given) = (Self::default(), GivenNames::default());
        for (key, value) in entries {
            if let (Some(quantity), false) = (quantity_of(&key, &value), value.is_null()) {
                given.add(quantity, &key)?;
            }
            case.assign_json(&key, &value)?;
        }
        Ok(case)
    }

    /// Converts the given inputs to a JSON object.
    pub fn to_json(&self) -> Value {
        let text = self.description.iter().map(|text| (DESCRIPTION.to_owned(), json!(text)));
        let number = |key: InputKey| Some((key.name().to_owned(), json!(self[key]?)));
        let numbers = InputKey::ALL.into_iter().filter_map(number);
        Value::Object(text.chain(numbers).chain(self.entries.to_map()).collect())
    }

    pub(crate) fn assign_json(&mut self, key: &str, value: &Value) -> Result<(), CaseError> {
        if key == DESCRIPTION {
            return match value {
                Value::String(text) => {
                    self.description = Some(text.clone());
                    Ok(())
                }
                Value::Null => Ok(()),
                other => Err(wrong_type(key, other, "text")),
            };
        }
        let key = key_of(key, value.as_str());
        if CaseEntries::has_key(key) {
            return self.entries.set(key.to_owned(), value.clone());
        }
        // The name is checked first, so that an unknown name is reported instead of a wrong type.
        let (input, change) = InputKey::in_unit(key)?;
        let number = match value {
            Value::Null => None,
            Value::Number(number) => number.as_f64(),
            other => return Err(wrong_type(key, other, "a number")),
        };
        self[input] = number.map(|number| change.value(number));
        Ok(())
    }

    /// Removes the input with the given name.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Unknown`] for an unknown name.
    pub fn remove(&mut self, name: &str) -> Result<(), CaseError> {
        if name == DESCRIPTION {
            self.description = None;
        } else if !self.entries.remove(name) {
            let (key, _) = InputKey::in_unit(name)?;
            self[key] = None;
        }
        Ok(())
    }

    /// Sets one input (see [`override_with`](Self::override_with)).
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Unknown`] for an unknown name.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), CaseError> {
        let mut setting = Self::default();
        setting[InputKey::named(name)?] = Some(value);
        self.override_with(&setting);
        Ok(())
    }

    /// Applies several settings `name=value` at once (see [`override_with`](Self::override_with)).
    ///
    /// # Errors
    /// Returns [`CaseError`] if a setting does not have this form, contains an unknown name or an
    /// invalid number, or sets an input that is already set.
    pub fn apply<S: AsRef<str>>(&mut self, settings: &[S]) -> Result<(), CaseError> {
        let (mut given, mut names) = (Self::default(), GivenNames::default());
        for setting in settings {
            let text = setting.as_ref();
            let malformed = || CaseError::bad_setting(text, "name=value");
            let (name, value) = text.split_once('=').ok_or_else(malformed)?;
            let (name, value) = (name.trim(), value.trim());
            // In a setting such as `support=fixed-fixed`, the text value needs no quotes.
            let word = match name {
                DESCRIPTION => json!(value.trim_matches('"')),
                _ => json_or_text(value)?,
            };
            if let Some(quantity) = quantity_of(name, &word) {
                names.add(quantity, name)?;
            }
            let key = key_of(name, word.as_str());
            if key == DESCRIPTION || CaseEntries::has_key(key) {
                given.assign_json(key, &word)?;
                continue;
            }
            let (key, change) = InputKey::in_unit(name)?;
            let number: f64 = value.parse().map_err(|_| CaseError::not_a_number(name, value))?;
            given[key] = Some(change.value(number));
        }
        if given.description.is_some() {
            self.description.clone_from(&given.description);
        }
        self.override_with(&given);
        Ok(())
    }

    /// Checks each given value against its rule, and the rules that relate several values.
    ///
    /// # Errors
    ///
    /// Returns a [`CaseError`] that states the key, the value and the violated rule.
    pub fn check(&self) -> Result<(), CaseError> {
        self.check_but(InputSet::default())
    }

    /// Checks all rules except for the rules that depend on the inputs in `open`.
    pub(crate) fn check_but(&self, open: InputSet) -> Result<(), CaseError> {
        let given = self.given().without(open);
        for key in given.iter() {
            let value = self[key].unwrap_or(f64::NAN);
            key.input().rule.check(key.name(), value)?;
        }
        given.check_forms()?;
        let relations =
            Relation::ALL.into_iter().filter(|relation| !relation.inputs().intersects(open));
        for relation in relations {
            if relation.holds(self) == Some(false) {
                return Err(relation.broken(self));
            }
        }
        Ok(())
    }

    /// Returns the speeds of screw and nut \[rpm\], or `None` if the screw speed is missing. The
    /// nut speed defaults to 0.
    pub fn speeds_rpm(&self) -> Option<(f64, f64)> {
        let screw = self.value_or_default(InputKey::screw_speed_rpm)?;
        Some((screw, self.nut_speed_rpm.unwrap_or(0.0)))
    }

    /// Returns the lead angle \[rad\], either given or calculated from lead and pitch circle.
    pub fn lead_angle(&self) -> Option<f64> {
        self.reader().lead_angle()
    }

    /// Returns the lead \[mm\], either given or calculated from lead angle and pitch circle.
    pub(crate) fn lead(&self) -> Option<f64> {
        self.lead_mm.or_else(|| {
            let pitch = self.pitch_circle_diameter_mm?;
            Some(lead_mm(self.lead_angle()?, pitch))
        })
    }

    /// Returns a note on the roughness values that are assumed for a lubricated case.
    pub(crate) fn assumed_roughness(&self) -> Option<String> {
        const SURFACES: [InputKey; 3] =
            [InputKey::ball_roughness_um, InputKey::nut_roughness_um, InputKey::screw_roughness_um];
        let assumed = |key: &InputKey| {
            let value = self.value_or_default(*key).filter(|_| self[*key].is_none())?;
            Some(format!("{} {value}", key.name()))
        };
        let assumed: Vec<_> = SURFACES.iter().filter_map(assumed).collect();
        (self.given().is_lubricated() && !assumed.is_empty()).then(|| {
            format!(
                "A typical roughness of ground surfaces is assumed, which is accurate to about 40 %: {}. If screw_make is rolled, screw_roughness_um \
                 defaults to 0.4.",
                assumed.join(", ")
            )
        })
    }

    /// Returns warnings about the inputs.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let (Some(ball), Some(lead)) = (self.ball_diameter_mm, self.lead())
            && lead > 0.0
            && let Some(starts) = self.value_or_default(InputKey::starts)
            && ball * starts >= lead
        {
            let threads = match starts {
                1.0 => "a single-start screw".to_owned(),
                _ => format!("a screw with {starts} starts"),
            };
            warnings.push(format!(
                "Balls with ball_diameter_mm = {ball} do not fit into the lead of {lead:.3} mm: neighboring \
                 turns of {threads} overlap."
            ));
        }
        warnings.extend(self.too_heavy());
        warnings
    }
}

impl Case {
    /// Returns a warning if the mass or the moment of inertia per length of the screw exceeds the
    /// value of a solid steel rod with the outer diameter of the screw.
    fn too_heavy(&self) -> Option<String> {
        /// Permitted ratio of the given mass or moment of inertia to the value for a rod with the
        /// nominal diameter. Outer diameters exceed nominal diameters by up to 2 %, and the moment
        /// of inertia increases with the fourth power of the diameter.
        const SLACK: f64 = 1.08;
        let outer_mm = self.screw_outer_diameter_mm.or(self.nominal_diameter_mm)?;
        let mass = rod_mass_per_length(outer_mm * MM);
        let rod = [mass, rod_inertia(1.0, mass)];
        let given = [InputKey::screw_mass_kg_m, InputKey::screw_inertia_kg_m2_m];
        let (key, value, most) = given
            .into_iter()
            .zip(rod)
            .filter_map(|(key, most)| Some((key, self[key]?, most)))
            .find(|(_, value, most)| *value > SLACK * most)?;
        Some(format!(
            "{} is {}, but a solid steel rod of {outer_mm} mm has only {}. Check the diameter and the unit.",
            key.name(),
            format_trimmed(value),
            format_short(most)
        ))
    }
}

/// Returns the key to which a value is assigned. If the preload is set to the word `auto`, this is
/// the key of the preload class instead of the key of the preload force.
fn key_of<'a>(key: &'a str, word: Option<&str>) -> &'a str {
    let is_least = word == Some("auto") && key == InputKey::preload_N.name();
    if is_least { "preload_class" } else { key }
}

/// Returns the name of the quantity to which a key with any unit refers, or `None` for an unknown
/// key.
pub(crate) fn quantity_of(key: &str, value: &Value) -> Option<&'static str> {
    let key = key_of(key, value.as_str());
    let entry = || CaseEntries::KEYS.iter().chain(&[DESCRIPTION]).find(|own| **own == key).copied();
    entry().or_else(|| Some(InputKey::known_in_unit(key)?.0.name()))
}

/// Sets of inputs that no ball model uses, each with a clause that names the results that depend on
/// these inputs.
const NOT_IN_BALANCE: [(InputSet, &str); 2] = {
    let of_an_axis = inputs! { moved_mass_kg seal_torque_Nm support_bearing_torque_Nm };
    [
        (NUT_ONLY_INPUTS, "`bsm nut` includes all balls of the nut"),
        (of_an_axis, "the screw torque and `bsm axis` include the whole axis"),
    ]
};

impl InputSet {
    /// Returns notes on the given inputs that no ball model uses.
    pub fn unused_by_models(self) -> impl Iterator<Item = String> {
        NOT_IN_BALANCE.into_iter().filter_map(move |(unused, part)| {
            let names: Vec<_> =
                unused.iter().filter(|key| self.contains(*key)).map(InputKey::name).collect();
            let verb = if names.len() == 1 { "is" } else { "are" };
            let names = names.join(", ");
            (!names.is_empty()).then(|| {
                format!(
                    "{names} {verb} not included in the results of the balls, because the model calculates one ball; {part}."
                )
            })
        })
    }
}

impl Case {
    /// Returns a note if the case contains a cycle, which no ball model uses.
    pub(crate) fn unused_cycle(&self) -> Option<String> {
        let note = "The cycle is not used, because the models calculate one ball at axial_load_N and screw_speed_rpm. \
                    `bsm nut` and `bsm axis` use the cycle.";
        self.entries.cycle.as_ref().map(|_| note.to_owned())
    }
}

/// Inputs of the nut that are calculated from the warm steady state.
const WARM: [InputKey; 4] = {
    let [nut, screw, balls] = RISES;
    [nut, screw, balls, InputKey::screw_tension_N]
};

/// Inputs for the temperature rises of nut, screw and balls.
pub(crate) const RISES: [InputKey; 3] = [
    InputKey::nut_temperature_rise_K,
    InputKey::screw_temperature_rise_K,
    InputKey::ball_temperature_rise_K,
];

impl Case {
    /// Returns a warning if a moving mass and an axial load are given, because the axial load then
    /// does not include the forces of the mass.
    pub(crate) fn load_of_the_mass(&self) -> Option<String> {
        let mass = self.moved_mass_kg.filter(|mass| *mass != 0.0)?;
        self.axial_load_N.map(|_| {
            format!(
                "The axial load is axial_load_N without weight and guide friction of the moved mass of {mass} kg; `bsm axis` \
                 adds them."
            )
        })
    }

    /// Returns the kinematic viscosity of the lubricant at its temperature \[m²/s\], if lubricant
    /// and temperature are known.
    pub(crate) fn viscosity(&self) -> Option<f64> {
        let lubricant = self.reader().lubricant()?;
        match lubricant.temperature {
            Temperature::Known(kelvin) => Some(lubricant.oil.at(kelvin).kinematic_viscosity),
            Temperature::Balance { .. } => None,
        }
    }

    /// Returns a note on the torques that are not calculated if the lubricant is too viscous for a
    /// cold start. Returns `None` if the drag of the balls is given.
    pub(crate) fn cold_lubricant(&self) -> Option<String> {
        /// Largest kinematic viscosity at which manufacturers of gears and pumps typically permit a
        /// start without heating \[m²/s\].
        const START: f64 = 1000e-6;
        let viscosity = self.viscosity().filter(|viscosity| *viscosity > START)?;
        self.drag_coefficient.is_none().then(|| {
            format!(
                "drag_coefficient is not given, so churning of the lubricant is neglected; the torque to start from rest is not \
                 calculated at a viscosity of {:.0} mm2/s",
                viscosity * 1e6
            )
        })
    }

    /// Returns the speed inputs that need not be checked because the screw is at standstill. The
    /// nut analysis is also valid at standstill, because the balls still carry the load.
    pub(crate) fn speeds_at_rest(&self) -> InputSet {
        let is_at_rest = self.speeds_rpm().is_some_and(|(screw, nut)| screw - nut == 0.0);
        if is_at_rest {
            inputs! { screw_speed_rpm }
        } else {
            InputSet::default()
        }
    }

    /// Returns true if the case requests its warm steady state.
    pub fn requests_warm_state(&self) -> bool {
        self.entries.warm_state == Some(true)
    }

    /// Returns a copy of the case in the state in which the preload is set: without temperature
    /// rises, screw tension and warm state.
    pub(crate) fn cold(&self) -> Self {
        let mut cold = self.clone();
        cold.entries.warm_state = None;
        for key in WARM {
            cold[key] = None;
        }
        cold
    }

    /// Returns a copy of the case without the inputs that determine friction.
    pub(crate) fn without_friction(mut self) -> Self {
        self.friction_coefficient = None;
        for key in LUBRICANT_INPUTS.iter() {
            self[key] = None;
        }
        self
    }

    /// Returns true if the nut is preloaded.
    pub(crate) fn is_preloaded(&self) -> bool {
        [InputKey::preload_N, InputKey::preload_offset_um, InputKey::ball_oversize_um]
            .into_iter()
            .any(|key| self[key].is_some_and(|value| value != 0.0))
    }

    /// Returns true if the temperature of nut, screw or balls has changed since the preload was
    /// set, or if the screw is under tension.
    pub(crate) fn is_warm(&self) -> bool {
        WARM.into_iter().any(|key| self[key].is_some_and(|value| value != 0.0))
    }
}
