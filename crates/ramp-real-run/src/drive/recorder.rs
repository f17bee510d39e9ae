//! The log of a run over the wire, in the form that [`poses`](crate::poses) judges, with what the robot
//! reported and was commanded beside it.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use ramp_log::{LogError, LogFile, signals};
use ramp_result::episode::{Host, RULES, RobotKind};
use ramp_robot::{
    Camera, CameraModel, Command, Event, Image, ImageWidth, Observation, PartReading, Pose, Robot, RobotError,
};
use serde_json::{Value, json};

use super::images;
use super::run::Run;
use crate::poses::SCHEMA;

/// Control periods between two records of the signals.
const SIGNALS_EVERY: u64 = 10;
/// The identity of the run: topic, name of the schema, and the schema itself.
const RUN: (&str, &str, &str) =
    ("/run", "ramp.RealRun", include_str!("../../../../data/schema/real-run.schema.json"));
const NANOSECONDS: f64 = 1e9;

/// The facts of a run at its end.
pub struct RunHead<'a> {
    /// The run.
    pub run: &'a Run<'a>,
    /// The agent's name.
    pub agent: &'a str,
    /// Its version.
    pub version: &'a str,
    /// `done`, or what ended it.
    pub ended: &'a str,
    /// The computer.
    pub host: &'a Host,
}

/// A robot whose calls are logged.
///
/// Times are seconds since the goal was handed over. In lock-step the arm's time stands still while the agent
/// thinks: the log then has the time until the robot was free to move, and after it the arm's own.
pub struct Recorder<'a> {
    robot: &'a mut dyn Robot,
    file: LogFile,
    lock_step: bool,
    /// Whether images are logged.
    images: bool,
    /// When the goal was handed over: by the wall, s since 1970, and by a clock that only goes on.
    handed_over: (f64, Instant),
    /// The robot's time then, s.
    from: f64,
    /// When the robot was first commanded: time since the goal was handed over, and the robot's own, s.
    free: Option<(f64, f64)>,
    /// When the agent was done, s, and until when was measured afterwards.
    end: Option<f64>,
    surveyed: Option<f64>,
    /// Control periods since the last record.
    shown: u64,
    shown_command: Option<Command>,
    /// Messages on `/parts`: the time, and their text. They come after the one on `/run`.
    parts: Vec<(f64, String)>,
}

impl<'a> Recorder<'a> {
    /// Begins a log; its name is `path`. The goal is handed over now.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(path: &Path, robot: &'a mut dyn Robot, run: &Run) -> Result<Recorder<'a>, LogError> {
        let mut file = LogFile::create(path)?;
        let of = |name: &str, value: &str| (name.to_string(), value.to_string());
        file.describe(BTreeMap::from([of("schema", SCHEMA), of("rules", RULES)]));
        file.add_json(&[RUN]);
        file.add_json(&signals::CHANNELS);
        if run.images {
            file.add_json(&images::CHANNELS);
        }
        let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
        let from = robot.observe().time;
        Ok(Recorder {
            robot,
            file,
            lock_step: run.kind == RobotKind::ServedTwinInLockStep,
            images: run.images,
            handed_over: (wall.as_secs_f64(), Instant::now()),
            from,
            free: None,
            end: None,
            surveyed: None,
            shown: SIGNALS_EVERY,
            shown_command: None,
            parts: Vec::new(),
        })
    }

    /// Time since the goal was handed over, s, at a time of the robot, s.
    fn time_at(&self, robot: f64) -> f64 {
        match (self.lock_step, self.free) {
            (true, Some((time, free))) => time + (robot - free).max(0.0),
            (true, None) => self.handed_over.1.elapsed().as_secs_f64(),
            (false, _) => (robot - self.from).max(0.0),
        }
    }

    fn time(&self) -> f64 {
        self.time_at(self.robot.observe().time)
    }

    /// Robot time since the robot was free to move, s.
    pub fn robot_time(&self) -> f64 {
        self.time() - self.planning()
    }

    /// The agent is done.
    pub fn end(&mut self) {
        self.move_freely();
        self.end = Some(self.time());
    }

    /// From now on, at the latest, the robot is free to move.
    fn move_freely(&mut self) {
        if self.free.is_none() {
            self.free = Some((self.time(), self.robot.observe().time));
        }
    }

    /// Time until the robot was free to move, s.
    fn planning(&self) -> f64 {
        self.free.map_or(0.0, |(time, _)| time)
    }

    /// Takes what was measured after the end.
    pub fn surveyed(&mut self, parts: BTreeMap<String, Pose>, took: Duration) {
        let now = self.time().max(self.end.unwrap_or_default() + took.as_secs_f64());
        self.surveyed = Some(now);
        self.see(now, parts.iter().map(|(part, x_wp)| (part.as_str(), x_wp)));
    }

    fn see<'p>(&mut self, time: f64, parts: impl Iterator<Item = (&'p str, &'p Pose)>) {
        let stamp = self.stamp(time);
        let transforms: Vec<Value> = parts.map(|(part, x_wp)| signals::part(part, x_wp, &stamp)).collect();
        if !transforms.is_empty() {
            self.parts.push((time, json!({ "transforms": transforms }).to_string()));
        }
    }

    /// A time on the wall, ns since 1970.
    fn nanoseconds(&self, time: f64) -> u64 {
        ((self.handed_over.0 + time) * NANOSECONDS).round() as u64
    }

    fn stamp(&self, time: f64) -> Value {
        let (all, second) = (self.nanoseconds(time), NANOSECONDS as u64);
        json!({"sec": all / second, "nsec": all % second})
    }

    fn put(&mut self, topic: &str, time: f64, value: &Value) {
        let at = self.nanoseconds(time);
        self.file.put(topic, at, value.to_string().as_bytes());
    }

    /// Logs what the robot reports, a hundred times a second.
    fn show(&mut self, seen: &Observation, command: &Command) {
        let time = self.time_at(seen.time);
        self.shown += 1;
        if self.shown < SIGNALS_EVERY {
            return;
        }
        self.shown = 0;
        self.put("/robot", time, &signals::sensed(seen));
        let tip = signals::tip(&seen.x_wt, &self.stamp(time));
        self.put("/tip", time, &tip);
        if self.shown_command.as_ref() != Some(command) {
            self.put("/command", time, &signals::command(command));
            self.shown_command = Some(command.clone());
        }
    }

    /// Writes the end, and gives the log its name. Returns its bytes.
    ///
    /// # Errors
    /// When something could not be written, now or earlier.
    pub fn finish(mut self, head: &RunHead, events: &[Event]) -> Result<Vec<u8>, LogError> {
        let planning = self.planning();
        let end = self.end.unwrap_or(planning);
        for event in events {
            let time = self.time_at(self.from + event.time);
            // Structs of numbers and texts always serialise.
            let value = serde_json::to_value(event).unwrap_or_default();
            self.put("/events", time, &value);
        }
        let Run { assembly, arm, track, repeat, kind, robot, scorer, source, .. } = head.run;
        let mut run = json!({
            "schema": SCHEMA, "rules": RULES, "goal": assembly.name, "repeat": repeat, "track": track.name(),
            "agent": head.agent, "version": head.version, "robot": robot, "computer": head.host.cpu,
            "cores": head.host.cores, "scorer": scorer, "source": source, "kind": kind, "arm": arm.name,
            "begin": self.stamp(0.0), "planning": planning, "end": self.stamp(end), "ended": head.ended,
        });
        if let Some(surveyed) = self.surveyed {
            run["surveyed"] = self.stamp(surveyed);
        }
        self.put("/run", 0.0, &run);
        for (time, text) in std::mem::take(&mut self.parts) {
            let at = self.nanoseconds(time);
            self.file.put("/parts", at, text.as_bytes());
        }
        Ok(self.file.finish()?.0)
    }
}

impl Robot for Recorder<'_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.move_freely();
        let seen = self.robot.step(command)?;
        self.show(&seen, command);
        Ok(seen)
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let parts = self.robot.read_parts()?;
        // After the end, the survey is what counts.
        if self.end.is_none() {
            let time = self.time();
            self.see(time, parts.iter().map(|reading| (reading.part.as_str(), &reading.x_wp)));
        }
        Ok(parts)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.robot.expose()
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        let image = self.robot.look_sized(camera, width)?;
        if self.images {
            let time = self.time_at(image.time);
            // An image that is not whole is the agent's to refuse.
            if let Ok(message) = images::message(&image, &self.stamp(time)) {
                self.put(images::topic(camera), time, &message);
            }
            if let Some(depth) = &image.depth
                && let Ok(message) = images::depth_message(&image, depth, &self.stamp(time))
            {
                self.put(images::depth_topic(camera), time, &message);
            }
        }
        Ok(image)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}
