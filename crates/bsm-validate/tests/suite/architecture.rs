//! `docs/architecture.md` and its drawing say what is there.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Code spans with what stands between each and the next.
fn code_spans(text: &str) -> Vec<(&str, &str)> {
    let pieces: Vec<_> = text.split('`').collect();
    pieces[1..].chunks(2).map(|pair| (pair[0], pair.get(1).copied().unwrap_or(""))).collect()
}

/// Every path exists, and every name in brackets after a file is in that file.
#[test]
fn the_recipes_name_what_exists() {
    let text = fs::read_to_string(root().join("docs/architecture.md")).expect("the page");
    let places = ["crates/", "docs/", "validation/", "README.md", "CHANGELOG.md"];
    let (mut paths, mut names) = (0, 0);
    let mut file: Option<(&str, String)> = None;
    for (span, after) in code_spans(&text) {
        let is_path = places.iter().any(|place| span.starts_with(place));
        if is_path {
            assert!(root().join(span).exists(), "{span} does not exist");
            paths += 1;
            file = after.trim_start().starts_with('(').then(|| {
                (span, fs::read_to_string(root().join(span)).expect("names are of a file"))
            });
        } else if let Some((path, code)) = &file {
            assert!(code.contains(span), "{path} has no `{span}`");
            names += 1;
            if after.starts_with(')') {
                file = None;
            }
        }
    }
    // That few would mean that the page is read wrongly.
    assert!(paths > 40 && names > 30, "{paths} paths, {names} names");
}

/// Modules of `bsm-case`: each may use what stands in its own folder and in those before it.
#[test]
fn a_case_knows_no_answer() {
    const FOLDERS: [&str; 3] = ["vocabulary", "case", "answers"];
    let source = root().join("crates/bsm-case/src");
    let code = |path: &Path| {
        let text = fs::read_to_string(path).expect("a module");
        text.split("#[cfg(test)]").next().unwrap_or_default().to_owned()
    };
    // Names that the crate takes from its folders.
    let face = code(&source.join("lib.rs"));
    let mut names = BTreeMap::new();
    for line in face.split(';') {
        for (rank, folder) in FOLDERS.into_iter().enumerate() {
            let Some((_, path)) = line.split_once(&format!("use {folder}::")) else { continue };
            let of_path = path.split(|c: char| !c.is_alphanumeric() && c != '_');
            names.extend(of_path.map(|name| (name.to_owned(), rank)));
        }
    }
    assert!(names.len() > 60, "{names:?}");
    let mut files = 0;
    let mut folders: Vec<_> = (0..).zip(FOLDERS.map(|folder| source.join(folder))).collect();
    while let Some((rank, folder)) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push((rank, path));
                continue;
            }
            if path.extension().is_none_or(|ending| ending != "rs") {
                continue;
            }
            files += 1;
            for used in code(&path).split("crate::").skip(1) {
                let list = if used.starts_with('{') { used.split('}').next() } else { None };
                let list = list.unwrap_or_else(|| {
                    used.split(|c: char| !c.is_alphanumeric() && c != '_')
                        .next()
                        .unwrap_or_default()
                });
                for name in list.split(|c: char| !c.is_alphanumeric() && c != '_') {
                    let folder = FOLDERS.iter().position(|folder| *folder == name);
                    let theirs = folder.or(names.get(name).copied()).unwrap_or(0);
                    assert!(theirs <= rank, "{} uses {name}", path.display());
                }
            }
        }
    }
    assert!(files > 35, "{files} modules");
}

/// Our crates under `[dependencies]` of the manifests, by the name of the crate.
fn manifests() -> BTreeMap<String, BTreeSet<String>> {
    let crates = fs::read_dir(root().join("crates")).expect("crates");
    let folders = crates.map(|entry| entry.expect("entry").path());
    let others = ["benches", "fuzz"].map(|name| root().join(name));
    let manifest = |folder: PathBuf| {
        let text = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
        let name = text.split("name = \"").nth(1).and_then(|s| s.split('"').next());
        let mut ours = BTreeSet::new();
        let mut section = "";
        for line in text.lines() {
            if line.starts_with('[') {
                section = line;
            } else if section == "[dependencies]" && line.starts_with("bsm-") {
                ours.extend(line.split(['.', ' ']).next().map(str::to_owned));
            }
        }
        (name.expect("a name").to_owned(), ours)
    };
    folders.chain(others).map(manifest).collect()
}

/// The arrows of the drawing.
fn arrows() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("docs/img/architecture.dot")).expect("the drawing");
    let mut arrows = BTreeMap::<_, BTreeSet<_>>::new();
    for (from, to) in text.lines().filter_map(|line| line.trim().split_once(" -> ")) {
        let name = |s: &str| s.trim_matches(['"', ';']).to_owned();
        arrows.entry(name(from)).or_default().insert(name(to));
    }
    arrows
}

/// What can be reached from a crate.
fn reached(from: &str, edges: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let next = edges.get(from).into_iter().flatten();
    next.flat_map(|to| reached(to, edges).into_iter().chain([to.clone()])).collect()
}

/// Each arrow is a dependency, and each dependency is an arrow or follows from arrows.
#[test]
fn the_drawing_shows_the_dependencies() {
    let (manifests, arrows) = (manifests(), arrows());
    assert!(manifests.len() > 10, "{manifests:?}");
    for (from, to) in &arrows {
        let missing: Vec<_> = to.difference(&manifests[from]).collect();
        assert!(missing.is_empty(), "the drawing has {from} -> {missing:?}, the manifest not");
    }
    for (name, dependencies) in &manifests {
        let drawn = reached(name, &arrows);
        let missing: Vec<_> = dependencies.difference(&drawn).collect();
        assert!(missing.is_empty(), "{name} builds on {missing:?}, which the drawing lacks");
    }
    let report = reached("bsm-report", &manifests);
    assert!(!report.contains("bsm-kernels"), "sheets are of answers, not of tables: {report:?}");
}
