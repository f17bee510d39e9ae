//! The cell of a served twin, beside Franka's protocol: lines of JSON, over a connection of its own. An
//! image's pixels follow their line.

use ramp_robot::{Camera, FingerTouch, PartReading, Pose};
use serde::{Deserialize, Serialize};

/// The question of a client.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub enum Question {
    /// Readings of the parts.
    Parts,
    /// The shutters are to open while the arm moves.
    Expose,
    /// A reading of the sensors in the fingers.
    Touch,
    /// An image.
    Image {
        /// Of this camera.
        #[serde(with = "camera_name")]
        camera: Camera,
        /// Pixels in a row; the camera's own without it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        width: Option<u64>,
    },
}

/// The answer.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case", deny_unknown_fields)]
pub enum Answer {
    /// It was done.
    Done,
    /// The readings.
    Parts {
        /// One for each part that was seen.
        parts: Vec<Reading>,
    },
    /// The reading of the sensors in the fingers, first of the one at +y of the tip.
    Touch {
        /// Of each finger.
        fingers: [Finger; 2],
    },
    /// The image comes after this number of control periods.
    Wait {
        /// Of a millisecond.
        periods: u64,
    },
    /// An image, whose pixels follow: three bytes each, row by row from above; then its depths, if it has
    /// them.
    Image(ImageHead),
    /// The question was refused.
    Refused {
        /// The reason.
        why: String,
    },
}

/// The reading of a part.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Reading {
    /// Its name.
    pub part: String,
    /// Its pose in the world.
    pub x_wp: Numbers,
    /// Standard deviations, m and rad.
    pub sigma: [f64; 2],
}

/// The reading of the tactile sensor of a finger, as [`ramp_robot::FingerTouch`].
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Finger {
    /// N, axes of the tip.
    pub force: [f64; 3],
    /// m; `None` while the finger presses too lightly.
    pub centre: Option<[f64; 2]>,
}

/// The head of an image.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ImageHead {
    /// Its camera.
    #[serde(with = "camera_name")]
    pub camera: Camera,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The number of the arm's state at the middle of the exposure: a millisecond each.
    pub message: u64,
    /// Pose of the tip in the world then, as the arm reported it.
    pub x_wt: Numbers,
    /// Whether depths follow the pixels: two bytes each, the lower one first.
    #[serde(default)]
    pub depth: bool,
}

/// A pose as numbers: x, y, z in m, then a unit quaternion w, x, y, z.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Numbers(pub [f64; 7]);

impl From<&Pose> for Numbers {
    fn from(x: &Pose) -> Numbers {
        let (p, r) = (&x.translation.vector, x.rotation.quaternion());
        Numbers([p.x, p.y, p.z, r.w, r.i, r.j, r.k])
    }
}

impl From<Numbers> for Pose {
    fn from(Numbers([x, y, z, w, i, j, k]): Numbers) -> Pose {
        let rotation = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
        Pose::from_parts(nalgebra::Translation3::new(x, y, z), rotation)
    }
}

impl From<&PartReading> for Reading {
    fn from(reading: &PartReading) -> Reading {
        Reading { part: reading.part.clone(), x_wp: (&reading.x_wp).into(), sigma: reading.sigma }
    }
}

impl From<Reading> for PartReading {
    fn from(reading: Reading) -> PartReading {
        PartReading { part: reading.part, x_wp: reading.x_wp.into(), sigma: reading.sigma }
    }
}

impl From<&FingerTouch> for Finger {
    fn from(finger: &FingerTouch) -> Finger {
        Finger { force: finger.force.into(), centre: finger.centre }
    }
}

impl From<Finger> for FingerTouch {
    fn from(finger: Finger) -> FingerTouch {
        FingerTouch { force: finger.force.into(), centre: finger.centre }
    }
}

/// Cameras by their names.
mod camera_name {
    use ramp_robot::Camera;
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
    pub fn serialize<S: Serializer>(camera: &Camera, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(camera.name())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Camera, D::Error> {
        let name = String::deserialize(deserializer)?;
        Camera::ALL
            .into_iter()
            .find(|camera| camera.name() == name)
            .ok_or_else(|| D::Error::custom(format!("no camera `{name}`")))
    }
}
