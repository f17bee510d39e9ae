//! `ramp trials`: success rates of single contact skills of the baseline from randomised starts.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressStyle};
use miette::{Diagnostic, IntoDiagnostic, Report, miette};
use ramp_abilities::manipulation::{Aim, run_trial};
use ramp_assembly::Task;
use ramp_data::{Data, Texts};
use ramp_external_agent::{AgentFile, adopt_orphans};
use ramp_gym::own::kinds;
use ramp_gym::tasks::{self, PlannedGoal, Step};
use ramp_kit::source::{nearest, read_text, shorten};
use ramp_policy_client::PolicyUrl;
use ramp_result::collection::LARGEST;
use ramp_result::episode::{Software, StartInfo, WorldLabel};
use ramp_result::manipulation::sums::{SkillSum, sums};
use ramp_result::manipulation::{SCHEMA, Trial};
use ramp_result::write_whole;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_skills::Piece;
use ramp_skills::skill::ActionKind;
use ramp_twin::Setup;
use ramp_world::{Start, World};

use crate::columns::{Table, terminal_width};
use crate::command::agent;
use crate::command::own_skill::{self, SkillHost, Source};
use crate::command::parts::{self, Parts, Sandboxes};
use crate::command::program::find_policy;
use crate::options::{StartOption, TrackName, WorldOption};
use crate::output::{print, tell};
use crate::pool;
use crate::software::software;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Skills to run [default: all that the nine goals need]
    #[arg(value_name = "SKILL")]
    skills: Vec<String>,
    /// Trials of each skill, with seeds in a row
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    trials: u32,
    /// Seed of the first trial of each skill
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    first_seed: u64,
    /// Knowledge that the agent has of the parts' poses
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    /// Number of parallel trials
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    jobs: u32,
    #[command(flatten)]
    parts: parts::Arguments,
    /// Let this program carry out the whole trial
    #[arg(long, value_name = "FILE")]
    agent: Option<PathBuf>,
    /// Let the policy behind this server carry out the action that the skill is named after, inside the
    /// baseline
    #[arg(long, value_name = "ws://HOST:PORT", conflicts_with_all = ["agent", "skill"])]
    policy: Option<PolicyUrl>,
    /// Time limit for each message of the program, or answer of the policy
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = agent::seconds)]
    agent_limit: f64,
    /// Folder for the results; results that it already has are not run again
    #[arg(short, long, value_name = "DIR", default_value = "results/trials")]
    output: PathBuf,
}

/// Errors before any trial starts.
#[derive(Debug, thiserror::Error, Diagnostic)]
enum TrialsError {
    #[error("no goal has a step of the skill `{name}`")]
    Unknown {
        name: String,
        #[help]
        help: String,
    },
    #[error("the seeds go past the largest number there is")]
    #[diagnostic(help("take a smaller --first-seed or fewer --trials"))]
    Seeds,
    #[error("{file} was made by {theirs}, and this is {ours}")]
    #[diagnostic(help(
        "results of different versions are not added up: name another folder with -o, or move these away"
    ))]
    OtherVersion { file: String, theirs: String, ours: String },
    #[error("{file} is of another start")]
    #[diagnostic(help("a folder is of one start: name another folder with -o, or give the same --start"))]
    OtherStart { file: String },
    #[error("{file} is of another world")]
    #[diagnostic(help("a folder is of one world: name another folder with -o, or give the same --world"))]
    OtherWorld { file: String },
    #[error("{file} is a trial of {theirs}, and this is one of {ours}")]
    #[diagnostic(help("a folder is of one agent: name another one with -o"))]
    OtherAgent { file: String, theirs: String, ours: String },
    #[error("no goal has one of these plans")]
    #[diagnostic(help("name each file of plans after its goal, such as easy-1.json"))]
    NoPlan,
}

/// Settings that all trials share.
struct Trials<'a> {
    arm: ArmModel,
    goals: Vec<PlannedGoal>,
    /// The files of each goal.
    texts: Vec<Texts>,
    /// The steps of each skill, as pairs of goal index and step index.
    steps: BTreeMap<String, Vec<(usize, usize)>>,
    track: Track,
    world: World,
    start: Start,
    software: Software,
    /// Parts of the baseline.
    parts: Parts,
    /// The program for the whole trial.
    agent: Option<AgentFile>,
    agent_limit: f64,
    folder: &'a Path,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    if arguments.first_seed.checked_add(u64::from(arguments.trials) - 1).is_none() {
        return Err(TrialsError::Seeds.into());
    }
    let folder = &arguments.output;
    if folder.exists() && !folder.is_dir() {
        return Err(miette!(help = "name a folder with -o", "{} is not a folder", folder.display()));
    }
    let mut parts = arguments.parts.read(data, arguments.track.into())?;
    let (mut goals, mut texts) = (Vec::new(), Vec::new());
    for name in data.goal_names()? {
        let (goal, files) = data.goal_with_texts(&name)?;
        goals.push(match &parts.plans {
            None => PlannedGoal::new(goal, &parts.domains).into_diagnostic()?,
            Some(plans) if plans.names(&name) => {
                let Some(plan) = parts.plan(&goal)? else { continue };
                PlannedGoal::with_plan(goal, &plan, &parts.domains).into_diagnostic()?
            }
            Some(_) => continue,
        });
        texts.push(files);
    }
    if goals.is_empty() {
        return Err(TrialsError::NoPlan.into());
    }
    let mut steps: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
    for (index, goal) in goals.iter().enumerate() {
        for (step, Step { task, .. }) in goal.steps.iter().enumerate() {
            steps.entry(task.skill.clone()).or_default().push((index, step));
        }
    }
    let skills = chosen(&arguments.skills, &steps)?;
    if let Some(url) = &arguments.policy {
        let server = find_policy(url, arguments.agent_limit)?;
        parts.replace(kinds_of(&skills)?, &Source::Server(Arc::new(server)));
    }
    let trials = Trials {
        arm: data.arm()?,
        goals,
        texts,
        steps,
        track: arguments.track.into(),
        world: arguments.world.read(data)?,
        start: arguments.start.read(data)?,
        software: software(),
        parts,
        agent: arguments.agent.as_deref().map(own_skill::file).transpose()?,
        agent_limit: arguments.agent_limit,
        folder,
    };
    if trials.agent.is_some() {
        adopt_orphans();
    }
    let last = arguments.first_seed + u64::from(arguments.trials) - 1;
    let seeds = || arguments.first_seed..=last;
    // Alternate between skills, so that an interrupted command has trials of each.
    let wanted: Vec<(&str, u64)> =
        seeds().flat_map(|seed| skills.iter().map(move |skill| (skill.as_str(), seed))).collect();
    let before: Vec<Option<Trial>> =
        wanted.iter().map(|(skill, seed)| trials.read(skill, *seed)).collect::<Result<_, Report>>()?;
    std::fs::create_dir_all(folder)
        .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
    let done = trials.work(&wanted, before, arguments.jobs as usize)?;
    let world = WorldLabel::of(&trials.world).title;
    let (track, first) = (trials.track.name(), arguments.first_seed);
    let start = StartInfo::of(&trials.start).title();
    let mut text = format!("world {world}, start {start}, track {track}, seeds {first} to {last}\n");
    table(&mut text, &sums(&done));
    let _ = writeln!(text, "results: {}", folder.display());
    print(&text)?;
    Ok(DONE)
}

/// The requested skills, without duplicates.
fn chosen(words: &[String], steps: &BTreeMap<String, Vec<(usize, usize)>>) -> Result<Vec<String>, Report> {
    if words.is_empty() {
        return Ok(steps.keys().cloned().collect());
    }
    let mut skills: Vec<String> = Vec::new();
    for word in words {
        if !steps.contains_key(word) {
            let known = || steps.keys().map(String::as_str);
            let help = match nearest(word, known()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the skills are {}", known().collect::<Vec<_>>().join(", ")),
            };
            return Err(TrialsError::Unknown { name: shorten(word), help }.into());
        }
        if !skills.contains(word) {
            skills.push(word.clone());
        }
    }
    Ok(skills)
}

/// The actions that skills are named after.
fn kinds_of(skills: &[String]) -> Result<Vec<ActionKind>, Report> {
    let kind_of = |skill: &String| {
        let mut known: Vec<ActionKind> = kinds().collect();
        // The longest name that fits: one may be the beginning of another.
        known.sort_by_key(|kind| std::cmp::Reverse(kind.name().len()));
        let kind = known.into_iter().find(|kind| skill.starts_with(&kind.name().replace('_', "-")));
        kind.ok_or_else(|| {
            let known: Vec<String> = kinds().map(|kind| kind.name().replace('_', "-")).collect();
            let help = format!("a policy can carry out {}: name such a skill", known.join(", "));
            miette!(help = help, "no policy can carry out the skill `{skill}`")
        })
    };
    skills.iter().map(kind_of).collect()
}

impl Arguments {
    /// Returns true if an external program runs.
    pub fn has_agent(&self) -> bool {
        self.parts.has_program() || self.agent.is_some()
    }
}

impl Trials<'_> {
    fn path(&self, skill: &str, seed: u64) -> PathBuf {
        self.folder.join(format!("{}.json", Trial::stem(skill, self.track.name(), seed)))
    }

    /// The existing result; `None` if the file is missing or is not a trial.
    fn read(&self, skill: &str, seed: u64) -> Result<Option<Trial>, Report> {
        let path = self.path(skill, seed);
        let Ok(text) = read_text(&path, LARGEST) else { return Ok(None) };
        let trial = Trial::from_json(text.as_bytes()).ok();
        let fits = |trial: &Trial| {
            let own = (trial.skill.as_str(), trial.seed, trial.track.as_str());
            trial.schema == SCHEMA && own == (skill, seed, self.track.name()) && trial.check().is_ok()
        };
        let Some(trial) = trial.filter(fits) else {
            tell(&format!("{} is no result of this trial: it is run again and replaced", path.display()));
            return Ok(None);
        };
        if trial.software != self.software {
            let say = |it: &Software| format!("ramp {} ({})", it.version, it.commit);
            return Err(TrialsError::OtherVersion {
                file: path.display().to_string(),
                theirs: say(&trial.software),
                ours: say(&self.software),
            }
            .into());
        }
        if trial.world.sha256 != WorldLabel::of(&self.world).sha256 {
            return Err(TrialsError::OtherWorld { file: path.display().to_string() }.into());
        }
        if trial.start.sha256 != StartInfo::of(&self.start).sha256 {
            return Err(TrialsError::OtherStart { file: path.display().to_string() }.into());
        }
        let (name, version) = self.parts.name();
        let (same, ours) = match &self.agent {
            Some(file) => {
                (trial.agent.sha256.as_deref() == Some(file.sha256()), file.path().display().to_string())
            }
            None => {
                let own = (&name, &version, &self.parts.parameters.sha256);
                (own == (&trial.agent.name, &trial.agent.version, &trial.agent.sha256), name.clone())
            }
        };
        if !same {
            let (file, theirs) = (path.display().to_string(), trial.agent.name.clone());
            return Err(TrialsError::OtherAgent { file, theirs, ours }.into());
        }
        Ok(Some(trial))
    }

    /// Runs the missing trials, and writes each as soon as it ends.
    fn work(
        &self,
        wanted: &[(&str, u64)],
        before: Vec<Option<Trial>>,
        jobs: usize,
    ) -> Result<Vec<Trial>, Report> {
        let open: Vec<usize> = (0..wanted.len()).filter(|index| before[*index].is_none()).collect();
        let display = Display::new(open.len(), wanted.len());
        let outcomes = pool::work(open.len(), jobs, |item| {
            let (skill, seed) = wanted[open[item]];
            match self.trial(skill, seed) {
                Ok(trial) => {
                    display.ended(&trial);
                    ControlFlow::Continue(Ok(trial))
                }
                Err(error) => ControlFlow::Break(Err(error)),
            }
        });
        display.finish();
        let mut trials = before;
        for (index, outcome) in open.into_iter().zip(outcomes) {
            trials[index] = outcome.transpose()?;
        }
        Ok(trials.into_iter().flatten().collect())
    }

    /// Runs one trial and writes its file.
    fn trial(&self, skill: &str, seed: u64) -> Result<Trial, Report> {
        let none = || miette!("no goal has a step of the skill `{skill}`");
        let steps = self.steps.get(skill).ok_or_else(none)?;
        let (goal, step) = tasks::draw(steps, seed).ok_or_else(none)?;
        let (goal, texts) = (&self.goals[goal], &self.texts[goal]);
        let step = &goal.steps[step];
        let setup = Setup {
            assembly: &goal.assembly,
            arm: &self.arm,
            track: self.track,
            seed,
            start: &self.start,
            world: &self.world,
            state: None,
            task: Task::Build,
            fault: None,
        };
        if let Some(file) = &self.agent {
            let told = serde_json::json!({
                "skill": step.task.skill,
                "step": step.task.step,
                "action": step.task.action,
                "state": step.state,
                "plan": step.plan.steps,
            });
            let cell = SkillHost::new(&setup, texts, self.agent_limit);
            let mut agent = cell.start(file, told)?;
            let trial = run_trial(&setup, &step.task, &mut agent, &self.software).into_diagnostic()?;
            write_whole(&self.path(skill, seed), trial.to_json()).into_diagnostic()?;
            return Ok(trial);
        }
        let given = self.parts.plans.as_ref().map(|_| step.plan.clone());
        let baseline = self.parts.agent(&setup, texts, self.agent_limit, given, Sandboxes::default())?;
        let next = match &step.task.aim {
            Aim::Placed { connections } => connections.clone(),
            _ => Vec::new(),
        };
        let mut agent = Piece::new(baseline, step.state.clone(), step.plan.clone(), next);
        let trial = run_trial(&setup, &step.task, &mut agent, &self.software).into_diagnostic()?;
        write_whole(&self.path(skill, seed), trial.to_json()).into_diagnostic()?;
        Ok(trial)
    }
}

/// The table of all skills, with the reasons for failures.
fn table(text: &mut String, sums: &[SkillSum]) {
    let mut table = Table::new(
        1,
        [
            "skill",
            "trials",
            "done",
            "share",
            "95 % interval",
            "retried",
            "time, median / 95 %",
            "largest force",
        ],
    );
    for sum in sums {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        table.add([
            sum.skill.clone(),
            sum.trials.to_string(),
            sum.successes.to_string(),
            percent(sum.successes as f64 / sum.trials as f64),
            format!("{} – {}", percent(sum.interval.low), percent(sum.interval.high)),
            sum.retried.to_string(),
            format!("{:.1} s / {:.1} s", sum.time[0], sum.time[1]),
            format!("{:.0} N", sum.largest_force),
        ]);
    }
    text.push_str(&table.text(terminal_width()));
    for sum in sums {
        for (cause, count, seed) in &sum.failures {
            let _ = writeln!(text, "  {}: {count} × {cause} (first with seed {seed})", sum.skill);
        }
    }
}

/// Progress on standard error: a bar on a terminal, a line for each trial elsewhere.
struct Display {
    bar: Option<ProgressBar>,
    count: usize,
    ended: AtomicUsize,
}

impl Display {
    fn new(count: usize, all: usize) -> Display {
        if count < all {
            tell(&format!("{} of {all} trials are finished already", all - count));
        }
        let bar = (std::io::stderr().is_terminal() && count > 0).then(|| {
            let bar = ProgressBar::new(count as u64);
            if let Ok(style) =
                ProgressStyle::with_template("{bar:24} {pos}/{len} trials  {elapsed}, {eta} left")
            {
                bar.set_style(style);
            }
            bar
        });
        Display { bar, count, ended: AtomicUsize::new(0) }
    }

    fn ended(&self, trial: &Trial) {
        let number = self.ended.fetch_add(1, Ordering::Relaxed) + 1;
        let what = match (&trial.missing, &trial.cause) {
            (Some(missing), cause) => format!("not done: {}", cause.as_ref().unwrap_or(missing)),
            (None, Some(cause)) => format!("done, but given up: {cause}"),
            (None, None) => format!("done in {:.1} s", trial.time),
        };
        let line = format!("{} {}, {}: {what}", trial.skill, trial.seed, trial.goal);
        match &self.bar {
            Some(bar) => {
                bar.inc(1);
                if !trial.success {
                    bar.println(line);
                }
            }
            None => tell(&format!("{number}/{}  {line}", self.count)),
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
