//! Summaries of several episodes: the figures that the protocol reports for a goal or a class.

use ramp_robot::EventKind;
use serde::Serialize;

use crate::episode::{EpisodeResult, RobotTime};

/// One episode of a bench.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Pegs in its goal, or parts that are to be put back.
    pub pegs: usize,
    /// Its result; `None` when it was lost: it crashed, was killed or reached the wall-clock limit.
    pub result: Option<EpisodeResult>,
}

/// Episodes of a goal or a class, summed up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of episodes requested.
    pub episodes: usize,
    /// Number of episodes with a result.
    pub finished: usize,
    /// Number of episodes that a technical failure ended: the lost ones, and those that ran out of time on
    /// the wall or whose physics diverged.
    pub technical: usize,
    /// Share of counted pegs over all episodes; a lost episode counts as zero.
    pub completion: Spread,
    /// The best episode: the highest completion, and the shortest total time among equals.
    pub best: Option<Best>,
    /// Number of counted pegs of all episodes together.
    pub pegs_counted: usize,
    /// Number of pegs in the goals of all episodes together.
    pub pegs: usize,
    /// Mean times of the episodes that have a result, complete or not.
    pub time: Option<MeanTime>,
}

/// Mean and sample standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The sample standard deviation (n − 1); `None` for fewer than two values.
    pub deviation: Option<f64>,
}

/// The best episode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Best {
    /// Its completion.
    pub completion: f64,
    /// Its total time, s.
    pub total: f64,
}

/// Mean times, s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanTime {
    /// Task planning.
    pub planning: f64,
    /// The rest of the agent's compute.
    pub compute: f64,
    /// The robot's own time.
    pub robot: f64,
    /// The sum.
    pub total: f64,
    /// Standard deviation of the sum.
    pub total_deviation: Option<f64>,
    /// Mean times to compare robot time with, of the results that have them.
    pub compared: Option<RobotTime>,
}

impl Spread {
    /// Over these values; `None` when there are none.
    pub fn of(values: &[f64]) -> Option<Spread> {
        if values.is_empty() {
            return None;
        }
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Spread { mean, deviation: (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt()) })
    }
}

impl Summary {
    /// Over these episodes.
    pub fn of<'a>(entries: impl IntoIterator<Item = &'a Entry>) -> Summary {
        let entries: Vec<&Entry> = entries.into_iter().collect();
        let results: Vec<&EpisodeResult> = entries.iter().filter_map(|entry| entry.result.as_ref()).collect();
        let completion: Vec<f64> =
            entries.iter().map(|entry| entry.result.as_ref().map_or(0.0, |it| it.completion)).collect();
        let best = results
            .iter()
            .map(|result| Best { completion: result.completion, total: result.time.total })
            .min_by(|a, b| b.completion.total_cmp(&a.completion).then(a.total.total_cmp(&b.total)));
        let mean = |part: fn(&EpisodeResult) -> f64| {
            Spread::of(&results.iter().map(|result| part(result)).collect::<Vec<_>>())
        };
        let compared: Vec<RobotTime> = results.iter().filter_map(|result| result.robot_time).collect();
        let compared_mean = |part: fn(&RobotTime) -> f64| {
            Spread::of(&compared.iter().map(part).collect::<Vec<_>>()).map(|it| it.mean)
        };
        let compared = compared_mean(|it| it.bound)
            .zip(compared_mean(|it| it.reference))
            .map(|(bound, reference)| RobotTime { bound, reference });
        let time = mean(|it| it.time.total).map(|total| MeanTime {
            planning: mean(|it| it.time.planning).map_or(0.0, |it| it.mean),
            compute: mean(|it| it.time.compute).map_or(0.0, |it| it.mean),
            robot: mean(|it| it.time.robot).map_or(0.0, |it| it.mean),
            total: total.mean,
            total_deviation: total.deviation,
            compared,
        });
        Summary {
            episodes: entries.len(),
            finished: results.len(),
            technical: entries.len() - results.iter().filter(|result| !result.is_technical()).count(),
            completion: Spread::of(&completion).unwrap_or(Spread { mean: 0.0, deviation: None }),
            best,
            pegs_counted: results.iter().map(|result| result.counted()).sum(),
            pegs: entries.iter().map(|entry| entry.pegs).sum(),
            time,
        }
    }
}

/// Reason why an episode is not complete, in the words of its result; `None` when it is complete.
pub fn shortfall(result: &EpisodeResult) -> Option<String> {
    if result.counted() == result.wanted() {
        return None;
    }
    if result.ended.reason != "done" {
        return Some(result.ended.reason.clone());
    }
    let fault = result.events.iter().rev().find_map(|event| match &event.kind {
        EventKind::Fault(fault) => Some(fault),
        _ => None,
    });
    Some(fault.map_or_else(|| "the agent stopped".to_string(), ToString::to_string))
}

/// A reason without its variable parts: words that contain digits become `…`.
pub fn cause(reason: &str) -> String {
    let words = reason
        .split_whitespace()
        .map(|word| if word.bytes().any(|byte| byte.is_ascii_digit()) { "…" } else { word });
    let mut cause = words.collect::<Vec<_>>().join(" ");
    while cause.contains("… …") {
        cause = cause.replace("… …", "…");
    }
    cause
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        let spread = Spread::of(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(spread.mean, 2.5);
        assert!((spread.deviation.unwrap() - (5.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(Spread::of(&[0.5]).unwrap().deviation, None);
        assert_eq!(Spread::of(&[]), None);
    }

    #[test]
    fn a_lost_episode_counts_as_one_without_pegs() {
        let summary = Summary::of(&[Entry { pegs: 3, result: None }]);
        assert_eq!((summary.episodes, summary.finished, summary.pegs), (1, 0, 3));
        assert_eq!(summary.completion.mean, 0.0);
        assert_eq!((summary.best, summary.time), (None, None));
    }

    #[test]
    fn one_cause_is_one_cause_whatever_the_part() {
        assert_eq!(cause("p2 is 1.30 mm short of flush at C2"), cause("p1 is 0.71 mm short of flush at C14"));
        assert_eq!(cause("b4 jams 3.1 mm before its place at 40.0 N"), "… jams … mm before its place at … N");
    }
}
