//! Looks for the solver of saved pages, which the script `page-solver` in this folder builds.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(page_solver)");
    if env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
        // The solver does not contain the page.
        println!("cargo::rerun-if-changed=build.rs");
        // The stack of the solver [B]. The default is 1 MB.
        println!("cargo::rustc-link-arg-examples=-zstack-size=8388608");
        return;
    }
    // A folder, because a missing file would count as changed in every build.
    println!("cargo::rerun-if-changed=page");
    if Path::new("page/solver.wasm.gz.base64").exists() {
        println!("cargo::rustc-cfg=page_solver");
    }
}
