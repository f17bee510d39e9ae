//! The labels of images: where each part is in the camera's optical frame C, and what a detector says of it.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::Pose;
use serde::{Deserialize, Serialize};

/// Name and version of the form of the labels.
pub const SCHEMA: &str = "ramp-views/1";
/// A pose in files: position in m, quaternion w x y z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseLabel {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion.
    pub quat_wxyz: [f64; 4],
}

impl From<&Pose> for PoseLabel {
    fn from(x: &Pose) -> PoseLabel {
        let q = x.rotation.quaternion();
        PoseLabel { position: x.translation.vector.into(), quat_wxyz: [q.w, q.i, q.j, q.k] }
    }
}

impl From<&PoseLabel> for Pose {
    fn from(label: &PoseLabel) -> Pose {
        let [w, i, j, k] = label.quat_wxyz;
        let rotation = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
        Pose::from_parts(Translation3::from(Vector3::from(label.position)), rotation)
    }
}

/// A tag in a view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TagLabel {
    /// Its id.
    pub id: u32,
    /// Corners of its black square, pixels: upper left, upper right, lower right, lower left as printed.
    pub corners: [[f64; 2]; 4],
    /// Middle of the tag on its part, m.
    pub p_p: [f64; 3],
    /// Distance from the camera, m.
    pub distance: f64,
    /// Angle between its face's normal and the line of sight, degrees.
    pub angle: f64,
    /// Is all of it in view, its ring of white too? A part counts as one to be found when one of its tags is.
    pub whole: bool,
}

/// A part of which at least one tag is in view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartLabel {
    /// Its name in the kit.
    pub part: String,
    /// Its pose in the optical frame C.
    pub x_cp: PoseLabel,
    /// Its tags that face the camera and whose middle is in the image.
    pub tags: Vec<TagLabel>,
}

/// One image's labels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewLabel {
    /// The image's file.
    pub file: String,
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// Focal lengths, pixels.
    pub focal: [f64; 2],
    /// Principal point, pixels.
    pub centre: [f64; 2],
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// The parts.
    pub parts: Vec<PartLabel>,
}

/// All labels of a folder of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Labels {
    /// [`SCHEMA`].
    pub schema: String,
    /// The views.
    pub views: Vec<ViewLabel>,
}

/// Report of a detector on a part in an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The image's file, as in the labels.
    pub file: String,
    /// The part.
    pub part: String,
    /// Its pose in the optical frame C.
    pub x_cp: PoseLabel,
}
