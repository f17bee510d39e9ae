//! The track of planning alone: plans of any planner, judged without a robot.

use serde::{Deserialize, Serialize};

use crate::episode::Software;
use crate::words;

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-planning-1";

/// The verdict on one plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanVerdict {
    /// [`SCHEMA`].
    pub schema: String,
    /// The goal.
    pub goal: String,
    /// Its class.
    pub class: Option<String>,
    /// Name of the planner.
    pub planner: String,
    /// The program that judged it.
    pub software: Software,
    /// Whether every action is applicable and has the claimed effects, and the last state reaches
    /// the goal.
    pub accepted: bool,
    /// The first invalid action, and the reason.
    pub refused: Option<String>,
    /// Coarse actions.
    pub coarse: usize,
    /// Planning time as reported by the planner, s.
    pub seconds: Option<f64>,
}

impl PlanVerdict {
    /// Checks that the verdict is consistent.
    ///
    /// # Errors
    /// The contradiction, in words.
    pub fn check(&self) -> Result<(), String> {
        if self.accepted == self.refused.is_some() {
            return Err("a plan is accepted, or refused with a reason".to_string());
        }
        words::name("the goal", &self.goal)?;
        self.class.as_deref().map_or(Ok(()), words::known_class)?;
        words::name("the planner", &self.planner)?;
        words::software(&self.software)?;
        self.refused.as_ref().map_or(Ok(()), |why| words::sentence("why it is refused", why))?;
        match self.seconds {
            Some(seconds) if !(0.0..=1e7).contains(&seconds) => Err(format!("planning took {seconds} s")),
            _ => Ok(()),
        }
    }
}
