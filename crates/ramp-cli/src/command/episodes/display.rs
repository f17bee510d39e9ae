//! Progress display of many running episodes.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::episode::{Episode, Outcome};
use crate::output::tell;

/// Progress on standard error: a bar on a terminal, a line for each episode elsewhere.
pub struct Display {
    bar: Option<ProgressBar>,
    /// Episodes to run.
    count: usize,
    jobs: usize,
    /// Number of ended episodes, and their total duration.
    past: std::cell::Cell<(usize, Duration)>,
}

impl Display {
    pub fn new(count: usize, before: usize, jobs: usize) -> Display {
        if before > 0 {
            tell(&format!("{before} of {} episodes are finished already", before + count));
        }
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(count as u64);
            if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} episodes  {elapsed}  {msg}")
            {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Display { bar, count, jobs, past: std::cell::Cell::default() }
    }

    /// Estimated remaining time, from the durations so far; empty before the first episode has ended.
    fn left(&self) -> Option<String> {
        let (ended, took) = self.past.get();
        if ended == 0 {
            return None;
        }
        let jobs = self.jobs.min(self.count - ended).max(1);
        let left = took.as_secs_f64() / ended as f64 * (self.count - ended) as f64 / jobs as f64;
        Some(if left < 100.0 {
            format!("about {left:.0} s left")
        } else {
            format!("about {:.0} min left", left / 60.0)
        })
    }

    pub fn at_work<'s>(&self, stems: impl Iterator<Item = &'s str>) {
        if let Some(bar) = &self.bar {
            let names = stems.collect::<Vec<_>>().join(", ");
            let left = self.left().map_or_else(String::new, |left| format!("{left}  "));
            bar.set_message(format!("{left}{names}"));
        }
    }

    /// Shows that a cluster is at work: it does not tell which episodes run.
    pub fn at_work_elsewhere(&self) {
        let processors = if self.jobs == 1 { "processor" } else { "processors" };
        self.at_work([format!("on {} {processors}", self.jobs).as_str()].into_iter());
    }

    pub fn ended(&self, episode: &Episode, took: Duration) {
        let (ended, before) = self.past.get();
        self.past.set((ended + 1, before + took));
        let what = match &episode.outcome {
            Outcome::Finished(result) => {
                let (counted, wanted, unit) = (result.counted(), result.wanted(), result.unit());
                format!("{counted} of {wanted} {unit} in {:.1} s", result.time.total)
            }
            Outcome::Lost(reason) => format!("lost: {reason}"),
            Outcome::Open => "open".to_string(),
        };
        if let Some(bar) = &self.bar {
            bar.println(format!("{}  {what}", episode.stem));
            bar.inc(1);
        } else {
            let left = self.left().unwrap_or_default();
            tell(&format!("{}/{}  {}  {what}  ({left})", ended + 1, self.count, episode.stem));
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
