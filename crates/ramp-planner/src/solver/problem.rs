//! Defects of a rule file for the order.

use ramp_source::{FormProblem, Problem};

/// Longest statement, bytes without comments and spaces; the project's own are ten times shorter.
/// clingo walks terms recursively, so this bounds its stack.
pub(super) const MAX_STATEMENT: usize = 2048;

/// Defects of the rules for the order, which are a program for clingo.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OrderProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// A directive by which clingo would read other files or run programs.
    #[error("`{word}` is not allowed in a rule file, not even in a comment or in quotes")]
    Foreign {
        /// The word.
        word: &'static str,
    },
    /// A statement that is too long to be read safely.
    #[error("this statement has more than {MAX_STATEMENT} bytes besides comments")]
    Long,
    /// The file is not a valid program.
    #[error("{why}")]
    Rule {
        /// The solver's reason.
        why: String,
    },
}

impl Problem for OrderProblem {
    fn label(&self) -> String {
        match self {
            OrderProblem::Form(problem) => problem.label(),
            OrderProblem::Foreign { .. } => "expected rules only".to_string(),
            OrderProblem::Rule { .. } => "here".to_string(),
            OrderProblem::Long => "begins here".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            OrderProblem::Form(problem) => problem.help(),
            OrderProblem::Foreign { .. } => Some("put all rules into this one file".to_string()),
            OrderProblem::Long => Some("split it into several statements".to_string()),
            OrderProblem::Rule { .. } => None,
        }
    }
}
