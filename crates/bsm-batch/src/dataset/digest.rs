//! SHA-256 hashes in hexadecimal form.

use std::fmt::Write as _;
use std::io::{self, Read};

use sha2::{Digest, Sha256};

/// Number of bytes that are read and hashed at a time.
const BLOCK: usize = 1 << 18;

/// Returns a hash as lowercase hexadecimal digits.
pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail, so the result is ignored.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Returns the hash of a byte string.
pub(crate) fn of_bytes(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

/// Reads a reader to its end, and returns the hash and the number of the bytes. Returns `None` if
/// `stopped` returns true before the last byte has been read.
pub(crate) fn of_reader(
    reader: &mut impl Read,
    stopped: impl Fn() -> bool,
) -> io::Result<Option<(String, u64)>> {
    let mut hash = Sha256::new();
    let mut block = vec![0; BLOCK];
    let mut bytes = 0;
    while !stopped() {
        match reader.read(&mut block) {
            Ok(0) => return Ok(Some((hex(hash), bytes))),
            Ok(read) => {
                hash.update(&block[..read]);
                bytes += read as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected hash is the test vector in appendix B.1 of FIPS 180-2.
    #[test]
    fn the_hash_of_abc_matches_fips_180() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(of_bytes(b"abc"), abc);
        let read = of_reader(&mut &b"abc"[..], || false).expect("memory");
        assert_eq!(read, Some((abc.to_owned(), 3)));
        assert_eq!(of_reader(&mut &b"abc"[..], || true).expect("memory"), None);
    }
}
