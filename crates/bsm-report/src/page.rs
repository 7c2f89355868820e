//! Pages that consist of one file each and contain their figures, for screen, phone and print. They
//! need no network. This is the only file that uses the template engine.

use minijinja::value::Value;
use minijinja::{Environment, UndefinedBehavior, context};
use serde::Serialize;

use crate::{Figure, ReportError, number, short};

/// Name and version of the program, as written to its files.
pub const PROGRAM: &str = concat!("bsm ", env!("CARGO_PKG_VERSION"));

/// Colors and styles of every page, in light and dark mode.
pub const STYLE: &str = include_str!("../templates/page.css");

/// Templates that every page shares.
const PARTS: [(&str, &str); 2] =
    [("base.html", include_str!("../templates/base.html")), ("page.css", STYLE)];

/// A page.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// Command that creates the page.
    pub command: &'a str,
    /// The contents, a template that fills the block `content` of `base.html`. It can use the
    /// filters `number` and `short`, the macro `figure`, and `figures`.
    pub template: &'a str,
    /// The figures.
    pub figures: &'a [Figure],
}

impl Page<'_> {
    /// Returns the page as HTML. The fields of `content` are available to the template.
    ///
    /// # Errors
    ///
    /// [`ReportError::Page`] if the template is wrong or uses an unknown name.
    pub fn html(&self, content: &impl Serialize) -> Result<String, ReportError> {
        let figure =
            |f: &Figure| context! { title => f.title, caption => f.caption, svg => f.inline_svg() };
        let figures: Vec<_> = self.figures.iter().map(figure).collect();
        let context = context! {
            title => self.title,
            command => self.command,
            program => PROGRAM,
            figures,
            ..Value::from_serialize(content)
        };
        let mut environment = Environment::new();
        // An unknown name is an error, not an empty cell.
        environment.set_undefined_behavior(UndefinedBehavior::Strict);
        environment.add_filter("number", number);
        environment.add_filter("short", short);
        environment.add_filter("unit", unit);
        environment.add_filter("symbol", |text: &str| Value::from_safe_string(symbol(text)));
        for (name, source) in PARTS {
            environment.add_template(name, source)?;
        }
        // With this file ending, inserted text is escaped.
        environment.add_template("content.html", self.template)?;
        Ok(environment.get_template("content.html")?.render(context)?)
    }
}

/// Returns a unit with the signs of print: \u{b5}m instead of um, and exponents.
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

/// Returns a symbol as HTML. Text after an underscore is a subscript, and Greek letters are given
/// by their names.
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

/// Returns each figure as SVG and as a table, by their paths.
///
/// # Errors
///
/// [`ReportError`] if a table of a figure cannot be written.
pub fn figure_files(
    folder: &str,
    figures: &[Figure],
) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = Vec::new();
    for figure in figures {
        files.push((format!("{folder}{}.svg", figure.key), figure.svg()));
        files.push((format!("{folder}{}.csv", figure.key), figure.csv()?));
    }
    Ok(files)
}

/// Returns the files of a report, by their paths in its folder: the page, the numbers, and each
/// figure as SVG and as a table.
///
/// # Errors
///
/// [`ReportError`] if a table of a figure cannot be written.
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

    /// Inserted text is escaped, and an unknown name is an error.
    #[test]
    fn pages_escape_text_and_reject_unknown_names() {
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
}
