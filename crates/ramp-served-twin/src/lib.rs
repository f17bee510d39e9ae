//! The served twin: the twin behind Franka's protocol (FCI), version 10 of an FR3 or 5 of a Panda.
//!
//! Any client of the protocol drives it as a real arm: the arm's service, the gripper's at the next port, and
//! the cell (parts, images) at the one after. Data passes one way in each cycle:
//! `session` takes requests, `arm_service` and `gripper` answer them, `motion` decides which torques act,
//! `plant` lets the twin do a millisecond, and [`server`] sends the `state`. `images` are drawn and sent
//! beside that, in a thread of their own.

mod arm_service;
mod cell;
mod gripper;
mod images;
mod motion;
mod plant;
pub mod server;
mod session;
mod state;
mod urdf;

pub use franka::FciVersion;
pub use server::{Options, Pace, Server, Statistics, Verdict};
