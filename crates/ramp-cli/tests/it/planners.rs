//! Task planners that are programs of their own.

use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/planners").join(name);
    path.canonicalize().unwrap().display().to_string()
}

fn ramp(folder: &TempDir, arguments: &[&str]) -> Output {
    super::ramp(folder.path(), arguments)
}

fn result(folder: &TempDir, name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.path().join(name)).unwrap()).unwrap()
}

/// Writes a planner whose `main` gets the problem.
fn planner(folder: &TempDir, name: &str, main: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, format!("import json, sys, time\nproblem = json.loads(input())\n{main}\n"))
        .unwrap();
    path.display().to_string()
}

/// The example plans at the start and again after a fault, from the state that the baseline believes in.
#[test]
fn the_example_plans_and_plans_again() {
    let folder = TempDir::new().unwrap();
    let planner = example("greedy.py");
    let run = ["run", "easy-1", "--track", "state", "--fault", "peg-missing@1", "--planner", &planner];
    let run = ramp(&folder, &[&run[..], &["-o", "out.json"]].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let result = result(&folder, "out.json");
    assert_eq!(result["completion"], 1.0);
    let name = result["agent"]["name"].as_str().unwrap();
    assert!(name.starts_with("baseline+planner-greedy."), "{name}");
    assert!(result["plan"]["replans"].as_u64().unwrap() >= 1);
    assert!(result["plan"]["coarse"].as_u64().unwrap() > 30);
    assert!(result["time"]["planning"].as_f64().unwrap() > 0.05);
}

/// The problem that a planner gets, and a plan in JSON.
#[test]
fn a_planner_gets_goal_state_and_history() {
    let folder = TempDir::new().unwrap();
    let made = ramp(&folder, &["plan", "easy-1", "--json"]);
    std::fs::write(folder.path().join("plan.json"), &made.stdout).unwrap();
    let plan = folder.path().join("plan.json").display().to_string();
    let main = format!(
        "assert problem['planner'] == 1 and problem['goal']['name'] == 'easy-1', problem\n\
         assert problem['goal']['connections'] and problem['goal']['beams'] and problem['goal']['files']['kit']\n\
         assert problem['state']['in_assembly'] == [] and isinstance(problem['history'], list)\n\
         assert not any(word in json.dumps(problem) for word in ('seed', 'x_wt'))\n\
         print(open({plan:?}).read())"
    );
    let own = planner(&folder, "own.py", &main);
    let bench = ["bench", "easy-1", "--track", "state", "--repeats", "1", "--planner", &own, "-o", "out"];
    let run = ramp(&folder, &bench);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let result = result(&folder, "out/easy-1-state-1.json");
    assert_eq!(result["completion"], 1.0, "{}", result["ended"]);
    // Another planner does not go on in the folder of this one.
    std::fs::write(&own, "print()").unwrap();
    assert_eq!(ramp(&folder, &bench).status.code(), Some(2));
}

/// At a new plan the planner gets the events up to then.
#[test]
fn a_planner_gets_the_history_at_a_new_plan() {
    let folder = TempDir::new().unwrap();
    let made = ramp(&folder, &["plan", "easy-1", "--json"]);
    std::fs::write(folder.path().join("plan.json"), &made.stdout).unwrap();
    let plan = folder.path().join("plan.json").display().to_string();
    let main = format!(
        "kinds = [event['kind'] for event in problem['history']]\n\
         if kinds: sys.exit(7 if 'fault' in kinds and 'action_begun' in kinds else 8)\n\
         print(open({plan:?}).read())"
    );
    let own = planner(&folder, "own.py", &main);
    let run = ["run", "easy-1", "--track", "state", "--fault", "peg-missing@1", "--planner", &own];
    ramp(&folder, &[&run[..], &["-o", "out.json"]].concat());
    let reason = result(&folder, "out.json")["ended"]["reason"].as_str().unwrap().to_string();
    assert!(reason.ends_with("it ended with status 7"), "{reason}");
}

/// A planner that fails ends its episode, and the reason is in the result.
#[test]
fn a_planner_that_fails_ends_its_episode_with_a_reason() {
    let folder = TempDir::new().unwrap();
    for (name, main, why) in [
        ("crash.py", "sys.exit(3)", "no plan: the planner crashed: it ended with status 3"),
        ("silent.py", "pass", "no plan: the planner wrote no plan"),
        ("slow.py", "time.sleep(30)", "no plan: the planner was not done after 1 s"),
        ("wrong.py", "print('(assemble b4)')", "no plan: the planner's plan: "),
        (
            "endless.py",
            "while True: print('(' * 65536)",
            "no plan: the planner wrote more than 16777216 bytes",
        ),
        ("words.py", "print('{\"plan\": 7}')", "no plan: the planner's plan: "),
    ] {
        let own = planner(&folder, name, main);
        let out = format!("{name}.json");
        let limit = if name == "slow.py" { "1" } else { "60" };
        let run = ["run", "easy-1", "--world", "ideal", "--track", "state", "--agent-limit", limit];
        let run = ramp(&folder, &[&run[..], &["--planner", &own, "-o", &out]].concat());
        assert_eq!(run.status.code(), Some(1), "{name}: {}", String::from_utf8_lossy(&run.stderr));
        let result = result(&folder, &out);
        let reason = result["ended"]["reason"].as_str().unwrap();
        assert!(reason.starts_with(why), "{name}: {reason}");
    }
    let missing = ramp(&folder, &["run", "easy-1", "--planner", "nowhere.py"]);
    assert_eq!(missing.status.code(), Some(2));
}
