//! Build script of every crate whose programs or tests link libmujoco: writes the library's folder into their
//! rpath, so that they start without any environment variable.

// A build script speaks to cargo on standard output.
#![allow(clippy::print_stdout)]

/// The build script.
pub fn main() {
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    println!("cargo::rerun-if-changed=../../tools/link_mujoco.rs");
    let own = std::env::var("MUJOCO_DYNAMIC_LINK_DIR").ok();
    let fetched = format!("{}/../../.deps/mujoco-3.17.0", env!("CARGO_MANIFEST_DIR"));
    let folder = own.unwrap_or(fetched);
    let folder = std::fs::canonicalize(&folder).unwrap_or_else(|_| folder.into());
    // An installed program searches its own prefix first, where tools/install puts the library.
    let here = if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        "@loader_path"
    } else {
        "$ORIGIN"
    };
    println!("cargo::rustc-link-arg=-Wl,-rpath,{here}/../lib");
    println!("cargo::rustc-link-arg=-Wl,-rpath,{}", folder.display());
}
