//! Unpredictable seeds: an organiser's secret in a bench.

use std::path::Path;

use crate::ramp;
use ramp_testing::program::text;
use serde_json::Value;
use tempfile::TempDir;

fn file(folder: &TempDir, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path().join(name)).unwrap()).unwrap()
}

#[test]
fn a_secret_makes_other_worlds_of_the_same_seeds() {
    let folder = TempDir::new().unwrap();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/good.py");
    let agent = agent.to_str().unwrap();
    let output = ramp(&folder, &["seeds", "commit", "-o", "kept"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let again = ramp(&folder, &["seeds", "commit", "-o", "kept"]);
    assert_eq!(again.status.code(), Some(2), "what was promised is not written over");
    let commitment = file(&folder, "kept/commitment.json")["commitment"].as_str().unwrap().to_string();
    let check = ["seeds", "verify", "kept/commitment.json", "kept/secret.json"];
    assert_eq!(ramp(&folder, &check).status.code(), Some(0));

    let bench = |place: &str, secret: &[&str]| {
        let base = ["bench", "easy-1", "--track", "state", "--repeats", "1", "--agent", agent, "-o", place];
        ramp(&folder, &[&base[..], secret].concat())
    };
    for (place, secret) in [("open", &[][..]), ("sealed", &["--secret", "kept/secret.json"])] {
        let output = bench(place, secret);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    let [open, sealed] =
        ["open", "sealed"].map(|place| file(&folder, &format!("{place}/easy-1-state-1.json")));
    assert_eq!(sealed["seed"], 1);
    assert_eq!(sealed["secret"], commitment.as_str());
    assert!(open.get("secret").is_none());
    assert_ne!(open["physics"]["state"], sealed["physics"]["state"], "the start is another one");
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/schema/episode.schema.json");
    let schema = serde_json::from_str(&std::fs::read_to_string(schema).unwrap()).unwrap();
    assert!(jsonschema::is_valid(&schema, &sealed));

    // The world is the one of the secret, the goal, the track and the number.
    let log = ramp_log::Log::read(&folder.path().join("sealed/easy-1-state-1.mcap")).unwrap();
    let kept = serde_json::from_value(file(&folder, "kept/secret.json")).unwrap();
    let secret = ramp_result::secret::Secret::from_kept(&kept).unwrap();
    let world = log.header.secret.unwrap();
    assert_eq!(world.commitment, commitment);
    assert_eq!(world.seed, secret.seed("easy-1", "state", 1));
    let replay = ramp(&folder, &["replay", "sealed/easy-1-state-1.mcap"]);
    assert_eq!(replay.status.code(), Some(0), "{}", text(&replay.stdout));

    // A folder is of one secret.
    for (place, secret) in [("sealed", &[][..]), ("open", &["--secret", "kept/secret.json"])] {
        let output = bench(place, secret);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("of another secret"), "{}", text(&output.stderr));
    }
    // Another secret than the promised one, and what is none.
    let path = folder.path().join("kept/secret.json");
    let digits = file(&folder, "kept/secret.json")["secret"].as_str().unwrap().to_string();
    let other = if digits.starts_with('0') { "1" } else { "0" }.to_string() + &digits[1..];
    let whole = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, whole.replace(&digits, &other)).unwrap();
    assert_eq!(ramp(&folder, &check).status.code(), Some(1));
    std::fs::write(&path, whole.replace(&digits, "00")).unwrap();
    let output = bench("new", &["--secret", "kept/secret.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("64 hexadecimal digits"), "{}", text(&output.stderr));
    assert!(!folder.path().join("new").exists());
}
