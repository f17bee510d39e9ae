//! Errors of writing PDDL and of reading plans.

/// PDDL cannot be written, or a plan cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PddlError {
    /// A law that PDDL cannot express.
    #[error("{file}:{line}: {why}")]
    Law {
        /// The file of the domain.
        file: String,
        /// The line of the law.
        line: usize,
        /// The missing feature of PDDL.
        why: String,
    },
    /// A line of a plan that is not an action.
    #[error("line {line}: {why}; found `{found}`")]
    Plan {
        /// Counted from 1.
        line: usize,
        /// The line's text.
        found: String,
        /// The defect.
        why: String,
    },
}
