//! Makes the git commit of the source tree available to the program, for `bsm --version`
//! and for the description of a table.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The program is rebuilt if the file `logs/HEAD` changes, which happens with every commit and
    // checkout. A source tree without git has no such file.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo:rerun-if-changed={log}");
    }
    let version = env!("CARGO_PKG_VERSION");
    let commit = git(&["rev-parse", "--short=9", "HEAD"]);
    if let Some(commit) = &commit {
        println!("cargo:rustc-env=BSM_COMMIT={commit}");
    }
    let described =
        commit.map_or_else(|| version.to_owned(), |commit| format!("{version} ({commit})"));
    println!("cargo:rustc-env=BSM_VERSION={described}");
}

/// Runs git and returns the line that it prints, or `None` if git fails or is not installed.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
