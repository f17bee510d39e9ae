//! Plans, detectors and single skills, each judged separately: their files and their report.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::ramp;
use serde_json::Value;
use tempfile::TempDir;

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).canonicalize().unwrap()
}

fn read(folder: &TempDir, file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.path().join(file)).unwrap()).unwrap()
}

/// The file follows its published schema, and the schema takes nothing else.
fn follows(folder: &TempDir, file: &str, schema: &str) {
    let text = std::fs::read_to_string(data(&format!("schema/{schema}.schema.json"))).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
    let mut value = read(folder, file);
    let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{file}: {errors:?}");
    value["more"] = Value::from(1);
    assert!(!validator.is_valid(&value), "{schema} takes a field that nobody writes");
}

#[test]
fn a_skill_is_tried_goes_on_where_it_stopped_and_gives_the_same_bits_again() {
    let folder = TempDir::new().unwrap();
    let trials = |count: &str, output: &str| {
        let base = ["trials", "push", "--track", "state", "--trials", count, "-o", output];
        ramp(&folder, &base)
    };
    let one = trials("1", "a");
    done(&one);
    follows(&folder, "a/push-state-1.json", "manipulation");
    let first = read(&folder, "a/push-state-1.json");
    assert_eq!(first["success"], true, "{first:#}");
    assert!(first["drawn"]["displaced"].as_f64().unwrap() > 0.1e-3, "it was not disturbed: {first:#}");
    // The second trial alone is run, and what is no trial is replaced.
    std::fs::write(folder.path().join("a/push-state-2.json"), "{}").unwrap();
    let both = trials("2", "a");
    done(&both);
    let told = String::from_utf8_lossy(&both.stderr);
    assert!(told.contains("1 of 2 trials are finished already"), "{told}");
    assert!(told.contains("push-state-2.json is no result of this trial"), "{told}");
    let table = String::from_utf8_lossy(&both.stdout);
    assert!(table.contains("push") && table.contains("95 % interval"), "{table}");
    done(&trials("1", "b"));
    assert_eq!(first, read(&folder, "b/push-state-1.json"), "the same seed gives the same bits");
    // In the report they have a table of their own; one trial twice is refused.
    done(&ramp(&folder, &["report", "a"]));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Manipulation alone") && page.contains("push"));
    let twice = ramp(&folder, &["report", "a", "b"]);
    assert_eq!(twice.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&twice.stderr).contains("two results"));
    // A folder is of one version.
    let path = folder.path().join("a/push-state-1.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let commit = first["software"]["commit"].as_str().unwrap();
    std::fs::write(&path, text.replace(commit, "another")).unwrap();
    let mixed = trials("2", "a");
    assert_eq!(mixed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&mixed.stderr).contains("another"));
}

/// The result of one trial.
fn trial(skill: &str, seed: &str) -> Value {
    let folder = TempDir::new().unwrap();
    done(&ramp(&folder, &["trials", skill, "--first-seed", seed, "--trials", "1", "-o", "a"]));
    read(&folder, &format!("a/{skill}-tags-{seed}.json"))
}

#[test]
fn a_wrist_camera_that_is_off_is_put_right_before_it_is_needed() {
    // Among the seeds whose wrist camera is furthest off; without it a seated peg seems a millimetre too
    // high, and the end of a beam that hangs goes under the joint it is slid into.
    for (skill, seed) in [("fasten-thru-f", "71"), ("slide", "62")] {
        let trial = trial(skill, seed);
        assert_eq!(trial["success"], true, "{trial:#}");
        assert_eq!(trial["retries"], 0, "{trial:#}");
    }
}

#[test]
fn a_beam_that_the_camera_over_the_table_cannot_place_is_looked_for_where_the_sheet_has_it() {
    // In this seed that camera's first images of b1 are too vague, and in all others the arm is in between.
    let trial = trial("assemble-deep", "205");
    assert_eq!(trial["success"], true, "{trial:#}");
}

#[test]
fn a_beam_that_stands_right_at_one_end_only_is_pushed_at_the_other() {
    // Here the cap that no peg holds yet is 1.7 mm off where it is to be pinned, and right at its far end.
    let trial = trial("fasten-in-f-end", "269");
    assert_eq!(trial["success"], true, "{trial:#}");
}

#[test]
fn a_skill_that_there_is_not_is_refused_with_the_nearest_name() {
    let folder = TempDir::new().unwrap();
    let output = ramp(&folder, &["trials", "asemble-cap", "-o", "new"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("did you mean `assemble-cap`?"), "{message}");
    assert!(!folder.path().join("new").exists());
}

#[test]
fn a_detector_is_judged_into_a_file_and_told_in_the_report() {
    let folder = TempDir::new().unwrap();
    done(&ramp(&folder, &["see", "easy-1", "--count", "5", "--no-images", "-o", "set"]));
    std::fs::create_dir(folder.path().join("verdicts")).unwrap();
    let judge = |file: &str, output: &str| ramp(&folder, &["see", "--judge", file, "set", "-o", output]);
    done(&judge("set/estimates.json", "verdicts/one.json"));
    follows(&folder, "verdicts/one.json", "perception");
    assert_eq!(read(&folder, "verdicts/one.json")["detector"], "estimates");
    // One that finds nothing, and one that is wrong.
    std::fs::write(folder.path().join("blind.json"), "[]").unwrap();
    done(&judge("blind.json", "verdicts/two.json"));
    follows(&folder, "verdicts/two.json", "perception");
    let mut wrong = read(&folder, "set/estimates.json");
    wrong[0]["x_cp"]["position"][0] = 3.0.into();
    std::fs::write(folder.path().join("wrong.json"), wrong.to_string()).unwrap();
    assert_eq!(judge("wrong.json", "verdicts/three.json").status.code(), Some(1));
    follows(&folder, "verdicts/three.json", "perception");
    let report = ramp(&folder, &["report", "verdicts"]);
    done(&report);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(
        page.contains("Perception alone") && page.contains("blind") && page.contains("1 false"),
        "{page}"
    );
    assert!(String::from_utf8_lossy(&report.stdout).contains("blind: 0 of "));
}

#[test]
fn verdicts_on_plans_published_means_and_promises_follow_their_schemas() {
    let folder = TempDir::new().unwrap();
    let plan = ramp(&folder, &["plan", "easy-1", "--json"]);
    done(&plan);
    std::fs::write(folder.path().join("good.json"), &plan.stdout).unwrap();
    let mut wrong: Value = serde_json::from_slice(&plan.stdout).unwrap();
    wrong["plan"]["steps"].as_array_mut().unwrap().remove(3);
    std::fs::write(folder.path().join("hasty.json"), wrong.to_string()).unwrap();
    for name in ["good", "hasty"] {
        let (from, output) = (format!("{name}.json"), format!("{name}-verdict.json"));
        ramp(&folder, &["plan", "easy-1", "--from", &from, "-o", &output]);
        follows(&folder, &output, "planning");
    }
    let means = data("published/ramp-baseline.csv").display().to_string();
    done(&ramp(&folder, &["score", &means, "-o", "published"]));
    follows(&folder, "published/ramp-baseline-easy-1.json", "published");
    let goal = data("goals/easy-2.xml").display().to_string();
    done(&ramp(&folder, &["goals", "commit", &goal, "-o", "held"]));
    follows(&folder, "held/commitments.json", "held-out");
    follows(&folder, "held/reveal.json", "held-out");
}
