//! What an episode is given beside its goal: task, state and plan.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use ramp_assembly::{Assembly, Task};
use ramp_data::{Plans, PlansError};
use ramp_planner::{Domains, Plan};
use ramp_twin::{GivenState, Start};

use crate::errors::{PlanningError, detached, input};

/// The task of that name, and the state in which the frame begins. `replaced`: a plan or a planner takes the
/// place of the baseline's.
pub fn given(
    task: &str,
    state: Option<&Path>,
    assembly: &Assembly,
    start: &Start,
    replaced: bool,
) -> PyResult<(Task, Option<GivenState>)> {
    let names = Task::ALL.map(Task::name).join(", ");
    let task =
        Task::named(task).ok_or_else(|| input(format!("there is no task `{task}`; there are {names}")))?;
    let state = match (task, state) {
        (Task::Build, path) => path.map(|path| GivenState::read(path, assembly)).transpose(),
        (Task::TakeApart, _) if replaced => {
            return Err(input("plans and planners build frames: the task `take-apart` cannot use them"));
        }
        (Task::TakeApart, Some(_)) => {
            return Err(input("a frame that is taken apart begins built: leave out the state"));
        }
        (Task::TakeApart, None) if start.scatter.is_some() => {
            return Err(input(format!("from the start `{}` no frame can be taken apart", start.name)));
        }
        (Task::TakeApart, None) => GivenState::built(assembly).map(Some),
    };
    Ok((task, state.map_err(|error| input(format!("{error:#}")))?))
}

/// The plan that was given as a text, or as a file or folder, and its hash.
pub fn given_plan(
    py: Python<'_>,
    text: Option<String>,
    path: Option<PathBuf>,
    assembly: &Assembly,
    domains: &Domains,
) -> PyResult<Option<(Plan, String)>> {
    let plans = match (text, path) {
        (Some(text), _) => Plans::of_text(Path::new("the plan"), text),
        (None, Some(path)) => Plans::read(&path).map_err(of_plans)?,
        (None, None) => return Ok(None),
    };
    let plan = detached(py, || plans.plan(assembly, domains).map_err(of_plans))?;
    Ok(Some((plan, plans.sha256().to_string())))
}

/// A plan that is refused, or files that are no plans.
fn of_plans(error: PlansError) -> PyErr {
    match error {
        PlansError::Plan { .. } => PlanningError::new_err(error.to_string()),
        error => input(error),
    }
}
