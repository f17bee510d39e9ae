//! The program away from its repository: built-in data, data of one's own, completions and manual pages.

use crate::ramp;
use tempfile::TempDir;

/// Standard output of a command that is done.
fn done(folder: &TempDir, arguments: &[&str]) -> String {
    let output = ramp(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn exported_data_is_the_built_in_data_until_it_is_changed() {
    let folder = TempDir::new().unwrap();
    done(&folder, &["data", "export", "mine"]);
    for words in [&["goals"][..], &["plan", "hard-2", "--json"], &["skills"], &["twin", "export", "easy-1"]] {
        let plain = |text: String| {
            text.lines().filter(|line| !line.contains("seconds")).map(str::to_string).collect::<Vec<_>>()
        };
        let own = done(&folder, &[words, &["--data", "mine"]].concat());
        assert_eq!(plain(done(&folder, words)), plain(own), "{words:?}");
    }

    let goal = folder.path().join("mine/goals/easy-1.xml");
    let changed = std::fs::read_to_string(&goal).unwrap().replace("b5", "b8");
    std::fs::write(&goal, &changed).unwrap();
    let refused = ramp(&folder, &["data", "export", "mine"]);
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&goal).unwrap(), changed);

    let skills = folder.path().join("mine/skills/baseline.toml");
    let text = std::fs::read_to_string(&skills).unwrap();
    assert!(text.contains("\nlift = 0.02"));
    std::fs::write(&skills, text.replacen("\nlift = 0.02", "\nlift = 0.03", 1)).unwrap();
    assert!(done(&folder, &["skills", "pick_up", "--data", "mine"]).contains("0.03 m"));
    assert!(!done(&folder, &["skills", "pick_up"]).contains("0.03 m"));

    done(&folder, &["data", "export", "mine", "--force"]);
    assert_ne!(std::fs::read_to_string(&goal).unwrap(), changed);
}

#[test]
fn a_folder_without_a_kit_is_refused_with_a_way_out() {
    let folder = TempDir::new().unwrap();
    let output = ramp(&folder, &["goals", "--data", "."]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("ramp data export"));
}

#[test]
fn missing_folders_of_results_are_made() {
    let folder = TempDir::new().unwrap();
    done(&folder, &["twin", "export", "easy-1", "-o", "new/folder/scene.xml"]);
    done(&folder, &["show", "easy-1", "-o", "other/easy-1.svg"]);
    done(&folder, &["kit", "export", "-o", "parts"]);
    assert!(folder.path().join("new/folder/scene.xml").is_file());
    assert!(folder.path().join("other/easy-1.svg").is_file());
    assert!(folder.path().join("parts").is_dir());
}

#[test]
fn shells_complete_and_manual_pages_are_there_for_each_command() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        assert!(done(&folder, &["completions", shell]).contains("leaderboard"), "{shell}");
    }
    done(&folder, &["man", "man1"]);
    for page in ["ramp.1", "ramp-run.1", "ramp-goals-generate.1"] {
        let text = std::fs::read_to_string(folder.path().join("man1").join(page)).unwrap();
        assert!(text.contains(".SH SYNOPSIS"), "{page}");
    }
}
