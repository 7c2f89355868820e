//! Pages that consist of one file each and contain their figures, for screen, phone and print. They
//! need no network. This is the only file that uses the template engine.

use minijinja::value::Value;
use minijinja::{Environment, UndefinedBehavior, context};
use serde::Serialize;

use crate::{Figure, ReportError, number, short};

/// Name and version of the program, in its files.
pub const PROGRAM: &str = concat!("bsm ", env!("CARGO_PKG_VERSION"));

/// Colours and styles of every page, light and dark.
pub const STYLE: &str = include_str!("../templates/page.css");

/// Parts of every page.
const PARTS: [(&str, &str); 2] =
    [("base.html", include_str!("../templates/base.html")), ("page.css", STYLE)];

/// A page.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// Its heading.
    pub title: &'a str,
    /// The command that makes it.
    pub command: &'a str,
    /// What it shows, a template that fills the block `content` of `base.html`: it has the filters
    /// `number` and `short`, the macro `figure`, and `figures`.
    pub template: &'a str,
    /// The figures.
    pub figures: &'a [Figure],
}

impl Page<'_> {
    /// The page as HTML, with the fields of `content` for the template.
    ///
    /// # Errors
    ///
    /// [`ReportError::Page`] if the template is wrong or names what is not there.
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
        // A name that is not there is an error, not an empty cell.
        environment.set_undefined_behavior(UndefinedBehavior::Strict);
        environment.add_filter("number", number);
        environment.add_filter("short", short);
        environment.add_filter("symbol", |text: &str| Value::from_safe_string(symbol(text)));
        for (name, source) in PARTS {
            environment.add_template(name, source)?;
        }
        // The ending says that what is filled in is escaped.
        environment.add_template("content.html", self.template)?;
        Ok(environment.get_template("content.html")?.render(context)?)
    }
}

/// A symbol of the field as HTML: what follows a low line stands lower, and Greek letters have names.
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

/// Each figure as SVG and as a table, by their paths.
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

/// The files of a report, by their paths in its folder: page, numbers, and each figure as SVG and as a table.
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

    /// What is filled in is text, and a name that is not there is an error.
    #[test]
    fn pages_escape_and_are_strict() {
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
