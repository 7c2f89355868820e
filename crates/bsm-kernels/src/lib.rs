//! Vector kernels that solve the models for several points at a time, with the widest instruction
//! set of the machine.
//!
//! A kernel evaluates the direct solution of its model for lanes. Rows that a kernel cannot solve
//! are passed to the scalar solver, `Problem::solve` of `bsm-dyn`, which also generates the
//! messages. Tests compare the results of kernels and models.

mod auto;
mod closed_form;
mod contacts;
mod elastic;
mod kernel;
mod operand;
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

pub use self::kernel::{OutputColumn, RowChoice, Rows, Selection};
pub use operand::{InputColumn, InputColumns, is_plain};

impl Rows<'_, '_> {
    /// Solves all rows for which the model has a direct solution. For `auto`, returns the selected
    /// model of each solved row; otherwise, returns an empty vector.
    pub fn solve(self, arch: Arch, model: ModelChoice, settings: &Settings) -> Vec<RowChoice> {
        // Kernels would double the size of the solver in a saved page, whose maps have few points.
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
            // Traction has no kernel, because the friction integrals of a single point already fill
            // the lanes.
            ModelChoice::Fixed(Model::Traction) => {}
        }
        Vec::new()
    }
}
