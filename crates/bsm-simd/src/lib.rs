//! Arithmetic on several numbers at once, with the widest instruction set of the machine: AVX-512,
//! AVX2, the instruction set of another processor, or portable scalar code. The instruction set is
//! chosen at run time.
//!
//! Every operation is an IEEE 754 operation on each number. Operations are executed in the order in
//! which they are written and are fused only where the code says so. Results are therefore the same
//! on every instruction set and in every lane. WebAssembly is an exception, because it has no fused
//! operations.

mod exponential;
mod lane;
mod polynomial;
mod root;
mod trigonometry;

pub use lane::{Lane, Mask};
pub use polynomial::polynomial;
pub use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};

/// Count of numbers that are processed together, which is the length of the widest vectors.
pub const BLOCK: usize = 8;

/// One number for each point of a group.
pub type Block = [f64; BLOCK];

/// Returns the short name of an instruction set.
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

/// Runs code for a few numbers on vectors of half the length, if the instruction set has them. On
/// the longest vectors, square roots and quotients take twice as long.
#[inline(always)]
pub fn for_few<S: Simd, W: WithSimd>(simd: S, code: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(longest) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>() {
        return code.with_simd(**longest);
    }
    code.with_simd(simd)
}

/// Returns the instruction sets that programs can choose on this machine, the widest last.
///
/// Tests use this function to show that results do not depend on the instruction set, and
/// benchmarks use it to compare instruction sets.
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
