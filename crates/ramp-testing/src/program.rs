//! The command line as a process: runs it in a folder, and reads the words that it prints.

use std::path::Path;
use std::process::{Command, Output};

/// Runs a program in a folder until it ends, without input.
pub fn run(program: &str, folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    Command::new(program).current_dir(folder).args(arguments).output().unwrap()
}

/// Output of a program as text.
#[must_use]
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The words in the output of a program, without the borders and line breaks that miette adds.
#[must_use]
pub fn words(bytes: &[u8]) -> String {
    let plain = text(bytes).replace(['│', '╭', '╰', '─', '·'], " ");
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}
