//! `ramp leaderboard` as an organiser has it: entries of strangers, some of them bad, on a site.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use ramp_result::episode::RULES;
use ramp_result::sha256;
use ramp_testing::log::{as_log, messages};
use ramp_testing::trials::{Trial, check, check_unless};
use ramp_world::{Start, World};
use serde_json::Value;
use tempfile::TempDir;

use crate::missing;
use ramp_testing::program::text;

/// A folder with data of one small class: `easy` is a corner of two beams.
struct Place(TempDir);

impl Place {
    fn new() -> Place {
        let place = Place(TempDir::new().unwrap());
        place.done(&["data", "export", "data"]);
        std::fs::remove_dir_all(place.path("data/goals")).unwrap();
        std::fs::create_dir(place.path("data/goals")).unwrap();
        let goal = r#"<assembly name="easy-1" class="easy">
  <component beam="b7" base="True"/>
  <component beam="b4"/>
  <connection name="C1">
    <element component="b4" joint="b4j1"/>
    <element component="b7" joint="b7j1"/>
  </connection>
</assembly>"#;
        std::fs::write(place.path("data/goals/easy-1.xml"), goal).unwrap();
        std::fs::create_dir(place.path("entries")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn ramp(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
        command.current_dir(&self.0).args(arguments).env("PYTHONDONTWRITEBYTECODE", "1").output().unwrap()
    }

    fn done(&self, arguments: &[&str]) {
        let output = self.ramp(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    }

    /// An entry as its owner makes it: an agent of this name that moves so far, and its results.
    fn enter(&self, entry: &str, name: &str, shift: usize) {
        self.enter_on("state", entry, name, shift, |agent| agent);
    }

    /// The same on a given track, with a change to the agent's file.
    fn enter_on(
        &self,
        track: &str,
        entry: &str,
        name: &str,
        shift: usize,
        change: impl Fn(String) -> String,
    ) {
        self.enter_in("real", track, entry, name, shift, change);
    }

    /// The same in a given world.
    fn enter_in(
        &self,
        world: &str,
        track: &str,
        entry: &str,
        name: &str,
        shift: usize,
        change: impl Fn(String) -> String,
    ) {
        let folder = self.path("entries").join(entry);
        std::fs::create_dir(&folder).unwrap();
        let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/mover.py");
        let agent = std::fs::read_to_string(agent).unwrap();
        assert!(agent.contains("\"mover\", 1\n"));
        let agent = agent.replace("\"mover\", 1\n", &format!("\"{name}\", {shift}\n"));
        std::fs::write(folder.join("agent.py"), change(agent)).unwrap();
        let file = format!("entries/{entry}/agent.py");
        let output = format!("entries/{entry}");
        let bench = ["--data", "data", "bench", "easy", "--track", track, "--world", world, "--jobs", "2"];
        self.done(&[&bench[..], &["--agent", &file, "-o", &output]].concat());
    }

    /// An entry that is a copy of another one.
    fn copy(&self, entry: &str, of: &str) -> PathBuf {
        let folder = self.path("entries").join(entry);
        std::fs::create_dir(&folder).unwrap();
        for file in std::fs::read_dir(self.path("entries").join(of)).unwrap() {
            let file = file.unwrap();
            std::fs::copy(file.path(), folder.join(file.file_name())).unwrap();
        }
        folder
    }

    fn board(&self, more: &[&str]) -> (Option<i32>, String) {
        let output = self.ramp(&[&["--data", "data", "leaderboard", "entries", "-o", "site"], more].concat());
        // Progress only, without the control characters of a name.
        let progress = text(&output.stderr);
        let known =
            |line: &str| ["entry ", "reading: ", "running again: "].iter().any(|it| line.starts_with(it));
        assert!(progress.starts_with("entry 1 of ") && progress.lines().all(known), "{progress}");
        assert!(!progress.contains('\u{1b}'), "{progress}");
        (output.status.code(), text(&output.stdout))
    }

    fn page(&self, name: &str) -> String {
        std::fs::read_to_string(self.path("site").join(name)).unwrap()
    }
}

fn change(path: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{from}: {text}");
    std::fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// The page of the one board here.
fn board_page() -> String {
    let [world, start] = [&World::shipped("real").unwrap().text, &Start::shipped("moved").unwrap().text]
        .map(|text| sha256(text.as_bytes()));
    format!("board-easy-state-panda-real-{}-moved-{}-{RULES}.html", &world[..24], &start[..24])
}

fn bad_entries_are_told_and_the_others_are_on_the_board() {
    let place = Place::new();
    place.enter("h-good", "good", 1);
    let result =
        |folder: &Path, seed: u64, ending: &str| folder.join(format!("easy-1-state-{seed}.{ending}"));
    let folder = place.copy("a-cut", "h-good");
    let log = std::fs::read(result(&folder, 2, "mcap")).unwrap();
    std::fs::write(result(&folder, 2, "mcap"), &log[..log.len() / 2]).unwrap();
    let folder = place.copy("b-faster", "h-good");
    let path = result(&folder, 3, "json");
    let mut faster: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    faster["time"]["compute"] = 0.0.into();
    faster["time"]["planning"] = 0.0.into();
    faster["time"]["total"] = faster["time"]["robot"].clone();
    std::fs::write(&path, faster.to_string()).unwrap();
    let folder = place.copy("c-part", "h-good");
    for ending in ["json", "log"] {
        std::fs::remove_file(result(&folder, 4, ending)).unwrap();
    }
    let folder = place.copy("d-<b>\u{1b}[31mnot-json", "h-good");
    std::fs::write(result(&folder, 5, "json"), "<script>alert(1)</script>").unwrap();
    // Links lead out of the entry, and opening a pipe blocks for ever.
    let folder = place.copy("e-link", "h-good");
    std::fs::remove_file(result(&folder, 1, "mcap")).unwrap();
    std::os::unix::fs::symlink(place.path("entries/h-good/easy-1-state-1.mcap"), result(&folder, 1, "mcap"))
        .unwrap();
    std::os::unix::fs::symlink(place.path("entries/h-good"), place.path("entries/f-link")).unwrap();
    let folder = place.copy("g-pipe", "h-good");
    std::fs::remove_file(result(&folder, 1, "mcap")).unwrap();
    assert!(Command::new("mkfifo").arg(result(&folder, 1, "mcap")).status().unwrap().success());
    // Everybody's class decides on the board, and not what a result says of it.
    let folder = place.copy("g-class", "h-good");
    for seed in 1..=5 {
        change(&result(&folder, seed, "json"), "\"class\": \"easy\"", "\"class\": \"hard\"");
    }
    place.copy("i-again", "h-good");
    place.enter("j-copy", "copy", 1);
    // It calls a function that its track does not allow.
    place.enter_on("tags", "k-asked", "asked", 1, |agent| {
        let done = "tell({\"done\": {}})";
        assert!(agent.contains(done));
        agent.replace(done, &format!("tell({{\"read_parts\": {{}}}})\nhear()\n{done}"))
    });
    // It runs on one track, and claims another.
    let folder = place.copy("l-relabelled", "k-asked");
    for seed in 1..=5 {
        let path = folder.join(format!("easy-1-tags-{seed}.json"));
        change(&path, "\"track\": \"tags\"", "\"track\": \"state\"");
    }

    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(1), "{told}");
    for sentence in [
        "refused a-cut: easy-1-state-2.mcap: the log is not a complete MCAP file: it ends too early",
        "refused b-faster: easy-1-state-3.json: the result differs from the one in its log",
        "refused c-part: good, track state: easy-1 was run with seeds 1, 2, 3, 5",
        "refused d-<b>\\u{1b}[31mnot-json: easy-1-state-5.json:1:1: expected value",
        "refused e-link: easy-1-state-1.mcap is a link",
        "refused f-link: it is no folder",
        "refused g-pipe: easy-1-state-1.mcap is no ordinary file",
        "refused g-class: easy-1-state-1.json: the goal differs from this board's goal of the same name",
        "refused i-again: entry h-good has these episodes of good 1.0 already",
        "warning j-copy: 5 of its 5 episodes make the same calls, to the last bit, as entry h-good (good 1.0)",
        "admitted h-good: good 1.0",
        "refused k-asked: easy-1-tags-1.mcap: at ",
        "the agent requested poses of parts, not available on track `tags`",
        "refused l-relabelled: easy-1-tags-1.mcap: at ",
        "2 of 13 entries admitted; ",
    ] {
        assert!(told.contains(sentence), "{sentence}: {told}");
    }
    let board = place.page(&board_page());
    assert!(board.contains("good 1.0") && board.contains("copy 1.0") && board.contains("as entry h-good"));
    assert!(place.page("index.html").contains(&format!("href=\"{}\"", board_page())));
    let refused = place.page("refused.html");
    assert!(refused.contains("d-&lt;b&gt;\\u{1b}[31mnot-json") && refused.contains("is a link"), "{refused}");
    assert!(!refused.contains("<script>alert") && !refused.contains('\u{1b}'));
    assert!(place.page("agent-1.html").contains("href=\"index.html\""));

    verdicts_are_stored_by_the_hash_of_the_log(&place);
}

/// Builds the board of this place again.
fn verdicts_are_stored_by_the_hash_of_the_log(place: &Place) {
    let (_, told) = place.board(&[]);
    assert!(told.contains("; 0 logs run again, "), "{told}");
    let path = place.path("site/replayed.json");
    let mut verdicts: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    for (_, verdict) in verdicts["logs"].as_object_mut().unwrap() {
        if verdict["valid"].is_object() {
            *verdict = serde_json::json!({"refused": "it does not replay: so it was"});
            break;
        }
    }
    std::fs::write(&path, verdicts.to_string()).unwrap();
    let (_, told) = place.board(&[]);
    assert!(told.contains(".mcap: it does not replay: so it was"), "{told}");
    assert!(told.contains("1 of 13 entries admitted"), "{told}");
    assert!(!place.path("site/agent-2.html").exists(), "a page of an earlier time is left");
    std::fs::write(&path, "{").unwrap();
    let (_, told) = place.board(&[]);
    assert!(
        told.contains("site/replayed.json is damaged (") && told.contains("run again, 0 known"),
        "{told}"
    );
    change(&path, "\"commit\": \"", "\"commit\": \"other-");
    let (_, told) = place.board(&[]);
    assert!(told.contains("is of ramp ") && told.contains("run again, 0 known"), "{told}");
}

fn a_site_is_written_when_all_are_refused_and_none_into_the_entries() {
    let place = Place::new();
    let output = place.ramp(&["--data", "data", "leaderboard", "entries", "-o", "site"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("there is no entry in entries"));
    std::fs::create_dir(place.path("entries/empty")).unwrap();
    for site in ["entries/site", "entries", "."] {
        let output = place.ramp(&["--data", "data", "leaderboard", "entries", "-o", site]);
        assert_eq!(output.status.code(), Some(2), "{site}");
        assert!(text(&output.stderr).contains("lie in one another"), "{}", text(&output.stderr));
    }
    assert!(!place.path("entries/site").exists());
    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(1));
    assert!(told.contains("refused empty: there is no result in "), "{told}");
    assert!(place.page("index.html").contains("1 entry was refused"));
}

fn agents_are_run_again_for_their_times() {
    let place = Place::new();
    place.enter("a-same", "same", 1);
    place.enter("b-other", "other", 2);
    // Another file than the one that made the results.
    place.enter("c-changed", "changed", 3);
    change(&place.path("entries/c-changed/agent.py"), "\"changed\", 3", "\"changed\", 4");
    place.enter("d-absent", "absent", 4);
    std::fs::remove_file(place.path("entries/d-absent/agent.py")).unwrap();
    // A nondeterministic agent: it depends on its working folder.
    let own = |entry: &str| place.path("entries").join(entry);
    std::fs::create_dir(own("e-random")).unwrap();
    let agent = std::fs::read_to_string(own("a-same").join("agent.py")).unwrap();
    let agent = agent.replace("\"same\", 1", "\"random\", 7 if \"entries\" in __file__ else 8");
    std::fs::write(own("e-random").join("agent.py"), agent).unwrap();
    place.done(&[
        "--data",
        "data",
        "bench",
        "easy",
        "--track",
        "state",
        "--agent",
        "entries/e-random/agent.py",
        "-o",
        "entries/e-random",
    ]);

    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(0), "{told}");
    assert!(!place.page(&board_page()).contains("<small>timed here"));
    let (status, told) = place.board(&["--rerun-agents"]);
    assert_eq!(status, Some(0), "{told}");
    for sentence in [
        "warning c-changed: its times are its own: agent.py is not the file that the results name",
        "warning d-absent: its times are its own: there is no agent.py and no agent in the entry",
        "warning e-random: run again here, 5 of its 5 episodes made other calls, 0 with other pegs",
    ] {
        assert!(told.contains(sentence), "{sentence}: {told}");
    }
    assert!(!told.contains("warning a-same") && !told.contains("warning b-other"), "{told}");
    let board = place.page(&board_page());
    assert_eq!(board.matches("<small>timed here").count(), 2 * 3, "planning and compute of three agents");
}

/// The results of an entry and their logs, each changed; the hash of the log in the result is right again.
fn change_logs(folder: &Path, change: impl Fn(&mut Value, &mut Value)) {
    for seed in 1..=5 {
        let [json, mcap] = ["json", "mcap"].map(|it| folder.join(format!("easy-1-state-{seed}.{it}")));
        let mut messages = messages(&std::fs::read(&mcap).unwrap());
        let read = |topic: &str| -> Value {
            let found = messages.iter().find(|it| it.0 == topic).unwrap();
            serde_json::from_slice(&found.1).unwrap()
        };
        let (mut header, mut result) = (read("/episode"), read("/result"));
        change(&mut header, &mut result);
        for (topic, value) in [("/episode", &header), ("/result", &result)] {
            messages.iter_mut().find(|it| it.0 == topic).unwrap().1 = value.to_string().into_bytes();
        }
        let bytes = as_log(&messages);
        result["log"] = sha256(&bytes).into();
        std::fs::write(mcap, bytes).unwrap();
        std::fs::write(json, result.to_string()).unwrap();
    }
}

fn a_world_under_a_shipped_name_is_not_on_its_board() {
    let place = Place::new();
    // The numbers of a perfect arm under the name of the default world.
    let ideal = std::fs::read_to_string(place.path("data/worlds/ideal.toml")).unwrap();
    assert!(ideal.contains("name = \"ideal\""));
    std::fs::write(place.path("fake.toml"), ideal.replace("name = \"ideal\"", "name = \"real\"")).unwrap();
    std::fs::write(place.path("mine.toml"), ideal.replace("name = \"ideal\"", "name = \"mine\"")).unwrap();
    place.enter_in("fake.toml", "state", "b-renamed", "renamed", 1, |agent| agent);
    let shipped = sha256(World::shipped("real").unwrap().text.as_bytes());
    // The same with the hash of the shipped file at the start of the log and in the result.
    let folder = place.copy("a-made-up", "b-renamed");
    change_logs(&folder, |header, result| {
        header["world"]["sha256"] = shipped.clone().into();
        result["world"]["sha256"] = shipped.clone().into();
    });
    place.enter("c-honest", "honest", 2);
    place.enter_in("mine.toml", "state", "d-own", "own", 3, |agent| agent);
    // Other times to compare with.
    let folder = place.copy("e-bound", "c-honest");
    change_logs(&folder, |_, result| {
        result["robot_time"] = serde_json::json!({"bound": 0.5, "reference": 999.5});
        result["agent"]["name"] = "flattered".into();
    });

    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(1), "{told}");
    let hash = sha256(&std::fs::read(place.path("fake.toml")).unwrap());
    for sentence in [
        "refused a-made-up: easy-1-state-1.mcap: the log is not the log of an episode: its world does not match its hash",
        &format!(
            "refused b-renamed: easy-1-state-1.json: world `real` was never shipped with the SHA-256 {}",
            &hash[..8]
        ),
        "admitted c-honest",
        "admitted d-own",
        "admitted e-bound",
    ] {
        assert!(told.contains(sentence), "{sentence}: {told}");
    }
    let board = place.page(&board_page());
    assert!(board.contains("honest 1.0") && !board.contains("renamed") && !board.contains("own 1.0"));
    assert!(
        board.contains(&shipped)
            && board.contains(&sha256(&std::fs::read(place.path("data/kit.xml")).unwrap()))
    );
    assert!(!board.contains("999.5"), "bound and reference are those of this program");
    assert!(place.page("index.html").contains("world mine ("));
}

fn an_entry_is_checked_as_the_board_does_it_and_packed() {
    let place = Place::new();
    place.enter("honest", "good", 1);
    let folder = place.copy("cut", "honest");
    let log = std::fs::read(folder.join("easy-1-state-2.mcap")).unwrap();
    std::fs::write(folder.join("easy-1-state-2.mcap"), &log[..log.len() / 2]).unwrap();
    let folder = place.copy("relabelled", "honest");
    for seed in 1..=5 {
        change(
            &folder.join(format!("easy-1-state-{seed}.json")),
            "\"track\": \"state\"",
            "\"track\": \"tags\"",
        );
    }
    let check = |words: &[&str]| {
        let output = place.ramp(&[&["--data", "data", "entry", "check"], words].concat());
        (output.status.code(), text(&output.stdout))
    };
    let (status, told) = check(&["entries/honest"]);
    assert_eq!(status, Some(0), "{told}");
    for words in ["good 1.0", "5 results, 0 of 5 pegs", "logs: 5 run again", "would be admitted"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    for (words, reason) in [
        (&["entries/cut"][..], "easy-1-state-2.mcap: the log is not a complete MCAP file: it ends too early"),
        (&["entries/relabelled"], "easy-1-state-1.json: the result differs from the one in its log"),
        (&["entries/honest", "--replay-limit", "0.001"], ".mcap: its replay was not done after 0.001 s"),
    ] {
        let (status, told) = check(words);
        assert_eq!(status, Some(1), "{told}");
        assert!(told.starts_with("would be refused: ") && told.contains(reason), "{reason}: {told}");
    }
    for words in [&["entries/nothing"][..], &["entries/honest", "--replay-limit", "0"]] {
        assert_eq!(check(words).0, Some(2), "{words:?}");
    }

    // Packed, it is one file; the board takes both.
    for words in
        [&["entries/honest", "-o", "out.zip"][..], &["data", "-o", "out.tar"], &["no", "-o", "out.tar"]]
    {
        let output = place.ramp(&[&["entry", "pack"], words].concat());
        assert_eq!(output.status.code(), Some(2), "{words:?}");
    }
    assert!(!place.path("out.tar").exists() && !place.path("out.zip").exists());
    place.done(&["entry", "pack", "entries/honest", "-o", "packed.tar"]);
    place.done(&["entry", "pack", "entries/honest", "-o", "again.tar"]);
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(read("packed.tar") == read("again.tar"), "equal files give equal archives");
    let (status, told) = check(&["packed.tar"]);
    assert_eq!((status, told.contains("would be admitted")), (Some(0), true), "{told}");
    for folder in ["honest", "cut", "relabelled"] {
        std::fs::remove_dir_all(place.path("entries").join(folder)).unwrap();
    }
    std::fs::rename(place.path("packed.tar"), place.path("entries/packed.tar")).unwrap();
    std::fs::write(place.path("entries/noise.tar"), [7; 2000]).unwrap();
    std::os::unix::fs::symlink("packed.tar", place.path("entries/link.tar")).unwrap();
    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(1), "{told}");
    for sentence in [
        "refused link: it in the archive is no ordinary file",
        "refused noise: the archive cannot be read: ",
        "admitted packed: good 1.0",
    ] {
        assert!(told.contains(sentence), "{sentence}: {told}");
    }
}

fn two_boards_into_one_site_keep_all_verdicts() {
    let place = Place::new();
    place.enter("a", "one", 1);
    std::fs::create_dir(place.path("others")).unwrap();
    place.enter("b", "two", 2);
    std::fs::rename(place.path("entries/b"), place.path("others/b")).unwrap();
    let start = |entries: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
        command.current_dir(&place.0).args(["--data", "data", "leaderboard", entries, "-o", "site"]);
        command.stdout(std::process::Stdio::null()).spawn().unwrap()
    };
    let mut boards = ["entries", "others"].map(start);
    assert!(boards.iter_mut().all(|board| board.wait().unwrap().success()));
    let verdicts: Value = serde_json::from_str(&place.page("replayed.json")).unwrap();
    assert_eq!(verdicts["logs"].as_object().unwrap().len(), 10);
}

fn a_board_has_the_baseline_as_its_control_row() {
    let place = Place::new();
    place.enter("a", "one", 1);
    let (_, told) = place.board(&[]);
    assert!(!place.page(&board_page()).contains("data-label=\"place\"><div>control</div>"), "{told}");
    let control = |more: &[&str]| {
        let words = [&["--data", "data", "leaderboard", "entries", "-o", "site"], more].concat();
        let output = place.ramp(&words);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let told = control(&["--control"]);
    assert!(told.contains("1 of 1 entries admitted"), "{told}");
    let board = place.page(&board_page());
    assert!(
        board.contains("data-label=\"place\"><div>control</div>") && board.contains(">baseline "),
        "{board}"
    );
    assert!(board.contains("5/5"), "the baseline builds two beams: {board}");
    assert!(
        board.contains("data-label=\"place\"><div>floor</div>") && board.contains(">blind-tape "),
        "{board}"
    );
    // Its results stay in the site, and the next board has the row without running it.
    let folder = place.path("site/control").join(board_page().replace("board-", "").replace(".html", ""));
    let result = folder.join("easy-1-state-1.json");
    let before = std::fs::metadata(&result).unwrap().modified().unwrap();
    let told = control(&["--control"]);
    assert!(told.contains("0 logs run again"), "{told}");
    control(&[]);
    assert_eq!(std::fs::metadata(&result).unwrap().modified().unwrap(), before);
    assert!(place.page(&board_page()).contains("data-label=\"place\"><div>control</div>"));
    // Damaged results are no row.
    std::fs::write(folder.join("easy-1-state-2.mcap"), "no log").unwrap();
    let told = control(&[]);
    assert!(told.contains("no control row on Class easy"), "{told}");
}

/// A board of 200 entries of which five are bad: `cargo test --release -p ramp-cli --test sandbox --
/// --ignored`. It takes minutes. With `RAMP_SITE=DIR` everything stays there, to be looked at.
fn a_board_of_two_hundred() {
    let mut place = Place::new();
    let number = |index: usize| format!("entry-{index:03}");
    let next = std::sync::atomic::AtomicUsize::new(6);
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    if index > 200 {
                        break;
                    }
                    place.enter(&number(index), &format!("agent-{index}"), index);
                }
            });
        }
    });
    let result = |folder: &Path, ending: &str| folder.join(format!("easy-1-state-1.{ending}"));
    for bad in 1..=5 {
        let folder = place.copy(&number(bad), &number(6 + bad));
        match bad {
            1 => std::fs::write(result(&folder, "mcap"), "no log").unwrap(),
            2 => std::fs::write(result(&folder, "json"), "{").unwrap(),
            3 => std::fs::remove_file(result(&folder, "mcap")).unwrap(),
            4 => std::fs::write(
                folder.join("easy-1-state-6.json"),
                std::fs::read(result(&folder, "json")).unwrap(),
            )
            .unwrap(),
            _ => change(&result(&folder, "json"), "\"planning\": 0.0", "\"planning\": 0.0001"),
        }
    }
    let (status, told) = place.board(&[]);
    assert_eq!(status, Some(1), "{told}");
    assert!(told.contains("195 of 200 entries admitted; 975 logs run again"), "{told}");
    assert_eq!(told.matches("refused ").count(), 5, "{told}");
    let (_, told) = place.board(&[]);
    assert!(told.contains("0 logs run again, 975 known from before"), "{told}");
    let last = board_page().replace(".html", "-4.html");
    for page in ["index.html", &board_page(), &last, "refused.html"] {
        assert!(place.page(page).len() < 1 << 20, "{page}");
    }
    if let Some(folder) = std::env::var_os("RAMP_SITE") {
        place.0.disable_cleanup(true);
        std::fs::rename(place.0.path(), folder).unwrap();
    }
}

/// The checks of this file.
pub fn checks() -> Vec<Trial> {
    vec![
        check(
            "bad_entries_are_told_and_the_others_are_on_the_board",
            bad_entries_are_told_and_the_others_are_on_the_board,
        ),
        check(
            "a_site_is_written_when_all_are_refused_and_none_into_the_entries",
            a_site_is_written_when_all_are_refused_and_none_into_the_entries,
        ),
        check(
            "a_world_under_a_shipped_name_is_not_on_its_board",
            a_world_under_a_shipped_name_is_not_on_its_board,
        ),
        check(
            "an_entry_is_checked_as_the_board_does_it_and_packed",
            an_entry_is_checked_as_the_board_does_it_and_packed,
        ),
        check("two_boards_into_one_site_keep_all_verdicts", two_boards_into_one_site_keep_all_verdicts),
        check("a_board_has_the_baseline_as_its_control_row", a_board_has_the_baseline_as_its_control_row),
        check_unless("agents_are_run_again_for_their_times", missing, agents_are_run_again_for_their_times),
        check("a_board_of_two_hundred", a_board_of_two_hundred).with_ignored_flag(true),
    ]
}
