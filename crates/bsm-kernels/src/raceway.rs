//! Raceway-control model, vectorized over the points of a block.

mod friction;
mod oil;

use std::f64::consts::PI;

use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::lanes::{
    ElasticMotion, LubricatedScrew, RacewayBall, friction_power, ideal_torque, onset_number,
    rolling_torque,
};
use bsm_dyn::{Control, Model, lubrication::FilmState, solution::Transmission};
use bsm_kin::Real;
use bsm_simd::{NullaryFnOnce, Simd};

use self::friction::Ellipse;
use self::oil::OilLane;
use crate::contacts::{Contacts, ElasticResults, UnitsCall};
use crate::inputs::{Lane, LaneInputs, Mask};
use crate::kernel::{Kernel, Sink};
use crate::units::Units;

/// Direct solution at each point of a block.
pub(super) type RollingRoot<S> = bsm_dyn::lanes::RollingRoot<Lane<S>>;

/// Motion of the rolling ball at each point of a block.
pub(super) type RollingMotion<S> = bsm_dyn::lanes::RollingMotion<Lane<S>>;

/// Function object that calculates the direct solution of the raceway-control model. It is compiled
/// as a separate function because two kernels share it.
pub(super) struct RollingCall<'a, S: Simd> {
    pub(super) contacts: &'a Contacts<S>,
    /// Controlling raceway. If it is `None`, (W7) determines the controlling raceway.
    pub(super) control: Option<Control>,
}

impl<S: Simd> NullaryFnOnce for RollingCall<'_, S> {
    type Output = RollingRoot<S>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        RollingRoot::direct(&RacewayBall::from(self.contacts), self.control, self.contacts.regular)
    }
}

pub(super) struct RacewayKernel {
    /// Controlling raceway. If it is `None`, (W7) determines the controlling raceway.
    pub(super) control: Option<Control>,
}

impl Kernel for RacewayKernel {
    const MODEL: Model = Model::RacewayControl;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let (units, contacts) = given.simd.vectorize(UnitsCall(given));
        let control = self.control;
        let ball = given.simd.vectorize(RacewayRow {
            given,
            units: &units,
            contacts: &contacts,
            control,
            out,
        });
        ball.found & ball.unique
    }
}

/// Function object that solves a block of points with the raceway-control model. It is compiled as
/// a separate function because the model selection by error bounds also uses it.
pub(super) struct RacewayRow<'a, 'b, 'c, 'd, S: Simd> {
    pub(super) given: &'a LaneInputs<'b, S>,
    pub(super) units: &'a Units<S>,
    pub(super) contacts: &'a Contacts<S>,
    pub(super) control: Option<Control>,
    pub(super) out: &'a mut Sink<'c, 'd>,
}

/// Results for rolling balls that are needed to select a model by its error bound.
pub(super) struct RacewayNumbers<S: Simd> {
    pub(super) efficiency: Lane<S>,
    /// Onset number (W11), and slip across the groove.
    pub(super) skid: [Lane<S>; 2],
    /// Cotangents of the contact angles at nut and screw.
    pub(super) cotangents: [Lane<S>; 2],
    /// Masks of the points for which a solution was found (`found`) and for which this solution is
    /// the only one (`unique`).
    pub(super) found: Mask<S>,
    pub(super) unique: Mask<S>,
}

impl<S: Simd> NullaryFnOnce for RacewayRow<'_, '_, '_, '_, S> {
    type Output = RacewayNumbers<S>;

    #[inline(always)]
    fn call(self) -> RacewayNumbers<S> {
        let Self { given, units, contacts, control, out } = self;
        let state = given.simd.vectorize(RollingCall { contacts, control });
        let (zero, unique) = (state.residual.constant(0.0), state.unique);
        if !state.is_first_root.any() {
            return RacewayNumbers {
                efficiency: zero,
                skid: [zero; 2],
                cotangents: [zero; 2],
                found: state.is_first_root,
                unique,
            };
        }
        let motion = RollingMotion::of(&contacts.scaled, state.by_nut, &state.sides);
        let RacewayLosses { transmission, friction, film, resolved } =
            losses(given, (units, contacts), (&state, &motion));
        let one = contacts.constant(1.0);
        // Both contact centers roll without slip along the groove. Half of the slip due to the lead
        // occurs at each contact, and friction acts along e_x.
        let elastic = ElasticMotion {
            slip: [contacts.scaled.lead.0 * 0.5; 2],
            spin: motion.spin,
            slip_angles: Some([units.result_units().back().select(one * PI, zero); 2]),
            rate: motion.p + contacts.scaled.nut_speed,
            to_nut: motion.omega,
            friction_in_balance: false,
        };
        given.simd.vectorize(ElasticResults {
            out: &mut *out,
            units,
            contacts,
            sides: &state.sides,
            motion: elastic,
            transmission: &transmission,
            error: None,
            film,
        });
        let skid = regime(out, friction, contacts, (&state, &motion));
        out.set(SolutionOutput::iterations, state.steps);
        out.set(SolutionOutput::residual_norm, state.residual);
        out.set(SolutionOutput::controlling_raceway, state.by_nut.select(zero, zero + 1.0));
        // If the balls are lubricated, the model does not search for further solutions.
        if given.columns.lubricant.is_none() {
            if control.is_none() {
                out.set(SolutionOutput::control_consistent, one);
            }
            out.set(SolutionOutput::other_solutions, zero);
        }
        let efficiency = transmission.efficiency;
        let [nut, screw] = &state.sides;
        let cotangents = [nut.cos / nut.sin, screw.cos / screw.sin];
        RacewayNumbers {
            efficiency,
            skid,
            cotangents,
            found: state.is_first_root & resolved,
            unique,
        }
    }
}

/// Returns the contact ellipse and its motion, at the nut for index 0 or at the screw for index 1.
#[inline(always)]
fn ellipse<S: Simd>(
    i: usize,
    contacts: &Contacts<S>,
    state: &RollingRoot<S>,
    motion: &RollingMotion<S>,
) -> Ellipse<S> {
    let (side, pressed) = (&state.sides[i], &contacts.pressed[i]);
    let speed = motion.speed[i];
    Ellipse {
        load: side.load,
        semi_axes: side.semi_axes(contacts.scaled.semi_axes[i]),
        pressed_radius: pressed.pressed_radius,
        speed,
        omega: [motion.omega[0], motion.spin[i], -speed],
    }
}

/// Friction losses in the contact ellipses at nut and screw.
struct RacewayLosses<S: Simd> {
    transmission: Transmission<Lane<S>>,
    /// Friction coefficient, or the equivalent friction coefficient of a lubricant.
    friction: Lane<S>,
    film: Option<FilmState<Lane<S>>>,
    /// Mask of the points at which the quadrature is fine enough for the losses. The mask must not
    /// depend on the requested outputs.
    resolved: Mask<S>,
}

/// Calculates torque, efficiency and power from the friction in both contact ellipses.
#[inline(always)]
fn losses<S: Simd>(
    given: &LaneInputs<'_, S>,
    (units, contacts): (&Units<S>, &Contacts<S>),
    (state, motion): (&RollingRoot<S>, &RollingMotion<S>),
) -> RacewayLosses<S> {
    let (nut, screw) = (ellipse(0, contacts, state, motion), ellipse(1, contacts, state, motion));
    let back = units.speed.below(0.0);
    let lubricated = OilLane::of(given, (units, contacts), (state, motion), [&nut, &screw]);
    let (loss, friction, resolved) = if let Some(lubricated) = &lubricated {
        (lubricated.loss(), lubricated.friction_scale(), lubricated.resolved)
    } else {
        let ((at_nut, nut_resolved), (at_screw, screw_resolved)) = (nut.power(), screw.power());
        let friction = given.get(InputKey::friction_coefficient);
        let loss = friction_power(friction, [nut.load, screw.load], [at_nut, at_screw]);
        (loss, friction, nut_resolved & screw_resolved)
    };
    let tan_lead = contacts.scaled.lead.0 / contacts.scaled.lead.1;
    let ideal = ideal_torque(units.axial, units.pitch, tan_lead);
    let mut torque = rolling_torque(ideal, back.select(-loss, loss), units.ball, units.axial);
    if let Some(lubricated) = &lubricated {
        torque = torque + lubricated.outside.torque(units.speed);
    }
    let transmission = Transmission::of(back, ideal, torque, units.speed);
    let mut film = None;
    if let Some(lubricated) = &lubricated {
        film = Some(lubricated.state(LubricatedScrew {
            power_unit: units.ball * units.speed.abs() * units.axial,
            balls: given.get(InputKey::loaded_balls),
            outside: lubricated.outside,
            back,
            tan_a: tan_lead,
            efficiency: transmission.efficiency,
        }));
    }
    let finite = torque.abs().below(f64::INFINITY);
    RacewayLosses { transmission, friction, film, resolved: resolved & finite }
}

/// Stores skid number and onset number at the points where they are defined. Returns the onset
/// number and the slip across the groove.
#[inline(always)]
fn regime<S: Simd>(
    out: &mut Sink<'_, '_>,
    friction: Lane<S>,
    contacts: &Contacts<S>,
    (state, motion): (&RollingRoot<S>, &RollingMotion<S>),
) -> [Lane<S>; 2] {
    let [skid, cross] = motion.skid_numbers(&contacts.scaled, friction, &state.sides);
    let onset = onset_number(skid, cross);
    let none = skid.constant(f64::NAN);
    out.set(SolutionOutput::skid_number, skid.below(f64::INFINITY).select(skid, none));
    out.set(SolutionOutput::onset_number, onset.below(f64::INFINITY).select(onset, none));
    [onset, cross]
}
