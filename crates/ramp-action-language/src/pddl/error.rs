//! What cannot be written in PDDL, and what cannot be read back.

/// Why PDDL cannot be written, or a plan not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PddlError {
    /// A law that PDDL cannot say.
    #[error("{file}:{line}: {why}")]
    Law {
        /// The file of the domain.
        file: String,
        /// The line of the law.
        line: usize,
        /// What PDDL lacks.
        why: String,
    },
    /// A line of a plan that is not an action.
    #[error("line {line}: {why}; found `{found}`")]
    Plan {
        /// Counted from 1.
        line: usize,
        /// What it says.
        found: String,
        /// What is wrong with it.
        why: String,
    },
}
