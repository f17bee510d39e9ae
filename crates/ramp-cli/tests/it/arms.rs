//! Episodes with either arm.

use std::path::Path;
use std::process::Output;

use tempfile::TempDir;

use crate::ramp;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn done(output: &Output) -> String {
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// A bench with an FR3 names it in the table and in each result, its logs replay, a folder holds one arm, and
/// a report has a table for each.
#[test]
fn results_of_two_arms_are_not_mixed() {
    let folder = TempDir::new().unwrap();
    let place = folder.path();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/mover.py");
    let bench = |arm: &str, output: &str| {
        let words = ["bench", "easy-1", "--track", "state", "--repeats", "1", "--agent"];
        let rest = [agent.to_str().unwrap(), "--arm", arm, "-o", output];
        ramp(place, &[&words[..], &rest].concat())
    };
    assert!(done(&bench("fr3", "research")).contains("arm fr3, world real"));
    let refused = bench("panda", "research");
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("is of the arm fr3") && said.contains("--arm"), "{said}");
    let result = std::fs::read(place.join("research/easy-1-state-1.json")).unwrap();
    let result: serde_json::Value = serde_json::from_slice(&result).unwrap();
    assert_eq!(result["arm"], "fr3");
    let replayed = ramp(place, &["replay", "research/easy-1-state-1.mcap"]);
    assert_eq!(replayed.status.code(), Some(0), "{}", text(&replayed.stderr));
    // Without the option it is the Panda.
    done(&bench("panda", "emika"));
    done(&ramp(place, &["report", "research", "emika", "-o", "report.html"]));
    let report = std::fs::read_to_string(place.join("report.html")).unwrap();
    for arm in ["fr3", "panda"] {
        assert!(report.contains(&format!("state, twin, arm {arm}, world real")), "{arm}");
    }
}

#[test]
fn an_unknown_arm_is_refused_with_the_known_ones() {
    let folder = TempDir::new().unwrap();
    let refused = ramp(folder.path(), &["run", "easy-1", "--arm", "ur5e"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("panda, fr3"), "{said}");
    assert!(!folder.path().join("results").exists(), "nothing is written");
}
