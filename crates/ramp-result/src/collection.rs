//! Reads results from folders and groups them by agent. The files are untrusted: everything is
//! checked before use.

mod check;
mod read;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ramp_assembly::{Class, Size};
use ramp_kit::source::{describe_debris, is_debris, is_name, shorten};
use ramp_robot::Track;
use serde::Serialize;

use crate::episode::{AgentInfo, EpisodeResult, RealRun, RobotKind, Software, StartInfo, WorldInfo};
use crate::manipulation::Trial;
use crate::perception::PerceptionVerdict;
use crate::planning::PlanVerdict;
use crate::published::Published;
pub use read::{CollectError, LARGEST, Parsed, ResultFile, parse};
use read::{Found, read, shown, unreadable};

/// An episode that was started and has no result.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Lost {
    /// The goal.
    pub goal: String,
    /// The seed.
    pub seed: u64,
}

/// Identity of an entry: only results that agree in all of these fields are added up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Identity {
    /// The track.
    pub track: String,
    /// The name of the arm; `None` for a real run that does not tell it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arm: Option<String>,
    /// Unambiguous name of the world ([`WorldInfo::title`]); `None` for a real run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world: Option<String>,
    /// Unambiguous name of the start ([`StartInfo::title`]); `None` for a real run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<String>,
    /// SHA-256 of the files of world and start, in hex; `None` for a real run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setting_sha256: Option<[String; 2]>,
    /// The agent's name.
    pub agent: String,
    /// Its version.
    pub agent_version: String,
    /// SHA-256 of its file, where it has one.
    pub agent_sha256: Option<String>,
    /// Whether the robot went on while it computed.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub asynchronous: bool,
    /// The version of this software.
    pub version: String,
    /// The commit it was built from.
    pub commit: String,
    /// The commitment of the secret mixed into the seeds, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub secret: Option<String>,
    /// Description of the real run; `None` in the twin.
    pub real: Option<RealRun>,
}

/// The conditions that entrants who are compared share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The track.
    pub track: String,
    /// The name of the arm; `None` for published results, and for real runs that do not tell it.
    pub arm: Option<String>,
    /// Unambiguous name of the world; `None` for real runs and published results.
    pub world: Option<String>,
    /// Unambiguous name of the start; `None` for real runs and published results.
    pub start: Option<String>,
    /// The kind of robot; `None` in the twin.
    pub robot: Option<RobotKind>,
    /// True if the robot goes on while the agent computes.
    pub asynchronous: bool,
}

/// One agent on one track: all its episodes.
#[derive(Clone, Debug)]
pub struct Entrant {
    /// The fields that distinguish it.
    pub identity: Identity,
    /// The shortest name that distinguishes it from the others on its track.
    pub label: String,
    /// Its results, by goal and seed.
    pub files: Vec<ResultFile>,
    /// Its episodes without a result.
    pub lost: Vec<Lost>,
}

/// A goal with at least one result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GoalInfo {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: Option<String>,
    /// Pegs in it.
    pub pegs: usize,
}

/// Everything that was read.
#[derive(Clone, Debug)]
pub struct Collection {
    /// By track, in the order in which the caller gave their folders.
    pub entrants: Vec<Entrant>,
    /// By class and name.
    pub goals: Vec<GoalInfo>,
    /// Published means of others.
    pub published: Vec<Published>,
    /// Verdicts on plans alone, by goal and planner.
    pub plans: Vec<PlanVerdict>,
    /// Verdicts on detectors alone, by name.
    pub perception: Vec<PerceptionVerdict>,
    /// Trials of single skills, by skill and seed.
    pub trials: Vec<Trial>,
    /// Notes for the reader about the files.
    pub notes: Vec<String>,
}

/// Reads all results of some folders.
///
/// # Errors
/// At the first invalid file. Files that do not end in `.json`, and JSON files without a schema of
/// RAMP, are skipped with a note.
pub fn collect(folders: &[PathBuf]) -> Result<Collection, CollectError> {
    let mut files: Vec<ResultFile> = Vec::new();
    let mut published: Vec<Published> = Vec::new();
    let mut plans: Vec<PlanVerdict> = Vec::new();
    let mut perception: Vec<PerceptionVerdict> = Vec::new();
    let mut trials: Vec<(PathBuf, Trial)> = Vec::new();
    let mut notes = Vec::new();
    let mut lost: Vec<(PathBuf, String)> = Vec::new();
    let mut seen = Vec::new();
    for folder in folders {
        let place = folder.canonicalize().map_err(|error| unreadable(folder, &error))?;
        if seen.contains(&place) {
            continue;
        }
        seen.push(place);
        let (paths, debris) = list(folder)?;
        notes.extend(describe_debris(debris, &shown(folder)));
        let mut found = false;
        for path in &paths {
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("json") => {
                    let file = read(path)?;
                    found |= match &file {
                        Found::Episode(file) => file.result.fault.is_none() && file.result.state.is_none(),
                        other => !matches!(other, Found::Other),
                    };
                    match file {
                        Found::Episode(file) if file.result.fault.is_some() => {
                            notes.push(format!(
                                "{} is of an episode with a fault and is left out",
                                shown(path)
                            ));
                        }
                        Found::Episode(file) if file.result.state.is_some() => {
                            notes.push(format!(
                                "{} is of an episode that began in a state of its own and is left out",
                                shown(path)
                            ));
                        }
                        Found::Episode(file) => files.push(*file),
                        Found::Published(means) => published.push(means),
                        Found::Plan(verdict) => plans.push(verdict),
                        Found::Perception(verdict) => perception.push(verdict),
                        Found::Trial(trial) => trials.push((path.clone(), *trial)),
                        Found::Other => {
                            notes.push(format!("{} is not a result and is ignored", shown(path)));
                        }
                    }
                }
                Some("log") if !path.with_extension("json").exists() => {
                    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                    lost.push((folder.clone(), stem));
                }
                _ => {}
            }
        }
        if !found {
            return Err(CollectError::Empty { folder: shown(folder) });
        }
    }
    let goals = goals(&files)?;
    // In the order in which the caller gave them.
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
            let name = |file: &ResultFile| shown(&file.path);
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
    perception.sort_by(|a, b| (&a.labels, &a.detector).cmp(&(&b.labels, &b.detector)));
    let trials = once(trials)?;
    Ok(Collection { entrants, goals, published, plans, perception, trials, notes })
}

/// The trials in order. An episode that occurs twice is an error.
fn once(mut trials: Vec<(PathBuf, Trial)>) -> Result<Vec<Trial>, CollectError> {
    let own = |trial: &Trial| {
        let (agent, software) = (&trial.agent, &trial.software);
        let agent = (agent.name.clone(), agent.version.clone(), agent.sha256.clone());
        let software = (software.version.clone(), software.commit.clone());
        (trial.track.clone(), agent, software, trial.skill.clone(), trial.seed)
    };
    trials.sort_by_cached_key(|(_, trial)| own(trial));
    if let Some(pair) = trials.windows(2).find(|pair| own(&pair[0].1) == own(&pair[1].1)) {
        let name = |(path, _): &(PathBuf, Trial)| shown(path);
        return Err(CollectError::Twice { first: name(&pair[0]), second: name(&pair[1]) });
    }
    Ok(trials.into_iter().map(|(_, trial)| trial).collect())
}

/// The files of a folder, by name, and the number of those that a file manager left there.
fn list(folder: &Path) -> Result<(Vec<PathBuf>, usize), CollectError> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        paths.push(entry.map_err(|error| unreadable(folder, &error))?.path());
    }
    let all = paths.len();
    paths.retain(|path| !is_debris(path));
    let debris = all - paths.len();
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok((paths, debris))
}

/// The goals of some results, each once.
fn goals(files: &[ResultFile]) -> Result<Vec<GoalInfo>, CollectError> {
    let mut known: BTreeMap<String, (&ResultFile, GoalInfo)> = BTreeMap::new();
    for file in files {
        let result = &file.result;
        let goal =
            GoalInfo { name: result.goal.clone(), class: result.class.clone(), pegs: result.pegs.len() };
        match known.get(&goal.name) {
            None => {
                known.insert(goal.name.clone(), (file, goal));
            }
            Some((_, same)) if *same == goal => {}
            Some((first, other)) => {
                let say = |goal: &GoalInfo| {
                    format!("{} pegs, class {}", goal.pegs, goal.class.as_deref().unwrap_or("none"))
                };
                return Err(CollectError::TwoGoals {
                    goal: shorten(&goal.name),
                    first: shown(&first.path),
                    second: shown(&file.path),
                    why: format!("{}; {}", say(other), say(&goal)),
                });
            }
        }
    }
    let mut goals: Vec<GoalInfo> = known.into_values().map(|(_, goal)| goal).collect();
    goals.sort_by_cached_key(|goal| {
        let digits = goal.name.len() - goal.name.bytes().rev().take_while(u8::is_ascii_digit).count();
        let number: u64 = goal.name[digits..].parse().unwrap_or(0);
        let size = Size::of_goal_name(&goal.name);
        (class_rank(goal.class.as_deref()), size, goal.name[..digits].to_string(), number, goal.name.clone())
    });
    Ok(goals)
}

/// Classes in order, with the sets of the open class after the others. Goals without a class come last.
pub fn class_rank(class: Option<&str>) -> (bool, Option<Class>) {
    let class = class.and_then(Class::of_name);
    (class.is_none(), class)
}

impl Identity {
    /// The track's index among all tracks.
    fn track_rank(&self) -> usize {
        Track::ALL.iter().position(|known| known.name() == self.track).unwrap_or(Track::ALL.len())
    }

    /// The conditions that entrants who are compared share.
    pub fn setting(&self) -> Setting {
        Setting {
            track: self.track.clone(),
            arm: self.arm.clone(),
            world: self.world.clone(),
            start: self.start.clone(),
            robot: self.real.as_ref().map(|real| real.kind),
            asynchronous: self.asynchronous,
        }
    }

    /// The agent and, if it is a real one, the robot, whatever the conditions.
    pub fn who(&self) -> (&str, &str, Option<&str>, Option<&str>) {
        let robot = self.real.as_ref().map(|real| real.robot.as_str());
        (&self.agent, &self.agent_version, self.agent_sha256.as_deref(), robot)
    }

    fn of(result: &EpisodeResult) -> Identity {
        let EpisodeResult { track, agent, software, secret, real, .. } = result;
        let AgentInfo { name, version: agent_version, sha256, asynchronous } = agent;
        let Software { version, commit } = software;
        Identity {
            track: track.clone(),
            arm: result.arm.clone(),
            world: result.world.as_ref().map(WorldInfo::title),
            start: result.start.as_ref().map(StartInfo::title),
            setting_sha256: result
                .world
                .as_ref()
                .zip(result.start.as_ref())
                .map(|(world, start)| [world.sha256.clone(), start.sha256.clone()]),
            agent: name.clone(),
            agent_version: agent_version.clone(),
            agent_sha256: sha256.clone(),
            asynchronous: *asynchronous,
            version: version.clone(),
            commit: commit.clone(),
            secret: secret.clone(),
            real: real.clone(),
        }
    }
}

/// Gives each entrant the shortest label that distinguishes it from the others on its track.
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
            if let Some(secret) = &it.secret {
                label = format!("{label}, secret {}", ramp_kit::source::shorten(secret));
            }
        }
        label
    };
    let labels: Vec<String> = (0..entrants.len())
        .map(|index| {
            let others = |words: usize| {
                let mine = say(&entrants[index], words);
                let same = |other: &Entrant| {
                    other.identity.setting() == entrants[index].identity.setting()
                        && say(other, words) == mine
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

/// Assigns an episode that has only a log, `GOAL-TRACK-SEED`, to the one entrant with results in
/// the same folder.
fn assign(entrants: &mut [Entrant], folder: &Path, stem: &str, notes: &mut Vec<String>) {
    let mut parts = stem.rsplitn(3, '-');
    let seed = parts.next().and_then(|seed| seed.parse().ok());
    let track = parts.next().filter(|track| Track::ALL.iter().any(|known| known.name() == *track));
    let goal = parts.next().filter(|goal| is_name(goal));
    let (Some(seed), Some(track), Some(goal)) = (seed, track, goal) else { return };
    let mut here = entrants.iter_mut().filter(|entrant| {
        entrant.identity.track == track && entrant.files.iter().any(|file| file.path.parent() == Some(folder))
    });
    match (here.next(), here.next()) {
        (Some(entrant), None) => entrant.lost.push(Lost { goal: goal.to_string(), seed }),
        _ => notes.push(format!("{stem} in {} was lost, and whose it was is not known", shown(folder))),
    }
}
