//! Completion over time, as in the paper: the mean of all episodes, its deviation, and the best one.

use ramp_result::episode::EpisodeResult;
use ramp_result::summary::Spread;

/// A step of the mean, valid from this time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Total time, s.
    pub time: f64,
    /// Mean completion of all episodes.
    pub mean: f64,
    /// Sample standard deviation; 0 for a single episode.
    pub deviation: f64,
}

/// The curves of some episodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The mean, from time 0 on.
    pub mean: Vec<Step>,
    /// The best episode: total time and completion from there on.
    pub best: Vec<(f64, f64)>,
    /// When the last episode ended, s.
    pub end: f64,
    /// When the best one ended, s.
    pub best_end: f64,
}

/// The curves of `results` and of `lost` episodes without any peg; `None` without results. After
/// its end an episode keeps its completion.
pub fn curves(results: &[&EpisodeResult], lost: usize) -> Option<Curves> {
    let of = |result: &EpisodeResult| {
        let mut times: Vec<f64> = result.pegs.iter().flatten().map(|peg| peg.t_total).collect();
        times.sort_by(f64::total_cmp);
        (times, result.pegs.len().max(1) as f64)
    };
    let episodes: Vec<(Vec<f64>, f64)> = results.iter().map(|result| of(result)).collect();
    let mut times: Vec<f64> = episodes.iter().flat_map(|(times, _)| times).copied().collect();
    times.push(0.0);
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mean = times
        .into_iter()
        .filter_map(|time| {
            let mut shares: Vec<f64> = episodes
                .iter()
                .map(|(times, pegs)| times.iter().filter(|it| **it <= time).count() as f64 / pegs)
                .collect();
            shares.extend(std::iter::repeat_n(0.0, lost));
            let spread = Spread::of(&shares)?;
            Some(Step { time, mean: spread.mean, deviation: spread.deviation.unwrap_or(0.0) })
        })
        .collect();
    let best = results
        .iter()
        .min_by(|a, b| b.completion.total_cmp(&a.completion).then(a.time.total.total_cmp(&b.time.total)))?;
    let (best_times, pegs) = of(best);
    let best_steps =
        best_times.into_iter().enumerate().map(|(index, time)| (time, (index + 1) as f64 / pegs));
    Some(Curves {
        mean,
        best: std::iter::once((0.0, 0.0)).chain(best_steps).collect(),
        end: results.iter().map(|result| result.time.total).fold(0.0, f64::max),
        best_end: best.time.total,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ramp_result::testing::episode;

    #[test]
    fn the_mean_rises_with_every_peg_and_stays() {
        let (one, two) = (episode("easy-1", 1, &[10.0, 20.0], 2), episode("easy-1", 2, &[15.0], 2));
        let curves = curves(&[&one, &two], 0).unwrap();
        let means: Vec<(f64, f64)> = curves.mean.iter().map(|step| (step.time, step.mean)).collect();
        assert_eq!(means, [(0.0, 0.0), (10.0, 0.25), (15.0, 0.5), (20.0, 0.75)]);
        assert_eq!(curves.best, [(0.0, 0.0), (10.0, 0.5), (20.0, 1.0)]);
        assert_eq!(curves.mean[1].deviation, (0.125_f64).sqrt());
    }

    #[test]
    fn a_lost_episode_pulls_the_mean_down() {
        let one = episode("easy-1", 1, &[10.0], 1);
        assert_eq!(curves(&[&one], 1).unwrap().mean[1].mean, 0.5);
    }
}
