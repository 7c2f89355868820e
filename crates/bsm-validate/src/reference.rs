//! Comparison of the rigid model with independent solutions of its equations, which were calculated
//! with 40 digits.

use bsm_case::Case;
use bsm_dyn::{Problem, model::RigidWorkspace};
use serde::Deserialize;

use crate::{Check, PublishedData, ValidateError};

#[derive(Debug, Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Row {
    lead_angle_deg: f64,
    contact_angle_deg: f64,
    screw_speed_rpm: f64,
    nut_speed_rpm: f64,
    friction_coefficient: f64,
    axial_load_N: f64,
    efficiency: f64,
    nut_load: f64,
    unloaded_flank_load: f64,
    screw_load: f64,
    p: f64,
    u: f64,
    tau: f64,
    s: f64,
}

/// Returns one check per row of the table. The checked number is the largest ratio of deviation to
/// tolerance in the row.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let mut work = RigidWorkspace::default();
    let case = published.lin_case.case()?;
    let rows: Vec<Row> = published.lin_reference.rows()?;
    rows.iter().map(|row| check(row, &case, &mut work)).collect()
}

fn check(row: &Row, case: &Case, work: &mut RigidWorkspace) -> Result<Check, ValidateError> {
    let case = Case {
        lead_angle_deg: Some(row.lead_angle_deg),
        contact_angle_deg: Some(row.contact_angle_deg),
        screw_speed_rpm: Some(row.screw_speed_rpm),
        nut_speed_rpm: Some(row.nut_speed_rpm),
        friction_coefficient: Some(row.friction_coefficient),
        axial_load_N: Some(row.axial_load_N),
        ..case.clone()
    };
    let name = format!(
        "lin1994/reference-{}-{}-{}-{}",
        row.lead_angle_deg, row.contact_angle_deg, row.screw_speed_rpm, row.nut_speed_rpm
    );
    let claim = format!(
        "rigid at lead {} deg, contact {} deg, screw {} rpm, nut {} rpm, f {}, {} N",
        row.lead_angle_deg,
        row.contact_angle_deg,
        row.screw_speed_rpm,
        row.nut_speed_rpm,
        row.friction_coefficient,
        row.axial_load_N
    );
    let check =
        Check::new(&name, "Lin, Velinsky and Ravani 1994, Eqs 5-9, solved with 40 digits", claim);

    let problem = case.problem(&bsm_dyn::Model::Rigid.into())?;
    let Problem::Rigid(rigid) = problem else { unreachable!("the model was fixed") };
    let efficiency = rigid.solve(work).efficiency();
    let (Some(efficiency), Ok(root)) = (efficiency, rigid.root(work)) else {
        return Ok(check.measured(f64::NAN, "").at_most(1.0, "the point must converge"));
    };
    // The reference prints nine digits. The tolerance is half a unit of the last digit, or a
    // relative error of 1e-9 if this is larger.
    let deviation = |ours: f64, printed: f64| {
        let last_digit = 10.0_f64.powf(printed.abs().log10().floor() - 8.0);
        (ours - printed).abs() / (0.5 * last_digit).max(1e-9 * printed.abs())
    };
    let columns = [
        ("efficiency", (efficiency - row.efficiency).abs() / (1e-9 * row.efficiency)),
        ("Q_A/F_a", deviation(root.nut_load, row.nut_load)),
        ("Q_A'/F_a", deviation(root.unloaded_flank_load, row.unloaded_flank_load)),
        ("Q_B/F_a", deviation(root.screw_load, row.screw_load)),
        ("p", deviation(root.p, row.p)),
        ("u", deviation(root.u, row.u)),
        ("tau", deviation(root.tau, row.tau)),
        ("s", deviation(root.s, row.s)),
    ];
    let worst = columns.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("", f64::NAN));
    Ok(check
        .measured(worst.1, "of the tolerance")
        .note(format!(
            "largest deviation in {}; efficiency {efficiency:.13}, reference {:.13}",
            worst.0, row.efficiency
        ))
        .at_most(1.0, "1e-9 relative, or half a unit of the last of nine printed digits"))
}
