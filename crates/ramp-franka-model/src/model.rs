//! Kinematics and dynamics of the Panda without its hand, in the arguments of Franka's functions.

use std::path::Path;
use std::sync::LazyLock;

use nalgebra::{Isometry3, Matrix3, Matrix4, SMatrix, Translation3, UnitQuaternion, Vector3};
use ramp_motion::{Dynamics, Inertia, Joints, Kinematics};
use ramp_robot::DOF;
use ramp_robot::arm::{ArmModel, FLANGE};

/// The arm file.
const ARM: &str = include_str!("../../../data/arms/panda.json");

/// The arm, read at the first call.
pub(crate) static PANDA: LazyLock<Panda> =
    LazyLock::new(|| match ArmModel::from_json(Path::new("panda.json"), ARM) {
        Ok(arm) => Panda { kinematics: Kinematics::new(&arm), dynamics: Dynamics::without_hand(&arm) },
        Err(error) => unreachable!("the arm file of the build is refused: {error}"),
    });

/// A frame of the arm.
#[derive(Clone, Copy)]
pub(crate) enum Frame {
    /// Of a joint, counted from zero.
    Joint(usize),
    Flange,
    /// Of the end effector, whose pose at the flange is given.
    EndEffector(Isometry3<f64>),
}

/// The axes in which a Jacobian is expressed.
#[derive(Clone, Copy)]
pub(crate) enum Axes {
    /// Of the base.
    Base,
    /// Of the frame itself.
    Frame,
}

/// What the last link carries, in the frame of the flange.
pub(crate) struct Load<'a> {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: &'a [f64; 3],
    /// Inertia about the centre of mass, column by column, kg·m².
    pub inertia: &'a [f64; 9],
}

/// The arm without its hand: a client adds what the last link carries.
pub(crate) struct Panda {
    kinematics: Kinematics,
    dynamics: Dynamics,
}

impl Panda {
    /// The pose of a frame in the base at joint positions `q` (rad).
    pub fn pose(&self, q: &[f64; DOF], frame: Frame) -> Isometry3<f64> {
        frame.pose(&self.kinematics.frames(&Joints::from(*q)).links)
    }

    /// The Jacobian of a frame's origin, linear above, angular below.
    pub fn jacobian(&self, q: &[f64; DOF], frame: Frame, axes: Axes) -> SMatrix<f64, 6, DOF> {
        let mut frames = self.kinematics.frames(&Joints::from(*q));
        frames.tip = frame.pose(&frames.links);
        let mut jacobian = self.kinematics.jacobian(&frames);
        // The joints beyond a link do not move it.
        if let Frame::Joint(joint) = frame {
            jacobian.columns_mut(joint + 1, DOF - joint - 1).fill(0.0);
        }
        if let Axes::Frame = axes {
            let turn = frames.tip.rotation.inverse().to_rotation_matrix();
            for row in [0, 3] {
                let turned = turn * jacobian.fixed_rows::<3>(row);
                jacobian.fixed_rows_mut::<3>(row).copy_from(&turned);
            }
        }
        jacobian
    }

    /// The joint-space inertia with `load`, without that of the drives, kg·m².
    pub fn inertia(&self, q: &[f64; DOF], load: &Load) -> SMatrix<f64, DOF, DOF> {
        self.carrying(load).at(&Joints::from(*q)).inertia()
    }

    /// The Coriolis and centrifugal torques at velocities `dq` (rad/s), N·m.
    pub fn coriolis(&self, q: &[f64; DOF], dq: &[f64; DOF], load: &Load) -> Joints {
        self.carrying(load).at(&Joints::from(*q)).moving(&Joints::from(*dq), &Joints::zeros())
    }

    /// The torques that hold the arm up against `gravity` (m/s², in the base), N·m.
    pub fn gravity(&self, q: &[f64; DOF], gravity: &[f64; 3], load: &Load) -> Joints {
        self.carrying(load).at(&Joints::from(*q)).holding_against(&Vector3::from(*gravity))
    }

    fn carrying(&self, load: &Load) -> Dynamics {
        // The flange has the axes of the last joint's frame.
        let body = Inertia {
            mass: load.mass,
            centre: Vector3::from(*load.centre) + Vector3::new(0.0, 0.0, FLANGE),
            moment: Matrix3::from_column_slice(load.inertia),
        };
        self.dynamics.clone().ending_in(&body)
    }
}

impl Frame {
    /// The end effector whose pose at the flange is this matrix, column by column.
    pub fn end_effector(f_t_ee: &[f64; 16]) -> Frame {
        let matrix = Matrix4::from_column_slice(f_t_ee);
        let turn = UnitQuaternion::from_matrix(&matrix.fixed_view::<3, 3>(0, 0).into_owned());
        let origin = Translation3::from(matrix.fixed_view::<3, 1>(0, 3).into_owned());
        Frame::EndEffector(Isometry3::from_parts(origin, turn))
    }

    fn pose(self, links: &[Isometry3<f64>; DOF]) -> Isometry3<f64> {
        let flange = links[DOF - 1] * Translation3::new(0.0, 0.0, FLANGE);
        match self {
            Frame::Joint(joint) => links[joint],
            Frame::Flange => flange,
            Frame::EndEffector(x_fe) => flange * x_fe,
        }
    }
}
