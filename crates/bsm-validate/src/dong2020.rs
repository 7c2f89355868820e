//! Checks of trends in the paper of Dong et al. (2020), and of identities for contact geometry and
//! thrust.

use bsm_case::{Answer, Case, OutputName, jam, output};
use bsm_dyn::{Model, ModelWorkspace};
use bsm_report::sheets::Study;

use crate::trends::LabeledStudy;
use crate::{Check, PublishedData, ValidateError, trends};

const SOURCE: &str = "Dong et al. 2020";

/// Returns all checks of this paper.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let case = published.dong_case.case()?;
    let studies = [
        LabeledStudy {
            label: "raceway-control",
            setting: "",
            study: study(published, Model::RacewayControl)?,
        },
        LabeledStudy { label: "traction", setting: "", study: study(published, Model::Traction)? },
    ];
    let mut checks = trends::checks(
        &format!("{SOURCE}, Figs 13-19"),
        "dong2020",
        &published.dong_trends,
        &studies,
    )?;
    checks.push(radical(&case)?);
    checks.push(printed_radical(&case)?);
    Ok(checks)
}

/// Calculates the sweeps of the paper with the given model.
pub(crate) fn study(published: &PublishedData, model: Model) -> Result<Study, ValidateError> {
    let case = published.dong_case.case()?;
    let settings = model.into();
    let solution = case.problem(&settings)?.solve(&mut ModelWorkspace::default());
    Ok(Study::jam(&case, &settings, &solution)?)
}

/// Returns the jamming analysis of a case. The motion of the ball is calculated by raceway control.
fn analysis(case: &Case) -> Result<Answer, ValidateError> {
    let problem = case.problem(&Model::RacewayControl.into())?;
    Ok(jam(case, &problem.solve(&mut ModelWorkspace::default()))?)
}

fn number(report: &Answer, name: OutputName) -> f64 {
    report.number(name).unwrap_or(f64::NAN)
}

/// Checks the corrected radical of Eq 17. The load is small, because the effect of inertia on the
/// contact angles is then largest.
fn radical(case: &Case) -> Result<Check, ValidateError> {
    let light = Case { axial_load_N: case.loaded_balls, ..case.clone() };
    let report = analysis(&light)?;
    let offset = |conformity: Option<f64>| {
        let conformity = conformity.unwrap_or(f64::NAN);
        (conformity - 0.5) * case.ball_diameter_mm.unwrap_or(f64::NAN) * 1e3
    };
    let length = |conformity, name| offset(conformity) + number(&report, name);
    let nut = length(case.nut_conformity, output!(nut_total_approach_um));
    let screw = length(case.screw_conformity, output!(screw_total_approach_um));
    let angle = |name| number(&report, name).to_radians();
    let (a, b) = (
        angle(output!(nut_angle_with_permanent_set_deg)),
        angle(output!(screw_angle_with_permanent_set_deg)),
    );
    let square =
        (nut * a.sin() + screw * b.sin()).powi(2) + (nut * a.cos() + screw * b.cos()).powi(2);
    // tan²(D/2) = [(l_A + l_B)² − A²] / [A² − (l_A − l_B)²]               (J6)
    let radical = ((nut + screw).powi(2) - square) / (square - (nut - screw).powi(2));
    let ours = 2.0 * radical.sqrt().atan();
    Ok(Check::new(
        "dong2020/radical",
        &format!("{SOURCE}, Eq 17 corrected"),
        "the corrected radical gives the difference between the contact angles, at 1 N per ball",
    )
    .measured((ours - (b - a)).abs(), "rad")
    .note(format!("difference {:.4} deg", (b - a).to_degrees()))
    .at_most(1e-12, "rounding error of squared lengths divided by their difference of 0.008"))
}

/// Shows that the radical of Eq 17 as printed requires an impossible friction coefficient, because
/// some lengths in the printed radical are not sides of the triangle from which the equation is
/// derived.
fn printed_radical(case: &Case) -> Result<Check, ValidateError> {
    let report = analysis(case)?;
    let mm = |name: OutputName| 1e-3 * number(&report, name);
    let (screw, nut) = (mm(output!(screw_total_approach_um)), mm(output!(nut_total_approach_um)));
    let ball = case.ball_diameter_mm.unwrap_or(f64::NAN);
    let nominal = case.pitch_circle_diameter_mm.unwrap_or(f64::NAN);
    let offset = |f: Option<f64>| (f.unwrap_or(f64::NAN) - 0.5) * ball;
    let (l_a, l_b) = (offset(case.nut_conformity) + nut, offset(case.screw_conformity) + screw);
    let angle = |name| number(&report, name).to_radians();
    let (a, b) = (
        angle(output!(nut_angle_with_permanent_set_deg)),
        angle(output!(screw_angle_with_permanent_set_deg)),
    );
    let square = l_a.powi(2) + l_b.powi(2) + 2.0 * l_a * l_b * (a - b).cos();
    // The printed numerator is −A₁² − A₂² + (δ_i + δ_o)² + 2 δ_i d_o − 2 δ_i d_b + 2 δ_o d_o + (d_o
    // − d_b)².
    let above = -square
        + (screw + nut).powi(2)
        + 2.0 * screw * (nominal - ball)
        + 2.0 * nut * nominal
        + (nominal - ball).powi(2);
    let printed = (above / (square + (screw - nut).powi(2))).sqrt();
    Ok(Check::new(
        "dong2020/printed-radical",
        &format!("{SOURCE}, Eq 17 as printed"),
        "the printed radical requires a friction coefficient that steel never reaches",
    )
    .measured(1.0 / printed, "reciprocal of the printed radical")
    .note(format!(
        "printed radical: {printed:.1}; corrected radical: {:.1e}",
        (0.5 * (b - a)).tan().abs()
    ))
    .at_most(0.1, "a required friction coefficient of 10 or more is impossible"))
}
