//! The arm's service: requests of its client, in the numbers of both versions.

use franka::wire::robot::{v5, v10};
use franka::wire::{ROBOT_VERSION, f64s_to_f64};
use franka::{FciVersion, MoveStatus};
use ramp_robot::PERIOD;
use zerocopy::little_endian::{F64, U32};
use zerocopy::{FromBytes, IntoBytes};

use crate::motion::{CONTROLLER_EXTERNAL, Doing, Generator, Motion, robot_mode, status};
use crate::plant::columns;
use crate::server::Server;
use crate::session::Request;
use crate::state::ERRORS;

/// A request that was done, and one that cannot be: what most requests are answered with.
const DONE: u8 = 0;
const REJECTED: u8 = 1;

/// The request, whatever the version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Connect,
    Move,
    StopMove,
    GetCartesianLimit,
    SetCollisionBehaviour,
    SetJointImpedance,
    SetCartesianImpedance,
    SetGuidingMode,
    SetTipOfStiffness,
    SetEndEffector,
    SetLoad,
    SetFilters,
    Recover,
    LoadModelLibrary,
    GetRobotModel,
}

/// The requests of version 5, in the order of their numbers.
const OF_V5: [Kind; 14] = [
    Kind::Connect,
    Kind::Move,
    Kind::StopMove,
    Kind::GetCartesianLimit,
    Kind::SetCollisionBehaviour,
    Kind::SetJointImpedance,
    Kind::SetCartesianImpedance,
    Kind::SetGuidingMode,
    Kind::SetTipOfStiffness,
    Kind::SetEndEffector,
    Kind::SetLoad,
    Kind::SetFilters,
    Kind::Recover,
    Kind::LoadModelLibrary,
];
/// The requests of version 10.
const OF_V10: [Kind; 12] = [
    Kind::Connect,
    Kind::Move,
    Kind::StopMove,
    Kind::SetCollisionBehaviour,
    Kind::SetJointImpedance,
    Kind::SetCartesianImpedance,
    Kind::SetGuidingMode,
    Kind::SetTipOfStiffness,
    Kind::SetEndEffector,
    Kind::SetLoad,
    Kind::Recover,
    Kind::GetRobotModel,
];

impl Server {
    /// Answers a request.
    pub(crate) fn request(&mut self, request: &Request) {
        let kinds: &[Kind] = match self.options.version {
            FciVersion::V5 => &OF_V5,
            FciVersion::V10 => &OF_V10,
        };
        let Request { command, id, payload } = request;
        let kind = usize::try_from(*command).ok().and_then(|command| kinds.get(command));
        match kind {
            Some(Kind::Connect) => self.connect(request),
            Some(Kind::Move) => self.begin_motion(request),
            Some(Kind::StopMove) => self.stop_motion(request),
            Some(
                Kind::SetCollisionBehaviour | Kind::SetTipOfStiffness | Kind::SetEndEffector | Kind::SetLoad,
            ) => {
                let done = kind.is_some_and(|kind| self.set(*kind, payload));
                self.answer(*command, *id, &[if done { DONE } else { REJECTED }]);
            }
            Some(
                Kind::SetJointImpedance
                | Kind::SetCartesianImpedance
                | Kind::SetGuidingMode
                | Kind::SetFilters,
            ) => self.answer(*command, *id, &[DONE]),
            Some(Kind::Recover) => match self.doing {
                Doing::Stopped => {
                    self.state.robot = robot_mode::RECOVERY;
                    let cycles = (self.options.recovery / PERIOD).round() as u64;
                    self.doing = Doing::Recover { cycles: cycles.max(1), command: *command, id: *id };
                }
                _ => self.answer(*command, *id, &[DONE]),
            },
            Some(Kind::GetRobotModel) => {
                let answer = [&[DONE], self.model.as_bytes()].concat();
                self.answer(*command, *id, &answer);
            }
            Some(Kind::LoadModelLibrary) => {
                let answer = match &self.options.model_library {
                    Some(library) => [&[DONE], library.as_slice()].concat(),
                    None => vec![REJECTED],
                };
                self.answer(*command, *id, &answer);
            }
            Some(Kind::GetCartesianLimit) | None => self.answer(*command, *id, &[REJECTED]),
        }
    }

    fn connect(&mut self, request: &Request) {
        let Ok((wanted, _)) = v10::ConnectRequest::read_from_prefix(&request.payload) else { return };
        let own = match self.options.version {
            FciVersion::V5 => v5::ROBOT_VERSION,
            FciVersion::V10 => ROBOT_VERSION,
        };
        let same = wanted.version.get() == own;
        if same && let Some(client) = &mut self.client {
            client.send_states_to(wanted.udp_port.get());
        }
        let status =
            if same { v10::ConnectStatus::Success } else { v10::ConnectStatus::IncompatibleLibraryVersion };
        let answer = v10::ConnectResponse::new(status, own);
        self.answer(request.command, request.id, answer.as_bytes());
    }

    /// Begins a motion under torques. The motion generators of the arm's own controller are not served; a
    /// client of version 5 sends torques together with joint velocities of zero, as that has no motion
    /// without a generator.
    fn begin_motion(&mut self, request: &Request) {
        let Request { command, id, payload } = request;
        let Ok((controller, rest)) = U32::read_from_prefix(payload) else { return };
        let Ok((generator, _)) = U32::read_from_prefix(rest) else { return };
        let number = generator.get();
        let generator = usize::try_from(number).ok().and_then(|index| Generator::ALL.get(index).copied());
        let carrier = match self.options.version {
            FciVersion::V5 => Generator::JointVelocity,
            FciVersion::V10 => Generator::None,
        };
        let external = controller.get() == CONTROLLER_EXTERNAL;
        if !matches!(self.doing, Doing::Rest) || !external || generator != Some(carrier) {
            let asked = generator.map_or("an unknown generator", Generator::name);
            if !external || generator != Some(carrier) {
                self.say(&format!("a motion by {asked} is refused: only torques are served"));
            }
            let rejected = status(self.options.version, MoveStatus::CommandNotPossibleRejected);
            return self.answer(*command, *id, &[rejected]);
        }
        // A state counts the generators from one.
        self.state.motion = u8::try_from(number + 1).unwrap_or(0);
        self.state.controller = u8::try_from(controller.get()).unwrap_or(0);
        self.state.robot = robot_mode::MOVE;
        self.state.errors = [0; ERRORS];
        self.doing = Doing::Move(Motion::new(*command, *id));
        self.answer(*command, *id, &[MoveStatus::MotionStarted.to_u8()]);
    }

    fn stop_motion(&mut self, request: &Request) {
        let motion = match &self.doing {
            Doing::Move(motion) => Some((motion.command, motion.id)),
            _ => None,
        };
        if motion.is_some() {
            self.rest(Doing::Rest, robot_mode::IDLE);
        }
        self.answer(request.command, request.id, &[DONE]);
        if let Some((command, id)) = motion {
            self.answer(command, id, &[MoveStatus::Preempted.to_u8()]);
        }
    }

    /// Sets what the arm is told of itself. Returns whether the request was one.
    fn set(&mut self, kind: Kind, payload: &[u8]) -> bool {
        match kind {
            Kind::SetCollisionBehaviour => {
                let Ok(set) = v10::SetCollisionBehaviorRequest::read_from_bytes(payload) else {
                    return false;
                };
                self.most_torque = f64s_to_f64(&set.upper_torque_thresholds_nominal);
                self.most_force = f64s_to_f64(&set.upper_force_thresholds_nominal);
            }
            Kind::SetTipOfStiffness => {
                let Ok(set) = v10::SetEEToKRequest::read_from_bytes(payload) else { return false };
                self.state.ee_t_k = set.EE_T_K.map(F64::get);
            }
            Kind::SetEndEffector => {
                let Ok(set) = v10::SetNEToEERequest::read_from_bytes(payload) else { return false };
                self.state.ne_t_ee = set.NE_T_EE.map(F64::get);
                let matrix = |columns: &[f64; 16]| nalgebra::Matrix4::from_column_slice(columns);
                self.state.f_t_ee = columns(&(matrix(&self.state.f_t_ne) * matrix(&self.state.ne_t_ee)));
            }
            Kind::SetLoad => {
                let Ok(set) = v10::SetLoadRequest::read_from_bytes(payload) else { return false };
                self.state.m_load = set.m_load.get();
                self.state.f_x_cload = set.F_x_Cload.map(F64::get);
                self.state.i_load = set.I_load.map(F64::get);
            }
            _ => return false,
        }
        true
    }
}
