//! The checker: from statements to a [`Domain`] with all names resolved and a sort for every
//! variable.
//!
//! `declarations` reads sorts and signatures, `laws` finds the sort of every variable and refuses
//! meaningless laws, and `negation` refuses predicates defined by their own negation.

mod checker;
mod declarations;
mod laws;
mod negation;
mod terms;

use crate::ast::Statement;
use crate::domain::{Domain, Kind};
use crate::parse::statements;
use crate::problem::LanguageError;
use checker::Checker;
use ramp_source::SourceFile;
use std::collections::BTreeMap;
use std::path::Path;

impl Domain {
    /// Reads a domain from a file. A fine domain receives the coarse one that it refines: it can
    /// use the coarse sorts and statics, and its `bridge` laws define coarse fluents.
    ///
    /// # Errors
    /// When the file cannot be read, or violates the language.
    pub fn read(path: &Path, coarse: Option<&Domain>) -> Result<Domain, LanguageError> {
        Domain::new(&SourceFile::read(path)?, coarse)
    }

    /// The same for a file in memory.
    ///
    /// # Errors
    /// When it violates the language.
    pub fn new(file: &SourceFile, coarse: Option<&Domain>) -> Result<Domain, LanguageError> {
        let statements = statements(file)?;
        let mut checker = Checker {
            coarse,
            domain: Domain {
                file: file.clone(),
                sorts: coarse.map(|domain| domain.sorts.clone()).unwrap_or_default(),
                functions: coarse.map(|domain| domain.functions.clone()).unwrap_or_default(),
                predicates: BTreeMap::new(),
                laws: Vec::new(),
            },
        };
        if let Some(coarse) = coarse {
            let statics = coarse.predicates.iter().filter(|(_, predicate)| predicate.kind == Kind::Static);
            checker.domain.predicates.extend(statics.map(|(name, p)| (name.clone(), p.clone())));
        }
        checker.declare(&statements)?;
        for statement in statements {
            if let Statement::Law { law, body, span } = statement {
                let law = checker.law(law, body, span)?;
                checker.domain.laws.push(law);
            }
        }
        checker.stratified()?;
        if let Some(coarse) = coarse {
            let inherited = coarse.laws.iter().filter(|law| coarse.is_static_law(law));
            checker.domain.laws.splice(0..0, inherited.cloned());
        }
        Ok(checker.domain)
    }
}
