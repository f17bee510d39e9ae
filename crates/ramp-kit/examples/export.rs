//! Exports a kit: `cargo run -p ramp-kit --features export --example export -- data/kit.xml OUT`.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::PathBuf;

fn main() -> miette::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [kit, out] = arguments.as_slice() else { miette::bail!("expected a kit file and a folder") };
    for file in ramp_kit::export::export(&ramp_kit::read_kit(kit)?, out, false)? {
        println!("{}", file.display());
    }
    Ok(())
}
