//! A camera for pictures that people look at: it stands beside the work, and follows it.

use nalgebra::{Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use ramp_robot::camera::Mount;
use ramp_robot::{CameraModel, Pose};

/// The camera moves when the point that it follows is further than this from the centre of the image, in half
/// image widths and heights.
const AWAY: f64 = 0.7;

/// A camera without distortion that follows a point. It stands still until the point nears the edge of its
/// image.
#[derive(Clone, Debug)]
pub struct FreeCamera {
    model: CameraModel,
    /// From the target to the camera, m, axes of the world.
    offset: Vector3<f64>,
    target: Option<Point3<f64>>,
}

impl FreeCamera {
    /// A camera for images of `width` by `height` pixels, with a focal length in image widths. `offset` is
    /// the vector from its target to the camera, m, axes of the world; it is not vertical.
    pub fn new([width, height]: [usize; 2], focal: f64, offset: [f64; 3]) -> FreeCamera {
        let model = CameraModel {
            width,
            height,
            focal: [focal * width as f64; 2],
            centre: [width as f64 / 2.0, height as f64 / 2.0],
            distortion: [0.0; 5],
            mount: Mount::World(Pose::identity()),
        };
        FreeCamera { model, offset: Vector3::from(offset), target: None }
    }

    /// Its model; [`FreeCamera::follow`] gives its pose.
    pub fn model(&self) -> &CameraModel {
        &self.model
    }

    /// The camera's pose in the world for an image in which `p_wq` can be seen.
    pub fn follow(&mut self, p_wq: Point3<f64>) -> Pose {
        if let Some(target) = self.target {
            let x_wc = self.pose(target);
            let half = [self.model.width as f64 / 2.0, self.model.height as f64 / 2.0];
            let near =
                |pixel: [f64; 2]| (0..2).all(|axis| (pixel[axis] - half[axis]).abs() <= AWAY * half[axis]);
            if self.model.project(&(x_wc.inverse() * p_wq)).is_some_and(near) {
                return x_wc;
            }
        }
        self.target = Some(p_wq);
        self.pose(p_wq)
    }

    /// The camera's pose in the world when `target` is in the centre.
    fn pose(&self, target: Point3<f64>) -> Pose {
        let forward = -self.offset.normalize();
        let right = forward.cross(&Vector3::z()).normalize();
        let axes = Matrix3::from_columns(&[right, forward.cross(&right), forward]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Pose::from_parts(Translation3::from(target.coords + self.offset), rotation)
    }
}
