//! The trials of each skill, added up.

use serde::Serialize;

use super::Trial;
use crate::episode::Software;
use crate::statistics::{Interval, quantile, wilson};
use crate::summary::cause;

/// All trials of one skill on one track in one world by one agent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkillSum {
    /// The skill.
    pub skill: String,
    /// The track.
    pub track: String,
    /// Unambiguous name of the world ([`WorldInfo::title`](crate::episode::WorldInfo::title)).
    pub world: String,
    /// Unambiguous name of the start ([`StartInfo::title`](crate::episode::StartInfo::title)).
    pub start: String,
    /// The agent and its version.
    pub agent: String,
    /// The program that made the trials.
    pub software: Software,
    /// Number of trials.
    pub trials: usize,
    /// Number of trials that are done according to the true poses.
    pub successes: usize,
    /// Wilson's interval of their share, 95 %.
    pub interval: Interval,
    /// Number of trials with at least one retry.
    pub retried: usize,
    /// Robot time, s: median and 95 % quantile, of all trials.
    pub time: [f64; 2],
    /// The largest force of all trials, N.
    pub largest_force: f64,
    /// Causes of failure without names and numbers, with count and first seed, the most frequent
    /// first.
    pub failures: Vec<(String, usize, u64)>,
}

/// Sums by skill, track, world, start, agent and software, in order of first occurrence.
pub fn sums<'t>(trials: impl IntoIterator<Item = &'t Trial>) -> Vec<SkillSum> {
    let mut groups: Vec<(Key, Vec<&Trial>)> = Vec::new();
    for trial in trials {
        let agent = format!("{} {}", trial.agent.name, trial.agent.version);
        let of = (trial.track.clone(), trial.world.title(), trial.start.title());
        let key = (trial.skill.clone(), of, agent, trial.software.clone());
        match groups.iter_mut().find(|(other, _)| *other == key) {
            Some((_, group)) => group.push(trial),
            None => groups.push((key, vec![trial])),
        }
    }
    groups.into_iter().map(|(key, group)| sum(key, &group)).collect()
}

/// Skill, track with world and start, agent and software.
type Key = (String, (String, String, String), String, Software);

fn sum((skill, (track, world, start), agent, software): Key, trials: &[&Trial]) -> SkillSum {
    let successes = trials.iter().filter(|trial| trial.success).count();
    let mut times: Vec<f64> = trials.iter().map(|trial| trial.time).collect();
    times.sort_by(f64::total_cmp);
    let mut failures: Vec<(String, usize, u64)> = Vec::new();
    for trial in trials.iter().filter(|trial| !trial.success) {
        let told = trial.cause.as_ref().or(trial.missing.as_ref());
        let cause = cause(told.map_or("", String::as_str));
        match failures.iter_mut().find(|(known, ..)| *known == cause) {
            Some((_, count, first)) => {
                *count += 1;
                *first = trial.seed.min(*first);
            }
            None => failures.push((cause, 1, trial.seed)),
        }
    }
    failures.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    SkillSum {
        skill,
        track,
        world,
        start,
        agent,
        software,
        trials: trials.len(),
        successes,
        interval: wilson(successes, trials.len()),
        retried: trials.iter().filter(|trial| trial.retries > 0).count(),
        time: [0.5, 0.95].map(|share| quantile(&times, share)),
        largest_force: trials.iter().map(|trial| trial.physics.largest_force).fold(0.0, f64::max),
        failures,
    }
}
