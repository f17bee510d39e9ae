//! Files as other programs write and pack them: encodings of editors and shells, and what file managers
//! leave beside them.

use std::path::Path;
use std::process::Output;

use crate::ramp;
use ramp_testing::log::as_log;
use ramp_testing::program::words;
use serde_json::json;
use tempfile::TempDir;

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name);
    std::fs::read_to_string(path).unwrap()
}

fn done(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
    words(&output.stdout)
}

fn with_mark(text: &str) -> Vec<u8> {
    [b"\xef\xbb\xbf", text.as_bytes()].concat()
}

fn utf_16(text: &str) -> Vec<u8> {
    [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

/// A reader of files: a file that it reads, and the arguments that read it.
type Reader = (&'static str, String, &'static [&'static str]);

/// PowerShell and some editors begin files with a byte order mark, or write UTF-16.
#[test]
fn every_reader_takes_marks_and_utf_16() {
    let folder = TempDir::new().unwrap();
    let plan = done(&ramp(&folder, &["plan", "easy-1", "--json"]));
    std::fs::write(folder.path().join("log.csv"), data("examples/stopwatch.csv")).unwrap();
    done(&ramp(&folder, &["score", "log.csv", "-o", "results"]));
    let result = std::fs::read_to_string(folder.path().join("results/easy-1-tags-1.json")).unwrap();
    let readers: [Reader; 10] = [
        ("goal.xml", data("goals/easy-1.xml"), &["check", "goal.xml"]),
        ("plan.json", plan, &["plan", "easy-1", "--from", "plan.json"]),
        ("state.json", "{}".to_string(), &["plan", "easy-1", "--coarse", "--state", "state.json"]),
        ("coarse.al", data("domains/coarse.al"), &["plan", "easy-1", "--coarse", "--domain", "coarse.al"]),
        ("order.lp", data("domains/order.lp"), &["plan", "easy-1", "--coarse", "--domain", "order.lp"]),
        ("world.toml", data("worlds/real.toml"), &["world", "show", "world.toml"]),
        ("start.toml", data("starts/sheet.toml"), &["start", "show", "start.toml"]),
        ("log.csv", data("examples/stopwatch.csv"), &["score", "log.csv", "-o", "scored"]),
        ("means.csv", data("published/ramp-baseline.csv"), &["score", "means.csv", "-o", "means"]),
        ("one/it.json", result, &["report", "one"]),
    ];
    std::fs::create_dir(folder.path().join("one")).unwrap();
    for (name, text, arguments) in readers {
        let read = |bytes: &[u8]| {
            std::fs::write(folder.path().join(name), bytes).unwrap();
            ramp(&folder, arguments)
        };
        // Without the time of planning.
        let said = |bytes: &[u8]| done(&read(bytes)).split(" coarse actions in").next().map(str::to_string);
        let sound = said(text.as_bytes());
        assert_eq!(said(&with_mark(&text)), sound, "{name}");
        assert_eq!(said(&utf_16(&text)), sound, "{name}");
        // Without its mark it is refused with its name.
        let output = read(&utf_16(&text)[2..]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let told = words(&output.stderr);
        assert!(told.contains("as in UTF-16 without a byte order mark"), "{name}: {told}");
    }
}

/// Files that macOS and Windows leave in a folder are ignored, with one message for each folder.
#[test]
fn files_of_a_file_manager_are_ignored() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("log.csv"), data("examples/stopwatch.csv")).unwrap();
    done(&ramp(&folder, &["score", "log.csv", "-o", "entries/ours"]));
    // One run of a real robot is not a whole class; the entry is refused with that reason.
    let board = ramp(&folder, &["leaderboard", "entries", "-o", "site"]);
    let said = words(&board.stdout);
    assert!(said.contains("refused ours: ") && !said.contains("MACOSX"), "{said}");
    let report = done(&ramp(&folder, &["report", "entries/ours"]));
    for name in ["entries/ours/._easy-1-tags-1.json", "entries/ours/.DS_Store", "entries/._ours"] {
        std::fs::write(path(name), b"\0\x05\x16\x07").unwrap();
    }
    std::fs::create_dir(path("entries/__MACOSX")).unwrap();
    std::fs::create_dir(path("entries/ours/__MACOSX")).unwrap();
    let output = ramp(&folder, &["leaderboard", "entries", "-o", "site"]);
    assert_eq!((output.status.code(), words(&output.stdout)), (board.status.code(), said));
    let told = words(&output.stderr);
    assert_eq!(told.matches("of a file manager").count(), 2, "{told}");
    assert!(told.contains("entries: 2 files of") && told.contains("ours: 3 files of"), "{told}");
    let output = ramp(&folder, &["report", "entries/ours"]);
    let sums = |text: &str| text.split("our-system, easy").nth(1).map(str::to_string);
    assert!(sums(&report).is_some_and(|sums| sums.contains("1 of 2 episodes")), "{report}");
    assert_eq!(sums(&done(&output)), sums(&report));
    let told = words(&output.stderr) + &words(&output.stdout);
    assert_eq!(told.matches("of a file manager").count(), 1, "{told}");
}

/// A log of measured poses whose clamped beam is turned, in metres or millimetres, is refused with the likely
/// cause, and leaves nothing behind. With the order of the quaternions it is read.
#[test]
fn a_log_of_poses_that_cannot_be_is_refused_and_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    // The clamped beam in its place: turned by -90° about the vertical.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let log = |[x, y, z]: [f64; 3], [w, i, j, k]: [f64; 4]| {
        let stamp = json!({"sec": 1_700_000_001, "nsec": 0});
        let run = json!({
            "schema": "ramp-poses-1", "rules": ramp_result::episode::RULES, "goal": "easy-1", "repeat": 1,
            "track": "tags", "agent": "ours", "version": "1", "robot": "an arm", "computer": "a laptop",
            "cores": 8, "scorer": "A. Person", "source": "a bench", "begin": {"sec": 1_700_000_000, "nsec": 0},
            "planning": 1.0, "end": {"sec": 1_700_000_100, "nsec": 0}, "ended": "done",
        });
        let parts = json!({"transforms": [{
            "timestamp": stamp, "parent_frame_id": "world", "child_frame_id": "b7",
            "translation": {"x": x, "y": y, "z": z}, "rotation": {"w": w, "x": i, "y": j, "z": k},
        }]});
        as_log(
            &[("/run", run), ("/parts", parts)].map(|(topic, it)| (topic.to_string(), it.to_string().into())),
        )
    };
    let place = [0.31, 0.0268, 0.0166];
    let score = |bytes: Vec<u8>, more: &[&str]| {
        std::fs::write(folder.path().join("log.mcap"), bytes).unwrap();
        ramp(&folder, &[&["score", "log.mcap", "-o", "scored"], more].concat())
    };
    // The numbers of x y z w in the fields of w x y z.
    let reordered = [0.0, 0.0, -half, half];
    for (bytes, cause) in [
        (log(place, reordered), "--quaternion xyzw"),
        (log(place.map(|it| it * 1e3), [half, 0.0, 0.0, -half]), "millimetres"),
        (log([0.31, 0.0268, 0.2], [half, 0.0, 0.0, -half]), "mm from its place"),
    ] {
        let output = score(bytes, &[]);
        let said = words(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains("b7") && said.contains(cause), "{cause}: {said}");
        assert!(!folder.path().join("scored").exists(), "{cause}: something was written");
    }
    done(&score(log(place, reordered), &["--quaternion", "xyzw"]));
    assert!(folder.path().join("scored").exists());
}
