//! The heat of a nut whose grooves have the temperatures of its nodes.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I13) to (I15).

use bsm_kin::Drive;

use super::{HeatSources, NODES, Network, ThermalAxis};
use crate::{BallModel, BallNut, Equilibrium, FrictionSum, NutError, PreloadKind, Support};

/// Friction of all balls of a nut. The models of the balls can be held constant.
///
/// A function of nut, equilibrium, speeds, oil temperature and accuracy between loads implements
/// this trait. Its models need not be held, because its friction does not jump.
pub trait HeldFriction {
    /// Returns the friction under a load at given speeds, or `None` unless the friction of every
    /// ball is known.
    ///
    /// * `oil`: oil temperature \[K\].
    /// * `between_loads`: permitted relative error of the friction between the loads of balls.
    /// * `held`: model of each ball, by its index. Balls without an entry choose their own model.
    fn sum(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        drive: &Drive<f64>,
        oil: f64,
        between_loads: f64,
        held: &[Option<BallModel>],
    ) -> Option<FrictionSum>;

    /// Returns the models that the balls choose, by their index. The list is empty if the friction
    /// does not depend on a model.
    fn models(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        drive: &Drive<f64>,
        oil: f64,
    ) -> Option<Vec<Option<BallModel>>>;
}

impl<F> HeldFriction for F
where
    F: Fn(&BallNut, &Equilibrium, &Drive<f64>, f64, f64) -> Option<FrictionSum>,
{
    fn sum(
        &self,
        nut: &BallNut,
        found: &Equilibrium,
        drive: &Drive<f64>,
        oil: f64,
        between_loads: f64,
        _: &[Option<BallModel>],
    ) -> Option<FrictionSum> {
        self(nut, found, drive, oil, between_loads)
    }

    fn models(
        &self,
        _: &BallNut,
        _: &Equilibrium,
        _: &Drive<f64>,
        _: f64,
    ) -> Option<Vec<Option<BallModel>>> {
        Some(Vec::new())
    }
}

/// Models of the balls in each phase of a cycle.
pub(super) type ModelsOfPhases = Vec<Vec<Option<BallModel>>>;

/// Permitted error of the friction between the loads of balls: a tenth of the residual heat of a
/// state.
pub const BETWEEN_LOADS: f64 = 1e-9;

/// A phase of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmPhase {
    /// Time, in any unit that all phases share.
    pub time: f64,
    /// Axial load \[N\].
    pub load: f64,
    /// Speeds of screw and nut.
    pub drive: Drive<f64>,
}

impl WarmPhase {
    /// Returns the phase with its speeds multiplied by a factor.
    fn at(&self, factor: f64) -> Drive<f64> {
        let Drive { screw_speed, nut_speed } = self.drive;
        Drive { screw_speed: factor * screw_speed, nut_speed: factor * nut_speed }
    }
}

/// A nut on its screw, with its friction and its thermal network.
#[derive(Clone)]
pub struct WarmNut<'a> {
    /// The nut with its preload, at the assembly temperature.
    pub nut: BallNut,
    /// Preload method; `None` without a preload.
    pub preload: Option<PreloadKind>,
    /// Support of the nut except for its axial load.
    pub support: Support,
    /// Phases of the cycle.
    pub phases: Vec<WarmPhase>,
    /// Friction of the balls.
    pub friction: &'a (dyn HeldFriction + 'a),
    /// Drag outside the contacts divided by the warm preload, `$K_x h$` \[m\] (I15).
    pub drag: f64,
    /// Torque of the seals \[N·m\].
    pub seal: f64,
    /// Torque of all support bearings \[N·m\].
    pub bearings: f64,
    /// Heat that the motor gives to end 1 \[W\].
    pub motor: f64,
    /// Assembly temperature, at which preload and fits are set \[K\].
    pub set: f64,
    /// The thermal model of the axis.
    pub axis: ThermalAxis,
}

/// The nut in a phase of its cycle.
#[derive(Debug, Clone)]
pub struct PhaseState {
    /// Loads of the nut.
    pub found: Equilibrium,
    /// Friction of its balls; `None` at rest.
    pub friction: Option<FrictionSum>,
    /// Drag outside the contacts \[N·m\].
    pub drag: f64,
}

/// Heat and loads of a nut at given temperatures.
#[derive(Debug, Clone)]
pub struct NutAtTemperature {
    /// Heat of each node \[W\], as a mean over the cycle.
    pub heat: [f64; NODES],
    /// Preload without external load \[N\]; 0 for a nut without preload.
    pub preload: f64,
    /// The nut without external load.
    pub unloaded: Option<Equilibrium>,
    /// The phases of the cycle. Phases at rest are included only if they are requested.
    pub phases: Vec<Option<PhaseState>>,
}

/// Returns the drag outside the contacts divided by the preload, `$K_x h$` \[m\] (I15).
///
/// * `rule`, `contacts`: drag torque of the cold preload according to the rule of manufacturers,
///   and drag torque of its contacts alone \[N·m\].
pub fn drag_beyond_contacts(rule: f64, contacts: f64, preload: f64) -> f64 {
    // K_x h = max(0, T_p − T_c)/F_p                                       (I15)
    (rule - contacts).max(0.0) / preload
}

impl WarmNut<'_> {
    /// Returns the thermal network if all speeds are multiplied by a factor.
    pub fn network(&self, factor: f64) -> Network {
        let paced = |phase: &WarmPhase| (phase.time, factor * phase.drive.relative_speed().abs());
        let phases: Vec<_> = self.phases.iter().map(paced).collect();
        self.axis.network(&phases)
    }

    /// Returns the oil temperature \[K\] (I13).
    pub fn oil(&self, [nut, screw, balls, ..]: &[f64; NODES]) -> f64 {
        // T_o = T_b/2 + (T_n + T_s)/4                                     (I13)
        self.set + 0.5 * balls + 0.25 * (nut + screw)
    }

    /// Returns the nut with the temperatures of the nodes in its grooves and balls, and with the
    /// strain of the screw.
    ///
    /// * `tension`: tension of the screw \[N\].
    pub fn warmed(&self, rises: &[f64; NODES], tension: f64) -> BallNut {
        let ThermalAxis { screw, .. } = &self.axis;
        let warm = self.nut.warmed([rises[0], rises[1], rises[2]], screw.expansion);
        match screw.hold {
            Some(hold) => warm.strained(screw.strain(tension), hold.poisson_ratio),
            None => warm,
        }
    }

    /// Returns loads and heat at given temperature rises if all speeds are multiplied by a factor
    /// (I14).
    ///
    /// * `all`: true to include the phases at rest, which produce no heat.
    ///
    /// # Errors
    ///
    /// The [`NutError`] of a load, or `None` if a ball has no friction.
    pub fn heated(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        all: bool,
    ) -> Result<NutAtTemperature, Option<NutError>> {
        self.heated_to(rises, factor, all, BETWEEN_LOADS, &[])
    }

    /// Returns the models that the balls choose in each phase of the cycle at given temperature
    /// rises, or `None` if a ball has no solution.
    ///
    /// * `heated`: the nut at these temperatures.
    pub(super) fn models(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        heated: &NutAtTemperature,
    ) -> Option<ModelsOfPhases> {
        let tension = self.axis.screw.hold.map_or(0.0, |_| self.network(factor).tension(rises));
        let (nut, oil) = (self.warmed(rises, tension), self.oil(rises));
        let of_phase = |(phase, state): (&WarmPhase, &Option<PhaseState>)| {
            let drive = phase.at(factor);
            let moving = state.as_ref().filter(|_| drive.relative_speed() != 0.0);
            let models = |state: &PhaseState| self.friction.models(&nut, &state.found, &drive, oil);
            moving.map_or(Some(Vec::new()), models)
        };
        self.phases.iter().zip(&heated.phases).map(of_phase).collect()
    }

    /// Returns loads and heat with a given accuracy of the friction between loads.
    ///
    /// * `held`: models of the balls in each phase of the cycle. Without it, balls choose their own
    ///   models.
    pub(super) fn heated_to(
        &self,
        rises: &[f64; NODES],
        factor: f64,
        all: bool,
        between_loads: f64,
        held: &[Vec<Option<BallModel>>],
    ) -> Result<NutAtTemperature, Option<NutError>> {
        let tension = self.axis.screw.hold.map_or(0.0, |_| self.network(factor).tension(rises));
        let (nut, oil) = (self.warmed(rises, tension), self.oil(rises));
        let unloaded = self.preload.map(|_| nut.solve(&Support::guided(0.0))).transpose()?;
        let preload = unloaded.as_ref().zip(self.preload);
        let preload = preload.map_or(0.0, |(found, by)| found.preload(&nut, by));
        let time: f64 = self.phases.iter().map(|phase| phase.time).sum();
        let mut sources = HeatSources { motor: self.motor, ..HeatSources::default() };
        let mut phases: Vec<Option<PhaseState>> = Vec::with_capacity(self.phases.len());
        for (number, phase) in self.phases.iter().enumerate() {
            let drive = phase.at(factor);
            let speed = drive.relative_speed().abs();
            if speed == 0.0 && !all {
                phases.push(None);
                continue;
            }
            let alike = self.phases[..number].iter().zip(&phases);
            let mut alike = alike.filter(|(other, _)| other.load.total_cmp(&phase.load).is_eq());
            let known = alike.find_map(|(_, known)| known.as_ref());
            let support = self.support.with_axial(phase.load);
            let found = match (known, &unloaded) {
                (Some(known), _) => known.found.clone(),
                (None, Some(found)) if support == Support::guided(0.0) => found.clone(),
                _ => nut.solve(&support)?,
            };
            if speed == 0.0 {
                phases.push(Some(PhaseState { found, friction: None, drag: 0.0 }));
                continue;
            }
            let held = held.get(number).map_or(&[][..], Vec::as_slice);
            let friction = self.friction.sum(&nut, &found, &drive, oil, between_loads, held);
            let friction = friction.ok_or(None)?;
            let FrictionSum { torque, contacts: [at_nut, at_screw], returns, .. } = friction;
            // T_x = K_x F_w h                                             (I15)
            let drag = self.drag * preload;
            let beyond = torque - at_nut - at_screw + returns + drag;
            let torques = HeatSources {
                contacts: [at_nut, at_screw],
                balls: beyond,
                seals: self.seal,
                bearings: self.bearings,
                motor: 0.0,
            };
            sources.add(&torques, phase.time / time * speed);
            phases.push(Some(PhaseState { found, friction: Some(friction), drag }));
        }
        Ok(NutAtTemperature { heat: self.axis.heats(&sources), preload, unloaded, phases })
    }
}
