//! The thirty functions, by the names and arguments that Franka's client library looks for.
//!
//! Frames are counted from 1: seven joints, the flange (8) and the end effector (9). `O_T_Ji` is the pose of
//! frame i in the base, `O_J_Ji` its Jacobian in the axes of the base and `Ji_J_Ji` in its own; `M_NE` is the
//! inertia, `c_NE` the Coriolis torques, and `g_NE` gravity. Matrices are written column by column. Units
//! are m, rad, kg, N and s. Arguments are as in `libfcimodels.h` of libfranka 0.9: arrays of a fixed length,
//! and the last one is written.

// Names and a way to call them that a program in C finds. A caller in C hands over arrays of these lengths;
// no pointer is used in another way.
#![allow(unsafe_code, reason = "a function with a name for the linker counts as unsafe")]
#![allow(non_snake_case, reason = "Franka's names")]

use crate::model::{Axes, Frame, Load, PANDA};

/// Joint positions or velocities, rad and rad/s.
type Joints = [f64; 7];
/// A pose, as a matrix of 4 by 4.
type Pose = [f64; 16];
/// A matrix of 6 by 7.
type Jacobian = [f64; 42];

fn pose(q: &Joints, frame: Frame, out: &mut Pose) {
    out.copy_from_slice(PANDA.pose(q, frame).to_homogeneous().as_slice());
}

fn jacobian(q: &Joints, frame: Frame, axes: Axes, out: &mut Jacobian) {
    out.copy_from_slice(PANDA.jacobian(q, frame, axes).as_slice());
}

/// Pose and Jacobians of one frame.
macro_rules! frame {
    ($frame:expr, $pose:ident, $in_base:ident, $in_frame:ident) => {
        #[unsafe(no_mangle)]
        extern "C" fn $pose(q: &Joints, out: &mut Pose) {
            pose(q, $frame, out);
        }

        #[unsafe(no_mangle)]
        extern "C" fn $in_base(q: &Joints, out: &mut Jacobian) {
            jacobian(q, $frame, Axes::Base, out);
        }

        #[unsafe(no_mangle)]
        extern "C" fn $in_frame(q: &Joints, out: &mut Jacobian) {
            jacobian(q, $frame, Axes::Frame, out);
        }
    };
}

frame!(Frame::Joint(1), O_T_J2, O_J_J2, Ji_J_J2);
frame!(Frame::Joint(2), O_T_J3, O_J_J3, Ji_J_J3);
frame!(Frame::Joint(3), O_T_J4, O_J_J4, Ji_J_J4);
frame!(Frame::Joint(4), O_T_J5, O_J_J5, Ji_J_J5);
frame!(Frame::Joint(5), O_T_J6, O_J_J6, Ji_J_J6);
frame!(Frame::Joint(6), O_T_J7, O_J_J7, Ji_J_J7);
frame!(Frame::Flange, O_T_J8, O_J_J8, Ji_J_J8);

#[unsafe(no_mangle)]
extern "C" fn O_T_J1(q: &Joints, out: &mut Pose) {
    pose(q, Frame::Joint(0), out);
}

/// The first joint's Jacobians do not depend on the positions.
#[unsafe(no_mangle)]
extern "C" fn O_J_J1(out: &mut Jacobian) {
    jacobian(&[0.0; 7], Frame::Joint(0), Axes::Base, out);
}

#[unsafe(no_mangle)]
extern "C" fn Ji_J_J1(out: &mut Jacobian) {
    jacobian(&[0.0; 7], Frame::Joint(0), Axes::Frame, out);
}

#[unsafe(no_mangle)]
extern "C" fn O_T_J9(q: &Joints, f_t_ee: &Pose, out: &mut Pose) {
    pose(q, Frame::end_effector(f_t_ee), out);
}

#[unsafe(no_mangle)]
extern "C" fn O_J_J9(q: &Joints, f_t_ee: &Pose, out: &mut Jacobian) {
    jacobian(q, Frame::end_effector(f_t_ee), Axes::Base, out);
}

#[unsafe(no_mangle)]
extern "C" fn Ji_J_J9(q: &Joints, f_t_ee: &Pose, out: &mut Jacobian) {
    jacobian(q, Frame::end_effector(f_t_ee), Axes::Frame, out);
}

#[unsafe(no_mangle)]
extern "C" fn M_NE(q: &Joints, inertia: &[f64; 9], mass: f64, centre: &[f64; 3], out: &mut [f64; 49]) {
    out.copy_from_slice(PANDA.inertia(q, &Load { mass, centre, inertia }).as_slice());
}

#[unsafe(no_mangle)]
extern "C" fn c_NE(
    q: &Joints,
    dq: &Joints,
    inertia: &[f64; 9],
    mass: f64,
    centre: &[f64; 3],
    out: &mut Joints,
) {
    out.copy_from_slice(PANDA.coriolis(q, dq, &Load { mass, centre, inertia }).as_slice());
}

#[unsafe(no_mangle)]
extern "C" fn g_NE(q: &Joints, gravity: &[f64; 3], mass: f64, centre: &[f64; 3], out: &mut Joints) {
    let load = Load { mass, centre, inertia: &[0.0; 9] };
    out.copy_from_slice(PANDA.gravity(q, gravity, &load).as_slice());
}
