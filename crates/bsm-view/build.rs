//! Checks whether the solver for saved pages exists. The script `page-solver` in this folder builds
//! this solver.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(page_solver)");
    if env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
        // The solver does not contain the page, so changes to the page do not require a new build.
        println!("cargo::rerun-if-changed=build.rs");
        // Stack size of the solver [B]. The default is 1 MB.
        println!("cargo::rustc-link-arg-examples=-zstack-size=8388608");
        return;
    }
    // The whole folder is watched, because cargo would treat a missing file as changed in every
    // build.
    println!("cargo::rerun-if-changed=page");
    if Path::new("page/solver.wasm.gz.base64").exists() {
        println!("cargo::rustc-cfg=page_solver");
    }
}
