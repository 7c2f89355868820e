//! The axis around a screw: loads of its cycle, torque, and every rule with its value, limit and source.

mod contacts;
mod lubrication;
mod rules;

use std::cell::OnceCell;
use std::f64::consts::TAU;

use bsm_design::{
    Axis, BackDriving, DutySpeed, Fall, Grade, Life, Motion, Nut, Phase, PreloadMethod, RigidityAt,
    Shaft, drag_torque, heat_transfer, in_series, least_acceleration_time, life, lost_motion,
    root_mean_square, steady_rise,
};
use bsm_dyn::ModelWorkspace;
use serde_json::{Value, json};

use self::contacts::{Contacts, contacts, nut_at};
use self::lubrication::Lubrication;
use super::nut::QUANTITIES as NUT;
use super::ratings::QUANTITIES as RATINGS;
use crate::answers::nut::preload_note;
use crate::case::axis::{FixedEnds, Machine, carriage, preload_method, useful_travel};
use crate::case::nut::bad;
use crate::case::rated_nut;
use crate::case::rated_screw::LEFT_OUT;
use crate::case::warm::{ColdNut, Detail, Warm, WarmState};
use crate::vocabulary::answer::numbers_json;
use crate::vocabulary::number::trimmed;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, RPM, UM};
use crate::{
    Answer, CaseError, Column, Content, Criterion, INPUTS, InputKey, Numbers, NutReport, Output,
    Quantity, Scene, Settings, Table, WarmBranch, ratings,
};

/// Inputs of an axis: its nut, and a load and a speed or a cycle.
pub(crate) const NEEDS: crate::case::problem::Needs = rated_nut::NEEDS;

quantities! { pub(crate) QUANTITIES, read(&AxisState<'_>) of Axis;
    "the cycle" {
        largest_load_N ["N"] Whole(|w| w.axis().largest_load()), "largest axial load of the screw";
        largest_speed_rpm ["rpm"] Whole(|w| w.axis().fastest() / RPM), "largest speed of the screw";
        largest_feed_m_min ["m/min"] Whole(|w| w.axis().fastest() * w.machine.advance() * 60.0), "largest feed";
        equivalent_load_N ["N" "F_m"] Whole(|w| Some(w.life()?.mean_load)),
            "equivalent constant load, with the same life; of a pair, that of the more heavily loaded nut";
        equivalent_speed_rpm ["rpm" "n_m"] Whole(|w| Some(w.life()?.mean_speed / RPM)), "equivalent speed";
    }
    "screw and bearings" {
        unsupported_length_mm = INPUTS Whole(|w| Some(w.shaft()?.length / MM));
        shaft_diameter_mm = INPUTS Whole(|w| Some(w.shaft()?.diameter / MM));
        critical_speed_rpm ["rpm" "n_k"] Whole(|w| Some(w.shaft()?.critical_speed() / RPM)), "critical speed";
        critical_speed_ratio [""] Whole(|w| w.shaft().and(w.axis().critical_speed_ratio())), "largest speed over the critical one";
        buckling_load_N ["N" "F_k"] Whole(|w| Some(w.shaft()?.buckling_load())), "buckling load";
        buckling_safety [""] Whole(|w| w.shaft().and(w.axis().buckling_safety())), "buckling load over the largest load";
        yield_load_N ["N"] Whole(|w| w.shaft().and(w.axis().yield_load())), "permissible axial load, core stress 147 N/mm2";
        largest_speed_number_mm_min ["mm/min" "d_pw n"] Whole(|w| w.axis().speed_number() / (MM * RPM)), "largest speed number";
        pretension_N = INPUTS Whole(|w| Some(w.pretension()?.tension(0.0)));
        pretension_K = INPUTS Whole(|w| Some(w.pretension()?.stretched));
        stretch_um ["um"] Whole(|w| {
            Some(w.pretension()?.tension(0.0) / w.shaft()?.held(f64::INFINITY) / UM)
        }), "elongation of the screw by its pretension";
        travel_compensation_um ["um" "c"] Whole(|w| Some(w.travel_compensation()? * MM / UM)), "target of the travel over the stroke for a screw that is stretched; below 0 it is made shorter";
        screw_tension_N = INPUTS Whole(|w| w.tension());
        support_bearing_load_N ["N"] Whole(|w| {
            Some(w.axis().largest_load() + w.pretension().map_or(0.0, |held| held.tension(0.0)))
        }), "largest load and pretension, which the support bearings carry";
        screw_mass_kg ["kg"] Whole(|w| w.shaft().and(w.machine.screw).map(|(mass, _)| mass)), "mass of the screw between its bearings";
        axis_heat_transfer_W_K = INPUTS Whole(|w| w.heat_transfer());
        steady_temperature_rise_K ["K"] Whole(|w| w.steady_rise()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency],
            "steady-state temperature rise, by axis_heat_transfer_W_K";
        screw_growth_um ["um"] Whole(|w| w.growth()),
            "thermal expansion between the bearings, in the warm state, by screw_temperature_rise_K or by the steady-state rise";
        travel_deviation_um ["um" "e_p"] Whole(|w| Some(w.grade()?.deviation(w.travel()?)? / UM)),
            "permitted deviation of the travel over the useful travel, of accuracy_grade";
        travel_variation_um ["um" "v_up"] Whole(|w| Some(w.grade()?.variation_of_travel(w.travel()?)? / UM)),
            "permitted variation of travel within the useful travel, of accuracy_grade";
        travel_variation_300_um ["um" "v_300p"] Whole(|w| Some(w.grade()?.variation / UM)),
            "permitted variation of travel within any 300 mm, of accuracy_grade";
        travel_variation_2pi_um ["um" "v_2pip"] Whole(|w| Some(w.grade()?.of_a_turn? / UM)),
            "permitted variation of travel within any turn, of accuracy_grade";
        travel_error_worst_um ["um"] Whole(|w| Some(w.grade()?.worst_error(w.travel()?)? / UM)),
            "largest error of the travel, of accuracy_grade";
    }
    "nut and life" {
        static_safety_factor ["" "f_s"] Whole(|w| w.static_safety()), "static safety factor, the smaller of rating and most loaded ball";
        cycle_life_revolutions ["" "L"] Whole(|w| Some(w.life()?.revolutions)), "life of the cycle by ISO 3408-5";
        cycle_life_h ["h" "L_h"] Whole(|w| Some(w.life()?.time / 3600.0)), "life of the cycle by ISO 3408-5";
        modified_dynamic_rating_N ["N" "C_am"] Whole(|w| w.axis().dynamic_rating), "modified dynamic load rating; by accuracy, hardness and steel";
        modified_static_rating_N ["N" "C_0am"] Whole(|w| w.axis().static_rating), "modified static load rating; by accuracy and hardness";
        fatigue_load_limit_N ["N" "C_u"] Whole(|w| w.lubrication.as_ref().map(|found| found.fatigue_limit)) needs [lubricant_temperature_C, contamination_factor],
            "fatigue load limit, largest pressure 1500 MPa";
        modified_life_h ["h" "L_nm"] Whole(|w| w.modified_life(0)) needs [lubricant_temperature_C, contamination_factor],
            "modified life of the cycle by ISO 281, with lubricant and contamination";
        modified_life_low_h ["h"] Whole(|w| w.modified_life(1)) needs [lubricant_temperature_C, contamination_factor],
            "modified life at the least contamination factor";
        modified_life_high_h ["h"] Whole(|w| w.modified_life(2)) needs [lubricant_temperature_C, contamination_factor],
            "modified life at the largest contamination factor";
        cycle_life_by_balls_h ["h"] Whole(|w| Some(w.axis().reliability * w.life_by_balls? / 3600.0)), "life of the cycle by the loads of all balls";
        limit_load_N = NUT Whole(|w| w.of_nut("limit_load_N"));
    }
    "stiffness" {
        screw_stiffness_N_um ["N/um" "R_s"] Whole(|w| Some(w.shaft()?.least_stiffness() * UM)), "minimum axial stiffness of the screw";
        nut_stiffness_at_largest_load_N_um ["N/um"] Whole(|w| w.nut_stiffness()),
            "tangent stiffness of the nut at the largest load, all balls";
        axis_stiffness_N_um ["N/um"] Whole(|w| Some(w.stiffness()? * UM)), "stiffness of screw, nut, bearings and housings in series";
        lost_motion_um ["um"] Whole(|w| {
            let friction = Some(w.machine.carriage.guide_friction()).filter(|friction| *friction > 0.0);
            Some(lost_motion(friction?, w.stiffness()?) / UM)
        }), "elastic lost motion on reversal";
    }
    "drive" {
        motor_speed_rpm ["rpm"] Whole(|w| w.axis().fastest() * w.machine.drive.gear_ratio / RPM), "largest speed of the motor";
        peak_motor_torque_Nm ["N m"] Whole(|w| w.peak(AxisState::motor_torque)) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency], "peak motor torque";
        rms_motor_torque_Nm ["N m"] Whole(|w| w.rms_torque()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency], "RMS motor torque";
        peak_motor_power_W ["W"] Whole(|w| w.peak(AxisState::motor_power)) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency], "peak motor power";
        mean_heat_W ["W"] Whole(|w| w.mean_heat()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency], "mean heat of nut, seals and support bearings";
        preload_torque_measured_Nm ["N m" "T_p0"] Whole(|w| Some(w.preload.as_ref()?.by_rule)),
            "friction torque of the preload to be measured; by manufacturers' rule, at 100 rpm, without wipers, oil of ISO VG 68";
        preload_torque_percent ["%"] Whole(|w| w.torque_percent()), "permitted variation of the friction torque of the preload, to either side; by accuracy_grade";
        preload_torque_measured_low_Nm ["N m"] Whole(|w| w.torque_by(-1.0)), "least permitted friction torque of the preload";
        preload_torque_measured_high_Nm ["N m"] Whole(|w| w.torque_by(1.0)), "largest permitted friction torque of the preload";
        screw_torque_Nm ["N m" "T"] Whole(|w| w.heaviest()?.at_screw()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency],
            "screw torque; at the largest load that moves, with preload, seals and support bearings";
        screw_efficiency ["" "eta"] Whole(|w| w.heaviest()?.efficiency()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency],
            "efficiency of the screw; at the largest load that moves, with preload, seals and support bearings";
        preload_torque_Nm = NUT Whole(|w| w.preload.as_ref()?.of_contacts) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency];
        holding_torque_Nm ["N m"] Whole(|w| w.holding) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency],
            "least holding torque at the screw, contacts alone; not for choosing a brake";
        holding_torque_frictionless_Nm ["N m"] Whole(|w| Some(w.falling()?.torque / w.machine.drive.gear_ratio)),
            "holding torque of the weight at the motor, without friction";
        required_brake_torque_Nm ["N m"] Whole(|w| w.required_brake()), "required torque of the brake, at the motor";
        back_driving_torque_Nm ["N m"] Whole(|w| Some(w.power_loss()?.nominal)), "torque with which the weight drives the screw, without power of the motor";
        back_driving_torque_low_Nm ["N m"] Whole(|w| Some(w.power_loss()?.torques[0])), "least torque with which the weight drives the screw; the largest friction, twice the drag";
        back_driving_torque_high_Nm ["N m"] Whole(|w| Some(w.power_loss()?.torques[1])), "largest torque with which the weight drives the screw; the least friction";
        stopping_distance_mm ["mm"] Whole(|w| Some(w.stopping_distance()? / MM)), "stopping distance after power loss downwards at the largest feed, by the brake alone";
        fall_acceleration_m_s2 ["m/s2"] Whole(|w| w.fall().map(|(acceleration, _)| acceleration)), "acceleration of the fall without power and brake";
        fall_speed_rpm ["rpm"] Whole(|w| w.fall().map(|(_, speed)| speed)), "speed of the screw after a fall over the stroke, without power and brake";
        inertia_of_screw_kg_m2 ["kg m2" "J_s"] Whole(|w| w.machine.screw.map(|(_, inertia)| inertia)), "moment of inertia of the screw";
        inertia_of_mass_kg_m2 ["kg m2"] Whole(|w| w.machine.drive.mass_inertia()), "reflected inertia of the moved mass, at the screw";
        inertia_at_motor_kg_m2 ["kg m2"] Whole(|w| w.inertia_at_motor()), "load inertia at the motor";
        inertia_ratio [""] Whole(|w| {
            let motor = Some(w.machine.drive.motor_inertia).filter(|inertia| *inertia > 0.0);
            Some(w.inertia_at_motor()? / motor?)
        }), "load-to-motor inertia ratio";
        least_acceleration_time_s ["s"] Whole(|w| w.least_ramp()) needs [friction_coefficient | lubricant_temperature_C | catalogue_efficiency],
            "least time to the largest speed, by motor_peak_torque_Nm";
        shortest_ramp_s ["s"] Whole(|w| w.shortest_ramp()), "time to the largest speed at the largest acceleration of the cycle";
    }
}

quantities! { pub(crate) TORQUES, read_torques(&Torques);
    "torque" {
        screw_load_N ["N" "F_a"] Whole(|t| t.phase.load), "axial load, with the moved mass";
        screw_torque_Nm = QUANTITIES Whole(Torques::at_screw);
        ideal_torque_Nm ["N m"] Whole(|t| t.ideal), "  of the load, without friction";
        contact_friction_torque_Nm ["N m"] Whole(|t| t.contacts.friction), "  contacts of the balls";
        preload_drag_beyond_contacts_Nm ["N m"] Whole(|t| t.drag), "  returns and lubricant of the preload, by manufacturers' rule";
        seal_torque_Nm ["N m"] Whole(|t| t.seal), "  seals";
        support_bearing_torque_Nm ["N m"] Whole(|t| t.bearing), "  support bearings";
        screw_efficiency = QUANTITIES Whole(Torques::efficiency);
    }
}

quantities! { pub(crate) PHASE, read_phase(&PhaseResult<'_>);
    "motion" {
        time_share [""] Whole(|p| p.torques.phase.time / p.worked.time()), "share of time";
        screw_speed_rpm ["rpm" "n"] Whole(|p| p.torques.phase.speed / RPM), "speed of the screw";
        feed_m_min ["m/min"] Whole(|p| p.torques.phase.speed * p.worked.machine.advance() * 60.0), "feed";
        acceleration_m_s2 ["m/s2"] Whole(|p| p.torques.phase.acceleration), "acceleration";
        motor_torque_Nm ["N m"] Whole(|p| p.worked.motor_torque(p.torques)), "motor torque";
        motor_power_W ["W"] Whole(|p| p.worked.motor_power(p.torques)), "motor power";
        heat_W ["W"] Whole(|p| p.torques.heat()), "heat";
        load_factor = INPUTS Whole(|p| p.torques.phase.load_factor);
        viscosity_ratio ["" "kappa"] Whole(|p| {
            let viscosity = p.worked.lubrication.as_ref()?.viscosity;
            let speed = Some(p.torques.phase.speed).filter(|speed| *speed != 0.0)?;
            Some(p.worked.axis().viscosity_ratio(viscosity, speed))
        }), "viscosity ratio of the lubricant";
    }
}

quantities! { pub(crate) SCREW, read_screw(&Screw<'_>);
    "screw and nut" {
        pitch_circle_diameter_mm = INPUTS Whole(|s| s.machine.axis.screw.pitch_diameter / MM);
        lead_mm = INPUTS Whole(|s| s.machine.axis.screw.lead / MM);
        lead_angle_deg = INPUTS Whole(|s| s.machine.axis.screw.lead_angle() / DEG);
        ball_diameter_mm = INPUTS Whole(|s| Some(s.nut()?.ball_diameter / MM));
        contact_angle_deg = INPUTS Whole(|s| Some(s.nut()?.contact_angle / DEG));
        nut_conformity = INPUTS Whole(|s| Some(s.nut()?.conformity.0));
        screw_conformity = INPUTS Whole(|s| Some(s.nut()?.conformity.1));
        loaded_balls_per_turn = INPUTS Whole(|s| Some(s.nut()?.balls_per_turn));
        loaded_turns = INPUTS Whole(|s| Some(s.nut()?.turns));
        nut_outer_diameter_mm = INPUTS Whole(|s| s.machine.body.outer / MM);
        nut_length_mm = INPUTS Whole(|s| s.machine.body.length / MM);
        screw_outer_diameter_mm = INPUTS Whole(|s| s.machine.axis.screw.outer / MM);
        screw_core_diameter_mm = RATINGS Whole(|s| s.machine.axis.screw.core / MM);
        dynamic_load_rating_N = RATINGS Whole(|s| s.machine.ratings[0]);
        static_load_rating_N = RATINGS Whole(|s| s.machine.ratings[1]);
        edge_load_N = RATINGS Whole(|s| s.of_nut.number("edge_load_N"));
        mass_kg = RATINGS Whole(|s| s.of_nut.number("mass_kg"));
        preload_set_N = NUT Whole(|s| Some(s.preload?.cold));
        warm_preload_N = NUT Whole(|s| Some(s.preload?.warm));
        friction_coefficient = INPUTS Whole(|s| s.scene.friction_coefficient);
    }
}

/// A phase of a cycle.
pub(crate) struct PhaseResult<'a> {
    worked: &'a AxisState<'a>,
    torques: &'a Torques,
}

/// The screw and its nut, as used.
pub(crate) struct Screw<'a> {
    scene: &'a Scene,
    machine: &'a Machine,
    of_nut: &'a Answer,
    preload: Option<&'a Preload>,
}

impl Screw<'_> {
    fn nut(&self) -> Option<&Nut> {
        self.machine.groove.as_ref().map(|(nut, _)| nut)
    }
}

/// The screw torque by its parts, in a phase with what follows.
#[derive(Debug, Clone)]
pub struct ScrewTorque {
    /// The numbers.
    pub numbers: Numbers,
    /// The model of the contacts, or the reason without one.
    pub contacts: String,
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

/// An axis: its numbers, its rules, its cycle.
#[derive(Debug, Clone)]
pub struct AxisReport {
    /// The scene.
    pub scene: Scene,
    /// How friction was calculated.
    pub settings: Settings,
    /// Each phase of the cycle.
    pub phases: Vec<ScrewTorque>,
    /// What to order, in a line.
    pub order: String,
    /// The answer.
    pub answer: Answer,
}

/// The numbers of a sheet that tell nuts apart, in tables of them.
pub fn sheet_columns() -> impl Iterator<Item = &'static Output> + Clone {
    const NAMES: [&str; 10] = [
        "cycle_life_h",
        "critical_speed_ratio",
        "buckling_safety",
        "static_safety_factor",
        "axis_stiffness_N_um",
        "peak_motor_torque_Nm",
        "screw_efficiency",
        "mean_heat_W",
        "screw_mass_kg",
        "inertia_of_screw_kg_m2",
    ];
    NAMES.into_iter().filter_map(|name| {
        QUANTITIES.iter().flat_map(|quantity| quantity.columns).find(|column| column.name == name)
    })
}

/// Turns of a stroke below which its life is no fatigue.
const LEAST_TURNS: f64 = 0.5;

/// Lengths of a nut below which a stroke is short (HIWIN BS-08-2, F 3.10), and the load factor there, the least.
const SHORT: (f64, f64) = (3.0, 3.0);

/// Speed number from which the grease is to be asked for \[mm/min\], usual value.
const FAST: f64 = 100e3;

/// Effects that the torque of an axis neglects.
const NOT_MODELLED: [&str; 6] = [
    "lubricant, unless its inputs are given: contacts are dry then, with one friction coefficient; the friction torque of the preload is that of manufacturers' rule, accurate to some 50 %",
    "ball returns and ball-to-ball contact: only in manufacturers' rule for the preload",
    "temperatures of nut, screw and balls, unless warm_state asks for them: their rises are inputs, which the preload follows; axis_heat_transfer_W_K gives the growth of the screw alone",
    "vibration of the axis, its control, and shocks: multiply the loads by the factor of your machine",
    "bending of the screw by its weight, and of the frame; misalignment unless it is given",
    "brackets of motor and bearings beyond housing_stiffness_N_um",
];

/// The torque of a phase.
pub(crate) struct Torques {
    phase: Phase,
    ideal: f64,
    contacts: Contacts,
    /// Of returns and lubricant, beyond the contacts of the preload, with its sign.
    drag: f64,
    seal: f64,
    bearing: f64,
}

impl Torques {
    /// * `advance`: for a radian of the screw \[m\]. * `drag`: of the preload beyond its contacts \[N·m\].
    fn of(
        scene: &Scene,
        settings: &Settings,
        (advance, drag): (f64, f64),
        phase: &Phase,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let moves = f64::from(u8::from(phase.speed != 0.0));
        let value = |key| moves * scene.value_or_default(key).unwrap_or(0.0);
        Ok(Self {
            phase: *phase,
            ideal: advance * phase.load,
            contacts: contacts(scene, settings, advance, phase, work)?,
            drag: moves * drag,
            seal: value(InputKey::seal_torque_Nm),
            bearing: value(InputKey::support_bearing_torque_Nm),
        })
    }

    /// Torque against the motion, positive \[N·m\].
    fn friction(&self) -> Option<f64> {
        Some(self.contacts.friction? + self.drag + self.seal + self.bearing)
    }

    /// Torque that the screw takes \[N·m\].
    fn at_screw(&self) -> Option<f64> {
        let way = if self.phase.speed == 0.0 { 0.0 } else { self.phase.speed.signum() };
        Some(self.ideal + way * self.friction()?)
    }

    fn heat(&self) -> Option<f64> {
        Some(self.friction()? * self.phase.speed.abs())
    }

    /// Power out over power in, of the screw with all its parts; `None` if nothing is done.
    fn efficiency(&self) -> Option<f64> {
        let output = self.ideal * self.phase.speed;
        let input = self.at_screw()? * self.phase.speed;
        let efficiency = if output > 0.0 { output / input } else { input / output };
        (output != 0.0).then_some(efficiency)
    }
}

/// The preload of a nut, and its drag on the screw \[N·m\].
pub(crate) struct Preload {
    /// As it is set, at no rise of temperature \[N\].
    cold: f64,
    /// With the rises of temperature \[N\].
    warm: f64,
    /// As it is measured, by manufacturers' rule.
    by_rule: f64,
    /// Of its contacts alone; `None` without friction.
    of_contacts: Option<f64>,
    /// Of returns and lubricant, beyond the contacts.
    beyond: f64,
}

impl Preload {
    /// That of a nut, if it is preloaded, at a speed \[rad/s\].
    fn of(
        scene: &Scene,
        settings: &Settings,
        machine: &Machine,
        nut: Option<&NutReport>,
        speed: f64,
    ) -> Result<Option<Self>, CaseError> {
        let screw = &machine.axis.screw;
        let by_rule = |preload| drag_torque(preload, screw.lead, screw.lead_angle());
        if let Some(preload) = scene.preload_N.filter(|_| machine.groove.is_none()) {
            let by_rule = by_rule(preload);
            let given = scene.extra_drag_factor.map(|factor| factor * machine.advance() * preload);
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
        let forces = nut.number("preload_set_N").zip(nut.number("warm_preload_N"));
        let Some((cold, warm)) = forces.filter(|_| scene.is_preloaded()) else { return Ok(None) };
        let of_contacts = if speed > 0.0 && scene.given().has_friction() {
            let unloaded = nut_at(scene, settings, 0.0, speed)?;
            unloaded.number("friction_heat_W").map(|heat| heat / speed)
        } else {
            None
        };
        let beyond = ColdNut::of(scene, settings, machine)?.drag(scene, machine)? * warm;
        Ok(Some(Self { cold, warm, by_rule: by_rule(cold), of_contacts, beyond }))
    }
}

/// The screw torque at the operating point of its scene by its parts: the load with weight and guides of what it moves, contacts
/// of the balls, preload, seals, support bearings. `None` without load, speed or friction.
///
/// # Errors
///
/// [`CaseError`] if the nut or its point has no solution.
pub fn torque_parts(scene: &Scene, settings: &Settings) -> Result<Option<ScrewTorque>, CaseError> {
    let scene = &scene.in_warm_state(settings)?;
    let preloaded = scene.is_preloaded() && NEEDS.are_met(scene.given());
    let point = scene.speeds_rpm().zip(scene.axial_load_N).zip(scene.lead());
    let Some((((screw, turned), force), lead)) = point.filter(|_| scene.given().has_friction())
    else {
        return Ok(None);
    };
    let pace = DutySpeed::Turns((screw - turned) * RPM);
    let motion = Motion { time: 1.0, force, pace, acceleration: 0.0, load_factor: 1.0 };
    let phase = motion.phase(&carriage(scene), lead * MM);
    let drag = if preloaded {
        let machine = Machine::of(scene)?;
        let nut = nut_at(scene, settings, phase.load, phase.speed)?;
        let preload = Preload::of(scene, settings, &machine, Some(&nut), phase.speed.abs())?;
        preload.map_or(0.0, |preload| preload.beyond)
    } else {
        0.0
    };
    let (advance, work) = (lead * MM / TAU, &mut ModelWorkspace::default());
    let torques = Torques::of(scene, settings, (advance, drag), &phase, work)?;
    let numbers = read_torques(&torques, |_| true);
    Ok(Some(ScrewTorque { numbers, contacts: torques.contacts.words }))
}

/// Efficiency of the screw in a phase for a search over screws, which has no time for all balls of a preloaded
/// nut: one ball under its equal share, and the friction torque of the preload by manufacturers' rule.
///
/// * `nut`: that of the scene.
pub(crate) fn quick_efficiency(
    scene: &Scene,
    settings: &Settings,
    nut: &Nut,
    phase: &Phase,
    work: &mut ModelWorkspace,
) -> Option<f64> {
    let preload = scene.preload_N.unwrap_or(0.0);
    let single = Scene { preload_N: None, ..scene.clone() };
    let drag = drag_torque(preload, nut.lead, nut.lead_angle());
    let torques = Torques::of(&single, settings, (nut.lead / TAU, drag), phase, work).ok()?;
    torques.efficiency()
}

impl AxisReport {
    /// The axis of a scene.
    ///
    /// * `settings`: the model that friction is calculated with.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if an input is missing or breaks its rule.
    pub fn of(scene: &Scene, settings: &Settings) -> Result<Self, CaseError> {
        Self::with(scene, settings, Detail { fold: true, band: true })
    }

    /// Its numbers and rules, without the notes that take more solutions.
    pub(crate) fn judged(scene: &Scene, settings: &Settings) -> Result<Self, CaseError> {
        Self::with(scene, settings, Detail { fold: true, band: false })
    }

    fn with(asked: &Scene, settings: &Settings, detail: Detail) -> Result<Self, CaseError> {
        refuse_idle(asked)?;
        let asked = &asked.with_preload()?;
        let warm = Warm::with_band(asked, settings, detail)?;
        if let Some(warm) = warm.as_ref().filter(|warm| warm.state.is_none()) {
            return Ok(Self::of_none(asked, settings, warm));
        }
        let scene = &warm.as_ref().map_or_else(|| asked.clone(), |warm| warm.scene(asked));
        let worked = AxisState::of(scene, settings, warm)?;
        if !detail.band {
            // It takes more solutions.
            worked.power_loss.get_or_init(|| None);
        }
        let of_nut = match &worked.machine.groove {
            Some(_) => ratings(&at_largest(scene, &worked.machine.axis))?,
            None => Answer::default(),
        };
        let mut warnings = of_nut.warnings.clone();
        warnings.extend(worked.machine.warning.clone());
        warnings.extend(worked.nut.as_ref().map(NutReport::warnings).unwrap_or_default());
        if let Some(why @ CaseError::Nut(_)) = &worked.no_nut {
            warnings.push(format!("{}; the rules of the preload are not judged", no_balls(why)));
        }
        warnings.extend(worked.warm.iter().filter_map(Warm::warning));
        warnings.sort();
        warnings.dedup();
        let (machine, preload) = (&worked.machine, worked.preload.as_ref());
        let fold = worked.warm.as_ref().and_then(|warm| warm.fold.as_ref()).map(|fold| fold.factor);
        let numbers = read(&worked, |_| true).where_finite();
        let rules = rules::rules(scene, &machine.axis, (&numbers, fold), &of_nut, preload);
        let phases: Vec<_> = worked.torques.iter().map(|torques| worked.phase(torques)).collect();
        let screw = read_screw(&Screw { scene, machine, of_nut: &of_nut, preload }, |_| true);
        let fails = !rules.iter().all(Criterion::passes);
        let mut notes = worked.notes();
        if detail.band {
            notes.extend(worked.how_sure());
            notes.extend(worked.falls());
        }
        let not_modelled = NOT_MODELLED.map(str::to_owned).to_vec();
        let answer = Answer { rules, notes, warnings, fails, ..Answer::default() }
            .with("passes", Content::Json((!fails).into()))
            .with("inputs", Content::Json(asked.to_json()))
            .with("phases", Content::Table(of_phases(&phases)))
            .with("results", Content::numbers(numbers, "axis"));
        let answer = match &worked.warm {
            Some(warm) => warm.add_to(answer),
            None => answer,
        };
        let answer = answer
            .with("screw", Content::numbers(screw, "screw"))
            .with("not_modelled", Content::Texts("not modelled", not_modelled));
        let order = worked.order();
        let answer = answer.with_shown(Content::Words("order:", Some(order.clone())));
        Ok(Self { scene: asked.clone(), settings: *settings, phases, order, answer })
    }

    /// The sheet of an axis that has no warm steady state.
    fn of_none(scene: &Scene, settings: &Settings, warm: &Warm) -> Self {
        let rules = rules::steady_state(warm.fold.as_ref().map(|fold| fold.factor));
        let warnings = warm.warning().into_iter().collect();
        let answer = Answer { rules, warnings, fails: true, ..Answer::default() }
            .with("passes", Content::Json(false.into()))
            .with("inputs", Content::Json(scene.to_json()))
            .with("phases", Content::Table(of_phases(&[])))
            .with("results", Content::numbers(Numbers::none(QUANTITIES), "axis"));
        let answer = warm
            .add_to(answer)
            .with("screw", Content::numbers(Numbers::none(SCREW), "screw"))
            .with("not_modelled", Content::Texts("not modelled", Vec::new()));
        let (phases, order) = (Vec::new(), String::new());
        Self { scene: scene.clone(), settings: *settings, phases, order, answer }
    }

    /// True if every rule holds.
    pub fn passes(&self) -> bool {
        !self.answer.fails
    }

    /// A number by name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.answer.number(name)
    }

    /// Its warm states over the speed; `None` unless they are asked for, or where there are none.
    pub fn warm_branch(&self) -> Option<WarmBranch> {
        WarmBranch::of(&self.scene, &self.settings).ok()?
    }

    /// Points of the speed-force diagram: for a speed \[rpm\] the load that gives the required life \[N\].
    pub fn load_of_life(&self, rpm: f64) -> Option<f64> {
        let hours = self.scene.required_life_h?;
        Some(self.number("modified_dynamic_rating_N")? * (1e6 / (60.0 * rpm * hours)).cbrt())
    }
}

/// The numbers of an axis alone.
///
/// # Errors
///
/// Those of [`AxisReport::of`], and [`CaseError::NoWarmState`] if it runs away.
///
/// * `wanted`: the quantities that are read.
pub(crate) fn numbers(
    scene: &Scene,
    settings: &Settings,
    wanted: impl Fn(&Quantity) -> bool,
) -> Result<Numbers, CaseError> {
    refuse_idle(scene)?;
    let scene = &scene.with_preload()?;
    let mut asked = QUANTITIES.iter().filter(|quantity| wanted(quantity));
    // At one operating point the torque takes no axis.
    if scene.nut.cycle.is_none()
        && asked.all(|quantity| quantity.name == "screw_torque_Nm")
        && let Some(torque) = torque_parts(scene, settings)?
    {
        return Ok(torque.numbers);
    }
    let warm = Warm::state_of(scene, settings)?;
    let scene = &warm.as_ref().map_or_else(|| scene.clone(), |warm| warm.scene(scene));
    Ok(read(&AxisState::of(scene, settings, warm)?, wanted).where_finite())
}

/// A row a phase, of which people see these numbers.
fn of_phases(phases: &[ScrewTorque]) -> Table {
    const SHOWN: [&str; 9] = [
        "time_share",
        "screw_load_N",
        "feed_m_min",
        "screw_speed_rpm",
        "ideal_torque_Nm",
        "screw_torque_Nm",
        "screw_efficiency",
        "motor_torque_Nm",
        "heat_W",
    ];
    let column = |quantity: &Quantity| Column {
        name: quantity.name,
        unit: quantity.unit,
        head: SHOWN.contains(&quantity.name).then_some(quantity.name),
    };
    let contacts = Column::hidden("contacts");
    let columns = PHASE.iter().chain(TORQUES).map(column);
    let row = |(place, phase): (usize, &ScrewTorque)| {
        let numbers = phase.numbers.columns().map(|(_, value)| json!(value));
        std::iter::once(json!(place)).chain(numbers).chain([json!(phase.contacts)]).collect()
    };
    Table {
        columns: std::iter::once(Column::headed("", "phase"))
            .chain(columns)
            .chain([contacts])
            .collect(),
        rows: (1..).zip(phases).map(row).collect(),
        keyed: false,
    }
}

/// Why there are no numbers of the nut with all its balls.
fn no_balls(why: &CaseError) -> String {
    format!("no numbers of all balls: {why}")
}

/// Intermediate results of an axis.
pub(crate) struct AxisState<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    machine: Machine,
    /// The nut under the largest load, with all its balls; or the reason for no solution.
    nut: Option<NutReport>,
    no_nut: Option<CaseError>,
    preload: Option<Preload>,
    torques: Vec<Torques>,
    holding: Option<f64>,
    /// Life by the loads of all balls \[s\].
    life_by_balls: Option<f64>,
    /// What the weight does without power of the motor, found when it is asked for.
    power_loss: OnceCell<Option<PowerLoss>>,
    /// Its warm steady state, if that is asked for.
    warm: Option<Warm>,
    /// For the modified life, if lubricant and contamination are given.
    lubrication: Option<Lubrication>,
}

/// What the weight of an inclined axis does to the screw without power of the motor.
struct PowerLoss {
    /// Torque that drives the screw at the friction of the scene \[N·m\].
    nominal: f64,
    /// Least and largest torque that drives it \[N·m\].
    torques: [f64; 2],
    what: BackDriving,
}

impl<'a> AxisState<'a> {
    fn of(scene: &'a Scene, settings: &'a Settings, warm: Option<Warm>) -> Result<Self, CaseError> {
        let mut machine = Machine::of(scene)?;
        let (axis, advance) = (&machine.axis, machine.advance());
        let mut work = ModelWorkspace::default();
        let heaviest = axis.heaviest().filter(|phase| phase.load != 0.0).copied();
        let fastest = axis.fastest();
        let with_balls = heaviest.filter(|_| machine.groove.is_some());
        let found = with_balls.map(|phase| {
            let speed = if phase.speed == 0.0 { fastest } else { phase.speed };
            nut_at(scene, settings, phase.load, speed)
        });
        let (nut, no_nut) = match found {
            Some(Ok(nut)) => (Some(nut), None),
            Some(Err(why)) => (None, Some(why)),
            None => (None, None),
        };
        let preload = Preload::of(scene, settings, &machine, nut.as_ref(), fastest)?;
        let drag = preload.as_ref().map_or(0.0, |preload| preload.beyond);
        let torque =
            |phase: &Phase| Torques::of(scene, settings, (advance, drag), phase, &mut work);
        let torques = axis.phases.iter().map(torque).collect::<Result<_, _>>()?;
        // The load drives: its sign against the speed.
        let back =
            heaviest.map(|phase| Phase { speed: -phase.load.signum() * fastest.max(RPM), ..phase });
        let back = back.map(|back| contacts(scene, settings, advance, &back, &mut work));
        let holding = back
            .transpose()?
            .and_then(|found| Some((advance * axis.largest_load() - found.friction?).max(0.0)));
        let life_by_balls =
            machine.groove.as_ref().and_then(|_| life_by_balls(scene, settings, axis));
        machine.axis.preload = preload.as_ref().map(|preload| preload.warm);
        let lubrication = Lubrication::of(scene, &machine)?;
        let mut worked = Self {
            scene,
            settings,
            machine,
            nut,
            no_nut,
            preload,
            torques,
            holding,
            life_by_balls,
            power_loss: OnceCell::new(),
            warm,
            lubrication,
        };
        worked.machine.axis.compression = -worked.tension().unwrap_or(0.0).min(0.0);
        Ok(worked)
    }

    fn axis(&self) -> &Axis {
        &self.machine.axis
    }

    fn warm_state(&self) -> Option<&WarmState> {
        self.warm.as_ref()?.state.as_ref()
    }

    fn shaft(&self) -> Option<&Shaft> {
        self.machine.axis.shaft.as_ref()
    }

    /// Life of the cycle; `None` too of a stroke of less than half a turn, which wears a groove by false brinelling.
    fn life(&self) -> Option<Life> {
        let turns = self.scene.stroke_mm.map(|mm| mm * MM / self.axis().screw.lead);
        self.axis().life().filter(|_| turns.is_none_or(|turns| turns >= LEAST_TURNS))
    }

    fn power_loss(&self) -> Option<&PowerLoss> {
        self.power_loss.get_or_init(|| self.at_power_loss()).as_ref()
    }

    /// The screw between two fixed bearings, if it is stretched.
    fn pretension(&self) -> Option<FixedEnds> {
        self.machine.held.filter(|held| held.stretched > 0.0)
    }

    /// Of the screw by a kelvin over its length.
    fn expansion(&self) -> Option<f64> {
        Some(self.scene.value_or_default(InputKey::thermal_expansion_um_m_K)? * UM)
    }

    /// Target of the travel over the stroke for a stretched screw \[mm\].
    fn travel_compensation(&self) -> Option<f64> {
        let kelvin = self.pretension()?.stretched;
        Some(-self.expansion()? * self.scene.stroke_mm? * kelvin)
    }

    /// How much warmer the screw is than the bed \[K\]: as given, or in the steady state.
    fn rise(&self) -> Option<f64> {
        let given = self.scene.screw_temperature_rise_K.filter(|rise| *rise != 0.0);
        given.or_else(|| self.steady_rise())
    }

    /// Tension of the screw \[N\]: as given or found by the warm state, or what its rise leaves of its pretension.
    fn tension(&self) -> Option<f64> {
        let by_rise = || Some(self.machine.held?.tension(self.rise()?));
        self.scene.screw_tension_N.or_else(by_rise)
    }

    /// A number of the nut under the largest load.
    fn of_nut(&self, name: &str) -> Option<f64> {
        self.nut.as_ref()?.number(name)
    }

    /// By the rating of the maker too, which is of the same ball.
    fn static_safety(&self) -> f64 {
        let axis = self.axis();
        let of_balls = self.machine.groove.as_ref().and_then(|(nut, _)| {
            let stated = axis.static_rating / nut.static_rating().rating;
            Some(self.of_nut("static_safety_by_balls")? * stated)
        });
        axis.static_safety().min(of_balls.unwrap_or(f64::INFINITY))
    }

    /// Modified life \[h\] at the usual, the least or the largest contamination factor.
    fn modified_life(&self, place: usize) -> Option<f64> {
        self.life()?;
        let Lubrication { viscosity, fatigue_limit, contamination } = self.lubrication.as_ref()?;
        let life = self.axis().modified_life(*viscosity, contamination[place] * fatigue_limit);
        life.map(|time| time / 3600.0)
    }

    fn grade(&self) -> Option<&'static Grade> {
        Some(self.scene.nut.accuracy_grade?.grade)
    }

    /// Useful travel \[m\].
    fn travel(&self) -> Option<f64> {
        useful_travel(self.scene)
    }

    /// To the surroundings \[W/K\]: given, or that to still air, unless the warm state has its own conductances.
    fn heat_transfer(&self) -> Option<f64> {
        let to_air = || {
            let length = self.shaft().filter(|_| self.warm.is_none())?.length;
            let Machine { body, axis, .. } = &self.machine;
            let speeds = axis.phases.iter().map(|phase| (phase.speed, phase.time));
            Some(heat_transfer((axis.screw.outer, length), (body.outer, body.length), speeds))
        };
        self.scene.axis_heat_transfer_W_K.or_else(to_air)
    }

    fn steady_rise(&self) -> Option<f64> {
        self.shaft()?;
        Some(steady_rise(self.mean_heat()?, self.heat_transfer()?))
    }

    /// Growth of the screw \[um\].
    fn growth(&self) -> Option<f64> {
        if let Some(state) = self.warm_state() {
            return Some(state.growth / UM);
        }
        let left = self.machine.held.map_or(1.0, |held| held.growth_left());
        Some(left * self.shaft()?.growth(self.expansion()?, self.rise()?) / UM)
    }

    /// Stiffness of the nut under the largest load \[N/um\]: of all its balls, or by that of its catalogue.
    fn nut_stiffness(&self) -> Option<f64> {
        let axis = self.axis();
        let by_catalogue = || {
            let stated = self.scene.rated_rigidity_N_um?;
            let at = RigidityAt::from(self.scene.nut.rated_rigidity_at?);
            at.rigidity(stated, axis.largest_load(), axis.preload, self.machine.ratings[0])
        };
        if self.machine.groove.is_some() {
            self.of_nut("nut_stiffness_N_um")
        } else {
            by_catalogue()
        }
    }

    /// Rigidity of screw, nut, bearings and housings in series \[N/m\].
    fn stiffness(&self) -> Option<f64> {
        let Scene { support_bearing_stiffness_N_um, housing_stiffness_N_um, .. } = self.scene;
        let others =
            [*support_bearing_stiffness_N_um, *housing_stiffness_N_um].into_iter().flatten();
        let (screw, nut) = (self.shaft()?.least_stiffness(), self.nut_stiffness()? / UM);
        Some(others.map(|stiffness| stiffness / UM).fold(in_series(screw, nut), in_series))
    }

    /// The largest size of a number of all phases.
    fn peak(&self, number: impl Fn(&Self, &Torques) -> Option<f64>) -> Option<f64> {
        let all: Option<Vec<f64>> =
            self.torques.iter().map(|torques| number(self, torques)).collect();
        Some(all?.into_iter().map(f64::abs).fold(0.0, f64::max))
    }

    fn rms_torque(&self) -> Option<f64> {
        let timed = |torques| Some((self.motor_torque(torques)?, torques.phase.time));
        let all: Option<Vec<_>> = self.torques.iter().map(timed).collect();
        root_mean_square(all?.into_iter())
    }

    fn inertia_at_motor(&self) -> Option<f64> {
        self.machine.screw.map(|_| self.machine.drive.load_inertia())
    }

    /// Load of its weight alone \[N\].
    fn weight(&self) -> f64 {
        self.machine.carriage.load(0.0, 0.0, 0.0).abs()
    }

    /// Its weight, if it turns the screw.
    fn falling(&self) -> Option<Fall> {
        let weight = self.weight();
        (weight > 0.0).then(|| self.machine.drive.falling(weight))
    }

    /// Torque of a brake at the motor: no friction is counted on.
    fn required_brake(&self) -> Option<f64> {
        let safety = self.scene.value_or_default(InputKey::brake_safety)?;
        Some(safety * self.falling()?.torque / self.machine.drive.gear_ratio)
    }

    fn stopping_distance(&self) -> Option<f64> {
        let brake = self.scene.brake_torque_Nm? * self.machine.drive.gear_ratio;
        let delay = self.scene.value_or_default(InputKey::brake_delay_s)?;
        let feed = self.axis().fastest() * self.machine.advance();
        self.falling()?.stopping_distance(brake, delay, feed)
    }

    /// Acceleration of a fall \[m/s²\], and speed of the screw after the stroke \[rpm\]; `None` if friction holds.
    fn fall(&self) -> Option<(f64, f64)> {
        let driving = self.power_loss()?.nominal;
        let acceleration = self.falling()?.acceleration(driving);
        let feed = (2.0 * acceleration * self.scene.stroke_mm? * MM).sqrt();
        (driving > 0.0).then(|| (acceleration, feed / self.machine.advance() / RPM))
    }

    /// Time to the largest speed by the peak torque of the motor \[s\].
    fn least_ramp(&self) -> Option<f64> {
        let Machine { drive, axis, .. } = &self.machine;
        let steady = self.torques.iter().filter(|torques| torques.phase.acceleration == 0.0);
        let loads = steady.map(|torques| Some(self.motor_torque(torques)?.abs()));
        let load = loads.collect::<Option<Vec<_>>>()?.into_iter().fold(0.0, f64::max);
        let speed = axis.fastest() * drive.gear_ratio;
        self.machine.screw?;
        least_acceleration_time(drive.inertia(), speed, self.scene.motor_peak_torque_Nm?, load)
    }

    /// Time to the largest speed at the largest acceleration of the cycle \[s\].
    fn shortest_ramp(&self) -> Option<f64> {
        let sizes = self.axis().phases.iter().map(|phase| phase.acceleration.abs());
        let most = sizes.fold(0.0, f64::max);
        (most > 0.0).then(|| self.axis().fastest() * self.machine.advance() / most)
    }

    /// Time of the cycle \[s\].
    fn time(&self) -> f64 {
        self.torques.iter().map(|torques| torques.phase.time).sum()
    }

    /// The phase of the largest load that moves.
    fn heaviest(&self) -> Option<&Torques> {
        let load = |torques: &&Torques| torques.phase.load.abs();
        let moving = self.torques.iter().filter(|torques| torques.phase.speed != 0.0);
        moving.max_by(|a, b| load(a).total_cmp(&load(b)))
    }

    /// Heat over the cycle \[W\].
    fn mean_heat(&self) -> Option<f64> {
        let heats = self.torques.iter().map(|torques| Some(torques.heat()? * torques.phase.time));
        heats.sum::<Option<f64>>().map(|heat| heat / self.time())
    }

    fn motor_torque(&self, torques: &Torques) -> Option<f64> {
        let Phase { speed, acceleration, .. } = torques.phase;
        Some(self.machine.drive.motor_torque(torques.at_screw()?, speed, acceleration))
    }

    fn motor_power(&self, torques: &Torques) -> Option<f64> {
        let speed = torques.phase.speed * self.machine.drive.gear_ratio;
        Some(self.motor_torque(torques)? * speed)
    }

    /// Defaults that were used.
    fn notes(&self) -> Vec<String> {
        let no_input = self.no_nut.as_ref().filter(|why| !matches!(why, CaseError::Nut(_)));
        let mut notes: Vec<_> = no_input.map(no_balls).into_iter().collect();
        if let Some(Preload { cold, warm, .. }) = self.preload
            && (cold - warm).abs() > 0.0
        {
            notes.push(preload_note(cold, warm));
        }
        notes.extend(self.warm.iter().flat_map(Warm::notes));
        notes.extend(self.nut.as_ref().and_then(NutReport::touch_note));
        notes.extend(self.machine.assumed.iter().cloned());
        notes.extend(self.by_catalogue());
        notes.extend(self.about_life());
        let films = self.machine.groove.is_some();
        notes.extend(self.scene.assumed_roughness().filter(|_| films));
        notes.extend(self.to_measure());
        if let Some(rise) =
            self.steady_rise().filter(|_| self.scene.axis_heat_transfer_W_K.is_none())
        {
            notes.push(format!(
                "steady-state temperature rise estimated within a factor of 2: {rise:.0} K ({:.0} to {:.0} K), by the \
                 heat transfer to still air; axis_heat_transfer_W_K replaces it",
                0.5 * rise,
                2.0 * rise
            ));
        }
        let mut note = |words: &str| notes.push(words.to_owned());
        if let Some(word) = self.scene.nut.accuracy_grade {
            note(&word.describe());
            let Grade { name, .. } = word.grade;
            match self.travel() {
                None => {
                    note("without stroke_mm or useful_travel_mm there is no error of the travel");
                }
                Some(travel) if word.grade.worst_error(travel).is_none() => {
                    let what = if word.grade.deviation(travel).is_some() { "v_up" } else { "e_p" };
                    note(&format!("{name} has no {what} over {:.0} mm", travel / MM));
                }
                Some(_) => {}
            }
        }
        let speed_number = self.axis().speed_number() / (MM * RPM);
        if speed_number > FAST {
            note(
                "above a speed number of some 100 000 mm/min oil or a high-speed grease is usual: ask for the grease",
            );
        }
        if let Some(short) = self.short_stroke() {
            note(&short);
        }
        if self.machine.axis.shaft.is_none() {
            note(
                "without stroke_mm or unsupported_length_mm there is no critical speed, buckling load and inertia of the screw",
            );
            return notes;
        }
        if self.scene.nut.support.is_none() {
            note("support is not given: fixed-supported is taken");
        }
        if let (None, Some(shaft)) = (self.scene.nut.buckling_support, self.shaft()) {
            note(&format!(
                "buckling between fixed bearing and nut: {} (default); buckling_support replaces it",
                shaft.buckling.0.name()
            ));
        }
        if self.scene.unsupported_length_mm.is_none() {
            note("unsupported_length_mm is stroke, length of the nut and two leads");
        }
        notes
    }

    /// What factors of ratings and life were taken, and which are usual.
    fn about_life(&self) -> Vec<String> {
        let (axis, scene) = (self.axis(), self.scene);
        let mut notes = Vec::new();
        if let Some(grade) = self.grade()
            && scene.rated_dynamic_load_N.is_some()
            && scene.accuracy_factor.is_none()
        {
            notes.push(format!(
                "rated_dynamic_load_N is taken as it is printed for grade {}",
                grade.name
            ));
        }
        let unity = axis.phases.iter().all(|phase| phase.load_factor <= 1.0);
        let lives = axis.advised_load_factors().map(|factor| {
            let phases = axis.phases.iter().map(|phase| Phase { load_factor: factor, ..*phase });
            self.life()?;
            Some(Axis { phases: phases.collect(), ..axis.clone() }.life()?.time / 3600.0)
        });
        if let ([Some(long), Some(short)], true) = (lives, unity) {
            let [low, high] = axis.advised_load_factors();
            notes.push(format!(
                "load factor 1; catalogues advise {low} to {high} at this speed: life {long:.0} to {short:.0} h"
            ));
        }
        let contaminated =
            scene.contamination_factor.is_some() || scene.nut.contamination.is_some();
        let lubricated = scene.given().is_lubricated();
        notes.extend(match (&self.lubrication, self.modified_life(0)) {
            (Some(_), None) => {
                Some("no modified life: a viscosity ratio is below 0.1, outside ISO 281".to_owned())
            }
            (None, _) if contaminated => Some(
                "no modified life: contamination without viscosity and lubricant_temperature_C"
                    .to_owned(),
            ),
            (None, _) if lubricated => {
                Some("no modified life: contamination is not given".to_owned())
            }
            _ => None,
        });
        notes
    }

    /// What a stroke of a few nut lengths does to the life.
    fn short_stroke(&self) -> Option<String> {
        let stroke = self.scene.stroke_mm? * MM;
        let (lengths, factor) = SHORT;
        if stroke < LEAST_TURNS * self.axis().screw.lead {
            return Some(
                "a stroke of less than half a turn has no life by fatigue: false brinelling"
                    .to_owned(),
            );
        }
        let circuits = self.scene.value_or_default(InputKey::circuits_count)?;
        // The balls of a circuit advance by (1 − γ)/2 of the nut.
        let round = self.machine.groove.as_ref().map(|(nut, _)| {
            2.0 * nut.turns / circuits * nut.lead / (1.0 - nut.dynamic_rating().gamma)
        });
        if let Some(round) = round.filter(|round| stroke < *round) {
            return Some(format!(
                "a stroke of less than {:.0} mm does not circulate the balls, the same ones carry: make a stroke of two nut \
                 lengths every few thousand strokes (usual advice)",
                round / MM
            ));
        }
        let life = self.life()?.time / 3600.0 / factor.powi(3);
        (stroke < lengths * self.machine.body.length).then(|| {
            format!(
                "a stroke of less than three nut lengths: HIWIN's load factor is 3 to 5, and the life at {factor} is {life:.0} h"
            )
        })
    }

    /// What the sheet of a screw without groove omits, and the band of its torque.
    fn by_catalogue(&self) -> Vec<String> {
        if self.machine.groove.is_some() {
            return Vec::new();
        }
        let at = self.heaviest().and_then(|heaviest| {
            let torque = heaviest.at_screw()?;
            let drives = heaviest.phase.load * heaviest.phase.speed < 0.0;
            let friction = contacts::by_catalogue(self.scene).friction(heaviest.ideal, drives);
            let [high, low] = contacts::usual_frictions(heaviest.ideal, drives)
                .map(|usual| torque + (usual - friction) * heaviest.phase.speed.signum());
            Some(format!(
                "torque by catalogue efficiency, {torque:.3} N m at the largest load that moves; usual efficiencies give {low:.3} to \
                 {high:.3} N m"
            ))
        });
        at.into_iter().chain([LEFT_OUT.to_owned()]).collect()
    }

    /// Uncertainty of the torque where friction comes from a lubricant.
    fn how_sure(&self) -> Option<String> {
        let heaviest = self.heaviest()?;
        let phase = &heaviest.phase;
        let work = &mut ModelWorkspace::default();
        let [low, high] = contacts::band(self.scene, self.settings, phase, work)?;
        let friction = heaviest.contacts.friction?;
        Some(format!(
            "friction from the lubricant: at {:.0} N and {:.0} rpm the 90 % interval over uncertain inputs lies \
             between {:.3} and {:.3} N m, of {friction:.3} N m of the contacts",
            phase.load,
            phase.speed / RPM,
            low * friction,
            high * friction
        ))
    }

    /// What to order: size, nut, preload, grade, length, torque of the preload, travel, ends.
    fn order(&self) -> String {
        let screw = &self.axis().screw;
        let mm = |metres: f64| trimmed(metres / MM);
        // The land is no nominal diameter.
        let nominal = self.scene.nominal_diameter_mm.or(self.scene.screw_outer_diameter_mm);
        let pitch = || format!("pitch circle {}", mm(screw.pitch_diameter));
        let size = nominal.map_or_else(pitch, trimmed);
        let mut parts = vec![format!("{size} x {}", mm(screw.lead))];
        if let Some((nut, _)) = &self.machine.groove {
            let circuits = self.scene.value_or_default(InputKey::circuits_count).unwrap_or(1.0);
            let of_each = trimmed(nut.turns / circuits);
            let turns = if circuits > 1.0 { format!("{circuits} x {of_each}") } else { of_each };
            parts.extend([format!("{turns} turns"), format!("ball {}", mm(nut.ball_diameter))]);
        }
        let method = match preload_method(self.scene) {
            PreloadMethod::DoubleNut => "double nut",
            PreloadMethod::Offset => "nut with a shifted lead",
            PreloadMethod::Oversize => "oversize balls",
        };
        match &self.preload {
            Some(preload) => {
                parts.extend([method.to_owned(), format!("preload {:.0} N", preload.cold)]);
            }
            None => parts.push("single nut".to_owned()),
        }
        parts.extend(self.grade().map(|grade| grade.name.to_owned()));
        parts.extend(self.shaft().map(|shaft| format!("thread {:.0}", shaft.length / MM)));
        if let Some(preload) = &self.preload {
            let percent = self.torque_percent();
            let percent = percent.map_or_else(String::new, |percent| format!(" +-{percent:.0} %"));
            parts.push(format!("T_p0 {:.2} N m{percent}", preload.by_rule));
        }
        if let (Some(target), Some(stroke)) = (self.travel_compensation(), self.scene.stroke_mm) {
            parts.push(format!("T = {target:.3}/{stroke:.0}"));
        }
        parts.extend(self.shaft().map(|shaft| shaft.support.name().to_owned()));
        parts.join(", ")
    }

    /// Permitted variation of the torque by which the preload is checked \[%\].
    fn torque_percent(&self) -> Option<f64> {
        let (torque, diameter) = (self.preload.as_ref()?.by_rule, self.axis().screw.outer);
        self.grade()?.torque_variation(torque, self.shaft()?.length, diameter)
    }

    /// That torque at an end of its variation.
    fn torque_by(&self, side: f64) -> Option<f64> {
        Some(self.preload.as_ref()?.by_rule * (1.0 + side * 0.01 * self.torque_percent()?))
    }

    /// The torque by which the preload is checked, with its tolerance.
    fn to_measure(&self) -> Option<String> {
        let torque = self.preload.as_ref()?.by_rule;
        let ends = [-1.0, 1.0].map(|side| self.torque_by(side));
        let tolerance = match (ends, self.torque_percent(), self.grade()) {
            ([Some(low), Some(high)], Some(percent), Some(grade)) => {
                format!("{low:.3} to {high:.3}, +-{percent:.0} % by {}", grade.name)
            }
            _ => "no tolerance is specified for this torque, length and accuracy_grade".to_owned(),
        };
        let seal = self.scene.seal_torque_Nm.filter(|seal| *seal > 0.0);
        let with_seals = seal
            .map_or_else(String::new, |seal| format!("; with the seals {:.3} N m", torque + seal));
        Some(format!(
            "friction torque of the preload to measure: {torque:.3} N m ({tolerance}) at 100 rpm, oil of ISO VG 68, \
             without wipers{with_seals}"
        ))
    }

    /// Whether its weight turns the screw of an inclined axis when the motor has no power (Z18).
    fn at_power_loss(&self) -> Option<PowerLoss> {
        /// Friction that is not measured, over that of the scene.
        const FRICTION: [f64; 2] = [2.0, 0.5];
        let (axis, settings, advance) = (self.axis(), self.settings, self.machine.advance());
        let ideal = self.falling()?.torque;
        let speed = -axis.fastest().max(RPM);
        let phase =
            Phase { time: 1.0, load: self.weight(), speed, acceleration: 0.0, load_factor: 1.0 };
        let work = &mut ModelWorkspace::default();
        let mut friction =
            |scene: &Scene| contacts(scene, settings, advance, &phase, work).ok()?.friction;
        let nominal = friction(self.scene)?;
        let [most, least] = if self.machine.groove.is_none() {
            let [most, least] = contacts::usual_frictions(ideal, true);
            [Some(most.max(nominal)), Some(least.min(nominal))]
        } else if let Some(coefficient) = self.scene.friction_coefficient {
            FRICTION.map(|factor| {
                let friction_coefficient = Some(factor * coefficient);
                friction(&Scene { friction_coefficient, ..self.scene.clone() })
            })
        } else {
            let [low, high] = contacts::band(self.scene, settings, &phase, work)?;
            [high, low].map(|factor| Some(factor * nominal))
        };
        let value = |key| self.scene.value_or_default(key).unwrap_or(0.0);
        let drag = self.preload.as_ref().map_or(0.0, |preload| preload.beyond)
            + value(InputKey::seal_torque_Nm)
            + value(InputKey::support_bearing_torque_Nm);
        let (torques, what) = BackDriving::of([ideal - most?, ideal - least?], drag);
        Some(PowerLoss { nominal: ideal - nominal - drag, torques, what })
    }

    /// The same in words, with the brake.
    fn falls(&self) -> Option<String> {
        let PowerLoss { torques: [low, high], what, .. } = self.power_loss()?;
        let words = match what {
            BackDriving::Turns => "the weight turns the screw; a brake is needed",
            BackDriving::Undecided => "the weight may turn the screw; take a brake",
            BackDriving::Holds => {
                "friction holds the weight; vibration can loosen it, which is no safety function"
            }
        };
        let brake = self.required_brake()?;
        let safety = self.scene.value_or_default(InputKey::brake_safety)?;
        let holds = match (self.scene.brake_torque_Nm, self.stopping_distance()) {
            (Some(_), Some(way)) => format!("; that given stops it within {:.1} mm", way / MM),
            (Some(_), None) => "; that given does not hold".to_owned(),
            (None, _) => String::new(),
        };
        Some(format!(
            "without power of the motor {words}: {low:.3} to {high:.3} N m drive the screw; brake of at least {brake:.3} N m \
             at the motor, {safety} times the weight without friction{holds}"
        ))
    }

    fn phase(&self, torques: &Torques) -> ScrewTorque {
        let motion = read_phase(&PhaseResult { worked: self, torques }, |_| true);
        let numbers = motion.and(read_torques(torques, |_| true));
        ScrewTorque { numbers, contacts: torques.contacts.words.clone() }
    }
}

/// Refuses an input of the warm state in a scene that neither asks for it nor leaves it out.
fn refuse_idle(scene: &Scene) -> Result<(), CaseError> {
    // These act without it too.
    let act = [InputKey::preload_temperature_C, InputKey::screw_tension_N];
    let is_idle = |key: &InputKey| key.input().title == "warm state" && !act.contains(key);
    let idle = scene.given().iter().find(is_idle).filter(|_| scene.nut.warm_state.is_none());
    match idle {
        Some(key) => Err(bad(key.name(), "has no effect without warm_state: true, or false")),
        None => Ok(()),
    }
}

/// A scene at the largest load and speed of its axis, for the ratings.
fn at_largest(scene: &Scene, axis: &Axis) -> Scene {
    let mut scene = scene.cold();
    let load = axis.largest_load();
    (scene.axial_load_N, scene.feed_m_min) = (Some(load).filter(|load| *load > 0.0), None);
    let rpm = axis.fastest() / RPM;
    (scene.screw_speed_rpm, scene.nut_speed_rpm) = (Some(rpm).filter(|rpm| *rpm > 0.0), None);
    // The load has the mass, and the warm preload is judged by itself.
    scene.moved_mass_kg = None;
    scene
}

/// Life of the cycle by the loads of all balls \[s\]: each phase takes its share of the life that it has alone.
fn life_by_balls(scene: &Scene, settings: &Settings, axis: &Axis) -> Option<f64> {
    let (mut taken, mut time) = (0.0, 0.0);
    for phase in &axis.phases {
        time += phase.time;
        let moves = phase.speed != 0.0 && (phase.load != 0.0 || scene.is_preloaded());
        if moves {
            let load = phase.load_factor * phase.load;
            let nut = nut_at(scene, settings, load, phase.speed).ok()?;
            let ours = nut.number("life_by_balls_revolutions")?;
            let rated = nut.number("iso_life_revolutions")?;
            // The ratio is of the model, the rating may be of the maker.
            let preload = nut.number("warm_preload_N").filter(|_| scene.is_preloaded());
            let duty = bsm_design::Duty { load, speed: 1.0, time: 1.0 };
            let stated = life(axis.dynamic_rating, preload, &[duty])?.revolutions;
            let turns = phase.speed.abs() * phase.time / TAU;
            taken += turns / (stated * ours / rated);
        }
    }
    (taken > 0.0).then(|| time / taken)
}
