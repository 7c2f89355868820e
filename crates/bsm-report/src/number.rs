//! Numbers as text, for people.

/// Five significant digits, in fixed notation where that reads well.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent is between -4 and 6")]
    let decimals = (4 - magnitude.log10().floor() as i32).max(0);
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
}

/// Two digits, or all before the point, for tables of times and errors to compare.
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        10.0..1e6 => format!("{value:.0}"),
        1.0..10.0 => format!("{value:.1}"),
        0.1..1.0 => format!("{value:.2}"),
        0.01..0.1 => format!("{value:.3}"),
        1e-3..0.01 => format!("{value:.4}"),
        _ => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.860_106_9, "0.86011"),
            (-3.25, "-3.2500"),
            (123_456.7, "123457"),
            (1.234_567e6, "1.2346e6"),
            (-4.5e-5, "-4.5000e-5"),
            (0.000_123_456, "0.00012346"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn short_numbers_have_two_digits() {
        for (value, text) in [
            (0.0, "0"),
            (203.8, "204"),
            (9.94, "9.9"),
            (0.164, "0.16"),
            (0.0088, "0.0088"),
            (1.8e-7, "1.8e-7"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
