//! Friction of the balls of an axis in each phase, and the nut under its largest load.

use bsm_design::{Efficiency, PhasePoint, viscosity_ratio_by_film};
use bsm_dyn::{ModelWorkspace, Status};

use crate::case::catalog_line::USUAL_EFFICIENCIES;
use crate::{Case, CaseError, InputKey, NutProblem, NutReport, Record, Settings};

/// Friction of the contacts in a phase.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contacts {
    /// Torque on the screw \[N·m\], positive; `None` where the model has none.
    pub(super) friction: Option<f64>,
    /// Its parts at the contacts with nut and screw \[N·m\]: halves where the model does not tell them apart, 0 without a torque.
    pub(super) at_raceways: [f64; 2],
    /// The model, or why there is no torque.
    pub(super) text: String,
}

impl Contacts {
    /// Returns a friction of which nut and screw have half each.
    fn halved(friction: f64, text: impl Into<String>) -> Self {
        Self { friction: Some(friction), at_raceways: [0.5 * friction; 2], text: text.into() }
    }

    /// Returns the reason for no torque.
    fn none(text: String) -> Self {
        Self { friction: None, at_raceways: [0.0; 2], text }
    }
}

/// The nut of an axis under a load, with all its balls.
pub(super) fn nut_at(
    case: &Case,
    settings: &Settings,
    load: f64,
    speed: f64,
) -> Result<NutReport, CaseError> {
    // Seals have a line of their own.
    let case = Case { seal_torque_Nm: None, ..case.at_point(load, speed) };
    NutProblem::of(&case, settings)?.solve().map_err(CaseError::Nut)
}

/// 90 % interval of lubricated friction over uncertain inputs, relative to the
/// stated friction of the contacts.
pub(super) fn band(
    case: &Case,
    settings: &Settings,
    PhasePoint { load, friction_speed: speed, .. }: &PhasePoint,
    work: &mut ModelWorkspace,
) -> Option<[f64; 2]> {
    let problem = case.at_point(load.abs(), load.signum() * speed).problem(settings).ok()?;
    let solution = problem.solve(work);
    Some(problem.band(solution.solved()?, work)?.loss)
}

/// Viscosity ratio by the least film of nut and screw; `None` unless groove, oil and roughness are known and the ball has a
/// solution.
///
/// * `load`: of a nut \[N\]. * `speed`: of the screw against the nut \[rad/s\].
pub(super) fn viscosity_ratio(
    case: &Case,
    settings: &Settings,
    (load, speed): (f64, f64),
    work: &mut ModelWorkspace,
) -> Option<f64> {
    let problem = case.at_point(load.abs(), speed.abs()).problem(settings).ok()?;
    let film = problem.solve(work).solved()?.film?;
    Some(viscosity_ratio_by_film(film.nut.least_ratio.min(film.screw.least_ratio)))
}

/// Returns true if friction follows from the efficiency of a catalog: the groove is estimated and friction is not given; or the groove
/// is not given in full, and either ratings of a catalog are given or the model of a ball lacks inputs.
pub(super) fn takes_catalogue_efficiency(case: &Case, settings: &Settings) -> bool {
    if case.has_estimated_groove() {
        return !case.given().has_friction();
    }
    let has_ratings = case.rated_dynamic_load_N.or(case.rated_static_load_N).is_some();
    case.lacks_groove() && (has_ratings || case.at_point(1.0, 1.0).choose(settings.model).is_err())
}

/// Efficiencies of the catalogue of a screw whose groove is not known.
pub(super) fn by_catalogue(case: &Case) -> Efficiency {
    Efficiency {
        forward: case.number(InputKey::catalogue_efficiency),
        back: case.number(InputKey::catalogue_back_efficiency),
    }
}

/// Largest and least friction of contacts by the usual efficiencies of catalogues \[N·m\].
///
/// * `ideal`: torque of the load without friction \[N·m\]. * `drives`: whether the load drives the screw.
pub(super) fn usual_frictions(ideal: f64, drives: bool) -> [f64; 2] {
    let (usual, driven_less) = USUAL_EFFICIENCIES;
    usual.map(|forward| Efficiency { forward, back: forward - driven_less }.friction(ideal, drives))
}

/// Friction of the contacts under a load at a speed: by the catalogue's efficiency where the groove is not known, by all balls of a preloaded nut, else by one ball under
/// its equal share.
///
/// * `advance`: for a radian of the screw \[m\].
pub(super) fn contacts(
    case: &Case,
    settings: &Settings,
    advance: f64,
    PhasePoint { load, friction_speed: speed, .. }: &PhasePoint,
    work: &mut ModelWorkspace,
) -> Result<Contacts, CaseError> {
    if takes_catalogue_efficiency(case, settings) {
        let drives = load * speed < 0.0;
        let moves = f64::from(u8::from(*speed != 0.0));
        let friction = moves * by_catalogue(case).friction(advance * load, drives);
        return Ok(Contacts::halved(friction, "by catalogue efficiency"));
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
        let friction = nut.number("friction_heat_W").map(|heat| heat / speed.abs());
        let text = match nut.model() {
            Some(model) => format!("{model}, all balls"),
            None => "all balls, on both flanks".to_owned(),
        };
        let at_raceways = nut.raceway_torques().or(friction.map(|torque| [0.5 * torque; 2]));
        return Ok(Contacts { friction, at_raceways: at_raceways.unwrap_or_default(), text });
    }
    if *load == 0.0 {
        return Ok(Contacts::halved(0.0, "no load"));
    }
    // The model has the load positive, and the speed negative where the load drives.
    let case = case.at_point(load.abs(), load.signum() * speed);
    let solution = case.problem(settings)?.solve(work);
    let powers = solution.solved().and_then(|solved| {
        let dissipated = solved.transmission.power.as_ref()?.dissipated;
        let at_raceways = solved.contact_power?;
        (dissipated > 0.0).then(|| at_raceways.map(|power| power / dissipated))
    });
    let record = Record::new(solution);
    let torque = record.number("ball_torque_Nm").filter(|_| record.status() == Status::Converged);
    let ideal = advance * load.abs();
    let text = match (torque, record.message()) {
        (None, Some(why)) => format!("no torque: {why}"),
        _ => record.model().name().to_owned(),
    };
    let Some(torque) = torque else { return Ok(Contacts::none(text)) };
    let friction = (torque - ideal).abs();
    let at_raceways = powers.unwrap_or([0.5; 2]).map(|share| share * friction);
    Ok(Contacts { friction: Some(friction), at_raceways, text })
}
