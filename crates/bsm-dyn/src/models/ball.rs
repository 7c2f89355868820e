//! Components that all models use: the operating point, the ball and its unknowns, and the
//! structure of a solution.

mod ball_contacts;
pub(crate) mod ball_unknowns;
mod elastic_ball;
mod equations;
mod film;
mod model;
mod operating_point;
mod sensitivity;
mod solution;
mod state;
mod weyl;

pub use self::{
    ball_contacts::*, elastic_ball::*, film::*, model::*, operating_point::*, sensitivity::*,
    solution::*, state::*,
};
pub(crate) use self::{ball_unknowns::*, equations::*, weyl::*};
pub(crate) use crate::outcome::*;
