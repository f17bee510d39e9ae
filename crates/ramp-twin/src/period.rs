//! One control period: command, controller, drives, fault, physics, cameras, sensors, limits.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use ramp_control::{ArmState, JointVector, check_command};
use ramp_robot::{Command, DOF, PERIOD, RobotError, TIME_LIMIT};

use crate::broad_phase::BroadPhase;
use crate::engine::rotation_from_rows;
use crate::fault::Injector;
use crate::scene::Scene;
use crate::sensors;
use crate::shutters::Moment;
use crate::state::State;
use crate::witness;

/// Distance by which a joint may pass a soft stop before the robot reports it, rad.
const POSITION_MARGIN: f64 = 0.005;

type Data = MjData<Arc<MjModel>>;

/// One period under a command, or without one, in which the last one holds. If the line to the arm was silent
/// for too long, also the stop and the recovery after it.
///
/// # Errors
/// When the command is refused, a limit is exceeded, or the physics diverge.
pub(crate) fn run(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    command: Option<&Command>,
) -> Result<(), RobotError> {
    advance(scene, data, state, broad_phase, command)?;
    if state.drive.has_stopped() {
        recover(scene, data, state, broad_phase)?;
    }
    Ok(())
}

/// The arm brakes and stands until it is ready again. Afterwards the commanded motion continues from there.
fn recover(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
) -> Result<(), RobotError> {
    state.drive.restart();
    let interrupted = state.controller.stopped();
    let periods = (scene.physics.line.recovery / PERIOD).round() as u32;
    let recovered = (0..periods).try_for_each(|_| hold(scene, data, state, broad_phase));
    state.drive.restart();
    state.controller.resume(interrupted);
    recovered
}

/// The arm stands for a time (s) after a stop, whatever pushes it meanwhile.
///
/// # Errors
/// When the physics diverge, a joint leaves its range or the time is over.
pub(crate) fn stand(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    seconds: f64,
) -> Result<(), RobotError> {
    for _ in 0..(seconds / PERIOD).round() as u32 {
        match hold(scene, data, state, broad_phase) {
            // It has stopped already.
            Err(RobotError::Reflex { .. } | RobotError::JointVelocity { .. }) => {}
            other => other?,
        }
    }
    Ok(())
}

/// One period of an arm that has stopped: its own controller holds it where it was, without the line.
fn hold(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
) -> Result<(), RobotError> {
    let torques = state.controller.hold();
    let motors = state.drive.hold(&torques);
    move_by(scene, data, state, broad_phase, &motors)
}

/// One period of the controller and of the arm.
fn advance(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    command: Option<&Command>,
) -> Result<(), RobotError> {
    if let Some(command) = command {
        check_command(command)?;
    }
    let torques = match command {
        Some(command) => {
            let torques = state.controller.torques(&command.arm)?;
            state.command = Some(command.clone());
            state.gripper_command = command.gripper;
            torques
        }
        None => state.controller.late(),
    };
    actuate(scene, data, state, broad_phase, &torques)
}

/// One period of the arm under torques on top of those that hold it up (N·m): drives, physics, sensors and
/// cameras, and the checks of its limits. The gripper holds its command.
///
/// # Errors
/// When a limit is exceeded, the physics diverge or the time is over.
pub(crate) fn actuate(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    torques: &JointVector,
) -> Result<(), RobotError> {
    let motors = state.drive.command(torques);
    move_by(scene, data, state, broad_phase, &motors)
}

/// One period of the arm under these torques of its motors, N·m.
fn move_by(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    motors: &JointVector,
) -> Result<(), RobotError> {
    if state.time() >= TIME_LIMIT {
        return Err(RobotError::OutOfTime { limit: TIME_LIMIT });
    }
    let before = state.controller.state().clone();
    drive(scene, data, state, &before, motors);
    if let Some(clamp) = &scene.clamp {
        clamp.step(data);
    }
    broad_phase.step(data);
    // The engine has the poses of the bodies at the begin of the period.
    expose(scene, data, state, &before);
    state.steps += 1;
    state.deepest = state.deepest.max(scene.deepest_penetration(data));
    witness::record(scene, data, &mut state.witness, state.steps);
    let reading = sensors::read_wrist(scene, data);
    state.sense(scene, data, &before, &reading);
    state.observe(scene, data);
    state.drive.check_reflex(&scene.physics.controller, state.wrench.fixed_rows::<3>(0).norm())?;
    check_limits(scene, state)
}

/// Sets motor torques, finger forces and external joint torques for the next step of the physics.
fn drive(scene: &Scene, data: &mut Data, state: &mut State, before: &ArmState, motors: &JointVector) {
    state.torques = *motors;
    let q = [data.qpos()[DOF], data.qpos()[DOF + 1]];
    let v = [data.qvel()[DOF], data.qvel()[DOF + 1]];
    let mut gripper = state.slow_gripper.step(state.gripper_command);
    if let Some(fault) = &mut state.fault {
        let fingers = [q[0] + q[1], v[0] + v[1]];
        gripper = fault.step(data, &before.x_wt, state.steps, fingers, gripper);
    }
    let fingers = state.gripper.forces(gripper.width, gripper.force, q, v, PERIOD);
    if scene.loaded {
        let hand = rotation_from_rows(&data.site_xmat()[scene.wrist_site]);
        let p_unknown = Vector3::from(data.site_xpos()[scene.wrist_site])
            + hand * Vector3::from(scene.physics.arm.unknown_centre);
        let load = state.drive.load(&scene.friction, scene.physics.arm.unknown_mass, before, &p_unknown);
        data.qfrc_applied_mut()[..DOF].copy_from_slice(load.as_slice());
    }
    let ctrl = data.ctrl_mut();
    ctrl[..DOF].copy_from_slice(motors.as_slice());
    ctrl[DOF..DOF + 2].copy_from_slice(&fingers);
}

/// Records the poses of all bodies for exposures that are under way, with the arm as it was reported then.
fn expose(scene: &Scene, data: &Data, state: &mut State, arm: &ArmState) {
    if !state.cameras.shutters.are_due(state.steps) {
        return;
    }
    let Ok(looks) = scene.cameras.looks(&scene.arm) else { return };
    let moment = Moment { scene: scene.picture(data, &looks), x_wt: arm.x_wt, time: state.time() };
    let frozen = state.fault.as_ref().is_some_and(Injector::freezes_cameras);
    state.cameras.shutters.record(state.steps, &moment, frozen);
}

/// Checks the arm's joints against their limits.
fn check_limits(scene: &Scene, state: &State) -> Result<(), RobotError> {
    let arm = state.controller.state();
    for (index, joint) in scene.arm.joints.iter().enumerate() {
        let (position, velocity) = (arm.positions[index], arm.velocities[index]);
        let [low, high] = joint.range;
        if !position.is_finite() || !velocity.is_finite() {
            return Err(RobotError::Diverged { time: state.time() });
        }
        if position < low - POSITION_MARGIN || position > high + POSITION_MARGIN {
            return Err(RobotError::JointPosition { joint: index + 1, position, low, high });
        }
        if velocity.abs() > joint.velocity {
            return Err(RobotError::JointVelocity { joint: index + 1, velocity, limit: joint.velocity });
        }
    }
    Ok(())
}
