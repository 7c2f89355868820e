//! Checks of trends in the paper of Xu and Tang (2015), and of identities between different
//! definitions of slip.

use bsm_case::{Case, OutputName, Settings, output, slip};
use bsm_dyn::{
    Control, Model, ModelWorkspace,
    solution::{ContactSite, SteadyBall},
};
use bsm_kin::{BallFrame, Site};
use bsm_report::sheets::Study;

use crate::report::largest;
use crate::trends::LabeledStudy;
use crate::{Check, PublishedData, ValidateError, trends};

const SOURCE: &str = "Xu and Tang 2015";

/// Contact angles at nut and screw in Tables 2 and 3 of the paper \[deg\].
const ANGLES: [f64; 2] = [50.0, 40.0];

/// Returns all checks of this paper.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let case = published.xu_case.case()?;
    let rolling = |control| study(published, Model::RacewayControl, control);
    let studies = [
        LabeledStudy { label: "rolling", setting: " (nut control)", study: rolling(Control::Nut)? },
        LabeledStudy {
            label: "rolling",
            setting: " (screw control)",
            study: rolling(Control::Screw)?,
        },
        LabeledStudy {
            label: "rigid",
            setting: "",
            study: study(published, Model::Rigid, Control::Nut)?,
        },
        LabeledStudy {
            label: "traction",
            setting: "",
            study: study(published, Model::Traction, Control::Nut)?,
        },
    ];
    let mut checks = trends::checks(
        &format!("{SOURCE}, Figs 7-9 and text"),
        "xu2015",
        &published.xu_trends,
        &studies,
    )?;
    checks.extend(field(&case)?);
    checks.extend(formulas(&case)?);
    Ok(checks)
}

/// Returns the case with the contact angles that the paper states for the running screw.
fn running(case: Case) -> Case {
    Case {
        nut_running_contact_angle_deg: Some(ANGLES[0]),
        screw_running_contact_angle_deg: Some(ANGLES[1]),
        ..case
    }
}

/// Calculates the sweeps of the paper with the given model.
pub(crate) fn study(
    published: &PublishedData,
    model: Model,
    control: Control,
) -> Result<Study, ValidateError> {
    let case = running(published.xu_case.case()?);
    let settings = Settings { control: Some(control), ..model.into() };
    let solution = case.problem(&settings)?.solve(&mut ModelWorkspace::default());
    Ok(Study::slip(&case, &settings, &solution)?)
}

/// Evaluates the printed formulas of the paper for the case in its Tables 1 to 3.
fn formulas(case: &Case) -> Result<Vec<Check>, ValidateError> {
    let settings: Settings = Model::RacewayControl.into();
    let solution = case.problem(&settings)?.solve(&mut ModelWorkspace::default());
    let Ok(bsm_dyn::Problem::RacewayControl(problem)) = case.problem(&settings) else {
        unreachable!("the model was fixed")
    };
    let (helix, radius, drive) =
        (problem.screw.point.helix, problem.screw.point.ball.radius, problem.screw.point.drive);
    let angles = ANGLES.map(f64::to_radians);
    let ball = SteadyBall::rolling(Control::Nut, helix, radius, drive, angles);
    // The array `printed` contains Eqs 1 and 2 as printed, for a nut that does not rotate.
    let ((sin_a, cos_a), [nut, screw]) = (helix.lead_angle.sin_cos(), angles);
    let (d, w, speed) = (helix.radius / cos_a, ball.motion.omega, drive.screw_speed);
    let printed = [
        (-radius * w.x)
            .hypot(d * ball.motion.precession + radius * (w.z * nut.cos() - w.y * nut.sin())),
        (radius * (w.x - speed * sin_a)).hypot(
            d * (ball.motion.precession - speed)
                - radius * ((w.z - speed * cos_a) * screw.cos() - w.y * screw.sin()),
        ),
    ];
    let touch = [
        ContactSite { site: Site::Nut, angle: nut },
        ContactSite { site: Site::Screw, angle: screw },
    ];
    let exact = touch.map(|touch| ball.differential_slip(&touch));
    let worst = largest((0..2).map(|i| (printed[i] / exact[i] - 1.0).abs()));
    // The nut moves only along the axis, so the distances between the groove-arc centers in Eq 3
    // depend only on the approaches, the contact angles and the axial displacement.
    let state = |site| solution.contact(site);
    let (mut radial, mut axial) = (0.0, 0.0);
    for (site, conformity) in
        [(Site::Nut, case.nut_conformity), (Site::Screw, case.screw_conformity)]
    {
        let offset = 2.0 * radius * (conformity.unwrap_or(f64::NAN) - 0.5);
        let approach = state(site).and_then(|c| c.pressed).map_or(f64::NAN, |p| p.approach);
        let (sin, cos) = state(site).map_or(f64::NAN, |c| c.angle).sin_cos();
        radial += (offset + approach) * cos;
        axial += (offset + approach) * sin;
    }
    let offsets =
        case.nut_conformity.zip(case.screw_conformity).map_or(f64::NAN, |(n, s)| n + s - 1.0);
    let length = 2.0 * radius * offsets;
    let displacement =
        solution.steady_state().and_then(|s| s.ball.axial_displacement).unwrap_or(f64::NAN);
    let binormal = displacement * problem.screw.point.helix.lead_angle.cos();
    let (sin, cos) = problem.screw.point.contact_angle.sin_cos();
    let off = [radial - length * cos, axial - length * sin - binormal];
    let off = largest(off.map(|x| x.abs() / length));
    let check = |key: &str, equation: &str, claim: &str| {
        Check::new(&format!("xu2015/{key}"), &format!("{SOURCE}, {equation}"), claim)
    };
    Ok(vec![
        check("eqs-1-2", "Eqs 1-2", "the printed formulas for the differential slip give the slip at the contact center")
            .measured(worst, "relative")
            .note(format!("{:.4} m/s at the nut, {:.4} at the screw, 50 and 40 deg", exact[0], exact[1]))
            .at_most(1e-11, "rounding errors of speeds that are a hundred times the slip"),
        check("eq-3", "Eq 3", "the contact angles follow from the distances between the groove-arc centers")
            .measured(off, "of the length")
            .note("the axial displacement is included in Eq 3f and omitted in Eq 3e; as printed, both equations reproduce only the approaches")
            .at_most(1e-9, "the forces are balanced to 1e-10 of the load"),
    ])
}

/// Compares the differential slip and the spin that model `traction` reports with values that are
/// calculated from the slip velocity field.
fn field(case: &Case) -> Result<[Check; 2], ValidateError> {
    let settings: Settings = Model::Traction.into();
    let solution = case.problem(&settings)?.solve(&mut ModelWorkspace::default());
    let report = slip(case, &settings, &solution)?;
    let number = |name: OutputName| report.number(name).unwrap_or(f64::NAN);
    let (mut value, mut slope): (f64, f64) = (0.0, 0.0);
    if let (Some(motion), Ok(bsm_dyn::Problem::Traction(traction))) =
        (solution.steady_state().and_then(|solved| solved.ball.motion), case.problem(&settings))
    {
        let (helix, radius, drive) = (
            traction.screw.point.helix,
            traction.screw.point.ball.radius,
            traction.screw.point.drive,
        );
        let ball = SteadyBall { helix, radius, drive, motion };
        let contacts = [
            (Site::Nut, output!(nut_differential_slip_m_s), output!(nut_spin_rad_s)),
            (Site::Screw, output!(screw_differential_slip_m_s), output!(screw_spin_rad_s)),
        ];
        for (site, slip, spin) in contacts {
            let state = solution.contact(site);
            let touch =
                ContactSite { site, angle: state.map_or(f64::NAN, |contact| contact.angle) };
            // The slip speed is taken from the solution of the model instead of the slip report, so
            // that the two can be compared.
            let own = state.and_then(|contact| contact.slip).map_or(f64::NAN, |slip| slip.speed);
            let contact = ball.contact(&touch);
            let tangent = BallFrame::<f64>::tangent();
            let across = tangent.cross(&contact.normal);
            let at = |x: f64| {
                let point = contact.point(radius) + across * x;
                ball.relative_to(site).slip_velocity(helix.arc_length_per_radian(), &point)
            };
            value = value.max((own / number(slip) - 1.0).abs());
            // The velocity field of a rigid motion is linear, so the difference has no truncation
            // error even for a large step.
            let difference = (at(1e-3) - at(-1e-3)).dot(&tangent) / 2e-3;
            slope = slope.max((difference / number(spin) - 1.0).abs());
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
            "differential slip equals the slip velocity at the contact center",
            value,
            "rounding errors of speeds that are a hundred times the slip",
        ),
        check(
            "field-slope",
            "spin equals the derivative of the slip velocity field across the groove",
            slope,
            "rounding errors of speeds that are a hundred times the spin multiplied by 1 mm",
        ),
    ])
}
