//! Errors of a setting relative to the reference solution, for each group of points.

use bsm_case::{Case, CaseError, Settings};
use bsm_dyn::{ModelWorkspace, Solution, solution::SlipRegime};
use bsm_kin::Site;
use schemars::JsonSchema;
use serde::Serialize;

use super::reference_settings;
use crate::ValidateError;

/// A group of points at which the balls have the same slip regime.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(into = "&'static str")]
pub enum Group {
    /// All points, regardless of their slip regime.
    All,
    /// Points with the given slip regime.
    #[schemars(skip)]
    Of(SlipRegime),
}

impl Group {
    /// All groups. The first group contains all points, and each of the other groups contains the
    /// points with one slip regime.
    pub const ALL: [Self; 4] = [
        Self::All,
        Self::Of(SlipRegime::Rolling),
        Self::Of(SlipRegime::PartialSkid),
        Self::Of(SlipRegime::GrossSkid),
    ];

    /// Returns the name of the group as text.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Of(motion) => motion.name(),
        }
    }

    fn holds(self, motion: SlipRegime) -> bool {
        self == Self::All || self == Self::Of(motion)
    }
}

impl From<Group> for &'static str {
    fn from(group: Group) -> Self {
        group.name()
    }
}

/// Distribution of an error, a time or a count over all points of a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Distribution {
    /// Mean of the values at all points.
    pub mean: f64,
    /// Median: at half of the points, the value is at most this large.
    pub median: f64,
    /// 90 % quantile: at 90 % of the points, the value is at most this large.
    pub q90: f64,
    /// 99 % quantile: at 99 % of the points, the value is at most this large.
    pub q99: f64,
    /// Largest value at any point.
    pub max: f64,
}

impl Distribution {
    /// Calculates mean, quantiles and maximum of the values. Returns `None` if there are no values.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        // The closure returns the smallest value that a given fraction of the values does not
        // exceed.
        let at = |share: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "an index among thousands"
            )]
            let place = (share * values.len() as f64).ceil() as usize;
            values.get(place.max(1) - 1).copied()
        };
        #[expect(clippy::cast_precision_loss, reason = "a number of points")]
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(Self { mean, median: at(0.5)?, q90: at(0.9)?, q99: at(0.99)?, max: at(1.0)? })
    }
}

/// Errors of a setting in a group of points. Points that the setting did not solve are left out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Errors {
    /// Group of points to which the errors refer.
    pub group: Group,
    /// Fraction of the points that the setting solved.
    pub solved: f64,
    /// Absolute error of the efficiency.
    pub efficiency: Option<Distribution>,
    /// Relative error of the screw torque.
    pub torque: Option<Distribution>,
    /// Relative error of the normal loads: the larger of the errors at nut and screw.
    pub loads: Option<Distribution>,
    /// Error of the contact angles \[deg\]: the larger of the errors at nut and screw.
    pub angles_deg: Option<Distribution>,
    /// Fraction of the solved points at which the efficiency error exceeds the error bound of the
    /// setting; `None` if the setting has no error bound.
    pub bound_broken: Option<f64>,
}

/// Reference solution and slip regime of each point; `None` for a point without a reference
/// solution.
pub(super) struct Reference(Vec<Option<(SlipRegime, Solution)>>);

impl Reference {
    pub(super) fn of(cases: &[Case], work: &mut ModelWorkspace) -> Result<Self, ValidateError> {
        let settings = reference_settings();
        let points = cases.iter().map(|case| {
            let solution = case.problem(&settings)?.solve(work);
            let regime = solution.steady_state().and_then(|solved| solved.skid?.regime());
            Ok(regime.map(|regime| (regime, solution)))
        });
        let points: Vec<_> = points.collect::<Result<_, CaseError>>()?;
        if points.iter().all(Option::is_none) {
            return Err(ValidateError::NoReference);
        }
        Ok(Self(points))
    }

    /// Returns the numbers of the rows without a reference solution, counted from 1.
    pub(super) fn missing(&self) -> Vec<usize> {
        (1..).zip(&self.0).filter(|(_, point)| point.is_none()).map(|(row, _)| row).collect()
    }

    /// Returns the groups that contain points, each with the indices of its points.
    pub(super) fn groups(&self) -> Vec<(Group, Vec<usize>)> {
        let places = |group: Group| {
            let holds = |(place, point): (usize, &Option<(SlipRegime, Solution)>)| {
                point.as_ref().filter(|(motion, _)| group.holds(*motion)).map(|_| place)
            };
            self.0.iter().enumerate().filter_map(holds).collect::<Vec<_>>()
        };
        let groups = Group::ALL.into_iter().map(|group| (group, places(group)));
        groups.filter(|(_, places)| !places.is_empty()).collect()
    }

    /// Calculates the errors of a setting in all [`groups`](Self::groups).
    pub(super) fn errors(
        &self,
        cases: &[Case],
        groups: &[(Group, Vec<usize>)],
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<Vec<Errors>, ValidateError> {
        let mut answers = Vec::with_capacity(cases.len());
        for case in cases {
            let solution = case.problem(settings)?.solve(work);
            answers.push(Some(solution).filter(|solution| solution.steady_state().is_some()));
        }
        let errors = |(group, places): &(_, Vec<_>)| self.errors_of(*group, places, &answers);
        Ok(groups.iter().map(errors).collect())
    }

    fn errors_of(&self, group: Group, places: &[usize], answers: &[Option<Solution>]) -> Errors {
        let pairs: Vec<_> = places
            .iter()
            .filter_map(|place| Some((answers[*place].as_ref()?, &self.0[*place].as_ref()?.1)))
            .collect();
        let distribution = |error: fn(&Solution, &Solution) -> Option<f64>| {
            Distribution::of(pairs.iter().filter_map(|(ours, exact)| error(ours, exact)).collect())
        };
        let bounds: Vec<_> = pairs
            .iter()
            .filter_map(|(ours, exact)| {
                Some((ours.steady_state()?.error?.efficiency, efficiency(ours, exact)?))
            })
            .collect();
        let broken = bounds.iter().filter(|(bound, error)| error > bound).count();
        Errors {
            group,
            solved: share(pairs.len(), places.len()),
            efficiency: distribution(efficiency),
            torque: distribution(|ours, exact| {
                let torque = |s: &Solution| s.steady_state()?.transmission.screw_torque;
                relative(torque(ours)?, torque(exact)?)
            }),
            loads: distribution(|ours, exact| {
                let load = |s: &Solution, site| s.contact(site)?.load;
                let off = |site| relative(load(ours, site)?, load(exact, site)?);
                Some(off(Site::Nut)?.max(off(Site::Screw)?))
            }),
            angles_deg: distribution(|ours, exact| {
                let off =
                    |site| Some((ours.contact(site)?.angle - exact.contact(site)?.angle).abs());
                Some(off(Site::Nut)?.max(off(Site::Screw)?).to_degrees())
            }),
            bound_broken: (!bounds.is_empty()).then(|| share(broken, bounds.len())),
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of points are small")]
fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

fn efficiency(ours: &Solution, exact: &Solution) -> Option<f64> {
    Some((ours.efficiency()? - exact.efficiency()?).abs())
}

fn relative(ours: f64, exact: f64) -> Option<f64> {
    Some(((ours - exact) / exact).abs()).filter(|error| error.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact mean and quantiles of the integers from 1 to 200 are known.
    #[test]
    fn quantiles_of_consecutive_integers_are_exact() {
        let errors: Vec<_> = (1..=200).rev().map(f64::from).collect();
        let expected =
            Distribution { mean: 100.5, median: 100.0, q90: 180.0, q99: 198.0, max: 200.0 };
        assert_eq!(Distribution::of(errors), Some(expected));
        let one = Distribution { mean: 3.0, median: 3.0, q90: 3.0, q99: 3.0, max: 3.0 };
        assert_eq!(Distribution::of(vec![3.0]), Some(one));
        assert_eq!(Distribution::of(Vec::new()), None);
    }
}
