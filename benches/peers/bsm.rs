//! The solver itself: one point at a time, and in batches.

use std::f64::consts::PI;

use bsm_batch::{Cell, Chunk, Columns};
use bsm_case::{Record, Scene, Settings};
use bsm_dyn::{Model, ModelWorkspace, Problem, RigidWorkspace, Solution};

use crate::equations::Answer;
use crate::points::{INPUTS, Point};

fn settings() -> Settings {
    Model::Rigid.into()
}

/// One scene after the other.
pub(crate) fn scalar(scenes: &[Scene]) -> Vec<Solution> {
    let mut work = ModelWorkspace::default();
    scenes
        .iter()
        .map(|scene| scene.problem(&settings()).expect("a seeded scene").solve(&mut work))
        .collect()
}

/// The points as a table in memory.
pub(crate) struct Table {
    chunk: Chunk,
    columns: Columns,
}

impl Table {
    pub(crate) fn of(points: &[Point]) -> Self {
        let columns = Columns::sort(INPUTS, &[]).expect("known names");
        let inputs = (0..INPUTS.len())
            .map(|i| points.iter().map(|point| Cell::Number(point[i])).collect())
            .collect();
        Self { chunk: Chunk { first: 1, len: points.len(), inputs, kept: Vec::new() }, columns }
    }

    /// The batch solver, on the threads of the pool that it is called in.
    pub(crate) fn solve(&self) -> Vec<Record> {
        bsm_batch::solve(&self.chunk, &self.columns, &Scene::default(), &settings())
    }
}

/// What every peer must agree with: the outputs of the solver and the motion at its root.
pub(crate) fn reference(scene: &Scene) -> Option<Answer> {
    let Ok(Problem::Rigid(rigid)) = scene.problem(&settings()) else { return None };
    let mut work = RigidWorkspace::default();
    let (outputs, root) = (rigid.solve(&mut work).outputs, rigid.root(&mut work).ok()?);
    Some([
        outputs.efficiency?,
        outputs.nut_normal_load?,
        outputs.minor_normal_load?,
        outputs.screw_normal_load?,
        root.p,
        root.u,
        root.tau,
        root.s,
    ])
}

/// The answer in a record; the unknowns follow from the motion and the slip at A.
pub(crate) fn answer(record: &Record, point: &Point) -> Option<Answer> {
    let [ball_mm, pitch_mm, lead_deg, _, _, density, screw_rpm, nut_rpm, axial, balls] = *point;
    let (r_b, r_m) = (0.5e-3 * ball_mm, 0.5e-3 * pitch_mm);
    let (sin_a, cos_a) = lead_deg.to_radians().sin_cos();
    let (w, nut) = ((screw_rpm - nut_rpm) * PI / 30.0, nut_rpm * PI / 30.0);
    let inertia = 0.4 * (4.0 / 3.0 * PI * r_b.powi(3) * density) * r_b * r_b;
    let precession = record.number("ball_precession_rad_s")?;
    let p = (precession - nut) / w;
    // Slip at A along t: d p + r_b τ in units of W; the slip angle is that of its opposite.
    let along = -record.number("nut_slip_velocity_m_s")?
        * record.number("nut_slip_angle_deg")?.to_radians().sin();
    Some([
        record.number("efficiency")?,
        record.number("nut_normal_load_N")?,
        record.number("minor_normal_load_N")?,
        record.number("screw_normal_load_N")?,
        p,
        (record.number("ball_omega_t_rad_s")? - nut * sin_a) / w,
        (along / w - p * r_m / cos_a) / r_b,
        inertia * precession * record.number("nut_spin_rad_s")? / (r_b * axial / balls),
    ])
}
