//! Gravity.

/// Acceleration of free fall, m/s²: the value with which the physics engine and Franka's own library compute.
pub const GRAVITY: f64 = 9.81;
