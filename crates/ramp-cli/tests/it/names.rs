//! Names that would lead out of a folder, hide a line or run in a spreadsheet: refused where they are read,
//! and nothing is written anywhere.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use ramp_testing::program::words;
use tempfile::TempDir;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).canonicalize().unwrap()
}

/// Runs it in the innermost of three folders, so that two steps up are still ours.
fn ramp(folder: &TempDir, arguments: &[&str]) -> Output {
    let inner = folder.path().join("a/b");
    std::fs::create_dir_all(&inner).unwrap();
    Command::cargo_bin("ramp").unwrap().current_dir(inner).args(arguments).output().unwrap()
}

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
}

/// Status 2, the sentence, and no character that a terminal would obey.
fn refused(output: &Output, sentence: &str) {
    let message = words(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains(sentence), "{message}");
    for bytes in [&output.stdout, &output.stderr] {
        let text = String::from_utf8_lossy(bytes);
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    }
}

/// All files and folders, however deep.
fn all(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(all(&path));
        }
        found.push(path);
    }
    found.sort();
    found
}

#[test]
fn a_goal_whose_name_leads_elsewhere_is_run_by_no_command() {
    let folder = TempDir::new().unwrap();
    let sound = std::fs::read_to_string(data("goals/easy-1.xml")).unwrap();
    let from = "name=\"easy-1\"";
    let victim = folder.path().join("victim");
    let place = victim.display().to_string();
    ramp(&folder, &["--version"]);
    for (name, shown) in [("../../x", "../../x"), (place.as_str(), "/"), ("x&#10;y", "x\\ny")] {
        let goal = match sound.contains(from) {
            true => sound.replacen(from, &format!("name=\"{name}\""), 1),
            false => sound.replacen("<assembly", &format!("<assembly name=\"{name}\""), 1),
        };
        std::fs::write(folder.path().join("a/b/goal.xml"), goal).unwrap();
        let before = all(folder.path());
        for command in [
            &["check", "goal.xml"][..],
            &["run", "goal.xml"],
            &["bench", "goal.xml"],
            &["bench", "goal.xml", "-o", "results"],
            &["faults", "goal.xml"],
            &["goals", "commit", "goal.xml", "-o", "kept"],
            &["show", "goal.xml", "-o", "goal.svg"],
            &["plan", "goal.xml", "--pddl", "pddl"],
        ] {
            refused(&ramp(&folder, command), &format!("found the name \"{shown}"));
            assert_eq!(all(folder.path()), before, "{command:?} wrote something");
        }
    }
}

/// The result of an episode that a person timed, and what it is in.
fn scored(folder: &TempDir) -> (PathBuf, String) {
    let log = data("examples/stopwatch.csv");
    done(&ramp(folder, &["score", log.to_str().unwrap(), "-o", "results"]));
    let path = folder.path().join("a/b/results/easy-1-tags-1.json");
    let text = std::fs::read_to_string(&path).unwrap();
    (path, text)
}

#[test]
fn a_result_with_names_that_are_none_is_refused() {
    let folder = TempDir::new().unwrap();
    let (path, sound) = scored(&folder);
    let long = "x".repeat(65);
    let endless = "word ".repeat(500);
    // Each replacement, and the message expected for it.
    let cases = [
        ("\"our-system\"", r#""=HYPERLINK(1)""#, "the agent's name is `=HYPERLINK(1)`"),
        ("\"our-system\"", r#""a\n\u001b[2J""#, r"the agent's name is `a\n\u{1b}[2J`"),
        ("\"our-system\"", &format!("\"{long}\""), "the agent's name is `xxx"),
        ("\"our-system\"", r#""our system""#, "the agent's name is `our system`"),
        ("\"2.1\"", r#""""#, "the agent's version is ``"),
        ("\"goal\": \"easy-1\"", r#""goal": "../easy-1""#, "the goal is `../easy-1`"),
        ("\"connection\": \"C1\"", r#""connection": "-C1""#, "a connection is `-C1`"),
        ("\"peg\": \"p1\"", r#""peg": "p/1""#, "a peg is `p/1`"),
        ("\"Intel i7-9700\"", r#""\u009b31m""#, r"the processor is `\u{9b}31m`"),
        ("\"A. Person\"", r#""\u202eA""#, r"the scorer is `\u{202e}A`"),
        ("\"reason\": \"done\"", &format!("\"reason\": \"{endless}\""), "why it ended is `word word"),
    ];
    for (from, to, sentence) in cases {
        assert!(sound.contains(from), "{from}");
        std::fs::write(&path, sound.replacen(from, to, 1)).unwrap();
        refused(&ramp(&folder, &["report", "results"]), sentence);
        assert!(!folder.path().join("a/b/report.html").exists());
    }
    // Error messages of the JSON reader quote the file.
    std::fs::write(&path, r#"{"schema": "ramp-published-1", "a\u001b[2J": 1}"#).unwrap();
    refused(&ramp(&folder, &["report", "results"]), r"unknown field `a\u{1b}[2J`");
    // Larger than any valid file: rejected before it is all in memory.
    let mut large = sound.into_bytes();
    large.resize((16 << 20) + 1, b' ');
    std::fs::write(&path, large).unwrap();
    refused(&ramp(&folder, &["report", "results"]), "is larger than 16384 kB");
}

#[test]
fn other_files_of_strangers_have_a_largest_size_as_well() {
    let folder = TempDir::new().unwrap();
    ramp(&folder, &["--version"]);
    let at = |name: &str| folder.path().join("a/b").join(name);
    std::fs::write(at("large.json"), vec![b' '; (16 << 20) + 1]).unwrap();
    std::fs::copy(at("large.json"), at("large.xml")).unwrap();
    for command in [
        &["plan", "easy-1", "--from", "large.json"][..],
        &["plan", "easy-1", "--state", "large.json"],
        &["plan", "easy-1", "--history", "large.json"],
        &["goals", "verify", "large.json", "large.json"],
        &["check", "large.xml"],
        &["run", "large.xml"],
        &["score", "large.json"],
    ] {
        refused(&ramp(&folder, command), "larger than");
    }
}

#[test]
fn a_link_in_the_place_of_a_file_is_replaced_and_not_followed() {
    let folder = TempDir::new().unwrap();
    let (path, sound) = scored(&folder);
    std::fs::remove_file(&path).unwrap();
    let victim = folder.path().join("victim");
    std::fs::write(&victim, "mine").unwrap();
    let partial = path.with_extension("json.partial");
    for link in [&path, &partial] {
        std::os::unix::fs::symlink(&victim, link).unwrap();
    }
    assert_eq!(scored(&folder), (path.clone(), sound));
    assert!(!path.is_symlink() && partial.is_symlink());
    // The same for what is written in many files.
    done(&ramp(&folder, &["plan", "easy-1", "--pddl", "pddl"]));
    let domain = folder.path().join("a/b/pddl/domain.pddl");
    std::fs::remove_file(&domain).unwrap();
    std::os::unix::fs::symlink(&victim, &domain).unwrap();
    done(&ramp(&folder, &["plan", "easy-1", "--pddl", "pddl"]));
    std::fs::create_dir_all(folder.path().join("a/b/kit")).unwrap();
    std::os::unix::fs::symlink(&victim, folder.path().join("a/b/kit/sheet.svg")).unwrap();
    refused(&ramp(&folder, &["kit", "export", "kit"]), "would overwrite `kit/sheet.svg`");
    done(&ramp(&folder, &["kit", "export", "kit", "--force"]));
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "mine");
}

#[test]
fn a_person_with_a_stopwatch_gives_names_and_words_too() {
    let folder = TempDir::new().unwrap();
    ramp(&folder, &["--version"]);
    let sound = std::fs::read_to_string(data("examples/stopwatch.csv")).unwrap();
    for (from, to, sentence) in [
        ("agent,our-system", "agent,=1+1", "the agent is `=1+1`"),
        ("version,2.1", "version,v 2", "the version is `v 2`"),
        ("scorer,A. Person", "scorer,A\u{1b}[2J", r"found `A\u{1b}[2J`"),
        ("scorer,A. Person", &format!("scorer,{}", "A".repeat(257)), "expected at most 256 characters"),
    ] {
        assert!(sound.contains(from), "{from}");
        std::fs::write(folder.path().join("a/b/log.csv"), sound.replacen(from, to, 1)).unwrap();
        refused(&ramp(&folder, &["score", "log.csv", "-o", "results"]), sentence);
        assert!(!folder.path().join("a/b/results").exists());
    }
}

#[test]
fn the_table_of_results_runs_nothing_in_a_spreadsheet() {
    let folder = TempDir::new().unwrap();
    let (path, sound) = scored(&folder);
    std::fs::write(path, sound.replacen("\"reason\": \"done\"", "\"reason\": \"=1+1\"", 1)).unwrap();
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/results-to-csv");
    let output = std::process::Command::new(tool)
        .arg("results")
        .current_dir(folder.path().join("a/b"))
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(",'=1+1\n") && !text.contains(",=1+1"), "{text}");
}
