//! A leaderboard admits results that match their log, made with the organiser's goal, parts and
//! start.

use ramp_log::{Log, SecretSeed};
use ramp_report::leaderboard::{BoardArm, BoardGoal, BoardTerms, Key, Refused, check_log, check_whole};
use ramp_result::collection::{ResultFile, collect};
use ramp_result::secret::Secret;
use ramp_testing::episode::Swing;
use ramp_testing::{GoalFiles, data};
use ramp_twin::Start;

#[test]
fn what_was_changed_afterwards_or_made_with_other_goals_is_refused() {
    let folder = tempfile::TempDir::new().unwrap();
    let world = GoalFiles::new("easy-1");
    let result = world.record_noisy(&mut Swing(300), &folder.path().join("it.mcap"));
    std::fs::write(folder.path().join("it.json"), result.to_json()).unwrap();
    let log = Log::read(&folder.path().join("it.mcap")).unwrap();
    let collection = collect(&[folder.path().to_path_buf()]).unwrap();
    let read = |name: &str| std::fs::read_to_string(data().join(name)).unwrap();
    let goal = BoardGoal {
        name: "easy-1".into(),
        class: Some("easy".into()),
        pegs: 3,
        xml: read("goals/easy-1.xml"),
    };
    let terms = BoardTerms {
        goals: vec![goal],
        kit: read("kit.xml"),
        arms: vec![BoardArm { name: "panda".to_string(), json: read("arms/panda.json") }],
        starts: vec![Start::sheet().text.clone()],
        secret: None,
    };
    let file = &collection.entrants[0].files[0];
    assert_eq!(check_log(file, &log.facts(), &terms), Ok(()));

    // Seeds of another secret, of none, or not derived from the secret.
    let secret = Secret::new([7; 32]);
    let sealed = BoardTerms { secret: Some(secret.clone()), ..terms.clone() };
    assert!(matches!(check_log(file, &log.facts(), &sealed), Err(Refused::Seed { .. })));
    let mut with_secret = log.clone();
    let mut file_with_secret = file.clone();
    let seed = secret.seed(&log.header.goal.name, &log.header.track, log.header.seed);
    with_secret.header.secret = Some(SecretSeed { commitment: secret.commitment(), seed });
    with_secret.result.secret = Some(secret.commitment());
    file_with_secret.result.secret = Some(secret.commitment());
    assert_eq!(check_log(&file_with_secret, &with_secret.facts(), &sealed), Ok(()));
    assert!(matches!(check_log(&file_with_secret, &with_secret.facts(), &terms), Err(Refused::Seed { .. })));
    let other = BoardTerms { secret: Some(Secret::new([8; 32])), ..terms.clone() };
    assert!(matches!(check_log(&file_with_secret, &with_secret.facts(), &other), Err(Refused::Seed { .. })));
    with_secret.header.secret = Some(SecretSeed { commitment: secret.commitment(), seed: seed + 1 });
    let error = check_log(&file_with_secret, &with_secret.facts(), &sealed).unwrap_err();
    assert!(matches!(error, Refused::Other { what: "seed of the world", .. }), "{error}");
    // One episode is not a class.
    assert!(matches!(check_whole(&collection, &terms), Err(Refused::Part { .. })));

    // Wrong class, or fewer pegs to count.
    let mut elsewhere = collection.clone();
    elsewhere.entrants[0].files[0].result.class = Some("hard".into());
    assert!(matches!(check_whole(&elsewhere, &terms), Err(Refused::Goal { .. })));
    let mut fewer = collection.clone();
    fewer.entrants[0].files[0].result.pegs.pop();
    assert!(matches!(check_whole(&fewer, &terms), Err(Refused::Goal { .. })));

    // A file of one's own under a shipped name, though all hashes are those of its text; the same file under
    // its own name; a log of another world than the result.
    let mut own = log.clone();
    let mut file_of_own = file.clone();
    let hash = ramp_result::sha256(b"another text");
    (own.header.world.toml, own.header.world.sha256) = ("another text".into(), hash.clone());
    for result in [&mut own.result, &mut file_of_own.result] {
        result.world.as_mut().unwrap().sha256 = hash.clone();
    }
    let error = check_log(&file_of_own, &own.facts(), &terms).unwrap_err();
    assert!(error.to_string().contains("world `ideal` was never shipped with the SHA-256 "), "{error}");
    own.header.world.name = "mine".into();
    for result in [&mut own.result, &mut file_of_own.result] {
        result.world.as_mut().unwrap().name = "mine".into();
    }
    assert_eq!(check_log(&file_of_own, &own.facts(), &terms), Ok(()));
    assert!(matches!(check_log(file, &own.facts(), &terms), Err(Refused::NotOfLog { .. })));
    // Two versions of one world are two boards.
    assert_ne!(Key::of(&file.result), Key::of(&file_of_own.result));
    let mut version = file.result.clone();
    version.world.as_mut().unwrap().sha256 = hash;
    assert_ne!(Key::of(&file.result), Key::of(&version));
    assert_ne!(Key::of(&file.result).slug(), Key::of(&version).slug());

    // Better than in the log, by one digit.
    let mut better = file.clone();
    better.result.time.planning -= 1e-9;
    assert!(matches!(check_log(&better, &log.facts(), &terms), Err(Refused::NotOfLog { .. })));
    // A different goal with that name, and an unknown goal.
    let mut other = terms.clone();
    other.goals[0].xml.push('\n');
    assert!(matches!(check_log(file, &log.facts(), &other), Err(Refused::Goal { .. })));
    other.goals.clear();
    assert!(matches!(check_log(file, &log.facts(), &other), Err(Refused::Goal { .. })));
    assert!(matches!(check_whole(&collection, &other), Err(Refused::Goal { .. })));
    another_arm_is_refused(file, &log, &terms);
    // Another kit, and another start.
    let mut other = terms.clone();
    other.kit = other.kit.replacen("joint", "Joint", 1);
    assert!(matches!(check_log(file, &log.facts(), &other), Err(Refused::Other { what: "kit", .. })));
    let other = BoardTerms { starts: vec![Start::moved().text.clone()], ..terms };
    assert!(matches!(check_log(file, &log.facts(), &other), Err(Refused::Other { .. })));
}

/// Another arm: not the organiser's, or not the one that the result names.
fn another_arm_is_refused(file: &ResultFile, log: &Log, terms: &BoardTerms) {
    let mut other = terms.clone();
    other.arms[0].json.push('\n');
    assert!(matches!(check_log(file, &log.facts(), &other), Err(Refused::Other { what: "arm", .. })));
    let (mut other, mut other_log) = (file.clone(), log.clone());
    for result in [&mut other.result, &mut other_log.result] {
        result.arm = Some("fr3".into());
    }
    assert!(matches!(check_log(&other, &other_log.facts(), terms), Err(Refused::NotOfLog { .. })));
    assert_ne!(Key::of(&file.result), Key::of(&other.result));
    assert_ne!(Key::of(&file.result).slug(), Key::of(&other.result).slug());
}
