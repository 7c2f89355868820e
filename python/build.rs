//! Sets linker options for macOS, where the symbols of Python are resolved when the module is
//! loaded.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        for part in ["-undefined", "dynamic_lookup"] {
            println!("cargo::rustc-cdylib-link-arg={part}");
        }
    }
}
