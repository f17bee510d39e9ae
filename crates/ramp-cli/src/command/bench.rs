//! `ramp bench`: runs goals and classes by the protocol, and summarises the results.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::{Class, Size, Task};
use ramp_data::Data;
use ramp_episode::tape;
use ramp_result::secret::Secret;
use ramp_result::summary::{Entry, Summary, shortfall};
use serde_json::{Value, json};

use super::episodes::{self, Batch, Episode, Outcome, Tapes};
use super::seeds;
use super::task;
use crate::columns::{Table, terminal_width};
use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Goals, classes (easy, medium, hard, open-2026), `all` for the nine goals, or folders of goal files
    /// with a `/` at their end
    #[arg(required = true, value_name = "CLASS|GOAL")]
    goals: Vec<String>,
    #[command(flatten)]
    shared: episodes::Arguments,
    #[command(flatten)]
    task: task::Arguments,
    /// Episodes of each goal, with seeds in a row
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repeats: u32,
    /// Secret that is mixed into the seeds, from `ramp seeds commit`
    #[arg(long, value_name = "FILE")]
    secret: Option<PathBuf>,
    /// Play the commands of the logs in this folder without sight, each on other seeds than its own: the
    /// floor of a board
    #[arg(long, value_name = "DIR", conflicts_with_all = ["agent", "policy", "path", "skill", "plan", "planner", "finder", "domain", "state", "task"])]
    tape: Option<PathBuf>,
    /// Folder for the results; results that it already has are not run again
    #[arg(short, long, value_name = "DIR", default_value = "results/bench")]
    output: PathBuf,
}

/// The episodes of a bench.
struct Bench<'a>(Batch<'a>);

/// The summary of a class, or of one size of a set of the open class.
struct Part {
    class: Class,
    size: Option<Size>,
    /// Its goals in this bench.
    goals: usize,
    sum: Summary,
}

/// An incomplete episode.
struct Incomplete<'e> {
    episode: &'e Episode,
    counted: usize,
    /// Whether it has a result.
    finished: bool,
    /// Whether it failed for a technical reason, and not because of the agent.
    technical: bool,
    reason: String,
}

impl Arguments {
    /// Returns true if an external agent program runs.
    pub fn has_agent(&self) -> bool {
        self.shared.has_agent()
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let shared = &arguments.shared;
    if arguments.secret.is_some() && shared.backend.is_some() {
        return Err(miette!(
            help = "leave one of them out",
            "a bench with a secret stays on this machine: on a cluster, an agent could ask the engine for its seeds"
        ));
    }
    let goals = episodes::find(data, &arguments.goals)?;
    let secret = arguments.secret.as_deref();
    let mut batch = shared.batch(data, &arguments.output, goals, arguments.repeats, "--repeats", secret)?;
    shared.set_task(&mut batch, &arguments.task)?;
    if let Some(folder) = &arguments.tape {
        batch.tapes = Some(Tapes::find(folder, &batch.goals, &batch.seeds)?);
        batch.name = Some((tape::NAME.to_string(), tape::VERSION.to_string()));
    }
    batch.secret = secret.map(seeds::read).transpose()?;
    let bench = Bench(batch);
    let mut episodes = bench.episodes();
    if let Some(status) = bench.0.run(&mut episodes)? {
        return Ok(status);
    }
    print(&if shared.json { bench.sums_json(&episodes)? } else { bench.sums_text(&episodes) })?;
    let lost = episodes.iter().any(|episode| matches!(episode.outcome, Outcome::Lost(_)));
    Ok(if lost { INCOMPLETE } else { DONE })
}

impl Bench<'_> {
    /// The task of all episodes.
    fn task(&self) -> Task {
        self.0.task.map_or(Task::Build, task::Arguments::task)
    }

    /// All requested episodes.
    fn episodes(&self) -> Vec<Episode> {
        let mut episodes = Vec::new();
        for (goal, it) in self.0.goals.iter().enumerate() {
            for (repeat, seed) in self.0.repeats() {
                let stem = format!("{}-{}-{seed}", it.name, self.0.track);
                episodes.push(Episode {
                    goal,
                    world: 0,
                    seed,
                    repeat,
                    fault: None,
                    stem,
                    outcome: Outcome::Open,
                });
            }
        }
        episodes
    }

    /// The summary of each goal, and of each class that has goals in this bench; before a set of the open
    /// class, those of its sizes.
    fn sums(&self, episodes: &[Episode]) -> (Vec<Summary>, Vec<Part>) {
        let entries: Vec<(usize, Entry)> = episodes
            .iter()
            .map(|episode| {
                let (pegs, result) = (self.0.goals[episode.goal].count, episode.result().cloned());
                (episode.goal, Entry { pegs, result })
            })
            .collect();
        let of = |wanted: &dyn Fn(usize) -> bool| {
            Summary::of(entries.iter().filter(|(goal, _)| wanted(*goal)).map(|(_, entry)| entry))
        };
        let goals = (0..self.0.goals.len()).map(|goal| of(&|it| it == goal)).collect();
        let part = |class: Class, size: Option<Size>| {
            let holds = |goal: usize| {
                let goal = &self.0.goals[goal];
                goal.class == Some(class) && (size.is_none() || Size::of_goal_name(&goal.name) == size)
            };
            let goals = (0..self.0.goals.len()).filter(|&goal| holds(goal)).count();
            (goals > 0).then(|| Part { class, size, goals, sum: of(&holds) })
        };
        let classes: BTreeSet<Class> = self.0.goals.iter().filter_map(|goal| goal.class).collect();
        let parts = classes.into_iter().flat_map(|class| {
            let sizes = Size::ALL.into_iter().filter(move |_| class.is_open()).map(Some);
            sizes.chain([None]).filter_map(move |size| part(class, size))
        });
        (goals, parts.collect())
    }

    /// The incomplete episodes.
    fn failures<'e>(&'e self, episodes: &'e [Episode]) -> impl Iterator<Item = Incomplete<'e>> {
        episodes.iter().filter_map(|episode| {
            let lost = |reason: &str| {
                let reason = reason.to_string();
                Some(Incomplete { episode, counted: 0, finished: false, technical: true, reason })
            };
            match &episode.outcome {
                Outcome::Finished(result) => {
                    let (counted, technical) = (result.counted(), result.is_technical());
                    shortfall(result).map(|reason| Incomplete {
                        episode,
                        counted,
                        finished: true,
                        technical,
                        reason,
                    })
                }
                Outcome::Lost(reason) => lost(reason),
                Outcome::Open => lost("not run"),
            }
        })
    }

    /// Number of episodes during which the machine was loaded.
    fn loaded(&self, episodes: &[Episode]) -> usize {
        episodes.iter().filter_map(Episode::result).filter(|result| result.time.is_loaded()).count()
    }

    fn sums_json(&self, episodes: &[Episode]) -> Result<String, Report> {
        let (goals, classes) = self.sums(episodes);
        let goals: Vec<Value> = self
            .0
            .goals
            .iter()
            .zip(&goals)
            .map(|(goal, sum)| json!({"goal": goal.name, "class": goal.class.map(Class::name), "sum": sum}))
            .collect();
        let classes: Vec<Value> = classes
            .iter()
            .map(|it| {
                let mut part = json!({"class": it.class.name(), "goals": it.goals, "sum": it.sum});
                if let Some(size) = it.size {
                    part["size"] = size.name().into();
                }
                part
            })
            .collect();
        let failures: Vec<Value> = self
            .failures(episodes)
            .map(|it| {
                json!({
                    "goal": self.0.goals[it.episode.goal].name,
                    "seed": it.episode.seed,
                    "pegs_counted": it.counted,
                    "pegs": self.0.goals[it.episode.goal].count,
                    "lost": !it.finished,
                    "technical": it.technical,
                    "reason": it.reason,
                })
            })
            .collect();
        let mut text = serde_json::to_string_pretty(&json!({
            "arm": self.0.arm,
            "world": self.0.worlds[0].title,
            "start": self.0.start.title,
            "task": self.task().name(),
            "track": self.0.track,
            "first_seed": self.0.seeds.start(),
            "repeats": self.0.count,
            "secret": self.0.secret.as_ref().map(Secret::commitment),
            "software": self.0.software,
            "goals": goals,
            "classes": classes,
            "failures": failures,
            "loaded": self.loaded(episodes),
        }))
        .into_diagnostic()?;
        text.push('\n');
        Ok(text)
    }

    fn sums_text(&self, episodes: &[Episode]) -> String {
        let (goals, classes) = self.sums(episodes);
        let (first, last) = (self.0.seeds.start(), self.0.seeds.end());
        let world = &self.0.worlds[0].title;
        let start = &self.0.start.title;
        let mut text = format!(
            "arm {}, world {world}, start {start}, track {}, seeds {first} to {last}",
            self.0.arm, self.0.track
        );
        if self.task() != Task::Build {
            let _ = write!(text, ", task {}", self.task().name());
        }
        if let Some(secret) = &self.0.secret {
            let _ = write!(text, " with the secret {}", secret.commitment());
        }
        text.push('\n');
        let mut table = Table::new(
            1,
            [
                "goal",
                "episodes",
                "completion",
                "deviation",
                "best",
                self.task().unit(),
                "mean total time",
                "robot",
                "bound",
                "reference",
            ],
        );
        for (goal, sum) in self.0.goals.iter().zip(&goals) {
            table.add(row(goal.name.clone(), sum));
        }
        for it in &classes {
            let goals = if it.goals == 1 { "goal" } else { "goals" };
            let size = it.size.map_or(String::new(), |size| format!(" {}", size.name()));
            table.add(row(format!("{}{size}: {} {goals}", it.class, it.goals), &it.sum));
        }
        text.push_str(&table.text(terminal_width()));
        for (technical, heading) in [
            (false, "not complete:\n"),
            (true, "technical failures, not the agent's; what is missing counts as no peg:\n"),
        ] {
            let mut heading = heading;
            for it in self.failures(episodes).filter(|it| it.technical == technical) {
                let goal = &self.0.goals[it.episode.goal];
                text.push_str(heading);
                heading = "";
                let pegs = match it.finished {
                    true => format!("{} of {} {}", it.counted, goal.count, self.task().unit()),
                    false => "lost".to_string(),
                };
                let _ = writeln!(text, "  {} seed {}: {pegs}: {}", goal.name, it.episode.seed, it.reason);
            }
        }
        let loaded = self.loaded(episodes);
        if loaded > 0 {
            let _ = writeln!(
                text,
                "the machine was loaded during {loaded} of {} episodes: planning and computing took longer than on an \
                 idle machine",
                episodes.len()
            );
        }
        let _ = writeln!(text, "results: {}", self.0.folder.display());
        text
    }
}

/// A row of the table.
fn row(name: String, sum: &Summary) -> [String; 10] {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let none = || "-".to_string();
    let seconds = |time: Option<f64>| time.map_or_else(none, |time| format!("{time:.1} s"));
    let compared = sum.time.and_then(|it| it.compared);
    [
        name,
        format!("{}/{}", sum.finished, sum.episodes),
        percent(sum.completion.mean),
        sum.completion.deviation.map_or_else(none, percent),
        sum.best.map_or_else(none, |best| format!("{:.0} %", 100.0 * best.completion)),
        format!("{}/{}", sum.pegs_counted, sum.pegs),
        sum.time.map_or_else(none, |time| match time.total_deviation {
            Some(deviation) => format!("{:.1} s ± {deviation:.1} s", time.total),
            None => format!("{:.1} s", time.total),
        }),
        seconds(sum.time.map(|it| it.robot)),
        seconds(compared.map(|it| it.bound)),
        seconds(compared.map(|it| it.reference)),
    ]
}
