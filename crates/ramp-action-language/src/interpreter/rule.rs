//! Laws in the interpreter: names and variables are numbers.

use super::values::Value;
use crate::ast::{Operator, Sign, Span};
use smallvec::SmallVec;
use std::collections::BTreeSet;

/// A law, its variables numbered.
pub(crate) struct Rule<'d> {
    pub(crate) heads: Vec<Head<'d>>,
    /// The action of a causal law.
    pub(crate) action: Option<Head<'d>>,
    pub(crate) conditions: Vec<Test>,
    /// The sort of each variable; `None` for numbers.
    pub(crate) variables: Vec<Option<usize>>,
    /// Predicates in the conditions.
    pub(crate) reads: BTreeSet<usize>,
    pub(crate) span: Span,
}

impl Rule<'_> {
    /// Whether a row can be matched against any of its atoms with no variable bound; a sum can only
    /// be evaluated.
    pub(crate) fn is_local(&self) -> bool {
        let literals = self.conditions.iter().filter_map(|test| match test {
            Test::Literal { arguments, .. } => Some(arguments),
            Test::Comparison(..) => None,
        });
        let mut heads = self.heads.iter().map(|head| &head.arguments).chain(literals);
        heads.all(|arguments| arguments.iter().all(Pattern::is_plain))
    }
}

/// The conclusion of a law, or its action.
pub(crate) struct Head<'d> {
    pub(crate) positive: bool,
    pub(crate) predicate: usize,
    /// The name, which for a bridge law is one of the coarse domain.
    pub(crate) name: &'d str,
    pub(crate) arguments: Vec<Pattern>,
}

/// A term with variables.
pub(crate) enum Pattern {
    Variable(usize),
    Constant(Value),
    Function(String, Vec<Pattern>),
    Sum(Box<Pattern>, Sign, Box<Pattern>),
}

impl Pattern {
    /// Whether it contains no sum.
    fn is_plain(&self) -> bool {
        match self {
            Pattern::Variable(_) | Pattern::Constant(_) => true,
            Pattern::Function(_, arguments) => arguments.iter().all(Pattern::is_plain),
            Pattern::Sum(..) => false,
        }
    }
}

/// A condition of a law.
pub(crate) enum Test {
    Literal { positive: bool, predicate: usize, arguments: Vec<Pattern> },
    Comparison(Pattern, Operator, Pattern),
}

/// The values of the variables bound so far.
pub(crate) type Binding = SmallVec<[Option<Value>; 8]>;

/// Whether every variable of a term is bound.
pub(crate) fn is_bound(pattern: &Pattern, binding: &Binding) -> bool {
    match pattern {
        Pattern::Variable(variable) => binding[*variable].is_some(),
        Pattern::Constant(_) => true,
        Pattern::Function(_, arguments) => arguments.iter().all(|argument| is_bound(argument, binding)),
        Pattern::Sum(left, _, right) => is_bound(left, binding) && is_bound(right, binding),
    }
}

/// The first unbound variable.
pub(crate) fn unbound(patterns: &[Pattern], binding: &Binding) -> Option<usize> {
    patterns.iter().find_map(|pattern| match pattern {
        Pattern::Variable(variable) => binding[*variable].is_none().then_some(*variable),
        Pattern::Constant(_) => None,
        Pattern::Function(_, arguments) => unbound(arguments, binding),
        Pattern::Sum(left, _, right) => unbound(std::slice::from_ref(left), binding)
            .or_else(|| unbound(std::slice::from_ref(right), binding)),
    })
}
