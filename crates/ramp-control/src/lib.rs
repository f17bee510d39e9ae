//! The inner loops of an arm and its gripper: from a command to joint torques, once each millisecond.
//!
//! Pure mathematics on plain numbers: the input is the sensed state ([`ArmState`]) and the command, the
//! output are torques. [`joints`] tracks joint positions and velocities, [`impedance`](mod@impedance) holds
//! the tip to a pose like a spring, [`gripper`] moves the fingers. [`commanded`] checks that a command can
//! follow the one before, and [`smooth`] makes one that can. [`follow`] keeps the limits of motion across
//! kinds of commands. [`handover`] goes from one kind of command to another without a jump. [`compensation`]
//! adds what friction takes, and [`estimate`] computes the external wrench of an arm without a force sensor.
//! The crate does not depend on whether a simulation or a real arm provides the numbers.

pub mod commanded;
pub mod compensation;
pub mod estimate;
mod fastest;
pub mod follow;
pub mod gripper;
pub mod handover;
pub mod impedance;
pub mod joints;
pub mod smooth;
pub mod state;

pub use commanded::{JointMotion, PoseMotion};
pub use compensation::Compensation;
pub use estimate::WrenchEstimate;
pub use follow::{Followed, Follower};
pub use gripper::{FINGER_SPEED, GripperLoop};
pub use handover::{Handover, Mode, limit_rate};
pub use impedance::{impedance, pose_impedance};
pub use joints::{limit_torques, track_joints, track_velocities};
pub use smooth::Smoother;
pub use state::{ArmState, Jacobian, JointVector};
