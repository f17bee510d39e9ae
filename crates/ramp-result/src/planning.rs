//! The track of planning alone: plans of any planner, judged without a robot.

use serde::{Deserialize, Serialize};

use crate::episode::Software;
use crate::words;

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-planning-1";

/// What came of judging one plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanVerdict {
    /// [`SCHEMA`].
    pub schema: String,
    /// The goal.
    pub goal: String,
    /// Its class.
    pub class: Option<String>,
    /// Who made the plan.
    pub planner: String,
    /// With what it was judged.
    pub software: Software,
    /// Does every action do what it says, and does the end reach the goal?
    pub accepted: bool,
    /// The first action that is wrong, and why.
    pub refused: Option<String>,
    /// Coarse actions.
    pub coarse: usize,
    /// How long planning took by the planner's own account, s.
    pub seconds: Option<f64>,
}

impl PlanVerdict {
    /// Can this be?
    ///
    /// # Errors
    /// What contradicts what, in words.
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
