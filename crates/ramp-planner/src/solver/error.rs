//! Why a call of the solver did not finish.

use clingo::ClingoError;

/// Why a call did not finish.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SolveError {
    /// clingo reports an error.
    #[error("{0}")]
    Clingo(String),
    /// The search reached its limit of conflicts.
    #[error("the search gave up")]
    Limit {
        /// Where steps are searched: how many. There is no plan of fewer.
        steps: usize,
    },
}

impl From<ClingoError> for SolveError {
    fn from(error: ClingoError) -> SolveError {
        // The error borrows a buffer that clingo writes to again.
        SolveError::Clingo(error.to_string())
    }
}
