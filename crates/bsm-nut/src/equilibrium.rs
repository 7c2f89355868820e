//! The nut under load: the least of a convex energy.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U2) to (U4) and (U15) to (U17).

use std::array::from_fn;

use bsm_dyn::{Reason, Status};
use bsm_newton::{Bordered, DynamicDense, LinearSolver};

use crate::ball::{BallInGrooves, FourContacts, on_one_diagonal};
use crate::bodies::Spring;
use crate::geometry::{BallNut, Place, count};

/// Displacements of a rigid body but the rotation about the axis: `$u_z, u_x, u_y$` \[m\] and
/// `$\varphi_x, \varphi_y$` \[rad\] of the nut against the screw.
pub(crate) const FREEDOMS: usize = 5;

/// What is given of a freedom of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// Its load \[N\] or \[N·m\]; the displacement follows.
    Loaded(f64),
    /// Its displacement \[m\] or \[rad\]; the guides carry what it takes.
    Held(f64),
    /// A spring \[N/m\] or \[N·m/rad\] to the guides, and a load.
    Sprung {
        /// Its stiffness.
        stiffness: f64,
        /// The load.
        load: f64,
    },
}

impl Freedom {
    /// The load from outside; none where the displacement is given.
    fn load(self) -> f64 {
        match self {
            Self::Loaded(load) | Self::Sprung { load, .. } => load,
            Self::Held(_) => 0.0,
        }
    }

    pub(crate) fn spring(self) -> f64 {
        if let Self::Sprung { stiffness, .. } = self { stiffness } else { 0.0 }
    }
}

/// Load and guidance of a nut: along the axis, across it (x, y), and about x and y, all at the
/// reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support(pub [Freedom; FREEDOMS]);

impl Support {
    /// Loaded along the axis \[N\], and held otherwise: a table on stiff guides.
    pub fn guided(axial: f64) -> Self {
        Self([Freedom::Held(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Loaded along the axis \[N\], and free otherwise.
    pub fn free(axial: f64) -> Self {
        Self([Freedom::Loaded(0.0); FREEDOMS]).with_axial(axial)
    }

    /// The same with another load along the axis \[N\].
    #[must_use]
    pub fn with_axial(mut self, axial: f64) -> Self {
        self.0[0] = Freedom::Loaded(axial);
        self
    }
}

/// How a nut carries its load.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// `$u_z, u_x, u_y, \varphi_x, \varphi_y$` of the nut's anchor section against the screw's.
    pub displacement: [f64; FREEDOMS],
    /// Force and moment of the nut on its balls, by freedom \[N\] and \[N·m\].
    pub carried: [f64; FREEDOMS],
    /// Stiffness of the nut, all freedoms against each other, with its bodies (U17).
    pub stiffness: [[f64; FREEDOMS]; FREEDOMS],
    /// Where the balls are.
    pub places: Vec<Place>,
    /// What they carry.
    pub balls: Vec<BallInGrooves>,
    /// The groove displacement of each ball along binormal and principal normal \[m\].
    pub grooves: Vec<[f64; 2]>,
    /// Axial force of each body on its balls \[N\].
    pub bodies: Vec<f64>,
    /// Widening of the nut at each circuit \[m\]; empty for a rigid nut.
    pub widening: Vec<f64>,
    /// Newton steps.
    pub steps: usize,
    /// Largest force that is left over, over the sum of all forces.
    pub residual: f64,
}

/// Why a nut has no state under a load.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NutError {
    /// The contacts are no Hertzian ones.
    #[error("the curvatures of ball and grooves make no Hertzian contact")]
    Contact(Reason),
    /// No ball takes the load: the nut moves without end.
    #[error("nothing carries the load: the nut has moved by {moved:e} m, out of its grooves")]
    NothingCarries {
        /// Displacement at which the search ended \[m\].
        moved: f64,
    },
    /// The iteration has ended before the forces were in balance.
    #[error(
        "the forces of the balls do not balance: {residual:e} of their sum is left after {steps} steps"
    )]
    NotConverged {
        /// What is left of the sum of all forces.
        residual: f64,
        /// Newton steps.
        steps: usize,
    },
    /// The nut has no balls.
    #[error("a nut without loaded balls carries nothing")]
    NoBalls,
    /// No preload of that size can be set.
    #[error("no offset of the bodies gives a preload of {force} N")]
    NoPreload {
        /// The preload asked for \[N\].
        force: f64,
    },
}

impl NutError {
    /// What it means for an answer: refused, without a solution, or not found.
    pub fn status(&self) -> Status {
        match self {
            Self::Contact(_) | Self::NoBalls => Status::InvalidInput,
            Self::NothingCarries { .. } | Self::NoPreload { .. } => Status::NoSolution,
            Self::NotConverged { .. } => Status::NotConverged,
        }
    }
}

/// Newton steps at most; ten are usual.
const MOST_STEPS: usize = 100;

/// Forces are in balance when this part of their sum is left.
const BALANCED: f64 = 1e-12;

/// After so many steps, so much may be left: where bodies strain by millimetres, the rounding of their
/// displacements is a larger part of the approaches of the balls.
const ROUNDED: (usize, f64) = (30, 1e-10);

impl BallNut {
    /// Displacements, loads of all balls and stiffness of the nut under a load.
    ///
    /// The energy is convex, so that the loads of the balls are the only ones (U15).
    ///
    /// # Errors
    ///
    /// [`NutError`]: there are no balls, no Hertzian contacts, or nothing carries the load.
    pub fn solve(&self, support: &Support) -> Result<Equilibrium, NutError> {
        self.solve_from(support, None)
    }

    /// [`solve`](Self::solve), the search begun at the displacement of a neighbour: it saves steps and moves
    /// the answer by rounding only.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub fn solve_from(
        &self,
        support: &Support,
        start: Option<&[f64; FREEDOMS]>,
    ) -> Result<Equilibrium, NutError> {
        Assembly::of(self, support)?.solve(start)
    }

    /// An estimate of [`solve`](Self::solve) at a third of its cost: one step from equal sharing (U28).
    /// [`Equilibrium::residual`] tells how far from balance it is; where a far flank is loaded, it is no
    /// estimate.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve), and where the nut has no axial load.
    pub fn estimate(&self, support: &Support) -> Result<Equilibrium, NutError> {
        Assembly::of(self, support)?.estimate(support.0[0].load())
    }
}

/// A ball with what does not change in the iteration.
struct Seat {
    place: Place,
    /// Displacement of the groove by errors \[m\], excess of the radius \[m\].
    error: ([f64; 2], f64),
    /// The unknowns that displace the groove, with the displacement by each: the freedoms of the nut
    /// first (U4), (U5).
    couplings: Vec<(usize, [f64; 2])>,
}

impl Seat {
    /// The displacement of the groove by each freedom of the nut (U4).
    fn by_the_nut(&self) -> impl Iterator<Item = [f64; 2]> {
        self.couplings[..FREEDOMS].iter().map(|(_, by)| *by)
    }
}

/// The problem of (U15), and its state.
struct Assembly<'a> {
    nut: &'a BallNut,
    support: Support,
    ball: FourContacts,
    seats: Vec<Seat>,
    nodes: usize,
    springs: [Vec<Spring>; 2],
    /// Stiffness of the ring of each circuit; empty if the nut is rigid.
    rings: Vec<f64>,
    /// Unknowns that are given; `[Want::Newton]` with the freedoms that the guides hold,
    /// `[Want::Stiffness]` without.
    held: [Vec<bool>; 2],
    matrix: Bordered<2>,
}

/// What is put into the matrix besides energy and forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Want {
    /// The matrix of a Newton step.
    Newton = 0,
    /// The stiffness of the nut itself: nothing of its guides.
    Stiffness = 1,
    /// Nothing.
    Forces,
}

/// Energy, forces and balls of a set of unknowns.
struct State {
    energy: f64,
    /// Size of the energies that it is the sum of.
    energies: f64,
    residual: Vec<f64>,
    /// Sum of the sizes of all forces \[N\].
    forces: f64,
    balls: Vec<BallInGrooves>,
    grooves: Vec<[f64; 2]>,
}

impl<'a> Assembly<'a> {
    fn of(nut: &'a BallNut, support: &Support) -> Result<Self, NutError> {
        if nut.balls() == 0 {
            return Err(NutError::NoBalls);
        }
        let places = nut.places();
        let mut nodes: Vec<f64> = places.iter().map(|place| place.z).collect();
        nodes.sort_by(f64::total_cmp);
        let length = nodes.last().zip(nodes.first()).map_or(0.0, |(last, first)| last - first);
        // Threads may have balls at one place.
        nodes.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * length);
        let reference = nut.middle();
        let bars = [nut.nut_bar, nut.screw_bar];
        let chained = bars.iter().any(Option::is_some);
        if !chained {
            nodes.clear();
        }
        let rings: Vec<f64> = nut.ring.map_or_else(Vec::new, |ring| {
            nut.circuits.iter().map(|circuit| ring.stiffness(nut, circuit)).collect()
        });
        let (first, along) = (2 * nodes.len(), nut.helix.lead_angle.cos());
        let seat = |(number, place): (usize, Place)| {
            let by_the_nut = kinematics(nut, &place, reference);
            let mut couplings: Vec<_> = (first..).zip(by_the_nut).collect();
            if chained {
                let node = nodes.partition_point(|z| *z < place.z - 1e-9 * length);
                // cosα (n_i − s_i) along the binormal                     (U5)
                couplings.extend([(2 * node, [along, 0.0]), (2 * node + 1, [-along, 0.0])]);
            }
            if !rings.is_empty() {
                // −w_c along the principal normal                         (U5)
                couplings.push((first + FREEDOMS + place.circuit, [0.0, -1.0]));
            }
            Seat { place, error: nut.error_at(number, &place), couplings }
        };
        let seats: Vec<_> = places.into_iter().enumerate().map(seat).collect();
        let mut held = vec![false; first + FREEDOMS + rings.len()];
        let springs = from_fn(|body| {
            let Some(bar) = bars[body] else {
                held[..first].iter_mut().skip(body).step_by(2).for_each(|h| *h = true);
                return Vec::new();
            };
            let (springs, at) = bar.springs(&nodes);
            if let Some(node) = at {
                held[2 * node + body] = true;
            }
            springs
        });
        let of_the_nut = held.clone();
        for (i, freedom) in support.0.iter().enumerate() {
            held[first + i] = matches!(freedom, Freedom::Held(_));
        }
        let border = FREEDOMS + rings.len();
        Ok(Self {
            ball: nut.ball_in_grooves().map_err(NutError::Contact)?,
            matrix: Bordered::new(nodes.len(), border),
            nodes: nodes.len(),
            nut,
            support: *support,
            seats,
            springs,
            rings,
            held: [held, of_the_nut],
        })
    }

    /// Place of the first freedom among the unknowns.
    fn freedoms(&self) -> usize {
        2 * self.nodes
    }

    /// The state at `y`, and its slopes in the matrix.
    fn state(&mut self, y: &[f64], want: Want) -> Option<State> {
        let (contacts, nut) = (self.ball, self.nut);
        self.assemble(y, want, |seat, w| {
            contacts.at(w, seat.error.1, nut.circuits[seat.place.circuit].flanks)
        })
    }

    /// The same with balls that `ball_at` tells from their groove displacement.
    fn assemble(
        &mut self,
        y: &[f64],
        want: Want,
        ball_at: impl Fn(&Seat, [f64; 2]) -> Option<BallInGrooves>,
    ) -> Option<State> {
        let first = self.freedoms();
        let mut state = State {
            energy: 0.0,
            energies: 0.0,
            residual: vec![0.0; y.len()],
            forces: 0.0,
            balls: Vec::with_capacity(self.seats.len()),
            grooves: Vec::with_capacity(self.seats.len()),
        };
        let mut matrix = self.held.get(want as usize).map(|held| {
            self.matrix.clear();
            Entries { matrix: &mut self.matrix, held }
        });
        for seat in &self.seats {
            let (mut w, _) = seat.error;
            for (k, by) in &seat.couplings {
                w[0] += by[0] * y[*k];
                w[1] += by[1] * y[*k];
            }
            let ball = ball_at(seat, w)?;
            state.energy += ball.energy;
            state.energies += ball.energy.abs();
            state.forces += ball.max_load();
            for (k, by) in &seat.couplings {
                // r = Σ A_jᵀ G_j + …                                      (U15)
                state.residual[*k] += by[0] * ball.force[0] + by[1] * ball.force[1];
                let Some(matrix) = &mut matrix else { continue };
                let [[bb, bn], [_, nn]] = ball.slope;
                let (b, n) = (by[0] * bb + by[1] * bn, by[0] * bn + by[1] * nn);
                for (l, other) in &seat.couplings {
                    // H = K_q + Σ A_jᵀ V″ A_j                             (U16)
                    matrix.add(*k, *l, b * other[0] + n * other[1]);
                }
            }
            state.balls.push(ball);
            state.grooves.push(w);
        }
        let mut spring = |i: usize, other: Option<usize>, stiffness: f64| {
            let stretch = y[i] - other.map_or(0.0, |k| y[k]);
            let energy = 0.5 * stiffness * stretch * stretch;
            state.energy += energy;
            state.energies += energy;
            state.residual[i] += stiffness * stretch;
            let ends = [Some((i, 1.0)), other.map(|k| (k, -1.0))];
            if let Some(k) = other {
                state.residual[k] -= stiffness * stretch;
            }
            if let Some(matrix) = &mut matrix {
                for (a, sign) in ends.iter().flatten() {
                    for (b, other) in ends.iter().flatten() {
                        matrix.add(*a, *b, stiffness * sign * other);
                    }
                }
            }
        };
        for (body, springs) in self.springs.iter().enumerate() {
            for each in springs {
                match *each {
                    Spring::Between(i, k) => spring(2 * i + body, Some(2 * (i + 1) + body), k),
                    Spring::Held(i, k) => spring(2 * i + body, None, k),
                }
            }
        }
        for (circuit, stiffness) in self.rings.iter().enumerate() {
            spring(first + FREEDOMS + circuit, None, *stiffness);
        }
        for (i, freedom) in self.support.0.iter().enumerate() {
            // What the guides do to the nut is no stiffness of the nut.
            if freedom.spring() > 0.0 && want != Want::Stiffness {
                spring(first + i, None, freedom.spring());
            }
        }
        for (i, freedom) in self.support.0.iter().enumerate() {
            let load = freedom.load();
            state.energy -= load * y[first + i];
            state.energies += (load * y[first + i]).abs();
            state.residual[first + i] -= load;
            // A moment as a force at the balls.
            let arm = if i < 3 { 1.0 } else { self.nut.helix.radius };
            state.forces += load.abs() / arm;
        }
        if let Some(Entries { matrix, held }) = matrix {
            for (i, _) in held.iter().enumerate().filter(|(_, held)| **held) {
                matrix.add(i, i, 1.0);
            }
        }
        for (residual, held) in state.residual.iter_mut().zip(&self.held[0]) {
            if *held {
                *residual = 0.0;
            }
        }
        Some(state)
    }

    /// What is left of the forces, over the sum of their sizes.
    fn imbalance(&self, state: &State) -> f64 {
        let tilts = self.freedoms() + 3..self.freedoms() + FREEDOMS;
        let force = |(i, r): (usize, &f64)| {
            if tilts.contains(&i) { r.abs() / self.nut.helix.radius } else { r.abs() }
        };
        let left = state.residual.iter().enumerate().map(force).fold(0.0, f64::max);
        if left == 0.0 { 0.0 } else { left / state.forces }
    }

    /// Stiffness of each unknown if every ball carried its share.
    fn usual_stiffness(&self, forces: f64) -> Vec<f64> {
        let series = self.ball.series;
        let share = (forces / count(self.seats.len())).max(f64::MIN_POSITIVE);
        let one = 1.5 * series.stiffness.powf(2.0 / 3.0) * share.cbrt();
        let mut usual = vec![one; self.held[0].len()];
        let mut all = [0.0; FREEDOMS];
        for seat in &self.seats {
            for (all, [b, n]) in all.iter_mut().zip(seat.by_the_nut()) {
                *all += one * (b.powi(2) + n.powi(2));
            }
        }
        usual[2 * self.nodes..2 * self.nodes + FREEDOMS].copy_from_slice(&all);
        usual
    }

    /// The nut as if all balls shared the load equally, unless its place along the axis is given.
    fn start(&self) -> Vec<f64> {
        let first = self.freedoms();
        let mut y = vec![0.0; self.held[0].len()];
        for (i, freedom) in self.support.0.iter().enumerate() {
            if let Freedom::Held(displacement) = freedom {
                y[first + i] = *displacement;
            }
        }
        let load = self.support.0[0].load();
        if !self.held[0][first] && load != 0.0 {
            y[first] = self.nut.equal(load).map_or(0.0, |equal| equal.displacement);
        }
        y
    }

    /// One Newton step from equal sharing, with all errors as displacements along the contact normal.
    fn estimate(mut self, axial: f64) -> Result<Equilibrium, NutError> {
        let equal = self.nut.equal(axial)?;
        let way = axial.signum();
        let along = equal.displacement * self.nut.helix.lead_angle.cos();
        let ball = self.ball.series.at([way * along, 0.0], 0.0);
        let shared = on_one_diagonal(usize::from(way < 0.0), &ball);
        let m = shared.force.map(|force| force / ball.load);
        let mut y = self.start();
        let lost = || NutError::NotConverged { residual: f64::NAN, steps: 0 };
        let state = self.assemble(&y, Want::Newton, |seat, _| {
            let (error, excess) = seat.error;
            // G_j ≈ G + V″ (m·w_j + 2Δr_j) m                              (U28)
            let wrong = m[0] * error[0] + m[1] * error[1] + 2.0 * excess;
            let more = |i: usize| (shared.slope[i][0] * m[0] + shared.slope[i][1] * m[1]) * wrong;
            Some(BallInGrooves { force: from_fn(|i| shared.force[i] + more(i)), ..shared })
        });
        let state = state.ok_or_else(lost)?;
        self.matrix.factorize().map_err(|_| lost())?;
        let mut step: Vec<f64> = state.residual.iter().map(|r| -r).collect();
        self.matrix.solve(&mut step);
        for (y, step) in y.iter_mut().zip(step) {
            *y += step;
        }
        let state = self.state(&y, Want::Forces).ok_or_else(lost)?;
        let residual = self.imbalance(&state);
        self.finish(&y, &state, 1, residual)
    }

    fn solve(mut self, start: Option<&[f64; FREEDOMS]>) -> Result<Equilibrium, NutError> {
        let first = self.freedoms();
        let mut y = self.start();
        for (i, start) in start.into_iter().flatten().enumerate() {
            if !self.held[0][first + i] {
                y[first + i] = *start;
            }
        }
        let none = |residual, steps| NutError::NotConverged { residual, steps };
        let mut state = self.state(&y, Want::Newton).ok_or(none(f64::NAN, 0))?;
        let mut damping = 0.0;
        for steps in 0..=MOST_STEPS {
            let imbalance = self.imbalance(&state);
            if imbalance <= BALANCED || (steps >= ROUNDED.0 && imbalance <= ROUNDED.1) {
                return self.finish(&y, &state, steps, imbalance);
            }
            let moved = self.moved(&y, &state);
            // Beyond, balls would be pressed from the other side of the groove arcs.
            if moved > self.nut.arc_distance() {
                return Err(NutError::NothingCarries { moved });
            }
            let usual = self.usual_stiffness(state.forces);
            let next = loop {
                if let Some(next) = self.step(&y, &state, damping, &usual) {
                    break Some(next);
                }
                // Free play, or a step that the balls refuse: nearer to the slope of the energy.
                damping = f64::max(10.0 * damping, 1e-6);
                if damping > 1e6 {
                    break None;
                }
                self.state(&y, Want::Newton).ok_or(none(imbalance, steps))?;
            };
            let Some(next) = next else { return Err(none(imbalance, steps)) };
            damping = if damping < 1e-7 { 0.0 } else { 0.1 * damping };
            y = next;
            state = self.state(&y, Want::Newton).ok_or(none(imbalance, steps))?;
        }
        Err(none(self.imbalance(&state), MOST_STEPS))
    }

    /// How far the nut has moved \[m\]: its section, or where bodies strain the groove that has moved least.
    fn moved(&self, y: &[f64], state: &State) -> f64 {
        let first = self.freedoms();
        if self.nodes == 0 {
            return y[first..first + 3].iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        }
        state.grooves.iter().map(|w| w[0].hypot(w[1])).fold(f64::MAX, f64::min)
    }

    /// A Newton step that lowers the energy; the stiffness of `state` is in the matrix.
    fn step(&mut self, y: &[f64], state: &State, damping: f64, usual: &[f64]) -> Option<Vec<f64>> {
        if damping > 0.0 {
            for (i, (usual, held)) in usual.iter().zip(&self.held[0]).enumerate() {
                if !held {
                    self.matrix.add(i, i, damping * usual);
                }
            }
        }
        self.matrix.factorize().ok()?;
        let mut step: Vec<f64> = state.residual.iter().map(|r| -r).collect();
        self.matrix.solve(&mut step);
        let fall: f64 = -step.iter().zip(&state.residual).map(|(s, r)| s * r).sum::<f64>();
        if !fall.is_finite() || fall <= 0.0 {
            return None;
        }
        let before = self.imbalance(state);
        let mut share = 1.0;
        while share > 1e-4 {
            let next: Vec<f64> = y.iter().zip(&step).map(|(y, s)| y + share * s).collect();
            if let Some(there) = self.state(&next, Want::Forces) {
                // Armijo; near the end the energy has no more digits, but the forces have.
                let lower = there.energy <= state.energy - 1e-4 * share * fall;
                let rounding = 1e-14 * state.energies.max(there.energies);
                let level = (there.energy - state.energy).abs() <= rounding;
                if lower || (level && self.imbalance(&there) < before) {
                    return Some(next);
                }
            }
            share *= 0.5;
        }
        None
    }

    fn finish(
        mut self,
        y: &[f64],
        state: &State,
        steps: usize,
        residual: f64,
    ) -> Result<Equilibrium, NutError> {
        let first = self.freedoms();
        self.state(y, Want::Stiffness).ok_or(NutError::NotConverged { residual, steps })?;
        let stiffness = self.stiffness();
        let mut carried = [0.0; FREEDOMS];
        let mut bodies = Vec::new();
        for (seat, ball) in self.seats.iter().zip(&state.balls) {
            let along = |[b, n]: [f64; 2]| b * ball.force[0] + n * ball.force[1];
            let forces: Vec<f64> = seat.by_the_nut().map(along).collect();
            for (carried, force) in carried.iter_mut().zip(&forces) {
                *carried += force;
            }
            let body = self.nut.circuits[seat.place.circuit].body;
            if bodies.len() <= body {
                bodies.resize(body + 1, 0.0);
            }
            bodies[body] += forces[0];
        }
        Ok(Equilibrium {
            displacement: from_fn(|i| y[first + i]),
            carried,
            stiffness,
            places: self.seats.iter().map(|seat| seat.place).collect(),
            balls: state.balls.clone(),
            grooves: state.grooves.clone(),
            bodies,
            widening: y[first + FREEDOMS..].to_vec(),
            steps,
            residual,
        })
    }

    /// The stiffness in the matrix, condensed to the freedoms (U17).
    fn stiffness(&mut self) -> [[f64; FREEDOMS]; FREEDOMS] {
        let rings = self.rings.len();
        let border = FREEDOMS + rings;
        // A nut that something does not carry has a singular border; the chain is eliminated before.
        let _ = self.matrix.factorize();
        let condensed = self.matrix.condensed();
        let mut inner = DynamicDense::new(rings);
        for i in 0..rings {
            for k in 0..rings {
                inner.set(i, k, condensed[(FREEDOMS + i) * border + FREEDOMS + k]);
            }
        }
        let mut all: [[f64; FREEDOMS]; FREEDOMS] =
            from_fn(|i| from_fn(|k| condensed[i * border + k]));
        if rings > 0 && inner.factorize().is_ok() {
            for k in 0..FREEDOMS {
                let mut column: Vec<f64> =
                    (0..rings).map(|i| condensed[(FREEDOMS + i) * border + k]).collect();
                inner.solve(&mut column);
                for (i, row) in all.iter_mut().enumerate() {
                    let coupled = |(r, x): (usize, &f64)| condensed[i * border + FREEDOMS + r] * x;
                    // K5 = S_qq − S_qr S_rr⁻¹ S_rq                        (U17)
                    row[k] -= column.iter().enumerate().map(coupled).sum::<f64>();
                }
            }
        }
        all
    }
}

/// The matrix, and the unknowns whose rows and columns stay empty.
struct Entries<'a> {
    matrix: &'a mut Bordered<2>,
    held: &'a [bool],
}

impl Entries<'_> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        if !self.held[row] && !self.held[column] {
            self.matrix.add(row, column, value);
        }
    }
}

/// Groove displacement of a ball by each freedom of the nut, along binormal and principal normal (U4).
fn kinematics(nut: &BallNut, place: &Place, reference: f64) -> [[f64; 2]; FREEDOMS] {
    let (radius, zeta) = (nut.helix.radius, place.z - reference);
    let (sin, cos) = place.theta.sin_cos();
    let (sin_a, cos_a) = nut.helix.lead_angle.sin_cos();
    let (x, y) = (radius * cos, radius * sin);
    // n_j = (−cosθ, −sinθ, 0),  b_j = (sinα sinθ, −sinα cosθ, cosα)       (U2)
    let normal = [-cos, -sin, 0.0];
    let binormal = [sin_a * sin, -sin_a * cos, cos_a];
    // u_j = (u_x + φ_y ζ, u_y − φ_x ζ, u_z + φ_x y − φ_y x)               (U3)
    let by = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -zeta, y], [zeta, 0.0, -x]];
    // w_j = (b_j·u_j, n_j·u_j) = B_j q                                    (U4)
    by.map(|u| [binormal, normal].map(|axis| axis.iter().zip(u).map(|(a, u)| a * u).sum()))
}
