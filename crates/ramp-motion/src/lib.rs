//! Motion planning: an arm model becomes kinematics, collision-free paths and timed trajectories.
//!
//! Data passes one way: [`kinematics`] turns joint positions into poses and back, and [`analytic`] gives every way back
//! where the arm's build allows it; [`collision`] holds what stands around the arm and what it carries; [`path`] finds a
//! joint path between two poses that keeps clear of it; [`time_law`] says when the arm is where on it, within its limits
//! and, by its [`dynamics`], those of its torques: a [`trajectory`]. [`bound`] tells what no motion can be quicker than.

pub mod analytic;
pub mod bound;
pub mod collision;
pub mod dynamics;
pub mod kinematics;
pub mod path;
mod random_tree;
mod space;
mod spline;
pub mod time_law;
pub mod trajectory;

pub use analytic::Analytic;
pub use bound::least_time_over;
pub use collision::{Checker, Obstacle};
pub use dynamics::{Dynamics, Inertia};
pub use kinematics::Kinematics;
pub use path::{MotionError, PathPlanner, Terms};
pub use space::{Joints, Pose};
pub use time_law::{Pace, TimeLaw};
pub use trajectory::Trajectory;
