//! Axis sheet of a screw: loads in the duty cycle, torque, and every design rule with its value,
//! limit and source.

mod contacts;
mod drive;
mod heat;
mod lubrication;
mod notes;
mod order;
mod rules;
mod state;
mod sufficiency;
mod torques;

use bsm_design::groove::FEW_DRAWS;
use bsm_design::shaft::warming_time;
use bsm_design::statistics::Band;
use bsm_design::{Axis, Bounds, Nut, in_series};
use bsm_dyn::ModelWorkspace;
use serde_json::json;

use self::heat::Heating;
pub use self::order::Order;
pub(crate) use self::rules::{NO_LOAD, rule_titles};
use self::state::AxisState;
pub(crate) use self::sufficiency::missing_for_rule;
pub(crate) use self::torques::quick_efficiency;
use self::torques::{PhaseTorques, Preload, Torques};
pub use self::torques::{ScrewTorque, torque_parts};
pub(crate) use self::torques::{TORQUES, TorqueParts};
use super::nut::QUANTITIES as NUT;
use super::ratings::{QUANTITIES as RATINGS, ratings_and_warnings};
use super::schema::CaseJson;
use super::warm::QUANTITIES as WARM;
use crate::case::axis::AxisModel;
use crate::case::axis_inputs::{operating_hours_per_year, stroke};
use crate::case::rated_nut;
use crate::case::warm::{Detail, NutInPhase, Warm};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input::InputGroup;
use crate::vocabulary::members::{
    Data, NumberCells, NumbersOf, Rows, Sentences, answer, number_tables, row,
};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, RPM, UM};
use crate::vocabulary::warning::{SelectionLimit, Warning};
use crate::{
    Answer, Case, CaseError, Content, Criterion, INPUTS, InputKey, InputSet, Numbers, NutReport,
    Output, OutputName, Quantity, Row, Section, Settings, Verdict, WarmBranch, output,
};

/// Required inputs of an axis: the inputs that describe its nut, and either a load and a speed or a
/// duty cycle.
pub(crate) const NEEDS: crate::case::problem::Needs = rated_nut::NEEDS;

/// Alternative inputs that determine the friction of the nut; at least one is required.
const FRICTION: &[InputSet] = quantities!(@needs [
    friction_coefficient | lubricant_temperature_C | catalog_efficiency | rated_dynamic_load_N
]);

/// Inputs required for the modified life.
const MODIFIED_LIFE: &[InputSet] =
    quantities!(@needs [lubricant_temperature_C, contamination_factor]);

quantities! { pub(crate) QUANTITIES, read(&AxisState<'_>) of Axis;
    "the cycle" {
        largest_load_N ["N"] Scalar(|w| w.axis().largest_load()), "largest axial load on the screw";
        largest_speed_rpm ["rpm"] Scalar(|w| w.axis().fastest() / RPM), "largest relative speed between screw and nut";
        largest_feed_m_min ["m/min"] Scalar(|w| w.axis().fastest() * w.machine.advance() * 60.0), "largest feed";
        equivalent_load_N ["N" "F_m"] Scalar(|w| Some(w.life()?.mean_load)),
            "equivalent load of the more heavily loaded flank; for a pair, of the more heavily loaded nut";
        equivalent_load_of_other_flank_N ["N" "F_m2"] Scalar(|w| Some(w.life()?.other_mean_load).filter(|load| *load > 0.0)),
            "equivalent load of the less heavily loaded flank or nut, which also reduces the life; empty if this flank or nut carries no load";
        equivalent_speed_rpm ["rpm" "n_m"] Scalar(|w| Some(w.life()?.mean_speed / RPM)), "equivalent speed: mean speed over the cycle, including standstill";
        cycle_time_s ["s"] Scalar(|w| w.cycle_time()), "cycle time";
        revolutions_per_cycle [""] Scalar(|w| w.revolutions_per_cycle()), "revolutions of the screw per cycle, in both directions";
        travel_per_cycle_mm ["mm"] Scalar(|w| Some(w.machine.cycle?.1.distance / MM)), "travel per cycle, in both directions";
        cycle_range_mm ["mm"] Scalar(|w| Some(w.machine.cycle?.1.range / MM)), "distance between the two extreme positions of the cycle";
        cycle_return_mm ["mm"] Scalar(|w| Some(w.machine.cycle?.1.end / MM)), "distance between the start position and the end position of the cycle; 0 if the cycle returns to its start";
        speed_jumps_count [""] Scalar(|w| w.speed_jumps().map(|count| u32::try_from(count).map_or(f64::INFINITY, f64::from))), "number of speed jumps in the cycle";
    }
    "screw and bearings" {
        unsupported_length_mm = INPUTS Scalar(|w| Some(w.shaft()?.length / MM));
        shaft_diameter_mm = INPUTS Scalar(|w| Some(w.shaft()?.diameter / MM));
        critical_speed_rpm ["rpm" "n_k"] Scalar(|w| Some(w.shaft()?.critical_speed() / RPM)), "critical speed";
        critical_speed_ratio [""] Scalar(|w| w.shaft().and(w.axis().critical_speed_ratio())), "speed / critical speed; includes compression due to constrained thermal expansion. Calculated only if the screw turns";
        nut_resonance_ratio [""] Scalar(|w| w.shaft().and(w.axis().nut_resonance_ratio())), "largest speed of a driven nut / critical speed of its screw";
        critical_speed_warm_rpm ["rpm"] Scalar(|w| {
            let compression = Some(w.axis().compression).filter(|force| *force > 0.0)?;
            Some(w.shaft()?.critical_speed_under(-compression) / RPM)
        }), "critical speed of the screw, including compression due to constrained thermal expansion";
        buckling_load_N ["N" "F_k"] Scalar(|w| Some(w.shaft()?.buckling_load())), "buckling load";
        buckling_safety [""] Scalar(|w| w.shaft().and(w.axis().buckling_safety())), "buckling safety factor";
        buckling_load_of_support_N ["N"] Scalar(|w| Some(w.shaft()?.with_buckling_of_support().buckling_load())),
            "buckling load for the end conditions that the input support specifies";
        buckling_safety_of_support [""] Scalar(|w| w.axis().buckling_safety_of_support()), "buckling safety factor with the end conditions of the input support";
        yield_load_N ["N"] Scalar(|w| w.yield_load()), "permissible axial load at a core stress of 147 N/mm2";
        largest_speed_number_mm_min ["mm/min" "d_pw n"] Scalar(|w| w.axis().speed_number() / (MM * RPM)), "largest speed number";
        pretension_N = INPUTS Scalar(|w| Some(w.pretension()?.tension(0.0)));
        pretension_K = INPUTS Scalar(|w| Some(w.pretension()?.stretched));
        stretch_um ["um"] Scalar(|w| {
            Some(w.pretension()?.tension(0.0) / w.shaft()?.constraint_stiffness(f64::INFINITY) / UM)
        }), "elongation of the screw due to pretension";
        travel_compensation_um ["um" "c"] Scalar(|w| Some(w.travel_compensation()? * MM / UM)), "travel compensation over the stroke for a screw with pretension; a negative value means a shorter travel";
        screw_tension_N = INPUTS Scalar(|w| w.tension());
        stretched_critical_speed_rpm ["rpm"] Scalar(|w| {
            let tension = w.pretension()?.tension(0.0);
            Some(w.shaft()?.critical_speed_under(tension) / RPM)
        }), "critical speed with the tension of the cold screw; for information only";
        pretension_for_no_slack_K ["K"] Scalar(|w| w.machine.held.and(w.rise())), "smallest pretension that keeps the warm screw in tension between two fixed bearings";
        support_bearing_load_cold_N ["N"] Scalar(|w| w.bearing_loads()?[0]), "load on two fixed support bearings while the screw is cold: largest load plus pretension";
        support_bearing_load_warm_N ["N"] Scalar(|w| w.bearing_loads()?[1]), "load on two fixed support bearings while the screw is warm: largest load plus tension or compression";
        support_bearing_load_N ["N"] Scalar(|w| w.bearing_load()), "largest load on the support bearings, cold or warm";
        thread_length_mm ["mm"] Scalar(|w| Some(w.machine.thread? / MM)), "length of the thread: stroke, nut set and overrun at both ends";
        screw_mass_kg ["kg"] Scalar(|w| w.shaft().and(w.machine.screw).map(|screw| screw.mass)), "mass of the screw between its bearings";
        mass_of_nut_and_screw_kg ["kg"] Scalar(|w| {
            let screw = w.shaft().and(w.machine.screw)?;
            Some(screw.mass + w.machine.nut_mass?)
        }), "mass of nut and screw between the bearings";
        axis_heat_transfer_W_K = INPUTS Scalar(|w| w.case.axis_heat_transfer_W_K);
        steady_temperature_rise_K ["K"] Scalar(|w| w.steady_rise()) needs FRICTION,
            "steady-state temperature rise of the screw above the surroundings, mean between the bearings";
        nut_rise_K ["K"] Scalar(|w| w.node_rise(0)) needs FRICTION, "steady-state temperature rise of the nut above the surroundings";
        screw_rise_K ["K"] Scalar(|w| w.node_rise(1)) needs FRICTION, "steady-state temperature rise of the screw section that the nut travels along, above the surroundings";
        end_1_rise_K ["K"] Scalar(|w| w.node_rise(3)) needs FRICTION, "steady-state temperature rise of the screw end at the motor, above the surroundings";
        end_2_rise_K ["K"] Scalar(|w| w.node_rise(4)) needs FRICTION, "steady-state temperature rise of the other screw end, above the surroundings";
        steady_temperature_rise_low_K ["K"] Scalar(|w| Some(w.heating?.band?[0])), "lower bound of the steady-state temperature rise, considering the uncertainty of conductances and heat sources";
        steady_temperature_rise_high_K ["K"] Scalar(|w| Some(w.heating?.band?[1])), "upper bound of the steady-state temperature rise, with typical values for missing friction torques";
        steady_temperature_time_s ["s" "tau"] Scalar(|w| {
            let transfer = w.mean_heat().filter(|heat| *heat > 0.0)? / w.steady_rise()?;
            Some(warming_time(w.machine.screw?.mass, transfer))
        }),
            "time constant of the screw temperature: heat capacity of the screw / (mean heat flow / steady-state temperature rise)";
        screw_growth_um ["um"] Scalar(|w| w.growth()),
            "thermal elongation of the screw that the bearings permit; for a warm state, the unconstrained elongation";
        free_growth_um ["um" "D_l"] Scalar(|w| Some(w.free_growth()? / UM)), "free thermal growth of the screw, not constrained by bearings";
        travel_deviation_um ["um" "e_p"] Scalar(|w| Some(w.grade()?.deviation(w.travel()?)? / UM)),
            "e_p (ISO 3408-3 or JIS B 1192), permitted mean deviation of the travel over the useful travel";
        travel_variation_um ["um" "v_up"] Scalar(|w| Some(w.grade()?.variation_of_travel(w.travel()?)? / UM)),
            "v_up (ISO 3408-3 or JIS B 1192), permitted travel variation over the useful travel";
        travel_variation_300_um ["um" "v_300p"] Scalar(|w| Some(w.grade()?.variation / UM)),
            "v_300p (ISO 3408-3 or JIS B 1192), travel variation within any 300 mm";
        travel_variation_2pi_um ["um" "v_2pip"] Scalar(|w| Some(w.grade()?.of_a_turn? / UM)),
            "v_2pip (ISO 3408-3), travel variation within any turn";
        travel_error_worst_um ["um"] Scalar(|w| Some(w.grade()?.worst_error(w.travel()?)? / UM)),
            "largest permitted travel error according to accuracy_grade";
    }
    "temperature" {
        nut_heat_W = WARM Scalar(|w| match w.warm_state() {
            Some(state) => Some(state.steady.nut_heat()),
            None => Some(w.powers()?.given.of_nut()),
        });
        nut_conductance_W_K = INPUTS Scalar(|w| Some(w.heating?.nodes?.1.nut));
        screw_film_W_m2K = INPUTS Scalar(|w| Some(w.heating?.nodes?.1.screw_film));
    }
    "nut and life" {
        static_safety_factor ["" "f_s"] Scalar(|w| w.static_safety()), "static safety factor; the smaller of the values from the static load rating and from the most loaded ball";
        cycle_life_revolutions ["" "L"] Scalar(|w| Some(w.life()?.revolutions)), "life under the cycle according to ISO 3408-5, revolutions";
        cycle_life_h ["h" "L_h"] Scalar(|w| Some(w.life()?.time / 3600.0)), "life under the cycle according to ISO 3408-5";
        cycle_life_km ["km"] Scalar(|w| Some(w.life()?.revolutions * w.axis().screw.lead / 1e3)), "life under the cycle as travel in both directions";
        cycle_life_cycles [""] Scalar(|w| Some(w.life()?.revolutions / w.revolutions_per_cycle()?)), "life in cycles";
        cycle_life_strokes [""] Scalar(|w| Some(w.life()?.revolutions * w.axis().screw.lead / w.machine.stroke?)), "life under the cycle in strokes of stroke_mm";
        cycle_life_years [""] Scalar(|w| Some(w.life()?.time / 3600.0 / operating_hours_per_year(w.case)?)), "life under the cycle in years, according to operating_h_day and operating_days_year";
        required_life_revolutions = INPUTS Scalar(|w| w.required_revolutions());
        required_dynamic_load_N ["N"] Scalar(|w| w.required_rating()), "required dynamic load rating for one million revolutions, including its factors";
        required_dynamic_load_in_basis_N ["N"] Scalar(|w| w.required_rating_in_basis()), "required dynamic load rating for the reference travel in rating_basis, without factors";
        modified_dynamic_rating_N ["N" "C_am"] Scalar(|w| w.axis().dynamic_rating), "modified dynamic load rating; includes the factors for accuracy, hardness and steel";
        modified_static_rating_N ["N" "C_0am"] Scalar(|w| w.axis().static_rating), "modified static load rating; includes the factors for accuracy and hardness";
        fatigue_load_limit_N ["N" "C_u"] Scalar(|w| w.lubrication.as_ref().map(|found| found.fatigue_limit)) needs MODIFIED_LIFE,
            "fatigue load limit, at a maximum pressure of 1500 MPa";
        modified_life_h ["h" "L_nm"] Scalar(|w| w.modified_life(0)) needs MODIFIED_LIFE,
            "modified life under the cycle according to ISO 281, which takes lubricant and contamination into account";
        modified_life_low_h ["h"] Scalar(|w| w.modified_life(1)) needs MODIFIED_LIFE,
            "modified life at the smallest contamination factor";
        modified_life_high_h ["h"] Scalar(|w| w.modified_life(2)) needs MODIFIED_LIFE,
            "modified life at the largest contamination factor";
        cycle_life_by_balls_h ["h"] Scalar(|w| Some(w.axis().reliability * w.life_by_balls? / 3600.0)), "life under the cycle, calculated from the loads of all balls";
        limit_load_N = NUT Scalar(|w| w.of_nut(output!(limit_load_N)));
    }
    "stiffness" {
        screw_stiffness_N_um ["N/um" "R_s"] Scalar(|w| Some(w.shaft()?.least_stiffness() * UM)), "minimum axial stiffness of the screw";
        nut_stiffness_at_largest_load_N_um ["N/um"] Scalar(|w| w.nut_stiffness()),
            "stiffness of the nut at the largest load; tangent stiffness of all balls, or 0.8 times the catalog stiffness";
        axis_stiffness_N_um ["N/um"] Scalar(|w| Some(w.stiffness()? * UM)), "stiffness of screw, nut, bearings and housings in series";
        torsional_stiffness_N_um ["N/um" "K_t"] Scalar(|w| Some(w.torsional_stiffness()? * UM)), "axial stiffness due to the torsion of the screw, for the nut position with the lowest stiffness";
        natural_frequency_Hz ["Hz"] Scalar(|w| w.natural_frequency(w.stiffness()?)), "natural frequency that results from the moved mass and the axis stiffness";
        natural_frequency_with_torsion_Hz ["Hz"] Scalar(|w| w.natural_frequency(in_series(w.stiffness()?, w.torsional_stiffness()?))), "natural frequency that results from the moved mass and the axis stiffness, including the torsion of the screw";
        lost_motion_um ["um"] Scalar(|w| Some(w.lost_motion()? / UM)), "lost motion on reversal: elastic displacement, plus the axial play of a nut without preload";
    }
    "drive" {
        motor_speed_rpm ["rpm"] Scalar(|w| w.axis().fastest() * w.machine.drive.gear_ratio / RPM), "largest speed of the motor";
        peak_motor_torque_Nm ["N m"] Scalar(|w| w.peak(AxisState::motor_torque)) needs FRICTION, "peak motor torque at the start and end of all phases";
        rms_motor_torque_Nm ["N m"] Scalar(|w| w.rms_torque()) needs FRICTION, "RMS motor torque";
        peak_torque_utilization [""] Scalar(|w| w.peak(AxisState::torque_utilization)) needs FRICTION, "largest ratio of the motor torque to the peak torque of motor_curve at the same speed";
        continuous_torque_at_mean_speed_Nm ["N m"] Scalar(|w| w.continuous_torque()), "continuous torque of motor_curve at the mean speed of the motor";
        rms_torque_utilization [""] Scalar(|w| Some(w.rms_torque()? / w.continuous_torque()?)) needs FRICTION, "ratio of the RMS motor torque to the continuous torque of motor_curve at the mean speed";
        peak_motor_power_W ["W"] Scalar(|w| w.peak(AxisState::motor_power)) needs FRICTION, "peak motor power";
        regenerated_energy_J ["J"] Scalar(|w| w.regenerated_energy()) needs FRICTION, "energy that is returned to the drive per cycle";
        peak_regenerated_power_W ["W"] Scalar(|w| w.peak(AxisState::regenerated_power)) needs FRICTION, "largest power that is returned to the drive";
        mean_heat_W ["W"] Scalar(|w| w.mean_heat()) needs FRICTION, "mean heat of nut, seals and support bearings over the cycle; a note names the sources that are not given";
        preload_torque_measured_Nm ["N m" "T_p0"] Scalar(|w| Some(w.preload.as_ref()?.by_rule)),
            "friction torque to be expected when the preload is verified by measuring the torque; manufacturers' rule at 100 rpm, with ISO VG 68 oil and without wipers";
        preload_torque_percent ["%"] Scalar(|w| w.torque_percent()), "permitted variation of the friction torque due to preload; plus or minus, according to accuracy_grade";
        preload_torque_measured_low_Nm ["N m"] Scalar(|w| w.torque_by(-1.0)), "smallest permitted friction torque due to preload";
        preload_torque_measured_high_Nm ["N m"] Scalar(|w| w.torque_by(1.0)), "largest permitted friction torque due to preload";
        screw_torque_Nm ["N m" "T"] Scalar(|w| w.torque_at_largest_load()) needs FRICTION,
            "screw torque; on a sheet, the largest torque at the largest load during motion, positive if it acts against the load; includes preload, seals and support bearings";
        screw_efficiency ["" "eta"] Scalar(|w| w.heaviest()?.efficiency()) needs FRICTION,
            "efficiency of the screw; at the largest load during motion, including preload, seals and support bearings";
        preload_torque_Nm = NUT Scalar(|w| w.preload.as_ref()?.of_contacts) needs FRICTION;
        preload_torque_reverse_Nm = NUT Scalar(|w| w.of_unloaded_nut(output!(preload_torque_reverse_Nm))) needs FRICTION;
        preload_torque_factor = NUT Scalar(|w| w.of_unloaded_nut(output!(preload_torque_factor))) needs FRICTION;
        preload_torque_factor_rule = NUT Scalar(|w| w.of_nut(output!(preload_torque_factor_rule)));
        running_preload_N = NUT Scalar(|w| w.of_unloaded_nut(output!(running_preload_N))) needs FRICTION;
        running_preload_torque_Nm = NUT Scalar(|w| w.of_unloaded_nut(output!(running_preload_torque_Nm))) needs FRICTION;
        running_preload_torque_reverse_Nm = NUT Scalar(|w| w.of_unloaded_nut(output!(running_preload_torque_reverse_Nm))) needs FRICTION;
        running_preload_torque_factor = NUT Scalar(|w| w.of_unloaded_nut(output!(running_preload_torque_factor))) needs FRICTION;
        running_preload_torque_over_rule = NUT Scalar(|w| w.of_unloaded_nut(output!(running_preload_torque_over_rule))) needs FRICTION;
        running_preload_torque_factor_without_play = NUT Scalar(|w| {
            w.of_unloaded_nut(output!(running_preload_torque_factor_without_play))
        }) needs FRICTION;
        third_contact_balls = NUT Scalar(|w| w.of_nut(output!(third_contact_balls))) needs FRICTION;
        largest_third_contact_load_N = NUT Scalar(|w| w.of_nut(output!(largest_third_contact_load_N))) needs FRICTION;
        third_contact_torque_share = NUT Scalar(|w| w.of_nut(output!(third_contact_torque_share))) needs FRICTION;
        rest_load_N ["N" "F_rest"] Scalar(|w| w.machine.rest_load), "axial load of the most loaded screw at rest: weight, counterweight, counterbalance and constant process force";
        holding_torque_Nm ["N m"] Scalar(|w| Some(w.power_loss()?.holding)) needs FRICTION,
            "torque at the screw that holds the load at rest with the help of contact friction; not for choosing a brake";
        holding_torque_frictionless_Nm ["N m"] Scalar(|w| w.holding_torque()),
            "torque at the motor that holds the load at rest without friction";
        required_brake_torque_Nm ["N m"] Scalar(|w| w.required_brake()), "required torque of the brake, at the motor";
        back_driving_torque_Nm ["N m"] Scalar(|w| Some(w.power_loss()?.nominal)), "torque with which the load at rest back-drives the screw when the motor has no power";
        back_driving_torque_low_Nm ["N m"] Scalar(|w| Some(w.power_loss()?.torques[0])), "smallest back-driving torque of the load at rest; assumes the largest friction, twice the drag, and guide friction";
        back_driving_torque_high_Nm ["N m"] Scalar(|w| Some(w.power_loss()?.torques[1])), "largest back-driving torque of the load at rest; assumes the smallest friction";
        stopping_distance_mm ["mm"] Scalar(|w| Some(w.stop()?.distance / MM)), "stopping distance in the direction of the load at rest, from the largest feed, including brake_delay_s";
        stop_deceleration_m_s2 = INPUTS Scalar(|w| Some(w.stop()?.deceleration));
        stop_energy_J ["J"] Scalar(|w| w.stop_energy()), "kinetic energy at the largest feed, including the motor";
        inertia_at_screw_kg_m2 ["kg m2"] Scalar(|w| w.machine.screw.map(|_| w.machine.drive.inertia_at_screw())), "moment of inertia at one screw, including its share of the motor inertia";
        fall_acceleration_m_s2 ["m/s2"] Scalar(|w| w.fall().map(|(acceleration, _)| acceleration)), "acceleration of the falling load without motor power or brake";
        fall_speed_rpm ["rpm"] Scalar(|w| w.fall().map(|(_, speed)| speed)), "speed of the screw after the load has fallen over the stroke, without motor power or brake";
        inertia_of_screw_kg_m2 ["kg m2" "J_s"] Scalar(|w| {
            let turns = w.machine.nut_inertia.is_none();
            w.machine.screw.filter(|_| turns).map(|screw| screw.inertia)
        }), "moment of inertia of the screw; calculated only if the screw turns";
        nut_inertia_kg_m2 = INPUTS Scalar(|w| w.machine.nut_inertia);
        inertia_of_mass_kg_m2 ["kg m2"] Scalar(|w| w.machine.drive.mass_inertia()), "reflected inertia of the moved mass, at the screw";
        reflected_mass_kg ["kg" "m_r"] Scalar(|w| w.machine.has_inertia().then(|| w.machine.drive.reflected_mass())), "reflected mass: mass on the carriage with the same kinetic energy as screw, gear and motor";
        travel_per_step_um ["um"] Scalar(|w| Some(w.machine.drive.travel_per_part(w.case.motor_steps_per_turn? * w.case.value_or_default(InputKey::microsteps_count)?) / UM)), "travel per step of the motor or, if microsteps_count is given, per microstep";
        travel_per_count_um ["um"] Scalar(|w| Some(w.machine.drive.travel_per_part(w.case.encoder_counts_per_turn?) / UM)), "travel per count of the encoder";
        inertia_at_motor_kg_m2 ["kg m2"] Scalar(|w| w.inertia_at_motor()), "load inertia at the motor";
        inertia_ratio [""] Scalar(|w| {
            let motor = Some(w.machine.drive.motor_inertia).filter(|inertia| *inertia > 0.0);
            Some(w.inertia_at_motor()? / motor?)
        }), "load-to-motor inertia ratio";
        least_acceleration_time_s ["s"] Scalar(|w| w.least_ramp(w.case.motor_peak_torque_Nm?)) needs FRICTION,
            "shortest time to accelerate to the largest speed with motor_peak_torque_Nm";
        least_rated_acceleration_time_s ["s"] Scalar(|w| Some(1.5 * w.least_ramp(w.case.motor_rated_torque_Nm?)?)) needs FRICTION,
            "1.5 times the shortest time to accelerate to the largest speed with motor_rated_torque_Nm (HIWIN)";
        shortest_ramp_s ["s"] Scalar(|w| w.shortest_ramp()), "time to the largest speed at the largest acceleration of the cycle";
    }
}

/// Warning about a catalog stiffness that is not used.
const UNUSED_RIGIDITY: &str = "rated_rigidity_N_um is not used, because rated_rigidity_at states a load on one nut, but the nut is preloaded. The stiffness of nut and axis is calculated instead and cannot be compared with the stiffness of other offers that follows from a catalog.";

/// Origin of the stiffness of a nut. A catalog stiffness is a secant stiffness of nut and balls, and
/// a calculated stiffness is the tangent stiffness of the contacts alone, so the two cannot be
/// compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StiffnessOrigin {
    /// The stiffness follows from `rated_rigidity_N_um`.
    Catalog,
    /// The stiffness is calculated from the contacts of all balls.
    Calculated,
}

/// Results that are omitted if the speed is not given.
const OF_SPEED: [OutputName; 42] = [
    output!(largest_speed_rpm),
    output!(largest_feed_m_min),
    output!(equivalent_speed_rpm),
    output!(critical_speed_ratio),
    output!(nut_resonance_ratio),
    output!(largest_speed_number_mm_min),
    output!(cycle_life_h),
    output!(cycle_life_years),
    output!(cycle_life_by_balls_h),
    output!(modified_life_h),
    output!(modified_life_low_h),
    output!(modified_life_high_h),
    output!(required_life_revolutions),
    output!(required_dynamic_load_N),
    output!(required_dynamic_load_in_basis_N),
    output!(steady_temperature_rise_K),
    output!(steady_temperature_rise_low_K),
    output!(steady_temperature_rise_high_K),
    output!(nut_rise_K),
    output!(screw_rise_K),
    output!(end_1_rise_K),
    output!(end_2_rise_K),
    output!(steady_temperature_time_s),
    output!(nut_heat_W),
    output!(mean_heat_W),
    output!(motor_speed_rpm),
    output!(peak_torque_utilization),
    output!(continuous_torque_at_mean_speed_Nm),
    output!(rms_torque_utilization),
    output!(peak_motor_power_W),
    output!(peak_regenerated_power_W),
    output!(stopping_distance_mm),
    output!(stop_energy_J),
    output!(heat_W),
    output!(motor_power_W),
    output!(screw_speed_rpm),
    output!(feed_m_min),
    output!(viscosity_ratio),
    output!(start_feed_m_min),
    output!(end_feed_m_min),
    output!(start_speed_rpm),
    output!(end_speed_rpm),
];

/// Results that are omitted if the speed is not given and the friction is calculated from a
/// lubricant.
const OF_SPEED_WITH_LUBRICANT: [OutputName; 8] = [
    output!(preload_torque_Nm),
    output!(preload_torque_reverse_Nm),
    output!(preload_torque_factor),
    output!(running_preload_torque_Nm),
    output!(running_preload_torque_reverse_Nm),
    output!(running_preload_torque_factor),
    output!(running_preload_torque_over_rule),
    output!(running_preload_torque_factor_without_play),
];

/// Returns true unless a result depends on the speed and the speed is not given.
fn is_known(case: &Case, quantity: &Quantity) -> bool {
    let is_in = |outputs: &[OutputName]| outputs.iter().any(|o| o.name() == quantity.name);
    let is_lubricated = case.lubricant_temperature_C.is_some();
    case.has_speed() || !(is_in(&OF_SPEED) || is_lubricated && is_in(&OF_SPEED_WITH_LUBRICANT))
}

quantities! { pub(crate) PHASE, read_phase(&PhaseResult<'_>);
    "motion" {
        cycle_entry [""] Scalar(|p| p.entry()), "number of the cycle entry; empty for the standstill that fills the rest of the cycle time";
        time_share [""] Scalar(|p| p.torques.phase.time), "share of the cycle time";
        start_feed_m_min ["m/min"] Scalar(|p| p.feed(p.torques.phase.speed[0])), "feed at the start";
        end_feed_m_min ["m/min"] Scalar(|p| p.feed(p.torques.phase.speed[1])), "feed at the end";
        start_speed_rpm ["rpm"] Scalar(|p| p.torques.phase.speed[0] / RPM), "speed of the screw at the start";
        end_speed_rpm ["rpm"] Scalar(|p| p.torques.phase.speed[1] / RPM), "speed of the screw at the end";
        screw_speed_rpm ["rpm" "n"] Scalar(|p| p.torques.phase.mean_speed() / RPM), "mean speed of the screw";
        feed_m_min ["m/min"] Scalar(|p| p.feed(p.torques.phase.mean_speed())), "mean feed";
        acceleration_m_s2 ["m/s2"] Scalar(|p| p.torques.phase.acceleration), "acceleration";
        start_load_N ["N"] Scalar(|p| p.torques.phase.load[0]), "axial load at the start";
        end_load_N ["N"] Scalar(|p| p.torques.phase.load[1]), "axial load at the end";
        start_motor_torque_Nm ["N m"] Scalar(|p| p.state.motor_torque(&p.torques.ends[0])), "motor torque at the start";
        end_motor_torque_Nm ["N m"] Scalar(|p| p.state.motor_torque(&p.torques.ends[1])), "motor torque at the end";
        motor_torque_Nm ["N m"] Scalar(|p| p.largest(|end| p.state.motor_torque(end))), "motor torque, the larger of the values at start and end";
        motor_power_W ["W"] Scalar(|p| p.largest(|end| p.state.motor_power(end))), "motor power, the larger of the values at start and end";
        heat_W ["W"] Scalar(|p| Some(p.torques.means?.heat)), "mean heat";
        load_factor = INPUTS Scalar(|p| p.torques.phase.load_factor);
        max_contact_load_N = NUT Scalar(|p| Some(p.nut?.max_load));
        nut_stiffness_N_um = NUT Scalar(|p| Some(p.nut?.stiffness * UM));
        preload_left_N = NUT Scalar(|p| p.nut?.preload_left);
        viscosity_ratio ["" "kappa"] Scalar(|p| {
            let [by_film, by_viscosity] = p.state.viscosity_ratios_of(&p.torques.phase);
            by_film.or(by_viscosity)
        }), "viscosity ratio of the lubricant, calculated from the film ratio if groove and roughness are known";
    }
}

quantities! { pub(crate) SCREW, read_screw(&Screw<'_>);
    "screw and nut" {
        pitch_circle_diameter_mm = INPUTS Scalar(|s| s.machine.axis.screw.pitch_diameter / MM);
        lead_mm = INPUTS Scalar(|s| s.machine.axis.screw.lead / MM);
        lead_angle_deg = INPUTS Scalar(|s| s.machine.axis.screw.lead_angle() / DEG);
        ball_diameter_mm = INPUTS Scalar(|s| Some(s.nut()?.ball_diameter / MM));
        contact_angle_deg = INPUTS Scalar(|s| Some(s.nut()?.contact_angle / DEG));
        nut_conformity = INPUTS Scalar(|s| Some(s.nut()?.conformity.nut));
        screw_conformity = INPUTS Scalar(|s| Some(s.nut()?.conformity.screw));
        loaded_balls_per_turn = INPUTS Scalar(|s| Some(s.nut()?.balls_per_turn));
        loaded_turns = INPUTS Scalar(|s| Some(s.nut()?.turns));
        nut_outer_diameter_mm = INPUTS Scalar(|s| s.machine.body.outer / MM);
        nut_length_mm = INPUTS Scalar(|s| s.machine.body.length / MM);
        screw_outer_diameter_mm = INPUTS Scalar(|s| s.machine.axis.screw.outer / MM);
        screw_core_diameter_mm = RATINGS Scalar(|s| s.machine.axis.screw.core / MM);
        dynamic_load_rating_N = RATINGS Scalar(|s| s.machine.ratings.dynamic);
        static_load_rating_N = RATINGS Scalar(|s| s.machine.ratings.static_);
        edge_load_N = RATINGS Scalar(|s| s.of_nut.number(output!(edge_load_N)));
        nut_mass_kg = INPUTS Scalar(|s| s.machine.nut_mass);
        cold_preload_N = NUT Scalar(|s| Some(s.preload?.cold));
        warm_preload_N = NUT Scalar(|s| Some(s.preload?.warm));
        friction_coefficient = INPUTS Scalar(|s| s.case.friction_coefficient);
    }
}

/// Results of the axis in one phase of a cycle.
pub(crate) struct PhaseResult<'a> {
    state: &'a AxisState<'a>,
    torques: &'a PhaseTorques,
    /// Results for the warm nut at the end of the phase; `None` without a warm state.
    nut: Option<&'a NutInPhase>,
}

impl PhaseResult<'_> {
    /// Returns the number of the cycle entry, counted from 1.
    fn entry(&self) -> Option<f64> {
        let number = u32::try_from(self.torques.phase.entry? + 1).ok()?;
        Some(f64::from(number))
    }

    /// Returns the feed rate at a speed of the screw \[m/min\].
    fn feed(&self, speed: f64) -> f64 {
        speed * self.state.machine.advance() * 60.0
    }

    /// Returns the value at the start or at the end of the phase, whichever is larger in magnitude.
    /// The value keeps its sign.
    fn largest(&self, number: impl Fn(&Torques) -> Option<f64>) -> Option<f64> {
        let [start, end] = self.torques.ends.each_ref().map(number);
        let (start, end) = (start?, end?);
        Some(if start.abs() > end.abs() { start } else { end })
    }
}

/// Dimensions of screw and nut that are used in the calculation.
pub(crate) struct Screw<'a> {
    case: &'a Case,
    machine: &'a AxisModel,
    of_nut: &'a Answer,
    preload: Option<&'a Preload>,
}

impl Screw<'_> {
    fn nut(&self) -> Option<&Nut> {
        self.machine.groove.as_ref().map(|(nut, _)| nut)
    }
}

/// Report on an axis: results, design rules and the phases of the duty cycle.
#[derive(Debug, Clone)]
pub struct AxisReport {
    /// Case for which the axis sheet was calculated.
    pub case: Case,
    /// Settings used to calculate friction.
    pub settings: Settings,
    /// Torques in each phase of the cycle.
    pub phases: Vec<ScrewTorque>,
    /// Order data of the screw.
    pub order: Order,
    /// Warnings in the answer, each with the corresponding selection limit, if there is one.
    pub warnings: Vec<Warning>,
    /// Answer that contains results, rules, notes and tables.
    pub answer: Answer,
    /// Origin of the stiffness of the nut; `None` if the stiffness is unknown.
    pub(crate) stiffness_origin: Option<StiffnessOrigin>,
}

/// Returns the columns of the axis sheet that are used to compare nuts in a table.
pub fn sheet_columns() -> impl Iterator<Item = &'static Output> + Clone {
    const NAMES: [OutputName; 15] = [
        output!(cycle_life_h),
        output!(critical_speed_ratio),
        output!(buckling_safety),
        output!(static_safety_factor),
        output!(axis_stiffness_N_um),
        output!(peak_motor_torque_Nm),
        output!(back_driving_torque_Nm),
        output!(screw_efficiency),
        output!(mean_heat_W),
        output!(screw_mass_kg),
        output!(mass_of_nut_and_screw_kg),
        output!(inertia_of_screw_kg_m2),
        output!(warm_preload_N),
        output!(fold_speed_factor),
        output!(unsupported_length_mm),
    ];
    let all = || QUANTITIES.iter().chain(WARM).flat_map(|quantity| quantity.columns);
    NAMES.into_iter().filter_map(move |name| all().find(|column| OutputName::from(*column) == name))
}

/// Outputs that describe the load at standstill. They are all zero if no force acts at standstill.
const AT_REST: [&str; 7] = [
    "rest_load_N",
    "holding_torque_Nm",
    "holding_torque_frictionless_Nm",
    "required_brake_torque_Nm",
    "back_driving_torque_Nm",
    "back_driving_torque_low_Nm",
    "back_driving_torque_high_Nm",
];

/// Output that is hidden on the screen: the holding torque with contact friction. The screen shows
/// the required brake torque instead, because a brake must be chosen without relying on friction.
const NOT_FOR_A_BRAKE: [&str; 1] = ["holding_torque_Nm"];

/// Physical effects that the axis calculation always neglects.
const NOT_MODELED: [&str; 4] = [
    "vibration and control of the axis, and shocks that load_factor does not cover",
    "bending of the screw under its own weight; deformation of the frame; misalignment, unless it \
     is given",
    "compliance of brackets beyond housing_stiffness_N_um; displacement due to twist of the screw, which can exceed the elastic axial displacement at large leads",
    "wear, the torque to start from rest, and jerk",
];

/// Returns the physical effects that are neglected in the results for an axis.
///
/// * `contacts`: true if friction is calculated from the contacts, false if it follows from the
///   catalog efficiency.
/// * `heating`: steady temperatures, if they are known.
fn not_modeled(case: &Case, contacts: bool, heating: Option<&Heating>) -> Vec<String> {
    let temperatures = match heating {
        _ if case.requests_warm_state() => {
            "changes of the temperatures over time, because only the steady state is calculated"
        }
        Some(_) => {
            "effect of the steady-state temperature rise on preload and torque; set warm_state to true to include it"
        }
        None => {
            "temperatures of nut, screw and balls, because friction or the length of the screw is unknown"
        }
    };
    let lubricant = (contacts && !case.given().is_lubricated()).then_some(
        "effects of a lubricant, because its inputs are not given; the contacts are assumed to be dry with a constant friction coefficient",
    );
    let preload = case.is_preloaded().then_some(
        "exact friction torque due to preload; this torque is calculated with the manufacturers' rule, which is accurate to about 50 %",
    );
    let pushes = match (case.ball_gap_mm, case.is_preloaded()) {
        (None, _) => {
            "ball returns and ball-to-ball contact, which only the manufacturers' rule for the preload torque includes"
        }
        // The torque of a preloaded nut is calculated from the friction of all its balls.
        (Some(_), true) => {
            "ball returns (except for return_push_N and its effects), which only the manufacturers' rule for the preload torque includes; the torque includes ball-to-ball contact according to ball_gap_mm"
        }
        (Some(_), false) => {
            "ball returns, and the torque due to ball-to-ball contact in a nut without preload, which `bsm nut` calculates from ball_gap_mm"
        }
    };
    let of_inputs = lubricant.into_iter().chain(preload).chain(contacts.then_some(pushes));
    of_inputs.chain([temperatures]).chain(NOT_MODELED).map(str::to_owned).collect()
}

impl AxisReport {
    /// Calculates the axis sheet of a case.
    ///
    /// * `settings`: model and solver settings for friction.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input is missing or violates its rule.
    pub fn of(case: &Case, settings: &Settings) -> Result<Self, CaseError> {
        let full = Detail { band: true, ..Detail::WITHOUT_BAND };
        let line = case.without_estimates();
        let (report, refused) = match line.with_groove() {
            // Life, speed limits and buckling can be calculated without groove data, but a warm
            // state cannot.
            Err(CaseError::NoGroove(why)) if !line.requests_warm_state() => {
                (Self::with(&line, settings, full)?, Some(why))
            }
            Err(why) => return Err(why),
            Ok(case) => match (Self::with(&case, settings, full), case.has_estimated_groove()) {
                // Unlike an estimated groove, an input can be corrected by the user.
                (Err(why @ CaseError::Entry { .. }), _) => return Err(why),
                (Err(why), true) => {
                    let Ok(report) = Self::with(&line, settings, full) else { return Err(why) };
                    let why = format!("The results that need the groove are omitted: {why}");
                    (report, Some(why))
                }
                (report, _) => (report?, None),
            },
        };
        let own = report.settings;
        let mut report =
            report.with_groove_intervals(|possible| Self::numbers_only(possible, &own).ok());
        if let Some(why) = refused {
            report.warnings.push(Warning::advice(why.clone()));
            report.answer.warnings.push(why);
        }
        Ok(report)
    }

    /// Adds the 90 % intervals of all results over the possible grooves. A rule that is violated
    /// for the best estimate of the groove may then be undecided.
    ///
    /// * `answer`: function that calculates the answer for a case with one of the possible grooves.
    #[must_use]
    pub(crate) fn with_groove_intervals(
        mut self,
        answer: impl Fn(&Case) -> Option<Answer> + Sync,
    ) -> Self {
        self.answer = self.answer.with_groove_intervals(&self.case, FEW_DRAWS, answer);
        // Without a warm steady state, the report has no phases, and its verdict is already final.
        if !self.phases.is_empty() {
            self.answer.fails = self.answer.rules.iter().any(Criterion::fails);
            self.answer = self.answer.with_verdict();
        }
        self
    }

    /// Calculates results and design rules, but omits the notes that require additional model
    /// solutions.
    pub(crate) fn without_band(case: &Case, settings: &Settings) -> Result<Self, CaseError> {
        Self::with(case, settings, Detail::WITHOUT_BAND)
    }

    /// Calculates the results and the design rules for one of the possible grooves, without
    /// warnings, notes and order data.
    pub(crate) fn numbers_only(case: &Case, settings: &Settings) -> Result<Answer, CaseError> {
        let detail = Detail { texts: false, ..Detail::WITHOUT_BAND };
        Self::with(case, settings, detail).map(|report| report.answer)
    }

    fn with(given: &Case, settings: &Settings, detail: Detail) -> Result<Self, CaseError> {
        check_inputs(given)?;
        let given = &given.with_preload()?;
        let warm = Warm::with_band(given, settings, detail)?;
        if let Some(warm) = warm.as_ref().filter(|warm| warm.state.is_none()) {
            return Ok(Self::without_steady_state(given, warm));
        }
        let settings = &warm.as_ref().map_or(*settings, |warm| warm.settings);
        let case = &warm.as_ref().map_or_else(|| given.clone(), |warm| warm.case(given));
        let state = AxisState::of(case, settings, warm)?;
        let (of_nut, of_ratings) = match &state.machine.groove {
            Some(_) => ratings_and_warnings(&at_largest(case, &state.machine.axis))?,
            None => (Answer::default(), Vec::new()),
        };
        let warnings =
            if detail.texts { all_warnings(&state, case, of_ratings) } else { Vec::new() };
        let texts = warnings.iter().map(|warning| warning.text.clone()).collect();
        let (machine, preload) = (&state.machine, state.preload.as_ref());
        let fold = state.warm.as_ref().and_then(|warm| warm.fold.as_ref()).map(|fold| fold.factor);
        let numbers = read(&state, |quantity| is_known(case, quantity)).where_finite();
        sufficiency::check(case, &numbers)?;
        let rules = rules::rules(
            case,
            machine,
            (&numbers, fold),
            &of_nut,
            preload,
            [
                state.motor_peak(AxisState::motor_torque),
                state.motor_peak(AxisState::torque_utilization),
            ],
        );
        let phases: Vec<_> = (0..state.torques.len()).map(|place| state.phase(place)).collect();
        let screw = read_screw(&Screw { case, machine, of_nut: &of_nut, preload }, |_| true);
        let screw = screw.where_finite();
        let fails = rules.iter().any(Criterion::fails);
        let mut notes = if detail.texts { state.notes() } else { Vec::new() };
        if detail.band {
            notes.extend(state.uncertainty_note());
            notes.extend(state.back_driving_note());
        }
        // If no force acts at standstill, a note says so, and the outputs for the load at
        // standstill are hidden.
        let is_free = state.machine.rest_load == 0.0;
        let numbers = numbers.with_hidden(if is_free { &AT_REST } else { &NOT_FOR_A_BRAKE });
        let order = if detail.texts { state.order() } else { Order::default() };
        let not_given = state.not_given();
        let of = Answer { rules, notes, warnings: texts, not_given, fails, ..Answer::default() };
        let warm = state.warm.as_ref();
        let mut answer = sheet(
            of,
            given,
            warm,
            (&phases, numbers, screw),
            not_modeled(
                given,
                state.machine.groove.is_some()
                    && !contacts::takes_catalog_efficiency(given, settings),
                state.heating.as_ref(),
            ),
        );
        let back_driving = state.back_driving().map(str::to_owned);
        answer = answer.with(
            "back_driving",
            if is_free {
                Content::Json(json!(back_driving))
            } else {
                Content::Text("effect of the load at rest on the screw:", back_driving)
            },
        );
        answer = answer.with_shown(Content::Text("order:", Some(order.to_string())));
        Ok(Self {
            case: given.clone(),
            settings: *settings,
            phases,
            order,
            warnings,
            answer,
            stiffness_origin: state.stiffness_origin(),
        })
    }

    /// Creates the axis sheet of an axis that has no warm steady state.
    fn without_steady_state(case: &Case, warm: &Warm) -> Self {
        let rules = rules::steady_state(warm.fold.as_ref().map(|fold| fold.factor));
        let rules = rules.into_iter().collect();
        let texts: Vec<_> = warm.warning().into_iter().collect();
        let warnings = texts.iter().cloned().map(Warning::advice).collect();
        let of = Answer { rules, warnings: texts, fails: true, ..Answer::default() };
        let none = (&[][..], Numbers::none(QUANTITIES), Numbers::none(SCREW));
        let answer = sheet(of, case, Some(warm), none, Vec::new());
        let (phases, order) = (Vec::new(), Order::default());
        Self {
            case: case.clone(),
            settings: warm.settings,
            phases,
            order,
            warnings,
            answer,
            stiffness_origin: None,
        }
    }

    /// Returns the report with its results in the displayed units of the case.
    #[must_use]
    pub fn displayed(&self) -> Self {
        let units = self.case.display_units();
        let phase = |phase: &ScrewTorque| ScrewTorque {
            numbers: phase.numbers.clone().in_units(units),
            ..phase.clone()
        };
        let phases = self.phases.iter().map(phase).collect();
        Self { phases, answer: self.answer.clone().in_units(units), ..self.clone() }
    }

    /// Returns the verdict on all rules together: passed, failed or undecided.
    pub fn verdict(&self) -> Verdict {
        self.answer.verdict()
    }

    /// Returns true if every rule is met.
    pub fn passes(&self) -> bool {
        self.verdict() == Verdict::Passes
    }

    /// Returns the output with the given name.
    pub fn number(&self, name: OutputName) -> Option<f64> {
        self.answer.number(name)
    }

    /// Returns the dimensions and data of the screw on which the sheet is based.
    pub fn screw_rows(&self) -> &[Row] {
        match self.answer.section("screw") {
            Some(Content::Numbers { numbers, .. }) => numbers.all(),
            _ => &[],
        }
    }

    /// Returns the 90 % interval of a result of a phase, or `None` if the result does not depend on
    /// an estimated groove.
    ///
    /// * `place`: index of the phase in [`phases`](Self::phases).
    pub fn phase_band(&self, place: usize, name: OutputName) -> Option<Band> {
        match self.answer.section("phases") {
            Some(Content::Table(phases)) => phases.band(place, name.name()),
            _ => None,
        }
    }

    /// Returns the uncertainty band of a result in the warm state. Bounds that are unknown are
    /// missing.
    pub fn warm_bounds(&self, name: OutputName) -> Bounds {
        let Some(Content::Table(band)) = self.answer.section("band") else {
            return Bounds::default();
        };
        let row = band.rows.iter().find(|row| row.first().is_some_and(|cell| cell == name.name()));
        let bound = |column: &str| {
            let column = band.columns.iter().position(|known| known.name == column)?;
            row?[column].as_f64()
        };
        Bounds { min: bound("low"), max: bound("high") }
    }

    /// Returns the thermal steady states (warm states) as a function of speed, or `None` if no warm
    /// state is requested or none exists.
    pub fn warm_branch(&self) -> Option<WarmBranch> {
        WarmBranch::of(&self.case, &self.settings).ok()?
    }

    /// Returns the axial load \[N\] at which the axis reaches exactly the required life at a given
    /// speed \[rpm\]. Load and speed define a point in the speed-force diagram.
    pub fn load_of_life(&self, rpm: f64) -> Option<f64> {
        let required = self.number(output!(required_life_revolutions))?;
        let mean_speed = self.number(output!(equivalent_speed_rpm))?;
        // This is the number of revolutions at the given speed within the required life.
        let revolutions = required * rpm / mean_speed;
        Some(self.number(output!(modified_dynamic_rating_N))? * (1e6 / revolutions).cbrt())
    }
}

/// Calculates the results for an axis without creating a report.
///
/// # Errors
/// Returns the same errors as [`AxisReport::of`], and [`CaseError::NoWarmState`] in case of thermal
/// runaway.
///
/// * `wanted`: selects the quantities to calculate.
/// * `work`: workspace of the models, which is reused for several cases.
pub(crate) fn numbers(
    case: &Case,
    settings: &Settings,
    wanted: impl Fn(&Quantity) -> bool,
    work: &mut ModelWorkspace,
) -> Result<Numbers, CaseError> {
    check_inputs(case)?;
    let case = &case.with_preload()?;
    let mut chosen = QUANTITIES.iter().filter(|quantity| wanted(quantity));
    // The torque at a single operating point can be calculated without the rest of the axis.
    if case.entries.cycle.is_none()
        && chosen.all(|quantity| quantity.name == "screw_torque_Nm")
        && let Some(torque) = torque_parts(case, settings, work)?
        // On the axis sheet, the torque is positive if it acts against the load. `torque_parts`
        // gives the same sign only for a positive load.
        && torque.number(output!(screw_load_N)).is_some_and(|load| load > 0.0)
    {
        return Ok(torque.numbers);
    }
    let warm = Warm::state_of(case, settings, false)?;
    let settings = &warm.as_ref().map_or(*settings, |warm| warm.settings);
    let case = &warm.as_ref().map_or_else(|| case.clone(), |warm| warm.case(case));
    let wanted = |quantity: &Quantity| is_known(case, quantity) && wanted(quantity);
    Ok(read(&AxisState::of(case, settings, warm)?, wanted).where_finite())
}

/// Returns the warnings about an axis, its nut and its ratings, beginning with the most important
/// warning.
///
/// * `of_ratings`: warnings about the load ratings of the nut.
fn all_warnings(state: &AxisState<'_>, case: &Case, of_ratings: Vec<Warning>) -> Vec<Warning> {
    let mut texts: Vec<_> = state.machine.warning.iter().cloned().collect();
    texts.extend(case.unused_with_cycle());
    texts.extend(state.has_unused_rigidity().then(|| UNUSED_RIGIDITY.to_owned()));
    let is_estimated = case.has_estimated_groove();
    // An estimated groove may have different proportions than the real groove, so warnings about
    // the proportions are discarded.
    let mut warnings = if is_estimated { Vec::new() } else { of_ratings };
    if state.machine.groove.is_none() || is_estimated {
        texts.extend(case.warnings());
    }
    // For an estimated groove, the edge-load rule, which considers all possible grooves, replaces
    // the warning about the flanks.
    let of_balls =
        if is_estimated { NutReport::warnings_besides_flanks } else { NutReport::warnings };
    texts.extend(state.nut.as_ref().map(of_balls).unwrap_or_default());
    texts.extend(state.warm.iter().filter_map(Warm::warning));
    warnings.extend(texts.into_iter().map(Warning::advice));
    warnings.extend(state.warnings());
    if let Some(why @ CaseError::Nut(_)) = &state.no_nut {
        let text = format!("{}; the preload rules are not checked", no_balls(why));
        warnings.push(Warning::limit(SelectionLimit::UnsolvedNut, text));
    }
    warnings.sort();
    warnings.dedup();
    warnings
}

number_tables! {
    /// Results for an axis.
    pub(crate) AxisNumbers = QUANTITIES.iter();
    /// Inputs and results of a screw.
    pub(crate) ScrewNumbers = SCREW.iter();
    /// Results for a phase of the cycle.
    pub(crate) PhaseNumbers = PHASE.iter().chain(TORQUES), shown [
        "time_share",
        "screw_load_N",
        "start_feed_m_min",
        "end_feed_m_min",
        "ideal_torque_Nm",
        "screw_torque_Nm",
        "screw_efficiency",
        "motor_torque_Nm",
        "heat_W",
    ];
}

row! {
    /// A phase of the cycle.
    #[expect(non_snake_case, reason = "the names end with unit symbols")]
    pub(crate) struct PhaseRow {
        [skip] phase: usize = "phase";
        [flatten] numbers: NumberCells<PhaseNumbers>;
        /// Name of the contact model, or the reason why the friction torque of the contacts is not
        /// calculated.
        contacts: String;
        /// Axial force of each nut body in the warm steady state \[N\].
        body_axial_N: Option<Vec<f64>>;
    }
}

answer! {
    /// Calculation sheet of an axis.
    pub(crate) struct AxisMembers {
        /// True if all rules are met, false if a rule is violated, else null.
        passes: Data<Option<bool>>;
        inputs: Data<CaseJson>;
        phases: Rows<PhaseRow>;
        results: NumbersOf<AxisNumbers>;
    }
}

answer! {
    /// JSON members of the axis sheet that follow the members of the warm state.
    pub(crate) struct AxisRemarks {
        screw: NumbersOf<ScrewNumbers>;
        /// Effects that the results neglect.
        not_modeled: Sentences;
    }
}

/// Adds the sections of the axis sheet to an answer.
fn sheet(
    of: Answer,
    case: &Case,
    warm: Option<&Warm>,
    (phases, numbers, screw): (&[ScrewTorque], Numbers, Numbers),
    not_modeled: Vec<String>,
) -> Answer {
    let row = |(phase, torque): (usize, &ScrewTorque)| PhaseRow {
        phase,
        numbers: NumberCells::of(&torque.numbers),
        contacts: torque.contacts.clone(),
        body_axial_N: torque.bodies.clone(),
    };
    let passes = Data(of.verdict().passes());
    let answer = of.with_members(AxisMembers {
        passes,
        inputs: Data(CaseJson(case.to_json())),
        phases: Rows((1..).zip(phases).map(row).collect()),
        results: NumbersOf::new(numbers, "axis"),
    });
    Warm::add_to(warm, answer).with_members(AxisRemarks {
        screw: NumbersOf::new(screw, "screw"),
        not_modeled: Sentences("not modeled", not_modeled),
    })
}

impl Answer {
    /// Sets the JSON member `passes` to the verdict on all rules.
    fn with_verdict(mut self) -> Self {
        let verdict = self.verdict().passes();
        let is_verdict = |section: &&mut Section| section.member == Some("passes");
        if let Some(section) = self.sections.iter_mut().find(is_verdict) {
            section.content = Content::Json(json!(verdict));
        }
        self
    }
}

/// Returns a sentence that explains why the loads of the individual balls cannot be calculated.
fn no_balls(why: &CaseError) -> String {
    format!("The nut with all its balls cannot be calculated: {why}")
}

impl AxisState<'_> {
    fn phase(&self, place: usize) -> ScrewTorque {
        let torques = &self.torques[place];
        // The nut is evaluated at the last sample of the phase, which is closest to the end of the
        // phase.
        let samples = self.axis().phases[..=place].iter().map(|phase| phase.samples().len());
        let sample = samples.sum::<usize>() - 1;
        let nut = self.warm_state().and_then(|warm| warm.phases[sample].as_ref());
        let phase = PhaseResult { state: self, torques, nut };
        let motion = read_phase(&phase, |quantity| is_known(self.case, quantity));
        let numbers = motion.and(torques.heavier().numbers()).where_finite();
        let bodies = nut.map(|nut| nut.bodies.clone());
        ScrewTorque { numbers, contacts: torques.heavier().contacts.text.clone(), bodies }
    }
}

/// Rejects temperature inputs that have no effect, and an accuracy grade that is given without the
/// travel to which it applies.
fn check_inputs(case: &Case) -> Result<(), CaseError> {
    let travels = case.useful_travel_mm.is_some() || stroke(case)?.is_some();
    if case.entries.accuracy_grade.is_some() && !travels {
        let missing = ["stroke_mm (or useful_travel_mm)".to_owned()];
        return Err(CaseError::missing(&missing, "for accuracy_grade"));
    }
    if case.fold_search_factor.is_some() && case.entries.warm_state.is_none() {
        let what = "has no effect unless warm_state is given";
        return Err(invalid_input(InputKey::fold_search_factor.name(), what));
    }
    // These inputs of the section "warm state" have an effect even without the thermal network.
    let act = [
        InputKey::preload_temperature_C,
        InputKey::screw_tension_N,
        InputKey::structure_temperature_C,
        InputKey::fold_search_factor,
    ];
    let is_idle = |key: &InputKey| key.group() == InputGroup::WarmState && !act.contains(key);
    let idle = case.given().iter().find(is_idle);
    match idle.filter(|_| case.axis_heat_transfer_W_K.is_some()) {
        Some(key) => {
            let what =
                "has no effect with axis_heat_transfer_W_K, which replaces the thermal network";
            Err(invalid_input(key.name(), what))
        }
        None => Ok(()),
    }
}

/// Returns the case at the largest load and speed of the axis. The ratings are calculated for this
/// case.
fn at_largest(case: &Case, axis: &Axis) -> Case {
    // The carriage and the temperature rises are removed from the case, because the load already
    // includes the forces on the moving mass, and because a separate rule checks the warm preload.
    let mut case = case.cold().without_carriage();
    let load = axis.largest_load();
    (case.axial_load_N, case.feed_m_min) = (Some(load).filter(|load| *load > 0.0), None);
    let rpm = axis.fastest() / RPM;
    (case.screw_speed_rpm, case.nut_speed_rpm) = (Some(rpm).filter(|rpm| *rpm > 0.0), None);
    case
}
