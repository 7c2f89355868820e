//! Scenes, rules, analyses and reports.

mod analysis;
mod capacity;
mod catalogue;
mod design;
mod hard_points;
mod lubricant;
mod rated;
mod scene;
mod sensitivities;
mod size;
mod train;
mod warm;
