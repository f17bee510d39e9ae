//! The datagrams of each cycle: the state of the arm, and one command.

use franka::FciVersion;
use franka::wire::robot::{v5, v10};
use ramp_robot::{DOF, GRAVITY};
use zerocopy::little_endian::{F32, F64, U64};
use zerocopy::{FromBytes, IntoBytes};

/// A matrix of a pose without shift and turn, column by column.
pub(crate) const IDENTITY: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Number of errors that a state has a flag for.
pub(crate) const ERRORS: usize = 41;

/// The state of the arm, in the protocol's words and units: m, rad, N, N·m, kg, s. Poses are matrices, column
/// by column.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub message: u64,
    pub o_t_ee: [f64; 16],
    pub f_t_ee: [f64; 16],
    pub f_t_ne: [f64; 16],
    pub ne_t_ee: [f64; 16],
    pub ee_t_k: [f64; 16],
    pub m_ee: f64,
    pub f_x_cee: [f64; 3],
    pub i_ee: [f64; 9],
    pub m_load: f64,
    pub f_x_cload: [f64; 3],
    pub i_load: [f64; 9],
    pub tau_j: [f64; DOF],
    pub tau_j_d: [f64; DOF],
    pub dtau_j: [f64; DOF],
    pub q: [f64; DOF],
    pub q_d: [f64; DOF],
    pub dq: [f64; DOF],
    pub tau_ext: [f64; DOF],
    pub o_f_ext: [f64; 6],
    pub k_f_ext: [f64; 6],
    pub joint_collision: [f64; DOF],
    pub cartesian_collision: [f64; 6],
    pub motion: u8,
    pub controller: u8,
    pub robot: u8,
    pub errors: [u8; ERRORS],
    pub reflex: [u8; ERRORS],
    pub success: f64,
}

/// The state as the struct of one version, whose numbers `$number` makes.
macro_rules! encoded {
    ($version:ident, $state:ident, $number:expr) => {{
        let number = $number;
        let elbow = [$state.q[2], if $state.q[3] < 0.0 { -1.0 } else { 1.0 }].map(number);
        $version::RobotState {
            message_id: U64::new($state.message),
            O_T_EE: $state.o_t_ee.map(number),
            O_T_EE_d: $state.o_t_ee.map(number),
            O_T_EE_c: $state.o_t_ee.map(number),
            F_T_EE: $state.f_t_ee.map(number),
            F_T_NE: $state.f_t_ne.map(number),
            NE_T_EE: $state.ne_t_ee.map(number),
            EE_T_K: $state.ee_t_k.map(number),
            m_ee: number($state.m_ee),
            F_x_Cee: $state.f_x_cee.map(number),
            I_ee: $state.i_ee.map(number),
            m_load: number($state.m_load),
            F_x_Cload: $state.f_x_cload.map(number),
            I_load: $state.i_load.map(number),
            elbow,
            elbow_d: elbow,
            elbow_c: elbow,
            tau_J: $state.tau_j.map(number),
            tau_J_d: $state.tau_j_d.map(number),
            dtau_J: $state.dtau_j.map(number),
            q: $state.q.map(number),
            q_d: $state.q_d.map(number),
            dq: $state.dq.map(number),
            theta: $state.q.map(number),
            dtheta: $state.dq.map(number),
            tau_ext_hat_filtered: $state.tau_ext.map(number),
            O_F_ext_hat_K: $state.o_f_ext.map(number),
            K_F_ext_hat_K: $state.k_f_ext.map(number),
            joint_collision: $state.joint_collision.map(number),
            joint_contact: $state.joint_collision.map(number),
            cartesian_collision: $state.cartesian_collision.map(number),
            cartesian_contact: $state.cartesian_collision.map(number),
            O_ddP_O: [0.0, 0.0, -GRAVITY].map(number),
            motion_generator_mode: $state.motion,
            controller_mode: $state.controller,
            robot_mode: $state.robot,
            errors: $state.errors,
            reflex_reason: $state.reflex,
            control_command_success_rate: number($state.success),
            ..Default::default()
        }
        .as_bytes()
        .to_vec()
    }};
}

impl State {
    /// The datagram.
    pub fn bytes(&self, version: FciVersion) -> Vec<u8> {
        match version {
            FciVersion::V5 => encoded!(v5, self, F64::new),
            FciVersion::V10 => encoded!(v10, self, |value: f64| F32::new(value as f32)),
        }
    }
}

/// The command of a client for one cycle.
#[derive(Clone, Debug)]
pub(crate) struct Commanded {
    /// The number of the state that it answers.
    pub message: u64,
    /// N·m, on top of those that hold the arm up.
    pub torques: [f64; DOF],
    /// Whether the motion ends with it.
    pub finished: bool,
}

impl Commanded {
    /// The command of a datagram; `None` if it is none.
    pub fn read(version: FciVersion, bytes: &[u8]) -> Option<Commanded> {
        match version {
            FciVersion::V5 => {
                let command = v5::RobotCommand::read_from_bytes(bytes).ok()?;
                Some(Commanded {
                    message: command.message_id.get(),
                    torques: command.control.tau_J_d.map(F64::get),
                    finished: command.motion.motion_generation_finished != 0,
                })
            }
            FciVersion::V10 => {
                let command = v10::RobotCommand::read_from_bytes(bytes).ok()?;
                Some(Commanded {
                    message: command.message_id.get(),
                    torques: command.control.tau_J_d.map(F64::get),
                    finished: command.motion.motion_generation_finished != 0
                        || command.control.torque_command_finished != 0,
                })
            }
        }
    }
}
