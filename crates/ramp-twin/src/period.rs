//! One control period: command, inner loop, drives, fault, physics, sensors, cameras, limits.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use ramp_control::{ArmState, Follower, JointMotion};
use ramp_robot::{ArmCommand, Command, DOF, PERIOD, RobotError, TIME_LIMIT};

use crate::broad_phase::BroadPhase;
use crate::command::check_command;
use crate::engine::rotation_from_rows;
use crate::fault::Injector;
use crate::scene::Scene;
use crate::sensors;
use crate::shutters::Moment;
use crate::state::State;
use crate::targets::Targets;
use crate::witness;

/// Distance by which a joint may pass a soft stop before the robot reports it, rad.
const POSITION_MARGIN: f64 = 0.005;

type Data = MjData<Arc<MjModel>>;

/// One period under a command. If the line to the arm was silent for too long, also the stop and the recovery
/// after it.
///
/// # Errors
/// When the command is refused, a limit is exceeded, or the physics diverge.
pub(crate) fn run(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    command: &Command,
) -> Result<(), RobotError> {
    advance(scene, data, state, broad_phase, command)?;
    if state.drive.has_stopped() && !state.targets.holding {
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
    let before = state.targets.clone();
    let arm = ArmCommand::JointPositions(state.arm.positions.into());
    let here = Command { arm, gripper: before.gripper() };
    let periods = (scene.physics.line.recovery / PERIOD).round() as u32;
    state.targets.holding = true;
    state.targets.joints = Some(JointMotion::at_rest(state.arm.positions));
    state.targets.follower = Follower::Free;
    let recovered = (0..periods).try_for_each(|_| advance(scene, data, state, broad_phase, &here));
    // The arm goes on from where it stands.
    state.targets = Targets { follower: Follower::Free, ..before };
    recovered
}

/// One period under a command.
fn advance(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    broad_phase: &mut BroadPhase,
    command: &Command,
) -> Result<(), RobotError> {
    check_command(command)?;
    if state.time() >= TIME_LIMIT {
        return Err(RobotError::OutOfTime { limit: TIME_LIMIT });
    }
    let before = state.arm.clone();
    actuate(scene, data, state, &before, command)?;
    if let Some(clamp) = &scene.clamp {
        clamp.step(data);
    }
    broad_phase.step(data);
    state.targets.command = Some(command.clone());
    state.steps += 1;
    state.deepest = state.deepest.max(scene.deepest_penetration(data));
    witness::record(scene, data, &mut state.witness, state.steps);
    let reading = sensors::read_wrist(scene, data);
    state.arm = sensors::arm_state(scene, data, &mut state.encoder_noise);
    state.feel(scene, data, &before, &reading);
    state.observe(scene, data);
    expose(scene, data, state);
    state.drive.check_reflex(&scene.physics.controller, state.wrench.fixed_rows::<3>(0).norm())?;
    check_limits(scene, state)
}

/// Sets motor torques, finger forces and external joint torques for the next step of the physics.
fn actuate(
    scene: &Scene,
    data: &mut Data,
    state: &mut State,
    before: &ArmState,
    command: &Command,
) -> Result<(), RobotError> {
    let wanted = state.targets.torques(&scene.arm, before, &command.arm)?;
    let motors = state.drive.command(&scene.physics.controller, &scene.arm, &command.arm, wanted)?;
    state.torques = motors;
    let q = [data.qpos()[DOF], data.qpos()[DOF + 1]];
    let v = [data.qvel()[DOF], data.qvel()[DOF + 1]];
    let mut gripper = state.slow_gripper.step(command.gripper);
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
    Ok(())
}

/// Records the poses of all bodies for exposures that are under way.
fn expose(scene: &Scene, data: &Data, state: &mut State) {
    if !state.cameras.shutters.are_due(state.steps) {
        return;
    }
    let Ok(looks) = scene.cameras.looks(&scene.arm) else { return };
    let moment = Moment { scene: scene.picture(data, &looks), x_wt: state.arm.x_wt, time: state.time() };
    let frozen = state.fault.as_ref().is_some_and(Injector::freezes_cameras);
    state.cameras.shutters.record(state.steps, &moment, frozen);
}

/// Checks the arm's joints against their limits.
fn check_limits(scene: &Scene, state: &State) -> Result<(), RobotError> {
    for (index, joint) in scene.arm.joints.iter().enumerate() {
        let (position, velocity) = (state.arm.positions[index], state.arm.velocities[index]);
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
