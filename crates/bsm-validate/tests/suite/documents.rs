//! Tests of the links in Markdown documents.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::sources::files;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("UTF-8 text")
}

/// Returns the paths of all Markdown files in the repository.
fn documents() -> Vec<PathBuf> {
    let folders = ["docs", "validation", "python", "benches"].map(|name| root().join(name));
    let mut found: Vec<_> = folders.iter().flat_map(|folder| files(folder, "md")).collect();
    found.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name)));
    found.retain(|path| !path.components().any(|part| part.as_os_str() == "target"));
    found
}

/// Returns the targets of all links (`](target)`) outside code blocks.
fn links(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    let after = prose.flat_map(|piece| piece.split("](").skip(1));
    after.filter_map(|s| Some(s.split_once(')')?.0)).collect()
}

/// Returns the anchors that GitHub creates for the headings of a document. An anchor is in
/// lowercase, and has hyphens instead of spaces and no other punctuation.
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
fn links_point_to_existing_files_and_headings() {
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
