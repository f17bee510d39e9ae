//! Episodes that begin in a given state.

use ramp_episode::{GivenError, check_given, replay};
use std::collections::BTreeMap;

use ramp_kit::Holder;
use ramp_kit::Pose;
use ramp_kit::source::SourceFile;
use ramp_log::Log;
use ramp_robot::Track;
use ramp_skills::survey;
use ramp_testing::GoalFiles;
use ramp_testing::episode::Swing;
use ramp_twin::{GivenState, Setup, Start, Twin, World};

fn state(goal: &GoalFiles, text: &str) -> GivenState {
    GivenState::from_source(&SourceFile::new("state.json", text), &goal.assembly).unwrap()
}

/// The state file of a goal that is built.
fn built(goal: &GoalFiles) -> String {
    let assembly = &goal.assembly;
    let beams = assembly.beams.iter().map(|placed| placed.beam.name.as_str());
    let beams: Vec<_> = beams.filter(|name| *name != assembly.beams[assembly.base].beam.name).collect();
    let pegs = assembly.connections.iter().zip(&assembly.kit.pegs);
    let pegs: Vec<_> = pegs.map(|(connection, peg)| [&connection.name, &peg.name]).collect();
    serde_json::json!({"in_assembly": beams, "fastened": pegs}).to_string()
}

/// A peg that is not in its hole, or a frame that moves by itself, would be seen by the referee.
#[test]
fn a_built_frame_stands_and_its_log_repeats_it() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    for (goal, world, start) in [
        ("easy-1", World::ideal(), Start::sheet()),
        ("hard-1", World::shipped("real").unwrap(), Start::moved()),
    ] {
        let goal = GoalFiles::new(goal);
        let state = state(&goal, &built(&goal));
        let setup = Setup { state: Some(&state), world, start, ..goal.setup(Track::State, 1) };
        check_given(&setup).unwrap();
        let result = goal.record(&setup, &mut Swing(100), &path);
        assert_eq!((result.completion, result.counted()), (1.0, goal.assembly.connections.len()));
        assert_eq!(result.state.as_ref().unwrap().json, state.text);

        let log = Log::read(&path).unwrap();
        let replayed = replay(&log).unwrap();
        assert!(replayed.is_equal(), "{:?}", replayed.differences);
        let mut other = log.clone();
        other.header.state = None;
        assert!(replay(&other).unwrap_err().to_string().contains("its state is none"));
        let mut unbuilt = other;
        unbuilt.result.state = None;
        assert!(!replay(&unbuilt).unwrap().is_equal());
    }
}

/// Only the named parts are elsewhere than the start draws them.
#[test]
fn parts_begin_in_their_poses() {
    let goal = GoalFiles::new("easy-1");
    let setup = Setup { start: Start::moved(), ..goal.setup(Track::State, 1) };
    let text = r#"{"poses": {"b4": {"position": [0.45, 0.3, 0.1], "yaw": 0.5},
        "p1": {"position": [0.2, 0.5, 0.1], "quat_wxyz": [0.6, 0.8, 0, 0]}}}"#;
    let state = state(&goal, text);
    assert_eq!(state.parts().collect::<Vec<_>>(), ["b4", "p1"]);
    let with_state = Setup { state: Some(&state), ..setup.clone() };
    check_given(&with_state).unwrap();
    let poses = |setup: &Setup| -> Vec<(String, Pose)> {
        let twin = Twin::new(setup).unwrap();
        twin.part_names().map(str::to_string).zip(twin.truth().x_wp).collect()
    };
    for ((name, drawn), (_, found)) in poses(&setup).into_iter().zip(poses(&with_state)) {
        let p = found.translation.vector;
        match name.as_str() {
            "b4" => assert!((p - nalgebra::Vector3::new(0.45, 0.3, 0.1)).norm() < 1e-9, "{p}"),
            "p1" => assert!((found.rotation.scalar() - 0.6).abs() < 1e-9, "{found}"),
            _ => assert_eq!(drawn, found, "{name}"),
        }
    }
}

#[test]
fn parts_that_are_in_each_other_or_in_the_table_are_refused() {
    let goal = GoalFiles::new("easy-1");
    let refused = |text: &str| {
        let state = state(&goal, text);
        let setup = Setup { state: Some(&state), ..goal.setup(Track::State, 1) };
        let GivenError::Penetration { parts, depth } = check_given(&setup).unwrap_err() else { panic!() };
        (parts, depth)
    };
    // A little too low on the table, where nothing else is.
    let (parts, depth) = refused(r#"{"poses": {"b4": {"position": [0.3, -0.55, 0.003], "yaw": 0}}}"#);
    assert!(parts.contains(&"b4".to_string()) && parts.contains(&"the table".to_string()), "{parts:?}");
    assert!(depth > 0.0015, "{depth}");
    // In the place of another beam.
    let kit = &goal.assembly.kit;
    let placed = &goal.assembly.beams[goal.assembly.base];
    let p = (kit.x_wa() * placed.x_ab).translation.vector;
    let [x, y, z] = [p.x, p.y, p.z];
    let text = format!(r#"{{"poses": {{"b4": {{"position": [{x}, {y}, {z}], "yaw": -1.5708}}}}}}"#);
    let (parts, _) = refused(&text);
    assert!(parts.contains(&"b4".to_string()) && parts.contains(&placed.beam.name), "{parts:?}");
}

/// The baseline is not told that a part of the frame stands: it sees it, and builds the rest.
#[test]
fn a_frame_that_stands_in_part_is_completed() {
    let goal = GoalFiles::new("easy-3");
    let state = state(&goal, r#"{"in_assembly": ["b4", "b5"], "fastened": [["C1", "p1"]]}"#);
    let setup = Setup { state: Some(&state), ..goal.setup(Track::State, 3) };
    let result = goal.run_setup(&setup);
    assert_eq!(result.completion, 1.0, "{:?}", result.events);
    // It fetches what is missing, and takes nothing out.
    let fetched = |part: &str| {
        result.events.iter().any(|event| event.kind.to_string().contains(&format!("pick up {part} ")))
    };
    assert_eq!(["b4", "b5", "p1", "b8"].map(fetched), [false, false, false, true]);
}

/// Poses of the built easy-3 in W, as a state file that the change may spoil.
fn spoilt(
    goal: &GoalFiles,
    change: impl FnOnce(&mut serde_json::Map<String, serde_json::Value>),
) -> GivenState {
    let assembly = &goal.assembly;
    let pose = |x: &Pose| {
        let q = x.rotation;
        serde_json::json!({"position": x.translation.vector.as_slice(), "quat_wxyz": [q.w, q.i, q.j, q.k]})
    };
    let mut poses = serde_json::Map::new();
    let loose = assembly.beams.iter().enumerate().filter(|(index, _)| *index != assembly.base);
    for (_, placed) in loose {
        poses.insert(placed.beam.name.clone(), pose(&(assembly.kit.x_wa() * placed.x_ab)));
    }
    for (connection, peg) in assembly.connections.iter().zip(assembly.built_with()) {
        let hole = assembly.kit.x_wa() * assembly.p_a_hole(connection.female);
        let plate = Pose::translation(hole.x, hole.y, hole.z + ramp_kit::joint::FEMALE_HEIGHT / 2.0);
        poses.insert(peg.to_string(), pose(&plate));
    }
    change(&mut poses);
    state(goal, &serde_json::json!({"poses": poses}).to_string())
}

/// A frame that stands wrong is set right: beams in each other's places are taken out with all that holds
/// them, and a peg comes out of a hole that pins nothing.
#[test]
fn a_frame_that_stands_wrong_is_repaired() {
    let goal = GoalFiles::new("easy-3");
    let swapped = spoilt(&goal, |poses| {
        let (b4, b5) = (poses["b4"].clone(), poses["b5"].clone());
        poses.insert("b4".into(), b5);
        poses.insert("b5".into(), b4);
    });
    let b8 = goal.assembly.beam_index("b8").unwrap();
    let open =
        goal.assembly.kit.x_wa() * goal.assembly.p_a_hole(ramp_assembly::JointRef { beam: b8, joint: 2 });
    let misplaced = spoilt(&goal, |poses| {
        poses["p4"]["position"][0] = open.x.into();
        poses["p4"]["position"][1] = open.y.into();
    });
    for (state, done) in [(swapped, "draw b5 out"), (misplaced, "p4 stands in a hole and pins nothing")] {
        let setup = Setup { state: Some(&state), ..goal.setup(Track::State, 3) };
        let result = goal.run_setup(&setup);
        assert_eq!(result.completion, 1.0, "{:?}", result.events);
        assert!(result.events.iter().any(|event| event.kind.to_string().contains(done)), "{done}");
    }
}

/// A beam of no use to the goal lies so close beside one that is needed that the fingers have no room: it is
/// laid down elsewhere.
#[test]
fn a_neighbour_that_leaves_the_fingers_no_room_is_laid_aside() {
    let goal = GoalFiles::new("easy-1");
    let text = r#"{"poses": {"b1": {"position": [0.50, 0.08, 0.02], "yaw": 0.0},
        "b9": {"position": [0.39, 0.106, 0.02], "yaw": 0.0}}}"#;
    let state = state(&goal, text);
    let world = World::shipped("real").unwrap();
    let setup = Setup { state: Some(&state), world, ..goal.setup(Track::State, 3) };
    let result = goal.run_setup(&setup);
    assert_eq!(result.completion, 1.0, "{:?}", result.events);
    for told in ["pick up, with b9 laid aside", "b9 lies beside b1: laid down at"] {
        assert!(result.events.iter().any(|event| event.kind.to_string().contains(told)), "{told}");
    }
}

/// Without tags, a beam that is not on the sheet is found at its place in the frame; its printed outline is
/// not taken for it.
#[test]
fn without_tags_a_frame_that_stands_in_part_is_found() {
    let goal = GoalFiles::new("easy-1");
    let state = state(&goal, r#"{"in_assembly": ["b4"], "fastened": [["C1", "p1"]]}"#);
    let told = told_without_tags(&goal, &state, Track::Depth);
    assert!(told.contains("in their places in the frame: b4, p1"), "{told}");
}

/// Without tags, the pegs of a frame are found in whatever holes they are, and not taken for their neighbours
/// in the holders; nor is an absent beam taken for the one that lies beside its outline.
#[test]
fn without_tags_a_frame_that_stands_wrong_is_repaired() {
    let goal = GoalFiles::new("easy-3");
    let b8 = goal.assembly.beam_index("b8").unwrap();
    let open =
        goal.assembly.kit.x_wa() * goal.assembly.p_a_hole(ramp_assembly::JointRef { beam: b8, joint: 2 });
    let state = spoilt(&goal, |poses| {
        poses["p1"]["position"][0] = open.x.into();
        poses["p1"]["position"][1] = open.y.into();
    });
    let told = told_without_tags(&goal, &state, Track::Colour);
    assert!(told.contains("in their places in the frame: b4, b5, b8, "), "{told}");
    assert!(told.contains(" stands in a hole and pins nothing: it is taken out"), "{told}");
}

/// The notes of an episode in `real` that completes the frame.
fn told_without_tags(goal: &GoalFiles, state: &GivenState, track: Track) -> String {
    let world = World::shipped("real").unwrap();
    let setup = Setup { state: Some(state), world, start: Start::moved(), ..goal.setup(track, 3) };
    let result = goal.run_setup(&setup);
    assert_eq!(result.completion, 1.0, "{:?}", result.events);
    result.events.iter().map(|event| event.kind.to_string() + "\n").collect()
}

/// A beam that leans on another one is gripped by a hand that leans as it does, and built in: with poses that
/// are told, and from images. An upright hand does not find its slots.
#[test]
fn a_beam_that_leans_on_another_is_built_in() {
    let goal = GoalFiles::new("easy-1");
    // Its first end on the table, 200 mm of it this side of b5.
    let text = r#"{"poses": {"b4": {"position": [0.50, 0.005, 0.02],
        "quat_wxyz": [0.70473, 0.05794, -0.05794, 0.70473]}}}"#;
    let state = state(&goal, text);
    let world = World::shipped("real").unwrap();
    for track in [Track::State, Track::Tags] {
        let setup = Setup { state: Some(&state), world, ..goal.setup(track, 1) };
        let result = goal.run_setup(&setup);
        assert_eq!(result.completion, 1.0, "{track:?}: {:?}", result.events);
        let told = result.events.iter().map(|event| event.kind.to_string());
        assert_eq!(told.filter(|told| told.contains("the fingers stop")).count(), 0, "{track:?}");
    }
}

/// A beam that lies across another one is laid aside before that is taken: it would fall.
#[test]
fn a_beam_that_lies_on_another_is_laid_aside_first() {
    let goal = GoalFiles::new("easy-1");
    let text =
        r#"{"poses": {"b1": {"position": [0.52, 0.335, 0.05], "quat_wxyz": [0.70711, 0, 0, -0.70711]}}}"#;
    let state = state(&goal, text);
    let world = World::shipped("real").unwrap();
    let setup = Setup { state: Some(&state), world, start: Start::moved(), ..goal.setup(Track::State, 1) };
    let result = goal.run_setup(&setup);
    assert_eq!(result.completion, 1.0, "{:?}", result.events);
    let told: Vec<String> = result.events.iter().map(|event| event.kind.to_string()).collect();
    let aside = told.iter().position(|told| told.contains("b1 lies on b5: laid down"));
    let taken = told.iter().position(|told| told.contains("pick up b5"));
    assert!(aside.is_some() && aside < taken, "{told:?}");
}

/// Beams with the same joints that stand in one another's places are not the goal: a survey tells them apart
/// without tags, too, and only then.
#[test]
fn a_survey_without_tags_tells_swapped_beams() {
    let goal = GoalFiles::new("easy-3");
    let world = World::shipped("real").unwrap();
    for is_swapped in [true, false] {
        let state = spoilt(&goal, |poses| {
            if is_swapped {
                let [b4, b5] = ["b4", "b5"].map(|beam| poses[beam].clone());
                poses.insert("b4".to_string(), b5);
                poses.insert("b5".to_string(), b4);
            }
        });
        let setup = Setup { state: Some(&state), world, ..goal.setup(Track::Colour, 3) };
        let mut twin = Twin::new(&setup).unwrap();
        let seen = survey(&goal.assembly, &goal.arm, Track::Colour, &mut twin, 3).unwrap();
        let names: Vec<String> = twin.part_names().map(str::to_string).collect();
        let truth: BTreeMap<String, Pose> = names.into_iter().zip(twin.truth().x_wp).collect();
        for beam in ["b4", "b5", "b8"] {
            let off = (seen[beam].translation.vector - truth[beam].translation.vector).norm();
            assert!(off < 2.0e-3, "swapped: {is_swapped}, {beam} is {:.2} mm off", off * 1e3);
        }
    }
}

/// A survey measures the frame from images on every track that gives them, with tags and without. A peg that
/// is missing is not seen.
#[test]
fn a_built_frame_is_surveyed() {
    let goal = GoalFiles::new("easy-1");
    let missing = goal.assembly.built_with()[1].to_string();
    let state = spoilt(&goal, |poses| {
        poses.remove(&missing);
    });
    let world = World::shipped("real").unwrap();
    for track in [Track::Tags, Track::Colour, Track::Depth] {
        let setup = Setup { state: Some(&state), world, ..goal.setup(track, 3) };
        let mut twin = Twin::new(&setup).unwrap();
        let seen = survey(&goal.assembly, &goal.arm, track, &mut twin, 3).unwrap();
        let names: Vec<String> = twin.part_names().map(str::to_string).collect();
        let truth: BTreeMap<String, Pose> = names.into_iter().zip(twin.truth().x_wp).collect();
        let stand = |part: &&str| **part != missing;
        for part in goal.assembly.movable_parts().into_iter().filter(stand) {
            let x = seen.get(part).unwrap_or_else(|| panic!("{track:?}: {part} was not seen"));
            let off = (x.translation.vector - truth[part].translation.vector).norm();
            assert!(off < 1.2e-3, "{track:?}: {part} is {:.2} mm off", off * 1e3);
        }
        let there = seen.get(&missing).map(|x| x.translation.vector.z);
        assert!(there.is_none_or(|z| z > Holder::HEIGHT - 0.01), "{track:?}: {missing} seen at {there:?}");
    }
}
