//! What the balls of an axis take: friction of each phase, and the nut under its largest load.

use bsm_design::{Efficiency, PhasePoint, viscosity_ratio_by_film};
use bsm_dyn::{ModelWorkspace, Status};

use crate::vocabulary::units::RPM;
use crate::{Case, CaseError, InputKey, NutProblem, NutReport, Record, Settings};

/// Friction of the contacts in a phase.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contacts {
    /// Torque on the screw \[N·m\], positive; `None` where the model has none.
    pub(super) friction: Option<f64>,
    /// The model, or why there is no torque.
    pub(super) text: String,
}

/// A case at another load and speed of its axis: with a load of zero only where the nut takes it. Screw and nut turn in
/// the ratio of the case.
///
/// * `speed`: of the screw against the nut \[rad/s\].
fn at(case: &Case, load: f64, speed: f64) -> Case {
    let turning = case.speeds_rpm().map(|(screw, nut)| nut / (screw - nut));
    let nut = turning.filter(|share| share.is_finite() && *share != 0.0);
    let nut = nut.map(|share| share * speed / RPM);
    let mut case = case.clone();
    (case.axial_load_N, case.feed_m_min) = (Some(load), None);
    case.screw_speed_rpm = Some(speed / RPM + nut.unwrap_or(0.0));
    case.nut_speed_rpm = nut;
    case
}

/// The nut of an axis under a load, with all its balls.
pub(super) fn nut_at(
    case: &Case,
    settings: &Settings,
    load: f64,
    speed: f64,
) -> Result<NutReport, CaseError> {
    // Seals have a line of their own.
    let case = Case { seal_torque_Nm: None, ..at(case, load, speed) };
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
    let problem = at(case, load.abs(), load.signum() * speed).problem(settings).ok()?;
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
    let problem = at(case, load.abs(), speed.abs()).problem(settings).ok()?;
    let film = problem.solve(work).solved()?.film?;
    Some(viscosity_ratio_by_film(film.nut.least_ratio.min(film.screw.least_ratio)))
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
    /// Driven by torque; driven back they are less by 0.1.
    const USUAL: [f64; 2] = [0.85, 0.95];
    USUAL.map(|forward| Efficiency { forward, back: forward - 0.1 }.friction(ideal, drives))
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
    if case.has_ratings_only() {
        let drives = load * speed < 0.0;
        let moves = f64::from(u8::from(*speed != 0.0));
        let friction = moves * by_catalogue(case).friction(advance * load, drives);
        return Ok(Contacts {
            friction: Some(friction),
            text: "by catalogue efficiency".to_owned(),
        });
    }
    if !case.given().has_friction() {
        let text = "no torque: neither friction_coefficient nor a lubricant is given".to_owned();
        return Ok(Contacts { friction: None, text });
    }
    if *speed == 0.0 {
        return Ok(Contacts { friction: Some(0.0), text: "at rest".to_owned() });
    }
    if case.is_preloaded() {
        let nut = nut_at(case, settings, *load, *speed)?;
        let friction = nut.number("friction_heat_W").map(|heat| heat / speed.abs());
        let text = match nut.model() {
            Some(model) => format!("{model}, all balls"),
            None => "all balls, on both flanks".to_owned(),
        };
        return Ok(Contacts { friction, text });
    }
    if *load == 0.0 {
        return Ok(Contacts { friction: Some(0.0), text: "no load".to_owned() });
    }
    // The model has the load positive, and the speed negative where the load drives.
    let case = at(case, load.abs(), load.signum() * speed);
    let record = Record::new(case.problem(settings)?.solve(work));
    let torque = record.number("ball_torque_Nm").filter(|_| record.status() == Status::Converged);
    let ideal = advance * load.abs();
    let text = match (torque, record.message()) {
        (None, Some(why)) => format!("no torque: {why}"),
        _ => record.model().name().to_owned(),
    };
    Ok(Contacts { friction: torque.map(|torque| (torque - ideal).abs()), text })
}
