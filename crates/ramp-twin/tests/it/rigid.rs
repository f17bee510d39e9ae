//! A frame that is one rigid body.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use ramp_robot::{Robot, Track};
use ramp_testing::GoalFiles;
use ramp_twin::{SceneOptions, Twin};

fn names(parts: &[&str]) -> BTreeSet<String> {
    parts.iter().map(|it| (*it).to_string()).collect()
}

/// A rigid part stays in its place, however it is knocked; all else moves as before, and the robot goes on.
#[test]
fn only_the_rigid_parts_stay() {
    let goal = GoalFiles::new("easy-1");
    let setup = goal.setup(Track::State, 1);
    let mut twin = Twin::new(&setup).unwrap();
    twin.settle(300).unwrap();
    let mut rigid = twin.with_rigid(&setup, names(&["b1"]), &SceneOptions::default()).unwrap();
    assert_eq!((rigid.time(), rigid.observe()), (twin.time(), twin.observe()));
    let (before, after) = (twin.truth().x_wp, rigid.truth().x_wp);
    let off =
        |a: &ramp_robot::Pose, b: &ramp_robot::Pose| (a.translation.vector - b.translation.vector).norm();
    let apart = before.iter().zip(&after).map(|(a, b)| off(a, b)).fold(0.0, f64::max);
    // The engine has poses of a step before.
    assert!(apart < 1e-6, "{apart} m");
    for name in ["b1", "b2"] {
        let index = rigid.part_names().position(|part| part == name).unwrap();
        rigid.knock(name, &Vector3::new(0.3, 0.0, 0.0), &Vector3::zeros());
        rigid.settle(100).unwrap();
        let moved = off(&rigid.truth().x_wp[index], &after[index]);
        assert_eq!(name == "b1", moved < 1e-9, "{name}: {moved} m");
    }
}
