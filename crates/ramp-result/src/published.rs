//! Published figures of a class without single episodes: means to be shown beside results, never
//! added to them.

use serde::{Deserialize, Serialize};

use crate::words;

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-published-1";

/// The published figures of a class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name in tables.
    pub name: String,
    /// The robot.
    pub robot: String,
    /// The publication.
    pub source: String,
    /// The class.
    pub class: String,
    /// Number of goals of the class that were run.
    pub goals: usize,
    /// Repeats of each.
    pub repeats: usize,
    /// The track it belongs to.
    pub track: String,
    /// Mean completion, 0 to 1.
    pub completion: f64,
    /// Mean total time, s.
    pub total: f64,
    /// Shortest and longest planning time, s.
    pub planning: [f64; 2],
}

impl Published {
    /// Checks that these figures are consistent.
    ///
    /// # Errors
    /// The contradiction, in words.
    pub fn check(&self) -> Result<(), String> {
        words::title("the name", &self.name)?;
        words::title("the robot", &self.robot)?;
        words::title("the source", &self.source)?;
        words::class_and_track(Some(&self.class), &self.track)?;
        if self.goals == 0 || self.repeats == 0 {
            return Err("no goal was run".to_string());
        }
        if !(0.0..=1.0).contains(&self.completion) {
            return Err(format!("mean completion is {}, expected 0 to 1", self.completion));
        }
        if !(0.0..=1e7).contains(&self.total) {
            return Err(format!("mean total time is {} s", self.total));
        }
        let [shortest, longest] = self.planning;
        if !(0.0 <= shortest && shortest <= longest && longest <= self.total) {
            return Err(format!("planning takes {shortest} to {longest} s of {} s in total", self.total));
        }
        Ok(())
    }
}
