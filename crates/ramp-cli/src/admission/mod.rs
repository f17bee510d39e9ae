//! Admission of entries to a board: the only way from an untrusted entry to a row. The board and
//! `ramp entry check` share it.

mod archive;
mod entry;
mod judge;
mod limits;
mod rerun;
mod verdicts;

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::time::Duration;

use miette::{Report as Failure, miette};
use ramp_data::{ARMS, Data};
use ramp_report::leaderboard::{BoardArm, BoardGoal, BoardTerms, Streams, agent, one_agent};
use ramp_result::collection::{Collection, collect};
use ramp_result::episode::RobotTime;
use ramp_result::secret::Secret;
use ramp_skills::{ReferenceTimes, reference_times_of_goal};
use ramp_world::Start;

use self::archive::ArchiveError;
use self::entry::Known;
use self::judge::{Allowance, LogFile};
use crate::command::seeds;
use crate::engine::Backend;
use crate::rules::domains;
use crate::status::MachineFault;

pub use self::archive::pack;
pub use self::entry::{Entry, entries, name};
pub use self::judge::{Arguments as JudgeArguments, judge};
pub use self::rerun::AGENT_NAMES;
pub use self::verdicts::Verdicts;

/// Options of everything that admits entries.
#[derive(clap::Args)]
pub struct Options {
    /// Secret that was mixed into the seeds of all entries, from `ramp seeds commit`
    #[arg(long, value_name = "FILE")]
    pub secret: Option<PathBuf>,
    /// Run the agents again for their planning and compute times, in a sandbox: each entry's `agent.py` or
    /// `agent`, or the baseline
    #[arg(long)]
    rerun_agents: bool,
    /// Wall-clock limit of the replay of a log; a log that needs longer is refused
    #[arg(long, value_name = "SECONDS", default_value_t = Allowance::default().replay.as_secs_f64(), value_parser = seconds)]
    replay_limit: f64,
    /// Repeat the logs on a cluster of Ray, one on each processor. It needs the Python package with the
    /// extra `ray`, on all nodes. Without an address, it is the cluster that runs here, or a new one
    #[arg(long, value_name = "ray[:ADDRESS]")]
    backend: Option<Backend>,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.001..=1e6).contains(&seconds) => Ok(seconds),
        _ => Err("expected a number of seconds from 0.001 to 1000000".to_string()),
    }
}

/// Terms of admission, and what earlier entries have shown.
pub struct Admission<'a> {
    data: &'a Data,
    terms: BoardTerms,
    options: &'a Options,
    allowance: Allowance,
    known: Known,
    streams: Streams,
    verdicts: Verdicts,
    /// Bound and reference of each goal with each arm, once computed.
    robot_times: HashMap<(String, Option<String>), Option<RobotTime>>,
}

/// A note for the reader of a board.
pub struct Warning {
    /// The only track that it concerns.
    pub track: Option<String>,
    /// The note.
    pub text: String,
}

/// An entry that a board lists.
pub struct Admitted {
    /// Its agent's name and version.
    pub agent: String,
    /// Its results, with the bound and reference of this program.
    pub collection: Collection,
    /// The same with the times of this machine, if its agents were run again.
    pub timed: Collection,
    /// For each of its entrants: whether `timed` has the times of this machine.
    pub timed_here: Vec<bool>,
    /// Notes for the reader.
    pub warnings: Vec<Warning>,
    /// Its logs.
    pub logs: Vec<LogFile>,
}

impl<'a> Admission<'a> {
    /// Reads the terms.
    ///
    /// # Errors
    /// If the goals or the secret cannot be read, or what the backend needs is not there.
    pub fn new(data: &'a Data, options: &'a Options, verdicts: Verdicts) -> Result<Admission<'a>, Failure> {
        let secret = options.secret.as_deref().map(seeds::read).transpose()?;
        options.backend.as_ref().map(Backend::check).transpose()?;
        let replay = Duration::from_secs_f64(options.replay_limit);
        Ok(Admission {
            data,
            terms: terms(data, secret)?,
            options,
            allowance: Allowance { replay, ..Allowance::default() },
            known: Known::default(),
            streams: Streams::default(),
            verdicts,
            robot_times: HashMap::new(),
        })
    }

    /// The terms.
    pub fn terms(&self) -> &BoardTerms {
        &self.terms
    }

    /// The verdicts so far.
    pub fn verdicts(&self) -> &Verdicts {
        &self.verdicts
    }

    /// Opens the entry in a folder or an archive; or returns the reason for rejecting it.
    ///
    /// # Errors
    /// If an archive cannot be unpacked on this machine.
    pub fn open(path: &Path) -> Result<Result<Entry, String>, Failure> {
        match Entry::open(path) {
            Ok(entry) => Ok(Ok(entry)),
            Err(error @ ArchiveError::Unpack(_)) => Err(MachineFault::of(error).into()),
            Err(error) => Ok(Err(error.to_string())),
        }
    }

    /// Admits an entry, or returns the reason for rejecting it. All checks are made here.
    ///
    /// # Errors
    /// If this machine fails.
    pub fn admit(&mut self, entry: &Entry) -> Result<Result<Admitted, String>, Failure> {
        self.admit_timed(entry, self.options.rerun_agents)
    }

    fn admit_timed(
        &mut self,
        entry: &Entry,
        rerun_agents: bool,
    ) -> Result<Result<Admitted, String>, Failure> {
        let mut checked = match entry.read(&self.terms, &self.known, &self.verdicts, &self.allowance) {
            Ok(checked) => checked,
            Err(why) => return Ok(Err(entry.reason(&why))),
        };
        if let Err(reason) =
            self.verdicts.replay(&checked.logs, &self.allowance, self.options.backend.as_ref())?
        {
            return Ok(Err(entry.reason(&miette!("{reason}"))));
        }
        self.known.add(&entry.name, &checked.collection);
        let mut warnings = Vec::new();
        for copy in self.streams.add(&entry.name, &checked.agent, &checked.streams) {
            let all = checked.streams.len();
            let text = format!(
                "{} of its {all} episodes make the same calls, to the last bit, as entry {} ({})",
                copy.episodes, copy.entry, copy.agent
            );
            warnings.push(Warning { track: None, text });
        }
        self.set_robot_times(&mut checked.collection)?;
        let mut timed = checked.collection.clone();
        let mut timed_here = vec![false; timed.entrants.len()];
        if rerun_agents {
            for (entrant, timed_here) in timed.entrants.iter_mut().zip(&mut timed_here) {
                if entrant.identity.real.is_some() {
                    continue;
                }
                let secret = self.options.secret.as_deref();
                let timing = rerun::time(self.data, entry, entrant, &checked.streams, secret)?;
                *timed_here = timing.timed;
                let track = entrant.identity.track.clone();
                warnings.extend(timing.warning.map(|text| Warning { track: Some(track), text }));
            }
        }
        Ok(Ok(Admitted {
            agent: checked.agent,
            collection: checked.collection,
            timed,
            timed_here,
            warnings,
            logs: checked.logs,
        }))
    }

    /// Admits the organiser's own results. Their times are of this machine, and entries are not compared with
    /// them.
    ///
    /// # Errors
    /// If this machine fails.
    pub fn admit_control(&mut self, entry: &Entry) -> Result<Result<Admitted, String>, Failure> {
        let (known, streams) = (std::mem::take(&mut self.known), std::mem::take(&mut self.streams));
        let mut outcome = self.admit_timed(entry, false);
        (self.known, self.streams) = (known, streams);
        if let Ok(Ok(admitted)) = &mut outcome {
            admitted.timed_here.fill(true);
        }
        outcome
    }

    /// Lists the organiser's own blind tape. It sees nothing, so its results are not checked as those of an
    /// entry.
    ///
    /// # Errors
    /// If this machine fails.
    pub fn admit_floor(&mut self, folder: &Path) -> Result<Result<Admitted, String>, Failure> {
        let mut collection = match collect(&[folder.to_path_buf()]) {
            Ok(collection) => collection,
            Err(why) => return Ok(Err(why.to_string())),
        };
        let agent = match one_agent(&collection) {
            Ok(identity) => agent(identity),
            Err(why) => return Ok(Err(why.to_string())),
        };
        self.set_robot_times(&mut collection)?;
        Ok(Ok(Admitted {
            agent,
            timed_here: vec![true; collection.entrants.len()],
            timed: collection.clone(),
            collection,
            warnings: Vec::new(),
            logs: Vec::new(),
        }))
    }

    /// Pegs that the calls of one log of each goal keep when they are played without sight on two other
    /// seeds, and all that they could; for each track.
    ///
    /// # Errors
    /// The reason for a log that cannot be played.
    pub fn kept_elsewhere(&self, admitted: &Admitted) -> Result<BTreeMap<String, [usize; 2]>, String> {
        let mut kept: BTreeMap<String, [usize; 2]> = BTreeMap::new();
        for entrant in &admitted.collection.entrants {
            let mut last = None;
            for file in entrant.files.iter().filter(|file| file.result.counted() > 0) {
                let goal = Some(&file.result.goal);
                let log = admitted.logs.iter().find(|log| Some(&log.sha256) == file.result.log.as_ref());
                let Some(log) = log.filter(|_| goal != last) else { continue };
                last = goal;
                let [own, all] = judge::elsewhere(log, &self.allowance)?;
                let sum = kept.entry(entrant.identity.track.clone()).or_default();
                *sum = [sum[0] + own, sum[1] + all];
            }
        }
        Ok(kept)
    }

    /// Replaces bound and reference in results by those that this program computes: a log does not prove
    /// them.
    fn set_robot_times(&mut self, collection: &mut Collection) -> Result<(), Failure> {
        let files = collection.entrants.iter_mut().flat_map(|entrant| &mut entrant.files);
        for file in files {
            let own = (file.result.goal.clone(), file.result.arm.clone());
            if !self.robot_times.contains_key(&own) {
                let (assembly, _) = self.data.goal_with_texts(&own.0)?;
                let arm = self.data.with_arm(own.1.as_deref().unwrap_or(ARMS[0]))?.arm()?;
                let times = reference_times_of_goal(&assembly, &arm, &domains(self.data, None)?).ok();
                let times = times.map(|ReferenceTimes { bound, reference }| RobotTime { bound, reference });
                self.robot_times.insert(own.clone(), times);
            }
            file.result.robot_time = self.robot_times.get(&own).copied().flatten();
        }
        Ok(())
    }
}

fn terms(data: &Data, secret: Option<Secret>) -> Result<BoardTerms, Failure> {
    let mut goals = Vec::new();
    let mut kit = None;
    let mut names = data.goal_names()?;
    for set in data.open_sets()? {
        names.extend(data.open_goal_names(set)?);
    }
    for name in names {
        let (goal, texts) = data.goal_with_texts(&name)?;
        let sources = texts.sources();
        kit = Some(sources.kit.to_string());
        let class = goal.class.map(|class| class.name());
        let pegs = goal.connections.len();
        goals.push(BoardGoal { name: goal.name, class, pegs, xml: sources.goal.to_string() });
    }
    let Some(kit) = kit else {
        return Err(miette!("there is no goal in {}", data.goals()));
    };
    let starts = Start::names().filter_map(Start::shipped).map(|start| start.text.clone()).collect();
    // A folder that lacks an arm has no boards of it.
    let arm = |name: &str| {
        let json = data.with_arm(name).ok()?.arm_text().ok()?;
        Some(BoardArm { name: name.to_string(), json })
    };
    let arms = ARMS.into_iter().filter_map(arm).collect();
    Ok(BoardTerms { goals, kit, arms, starts, secret })
}
