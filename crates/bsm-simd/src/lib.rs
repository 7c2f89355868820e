//! Several numbers at once, on the widest instruction set of the machine: AVX-512, AVX2, the
//! portable scalar path, or that of another processor, chosen while the program runs.
//!
//! Every operation is one of IEEE 754 on each number by itself, in the order that is written, fused
//! only where that is written: results are the same on every instruction set and in every lane.

mod compare;
mod exponential;
mod lane;
mod polynomial;
mod root;
mod trigonometry;

pub use compare::Compare;
pub use lane::{Lane, Mask};
pub use polynomial::polynomial;
pub use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};

/// Numbers that are worked on together: the widest vectors hold as many.
pub const BLOCK: usize = 8;

/// One number of each point of a group.
pub type Block = [f64; BLOCK];

/// Short name of an instruction set.
pub fn name(arch: Arch) -> &'static str {
    match arch {
        Arch::Scalar => "portable",
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Arch::V4(_) => "AVX-512",
        _ => "vectors",
    }
}

/// Runs code for a few numbers, on vectors of half the length where there are such: square roots and quotients of the
/// longest ones take twice as long.
#[inline(always)]
pub fn for_few<S: Simd, W: WithSimd>(simd: S, code: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(longest) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>() {
        return code.with_simd(**longest);
    }
    code.with_simd(simd)
}

/// The instruction sets that programs can choose from on this machine, the widest last.
///
/// For tests that results do not depend on it, and for benches.
pub fn instruction_sets() -> Vec<Arch> {
    #[cfg_attr(
        not(target_arch = "x86_64"),
        expect(unused_mut, reason = "other processors have one")
    )]
    let mut all = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        all.extend(pulp::x86::V3::try_new().map(Arch::V3));
        all.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    all
}

#[cfg(test)]
mod tests;
