//! The warm steady state of an axis: found once, and the scene as warm as it.

mod axis;

use bsm_dyn::ZERO_CELSIUS;
use bsm_nut::thermal::{Band, Conductances, Fold, NODES, NoSteadyState, OnBranch, Steady, WarmNut};

use crate::case::axis::Machine;
use crate::case::scene::RISES;
use crate::{CaseError, InputKey, Scene, Settings};

pub(crate) use axis::ColdNut;
use axis::WarmAxis;

/// The warm steady state that was asked for, and where it ends.
#[derive(Debug)]
pub(crate) struct Warm {
    /// The state; `None`: the axis runs away.
    pub(crate) state: Option<WarmState>,
    pub(crate) fold: Option<Fold>,
    /// Why the states end without a fold.
    pub(crate) end: Option<NoSteadyState>,
    /// Multiple of the speeds up to which the fold is looked for.
    pub(crate) search: f64,
}

/// What is looked for besides the state itself, which takes many states.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Detail {
    pub(crate) fold: bool,
    pub(crate) band: bool,
}

/// A warm steady state.
#[derive(Debug)]
pub(crate) struct WarmState {
    pub(crate) steady: Steady,
    /// Temperatures of the nodes \[°C\].
    pub(crate) celsius: [f64; NODES],
    /// Free growth of the screw \[m\].
    pub(crate) growth: f64,
    /// Preload without load, cold and warm \[N\]; `None` without one.
    pub(crate) preload: Option<[f64; 2]>,
    /// Tension of a screw between two fixed bearings \[N\].
    pub(crate) tension: Option<f64>,
    /// Those given, and those that follow from the scene.
    pub(crate) conductances: Conductances,
    /// Temperature of the lubricant \[°C\]; `None` of a dry nut.
    pub(crate) oil: Option<f64>,
    pub(crate) band: Option<Band>,
}

impl Warm {
    /// That of a scene which asks for it.
    ///
    /// * `of_band`: numbers of a state that have an uncertainty band.
    pub(crate) fn of(
        scene: &Scene,
        settings: &Settings,
        detail: Detail,
        of_band: impl Fn(&WarmNut<'_>, &Steady) -> Vec<f64>,
    ) -> Result<Option<Self>, CaseError> {
        if !scene.asks_warm() {
            return Ok(None);
        }
        let machine = Machine::of(scene)?;
        let axis = WarmAxis::of(scene, settings, &machine)?;
        let friction = axis.friction();
        let nut = axis.nut(&friction)?;
        let search = axis.search();
        let steady = match nut.steady() {
            Ok(steady) => steady,
            Err(NoSteadyState::RunsAway(fold)) => {
                return Ok(Some(Self { state: None, fold: Some(*fold), end: None, search }));
            }
            Err(why) => return Err(CaseError::NoWarmState(Box::new(why))),
        };
        let fold = if detail.fold { nut.fold(&steady, search) } else { Ok(None) };
        let (fold, end) = fold.map_or_else(|why| (None, Some(why)), |fold| (fold, None));
        let (network, lubricated) = (nut.network(1.0), scene.given().is_lubricated());
        let state = WarmState {
            celsius: nut.temperatures(&steady).map(|kelvin| kelvin - ZERO_CELSIUS),
            growth: network.growth(&steady.rises),
            preload: axis.cold_preload().map(|cold| [cold, steady.heated.preload]),
            tension: nut.screw.hold.map(|_| network.tension(&steady.rises)),
            conductances: network.conductances,
            oil: lubricated.then(|| nut.oil(&steady.rises) - ZERO_CELSIUS),
            band: detail.band.then(|| nut.band(&steady, of_band)),
            steady,
        };
        Ok(Some(Self { state: Some(state), fold, end, search }))
    }

    /// Temperature of setting \[K\], and the states from rest up to the multiple of the speeds to which a fold is looked for.
    pub(crate) fn branch(
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(f64, Vec<OnBranch>), CaseError> {
        let machine = Machine::of(scene)?;
        let axis = WarmAxis::of(scene, settings, &machine)?;
        let friction = axis.friction();
        let nut = axis.nut(&friction)?;
        let states = nut.branch(axis.search());
        Ok((nut.set, states.map_err(|why| CaseError::NoWarmState(Box::new(why)))?))
    }

    /// The state of a scene which asks for it, without its band.
    ///
    /// * `fold`: with the fold above it.
    ///
    /// # Errors
    ///
    /// [`CaseError::NoWarmState`] if it runs away too.
    pub(crate) fn state_of(
        scene: &Scene,
        settings: &Settings,
        fold: bool,
    ) -> Result<Option<Self>, CaseError> {
        let warm = Self::of(scene, settings, Detail { fold, band: false }, |_, _| vec![])?;
        match warm {
            Some(Self { state: None, fold: Some(fold), .. }) => {
                Err(CaseError::NoWarmState(Box::new(NoSteadyState::RunsAway(Box::new(fold)))))
            }
            warm => Ok(warm),
        }
    }

    /// The scene in this state: as warm, as strained, with oil as warm.
    pub(crate) fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = scene.cold();
        if let Some(state) = &self.state {
            for (key, rise) in RISES.into_iter().zip(state.steady.rises) {
                scene[key] = Some(rise);
            }
            scene[InputKey::screw_tension_N] = state.tension;
            if state.oil.is_some() {
                scene.lubricant_temperature_C = state.oil;
            }
        }
        scene
    }
}

impl Scene {
    /// In the warm steady state that it asks for: with rises of temperature, tension of the screw and temperature of the
    /// lubricant; as it is if it asks for none.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if there is no state, or what it follows from is missing or contradicts itself.
    pub fn in_warm_state(&self, settings: &Settings) -> Result<Self, CaseError> {
        let warm = Warm::state_of(self, settings, false)?;
        Ok(warm.map_or_else(|| self.clone(), |warm| warm.scene(self)))
    }
}
