//! Checks that every equation tag in the code also occurs in the theory chapters, and vice versa.

use crate::sources;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use self::sources::files;

/// Beginning of the sentence in a theory chapter that lists the equations evaluated only by tests.
const BY_TESTS: &str = "Only tests evaluate";

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("UTF-8 text")
}

/// Returns all equation tags in a text, such as `(K12)` or `\tag{K12}`.
fn tags(text: &str) -> BTreeSet<String> {
    let between = |open: &str, close: char| -> Vec<String> {
        text.split(open).skip(1).filter_map(|s| tag(s.split_once(close)?.0)).collect()
    };
    between("(", ')').into_iter().chain(between("\\tag{", '}')).collect()
}

/// Splits the text of a file into code that is always compiled and code that is compiled only for
/// tests. Test code begins at a line `#[cfg(test)]` and ends at the closing line with the same
/// indentation.
fn parts(text: &str) -> [String; 2] {
    let mut parts = [String::new(), String::new()];
    let mut of_tests = None;
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        let begins = line.trim() == "#[cfg(test)]";
        if begins {
            of_tests = of_tests.or(Some(indent));
        }
        let part = &mut parts[usize::from(of_tests.is_some())];
        part.push_str(line);
        part.push('\n');
        if of_tests == Some(indent) && !begins && line.ends_with(['}', ';', ',']) {
            of_tests = None;
        }
    }
    parts
}

/// Returns the files of all modules that are declared without a body (`mod name;`) in a part of a
/// file.
fn modules(file: &Path, part: &str) -> Vec<PathBuf> {
    let root = ["lib", "main", "mod"].iter().any(|name| file.file_stem() == Some(name.as_ref()));
    let folder = if root { file.with_file_name("") } else { file.with_extension("") };
    let names = part.lines().filter_map(|l| l.trim().strip_prefix("mod ")?.strip_suffix(';'));
    names.map(|name| folder.join(format!("{name}.rs"))).collect()
}

/// Returns two texts for each crate: code that is always compiled, and code that is compiled only
/// for tests.
fn crates() -> BTreeMap<String, [String; 2]> {
    let mut crates = BTreeMap::new();
    for entry in fs::read_dir(root().join("crates")).expect("crates") {
        let entry = entry.expect("folder entry");
        let root = entry.path();
        let sources = files(&root.join("src"), "rs");
        let split: Vec<_> = sources.iter().map(|file| (file, parts(&read(file)))).collect();
        let of_tests: BTreeSet<_> =
            split.iter().flat_map(|(file, [_, part])| modules(file, part)).collect();
        let [mut code, mut tests] = [String::new(), String::new()];
        for (file, [always, in_tests]) in &split {
            if of_tests.contains(*file) { &mut tests } else { &mut code }.push_str(always);
            tests.push_str(in_tests);
        }
        if root.join("tests").is_dir() {
            tests.extend(files(&root.join("tests"), "rs").iter().map(|file| read(file)));
        }
        crates.insert(entry.file_name().into_string().expect("UTF-8 name"), [code, tests]);
    }
    crates
}

/// Returns the tags of all formulas in the code. The tag of a formula is at the end of its line, or
/// at the end of the comment line above it.
fn formulas(code: &str) -> BTreeSet<String> {
    let comments = code.lines().filter_map(|line| {
        let (_, comment) =
            line.split_once("//").filter(|(_, text)| !text.starts_with(['/', '!']))?;
        tag(comment.trim_end().strip_suffix(')')?.rsplit_once('(')?.1)
    });
    comments.collect()
}

/// Parses an equation tag. It consists of one capital letter, or of AA, AB, AC or BB, followed by
/// at least one digit.
fn tag(s: &str) -> Option<String> {
    let two = ["AA", "AB", "AC", "BB"].into_iter().find_map(|letters| s.strip_prefix(letters));
    let digits = two.or(s.strip_prefix(|c: char| c.is_ascii_uppercase()))?;
    (!digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())).then(|| s.to_owned())
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn theory() -> Vec<String> {
    files(&root().join("docs/theory"), "md").iter().map(|file| read(file)).collect()
}

#[test]
fn code_and_theory_cite_the_same_equations() {
    let crates = crates();
    let [code, tests] = [0, 1]
        .map(|part| crates.values().flat_map(|text| tags(&text[part])).collect::<BTreeSet<_>>());
    let theory = theory();
    let stated: BTreeSet<_> = theory.iter().flat_map(|text| tags(text)).collect();
    let lines = theory.iter().flat_map(|text| text.lines());
    let by_tests: BTreeSet<_> = lines.filter(|l| l.contains(BY_TESTS)).flat_map(tags).collect();
    assert!(code.len() > 50 && !by_tests.is_empty(), "{code:?} {by_tests:?}");

    let only_code: Vec<_> = code.difference(&stated).collect();
    assert!(only_code.is_empty(), "cited in the code, absent from docs/theory: {only_code:?}");
    let only_tests: Vec<_> = tests.difference(&stated).collect();
    assert!(only_tests.is_empty(), "cited in tests, absent from docs/theory: {only_tests:?}");
    let only_theory: BTreeSet<_> = stated.difference(&code).cloned().collect();
    assert_eq!(only_theory, by_tests, "in docs/theory and in no code but tests: mark them there");
    let untested: Vec<_> = by_tests.difference(&tests).collect();
    assert!(untested.is_empty(), "said to be checked by tests, cited by none: {untested:?}");
}

/// Each formula must be implemented in a single crate, which all other crates use.
#[test]
fn each_formula_is_implemented_in_one_crate() {
    let mut homes = BTreeMap::<String, Vec<String>>::new();
    for (name, [code, _]) in crates() {
        for tag in formulas(&code) {
            homes.entry(tag).or_default().push(name.clone());
        }
    }
    homes.retain(|_, crates| crates.len() > 1);
    assert!(homes.is_empty(), "written in several crates: {homes:?}");
}

/// Code that is compiled only for tests must be recognized in three forms: items, modules in
/// separate files, and single lines.
#[test]
fn code_compiled_only_for_tests_is_recognized() {
    let text = "fn a() {} // (K1)\n#[cfg(test)]\nmod tests;\nmod b; // (K2)\n    #[cfg(test)]\n    \
                #[expect(x)]\n    fn c() {\n        // (K3)\n    }\n    fn d() {} // (K4)\n";
    let [always, in_tests] = parts(text);
    assert_eq!(tags(&always), BTreeSet::from(["K1", "K2", "K4"].map(str::to_owned)));
    assert_eq!(tags(&in_tests), BTreeSet::from(["K3".to_owned()]));
    let listed = "// x = y (K1), (K2)\n/// doc (K3)\nlet x = y; // x = y (K4)\n// see (K5) there\n";
    assert_eq!(formulas(listed), BTreeSet::from(["K2", "K4"].map(str::to_owned)));
    let folders = [("src/lib.rs", "src/tests.rs"), ("src/b.rs", "src/b/tests.rs")];
    for (file, module) in folders {
        assert_eq!(modules(Path::new(file), &in_tests), [Path::new(module)]);
    }
}

/// Each equation must be stated only once in the theory chapters, so each tag must have only one
/// `\tag{...}`.
#[test]
fn the_theory_states_each_equation_once() {
    let (mut seen, mut twice) = (BTreeSet::new(), Vec::new());
    for text in theory() {
        for piece in text.split("\\tag{").skip(1) {
            let name = piece.split_once('}').expect("closed tag").0.to_owned();
            if !seen.insert(name.clone()) {
                twice.push(name);
            }
        }
    }
    assert!(twice.is_empty(), "stated twice: {twice:?}");
    let cited: BTreeSet<_> = theory().iter().flat_map(|text| tags(text)).collect();
    let unstated: Vec<_> = cited.difference(&seen).collect();
    assert!(unstated.is_empty(), "cited but never stated: {unstated:?}");
}
