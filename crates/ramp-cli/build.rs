//! Links libmujoco, and notes the commit that the program is built from.

#[path = "../../tools/link_mujoco.rs"]
mod link_mujoco;

fn main() {
    link_mujoco::main();
    println!("cargo::rerun-if-changed=../../.git/logs/HEAD");
    let commit = std::process::Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok();
    let commit = commit
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .map_or_else(|| "unknown".to_string(), |text| text.trim().to_string());
    println!("cargo::rustc-env=RAMP_COMMIT={commit}");
}
