//! Numbers of Python to commands, and what the robot senses to arrays.

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector6};
use numpy::{
    AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayLike1, PyArrayMethods, ToPyArray,
};
use pyo3::prelude::*;
use ramp_kit::Pose;
use ramp_robot::{
    ArmCommand, Camera, Command as Inner, DOF, FingerTouch, GripperCommand, Image, ImageWidth, Impedance,
    Observation as Seen, Touch,
};

use crate::errors::input;

/// A row of numbers of Python: any sequence, or an array of any number type and stride.
pub type Numbers<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// So many numbers.
pub fn exactly<const N: usize>(numbers: &Numbers<'_>, what: &str) -> PyResult<[f64; N]> {
    let view = numbers.as_array();
    if view.len() != N {
        return Err(input(format!("{what} has {} numbers, and {N} were expected", view.len())));
    }
    let mut all = [0.0; N];
    for (slot, number) in all.iter_mut().zip(view.iter()) {
        *slot = *number;
    }
    Ok(all)
}

/// All numbers.
pub fn all(numbers: &Numbers<'_>) -> Vec<f64> {
    numbers.as_array().iter().copied().collect()
}

/// A pose from arrays.
fn pose_of(position: &Numbers<'_>, quat_wxyz: &Numbers<'_>) -> PyResult<Pose> {
    let p: [f64; 3] = exactly(position, "position")?;
    let q: [f64; 4] = exactly(quat_wxyz, "quat_wxyz")?;
    pose(&p, &q)
}

/// A pose from a position (m) and a quaternion w, x, y, z of about length one.
pub fn pose(p: &[f64], q: &[f64]) -> PyResult<Pose> {
    let ([px, py, pz], [w, x, y, z]) = (p, q) else { return Err(input("a pose has seven numbers")) };
    let p = [*px, *py, *pz];
    let [w, x, y, z] = [w, x, y, z].map(|it| *it);
    let q = Quaternion::new(w, x, y, z);
    let length = q.norm();
    if !length.is_finite() || (length - 1.0).abs() > 1e-3 {
        return Err(input(format!("quat_wxyz has the length {length:.4}, and 1 was expected")));
    }
    Ok(Pose::from_parts(Translation3::from(p), UnitQuaternion::from_quaternion(q)))
}

/// A pose as seven numbers: x, y, z in m, quaternion w, x, y, z.
pub fn seven(x: &Pose) -> Vec<f64> {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    vec![p.x, p.y, p.z, q.w, q.i, q.j, q.k]
}

/// The camera of that name.
pub fn camera(name: &str) -> PyResult<Camera> {
    let named = Camera::ALL.into_iter().find(|it| it.name() == name || it.name().replace('-', "_") == name);
    named.ok_or_else(|| input(format!("there is no camera `{name}`; there are wrist, birds-eye")))
}

/// The width of an image, pixels; `None` is the camera's own.
pub fn width_of(size: Option<u64>) -> PyResult<Option<ImageWidth>> {
    let Some(size) = size else { return Ok(None) };
    let (least, most) = (ImageWidth::LEAST, ImageWidth::MOST);
    let wrong = || input(format!("size: found {size}, expected an integer from {least} to {most}"));
    Ok(Some(ImageWidth::new(size).ok_or_else(wrong)?))
}

/// An image as an array of shape (height, width, 3).
pub fn picture<'py>(
    py: Python<'py>,
    pixels: Vec<u8>,
    [height, width]: [usize; 2],
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    pixels.into_pyarray(py).reshape([height, width, 3])
}

/// Command of arm and gripper for control periods of 1 ms.
///
/// Made by one of its functions, each with `width`, the wanted distance between the fingers (m, 0 to 0.08),
/// and `force`, the largest force of each finger (N).
#[pyclass(frozen, module = "ramp")]
#[derive(Clone)]
pub struct Command {
    pub inner: Inner,
}

fn command(arm: ArmCommand, width: f64, force: f64) -> Command {
    Command { inner: Inner { arm, gripper: GripperCommand { width, force } } }
}

#[pymethods]
impl Command {
    /// Joint positions, rad, shape (7,); the inner loop tracks them stiffly.
    #[staticmethod]
    #[pyo3(signature = (positions, width=0.04, force=20.0))]
    fn joint_positions(positions: Numbers<'_>, width: f64, force: f64) -> PyResult<Command> {
        Ok(command(ArmCommand::JointPositions(exactly::<DOF>(&positions, "positions")?), width, force))
    }

    /// Joint velocities, rad/s, shape (7,).
    #[staticmethod]
    #[pyo3(signature = (velocities, width=0.04, force=20.0))]
    fn joint_velocities(velocities: Numbers<'_>, width: f64, force: f64) -> PyResult<Command> {
        Ok(command(ArmCommand::JointVelocities(exactly::<DOF>(&velocities, "velocities")?), width, force))
    }

    /// Joint torques on top of gravity compensation, N·m, shape (7,).
    #[staticmethod]
    #[pyo3(signature = (torques, width=0.04, force=20.0))]
    fn joint_torques(torques: Numbers<'_>, width: f64, force: f64) -> PyResult<Command> {
        Ok(command(ArmCommand::JointTorques(exactly::<DOF>(&torques, "torques")?), width, force))
    }

    /// The pose of the tip in the world, tracked stiffly: position in m, quaternion w, x, y, z.
    #[staticmethod]
    #[pyo3(signature = (position, quat_wxyz, width=0.04, force=20.0))]
    fn pose(position: Numbers<'_>, quat_wxyz: Numbers<'_>, width: f64, force: f64) -> PyResult<Command> {
        Ok(command(ArmCommand::CartesianPose(pose_of(&position, &quat_wxyz)?), width, force))
    }

    /// A spring and damper between the tip and a pose in the world: `stiffness` along (N/m) and about
    /// (N·m/rad) the axes of the world, `feed_forward` a wrench (N, N·m) at the tip, `posture` joint
    /// positions (rad) for the null space.
    #[staticmethod]
    #[pyo3(signature = (position, quat_wxyz, posture, stiffness=None, damping_ratio=1.0, feed_forward=None, width=0.04, force=20.0))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn impedance(
        position: Numbers<'_>,
        quat_wxyz: Numbers<'_>,
        posture: Numbers<'_>,
        stiffness: Option<Numbers<'_>>,
        damping_ratio: f64,
        feed_forward: Option<Numbers<'_>>,
        width: f64,
        force: f64,
    ) -> PyResult<Command> {
        let six = |numbers: Option<Numbers<'_>>, what: &str, otherwise: [f64; 6]| match numbers {
            Some(numbers) => exactly::<6>(&numbers, what),
            None => Ok(otherwise),
        };
        let arm = ArmCommand::CartesianImpedance(Impedance {
            x_wt: pose_of(&position, &quat_wxyz)?,
            stiffness: Vector6::from(six(
                stiffness,
                "stiffness",
                [1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0],
            )?),
            damping_ratio,
            feed_forward: Vector6::from(six(feed_forward, "feed_forward", [0.0; 6])?),
            posture: exactly(&posture, "posture")?,
        });
        Ok(command(arm, width, force))
    }

    fn __repr__(&self) -> String {
        let kind = match self.inner.arm {
            ArmCommand::JointPositions(_) => "joint_positions",
            ArmCommand::JointVelocities(_) => "joint_velocities",
            ArmCommand::JointTorques(_) => "joint_torques",
            ArmCommand::CartesianPose(_) => "pose",
            ArmCommand::CartesianImpedance(_) => "impedance",
        };
        let GripperCommand { width, force } = self.inner.gripper;
        format!("Command.{kind}(…, width={width}, force={force})")
    }
}

/// Observation of the robot at the end of a control period.
#[pyclass(frozen, module = "ramp")]
pub struct Observation {
    pub inner: Seen,
}

#[pymethods]
impl Observation {
    /// Robot time since the start of the episode, s.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time
    }

    /// Joint positions, rad, shape (7,).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.positions.to_vec().into_pyarray(py)
    }

    /// Joint velocities, rad/s, shape (7,).
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.velocities.to_vec().into_pyarray(py)
    }

    /// Joint torques on top of gravity compensation, N·m, shape (7,).
    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.torques.to_vec().into_pyarray(py)
    }

    /// Position of the tip in the world, m, shape (3,).
    #[getter]
    fn tip_position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.x_wt.translation.vector.as_slice().to_vec().into_pyarray(py)
    }

    /// Rotation of the tip in the world, quaternion w, x, y, z, shape (4,): z out of the hand, y along the
    /// closing direction.
    #[getter]
    fn tip_quat_wxyz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        seven(&self.inner.x_wt)[3..].to_vec().into_pyarray(py)
    }

    /// Wrench of the hand on the world at the wrist, axes of the world: force in N, moment in N·m, shape
    /// (6,).
    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.wrench.as_slice().to_vec().into_pyarray(py)
    }

    /// Distance between the two fingers, m.
    #[getter]
    fn width(&self) -> f64 {
        self.inner.width
    }

    /// Whether the gripper is still at what it was commanded last.
    #[getter]
    fn gripper_busy(&self) -> bool {
        self.inner.gripper_busy
    }

    /// Force of each finger on the object that it touches, N, axes of the tip, shape (2, 3); `None` for
    /// fingers without tactile sensors.
    #[getter]
    fn touch_force<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let rows = |touch: Touch| touch.fingers.map(|finger| finger.force.as_slice().to_vec()).to_vec();
        Ok(self.inner.touch.map(|touch| PyArray2::from_vec2(py, &rows(touch))).transpose()?)
    }

    /// Centre of pressure of each finger: x and z from the tip, m, shape (2, 2). NaN where the finger presses
    /// too lightly; `None` for fingers without tactile sensors.
    #[getter]
    fn touch_centre<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let row = |finger: FingerTouch| finger.centre.unwrap_or([f64::NAN; 2]).to_vec();
        let rows = |touch: Touch| touch.fingers.map(row).to_vec();
        Ok(self.inner.touch.map(|touch| PyArray2::from_vec2(py, &rows(touch))).transpose()?)
    }

    fn __repr__(&self) -> String {
        let p = self.inner.x_wt.translation.vector;
        format!(
            "Observation(time={:.3}, tip_position=[{:.4}, {:.4}, {:.4}], width={:.4})",
            self.inner.time, p.x, p.y, p.z, self.inner.width
        )
    }
}

/// An image of a camera.
#[pyclass(frozen, module = "ramp")]
pub struct CameraImage {
    inner: Image,
}

impl From<Image> for CameraImage {
    fn from(inner: Image) -> CameraImage {
        CameraImage { inner }
    }
}

#[pymethods]
impl CameraImage {
    /// Name of the camera.
    #[getter]
    fn camera(&self) -> &'static str {
        self.inner.camera.name()
    }

    /// Robot time in the middle of the exposure, s.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time
    }

    /// Red, green and blue of each pixel, gamma 2.2, shape (height, width, 3), uint8: (800, 1280, 3)
    /// without a size.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        picture(py, self.inner.pixels.clone(), [self.inner.height, self.inner.width])
    }

    /// On the track ``depth``: the measured distance along the optical axis in each pixel, in 0.1 mm, 0 where
    /// there is none, shape (height, width), uint16; ``None`` on other tracks.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u16>>>> {
        let shape = [self.inner.height, self.inner.width];
        self.inner.depth.as_ref().map(|depth| depth.to_pyarray(py).reshape(shape)).transpose()
    }

    /// Pose of the tip in the world at that moment: x, y, z in m, quaternion w, x, y, z, shape (7,).
    #[getter]
    fn tip<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        seven(&self.inner.x_wt).into_pyarray(py)
    }
}
