//! The catalogue of nuts in the vocabulary: its lists, its columns, and what may be asked of them.

use bsm_design::{Candidate, Limits, Lists, front};
use bsm_dyn::Material;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::vocabulary::units::{DEG, GPA, MM, UM};
use crate::{CaseError, INPUTS, InputKey, Known, RequirementFile, entries, nearest};

/// The standard lists and limits, to copy and edit.
pub const STANDARD_CATALOGUE: &str = include_str!("catalogue.json");

/// Combinations that a list may make.
const MOST: usize = 20_000_000;

/// Nuts that are compared at a time.
const PART: usize = 1 << 16;

/// Least length in a list \[mm\].
const LEAST: f64 = 1e-3;

/// Lists of sizes, and the limits that a combination must keep.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalogue {
    /// The sizes.
    pub lists: Lists,
    /// The limits.
    pub limits: Limits,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "names carry their unit as it is written")]
struct File {
    nominal_diameter_mm: Vec<f64>,
    lead_mm: Vec<f64>,
    ball_diameter_mm: Vec<f64>,
    loaded_turns: Vec<f64>,
    conformity: Vec<f64>,
    contact_angle_deg: Vec<f64>,
    largest_ball_over_lead: f64,
    largest_ball_over_screw_root: f64,
    largest_ball_gap_over_ball: f64,
    axial_play_um: f64,
    turns_range: (f64, f64),
    conformity_range: (f64, f64),
    youngs_modulus_GPa: f64,
    poisson_ratio: f64,
    preload_over_dynamic_rating: f64,
    rolling_friction_mm: f64,
}

impl Catalogue {
    /// The standard lists of ISO 3408-2, balls in stock, and the limits of Sobolewski (2002).
    ///
    /// # Errors
    ///
    /// None; the lists are compiled in.
    pub fn standard() -> Result<Self, CaseError> {
        Self::from_json(b"{}")
    }

    /// Reads lists and limits; what is not given is standard.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for syntax, unknown keys, values out of range, or too many combinations.
    pub fn from_json(json: &[u8]) -> Result<Self, CaseError> {
        let mut all: Map<String, Value> =
            serde_json::from_str(STANDARD_CATALOGUE).map_err(CaseError::Syntax)?;
        for (key, value) in entries(json)? {
            if !all.contains_key(&key) {
                let nearest = nearest(&key, all.keys().map(String::as_str));
                return Err(CaseError::unknown(Known::List, &key, nearest));
            }
            all.insert(key, value);
        }
        let file: File = serde_path_to_error::deserialize(Value::Object(all)).map_err(|e| {
            CaseError::BadEntry { key: e.path().to_string(), what: e.inner().to_string() }
        })?;
        file.catalogue()
    }

    /// Places of the nuts within the limits among all combinations, in the order of the lists: a nut
    /// takes sixty times the memory of its place, and is made again where it is looked at.
    pub fn places(&self) -> Vec<u32> {
        self.lists.places(&self.limits)
    }

    /// What `each` makes of the nuts of some places, in their order.
    pub fn map<R: Send>(
        &self,
        places: &[u32],
        each: impl Fn(u32, &Candidate) -> Option<R> + Sync + Send,
    ) -> Vec<R> {
        self.lists.map(&self.limits, places, each)
    }

    /// Leaves the places of the nuts that no other one beats in dynamic rating, rigidity and mass.
    #[must_use]
    pub fn pareto(&self, places: &[u32]) -> Vec<u32> {
        let mut best: Vec<(u32, [f64; 3])> = Vec::new();
        // Who is beaten within a part is beaten by the whole.
        for part in places.chunks(PART) {
            best.extend(self.map(part, |place, nut| Some((place, nut.costs()))));
            let costs: Vec<_> = best.iter().map(|(_, costs)| *costs).collect();
            best = front(&costs).into_iter().map(|i| best[i]).collect();
        }
        best.into_iter().map(|(place, _)| place).collect()
    }
}

impl File {
    fn catalogue(&self) -> Result<Catalogue, CaseError> {
        let scaled = |key: &str, list: &[f64], below: f64, unit: f64| {
            if list.is_empty() {
                let what = "the list is empty".to_owned();
                return Err(CaseError::BadEntry { key: key.to_owned(), what });
            }
            let one = |value: &f64| {
                if key.ends_with("_mm") && (0.0..LEAST).contains(value) && *value > 0.0 {
                    let (value, rule) = (*value, format!(">= {LEAST}"));
                    return Err(CaseError::OutOfRange { key: key.to_owned(), value, rule });
                }
                positive(key, *value, below).map(|v| v * unit)
            };
            list.iter().map(one).collect()
        };
        let any = f64::INFINITY;
        let lists = Lists {
            diameters: scaled("nominal_diameter_mm", &self.nominal_diameter_mm, 1e4, MM)?,
            leads: scaled("lead_mm", &self.lead_mm, 1e4, MM)?,
            balls: scaled("ball_diameter_mm", &self.ball_diameter_mm, 1e3, MM)?,
            turns: scaled("loaded_turns", &self.loaded_turns, any, 1.0)?,
            conformities: scaled("conformity", &self.conformity, any, 1.0)?,
            contact_angles: scaled("contact_angle_deg", &self.contact_angle_deg, 90.0, DEG)?,
        };
        if lists.len() > MOST {
            return Err(CaseError::GridTooLarge { limit: MOST });
        }
        for (key, (low, high)) in
            [("turns_range", self.turns_range), ("conformity_range", self.conformity_range)]
        {
            if low > high {
                let what = format!("from {low} to {high} is no range");
                return Err(CaseError::BadEntry { key: key.to_owned(), what });
            }
        }
        let (low, high) = self.conformity_range;
        for value in [low, high] {
            if value <= 0.5 {
                let (key, rule) = ("conformity_range".to_owned(), "> 0.5".to_owned());
                return Err(CaseError::OutOfRange { key, value, rule });
            }
        }
        let steel = Material {
            youngs_modulus: positive("youngs_modulus_GPa", self.youngs_modulus_GPa, any)? * GPA,
            poisson_ratio: positive("poisson_ratio", self.poisson_ratio, 0.5)?,
        };
        Ok(Catalogue {
            lists,
            limits: Limits {
                ball_over_lead: positive(
                    "largest_ball_over_lead",
                    self.largest_ball_over_lead,
                    any,
                )?,
                ball_over_root: positive(
                    "largest_ball_over_screw_root",
                    self.largest_ball_over_screw_root,
                    any,
                )?,
                ball_gap: positive(
                    "largest_ball_gap_over_ball",
                    self.largest_ball_gap_over_ball,
                    1.0,
                )?,
                axial_play: self.axial_play()?,
                turns: self.turns_range,
                conformity: self.conformity_range,
                material: (steel, steel),
                preload: positive(
                    "preload_over_dynamic_rating",
                    self.preload_over_dynamic_rating,
                    any,
                )?,
                rolling_lever: positive("rolling_friction_mm", self.rolling_friction_mm, any)? * MM,
            },
        })
    }
}

impl File {
    /// Axial play \[m\].
    fn axial_play(&self) -> Result<f64, CaseError> {
        let key = InputKey::axial_play_um;
        key.input().rule.check(key.name(), self.axial_play_um)?;
        Ok(self.axial_play_um * UM)
    }
}

/// A positive value below a bound.
fn positive(key: &str, value: f64, below: f64) -> Result<f64, CaseError> {
    if value > 0.0 && value < below {
        return Ok(value);
    }
    let rule = if below.is_finite() { format!("> 0 and < {below}") } else { "> 0".to_owned() };
    Err(CaseError::OutOfRange { key: key.to_owned(), value, rule })
}

/// A column of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct CatalogueColumn {
    /// Name, with its unit as suffix; that of the vocabulary where it is an input.
    pub name: &'static str,
    /// Unit in words; empty if dimensionless.
    pub unit: &'static str,
    /// Among the few that a screen shows.
    pub brief: bool,
    /// Reads it, in its unit.
    pub read: fn(&Candidate) -> f64,
}

macro_rules! columns {
    ($($name:literal [$unit:literal] $brief:literal $read:expr;)*) => {
        /// All columns, in the order of the tables.
        pub const CATALOGUE_COLUMNS: &[CatalogueColumn] = &[$(CatalogueColumn {
            name: $name,
            unit: $unit,
            brief: $brief,
            read: $read,
        },)*];
    };
}

columns! {
    "nominal_diameter_mm" ["mm"] true |c| c.size.diameter / MM;
    "lead_mm" ["mm"] true |c| c.nut.lead / MM;
    "ball_diameter_mm" ["mm"] true |c| c.nut.ball_diameter / MM;
    "loaded_turns" [""] true |c| c.nut.turns;
    "nut_conformity" [""] true |c| c.nut.conformity.0;
    "screw_conformity" [""] false |c| c.nut.conformity.1;
    "contact_angle_deg" ["deg"] false |c| c.nut.contact_angle / DEG;
    "pitch_circle_diameter_mm" ["mm"] false |c| c.nut.pitch_diameter / MM;
    "loaded_balls_per_turn" [""] false |c| c.nut.balls_per_turn;
    "dynamic_load_rating_N" ["N"] true |c| c.dynamic_rating;
    "static_load_rating_N" ["N"] true |c| c.static_rating;
    "edge_load_N" ["N"] false |c| c.edge_load;
    "rigidity_characteristic_N_um15" ["N/um^1.5"] false |c| c.elasticity.turn * 1e-9;
    "preload_N" ["N"] false |c| c.preload;
    "preloaded_contact_rigidity_N_um" ["N/um"] false |c| c.elasticity.preloaded(c.preload) * UM;
    "preloaded_body_rigidity_N_um" ["N/um"] false |c| 2.0 * c.elasticity.body * UM;
    "preloaded_rigidity_N_um" ["N/um"] true |c| c.rigidity * UM;
    "nut_outer_diameter_mm" ["mm"] false |c| c.body.outer / MM;
    "nut_length_mm" ["mm"] false |c| c.body.length / MM;
    "mass_kg" ["kg"] true |c| c.mass;
    "rolling_efficiency" [""] true |c| c.efficiency;
    "ball_gap_mm" ["mm"] false |c| c.nut.ball_gap() / MM;
    "axial_play_um" ["um"] false |c| c.thread.play / UM;
    "nut_groove_radius_mm" ["mm"] false |c| c.thread.nut.radius / MM;
    "screw_groove_radius_mm" ["mm"] false |c| c.thread.screw.radius / MM;
    "nut_groove_offset_mm" ["mm"] false |c| c.thread.nut.offset / MM;
    "screw_groove_offset_mm" ["mm"] false |c| c.thread.screw.offset / MM;
    "nut_core_diameter_mm" ["mm"] false |c| c.thread.nut.core / MM;
    "screw_core_diameter_mm" ["mm"] false |c| c.thread.screw.core / MM;
    "nut_root_diameter_mm" ["mm"] false |c| c.thread.nut.root / MM;
    "screw_root_diameter_mm" ["mm"] false |c| c.thread.screw.root / MM;
    "nut_bore_mm" ["mm"] false |c| c.thread.nut.land / MM;
    "screw_outer_diameter_mm" ["mm"] false |c| c.thread.screw.land / MM;
}

impl CatalogueColumn {
    /// The column of that name.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`] with the nearest one.
    pub fn named(name: &str) -> Result<&'static Self, CaseError> {
        CATALOGUE_COLUMNS.iter().find(|column| column.name == name).ok_or_else(|| {
            let names = CATALOGUE_COLUMNS.iter().map(|column| column.name);
            CaseError::unknown(Known::Column, name, nearest(name, names))
        })
    }
}

/// What is asked of a number: its name, and a range.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Its name.
    pub name: String,
    least: f64,
    most: f64,
}

/// A condition on a column.
#[derive(Debug, Clone)]
pub struct Condition {
    column: &'static CatalogueColumn,
    asked: Asked,
}

impl Asked {
    /// Parses `name>=value`, `name<=value` or `name=value`.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form or no number.
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let form = "name>=value, name<=value or name=value";
        let bad = || CaseError::BadSetting { text: text.to_owned(), form };
        let at = text.find(['<', '>', '=']).ok_or_else(bad)?;
        let sign =
            if text[at..].starts_with('=') { "=" } else { text.get(at..at + 2).ok_or_else(bad)? };
        let value: f64 = text[at + sign.len()..].trim().parse().map_err(|_| bad())?;
        // Tables are in decimals, which sizes in metres do not meet to the last bit.
        let near = 1e-9 * value.abs();
        let (least, most) = match sign {
            ">=" => (value - near, f64::INFINITY),
            "<=" => (f64::NEG_INFINITY, value + near),
            "=" => (value - near, value + near),
            _ => return Err(bad()),
        };
        if value.is_nan() {
            return Err(bad());
        }
        Ok(Self { name: text[..at].trim().to_owned(), least, most })
    }

    /// True if a value is within the range.
    pub fn is_met(&self, value: f64) -> bool {
        (self.least..=self.most).contains(&value)
    }
}

impl Condition {
    /// What is asked of a column.
    ///
    /// # Errors
    ///
    /// [`CaseError::Unknown`].
    pub fn on(asked: Asked) -> Result<Self, CaseError> {
        Ok(Self { column: CatalogueColumn::named(&asked.name)?, asked })
    }

    /// Parses a condition, see [`Asked::parse`].
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form, an unknown column or no number.
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        Self::on(Asked::parse(text)?)
    }

    /// True if a nut meets it.
    pub fn is_met(&self, candidate: &Candidate) -> bool {
        self.asked.is_met((self.column.read)(candidate))
    }

    /// What it asks of.
    pub fn column(&self) -> &'static CatalogueColumn {
        self.column
    }

    /// The value that comes nearest to it, if there are any.
    pub fn nearest_of(&self, values: &[f64]) -> Option<f64> {
        let miss = |value: f64| (self.asked.least - value).max(value - self.asked.most);
        values.iter().copied().min_by(|a, b| miss(*a).total_cmp(&miss(*b)))
    }
}

/// A nut as JSON object with the names of the columns.
pub fn candidate_json(candidate: &Candidate) -> Map<String, Value> {
    let entry = |c: &CatalogueColumn| (c.name.to_owned(), json!((c.read)(candidate)));
    CATALOGUE_COLUMNS.iter().map(entry).collect()
}

/// A nut as the scene of every other command: with a requirement at its operating point.
pub fn candidate_scene(candidate: &Candidate, wish: Option<&RequirementFile>) -> Value {
    if let Some(wish) = wish {
        return wish.scene_of(&candidate.nut).to_json();
    }
    let mut nut = candidate_json(candidate);
    nut.retain(|name, _| INPUTS.iter().any(|input| input.name == name));
    let races = candidate.nut.material.0;
    nut.insert("youngs_modulus_GPa".to_owned(), json!(races.youngs_modulus / GPA));
    nut.insert("poisson_ratio".to_owned(), json!(races.poisson_ratio));
    Value::Object(nut)
}
