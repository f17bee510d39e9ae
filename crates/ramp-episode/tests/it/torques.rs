//! The torques that motions are limited by are those of MuJoCo's inverse dynamics.

use std::fmt::Write;
use std::path::Path;

use mujoco_rs::prelude::*;
use ramp_motion::{Dynamics, Joints};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

/// A body of MJCF, left open for those that it carries.
fn body(position: [f64; 3], turn: [f64; 4], mass: f64, centre: [f64; 3], inertia: [f64; 6]) -> String {
    let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    format!(
        "<body pos='{}' quat='{}'><inertial mass='{mass}' pos='{}' fullinertia='{}'/>",
        list(&position),
        list(&turn),
        list(&centre),
        list(&inertia)
    )
}

/// The arm with its closed hand alone, as a scene.
fn scene<const N: usize>(arm: &ArmModel<N>) -> String {
    let mut text = "<mujoco><option gravity='0 0 -9.81'/><worldbody>".to_string();
    for joint in &arm.joints {
        let link = &joint.link;
        text += &body(joint.position, joint.quat_wxyz, link.mass, link.centre, link.inertia);
        text += "<joint type='hinge' axis='0 0 1'/>";
    }
    let (hand, finger) = (&arm.hand, &arm.finger);
    text += &body(hand.position, hand.quat_wxyz, hand.mass, hand.centre, hand.inertia);
    for turn in [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]] {
        text += &body([0.0, 0.0, finger.origin], turn, finger.mass, finger.centre, finger.inertia);
        text += "</body>";
    }
    write!(text, "{}</worldbody></mujoco>", "</body>".repeat(N + 1)).unwrap();
    text
}

#[test]
fn torques_are_those_of_mujoco() {
    compare::<7>("panda");
    compare::<7>("fr3");
    compare::<6>("ur5e");
}

fn compare<const N: usize>(name: &str) {
    let file = format!("{}/../../data/arms/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let arm: ArmModel<N> = ArmModel::read(Path::new(&file)).unwrap();
    let dynamics = Dynamics::new(&arm);
    let model = MjModel::from_xml_string(&scene(&arm)).unwrap();
    let mut data = MjData::new(&model);
    let mut stream = Stream::new(1, "torques");
    for _ in 0..200 {
        let mut draw = |most: f64| Joints::<N>::from_fn(|_, _| stream.symmetric(most));
        let (q, speeds, gains) = (draw(2.5), draw(2.5), draw(20.0));
        data.qpos_mut().copy_from_slice(q.as_slice());
        data.qvel_mut().copy_from_slice(speeds.as_slice());
        data.qacc_mut().copy_from_slice(gains.as_slice());
        data.inverse();
        let theirs = Joints::<N>::from_column_slice(data.qfrc_inverse());
        let ours = dynamics.at(&q).torques(&speeds, &gains);
        assert!((ours - theirs).amax() < 1e-9 * theirs.amax().max(1.0), "{name}: {ours} {theirs}");
    }
}
