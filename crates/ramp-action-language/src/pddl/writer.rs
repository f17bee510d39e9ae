//! Names, terms and declarations in PDDL.

use super::error::PddlError;
use super::text::{parameters, plain, spaced, variable};
use crate::ast::{Atom, Expression, Shape};
use crate::domain::{CheckedLaw, Domain, Kind, Leaf, NUMBER};
use crate::term::Term;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// PDDL's unique name of each object, by its sort and its name in the facts.
pub(crate) type Objects = BTreeMap<(String, String), String>;

/// Words of PDDL that are no names.
const RESERVED: [&str; 17] = [
    "and",
    "assign",
    "decrease",
    "define",
    "domain",
    "either",
    "exists",
    "forall",
    "imply",
    "increase",
    "not",
    "number",
    "object",
    "or",
    "problem",
    "total_time",
    "when",
];

/// Writes terms and declarations; it gives every object a unique name.
pub(crate) struct Writer<'d> {
    pub(crate) domain: &'d Domain,
    /// PDDL's name of each object, by its sort and its name in the facts.
    pub(crate) objects: Objects,
    /// Objects named by the laws.
    pub(crate) quoted: BTreeSet<String>,
}

impl Writer<'_> {
    /// The PDDL name of an object of a sort. No other object, constant, sort, predicate or word of PDDL
    /// has it.
    pub(crate) fn object(&mut self, sort: &str, name: &str) -> String {
        let key = (self.open_sort(sort, name), name.to_string());
        if let Some(known) = self.objects.get(&key) {
            return known.clone();
        }
        let domain = self.domain;
        let taken = |text: &String| {
            RESERVED.contains(&text.as_str())
                || self.objects.values().any(|other| other == text)
                || domain.sorts.contains_key(text)
                || domain.predicates.contains_key(text)
                || domain.sorts.values().any(|sort| sort.leaves.contains(&Leaf::Constant(text.clone())))
        };
        let base = plain(name);
        let numbered = (2..).map(|number| format!("{base}_{number}"));
        let text = std::iter::once(base.clone()).chain(numbered).find(|text| !taken(text));
        let text = text.unwrap_or(base);
        self.objects.insert(key, text.clone());
        text
    }

    /// The sort whose objects the problem gives, among the leaves of a sort: that of a known object of this
    /// name, else the first.
    fn open_sort(&self, sort: &str, name: &str) -> String {
        let leaves = self.domain.sorts.get(sort).into_iter().flat_map(|sort| &sort.leaves);
        let mut open = leaves.filter_map(|leaf| match leaf {
            Leaf::Open(open) => Some(open.clone()),
            _ => None,
        });
        let first = open.clone().next();
        let known = open.find(|open| self.objects.contains_key(&(open.clone(), name.to_string())));
        known.or(first).unwrap_or_else(|| sort.to_string())
    }

    /// The sort of a function's argument.
    fn inner_sort(&self, function: &str) -> String {
        self.domain.functions.get(function).and_then(|sorts| sorts.first()).cloned().unwrap_or_default()
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

    /// The terms of an atom of a law.
    pub(crate) fn expressions(&mut self, law: &CheckedLaw, atom: &Atom) -> Result<Vec<String>, PddlError> {
        let sorts =
            self.domain.predicates.get(&atom.name.text).map(|it| it.sorts.clone()).unwrap_or_default();
        let terms = atom.arguments.iter().zip(&sorts);
        terms.map(|(term, sort)| self.expression(law, term, sort)).collect()
    }

    /// A term of a law with its sort; the functions around an object are left out.
    pub(crate) fn expression(
        &mut self,
        law: &CheckedLaw,
        term: &Expression,
        sort: &str,
    ) -> Result<String, PddlError> {
        match &term.what {
            Shape::Variable(name) => Ok(variable(name)),
            Shape::Quoted(name) => {
                let object = self.object(sort, name);
                self.quoted.insert(object.clone());
                Ok(object)
            }
            Shape::Function(name, arguments) => match &arguments[..] {
                [] => Ok(name.clone()),
                [inner] => self.expression(law, inner, &self.inner_sort(name)),
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
        let sorts = self.domain.predicates.get(name).map(|it| it.sorts.clone()).unwrap_or_default();
        let terms = arguments.iter().zip(&sorts).map(|(argument, sort)| self.argument(argument, sort));
        let terms: Vec<String> = terms.collect();
        spaced(name, &terms)
    }

    fn argument(&mut self, term: &Term, sort: &str) -> String {
        match term {
            Term::Text(name) => self.object(sort, name),
            Term::Function(name, arguments) => match &arguments[..] {
                [inner] => self.argument(inner, &self.inner_sort(name)),
                _ => name.clone(),
            },
            other => other.to_string(),
        }
    }
}
