//! The gripper's client, without a thread of its own: it is asked in each cycle whether it is done.

use franka::network::Network;
use franka::wire::HeaderLayout;
use franka::wire::gripper::{
    GRIPPER_COMMAND_PORT, GRIPPER_VERSION, GraspRequest, GripperCommand as Kind, GripperConnectRequest,
    GripperMoveRequest, GripperState,
};
use ramp_robot::GripperCommand;
use zerocopy::IntoBytes;

use crate::error::FrankaError;

/// Speed of the fingers, m/s: the fastest of the hand.
const SPEED: f64 = 0.1;
/// Tolerance of a grasp, m: any width counts, since the agent judges it.
const ANY_WIDTH: f64 = 1.0;

/// A connected gripper.
pub(crate) struct Gripper {
    network: Network,
    /// The request that it carries out.
    running: Option<u32>,
    /// It has carried out its request, and has not reported a width since.
    unread: bool,
    /// The command that it was given last.
    given: GripperCommand,
    /// Width as it was reported last, m.
    pub width: f64,
}

impl Gripper {
    /// Connects to the gripper at `address`, `HOST` or `HOST:PORT`.
    pub fn connect(address: &str) -> Result<Gripper, FrankaError> {
        let network = Network::connect(address, GRIPPER_COMMAND_PORT, HeaderLayout::Gripper)?;
        let request = GripperConnectRequest::new(GRIPPER_VERSION, network.udp.port());
        let id = network.tcp.send_request(Kind::Connect.to_u16().into(), request.as_bytes())?;
        let answer = network.tcp.blocking_receive_response(id)?;
        // A status of two bytes comes first, the version after it.
        let [status, version] = [0, 2].map(|from| answer.get(from..from + 2).map(|it| [it[0], it[1]]));
        if status != Some([0, 0]) {
            let version = version.map_or(0, u16::from_le_bytes);
            let text = format!("the gripper speaks version {version}, this program {GRIPPER_VERSION}");
            return Err(FrankaError::Arm(text));
        }
        let first = network.blocking_receive_struct::<GripperState>()?;
        let width = first.width.get();
        Ok(Gripper {
            network,
            running: None,
            unread: false,
            given: GripperCommand { width, force: 0.0 },
            width,
        })
    }

    /// Takes what the gripper reports, and gives it the command as soon as the last one is done. Returns
    /// whether it is busy: until it has reported a width after it was done, since that which it reported
    /// before is up to a tenth of a second old.
    pub fn cycle(&mut self, command: &GripperCommand) -> Result<bool, FrankaError> {
        while let Some(state) = self.network.try_receive_struct::<GripperState>()? {
            self.width = state.width.get();
            self.unread = false;
        }
        if let Some(id) = self.running {
            self.network.tcp.throw_if_connection_closed()?;
            if self.network.tcp.try_receive_response(id)?.is_some() {
                self.running = None;
                self.unread = true;
            }
        }
        if self.running.is_none() && *command != self.given {
            let closes = command.width < self.given.width || command.force > self.given.force;
            let tcp = &self.network.tcp;
            let id = if closes {
                let request = GraspRequest::new(command.width, ANY_WIDTH, ANY_WIDTH, SPEED, command.force);
                tcp.send_request(Kind::Grasp.to_u16().into(), request.as_bytes())?
            } else {
                let request = GripperMoveRequest::new(command.width, SPEED);
                tcp.send_request(Kind::Move.to_u16().into(), request.as_bytes())?
            };
            self.given = *command;
            self.running = Some(id);
        }
        Ok(self.running.is_some() || self.unread)
    }
}
