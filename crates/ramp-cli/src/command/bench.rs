//! `ramp bench`: goals and whole classes by the protocol, each episode in a process of its own, and the sums.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::fmt::Write;
use std::fs::{File, TryLockError};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use miette::{Diagnostic, IntoDiagnostic, Report, miette};
use ramp_assembly::Class;
use ramp_eval::external::{AgentFile, adopt_orphans, end_orphans};
use ramp_eval::log::ENDING;
use ramp_eval::result::{EpisodeResult, SCHEMA, Software};
use ramp_eval::summary::{Entry, Summary, shortfall};
use ramp_kit::source::{nearest, shorten};
use ramp_robot::Track;
use serde_json::{Value, json};

use super::agent;
use super::run::{TrackName, software};
use crate::data::{Data, print};
use crate::{DONE, INCOMPLETE};

/// The name that stands for every goal.
const ALL: &str = "all";
/// Folder in the results' folder for what is not finished.
const RUNNING: &str = ".running";
/// File in the results' folder that one bench at a time holds.
const LOCK: &str = ".lock";
/// The bench was stopped by Ctrl-C.
const STOPPED: u8 = 130;
/// What is left of an episode's time on the wall to score it when an agent is not done.
const SCORING: Duration = Duration::from_secs(20);
/// How often the bench looks after its episodes.
const LOOK: Duration = Duration::from_millis(50);

#[derive(clap::Args)]
pub struct Arguments {
    /// Goals, classes (easy, medium, hard) or `all`
    #[arg(required = true, value_name = "CLASS|GOAL")]
    goals: Vec<String>,
    /// What the agent may see of the parts
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    agent: agent::Arguments,
    /// Episodes of each goal, with seeds in a row
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repeats: u32,
    /// Seed of the first episode of each goal
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    first_seed: u64,
    /// Episodes at a time; more than one makes the agent's own time longer
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    jobs: u32,
    /// Time on the wall after which an episode is lost
    #[arg(long, value_name = "SECONDS", default_value_t = 1800, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    limit: u64,
    /// Print the sums as JSON
    #[arg(long)]
    json: bool,
    /// Folder for the results; made if it is not there, continued if it is
    #[arg(short, long, value_name = "DIR", default_value = "results/bench")]
    output: PathBuf,
}

/// Why a bench does not start.
#[derive(Debug, thiserror::Error, Diagnostic)]
enum BenchError {
    #[error("there is no goal and no class `{name}`")]
    Unknown {
        name: String,
        #[help]
        help: String,
    },
    #[error("{first} and {second} are two goals of the name `{name}`")]
    #[diagnostic(help("rename one of the files: results are told apart by the goal's name"))]
    SameName { name: String, first: String, second: String },
    #[error("no goal in {folder} is of the class `{class}`")]
    EmptyClass { class: String, folder: String },
    #[error("the seeds go past the largest number there is")]
    #[diagnostic(help("take a smaller --first-seed or fewer --repeats"))]
    Seeds,
    #[error("{file} was made by {theirs}, and this is {ours}")]
    #[diagnostic(help(
        "results of different versions are not added up: name another folder with -o, or move these away"
    ))]
    OtherVersion { file: String, theirs: String, ours: String },
    #[error("{file} is of the agent {theirs}, and the folder would become one of two agents")]
    #[diagnostic(help(
        "a class is run with one unchanged agent: name another folder with -o, or move these away"
    ))]
    OtherAgent { file: String, theirs: String },
    #[error("another bench is at work in {folder}")]
    #[diagnostic(help("wait for it, or name another folder with -o"))]
    Busy { folder: String },
}

/// A goal to be run.
struct Goal {
    name: String,
    /// As `ramp run` is told it.
    argument: String,
    class: Option<Class>,
    pegs: usize,
}

/// One episode that is asked for.
struct Episode {
    goal: usize,
    seed: u64,
    repeat: u32,
    /// Name of its files, without an ending.
    stem: String,
    outcome: Outcome,
}

enum Outcome {
    /// Not run yet.
    Open,
    Finished(Box<EpisodeResult>),
    /// Crashed, killed or out of time, and why.
    Lost(String),
}

/// An episode at work.
struct Worker {
    episode: usize,
    child: Child,
    since: Instant,
}

/// What all episodes of a bench share.
struct Bench<'a> {
    data: &'a Data,
    folder: &'a Path,
    track: &'static str,
    limit: Duration,
    agent: Option<AgentFile>,
    agent_limit: f64,
    goals: Vec<Goal>,
    software: Software,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let goals = find_goals(data, &arguments.goals)?;
    if arguments.first_seed.checked_add(u64::from(arguments.repeats) - 1).is_none() {
        return Err(BenchError::Seeds.into());
    }
    let folder = &arguments.output;
    if folder.exists() && !folder.is_dir() {
        return Err(miette!(help = "name a folder with -o", "{} is not a folder", folder.display()));
    }
    let bench = Bench {
        data,
        folder,
        track: Track::from(arguments.track).name(),
        limit: Duration::from_secs(arguments.limit),
        agent: arguments.agent.file()?,
        agent_limit: arguments.agent.agent_limit,
        goals,
        software: software(),
    };
    if bench.agent.is_some() {
        adopt_orphans();
    }
    bench.refuse_other_versions()?;
    std::fs::create_dir_all(folder)
        .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
    let lock = File::create(folder.join(LOCK))
        .map_err(|error| miette!("cannot write to {}: {error}", folder.display()))?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(BenchError::Busy { folder: folder.display().to_string() }.into());
        }
        Err(TryLockError::Error(error)) => return Err(error).into_diagnostic(),
    }
    let stop = Arc::new(AtomicBool::new(false));
    let handler = stop.clone();
    ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed)).into_diagnostic()?;

    let mut episodes = bench.episodes(arguments);
    let jobs = arguments.jobs as usize;
    let whole = bench.work(&mut episodes, jobs, &stop)?;
    if !whole {
        let finished = episodes.iter().filter(|it| matches!(it.outcome, Outcome::Finished(_))).count();
        eprintln!(
            "stopped: {finished} of {} episodes are finished; the same command goes on from there",
            episodes.len()
        );
        return Ok(STOPPED);
    }
    print(&if arguments.json {
        bench.sums_json(arguments, &episodes)?
    } else {
        bench.sums_text(arguments, &episodes)
    })?;
    let lost = episodes.iter().any(|episode| matches!(episode.outcome, Outcome::Lost(_)));
    Ok(if lost { INCOMPLETE } else { DONE })
}

/// The goals that are meant, each once, in the order they were named.
fn find_goals(data: &Data, words: &[String]) -> Result<Vec<Goal>, Report> {
    let kit = data.kit()?;
    let folder = data.goals();
    let names = ramp_assembly::goal_names(&folder)
        .map_err(|error| miette!("the folder {} cannot be read: {error}", folder.display()))?;
    let mut goals: Vec<Goal> = Vec::new();
    for word in words {
        let class = Class::ALL.into_iter().find(|class| class.name() == word);
        let is_file = word.ends_with(".xml") || Path::new(word).components().count() > 1;
        let meant: Vec<&str> = if class.is_some() || word == ALL {
            names.iter().map(String::as_str).collect()
        } else if is_file || names.contains(word) {
            vec![word]
        } else {
            let mut known: Vec<&str> = names.iter().map(String::as_str).collect();
            known.extend(Class::ALL.map(Class::name));
            known.push(ALL);
            let near = nearest(word, known);
            let help = near.map_or_else(
                || format!("the goals are {}; the classes easy, medium, hard and all", names.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(BenchError::Unknown { name: shorten(word), help }.into());
        };
        let mut found = false;
        for argument in meant {
            let assembly = data.goal(argument, &kit)?;
            if class.is_some() && assembly.class != class {
                continue;
            }
            found = true;
            match goals.iter().find(|goal| goal.name == assembly.name) {
                None => goals.push(Goal {
                    name: assembly.name.clone(),
                    argument: argument.to_string(),
                    class: assembly.class,
                    pegs: assembly.connections.len(),
                }),
                Some(known) if known.argument == argument => {}
                Some(known) => {
                    return Err(BenchError::SameName {
                        name: assembly.name.clone(),
                        first: known.argument.clone(),
                        second: argument.to_string(),
                    }
                    .into());
                }
            }
        }
        if !found {
            return Err(
                BenchError::EmptyClass { class: word.clone(), folder: folder.display().to_string() }.into()
            );
        }
    }
    Ok(goals)
}

impl Bench<'_> {
    /// A folder is of one version of the software and one agent.
    fn refuse_other_versions(&self) -> Result<(), Report> {
        let Ok(entries) = std::fs::read_dir(self.folder) else { return Ok(()) };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "json")) {
            let Ok(text) = std::fs::read_to_string(path) else { continue };
            let Ok(value) = serde_json::from_str::<Value>(&text) else { continue };
            let Some(schema) = value["schema"].as_str().filter(|it| it.starts_with("ramp-episode-")) else {
                continue;
            };
            let theirs = &value["software"];
            if schema != SCHEMA
                || theirs["version"] != self.software.version.as_str()
                || theirs["commit"] != self.software.commit.as_str()
            {
                let part = |name: &str| theirs[name].as_str().unwrap_or("unknown");
                return Err(BenchError::OtherVersion {
                    file: path.display().to_string(),
                    theirs: format!("ramp {} ({}, {schema})", part("version"), part("commit")),
                    ours: format!("ramp {} ({}, {SCHEMA})", self.software.version, self.software.commit),
                }
                .into());
            }
            let agent = &value["agent"];
            if agent["sha256"].as_str() != self.agent.as_ref().map(AgentFile::sha256) {
                let part = |name: &str| agent[name].as_str().unwrap_or("unknown");
                return Err(BenchError::OtherAgent {
                    file: path.display().to_string(),
                    theirs: format!("{} {}", part("name"), part("version")),
                }
                .into());
            }
        }
        Ok(())
    }

    /// All episodes that are asked for, with the results that are there.
    fn episodes(&self, arguments: &Arguments) -> Vec<Episode> {
        let mut episodes = Vec::new();
        for (goal, Goal { name, .. }) in self.goals.iter().enumerate() {
            for repeat in 1..=arguments.repeats {
                let seed = arguments.first_seed + u64::from(repeat - 1);
                let stem = format!("{name}-{}-{seed}", self.track);
                let path = self.folder.join(format!("{stem}.json"));
                let outcome = match self.read(&path, goal, seed) {
                    Some(result) => Outcome::Finished(Box::new(result)),
                    None => Outcome::Open,
                };
                if matches!(outcome, Outcome::Open) && path.exists() {
                    eprintln!(
                        "{} is no result of this episode: it is run again and replaced",
                        path.display()
                    );
                }
                episodes.push(Episode { goal, seed, repeat, stem, outcome });
            }
        }
        episodes
    }

    /// The result in a file, if it is one of this very episode and this software.
    fn read(&self, path: &Path, goal: usize, seed: u64) -> Option<EpisodeResult> {
        let text = std::fs::read_to_string(path).ok()?;
        let result: EpisodeResult = serde_json::from_str(&text).ok()?;
        let goal = &self.goals[goal];
        let fits = result.schema == SCHEMA
            && result.goal == goal.name
            && result.pegs.len() == goal.pegs
            && result.track == self.track
            && result.seed == seed
            && result.software == self.software
            && result.fault.is_none()
            && result.agent.sha256.as_deref() == self.agent.as_ref().map(AgentFile::sha256);
        fits.then_some(result)
    }

    /// Runs what is open; false when it was stopped.
    fn work(&self, episodes: &mut [Episode], jobs: usize, stop: &AtomicBool) -> Result<bool, Report> {
        let mut open: VecDeque<usize> =
            (0..episodes.len()).filter(|&it| matches!(episodes[it].outcome, Outcome::Open)).collect();
        let running = self.folder.join(RUNNING);
        // What a bench that was killed has left behind.
        if running.exists() {
            std::fs::remove_dir_all(&running).into_diagnostic()?;
        }
        if open.is_empty() {
            return Ok(true);
        }
        std::fs::create_dir_all(&running).into_diagnostic()?;
        let display = Display::new(open.len(), episodes.len() - open.len(), jobs);
        let mut workers: Vec<Worker> = Vec::new();
        let mut failure = None;
        while failure.is_none() && !(open.is_empty() && workers.is_empty()) {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            while workers.len() < jobs
                && let Some(episode) = open.pop_front()
            {
                match self.start(&running, &episodes[episode]) {
                    Ok(child) => workers.push(Worker { episode, child, since: Instant::now() }),
                    Err(error) => episodes[episode].outcome = Outcome::Lost(format!("not started: {error}")),
                }
            }
            let mut index = 0;
            while index < workers.len() {
                match self.look_after(&running, &mut workers[index], episodes) {
                    Ok(None) => index += 1,
                    Ok(Some(outcome)) => {
                        let worker = workers.swap_remove(index);
                        if self.agent.is_some() {
                            let at_work = workers.iter().filter_map(|it| i32::try_from(it.child.id()).ok());
                            end_orphans(&at_work.collect::<Vec<_>>());
                        }
                        let episode = &mut episodes[worker.episode];
                        episode.outcome = outcome;
                        display.ended(episode, worker.since.elapsed());
                    }
                    Err(error) => {
                        failure = Some(error);
                        break;
                    }
                }
            }
            display.at_work(workers.iter().map(|worker| episodes[worker.episode].stem.as_str()));
            std::thread::sleep(LOOK);
        }
        let whole = open.is_empty() && workers.is_empty();
        for worker in &mut workers {
            let _ = worker.child.kill();
            let _ = worker.child.wait();
        }
        display.finish();
        let _ = std::fs::remove_dir_all(&running);
        match failure {
            Some(error) => Err(error),
            None => Ok(whole),
        }
    }

    /// Starts an episode in its own process. The pipe to its standard input is its leash: it closes when the bench
    /// dies, however that happens.
    fn start(&self, running: &Path, episode: &Episode) -> std::io::Result<Child> {
        let log = File::create(running.join(format!("{}.log", episode.stem)))?;
        let mut command = Command::new(std::env::current_exe()?);
        command
            .args(self.data.arguments())
            .args(["run", "--leash", "--track", self.track])
            .args(["--seed", &episode.seed.to_string(), "--repeat", &episode.repeat.to_string()])
            .args(self.agent_arguments())
            .arg("-o")
            .arg(running.join(format!("{}.json", episode.stem)))
            .arg("--")
            .arg(&self.goals[episode.goal].argument)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(log);
        // Ctrl-C on a terminal is for the bench alone, which then ends its episodes.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn()
    }

    /// What an episode is told of the agent: one that would not be done in time is ended before the episode is.
    fn agent_arguments(&self) -> Vec<OsString> {
        let Some(agent) = &self.agent else { return Vec::new() };
        let end_after = self.limit.saturating_sub(SCORING.min(self.limit / 2)).as_secs();
        let words = [
            "--agent-limit".into(),
            self.agent_limit.to_string(),
            "--end-after".into(),
            end_after.to_string(),
            "--agent".into(),
        ];
        words.into_iter().map(OsString::from).chain([agent.path().into()]).collect()
    }

    /// Whether an episode has ended, and how. What it wrote is moved to its place.
    ///
    /// # Errors
    /// When a finished result cannot be moved: then no other could be.
    fn look_after(
        &self,
        running: &Path,
        worker: &mut Worker,
        episodes: &[Episode],
    ) -> Result<Option<Outcome>, Report> {
        let episode = &episodes[worker.episode];
        let status = match worker.child.try_wait().into_diagnostic()? {
            Some(status) => Some(status),
            None if worker.since.elapsed() < self.limit => return Ok(None),
            None => {
                let _ = worker.child.kill();
                let _ = worker.child.wait();
                None
            }
        };
        let stem = &episode.stem;
        let place = |ending: &str| {
            let name = format!("{stem}.{ending}");
            (running.join(&name), self.folder.join(name))
        };
        let (result_from, result_to) = place("json");
        let (curve_from, curve_to) = place("svg");
        let (record_from, record_to) = place(ENDING);
        let (log_from, log_to) = place("log");
        let result = self.read(&result_from, episode.goal, episode.seed);
        if let (Some(status), Some(result)) = (status, result)
            && status.code().is_some_and(|code| [DONE, INCOMPLETE].map(i32::from).contains(&code))
        {
            std::fs::rename(&curve_from, &curve_to).into_diagnostic()?;
            std::fs::rename(&record_from, &record_to).into_diagnostic()?;
            std::fs::rename(&result_from, &result_to).into_diagnostic()?;
            // What an agent of one's own has said is kept.
            if self.agent.is_some() {
                let _ = std::fs::rename(&log_from, &log_to);
            } else {
                let _ = std::fs::remove_file(&log_from);
                let _ = std::fs::remove_file(&log_to);
            }
            return Ok(Some(Outcome::Finished(Box::new(result))));
        }
        let _ = std::fs::remove_file(&result_from);
        let _ = std::fs::remove_file(&curve_from);
        let _ = std::fs::remove_file(&record_from);
        let _ = std::fs::rename(&log_from, &log_to);
        let reason = match status {
            Some(status) => end_of(status),
            None => format!("not done after {} s on the wall", self.limit.as_secs()),
        };
        Ok(Some(Outcome::Lost(format!("{reason}; its last words are in {stem}.log"))))
    }

    /// The sums of each goal, and of each class that has goals here.
    fn sums(&self, episodes: &[Episode]) -> (Vec<Summary>, Vec<(Class, usize, Summary)>) {
        let entries: Vec<(usize, Entry)> = episodes
            .iter()
            .map(|episode| {
                let result = match &episode.outcome {
                    Outcome::Finished(result) => Some((**result).clone()),
                    Outcome::Open | Outcome::Lost(_) => None,
                };
                (episode.goal, Entry { pegs: self.goals[episode.goal].pegs, result })
            })
            .collect();
        let of = |wanted: &dyn Fn(usize) -> bool| {
            Summary::of(entries.iter().filter(|(goal, _)| wanted(*goal)).map(|(_, entry)| entry))
        };
        let goals = (0..self.goals.len()).map(|goal| of(&|it| it == goal)).collect();
        let classes = Class::ALL
            .into_iter()
            .filter_map(|class| {
                let count = self.goals.iter().filter(|goal| goal.class == Some(class)).count();
                (count > 0).then(|| (class, count, of(&|goal| self.goals[goal].class == Some(class))))
            })
            .collect();
        (goals, classes)
    }

    /// Each episode that is not complete: which, pegs that count, whether it has a result, and why.
    fn failures<'e>(
        &'e self,
        episodes: &'e [Episode],
    ) -> impl Iterator<Item = (&'e Episode, usize, bool, String)> {
        episodes.iter().filter_map(|episode| match &episode.outcome {
            Outcome::Finished(result) => {
                shortfall(result).map(|reason| (episode, result.counted(), true, reason))
            }
            Outcome::Lost(reason) => Some((episode, 0, false, reason.clone())),
            Outcome::Open => Some((episode, 0, false, "not run".to_string())),
        })
    }

    fn sums_json(&self, arguments: &Arguments, episodes: &[Episode]) -> Result<String, Report> {
        let (goals, classes) = self.sums(episodes);
        let goals: Vec<Value> = self
            .goals
            .iter()
            .zip(&goals)
            .map(|(goal, sum)| json!({"goal": goal.name, "class": goal.class.map(Class::name), "sum": sum}))
            .collect();
        let classes: Vec<Value> = classes
            .iter()
            .map(|(class, count, sum)| json!({"class": class.name(), "goals": count, "sum": sum}))
            .collect();
        let failures: Vec<Value> = self
            .failures(episodes)
            .map(|(episode, counted, finished, reason)| {
                json!({
                    "goal": self.goals[episode.goal].name,
                    "seed": episode.seed,
                    "pegs_counted": counted,
                    "pegs": self.goals[episode.goal].pegs,
                    "lost": !finished,
                    "reason": reason,
                })
            })
            .collect();
        let mut text = serde_json::to_string_pretty(&json!({
            "track": self.track,
            "first_seed": arguments.first_seed,
            "repeats": arguments.repeats,
            "software": self.software,
            "goals": goals,
            "classes": classes,
            "failures": failures,
        }))
        .into_diagnostic()?;
        text.push('\n');
        Ok(text)
    }

    fn sums_text(&self, arguments: &Arguments, episodes: &[Episode]) -> String {
        let (goals, classes) = self.sums(episodes);
        let last = arguments.first_seed + u64::from(arguments.repeats) - 1;
        let mut text = format!("track {}, seeds {} to {last}\n", self.track, arguments.first_seed);
        let width = self.goals.iter().map(|goal| goal.name.chars().count()).max().unwrap_or(0).max(16);
        let _ = writeln!(
            text,
            "{:<width$}  episodes  completion  deviation    best      pegs   mean total time",
            "goal"
        );
        for (goal, sum) in self.goals.iter().zip(&goals) {
            line(&mut text, &goal.name, width, sum);
        }
        for (class, count, sum) in &classes {
            let goals = if *count == 1 { "goal" } else { "goals" };
            line(&mut text, &format!("{}: {count} {goals}", class.name()), width, sum);
        }
        let mut heading = "not complete:\n";
        for (episode, counted, finished, reason) in self.failures(episodes) {
            let goal = &self.goals[episode.goal];
            text.push_str(heading);
            heading = "";
            let pegs = if finished { format!("{counted} of {} pegs", goal.pegs) } else { "lost".to_string() };
            let _ = writeln!(text, "  {} seed {}: {pegs}: {reason}", goal.name, episode.seed);
        }
        let _ = writeln!(text, "results: {}", self.folder.display());
        text
    }
}

/// One line of the table.
fn line(text: &mut String, name: &str, width: usize, sum: &Summary) {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let none = || "-".to_string();
    let _ = writeln!(
        text,
        "{name:<width$}  {:>8}  {:>10}  {:>9}  {:>6}  {:>8}   {}",
        format!("{}/{}", sum.finished, sum.episodes),
        percent(sum.completion.mean),
        sum.completion.deviation.map_or_else(none, percent),
        sum.best.map_or_else(none, |best| format!("{:.0} %", 100.0 * best.completion)),
        format!("{}/{}", sum.pegs_counted, sum.pegs),
        sum.time.map_or_else(none, |time| match time.total_deviation {
            Some(deviation) => format!("{:.1} s ± {deviation:.1} s", time.total),
            None => format!("{:.1} s", time.total),
        }),
    );
}

/// How a process ended, in words.
fn end_of(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("killed by signal {signal}");
    }
    match status.code() {
        Some(code) => format!("ended with status {code} and no result"),
        None => "ended without a result".to_string(),
    }
}

/// Progress on standard error: a bar on a terminal, a line for each episode elsewhere.
struct Display {
    bar: Option<ProgressBar>,
    /// Episodes to run.
    count: usize,
    jobs: usize,
    /// Episodes that have ended, and how long they took together.
    past: std::cell::Cell<(usize, Duration)>,
}

impl Display {
    fn new(count: usize, before: usize, jobs: usize) -> Display {
        if before > 0 {
            eprintln!("{before} of {} episodes are finished already", before + count);
        }
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(count as u64);
            if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} episodes  {elapsed}  {msg}")
            {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Display { bar, count, jobs, past: std::cell::Cell::default() }
    }

    /// What is left, from how long the episodes so far took; nothing before the first has ended.
    fn left(&self) -> Option<String> {
        let (ended, took) = self.past.get();
        if ended == 0 {
            return None;
        }
        let jobs = self.jobs.min(self.count - ended).max(1);
        let left = took.as_secs_f64() / ended as f64 * (self.count - ended) as f64 / jobs as f64;
        Some(if left < 100.0 {
            format!("about {left:.0} s left")
        } else {
            format!("about {:.0} min left", left / 60.0)
        })
    }

    fn at_work<'s>(&self, stems: impl Iterator<Item = &'s str>) {
        if let Some(bar) = &self.bar {
            let names = stems.collect::<Vec<_>>().join(", ");
            let left = self.left().map_or_else(String::new, |left| format!("{left}  "));
            bar.set_message(format!("{left}{names}"));
        }
    }

    fn ended(&self, episode: &Episode, took: Duration) {
        let (ended, before) = self.past.get();
        self.past.set((ended + 1, before + took));
        let what = match &episode.outcome {
            Outcome::Finished(result) => {
                format!("{} of {} pegs in {:.1} s", result.counted(), result.pegs.len(), result.time.total)
            }
            Outcome::Lost(reason) => format!("lost: {reason}"),
            Outcome::Open => "open".to_string(),
        };
        if let Some(bar) = &self.bar {
            bar.println(format!("{}  {what}", episode.stem));
            bar.inc(1);
        } else {
            let left = self.left().unwrap_or_default();
            eprintln!("{}/{}  {}  {what}  ({left})", ended + 1, self.count, episode.stem);
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
