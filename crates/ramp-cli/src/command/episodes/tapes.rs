//! The logs whose commands a bench plays without sight.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report, miette};
use ramp_kit::source::is_debris;
use ramp_log::{ENDING, Log};

use super::goals::BatchGoal;

/// Logs by goal: seed and file of each.
pub struct Tapes(BTreeMap<String, Vec<(u64, PathBuf)>>);

impl Tapes {
    /// The logs of these goals in a folder, for episodes of `seeds`.
    ///
    /// # Errors
    /// If the folder or a log cannot be read, or a goal has no log of another seed for one of the episodes.
    pub fn find(folder: &Path, goals: &[BatchGoal], seeds: &RangeInclusive<u64>) -> Result<Tapes, Report> {
        let fail = |error| miette!("{} cannot be read: {error}", folder.display());
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(fail)? {
            paths.push(entry.map_err(fail)?.path());
        }
        paths.retain(|path| path.extension().is_some_and(|ending| ending == ENDING) && !is_debris(path));
        paths.sort();
        let mut tapes: BTreeMap<String, Vec<(u64, PathBuf)>> = BTreeMap::new();
        for path in paths {
            let header = Log::read(&path).into_diagnostic()?.header;
            tapes.entry(header.goal.name).or_default().push((header.seed, path));
        }
        for goal in goals {
            let logs = tapes.get(&goal.name).map_or(&[][..], Vec::as_slice);
            // One log is enough for all seeds but its own.
            if logs.len() < 2 && logs.first().is_none_or(|(own, _)| seeds.contains(own)) {
                let (name, folder) = (&goal.name, folder.display());
                return Err(miette!(
                    help = format!("make some: ramp bench {name} --track state -o {folder}"),
                    "{folder} has logs of fewer than two seeds of {name}"
                ));
            }
        }
        Ok(Tapes(tapes))
    }

    /// The log that is played in an episode: one of another seed, in turn.
    pub fn of(&self, goal: &str, seed: u64) -> Option<&Path> {
        let others: Vec<&(u64, PathBuf)> = self.0.get(goal)?.iter().filter(|(own, _)| *own != seed).collect();
        let index = usize::try_from(seed % others.len().max(1) as u64).unwrap_or_default();
        Some(&others.get(index)?.1)
    }
}
