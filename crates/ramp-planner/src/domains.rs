//! The rules of the planner: two domains in the action language and the rules for the order, which
//! users may edit.

use crate::limits::{Limits, Watch};
use crate::solver::{self, OrderProblem};
use ramp_action_language::{Domain, LanguageError};
use ramp_source::{Fault, SourceFile};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The three files as the program was built with, in the order of [`Domains::FILES`].
const SHIPPED: [&str; 3] = [
    include_str!("../../../data/domains/order.lp"),
    include_str!("../../../data/domains/coarse.al"),
    include_str!("../../../data/domains/fine.al"),
];

/// A defect of a rule file, with its place.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum DomainError {
    /// A domain of the action language.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Language(#[from] LanguageError),
    /// The rules for the order.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Order(#[from] Fault<OrderProblem>),
}

/// The rules of the three levels, read and checked once.
///
/// ```
/// use ramp_planner::Domains;
///
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// assert!(domains.fine().file().text().contains("assemble_square"));
/// # Ok::<(), ramp_planner::DomainError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Domains {
    order: SourceFile,
    coarse: Domain,
    fine: Domain,
    limits: Option<Limits>,
}

impl Domains {
    /// The names of the three files in their folder: the order of the beams, coarse actions, fine actions.
    pub const FILES: [&'static str; 3] = ["order.lp", "coarse.al", "fine.al"];

    /// Reads and checks the three files of a folder.
    ///
    /// # Errors
    /// When a file cannot be read, or violates its language.
    pub fn read(folder: &Path) -> Result<Domains, DomainError> {
        let [order, coarse, fine] = Domains::FILES.map(|file| folder.join(file));
        let order = SourceFile::read(&order).map_err(DomainError::Order)?;
        let coarse = SourceFile::read(&coarse).map_err(DomainError::Language)?;
        let fine = SourceFile::read(&fine).map_err(DomainError::Language)?;
        Domains::new(order, coarse, fine)
    }

    /// Checks rules that are already in memory.
    ///
    /// # Errors
    /// As [`Domains::read`].
    pub fn new(order: SourceFile, coarse: SourceFile, fine: SourceFile) -> Result<Domains, DomainError> {
        solver::check(&order)?;
        let coarse = Domain::new(&coarse, None)?;
        let fine = Domain::new(&fine, Some(&coarse))?;
        Ok(Domains { order, coarse, fine, limits: None })
    }

    /// The same rules with limits: every plan is monitored. For untrusted rules.
    #[must_use]
    pub fn within(mut self, limits: Limits) -> Domains {
        self.limits = Some(limits);
        self
    }

    /// Monitors this process while these rules are used, if they have limits.
    pub(crate) fn watch(&self, proof: bool) -> Option<Watch> {
        let limits = self.limits?;
        let files = [&self.order, self.coarse.file(), self.fine.file()].map(|file| file.name().to_string());
        Some(limits.watch_for(files.into(), if proof { limits.proof } else { limits.time }))
    }

    /// The same rules with one file replaced: a file with `bridge` laws becomes the fine domain,
    /// one that ends in `.lp` the order, any other the coarse domain.
    ///
    /// # Errors
    /// As [`Domains::read`].
    pub fn with(&self, path: &Path) -> Result<Domains, DomainError> {
        let (mut order, mut coarse, mut fine) =
            (self.order.clone(), self.coarse.file().clone(), self.fine.file().clone());
        if path.extension().is_some_and(|extension| extension == "lp") {
            order = SourceFile::read(path).map_err(DomainError::Order)?;
        } else {
            let file = SourceFile::read(path).map_err(DomainError::Language)?;
            let bridges = file.text().lines().any(|line| line.trim_start().starts_with("bridge "));
            *(if bridges { &mut fine } else { &mut coarse }) = file;
        }
        let limits = self.limits;
        Ok(Domains { limits, ..Domains::new(order, coarse, fine)? })
    }

    /// SHA-256, in hex, of the texts of the three files, if a file differs from the one that the program was
    /// built with. It names rules of one's own in results.
    pub fn replaced(&self) -> Option<String> {
        let texts = [&self.order, self.coarse.file(), self.fine.file()].map(SourceFile::text);
        if texts == SHIPPED {
            return None;
        }
        let mut hash = Sha256::new();
        for (name, text) in Domains::FILES.iter().zip(texts) {
            hash.update(format!("{name} {}\n{text}", text.len()));
        }
        Some(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }

    /// The rules for the order of the beams.
    pub fn order(&self) -> &SourceFile {
        &self.order
    }

    /// The coarse domain.
    pub fn coarse(&self) -> &Domain {
        &self.coarse
    }

    /// The fine domain.
    pub fn fine(&self) -> &Domain {
        &self.fine
    }
}
