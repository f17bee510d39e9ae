//! The checker's common part: the domain so far, and errors at places of its file.

use crate::ast::{Name, Span};
use crate::domain::Domain;
use crate::problem::{LanguageError, LanguageProblem};
use ramp_source::{Fault, nearest};

/// A domain being checked.
pub(crate) struct Checker<'a> {
    pub(crate) coarse: Option<&'a Domain>,
    pub(crate) domain: Domain,
}

impl Checker<'_> {
    /// An error at a place of the file.
    pub(crate) fn fault<T>(&self, problem: LanguageProblem, span: &Span) -> Result<T, LanguageError> {
        Err(Fault::new(problem, self.domain.file.place(span.clone())))
    }

    /// An error about an undeclared name.
    pub(crate) fn unknown<'n, T>(
        &self,
        kind: &'static str,
        name: &Name,
        names: impl Iterator<Item = &'n String>,
    ) -> Result<T, LanguageError> {
        let nearest = nearest(&name.text, names.map(String::as_str)).map(str::to_string);
        self.fault(LanguageProblem::Unknown { kind, name: name.text.clone(), nearest }, &name.span)
    }
}
