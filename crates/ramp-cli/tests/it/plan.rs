//! `ramp plan` as a user has it: rules changed, histories explained, plans taken from elsewhere.

use std::path::Path;

use assert_cmd::Command;
use tempfile::TempDir;

/// Exit status, standard output and standard error of `ramp plan`.
fn plan(folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("ramp").unwrap();
    let output = command.current_dir(folder).arg("plan").args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

fn assembled(said: &str) -> Vec<&str> {
    let actions = said.lines().filter_map(|line| line.split_once("  assemble "));
    actions.map(|(_, beam)| beam).collect()
}

fn coarse_rules() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/domains/coarse.al");
    std::fs::read_to_string(file).unwrap()
}

/// The commands and results of the tutorial docs/src/tutorials/your-planner.md.
#[test]
fn a_changed_rule_changes_the_plan() {
    let folder = TempDir::new().unwrap();
    let (_, usual, _) = plan(&folder, &["easy-3", "--coarse"]);
    assert!(usual.contains("43 coarse actions"), "{usual}");
    assert_eq!(assembled(&usual), ["b4", "b5", "b8"]);

    let swings = "fasten(C) causes -aligned(B) if joins(C, B, _), awaits(B), -steady(B), -other_open(B, C).";
    let rules = coarse_rules();
    assert!(rules.contains(swings));
    std::fs::write(folder.path().join("mine.al"), rules.replace(swings, "")).unwrap();
    let (_, stiff, _) = plan(&folder, &["easy-3", "--coarse", "--domain", "mine.al"]);
    assert!(stiff.contains("41 coarse actions") && !stiff.contains("push"), "{stiff}");

    let wish = "impossible assemble(\"b4\") if -in_assembly(\"b5\").";
    std::fs::write(folder.path().join("wish.al"), format!("{rules}\n{wish}\n")).unwrap();
    let (_, wished, _) = plan(&folder, &["easy-3", "--coarse", "--domain", "wish.al"]);
    assert_eq!(assembled(&wished), ["b5", "b4", "b8"]);

    let misspelt =
        rules.replace("impossible assemble(_) if -at(assembly).", "impossible assemble(_) if -at(asembly).");
    std::fs::write(folder.path().join("bad.al"), misspelt).unwrap();
    let (status, _, told) = plan(&folder, &["easy-3", "--domain", "bad.al"]);
    assert_eq!(status, 2);
    assert!(told.contains("bad.al") && told.contains("did you mean `assembly`"), "{told}");
}

#[test]
fn the_published_rules_need_no_more_actions_than_were_measured() {
    let folder = TempDir::new().unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/domains/published.al");
    for (goal, measured) in [("easy-1", 41), ("easy-2", 42), ("easy-3", 50)] {
        let (_, said, _) = plan(&folder, &[goal, "--coarse", "--domain", file.to_str().unwrap(), "--json"]);
        let json: serde_json::Value = serde_json::from_str(&said).unwrap();
        let steps = json["plan"]["steps"].as_array().unwrap().len();
        assert!(steps <= measured && steps + 2 > measured, "{goal} has {steps} coarse actions");
    }
}

#[test]
fn a_history_is_explained_and_the_plan_goes_on() {
    let folder = TempDir::new().unwrap();
    let history = r#"{"records": [
        {"did": {"action": "pick_up", "item": {"beam": "b4"}}}, {"saw": "full"},
        {"did": {"action": "move", "to": "intermediate"}},
        {"did": {"action": "move", "to": "assembly"}}, {"saw": "at(assembly)"},
        {"did": {"action": "assemble", "beam": "b4"}}, {"saw": "-in_assembly(b4)"}]}"#;
    std::fs::write(folder.path().join("history.json"), history).unwrap();
    let (status, said, _) = plan(&folder, &["easy-3", "--history", "history.json"]);
    assert_eq!(status, 0);
    for cause in ["jam(\"b4\")", "slip(\"b4\")", "no_effect(assemble(\"b4\"))"] {
        assert!(said.contains(cause), "{cause} is not told: {said}");
    }
    assert!(said.contains("  1  assemble b4"), "{said}");

    std::fs::write(folder.path().join("history.json"), history.replace("\"saw\"", "\"say\"")).unwrap();
    let (status, _, told) = plan(&folder, &["easy-3", "--history", "history.json"]);
    assert_eq!(status, 2);
    assert!(told.contains("history.json:2:") && told.contains("unknown variant"), "{told}");
}

#[test]
fn a_plan_starts_from_a_state_of_ones_own() {
    let folder = TempDir::new().unwrap();
    let state = r#"{"in_assembly": ["b4"], "fastened": [["C1", "p1"]]}"#;
    std::fs::write(folder.path().join("state.json"), state).unwrap();
    let (status, said, _) = plan(&folder, &["easy-3", "--state", "state.json"]);
    assert_eq!((status, assembled(&said)), (0, vec!["b5", "b8"]));
    std::fs::write(folder.path().join("state.json"), state.replace("b4", "b44")).unwrap();
    let (status, _, told) = plan(&folder, &["easy-3", "--state", "state.json"]);
    assert!(status == 2 && told.contains("did you mean"), "{status} {told}");
}

#[test]
fn what_is_built_is_taken_apart_from_the_other_end() {
    let folder = TempDir::new().unwrap();
    let (status, said, _) = plan(&folder, &["medium-3", "--disassemble", "--coarse"]);
    assert_eq!(status, 0);
    let words = ["pull p8 out of C8", "slide b2 back", "take out b8", "put down b8", "take out b4"];
    let places: Vec<usize> = words.iter().map(|words| said.find(words).unwrap()).collect();
    assert!(places.is_sorted(), "{said}");
}

#[test]
fn plans_go_out_and_come_in() {
    let folder = TempDir::new().unwrap();
    let (status, said, _) = plan(&folder, &["easy-1", "--pddl", "pddl"]);
    assert!(status == 0 && said.contains("domain.pddl") && folder.path().join("pddl/problem.pddl").is_file());
    std::fs::write(folder.path().join("short.txt"), "(pick_up b4)\n(move intermediate)\n").unwrap();
    let (status, said, _) = plan(&folder, &["easy-1", "--from", "short.txt"]);
    assert!(status == 1 && said.contains("refused at step 3 (the end)"), "{status} {said}");

    let (_, ours, _) = plan(&folder, &["easy-1", "--json"]);
    std::fs::write(folder.path().join("ours.json"), ours).unwrap();
    let (status, said, _) = plan(&folder, &["easy-1", "--from", "ours.json"]);
    assert!(status == 0 && said.contains("accepted"), "{said}");
}

#[test]
fn why_tells_laws_and_places() {
    let folder = TempDir::new().unwrap();
    let (status, said, _) = plan(&folder, &["easy-3", "--why", "assemble(b8)"]);
    assert_eq!(status, 0);
    assert!(said.contains("-aligned(\"b5\")") && said.contains("coarse.al:"), "{said}");
    let (status, _, told) = plan(&folder, &["easy-3", "--why", "assemble(b88)"]);
    assert!(status == 2 && told.contains("did you mean"), "{told}");
}

/// Rules of strangers that would take the machine's memory, in `ramp plan` and before `ramp run` has written
/// anything.
#[cfg(target_os = "linux")]
#[test]
fn rules_that_never_end_are_ended_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let rules = std::fs::read_to_string(data.join("domains/order.lp")).unwrap();
    let endless = format!("{rules}\nmany(1..9999, 1..9999).\n");
    std::fs::write(folder.path().join("mine.lp"), endless).unwrap();
    let (status, said, told) = plan(&folder, &["easy-1", "--domain", "mine.lp", "--json"]);
    assert_eq!((status, said.as_str()), (2, ""), "{told}");
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        told.contains("the rules took more than 1024 MiB of memory") && told.contains("mine.lp"),
        "{told}"
    );
    assert!(told.contains("make the rules or the goal smaller"), "{told}");

    let ramp = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("ramp").unwrap();
        command.current_dir(folder.path()).args(arguments).output().unwrap()
    };
    assert!(ramp(&["data", "export", "own"]).status.success());
    let beams = ["beam"; 13].join(", ");
    let endless = format!("{}\naction many({beams}).\n", coarse_rules());
    std::fs::write(folder.path().join("own/domains/coarse.al"), endless).unwrap();
    let output = ramp(&["--data", "own", "run", "hard-1", "-o", "results/one.json"]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("the rules took more than"), "{told}");
    let left: Vec<_> =
        std::fs::read_dir(folder.path().join("results")).into_iter().flatten().flatten().collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn rules_that_read_files_are_refused_at_their_place() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("mine.lp"), "a.\n#include \"/etc/passwd\".\n").unwrap();
    let (status, said, told) = plan(&folder, &["easy-1", "--domain", "mine.lp"]);
    assert_eq!((status, said.as_str()), (2, ""), "{told}");
    assert!(
        told.contains("mine.lp:2:1") && told.contains("`#include` is not allowed in a rule file"),
        "{told}"
    );
}
