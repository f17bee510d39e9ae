//! Notes the commit that the module is built from.
//!
//! No place of libmujoco is written into the module: the wheel brings its own beside it, and the package's build finds it by
//! cargo's search path.

fn main() {
    println!("cargo::rerun-if-changed=../../.git/logs/HEAD");
    let commit = std::process::Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok();
    let commit = commit
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .map_or_else(|| "unknown".to_string(), |text| text.trim().to_string());
    println!("cargo::rustc-env=RAMP_COMMIT={commit}");
    // Symbols of Python are resolved when it loads the module.
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        println!("cargo::rustc-link-arg-cdylib=-undefined");
        println!("cargo::rustc-link-arg-cdylib=dynamic_lookup");
    }
}
