//! Rolling, partial and gross slip in one model: friction integrated over the contact ellipses.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T9) to (T11).

mod path;
mod root;
mod scatter;
mod sensitivities;

use std::num::NonZeroUsize;

use bsm_kin::{Motion, Scalar};
use bsm_newton::{EvalError, Options, Report, Scales, solve};

use self::path::PATH;
pub(crate) use self::root::Root;
use crate::ball_unknowns::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::ball_unknowns::{BALL, ROWS, weight};
use crate::elastic_ball::{ElasticBall, ElasticScrew, Loaded};
use crate::ellipse::{Lanes, Local, Quadrature};
use crate::equations::{Workspace, equations};
use crate::raceway_control::{Grip, STATIC};
use crate::{
    BallState, Model, SkidNumbers, Solution, SolveInfo, Solved, Transmission, Unsolved, Wrench,
    cost,
};

/// Places of the angular velocity along `$k$`, `$n$` and `$k \times n$` (T4).
const OMEGA: [usize; 3] = [4, 5, 6];

/// Order that [`Traction::solve_to`] begins with.
const COARSEST: NonZeroUsize = NonZeroUsize::new(4).expect("not zero");

const TWO: NonZeroUsize = NonZeroUsize::new(2).expect("not zero");

/// A solve may take this many steps.
const MOST_STEPS: usize = 20;

/// Inputs of the traction model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traction<D = f64> {
    /// The screw at its operating point; friction positive.
    pub screw: ElasticScrew<D>,
    /// Order of the quadrature over the ellipses.
    pub order: NonZeroUsize,
    /// Creep speed `$v_e$` over `$r_b |W|$`, positive.
    pub creep: f64,
}

impl Traction {
    /// Order that leaves an error of 1e-7 in the efficiency of a screw like Lin's; long ellipses
    /// with much spin need more, see the choice by error bounds.
    pub const ORDER: NonZeroUsize = NonZeroUsize::new(12).expect("not zero");
    /// Creep speed that moves the efficiency of most screws by less than 1e-6.
    pub const CREEP: f64 = 1e-4;
}

/// Memory of the solves.
pub struct TractionWorkspace {
    statics: Workspace<STATIC>,
    newton: Workspace,
    path: Workspace<PATH>,
    quadratures: Vec<(NonZeroUsize, Quadrature)>,
}

impl Default for TractionWorkspace {
    fn default() -> Self {
        let (statics, newton) = (Workspace::default(), Workspace::default());
        Self { statics, newton, path: Workspace::default(), quadratures: Vec::new() }
    }
}

impl TractionWorkspace {
    /// Place of the quadrature of an order, made when it is first asked for.
    fn quadrature(&mut self, order: NonZeroUsize) -> usize {
        self.quadratures.iter().position(|(known, _)| *known == order).unwrap_or_else(|| {
            self.quadratures.push((order, Quadrature::new(order)));
            self.quadratures.len() - 1
        })
    }
}

/// The equations of a point.
struct Rolling<'a, P = f64> {
    pair: &'a ElasticBall<P>,
    quadrature: &'a Quadrature,
    creep: f64,
    /// The unknowns are those of a ball that is thrown against the nut (T10).
    at_nut: bool,
}

struct State<D> {
    loaded: Loaded<D>,
    to_nut: Motion<D>,
    wrench: [Wrench<D>; 2],
}

impl<P: Scalar> Rolling<'_, P> {
    fn state<D: Lanes<P>>(&self, y: &[D; BALL]) -> Result<State<D>, EvalError> {
        self.rubbed(y, D::from(self.pair.friction))
    }

    /// The state with another friction coefficient.
    fn rubbed<D: Lanes<P>>(&self, y: &[D; BALL], friction: D) -> Result<State<D>, EvalError> {
        cost::evaluated();
        let pair = self.pair;
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        let loaded = if self.at_nut {
            // (Q_A/F_a, β_A, Q_B/F_a, (P − Ω_n)/|W|, …)                   (T10)
            pair.loaded_at_nut(loads, y[TILT])?
        } else {
            pair.loaded(loads, y[TILT])?
        };
        // ω' = ω'_k k + ω'_n n + ω'_c k × n                               (T4)
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        let [along, radial, around] = OMEGA.map(|i| y[i]);
        let omega = k * along + n * radial + k.cross(&n) * around;
        let to_nut = Motion { precession: y[PRECESSION] + (self.offset() - pair.nut_speed), omega };
        let motions = pair.relative(&to_nut, &loaded.frame);
        let wrench = std::array::from_fn(|i| {
            let contact = &loaded.contacts[i];
            let local = Local::of(&motions[i], contact, D::from(pair.arc));
            let ellipse = pair.ellipse(i, &loaded);
            let unit = D::integrate(&ellipse, &local, self.creep, self.quadrature);
            // F = Q N + f Q ∫ dF,  M = f Q ∫ dM                            (T2)
            let pull = loaded.loads[i] * friction;
            let friction = unit.wrench(contact);
            Wrench {
                force: contact.normal * loaded.loads[i] + friction.force * pull,
                moment: friction.moment * pull,
            }
        });
        Ok(State { loaded, to_nut, wrench })
    }

    /// What the unknown of the precession leaves out of its rate: the nut's speed where that is far
    /// above the relative speed, so that neither the rate nor the slip loses its digits, or where the
    /// ball all but sticks to the nut.
    fn offset(&self) -> P {
        let nut = self.pair.nut_speed;
        if self.at_nut || nut.re().abs() > 2.0 { nut } else { P::from(0.0) }
    }

    fn residual<D: Lanes<P>>(&self, y: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        let rate = y[PRECESSION] + self.offset();
        Ok(self.left(y, &self.state(y)?, rate))
    }

    /// What the balance leaves over, with the inertia forces of a precession rate.
    fn left<D: Lanes<P>>(&self, y: &[D; BALL], state: &State<D>, rate: D) -> [D; BALL] {
        // k × ω = ω'_n k × n − ω'_c n                                     (T5)
        let [_, radial, around] = OMEGA.map(|i| y[i]);
        let n = state.loaded.frame.n;
        let omega = n * radial + state.loaded.frame.k.cross(&n) * around;
        self.pair.balance(&state.loaded, &Motion { precession: rate, omega }, &state.wrench)
    }
}

impl Rolling<'_> {
    /// The unknowns (T1) of a state.
    fn unknowns(&self, loaded: &Loaded<f64>, to_nut: &Motion<f64>) -> [f64; BALL] {
        let mut y = [0.0; BALL];
        [y[NUT_LOAD], y[SCREW_LOAD]] = loaded.loads;
        y[TILT] = if self.at_nut { loaded.angles[0] } else { loaded.tilt };
        y[PRECESSION] = to_nut.precession + self.pair.nut_speed - self.offset();
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        for (place, axis) in OMEGA.iter().zip([k, n, k.cross(&n)]) {
            y[*place] = to_nut.omega.dot(&axis);
        }
        y
    }

    /// Weights of the equations.
    fn weights(&self, y: &[f64; BALL]) -> [f64; BALL] {
        self.weights_of(y, self.pair.friction, y[PRECESSION] + self.offset())
    }

    /// The same with the friction and the inertia forces of a path.
    fn weights_of(&self, y: &[f64; BALL], friction: f64, rate: f64) -> [f64; BALL] {
        // D_F = diag(w, w₀, w, w/(f h), w/(f h), w/(f h), w)              (T3)
        let thrown = self.pair.inertia_ratio() * rate * rate;
        let across =
            if self.at_nut { thrown.min(self.rubbing(y, friction, thrown)) } else { thrown };
        let [pressing, across] = [thrown, across].map(|size| size.max(1.0));
        let (force, moment) = (weight(across), weight(across * friction.min(1.0) * self.lever(y)));
        [force, weight(pressing), force, moment, moment, moment, force]
    }

    /// Size of the friction at the nut that the digits of its slip are worth.
    fn rubbing(&self, y: &[f64; BALL], friction: f64, load: f64) -> f64 {
        // f C (|P − Ω_n| r_m + |ω'|)/v_e                                  (T11)
        let turning = OMEGA.iter().map(|i| y[*i].abs()).sum::<f64>();
        let slip = y[PRECESSION].abs() * self.pair.helix.radius + turning;
        friction * load * slip / self.creep
    }

    /// Lever arm of friction over the ball radius `$h$`, that of the ends of ellipses longer than the
    /// ball.
    fn lever(&self, y: &[f64; BALL]) -> f64 {
        let pair = self.pair;
        let lever = |i: usize, load: f64| {
            let a = pair.semi_axes[i].0 * load.cbrt();
            a.max(pair.depth(i, a))
        };
        lever(0, y[NUT_LOAD]).max(lever(1, y[SCREW_LOAD])).max(1.0)
    }

    /// One damped Newton solve from `y`.
    fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
        let weights = self.weights(y);
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        let options = Options { residual_goal: 1e-13, max_steps: MOST_STEPS, ..Options::default() };
        solve(self, y, &scales, &options, newton)
    }
}

equations!(Rolling<'_>, BALL, Rolling::residual, ROWS);

impl Traction {
    /// Solves for the steady motion of the ball.
    ///
    /// Orders above [`Traction::ORDER`] refine the root of that order: whether there is a root is
    /// decided there, where it costs little.
    pub fn solve(&self, work: &mut TractionWorkspace) -> Solution {
        let found = self.screw.require_friction().and_then(|()| {
            let pair = self.screw.scaled()?;
            let grip = Grip::of(&pair, None, &mut work.statics);
            let start = Start::new(&pair, grip.ok().as_ref())?;
            let coarse = Self { order: self.order.min(Self::ORDER), ..*self };
            let mut found = coarse.found(&start, None, work)?;
            if coarse.order < self.order {
                let steps = found.info.steps - start.grip.steps;
                found = self.found(&start, Some(&found.root), work)?;
                found.info.steps += steps;
            }
            Ok(found.solved())
        });
        Solution::new(Model::Traction, found)
    }

    /// Solves with orders from 4 on, each twice the last, until the error of the efficiency is at
    /// most `tolerance` or the order is `finest`; returns the root, its order and the error.
    ///
    /// The error is the last change of the efficiency, which is larger than what is left, and for
    /// changes that are small by chance the loss over the cube of the order (A6). Where a finer
    /// order has no root, the last one that has is returned, with the whole loss as its error.
    pub(crate) fn solve_to(
        &self,
        start: &Start<'_>,
        tolerance: f64,
        finest: NonZeroUsize,
        work: &mut TractionWorkspace,
    ) -> Result<(Found, NonZeroUsize, f64), Unsolved> {
        let mut case = Self { order: COARSEST, ..*self };
        let mut found = case.found(start, None, work);
        // A coarse quadrature may have no root where a finer one has.
        if found.is_err() {
            case.order = Self::ORDER.min(finest);
            found = case.found(start, None, work);
        }
        let mut found = found?;
        let eta = |found: &Found| found.transmission.efficiency;
        let mut error = (1.0 - eta(&found)).abs();
        let mut steps = found.info.steps;
        while case.order < finest {
            let finer = Self { order: case.order.saturating_mul(TWO).min(finest), ..case };
            let Ok(next) = finer.found(start, Some(&found.root), work) else { break };
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let order = finer.order.get() as f64;
            // |η_n − η_{n/2}| + |1 − η|/n³ + 5·10⁻⁷                        (A6)
            error =
                (eta(&next) - eta(&found)).abs() + (1.0 - eta(&next)).abs() / order.powi(3) + 5e-7;
            steps += next.info.steps - start.grip.steps;
            (case, found) = (finer, next);
            if error <= tolerance {
                break;
            }
        }
        found.info.steps = steps;
        Ok((found, case.order, error))
    }

    /// The root and its answer, from the root of another order if there is one.
    fn found(
        &self,
        Start { pair, grip }: &Start<'_>,
        from: Option<&Root>,
        work: &mut TractionWorkspace,
    ) -> Result<Found, Unsolved> {
        let quadrature = work.quadrature(self.order);
        let quadrature = &work.quadratures[quadrature].1;
        let creep = self.creep * pair.slip_scale();
        let system = Rolling { pair, quadrature, creep, at_nut: false };
        let mut steps = grip.steps;
        let root = system.find(grip, from, (&mut work.newton, &mut work.path), &mut steps)?;
        let state =
            system.of(&root).state(&root.unknowns).expect("the residual was evaluated at the root");
        let ball = self.screw.ball_state(pair, &state.loaded, &state.to_nut)?;
        let power = pair.friction_power(&state.loaded, &state.to_nut, creep, quadrature);
        let frame = &state.loaded.frame;
        let transmission = self.screw.transmission(pair, frame, &state.wrench[1], power)?;
        let info = SolveInfo { steps, residual: root.residual };
        Ok(Found { ball, transmission, skid: grip.skid(pair), info, root })
    }
}

/// A point and the gripping ball that it starts from: what does not depend on the quadrature.
pub(crate) struct Start<'a> {
    pair: &'a ElasticBall,
    grip: Grip,
}

impl<'a> Start<'a> {
    /// From a gripping ball, or from a guess where there is none.
    pub(crate) fn new(pair: &'a ElasticBall, grip: Option<&Grip>) -> Result<Self, Unsolved> {
        // Centrifugal forces may be beyond a guess; the ball without them is one too.
        let guess = || Grip::guess(pair).or_else(|_| Grip::guess(&pair.with_inertia(0.0)));
        Ok(Self { pair, grip: grip.map_or_else(guess, |grip| Ok(*grip))? })
    }
}

/// A root and its answer.
pub(crate) struct Found {
    ball: BallState,
    transmission: Transmission,
    skid: SkidNumbers,
    info: SolveInfo,
    pub(crate) root: Root,
}

impl Found {
    pub(crate) fn solved(&self) -> Solved {
        let Self { ball, transmission, skid, info, .. } = *self;
        Solved { skid: Some(skid), info: Some(info), ..Solved::new(&ball, transmission) }
    }
}

#[cfg(test)]
mod tests;
