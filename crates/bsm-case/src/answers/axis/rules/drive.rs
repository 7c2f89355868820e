//! The rules of motor and brake.

use super::Rules;
use crate::case::axis::motor_speed;
use crate::{InputKey, Numbers, Scene};

/// Of the motor and its brake, as far as their limits are given.
pub(super) fn drive_rules(rules: &mut Rules, scene: &Scene, numbers: &Numbers) {
    let number = |name: &str| numbers.number(name);
    // Without a limit there is no rule.
    let of = |name: &str, limit: Option<f64>| limit.and(number(name));
    let lead = scene.lead_mm.unwrap_or(f64::NAN);
    rules.add(
        "motor speed",
        ("motor_speed_rpm", "rpm"),
        of("motor_speed_rpm", motor_speed(scene)),
        (false, motor_speed(scene)),
        "THK A-719",
        &|margin| format!("lead_mm {:.1} at the same feed", lead / margin),
    );
    rules.add(
        "peak torque of the motor",
        ("peak_motor_torque_Nm", "N m"),
        of("peak_motor_torque_Nm", scene.motor_peak_torque_Nm),
        (false, scene.motor_peak_torque_Nm),
        "THK A-720",
        &|_| "a larger motor, a smaller lead, or less acceleration".to_owned(),
    );
    rules.add(
        "rated torque of the motor",
        ("rms_motor_torque_Nm", "N m"),
        of("rms_motor_torque_Nm", scene.motor_rated_torque_Nm),
        (false, scene.motor_rated_torque_Nm),
        "THK, eq. 48: RMS over the cycle (Z13)",
        &|_| "a larger motor, a smaller lead, or longer rests".to_owned(),
    );
    rules.add(
        "power of the motor",
        ("peak_motor_power_W", "W"),
        of("peak_motor_power_W", scene.motor_rated_power_W),
        (false, scene.motor_rated_power_W),
        "the worst phase",
        &|margin| format!("a feed of {margin:.2} times this one, or a larger motor"),
    );
    rules.add(
        "inertia ratio",
        ("inertia_ratio", ""),
        number("inertia_ratio"),
        (false, scene.value_or_default(InputKey::largest_inertia_ratio)),
        "THK, eq. 49: 3 to 10",
        &|margin| format!("gear_ratio {:.2} times this one, or a larger motor", margin.powf(-0.5)),
    );
    rules.add(
        "acceleration time",
        ("least_acceleration_time_s", "s"),
        of("least_acceleration_time_s", number("shortest_ramp_s")),
        (false, number("shortest_ramp_s")),
        "THK A-720 (AA11)",
        &|_| "a motor of more peak torque, or less acceleration".to_owned(),
    );
    let required = number("required_brake_torque_Nm");
    rules.add(
        "brake",
        ("brake_torque_Nm", "N m"),
        scene.brake_torque_Nm.filter(|_| required.is_some()),
        (true, required),
        "brake_safety times the weight without friction (Z18)",
        &|_| format!("brake_torque_Nm {:.2}", required.unwrap_or(f64::NAN)),
    );
}
