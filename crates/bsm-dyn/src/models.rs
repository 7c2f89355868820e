//! The models of the ball screw, ordered by increasing number of inputs, and the code that they
//! have in common.

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
