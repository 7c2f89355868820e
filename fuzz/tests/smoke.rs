//! Runs all fuzz targets with the corpus and with random mutations of the corpus. For longer
//! fuzzing, use `fuzz/run.sh`.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use bsm_fuzz::{Target, mutate};
use bsm_sample::campaign;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Time without progress after which an input is assumed to cause an endless loop. The limit in
/// `Target::check` is shorter.
const TIME_LIMIT: Duration = Duration::from_secs(120);

/// Runs a target with its corpus and with random mutations of the corpus. If an input fails, the
/// panic message states which input.
fn smoke(name: &'static str, mutations: usize) {
    let target = Target::named(name).expect("a target");
    let (done, heard) = channel();
    let worker = thread::spawn(move || {
        let corpus = target.corpus();
        assert!(!corpus.is_empty(), "{name} has a corpus");
        let feed = |what: &str, input: &[u8]| {
            let _ = done.send(what.to_owned());
            let fed = catch_unwind(AssertUnwindSafe(|| target.check(input)));
            assert!(fed.is_ok(), "{what}: {}", input.escape_ascii());
        };
        for (file, input) in &corpus {
            feed(file, input);
        }
        for seed in 0..campaign(mutations) as u64 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let (file, input) = &corpus[rng.random_range(0..corpus.len())];
            feed(&format!("{file}, seed {seed}"), &mutate(input, &mut rng));
        }
    });
    let mut last = String::new();
    loop {
        match heard.recv_timeout(TIME_LIMIT) {
            Ok(what) => last = what,
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => panic!("{name} hangs: {last}"),
        }
    }
    assert!(worker.join().is_ok(), "{name}: {last}");
}

#[test]
fn mutated_cases_cause_no_panic() {
    smoke("case", 300);
}

#[test]
fn mutated_nuts_cause_no_panic() {
    smoke("nut", 100);
}

#[test]
fn mutated_settings_cause_no_panic() {
    smoke("solve", 300);
}

#[test]
fn mutated_command_line_arguments_cause_no_panic() {
    smoke("words", 1000);
}

#[test]
fn mutated_csv_tables_cause_no_panic() {
    smoke("csv", 1000);
}

#[test]
fn mutated_json_lines_cause_no_panic() {
    smoke("json-lines", 1000);
}

#[test]
fn mutated_parquet_tables_cause_no_panic() {
    smoke("parquet", 1000);
}

#[test]
fn mutated_requirements_cause_no_panic() {
    smoke("requirement", 10);
}

#[test]
fn mutated_catalogs_cause_no_panic() {
    smoke("catalog", 300);
}
