//! The contact between ball and groove: geometry, Hertz pressure, friction, lubricant and force
//! balance.

mod angles;
mod balance;
mod friction;
mod hertz;
mod jam;
mod jones;
mod lubricant;
mod transition;

pub(crate) use self::jones::*;
pub use self::{
    angles::*, balance::*, friction::*, hertz::*, jam::*, lubricant::film_state::*,
    lubricant::losses::*, lubricant::mixed::*, lubricant::oil::*, lubricant::*, transition::*,
};
