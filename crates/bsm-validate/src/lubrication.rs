//! Checks of lubricant friction. The results are compared with an independent solution, with
//! bearing formulas, and with published trends.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use bsm_case::{Case, OutputName, Record, ScrewTorque, output, torque_parts};
use bsm_dyn::{
    Model, ModelWorkspace, Status,
    lubrication::{BaseOil, Oil, OilState, ZERO_CELSIUS},
};
use serde::Deserialize;
use serde_json::Value;

use crate::published::File;
use crate::report::largest;
use crate::{Check, PublishedData, ValidateError};

const SOLUTION: &str = "independent solution of the lubricated models";
const BEARING: &str = "SKF model of bearing friction, size 7208, 40 deg";
const PALMGREN: &str = "Palmgren's formulas of bearing friction, size 7208, 40 deg";
const FILM: &str = "Nijenbanning, Venner and Moes 1994, film of wide elliptical contacts";
const ROLLING: &str =
    "Houpert; Balan, Houpert, Tufescu and Olaru 2015, power laws of the rolling force";
const TRENDS: &str = "published trends of lubricated ball screws";

/// Returns all checks of lubricant friction.
pub(crate) fn checks(published: &PublishedData) -> Result<Vec<Check>, ValidateError> {
    let references: References = published.lubrication.json()?;
    let work = &mut ModelWorkspace::default();
    let mut checks = Vec::new();
    for reference in &references.cases {
        checks.push(solution(reference, &published.lubrication, work)?);
    }
    let feed = reference_case(published, "feed-mixed")?;
    let bearing = reference_case(published, "thrust-bearing-limit")?;
    checks.extend(against_skf(&bearing, work)?);
    checks.push(against_palmgren(&bearing, work)?);
    checks.extend(film_and_rolling_force(&bearing, work)?);
    checks.push(drag_over_preload(&feed, work)?);
    checks.extend(trends(&feed, work)?);
    Ok(checks)
}

/// Returns the case with the given id from the published data on lubricated screws.
pub(crate) fn reference_case(published: &PublishedData, id: &str) -> Result<Case, ValidateError> {
    let file = &published.lubrication;
    let references: References = file.json()?;
    let reference = references.cases.iter().find(|one| one.id == id);
    reference.ok_or_else(|| ValidateError::of(file.name(), format!("no case `{id}`")))?.case(file)
}

#[derive(Deserialize)]
struct References {
    cases: Vec<Reference>,
}

/// A case, and the results of an independent solution of this case.
#[derive(Deserialize)]
struct Reference {
    id: String,
    model: String,
    case: Value,
    expect: BTreeMap<OutputName, f64>,
    rel_tol: f64,
}

impl Reference {
    fn case(&self, file: &File) -> Result<Case, ValidateError> {
        Case::from_json(self.case.to_string().as_bytes())
            .map_err(|error| ValidateError::of(file.name(), error))
    }
}

fn solve(case: &Case, model: Model, work: &mut ModelWorkspace) -> Result<Record, ValidateError> {
    Ok(Record::new(case.problem(&model.into())?.solve(work)))
}

/// Returns the value of an output, or NaN if the output is missing. NaN fails every check.
fn number(record: &Record, name: OutputName) -> f64 {
    let converged = record.status() == Status::Converged;
    record.number(name).filter(|_| converged).unwrap_or(f64::NAN)
}

/// Returns the value of an output. Torque, efficiency and power loss include the friction of the
/// seals.
fn with_seals(record: &Record, parts: Option<&ScrewTorque>, name: OutputName) -> f64 {
    let of_screw = |name: OutputName| parts.and_then(|parts| parts.number(name));
    match name.name() {
        "screw_torque_Nm" => of_screw(name),
        "efficiency" => of_screw(output!(screw_efficiency)),
        "dissipated_power_W" => Some(number(record, name) + number(record, output!(seal_power_W))),
        _ => None,
    }
    .unwrap_or_else(|| number(record, name))
}

/// Checks all outputs of a case. The checked number is the largest ratio of deviation to tolerance.
fn solution(
    reference: &Reference,
    file: &File,
    work: &mut ModelWorkspace,
) -> Result<Check, ValidateError> {
    let model = Model::from_name(&reference.model).ok_or_else(|| {
        ValidateError::of(file.name(), format!("unknown model {}", reference.model))
    })?;
    let case = reference.case(file)?;
    let record = solve(&case, model, work)?;
    let parts = torque_parts(&case, &model.into(), &mut ModelWorkspace::default())?;
    let (mut worst, mut at) = (0.0, "");
    for (name, value) in &reference.expect {
        // The equivalent thread friction coefficient is not compared for a screw with seals,
        // because it is calculated from the efficiency without seals.
        if number(&record, output!(seal_power_W)) > 0.0
            && *name == output!(catalog_friction_coefficient)
        {
            continue;
        }
        let is_spin = name.name().contains("spin");
        let tolerance = if is_spin { 1e-3 } else { reference.rel_tol };
        // At the controlling raceway, the spin is zero except for rounding errors, so an absolute
        // tolerance is added.
        let rounding = if is_spin { 1e-9 } else { 0.0 };
        let off = (with_seals(&record, parts.as_ref(), *name) - value).abs() - rounding;
        let part = if off <= 0.0 { 0.0 } else { off / (tolerance * value.abs()) };
        if part.is_nan() || part > worst {
            (worst, at) = (part, name.name());
        }
    }
    Ok(Check::new(
        &format!("lubrication/{}", reference.id),
        SOLUTION,
        format!("{}: all results", reference.id),
    )
    .measured(worst, "of the tolerance")
    .note(at)
    .at_most(1.0, "error of the independent solution, due to its quadrature nodes and creep speed"))
}

/// Returns the smallest value, the median and the largest value. All three are NaN if any value is
/// NaN or if there are no values.
fn min_median_max(mut numbers: Vec<f64>) -> [f64; 3] {
    if numbers.iter().any(|number| number.is_nan()) {
        return [f64::NAN; 3];
    }
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().saturating_sub(1);
    [0, last / 2, last].map(|i| numbers.get(i).copied().unwrap_or(f64::NAN))
}

/// Returns the rolling and the sliding frictional moment \[N m\] according to SKF's model for a
/// single-row angular contact bearing with a contact angle of 40 deg. Starvation and inlet shear
/// heating are not included.
///
/// * `diameter`: mean diameter of the bearing \[mm\].
/// * `viscosity`: kinematic viscosity of the oil \[mm²/s\].
/// * `speed`: rotational speed \[1/min\].
/// * `load`: axial load on the bearing \[N\].
fn skf(diameter: f64, viscosity: f64, speed: f64, load: f64) -> [f64; 2] {
    let rolling = 5.03e-7
        * diameter.powf(1.97)
        * (1.90e-12 * diameter.powi(4) * speed * speed + 1.97 * load).powf(0.54)
        * (viscosity * speed).powf(0.6);
    let pressed =
        (1.91e-12 * diameter.powi(4) * speed * speed).powf(4.0 / 3.0) + 0.68 * load.powf(4.0 / 3.0);
    let boundary = (-2.6e-8 * (viscosity * speed).powf(1.4) * diameter).exp();
    let sliding =
        1.30e-2 * diameter.powf(0.26) * pressed * (0.12 * boundary + 0.05 * (1.0 - boundary));
    [rolling * 1e-3, sliding * 1e-3]
}

/// A bearing at one operating point, and the solution at this point.
struct BearingPoint {
    /// Axial load on the bearing \[N\].
    load: f64,
    /// Rotational speed of the bearing \[1/min\].
    speed: f64,
    celsius: f64,
    record: Record,
}

impl BearingPoint {
    /// Returns the kinematic viscosity of the oil \[mm²/s\].
    fn viscosity(&self) -> f64 {
        let density = 880.0 * (1.0 - 6.5e-4 * (self.celsius - 15.0));
        number(&self.record, output!(viscosity_mPas)) * 1e3 / density
    }

    /// Returns the rolling and the sliding frictional moment of the bearing \[N·m\].
    fn moments(&self) -> [f64; 2] {
        let per_watt = 30.0 / (PI * self.speed);
        [output!(rolling_power_W), output!(sliding_power_W)]
            .map(|name| number(&self.record, name) * per_watt)
    }
}

/// Solves a bearing at all combinations of the given loads, speeds and temperatures. The bearing is
/// modeled as a screw with zero lead.
fn solve_bearing(
    bearing: &Case,
    (loads, speeds, temperatures): (&[f64], &[f64], &[f64]),
    work: &mut ModelWorkspace,
) -> Result<Vec<BearingPoint>, ValidateError> {
    let mut all = Vec::new();
    for &load in loads {
        for &speed in speeds {
            for &celsius in temperatures {
                let mut case = bearing.clone();
                case.set("axial_load_N", load)?;
                case.set("screw_speed_rpm", speed)?;
                case.set("lubricant_temperature_C", celsius)?;
                let record = solve(&case, Model::RacewayControl, work)?;
                all.push(BearingPoint { load, speed, celsius, record });
            }
        }
    }
    Ok(all)
}

/// Compares the friction of the bearing with SKF's model.
fn against_skf(bearing: &Case, work: &mut ModelWorkspace) -> Result<Vec<Check>, ValidateError> {
    let over = (
        &[2000.0, 4000.0, 8000.0][..],
        &[200.0, 500.0, 1000.0, 2000.0, 3000.0][..],
        &[40.0, 60.0, 80.0][..],
    );
    let (mut whole, mut rolling) = (Vec::new(), Vec::new());
    for at in solve_bearing(bearing, over, work)? {
        let (viscosity, moments) = (at.viscosity(), at.moments());
        if viscosity * at.speed > 1.1e5 {
            continue;
        }
        let [rolls, slides] = skf(60.0, viscosity, at.speed, at.load);
        whole.push((moments[0] + moments[1]) / (rolls + slides));
        rolling.push(moments[0] / rolls);
    }
    let points = whole.len();
    let check = |key: &str, what: &str, numbers: Vec<f64>| {
        let [least, middle, most] = min_median_max(numbers);
        Check::new(
            &format!("lubrication/{key}"),
            BEARING,
            format!("{what} divided by the value from SKF's model"),
        )
        .measured(middle, "")
        .note(format!(
            "median of the ratios at {points} points, which range from {least:.2} to {most:.2}; the constants of the model were quoted from memory"
        ))
        .equals(1.0, 0.36, "two friction models should agree to within a third")
    };
    Ok(vec![check("skf-torque", "torque", whole), check("skf-rolling", "rolling part", rolling)])
}

/// Returns the frictional moment \[N m\] according to Palmgren's formulas for the same bearing as
/// in [`skf`], under axial load in an oil bath.
///
/// * `diameter`: mean diameter of the bearing \[mm\].
/// * `viscosity`: kinematic viscosity of the oil \[mm²/s\].
/// * `speed`: rotational speed \[1/min\].
/// * `load`: axial load on the bearing \[N\].
///
/// Source: Harris and Kotzalas, *Essential Concepts of Bearing Technology*.
fn palmgren(diameter: f64, viscosity: f64, speed: f64, load: f64) -> f64 {
    // Static load rating of the angular contact bearing 7208 [N].
    const STATIC: f64 = 26_000.0;
    let viscous = 2.0 * 1e-7 * (viscosity * speed).powf(2.0 / 3.0) * diameter.powi(3);
    let turning = 0.9 / 40.0_f64.to_radians().tan() * load;
    let by_load = 0.0013 * (0.26 * load / STATIC).powf(0.33) * turning * diameter;
    (viscous + by_load) * 1e-3
}

/// Compares the friction of the bearing with Palmgren's formulas.
fn against_palmgren(bearing: &Case, work: &mut ModelWorkspace) -> Result<Check, ValidateError> {
    let over = (
        &[1000.0, 2000.0, 4000.0, 8000.0][..],
        &[300.0, 1000.0, 3000.0, 5000.0][..],
        &[40.0, 55.0, 70.0][..],
    );
    let ratio = |at: &BearingPoint| {
        let [rolls, slides] = at.moments();
        (rolls + slides) / palmgren(60.0, at.viscosity(), at.speed, at.load)
    };
    let ratios: Vec<_> = solve_bearing(bearing, over, work)?.iter().map(ratio).collect();
    let points = ratios.len();
    let [least, middle, most] = min_median_max(ratios);
    Ok(Check::new(
        "lubrication/palmgren",
        PALMGREN,
        "torque divided by the value from Palmgren's formulas",
    )
    .measured(middle, "")
    .note(format!("median of the ratios at {points} points, which range from {least:.2} to {most:.2}; the factors were quoted from memory"))
    .equals(1.0, 0.36, "two friction models should agree to within a third"))
}

/// Dimensionless data of the contact between a ball and the outer raceway of a bearing. The film
/// thickness and the rolling force in this contact are compared with other formulas.
struct OuterContact {
    /// Effective radius perpendicular to the rolling direction, divided by the effective radius in
    /// the rolling direction.
    across: f64,
    /// Long semi-axis of the contact ellipse divided by the short semi-axis.
    flatness: f64,
    /// Dimensionless normal load of the contact.
    weight: f64,
    /// Dimensionless speed parameter, based on the sum of the two surface speeds.
    rate: f64,
    /// Dimensionless pressure-viscosity coefficient `$\alpha E'$`.
    stiffening: f64,
    /// Central film thickness divided by the effective radius in the rolling direction. Inlet shear
    /// heating is not included.
    film: f64,
    /// Rolling force divided by `$E'R_x^2$`. Inlet shear heating is not included.
    rolling: f64,
}

impl OuterContact {
    /// * `oil`: properties of the oil at the oil temperature.
    /// * `(ball, pitch)`: ball radius and pitch circle radius \[m\]. The conformity is 0.52.
    fn of(record: &Record, oil: &OilState, conductivity: f64, (ball, pitch): (f64, f64)) -> Self {
        let value = |name: OutputName| number(record, name);
        let angle = value(output!(nut_contact_angle_deg)).to_radians();
        // 1/R_x = 1/r_b − cosβ/(r_m + r_b cosβ);  1/R_y = (1 − 1/(2f))/r_b
        let radius = ball * (1.0 + ball * angle.cos() / pitch);
        let across = ball / (1.0 - 1.0 / 1.04) / radius;
        // E' = E/(1 − ν²)
        let modulus = 207e9 / (1.0 - 0.09);
        let speed = value(output!(nut_entrainment_m_s));
        // The reduction factor φ_T for inlet shear heating is calculated according to Murch and
        // Wilson.
        let heat = oil.viscosity * oil.temperature_coefficient * speed * speed / conductivity;
        let heating = 1.0 / (1.0 + 0.254 * heat.powf(0.62));
        let unit = modulus * radius * radius;
        let rolling = value(output!(nut_rolling_moment_Nmm)) * 1e-3 / (2.0 * radius);
        Self {
            across,
            flatness: value(output!(nut_ellipse_a_mm)) / value(output!(nut_ellipse_b_mm)),
            weight: value(output!(nut_normal_load_N)) / unit,
            rate: 2.0 * oil.viscosity * speed / (modulus * radius),
            stiffening: oil.pressure_viscosity * modulus,
            film: value(output!(nut_film_um)) * 1e-6 / (radius * heating),
            rolling: rolling / (unit * heating),
        }
    }

    /// Returns the central film thickness divided by the effective radius, according to
    /// Nijenbanning, Venner and Moes. Their formula applies to rigid and elastic contacts, and to
    /// isoviscous and piezoviscous oil.
    fn nijenbanning(&self) -> f64 {
        let (theta, root) = (1.0 / self.across, self.rate.powf(0.25));
        let (m, l) = (self.weight / root.powi(3), self.stiffening * root);
        let shape = 1.0 + 0.006 * theta.ln() + 0.63 * theta.powf(4.0 / 7.0);
        let rigid =
            145.0 * (1.0 + 0.796 * theta.powf(14.0 / 15.0)).powf(-15.0 / 7.0) / (theta * m * m);
        let elastic =
            3.18 * shape.powf(-14.0 / 25.0) * theta.powf(-1.0 / 15.0) * m.powf(-2.0 / 15.0);
        let rigid_stiff = 1.29 * (1.0 + 0.691 * theta).powf(-2.0 / 3.0) * l.powf(2.0 / 3.0);
        let elastic_stiff = 1.48
            * shape.powf(-7.0 / 20.0)
            * theta.powf(-1.0 / 24.0)
            * m.powf(-1.0 / 12.0)
            * l.powf(0.75);
        let flooded = 1.8 / theta;
        let s = 1.5 * (1.0 + (-1.2 * elastic / elastic_stiff).exp());
        let thin = rigid.powf(1.5) + (elastic.powi(-4) + flooded.powi(-4)).powf(-3.0 / 8.0);
        let stiff = rigid_stiff.powi(-8) + elastic_stiff.powi(-8);
        (thin.powf(2.0 * s / 3.0) + stiff.powf(-s / 8.0)).powf(1.0 / s) * self.rate.sqrt()
    }

    /// Returns the rolling force divided by `$E'R_x^2$`, according to Houpert. The formula applies
    /// to rigid and elastic contacts.
    fn houpert(&self) -> f64 {
        let (k, rate) = (self.across, 0.5 * self.rate);
        let load = self.weight.cbrt();
        let rigid = 2.9766 * k.powf(0.3316) * load * rate.powf(0.6643);
        let elastic = 7.5826 * k.powf(0.4055) * load * rate.powf(0.75);
        let between = self.weight / (self.flatness * self.rate.powf(0.75));
        elastic + (rigid - elastic) / (1.0 + between / 6.6)
    }
}

/// Compares film thickness and rolling force at the balls of a bearing with other formulas.
fn film_and_rolling_force(
    bearing: &Case,
    work: &mut ModelWorkspace,
) -> Result<[Check; 2], ValidateError> {
    let base = BaseOil::Mineral;
    let viscosities = Oil::of_grade(68.0).unwrap_or([f64::NAN; 2]);
    let oil = Oil {
        base,
        viscosities,
        density: base.density(),
        pressure_viscosity: None,
        limiting_shear: base.limiting_shear(),
    };
    let (mut films, mut forces) = (Vec::new(), Vec::new());
    let mut flooded = bearing.clone();
    flooded.set("rolling_factor", 1.0)?;
    flooded.set("hysteresis_loss", 0.0)?;
    // These operating points have ball loads of 15 to 640 N and surface speeds of 0.05 to 4.7 m/s.
    let over = (
        &[140.0, 700.0, 2000.0, 6000.0][..],
        &[30.0, 100.0, 300.0, 1000.0, 3000.0][..],
        &[30.0, 70.0][..],
    );
    for BearingPoint { celsius, record, .. } in solve_bearing(&flooded, over, work)? {
        let warm = oil.at(celsius + ZERO_CELSIUS);
        let outer = OuterContact::of(&record, &warm, base.conductivity(), (5.95e-3, 30e-3));
        forces.push(outer.rolling / outer.houpert());
        // If weight/rate^(3/4) is below 40, the surfaces are practically rigid, and the film
        // formula of Hamrock and Dowson does not apply. For a point without a solution, this ratio
        // is NaN, so the point is included and fails the check.
        let is_rigid = outer.weight / outer.rate.powf(0.75) < 40.0;
        if !is_rigid {
            films.push(outer.film / outer.nijenbanning());
        }
    }
    let check = |key: &str, source: &str, what: &str, ratios: Vec<f64>| {
        let points = ratios.len();
        let [least, middle, most] = min_median_max(ratios);
        let worst = largest([1.0 - least, most - 1.0]);
        Check::new(&format!("lubrication/{key}"), source, what).measured(worst, "").note(format!(
            "ratios at {points} points: {least:.2} to {most:.2}, median {middle:.3}; the factors were quoted from memory"
        ))
    };
    let film = check(
        "film",
        FILM,
        "central film thickness divided by the value from another formula (ratio farthest from 1)",
        films,
    )
    .at_most(
        0.25,
        "both formulas are fits to solutions of the same equation, each accurate to 20 %",
    );
    let rolling = check(
        "rolling-force",
        ROLLING,
        "rolling force divided by the value from power laws (ratio farthest from 1)",
        forces,
    )
    .at_most(0.08, "power laws agree to within a tenth if the surfaces are nearly rigid");
    Ok([film, rolling])
}

/// Checks that the drag torque is nearly a linear function of the load.
fn drag_over_preload(feed: &Case, work: &mut ModelWorkspace) -> Result<Check, ValidateError> {
    let mut drags = Vec::new();
    for load in [500.0, 1000.0, 2000.0, 3000.0] {
        let mut case = feed.clone();
        case.set("axial_load_N", load)?;
        case.set("screw_speed_rpm", 100.0)?;
        let record = solve(&case, Model::RacewayControl, work)?;
        let lost =
            number(&record, output!(rolling_power_W)) + number(&record, output!(sliding_power_W));
        drags.push((load, lost * 30.0 / (PI * 100.0)));
    }
    let (low, high) = (drags[0], drags[drags.len() - 1]);
    let bent = drags.iter().map(|(load, torque)| {
        let straight = low.1 + (high.1 - low.1) * (load - low.0) / (high.0 - low.0);
        (torque / straight - 1.0).abs()
    });
    let claim = "drag torque is linear in the preload (Zhou 2016)";
    Ok(Check::new("lubrication/drag-over-preload", TRENDS, claim)
        .measured(largest(bent), "")
        .note("largest relative deviation from a straight line, 0.5 to 3 kN at 100 rpm")
        .at_most(0.05, "the deviations must be smaller than the scatter of measurements"))
}

/// Checks two published trends: the efficiency increases with the load, and the Stribeck curve has
/// a minimum.
fn trends(feed: &Case, work: &mut ModelWorkspace) -> Result<Vec<Check>, ValidateError> {
    let mut at = |load: f64, speed: f64, name: OutputName| -> Result<f64, ValidateError> {
        let mut case = feed.clone();
        case.set("axial_load_N", load)?;
        case.set("screw_speed_rpm", speed)?;
        Ok(number(&solve(&case, Model::RacewayControl, work)?, name))
    };
    let mut gains = Vec::new();
    for pair in [[1000.0, 2000.0], [2000.0, 4000.0], [4000.0, 8000.0]] {
        gains.push(
            at(pair[1], 1000.0, output!(efficiency))? - at(pair[0], 1000.0, output!(efficiency))?,
        );
    }
    let grows = Check::new(
        "lubrication/efficiency-over-load",
        TRENDS,
        "efficiency increases with the load at 1000 rpm (Zhou 2018)",
    )
    .measured(min_median_max(gains)[0], "")
    .note("smallest increase from 1 to 8 kN")
    .at_least(0.0, "the efficiency increases");
    let mut curve = Vec::new();
    for speed in [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 4000.0] {
        curve.push(at(3000.0, speed, output!(equivalent_friction_coefficient))?);
    }
    let [least, ..] = min_median_max(curve.clone());
    let lower_end = curve[0].min(curve[curve.len() - 1]);
    let stribeck = Check::new(
        "lubrication/stribeck-minimum",
        TRENDS,
        "friction has a minimum at some speed (Zhang 2021)",
    )
    .measured(lower_end / least, "")
    .note("friction coefficient at 10 or 4000 rpm, whichever is smaller, divided by the smallest friction coefficient, at 3 kN")
    .at_least(1.02, "the minimum must be at least 2 % lower than both ends of the curve");
    Ok(vec![grows, stribeck])
}
