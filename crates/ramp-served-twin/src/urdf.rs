//! The arm of an arm file as a URDF, with what Franka's client libraries look for in it.

use std::fmt::Write;

use nalgebra::{Quaternion, UnitQuaternion};
use ramp_robot::arm::{ArmModel, FLANGE};

/// Deceleration of an arm whose largest velocity is the same everywhere, rad/s²: so large that no velocity is
/// limited by it.
const ANY_DECELERATION: f64 = 1e6;

/// Links `link0` to `link8` and joints `joint1` to `joint8`: the arm without its hand.
pub(crate) fn urdf(arm: &ArmModel) -> String {
    let mut text =
        format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n<link name=\"link0\"/>\n", arm.name);
    for (index, joint) in arm.joints.iter().enumerate() {
        let number = index + 1;
        let [xx, yy, zz, xy, xz, yz] = joint.link.inertia;
        let [x, y, z] = joint.link.centre;
        let (deceleration, offset) = joint
            .braking
            .as_ref()
            .map_or((ANY_DECELERATION, 0.0), |braking| (braking.deceleration, braking.offset));
        let [low, high] = joint.range;
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "<link name=\"link{number}\"><inertial><origin rpy=\"0 0 0\" xyz=\"{x} {y} {z}\"/>\
             <mass value=\"{}\"/><inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" \
             izz=\"{zz}\"/></inertial></link>\n\
             <joint name=\"joint{number}\" type=\"revolute\">{}<parent link=\"link{index}\"/>\
             <child link=\"link{number}\"/><axis xyz=\"0 0 1\"/>\
             <limit effort=\"{}\" lower=\"{low}\" upper=\"{high}\" velocity=\"{}\"/>\
             <position_based_velocity_limits deceleration_limit=\"{deceleration}\" \
             velocity_offset=\"{offset}\"/></joint>\n",
            joint.link.mass,
            origin(&joint.position, joint.quat_wxyz),
            joint.torque,
            joint.velocity,
        );
    }
    let _ = write!(
        text,
        "<link name=\"link8\"/>\n<joint name=\"joint8\" type=\"fixed\">\
         <origin rpy=\"0 0 0\" xyz=\"0 0 {FLANGE}\"/><parent link=\"link7\"/><child link=\"link8\"/></joint>\n\
         </robot>\n"
    );
    text
}

fn origin([x, y, z]: &[f64; 3], [w, i, j, k]: [f64; 4]) -> String {
    let (roll, pitch, yaw) = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)).euler_angles();
    format!("<origin rpy=\"{roll:.17} {pitch:.17} {yaw:.17}\" xyz=\"{x} {y} {z}\"/>")
}
