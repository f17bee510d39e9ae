//! The twin's state, to be kept and taken up again exactly to the last bit.
//!
//! MuJoCo's own `mjSTATE_*` leave out which bodies sleep, so that a scene set from them ends micrometres elsewhere. A
//! snapshot copies all of MuJoCo's data, and every field of the twin that changes: motions, filters, streams of random
//! numbers, cameras, fault. Functions here name every field, so that the compiler tells when one is added.

use std::collections::VecDeque;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Vector3, Vector6};
use ramp_control::{ArmState, GripperLoop, JointMotion, JointVector, PoseMotion};
use ramp_render::LooksError;
use ramp_robot::random::Stream;
use ramp_robot::{Command, DOF, Observation, RobotError};

use super::Twin;
use crate::cameras::{CamerasState, Exposure};
use crate::drive::Drive;
use crate::fault::Injector;
use crate::slow_gripper::SlowGripper;

/// Everything of a twin that changes.
#[derive(Clone)]
pub struct Snapshot {
    data: MjData<Arc<MjModel>>,
    gripper: GripperLoop,
    slow_gripper: SlowGripper,
    drive: Drive,
    last_joints: Option<JointMotion>,
    last_command: Option<Command>,
    last_pose: Option<(PoseMotion, bool)>,
    holding: bool,
    posture: [f64; DOF],
    state: ArmState,
    torques: JointVector,
    wrench: Vector6<f64>,
    noise: Stream,
    reading_noise: Stream,
    cameras: CamerasState,
    exposures: VecDeque<Exposure>,
    shutters_free: u64,
    fault: Option<Injector>,
    failed: Option<RobotError>,
    deepest: f64,
    pressed: Vector3<f64>,
    largest_force: f64,
    steps: u64,
    observation: Observation,
}

/// Why a snapshot cannot be taken up.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// It is of another scene: another goal, seed, world or layout.
    #[error("the snapshot was taken of another twin")]
    OtherTwin,
    /// The cameras have nothing to show.
    #[error(transparent)]
    Looks(#[from] LooksError),
}

impl Snapshot {
    /// Robot time at which it was taken, s.
    pub fn time(&self) -> f64 {
        self.observation.time
    }
}

impl Twin {
    /// Keeps everything that changes. Costs some microseconds, and the memory of MuJoCo's data that is in use.
    pub fn snapshot(&self) -> Snapshot {
        let Twin {
            data,
            broad_phase: _,
            xml: _,
            arm: _,
            track: _,
            parts: _,
            is_part: _,
            wrist_site: _,
            tip_site: _,
            hand_bodies: _,
            gripper,
            slow_gripper,
            physics: _,
            drive,
            loaded: _,
            last_joints,
            last_command,
            last_pose,
            holding,
            posture,
            state,
            torques,
            wrench,
            noise,
            reading_noise,
            cameras,
            exposures,
            shutters_free,
            fault,
            failed,
            deepest,
            pressed,
            largest_force,
            steps,
            observation,
        } = self;
        Snapshot {
            data: data.clone(),
            gripper: *gripper,
            slow_gripper: slow_gripper.clone(),
            drive: drive.clone(),
            last_joints: *last_joints,
            last_command: last_command.clone(),
            last_pose: *last_pose,
            holding: *holding,
            posture: *posture,
            state: state.clone(),
            torques: *torques,
            wrench: *wrench,
            noise: noise.clone(),
            reading_noise: reading_noise.clone(),
            cameras: cameras.state(),
            exposures: exposures.clone(),
            shutters_free: *shutters_free,
            fault: fault.clone(),
            failed: failed.clone(),
            deepest: *deepest,
            pressed: *pressed,
            largest_force: *largest_force,
            steps: *steps,
            observation: observation.clone(),
        }
    }

    /// Takes up a snapshot of this twin, or of one that [`Twin::duplicate`] made of it: what follows is the same to the last
    /// bit, whatever was done since.
    ///
    /// # Errors
    /// [`RestoreError::OtherTwin`]; the twin is then as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), RestoreError> {
        let Snapshot {
            data,
            gripper,
            slow_gripper,
            drive,
            last_joints,
            last_command,
            last_pose,
            holding,
            posture,
            state,
            torques,
            wrench,
            noise,
            reading_noise,
            cameras,
            exposures,
            shutters_free,
            fault,
            failed,
            deepest,
            pressed,
            largest_force,
            steps,
            observation,
        } = snapshot;
        if !std::ptr::eq(data.model(), self.data.model()) {
            return Err(RestoreError::OtherTwin);
        }
        self.cameras.recall(cameras)?;
        data.copy_to(&mut self.data).map_err(|_| RestoreError::OtherTwin)?;
        self.gripper = *gripper;
        self.slow_gripper.clone_from(slow_gripper);
        self.drive.clone_from(drive);
        self.last_joints = *last_joints;
        self.last_command.clone_from(last_command);
        self.last_pose = *last_pose;
        self.holding = *holding;
        self.posture = *posture;
        self.state.clone_from(state);
        self.torques = *torques;
        self.wrench = *wrench;
        self.noise.clone_from(noise);
        self.reading_noise.clone_from(reading_noise);
        self.exposures.clone_from(exposures);
        self.shutters_free = *shutters_free;
        self.fault.clone_from(fault);
        self.failed.clone_from(failed);
        self.deepest = *deepest;
        self.pressed = *pressed;
        self.largest_force = *largest_force;
        self.steps = *steps;
        self.observation.clone_from(observation);
        Ok(())
    }

    /// A second twin in the same state, which shares MuJoCo's model.
    ///
    /// # Errors
    /// When its cameras have nothing to show.
    pub fn duplicate(&self) -> Result<Twin, RestoreError> {
        let Twin {
            data,
            broad_phase,
            xml,
            arm,
            track,
            parts,
            is_part,
            wrist_site,
            tip_site,
            hand_bodies,
            gripper,
            slow_gripper,
            physics,
            drive,
            loaded,
            last_joints,
            last_command,
            last_pose,
            holding,
            posture,
            state,
            torques,
            wrench,
            noise,
            reading_noise,
            cameras,
            exposures,
            shutters_free,
            fault,
            failed,
            deepest,
            pressed,
            largest_force,
            steps,
            observation,
        } = self;
        let mut fresh = cameras.fresh();
        fresh.recall(&cameras.state())?;
        Ok(Twin {
            data: data.clone(),
            broad_phase: broad_phase.clone(),
            xml: Arc::clone(xml),
            arm: arm.clone(),
            track: *track,
            parts: parts.clone(),
            is_part: is_part.clone(),
            wrist_site: *wrist_site,
            tip_site: *tip_site,
            hand_bodies: *hand_bodies,
            gripper: *gripper,
            slow_gripper: slow_gripper.clone(),
            physics: physics.clone(),
            drive: drive.clone(),
            loaded: *loaded,
            last_joints: *last_joints,
            last_command: last_command.clone(),
            last_pose: *last_pose,
            holding: *holding,
            posture: *posture,
            state: state.clone(),
            torques: *torques,
            wrench: *wrench,
            noise: noise.clone(),
            reading_noise: reading_noise.clone(),
            cameras: fresh,
            exposures: exposures.clone(),
            shutters_free: *shutters_free,
            fault: fault.clone(),
            failed: failed.clone(),
            deepest: *deepest,
            pressed: *pressed,
            largest_force: *largest_force,
            steps: *steps,
            observation: observation.clone(),
        })
    }
}
