//! The parts of the screw torque.

use std::f64::consts::TAU;

use bsm_design::{
    DriveTrain, DutySpeed, Nut, Phase, PhaseMeans, PhasePoint, ProfileSegment, drag_torque, phases,
};
use bsm_dyn::ModelWorkspace;
use bsm_nut::thermal::HeatSources;
use serde_json::{Value, json};

use super::contacts::{Contacts, contacts, nut_at, takes_catalogue_efficiency};
use super::{NEEDS, QUANTITIES};
use crate::case::axis::{Machine, carriage};
use crate::case::warm::ColdNut;
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::number::short;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{MM, RPM};
use crate::{Case, CaseError, InputKey, Numbers, NutReport, Settings};

quantities! { pub(crate) TORQUES, read_torques(&Torques);
    "torque" {
        screw_load_N ["N" "F_a"] Scalar(|t| t.point.load), "axial load, with the moved mass";
        screw_torque_Nm = QUANTITIES Scalar(Torques::at_screw);
        ideal_torque_Nm ["N m"] Scalar(|t| t.ideal), "  of the load, without friction";
        contact_friction_torque_Nm ["N m"] Scalar(|t| t.contacts.friction), "  contacts of the balls";
        preload_drag_beyond_contacts_Nm ["N m"] Scalar(|t| t.drag), "  drag of the preload (catalog rule)";
        seal_torque_Nm ["N m"] Scalar(|t| t.seal), "  seals";
        support_bearing_torque_Nm ["N m"] Scalar(|t| t.bearing), "  support bearings";
        screw_efficiency = QUANTITIES Scalar(Torques::efficiency);
    }
}

/// The screw torque by its parts, in a phase with what follows.
#[derive(Debug, Clone)]
pub struct ScrewTorque {
    /// The numbers.
    pub numbers: Numbers,
    /// The model of the contacts, or the reason without one.
    pub contacts: String,
    /// Axial force of each body of the nut in the warm steady state of an axis \[N\].
    pub bodies: Option<Vec<f64>>,
}

impl ScrewTorque {
    /// Parts of the torque, in the order of a sum: the load, then what turns into heat.
    pub const PARTS: [&str; 5] = [
        "ideal_torque_Nm",
        "contact_friction_torque_Nm",
        "preload_drag_beyond_contacts_Nm",
        "seal_torque_Nm",
        "support_bearing_torque_Nm",
    ];

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.number(name)
    }

    /// The screw torque \[N m\], if the contacts have a solution.
    pub fn torque(&self) -> Option<f64> {
        self.number("screw_torque_Nm")
    }

    /// JSON object.
    pub fn to_json(&self) -> Value {
        let mut map = numbers_json(&self.numbers);
        map.insert("contacts".to_owned(), json!(self.contacts));
        Value::Object(map)
    }
}

/// The torque at a moment of a phase.
#[derive(Clone)]
pub(crate) struct Torques {
    pub(super) point: PhasePoint,
    pub(super) ideal: f64,
    pub(super) contacts: Contacts,
    /// Of returns and lubricant, beyond the contacts of the preload, with its sign.
    drag: f64,
    seal: f64,
    bearing: f64,
}

impl Torques {
    /// * `advance`: for a radian of the screw \[m\]. * `drag`: of the preload beyond its contacts \[N·m\].
    pub(super) fn of(
        case: &Case,
        (advance, drag): (f64, f64),
        point: &PhasePoint,
        contacts: Contacts,
    ) -> Self {
        let moves = point.direction().abs();
        let value = |key| moves * case.value_or_default(key).unwrap_or(0.0);
        Self {
            point: *point,
            ideal: advance * point.load,
            contacts,
            drag: moves * drag,
            seal: value(InputKey::seal_torque_Nm),
            bearing: value(InputKey::support_bearing_torque_Nm),
        }
    }

    /// Its numbers.
    pub(super) fn numbers(&self) -> Numbers {
        read_torques(self, |_| true)
    }

    /// Torque against the motion, positive \[N·m\].
    pub(super) fn friction(&self) -> Option<f64> {
        Some(self.contacts.friction? + self.drag + self.seal + self.bearing)
    }

    /// Torque that the screw takes \[N·m\].
    pub(super) fn at_screw(&self) -> Option<f64> {
        Some(self.ideal + self.point.direction() * self.friction()?)
    }

    /// What each part costs of the power put in, in words.
    pub(super) fn costs(&self) -> Option<String> {
        let input = self.at_screw()?.abs().max(self.ideal.abs());
        let parts = [
            ("contacts", self.contacts.friction?),
            ("drag of the preload", self.drag),
            ("seals", self.seal),
            ("support bearings", self.bearing),
        ];
        let costly = parts.into_iter().filter(|(_, torque)| *torque > 0.0);
        let costs: Vec<_> = costly
            .map(|(part, torque)| format!("{part} {} %", short(100.0 * torque / input)))
            .collect();
        (!costs.is_empty()).then(|| {
            format!(
                "friction takes of the power at the largest load that moves: {}",
                costs.join(", ")
            )
        })
    }

    /// Power out over power in, of the screw with all its parts; `None` if nothing is done, or if the drag is larger than the torque
    /// with which the load drives the screw.
    pub(super) fn efficiency(&self) -> Option<f64> {
        let output = self.ideal * self.point.direction();
        let input = self.at_screw()? * self.point.direction();
        let efficiency = if output > 0.0 { output / input } else { input / output };
        (output != 0.0 && efficiency >= 0.0).then_some(efficiency)
    }
}

/// The torques of a phase.
pub(crate) struct PhaseTorques {
    pub(super) phase: Phase,
    /// At its start and at its end.
    pub(super) ends: [Torques; 2],
    /// Means over its time; `None` without friction.
    pub(super) means: Option<PhaseMeans>,
}

impl PhaseTorques {
    /// * `preload`: of a pair \[N\]. * `at`: the torques at a moment.
    pub(super) fn of(
        phase: &Phase,
        drive: &DriveTrain,
        preload: Option<f64>,
        mut at: impl FnMut(&PhasePoint) -> Result<Torques, CaseError>,
    ) -> Result<Self, CaseError> {
        let [start, end] = phase.ends();
        let ends = [at(&start)?, at(&end)?];
        let mut failed = None;
        let friction = |point: &PhasePoint| match at(point) {
            Ok(torques) => torques.friction(),
            Err(why) => {
                failed = Some(why);
                None
            }
        };
        let means = phase.means(drive, preload, friction);
        failed.map_or(Ok(Self { phase: *phase, ends, means }), Err)
    }

    /// Returns the mean powers of the sources of heat \[W\]; `None` without friction.
    pub(super) fn sources(&self) -> Option<HeatSources> {
        let speed = self.phase.mean_speed().abs();
        let Torques { drag, seal, bearing, .. } = self.heavier();
        let contacts = self.means?.heat - (drag + seal + bearing) * speed;
        let mut parts = [0.0; 2];
        for torques in &self.ends {
            let Contacts { friction, at_raceways, .. } = &torques.contacts;
            let friction = friction.filter(|friction| *friction > 0.0);
            for (part, torque) in parts.iter_mut().zip(at_raceways) {
                // Both ends count alike; a contact without friction has no part.
                *part += 0.5 * friction.map_or(0.0, |friction| torque / friction);
            }
        }
        let at_raceways = parts.map(|part| part * contacts);
        Some(HeatSources {
            contacts: at_raceways,
            balls: contacts - at_raceways.iter().sum::<f64>() + drag * speed,
            seals: seal * speed,
            bearings: bearing * speed,
            motor: 0.0,
        })
    }

    /// The end with the larger load, of equal loads the faster one.
    pub(super) fn heavier(&self) -> &Torques {
        let [start, end] = &self.ends;
        if start.point.heavier(end.point) == start.point { start } else { end }
    }
}

/// The preload of a nut, and its drag on the screw \[N·m\].
pub(crate) struct Preload {
    /// As it is set, at no rise of temperature \[N\].
    pub(super) cold: f64,
    /// With the rises of temperature \[N\].
    pub(super) warm: f64,
    /// As it is measured, by manufacturers' rule.
    pub(super) by_rule: f64,
    /// Of its contacts alone; `None` without friction.
    pub(super) of_contacts: Option<f64>,
    /// Of returns and lubricant, beyond the contacts.
    pub(super) beyond: f64,
}

impl Preload {
    /// That of a nut, if it is preloaded, at a speed \[rad/s\].
    pub(super) fn of(
        case: &Case,
        settings: &Settings,
        machine: &Machine,
        nut: Option<&NutReport>,
        speed: f64,
    ) -> Result<Option<Self>, CaseError> {
        let screw = &machine.axis.screw;
        let by_rule = |preload| drag_torque(preload, screw.lead, screw.lead_angle());
        let by_catalogue = machine.groove.is_none() || takes_catalogue_efficiency(case, settings);
        if let Some(preload) = case.preload_N.filter(|_| by_catalogue) {
            let by_rule = by_rule(preload);
            let given = case.extra_drag_factor.map(|factor| factor * machine.advance() * preload);
            let beyond = given.unwrap_or(by_rule);
            return Ok(Some(Self {
                cold: preload,
                warm: preload,
                by_rule,
                of_contacts: None,
                beyond,
            }));
        }
        let Some(nut) = nut else { return Ok(None) };
        let forces = nut.number("cold_preload_N").zip(nut.number("warm_preload_N"));
        let Some((cold, warm)) = forces.filter(|_| case.is_preloaded()) else { return Ok(None) };
        let of_contacts = if speed > 0.0 && case.given().has_friction() {
            let unloaded = nut_at(case, settings, 0.0, speed)?;
            unloaded.number("friction_heat_W").map(|heat| heat / speed)
        } else {
            None
        };
        let beyond = ColdNut::of(case, settings, machine)?.drag(case, machine) * warm;
        Ok(Some(Self { cold, warm, by_rule: by_rule(cold), of_contacts, beyond }))
    }
}

/// The screw torque at the operating point of its case by its parts: the load with weight and guides of what it moves, contacts
/// of the balls, preload, seals, support bearings. `None` without load, speed or friction.
///
/// # Errors
///
/// [`CaseError`] if the nut or its point has no solution.
pub fn torque_parts(case: &Case, settings: &Settings) -> Result<Option<ScrewTorque>, CaseError> {
    let case = &case.in_warm_state(settings)?;
    let preloaded = case.is_preloaded() && NEEDS.are_met(case.given());
    let point = case.speeds_rpm().zip(case.axial_load_N).zip(case.lead());
    let Some((((screw, turned), force), lead)) = point.filter(|_| case.given().has_friction())
    else {
        return Ok(None);
    };
    let pace = DutySpeed::of_turns((screw - turned) * RPM);
    let point = ProfileSegment::constant(1.0, pace, force);
    let point = phases(&[point], &carriage(case)?, lead * MM)[0].heavier_end();
    let drag = if preloaded {
        let machine = Machine::of(case)?;
        let nut = nut_at(case, settings, point.load, point.speed)?;
        let preload = Preload::of(case, settings, &machine, Some(&nut), point.speed.abs())?;
        preload.map_or(0.0, |preload| preload.beyond)
    } else {
        0.0
    };
    let (advance, work) = (lead * MM / TAU, &mut ModelWorkspace::default());
    let contacts = contacts(case, settings, advance, &point, work)?;
    let torques = Torques::of(case, (advance, drag), &point, contacts);
    let numbers = torques.numbers();
    Ok(Some(ScrewTorque { numbers, contacts: torques.contacts.text, bodies: None }))
}

/// Efficiency of the screw at a moment of a phase for a search over screws, which has no time for all balls of a preloaded
/// nut: one ball under its equal share, and the friction torque of the preload by manufacturers' rule.
///
/// * `nut`: that of the case.
pub(crate) fn quick_efficiency(
    case: &Case,
    settings: &Settings,
    nut: &Nut,
    point: &PhasePoint,
    work: &mut ModelWorkspace,
) -> Option<f64> {
    let preload = case.preload_N.unwrap_or(0.0);
    let single = Case { preload_N: None, ..case.clone() };
    let drag = drag_torque(preload, nut.lead, nut.lead_angle());
    let advance = nut.lead / TAU;
    let contacts = contacts(&single, settings, advance, point, work).ok()?;
    Torques::of(&single, (advance, drag), point, contacts).efficiency()
}
