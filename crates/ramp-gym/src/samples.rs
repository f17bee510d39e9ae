//! Samples of an episode at a fixed rate, for data sets: what the robot senses, where the arm was told to
//! go, and small images.

use std::sync::Arc;

use ramp_assembly::Assembly;
use ramp_kit::Pose;
use ramp_motion::{Joints, Kinematics};
use ramp_render::{Looks, LooksError};
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, Camera, DEPTH_UNIT, DOF, GripperCommand, Observation, PERIOD, Robot};
use ramp_twin::Twin;

use crate::pictures::{Painter, View};

/// One sample.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The readings of the robot's sensors.
    pub seen: Observation,
    /// Targets of the joints, rad: commanded positions, or those that bring the tip to a commanded pose. The
    /// present positions, for commands without a target, for poses out of reach, and before the first
    /// command.
    pub joints: [f64; DOF],
    /// The last command of the gripper; its present width before the first one.
    pub gripper: GripperCommand,
    /// An image for each camera, in the order of [`Camera::ALL`]: red, green and blue of each pixel. Empty
    /// without images.
    pub images: Vec<Vec<u8>>,
    /// The depth of each image, in [`DEPTH_UNIT`]: 0 where there is none. Empty without depth images.
    pub depths: Vec<Vec<u16>>,
}

/// The images of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pictures {
    /// Pixels along each side, within [`SIZES`](crate::pictures::SIZES).
    pub size: usize,
    /// Whether there are depth images, too.
    pub depth: bool,
}

/// Takes samples of a running episode.
pub struct Sampler {
    kinematics: Kinematics,
    painters: Vec<Painter>,
    /// Time between two samples, s.
    every: f64,
    /// Samples so far.
    taken: u64,
}

impl Sampler {
    /// A sample each `periods` control periods, from the first moment on, with these images or none.
    ///
    /// # Errors
    /// When the parts cannot be drawn.
    pub fn new(
        assembly: &Assembly,
        arm: &ArmModel,
        periods: u32,
        pictures: Option<Pictures>,
    ) -> Result<Sampler, LooksError> {
        let mut painters = Vec::new();
        if let Some(Pictures { size, depth }) = pictures {
            let looks = Looks::shared(&assembly.kit, arm)?;
            let painter =
                |camera| Painter::new(View { camera, size, depth }, Arc::clone(&looks), arm.hand.tip);
            painters.extend(Camera::ALL.map(painter));
        }
        let every = f64::from(periods) * PERIOD;
        Ok(Sampler { kinematics: Kinematics::new(arm), painters, every, taken: 0 })
    }

    /// The samples that are due by now. A call that lets much time pass gives several, equal ones.
    ///
    /// # Errors
    /// When the parts of the episode cannot be drawn.
    pub fn due(&mut self, twin: &Twin) -> Result<Vec<Sample>, LooksError> {
        // Half a period more, since times are sums of periods.
        let due = ((twin.time() + 0.5 * PERIOD) / self.every) as u64 + 1;
        let missing = due.saturating_sub(self.taken);
        self.taken += missing;
        if missing == 0 {
            return Ok(Vec::new());
        }
        if missing == self.taken {
            // The first one of this episode.
            self.painters.iter_mut().try_for_each(|painter| painter.dress(twin))?;
        }
        Ok(vec![self.sample(twin); missing as usize])
    }

    fn sample(&mut self, twin: &Twin) -> Sample {
        let seen = twin.observe();
        let commanded = twin.commanded();
        let joints = match commanded.map(|command| &command.arm) {
            Some(ArmCommand::JointPositions(positions)) => *positions,
            Some(ArmCommand::CartesianPose(x_wt)) => self.joints_at(x_wt, &seen),
            Some(ArmCommand::CartesianImpedance(impedance)) => self.joints_at(&impedance.x_wt, &seen),
            Some(ArmCommand::JointVelocities(_) | ArmCommand::JointTorques(_)) | None => seen.positions,
        };
        let gripper =
            commanded.map_or(GripperCommand { width: seen.width, force: 0.0 }, |command| command.gripper);
        for painter in &mut self.painters {
            painter.paint(twin);
        }
        let images = self.painters.iter().map(|painter| painter.colour.clone()).collect();
        let deep = self.painters.iter().filter(|painter| painter.view().depth);
        let depths = deep.map(|painter| painter.depth.iter().copied().map(units).collect()).collect();
        Sample { seen, joints, gripper, images, depths }
    }

    /// The joint positions, rad, near the present ones that bring the tip to a pose.
    fn joints_at(&self, x_wt: &Pose, seen: &Observation) -> [f64; DOF] {
        let here = Joints::from(seen.positions);
        self.kinematics.inverse(x_wt, &here, &here).map_or(seen.positions, Into::into)
    }
}

/// A distance, m, in [`DEPTH_UNIT`]; 0 for one that a depth image cannot hold.
fn units(distance: f32) -> u16 {
    let units = (f64::from(distance) / DEPTH_UNIT).round();
    if units <= f64::from(u16::MAX) { units as u16 } else { 0 }
}
