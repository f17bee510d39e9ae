//! Worlds and starts at the command line: listed, shown, of one's own, wrong, and varied.

use crate::ramp;
use std::path::Path;
use std::process::Output;

fn done(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn refused(output: &Output, sentence: &str) {
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    let plain = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    assert!(plain.contains(sentence), "{plain}");
}

#[test]
fn worlds_are_listed_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let list = done(&ramp(folder.path(), &["world", "list"]));
    let names: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(names, ["ideal", "real", "hard", "ideal+touch", "real+touch", "hard+touch"]);
    let show = |arguments: &[&str]| done(&ramp(folder.path(), &[&["world", "show"], arguments].concat()));
    let real = show(&[]);
    assert!(real.contains("coulomb") && real.contains("Source: "), "{real}");
    assert_ne!(show(&["real", "--seed", "1"]), show(&["real", "--seed", "2"]));
    assert_eq!(show(&["real", "--seed", "1"]), show(&["real", "--seed", "1"]));
    let json: serde_json::Value = serde_json::from_str(&show(&["hard", "--seed", "3", "--json"])).unwrap();
    assert_eq!(json["drawn"]["friction.coulomb"].as_array().unwrap().len(), 7);
    // A world that is printed as a file is one.
    std::fs::write(folder.path().join("again.toml"), show(&["real", "--file"])).unwrap();
    assert_eq!(show(&["again.toml", "--seed", "1"]), show(&["real", "--seed", "1"]));
}

/// A world of one's own runs, the result says which it was and what was drawn, and a replay finds the same
/// physics.
#[test]
fn a_world_of_ones_own_is_run_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let world = "name = \"ours\"\nbased_on = \"real\"\n[friction]\n\
                 coulomb = { value = 0.3, within = 0.1, unit = \"N·m\", source = \"a test\" }\n";
    std::fs::write(place.join("ours.toml"), world).unwrap();
    let run = ["run", "easy-1", "--track", "state", "--world", "ours.toml", "--seed", "2", "-o", "out.json"];
    let said = done(&ramp(place, &run));
    assert!(said.contains("world ours") && said.contains("3 of 3 pegs"), "{said}");
    let result: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(place.join("out.json")).unwrap()).unwrap();
    assert_eq!(result["world"]["name"], "ours");
    let drawn = result["world"]["draw"]["friction.coulomb"].as_array().unwrap();
    assert!(drawn.iter().all(|it| (0.2..=0.4).contains(&it.as_f64().unwrap())), "{drawn:?}");
    done(&ramp(place, &["replay", "out.mcap"]));
}

#[test]
fn a_wrong_world_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    refused(&ramp(place, &["run", "easy-1", "--world", "reel"]), "did you mean `real`");
    let wrong = "name = \"x\"\nbased_on = \"real\"\n[line]\nlost = { value = 2, source = \"a test\" }\n";
    std::fs::write(place.join("wrong.toml"), wrong).unwrap();
    refused(&ramp(place, &["bench", "easy-1", "--world", "wrong.toml"]), "expected a number from 0 to 0.1");
    let sweep = |vary: &str| ramp(place, &["sweep", "easy-1", "--vary", vary]);
    refused(&sweep("friction.columb=0..1"), "did you mean `friction.coulomb`");
    refused(&sweep("friction.coulomb=0..99"), "expected a number from 0 to 20");
    refused(&sweep("friction.coulomb=1"), "expected QUANTITY=FROM..TO");
    refused(&sweep("friction.coulomb=1..0"), "expected QUANTITY=FROM..TO");
    assert!(!place.join("results").exists(), "nothing is written");
}

/// A sweep runs each world, writes table, figure and page, and resumes where it stopped.
#[test]
fn a_sweep_gives_a_table_and_a_figure() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/mover.py");
    let agent = agent.to_str().unwrap();
    let sweep = ["sweep", "easy-1", "--track", "state", "--world", "real", "--steps", "2"];
    let vary = ["--vary", "friction.coulomb=0..0.4", "--curves", "controller.compensation=0,1"];
    let sweep = [&sweep[..], &vary].concat();
    let rest = ["--repeats", "1", "--agent", agent, "-o", "out"];
    let said = done(&ramp(place, &[&sweep[..], &rest].concat()));
    assert!(said.contains("controller.compensation 0") && said.contains("0/1"), "{said}");
    let csv = std::fs::read_to_string(place.join("out/sweep.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5);
    let figure = std::fs::read_to_string(place.join("out/sweep.svg")).unwrap();
    assert!(figure.starts_with("<svg") && figure.contains("controller.compensation 1"));
    assert!(
        std::fs::read_to_string(place.join("out/sweep.html")).unwrap().contains("Sweep of friction.coulomb")
    );
    // Finished episodes are not run again.
    let log = place.join("out/easy-1-real+controller.compensation-0+friction.coulomb-0-state-1.mcap");
    let written = || std::fs::metadata(&log).unwrap().modified().unwrap();
    let before = written();
    assert_eq!(done(&ramp(place, &[&sweep[..], &rest].concat())), said);
    assert_eq!(written(), before);
}

/// A start of one's own runs, the result names it, and a wrong one is refused with its place.
#[test]
fn starts_are_listed_shown_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let list = done(&ramp(place, &["start", "list"]));
    assert!(list.starts_with("sheet") && list.contains("\nmoved") && list.contains("\nscattered"), "{list}");
    assert!(done(&ramp(place, &["start", "show"])).contains("clearance"));
    let file = done(&ramp(place, &["start", "show", "moved", "--file"]));
    std::fs::write(place.join("ours.toml"), file.replace("name = \"moved\"", "name = \"ours\"")).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&done(&ramp(place, &["start", "show", "ours.toml", "--json"]))).unwrap();
    assert_eq!((&json["name"], &json["quantities"][0]["name"]), (&"ours".into(), &"shift".into()));
    std::fs::write(place.join("wrong.toml"), file.replace("5.0e-3", "5.0")).unwrap();
    let run = |start: &str| ramp(place, &["run", "easy-1", "--start", start, "-o", "out.json"]);
    refused(&run("wrong.toml"), "found shift = 5.0, expected a number from 0 to 0.05 m");
    refused(&run("shet"), "there is no start `shet`");
    assert!(!place.join("out.json").exists());
}
