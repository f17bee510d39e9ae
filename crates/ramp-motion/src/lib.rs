//! Motion planning: an arm model becomes kinematics, collision-free paths and timed trajectories.
//!
//! Data passes one way: [`kinematics`] turns joint positions into poses and back, and [`analytic`] gives
//! every way back where the arm's build allows it; [`collision`] has the obstacles and the held part;
//! [`path`] finds a collision-free joint path between two poses; [`time_law`] parametrises it by time within
//! the limits of the joints and, by the arm's [`dynamics`], of their torques: a [`trajectory`]. [`bound`] is
//! a lower bound on the time of any motion.

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
