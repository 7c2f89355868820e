//! Solved motion of a ball, and the data that all analyses of the ball motion share.

use super::record::message;
use crate::vocabulary::members::{Keyed, NumberTable, NumbersOf, Sentences, Word, answer, row};
use crate::vocabulary::units::DEG;
use crate::{
    Answer, Case, CaseError, InputKey, InputSet, Numbers, OutputName, Quantity, Record, Scope,
    Settings,
};
use bsm_dyn::{
    Control, Model, ModelWorkspace, Solution,
    solution::{ContactSite, SteadyBall},
};
use bsm_kin::Site;

/// Contacts of a ball, in the order in which the analyses list them.
const SITES: [Site; 3] = [Site::Nut, Site::Screw, Site::NutUnloaded];

row! {
    /// A true-or-false statement about the motion.
    pub(crate) struct MotionVerdict {
        [skip] statement: &'static str = "statement";
        /// True if the statement holds.
        answer: bool = "";
        /// The text of the statement, including its numbers.
        words: String = "";
    }
}

answer! {
    /// An analysis of a solved motion, with the results `T`.
    pub(crate) struct MotionMembers<T> {
        model: Word;
        [flatten] numbers: NumbersOf<T>;
        verdicts: Keyed<MotionVerdict>;
        /// Parts of the analysis that are omitted, with the reasons.
        lacks: Sentences;
    }
}

/// Creates the answer for an analysis of the ball motion.
///
/// * `verdicts`: names and wordings of the true-or-false statements.
/// * `lacks`: parts of the analysis that are omitted for a reason other than missing inputs.
pub(crate) fn motion_answer<T: NumberTable>(
    case: &Case,
    solution: &Solution,
    numbers: Numbers,
    verdicts: Vec<(OutputName, String)>,
    lacks: Vec<String>,
) -> Answer {
    let verdict = |(name, words): (OutputName, String)| {
        let holds = numbers.number(name).is_some_and(|number| number > 0.5);
        MotionVerdict { statement: name.name(), answer: holds, words }
    };
    let verdicts = Keyed(verdicts.into_iter().map(verdict).collect());
    let lacks = without(T::quantities(), case.given()).into_iter().chain(lacks).collect();
    let record = Record::new(solution.clone());
    let warnings = record.all_warnings(case);
    let notes = case.given().unused_by_models().chain(case.unused_cycle()).collect();
    Answer { notes, warnings, ..Answer::default() }.with_members(MotionMembers::<T> {
        model: Word("model ", solution.model.name().to_owned()),
        numbers: NumbersOf::new(numbers, "ball"),
        verdicts,
        lacks: Sentences("omitted", lacks),
    })
}

/// Explains that quantities are omitted because the model does not calculate contact ellipses.
pub(crate) fn lacks_ellipses(what: &str, model: Model) -> String {
    format!("{what}: needs a model with elastic contacts, but {} has none", model.name())
}

/// Lists the quantities that cannot be calculated, grouped by their missing inputs.
fn without(quantities: impl Iterator<Item = &'static Quantity>, given: InputSet) -> Vec<String> {
    let mut lacks: Vec<(String, Vec<&str>)> = Vec::new();
    for quantity in quantities.filter(|quantity| quantity.scope != Scope::Statement) {
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

/// A solution of a model, prepared for analyses of the ball motion.
#[derive(Debug, Clone)]
pub struct MotionAnswer {
    /// Model and settings of the solution.
    pub settings: Settings,
    /// Solution of the model.
    pub solution: Solution,
}

/// A contact of a moving ball, with its load and slip.
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

/// Motion and contact loads of a ball, extracted from a solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingBall {
    pub(crate) ball: SteadyBall<f64>,
    /// Contacts in the order of [`SITES`].
    pub(crate) contacts: [Option<MovingContact>; 3],
}

impl MovingBall {
    /// Returns a ball that rolls at the running contact angles of the case, with the contact
    /// ellipses of the solution, and `true`. If the case prescribes no running contact angles,
    /// returns the ball of the solution and `false`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::OutOfRange`] if running contact angles are given although the model
    /// calculates the contact angles.
    pub(crate) fn at_given_angles(
        mut self,
        case: &Case,
        settings: &Settings,
        model: Model,
    ) -> Result<(Self, bool), CaseError> {
        let Some(angles) = case.running_angles() else { return Ok((self, false)) };
        if model != Model::RacewayControl {
            let (key, value) = (InputKey::nut_running_contact_angle_deg, angles[0] / DEG);
            return Err(CaseError::not_covered(key, value, "omitted", model));
        }
        let SteadyBall { helix, radius, drive, .. } = self.ball;
        let control = settings.control.unwrap_or(Control::Nut);
        self.ball = SteadyBall::rolling(control, helix, radius, drive, angles);
        for (contact, angle) in self.contacts.iter_mut().flatten().zip(angles) {
            contact.touch.angle = angle;
        }
        Ok((self, true))
    }

    /// Extracts the motion and the contacts of the ball from a solution.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Invalid`] if the model does not calculate the motion of the ball or
    /// there is no solution.
    pub(crate) fn of(case: &Case, solution: &Solution) -> Result<Self, CaseError> {
        let state = match &solution.result {
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

    /// Returns the value of `number` for each of the three contacts.
    pub(crate) fn each(&self, number: impl Fn(&MovingContact) -> f64) -> [Option<f64>; 3] {
        self.contacts.map(|contact| contact.as_ref().map(&number))
    }
}

impl MotionAnswer {
    /// Solves the case with the model that `ModelChoice::for_motion` selects.
    ///
    /// # Errors
    /// Returns the same errors as [`Case::problem`].
    pub fn of(
        case: &Case,
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Self, CaseError> {
        let settings = Settings { model: settings.model.for_motion(case.stated()), ..*settings };
        let solution = case.problem(&settings)?.solve(work);
        Ok(Self { settings, solution })
    }
}

impl Case {
    /// Returns the running contact angles at nut and screw \[rad\], if they are given.
    pub fn running_angles(&self) -> Option<[f64; 2]> {
        let angles = [self.nut_running_contact_angle_deg?, self.screw_running_contact_angle_deg?];
        Some(angles.map(|angle| angle * DEG))
    }
}
