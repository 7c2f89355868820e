//! Warm steady state of an axis. The state is calculated first, and the case is then solved at the
//! temperatures of this state.

mod axis;

use bsm_dyn::Model;
use bsm_dyn::lubrication::ZERO_CELSIUS;
use bsm_nut::thermal::{
    BranchState, Conductances, Fold, NODES, NoSteadyState, PhaseState, StateInterval, SteadyState,
    WarmNut, celsius,
};
use bsm_nut::{Equilibrium, Support};

use crate::case::axis::AxisModel;
use crate::case::file::RISES;
use crate::case::nut::NutPreload;
use crate::case::thermal::missing_torques;
use crate::{Case, CaseError, InputKey, InputSet, ModelChoice, Settings};

pub(crate) use axis::ColdNut;
use axis::WarmAxis;

/// Warm steady state that a case requests, and the fold, which is the highest speed on the branch
/// of steady states.
#[derive(Debug)]
pub(crate) struct Warm {
    /// Steady state; `None` in case of thermal runaway.
    pub(crate) state: Option<WarmState>,
    pub(crate) fold: Option<Fold>,
    /// Reason why the branch of states ends before it reaches a fold; `None` if it does not end
    /// early.
    pub(crate) end: Option<NoSteadyState>,
    /// Upper limit of the search for the fold, as a multiple of the given speeds; `None` if there
    /// was no search.
    pub(crate) search: Option<f64>,
    /// Model and settings with which the friction was calculated.
    pub(crate) settings: Settings,
    /// Reason why no warm state exists with the model that `auto` chose first, so that another
    /// model was used; `None` if the requested settings were used.
    pub(crate) replaced: Option<Box<NoSteadyState>>,
}

/// Selection of optional results that take additional time to calculate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Detail {
    pub(crate) fold: bool,
    pub(crate) band: bool,
    /// True if the report includes warnings, notes and order data of an axis.
    pub(crate) texts: bool,
}

impl Detail {
    /// Results that are needed to decide whether an axis is suitable.
    pub(crate) const WITHOUT_BAND: Self = Self { fold: true, band: false, texts: true };
}

/// Results for a warm steady state.
#[derive(Debug)]
pub(crate) struct WarmState {
    pub(crate) steady: SteadyState,
    /// Temperatures of the network nodes \[°C\].
    pub(crate) celsius: [f64; NODES],
    /// Thermal expansion that the screw would have if its ends were free \[m\].
    pub(crate) growth: f64,
    /// Preload without external load; `None` without a preload.
    pub(crate) preload: Option<NutPreload>,
    /// Stiffness of the preloaded nut without external load, in the cold and in the warm state
    /// \[N/m\]; `None` without a preload.
    pub(crate) stiffness: Option<[f64; 2]>,
    /// Life under the duty cycle with the cold preload \[revolutions\].
    pub(crate) cold_life: Option<f64>,
    /// Results for the nut in each phase of the cycle.
    pub(crate) phases: Vec<Option<NutInPhase>>,
    /// Tension of a screw between two fixed bearings \[N\].
    pub(crate) tension: Option<f64>,
    /// Conductances, either given or calculated from the case.
    pub(crate) conductances: Conductances,
    pub(crate) given: InputSet,
    /// Temperature of the lubricant \[°C\]; `None` for a dry nut.
    pub(crate) oil: Option<f64>,
    pub(crate) band: Option<StateInterval>,
}

/// Results for the warm nut in a phase of the cycle.
#[derive(Debug, Clone)]
pub(crate) struct NutInPhase {
    /// Axial force on each nut body \[N\].
    pub(crate) bodies: Vec<f64>,
    /// Largest load of any contact \[N\].
    pub(crate) max_load: f64,
    /// Stiffness of the nut \[N/m\].
    pub(crate) stiffness: f64,
    /// Preload that remains under load \[N\]; `None` without a preload.
    pub(crate) preload_left: Option<f64>,
}

impl Warm {
    /// Calculates the warm state, if the case requests it.
    /// For a lubricated nut, `auto` chooses the `traction` model. Under very light loads, the balls
    /// skid, and this model may have no solution. The warm state is then calculated with raceway
    /// control, whose friction is limited by gross sliding (U33).
    ///
    /// * `band_values`: function that returns the results of a steady state for which an
    ///   uncertainty band is calculated.
    pub(crate) fn of(
        case: &Case,
        settings: &Settings,
        detail: Detail,
        band_values: impl Fn(&WarmNut<'_>, &SteadyState) -> Vec<f64>,
    ) -> Result<Option<Self>, CaseError> {
        if !case.requests_warm_state() {
            return Ok(None);
        }
        let found = Self::with_model(case, settings, detail, &band_values);
        let may_replace = settings.model == ModelChoice::Auto && case.given().is_lubricated();
        match found {
            Err(CaseError::NoWarmState(why)) if may_replace && is_without_friction(&why) => {
                let rolling = Settings { model: Model::RacewayControl.into(), ..*settings };
                let Ok(warm) = Self::with_model(case, &rolling, detail, &band_values) else {
                    return Err(CaseError::NoWarmState(why));
                };
                Ok(Some(Self { replaced: Some(why), ..warm }))
            }
            found => found.map(Some),
        }
    }

    /// Calculates the warm state with one model.
    fn with_model(
        case: &Case,
        settings: &Settings,
        detail: Detail,
        band_values: &impl Fn(&WarmNut<'_>, &SteadyState) -> Vec<f64>,
    ) -> Result<Self, CaseError> {
        let (settings, replaced) = (*settings, None);
        let machine = AxisModel::of(case)?;
        let axis = WarmAxis::of(case, &settings, &machine)?;
        let nut = axis.nut()?;
        let search = detail.fold.then(|| axis.search());
        let steady = match nut.steady() {
            Ok(steady) => steady,
            Err(NoSteadyState::RunsAway(fold)) => {
                let (state, fold, end) = (None, Some(*fold), None);
                return Ok(Self { state, fold, end, search, settings, replaced });
            }
            Err(why) => return Err(CaseError::NoWarmState(Box::new(why))),
        };
        let fold = search.map_or(Ok(None), |search| nut.fold(&steady, search));
        let (fold, end) = fold.map_or_else(|why| (None, Some(why)), |fold| (fold, None));
        let preload = axis.cold.preload;
        let mut cold = machine.clone();
        cold.axis.preload = preload.map(|preload| preload.cold);
        let guided = Support::guided(0.0);
        let unloaded = axis.cold.unloaded.as_ref().zip(steady.heated.unloaded.as_ref());
        let stiffness = |(cold, warm): (&Equilibrium, &Equilibrium)| {
            [cold, warm].map(|found| found.axial_stiffness(&guided))
        };
        let in_phase = |PhaseState { found, .. }: &PhaseState| NutInPhase {
            bodies: found.bodies.clone(),
            max_load: found.max_load(),
            stiffness: found.axial_stiffness(&nut.support),
            preload_left: nut.preload.map(|by| found.preload(&nut.nut, by)),
        };
        let (network, lubricated) = (nut.network(1.0), case.given().is_lubricated());
        let missing = missing_torques(case, machine.nominal(case));
        let state = WarmState {
            celsius: celsius(nut.assembly_temperature, &steady.rises),
            growth: network.thermal_expansion(&steady.rises),
            stiffness: unloaded.map(stiffness),
            cold_life: cold.life().map(|life| life.revolutions),
            phases: steady.heated.phases.iter().map(|phase| phase.as_ref().map(in_phase)).collect(),
            preload: preload.map(|cold| NutPreload { warm: steady.heated.preload, ..cold }),
            tension: nut.axis.screw.constraint.map(|_| network.tension(&steady.rises)),
            conductances: network.conductances,
            given: case.given(),
            oil: lubricated.then(|| nut.oil(&steady.rises) - ZERO_CELSIUS),
            band: detail.band.then(|| nut.band(&steady, missing, band_values)),
            steady,
        };
        Ok(Self { state: Some(state), fold, end, search, settings, replaced })
    }

    /// Returns the temperature at which the preload is set \[K\], the cold preload \[N\], and the
    /// steady states from standstill up to the highest speed at which the fold is searched for.
    pub(crate) fn branch(
        case: &Case,
        settings: &Settings,
    ) -> Result<(f64, Option<f64>, Vec<BranchState>), CaseError> {
        let machine = AxisModel::of(case)?;
        let axis = WarmAxis::of(case, settings, &machine)?;
        let nut = axis.nut()?;
        let states = nut.branch(axis.search());
        let cold = axis.cold.preload.map(|preload| preload.cold);
        Ok((
            nut.assembly_temperature,
            cold,
            states.map_err(|why| CaseError::NoWarmState(Box::new(why)))?,
        ))
    }

    /// Calculates the warm state without its uncertainty band, if the case requests a warm state.
    ///
    /// * `fold`: if true, the fold is also searched for at speeds above the given speeds.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::NoWarmState`] if no steady state exists, for example because of thermal
    /// runaway.
    pub(crate) fn state_of(
        case: &Case,
        settings: &Settings,
        fold: bool,
    ) -> Result<Option<Self>, CaseError> {
        let warm =
            Self::of(case, settings, Detail { fold, ..Detail::WITHOUT_BAND }, |_, _| vec![])?;
        match warm {
            Some(Self { state: None, fold: Some(fold), .. }) => {
                Err(CaseError::NoWarmState(Box::new(NoSteadyState::RunsAway(Box::new(fold)))))
            }
            warm => Ok(warm),
        }
    }

    /// Returns a copy of the case with the temperature rises, the screw tension and the lubricant
    /// temperature of this warm state.
    pub(crate) fn case(&self, case: &Case) -> Case {
        let mut case = case.cold();
        if let Some(state) = &self.state {
            for (key, rise) in RISES.into_iter().zip(state.steady.rises) {
                case[key] = Some(rise);
            }
            case[InputKey::screw_tension_N] = state.tension;
            if state.oil.is_some() {
                case.lubricant_temperature_C = state.oil;
            }
        }
        case
    }
}

/// Returns true if no warm state was found because the friction of the balls is unknown or jumps.
fn is_without_friction(why: &NoSteadyState) -> bool {
    matches!(why, NoSteadyState::NoFriction | NoSteadyState::Jump { .. } | NoSteadyState::NotFound)
}

impl Case {
    /// Returns a copy of the case with the temperature rises, the screw tension and the lubricant
    /// temperature of its warm steady state. If the case does not request a warm state, the copy is
    /// unchanged.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if no warm steady state exists, or if inputs of the warm state are
    /// missing or contradictory.
    pub fn in_warm_state(&self, settings: &Settings) -> Result<Self, CaseError> {
        let warm = Warm::state_of(self, settings, false)?;
        Ok(warm.map_or_else(|| self.clone(), |warm| warm.case(self)))
    }
}
