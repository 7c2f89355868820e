//! On macOS a module of Python leaves the names of Python to be found when it is loaded.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        for part in ["-undefined", "dynamic_lookup"] {
            println!("cargo::rustc-cdylib-link-arg={part}");
        }
    }
}
