//! The messages of the protocol: one JSON object a line, its only key the kind of message. An image is followed by its
//! pixels as bytes.

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector6};
use ramp_kit::source::{A_NAME, is_name, is_text, plain, shorten};
use ramp_robot::{
    ArmCommand, Camera, Command, DOF, Event, GripperCommand, Image, Impedance, Observation, PartReading,
    Pose, RobotError,
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::limits::{MOST_EVENTS, MOST_PERIODS};

/// The version of the protocol.
pub const PROTOCOL: u32 = 1;
/// The longest message of an agent, bytes.
pub const LONGEST_MESSAGE: usize = 4 << 20;
/// The longest reason that may hold an agent's own words, characters.
const LONGEST_REASON: usize = 200;
/// How far the length of a quaternion may be from one.
const QUATERNION: f64 = 1e-3;
/// The longest time that planning can have taken, s.
const LONGEST_PLANNING: f64 = 1e6;

/// What an agent may say.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// First of all.
    Hello(Hello),
    /// Lets control periods pass.
    Step(Step),
    /// Asks for what was sensed last.
    Observe {},
    /// Reads where the parts are.
    ReadParts {},
    /// Opens the shutters of the cameras.
    Expose {},
    /// Takes an image.
    Look(Look),
    /// Tells of a plan.
    Plan(PlanText),
    /// Tells what happens.
    Event(EventText),
    /// Ends the episode.
    Done {},
}

/// The first message.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    protocol: u32,
    /// The agent's name, for results.
    pub name: String,
    /// Its version, likewise.
    pub version: String,
    /// Are its commanded positions and poses to be made smooth, in place of refused?
    #[serde(default)]
    pub clip: bool,
}

impl Hello {
    /// Whether this can be worked with.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub fn check(&self) -> Result<(), String> {
        if self.protocol != PROTOCOL {
            let theirs = self.protocol;
            return Err(format!("the agent speaks protocol {theirs}, and {PROTOCOL} is spoken here"));
        }
        for (what, text) in [("name", &self.name), ("version", &self.version)] {
            if !is_name(text) {
                return Err(format!("the agent's {what} must be {A_NAME}, and it is `{}`", shorten(text)));
            }
        }
        Ok(())
    }
}

/// Commands, one after the other.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    commands: Vec<CommandText>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct CommandText {
    arm: ArmText,
    gripper: GripperText,
    /// Periods.
    #[serde(default = "once")]
    repeat: u64,
}

fn once() -> u64 {
    1
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ArmText {
    JointPositions([f64; DOF]),
    JointVelocities([f64; DOF]),
    JointTorques([f64; DOF]),
    Pose(PoseText),
    Impedance(ImpedanceText),
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct ImpedanceText {
    x_wt: PoseText,
    stiffness: [f64; 6],
    damping_ratio: f64,
    feed_forward: [f64; 6],
    posture: [f64; DOF],
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct GripperText {
    width: f64,
    force: f64,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseText {
    position: [f64; 3],
    quat_wxyz: [f64; 4],
}

impl PoseText {
    fn pose(&self) -> Result<Pose, String> {
        let [w, x, y, z] = self.quat_wxyz;
        let q = Quaternion::new(w, x, y, z);
        let length = q.norm();
        if (length - 1.0).abs() > QUATERNION {
            return Err(format!("has a quaternion of length {length:.4}, and 1 is expected"));
        }
        Ok(Pose::from_parts(Translation3::from(self.position), UnitQuaternion::from_quaternion(q)))
    }
}

impl Step {
    /// The commands with their numbers of periods.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub fn commands(&self) -> Result<Vec<(Command, u64)>, String> {
        let periods = self.commands.iter().fold(0_u64, |sum, it| sum.saturating_add(it.repeat));
        if periods > MOST_PERIODS {
            return Err(format!("asks for {periods} periods, and {MOST_PERIODS} is the most in one"));
        }
        self.commands.iter().map(|it| Ok((it.command()?, it.repeat))).collect()
    }
}

impl CommandText {
    fn command(&self) -> Result<Command, String> {
        let arm = match &self.arm {
            ArmText::JointPositions(values) => ArmCommand::JointPositions(*values),
            ArmText::JointVelocities(values) => ArmCommand::JointVelocities(*values),
            ArmText::JointTorques(values) => ArmCommand::JointTorques(*values),
            ArmText::Pose(pose) => ArmCommand::CartesianPose(pose.pose()?),
            ArmText::Impedance(it) => ArmCommand::CartesianImpedance(Impedance {
                x_wt: it.x_wt.pose()?,
                stiffness: Vector6::from(it.stiffness),
                damping_ratio: it.damping_ratio,
                feed_forward: Vector6::from(it.feed_forward),
                posture: it.posture,
            }),
        };
        let gripper = GripperCommand { width: self.gripper.width, force: self.gripper.force };
        Ok(Command { arm, gripper })
    }
}

/// Which camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Look {
    camera: CameraText,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum CameraText {
    Wrist,
    BirdsEye,
}

impl Look {
    /// The camera.
    pub fn camera(&self) -> Camera {
        match self.camera {
            CameraText::Wrist => Camera::Wrist,
            CameraText::BirdsEye => Camera::BirdsEye,
        }
    }
}

/// A plan's figures. The first one tells its sizes; each further one is a new plan.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanText {
    /// Coarse actions.
    #[serde(default)]
    pub coarse: usize,
    /// Fine actions.
    #[serde(default)]
    pub fine: usize,
    /// Time that this plan took, s.
    #[serde(default)]
    pub planning: f64,
}

impl PlanText {
    /// Whether it can be.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub fn check(&self) -> Result<(), String> {
        if (0.0..=LONGEST_PLANNING).contains(&self.planning) && self.coarse.max(self.fine) <= 1_000_000 {
            Ok(())
        } else {
            Err("tells of a plan that cannot be".to_string())
        }
    }
}

/// Something that happens.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventText {
    kind: String,
    what: String,
}

impl EventText {
    /// The event, at a robot time (s).
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub fn at(self, time: f64) -> Result<Event, String> {
        let Some(kind) = Event::KINDS.into_iter().find(|kind| *kind == self.kind) else {
            let kinds = Event::KINDS.join(", ");
            return Err(format!("has an event of the kind `{}`; the kinds are {kinds}", shorten(&self.kind)));
        };
        if !is_text(&self.what, MOST_EVENTS[1]) {
            return Err(format!(
                "has an event of more than {} characters, or with a control character",
                MOST_EVENTS[1]
            ));
        }
        Ok(Event { time, kind, what: self.what })
    }
}

/// Understands a line.
///
/// # Errors
/// Why it is no message, to be put after "message 7 of the agent".
pub fn parse(line: &[u8]) -> Result<Request, String> {
    serde_json::from_slice(line).map_err(|error| {
        let text = String::from_utf8_lossy(line);
        let no_number = ["NaN", "Infinity"].into_iter().find(|word| text.contains(word));
        match no_number {
            Some(word) if error.is_syntax() => format!("holds {word}, which is no number for a robot"),
            _ => format!("is not understood: {}", plain(&error.to_string(), LONGEST_REASON)),
        }
    })
}

/// What an agent is told.
#[derive(Clone, Debug)]
pub enum Answer {
    /// After hello: all about the goal.
    Goal(Value),
    /// What was sensed.
    Observation(Observation),
    /// Where parts are.
    Parts(Vec<PartReading>),
    /// An image.
    Image(Image),
    /// Heard.
    Noted,
    /// The robot does not do this, and goes on.
    Refused(RobotError),
    /// The episode is over.
    End(String),
}

impl Answer {
    /// As it goes through the pipe.
    pub fn to_bytes(&self) -> Vec<u8> {
        let value = match self {
            Answer::Goal(goal) => json!({"goal": goal}),
            Answer::Observation(seen) => json!({"observation": {
                "time": seen.time,
                "positions": seen.positions,
                "velocities": seen.velocities,
                "torques": seen.torques,
                "x_wt": pose(&seen.x_wt),
                "wrench": seen.wrench.as_slice(),
                "width": seen.width,
                "gripper_busy": seen.gripper_busy,
            }}),
            Answer::Parts(parts) => {
                let parts: Vec<Value> = parts
                    .iter()
                    .map(|it| json!({"part": it.part, "x_wp": pose(&it.x_wp), "sigma": it.sigma}))
                    .collect();
                json!({"parts": parts})
            }
            Answer::Image(image) => json!({"image": {
                "camera": image.camera.name(),
                "time": image.time,
                "x_wt": pose(&image.x_wt),
                "width": image.width,
                "height": image.height,
                "bytes": image.pixels.len(),
            }}),
            Answer::Noted => json!({"noted": {}}),
            Answer::Refused(error) => json!({"refused": {"reason": error.to_string()}}),
            Answer::End(reason) => json!({"end": {"reason": reason}}),
        };
        let mut bytes = value.to_string().into_bytes();
        bytes.push(b'\n');
        if let Answer::Image(image) = self {
            bytes.extend_from_slice(&image.pixels);
        }
        bytes
    }
}

/// A pose as the protocol has it.
pub fn pose(x: &Pose) -> Value {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    json!({"position": [p.x, p.y, p.z], "quat_wxyz": [q.w, q.i, q.j, q.k]})
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn an_agent_says_a_name_and_a_version_that_are_names() {
        let hello = |name: &str, version: &str| {
            let hello = json!({"hello": {"protocol": PROTOCOL, "name": name, "version": version}});
            let Request::Hello(hello) = parse(hello.to_string().as_bytes()).unwrap() else {
                panic!("{name}")
            };
            hello.check()
        };
        assert_eq!(hello("my-agent_2", "1.0+a"), Ok(()));
        for bad in ["", "my agent", "-x", "../x", ".x", "=x", "a\n", "\u{1b}[2J", &"x".repeat(65)] {
            assert!(hello(bad, "1").is_err_and(|why| why.contains("the agent's name must be")), "{bad:?}");
            assert!(hello("x", bad).is_err_and(|why| why.contains("the agent's version must be")), "{bad:?}");
        }
    }
}
