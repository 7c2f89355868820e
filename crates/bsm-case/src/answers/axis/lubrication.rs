//! Lubricant quantities that determine the modified life of an axis.

use crate::case::axis::AxisModel;
use crate::vocabulary::entries::Named;
use crate::{Case, CaseError};
use bsm_design::life::{Contamination, usual_fatigue_limit};

/// Lubricant and cleanliness data for the modified life.
pub(super) struct Lubrication {
    /// Kinematic viscosity of the warm lubricant \[m²/s\].
    pub(super) viscosity: f64,
    /// Fatigue load limit for the modified life \[N\].
    pub(super) fatigue_limit: f64,
    /// Typical, smallest and largest contamination factor.
    pub(super) contamination: [f64; 3],
}

impl Lubrication {
    /// Returns the lubrication data of a case, or `None` if contamination, viscosity or lubricant
    /// temperature is missing.
    pub(super) fn of(case: &Case, machine: &AxisModel) -> Result<Option<Self>, CaseError> {
        let screw = &machine.axis.screw;
        let by_word = |Named(word): Named<Contamination>| word.factor(screw.pitch_diameter);
        let contamination = match (case.entries.contamination, case.contamination_factor) {
            (Some(_), Some(_)) => {
                return Err(CaseError::given_twice(["contamination", "contamination_factor"]));
            }
            (word, factor) => factor.map(|factor| [factor; 3]).or(word.map(by_word)),
        };
        let viscosity = case.viscosity();
        let groove = machine.groove.as_ref().filter(|_| !case.has_estimated_groove());
        let of_groove = groove.map(|(nut, _)| nut.fatigue_limit());
        let fatigue_limit = of_groove.unwrap_or_else(|| {
            Some(usual_fatigue_limit(machine.ratings.static_, screw.pitch_diameter))
        });
        let found = contamination.zip(viscosity).zip(fatigue_limit);
        Ok(found.map(|((contamination, viscosity), fatigue_limit)| Self {
            viscosity,
            fatigue_limit,
            contamination,
        }))
    }
}
