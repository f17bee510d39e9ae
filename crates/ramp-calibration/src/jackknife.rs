//! Standard errors from the data themselves: by how much an estimate changes when some of them are left out.

/// Most groups of observations that are left out one after another.
const GROUPS: usize = 12;

/// The standard error of an estimate of which `differences` are those from the estimates without one of the
/// groups each, squared.
pub(crate) fn standard_error(differences: &[f64]) -> f64 {
    let count = differences.len() as f64;
    ((count - 1.0) / count * differences.iter().sum::<f64>()).sqrt()
}

/// For each group the observations that are kept when it is left out, of `count`. A group is one observation
/// while there are few.
pub(crate) fn kept(count: usize) -> impl Iterator<Item = Vec<usize>> {
    let groups = count.min(GROUPS);
    (0..groups).map(move |group| (0..count).filter(|index| index % groups != group).collect())
}
