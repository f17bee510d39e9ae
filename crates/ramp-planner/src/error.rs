//! Why there is no plan.

use crate::solver::SolveError;
use ramp_action_language::PddlError;
use ramp_source::SourceFile;

/// Why a plan is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {step} ({action}): {why}")]
pub struct Refused {
    /// The coarse step, counted from 1; one more than there are when the end is wrong.
    pub step: usize,
    /// The action.
    pub action: String,
    /// What is wrong with it.
    pub why: String,
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The state names something that the goal or the kit does not have.
    #[error("the state names the {kind} `{name}`, which {place} does not have{}", suggestion(.nearest))]
    UnknownName {
        /// `beam`, `connection` or `peg`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The goal's name, or `the kit`.
        place: String,
        /// The name most like it.
        nearest: Option<String>,
    },
    /// An action that the plan does not have.
    #[error("the plan has no action {name}{}", suggestion(.nearest))]
    UnknownAction {
        /// The action, in the words of the rules.
        name: String,
        /// The action of the plan most like it.
        nearest: Option<String>,
    },
    /// The state contradicts itself.
    #[error("the state cannot be: {why}")]
    ImpossibleState {
        /// What is wrong with it.
        why: String,
    },
    /// Fewer pegs are left than connections.
    #[error("{goal} needs {needed} more pegs, but only {left} are left")]
    Pegs {
        /// The goal.
        goal: String,
        /// Connections without a peg.
        needed: usize,
        /// Pegs of the kit that are neither used nor lost.
        left: usize,
    },
    /// It cannot be built in this order, or with this hand.
    #[error("{goal} cannot be built: {why}")]
    Illegal {
        /// The goal.
        goal: String,
        /// Why, as the rules say it.
        why: String,
        /// The beams that this is about.
        beams: Vec<String>,
    },
    /// It cannot be built with what the arm and the hand were found not to be able to do.
    #[error("{goal} cannot be built: {why}. What the arm cannot do: {reasons}")]
    Motion {
        /// The goal.
        goal: String,
        /// Why, as the rules say it.
        why: String,
        /// The motion facts.
        reasons: String,
    },
    /// No order of the beams is left to try.
    #[error("{goal} cannot be built: no order of its beams can be carried out")]
    NoOrder {
        /// The goal.
        goal: String,
    },
    /// An action or a state contradicts the coarse domain.
    #[error("{file}: {why}")]
    Refused {
        /// The rule file.
        file: String,
        /// Which law it contradicts.
        why: String,
    },
    /// The rules allow no plan for a part of the goal.
    #[error("{goal} has no plan: the rules of {file} do not allow `{task}` within {steps} steps")]
    NoPlan {
        /// The goal.
        goal: String,
        /// The rule file.
        file: String,
        /// What was to be reached, in the words of the rules.
        task: String,
        /// How many steps were tried.
        steps: usize,
    },
    /// The rules gave an answer that does not fit their level.
    #[error("{file} gave the answer `{answer}`, which has no meaning here")]
    Answer {
        /// The rule file.
        file: String,
        /// The answer.
        answer: String,
    },
    /// A law that PDDL cannot say.
    #[error("{file}:{line}: {why}")]
    Pddl {
        /// The rule file.
        file: String,
        /// The line of the law.
        line: usize,
        /// What PDDL lacks.
        why: String,
    },
    /// A line of a plan from outside that is none.
    #[error("line {line}: {why}; found `{found}`")]
    PlanText {
        /// Counted from 1.
        line: usize,
        /// What it says.
        found: String,
        /// What is wrong with it.
        why: String,
    },
    /// A plan from outside with an action that is not possible, or that does not reach the goal.
    #[error("{0}")]
    Outside(#[from] Refused),
    /// The search was given up.
    #[error("{file}: the search for a plan of {steps} steps gave up")]
    GaveUp {
        /// The rule file.
        file: String,
        /// There is no plan of fewer steps.
        steps: usize,
    },
    /// The solver failed.
    #[error("{file}: {why}")]
    Solver {
        /// The rule file.
        file: String,
        /// The solver's reason.
        why: String,
    },
}

impl PlanError {
    /// A failure of the solver on one rule file.
    pub(crate) fn solver(rules: &SourceFile, error: &SolveError) -> PlanError {
        let file = rules.name().to_string();
        match error {
            SolveError::Limit { steps } => PlanError::GaveUp { file, steps: *steps },
            SolveError::Clingo(why) => PlanError::Solver { file, why: why.clone() },
        }
    }
}

impl From<PddlError> for PlanError {
    fn from(error: PddlError) -> PlanError {
        match error {
            PddlError::Law { file, line, why } => PlanError::Pddl { file, line, why },
            PddlError::Plan { line, found, why } => PlanError::PlanText { line, found, why },
        }
    }
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}
