//! Checks that the page `docs/architecture.md` and its drawing agree with the code.

use crate::sources;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Returns all code spans in a text. Each code span is returned together with the text between it
/// and the next code span.
fn code_spans(text: &str) -> Vec<(&str, &str)> {
    let pieces: Vec<_> = text.split('`').collect();
    pieces[1..].chunks(2).map(|pair| (pair[0], pair.get(1).copied().unwrap_or(""))).collect()
}

/// Every path on the page must exist. Every name in parentheses after a file must occur in this
/// file.
#[test]
fn architecture_page_names_existing_files_and_items() {
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
            let is_item = |kind| {
                let item = format!("{kind} {}", span.trim_end_matches('!'));
                code.match_indices(&item).any(|(at, _)| {
                    let next = code[at + item.len()..].chars().next();
                    next.is_none_or(|c| !c.is_alphanumeric() && c != '_')
                })
            };
            let kinds =
                ["fn", "struct", "enum", "trait", "const", "static", "type", "macro_rules!"];
            assert!(kinds.into_iter().any(is_item), "{path} has no item `{span}`");
            names += 1;
            if after.starts_with(')') {
                file = None;
            }
        }
    }
    // Smaller numbers of paths or names would mean that the page was not parsed correctly.
    assert!(paths > 40 && names > 30, "{paths} paths, {names} names");
}

/// A module of `bsm-case` may use only modules in its own folder and in folders that precede it in
/// this list.
#[test]
fn modules_of_bsm_case_use_only_preceding_folders() {
    const FOLDERS: [&str; 3] = ["vocabulary", "case", "answers"];
    let source = root().join("crates/bsm-case/src");
    let code = |path: &Path| {
        let text = fs::read_to_string(path).expect("a module");
        text.split("#[cfg(test)]").next().unwrap_or_default().to_owned()
    };
    // The map assigns each name that the crate exports to the position of its folder in `FOLDERS`.
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

/// Models of `bsm-dyn`, each with the models that it may use. A model may use only models that
/// precede it in this list.
const MODELS: [(&str, &[&str]); 15] = [
    ("closed_form", &[]),
    ("quasi_static", &["closed_form"]),
    ("permanent_set", &[]),
    ("static_ball", &[]),
    ("rigid", &[]),
    ("raceway_control", &[]),
    ("slip", &["raceway_control"]),
    ("elastic", &[]),
    // Model `traction` starts its iteration from the solutions for pure rolling and for gross slip.
    ("traction", &["raceway_control", "elastic"]),
    // Model `gothic` starts its iteration from the solution for a ball with two contacts.
    ("gothic", &["traction"]),
    // The module `workspace` contains the buffers of the solvers. A model passes these buffers on
    // to the models that it calls.
    ("workspace", &["rigid", "raceway_control", "elastic", "traction", "gothic"]),
    ("lubricated", &["raceway_control", "traction", "workspace"]),
    // Model `lubricated_arch` adds the losses of a third contact to the losses of a lubricated
    // ball.
    ("lubricated_arch", &["traction", "gothic", "workspace", "lubricated"]),
    ("auto", &["raceway_control", "elastic", "traction", "workspace"]),
    (
        "problem",
        &[
            "closed_form",
            "quasi_static",
            "rigid",
            "raceway_control",
            "elastic",
            "traction",
            "gothic",
            "workspace",
            "lubricated",
            "lubricated_arch",
            "auto",
        ],
    ),
];

/// Returns the modules that the code of a file names, as paths from the crate root. For example,
/// `crate::contact::Hertz` names the module `contact`. In `models/rigid/root.rs`, the path
/// `super::ball::RigidBall` means `models::rigid::ball::RigidBall`.
fn modules_named_in(module: &[&str], code: &str) -> Vec<Vec<String>> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut named = Vec::new();
    for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
        let starts = line.match_indices("crate::").chain(line.match_indices("super::"));
        for (at, word) in starts {
            let before = &line[..at];
            let path = line[at..].split(|c| !is_name(c)).next().unwrap_or_default();
            let ups = path.split("::").take_while(|part| *part == "super").count();
            // In `super::super`, the second `super` has already been counted together with the
            // first.
            if before.ends_with("super::") || (word == "super::" && ups > module.len()) {
                continue;
            }
            let base = if word == "crate::" { &[][..] } else { &module[..module.len() - ups] };
            let rest = path.split("::").skip(ups.max(1)).filter(|part| !part.is_empty());
            named.push(base.iter().copied().chain(rest).map(str::to_owned).collect());
        }
    }
    named
}

/// The crate `bsm-dyn` has three layers: contact, ellipse and models. A layer may use only the
/// layers below it. A model may use only `models/ball`, which all models share, and the models that
/// [`MODELS`] permits. No module may use a name that the crate root exports.
#[test]
fn modules_of_bsm_dyn_use_only_lower_layers() {
    const LAYERS: [&str; 3] = ["contact", "ellipse", "models"];
    for (at, (model, parts)) in MODELS.iter().enumerate() {
        let before = |part: &&str| MODELS[..at].iter().any(|(name, _)| name == part);
        assert!(parts.iter().all(before), "{model} comes before what it is made of");
    }
    let source = root().join("crates/bsm-dyn/src");
    let mut seen = 0;
    for file in sources::files(&source, "rs") {
        let path = file.strip_prefix(&source).expect("a source").with_extension("");
        let module: Vec<_> = path.iter().map(|part| part.to_str().expect("UTF-8")).collect();
        if module == ["lib"] || module.contains(&"tests") {
            continue;
        }
        seen += 1;
        let text = fs::read_to_string(&file).expect("a module");
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        // The modules for the solve status and the evaluation counter are below all layers.
        let rank = |name: &str| LAYERS.iter().position(|layer| *layer == name).map_or(0, |i| i + 1);
        for used in modules_named_in(&module, code) {
            let [layer, rest @ ..] = &used[..] else {
                panic!("{} names the face of the crate", path.display())
            };
            let own = [&LAYERS[..], &["outcome", "cost"]].concat();
            assert!(own.contains(&layer.as_str()), "{} takes {used:?} from lib.rs", path.display());
            assert!(rank(layer) <= rank(module[0]), "{} names {used:?}, above it", path.display());
            let ([_, model, ..], Some(other)) = (&module[..], rest.first()) else { continue };
            if layer != "models" || other == model || other == "ball" {
                continue;
            }
            let parts = MODELS.iter().find(|(name, _)| name == model).map_or(&[][..], |m| m.1);
            let memory = other == "workspace" && *model == "traction";
            assert!(
                memory || parts.contains(&other.as_str()),
                "{} names {used:?}: no part of {model}",
                path.display()
            );
        }
    }
    assert!(seen > 60, "{seen} modules");
}

/// The imports between the files of a solver crate must not form a cycle of any length. A module
/// that is declared with `mod` counts as part of the file that declares it.
#[test]
fn files_have_no_circular_imports() {
    for name in ["kin", "simd", "newton", "dyn", "kernels", "nut", "design", "batch"] {
        let source = root().join(format!("crates/bsm-{name}/src"));
        let mut files = BTreeMap::new();
        for file in sources::files(&source, "rs") {
            let path = file.strip_prefix(&source).expect("a source").with_extension("");
            let module: Vec<_> = path.iter().map(|part| part.to_str().expect("UTF-8")).collect();
            if module == ["lib"] || module.contains(&"tests") {
                continue;
            }
            let text = fs::read_to_string(&file).expect("a module");
            let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
            files.insert(module.join("::"), modules_named_in(&module, code));
        }
        let (count, mut left) = (files.len(), files.keys().cloned().collect::<BTreeSet<_>>());
        // A file that imports none of the remaining files cannot be part of a cycle, so it is
        // removed.
        loop {
            let is_left = |used: &Vec<String>, own: &str| {
                let mut paths = (1..=used.len()).rev().map(|end| used[..end].join("::"));
                let file = paths.find(|path| files.contains_key(path));
                file.is_some_and(|file| file != own && left.contains(&file))
            };
            let imports = |own: &&String| files[*own].iter().any(|used| is_left(used, own));
            let next: BTreeSet<_> = left.iter().filter(imports).cloned().collect();
            if next.len() == left.len() {
                break;
            }
            left = next;
        }
        assert!(left.is_empty() && count > 4, "{count} files of bsm-{name}, in circles {left:?}");
    }
}

/// Returns the dependencies of each crate on other crates of this workspace, as listed in its
/// manifest under `[dependencies]`.
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

/// Returns the arrows of the drawing: for each crate, the crates to which its arrows point.
fn arrows() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("docs/img/architecture.dot")).expect("the drawing");
    let mut arrows = BTreeMap::<_, BTreeSet<_>>::new();
    for (from, to) in text.lines().filter_map(|line| line.trim().split_once(" -> ")) {
        let name = |s: &str| s.trim_matches(['"', ';']).to_owned();
        arrows.entry(name(from)).or_default().insert(name(to));
    }
    arrows
}

/// Returns all crates that can be reached from a crate by following the arrows of the drawing.
fn reachable_crates(from: &str, edges: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let next = edges.get(from).into_iter().flatten();
    next.flat_map(|to| reachable_crates(to, edges).into_iter().chain([to.clone()])).collect()
}

/// Each arrow must represent a dependency. Each dependency must be drawn as an arrow or follow from
/// a chain of arrows.
#[test]
fn the_architecture_drawing_shows_all_dependencies() {
    let (manifests, arrows) = (manifests(), arrows());
    assert!(manifests.len() > 10, "{manifests:?}");
    for (from, to) in &arrows {
        let missing: Vec<_> = to.difference(&manifests[from]).collect();
        assert!(missing.is_empty(), "the drawing has {from} -> {missing:?}, the manifest not");
    }
    for (name, dependencies) in &manifests {
        let drawn = reachable_crates(name, &arrows);
        let missing: Vec<_> = dependencies.difference(&drawn).collect();
        assert!(missing.is_empty(), "{name} builds on {missing:?}, which the drawing lacks");
    }
    let report = reachable_crates("bsm-report", &manifests);
    assert!(!report.contains("bsm-kernels"), "sheets are of answers, not of tables: {report:?}");
}

/// If the test build of a crate is disabled, the crate must not contain tests, except in files that
/// its test suite includes.
#[test]
fn every_test_is_compiled() {
    let mut included = 0;
    for folder in fs::read_dir(root().join("crates")).expect("crates") {
        let folder = folder.expect("a crate").path();
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
        if !manifest.contains("\ntest = false\n") {
            continue;
        }
        let suite = fs::read_to_string(folder.join("tests/suite/main.rs")).unwrap_or_default();
        for file in sources::files(&folder.join("src"), "rs") {
            if fs::read_to_string(&file).expect("a module").contains("#[test]") {
                let path = file.strip_prefix(&folder).expect("in the crate").display();
                assert!(suite.contains(&format!("#[path = \"../../{path}\"]")), "{path}");
                included += 1;
            }
        }
    }
    assert!(included > 0, "no crate without a test build has tests");
}
