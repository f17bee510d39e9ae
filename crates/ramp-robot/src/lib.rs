//! The seam between an agent and a robot: traits and plain types, nothing else.
//!
//! An agent sends a [`Command`] and gets an [`Observation`], once for each control period of a millisecond;
//! the inner loop runs inside the robot. The same agent drives the twin and a real arm. What it may learn of
//! the parts is decided by the [`Track`] it is judged on.

mod action;
mod agent;
pub mod arm;
pub mod camera;
pub mod cause;
mod command;
mod error;
mod event;
mod fault;
mod gravity;
pub mod limits;
mod observation;
mod older_event;
mod pose;
pub mod random;
mod robot;
mod time;
mod touch;
mod track;

pub use action::{Action, Argument};
pub use agent::{Account, Agent, BASELINE, BLIND_TAPE, is_reserved};
pub use arm::DOF;
pub use camera::{Camera, CameraModel, DEPTH_UNIT, Image, ImageWidth};
pub use cause::Cause;
pub use command::{ArmCommand, Command, GripperCommand, Impedance};
pub use error::RobotError;
pub use event::{Event, EventKind, MOST_EVENT, MOST_EVENTS, Retry, Search, Surface};
pub use fault::Fault;
pub use gravity::GRAVITY;
pub use observation::{Observation, PartReading};
pub use older_event::OLDER_KINDS;
pub use pose::Pose;
pub use robot::{MOST_EXPOSURES, Robot};
pub use time::{PERIOD, TIME_LIMIT};
pub use touch::{FingerTouch, Touch};
pub use track::Track;
