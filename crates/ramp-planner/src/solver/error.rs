//! Reasons why a call of the solver did not finish.

use clingo::ClingoError;

/// A call did not finish.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SolveError {
    /// clingo reports an error.
    #[error("{0}")]
    Clingo(String),
    /// The search reached its limit of conflicts.
    #[error("the search reached its limit")]
    Limit {
        /// Lower bound on the number of steps, where steps are searched.
        steps: usize,
    },
}

impl From<ClingoError> for SolveError {
    fn from(error: ClingoError) -> SolveError {
        // The error borrows a buffer that clingo overwrites.
        SolveError::Clingo(error.to_string())
    }
}
