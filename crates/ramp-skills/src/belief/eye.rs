//! One camera of the agent: its model as it is known by now, and the sighting of a part that it saw.

use nalgebra::{Matrix6, Point3, Rotation3, SMatrix};
use ramp_robot::{Camera, CameraModel};
use ramp_vision::Calibration;

use super::estimate::{Estimate, covariance};
use super::repeats::Repeats;
use crate::Pose;
use crate::parameters::belief::EyesParameters;

/// A part as it was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// Its name.
    pub part: String,
    /// Its pose in the world.
    pub estimate: Estimate,
    /// The camera that saw it, if that has not yet seen anything with a known pose: all its sightings share
    /// the error of its nominal place.
    pub nominal: Option<Camera>,
    /// The pose of the tip in the world when it was seen.
    pub x_wt: Pose,
}

/// A camera, and how well its place is known by now.
pub struct Eye {
    /// Which camera.
    pub camera: Camera,
    /// Its model by now; `None` before the first image.
    pub model: Option<CameraModel>,
    /// The known points that it has seen.
    pub calibration: Option<Calibration>,
    /// Covariance of a small shift (m) and turn (rad) of the camera, in its own axes.
    pub covariance: Matrix6<f64>,
    /// Images in a row that were of no use.
    pub bad: usize,
    /// The last image that was of use: one black image is like another, and no camera repeats it.
    pub last: Vec<u8>,
    /// The places from which it has seen parts.
    pub repeats: Repeats,
}

impl Eye {
    /// Before any image.
    pub fn new(camera: Camera, parameters: &EyesParameters) -> Eye {
        let [position, angle] = calibration(parameters);
        let covariance = covariance([position; 3], [angle; 3]);
        Eye {
            camera,
            model: None,
            calibration: None,
            covariance,
            bad: 0,
            last: Vec::new(),
            repeats: Repeats::default(),
        }
    }

    /// Whether it is no longer used.
    pub fn broken(&self, parameters: &EyesParameters) -> bool {
        self.bad >= parameters.broken
    }

    /// Number of known points that it has seen.
    pub fn points(&self) -> usize {
        self.calibration.as_ref().map_or(0, Calibration::len)
    }

    /// Known points of the world were seen: `add` tells the calibration. Gives the model that is most
    /// likely by now.
    pub fn learn(
        &mut self,
        nominal: &CameraModel,
        parameters: &EyesParameters,
        add: impl FnOnce(&mut Calibration),
    ) -> CameraModel {
        let calibration =
            self.calibration.get_or_insert_with(|| Calibration::new(nominal, calibration(parameters)));
        add(calibration);
        let (better, left) = calibration.solve();
        let (position, angle) = (parameters.remains, parameters.remains_turn);
        self.covariance = left + covariance([position; 3], [angle; 3]);
        self.model.insert(better).clone()
    }

    /// A part that it saw from `x_wc`, with the tip at `x_wt`: as `seen` has it, if the camera is where its
    /// model says, and less sure by the error of the camera's place.
    pub fn sighting(&self, part: String, seen: Estimate, x_wc: &Pose, x_wt: Pose) -> Sighting {
        let axes: Rotation3<f64> = x_wc.rotation.to_rotation_matrix();
        let p_cp = x_wc.inverse_transform_point(&Point3::from(seen.x.translation.vector));
        // A camera that is turned by δθ sees a part at p as shifted by δθ × p.
        let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(axes.matrix());
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-axes.matrix() * p_cp.coords.cross_matrix()));
        jacobian.fixed_view_mut::<3, 3>(3, 3).copy_from(axes.matrix());
        let covariance = seen.covariance + jacobian * self.covariance * jacobian.transpose();
        let nominal = (self.points() == 0).then_some(self.camera);
        Sighting { part, estimate: Estimate { x: seen.x, covariance }, nominal, x_wt }
    }
}

/// Pose error of a camera's calibration, 1 σ, m and rad.
pub fn calibration(parameters: &EyesParameters) -> [f64; 2] {
    [parameters.calibration, parameters.calibration_turn]
}
