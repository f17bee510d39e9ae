//! Errors of planning.

use crate::solver::SolveError;
use ramp_action_language::PddlError;
use ramp_source::SourceFile;

/// A refused plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {step} ({action}): {why}")]
pub struct Refused {
    /// The coarse step, from 1; one more than the number of steps when the final state is wrong.
    pub step: usize,
    /// The action.
    pub action: String,
    /// The reason.
    pub why: String,
}

/// Reasons why there is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The state names something unknown to the goal or the kit.
    #[error("the state names the {kind} `{name}`, which {place} does not have{}", suggestion(.nearest))]
    UnknownName {
        /// `beam`, `connection` or `peg`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The goal's name, or `the kit`.
        place: String,
        /// The most similar name.
        nearest: Option<String>,
    },
    /// The plan has no such action.
    #[error("the plan has no action {name}{}", suggestion(.nearest))]
    UnknownAction {
        /// The action, in the syntax of the rules.
        name: String,
        /// The most similar action of the plan.
        nearest: Option<String>,
    },
    /// The state contradicts itself.
    #[error("invalid state: {why}")]
    ImpossibleState {
        /// The contradiction.
        why: String,
    },
    /// Fewer pegs remain than connections.
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
        /// The reason given by the rules.
        why: String,
        /// The beams involved.
        beams: Vec<String>,
    },
    /// It cannot be built within the known limits of the arm and the hand.
    #[error("{goal} cannot be built: {why}. What the arm cannot do: {reasons}")]
    Motion {
        /// The goal.
        goal: String,
        /// The reason given by the rules.
        why: String,
        /// The motion facts.
        reasons: String,
    },
    /// All orders of the beams were tried.
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
        /// The contradicted law.
        why: String,
    },
    /// The rules allow no plan for a task.
    #[error("{goal} has no plan: the rules of {file} do not allow `{task}` within {steps} steps")]
    NoPlan {
        /// The goal.
        goal: String,
        /// The rule file.
        file: String,
        /// The task, in the syntax of the rules.
        task: String,
        /// Number of steps that were tried.
        steps: usize,
    },
    /// An answer of the rules that does not fit their level.
    #[error("{file} gave the unexpected answer `{answer}`")]
    Answer {
        /// The rule file.
        file: String,
        /// The answer.
        answer: String,
    },
    /// A law that PDDL cannot express.
    #[error("{file}:{line}: {why}")]
    Pddl {
        /// The rule file.
        file: String,
        /// The line of the law.
        line: usize,
        /// The missing feature of PDDL.
        why: String,
    },
    /// An invalid line of an external plan.
    #[error("line {line}: {why}; found `{found}`")]
    PlanText {
        /// Counted from 1.
        line: usize,
        /// The line's text.
        found: String,
        /// The defect.
        why: String,
    },
    /// An external plan with an impossible action, or one that does not reach the goal.
    #[error("{0}")]
    Outside(#[from] Refused),
    /// The search reached its limit.
    #[error("{file}: the search for a plan of {steps} steps reached its limit")]
    GaveUp {
        /// The rule file.
        file: String,
        /// Lower bound on the number of steps.
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
