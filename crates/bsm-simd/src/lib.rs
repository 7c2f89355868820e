//! Arithmetic on several numbers at once, with the widest SIMD instruction set of the machine. The
//! crate supports AVX-512, AVX2, vector instructions of other processors, and portable scalar code.
//! The instruction set is selected at run time.
//!
//! Every operation is an IEEE 754 operation on each number. Operations are executed in the order in
//! which they are written, and are fused only where the code requests it. The results are therefore
//! identical for every instruction set and every position in a lane. WebAssembly is an exception,
//! because it has no fused operations.
//!
//! In this example, [`Arch`] selects the instruction set and runs the calculation for two
//! triangles:
//!
//! ```
//! use bsm_simd::{Arch, BLOCK, Lane, Simd, WithSimd};
//!
//! /// Calculates the hypotenuses of right triangles from their legs.
//! struct Hypotenuses {
//!     legs: [[f64; 2]; 2],
//! }
//!
//! impl WithSimd for Hypotenuses {
//!     type Output = [f64; 2];
//!
//!     fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
//!         let [a, b] = self.legs.map(|leg| Lane::<S, BLOCK>::load(simd, &leg));
//!         let mut lengths = [0.0; 2];
//!         a.mul_add(a, b * b).sqrt().store(&mut lengths);
//!         lengths
//!     }
//! }
//!
//! let lengths = Arch::new().dispatch(Hypotenuses { legs: [[3.0, 5.0], [4.0, 12.0]] });
//! assert_eq!(lengths, [5.0, 13.0]);
//! ```

mod exponential;
mod lane;
mod polynomial;
mod root;
mod trigonometry;

pub use lane::{Lane, Mask};
pub use polynomial::polynomial;
/// From the crate `pulp`: the instruction set and the code that runs with it.
pub use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};

/// Number of values that are processed together, which is the number of values in the widest
/// vectors.
pub const BLOCK: usize = 8;

/// A block with one number for each of [`BLOCK`] points.
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

/// Runs code that processes only a few numbers. On processors with AVX-512, the code uses AVX2
/// vectors of half the width, because square roots and divisions take twice as long with the widest
/// vectors.
#[inline(always)]
pub fn for_few<S: Simd, W: WithSimd>(simd: S, code: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(longest) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>() {
        return code.with_simd(**longest);
    }
    code.with_simd(simd)
}

/// Returns the instruction sets that are available on this machine, in order of increasing width.
///
/// Tests use this function to show that results do not depend on the instruction set. Benchmarks
/// use it to compare the speed of instruction sets.
pub fn instruction_sets() -> Vec<Arch> {
    #[cfg_attr(
        not(target_arch = "x86_64"),
        expect(unused_mut, reason = "other processors support one")
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
