//! Trends of Xu and Tang (2015), and identities of the slips.

use bsm_case::{Analysis, Scene, Settings};
use bsm_dyn::{Control, Model, ModelWorkspace, SteadyBall, Touch};
use bsm_kin::{BallFrame, Drive, Helix, Site};

use crate::{Check, Published, Study, ValidateError, trends};

const SOURCE: &str = "Xu and Tang 2015";

/// All checks of this source.
pub(crate) fn checks(published: &Published) -> Result<Vec<Check>, ValidateError> {
    let scene = published.xu_case.scene()?;
    let studies = [
        ("", " (nut control)", study(published, Control::Nut)?),
        ("", " (screw control)", study(published, Control::Screw)?),
    ];
    let mut checks = trends::checks(
        &format!("{SOURCE}, Figs 7-9, rolling balls"),
        "xu2015",
        &published.xu_trends,
        &studies,
    )?;
    checks.push(half_the_lead());
    checks.extend(field(&scene)?);
    // Balls with saturated friction need a larger lead, or they would roll.
    let steep = Scene { lead_mm: Some(40.0), ..scene.clone() };
    checks.push(powers(&steep, Model::Rigid)?);
    for model in [Model::RacewayControl, Model::Elastic, Model::Traction] {
        checks.push(powers(&scene, model)?);
    }
    Ok(checks)
}

/// Their sweeps.
pub(crate) fn study(published: &Published, control: Control) -> Result<Study, ValidateError> {
    let scene = published.xu_case.scene()?;
    let settings = Settings { control: Some(control), ..Model::RacewayControl.into() };
    let solution = scene.problem(&settings)?.solve(&mut ModelWorkspace::default());
    Study::slip(&scene, &settings, &solution)
}

/// Differential slip of a rolling ball.
fn half_the_lead() -> Check {
    let drive = Drive { screw_speed: 523.6, nut_speed: 0.0 };
    let mut worst: f64 = 0.0;
    for degrees in (1..=89).map(f64::from) {
        let helix = Helix { radius: 20e-3, lead_angle: 0.5 * degrees.to_radians() };
        let half = 0.5 * helix.lead_angle.sin();
        for control in [Control::Nut, Control::Screw] {
            let angles = [degrees, 90.0 - degrees].map(f64::to_radians);
            let ball = SteadyBall::rolling(control, helix, 3e-3, drive, angles);
            for (site, angle) in [(Site::Nut, angles[0]), (Site::Screw, angles[1])] {
                let slip = ball.differential_slip(&Touch { site, angle }) / (3e-3 * 523.6);
                worst = worst.max((slip - half).abs());
            }
        }
    }
    Check::new(
        "xu2015/half-the-lead",
        SOURCE,
        "differential slip of a rolling ball is half the lead's, r_b W sinα/2, at any contact angle",
    )
    .measured(worst, "of r_b W")
    .at_most(1e-14, "rounding of speeds of ten times r_b W")
}

/// Differential slip and spin of the traction model against the field of slip velocities.
fn field(scene: &Scene) -> Result<[Check; 2], ValidateError> {
    let settings: Settings = Model::Traction.into();
    let solution = scene.problem(&settings)?.solve(&mut ModelWorkspace::default());
    let report = Analysis::slip(scene, &settings, &solution)?;
    let number = |name: &str| report.number(name).unwrap_or(f64::NAN);
    let (mut value, mut slope): (f64, f64) = (0.0, 0.0);
    if let (Some(motion), Ok(bsm_dyn::Problem::Traction(case))) =
        (solution.solved().and_then(|solved| solved.ball.motion), scene.problem(&settings))
    {
        let (helix, radius, drive) = (case.screw.helix, case.screw.ball.radius, case.screw.drive);
        let ball = SteadyBall { helix, radius, drive, motion };
        for (i, site) in [Site::Nut, Site::Screw].into_iter().enumerate() {
            let state = solution.contact(site);
            let touch = Touch { site, angle: state.map_or(f64::NAN, |contact| contact.angle) };
            // Of the model, which knows the motion in its own units and axes.
            let own = state.and_then(|contact| contact.slip).map_or(f64::NAN, |slip| slip.speed);
            let contact = ball.contact(&touch);
            let tangent = BallFrame::<f64>::tangent();
            let across = tangent.cross(&contact.normal);
            let at = |x: f64| {
                let point = contact.point(radius) + across * x;
                ball.relative_to(site).slip_velocity(helix.arc_length_per_radian(), &point)
            };
            let name = ["nut", "screw"][i];
            let slip = number(&format!("{name}_differential_slip_m_s"));
            value = value.max((own / slip - 1.0).abs());
            // The field of a rigid motion is linear: a wide step has no truncation.
            let spin = number(&format!("{name}_spin_rad_s"));
            let difference = (at(1e-3) - at(-1e-3)).dot(&tangent) / 2e-3;
            slope = slope.max((difference / spin - 1.0).abs());
        }
    }
    let check = |key: &str, claim: &str, worst: f64, reason: &str| {
        Check::new(&format!("xu2015/{key}"), "identity, model traction", claim)
            .measured(worst, "relative")
            .at_most(1e-11, reason)
    };
    Ok([
        check(
            "field-value",
            "differential slip is the field of slip velocities at the contact centre",
            value,
            "rounding of speeds of a hundred times the slip",
        ),
        check(
            "field-slope",
            "spin is the derivative of that field across the groove",
            slope,
            "rounding of speeds of a hundred times the spin over a millimetre",
        ),
    ])
}

/// The powers of the parts of the slip against what the model dissipates.
fn powers(scene: &Scene, model: Model) -> Result<Check, ValidateError> {
    let settings: Settings = model.into();
    let solution = scene.problem(&settings)?.solve(&mut ModelWorkspace::default());
    let report = Analysis::slip(scene, &settings, &solution)?;
    let difference = report.number("power_difference").map_or(f64::NAN, f64::abs);
    let parts = ["centre", "spin", "curvature"].map(|part| {
        let power =
            |contact: &str| report.number(&format!("{contact}_{part}_power_W")).unwrap_or(0.0);
        format!("{part} {:.4} W", power("nut") + power("screw") + power("minor"))
    });
    Ok(Check::new(
        &format!("xu2015/powers-{}", model.name()),
        "identity",
        format!("the powers of the parts of the slip are what model {} dissipates", model.name()),
    )
    .measured(difference, "relative")
    .note(parts.join(", "))
    .at_most(
        1e-10,
        "the motion is read back from rounded outputs, whose spins are up to 1e6 rad/s",
    ))
}
