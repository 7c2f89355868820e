//! Static balance, controlling raceway and motion of the rolling ball for lanes.

use bsm_dyn::internals::{StaticBalance, StaticState, rolling, spread_of_control};
use bsm_dyn::{Control, RacewayControl};
use bsm_kin::{relative_rotation, spin_at_nut};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::contacts::{Contacts, LaneContact};
use crate::operand::{Lane, Mask};

/// Relative difference of spin moments below which the controlling raceway is undecided, and
/// cotangent below which the loaded flank is undecided.
const TIE: f64 = 1e-9;

/// Roots of the static balances of a lane.
pub(crate) struct BalanceRoot<S: Simd> {
    /// Mask of the points at which the nut controls.
    pub(crate) by_nut: Mask<S>,
    pub(crate) sides: [LaneContact<S>; 2],
    pub(crate) steps: Lane<S>,
    pub(crate) residual: Lane<S>,
    /// Masks of the points at which it is the first root, and at which there is no other root.
    pub(crate) found: Mask<S>,
    pub(crate) unique: Mask<S>,
}

/// Motion of the ball relative to the nut, divided by `$W$`.
pub(crate) struct RollingMotion<S: Simd> {
    pub(crate) p: Lane<S>,
    /// Angular velocity about n and b. About t it is `$\sin\alpha/2$` (W3).
    pub(crate) omega: [Lane<S>; 2],
    /// Speed of the center relative to nut and screw. The ball rotates about `$t \times N$` in the
    /// opposite sense.
    pub(crate) speed: [Lane<S>; 2],
    /// Angular velocity about `$N$`, relative to nut and screw.
    pub(crate) spin: [Lane<S>; 2],
}

impl<S: Simd> RollingMotion<S> {
    #[inline(always)]
    pub(crate) fn of(contacts: &Contacts<S>, state: &BalanceRoot<S>) -> Self {
        let ([a, b], by_nut, one) = (&state.sides, state.by_nut, contacts.constant(1.0));
        let lead = contacts.scaled.lead;
        let (p, to_nut) =
            rolling(by_nut, lead, contacts.scaled.arc, [(a.sin, a.cos), (b.sin, b.cos)]);
        let (zero, to_screw) = (contacts.constant(0.0), relative_rotation(to_nut, one, lead));
        let nut_spin = spin_at_nut(to_nut, (a.sin, a.cos));
        let screw_spin = -spin_at_nut(to_screw, (b.sin, b.cos));
        Self {
            p,
            omega: [to_nut[1], to_nut[2]],
            speed: [p * contacts.scaled.arc, (p - 1.0) * contacts.scaled.arc],
            spin: [by_nut.select(zero, nut_spin), by_nut.select(screw_spin, zero)],
        }
    }
}

/// Solves the rolling balls of a lane, with a given controlling raceway or with the raceway that
/// controls by its spin moment. It is a separate call because two kernels share it.
pub(crate) struct BalanceCall<'a, S: Simd> {
    pub(crate) contacts: &'a Contacts<S>,
    pub(crate) control: Option<Control>,
}

impl<S: Simd> NullaryFnOnce for BalanceCall<'_, S> {
    type Output = BalanceRoot<S>;

    #[inline(always)]
    fn call(self) -> BalanceRoot<S> {
        let Self { contacts, control } = self;
        let zero = contacts.constant(0.0);
        let by_nut = match control {
            Some(Control::Screw) => zero.lt(zero),
            Some(Control::Nut) | None => zero.le(zero),
        };
        let unloaded = contacts.cos_b / contacts.sin_b;
        let mut balance = StaticBalance::of(&contacts.scaled, by_nut);
        let mut at = balance.start(unloaded, contacts.regular);
        balance.iterate(&mut at);
        let first = balance.is_first(at.unknowns);
        let mut found = contacts.regular & at.converged;
        let mut unique;
        if control.is_some() {
            unique = balance.is_unique(unloaded, found);
            found = found & (unique | first);
        } else {
            let sides = balance.loaded(at.unknowns);
            let (excess, tie) = (contacts.nut_excess(&sides), zero.constant(TIE));
            let nut = tie.lt(excess);
            unique = balance.is_unique(unloaded, found & (nut | !first));
            found = found & (unique | first) & excess.abs().gt(tie);
            balance.by_nut = nut;
            let screw = StaticBalance::of(&contacts.scaled, zero.lt(zero));
            let by_screw = screw.is_unique(unloaded, found);
            // Checks whether the screw also controls the ball calculated with screw control.
            let close = excess.le(cotangent_difference(contacts, &sides) * RacewayControl::CLEAR);
            let close = found & nut & close;
            if close.any() {
                let mut other = StaticState { converged: !close, ..at };
                screw.iterate(&mut other);
                let on_flanks = zero.lt(other.unknowns[1]);
                let first = by_screw & on_flanks | screw.is_first(other.unknowns);
                let by_nut = tie.lt(contacts.nut_excess(&screw.loaded(other.unknowns)));
                found = found & (!close | other.converged & first & by_nut);
            }
            at.converged = at.converged & balance.by_nut | !found;
            balance.iterate(&mut at);
            // If the screw controls, the ball calculated with nut control counts as another
            // solution.
            unique = by_screw & (unique | !balance.by_nut);
            found =
                found & at.converged & (by_screw | balance.by_nut | balance.is_first(at.unknowns));
        }
        let sides = balance.loaded(at.unknowns);
        let [a, b] = &sides;
        let residual = balance.scaled_residual(at.unknowns);
        let on_flanks = a.cot.min(b.cot).gt(zero.constant(TIE));
        let closed = residual.lt(zero.constant(StaticBalance::<Lane<S>>::CLOSED));
        let mut found = found & on_flanks & closed;
        if control.is_none() {
            // The raceway that was chosen with nut control must also control the final ball.
            let excess = contacts.nut_excess(&sides);
            let excess = balance.by_nut.select(excess, -excess);
            found = found & zero.constant(TIE).lt(excess);
        }
        BalanceRoot { by_nut: balance.by_nut, sides, steps: at.steps, residual, found, unique }
    }
}

/// Returns the difference of the cotangents between the solutions for both raceways, to first
/// order.
#[inline(always)]
fn cotangent_difference<S: Simd>(contacts: &Contacts<S>, [a, b]: &[LaneContact<S>; 2]) -> Lane<S> {
    let (zero, lead) = (contacts.constant(0.0), contacts.scaled.lead);
    let angles = [(a.sin, a.cos), (b.sin, b.cos)];
    let (nut, _) = rolling(zero.le(zero), lead, contacts.scaled.arc, angles);
    let (screw, _) = rolling(zero.lt(zero), lead, contacts.scaled.arc, angles);
    let rates = [screw - nut, screw + nut + contacts.scaled.nut_speed * 2.0];
    spread_of_control(contacts.scaled.inertia_ratio(), contacts.scaled.lead.1, rates)
}
