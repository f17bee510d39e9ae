//! The arm of the twin as its controller cabinet knows it: torques in, and what goes into the state out.

use nalgebra::{Isometry3, Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3};
use ramp_motion::Inertia;
use ramp_robot::arm::{ArmModel, FLANGE};
use ramp_robot::{DOF, GripperCommand, Observation, Robot, RobotError};
use ramp_twin::Twin;

use crate::state::State;

/// The twin, with the command that its gripper holds.
pub(crate) struct Plant {
    pub twin: Twin,
    arm: ArmModel,
    pub gripper: GripperCommand,
}

impl Plant {
    /// Serves this twin.
    pub fn new(twin: Twin, arm: &ArmModel) -> Plant {
        let gripper = GripperCommand { width: twin.observe().width, force: 20.0 };
        Plant { twin, arm: arm.clone(), gripper }
    }

    /// One millisecond under these torques (N·m), or, without any, at rest.
    ///
    /// # Errors
    /// The limit that was passed.
    pub fn step(&mut self, torques: Option<&[f64; DOF]>) -> Result<(), RobotError> {
        match torques {
            Some(torques) => self.twin.actuate(torques, self.gripper),
            None => self.twin.rest(self.gripper),
        }
    }

    /// What the arm reports now.
    pub fn seen(&self) -> Observation {
        self.twin.observe()
    }

    /// Puts what the arm reports into the state.
    pub fn tell(&self, state: &mut State) {
        let seen = self.twin.observe();
        let report = self.twin.joint_report();
        let before = state.tau_j;
        state.q = seen.positions;
        state.dq = seen.velocities;
        state.tau_j = std::array::from_fn(|joint| seen.torques[joint] + report.weight[joint]);
        state.dtau_j = std::array::from_fn(|joint| (state.tau_j[joint] - before[joint]) * 1e3);
        state.tau_ext = report.external;
        // The twin tells the wrench at the wrist, Franka at the tip.
        let lever = seen.x_wt.rotation * Vector3::z() * self.arm.hand.tip;
        let force = Vector3::new(seen.wrench[0], seen.wrench[1], seen.wrench[2]);
        let moment = Vector3::new(seen.wrench[3], seen.wrench[4], seen.wrench[5]) - lever.cross(&force);
        let turn = seen.x_wt.rotation.inverse();
        for (from, vector) in [(0, force), (3, moment)] {
            state.o_f_ext[from..from + 3].copy_from_slice(vector.as_slice());
            state.k_f_ext[from..from + 3].copy_from_slice((turn * vector).as_slice());
        }
        let tip = seen.x_wt.to_homogeneous();
        state.o_t_ee = columns(&(tip * Matrix4::from_column_slice(&state.ne_t_ee)));
        state.q_d = state.q;
    }

    /// The hand with its fingers closed, in the flange's frame.
    pub fn end_effector(&self) -> Inertia {
        let hand = Inertia::of_hand(&self.arm);
        // The flange has the axes of the last joint's frame.
        Inertia { centre: hand.centre - Vector3::new(0.0, 0.0, FLANGE), ..hand }
    }

    /// The tip's frame in the flange's.
    pub fn f_t_tip(&self) -> [f64; 16] {
        let tip = Translation3::new(0.0, 0.0, self.arm.hand.tip);
        columns(&(self.hand_at_flange() * tip).to_homogeneous())
    }

    fn hand_at_flange(&self) -> Isometry3<f64> {
        let [w, x, y, z] = self.arm.hand.quat_wxyz;
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let shift = Translation3::new(0.0, 0.0, self.arm.hand.position[2] - FLANGE);
        Isometry3::from_parts(shift, turn)
    }
}

/// A matrix, column by column.
pub(crate) fn columns(matrix: &Matrix4<f64>) -> [f64; 16] {
    let mut columns = [0.0; 16];
    columns.copy_from_slice(matrix.as_slice());
    columns
}
