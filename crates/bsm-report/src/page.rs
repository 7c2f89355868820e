//! Self-contained HTML pages for screen, phone and print. Each page is a single file that includes
//! its figures and needs no network. Only this module uses the template engine.

use minijinja::value::Value;
use minijinja::{Environment, UndefinedBehavior, context};
use serde::Serialize;

use crate::{Figure, ReportError, format_number, format_short};

/// Name and version of the program, as written into the files that it creates.
pub const PROGRAM: &str = concat!("bsm ", env!("CARGO_PKG_VERSION"));

/// Style sheet for all pages, in light and dark mode.
pub const STYLE: &str = include_str!("../templates/page.css");

/// Names and texts of the templates that all pages share.
const PARTS: [(&str, &str); 2] =
    [("base.html", include_str!("../templates/base.html")), ("page.css", STYLE)];

/// An HTML page that is created from a template.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// Command that created the page, which is stated in the footer.
    pub command: &'a str,
    /// Template for the contents, which fills the block `content` of `base.html`. It can use the
    /// filters `number`, `short`, `unit` and `symbol`, the macro `figure`, and the list `figures`.
    pub template: &'a str,
    /// Figures that the page contains.
    pub figures: &'a [Figure],
}

impl Page<'_> {
    /// Returns the page as HTML. The template can use the fields of `content`.
    ///
    /// # Errors
    ///
    /// Returns [`ReportError::Page`] if the template is invalid or uses an unknown name.
    pub fn html(&self, content: &impl Serialize) -> Result<String, ReportError> {
        let figure = |f: &Figure| {
            let svg = f.inline_svg()?;
            Ok(context! { title => f.title, caption => f.caption, svg => svg })
        };
        let figures: Vec<_> =
            self.figures.iter().map(figure).collect::<Result<_, ReportError>>()?;
        let context = context! {
            title => self.title,
            command => self.command,
            program => PROGRAM,
            figures,
            ..Value::from_serialize(content)
        };
        let mut environment = Environment::new();
        // In strict mode, an unknown name is an error instead of an empty cell.
        environment.set_undefined_behavior(UndefinedBehavior::Strict);
        environment.add_filter("number", format_number);
        environment.add_filter("short", format_short);
        environment.add_filter("unit", unit);
        environment.add_filter("symbol", |text: &str| Value::from_safe_string(symbol(text)));
        for (name, source) in PARTS {
            environment.add_template(name, source)?;
        }
        // The template engine escapes inserted text because the template name ends with .html.
        environment.add_template("content.html", self.template)?;
        Ok(environment.get_template("content.html")?.render(context)?)
    }
}

/// Returns a unit in typographic form: \u{b5}m instead of um, and superscript exponents.
fn unit(text: &str) -> String {
    let part = |part: &str| match part {
        "um" => "\u{b5}m".to_owned(),
        "uin" => "\u{b5}in".to_owned(),
        "deg" | "C" => part.replace("deg", "\u{b0}").replace('C', "\u{b0}C"),
        "degF" => "\u{b0}F".to_owned(),
        _ => part.replace("m2", "m\u{b2}").replace("in2", "in\u{b2}").replace("s2", "s\u{b2}"),
    };
    let of_product = |text: &str| text.split(' ').map(part).collect::<Vec<_>>().join("\u{a0}");
    text.split('/').map(of_product).collect::<Vec<_>>().join("/")
}

/// Returns a symbol as HTML. Text after an underscore becomes a subscript, and names of Greek
/// letters become Greek letters.
fn symbol(text: &str) -> String {
    const GREEK: [(&str, &str); 8] = [
        ("alpha", "α"),
        ("eta", "η"),
        ("kappa", "κ"),
        ("mu", "μ"),
        ("nu", "ν"),
        ("phi", "φ"),
        ("lambda", "λ"),
        ("tau", "τ"),
    ];
    let one = |word: &str| {
        let (head, low) = word.split_once('_').unwrap_or((word, ""));
        let head = GREEK.iter().find(|(name, _)| *name == head).map_or(head, |(_, letter)| letter);
        if low.is_empty() { head.to_owned() } else { format!("{head}<sub>{low}</sub>") }
    };
    text.split(' ').map(one).collect::<Vec<_>>().join("&#8202;")
}

/// Returns the paths and contents of the files for all figures. Each figure has an SVG file and a
/// table.
///
/// # Errors
///
/// Returns [`ReportError`] if a table of a figure cannot be written.
pub fn figure_files(
    folder: &str,
    figures: &[Figure],
) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = Vec::new();
    for figure in figures {
        files.push((format!("{folder}{}.svg", figure.key), figure.svg()?));
        files.push((format!("{folder}{}.csv", figure.key), figure.csv()?));
    }
    Ok(files)
}

/// Returns the paths and contents of all files of a report: the page, the numbers, and an SVG file
/// and a table for each figure.
///
/// # Errors
///
/// Returns [`ReportError`] if a table of a figure cannot be written.
pub fn report_files(
    page: String,
    results: &serde_json::Value,
    figures: &[Figure],
) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = figure_files("figures/", figures)?;
    files.push(("results.json".to_owned(), format!("{results:#}\n")));
    files.push(("report.html".to_owned(), page));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inserted text must be escaped, and an unknown name must be an error.
    #[test]
    fn page_templates_escape_text_and_reject_unknown_variables() {
        let page = |template| {
            let page = Page { title: "a < b", command: "bsm", template, figures: &[] };
            page.html(&std::collections::BTreeMap::from([("value", 0.164)]))
        };
        let html = page(
            "{% extends \"base.html\" %}{% block content %}{{ value|short }} us{% endblock %}",
        );
        let html = html.expect("a page");
        assert!(html.contains("<h1>a &lt; b</h1>"), "{html}");
        assert!(html.contains("0.16 us"), "{html}");
        assert!(matches!(page("{{ missing }}"), Err(ReportError::Page(_))));
    }

    #[test]
    fn units_are_written_with_exponents_and_greek_letters() {
        for (text, typographic) in [
            ("um/m", "\u{b5}m/m"),
            ("uin", "\u{b5}in"),
            ("deg", "\u{b0}"),
            ("C", "\u{b0}C"),
            ("degF", "\u{b0}F"),
            ("m/s2", "m/s\u{b2}"),
            ("kg m2", "kg\u{a0}m\u{b2}"),
            ("lb in2", "lb\u{a0}in\u{b2}"),
            ("W/(m2 K)", "W/(m\u{b2}\u{a0}K)"),
            ("N m", "N\u{a0}m"),
            ("mm/min", "mm/min"),
        ] {
            assert_eq!(unit(text), typographic, "{text}");
        }
    }

    #[test]
    fn symbols_are_written_with_subscripts_and_greek_letters() {
        for (text, html) in [
            ("F", "F"),
            ("F_pr", "F<sub>pr</sub>"),
            ("eta", "η"),
            ("mu_b", "μ<sub>b</sub>"),
            ("C_a F_m", "C<sub>a</sub>&#8202;F<sub>m</sub>"),
            ("delta_x", "delta<sub>x</sub>"),
        ] {
            assert_eq!(symbol(text), html, "{text}");
        }
    }
}
