//! Sweeps of a scene: the closed form against the rigid equations.

use bsm_case::Scene;
use bsm_dyn::{Model, ModelWorkspace, Solution};

use crate::ValidateError;

/// One solved point of a sweep, against the closed form.
pub(crate) struct Point {
    pub(crate) at: f64,
    /// |η − η(14) or (17)| in percentage points.
    deviation: f64,
    pub(crate) rigid: Solution,
}

/// A sweep of Lin's case over one input.
pub(crate) struct Sweep {
    pub(crate) input: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) points: Vec<Point>,
    denied: usize,
}

impl Sweep {
    fn run(
        lin: &Scene,
        input: &'static str,
        unit: &'static str,
        values: impl Iterator<Item = f64>,
        work: &mut ModelWorkspace,
    ) -> Result<Self, ValidateError> {
        let (mut points, mut denied) = (Vec::new(), 0);
        for at in values {
            let mut scene = lin.clone();
            scene.set(input, at)?;
            match deviation(&scene, work)? {
                Some((deviation, rigid)) => points.push(Point { at, deviation, rigid }),
                None => denied += 1,
            }
        }
        Ok(Self { input, unit, points, denied })
    }

    pub(crate) fn lead(lin: &Scene, work: &mut ModelWorkspace) -> Result<Self, ValidateError> {
        Self::run(lin, "lead_angle_deg", "deg", (1..=60).map(f64::from), work)
    }

    pub(crate) fn contact(lin: &Scene, work: &mut ModelWorkspace) -> Result<Self, ValidateError> {
        Self::run(lin, "contact_angle_deg", "deg", (5..=85).map(f64::from), work)
    }

    pub(crate) fn speed(lin: &Scene, work: &mut ModelWorkspace) -> Result<Self, ValidateError> {
        let sign = lin.screw_speed_rpm.map_or(1.0, f64::signum);
        let values = (0..=40).map(|i| sign * 100.0 * 10.0_f64.powf(f64::from(i) / 20.0));
        Self::run(lin, "screw_speed_rpm", "rpm", values, work)
    }

    /// Largest deviation, and where.
    pub(crate) fn largest(&self) -> (f64, f64) {
        self.points
            .iter()
            .max_by(|a, b| a.deviation.total_cmp(&b.deviation))
            .map_or((f64::NAN, f64::NAN), |p| (p.deviation, p.at))
    }

    pub(crate) fn describe(&self) -> String {
        let total = self.points.len() + self.denied;
        let (_, at) = self.largest();
        format!(
            "at {} = {at:.4} {}; {} of {total} points have a root",
            self.input,
            self.unit,
            self.points.len()
        )
    }
}

/// Deviation of the closed form in percentage points, and the rigid solution; `None` where the
/// rigid equations have no root.
pub(crate) fn deviation(
    scene: &Scene,
    work: &mut ModelWorkspace,
) -> Result<Option<(f64, Solution)>, ValidateError> {
    let eta = |model: Model, work: &mut ModelWorkspace| -> Result<_, ValidateError> {
        Ok(scene.problem(&model.into())?.solve(work))
    };
    let rigid = eta(Model::Rigid, work)?;
    let closed = eta(Model::ClosedForm, work)?;
    Ok(match (rigid.efficiency(), closed.efficiency()) {
        (Some(exact), Some(closed)) => Some((100.0 * (exact - closed).abs(), rigid)),
        _ => None,
    })
}
