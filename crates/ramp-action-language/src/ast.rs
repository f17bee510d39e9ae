//! Statements as parsed: names are not resolved yet; every part has its place in the text.

use std::collections::BTreeSet;
use std::fmt::{self, Display, Write};
use std::ops::Range;

/// Byte offsets into the text of the domain.
pub(crate) type Span = Range<usize>;

/// A name with its place.
#[derive(Clone, Debug)]
pub(crate) struct Name {
    pub text: String,
    pub span: Span,
}

/// A term of the language.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    pub what: Shape,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// `B`; each `_` gets a name of its own, such as `_3`.
    Variable(String),
    Number(i64),
    /// `"b4"`: an object of a problem.
    Quoted(String),
    /// `input`, `above(A)`.
    Function(String, Vec<Expression>),
    Sum(Box<Expression>, Sign, Box<Expression>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
}

/// `joins(C, A, B)`.
#[derive(Clone, Debug)]
pub(crate) struct Atom {
    pub name: Name,
    pub arguments: Vec<Expression>,
    pub span: Span,
}

/// An atom, or `-` and an atom.
#[derive(Clone, Debug)]
pub(crate) struct Literal {
    pub positive: bool,
    pub atom: Atom,
}

/// `A != B`.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    pub left: Expression,
    pub operator: Operator,
    pub right: Expression,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

/// One condition of a body.
#[derive(Clone, Debug)]
pub(crate) enum Condition {
    Literal(Literal),
    Comparison(Comparison),
}

/// The form of a law.
#[derive(Clone, Debug)]
pub(crate) enum Law {
    /// `action causes heads if body`
    Causal { action: Atom, heads: Vec<Literal> },
    /// `head if body`: about a static, an inertial fluent (a state constraint) or a defined one.
    Holds { head: Literal },
    /// `impossible action if body`
    Impossible { action: Atom },
    /// `initially head if body`
    Initially { head: Literal },
    /// `goal head if body`
    Goal { head: Literal },
    /// `bridge head if body`: a coarse fluent defined by fine ones.
    Bridge { head: Atom },
}

/// A part of a sort.
#[derive(Clone, Debug)]
pub(crate) enum SortPart {
    /// Another sort.
    Sort(Name),
    /// A constant of `{ … }`.
    Constant(Name),
    /// `above(area)`.
    Function(Name, Vec<Name>),
}

/// A statement.
#[derive(Clone, Debug)]
pub(crate) enum Statement {
    /// `sort name = parts`; without parts, its objects are given by the problem.
    Sort { name: Name, parts: Option<Vec<SortPart>> },
    /// `static name(sorts)`
    Static { name: Name, sorts: Vec<Name> },
    /// `inertial fluent name(sorts)`, `defined fluent name(sorts)`
    Fluent { name: Name, sorts: Vec<Name>, inertial: bool },
    /// `action name(sorts)`, `exogenous action name(sorts)`
    Action { name: Name, sorts: Vec<Name>, exogenous: bool },
    /// A law.
    Law { law: Law, body: Vec<Condition>, span: Span },
}

impl Expression {
    /// The quoted names in it.
    pub fn quoted(&self, into: &mut BTreeSet<String>) {
        match &self.what {
            Shape::Quoted(name) => {
                into.insert(name.clone());
            }
            Shape::Variable(_) | Shape::Number(_) => {}
            Shape::Function(_, arguments) => arguments.iter().for_each(|term| term.quoted(into)),
            Shape::Sum(left, _, right) => {
                left.quoted(into);
                right.quoted(into);
            }
        }
    }

    /// Whether it names a number or contains a sum.
    pub fn reckons(&self) -> bool {
        match &self.what {
            Shape::Number(_) | Shape::Sum(..) => true,
            Shape::Variable(_) | Shape::Quoted(_) => false,
            Shape::Function(_, arguments) => arguments.iter().any(Expression::reckons),
        }
    }

    /// Calls `with` for every variable in it.
    pub fn variables(&self, with: &mut impl FnMut(&str, &Span)) {
        match &self.what {
            Shape::Variable(name) => with(name, &self.span),
            Shape::Number(_) | Shape::Quoted(_) => {}
            Shape::Function(_, arguments) => arguments.iter().for_each(|term| term.variables(with)),
            Shape::Sum(left, _, right) => {
                left.variables(with);
                right.variables(with);
            }
        }
    }
}

/// Whether this is the parser's name for a `_`.
pub(crate) fn is_anonymous(variable: &str) -> bool {
    variable.starts_with('_')
}

impl Operator {
    /// The operator as written in both the language and clingo.
    pub fn text(self) -> &'static str {
        match self {
            Operator::Equal => "=",
            Operator::NotEqual => "!=",
            Operator::Less => "<",
            Operator::LessEqual => "<=",
            Operator::Greater => ">",
            Operator::GreaterEqual => ">=",
        }
    }

    /// Whether it holds for two values in this order.
    pub fn holds(self, ordering: std::cmp::Ordering) -> bool {
        match self {
            Operator::Equal => ordering.is_eq(),
            Operator::NotEqual => ordering.is_ne(),
            Operator::Less => ordering.is_lt(),
            Operator::LessEqual => ordering.is_le(),
            Operator::Greater => ordering.is_gt(),
            Operator::GreaterEqual => ordering.is_ge(),
        }
    }
}

// In clingo's syntax, which is also the language's.

impl Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.what {
            // All `_` are equal in a program.
            Shape::Variable(name) => f.write_str(if is_anonymous(name) { "_" } else { name }),
            Shape::Number(number) => write!(f, "{number}"),
            Shape::Quoted(name) => write!(f, "{}", crate::term::Term::from(name.as_str())),
            Shape::Function(name, arguments) => {
                f.write_str(name)?;
                list(f, arguments)
            }
            Shape::Sum(left, sign, right) => {
                let sign = if *sign == Sign::Plus { '+' } else { '-' };
                write!(f, "({left}{sign}{right})")
            }
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, arguments: &[Expression]) -> fmt::Result {
    for (index, argument) in arguments.iter().enumerate() {
        write!(f, "{}{argument}", if index == 0 { '(' } else { ',' })?;
    }
    if arguments.is_empty() { Ok(()) } else { f.write_char(')') }
}

impl Display for Atom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name.text)?;
        list(f, &self.arguments)
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.left, self.operator.text(), self.right)
    }
}
