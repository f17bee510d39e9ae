//! Motion planning: an arm model becomes kinematics, collision-free paths and timed trajectories.
//!
//! Data passes one way: [`kinematics`] turns joint positions into poses and back, and [`analytic`] gives every way back
//! where the arm's build allows it; [`collision`] holds what stands around the arm and what it carries; [`path`] finds a
//! joint path between two poses that keeps clear of it; [`trajectory`] times the path within the arm's limits.

pub mod analytic;
pub mod collision;
pub mod kinematics;
pub mod path;
mod space;
pub mod trajectory;

pub use analytic::Analytic;
pub use collision::{Checker, Obstacle};
pub use kinematics::Kinematics;
pub use path::{MotionError, PathPlanner};
pub use space::{Joints, Pose};
pub use trajectory::Trajectory;
