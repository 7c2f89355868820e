//! The warm steady state of an axis: found once, and what the sheet says of it.

use bsm_dyn::ZERO_CELSIUS;
use bsm_nut::thermal::{Band, Fold, NODES, NoSteadyState, Steady, WarmNut};

use crate::case::axis::Machine;
use crate::case::warm::WarmAxis;
use crate::vocabulary::warm::Found;
use crate::{CaseError, Scene, Settings};

/// Numbers of the band, in the order of [`of_band`].
const OF_BAND: [(&str, &str); 5] =
    [("nut", "C"), ("screw", "C"), ("balls", "C"), ("preload", "N"), ("heat", "W")];

/// The warm steady state that was asked for, and where it ends.
#[derive(Debug)]
pub(super) struct Warm {
    /// The state; `None`: the axis runs away.
    pub(super) state: Option<WarmState>,
    pub(super) fold: Option<Fold>,
    /// Temperature of setting \[K\].
    set: f64,
    search: f64,
}

/// What is looked for besides the state itself, which takes many states.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    pub(super) fold: bool,
    pub(super) band: bool,
}

/// A warm steady state.
#[derive(Debug)]
pub(super) struct WarmState {
    pub(super) steady: Steady,
    /// Temperatures of the nodes \[°C\].
    pub(super) celsius: [f64; NODES],
    /// Free growth of the screw \[m\].
    pub(super) growth: f64,
    /// Preload without load \[N\]; `None` without a cold one.
    pub(super) preload: Option<f64>,
    /// Tension of a screw between two fixed bearings \[N\].
    pub(super) tension: Option<f64>,
    strain: f64,
    /// Temperature of the oil \[°C\].
    oil: f64,
    band: Option<Band>,
}

impl Warm {
    /// That of a scene which asks for it.
    pub(super) fn of(
        scene: &Scene,
        settings: &Settings,
        detail: Detail,
    ) -> Result<Option<Self>, CaseError> {
        let Some(words) = &scene.nut.warm_state else { return Ok(None) };
        let machine = Machine::of(scene)?;
        let axis = WarmAxis::of(scene, words, settings, &machine)?;
        let friction = axis.friction();
        let nut = axis.nut(&friction)?;
        let (set, search) = (nut.set, axis.search());
        let steady = match nut.steady() {
            Ok(steady) => steady,
            Err(NoSteadyState::RunsAway(fold)) => {
                return Ok(Some(Self { state: None, fold: Some(*fold), set, search }));
            }
            Err(why) => return Err(CaseError::NoWarmState(Box::new(why))),
        };
        let fold = if detail.fold { nut.fold(&steady, search) } else { Ok(None) };
        let fold = fold.map_err(|why| CaseError::NoWarmState(Box::new(why)))?;
        let network = nut.network(1.0);
        let tension = nut.screw.hold.map(|_| network.tension(&steady.rises));
        let state = WarmState {
            celsius: celsius(&nut, &steady),
            growth: network.growth(&steady.rises),
            preload: axis.cold_preload().map(|_| steady.heated.preload),
            tension,
            strain: nut.screw.strain(tension.unwrap_or(0.0)),
            oil: nut.oil(&steady.rises) - ZERO_CELSIUS,
            band: detail.band.then(|| nut.band(&steady, of_band)),
            steady,
        };
        Ok(Some(Self { state: Some(state), fold, set, search }))
    }

    /// The scene in this state: as warm, as strained, with oil as warm; at the temperature of setting if there is none.
    pub(super) fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        if scene.given().is_lubricated() {
            let cold = self.set - ZERO_CELSIUS;
            scene.lubricant_temperature_C = Some(self.state.as_ref().map_or(cold, |at| at.oil));
        }
        if let (Some(state), Some(words)) = (&self.state, &mut scene.nut.warm_state) {
            let [nut, screw, balls, ..] = state.steady.rises;
            words.found = Some(Found { rises: [nut, screw, balls], strain: state.strain });
        }
        scene
    }

    /// What the temperatures rest on.
    pub(super) fn notes(&self) -> Vec<String> {
        let Some(band) = self.state.as_ref().and_then(|state| state.band.as_ref()) else {
            return Vec::new();
        };
        let end = |((name, unit), [low, high]): (&(&str, &str), &[f64; 2])| {
            format!("{name} {low:.0} to {high:.0} {unit}")
        };
        let ends: Vec<_> = OF_BAND.iter().zip(&band.ends).map(end).collect();
        let mut notes = vec![format!(
            "warm state, between what the conductances that are not given may make of it: {}",
            ends.join(", ")
        )];
        if self.fold.is_none() {
            notes.push(format!("no fold of the warm state up to {} times the speeds", self.search));
        }
        for (guess, factor, why) in &band.none {
            let (times, way) =
                if *factor > 1.0 { (*factor, "more") } else { (factor.recip(), "less") };
            notes.push(format!("{why} if {} {times} times {way}", guess.name()));
        }
        notes
    }

    /// What a user should know first.
    pub(super) fn warning(&self) -> Option<String> {
        let Some(state) = &self.state else {
            let fold = self.fold.as_ref()?;
            let [nut, screw, balls, ..] = fold.rises.map(|rise| self.set + rise - ZERO_CELSIUS);
            return Some(format!(
                "no warm steady state: runs away above {:.2} of these speeds; there nut {nut:.0}, screw {screw:.0}, \
                 balls {balls:.0} C, preload {:.0} N. All other numbers are cold",
                fold.factor, fold.preload
            ));
        };
        if state.preload.is_some_and(|preload| preload <= 0.0) {
            return Some("the preload is lost in the warm state: the nut has play".to_owned());
        }
        state.tension.filter(|tension| *tension < 0.0).map(|tension| {
            format!(
                "the screw at {:.1} C is pressed between its bearings with {:.0} N: its pretension is lost",
                state.celsius[1], -tension
            )
        })
    }
}

fn celsius(nut: &WarmNut<'_>, state: &Steady) -> [f64; NODES] {
    nut.temperatures(state).map(|kelvin| kelvin - ZERO_CELSIUS)
}

/// Numbers of a state that have an uncertainty band.
fn of_band(nut: &WarmNut<'_>, state: &Steady) -> Vec<f64> {
    let [body, screw, balls, ..] = celsius(nut, state);
    vec![body, screw, balls, state.heated.preload, state.heat()]
}
