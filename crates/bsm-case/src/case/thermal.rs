//! Thermal data of an axis: surfaces, given conductances, screw and surroundings.

use bsm_design::shaft::EndFixity;
use bsm_dyn::lubrication::ZERO_CELSIUS;
use bsm_nut::thermal::{
    AxialConstraint, BallLink, Coolant, NutSize, ScrewBar, Surfaces, Surroundings, ThermalAxis,
    coolant_conductance,
};

use crate::case::axis::AxisModel;
use crate::vocabulary::entries::Named;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::UM;
use crate::{Case, CaseError, InputKey};

/// Default temperature of the surrounding air \[°C\].
const DEFAULT_AIR_CELSIUS: f64 = 20.0;

/// Typical torques of the seals and of all support bearings of a screw with [`USUAL_DIAMETER`]
/// \[N·m\]. For other screws, the torques are proportional to the square of the diameter.
const USUAL_TORQUES: (f64, f64) = (0.2, 0.3);

/// Screw diameter to which [`USUAL_TORQUES`] apply \[m\].
const USUAL_DIAMETER: f64 = 0.040;

/// Returns the temperature at which the preload is set \[K\].
pub(crate) fn set_temperature(case: &Case) -> f64 {
    case.number(InputKey::preload_temperature_C) + ZERO_CELSIUS
}

/// Returns the temperature of the air minus the temperature at which the preload is set \[K\].
pub(crate) fn air_over_set(case: &Case) -> f64 {
    case.ambient_temperature_C.unwrap_or(DEFAULT_AIR_CELSIUS) + ZERO_CELSIUS - set_temperature(case)
}

/// Returns the temperature of the structure that carries the screw bearings minus the temperature
/// at which the preload is set \[K\].
pub(crate) fn bed_over_set(case: &Case) -> f64 {
    let given = case.structure_temperature_C;
    given.map_or(air_over_set(case), |celsius| celsius + ZERO_CELSIUS - set_temperature(case))
}

/// Returns typical torques of the seals and of all support bearings \[N·m\]. The value is 0 for a
/// torque that is given in the case.
///
/// * `nominal`: nominal diameter of the screw \[m\].
pub(crate) fn missing_torques(case: &Case, nominal: f64) -> (f64, f64) {
    let scale = (nominal / USUAL_DIAMETER).powi(2);
    let missing = |given: Option<f64>, usual: f64| given.map_or(scale * usual, |_| 0.0);
    (
        missing(case.seal_torque_Nm, USUAL_TORQUES.0),
        missing(case.support_bearing_torque_Nm, USUAL_TORQUES.1),
    )
}

/// Returns the thermal data of the axis, or `None` if the length of the screw is unknown or too
/// short for the nut.
///
/// * `link`: heat transfer between nut and screw through the balls.
///
/// # Errors
///
/// Returns [`CaseError`] if the thread is longer than the unsupported length, or if coolant flows
/// through a screw without a bore.
pub(crate) fn thermal_axis(
    case: &Case,
    machine: &AxisModel,
    link: BallLink,
) -> Result<Option<ThermalAxis>, CaseError> {
    let (Some(shaft), Some(travel)) = (&machine.axis.shaft, machine.covered(case)?) else {
        return Ok(None);
    };
    if case.coolant_flow_l_min.is_some() && case.screw_bore_mm.is_none() {
        return Err(invalid_input("coolant_flow_l_min", "needs screw_bore_mm"));
    }
    let flow = case.coolant_flow_l_min.map(|flow| {
        let coolant = case.entries.coolant.map_or(Coolant::Water, |Named(coolant)| coolant);
        coolant_conductance(coolant, flow / 6e4, shaft.bore.diameter, shaft.length)
    });
    let constraint = machine.held.map(|held| AxialConstraint {
        stiffness: held.shaft.constraint_stiffness(held.bearing),
        pretension: held.tension(0.0),
        youngs_modulus: shaft.youngs_modulus,
        poisson_ratio: case.number(InputKey::poisson_ratio),
    });
    let air = air_over_set(case);
    let coolant = case.coolant_temperature_C;
    Ok(Some(ThermalAxis {
        surfaces: Surfaces {
            diameter: machine.axis.screw.pitch_diameter,
            lead: machine.axis.screw.lead,
            size: NutSize { outer_diameter: machine.body.outer, length: machine.body.length },
            carriage: case.carriage_area_m2,
            driven: machine.axis.driven,
            link,
            nut: case.nut_conductance_W_K,
            screw_film: case.screw_film_W_m2K,
            gap: case.gap_conductance_W_K,
            ball_nut: case.ball_nut_conductance_W_K,
            ball_screw: case.ball_screw_conductance_W_K,
            end: case.end_conductance_W_K,
            coolant: case.coolant_conductance_W_K.or(flow).unwrap_or(0.0),
            nut_coolant: case.number(InputKey::nut_coolant_conductance_W_K),
        },
        changed_estimate: None,
        screw: ScrewBar {
            diameter: machine.axis.screw.pitch_diameter,
            length: shaft.length,
            travel,
            section: shaft.section(),
            conductivity: case.number(InputKey::steel_conductivity_W_m_K),
            expansion: case.number(InputKey::thermal_expansion_um_m_K) * UM,
            bearings: [true, shaft.support != EndFixity::FixedFree],
            constraint,
        },
        surroundings: Surroundings {
            air,
            structure: bed_over_set(case),
            coolant: coolant.map_or(air, |celsius| celsius + ZERO_CELSIUS - set_temperature(case)),
        },
    }))
}
