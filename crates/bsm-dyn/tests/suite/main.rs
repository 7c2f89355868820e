//! Limiting cases, failures and campaigns of the models.

mod elastic;
mod extremes;
mod lanes;
mod rigid;
mod rigid_campaign;
mod train;
