//! `ramp demos` and `ramp replay --dataset` before they start Python: bad arguments, and no package. What
//! they do is tested in python/tests.

use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Runs `ramp` in a folder, with a Python that is not there.
fn without_python(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ramp"))
        .args(arguments)
        .current_dir(folder.path())
        .env("RAMP_PYTHON", "no-such-python")
        .output()
        .unwrap()
}

#[test]
fn bad_arguments_and_a_missing_package_are_one_error_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    let install = "pip install 'ramp-benchmark[data]'";
    for (arguments, expected) in [
        ("demos fasten -o set", install),
        ("demos easy-1 -o set", install),
        ("replay --dataset set", install),
        ("demos fasten --backend ray -o set", "pip install 'ramp-benchmark[ray]'"),
        ("demos fastne -o set", "there is no goal `fastne`"),
        ("demos fasten --goal easy-9 -o set", "there is no goal `easy-9`"),
        ("demos fasten --world moon -o set", "moon"),
        ("demos fasten --rate 30 -o set", "divides 1000"),
        ("demos fasten --image-size 8 -o set", "from 16 to 512"),
        ("demos fasten --belief-error 1 -o set", "from 0 to 0.05"),
        ("demos fasten --agent mine.py -o set", "is a skill"),
        ("demos easy-1 --goal easy-2 -o set", "belong to a skill"),
        ("demos --log nothing.mcap -o set", "no such file"),
        ("demos -o set", "required"),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = without_python(&folder, &arguments);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        // Lines are broken to fit the terminal.
        let words = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(words.contains(expected), "{arguments:?}: {told}");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_package_of_another_version_is_refused() {
    let folder = TempDir::new().unwrap();
    let python = folder.path().join("python");
    std::fs::write(&python, "#!/bin/sh\necho 9.9\n").unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_ramp"))
        .args(["demos", "fasten", "-o", "set"])
        .current_dir(folder.path())
        .env("RAMP_PYTHON", &python)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let words = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    assert!(words.contains("is of version 9.9, and this program is"), "{told}");
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(!folder.path().join("set").exists());
}
