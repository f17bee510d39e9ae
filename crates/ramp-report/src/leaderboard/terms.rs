//! Conditions of admission to a board: one agent, whole classes of the organiser's goals, and
//! results that match their logs.

use super::boards::SHOWN_HASH;
use crate::report::repeats;
use ramp_kit::source::shorten;
use ramp_log::{Facts, SecretSeed};
use ramp_result::collection::{Collection, Identity, ResultFile};
use ramp_result::secret::Secret;
use ramp_result::sha256;
use ramp_result::shipped::{Kind, may_be_named};

/// A goal of the organiser.
#[derive(Clone, Debug)]
pub struct BoardGoal {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: Option<String>,
    /// Pegs in it.
    pub pegs: usize,
    /// Its file.
    pub xml: String,
}

/// An arm of the organiser.
#[derive(Clone, Debug)]
pub struct BoardArm {
    /// Its name.
    pub name: String,
    /// Its file.
    pub json: String,
}

/// Inputs that results must have been made with.
#[derive(Clone, Debug)]
pub struct BoardTerms {
    /// The goals.
    pub goals: Vec<BoardGoal>,
    /// The kit file.
    pub kit: String,
    /// The arms that have boards.
    pub arms: Vec<BoardArm>,
    /// The files of the starts that have boards.
    pub starts: Vec<String>,
    /// The secret mixed into the seeds; `None` for public seeds.
    pub secret: Option<Secret>,
}

impl BoardTerms {
    /// Everything that is the same in all entries of a board of this class with this arm: its name, and its
    /// SHA-256 or commitment.
    pub fn compared(&self, class: Option<&str>, arm: Option<&str>) -> Vec<(String, String)> {
        let hash = |text: &str| sha256(text.as_bytes());
        let goals = self.goals.iter().filter(|goal| goal.class.as_deref() == class);
        let goals = goals.map(|goal| (format!("goal {}", goal.name), hash(&goal.xml)));
        let arms = self.arms.iter().filter(|it| Some(it.name.as_str()) == arm);
        let arms = arms.map(|it| (format!("arm {}", it.name), hash(&it.json)));
        let secret = self.secret.iter().map(|it| ("secret of the seeds".to_string(), it.commitment()));
        [("kit".to_string(), hash(&self.kit))].into_iter().chain(arms).chain(goals).chain(secret).collect()
    }
}

/// Reasons why a result is not admitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// No episode that a board could show.
    #[error("it contains no episode of an agent")]
    NoEpisode,
    /// More than one agent.
    #[error("it holds results of {first} and of {second}, but an entry is of one agent")]
    Agents {
        /// One agent.
        first: String,
        /// The other.
        second: String,
    },
    /// An incomplete class.
    #[error(
        "{who}: {goal} was run with seeds {found}; a class is every goal of it with seeds 1 to {repeats}"
    )]
    Part {
        /// The agent and track.
        who: String,
        /// The goal.
        goal: String,
        /// The existing seeds.
        found: String,
        /// The last seed that was expected.
        repeats: u64,
    },
    /// A goal that is not the organiser's.
    #[error("{file}: the goal differs from this board's goal of the same name")]
    Goal {
        /// The result.
        file: String,
    },
    /// Other parts, or another start, than the organiser's.
    #[error("{file}: the {what} differs from this board's")]
    Other {
        /// The result.
        file: String,
        /// Kit, arm or start.
        what: &'static str,
    },
    /// Seeds that are not the organiser's.
    #[error("{file}: run with {found}, expected {expected}")]
    Seed {
        /// The result.
        file: String,
        /// The secret of its seeds, in words.
        found: String,
        /// The organiser's, in words.
        expected: String,
    },
    /// A shipped name on a file that was never shipped.
    #[error(
        "{file}: {kind} `{name}` was never shipped with the SHA-256 {hash}; a file of one's own needs a name of its own"
    )]
    NotShipped {
        /// The result.
        file: String,
        /// World or start.
        kind: &'static str,
        /// Its name.
        name: String,
        /// The begin of its SHA-256.
        hash: String,
    },
    /// The result does not match its log.
    #[error("{file}: the result differs from the one in its log")]
    NotOfLog {
        /// The result.
        file: String,
    },
}

/// The agent of an entry: one name, version, file and program, on one or several tracks.
///
/// # Errors
/// When there is none, or more than one.
pub fn one_agent(collection: &Collection) -> Result<&Identity, Refused> {
    let mut identities = collection.entrants.iter().map(|entrant| &entrant.identity);
    let first = identities.next().ok_or(Refused::NoEpisode)?;
    let without_track = |it: &Identity| Identity { track: String::new(), ..it.clone() };
    match identities.find(|it| without_track(it) != without_track(first)) {
        Some(second) => Err(Refused::Agents { first: agent(first), second: agent(second) }),
        None => Ok(first),
    }
}

/// An agent in words.
pub fn agent(identity: &Identity) -> String {
    format!("{} {}", identity.agent, identity.agent_version)
}

/// Checks that every class with at least one episode is complete. Lost episodes count.
///
/// # Errors
/// The first goal that is not the organiser's, lacks a seed, or has one too many.
pub fn check_whole(collection: &Collection, terms: &BoardTerms) -> Result<(), Refused> {
    for entrant in &collection.entrants {
        let of = |goal: &str| {
            let files = entrant.files.iter().filter(|file| file.result.goal == goal);
            let lost = entrant.lost.iter().filter(|lost| lost.goal == goal);
            let mut seeds: Vec<u64> =
                files.map(|file| file.result.seed).chain(lost.map(|lost| lost.seed)).collect();
            seeds.sort_unstable();
            seeds
        };
        let who = format!("{}, track {}", entrant.label, entrant.identity.track);
        // The class in a result determines its board.
        let known = |file: &&ResultFile| {
            terms.goals.iter().any(|goal| {
                let it = &file.result;
                (&goal.name, &goal.class, goal.pegs) == (&it.goal, &it.class, it.pegs.len())
            })
        };
        if let Some(file) = entrant.files.iter().find(|file| !known(file)) {
            return Err(Refused::Goal { file: file.path.display().to_string() });
        }
        for goal in &terms.goals {
            let begun = terms.goals.iter().any(|other| {
                other.class == goal.class && goal.class.is_some() && !of(&other.name).is_empty()
            });
            let seeds = of(&goal.name);
            let repeats = repeats(goal.class.as_deref());
            let whole = seeds == (1..=repeats).collect::<Vec<u64>>();
            if (begun || !seeds.is_empty()) && !whole {
                let list: Vec<String> = seeds.iter().map(u64::to_string).collect();
                let found = if list.is_empty() { "none".to_string() } else { list.join(", ") };
                return Err(Refused::Part { who, goal: goal.name.clone(), found, repeats });
            }
        }
    }
    Ok(())
}

/// Checks that a result was made with the organiser's goal, parts and start, in a world that may have its
/// name, and matches its log.
///
/// # Errors
/// The difference.
pub fn check_log(file: &ResultFile, log: &Facts, terms: &BoardTerms) -> Result<(), Refused> {
    let name = || file.path.display().to_string();
    let hash = |text: &str| sha256(text.as_bytes());
    let goal = terms.goals.iter().find(|goal| goal.name == file.result.goal);
    if goal.is_none_or(|goal| hash(&goal.xml) != log.goal.sha256 || goal.name != log.goal.name) {
        return Err(Refused::Goal { file: name() });
    }
    let other = |what| Err(Refused::Other { file: name(), what });
    if log.kit != hash(&terms.kit) {
        return other("kit");
    }
    let arm = terms.arms.iter().find(|it| hash(&it.json) == log.arm);
    let Some(arm) = arm else { return other("arm") };
    if !terms.starts.iter().any(|start| hash(start) == log.start.sha256) {
        return other("start");
    }
    for (kind, logged) in [(Kind::World, &log.world), (Kind::Start, &log.start)] {
        if !may_be_named(kind, &logged.name, &logged.sha256) {
            return Err(Refused::NotShipped {
                file: name(),
                kind: kind.name(),
                name: shorten(&logged.name),
                hash: logged.sha256.chars().take(SHOWN_HASH).collect(),
            });
        }
    }
    let world = file.result.world.as_ref().map(|it| (&it.name, &it.sha256));
    let start = file.result.start.as_ref().map(|it| (&it.name, &it.sha256));
    let logged = [&log.world, &log.start].map(|it| Some((&it.name, &it.sha256)));
    if [world, start] != logged || file.result.arm.as_ref() != Some(&arm.name) {
        return Err(Refused::NotOfLog { file: name() });
    }
    let name_of = |commitment: Option<&String>| match commitment {
        Some(commitment) => format!("the secret {}", shorten(commitment)),
        None => "no secret in its seeds".to_string(),
    };
    let expected = terms.secret.as_ref().map(|secret| SecretSeed {
        commitment: secret.commitment(),
        seed: secret.seed(&log.goal.name, &log.track, log.seed),
    });
    let commitment = |seed: &Option<SecretSeed>| seed.as_ref().map(|seed| seed.commitment.clone());
    if commitment(&log.secret) != commitment(&expected) {
        let found = name_of(commitment(&log.secret).as_ref());
        return Err(Refused::Seed { file: name(), found, expected: name_of(commitment(&expected).as_ref()) });
    }
    if log.secret != expected {
        return other("seed of the world");
    }
    if log.result != file.result.digest() || file.result.log.as_ref() != Some(&log.log) {
        return Err(Refused::NotOfLog { file: name() });
    }
    Ok(())
}
