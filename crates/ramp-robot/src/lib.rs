//! The seam between an agent and a robot: traits and plain types, nothing else.
//!
//! An agent sends a [`Command`] and gets an [`Observation`], once per control period of a
//! millisecond; the inner loop runs inside the robot. The same agent drives the twin and a real
//! arm. The [`Track`] decides how the agent may observe the parts.

mod agent;
pub mod arm;
pub mod camera;
pub mod cause;
mod command;
mod error;
pub mod limits;
mod observation;
mod pose;
pub mod random;
mod robot;
mod time;
mod track;

pub use agent::{Account, Agent, Event};
pub use arm::DOF;
pub use camera::{Camera, CameraModel, Image};
pub use cause::Cause;
pub use command::{ArmCommand, Command, GripperCommand, Impedance};
pub use error::RobotError;
pub use observation::{Observation, PartReading};
pub use pose::Pose;
pub use robot::{MOST_EXPOSURES, Robot};
pub use time::{PERIOD, TIME_LIMIT};
pub use track::Track;
