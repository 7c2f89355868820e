//! Nuts: identities, public cases and campaigns.

mod campaign;
mod identities;
mod nuts;
mod public;
mod train;
mod warm;
