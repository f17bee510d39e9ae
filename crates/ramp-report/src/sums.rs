//! The report's numbers for each agent, goal and class.

use std::cmp::Ordering;

use ramp_assembly::Size;
use serde::Serialize;

use ramp_result::activity::{self, Activity};
use ramp_result::collection::{Collection, Entrant, GoalInfo};
use ramp_result::episode::EpisodeResult;
use ramp_result::statistics::{Interval, bootstrap, completion_interval, sign_flip, wilson};
use ramp_result::summary::{Entry, Spread, Summary, cause};

/// The scope of a line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub enum Scope {
    /// One goal.
    Goal(String),
    /// The goals of one size in a set of the open class, by the names of both.
    Size(String, &'static str),
    /// All goals of a class, or of none.
    Class(Option<String>),
}

impl Scope {
    /// Whether it includes this goal.
    pub fn holds(&self, goal: &GoalInfo) -> bool {
        match self {
            Scope::Goal(name) => *name == goal.name,
            Scope::Size(class, size) => {
                Some(class) == goal.class.as_ref()
                    && Size::of_goal_name(&goal.name).map(Size::name) == Some(*size)
            }
            Scope::Class(class) => *class == goal.class,
        }
    }

    /// For a table.
    pub fn name(&self) -> &str {
        match self {
            Scope::Goal(name) => name,
            Scope::Size(_, size) => size,
            Scope::Class(class) => class.as_deref().unwrap_or("no class"),
        }
    }
}

/// One line of a table: an agent on a goal or a class.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Index of the agent in the collection.
    pub entrant: usize,
    /// Its scope.
    pub scope: Scope,
    /// The sums of the protocol.
    pub summary: Summary,
    /// Episodes in which every peg counts.
    pub complete: usize,
    /// Their share, Wilson's interval.
    pub complete_interval: Interval,
    /// The interval of mean completion.
    pub completion_interval: Option<Interval>,
    /// The interval of mean total time, s.
    pub total_interval: Option<Interval>,
    /// Total time of the episodes in which every peg counts, s.
    pub complete_total: Option<Spread>,
    /// Mean robot time of each activity, s.
    pub activities: [f64; Activity::ALL.len()],
}

/// Two agents on their common goals and seeds.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Indices of the two agents in the collection.
    pub entrants: [usize; 2],
    /// The scope.
    pub scope: Scope,
    /// First minus second.
    pub completion: Difference,
    /// The same for total time, s, over pairs in which both are complete.
    pub total: Option<Difference>,
}

/// The mean of paired differences.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Pairs.
    pub pairs: usize,
    /// Their mean.
    pub mean: f64,
    /// Its interval by bootstrap over pairs.
    pub interval: Option<Interval>,
    /// p of the sign-flip test.
    pub p: f64,
    /// The same after Holm's correction for all tests of the report.
    pub corrected: f64,
}

/// Results and lost episodes of an entrant in a scope, grouped by goal.
fn groups<'c>(collection: &'c Collection, entrant: &'c Entrant, scope: &Scope) -> Vec<Vec<Entry>> {
    let goals = collection.goals.iter().filter(|goal| scope.holds(goal));
    goals
        .map(|goal| {
            let results = entrant
                .files
                .iter()
                .filter(|file| file.result.goal == goal.name)
                .map(|file| Entry { pegs: goal.pegs, result: Some(file.result.clone()) });
            let lost = entrant.lost.iter().filter(|lost| lost.goal == goal.name);
            results.chain(lost.map(|_| Entry { pegs: goal.pegs, result: None })).collect()
        })
        .filter(|group: &Vec<Entry>| !group.is_empty())
        .collect()
}

/// The results of an entrant in a scope, by goal and seed.
pub fn results<'c>(
    collection: &'c Collection,
    entrant: &'c Entrant,
    scope: &'c Scope,
) -> impl Iterator<Item = &'c EpisodeResult> {
    entrant.files.iter().map(|file| &file.result).filter(move |result| {
        collection.goals.iter().any(|goal| goal.name == result.goal && scope.holds(goal))
    })
}

/// One line; `None` when the agent has no episode there.
pub fn line(collection: &Collection, entrant: usize, scope: &Scope) -> Option<Line> {
    let who = &collection.entrants[entrant];
    let groups = groups(collection, who, scope);
    if groups.is_empty() {
        return None;
    }
    let completion: Vec<Vec<f64>> = groups
        .iter()
        .map(|group| {
            group.iter().map(|entry| entry.result.as_ref().map_or(0.0, |it| it.completion)).collect()
        })
        .collect();
    let total: Vec<Vec<f64>> = groups
        .iter()
        .map(|group| group.iter().filter_map(|entry| Some(entry.result.as_ref()?.time.total)).collect())
        .filter(|group: &Vec<f64>| !group.is_empty())
        .collect();
    let episodes = groups.iter().map(Vec::len).sum();
    let done: Vec<&EpisodeResult> = groups
        .iter()
        .flatten()
        .filter_map(|entry| entry.result.as_ref())
        .filter(|it| is_complete(it))
        .collect();
    let mut activities = [0.0; Activity::ALL.len()];
    let finished: Vec<&EpisodeResult> =
        groups.iter().flatten().filter_map(|entry| entry.result.as_ref()).collect();
    for result in &finished {
        for (sum, time) in activities.iter_mut().zip(activity::times(result)) {
            *sum += time / finished.len() as f64;
        }
    }
    let name = format!("{} {:?}", who.label, scope);
    Some(Line {
        entrant,
        scope: scope.clone(),
        summary: Summary::of(groups.iter().flatten()),
        complete: done.len(),
        complete_interval: wilson(done.len(), episodes),
        completion_interval: completion_interval(&completion, &format!("completion {name}")),
        total_interval: bootstrap(&total, &format!("total {name}")),
        complete_total: Spread::of(&done.iter().map(|it| it.time.total).collect::<Vec<_>>()),
        activities,
    })
}

/// Ranking of two agents: higher completion, then less time.
pub fn better(a: &Line, b: &Line) -> Ordering {
    let total = |line: &Line| line.summary.time.map_or(f64::INFINITY, |time| time.total);
    let completion = b.summary.completion.mean.total_cmp(&a.summary.completion.mean);
    completion.then(total(a).total_cmp(&total(b)))
}

/// Whether every peg counts.
pub fn is_complete(result: &EpisodeResult) -> bool {
    !result.pegs.is_empty() && result.counted() == result.pegs.len()
}

/// Two agents compared; `None` when they share no goal and seed.
pub fn compare(collection: &Collection, entrants: [usize; 2], scope: &Scope) -> Option<Comparison> {
    let [one, two] = entrants.map(|index| &collection.entrants[index]);
    // For each episode: its completion, and its total time if it is complete.
    let episode = |entrant: &Entrant, goal: &str, seed: u64| -> Option<(f64, Option<f64>)> {
        let file = entrant.files.iter().find(|file| file.result.goal == goal && file.result.seed == seed);
        if let Some(file) = file {
            let result = &file.result;
            return Some((result.completion, is_complete(result).then_some(result.time.total)));
        }
        entrant.lost.iter().any(|lost| lost.goal == goal && lost.seed == seed).then_some((0.0, None))
    };
    let mut completion: Vec<Vec<f64>> = Vec::new();
    let mut total: Vec<Vec<f64>> = Vec::new();
    for goal in collection.goals.iter().filter(|goal| scope.holds(goal)) {
        let mut seeds: Vec<u64> = one
            .files
            .iter()
            .filter(|file| file.result.goal == goal.name)
            .map(|file| file.result.seed)
            .chain(one.lost.iter().filter(|lost| lost.goal == goal.name).map(|lost| lost.seed))
            .collect();
        seeds.sort_unstable();
        let (mut shares, mut times) = (Vec::new(), Vec::new());
        for seed in seeds {
            let (Some(a), Some(b)) = (episode(one, &goal.name, seed), episode(two, &goal.name, seed)) else {
                continue;
            };
            shares.push(a.0 - b.0);
            times.extend(a.1.zip(b.1).map(|(a, b)| a - b));
        }
        completion.push(shares);
        total.push(times);
    }
    let name = format!("{} against {} {scope:?}", one.label, two.label);
    Some(Comparison {
        entrants,
        scope: scope.clone(),
        completion: difference(completion, &format!("completion {name}"))?,
        total: difference(total, &format!("total {name}")),
    })
}

fn difference(mut groups: Vec<Vec<f64>>, name: &str) -> Option<Difference> {
    groups.retain(|group| !group.is_empty());
    let all: Vec<f64> = groups.iter().flatten().copied().collect();
    let p = sign_flip(&all, name)?;
    Some(Difference {
        pairs: all.len(),
        mean: Spread::of(&all)?.mean,
        interval: bootstrap(&groups, name),
        p,
        corrected: p,
    })
}

/// A cause of failure and the episodes that it ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// The cause, without names and numbers.
    pub cause: String,
    /// Whether it is technical, and no failure of the agent.
    pub technical: bool,
    /// The episodes: goal, seed, and the full reason.
    pub episodes: Vec<(String, u64, String)>,
}

/// The incomplete episodes of an agent, by cause, the most frequent first; technical causes come last.
pub fn failures(entrant: &Entrant) -> Vec<Failure> {
    let mut failures: Vec<Failure> = Vec::new();
    let told = entrant.files.iter().filter_map(|file| {
        let reason = ramp_result::summary::shortfall(&file.result)?;
        Some((file.result.is_technical(), (file.result.goal.clone(), file.result.seed, reason)))
    });
    let lost = entrant.lost.iter().map(|lost| {
        let reason = "lost: its program crashed, was killed or ran out of time on the wall".to_string();
        (true, (lost.goal.clone(), lost.seed, reason))
    });
    for (technical, episode) in told.chain(lost) {
        let cause = cause(&episode.2);
        match failures.iter_mut().find(|it| it.cause == cause && it.technical == technical) {
            Some(failure) => failure.episodes.push(episode),
            None => failures.push(Failure { cause, technical, episodes: vec![episode] }),
        }
    }
    let order = |it: &Failure| (it.technical, std::cmp::Reverse(it.episodes.len()), it.cause.clone());
    failures.sort_by_cached_key(order);
    failures
}
