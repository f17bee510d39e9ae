//! The served twin, driven by clients of Franka's protocol over the loopback interface.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod arm;
mod cell;
mod faults;
mod model;
mod served;
