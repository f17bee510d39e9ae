//! Runs many episodes, each in its own process, several in parallel. Finished results are kept and not run
//! again.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report, miette};
use ramp_data::Data;
use ramp_external_agent::{AgentFile, adopt_orphans, end_orphans};
use ramp_log::ENDING;
use ramp_policy_client::PolicyUrl;
use ramp_result::episode::{EpisodeResult, Software, StartInfo, WorldLabel};
use ramp_result::resume::{Identity, Shared, Wanted};
use ramp_result::secret::Secret;
use ramp_world::{Start, World};

use super::display::Display;
use super::episode::{Episode, Outcome};
use super::goals::{BatchError, BatchGoal};
use super::remote::{RESULT, Remote};
use super::tapes::Tapes;
use crate::command::{parts, task};
use crate::ending::{defer_requests, end_of, requested};
use crate::engine::{Backend, Engine};
use crate::lock::{FolderLock, LockError};
use crate::options::is_file;
use crate::output::tell;
use crate::pool;
use crate::seal;
use crate::status::{DONE, INCOMPLETE, MACHINE, MachineFault};

/// Folder inside the results folder for unfinished files.
const RUNNING: &str = ".running";
/// Wall-clock time reserved for scoring an episode whose agent has not finished.
const SCORING: Duration = Duration::from_secs(20);
/// Length of the end of an episode's standard error that is shown when the machine fails, bytes.
const LAST_WORDS: usize = 400;
/// Room that a folder must have for a lost episode to count as lost, bytes.
const ROOM: usize = 1 << 20;
/// Polling interval for the episodes.
const LOOK: Duration = Duration::from_millis(50);

/// The process of an episode.
struct Worker {
    child: Child,
    since: Instant,
}

/// State shared by the threads of the pool.
struct State<'e> {
    episodes: &'e mut [Episode],
    display: Display,
    /// Process ids of the running episodes, by episode.
    at_work: BTreeMap<usize, u32>,
}

impl State<'_> {
    /// Shows which episodes run.
    fn show(&self) {
        self.display.at_work(self.at_work.keys().map(|&index| self.episodes[index].stem.as_str()));
    }
}

/// World of a group of episodes.
pub struct BatchWorld {
    /// As on the command line.
    pub argument: OsString,
    /// The hash of its file.
    pub hash: String,
    /// Title, unique among all worlds.
    pub title: String,
}

impl BatchWorld {
    /// The world that `argument` names on the command line.
    pub fn new(argument: OsString, world: &World) -> BatchWorld {
        let WorldLabel { sha256, title } = WorldLabel::of(world);
        BatchWorld { argument, hash: sha256, title }
    }
}

/// Start of all episodes.
pub struct BatchStart {
    /// As on the command line.
    pub argument: OsString,
    /// The hash of its file.
    pub hash: String,
    /// Title, unique among all starts.
    pub title: String,
}

impl BatchStart {
    /// The start that `argument` names on the command line.
    pub fn new(argument: OsString, start: &Start) -> BatchStart {
        let info = StartInfo::of(start);
        BatchStart { argument, title: info.title(), hash: info.sha256 }
    }
}

/// Policy server that all episodes connect to.
pub struct BatchPolicy {
    pub url: PolicyUrl,
    /// Hash of its metadata.
    pub sha256: String,
    /// Name and version in results.
    pub name: (String, String),
    /// Whether the robot goes on while it computes.
    pub asynchronous: bool,
}

/// Settings that all episodes of a batch share, and their results folder.
pub struct Batch<'a> {
    pub data: &'a Data,
    pub folder: &'a Path,
    pub track: &'static str,
    /// The name of the arm.
    pub arm: &'a str,
    /// The worlds. All episodes of a bench share one.
    pub worlds: Vec<BatchWorld>,
    pub start: BatchStart,
    pub limit: Duration,
    /// Number of parallel episodes.
    pub jobs: usize,
    pub agent: Option<AgentFile>,
    pub policy: Option<BatchPolicy>,
    pub agent_limit: f64,
    /// True if the programs run in sandboxes.
    pub sandbox: bool,
    /// Secret that is mixed into the seeds.
    pub secret: Option<Secret>,
    /// Name and version of the agent, if they are known before it starts.
    pub name: Option<(String, String)>,
    /// Logs that are played without sight, in place of an agent.
    pub tapes: Option<Tapes>,
    /// Options that replace parts of the baseline.
    pub parts: &'a parts::Arguments,
    /// Options of the task, if it may be another one than to build all.
    pub task: Option<&'a task::Arguments>,
    /// The engine that runs the episodes, if they do not run in processes of this one.
    pub backend: Option<Backend>,
    /// True if an external program runs: an agent, or a skill of the baseline.
    pub has_program: bool,
    /// Hash of the file of parameters, if it differs from the built-in one.
    pub parameters_hash: Option<String>,
    pub goals: Vec<BatchGoal>,
    /// Number of episodes of each goal.
    pub count: u32,
    /// Their seeds.
    pub seeds: RangeInclusive<u64>,
    pub software: Software,
}

impl Batch<'_> {
    /// The number of each episode of a goal, from 1 on, and its seed.
    pub fn repeats(&self) -> impl Iterator<Item = (u32, u64)> {
        (1..).zip(self.seeds.clone())
    }

    /// Runs the episodes that have no result in the folder yet. Returns the exit status, after printing a
    /// message, if it was stopped by a signal.
    ///
    /// # Errors
    /// If the folder belongs to another version or agent, is in use, or cannot be written to.
    pub fn run(&self, episodes: &mut [Episode]) -> Result<Option<u8>, Report> {
        let folder = self.folder;
        if folder.exists() && !folder.is_dir() {
            return Err(miette!(help = "name a folder with -o", "{} is not a folder", folder.display()));
        }
        if self.has_program {
            adopt_orphans();
        }
        self.refuse_foreign()?;
        let engine = self.backend.as_ref().map(Engine::start).transpose()?;
        std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
        let _lock = FolderLock::take(folder).map_err(|error| match error {
            LockError::Busy { who } => Report::from(BatchError::Busy {
                folder: folder.display().to_string(),
                who: who.unwrap_or_default(),
            }),
            LockError::Failed(error) => miette!("cannot write to {}: {error}", folder.display()),
        })?;
        defer_requests();
        for episode in episodes.iter_mut() {
            let path = folder.join(format!("{}.json", episode.stem));
            match self.read(&path, episode) {
                Some(result) => episode.outcome = Outcome::Finished(Box::new(result)),
                None if path.exists() => {
                    tell(&format!(
                        "{} is no result of this episode: it is run again and replaced",
                        path.display()
                    ));
                }
                None => {}
            }
        }
        let stopped = if self.work(engine, episodes)? { None } else { requested() };
        if stopped.is_some() {
            let finished = episodes.iter().filter(|it| matches!(it.outcome, Outcome::Finished(_))).count();
            tell(&format!(
                "stopped: {finished} of {} episodes are finished; run the same command to resume",
                episodes.len()
            ));
        }
        Ok(stopped)
    }

    /// Conditions that all results of the folder share.
    fn shared(&self) -> Shared<'_> {
        Shared {
            arm: self.arm,
            worlds: self.worlds.iter().map(|world| world.hash.as_str()).collect(),
            start: &self.start.hash,
            states: self.goals.iter().map(|goal| goal.state.as_deref()).collect(),
            secret: self.commitment(),
            software: &self.software,
            agent: Identity {
                name: self.name.as_ref().map(|(name, version)| (name.as_str(), version.as_str())),
                sha256: self.agent_hash(),
                asynchronous: self.policy.as_ref().is_some_and(|policy| policy.asynchronous),
            },
        }
    }

    /// Rejects a folder with results of another version, arm, world, secret or agent.
    fn refuse_foreign(&self) -> Result<(), Report> {
        let Ok(entries) = std::fs::read_dir(self.folder) else { return Ok(()) };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        let shared = self.shared();
        for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "json")) {
            let Ok(text) = std::fs::read_to_string(path) else { continue };
            shared.check(&text).map_err(|foreign| BatchError::foreign(path, foreign))?;
        }
        Ok(())
    }

    /// The result in a file, if it belongs to this episode.
    fn read(&self, path: &Path, episode: &Episode) -> Option<EpisodeResult> {
        let text = std::fs::read_to_string(path).ok()?;
        let goal = &self.goals[episode.goal];
        let wanted = Wanted {
            goal: &goal.name,
            task: self.task.and_then(|task| task.task().told()),
            state: goal.state.as_deref(),
            count: goal.count,
            track: self.track,
            world: &self.worlds[episode.world].hash,
            seed: episode.seed,
            fault: episode.fault.map(|it| it.kind.name()),
        };
        self.shared().find(&wanted, &text).ok().flatten()
    }

    /// Runs the open episodes. Returns false if it was stopped.
    fn work(&self, engine: Option<Engine>, episodes: &mut [Episode]) -> Result<bool, Report> {
        let open: Vec<usize> =
            (0..episodes.len()).filter(|&it| matches!(episodes[it].outcome, Outcome::Open)).collect();
        let running = self.folder.join(RUNNING);
        // A bench that was killed leaves its folder behind.
        if running.exists() {
            std::fs::remove_dir_all(&running).into_diagnostic()?;
        }
        if open.is_empty() {
            return Ok(true);
        }
        std::fs::create_dir_all(&running).map_err(MachineFault::of)?;
        if let Some(engine) = engine {
            let remote = Remote {
                running: &running,
                limit: self.limit,
                words: &|episode, place| self.words(episode, RESULT.as_ref(), place),
                keep: &|episode, status| self.keep(&running, episode, status),
            };
            let worked = remote.work(engine, episodes, &open);
            let _ = std::fs::remove_dir_all(&running);
            return worked;
        }
        // A killed episode leaves its temporary files in here.
        let temporary = tempfile::tempdir().map_err(MachineFault::of)?;
        let display = Display::new(open.len(), episodes.len() - open.len(), self.jobs);
        let state = Mutex::new(State { episodes, display, at_work: BTreeMap::new() });
        let halt = AtomicBool::new(false);
        let outcomes = pool::work(open.len(), self.jobs, |item| {
            let stopped = || requested().is_some() || halt.load(Ordering::Relaxed);
            let outcome = self.episode(open[item], &state, (&running, temporary.path()), &stopped);
            if outcome.is_err() {
                halt.store(true, Ordering::Relaxed);
            }
            if stopped() { ControlFlow::Break(outcome) } else { ControlFlow::Continue(outcome) }
        });
        let State { episodes, display, .. } = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        display.finish();
        let _ = std::fs::remove_dir_all(&running);
        outcomes.into_iter().flatten().collect::<Result<(), Report>>()?;
        Ok(!episodes.iter().any(|episode| matches!(episode.outcome, Outcome::Open)))
    }

    /// Runs one episode in a process of its own until it ends or `stopped` says so.
    ///
    /// # Errors
    /// If the process cannot be started, or its result cannot be kept.
    fn episode(
        &self,
        index: usize,
        state: &Mutex<State>,
        (running, temporary): (&Path, &Path),
        stopped: &dyn Fn() -> bool,
    ) -> Result<(), Report> {
        let lock = || state.lock().unwrap_or_else(PoisonError::into_inner);
        if stopped() {
            return Ok(());
        }
        let mut worker = {
            // Hold the lock until the process id is stored, so that the process is not treated as an orphan.
            let mut state = lock();
            let stem = state.episodes[index].stem.clone();
            let child = self
                .start(running, temporary, &state.episodes[index])
                .map_err(|error| MachineFault { what: format!("{stem} is not started: {error}") })?;
            state.at_work.insert(index, child.id());
            state.show();
            Worker { child, since: Instant::now() }
        };
        loop {
            let mut state = lock();
            let looked = self.look_after(running, &mut worker, &state.episodes[index]);
            if let Ok(None) = looked
                && !stopped()
            {
                drop(state);
                std::thread::sleep(LOOK);
                continue;
            }
            state.at_work.remove(&index);
            if !matches!(looked, Ok(Some(_))) {
                let _ = worker.child.kill();
                let _ = worker.child.wait();
            }
            if let Some(outcome) = looked? {
                if self.has_program {
                    let pids = state.at_work.values().filter_map(|&id| i32::try_from(id).ok());
                    end_orphans(&pids.collect::<Vec<_>>());
                }
                state.episodes[index].outcome = outcome;
                state.display.ended(&state.episodes[index], worker.since.elapsed());
                state.show();
            }
            return Ok(());
        }
    }

    /// Starts an episode in its own process, which ends with this one. Its arguments are sealed: the seed is
    /// among them.
    fn start(&self, running: &Path, temporary: &Path, episode: &Episode) -> std::io::Result<Child> {
        let log = File::create_new(running.join(format!("{}.log", episode.stem)))?;
        let output = running.join(format!("{}.json", episode.stem));
        let words = self.words(episode, &output, &mut Path::to_path_buf);
        seal::child(&words, |command| {
            command.stdout(Stdio::null()).stderr(log).env("TMPDIR", temporary);
        })
    }

    /// The arguments of an episode with this file for its result; `place` gives the path of each file that
    /// they name.
    pub fn words(
        &self,
        episode: &Episode,
        output: &Path,
        place: &mut dyn FnMut(&Path) -> PathBuf,
    ) -> Vec<OsString> {
        let mut words = Vec::new();
        for pair in self.data.arguments().chunks(2) {
            words.extend([pair[0].clone(), place(pair[1].as_ref()).into()]);
        }
        words.extend(["run", "--track", self.track, "--arm", self.arm].map(OsString::from));
        for (option, argument) in
            [("--world", &self.worlds[episode.world].argument), ("--start", &self.start.argument)]
        {
            let its =
                if is_file(argument, ".toml") { place(argument.as_ref()).into() } else { argument.clone() };
            words.extend([option.into(), its]);
        }
        words.extend(["--seed".into(), episode.seed.to_string().into()]);
        words.extend(["--repeat".into(), episode.repeat.to_string().into()]);
        words.extend(self.task.iter().flat_map(|task| task.words(place)));
        words.extend(episode.fault.iter().flat_map(|fault| ["--fault".into(), fault.to_string().into()]));
        if let Some(secret) = &self.secret {
            let seed = secret.seed(&self.goals[episode.goal].name, self.track, episode.seed);
            words.extend(["--world-seed".into(), seed.to_string().into()]);
            words.extend(["--secret".into(), secret.commitment().into()]);
        }
        let goal = &self.goals[episode.goal];
        let tape = self.tapes.as_ref().and_then(|tapes| tapes.of(&goal.name, episode.seed));
        words.extend(tape.iter().flat_map(|path| ["--tape".into(), place(path).into()]));
        words.extend(self.agent_arguments(place));
        words.extend(["-o".into(), output.into()]);
        let argument =
            if goal.is_file { place(goal.argument.as_ref()) } else { goal.argument.clone().into() };
        words.extend(["--".into(), argument.into()]);
        words
    }

    /// The commitment to the secret.
    fn commitment(&self) -> Option<String> {
        self.secret.as_ref().map(Secret::commitment)
    }

    /// The hash of the agent's file, of the policy's metadata, or of the parameter file.
    fn agent_hash(&self) -> Option<&str> {
        let policy = self.policy.as_ref().map(|policy| policy.sha256.as_str());
        self.agent.as_ref().map(AgentFile::sha256).or(policy).or(self.parameters_hash.as_deref())
    }

    /// The agent's arguments for an episode. A slow agent is ended before the episode's own time limit, so
    /// that it is still scored.
    fn agent_arguments(&self, place: &mut dyn FnMut(&Path) -> PathBuf) -> Vec<OsString> {
        let sandbox = self.sandbox.then(|| "--sandbox".into());
        let limit = ["--agent-limit".to_string(), self.agent_limit.to_string()];
        let who: Vec<OsString> = match (&self.agent, &self.policy) {
            (Some(agent), _) => vec!["--agent".into(), place(agent.path()).into()],
            (None, Some(policy)) => {
                let pace = policy.asynchronous.then(|| "--async".into());
                ["--policy".into(), policy.url.to_string().into()].into_iter().chain(pace).collect()
            }
            (None, None) => {
                let limit = limit.map(OsString::from);
                return self.parts.words(place).into_iter().chain(limit).chain(sandbox).collect();
            }
        };
        let end_after = self.limit.saturating_sub(SCORING.min(self.limit / 2)).as_secs();
        let words = limit.into_iter().chain(["--end-after".to_string(), end_after.to_string()]);
        words.map(OsString::from).chain(who).chain(sandbox).collect()
    }

    /// Checks whether an episode has ended, and how, as [`Batch::keep`] says.
    fn look_after(
        &self,
        running: &Path,
        worker: &mut Worker,
        episode: &Episode,
    ) -> Result<Option<Outcome>, Report> {
        let status = match worker.child.try_wait().into_diagnostic()? {
            Some(status) => Some(status),
            None if worker.since.elapsed() < self.limit => return Ok(None),
            None => {
                let _ = worker.child.kill();
                let _ = worker.child.wait();
                None
            }
        };
        self.keep(running, episode, status).map(Some)
    }

    /// Moves the files of an ended episode to the results folder. `status` is `None` if it was stopped after
    /// its time.
    ///
    /// # Errors
    /// If the machine failed, or a finished result cannot be moved.
    pub fn keep(
        &self,
        running: &Path,
        episode: &Episode,
        status: Option<ExitStatus>,
    ) -> Result<Outcome, Report> {
        let stem = &episode.stem;
        let place = |ending: &str| {
            let name = format!("{stem}.{ending}");
            (running.join(&name), self.folder.join(name))
        };
        let (result_from, result_to) = place("json");
        let (curve_from, curve_to) = place("svg");
        let (record_from, record_to) = place(ENDING);
        let (log_from, log_to) = place("log");
        let result = self.read(&result_from, episode);
        if status.is_some_and(|status| status.code() == Some(MACHINE.into())) {
            return Err(MachineFault { what: format!("{stem} has failed: {}", last_words(&log_from)) }.into());
        }
        if let (Some(status), Some(result)) = (status, result)
            && status.code().is_some_and(|code| [DONE, INCOMPLETE].map(i32::from).contains(&code))
        {
            std::fs::rename(&curve_from, &curve_to).map_err(MachineFault::of)?;
            std::fs::rename(&record_from, &record_to).map_err(MachineFault::of)?;
            std::fs::rename(&result_from, &result_to).map_err(MachineFault::of)?;
            // Keep the output of an external agent.
            if self.has_program {
                let _ = std::fs::rename(&log_from, &log_to);
            } else {
                let _ = std::fs::remove_file(&log_from);
                let _ = std::fs::remove_file(&log_to);
            }
            return Ok(Outcome::Finished(Box::new(result)));
        }
        // A full disk ends a program in many ways. No episode is lost to it.
        check_room(running)
            .map_err(|error| MachineFault { what: format!("{stem} has no result: {error}") })?;
        let _ = std::fs::remove_file(&result_from);
        let _ = std::fs::remove_file(&curve_from);
        let _ = std::fs::remove_file(&record_from);
        let _ = std::fs::rename(&log_from, &log_to);
        let reason = match status {
            Some(status) => end_of(status),
            None => format!("not done after {} s on the wall", self.limit.as_secs()),
        };
        Ok(Outcome::Lost(format!("{reason}; its last words are in {stem}.log")))
    }
}

/// Checks that a folder has room for a file of [`ROOM`] bytes.
fn check_room(folder: &Path) -> std::io::Result<()> {
    let mut file = tempfile::tempfile_in(folder)?;
    file.write_all(&vec![1; ROOM])?;
    file.sync_all()
}

/// The last part of a process's output.
fn last_words(log: &Path) -> String {
    let text = std::fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text[text.len().saturating_sub(LAST_WORDS)..]).into_owned();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
