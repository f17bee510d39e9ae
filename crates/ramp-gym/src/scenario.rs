//! The scenario of an environment: a goal or a skill, a track, a world, and the start of its episodes.

use std::collections::BTreeMap;
use std::sync::Arc;

use ramp_assembly::{Assembly, Task};
use ramp_kit::source::{nearest, shorten};
use ramp_robot::Track;
use ramp_twin::{Setup, Start, World};

use crate::benchmark::{Benchmark, BenchmarkError};
use crate::tasks::PlannedGoal;

/// Why an environment cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// Something is wrong with a file or a name.
    #[error(transparent)]
    Data(#[from] BenchmarkError),
    /// A skill's name.
    #[error("there is no skill `{skill}`; {help}")]
    UnknownSkill {
        /// The name.
        skill: String,
        /// The most similar name, or the names of all skills.
        help: String,
    },
    /// The goals that were chosen have no step of the skill.
    #[error("none of the goals {goals} has a step of the skill `{skill}`")]
    NoStep {
        /// The goals.
        goals: String,
        /// The skill.
        skill: String,
    },
}

/// The moment at which an episode of a skill begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Begin {
    /// At the skill itself: the baseline has fetched and carried the parts.
    #[default]
    Ready,
    /// With the arm at home, as `ramp trials` has it.
    Home,
}

/// The hold of the parts of a standing frame on each other while a skill is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// They are one rigid body, without those that the skill moves.
    #[default]
    Rigid,
    /// By contact alone, as in `ramp trials`.
    Free,
}

/// The task.
#[derive(Clone, Debug, PartialEq)]
pub enum Mission {
    /// A whole goal.
    Goal,
    /// One skill.
    Skill {
        /// Its name, such as `fasten-corner`; `fasten` stands for all joints.
        name: String,
        /// The steps of it, as indices of a goal and of a step of that goal.
        steps: Vec<(usize, usize)>,
    },
}

/// The part that environments of one kind share. Immutable.
pub struct Scenario {
    /// The files.
    pub benchmark: Arc<Benchmark>,
    /// The goals that are built, or whose steps are tried.
    pub goals: Vec<Arc<PlannedGoal>>,
    /// The task.
    pub mission: Mission,
    /// The track: what the agent may see of the parts.
    pub track: Track,
    /// The world from which the physics are drawn.
    pub world: World,
    /// The start from which the places of the parts are drawn.
    pub start: Start,
    /// The moment at which an episode of a skill begins.
    pub begin: Begin,
    /// Whether a skill's scene has all parts of the kit, as `ramp trials` has it, and not only those that it
    /// needs.
    pub whole_scene: bool,
    /// The hold of the frame that stands before a skill.
    pub frame: Frame,
}

impl Scenario {
    /// A whole goal.
    pub fn goal(
        benchmark: Arc<Benchmark>,
        assembly: Assembly,
        track: Track,
        world: World,
        start: Start,
    ) -> Scenario {
        let goals = vec![Arc::new(PlannedGoal { assembly, steps: Vec::new() })];
        Scenario {
            benchmark,
            goals,
            mission: Mission::Goal,
            track,
            world,
            start,
            begin: Begin::Home,
            whole_scene: true,
            frame: Frame::Free,
        }
    }

    /// One skill, at the steps of it that these goals have. `fasten` stands for the skills of all joints.
    ///
    /// # Errors
    /// When there is no such skill, or a goal cannot be read or planned.
    pub fn skill(
        benchmark: Arc<Benchmark>,
        name: &str,
        goals: &[String],
        track: Track,
        world: World,
        start: Start,
        begin: Begin,
    ) -> Result<Scenario, ScenarioError> {
        let goals = read_goals(&benchmark, goals)?;
        let mut steps = Vec::new();
        for (index, goal) in goals.iter().enumerate() {
            for (step, it) in goal.steps.iter().enumerate() {
                if it.task.skill == name || (name == ALL_JOINTS && it.task.skill.starts_with("fasten-")) {
                    steps.push((index, step));
                }
            }
        }
        if steps.is_empty() {
            let known = skills(&goals);
            if known.contains_key(name) || name == ALL_JOINTS || SKILLS.contains(&name) {
                let goals: Vec<&str> = goals.iter().map(|it| it.assembly.name.as_str()).collect();
                return Err(ScenarioError::NoStep { goals: goals.join(", "), skill: name.to_string() });
            }
            let help = match nearest(name, SKILLS.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the skills are {}", SKILLS.join(", ")),
            };
            return Err(ScenarioError::UnknownSkill { skill: shorten(name), help });
        }
        let mission = Mission::Skill { name: name.to_string(), steps };
        let (whole_scene, frame) = (false, Frame::default());
        Ok(Scenario { benchmark, goals, mission, track, world, start, begin, whole_scene, frame })
    }

    /// The setup of an episode of one of the goals.
    pub fn setup(&self, goal: usize, seed: u64) -> Setup<'_> {
        Setup {
            assembly: &self.goals[goal].assembly,
            arm: &self.benchmark.arm,
            track: self.track,
            seed,
            start: &self.start,
            world: &self.world,
            state: None,
            task: Task::Build,
            fault: None,
        }
    }
}

/// The name that stands for the skills of all joints that a peg can pin.
pub const ALL_JOINTS: &str = "fasten";

/// The twelve skills that the nine goals of the benchmark need, as `ramp trials` names them.
pub const SKILLS: [&str; 12] = [
    "assemble-cap",
    "assemble-deep",
    "assemble-square",
    "assemble-through",
    "fasten-angle-f",
    "fasten-in-f",
    "fasten-in-f-end",
    "fasten-thru-f",
    "lay-down",
    "pick-up-peg",
    "push",
    "slide",
];

/// Reads and plans goals; all of the benchmark without a name.
///
/// # Errors
/// When a goal cannot be read or planned.
pub fn read_goals(benchmark: &Benchmark, names: &[String]) -> Result<Vec<Arc<PlannedGoal>>, BenchmarkError> {
    let all = if names.is_empty() { benchmark.goal_names()? } else { names.to_vec() };
    all.iter().map(|name| benchmark.planned(name)).collect()
}

/// The skills of some goals, each with its steps as indices of a goal and of a step of it.
pub fn skills(goals: &[Arc<PlannedGoal>]) -> BTreeMap<String, Vec<(usize, usize)>> {
    let mut steps: BTreeMap<String, Vec<(usize, usize)>> = BTreeMap::new();
    for (index, goal) in goals.iter().enumerate() {
        for (step, it) in goal.steps.iter().enumerate() {
            steps.entry(it.task.skill.clone()).or_default().push((index, step));
        }
    }
    steps
}
