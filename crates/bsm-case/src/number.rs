//! Numbers as text, for programs.

use std::io::{self, Write};

/// The shortest decimal that reads back as the same number, as the cells of CSV tables have it: with
/// an exponent from 1e16 on and below 1e-5, whole numbers without a point.
///
/// JSON has the same digits, and `.0` on whole numbers, which tells them from counts there.
pub fn exact(value: f64) -> String {
    let mut text = Vec::with_capacity(24);
    // Only a full disk fails, and memory is none.
    let _ = write_exact(&mut text, value);
    String::from_utf8_lossy(&text).into_owned()
}

/// Writes what [`exact`] returns.
///
/// # Errors
///
/// Those of the writer.
pub fn write_exact(to: &mut Vec<u8>, value: f64) -> io::Result<()> {
    if !value.is_finite() {
        return write!(to, "{value}");
    }
    serde_json::to_writer(&mut *to, &value)?;
    if to.ends_with(b".0") {
        to.truncate(to.len() - 2);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_one_form() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (5.0, "5"),
            (2000.5, "2000.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e15, "1000000000000000"),
            (1e16, "1e+16"),
            (1e22, "1e+22"),
            (3.18e19, "3.18e+19"),
            (1e-4, "0.0001"),
            (1e-5, "0.00001"),
            (-1.25e-7, "-1.25e-7"),
            (f64::MAX, "1.7976931348623157e+308"),
            (5e-324, "5e-324"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(exact(value), text);
            let back = text.parse::<f64>().expect("a number");
            assert!(value.is_nan() || back.to_bits() == value.to_bits());
        }
    }
}
