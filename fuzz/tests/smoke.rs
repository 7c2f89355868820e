//! The corpus and some thousand seeded mutations of it; `fuzz/run.sh` goes on from here.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use bsm_fuzz::{Target, mutate};
use bsm_sample::campaign;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Silence of this length is an endless loop: no input may take as long, see `Target::check`.
const PATIENCE: Duration = Duration::from_secs(120);

/// Replays the corpus of a target and a campaign of mutations, and names the input that breaks it.
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
        match heard.recv_timeout(PATIENCE) {
            Ok(what) => last = what,
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => panic!("{name} hangs: {last}"),
        }
    }
    assert!(worker.join().is_ok(), "{name}: {last}");
}

#[test]
fn cases() {
    smoke("case", 300);
}

#[test]
fn nuts() {
    smoke("nut", 100);
}

#[test]
fn the_solve_path() {
    smoke("solve", 300);
}

#[test]
fn words_of_the_command_line() {
    smoke("words", 1000);
}

#[test]
fn csv_tables() {
    smoke("csv", 1000);
}

#[test]
fn json_lines() {
    smoke("json-lines", 1000);
}

#[test]
fn parquet_tables() {
    smoke("parquet", 1000);
}

#[test]
fn requirements() {
    smoke("requirement", 10);
}

#[test]
fn catalogues() {
    smoke("catalogue", 300);
}
