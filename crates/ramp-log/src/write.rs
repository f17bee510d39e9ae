//! Writes a log while an episode runs.

use std::collections::BTreeMap;
use std::path::Path;

use ramp_assembly::Truth;
use ramp_robot::{Camera, Command, ImageWidth, Observation, Pose};
use serde_json::{Value, json};

use ramp_referee::{Referee, Seated};
use ramp_result::EpisodeResult;

use crate::calls::Encoder;
use crate::channels::LogFile;
use crate::error::LogError;
use crate::header::{CALLS, Header, SCHEMA};
use crate::signals;

/// Periods between two records of the signals: 100 records a second.
const SIGNALS_EVERY: u64 = 10;
/// Periods between two records of true part poses and state hashes: 10 a second.
pub const STATE_EVERY: u64 = 100;
/// Pose changes above these thresholds count as a move since the last record, m and rad.
const MOVED: f64 = 1.0e-5;
/// Bytes of calls that are collected before they are written to the file.
const CALLS_SIZE: usize = 32 * 1024;

/// The channels beside those of [`signals`]: topic, name of the schema, and the schema itself.
const EPISODE: (&str, &str, &str) =
    ("/episode", "ramp.Episode", include_str!("../../../data/schema/log/episode.schema.json"));
const JUDGEMENT: [(&str, &str, &str); 2] = [
    ("/referee", "ramp.Verdict", include_str!("../../../data/schema/log/verdict.schema.json")),
    ("/result", "ramp.EpisodeResult", include_str!("../../../data/schema/episode.schema.json")),
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

/// A log that is being written, in a [`LogFile`].
pub struct Recorder {
    file: LogFile,
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
        let mut file = LogFile::create(path)?;
        head(&mut file, header);
        Ok(Recorder {
            file,
            calls: Encoder::default(),
            command: None,
            shown_command: None,
            period: 0,
            begun: false,
            places: vec![None; parts.len()],
            parts,
            verdict: vec![None; connections.len()],
            connections,
        })
    }

    fn put_json(&mut self, topic: &str, value: &Value) {
        self.file.put(topic, nanoseconds(self.period), value.to_string().as_bytes());
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
        self.file.put("/calls", nanoseconds(self.period), &self.calls.take());
    }

    fn signals(&mut self, seen: &Observation) {
        self.put_json("/robot", &signals::sensed(seen));
        self.put_json("/tip", &signals::tip(&seen.x_wt, &self.stamp()));
        if self.command.is_some() && self.command != self.shown_command {
            self.shown_command.clone_from(&self.command);
            if let Some(command) = &self.command {
                let value = signals::command(command);
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
                transforms.push(signals::part(name, x_wp, &stamp));
            }
        }
        if !transforms.is_empty() {
            self.put_json("/parts", &json!({"transforms": transforms}));
        }
    }

    /// The referee's verdict now. A part that is to be back in its place counts under its own name.
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
        for event in &result.events {
            // Structs of numbers and texts always serialise.
            let text = serde_json::to_string(event).unwrap_or_default();
            self.file.put("/events", nanoseconds(periods(event.time)), text.as_bytes());
        }
        self.file.put("/result", nanoseconds(self.period), result.to_json().as_bytes());
        Ok(self.file.finish()?.1)
    }
}

/// Describes the log, adds its channels, and writes the inputs of the episode.
fn head(file: &mut LogFile, header: &Header) {
    let of = |name: &str, value: &str| (name.to_string(), value.to_string());
    file.describe(BTreeMap::from([
        of("schema", SCHEMA),
        of("rules", &header.rules),
        of("goal", &header.goal.name),
        of("track", &header.track),
        of("seed", &header.seed.to_string()),
        of("kit sha256", &header.kit.sha256),
        of("software", &format!("{} {}", header.software.version, header.software.commit)),
    ]));
    file.add_json(&[EPISODE]);
    file.add_json(&signals::CHANNELS);
    file.add_json(&JUDGEMENT);
    file.add_encoded("/calls", CALLS);
    // Structs of numbers and texts always serialise.
    file.put("/episode", 0, &serde_json::to_vec(header).unwrap_or_default());
}

/// Robot time in control periods.
pub fn periods(time: f64) -> u64 {
    (time / ramp_robot::PERIOD).round() as u64
}

/// ns.
fn nanoseconds(periods: u64) -> u64 {
    periods * 1_000_000
}
