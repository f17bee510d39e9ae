//! Results read from folders, and who they belong to. Files come from anywhere: nothing in them is believed before it
//! is checked.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ramp_assembly::Class;
use ramp_robot::Track;
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::planning::{self, PlanVerdict};
use crate::published::{self, Published};
use crate::result::{AgentInfo, EpisodeResult, RULES, RealRun, SCHEMA, Software};

/// The largest file that is read, bytes.
const LARGEST: u64 = 64 << 20;
/// The longest time that an episode can have, s: more than any protocol asks for, and what a picture can show.
const LONGEST: f64 = 1e7;
/// By how much times that should agree may differ, s: rounding of whoever wrote them.
const SLACK: f64 = 1e-3;

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
    #[diagnostic(help("make some with `ramp bench easy -o {folder}`"))]
    Empty {
        /// The folder.
        folder: String,
    },
}

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

/// An episode that was begun and has no result.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Lost {
    /// The goal.
    pub goal: String,
    /// The seed.
    pub seed: u64,
}

/// Who worked, with what, on what: only results that agree in all of this are added up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Identity {
    /// The track.
    pub track: String,
    /// The agent's name.
    pub agent: String,
    /// Its version.
    pub agent_version: String,
    /// SHA-256 of its file, where it has one.
    pub agent_sha256: Option<String>,
    /// The version of this software.
    pub version: String,
    /// The commit it was built from.
    pub commit: String,
    /// Of a real run, what is known of it.
    pub real: Option<RealRun>,
}

/// One agent on one track: all its episodes.
#[derive(Clone, Debug)]
pub struct Entrant {
    /// What sets it apart.
    pub identity: Identity,
    /// The shortest name that sets it apart from the others of its track.
    pub label: String,
    /// Its results, by goal and seed.
    pub files: Vec<ResultFile>,
    /// Its episodes without a result.
    pub lost: Vec<Lost>,
}

/// A goal that somebody worked on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: Option<String>,
    /// Pegs in it.
    pub pegs: usize,
}

/// All that was read.
#[derive(Clone, Debug)]
pub struct Collection {
    /// By track, in the order in which their folders were named.
    pub entrants: Vec<Entrant>,
    /// By class and name.
    pub goals: Vec<Goal>,
    /// Means that others have published.
    pub published: Vec<Published>,
    /// Plans that were judged alone, by goal and planner.
    pub plans: Vec<PlanVerdict>,
    /// What a reader must know of what was read.
    pub notes: Vec<String>,
}

/// Reads all results of some folders.
///
/// # Errors
/// At the first file that is not what it should be. Files that do not end in `.json`, and JSON files that name no schema
/// of RAMP, are left alone and noted.
pub fn collect(folders: &[PathBuf]) -> Result<Collection, CollectError> {
    let mut files: Vec<ResultFile> = Vec::new();
    let mut published: Vec<Published> = Vec::new();
    let mut plans: Vec<PlanVerdict> = Vec::new();
    let mut notes = Vec::new();
    let mut lost: Vec<(PathBuf, String)> = Vec::new();
    let mut seen = Vec::new();
    for folder in folders {
        let place = folder.canonicalize().map_err(|error| unreadable(folder, &error))?;
        if seen.contains(&place) {
            continue;
        }
        seen.push(place);
        let paths = list(folder)?;
        let before = files.len() + published.len() + plans.len();
        for path in &paths {
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("json") => match read(path)? {
                    Found::Episode(file) => files.push(*file),
                    Found::Published(means) => published.push(means),
                    Found::Plan(verdict) => plans.push(verdict),
                    Found::Other => notes.push(format!("{} is no result and is left out", path.display())),
                },
                Some("log") if !path.with_extension("json").exists() => {
                    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                    lost.push((folder.clone(), stem));
                }
                _ => {}
            }
        }
        if files.len() + published.len() + plans.len() == before {
            return Err(CollectError::Empty { folder: folder.display().to_string() });
        }
    }
    let goals = goals(&files)?;
    // In the order in which they were named.
    let mut by_identity: Vec<(Identity, Vec<ResultFile>)> = Vec::new();
    for file in files {
        let identity = Identity::of(&file.result);
        match by_identity.iter_mut().find(|(known, _)| *known == identity) {
            Some((_, files)) => files.push(file),
            None => by_identity.push((identity, vec![file])),
        }
    }
    by_identity.sort_by_key(|(identity, _)| identity.track_rank());
    let mut entrants = Vec::new();
    for (identity, mut files) in by_identity {
        let order = |file: &ResultFile| {
            (goals.iter().position(|goal| goal.name == file.result.goal), file.result.seed)
        };
        files.sort_by_key(order);
        if let Some(pair) = files.windows(2).find(|pair| order(&pair[0]) == order(&pair[1])) {
            let name = |file: &ResultFile| file.path.display().to_string();
            return Err(CollectError::Twice { first: name(&pair[0]), second: name(&pair[1]) });
        }
        entrants.push(Entrant { label: identity.agent.clone(), identity, files, lost: Vec::new() });
    }
    for (folder, stem) in lost {
        assign(&mut entrants, &folder, &stem, &mut notes);
    }
    label(&mut entrants);
    published.sort_by(|a, b| a.name.cmp(&b.name).then(a.class.cmp(&b.class)));
    published.dedup();
    plans.sort_by(|a, b| (&a.planner, &a.goal).cmp(&(&b.planner, &b.goal)));
    Ok(Collection { entrants, goals, published, plans, notes })
}

/// The files of a folder, by name.
fn list(folder: &Path) -> Result<Vec<PathBuf>, CollectError> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        paths.push(entry.map_err(|error| unreadable(folder, &error))?.path());
    }
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok(paths)
}

fn unreadable(path: &Path, error: &std::io::Error) -> CollectError {
    let why = match error.kind() {
        std::io::ErrorKind::NotFound => "there is nothing of that name".to_string(),
        std::io::ErrorKind::NotADirectory => "it is not a folder".to_string(),
        _ => error.to_string(),
    };
    CollectError::Unreadable { path: path.display().to_string(), why }
}

enum Found {
    Episode(Box<ResultFile>),
    Published(Published),
    Plan(PlanVerdict),
    /// Not ours.
    Other,
}

fn read(path: &Path) -> Result<Found, CollectError> {
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
            sha256: hex(&Sha256::digest(&bytes)),
            result: *result,
        })),
        Parsed::Published(means) => Found::Published(means),
        Parsed::Plan(verdict) => Found::Plan(verdict),
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
    if schema == published::SCHEMA {
        let means: Published = serde_json::from_slice(bytes).map_err(bad)?;
        let impossible = |why| CollectError::Impossible { file: name.to_string(), why };
        means.check().map_err(impossible)?;
        return Ok(Some(Parsed::Published(means)));
    }
    if schema == planning::SCHEMA {
        let verdict: PlanVerdict = serde_json::from_slice(bytes).map_err(bad)?;
        let impossible = |why| CollectError::Impossible { file: name.to_string(), why };
        verdict.check().map_err(impossible)?;
        return Ok(Some(Parsed::Plan(verdict)));
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
    check(&result).map_err(|why| CollectError::Impossible { file: name.to_string(), why })?;
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

/// The goals of some results, each once.
fn goals(files: &[ResultFile]) -> Result<Vec<Goal>, CollectError> {
    let mut known: BTreeMap<String, (&ResultFile, Goal)> = BTreeMap::new();
    for file in files {
        let result = &file.result;
        let goal = Goal { name: result.goal.clone(), class: result.class.clone(), pegs: result.pegs.len() };
        match known.get(&goal.name) {
            None => {
                known.insert(goal.name.clone(), (file, goal));
            }
            Some((_, same)) if *same == goal => {}
            Some((first, other)) => {
                let say = |goal: &Goal| {
                    format!("{} pegs, class {}", goal.pegs, goal.class.as_deref().unwrap_or("none"))
                };
                return Err(CollectError::TwoGoals {
                    goal: ramp_kit::source::shorten(&goal.name),
                    first: first.path.display().to_string(),
                    second: file.path.display().to_string(),
                    why: format!("{}; {}", say(other), say(&goal)),
                });
            }
        }
    }
    let mut goals: Vec<Goal> = known.into_values().map(|(_, goal)| goal).collect();
    goals.sort_by_cached_key(|goal| {
        let digits = goal.name.len() - goal.name.bytes().rev().take_while(u8::is_ascii_digit).count();
        let number: u64 = goal.name[digits..].parse().unwrap_or(0);
        (class_rank(goal.class.as_deref()), goal.name[..digits].to_string(), number, goal.name.clone())
    });
    Ok(goals)
}

/// Classes in order, goals without one last.
pub(crate) fn class_rank(class: Option<&str>) -> usize {
    Class::ALL.iter().position(|known| Some(known.name()) == class).unwrap_or(Class::ALL.len())
}

impl Identity {
    /// The track's place among all of them.
    fn track_rank(&self) -> usize {
        Track::ALL.iter().position(|known| known.name() == self.track).unwrap_or(Track::ALL.len())
    }

    fn of(result: &EpisodeResult) -> Identity {
        let EpisodeResult { track, agent, software, real, .. } = result;
        let AgentInfo { name, version: agent_version, sha256 } = agent;
        let Software { version, commit } = software;
        Identity {
            track: track.clone(),
            agent: name.clone(),
            agent_version: agent_version.clone(),
            agent_sha256: sha256.clone(),
            version: version.clone(),
            commit: commit.clone(),
            real: real.clone(),
        }
    }
}

/// Gives each entrant the shortest label that tells it from the others of its track.
fn label(entrants: &mut [Entrant]) {
    let say = |entrant: &Entrant, words: usize| {
        let it = &entrant.identity;
        let mut label = it.agent.clone();
        if words > 0 {
            label = format!("{label} {}", it.agent_version);
        }
        if words > 1 {
            label = match &it.real {
                Some(real) => format!("{label} on {}", real.robot),
                None => format!("{label} in the twin"),
            };
        }
        if words > 2 {
            label = format!("{label}, ramp {} ({})", it.version, it.commit);
        }
        label
    };
    let labels: Vec<String> = (0..entrants.len())
        .map(|index| {
            let others = |words: usize| {
                let mine = say(&entrants[index], words);
                let same = |other: &Entrant| {
                    other.identity.track == entrants[index].identity.track && say(other, words) == mine
                };
                entrants.iter().filter(|it| same(it)).count()
            };
            let words = (0..3).find(|words| others(*words) == 1).unwrap_or(3);
            say(&entrants[index], words)
        })
        .collect();
    for (entrant, label) in entrants.iter_mut().zip(labels) {
        entrant.label = label;
    }
}

/// Gives an episode that has only a log, `GOAL-TRACK-SEED`, to the one entrant whose results lie beside it.
fn assign(entrants: &mut [Entrant], folder: &Path, stem: &str, notes: &mut Vec<String>) {
    let mut parts = stem.rsplitn(3, '-');
    let seed = parts.next().and_then(|seed| seed.parse().ok());
    let track = parts.next().filter(|track| Track::ALL.iter().any(|known| known.name() == *track));
    let (Some(seed), Some(track), Some(goal)) = (seed, track, parts.next()) else { return };
    let mut here = entrants.iter_mut().filter(|entrant| {
        entrant.identity.track == track && entrant.files.iter().any(|file| file.path.parent() == Some(folder))
    });
    match (here.next(), here.next()) {
        (Some(entrant), None) => entrant.lost.push(Lost { goal: goal.to_string(), seed }),
        _ => notes.push(format!("{stem} in {} was lost, and whose it was is not known", folder.display())),
    }
}

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
