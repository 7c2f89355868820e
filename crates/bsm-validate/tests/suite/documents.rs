//! Documents, labels and messages: no forbidden term, no link that leads nowhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::sources::files;

/// Names of the libraries that plot and draw in space.
const OF_LIBRARIES: [&str; 3] = ["scene as drawing", "render_scene", "three.scene"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("UTF-8 text")
}

/// Markdown of the repository, but the changelog, which quotes what was.
fn documents() -> Vec<PathBuf> {
    let folders = ["docs", "validation", "python", "benches"].map(|name| root().join(name));
    let mut found: Vec<_> = folders.iter().flat_map(|folder| files(folder, "md")).collect();
    found.extend(["README.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    found.retain(|path| !path.components().any(|part| part.as_os_str() == "target"));
    found
}

/// A text in one line of small letters, without the marks of comments and of broken strings.
fn plain(text: &str) -> String {
    let line = |line: &str| {
        let line = line.trim().trim_end_matches('\\');
        line.trim_start_matches(['/', '!', '#']).trim().to_lowercase()
    };
    let words = text.lines().map(line).collect::<Vec<_>>().join(" ");
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The terms of the list, each with what stands in its place.
fn terms() -> Vec<(String, String)> {
    let list = read(&root().join("docs/forbidden-terms.txt"));
    let lines = list.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let pair = |line: &str| {
        let (term, better) = line.split_once("=>").expect("a term, =>, and a better one");
        (plain(term), better.trim().to_owned())
    };
    lines.map(pair).collect()
}

/// True if a text has a term as whole words, also with a plural s.
fn holds(text: &str, term: &str) -> bool {
    text.match_indices(term).any(|(at, _)| {
        let after = &text[at + term.len()..];
        let after = after.strip_prefix('s').unwrap_or(after);
        !text[..at].ends_with(char::is_alphanumeric) && !after.starts_with(char::is_alphanumeric)
    })
}

#[test]
fn terms_are_whole_words() {
    assert!(holds("the caps of cap_sizes", "cap") && holds("of cap_sizes", "cap"));
    assert!(!holds("a landscape", "cap") && !holds("a capital", "cap"));
}

#[test]
fn broken_strings_and_comments_are_one_text() {
    let text = "    \"Nine of \\\n     ten\" // draws\n/// of Oil\n";
    assert_eq!(plain(text), "\"nine of ten\" // draws of oil");
}

#[test]
fn no_text_uses_a_forbidden_term() {
    let terms = terms();
    assert!(terms.len() > 40, "{} terms", terms.len());
    let mut texts = documents();
    for entry in fs::read_dir(root().join("crates")).expect("crates") {
        let folder = entry.expect("folder entry").path();
        for (name, ending) in
            [("src", "rs"), ("tests", "rs"), ("page", "js"), ("templates", "html")]
        {
            if folder.join(name).is_dir() {
                texts.extend(files(&folder.join(name), ending));
            }
        }
    }
    texts.retain(|path| !path.components().any(|part| part.as_os_str() == "vendor"));
    texts.extend(files(&root().join("python/ballscrew"), "py"));
    texts.extend(files(&root().join("python/src"), "rs"));
    assert!(texts.len() > 300, "{} texts", texts.len());
    let mut found = Vec::new();
    for path in texts {
        let text = plain(&read(&path));
        let text = OF_LIBRARIES.iter().fold(text, |text, name| text.replace(name, ""));
        for (term, better) in &terms {
            if holds(&text, term) {
                found.push(format!("{}: \"{term}\": write: {better}", path.display()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The addresses of links, `](address)`, outside of fences.
fn links(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    let after = prose.flat_map(|piece| piece.split("](").skip(1));
    after.filter_map(|s| Some(s.split_once(')')?.0)).collect()
}

/// The anchors of headings, as GitHub makes them: small letters, spaces as hyphens, without other signs.
fn anchors(text: &str) -> BTreeSet<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let heading = |line: &str| {
        let title = line.strip_prefix('#')?.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
        Some(kept.map(|c| if c == ' ' { '-' } else { c }).collect())
    };
    prose.lines().filter_map(heading).collect()
}

#[test]
fn links_lead_to_files_and_headings() {
    let (mut seen, mut wrong) = (0, Vec::new());
    for path in documents() {
        let text = read(&path);
        for link in links(&text).into_iter().filter(|link| !link.contains("://")) {
            seen += 1;
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => path.with_file_name("").join(file),
            };
            let is_there = target.exists()
                && (heading.is_empty() || anchors(&read(&target)).contains(heading));
            if !is_there {
                wrong.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(seen > 100, "{seen} links");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
