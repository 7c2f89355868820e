//! The warm steady state of an axis: from its entries to its problem in SI.

use bsm_design::{Shaft, Support as Mounting, drag_torque};
use bsm_dyn::ZERO_CELSIUS;
use bsm_kin::Drive;
use bsm_nut::thermal::{
    AxialHold, Coolant, ScrewBar, Sinks, Surfaces, WarmNut, WarmPhase, coolant_conductance,
    drag_beyond_contacts,
};
use bsm_nut::{BallNut, Equilibrium, FrictionSum, Support};

use crate::case::axis::Machine;
use crate::case::nut::{Set, bad, twice};
use crate::vocabulary::units::{MM, RPM, UM};
use crate::vocabulary::warm::{CoolantWord, WarmWords};
use crate::{CaseError, InputKey, NutProblem, Scene, Settings};

/// Temperature at which preload and fits are set, unless it is given \[°C\].
const SET: f64 = 20.0;

/// Speed at which makers measure the drag of a preload \[rad/s\].
const SLOW: f64 = 100.0 * RPM;

/// The axis of a scene with what its warm state follows from.
pub(crate) struct WarmAxis<'a> {
    words: &'a WarmWords,
    scene: &'a Scene,
    machine: &'a Machine,
    shaft: &'a Shaft,
    /// Stroke and nut \[m\].
    travel: f64,
    problem: NutProblem,
    nut: BallNut,
    preload: Option<Set>,
}

impl<'a> WarmAxis<'a> {
    /// That of a scene with what it says of it.
    pub(crate) fn of(
        scene: &'a Scene,
        words: &'a WarmWords,
        settings: &Settings,
        machine: &'a Machine,
    ) -> Result<Self, CaseError> {
        words.check()?;
        for (one, other) in [
            (
                ("nut_conductance_W_K", words.nut_conductance_W_K),
                ("carriage_area_m2", words.carriage_area_m2),
            ),
            (
                ("coolant_flow_l_min", words.coolant_flow_l_min),
                ("coolant_conductance_W_K", words.coolant_conductance_W_K),
            ),
            (("pretension_N", words.pretension_N), ("pretension_K", words.pretension_K)),
        ] {
            if one.1.and(other.1).is_some() {
                return Err(twice(one.0, other.0));
            }
        }
        if scene.has_rises() {
            return Err(bad("warm_state", "finds the rises of temperature, which are given too"));
        }
        if scene.axis_heat_transfer_W_K.or(scene.heat_transfer_W_K).is_some() {
            let what = "has five nodes: a heat transfer of one node is given too";
            return Err(bad("warm_state", what));
        }
        let (Some(shaft), Some(stroke)) = (&machine.axis.shaft, scene.stroke_mm) else {
            return Err(bad("warm_state", "needs stroke_mm"));
        };
        let travel = stroke * MM + machine.body.length;
        if shaft.length <= travel {
            let what = "is not more than stroke and nut: the nut would run into the bearings";
            return Err(bad("unsupported_length_mm", what));
        }
        if words.screw_bore_mm.is_some_and(|bore| bore * MM >= shaft.diameter) {
            return Err(bad("warm_state.screw_bore_mm", "must be less than the core of the screw"));
        }
        if words.coolant_flow_l_min.is_some() && words.screw_bore_mm.is_none() {
            return Err(bad("warm_state.coolant_flow_l_min", "needs screw_bore_mm"));
        }
        let pretension = words.pretension_N.or(words.pretension_K);
        if pretension.is_some() && shaft.support != Mounting::FixedFixed {
            return Err(bad("warm_state", "a pretension needs support fixed-fixed"));
        }
        if !scene.given().has_friction() {
            let missing = vec!["friction_coefficient or a lubricant".to_owned()];
            return Err(CaseError::Missing { missing, by: "for the warm state".to_owned() });
        }
        let heaviest = machine.axis.heaviest().map_or(0.0, |phase| phase.load);
        let mut cold = scene.clone();
        cold.nut.warm_state = None;
        cold.feed_m_min = None;
        cold.seal_torque_Nm = None;
        (cold.screw_speed_rpm, cold.nut_speed_rpm) = (Some(SLOW / RPM), None);
        cold.axial_load_N = Some(if scene.is_preloaded() { 0.0 } else { heaviest });
        if scene.given().is_lubricated() {
            cold.lubricant_temperature_C = Some(words.preload_temperature_C.unwrap_or(SET));
        }
        let problem = NutProblem::of(&cold, settings)?;
        let made = problem.made().map_err(CaseError::Nut)?;
        let (nut, preload) = (made.nut, made.preload);
        Ok(Self { words, scene, machine, shaft, travel, problem, nut, preload })
    }

    /// Friction of all balls.
    pub(crate) fn friction(
        &self,
    ) -> impl Fn(&BallNut, &Equilibrium, &Drive<f64>, f64) -> Option<FrictionSum> {
        |nut, found, drive, oil| self.problem.friction_sum(nut, found, drive, oil)
    }

    /// Up to which multiple of the speeds the fold is looked for.
    pub(crate) fn search(&self) -> f64 {
        self.words.fold_search_factor.unwrap_or(2.0)
    }

    /// The cold preload \[N\].
    pub(crate) fn cold_preload(&self) -> Option<f64> {
        self.preload.map(|preload| preload.cold)
    }

    /// The nut with its friction.
    pub(crate) fn nut<'f>(
        &self,
        friction: &'f bsm_nut::thermal::FrictionOf<'f>,
    ) -> Result<WarmNut<'f>, CaseError> {
        let (words, machine, shaft) = (self.words, self.machine, self.shaft);
        let value = |key| self.scene.value_or_default(key).unwrap_or(f64::NAN);
        let expansion = value(InputKey::thermal_expansion_um_m_K) * UM;
        let set = words.preload_temperature_C.unwrap_or(SET);
        let air = words.ambient_temperature_C.unwrap_or(set) - set;
        let over_set = |celsius: Option<f64>| celsius.map_or(air, |celsius| celsius - set);
        let guided = Support::guided(0.0);
        let unloaded = self.nut.solve(&self.problem.support).map_err(CaseError::Nut)?;
        let mean = unloaded.max_load() / unloaded.concentration();
        let bore = words.screw_bore_mm.unwrap_or(0.0) * MM;
        let section = 0.25 * std::f64::consts::PI * (shaft.diameter.powi(2) - bore * bore);
        let flow = words.coolant_flow_l_min.map(|flow| {
            let coolant = match words.coolant {
                Some(CoolantWord::Oil) => Coolant::Oil,
                _ => Coolant::Water,
            };
            coolant_conductance(coolant, flow / 6e4, bore, shaft.length)
        });
        let hold = (shaft.support == Mounting::FixedFixed).then(|| {
            let bearing = self.scene.support_bearing_stiffness_N_um.map_or(0.0, |k| 2.0 * UM / k);
            let own = shaft.length / (shaft.youngs_modulus * section);
            let stiffness = (own + bearing).recip();
            let by_rise = words.pretension_K.unwrap_or(0.0) * expansion * shaft.length * stiffness;
            AxialHold {
                stiffness,
                pretension: words.pretension_N.unwrap_or(by_rise),
                youngs_modulus: shaft.youngs_modulus,
                poisson_ratio: value(InputKey::poisson_ratio),
            }
        });
        let free = shaft.support == Mounting::FixedFree;
        let lead = machine.axis.nut.lead;
        let drag = match (words.extra_drag_factor, self.preload) {
            (Some(factor), _) => factor * machine.advance(),
            (None, Some(preload)) if words.drag_rule != Some(false) => {
                let found = self.nut.solve(&guided).map_err(CaseError::Nut)?;
                let slow = Drive { screw_speed: SLOW, nut_speed: 0.0 };
                let contacts = friction(&self.nut, &found, &slow, set + ZERO_CELSIUS)
                    .map_or(0.0, |friction| friction.torque);
                let rule = drag_torque(preload.cold, lead, machine.axis.nut.lead_angle());
                drag_beyond_contacts(rule, contacts, preload.cold)
            }
            _ => 0.0,
        };
        let phase = |phase: &bsm_design::Phase| WarmPhase {
            time: phase.time,
            load: phase.load,
            drive: Drive { screw_speed: phase.speed, nut_speed: 0.0 },
        };
        Ok(WarmNut {
            nut: self.nut.clone(),
            preload: self.preload.map(|preload| preload.by),
            support: self.problem.support,
            phases: machine.axis.phases.iter().map(phase).collect(),
            friction,
            drag,
            seal: value(InputKey::seal_torque_Nm),
            bearings: value(InputKey::support_bearing_torque_Nm),
            motor: words.motor_heat_W.unwrap_or(0.0),
            set: set + ZERO_CELSIUS,
            surfaces: Surfaces {
                size: (machine.body.outer, machine.body.length),
                carriage: words.carriage_area_m2,
                radii: self
                    .nut
                    .contact_radii(mean)
                    .map_err(|why| CaseError::Nut(bsm_nut::NutError::Contact(why)))?,
                nut: words.nut_conductance_W_K,
                screw_film: words.screw_film_W_m2K,
                gap: words.gap_conductance_W_K,
                ball_nut: words.ball_nut_conductance_W_K,
                ball_screw: words.ball_screw_conductance_W_K,
                end: words.end_conductance_W_K,
                coolant: words.coolant_conductance_W_K.or(flow).unwrap_or(0.0),
                nut_coolant: words.nut_coolant_conductance_W_K.unwrap_or(0.0),
            },
            off: None,
            screw: ScrewBar {
                diameter: machine.axis.nut.pitch_diameter,
                length: shaft.length,
                travel: self.travel,
                section,
                conductivity: words.steel_conductivity_W_m_K.unwrap_or(45.0),
                expansion,
                bearings: [true, !free],
                hold,
            },
            sinks: Sinks {
                air,
                structure: over_set(words.structure_temperature_C),
                coolant: over_set(words.coolant_temperature_C),
            },
        })
    }
}
