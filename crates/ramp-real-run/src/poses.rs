//! Logs of camera-measured part poses of a real robot's run, judged by the twin's referee.
//!
//! A log is an MCAP file with two channels of JSON messages: `/run`, one message that identifies
//! the run (`data/schema/real-run.schema.json`), and `/parts`, the poses of parts over time in the
//! format of the twin's logs (`foxglove.FrameTransforms`, `data/schema/log/parts.schema.json`). The
//! pose of a tag on a part is accepted instead of the part's pose.
//! `docs/src/reference/real-runs.md` describes the format. Impossible messages are refused with
//! their number and time.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use ramp_assembly::Assembly;
use ramp_assembly::Truth;
use ramp_kit::source::{A_NAME, MAX_TITLE, is_name, is_text, nearest, plain, shorten};
use ramp_kit::tags::{self, SHEET_ID, TagPlace};
use ramp_kit::{Kit, Pose};
use ramp_robot::Track;
use serde::Deserialize;

use ramp_log::LogError;
use ramp_log::records::{Limits, Record, bytes_of, walk};
use ramp_referee::Referee;
use ramp_result::episode::completion;
use ramp_result::episode::{
    AgentInfo, Ended, EpisodeResult, Host, PegResult, PlanInfo, RULES, RealRun, SCHEMA as EPISODE, Software,
    Time,
};
use ramp_result::sha256;

/// The version of the format of these logs.
pub const SCHEMA: &str = "ramp-poses-1";
/// The frame that all poses are given in: the world of the kit.
const WORLD: &str = "world";
/// Time limit of an episode by the rules, s of robot time.
const LIMIT: f64 = 1800.0;
/// Longest time of planning, s.
const LONGEST: f64 = 1.0e6;
/// Largest distance of the clamped beam from its nominal pose, m; beyond that, the poses are not in
/// the expected frame.
const CLAMPED: f64 = 10.0e-3;
/// Largest distance of a part from the origin, m.
const FAR: f64 = 10.0;
/// Largest deviation of a quaternion's norm from one.
const UNIT: f64 = 1.0e-3;
/// Coordinate of a part that was not detected yet, m: far from every hole.
const UNSEEN: f64 = 1.0e3;

/// Identity of the run.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    /// Checked before all other fields.
    #[serde(rename = "schema")]
    _schema: String,
    rules: String,
    goal: String,
    repeat: u32,
    track: String,
    agent: String,
    version: String,
    robot: String,
    computer: String,
    cores: usize,
    scorer: String,
    source: String,
    begin: Stamp,
    planning: f64,
    end: Stamp,
    ended: String,
}

/// A time by the clock of the poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stamp {
    sec: u64,
    nsec: u32,
}

impl Stamp {
    /// Seconds since `begin`, with the resolution of a nanosecond for any epoch.
    fn since(self, begin: Stamp) -> f64 {
        let whole = i128::from(self.sec) - i128::from(begin.sec);
        let nanoseconds = whole * 1_000_000_000 + i128::from(self.nsec) - i128::from(begin.nsec);
        nanoseconds as f64 / 1e9
    }
}

/// Measured poses of parts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sight {
    transforms: Vec<Transform>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Transform {
    timestamp: Stamp,
    parent_frame_id: String,
    child_frame_id: String,
    translation: Vector,
    rotation: Rotation,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rotation {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

/// Reference data for reading a log.
pub struct Reader<'a> {
    /// The parts.
    pub kit: &'a Kit,
    /// The goals that a log may name.
    pub goals: &'a [Assembly],
    /// The program that made the results.
    pub software: &'a Software,
}

impl Reader<'_> {
    /// Reads and judges the log in a file.
    ///
    /// # Errors
    /// When it cannot be read, or contains impossible events.
    pub fn read(&self, path: &Path) -> Result<EpisodeResult, LogError> {
        self.from_bytes(path, &bytes_of(path, &Limits::default())?)
    }

    /// Reads and judges the log in a file's bytes; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Reader::read`].
    pub fn from_bytes(&self, path: &Path, bytes: &[u8]) -> Result<EpisodeResult, LogError> {
        let mut channels: BTreeMap<u16, bool> = BTreeMap::new();
        let mut run: Option<Run> = None;
        let mut number = 0;
        walk(bytes, &Limits::default(), |record| match record {
            Record::Channel(channel) => {
                let is_run = match channel.topic {
                    b"/run" => true,
                    b"/parts" => false,
                    _ => return Ok(()),
                };
                if channel.encoding != b"json" {
                    let topic = if is_run { "/run" } else { "/parts" };
                    let found = shorten(&String::from_utf8_lossy(channel.encoding));
                    return Err(format!("{topic} is encoded as `{found}`, expected `json`"));
                }
                // A writer repeats its channels at the end of the file.
                channels.entry(channel.id).or_insert(is_run);
                Ok(())
            }
            Record::Message { channel, data } => match (channels.get(&channel), &mut run) {
                (None, _) => Ok(()),
                (Some(true), None) => {
                    run = Some(self.head(data).map_err(|why| format!("/run: {why}"))?);
                    Ok(())
                }
                (Some(true), Some(_)) => Err("it has two messages on /run, expected one".to_string()),
                (Some(false), None) => Err("a message on /parts comes before the one on /run".to_string()),
                (Some(false), Some(run)) => {
                    number += 1;
                    run.see(data).map_err(|why| format!("/parts, message {number}: {why}"))
                }
            },
        })
        .map_err(|wrong| wrong.at(path))?;
        let other = |what: String| LogError::Other { path: path.to_path_buf(), what };
        let run = run.ok_or_else(|| other("it has no message on /run".to_string()))?;
        run.result(self.software, &sha256(bytes)).map_err(other)
    }

    /// Reads the identity of the run.
    fn head(&self, data: &[u8]) -> Result<Run<'_>, String> {
        #[derive(Deserialize)]
        struct Only {
            schema: String,
        }
        let Only { schema } =
            serde_json::from_slice(data).map_err(|error| plain(&error.to_string(), MAX_TITLE))?;
        if schema != SCHEMA {
            return Err(format!("found the schema `{}`, expected `{SCHEMA}`", shorten(&schema)));
        }
        let head: Head =
            serde_json::from_slice(data).map_err(|error| plain(&error.to_string(), MAX_TITLE))?;
        if head.rules != RULES {
            return Err(format!("the rules are of version `{}`, expected {RULES}", shorten(&head.rules)));
        }
        let names = || self.goals.iter().map(|goal| goal.name.as_str());
        let unknown = |what: &str, found: &str, near: Option<&str>| {
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!("there is no {what} `{}`{near}", shorten(found))
        };
        let goal = self.goals.iter().find(|goal| goal.name == head.goal);
        let goal = goal.ok_or_else(|| unknown("goal", &head.goal, nearest(&head.goal, names())))?;
        let tracks = || Track::ALL.iter().map(|track| track.name());
        if tracks().all(|name| name != head.track) {
            return Err(unknown("track", &head.track, nearest(&head.track, tracks())));
        }
        for (what, text) in [("agent", &head.agent), ("version", &head.version)] {
            if !is_name(text) {
                return Err(format!("`{what}` is `{}`, expected {A_NAME}", shorten(text)));
            }
        }
        let words = [
            ("robot", &head.robot),
            ("computer", &head.computer),
            ("scorer", &head.scorer),
            ("source", &head.source),
            ("ended", &head.ended),
        ];
        for (what, text) in words {
            if text.trim().is_empty() {
                return Err(format!("`{what}` is empty"));
            }
            if !is_text(text, MAX_TITLE) {
                let text = shorten(text);
                return Err(format!(
                    "`{what}` is `{text}`, expected at most {MAX_TITLE} characters and no control character"
                ));
            }
        }
        for (name, count) in [("repeat", head.repeat as usize), ("cores", head.cores)] {
            if !(1..=100_000).contains(&count) {
                return Err(format!("`{name}` is {count}, expected 1 to 100000"));
            }
        }
        let total = head.end.since(head.begin);
        if !(0.0..=LONGEST).contains(&head.planning) || head.planning > total {
            return Err(format!(
                "the robot was free to move after {} s, expected a time between begin and end, 0 to {total} s",
                head.planning
            ));
        }
        if total - head.planning > LIMIT {
            return Err(format!(
                "it ends after {:.0} s of robot time, and the rules end an episode after {LIMIT} s",
                total - head.planning
            ));
        }
        let (beams, pegs) = (self.kit.beams.iter(), self.kit.pegs.iter());
        let parts: Vec<String> =
            beams.map(|beam| &beam.name).chain(pegs.map(|peg| &peg.name)).cloned().collect();
        let unseen = Pose::translation(0.0, 0.0, UNSEEN);
        let base = &goal.beams[goal.base];
        let mut x_wp = vec![unseen; parts.len()];
        if let Some(index) = parts.iter().position(|part| *part == base.beam.name) {
            x_wp[index] = self.kit.x_wa() * base.x_ab;
        }
        let referee = Referee::new(goal, parts.iter().map(String::as_str));
        let truth = Truth { time: 0.0, x_wp };
        let tags = tags::places(self.kit);
        Ok(Run { kit: self.kit, goal, head, parts, tags, truth, referee, seen: None })
    }
}

/// A run while its messages are read.
struct Run<'a> {
    kit: &'a Kit,
    goal: &'a Assembly,
    head: Head,
    parts: Vec<String>,
    /// The tags on the parts.
    tags: Vec<TagPlace>,
    /// The last known pose of each part.
    truth: Truth,
    referee: Referee,
    /// The time of the last message.
    seen: Option<Stamp>,
}

impl Run<'_> {
    /// Reads one message, and passes it to the referee.
    fn see(&mut self, data: &[u8]) -> Result<(), String> {
        let sight: Sight =
            serde_json::from_slice(data).map_err(|error| plain(&error.to_string(), MAX_TITLE))?;
        // Number of tags that measured each part, by its index.
        let mut tags = BTreeMap::new();
        for transform in &sight.transforms {
            let stamp = transform.timestamp;
            let time = stamp.since(self.head.begin);
            self.take(transform, time, &mut tags).map_err(|why| format!("at {time:.3} s, {why}"))?;
            self.seen = Some(stamp);
            self.truth.time = time;
        }
        if !sight.transforms.is_empty() {
            self.referee.watch(&self.truth, 0.0);
        }
        Ok(())
    }

    fn take(
        &mut self,
        transform: &Transform,
        time: f64,
        tags: &mut BTreeMap<usize, f64>,
    ) -> Result<(), String> {
        if transform.timestamp.nsec > 999_999_999 {
            return Err("a second has more than 999999999 nanoseconds".to_string());
        }
        if let Some(before) = self.seen.filter(|before| transform.timestamp < *before) {
            return Err(format!("time runs backwards, after {:.3} s", before.since(self.head.begin)));
        }
        if time < 0.0 {
            return Err("a part was seen before the beginning".to_string());
        }
        if transform.timestamp > self.head.end {
            return Err(format!(
                "a part was seen after the end, {:.3} s",
                self.head.end.since(self.head.begin)
            ));
        }
        let name = &transform.child_frame_id;
        // A tag is `tag` and its id.
        let tag = name.strip_prefix("tag").and_then(|id| id.parse::<u32>().ok());
        let place = tag.and_then(|id| self.tags.iter().find(|place| place.id == id));
        let part = place.map_or(name, |place| &place.part);
        let index = self.parts.iter().position(|known| known == part);
        if index.is_none() && tag != Some(SHEET_ID) {
            let near = nearest(name, self.parts.iter().map(String::as_str));
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return Err(format!("the kit has no part or tag `{}`{near}", shorten(name)));
        }
        if transform.parent_frame_id != WORLD {
            let found = shorten(&transform.parent_frame_id);
            return Err(format!("{name} is given in the frame `{found}`, expected `{WORLD}`"));
        }
        let Vector { x, y, z } = transform.translation;
        let Rotation { x: i, y: j, z: k, w } = transform.rotation;
        if [x, y, z].iter().any(|value| !value.is_finite() || value.abs() > FAR) {
            return Err(format!("{name} is at ({x}, {y}, {z}) m, expected it within {FAR} m"));
        }
        let quaternion = Quaternion::new(w, i, j, k);
        if (quaternion.norm() - 1.0).abs() > UNIT || !quaternion.norm().is_finite() {
            return Err(format!(
                "the rotation of {name} has the length {}, expected a unit quaternion",
                quaternion.norm()
            ));
        }
        let seen = Pose::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(quaternion));
        // The sheet's own tag belongs to no part.
        let Some(index) = index else { return Ok(()) };
        let x_wp = match place {
            None => seen,
            Some(place) => {
                // The mean over all tags on a part in one message.
                let x_wp = seen * place.x_pg.inverse();
                let count = tags.entry(index).or_insert(0.0);
                *count += 1.0;
                if *count > 1.0 {
                    let mean = self.truth.x_wp[index].try_lerp_slerp(&x_wp, 1.0 / *count, UNIT);
                    mean.ok_or_else(|| {
                        format!("{name} and the other tags on {part} disagree on its orientation")
                    })?
                } else {
                    x_wp
                }
            }
        };
        let base = &self.goal.beams[self.goal.base];
        if *part == base.beam.name {
            let nominal = self.kit.x_wa() * base.x_ab;
            let off = (x_wp.translation.vector - nominal.translation.vector).norm();
            if off > CLAMPED {
                return Err(format!(
                    "{part}, which is clamped, is {:.0} mm from its place: are the poses in the frame of the robot's base?",
                    off * 1e3
                ));
            }
        }
        self.truth.x_wp[index] = x_wp;
        Ok(())
    }

    fn result(self, software: &Software, log: &str) -> Result<EpisodeResult, String> {
        if self.seen.is_none() {
            return Err("it has no pose on /parts".to_string());
        }
        let head = self.head;
        let mut pegs = Vec::new();
        for (connection, seated) in self.goal.connections.iter().zip(self.referee.verdict()) {
            let Some(seated) = seated else {
                pegs.push(None);
                continue;
            };
            if seated.since < head.planning {
                return Err(format!(
                    "{} is pinned since {:.3} s, and the robot was not free to move before {} s",
                    connection.name, seated.since, head.planning
                ));
            }
            pegs.push(Some(PegResult {
                connection: connection.name.clone(),
                joints: [connection.female, connection.male]
                    .map(|joint| self.goal.joint_name(joint).to_string()),
                peg: seated.peg.clone(),
                t_robot: seated.since - head.planning,
                t_total: seated.since,
            }));
        }
        let total = head.end.since(head.begin);
        Ok(EpisodeResult {
            schema: EPISODE.to_string(),
            rules: RULES.to_string(),
            goal: self.goal.name.clone(),
            class: self.goal.class.map(|class| class.name().to_string()),
            track: head.track,
            real: Some(RealRun { robot: head.robot, scorer: head.scorer, source: head.source }),
            world: None,
            start: None,
            seed: u64::from(head.repeat),
            secret: None,
            repeat: head.repeat,
            agent: AgentInfo { name: head.agent, version: head.version, sha256: None },
            software: software.clone(),
            host: Host { cpu: head.computer, cores: head.cores },
            rejected: Vec::new(),
            completion: completion(&pegs),
            pegs,
            time: Time {
                planning: head.planning,
                compute: 0.0,
                robot: total - head.planning,
                total,
                agent_cpu: None,
                waiting: None,
            },
            robot_time: None,
            plan: PlanInfo { coarse: 0, fine: 0, replans: 0 },
            events: Vec::new(),
            physics: None,
            fault: None,
            ended: Ended { reason: head.ended, kind: None },
            log: Some(log.to_string()),
        })
    }
}
