//! Cases that contain only catalog data: nominal diameter, lead and load ratings. The groove is
//! estimated before a problem is built, so every command can use such a case.

use bsm_design::groove::{
    CatalogLine, CatalogMistake, EstimatedGroove, GrooveEstimate, RejectedRow,
    quasi_random_besides_groove,
};
use bsm_design::turn_length;
use bsm_dyn::Conformities;

use crate::case::axis_inputs::rated_dynamic_load;
use crate::case::nut::NutTurns;
use crate::case::rated_nut;
use crate::vocabulary::entries::InputName;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::number::{decimal, format_digits, format_trimmed};
use crate::vocabulary::units::{DEG, MM};
use crate::{Case, CaseError, InputKey, InputSet};

/// Typical range of catalog efficiencies, and the amount by which the efficiency decreases if the
/// load drives the screw.
pub(crate) const USUAL_EFFICIENCIES: ([f64; 2], f64) = ([0.85, 0.95], 0.1);

/// Inputs without which a groove cannot be estimated.
const NEEDED: InputSet = inputs! { nominal_diameter_mm rated_dynamic_load_N };

/// Inputs that the estimate of a groove adds to a case.
const GROOVE: InputSet = inputs! {
    ball_diameter_mm pitch_circle_diameter_mm contact_angle_deg nut_conformity screw_conformity
    loaded_balls_per_turn loaded_turns
};

/// Inputs on which the estimate of a groove depends.
const READ: InputSet = {
    let others = inputs! {
        lead_mm lead_angle_deg rated_static_load_N shaft_diameter_mm circuits_count gap_deg starts
    };
    NEEDED.union(GROOVE).union(others)
};

impl InputSet {
    /// Returns this set of inputs. If the set contains nominal diameter, lead and dynamic load
    /// rating, the groove inputs that the program estimates from them are added.
    #[must_use]
    pub fn with_groove(self) -> Self {
        let has_lead = self.intersects(inputs! { lead_mm lead_angle_deg });
        if self.contains_all(NEEDED) && has_lead && self.lacks_groove() {
            let bottoms = self.contains(InputKey::groove_bottom_distance_mm);
            let angle = inputs! { contact_angle_deg };
            self.union(if bottoms { GROOVE.without(angle) } else { GROOVE })
        } else {
            self
        }
    }

    /// Returns true if the estimate of a groove depends on at least one input of this set.
    pub fn changes_groove(self) -> bool {
        self.intersects(READ)
    }
}

impl Case {
    /// Returns the inputs that are known for the rows of a table with the input columns `columns`,
    /// including the inputs of an estimated groove.
    pub fn stated_over(&self, columns: InputSet) -> InputSet {
        let given = self.stated().overridden_by(columns);
        // If circuits are given, they determine the numbers of turns and balls.
        let lacks_groove = given.union(rated_nut::given(self)).lacks_groove();
        let estimates = lacks_groove && self.entries.estimate_groove != Some(false);
        if estimates { given.with_groove() } else { given }
    }

    /// Returns true if the groove of the case is estimated, at least in part.
    pub fn has_estimated_groove(&self) -> bool {
        self.entries.estimated_inputs.as_ref().is_some_and(|names| !names.is_empty())
    }

    /// Returns true if the input with this name is estimated.
    pub fn estimates(&self, name: &str) -> bool {
        let mut names = self.entries.estimated_inputs.iter().flatten();
        names.any(|InputName(key)| key.name() == name)
    }

    /// Returns the case without its estimated inputs.
    #[must_use]
    pub fn without_estimates(&self) -> Self {
        let mut case = self.clone();
        for InputName(key) in case.entries.estimated_inputs.take().into_iter().flatten() {
            case[key] = None;
        }
        case
    }

    /// Returns the case with a complete groove. If the given groove is incomplete, it is estimated
    /// from nominal diameter, lead and load ratings. The case is returned unchanged if the groove
    /// is already complete or if these inputs are missing.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::NoGroove`] if no typical groove has the given ratings, unless
    /// `keep_ratings` is true. Returns [`CaseError::OutOfRange`] if an input violates its rule.
    pub fn with_groove(&self) -> Result<Self, CaseError> {
        let line = self.without_estimates();
        let estimate = line.groove_estimate()?;
        Ok(estimate.map_or_else(|| line.clone(), |estimate| line.with(&estimate.best())))
    }

    /// Returns the estimate of the groove for a case without estimated inputs, or `None` if no
    /// estimate is necessary or possible.
    pub(crate) fn groove_estimate(&self) -> Result<Option<GrooveEstimate>, CaseError> {
        let wanted = self.entries.estimate_groove != Some(false) && self.lacks_groove();
        if !wanted {
            return Ok(None);
        }
        let Some(line) = self.catalog_line()? else { return Ok(None) };
        for key in self.given().iter().filter(|key| READ.contains(*key)) {
            key.input().rule.check(key.name(), self[key].unwrap_or(f64::NAN))?;
        }
        if self.number(InputKey::starts) > 1.0 {
            let what = "The groove is not given in full, and it can be estimated from load ratings only if the screw has one \
                        start. Give all inputs of the groove.";
            return Err(CaseError::NoGroove(what.to_owned()));
        }
        match line.estimate() {
            Ok(estimate) => Ok(Some(estimate)),
            Err(RejectedRow { nearest: Some(nearest), .. })
                if self.entries.keep_ratings == Some(true) =>
            {
                Ok(Some(*nearest))
            }
            Err(refused) => Err(CaseError::NoGroove(self.refusal(&refused))),
        }
    }

    /// Returns the catalog data from which a groove can be estimated, or `None` if required inputs
    /// are missing.
    fn catalog_line(&self) -> Result<Option<CatalogLine>, CaseError> {
        let meters = |key: InputKey| self[key].map(|mm| mm * MM);
        let sizes = meters(InputKey::nominal_diameter_mm).zip(self.lead());
        let Some(((nominal_diameter, lead), dynamic_rating)) = sizes.zip(rated_dynamic_load(self)?)
        else {
            return Ok(None);
        };
        Ok(Some(CatalogLine {
            nominal_diameter,
            lead: lead * MM,
            dynamic_rating,
            static_rating: self.rated_static_load_N,
            ball_diameter: meters(InputKey::ball_diameter_mm),
            pitch_diameter: meters(InputKey::pitch_circle_diameter_mm),
            core: meters(InputKey::shaft_diameter_mm),
            turns: NutTurns::of(self).turns,
            conformity: Conformities { nut: self.nut_conformity, screw: self.screw_conformity },
            contact_angle: self.contact_angle_deg.map(|deg| deg * DEG),
        }))
    }

    /// Returns a copy of the case in which missing inputs are taken from an estimated groove.
    fn with(&self, groove: &EstimatedGroove) -> Self {
        let mut case = self.clone();
        let lead = self.lead().map_or(f64::NAN, |mm| mm * MM);
        let full_turn = turn_length(groove.pitch_diameter, lead) / groove.ball_diameter;
        let given_turns = NutTurns::of(self).turns;
        // If the number of turns is not given, it is chosen so that all balls fit.
        let turns = given_turns.unwrap_or(groove.turns.max(groove.loaded_balls / full_turn));
        let per_turn = (groove.loaded_balls / turns).min(full_turn);
        let angle = groove.contact_angle / DEG;
        let values = [
            (InputKey::ball_diameter_mm, groove.ball_diameter / MM, true),
            (InputKey::pitch_circle_diameter_mm, groove.pitch_diameter / MM, true),
            (InputKey::contact_angle_deg, angle, self.groove_bottom_distance_mm.is_none()),
            (InputKey::nut_conformity, groove.conformity.nut, true),
            (InputKey::screw_conformity, groove.conformity.screw, true),
            (InputKey::loaded_balls_per_turn, per_turn, self.entries.circuits.is_none()),
            (InputKey::loaded_turns, turns, given_turns.is_none()),
        ];
        let mut estimated = Vec::new();
        for (key, value, applies) in values {
            if applies && case[key].is_none() {
                case[key] = Some(decimal(value));
                estimated.push(InputName(key));
            }
        }
        case.entries.estimated_inputs = Some(estimated);
        case
    }

    /// Returns a copy of the case with one of the possible grooves, which represent the uncertainty
    /// of the estimate. If friction is not given, a possible catalog efficiency is added.
    ///
    /// * `draw`: index of the possible groove.
    pub(crate) fn possible(&self, draw: usize, groove: &EstimatedGroove) -> Self {
        let mut case = self.with(groove);
        if !case.given().has_friction() {
            let ([low, high], driven_less) = USUAL_EFFICIENCIES;
            let efficiency = low + (high - low) * quasi_random_besides_groove(draw);
            case.catalog_efficiency.get_or_insert(efficiency);
            case.catalog_back_efficiency.get_or_insert(efficiency - driven_less);
        }
        case
    }

    /// Returns a message that explains why no groove can be estimated. The message states the given
    /// values, the nearest groove with its ratings, and possible mistakes in the data.
    fn refusal(&self, RejectedRow { nearest, mistakes }: &RejectedRow) -> String {
        let stated: Vec<_> = self.given().iter().filter(|key| READ.contains(*key)).collect();
        let stated = stated.iter().filter_map(|key| {
            let unit = key.input().unit;
            Some(
                format!("{} = {} {unit}", key.name(), format_trimmed(self[*key]?))
                    .trim()
                    .to_owned(),
            )
        });
        let stated = stated.collect::<Vec<_>>().join(", ");
        let nearest = match nearest {
            None => "no standard ball diameter fits these dimensions".to_owned(),
            Some(nearest) => {
                let groove = nearest.best();
                let case = self.with(&groove);
                let nut = groove.nut(nearest.line.lead, case.reader().materials());
                format!(
                    "the nearest groove has {} balls of {} mm in {} turns and ratings of {:.0} N and {:.0} N",
                    groove.loaded_balls,
                    format_trimmed(groove.ball_diameter / MM),
                    format_digits(groove.turns, 3),
                    nut.dynamic_rating().rating,
                    nut.static_rating().rating
                )
            }
        };
        let mistakes: Vec<_> = mistakes.iter().map(|(mistake, _)| words(*mistake)).collect();
        let mistakes = if mistakes.is_empty() {
            String::new()
        } else {
            format!(" A typical groove would match the ratings if {}.", mistakes.join(", or "))
        };
        format!(
            "No typical groove has these ratings and dimensions: {stated}; {nearest}.{mistakes} Correct the values, give the groove in full, or set \
             keep_ratings=true to use the nearest groove."
        )
    }
}

/// Describes a possible mistake in the catalog data.
fn words(mistake: CatalogMistake) -> &'static str {
    match mistake {
        CatalogMistake::RatingsInKilogramForce => "the ratings were in kgf",
        CatalogMistake::RatingsInPoundForce => "the ratings were in lbf",
        CatalogMistake::RatingsSwapped => "the two ratings were swapped",
        CatalogMistake::StaticRatingTimesTen => "rated_static_load_N were 10 times as large",
        CatalogMistake::StaticRatingOverTen => {
            "rated_static_load_N were a tenth of the given value"
        }
        CatalogMistake::LeadTimesTen => "lead_mm were 10 times as large",
        CatalogMistake::LeadOverTen => "lead_mm were a tenth of the given value",
    }
}
