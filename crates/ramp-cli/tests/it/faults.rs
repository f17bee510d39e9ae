//! `ramp run --fault` and `ramp faults` as a user has them.

use crate::ramp;
use ramp_testing::program::words;
use serde_json::Value;
use tempfile::TempDir;

#[test]
fn a_fault_that_there_is_not_is_refused_and_nothing_written() {
    let folder = TempDir::new().unwrap();
    for (arguments, expected) in [
        (&["run", "easy-1", "--fault", "peg-droped"][..], "did you mean `peg-dropped`?"),
        (&["run", "easy-1", "--fault", "earthquake"], "expected one of peg-dropped, peg-tilted"),
        (&["run", "easy-1", "--fault", "jam@0"], "expected a number from 1 after the @"),
        (&["run", "easy-1", "--fault", "jam@"], "expected a number from 1 after the @"),
        (&["run", "easy-1", "--fault", "jam@-1"], "invalid occasion `-1` of the fault `jam`"),
        (&["faults", "easy-1", "--fault", "jams"], "did you mean `jam`?"),
        (&["faults", "easy-33"], "did you mean `easy-3`?"),
        (&["faults", "easy-1", "--seeds", "0"], "--seeds"),
        (&["faults", "easy-1", "--first-seed", "18446744073709551615"], "fewer --seeds"),
    ] {
        let output = ramp(&folder, arguments);
        let message = words(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty());
        assert!(message.contains(expected), "{arguments:?} should say `{expected}`: {message}");
        assert!(!message.contains("panicked"), "{message}");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn a_suite_says_how_often_a_fault_struck_and_goes_on_where_it_was() {
    let folder = TempDir::new().unwrap();
    let suite = [
        "faults",
        "easy-1",
        "--track",
        "state",
        "--fault",
        "force-drift@1",
        "--fault",
        "peg-missing@15",
        "--seeds",
        "1",
        "--jobs",
        "2",
        "-o",
        "out",
    ];
    let output = ramp(&folder, &[&suite[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
    let table: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (row, fault) in ["force-drift@1", "peg-missing@15"].into_iter().enumerate() {
        let row = &table["rows"][row];
        assert_eq!((&row["fault"], &row["goal"]), (&fault.into(), &"easy-1".into()));
        assert_eq!((&row["tally"]["episodes"], &row["tally"]["struck"]), (&1.into(), &1.into()));
    }
    // A peg that is not wanted is not missed.
    assert_eq!(table["rows"][1]["tally"]["harmless"], 1);
    let path = folder.path().join("out/easy-1-state-peg-missing@15-1.json");
    let result: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(result["fault"]["kind"], "peg-missing");
    assert_eq!(result["fault"]["part"], "p15");

    // Once more: nothing is run, and the table for a person is the same.
    let again = ramp(&folder, &suite);
    assert!(
        words(&again.stdout).contains("peg-missing@15 easy-1 1/1 1 - 1/1 100 %"),
        "{}",
        words(&again.stdout)
    );
    assert!(!words(&again.stderr).contains("easy-1-state"), "{}", words(&again.stderr));

    // Such results are none of the benchmark; that of the control, in which nothing went wrong, is.
    let report = ramp(&folder, &["report", "out", "-o", "report.html"]);
    assert_eq!(report.status.code(), Some(0), "{}", words(&report.stderr));
    assert!(words(&report.stdout).contains("1 of 1 episodes complete"), "{}", words(&report.stdout));
    std::fs::remove_file(folder.path().join("out/easy-1-state-no-fault-1.json")).unwrap();
    let report = ramp(&folder, &["report", "out", "-o", "report.html"]);
    assert_eq!(report.status.code(), Some(2), "{}", words(&report.stderr));
}
