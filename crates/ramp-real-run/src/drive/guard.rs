//! The guards between an agent and an arm: walls of the workspace, velocities, and a person who wants a stop.

use nalgebra::Vector3;
use ramp_control::Smoother;
use ramp_motion::{Joints, Kinematics};
use ramp_robot::arm::ArmModel;
use ramp_robot::{
    ArmCommand, Camera, CameraModel, Command, DOF, Image, ImageWidth, Observation, PartReading, Robot,
    RobotError,
};

/// Control periods in which the arm comes to rest when it is stopped (s/1000). Chosen: the slowest joint
/// needs a third of it from full speed.
const BRAKING: u32 = 600;
/// By this share a commanded velocity or torque fades in each period of braking.
const FADE: f64 = 0.01;
/// A joint may be so many times faster than is allowed. Chosen: one that catches up after late commands is an
/// eighth faster than it was commanded.
const FASTER: f64 = 1.2;

/// The box in which the tip may be, in the world, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace {
    /// Its lowest corner.
    pub low: [f64; 3],
    /// Its highest corner.
    pub high: [f64; 3],
}

impl Workspace {
    /// The wall that a point is behind, in words.
    fn behind(&self, point: &Vector3<f64>) -> Option<String> {
        ["x", "y", "z"].iter().enumerate().find_map(|(axis, name)| {
            let (at, low, high) = (point[axis], self.low[axis], self.high[axis]);
            (!(low..=high).contains(&at))
                .then(|| format!("{name} = {at:.3} m, outside {low:.3} to {high:.3} m of the workspace"))
        })
    }
}

/// A robot behind guards.
pub struct Guard<'a, R: Robot + ?Sized> {
    pub(super) robot: &'a mut R,
    workspace: Workspace,
    kinematics: Kinematics,
    smoother: Smoother,
    /// The largest velocities that are allowed, rad/s.
    velocities: [f64; DOF],
    stop: &'a dyn Fn() -> Option<String>,
    last: Option<Command>,
    /// Whether commands that do not follow the last one are made to.
    pub(super) smooths: bool,
    stopped: Option<RobotError>,
}

impl<'a, R: Robot + ?Sized> Guard<'a, R> {
    /// Guards a robot. The first arm is its own, the second has the largest velocities that are allowed.
    /// `stop` gives the reason of a person who wants it to stop.
    pub fn new(
        robot: &'a mut R,
        [arm, told]: [&ArmModel; 2],
        workspace: &Workspace,
        stop: &'a dyn Fn() -> Option<String>,
    ) -> Guard<'a, R> {
        Guard {
            robot,
            workspace: *workspace,
            kinematics: Kinematics::new(arm),
            smoother: Smoother::new(arm),
            velocities: told.joints.each_ref().map(|joint| joint.velocity),
            stop,
            last: None,
            smooths: false,
            stopped: None,
        }
    }

    /// Where a command wants the tip, in the world, as far as it says.
    fn target(&self, command: &ArmCommand) -> Option<Vector3<f64>> {
        match command {
            ArmCommand::JointPositions(positions) => {
                let positions = Joints::from_row_slice(positions);
                Some(self.kinematics.tip(&positions).translation.vector)
            }
            ArmCommand::CartesianPose(x_wt) => Some(x_wt.translation.vector),
            ArmCommand::CartesianImpedance(impedance) => Some(impedance.x_wt.translation.vector),
            ArmCommand::JointVelocities(_) | ArmCommand::JointTorques(_) => None,
        }
    }

    /// Brings the arm to rest, and remembers why.
    fn brake(&mut self, why: String) -> RobotError {
        if let Some(mut command) = self.last.take() {
            for _ in 0..BRAKING {
                if let ArmCommand::JointVelocities(values) | ArmCommand::JointTorques(values) =
                    &mut command.arm
                {
                    values.iter_mut().for_each(|value| *value *= 1.0 - FADE);
                }
                // Its smoothed target runs out to where it was commanded last.
                let smooth = self.smoother.smooth(&command, &self.robot.observe()).0;
                if self.robot.step(&smooth).is_err() {
                    break;
                }
            }
        }
        let error = RobotError::Arm { what: why };
        self.stopped = Some(error.clone());
        error
    }

    /// The reason for which nothing more may happen.
    fn check(&mut self) -> Result<(), RobotError> {
        if let Some(error) = &self.stopped {
            return Err(error.clone());
        }
        match (self.stop)() {
            Some(why) => Err(self.brake(why)),
            None => Ok(()),
        }
    }
}

impl<R: Robot + ?Sized> Robot for Guard<'_, R> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.check()?;
        command.check_limits()?;
        if let Some(wall) = self.target(&command.arm).and_then(|point| self.workspace.behind(&point)) {
            return Err(self.brake(format!("the agent wants the tip at {wall}")));
        }
        let smooth = self.smoother.smooth(command, &self.robot.observe()).0;
        self.last = Some(command.clone());
        let seen = self.robot.step(if self.smooths { &smooth } else { command });
        if seen.as_ref().is_err_and(RobotError::is_recovered) {
            // The arm stands: there is no motion to brake, and the next one begins there.
            self.last = None;
            self.smoother.begin_anew();
        }
        let seen = seen?;
        if let Some(wall) = self.workspace.behind(&seen.x_wt.translation.vector) {
            return Err(self.brake(format!("the tip is at {wall}")));
        }
        let fast = |joint: &usize| seen.velocities[*joint].abs() > FASTER * self.velocities[*joint];
        match (0..DOF).find(fast) {
            Some(joint) => {
                let (velocity, most) = (seen.velocities[joint], self.velocities[joint]);
                let number = joint + 1;
                Err(self.brake(format!("joint {number} moves at {velocity:.2} rad/s, allowed are {most:.2}")))
            }
            None => Ok(seen),
        }
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.check()?;
        self.robot.read_parts()
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.check()?;
        self.robot.expose()
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.check()?;
        self.robot.look_sized(camera, width)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}
