//! Friction of the balls in each phase of the duty cycle, and the nut under its largest load.

use bsm_design::Efficiency;
use bsm_design::life::viscosity_ratio_by_film;
use bsm_design::motion::PhasePoint;
use bsm_dyn::{ModelWorkspace, Status};

use crate::case::catalog_line::USUAL_EFFICIENCIES;
use crate::{Case, CaseError, InputKey, NutProblem, NutReport, Record, Settings, output};

/// Friction of the ball contacts in a phase of the cycle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contacts {
    /// Friction torque at the screw \[N·m\], positive; `None` if the model has no solution.
    pub(super) friction: Option<f64>,
    /// Friction torques of the nut contacts and of the screw contacts \[N·m\]. The two torques are
    /// equal if the model does not distinguish between the contacts, and 0 if there is no friction
    /// torque.
    pub(super) at_raceways: [f64; 2],
    /// Friction torque of the third contacts, which are on the far flanks \[N·m\]; `None` if the
    /// balls have only two contacts.
    pub(super) third: Option<f64>,
    /// Name of the model that was used, or the reason why there is no torque.
    pub(super) text: String,
}

impl Contacts {
    /// Creates a result in which the nut contacts and the screw contacts each account for half of
    /// the friction torque.
    fn halved(friction: f64, text: impl Into<String>) -> Self {
        let at_raceways = [0.5 * friction; 2];
        Self { friction: Some(friction), at_raceways, third: None, text: text.into() }
    }

    /// Creates a result without a friction torque. `text` states the reason.
    pub(super) fn none(text: String) -> Self {
        Self { friction: None, at_raceways: [0.0; 2], third: None, text }
    }
}

/// Solves the nut of an axis, including the loads of all balls, under a given axial load.
pub(super) fn nut_at(
    case: &Case,
    settings: &Settings,
    load: f64,
    speed: f64,
) -> Result<NutReport, CaseError> {
    // The seal torque is omitted here, because the axis sheet adds it separately.
    let case = Case { seal_torque_Nm: None, ..case.at_point(load, speed) };
    NutProblem::of(&case, settings)?.solve().map_err(CaseError::Nut)
}

/// Returns the 90 % interval of the lubricated contact friction due to uncertain inputs, as a ratio
/// to the calculated friction.
pub(super) fn band(
    case: &Case,
    settings: &Settings,
    PhasePoint { load, friction_speed: speed, .. }: &PhasePoint,
    work: &mut ModelWorkspace,
) -> Option<[f64; 2]> {
    let problem = case.at_point(load.abs(), load.signum() * speed).problem(settings).ok()?;
    let solution = problem.solve(work);
    Some(problem.loss_interval(solution.steady_state()?, work)?.loss)
}

/// Returns the viscosity ratio for the lubricant film at the nut or at the screw, whichever is
/// thinner. Returns `None` if the groove, the lubricant or the roughness is unknown, or if the ball
/// model has no solution.
///
/// * `load`: axial load of one nut \[N\].
/// * `speed`: speed of the screw relative to the nut \[rad/s\].
pub(super) fn viscosity_ratio(
    case: &Case,
    settings: &Settings,
    (load, speed): (f64, f64),
    work: &mut ModelWorkspace,
) -> Option<f64> {
    let problem = case.at_point(load.abs(), speed.abs()).problem(settings).ok()?;
    let film = problem.solve(work).steady_state()?.film?;
    Some(viscosity_ratio_by_film(film.nut.min_ratio.min(film.screw.min_ratio)))
}

/// Returns true if friction is calculated from the catalog efficiency. This is the case if the
/// groove is estimated and no friction input is given. It is also the case if the groove is
/// incomplete, and either catalog ratings are given or inputs of the ball model are missing.
pub(super) fn takes_catalog_efficiency(case: &Case, settings: &Settings) -> bool {
    if case.has_estimated_groove() {
        return !case.given().has_friction();
    }
    let has_ratings = case.rated_dynamic_load_N.or(case.rated_static_load_N).is_some();
    case.lacks_groove() && (has_ratings || case.at_point(1.0, 1.0).choose(settings.model).is_err())
}

/// Returns the catalog efficiencies of a screw whose groove is not known.
pub(super) fn by_catalog(case: &Case) -> Efficiency {
    Efficiency {
        forward: case.number(InputKey::catalog_efficiency),
        back: case.number(InputKey::catalog_back_efficiency),
    }
}

/// Returns the largest and the smallest contact friction torque for the typical range of catalog
/// efficiencies \[N·m\].
///
/// * `ideal`: load torque without friction \[N·m\].
/// * `drives`: true if the load back-drives the screw.
pub(super) fn usual_frictions(ideal: f64, drives: bool) -> [f64; 2] {
    let (usual, driven_less) = USUAL_EFFICIENCIES;
    usual.map(|forward| Efficiency { forward, back: forward - driven_less }.friction(ideal, drives))
}

/// Calculates the contact friction at a load and a speed. The friction follows from the catalog
/// efficiency if the groove is unknown, from all balls if the nut is preloaded, and otherwise from
/// one ball that carries an equal share of the load.
///
/// * `advance`: travel per radian of screw rotation \[m\].
pub(super) fn contacts(
    case: &Case,
    settings: &Settings,
    advance: f64,
    PhasePoint { load, friction_speed: speed, .. }: &PhasePoint,
    work: &mut ModelWorkspace,
) -> Result<Contacts, CaseError> {
    if takes_catalog_efficiency(case, settings) {
        let drives = load * speed < 0.0;
        let moves = f64::from(u8::from(*speed != 0.0));
        let friction = moves * by_catalog(case).friction(advance * load, drives);
        return Ok(Contacts::halved(friction, "catalog efficiency"));
    }
    if !case.given().has_friction() {
        let text = "no torque: neither friction_coefficient nor a lubricant is given".to_owned();
        return Ok(Contacts::none(text));
    }
    if *speed == 0.0 {
        return Ok(Contacts::halved(0.0, "at rest"));
    }
    if case.is_preloaded() {
        let nut = nut_at(case, settings, *load, *speed)?;
        let friction = nut.number(output!(friction_heat_W)).map(|heat| heat / speed.abs());
        let text = match nut.model() {
            Some(model) => format!("{model}, all balls"),
            None => "all balls, on both flanks".to_owned(),
        };
        let at_raceways = nut.raceway_torques().or(friction.map(|torque| [0.5 * torque; 2]));
        let at_raceways = at_raceways.unwrap_or_default();
        let third = nut.third_contact_torque().filter(|torque| *torque > 0.0);
        return Ok(Contacts { friction, at_raceways, third, text });
    }
    if *load == 0.0 {
        return Ok(Contacts::halved(0.0, "no load"));
    }
    // The model expects a positive load. The speed is negative if the load back-drives the screw.
    let case = case.at_point(load.abs(), load.signum() * speed);
    let solution = case.problem(settings)?.solve(work);
    let powers = solution.steady_state().and_then(|solved| {
        let dissipated = solved.transmission.power.as_ref()?.dissipated;
        let at_raceways = solved.contact_power?;
        (dissipated > 0.0).then(|| at_raceways.map(|power| power / dissipated))
    });
    let far_flank = solution.steady_state().and_then(|solved| solved.far_flank);
    let third_share = far_flank.and_then(|far| Some(far.contact?.power_share));
    let record = Record::new(solution);
    let torque =
        record.number(output!(ball_torque_Nm)).filter(|_| record.status() == Status::Converged);
    let ideal = advance * load.abs();
    let text = match (torque, record.message()) {
        (None, Some(why)) => format!("no torque: {why}"),
        _ => record.model().name().to_owned(),
    };
    let Some(torque) = torque else { return Ok(Contacts::none(text)) };
    let friction = (torque - ideal).abs();
    let at_raceways = powers.unwrap_or([0.5; 2]).map(|share| share * friction);
    let third = third_share.map(|share| share * friction);
    Ok(Contacts { friction: Some(friction), at_raceways, third, text })
}
