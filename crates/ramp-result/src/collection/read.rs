//! Reads and checks one file.

use std::path::{Path, PathBuf};

use ramp_kit::source::{ReadError, decode, plain, read_bytes, shorten};
use serde_json::Value;

use super::check::check;
use crate::episode::{EpisodeResult, RULES, SCHEMA};
use crate::file::sha256;
use crate::manipulation::Trial;
use crate::perception::{self, PerceptionVerdict};
use crate::planning::{self, PlanVerdict};
use crate::published::{self, Published};

/// Size limit of a file, bytes: more than all events of an agent need.
pub const LARGEST: usize = 16 << 20;
/// Length limit of the parser's message that is passed on, characters.
const LONGEST_WHY: usize = 300;

/// One result file.
#[derive(Clone, Debug)]
pub struct ResultFile {
    /// Its path.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// The result.
    pub result: EpisodeResult,
}

/// Reasons why results cannot be added up.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CollectError {
    /// A folder or file that cannot be read.
    #[error("{path} cannot be read: {why}")]
    Unreadable {
        /// Its path.
        path: String,
        /// The system's message.
        why: String,
    },
    /// A file that cannot be read, or is too large.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// A file that is not JSON, or not an episode.
    #[error("{place}: {why}")]
    #[diagnostic(help("expected a result of `ramp run`, `ramp bench` or `ramp score`"))]
    Form {
        /// File, line and column.
        place: String,
        /// The mistake.
        why: String,
    },
    /// A result of another schema.
    #[error("{file} is of the schema `{found}`, expected `{SCHEMA}`")]
    #[diagnostic(help("results of different schemas cannot be combined: run these episodes again"))]
    Schema {
        /// The file.
        file: String,
        /// The version in the file.
        found: String,
    },
    /// A result by other rules.
    #[error("{file} was judged by the rules {found}, expected {RULES}")]
    #[diagnostic(help("results of different rules cannot be combined: run these episodes again"))]
    Rules {
        /// The file.
        file: String,
        /// The version in the file.
        found: String,
    },
    /// A result that contradicts itself.
    #[error("{file}: {why}")]
    #[diagnostic(help("the file contradicts itself: it was edited, or not written by RAMP"))]
    Impossible {
        /// The file.
        file: String,
        /// The contradiction.
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
    /// Two different goals with the same name.
    #[error("{first} and {second} are of two goals called `{goal}`: {why}")]
    TwoGoals {
        /// The name.
        goal: String,
        /// One file.
        first: String,
        /// The other.
        second: String,
        /// The difference.
        why: String,
    },
    /// A folder without results.
    #[error("there is no result in {folder}")]
    #[diagnostic(help(
        "make some with `ramp bench easy -o {folder}`; results with an injected fault are ignored"
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
    /// A file without a schema of RAMP.
    Other,
}

pub(super) fn read(path: &Path) -> Result<Found, CollectError> {
    let name = shown(path);
    let bytes = read_bytes(path, LARGEST)?;
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

/// The content of a file.
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

/// Reads one result; `None` for JSON without a schema of RAMP. `name` is its name in messages.
///
/// # Errors
/// [`CollectError`] for a file that claims to be a result and is not a valid one.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Option<Parsed>, CollectError> {
    let bad = |error: serde_json::Error| {
        let text = error.to_string();
        let why = plain(text.split(" at line ").next().unwrap_or(&text), LONGEST_WHY);
        CollectError::Form { place: format!("{name}:{}:{}", error.line(), error.column()), why }
    };
    let text = decode(bytes)
        .map_err(|error| CollectError::Form { place: name.to_string(), why: error.to_string() })?;
    let bytes = text.as_bytes();
    // Parsed twice, so that a wrong schema is reported before the errors that follow from it.
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
    if Trial::reads(schema) {
        let trial = Trial::from_json(bytes).map_err(bad)?;
        trial.check().map_err(impossible)?;
        return Ok(Some(Parsed::Trial(Box::new(trial))));
    }
    if !schema.starts_with("ramp-episode-") {
        return Ok(None);
    }
    if !EpisodeResult::reads(schema) {
        return Err(CollectError::Schema { file: name.to_string(), found: shorten(schema) });
    }
    if let Some(rules) = value["rules"].as_str().filter(|rules| *rules != RULES) {
        let found = shorten(rules);
        return Err(CollectError::Rules { file: name.to_string(), found });
    }
    let result = EpisodeResult::from_json(bytes).map_err(bad)?;
    check(&result).map_err(impossible)?;
    Ok(Some(Parsed::Episode(Box::new(result))))
}

/// The error of a file or folder that the operating system cannot read.
pub(super) fn unreadable(path: &Path, error: &std::io::Error) -> CollectError {
    let why = match error.kind() {
        std::io::ErrorKind::NotFound => "there is nothing of that name".to_string(),
        std::io::ErrorKind::NotADirectory => "it is not a folder".to_string(),
        _ => error.to_string(),
    };
    CollectError::Unreadable { path: shown(path), why }
}

/// A path made safe for a message: file names are untrusted.
pub(super) fn shown(path: &Path) -> String {
    plain(&path.display().to_string(), usize::MAX)
}
