//! The task of an episode, and the state in which its frame begins: options that `ramp run` and `ramp bench`
//! share.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use miette::{Report, miette};
use ramp_assembly::{Assembly, Task};
use ramp_result::episode::StateInfo;
use ramp_twin::GivenState;
use ramp_world::Start;

use super::agent;
use crate::options::TaskName;

#[derive(clap::Args)]
pub struct Arguments {
    /// Begin with the frame in the state of this file (JSON). The agent is not told
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Task: build the frame, or take it apart
    #[arg(long, value_enum, default_value_t = TaskName::Build, conflicts_with = "state")]
    task: TaskName,
}

impl Arguments {
    /// The task.
    pub fn task(&self) -> Task {
        self.task.into()
    }

    /// Whether a file gives the state in which the frame begins.
    pub fn has_state(&self) -> bool {
        self.state.is_some()
    }

    /// The state in which the frame begins, if not with nothing built.
    ///
    /// # Errors
    /// If the file cannot be read, the frame cannot begin like that, or this agent has no such task.
    pub fn state(
        &self,
        assembly: &Assembly,
        start: &Start,
        agent: &agent::Arguments,
    ) -> Result<Option<GivenState>, Report> {
        if self.task() == Task::Build {
            return Ok(self.state.as_ref().map(|path| GivenState::read(path, assembly)).transpose()?);
        }
        if start.scatter.is_some() {
            return Err(miette!(
                help = "leave out --start, or name one whose parts lie on the sheet",
                "a frame cannot be taken apart from the start `{}`: its parts have no places on the sheet",
                start.name
            ));
        }
        if agent.parts.replaces_plans() {
            return Err(miette!("--plan and --planner build frames: --task take-apart cannot use them"));
        }
        if agent.policy.is_some() {
            return Err(miette!("a policy is told to build a frame: --task take-apart cannot use --policy"));
        }
        Ok(Some(GivenState::built(assembly)?))
    }

    /// These options as arguments of `ramp run`; `place` gives the path of a file that they name.
    pub fn words(&self, place: &mut dyn FnMut(&Path) -> PathBuf) -> Vec<OsString> {
        match &self.state {
            Some(path) => vec!["--state".into(), place(path).into()],
            None if self.task() == Task::Build => Vec::new(),
            None => vec!["--task".into(), self.task().name().into()],
        }
    }
}

/// The hash of a state's file, as results have it.
pub fn state_hash(state: &GivenState) -> String {
    StateInfo::of(&state.text).sha256
}
