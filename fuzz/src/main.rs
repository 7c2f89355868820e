//! Runs libFuzzer on the target whose name is in the environment variable `BSM_FUZZ` (see run.sh).

#![no_main]

use std::sync::LazyLock;

use bsm_fuzz::{Target, mutate};
use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

static TARGET: LazyLock<Target> = LazyLock::new(|| {
    let name = std::env::var("BSM_FUZZ").expect("BSM_FUZZ names a target");
    Target::named(&name).expect("the name of a target")
});

fuzz_target!(|input: &[u8]| TARGET.check(input));

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.into());
    // Half of the mutations take the structure of the input into account; libFuzzer generates the
    // other half.
    if rng.random() {
        return fuzzer_mutate(data, size, max_size);
    }
    let mutated = mutate(&data[..size], &mut rng);
    let len = mutated.len().min(max_size);
    data[..len].copy_from_slice(&mutated[..len]);
    len
});
