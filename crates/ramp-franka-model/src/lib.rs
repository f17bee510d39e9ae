//! The model of the Panda as a shared library, for clients of Franka's protocol version 5 (FCI).
//!
//! A client of that version has no model of the arm. It downloads a library from the arm and calls its
//! functions in C: poses and Jacobians of the arm's frames, inertia, Coriolis torques, and gravity. This one
//! computes them from `data/arms/panda.json` by `ramp-motion`, as the controller of this project does.
//! `exports` has the functions, `model` the mathematics.

mod exports;
mod model;
