//! Checks of statements in Lin, Velinsky and Ravani (1994) that do not concern the accuracy of the
//! closed-form solution.

use bsm_case::Case;
use bsm_design::search::minimum_of;
use bsm_dyn::{
    Coulomb, Direction, Model, ModelWorkspace,
    angles::{Angles, Optimum},
    model::QuasiStatic,
    solution::DrivenBody,
};
use bsm_report::sheets::efficiency_as_printed;

use super::{SOURCE, slender};
use crate::{Check, ValidateError};

/// Friction coefficient that the paper uses.
const F: f64 = 0.075;

const FORWARD: Direction = Direction::RotaryToLinear;

/// Returns the checks of all statements in this module.
pub(super) fn checks(lin: &Case) -> Result<Vec<Check>, ValidateError> {
    let mut checks = vec![quotient(), driving_part(lin)?, driven_side()];
    checks.extend(direction_of_slip(lin)?);
    checks.extend(optimum_range());
    Ok(checks)
}

fn check(key: &str, equation: &str, claim: &str) -> Check {
    Check::new(&format!("lin1994/{key}"), &format!("{SOURCE}, {equation}"), claim)
}

fn angles(lead_deg: f64, contact_deg: f64) -> Angles<f64> {
    Angles { lead: lead_deg.to_radians(), contact: contact_deg.to_radians() }
}

/// Checks that the efficiencies according to Eqs 3 and 4 equal the ratio of output work to input
/// work according to Eqs 1 and 2.
fn quotient() -> Check {
    let (size, mut worst) = (0.18, 0.0_f64);
    for lead in (4..=40).step_by(4).map(f64::from) {
        for contact in (20..=80).step_by(5).map(f64::from) {
            for (friction, rolling_ratio) in [(F, 0.0), (0.0, 2e-3), (0.05, 2e-3)] {
                for (driven, side) in [(DrivenBody::Screw, -1.0), (DrivenBody::Nut, 1.0)] {
                    let angles = angles(lead, contact);
                    let case = QuasiStatic {
                        angles,
                        friction: Coulomb(friction),
                        size_ratio: size,
                        rolling_ratio,
                        driven,
                        direction: FORWARD,
                        size: None,
                    };
                    let (sin_a, cos_a) = angles.lead.sin_cos();
                    let (sin_b, cos_b) = angles.contact.sin_cos();
                    // Torque and force follow from Eqs 1 and 2 after division by the normal load. At
                    // the nut, the friction across the groove has the opposite sign.
                    let (sin_r, cos_r) = (rolling_ratio / sin_b).atan().sin_cos();
                    let across = sin_b + friction * (size + side * cos_b);
                    let torque = sin_a * cos_r * across + cos_a * sin_r;
                    let force = cos_a * cos_r * (sin_b - friction * cos_b) - sin_a * sin_r;
                    let quotient = force * angles.lead.tan() / torque;
                    worst = worst.max((quotient - case.efficiency()).abs());
                }
            }
        }
    }
    check(
        "quasi-static-quotient",
        "Eqs 1-4",
        "Eqs 3 and 4 are equal to output work divided by input work according to Eqs 1 and 2",
    )
    .measured(worst, "largest difference")
    .at_most(1e-13, "rounding")
}

/// Checks the statement "The driving component does not have an effect", which is not exactly true.
fn driving_part(lin: &Case) -> Result<Check, ValidateError> {
    let rpm = lin.screw_speed_rpm;
    let nut =
        Case { screw_speed_rpm: Some(0.0), nut_speed_rpm: rpm.map(|rpm| -rpm), ..lin.clone() };
    let pair = |lead: f64| {
        let efficiency = |case: &Case| {
            let mut case = case.clone();
            case.set("lead_angle_deg", lead)?;
            let solution =
                case.problem(&Model::Rigid.into())?.solve(&mut ModelWorkspace::default());
            Ok::<_, ValidateError>(solution.efficiency().unwrap_or(f64::NAN))
        };
        Ok::<_, ValidateError>([efficiency(lin)?, efficiency(&nut)?])
    };
    let mut worst = (0.0, 0.0);
    for lead in (8..=60).map(f64::from) {
        let [screw, nut] = pair(lead)?;
        // If the nut drive has no solution, the difference is NaN, and the lead angle is skipped.
        if (screw - nut).abs() > worst.0 {
            worst = ((screw - nut).abs(), lead);
        }
    }
    let [screw, nut] = pair(10.0)?;
    let claim = "the driving component has no effect on the efficiency";
    Ok(check("driving-part", "conclusions; Eqs 5-9", claim)
        .measured(worst.0, "difference of the efficiencies")
        .note(format!(
            "at a lead angle of {} deg; at 10 deg, {screw:.7} if the screw turns and {nut:.7} if the nut turns",
            worst.1
        ))
        .at_most(1e-4, "a hundredth of a percentage point, the effect of inertia at 2000 rpm"))
}

/// Checks Eq 11 and the statements about Fig 5 of the paper.
fn direction_of_slip(lin: &Case) -> Result<Vec<Check>, ValidateError> {
    let slender = slender(lin);
    let lin_angles = angles(10.0, 45.0);
    let (ball, pitch) = (slender.ball_diameter_mm, slender.pitch_circle_diameter_mm);
    let size = ball.zip(pitch).map_or(f64::NAN, |(ball, pitch)| ball / pitch);
    let at = |psi: f64| lin_angles.efficiency_at(FORWARD, F, size, psi.to_radians());
    let quarter: Vec<_> = (0..=900).map(|i| 0.1 * f64::from(i)).collect();
    let best =
        quarter.iter().copied().fold(0.0, |best, psi| if at(psi) > at(best) { psi } else { best });
    let least = minimum_of(|psi| Ok::<_, ValidateError>(at(psi)), 45.0, 90.0)?;
    let printed = |psi: f64| efficiency_as_printed(&lin_angles, F, size, psi.to_radians());
    let most = quarter.iter().copied().map(printed).fold(0.0, f64::max);

    let mut off = 0.0_f64;
    let mut falling = 0;
    for lead in (2..=60).map(f64::from) {
        let across = |contact: f64| angles(lead, contact).efficiency_at(FORWARD, F, size, 0.0);
        for contact in (5..=85).map(f64::from) {
            let angles = angles(lead, contact);
            let psi = angles.screw_slip_angle(FORWARD);
            let difference =
                angles.efficiency_at(FORWARD, F, size, psi) - angles.efficiency(FORWARD, F);
            off = off.max(difference.abs());
            falling += i32::from(across(contact + 1.0) <= across(contact));
        }
    }
    Ok(vec![
        check(
            "eq-11",
            "Eqs 11, 13, 14",
            "Eq 11 with the slip angle of Eq 13 equals Eq 14 (as corrected)",
        )
        .measured(off, "largest difference")
        .note("lead angles of 2 to 60 deg, contact angles of 5 to 85 deg, r_b/r_m = 0.1")
        .at_most(1e-12, "rounding"),
        check("eq-11-as-printed", "Eq 11 as printed", "efficiency as a function of the slip angle")
            .measured(most, "largest efficiency")
            .note("the efficiency exceeds one, because the sign of the friction in the numerator contradicts Eq 9"),
        check(
            "fig-5-upper-limit",
            "Fig 5",
            "the efficiency is largest for slip across the groove, 0 deg",
        )
        .measured(best, "deg")
        .note(format!("efficiency {:.4}", at(best)))
        .equals(0.0, 0.05, "steps of 0.1 deg"),
        check(
            "fig-5-tangential",
            "Fig 5",
            "friction along the groove causes a larger loss than friction across the groove",
        )
        .measured((1.0 - at(90.0)) / (1.0 - at(0.0)), "times the loss")
        .note(format!("efficiency {:.4} at 0 deg, {:.4} at 90 deg", at(0.0), at(90.0)))
        .at_least(1.0, "the statement requires a ratio above one"),
        check(
            "fig-5-lower-limit",
            "Fig 5",
            "the efficiency is smallest for slip along the groove, 90 deg",
        )
        .measured(least, "deg")
        .note(format!(
            "the lowest efficiency is {:.5}; at 90 deg, it is {:.5}",
            at(least),
            at(90.0)
        )),
        check(
            "across-alone",
            "Eq 11",
            "if friction acts only across the groove, the efficiency increases with the contact angle",
        )
        .measured(f64::from(falling), "steps of one degree without an increase")
        .note("psi_B = 0, lead angles of 2 to 60 deg, contact angles of 5 to 86 deg")
        .at_most(0.0, "the statement permits no exception"),
    ])
}

/// Checks the statement "The peak efficiency exists only at lower helix angles and higher contact
/// angles."
fn optimum_range() -> Vec<Check> {
    let range = |direction: Direction, suffix: &str| {
        let constant = Optimum::constant(direction, F);
        let (largest, least) = (constant.acos(), constant.asin());
        // The loss is minimized numerically at lead angles slightly below and slightly above the
        // largest lead angle at which the efficiency has a peak.
        let inside = |lead: f64| {
            let loss = |contact: f64| {
                Ok::<_, ValidateError>(1.0 - Angles { lead, contact }.efficiency(direction, F))
            };
            minimum_of(loss, 0.3, 1.57).unwrap_or(f64::NAN)
        };
        let wrong =
            i32::from(inside(largest - 0.01) >= 1.569) + i32::from(inside(largest + 0.01) < 1.569);
        check(
            &format!("optimum-range-{suffix}"),
            "Fig 6",
            "the peak efficiency exists only at lower lead angles and higher contact angles",
        )
        .measured(f64::from(wrong), "searches that differ")
        .note(format!(
            "lead angles up to {:.2} deg, contact angles above {:.2} deg; the peak was searched for half a degree below and above the largest lead angle",
            largest.to_degrees(),
            least.to_degrees()
        ))
        .at_most(0.0, "there must be a peak below the largest lead angle and none above it")
    };
    vec![range(FORWARD, "rotary-to-linear"), range(Direction::LinearToRotary, "linear-to-rotary")]
}

/// Checks the statement "The self-braking condition always takes place at the driven side."
fn driven_side() -> Check {
    let (mut wrong, mut points) = (0, 0);
    for friction in (1..=20).map(|i| 0.05 * f64::from(i)) {
        for lead in (1..=80).map(f64::from) {
            for direction in [FORWARD, Direction::LinearToRotary] {
                let locks = Angles::locking_contact_angle(direction, lead.to_radians(), friction);
                let Some(contact) = locks.filter(|contact| *contact < 1.57) else { continue };
                let angles = Angles { lead: lead.to_radians(), contact };
                let psi = angles.screw_slip_angle(direction);
                let (force, torque) = angles.transmitted_at(friction, 0.1, psi);
                let (driven, driving) =
                    if direction == FORWARD { (force, torque) } else { (torque, force) };
                points += 1;
                // The tolerance is the rounding error of a sum whose terms are as large as the
                // friction coefficient divided by the lead angle.
                wrong += i32::from(!(driven.abs() < 1e-9 && driving > 1.0));
            }
        }
    }
    check("driven-side", "Eqs 16, 19", "self-locking takes place at the driven side")
        .measured(f64::from(wrong), "points at the self-locking limit that contradict the claim")
        .note(format!("{points} points: the driven side transmits no power, and the driving side transmits more power than without friction"))
        .at_most(0.0, "always")
}
