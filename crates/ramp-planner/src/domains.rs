//! The rules of the planner: one file of Answer Set Programming for each level, which people may edit.

use crate::solver;
use ramp_kit::source::{Fault, FormProblem, Problem, SourceFile};
use std::path::Path;

/// What is wrong with a rule file, and where.
pub type DomainError = Fault<DomainProblem>;

/// What can be wrong with a rule file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// The file is not a valid program.
    #[error("{why}")]
    Rule {
        /// The solver's reason.
        why: String,
    },
}

impl Problem for DomainProblem {
    fn label(&self) -> String {
        match self {
            DomainProblem::Form(problem) => problem.label(),
            DomainProblem::Rule { .. } => "here".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            DomainProblem::Form(problem) => problem.help(),
            DomainProblem::Rule { .. } => None,
        }
    }
}

/// The rule files of the three levels, read and checked once.
///
/// ```
/// use ramp_planner::Domains;
///
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// assert!(domains.fine().text().contains("assemble_square"));
/// # Ok::<(), ramp_planner::DomainError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Domains {
    order: SourceFile,
    coarse: SourceFile,
    fine: SourceFile,
}

impl Domains {
    /// The names of the three files in their folder: the order of the beams, coarse actions, fine actions.
    pub const FILES: [&'static str; 3] = ["order.lp", "coarse.lp", "fine.lp"];

    /// Reads and checks the three files of a folder.
    ///
    /// # Errors
    /// When a file cannot be read, has a syntax error, or a rule with a variable that nothing binds.
    pub fn read(folder: &Path) -> Result<Domains, DomainError> {
        let [order, coarse, fine] =
            Domains::FILES.map(|file| SourceFile::read::<DomainProblem>(&folder.join(file)));
        Domains::new(order?, coarse?, fine?)
    }

    /// Checks rules that are already in memory.
    ///
    /// # Errors
    /// As [`Domains::read`].
    pub fn new(order: SourceFile, coarse: SourceFile, fine: SourceFile) -> Result<Domains, DomainError> {
        for file in [&order, &coarse, &fine] {
            solver::check(file)?;
        }
        Ok(Domains { order, coarse, fine })
    }

    /// The rules for the order of the beams.
    pub fn order(&self) -> &SourceFile {
        &self.order
    }

    /// The rules of the coarse actions.
    pub fn coarse(&self) -> &SourceFile {
        &self.coarse
    }

    /// The rules of the fine actions.
    pub fn fine(&self) -> &SourceFile {
        &self.fine
    }
}
