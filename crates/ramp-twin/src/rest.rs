//! The world with the arm gone: would the parts stay where they are?
//!
//! A copy of the physics goes on without the arm. The fingers let go at once, hand and links touch nothing
//! any more, a fault pushes no longer, and the parts fall, slide or stay. The world itself is not changed,
//! and no robot time passes.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use ramp_robot::{DOF, PERIOD};

use crate::broad_phase::BroadPhase;
use crate::scene::Scene;
use crate::witness::{LEAST, Moment, merge};

/// Force that wakes a part, N: a millionth of a peg's weight.
const WAKING: f64 = 1e-7;

/// The true world while a copy of `data` goes on without the arm for `seconds`: every `periods` control
/// periods, and at the end. All moments have the robot time `time`, s. The last one has the penetrations of
/// its period.
pub(crate) fn without_arm(
    scene: &Scene,
    data: &MjData<Arc<MjModel>>,
    [time, seconds]: [f64; 2],
    periods: u64,
) -> Vec<Moment> {
    let mut copy = data.clone();
    // The arm floats at rest where it was.
    copy.qvel_mut()[..DOF + 2].fill(0.0);
    copy.qfrc_applied_mut().fill(0.0);
    copy.xfrc_applied_mut().fill([0.0; 6]);
    // A part that sleeps in the hand, or leans on it, would not fall: contacts that are gone wake nothing.
    for (_, body) in &scene.parts {
        copy.xfrc_applied_mut()[*body] = [0.0, 0.0, -WAKING, 0.0, 0.0, 0.0];
    }
    copy.ctrl_mut().fill(0.0);
    let mut broad_phase = BroadPhase::new(&scene.model).without(&scene.arm_bodies);
    let mut moments = Vec::new();
    let all = (seconds / PERIOD).round() as u64;
    for period in 1..=all {
        if let Some(clamp) = &scene.clamp {
            clamp.step(&mut copy);
        }
        broad_phase.step(&mut copy);
        if period == 1 {
            copy.xfrc_applied_mut().fill([0.0; 6]);
        }
        if period == all || period.is_multiple_of(periods.max(1)) {
            moments.push(Moment { truth: scene.truth(&copy, time), penetrations: Vec::new() });
        }
    }
    if let Some(last) = moments.last_mut() {
        merge(&mut last.penetrations, scene.penetrations(&copy, LEAST));
    }
    moments
}
