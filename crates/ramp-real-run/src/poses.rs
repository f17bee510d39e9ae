//! Logs of camera-measured part poses of a real robot's run, judged by the twin's referee.
//!
//! A log is an MCAP file with two channels of JSON messages: `/run`, one message that identifies
//! the run (`data/schema/real-run.schema.json`), and `/parts`, the poses of parts over time in the
//! format of the twin's logs (`foxglove.FrameTransforms`, `data/schema/log/parts.schema.json`). The
//! pose of a tag on a part is accepted instead of the part's pose.
//! `docs/src/reference/real-runs.md` describes the format. Impossible messages are refused with
//! their number and time, and impossible poses with the likely cause.

mod cause;
mod message;
mod order;
mod possible;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::Vector3;
use ramp_assembly::Assembly;
use ramp_assembly::Truth;
use ramp_kit::source::{A_NAME, MAX_TITLE, is_name, is_text, nearest, plain, shorten, without_mark};
use ramp_kit::tags::{self, SHEET_ID, TagPlace};
use ramp_kit::{Kit, Pose};
use ramp_robot::Track;
use serde::Deserialize;

use cause::{Measured, length_unit, time_unit};
use message::{Head, Rotation, Sight, Stamp, Transform, Vector};
pub use order::QuaternionOrder;
use possible::{check_clamped, check_loose};

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
/// Shortest time of a run that is taken for one in another unit, s.
const SHORTEST: f64 = 5.0;
/// Largest distance of a part from the origin, m.
const FAR: f64 = 10.0;
/// Largest deviation of a quaternion's norm from one.
const UNIT: f64 = 1.0e-3;
/// Coordinate of a part that was not detected yet, m: far from every hole.
const UNSEEN: f64 = 1.0e3;
/// Number of different fractions of seconds that tell their unit.
const FRACTIONS: usize = 3;
/// Fractions of seconds are not all smaller than this, ns.
const COARSE: u32 = 1_000_000;

/// Reference data for reading a log.
pub struct Reader<'a> {
    /// The parts.
    pub kit: &'a Kit,
    /// The goals that a log may name.
    pub goals: &'a [Assembly],
    /// The program that made the results.
    pub software: &'a Software,
    /// The order of the numbers of its quaternions.
    pub order: QuaternionOrder,
    /// Accepts a log without any pose: a run that was stopped before anything was measured. Nothing counts in
    /// it.
    pub unmeasured: bool,
}

/// A run that was judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its result.
    pub result: EpisodeResult,
    /// Whether the clamped beam was measured: without it, nothing tells that the frame is right.
    pub clamped_seen: bool,
}

impl Reader<'_> {
    /// Reads and judges the log in a file.
    ///
    /// # Errors
    /// When it cannot be read, or contains impossible events or poses.
    pub fn read(&self, path: &Path) -> Result<Judged, LogError> {
        self.from_bytes(path, &bytes_of(path, &Limits::default())?)
    }

    /// Reads and judges the log in a file's bytes; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Reader::read`].
    pub fn from_bytes(&self, path: &Path, bytes: &[u8]) -> Result<Judged, LogError> {
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
        run.result(self.software, &sha256(bytes), self.unmeasured).map_err(other)
    }

    /// Reads the identity of the run.
    fn head(&self, data: &[u8]) -> Result<Run<'_>, String> {
        #[derive(Deserialize)]
        struct Only {
            schema: String,
        }
        let data = without_mark(data);
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
        let arm = head.arm.as_ref().map(|arm| ("arm", arm));
        for (what, text) in [("agent", &head.agent), ("version", &head.version)].into_iter().chain(arm) {
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
                "the robot was free to move after {} s, expected a time between begin and end, 0 to {total} s{}",
                head.planning,
                time_unit(head.planning, |planning| (0.0..=total).contains(&planning))
            ));
        }
        let robot = total - head.planning;
        if robot > LIMIT {
            return Err(format!(
                "it ends after {robot:.0} s of robot time, and the rules end an episode after {LIMIT} s{}",
                time_unit(robot, |robot| (SHORTEST..=LIMIT).contains(&robot))
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
        Ok(Run {
            kit: self.kit,
            goal,
            head,
            seen_parts: vec![false; parts.len()],
            parts,
            tags,
            truth,
            referee,
            seen: None,
            order: self.order,
            fractions: BTreeSet::new(),
        })
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
    /// Whether each part was measured.
    seen_parts: Vec<bool>,
    order: QuaternionOrder,
    /// Some of the fractions of seconds of the messages, ns.
    fractions: BTreeSet<u32>,
}

impl Run<'_> {
    /// Reads one message, and passes it to the referee.
    fn see(&mut self, data: &[u8]) -> Result<(), String> {
        let sight: Sight = serde_json::from_slice(without_mark(data))
            .map_err(|error| plain(&error.to_string(), MAX_TITLE))?;
        // Number of tags that measured each part, by its index.
        let mut tags = BTreeMap::new();
        for transform in &sight.transforms {
            let stamp = transform.timestamp;
            let time = stamp.since(self.head.begin);
            self.take(transform, time, &mut tags).map_err(|why| format!("at {time:.3} s, {why}"))?;
            self.seen = Some(stamp);
            // What is measured after the end is what stood at the end.
            self.truth.time = time.min(self.head.end.since(self.head.begin));
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
        let total = self.head.end.since(self.head.begin);
        let last = self.head.surveyed.map_or(total, |surveyed| surveyed.since(self.head.begin).max(total));
        if !(0.0..=last).contains(&time) {
            // The same clock in another unit counts from the same beginning.
            let end = self.head.end.since(Stamp { sec: 0, nsec: 0 });
            let stamp = transform.timestamp.since(Stamp { sec: 0, nsec: 0 });
            let cause = time_unit(stamp, |stamp| (end - total..=end).contains(&stamp));
            return Err(match time < 0.0 {
                true => "a part was seen before the beginning".to_string(),
                false => format!("a part was seen after the end, {total:.3} s{cause}"),
            });
        }
        if self.fractions.len() < FRACTIONS && transform.timestamp.nsec > 0 {
            self.fractions.insert(transform.timestamp.nsec);
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
            let cause = length_unit([x, y, z], FAR);
            return Err(format!("{name} is at ({x}, {y}, {z}) m, expected it within {FAR} m{cause}"));
        }
        let norm = [w, i, j, k].iter().map(|value| value * value).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > UNIT || !norm.is_finite() {
            return Err(format!("the rotation of {name} has the length {norm}, expected a unit quaternion"));
        }
        // The sheet's own tag belongs to no part.
        let Some(index) = index else { return Ok(()) };
        let measured =
            Measured { at: Vector3::new(x, y, z), wxyz: [w, i, j, k], order: self.order, tag: place };
        let mut x_wp = measured.x_wp();
        if place.is_some() {
            // The mean over all tags on a part in one message.
            let count = tags.entry(index).or_insert(0.0);
            *count += 1.0;
            if *count > 1.0 {
                let mean = self.truth.x_wp[index].try_lerp_slerp(&x_wp, 1.0 / *count, UNIT);
                x_wp = mean.ok_or_else(|| {
                    format!("{name} and the other tags on {part} disagree on its orientation")
                })?;
            }
        }
        let base = &self.goal.beams[self.goal.base];
        let x_wa = self.kit.x_wa();
        if *part == base.beam.name {
            check_clamped(part, &measured, &x_wp, &(x_wa * base.x_ab), &x_wa)?;
        } else {
            let placed = self.goal.beams.iter().find(|placed| placed.beam.name == *part);
            let goal = placed.map(|placed| x_wa * placed.x_ab);
            check_loose(self.kit, part, &measured, !self.seen_parts[index], goal.as_ref())?;
        }
        self.seen_parts[index] = true;
        self.truth.x_wp[index] = x_wp;
        Ok(())
    }

    fn result(self, software: &Software, log: &str, unmeasured: bool) -> Result<Judged, String> {
        if self.seen.is_none() && !unmeasured {
            return Err("it has no pose on /parts".to_string());
        }
        let base = &self.goal.beams[self.goal.base].beam.name;
        let clamped = self.parts.iter().position(|part| part == base);
        let clamped_seen = clamped.is_some_and(|index| self.seen_parts[index]);
        if self.fractions.len() == FRACTIONS && self.fractions.iter().all(|nsec| *nsec < COARSE) {
            return Err(format!(
                "no `nsec` on /parts is {COARSE} or more: are they milliseconds or microseconds (expected \
                 nanoseconds)?"
            ));
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
                    "{} is pinned since {:.3} s, and the robot was not free to move before {} s{}",
                    connection.name,
                    seated.since,
                    head.planning,
                    time_unit(head.planning, |planning| (0.0..=seated.since).contains(&planning))
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
        let result = EpisodeResult {
            schema: EPISODE.to_string(),
            rules: RULES.to_string(),
            goal: self.goal.name.clone(),
            class: self.goal.class.map(|class| class.name()),
            track: head.track,
            real: Some(RealRun {
                robot: head.robot,
                scorer: head.scorer,
                source: head.source,
                kind: head.kind,
            }),
            arm: head.arm,
            world: None,
            start: None,
            state: None,
            task: None,
            parts: Vec::new(),
            seed: u64::from(head.repeat),
            secret: None,
            repeat: head.repeat,
            agent: AgentInfo { name: head.agent, version: head.version, sha256: None, asynchronous: false },
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
        };
        Ok(Judged { result, clamped_seen })
    }
}
