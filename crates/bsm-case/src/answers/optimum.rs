//! Optimum contact angles and self-locking limits. The results are named quantities with units.

use std::cell::RefCell;

use crate::case::problem::Needs;
use crate::case::requirement::USUAL_CONTACT_ANGLES_DEG;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::members::{Maybe, NumbersOf, Word, answer, number_tables};
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::DEG;
use crate::{Answer, Case, CaseError, Numbers, Scope, Settings};
use bsm_design::Range;
use bsm_design::search::{Minimum, minimum_inside};
use bsm_dyn::{
    Direction, Model, ModelWorkspace,
    angles::{Angles, Optimum},
};

number_tables! {
    /// Optima and self-locking limits in closed form.
    pub(crate) OptimumNumbers = QUANTITIES.iter();
    /// Optimum contact angle that a model predicts.
    pub(crate) ModelOptimum = BY_MODEL.iter();
}

answer! {
    /// Optimum angles in closed form, and the optimum contact angle that a model predicts.
    pub(crate) struct OptimumMembers {
        [flatten] numbers: NumbersOf<OptimumNumbers>;
        /// Model for which the optimum was found.
        [skip_serializing_if = "Maybe::is_none"] model: Maybe<Word>;
        [skip_serializing_if = "Maybe::is_none"] by_model: Maybe<NumbersOf<ModelOptimum>>;
    }
}

quantities! { pub(crate) QUANTITIES, read(&AnglesAndFriction) of Optimum;
    "closed form" {
        optimum_contact_angle_deg ["deg"] Directions(|k| k.best.map(|best| Some(best?.contact_angle / DEG)))
            needs [lead_angle_deg | lead_mm], "contact angle with the best efficiency";
        optimum_lead_angle_deg ["deg"] Directions(|k| k.best_leads.map(|lead| Some(lead? / DEG))) needs [contact_angle_deg],
            "lead angle for which the given contact angle is optimal";
        optimum_efficiency [""] Directions(AnglesAndFriction::best_efficiency), "efficiency at the optimum angle";
        self_locking_contact_angle_deg ["deg"] Directions(|k| {
            DIRECTIONS.map(|d| Some(Angles::locking_contact_angle(d, k.lead?, k.friction)? / DEG))
        }) needs [lead_angle_deg | lead_mm],
            "self-locking limit of the contact angle: upper limit (rotary to linear), lower limit (linear to rotary)";
        self_locking_lead_angle_deg ["deg"] Directions(|k| {
            DIRECTIONS.map(|d| Some(Angles::locking_lead_angle(d, k.contact?, k.friction)? / DEG))
        }) needs [contact_angle_deg],
            "self-locking limit of the lead angle: lower limit (rotary to linear), upper limit (linear to rotary)";
        efficiency [""] Directions(|k| {
            let own = k.lead.zip(k.contact).map(|(lead, contact)| Angles { lead, contact });
            DIRECTIONS.map(|d| Some(own?.efficiency(d, k.friction)))
        }) needs [contact_angle_deg, lead_angle_deg | lead_mm], "efficiency at the contact angle of the case";
    }
}

quantities! { pub(crate) BY_MODEL, by_model(&Option<Optimum>);
    "by the model" {
        optimum_contact_angle_deg ["deg"] Scalar(|best| Some(best.as_ref()?.contact_angle / DEG)),
            "contact angle with the best efficiency";
        optimum_efficiency [""] Scalar(|best| Some(best.as_ref()?.efficiency)), "efficiency at this contact angle";
    }
}

/// Inputs that are always required. A lead angle or a contact angle is required in addition.
pub(crate) const NEEDS: Needs = Needs { all: inputs! { friction_coefficient }, quantities: &[] };

/// The given angles and friction coefficient, together with the optimum angles for both directions
/// of drive.
struct AnglesAndFriction {
    lead: Option<f64>,
    contact: Option<f64>,
    friction: f64,
    /// Optimum contact angles, if a lead angle is given.
    best: [Option<Optimum>; 2],
    /// Optimum lead angles, if a contact angle is given.
    best_leads: [Option<f64>; 2],
}

/// Range of contact angles that is searched for the optimum of a model \[deg\].
const SEARCHED_DEG: Range = Range { low: 5.0, high: 85.0 };

const DIRECTIONS: [Direction; 2] = [Direction::RotaryToLinear, Direction::LinearToRotary];

impl AnglesAndFriction {
    fn of(case: &Case) -> Result<Self, CaseError> {
        let (lead, contact) = (case.lead_angle(), case.contact_angle_deg.map(|deg| deg * DEG));
        let mut missing = NEEDS.missing(case.given());
        if lead.or(contact).is_none() {
            let words =
                "lead_angle_deg (or lead_mm with pitch_circle_diameter_mm) or contact_angle_deg";
            missing.push(words.to_owned());
        }
        let Some(friction) = case.friction_coefficient.filter(|_| missing.is_empty()) else {
            return Err(CaseError::missing(&missing, "by model closed-form"));
        };
        Ok(Self {
            lead,
            contact,
            friction,
            best: DIRECTIONS.map(|d| Optimum::of(d, lead?, friction)),
            best_leads: DIRECTIONS.map(|d| Optimum::lead_angle(d, contact?, friction)),
        })
    }

    /// Returns the best efficiency at the given lead angle or, without a lead angle, at the given
    /// contact angle.
    fn best_efficiency(&self) -> [Option<f64>; 2] {
        let best = Optimum::best_efficiency(self.friction);
        match self.lead {
            Some(_) => self.best.map(|best| best.map(|best| best.efficiency)),
            None => self.best_leads.map(|lead| lead.map(|_| best)),
        }
    }

    /// Returns warnings about optimum angles that do not exist or that are difficult to
    /// manufacture.
    fn warnings(&self) -> Vec<String> {
        let of_direction = |(best, name): (Option<Optimum>, &str)| match best {
            None => Some(format!(
                "{name}: no contact angle reaches the best efficiency of {:.4}, because the lead angle is too large.",
                Optimum::best_efficiency(self.friction)
            )),
            Some(best) => hard_to_make(name, Some(best.contact_angle / DEG)),
        };
        let bests = self.best.into_iter().zip(["rotary to linear", "linear to rotary"]);
        bests.filter(|_| self.lead.is_some()).filter_map(of_direction).collect()
    }
}

/// Calculates the results that have closed-form solutions.
pub(crate) fn numbers(case: &Case) -> Result<Numbers, CaseError> {
    case.check()?;
    read(&AnglesAndFriction::of(case)?, |_| true).finite()
}

/// Calculates the optimum angles and self-locking limits for both directions of drive in closed
/// form, from the friction coefficient and the lead angle or contact angle. If `model` is given,
/// the function also finds the optimum contact angle of this model in the direction of the given
/// speeds.
///
/// # Errors
///
/// Returns [`CaseError`] if an input is missing or violates its rule.
pub fn optimum(case: &Case, model: Option<Model>) -> Result<Answer, CaseError> {
    case.check()?;
    let found = model.map(|model| Ok((model, best_by(case, model)?))).transpose()?;
    let numbers = NumbersOf::new(numbers(case)?, "");
    let by_model = found.as_ref().map(|(_, (direction, best))| {
        let whole = Scope::Directions.members()[usize::from(direction.is_back())];
        NumbersOf::new(by_model(best, |_| true), whole)
    });
    let model = found.as_ref().map(|(model, _)| Word("model ", model.name().to_owned()));
    let members = OptimumMembers { numbers, model: Maybe(model), by_model: Maybe(by_model) };
    let mut answer = Answer::default().with_members(members);
    if let Some((model, (_, best))) = found {
        let (model, Range { low, high }) = (model.name(), SEARCHED_DEG);
        if best.is_none() {
            answer.warnings.push(format!(
                "Model {model} has no optimum contact angle between {low} and {high} deg; the efficiency is largest at \
                 an end of this range."
            ));
        }
    }
    answer.warnings.extend(AnglesAndFriction::of(case)?.warnings());
    Ok(answer)
}

/// Finds the contact angle at which the loss that a model predicts is smallest, for the direction
/// of the given speeds. The result is `None` if the model has no solution at any angle, or if the
/// smallest loss is at an end of the range.
fn best_by(case: &Case, model: Model) -> Result<(Direction, Option<Optimum>), CaseError> {
    let settings = Settings::from(model);
    let speeds = case.speeds_rpm().map_or(1.0, |(screw, nut)| screw - nut);
    let direction = Direction::of(speeds).unwrap_or(Direction::RotaryToLinear);
    let work = RefCell::new(ModelWorkspace::default());
    let loss = |deg: f64| -> Result<f64, CaseError> {
        let case = Case { contact_angle_deg: Some(deg), ..case.clone() };
        let solution = case.problem(&settings)?.solve(&mut work.borrow_mut());
        Ok(solution.efficiency().map_or(f64::NAN, |eta| 1.0 - eta))
    };
    // At standstill, the efficiency is 0 at every angle, so there is no optimum.
    let best = minimum_inside(loss, SEARCHED_DEG)?.filter(|best| best.value < 1.0);
    let optimum =
        |best: Minimum| Optimum { contact_angle: best.at * DEG, efficiency: 1.0 - best.value };
    Ok((direction, best.map(optimum)))
}

/// Returns a warning if the optimum contact angle for a motion is difficult to manufacture.
pub(crate) fn hard_to_make(motion: &str, best_deg: Option<f64>) -> Option<String> {
    let Range { low, high } = USUAL_CONTACT_ANGLES_DEG;
    // An angle at a limit of the recommended range may exceed the limit by a rounding error.
    let deg = best_deg.filter(|deg| !(low - 1e-6..=high + 1e-6).contains(deg))?;
    Some(format!(
        "{motion}: a contact angle of {deg:.1} deg is difficult to manufacture; {low:.0} to {high:.0} deg are typical."
    ))
}
