//! A solution whose motion is analyzed, and the data that all such analyses share.

use bsm_dyn::{ContactSite, Control, Model, ModelWorkspace, Solution, SteadyBall};
use bsm_kin::Site;
use serde_json::json;

use super::record::message;
use crate::vocabulary::units::DEG;
use crate::{
    Answer, Case, CaseError, Content, InputKey, InputSet, Numbers, Quantity, Record, Scope,
    Settings, Table,
};

/// The contacts of a ball.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutUnloaded];

/// Columns of statements about the motion.
pub(crate) const VERDICTS: &str = "=statement | answer:boolean= | words:string=";

/// Result of an analysis of a solved motion.
///
/// * `quantities`: those of its table. * `verdicts`: names of its statements, as text. * `lacks`: parts that are left out besides those that lack inputs.
pub(crate) fn of_a_motion(
    quantities: &[Quantity],
    case: &Case,
    solution: &Solution,
    numbers: Numbers,
    verdicts: Vec<(&'static str, String)>,
    lacks: Vec<String>,
) -> Answer {
    let verdict = |(name, words): (&'static str, String)| {
        let holds = numbers.number(name).is_some_and(|number| number > 0.5);
        vec![json!(name), json!(holds), json!(words)]
    };
    let verdicts = Table::of(VERDICTS, verdicts.into_iter().map(verdict)).keyed();
    let lacks = without(quantities, case.given()).into_iter().chain(lacks).collect();
    let record = Record::new(solution.clone());
    let warnings = record.all_warnings(case);
    let notes = case.given().unused_by_models().collect();
    Answer { notes, warnings, ..Answer::default() }
        .with("model", Content::Text("model ", Some(solution.model.name().to_owned())))
        .with("", Content::numbers(numbers, "ball"))
        .with("verdicts", Content::Table(verdicts))
        .with("lacks", Content::Texts("left out", lacks))
}

/// Quantities omitted without contact ellipses.
pub(crate) fn lacks_ellipses(what: &str, model: Model) -> String {
    format!("{what}: a model with elastic contacts, which {} is not", model.name())
}

/// The quantities that lack inputs of their own, together with those that lack the same.
fn without(quantities: &[Quantity], given: InputSet) -> Vec<String> {
    let mut lacks: Vec<(String, Vec<&str>)> = Vec::new();
    for quantity in quantities.iter().filter(|quantity| quantity.scope != Scope::Statement) {
        let missing = quantity.missing(given);
        if missing.is_empty() {
            continue;
        }
        let missing = missing.join(" and ");
        match lacks.iter_mut().find(|(known, _)| *known == missing) {
            Some((_, abouts)) => abouts.push(quantity.about),
            None => lacks.push((missing, vec![quantity.about])),
        }
    }
    let words =
        |(missing, abouts): (String, Vec<&str>)| format!("{}: {missing}", abouts.join(", "));
    lacks.into_iter().map(words).collect()
}

/// A solution for an analysis of the motion of the ball.
#[derive(Debug, Clone)]
pub struct MotionAnswer {
    /// Model and settings of the result.
    pub settings: Settings,
    /// The solution.
    pub solution: Solution,
}

/// A contact of a ball in motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingContact {
    pub(crate) touch: ContactSite<f64>,
    /// Normal load \[N\].
    pub(crate) load: f64,
    /// Slip angle \[rad\].
    pub(crate) slip_angle: f64,
    /// Semi-axes of the contact ellipse \[m\], if the model has them.
    pub(crate) semi_axes: Option<(f64, f64)>,
}

/// Solution of a model that the analyses read: a ball of known motion and loads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingBall {
    pub(crate) ball: SteadyBall<f64>,
    /// At [`SITES`].
    pub(crate) contacts: [Option<MovingContact>; 3],
}

impl MovingBall {
    /// The ball that rolls at the contact angles in motion that the case gives, if it does, with the
    /// contact ellipses of the solution; and whether it is that one.
    ///
    /// # Errors
    ///
    /// [`CaseError::OutOfRange`] if the model finds the angles itself.
    pub(crate) fn at_given_angles(
        mut self,
        case: &Case,
        settings: &Settings,
        model: Model,
    ) -> Result<(Self, bool), CaseError> {
        let Some(angles) = case.running_angles() else { return Ok((self, false)) };
        if model != Model::RacewayControl {
            let (key, value) = (InputKey::nut_running_contact_angle_deg, angles[0] / DEG);
            return Err(CaseError::not_covered(key, value, "left out", model));
        }
        let SteadyBall { helix, radius, drive, .. } = self.ball;
        let control = settings.control.unwrap_or(Control::Nut);
        self.ball = SteadyBall::rolling(control, helix, radius, drive, angles);
        for (contact, angle) in self.contacts.iter_mut().flatten().zip(angles) {
            contact.touch.angle = angle;
        }
        Ok((self, true))
    }

    /// Motion and contacts of a solution.
    ///
    /// # Errors
    ///
    /// [`CaseError::Invalid`] if the model has none or there is no solution.
    pub(crate) fn of(case: &Case, solution: &Solution) -> Result<Self, CaseError> {
        let state = match &solution.answer {
            Ok(solved) => &solved.ball,
            Err(none) => return Err(CaseError::Invalid(message(none.reason()))),
        };
        let motion = state
            .motion
            .ok_or_else(|| CaseError::no_motion(solution.model, &case.missing(Model::Rigid)))?;
        let point = case.reader().operating_point();
        let ball = SteadyBall {
            helix: point.helix,
            radius: point.ball.radius,
            drive: point.drive,
            motion,
        };
        let contacts = SITES.map(|site| {
            let contact = state.contact(site)?;
            Some(MovingContact {
                touch: ContactSite { site, angle: contact.angle },
                load: contact.load?,
                slip_angle: contact.slip_angle?,
                semi_axes: contact.pressed.map(|pressed| pressed.semi_axes),
            })
        });
        Ok(Self { ball, contacts })
    }

    /// A number of each contact.
    pub(crate) fn each(&self, number: impl Fn(&MovingContact) -> f64) -> [Option<f64>; 3] {
        self.contacts.map(|contact| contact.as_ref().map(&number))
    }
}

impl MotionAnswer {
    /// The solution of the model that the settings come to, see `ModelChoice::of_motion`.
    ///
    /// # Errors
    ///
    /// As [`Case::problem`].
    pub fn of(
        case: &Case,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let settings = Settings { model: settings.model.of_motion(case.stated()), ..*settings };
        let solution = case.problem(&settings)?.solve(work);
        Ok(Self { settings, solution })
    }
}

impl Case {
    /// Contact angles of nut and screw in motion, if they are given \[rad\].
    pub fn running_angles(&self) -> Option<[f64; 2]> {
        let angles = [self.nut_running_contact_angle_deg?, self.screw_running_contact_angle_deg?];
        Some(angles.map(|angle| angle * DEG))
    }
}
