//! The program away from its repository: built-in data, data of one's own, completions and manual pages.

use std::path::Path;
use std::process::Command;

use crate::ramp;
use ramp_testing::program::text;
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

/// On a narrow terminal, help and messages break between words.
#[test]
fn help_and_messages_break_between_words() {
    let output = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_ramp")).args(arguments).env("COLUMNS", "60").output().unwrap()
    };
    for command in ["run", "bench", "leaderboard"] {
        let help = text(&output(&[command, "--help"]).stdout);
        assert!(help.lines().count() > 20);
        for line in help.lines() {
            assert!(line.chars().count() <= 60, "{command}: {line}");
        }
    }
    let message = text(&output(&["trials", "fasten"]).stderr);
    assert!(message.lines().count() > 3);
    for line in message.lines() {
        assert!(!line.ends_with('-'), "{message}");
    }
}

/// The words that bash offers at the end of a line of a `ramp` command.
fn completed(folder: &TempDir, line: &str) -> Vec<String> {
    let script = r#"source <(ramp completions bash)
        read -ra COMP_WORDS <<< "ramp $LINE"
        [[ "$LINE" == *" " ]] && COMP_WORDS+=("")
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMP_TYPE=9
        _clap_complete_ramp ramp "${COMP_WORDS[COMP_CWORD]}"
        printf '%s\n' "${COMPREPLY[@]}""#;
    let program = Path::new(env!("CARGO_BIN_EXE_ramp")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let output = Command::new("bash")
        .args(["-c", script])
        .current_dir(folder)
        .env("PATH", path)
        .env("LINE", line)
        .output()
        .unwrap();
    assert!(output.status.success(), "{line}: {}", text(&output.stderr));
    text(&output.stdout).lines().map(|it| it.trim().to_string()).collect()
}

#[test]
fn shells_complete_and_manual_pages_are_there_for_each_command() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(done(&folder, &["completions", shell]).contains("RAMP_COMPLETE"), "{shell}");
    }
    std::fs::write(folder.path().join("mine.xml"), "").unwrap();
    for (line, expected) in [
        ("leader", &["leaderboard"][..]),
        ("run ea", &["easy-1", "easy-2", "easy-3"]),
        ("run mi", &["mine.xml"]),
        ("plan hard-", &["hard-1", "hard-2", "hard-3"]),
        ("bench ea", &["easy", "easy-1", "easy-2", "easy-3"]),
        ("bench easy-1 ha", &["hard", "hard-1", "hard-2", "hard-3"]),
        ("run easy-1 --arm ", &["panda", "fr3"]),
        ("run easy-1 --world i", &["ideal", "ideal+touch"]),
        ("run easy-1 --start m", &["moved", "mine.xml"]),
        ("run easy-1 --fault peg-", &["peg-dropped", "peg-tilted", "peg-missing"]),
        ("run easy-1 --skill fast", &["fasten="]),
        ("run easy-1 --skill fasten=mi", &["fasten=mine.xml"]),
        ("trials fasten-in-f", &["fasten-in-f", "fasten-in-f-end"]),
        ("world show r", &["real", "real+touch"]),
        ("start show s", &["sheet", "scattered"]),
        ("score --form medium-", &["medium-1", "medium-2", "medium-3"]),
    ] {
        assert_eq!(completed(&folder, line), expected, "{line}");
    }
    done(&folder, &["man", "man1"]);
    for page in ["ramp.1", "ramp-run.1", "ramp-goals-generate.1"] {
        let text = std::fs::read_to_string(folder.path().join("man1").join(page)).unwrap();
        assert!(text.contains(".SH SYNOPSIS"), "{page}");
    }
}
