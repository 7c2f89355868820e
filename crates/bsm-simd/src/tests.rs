//! Test macro that evaluates formulas on blocks of numbers with SIMD vectors.

/// Defines a type that contains one block of numbers per variable. Dispatching a value of this type
/// to an instruction set evaluates the formulas and returns one block of numbers per formula.
macro_rules! by_lanes {
    ($name:ident { $($x:ident),+ } -> $count:literal: $values:expr) => {
        struct $name {
            $($x: $crate::Block,)+
        }

        impl $crate::WithSimd for $name {
            type Output = [$crate::Block; $count];

            #[inline(always)]
            fn with_simd<S: $crate::Simd>(self, simd: S) -> Self::Output {
                let mut found = [[0.0; $crate::BLOCK]; $count];
                for at in (0..$crate::BLOCK).step_by(S::F64_LANES) {
                    $(let $x = $crate::Lane::<S>::load(simd, &self.$x[at..]);)+
                    for (found, value) in found.iter_mut().zip($values) {
                        value.store(&mut found[at..]);
                    }
                }
                found
            }
        }
    };
}
pub(crate) use by_lanes;
