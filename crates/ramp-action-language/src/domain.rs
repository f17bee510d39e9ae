//! A checked domain as data: all names are resolved and every variable has a sort.

use crate::ast::{Atom, Condition, Expression, Law, Span};
use ramp_source::SourceFile;
use std::collections::{BTreeMap, BTreeSet};

/// The sort of whole numbers, which every domain has.
pub(crate) const NUMBER: &str = "number";

/// A domain of the action language: parsed, and every sort checked.
///
/// ```
/// use ramp_action_language::{Domain, SourceFile};
///
/// let file = SourceFile::new(
///     "lamp.al",
///     "sort lamp = { red, green }.
///      inertial fluent on(lamp).
///      action press(lamp).
///      press(L) causes on(L) if -on(L).",
/// );
/// assert!(Domain::new(&file, None).is_ok());
///
/// let text = "sort lamp = { red, green }. static brighter(lamp, lamp). brighter(rad, green).";
/// let file = SourceFile::new("lamp.al", text);
/// let error = Domain::new(&file, None).unwrap_err();
/// assert_eq!(format!("{error:#}"), "lamp.al:1:67: `rad` is not of the sort `lamp` (did you mean `red`?)");
/// ```
#[derive(Clone, Debug)]
pub struct Domain {
    pub(crate) file: SourceFile,
    pub(crate) sorts: BTreeMap<String, Sort>,
    /// The arguments of the functions from which sorts are built.
    pub(crate) functions: BTreeMap<String, Vec<String>>,
    pub(crate) predicates: BTreeMap<String, Predicate>,
    pub(crate) laws: Vec<CheckedLaw>,
}

/// The kind of a declared name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Never changes.
    Static,
    /// True at some times and false at others.
    Fluent(FluentKind),
    /// Changes fluents.
    Action {
        /// It happens without the agent; plans cannot contain it.
        exogenous: bool,
    },
}

/// The source of a fluent's truth value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FluentKind {
    /// Persists unless a law changes it.
    Inertial,
    /// True exactly when a law derives it.
    Defined,
}

impl Kind {
    /// In words, for messages.
    pub(crate) fn describe(self) -> &'static str {
        match self {
            Kind::Static => "a static",
            Kind::Fluent(FluentKind::Inertial) => "an inertial fluent",
            Kind::Fluent(FluentKind::Defined) => "a defined fluent",
            Kind::Action { .. } => "an action",
        }
    }
}

/// A static, a fluent or an action with the sorts of its arguments.
#[derive(Clone, Debug)]
pub(crate) struct Predicate {
    pub kind: Kind,
    pub sorts: Vec<String>,
}

/// A sort, as the set of its leaves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sort {
    pub leaves: BTreeSet<Leaf>,
}

/// A leaf of a sort.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Leaf {
    Number,
    /// The objects of this sort are given by the problem.
    Open(String),
    Constant(String),
    Function(String),
}

/// A law with the sorts of its variables.
#[derive(Clone, Debug)]
pub(crate) struct CheckedLaw {
    pub law: Law,
    pub body: Vec<Condition>,
    pub span: Span,
    pub variables: BTreeMap<String, String>,
}

impl Domain {
    /// The objects named by laws: they are not interchangeable with others.
    pub fn quoted(&self) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        self.expressions(&mut |expression| expression.quoted(&mut names));
        names
    }

    /// Whether the laws only compare numbers: then problems whose numbers have the same order are
    /// equivalent.
    pub fn only_compares_numbers(&self) -> bool {
        let mut only = true;
        self.expressions(&mut |expression| only &= !expression.reckons());
        only
    }

    /// Calls `with` for every term in a law.
    fn expressions(&self, with: &mut impl FnMut(&Expression)) {
        for law in &self.laws {
            let heads: Vec<&Atom> = match &law.law {
                Law::Causal { action, heads } => {
                    [action].into_iter().chain(heads.iter().map(|head| &head.atom)).collect()
                }
                Law::Holds { head } | Law::Initially { head } | Law::Goal { head } => vec![&head.atom],
                Law::Impossible { action } => vec![action],
                Law::Bridge { head } => vec![head],
            };
            heads.iter().flat_map(|atom| &atom.arguments).for_each(&mut *with);
            for condition in &law.body {
                match condition {
                    Condition::Literal(literal) => literal.atom.arguments.iter().for_each(&mut *with),
                    Condition::Comparison(comparison) => {
                        with(&comparison.left);
                        with(&comparison.right);
                    }
                }
            }
        }
    }

    /// The file.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// The kind of a declared name.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        self.predicates.get(name).map(|predicate| predicate.kind)
    }

    /// Whether a bridge law defines a coarse fluent of this name.
    pub fn bridges(&self, name: &str) -> bool {
        self.laws.iter().any(|law| matches!(&law.law, Law::Bridge { head } if head.name.text == name))
    }

    /// The sorts and the relevant statics: those used in a law about fluents, actions or goals, and
    /// those from which these are derived. All other facts have no effect.
    pub fn relevant_facts(&self) -> BTreeSet<&str> {
        let mut matter: BTreeSet<&str> = self.sorts.keys().map(String::as_str).collect();
        loop {
            let known = matter.len();
            for law in &self.laws {
                let concluded = match &law.law {
                    Law::Holds { head } if self.is_static_law(law) => Some(head.atom.name.text.as_str()),
                    _ => None,
                };
                if concluded.is_none_or(|name| matter.contains(name)) {
                    let names = law.body.iter().filter_map(|condition| match condition {
                        Condition::Literal(literal) => Some(literal.atom.name.text.as_str()),
                        Condition::Comparison(_) => None,
                    });
                    matter.extend(names.filter(|name| self.kind(name) == Some(Kind::Static)));
                }
            }
            if matter.len() == known {
                return matter;
            }
        }
    }

    /// Whether a law derives a static.
    pub(crate) fn is_static_law(&self, law: &CheckedLaw) -> bool {
        matches!(&law.law, Law::Holds { head } if self.kind(&head.atom.name.text) == Some(Kind::Static))
    }

    /// Whether every element of the first sort is one of the second.
    pub(crate) fn within(&self, inner: &str, outer: &str) -> bool {
        match (self.sorts.get(inner), self.sorts.get(outer)) {
            (Some(inner), Some(outer)) => inner.leaves.is_subset(&outer.leaves),
            _ => inner == outer,
        }
    }
}
