//! Observations and poses as the protocol has them.

use ramp_robot::{FingerTouch, Observation, Pose};
use serde_json::{Value, json};

/// An observation as the protocol has it.
pub fn observation(seen: &Observation) -> Value {
    let mut value = json!({
        "time": seen.time,
        "positions": seen.positions,
        "velocities": seen.velocities,
        "torques": seen.torques,
        "x_wt": pose(&seen.x_wt),
        "wrench": seen.wrench.as_slice(),
        "width": seen.width,
        "gripper_busy": seen.gripper_busy,
    });
    if let Some(touch) = &seen.touch {
        let finger = |it: FingerTouch| json!({"force": it.force.as_slice(), "centre": it.centre});
        value["touch"] = touch.fingers.map(finger).to_vec().into();
    }
    value
}

/// A pose as the protocol has it.
pub fn pose(x: &Pose) -> Value {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    json!({"position": [p.x, p.y, p.z], "quat_wxyz": [q.w, q.i, q.j, q.k]})
}

#[cfg(test)]
mod tests {
    use ramp_robot::{DOF, Touch};

    use super::*;

    /// An observation has the readings of tactile sensors where there are any.
    #[test]
    fn an_observation_tells_what_the_fingers_feel() {
        let mut seen = Observation {
            time: 0.5,
            positions: [0.0; DOF],
            velocities: [0.0; DOF],
            torques: [0.0; DOF],
            x_wt: Pose::identity(),
            wrench: nalgebra::Vector6::zeros(),
            width: 0.02,
            gripper_busy: false,
            touch: None,
        };
        assert!(observation(&seen).get("touch").is_none());
        let finger = |y: f64, centre| FingerTouch { force: nalgebra::Vector3::new(0.5, y, -1.0), centre };
        seen.touch = Some(Touch { fingers: [finger(-20.0, Some([0.001, 0.017])), finger(1.5, None)] });
        let expected = json!([
            {"force": [0.5, -20.0, -1.0], "centre": [0.001, 0.017]},
            {"force": [0.5, 1.5, -1.0], "centre": null},
        ]);
        assert_eq!(observation(&seen)["touch"], expected);
    }
}
