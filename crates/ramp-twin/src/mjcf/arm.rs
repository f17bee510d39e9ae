//! The arm with its hand and fingers, their motors and the wrist sensor.

use super::text::{box_geom, capsule_geom, inertial, numbers};
use crate::looks;
use ramp_kit::shape::Cuboid;
use ramp_robot::arm::{ArmBox, ArmModel};
use ramp_world::Physics;
use std::f64::consts::PI;
use std::fmt::Write;

/// A box of the hand.
fn hand_box(piece: &ArmBox) -> Cuboid {
    Cuboid { min: piece.min, max: piece.max }
}

/// A box of a finger in the finger's frame; `tip` is how far the tip is out along that frame's z (m), and the
/// arm file counts heights from the tip towards the hand.
fn finger_box(piece: &ArmBox, tip: f64) -> Cuboid {
    let [x0, y0, z0] = piece.min;
    let [x1, y1, z1] = piece.max;
    Cuboid { min: [x0, y0, tip - z1], max: [x1, y1, tip - z0] }
}

/// The arm, from its base outwards; `look` names the arm whose meshes show it.
pub(super) fn arm_bodies(xml: &mut String, arm: &ArmModel, look: &str, physics: &Physics) {
    xml.push_str("<body name=\"link0\">");
    for capsule in &arm.base.capsules {
        capsule_geom(xml, "arm", capsule);
    }
    xml.push_str(&looks::geoms(look, "link0"));
    for (index, joint) in arm.joints.iter().enumerate() {
        let number = index + 1;
        let q = joint.quat_wxyz;
        let _ = write!(
            xml,
            "\n<body name=\"link{number}\" pos=\"{}\" quat=\"{} {} {} {}\" gravcomp=\"1\">",
            numbers(&joint.position),
            q[0],
            q[1],
            q[2],
            q[3]
        );
        inertial(xml, joint.link.mass, &joint.link.centre, &joint.link.inertia);
        let _ = write!(
            xml,
            r#"<joint name="joint{number}" axis="0 0 1" range="{}" damping="{}" armature="{}"/>"#,
            numbers(&joint.range),
            physics.friction.viscous[index],
            physics.arm.armature[index]
        );
        for capsule in &joint.link.capsules {
            capsule_geom(xml, "arm", capsule);
        }
        xml.push_str(&looks::geoms(look, &format!("link{number}")));
    }
    let hand = &arm.hand;
    let q = hand.quat_wxyz;
    let _ = write!(
        xml,
        "\n<body name=\"hand\" pos=\"{}\" quat=\"{} {} {} {}\" gravcomp=\"1\">",
        numbers(&hand.position),
        q[0],
        q[1],
        q[2],
        q[3]
    );
    inertial(xml, hand.mass, &hand.centre, &hand.inertia);
    let _ = write!(
        xml,
        r#"<site name="wrist" pos="0 0 0" size="0.002"/><site name="tip" pos="0 0 {}" size="0.002"/>"#,
        hand.tip
    );
    for (index, piece) in hand.boxes.iter().enumerate() {
        // The first box is the hand's body, which has a mesh; the others are what is mounted on it.
        box_geom(xml, if index == 0 { "arm" } else { "tool" }, &hand_box(piece));
    }
    xml.push_str(&looks::geoms(look, "hand"));
    let finger = &arm.finger;
    let tip = hand.tip - finger.origin;
    for (name, turn) in [("finger1", 0.0), ("finger2", PI)] {
        let half: f64 = turn / 2.0;
        let _ = write!(
            xml,
            "\n<body name=\"{name}\" pos=\"0 0 {}\" quat=\"{} 0 0 {}\" gravcomp=\"1\">",
            finger.origin,
            half.cos().round(),
            half.sin().round()
        );
        inertial(xml, finger.mass, &finger.centre, &finger.inertia);
        let _ = write!(
            xml,
            r#"<joint name="{name}" type="slide" axis="0 1 0" range="0 {}" armature="0.1" damping="5"/>"#,
            finger.stroke
        );
        for pad in &finger.pads {
            box_geom(xml, "pad", &finger_box(pad, tip));
        }
        for piece in &finger.boxes {
            box_geom(xml, "tool", &finger_box(piece, tip));
        }
        xml.push_str("</body>");
    }
    xml.push_str("</body>");
    for _ in &arm.joints {
        xml.push_str("</body>");
    }
    xml.push_str("</body>\n");
}

/// Least number of joints between two bodies of the arm that collide. Nearer ones are kept apart by the
/// joints' ranges, and their capsules, which are wider than the arm, overlap. As in motion planning.
const JOINTS_BETWEEN: usize = 3;

/// The pairs of the arm's bodies that pass through each other: neighbours, and the fingers, whose ribs pass
/// each other's plates when the hand is closed on nothing.
fn passing(joints: usize) -> Vec<[String; 2]> {
    let links = (0..=joints).map(|number| (format!("link{number}"), number));
    let hand = ["hand", "finger1", "finger2"].map(|name| (name.to_string(), joints));
    let bodies: Vec<(String, usize)> = links.chain(hand).collect();
    let mut passing = Vec::new();
    for (index, (one, before)) in bodies.iter().enumerate() {
        for (other, after) in &bodies[index + 1..] {
            if after - before < JOINTS_BETWEEN {
                passing.push([one.clone(), other.clone()]);
            }
        }
    }
    passing
}

/// Actuators and sensors of the arm, and which of its bodies do not collide.
pub(super) fn actuators_and_sensors(xml: &mut String, arm: &ArmModel) {
    xml.push_str("<contact>");
    for [one, other] in passing(arm.joints.len()) {
        let _ = write!(xml, r#"<exclude body1="{one}" body2="{other}"/>"#);
    }
    xml.push_str("</contact>\n<actuator>");
    for (index, joint) in arm.joints.iter().enumerate() {
        let _ = write!(
            xml,
            r#"<motor name="joint{0}" joint="joint{0}" ctrlrange="{1} {2}"/>"#,
            index + 1,
            -joint.torque,
            joint.torque
        );
    }
    xml.push_str(
        r#"<motor name="finger1" joint="finger1"/><motor name="finger2" joint="finger2"/></actuator>"#,
    );
    xml.push_str("\n<sensor><force name=\"wrist_force\" site=\"wrist\"/><torque name=\"wrist_torque\" site=\"wrist\"/></sensor>\n");
}
