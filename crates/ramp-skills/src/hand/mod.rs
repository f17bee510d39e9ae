//! The hand: the only room that talks to the robot. It follows trajectories, moves in straight lines under
//! impedance, opens and closes the gripper, and measures forces. Every motion is guarded: at a force larger
//! than any skill needs it stops.

pub mod access;
mod compliance;
mod dead_time;
mod felt;
pub mod force;
mod gripper;
mod speed_profile;
mod straight;
mod trajectory;
pub mod trim;

pub use access::{Arrival, Hand, Held};
pub use force::Rise;
