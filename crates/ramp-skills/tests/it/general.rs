//! Skills know parts and goals from the kit, the goal and the plan alone: none by name.

use std::path::{Path, PathBuf};

/// Does `text` hold `name` as a word of its own?
fn holds(text: &str, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    text.match_indices(name).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + name.len()..].chars().next();
        !before.is_some_and(word) && !after.is_some_and(word)
    })
}

/// All source files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

#[test]
fn no_skill_names_a_goal_or_a_part() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = root.join("../../data");
    let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
    let mut names: Vec<String> = kit.pegs.iter().map(|peg| peg.name.clone()).collect();
    for beam in &kit.beams {
        names.push(beam.name.clone());
        names.extend(beam.joints.iter().map(|joint| joint.name.clone()));
        names.extend(beam.links.iter().map(|link| link.name.clone()));
    }
    for goal in std::fs::read_dir(data.join("goals")).unwrap() {
        names.push(goal.unwrap().path().file_stem().unwrap().to_str().unwrap().to_string());
    }
    assert!(names.iter().any(|name| name == "hard-3"));
    assert!(holds("if name == \"b4\" {", "b4") && !holds("b41", "b4") && !holds("hard-30", "hard-3"));
    let files = sources(&root.join("src"));
    for path in &files {
        let text = std::fs::read_to_string(path).unwrap();
        // The tests at the end of a file may, and so may a comment that gives an example.
        let code = text.split("#[cfg(test)]").next().unwrap();
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            for name in &names {
                assert!(!holds(line, name), "{} names {name}: {line}", path.display());
            }
        }
    }
    assert!(files.len() > 30);
}
