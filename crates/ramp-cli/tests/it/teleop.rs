//! `ramp teleop` before it starts Python: bad arguments, and no package. What it does is tested in
//! python/tests.

use std::process::Command;

use tempfile::TempDir;

#[test]
fn bad_arguments_and_a_missing_package_are_one_error_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("full")).unwrap();
    std::fs::write(folder.path().join("full/thesis.txt"), "mine").unwrap();
    for (arguments, expected) in [
        ("teleop fasten -o out", "pip install 'ramp-benchmark[data,teleop]'"),
        ("teleop easy-1 -o out", "pip install 'ramp-benchmark[data,teleop]'"),
        ("teleop fastne -o out", "there is no goal `fastne`"),
        ("teleop fasten --goal easy-9 -o out", "there is no goal `easy-9`"),
        ("teleop easy-1 --goal easy-2 -o out", "belongs to an action"),
        ("teleop fasten --world moon -o out", "moon"),
        ("teleop fasten --input none.txt -o out", "none.txt: there is no such file"),
        ("teleop fasten -o full", "full is not empty"),
        ("teleop fasten -o full/thesis.txt", "is not empty"),
        ("teleop fasten", "required"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_ramp"))
            .args(arguments.split(' '))
            .current_dir(folder.path())
            .env("RAMP_PYTHON", "no-such-python")
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        // Lines are broken to fit the terminal.
        let words = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(words.contains(expected), "{arguments:?}: {told}");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read_dir(folder.path().join("full")).unwrap().count(), 1);
}
