//! From the inputs of a scene to the nut in SI.

use std::array::from_fn;
use std::f64::consts::TAU;

use bsm_design::{Body, DynamicRating, Nut, StaticRating};
use bsm_dyn::Ball;
use bsm_kin::{Drive, Helix};
use bsm_nut::{
    BallNut, Bar, Circuit, Equilibrium, Errors, Flanks, Freedom, LeadError, NutError, Preload,
    Ring, Support, TurnRatings,
};

use super::samples::draw;
use super::words::{
    BarWords, CircuitWords, End, Flank, Guidance, LeadErrorWords, NutWords, PreloadWay,
};
use crate::reader::has_grooves;
use crate::units::{DEG, MM, UM};
use crate::{CaseError, InputKey, InputSet, ModelChoice, Rule, Scene, Settings, capacity};

/// Inputs of which a nut takes more than the models of one ball: it may be pulled or not loaded, and
/// a lead or a contact angle of zero makes it a ball bearing.
const WIDER: [(InputKey, Rule); 3] = [
    (InputKey::axial_load_N, Rule::Any),
    (InputKey::lead_mm, Rule::AtLeast(0.0)),
    (InputKey::contact_angle_deg, Rule::Within(0.0, 0.0)),
];

/// Freedoms across the axis: load, displacement and spring, and what their units are in SI.
const ACROSS: [([InputKey; 3], [f64; 3]); 4] = {
    use InputKey as K;
    const FORCE: [f64; 3] = [1.0, UM, 1.0 / UM];
    const MOMENT: [f64; 3] = [1.0, 1e-6, 1e3];
    [
        ([K::radial_load_x_N, K::radial_x_um, K::guide_x_N_um], FORCE),
        ([K::radial_load_y_N, K::radial_y_um, K::guide_y_N_um], FORCE),
        ([K::moment_x_Nm, K::tilt_x_urad, K::guide_tilt_x_Nm_mrad], MOMENT),
        ([K::moment_y_Nm, K::tilt_y_urad, K::guide_tilt_y_Nm_mrad], MOMENT),
    ]
};

/// The words that circuits are made from where they are not listed.
const SHORT: [InputKey; 5] = [
    InputKey::circuits_count,
    InputKey::loaded_turns,
    InputKey::loaded_balls_per_turn,
    InputKey::gap_deg,
    InputKey::phase_deg,
];

/// Balls of a nut at most.
const MOST_BALLS: usize = 100_000;

/// How large a preload is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Amount {
    /// Axial force \[N\].
    Force(f64),
    /// Offset of the bodies, or excess of the diameter of the balls \[m\].
    Displacement(f64),
}

/// A nut under load as a scene describes it.
#[derive(Debug, Clone)]
pub struct NutProblem {
    /// Before it is preloaded, and without the random part of its errors.
    pub(super) nut: BallNut,
    pub(super) support: Support,
    preload: Option<(Preload, Amount)>,
    /// Standard deviation of the excess of the balls' radius \[m\].
    scatter: f64,
    pub(super) seed: u64,
    pub(super) design: Nut,
    pub(super) body: Body,
    pub(super) rating: DynamicRating,
    pub(super) static_rating: StaticRating,
    pub(super) ratings: TurnRatings,
    /// Friction coefficient and speeds of screw and nut.
    pub(super) friction: Option<(f64, Drive<f64>)>,
    pub(super) settings: Settings,
    pub(super) notes: Vec<String>,
}

/// A nut that is made and carries its load.
#[derive(Debug, Clone)]
pub(super) struct Made {
    /// With its preload and all its errors.
    pub(super) nut: BallNut,
    pub(super) preload: Option<Set>,
    pub(super) found: Equilibrium,
}

/// The preload of a nut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Set {
    pub(super) by: Preload,
    /// Where nothing is loaded from outside and the nut is guided \[N\].
    pub(super) force: f64,
}

impl NutProblem {
    /// The nut of a scene.
    ///
    /// * `settings`: the model that friction is calculated with, and its dials.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if a value or a word breaks a rule, two words say one thing, or something is missing.
    pub fn of(scene: &Scene, settings: &Settings) -> Result<Self, CaseError> {
        settings.check()?;
        scene.check_for_a_nut()?;
        let missing = scene.missing_for_a_nut();
        if !missing.is_empty() {
            return Err(CaseError::MissingForNut { missing });
        }
        let (nut, way) = ball_nut(scene)?;
        let preload = preload(scene, &nut, way)?;
        let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
        let design = capacity::nut(scene)?;
        let thread = capacity::thread(scene, &design)?;
        let body = capacity::body(scene, &design, &thread)?;
        // Short words leave a fraction of a ball, which no circuit has.
        let design = of_circuits(design, &nut.circuits);
        let (rating, static_rating) = (design.dynamic_rating(), design.static_rating());
        let turns = design.turns.powf(0.86);
        let ratings = TurnRatings {
            screw: scene.screw_rating_N.unwrap_or(rating.screw * turns),
            nut: scene.nut_rating_N.unwrap_or(rating.screw / rating.ratio * turns),
        };
        let nut = bodies(scene, nut, &body)?;
        let drive = scene.reader().drive();
        if let ModelChoice::Fixed(model) = settings.model {
            scene.covered_by(model)?;
            if !has_grooves(model) {
                return Err(CaseError::NoBallOfANut { model: model.name() });
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number"
        )]
        let seed = value(InputKey::seed) as u64;
        Ok(Self {
            support: support(scene)?,
            notes: notes(scene, &nut, preload.map(|(by, _)| by)),
            nut,
            preload,
            scatter: 0.5 * UM * scene.ball_deviation_sd_um.unwrap_or(0.0),
            seed,
            design,
            body,
            rating,
            static_rating,
            ratings,
            friction: scene.friction_coefficient.zip(drive),
            settings: *settings,
        })
    }

    /// Loads of all balls with its preload, friction, life and what follows from them.
    ///
    /// # Errors
    ///
    /// [`NutError`]: nothing carries the load, or no displacement gives the preload.
    pub(super) fn made(&self) -> Result<Made, NutError> {
        if self.scatter > 0.0 { self.drawn(self.seed, 0, &[]).carried() } else { self.carried() }
    }

    /// One of many nuts like this: balls and phases of the lead error are drawn.
    ///
    /// * `waves`: numbers of the errors of the lead whose phase is drawn.
    pub(super) fn drawn(&self, seed: u64, number: u64, waves: &[usize]) -> Self {
        let mut one = self.clone();
        draw(&mut one.nut, self.scatter, waves, seed, number);
        one
    }

    /// True if nuts like this differ.
    pub(super) fn scatters(&self) -> bool {
        self.scatter > 0.0
    }

    /// The nut as it is, preloaded and loaded.
    pub(super) fn carried(&self) -> Result<Made, NutError> {
        let guided = Support::guided(0.0);
        let nut = match self.preload {
            None => self.nut.clone(),
            Some((by, Amount::Displacement(displacement))) => self.nut.preloaded(by, displacement),
            Some((by, Amount::Force(force))) => {
                let displacement = self.nut.preload_displacement(by, force, &guided)?;
                self.nut.preloaded(by, displacement)
            }
        };
        let found = nut.solve(&self.support)?;
        let two = nut.circuits.iter().any(|circuit| circuit.body == 1);
        let by = match self.preload {
            Some((by, _)) => Some(by),
            None if two => Some(Preload::Offset),
            None if nut.errors.oversize > 0.0 => Some(Preload::Oversize),
            None => None,
        };
        let preload = by.and_then(|by| {
            let force = nut.solve(&guided).ok()?.preload(&nut, by);
            (force > 0.0).then_some(Set { by, force })
        });
        Ok(Made { nut, preload, found })
    }
}

impl Scene {
    /// Checks every value as a nut takes it.
    fn check_for_a_nut(&self) -> Result<(), CaseError> {
        let wider = |&(key, rule): &(InputKey, Rule)| {
            let value = self[key]?;
            (rule.holds(value) && !key.input().rule.holds(value)).then_some(key)
        };
        self.check_but(WIDER.iter().filter_map(wider).collect())
    }
}

/// Two inputs that say the same.
fn twice(one: &'static str, other: &'static str) -> CaseError {
    CaseError::OneOfTwo { keys: [one, other], found: "both are" }
}

fn bad(key: impl Into<String>, what: impl Into<String>) -> CaseError {
    CaseError::BadEntry { key: key.into(), what: what.into() }
}

/// Checks a number of an object by its path.
fn checked(rule: Rule, path: &str, value: f64) -> Result<f64, CaseError> {
    rule.check(path, value).map(|()| value)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole numbers by their rules, or rounded, below the most balls"
)]
fn whole(value: f64) -> usize {
    value.round() as usize
}

#[expect(clippy::cast_precision_loss, reason = "numbers of circuits and balls")]
pub(crate) fn count(n: usize) -> f64 {
    n as f64
}

/// Loaded balls of a turn and loaded turns of one body: from the listed circuits or from the short words.
pub(crate) fn balls_and_turns(scene: &Scene) -> (Option<f64>, Option<f64>) {
    let Some(circuits) = &scene.nut.circuits else {
        let by_gap = || {
            let arc = 360.0 - scene.gap_deg?;
            Some(scene.circuits_count? * arc / 360.0)
        };
        return (scene.loaded_balls_per_turn, scene.loaded_turns.or_else(by_gap));
    };
    let first = || circuits.iter().filter(|circuit| circuit.body == 0);
    let turns = first().map(|circuit| circuit.arc_deg).sum::<f64>() / 360.0;
    let balls = first().map(|circuit| circuit.balls).sum::<usize>();
    (Some(count(balls) / turns), Some(turns))
}

/// The nut of the ratings with the balls and turns that the circuits of one body have.
fn of_circuits(design: Nut, circuits: &[Circuit]) -> Nut {
    let first = || circuits.iter().filter(|circuit| circuit.body == 0);
    let turns = first().map(|circuit| circuit.arc).sum::<f64>() / TAU;
    let balls = first().map(|circuit| circuit.balls).sum::<usize>();
    Nut { balls_per_turn: count(balls) / turns, turns, ..design }
}

/// The nut without its elastic bodies, and how it is preloaded if it is.
fn ball_nut(scene: &Scene) -> Result<(BallNut, Preload), CaseError> {
    let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
    let words = &scene.nut;
    let radius = 0.5 * MM * value(InputKey::ball_diameter_mm);
    let (circuits, way) = if let Some(listed) = &words.circuits {
        if let Some(key) = SHORT.into_iter().find(|key| scene[*key].is_some()) {
            return Err(twice("circuits", key.name()));
        }
        let several = listed.iter().any(|circuit| circuit.body > 0);
        let usual = if several { Preload::Offset } else { Preload::Oversize };
        let way = words.preload_by.map_or(usual, Preload::from);
        (listed_circuits(listed, value(InputKey::starts))?, way)
    } else {
        let way = words.preload_by.map_or(Preload::Offset, Preload::from);
        (short_circuits(scene, way)?, way)
    };
    let lead_errors = words.lead_error.as_deref().unwrap_or_default();
    let errors = Errors {
        balls: deviations(words, scene.ball_deviation_sd_um)?,
        oversize: 0.0,
        lead: lead_errors.iter().enumerate().map(lead_error).collect::<Result<_, _>>()?,
        gap: value(InputKey::radial_gap_um) * UM,
    };
    let helix = Helix {
        radius: 0.5 * MM * value(InputKey::pitch_circle_diameter_mm),
        lead_angle: scene.lead_angle().unwrap_or(f64::NAN),
    };
    let precession = words.ball_precession_rad_s.unwrap_or(0.0);
    let nut = BallNut {
        helix,
        starts: whole(value(InputKey::starts)),
        ball: Ball::of_density(radius, value(InputKey::density_kg_m3)),
        contact_angle: value(InputKey::contact_angle_deg) * DEG,
        conformity: (value(InputKey::nut_conformity), value(InputKey::screw_conformity)),
        material: scene.reader().materials(),
        circuits,
        errors,
        nut_bar: None,
        screw_bar: None,
        ring: None,
        reference: scene.reference_z_mm.map(|z| z * MM),
        precession: checked(Rule::Any, "ball_precession_rad_s", precession)?,
    };
    let given = nut.errors.balls.len();
    if given > 0 && given != nut.balls() {
        let what = format!("has {given} numbers, but the nut has {} balls", nut.balls());
        return Err(bad("ball_deviation_um", what));
    }
    let rises = [
        InputKey::nut_temperature_rise_K,
        InputKey::screw_temperature_rise_K,
        InputKey::ball_temperature_rise_K,
    ];
    if rises.iter().all(|key| scene[*key].is_none()) {
        return Ok((nut, way));
    }
    let expansion = value(InputKey::thermal_expansion_um_m_K) * UM;
    Ok((nut.warmed(rises.map(value), expansion), way))
}

impl From<PreloadWay> for Preload {
    fn from(way: PreloadWay) -> Self {
        match way {
            PreloadWay::Pair => Self::Offset,
            PreloadWay::Oversize => Self::Oversize,
        }
    }
}

impl From<Flank> for Flanks {
    fn from(flank: Flank) -> Self {
        match flank {
            Flank::Plus => Self::Plus,
            Flank::Minus => Self::Minus,
            Flank::Both => Self::Both,
        }
    }
}

/// The flank of a body of a pair: each is pressed outwards.
fn flank_of(body: usize) -> Flanks {
    if body.is_multiple_of(2) { Flanks::Plus } else { Flanks::Minus }
}

fn listed_circuits(listed: &[CircuitWords], starts: f64) -> Result<Vec<Circuit>, CaseError> {
    if listed.is_empty() {
        return Err(bad("circuits", "the list is empty"));
    }
    let bodies = 1 + listed.iter().map(|circuit| circuit.body).max().unwrap_or(0);
    if let Some(body) = (0..bodies.min(MOST_BALLS)).find(|b| listed.iter().all(|c| c.body != *b)) {
        return Err(bad("circuits", format!("no circuit belongs to body {body}")));
    }
    let mut balls = 0_usize;
    let mut all = Vec::new();
    for (i, words) in listed.iter().enumerate() {
        let path = |key: &str| format!("circuits[{i}].{key}");
        balls = balls.saturating_add(words.balls);
        if words.balls == 0 || balls > MOST_BALLS {
            let rule = format!("from 1 to {MOST_BALLS} balls in all");
            return Err(CaseError::OutOfRange {
                key: path("balls"),
                value: count(words.balls),
                rule,
            });
        }
        if count(words.start) >= starts {
            let rule = format!("below the number of starts, {starts}");
            return Err(CaseError::OutOfRange {
                key: path("start"),
                value: count(words.start),
                rule,
            });
        }
        all.push(Circuit {
            start: checked(Rule::Any, &path("start_deg"), words.start_deg)? * DEG,
            arc: checked(Rule::Above(0.0), &path("arc_deg"), words.arc_deg)? * DEG,
            balls: words.balls,
            thread: words.start,
            body: words.body,
            flanks: match words.flank {
                Some(flank) => flank.into(),
                None if bodies == 1 => Flanks::Both,
                None => flank_of(words.body),
            },
            offset: checked(Rule::Any, &path("offset_um"), words.offset_um)? * UM,
        });
    }
    Ok(all)
}

/// Circuits of one nut, or of each nut of a pair that is preloaded by an offset.
fn short_circuits(scene: &Scene, way: Preload) -> Result<Vec<Circuit>, CaseError> {
    let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
    let (per_turn, turns) = balls_and_turns(scene);
    let (per_turn, turns) = (per_turn.unwrap_or(f64::NAN), turns.unwrap_or(f64::NAN));
    let (number, starts) = (value(InputKey::circuits_count), value(InputKey::starts));
    let arc = 360.0 * turns / number;
    let balls = (per_turn * arc / 360.0).round();
    if balls < 1.0 || balls * number > count(MOST_BALLS) || !arc.is_finite() || arc <= 0.0 {
        let rule = format!(
            "so that each of {number} circuits has at least 1 ball, and all at most {MOST_BALLS}"
        );
        let key = InputKey::loaded_balls_per_turn.name().to_owned();
        return Err(CaseError::OutOfRange { key, value: per_turn, rule });
    }
    // From the beginning of a circuit to that of the next one of its thread.
    let gap = scene.gap_deg.unwrap_or_else(|| (arc / 360.0).ceil() * 360.0 - arc);
    let (step, phase) = (arc + gap, value(InputKey::phase_deg));
    let pair = way == Preload::Offset && is_preloaded(scene);
    let swapped = scene.preload_offset_um.is_some_and(|offset| offset < 0.0);
    let circuit = |body: usize, from: f64| {
        move |i: usize| Circuit {
            start: (from + (count(i) / starts).floor() * step + count(i) * phase) * DEG,
            arc: arc * DEG,
            balls: whole(balls),
            thread: i % whole(starts),
            body,
            flanks: if pair { flank_of(body + usize::from(swapped)) } else { Flanks::Both },
            offset: 0.0,
        }
    };
    let mut all: Vec<_> = (0..whole(number)).map(circuit(0, 0.0)).collect();
    if pair {
        // The second nut goes on along the helix after a spacer of a turn.
        let end = all.iter().map(|c| (c.start + c.arc) / DEG).fold(0.0, f64::max);
        let next = ((end - 1e-9) / 360.0).ceil() * 360.0 + 360.0;
        all.extend((0..whole(number)).map(circuit(1, next)));
    }
    Ok(all)
}

/// True if an amount of preload between two bodies is given.
fn is_preloaded(scene: &Scene) -> bool {
    scene.preload_N.is_some() || scene.preload_offset_um.is_some()
}

/// Excess of the radius of each ball \[m\].
fn deviations(words: &NutWords, deviation: Option<f64>) -> Result<Vec<f64>, CaseError> {
    let Some(listed) = &words.ball_deviation_um else { return Ok(Vec::new()) };
    if deviation.is_some() {
        return Err(twice("ball_deviation_um", "ball_deviation_sd_um"));
    }
    let one = |(i, value): (usize, &f64)| {
        let value = checked(Rule::Any, &format!("ball_deviation_um[{i}]"), *value)?;
        Ok(0.5 * UM * value)
    };
    listed.iter().enumerate().map(one).collect()
}

fn lead_error((i, words): (usize, &LeadErrorWords)) -> Result<LeadError, CaseError> {
    let path = format!("lead_error[{i}]");
    let LeadErrorWords { amplitude_um, order, phase_deg, slope_um_per_mm, z0_mm } = *words;
    match (amplitude_um, order, slope_um_per_mm) {
        (Some(amplitude), Some(order), None) if z0_mm.is_none() => Ok(LeadError::Wave {
            amplitude: amplitude * UM,
            order,
            phase: phase_deg.unwrap_or(0.0) * DEG,
        }),
        (None, None, Some(slope)) if phase_deg.is_none() => {
            Ok(LeadError::Slope { slope: slope * (UM / MM), origin: z0_mm.unwrap_or(0.0) * MM })
        }
        _ => Err(bad(
            path,
            "must be a wave (amplitude_um, order and, if it is not 0, phase_deg) or a slope \
             (slope_um_per_mm and, if it is not 0, z0_mm)",
        )),
    }
}

/// What preloads the nut, and how much.
fn preload(
    scene: &Scene,
    nut: &BallNut,
    way: Preload,
) -> Result<Option<(Preload, Amount)>, CaseError> {
    use InputKey as K;
    let amounts = [K::preload_N, K::preload_offset_um, K::ball_oversize_um];
    let given: Vec<_> = amounts.into_iter().filter(|key| scene[*key].is_some()).collect();
    let key = match given[..] {
        [] => return Ok(None),
        [key] => key,
        [one, other, ..] => return Err(twice(one.name(), other.name())),
    };
    let value = scene[key].unwrap_or(f64::NAN);
    let by = if key == K::ball_oversize_um { Preload::Oversize } else { way };
    if key == K::preload_offset_um && way == Preload::Oversize {
        return Err(bad(
            key.name(),
            "is of a pair of nuts; balls that are too large have ball_oversize_um",
        ));
    }
    let bodies = 1 + nut.circuits.iter().map(|circuit| circuit.body).max().unwrap_or(0);
    if by == Preload::Offset && bodies != 2 {
        let what = format!("a pair has two bodies, but the circuits have {bodies}");
        return Err(bad(key.name(), what));
    }
    let both = nut.circuits.iter().all(|circuit| circuit.flanks == Flanks::Both);
    if by == Preload::Oversize && key == K::preload_N && !both {
        let what = "balls that are too large press both flanks, but a circuit has one flank only";
        return Err(bad(key.name(), what));
    }
    let amount =
        if key == K::preload_N { Amount::Force(value) } else { Amount::Displacement(value * UM) };
    Ok(Some((by, amount)))
}

/// The nut with bars and ring.
fn bodies(scene: &Scene, mut nut: BallNut, body: &Body) -> Result<BallNut, CaseError> {
    use InputKey as K;
    let words = &scene.nut;
    let bars = words.bars.clone().unwrap_or_default();
    let ends = ends(&nut);
    let made = nut.nut_stiffness(body.outer);
    let keys = [K::nut_EA_N, K::nut_anchor_z_mm];
    nut.nut_bar =
        bar(scene, ("nut", bars.nut), (keys, "nut_anchor", words.nut_anchor), made, ends)?;
    let keys = [K::screw_EA_N, K::screw_anchor_z_mm];
    let made = nut.screw_stiffness();
    nut.screw_bar =
        bar(scene, ("screw", bars.screw), (keys, "screw_anchor", words.screw_anchor), made, ends)?;
    let youngs_modulus = nut.material.0.youngs_modulus;
    nut.ring = match (&words.ring, words.ring_expansion) {
        (Some(_), Some(_)) => return Err(twice("ring", "ring_expansion")),
        (Some(ring), None) => {
            let inner =
                checked(Rule::Above(0.0), "ring.inner_diameter_mm", ring.inner_diameter_mm)?;
            let larger = Rule::Above(inner);
            let outer = checked(larger, "ring.outer_diameter_mm", ring.outer_diameter_mm)?;
            Some(Ring { outer: outer * MM, inner: inner * MM, youngs_modulus })
        }
        (None, Some(true)) => {
            let [_, inner] = nut.groove_diameters();
            Some(Ring { outer: body.outer, inner, youngs_modulus })
        }
        (None, Some(false) | None) => None,
    };
    Ok(nut)
}

/// Places of the first and the last ball along the axis \[m\].
fn ends(nut: &BallNut) -> [f64; 2] {
    let places = nut.places();
    let z = || places.iter().map(|place| place.z);
    [z().fold(f64::INFINITY, f64::min), z().fold(f64::NEG_INFINITY, f64::max)]
}

/// A body as a bar: from an object of `bars`, or from the short words; `None` if neither names an anchor.
///
/// * `made`: stiffness from the diameters \[N\].
fn bar(
    scene: &Scene,
    (name, listed): (&str, Option<BarWords>),
    ([stiffness, place], word, end): ([InputKey; 2], &'static str, Option<End>),
    made: f64,
    ends: [f64; 2],
) -> Result<Option<Bar>, CaseError> {
    let at = |end: End| if end == End::Low { ends[0] } else { ends[1] };
    let short = [stiffness, place].into_iter().find(|key| scene[*key].is_some());
    let short = short.map(InputKey::name).or(end.map(|_| word));
    if let Some(BarWords { EA_N, anchor, anchor_z_mm }) = listed {
        if let Some(short) = short {
            return Err(twice("bars", short));
        }
        let anchor = match (anchor, anchor_z_mm) {
            (Some(end), None) => at(end),
            (None, Some(z)) => z * MM,
            _ => return Err(bad(format!("bars.{name}"), "give one of anchor and anchor_z_mm")),
        };
        let stiffness = checked(Rule::Above(0.0), &format!("bars.{name}.EA_N"), EA_N)?;
        return Ok(Some(Bar { stiffness, anchor }));
    }
    let anchor = match (end, scene[place]) {
        (Some(_), Some(_)) => return Err(twice(word, place.name())),
        (Some(end), None) => at(end),
        (None, Some(z)) => z * MM,
        (None, None) if scene[stiffness].is_some() => {
            let what =
                format!("needs the place where the force leaves: {word} or {}", place.name());
            return Err(bad(stiffness.name(), what));
        }
        (None, None) => return Ok(None),
    };
    Ok(Some(Bar { stiffness: scene[stiffness].unwrap_or(made), anchor }))
}

/// Loads and what holds the nut.
fn support(scene: &Scene) -> Result<Support, CaseError> {
    let free = scene.nut.nut_guidance == Some(Guidance::Free);
    let mut support = Support::guided(scene.axial_load_N.unwrap_or(0.0));
    for (freedom, (keys, units)) in support.0[1..].iter_mut().zip(ACROSS) {
        let given: [Option<f64>; 3] = from_fn(|i| Some(scene[keys[i]]? * units[i]));
        *freedom = match given {
            [_, Some(_), Some(_)] => return Err(twice(keys[1].name(), keys[2].name())),
            [Some(_), Some(_), _] => return Err(twice(keys[0].name(), keys[1].name())),
            [load, None, Some(stiffness)] => {
                Freedom::Sprung { stiffness, load: load.unwrap_or(0.0) }
            }
            [None, Some(displacement), None] => Freedom::Held(displacement),
            [load, None, None] if free => Freedom::Loaded(load.unwrap_or(0.0)),
            [Some(load), None, None] if load != 0.0 => {
                let what = format!(
                    "acts on what the guides hold; set nut_guidance to free, or give {}",
                    keys[2].name()
                );
                return Err(bad(keys[0].name(), what));
            }
            [_, None, None] => Freedom::Held(0.0),
        };
    }
    Ok(support)
}

/// What the words mean where they could be meant otherwise.
fn notes(scene: &Scene, nut: &BallNut, by: Option<Preload>) -> Vec<String> {
    let mut notes = Vec::new();
    if by == Some(Preload::Offset) && scene.nut.circuits.is_none() {
        notes.push(format!(
            "preload makes a pair of nuts with {} balls each, a turn apart; preload_by oversize means \
             one nut with balls that are too large",
            nut.balls() / 2
        ));
    }
    if by == Some(Preload::Oversize) && scene.preload_N.is_some() {
        notes.push("preload_N of one nut is that of balls too large for both flanks".to_owned());
    }
    if let Some(balls) = scene.loaded_balls
        && whole(balls) != nut.balls()
    {
        notes.push(format!(
            "the circuits have {} balls; loaded_balls = {balls} is for the models of one ball",
            nut.balls()
        ));
    }
    notes
}

/// The inputs that only a nut uses, among those that are given, for notes of other commands.
pub(crate) const OF_A_NUT: InputSet = {
    use InputKey as K;
    InputSet::of(&[
        K::preload_N,
        K::preload_offset_um,
        K::ball_oversize_um,
        K::radial_load_x_N,
        K::radial_load_y_N,
        K::moment_x_Nm,
        K::moment_y_Nm,
        K::tilt_x_urad,
        K::tilt_y_urad,
        K::radial_x_um,
        K::radial_y_um,
    ])
};
