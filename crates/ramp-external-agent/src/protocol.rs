//! The messages of the protocol: one JSON object a line, its only key the kind of message. An image is
//! followed by its pixels as bytes, and by its depths, if it has them.

use anstream::adapter::strip_str;
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector6};
use ramp_kit::source::{A_NAME, is_name, is_text, plain, shorten, without_mark};
use ramp_robot::{
    ArmCommand, Camera, Command, DOF, Event, EventKind, GripperCommand, Image, ImageWidth, Impedance,
    MOST_EVENT, OLDER_KINDS, Observation, PartReading, Pose, RobotError, is_reserved,
};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::limits::MOST_PERIODS;
use crate::observation::{observation, pose};

/// The version of the protocol.
pub const PROTOCOL: u32 = 1;
/// The longest message of an agent, bytes.
pub const LONGEST_MESSAGE: usize = 4 << 20;
/// The longest reason that may hold an agent's own words, characters.
const LONGEST_REASON: usize = 200;
/// Longest beginning of a line that is no message in the reason of an end, characters.
const LONGEST_QUOTE: usize = 80;
/// The longest text of an older event, characters.
const LONGEST_WHAT: usize = 200;
/// The longest message of the parser about an event, characters: it lists all kinds.
const LONGEST_WHY: usize = 400;
/// How far the length of a quaternion may be from one.
const QUATERNION: f64 = 1e-3;
/// The longest time that planning can have taken, s.
const LONGEST_PLANNING: f64 = 1e6;

/// A message of an agent.
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
    /// Reports an event.
    Event(EventText),
    /// Answers a rehearsal: the motions that the program will ask for.
    Rehearsal(RehearsalText),
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
    /// A program for a single action can rehearse it: it answers `rehearse` in place of a goal.
    #[serde(default)]
    pub rehearses: bool,
}

/// The motions that a program for a single action will ask for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RehearsalText {
    /// Alternatives, the preferred one first; each a list of motions.
    pub alternatives: Value,
}

impl Hello {
    /// Whether this can be worked with.
    ///
    /// # Errors
    /// The mistake, for a person.
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
        if is_reserved(&self.name) {
            return Err(format!("the agent's name is `{}`, which is the benchmark's own", self.name));
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
pub(crate) struct PoseText {
    position: [f64; 3],
    quat_wxyz: [f64; 4],
}

impl PoseText {
    pub(crate) fn pose(&self) -> Result<Pose, String> {
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
    /// The mistake, for a person.
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

/// A camera, and the size of an image.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Look {
    camera: CameraText,
    /// Pixels in a row.
    #[serde(default)]
    size: Option<u64>,
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

    /// The width of the image; `None` is the camera's own.
    ///
    /// # Errors
    /// The mistake, for a person.
    pub fn width(&self) -> Result<Option<ImageWidth>, String> {
        let Some(size) = self.size else { return Ok(None) };
        let (least, most) = (ImageWidth::LEAST, ImageWidth::MOST);
        let width = ImageWidth::new(size)
            .ok_or_else(|| format!("asks for an image of size {size}, and {least} to {most} are possible"))?;
        Ok(Some(width))
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
    /// The mistake, for a person.
    pub fn check(&self) -> Result<(), String> {
        if (0.0..=LONGEST_PLANNING).contains(&self.planning) && self.coarse.max(self.fine) <= 1_000_000 {
            Ok(())
        } else {
            Err("tells of a plan that cannot be".to_string())
        }
    }
}

/// An event that an agent reports: `kind` and the fields of that kind; or, as up to version 0.1.0 of this
/// program, one of the older kinds with its text in `what`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct EventText {
    fields: Map<String, Value>,
}

impl EventText {
    /// The event, at a robot time (s).
    ///
    /// # Errors
    /// The mistake, for a person.
    pub fn at(self, time: f64) -> Result<Event, String> {
        let text = |name: &str| self.fields.get(name).and_then(Value::as_str);
        let older = (self.fields.len() == 2).then(|| Some((text("kind")?, text("what")?))).flatten();
        let kind: EventKind = match older.filter(|(kind, _)| OLDER_KINDS.contains(kind)) {
            Some((kind, what)) if is_text(what, LONGEST_WHAT) => {
                return Ok(Event::new(time, EventKind::of_words(kind, what)));
            }
            Some(_) => {
                return Err(format!(
                    "has an event of more than {LONGEST_WHAT} characters, or with a control character"
                ));
            }
            None => serde_json::from_value(Value::Object(self.fields)).map_err(|error| {
                format!("has an event that is not understood: {}", plain(&error.to_string(), LONGEST_WHY))
            })?,
        };
        if kind.is_of_episode() {
            return Err(format!(
                "has an event of the kind `{}`, which only the episode reports",
                kind.name()
            ));
        }
        kind.check(MOST_EVENT).map_err(|why| format!("has an event that {why}"))?;
        Ok(Event::new(time, kind))
    }
}

/// Understands a line.
///
/// # Errors
/// Why it is no message, to be put after "message 7 of the agent".
pub fn parse(line: &[u8]) -> Result<Request, String> {
    // Some runtimes begin their output with a byte order mark.
    let line = without_mark(line);
    serde_json::from_slice(line).map_err(|error| {
        let text = String::from_utf8_lossy(line);
        let no_number = ["NaN", "Infinity"].into_iter().find(|word| text.contains(word));
        match no_number {
            Some(word) if error.is_syntax() => format!("holds {word}, which is no number for a robot"),
            _ if !text.trim_start().starts_with('{') => format!(
                "is no message: `{}`. Standard output is for messages; print all else to standard error",
                quoted(&text)
            ),
            _ => {
                let error = plain(&error.to_string(), LONGEST_REASON);
                format!("is not understood: {error}: `{}`", quoted(&text))
            }
        }
    })
}

/// The beginning of a line for a message to a person, without escape sequences.
fn quoted(line: &str) -> String {
    // What lies beyond cannot be among the first characters.
    let mut characters = line.chars();
    let begin: String = characters.by_ref().take(2 * LONGEST_QUOTE).collect();
    let mut short = plain(strip_str(&begin).to_string().trim(), LONGEST_QUOTE);
    if characters.next().is_some() && !short.ends_with('…') {
        short.push('…');
    }
    short
}

/// An answer to an agent.
#[derive(Clone, Debug)]
pub enum Answer {
    /// After hello: all about the goal.
    Goal(Value),
    /// After the hello of a program that rehearses, in place of a goal: the task.
    Rehearse(Value),
    /// The last observation.
    Observation(Observation),
    /// Poses of parts.
    Parts(Vec<PartReading>),
    /// An image.
    Image(Image),
    /// Heard.
    Noted,
    /// The robot does not do this, and goes on.
    Refused(RobotError),
    /// The arm stopped, stood for a while and is ready again; what was asked for was not done to its end.
    Recovered {
        /// The error that stopped it.
        why: String,
        /// Robot time for which it stood, s.
        after: f64,
        /// The observation since.
        seen: Observation,
    },
    /// The episode is over.
    End(String),
}

impl Answer {
    /// As it goes through the pipe.
    pub fn to_bytes(&self) -> Vec<u8> {
        let value = match self {
            Answer::Goal(goal) => json!({"goal": goal}),
            Answer::Rehearse(task) => json!({"rehearse": {"task": task}}),
            Answer::Observation(seen) => json!({"observation": observation(seen)}),
            Answer::Parts(parts) => {
                let parts: Vec<Value> = parts
                    .iter()
                    .map(|it| json!({"part": it.part, "x_wp": pose(&it.x_wp), "sigma": it.sigma}))
                    .collect();
                json!({"parts": parts})
            }
            Answer::Image(image) => {
                let mut head = json!({
                    "camera": image.camera.name(),
                    "time": image.time,
                    "x_wt": pose(&image.x_wt),
                    "width": image.width,
                    "height": image.height,
                    "bytes": image.pixels.len(),
                });
                if let Some(depth) = &image.depth {
                    head["depth_bytes"] = (2 * depth.len()).into();
                }
                json!({"image": head})
            }
            Answer::Noted => json!({"noted": {}}),
            Answer::Refused(error) => json!({"refused": {"reason": error.to_string()}}),
            Answer::Recovered { why, after, seen } => {
                json!({"recovered": {"reason": why, "after": after, "observation": observation(seen)}})
            }
            Answer::End(reason) => json!({"end": {"reason": reason}}),
        };
        let mut bytes = value.to_string().into_bytes();
        bytes.push(b'\n');
        if let Answer::Image(image) = self {
            bytes.extend_from_slice(&image.pixels);
            bytes.extend_from_slice(&image.depth_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use ramp_robot::Fault;

    use super::*;

    fn event(event: Value) -> Result<Event, String> {
        let Request::Event(event) = parse(json!({ "event": event }).to_string().as_bytes())? else {
            panic!("not an event");
        };
        event.at(1.5)
    }

    #[test]
    fn an_agent_reports_events_in_the_form_of_results_and_in_the_older_one() {
        let jam =
            json!({"kind": "fault", "fault": "jammed", "part": "b4", "remaining": 0.003, "force": 25.0});
        let fault = Fault::Jammed { part: "b4".into(), remaining: 0.003, force: 25.0 };
        assert_eq!(event(jam), Ok(Event::new(1.5, fault.into())));
        let push = json!({"kind": "action_begun", "action": "push", "beam": "b4", "link": "b4l2"});
        assert_eq!(event(push).unwrap().kind.to_string(), "push b4 by b4l2");
        let older = json!({"kind": "diagnosis", "what": "jam: b4 stands still"});
        assert_eq!(event(older).unwrap().kind.to_string(), "jam: b4 stands still");
    }

    #[test]
    fn events_are_bounded_in_length_depth_and_characters() {
        let note = |text: &str| json!({"kind": "note", "text": text});
        assert!(event(note(&"é".repeat(225))).is_ok());
        let mut deep = json!("b4");
        for _ in 0..5 {
            deep = json!({ "beam": deep });
        }
        let many = vec!["a"; 80];
        for (wrong, why) in [
            (note(&"é".repeat(226)), "has an event that has 251 characters, and 250 is the most"),
            (note("\u{1b}[2J"), "a control character"),
            (json!({"kind": "note", "text": 1}), "not understood"),
            (json!({"kind": "note"}), "missing field `text`"),
            (json!({"kind": "dance"}), "unknown variant `dance`, expected one of `action_begun`"),
            (json!({"kind": "clipped", "t": 1.0}), "unknown field `t`"),
            (json!({"kind": "stopped", "why": "so it says"}), "which only the episode reports"),
            (json!({"kind": "fault_struck", "fault": "jam"}), "which only the episode reports"),
            (json!({"kind": "action_begun", "action": "x", "to": deep}), "nested too deep"),
            (json!({"kind": "action_begun", "action": "x", "to": many}), "characters, and 250 is the most"),
            (json!({"kind": "action_begun", "action": "x", "t": 1.0}), "an argument `t`"),
            (json!({"kind": "action_begun", "action": "x", "\u{1b}": 1.0}), "not a name"),
            (json!({"kind": "start", "what": "é".repeat(201)}), "more than 200 characters"),
            (json!({"kind": "start", "what": "a\nb"}), "a control character"),
        ] {
            let refused = event(wrong.clone());
            assert!(refused.as_ref().is_err_and(|it| it.contains(why)), "{wrong}: {refused:?}");
        }
    }

    #[test]
    fn what_is_no_message_is_quoted_in_short_and_without_escape_sequences() {
        let why = |line: &str| parse(line.as_bytes()).unwrap_err();
        let text = why("\u{1b}[1;31mbeam\u{1b}[0m b4\u{7} found");
        assert!(text.starts_with("is no message: `beam b4 found`. Standard output is"), "{text}");
        assert!(text.ends_with("print all else to standard error"), "{text}");
        assert!(why("42").starts_with("is no message: `42`"));
        assert!(why("").starts_with("is no message: ``"));
        let long = why(&"é\u{1b}]".repeat(1 << 20));
        assert!(long.chars().count() < 200 && long.contains('…') && !long.contains('\u{1b}'), "{long}");
        let python = why("{'step': 1}");
        assert!(python.starts_with("is not understood: key must be a string"), "{python}");
        assert!(python.ends_with(": `{'step': 1}`"), "{python}");
    }

    /// A program reads as many bytes as the line says, with depth and without.
    #[test]
    fn depths_follow_the_pixels() {
        let image = |depth| Image {
            camera: Camera::Wrist,
            time: 0.5,
            x_wt: Pose::identity(),
            width: 2,
            height: 1,
            pixels: vec![7; 6],
            depth,
        };
        let sent = |depth| {
            let bytes = Answer::Image(image(depth)).to_bytes();
            let line = bytes.iter().position(|byte| *byte == b'\n').unwrap();
            let head: Value = serde_json::from_slice(&bytes[..line]).unwrap();
            (head["image"]["depth_bytes"].clone(), bytes[line + 1..].to_vec())
        };
        assert_eq!(sent(None), (Value::Null, vec![7; 6]));
        assert_eq!(sent(Some(vec![1, 0x0203])), (4.into(), vec![7, 7, 7, 7, 7, 7, 1, 0, 3, 2]));
    }

    #[test]
    fn an_image_has_a_size_that_a_camera_can_give() {
        let width = |look: Value| {
            let Request::Look(look) = parse(json!({ "look": look }).to_string().as_bytes())? else {
                panic!("not a look");
            };
            look.width()
        };
        assert_eq!(width(json!({"camera": "wrist"})), Ok(None));
        assert_eq!(width(json!({"camera": "wrist", "size": 224})), Ok(ImageWidth::new(224)));
        for wrong in [0, 15, 1281, u64::MAX] {
            let refused = width(json!({"camera": "wrist", "size": wrong}));
            assert!(
                refused.as_ref().is_err_and(|why| why.contains("16 to 1280 are possible")),
                "{refused:?}"
            );
        }
        assert!(width(json!({"camera": "wrist", "size": -1})).is_err());
    }

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
        for own in ["baseline", "baseline+mine", "blind-tape"] {
            assert!(hello(own, "1").is_err_and(|why| why.contains("the benchmark's own")), "{own}");
        }
        for bad in ["", "my agent", "-x", "../x", ".x", "=x", "a\n", "\u{1b}[2J", &"x".repeat(65)] {
            assert!(hello(bad, "1").is_err_and(|why| why.contains("the agent's name must be")), "{bad:?}");
            assert!(hello("x", bad).is_err_and(|why| why.contains("the agent's version must be")), "{bad:?}");
        }
    }
}
