//! Individual contributions to the screw torque.

use std::f64::consts::TAU;

use bsm_design::Nut;
use bsm_design::drive::{DriveTrain, drag_torque};
use bsm_design::motion::{DutySpeed, Phase, PhaseMeans, PhasePoint, ProfileSegment, phases};
use bsm_dyn::ModelWorkspace;
use bsm_nut::thermal::HeatSources;
use schemars::JsonSchema;
use serde::Serialize;

use super::contacts::{Contacts, contacts, nut_at, takes_catalog_efficiency};
use super::{NEEDS, NUT, QUANTITIES};
use crate::case::axis::AxisModel;
use crate::case::axis_inputs::carriage;
use crate::case::warm::ColdNut;
use crate::vocabulary::members::{NumbersJson, number_tables};
use crate::vocabulary::number::format_short;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{MM, RPM};
use crate::{Case, CaseError, InputKey, Numbers, NutReport, OutputName, Settings, output};

quantities! { pub(crate) TORQUES, read_torques(&Torques);
    "torque" {
        screw_load_N ["N" "F_a"] Scalar(|t| t.point.load), "axial load, including the moved mass";
        screw_torque_Nm = QUANTITIES Scalar(Torques::at_screw);
        ideal_torque_Nm ["N m"] Scalar(|t| t.ideal), "  axial load, without friction";
        contact_friction_torque_Nm ["N m"] Scalar(|t| t.contacts.friction), "  ball contacts";
        third_contact_torque_Nm = NUT Scalar(|t| t.contacts.third);
        preload_drag_beyond_contacts_Nm ["N m"] Scalar(|t| t.drag), "  preload drag outside the contacts";
        seal_torque_Nm ["N m"] Scalar(|t| t.seal), "  seals";
        support_bearing_torque_Nm ["N m"] Scalar(|t| t.bearing), "  support bearings";
        screw_efficiency = QUANTITIES Scalar(Torques::efficiency);
    }
}

number_tables! {
    /// Contributions to the screw torque.
    pub(crate) TorqueNumbers = TORQUES.iter();
}

/// Contributions to the screw torque in JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct TorqueParts {
    #[serde(flatten)]
    numbers: NumbersJson<TorqueNumbers>,
    /// Name of the contact model, or the reason why there is no contact torque.
    contacts: String,
}

/// The screw torque and its contributions. For a phase of a cycle, results that are derived from
/// the torque are included.
#[derive(Debug, Clone)]
pub struct ScrewTorque {
    /// Screw torque, its contributions, and results derived from the torque.
    pub numbers: Numbers,
    /// Name of the contact model, or the reason why there is no contact torque.
    pub contacts: String,
    /// Axial force of each nut body in the warm steady state of an axis \[N\].
    pub bodies: Option<Vec<f64>>,
}

impl ScrewTorque {
    /// Contributions to the screw torque in the order in which they are added: first the load
    /// torque, then the contributions that dissipate energy as heat.
    pub const PARTS: [OutputName; 5] = [
        output!(ideal_torque_Nm),
        output!(contact_friction_torque_Nm),
        output!(preload_drag_beyond_contacts_Nm),
        output!(seal_torque_Nm),
        output!(support_bearing_torque_Nm),
    ];

    /// Returns the output with the given name.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.numbers.number(name)
    }

    /// Returns the screw torque \[N·m\], or `None` if the contacts have no solution.
    pub fn torque(&self) -> Option<f64> {
        self.number(output!(screw_torque_Nm))
    }

    /// Returns the torques as JSON.
    pub(crate) fn members(&self) -> TorqueParts {
        TorqueParts { numbers: NumbersJson::of(&self.numbers), contacts: self.contacts.clone() }
    }
}

/// Torques at one moment of a phase of the duty cycle.
#[derive(Clone)]
pub(crate) struct Torques {
    pub(super) point: PhasePoint,
    pub(super) ideal: f64,
    pub(super) contacts: Contacts,
    /// Friction torque of the ball returns and the lubricant due to the preload \[N·m\]. It is
    /// added to the friction torque of the contacts.
    drag: f64,
    seal: f64,
    bearing: f64,
}

impl Torques {
    /// Creates the torques at one moment of a phase.
    ///
    /// * `advance`: travel per radian of screw rotation \[m\].
    /// * `drag`: friction torque of ball returns and lubricant due to the preload \[N·m\].
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

    /// Returns the screw torque and its contributions as named quantities.
    pub(super) fn numbers(&self) -> Numbers {
        read_torques(self, |_| true)
    }

    /// Returns the friction torque that opposes the motion \[N·m\]. The value is positive.
    pub(super) fn friction(&self) -> Option<f64> {
        Some(self.contacts.friction? + self.drag + self.seal + self.bearing)
    }

    /// Returns the torque at the screw \[N·m\].
    pub(super) fn at_screw(&self) -> Option<f64> {
        Some(self.ideal + self.point.direction() * self.friction()?)
    }

    /// Returns the torque at the screw \[N·m\]. It is positive if it acts against the load or,
    /// without a load, in the direction of motion.
    pub(super) fn against_load(&self) -> Option<f64> {
        let Torques { point, .. } = self;
        let sign = if point.load == 0.0 { point.direction() } else { point.load.signum() };
        Some(sign * self.at_screw()?)
    }

    /// Describes the percentage of the input power that each contribution dissipates.
    pub(super) fn costs(&self) -> Option<String> {
        let input = self.at_screw()?.abs().max(self.ideal.abs());
        let parts = [
            ("contacts", self.contacts.friction?),
            ("preload drag", self.drag),
            ("seals", self.seal),
            ("support bearings", self.bearing),
        ];
        let costly = parts.into_iter().filter(|(_, torque)| *torque > 0.0);
        let costs: Vec<_> = costly
            .map(|(part, torque)| format!("{part} {} %", format_short(100.0 * torque / input)))
            .collect();
        (!costs.is_empty()).then(|| {
            format!(
                "Friction losses as shares of the input power, at the largest load during motion: {}.",
                costs.join(", ")
            )
        })
    }

    /// Returns the ratio of output power to input power of the screw, including all contributions
    /// to the torque. Returns `None` if no work is done, or if the friction torque exceeds the
    /// torque with which the load drives the screw.
    pub(super) fn efficiency(&self) -> Option<f64> {
        let output = self.ideal * self.point.direction();
        let input = self.at_screw()? * self.point.direction();
        let efficiency = if output > 0.0 { output / input } else { input / output };
        (output != 0.0 && efficiency >= 0.0).then_some(efficiency)
    }
}

/// Torques in a phase of the cycle.
pub(crate) struct PhaseTorques {
    pub(super) phase: Phase,
    /// Torques at the start and the end of the phase.
    pub(super) ends: [Torques; 2],
    /// Time averages over the phase; `None` if friction is unknown.
    pub(super) means: Option<PhaseMeans>,
}

impl PhaseTorques {
    /// Calculates the torques at the ends of a phase, and their averages over the phase.
    ///
    /// * `preload`: preload of a nut pair \[N\].
    /// * `at`: function that calculates the torques at a moment of the phase.
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

    /// Returns the mean powers of the heat sources in the phase \[W\], or `None` if friction is
    /// unknown.
    pub(super) fn sources(&self) -> Option<HeatSources> {
        let speed = self.phase.mean_speed().abs();
        let Torques { drag, seal, bearing, .. } = self.heavier();
        let contacts = self.means?.heat - (drag + seal + bearing) * speed;
        let mut parts = [0.0; 2];
        for torques in &self.ends {
            let Contacts { friction, at_raceways, .. } = &torques.contacts;
            let friction = friction.filter(|friction| *friction > 0.0);
            for (part, torque) in parts.iter_mut().zip(at_raceways) {
                // The start and the end of the phase have equal weights. Contacts without friction
                // contribute nothing.
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

    /// Returns the torques at the more heavily loaded end of the phase (see
    /// [`PhasePoint::heavier`]).
    pub(super) fn heavier(&self) -> &Torques {
        let [start, end] = &self.ends;
        if start.point.heavier(end.point) == start.point { start } else { end }
    }
}

/// Preload of a nut \[N\], and the drag torques that it causes at the screw \[N·m\].
pub(crate) struct Preload {
    /// Preload as set at assembly, without temperature rises \[N\].
    pub(super) cold: f64,
    /// Preload including the effect of temperature rises \[N\].
    pub(super) warm: f64,
    /// Drag torque \[N·m\] according to the manufacturers' rule, which predicts the torque that is
    /// measured.
    pub(super) by_rule: f64,
    /// Drag torque of the ball contacts only; `None` if friction is not known.
    pub(super) of_contacts: Option<f64>,
    /// Solution of the nut without external load; `None` without friction or motion.
    pub(super) unloaded: Option<NutReport>,
    /// Drag torque of the ball returns and the lubricant, which is added to the drag torque of the
    /// contacts.
    pub(super) drag_beyond_contacts: f64,
}

impl Preload {
    /// Returns the preload and its drag torque at a given speed of the screw relative to the nut
    /// \[rad/s\], or `None` if the nut is not preloaded.
    pub(super) fn of(
        case: &Case,
        settings: &Settings,
        machine: &AxisModel,
        nut: Option<&NutReport>,
        speed: f64,
    ) -> Result<Option<Self>, CaseError> {
        let screw = &machine.axis.screw;
        let by_rule = |preload| drag_torque(preload, screw.lead, screw.lead_angle());
        let by_catalog = machine.groove.is_none() || takes_catalog_efficiency(case, settings);
        if let Some(preload) = case.preload_N.filter(|_| by_catalog) {
            let by_rule = by_rule(preload);
            let given = case.extra_drag_factor.map(|factor| factor * machine.advance() * preload);
            let drag_beyond_contacts = given.unwrap_or(by_rule);
            return Ok(Some(Self {
                cold: preload,
                warm: preload,
                by_rule,
                of_contacts: None,
                unloaded: None,
                drag_beyond_contacts,
            }));
        }
        let Some(nut) = nut else { return Ok(None) };
        let forces = nut.number(output!(cold_preload_N)).zip(nut.number(output!(warm_preload_N)));
        let Some((cold, warm)) = forces.filter(|_| case.is_preloaded()) else { return Ok(None) };
        let runs = speed > 0.0 && case.given().has_friction();
        let unloaded = runs.then(|| nut_at(case, settings, 0.0, speed)).transpose()?;
        let heat = unloaded.as_ref().and_then(|nut| nut.number(output!(friction_heat_W)));
        let of_contacts = heat.map(|heat| heat / speed);
        let drag_beyond_contacts = ColdNut::of(case, settings, machine)?.drag(case, machine) * warm;
        Ok(Some(Self {
            cold,
            warm,
            by_rule: by_rule(cold),
            of_contacts,
            unloaded,
            drag_beyond_contacts,
        }))
    }
}

/// Calculates the screw torque at the operating point of the case, and its contributions: the load
/// including weight and guide friction, the ball contacts, the preload, the seals and the support
/// bearings. Returns `None` if load, speed or friction is missing.
///
/// # Errors
///
/// Returns [`CaseError`] if the ball model has no solution for the nut or the operating point.
///
/// * `work`: workspace of the models, which is reused for several cases.
pub fn torque_parts(
    case: &Case,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Option<ScrewTorque>, CaseError> {
    let case = &case.in_warm_state(settings)?;
    let preloaded = case.is_preloaded() && NEEDS.are_met(case.given());
    let point = case.speeds_rpm().zip(case.axial_load_N).zip(case.lead());
    let Some((((screw, turned), force), lead)) = point.filter(|_| case.given().has_friction())
    else {
        return Ok(None);
    };
    let speed = DutySpeed::of_rotation((screw - turned) * RPM);
    let point = ProfileSegment::constant(1.0, speed, force);
    let point = phases(&[point], &carriage(case)?, lead * MM)[0].heavier_end();
    let drag = if preloaded {
        let machine = AxisModel::of(case)?;
        let nut = nut_at(case, settings, point.load, point.speed)?;
        let preload = Preload::of(case, settings, &machine, Some(&nut), point.speed.abs())?;
        preload.map_or(0.0, |preload| preload.drag_beyond_contacts)
    } else {
        0.0
    };
    let advance = lead * MM / TAU;
    let contacts = contacts(case, settings, advance, &point, work)?;
    let torques = Torques::of(case, (advance, drag), &point, contacts);
    let numbers = torques.numbers();
    Ok(Some(ScrewTorque { numbers, contacts: torques.contacts.text, bodies: None }))
}

/// Calculates the efficiency of the screw at a moment of a phase, fast enough for a search over
/// many screws. Even for a preloaded nut, the function solves only one ball with an equal share of
/// the load, and calculates the friction torque due to preload with the manufacturers' rule.
///
/// * `nut`: nut that the case describes.
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
