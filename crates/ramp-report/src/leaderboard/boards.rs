//! Rankings: one board for each class, track, arm, world, start and rules, the best agent first.

use ramp_assembly::Class;
use ramp_log::Named;
use ramp_result::collection::{Collection, class_rank};
use ramp_result::episode::{EpisodeResult, RealRun, RobotKind};
use ramp_robot::Track;

use crate::sums::{self, Line, Scope};

/// Digits of a SHA-256 that are shown.
pub(super) const SHOWN_HASH: usize = 8;
/// Digits of a SHA-256 in the name of a page. Longer than the shown hash, so that nobody can make a file with
/// the same one.
const SLUG_HASH: usize = 24;

/// The order of a board among all.
type Rank<'a> = (
    (bool, bool, Option<Class>),
    usize,
    (Option<RobotKind>, bool),
    Option<&'a String>,
    [Option<&'a Named>; 2],
    &'a str,
);

/// Properties that episodes must share to be ranked together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// The class, or none.
    pub class: Option<String>,
    /// The track.
    pub track: String,
    /// The name of the arm; `None` for real runs that do not tell it.
    pub arm: Option<String>,
    /// The world; `None` for real runs. Two versions of one world are two worlds.
    pub world: Option<Named>,
    /// The start; `None` for real runs. Two versions of one start are two starts.
    pub start: Option<Named>,
    /// The rules of judging.
    pub rules: String,
    /// The kind of robot; `None` in the twin.
    pub robot: Option<RobotKind>,
    /// Whether the robot went on while the agent computed.
    pub asynchronous: bool,
}

impl Key {
    /// The key of an episode. Further distinctions between boards belong here.
    pub fn of(result: &EpisodeResult) -> Key {
        Key {
            class: result.class.clone(),
            track: result.track.clone(),
            arm: result.arm.clone(),
            world: result.world.as_ref().map(|it| Named { name: it.name.clone(), sha256: it.sha256.clone() }),
            start: result.start.as_ref().map(|it| Named { name: it.name.clone(), sha256: it.sha256.clone() }),
            rules: result.rules.clone(),
            robot: result.real.as_ref().map(|real| real.kind),
            asynchronous: result.agent.asynchronous,
        }
    }

    /// For a person.
    pub fn title(&self) -> String {
        let class =
            self.class.as_ref().map_or("Goals without a class".to_string(), |it| format!("Class {it}"));
        let robot = self.robot.map_or("twin", RobotKind::words);
        let version = |kind: &str, file: &Option<Named>| {
            file.as_ref()
                .map_or(String::new(), |it| format!(", {kind} {} ({})", it.name, begin(it, SHOWN_HASH)))
        };
        let (world, start) = (version("world", &self.world), version("start", &self.start));
        let arm = self.arm.iter().map(|arm| format!(", arm {arm}")).collect::<String>();
        let pace = if self.asynchronous { ", async" } else { "" };
        format!("{class}, track {}, {robot}{arm}{world}{start}{pace}", self.track)
    }

    /// For the name of a file: letters, digits and hyphens.
    pub fn slug(&self) -> String {
        let class = self.class.as_deref().unwrap_or("no-class");
        let robot = self.robot.map_or(String::new(), |kind| format!("-{}", kind.words()));
        let pace = if self.asynchronous { "-async" } else { "" };
        let version = |file: &Option<Named>| {
            file.as_ref().map_or(String::new(), |it| format!("-{}-{}", it.name, begin(it, SLUG_HASH)))
        };
        let (world, start) = (version(&self.world), version(&self.start));
        let arm = self.arm.iter().map(|arm| format!("-{arm}")).collect::<String>();
        format!("{class}-{}{arm}{world}{start}{robot}{pace}-{}", self.track, self.rules)
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' })
            .collect()
    }

    /// The open class first, then easy classes first; tracks in their order, real robots last.
    fn rank(&self) -> Rank<'_> {
        let (none, class) = class_rank(self.class.as_deref());
        let track = Track::ALL.iter().position(|known| known.name() == self.track);
        (
            (!class.is_some_and(Class::is_open), none, class),
            track.unwrap_or(Track::ALL.len()),
            (self.robot, self.asynchronous),
            self.arm.as_ref(),
            [self.world.as_ref(), self.start.as_ref()],
            &self.rules,
        )
    }
}

/// The first digits of a file's SHA-256.
fn begin(file: &Named, digits: usize) -> &str {
    file.sha256.get(..digits).unwrap_or(&file.sha256)
}

/// One agent's row on one board.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The entry.
    pub entry: String,
    /// The agent's name and version.
    pub agent: String,
    /// The file of its own page.
    pub page: String,
    /// Its sums.
    pub line: Line,
    /// The computer.
    pub host: String,
    /// The program that made the results.
    pub software: [String; 2],
    /// Description of a real robot.
    pub real: Option<RealRun>,
    /// Whether the organiser measured planning and compute.
    pub timed_here: bool,
    /// Warnings for the reader.
    pub warnings: Vec<String>,
}

/// A row of the organiser, which takes no place.
#[derive(Clone, Debug)]
pub struct Control {
    /// Its name: what a reader compares with it.
    pub label: String,
    /// The row.
    pub standing: Standing,
}

/// One board.
#[derive(Clone, Debug)]
pub struct Board {
    /// Common properties of its rows.
    pub key: Key,
    /// The rows of the entries, the best first.
    pub standings: Vec<Standing>,
    /// The organiser's rows.
    pub controls: Vec<Control>,
}

/// All boards.
#[derive(Debug, Default)]
pub struct Boards {
    boards: Vec<Board>,
}

impl Boards {
    /// Inserts an agent by rank: higher completion first, then less time, then the earlier entry.
    pub fn add(&mut self, key: Key, standing: Standing) {
        let index = self.boards.iter().position(|board| board.key == key).unwrap_or_else(|| {
            let index = self.boards.partition_point(|board| board.key.rank() < key.rank());
            self.boards.insert(index, Board { key, standings: Vec::new(), controls: Vec::new() });
            index
        });
        let standings = &mut self.boards[index].standings;
        let place = standings.partition_point(|other| sums::better(&other.line, &standing.line).is_le());
        standings.insert(place, standing);
    }

    /// Adds a row of the organiser to the board of this key, if it has an entry.
    pub fn add_control(&mut self, key: &Key, control: Control) {
        if let Some(board) = self.boards.iter_mut().find(|board| board.key == *key) {
            board.controls.push(control);
        }
    }

    /// The boards in order.
    pub fn boards(&self) -> &[Board] {
        &self.boards
    }
}

/// The agent's rows of an entry on each track and class, without warnings.
pub fn standings(
    entry: &str,
    agent: &str,
    collection: &Collection,
    page: impl Fn(usize) -> String,
    timed_here: impl Fn(usize) -> bool,
) -> Vec<(Key, Standing)> {
    let mut standings = Vec::new();
    for (index, entrant) in collection.entrants.iter().enumerate() {
        let mut keys: Vec<Key> = Vec::new();
        for file in &entrant.files {
            let key = Key::of(&file.result);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        let it = &entrant.identity;
        let host = entrant.files.first().map(|file| &file.result.host);
        for key in keys {
            let Some(line) = sums::line(collection, index, &Scope::Class(key.class.clone())) else {
                continue;
            };
            let standing = Standing {
                entry: entry.to_string(),
                agent: agent.to_string(),
                page: page(index),
                line,
                host: host.map_or_else(String::new, |it| format!("{}, {} threads", it.cpu, it.cores)),
                software: [it.version.clone(), it.commit.clone()],
                real: it.real.clone(),
                timed_here: timed_here(index),
                warnings: Vec::new(),
            };
            standings.push((key, standing));
        }
    }
    standings
}
