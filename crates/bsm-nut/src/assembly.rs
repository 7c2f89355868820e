//! Equilibrium equations of a nut: energy, forces and derivatives of the forces as functions of the
//! unknowns.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U2) to (U5) and (U15) to (U17).

use std::array::from_fn;

use bsm_kin::FrenetFrame;
use bsm_newton::BorderedMatrix;
use nalgebra::DMatrix;

use crate::ball::{BallInGrooves, FourContacts};
use crate::equilibrium::{FREEDOMS, Freedom, NutError, Support};
use crate::geometry::{BallNut, BallPosition, count};

/// A ball, and the data of this ball that remain constant during the iteration.
struct BallSite {
    position: BallPosition,
    /// Groove displacement due to manufacturing errors \[m\], and excess of the ball radius over
    /// the nominal radius \[m\].
    error: ([f64; 2], f64),
    /// Vector from the reference point to the ball \[m\]. The first two components are transverse,
    /// and the third is axial.
    lever_arm: [f64; 3],
    /// Groove displacement at the ball per unit displacement of the nut, for each degree of freedom
    /// (U4).
    nut_matrix: [[f64; 2]; FREEDOMS],
    /// Index of the node of the elastic bodies at the position of the ball; `None` if both bodies
    /// are rigid.
    node: Option<usize>,
    /// Index, in the vector of unknowns, of the radial expansion of the nut around the ball; `None`
    /// if the nut is rigid.
    ring: Option<usize>,
}

/// A linear spring between two unknowns, or between an unknown and a fixed point.
struct Spring {
    ends: (usize, Option<usize>),
    stiffness: f64,
}

/// Nodes at which the elastic bodies of nut and screw are connected to the balls.
struct Nodes {
    /// Axial positions \[m\], in ascending order; empty if both bodies are axially rigid.
    z: Vec<f64>,
    /// Largest difference between axial positions that belong to the same node \[m\].
    tolerance: f64,
}

impl Nodes {
    fn of(nut: &BallNut, positions: &[BallPosition]) -> Self {
        let mut z = Vec::new();
        if nut.nut_bar.is_some() || nut.screw_bar.is_some() {
            z.extend(positions.iter().map(|position| position.z));
            z.sort_by(f64::total_cmp);
        }
        let length = z.last().zip(z.first()).map_or(0.0, |(last, first)| last - first);
        let tolerance = 1e-9 * length;
        // Balls on different threads may have the same axial position. Such balls share a node.
        z.dedup_by(|a, b| (*a - *b).abs() <= tolerance);
        Self { z, tolerance }
    }

    /// Returns the index of the node at an axial position \[m\], or `None` if both bodies are
    /// axially rigid.
    fn at(&self, z: f64) -> Option<usize> {
        let node = self.z.partition_point(|of_node| *of_node < z - self.tolerance);
        (!self.z.is_empty()).then_some(node)
    }

    /// Returns the springs that represent the bars of nut and screw.
    ///
    /// * `fixed`: flags of the displacements of nut and screw at each node. They are set to true at
    ///   the anchors and for a rigid body.
    fn bar_springs(&self, nut: &BallNut, fixed: &mut [bool]) -> Vec<Spring> {
        let mut all = Vec::new();
        for (body, bar) in [nut.nut_bar, nut.screw_bar].iter().enumerate() {
            let Some(bar) = bar else {
                fixed.iter_mut().skip(body).step_by(2).for_each(|fixed| *fixed = true);
                continue;
            };
            let (springs, at) = bar.springs(&self.z);
            let unknown = |node: usize| 2 * node + body;
            all.extend(springs.into_iter().map(|(node, next, stiffness)| Spring {
                ends: (unknown(node), next.map(unknown)),
                stiffness,
            }));
            if let Some(node) = at {
                fixed[unknown(node)] = true;
            }
        }
        all
    }
}

/// Selects which springs contribute to the stiffness matrix, and which unknowns are fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StiffnessScope {
    /// All springs, for a Newton step. Degrees of freedom that are held by the guides are fixed.
    Step = 0,
    /// Only the springs of the nut itself, without the springs of the guides.
    Nut = 1,
}

/// The equilibrium problem (U15). The unknowns are, in this order: displacements of nut and screw
/// at each node, degrees of freedom of the nut, and radial expansion of the nut at each circuit.
pub(crate) struct Assembly<'a> {
    pub(crate) nut: &'a BallNut,
    support: Support,
    ball: FourContacts,
    sites: Vec<BallSite>,
    nodes: usize,
    /// Displacement along the binormal divided by the axial displacement, `$\cos\alpha$`.
    along: f64,
    /// Springs that represent the elastic bodies (bars and rings).
    bodies: Vec<Spring>,
    guides: Vec<Spring>,
    rings: usize,
    /// For each [`StiffnessScope`], flags that are true for fixed unknowns.
    fixed: [Vec<bool>; 2],
    pub(crate) matrix: BorderedMatrix<2>,
}

/// Energy and forces of the nut, and states of all balls, for given values of the unknowns.
#[derive(Default)]
pub(crate) struct EnergyState {
    pub(crate) energy: f64,
    /// Sum of the absolute values of all contributions to the energy \[J\].
    pub(crate) energy_scale: f64,
    pub(crate) residual: Vec<f64>,
    /// Sum of the absolute values of all forces \[N\].
    pub(crate) force_scale: f64,
    pub(crate) balls: Vec<BallInGrooves>,
    pub(crate) grooves: Vec<[f64; 2]>,
}

impl<'a> Assembly<'a> {
    pub(crate) fn of(nut: &'a BallNut, support: &Support) -> Result<Self, NutError> {
        if nut.balls() == 0 {
            return Err(NutError::NoBalls);
        }
        let ball = nut.ball_in_grooves().map_err(NutError::Contact)?;
        let positions = nut.positions();
        let nodes = Nodes::of(nut, &positions);
        let first = 2 * nodes.z.len();
        let mut fixed = vec![false; first];
        let mut bodies = nodes.bar_springs(nut, &mut fixed);
        let mut guides = Vec::new();
        let rings = nut.ring.map_or_else(Vec::new, |ring| {
            nut.circuits
                .iter()
                .map(|circuit| ring.stiffness(nut.helix.lead(), circuit.arc))
                .collect()
        });
        bodies.extend(
            (first + FREEDOMS..)
                .zip(&rings)
                .map(|(ring, stiffness)| Spring { ends: (ring, None), stiffness: *stiffness }),
        );
        fixed.resize(first + FREEDOMS + rings.len(), false);
        let of_the_nut = fixed.clone();
        for (freedom, i) in support.0.iter().zip(first..) {
            fixed[i] = matches!(freedom, Freedom::Held(_));
            if freedom.spring() > 0.0 {
                guides.push(Spring { ends: (i, None), stiffness: freedom.spring() });
            }
        }
        let reference = nut.reference_position();
        let site = |(number, position): (usize, BallPosition)| {
            let ring = first + FREEDOMS + position.circuit;
            let frame = nut.helix.frame(position.theta);
            let lever_arm = [frame.p_WC.x, frame.p_WC.y, position.z - reference];
            BallSite {
                position,
                error: nut.error_at(number, &position),
                lever_arm,
                nut_matrix: kinematics(&frame, lever_arm),
                node: nodes.at(position.z),
                ring: (!rings.is_empty()).then_some(ring),
            }
        };
        let sites: Vec<_> = positions.into_iter().enumerate().map(site).collect();
        let groove = ball.grooves.offsets[0].min(ball.grooves.offsets[1]);
        if let Some(ball) = sites.iter().position(|site| site.error.1 >= groove) {
            return Err(NutError::BallTooLarge { ball });
        }
        Ok(Self {
            ball,
            sites,
            matrix: BorderedMatrix::new(nodes.z.len(), FREEDOMS + rings.len()),
            nodes: nodes.z.len(),
            along: nut.helix.lead_angle.cos(),
            nut,
            support: *support,
            bodies,
            guides,
            rings: rings.len(),
            fixed: [fixed, of_the_nut],
        })
    }

    /// Returns the index of the first degree of freedom of the nut in the vector of unknowns.
    pub(crate) fn freedoms(&self) -> usize {
        2 * self.nodes
    }

    /// Returns initial values of the unknowns. If `neighbor` is given, its displacements are used.
    /// Otherwise, the axial displacement of a loaded nut is calculated for equal load sharing.
    pub(crate) fn start(&self, neighbor: Option<&[f64; FREEDOMS]>) -> Vec<f64> {
        let first = self.freedoms();
        let mut y = vec![0.0; self.fixed[0].len()];
        for (i, freedom) in self.support.0.iter().enumerate() {
            y[first + i] = match (freedom, neighbor) {
                (Freedom::Held(displacement), _) => *displacement,
                (_, Some(neighbor)) => neighbor[i],
                (_, None) => 0.0,
            };
        }
        let load = self.support.0[0].load();
        if neighbor.is_none() && !self.fixed[0][first] && load != 0.0 {
            let equal = self.nut.equal_of(&self.ball.series, load);
            y[first] = equal.map_or(0.0, |equal| equal.displacement);
        }
        y
    }

    /// Returns energy, forces and ball states for the values `y` of the unknowns.
    ///
    /// # Errors
    ///
    /// Returns the index of the first ball for which no equilibrium position was found.
    pub(crate) fn state(&self, y: &[f64]) -> Result<EnergyState, usize> {
        let first = self.freedoms();
        let mut state = EnergyState { residual: vec![0.0; y.len()], ..EnergyState::default() };
        for (number, site) in self.sites.iter().enumerate() {
            let (mut w, oversize) = site.error;
            for (q, by) in y[first..].iter().zip(site.nut_matrix) {
                w[0] += by[0] * q;
                w[1] += by[1] * q;
            }
            // w_b += cosα (n_i − s_i),  w_n −= w_c                        (U5)
            if let Some(node) = site.node {
                w[0] += self.along * (y[2 * node] - y[2 * node + 1]);
            }
            if let Some(ring) = site.ring {
                w[1] -= y[ring];
            }
            let flanks = self.nut.circuits[site.position.circuit].flanks;
            let ball = self.ball.at(w, oversize, flanks).ok_or(number)?;
            state.energy += ball.energy;
            state.energy_scale += ball.energy.abs();
            state.force_scale += ball.max_load();
            // r = Σ A_jᵀ G_j + …                                          (U15)
            for (r, by) in state.residual[first..].iter_mut().zip(site.nut_matrix) {
                *r += dot(by, ball.force);
            }
            if let Some(node) = site.node {
                state.residual[2 * node] += self.along * ball.force[0];
                state.residual[2 * node + 1] -= self.along * ball.force[0];
            }
            if let Some(ring) = site.ring {
                state.residual[ring] -= ball.force[1];
            }
            state.balls.push(ball);
            state.grooves.push(w);
        }
        for &Spring { ends: (i, other), stiffness } in self.bodies.iter().chain(&self.guides) {
            let stretch = y[i] - other.map_or(0.0, |k| y[k]);
            let energy = 0.5 * stiffness * stretch * stretch;
            state.energy += energy;
            state.energy_scale += energy;
            state.residual[i] += stiffness * stretch;
            if let Some(k) = other {
                state.residual[k] -= stiffness * stretch;
            }
        }
        for (i, freedom) in self.support.0.iter().enumerate() {
            let load = freedom.load();
            state.energy -= load * y[first + i];
            state.energy_scale += (load * y[first + i]).abs();
            state.residual[first + i] -= load;
            // Moments are divided by the pitch circle radius, so that they can be compared with
            // forces.
            let lever_arm = if i < 3 { 1.0 } else { self.nut.helix.radius };
            state.force_scale += load.abs() / lever_arm;
        }
        for (residual, fixed) in state.residual.iter_mut().zip(&self.fixed[0]) {
            if *fixed {
                *residual = 0.0;
            }
        }
        Ok(state)
    }

    /// Fills the matrix with the derivatives of all forces with respect to the unknowns at the
    /// given state (U16).
    pub(crate) fn linearize(&mut self, state: &EnergyState, of: StiffnessScope) {
        let (first, along) = (self.freedoms(), self.along);
        let matrix = &mut self.matrix;
        matrix.clear();
        let mut of_the_nut = [[0.0; FREEDOMS]; FREEDOMS];
        // H = K_q + Σ A_jᵀ V″ A_j                                         (U16)
        for (site, ball) in self.sites.iter().zip(&state.balls) {
            let [[bb, bn], [_, nn]] = ball.slope;
            let pulled = site.nut_matrix.map(|by| [dot([bb, bn], by), dot([bn, nn], by)]);
            for (row, pulled) in of_the_nut.iter_mut().zip(&pulled) {
                for (entry, by) in row.iter_mut().zip(site.nut_matrix) {
                    *entry += dot(*pulled, by);
                }
            }
            if let Some(node) = site.node {
                let block = matrix.block_mut(node);
                let own = along * along * bb;
                for (row, sign) in block.rows.iter_mut().zip([1.0, -1.0]) {
                    row[0] += sign * own;
                    row[1] -= sign * own;
                }
                let mut couple = |column: usize, coupling: f64| {
                    for coupled in [&mut block.right[column], &mut block.bottom[column]] {
                        coupled[0] += coupling;
                        coupled[1] -= coupling;
                    }
                };
                for (i, [b, _]) in pulled.iter().enumerate() {
                    couple(i, along * b);
                }
                if let Some(ring) = site.ring {
                    couple(ring - first, -along * bn);
                }
            }
            if let Some(ring) = site.ring {
                matrix.add(ring, ring, nn);
                for (i, [_, n]) in pulled.iter().enumerate() {
                    matrix.add(first + i, ring, -n);
                    matrix.add(ring, first + i, -n);
                }
            }
        }
        for (i, row) in of_the_nut.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                matrix.add(first + i, first + k, *entry);
            }
        }
        // The stiffness of the nut does not include the springs of the guides.
        let guides = self.guides.iter().filter(|_| of == StiffnessScope::Step);
        for &Spring { ends: (i, other), stiffness } in self.bodies.iter().chain(guides) {
            matrix.add(i, i, stiffness);
            if let Some(k) = other {
                matrix.add(k, k, stiffness);
                matrix.add(i, k, -stiffness);
                matrix.add(k, i, -stiffness);
            }
        }
        for (i, _) in self.fixed[of as usize].iter().enumerate().filter(|(_, fixed)| **fixed) {
            matrix.fix(i);
        }
    }

    /// Adds damping to the diagonal of the matrix. Each diagonal entry is increased by a fraction
    /// of the stiffness that its unknown would have if all balls carried equal loads.
    pub(crate) fn damp(&mut self, state: &EnergyState, part: f64) {
        let share = (state.force_scale / count(self.sites.len())).max(f64::MIN_POSITIVE);
        let one = 1.5 * self.ball.series.stiffness.powf(2.0 / 3.0) * share.cbrt();
        let mut usual = vec![one; self.fixed[0].len()];
        let mut all = [0.0; FREEDOMS];
        for site in &self.sites {
            for (all, by) in all.iter_mut().zip(site.nut_matrix) {
                *all += one * dot(by, by);
            }
        }
        usual[2 * self.nodes..2 * self.nodes + FREEDOMS].copy_from_slice(&all);
        for (i, (usual, fixed)) in usual.iter().zip(&self.fixed[0]).enumerate() {
            if !fixed {
                self.matrix.add(i, i, part * usual);
            }
        }
    }

    /// Returns the largest residual force divided by the sum of the absolute values of all forces.
    pub(crate) fn imbalance(&self, state: &EnergyState) -> f64 {
        let tilts = self.freedoms() + 3..self.freedoms() + FREEDOMS;
        let force = |(i, r): (usize, &f64)| {
            if tilts.contains(&i) { r.abs() / self.nut.helix.radius } else { r.abs() }
        };
        let imbalance = state.residual.iter().enumerate().map(force).fold(0.0, f64::max);
        if imbalance == 0.0 { 0.0 } else { imbalance / state.force_scale }
    }

    /// Returns how far the nut has moved relative to the screw \[m\]. If the bodies are elastic,
    /// the result is the smallest of the displacements at the balls. The result includes motion
    /// along the groove, because no force resists this motion.
    pub(crate) fn moved(&self, y: &[f64]) -> f64 {
        let [u_z, u_x, u_y, phi_x, phi_y]: [f64; FREEDOMS] = from_fn(|i| y[self.freedoms() + i]);
        if self.nodes == 0 {
            return [u_z, u_x, u_y].into_iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        }
        let at = |site: &BallSite| {
            let [x, y_j, zeta] = site.lever_arm;
            let strain = site.node.map_or(0.0, |node| y[2 * node] - y[2 * node + 1]);
            let along = u_z + phi_x * y_j - phi_y * x + strain;
            let across = [u_x + phi_y * zeta, u_y - phi_x * zeta];
            (along * along + dot(across, across)).sqrt()
        };
        self.sites.iter().map(at).fold(f64::MAX, f64::min)
    }

    /// Returns the forces and moments that the nut exerts on its balls, one for each degree of
    /// freedom, and the axial force of each nut body.
    pub(crate) fn carried(&self, state: &EnergyState) -> ([f64; FREEDOMS], Vec<f64>) {
        let mut carried = [0.0; FREEDOMS];
        let mut bodies = Vec::new();
        for (site, ball) in self.sites.iter().zip(&state.balls) {
            let forces = site.nut_matrix.map(|by| dot(by, ball.force));
            for (carried, force) in carried.iter_mut().zip(forces) {
                *carried += force;
            }
            let body = self.nut.circuits[site.position.circuit].body;
            if bodies.len() <= body {
                bodies.resize(body + 1, 0.0);
            }
            bodies[body] += forces[0];
        }
        (carried, bodies)
    }

    /// Returns the positions of the balls.
    pub(crate) fn positions(&self) -> Vec<BallPosition> {
        self.sites.iter().map(|site| site.position).collect()
    }

    /// Returns the stiffness matrix of the nut for its five degrees of freedom. All other unknowns
    /// are eliminated (U17).
    pub(crate) fn condensed(&mut self) -> [[f64; FREEDOMS]; FREEDOMS] {
        // If nothing holds the nut in some direction, the last block of the matrix is singular, and
        // the factorization fails. The Schur complement is valid nevertheless, because the other
        // blocks are eliminated first.
        let _ = self.matrix.factorize();
        let (rings, border) = (self.rings, FREEDOMS + self.rings);
        let all = DMatrix::from_row_slice(border, border, self.matrix.condensed());
        let mut condensed = all.fixed_view::<FREEDOMS, FREEDOMS>(0, 0).into_owned();
        let of_rings = all.view((FREEDOMS, FREEDOMS), (rings, rings)).into_owned().lu();
        let coupled = all.view((FREEDOMS, 0), (rings, FREEDOMS)).into_owned();
        // A rigid nut has no ring, and solving with an empty matrix would read out of bounds.
        if rings > 0
            && let Some(moved) = of_rings.solve(&coupled)
        {
            // K5 = S_qq − S_qr S_rr⁻¹ S_rq                                (U17)
            condensed -= all.view((0, FREEDOMS), (FREEDOMS, rings)) * moved;
        }
        condensed.transpose().into()
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns the groove displacement at a ball, along binormal and principal normal, per unit
/// displacement of the nut in each degree of freedom (U4).
///
/// * `frame`: Frenet-Serret triad of the helix at the ball.
/// * `lever_arm`: vector from the reference point of the nut to the ball.
fn kinematics(
    FrenetFrame { n_W, b_W, .. }: &FrenetFrame<f64>,
    [x, y, zeta]: [f64; 3],
) -> [[f64; 2]; FREEDOMS] {
    // n_j = (−cosθ, −sinθ, 0),  b_j = (sinα sinθ, −sinα cosθ, cosα)       (U2)
    let [normal, binormal] = [n_W, b_W];
    // u_j = (u_x + φ_y ζ, u_y − φ_x ζ, u_z + φ_x y − φ_y x)               (U3)
    let by = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -zeta, y], [zeta, 0.0, -x]];
    // w_j = (b_j·u_j, n_j·u_j) = B_j q                                    (U4)
    by.map(|u| [binormal, normal].map(|axis| axis.iter().zip(u).map(|(a, u)| a * u).sum()))
}
