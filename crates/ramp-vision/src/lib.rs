//! Perception.
