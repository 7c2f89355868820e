//! Vectorized kernels, which solve the models for several points at a time, using the widest
//! instruction set of the machine.
//!
//! A kernel calculates the direct solution of its model for a block of points, one SIMD element per
//! point. Rows that a kernel cannot solve are left to the scalar solver,
//! [`Problem::solve`](bsm_dyn::Problem::solve), which also generates the messages. Tests compare the results of the kernels with the
//! results of the scalar solver.
//!
//! [`bsm_batch::Task`](../bsm_batch/struct.Task.html) calls the kernels; start there.

mod auto;
mod closed_form;
mod contacts;
mod elastic;
mod inputs;
mod kernel;
mod quasi_static;
mod raceway;
mod rigid;
mod units;

use bsm_case::{ModelChoice, Settings};
use bsm_dyn::Model;
use bsm_simd::Arch;

use self::closed_form::ClosedFormKernel;
use self::elastic::ElasticKernel;
use self::kernel::RowKernel;
use self::quasi_static::QuasiStaticKernel;
use self::raceway::RacewayKernel;
use self::rigid::RigidKernel;

pub use self::inputs::{InputColumn, InputColumns, is_plain};
pub use self::kernel::{OutputColumn, RowChoice, Rows, Selection};

impl Rows<'_, '_> {
    /// Solves all rows for which the model has a direct solution. For `auto`, returns the selected
    /// model of each solved row; for all other models, returns an empty vector.
    pub fn solve(self, arch: Arch, model: ModelChoice, settings: &Settings) -> Vec<RowChoice> {
        // The solver in a saved HTML page does not use kernels. Kernels would double the size of
        // the solver, and the maps of a page have only a few points.
        if cfg!(target_family = "wasm") {
            return Vec::new();
        }
        match model {
            ModelChoice::Auto => return auto::solve(arch, self, settings.tolerance),
            ModelChoice::Fixed(Model::ClosedForm) => {
                arch.dispatch(RowKernel { kernel: ClosedFormKernel, rows: self });
            }
            ModelChoice::Fixed(Model::QuasiStatic) => {
                arch.dispatch(RowKernel { kernel: QuasiStaticKernel, rows: self });
            }
            ModelChoice::Fixed(Model::Rigid) => {
                arch.dispatch(RowKernel { kernel: RigidKernel, rows: self });
            }
            ModelChoice::Fixed(Model::RacewayControl) => {
                let kernel = RacewayKernel { control: settings.control };
                arch.dispatch(RowKernel { kernel, rows: self });
            }
            ModelChoice::Fixed(Model::Elastic) => {
                arch.dispatch(RowKernel { kernel: ElasticKernel, rows: self });
            }
            // The traction model has no kernel, because its friction integrals for a single point
            // already use all elements of the SIMD vectors.
            ModelChoice::Fixed(Model::Traction) => {}
        }
        Vec::new()
    }
}
