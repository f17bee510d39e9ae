//! What a page says to a reader who was not there.

use ramp_report::leaderboard::{Boards, pages, standings};
use ramp_report::{Report, page};
use ramp_result::collection::{Collection, collect};
use ramp_result::episode::{EpisodeResult, RealRun, RobotKind, StartInfo, WorldInfo};
use ramp_result::testing::episode;
use ramp_twin::{Start, World};

/// An episode in the twin with the Panda, in the world `real`.
fn in_the_twin(agent: &str, track: &str, seed: u64) -> EpisodeResult {
    let mut result = episode("easy-1", seed, &[20.0, 40.0], 3);
    let (world, start) = (World::shipped("real").unwrap(), Start::moved());
    result.arm = Some("panda".into());
    result.world = Some(WorldInfo::of(world, seed));
    result.start = Some(StartInfo::of(start));
    (result.agent.name, result.track) = (agent.into(), track.into());
    result
}

/// Results of two agents in the twin, and of a real robot.
fn results() -> Collection {
    let folder = tempfile::TempDir::new().unwrap();
    let mut real = episode("easy-1", 1, &[60.0, 90.0, 120.0], 3);
    real.physics = None;
    real.track = "tags".into();
    real.real = Some(RealRun {
        robot: "Franka Research 3".into(),
        scorer: "A. Person".into(),
        source: "made up".into(),
        kind: RobotKind::Arm,
    });
    let mut all = vec![real];
    for seed in 1..=5 {
        all.push(in_the_twin("baseline", "tags", seed));
        all.push(in_the_twin("baseline", "state", seed));
    }
    all.push(in_the_twin("other", "state", 1));
    let mut hasty = in_the_twin("hasty", "state", 1);
    hasty.agent.asynchronous = true;
    all.push(hasty);
    let mut other_arm = in_the_twin("baseline", "state", 1);
    other_arm.arm = Some("fr3".into());
    all.push(other_arm);
    for (index, result) in all.iter().enumerate() {
        std::fs::write(folder.path().join(format!("{index}.json")), result.to_json()).unwrap();
    }
    collect(&[folder.path().to_path_buf()]).unwrap()
}

#[test]
fn a_real_robot_and_the_world_real_have_headings_that_say_so() {
    let report = Report::new(results());
    let titles: Vec<String> = report.tracks.iter().map(|part| part.title()).collect();
    assert_eq!(
        titles,
        [
            "state, twin, arm fr3, world real, start moved",
            "state, twin, arm panda, world real, start moved",
            "state, twin, arm panda, world real, start moved, async",
            "tags, twin, arm panda, world real, start moved",
            "tags, real robot"
        ]
    );
    let html = page::html(&report);
    for title in titles {
        assert!(html.contains(&format!("<h2>Easy, track {title}</h2>")), "{title}");
    }
    let mut boards = Boards::default();
    for (key, standing) in standings("entry", "agent", &report.collection, page::agent_page, |_| false) {
        boards.add(key, standing);
    }
    let front = pages::pages(&boards, &[], &|_| Vec::new()).pop().unwrap().1;
    assert!(front.contains("Class easy, track tags, real robot<"), "{front}");
    assert!(front.contains("Class easy, track tags, twin, arm panda, world real ("), "{front}");
    assert!(front.contains("Class easy, track state, twin, arm fr3, world real ("), "{front}");
    assert!(front.contains("), async<"), "{front}");
}

#[test]
fn each_agent_has_one_colour_on_all_tracks() {
    let report = Report::new(results());
    let entrants = report.collection.entrants.iter();
    let colours: Vec<(&str, &str, Option<usize>)> = entrants
        .enumerate()
        .map(|(index, it)| (it.identity.agent.as_str(), it.identity.track.as_str(), report.place(index)))
        .collect();
    let of = |agent: &str| {
        let mut places: Vec<_> = colours.iter().filter(|it| it.0 == agent).map(|it| it.2.unwrap()).collect();
        places.dedup();
        assert_eq!(places.len(), 1, "{colours:?}");
        places[0]
    };
    let places = [of("baseline"), of("other"), of("hasty"), of("hand")];
    assert!((0..4).all(|place| places.contains(&place)), "{colours:?}");
}

#[test]
fn counts_are_not_percentages_and_one_is_singular() {
    let report = Report::new(results());
    let html = page::html(&report);
    assert!(html.contains("data-label=\"complete, episodes\"><div>0 of 5<small>0.0 % to"), "{html}");
    assert!(!html.contains("1 episodes") && html.contains(", 1 episode<"), "{html}");
    let note = |words: &str| assert!(report.notes.iter().any(|it| it.ends_with(words)), "{:?}", report.notes);
    note("other on track state: easy-1 was run with seed 1, the protocol asks for seeds 1 to 5");
    note("hand on track tags: easy-1 was run with repeat 1, the protocol asks for repeats 1 to 5");
}

/// Two sets of the open class are two classes: no board, no line and no note puts them together.
#[test]
fn sets_of_the_open_class_are_never_mixed_and_come_first() {
    let folder = tempfile::TempDir::new().unwrap();
    let goals = [
        ("easy-1", "easy"),
        ("open-2026-small-01", "open-2026"),
        ("open-2026-large-02", "open-2026"),
        ("open-held-0a1b2c3d-small-01", "open-held-0a1b2c3d"),
        ("open-7-small-01", "open-7"),
    ];
    for (goal, class) in goals {
        let mut result = in_the_twin("baseline", "state", 1);
        (result.goal, result.class) = (goal.into(), Some(class.into()));
        std::fs::write(folder.path().join(format!("{goal}.json")), result.to_json()).unwrap();
    }
    let report = Report::new(collect(&[folder.path().to_path_buf()]).unwrap());
    let mut boards = Boards::default();
    for (key, standing) in standings("entry", "agent", &report.collection, page::agent_page, |_| false) {
        boards.add(key, standing);
    }
    let classes: Vec<&str> =
        boards.boards().iter().map(|board| board.key.class.as_deref().unwrap()).collect();
    assert_eq!(classes, ["open-7", "open-2026", "open-held-0a1b2c3d", "easy"]);
    let counts: Vec<usize> =
        boards.boards().iter().map(|board| board.standings[0].line.summary.episodes).collect();
    assert_eq!(counts, [1, 2, 1, 1]);

    let sizes: Vec<(String, usize)> = report.tracks[0]
        .classes
        .iter()
        .flat_map(|class| class.size_lines.iter().map(|it| (class.name_of(it), it.summary.episodes)))
        .collect();
    let expected = ["open-7, small", "open-2026, small", "open-2026, large", "open-held-0a1b2c3d, small"];
    assert_eq!(sizes, expected.map(|name| (name.to_string(), 1)));
    // One episode of each goal is what the protocol asks for.
    assert_eq!(report.notes.iter().filter(|it| it.contains("the protocol asks for")).count(), 1);
    assert!(report.notes.iter().any(|it| it.contains("easy-1 was run with seed 1")));
}
