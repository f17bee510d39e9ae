//! Names, terms and declarations in PDDL.

use super::error::PddlError;
use super::text::{parameters, plain, spaced, variable};
use crate::ast::{Expression, Shape};
use crate::domain::{CheckedLaw, Domain, Kind, Leaf, NUMBER};
use crate::term::Term;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Writes terms and declarations; it gives every object a unique name.
pub(crate) struct Writer<'d> {
    pub(crate) domain: &'d Domain,
    /// PDDL's name of each object, by its name in the facts.
    pub(crate) objects: BTreeMap<String, String>,
    /// Objects named by the laws.
    pub(crate) quoted: BTreeSet<String>,
}

impl Writer<'_> {
    /// The unique PDDL name of an object.
    pub(crate) fn object(&mut self, name: &str) -> String {
        if let Some(known) = self.objects.get(name) {
            return known.clone();
        }
        let taken = |text: &String, all: &BTreeMap<String, String>| {
            all.values().any(|other| other == text)
                || self.domain.sorts.values().any(|sort| sort.leaves.contains(&Leaf::Constant(text.clone())))
        };
        let base = plain(name);
        let numbered = (2..).map(|number| format!("{base}_{number}"));
        let text = std::iter::once(base.clone()).chain(numbered).find(|text| !taken(text, &self.objects));
        let text = text.unwrap_or(base);
        self.objects.insert(name.to_string(), text.clone());
        text
    }

    /// An error about a law.
    pub(crate) fn cannot(&self, law: &CheckedLaw, why: &str) -> PddlError {
        let file = self.domain.file();
        PddlError::Law {
            file: file.name().to_string(),
            line: file.place(law.span.clone()).line_column().0,
            why: why.to_string(),
        }
    }

    /// A sort and its parts by a function: `beam connection - item`.
    pub(crate) fn types(&self) -> String {
        let mut parents: BTreeMap<&str, &str> = BTreeMap::new();
        for (name, sort) in &self.domain.sorts {
            for leaf in &sort.leaves {
                if let Leaf::Function(function) = leaf
                    && let Some([inner]) = self.domain.functions.get(function).map(Vec::as_slice)
                {
                    parents.insert(inner, name);
                }
            }
        }
        let mut text = "(:types".to_string();
        for name in self.domain.sorts.keys().filter(|name| *name != NUMBER) {
            let parent = parents.get(name.as_str()).copied().unwrap_or("object");
            let _ = write!(text, " {name} - {parent}");
        }
        text + ")\n"
    }

    /// The constants of sorts, and the objects named by laws.
    pub(crate) fn constants(&self, objects: &BTreeMap<&str, Vec<String>>) -> String {
        let mut text = "(:constants".to_string();
        for (name, sort) in &self.domain.sorts {
            for leaf in &sort.leaves {
                if let Leaf::Constant(constant) = leaf {
                    let _ = write!(text, " {constant} - {name}");
                }
            }
        }
        for (sort, names) in objects {
            for name in names.iter().filter(|name| self.quoted.contains(*name)) {
                let _ = write!(text, " {name} - {sort}");
            }
        }
        text + ")\n"
    }

    /// Statics and fluents.
    pub(crate) fn predicates(&self) -> String {
        let mut text = "(:predicates\n".to_string();
        for (name, predicate) in &self.domain.predicates {
            if !matches!(predicate.kind, Kind::Action { .. }) {
                let _ = writeln!(text, "  ({name}{})", parameters(&predicate.sorts));
            }
        }
        text + ")\n"
    }

    /// Terms of a law.
    pub(crate) fn expressions(
        &mut self,
        law: &CheckedLaw,
        terms: &[Expression],
    ) -> Result<Vec<String>, PddlError> {
        terms.iter().map(|term| self.expression(law, term)).collect()
    }

    /// A term of a law; the functions around an object are left out.
    pub(crate) fn expression(&mut self, law: &CheckedLaw, term: &Expression) -> Result<String, PddlError> {
        match &term.what {
            Shape::Variable(name) => Ok(variable(name)),
            Shape::Quoted(name) => {
                let object = self.object(name);
                self.quoted.insert(object.clone());
                Ok(object)
            }
            Shape::Function(name, arguments) => match &arguments[..] {
                [] => Ok(name.clone()),
                [inner] => self.expression(law, inner),
                _ => Err(self.cannot(law, "it needs a term with several arguments, which PDDL has not")),
            },
            Shape::Number(_) | Shape::Sum(..) => {
                Err(self.cannot(law, "it needs numbers, which this PDDL has not"))
            }
        }
    }

    /// A ground atom of the rules.
    pub(crate) fn ground(&mut self, term: &Term) -> String {
        let Some((name, arguments)) = term.parts() else { return String::new() };
        let terms: Vec<String> = arguments.iter().map(|argument| self.argument(argument)).collect();
        spaced(name, &terms)
    }

    fn argument(&mut self, term: &Term) -> String {
        match term {
            Term::Text(name) => self.object(name),
            Term::Function(name, arguments) => match &arguments[..] {
                [inner] => self.argument(inner),
                _ => name.clone(),
            },
            other => other.to_string(),
        }
    }
}
