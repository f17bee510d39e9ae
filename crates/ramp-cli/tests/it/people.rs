//! Files as other programs write and pack them: encodings of editors and shells, and what file managers
//! leave beside them.

use std::path::Path;
use std::process::Output;

use crate::ramp;
use ramp_testing::program::words;
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
