//! Inputs of a case that are not single numbers: lists, objects, strings and flags for nut, axis
//! and lubricant.

use std::borrow::Cow;

use bsm_design::life::{Contamination, RatingBasis};
use bsm_design::shaft::EndFixity;
use bsm_design::{
    Grade, Make, Objective, PRELOAD_CLASSES, PreloadClass, PreloadMethod, StiffnessAt,
};
use bsm_dyn::{Direction, DrivenPart, lubrication::BaseOil};
use bsm_nut::Flanks;
use bsm_nut::thermal::Coolant;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::names::json_or_text;
use super::phase::{MoveProfile, PhaseEntry};
use crate::{CaseError, DisplayUnits, INPUTS, InputKey, nearest};

macro_rules! entries {
    ($($name:ident: $kind:ty, $about:literal;)*) => {
        /// Inputs of a case other than single numbers.
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct CaseEntries {
            $(
                #[doc = $about]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $name: Option<$kind>,
            )*
        }

        impl CaseEntries {
            /// Names of all entries, in the order of the documentation.
            pub const KEYS: &[&str] = &[$(stringify!($name)),*];

            /// Replaces the entries that are given in `other`.
            pub(crate) fn override_with(&mut self, other: &Self) {
                $(if other.$name.is_some() {
                    self.$name.clone_from(&other.$name);
                })*
            }

            /// Returns an entry as a JSON value, which is null if the entry is not given. Returns
            /// `None` for an unknown key.
            pub fn get(&self, key: &str) -> Option<Value> {
                match key {
                    $(stringify!($name) => Some(json!(self.$name)),)*
                    _ => None,
                }
            }

            /// Removes an entry. Returns false for an unknown key.
            pub(crate) fn remove(&mut self, key: &str) -> bool {
                match key {
                    $(stringify!($name) => self.$name = None,)*
                    _ => return false,
                }
                true
            }
        }
    };
}

entries! {
    project: String, "project, printed in the header of the `axis` sheet";
    drawing: String, "drawing number, printed in the header of the sheet";
    revision: String, "revision, printed in the header of the sheet";
    author: String, "author, printed in the header of the sheet";
    date: String, "date, printed as given in the header of the sheet";
    customer: String, "customer, printed in the header of the sheet";
    remark: String, "remark, printed in the header of the sheet";
    manufacturer: String, "manufacturer of the screw, printed in the order data of the sheet";
    order_code: String, "manufacturer's order code of the screw or the nut, printed in the order data of the sheet";
    display_units: Named<DisplayUnits>,
        "units of screen, sheet, figures and columns: metric, or inch; JSON always has metric units. Defaults to metric";
    circuits: Vec<CircuitEntry>,
        "loaded balls of a nut, circuit by circuit; replaces circuits_count, loaded_turns and loaded_balls_per_turn";
    ring_expansion: bool,
        "true: the ball loads expand the nut radially; the nut is modeled as a tube from the grooves to nut_outer_diameter_mm";
    nut_guidance: Named<Guidance>,
        "guidance of a nut perpendicular to its axis: guided (tilt and lateral displacement are prevented); free (tilt and lateral displacement follow from the loads)";
    nut_anchor: Named<End>,
        "end of the loaded length at which the nut transmits its load to the table; without this input, the nut is assumed to be rigid";
    screw_anchor: Named<End>,
        "end of the loaded length at which a bearing supports the screw; without this input, the screw is assumed to be rigid";
    screw_torsion: bool,
        "true: the torque of the balls twists the screw up to screw_anchor";
    preload_by: Named<PreloadMethod>,
        "preload method of a nut: pair (two nuts against each other); offset (a shifted lead within one nut, which acts as a pair); oversize (balls that press against both flanks). Defaults to oversize if circuits has a single nut body, else to pair";
    preload_class: ClassName,
        "preload class for `axis` and `select`, which replaces preload_N: auto (the smallest preload at which no nut unloads under the largest load); or a class of manufacturers: Z, G0 to G3, GT, P0 to P4, Z0 to Z3";
    preload_arrangement: Named<Arrangement>,
        "arrangement of a preloaded pair: O (the nuts are pushed apart); X (the nuts are pulled together). Defaults to the arrangement that preload_offset_um or the flanks of the circuits determine, else to O";
    ball_deviation_um: Vec<f64>,
        "deviation of the diameter of each ball from the nominal diameter in um, in the order of the circuits";
    lead_error: Vec<LeadErrorEntry>,
        "axial errors of the nut groove relative to the screw groove; the sum of waves (amplitude_um, order per turn, phase_deg) and slopes (slope_um_per_mm, z0_mm)";
    base_oil: Named<BaseOil>,
        "base oil of the lubricant, which determines the properties that are not given; defaults to mineral";
    ball_precession_rad_s: f64,
        "angular velocity of the balls about the axis [rad/s]; determines their centrifugal force in a nut. Defaults to 0";
    driven_part: Named<DrivenPart>,
        "part that the motor turns, for `axis`: screw, or nut with the screw at rest; defaults to nut if nut_speed_rpm is given and the screw is at rest, else to screw";
    support: Named<EndFixity>,
        "supports of the two ends of the screw, for `axis`; a fixed end takes the axial load";
    buckling_support: Named<EndFixity>,
        "end conditions for the buckling of the screw section between fixed bearing and nut; defaults to fixed-fixed (guided table) unless support is supported-supported";
    screw_make: Named<Make>,
        "type of screw and ball return, which determines the largest speed number and the roughness of the groove; defaults to ground";
    accuracy_grade: GradeName,
        "accuracy grade of the screw, for `axis`: P0 to P10 and T5 to T10 of ISO 3408-3, C0 to C10 of JIS B 1192 (THK, NSK, MISUMI); a number alone is a P grade";
    steel: Named<SteelFactor>,
        "melting process of the raceway steel, for the dynamic load rating; defaults to air-melted";
    contamination: Named<Contamination>,
        "cleanliness of the lubricant according to ISO 281, for the modified life: high (sealed and greased for life), normal (with wipers and bellows), typical (without wipers), or severe (open and exposed to chips)";
    kappa_by: Named<KappaBy>,
        "basis of the viscosity ratio of the modified life: film (the film thickness ratio, if groove and roughness are known) or viscosity; defaults to film";
    rating_basis: Named<RatingBasis>,
        "travel for which rated_dynamic_load_N is stated: revolutions (one million revolutions, ISO 3408-5), 100 km, or million inches (one million inches). Defaults to revolutions";
    motor_curve: Vec<MotorCurveRow>,
        "torque-speed curve of the motor, which replaces motor_peak_torque_Nm and motor_rated_torque_Nm: rows of speed_rpm, peak_torque_Nm and continuous_torque_Nm. Between the rows, the torques are interpolated linearly";
    keep_ratings: bool,
        "true: rated_dynamic_load_N and rated_static_load_N are accepted although they differ from the ratings of the groove by more than a factor of 2";
    estimate_groove: bool,
        "false: an incomplete groove is not estimated from nominal_diameter_mm, lead_mm and rated_dynamic_load_N; defaults to true";
    estimated_inputs: Vec<InputName>,
        "inputs that the program has estimated from the load ratings; it estimates them again when it reads the case";
    rated_rigidity_at: Named<StiffnessAt>,
        "load for which rated_rigidity_N_um is stated: an axial load of 0.3 C_a (THK) or 0.28 C_a (HIWIN), or a preload of 0.1 C_a";
    cycle: Vec<PhaseEntry>,
        "cycle of the axis, which replaces axial_load_N and screw_speed_rpm: a list of moves (distance_mm), phases (time_s or share) and dwells (dwell_s), each with force_N and load_factor";
    brake_at_rest: bool,
        "true: a brake holds the load at standstill, so that the motor needs no torque at standstill; defaults to false";
    warm_state: bool,
        "true: calculates the steady-state temperatures that result from friction, and the preload at these temperatures";
    coolant: Named<Coolant>,
        "fluid that flows through a hollow screw; defaults to water";
    drag_rule: bool,
        "false: the preload causes no drag torque except for friction in the contacts; defaults to true, which means that the drag torque follows the manufacturers' rule";
}

impl CaseEntries {
    /// Returns true if an entry has this key.
    pub(crate) fn has_key(key: &str) -> bool {
        Self::KEYS.contains(&key)
    }

    /// Converts the given entries to a JSON object.
    pub(crate) fn to_map(&self) -> Map<String, Value> {
        match json!(self) {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    /// Sets an entry to a JSON value.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] with the path of the invalid value.
    pub(crate) fn set(&mut self, key: String, value: Value) -> Result<(), CaseError> {
        let one = Value::Object(Map::from_iter([(key, value)]));
        let one: Self = serde_path_to_error::deserialize(one)
            .map_err(|e| CaseError::of_value(&e.path().to_string(), &e.inner().to_string()))?;
        self.override_with(&one);
        Ok(())
    }
}

impl CaseEntries {
    /// Sets an entry to the value in a table cell. Text values need no quotes, even if they consist
    /// of digits.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the entry does not permit the value.
    pub(crate) fn set_cell(&mut self, key: &str, cell: &str) -> Result<(), CaseError> {
        self.set(key.to_owned(), json_or_text(cell)?)
            .or_else(|error| self.set(key.to_owned(), Value::from(cell)).map_err(|_| error))
    }
}

/// A circuit of a nut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircuitEntry {
    /// Helix angle at which the loaded arc begins.
    pub start_deg: f64,
    /// Angle of the loaded arc around the screw axis.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub arc_deg: f64,
    /// Number of loaded balls in the circuit.
    pub balls: usize,
    /// Index of the thread on which the circuit lies, from 0.
    #[serde(default)]
    pub start: usize,
    /// Index of the nut body to which the circuit belongs, from 0.
    #[serde(default)]
    pub body: usize,
    /// Flanks of the circuit's groove. Defaults to both flanks if there is a single nut body, and
    /// to one flank if there are several nut bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flank: Option<Named<Flanks>>,
    /// Axial offset of the circuit's groove in the nut.
    #[serde(default)]
    pub offset_um: f64,
    /// Sum of the gaps between the balls of the circuit. Defaults to the value for the whole nut.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub ball_gap_mm: Option<f64>,
}

/// A point of the torque-speed curve of a motor.
#[expect(
    non_snake_case,
    reason = "the names end with units, and some unit symbols are capital letters"
)]
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotorCurveRow {
    /// Speed of the motor.
    #[schemars(extend("minimum" = 0.0))]
    pub speed_rpm: f64,
    /// Peak torque at this speed.
    #[schemars(extend("minimum" = 0.0))]
    pub peak_torque_Nm: f64,
    /// Continuous torque at this speed. If it is missing in a row, only the peak torque is checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub continuous_torque_Nm: Option<f64>,
}

/// One of the two ends of the loaded length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The end with the smallest z.
    Low,
    /// The end with the largest z.
    High,
}

/// Constraint of a nut against tilt and lateral displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guidance {
    /// Tilt and lateral displacement are prevented.
    Guided,
    /// Tilt and lateral displacement result from the loads.
    Free,
}

/// Arrangement of a preloaded pair of nuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// The nuts are pushed apart, either by an oversized spacer or by a shifted lead.
    O,
    /// The nuts are pulled together by an undersized spacer.
    X,
}

/// A preload class, identified by its name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ClassName(&'static (&'static str, PreloadClass));

impl ClassName {
    /// Returns the preload or the play that the class specifies.
    pub(crate) fn class(self) -> PreloadClass {
        self.0.1
    }
}

impl TryFrom<String> for ClassName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let known = PRELOAD_CLASSES.iter().find(|(name, _)| name.eq_ignore_ascii_case(&text));
        known.map(Self).ok_or_else(|| {
            format!("\"{text}\" is not one of {}", names(&PRELOAD_CLASSES).join(", "))
        })
    }
}

impl From<ClassName> for String {
    fn from(word: ClassName) -> Self {
        word.0.0.to_owned()
    }
}

/// Factor `$f_m$` of the dynamic load rating for the melting process of the steel (typical values
/// in ISO 3408-5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteelFactor(pub f64);

/// Quantity on which the viscosity ratio of the modified life is based.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KappaBy {
    /// The viscosity ratio is calculated from the film thickness, if the film thickness is known.
    Film,
    /// The viscosity ratio is calculated from the viscosity alone.
    Viscosity,
}

/// An enumeration whose values have names.
pub trait Choice: Copy + PartialEq + 'static {
    /// All values with their names.
    const NAMES: &'static [(&'static str, Self)];

    /// Returns the name of the value.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, own)| *own == self).map_or("", |(name, _)| name)
    }

    /// Returns the value with the given name.
    fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(own, _)| *own == name).map(|(_, value)| *value)
    }
}

macro_rules! choices {
    ($($kind:ident: $($name:literal = $value:expr),+;)*) => {
        $(impl Choice for $kind {
            const NAMES: &'static [(&'static str, Self)] = &[$(($name, $value)),+];
        })*
    };
}

choices! {
    Arrangement: "O" = Self::O, "X" = Self::X;
    BaseOil: "mineral" = Self::Mineral, "pao" = Self::Pao, "ester" = Self::Ester, "pag" = Self::Pag;
    Contamination: "extreme-cleanliness" = Self::ExtremeCleanliness, "high" = Self::High,
        "normal" = Self::Normal, "slight" = Self::Slight, "typical" = Self::Typical,
        "severe" = Self::Severe, "very-severe" = Self::VerySevere;
    DisplayUnits: "metric" = Self::Metric, "inch" = Self::Inch;
    bool: "false" = false, "true" = true;
    Coolant: "water" = Self::Water, "oil" = Self::Oil;
    Direction: "rotary-to-linear" = Self::RotaryToLinear,
        "linear-to-rotary" = Self::LinearToRotary;
    DrivenPart: "screw" = Self::Screw, "nut" = Self::Nut;
    End: "low" = Self::Low, "high" = Self::High;
    Flanks: "+" = Self::Plus, "-" = Self::Minus, "both" = Self::Both;
    Guidance: "guided" = Self::Guided, "free" = Self::Free;
    KappaBy: "film" = Self::Film, "viscosity" = Self::Viscosity;
    Make: "rolled" = Self::Rolled, "ground" = Self::Ground, "caged" = Self::Caged,
        "high-speed" = Self::HighSpeed;
    MoveProfile: "trapezoidal" = Self::Trapezoidal, "triangular" = Self::Triangular;
    Objective: "mass" = Self::Mass, "efficiency" = Self::Efficiency, "capacity" = Self::Capacity,
        "inertia" = Self::Inertia, "power" = Self::Power;
    PreloadMethod: "pair" = Self::DoubleNut, "offset" = Self::Offset, "oversize" = Self::Oversize;
    StiffnessAt: "0.3 Ca" = Self::Load(0.3), "0.28 Ca" = Self::Load(0.28),
        "preload 0.1 Ca" = Self::Preload(0.1);
    RatingBasis: "revolutions" = Self::Revolutions, "100 km" = Self::Kilometers,
        "million inches" = Self::MillionInches;
    SteelFactor: "air-melted" = Self(1.0), "vacuum-degassed" = Self(1.25),
        "electro-slag" = Self(1.44), "vacuum-remelted" = Self(1.71);
    EndFixity: "fixed-free" = Self::FixedFree, "supported-supported" = Self::SupportedSupported,
        "fixed-supported" = Self::FixedSupported, "fixed-fixed" = Self::FixedFixed;
}

/// A value that a case specifies by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Named<T>(pub T);

impl<T: Choice> Serialize for Named<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de, T: Choice> Deserialize<'de> for Named<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        T::from_name(&word).map(Self).ok_or_else(|| {
            let names: Vec<_> = T::NAMES.iter().map(|(name, _)| format!("`{name}`")).collect();
            serde::de::Error::custom(format!("`{word}` is not one of {}", names.join(", ")))
        })
    }
}

macro_rules! schemas {
    ($([$($of:tt)*] $kind:ty = $schema:tt;)*) => {
        $(impl $($of)* JsonSchema for $kind {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($kind).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        })*
    };
}

schemas! {
    [<T: Choice>] Named<T> = { "type": "string", "enum": names(T::NAMES) };
    [] InputName = { "type": "string", "enum": INPUTS.iter().map(|input| input.name).collect::<Vec<_>>() };
    [] ClassName = { "type": "string", "enum": names(&PRELOAD_CLASSES) };
    // The values are the names of accuracy grades, and numbers that stand for P grades.
    [] GradeName = {
        "type": ["string", "integer"],
        "enum": Grade::all().map(|grade| json!(grade.name)).chain(NUMBERS.map(Value::from)).collect::<Vec<_>>(),
    };
}

fn names<T>(all: &[(&'static str, T)]) -> Vec<&'static str> {
    all.iter().map(|(name, _)| *name).collect()
}

/// An input that is specified by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct InputName(pub InputKey);

impl TryFrom<String> for InputName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        InputKey::named(&name).map(Self).map_err(|error| error.to_string())
    }
}

impl From<InputName> for String {
    fn from(InputName(key): InputName) -> Self {
        key.name().to_owned()
    }
}

/// Numbers that identify P grades if the letter P is omitted.
const NUMBERS: [u8; 6] = [0, 1, 3, 5, 7, 10];

/// An accuracy grade that is specified by its name or, for a P grade, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Value", into = "Value")]
pub struct GradeName {
    /// Accuracy grade to which the name or number refers.
    pub grade: &'static Grade,
    /// Number of a P grade, if the grade was specified without its letter.
    number: Option<u8>,
}

/// Returns the grades with the next lower and the next higher number in the same series, as
/// suggestions for an unknown grade. An example is `P2`, which JIS and GB/T list but the program
/// does not support. The result is empty unless `name` consists of a letter and a number.
fn neighbors(name: &str) -> Vec<&'static str> {
    let split = |name: &str| -> Option<(char, u8)> {
        let letter = name.chars().next().filter(char::is_ascii_alphabetic)?;
        Some((letter.to_ascii_uppercase(), name[1..].parse().ok()?))
    };
    let Some((series, wanted)) = split(name) else { return Vec::new() };
    let numbers = || {
        let numbered = |grade: &'static Grade| Some((split(grade.name)?, grade.name));
        let of_series = Grade::all().filter_map(numbered).filter(|((of, _), _)| *of == series);
        of_series.map(|((_, number), name)| (number, name))
    };
    let smaller = numbers().filter(|(number, _)| *number < wanted).max();
    let larger = numbers().filter(|(number, _)| *number > wanted).min();
    smaller.into_iter().chain(larger).map(|(_, name)| name).collect()
}

impl TryFrom<Value> for GradeName {
    type Error = String;

    fn try_from(value: Value) -> Result<Self, String> {
        let number = value
            .as_f64()
            .and_then(|x| NUMBERS.into_iter().find(|n| (f64::from(*n) - x).abs() <= 0.0));
        let name = number.map(|number| format!("P{number}"));
        let name = name.as_deref().or(value.as_str()).unwrap_or_default();
        let names = || Grade::all().map(|grade| grade.name);
        let grade = Grade::named(name).ok_or_else(|| {
            let mut near = neighbors(name);
            if near.is_empty() {
                near.extend(nearest(&name.to_uppercase(), names()));
            }
            let near = match near.as_slice() {
                [] => String::new(),
                near => format!("; did you mean `{}`?", near.join("` or `")),
            };
            format!("{value} is not one of {}{near}", names().collect::<Vec<_>>().join(", "))
        })?;
        Ok(Self { grade, number })
    }
}

impl From<GradeName> for Value {
    fn from(word: GradeName) -> Self {
        word.number.map_or_else(|| json!(word.grade.name), |number| json!(number))
    }
}

impl GradeName {
    /// Describes the grade. If the grade was specified by its number alone, the text also names the
    /// grade of another standard with which it could be confused.
    pub(crate) fn describe(self) -> String {
        let Grade { name, standard, variation, .. } = self.grade;
        let um = |variation: f64| (1e7 * variation).round() / 10.0;
        let within = format!("{} um within any 300 mm", um(*variation));
        let Some(number) = self.number else {
            let twice = if name.starts_with('T') {
                "; transport screws may have twice this travel deviation (common rule)"
            } else {
                ""
            };
            return format!("accuracy_grade is {name} of {standard}, {within}{twice}");
        };
        let other = Grade::named(&format!("C{number}")).map_or_else(String::new, |other| {
            format!("; {} of {} has {} um", other.name, other.standard, um(other.variation))
        });
        format!("accuracy_grade {number} is read as {name} of {standard}, {within}{other}")
    }
}

/// An axial error of the nut groove relative to the screw groove, in the form of a wave or a slope.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LeadErrorEntry {
    /// Amplitude of a wave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude_um: Option<f64>,
    /// Number of wave periods per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
    /// Phase of the wave. Defaults to 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_deg: Option<f64>,
    /// Change of the axial error per millimeter of travel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope_um_per_mm: Option<f64>,
    /// Axial position at which the sloping error is zero. Defaults to 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z0_mm: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every kind of entry is written exactly as it was read.
    #[test]
    fn entries_round_trip_through_json() {
        let all: Value = serde_json::from_str(
            r#"{
            "project": "a", "drawing": "b", "revision": "c", "author": "d", "date": "e",
            "customer": "f", "remark": "g", "manufacturer": "h", "order_code": "i",
            "display_units": "inch",
            "circuits": [{ "start_deg": 0.0, "arc_deg": 1.0, "balls": 1, "start": 0, "body": 0,
                           "flank": "both", "offset_um": 0.0, "ball_gap_mm": 1.0 }],
            "ring_expansion": true,
            "nut_guidance": "free",
            "nut_anchor": "low",
            "screw_anchor": "high",
            "screw_torsion": true,
            "preload_by": "oversize",
            "preload_class": "auto",
            "preload_arrangement": "O",
            "ball_deviation_um": [1.0],
            "lead_error": [{ "amplitude_um": 1.0, "order": 1.0, "phase_deg": 1.0,
                             "slope_um_per_mm": 1.0, "z0_mm": 1.0 }],
            "base_oil": "pao",
            "ball_precession_rad_s": 1.0,
            "driven_part": "nut",
            "support": "fixed-supported",
            "buckling_support": "fixed-fixed",
            "screw_make": "ground",
            "accuracy_grade": "C3",
            "steel": "electro-slag",
            "contamination": "very-severe",
            "kappa_by": "viscosity",
            "rating_basis": "100 km",
            "motor_curve": [{ "speed_rpm": 0.0, "peak_torque_Nm": 2.0, "continuous_torque_Nm": 1.0 }],
            "keep_ratings": true,
            "estimate_groove": false,
            "estimated_inputs": ["ball_diameter_mm"],
            "rated_rigidity_at": "0.28 Ca",
            "cycle": [{ "time_s": 1.0, "force_N": 1.0, "feed_m_min": 1.0, "acceleration_m_s2": 1.0,
                        "load_factor": 1.5 },
                      { "distance_mm": -300.0, "time_s": 2.0, "profile": "triangular" },
                      { "dwell_s": 1.0 }],
            "brake_at_rest": true,
            "warm_state": true,
            "coolant": "oil",
            "drag_rule": false
        }"#,
        )
        .expect("JSON");
        let mut words = CaseEntries::default();
        for (key, value) in all.as_object().expect("an object") {
            words.set(key.clone(), value.clone()).expect(key);
        }
        assert_eq!(Value::Object(words.to_map()), all);
        assert_eq!(words.to_map().keys().collect::<Vec<_>>(), CaseEntries::KEYS);
    }
}
