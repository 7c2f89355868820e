//! Models by lanes: several points at a time, on the widest instruction set of the machine.
//!
//! A kernel answers the ordinary points of its model, and leaves the others to the model itself,
//! which also finds the words for them. Its formulas are those of the model, written again for
//! lanes; the tests compare the two.

mod closed_form;
mod elastic;
mod hertz;
mod pair;
mod quasi_static;
mod raceway;
mod rigid;
mod units;

use bsm_case::{OUTPUTS, Output, OutputKey, Settings};
use bsm_dyn::Model;
use bsm_simd::{Arch, Simd, WithSimd};

use self::closed_form::ClosedForm;
use self::elastic::Elastic;
use self::quasi_static::QuasiStatic;
use self::raceway::Raceway;
use self::rigid::Rigid;
use crate::operand::{Given, Lane, Mask, Operands};

/// True if there is a kernel of the model.
pub fn exists(model: Model) -> bool {
    model != Model::Traction
}

/// A model by lanes.
trait Kernel {
    /// The model.
    const MODEL: Model;

    /// Solves a lane of points, and says for which of them the numbers are the answer.
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S>;
}

/// The outputs that are wanted, and their places.
#[derive(Debug)]
pub(crate) struct Wanted([Option<usize>; OUTPUTS.len()]);

impl Wanted {
    pub(crate) fn of(outputs: &[&Output]) -> Self {
        let mut places = [None; OUTPUTS.len()];
        for (place, output) in outputs.iter().enumerate() {
            if let Some(key) = output.key() {
                places[key as usize] = Some(place);
            }
        }
        Self(places)
    }
}

/// Where the outputs of a lane of points go.
struct Out<'a, 'b> {
    wanted: &'a Wanted,
    columns: &'a mut [&'b mut [f64]],
    /// The first of the points.
    row: usize,
}

impl Out<'_, '_> {
    /// True if any of these outputs is wanted: what takes time is computed only then.
    #[inline(always)]
    fn wants(&self, keys: &[OutputKey]) -> bool {
        keys.iter().any(|key| self.wanted.0[*key as usize].is_some())
    }

    /// Stores the values of an output, in the unit of the vocabulary.
    #[inline(always)]
    fn set<S: Simd>(&mut self, key: OutputKey, values: Lane<S>) {
        if let Some(place) = self.wanted.0[key as usize] {
            values.store(&mut self.columns[place][self.row..]);
        }
    }

    /// No other solution than this one.
    #[inline(always)]
    fn set_unique<S: Simd>(&mut self, like: Lane<S>) {
        self.set(OutputKey::other_solutions, like.constant(0.0));
    }

    /// Stores yes and no.
    #[inline(always)]
    fn set_flag<S: Simd>(&mut self, key: OutputKey, values: Mask<S>) {
        self.set(key, values.to_numbers());
    }
}

/// Some rows of a chunk and the places of their answers.
pub(crate) struct Rows<'a, 'b> {
    pub(crate) operands: &'a Operands<'a>,
    pub(crate) wanted: &'a Wanted,
    /// The first of the rows in the chunk.
    pub(crate) first: usize,
    /// Columns of the outputs, of these rows only.
    pub(crate) columns: &'a mut [&'b mut [f64]],
    /// Which of the rows are answered.
    pub(crate) done: &'a mut [bool],
}

impl Rows<'_, '_> {
    /// Answers the ordinary rows of a model; without a kernel for it, none.
    pub(crate) fn solve(self, arch: Arch, model: Model, settings: &Settings) {
        match model {
            Model::ClosedForm => arch.dispatch(Run { kernel: ClosedForm, rows: self }),
            Model::QuasiStatic => arch.dispatch(Run { kernel: QuasiStatic, rows: self }),
            Model::Rigid => arch.dispatch(Run { kernel: Rigid, rows: self }),
            Model::RacewayControl => {
                let kernel = Raceway { control: settings.control };
                arch.dispatch(Run { kernel, rows: self });
            }
            Model::Elastic => arch.dispatch(Run { kernel: Elastic, rows: self }),
            Model::Traction => {}
        }
    }
}

/// A kernel over rows.
struct Run<'a, 'b, K> {
    kernel: K,
    rows: Rows<'a, 'b>,
}

impl<K: Kernel> WithSimd for Run<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Rows { operands, wanted, first, columns, done } = self.rows;
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = Given { simd, operands, row: first + row };
            let mut out = Out { wanted, columns: &mut *columns, row };
            let solved = self.kernel.solve(&given, &mut out);
            (solved & given.lawful(K::MODEL)).store(&mut done[row..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use bsm_case::Scene;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::rows::{Cell, Chunk, Column, Columns};

    /// Speed depends on it: of points that have a root nearly none is left to Newton.
    #[test]
    fn sweeps_finish_nearly_all_points() {
        const COUNT: usize = 10_000;
        let mut rng = ChaCha8Rng::seed_from_u64(24);
        let base = Scene::from_json(
            br#"{"pitch_circle_diameter_mm": 48.6, "ball_diameter_mm": 8.74, "nut_speed_rpm": 0,
                 "loaded_balls": 1}"#,
        )
        .expect("scene");
        let names = [
            ("lead_angle_deg", 10.0..45.0),
            ("contact_angle_deg", 30.0..70.0),
            ("friction_coefficient", 0.01..0.1),
            ("screw_speed_rpm", -6000.0..6000.0),
            ("axial_load_N", 20.0..3000.0),
        ];
        let columns = Columns::sort(names.iter().map(|(name, _)| *name), &[]).expect("known names");
        let mut inputs = vec![Column::default(); names.len()];
        for _ in 0..COUNT {
            for (column, (_, range)) in inputs.iter_mut().zip(&names) {
                column.push(Cell::Number(rng.random_range(range.clone())));
            }
        }
        let chunk = Chunk { first: 1, len: COUNT, inputs, kept: Vec::new() };
        let settings = Settings::from(Model::Rigid);
        let (operands, model) = Operands::of(&chunk, &columns, &base, &settings).expect("complete");
        let mut done = vec![false; COUNT];
        let wanted = &Wanted::of(&[]);
        let rows =
            Rows { operands: &operands, wanted, first: 0, columns: &mut [], done: &mut done };
        rows.solve(Arch::new(), model, &settings);
        let (mut left, mut solved) = (0, 0);
        let mut work = bsm_dyn::ModelWorkspace::default();
        for (row, done) in done.iter().enumerate() {
            let mut scene = base.clone();
            for ((name, _), column) in names.iter().zip(&chunk.inputs) {
                scene.set(name, column.values()[row]).expect("known name");
            }
            let root = scene.problem(&settings).expect("complete").solve(&mut work);
            let converged = root.status() == bsm_dyn::Status::Converged;
            solved += usize::from(converged);
            if converged && !done {
                left += 1;
            }
        }
        assert!(solved > COUNT / 2, "{solved}");
        assert!(left * 200 < solved, "{left} of {solved} points are left to Newton");
    }
}
