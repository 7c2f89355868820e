//! The warm steady state of an axis: from its case to its problem in SI.

use bsm_design::{EndFixity, Shaft, drag_torque};
use bsm_dyn::ZERO_CELSIUS;
use bsm_kin::Drive;
use bsm_nut::thermal::{
    AxialHold, BETWEEN_LOADS, Coolant, HeldFriction as _, ScrewBar, Sinks, Surfaces, WarmNut,
    WarmPhase, coolant_conductance, drag_beyond_contacts,
};
use bsm_nut::{BallNut, Equilibrium, Support};

use crate::case::axis::Machine;
use crate::case::nut::NutPreload;
use crate::vocabulary::entries::Named;
use crate::vocabulary::error::bad;
use crate::vocabulary::units::{RPM, UM};
use crate::{Case, CaseError, InputKey, NutProblem, Settings};

/// Speed at which manufacturers measure the drag of a preload \[rad/s\].
const SLOW: f64 = 100.0 * RPM;

/// Temperature of the air unless given \[°C\].
const AIR: f64 = 20.0;

/// A nut as its preload is set and manufacturers measure it: cold, at [`SLOW`].
pub(crate) struct ColdNut {
    problem: NutProblem,
    nut: BallNut,
    pub(super) preload: Option<NutPreload>,
    /// The preloaded nut without load, held against tilting.
    pub(super) unloaded: Option<Equilibrium>,
    /// Temperature of setting \[K\].
    set: f64,
}

impl ColdNut {
    /// That of a case.
    pub(crate) fn of(
        case: &Case,
        settings: &Settings,
        machine: &Machine,
    ) -> Result<Self, CaseError> {
        let mut cold = case.cold();
        let celsius = case.number(InputKey::preload_temperature_C);
        (cold.feed_m_min, cold.seal_torque_Nm) = (None, None);
        (cold.screw_speed_rpm, cold.nut_speed_rpm) = (Some(SLOW / RPM), None);
        let heaviest = machine.axis.heaviest().map_or(0.0, |phase| phase.load);
        cold.axial_load_N = Some(if case.is_preloaded() { 0.0 } else { heaviest });
        if case.given().is_lubricated() {
            cold.lubricant_temperature_C = Some(celsius);
        }
        let problem = NutProblem::of(&cold, settings)?;
        let made = problem.made().map_err(CaseError::Nut)?;
        let (nut, preload) = (made.nut, made.preload);
        let unloaded = preload.map(|_| nut.solve(&Support::guided(0.0)));
        let unloaded = unloaded.transpose().map_err(CaseError::Nut)?;
        Ok(Self { problem, nut, preload, unloaded, set: celsius + ZERO_CELSIUS })
    }

    /// Drag beyond the contacts over the warm preload, `$K_x h$` \[m\]; 0 without a preload.
    pub(crate) fn drag(&self, case: &Case, machine: &Machine) -> f64 {
        if let Some(factor) = case.extra_drag_factor {
            return factor * machine.advance();
        }
        let by_rule = case.nut.drag_rule != Some(false);
        let preloaded = self.preload.zip(self.unloaded.as_ref()).filter(|_| by_rule);
        let Some((preload, found)) = preloaded else { return 0.0 };
        let slow = Drive { screw_speed: SLOW, nut_speed: 0.0 };
        let contacts = self
            .problem
            .sum(&self.nut, found, &slow, self.set, BETWEEN_LOADS, &[])
            .map_or(0.0, |friction| friction.torque);
        let screw = &machine.axis.screw;
        let rule = drag_torque(preload.cold, screw.lead, screw.lead_angle());
        drag_beyond_contacts(rule, contacts, preload.cold)
    }
}

/// The axis of a case with what its warm state follows from.
pub(crate) struct WarmAxis<'a> {
    case: &'a Case,
    machine: &'a Machine,
    shaft: &'a Shaft,
    /// Stroke and nut \[m\].
    travel: f64,
    pub(super) cold: ColdNut,
}

impl<'a> WarmAxis<'a> {
    /// That of a case which asks for its warm state.
    pub(crate) fn of(
        case: &'a Case,
        settings: &Settings,
        machine: &'a Machine,
    ) -> Result<Self, CaseError> {
        if case.is_warm() {
            let what =
                "finds rises of temperature and the tension of the screw, which are given too";
            return Err(bad("warm_state", what));
        }
        if case.axis_heat_transfer_W_K.or(case.heat_transfer_W_K).is_some() {
            let what = "has five nodes: a heat transfer of one node is given too";
            return Err(bad("warm_state", what));
        }
        let (Some(shaft), Some(travel)) = (&machine.axis.shaft, machine.travel(case)?) else {
            return Err(bad("warm_state", "needs stroke_mm"));
        };
        if case.coolant_flow_l_min.is_some() && case.screw_bore_mm.is_none() {
            return Err(bad("coolant_flow_l_min", "needs screw_bore_mm"));
        }
        if !case.given().has_friction() {
            let missing = ["friction_coefficient or a lubricant".to_owned()];
            return Err(CaseError::missing(&missing, "for the warm state"));
        }
        let cold = ColdNut::of(case, settings, machine)?;
        Ok(Self { case, machine, shaft, travel, cold })
    }

    /// Up to which multiple of the speeds the fold is looked for.
    pub(crate) fn search(&self) -> f64 {
        self.case.number(InputKey::fold_search_factor)
    }

    /// The nut with its friction.
    pub(crate) fn nut(&self) -> Result<WarmNut<'_>, CaseError> {
        let Self { case, machine, shaft, travel, ref cold } = *self;
        let expansion = case.number(InputKey::thermal_expansion_um_m_K) * UM;
        let over_set = |celsius: f64| celsius + ZERO_CELSIUS - cold.set;
        let air = over_set(case.ambient_temperature_C.unwrap_or(AIR));
        let mean = match &cold.unloaded {
            Some(found) if cold.problem.support == Support::guided(0.0) => found.mean_load(),
            _ => cold.nut.solve(&cold.problem.support).map_err(CaseError::Nut)?.mean_load(),
        };
        let flow = case.coolant_flow_l_min.map(|flow| {
            let coolant = case.nut.coolant.map_or(Coolant::Water, |Named(coolant)| coolant);
            coolant_conductance(coolant, flow / 6e4, shaft.bore, shaft.length)
        });
        let hold = machine.held.map(|held| AxialHold {
            stiffness: held.shaft.held(held.bearing),
            pretension: held.tension(0.0),
            youngs_modulus: shaft.youngs_modulus,
            poisson_ratio: case.number(InputKey::poisson_ratio),
        });
        let free = shaft.support == EndFixity::FixedFree;
        let phase = |phase: &bsm_design::Phase| WarmPhase {
            time: phase.time,
            load: phase.load,
            drive: Drive { screw_speed: phase.speed, nut_speed: 0.0 },
        };
        Ok(WarmNut {
            nut: cold.nut.clone(),
            preload: cold.preload.map(|preload| preload.by),
            support: cold.problem.support,
            phases: machine.axis.phases.iter().map(phase).collect(),
            friction: &cold.problem,
            drag: cold.drag(case, machine),
            seal: case.number(InputKey::seal_torque_Nm),
            bearings: case.number(InputKey::support_bearing_torque_Nm),
            motor: case.number(InputKey::motor_heat_W),
            set: cold.set,
            surfaces: Surfaces {
                size: (machine.body.outer, machine.body.length),
                carriage: case.carriage_area_m2,
                radii: cold
                    .nut
                    .contact_radii(mean)
                    .map_err(|why| CaseError::Nut(bsm_nut::NutError::Contact(why)))?,
                nut: case.nut_conductance_W_K,
                screw_film: case.screw_film_W_m2K,
                gap: case.gap_conductance_W_K,
                ball_nut: case.ball_nut_conductance_W_K,
                ball_screw: case.ball_screw_conductance_W_K,
                end: case.end_conductance_W_K,
                coolant: case.coolant_conductance_W_K.or(flow).unwrap_or(0.0),
                nut_coolant: case.number(InputKey::nut_coolant_conductance_W_K),
            },
            off: None,
            screw: ScrewBar {
                diameter: machine.axis.screw.pitch_diameter,
                length: shaft.length,
                travel,
                section: shaft.section(),
                conductivity: case.number(InputKey::steel_conductivity_W_m_K),
                expansion,
                bearings: [true, !free],
                hold,
            },
            sinks: Sinks {
                air,
                structure: case.structure_temperature_C.map_or(air, over_set),
                coolant: case.coolant_temperature_C.map_or(air, over_set),
            },
        })
    }
}
