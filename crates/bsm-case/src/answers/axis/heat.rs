//! Steady-state temperatures of an axis: from its warm state, from its thermal network without
//! feedback, or from `axis_heat_transfer_W_K`.

use bsm_design::motion::Phase;
use bsm_design::shaft::steady_rise;
use bsm_nut::thermal::{BallLink, Conductances, HeatSources, NODES, Network, ThermalAxis};

use super::torques::PhaseTorques;
use crate::case::axis::AxisModel;
use crate::case::thermal::{air_over_set, bed_over_set, missing_torques, thermal_axis};
use crate::case::warm::{ColdNut, WarmState};
use crate::{Case, CaseError, Settings};

/// Steady-state temperatures of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heating {
    /// Temperature rises of nut, screw, balls and both screw ends above the surroundings \[K\], and
    /// the conductances between them. `None` if `axis_heat_transfer_W_K` is given.
    pub(super) nodes: Option<([f64; NODES], Conductances)>,
    /// Thermal expansion that the screw would have between its bearings if its ends were free
    /// \[m\].
    pub(super) growth: f64,
    /// Mean temperature rise of the screw above the surroundings \[K\].
    pub(super) mean: f64,
    /// Mean temperature rise of the screw above the machine structure that carries its bearings
    /// \[K\].
    pub(super) over_bed: f64,
    /// Uncertainty of `mean` \[K\]; `None` for a warm state, whose uncertainty is calculated
    /// separately.
    pub(super) band: Option<[f64; 2]>,
}

/// Mean powers of the heat sources over the cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Powers {
    /// Powers of the heat sources for which a torque is given \[W\].
    pub(super) given: HeatSources,
    /// Powers of the heat sources for which no torque is given, estimated from typical torques
    /// \[W\].
    pub(super) missing: HeatSources,
}

impl Powers {
    /// Returns the mean powers of the heat sources over a cycle, or `None` if the friction or the
    /// cycle time is unknown.
    pub(super) fn of(case: &Case, machine: &AxisModel, torques: &[PhaseTorques]) -> Option<Self> {
        let time: f64 = torques.iter().map(|torques| torques.phase.time).sum();
        let (seals, bearings) = missing_torques(case, machine.nominal(case));
        let usual = HeatSources { seals, bearings, ..HeatSources::default() };
        let mut powers = Self { given: HeatSources::default(), missing: HeatSources::default() };
        for torques in torques {
            let weight = torques.phase.time / time;
            powers.given.add(&torques.sources()?, weight);
            powers.missing.add(&usual, weight * torques.phase.mean_speed().abs());
        }
        (time > 0.0).then_some(powers)
    }
}

impl Heating {
    /// Returns the temperatures of an axis without a warm state, or `None` if friction or the
    /// length of the screw is unknown.
    ///
    /// * `expansion`: coefficient of thermal expansion of the screw \[1/K\].
    pub(super) fn of(
        case: &Case,
        settings: &Settings,
        machine: &AxisModel,
        torques: &[PhaseTorques],
        expansion: f64,
    ) -> Result<Option<Self>, CaseError> {
        let Some(shaft) = &machine.axis.shaft else { return Ok(None) };
        let Some(Powers { given, missing }) = Powers::of(case, machine, torques) else {
            return Ok(None);
        };
        let (air, bed) = (air_over_set(case), bed_over_set(case));
        let unit_growth = shaft.growth(expansion, 1.0);
        if let Some(transfer) = case.axis_heat_transfer_W_K {
            let mean = steady_rise(given.total(), transfer);
            let most = steady_rise(given.total() + missing.total(), transfer);
            let growth = unit_growth * mean;
            let (over_bed, band) = (mean + air - bed, Some([mean, most]));
            return Ok(Some(Self { nodes: None, growth, mean, over_bed, band }));
        }
        let link = match &machine.groove {
            // If the balls cannot carry the load, the contact areas are unknown, and a typical
            // thermal conductance of the balls is used. A note states the reason.
            Some(_) => ColdNut::of(case, settings, machine)
                .and_then(|cold| cold.link())
                .unwrap_or(BallLink::Usual),
            None => BallLink::Usual,
        };
        let Some(axis) = thermal_axis(case, machine, link)? else { return Ok(None) };
        let phases = phases(machine);
        let mean_of = |network: &Network, rises: &[f64; NODES]| {
            vec![network.thermal_expansion(rises) / unit_growth - air]
        };
        let motor = crate::InputKey::motor_heat_W;
        let given = HeatSources { motor: case.number(motor), ..given };
        let found =
            rises(&axis, &phases, &given).zip(axis.band(&phases, (&given, &missing), mean_of).ok());
        Ok(found.map(|((network, rises), band)| {
            let growth = network.thermal_expansion(&rises);
            Self {
                nodes: Some((rises.map(|rise| rise - air), network.conductances)),
                growth,
                mean: growth / unit_growth - air,
                over_bed: growth / unit_growth - bed,
                band: Some(band.limits[0]),
            }
        }))
    }

    /// Returns the temperatures of a warm state.
    pub(super) fn of_warm(
        case: &Case,
        machine: &AxisModel,
        state: &WarmState,
        expansion: f64,
    ) -> Option<Self> {
        let unit_growth = machine.axis.shaft.as_ref()?.growth(expansion, 1.0);
        let (air, bed) = (air_over_set(case), bed_over_set(case));
        Some(Self {
            nodes: Some((state.steady.rises.map(|rise| rise - air), state.conductances)),
            growth: state.growth,
            mean: state.growth / unit_growth - air,
            over_bed: state.growth / unit_growth - bed,
            band: None,
        })
    }
}

/// Returns samples that represent the cycle, including standstill. Each sample consists of a
/// duration and an absolute relative speed.
fn phases(machine: &AxisModel) -> Vec<(f64, f64)> {
    let samples = machine.axis.phases.iter().flat_map(Phase::samples);
    samples.map(|(time, point)| (time, point.speed.abs())).collect()
}

/// Returns the thermal network and its temperature rises, or `None` if the network equations are
/// singular.
fn rises(
    axis: &ThermalAxis,
    phases: &[(f64, f64)],
    powers: &HeatSources,
) -> Option<(Network, [f64; NODES])> {
    Some((axis.network(phases), axis.rises(phases, powers).ok()?))
}
