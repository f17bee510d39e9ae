//! A checked domain as data: every name is known and every variable has a sort.

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
/// let file = SourceFile::new("lamp.al", "sort lamp = { red, green }. static brighter(lamp, lamp). brighter(rad, green).");
/// let error = Domain::new(&file, None).unwrap_err();
/// assert_eq!(format!("{error:#}"), "lamp.al:1:67: `rad` is not of the sort `lamp` (did you mean `red`?)");
/// ```
#[derive(Clone, Debug)]
pub struct Domain {
    pub(crate) file: SourceFile,
    pub(crate) sorts: BTreeMap<String, Sort>,
    /// The arguments of the functions that sorts are made of.
    pub(crate) functions: BTreeMap<String, Vec<String>>,
    pub(crate) predicates: BTreeMap<String, Predicate>,
    pub(crate) laws: Vec<CheckedLaw>,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What never changes.
    Static,
    /// What is true at one time and may be false at another.
    Fluent(FluentKind),
    /// What changes fluents.
    Action {
        /// It happens by itself; no plan may hold it.
        exogenous: bool,
    },
}

/// How a fluent gets its truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FluentKind {
    /// Stays as it is unless a law changes it.
    Inertial,
    /// True exactly when a law says so.
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

/// A sort, as the set of what it is made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sort {
    pub leaves: BTreeSet<Leaf>,
}

/// One thing that a sort is made of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Leaf {
    Number,
    /// The objects of this sort come with the problem.
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
    /// The objects that laws name: they are not like others.
    pub fn quoted(&self) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        self.expressions(&mut |expression| expression.quoted(&mut names));
        names
    }

    /// Whether the laws do nothing with numbers but compare them with each other: then problems whose numbers have the same
    /// order are alike.
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

    /// What it declares under a name.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        self.predicates.get(name).map(|predicate| predicate.kind)
    }

    /// Does a bridge law define a coarse fluent of this name?
    pub fn bridges(&self, name: &str) -> bool {
        self.laws.iter().any(|law| matches!(&law.law, Law::Bridge { head } if head.name.text == name))
    }

    /// The sorts, and the statics that matter: those that a law about fluents, actions or goals asks for, and those that
    /// these statics are concluded from. Facts about others change nothing.
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

    /// Does a law conclude a static?
    pub(crate) fn is_static_law(&self, law: &CheckedLaw) -> bool {
        matches!(&law.law, Law::Holds { head } if self.kind(&head.atom.name.text) == Some(Kind::Static))
    }

    /// Is every element of the first sort one of the second?
    pub(crate) fn within(&self, inner: &str, outer: &str) -> bool {
        match (self.sorts.get(inner), self.sorts.get(outer)) {
            (Some(inner), Some(outer)) => inner.leaves.is_subset(&outer.leaves),
            _ => inner == outer,
        }
    }
}
