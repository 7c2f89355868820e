//! The models, ordered by increasing number of inputs, and their shared code.

mod auto;
mod ball;
mod closed_form;
mod elastic;
mod gothic;
mod lubricated;
mod lubricated_arch;
mod permanent_set;
mod problem;
mod quasi_static;
mod raceway_control;
mod rigid;
mod slip;
mod static_ball;
mod traction;
mod workspace;

pub use self::{
    auto::*, ball::*, closed_form::*, elastic::*, gothic::*, lubricated::*, lubricated_arch::*,
    permanent_set::*, problem::*, quasi_static::*, raceway_control::*, rigid::*, slip::*,
    static_ball::*, traction::*, workspace::*,
};
