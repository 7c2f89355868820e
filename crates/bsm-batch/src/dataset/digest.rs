//! SHA-256 as text in files.

use std::fmt::Write as _;
use std::io::{self, Read};

use sha2::{Digest, Sha256};

/// Number of bytes that are read at a time.
const BLOCK: usize = 1 << 18;

/// Returns a hash in lower-case hexadecimal digits.
pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Returns the hash of bytes.
pub(crate) fn of_bytes(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

/// Returns the hash and the number of all bytes of a reader, or `None` if `stopped` returns true
/// before the end.
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

    /// Test vector of FIPS 180-2, appendix B.1.
    #[test]
    fn the_hash_of_abc_matches_fips_180() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(of_bytes(b"abc"), abc);
        let read = of_reader(&mut &b"abc"[..], || false).expect("memory");
        assert_eq!(read, Some((abc.to_owned(), 3)));
        assert_eq!(of_reader(&mut &b"abc"[..], || true).expect("memory"), None);
    }
}
