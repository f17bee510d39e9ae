//! Plans that are not the baseline's own: a given one, or those of a task planner in Python.

use pyo3::prelude::*;
use ramp_assembly::Assembly;
use ramp_planner::{Domains, Plan, State, read_plan_from};
use ramp_robot::Event;
use ramp_skills::{Baseline, OwnPlanner};
use serde_json::json;

use crate::errors::Raised;

/// The baseline with a given plan and its hash, or with a planner in Python and its name, if there is one.
pub fn planned<'a>(
    baseline: Baseline<'a>,
    (assembly, domains): (&'a Assembly, &'a Domains),
    plan: Option<(Plan, String)>,
    planner: Option<(Py<PyAny>, String)>,
    raised: &Raised,
) -> Baseline<'a> {
    match (plan, planner) {
        (Some((plan, sha256)), _) => baseline.with_plan(plan, &sha256),
        (None, Some((object, name))) => {
            baseline.with_planner(own_planner(assembly, domains, object, raised.clone()), &name)
        }
        (None, None) => baseline,
    }
}

/// A planner in Python: it gets state and history as JSON, and returns the text of a plan.
fn own_planner<'a>(
    assembly: &'a Assembly,
    domains: &'a Domains,
    object: Py<PyAny>,
    raised: Raised,
) -> OwnPlanner<'a> {
    Box::new(move |state: &State, events: &[Event]| -> Result<Plan, String> {
        let problem = json!({ "state": state, "history": events }).to_string();
        let answer =
            Python::attach(|py| object.bind(py).call1((problem,)).and_then(|text| text.extract::<String>()));
        let text = answer.map_err(|error| {
            let why = error.to_string();
            raised.keep(error);
            why
        })?;
        read_plan_from(&text, assembly, state, domains)
            .map_err(|error| format!("the planner's plan: {error}"))
    })
}
