//! Motion planning: arm model to kinematics, collision-free paths and timed trajectories.
