//! Random mutations of an input, which preserve its structure or deliberately break it.

use bsm_case::{CATALOG, INPUTS, OUTPUTS, REQUIREMENT_INPUTS};
use rand::{Rng, RngExt};

/// Numbers near or beyond the limits of the parsers, of floating-point arithmetic, and of
/// physically meaningful values.
const NUMBERS: [&str; 40] = [
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "2",
    "45",
    "89.999999999",
    "90",
    "1e-3",
    "1e3",
    "1e-9",
    "1e9",
    "1e15",
    "1e-15",
    "1e16",
    "-1e6",
    "1e100",
    "-1e100",
    "1e-100",
    "1e154",
    "1e155",
    "1e-162",
    "1e300",
    "-1e300",
    "1e-300",
    "1.7976931348623157e308",
    "2.2250738585072014e-308",
    "5e-324",
    "1e-320",
    "1e309",
    "NaN",
    "inf",
    "-inf",
    "9007199254740993",
    "18446744073709551616",
    "0x10",
    "1,5",
    "1_000",
    "",
];

/// Pieces of syntax that open or close a structure, or that parsers often misread.
const PIECES: [&[u8]; 24] = [
    b"\"",
    b"\"\"",
    b"'",
    b"\0",
    b"\xff",
    b"\xc3",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\r\n",
    b"\n",
    b"\r",
    b",",
    b";",
    b"\t",
    b":",
    b"=",
    b"{",
    b"}",
    b"[",
    b"[[[[[[[[",
    b"null",
    b"{\"id\":1}",
    b"\\ud800",
    b">=",
];

/// Returns a copy of the input with one to four random mutations.
pub fn mutate(input: &[u8], rng: &mut impl Rng) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..rng.random_range(1..=4) {
        if input.starts_with(b"PAR1") {
            mutate_binary(&mut bytes, rng);
        } else {
            mutate_text(&mut bytes, rng);
        }
    }
    bytes
}

fn mutate_text(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    let part_of_word = |b: &u8| b.is_ascii_alphanumeric() || b"_.+-".contains(b);
    // The word around a random position extends from `start` to `end`.
    let at = rng.random_range(0..=bytes.len());
    let start = bytes[..at].iter().rposition(|b| !part_of_word(b)).map_or(0, |i| i + 1);
    let end = at + bytes[at..].iter().position(|b| !part_of_word(b)).unwrap_or(bytes.len() - at);
    match rng.random_range(0..8) {
        0..=2 => put(bytes, start, end, pick(&NUMBERS, rng).as_bytes()),
        3 => {
            let value = f64::from_bits(rng.random());
            put(bytes, start, end, value.to_string().as_bytes());
        }
        4 => put(bytes, start, end, name(rng).as_bytes()),
        5 => put(bytes, at, at, pick(&PIECES, rng)),
        6 => copy(bytes, rng),
        _ => mutate_binary(bytes, rng),
    }
}

fn mutate_binary(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    if bytes.is_empty() {
        return;
    }
    // Half of the mutations are limited to the end of the file, which contains the footer of a
    // Parquet file.
    let tail = if rng.random() { bytes.len().min(600) } else { bytes.len() };
    let at = bytes.len() - rng.random_range(1..=tail);
    match rng.random_range(0..6) {
        0 => bytes[at] = rng.random(),
        1 => bytes[at] ^= 1 << rng.random_range(0..8),
        // These bytes are the variable-length encoding of the largest 32-bit integer.
        2 => put(bytes, at, at + 1, &[0xff, 0xff, 0xff, 0xff, 0x0f]),
        3 => put(bytes, at, at + 1, &[]),
        4 => bytes.truncate(at),
        _ => copy(bytes, rng),
    }
}

/// Replaces the bytes from `start` to `end` by other bytes.
fn put(bytes: &mut Vec<u8>, start: usize, end: usize, by: &[u8]) {
    bytes.splice(start..end, by.iter().copied());
}

/// Inserts a copy of a random range of bytes at another random position.
fn copy(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    let mut places = [(); 3].map(|()| rng.random_range(0..=bytes.len()));
    places[..2].sort_unstable();
    let piece = bytes[places[0]..places[1]].to_vec();
    put(bytes, places[2], places[2], &piece);
}

fn pick<'a, T: ?Sized>(from: &[&'a T], rng: &mut impl Rng) -> &'a T {
    from[rng.random_range(0..from.len())]
}

/// Returns the name of a random input, requirement, output or catalog column.
fn name(rng: &mut impl Rng) -> &'static str {
    match rng.random_range(0..8) {
        0 => REQUIREMENT_INPUTS[rng.random_range(0..REQUIREMENT_INPUTS.len())].name,
        1 => CATALOG[rng.random_range(0..CATALOG.len())].name,
        2 => OUTPUTS[rng.random_range(0..OUTPUTS.len())].name,
        _ => INPUTS[rng.random_range(0..INPUTS.len())].name,
    }
}
