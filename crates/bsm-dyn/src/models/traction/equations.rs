//! The equations of a ball between elastic raceways whose friction is integrated over the contact ellipses, in any scalar.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T10), (T11).

use std::array::from_fn;
use std::cell::OnceCell;

use bsm_kin::{Field, Motion, Scalar};
use bsm_newton::{Backtracking, Convergence, EvalError, JacobianUpdate, Options};
use bsm_simd::Compare;

use super::push::Push;
use crate::contact::Wrench;
use crate::cost;
use crate::ellipse::{ContactMotion, FrozenRule, Integrate, Placement, Quadrature, surface_drop};
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{BALL, BallLoads, EhlLoss, EhlPoint, ElasticContacts, to_both, weight};

/// Places of the angular velocity along `$k$`, `$n$` and `$k \times n$` (T4).
pub(super) const OMEGA: [usize; 3] = [4, 5, 6];

/// Accuracies of the quadrature: of the first try, and of the search for what it does not find, whose sums
/// change smoothly enough to be followed.
pub(crate) const COARSE: f64 = 1e-4;
pub(crate) const SEARCH: f64 = 1e-6;
/// Residual from which the first try is left to the quadrature that is asked for.
pub(crate) const COARSE_RESIDUAL: f64 = 1e-3;
/// Residual from which a last step, which is not evaluated, leads to the root.
pub(super) const ROOT: f64 = 1e-10;
/// Residual below which steps keep the Jacobian; that whose square is enough, if it is larger.
const KEEP: f64 = 1e-3;

/// Nut speed over the relative speed from which the unknown of the precession leaves it out.
pub const FAST_NUT: f64 = 2.0;

/// A solve may take this many steps and halvings of a step.
const LIMITS: (usize, u32) = (20, 6);

/// The equations of a point.
#[derive(Clone, Copy)]
pub(super) struct SlipBall<'a, P = f64> {
    pub(super) contacts: &'a ElasticContacts<P>,
    pub(super) quadrature: &'a Quadrature,
    /// Numbers of nodes near a root; by the slip elsewhere.
    pub(super) frozen_rules: Option<&'a [OnceCell<FrozenRule>; 2]>,
    pub(super) creep: f64,
    /// The residual that is small enough for a root, and the one that is aimed at.
    pub(super) enough: f64,
    /// The unknowns are those of a ball under a high centrifugal load (T10).
    pub(super) nut_chart: bool,
    /// What friction comes from, unless it has one coefficient.
    pub(super) lubrication: Option<Lubrication<'a, P>>,
    /// Of its neighbours.
    pub(super) push: Option<Push>,
    /// Steps and halvings of a step after which a solve is given up.
    pub(super) limits: (usize, u32),
}

/// Friction by a lubricant.
#[derive(Clone, Copy)]
pub(super) struct Lubrication<'a, P = f64> {
    pub(super) ehl: &'a EhlPoint<P>,
    /// Part of the friction that comes from it; the rest has one coefficient.
    pub(super) fraction: f64,
    /// Derivatives of all that changes, by jets; else without those that hardly matter, by hand.
    pub(super) complete: bool,
}

pub(super) struct SlipState<D> {
    pub(super) loaded: BallLoads<D>,
    pub(super) to_nut: Motion<D>,
    pub(super) wrench: [Wrench<D>; 2],
    /// That friction takes, and that of sliding at nut and screw; without derivatives.
    pub(super) power: f64,
    pub(super) sliding: [f64; 2],
    /// What a lubricant does.
    pub(super) losses: Option<[EhlLoss<D>; 2]>,
}

impl<P: Scalar> SlipBall<'_, P> {
    pub(super) fn state<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<SlipState<D>, EvalError> {
        self.contact_wrenches(y, D::from(self.contacts.friction))
    }

    /// Contacts of a state.
    pub(super) fn loaded<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<BallLoads<D>, EvalError> {
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        if self.nut_chart {
            // (Q_A/F_a, β_A, Q_B/F_a, (P − Ω_n)/W, …)                     (T10)
            self.contacts.loaded_by_nut_angle(loads, y[TILT])
        } else {
            self.contacts.loaded(loads, y[TILT])
        }
    }

    /// Motion relative to the nut.
    pub(super) fn motion_to_nut<D: Integrate<P>>(
        &self,
        y: &[D; BALL],
        loaded: &BallLoads<D>,
    ) -> Motion<D> {
        // ω' = ω'_k k + ω'_n n + ω'_c k × n                               (T4)
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        let [along, radial, around] = OMEGA.map(|i| y[i]);
        let omega = k * along + n * radial + k.cross(&n) * around;
        Motion {
            precession: y[PRECESSION] + (self.offset() - self.contacts.scaled.nut_speed),
            omega,
        }
    }

    /// The state with another friction coefficient.
    pub(super) fn contact_wrenches<D: Integrate<P>>(
        &self,
        y: &[D; BALL],
        friction: D,
    ) -> Result<SlipState<D>, EvalError> {
        cost::evaluated();
        let (contacts, loaded) = (self.contacts, self.loaded(y)?);
        let to_nut = self.motion_to_nut(y, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let (mut power, mut sliding) = (0.0, [0.0; 2]);
        let fraction = self.lubrication.map_or(0.0, |lubrication| lubrication.fraction);
        let mut wrench = [Wrench::zero(); 2];
        if fraction < 1.0 {
            wrench = from_fn(|i| {
                let contact = &loaded.contacts[i];
                let local = ContactMotion::of(&motions[i], contact, D::from(contacts.scaled.arc));
                let ellipse = contacts.ellipse(i, &loaded);
                let (unit, unit_power) = D::integrate(&ellipse, &local, self.creep, self.nodes(i));
                let pull = loaded.loads[i] * contacts.signed(friction);
                // P_f = Σ f Q ∫ dP                                        (P7)
                sliding[i] = pull.re() * unit_power;
                power += sliding[i];
                // f Q ∫ dF,  f Q ∫ dM                                     (T2)
                unit.wrench(contact) * (pull * (1.0 - fraction))
            });
        }
        let losses = self.lubrication.map(|Lubrication { ehl, .. }| {
            let of = (contacts, &loaded);
            from_fn(|i| ehl.loss(i, of, &motions[i], self.creep, self.nodes(i)))
        });
        if let Some(losses) = &losses {
            // ∫ dF + F_h,  ∫ r × dF + r × F_h + C_h                       (Y32)
            wrench = from_fn(|i| wrench[i] + losses[i].wrench * D::from(fraction));
            sliding = losses.each_ref().map(|loss| loss.sliding.re());
            power = losses.iter().map(|loss| (loss.sliding + loss.rolling).re()).sum();
        }
        // F = Q N + f Q ∫ dF                                              (T2)
        for (wrench, (contact, load)) in
            wrench.iter_mut().zip(loaded.contacts.iter().zip(loaded.loads))
        {
            wrench.force = contact.normal * load + wrench.force;
        }
        Ok(SlipState { loaded, to_nut, wrench, power, sliding, losses })
    }

    /// The nodes at nut (0) or screw (1).
    pub(super) fn nodes(&self, i: usize) -> Placement<'_> {
        Placement {
            rule: self.quadrature,
            frozen_rule: self.frozen_rules.map(|rules| &rules[i]),
            coarse: self.is_first_try() && self.lubrication.is_none(),
        }
    }

    /// True if its root is only a start for another quadrature or creep speed.
    pub(super) fn is_first_try(&self) -> bool {
        self.enough >= COARSE_RESIDUAL
    }

    /// What the unknown of the precession leaves out of its rate: the nut's speed where that is far
    /// above the relative speed, so that neither the rate nor the slip loses its digits, or where the
    /// ball all but sticks to the nut.
    pub(super) fn offset(&self) -> P {
        let nut = self.contacts.scaled.nut_speed;
        if self.nut_chart || nut.re().abs() > FAST_NUT { nut } else { P::from(0.0) }
    }

    pub(super) fn residual<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        let rate = y[PRECESSION] + self.offset();
        Ok(self.residual_of(y, &self.state(y)?, rate))
    }

    /// What the balance leaves over, with the inertia forces of a precession rate.
    pub(super) fn residual_of<D: Integrate<P>>(
        &self,
        y: &[D; BALL],
        state: &SlipState<D>,
        rate: D,
    ) -> [D; BALL] {
        // k × ω = ω'_n k × n − ω'_c n                                     (T5)
        let [_, radial, around] = OMEGA.map(|i| y[i]);
        let n = state.loaded.frame.n;
        let omega = n * radial + state.loaded.frame.k.cross(&n) * around;
        let mut residual = self.contacts.balance(
            &state.loaded,
            &Motion { precession: rate, omega },
            &state.wrench,
        );
        if let Some(push) = &self.push {
            push.add_to(&mut residual, self.contacts, (&state.loaded, &state.to_nut));
        }
        residual
    }
}

impl<'a, P> SlipBall<'a, P> {
    /// In the unknowns (T1).
    pub(super) fn of_contacts(
        contacts: &'a ElasticContacts<P>,
        quadrature: &'a Quadrature,
        creep: f64,
    ) -> Self {
        Self {
            contacts,
            quadrature,
            frozen_rules: None,
            creep,
            enough: 1e-12,
            nut_chart: false,
            lubrication: None,
            push: None,
            limits: LIMITS,
        }
    }

    /// Of a Newton solve.
    pub(super) fn options(&self) -> Options {
        let (max_steps, max_halvings) = self.limits;
        let by_jets = self.lubrication.as_ref().is_some_and(|lubrication| lubrication.complete);
        let chord_below = if by_jets { 0.0 } else { self.enough.sqrt().max(KEEP) };
        Options {
            convergence: Convergence {
                residual_tol: self.enough.max(ROOT),
                residual_goal: self.enough,
                max_steps,
            },
            damping: Backtracking { max_halvings },
            jacobian: JacobianUpdate::EveryTrial { chord_below },
        }
    }
}

impl SlipBall<'_> {
    /// The unknowns (T1) of a state.
    pub(super) fn unknowns(&self, loaded: &BallLoads<f64>, to_nut: &Motion<f64>) -> [f64; BALL] {
        let mut y = [0.0; BALL];
        [y[NUT_LOAD], y[SCREW_LOAD]] = loaded.loads;
        y[TILT] = if self.nut_chart { loaded.angles[0] } else { loaded.tilt };
        y[PRECESSION] = to_nut.precession + self.contacts.scaled.nut_speed - self.offset();
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        for (place, axis) in OMEGA.iter().zip([k, n, k.cross(&n)]) {
            y[*place] = to_nut.omega.dot(&axis);
        }
        y
    }

    /// The precession over `$W$`.
    pub(super) fn rate(&self, y: &[f64; BALL]) -> f64 {
        y[PRECESSION] + self.offset()
    }

    /// Weights of the equations.
    pub(super) fn weights(&self, y: &[f64; BALL]) -> [f64; BALL] {
        self.weights_of(y, self.contacts.friction, self.rate(y))
    }

    /// The same with the friction and the inertia forces of a path.
    pub(super) fn weights_of(&self, y: &[f64; BALL], friction: f64, rate: f64) -> [f64; BALL] {
        let centrifugal = self.contacts.inertia_ratio() * rate * rate;
        let across = if self.nut_chart {
            centrifugal.min(self.friction_force(y, friction, centrifugal))
        } else {
            centrifugal
        };
        let (force, moment) = sizes(across, friction, self.lever(y));
        let [force, pressing, moment] = [force, centrifugal.max(1.0), moment].map(weight);
        [force, pressing, force, moment, moment, moment, force]
    }

    /// Size of the friction at the nut that the digits of its slip are worth.
    fn friction_force(&self, y: &[f64; BALL], friction: f64, load: f64) -> f64 {
        // f C (|P − Ω_n| r_m + |ω'|)/v_e                                  (T11)
        let turning = OMEGA.iter().map(|i| y[*i].abs()).sum::<f64>();
        let slip = y[PRECESSION].abs() * self.contacts.helix.radius + turning;
        friction * load * slip / self.creep
    }

    /// Lever arm of friction over the ball radius.
    pub(super) fn lever(&self, y: &[f64; BALL]) -> f64 {
        let lengths = [(0, NUT_LOAD), (1, SCREW_LOAD)]
            .map(|(i, load)| self.contacts.scaled.semi_axes[i].0 * Field::cbrt(y[load]));
        lever(lengths, self.contacts.scaled.pressed_radius)
    }
}

/// Lever arm of friction over the ball radius `$h$`, that of the ends of ellipses longer than the ball.
///
/// * `semi_axes`: of the loaded ellipses.
#[inline(always)]
pub(super) fn lever<F: Compare>(semi_axes: [F; 2], pressed_radius: [F; 2]) -> F {
    let mut lever = semi_axes[0].constant(1.0);
    for i in 0..2 {
        let a = semi_axes[i];
        lever = lever.larger(a.larger(surface_drop(a, pressed_radius[i])));
    }
    lever
}

/// Sizes of the forces along t and t × N and of the moments.
///
/// * `force`: the inertia force over the load.
#[inline(always)]
pub(super) fn sizes<F: Compare>(force: F, friction: F, lever: F) -> (F, F) {
    // D_F = diag(w, w₀, w, w/(f h), w/(f h), w/(f h), w)                  (T3)
    let one = force.constant(1.0);
    let force = force.larger(one);
    (force, force * F::select(friction.lt(one), friction, one) * lever)
}
