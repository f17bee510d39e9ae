//! The inner loops of an arm and its gripper: from a command to joint torques, once each millisecond.
//!
//! [`ArmController`] is what drives an arm, the twin's or a real one: a command comes in, torques go out, and
//! what the arm reports comes back. The rest is pure mathematics on plain numbers, of which it is made:
//! [`model`] computes the arm's state ([`ArmState`]) from the joints, and [`command`] refuses numbers that
//! are none. [`joints`] tracks joint positions and velocities, [`impedance`](mod@impedance) holds
//! the tip to a pose like a spring, [`gripper`] moves the fingers. [`commanded`] checks that a command can
//! follow the one before, and [`smooth`] makes one that can. [`follow`] keeps the limits of motion across
//! kinds of commands. [`handover`] goes from one kind of command to another without a jump. [`compensation`]
//! adds what friction takes, and [`estimate`] computes the external wrench of an arm without a force sensor.
//! The crate does not depend on whether a simulation or a real arm provides the numbers.

pub mod command;
pub mod commanded;
pub mod compensation;
pub mod controller;
pub mod estimate;
mod fastest;
pub mod follow;
pub mod gripper;
pub mod handover;
pub mod impedance;
pub mod joints;
pub mod model;
pub mod smooth;
pub mod state;
mod targets;

pub use command::check_command;
pub use commanded::{JointMotion, PoseMotion};
pub use compensation::Compensation;
pub use controller::{ArmController, ControllerSettings, Interrupted, Sensed};
pub use estimate::WrenchEstimate;
pub use follow::{Followed, Follower};
pub use gripper::{FINGER_SPEED, GripperLoop};
pub use handover::{Handover, Mode, limit_rate};
pub use impedance::{impedance, pose_impedance};
pub use joints::{limit_torques, track_joints, track_velocities};
pub use model::StateModel;
pub use smooth::Smoother;
pub use state::{ArmState, Jacobian, JointVector};
