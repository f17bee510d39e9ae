//! The seam between an agent and a robot: traits and plain types, nothing else.
//!
//! An agent sends a [`Command`] and gets an [`Observation`], once for each control period of a millisecond; the
//! inner loop runs inside the robot. The same agent drives the twin and a real arm. What it may learn of the
//! parts is decided by the [`Track`] it is judged on.

pub mod arm;
pub mod camera;
pub mod cause;
pub mod limits;
pub mod random;

use nalgebra::{Isometry3, Vector6};

pub use camera::{Camera, CameraModel, Image};
pub use cause::Cause;

/// A rigid pose; `x_wt` is the pose of the tip T in the world W.
pub type Pose = Isometry3<f64>;

/// Number of joints of the arm.
pub const DOF: usize = 7;

/// What an agent may see of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Track {
    /// Exact poses from the simulator.
    State,
    /// Poses from the simulator with noise on each reading, and readings that are missing.
    Noisy,
    /// Camera images alone, with the parts' tags in them.
    Tags,
}

impl Track {
    /// All of them.
    pub const ALL: [Track; 3] = [Track::State, Track::Noisy, Track::Tags];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Track::State => "state",
            Track::Noisy => "noisy",
            Track::Tags => "tags",
        }
    }
}

/// What the arm is to do during the next control period.
#[derive(Clone, Debug, PartialEq)]
pub enum ArmCommand {
    /// Joint positions, rad; the inner loop tracks them stiffly.
    JointPositions([f64; DOF]),
    /// Joint velocities, rad/s.
    JointVelocities([f64; DOF]),
    /// Joint torques on top of gravity compensation, N·m.
    JointTorques([f64; DOF]),
    /// The pose of the tip in the world, tracked stiffly.
    CartesianPose(Pose),
    /// A spring and damper between the tip and a target pose.
    CartesianImpedance(Impedance),
}

/// A Cartesian impedance at the tip, axes of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Impedance {
    /// Where the spring pulls the tip: pose in the world. The damper acts relative to this pose's own motion from
    /// command to command.
    pub x_wt: Pose,
    /// Stiffness: three translational, N/m, then three rotational, N·m/rad.
    pub stiffness: Vector6<f64>,
    /// Damping ratio of the spring with the mass the arm shows at its tip; 1 is critical.
    pub damping_ratio: f64,
    /// Wrench added to the spring's, at the tip, axes of the world: force in N, then moment in N·m. For example
    /// the weight of a held part.
    pub feed_forward: Vector6<f64>,
    /// Joint positions that the arm leans towards in its null space, rad.
    pub posture: [f64; DOF],
}

/// What the gripper is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripperCommand {
    /// Wanted distance between the two fingers, m: the sum of the two finger joints, 0 to 0.08.
    pub width: f64,
    /// Largest force of each finger, N.
    pub force: f64,
}

/// One control period's command.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// The arm's part.
    pub arm: ArmCommand,
    /// The gripper's part.
    pub gripper: GripperCommand,
}

/// What the robot senses at the end of a control period.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Robot time since the start of the episode, s.
    pub time: f64,
    /// Joint positions, rad.
    pub positions: [f64; DOF],
    /// Joint velocities, rad/s.
    pub velocities: [f64; DOF],
    /// Joint torques on top of gravity compensation, N·m.
    pub torques: [f64; DOF],
    /// Pose of the tip T in the world: origin between the fingertips, z out of the hand, y along the closing
    /// direction.
    pub x_wt: Pose,
    /// Wrench of the hand on the world, measured at the wrist and expressed at the wrist in axes of the world:
    /// force in N, then moment in N·m. Weights that the arm compensates (the hand's) are taken off; a held part's
    /// is not. Noisy.
    pub wrench: Vector6<f64>,
    /// Distance between the two fingers, m.
    pub width: f64,
}

/// Where a part was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct PartReading {
    /// Name in the kit, for example `b4` or `p1`.
    pub part: String,
    /// Pose of its frame in the world: a beam's at its j1 hole, a peg's at the underside of its head.
    pub x_wp: Pose,
    /// Standard deviation of its noise: of the position along each axis of the world, m, and of the rotation about
    /// each axis of the world, rad. Zero for an exact reading.
    pub sigma: [f64; 2],
}

/// Why a robot stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotError {
    /// A joint left its range.
    #[error("joint {joint} is at {position:.3} rad, outside {low:.3} to {high:.3}")]
    JointPosition {
        /// 1 to 7.
        joint: usize,
        /// rad.
        position: f64,
        /// rad.
        low: f64,
        /// rad.
        high: f64,
    },
    /// A joint moved too fast.
    #[error("joint {joint} moves at {velocity:.3} rad/s, faster than {limit:.3}")]
    JointVelocity {
        /// 1 to 7.
        joint: usize,
        /// rad/s.
        velocity: f64,
        /// rad/s.
        limit: f64,
    },
    /// A command holds a number that is not finite, or is not a pose, force or width at all.
    #[error("the command's {what} is not a finite, sensible number")]
    BadCommand {
        /// Which part of the command.
        what: &'static str,
    },
    /// A command holds a number beyond [`limits`].
    #[error("the command's {what} is {value:e}, and {limit} {unit} is the most there is")]
    TooMuch {
        /// Which part of the command.
        what: &'static str,
        /// In `unit`.
        value: f64,
        /// The most that is allowed, in `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// The episode has lasted as long as an episode may.
    #[error("the episode reached its limit of {limit:.0} s of robot time")]
    OutOfTime {
        /// s.
        limit: f64,
    },
    /// The track on which the agent is judged does not give what it asked for. The robot goes on.
    #[error("track `{}` gives no {what}", track.name())]
    NotOnTrack {
        /// The track.
        track: Track,
        /// What was asked for.
        what: &'static str,
    },
    /// A camera gives no images any more. The robot goes on.
    #[error("the camera `{}` gives no image", camera.name())]
    CameraStopped {
        /// The camera.
        camera: Camera,
    },
    /// The simulation became unstable.
    #[error("the physics diverged at {time:.3} s")]
    Diverged {
        /// s.
        time: f64,
    },
}

impl RobotError {
    /// Whether the robot has stopped for good; after the other errors it goes on.
    pub fn is_final(&self) -> bool {
        !matches!(self, RobotError::NotOnTrack { .. } | RobotError::CameraStopped { .. })
    }
}

/// A robot that an agent can drive: the twin, or a real arm.
///
/// The trait is all that an agent gets of it. What is behind it, with the truth that the referee reads, cannot be had
/// from it:
///
/// ```
/// fn drive(robot: &mut dyn ramp_robot::Robot) -> &mut dyn ramp_robot::Robot {
///     robot
/// }
/// ```
/// ```compile_fail
/// fn peek(robot: &mut dyn ramp_robot::Robot) -> &mut dyn std::any::Any {
///     robot
/// }
/// ```
pub trait Robot {
    /// Lets one control period of a millisecond pass under `command` and returns what was sensed at its end.
    ///
    /// # Errors
    /// When the command is not finite, a limit of the arm is broken or the episode's time is over. After an error
    /// every further call returns the same error.
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError>;

    /// What was sensed last, without letting time pass.
    fn observe(&self) -> Observation;

    /// Reads where the parts are, as far as the track allows. On `state` all parts, exactly and at no cost;
    /// on `noisy` most of them, with noise, and robot time passes as for an image, during which the arm goes on with
    /// its last command.
    ///
    /// # Errors
    /// As [`Robot::step`]; on `tags` always [`RobotError::NotOnTrack`], and the robot goes on.
    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError>;

    /// Takes an image. Exposure and the way to the agent take robot time, during which the arm goes on with its
    /// last command.
    ///
    /// # Errors
    /// As [`Robot::step`]; [`RobotError::CameraStopped`] when there is no image, and on `noisy`
    /// [`RobotError::NotOnTrack`]: after these two the robot goes on.
    fn look(&mut self, camera: Camera) -> Result<Image, RobotError>;

    /// What is known of a camera: its lens, and where it is up to the error of a usual calibration.
    fn camera(&self, camera: Camera) -> CameraModel;
}

/// What an agent tells about its own work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Account {
    /// Time spent on task planning, s of its own clock.
    pub planning: f64,
    /// Number of coarse actions in the first plan.
    pub coarse: usize,
    /// Number of fine actions in the first plan.
    pub fine: usize,
    /// How often it planned again.
    pub replans: usize,
    /// What happened, in order of time.
    pub events: Vec<Event>,
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Robot time, s.
    pub time: f64,
    /// In one word, one of [`Event::KINDS`].
    pub kind: &'static str,
    /// What it was about, for a person.
    pub what: String,
}

impl Event {
    /// The kinds there are.
    pub const KINDS: [&'static str; 8] =
        ["start", "done", "fault", "retry", "search", "replan", "seen", "diagnosis"];
}

/// An agent: gets a robot and works until it is done or the robot stops it.
pub trait Agent {
    /// Its name and version in results.
    fn name(&self) -> (&str, &str);

    /// What it did, for the result; read after [`Agent::run`].
    fn account(&self) -> Account;

    /// SHA-256, in hex, of the file that the agent, or its parameters, were read from; `None` where both are part of the program.
    fn file_hash(&self) -> Option<&str> {
        None
    }

    /// Why the agent itself could not go on, where it was not the robot that stopped it; read after [`Agent::run`].
    fn failure(&self) -> Option<String> {
        None
    }

    /// Works on the goal it was made for. Returning ends the episode.
    ///
    /// # Errors
    /// The robot's error, when that is what ended the work.
    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError>;
}
