//! Conversion of numbers to text: with all significant digits for programs, and with five or two
//! digits for readers.

use std::io::{self, Write};

use bsm_design::statistics::Band;

/// Formats a number with the fewest decimal digits that reproduce the number when read back. CSV
/// tables contain this format. Numbers of at least 1e16 and numbers below 1e-5 have an exponent,
/// and integers have no decimal point.
///
/// JSON output has the same digits, but whole numbers end with `.0` to distinguish them from
/// counts.
pub fn format_exact(value: f64) -> String {
    let mut text = Vec::with_capacity(24);
    // Writing to a buffer in memory cannot fail.
    let _ = write_exact(&mut text, value);
    String::from_utf8_lossy(&text).into_owned()
}

/// Writes a number in the format of [`format_exact`].
///
/// # Errors
/// Returns the same errors as the writer.
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

/// Formats a number with five significant digits. Fixed notation is used if it is readable.
pub fn format_number(value: f64) -> String {
    format_digits(value, 5)
}

/// Formats a number with the given number of significant digits. Fixed notation is used if it is
/// readable. All digits before the decimal point are shown.
pub fn format_digits(value: f64, count: u8) -> String {
    let magnitude = value.abs();
    let after = i32::from(count) - 1;
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&magnitude) {
        return format!("{value:.*e}", usize::from(count - 1));
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent is between -4 and 6")]
    let decimals = (after - magnitude.log10().floor() as i32).max(0);
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
}

/// Formats a number with at most five significant digits, like [`format_number`] but without trailing
/// zeros.
pub fn format_trimmed(value: f64) -> String {
    let text = format_number(value);
    if text.contains('e') || !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats a 90 % interval as " (low to high)", with three digits, or with five digits if the
/// interval is narrow. The ends are rounded outward, so the interval in the text contains every
/// value of the exact interval. The text is empty if there is no interval.
pub fn format_interval(band: Option<Band>) -> String {
    band.map_or_else(String::new, |band| {
        let (count, Band { low, high }) = (digits_of_interval(band), band);
        let text =
            |end: f64, outward: fn(f64) -> f64| format_digits(rounded(end, count, outward), count);
        format!(" ({} to {})", text(low, f64::floor), text(high, f64::ceil))
    })
}

/// Formats a number with as many digits as its 90 % interval, followed by the interval.
pub fn format_with_interval(value: f64, band: Band) -> String {
    format_digits(value, digits_of_interval(band)) + &format_interval(Some(band))
}

/// Returns the number of digits with which an interval is shown.
fn digits_of_interval(Band { low, high }: Band) -> u8 {
    /// Relative width below which three digits are not sufficient to show an interval.
    const NARROW: f64 = 0.02;
    if high - low < NARROW * low.abs().max(high.abs()) { 5 } else { 3 }
}

/// Rounds a number up or down to the number of digits that [`format_digits`] returns. If a number
/// with this many digits differs from the given number only by rounding errors, that number is
/// returned.
fn rounded(value: f64, count: u8, towards: fn(f64) -> f64) -> f64 {
    /// Largest rounding error, in units of the last shown digit.
    const ROUNDING: f64 = 1e-6;
    if value == 0.0 {
        return value;
    }
    let exponent = value.abs().log10().floor() + 1.0 - f64::from(count);
    let is_fixed = (1e-4..1e6).contains(&value.abs());
    let last = 10_f64.powf(if is_fixed { exponent.min(0.0) } else { exponent });
    let (units, nearest) = (value / last, (value / last).round());
    last * if (units - nearest).abs() < ROUNDING { nearest } else { towards(units) }
}

/// Formats a number with two significant digits, for tables of times and errors. All digits before
/// the decimal point are shown. Numbers below 1e-3 have an exponent.
pub fn format_short(value: f64) -> String {
    if value.abs() > 0.0 && value.abs() < 1e-3 {
        return format!("{value:.1e}");
    }
    format_digits(value, 2)
}

/// Rounds a dimension to a multiple of 1e-9 to remove the rounding errors of unit conversions.
pub(crate) fn decimal(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// Converts a floating-point number whose value is an integer, such as a count from a case file, to
/// an integer.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "every number is rounded or checked to be an integer, and is at most the maximum number of balls"
)]
pub(crate) fn whole(value: f64) -> usize {
    value.round() as usize
}

/// Converts an integer count to a floating-point number.
#[expect(clippy::cast_precision_loss, reason = "numbers of circuits and balls")]
pub(crate) fn count(n: usize) -> f64 {
    n as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_numbers_are_printed_with_the_fewest_digits_that_round_trip() {
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
            assert_eq!(format_exact(value), text);
            let back = text.parse::<f64>().expect("a number");
            assert!(value.is_nan() || back.to_bits() == value.to_bits());
        }
    }

    /// Regression test: the text "3.1750 (2.78 to 3.17)" stated an interval that excluded its own
    /// value.
    #[test]
    fn printed_interval_contains_the_exact_interval() {
        for (low, high, text) in [
            (2.778, 3.175, " (2.77 to 3.18)"),
            (0.511, 0.534, " (0.511 to 0.534)"),
            (949.2, 1415.3, " (949 to 1416)"),
            (-1.841, -1.762, " (-1.85 to -1.76)"),
            (0.974_862, 0.978_731, " (0.97486 to 0.97874)"),
            (1.234e7, 2.341e7, " (1.23e7 to 2.35e7)"),
            (0.0, 3e-5, " (0 to 3.00e-5)"),
        ] {
            assert_eq!(format_interval(Some(Band { low, high })), text);
        }
    }

    #[test]
    fn numbers_in_default_format_are_printed_with_five_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.860_106_9, "0.86011"),
            (-3.25, "-3.2500"),
            (123_456.7, "123457"),
            (1.234_567e6, "1.2346e6"),
            (-4.5e-5, "-4.5000e-5"),
            (0.000_123_456, "0.00012346"),
        ] {
            assert_eq!(format_number(value), text);
        }
    }

    #[test]
    fn numbers_in_short_format_are_printed_with_two_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (203.8, "204"),
            (9.94, "9.9"),
            (0.164, "0.16"),
            (0.0088, "0.0088"),
            (1.8e-7, "1.8e-7"),
        ] {
            assert_eq!(format_short(value), text);
        }
    }
}
