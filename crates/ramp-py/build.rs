//! Notes the commit that the module is built from.
//!
//! No place of libmujoco is written into the module: the wheel brings its own beside it, and the package's
//! build finds it by cargo's search path.

#[path = "../../tools/commit.rs"]
mod commit;

fn main() {
    commit::main();
    // Symbols of Python are resolved when it loads the module.
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        println!("cargo::rustc-link-arg-cdylib=-undefined");
        println!("cargo::rustc-link-arg-cdylib=dynamic_lookup");
    }
}
