//! Every equation tag in the code exists in the theory, and the other way round.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Tags such as `(K12)` or `\tag{K12}` in all files under `dir` with extension `ext`.
fn tags(dir: &Path, ext: &str, found: &mut BTreeSet<String>) {
    for entry in fs::read_dir(dir).expect("source folder") {
        let path = entry.expect("folder entry").path();
        if path.is_dir() {
            tags(&path, ext, found);
        } else if path.extension().is_some_and(|e| e == ext) {
            let text = fs::read_to_string(&path).expect("UTF-8 text");
            let cited = text.split('(').skip(1).filter_map(|s| tag(s.split_once(')')?.0));
            found.extend(cited);
            let stated = text.split("\\tag{").skip(1).filter_map(|s| tag(s.split_once('}')?.0));
            found.extend(stated);
        }
    }
}

/// One capital and at least one digit.
fn tag(s: &str) -> Option<String> {
    let digits = s.strip_prefix(|c: char| c.is_ascii_uppercase())?;
    (!digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())).then(|| s.to_owned())
}

#[test]
fn code_and_theory_cite_the_same_equations() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut code, mut theory) = (BTreeSet::new(), BTreeSet::new());
    for krate in ["bsm-kin", "bsm-dyn", "bsm-newton", "bsm-batch", "bsm-design"] {
        tags(&root.join("crates").join(krate).join("src"), "rs", &mut code);
    }
    tags(&root.join("docs/theory"), "md", &mut theory);
    assert!(code.len() > 50, "{code:?}");

    let only_code: Vec<_> = code.difference(&theory).collect();
    let only_theory: Vec<_> = theory.difference(&code).collect();
    assert!(only_code.is_empty(), "cited in the code, absent from docs/theory: {only_code:?}");
    assert!(only_theory.is_empty(), "in docs/theory, cited by no code: {only_theory:?}");
}

/// Each equation is stated once in the theory: one `\tag{...}` per tag.
#[test]
fn the_theory_states_each_equation_once() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/theory");
    let (mut seen, mut twice) = (BTreeSet::new(), Vec::new());
    for entry in fs::read_dir(folder).expect("theory") {
        let text = fs::read_to_string(entry.expect("entry").path()).expect("UTF-8 text");
        for piece in text.split("\\tag{").skip(1) {
            let name = piece.split_once('}').expect("closed tag").0.to_owned();
            if !seen.insert(name.clone()) {
                twice.push(name);
            }
        }
    }
    assert!(twice.is_empty(), "stated twice: {twice:?}");
    let mut cited = BTreeSet::new();
    tags(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/theory"), "md", &mut cited);
    let unstated: Vec<_> = cited.difference(&seen).collect();
    assert!(unstated.is_empty(), "cited but never stated: {unstated:?}");
}
