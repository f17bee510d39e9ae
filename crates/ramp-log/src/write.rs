//! Writes a log while an episode runs.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Read, Seek};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use nalgebra::Vector3;
use ramp_assembly::Truth;
use ramp_robot::{ArmCommand, Camera, Command, ImageWidth, Observation, Pose};
use serde_json::{Value, json};

use ramp_referee::{Referee, Seated};
use ramp_result::{EpisodeResult, sha256};

use crate::calls::Encoder;
use crate::error::LogError;
use crate::header::{CALLS, Header, SCHEMA};

/// Periods between two records of the signals: 100 records a second.
const SIGNALS_EVERY: u64 = 10;
/// Periods between two records of true part poses and state hashes: 10 a second.
pub const STATE_EVERY: u64 = 100;
/// Pose changes above these thresholds count as a move since the last record, m and rad.
const MOVED: f64 = 1.0e-5;
/// Bytes of calls that are collected before they are written to the file.
const CALLS_SIZE: usize = 32 * 1024;
/// Size of a chunk, bytes before compression.
const CHUNK: u64 = 512 * 1024;

macro_rules! schema {
    ($name:literal) => {
        include_str!(concat!("../../../data/schema/", $name, ".schema.json"))
    };
}

/// The channels: topic, name of the schema, and the schema itself.
const CHANNELS: [(&str, &str, &str); 8] = [
    ("/episode", "ramp.Episode", schema!("log/episode")),
    ("/robot", "ramp.Sensed", schema!("log/sensed")),
    ("/tip", "foxglove.PoseInFrame", schema!("log/tip")),
    ("/command", "ramp.Command", schema!("log/command")),
    ("/parts", "foxglove.FrameTransforms", schema!("log/parts")),
    ("/events", "ramp.Event", schema!("log/event")),
    ("/referee", "ramp.Verdict", schema!("log/verdict")),
    ("/result", "ramp.EpisodeResult", schema!("episode")),
];

/// The quantities that a log records at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Due {
    /// Robot time, s.
    time: f64,
    /// The robot's observation.
    pub signals: bool,
    /// Poses of the parts.
    pub truth: bool,
    /// Whether the hash of the physics state is needed.
    pub state: bool,
}

/// A log that is being written. Until it is whole it is in a file without a name, so that nobody else can
/// open it, and nothing of it is left when the program ends early.
pub struct Recorder {
    path: PathBuf,
    /// `None` after a failure.
    file: Option<mcap::Writer<BufWriter<File>>>,
    failed: Option<mcap::McapError>,
    /// Number of each channel, in the order of [`CHANNELS`], then the channel of the calls.
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
    calls: Encoder,
    command: Option<Command>,
    shown_command: Option<Command>,
    /// Robot time of the last record of the twin, periods.
    period: u64,
    /// Whether the world was recorded before.
    begun: bool,
    parts: Vec<String>,
    /// The last pose of each part that was written.
    places: Vec<Option<Pose>>,
    connections: Vec<String>,
    verdict: Vec<Option<Seated>>,
}

impl Recorder {
    /// Opens a log for an episode. It is written to a file without a name in the folder of `path`, and put
    /// there when it is whole. `parts` names the parts in the order of the truths that will come,
    /// `connections` those of the goal.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(
        path: &Path,
        header: &Header,
        parts: Vec<String>,
        connections: Vec<String>,
    ) -> Result<Recorder, LogError> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let file = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(|source| LogError::Io { path: path.to_path_buf(), source })?;
        let options = mcap::WriteOptions::new()
            .profile("ramp")
            .library("ramp")
            .chunk_size(Some(CHUNK))
            .compression_threads(0);
        let file = options
            .create(BufWriter::new(file))
            .map_err(|source| LogError::Write { path: path.to_path_buf(), source })?;
        let mut recorder = Recorder {
            path: path.to_path_buf(),
            file: Some(file),
            failed: None,
            channels: BTreeMap::new(),
            sequence: 0,
            calls: Encoder::default(),
            command: None,
            shown_command: None,
            period: 0,
            begun: false,
            places: vec![None; parts.len()],
            parts,
            verdict: vec![None; connections.len()],
            connections,
        };
        recorder.attempt(|recorder| recorder.head(header));
        Ok(recorder)
    }

    /// Runs `work` on the file, unless an earlier write failed.
    fn attempt(&mut self, work: impl FnOnce(&mut Recorder) -> Result<(), mcap::McapError>) {
        if self.failed.is_none() {
            self.failed = work(self).err();
        }
    }

    fn head(&mut self, header: &Header) -> Result<(), mcap::McapError> {
        if let Some(file) = &mut self.file {
            let of = |name: &str, value: &str| (name.to_string(), value.to_string());
            let metadata = BTreeMap::from([
                of("schema", SCHEMA),
                of("rules", &header.rules),
                of("goal", &header.goal.name),
                of("track", &header.track),
                of("seed", &header.seed.to_string()),
                of("kit sha256", &header.kit.sha256),
                of("software", &format!("{} {}", header.software.version, header.software.commit)),
            ]);
            file.write_metadata(&Metadata { name: "ramp".to_string(), metadata })?;
            for (topic, name, schema) in CHANNELS {
                let schema = file.add_schema(name, "jsonschema", schema.as_bytes())?;
                let channel = file.add_channel(schema, topic, "json", &BTreeMap::new())?;
                self.channels.insert(topic, channel);
            }
            let channel = file.add_channel(0, "/calls", CALLS, &BTreeMap::new())?;
            self.channels.insert("/calls", channel);
        }
        self.put("/episode", 0, &serde_json::to_vec(header).map_err(std::io::Error::from)?)
    }

    /// Writes a message; `period` is its robot time.
    fn put(&mut self, topic: &str, period: u64, data: &[u8]) -> Result<(), mcap::McapError> {
        let (Some(file), Some(&channel_id)) = (&mut self.file, self.channels.get(topic)) else {
            return Ok(());
        };
        let time = period * 1_000_000;
        self.sequence = self.sequence.wrapping_add(1);
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: time, publish_time: time };
        file.write_to_known_channel(&header, data)
    }

    fn put_json(&mut self, topic: &str, value: &Value) {
        let period = self.period;
        let text = value.to_string();
        self.attempt(|recorder| recorder.put(topic, period, text.as_bytes()));
    }

    /// The agent is about to advance one period under this command.
    pub fn step(&mut self, command: &Command) {
        self.calls.step(command);
        self.command = Some(command.clone());
    }

    /// The agent is about to read the parts.
    pub fn read_parts(&mut self) {
        self.calls.read_parts();
    }

    /// The agent is about to take an image.
    pub fn look(&mut self, camera: Camera, width: Option<ImageWidth>) {
        self.calls.look(camera, width);
    }

    /// The agent is about to open the shutters of the cameras.
    pub fn expose(&mut self) {
        self.calls.expose();
    }

    /// The last reading or image was delivered; `hash` is the hash of its content.
    pub fn answered(&mut self, hash: u64) {
        self.calls.answered(hash);
    }

    /// The last reading or image was refused.
    pub fn refused(&mut self) {
        self.calls.refused();
    }

    /// The quantities to write now; `time` is robot time, s.
    pub fn due(&self, time: f64) -> Due {
        let period = periods(time);
        let passed = |every: u64| period / every > self.period / every;
        let (signals, state) = (passed(SIGNALS_EVERY), passed(STATE_EVERY));
        Due { time, signals: signals || !self.begun, truth: state || !self.begun, state }
    }

    /// Records the world after a call, as requested by [`Recorder::due`].
    pub fn watch(&mut self, due: Due, seen: Option<&Observation>, truth: Option<&Truth>, state: Option<u64>) {
        self.period = periods(due.time);
        self.begun = true;
        if let Some(state) = state {
            self.calls.state(state);
        }
        if let Some(seen) = seen {
            self.signals(seen);
        }
        if let Some(truth) = truth {
            self.true_parts(truth);
        }
        if self.calls.waiting() > CALLS_SIZE {
            self.put_calls();
        }
    }

    fn put_calls(&mut self) {
        let (period, bytes) = (self.period, self.calls.take());
        self.attempt(|recorder| recorder.put("/calls", period, &bytes));
    }

    fn signals(&mut self, seen: &Observation) {
        let wrench = |from: usize| {
            let [x, y, z]: [f64; 3] = seen.wrench.fixed_rows::<3>(from).into_owned().into();
            json!({"x": round(x, 1e3), "y": round(y, 1e3), "z": round(z, 1e3)})
        };
        let sensed = json!({
            "positions": seen.positions.map(|it| round(it, 1e5)),
            "velocities": seen.velocities.map(|it| round(it, 1e4)),
            "torques": seen.torques.map(|it| round(it, 1e3)),
            "force": wrench(0),
            "moment": wrench(3),
            "width": round(seen.width, 1e5),
        });
        self.put_json("/robot", &sensed);
        let pose = json!({
            "timestamp": self.stamp(),
            "frame_id": "world",
            "pose": {"position": xyz(&seen.x_wt.translation.vector), "orientation": xyzw(&seen.x_wt)},
        });
        self.put_json("/tip", &pose);
        if self.command.is_some() && self.command != self.shown_command {
            self.shown_command.clone_from(&self.command);
            if let Some(command) = &self.command {
                let value = command_json(command);
                self.put_json("/command", &value);
            }
        }
    }

    /// Writes the poses of the parts that have moved.
    fn true_parts(&mut self, truth: &Truth) {
        let stamp = self.stamp();
        let mut transforms = Vec::new();
        for ((name, place), x_wp) in self.parts.iter().zip(&mut self.places).zip(&truth.x_wp) {
            let still = place.as_ref().is_some_and(|before| {
                (before.translation.vector - x_wp.translation.vector).norm() < MOVED
                    && before.rotation.angle_to(&x_wp.rotation) < MOVED
            });
            if !still {
                *place = Some(*x_wp);
                transforms.push(json!({
                    "timestamp": stamp,
                    "parent_frame_id": "world",
                    "child_frame_id": name,
                    "translation": xyz(&x_wp.translation.vector),
                    "rotation": xyzw(x_wp),
                }));
            }
        }
        if !transforms.is_empty() {
            self.put_json("/parts", &json!({"transforms": transforms}));
        }
    }

    /// The referee's verdict now.
    pub fn judge(&mut self, referee: &Referee) {
        for (index, seated) in referee.verdict().iter().enumerate() {
            if self.verdict[index] != *seated {
                self.verdict[index].clone_from(seated);
                let value = json!({
                    "connection": self.connections[index],
                    "peg": seated.as_ref().map(|it| &it.peg),
                    "since": seated.as_ref().map(|it| it.since),
                    "thought": seated.as_ref().map(|it| it.thought),
                });
                self.put_json("/referee", &value);
            }
        }
    }

    fn stamp(&self) -> Value {
        json!({"sec": self.period / 1000, "nsec": self.period % 1000 * 1_000_000})
    }

    /// Writes the end: the last state, the agent's events and the result. Then the log is whole and gets its
    /// name. Returns its SHA-256 in hex.
    ///
    /// # Errors
    /// When something could not be written, now or earlier.
    pub fn finish(mut self, state: u64, result: &EpisodeResult) -> Result<String, LogError> {
        self.calls.state(state);
        self.put_calls();
        let end = self.period;
        for event in &result.events {
            // Structs of numbers and texts always serialise.
            let text = serde_json::to_string(event).unwrap_or_default();
            self.attempt(|recorder| recorder.put("/events", periods(event.time), text.as_bytes()));
        }
        let text = result.to_json();
        self.attempt(|recorder| recorder.put("/result", end, text.as_bytes()));
        let fail = |source| LogError::Write { path: self.path.clone(), source };
        if let Some(source) = self.failed.take() {
            return Err(fail(source));
        }
        let mut bytes = Vec::new();
        if let Some(mut file) = self.file.take() {
            file.finish().map_err(fail)?;
            let file = file.into_inner().into_inner().map_err(std::io::IntoInnerError::into_error);
            file.and_then(|mut file| {
                file.rewind()?;
                file.read_to_end(&mut bytes)
            })
            .map_err(|source| LogError::Io { path: self.path.clone(), source })?;
        }
        ramp_result::write_whole(&self.path, &bytes)
            .map_err(|error| LogError::Io { path: error.path, source: error.source })?;
        Ok(sha256(&bytes))
    }
}

/// Robot time in control periods.
pub fn periods(time: f64) -> u64 {
    (time / ramp_robot::PERIOD).round() as u64
}

/// `value` rounded to a multiple of 1/`parts`: signals are for viewers, and the calls are exact.
fn round(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// To a millionth.
fn fine(value: f64) -> f64 {
    round(value, 1e6)
}

fn xyz(v: &Vector3<f64>) -> Value {
    json!({"x": fine(v.x), "y": fine(v.y), "z": fine(v.z)})
}

fn xyzw(x: &Pose) -> Value {
    let q = x.rotation.quaternion();
    json!({"x": fine(q.i), "y": fine(q.j), "z": fine(q.k), "w": fine(q.w)})
}

/// A command for viewers.
fn command_json(command: &Command) -> Value {
    let joints = |kind: &str, values: &[f64; ramp_robot::DOF]| {
        (kind.to_string(), json!(values.map(fine)), Value::Null)
    };
    let pose = |kind: &str, x: &Pose| {
        let (p, q) = (x.translation.vector, x.rotation.quaternion());
        let (position, quat_wxyz) = ([p.x, p.y, p.z].map(fine), [q.w, q.i, q.j, q.k].map(fine));
        let place = json!({"position": position, "quat_wxyz": quat_wxyz});
        (kind.to_string(), Value::Null, place)
    };
    let (kind, joints, x_wt) = match &command.arm {
        ArmCommand::JointPositions(values) => joints("joint_positions", values),
        ArmCommand::JointVelocities(values) => joints("joint_velocities", values),
        ArmCommand::JointTorques(values) => joints("joint_torques", values),
        ArmCommand::CartesianPose(x_wt) => pose("pose", x_wt),
        ArmCommand::CartesianImpedance(impedance) => pose("impedance", &impedance.x_wt),
    };
    let gripper = json!({"width": fine(command.gripper.width), "force": fine(command.gripper.force)});
    json!({"kind": kind, "joints": joints, "x_wt": x_wt, "gripper": gripper})
}
