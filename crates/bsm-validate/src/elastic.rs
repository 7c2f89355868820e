//! Checks of the models `elastic` and `traction`: comparison with an independent solution.

use bsm_case::{Case, Settings};
use bsm_dyn::{Model, ModelWorkspace, Problem, Solution, model::Traction};
use bsm_kin::{Motion, Site};
use serde::Deserialize;

use crate::{Check, PublishedData, ValidateError};

const SOURCE: &str = "independent solution of the elastic models, Lin's screw, conformity 0.53";

/// Quadrature accuracy with which `traction` is compared with the reference values.
const FINE: f64 = 1e-10;

/// Returns all checks of the models `elastic` and `traction`.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let lin = lin(published)?;
    let work = &mut ModelWorkspace::default();
    let mut checks = Vec::new();
    for row in published.elastic_reference.rows::<Reference>()? {
        checks.extend(reference(&row, &lin, work)?);
    }
    Ok(checks)
}

/// Returns the case of Lin, Velinsky and Ravani (1994) with conformities of 0.53 at nut and screw.
pub(crate) fn lin(published: &PublishedData) -> Result<Case, ValidateError> {
    Ok(Case {
        nut_conformity: Some(0.53),
        screw_conformity: Some(0.53),
        ..published.lin_case.case()?
    })
}

fn solve(
    case: &Case,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Solution, ValidateError> {
    Ok(case.problem(settings)?.solve(work))
}

/// Returns the value, or NaN if the value is missing. NaN fails every check.
fn number(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Reference {
    model: String,
    lead_angle_deg: f64,
    contact_angle_deg: f64,
    screw_speed_rpm: f64,
    axial_load_N: f64,
    efficiency: f64,
    nut_normal_load_N: f64,
    screw_normal_load_N: f64,
    nut_contact_angle_deg: f64,
    screw_contact_angle_deg: f64,
    p: f64,
    omega_t: f64,
    omega_n: Option<f64>,
    omega_b: Option<f64>,
    binormal_displacement_um: f64,
}

/// Checks a row of the table. The checked number is the largest ratio of deviation to tolerance.
/// Model `traction` is checked twice: with the settings of the table and with the default settings.
fn reference(
    row: &Reference,
    lin: &Case,
    work: &mut ModelWorkspace,
) -> Result<Vec<Check>, ValidateError> {
    let mut case = lin.clone();
    for (name, value) in [
        ("lead_angle_deg", row.lead_angle_deg),
        ("contact_angle_deg", row.contact_angle_deg),
        ("screw_speed_rpm", row.screw_speed_rpm),
        ("axial_load_N", row.axial_load_N),
    ] {
        case.set(name, value)?;
    }
    let point = format!(
        "{}-{}-{}-{}-{}",
        row.model, row.lead_angle_deg, row.contact_angle_deg, row.screw_speed_rpm, row.axial_load_N
    );
    let claim = format!(
        "{} at lead {} deg, contact {} deg, {} rpm, {} N",
        row.model, row.lead_angle_deg, row.contact_angle_deg, row.screw_speed_rpm, row.axial_load_N
    );
    let check = |name: &str| Check::new(&format!("elastic/{name}-{point}"), SOURCE, claim.clone());

    if row.model == "elastic" {
        let o = solve(&case, &Model::Elastic.into(), work)?;
        let (worst, column) = row.deviation(&o, [ELASTIC_DIGITS, [0.0; 6]]);
        let check = check("reference").measured(worst, "of the tolerance").note(column);
        return Ok(vec![check.at_most(1.0, "half a unit of the last printed digit")]);
    }
    let Problem::Traction(traction) = case.problem(&Model::Traction.into())? else {
        unreachable!("the model was fixed")
    };
    let fine = Traction { accuracy: FINE, creep: 1e-6, ..traction };
    let o = Problem::Traction(fine).solve(work);
    let (worst, column) = row.deviation(&o, [TRACTION_DIGITS, [0.0; 6]]);
    let exact = check("reference")
        .measured(worst, "of the tolerance")
        .note(column)
        .at_most(1.0, "half a unit of the last printed digit");

    let o = Problem::Traction(traction).solve(work);
    let (worst, column) = row.deviation(&o, DEFAULT_SETTINGS);
    let default = check("default-settings")
        .measured(worst, "of the tolerance")
        .note(column)
        .at_most(1.0, "permitted errors: 1e-6 for the efficiency, 1e-5 for loads and angles, 1e-4 for the motion");
    Ok(vec![exact, default])
}

/// Half a unit of the last digit that the reference prints for `traction`, in this order:
/// efficiency, loads, angles, precession, rotation and displacement.
const TRACTION_DIGITS: [f64; 6] = [0.51e-7, 0.51e-4, 0.51e-5, 0.51e-6, 0.51e-5, 0.51e-5];
/// Half a unit of the last digit that the reference prints for `elastic`, in this order:
/// efficiency, loads, angles, precession, rotation and displacement.
const ELASTIC_DIGITS: [f64; 6] = [0.51e-9, 0.51e-5, 0.51e-6, 0.51e-7, 0.51e-5, 0.51e-6];

/// Absolute and relative tolerances for the default settings of `traction`, in this order:
/// efficiency, loads, angles, precession, rotation and displacement.
const DEFAULT_SETTINGS: [[f64; 6]; 2] =
    [[1e-6, 0.51e-4, 0.51e-5, 1e-5, 1e-4, 0.0], [0.0, 1e-5, 1e-5, 0.0, 1e-4, 1e-4]];

impl Reference {
    /// Returns the largest ratio of deviation to tolerance, and a note that names the column with
    /// this ratio.
    fn deviation(&self, solution: &Solution, [absolute, relative]: [[f64; 6]; 2]) -> (f64, String) {
        let limit = |i: usize| (absolute[i], relative[i]);
        let [eta, load, angle, rate, rotation, shift] = [0, 1, 2, 3, 4, 5].map(limit);
        let speed = self.screw_speed_rpm * std::f64::consts::PI / 30.0;
        let degrees = |x: Option<f64>| Some(number(x).to_degrees());
        let over_speed = |x: Option<f64>| Some(number(x) / speed);
        let ball = solution.steady_state().map(|solved| &solved.ball);
        let axial = ball.and_then(|ball| ball.axial_displacement);
        let binormal = axial.map(|x| 1e6 * x * self.lead_angle_deg.to_radians().cos());
        let contacts = [Site::Nut, Site::Screw].map(|site| solution.contact(site));
        let [q_a, q_b] = contacts.map(|contact| contact?.load);
        let [beta_a, beta_b] = contacts.map(|contact| degrees(contact.map(|c| c.angle)));
        let motion = ball.and_then(|ball| ball.motion.as_ref());
        let rate_of = |read: fn(&Motion<f64>) -> f64| over_speed(motion.map(read));
        [
            ("efficiency", solution.efficiency(), Some(self.efficiency), eta),
            ("Q_A", q_a, Some(self.nut_normal_load_N), load),
            ("Q_B", q_b, Some(self.screw_normal_load_N), load),
            ("beta_A", beta_a, Some(self.nut_contact_angle_deg), angle),
            ("beta_B", beta_b, Some(self.screw_contact_angle_deg), angle),
            ("p", rate_of(|m| m.precession), Some(self.p), rate),
            ("omega_t", rate_of(|m| m.omega.x), Some(self.omega_t), rotation),
            ("omega_n", rate_of(|m| m.omega.y), self.omega_n, rotation),
            ("omega_b", rate_of(|m| m.omega.z), self.omega_b, rotation),
            ("delta_b", binormal, Some(self.binormal_displacement_um), shift),
        ]
        .into_iter()
        .filter_map(|(name, ours, theirs, (absolute, relative))| {
            let (ours, theirs) = (number(ours), theirs?);
            let limit = f64::max(absolute, relative * theirs.abs());
            let note = format!("largest deviation in {name}: {ours} instead of {theirs}");
            Some(((ours - theirs).abs() / limit, note))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::NAN, String::new()))
    }
}
