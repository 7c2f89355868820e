//! Several numbers at once, on the widest instruction set of the machine: AVX-512, AVX2, the
//! portable scalar path, or that of another processor, chosen while the program runs.
//!
//! Every operation is one of IEEE 754 on each number by itself, in the order that is written, and
//! nothing is fused: results are the same on every instruction set and in every lane.

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

mod lane;
mod root;
mod trigonometry;

pub use lane::{Lane, Mask};
pub use pulp::{Arch, Simd, WithSimd};

/// Numbers that are worked on together: the widest vectors hold as many.
pub const BLOCK: usize = 8;

/// One number of each point of a group.
pub type Block = [f64; BLOCK];
