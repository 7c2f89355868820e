//! From the inputs of a scene to the axis in SI.

use std::f64::consts::TAU;

use bsm_design::{
    Axis, Drive, DutySpeed, Hardness, MachineTable, Motion, Mount, Nut, NutBody, RatingFactors,
    Support, Thread, reliability_factor, screw_inertia,
};

use crate::case::rated_nut;
use crate::case::rated_screw::RatedScrew;
use crate::vocabulary::units::{DEG, MM, RPM};
use crate::vocabulary::words::{SteelWord, SupportWord};
use crate::{CaseError, InputKey, PhaseWords, Scene};

/// The axis of a scene, with what turns and moves in it.
#[derive(Debug, Clone)]
pub(crate) struct Machine {
    pub(crate) axis: Axis,
    /// Dynamic and static load rating \[N\], calculated or of the maker, without factors.
    pub(crate) ratings: [f64; 2],
    /// The nut and its thread; `None` of a screw of which only the ratings are known.
    pub(crate) groove: Option<(Nut, Thread)>,
    pub(crate) body: NutBody,
    pub(crate) carriage: MachineTable,
    pub(crate) drive: Drive,
    /// Mass \[kg\] and moment of inertia \[kg·m²\] of the screw; `None` without a length.
    pub(crate) screw: Option<(f64, f64)>,
    /// What was estimated, in words.
    pub(crate) assumed: Vec<String>,
}

impl Machine {
    /// The axis of a scene, without the preload, which its nut tells.
    pub(crate) fn of(scene: &Scene) -> Result<Self, CaseError> {
        scene.check()?;
        let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
        let (groove, RatedScrew { screw: size, body, assumed }) = if scene.has_ratings_only() {
            (None, RatedScrew::of(scene)?)
        } else {
            let nut = rated_nut::nut(scene)?;
            let thread = rated_nut::thread(scene, &nut)?;
            let body = rated_nut::body(scene, &nut, &thread)?;
            rated_nut::compared(scene, &nut)?;
            let screw = nut.screw(&thread);
            (Some((nut, thread)), RatedScrew { screw, body, assumed: Vec::new() })
        };
        let calculated = groove.as_ref().map(|(nut, _)| nut);
        let dynamic = || calculated.map(|nut| nut.dynamic_rating().rating);
        let rated = || calculated.map(|nut| nut.static_rating().rating);
        let ratings = [
            scene.rated_dynamic_load_N.or_else(dynamic).unwrap_or(f64::NAN),
            scene.rated_static_load_N.or_else(rated).unwrap_or(f64::NAN),
        ];
        let factors = rating_factors(scene);
        let stroke = scene.stroke_mm.map(|mm| mm * MM);
        let shaft = mount(scene).shaft(&size, body.length, stroke);
        let carriage = carriage(scene);
        let screw = shaft.as_ref().map(|shaft| {
            let mass = size.mass_per_length * shaft.length;
            (mass, screw_inertia(shaft.length, mass))
        });
        let of_screw = screw.map_or(0.0, |(_, inertia)| inertia);
        let drive = Drive {
            lead: size.lead,
            screw_inertia: of_screw + value(InputKey::coupling_inertia_kg_m2),
            mass: carriage.mass,
            gear_ratio: value(InputKey::gear_ratio),
            motor_inertia: value(InputKey::motor_inertia_kg_m2),
        };
        let phase = |motion: &Motion| motion.phase(&carriage, size.lead);
        let axis = Axis {
            screw: size,
            shaft,
            phases: motions(scene)?.iter().map(phase).collect(),
            dynamic_rating: factors.dynamic_rating * ratings[0],
            static_rating: factors.static_rating * ratings[1],
            preload: None,
            compression: -scene.screw_tension_N.unwrap_or(0.0).min(0.0),
            reliability: reliability(scene),
        };
        Ok(Self { axis, ratings, groove, body, carriage, drive, screw, assumed })
    }

    /// Advance for a radian of the screw \[m\].
    pub(crate) fn advance(&self) -> f64 {
        self.axis.screw.lead / TAU
    }
}

/// The load that the axis of a scene moves.
pub(crate) fn carriage(scene: &Scene) -> MachineTable {
    let value = |key| scene.value_or_default(key).unwrap_or(f64::NAN);
    MachineTable {
        mass: value(InputKey::moved_mass_kg),
        inclination: value(InputKey::inclination_deg) * DEG,
        friction: value(InputKey::guide_friction),
    }
}

/// Over which its accuracy grade limits the error of the travel \[m\].
pub(crate) fn useful_travel(scene: &Scene) -> Option<f64> {
    scene.useful_travel_mm.or(scene.stroke_mm).map(|mm| mm * MM)
}

/// Ends and length of its screw.
pub(crate) fn mount(scene: &Scene) -> Mount {
    Mount {
        support: scene.nut.support.map_or(Support::FixedSupported, Support::from),
        length: scene.unsupported_length_mm.map(|mm| mm * MM),
        diameter: scene.shaft_diameter_mm.map(|mm| mm * MM),
    }
}

/// Factors of its load ratings: of makers' ones that of accuracy only where it is given, as they are printed for their own grade.
pub(crate) fn rating_factors(scene: &Scene) -> RatingFactors {
    let own = scene.rated_dynamic_load_N.or(scene.rated_static_load_N).is_none();
    let grade = scene.nut.accuracy_grade.filter(|_| own);
    let by_grade = grade.map_or(1.0, |word| word.grade.rating_factor());
    let hardness = scene.hardness_HRC.map(Hardness::Rockwell);
    let hardness = hardness.or(scene.hardness_HV10.map(Hardness::Vickers));
    let steel = scene.nut.steel.map_or(1.0, SteelWord::factor);
    RatingFactors::of(hardness, scene.accuracy_factor.unwrap_or(by_grade), steel)
}

/// Life at the reliability of a scene over that at 90 %.
pub(crate) fn reliability(scene: &Scene) -> f64 {
    scene.value_or_default(InputKey::reliability_percent).map_or(1.0, reliability_factor)
}

/// The stretches of the cycle, or the one of the operating point.
pub(crate) fn motions(scene: &Scene) -> Result<Vec<Motion>, CaseError> {
    let load_factor = scene.value_or_default(InputKey::load_factor).unwrap_or(f64::NAN);
    let motion = |words: &PhaseWords| Motion {
        time: words.time(),
        force: words.force_N,
        pace: words.pace(),
        acceleration: words.acceleration_m_s2,
        load_factor: words.load_factor.unwrap_or(load_factor),
    };
    if let Some(cycle) = &scene.nut.cycle {
        let timed = cycle.iter().filter(|phase| phase.time_s.is_some()).count();
        if cycle.is_empty() || (timed > 0 && timed < cycle.len()) {
            let what =
                "must be a list of phases that all have time_s, or all have share".to_owned();
            return Err(CaseError::BadEntry { key: "cycle".to_owned(), what });
        }
        return Ok(cycle.iter().map(motion).collect());
    }
    let pace = match (scene.feed_m_min, scene.speeds_rpm()) {
        (Some(feed), _) if scene.nut_speed_rpm.is_none() => Some(DutySpeed::Feed(feed / 60.0)),
        (_, speeds) => speeds.map(|(screw, nut)| DutySpeed::Turns((screw - nut) * RPM)),
    };
    let missing = |absent: bool, words: &str| absent.then(|| words.to_owned());
    let (Some(pace), Some(force)) = (pace, scene.axial_load_N) else {
        let missing = [
            missing(scene.axial_load_N.is_none(), "axial_load_N (or cycle)"),
            missing(pace.is_none(), "screw_speed_rpm or feed_m_min (or cycle)"),
        ];
        return Err(CaseError::Missing {
            missing: missing.into_iter().flatten().collect(),
            by: "for the axis".to_owned(),
        });
    };
    Ok(vec![Motion { time: 1.0, force, pace, acceleration: 0.0, load_factor }])
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
