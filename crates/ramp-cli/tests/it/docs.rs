//! Every command of the documentation is one that the program takes, and those marked to be run do run.
//!
//! Blocks of `sh` are run, a page in one temporary folder, one block after the other. Of blocks of
//! `sh,norun`, which would take too long, and of commands of `cargo run`, the arguments are parsed.

use std::path::{Path, PathBuf};
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// README.md, CONTRIBUTING.md and all pages of the book.
fn pages() -> Vec<PathBuf> {
    let mut pages = ["README.md", "CONTRIBUTING.md"].map(|name| Path::new(ROOT).join(name)).to_vec();
    let mut folders = vec![Path::new(ROOT).join("docs/src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    pages
}

/// The blocks of a page with this info string.
fn blocks(text: &str, info: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(found) = line.trim_start().strip_prefix("```") else { continue };
        let block: Vec<&str> = lines.by_ref().take_while(|line| line.trim_start() != "```").collect();
        if found == info {
            blocks.push(block.join("\n"));
        }
    }
    blocks
}

/// The commands of a block, lines that go on put together.
fn commands(block: &str) -> Vec<String> {
    let whole = block.replace("\\\n", " ");
    let lines = whole.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(str::to_string).collect()
}

/// The error in the arguments of a `ramp` command; `None` for other programs.
fn wrong(command: &str) -> Option<String> {
    let command = command.split(" > ").next().unwrap_or(command).split(" | ").next().unwrap_or(command);
    let command = command.trim_start_matches("nohup ").trim_end_matches(" &");
    let Some(words) = shlex::split(command) else {
        // A quoted text that continues on the next line.
        return command.starts_with("ramp ").then(|| "it is no command of a shell".to_string());
    };
    let ours = match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["ramp", ..] => &words[1..],
        ["cargo", "run", rest @ ..] => &words[2 + rest.iter().position(|word| *word == "--")? + 1..],
        _ => return None,
    };
    let words = std::iter::once("ramp".to_string()).chain(ours.iter().cloned());
    match ramp_cli::arguments().try_get_matches_from(words) {
        Err(error) if error.use_stderr() => Some(error.to_string()),
        _ => None,
    }
}

#[test]
fn all_commands_are_ones_that_the_program_takes() {
    let mut count = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let blocks = [blocks(&text, "sh"), blocks(&text, "sh,norun")].concat();
        // The README's two commands are indented.
        let indented = text
            .lines()
            .filter_map(|line| line.strip_prefix("    cargo run "))
            .map(|it| format!("cargo run {it}"));
        for command in blocks.iter().flat_map(|block| commands(block)).chain(indented) {
            count += 1;
            if let Some(why) = wrong(&command) {
                panic!("{}: {command}\n{why}", page.display());
            }
        }
    }
    assert!(count > 40, "{count} commands");
}

#[test]
fn commands_that_are_to_be_run_run() {
    let program = Path::new(env!("CARGO_BIN_EXE_ramp"));
    let path = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let mut count = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for block in blocks(&text, "sh") {
            count += 1;
            let output = Command::new("bash")
                .args(["-euo", "pipefail", "-c", &block])
                .current_dir(&folder)
                .env("PATH", &path)
                .output()
                .unwrap();
            assert!(
                output.status.success(),
                "{}:\n{block}\n{}",
                page.display(),
                String::from_utf8_lossy(&output.stderr)
            );
        }
    }
    assert!(count > 5, "{count} blocks");
}

/// A line without what differs from run to run: numbers become `#`, the track `T`, runs of blanks one.
fn form(line: &str) -> String {
    let mut form = String::new();
    for word in line.split_whitespace() {
        let word = word.trim_end_matches(',');
        let word = if ["tags", "state"].contains(&word) { "T" } else { word };
        for letter in word.chars() {
            match letter {
                '0'..='9' if form.ends_with('#') => {}
                '0'..='9' => form.push('#'),
                other => form.push(other),
            }
        }
        form.push(' ');
    }
    form.replace("#.#", "#")
}

/// The output of `ramp run` has the form of the README's sample.
pub fn has_the_form_of_the_sample(printed: &str) {
    let readme = std::fs::read_to_string(Path::new(ROOT).join("README.md")).unwrap();
    let sample = blocks(&readme, "text").into_iter().find(|block| block.contains("seated at")).unwrap();
    let forms = |text: &str| {
        let lines = text.lines().filter(|line| !line.trim().is_empty());
        // Printed on a loaded machine only.
        let lines = lines.filter(|line| !line.starts_with("the machine was loaded"));
        let mut forms: Vec<String> = lines.map(form).collect();
        forms.dedup();
        forms
    };
    assert_eq!(forms(&sample), forms(printed));
}
