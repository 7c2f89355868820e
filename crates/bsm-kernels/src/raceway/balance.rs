//! Static balance of the rolling ball by lanes, and which raceway controls.

use bsm_dyn::internals::{StaticBalance, rolling, spread_of_control};
use bsm_dyn::{Control, RacewayControl};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::operand::{Lane, Mask};
use crate::pair::{Balls, LaneContact};

/// Spin moments nearer to each other than this do not decide which raceway controls, nor cotangents
/// nearer to zero which flank carries.
const TIE: f64 = 1e-9;

/// A lane of rolling balls.
pub(crate) struct Roll<S: Simd> {
    /// Where the nut controls.
    pub(crate) by_nut: Mask<S>,
    pub(crate) sides: [LaneContact<S>; 2],
    /// `$\sin(\beta_B - \beta_A)$`.
    pub(crate) twist: Lane<S>,
    pub(crate) steps: Lane<S>,
    pub(crate) residual: Lane<S>,
    /// Where it is the first one, and where there is no other.
    pub(crate) found: Mask<S>,
    pub(crate) unique: Mask<S>,
}

/// The rolling balls of a lane, with the raceway that controls or by the decision: a call of its own, as two kernels
/// share it.
pub(crate) struct BalanceCall<'a, S: Simd> {
    pub(crate) pair: &'a Balls<S>,
    pub(crate) control: Option<Control>,
}

impl<S: Simd> NullaryFnOnce for BalanceCall<'_, S> {
    type Output = Roll<S>;

    #[inline(always)]
    fn call(self) -> Roll<S> {
        let Self { pair, control } = self;
        let zero = pair.constant(0.0);
        let by_nut = match control {
            Some(Control::Screw) => zero.lt(zero),
            Some(Control::Nut) | None => zero.le(zero),
        };
        let mut balance = StaticBalance::of(&pair.scaled, by_nut);
        let inertia = pair.scaled.inertia_ratio() * (pair.scaled.nut_speed.abs() + 1.0);
        // Beyond, the precession, which the angles change by tenths, may turn the slope of the radial balance.
        let unique = inertia.lt(zero.constant(RacewayControl::UNIQUE_BELOW));
        let mut at = balance.start(pair.cos_b / pair.sin_b, pair.regular);
        balance.settle(&mut at);
        let mut found = pair.regular & at.settled & (unique | balance.is_first(at.unknowns));
        if control.is_none() {
            let sides = balance.loaded(at.unknowns);
            let excess = pair.nut_excess(&sides);
            balance.by_nut = zero.lt(excess);
            found = found & excess.abs().gt(apart(pair, &sides) * RacewayControl::CLEAR + TIE);
            at.settled = at.settled & balance.by_nut | !found;
            balance.settle(&mut at);
            found = found & at.settled & (unique | balance.is_first(at.unknowns));
        }
        let sides = balance.loaded(at.unknowns);
        let [a, b] = &sides;
        let residual = balance.scaled_residual(at.unknowns);
        let on_flanks = a.cot.min(b.cot).gt(zero.constant(TIE));
        let closed = residual.lt(zero.constant(StaticBalance::<Lane<S>>::CLOSED));
        let found = found & on_flanks & closed;
        let twist = b.sin * a.cos - b.cos * a.sin;
        Roll { by_nut: balance.by_nut, sides, twist, steps: at.steps, residual, found, unique }
    }
}

/// By how much the cotangents differ between the balls of both raceways, to first order.
#[inline(always)]
fn apart<S: Simd>(pair: &Balls<S>, [a, b]: &[LaneContact<S>; 2]) -> Lane<S> {
    let (zero, lead) = (pair.constant(0.0), pair.scaled.lead);
    let angles = [(a.sin, a.cos), (b.sin, b.cos)];
    let (nut, _) = rolling(zero.le(zero), lead, pair.scaled.arc, angles);
    let (screw, _) = rolling(zero.lt(zero), lead, pair.scaled.arc, angles);
    let rates = [screw - nut, screw + nut + pair.scaled.nut_speed * 2.0];
    spread_of_control(pair.scaled.inertia_ratio(), pair.scaled.lead.1, rates)
}
