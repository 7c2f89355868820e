//! What a screw must do, in the vocabulary and a few more keys.

use bsm_design::{
    DutySpeed, Fixed, Lists, LoadCase, Objective, Pitch, Ranges, Requirement, Travel,
};
use bsm_dyn::{Direction, Model, Optimum};
use serde_json::{Map, Value};

use crate::Rule::{Above, AtLeast, Between};
use crate::case::axis::{carriage, motions, mount, rating_factors, reliability};
use crate::vocabulary::names::wrong_type;
use crate::vocabulary::quantity::keys;
use crate::vocabulary::units::{DEG, MM, MPA, RPM, convert};
use crate::{CaseError, InputKey, Known, Scene, entries, nearest};

keys! {
    /// Numbers that only requirements have.
    pub REQUIREMENT_INPUTS;
    screw_torque_Nm ["N m"] Above(0.0), None, "torque on the screw, in place of axial_load_N";
    screw_length_mm ["mm"] Above(0.0), None, "length of the screw, or give stroke_mm";
    least_efficiency [""] Between(0.0, 1.0), None, "smallest efficiency allowed";
    largest_input_power_W ["W"] Above(0.0), None, "largest input power allowed: that of the motor, or of the load where it drives";
    pressure_limit_MPa ["MPa"] Above(0.0), Some(4200.0), "largest Hertz pressure allowed (ISO 76)";
    largest_pitch_circle_diameter_mm ["mm"] Above(0.0), Some(125.0), "largest pitch circle diameter allowed";
    largest_loaded_turns [""] AtLeast(2.0), Some(6.0), "largest number of loaded turns allowed, 12 at most";
    largest_ball_over_lead [""] Above(0.0), Some(0.7), "largest ball diameter over lead; the rest of the lead is the land between the grooves";
    smallest_contact_angle_deg ["deg"] Between(0.0, 90.0), Some(USUAL_CONTACT_ANGLES_DEG.0), "smallest contact angle allowed";
    largest_contact_angle_deg ["deg"] Between(0.0, 90.0), Some(USUAL_CONTACT_ANGLES_DEG.1), "largest contact angle allowed";
    largest_length_over_pitch_radius [""] Above(0.0), None, "largest length of the screw over its pitch circle radius, 60 in Lin's step 4";
    smallest_ball_radius_over_pitch_radius [""] Between(0.0, 1.0), Some(0.07), "smallest ball radius over pitch circle radius (Lin's step 5)";
    largest_ball_radius_over_pitch_radius [""] Between(0.0, 1.0), Some(0.2), "largest ball radius over pitch circle radius (Lin's step 5)";
    smallest_ball_radius_over_groove_radius [""] Between(0.0, 1.0), Some(0.95), "smallest ball radius over groove radius (Lin's step 6); 0.5 / conformity";
    largest_ball_radius_over_groove_radius [""] Between(0.0, 1.0), Some(0.97), "largest ball radius over groove radius (Lin's step 6)";
}

/// Friction coefficient of a requirement without one, and the usual range; a grease or an oil gives some 0.03 to 0.12.
const USUAL_FRICTION: (f64, [f64; 2]) = (0.06, [0.03, 0.12]);

/// Contact angles that are easy to make \[deg\].
pub(crate) const USUAL_CONTACT_ANGLES_DEG: (f64, f64) = (30.0, 75.0);

/// Keys with texts, and their possible texts; the first is the default.
pub const REQUIREMENT_WORDS: [(&str, &[&str], &str); 3] = [
    ("motion", &["rotary-to-linear", "linear-to-rotary"], "which side drives"),
    ("objective", &["mass", "efficiency", "capacity"], "what the search optimises"),
    (
        "model",
        &["traction", "elastic", "raceway-control", "rigid", "quasi-static", "closed-form"],
        "model for the efficiency",
    ),
];

macro_rules! inputs_of_scenes {
    ($($key:ident)*) => { [$(InputKey::$key),*] };
}

/// Inputs of a scene that a requirement may have: what decides, and what bsm axis reads besides, so that one file serves all.
const FROM_SCENES: [InputKey; 47] = inputs_of_scenes! {
    axial_load_N lead_mm lead_angle_deg screw_speed_rpm friction_coefficient speed_number_limit_mm_min
    ball_diameter_mm pitch_circle_diameter_mm contact_angle_deg nut_conformity screw_conformity loaded_turns
    rolling_friction_mm density_kg_m3 youngs_modulus_GPa poisson_ratio ball_youngs_modulus_GPa
    ball_poisson_ratio feed_m_min stroke_mm preload_N unsupported_length_mm shaft_diameter_mm moved_mass_kg
    inclination_deg guide_friction motor_inertia_kg_m2 coupling_inertia_kg_m2 gear_ratio
    support_bearing_torque_Nm seal_torque_Nm support_bearing_stiffness_N_um housing_stiffness_N_um
    axis_heat_transfer_W_K reliability_percent required_life_h required_static_safety
    required_critical_speed_ratio required_buckling_safety useful_travel_mm required_travel_error_um
    load_factor hardness_HRC hardness_HV10 accuracy_factor screw_temperature_rise_K thermal_expansion_um_m_K
};

/// Words of a scene that a requirement may have.
const WORDS_FROM_SCENES: [&str; 5] =
    ["support", "cycle", "accuracy_grade", "steel", "preload_arrangement"];

/// A requirement as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct RequirementFile {
    /// Inputs that it shares with scenes: load, speed, friction, materials, and whatever is fixed.
    pub(crate) scene: Scene,
    /// The model that tells the efficiency.
    pub(crate) model: Model,
    pub(crate) requirement: Requirement,
    /// What was assumed.
    pub(crate) notes: Vec<String>,
}

impl RequirementFile {
    /// Reads a requirement and applies settings `name=value`.
    ///
    /// * `standard`: balls in stock, and the leads to choose from if the requirement has none.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for syntax, unknown keys, values out of range, and what is missing or
    /// contradicts itself.
    pub fn from_json(json: &[u8], settings: &[String], standard: Lists) -> Result<Self, CaseError> {
        let mut given = Given::default();
        for (key, value) in entries(json)? {
            given.assign(&key, &value)?;
        }
        for setting in settings {
            let bad = || CaseError::BadSetting { text: setting.clone(), form: "name=value" };
            let (key, text) = setting.split_once('=').ok_or_else(bad)?;
            let (key, text) = (key.trim(), text.trim());
            let value = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text));
            given.assign(key, &value)?;
        }
        given.wish(standard)
    }
}

/// A key, and what its value makes.
type Form<T> = (&'static str, fn(f64) -> T);

/// Keys and values, checked one by one.
#[derive(Default)]
struct Given {
    scene: Scene,
    numbers: Map<String, Value>,
    words: Map<String, Value>,
}

impl Given {
    fn assign(&mut self, key: &str, value: &Value) -> Result<(), CaseError> {
        if let Some((_, words, _)) = REQUIREMENT_WORDS.iter().find(|(name, ..)| *name == key) {
            let known = value.as_str().is_some_and(|word| words.contains(&word));
            if !known {
                let expected = format!("one of {}", words.join(", "));
                return Err(wrong_type(key.to_owned(), value, &expected));
            }
            self.words.insert(key.to_owned(), value.clone());
            return Ok(());
        }
        if let Some(input) = REQUIREMENT_INPUTS.iter().find(|input| input.name == key) {
            let number =
                value.as_f64().ok_or_else(|| wrong_type(key.to_owned(), value, "a number"))?;
            input.rule.check(input.name, number)?;
            self.numbers.insert(key.to_owned(), value.clone());
            return Ok(());
        }
        let names = || FROM_SCENES.iter().map(|key| key.name());
        let known = key == "description"
            || WORDS_FROM_SCENES.contains(&key)
            || names().any(|name| name == key)
            || convert(key, &names()).is_some();
        if !known {
            let names = FROM_SCENES.iter().map(|k| k.name());
            let names = names.chain(REQUIREMENT_INPUTS.iter().map(|input| input.name));
            let names = names.chain(REQUIREMENT_WORDS.iter().map(|(name, ..)| *name));
            let names = names.chain(WORDS_FROM_SCENES);
            return Err(CaseError::unknown(Known::Requirement, key, nearest(key, names)));
        }
        self.scene.assign_json(key.to_owned(), value)
    }

    fn number(&self, key: &str) -> Option<f64> {
        let input = REQUIREMENT_INPUTS.iter().find(|input| input.name == key);
        self.numbers.get(key).and_then(Value::as_f64).or(input.and_then(|input| input.default))
    }

    fn word(&self, key: &str) -> &str {
        let first = REQUIREMENT_WORDS.iter().find(|(name, ..)| *name == key);
        let first = first.map_or("", |(_, words, _)| words[0]);
        self.words.get(key).and_then(Value::as_str).unwrap_or(first)
    }

    /// One of two forms of a demand.
    fn one_of<T>(&self, forms: [Form<T>; 2]) -> Result<T, CaseError> {
        let in_scene = |key| InputKey::named(key).ok().and_then(|key| self.scene[key]);
        let value = |key| in_scene(key).or_else(|| self.number(key));
        match forms.map(|(key, form)| value(key).map(form)) {
            [Some(one), None] | [None, Some(one)] => Ok(one),
            found => Err(CaseError::OneOfTwo {
                keys: forms.map(|(key, _)| key),
                found: if found[0].is_some() { "both are" } else { "neither is" },
            }),
        }
    }

    /// The cycle, or the operating point, or a torque.
    fn demand(&self, scene: &Scene) -> Result<LoadCase, CaseError> {
        let torque = self.number("screw_torque_Nm");
        let not_with = |key: &'static str, given: bool| {
            if given {
                let keys = [key, "screw_torque_Nm"];
                return Err(CaseError::OneOfTwo { keys, found: "both are" });
            }
            Ok(())
        };
        let Some(torque) = torque else {
            if scene.nut.cycle.is_none() && scene.axial_load_N.is_none() {
                let keys = ["axial_load_N", "screw_torque_Nm"];
                return Err(CaseError::OneOfTwo { keys, found: "neither is" });
            }
            return Ok(LoadCase::Cycle(motions(scene)?));
        };
        not_with("axial_load_N", scene.axial_load_N.is_some())?;
        not_with("cycle", scene.nut.cycle.is_some())?;
        // It is the torque of all that the screw carries.
        not_with("moved_mass_kg", scene.moved_mass_kg.is_some_and(|mass| mass != 0.0))?;
        let pace = match (scene.feed_m_min, scene.screw_speed_rpm) {
            (Some(feed), _) => DutySpeed::Feed(feed / 60.0),
            (None, rpm) => DutySpeed::Turns(rpm.unwrap_or(f64::NAN) * RPM),
        };
        Ok(LoadCase::Torque(torque, pace))
    }

    /// Least and largest of a number; the keys of both are of the requirement.
    fn range(&self, low: &'static str, high: &'static str) -> Result<(f64, f64), CaseError> {
        let [least, most] = [low, high].map(|key| self.number(key).unwrap_or(f64::NAN));
        // The search moves within the range: a value is fixed by its own key.
        if least < most {
            return Ok((least, most));
        }
        let rule = format!("> {low} = {least}");
        Err(CaseError::OutOfRange { key: high.to_owned(), value: most, rule })
    }

    fn ranges(&self) -> Result<Ranges, CaseError> {
        let (low, high) = self.range("smallest_contact_angle_deg", "largest_contact_angle_deg")?;
        let slenderness = self.number("largest_length_over_pitch_radius");
        Ok(Ranges {
            contact_angle: (low * DEG, high * DEG),
            slimmest: slenderness.map(f64::recip),
            ball_over_radius: self.range(
                "smallest_ball_radius_over_pitch_radius",
                "largest_ball_radius_over_pitch_radius",
            )?,
            ball_over_groove: self.range(
                "smallest_ball_radius_over_groove_radius",
                "largest_ball_radius_over_groove_radius",
            )?,
        })
    }

    fn wish(self, standard: Lists) -> Result<RequirementFile, CaseError> {
        let mut scene = self.scene.clone();
        scene.check()?;
        let reach = self.one_of([
            ("screw_length_mm", |mm| Travel::Screw(mm * MM)),
            ("stroke_mm", |mm| Travel::Stroke(mm * MM)),
        ])?;
        // Lead and lead angle together are a pitch circle.
        if let (Some(lead), Some(angle), None) =
            (scene.lead_mm, scene.lead_angle_deg, scene.pitch_circle_diameter_mm)
        {
            let diameter = lead / (std::f64::consts::PI * (angle * DEG).tan());
            scene.pitch_circle_diameter_mm = Some(diameter);
        }
        // The screw is judged over its whole length unless that between its bearings is given.
        if let Travel::Screw(length) = reach {
            scene.unsupported_length_mm.get_or_insert(length / MM);
        }
        let moves = scene.screw_speed_rpm.is_some() || scene.feed_m_min.is_some();
        if !moves && scene.nut.cycle.is_none() {
            let missing = vec!["screw_speed_rpm (or feed_m_min)".to_owned()];
            return Err(CaseError::Missing { missing, by: "for a design".to_owned() });
        }
        let mut notes = Vec::new();
        let friction = *scene.friction_coefficient.get_or_insert_with(|| {
            let (usual, [low, high]) = USUAL_FRICTION;
            notes.push(format!(
                "friction_coefficient {usual} is assumed; usual values are {low} to {high}"
            ));
            usual
        });
        let conformity = match (scene.nut_conformity, scene.screw_conformity) {
            (Some(nut), Some(screw)) if (nut - screw).abs() > 1e-12 => {
                return Err(CaseError::TwoConformities { nut, screw });
            }
            (nut, screw) => nut.or(screw),
        };
        let direction = match self.word("motion") {
            "linear-to-rotary" => Direction::LinearToRotary,
            _ => Direction::RotaryToLinear,
        };
        // The motion tells the direction; a sign of the speed is of no matter.
        let towards = |speed: f64| direction.sign() * speed.abs();
        scene.screw_speed_rpm = scene.screw_speed_rpm.map(towards);
        scene.feed_m_min = scene.feed_m_min.map(towards);
        let demand = self.demand(&scene)?;
        let ranges = self.ranges()?;
        let pitches = match (scene.lead_mm, scene.lead_angle_deg) {
            (Some(lead), _) => vec![Pitch::Lead(lead * MM)],
            (None, Some(angle)) => vec![Pitch::Angle(angle * DEG)],
            (None, None) if direction.is_back() => {
                // Lin's rule: the largest contact angle, and the lead angle that it is best for.
                let largest = ranges.contact_angle.1 / DEG;
                let contact = *scene.contact_angle_deg.get_or_insert(largest);
                let lead = Optimum::lead_angle(direction, contact * DEG, friction);
                vec![Pitch::Angle(
                    lead.ok_or(CaseError::NoBestLead { contact_angle_deg: contact })?,
                )]
            }
            (None, None) => standard.leads.into_iter().map(Pitch::Lead).collect(),
        };
        let limit = |key| self.number(key).unwrap_or(f64::NAN);
        let least = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
        let requirement = Requirement {
            demand,
            carriage: carriage(&scene),
            preload: scene.preload_N,
            reliability: reliability(&scene),
            factors: rating_factors(&scene),
            direction,
            pitches,
            reach,
            mount: mount(&scene),
            speed_ratio: least(InputKey::required_critical_speed_ratio),
            buckling_safety: least(InputKey::required_buckling_safety),
            static_safety: least(InputKey::required_static_safety),
            life: scene.required_life_h.map(|hours| 3600.0 * hours),
            friction,
            material: scene.reader().materials(),
            pressure: limit("pressure_limit_MPa") * MPA,
            speed_number: least(InputKey::speed_number_limit_mm_min) * MM * RPM,
            ball_over_lead: limit("largest_ball_over_lead"),
            largest_diameter: limit("largest_pitch_circle_diameter_mm") * MM,
            largest_turns: limit("largest_loaded_turns"),
            least_efficiency: self.number("least_efficiency"),
            largest_power: self.number("largest_input_power_W"),
            ranges,
            objective: match self.word("objective") {
                "capacity" => Objective::Capacity,
                "efficiency" => Objective::Efficiency,
                _ => Objective::Mass,
            },
            fixed: Fixed {
                pitch_diameter: scene.pitch_circle_diameter_mm.map(|mm| mm * MM),
                ball: scene.ball_diameter_mm.map(|mm| mm * MM),
                contact_angle: scene.contact_angle_deg.map(|deg| deg * DEG),
                conformity,
                turns: scene.loaded_turns,
            },
            stock: standard.balls,
        };
        let model = Model::from_name(self.word("model")).unwrap_or(Model::Traction);
        Ok(RequirementFile { scene, model, requirement, notes })
    }
}
