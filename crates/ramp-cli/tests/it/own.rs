//! External plans and skills, executed in the twin.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

fn ramp(arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_ramp")).args(arguments).output().unwrap()
}

fn example() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/skills/press.py");
    path.canonicalize().unwrap().display().to_string()
}

fn result(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn words(path: PathBuf) -> String {
    path.display().to_string()
}

/// The result names whatever is not the baseline's.
#[test]
fn a_plan_of_ones_own_is_carried_out_as_it_is_and_a_program_fastens_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, out) = (words(folder.path().join("plan.json")), words(folder.path().join("out.json")));
    let made = ramp(&["plan", "easy-1", "--json"]);
    let mut own: Value = serde_json::from_slice(&made.stdout).unwrap();
    // As another program would write it: with no word on how the beams get to their places.
    own["plan"].as_object_mut().unwrap().remove("entries");
    std::fs::write(&plan, own.to_string()).unwrap();
    let skill = format!("fasten={}", example());
    let run = ["run", "easy-1", "--track", "state", "--plan", &plan, "--skill", &skill, "-o", &out];
    let run = ramp(&run);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let result = result(Path::new(&out));
    assert_eq!(result["completion"], 1.0);
    let name = result["agent"]["name"].as_str().unwrap();
    assert!(name.starts_with("baseline+") && name.contains("+plan."), "{name}");
    assert!(name.contains("+fasten-by-press."), "{name}");
    assert_eq!(result["plan"]["coarse"], own["plan"]["steps"].as_array().unwrap().len());
}

/// The example rehearses its motions before the arm moves, so no event says that it does not.
#[test]
fn a_program_rehearses_its_motions() {
    let folder = tempfile::tempdir().unwrap();
    let out = words(folder.path().join("out.json"));
    let skill = format!("fasten={}", example());
    let world = ["--world", "ideal", "--track", "state"];
    let run = ramp(&[&["run", "easy-1", "--skill", &skill, "-o", &out][..], &world[..]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let result = result(Path::new(&out));
    let events = result["events"].as_array().unwrap();
    assert!(!events.iter().any(|event| event["kind"] == "not_rehearsed" || event["kind"] == "motion"));
}

/// The tutorial of the planner deletes a rule: the beam is then laid down where it should be inserted, and no
/// peg counts. With the rule, the same goal is built.
#[test]
fn the_rule_that_the_tutorial_removes_matters() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = std::fs::read_to_string(root.join("docs/src/tutorials/your-planner.md")).unwrap();
    let rules = std::fs::read_to_string(root.join("data/domains/coarse.al")).unwrap();
    let rule = page.lines().find(|line| line.starts_with("impossible assemble(B) if")).unwrap();
    assert_eq!(rules.matches(rule).count(), 1, "{rule}");
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| words(folder.path().join(name));
    std::fs::write(place("mine.al"), rules.replace(rule, "")).unwrap();
    let corner = r#"<assembly>
  <component beam="b7" base="True"/>
  <component beam="b4"/>
  <connection name="C1">
    <element component="b4" joint="b4j1"/>
    <element component="b7" joint="b7j1"/>
  </connection>
</assembly>"#;
    std::fs::write(place("corner.xml"), corner).unwrap();
    let (goal, mine, out) = (place("corner.xml"), place("mine.al"), place("out.json"));
    for (domain, planned, pegs) in
        [(&[][..], "insert b4 by b4j1", 1), (&["--domain", &mine][..], "lay down b4 at its place", 0)]
    {
        let plan = ramp(&[&["plan", &goal][..], domain].concat());
        let plan = String::from_utf8(plan.stdout).unwrap();
        assert!(plan.contains(planned), "{plan}");
        let fast = ["--track", "state", "--world", "ideal", "--force", "-o", &out];
        ramp(&[&["run", &goal][..], domain, &fast].concat());
        let counted =
            result(Path::new(&out))["pegs"].as_array().unwrap().iter().filter(|it| !it.is_null()).count();
        assert_eq!(counted, pegs, "{domain:?}");
    }
}

#[test]
fn a_plan_that_cannot_be_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, out) = (words(folder.path().join("plan.json")), words(folder.path().join("out.json")));
    for (text, expected) in [
        (
            r#"{"plan":{"steps":[{"coarse":{"action":"assemble","beam":"b4"},"fine":[]}]}}"#,
            "refused at step 1",
        ),
        (r#"{"plan":{"steps":[{"coarse":{"action":"fly"}}]}}"#, "plan.json:1:"),
        ("(fly b4)", "plan.json"),
    ] {
        std::fs::write(&plan, text).unwrap();
        let run = ramp(&["run", "easy-1", "--plan", &plan, "-o", &out]);
        let told = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{told}");
        assert!(told.replace("\n  │ ", "").contains(expected), "{told}");
        assert!(!Path::new(&out).exists());
    }
}

#[test]
fn a_program_is_judged_on_trials_of_its_skill() {
    let folder = tempfile::tempdir().unwrap();
    let out = words(folder.path().join("trials"));
    let trials = ["trials", "fasten-in-f-end", "--track", "state", "--trials", "1", "-o", &out];
    let run = ramp(&[&trials[..], &["--skill", &format!("fasten={}", example())]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let trial = result(&folder.path().join("trials/fasten-in-f-end-state-1.json"));
    assert_eq!(trial["success"], true);
    assert!(trial["agent"]["name"].as_str().unwrap().contains("fasten-by-press."));
    // The folder is of that program: the baseline is not mixed in.
    let mixed = ramp(&trials);
    assert_eq!(mixed.status.code(), Some(2));
    // An agent that does nothing fails, and says nothing.
    let idle = folder.path().join("idle.py");
    let say = |message: &str| format!("print('{message}', flush=True); sys.stdin.readline()\n");
    let hello = say(r#"{"hello": {"protocol": 1, "name": "idle", "version": "1"}}"#);
    std::fs::write(&idle, format!("import sys\n{hello}{}", say(r#"{"done": {}}"#))).unwrap();
    let out = words(folder.path().join("idle"));
    let idle = words(idle);
    let run = ramp(&["trials", "push", "--track", "state", "--trials", "1", "-o", &out, "--agent", &idle]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let trial = result(&folder.path().join("idle/push-state-1.json"));
    assert_eq!(trial["agent"]["name"], "idle");
}

#[test]
fn what_is_no_skill_is_bad_input() {
    for (skill, expected) in [
        ("fsten=x.py", "there is no action `fsten`"),
        ("fasten", "expected ACTION=FILE"),
        ("fasten=nowhere.py", "nowhere.py"),
        ("pick_up=x.py", "there is no action `pick_up`"),
    ] {
        let run = ramp(&["run", "easy-1", "--skill", skill]);
        let told = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{told}");
        assert!(told.contains(expected), "{told}");
    }
}

/// A planner, plan, skill or parameters of one's own are another agent, for every command and in a report.
#[test]
fn whatever_is_replaced_is_another_agent() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| words(folder.path().join(name));
    let rules = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/domains/coarse.al");
    let rules = std::fs::read_to_string(rules).unwrap();
    std::fs::write(file("mine.al"), format!("{rules}\n% Mine.\n")).unwrap();
    std::fs::write(file("same.al"), rules).unwrap();
    std::fs::write(file("mine.toml"), "[agent]\nlatest = 1700.0\n").unwrap();
    std::fs::create_dir(file("plans")).unwrap();
    let plan = ramp(&["plan", "easy-1", "--json"]).stdout;
    std::fs::write(file("plans/easy-1.json"), plan).unwrap();
    let bench = |output: &str, parts: &[&str]| {
        let all = ["bench", "easy-1", "--repeats", "1", "--track", "state", "--world", "ideal", "-o", output];
        let run = ramp(&[&all[..], parts].concat());
        (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
    };
    let (mine, base) = (file("mine"), file("base"));
    let (domain, parameters, plans) = (file("mine.al"), file("mine.toml"), file("plans"));
    let parts = ["--domain", &domain, "--parameters", &parameters, "--plan", &plans];
    let (status, told) = bench(&mine, &parts);
    assert_eq!(status, Some(0), "{told}");
    let name = |folder: &str| {
        result(&Path::new(folder).join("easy-1-state-1.json"))["agent"]["name"].as_str().unwrap().to_string()
    };
    let own = name(&mine);
    for part in ["baseline+parameters.", "+domain.", "+plan."] {
        assert!(own.contains(part), "{own}");
    }
    // The same again is finished already; with other parts it is another agent.
    let written = || std::fs::metadata(file("mine/easy-1-state-1.json")).unwrap().modified().unwrap();
    let before = written();
    let (status, told) = bench(&mine, &parts);
    assert_eq!((status, written()), (Some(0), before), "it ran again: {told}");
    let (status, told) = bench(&mine, &parts[..4]);
    assert!(status == Some(2) && told.contains("the folder would become one of two agents"), "{told}");
    // Rules with the same text are the baseline's.
    let (status, told) = bench(&base, &["--domain", &file("same.al")]);
    assert_eq!((status, name(&base).as_str()), (Some(0), "baseline"), "{told}");
    let page = file("report.html");
    let run = ramp(&["report", &mine, &base, "-o", &page]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(std::fs::read_to_string(page).unwrap().contains(&own));
    let trials = file("trials");
    let one = ["trials", "push", "--track", "state", "--trials", "1", "-o", &trials, "--domain", &domain];
    let run = ramp(&one);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let trial = result(&Path::new(&trials).join("push-state-1.json"));
    assert!(trial["agent"]["name"].as_str().unwrap().starts_with("baseline+domain."), "{trial}");
}

#[test]
fn plans_for_many_goals_are_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| words(folder.path().join(name));
    let plan = ramp(&["plan", "easy-1", "--json"]).stdout;
    std::fs::create_dir(file("plans")).unwrap();
    std::fs::write(file("plans/easy-1.json"), &plan).unwrap();
    let out = file("out");
    for (goals, plans, expected) in [
        (&["easy-1", "easy-2"][..], "plans", "has no plan for the goal easy-2"),
        (&["easy-1", "easy-2"], "plans/easy-1.json", "is the plan of one goal, and there are 2 goals"),
        (&["easy-1"], "none", "none"),
        (&["easy-3"], "plans/easy-1.json", "refused at step"),
    ] {
        let run = ramp(&[&["bench", "-o", &out, "--plan", &file(plans)], goals].concat());
        let told = String::from_utf8_lossy(&run.stderr).replace("\n  │ ", " ");
        assert_eq!(run.status.code(), Some(2), "{told}");
        assert!(told.contains(expected), "{told}");
        assert!(!Path::new(&out).exists());
    }
}

/// A plan that the rules allow and the arm cannot carry out: the step, the part and a remedy are named before
/// anything moves.
#[test]
fn a_plan_that_the_arm_cannot_carry_out_is_refused_before_it_moves() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (words(folder.path().join("plan.json")), words(folder.path().join("out.json")));
    let made = ramp(&["plan", "easy-1", "--json"]);
    let mut own: Value = serde_json::from_slice(&made.stdout).unwrap();
    // A way to its place that begins beyond the arm's reach.
    let entries = own["plan"]["entries"].as_array_mut().unwrap();
    entries.iter_mut().find(|entry| entry["beam"] == "b5").unwrap()["distance"] = 2.0.into();
    std::fs::write(&path, own.to_string()).unwrap();
    let run = ramp(&["run", "easy-1", "--plan", &path, "--check-motion", "-o", &out]);
    let told = String::from_utf8_lossy(&run.stderr).replace("\n  │ ", " ");
    assert_eq!(run.status.code(), Some(2), "{told}");
    for expected in [
        "cannot carry out the plan of easy-1",
        "assemble b5: b5 cannot be inserted",
        "insert b5 from another",
    ] {
        assert!(told.contains(expected), "{told}");
    }
    assert!(!Path::new(&out).exists());
    let judged = ramp(&["plan", "easy-1", "--from", &path, "--check-motion"]);
    let said = String::from_utf8_lossy(&judged.stdout).into_owned();
    assert!(judged.status.code() == Some(1) && said.contains("refused at step"), "{said}");
    assert_eq!(ramp(&["plan", "easy-1", "--from", &path]).status.code(), Some(0));
}
