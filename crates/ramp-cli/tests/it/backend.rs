//! `--backend ray`: what is refused before anything is written, and what a failing engine does to a bench.
//! The work of a cluster is tested in python/tests.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const BENCH: &str = "bench easy-1 --track state --world ideal --repeats 2 -o bench";

/// Runs `ramp` in a folder with this Python.
fn ramp(folder: &Path, python: &Path, arguments: &str) -> (Option<i32>, String) {
    let output: Output = Command::new(env!("CARGO_BIN_EXE_ramp"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .env("RAMP_PYTHON", python)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    // Lines are broken to fit the terminal.
    let words = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    (output.status.code(), words)
}

/// A Python whose module `ramp.ray` reads two requests and answers each with a text.
fn engine(folder: &Path, hello: &str, answers: &str) -> PathBuf {
    let python = folder.join("python");
    let version = env!("CARGO_PKG_VERSION");
    let script = format!(
        "#!/bin/sh\nif [ \"$1\" = -c ]; then echo {version}; exit; fi\n\
         read -r line; printf '%s\\n' '{hello}'\n\
         read -r line; printf '%s\\n' '{answers}'\n\
         echo the engine is broken >&2\n"
    );
    std::fs::write(&python, script).unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    python
}

#[test]
fn what_cannot_run_on_a_cluster_is_one_error_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir_all(folder.path().join("entries/one")).unwrap();
    for (arguments, expected) in [
        ("bench easy-1 --backend ray -o bench", "pip install 'ramp-benchmark[ray]'"),
        ("sweep easy-1 --vary friction.coulomb=0..1 --backend ray -o sweep", "ramp-benchmark[ray]"),
        ("entry check entries --backend ray", "ramp-benchmark[ray]"),
        ("leaderboard entries -o site --backend ray", "ramp-benchmark[ray]"),
        ("bench easy-1 --backend dask -o bench", "`ray` or `ray:ADDRESS` is expected"),
        ("bench easy-1 --backend ray --jobs 2 -o bench", "cannot be used with"),
        ("bench easy-1 --backend ray --secret secret.json -o bench", "stays on this machine"),
    ] {
        let (status, told) = ramp(folder.path(), Path::new("no-such-python"), arguments);
        assert!(told.contains(expected), "{arguments}: {told}");
        assert_eq!(status, Some(2), "{arguments}: {told}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_cluster_that_is_not_there_is_one_error_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    let python = engine(folder.path(), r#"{"kind": "refused", "why": "there is no cluster"}"#, "");
    let (status, told) = ramp(folder.path(), &python, &format!("{BENCH} --backend ray:10.0.0.1:1"));
    assert!(told.contains("there is no cluster"), "{told}");
    assert_eq!(status, Some(2), "{told}");
    assert!(!folder.path().join("bench").exists());
}

#[test]
fn an_engine_that_fails_never_makes_a_result() {
    let ready = r#"{"kind": "ready", "processors": 2}"#;
    let lost = |job: usize| format!(r#"{{"kind": "lost", "job": {job}, "why": "its worker was lost"}}"#);
    let ended =
        r#"{"kind": "ended", "job": 0, "status": 0, "took": 1.0, "printed": 0, "told": 0, "files": {}}"#;
    let late =
        r#"{"kind": "ended", "job": 0, "status": null, "took": 1.0, "printed": 0, "told": 0, "files": {}}"#;
    for (answers, code, expected) in [
        (format!("{}\n{}", lost(0), lost(1)), 1, "seed 2: lost: its worker was lost"),
        (format!("{ended}\n{}", lost(1)), 1, "seed 1: lost: ended with status 0 and no result"),
        (format!("{late}\n{}", lost(1)), 1, "seed 1: lost: not done after 1800 s"),
        (r#"{"kind": "refused", "why": "a node has another build"}"#.to_string(), 2, "another build"),
        (r#"{"kind": "failed", "why": "a node has failed: no space"}"#.to_string(), 3, "no space"),
        (lost(2), 3, "an answer to nothing: the engine is broken"),
        ("nonsense".to_string(), 3, "has failed"),
        (lost(0), 3, "it has ended: the engine is broken"),
    ] {
        let folder = TempDir::new().unwrap();
        let python = engine(folder.path(), ready, &answers);
        let (status, told) = ramp(folder.path(), &python, &format!("{BENCH} --backend ray"));
        assert!(told.contains(expected), "{answers}: {told}");
        assert_eq!(status, Some(code), "{answers}: {told}");
        let left: Vec<_> = std::fs::read_dir(folder.path().join("bench")).unwrap().flatten().collect();
        assert!(left.iter().all(|file| !file.path().to_string_lossy().ends_with(".json")), "{left:?}");
        assert!(!folder.path().join("bench/.running").exists());
    }
}
