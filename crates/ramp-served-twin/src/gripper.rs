//! The gripper's service, version 3 of its protocol: one command at a time, and the width ten times a second.

use std::net::{SocketAddr, UdpSocket};

use franka::wire::gripper::{
    GRIPPER_VERSION, GraspRequest, GripperCommand as Kind, GripperMoveRequest, GripperState, GripperStatus,
};
use ramp_robot::{GripperCommand, Observation};
use zerocopy::little_endian::{F64, U16, U32};
use zerocopy::{FromBytes, IntoBytes};

use crate::plant::Plant;
use crate::session::{Message, Request, Session};

/// Fingers that move less than this in a period are still, m.
const STILL: f64 = 2e-6;
/// Number of still periods after which a command is done. Chosen: a rib that slides into a slot pauses.
const STILL_PERIODS: u32 = 60;
/// Periods between two reports of the width. libfranka's documentation: about ten a second.
pub(crate) const REPORT_EVERY: u64 = 100;
/// The width of the open gripper, m, and the largest force of a grasp, N. From the hand's manual.
const OPEN: f64 = 0.08;
const MOST_FORCE: f64 = 140.0;
/// The force with which fingers move to a width, N.
const MOVE_FORCE: f64 = 20.0;
/// A temperature to report, °C.
const TEMPERATURE: u16 = 30;

/// A command that is not done yet.
struct Running {
    command: u32,
    id: u32,
    still: u32,
    width: f64,
    /// Width and tolerances of a grasp, m.
    grasp: Option<[f64; 3]>,
}

/// The gripper of a plant, for one client.
#[derive(Default)]
pub(crate) struct Gripper {
    client: Option<Session>,
    message: u32,
    running: Option<Running>,
}

impl Gripper {
    /// Takes a client. A second one is refused.
    pub fn connect(&mut self, client: Session) {
        if self.client.is_none() {
            self.client = Some(client);
        }
    }

    /// Whether a command is being carried out.
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// Answers what the client asks. Returns whether it asked anything.
    pub fn listen(&mut self, plant: &mut Plant) -> bool {
        let mut any = false;
        while let Some(client) = &mut self.client {
            match client.next() {
                Message::Request(request) => {
                    any = true;
                    self.request(plant, &request);
                }
                Message::Nothing => break,
                Message::Closed => {
                    self.client = None;
                    self.running = None;
                    return true;
                }
            }
        }
        any
    }

    fn request(&mut self, plant: &mut Plant, request: &Request) {
        let running =
            |grasp| Some(Running { command: request.command, id: request.id, still: 0, width: -1.0, grasp });
        match u16::try_from(request.command).ok().and_then(Kind::from_u16) {
            Some(Kind::Connect) => {
                let port = request.payload.get(2..).and_then(|rest| U16::read_from_prefix(rest).ok());
                let (Some((port, _)), Some(client)) = (port, &mut self.client) else { return };
                client.send_states_to(port.get());
                let [low, high] = GRIPPER_VERSION.to_le_bytes();
                client.answer(request.command, request.id, &[0, 0, low, high]);
            }
            Some(Kind::Homing) => {
                plant.gripper = GripperCommand { width: OPEN, force: MOVE_FORCE };
                self.running = running(None);
            }
            Some(Kind::Move) => match GripperMoveRequest::read_from_bytes(&request.payload) {
                Ok(wanted) if (0.0..=OPEN).contains(&wanted.width.get()) => {
                    plant.gripper = GripperCommand { width: wanted.width.get(), force: MOVE_FORCE };
                    self.running = running(None);
                }
                _ => self.answer(request.command, request.id, GripperStatus::Fail),
            },
            Some(Kind::Grasp) => match GraspRequest::read_from_bytes(&request.payload) {
                Ok(wanted) if (0.0..=OPEN).contains(&wanted.width.get()) && wanted.force.get() > 0.0 => {
                    let force = wanted.force.get().min(MOST_FORCE);
                    plant.gripper = GripperCommand { width: wanted.width.get(), force };
                    let tolerance = [&wanted.width, &wanted.epsilon_inner, &wanted.epsilon_outer];
                    self.running = running(Some(tolerance.map(|value| value.get())));
                }
                _ => self.answer(request.command, request.id, GripperStatus::Fail),
            },
            Some(Kind::Stop) => {
                plant.gripper.width = plant.seen().width;
                if let Some(stopped) = self.running.take() {
                    self.answer(stopped.command, stopped.id, GripperStatus::Aborted);
                }
                self.answer(request.command, request.id, GripperStatus::Success);
            }
            None => self.answer(request.command, request.id, GripperStatus::Fail),
        }
    }

    fn answer(&mut self, command: u32, id: u32, status: GripperStatus) {
        if let Some(client) = &mut self.client {
            client.answer(command, id, U16::new(status.to_u16()).as_bytes());
        }
    }

    /// After a period: answers a command whose fingers have come to rest.
    pub fn moved(&mut self, seen: &Observation) {
        let Some(running) = &mut self.running else { return };
        running.still = if (seen.width - running.width).abs() < STILL { running.still + 1 } else { 0 };
        running.width = seen.width;
        if running.still < STILL_PERIODS || seen.gripper_busy {
            return;
        }
        let held = running
            .grasp
            .is_none_or(|[width, inner, outer]| seen.width > width - inner && seen.width < width + outer);
        let status = if held { GripperStatus::Success } else { GripperStatus::Unsuccessful };
        let (command, id) = (running.command, running.id);
        self.running = None;
        self.answer(command, id, status);
    }

    /// Reports the width.
    pub fn report(&mut self, plant: &Plant, socket: &UdpSocket) {
        let Some(to): Option<SocketAddr> = self.client.as_ref().and_then(|client| client.states) else {
            return;
        };
        self.message += 1;
        let width = plant.seen().width;
        let held = plant.gripper.width < width - 1e-3 && self.running.is_none();
        let state = GripperState {
            message_id: U32::new(self.message),
            width: F64::new(width),
            max_width: F64::new(OPEN),
            is_grasped: u8::from(held),
            temperature: U16::new(TEMPERATURE),
        };
        // A client that has gone is noticed by its connection.
        let _ = socket.send_to(state.as_bytes(), to);
    }
}
