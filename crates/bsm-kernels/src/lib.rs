//! Vector kernels: the models for several points at a time, on the widest instruction set of the
//! machine.
//!
//! A kernel solves the ordinary points of its model and leaves all other points to the model
//! itself, which also writes the messages. The formulas are those of the model, evaluated for
//! lanes. Tests compare the results of kernel and model.

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

pub use self::kernel::{RowChoice, Rows, Selection};
pub use operand::{InputColumn, InputColumns, is_plain};

impl Rows<'_, '_> {
    /// Solves the ordinary rows of a model. For `auto`, the result contains the chosen model of each
    /// row; otherwise it is empty.
    pub fn solve(self, arch: Arch, model: ModelChoice, settings: &Settings) -> Vec<RowChoice> {
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
            // Friction sums fill the lanes of a single point.
            ModelChoice::Fixed(Model::Traction) => {}
        }
        Vec::new()
    }
}
