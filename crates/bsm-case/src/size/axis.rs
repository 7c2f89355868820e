//! From the inputs of a scene to the axis in SI.

use std::f64::consts::TAU;

use bsm_design::{
    Body, Carriage, Drive, Duty, Nut, Shaft, StaticRating, Support, Thread, rod_inertia,
};

use crate::nut::SupportWord;
use crate::units::{DEG, MM, RPM};
use crate::{CaseError, InputKey, PhaseWords, Scene, capacity};

/// Leads that the screw is longer than stroke and nut, unless its length is given.
const OVERRUN_LEADS: f64 = 2.0;

/// A phase of the cycle in SI.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phase {
    /// Time, in any unit that all phases share.
    pub(super) time: f64,
    /// Axial load of the screw \[N\], positive against a positive feed.
    pub(super) load: f64,
    /// Speed of the screw against the nut \[rad/s\].
    pub(super) speed: f64,
    /// Acceleration along a positive feed \[m/s²\].
    pub(super) acceleration: f64,
}

/// The axis of a scene.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) nut: Nut,
    pub(super) thread: Thread,
    pub(super) body: Body,
    /// `None` without a length.
    pub(super) shaft: Option<Shaft>,
    pub(super) carriage: Carriage,
    pub(super) drive: Drive,
    pub(super) screw_inertia: Option<f64>,
    pub(super) dynamic_rating: f64,
    pub(super) static_rating: StaticRating,
    pub(super) phases: Vec<Phase>,
}

impl Axis {
    pub(super) fn of(scene: &Scene) -> Result<Self, CaseError> {
        scene.check()?;
        let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
        let nut = capacity::nut(scene)?;
        let thread = capacity::thread(scene, &nut)?;
        let body = capacity::body(scene, &nut, &thread)?;
        let stroke = scene.stroke_mm.map(|mm| mm * MM);
        let usual = stroke.map(|stroke| stroke + body.length + OVERRUN_LEADS * nut.lead);
        let length = scene.unsupported_length_mm.map(|mm| mm * MM).or(usual);
        let support = scene.nut.support.map_or(Support::FixedSupported, Support::from);
        let diameter = scene.shaft_diameter_mm.map_or(thread.screw.core, |mm| mm * MM);
        let shaft = length.map(|length| Shaft {
            support,
            length,
            diameter,
            youngs_modulus: nut.material.0.youngs_modulus,
        });
        let carriage = Carriage {
            mass: value(InputKey::moved_mass_kg),
            inclination: value(InputKey::inclination_deg) * DEG,
            friction: value(InputKey::guide_friction),
        };
        // Between core and land.
        let screw_inertia = length.map(|length| rod_inertia(length, nut.pitch_diameter));
        let drive = Drive {
            lead: nut.lead,
            screw_inertia: screw_inertia.unwrap_or(0.0) + value(InputKey::coupling_inertia_kg_m2),
            mass: carriage.mass,
            gear_ratio: value(InputKey::gear_ratio),
            motor_inertia: value(InputKey::motor_inertia_kg_m2),
        };
        let static_rating = nut.static_rating();
        let rating = scene.rated_static_load_N.unwrap_or(static_rating.rating);
        Ok(Self {
            phases: phases(scene, &nut, &carriage)?,
            shaft,
            carriage,
            drive,
            screw_inertia,
            dynamic_rating: scene.rated_dynamic_load_N.unwrap_or(nut.dynamic_rating().rating),
            static_rating: StaticRating { rating, ..static_rating },
            nut,
            thread,
            body,
        })
    }

    /// Advance for a radian of the screw \[m\].
    pub(super) fn advance(&self) -> f64 {
        self.nut.lead / TAU
    }

    /// The cycle, for the life.
    pub(super) fn duty(&self) -> Vec<Duty> {
        let duty = |phase: &Phase| Duty { load: phase.load, speed: phase.speed, time: phase.time };
        self.phases.iter().map(duty).collect()
    }

    /// The phase of the largest load, by its size.
    pub(super) fn heaviest(&self) -> Option<&Phase> {
        self.phases.iter().max_by(|a, b| a.load.abs().total_cmp(&b.load.abs()))
    }

    /// Largest speed of the screw \[rad/s\].
    pub(super) fn fastest(&self) -> f64 {
        self.phases.iter().map(|phase| phase.speed.abs()).fold(0.0, f64::max)
    }

    /// Largest axial load by its size \[N\].
    pub(super) fn largest_load(&self) -> f64 {
        self.heaviest().map_or(0.0, |phase| phase.load.abs())
    }
}

/// The phases of the cycle, or the one of the operating point.
fn phases(scene: &Scene, nut: &Nut, carriage: &Carriage) -> Result<Vec<Phase>, CaseError> {
    let phase = |words: &PhaseWords| Phase {
        time: words.time(),
        load: carriage.load(words.force_N, words.feed(), words.acceleration_m_s2),
        speed: words.feed() * TAU / nut.lead,
        acceleration: words.acceleration_m_s2,
    };
    if let Some(cycle) = &scene.nut.cycle {
        let timed = cycle.iter().filter(|phase| phase.time_s.is_some()).count();
        if cycle.is_empty() || (timed > 0 && timed < cycle.len()) {
            let what =
                "must be a list of phases that all have time_s, or all have share".to_owned();
            return Err(CaseError::BadEntry { key: "cycle".to_owned(), what });
        }
        return Ok(cycle.iter().map(phase).collect());
    }
    let (speeds, load) = (scene.speeds_rpm(), scene.axial_load_N);
    let missing = |absent: bool, words: &str| absent.then(|| words.to_owned());
    let (Some((screw, turned)), Some(force)) = (speeds, load) else {
        let missing = [
            missing(load.is_none(), "axial_load_N (or cycle)"),
            missing(speeds.is_none(), "screw_speed_rpm or feed_m_min (or cycle)"),
        ];
        return Err(CaseError::MissingForAxis { missing: missing.into_iter().flatten().collect() });
    };
    let speed = (screw - turned) * RPM;
    let load = carriage.load(force, speed, 0.0);
    Ok(vec![Phase { time: 1.0, load, speed, acceleration: 0.0 }])
}

impl From<SupportWord> for Support {
    fn from(word: SupportWord) -> Self {
        match word {
            SupportWord::FixedFree => Self::FixedFree,
            SupportWord::SupportedSupported => Self::SupportedSupported,
            SupportWord::FixedSupported => Self::FixedSupported,
            SupportWord::FixedFixed => Self::FixedFixed,
        }
    }
}
