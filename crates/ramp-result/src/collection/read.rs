//! One file: read, and checked before anything in it is believed.

use std::path::{Path, PathBuf};

use ramp_assembly::Class;
use ramp_robot::Track;
use serde_json::Value;

use crate::episode::{EpisodeResult, RULES, SCHEMA};
use crate::file::sha256;
use crate::manipulation::{self, Trial};
use crate::perception::{self, PerceptionVerdict};
use crate::planning::{self, PlanVerdict};
use crate::published::{self, Published};

/// The largest file that is read, bytes.
const LARGEST: u64 = 64 << 20;
/// The longest time that an episode can have, s: more than any protocol asks for, and what a picture can show.
const LONGEST: f64 = 1e7;
/// By how much times that should agree may differ, s: rounding of whoever wrote them.
const SLACK: f64 = 1e-3;

/// One result file.
#[derive(Clone, Debug)]
pub struct ResultFile {
    /// Where it was read from.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// What it says.
    pub result: EpisodeResult,
}

/// Why results cannot be summed up.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CollectError {
    /// A folder or file that cannot be read.
    #[error("{path} cannot be read: {why}")]
    Unreadable {
        /// Which.
        path: String,
        /// What the system said.
        why: String,
    },
    /// A file that is no JSON, or no episode.
    #[error("{place}: {why}")]
    #[diagnostic(help("expected a result of `ramp run`, `ramp bench` or `ramp score`"))]
    Form {
        /// File, line and column.
        place: String,
        /// What is wrong.
        why: String,
    },
    /// A result of another schema.
    #[error("{file} is of the schema `{found}`, expected `{SCHEMA}`")]
    #[diagnostic(help("results of different schemas are not added up: run these episodes again"))]
    Schema {
        /// The file.
        file: String,
        /// What it says.
        found: String,
    },
    /// A result by other rules.
    #[error("{file} was judged by the rules {found}, expected {RULES}")]
    #[diagnostic(help("results of different rules are not added up: run these episodes again"))]
    Rules {
        /// The file.
        file: String,
        /// What it says.
        found: String,
    },
    /// A result that cannot be.
    #[error("{file}: {why}")]
    #[diagnostic(help("no episode ends like this: the file was changed, or made by something else"))]
    Impossible {
        /// The file.
        file: String,
        /// What contradicts what.
        why: String,
    },
    /// Two results of one episode.
    #[error("{first} and {second} are two results of one episode")]
    #[diagnostic(help("each goal and seed of an agent counts once: move one of them away"))]
    Twice {
        /// One file.
        first: String,
        /// The other.
        second: String,
    },
    /// Two goals of one name.
    #[error("{first} and {second} are of two goals called `{goal}`: {why}")]
    TwoGoals {
        /// The name.
        goal: String,
        /// One file.
        first: String,
        /// The other.
        second: String,
        /// What differs.
        why: String,
    },
    /// Nothing there.
    #[error("there is no result in {folder}")]
    #[diagnostic(help(
        "make some with `ramp bench easy -o {folder}`; those with a fault on purpose are left out"
    ))]
    Empty {
        /// The folder.
        folder: String,
    },
}

pub(super) enum Found {
    Episode(Box<ResultFile>),
    Published(Published),
    Plan(PlanVerdict),
    Perception(PerceptionVerdict),
    Trial(Box<Trial>),
    /// Not ours.
    Other,
}

pub(super) fn read(path: &Path) -> Result<Found, CollectError> {
    let size = std::fs::metadata(path).map_err(|error| unreadable(path, &error))?.len();
    let name = path.display().to_string();
    if size > LARGEST {
        return Err(CollectError::Form { place: name, why: format!("it has {size} bytes") });
    }
    let bytes = std::fs::read(path).map_err(|error| unreadable(path, &error))?;
    let Some(found) = parse(&name, &bytes)? else { return Ok(Found::Other) };
    Ok(match found {
        Parsed::Episode(result) => Found::Episode(Box::new(ResultFile {
            path: path.to_path_buf(),
            sha256: sha256(&bytes),
            result: *result,
        })),
        Parsed::Published(means) => Found::Published(means),
        Parsed::Plan(verdict) => Found::Plan(verdict),
        Parsed::Perception(verdict) => Found::Perception(verdict),
        Parsed::Trial(trial) => Found::Trial(trial),
    })
}

/// A file's content.
#[derive(Clone, Debug, PartialEq)]
pub enum Parsed {
    /// The result of an episode.
    Episode(Box<EpisodeResult>),
    /// Published means.
    Published(Published),
    /// The verdict on a plan.
    Plan(PlanVerdict),
    /// The verdict on a detector.
    Perception(PerceptionVerdict),
    /// A trial of a single skill.
    Trial(Box<Trial>),
}

/// Reads one result; `None` for JSON that does not say that it is one. `name` is what messages call it.
///
/// # Errors
/// [`CollectError`] for everything that is not a result that can be.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Option<Parsed>, CollectError> {
    let bad = |error: serde_json::Error| {
        let text = error.to_string();
        let why = text.split(" at line ").next().unwrap_or(&text).to_string();
        CollectError::Form { place: format!("{name}:{}:{}", error.line(), error.column()), why }
    };
    // Twice, so that a wrong schema is told before everything that follows from it.
    let value: Value = serde_json::from_slice(bytes).map_err(bad)?;
    let schema = value["schema"].as_str().unwrap_or_default();
    let impossible = |why| CollectError::Impossible { file: name.to_string(), why };
    if schema == published::SCHEMA {
        let means: Published = serde_json::from_slice(bytes).map_err(bad)?;
        means.check().map_err(impossible)?;
        return Ok(Some(Parsed::Published(means)));
    }
    if schema == planning::SCHEMA {
        let verdict: PlanVerdict = serde_json::from_slice(bytes).map_err(bad)?;
        verdict.check().map_err(impossible)?;
        return Ok(Some(Parsed::Plan(verdict)));
    }
    if schema == perception::SCHEMA {
        let verdict: PerceptionVerdict = serde_json::from_slice(bytes).map_err(bad)?;
        verdict.check().map_err(impossible)?;
        return Ok(Some(Parsed::Perception(verdict)));
    }
    if schema == manipulation::SCHEMA {
        let trial: Trial = serde_json::from_slice(bytes).map_err(bad)?;
        trial.check().map_err(impossible)?;
        return Ok(Some(Parsed::Trial(Box::new(trial))));
    }
    if !schema.starts_with("ramp-episode-") {
        return Ok(None);
    }
    if schema != SCHEMA {
        return Err(CollectError::Schema {
            file: name.to_string(),
            found: ramp_kit::source::shorten(schema),
        });
    }
    if let Some(rules) = value["rules"].as_str().filter(|rules| *rules != RULES) {
        let found = ramp_kit::source::shorten(rules);
        return Err(CollectError::Rules { file: name.to_string(), found });
    }
    let result: EpisodeResult = serde_json::from_slice(bytes).map_err(bad)?;
    check(&result).map_err(impossible)?;
    Ok(Some(Parsed::Episode(Box::new(result))))
}

/// Can an episode have ended like this?
fn check(result: &EpisodeResult) -> Result<(), String> {
    if let Some(class) = &result.class
        && Class::ALL.iter().all(|known| known.name() != class)
    {
        return Err(format!("there is no class `{}`", ramp_kit::source::shorten(class)));
    }
    if Track::ALL.iter().all(|known| known.name() != result.track) {
        return Err(format!("there is no track `{}`", ramp_kit::source::shorten(&result.track)));
    }
    if result.real.is_some() != result.physics.is_none() {
        return Err("a run of a real robot has no physics of the twin, and every other has one".to_string());
    }
    let time = &result.time;
    let parts = [
        ("time.planning", time.planning),
        ("time.compute", time.compute),
        ("time.robot", time.robot),
        ("time.total", time.total),
    ];
    for (name, value) in parts {
        if !(0.0..=LONGEST).contains(&value) {
            return Err(format!("`{name}` is {value} s, expected 0 to {LONGEST}"));
        }
    }
    let sum = time.planning + time.compute + time.robot;
    if (sum - time.total).abs() > SLACK {
        return Err(format!(
            "`time.total` is {} s, and planning, compute and robot time are {sum} s together",
            time.total
        ));
    }
    let counted: Vec<_> = result.pegs.iter().flatten().collect();
    for (index, peg) in counted.iter().enumerate() {
        let name = ramp_kit::source::shorten(&peg.connection);
        if !(0.0..=time.robot + SLACK).contains(&peg.t_robot) {
            return Err(format!(
                "{name} is pinned since {} s of robot time, and all of it is {} s",
                peg.t_robot, time.robot
            ));
        }
        if !(peg.t_robot - SLACK..=time.total + SLACK).contains(&peg.t_total) {
            return Err(format!(
                "{name} is pinned since {} s in total, which is not between its robot time, {} s, and the end, {} s",
                peg.t_total, peg.t_robot, time.total
            ));
        }
        for other in &counted[..index] {
            if other.connection == peg.connection {
                return Err(format!("{name} counts twice"));
            }
            // A person with a stopwatch may not have noted which peg it was.
            if other.peg == peg.peg && !peg.peg.is_empty() {
                return Err(format!("the peg {} counts twice", ramp_kit::source::shorten(&peg.peg)));
            }
        }
    }
    let completion =
        if result.pegs.is_empty() { 0.0 } else { counted.len() as f64 / result.pegs.len() as f64 };
    if (completion - result.completion).abs() > 1e-9 {
        return Err(format!(
            "`completion` is {}, and {} of {} pegs count",
            result.completion,
            counted.len(),
            result.pegs.len()
        ));
    }
    match result.events.iter().find(|event| !(0.0..=LONGEST).contains(&event.t)) {
        Some(event) => Err(format!("an event is at {} s", event.t)),
        None => Ok(()),
    }
}

/// The error of a file or folder that the system does not let be read.
pub(super) fn unreadable(path: &Path, error: &std::io::Error) -> CollectError {
    let why = match error.kind() {
        std::io::ErrorKind::NotFound => "there is nothing of that name".to_string(),
        std::io::ErrorKind::NotADirectory => "it is not a folder".to_string(),
        _ => error.to_string(),
    };
    CollectError::Unreadable { path: path.display().to_string(), why }
}
