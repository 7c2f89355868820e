//! Requirements for the selection of a screw.

use bsm_design::catalog::Lists;
use bsm_design::motion::DutySpeed;
use bsm_design::{
    Bounds, FixedValues, LoadCase, MotorLimit, Objective, Pitch, Range, Ranges, Requirement, Travel,
};
use bsm_dyn::{Direction, angles::Optimum};
use serde_json::Value;

use crate::Rule::{Above, AtLeast, Between};
use crate::case::axis_inputs::{
    AXIAL_LOAD, carriage, driven_part, given_make, motor_speed, mount, preload, preload_method,
    rating_factors, reliability, required_life, stroke,
};
use crate::case::cycle::Cycle;
use crate::case::file::quantity_of;
use crate::vocabulary::entries::Choice;
use crate::vocabulary::input::InputGroup;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::names::{GivenNames, json_or_text, wrong_type};
use crate::vocabulary::quantity::keys;
use crate::vocabulary::units::{DEG, MM, MPA, RPM, UM, convert};
use crate::{
    Case, CaseError, InputKey, InputSet, ModelChoice, NameKind, Quantity, RequirementChoice,
    Settings, entries, nearest,
};

keys! {
    /// Numeric keys that occur only in requirements.
    pub REQUIREMENT_INPUTS of RequirementKey;
    screw_torque_Nm ["N m"] Above(0.0), None, "torque on the screw; replaces axial_load_N";
    screw_length_mm ["mm"] Above(0.0), None, "length of the screw; alternative: stroke_mm";
    least_efficiency [""] Between(0.0, 1.0), None, "smallest permitted efficiency";
    largest_input_power_W ["W"] Above(0.0), None, "largest permitted input power; supplied by the motor, or by the load if the load drives";
    pressure_limit_MPa ["MPa"] Above(0.0), Some(4200.0), "largest permitted Hertz pressure (ISO 76)";
    largest_pitch_circle_diameter_mm ["mm"] Above(0.0), Some(125.0), "largest permitted pitch circle diameter";
    largest_loaded_turns [""] AtLeast(2.0), None, "largest permitted number of loaded turns, at most 12; defaults to 6";
    largest_ball_over_lead [""] Above(0.0), Some(Requirement::BALL_OVER_LEAD), "largest ball diameter divided by lead; the rest of the lead is the land between the grooves";
    smallest_contact_angle_deg ["deg"] Between(0.0, 90.0), Some(USUAL_CONTACT_ANGLES_DEG.low), "smallest permitted contact angle";
    largest_contact_angle_deg ["deg"] Between(0.0, 90.0), Some(USUAL_CONTACT_ANGLES_DEG.high), "largest permitted contact angle";
    largest_length_over_pitch_radius [""] Above(0.0), None, "largest length of the screw divided by its pitch circle radius (60 in step 4 of Lin)";
    smallest_ball_radius_over_pitch_radius [""] Between(0.0, 1.0), None, "smallest ball radius divided by pitch circle radius (step 5 of Lin); defaults to 0.07 for continuous sizes";
    largest_ball_radius_over_pitch_radius [""] Between(0.0, 1.0), None, "largest ball radius divided by pitch circle radius (step 5 of Lin); defaults to 0.2 for continuous sizes";
    smallest_ball_radius_over_groove_radius [""] Between(0.0, 1.0), None, "smallest ball radius divided by groove radius, 0.5 / conformity (step 6 of Lin); defaults to 0.95 for continuous sizes";
    largest_ball_radius_over_groove_radius [""] Between(0.0, 1.0), None, "largest ball radius divided by groove radius (step 6 of Lin); defaults to 0.97 for continuous sizes";
}

/// Friction coefficient that is assumed if a requirement contains none, and its typical range.
/// Greases and oils have friction coefficients of about 0.03 to 0.12.
const USUAL_FRICTION: (f64, [f64; 2]) = (0.06, [0.03, 0.12]);

/// Range of contact angles that are easy to manufacture \[deg\].
pub(crate) const USUAL_CONTACT_ANGLES_DEG: Range = Range { low: 30.0, high: 75.0 };

/// Axis inputs that are not permitted in a requirement. These inputs are catalog data that the
/// search itself calculates.
const NOT_OF_AXES: InputSet = inputs! {
    nominal_diameter_mm rated_dynamic_load_N rated_static_load_N screw_mass_kg_m nut_mass_kg
    catalog_efficiency catalog_back_efficiency rated_rigidity_N_um
};

/// Inputs of screw and nut that a requirement may contain, and other inputs that are used only for
/// the axis sheet.
const SHEET_INPUTS: InputSet = inputs! {
    lead_mm lead_angle_deg ball_diameter_mm pitch_circle_diameter_mm contact_angle_deg
    nut_conformity screw_conformity loaded_turns density_kg_m3 youngs_modulus_GPa poisson_ratio
    ball_youngs_modulus_GPa ball_poisson_ratio preload_N nut_temperature_rise_K
    screw_temperature_rise_K ball_temperature_rise_K thermal_expansion_um_m_K
};

/// Returns the case inputs that a requirement may contain. Some of them affect the selection, and
/// others are used only by `bsm axis`, so that all commands can read the same file.
fn from_cases() -> impl Iterator<Item = InputKey> + Clone {
    let of_axis = |key: &InputKey| match key.group() {
        InputGroup::OperatingPoint => !SINGLE_BALL_INPUTS.contains(*key),
        InputGroup::Axis => !NOT_OF_AXES.contains(*key),
        InputGroup::Lubricant | InputGroup::WarmState => true,
        InputGroup::Screw | InputGroup::Nut => false,
    };
    InputKey::ALL.into_iter().filter(move |key| of_axis(key) || SHEET_INPUTS.contains(*key))
}

/// Inputs of the single-ball models that a requirement must not contain, because the number of
/// balls in a design follows from the number of turns, and the nut of a design does not turn.
const SINGLE_BALL_INPUTS: InputSet = inputs! { loaded_balls nut_speed_rpm };

/// Text and list inputs that a requirement may contain.
const ENTRIES_FROM_CASES: [&str; 18] = [
    "display_units",
    "driven_part",
    "support",
    "buckling_support",
    "screw_make",
    "cycle",
    "brake_at_rest",
    "accuracy_grade",
    "steel",
    "contamination",
    "kappa_by",
    "preload_arrangement",
    "preload_by",
    "preload_class",
    "base_oil",
    "warm_state",
    "drag_rule",
    "coolant",
];

/// A requirement, as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct RequirementFile {
    /// Inputs that requirements have in common with cases: load, speed, friction, materials and
    /// prescribed sizes.
    pub(crate) case: Case,
    /// Model and solver settings for friction.
    pub(crate) settings: Settings,
    pub(crate) problem: Requirement,
    /// If true, warnings do not limit the selection. Exceptions are warnings that can never be
    /// permitted.
    pub(crate) allow_warnings: bool,
    /// Notes on the assumptions that replace missing data of the requirement.
    pub(crate) notes: Vec<String>,
}

impl RequirementFile {
    /// Returns the notes on the assumptions that replace missing data of the requirement.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Reads a requirement from JSON text and applies settings `name=value`.
    ///
    /// * `standard`: standard ball diameters, and the leads to choose from if the requirement
    ///   contains no lead.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for syntax errors, unknown keys, values out of range, and missing or
    /// contradictory inputs.
    pub fn from_json(json: &[u8], settings: &[String], standard: Lists) -> Result<Self, CaseError> {
        Self::from_entries(entries(json)?, settings, standard)
    }

    /// Works like [`from_json`](Self::from_json), but takes the members of the JSON object.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`from_json`](Self::from_json) except for syntax errors.
    pub fn from_entries(
        entries: impl IntoIterator<Item = (String, Value)>,
        settings: &[String],
        standard: Lists,
    ) -> Result<Self, CaseError> {
        let mut given = RequirementKeys::default();
        for (key, value) in entries {
            given.assign(&key, &value)?;
        }
        let mut set = RequirementKeys::default();
        for setting in settings {
            let malformed = || CaseError::bad_setting(setting, "name=value");
            let (key, text) = setting.split_once('=').ok_or_else(malformed)?;
            let (key, text) = (key.trim(), text.trim());
            set.assign(key, &json_or_text(text)?)?;
        }
        // In a case, lead and lead angle are two forms of the same quantity. In a requirement, they
        // may both be given and then determine the pitch circle diameter.
        let Case { lead_mm, lead_angle_deg, .. } = given.case;
        given.case.override_with(&set.case);
        given.case.lead_mm = set.case.lead_mm.or(lead_mm);
        given.case.lead_angle_deg = set.case.lead_angle_deg.or(lead_angle_deg);
        given.own.override_with(&set.own);
        given.requirement(standard)
    }
}

impl RequirementChoice {
    /// Returns the words that are permitted as the value of the key. The first word is the default.
    pub fn words(self) -> Vec<&'static str> {
        fn names<T: Choice>() -> Vec<&'static str> {
            T::NAMES.iter().map(|(name, _)| *name).collect()
        }
        match self {
            Self::Motion => names::<Direction>(),
            Self::Objective => names::<Objective>(),
            Self::Model => ModelChoice::names().collect(),
            Self::AllowWarnings => names::<bool>(),
        }
    }
}

/// Values of the keys that occur only in requirements. Each value has been checked.
#[derive(Default)]
struct OwnValues {
    /// Numbers in the order of [`REQUIREMENT_INPUTS`].
    numbers: [Option<f64>; REQUIREMENT_INPUTS.len()],
    motion: Option<Direction>,
    objective: Option<Objective>,
    model: Option<ModelChoice>,
    allow_warnings: Option<bool>,
}

impl OwnValues {
    /// Sets the number of a key.
    fn set_number(&mut self, key: RequirementKey, value: &Value) -> Result<(), CaseError> {
        let Quantity { name, rule, .. } = key.quantity();
        let number = value.as_f64().ok_or_else(|| wrong_type(name, value, "a number"))?;
        self.numbers[key as usize] = Some(rule.checked(name, number)?);
        Ok(())
    }

    /// Sets the word of a key. `allow_warnings` can also be a JSON truth value.
    fn set_word(&mut self, key: RequirementChoice, value: &Value) -> Result<(), CaseError> {
        let wrong = || {
            let expected = format!("one of {}", key.words().join(", "));
            wrong_type(key.name(), value, &expected)
        };
        let word = match value {
            Value::Bool(truth) => truth.name(),
            Value::String(word) => word,
            _ => return Err(wrong()),
        };
        match key {
            RequirementChoice::Motion => {
                self.motion = Some(Choice::from_name(word).ok_or_else(wrong)?);
            }
            RequirementChoice::Objective => {
                self.objective = Some(Choice::from_name(word).ok_or_else(wrong)?);
            }
            RequirementChoice::Model => {
                self.model = Some(ModelChoice::from_name(word).map_err(|_| wrong())?);
            }
            RequirementChoice::AllowWarnings => {
                self.allow_warnings = Some(Choice::from_name(word).ok_or_else(wrong)?);
            }
        }
        Ok(())
    }

    /// Replaces the values that are given in `other`.
    fn override_with(&mut self, other: &Self) {
        for (number, new) in self.numbers.iter_mut().zip(other.numbers) {
            *number = new.or(*number);
        }
        self.motion = other.motion.or(self.motion);
        self.objective = other.objective.or(self.objective);
        self.model = other.model.or(self.model);
        self.allow_warnings = other.allow_warnings.or(self.allow_warnings);
    }

    /// Returns the given or default number of a key, or `None` if the key has neither.
    fn number(&self, key: RequirementKey) -> Option<f64> {
        self.numbers[key as usize].or(key.quantity().default)
    }

    /// Returns the given word of a key, or the default, which is the first word.
    fn word<T: Choice>(given: Option<T>) -> T {
        given.unwrap_or(T::NAMES[0].1)
    }
}

/// Keys of a requirement, after each value has been checked separately.
#[derive(Default)]
struct RequirementKeys {
    case: Case,
    own: OwnValues,
    /// Names of the quantities that the requirement has specified so far.
    given: GivenNames,
}

impl RequirementKeys {
    fn assign(&mut self, key: &str, value: &Value) -> Result<(), CaseError> {
        if let (Some(quantity), false) = (Self::quantity_of(key, value), value.is_null()) {
            self.given.add(quantity, key)?;
        }
        if let Some(choice) = RequirementChoice::from_name(key) {
            return self.own.set_word(choice, value);
        }
        if let Some(key) = RequirementKey::from_name(key) {
            return self.own.set_number(key, value);
        }
        let names = || from_cases().map(InputKey::name);
        let known = key == "description"
            || ENTRIES_FROM_CASES.contains(&key)
            || names().any(|name| name == key)
            || convert(key, names()).is_some();
        if !known {
            let names = names().chain(REQUIREMENT_INPUTS.iter().map(|input| input.name));
            let names = names.chain(RequirementChoice::ALL.map(RequirementChoice::name));
            let names = names.chain(ENTRIES_FROM_CASES);
            return Err(CaseError::unknown(NameKind::Requirement, key, nearest(key, names)));
        }
        self.case.assign_json(key, value)
    }

    /// Returns the name of the quantity to which a key with any unit refers, or `None` for an
    /// unknown key.
    fn quantity_of(key: &str, value: &Value) -> Option<&'static str> {
        let number = || Some(RequirementKey::from_name(key)?.quantity().name);
        let choice = RequirementChoice::from_name(key).map(RequirementChoice::name);
        choice.or_else(number).or_else(|| quantity_of(key, value))
    }

    /// Returns the load case: a cycle, an operating point, or a torque.
    fn demand(&self, case: &Case) -> Result<LoadCase, CaseError> {
        let torque = self.own.number(RequirementKey::screw_torque_Nm);
        let Some(torque) = torque else {
            let segments = Cycle::of(case)?.segments;
            let has_force = segments.iter().flat_map(|part| part.force).any(|force| force != 0.0);
            if !has_force && !carriage(case)?.is_loaded() && !case.is_preloaded() {
                return Err(CaseError::neither(["axial_load_N", "screw_torque_Nm"]));
            }
            return Ok(LoadCase::Cycle(segments));
        };
        // The torque already includes all loads on the screw, so additional loads are not
        // permitted.
        let loads = [
            ("axial_load_N", case.axial_load_N.is_some()),
            ("cycle", case.entries.cycle.is_some()),
            ("moved_mass_kg", case.moved_mass_kg.is_some_and(|mass| mass != 0.0)),
        ];
        if let Some((key, _)) = loads.into_iter().find(|(_, given)| *given) {
            return Err(CaseError::given_twice([key, "screw_torque_Nm"]));
        }
        let speed = match (case.feed_m_min, case.screw_speed_rpm) {
            (Some(feed), _) => DutySpeed::of_feed(feed / 60.0),
            (None, rpm) => DutySpeed::of_rotation(rpm.unwrap_or(f64::NAN) * RPM),
        };
        Ok(LoadCase::Torque { torque, speed })
    }

    /// Returns the limits of a quantity. Each limit has its own key in a requirement.
    ///
    /// * `usual`: default range, whose ends replace missing limits.
    fn range(
        &self,
        (low, high): (RequirementKey, RequirementKey),
        usual: Range,
    ) -> Result<Bounds, CaseError> {
        let limits = Bounds { min: self.own.number(low), max: self.own.number(high) };
        let searched = limits.range_or(usual);
        // The two ends of a searched range must differ. A fixed value has a separate key.
        if searched.low < searched.high {
            return Ok(limits);
        }
        let rule = format!("> {} = {}", low.quantity().name, searched.low);
        Err(CaseError::out_of_range(high.quantity().name, searched.high, rule))
    }

    fn ranges(&self) -> Result<Ranges, CaseError> {
        use RequirementKey as K;
        let usual = USUAL_CONTACT_ANGLES_DEG;
        let angles = (K::smallest_contact_angle_deg, K::largest_contact_angle_deg);
        let contact_angle = self.range(angles, usual)?.range_or(usual);
        let radii =
            (K::smallest_ball_radius_over_pitch_radius, K::largest_ball_radius_over_pitch_radius);
        let grooves =
            (K::smallest_ball_radius_over_groove_radius, K::largest_ball_radius_over_groove_radius);
        Ok(Ranges {
            contact_angle: contact_angle.map(|deg| deg * DEG),
            slimmest: self.own.number(K::largest_length_over_pitch_radius).map(f64::recip),
            ball_over_radius: self.range(radii, Ranges::LIN_BALL_OVER_RADIUS)?,
            ball_over_groove: self.range(grooves, Ranges::LIN_BALL_OVER_GROOVE)?,
        })
    }

    /// Returns the given screw length or the stroke. A given screw length takes precedence over the
    /// range of the cycle.
    fn travel(&self, case: &Case) -> Result<Travel, CaseError> {
        let forms = [RequirementKey::screw_length_mm.quantity().name, InputKey::stroke_mm.name()];
        let length = self.own.number(RequirementKey::screw_length_mm);
        match (length, stroke(case)?) {
            (Some(_), Some(_)) if case.stroke_mm.is_some() => Err(CaseError::given_twice(forms)),
            (Some(mm), _) => Ok(Travel::Screw(mm * MM)),
            (None, Some(stroke)) => Ok(Travel::Stroke(stroke)),
            (None, None) => Err(CaseError::neither(forms)),
        }
    }

    fn requirement(self, standard: Lists) -> Result<RequirementFile, CaseError> {
        use RequirementKey as K;
        let mut case = self.case.clone();
        case.check_but(AXIAL_LOAD)?;
        case.given().check_friction()?;
        let travel = self.travel(&case)?;
        // If both lead and lead angle are given, they determine the pitch circle diameter.
        if let (Some(lead), Some(angle), None) =
            (case.lead_mm, case.lead_angle_deg, case.pitch_circle_diameter_mm)
        {
            let diameter = lead / (std::f64::consts::PI * (angle * DEG).tan());
            case.pitch_circle_diameter_mm = Some(diameter);
        }
        // If no unsupported length is given, the whole screw length is assumed to be unsupported.
        if let Travel::Screw(length) = travel {
            case.unsupported_length_mm.get_or_insert(length / MM);
        }
        let moves = case.screw_speed_rpm.is_some() || case.feed_m_min.is_some();
        if !moves && case.entries.cycle.is_none() {
            let missing = ["screw_speed_rpm (or feed_m_min)".to_owned()];
            return Err(CaseError::missing(&missing, "for a design"));
        }
        let mut notes = Vec::new();
        notes.extend(assume_friction(&mut case));
        let motion = Cycle::of(&case)?;
        let life = required_life(&case, motion.time, stroke(&case)?)?;
        if life.is_none() {
            notes.push("required_life_h is not given, so no life is required.".to_owned());
        }
        // The optimum angles of a lubricated screw are calculated with the default friction
        // coefficient.
        let friction = case.friction_coefficient.unwrap_or(USUAL_FRICTION.0);
        let conformity = conformity(&case)?;
        let direction = OwnValues::word(self.own.motion);
        // The direction follows from the key `motion`, so the sign of the speed is ignored.
        let towards = |speed: f64| direction.sign() * speed.abs();
        case.screw_speed_rpm = case.screw_speed_rpm.map(towards);
        case.feed_m_min = case.feed_m_min.map(towards);
        let demand = self.demand(&case)?;
        let (preload, play) = preload(&case)?;
        case.axial_play_um = case.axial_play_um.or(play.map(|play| play / UM));
        let ranges = self.ranges()?;
        if case.lead_mm.is_none() && case.lead_angle_deg.is_none() && direction.is_back() {
            // Lin's rule uses the largest contact angle.
            case.contact_angle_deg.get_or_insert(ranges.contact_angle.high / DEG);
        }
        let pitches = pitches(&case, direction, friction, standard.leads)?;
        let limit = |key| self.own.number(key).unwrap_or(f64::NAN);
        let problem = Requirement {
            demand,
            carriage: carriage(&case)?,
            preload,
            method: preload_method(&case),
            nut_gap: case.nut_gap_mm.map(|mm| mm * MM),
            driven: driven_part(&case)?,
            reliability: reliability(&case),
            factors: rating_factors(&case),
            direction,
            pitches,
            travel,
            mount: mount(&case),
            speed_ratio: case.number(InputKey::required_critical_speed_ratio),
            buckling_safety: case.number(InputKey::required_buckling_safety),
            static_safety: case.number(InputKey::required_static_safety),
            life,
            friction,
            material: case.reader().materials(),
            pressure: limit(K::pressure_limit_MPa) * MPA,
            speed_number: case.speed_number_limit_mm_min.map(|limit| limit * MM * RPM),
            make: given_make(&case),
            grade: case.entries.accuracy_grade.map(|word| word.grade),
            motor: MotorLimit {
                gear_ratio: case.number(InputKey::gear_ratio),
                max_speed: motor_speed(&case).map(|rpm| rpm * RPM),
            },
            ball_over_lead: limit(K::largest_ball_over_lead),
            largest_diameter: limit(K::largest_pitch_circle_diameter_mm) * MM,
            largest_turns: self.own.number(K::largest_loaded_turns),
            least_efficiency: self.own.number(K::least_efficiency),
            largest_power: self.own.number(K::largest_input_power_W),
            ranges,
            objective: OwnValues::word(self.own.objective),
            fixed: FixedValues {
                pitch_diameter: case.pitch_circle_diameter_mm.map(|mm| mm * MM),
                ball: case.ball_diameter_mm.map(|mm| mm * MM),
                contact_angle: case.contact_angle_deg.map(|deg| deg * DEG),
                conformity,
                turns: case.loaded_turns,
            },
            stock: standard.balls,
        };
        let settings =
            Settings { model: self.own.model.unwrap_or_default(), ..Settings::default() };
        let allow_warnings = OwnValues::word(self.own.allow_warnings);
        Ok(RequirementFile { case, settings, problem, allow_warnings, notes })
    }
}

/// Sets a typical friction coefficient if the case specifies no friction, and returns a note on this
/// assumption.
fn assume_friction(case: &mut Case) -> Option<String> {
    if case.given().has_friction() {
        return None;
    }
    let (usual, [low, high]) = USUAL_FRICTION;
    case.friction_coefficient = Some(usual);
    Some(format!("friction_coefficient = {usual} is assumed; typical values are {low} to {high}."))
}

/// Returns the conformity of nut and screw, or `None` if no conformity is given.
fn conformity(case: &Case) -> Result<Option<f64>, CaseError> {
    match (case.nut_conformity, case.screw_conformity) {
        (Some(nut), Some(screw)) if (nut - screw).abs() > 1e-12 => {
            Err(CaseError::Invalid(format!(
                "nut_conformity = {nut} and screw_conformity = {screw} differ, but a design uses one conformity for both; give \
                 only one of them"
            )))
        }
        (nut, screw) => Ok(nut.or(screw)),
    }
}

/// Returns the leads or lead angles of the search. If the load drives the screw and neither lead nor
/// lead angle is given, the result is the lead angle for which the contact angle is optimal.
///
/// * `friction`: friction coefficient with which the optimum is calculated.
/// * `standard_leads`: leads to choose from if neither lead nor lead angle is given \[m\].
fn pitches(
    case: &Case,
    direction: Direction,
    friction: f64,
    standard_leads: Vec<f64>,
) -> Result<Vec<Pitch>, CaseError> {
    match (case.lead_mm, case.lead_angle_deg) {
        (Some(lead), _) => Ok(vec![Pitch::Lead(lead * MM)]),
        (None, Some(angle)) => Ok(vec![Pitch::Angle(angle * DEG)]),
        (None, None) if direction.is_back() => {
            let contact = case.number(InputKey::contact_angle_deg);
            let lead = Optimum::lead_angle(direction, contact * DEG, friction);
            Ok(vec![Pitch::Angle(lead.ok_or_else(|| {
                CaseError::Invalid(format!(
                    "no lead angle has its best efficiency at contact_angle_deg = {contact}; give a larger contact angle, lead_mm or \
                     lead_angle_deg"
                ))
            })?)])
        }
        (None, None) => Ok(standard_leads.into_iter().map(Pitch::Lead).collect()),
    }
}
