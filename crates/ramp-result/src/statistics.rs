//! Intervals and tests of the report. All of them give the same bits on every machine: random draws
//! come from streams of one fixed seed, named after their purpose.
//!
//! The pegs of an episode are not independent: if one is not seated, those after it often cannot
//! be. So the unit of all statistics is the episode, not the peg. Episodes are resampled within
//! their goal, because goals are chosen, not sampled.

use ramp_robot::random::Stream;
use serde::Serialize;

/// Seed of all random numbers of a report.
pub const SEED: u64 = 1;
/// Number of bootstrap draws.
pub const DRAWS: usize = 10_000;
/// Number of draws of a sign-flip test with too many pairs to try all signs.
pub const FLIPS: usize = 100_000;
/// Largest number of non-zero differences for which all signs are tried.
const EXACT: usize = 20;
/// The normal quantile of a two-sided interval of 95 %.
const Z: f64 = 1.959_963_984_540_054;

/// An interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Wilson's interval of a share, `hits` of `count`; from 0 to 1 when there are none to count.
///
/// ```
/// let interval = ramp_result::statistics::wilson(15, 15);
/// assert!((interval.low - 0.796).abs() < 1e-3 && interval.high == 1.0);
/// ```
pub fn wilson(hits: usize, count: usize) -> Interval {
    if count == 0 {
        return Interval { low: 0.0, high: 1.0 };
    }
    let (n, share) = (count as f64, hits as f64 / count as f64);
    let scale = 1.0 + Z * Z / n;
    let middle = (share + Z * Z / (2.0 * n)) / scale;
    let half = Z / scale * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    // At the ends the two terms cancel, up to rounding.
    Interval {
        low: if hits == 0 { 0.0 } else { (middle - half).max(0.0) },
        high: if hits == count { 1.0 } else { (middle + half).min(1.0) },
    }
}

/// Percentile bootstrap of the mean over all values; each group (the episodes of a goal) is
/// resampled from itself. `None` when every group is constant, because resampling then gives no
/// interval.
pub fn bootstrap(groups: &[Vec<f64>], name: &str) -> Option<Interval> {
    let spread = |group: &&Vec<f64>| group.iter().any(|value| *value != group[0]);
    groups.iter().find(spread)?;
    let count: usize = groups.iter().map(Vec::len).sum();
    let mut stream = Stream::new(SEED, &format!("bootstrap {name}"));
    let mut means: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let mut sum = 0.0;
            for group in groups {
                for _ in group {
                    let index = (stream.uniform() * group.len() as f64) as usize;
                    sum += group[index.min(group.len() - 1)];
                }
            }
            sum / count as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    Some(Interval { low: quantile(&means, 0.025), high: quantile(&means, 0.975) })
}

/// Interval of the mean completion: the bootstrap over episodes. Where all episodes are complete,
/// or all have no peg, the bootstrap is degenerate; then it is Wilson's interval of the share of
/// such episodes, a conservative bound of the mean.
pub fn completion_interval(groups: &[Vec<f64>], name: &str) -> Option<Interval> {
    let count: usize = groups.iter().map(Vec::len).sum();
    let all = |wanted: f64| count > 0 && groups.iter().flatten().all(|share| *share == wanted);
    if all(1.0) {
        return Some(wilson(count, count));
    }
    if all(0.0) {
        return Some(wilson(0, count));
    }
    bootstrap(groups, name)
}

/// Quantile of sorted values, with linear interpolation.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * (sorted.len() - 1) as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

/// Two-sided p value of the sign-flip test that the mean of paired differences is zero: the share
/// of all sign patterns whose sum is at least as far from zero. Exact for up to 20 non-zero
/// differences; beyond that from [`FLIPS`] draws, the observed pattern included. `None` without any
/// pair.
///
/// ```
/// let p = ramp_result::statistics::sign_flip(&[1.0, 1.0, 1.0, 1.0, 1.0], "example");
/// assert_eq!(p, Some(2.0 / 32.0));
/// ```
pub fn sign_flip(differences: &[f64], name: &str) -> Option<f64> {
    if differences.is_empty() {
        return None;
    }
    let sizes: Vec<f64> = differences.iter().map(|it| it.abs()).filter(|it| *it > 0.0).collect();
    // Rounding error of a sum in another order.
    let slack = 1e-9 * sizes.iter().sum::<f64>();
    let observed = differences.iter().sum::<f64>().abs() - slack;
    if sizes.len() <= EXACT {
        let ways = 1_u32 << sizes.len();
        let far = (0..ways)
            .filter(|signs| {
                let signed = |(bit, size): (usize, &f64)| if signs >> bit & 1 == 1 { -size } else { *size };
                sizes.iter().enumerate().map(signed).sum::<f64>().abs() >= observed
            })
            .count();
        return Some(far as f64 / f64::from(ways));
    }
    let mut stream = Stream::new(SEED, &format!("signs {name}"));
    let far = (0..FLIPS)
        .filter(|_| {
            let signed = |size: &f64| if stream.uniform() < 0.5 { -size } else { *size };
            sizes.iter().map(signed).sum::<f64>().abs() >= observed
        })
        .count();
    Some((far + 1) as f64 / (FLIPS + 1) as f64)
}

/// Holm's correction of several p values of one family, in their order.
///
/// ```
/// assert_eq!(ramp_result::statistics::holm(&[0.5, 0.01, 0.5]), [1.0, 0.03, 1.0]);
/// ```
pub fn holm(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]).then(a.cmp(b)));
    let mut corrected = vec![0.0; values.len()];
    let mut largest: f64 = 0.0;
    for (rank, index) in order.into_iter().enumerate() {
        largest = largest.max((values[index] * (values.len() - rank) as f64).min(1.0));
        corrected[index] = largest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilsons_interval_is_that_of_the_books() {
        // Newcombe 1998, table I: 81 of 263 and 1 of 29.
        let close = |interval: Interval, low: f64, high: f64| {
            (interval.low - low).abs() < 5e-5 && (interval.high - high).abs() < 5e-5
        };
        assert!(close(wilson(81, 263), 0.2553, 0.3662));
        assert!(close(wilson(15, 148), 0.0624, 0.1605));
        assert!(close(wilson(0, 20), 0.0, 0.1611));
        assert!(close(wilson(1, 29), 0.0061, 0.1718));
        assert_eq!(wilson(0, 0), Interval { low: 0.0, high: 1.0 });
    }

    #[test]
    fn a_bootstrap_gives_the_same_bits_again_and_brackets_the_mean() {
        let groups = [vec![1.0, 0.5, 0.75, 1.0, 0.25], vec![0.0, 1.0, 0.5, 0.5, 1.0]];
        let interval = bootstrap(&groups, "test").unwrap();
        assert_eq!(Some(interval), bootstrap(&groups, "test"));
        assert!(interval.low < 0.65 && 0.65 < interval.high);
        // Differences between goals are not differences between episodes.
        assert_eq!(bootstrap(&[vec![1.0; 5], vec![0.0; 5]], "test"), None);
        assert_eq!(bootstrap(&[], "test"), None);
    }

    #[test]
    fn all_complete_is_not_certainty() {
        let interval = completion_interval(&[vec![1.0; 5]], "test").unwrap();
        assert!(interval.low < 0.57 && interval.high == 1.0, "{interval:?}");
        let interval = completion_interval(&[vec![0.0; 5]], "test").unwrap();
        assert!(interval.low == 0.0 && interval.high > 0.43, "{interval:?}");
    }

    #[test]
    fn no_difference_is_never_significant() {
        assert_eq!(sign_flip(&[0.0; 15], "test"), Some(1.0));
        assert_eq!(sign_flip(&[], "test"), None);
        assert_eq!(sign_flip(&[1.0, -1.0], "test"), Some(1.0));
    }

    #[test]
    fn many_pairs_are_drawn_and_agree_with_the_exact_test() {
        let differences: Vec<f64> = (0..20).map(|it| f64::from(it % 7) - 1.8).collect();
        let exact = sign_flip(&differences, "test").unwrap();
        let mut more = differences.clone();
        // One more difference, almost zero: drawn instead of enumerated.
        more.push(1e-12);
        let drawn = sign_flip(&more, "test").unwrap();
        assert!((exact - drawn).abs() < 0.005, "{exact} {drawn}");
    }
}
