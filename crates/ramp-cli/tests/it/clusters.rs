//! The examples for clusters. `docs/src/howto/run-on-a-cluster.md` shows them.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/clusters").join(name)
}

/// A command in a folder, with the `ramp` of this build first in its path.
fn shell(folder: &Path, program: &str) -> Command {
    let ramp = Path::new(env!("CARGO_BIN_EXE_ramp")).parent().unwrap();
    let path = std::env::var("PATH").unwrap();
    let mut command = Command::new(program);
    command.current_dir(folder).env("PATH", format!("{}:{path}", ramp.display()));
    command
}

/// Each task of a Slurm array runs its seed, and the folders merge.
#[test]
fn the_slurm_script_runs_the_seed_of_its_task() {
    let folder = TempDir::new().unwrap();
    for seed in ["3", "4"] {
        let mut script = shell(folder.path(), "sh");
        script.arg(example("slurm.sh")).args(["easy-1", "--track", "state", "--world", "ideal"]);
        let output = script.env("SLURM_ARRAY_TASK_ID", seed).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(folder.path().join(format!("results/array/{seed}/easy-1-state-{seed}.json")).exists());
    }
    let merge = "ramp report results/array/* -o report.html";
    let output = shell(folder.path(), "sh").args(["-c", merge]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("2 of 2<small>"), "{report}");
    let without = shell(folder.path(), "sh").arg(example("slurm.sh")).output().unwrap();
    assert!(!without.status.success());
}

/// The Kubernetes file is an indexed Job whose pods take their seed from their index.
#[test]
fn the_kubernetes_file_is_an_indexed_job() {
    let text = std::fs::read_to_string(example("kubernetes.yaml")).unwrap();
    for line in
        ["apiVersion: batch/v1", "kind: Job", "  completionMode: Indexed", "      restartPolicy: Never"]
    {
        assert!(text.lines().any(|it| it == line), "{line}");
    }
    assert!(text.contains("seed=$((JOB_COMPLETION_INDEX + 1))"));
    assert!(!text.contains('\t'), "YAML has no tabs");
    for line in text.lines() {
        assert_eq!((line.len() - line.trim_start().len()) % 2, 0, "{line}");
    }
}
