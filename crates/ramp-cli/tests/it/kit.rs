//! `ramp kit export`, `ramp goals generate` and `ramp show --all` as a user meets them.

use assert_cmd::Command;

fn ramp() -> Command {
    Command::cargo_bin("ramp").unwrap()
}

#[test]
fn exports_a_kit_and_keeps_other_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("parts");
    ramp().args(["kit", "export"]).arg(&out).assert().success();
    assert!(out.join("sheet.pdf").is_file() && out.join("stl/peg.stl").is_file());
    std::fs::write(out.join("sheet.svg"), "mine").unwrap();
    let refused = ramp().args(["kit", "export"]).arg(&out).assert().code(2);
    let words = String::from_utf8_lossy(&refused.get_output().stderr).replace('\n', " ");
    assert!(words.contains("--force"), "{words}");
    assert_eq!(std::fs::read_to_string(out.join("sheet.svg")).unwrap(), "mine");
    ramp().args(["kit", "export", "--force"]).arg(&out).assert().success();
}

#[test]
fn generates_goals_that_pass_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let generate = |more: &[&str]| {
        ramp().args(["goals", "generate", "-o"]).arg(folder.path()).args(more).assert().success();
    };
    generate(&["--beams", "5", "--seed", "3", "--class", "hard", "--count", "2"]);
    generate(&["--beams", "20", "--seed", "1"]);
    let mut checked = 0;
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        if stem.ends_with("-kit") {
            continue;
        }
        let mut check = ramp();
        check.arg("check").arg(&path);
        let kit = path.with_file_name(format!("{stem}-kit.xml"));
        if kit.exists() {
            check.arg("--kit").arg(kit);
        }
        check.assert().success();
        checked += 1;
    }
    assert_eq!(checked, 3);
    // A single goal without a folder; the same seed, the same text.
    let text =
        || ramp().args(["goals", "generate", "--seed", "9"]).assert().success().get_output().stdout.clone();
    assert_eq!(text(), text());
    ramp().args(["goals", "generate", "--beams", "1"]).assert().code(2);
}

#[test]
fn shows_all_goals_on_one_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("all.svg");
    ramp().args(["show", "--all", "-o"]).arg(&file).assert().success();
    let svg = std::fs::read_to_string(file).unwrap();
    for name in ["easy-1", "medium-2", "hard-3"] {
        assert!(svg.contains(&format!("aria-label=\"{name}\"")), "{name}");
    }
    ramp().args(["show"]).assert().code(2);
    ramp().args(["show", "--all", "easy-1"]).assert().code(2);
}
