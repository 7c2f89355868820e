//! Warm steady state of a nut: frictional heat, its effect on the preload, and the fold (the
//! highest speed with a steady state).
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I5) to (I22).
//!
//! A [`Network`] conducts heat between the five nodes of a [`ThermalAxis`]. A [`WarmNut`] generates
//! heat, which depends on the temperatures of the nodes. [`WarmNut::steady`] calculates the
//! temperatures at which the nodes lose as much heat as they receive. [`WarmNut::fold`] calculates
//! the speed above which no such temperatures exist.

mod axis;
mod band;
mod conductances;
mod coupling;
mod network;
mod states;

pub use axis::{HeatSources, ThermalAxis};
pub use band::StateInterval;
pub use conductances::{
    BallLink, Conductances, Coolant, Estimate, NutSize, Surfaces, coolant_conductance,
};
pub use coupling::{
    BETWEEN_LOADS, HeldFriction, NutAtTemperature, PhaseState, WarmNut, WarmPhase,
    drag_beyond_contacts,
};
pub use network::{AxialConstraint, Network, ScrewBar, Surroundings};
pub use states::{BranchState, Fold, NoSteadyState, SteadyState};

/// Number of thermal nodes: nut, screw within the travel, balls, and both ends of the screw.
pub const NODES: usize = 5;

/// Converts temperature rises of the nodes to temperatures \[°C\].
///
/// * `set`: assembly temperature \[K\].
/// * `rises`: temperature rises above the assembly temperature \[K\].
pub fn celsius(assembly_temperature: f64, rises: &[f64; NODES]) -> [f64; NODES] {
    rises.map(|rise| assembly_temperature + rise - bsm_dyn::lubrication::ZERO_CELSIUS)
}
