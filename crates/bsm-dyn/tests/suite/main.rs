//! Tests of the models: limiting cases, expected failures, and campaigns over random screws.

mod elastic;
mod extremes;
mod lanes;
mod rigid;
mod rigid_campaign;
mod train;
