//! The hand's access to the robot: observations, images, one command a control period.

use nalgebra::{Point3, Vector6};
use ramp_motion::Joints;
use ramp_robot::arm::ArmModel;
use ramp_robot::{
    ArmCommand, Camera, CameraModel, Command, GripperCommand, Image, ImageWidth, Observation, PERIOD,
    PartReading, Robot, RobotError,
};

use super::dead_time::DeadTime;
use super::felt::Felt;
use crate::Pose;
use crate::parameters::Parameters;
use crate::parameters::hand::{FeltParameters, HandParameters, TrimParameters};

/// A part between the fingers.
#[derive(Clone, Debug)]
pub struct Held {
    /// Its name.
    pub part: String,
    /// Its frame in the tip's frame.
    pub x_tp: Pose,
    /// The pose in the world at which it is put down: where it was grasped, or its place on the sheet.
    pub x_wp_back: Pose,
    /// It is brought back to its place on the sheet.
    pub returns_to_sheet: bool,
    /// kg.
    pub mass: f64,
    /// Centre of mass in the part's frame, m.
    pub p_centre: Point3<f64>,
}

/// Actions shortly before the end of a motion, and a halt on its way.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrival {
    /// Gripper command sent early, to hide the dead time of a gripper that has nothing else to do.
    pub closing: Option<GripperCommand>,
    /// Time before the end at which the cameras are exposed, s.
    pub look: Option<f64>,
    /// Whether the motion comes to a halt on its way when something pushes the held part.
    pub halts: bool,
}

/// The robot, with the state of its hand.
pub struct Hand<'r> {
    pub(super) robot: &'r mut dyn Robot,
    pub(super) parameters: HandParameters,
    pub(super) trim: TrimParameters,
    /// The last observation.
    pub seen: Observation,
    /// The gripper's command.
    pub gripper: GripperCommand,
    /// The pose of the tip to which the impedance pulls, in the world.
    pub setpoint: Pose,
    /// Stiffness of the impedance: N/m, N·m/rad, axes of the world.
    pub stiffness: Vector6<f64>,
    /// The held part.
    pub held: Option<Held>,
    pub(super) posture: Joints,
    /// The largest velocity of each joint, rad/s.
    pub(super) fastest: Joints,
    pub(super) tare: Vector6<f64>,
    pub(super) last: Option<Command>,
    /// The guard has stopped a motion, and the force has not fallen since.
    pub(super) struck: bool,
    /// Something has pushed the held part during a trajectory, since it was grasped or last seen.
    pub pushed: bool,
    /// The fingers held the part too weakly at some time since it was grasped: it may have turned between
    /// them.
    pub slipped: bool,
    /// Forces of the fingers; `None` before the first reading of tactile sensors.
    felt: Option<Felt>,
    feeling: FeltParameters,
    /// The largest force at the wrist in free space before the first grasp, N: the usual error of the wrench.
    pub usual_force: f64,
    /// Number of stops after which the arm was ready again.
    pub stops: i32,
    /// The gripper's dead time after a command.
    pub(super) dead_time: DeadTime,
}

impl<'r> Hand<'r> {
    /// Takes over a robot.
    pub fn new(robot: &'r mut dyn Robot, arm: &ArmModel, parameters: &Parameters) -> Hand<'r> {
        let seen = robot.observe();
        Hand {
            gripper: GripperCommand { width: seen.width, force: 20.0 },
            setpoint: seen.x_wt,
            stiffness: Vector6::from(parameters.hand.stiffness),
            parameters: parameters.hand.clone(),
            trim: parameters.trim.clone(),
            held: None,
            posture: Joints::from(seen.positions),
            fastest: Joints::from_fn(|joint, _| arm.joints[joint].velocity),
            tare: Vector6::zeros(),
            last: None,
            struck: false,
            pushed: false,
            slipped: false,
            felt: None,
            feeling: parameters.felt.clone(),
            usual_force: seen.wrench.fixed_rows::<3>(0).norm(),
            stops: 0,
            dead_time: DeadTime::default(),
            robot,
            seen,
        }
    }

    /// The bounds of a trim of this arm: the more it feels in free space, the more friction there is.
    pub fn trim_bounds(&self) -> TrimParameters {
        let mut bounds = self.trim.clone();
        let rough = (self.usual_force / bounds.smooth).max(1.0);
        bounds.most *= rough;
        bounds.most_turn *= rough;
        bounds
    }

    /// Reads the poses of the parts. Time may pass, during which the arm follows its last command.
    ///
    /// # Errors
    /// The robot's.
    pub fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let readings = self.robot.read_parts();
        self.seen = self.robot.observe();
        readings.inspect_err(|error| self.begin_anew(error))
    }

    /// Opens the shutters of the cameras while the arm moves: [`Hand::look`] gives the images later, the
    /// oldest first.
    ///
    /// # Errors
    /// The robot's.
    pub fn expose(&mut self) -> Result<(), RobotError> {
        self.robot.expose()
    }

    /// Takes an image. Time passes, during which the arm follows its last command.
    ///
    /// # Errors
    /// The robot's.
    pub fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        self.look_sized(camera, None)
    }

    /// As [`Hand::look`], with an image of this width.
    ///
    /// # Errors
    /// The robot's.
    pub fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        let image = self.robot.look_sized(camera, width);
        self.seen = self.robot.observe();
        image.inspect_err(|error| self.begin_anew(error))
    }

    /// The robot's model of a camera.
    pub fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }

    /// Joint positions, rad.
    pub fn joints(&self) -> Joints {
        Joints::from(self.seen.positions)
    }

    /// Joint positions from which a motion of the joints begins, rad: the last commanded ones, or else the
    /// measured ones.
    pub fn start(&self) -> Joints {
        match &self.last {
            Some(Command { arm: ArmCommand::JointPositions(positions), .. }) => Joints::from(*positions),
            _ => self.joints(),
        }
    }

    /// Robot time, s.
    pub fn time(&self) -> f64 {
        self.seen.time
    }

    /// The pose of the held part in the world, if the grasp has not slipped; `None` with an empty hand.
    pub fn x_wp_held(&self) -> Option<Pose> {
        self.held.as_ref().map(|held| self.seen.x_wt * held.x_tp)
    }

    pub(super) fn joint_step(&mut self, q: Joints) -> Result<(), RobotError> {
        self.command(Command { arm: ArmCommand::JointPositions(q.into()), gripper: self.gripper })
    }

    /// One control period under a command of a skill's own making. Nothing guards it.
    ///
    /// # Errors
    /// The robot's.
    pub fn obey(&mut self, command: Command) -> Result<(), RobotError> {
        self.gripper = command.gripper;
        self.command(command)
    }

    pub(super) fn command(&mut self, command: Command) -> Result<(), RobotError> {
        if self.last.as_ref().is_some_and(|last| last.gripper != command.gripper) {
            self.dead_time.commanded(&self.seen);
        }
        self.seen = self.robot.step(&command).inspect_err(|error| self.begin_anew(error))?;
        self.dead_time.sensed(self.seen.time, self.seen.width, self.parameters.told_every);
        if let Some(touch) = &self.seen.touch {
            let felt = self.felt.get_or_insert_with(|| Felt::new(touch));
            felt.sense(touch, &self.feeling);
            if self.held.is_some()
                && !self.seen.gripper_busy
                && felt.is_loose(&command.gripper, &self.feeling)
            {
                (self.pushed, self.slipped) = (true, true);
            }
        }
        self.last = Some(command);
        Ok(())
    }

    /// After a stop from which the arm has recovered, the next motion begins where it stands, and the held
    /// part may have moved in the hand.
    fn begin_anew(&mut self, error: &RobotError) {
        if error.is_recovered() {
            self.seen = self.robot.observe();
            self.last = None;
            self.struck = false;
            self.stops += 1;
            self.pushed = self.held.is_some();
            self.relax();
        }
    }

    /// Repeats the last command for a time, s.
    ///
    /// # Errors
    /// The robot's.
    pub fn hold(&mut self, seconds: f64) -> Result<(), RobotError> {
        for _ in 0..(seconds / PERIOD).round() as usize {
            match self.last.clone() {
                Some(command) => self.command(command)?,
                None => self.joint_step(self.joints())?,
            }
        }
        Ok(())
    }
}
