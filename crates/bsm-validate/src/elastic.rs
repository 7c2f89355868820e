//! Elastic contacts: Hertz constants, reference solutions of elastic and traction, a bearing, and
//! the hypothesis of raceway control.

use bsm_case::{Scene, Settings};
use bsm_dyn::{Control, Hertz, Model, ModelWorkspace, Problem, Solution, Traction};
use bsm_kin::{Motion, Site};
use serde::Deserialize;

use crate::{Check, Published, ValidateError};

const SOURCE: &str = "independent solution of the elastic models, Lin's screw, conformity 0.53";

/// Accuracy of the quadrature that the reference values are compared with.
const FINE: f64 = 1e-10;

/// All checks of this source.
pub(crate) fn checks(published: &Published) -> Result<Vec<Check>, ValidateError> {
    let lin = lin(published)?;
    let work = &mut ModelWorkspace::default();
    let mut checks = hertz(&lin, published)?;
    for row in published.elastic_reference.rows::<Reference>()? {
        checks.extend(reference(&row, &lin, work)?);
    }
    for row in published.transition.rows::<Transition>()? {
        checks.extend(transition(&row, &lin, work)?);
    }
    checks.extend(bearing(work)?);
    checks.extend(hypothesis(&lin, work)?);
    Ok(checks)
}

/// Lin's case with conformities of 0.53.
pub(crate) fn lin(published: &Published) -> Result<Scene, ValidateError> {
    Ok(Scene {
        nut_conformity: Some(0.53),
        screw_conformity: Some(0.53),
        ..published.lin_case.scene()?
    })
}

fn solve(
    scene: &Scene,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Solution, ValidateError> {
    Ok(scene.problem(settings)?.solve(work))
}

/// A missing number is a NaN, which no check passes.
fn number(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

#[derive(Deserialize)]
struct HertzRow {
    member: String,
    quantity: String,
    value: f64,
}

/// Constants of the Hertz contacts at nut and screw.
fn hertz(lin: &Scene, published: &Published) -> Result<Vec<Check>, ValidateError> {
    let Problem::Elastic(case) = lin.problem(&Model::Elastic.into())? else {
        unreachable!("the model was fixed")
    };
    let Ok([nut, screw]) = case.at.hertz() else { unreachable!("the grooves have ellipses") };
    let read = |contact: &Hertz, quantity: &str| match quantity {
        "ratio" => contact.ratio(),
        "stiffness_N_m15" => contact.stiffness(),
        "a_over_cube_root_of_load_m" => contact.semi_axes(1.0).0,
        "b_over_cube_root_of_load_m" => contact.semi_axes(1.0).1,
        _ => f64::NAN,
    };
    let check = |row: &HertzRow| {
        let contact = if row.member == "nut" { &nut } else { &screw };
        Check::new(
            &format!("elastic/hertz-{}-{}", row.member, row.quantity),
            SOURCE,
            format!("Hertz contact at the {}: {}", row.member, row.quantity),
        )
        .measured(read(contact, &row.quantity), "")
        .equals(row.value, 1e-8 * row.value, "1e-8 relative, the digits of the table")
    };
    Ok(published.hertz.rows::<HertzRow>()?.iter().map(check).collect())
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
    axial_displacement_um: f64,
}

/// The largest deviation over the columns of a row; for traction with the dials of the table and
/// with the default ones.
fn reference(
    row: &Reference,
    lin: &Scene,
    work: &mut ModelWorkspace,
) -> Result<Vec<Check>, ValidateError> {
    let mut scene = lin.clone();
    for (name, value) in [
        ("lead_angle_deg", row.lead_angle_deg),
        ("contact_angle_deg", row.contact_angle_deg),
        ("screw_speed_rpm", row.screw_speed_rpm),
        ("axial_load_N", row.axial_load_N),
    ] {
        scene.set(name, value)?;
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
        let o = solve(&scene, &Model::Elastic.into(), work)?;
        let (worst, column) = row.deviation(&o, &ELASTIC_DIGITS);
        let check = check("reference").measured(worst, "of the tolerance").note(column);
        return Ok(vec![check.at_most(1.0, "half a unit of the last printed digit")]);
    }
    let Problem::Traction(case) = scene.problem(&Model::Traction.into())? else {
        unreachable!("the model was fixed")
    };
    let fine = Traction { accuracy: FINE, creep: 1e-6, ..case };
    let o = Problem::Traction(fine).solve(work);
    let (worst, column) = row.deviation(&o, &TRACTION_DIGITS);
    let exact = check("reference")
        .measured(worst, "of the tolerance")
        .note(column)
        .at_most(1.0, "half a unit of the last printed digit");

    let o = Problem::Traction(case).solve(work);
    let (worst, column) = row.deviation(&o, &DEFAULT_DIALS);
    let default = check("default-dials")
        .measured(worst, "of the tolerance")
        .note(column)
        .at_most(1.0, "1e-6 in the efficiency, 1e-5 in loads and angles, 1e-4 in the motion");
    Ok(vec![exact, default])
}

/// What a column may deviate: absolute, or relative where that is larger.
type Limit = (f64, f64);

/// Limits of efficiency, loads \[N\], angles \[deg\], precession over W, rotation over W, and
/// displacement \[µm\]: half a unit of the last printed digit.
const TRACTION_DIGITS: [Limit; 6] = [
    (0.51e-7, 0.0),
    (0.51e-4, 0.0),
    (0.51e-5, 0.0),
    (0.51e-6, 0.0),
    (0.51e-5, 0.0),
    (0.51e-5, 0.0),
];
const ELASTIC_DIGITS: [Limit; 6] = [
    (0.51e-9, 0.0),
    (0.51e-5, 0.0),
    (0.51e-6, 0.0),
    (0.51e-7, 0.0),
    (0.51e-5, 0.0),
    (0.51e-6, 0.0),
];

/// What the default quadrature and creep speed may change.
const DEFAULT_DIALS: [Limit; 6] =
    [(1e-6, 0.0), (0.51e-4, 1e-5), (0.51e-5, 1e-5), (1e-5, 0.0), (1e-4, 1e-4), (0.0, 1e-4)];

impl Reference {
    /// Largest deviation over its limit, and in which column.
    fn deviation(&self, solution: &Solution, limits: &[Limit; 6]) -> (f64, String) {
        let [eta, load, angle, rate, rotation, shift] = *limits;
        let speed = self.screw_speed_rpm * std::f64::consts::PI / 30.0;
        let degrees = |x: Option<f64>| Some(number(x).to_degrees());
        let over_speed = |x: Option<f64>| Some(number(x) / speed);
        let ball = solution.solved().map(|solved| &solved.ball);
        let displacement = ball.and_then(|ball| ball.axial_displacement).map(|x| 1e6 * x);
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
            ("delta_a", displacement, Some(self.axial_displacement_um), shift),
        ]
        .into_iter()
        .filter_map(|(name, ours, theirs, (absolute, relative))| {
            let (ours, theirs) = (number(ours), theirs?);
            let limit = f64::max(absolute, relative * theirs.abs());
            let note = format!("largest in {name}: {ours} for {theirs}");
            Some(((ours - theirs).abs() / limit, note))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::NAN, String::new()))
    }
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "columns of the table")]
struct Transition {
    axial_load_N: f64,
    screw_speed_rpm: f64,
    raceway_control: Option<f64>,
    traction: f64,
    elastic: f64,
}

/// Efficiency of the three models from rolling to gross skid.
fn transition(
    row: &Transition,
    lin: &Scene,
    work: &mut ModelWorkspace,
) -> Result<Vec<Check>, ValidateError> {
    let scene = Scene {
        axial_load_N: Some(row.axial_load_N),
        screw_speed_rpm: Some(row.screw_speed_rpm),
        ..lin.clone()
    };
    let mut checks = Vec::new();
    for (model, claimed, digit) in [
        (Model::RacewayControl, row.raceway_control, 1e-4),
        (Model::Traction, Some(row.traction), 1e-5),
        (Model::Elastic, Some(row.elastic), 1e-5),
    ] {
        let Some(claimed) = claimed else { continue };
        let settings = Settings { control: Some(Control::Nut), ..model.into() };
        let o = solve(&scene, &settings, work)?;
        let name = model.name();
        let check = Check::new(
            &format!("elastic/transition-{name}-{}-{}", row.axial_load_N, row.screw_speed_rpm),
            SOURCE,
            format!("efficiency of {name} at {} N, {} rpm", row.axial_load_N, row.screw_speed_rpm),
        )
        .measured(number(o.efficiency()), "");
        // At 20 N and 6000 rpm the table leaves the centrifugal force out of raceway control.
        let light = model == Model::RacewayControl && row.screw_speed_rpm > 2000.0;
        let onset = o.solved().and_then(|solved| solved.skid?.onset_number());
        let partly = model == Model::Traction && onset.is_some_and(|s| (0.1..2.0).contains(&s));
        checks.push(if light {
            check.equals(claimed, 1e-3, "the table has no centrifugal force in it")
        } else if partly {
            let rings = "the table is of a quadrature by rings, which errs by up to 6.2e-4 where balls skid partly";
            check.equals(claimed, 6.5e-4, rings)
        } else {
            check.equals(claimed, 0.6 * digit, "half a unit of the last printed digit")
        });
    }
    Ok(checks)
}

/// The thrust-loaded 218 angular-contact bearing: a screw without lead.
fn bearing(work: &mut ModelWorkspace) -> Result<Vec<Check>, ValidateError> {
    let scene = Scene {
        ball_diameter_mm: Some(22.23),
        pitch_circle_diameter_mm: Some(125.3),
        lead_angle_deg: Some(1e-6),
        contact_angle_deg: Some(40.0),
        nut_conformity: Some(0.5232),
        screw_conformity: Some(0.5232),
        friction_coefficient: Some(0.0),
        youngs_modulus_GPa: Some(206.9),
        screw_speed_rpm: Some(1.0),
        axial_load_N: Some(17_800.0),
        loaded_balls: Some(16.0),
        ..Scene::default()
    };
    let solution = solve(&scene, &Model::RacewayControl.into(), work)?;
    let nut = solution.contact(Site::Nut);
    let displacement = solution.solved().and_then(|solved| solved.ball.axial_displacement);
    let check = |key: &str, claim: &str| {
        let source = "Harris and Kotzalas, thrust-loaded 218 angular-contact ball bearing";
        Check::new(&format!("bearing-218/{key}"), source, claim)
    };
    let chart = "the book reads the stiffness from a chart";
    Ok(vec![
        check("contact-angle", "contact angle under 17 800 N of thrust")
            .measured(number(nut.map(|contact| contact.angle)).to_degrees(), "deg")
            .equals(41.6, 0.15, &format!("{chart}: 0.15 of the change of 1.6 deg")),
        check("normal-load", "normal load of a ball")
            .measured(number(nut.and_then(|contact| contact.load)), "N")
            .equals(1676.0, 5.0, &format!("follows the angle; {chart}")),
        check("displacement", "axial displacement")
            .measured(1e3 * number(displacement), "mm")
            .equals(0.0386, 0.003, &format!("follows the change of the angle; {chart}")),
    ])
}

/// Spin at nut and screw in the traction model as the load falls: raceway control says that one
/// race has all of it.
fn hypothesis(lin: &Scene, work: &mut ModelWorkspace) -> Result<Vec<Check>, ValidateError> {
    let mut checks = Vec::new();
    for (rpm, load) in
        [(2000.0, 2113.0), (2000.0, 500.0), (2000.0, 100.0), (6000.0, 500.0), (6000.0, 100.0)]
    {
        let scene = Scene { axial_load_N: Some(load), screw_speed_rpm: Some(rpm), ..lin.clone() };
        let o = solve(&scene, &Model::Traction.into(), work)?;
        let spin = |site| number(o.contact(site).and_then(|c| Some(c.slip?.spin))).abs();
        let (nut, screw) = (spin(Site::Nut), spin(Site::Screw));
        let share = nut.min(screw) / (nut + screw);
        let check = |claim: &str| {
            let key = format!("elastic/raceway-hypothesis-{load}-{rpm}");
            Check::new(&key, SOURCE, format!("{claim}, at {load} N and {rpm} rpm"))
                .measured(share, "of the spin, at the race with less")
                .note(format!(
                    "nut {nut:.1} rad/s, screw {screw:.1} rad/s, skid number {:.4}",
                    number(o.solved().and_then(|solved| solved.skid?.skid_number))
                ))
        };
        let control = "raceway control: one race has no spin";
        checks.push(match (rpm, load) {
            (2000.0, 2113.0) => check("equal conformities share the spin").equals(
                0.5,
                0.1,
                "half each; raceway control has none at one race",
            ),
            (6000.0, 100.0) => check(control).at_most(0.1, "a light load: near nut control"),
            _ => check(control),
        });
    }
    Ok(checks)
}
