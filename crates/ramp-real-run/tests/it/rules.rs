//! The worked examples of `docs/src/reference/rules.md`, read from the page and judged by the real referee.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_assembly::{Assembly, Penetration, Truth};
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::source::SourceFile;
use ramp_kit::{Kit, Pose};
use ramp_real_run::stopwatch::{Log, Reader};
use ramp_referee::Referee;
use ramp_result::episode::{RULES, Software};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page() -> String {
    std::fs::read_to_string(root().join("docs/src/reference/rules.md")).unwrap()
}

/// Name and verdict of each row of the page's table number `index`.
fn examples(index: usize) -> Vec<(String, String)> {
    let page = page();
    let table = page.split("| example |").nth(index + 1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        (cells[0].trim_matches('`').to_string(), cells[2].to_string())
    })
    .collect()
}

struct Table {
    kit: Kit,
    goal: Assembly,
}

/// The true poses at one time.
struct Scene {
    time: f64,
    /// The peg and the position of its head's underside, in the world.
    pegs: Vec<(&'static str, Pose)>,
    /// Displacement of both beams from their goal poses.
    moved: Pose,
    /// Additional displacement of the male.
    male: Pose,
    /// Depth of p1 in the female, and of the male in the female, m.
    depths: [f64; 2],
    /// Whether the arm is gone.
    rested: bool,
}

fn up(x: f64, z: f64) -> Pose {
    Pose::translation(x, 0.0, z)
}

impl Table {
    fn new() -> Table {
        let kit = ramp_kit::read_kit(&root().join("data/kit.xml")).unwrap();
        let goal = ramp_assembly::read_goal(&root().join("data/goals/easy-1.xml"), &kit).unwrap();
        Table { kit, goal }
    }

    /// The middle of the female's top plate over a joint of b7, in the assembly frame.
    fn plate(&self, joint: usize) -> Pose {
        let placed = &self.goal.beams[self.goal.connections[0].female.beam];
        let hole = placed.x_ab * placed.beam.p_b_hole(joint);
        Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0)
    }

    /// The verdict on C1 after some scenes: the total time since which its peg counts.
    fn judge(&self, scenes: &[Scene], thought: f64) -> Option<f64> {
        let beams = self.goal.beams.iter().map(|placed| placed.beam.name.as_str());
        let names: Vec<&str> = beams.chain(self.kit.pegs.iter().map(|peg| peg.name.as_str())).collect();
        let mut referee = Referee::new(&self.goal, names.iter().copied());
        let connection = &self.goal.connections[0];
        for scene in scenes {
            let beams = self.goal.beams.iter().enumerate().map(|(index, placed)| {
                let male = if index == connection.male.beam { scene.male } else { Pose::identity() };
                male * scene.moved * placed.x_ab
            });
            let pegs = self.kit.pegs.iter().map(|peg| {
                let here = scene.pegs.iter().find(|(name, _)| *name == peg.name);
                here.map_or(Pose::translation(5.0, 5.0, 0.0), |(_, x)| *x)
            });
            let truth = Truth { time: scene.time, x_wp: beams.chain(pegs).collect() };
            let [female, male] = [connection.female, connection.male].map(|joint| joint.beam);
            let p1 = names.iter().position(|name| *name == "p1").unwrap();
            let penetrations = [[p1, female], [male, female]].into_iter().zip(scene.depths);
            let penetrations: Vec<_> =
                penetrations.map(|(parts, depth)| Penetration { parts, depth }).collect();
            if scene.rested {
                referee.rested(&truth, &penetrations);
            } else {
                referee.penetrated(&truth, &penetrations);
                referee.watch(&truth, thought);
            }
        }
        // The peg in this connection pins no other.
        assert!(referee.verdict()[1..].iter().all(Option::is_none));
        referee.verdict()[0].as_ref().map(|seated| seated.since + seated.thought)
    }

    fn example(&self, name: &str) -> Option<f64> {
        let female = self.goal.connections[0].female.joint;
        let plate = self.plate(female);
        let home = plate;
        let scene = |time: f64, pegs: Vec<(&'static str, Pose)>| Scene {
            time,
            pegs,
            moved: Pose::identity(),
            male: Pose::identity(),
            depths: [0.0; 2],
            rested: false,
        };
        let p1 = |x: Pose| vec![scene(10.0, vec![("p1", x)]), scene(40.0, vec![("p1", x)])];
        let turn = |axis, angle| {
            let turn = UnitQuaternion::from_axis_angle(&axis, angle);
            Pose::from_parts(Translation3::identity(), turn)
        };
        let both = |moved: Pose| {
            let mut scenes = p1(moved * home);
            scenes.iter_mut().for_each(|scene| scene.moved = moved);
            scenes
        };
        let mut thought = 0.0;
        let scenes = match name {
            "seated" => p1(home),
            "within" => p1(up(0.0, 0.49e-3) * home),
            "not-flush" => p1(up(0.0, 0.51e-3) * home),
            "sunk" => p1(up(0.0, -0.51e-3) * home),
            "at-the-rim" => p1(up(4.1e-3, 0.0) * home),
            "beside" => p1(up(4.3e-3, 0.0) * home),
            "tilted" => p1(home * turn(Vector3::y_axis(), 10.0_f64.to_radians())),
            "no-male" => {
                let mut scenes = p1(home);
                scenes.iter_mut().for_each(|scene| scene.male = up(5e-3, 0.0));
                scenes
            }
            "other-hole" => p1(self.plate(female + 1)),
            "lying" => p1(home * turn(Vector3::x_axis(), PI / 2.0)),
            "upside-down" => p1(home * turn(Vector3::x_axis(), PI)),
            "turned-over" => {
                // Rotated about the long axis of b7 through its holes, so that the lower plate is
                // on top.
                let axis = home * Pose::translation(0.0, 0.0, -FEMALE_HEIGHT / 2.0);
                let over = axis * turn(Vector3::x_axis(), PI) * axis.inverse();
                let mut scenes = p1(home);
                scenes.iter_mut().for_each(|scene| scene.moved = over);
                scenes
            }
            "any-peg" => vec![scene(10.0, vec![("p9", home)]), scene(40.0, vec![("p9", home)])],
            "moved" => both(Pose::translation(0.05, 0.02, 0.0)),
            "came-out" => vec![
                scene(10.0, vec![("p1", home)]),
                scene(20.0, vec![("p1", up(0.0, 0.02) * home)]),
                scene(40.0, vec![("p1", up(0.0, 0.02) * home)]),
            ],
            "came-back" => vec![
                scene(10.0, vec![("p1", home)]),
                scene(20.0, vec![("p1", up(0.0, 0.02) * home)]),
                scene(30.0, vec![("p1", home)]),
                scene(40.0, vec![("p1", home)]),
            ],
            "changed" => vec![
                scene(10.0, vec![("p1", home)]),
                scene(30.0, vec![("p2", home)]),
                scene(40.0, vec![("p2", home)]),
            ],
            "too-late" => vec![scene(30.0, vec![]), scene(40.0, vec![("p1", home)])],
            "forced" | "pressed" | "beams-forced" => {
                let mut scenes = p1(home);
                scenes[0].depths = match name {
                    "forced" => [1.6e-3, 0.0],
                    "pressed" => [1.4e-3, 0.0],
                    _ => [0.0, 1.6e-3],
                };
                scenes
            }
            "redone" => {
                let mut scenes = vec![
                    scene(10.0, vec![("p1", home)]),
                    scene(20.0, vec![("p1", up(0.0, 0.07) * home)]),
                    scene(30.0, vec![("p1", home)]),
                ];
                scenes[0].depths = [1.6e-3, 0.0];
                scenes
            }
            "falls" | "stands" => {
                let [end, rest] = if name == "falls" { [0.0, 1e-3] } else { [0.4e-3, 0.0] };
                let mut scenes = p1(up(0.0, end) * home);
                scenes.push(scene(40.0, vec![("p1", up(0.0, rest) * home)]));
                scenes[2].rested = true;
                scenes
            }
            "thinking" => {
                thought = 5.0;
                p1(home)
            }
            other => panic!("the example `{other}` of the page has no test"),
        };
        self.judge(&scenes, thought)
    }
}

#[test]
fn the_referee_judges_the_examples_as_the_page_says() {
    let table = Table::new();
    let examples = examples(0);
    assert_eq!(examples.len(), 25);
    for (name, verdict) in examples {
        let expected = match verdict.strip_prefix("counts since ") {
            Some(time) => Some(time.trim_end_matches(" s").parse::<f64>().unwrap()),
            None => {
                assert_eq!(verdict, "does not count", "{name}");
                None
            }
        };
        assert_eq!(table.example(&name), expected, "{name}");
    }
}

/// A person's lines for an example.
fn log_lines(name: &str) -> &'static str {
    match name {
        "touched" => "C1,60,p1\ntouch,90",
        "caught" => "C1,60,p1\ntouch,70,,caught p2\nC2,90,p2\nend,95",
        "dropped" => "C1,60,p1\nfault,80,,p2 dropped\nC2,120,p3\nend,130",
        "knocked-out" => "C1,60,p1\nout C1,90\nC2,120,p2\nend,130",
        "half-an-hour" => "C1,1811,p1\nend,1811",
        "backwards" => "C1,60,p1\nC2,50,p2\nend,95",
        "one-peg-twice" => "C1,60,p1\nC2,90,p1\nend,95",
        "no-end" => "C1,60,p1",
        other => panic!("the example `{other}` of the page has no test"),
    }
}

#[test]
fn stopwatch_logs_are_scored_as_the_page_says() {
    let Table { kit, goal } = Table::new();
    let goals = [goal];
    let software = Software { version: "test".into(), commit: "test".into() };
    let examples = examples(1);
    assert_eq!(examples.len(), 8);
    for (name, verdict) in examples {
        let mut text = format!(
            "log,ramp-stopwatch-1\nrules,{RULES}\nagent,a\nversion,1\ntrack,tags\nrobot,r\ncomputer,c\ncores,1\n\
             scorer,s\nsource,s\n\ngoal,repeat,what,time,peg,note\neasy-1,1,planning,10\n"
        );
        for line in log_lines(&name).lines() {
            text.push_str(&format!("easy-1,1,{line}\n"));
        }
        let file = SourceFile::new("log.csv", &text);
        let log = Reader { file: &file, kit: &kit, goals: &goals, software: &software }.read();
        let said = match log {
            Ok(Log::Episodes(results)) => {
                format!("{} of {}", results[0].counted(), results[0].pegs.len())
            }
            Ok(Log::Means(_)) => "means".to_string(),
            Err(_) => "refused".to_string(),
        };
        assert_eq!(said, verdict, "{name}");
    }
}

#[test]
fn the_page_is_of_the_version_that_results_name() {
    assert!(page().contains(&format!("Version `{RULES}`")));
}

/// Two pairs of beams with their holes in one place, and one peg through all: it counts for the connection
/// for which it counted before, and for no other.
#[test]
fn a_peg_counts_for_one_connection() {
    let kit = ramp_kit::read_kit(&root().join("data/kit.xml")).unwrap();
    let goal = ramp_assembly::read_goal(&root().join("data/goals/medium-1.xml"), &kit).unwrap();
    let names: Vec<&str> = goal.beams.iter().map(|it| it.beam.name.as_str()).chain(["p1", "p2"]).collect();
    // C1 and C4 share no beam. `together` puts both beams of one to the same place as those of the other.
    let (first, last) = (&goal.connections[0], &goal.connections[3]);
    let truth = |time: f64, pinned: &[usize], peg: usize| {
        let away = |index: usize| Pose::translation(2.0 + index as f64, 2.0, 0.0);
        let mut x_wp: Vec<Pose> = (0..names.len()).map(away).collect();
        for connection in pinned.iter().map(|index| [first, last][*index]) {
            for joint in [connection.female, connection.male] {
                let hole = goal.beams[joint.beam].beam.p_b_hole(joint.joint);
                x_wp[joint.beam] = Pose::translation(-hole.x, -hole.y, -hole.z);
            }
        }
        x_wp[peg] = Pose::translation(0.0, 0.0, FEMALE_HEIGHT / 2.0);
        Truth { time, x_wp }
    };
    let p1 = names.len() - 2;
    let counted = |referee: &Referee| {
        let counted = referee.verdict().iter().enumerate().filter(|(_, seated)| seated.is_some());
        counted.map(|(index, _)| index).collect::<Vec<_>>()
    };
    let mut referee = Referee::new(&goal, names.iter().copied());
    referee.watch(&truth(1.0, &[0, 1], p1), 0.0);
    assert_eq!(counted(&referee), [0]);
    let mut referee = Referee::new(&goal, names.iter().copied());
    referee.watch(&truth(1.0, &[1], p1), 0.0);
    referee.watch(&truth(2.0, &[0, 1], p1), 0.0);
    assert_eq!(counted(&referee), [3]);
    referee.rested(&truth(2.0, &[0, 1], p1), &[]);
    assert_eq!(counted(&referee), [3]);
}

/// A peg whose tip misses the outer opening of the lower plate does not count, though it passes the inner
/// one.
#[test]
fn the_axis_passes_all_openings_of_a_hole() {
    // 33.2 mm below the head, where the outer opening is, the axis is 4.3 mm aside; at the inner one, 3.9 mm.
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), (4.3e-3_f64 / FEMALE_HEIGHT).atan());
    let plate = Translation3::new(0.0, 0.0, FEMALE_HEIGHT / 2.0);
    let here = nalgebra::Point3::origin();
    let judged = |x_peg: Pose| ramp_referee::pins(&x_peg, &Pose::identity(), &here, &Pose::identity(), &here);
    assert!(judged(Pose::from_parts(plate, UnitQuaternion::identity())));
    assert!(!judged(Pose::from_parts(plate, tilt)));
}

/// The sources of all crates, read: files that may hold tests.
fn sources() -> String {
    let mut text = String::new();
    let mut folders = vec![root().join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                text.push_str(&std::fs::read_to_string(&path).unwrap());
            }
        }
    }
    text
}

/// Every numbered rule has its line in the table of tests, and the tests are there.
#[test]
fn each_rule_names_tests_that_exist() {
    let page = page();
    let numbered = page.lines().filter_map(|line| line.split_once(". ")?.0.parse::<u32>().ok());
    let rules: Vec<u32> = numbered.collect();
    assert_eq!(rules, (1..=23).collect::<Vec<u32>>());
    let table = page.split("| rule | tests |").nth(1).unwrap();
    let mut told = Vec::new();
    let sources = sources();
    for line in table.lines().skip(2).take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        told.push(cells[0].parse::<u32>().unwrap());
        for name in cells[1].split(", ").map(|name| name.trim_matches('`')) {
            assert!(sources.contains(&format!("fn {name}() {{")), "rule {}: no test {name}", cells[0]);
        }
    }
    assert_eq!(told, rules);
}
