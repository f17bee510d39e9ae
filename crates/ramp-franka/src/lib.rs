//! A Franka arm over its own protocol (FCI): an FR3 by version 10, a Panda by version 5.
//!
//! Data passes one way in each millisecond: an agent steps a [`FrankaRobot`]; its thread turns the command
//! into torques by the [`ArmController`](ramp_control::ArmController) that drives the twin, too, sends them
//! by `link`, and hands on what the arm reports. [`cell`] has what a served twin tells beside the protocol,
//! [`cameras`] are those of this computer.
//! A [`station`] file says where the arm is, and what is known of it.

pub mod cameras;
pub mod cell;
mod cell_client;
mod connection;
mod error;
mod gripper;
mod link;
mod periods;
pub mod robot;
pub mod station;
mod touch;

pub use connection::{Connection, Pace, Statistics};
pub use error::FrankaError;
pub use robot::FrankaRobot;
pub use station::Station;
pub use touch::TouchSource;
