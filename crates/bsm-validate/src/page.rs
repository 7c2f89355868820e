//! Pages of one file each: figures inside, no network, for screen, phone and print.

use minijinja::value::Value;
use minijinja::{Environment, UndefinedBehavior, context};

use crate::figure::Figure;
use crate::tradeoff::Tradeoff;
use crate::{Report, ValidateError, Verdict};

const TEMPLATES: [(&str, &str); 4] = [
    ("base.html", include_str!("../templates/base.html")),
    ("page.css", include_str!("../templates/page.css")),
    ("validation.html", include_str!("../templates/validation.html")),
    ("tradeoff.html", include_str!("../templates/tradeoff.html")),
];

/// Name and version of the program, in what it writes.
pub const PROGRAM: &str = concat!("bsm ", env!("CARGO_PKG_VERSION"));

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

/// Page of the checks and their figures.
///
/// # Errors
///
/// [`ValidateError::Page`] if a template is wrong.
pub fn validation_page(report: &Report, figures: &[Figure]) -> Result<String, ValidateError> {
    render(
        "validation.html",
        context! {
            title => "Ball screw motion: checks against published results",
            command => "bsm validate --out DIR",
            program => PROGRAM,
            passed => report.count(Verdict::Pass),
            failed => report.count(Verdict::Fail),
            findings => report.count(Verdict::Finding),
            checks => report.checks,
            figures => values(figures),
        },
    )
}

/// Page of the measurement of speed against accuracy.
///
/// # Errors
///
/// [`ValidateError::Page`] if a template is wrong.
pub fn tradeoff_page(tradeoff: &Tradeoff) -> Result<String, ValidateError> {
    render(
        "tradeoff.html",
        context! {
            title => "Ball screw motion: speed against accuracy",
            command => "bsm tradeoff --out DIR",
            program => PROGRAM,
            figures => values(&tradeoff.figures()),
            ..Value::from_serialize(tradeoff)
        },
    )
}

fn values(figures: &[Figure]) -> Vec<Value> {
    let value =
        |f: &Figure| context! { title => f.title, caption => f.caption, svg => f.inline_svg() };
    figures.iter().map(value).collect()
}

fn render(template: &str, context: Value) -> Result<String, ValidateError> {
    let mut environment = Environment::new();
    // A name that is not there is an error, not an empty cell.
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_filter("number", number);
    environment.add_filter("short", short);
    for (name, source) in TEMPLATES {
        environment.add_template(name, source)?;
    }
    Ok(environment.get_template(template)?.render(context)?)
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
