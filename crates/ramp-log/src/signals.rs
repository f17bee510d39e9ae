//! The messages of a log for viewers: what a robot reports, commands, poses. Their schemas are in
//! `data/schema/log`.

use nalgebra::Vector3;
use ramp_robot::{ArmCommand, Command, FingerTouch, Observation, Pose};
use serde_json::{Value, json};

macro_rules! schema {
    ($name:literal) => {
        include_str!(concat!("../../../data/schema/log/", $name, ".schema.json"))
    };
}

/// The channels: topic, name of the schema, and the schema itself.
pub const CHANNELS: [(&str, &str, &str); 5] = [
    ("/robot", "ramp.Sensed", schema!("sensed")),
    ("/tip", "foxglove.PoseInFrame", schema!("tip")),
    ("/command", "ramp.Command", schema!("command")),
    ("/parts", "foxglove.FrameTransforms", schema!("parts")),
    ("/events", "ramp.Event", schema!("event")),
];

/// A message on `/robot`.
pub fn sensed(seen: &Observation) -> Value {
    let wrench = |from: usize| {
        let [x, y, z]: [f64; 3] = seen.wrench.fixed_rows::<3>(from).into_owned().into();
        json!({"x": round(x, 1e3), "y": round(y, 1e3), "z": round(z, 1e3)})
    };
    let mut message = json!({
        "positions": seen.positions.map(|it| round(it, 1e5)),
        "velocities": seen.velocities.map(|it| round(it, 1e4)),
        "torques": seen.torques.map(|it| round(it, 1e3)),
        "force": wrench(0),
        "moment": wrench(3),
        "width": round(seen.width, 1e5),
    });
    if let Some(touch) = &seen.touch {
        let rounded = |it: f64| round(it, 1e3);
        let finger = |it: FingerTouch| {
            let [x, y, z]: [f64; 3] = it.force.map(rounded).into();
            let centre = it.centre.map(|[x, z]| json!({"x": round(x, 1e5), "z": round(z, 1e5)}));
            json!({"force": {"x": x, "y": y, "z": z}, "centre": centre})
        };
        message["touch"] = touch.fingers.map(finger).to_vec().into();
    }
    message
}

/// A message on `/tip`; `stamp` is its time.
pub fn tip(x_wt: &Pose, stamp: &Value) -> Value {
    json!({
        "timestamp": stamp,
        "frame_id": "world",
        "pose": {"position": xyz(&x_wt.translation.vector), "orientation": xyzw(x_wt)},
    })
}

/// The pose of a part in a message on `/parts`; `stamp` is its time.
pub fn part(name: &str, x_wp: &Pose, stamp: &Value) -> Value {
    json!({
        "timestamp": stamp,
        "parent_frame_id": "world",
        "child_frame_id": name,
        "translation": xyz(&x_wp.translation.vector),
        "rotation": xyzw(x_wp),
    })
}

/// A message on `/command`.
pub fn command(command: &Command) -> Value {
    let joints = |kind: &str, values: &[f64; ramp_robot::DOF]| {
        (kind.to_string(), json!(values.map(fine)), Value::Null)
    };
    let pose = |kind: &str, x: &Pose| {
        let (p, q) = (x.translation.vector, x.rotation.quaternion());
        let (position, quat_wxyz) = ([p.x, p.y, p.z].map(fine), [q.w, q.i, q.j, q.k].map(fine));
        let place = json!({"position": position, "quat_wxyz": quat_wxyz});
        (kind.to_string(), Value::Null, place)
    };
    let (kind, joints, x_wt) = match &command.arm {
        ArmCommand::JointPositions(values) => joints("joint_positions", values),
        ArmCommand::JointVelocities(values) => joints("joint_velocities", values),
        ArmCommand::JointTorques(values) => joints("joint_torques", values),
        ArmCommand::CartesianPose(x_wt) => pose("pose", x_wt),
        ArmCommand::CartesianImpedance(impedance) => pose("impedance", &impedance.x_wt),
    };
    let gripper = json!({"width": fine(command.gripper.width), "force": fine(command.gripper.force)});
    json!({"kind": kind, "joints": joints, "x_wt": x_wt, "gripper": gripper})
}

/// `value` rounded to a multiple of 1/`parts`: signals are for viewers, and the calls are exact.
fn round(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// To a millionth.
fn fine(value: f64) -> f64 {
    round(value, 1e6)
}

fn xyz(v: &Vector3<f64>) -> Value {
    json!({"x": fine(v.x), "y": fine(v.y), "z": fine(v.z)})
}

fn xyzw(x: &Pose) -> Value {
    let q = x.rotation.quaternion();
    json!({"x": fine(q.i), "y": fine(q.j), "z": fine(q.k), "w": fine(q.w)})
}
