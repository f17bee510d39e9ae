//! The benchmark's files, goals and plans.

use std::sync::Arc;

use pyo3::prelude::*;
use ramp_assembly::{Assembly, Class};
use ramp_gym::{Benchmark as Inner, SKILLS};
use ramp_planner::{Domains, Options, Plan, State, read_plan};
use serde_json::json;

use crate::errors::{PlanningError, data, detached, input};

/// Kit, goals, rules and arm of a data folder.
#[pyclass(frozen, module = "ramp._ramp")]
pub struct Benchmark {
    pub inner: Arc<Inner>,
}

#[pymethods]
impl Benchmark {
    #[new]
    fn new(folder: &str) -> PyResult<Benchmark> {
        Ok(Benchmark { inner: Arc::new(Inner::read(folder.as_ref()).map_err(data)?) })
    }

    /// The names of the goals, easy ones first.
    fn goal_names(&self) -> PyResult<Vec<String>> {
        self.inner.goal_names().map_err(data)
    }

    /// The names of the goals of a set of the open class, small ones first.
    fn open_goal_names(&self, set: &str) -> PyResult<Vec<String>> {
        let class = Class::of_name(set).filter(|class| class.is_open());
        let class = class.ok_or_else(|| input(format!("there is no set {set:?} of the open class")))?;
        self.inner.data.open_goal_names(class).map_err(data)
    }

    /// A goal, as JSON.
    fn goal(&self, name: &str) -> PyResult<String> {
        let goal = self.inner.goal(name).map_err(data)?;
        let connections: Vec<_> = goal
            .connections
            .iter()
            .map(|it| {
                json!({
                    "name": it.name,
                    "female": goal.joint_name(it.female),
                    "male": goal.joint_name(it.male),
                })
            })
            .collect();
        let file = self.inner.data.goal_file_name(name).map_err(data)?;
        let value = json!({
            "name": goal.name,
            "class": goal.class.map(|class| class.name()),
            "beams": goal.beams.iter().map(|it| it.beam.name.as_str()).collect::<Vec<_>>(),
            "base": goal.beams[goal.base].beam.name,
            "connections": connections,
            "file": file,
        });
        Ok(value.to_string())
    }

    /// A goal from above, as SVG.
    fn goal_svg(&self, name: &str) -> PyResult<String> {
        Ok(ramp_assembly::draw_svg(&self.inner.goal(name).map_err(data)?))
    }

    /// A plan for a goal, as JSON in the form of `ramp plan GOAL --json`.
    #[pyo3(signature = (goal, domain=None, optimal=false))]
    fn plan(&self, py: Python<'_>, goal: &str, domain: Option<&str>, optimal: bool) -> PyResult<String> {
        let assembly = self.inner.goal(goal).map_err(data)?;
        let domains = self.domains(domain)?;
        let options = Options { optimal, ..Options::default() };
        let plan = detached(py, || {
            ramp_planner::plan_with(&assembly, &State::default(), &domains, options)
                .map_err(|error| PlanningError::new_err(error.to_string()))
        })?;
        Ok(json!({ "goal": assembly.name, "plan": plan }).to_string())
    }

    /// Checks a plan of somebody else by the rules, and adds how beams get to their places; JSON in and out.
    #[pyo3(signature = (goal, text, domain=None))]
    fn check_plan(&self, py: Python<'_>, goal: &str, text: &str, domain: Option<&str>) -> PyResult<String> {
        let assembly = self.inner.goal(goal).map_err(data)?;
        let domains = self.domains(domain)?;
        let plan = detached(py, || self.own_plan(text, &assembly, &domains))?;
        Ok(json!({ "goal": assembly.name, "plan": plan }).to_string())
    }

    /// The coarse domain and a goal with a state (JSON) as PDDL: domain and problem, then both in STRIPS;
    /// none for what cannot be written.
    #[pyo3(signature = (goal, state, domain=None))]
    fn pddl(
        &self,
        py: Python<'_>,
        goal: &str,
        state: &str,
        domain: Option<&str>,
    ) -> PyResult<[Option<String>; 4]> {
        let assembly = self.inner.goal(goal).map_err(data)?;
        let domains = self.domains(domain)?;
        let state: State = serde_json::from_str(state).map_err(|error| input(error.to_string()))?;
        detached(py, || {
            let full = ramp_planner::pddl(&assembly, &state, &domains).ok();
            let (domain, problem) = full.map(|it| (it.domain, it.problem)).unzip();
            let strips = ramp_planner::strips(&assembly, &state, &domains).ok();
            let (strips_domain, strips_problem) = strips.map(|it| (it.domain, it.problem)).unzip();
            Ok([domain, problem, strips_domain, strips_problem])
        })
    }

    /// The skills that the goals of the benchmark need.
    #[staticmethod]
    fn skills() -> Vec<&'static str> {
        SKILLS.to_vec()
    }

    /// The contact steps of a goal's plan: number from 1, skill, action.
    fn steps(&self, py: Python<'_>, goal: &str) -> PyResult<Vec<(usize, String, String)>> {
        let goal = detached(py, || self.inner.planned(goal).map_err(data))?;
        let steps = goal.steps.iter().map(|it| &it.task);
        Ok(steps.map(|it| (it.step, it.skill.clone(), it.action.clone())).collect())
    }

    /// The names of the worlds that are part of the package.
    #[staticmethod]
    fn world_names() -> Vec<&'static str> {
        ramp_twin::World::names().collect()
    }

    /// Whether the fingers have tactile sensors in a world.
    fn has_touch(&self, world: &str) -> PyResult<bool> {
        Ok(self.inner.world(world).map_err(data)?.has_touch())
    }
}

impl Benchmark {
    /// The rules, with a file in place of the one of its kind.
    pub fn domains(&self, domain: Option<&str>) -> PyResult<Domains> {
        match domain {
            Some(path) => self.inner.domains.with(path.as_ref()).map_err(|error| input(format!("{error:?}"))),
            None => Ok(self.inner.domains.clone()),
        }
    }

    /// A plan of somebody else.
    pub fn own_plan(&self, text: &str, assembly: &Assembly, domains: &Domains) -> PyResult<Plan> {
        read_plan(text, assembly, domains).map_err(|error| PlanningError::new_err(error.to_string()))
    }
}
