//! Conversion of an axis to the problem of its warm steady state in SI units.

use bsm_design::drive::drag_torque;
use bsm_dyn::DrivenPart;
use bsm_kin::Drive;
use bsm_nut::thermal::{
    BETWEEN_LOADS, BallLink, HeldFriction as _, WarmNut, WarmPhase, drag_beyond_contacts,
};
use bsm_nut::{BallNut, Equilibrium, NutError, Support};

use crate::case::axis::AxisModel;
use crate::case::nut::NutPreload;
use crate::case::thermal::{set_temperature, thermal_axis};
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::units::RPM;
use crate::{Case, CaseError, InputKey, NutProblem, Settings};

/// Speed at which manufacturers measure the drag torque due to preload \[rad/s\].
const SLOW: f64 = 100.0 * RPM;

/// A nut in the state in which manufacturers set the preload and measure the drag torque: cold and
/// at the speed [`SLOW`].
pub(crate) struct ColdNut {
    problem: NutProblem,
    nut: BallNut,
    /// Equilibrium of the nut with the loads and constraints of the problem.
    found: Equilibrium,
    pub(super) preload: Option<NutPreload>,
    /// Equilibrium of the preloaded nut without external load. The guides prevent tilting.
    pub(super) unloaded: Option<Equilibrium>,
    /// Temperature at which the preload is set \[K\].
    assembly_temperature: f64,
}

impl ColdNut {
    /// Prepares the cold nut of a case.
    pub(crate) fn of(
        case: &Case,
        settings: &Settings,
        machine: &AxisModel,
    ) -> Result<Self, CaseError> {
        let mut cold = case.cold().without_carriage();
        let celsius = case.number(InputKey::preload_temperature_C);
        (cold.feed_m_min, cold.seal_torque_Nm, cold.entries.cycle) = (None, None, None);
        (cold.screw_speed_rpm, cold.nut_speed_rpm) = (Some(SLOW / RPM), None);
        let heaviest = machine.axis.heaviest().map_or(0.0, |phase| phase.load);
        cold.axial_load_N = Some(if case.is_preloaded() { 0.0 } else { heaviest });
        if case.given().is_lubricated() {
            cold.lubricant_temperature_C = Some(celsius);
        }
        let problem = NutProblem::of(&cold, settings)?;
        let at_rest = problem.solve_at_rest().map_err(CaseError::Nut)?;
        let (nut, preload, found) = (at_rest.nut, at_rest.preload, at_rest.found);
        let unloaded = preload.map(|_| nut.solve(&Support::guided(0.0)));
        let unloaded = unloaded.transpose().map_err(CaseError::Nut)?;
        Ok(Self {
            problem,
            nut,
            found,
            preload,
            unloaded,
            assembly_temperature: set_temperature(case),
        })
    }

    /// Returns the data for the heat transfer through the balls. The contact areas are calculated
    /// for the mean ball load that the cold preload causes or, without a preload, that the largest
    /// load causes.
    pub(crate) fn link(&self) -> Result<BallLink, CaseError> {
        let mean = match &self.unloaded {
            Some(found) if self.problem.support == Support::guided(0.0) => found.mean_load(),
            _ => self.found.mean_load(),
        };
        let radii = self.nut.contact_radii(mean);
        let radii = radii.map_err(|why| CaseError::Nut(NutError::Contact(why)))?;
        Ok(BallLink::of(&self.nut, radii))
    }

    /// Returns the ratio of drag torque to preload, `$K_x h$` \[m\], for the part of the drag
    /// torque that is not caused by the contacts. The ratio is 0 without a preload.
    pub(crate) fn drag(&self, case: &Case, machine: &AxisModel) -> f64 {
        if let Some(factor) = case.extra_drag_factor {
            return factor * machine.advance();
        }
        let by_rule = case.entries.drag_rule != Some(false);
        let preloaded = self.preload.zip(self.unloaded.as_ref()).filter(|_| by_rule);
        let Some((preload, found)) = preloaded else { return 0.0 };
        let slow = Drive { screw_speed: SLOW, nut_speed: 0.0 };
        let contacts = self
            .problem
            .sum(&self.nut, found, &slow, self.assembly_temperature, BETWEEN_LOADS, &[])
            .map_or(0.0, |friction| friction.torque);
        let screw = &machine.axis.screw;
        let rule = drag_torque(preload.cold, screw.lead, screw.lead_angle());
        drag_beyond_contacts(rule, contacts, preload.cold)
    }
}

/// An axis with the data that determine its warm state.
pub(crate) struct WarmAxis<'a> {
    case: &'a Case,
    machine: &'a AxisModel,
    pub(super) cold: ColdNut,
}

impl<'a> WarmAxis<'a> {
    /// Prepares the warm state of an axis.
    pub(crate) fn of(
        case: &'a Case,
        settings: &Settings,
        machine: &'a AxisModel,
    ) -> Result<Self, CaseError> {
        if case.is_warm() {
            let what = "calculates temperature rises and the tension of the screw, so they must not be given";
            return Err(invalid_input("warm_state", what));
        }
        if case.axis_heat_transfer_W_K.or(case.heat_transfer_W_K).is_some() {
            let what = "uses a thermal network of five nodes, so the heat transfer of a single node must not be given";
            return Err(invalid_input("warm_state", what));
        }
        if machine.travel(case)?.is_none() {
            return Err(invalid_input("warm_state", "needs stroke_mm"));
        }
        if !case.given().has_friction() {
            let missing = ["friction_coefficient or a lubricant".to_owned()];
            return Err(CaseError::missing(&missing, "for the warm state"));
        }
        let cold = ColdNut::of(case, settings, machine)?;
        Ok(Self { case, machine, cold })
    }

    /// Returns the upper limit of the search for the fold, as a multiple of the given speeds.
    pub(crate) fn search(&self) -> f64 {
        self.case.number(InputKey::fold_search_factor)
    }

    /// Returns the nut with its friction and its thermal network.
    pub(crate) fn nut(&self) -> Result<WarmNut<'_>, CaseError> {
        let Self { case, machine, ref cold } = *self;
        let axis = thermal_axis(case, machine, cold.link()?)?;
        let Some(axis) = axis else { return Err(invalid_input("warm_state", "needs stroke_mm")) };
        let samples = machine.axis.phases.iter().flat_map(bsm_design::motion::Phase::samples);
        let phase = |(time, point): (f64, bsm_design::motion::PhasePoint)| WarmPhase {
            time,
            load: point.load,
            drive: match machine.axis.driven {
                DrivenPart::Screw => Drive { screw_speed: point.speed, nut_speed: 0.0 },
                DrivenPart::Nut => Drive { screw_speed: 0.0, nut_speed: -point.speed },
            },
        };
        Ok(WarmNut {
            nut: cold.nut.clone(),
            preload: cold.preload.map(|preload| preload.by),
            support: cold.problem.support,
            phases: samples.map(phase).collect(),
            friction: &cold.problem,
            drag: cold.drag(case, machine),
            seal: case.number(InputKey::seal_torque_Nm),
            bearings: case.number(InputKey::support_bearing_torque_Nm),
            motor: case.number(InputKey::motor_heat_W),
            assembly_temperature: cold.assembly_temperature,
            axis,
        })
    }
}
