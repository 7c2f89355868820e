//! Checks that a browser can render every formula in doc comments and Markdown documents.

use crate::sources;

use std::fs;
use std::path::{Path, PathBuf};

use pulldown_latex::{Parser, Storage};

use self::sources::files;

/// Returns the formulas in a Markdown text. They are `math` blocks and texts between `open` and
/// `close`.
fn formulas(text: &str, (open, close): (&str, &str)) -> Vec<String> {
    let (mut found, mut prose) = (Vec::new(), String::new());
    // Every second piece of the text, beginning with the second piece, is a code block.
    for (i, piece) in text.split("```").enumerate() {
        match piece.strip_prefix("math") {
            Some(formula) if i % 2 == 1 => found.push(formula.to_owned()),
            _ if i % 2 == 1 => {}
            _ => prose.push_str(piece),
        }
    }
    let mut rest = prose.as_str();
    while let Some((formula, after)) = rest.split_once(open).and_then(|s| s.1.split_once(close)) {
        found.push(formula.to_owned());
        rest = after;
    }
    found
}

/// Returns the text of all doc comments in a file.
fn doc_comments(code: &str) -> String {
    let line = |line: &str| {
        let line = line.trim_start();
        let text = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        text.unwrap_or_default().to_owned() + "\n"
    };
    code.lines().map(line).collect()
}

/// Returns the reason why a formula cannot be rendered, or `None` if it can be rendered. Equation
/// tags such as `\tag{K1}` are removed first.
fn formula_defect(formula: &str) -> Option<String> {
    let mut pieces = formula.split("\\tag{");
    let mut bare = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        bare.push_str(piece.split_once('}').map_or("", |(_, rest)| rest));
    }
    let storage = Storage::new();
    let error = Parser::new(&bare, &storage).find_map(Result::err);
    error.map(|error| error.to_string())
}

#[test]
fn formula_check_detects_invalid_latex() {
    assert_eq!(formula_defect("\\frac{a}{b} \\tag{K1}"), None);
    for wrong in ["\\frac{a}", "{a", "\\nosuchcommand", "\\left( a"] {
        assert!(formula_defect(wrong).is_some(), "{wrong}");
    }
}

#[test]
fn every_formula_in_the_documentation_is_valid_latex() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut all = Vec::new();
    for path in files(&root.join("crates"), "rs") {
        let text = doc_comments(&fs::read_to_string(&path).expect("UTF-8 text"));
        all.extend(
            formulas(&text, ("`$", "$`")).into_iter().map(|formula| (path.clone(), formula)),
        );
    }
    for path in files(&root.join("docs"), "md") {
        // A formula on a line of its own is enclosed in double dollar signs, which are replaced by
        // single dollar signs.
        let text = fs::read_to_string(&path).expect("UTF-8 text").replace("$$", "$");
        all.extend(formulas(&text, ("$", "$")).into_iter().map(|formula| (path.clone(), formula)));
    }
    assert!(all.len() > 1000, "{} formulas", all.len());
    let wrong = |(path, formula): &(PathBuf, String)| {
        Some(format!("{}: {}\n{}", path.display(), formula.trim(), formula_defect(formula)?))
    };
    let wrong: Vec<_> = all.iter().filter_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
